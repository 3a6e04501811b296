//! The shear wall of `examples/03_shear_wall_j7d.toml` with 10,000 to 500,000 unknowns, solved in full:
//! compressed, then pushed until joints slide and bricks yield. The bench measures the cost of a solve on one
//! thread, on two, and on four if the machine has them, and the memory of the process, without results on disk. It
//! rewrites `docs/sizes/table.csv` and `chart.svg` and prints the table. `WYTHE_BENCH_UNKNOWNS=100000` stops at
//! that size and writes nothing.

mod growth;

use std::fmt::Write as _;
use std::time::Instant;

use growth::exponent;
use rayon::{ThreadPool, ThreadPoolBuilder};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::results::plotting::{Scatter, Spot};
use wythe::results::usage::peak_memory_megabytes;

/// Units per course, and number of courses; the unknowns grow by a factor of some 2.6. The largest memory of a
/// process never decreases, so the sizes only grow.
const SIZES: [[usize; 2]; 5] = [[6, 12], [10, 20], [16, 32], [26, 52], [43, 85]];
/// Displacement of the top over the height [-]: joints slide and the first bricks yield.
const DRIFT: f64 = 6e-4;
/// A smaller pressure than that of J7D, under which the highest wall would buckle.
const PRESSURE: &str = "1 MPa";
const THREADS: [usize; 3] = [1, 2, 4];

fn wall([units, courses]: [usize; 2]) -> Model {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/03_shear_wall_j7d.toml"
    );
    let set = |key: &str, value: String| (key.to_owned(), value);
    let height = 62.5 * courses as f64;
    let overrides = [
        set("fidelity", "full".to_owned()),
        set("wall.length", (216.5 * units as f64 - 12.5).to_string()),
        set("wall.courses", courses.to_string()),
        set("steps.0.top_pressure", PRESSURE.to_owned()),
        set("steps.1.displacement", (DRIFT * height).to_string()),
        set("steps.1.increments.initial", "0.2".to_owned()),
        set("steps.1.increments.max", "0.2".to_owned()),
    ];
    let deck = Deck::load(path, &overrides).expect("the example");
    let (model, _) = Model::from_deck(&deck).expect("its model");
    model
}

fn pool(threads: usize) -> ThreadPool {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads")
}

#[expect(clippy::too_many_lines, reason = "a study, from its runs to its table")]
fn main() {
    let most: Option<usize> = std::env::var("WYTHE_BENCH_UNKNOWNS")
        .ok()
        .and_then(|text| text.parse().ok());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut table = String::from(
        "unknowns,units,threads,solves,wall_s,cpu_s,wall_ms_a_solve,factorise_s,memory_MB,memory_kB_an_unknown\n",
    );
    let (mut names, mut curves): (Vec<String>, Vec<Vec<(f64, f64)>>) = THREADS
        .iter()
        .filter(|&&threads| threads <= cores)
        .map(|threads| (format!("a solve [ms], threads: {threads}"), Vec::new()))
        .unzip();
    names.push("memory [MB]".to_owned());
    let mut memory = Vec::new();
    for size in SIZES {
        let model = wall(size);
        let mut unknowns = 0;
        for (curve, threads) in curves.iter_mut().zip(THREADS) {
            let pool = pool(threads);
            let begun = Instant::now();
            let (cpu, _, summary) = growth::run(&model, &pool);
            let seconds = begun.elapsed().as_secs_f64();
            let megabytes = peak_memory_megabytes().expect("a size");
            let a_solve = 1e3 * seconds / summary.iterations.max(1) as f64;
            unknowns = summary.sizes.dofs;
            writeln!(
                table,
                "{unknowns},{},{threads},{},{seconds:.2},{cpu:.2},{a_solve:.1},{:.2},{megabytes:.0},{:.2}",
                summary.sizes.units,
                summary.iterations,
                summary.seconds_by_phase[3],
                1e3 * megabytes / unknowns as f64,
            )
            .expect("a string takes it");
            println!("{}", table.lines().last().unwrap_or_default());
            curve.push((unknowns as f64, a_solve));
            if threads == 1 {
                memory.push((unknowns as f64, megabytes));
            }
        }
        if most.is_some_and(|most| unknowns >= most) {
            break;
        }
    }
    curves.push(memory);
    for (name, curve) in names.iter().zip(&curves) {
        println!("{name}: grows as n^{:.2}", exponent(curve));
    }
    if most.is_some() {
        return;
    }
    let spots: Vec<Spot> = curves
        .iter()
        .enumerate()
        .flat_map(|(series, curve)| {
            curve.iter().map(move |&at| Spot {
                name: String::new(),
                at,
                series,
                marked: false,
            })
        })
        .collect();
    let series: Vec<&str> = names.iter().map(String::as_str).collect();
    let axes = ["unknowns", "wall time of a solve [ms], memory [MB]"];
    let title = "Shear walls of 10,000 to 500,000 unknowns";
    let svg = Scatter {
        title,
        axes,
        series: &series,
        spots: &spots,
        ..Scatter::default()
    }
    .svg()
    .expect("a chart");
    growth::write("sizes", &table, &svg);
}
