//! Draws the wall of a seed and writes its deck. The deck is that of a beginner, who gives sizes and strengths but
//! no key of the solver.
//!
//! The order of the random numbers is part of the definition: another order, or one number more, changes the walls
//! of all seeds.

use std::fmt::{self, Write as _};

use super::python_random::PythonRandom;

/// A random wall of `wythe study zoo`.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Length, thickness and height of a unit [mm].
    pub unit: [f64; 3],
    /// Thickness of bed and head joints [mm]; 0 for a dry wall.
    pub joint: f64,
    /// Bond, by its name in decks.
    pub bond: &'static str,
    /// Length of the wall [mm].
    pub length: f64,
    /// Number of courses.
    pub courses: usize,
    /// Whether it has an opening with a lintel.
    pub opening: bool,
    /// Pressure on top [MPa]; not used under an air bag.
    pub pressure: f64,
    /// Kind of load.
    pub load: Load,
    /// Material of the units.
    pub brick: Solid,
    /// Material of the mortar; not used by dry walls.
    pub mortar: Solid,
    /// Strengths of the joints.
    pub bonding: Bonding,
    /// Its deck.
    pub deck: String,
}

/// Stiffness and strengths of a solid [MPa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Young's modulus.
    pub e: f64,
    /// Tensile strength.
    pub f_t: f64,
    /// Compressive strength.
    pub f_c: f64,
}

/// Strengths of the joints; a dry joint has friction only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bonding {
    /// Tensile strength [MPa].
    pub f_t: f64,
    /// Cohesion [MPa].
    pub c: f64,
    /// Initial friction coefficient [-].
    pub tan_phi: f64,
    /// Friction coefficient after sliding [-].
    pub mu: f64,
}

impl Solid {
    /// A solid with random values in these ranges; the compressive strength is `times` the tensile strength.
    fn drawn(r: &mut PythonRandom, e: [f64; 2], f_t: [f64; 2], times: [f64; 2]) -> Self {
        let e = r.uniform(e[0], e[1]);
        let f_t = r.uniform(f_t[0], f_t[1]);
        let f_c = f_t * r.uniform(times[0], times[1]);
        Self { e, f_t, f_c }
    }
}

impl Bonding {
    fn drawn(r: &mut PythonRandom) -> Self {
        let c = r.uniform(0.05, 0.9);
        let tan_phi = r.uniform(0.5, 1.05);
        let mu = tan_phi * r.uniform(0.7, 1.0);
        let f_t = c * r.uniform(0.2, 0.9) / tan_phi.max(1.0);
        Self {
            f_t,
            c,
            tan_phi,
            mu,
        }
    }
}

/// Kinds of load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// Pressed vertically, then pushed in plane; the top stays level or is free.
    Push,
    /// Pressed vertically, then pushed in plane with a free top.
    Free,
    /// Pressed vertically, then pushed in plane in cycles.
    Cyclic,
    /// Held along its edges, then loaded out of plane by an air bag.
    Airbag,
    /// Under its weight, then loaded as in `Push`.
    GravityPush,
    /// Under its weight and a pressure, then its top is displaced out of plane.
    Settle,
}

impl Load {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Push => "push",
            Self::Free => "free",
            Self::Cyclic => "cyclic",
            Self::Airbag => "airbag",
            Self::GravityPush => "gravity-push",
            Self::Settle => "settle",
        }
    }
}

/// Length, thickness, height [mm].
const UNITS: [[f64; 3]; 8] = [
    [204.0, 98.0, 50.0],
    [250.0, 120.0, 55.0],
    [215.0, 102.5, 65.0],
    [240.0, 115.0, 71.0],
    [290.0, 140.0, 190.0],
    [112.0, 53.0, 36.0],
    [440.0, 140.0, 215.0],
    [390.0, 190.0, 190.0],
];
const JOINTS: [f64; 6] = [3.0, 8.0, 10.0, 10.0, 12.5, 15.0];
/// Part of the walls that have dry joints [-].
const DRY: f64 = 0.08;
const BONDS: [&str; 10] = [
    "stretcher",
    "stretcher",
    "stretcher",
    "stretcher",
    "stretcher",
    "stretcher",
    "stack",
    "flemish",
    "english",
    "header",
];
const LOADS: [Load; 11] = [
    Load::Push,
    Load::Push,
    Load::Push,
    Load::Push,
    Load::Push,
    Load::Free,
    Load::Cyclic,
    Load::Airbag,
    Load::Airbag,
    Load::GravityPush,
    Load::Settle,
];
/// Pressures [MPa].
const PRESSURES: [f64; 8] = [0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0];
/// Approximate largest number of units in a wall: it keeps a study of two hundred walls affordable.
const UNITS_AT_MOST: f64 = 110.0;

