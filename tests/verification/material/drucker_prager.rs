//! Hyperbolic Drucker–Prager plasticity against closed forms.

use std::num::NonZeroUsize;

use nalgebra::{Vector3, Vector6};
use wythe::deck::Deck;
use wythe::material::{
    DruckerPrager, DruckerPragerParameters, ElasticParameters, Increment, Material,
    MaterialHistory, MaterialParameters, SolidLaw, TableError, Wanted,
};
use wythe::point::checks::{self, Paths};
use wythe::point::{Row, Target, Walk, material_path};

/// A soft limestone.
fn stone() -> DruckerPragerParameters {
    DruckerPragerParameters {
        elastic: ElasticParameters {
            E: 8000.0,
            nu: 0.2,
            density: 0.0,
        },
        cohesion: 3.0,
        friction_angle: 40_f64.to_radians(),
        dilation_angle: 15_f64.to_radians(),
        tensile_strength: 1.0,
        tension_energy: None,
        compression_energy: None,
        reference_length: None,
    }
}

/// The same, softening in tension and in compression.
fn softening() -> DruckerPragerParameters {
    DruckerPragerParameters {
        tension_energy: Some(0.05),
        compression_energy: Some(10.0),
        ..stone()
    }
}

fn law(p: &DruckerPragerParameters, l_eq: f64) -> DruckerPrager {
    DruckerPrager::new(p, Some(l_eq)).expect("sound parameters")
}

/// η, k and a of the yield surface, by the formulas of the theory page.
fn surface(p: &DruckerPragerParameters) -> [f64; 3] {
    let (sin, cos) = p.friction_angle.sin_cos();
    let eta = 6.0 * sin / (3.0 - sin);
    let (f_t, f_c) = (p.tensile_strength, 2.0 * p.cohesion * cos / (1.0 - sin));
    let k = 3.0 * (f_c - f_t) * (1.0 - eta * eta / 9.0) / (2.0 * eta);
    [eta, k, ((k - eta * f_t / 3.0).powi(2) - f_t * f_t).sqrt()]
}

/// Strain along z to `end` with the lateral stress `sides` [MPa], in `rows` rows; the lateral stress is applied
/// first.
fn axial(
    p: &DruckerPragerParameters,
    l_eq: f64,
    end: f64,
    sides: f64,
    rows: usize,
) -> Walk<6, MaterialHistory> {
    let law = Material::DruckerPrager(Box::new(law(p, l_eq)));
    let targets = |axial: Target| {
        let side = Target::Stress(sides);
        let none = Target::Stress(0.0);
        [side, side, axial, none, none, none]
    };
    let mut path = vec![Row {
        time: 0.1,
        targets: targets(Target::Stress(sides)),
    }];
    path.extend((1..=rows).map(|i| Row {
        time: 1.0 + i as f64,
        targets: targets(Target::Strain(end * i as f64 / rows as f64)),
    }));
    material_path(&law, &path, NonZeroUsize::MIN)
}

fn last_axial(walk: &Walk<6, MaterialHistory>) -> f64 {
    assert_eq!(walk.failure, None);
    walk.records.last().unwrap().state.stress[2]
}

/// Tolerance of the point driver's stresses (1e-10 MPa) and of the yield function.
const NEAR: f64 = 1e-8;

#[test]
fn uniaxial_strengths_are_those_of_the_parameters() {
    let p = stone();
    let pulled = last_axial(&axial(&p, 50.0, 1e-3, 0.0, 20));
    assert!((pulled - p.tensile_strength).abs() < NEAR, "{pulled}");
    let pressed = last_axial(&axial(&p, 50.0, -8e-3, 0.0, 20));
    let f_c = 2.0 * 3.0 * 40_f64.to_radians().cos() / (1.0 - 40_f64.to_radians().sin());
    assert!((pressed + f_c).abs() < NEAR, "{pressed} {f_c}");
}

