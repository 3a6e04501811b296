//! Elements as the solver evaluates them, against the law applied to each point.

use crate::common::{Random, brick, mortar};
use nalgebra::{Matrix6, Rotation3, Vector3, Vector6};
use wythe::assembly::bulk;
use wythe::assembly::bulk::{ElementSlot, Marks};
use wythe::assembly::pattern::CELL;
use wythe::assembly::{Evaluation, Solids, Turning};
use wythe::element::Formulation;
use wythe::element::hex8::CORNERS;
use wythe::element::{Corotated, ElementShape};
use wythe::material::{
    DamagePlasticityParameters, Material, MaterialHistory, MaterialParameters, PointEnergy,
    elastic_stiffness,
};

/// An element and all its results.
struct One {
    shape: ElementShape,
    law: Material,
    old: [MaterialHistory; 8],
    new: [MaterialHistory; 8],
    marks: Marks,
    force: [[f64; 3]; 8],
    cell: Vec<f64>,
    energy: PointEnergy,
}

impl One {
    fn evaluate(&mut self, x: &[[f64; 3]; 8], solids: Solids, tangent: bool) {
        let setting = Evaluation {
            dt: 0.3,
            solids,
            shifted: true,
            tangent,
            turning: Turning::Ignored,
        };
        let mut slot = ElementSlot {
            force: &mut self.force,
            cell: &mut self.cell,
            written: &mut false,
            new: &mut self.new,
            energy: &mut self.energy,
            marks: &mut self.marks,
            kept: None,
        };
        bulk::element(&self.shape, &self.law, x, &self.old, setting, &mut slot)
            .expect("a sound element");
        assert_eq!(self.marks, Marks::of(&self.old, &self.new));
    }

    /// Compares with [`Material::update`] at every point.
    fn compare(&self, x: &[[f64; 3]; 8], solids: Solids) {
        let shape = &self.shape;
        let frame = Corotated::new(shape, x).expect("a sound element");
        let strains = shape.strains(&frame.local);
        let answers: Vec<_> = strains
            .iter()
            .zip(&self.old)
            .map(|(e, old)| self.law.update(e, old, 0.3, true).expect("an answer"))
            .collect();
        let stresses = std::array::from_fn(|g| answers[g].stress);
        let local = shape.internal_force(&stresses);
        let force = frame.force(shape, &local);
        let e = shape.elastic_stiffness()[0][0][0][0];
        let large = e * frame
            .local
            .as_flattened()
            .iter()
            .fold(0.0, |m: f64, u| m.max(u.abs()));
        for (found, exact) in self.force.as_flattened().iter().zip(force.as_flattened()) {
            // Tolerance: rounding of sums of some hundred terms, and the tolerance of the return map.
            assert!((found - exact).abs() <= 1e-11 * large, "{found} {exact}");
        }
        let mut energy = PointEnergy::default();
        let mut alike = true;
        let mut tangents = [Matrix6::zeros(); 8];
        for g in 0..8 {
            let (found, answer) = (&self.new[g], &answers[g]);
            let (exact, old) = (&answer.history, &self.old[g]);
            energy.add(&answer.energy, shape.weight[g]);
            let near = |a: f64, b: f64, of: f64| (a - b).abs() <= 1e-10 * of;
            let strain = strains[g].amax() + old.plastic_strain.amax();
            for k in 0..6 {
                assert!(near(
                    found.plastic_strain[k],
                    exact.plastic_strain[k],
                    strain
                ));
                assert!(near(
                    found.viscous_strain[k],
                    exact.viscous_strain[k],
                    strain
                ));
                assert!(near(
                    found.viscous_strain_step[k],
                    exact.viscous_strain_step[k],
                    strain
                ));
                let stress = exact.stress.amax() + 1.0;
                assert!(
                    near(found.stress[k], exact.stress[k], stress),
                    "{found:?} {exact:?}"
                );
            }
            assert!(near(found.kappa_t, exact.kappa_t, strain));
            assert!(near(found.kappa_c, exact.kappa_c, strain));
            for (a, b) in [
                (found.damage, exact.damage),
                (found.viscous_damage, exact.viscous_damage),
                (found.viscous_damage_step, exact.viscous_damage_step),
                (found.tensile_damage, exact.tensile_damage),
                (found.compressive_damage, exact.compressive_damage),
            ] {
                // Damage per strain is up to some 1e4.
                assert!((a - b).abs() <= 1e-9, "{a} {b}");
            }
            let yields = |h: &MaterialHistory| h.kappa_t > old.kappa_t || h.kappa_c > old.kappa_c;
            alike &= yields(found) == yields(exact);
            let intact = 1.0 - exact.viscous_damage;
            tangents[g] = match (&self.law, solids) {
                (_, Solids::Implicit) | (Material::Elastic(_), _) => answer.tangent,
                (Material::DamagePlasticity(law), Solids::Softened) if yields(exact) => {
                    law.bounded(&answer.tangent, intact)
                }
                (Material::DamagePlasticity(law), _) => law.secant_stiffness(intact),
                (law, Solids::Softened) if yields(exact) => {
                    law.law().bounded(&answer.tangent, intact)
                }
                (law, _) => elastic_stiffness(law.law().elastic()) * intact,
            };
        }
        let work = large
            * frame
                .local
                .as_flattened()
                .iter()
                .fold(0.0, |m: f64, u| m.max(u.abs()));
        for (found, exact) in [
            (self.energy.elastic, energy.elastic),
            (self.energy.plastic_damage, energy.plastic_damage),
            (self.energy.recovery, energy.recovery),
            (self.energy.viscous, energy.viscous),
        ] {
            assert!((found - exact).abs() <= 1e-9 * work, "{found} {exact}");
        }
        // Within rounding of the yield surface either tangent may result.
        if alike {
            let mut cell = vec![0.0; CELL];
            frame.stiffness(shape, &shape.stiffness(&tangents), &local, &mut cell);
            for (found, exact) in self.cell.iter().zip(&cell) {
                // Tolerance: rounding, and near coinciding principal stresses that of their directions.
                assert!(
                    (found - exact).abs() <= 1e-8 * e,
                    "{solids:?}: {found} {exact}"
                );
            }
        }
    }
}

