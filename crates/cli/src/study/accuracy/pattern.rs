//! Crack patterns on a grid in the elevation, so that runs with different meshes can be compared.
//!
//! ```text
//!   z ▲   . . # . .      # an element in the cell is cracked, or a joint in it has lost half of its bond,
//!     │   . . # # .        at any y: half a model by symmetry in y has the same pattern as the whole
//!     └──▶ x
//! ```

use std::fmt::Write as _;
use std::path::Path;

use wythe_core::error::IoError;
use wythe_core::model::{Mesh, Model};
use wythe_core::state::{Frame, InterfaceState};

/// Name of the file beside a `scene.toml`.
pub const PATTERN: &str = "pattern.txt";

/// Side of a cell [mm], about the thickness of a joint.
const CELL: f64 = 10.0;
/// Damage at or above which an element (in tension) or a quarter of a joint facet counts as cracked [-].
const TORN: f64 = 0.5;
/// Crack width at or above which an element counts as cracked [mm]: visible to the naked eye.
const WIDE: f64 = 0.05;
/// Part of a cell by which rounding may change a coordinate [-]: joints often lie on the edges of cells.
const ROUNDING: f64 = 1e-6;

/// Cracked elements and joint points of a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cracks {
    /// Whether an element is cracked. `[element]`
    torn: Vec<bool>,
    /// Whether a joint point has failed, four points per facet. `[slave facet][point]`
    parted: Vec<bool>,
}

impl Cracks {
    /// Cracks of a frame.
    pub fn of(frame: &Frame) -> Self {
        let elements = frame.tensile_damage.iter().zip(&frame.crack_width);
        let points = frame.interfaces.state.iter().zip(&frame.interfaces.damage);
        // A dry joint has no bond that could be damaged, so its state decides.
        let parted = |(state, damage): (&InterfaceState, &f64)| match state {
            InterfaceState::FailedOpen | InterfaceState::FailedSliding => true,
            InterfaceState::Softening => *damage >= TORN,
            InterfaceState::Intact => false,
        };
        Self {
            torn: elements.map(|(d, w)| *d >= TORN || *w >= WIDE).collect(),
            parted: points.map(parted).collect(),
        }
    }
}

/// Square cells over an elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Side of a cell [mm].
    cell: f64,
    /// Lower left corner [mm]. `[x, z]`
    corner: [f64; 2],
    /// Numbers of columns and rows.
    size: [usize; 2],
}

impl Grid {
    /// Grid over all solids.
    pub fn over(mesh: &Mesh) -> Self {
        let [[x, right], [z, top]] = [mesh.extent(0), mesh.extent(2)];
        let count = |from: f64, to: f64| ((to - from) / CELL - ROUNDING).ceil().max(1.0) as usize;
        Self {
            cell: CELL,
            corner: [x, z],
            size: [count(x, right), count(z, top)],
        }
    }

    /// Cell at a point; none outside the grid.
    fn cell_at(&self, point: [f64; 2]) -> Option<usize> {
        let [column, row] = [0, 1].map(|i| {
            let along = ((point[i] - self.corner[i]) / self.cell + ROUNDING).floor();
            // A point on the far edge belongs to the last cell.
            let last = self.size[i] as f64 - 1.0;
            let on_edge = along == last + 1.0
                && point[i] - self.corner[i] <= (last + 1.0 + ROUNDING) * self.cell;
            (if on_edge { last } else { along }, last)
        });
        let inside = [column, row]
            .iter()
            .all(|(i, last)| (0.0..=*last).contains(i));
        inside.then(|| row.0 as usize * self.size[0] + column.0 as usize)
    }
}

/// Cracked cells of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    grid: Grid,
    /// Whether a cell is cracked. `[row from the bottom][column]`
    cracked: Vec<bool>,
}