/// Writing to a `String` cannot fail.
macro_rules! say {
    ($to:expr, $($text:tt)*) => {{ let _ = writeln!($to, $($text)*); }};
}

impl Wall {
    /// The wall of a seed.
    pub fn drawn(seed: u64) -> Self {
        let mut random = PythonRandom::new(seed);
        let r = &mut random;
        let unit @ [l, t, h] = r.choice(&UNITS);
        let dry = r.random() <= DRY;
        let joint = if dry { 0.0 } else { r.choice(&JOINTS) };
        let mut bond = r.choice(&BONDS);
        let of_leaves = |bond| matches!(bond, "flemish" | "english" | "header");
        if of_leaves(bond) && (dry || l < 2.0 * t) {
            bond = "stretcher"; // with two leaves, a header is as long as the wall is thick
        }
        let units_long = r.choice(&[2.5, 3.0, 3.5, 4.0, 4.5, 5.0]);
        let long = |units: f64| units * (l + joint) - joint;
        let length = if of_leaves(bond) {
            long(r.choice(&[3.0, 4.0]))
        } else {
            long(units_long)
        };
        let height = length * r.choice(&[0.6, 0.8, 1.0, 1.0, 1.3, 1.8]);
        let mut courses = (height / (h + joint)).round_ties_even().max(4.0);
        while courses * units_long > UNITS_AT_MOST {
            courses = (courses * 0.8).trunc().max(4.0);
        }
        let brick = Solid::drawn(r, [3000.0, 20000.0], [0.8, 4.0], [4.0, 12.0]);
        let mortar = Solid::drawn(r, [600.0, 9000.0], [0.3, 2.0], [5.0, 10.0]);
        let bonding = Bonding::drawn(r);
        let pressure = r.choice(&PRESSURES).min(0.3 * brick.f_c.min(mortar.f_c));
        let load = r.choice(&LOADS);
        let mut wall = Self {
            seed,
            unit,
            joint,
            bond,
            length,
            courses: courses as usize,
            opening: false,
            pressure,
            load,
            brick,
            mortar,
            bonding,
            deck: String::new(),
        };
        let tables = wall.tables(r);
        // A number is drawn for every wall, so that later draws do not depend on the condition.
        let opening = r.random() < 0.15;
        wall.opening = opening
            && bond == "stretcher"
            && wall.courses >= 8
            && units_long >= 4.0
            && matches!(load, Load::Push | Load::Cyclic | Load::GravityPush);
        let scene = wall.scene();
        let steps = wall.steps(r);
        wall.deck = tables + &scene + &steps;
        wall
    }

    /// Height of the wall, including a joint on top [mm].
    fn height(&self) -> f64 {
        self.courses as f64 * (self.unit[2] + self.joint)
    }

    fn dry(&self) -> bool {
        self.joint == 0.0
    }

    /// Text of title, materials and interface.
    fn tables(&self, r: &mut PythonRandom) -> String {
        let ([l, t, h], j) = (self.unit, self.joint);
        let mut deck = format!("format = 1\ntitle = \"zoo {}\"\n", self.seed);
        let volume = if self.dry() {
            l * t * h / 8.0
        } else {
            (l + j) / 5.0 * t / 2.0 * h
        };
        say!(deck, "\n[materials.brick]");
        material(&mut deck, r, self.brick, volume, 1800.0);
        if self.dry() {
            let friction = self.bonding.tan_phi;
            say!(deck, "\n[interfaces.joint]\nf_t = 0\nc = 0");
            say!(deck, "tan_phi = {friction:.3}\nmu = {friction:.3}");
            return deck;
        }
        say!(deck, "\n[materials.mortar]");
        let volume = (l / 4.0) * t / 2.0 * j.max(3.0);
        material(&mut deck, r, self.mortar, volume, 1700.0);
        let Bonding {
            f_t,
            c,
            tan_phi,
            mu,
        } = self.bonding;
        say!(deck, "\n[interfaces.joint]");
        say!(deck, "f_t = \"{} MPa\"\nc = \"{} MPa\"", G(f_t, 6), G(c, 6));
        say!(deck, "tan_phi = {tan_phi:.3}\nmu = {mu:.3}");
        say!(deck, "zeta = {:.3}", r.uniform(2.0, 6.0));
        say!(deck, "xi = {:.3}", r.uniform(1.0, 5.0));
        say!(deck, "G_I = \"{} N/mm\"", G(r.uniform(0.005, 0.03), 6));
        say!(deck, "G_II = \"{} N/mm\"", G(r.uniform(0.03, 0.3), 6));
        deck
    }

