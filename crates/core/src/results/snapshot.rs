//! Results of a run at one frame, checked for consistency before drawing or export.

use std::str::FromStr;

use super::vtkhdf::read::{FieldsFile, RestMesh, RestSurface};
use super::{ReadError, ReadHistory, RunFolder, StepOfCurve};
use crate::model::{Mesh, Model};
use crate::state::{Frame, HistoryRow};

/// Choice of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameChoice {
    /// Frame of this number, from 0.
    Number(usize),
    /// Frame of the largest force; the nearest one of a run that was killed before it was written.
    Peak,
    /// Last frame.
    #[default]
    Last,
}

impl FromStr for FrameChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "peak" => Ok(Self::Peak),
            "last" => Ok(Self::Last),
            _ => text
                .parse()
                .map(Self::Number)
                .map_err(|_| "expected a number from 0, `peak` or `last`".to_owned()),
        }
    }
}

/// Mesh at rest and fields of one frame. Every index is in range and every field has the length of its mesh.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Title of the model.
    pub title: String,
    /// Names of the materials.
    pub materials: Vec<String>,
    /// The solids at rest.
    pub mesh: Mesh,
    /// Fields without reactions and probes.
    pub frame: Frame,
    /// Number of the frame, from 0.
    pub number: usize,
    /// The interfaces at rest.
    pub surface: RestSurface,
    /// Displacement of the corners of the interface quads [mm]. `[corner][xyz]`
    pub surface_displacement: Vec<[f64; 3]>,
    /// Row of the history at this time, if there is one.
    pub row: Option<HistoryRow>,
}

impl From<RestMesh> for Mesh {
    fn from(rest: RestMesh) -> Self {
        Self {
            nodes: rest.nodes,
            elements: rest.elements,
            material: rest.material,
            unit: rest.unit,
            course: rest.course,
            names: Vec::new(),
            walls: Vec::new(),
            reflected: Vec::new(),
        }
    }
}

/// The fields of a run, opened to read several frames.
#[derive(Debug)]
pub struct Snapshots {
    file: FieldsFile,
    history: ReadHistory,
    rest: Snapshot,
}

impl Snapshots {
    /// Opens the fields of a run.
    ///
    /// # Errors
    /// The fields or the history cannot be read, or they do not fit together.
    pub fn open(folder: &RunFolder) -> Result<Self, ReadError> {
        let file = folder.fields()?;
        let read = |why| ReadError::Read {
            path: file.path().to_owned(),
            why,
        };
        let rest = Snapshot {
            title: file.title_and_version().map_err(read)?.0,
            materials: file.materials().map_err(read)?,
            mesh: file.mesh().map_err(read)?.into(),
            surface: file.surface().map_err(read)?,
            ..Snapshot::default()
        };
        rest.check_rest().map_err(|why| content(&file, why))?;
        Ok(Self {
            history: folder.history()?,
            file,
            rest,
        })
    }

    /// With the curve of a model, whatever the folder says of its steps.
    #[must_use]
    pub fn of_model(mut self, model: &Model) -> Self {
        self.history.steps = Some(StepOfCurve::all(model));
        self
    }

    /// Number of frames.
    pub fn count(&self) -> usize {
        self.file.times().len()
    }

    /// History of the run.
    pub fn history(&self) -> &ReadHistory {
        &self.history
    }

    /// Number of the chosen frame.
    ///
    /// # Errors
    /// [`ReadError::NoFrame`] if there is no such frame.
    pub fn number(&self, choice: FrameChoice) -> Result<usize, ReadError> {
        let count = self.count();
        let none = |asked: String| ReadError::NoFrame {
            path: self.file.path().to_owned(),
            asked,
            count,
        };
        match choice {
            FrameChoice::Number(n) if n < count => Ok(n),
            FrameChoice::Number(n) => Err(none(n.to_string())),
            FrameChoice::Last => count
                .checked_sub(1)
                .ok_or_else(|| none("`last`".to_owned())),
            FrameChoice::Peak => self.peak().ok_or_else(|| none("`peak`".to_owned())),
        }
    }

