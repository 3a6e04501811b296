//! A run that resumes from a checkpoint is bitwise equal to an uninterrupted run.

use std::collections::BTreeSet;
use std::path::Path;

use crate::common::Random;
use crate::common::scene::{self, Face, Recording};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::mirrored::mirror_planes;
use wythe::model::scene::{Fidelity, Gravity};
use wythe::results::checkpoint::CheckpointFile;
use wythe::solve;
use wythe::solve::Checkpoint;
use wythe::solve::Recorder;
use wythe::state::{Frame, HistoryRow, Status, Summary};
use wythe::state::{Method, State};

/// Records everything, with a checkpoint after each accepted increment, and may stop the run.
#[derive(Default)]
struct Keeper {
    recording: Recording,
    checkpoints: Vec<Checkpoint>,
    /// Number of rows after which the run should stop; `None`: never.
    stop_after: Option<usize>,
}

impl Recorder for Keeper {
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        self.recording.take(model, row, frame)?;
        Ok(self.stop_after != Some(self.recording.rows.len()))
    }

    fn observe(&mut self, state: &State) {
        self.recording.observe(state);
    }

    fn checkpoint(&mut self, _: bool, make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        self.checkpoints.push(make());
        Ok(())
    }
}

/// A checkpoint after writing and reading.
fn through_a_file(checkpoint: &Checkpoint) -> Checkpoint {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint.bin");
    let file = CheckpointFile {
        version: String::new(),
        deck: None,
        deck_folder: None,
        way_to_deck_folder: None,
        history: wythe::files::Extent::default(),
        frames: 0,
        messages: None,
        wall_s: 0.0,
        cpu_s: None,
        peak: None,
        solver: checkpoint.clone(),
    };
    file.write(&path).unwrap();
    CheckpointFile::read(&path).unwrap().solver
}

/// All numbers with enough digits to reproduce their bits.
fn digits<T: std::fmt::Debug>(of: &[T]) -> Vec<String> {
    of.iter().map(|one| format!("{one:?}")).collect()
}

/// The part of a summary that does not depend on time.
fn told(summary: &Summary) -> String {
    let mut summary = summary.clone();
    summary.seconds_by_phase = [0.0; 6];
    // A resumed run has no earlier factors: its first factorisation is complete, with the same bits.
    summary.reused = 0.0;
    format!("{summary:?}")
}

/// Increments after which the procedure or the step changes.
fn turns(rows: &[HistoryRow]) -> BTreeSet<usize> {
    let pairs = rows.windows(2).enumerate();
    let turning = pairs.filter(|(_, w)| w[0].procedure != w[1].procedure || w[0].step != w[1].step);
    turning.flat_map(|(i, _)| [i, i + 1, i + 2]).collect()
}

/// Runs a model to its end. Then resumes from checkpoints at changes and at random, for some increments each. Then
/// runs once more from the start, interrupted after every increment.
fn goes_on_as_if_nothing_had_happened(model: &Model, name: &str, seed: u64) -> Vec<HistoryRow> {
    /// Number of increments that are compared after each checkpoint.
    const AHEAD: usize = 12;
    let mut whole = Keeper::default();
    let end = solve::run(model, &mut whole).unwrap();
    let rows = whole.recording.rows;
    let (all, frames) = (digits(&rows), digits(&whole.recording.frames));
    let states = digits(&whole.recording.states);
    assert_eq!(whole.checkpoints.len(), rows.len());
    println!("{name}: {} increments, {}", rows.len(), end.message);

    let mut random = Random(seed);
    let mut from: Vec<usize> = turns(&rows).into_iter().collect();
    while from.len() > 10 {
        from.remove((random.uniform() * from.len() as f64) as usize);
    }
    from.extend((0..6).map(|_| 1 + (random.uniform() * (rows.len() - 1) as f64) as usize));
    for k in from.into_iter().filter(|k| (1..=rows.len()).contains(k)) {
        let checkpoint = through_a_file(&whole.checkpoints[k - 1]);
        assert_eq!(checkpoint.increments(), k);
        let mut keeper = Keeper {
            stop_after: Some(AHEAD),
            ..Keeper::default()
        };
        solve::resume(model, checkpoint, &mut keeper).unwrap();
        let again = digits(&keeper.recording.rows);
        let until = rows.len().min(k + AHEAD);
        assert!(again == all[k..until], "{name}: rows from {k}");
        let again = digits(&keeper.recording.states);
        assert!(again == states[k..until], "{name}: states from {k}");
    }

    let mut stopped = Keeper {
        stop_after: Some(1),
        ..Keeper::default()
    };
    let mut summary = solve::run(model, &mut stopped).unwrap();
    let (mut again, mut frames_again) = (Vec::new(), Vec::new());
    loop {
        again.extend(digits(&stopped.recording.rows));
        frames_again.extend(digits(&stopped.recording.frames));
        if summary.status != Status::Interrupted {
            break;
        }
        let last = through_a_file(stopped.checkpoints.last().unwrap());
        stopped = Keeper {
            stop_after: Some(1),
            ..Keeper::default()
        };
        summary = solve::resume(model, last, &mut stopped).unwrap();
    }
    assert!(again == all, "{name}: rows of a run stopped each time");
    assert!(frames_again == frames, "{name}: frames");
    assert_eq!(told(&summary), told(&end), "{name}");
    rows
}

