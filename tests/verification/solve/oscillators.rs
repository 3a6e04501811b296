//! Oscillators and springs against closed forms: the schemes, damping and their energies.

use crate::common::scene::{self, DENSITY, Face, Recording, completed, gap};
use wythe::model::Model;
use wythe::model::scene::{Gravity, Procedure, Rayleigh, Spring, Step, Tangent};

/// Relative to the mean nodal force: one iteration solves linear problems up to rounding. When an oscillator passes
/// zero the scale is a hundredth of its largest force, and rounding is 1e-11 of it.
const EXACT: f64 = 1e-8;

/// One element, fixed except for its top, which moves axially: k = EA/L, m = ϱAL/3.
struct Oscillator {
    model: Model,
    /// √(k/m) [1/s].
    omega: f64,
}

/// Initial velocity [mm/s].
const V0: f64 = 100.0;

fn oscillator() -> Oscillator {
    let (e, length) = (1e4, 100.0);
    let mut model = scene::empty();
    let solid = scene::heavy(e, 0.0, DENSITY);
    let column = scene::block(
        &mut model,
        [0.0; 3],
        [10.0, 10.0, length],
        [1, 1, 1],
        &solid,
    );
    scene::hold(&mut model, column.face(Face::Bottom), [true; 3]);
    scene::hold(&mut model, column.face(Face::Top), [true, true, false]);
    model.initial_velocity = vec![[0.0, 0.0, V0]; model.mesh.nodes.len()];
    Oscillator {
        model,
        omega: (3.0 * e / DENSITY).sqrt() / length,
    }
}

impl Oscillator {
    /// `periods` periods in increments of 1/`per_period`; (u, v) after each increment.
    fn swing(
        &mut self,
        procedure: Procedure,
        periods: usize,
        per_period: usize,
    ) -> (Recording, Vec<[f64; 2]>, f64) {
        let duration = periods as f64 * std::f64::consts::TAU / self.omega;
        let count = periods * per_period;
        self.model.steps = vec![Step {
            procedure,
            tangent: Tangent::Consistent,
            ..scene::left_alone(Gravity::None, duration, count, EXACT)
        }];
        let recording = completed(&self.model);
        assert_eq!(recording.states.len(), count);
        let path = recording
            .states
            .iter()
            .map(|s| [s.q[0], s.velocity[0]])
            .collect();
        (recording, path, duration / count as f64)
    }
}

/// The same oscillator as a scalar equation with unit mass: HHT-α after one increment of backward Euler.
fn scalar(alpha: f64, damping: Rayleigh, omega: f64, dt: f64, count: usize) -> Vec<[f64; 2]> {
    let (k, c) = (
        omega * omega,
        damping.mass + damping.stiffness * omega * omega,
    );
    let (beta, gamma) = ((1.0 - alpha) * (1.0 - alpha) / 4.0, 0.5 - alpha);
    let v = V0 / (1.0 + dt * c + dt * dt * k);
    let (mut u, mut v, mut a) = (dt * v, v, (v - V0) / dt);
    let mut path = vec![[u, v]];
    for _ in 1..count {
        let u_star = u + dt * v + dt * dt * (0.5 - beta) * a;
        let v_star = v + dt * (1.0 - gamma) * a;
        let before = c * v + k * u;
        let next = (alpha * before - (1.0 + alpha) * (c * v_star + k * u_star))
            / (1.0 + (1.0 + alpha) * (c * gamma * dt + k * beta * dt * dt));
        (u, v, a) = (
            u_star + beta * dt * dt * next,
            v_star + gamma * dt * next,
            next,
        );
        path.push([u, v]);
    }
    path
}