fn random_parameters(random: &mut Random) -> DamagePlasticityParameters {
    let mut p = if random.uniform() < 0.5 {
        brick()
    } else {
        mortar(2300.0)
    };
    p.elastic.nu = 0.05 + 0.3 * random.uniform();
    p.dilation_angle = 0.05 + 0.5 * random.uniform();
    p.eccentricity = 0.02 + random.uniform();
    p.fb0_fc0 = 1.01 + 0.3 * random.uniform();
    p.k_c = 0.52 + 0.4 * random.uniform();
    p.compression_recovery = random.uniform();
    p.tension_recovery = 0.5 * random.uniform();
    if random.uniform() < 0.5 {
        p.viscosity = 0.2 * random.uniform();
    }
    p
}

const ALL: [Solids; 3] = [Solids::Implicit, Solids::Secant, Solids::Softened];

/// Walks of random displacements from well inside the yield surface to far beyond it, in both directions. In every
/// third walk the step is reduced so that the first point to yield lies exactly on its surface.
#[test]
fn elements_equal_the_law_at_each_point() {
    let mut random = Random(71);
    let (mut whole, mut mixed, mut damaged) = (0, 0, 0);
    for walk in 0..300 {
        let p = random_parameters(&mut random);
        let elastic = p.elastic;
        let parameters = if walk % 10 == 9 {
            MaterialParameters::Elastic(elastic)
        } else {
            MaterialParameters::DamagePlasticity(p)
        };
        let corners = CORNERS.map(|c| {
            let size = [25.0, 24.0, 12.0];
            [0, 1, 2].map(|i| size[i] * (c[i] + 0.1 * random.signed()))
        });
        let formulation = [
            Formulation::Full,
            Formulation::BBar,
            Formulation::Incompatible,
        ][walk % 3];
        let shape = ElementShape::new(&corners, formulation, &elastic).expect("a sound element");
        let (law, _) = Material::new(&parameters, None).expect("a sound table");
        let virgin = [MaterialHistory::default(); 8];
        let mut one = One {
            shape,
            law,
            old: virgin,
            new: virgin,
            marks: Marks::default(),
            force: [[0.0; 3]; 8],
            cell: vec![0.0; CELL],
            energy: PointEnergy::default(),
        };
        let turn = Rotation3::new(Vector3::from_fn(|_, _| 0.5 * random.signed()));
        let strength = 10.0_f64.powf(-5.0 + 2.0 * random.uniform());
        // Every other walk is uneven: some points yield, others do not.
        let (even, uneven) = if walk % 2 == 0 {
            (1.0, 3.0)
        } else {
            (0.2, 12.0)
        };
        let mut gradient = nalgebra::Matrix3::zeros();
        let mut rough = [Vector3::zeros(); 8];
        for step in 0..8 {
            let change = nalgebra::Matrix3::from_fn(|_, _| even * strength * random.signed());
            let noise: [Vector3<f64>; 8] = std::array::from_fn(|_| {
                Vector3::from_fn(|_, _| uneven * strength * random.signed())
            });
            let at = |part: f64| -> [[f64; 3]; 8] {
                std::array::from_fn(|a| {
                    let x = Vector3::from(corners[a]);
                    let u = (gradient + change * part) * x + rough[a] + noise[a] * part;
                    (turn * (x + u)).into()
                })
            };
            let mut part = 1.0;
            if walk % 3 == 0 && step == 0 {
                let (mut low, mut high) = (0.0, 1.0);
                while high - low > f64::EPSILON * high {
                    part = 0.5 * (low + high);
                    one.evaluate(&at(part), Solids::Secant, false);
                    let yields = one.new.iter().any(|h| h.kappa_t + h.kappa_c > 0.0);
                    *(if yields { &mut high } else { &mut low }) = part;
                }
            }
            // Distant iterates come first: they must leave no trace.
            one.evaluate(&at(2.0), Solids::Secant, true);
            let x = at(part);
            for solids in ALL {
                one.evaluate(&x, solids, true);
                one.compare(&x, solids);
                let (force, cell) = (one.force, one.cell.clone());
                one.evaluate(&x, solids, false);
                assert_eq!((force, &cell), (one.force, &one.cell));
            }
            // With frozen histories the solids have the same forces.
            one.evaluate(&x, Solids::Secant, true);
            let (force, cell) = (one.force, one.cell.clone());
            one.evaluate(&x, Solids::Held, true);
            let scale = one.shape.elastic_stiffness()[0][0][0][0];
            for (a, b) in force.as_flattened().iter().zip(one.force.as_flattened()) {
                assert!((a - b).abs() < 1e-11 * scale, "{a} {b}");
            }
            for (a, b) in cell.iter().zip(&one.cell) {
                assert!((a - b).abs() < 1e-9 * scale, "{a} {b}");
            }
            match one.marks.new {
                0 => whole += 1,
                0xff => damaged += 1,
                _ => mixed += 1,
            }
            gradient += change * part;
            for a in 0..8 {
                rough[a] += noise[a] * part;
            }
            one.old = one.new;
            one.marks = Marks::of(&one.old, &one.new);
        }
    }
    assert!(
        whole > 100 && mixed > 100 && damaged > 100,
        "{whole} {mixed} {damaged}"
    );
}