fn deck(path: &str, overrides: &[(&str, &str)]) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    Model::from_deck(&Deck::load(path, &overrides).unwrap())
        .unwrap()
        .0
}

fn methods(rows: &[HistoryRow]) -> BTreeSet<&'static str> {
    rows.iter().map(|row| row.procedure.name()).collect()
}

#[test]
fn a_wall_that_cracks() {
    for (how, name) in [
        (scene::SECANT, "static"),
        (scene::IMPLEX, "implex"),
        (scene::CONSISTENT, "consistent"),
    ] {
        let mut model = crate::common::small_wall();
        model.steps[1].increments.max = 0.04;
        for step in &mut model.steps {
            (step.procedure, step.tangent) = how;
        }
        let rows = goes_on_as_if_nothing_had_happened(&model, name, 11);
        let last = rows.last().unwrap();
        assert!(last.open_points > 20 && last.max_interface_damage > 0.1);
    }
}

/// A slender column in bending is too badly conditioned for factors in single precision, a stocky one is not. The
/// first increment detects this, the other increments of the step use it, and so does a resumed run.
#[test]
fn a_column_that_needs_double_precision() {
    for (cells, wants) in [(100, true), (8, false)] {
        let mut model = scene::empty();
        let solid = scene::heavy(1e4, 0.2, 2e-9);
        let height = 20.0 * cells as f64;
        let column = scene::block(
            &mut model,
            [0.0; 3],
            [20.0, 20.0, height],
            [1, 1, cells],
            &solid,
        );
        scene::hold(&mut model, column.face(Face::Bottom), [true; 3]);
        // Sideways load: the head of the slender column moves by a millimetre.
        let gravity = Gravity::Growing([98.1, 0.0, 0.0]);
        model.steps = vec![scene::left_alone(gravity, 1.0, 5, 1e-6); 2];
        let mut keeper = Keeper::default();
        assert_eq!(
            solve::run(&model, &mut keeper).unwrap().status,
            Status::Completed
        );
        let states = &keeper.recording.states;
        assert!(states.len() == 10 && states.iter().all(|s| s.wants_double == wants));
        goes_on_as_if_nothing_had_happened(&model, "column", 61);
    }
}

/// One half is solved, and its solids remain elastic.
#[test]
fn a_wall_with_automatic_simplifications() {
    for (fidelity, seed) in [("auto", 51), ("elastic", 52)] {
        let less = [
            ("fidelity", fidelity),
            ("wall.mesh", "[4, 2, 2]"),
            ("steps.1.displacement", "0.3 mm"),
        ];
        let model = deck("tests/stability/small_wall.toml", &less);
        let rows = goes_on_as_if_nothing_had_happened(&model, fidelity, seed);
        assert!(rows.last().unwrap().max_interface_damage > 0.1);
    }
}

/// Factors are reused for several iterates of an increment, but not in the next increment.
#[test]
fn a_wall_with_reused_factors() {
    let less = [
        ("steps.1.displacement", "0.8 mm"),
        ("steps.1.increments", "{ initial = 0.05, max = 0.1 }"),
    ];
    let model = deck("examples/03_shear_wall_j7d.toml", &less);
    let summary = solve::run(&model, &mut Keeper::default()).unwrap();
    assert!(2 * summary.factorisations < summary.iterations);
    goes_on_as_if_nothing_had_happened(&model, "factors", 71);
}

