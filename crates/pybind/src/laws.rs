//! Laws of joints and solids that Python functions give.
//!
//! The Python half (`wythe.JointLaw`, `wythe.SolidLaw`) checks the answer of the function and flattens it. The first
//! exception of a law is stored, no further call is made, and the run or check that asked raises it.

use std::fmt;
use std::num::NonZeroUsize;
use std::sync::{Arc, OnceLock};

use nalgebra::{Matrix3, Matrix6, Vector6};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wythe_contact::checks::{self as of_joints, Path};
use wythe_contact::{
    Aabb, InterfaceHistory, InterfaceLaw, InterfaceResponse, JointLaw, Output, SLOTS,
};
use wythe_core::material::{
    ElasticParameters, Increment, LawOutput, LocalFailure, Material, MaterialHistory,
    MaterialParameters, Response, Slot, SolidLaw,
};
use wythe_core::model::Model;
use wythe_core::model::scene::{Fidelity, HeldBy};
use wythe_core::point::checks::{self as of_solids, Paths as RandomPaths};

use crate::errors;
use crate::point::{Driven, Paths, drive_joints, drive_solids};

/// First exception of the laws of a run.
#[derive(Clone, Default)]
pub struct Failure(Arc<OnceLock<PyErr>>);

impl Failure {
    /// Raises the exception, if there is one.
    pub fn raised(&self, py: Python<'_>) -> PyResult<()> {
        match self.0.get() {
            Some(error) => Err(error.clone_ref(py)),
            None => Ok(()),
        }
    }
}

/// A function that answers with one flat array of numbers.
struct Function {
    name: &'static str,
    answer: Py<PyAny>,
    failure: Failure,
}

impl Function {
    /// Calls the function with four arrays; none if it fails or a law of the run has failed before.
    fn call(&self, arguments: [&[f64]; 4]) -> Option<Vec<f64>> {
        if self.failure.0.get().is_some() {
            return None;
        }
        Python::attach(|py| {
            let [a, b, c, d] = arguments.map(|of| PyArray1::from_slice(py, of));
            let answer = self.answer.bind(py).call1((a, b, c, d));
            let numbers = answer.and_then(|answer| {
                let array: PyReadonlyArray1<'_, f64> = answer.extract()?;
                Ok(array.as_slice()?.to_vec())
            });
            // If another thread has failed before, its exception stays.
            numbers.map_err(|error| self.failure.0.set(error)).ok()
        })
    }
}

/// What a resumed run compares: the name. The function itself has no text.
impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Python {:?}", self.name)
    }
}

/// The parts of `wythe.JointLaw` and `wythe.SolidLaw` that the solver needs.
#[derive(FromPyObject)]
pub struct PythonLaw {
    name: String,
    #[pyo3(attribute("_answer"))]
    answer: Py<PyAny>,
    /// Names and units of its state.
    #[pyo3(attribute("_outputs"))]
    outputs: Vec<(String, String)>,
    /// Steepest softening of a joint in opening and slip [N/mm³].
    #[pyo3(attribute("_softening"))]
    softening: [f64; 2],
}

