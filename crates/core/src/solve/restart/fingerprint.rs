//! Fingerprint of a model: hashes of all data that affect results. A resumed run compares them.

use std::fmt::{self, Write};

use serde::{Deserialize, Serialize};

use crate::model::Model;
use crate::model::scene::Step;

/// Hashes of the parts of a model; titles and output settings are not included.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::solve) struct Fingerprint {
    /// Hashes of the parts that [`PARTS`] names. `[part]`
    parts: Vec<u64>,
    /// Hashes of the steps. `[step]`
    steps: Vec<u64>,
}

/// Names of the parts of a model beside its steps.
const PARTS: [&str; 9] = [
    "the mesh",
    "the materials",
    "the interfaces",
    "what is held or moves as one",
    "the springs",
    "the initial velocities",
    "the probes or sections",
    "the loads",
    "the ties or floors",
];

impl Fingerprint {
    /// Fingerprint of a model.
    pub fn of(model: &Model) -> Self {
        Self {
            parts: Self::of_parts(model),
            steps: model.steps.iter().map(Self::of_step).collect(),
        }
    }

    /// Whether the fingerprint belongs to a model, whatever its steps are.
    pub fn is_but_for_steps(&self, model: &Model) -> bool {
        self.parts == Self::of_parts(model)
    }

    fn of_parts(model: &Model) -> Vec<u64> {
        let parts: [&dyn fmt::Debug; PARTS.len()] = [
            &model.mesh,
            &(model.formulation, &model.materials),
            &model.contact,
            &(&model.beams, &model.supports),
            &model.springs,
            &model.initial_velocity,
            &(&model.probes, &model.sections),
            &model.loads,
            &(&model.ties, &model.floors),
        ];
        parts.into_iter().map(digest).collect()
    }

    /// Hash of a step without `stop`, which does not affect the results before it.
    fn of_step(step: &Step) -> u64 {
        digest(&Step {
            stop: None,
            ..step.clone()
        })
    }

    /// Replaces the hash of the last step.
    pub fn end_with(&mut self, step: &Step) {
        if let Some(last) = self.steps.last_mut() {
            *last = Self::of_step(step);
        }
    }

    /// First part in which `other` differs, in words.
    pub fn difference(&self, other: &Self) -> Option<String> {
        let parts = self.parts.iter().zip(&other.parts).zip(PARTS);
        for ((mine, its), name) in parts {
            if mine != its {
                return Some(name.to_owned());
            }
        }
        if self.steps.len() != other.steps.len() {
            return Some("the number of steps".to_owned());
        }
        let step = (0..self.steps.len()).find(|&s| self.steps[s] != other.steps[s]);
        step.map(|s| format!("steps.{s}, or a file that it names"))
    }
}

/// FNV-1a hash (Fowler, Noll, Vo) of the `Debug` output, which writes numbers as the shortest decimals that give back
/// their bits.
fn digest(of: &(impl fmt::Debug + ?Sized)) -> u64 {
    let mut hash = Fnv(0xCBF2_9CE4_8422_2325);
    // This cannot fail, because it writes to no device.
    let written = write!(hash, "{of:?}");
    debug_assert!(written.is_ok());
    hash.0
}

struct Fnv(u64);

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for &byte in text.as_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scene::Stop;
    use crate::results::fake;

    #[test]
    fn the_hash_matches_its_published_values() {
        // Test vectors of FNV-1a with 64 bits.
        for (text, hash) in [
            ("", 0xCBF2_9CE4_8422_2325_u64),
            ("a", 0xAF63_DC4C_8601_EC8C),
            ("foobar", 0x8594_4171_F739_67E8),
        ] {
            let mut fnv = Fnv(0xCBF2_9CE4_8422_2325);
            fnv.write_str(text).unwrap();
            assert_eq!(fnv.0, hash, "{text}");
        }
    }

    #[test]
    fn only_inputs_that_affect_results_change_the_fingerprint() {
        let model = fake::model();
        let print = Fingerprint::of(&model);
        let mut other = model.clone();
        other.title = "another".to_owned();
        other.output.every = 7;
        assert_eq!(print, Fingerprint::of(&other));
        other.mesh.nodes[3][1] = 100.0_f64.next_up();
        let told = print.difference(&Fingerprint::of(&other));
        assert_eq!(told.as_deref(), Some("the mesh"));
        other = model.clone();
        other.steps[1].stop = Some(Stop::default());
        assert_eq!(print, Fingerprint::of(&other));
        let mut other = model.clone();
        other.steps[1].duration = 2.0;
        let mut longer = Fingerprint::of(&other);
        assert!(print.difference(&longer).unwrap().starts_with("steps.1"));
        longer.end_with(&model.steps[1]);
        assert_eq!(print.difference(&longer), None);
        other.steps.pop();
        let told = print.difference(&Fingerprint::of(&other)).unwrap();
        assert_eq!(told, "the number of steps");
    }
}