#[test]
fn an_oscillator_follows_the_scheme_with_and_without_damping() {
    let mut oscillator = oscillator();
    let omega = oscillator.omega;
    for damping in [
        Rayleigh::default(),
        Rayleigh {
            mass: 0.1 * omega,
            stiffness: 0.0,
        },
        Rayleigh {
            mass: 0.0,
            stiffness: 0.1 / omega,
        },
    ] {
        for alpha in [0.0, -0.1, -1.0 / 3.0] {
            let procedure = Procedure::Dynamic { alpha, damping };
            let (recording, path, dt) = oscillator.swing(procedure, 2, 40);
            let expected = scalar(alpha, damping, omega, dt, path.len());
            for ([u, v], [u_expected, v_expected]) in path.iter().zip(&expected) {
                // Tolerance: the residual, 1e-8 of the forces, over 80 increments, relative to the amplitude.
                assert!(
                    (u - u_expected).abs() < 1e-6 * V0 / omega,
                    "{u} {u_expected}"
                );
                assert!((v - v_expected).abs() < 1e-6 * V0, "{v} {v_expected}");
            }
            let first = recording.rows[0].external_work_J;
            for row in &recording.rows {
                // Tolerance: the residual.
                assert!(gap(row).abs() < 1e-7 * first, "{row:?}");
            }
            let last = recording.rows.last().unwrap();
            let damped = last.damping_dissipation_J;
            assert_eq!(damped > 0.0, damping != Rayleigh::default());
        }
    }
}

#[test]
fn the_trapezoidal_rule_keeps_the_energy_and_has_its_known_period() {
    let mut oscillator = oscillator();
    let omega = oscillator.omega;
    let procedure = Procedure::Dynamic {
        alpha: 0.0,
        damping: Rayleigh::default(),
    };
    let (recording, path, dt) = oscillator.swing(procedure, 5, 20);
    // From the first increment on ω̄ Δt = 2 atan(ω Δt/2) (Hughes 2000, §9.1.2).
    let turn = 2.0 * (0.5 * omega * dt).atan();
    let [u, v] = path[0];
    let (swing, phase) = (u.hypot(v / omega), (omega * u).atan2(v));
    for (n, [u, _]) in path.iter().enumerate() {
        let expected = swing * (n as f64 * turn + phase).sin();
        // Tolerance as above.
        assert!((u - expected).abs() < 1e-6 * swing, "{n}: {u} {expected}");
    }
    let numerical: Vec<f64> = recording
        .rows
        .iter()
        .map(|r| r.numerical_dissipation_J)
        .collect();
    let first = recording.rows[0].external_work_J;
    // Backward Euler dissipates 1 − 1/(1 + ω²Δt²) of the energy, the trapezoidal rule nothing.
    let euler = 1.0 - 1.0 / (1.0 + (omega * dt) * (omega * dt));
    for taken in &numerical {
        assert!((taken / first - euler).abs() < 1e-7, "{taken}, {euler}");
    }
}

#[test]
fn backward_euler_takes_its_known_part_of_the_energy() {
    let mut oscillator = oscillator();
    let omega = oscillator.omega;
    let (recording, path, dt) = oscillator.swing(Procedure::QuasiStatic, 3, 20);
    let factor = 1.0 + (omega * dt) * (omega * dt);
    let mut energy = V0 * V0;
    for [u, v] in path {
        energy /= factor;
        let found = omega * omega * u * u + v * v;
        // Tolerance: the residual, as above.
        assert!((found / energy - 1.0).abs() < 1e-6, "{found} {energy}");
    }
    let last = recording.rows.last().unwrap();
    assert!(gap(last).abs() < 1e-7 * last.external_work_J);
    assert!(last.numerical_dissipation_J > 0.99 * last.external_work_J);
}

#[test]
fn damping_has_the_period_and_the_decrement_of_the_textbook() {
    let mut oscillator = oscillator();
    let omega = oscillator.omega;
    // ζ = a/(2ω) + bω/2 = 3 % + 2 %.
    let zeta = 0.05_f64;
    let procedure = Procedure::Dynamic {
        alpha: 0.0,
        damping: Rayleigh {
            mass: 0.06 * omega,
            stiffness: 0.04 / omega,
        },
    };
    let (_, path, dt) = oscillator.swing(procedure, 4, 200);
    // Upward zero crossings by linear interpolation between increments: times and velocities.
    let passages: Vec<[f64; 2]> = path
        .windows(2)
        .enumerate()
        .filter(|(_, w)| w[0][0] < 0.0 && w[1][0] >= 0.0)
        .map(|(n, w)| {
            let part = w[0][0] / (w[0][0] - w[1][0]);
            [(n as f64 + part) * dt, w[0][1] + part * (w[1][1] - w[0][1])]
        })
        .collect();
    assert!(passages.len() >= 3);
    let root = (1.0 - zeta * zeta).sqrt();
    for pair in passages.windows(2) {
        let period = pair[1][0] - pair[0][0];
        let decrement = (pair[0][1] / pair[1][1]).ln();
        // The rule lengthens the periods by (ωΔt)²/12 = 8e-5.
        let expected = std::f64::consts::TAU / (omega * root);
        assert!(
            (period / expected - 1.0).abs() < 2e-4,
            "{period} {expected}"
        );
        // Also of second order, with a factor of order one, for a decrement of 0.31.
        let expected = std::f64::consts::TAU * zeta / root;
        assert!(
            (decrement / expected - 1.0).abs() < 1e-3,
            "{decrement} {expected}"
        );
    }
}

