//! The trait of solid laws: all registered laws with the generic checks, and user-defined laws in elements and runs.

use std::sync::Arc;

use crate::common::{brick, mortar};
use nalgebra::Vector6;
use wythe::assembly::bulk::{self, ElementSlot, Marks};
use wythe::assembly::pattern::CELL;
use wythe::assembly::{Evaluation, Solids, Turning};
use wythe::deck::Deck;
use wythe::deck::schema::registry::SOLIDS;
use wythe::element::hex8::CORNERS;
use wythe::element::{Corotated, ElementShape, Formulation};
use wythe::material::{
    DamagePlasticity, DamagePlasticityParameters, ElasticParameters, Increment, LawOutput,
    LocalFailure, Material, MaterialHistory, MaterialParameters, PointEnergy, Response, Slot,
    SolidLaw, elastic_stiffness, hooke,
};
use wythe::model::Model;
use wythe::point::checks::{self, CheckError, Paths};
use wythe::solve::{self, Recorder};
use wythe::state::{Frame, HistoryRow, Status};

/// A material of each kind, and a step length that exercises the law.
fn sample(kind: &str) -> (&'static str, f64) {
    match kind {
        "damage-plasticity" => (
            r"E = 16700
            nu = 0.15
            tension = [[3.5, 0, 0], [0.3, 0.002, 0.95]]
            compression = [[11.0, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]",
            1e-4,
        ),
        "drucker-prager" => (
            r#"E = 8000
            nu = 0.2
            c = 3
            phi = "40 deg"
            psi = "15 deg"
            f_t = 1
            G_I = 0.05
            G_c = 10"#,
            1e-4,
        ),
        _ => panic!("give the kind {kind} a sample"),
    }
}

#[test]
fn every_registered_law_passes_the_checks() {
    for line in &SOLIDS {
        let (keys, step) = sample(line.name);
        let text = format!(
            "format = 1\n[materials.m]\nkind = \"{}\"\n{keys}\n",
            line.name
        );
        let deck = Deck::from_str(&text, "laws").unwrap();
        let (law, _) = deck.law("m", Some(50.0)).unwrap();
        assert_eq!(law.law().name(), line.name);
        checks::all(law.law(), &Paths::of_step(step)).unwrap();
    }
    let elastic = brick().elastic;
    checks::all(&elastic, &Paths::of_step(1e-3)).unwrap();
}

/// Deliberate error of a test law.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flaw {
    None,
    Tangent,
    Energy,
    Stress,
    Gives,
    Turns,
    /// Not finite above this first normal strain.
    NotFinite(f64),
}

/// Damage d = 1 − e^(−κ/κ_f) of the largest κ = √(ε:ε) so far, beyond a strain κ_0.
#[derive(Clone, Debug)]
struct Damage {
    elastic: ElasticParameters,
    flaw: Flaw,
}

const FIRST: f64 = 2e-4;
const LAST: f64 = 1e-3;

impl SolidLaw for Damage {
    fn name(&self) -> &'static str {
        "test-damage"
    }

    fn elastic(&self) -> &ElasticParameters {
        &self.elastic
    }

    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        _: Increment,
    ) -> Result<Response, LocalFailure> {
        let half = Vector6::new(1.0, 1.0, 1.0, 0.5, 0.5, 0.5);
        let tensor = strain.component_mul(&half);
        let size = tensor.dot(strain).sqrt();
        let kappa = (size - FIRST).max(0.0);
        let mut history = *old;
        let elastic = hooke(&self.elastic, strain);
        let mut tangent = elastic_stiffness(&self.elastic);
        let grows = kappa > old.kappa_t;
        if grows {
            history.kappa_t = kappa;
            history.damage = 1.0 - (-kappa / LAST).exp();
            history.tensile_damage = history.damage;
        }
        let intact = 1.0 - history.damage;
        tangent *= intact;
        if grows {
            tangent -= elastic * tensor.transpose() * (intact / (LAST * size));
        }
        if self.flaw == Flaw::Tangent && grows {
            tangent[(0, 1)] *= 1.001;
        }
        let mut stress = elastic * intact;
        match self.flaw {
            Flaw::Stress => stress[2] += 1e-3,
            Flaw::Turns => stress = elastic * intact * (1.0 + strain[3].signum() * 1e-3),
            Flaw::NotFinite(limit) if strain[0] > limit => stress[0] = f64::NAN,
            Flaw::Gives => history.damage = 0.0,
            _ => {}
        }
        let mut response = Response::inviscid(strain, old, stress, tangent, history);
        if self.flaw == Flaw::Energy {
            response.energy.plastic_damage *= 1.01;
        }
        Ok(response)
    }

    fn outputs(&self) -> &'static [LawOutput] {
        &[LawOutput {
            name: "largest_strain",
            unit: "1",
            slot: Slot::KappaT,
        }]
    }
}