/// Texts and lists of laws live as long as the process: some hundred bytes for each law of a run.
fn lasting(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

impl PythonLaw {
    fn function(&self, py: Python<'_>, failure: &Failure) -> Function {
        Function {
            name: lasting(&self.name),
            answer: self.answer.clone_ref(py),
            failure: failure.clone(),
        }
    }

    /// As the law of a joint with stiffnesses `[k_n, k_s]` [N/mm³].
    fn joint(&self, py: Python<'_>, stiffness: [f64; 2], failure: &Failure) -> PythonJoint {
        let states = self.outputs.iter().enumerate();
        let mut outputs: Vec<Output> = states
            .map(|(slot, (name, unit))| Output::new(lasting(name), lasting(unit), slot))
            .collect();
        outputs.push(Output::new("plastic_opening", "mm", PLASTIC_OPENING));
        PythonJoint {
            function: self.function(py, failure),
            stiffness,
            softening: self.softening,
            outputs: Box::leak(outputs.into_boxed_slice()),
        }
    }

    /// As the law of a solid.
    fn solid(&self, py: Python<'_>, elastic: ElasticParameters, failure: &Failure) -> PythonSolid {
        let states = self.outputs.iter().zip(SOLID_SLOTS);
        let outputs: Vec<LawOutput> = states
            .map(|((name, unit), slot)| LawOutput::new(lasting(name), lasting(unit), slot))
            .collect();
        PythonSolid {
            function: self.function(py, failure),
            elastic,
            outputs: Box::leak(outputs.into_boxed_slice()),
        }
    }
}

/// Slot of the plastic opening, after those of the state.
const PLASTIC_OPENING: usize = SLOTS - 1;

#[derive(Debug)]
struct PythonJoint {
    function: Function,
    stiffness: [f64; 2],
    softening: [f64; 2],
    outputs: &'static [Output],
}

impl PythonJoint {
    fn states(&self) -> usize {
        self.outputs.len() - 1
    }
}

impl JointLaw for PythonJoint {
    fn name(&self) -> &'static str {
        self.function.name
    }

    fn stiffness(&self) -> [f64; 2] {
        self.stiffness
    }

    fn outputs(&self) -> &'static [Output] {
        self.outputs
    }

    fn softening_slopes(&self) -> [f64; 2] {
        self.softening
    }

    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let [normal, shear] = self.stiffness;
        let k = [normal, shear, shear];
        let states = self.states();
        let [slip_1, slip_2] = old.plastic_slip;
        let before = [old.slots[PLASTIC_OPENING], slip_1, slip_2];
        let answer = self
            .function
            .call([&gap, &before, &old.slots[..states], &self.stiffness]);
        // The solver ends a run at a traction that is not finite; the exception tells why.
        let numbers = answer.unwrap_or_else(|| vec![f64::NAN; 12 + states]);
        let traction = [numbers[0], numbers[1], numbers[2]];
        let plastic = [0, 1, 2].map(|i| gap[i] - traction[i] / k[i]);
        let mut slots = [0.0; SLOTS];
        slots[..states].copy_from_slice(&numbers[12..12 + states]);
        slots[PLASTIC_OPENING] = plastic[0];
        let mut response = InterfaceResponse::new(
            old,
            gap,
            traction,
            Matrix3::from_row_slice(&numbers[3..12]),
            [before, plastic],
            0.0,
            slots,
            self.stiffness,
            0.0,
        );
        response.dissipation -= crossing(old, &response.history);
        response
    }

    fn crossing_work(&self, old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
        crossing(old, new)
    }
}

/// Work of the normal traction by the trapezoidal rule on the plastic opening [N/mm] in a step in which a point begins or
/// ceases to carry normal traction. A joint without tension opens and closes so, and dissipates nothing.
fn crossing(old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
    if (old.traction[0] == 0.0) == (new.traction[0] == 0.0) {
        return 0.0;
    }
    let change = new.slots[PLASTIC_OPENING] - old.slots[PLASTIC_OPENING];
    0.5 * (old.traction[0] + new.traction[0]) * change
}

/// Places of the state of a solid. κ_t is that of the plastic strain, by which the solver sees that a point yields.
const SOLID_SLOTS: [Slot; 3] = [Slot::KappaC, Slot::TensileDamage, Slot::CompressiveDamage];

#[derive(Debug)]
struct PythonSolid {
    function: Function,
    elastic: ElasticParameters,
    outputs: &'static [LawOutput],
}

impl SolidLaw for PythonSolid {
    fn name(&self) -> &'static str {
        self.function.name
    }

    fn elastic(&self) -> &ElasticParameters {
        &self.elastic
    }

    fn outputs(&self) -> &'static [LawOutput] {
        self.outputs
    }

    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        _: Increment,
    ) -> Result<Response, LocalFailure> {
        let state: Vec<f64> = self.outputs.iter().map(|of| of.slot.of(old)).collect();
        let constants = [self.elastic.E, self.elastic.nu];
        let before = old.plastic_strain;
        let answer = self
            .function
            .call([strain.as_slice(), before.as_slice(), &state, &constants]);
        let Some(numbers) = answer else {
            return Err(LocalFailure::NoAnswer {
                law: self.function.name,
                why: "its function failed",
            });
        };
        let stress = Vector6::from_column_slice(&numbers[..6]);
        let tangent = Matrix6::from_row_slice(&numbers[6..42]);
        let mut history = MaterialHistory {
            plastic_strain: strain - Material::Elastic(self.elastic).elastic_strain(&stress),
            ..*old
        };
        // Rounding of C₀⁻¹ : C₀ : ε is no plastic strain.
        let change = (history.plastic_strain - before).norm();
        if change <= ROUNDING * strain.norm() {
            history.plastic_strain = before;
        } else {
            history.kappa_t += change;
        }
        for (output, value) in self.outputs.iter().zip(&numbers[42..]) {
            match output.slot {
                Slot::TensileDamage => history.tensile_damage = *value,
                Slot::CompressiveDamage => history.compressive_damage = *value,
                _ => history.kappa_c = *value,
            }
        }
        Ok(Response::inviscid(strain, old, stress, tangent, history))
    }
}