impl Pattern {
    /// Cracks of a model on a grid.
    pub fn of(model: &Model, cracks: &Cracks, grid: Grid) -> Self {
        let mut pattern = Self {
            grid,
            cracked: vec![false; grid.size[0] * grid.size[1]],
        };
        let torn = cracks.torn.iter().enumerate().filter(|(_, torn)| **torn);
        for (e, _) in torn {
            pattern.fill(&model.mesh.corners(e));
        }
        for (f, parted) in cracks.parted.chunks_exact(4).enumerate() {
            let corners = model.contact.outline(f, &model.mesh.nodes);
            for k in (0..4).filter(|k| parted[*k]) {
                pattern.fill(&quarter(&corners, k));
            }
        }
        pattern
    }

    /// Marks the cells covered by a hexahedron, or by a quadrilateral (its corners twice), at sampling points no
    /// farther apart than half a cell.
    fn fill(&mut self, corners: &[[f64; 3]; 8]) {
        let seen = |n: usize| [corners[n][0], corners[n][2]];
        // Edges along the three axes of the element.
        let edges: [[[usize; 2]; 4]; 3] = [
            [[0, 1], [3, 2], [4, 5], [7, 6]],
            [[0, 3], [1, 2], [4, 7], [5, 6]],
            [[0, 4], [1, 5], [2, 6], [3, 7]],
        ];
        let counts = edges.map(|edges| {
            let length = |[a, b]: [usize; 2]| {
                let (a, b) = (seen(a), seen(b));
                (a[0] - b[0]).hypot(a[1] - b[1])
            };
            let longest = edges.into_iter().map(length).fold(0.0, f64::max);
            ((2.0 * longest / self.grid.cell).ceil() as usize).max(1)
        });
        let along = |i: usize, axis: usize| (i as f64 + 0.5) / counts[axis] as f64;
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                for k in 0..counts[2] {
                    let [r, s, t] = [along(i, 0), along(j, 1), along(k, 2)];
                    let plane = [(1. - r) * (1. - s), r * (1. - s), r * s, (1. - r) * s];
                    let weight = |n: usize| plane[n % 4] * if n < 4 { 1.0 - t } else { t };
                    let at = |d: usize| (0..8).map(|n| weight(n) * seen(n)[d]).sum();
                    if let Some(cell) = self.grid.cell_at([at(0), at(1)]) {
                        self.cracked[cell] = true;
                    }
                }
            }
        }
    }

    /// Cracked cells and all their neighbours.
    fn wider(&self) -> Vec<bool> {
        let [columns, rows] = self.grid.size;
        let mut wider = vec![false; self.cracked.len()];
        let near = |i: usize, count: usize| i.saturating_sub(1)..(i + 2).min(count);
        for (cell, _) in self.cracked.iter().enumerate().filter(|(_, c)| **c) {
            for row in near(cell / columns, rows) {
                for column in near(cell % columns, columns) {
                    wider[row * columns + column] = true;
                }
            }
        }
        wider
    }

    /// Overlap of two patterns [-]: |A ∩ B| / |A ∪ B|. A cell is common if it or a neighbour is cracked in the
    /// other pattern; |A ∩ B| is the mean of the counts from both sides. The overlap is 1 if no cell is cracked,
    /// and none on different grids.
    pub fn overlap(&self, other: &Self) -> Option<f64> {
        let common = |one: &Self, wide: &[bool]| {
            let cells = one.cracked.iter().zip(wide);
            cells.filter(|(a, b)| **a && **b).count() as f64
        };
        let count = |one: &Self| one.cracked.iter().filter(|c| **c).count() as f64;
        let all = count(self) + count(other);
        let both = 0.5 * (common(self, &other.wider()) + common(other, &self.wider()));
        let overlap = if all == 0.0 { 1.0 } else { both / (all - both) };
        (self.grid == other.grid).then_some(overlap)
    }

    /// Text of a file: the grid, then the rows from the top.
    pub fn text(&self) -> String {
        let Grid {
            cell,
            corner: [x, z],
            size,
        } = self.grid;
        let mut text =
            format!("{cell} {x} {z} mm: side of a cell, x and z of the lower left corner\n");
        for row in self.cracked.chunks_exact(size[0]).rev() {
            text.extend(row.iter().map(|cracked| if *cracked { '#' } else { '.' }));
            text.push('\n');
        }
        text
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// In words: the text is not a pattern.
    fn parsed(text: &str) -> Result<Self, String> {
        let mut lines = text.lines();
        let first = lines.next().unwrap_or_default();
        let numbers: Vec<f64> = first
            .split(' ')
            .map_while(|word| word.parse().ok())
            .collect();
        let [cell, x, z] = numbers[..] else {
            return Err("line 1: begin with the side of a cell and x and z of the corner, as in `10 0 0 mm`".to_owned());
        };
        if !(cell.is_finite() && cell > 0.0 && x.is_finite() && z.is_finite()) {
            return Err("line 1: a cell has a size, a corner its place".to_owned());
        }
        let rows: Vec<&str> = lines.collect();
        let columns = rows.first().map_or(0, |row| row.len());
        for (i, row) in rows.iter().enumerate() {
            if row.len() != columns || row.contains(|c| c != '#' && c != '.') {
                let mut why = String::new();
                let _ = write!(
                    why,
                    "line {}: {columns} of `#` and `.` were expected",
                    i + 2
                );
                return Err(why);
            }
        }
        if columns == 0 {
            return Err("there are no rows of `#` and `.`".to_owned());
        }
        let upwards = rows.iter().rev();
        Ok(Self {
            grid: Grid {
                cell,
                corner: [x, z],
                size: [columns, rows.len()],
            },
            cracked: upwards
                .flat_map(|row| row.chars().map(|c| c == '#'))
                .collect(),
        })
    }

    /// Grid of the pattern.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Reads a file.
    ///
    /// # Errors
    /// The file cannot be read, or is not a pattern.
    pub fn read(path: &Path) -> Result<Self, IoError> {
        let failed = |why: std::io::Error| IoError {
            path: path.to_owned(),
            why,
        };
        let text = std::fs::read_to_string(path).map_err(failed)?;
        Self::parsed(&text).map_err(|why| failed(std::io::Error::other(why)))
    }
}