fn damage(flaw: Flaw) -> Damage {
    Damage {
        elastic: ElasticParameters {
            E: 10_000.0,
            nu: 0.2,
            density: 0.0,
        },
        flaw,
    }
}

#[test]
fn the_checks_find_wrong_laws() {
    let paths = Paths::of_step(1e-4);
    checks::all(&damage(Flaw::None), &paths).unwrap();
    let tangent = checks::tangent(&damage(Flaw::Tangent), &paths).unwrap_err();
    assert!(
        matches!(
            tangent.what,
            CheckError::Tangent {
                row: 0,
                column: 1,
                ..
            }
        ),
        "{tangent}"
    );
    let energy = checks::balance(&damage(Flaw::Energy), &paths).unwrap_err();
    assert!(energy.to_string().contains("dissipation"), "{energy}");
    checks::form(&damage(Flaw::Stress), &paths).unwrap_err();
    checks::objectivity(&damage(Flaw::Turns), &paths).unwrap_err();
    checks::form(&damage(Flaw::Gives), &paths).unwrap_err();
    let nan = checks::form(&damage(Flaw::NotFinite(5e-4)), &paths).unwrap_err();
    assert!(
        nan.to_string().contains("`test-damage` gave a stress"),
        "{nan}"
    );
}

/// Plastic strain against the stress creates energy.
#[test]
fn negative_dissipation_is_found() {
    #[derive(Debug)]
    struct Giving(ElasticParameters);
    impl SolidLaw for Giving {
        fn name(&self) -> &'static str {
            "giving"
        }
        fn elastic(&self) -> &ElasticParameters {
            &self.0
        }
        fn update(
            &self,
            strain: &Vector6<f64>,
            old: &MaterialHistory,
            _: Increment,
        ) -> Result<Response, LocalFailure> {
            let history = MaterialHistory {
                plastic_strain: strain * -0.1,
                ..*old
            };
            let stress = hooke(&self.0, &(strain - history.plastic_strain));
            let tangent = elastic_stiffness(&self.0) * 1.1;
            Ok(Response::inviscid(strain, old, stress, tangent, history))
        }
    }
    let law = Giving(brick().elastic);
    let paths = Paths::of_step(1e-4);
    checks::form(&law, &paths).unwrap();
    checks::tangent(&law, &paths).unwrap();
    checks::balance(&law, &paths).unwrap();
    let found = checks::dissipation(&law, &paths).unwrap_err();
    assert!(matches!(found.what, CheckError::Dissipation(_)), "{found}");
}

/// Damage plasticity as a user-defined law with the defaults of the trait.
#[derive(Debug)]
struct Outside(DamagePlasticity);

impl SolidLaw for Outside {
    fn name(&self) -> &'static str {
        "outside"
    }

    fn elastic(&self) -> &ElasticParameters {
        self.0.elastic()
    }

    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        increment: Increment,
    ) -> Result<Response, LocalFailure> {
        SolidLaw::update(&self.0, strain, old, increment)
    }
}

/// Results of an element.
type Written = ([[f64; 3]; 8], Vec<f64>, [MaterialHistory; 8], PointEnergy);

fn evaluate(
    law: &Material,
    shape: &ElementShape,
    x: &[[f64; 3]; 8],
    solids: Solids,
    old: &[MaterialHistory; 8],
) -> Written {
    let mut new = *old;
    let mut marks = Marks::of(old, &new);
    let (mut force, mut cell) = ([[0.0; 3]; 8], vec![0.0; CELL]);
    let mut energy = PointEnergy::default();
    let setting = Evaluation {
        dt: 1.0,
        solids,
        shifted: true,
        tangent: true,
        turning: Turning::Ignored,
    };
    let mut slot = ElementSlot {
        force: &mut force,
        cell: &mut cell,
        written: &mut false,
        new: &mut new,
        energy: &mut energy,
        marks: &mut marks,
        kept: None,
    };
    bulk::element(shape, law, x, old, setting, &mut slot).unwrap();
    (force, cell, new, energy)
}

