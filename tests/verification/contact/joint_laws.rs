//! Joint laws in decks: keys, messages and laws, and whole models with built-in and user-defined laws.

use wythe::contact::{InterfaceHistory, InterfaceLaw, InterfaceResponse, JointLaw, registry};
use wythe::deck::schema::JointKind;
use wythe::deck::{Deck, check};
use wythe::model::Model;
use wythe::point::{self, Row, Target};
use wythe::solve::Recorder;
use wythe::solve::RunError;
use wythe::state::{Frame, HistoryRow};

const CAP: &str = r#"
format = 1
[materials.stone]
E = "5 GPa"
nu = 0.2
[interfaces.joint]
kind = "cap"
f_t = "0.25 MPa"
G_I = "0.018 N/mm"
c = "0.35 MPa"
G_II = "0.125 N/mm"
tan_phi = 0.75
mu = 0.6
f_m = "10.5 MPa"
G_fc = "5 N/mm"
kappa_p = "0.09 mm"
normal_stiffness = 82
shear_stiffness = 36
[[blocks]]
name = "lower"
size = ["200 mm", "100 mm", "50 mm"]
material = "stone"
mesh = [2, 1, 1]
[[blocks]]
name = "upper"
size = ["200 mm", "100 mm", "50 mm"]
at = [0, 0, "50 mm"]
material = "stone"
mesh = [4, 2, 1]
[[contacts]]
slave = "upper.bottom"
master = "lower.top"
interface = "joint"
[[supports]]
on = "lower.bottom"
"#;

const SHEARED: &str = r#"
[[steps]]
kind = "preload"
face = "upper.top"
pressure = "0.5 MPa"
[[steps]]
kind = "drive"
face = "upper.top"
direction = "x"
displacement = "0.6 mm"
free = ["z"]
"#;

const PRESSED: &str = r#"
[[steps]]
kind = "drive"
face = "upper.top"
direction = "z"
displacement = "-2 mm"
"#;

/// Records rows and the last frame.
#[derive(Default)]
struct Kept(Vec<HistoryRow>, Frame);

impl Recorder for Kept {
    fn take(
        &mut self,
        _: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        self.0.push(row.clone());
        if let Some(frame) = frame {
            self.1 = frame.clone();
        }
        Ok(true)
    }
}

