//! Joints that are no rectangles: strengths against blocks of stress that are integrated, and against the centroid.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use super::{EXACT, associated, near};
use wythe::deck::Deck;
use wythe::limit::{LimitSettings, analyse};
use wythe::model::Model;

const HEIGHT: f64 = 400.0;
/// Weight of a volume [N/mm³].
const HEAVY: f64 = 2e-9 * 9810.0;
/// Tensile strength of the bond [MPa].
const TENSION: f64 = 0.1;
const DECK: &str = r#"
format = 1
[materials.stone]
E = "10 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.joint]
f_t = 0.1
c = 1
zeta = 4
xi = 1
G_I = 0.02
G_II = 0.1
tan_phi = 3
mu = 3
normal_stiffness = "100 N/mm^3"
shear_stiffness = "50 N/mm^3"
[[blocks]]
name = "s"
file = "stones.obj"
material = "stone"
[[contacts]]
interface = "joint"
[[supports]]
on = ["s-ground"]
[[steps]]
kind = "gravity"
"#;

/// A prism of this base on the ground.
fn prism(base: &[[f64; 2]]) -> Model {
    let ground = [
        [-400.0, -400.0],
        [400.0, -400.0],
        [400.0, 400.0],
        [-400.0, 400.0],
    ];
    let mut text = String::new();
    let mut first = 1;
    for (name, outline, [low, high]) in [
        ("top", base, [0.0, HEIGHT]),
        ("ground", &ground[..], [-100.0, 0.0]),
    ] {
        writeln!(text, "o {name}").unwrap();
        let count = outline.len();
        for z in [low, high] {
            for [x, y] in outline {
                writeln!(text, "v {x} {y} {z}").unwrap();
            }
        }
        let mut face = |nodes: Vec<usize>| {
            let nodes: Vec<String> = nodes.iter().map(|n| (first + n).to_string()).collect();
            writeln!(text, "f {}", nodes.join(" ")).unwrap();
        };
        face((0..count).rev().collect());
        face((count..2 * count).collect());
        for k in 0..count {
            let next = (k + 1) % count;
            face(vec![k, next, count + next, count + k]);
        }
        first += 2 * count;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("stones.obj"), text).unwrap();
    let path = folder.path().join("deck.toml");
    std::fs::write(&path, DECK).unwrap();
    let deck = Deck::load(&path, &[]).unwrap();
    Model::from_deck(&deck).unwrap().0
}

/// Corners of an arc of a circle of 150 mm about the origin.
fn arc(chords: u32, angle: f64, ends: u32) -> Vec<[f64; 2]> {
    let corner = |k: u32| {
        let (sine, cosine) = (angle * f64::from(k) / f64::from(chords)).sin_cos();
        [150.0 * cosine, 150.0 * sine]
    };
    (0..chords + ends).map(corner).collect()
}

fn drum() -> Vec<[f64; 2]> {
    arc(24, TAU, 0)
}

fn half_disc() -> Vec<[f64; 2]> {
    arc(24, PI, 1)
}

fn triangle() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [300.0, 0.0], [150.0, 260.0]]
}

/// Areas of thin strips across a direction, with their places, from the far end on.
fn strips(base: &[[f64; 2]], [u, v]: [f64; 2]) -> Vec<[f64; 2]> {
    const STRIPS: u32 = 2000;
    let turned: Vec<[f64; 2]> = base
        .iter()
        .map(|[x, y]| [u * x + v * y, u * y - v * x])
        .collect();
    let low = turned.iter().map(|x| x[0]).fold(f64::INFINITY, f64::min);
    let high = turned
        .iter()
        .map(|x| x[0])
        .fold(f64::NEG_INFINITY, f64::max);
    let thin = (high - low) / f64::from(STRIPS);
    let strip = |k: u32| {
        let at = high - (f64::from(k) + 0.5) * thin;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (a, b) in turned.iter().zip(turned.iter().cycle().skip(1)) {
            if (a[0] < at) != (b[0] < at) {
                let y = a[1] + (b[1] - a[1]) * (at - a[0]) / (b[0] - a[0]);
                (least, most) = (least.min(y), most.max(y));
            }
        }
        [at, thin * (most - least).max(0.0)]
    };
    (0..STRIPS).map(strip).collect()
}

