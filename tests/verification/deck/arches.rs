//! Arch scenes: models from decks, and rejected decks.

use crate::common::blocks::{
    GRAVITY, HEAD, ROUNDING, area_vector, model, nodes, norm, normals_point_out, volume,
};
use wythe::deck::Deck;
use wythe::model::Model;

#[test]
fn an_arch_is_made_of_equal_voussoirs_on_springings() {
    let arch = r#"
[arch]
radius = "1 m"
thickness = 105
width = 200
voussoirs = 7
material = "stone"
interface = "dry"
mesh = [2, 1, 3]
"#;
    let model = model(arch, GRAVITY);
    // A flat-faced voussoir is a prism with the volume ½ (r_o² − r_i²) sin β × width, β = π/7.
    let beta = std::f64::consts::PI / 7.0;
    let exact = 0.5 * (1052.5_f64.powi(2) - 947.5_f64.powi(2)) * beta.sin() * 200.0;
    for body in 0..7 {
        let found = volume(&model, body);
        assert!(
            (found - exact).abs() <= exact * ROUNDING,
            "{found} is not {exact}"
        );
    }
    // The springings: depth t, 1.5 t along the radius.
    for body in [7, 8] {
        let exact = 105.0 * 157.5 * 200.0;
        assert!((volume(&model, body) - exact).abs() <= exact * ROUNDING);
    }
    normals_point_out(&model);
    // 8 joints of 1 × 3 facets; the masters of the springings are single facets
    assert_eq!(model.contact.slave_facets.len(), 24);
    assert_eq!(model.contact.master_facets.len(), 6 * 3 + 2);
    // Slave facets cover the 8 joints of t × width.
    let area: f64 = (model.contact.slave_facets.iter())
        .map(|f| norm(area_vector(nodes(&model, *f))))
        .sum();
    let exact = 8.0 * 105.0 * 200.0;
    assert!((area - exact).abs() <= exact * ROUNDING);
    // Adjacent voussoirs have bitwise equal joint positions.
    let on_masters: Vec<[f64; 3]> = (model.contact.master_facets.iter())
        .flat_map(|f| nodes(&model, *f))
        .collect();
    let inner = (model
        .contact
        .slave_facets
        .iter()
        .zip(&model.contact.slave_body))
    .filter(|(f, _)| nodes(&model, **f).iter().all(|x| x[2] > 1.0));
    let mut count = 0;
    for (facet, _) in inner {
        count += 1;
        assert!(nodes(&model, *facet).iter().all(|x| on_masters.contains(x)));
    }
    assert_eq!(count, 6 * 3);
    assert_eq!(model.supports[0].nodes.len(), 16);
    // The feet are level.
    let lowest = |body: u32| {
        let elements = (0..model.mesh.elements.len()).filter(|e| model.mesh.unit[*e] == body);
        let x = elements.flat_map(|e| model.mesh.corners(e));
        x.map(|x| x[2]).fold(f64::INFINITY, f64::min)
    };
    // sin and cos of π/2 in floating point
    assert!(lowest(0).abs() <= 1e-12 * 1000.0 && lowest(6).abs() <= 1e-12 * 1000.0);

    let by_span = arch.replace("radius = \"1 m\"", "span = 1895");
    let same = crate::common::blocks::model(&by_span, GRAVITY);
    assert_eq!(same.mesh.nodes, model.mesh.nodes);
}

