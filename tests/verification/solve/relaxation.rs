//! Relaxation: dashpots carry the structure over a snap to the next equilibrium, and their work is counted.

use crate::common::blocks::{HEAD, deck_and_model};
use crate::common::scene::{completed, gap};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::HistoryRow;
use wythe::state::Method;

/// Case 15 of the atlas: a brick of 3.5 MPa on 50 by 50 mm breaks in series with 0.8 m of elastic brickwork. Its
/// residual stress is 0.3 MPa.
#[test]
fn a_brick_that_snaps_is_relaxed_once_and_its_energy_is_counted() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/stability/cases/15-brick-snaps/deck.toml"
    );
    let deck = Deck::load(path, &[]).unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let rows = completed(&model).rows;
    let relaxed = |row: &HistoryRow| row.procedure == Method::Relaxation;
    assert_eq!(rows.iter().filter(|row| relaxed(row)).count(), 1);
    let at = rows.iter().position(relaxed).unwrap();
    let (before, after, last) = (&rows[at - 1], &rows[at], rows.last().unwrap());
    // The prescribed displacement continues and never turns back.
    assert!(after.displacement_mm > before.displacement_mm);
    // The peak is found (`increments.peak` is half a per cent), and the run continues in the equilibrium of the
    // residual stress (the tolerance is 2e-3 in the root mean square).
    let peak = rows.iter().map(|row| row.force_kN).fold(0.0, f64::max);
    assert!((peak / 8.75 - 1.0).abs() < 5e-3, "{peak} kN");
    assert!(
        (after.force_kN / 0.75 - 1.0).abs() < 5e-3,
        "{} kN",
        after.force_kN
    );
    // The dashpots dissipate the elastic energy that went neither into the crack nor into the drive, and nothing
    // before or after.
    let freed = before.elastic_energy_J - after.elastic_energy_J;
    let work = after.external_work_J - before.external_work_J;
    let crack = after.plastic_damage_dissipation_J - before.plastic_damage_dissipation_J;
    let dashpots = after.damping_dissipation_J - before.damping_dissipation_J;
    // The energy error may be at most 1 % of the work.
    let open = freed + work - crack - dashpots;
    assert!(open.abs() < 1e-2 * last.external_work_J, "{open} J");
    assert!(dashpots > 0.2, "{dashpots} J of 0.79");
    assert_eq!(before.damping_dissipation_J, 0.0);
    // At the end the dashpot forces are below the equilibrium tolerance, 2e-3, and act over less than 1 % of the
    // displacement of the snap.
    let rest = last.damping_dissipation_J - after.damping_dissipation_J;
    assert!(rest.abs() < 2e-5 * dashpots, "{rest} J");
}

/// A block hangs from another one by a bond that carries less than its weight, 1 mm above its base.
const HANGING: &str = "
[interfaces.bond]
f_t = 0.0015
G_I = 5e-5
c = 0.003
G_II = 5e-4
zeta = 4.38
xi = 1.1
tan_phi = 0.6
mu = 0.6
[[blocks]]
name = \"base\"
size = [200, 200, 100]
material = \"stone\"
[[blocks]]
name = \"loose\"
size = [200, 200, 100]
at = [0, 0, 101]
material = \"stone\"
[[blocks]]
name = \"above\"
size = [200, 200, 100]
at = [0, 0, 201]
material = \"stone\"
[[contacts]]
slave = \"loose.bottom\"
master = \"base.top\"
interface = \"dry\"
[[contacts]]
slave = \"above.bottom\"
master = \"loose.top\"
interface = \"bond\"
[[supports]]
on = \"base.bottom\"
[[springs]]
name = \"jack\"
on = \"above.top\"
stiffness = [1e4, 1e4, 1e4]
[[probes]]
name = \"loose\"
on = \"loose.bottom\"
direction = \"z\"
[[steps]]
kind = \"gravity\"
[[steps]]
kind = \"drive\"
spring = \"jack\"
direction = \"z\"
displacement = 1
";

/// The block comes loose under its weight. A relaxation puts it on its base; inertia is not needed.
#[test]
fn a_block_that_comes_loose_is_put_down() {
    let head = HEAD.replace("[contact]\n", "[contact]\nsearch_radius = 20\n");
    let (_, model) = deck_and_model(&format!("{head}{HANGING}"));
    let rows = completed(&model).rows;
    let by = |method: Method| rows.iter().filter(|row| row.procedure == method).count();
    assert_eq!((by(Method::Relaxation), by(Method::QuasiStatic)), (1, 0));
    let last = rows.last().expect("a row");
    // The base is compressed by 1e-4 mm by the weight.
    assert!((last.probes[0] + 1.0).abs() < 1e-3, "{last:?}");
    let weight = 200.0 * 200.0 * 100.0 * 2000e-12 * 9810.0;
    // Tolerance of equilibrium: 2e-3. The base carries itself and the loose block, the jack the other one.
    let [carried, hangs] = [last.reactions[0][2], 1e3 * last.force_kN];
    assert!((carried / weight - 2.0).abs() < 4e-3, "{carried} {weight}");
    assert!((hangs / weight - 1.0).abs() < 2e-3, "{hangs} {weight}");
    // The dashpots take most of the energy of the fall, and no more than all of it.
    let fall = 1e-3 * weight;
    assert!(last.damping_dissipation_J > 0.5 * fall && last.damping_dissipation_J < fall);
    // The bound beyond which a run warns.
    assert!(gap(last) < 1e-2, "{}", gap(last));
}

/// A pier that slides below a beam which turns, with relaxations whose prediction fails: the work from outside is that of
/// the drive, and no dashpot is pulled at its cost.
#[test]
fn relaxations_of_a_sliding_pier_take_no_work() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/66_rocking_pier.toml");
    let set = ["tan_phi", "mu"].map(|key| (format!("interfaces.dry.{key}"), "0.15".to_owned()));
    let deck = Deck::load(path, &set).unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let rows = completed(&model).rows;
    let drive: Vec<&HistoryRow> = rows.iter().filter(|row| row.step == 2).collect();
    let work: f64 = drive
        .windows(2)
        .map(|p| {
            0.5 * (p[0].force_kN + p[1].force_kN) * (p[1].displacement_mm - p[0].displacement_mm)
        })
        .sum();
    let booked = drive[drive.len() - 1].external_work_J - drive[0].external_work_J;
    // Weights move hardly, and the trapezoids are those of the account.
    assert!((booked / work - 1.0).abs() < 0.01, "{booked} J, {work} J");
}
