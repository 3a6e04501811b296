//! Comparison with other programs: writes the matrices for them and measures this solver on request, so that both
//! are measured alternately.

use std::collections::BTreeMap;
use std::io::{BufRead, BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use wythe::linear::{Backend, LinearSolver};
use wythe::results::plotting::{Scatter, Spot};

use super::matrices::{Matrix, NAMES, large_wall, matrix};

/// Writes `name.bin` in little endian: n and the number of entries (u64), column pointers (u64),
/// rows (u32), values (f64), both triangles.
fn write(path: &Path, matrix: &Matrix) -> std::io::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    let pattern = &matrix.pattern;
    for size in [pattern.n(), pattern.nnz()] {
        file.write_all(&(size as u64).to_le_bytes())?;
    }
    for &start in pattern.col_ptr() {
        file.write_all(&(start as u64).to_le_bytes())?;
    }
    for &row in pattern.row_idx() {
        file.write_all(&row.to_le_bytes())?;
    }
    for value in &matrix.values {
        file.write_all(&value.to_le_bytes())?;
    }
    file.flush()
}

/// The values of a matrix and 1.5 times these. Factorised by turns, no factor can serve again: unchanged values would
/// be recognised, and no work would be timed.
fn turns(matrix: &Matrix) -> [Vec<f64>; 2] {
    let other = matrix.values.iter().map(|a| 1.5 * a).collect();
    [matrix.values.clone(), other]
}

/// CPU time of this thread [s] (Linux; zero elsewhere). On a shared host the wall time would include the load of
/// others.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split_whitespace().next().and_then(|n| n.parse().ok());
    1e-9 * nanoseconds.unwrap_or(0.0)
}

/// Writes the matrices to `folder`. Then answers each line `matrix llt|lu threads` with a line of numbers: times
/// to factorise and to solve [s], residual, number of entries of the factor, operations, and CPU times of the
/// calling thread to factorise and to solve [s].
pub fn serve(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let matrices: BTreeMap<&str, Matrix> = NAMES.map(|name| (name, matrix(name))).into();
    for (name, matrix) in &matrices {
        write(&folder.join(format!("{name}.bin")), matrix)?;
    }
    println!("ready");
    let values: BTreeMap<&str, [Vec<f64>; 2]> =
        matrices.iter().map(|(name, m)| (*name, turns(m))).collect();
    // A solver, and how often it has factorised.
    let mut solvers: BTreeMap<(String, String), (LinearSolver, usize)> = BTreeMap::new();
    let mut pools: BTreeMap<usize, rayon::ThreadPool> = BTreeMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, kind, threads] = words[..] else {
            break;
        };
        let backend = match kind {
            "lu" => Backend::MultifrontalLu,
            _ => Backend::MultifrontalLlt,
        };
        let threads = threads.parse().expect("a number of threads");
        let pool = pools.entry(threads).or_insert_with(|| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().expect("threads")
        });
        let matrix = &matrices[name];
        let (solver, count) = solvers
            .entry((name.to_owned(), kind.to_owned()))
            .or_insert_with(|| (matrix.analyse(backend), 0));
        let values = &values[name][*count % 2];
        *count += 1;
        let answer = pool.install(|| {
            let (start, cpu) = (Instant::now(), cpu_seconds());
            let stats = solver.factorise(values).expect("factors");
            let factorised = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
            let mut x = vec![1.0; solver.n()];
            let (start, cpu) = (Instant::now(), cpu_seconds());
            let report = solver.solve(&mut x).expect("a solution");
            let solved = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
            let residual = report.relative;
            format!(
                "{:e} {:e} {residual:e} {} {:e} {:e} {:e}",
                factorised.0, solved.0, stats.nnz, stats.flops, factorised.1, solved.1
            )
        });
        println!("{answer}");
    }
    Ok(())
}

/// Analyses a matrix, factorises it twice and solves for `columns` right-hand sides. Prints the times and the
/// largest memory of the process (Linux).
pub fn once(name: &str, backend: Backend, threads: usize, columns: usize) -> std::io::Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().expect("threads");
    let matrix = matrix(name);
    pool.install(|| {
        let mut solver = matrix.analyse(backend);
        let stats = solver.stats();
        println!(
            "{name} {backend:?}: {} equations, {:.2e} entries, {:.2e} numbers, {:.2e} operations, \
             analysis {:.2} s",
            solver.n(),
            matrix.pattern.nnz() as f64,
            stats.nnz as f64,
            stats.flops,
            stats.analysis_seconds
        );
        for values in turns(&matrix) {
            let seconds = solver.factorise(&values).expect("factors").seconds;
            println!(
                "factorised in {seconds:.2} s, {:.1e} /s",
                stats.flops / seconds
            );
        }
        let mut x = vec![1.0; solver.n() * columns];
        let start = Instant::now();
        let report = solver.solve(&mut x).expect("a solution");
        let seconds = start.elapsed().as_secs_f64();
        println!("{columns} right-hand sides in {seconds:.3} s, {report:?}");
    });
    let status = std::fs::read_to_string("/proc/self/status")?;
    if let Some(line) = status.lines().find(|line| line.starts_with("VmHWM")) {
        println!("{line}");
    }
    Ok(())
}

