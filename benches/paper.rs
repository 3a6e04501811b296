//! The walls of D'Altri et al. (2018): whole runs with results, as `wythe run` performs them. The bench measures
//! CPU and wall time, linear solves, the times of the parts of the solver, and the peak relative to the references
//! of docs/accuracy-speed.md. Runs use one thread; some are repeated on two, and on four if the machine has them.
//! All runs are made in turn, `WYTHE_BENCH_ROUNDS` times (default two; some five minutes each); the least time
//! counts. The bench rewrites `docs/paper-times/table.csv`. `WYTHE_BENCH_ONLY=J4D` runs only the walls with this
//! text in their names and writes nothing.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use rayon::ThreadPoolBuilder;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::results::{RunDirectory, SummaryFile};

#[derive(Clone, Copy)]
struct Wall {
    name: &'static str,
    example: &'static str,
    set: &'static [(&'static str, &'static str)],
    /// Folder of the accuracy scene with the reference, and the column of its peak.
    beside: Option<(&'static str, &'static str)>,
    most_threads: usize,
}

const J7D: &str = "03_shear_wall_j7d";
const J4D: &str = "04_shear_wall_j4d";
const AIRBAG: &str = "62_out_of_plane_wall";
const SHEARED: Option<(&str, &str)> = Some(("03-shear-wall-j7d", "force_kN"));
const LIGHTLY_PRESSED: Option<(&str, &str)> = Some(("05-shear-wall-j4d", "force_kN"));
const BENT: Option<(&str, &str)> = Some(("04-out-of-plane", "airbag_MPa"));
const FINE: (&str, &str) = ("wall.mesh", "fine");
const FULL: (&str, &str) = ("fidelity", "full");

/// Settings of scene 4 of the accuracy study.
const SCENE_4: [(&str, &str); 2] = [
    ("steps.1.control.displacement", "1.0"),
    ("steps.1.increments.max", "0.05"),
];

const WALLS: [Wall; 9] = [
    Wall {
        name: "J7D",
        example: J7D,
        set: &[],
        beside: SHEARED,
        most_threads: 4,
    },
    Wall {
        name: "J7D whole",
        example: J7D,
        set: &[FULL],
        beside: SHEARED,
        most_threads: 1,
    },
    Wall {
        name: "J4D",
        example: J4D,
        set: &[],
        beside: LIGHTLY_PRESSED,
        most_threads: 4,
    },
    Wall {
        name: "J4D fine",
        example: J4D,
        set: &[FINE],
        beside: LIGHTLY_PRESSED,
        most_threads: 1,
    },
    Wall {
        name: "J7D fine",
        example: J7D,
        set: &[FINE],
        beside: SHEARED,
        most_threads: 4,
    },
    Wall {
        name: "J7D fine whole",
        example: J7D,
        set: &[FINE, FULL],
        beside: SHEARED,
        most_threads: 4,
    },
    Wall {
        name: "airbag to 1 mm",
        example: AIRBAG,
        set: &SCENE_4,
        beside: BENT,
        most_threads: 4,
    },
    Wall {
        name: "airbag",
        example: AIRBAG,
        set: &[],
        beside: BENT,
        most_threads: 1,
    },
    Wall {
        name: "airbag mesh 5x2x2",
        example: AIRBAG,
        set: &[("wall.mesh", "[5, 2, 2]")],
        beside: BENT,
        most_threads: 1,
    },
];