/// Area, and the place of the centroid along a direction.
fn whole(strips: &[[f64; 2]]) -> [f64; 2] {
    let area: f64 = strips.iter().map(|strip| strip[1]).sum();
    let moment: f64 = strips.iter().map(|[at, area]| at * area).sum();
    [area, moment / area]
}

/// Factor of a body force at which blocks of stress, a part of the area, carry the weight: the least one of all borders.
fn tips(base: &[[f64; 2]], [u, v]: [f64; 2], part: f64) -> f64 {
    let turned = (-80..=80).map(|degrees| {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        let strips = strips(base, [u * cosine - v * sine, v * cosine + u * sine]);
        let [area, middle] = whole(&strips);
        let mut left = part * area;
        let mut moment = 0.0;
        for [at, own] in strips {
            let own = own.min(left);
            left -= own;
            moment += own * (at - middle);
        }
        moment / (part * area * cosine)
    });
    turned.fold(f64::INFINITY, f64::min) / (0.5 * HEIGHT)
}

fn settings([x, y]: [f64; 2]) -> LimitSettings {
    LimitSettings {
        along: Some([x, y, 0.0]),
        ..LimitSettings::default()
    }
}

/// Blocks of stress of any joint: the factor is up to 2 % above that of the block that is integrated.
#[test]
fn any_joint_is_crushed_over_its_block_of_stress() {
    for (base, along) in [
        (drum(), [1.0, 0.0]),
        (triangle(), [0.0, 1.0]),
        (triangle(), [-0.6, 0.8]),
        (half_disc(), [0.0, -1.0]),
        (
            vec![[0.0, 0.0], [300.0, 100.0], [300.0, 150.0], [0.0, 250.0]],
            [1.0, 0.0],
        ),
    ] {
        let model = prism(&base);
        for part in [0.1, 0.6, 0.95] {
            let crushed = LimitSettings {
                strength: Some(HEAVY * HEIGHT / part),
                ..associated(settings(along))
            };
            let whole = LimitSettings {
                whole: true,
                ..crushed
            };
            let known = tips(&base, along, part);
            for settings in [crushed, whole] {
                let found = analyse(&model, &settings).unwrap();
                let ratio = found.factor / known;
                // Strips of the known factor below; 20 borders in 36 directions above, 2.2 % for this triangle.
                assert!(ratio > 0.998 && ratio < 1.025, "{base:?} {part}: {ratio}");
            }
        }
    }
}

/// The strength of the bond acts at the centroid of any joint: tipping and lifting have their closed forms.
#[test]
fn the_bond_of_any_joint_acts_at_its_centroid() {
    for (base, along) in [
        (half_disc(), [0.0, -1.0]),
        (
            vec![[0.0, 0.0], [300.0, 0.0], [180.0, 260.0], [120.0, 260.0]],
            [0.0, 1.0],
        ),
        (triangle(), [0.0, 1.0]),
    ] {
        let model = prism(&base);
        let strips = strips(&base, along);
        let [area, middle] = whole(&strips);
        let edge = base.iter().map(|[x, y]| along[0] * x + along[1] * y);
        let arm = edge.fold(f64::NEG_INFINITY, f64::max) - middle;
        let weight = HEAVY * HEIGHT * area;
        let held = (weight + TENSION * area) / weight;
        let bonded = |along: [f64; 3]| LimitSettings {
            along: Some(along),
            bonded: true,
            ..associated(LimitSettings::default())
        };
        let tipping = analyse(&model, &bonded([along[0], along[1], 0.0])).unwrap();
        // Rounding of the strips.
        near(tipping.factor, held * arm / (0.5 * HEIGHT), 1e-4);
        let lifted = analyse(&model, &bonded([0.0, 0.0, 1.0])).unwrap();
        near(lifted.factor, held, 10.0 * EXACT);
    }
}