    /// Text of the table `[wall]`.
    fn scene(&self) -> String {
        let ([l, t, h], j, length) = (self.unit, self.joint, self.length);
        let mut deck = String::new();
        say!(deck, "\n[wall]\nunit = [{l}, {t}, {h}]");
        say!(deck, "bed_joint = {j}\nhead_joint = {j}");
        say!(
            deck,
            "length = {}\ncourses = {}",
            G(length, 6),
            self.courses
        );
        say!(deck, "unit_material = \"brick\"\ninterface = \"joint\"");
        say!(deck, "bond = \"{}\"", self.bond);
        if !self.dry() {
            say!(deck, "mortar_material = \"mortar\"");
        }
        if self.opening {
            let (from, to) = (G(length * 0.35, 5), G(length * 0.65, 5));
            let (sill, courses) = (self.courses / 4, self.courses / 3);
            let bearing = G(l * 0.5, 4);
            say!(
                deck,
                "openings = [{{ from = {from}, to = {to}, sill = {sill}, courses = {courses}, lintel = {{ bearing = {bearing} }} }}]"
            );
        }
        if self.load == Load::Airbag {
            say!(deck, "clamped = false");
        }
        deck
    }

    /// Text of supports, probes and steps.
    fn steps(&self, r: &mut PythonRandom) -> String {
        let drive = self.height() * r.choice(&[0.002, 0.003, 0.005]);
        let thickness = self.unit[1];
        let preload = format!(
            "[[steps]]\nkind = \"preload\"\ntop_pressure = \"{} MPa\"\n",
            G(self.pressure, 6)
        );
        let gravity = "[[steps]]\nkind = \"gravity\"\n";
        let mut deck = String::new();
        match self.load {
            Load::Airbag => {
                let middle = [self.length / 2.0, self.height() / 2.0].map(|x| G(x, 5));
                deck += "\n[[supports]]\non = \"wall.bottom\"\n\
                    [[supports]]\non = [\"wall.left\", \"wall.right\"]\nfixed = [\"y\"]\n\
                    [[supports]]\non = \"wall.top\"\nfixed = [\"y\"]\n";
                say!(deck, "\n[[probes]]\nname = \"mid\"\non = \"wall\"");
                say!(deck, "near = [{}, {thickness}, {}]", middle[0], middle[1]);
                say!(deck, "direction = \"y\"\n\n{gravity}");
                say!(
                    deck,
                    "[[steps]]\nkind = \"load\"\nprocedure = \"displacement_control\""
                );
                say!(
                    deck,
                    "control = {{ probe = \"mid\", displacement = {} }}",
                    G(thickness * 0.1, 4)
                );
                say!(
                    deck,
                    "[[steps.loads]]\nname = \"air\"\non = \"wall.front\"\npressure = \"10 kPa\""
                );
            }
            Load::Settle => {
                say!(
                    deck,
                    "\n{gravity}{preload}[[steps]]\nkind = \"drive\"\ndirection = \"y\""
                );
                say!(deck, "displacement = {}", G(thickness * 0.05, 4));
            }
            load => {
                if load == Load::GravityPush {
                    deck += &format!("\n{gravity}");
                }
                deck += &format!("\n{preload}");
                // The load `Free` fixes this choice and draws no number.
                let vertical = match load {
                    Load::Free => "free",
                    _ => r.choice(&["locked", "locked", "free"]),
                };
                say!(deck, "\n[[steps]]\nkind = \"drive\"\ndirection = \"x\"");
                if load == Load::Cyclic {
                    let [a, b, c] = [drive * 0.25, drive * 0.5, drive].map(|x| G(x, 4));
                    say!(deck, "cycles = {{ amplitudes = [{a}, {b}, {c}] }}");
                } else {
                    say!(deck, "displacement = {}", G(drive, 4));
                }
                say!(deck, "vertical = \"{vertical}\"");
            }
        }
        deck
    }
}