#[test]
fn an_element_gives_the_same_results_with_a_user_defined_law() {
    let near = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-11 * scale;
    for p in [brick(), mortar(2300.0)] {
        let p = DamagePlasticityParameters {
            viscosity: 0.1,
            ..p
        };
        let (law, _) = DamagePlasticity::new(&p, None).unwrap();
        let corners = CORNERS.map(|c| c.map(|v| 20.0 * v));
        let shape = ElementShape::new(&corners, Formulation::Incompatible, &p.elastic).unwrap();
        let inside = Material::DamagePlasticity(Box::new(law.clone()));
        let outside = Material::Custom(Arc::new(Outside(law)));
        // One edge is pulled more than the other, so that some points yield and some do not.
        let pulled = |by: f64| {
            corners.map(|[x, y, z]| {
                let stretch = by * (1.0 + 0.04 * y) * z;
                [x, y + 0.3 * by * z, z + stretch]
            })
        };
        let virgin = [MaterialHistory::default(); 8];
        let mut cracked = virgin;
        for (by, old) in [(1e-5, 0), (3e-4, 0), (6e-4, 0), (8e-4, 1), (2e-4, 1)] {
            let old = if old == 0 { virgin } else { cracked };
            let x = pulled(by);
            Corotated::new(&shape, &x).unwrap();
            for solids in [
                Solids::Implicit,
                Solids::Secant,
                Solids::Softened,
                Solids::Extrapolated { ratio: 0.7 },
            ] {
                let (force, cell, new, energy) = evaluate(&inside, &shape, &x, solids, &old);
                let other = evaluate(&outside, &shape, &x, solids, &old);
                let scale = p.elastic.E * 20.0;
                for (a, b) in force.as_flattened().iter().zip(other.0.as_flattened()) {
                    assert!(near(*a, *b, scale), "{solids:?} {by}: {a} {b}");
                }
                for (a, b) in cell.iter().zip(&other.1) {
                    assert!(near(*a, *b, scale), "{solids:?} {by}: {a} {b}");
                }
                for (a, b) in new.iter().zip(&other.2) {
                    assert!((a.kappa_t - b.kappa_t).abs() < 1e-14);
                    assert!((a.viscous_damage - b.viscous_damage).abs() < 1e-9);
                }
                assert!(near(energy.elastic, other.3.elastic, scale));
                if by == 6e-4 {
                    cracked = evaluate(&inside, &shape, &x, Solids::Implicit, &virgin).2;
                }
            }
        }
        assert!(cracked.iter().any(|h| h.tensile_damage > 0.0));
    }
}

const DECK: &str = r#"
format = 1
materials.stone = { E = "10 GPa", nu = 0.2 }
blocks = [{ name = "cube", size = [100, 100, 100], material = "stone", mesh = [2, 2, 2] }]
supports = [
    { on = "cube.bottom", fixed = ["z"] },
    { on = "cube.left", fixed = ["x"] },
    { on = "cube.front", fixed = ["y"] },
]
probes = [{ name = "top", near = [100, 100, 100], direction = "z" }]
[[steps]]
kind = "load"
procedure = "displacement_control"
control = { probe = "top", displacement = "0.05 mm" }
loads = [{ name = "pull", on = "cube.top", traction = [0, 0, "1 MPa"] }]
"#;

#[derive(Default)]
struct Rows(Vec<HistoryRow>, Vec<Frame>);

impl Recorder for Rows {
    fn take(
        &mut self,
        _: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        self.0.push(row.clone());
        self.1.extend(frame.cloned());
        Ok(true)
    }
}

fn model(flaw: Flaw) -> Model {
    let deck = Deck::from_str(DECK, "laws").unwrap();
    let (mut model, _) = Model::from_deck(&deck).unwrap();
    model.materials[0].parameters = MaterialParameters::custom(damage(flaw));
    model
}

#[test]
fn a_user_defined_law_runs_and_its_output_is_a_column_and_a_field() {
    let model = model(Flaw::None);
    // Those of the supports follow.
    assert_eq!(
        model.columns()[..4],
        ["top_mm", "pull_MPa", "pull_kN", "max_largest_strain"]
    );
    let mut rows = Rows::default();
    let summary = solve::run(&model, &mut rows).unwrap();
    assert_eq!(summary.status, Status::Completed);
    let last = rows.0.last().unwrap();
    // Uniaxial stress: ε_x = ε_y = −ν ε_z, √(ε:ε) = ε √(1 + 2ν²).
    let kappa = 5e-4 * (1.0_f64 + 2.0 * 0.04).sqrt() - FIRST;
    // The solver's tolerance, 5e-3 of the mean nodal force.
    assert!(
        (last.probes[3] / kappa - 1.0).abs() < 5e-3,
        "{} {kappa}",
        last.probes[3]
    );
    let force = 10_000.0 * 5e-4 * (-kappa / LAST).exp() * 10.0;
    assert!(
        (last.probes[2] / force - 1.0).abs() < 5e-3,
        "{} {force}",
        last.probes[2]
    );
    let frame = rows.1.last().unwrap();
    assert_eq!(frame.outputs[0].name, "largest_strain");
    assert_eq!(frame.outputs[0].values.len(), 8);
    assert!((frame.outputs[0].values[3] / kappa - 1.0).abs() < 5e-3);
}

#[test]
fn a_law_that_returns_nan_is_named() {
    let model = model(Flaw::NotFinite(-1.0));
    let summary = solve::run(&model, &mut Rows::default()).unwrap();
    assert_eq!(summary.status, Status::NotConverged);
    let message = &summary.message;
    assert!(
        message.contains("the law `test-damage` gave a stress that is not finite"),
        "{message}"
    );
}
