use super::*;
use crate::results::fake;
use crate::results::vtkhdf::read::RestSurface;
use crate::state::InterfaceState;

/// The two cubes with one facet of a joint on the right face of the left cube.
fn snapshot() -> Snapshot {
    let mut model = fake::model();
    model.contact.slave_facets = vec![[1, 2, 6, 5]];
    let frame = fake::frame(&model, 1.0);
    let corners = [1, 2, 6, 5].map(|n: usize| model.mesh.nodes[n]);
    let points = super::super::quarters::WEIGHTS
        .map(|w| [0, 1, 2].map(|i| (0..4).map(|a| w[a] * corners[a][i]).sum::<f64>()));
    let quads = super::super::quarters::QUARTERS.map(|q| q.map(|n| n as u32));
    Snapshot {
        title: "Two cubes & a <gap>".to_owned(),
        frame,
        mesh: model.mesh,
        surface: RestSurface {
            points: points.to_vec(),
            quads: quads.to_vec(),
        },
        surface_displacement: vec![[0.0; 3]; 9],
        ..Snapshot::default()
    }
}

fn picture(of: &Snapshot, view: View) -> String {
    let look = Look {
        view,
        ..Look::default()
    };
    wall_picture(of, None, &look).unwrap()
}

#[test]
fn each_face_is_drawn_once_and_crushing_is_marked() {
    let of = snapshot();
    let svg = picture(&of, View::default());
    assert_eq!(svg.matches("<polygon").count(), 2);
    // One of the two cubes has compressive damage 0, the other 0.4.
    assert_eq!(svg.matches(r#"class="crushed""#).count(), 1);
    assert!(svg.contains("Two cubes &amp; a &lt;gap&gt;"));
    assert!(svg.contains("front, seen from −y"));
    assert!(!svg.contains("NaN"));
}

/// The opening of a joint is the width of its line, from the front and in a section through it.
#[test]
fn a_joint_shows_its_state_and_opening() {
    let mut of = snapshot();
    of.frame.crack_width.fill(0.0);
    for (state, name) in [
        (InterfaceState::FailedOpen, 2),
        (InterfaceState::FailedSliding, 3),
        (InterfaceState::Softening, 1),
    ] {
        of.frame.interfaces.state = vec![state; 4];
        let stroke = format!(r#"stroke="{}""#, hex(colours::STATES[name]));
        for view in [View::default(), View::Section { axis: 1, at: 30.0 }] {
            let svg = picture(&of, view);
            let wall = svg.split(r#"<g class="wall""#).nth(1).unwrap();
            let wall = wall.split("</g>").next().unwrap();
            assert_eq!(wall.matches(&stroke).count(), 2, "{state:?} {view:?}");
        }
    }
    of.frame.interfaces.state = vec![InterfaceState::FailedOpen; 4];
    of.frame.interfaces.opening = vec![0.2, 0.2, 0.05, 0.05];
    let look = Look {
        view: View::Section { axis: 1, at: 30.0 },
        ..Look::default()
    };
    let svg = wall_picture(&of, None, &look).unwrap();
    // 9 px for 0.2 mm, a quarter of it for 0.05 mm.
    for width in ["9.00", "2.25"] {
        let open = format!(
            r#"stroke="{}" stroke-width="{width}""#,
            hex(colours::STATES[2])
        );
        assert_eq!(svg.matches(&open).count(), 1, "{width}");
    }
}

/// From behind, the joint lies at the mirrored place.
#[test]
fn both_faces_show_the_joint() {
    let of = snapshot();
    let places = ["front", "back"].map(|view| {
        let svg = picture(&of, view.parse().unwrap());
        let stroke = format!(r#"stroke="{}""#, hex(colours::STATES[1]));
        let line = svg.lines().find(|l| l.contains(&stroke));
        let line = line.unwrap_or_else(|| panic!("{view}: {svg}"));
        let x = line.split('M').nth(1).unwrap().split(',').next().unwrap();
        x.parse::<f64>().unwrap()
    });
    assert!(
        (places[0] + places[1] - WIDTH).abs() < 0.1 * WIDTH,
        "{places:?}"
    );
    assert!((places[0] - places[1]).abs() > 1.0);
}

#[test]
fn dimensions_and_the_scale_are_of_the_wall_at_rest() {
    let svg = picture(&snapshot(), View::default());
    assert!(
        svg.contains(">202 mm<") && svg.contains(">100 mm<"),
        "{svg}"
    );
    assert!(!picture(&snapshot(), "iso".parse().unwrap()).contains(">202 mm<"));
}
