//! Directions from which a wall is seen, and sections.

use std::str::FromStr;

use crate::results::ReadError;

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// The outside, seen along this direction: degrees from the front (−y) towards the right (+x), and degrees above
    /// the horizontal.
    Outside {
        /// 0 front, 90 right, 180 back, 270 left.
        turned: f64,
        /// −90 to 90.
        raised: f64,
    },
    /// Section normal to an axis (0 to 2) at a position [mm]: vertical ones seen from +x or −y, plans from above.
    Section {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// Coordinate on the axis at rest [mm].
        at: f64,
    },
}

/// Views with a name.
const NAMED: [(&str, [f64; 2]); 6] = [
    ("front", [0.0, 0.0]),
    ("right", [90.0, 0.0]),
    ("back", [180.0, 0.0]),
    ("left", [270.0, 0.0]),
    ("top", [0.0, 90.0]),
    ("iso", [35.0, 25.0]),
];
const AXES: [&str; 3] = ["x", "y", "z"];

impl Default for View {
    fn default() -> Self {
        Self::outside([0.0, 0.0])
    }
}

impl View {
    const fn outside([turned, raised]: [f64; 2]) -> Self {
        Self::Outside { turned, raised }
    }

    /// Reads a section as `y=125`.
    ///
    /// # Errors
    /// Words on the expected form.
    pub fn section(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no section: expected an axis and mm, e.g. y=125");
        let (axis, at) = text.split_once('=').ok_or_else(wrong)?;
        let axis = AXES
            .iter()
            .position(|a| *a == axis.trim())
            .ok_or_else(wrong)?;
        let at = at.trim().trim_end_matches("mm").trim_end();
        let at: f64 = at.parse().map_err(|_| wrong())?;
        if at.is_finite() {
            Ok(Self::Section { axis, at })
        } else {
            Err(wrong())
        }
    }

    /// Part of a file name: nothing for the front.
    pub fn file_name(&self) -> String {
        match *self {
            Self::Outside { turned, raised } => match self.name() {
                Some("front") => String::new(),
                Some(name) => format!("_{name}"),
                None => format!("_{turned}_{raised}"),
            },
            Self::Section { axis, at } => format!("_{}{at}", AXES[axis]),
        }
    }

    /// In words.
    pub fn told(&self) -> String {
        match *self {
            Self::Outside { turned, raised } => match self.name() {
                Some("front") => "front, seen from −y".to_owned(),
                Some("back") => "back, seen from +y".to_owned(),
                Some("right") => "right end, seen from +x".to_owned(),
                Some("left") => "left end, seen from −x".to_owned(),
                Some("top") => "top, seen from +z".to_owned(),
                _ => format!("turned by {turned}°, from {raised}° above"),
            },
            Self::Section { axis, at } => format!("section {} = {at} mm", AXES[axis]),
        }
    }

    fn name(&self) -> Option<&'static str> {
        let named = NAMED.iter().find(|(_, of)| Self::outside(*of) == *self);
        named.map(|(name, _)| *name)
    }

    /// Whether lengths in the picture are lengths of the wall in both directions.
    pub fn is_square(&self) -> bool {
        self.name().is_none_or(|name| name != "iso") && {
            let whole = |degrees: f64| degrees.rem_euclid(90.0) == 0.0;
            match *self {
                Self::Outside { turned, raised } => whole(turned) && whole(raised),
                Self::Section { .. } => true,
            }
        }
    }

    /// The camera.
    pub(super) fn camera(&self) -> Camera {
        let [turned, raised] = match *self {
            Self::Outside { turned, raised } => [turned, raised],
            Self::Section { axis: 0, .. } => [90.0, 0.0],
            Self::Section { axis: 1, .. } => [0.0, 0.0],
            Self::Section { .. } => [0.0, 90.0],
        };
        let (a, e) = (turned.to_radians(), raised.to_radians());
        // Right angles give exact axes.
        let round = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
        let [sa, ca, se, ce] = [a.sin(), a.cos(), e.sin(), e.cos()].map(round);
        Camera {
            right: [ca, sa, 0.0],
            up: [-sa * se, ca * se, ce],
            toward: [sa * ce, -ca * ce, se],
        }
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some((_, of)) = NAMED.iter().find(|(name, _)| *name == text) {
            return Ok(Self::outside(*of));
        }
        let wrong = || {
            format!(
                "`{text}` is no view: expected front, back, left, right, top, iso, or degrees around \
                 and above, e.g. 35,25"
            )
        };
        let (turned, raised) = text.split_once(',').ok_or_else(wrong)?;
        let degrees = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
        let (turned, raised) = (degrees(turned)?, degrees(raised)?);
        if turned.is_finite() && raised.abs() <= 90.0 {
            Ok(Self::outside([turned, raised]))
        } else {
            Err(wrong())
        }
    }
}

/// Directions of a parallel projection, of length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Camera {
    pub right: [f64; 3],
    pub up: [f64; 3],
    /// Towards the viewer.
    pub toward: [f64; 3],
}

impl Camera {
    /// Right and up [mm].
    pub fn flat(&self, x: [f64; 3]) -> [f64; 2] {
        [dot(self.right, x), dot(self.up, x)]
    }

    /// Nearness to the viewer [mm].
    pub fn near(&self, x: [f64; 3]) -> f64 {
        dot(self.toward, x)
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Error of a section that meets nothing.
pub(super) fn no_section(axis: usize, at: f64, [low, high]: [f64; 2]) -> ReadError {
    ReadError::NoSection {
        axis: AXES[axis],
        at,
        low,
        high,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_read_and_named() {
        let view = |text: &str| text.parse::<View>().unwrap();
        assert_eq!(view("front"), View::default());
        assert_eq!(view("180,0"), view("back"));
        assert_eq!(view("back").file_name(), "_back");
        assert_eq!(view("10,-20").file_name(), "_10_-20");
        assert!(view("back").is_square() && view("top").is_square());
        assert!(!view("iso").is_square() && !view("10,0").is_square());
        let section = View::section("y = 12.5 mm").unwrap();
        assert_eq!(section, View::Section { axis: 1, at: 12.5 });
        assert_eq!(section.file_name(), "_y12.5");
        for wrong in ["behind", "1", "nan,0", "0,91", "a,b"] {
            assert!(wrong.parse::<View>().is_err(), "{wrong}");
        }
        for wrong in ["y", "w=1", "y=", "y=inf", "y=1 m"] {
            assert!(View::section(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn axes_are_those_of_the_eye() {
        for (name, right, up, toward) in [
            ("front", [1., 0., 0.], [0., 0., 1.], [0., -1., 0.]),
            ("back", [-1., 0., 0.], [0., 0., 1.], [0., 1., 0.]),
            ("right", [0., 1., 0.], [0., 0., 1.], [1., 0., 0.]),
            ("left", [0., -1., 0.], [0., 0., 1.], [-1., 0., 0.]),
            ("top", [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]),
        ] {
            let camera = name.parse::<View>().unwrap().camera();
            let plain = |v: [f64; 3]| v.map(|x| x + 0.0);
            assert_eq!(plain(camera.right), right, "{name}");
            assert_eq!(plain(camera.up), up, "{name}");
            assert_eq!(plain(camera.toward), toward, "{name}");
        }
    }
}
