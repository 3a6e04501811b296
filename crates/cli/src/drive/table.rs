//! Output of `drive`: the path and the response of the point.

use std::fmt::Write as _;

use wythe_core::point::{Layout, State};

use super::path::Path;

/// A CSV text that grows by one row per step.
///
/// The columns of the path come first, as they were written, without those that the response contains: stresses,
/// state, and strains that were solved for.
#[derive(Debug)]
pub struct Table {
    text: String,
    /// Columns of the path that are kept.
    kept: Vec<usize>,
    /// Components whose strains are solved for.
    solved: Vec<usize>,
}

impl Table {
    /// Writes the header for this path.
    pub fn new<const N: usize>(path: &Path<N>, layout: &Layout<N>) -> Self {
        let solved: Vec<usize> = (0..N).filter(|&i| path.by_stress[i]).collect();
        let said_anew = |name: &str| {
            layout.stresses.contains(&name)
                || layout.state.contains(&name)
                || solved.iter().any(|&i| layout.strains[i] == name)
        };
        let kept: Vec<usize> = (0..path.header.len())
            .filter(|&i| !said_anew(&path.header[i]))
            .collect();
        let names: Vec<String> = kept
            .iter()
            .map(|&i| quoted(&path.header[i]))
            .chain(solved.iter().map(|&i| layout.strains[i].to_owned()))
            .chain(
                layout
                    .stresses
                    .iter()
                    .chain(&*layout.state)
                    .map(|&name| name.to_owned()),
            )
            .collect();
        let mut table = Self {
            text: String::new(),
            kept,
            solved,
        };
        table.line(names.into_iter());
        table
    }

    /// Appends the response to row `index` of the path.
    pub fn push<const N: usize, H>(
        &mut self,
        path: &Path<N>,
        index: usize,
        point: &State<N, H>,
        state: &[f64],
    ) {
        let solved = self.solved.iter().map(|&i| point.strain[i]);
        let numbers = solved
            .chain(point.stress.iter().copied())
            .chain(state.iter().copied());
        let cells: Vec<String> = self
            .kept
            .iter()
            .map(|&i| quoted(&path.cells[index][i]))
            // Debug writes the shortest digits that read back to the same bits, with an exponent where that is
            // shorter.
            .chain(numbers.map(|value| format!("{value:?}")))
            .collect();
        self.line(cells.into_iter());
    }

    /// Returns the whole text.
    pub fn finish(self) -> String {
        self.text
    }

    fn line(&mut self, cells: impl Iterator<Item = String>) {
        for (i, cell) in cells.enumerate() {
            let comma = if i == 0 { "" } else { "," };
            // Writing to a string does not fail.
            let _ = write!(self.text, "{comma}{cell}");
        }
        self.text.push('\n');
    }
}

/// A cell of the path, quoted where CSV requires it.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) || cell.starts_with('#') {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use wythe_core::point::INTERFACE;

    #[test]
    fn the_path_is_repeated_and_the_answer_said_anew() {
        let text = "note,sig_MPa,d1_mm,u_mm,d2_mm,D\n\"a,b\",-0.50,1e-3,9,0,7\n";
        let path = Path::read("p.csv", text, &INTERFACE, &["normal".to_owned()]).unwrap();
        let mut table = Table::new(&path, &INTERFACE);
        let point = State {
            strain: Vector3::new(-5e-6, 1e-3, 0.0),
            stress: Vector3::new(-0.5, 0.1, 0.0),
            history: (),
            time: 1.0,
        };
        table.push(&path, 0, &point, &[0.25]);
        let expected = "note,d1_mm,d2_mm,u_mm,sig_MPa,tau1_MPa,tau2_MPa,D\n\
            \"a,b\",1e-3,0,-5e-6,-0.5,0.1,0.0,0.25\n";
        assert_eq!(table.finish(), expected);
    }
}
