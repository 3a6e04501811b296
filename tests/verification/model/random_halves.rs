//! Random walls: the half gives the result of the whole.

use crate::common::halves::{WALL, apart, both};
use crate::common::scene::Recording;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use wythe::state::HistoryRow;

/// The same walls in every run, so that failures are reproducible; `PROPTEST_RNG_SEED` selects others.
fn random() -> ProptestConfig {
    let given = ProptestConfig::default();
    let rng_seed = match given.rng_seed {
        RngSeed::Random => RngSeed::Fixed(2018),
        fixed => fixed,
    };
    ProptestConfig {
        cases: 8,
        failure_persistence: None,
        rng_seed,
        ..given
    }
}

proptest! {
    #![proptest_config(random())]

    /// For any material, pressure and push the force and the energies of a wall that cracks and slides agree with
    /// those of the whole within the documented 0.5 % of `auto`. The path depends on the residual of every increment.
    /// If the whole changes by more than 0.25 % at a quarter of its tolerance, the half may differ by as much again
    /// with the opposite sign. Increments are a fortieth of the push. With increments twice as long one wall took 25
    /// and its half 23, with a brittle peak between them, and the peaks differed by 0.8 %.
    #[test]
    fn halves_of_random_walls_give_the_results_of_the_whole(
        brick in 2.0..20.0_f64,
        f_t in 0.1..0.5_f64,
        c in 0.2..0.8_f64,
        mu in 0.3..0.8_f64,
        pressure in 0.5..2.0_f64,
        push in 0.05..0.2_f64,
    ) {
        let text = |tolerance: f64| {
            let steps = format!(
                r#"
[[steps]]
kind = "preload"
top_pressure = {pressure}
[[steps]]
kind = "drive"
direction = "x"
displacement = {push}
increments = {{ initial = 0.025, max = 0.025 }}
tolerance = {{ residual = {tolerance}, max_iterations = 100 }}
"#
            );
            format!("{WALL}{steps}")
                .replace("clamped = false\n[[supports]]\non = \"wall.bottom\"\n", "")
                .replace("courses = 3", "courses = 4")
                .replace("near = [300, 0, 150]", "near = [300, 0, 200]")
                .replace("E = \"10 GPa\"", &format!("E = \"{brick} GPa\""))
                .replace("f_t = \"0.3 MPa\"", &format!("f_t = {f_t}"))
                .replace("c = \"0.4 MPa\"", &format!("c = {c}"))
                .replace("mu = 0.7", &format!("mu = {mu}"))
        };
        let [(_, full), (_, auto)] = both(&text(4e-3));
        let [(_, closer), (_, closer_auto)] = both(&text(1e-3));
        let told: [fn(&HistoryRow) -> f64; 4] = [
            |r| r.force_kN,
            |r| r.reaction_kN,
            |r| r.external_work_J,
            |r| r.elastic_energy_J,
        ];
        for of in told {
            let curve = |recording: &Recording| {
                let pushed = recording.rows.iter().filter(|r| r.step == 1);
                let points = pushed.map(|r| [r.displacement_mm, of(r)]).collect::<Vec<_>>();
                (1..=20).map(move |i| at(&points, 0.05 * push * f64::from(i)))
            };
            let own = apart(curve(&full), curve(&closer));
            for (full, auto) in [(&full, &auto), (&closer, &closer_auto)] {
                let apart = apart(curve(full), curve(auto));
                println!("apart {apart:.1e}, whole from itself {own:.1e}");
                prop_assert!(apart < (2.0 * own).max(5e-3), "{} {} {:?}", apart, own, text(4e-3));
            }
        }
    }
}

/// Linear interpolation between points of a curve.
fn at(points: &[[f64; 2]], x: f64) -> f64 {
    let i = points
        .partition_point(|p| p[0] < x)
        .clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[i - 1], points[i]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