/// A run that began with the whole model continues with it.
#[test]
fn a_run_of_the_whole_stays_whole() {
    let less = [
        ("fidelity", "full"),
        ("wall.mesh", "[4, 2, 2]"),
        ("steps.1.displacement", "0.1 mm"),
    ];
    let mut model = deck("tests/stability/small_wall.toml", &less);
    let mut whole = Keeper::default();
    solve::run(&model, &mut whole).unwrap();
    model.fidelity = Fidelity::Auto;
    assert_eq!(mirror_planes(&model).len(), 1);
    let middle = whole.checkpoints.len() / 2;
    let mut rest = Keeper::default();
    let summary = solve::resume(&model, whole.checkpoints[middle - 1].clone(), &mut rest).unwrap();
    assert_eq!(summary.mirror_planes, []);
    assert!(digits(&rest.recording.rows) == digits(&whole.recording.rows[middle..]));
}

#[test]
fn paths_of_every_kind() {
    let snap_back = "tests/stability/cases/01-snap-back-bar/deck.toml";
    for (procedure, method) in [
        ("arc_length", Method::ArcLength),
        ("dissipation", Method::Dissipation),
    ] {
        let model = deck(snap_back, &[("steps.0.procedure", procedure)]);
        let rows = goes_on_as_if_nothing_had_happened(&model, procedure, 21);
        assert!(rows.iter().any(|row| row.procedure == method));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(snap_back);
    let text = std::fs::read_to_string(path).unwrap();
    let text = format!(
        r#"{text}
        [[steps]]
        kind = "drive"
        face = "right.right"
        direction = "x"
        displacement = "0.01 mm"
        procedure = "displacement_control"
        control = {{ probe = "opening", displacement = "0.1 mm" }}
        [[probes]]
        name = "opening"
        on = "right.left"
        minus = "left.right"
        direction = "x"
        "#
    );
    let steered = Deck::from_str(&text, "bar.toml").unwrap();
    let model = Model::from_deck(&steered).unwrap().0;
    let rows = goes_on_as_if_nothing_had_happened(&model, "displacement_control", 22);
    assert!(
        rows.iter()
            .any(|row| row.procedure == Method::DisplacementControl)
    );
}

/// Three steps; joints without strength; secant matrices and exact tangents.
#[test]
fn a_wall_that_tilts_twice() {
    let wall = "tests/stability/cases/09-tilted-wall/deck-a.toml";
    for (tangent, seed) in [("secant", 31), ("direct", 32)] {
        // The last step ends before collapse.
        let overrides = [
            ("steps.1.tangent", tangent),
            ("steps.2.tangent", tangent),
            ("steps.2.angle", "31 deg"),
            ("steps.2.increments.max", "0.1"),
        ];
        let rows = goes_on_as_if_nothing_had_happened(&deck(wall, &overrides), tangent, seed);
        assert_eq!(rows.last().unwrap().step, 2);
    }
}

/// The step ends early at its stop condition. A resumed run may have another stop condition; it is then equal to a
/// run that had this condition from the start.
#[test]
fn a_step_that_stops_by_itself() {
    let of = |key, value| {
        let wall = "tests/stability/small_wall.toml";
        deck(wall, &[("steps.1.displacement", "0.6 mm"), (key, value)])
    };
    let early = of("steps.1.stop.displacement", "0.1 mm");
    let rows = goes_on_as_if_nothing_had_happened(&early, "stop", 41);
    assert!(rows.last().unwrap().load_factor < 0.3);
    let later = of("steps.1.stop.displacement", "0.2 mm");
    let mut first = Keeper::default();
    solve::run(&early, &mut first).unwrap();
    let checkpoint = first.checkpoints.pop().unwrap();
    assert!(checkpoint.is_the_end_of(&early) && !checkpoint.is_the_end_of(&later));
    let mut rest = Keeper::default();
    solve::resume(&later, through_a_file(&checkpoint), &mut rest).unwrap();
    let mut rows = first.recording.rows;
    rows.extend(rest.recording.rows);
    let (whole, _) = scene::run(&later);
    assert!(digits(&rows) == digits(&whole.rows));
    // A step that has stopped remains finished.
    let mut nothing = Keeper::default();
    solve::resume(&early, checkpoint, &mut nothing).unwrap();
    assert!(nothing.recording.rows.is_empty());
}

#[test]
fn a_peak_with_short_increments() {
    let of = |peak| {
        let model = deck(
            "examples/85_arch_sideways.toml",
            &[("steps.1.increments.peak", peak)],
        );
        goes_on_as_if_nothing_had_happened(&model, peak, 41)
    };
    // Its last increments before the peak are short.
    assert!(of("0.0005").len() > of("0.005").len());
}

#[test]
fn a_path_through_snaps() {
    for (case, seed) in [("01-snap-back-bar", 1), ("15-brick-snaps", 2)] {
        let model = deck(&format!("tests/stability/cases/{case}/deck.toml"), &[]);
        let rows = goes_on_as_if_nothing_had_happened(&model, case, seed);
        println!("{:?}", methods(&rows));
        let over = [Method::Dissipation, Method::Relaxation];
        assert!(rows.iter().any(|row| over.contains(&row.procedure)));
    }
}

#[test]
fn blocks_in_motion() {
    for (case, seed) in [("06-braking-block", 3), ("07-rocking-block", 4)] {
        let model = deck(&format!("tests/stability/cases/{case}/deck.toml"), &[]);
        let rows = goes_on_as_if_nothing_had_happened(&model, case, seed);
        assert!(rows.iter().any(|row| row.procedure == Method::Dynamic));
    }
}

/// The procedure falls back to inertia when a unit tears off, and returns when it comes to rest.
#[test]
fn a_unit_that_tears_off() {
    let model = deck("tests/stability/cases/20-detached-unit/deck.toml", &[]);
    let rows = goes_on_as_if_nothing_had_happened(&model, "detached unit", 5);
    assert!(methods(&rows).contains("quasi_static"));
}

/// Without viscosity bricks snap: the procedure falls back and returns all the time.
#[test]
fn a_wall_with_procedure_fallback() {
    let model = deck(
        "tests/stability/small_wall.toml",
        &[
            ("steps.1.viscosity", "0"),
            ("steps.1.displacement", "0.8 mm"),
            ("materials.brick.crack_band", "volume"),
            ("materials.mortar.crack_band", "volume"),
        ],
    );
    let rows = goes_on_as_if_nothing_had_happened(&model, "ladder", 6);
    println!("{:?}, {} turns", methods(&rows), turns(&rows).len());
    assert!(methods(&rows).len() > 1);
}

/// Doubling the last step is equal to a run that had this length from the start, while increments do not depend on
/// its end.
#[test]
fn a_longer_last_step_continues_with_the_same_increments() {
    let of = |displacement: f64, part: f64| {
        let mut model = crate::common::small_wall();
        let step = &mut model.steps[1];
        for motion in step.motion.iter_mut().flatten() {
            if let wythe::model::scene::BeamMotion::Driven(by) = motion {
                *by = displacement;
            }
        }
        step.duration /= part;
        for size in [
            &mut step.increments.initial,
            &mut step.increments.max,
            &mut step.increments.min,
        ] {
            *size *= part;
        }
        model
    };
    let (short, long) = (of(0.15, 1.0), of(0.3, 0.5));
    let mut keeper = Keeper {
        stop_after: Some(9),
        ..Keeper::default()
    };
    solve::run(&short, &mut keeper).unwrap();
    let mut checkpoint = keeper.checkpoints.pop().unwrap();
    let refused = solve::resume(&long, checkpoint.clone(), &mut Keeper::default());
    assert!(refused.unwrap_err().to_string().contains("steps.1"));
    checkpoint.lengthen(&long, 0.5);
    let mut rest = Keeper::default();
    let summary = solve::resume(&long, checkpoint, &mut rest).unwrap();
    assert_eq!(summary.status, Status::Completed);
    let (whole, _) = scene::run(&long);
    let mut rows = keeper.recording.rows;
    for row in rows.iter_mut().filter(|row| row.step == 1) {
        row.load_factor *= 0.5;
    }
    rows.extend(rest.recording.rows);
    assert!(digits(&rows) == digits(&whole.rows));
}

#[test]
fn another_model_is_rejected() {
    let model = deck("examples/01_couplet_tension.toml", &[]);
    let mut keeper = Keeper {
        stop_after: Some(2),
        ..Keeper::default()
    };
    solve::run(&model, &mut keeper).unwrap();
    let checkpoint = keeper.checkpoints.pop().unwrap();
    for (key, value, named) in [
        ("interfaces.joint.f_t", "0.29", "the interfaces"),
        ("steps.1.increments.max", "0.01", "steps.1"),
        ("wall.mesh", "fine", "the mesh"),
    ] {
        let other = deck("examples/01_couplet_tension.toml", &[(key, value)]);
        let refused = solve::resume(&other, checkpoint.clone(), &mut Keeper::default());
        let error = refused.unwrap_err().to_string();
        assert!(error.contains(named), "{key}: {error}");
    }
    let output = deck("examples/01_couplet_tension.toml", &[("output.every", "1")]);
    assert!(solve::resume(&output, checkpoint, &mut Keeper::default()).is_ok());
}

/// Within the branches of an amplitude, under a follower pressure that a displacement controls, and at a row of a
/// table that only changes the rate.
#[test]
fn loads_and_amplitudes() {
    let cycles = [
        ("steps.1.increments.max", "0.01"),
        ("steps.1.increments.initial", "0.002"),
    ];
    for procedure in ["auto", "dynamic"] {
        let overrides = [&cycles[..], &[("steps.1.procedure", procedure)]].concat();
        let model = deck("examples/41_cyclic_block.toml", &overrides);
        let rows = goes_on_as_if_nothing_had_happened(&model, procedure, 23);
        assert!(rows.last().unwrap().displacement_mm.abs() < 1e-9);
    }
    for tangent in ["secant", "consistent"] {
        let airbag = [
            ("steps.1.tangent", tangent),
            ("steps.1.control.displacement", "1"),
        ];
        let model = deck("examples/40_airbag.toml", &airbag);
        goes_on_as_if_nothing_had_happened(&model, tangent, 29);
    }
    let rows = [
        ("steps.1.tangent", "secant"),
        ("steps.1.increments.max", "0.05"),
        (
            "steps.1.amplitude",
            "[[0, 0], [0.4, 0.1], [0.6, 0.3], [0.7, 0.3], [1, -0.1]]",
        ),
    ];
    let model = deck("examples/40_airbag.toml", &rows);
    goes_on_as_if_nothing_had_happened(&model, "rows", 31);
}

/// A rod is stressed, yields and breaks.
#[test]
fn blocks_held_by_a_rod_that_breaks() {
    let deck = Deck::from_str(
        "format = 1\n[materials.stone]\nE = 1e4\nnu = 0.2\ndensity = 2e-9\n\
         [interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = 0.6\nmu = 0.6\nnormal_stiffness = 1e3\nshear_stiffness = 1e3\n\
         [[blocks]]\nname = \"base\"\nsize = [100, 100, 100]\nmaterial = \"stone\"\nmesh = [2, 2, 2]\n\
         [[blocks]]\nname = \"top\"\nsize = [100, 100, 100]\nat = [0, 0, 100]\nmaterial = \"stone\"\nmesh = [2, 2, 2]\n\
         [[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n\
         [[supports]]\non = \"base.bottom\"\n\
         [[ties]]\nname = \"rod\"\npoints = [[50, 50, 20], [50, 50, 180]]\ndiameter = 10\nE = 2e5\nf_y = 300\n\
         hardening = 1e3\nrupture = 0.01\nprestress = 1e4\n\
         [[steps]]\nname = \"stress\"\nkind = \"free\"\nincrements = { initial = 0.25, max = 0.25 }\n\
         [[steps]]\nkind = \"drive\"\nface = \"top.top\"\ndirection = \"z\"\ndisplacement = 3\n\
         increments = { initial = 0.03, max = 0.03 }\n",
        "rod.toml",
    )
    .unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let rows = goes_on_as_if_nothing_had_happened(&model, "rod", 5);
    // The deck has no probes and loads: the rod is first.
    let force = |row: &HistoryRow| row.probes[0];
    let most = rows.iter().map(force).fold(0.0, f64::max);
    assert!(most > 23.6 && force(rows.last().unwrap()) == 0.0, "{most}");
}
