//! Elements that are similar, but not of one size, have their own volume and stiffness.

use crate::common::blocks::deck_and_model;
use crate::common::scene::completed;

/// A block and another twice as large, each held at its foot, weigh what their volumes weigh. Rigid ones too.
#[test]
fn a_block_twice_as_large_weighs_eight_times_as_much() {
    for rigid in [false, true] {
        let block = |name: &str, size: [u32; 3], x: u32| {
            format!(
                "[[blocks]]\nname = \"{name}\"\nsize = {size:?}\nat = [{x}, 0, 0]\nmaterial = \"stone\"\nrigid = {rigid}\n\
                 [[blocks]]\nname = \"{name} floor\"\nsize = [{}, 330, 35]\nat = [{x}, 0, -35]\nmaterial = \"stone\"\n\
                 [[supports]]\non = \"{name} floor\"\n",
                size[0] + 50
            )
        };
        let text = format!(
            "format = 1\n[materials.stone]\nE = 20000\nnu = 0.2\ndensity = \"2000 kg/m^3\"\n[interfaces.dry]\nf_t = 0\nc = \
             0\ntan_phi = 0.6\nmu = 0.6\nnormal_stiffness = 100\nshear_stiffness = 50\n[[contacts]]\ninterface = \
             \"dry\"\n{}{}[[steps]]\nkind = \"gravity\"\n",
            block("a", [100, 100, 50], 0),
            block("b", [200, 200, 100], 1000)
        );
        let (_, model) = deck_and_model(&text);
        let rows = completed(&model).rows;
        let reactions = &rows.last().unwrap().reactions;
        let weight = |size: [f64; 3], floor: f64| {
            (size.iter().product::<f64>() + floor * 330.0 * 35.0) * 2e-9 * 9810.0
        };
        let exact = [
            weight([100.0, 100.0, 50.0], 150.0),
            weight([200.0, 200.0, 100.0], 250.0),
        ];
        for (reaction, exact) in reactions.iter().zip(exact) {
            // Out-of-balance forces within the tolerance of 5 % of a mean nodal force.
            assert!(
                (reaction[2] / exact - 1.0).abs() < 5e-3,
                "{reactions:?} {exact}"
            );
        }
    }
}