#[test]
fn triaxial_compression_is_on_the_hyperbola_and_tends_to_the_cone() {
    let p = stone();
    let [eta, k, a] = surface(&p);
    let mut before = f64::INFINITY;
    for sides in [1.0_f64, 10.0, 100.0, 1000.0] {
        let axial = -last_axial(&axial(&p, 50.0, -0.01 - sides * 2e-3, -sides, 40));
        let (q, mean) = (axial - sides, -(axial + 2.0 * sides) / 3.0);
        let f = (q * q + a * a).sqrt() + eta * mean - k;
        assert!(f.abs() < NEAR * (1.0 + sides), "{f}");
        // √(q² + a²) − q = a²/2q − …: the distance from the cone.
        let cone = q + eta * mean - k;
        assert!(cone < 0.0 && -cone < a * a / (2.0 * q) + NEAR * (1.0 + sides));
        assert!(-cone < before);
        before = -cone;
        // The slope is that of Mohr–Coulomb in compression: dσ₁/dσ₃ → (1 + sin φ)/(1 − sin φ).
        if sides == 1000.0 {
            let slope = (1.0 + p.friction_angle.sin()) / (1.0 - p.friction_angle.sin());
            let asymptote = 3.0 * k / (3.0 - eta) + slope * sides;
            assert!(
                (axial / asymptote - 1.0).abs() < 1e-5,
                "{axial} {asymptote}"
            );
        }
    }
}

#[test]
fn the_strength_in_pure_shear_lies_on_the_hyperbola() {
    // At zero mean stress q = √3 τ = √(k² − a²). Stress-free sides allow the dilation.
    let p = stone();
    let [_, k, a] = surface(&p);
    let law = Material::DruckerPrager(Box::new(law(&p, 50.0)));
    let none = Target::Stress(0.0);
    let rows: Vec<Row<6>> = (1..=20)
        .map(|i| Row {
            time: i as f64,
            targets: [
                none,
                none,
                none,
                Target::Strain(5e-4 * i as f64),
                none,
                none,
            ],
        })
        .collect();
    let walk = material_path(&law, &rows, NonZeroUsize::MIN);
    assert_eq!(walk.failure, None);
    let tau = walk.records.last().unwrap().state.stress[3];
    assert!((tau - ((k * k - a * a) / 3.0).sqrt()).abs() < NEAR, "{tau}");
    // Dilation: the ratio of volumetric to equivalent plastic strain is η̄ √(q² + a²)/q.
    let plastic = walk.records.last().unwrap().state.history.plastic_strain;
    let sin = p.dilation_angle.sin();
    let dilation = 6.0 * sin / (3.0 - sin);
    let equivalent = plastic[3] / 3.0_f64.sqrt();
    let expected = dilation * k / (k * k - a * a).sqrt() * equivalent;
    let volume = plastic[0] + plastic[1] + plastic[2];
    assert!((volume - expected).abs() < 1e-9, "{volume} {expected}");
}

/// Work of the stress on the inelastic strain per volume, times ℓ, is the fracture energy for any ℓ.
#[test]
fn softening_dissipates_its_fracture_energy_in_elements_of_any_size() {
    let p = softening();
    for l_eq in [10.0, 50.0, 200.0] {
        for (energy, f, sign) in [(0.05, 1.0, 1.0), (10.0, p.compressive_strength(), -1.0)] {
            // ω = 6 at the end: e^(-6) remains, plus 6/1000 of the residual strength.
            let end = sign * (6.0 * energy / (f * l_eq) + f / p.elastic.E);
            let walk = axial(&p, l_eq, end, 0.0, 4000);
            assert_eq!(walk.failure, None);
            let mut work = 0.0;
            let (mut strain, mut stress) = (0.0, 0.0);
            for record in &walk.records {
                let (e, s) = (record.state.strain[2], record.state.stress[2]);
                work += 0.5 * (s + stress) * (e - strain);
                (strain, stress) = (e, s);
            }
            work -= 0.5 * stress * stress / p.elastic.E;
            let history = walk.records.last().unwrap().state.history;
            let law = law(&p, l_eq);
            let left = law.strength_left(&history);
            assert!((stress - sign * f * left).abs() < NEAR * f, "{stress}");
            // ∫ y dω from 0 to ω = r ω + (1 − r)(1 − e^(-ω)); the error of steps of 6/4000 is half a step.
            let r = wythe::material::drucker_prager::RESIDUAL;
            let omega = -((left - r) / (1.0 - r)).ln();
            let expected = energy * (r * omega + (1.0 - r) * (1.0 - (-omega).exp()));
            let found = work * l_eq;
            assert!(
                (found / expected - 1.0).abs() < 2e-3,
                "{l_eq}: {found} {expected}"
            );
            let damage = [history.tensile_damage, history.compressive_damage];
            let [own, other] = if sign > 0.0 {
                damage
            } else {
                [damage[1], damage[0]]
            };
            assert!(
                (own - (1.0 - left)).abs() < 1e-12 && other == 0.0,
                "{damage:?}"
            );
        }
    }
}

