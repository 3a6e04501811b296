//! Random variation of bond strength between units: the draws, the laws of whole models, and the strength of single
//! joints.

use std::collections::BTreeMap;
use std::path::Path;

use crate::common::blocks::{GRAVITY, HEAD, deck};
use crate::common::scene::completed;
use wythe::contact::{CohesiveFrictional, InterfaceLaw};
use wythe::deck::scatter::{factor, factors};
use wythe::deck::{Deck, check};
use wythe::model::Model;

/// A brick wall with random variation of its joint.
fn wall(overrides: &[(&str, &str)]) -> (Deck, Model) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/03_shear_wall_j7d.toml");
    let overrides = overrides.iter().map(|(k, v)| ((*k).into(), (*v).into()));
    let deck = Deck::load(path, &overrides.collect::<Vec<_>>()).unwrap();
    let model = Model::from_deck(&deck).unwrap().0;
    (deck, model)
}

/// Ratio of the tensile strength of each unit's slave facets to `f_t` [MPa]; one value per unit.
fn strengths(model: &Model, f_t: f64) -> BTreeMap<u32, f64> {
    let contact = &model.contact;
    let mut found = BTreeMap::new();
    for (&unit, &law) in contact.slave_body.iter().zip(&contact.slave_law) {
        let bond = contact.laws[usize::from(law)].as_cohesive_frictional();
        let x = bond.unwrap().f_t / f_t;
        assert_eq!(*found.entry(unit).or_insert(x), x, "unit {unit}");
    }
    found
}

/// Relative errors of the mean and of the coefficient of variation of a sample, in standard errors. The standard
/// error of the mean is v/√N. That of the coefficient is at most √(((β−1)/4 + v²)/N) with the kurtosis β = w⁴ + 2w³ +
/// 3w² − 3, w = 1 + v², of a lognormal distribution.
fn standard_errors(sample: &[f64], cv: f64) -> [f64; 2] {
    let n = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / n;
    let squares = sample.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    let w = 1.0 + cv * cv;
    let kurtosis = w.powi(4) + 2.0 * w.powi(3) + 3.0 * w * w - 3.0;
    let spread = ((0.25 * (kurtosis - 1.0) + cv * cv) / n).sqrt();
    let measured = (squares / (n - 1.0)).sqrt() / mean;
    [
        (mean - 1.0) / (cv / n.sqrt()),
        (measured / cv - 1.0) / spread,
    ]
}

/// The probability of a deviation above four standard errors is 1/16,000. The numbers are fixed, so that the test is
/// deterministic.
const BY_CHANCE: f64 = 4.0;

#[test]
fn factors_have_the_given_mean_and_variation() {
    for cv in [0.05, 0.3, 0.8] {
        let sample: Vec<f64> = (0..100_000).map(|unit| factor(cv, 11, 0, unit)).collect();
        let [mean, spread] = standard_errors(&sample, cv);
        println!("cv {cv}: mean {mean:.2}, variation {spread:.2} standard errors off");
        assert!(mean.abs() < BY_CHANCE && spread.abs() < BY_CHANCE);
        // The median of a lognormal sample is 1/√(1+v²): half of the values below it, within √(N/4).
        let median = 1.0 / (1.0 + cv * cv).sqrt();
        let below = sample.iter().filter(|x| **x < median).count() as f64;
        let n = sample.len() as f64;
        assert!(
            (below - 0.5 * n).abs() < BY_CHANCE * 0.5 * n.sqrt(),
            "{below}"
        );
    }
}

