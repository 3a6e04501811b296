//! Runs scenes with their choices, in alternation.

use std::time::{Duration, Instant};

use rayon::ThreadPool;

use super::errors::{Errors, SLACK};
use super::front::median;
use super::pattern::{Cracks, Grid, Pattern};
use super::peer::Peer;
use super::scene::{Choice, Group, Scene};
use crate::study::History;
use crate::study::cell::Cost;
use crate::study::curve::Point;
use crate::study::judge::{Ended, reason};
use crate::study::parallel::{on_threads, side_by_side};
use crate::study::run::{self, Watch};
use wythe_core::deck::Deck;
use wythe_core::model::Model;
use wythe_core::results::usage;
use wythe_core::solve::Recorder;
use wythe_core::state::{Frame, HistoryRow, Status};

/// Options of the study.
#[derive(Clone, Debug)]
pub struct Options {
    /// Whether the short forms are run instead of the full ones.
    pub short: bool,
    /// Largest wall time of a run, checked after each increment.
    pub limit: Duration,
    /// Number of runs at a time. More than one disturb each other's times.
    pub jobs: usize,
    /// Number of runs of each choice: all choices once, then all again.
    pub repeats: usize,
}

/// Result of a choice.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The choice.
    pub choice: Choice,
    /// Errors against the reference, or the reason why there are none: the run ended early or failed.
    pub errors: Result<Errors, String>,
    /// Overlap of the crack pattern with that of the reference [-]; none if one of them is missing.
    pub cracks: Option<f64>,
    /// Largest ordinate of the run, in the unit of its column; NaN if the run failed.
    pub peak: f64,
    /// Numbers of increments, solves and cut-backs.
    pub cost: Cost,
    /// Energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
    /// CPU seconds of all threads of the run; wall seconds if the system does not report CPU time. `[repeat]`
    pub cpu: Vec<f64>,
    /// Wall seconds. `[repeat]`
    pub wall: Vec<f64>,
}

/// A scene with the results of its choices.
#[derive(Clone, Debug)]
pub struct Studied {
    /// The scene.
    pub scene: Scene,
    /// Whether the results are those of the short forms.
    pub short: bool,
    /// Results in the order of the choices. Choices without the requested form, or that were not begun, are
    /// missing.
    pub outcomes: Vec<Outcome>,
    /// Machine and procedure of the time measurement, in words.
    pub sitting: String,
}

/// Machine of the runs.
#[derive(Clone, Debug, PartialEq)]
struct Machine {
    /// Name of the processor, if the system reports it.
    processor: Option<String>,
    /// Number of threads available to this process.
    threads: usize,
}