#[test]
fn elements_that_would_snap_back_are_rejected() {
    let p = softening();
    let [tension, compression] = p.longest();
    assert!((tension - 8000.0 * 0.05).abs() < 1e-9);
    assert!(DruckerPrager::new(&p, Some(0.999 * tension)).is_ok());
    let refused = DruckerPrager::new(&p, Some(1.001 * tension.min(compression)));
    assert!(
        matches!(refused, Err(TableError::TooBrittle { .. })),
        "{refused:?}"
    );
}

#[test]
fn hydrostatic_tension_returns_to_the_vertex() {
    let p = stone();
    let [eta, k, a] = surface(&p);
    let law = law(&p, 50.0);
    let increment = Increment {
        dt: 1.0,
        tangent: Wanted::Everywhere,
    };
    let strain = Vector6::new(1e-3, 1e-3, 1e-3, 0.0, 0.0, 0.0);
    let answer = law
        .update(&strain, &MaterialHistory::default(), increment)
        .unwrap();
    for i in 0..3 {
        assert!(
            (answer.stress[i] - (k - a) / eta).abs() < NEAR,
            "{}",
            answer.stress
        );
    }
    // The point is at its limit: the volumetric stiffness is zero.
    let volume = answer.tangent * Vector6::new(1.0, 1.0, 1.0, 0.0, 0.0, 0.0);
    assert!(volume.amax() < 1e-8 * p.elastic.E, "{volume}");
}

/// With equal friction and dilation and without softening the flow is associated: the tangent is symmetric.
#[test]
fn associated_flow_has_a_symmetric_tangent() {
    let p = DruckerPragerParameters {
        dilation_angle: stone().friction_angle,
        ..stone()
    };
    let increment = Increment {
        dt: 1.0,
        tangent: Wanted::Everywhere,
    };
    let strain = Vector6::new(15e-4, -6e-3, 3e-4, 18e-4, -9e-4, 6e-4);
    let virgin = MaterialHistory::default();
    let answer = law(&p, 50.0).update(&strain, &virgin, increment).unwrap();
    assert!(answer.history.kappa_c > 0.0);
    let skew = answer.tangent - answer.tangent.transpose();
    assert!(skew.amax() < 1e-10 * p.elastic.E, "{skew}");
}

#[test]
fn the_part_of_the_yield_stress_is_one_on_the_surface() {
    let p = stone();
    let law = law(&p, 50.0);
    let f_c = p.compressive_strength();
    let [eta, k, a] = surface(&p);
    let apex = (k - a) / eta;
    for stress in [
        Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        Vector6::new(0.0, -f_c, 0.0, 0.0, 0.0, 0.0),
        Vector6::new(apex, apex, apex, 0.0, 0.0, 0.0),
    ] {
        let part = law.reached(&stress).unwrap();
        assert!((part - 1.0).abs() < 1e-12, "{part}");
        assert!((law.reached(&(stress * 0.3)).unwrap() - 0.3).abs() < 1e-12);
    }
    assert_eq!(
        law.reached(&-Vector6::new(apex, apex, apex, 0.0, 0.0, 0.0)),
        Some(0.0)
    );
}