    /// The frame nearest in time to the peak; the last one if nothing was driven.
    fn peak(&self) -> Option<usize> {
        let times = self.file.times();
        let Some(time) = self.history.time_of_peak() else {
            return times.len().checked_sub(1);
        };
        let away = |i: &usize| (times[*i] - time).abs();
        (0..times.len()).min_by(|a, b| away(a).total_cmp(&away(b)))
    }

    /// The last frame of those at which the drive is farthest from a displacement [mm]; `None` without frames.
    pub fn farthest_from(&self, displacement: f64) -> Option<usize> {
        let mut best = None;
        for (frame, increment) in self.file.increments().iter().enumerate() {
            let row = increment
                .checked_sub(1)
                .and_then(|i| self.history.rows.get(i));
            let Some(row) = row else { continue };
            let away = (row.displacement_mm - displacement).abs();
            if best.is_none_or(|(_, most)| away >= most) {
                best = Some((frame, away));
            }
        }
        best.map(|(frame, _)| frame)
    }

    /// Step of a frame, from 0, as far as the history has it.
    pub fn step_of(&self, frame: usize) -> Option<usize> {
        let increment = *self.file.increments().get(frame)?;
        let row = self.history.rows.get(increment.checked_sub(1)?)?;
        Some(row.step)
    }

    /// The last frame before a step, in which the step before it ends; none if the step is the first.
    pub fn last_before(&self, step: usize) -> Option<usize> {
        let is_before = |frame: &usize| self.step_of(*frame).is_some_and(|of| of < step);
        (0..self.count()).rev().find(is_before)
    }

    /// External forces on beams, supports and loads at an increment, from 1 [N]; empty if the file has no such row.
    /// Names are paths, as `supports/bottom`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn reactions(&self, increment: usize) -> Result<Vec<(String, [f64; 3])>, ReadError> {
        let all = self.file.reactions().map_err(|why| ReadError::Read {
            path: self.file.path().to_owned(),
            why,
        })?;
        let row = |of: &[[f64; 3]]| of.get(increment.checked_sub(1)?).copied();
        let named = all.into_iter();
        Ok(named
            .filter_map(|(name, of)| Some((name, row(&of)?)))
            .collect())
    }

    /// Reads a frame.
    ///
    /// # Errors
    /// The frame does not exist, cannot be read or does not fit the mesh.
    pub fn at(&self, choice: FrameChoice) -> Result<Snapshot, ReadError> {
        let number = self.number(choice)?;
        let read = |why| ReadError::Read {
            path: self.file.path().to_owned(),
            why,
        };
        let frame = self.file.frame(number).map_err(read)?;
        let time = frame.time;
        let snapshot = Snapshot {
            surface_displacement: self.file.surface_displacement(number).map_err(read)?,
            row: self.history.rows.iter().find(|r| r.time == time).cloned(),
            frame,
            number,
            ..self.rest.clone()
        };
        snapshot
            .check_fields()
            .map_err(|why| content(&self.file, format!("frame {number}: {why}")))?;
        Ok(snapshot)
    }
}

fn content(file: &FieldsFile, why: String) -> ReadError {
    ReadError::Content {
        path: file.path().to_owned(),
        line: None,
        why,
    }
}

impl Snapshot {
    /// Checks that indices are in range and labels complete.
    fn check_rest(&self) -> Result<(), String> {
        let (mesh, surface) = (&self.mesh, &self.surface);
        let within = |nodes: &[u32], count: usize| nodes.iter().all(|&n| (n as usize) < count);
        if !within(mesh.elements.as_flattened(), mesh.nodes.len())
            || !within(surface.quads.as_flattened(), surface.points.len())
        {
            return Err("elements name nodes that are not there".to_owned());
        }
        let elements = mesh.elements.len();
        for (name, length) in [
            ("material", mesh.material.len()),
            ("unit", mesh.unit.len()),
            ("course", mesh.course.len()),
        ] {
            expect(name, length, elements)?;
        }
        let materials = self.materials.len();
        if mesh.material.iter().any(|&m| usize::from(m) >= materials) {
            return Err("elements name materials that are not there".to_owned());
        }
        Ok(())
    }

