//! Limit analysis of dry walls in running bond, pushed by a part of their weight: with the forces at all corners, and
//! with those of one side of the middle plane. Associated friction, one program.
//!
//! Not covered: reading of the deck, and the search without dilatancy, whose number of programs depends on the wall.

use criterion::{Criterion, criterion_group, criterion_main};
use rayon::ThreadPoolBuilder;
use wythe::deck::Deck;
use wythe::limit::{LimitSettings, analyse};
use wythe::model::Model;

/// A wall of `courses` courses of `units` units of 200 × 200 × 100 mm on the ground.
fn wall(units: usize, courses: usize) -> Model {
    let length = 200 * units;
    let text = format!(
        "format = 1\n[materials.stone]\nE = \"15 GPa\"\nnu = 0.2\ndensity = \"2300 kg/m^3\"\n\
         [interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = 0.6\nmu = 0.6\n\
         normal_stiffness = \"10 N/mm^3\"\nshear_stiffness = \"4 N/mm^3\"\n[contact]\npoints = \"corner\"\n\
         [wall]\nunit = [200, 200, 100]\nbed_joint = 0\nhead_joint = 0\nlength = {length}\ncourses = {courses}\n\
         unit_material = \"stone\"\ninterface = \"dry\"\nmesh = [2, 1, 1]\nclamped = false\n\
         [[blocks]]\nname = \"ground\"\nsize = [{}, 200, 50]\nat = [-100, 0, -50]\nmaterial = \"stone\"\n\
         mesh = [{}, 1, 1]\n\
         [[contacts]]\nslave = \"wall.bottom\"\nmaster = \"ground.top\"\ninterface = \"dry\"\n\
         [[supports]]\non = \"ground\"\n[[steps]]\nkind = \"gravity\"\n",
        length + 200,
        2 * units + 2
    );
    let deck = Deck::from_str(&text, "wall.toml").expect("the deck");
    Model::from_deck(&deck).expect("its model").0
}

fn limit(c: &mut Criterion) {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut group = c.benchmark_group("limit");
    group.sample_size(10);
    for (name, units, courses) in [("100", 12, 8), ("300", 20, 15)] {
        let model = wall(units, courses);
        for (program, whole) in [("plane", false), ("whole", true)] {
            let settings = LimitSettings {
                associated: true,
                along: Some([1.0, 0.0, 0.0]),
                whole,
                ..LimitSettings::default()
            };
            let run = || analyse(&model, &settings).expect("a factor");
            group.bench_function(format!("{name}/{program}"), |b| {
                b.iter(|| pool.install(run));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, limit);
criterion_main!(benches);
