//! Natural modes against closed forms: beams, a rigid block on the springs of a joint, sums of modal masses.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Matrix4;

use crate::common::blocks::deck_and_model;
use crate::common::scene::{self, DENSITY, Face};
use wythe::contact::CohesiveFrictional;
use wythe::material::MaterialParameters;
use wythe::model::Model;
use wythe::model::ties::{self, Installed, Tie, TieLaw};
use wythe::solve::vibration::{About, Mode, Modes, VibrationError, modes};
use wythe::state::{Frame, InterfaceFrame};

/// Young's modulus of the beams [MPa].
const E: f64 = 5000.0;

fn at_rest(model: &Model, count: usize) -> Modes {
    let found = modes(model, About::Rest, count).unwrap();
    for mode in &found.modes {
        // Bound of the solver.
        assert!(mode.residual <= 1e-6, "{}", mode.residual);
    }
    found
}

/// A cantilever along z, `size` [mm], held at its foot.
fn cantilever(size: [f64; 3], cells: [usize; 3]) -> Model {
    let mut model = scene::empty();
    let solid = scene::heavy(E, 0.0, DENSITY);
    let column = scene::block(&mut model, [0.0; 3], size, cells, &solid);
    scene::hold(&mut model, column.face(Face::Bottom), [true; 3]);
    model
}

/// The mode with the largest effective mass along an axis.
fn main_mode(found: &Modes, axis: usize) -> &Mode {
    let by = |a: &&Mode, b: &&Mode| a.effective_mass[axis].total_cmp(&b.effective_mass[axis]);
    found.modes.iter().max_by(by).unwrap()
}