/// Largest value of a column in a CSV table, in which `#` begins a comment.
fn largest(path: &Path, column: &str) -> f64 {
    let text = std::fs::read_to_string(path).expect("a table");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let mut names = lines.next().expect("names").split(',');
    let place = names.position(|name| name == column).expect("its column");
    lines
        .filter_map(|line| line.split(',').nth(place)?.parse().ok())
        .fold(f64::MIN, f64::max)
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Summary of a run, and its peak over that of the reference.
fn run(wall: &Wall, threads: usize) -> (SummaryFile, Option<f64>) {
    let text = |&(key, value): &(&str, &str)| (key.to_owned(), value.to_owned());
    let overrides: Vec<(String, String)> = wall.set.iter().map(text).collect();
    let path = root().join(format!("examples/{}.toml", wall.example));
    let deck = Deck::load(path, &overrides).expect("the example");
    let (model, warnings) = Model::from_deck(&deck).expect("its model");
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let out = root().join("target/paper-times");
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let summary = pool.expect("threads").install(|| {
        let mut folder = RunDirectory::create(&out, &model).expect("a folder");
        let summary = wythe::solve::run(&model, &mut folder).expect("a run");
        folder.finish(&model, &summary, &warnings).expect("results")
    });
    let ratio = wall.beside.map(|(scene, column)| {
        let reference = root().join(format!("docs/accuracy-speed/{scene}/reference.csv"));
        largest(&out.join("history.csv"), column) / largest(&reference, column)
    });
    (summary, ratio)
}

#[expect(clippy::too_many_lines, reason = "a study, from its runs to its table")]
fn main() {
    let variable = |name| std::env::var(name).ok();
    let rounds = variable("WYTHE_BENCH_ROUNDS").and_then(|text| text.parse().ok());
    let only = variable("WYTHE_BENCH_ONLY");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let chosen: Vec<(Wall, usize)> = WALLS
        .into_iter()
        .filter(|wall| only.as_ref().is_none_or(|part| wall.name.contains(part)))
        .flat_map(|wall| {
            let most = wall.most_threads.min(cores);
            [1, 2, 4]
                .into_iter()
                .filter(move |&threads| threads <= most)
                .map(move |threads| (wall, threads))
        })
        .collect();
    let mut taken: Vec<Vec<(SummaryFile, Option<f64>)>> = vec![Vec::new(); chosen.len()];
    for round in 0..rounds.unwrap_or(2) {
        for (&(wall, threads), runs) in chosen.iter().zip(&mut taken) {
            runs.push(run(&wall, threads));
            let (summary, _) = runs.last().expect("just made");
            let cpu = summary.cpu_s.unwrap_or(f64::NAN);
            println!(
                "round {round}: {}, {threads} threads: {:.1} s, CPU {cpu:.1} s",
                wall.name, summary.wall_s
            );
        }
    }
    let mut table = String::from(
        "wall,threads,unknowns,solves,wall_s,wall_s_most,cpu_s,cpu_s_most,elements_s,contact_s,gather_s,factorise_s,solve_s,output_s,peak_over_reference\n",
    );
    for ((wall, threads), runs) in chosen.iter().zip(&taken) {
        let over = |time: fn(&SummaryFile) -> f64| {
            let times = runs.iter().map(|(summary, _)| time(summary));
            times.fold((f64::MAX, f64::MIN), |(a, b), t| (a.min(t), b.max(t)))
        };
        let (clock, cpu) = (over(|s| s.wall_s), over(|s| s.cpu_s.unwrap_or(f64::NAN)));
        let quickest = runs.iter().min_by(|a, b| a.0.wall_s.total_cmp(&b.0.wall_s));
        let (s, peak) = quickest.expect("a round");
        let t = &s.seconds_by_phase;
        let peak = peak.map_or(String::new(), |p| format!("{p:.4}"));
        writeln!(
            table,
            "{},{threads},{},{},{:.2},{:.2},{:.2},{:.2},{:.2},{:.2},{:.2},{:.2},{:.2},{:.2},{peak}",
            wall.name,
            s.dofs,
            s.iterations,
            clock.0,
            clock.1,
            cpu.0,
            cpu.1,
            t.elements,
            t.contact,
            t.assembly,
            t.factorise,
            t.solve,
            t.output,
        )
        .expect("a string takes it");
    }
    print!("{table}");
    if only.is_none() {
        let folder = root().join("docs/paper-times");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("table.csv"), table).expect("a table");
    }
}