fn model(steps: &str) -> (Deck, Model) {
    let deck = Deck::from_str(&format!("{CAP}{steps}"), "cap.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    (deck, model)
}

fn largest(rows: &[HistoryRow], sign: f64) -> f64 {
    rows.iter()
        .map(|row| sign * row.force_kN)
        .fold(0.0, f64::max)
}

#[test]
fn the_registry_and_the_kinds_of_decks_are_the_same() {
    let names = [JointKind::CohesiveFrictional, JointKind::Cap].map(JointKind::name);
    assert_eq!(names, registry::KINDS);
    assert_eq!(JointKind::default().name(), "cohesive-frictional");
    let (deck, model) = model(SHEARED);
    assert_eq!(model.contact.laws[0].name(), "cap");
    assert_eq!(deck.interface("joint").unwrap().stiffness(), [82.0, 36.0]);
    let notes = check(&deck, &model).notes;
    assert!(
        notes.iter().any(|n| n.contains("cap law, f_m = 10.5 MPa")),
        "{notes:?}"
    );
    // Writing and reading the deck gives the same deck.
    let again = Deck::from_str(&deck.to_toml().unwrap(), "again.toml").unwrap();
    assert_eq!(again.interfaces, deck.interfaces);
}

#[test]
fn keys_that_do_not_fit_are_named() {
    let with = |from: &str, to: &str| {
        let text = format!("{CAP}{SHEARED}").replace(from, to);
        Deck::from_str(&text, "cap.toml").unwrap_err().to_string()
    };
    for (from, to, said) in [
        ("f_m = \"10.5 MPa\"\n", "", "`f_m` is missing"),
        ("G_II = \"0.125 N/mm\"\n", "", "`G_II` is missing"),
        ("mu = 0.6", "mu = 0.6\nzeta = 2", "a key of kind"),
        ("kind = \"cap\"\n", "", "a key of kind"),
        (
            "f_t = \"0.25 MPa\"",
            "f_t = \"0.6 MPa\"",
            "where friction ends",
        ),
        ("mu = 0.6", "mu = 0.6\ntan_psi = 0.7", "would give energy"),
        (
            "G_fc = \"5 N/mm\"",
            "G_fc = \"0.6 N/mm\"",
            "spent before the peak",
        ),
        (
            "c = \"0.35 MPa\"",
            "c = \"0.6 MPa\"",
            "does not hold the cohesion",
        ),
        ("kind = \"cap\"", "kind = \"glue\"", "glue"),
    ] {
        let error = with(from, to);
        assert!(error.contains(said), "{said}: {error}");
    }
}

#[test]
fn a_couplet_slides_and_crushes_at_its_strengths() {
    let mut kept = Kept::default();
    wythe::solve::run(&model(SHEARED).1, &mut kept).unwrap();
    // c + tan φ 0.5 MPa on 200 × 100 mm; the peak is found within 0.5 %, and the other edge unloads slightly.
    let exact = (0.35 + 0.75 * 0.5) * 20.0;
    let peak = largest(&kept.0, 1.0);
    assert!((peak / exact - 1.0).abs() < 0.03, "{peak} {exact}");
    let names: Vec<&str> = kept
        .1
        .interfaces
        .outputs
        .iter()
        .map(|output| &*output.name)
        .collect();
    assert_eq!(names, ["plastic_opening", "plastic_slip", "crushing"]);
    let slip = &kept.1.interfaces.outputs[1].values;
    assert!(slip.iter().any(|s| *s > 0.3) && slip.iter().all(|s| s.is_finite()));

    let mut kept = Kept::default();
    wythe::solve::run(&model(PRESSED).1, &mut kept).unwrap();
    let peak = largest(&kept.0, -1.0).max(largest(&kept.0, 1.0));
    // f_m on 200 × 100 mm. The edges of blocks that expand under pressure slide, which affects the cap.
    assert!((peak / 210.0 - 1.0).abs() < 0.02, "{peak}");
}

#[test]
fn point_results_include_the_outputs_of_the_law() {
    let law = model(SHEARED).0.interface("joint").unwrap();
    let names = ["D", "plastic_opening", "plastic_slip", "crushing"];
    assert_eq!(*point::interface_layout(&law).state, names);
    let rows = [Row {
        time: 1.0,
        targets: [0.01, 0.0, 0.0].map(Target::Strain),
    }];
    let walk = point::interface_path(&law, &rows, std::num::NonZeroUsize::MIN);
    let history = walk.records[0].state.history;
    let told = point::interface_outputs(&law, &history);
    assert_eq!(told[..2], [history.damage, history.slots[0]]);
    assert!(told[0] > 0.0 && told[1] > 0.0);
}

/// Elastic up to a slip beyond which the law has no solution.
#[derive(Debug)]
struct Breaks([f64; 2]);

impl JointLaw for Breaks {
    fn name(&self) -> &'static str {
        "breaks at 0.1 mm"
    }
    fn stiffness(&self) -> [f64; 2] {
        self.0
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let [n, s] = self.0;
        let tangent = nalgebra::Matrix3::from_diagonal(&[n, s, s].into());
        let mut traction = [n * gap[0], s * gap[1], s * gap[2]];
        if gap[1].abs() > 0.1 {
            traction[1] = f64::NAN;
        }
        let none = [[0.0; 3]; 2];
        InterfaceResponse::new(
            old, gap, traction, tangent, none, 0.0, [0.0; 4], self.0, 1e9,
        )
    }
}

#[test]
fn a_law_without_a_solution_ends_the_run_with_its_name() {
    let mut model = model(SHEARED).1;
    for law in &mut model.contact.laws {
        *law = InterfaceLaw::custom(Breaks(law.stiffness()));
    }
    let error = wythe::solve::run(&model, &mut Kept::default()).unwrap_err();
    assert!(matches!(error, RunError::JointLaw { .. }), "{error}");
    assert!(error.to_string().contains("breaks at 0.1 mm"), "{error}");
}