#[test]
fn units_interfaces_and_seeds_are_independent() {
    let n = 100_000;
    let z = |seed, interface, unit| factor(0.5, seed, interface, unit).ln();
    let sample = |seed, interface, from: u32| -> Vec<f64> {
        (from..from + n)
            .map(|unit| z(seed, interface, unit))
            .collect()
    };
    let one = sample(0, 0, 0);
    for other in [
        sample(0, 0, 1),
        sample(0, 0, 18),
        sample(1, 0, 0),
        sample(0, 1, 0),
    ] {
        let mean = |of: &[f64]| of.iter().sum::<f64>() / f64::from(n);
        let (a, b) = (mean(&one), mean(&other));
        let pairs = || one.iter().zip(&other);
        let together: f64 = pairs().map(|(x, y)| (x - a) * (y - b)).sum();
        let [xx, yy] = [(&one, a), (&other, b)]
            .map(|(of, mean)| of.iter().map(|x| (x - mean).powi(2)).sum::<f64>());
        let correlation = together / (xx * yy).sqrt();
        // The standard error of a zero correlation is 1/√N.
        assert!(
            correlation.abs() < BY_CHANCE / f64::from(n).sqrt(),
            "{correlation}"
        );
    }
}

/// Values of an independent Python implementation with ChaCha20 and Box–Muller, so that a study can be repeated with
/// any version.
#[test]
fn the_numbers_never_change() {
    for (cv, seed, interface, unit, x) in [
        (0.3, 0, 0, 0, 1.1352239619478004),
        (0.3, 0, 0, 1, 1.3441769987620578),
        (0.3, 0, 0, 2, 0.8299559669367162),
        (0.3, 0, 1, 0, 0.9061358626392113),
        (0.3, 7, 0, 0, 1.5012347168413336),
        (0.3, i64::MAX as u64, 3, 4_000_000_000, 1.4035163125438432),
        (1.5, 12345, 0, 17, 1.2498960129929741),
    ] {
        // The random bits are equal; logarithm, cosine and exponential may be rounded differently on other machines.
        let found = factor(cv, seed, interface, unit);
        assert!((found / x - 1.0).abs() < 1e-13, "{found} is not {x}");
    }
    let (_, model) = wall(&[("interfaces.joint.scatter", "{ cv = 0.3, seed = 7 }")]);
    let first = strengths(&model, 0.2)[&0];
    assert!((first / 1.5012347168413336 - 1.0).abs() < 1e-13, "{first}");
}

#[test]
fn every_unit_of_a_wall_has_its_own_strength_and_nothing_else_of_its_own() {
    let many = [
        ("wall.length", "10 m"),
        ("wall.courses", "40"),
        ("wall.mesh", "[2, 2, 1]"),
        // Elements as large as bricks would snap back.
        ("materials.brick.tension", "[]"),
        ("materials.brick.compression", "[]"),
        ("materials.mortar.tension", "[]"),
        ("materials.mortar.compression", "[]"),
    ];
    let (_, plain) = wall(&many);
    let (deck, model) = wall(&[&many[..], &[("interfaces.joint.scatter.cv", "30 %")]].concat());
    let found = strengths(&model, 0.2);
    let sample: Vec<f64> = found.values().copied().collect();
    let [mean, spread] = standard_errors(&sample, 0.3);
    println!(
        "{} units: {mean:.2}, {spread:.2} standard errors off",
        sample.len()
    );
    assert!(sample.len() > 1500 && mean.abs() < BY_CHANCE && spread.abs() < BY_CHANCE);
    let told = factors(&deck, &model.contact, "joint").unwrap();
    assert_eq!(told.len(), found.len());
    for (unit, x) in told {
        assert_eq!(x, factor(0.3, 0, 0, unit));
        assert!((found[&unit] / x - 1.0).abs() < 1e-15); // once multiplied, once divided
    }
    // Per facet: the strengths contain the factor, everything else is as without variation.
    let (a, b) = (&plain.contact, &model.contact);
    assert_eq!(a.slave_facets, b.slave_facets);
    for (f, unit) in b.slave_body.iter().enumerate() {
        let bond = |law: &InterfaceLaw| *law.as_cohesive_frictional().unwrap();
        let mean = bond(&a.laws[usize::from(a.slave_law[f])]);
        let own = bond(&b.laws[usize::from(b.slave_law[f])]);
        let x = factor(0.3, 0, 0, *unit);
        assert_eq!((own.f_t, own.c), (x * mean.f_t, x * mean.c));
        let as_mean = CohesiveFrictional {
            f_t: mean.f_t,
            c: mean.c,
            ..own
        };
        assert_eq!(as_mean, mean);
        // Hence both energies contain it, up to rounding.
        assert!((own.mode_1_energy() / (x * mean.mode_1_energy()) - 1.0).abs() < 1e-14);
        assert!((own.mode_2_energy(0.0) / (x * mean.mode_2_energy(0.0)) - 1.0).abs() < 1e-14);
    }
    assert!(b.law_names.iter().all(|name| name == "joint"));
    // A unit has at most one law for each pair of stiffnesses of its facets.
    assert!(b.laws.len() <= a.laws.len() * found.len());
}