/// Draws the tables of a solid and writes them. Their strains are large enough to exclude a snap-back within an
/// element. `volume`: volume of an element, whose cube root is the reference length [mm³]; `density` [kg/m³].
fn material(deck: &mut String, r: &mut PythonRandom, solid: Solid, volume: f64, density: f64) {
    let Solid { e, f_t, f_c } = solid;
    let softening = r.uniform(0.0015, 0.004);
    let cracked = (2.2 * 20.0 * 0.05 * f_t / e).max(0.0015 * r.uniform(0.8, 2.0));
    let crushed = (2.5 * f_c / e).max(r.uniform(0.006, 0.02));
    say!(deck, "E = \"{} MPa\"", G(e, 6));
    say!(deck, "nu = {:.3}", r.uniform(0.12, 0.22));
    say!(deck, "density = \"{density} kg/m^3\"");
    let (f, rest, end) = (G(f_t, 4), G(f_t * 0.07, 4), G(cracked, 4));
    say!(deck, "tension = [[{f}, 0, 0], [{rest}, {end}, 0.9]]");
    let (yields, f, rest) = (G(f_c * 0.92, 4), G(f_c, 4), G(f_c * 0.06, 4));
    let (peak, end) = (G(softening * 0.5, 4), G(crushed + softening, 4));
    say!(
        deck,
        "compression = [[{yields}, 0, 0], [{f}, {peak}, 0], [{rest}, {end}, 0.9]]"
    );
    let length = volume.powf(1.0 / 3.0);
    say!(deck, "reference_length = \"{} mm\"", G(length, 6));
}

/// A number with this many significant digits as `%g` of C and Python writes it: without trailing zeros, and with
/// an exponent if it is below 1e-4 or has more digits before the point.
struct G(f64, usize);

impl fmt::Display for G {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, digits) = *self;
        // Rounding comes first: 9.9999 with four digits has the exponent of 10.
        let scientific = format!("{value:.*e}", digits - 1);
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        let trimmed = |text: &str| {
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text.to_owned()
            }
        };
        if exponent < -4 || exponent >= digits as i32 {
            let sign = if exponent < 0 { '-' } else { '+' };
            let exponent = exponent.abs();
            return write!(f, "{}e{sign}{exponent:02}", trimmed(mantissa));
        }
        let decimals = (digits as i32 - 1 - exponent) as usize;
        f.write_str(&trimmed(&format!("{value:.decimals$}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sha2::{Digest, Sha256};
    use std::path::{Path, PathBuf};
    use wythe_core::deck::Deck;
    use wythe_core::model::Model;

    /// Decks written by the original Python program of the zoo.
    fn stored() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/zoo")
    }

    #[test]
    fn decks_are_those_that_python_drew() {
        for seed in [2, 7, 15, 28, 34, 92] {
            let text = std::fs::read_to_string(stored().join(format!("{seed}.toml"))).unwrap();
            assert_eq!(Wall::drawn(seed).deck, text, "{seed}");
        }
        let sums = std::fs::read_to_string(stored().join("decks.sha256")).unwrap();
        assert_eq!(sums.lines().count(), 202);
        for line in sums.lines() {
            let (sum, name) = line.split_once("  ").unwrap();
            let seed = name.strip_suffix(".toml").unwrap().parse().unwrap();
            let deck = Wall::drawn(seed).deck;
            let ours: String = Sha256::digest(deck)
                .iter()
                .map(|b| format!("{b:02x}"))
                .collect();
            assert_eq!(ours, sum, "{seed}");
        }
    }

    #[test]
    fn every_kind_of_wall_is_drawn_and_its_deck_is_sound() {
        let walls: Vec<Wall> = (1..=120).map(Wall::drawn).collect();
        for load in LOADS {
            assert!(walls.iter().any(|w| w.load == load), "{load:?}");
        }
        for bond in BONDS {
            assert!(walls.iter().any(|w| w.bond == bond), "{bond}");
        }
        assert!(walls.iter().any(Wall::dry) && walls.iter().any(|w| w.opening));
        // Building all models would take too long; every tenth is built.
        for wall in walls.iter().step_by(10) {
            let deck = Deck::from_str(&wall.deck, "zoo.toml").unwrap();
            Model::from_deck(&deck).unwrap_or_else(|e| panic!("seed {}: {e}", wall.seed));
        }
    }

    #[test]
    fn numbers_are_written_as_percent_g_writes_them() {
        for (value, digits, text) in [
            (100.0, 4, "100"),
            (0.0001234567, 4, "0.0001235"),
            (0.00001234567, 4, "1.235e-05"),
            (1234567.0, 6, "1.23457e+06"),
            (999999.6, 6, "1e+06"),
            (0.5, 6, "0.5"),
            (2.72, 4, "2.72"),
            (120.0, 2, "1.2e+02"),
        ] {
            assert_eq!(G(value, digits).to_string(), text);
        }
    }
}