/// A hundred roundings of a number.
const ROUNDING: f64 = 2e-14;

/// Laws that replace those of interfaces and materials of a deck, by name.
#[derive(FromPyObject)]
pub struct Laws {
    interfaces: Vec<(String, PythonLaw)>,
    materials: Vec<(String, PythonLaw)>,
}

impl Laws {
    /// Rejects interfaces whose bond scatters, which a law of one's own cannot know.
    pub fn require_no_scatter(&self, deck: &wythe_core::deck::Deck) -> PyResult<()> {
        let scatters = |name: &String| {
            let interface = deck.interfaces.get(name);
            interface.is_some_and(|interface| interface.scatter.is_some())
        };
        let mut names = self.interfaces.iter().map(|(name, _)| name);
        names.find(|name| scatters(name)).map_or(Ok(()), |name| {
            Err(PyValueError::new_err(format!(
                "laws: the bond of interface `{name}` scatters, and the factor of a unit does not reach a law of one's \
                 own: take `scatter` out of the deck"
            )))
        })
    }

    /// The model with these laws, and a line for each.
    ///
    /// # Errors
    /// Unknown names; a joint that a plane of symmetry of the deck cuts, where the law would get half of the gap.
    pub fn put_into(
        &self,
        py: Python<'_>,
        model: &mut Model,
        failure: &Failure,
    ) -> PyResult<Vec<String>> {
        let mut told = Vec::new();
        for (name, law) in &self.interfaces {
            if is_cut(model, name) {
                return Err(PyValueError::new_err(format!(
                    "laws: a plane of [[symmetry]] cuts joints of interface `{name}`, of which a law of one's own would \
                     get half the gap: model the whole"
                )));
            }
            let contact = &mut model.contact;
            let mut laws = contact.laws.iter_mut().zip(&contact.law_names);
            let mut found = 0;
            for (old, _) in laws.by_ref().filter(|(_, of)| *of == name) {
                *old = InterfaceLaw::custom(law.joint(py, old.stiffness(), failure));
                found += 1;
            }
            if found == 0 {
                let known = named(contact.law_names.iter());
                return Err(unknown("interface", name, &known));
            }
            told.push(format!(
                "interfaces.{name} has the Python law `{}`",
                law.name
            ));
        }
        if let (Some((name, _)), Fidelity::Elastic) = (self.materials.first(), model.fidelity) {
            return Err(PyValueError::new_err(format!(
                "laws: with fidelity = \"elastic\" solids stay linear elastic, so that the law of material `{name}` \
                 would never be called: take another fidelity, or leave the law out"
            )));
        }
        for (name, law) in &self.materials {
            let known = named(model.materials.iter().map(|material| &material.name));
            let material = model.materials.iter_mut().find(|of| of.name == *name);
            let Some(material) = material else {
                return Err(unknown("material", name, &known));
            };
            let elastic = *material.parameters.elastic();
            material.parameters = MaterialParameters::custom(law.solid(py, elastic, failure));
            told.push(format!(
                "materials.{name} has the Python law `{}`",
                law.name
            ));
        }
        Ok(told)
    }
}