#[test]
fn the_same_seed_is_the_same_model_and_another_seed_another() {
    let contact = |scatter: &str| {
        let model = wall(&[("interfaces.joint.scatter", scatter)]).1;
        (model.contact.laws, model.contact.slave_law)
    };
    let once = contact("{ cv = 0.3, seed = 5 }");
    assert_eq!(once, contact("{ seed = 5, cv = \"30 %\" }"));
    assert_ne!(once.0, contact("{ cv = 0.3, seed = 6 }").0);
    assert_eq!(contact("{ cv = 0.3 }"), contact("{ cv = 0.3, seed = 0 }"));
    // A different coefficient scales the same draws: the order of the units remains.
    let (one, other) = (contact("{ cv = 0.1 }").0, contact("{ cv = 0.5 }").0);
    for (a, b) in one.windows(2).zip(other.windows(2)) {
        let [a, b] = [a, b].map(|pair| {
            let f_t = |law: &InterfaceLaw| law.as_cohesive_frictional().unwrap().f_t;
            f_t(&pair[0]) < f_t(&pair[1])
        });
        assert_eq!(a, b);
    }
}

/// Two couplets side by side; each is torn apart in its own step.
const COUPLETS: &str = r#"
format = 1

[materials.stone]
E = "200 GPa"
nu = 0

[interfaces.joint]
f_t = "0.28 MPa"
u_k = "0.2 mm"
zeta = 4.38
tan_phi = 1.01
c = "0.87 MPa"
delta_k = "0.4 mm"
xi = 1.1
mu = 0.73
scatter = { cv = 0.4, seed = 3 }

[[blocks]]
name = "base"
size = [300, 100, 50]
material = "stone"
mesh = [3, 1, 1]

[[blocks]]
name = "one"
size = [100, 100, 50]
at = [0, 0, 50]
material = "stone"

[[blocks]]
name = "two"
size = [100, 100, 50]
at = [200, 0, 50]
material = "stone"

[[contacts]]
slave = ["one.bottom", "two.bottom"]
master = "base.top"
interface = "joint"

[[supports]]
on = "base"

[[steps]]
kind = "drive"
face = "one.top"
direction = "z"
displacement = "1 um"
increments = { initial = 0.01, max = 0.01 }
stop = { below_peak = 0.999 }
tangent = "direct"
tolerance = { residual = 2e-6 }

[[steps]]
kind = "drive"
face = "two.top"
direction = "z"
displacement = "1 um"
increments = { initial = 0.01, max = 0.01 }
stop = { below_peak = 0.999 }
tangent = "direct"
tolerance = { residual = 2e-6 }
"#;

#[test]
fn each_joint_bears_its_own_strength() {
    let (model, _) = Model::from_deck(&deck(COUPLETS)).unwrap();
    let rows = completed(&model).rows;
    let mut peaks = Vec::new();
    for (step, unit) in [(0, 1), (1, 2)] {
        let forces = rows.iter().filter(|r| r.step == step).map(|r| r.force_kN);
        let peak = forces.fold(0.0, f64::max) * 1e3;
        let exact = factor(0.4, 3, 0, unit) * 0.28 * 1e4;
        println!("unit {unit}: {peak:.3} N, exact {exact:.3} N");
        // The stress is uniform. Beyond its strength a joint softens with 6.2 MPa/mm times the factor, so that an
        // increment of 1e-5 mm misses the peak by at most 2.2e-4 of it. Equilibrium holds to 2e-6, of which rounding
        // takes 0.9 to 1.4e-6 in the first increment.
        assert!(
            (peak / exact - 1.0).abs() < 3e-4,
            "{peak} N is not {exact} N"
        );
        peaks.push(peak);
    }
    assert!((peaks[0] / peaks[1] - 1.0).abs() > 0.05, "{peaks:?}");
}

