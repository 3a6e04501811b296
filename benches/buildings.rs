//! A wall of 4,035 bricks (benches/door_wall.toml) by every modelling strategy, and the house of example 98 with rigid
//! units: whole runs with results, as `wythe run` performs them, one of each, on two threads. The detailed model ends at
//! 1 mm, because the whole run takes an hour. The bench measures CPU and wall time, linear solves and the times of the
//! parts of the solver, and rewrites `docs/buildings/table.csv`; some half an hour and 5 GB. `WYTHE_BENCH_ONLY=rigid`
//! runs only those with this text in their names and writes nothing.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use wythe::deck::Deck;
use wythe::limit::{LimitSettings, analyse};
use wythe::model::Model;
use wythe::results::usage::cpu_seconds;
use wythe::results::{RunDirectory, SummaryFile};

const WALL: &str = "benches/door_wall.toml";
const HOUSE: &str = "examples/98_house_of_pavia.toml";
const THREADS: usize = 2;

/// A run: name, deck, strategy, and keys of the deck that it replaces.
struct Run {
    name: &'static str,
    deck: &'static str,
    strategy: &'static str,
    set: &'static [(&'static str, &'static str)],
}

const RUNS: [Run; 5] = [
    Run {
        name: "wall, limit",
        deck: WALL,
        strategy: "limit",
        set: &[],
    },
    Run {
        name: "wall, rigid",
        deck: WALL,
        strategy: "rigid",
        set: &[],
    },
    Run {
        name: "wall, simplified",
        deck: WALL,
        strategy: "simplified",
        set: &[],
    },
    Run {
        name: "wall, detailed to 1 mm",
        deck: WALL,
        strategy: "detailed",
        set: &[("steps.2.stop.displacement", "\"1 mm\"")],
    },
    Run {
        name: "house, rigid",
        deck: HOUSE,
        strategy: "rigid",
        set: &[],
    },
];

const COLUMNS: &str = "run,units,unknowns,contact_points,solves,cpu_s,wall_s,elements_s,contact_s,assembly_s,\
                       factorise_s,substitute_s,output_s,peak_kN,energies";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn model(run: &Run) -> (Model, Vec<String>) {
    let own = [("strategy", run.strategy)];
    let set = own.iter().chain(run.set);
    let set: Vec<_> = set
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let deck = Deck::load(root().join(run.deck), &set).expect("the deck");
    let (model, warnings) = Model::from_deck(&deck).expect("its model");
    (model, warnings.iter().map(ToString::to_string).collect())
}

/// Runs all steps into a folder.
fn solved(run: &Run, pool: &ThreadPool, out: &Path) -> SummaryFile {
    let (model, warnings) = model(run);
    pool.install(|| {
        let mut folder = RunDirectory::create(out, &model).expect("a folder");
        let summary = wythe::solve::run(&model, &mut folder).expect("a run");
        folder.finish(&model, &summary, &warnings).expect("results")
    })
}

/// Row of a limit analysis with associated friction, one program.
fn limit_row(run: &Run, pool: &ThreadPool) -> String {
    let (model, _) = model(run);
    let (cpu, wall) = (cpu_seconds().expect("a clock"), Instant::now());
    let settings = LimitSettings {
        associated: true,
        ..LimitSettings::default()
    };
    let found = pool.install(|| analyse(&model, &settings));
    let found = found.expect("a factor");
    let (cpu, wall) = (
        cpu_seconds().expect("a clock") - cpu,
        wall.elapsed().as_secs_f64(),
    );
    let force = found.force.unwrap_or(f64::NAN);
    let units = model.mesh.names.len();
    format!(
        "\"{}\",{units},,,{},{cpu:.2},{wall:.2},,,,,,,{force:.2},",
        run.name, found.programs
    )
}

/// Row of a run.
fn row(run: &Run, pool: &ThreadPool) -> String {
    let s = solved(run, pool, &root().join("target/buildings"));
    let parts = s.seconds_by_phase;
    format!(
        "\"{}\",{},{},{},{},{:.1},{:.1},{:.1},{:.1},{:.1},{:.1},{:.1},{:.1},{:.2},{:.0e}",
        run.name,
        s.units,
        s.dofs,
        s.contact_points,
        s.iterations,
        s.cpu_s.unwrap_or(f64::NAN),
        s.wall_s,
        parts.elements,
        parts.contact,
        parts.assembly,
        parts.factorise,
        parts.solve,
        parts.output,
        s.peak_force_kN.unwrap_or(f64::NAN),
        s.energy_balance_error,
    )
}

fn main() {
    let only = std::env::var("WYTHE_BENCH_ONLY").ok();
    let pool = ThreadPoolBuilder::new().num_threads(THREADS).build();
    let pool = pool.expect("threads");
    let mut table = format!("{COLUMNS}\n");
    println!("{COLUMNS}");
    let chosen = |run: &&Run| only.as_ref().is_none_or(|part| run.name.contains(part));
    for run in RUNS.iter().filter(chosen) {
        let row = match run.strategy {
            "limit" => limit_row(run, &pool),
            _ => row(run, &pool),
        };
        println!("{row}");
        writeln!(table, "{row}").expect("a string takes it");
    }
    if only.is_none() {
        let folder = root().join("docs/buildings");
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("table.csv"), table).expect("a table");
    }
}