impl Machine {
    /// The machine of this process.
    fn this() -> Self {
        let told = std::fs::read_to_string("/proc/cpuinfo");
        Self {
            processor: told.ok().and_then(|text| processor(&text)),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

/// `model name : …` of the first processor (proc(5)).
fn processor(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|l| l.starts_with("model name"))?;
    let name = line.split_once(':')?.1.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

impl Outcome {
    /// Median CPU time [s].
    pub fn cpu_seconds(&self) -> f64 {
        median(&self.cpu).unwrap_or(f64::NAN)
    }

    /// Median wall time [s].
    pub fn wall_seconds(&self) -> f64 {
        median(&self.wall).unwrap_or(f64::NAN)
    }
}

impl Studied {
    /// Result of the default; none if it was not run.
    pub fn default(&self) -> Option<&Outcome> {
        let mut all = self.outcomes.iter();
        all.find(|o| o.choice.group == Group::Default)
    }

    /// CPU and wall time over those of the default; NaN without the default. `[outcome][cpu, wall]`
    pub fn ratios(&self) -> Vec<[f64; 2]> {
        let times = |o: &Outcome| [o.cpu_seconds(), o.wall_seconds()];
        let of_default = self.default().map_or([f64::NAN; 2], times);
        let ratio = |o: &Outcome| [0, 1].map(|i| times(o)[i] / of_default[i]);
        self.outcomes.iter().map(ratio).collect()
    }

    /// Peers of the scene with their errors; none in the short form.
    pub fn peers(&self) -> Vec<(&Peer, Result<Errors, String>)> {
        let peers = self.scene.peers.iter().filter(|_| !self.short);
        let errors = |peer: &Peer| peer.errors(&self.scene.known(false)?);
        peers.map(|peer| (peer, errors(peer))).collect()
    }

    /// CPU time over that of the default, and error for the chart; NaN if there is none. `[outcome]`
    pub fn points(&self) -> Vec<(f64, f64)> {
        let ratios = self.ratios().into_iter().zip(&self.outcomes);
        let error = |o: &Outcome| o.errors.as_ref().map_or(f64::NAN, Errors::of_chart);
        ratios.map(|([cpu, _], o)| (cpu, error(o))).collect()
    }
}

/// Runs the scenes one after the other. `progress` is called with each finished run and the number of its repeat,
/// from 1, on any thread. `stop` is called after each increment; runs that have not begun when it returns true are
/// missing.
pub fn study(
    scenes: &[Scene],
    options: &Options,
    progress: &(dyn Fn(&Scene, &Outcome, usize) + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<Studied> {
    let machine = Machine::this();
    let studied = |scene: &Scene| {
        let of_form = scene.choices.iter();
        let of_form: Vec<&Choice> = of_form
            .filter(|c| scene.overrides(c, options.short).is_some())
            .collect();
        let round = |r| round(&of_form, r, options.repeats);
        let jobs = (1..=options.repeats).flat_map(|r| round(r).map(move |c| (r, c)));
        let run = |(repeat, choice): (usize, &Choice)| {
            let outcome = outcome(scene, choice, options, machine.threads, stop);
            progress(scene, &outcome, repeat);
            outcome
        };
        let mut outcomes: Vec<Outcome> = Vec::new();
        let done = side_by_side(jobs.collect(), options.jobs, stop, &run);
        for outcome in done.into_iter().flatten() {
            match outcomes.iter_mut().find(|o| o.choice == outcome.choice) {
                Some(first) => {
                    first.cpu.extend(outcome.cpu);
                    first.wall.extend(outcome.wall);
                }
                None => outcomes.push(outcome),
            }
        }
        Studied {
            scene: scene.clone(),
            short: options.short,
            outcomes,
            sitting: sitting(options, &machine),
        }
    };
    let all = scenes.iter().map(studied);
    all.filter(|s| !s.outcomes.is_empty()).collect()
}

/// Choices in the order of round `r`, from 1, of `rounds`. Each round starts at another choice, and every second
/// one runs backwards, because the run before (on other threads, or with a larger mesh) changes the time of a run
/// by up to a tenth.
fn round<'c>(
    choices: &[&'c Choice],
    r: usize,
    rounds: usize,
) -> impl Iterator<Item = &'c Choice> + use<'c> {
    let mut turn = choices.to_vec();
    if !turn.is_empty() {
        turn.rotate_left((r - 1) * choices.len() / rounds % choices.len());
    }
    if r.is_multiple_of(2) {
        turn.reverse();
    }
    turn.into_iter()
}

/// Description of the time measurement.
fn sitting(options: &Options, machine: &Machine) -> String {
    let processor = machine.processor.as_deref();
    let processor = processor.unwrap_or("an unnamed processor");
    let threads = machine.threads;
    let times = match options.repeats {
        1 => "each choice was run once".to_owned(),
        n => format!("medians of {n} runs of each choice, by turns"),
    };
    let jobs = match options.jobs {
        1 => "one at a time".to_owned(),
        n => format!("{n} at a time, which disturb each other"),
    };
    format!("{processor}, {threads} threads; {times}, {jobs}, on one thread unless said.")
}

fn outcome(
    scene: &Scene,
    choice: &Choice,
    options: &Options,
    threads: usize,
    stop: &(dyn Fn() -> bool + Sync),
) -> Outcome {
    let mut outcome = Outcome {
        choice: choice.clone(),
        errors: Err(String::new()),
        cracks: None,
        peak: f64::NAN,
        cost: Cost::default(),
        energy: f64::NAN,
        cpu: Vec::new(),
        wall: Vec::new(),
    };
    if choice.threads > threads {
        let why = format!("not run: the machine has {threads} threads");
        return Outcome {
            errors: Err(why),
            ..outcome
        };
    }
    let set = scene.overrides(choice, options.short).unwrap_or_default();
    let watch = Watch {
        limit: options.limit,
        stop,
    };
    let pattern = scene.pattern(options.short);
    let grid = pattern.map(Pattern::grid);
    match solved(scene, choice, &set, watch, grid) {
        Err(why) => outcome.errors = Err(why),
        Ok(solved) => {
            let curve = curve(scene, choice, &solved.ended);
            outcome.peak = curve.iter().map(|p| p[1]).fold(f64::NAN, f64::max);
            outcome.errors = errors(scene, options.short, &curve, &solved.ended);
            // A run that ended early has no pattern at the end of the range.
            let cracked = solved.pattern.filter(|_| outcome.errors.is_ok());
            outcome.cracks = cracked
                .zip(pattern)
                .and_then(|(own, known)| own.overlap(known));
            outcome.cost = solved.cost;
            outcome.energy = solved.ended.energy;
            outcome.cpu.push(solved.cpu);
            outcome.wall.push(solved.wall);
        }
    }
    outcome
}

fn errors(scene: &Scene, short: bool, curve: &[Point], ended: &Ended) -> Result<Errors, String> {
    let errors = scene.known(short)?.errors(curve);
    // A run that reached the end of the comparison has errors, however it ended afterwards.
    errors.map_err(|why| match ended.status {
        Status::Completed => why,
        Status::Collapsed => format!("{why}: {}", ended.message),
        Status::NotConverged => format!("{why}: {}", reason(&ended.message)),
        Status::Interrupted | Status::Stopped => format!("{why}: its time was up"),
    })
}

/// Curve of a run from the start of the compared steps: from rest, or from the last row before them. `[point][x,
/// y]`
pub(super) fn curve(scene: &Scene, choice: &Choice, ended: &Ended) -> Vec<Point> {
    let history = History::new(&ended.rows, &ended.probes);
    let rows = history.rows(scene.steps.as_deref());
    let first = rows.first().copied().unwrap_or(0);
    let start = [&scene.x, &scene.y].map(|name| history.before(name, first));
    let (x, y) = (history.column(&scene.x), history.column(&scene.y));
    let points = rows.into_iter().map(|i| [x[i], y[i]]);
    let [of_x, of_y] = scene.signs;
    std::iter::once(start)
        .chain(points)
        .map(|[x, y]| [of_x * x, of_y * choice.factor * y])
        .collect()
}

/// A finished run, whatever its status, and its times [s].
pub(super) struct Solved {
    pub ended: Ended,
    pub cost: Cost,
    pub cpu: f64,
    pub wall: f64,
    /// Crack pattern at the end of the range; none without a frame up to there.
    pub pattern: Option<Pattern>,
}

/// Runs a choice on its threads. The times are those of the solver, without reading of the deck and output of
/// results. The pattern is on `grid`, or else on a grid over all solids.
pub(super) fn solved(
    scene: &Scene,
    choice: &Choice,
    set: &[(String, String)],
    watch: Watch<'_>,
    grid: Option<Grid>,
) -> Result<Solved, String> {
    on_threads(choice.threads, |pool| {
        let deck = Deck::load(&scene.deck, set).map_err(|e| e.to_string())?;
        let (mut model, _) = Model::from_deck(&deck).map_err(|e| e.to_string())?;
        model.output.mcap = false;
        let (started, cpu) = (Instant::now(), cpu_of(pool));
        let last = Last {
            x: &scene.x,
            sign: scene.signs[0],
            // Displacement control may end beyond the target within its tolerance.
            to: scene.range[1] + SLACK * (scene.range[1] - scene.range[0]),
            cracks: None,
        };
        let ran = pool.install(|| run::run(&model, last, watch))?;
        let wall = started.elapsed().as_secs_f64();
        let cpu = cpu_of(pool).zip(cpu).map_or(wall, |(now, then)| now - then);
        let grid = grid.unwrap_or_else(|| Grid::over(&model.mesh));
        let cracks = ran.recorder.cracks;
        Ok(Solved {
            ended: ran.ended,
            cost: ran.cost,
            cpu,
            wall,
            pattern: cracks.map(|cracks| Pattern::of(&model, &cracks, grid)),
        })
    })
}

/// Recorder that keeps only the cracks of the last frame at or before the end of the range.
struct Last<'a> {
    /// Column of the abscissa.
    x: &'a str,
    /// Sign by which it is multiplied.
    sign: f64,
    /// Largest abscissa of a frame.
    to: f64,
    cracks: Option<Cracks>,
}

impl Recorder for Last<'_> {
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        if let Some(frame) = frame {
            let history = History::new(std::slice::from_ref(row), &model.columns());
            let x = history.column(self.x).first();
            if x.is_some_and(|x| self.sign * x <= self.to) {
                self.cracks = Some(Cracks::of(frame));
            }
        }
        Ok(true)
    }
}

/// CPU seconds of all threads of a pool.
fn cpu_of(pool: &ThreadPool) -> Option<f64> {
    let threads = pool.broadcast(|_| usage::thread_cpu_seconds());
    threads.into_iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_the_processor_is_that_of_the_first() {
        let text =
            "processor\t: 0\nmodel name\t: Some CPU @ 2.5 GHz\nprocessor\t: 1\nmodel name\t: B\n";
        assert_eq!(processor(text).as_deref(), Some("Some CPU @ 2.5 GHz"));
        assert_eq!(processor("processor\t: 0\n"), None);
        assert!(Machine::this().threads >= 1);
        let machine = Machine {
            processor: Some("Z80".to_owned()),
            threads: 1,
        };
        let mut options = Options {
            short: false,
            limit: Duration::from_secs(1),
            jobs: 1,
            repeats: 3,
        };
        let told = sitting(&options, &machine);
        assert!(
            told.starts_with("Z80, 1 threads; medians of 3 runs"),
            "{told}"
        );
        (options.jobs, options.repeats) = (2, 1);
        let told = sitting(&options, &machine);
        assert!(told.contains("run once, 2 at a time"), "{told}");
    }
}
