//! Block scenes as decks, and measures of their meshes.

use wythe::deck::Deck;
use wythe::model::Model;

/// Rounding of a few hundred sums of coordinates, relative to their size.
pub const ROUNDING: f64 = 1e-12;

/// Materials, interfaces and contact points of a deck.
pub const HEAD: &str = r#"
format = 1

[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2000 kg/m^3"

[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.4
mu = 0.4

[interfaces.smooth]
f_t = 0
c = 0
tan_phi = 0
mu = 0

[contact]
points = "corner"
"#;

/// A base and a block with a different mesh on it.
pub const PAIR: &str = r#"
[[blocks]]
name = "base"
size = [400, 200, 50]
at = [-100, -50, -50]
material = "stone"
mesh = [2, 1, 1]

[[blocks]]
name = "top"
size = [200, 100, 80]
material = "stone"
mesh = [4, 2, 1]
velocity = ["1 m/s", 0, 0]

[[contacts]]
slave = "top.bottom"
master = "base.top"
interface = "dry"

[[supports]]
on = "base"
"#;

/// A step of gravity.
pub const GRAVITY: &str = "\n[[steps]]\nkind = \"gravity\"\n";

/// Reads a deck.
pub fn deck(text: &str) -> Deck {
    Deck::from_str(text, "scene.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// A deck and its model.
pub fn deck_and_model(text: &str) -> (Deck, Model) {
    let deck = deck(text);
    let (model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}"));
    (deck, model)
}

/// The model of a scene between [`HEAD`] and its steps.
pub fn model(scene: &str, steps: &str) -> Model {
    deck_and_model(&format!("{HEAD}{scene}{steps}")).1
}

/// Corners of a facet [mm].
pub fn nodes(model: &Model, facet: [u32; 4]) -> [[f64; 3]; 4] {
    facet.map(|n| model.mesh.nodes[n as usize])
}

/// Area along the normal [mm²].
pub fn area_vector(q: [[f64; 3]; 4]) -> [f64; 3] {
    let d = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let (u, v) = (d(q[2], q[0]), d(q[3], q[1]));
    [
        0.5 * (u[1] * v[2] - u[2] * v[1]),
        0.5 * (u[2] * v[0] - u[0] * v[2]),
        0.5 * (u[0] * v[1] - u[1] * v[0]),
    ]
}

pub fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Volume of a body [mm³].
pub fn volume(model: &Model, body: u32) -> f64 {
    let of = |e: &usize| model.mesh.unit[*e] == body;
    (0..model.mesh.elements.len())
        .filter(of)
        .map(|e| model.mesh.volume(e))
        .sum()
}

/// Checks that every facet's normal points away from the centre of its body.
pub fn normals_point_out(model: &Model) {
    let contact = &model.contact;
    let slaves = contact.slave_facets.iter().zip(&contact.slave_body);
    let masters = contact.master_facets.iter().zip(&contact.master_body);
    for (facet, body) in slaves.chain(masters) {
        let mut of_body: Vec<u32> = (0..model.mesh.elements.len())
            .filter(|e| model.mesh.unit[*e] == *body)
            .flat_map(|e| model.mesh.elements[e])
            .collect();
        of_body.sort_unstable();
        of_body.dedup();
        assert!(facet.iter().all(|n| of_body.contains(n)));
        let centre = [0, 1, 2].map(|d| {
            let sum: f64 = of_body
                .iter()
                .map(|n| model.mesh.nodes[*n as usize][d])
                .sum();
            sum / of_body.len() as f64
        });
        let x = nodes(model, *facet);
        let out: f64 = (0..3)
            .map(|d| area_vector(x)[d] * (x.iter().map(|x| x[d]).sum::<f64>() / 4.0 - centre[d]))
            .sum();
        assert!(out > 0.0, "facet {facet:?} of body {body} looks inwards");
    }
}

/// Part of a deck, its replacement, and the expected key, message and advice.
pub type Bad<'a> = (&'a str, &'a str, &'a str, &'a str, &'a str);

/// Checks that each change to `good` is rejected with its key, message and advice, file and line.
pub fn refuses(good: &str, changes: &[Bad]) {
    let mut wrong = Vec::new();
    for (from, to, key, message, advice) in changes {
        // Replace the last occurrence, because blocks repeat some keys.
        let at = good.rfind(from).unwrap_or_else(|| panic!("no {from}"));
        let bad = format!("{}{to}{}", &good[..at], &good[at + from.len()..]);
        let error = Deck::from_str(&bad, "scene.toml")
            .and_then(|deck| Model::from_deck(&deck))
            .map_or_else(|e| e, |_| panic!("accepted: {to}"));
        let right = error.key() == *key
            && error.message().contains(message)
            && error.advice().contains(advice)
            && error.line().is_some()
            && error.file() == "scene.toml";
        if !right {
            wrong.push(format!("{to}\n{error}\n(advice: {})\n", error.advice()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