/// Whether a plane of symmetry of the deck cuts joints of an interface: their facets lie on faces that stand for the
/// other half.
fn is_cut(model: &Model, name: &str) -> bool {
    let at = |n: &u32| model.mesh.nodes[*n as usize];
    let mirrors = model.supports.iter().filter(|s| s.by == HeldBy::Mirror);
    let places: Vec<Vec<[f64; 3]>> = mirrors.map(|s| s.nodes.iter().map(at).collect()).collect();
    let bounds: Vec<Aabb> = places
        .iter()
        .map(|at| Aabb::of(at).fattened(SAME_PLACE))
        .collect();
    let contact = &model.contact;
    let mut facets = contact.slave_facets.iter().zip(&contact.slave_law);
    facets.any(|(nodes, law)| {
        let facet = nodes.each_ref().map(at);
        let within = |mirror: &Aabb| facet.iter().all(|x| mirror.touches(&Aabb::of([x])));
        contact.law_names[usize::from(*law)] == name && bounds.iter().any(within)
    })
}

/// Distance within which nodes lie on a face [mm].
const SAME_PLACE: f64 = 1e-3;

/// Names, each once, as a text.
fn named<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: std::collections::BTreeSet<&str> = names.map(String::as_str).collect();
    names.into_iter().collect::<Vec<_>>().join(", ")
}

fn unknown(kind: &str, name: &str, known: &str) -> PyErr {
    PyValueError::new_err(format!(
        "laws: the model has no {kind} `{name}`; it has {known}"
    ))
}

/// Checks a joint law: tangent, objectivity, balance of energy, on a random path of this step [mm].
#[pyfunction]
pub fn check_joint_law(
    py: Python<'_>,
    law: PythonLaw,
    stiffness: [f64; 2],
    step: f64,
) -> PyResult<()> {
    let failure = Failure::default();
    let joint = law.joint(py, stiffness, &failure);
    let path = Path::random(1, 60, step, step);
    // Central differences with 1e-5 of a step: the error of the differences is 1e-10 of the tangent, that of
    // rounding 1e-11 over 1e-5.
    let found = py.detach(|| {
        of_joints::tangent(&joint, &path, 1e-5 * step, 1e-5)?;
        of_joints::objectivity(&joint, &path, 1.0, 1e-9)?;
        of_joints::dissipation(&joint, &path.divided(50), 1e-9)?;
        Ok::<(), of_joints::Failed>(())
    });
    failure.raised(py)?;
    found.map_err(|failed| errors::of_law(py, &failed.to_string()))
}

/// Checks a solid law: tangent, form, balance of energy, dissipation and isotropy on random paths of this step [-].
#[pyfunction]
pub fn check_solid_law(
    py: Python<'_>,
    law: PythonLaw,
    elastic: [f64; 2],
    step: f64,
) -> PyResult<()> {
    let failure = Failure::default();
    let solid = law.solid(py, constants(elastic), &failure);
    let found = py.detach(|| of_solids::all(&solid, &RandomPaths::of_step(step)));
    failure.raised(py)?;
    found.map_err(|failed| errors::of_law(py, &failed.to_string()))
}

/// Elastic constants without mass.
#[allow(non_snake_case, reason = "E is the symbol of Young's modulus")]
fn constants([E, nu]: [f64; 2]) -> ElasticParameters {
    ElasticParameters {
        E,
        nu,
        density: 0.0,
    }
}

/// Drives points of a joint law, see [`drive_interface`](crate::point::drive_interface).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "its keywords in Python")]
pub fn drive_joint_law<'py>(
    py: Python<'py>,
    law: PythonLaw,
    stiffness: [f64; 2],
    values: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    by_stress: [bool; 3],
    substeps: NonZeroUsize,
) -> PyResult<Driven<'py>> {
    let failure = Failure::default();
    let joint = law.joint(py, stiffness, &failure);
    let paths = Paths::new(&values, &times, by_stress)?;
    let driven = drive_joints(py, &paths, substeps, std::slice::from_ref(&joint))?;
    failure.raised(py)?;
    Ok(driven)
}

/// Drives points of a solid law, see [`drive_material`](crate::point::drive_material).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "its keywords in Python")]
pub fn drive_solid_law<'py>(
    py: Python<'py>,
    law: PythonLaw,
    elastic: [f64; 2],
    values: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    by_stress: [bool; 6],
    substeps: NonZeroUsize,
) -> PyResult<Driven<'py>> {
    let failure = Failure::default();
    let solid = law.solid(py, constants(elastic), &failure);
    let material = Material::Custom(Arc::new(solid));
    let paths = Paths::new(&values, &times, by_stress)?;
    let driven = drive_solids(py, &paths, substeps, &[material])?;
    failure.raised(py)?;
    Ok(driven)
}