/// Quarter of a facet around its point `k`, with its corners twice, as a hexahedron without thickness.
fn quarter(facet: &[[f64; 3]; 4], k: usize) -> [[f64; 3]; 8] {
    let mean = |of: &[usize]| {
        [0, 1, 2].map(|d| of.iter().map(|n| facet[*n][d]).sum::<f64>() / of.len() as f64)
    };
    let corners = [
        facet[k],
        mean(&[k, (k + 1) % 4]),
        mean(&[0, 1, 2, 3]),
        mean(&[k, (k + 3) % 4]),
    ];
    std::array::from_fn(|n| corners[n % 4])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(rows: &[&str]) -> Pattern {
        Pattern::parsed(&format!("10 -5 2.5 mm\n{}\n", rows.join("\n"))).unwrap()
    }

    /// Corners of a box.
    fn hexahedron([x, y, z]: [[f64; 2]; 3]) -> [[f64; 3]; 8] {
        let plane = [[0, 0], [1, 0], [1, 1], [0, 1]];
        std::array::from_fn(|n| [x[plane[n % 4][0]], y[plane[n % 4][1]], z[n / 4]])
    }

    #[test]
    fn neighbouring_paths_are_the_same_and_others_are_not() {
        let one = pattern(&["..#...", "..#...", "..#..."]);
        assert_eq!(one.overlap(&one), Some(1.0));
        let beside = pattern(&["...#..", "..#...", ".#...."]);
        assert_eq!(one.overlap(&beside), Some(1.0));
        // A crack two cells away is a different crack.
        let away = pattern(&["....#.", "....#.", "....#."]);
        assert_eq!(one.overlap(&away), Some(0.0));
        // Three cells each, and three others far away: 3 of 6.
        let both = pattern(&["..#..#", "..#..#", "..#..#"]);
        assert_eq!(one.overlap(&both), Some(0.5));
        assert_eq!(both.overlap(&one), Some(0.5));
        let none = pattern(&["......", "......", "......"]);
        assert_eq!(
            (none.overlap(&none), none.overlap(&one)),
            (Some(1.0), Some(0.0))
        );
        assert_eq!(one.overlap(&pattern(&["..#...", "..#..."])), None);
    }

    #[test]
    fn a_text_is_read_back_and_what_is_none_says_where() {
        let text = pattern(&["..#", "#.."]).text();
        assert!(text.ends_with("\n..#\n#..\n"), "{text}");
        assert_eq!(Pattern::parsed(&text).unwrap(), pattern(&["..#", "#.."]));
        for (text, said) in [
            ("", "line 1"),
            ("10 0\n.#", "line 1"),
            ("0 0 0\n.#", "a cell has a size"),
            ("10 0 0 mm\n.#\n.\n", "line 3: 2 of"),
            ("10 0 0 mm\n.x\n", "line 2"),
            ("10 0 0 mm\n", "no rows"),
        ] {
            let why = Pattern::parsed(text).unwrap_err();
            assert!(why.contains(said), "{text}: {why}");
        }
    }

    #[test]
    fn what_is_filled_does_not_hang_on_how_it_is_cut() {
        let empty = pattern(&["......", "......", "......"]);
        let mut whole = empty.clone();
        // x from -5 in cells of 10: columns 1 to 3; z from 2.5: row 1.
        whole.fill(&hexahedron([[5.0, 35.0], [0.0, 98.0], [12.5, 22.5]]));
        assert_eq!(whole, pattern(&["......", ".###..", "......"]));
        let mut parts = empty.clone();
        for i in 0..7 {
            let x = |i: i32| 5.0 + 30.0 * f64::from(i) / 7.0;
            parts.fill(&hexahedron([[x(i), x(i + 1)], [40.0, 49.0], [12.5, 22.5]]));
        }
        assert_eq!(parts, whole);
        // The right half of a facet on the upper edge of the wall.
        let corners = [[15.0, 0.0], [55.0, 0.0], [55.0, 98.0], [15.0, 98.0]];
        let facet = corners.map(|[x, y]| [x, y, 32.5]);
        let mut joint = empty.clone();
        joint.fill(&quarter(&facet, 1));
        assert_eq!(joint, pattern(&["....##", "......", "......"]));
        // A vertical facet outside the grid.
        let facet = corners.map(|[y, z]| [-5.0, y, 2.5 + z / 9.8]);
        let mut joint = empty.clone();
        joint.fill(&quarter(&facet, 0));
        assert_eq!(joint, pattern(&["......", "......", "#....."]));
        let mut outside = empty.clone();
        outside.fill(&hexahedron([[70.0, 90.0], [0.0, 98.0], [-40.0, 0.0]]));
        assert_eq!(outside, empty);
    }

    #[test]
    fn cracks_are_what_is_torn_wide_or_failed() {
        let mut frame = Frame {
            tensile_damage: vec![0.49, 0.5, 0.1],
            crack_width: vec![0.01, 0.0, 0.06],
            ..Frame::default()
        };
        frame.interfaces.state = vec![
            InterfaceState::Intact,
            InterfaceState::Softening,
            InterfaceState::Softening,
            InterfaceState::FailedOpen,
            InterfaceState::FailedSliding,
        ];
        // The damage of a dry joint is 1 from the start.
        frame.interfaces.damage = vec![1.0, 0.49, 0.5, 1.0, 1.0];
        let cracks = Cracks::of(&frame);
        assert_eq!(cracks.torn, [false, true, true]);
        assert_eq!(cracks.parted, [false, false, true, true, true]);
    }
}