/// Blocks on each other; each course has an interface with its own name.
fn tower(names: [&str; 2], scatters: [&str; 2]) -> String {
    let bond =
        "f_t = 0.2\nc = 0.3\ntan_phi = 0.7\nmu = 0.7\nu_k = 0.2\ndelta_k = 0.4\nzeta = 4\nxi = 1";
    let mut text = format!("{HEAD}\n");
    for (name, scatter) in names.into_iter().zip(scatters) {
        text += &format!("[interfaces.{name}]\n{bond}\n{scatter}\n");
    }
    for (name, z) in [("base", 0), ("lower", 50), ("upper", 100)] {
        text += &format!(
            "[[blocks]]\nname = \"{name}\"\nsize = [100, 100, 50]\nat = [0, 0, {z}]\nmaterial = \"stone\"\n"
        );
    }
    for (slave, master, name) in [("lower", "base", names[0]), ("upper", "lower", names[1])] {
        text += &format!(
            "[[contacts]]\nslave = \"{slave}.bottom\"\nmaster = \"{master}.top\"\ninterface = \"{name}\"\n"
        );
    }
    text + "[[supports]]\non = \"base\"\n" + GRAVITY
}

#[test]
fn interfaces_scatter_independently_of_each_other_and_of_their_names() {
    let of = |names, scatters| {
        let (model, _) = Model::from_deck(&deck(&tower(names, scatters))).unwrap();
        let found = strengths(&model, 0.2);
        ([found[&1], found[&2]], model.contact.law_names)
    };
    let near = |a: [f64; 2], b: [f64; 2]| {
        a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-15) // multiplied by 0.2 and divided by it
    };
    let cv = "scatter = { cv = 0.3, seed = 9 }";
    let own = |interface, unit| factor(0.3, 9, interface, unit);
    let (both, names) = of(["a", "b"], [cv, cv]);
    assert!(near(both, [own(0, 1), own(1, 2)]), "{both:?}");
    assert_eq!(names, ["a", "b"]);
    assert!(near(of(["y", "x"], [cv, cv]).0, both));
    // An interface without variation does not use up a stream of random numbers.
    assert!(near(of(["a", "b"], ["", cv]).0, [1.0, own(0, 2)]));
    assert!(near(of(["a", "b"], [cv, ""]).0, [own(0, 1), 1.0]));
}

#[test]
fn voussoirs_scatter_too() {
    let arch = r#"
[interfaces.mortar]
f_t = 0.2
c = 0.3
tan_phi = 0.7
mu = 0.7
u_k = 0.2
delta_k = 0.4
zeta = 4
xi = 1
scatter = { cv = 0.25 }

[arch]
radius = "1 m"
thickness = 105
width = 200
voussoirs = 7
material = "stone"
interface = "mortar"
mesh = [1, 2, 2]
"#;
    let (model, _) = Model::from_deck(&deck(&format!("{HEAD}{arch}{GRAVITY}"))).unwrap();
    let mut found: Vec<f64> = strengths(&model, 0.2).into_values().collect();
    assert_eq!(found.len(), 7);
    found.sort_by(f64::total_cmp);
    assert!(found.windows(2).all(|w| w[0] < w[1]));
}

#[test]
fn the_check_reports_the_drawn_strengths() {
    let (deck, model) = wall(&[("interfaces.joint.scatter", "{ cv = 0.3, seed = 2 }")]);
    let found: Vec<f64> = strengths(&model, 0.2).into_values().collect();
    let least = found.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = found.iter().copied().fold(0.0, f64::max);
    let notes = check(&deck, &model).notes;
    let of_joint: Vec<_> = notes.iter().filter(|n| n.contains("joint:")).collect();
    assert_eq!(of_joint.len(), 3, "{of_joint:?}");
    let range = format!("cv = 0.3, seed 2: {least:.3} to {largest:.3} times their mean");
    assert!(of_joint[2].contains(&range), "{}", of_joint[2]);
    assert!(of_joint[2].contains(&format!("{} units", found.len())));
    // Stiffnesses are reported once, not once per unit.
    let (deck, model) = wall(&[]);
    assert!(check(&deck, &model).notes.contains(of_joint[1]));
}