/// First frequency [Hz] of a Timoshenko cantilever of the section `width` × `depth` that bends along its depth, from
/// the determinant of its equations of vibration:
///
/// w′ = φ + V/(κGA), φ′ = M/(EI), M′ = −V − ϱIω²φ, V′ = −ϱAω²w; w = φ = 0 at the foot, M = V = 0 at the top.
fn timoshenko(width: f64, depth: f64, length: f64) -> f64 {
    // Cowper (1966) for a rectangle with ν = 0.
    let kappa = 5.0 / 6.0;
    let (area, inertia) = (width * depth, width * depth.powi(3) / 12.0);
    let (bending, shear) = (E * inertia, kappa * 0.5 * E * area);
    // Lengths over L, moments over EI/L, forces over EI/L².
    let determinant = |omega: f64| {
        let b = Matrix4::new(
            0.0,
            1.0,
            0.0,
            bending / (shear * length * length),
            0.0,
            0.0,
            1.0,
            0.0,
            0.0,
            -DENSITY * inertia * omega * omega * length * length / bending,
            0.0,
            -1.0,
            -DENSITY * area * omega * omega * length.powi(4) / bending,
            0.0,
            0.0,
            0.0,
        );
        let end = b.exp();
        end.fixed_view::<2, 2>(2, 2).determinant()
    };
    // Bernoulli's frequency is above it.
    let above = 1.8751_f64.powi(2) * (bending / (DENSITY * area)).sqrt() / length.powi(2);
    let (mut low, mut high) = (0.3 * above, 1.01 * above);
    assert!(determinant(low) * determinant(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if determinant(low) * determinant(middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    low / TAU
}

#[test]
fn a_cantilever_bends_with_the_frequency_of_timoshenko() {
    // Slender and squat: shear takes 2 % and 40 % of the first frequency.
    for (length, cells) in [(2000.0, [3, 2, 40]), (400.0, [8, 2, 16])] {
        let (width, depth) = (120.0, 250.0);
        let model = cantilever([depth, width, length], cells);
        let found = at_rest(&model, 8);
        for (axis, [width, depth]) in [(0, [width, depth]), (1, [depth, width])] {
            let computed = main_mode(&found, axis).frequency;
            let closed = timoshenko(width, depth, length);
            println!("length {length}, axis {axis}: {computed:.3} Hz, Timoshenko {closed:.3} Hz");
            // Discretisation: halved elements err a quarter as much.
            assert!(
                (computed / closed - 1.0).abs() < 0.01,
                "{computed} {closed}"
            );
        }
    }
}

#[test]
fn a_bar_swings_along_itself_as_a_chain_of_linear_elements() {
    let (length, n) = (1000.0, 10);
    let found = at_rest(&cantilever([100.0, 120.0, length], [1, 1, n]), 12);
    let speed = (E / DENSITY).sqrt();
    // Consistent masses: ω² = 6 c²/h² (1 − cos α)/(2 + cos α) with α = π/(2n), which tends to πc/(2L).
    let (element, cosine) = (length / n as f64, (FRAC_PI_2 / n as f64).cos());
    let closed = (6.0 * (1.0 - cosine) / (2.0 + cosine)).sqrt() * speed / element / TAU;
    let mode = main_mode(&found, 2);
    // Rounding of the stiffness.
    assert!(
        (mode.frequency / closed - 1.0).abs() < 1e-7,
        "{}",
        mode.frequency
    );
    assert!((mode.frequency / (speed / (4.0 * length)) - 1.0).abs() < 2e-3);
    // Effective mass of a quarter sine, 8/π² of the mass of the bar.
    let part = mode.effective_mass[2] / found.total_mass;
    // Discretisation, of second order in 1/n.
    assert!(
        (part - 8.0 / (2.0 * FRAC_PI_2).powi(2)).abs() < 5e-3,
        "{part}"
    );
}

/// A block on a joint that rests on a held slab: sizes [mm], stiffness of the joint [N/mm³].
const BLOCK: [f64; 3] = [200.0, 120.0, 300.0];
const CELLS: [usize; 3] = [4, 2, 4];
const JOINT: [f64; 2] = [2.0, 0.8];

fn block_on_joint(law: CohesiveFrictional, young: f64) -> Model {
    let mut model = scene::empty();
    let solid = scene::heavy(young, 0.0, DENSITY);
    let [x, y, _] = BLOCK;
    let slab = scene::block(
        &mut model,
        [0.0, 0.0, -50.0],
        [x, y, 50.0],
        [4, 2, 1],
        &solid,
    );
    scene::hold(&mut model, slab.nodes(), [true; 3]);
    let block = scene::block(&mut model, [0.0; 3], BLOCK, CELLS, &solid);
    scene::slave(&mut model, &block, Face::Bottom, law);
    scene::master(&mut model, &slab, Face::Top);
    model
}

#[test]
fn a_rigid_block_vibrates_on_the_springs_of_its_joint() {
    // A hundred thousand times as stiff as the joint.
    let dry = CohesiveFrictional::dry(0.6, JOINT[0], JOINT[1]);
    let found = at_rest(&block_on_joint(dry, 6e7), 6);
    assert_eq!((found.free, found.closed_area), (0, 1.0));
    let [x, y, z] = BLOCK;
    let [k_n, k_s] = JOINT;
    let (area, mass) = (x * y, DENSITY * x * y * z);
    let second = |i: usize| BLOCK[i].powi(2) / 12.0;
    // Vertical and about the vertical axis.
    let vertical = k_n * area / mass;
    let about_z = k_s * area * (x * x + y * y) / 12.0 / (mass * (second(0) + second(1)));
    let mut squares = vec![vertical, about_z];
    // Sliding u of the centre and rocking θ: [k_s A, −k_s A h; −k_s A h, k_s A h² + k_n I] with h = z/2.
    for (side, axis) in [(x, 0), (y, 1)] {
        let h = 0.5 * z;
        let rocking = k_n * area * side * side / 12.0;
        let inertia = mass * (second(axis) + second(2));
        let (a, b, d) = (
            k_s * area / mass,
            -k_s * area * h / (mass * inertia).sqrt(),
            (k_s * area * h * h + rocking) / inertia,
        );
        let root = (0.25 * (a - d).powi(2) + b * b).sqrt();
        squares.extend([0.5 * (a + d) - root, 0.5 * (a + d) + root]);
    }
    squares.sort_by(f64::total_cmp);
    for (mode, square) in found.modes.iter().zip(&squares) {
        let closed = square.sqrt() / TAU;
        println!("{:.4} Hz, closed {closed:.4} Hz", mode.frequency);
        // The block is not quite rigid: k_n z/E = 1e-5, times the shape of the bending.
        assert!((mode.frequency / closed - 1.0).abs() < 1e-4, "{closed}");
    }
}

const ROD: TieLaw = TieLaw {
    area: 100.0,
    E: 2e5,
    f_y: f64::INFINITY,
    hardening: 0.0,
    rupture: f64::INFINITY,
    compression: true,
};

/// The model with a rod between slab and block, and the rise of the square of the vertical frequency by it [1/s²].
fn with_rod(model: &Model, law: TieLaw) -> (Model, f64) {
    let [x, y, z] = BLOCK;
    let ends = [[0.5 * x, 0.5 * y, -25.0], [0.5 * x, 0.5 * y, 0.5 * z]];
    let mut with = model.clone();
    with.ties.push(Tie {
        name: "rod".to_owned(),
        law,
        strands: vec![ties::anchored(&with.mesh, ends).unwrap()],
        shares: Vec::new(),
    });
    let stiffness = law.E * law.area / (0.5 * z + 25.0);
    (with, stiffness / (DENSITY * x * y * z) / TAU.powi(2))
}

/// A rod between slab and block is a spring beside the joint: it adds E A/(L m) to the square of the vertical mode.
#[test]
fn a_tie_stiffens_the_vertical_mode() {
    let dry = CohesiveFrictional::dry(0.6, JOINT[0], JOINT[1]);
    let vertical = |model: &Model| main_mode(&at_rest(model, 6), 2).frequency;
    let without = block_on_joint(dry, 6e7);
    let (with, added) = with_rod(&without, ROD);
    let [before, after] = [&without, &with].map(vertical);
    let found = after * after - before * before;
    println!("{before} Hz, {after} Hz: {found} of {added}");
    // The block is not quite rigid at the end of the rod.
    assert!((found / added - 1.0).abs() < 5e-3, "{found} {added}");
}

/// The block has risen by 0.2 mm under pressure: a rod that was there from the start has yielded.
#[test]
fn a_tie_counts_from_its_installation() {
    let dry = CohesiveFrictional::dry(0.6, JOINT[0], JOINT[1]);
    let law = TieLaw {
        f_y: 100.0,
        compression: false,
        ..ROD
    };
    let (model, added) = with_rod(&block_on_joint(dry, 6e7), law);
    let (mesh, points) = (&model.mesh, 4 * model.contact.slave_facets.len());
    let elements = mesh.elements.len();
    let mut displacement = vec![[0.0; 3]; mesh.nodes.len()];
    let block = mesh.unit[elements - 1];
    for (nodes, _) in (mesh.elements.iter().zip(&mesh.unit)).filter(|(_, unit)| **unit == block) {
        for n in nodes {
            displacement[*n as usize] = [0.0, 0.0, 0.2];
        }
    }
    let frame = Frame {
        displacement,
        stress: vec![[0.0; 6]; elements],
        plastic_strain: vec![[0.0; 6]; elements],
        tensile_damage: vec![0.0; elements],
        compressive_damage: vec![0.0; elements],
        interfaces: InterfaceFrame {
            opening: vec![-0.05; points],
            traction: vec![[-0.1, 0.0, 0.0]; points],
            damage: vec![1.0; points],
            ..InterfaceFrame::default()
        },
        ..Frame::default()
    };
    let square = |since: Installed<'_>| {
        let about = About::Frame {
            frame: &frame,
            step: 0,
            ties: &[since],
        };
        main_mode(&modes(&model, about, 6).unwrap(), 2)
            .frequency
            .powi(2)
    };
    let without = square(Installed::Later);
    for (since, part) in [
        (Installed::AtRest, 0.0),
        (Installed::At(&frame.displacement), 1.0),
    ] {
        let found = (square(since) - without) / added;
        // The block is not quite rigid at the end of the rod.
        assert!((found - part).abs() < 5e-3, "{since:?}: {found}");
    }
    let others = About::Frame {
        frame: &frame,
        step: 0,
        ties: &[Installed::At(&[])],
    };
    assert!(matches!(
        modes(&model, others, 1),
        Err(VibrationError::OtherModel(_))
    ));
}

/// Two units whose head joint lies in the plane x = 200 mm, on springs along y and z. `@` stands for the rest.
const COUPLE: &str = r#"format = 1
[materials.stone]
E = "10 GPa"
nu = 0.2
density = "2000 kg/m^3"

[interfaces.joint]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
normal_stiffness = "100 N/mm^3"
shear_stiffness = "50 N/mm^3"

[wall]
unit = [200, 100, 100]
bed_joint = 0
head_joint = 0
length = 400
courses = 1
unit_material = "stone"
interface = "joint"
mesh = [2, 1, 1]
clamped = false
@
[[steps]]
kind = "free"
"#;

/// A joint in a plane of symmetry has no slip, so that it has no stiffness against it.
#[test]
fn halves_slide_along_their_plane_with_their_image() {
    let spring =
        |k: f64| format!("[[springs]]\nname = \"k\"\non = \"wall\"\nstiffness = [0, {k}, {k}]\n");
    let plane = "[[symmetry]]\nnormal = \"x\"\nat = 200\n";
    let bond = [
        (
            "f_t = 0\nc = 0",
            "f_t = \"0.2 MPa\"\nc = \"0.3 MPa\"\nzeta = 4.38\nxi = 1.1",
        ),
        ("mu = 0.6", "mu = 0.6\nG_I = \"10 N/m\"\nG_II = \"100 N/m\""),
    ];
    let bonded = bond
        .iter()
        .fold(COUPLE.to_owned(), |text, (a, b)| text.replace(a, b));
    // Two units of 4 kg on 100 N/mm.
    let closed = (100.0_f64 / 8e-3).sqrt() / TAU;
    for text in [COUPLE, bonded.as_str()] {
        let whole = text.replace('@', &spring(100.0));
        let half = text.replace('@', &(spring(50.0) + plane));
        for text in [whole, half] {
            let (_, model) = deck_and_model(&text);
            let found = at_rest(&model, 10);
            for axis in [1, 2] {
                let frequency = main_mode(&found, axis).frequency;
                // The units are not quite rigid.
                assert!(
                    (frequency / closed - 1.0).abs() < 1e-3,
                    "{frequency} {closed}"
                );
            }
        }
    }
}

#[test]
fn open_and_torn_joints_carry_their_secant() {
    let bond = CohesiveFrictional {
        f_t: 0.2,
        c: 0.3,
        ..CohesiveFrictional::dry(0.6, JOINT[0], JOINT[1])
    };
    let model = block_on_joint(bond, 6e7);
    let whole = at_rest(&model, 6);
    let points = 4 * model.contact.slave_facets.len();
    let elements = model.mesh.elements.len();
    let at = |traction: f64, opening: f64, damage: f64| {
        let frame = Frame {
            displacement: vec![[0.0; 3]; model.mesh.nodes.len()],
            stress: vec![[0.0; 6]; elements],
            plastic_strain: vec![[0.0; 6]; elements],
            tensile_damage: vec![0.0; elements],
            compressive_damage: vec![0.0; elements],
            interfaces: InterfaceFrame {
                opening: vec![opening; points],
                traction: vec![[traction, 0.0, 0.0]; points],
                damage: vec![damage; points],
                ..InterfaceFrame::default()
            },
            ..Frame::default()
        };
        let about = About::Frame {
            frame: &frame,
            step: 0,
            ties: &[],
        };
        modes(&model, about, 6).unwrap()
    };
    // Under pressure, whatever the damage: the elastic stiffness.
    let pressed = at(-0.1, -0.05, 0.9);
    // A quarter of the elastic stiffness: half the frequency.
    let torn = at(0.1, 4.0 * 0.1 / JOINT[0], 0.5);
    for ((whole, pressed), torn) in whole.modes.iter().zip(&pressed.modes).zip(&torn.modes) {
        // Rounding; the block is not quite rigid.
        assert!((pressed.frequency / whole.frequency - 1.0).abs() < 1e-9);
        assert!((torn.frequency / whole.frequency - 0.5).abs() < 1e-4);
    }
    let open = at(0.0, 0.3, 1.0);
    assert_eq!((open.free, open.closed_area), (6, 0.0));
    assert!(open.modes.iter().all(|mode| mode.frequency == 0.0));
    let wrong = Frame::default();
    let about = About::Frame {
        frame: &wrong,
        step: 0,
        ties: &[],
    };
    assert!(matches!(
        modes(&model, about, 1),
        Err(VibrationError::OtherModel(_))
    ));
}

#[test]
fn damaged_solids_vibrate_with_their_secant_stiffness() {
    let mut model = cantilever([100.0, 120.0, 600.0], [1, 1, 6]);
    let mut brick = crate::common::brick();
    brick.elastic.density = DENSITY;
    model.materials[0].parameters = MaterialParameters::DamagePlasticity(brick);
    let whole = at_rest(&model, 4);
    let elements = model.mesh.elements.len();
    let frame = |stress: f64| Frame {
        displacement: vec![[0.0; 3]; model.mesh.nodes.len()],
        stress: vec![[0.0, 0.0, stress, 0.0, 0.0, 0.0]; elements],
        plastic_strain: vec![[0.0; 6]; elements],
        tensile_damage: vec![0.75; elements],
        compressive_damage: vec![0.0; elements],
        ..Frame::default()
    };
    // In tension a quarter of the stiffness is left; under pressure cracks are closed.
    for (stress, part) in [(1e-9, 0.5), (-1e-9, 1.0)] {
        let frame = frame(stress);
        let damaged = modes(
            &model,
            About::Frame {
                frame: &frame,
                step: 0,
                ties: &[],
            },
            4,
        )
        .unwrap();
        for (whole, damaged) in whole.modes.iter().zip(&damaged.modes) {
            assert!(
                (damaged.frequency / whole.frequency - part).abs() < 1e-6,
                "{part}"
            );
        }
    }
}

#[test]
fn all_modes_together_have_the_moving_mass() {
    let mut model = cantilever([120.0, 100.0, 300.0], [2, 1, 3]);
    // Any shape: no symmetry, no equal frequencies.
    for (i, node) in model.mesh.nodes.iter_mut().enumerate() {
        node[0] += 3.0 * (i as f64).sin();
        node[1] += 2.0 * (1.7 * i as f64).cos();
    }
    let found = at_rest(&model, usize::MAX);
    assert_eq!(found.modes.len(), 3 * 6 * 3);
    for axis in 0..3 {
        let sum: f64 = found
            .modes
            .iter()
            .map(|mode| mode.effective_mass[axis])
            .sum();
        let moving = found.moving_mass[axis];
        // Rounding.
        assert!((sum / moving - 1.0).abs() < 1e-9, "{sum} {moving}");
        assert!(moving < found.total_mass);
    }
    assert!(
        found
            .modes
            .is_sorted_by(|a, b| a.eigenvalue <= b.eigenvalue)
    );
}

/// A basis of all vectors of a small scene has rounding errors of its largest eigenvalues.
#[test]
fn a_free_element_has_six_motions_without_frequency() {
    for size in [[100.0; 3], [300.0, 200.0, 20.0]] {
        let mut model = scene::empty();
        let solid = scene::heavy(E, 0.2, DENSITY);
        scene::block(&mut model, [0.0; 3], size, [1, 1, 1], &solid);
        let found = at_rest(&model, 8);
        assert_eq!((found.free, found.unstable), (6, 0), "{size:?}");
    }
}

#[test]
fn a_free_block_has_six_motions_without_frequency() {
    let mut model = scene::empty();
    let solid = scene::heavy(E, 0.2, DENSITY);
    scene::block(
        &mut model,
        [0.0; 3],
        [200.0, 100.0, 50.0],
        [3, 2, 2],
        &solid,
    );
    let found = at_rest(&model, 8);
    assert_eq!((found.free, found.unstable), (6, 0));
    assert!(found.modes[5].frequency == 0.0 && found.modes[6].frequency > 100.0);
    assert!(found.modes[0].period().is_infinite());
    let sum: f64 = found.modes[..6]
        .iter()
        .map(|mode| mode.effective_mass[0])
        .sum();
    // Rigid motions have all the mass; rounding over the shift.
    assert!((sum / found.total_mass - 1.0).abs() < 1e-6, "{sum}");
}

#[test]
fn what_has_no_mass_is_named() {
    let mut model = scene::empty();
    let light = scene::elastic(E, 0.2);
    let block = scene::block(&mut model, [0.0; 3], [100.0; 3], [1, 1, 1], &light);
    scene::hold(&mut model, block.face(Face::Bottom), [true; 3]);
    let error = modes(&model, About::Rest, 1).unwrap_err().to_string();
    assert!(
        error.contains("block 0") && error.contains("density"),
        "{error}"
    );
    scene::hold(&mut model, block.nodes(), [true; 3]);
    assert_eq!(
        modes(&model, About::Rest, 1).unwrap_err(),
        VibrationError::NothingMoves
    );
}
