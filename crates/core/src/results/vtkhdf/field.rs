//! Reads one field of one frame.

use std::io;

use super::into_io;
use super::read::FieldsFile;
use hdf5_metno as hdf5;

/// Prefixes of field names and the HDF5 groups of these fields.
const GROUPS: [(&str, &str); 4] = [
    ("", "VTKHDF/PointData"),
    ("", "VTKHDF/CellData"),
    ("interfaces.", "interfaces/PointData"),
    ("interfaces.", "interfaces/CellData"),
];

/// Labels, which are the same in every frame and have no rows per frame.
const LABELS: [&str; 5] = ["material", "unit", "course", "facet", "law"];

/// Values of a field at a frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Real numbers, `width` per row. `[row][width]`
    Real {
        /// All values, row by row.
        values: Vec<f64>,
        /// Number of values per row.
        width: usize,
    },
    /// Small integers: flags and states. `[row]`
    Code(Vec<u8>),
}

impl FieldsFile {
    /// Names of all fields of a frame. Those of the solids are the names in the file (`displacement`, `stress`),
    /// those of the interfaces have the prefix `interfaces.`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn field_names(&self) -> io::Result<Vec<String>> {
        let list = || -> hdf5::Result<Vec<String>> {
            let mut names = Vec::new();
            for (prefix, group) in GROUPS {
                if !self.has(group) {
                    continue;
                }
                let members = self.group(group)?.member_names()?;
                let fields = members
                    .iter()
                    .filter(|name| !LABELS.contains(&name.as_str()));
                names.extend(fields.map(|name| format!("{prefix}{name}")));
            }
            Ok(names)
        };
        list().map_err(|error| into_io(&error))
    }

    /// Reads one field of a frame, from 0, by its name in [`FieldsFile::field_names`], and nothing else.
    ///
    /// # Errors
    /// The field or frame does not exist or cannot be read.
    pub fn field(&self, name: &str, frame: usize) -> io::Result<Values> {
        let read = || -> hdf5::Result<Values> {
            let within = GROUPS.iter().find_map(|(prefix, group)| {
                let rest = name.strip_prefix(prefix)?;
                let path = format!("{group}/{rest}");
                (!LABELS.contains(&rest) && !rest.contains('/') && self.has(&path)).then_some(path)
            });
            let Some(path) = within else {
                return Err(format!("there is no field {name}").into());
            };
            if frame >= self.times().len() {
                let message = format!(
                    "there is no frame {frame}: there are {}",
                    self.times().len()
                );
                return Err(message.into());
            }
            self.values(&path, frame)
        };
        read().map_err(|error| into_io(&error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{VtkHdfWriter, fake};

    #[test]
    fn fields_are_read_one_by_one_and_agree_with_whole_frames() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let mut model = fake::model();
        // Without interfaces the file has no interface fields.
        model.contact.slave_facets = vec![[1, 2, 6, 5]];
        model.contact.slave_law = vec![0];
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        for time in [0.5, 1.0] {
            writer.append(&fake::frame(&model, time)).unwrap();
        }
        drop(writer);
        let file = FieldsFile::open(&path).unwrap();
        let frame = file.frame(1).unwrap();
        let real = |values: Vec<f64>, width| Values::Real { values, width };
        let read = |name: &str| file.field(name, 1).unwrap();
        let displacement = frame.displacement.clone().into_flattened();
        assert_eq!(read("displacement"), real(displacement, 3));
        assert_eq!(
            read("stress"),
            real(frame.stress.clone().into_flattened(), 6)
        );
        assert_eq!(
            read("tensile_damage"),
            real(frame.tensile_damage.clone(), 1)
        );
        let traction = frame.interfaces.traction.clone().into_flattened();
        assert_eq!(read("interfaces.traction"), real(traction, 3));
        let states: Vec<u8> = frame.interfaces.state.iter().map(|s| *s as u8).collect();
        assert_eq!(read("interfaces.state"), Values::Code(states));
        for name in file.field_names().unwrap() {
            file.field(&name, 0).unwrap();
        }
        for (name, frame, what) in [
            ("dt", 0, "no field dt"),
            ("material", 0, "no field material"),
            ("stress", 2, "no frame 2"),
        ] {
            let error = file.field(name, frame).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
