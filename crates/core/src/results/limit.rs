//! Limit analysis of a model, and its files.
//!
//! | File | Content |
//! |---|---|
//! | [`TABLE`] | factor, mechanism, forces and the warnings about the deck as JSON |
//! | [`MECHANISM`] | the mesh with the `velocity` of its nodes, the fastest at 1, and the `unit` of its elements |
//! | [`JOINTS`] | a point where the normal force of each joint acts: `force` and `normal_force` [N], `sliding` |
//! | [`CORNERS`] | the corners of the joints: `force` [N] |
//! | [`PICTURE`] | mechanism and forces |

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use serde::Serialize;

use super::plotting::mechanism;
use super::vtkhdf::still::{At, StillField, write_mesh, write_points};
use crate::error::{IoError, Warning};
use crate::files::write_whole;
use crate::limit::{LimitAnalysis, LimitError, LimitSettings, MovedUnit, Progress, analyse_told};
use crate::model::Model;

/// File of the figures.
pub const TABLE: &str = "limit.json";
/// File of the mechanism.
pub const MECHANISM: &str = "mechanism.vtkhdf";
/// File of the resultants.
pub const JOINTS: &str = "joints.vtkhdf";
/// File of the forces at the corners.
pub const CORNERS: &str = "corners.vtkhdf";
/// File of the picture.
pub const PICTURE: &str = "mechanism.svg";

/// All files.
pub const FILES: [&str; 5] = [TABLE, MECHANISM, JOINTS, CORNERS, PICTURE];

/// Limit analysis of a model.
#[derive(Clone, Debug)]
pub struct FoundLimit {
    /// The model.
    pub model: Model,
    /// Its factor, mechanism and forces.
    pub found: LimitAnalysis,
    /// Warnings about the deck of the model; none unless they are set.
    pub warnings: Vec<Warning>,
}

/// Content of [`TABLE`].
#[derive(Serialize)]
struct Table<'a> {
    #[serde(flatten)]
    found: &'a LimitAnalysis,
    warnings: &'a [Warning],
}

impl FoundLimit {
    /// Limit analysis of a model.
    ///
    /// # Errors
    /// [`LimitError`].
    pub fn of(model: Model, settings: &LimitSettings) -> Result<Self, LimitError> {
        Self::of_told(model, settings, &mut |_| ())
    }

    /// The same, which tells its progress.
    ///
    /// # Errors
    /// [`LimitError`].
    pub fn of_told(
        model: Model,
        settings: &LimitSettings,
        tell: &mut dyn FnMut(Progress),
    ) -> Result<Self, LimitError> {
        let found = analyse_told(&model, settings, tell)?;
        Ok(Self {
            model,
            found,
            warnings: Vec::new(),
        })
    }

    /// Content of [`TABLE`]: the figures with the warnings, as one JSON object.
    ///
    /// # Errors
    /// None that is known: all numbers and names have a form in JSON.
    pub fn table(&self) -> Result<String, serde_json::Error> {
        let table = Table {
            found: &self.found,
            warnings: &self.warnings,
        };
        Ok(serde_json::to_string_pretty(&table)? + "\n")
    }

    /// Picture of mechanism and forces as SVG.
    pub fn picture(&self) -> String {
        mechanism(&self.model, &self.found)
    }

    /// Velocities of the nodes in the mechanism, the fastest at 1; 0 of nodes without solids. `[node][xyz]`
    pub fn velocities(&self) -> Vec<[f64; 3]> {
        let mesh = &self.model.mesh;
        let units = self.found.mechanism.iter().map(|unit| (unit.unit, unit));
        let units: BTreeMap<u32, &MovedUnit> = units.collect();
        let mut velocities = vec![[0.0; 3]; mesh.nodes.len()];
        for (nodes, unit) in mesh.elements.iter().zip(&mesh.unit) {
            let Some(unit) = units.get(unit) else {
                continue;
            };
            for n in nodes.iter().map(|n| *n as usize) {
                let arm = Vector3::from(mesh.nodes[n]) - Vector3::from(unit.centre_mm);
                let turned = Vector3::from(unit.spin).cross(&arm);
                velocities[n] = (Vector3::from(unit.velocity) + turned).into();
            }
        }
        velocities
    }

    /// Writes all files into a folder, which is made if necessary, and returns their paths.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, out: &Path) -> Result<Vec<PathBuf>, IoError> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |why| IoError { path, why }
        };
        std::fs::create_dir_all(out).map_err(failed(out))?;
        let paths = FILES.map(|name| out.join(name));
        let [table, moved, joints, corners, picture] = &paths;
        let json = self.table().map_err(std::io::Error::other);
        let json = json.map_err(failed(table))?;
        write_whole(table, json.as_bytes()).map_err(failed(table))?;
        self.write_mechanism(moved).map_err(failed(moved))?;
        self.write_joints(joints).map_err(failed(joints))?;
        self.write_corners(corners).map_err(failed(corners))?;
        write_whole(picture, self.picture().as_bytes()).map_err(failed(picture))?;
        Ok(paths.to_vec())
    }

    fn write_mechanism(&self, path: &Path) -> std::io::Result<()> {
        let velocity = StillField {
            name: "velocity",
            unit: "1",
            values: At::Vectors(&self.velocities()),
        };
        write_mesh(path, &self.model, &[velocity])
    }

    fn write_joints(&self, path: &Path) -> std::io::Result<()> {
        let joints = || self.found.joints.iter();
        let forces: Vec<[f64; 3]> = joints().map(|joint| joint.force).collect();
        let normal: Vec<f64> = joints().map(|joint| joint.normal).collect();
        let sliding: Vec<f64> = joints().map(|joint| joint.sliding).collect();
        let field = |name, unit, values| StillField { name, unit, values };
        let fields = [
            field("force", "N", At::Vectors(&forces)),
            field("normal_force", "N", At::Numbers(&normal)),
            field("sliding", "1", At::Numbers(&sliding)),
        ];
        let places = joints().map(|joint| joint.at_mm).collect();
        write_points(path, &self.model, places, &fields)
    }

    fn write_corners(&self, path: &Path) -> std::io::Result<()> {
        let joints = || self.found.joints.iter();
        let forces = joints().flat_map(|joint| joint.corner_forces.iter().copied());
        let forces: Vec<[f64; 3]> = forces.collect();
        let force = StillField {
            name: "force",
            unit: "N",
            values: At::Vectors(&forces),
        };
        let places = joints().flat_map(|joint| joint.corners_mm.iter().copied());
        write_points(path, &self.model, places.collect(), &[force])
    }
}