#[test]
fn random_paths_pass_all_checks() {
    let associated = |p: DruckerPragerParameters| DruckerPragerParameters {
        dilation_angle: p.friction_angle,
        ..p
    };
    let dilating_little = DruckerPragerParameters {
        dilation_angle: 0.002,
        ..softening()
    };
    for p in [
        stone(),
        softening(),
        associated(stone()),
        associated(softening()),
        dilating_little,
    ] {
        for strain in [3e-5, 3e-4] {
            checks::all(&law(&p, 50.0), &Paths::of_step(strain)).unwrap();
        }
    }
}

/// A single step across the whole softening range also has a solution.
#[test]
fn one_large_step_finds_its_root() {
    let law = law(&softening(), 100.0);
    let increment = Increment {
        dt: 1.0,
        tangent: Wanted::Everywhere,
    };
    for size in [1e-4, 1e-3, 1e-2, 0.1, 1.0] {
        for direction in [
            Vector3::new(1.0, 0.0, 0.0),
            Vector3::new(1.0, 1.0, 1.0),
            Vector3::new(-1.0, -1.0, -0.2),
            Vector3::new(0.5, -1.0, 0.5),
        ] {
            let d = direction * size;
            let strain = Vector6::new(d.x, d.y, d.z, 0.3 * size, 0.0, 0.0);
            let answer = law
                .update(&strain, &MaterialHistory::default(), increment)
                .unwrap();
            let f = law.yield_function(&answer.stress, &answer.history);
            // Tolerance: rounding of a trial stress of 10⁴ MPa times the size.
            assert!(f < 1e-9 * (1.0 + 1e4 * size), "{size} {direction}: {f}");
        }
    }
}

const DECK: &str = r#"
format = 1
[materials.stone]
kind = "drucker-prager"
E = "8 GPa"
nu = 0.2
c = "3 MPa"
phi = "40 deg"
psi = "15 deg"
f_t = "1 MPa"
"#;

#[test]
fn a_deck_names_the_law() {
    let deck = Deck::from_str(DECK, "stone").unwrap();
    let MaterialParameters::DruckerPrager(p) = deck.material("stone").unwrap() else {
        panic!("another law");
    };
    assert_eq!(p, stone());
    // Writing and reading the deck gives the same deck.
    let again = Deck::from_str(&deck.to_toml().unwrap(), "stone").unwrap();
    assert_eq!(again.materials, deck.materials);
    let associated = Deck::from_str(&DECK.replace("psi = \"15 deg\"\n", ""), "stone").unwrap();
    let MaterialParameters::DruckerPrager(p) = associated.material("stone").unwrap() else {
        panic!("another law");
    };
    assert_eq!(p.dilation_angle, p.friction_angle);
}

#[test]
fn keys_of_another_law_and_missing_ones_are_errors() {
    let error = |from: &str, to: &str| {
        assert!(DECK.contains(from), "{from}");
        let deck = Deck::from_str(&DECK.replace(from, to), "stone");
        deck.unwrap_err().to_string()
    };
    let foreign = error("psi = \"15 deg\"", "K_c = 0.7");
    assert!(
        foreign.contains("`K_c` is not read by kind = \"drucker-prager\""),
        "{foreign}"
    );
    let missing = error("f_t = \"1 MPa\"\n", "");
    assert!(missing.contains("needs `f_t`"), "{missing}");
    let own = error("kind = \"drucker-prager\"\n", "");
    assert!(
        own.contains("is not read by kind = \"damage-plasticity\""),
        "{own}"
    );
    let strong = error("f_t = \"1 MPa\"", "f_t = \"9 MPa\"");
    assert!(strong.contains("the sharp cone"), "{strong}");
    let giving = error("psi = \"15 deg\"", "psi = \"41 deg\"");
    assert!(giving.contains("at most phi"), "{giving}");
    let unknown = error("drucker-prager", "drucker");
    assert!(unknown.contains("drucker"), "{unknown}");
}