/// Resident memory of the process [bytes] (Linux; zero elsewhere).
fn resident() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmRSS"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse().ok());
    1024.0 * kilobytes.unwrap_or(0.0)
}

/// Walls of 10,000 to 500,000 unknowns by L Lᵀ: times of the analysis, the factorisation, the factorisation after
/// a change in a corner and after no change, and the solution; the memory; and the exponents of their growth from
/// the first wall to the last. Rewrites `docs/linear-solver/table.csv` and `chart.svg`.
pub fn scale(threads: usize, repeats: usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.build().expect("threads");
    let walls = [
        ("4317.5", "8"),
        ("4317.5", "36"),
        ("8647.5", "53"),
        ("17307.5", "88"),
    ];
    let head = "unknowns,analysis_ms,factorise_ms,corner_ms,again_ms,solve_ms,kB_an_unknown,kB_with_what_is_kept";
    let mut table = format!("{head}\n");
    println!("{head}");
    let mut rows = Vec::new();
    for (length, courses) in walls {
        let (n, figures) = pool.install(|| grow(&large_wall(length, courses), repeats));
        let told: Vec<String> = figures.iter().map(|x| format!("{x:.3}")).collect();
        let line = format!("{n},{}\n", told.join(","));
        print!("{line}");
        table += &line;
        rows.push((n, figures));
    }
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let exponent = |i: usize| (last.1[i] / first.1[i]).ln() / (last.0 / first.0).ln();
    let exponents: Vec<String> = (0..7).map(|i| format!("{:.2}", exponent(i))).collect();
    let line = format!("exponent,{}\n", exponents.join(","));
    print!("{line}");
    table += &line;
    let names = ["factorise", "a tenth changed", "analysis", "solve"];
    let spots = [1, 2, 0, 4]
        .into_iter()
        .enumerate()
        .flat_map(|(series, i)| {
            rows.iter().map(move |(n, figures)| Spot {
                name: String::new(),
                at: (*n, figures[i]),
                series,
                marked: false,
            })
        });
    let spots: Vec<Spot> = spots.collect();
    let title = format!("Cholesky factorisation of walls, threads: {threads}");
    let svg = Scatter {
        title: &title,
        axes: ["unknowns", "time [ms]"],
        series: &names,
        spots: &spots,
        ..Scatter::default()
    }
    .svg();
    let folder = format!("{}/docs/linear-solver", env!("CARGO_MANIFEST_DIR"));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(format!("{folder}/table.csv"), table).expect("a table");
    std::fs::write(format!("{folder}/chart.svg"), svg.expect("a chart")).expect("a chart");
}

/// Number of unknowns, and the figures that [`scale`] prints for one wall, the least of several times.
fn grow(matrix: &Matrix, repeats: usize) -> (f64, [f64; 7]) {
    let n = matrix.pattern.n();
    let mut times = [f64::INFINITY; 5];
    let note = |time: &mut f64, seconds: f64| *time = time.min(1e3 * seconds);
    let before = resident();
    let mut solver = matrix.analyse(Backend::MultifrontalLlt);
    note(&mut times[0], solver.stats().analysis_seconds);
    // The first tenth of the equations, which are numbered from one corner.
    let mut corner = matrix.values.clone();
    for j in 0..n / 10 {
        let diagonal = matrix.pattern.find(j, j).expect("a diagonal");
        corner[diagonal] *= 1.0 + 1e-6;
    }
    let other: Vec<f64> = matrix.values.iter().map(|a| a * 1.5).collect();
    let mut whole = 0.0;
    for round in 0..repeats {
        let seconds = solver.factorise(&other).expect("factors").seconds;
        note(&mut times[1], seconds);
        let start = Instant::now();
        solver.solve(&mut vec![1.0; n]).expect("a solution");
        note(&mut times[4], start.elapsed().as_secs_f64());
        if round == 0 {
            whole = resident() - before - 16.0 * matrix.values.len() as f64;
        }
        solver.factorise(&matrix.values).expect("factors");
        // The first change in a corner makes the solver store Schur complements; the second is measured.
        for values in [&corner, &matrix.values, &corner] {
            let stats = solver.factorise(values).expect("factors");
            if stats.reused > 0.0 {
                note(&mut times[2], stats.seconds);
            }
        }
        let seconds = solver.factorise(&corner).expect("factors").seconds;
        note(&mut times[3], seconds);
    }
    let kept = resident() - before - 16.0 * matrix.values.len() as f64;
    let [a, f, c, u, s] = times;
    let kilobytes = |bytes: f64| 1e-3 * bytes / n as f64;
    (n as f64, [a, f, c, u, s, kilobytes(whole), kilobytes(kept)])
}