/// A block that moves only in x, with a spring on all its nodes.
fn block_on_a_spring(stiffness: f64) -> Model {
    let mut model = scene::empty();
    let solid = scene::heavy(1e4, 0.2, DENSITY);
    scene::block(&mut model, [0.0; 3], [60.0, 40.0, 50.0], [2, 2, 2], &solid);
    let nodes: Vec<u32> = (0..model.mesh.nodes.len() as u32).collect();
    scene::hold(&mut model, nodes.clone(), [false, true, true]);
    model.springs.push(Spring {
        name: "spring".to_owned(),
        nodes,
        stiffness: [stiffness, 0.0, 0.0],
    });
    model
}

#[test]
fn a_block_swings_on_its_spring() {
    let stiffness = 5.0;
    let mut model = block_on_a_spring(stiffness);
    model.initial_velocity = vec![[V0, 0.0, 0.0]; model.mesh.nodes.len()];
    let omega = (stiffness / (DENSITY * 60.0 * 40.0 * 50.0)).sqrt();
    let period = std::f64::consts::TAU / omega;
    // Two and a quarter periods: at the turning point.
    let count = 450;
    model.steps = vec![scene::set_free(
        Gravity::None,
        2.25 * period,
        count,
        1e-6,
        0.0,
    )];
    let recording = completed(&model);
    let last = recording.rows.last().unwrap();
    let u = recording.frames.last().unwrap().displacement[0][0];
    // The first increment, by backward Euler, takes (ωΔt)²/2 = 5e-4 of the amplitude. The phase is late by 2.25 ×
    // 8e-5 of a period, which does not affect the turning point.
    assert!((u / (V0 / omega) - 1.0).abs() < 1e-3, "{u}");
    assert!(last.kinetic_energy_J < 1e-3 * last.elastic_energy_J);
    // Tolerance: the residual.
    assert!(gap(last).abs() < 1e-5 * last.external_work_J);
    // Zero crossings are half a period apart, late by (ωΔt)²/12 = 8e-5.
    let path: Vec<[f64; 2]> = recording
        .frames
        .iter()
        .map(|f| [f.time, f.displacement[0][0]])
        .collect();
    let crossings: Vec<f64> = path
        .windows(2)
        .filter(|w| w[0][1] * w[1][1] < 0.0)
        .map(|w| w[0][0] + (w[1][0] - w[0][0]) * w[0][1] / (w[0][1] - w[1][1]))
        .collect();
    assert_eq!(crossings.len(), 4);
    for pair in crossings.windows(2) {
        let half = pair[1] - pair[0];
        // Tolerance: linear interpolation between increments.
        assert!((2.0 * half / period - 1.0).abs() < 5e-4, "{half} {period}");
    }
}

#[test]
fn a_driven_spring_pulls_against_another() {
    let mut model = block_on_a_spring(3.0);
    let other = Spring {
        stiffness: [1.0, 0.0, 0.0],
        ..model.springs[0].clone()
    };
    model.springs.push(other);
    let mut step = scene::left_alone(Gravity::None, 1.0, 4, EXACT);
    step.springs = vec![[4.0, 0.0, 0.0], [0.0; 3]];
    model.steps = vec![step.clone(), step];
    let recording = completed(&model);
    let last = recording.rows.last().unwrap();
    for displacement in &recording.frames.last().unwrap().displacement {
        // k₁/(k₁ + k₂) of 8 mm, up to the residual.
        assert!((displacement[0] - 6.0).abs() < 1e-6, "{displacement:?}");
    }
    // ½ × 3 × 2² + ½ × 1 × 6² = 24 N mm, all supplied by the driven end.
    assert!((last.elastic_energy_J - 0.024).abs() < 1e-8, "{last:?}");
    assert!((last.external_work_J - 0.024).abs() < 1e-8, "{last:?}");
}