/// Replaced text of a valid arch, its replacement, the key of the error, part of the error.
const BAD_ARCHES: &[(&str, &str, &str, &str)] = &[
    (
        "radius = 1000",
        "",
        "arch.radius",
        "neither `radius` nor `span`",
    ),
    (
        "radius = 1000",
        "radius = 1000\nspan = 1900",
        "arch.span",
        "both",
    ),
    (
        "radius = 1000",
        "radius = -1000",
        "arch.radius",
        "not positive",
    ),
    (
        "thickness = 105",
        "thickness = 1100",
        "arch.thickness",
        "no arch",
    ),
    ("width = 200", "width = 0", "arch.width", "not positive"),
    (
        "voussoirs = 7",
        "voussoirs = 1",
        "arch.voussoirs",
        "no arch",
    ),
    (
        "voussoirs = 7",
        "voussoirs = 7\nangle = 200",
        "arch.angle",
        "an arch over 200",
    ),
    (
        "voussoirs = 7",
        "voussoirs = 7\nmesh = [1, 1, 0]",
        "arch.mesh",
        "leaves no element",
    ),
    (
        "material = \"stone\"",
        "material = \"stobe\"",
        "arch.material",
        "no material named",
    ),
    (
        "interface = \"dry\"",
        "interface = \"wet\"",
        "arch.interface",
        "no interface named",
    ),
    (
        "interface = \"dry\"",
        "interface = \"dry\"\nbulge = 3",
        "arch.bulge",
        "not a known key",
    ),
];

#[test]
fn bad_arches_name_the_key() {
    let arch = "[arch]\nradius = 1000\nthickness = 105\nwidth = 200\nvoussoirs = 7\n\
                material = \"stone\"\ninterface = \"dry\"\n";
    model(arch, GRAVITY);
    for (from, to, key, message) in BAD_ARCHES {
        assert!(arch.contains(from));
        let bad = format!("{HEAD}{}{GRAVITY}", arch.replace(from, to));
        let error = Deck::from_str(&bad, "scene.toml")
            .and_then(|deck| Model::from_deck(&deck))
            .map_or_else(|e| e, |_| panic!("accepted: {to}"));
        assert_eq!(error.key(), *key, "{error}");
        assert!(error.message().contains(message), "{error}");
    }
}

/// A segmental arch given by the clear span and rise of its intrados.
#[test]
fn an_arch_has_its_given_span_and_rise() {
    let arch = r#"
[arch]
span = 2000
rise = 500
thickness = 150
width = 200
voussoirs = 12
material = "stone"
interface = "dry"
"#;
    let deck = crate::common::blocks::deck(&format!("{HEAD}{arch}{GRAVITY}"));
    let own = deck.arch.as_ref().unwrap();
    // s²/4 + f² = 2 r f: r = 1250 mm; the sine of half the angle is 1000/1250.
    assert!(
        (own.centre_line() - 1325.0).abs() < 1e-9,
        "{}",
        own.centre_line()
    );
    assert!((own.embrace() - 2.0 * 0.8_f64.asin()).abs() < 1e-12);
    let model = model(arch, GRAVITY);
    let inside = |x: &&[f64; 3]| (x[0].hypot(x[2]) - 1250.0).abs() < 1e-6;
    let intrados: Vec<&[f64; 3]> = model.mesh.nodes.iter().filter(inside).collect();
    let most = |d: usize| {
        intrados
            .iter()
            .map(|x| x[d])
            .fold(f64::NEG_INFINITY, f64::max)
    };
    let least = |d: usize| intrados.iter().map(|x| x[d]).fold(f64::INFINITY, f64::min);
    assert!((most(0) - least(0) - 2000.0).abs() < 1e-9);
    assert!((most(2) - least(2) - 500.0).abs() < 1e-9);
    // A rise of half the span gives a semicircle.
    let half = arch.replace("rise = 500", "rise = 1000");
    let deck = crate::common::blocks::deck(&format!("{HEAD}{half}{GRAVITY}"));
    assert!((deck.arch.unwrap().embrace() - std::f64::consts::PI).abs() < 1e-12);
    crate::common::blocks::refuses(
        &format!("{HEAD}{arch}{GRAVITY}"),
        &[
            (
                "rise = 500",
                "rise = 1100",
                "arch.rise",
                "more than a semicircle",
                "half the span",
            ),
            (
                "rise = 500",
                "rise = 500\nangle = 90",
                "arch.angle",
                "both `rise` and `angle`",
                "leave out one",
            ),
            (
                "span = 2000",
                "radius = 2000",
                "arch.rise",
                "belongs to a `span`",
                "radius and angle",
            ),
            (
                "rise = 500",
                "rise = 0",
                "arch.rise",
                "0 is not positive",
                "above 0",
            ),
        ],
    );
}
