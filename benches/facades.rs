//! Façades of 100 to 10,000 units with one crack each (benches/facade.toml), solved in full and with `fidelity =
//! "auto"`: the cost of the crack and of the rest of the façade. CPU time of one run each on one thread, in turn,
//! without results on disk. The bench rewrites `docs/facades/table.csv` and `chart.svg` and prints the table.
//! `WYTHE_BENCH_UNITS=1000` stops at that size and writes nothing.

mod growth;

use std::fmt::Write as _;

use growth::exponent;
use rayon::ThreadPoolBuilder;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::scene::Fidelity;
use wythe::results::plotting::{Scatter, Spot};

const DECK: &str = include_str!("facade.toml");
/// Units per course, and number of courses.
const SIZES: [[usize; 2]; 6] = [[12, 9], [22, 16], [36, 28], [60, 42], [90, 64], [124, 81]];

/// A façade with this number of units per course and courses, on ground that separates below its middle.
fn facade([units, courses]: [usize; 2]) -> Model {
    let half = 102 * units;
    let set = |key: &str, value: String| (key.to_owned(), value);
    let overrides = [
        set("wall.length", (2 * half).to_string()),
        set("wall.courses", courses.to_string()),
        set("blocks.0.size", format!("[{half}, 98, 100]")),
        set("blocks.0.mesh", format!("[{units}, 1, 1]")),
        set("blocks.1.size", format!("[{half}, 98, 100]")),
        set("blocks.1.mesh", format!("[{units}, 1, 1]")),
        set("blocks.1.at", format!("[{half}, 0, -100]")),
    ];
    let deck = Deck::from_str_with(DECK, "facade.toml", &overrides).expect("the deck");
    let (model, _) = Model::from_deck(&deck).expect("its model");
    model
}

#[expect(clippy::too_many_lines, reason = "a study, from its runs to its table")]
fn main() {
    let most: Option<usize> = std::env::var("WYTHE_BENCH_UNITS")
        .ok()
        .and_then(|text| text.parse().ok());
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let names = ["full", "auto"];
    let mut table = String::from(
        "units,elements,fidelity,cpu_s,increments,solves,reused,force_kN,interface_dissipation_J,damage\n",
    );
    let (mut spots, mut curves) = (Vec::new(), [Vec::new(), Vec::new()]);
    for size in SIZES {
        let units = size[0] * size[1];
        if most.is_some_and(|most| units > most) {
            break;
        }
        let mut model = facade(size);
        for (series, fidelity) in [Fidelity::Full, Fidelity::Auto].into_iter().enumerate() {
            model.fidelity = fidelity;
            let (cpu, last, summary) = growth::run(&model, &pool);
            let a_solve = cpu / summary.iterations.max(1) as f64;
            writeln!(
                table,
                "{units},{},{},{cpu:.2},{},{},{:.1},{:.4},{:.5},{:.4}",
                summary.sizes.elements,
                names[series],
                summary.increments,
                summary.iterations,
                summary.reused,
                last.force_kN,
                last.interface_dissipation_J,
                last.max_interface_damage,
            )
            .expect("a string takes it");
            println!("{}", table.lines().last().unwrap_or_default());
            curves[series].push((units as f64, a_solve));
            spots.push(Spot {
                name: String::new(),
                at: (units as f64, 1e3 * a_solve),
                series,
                marked: false,
            });
        }
    }
    for (name, curve) in names.iter().zip(&curves) {
        println!(
            "{name}: CPU time of a solve grows as n^{:.2}",
            exponent(curve)
        );
    }
    if most.is_some() {
        return;
    }
    let axes = ["units", "CPU time of a solve [ms]"];
    let title = "Façades with one crack";
    let svg = Scatter {
        title,
        axes,
        series: &names,
        spots: &spots,
        ..Scatter::default()
    }
    .svg()
    .expect("a chart");
    growth::write("facades", &table, &svg);
}