/// Only the strongest units soften more steeply than their stiffness.
#[test]
fn snap_back_is_checked_for_the_strongest_unit() {
    // The slope is f_t ζ/(u_k (1 − e^−ζ)) = 2.464 N/mm³ on average.
    let stiffness = [
        ("interfaces.joint.normal_stiffness", "4"),
        ("interfaces.joint.shear_stiffness", "4"),
        ("interfaces.joint.penalty_factor", "500"),
    ];
    let warned = |scatter: &[(&str, &str)]| {
        let (deck, model) = wall(&[&stiffness[..], scatter].concat());
        let warnings = check(&deck, &model).warnings;
        let key = "interfaces.joint.normal_stiffness";
        warnings.into_iter().find(|w| w.key == key)
    };
    assert!(warned(&[]).is_none());
    let scatter = [("interfaces.joint.scatter.cv", "0.6")];
    let (_, model) = wall(&[&stiffness[..], &scatter].concat());
    let largest = strengths(&model, 0.2).into_values().fold(0.0, f64::max);
    let slope = largest * 0.2 * 4.38 / (0.36 * (1.0 - (-4.38_f64).exp()));
    let message = warned(&scatter).unwrap().message;
    assert!(
        message.contains(&format!("4.000 N/mm^3 is not above {slope:.3}")),
        "{message}"
    );
}

#[test]
fn invalid_scatter_is_rejected_with_its_key() {
    let good = tower(["a", "b"], ["", "scatter = { cv = 0.3, seed = 9 }"]);
    crate::common::blocks::refuses(
        &good,
        &[
            (
                "cv = 0.3",
                "cv = 0",
                "interfaces.b.scatter.cv",
                "0 is not above 0 and below 2",
                "0.3",
            ),
            (
                "cv = 0.3",
                "cv = \"200 %\"",
                "interfaces.b.scatter.cv",
                "2 is not above 0 and below 2",
                "leave the table out",
            ),
            (
                "cv = 0.3",
                "cv = -0.3",
                "interfaces.b.scatter.cv",
                "-0.3 is not",
                "standard deviation",
            ),
            (
                "cv = 0.3",
                "cv = \"0.3 MPa\"",
                "interfaces.b.scatter.cv",
                "expected a number",
                "cv = 0.3",
            ),
            (
                "cv = 0.3, ",
                "",
                "interfaces.b.scatter.cv",
                "`cv` is missing",
                "cv = 0.3",
            ),
            (
                "cv =",
                "cov =",
                "interfaces.b.scatter.cov",
                "`cov` is not a known key",
                "`cv`",
            ),
            (
                "seed = 9",
                "seed = -1",
                "interfaces.b.scatter.seed",
                "whole number from 0",
                "seed = 1",
            ),
            (
                "seed = 9",
                "seed = 0.5",
                "interfaces.b.scatter.seed",
                "whole number from 0",
                "seed = 1",
            ),
            (
                "seed = 9",
                "sead = 9",
                "interfaces.b.scatter.sead",
                "`sead` is not a known key",
                "did you mean `seed`?",
            ),
            (
                "scatter = { cv = 0.3, seed = 9 }",
                "scatter = 0.3",
                "interfaces.b.scatter",
                "",
                "scatter = { cv = 0.3",
            ),
        ],
    );
    let dry = good.replace("f_t = 0.2\nc = 0.3", "f_t = 0\nc = 0");
    crate::common::blocks::refuses(
        &dry.replace("scatter = { cv = 0.3, seed = 9 }", "# here"),
        &[(
            "# here",
            "scatter = { cv = 0.3 }",
            "interfaces.b.scatter",
            "no bond that could scatter",
            "leave `scatter` out",
        )],
    );
}