    /// Checks the length of every field.
    fn check_fields(&self) -> Result<(), String> {
        let (frame, mesh, of) = (&self.frame, &self.mesh, &self.frame.interfaces);
        let (nodes, elements, points) = (
            mesh.nodes.len(),
            mesh.elements.len(),
            self.surface.quads.len(),
        );
        for (name, length, wanted) in [
            ("displacement", frame.displacement.len(), nodes),
            ("stress", frame.stress.len(), elements),
            ("plastic_strain", frame.plastic_strain.len(), elements),
            ("tensile_damage", frame.tensile_damage.len(), elements),
            (
                "compressive_damage",
                frame.compressive_damage.len(),
                elements,
            ),
            ("crack_width", frame.crack_width.len(), elements),
            ("yielded", frame.yielded.len(), elements),
            ("opening", of.opening.len(), points),
            ("slip", of.slip.len(), points),
            ("traction", of.traction.len(), points),
            ("damage", of.damage.len(), points),
            ("state", of.state.len(), points),
            (
                "displacement of the interfaces",
                self.surface_displacement.len(),
                self.surface.points.len(),
            ),
        ] {
            expect(name, length, wanted)?;
        }
        for output in &frame.outputs {
            expect(&output.name, output.values.len(), elements)?;
        }
        if !frame.velocity.is_empty() {
            expect("velocity", frame.velocity.len(), nodes)?;
        }
        Ok(())
    }

    /// Short caption of the frame.
    pub fn caption(&self) -> String {
        let (number, time) = (self.number, self.frame.time);
        match &self.row {
            // Nothing is driven or carried.
            Some(row) if row.displacement_mm == 0.0 && row.force_kN == 0.0 => {
                format!("frame {number}: t = {time:.3} s")
            }
            Some(row) => format!(
                "frame {number}: {:.3} mm, {:.2} kN",
                row.displacement_mm, row.force_kN
            ),
            None => format!("frame {number}: t = {time:.3} s"),
        }
    }
}

fn expect(name: &str, length: usize, wanted: usize) -> Result<(), String> {
    if length == wanted {
        Ok(())
    } else {
        Err(format!("{name} has {length} rows where {wanted} belong"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{RunDirectory, fake};
    use crate::solve::Recorder;

    /// A run of the two cubes with its peak at the second of three frames.
    fn folder() -> (tempfile::TempDir, RunFolder) {
        let folder = tempfile::tempdir().unwrap();
        let model = fake::model();
        let mut run = RunDirectory::create(folder.path(), &model).unwrap();
        for (i, (d, f)) in [(1.0, 10.0), (2.0, 20.0), (3.0, 5.0)]
            .into_iter()
            .enumerate()
        {
            let mut row = fake::row(i + 1, 1, d, f);
            row.time = d;
            run.take(&model, &row, Some(&fake::frame(&model, d)))
                .unwrap();
        }
        drop(run);
        let open = RunFolder::open(folder.path()).unwrap();
        (folder, open)
    }

    #[test]
    fn frames_are_chosen_by_number_peak_and_last() {
        let (_keep, folder) = folder();
        let snapshots = Snapshots::open(&folder).unwrap();
        let number = |text: &str| snapshots.number(text.parse().unwrap()).unwrap();
        assert_eq!(["0", "peak", "last"].map(number), [0, 1, 2]);
        let peak = snapshots.at(FrameChoice::Peak).unwrap();
        assert_eq!(peak.caption(), "frame 1: 2.000 mm, 20.00 kN");
        assert_eq!(peak.title, "Two cubes & a <gap>");
        let error = snapshots
            .at(FrameChoice::Number(3))
            .unwrap_err()
            .to_string();
        assert!(error.contains("no frame 3: the file has 0 to 2"), "{error}");
        assert!("-1".parse::<FrameChoice>().is_err());
    }

    #[test]
    fn fields_that_do_not_fit_are_rejected() {
        let (_keep, folder) = folder();
        let mut snapshot = Snapshots::open(&folder)
            .unwrap()
            .at(FrameChoice::Last)
            .unwrap();
        snapshot.frame.tensile_damage.pop();
        let error = snapshot.check_fields().unwrap_err();
        assert_eq!(error, "tensile_damage has 1 rows where 2 belong");
        snapshot.mesh.elements[1][7] = 16;
        assert!(snapshot.check_rest().is_err());
        snapshot.mesh.elements[1][7] = 15;
        snapshot.materials.pop();
        assert!(snapshot.check_rest().is_err());
    }
}