/// NaN strains are reported by the law, for any material.
#[test]
fn nan_strains_are_rejected() {
    let corners = CORNERS.map(|c| c.map(|c| 10.0 * c));
    for parameters in [
        MaterialParameters::Elastic(brick().elastic),
        MaterialParameters::DamagePlasticity(brick()),
    ] {
        let shape = ElementShape::new(&corners, Formulation::Incompatible, &brick().elastic)
            .expect("a sound element");
        let (law, _) = Material::new(&parameters, None).expect("a sound table");
        let mut new = [MaterialHistory::default(); 8];
        let mut x = corners;
        x[3][1] = f64::NAN;
        let setting = Evaluation {
            dt: 1.0,
            solids: Solids::Secant,
            shifted: true,
            tangent: true,
            turning: Turning::Ignored,
        };
        let mut slot = ElementSlot {
            force: &mut [[0.0; 3]; 8],
            cell: &mut vec![0.0; CELL],
            written: &mut false,
            new: &mut new,
            energy: &mut PointEnergy::default(),
            marks: &mut Marks::default(),
            kept: None,
        };
        let old = [MaterialHistory::default(); 8];
        let answer = bulk::element(&shape, &law, &x, &old, setting, &mut slot);
        assert!(answer.is_err());
        let _: Vector6<f64> = new[0].stress;
    }
}
