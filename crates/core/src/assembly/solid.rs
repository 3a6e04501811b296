//! Forces and stiffness of one element from its rotated frame, its material law and its histories.

use nalgebra::{Matrix6, Vector6};

use super::stiffness_reuse::{Kept, stands_for};
use super::{Evaluation, Solids};
use crate::element::hex8::Nodal;
use crate::element::{Corotated, ElementShape};
use crate::material::{
    Increment, LocalFailure, Material, MaterialHistory, PointEnergy, Points, Response, SolidLaw,
    Wanted,
};
use crate::tensor::ByPoint;

/// Output of the evaluation of one element.
#[derive(Debug)]
pub struct ElementSlot<'a> {
    /// Nodal forces [N]. `[node][xyz]`
    pub force: &'a mut [[f64; 3]; 8],
    /// Stiffness [N/mm], written if the setting asks for tangents. `[CELL]`
    pub cell: &'a mut [f64],
    /// Set to true where the stiffness was written. Never cleared here.
    pub written: &'a mut bool,
    /// New histories, written unless the solids are extrapolated or kept linear. `[gauss point]`
    pub new: &'a mut [MaterialHistory],
    /// Energies, written in the same case [N mm].
    pub energy: &'a mut PointEnergy,
    /// Points with a history.
    pub marks: &'a mut Marks,
    /// Position at which elastic stiffness may be taken. None: the present position.
    pub kept: Option<&'a mut Kept>,
}

/// One bit for each Gauss point that is not virgin. Histories of the others need not be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    /// At the last commit.
    pub old: u8,
    /// At the last evaluation by the law.
    pub new: u8,
}

impl Marks {
    /// Marks of the histories of one element. `[gauss point]`
    pub fn of(old: &[MaterialHistory], new: &[MaterialHistory]) -> Self {
        let bits = |records: &[MaterialHistory]| {
            let marked = records.iter().enumerate().filter(|(_, h)| !h.is_virgin());
            marked.fold(0, |bits, (g, _)| bits | (1 << g))
        };
        Self {
            old: bits(old),
            new: bits(new),
        }
    }
}

/// Evaluates one element with nodes at `positions` [mm] and histories `old` of its eight points.
///
/// # Errors
/// [`LocalFailure`] if the element is inverted or its law found no solution.
pub fn element(
    shape: &ElementShape,
    law: &Material,
    positions: &[[f64; 3]; 8],
    old: &[MaterialHistory],
    setting: Evaluation,
    slot: &mut ElementSlot,
) -> Result<(), LocalFailure> {
    // Functions inlined below are compiled once for each vector width, and the widest available one is used.
    // Operations and their order are the same, and so are all bits of the results.
    pulp::Arch::new().dispatch(OneElement {
        shape,
        law,
        positions,
        old,
        setting,
        slot,
    })
}

/// Arguments of [`element`].
struct OneElement<'a, 'b> {
    shape: &'a ElementShape,
    law: &'a Material,
    positions: &'a [[f64; 3]; 8],
    old: &'a [MaterialHistory],
    setting: Evaluation,
    slot: &'a mut ElementSlot<'b>,
}

impl pulp::NullaryFnOnce for OneElement<'_, '_> {
    type Output = Result<(), LocalFailure>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        let frame = Corotated::new(self.shape, self.positions)?;
        match self.setting.solids {
            Solids::Extrapolated { .. } | Solids::Held => {
                self.extrapolated(&frame);
                Ok(())
            }
            Solids::Implicit | Solids::Secant | Solids::Softened => match self.law {
                Material::Custom(law) => self.by_custom_law(&frame, &**law),
                law => self.by_law(&frame, law),
            },
        }
    }
}

/// Answers of a law to the points of an element.
trait Answers {
    /// Prepares those of the points that `points` asks for.
    fn prepare(&mut self, points: &Points<'_>) -> Result<(), LocalFailure>;

    /// That of point `g`.
    fn of(&mut self, g: usize, points: &Points<'_>) -> Result<Response, LocalFailure>;
}

impl Answers for &Material {
    #[inline(always)]
    fn prepare(&mut self, _points: &Points<'_>) -> Result<(), LocalFailure> {
        Ok(())
    }

    #[inline(always)]
    fn of(&mut self, g: usize, points: &Points<'_>) -> Result<Response, LocalFailure> {
        let Increment { dt, tangent } = points.increment;
        self.step(&of_point(points.strain, g), &points.old[g], dt, tangent)
    }
}

/// Of a law from outside the library: all at once, by one virtual call.
struct Batch<'a> {
    law: &'a dyn SolidLaw,
    answers: [Response; 8],
}

impl Answers for Batch<'_> {
    fn prepare(&mut self, points: &Points<'_>) -> Result<(), LocalFailure> {
        self.law.update_points(points, &mut self.answers)?;
        let tangent = points.increment.tangent != Wanted::Nowhere;
        for (g, answer) in self.answers.iter().enumerate() {
            if points.which & (1 << g) != 0 {
                answer.checked(self.law.name(), tangent)?;
            }
        }
        Ok(())
    }

    fn of(&mut self, g: usize, _points: &Points<'_>) -> Result<Response, LocalFailure> {
        Ok(self.answers[g])
    }
}

/// Up to this number of points that follow their law, K̄ ū plus corrections at them is cheaper than stresses of
/// all points.
const FEW: u32 = 4;

impl OneElement<'_, '_> {
    /// Linear response about the last commit (extrapolated solids) or about the last histories.
    #[inline(always)]
    fn extrapolated(&mut self, frame: &Corotated) {
        let (shape, slot) = (self.shape, &mut *self.slot);
        let (old, marks, ratio) = match self.setting.solids {
            Solids::Extrapolated { ratio } => (self.old, slot.marks.old, ratio),
            _ => (&*slot.new, slot.marks.new, 0.0),
        };
        let mut force = shape.elastic_force(&frame.local);
        let mut intact = [1.0; 8];
        for g in 0..8 {
            if marks & (1 << g) == 0 {
                continue;
            }
            if !old[g].extrapolates_elastically() {
                let strain = shape.strain(g, &frame.local);
                let (part, stress) = self.law.extrapolated(&strain, &old[g], ratio);
                shape.add_force(g, &(stress - shape.elastic_stress(&strain)), &mut force);
                intact[g] = part;
            }
        }
        *slot.force = frame.force(shape, &force);
        if self.setting.tangent {
            *slot.written = true;
            write_secant(shape, frame, &intact, &force, slot.cell);
        }
    }

    /// [`Self::by_law`] of a law from outside the library.
    #[inline(never)]
    fn by_custom_law(&mut self, frame: &Corotated, law: &dyn SolidLaw) -> Result<(), LocalFailure> {
        let answers = [Response::default(); 8];
        self.by_law(frame, Batch { law, answers })
    }

    /// Response by the material law. Virgin points that stay elastic are treated together.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "the points of an element share their sums; compiled as one loop"
    )]
    fn by_law(&mut self, frame: &Corotated, mut answers: impl Answers) -> Result<(), LocalFailure> {
        let (shape, law, setting) = (self.shape, self.law, self.setting);
        let strains = shape.strains_by_point(&frame.local);
        let (stresses, elastic) = law.screen(&strains);
        let at_rest = elastic & !self.slot.marks.old;
        self.rest(at_rest, &strains, &stresses);
        if at_rest == 0xff {
            let force = shape.elastic_force(&frame.local);
            *self.slot.force = frame.force(shape, &force);
            if setting.tangent {
                self.write_elastic(frame, &force);
            }
            return Ok(());
        }
        let slot = &mut *self.slot;
        let wanted = match setting.solids {
            Solids::Implicit if setting.tangent => Wanted::Everywhere,
            Solids::Softened if setting.tangent => Wanted::WherePlastic,
            _ => Wanted::Nowhere,
        };
        let points = Points {
            strain: &strains,
            old: self.old,
            which: !at_rest,
            increment: Increment {
                dt: setting.dt,
                tangent: wanted,
            },
        };
        answers.prepare(&points)?;
        let few = at_rest.count_zeros() <= FEW;
        let mut force = [[0.0; 8]; 3];
        if few {
            force = shape.elastic_force(&frame.local);
        } else {
            for g in 0..8 {
                if at_rest & (1 << g) == 0 {
                    continue;
                }
                shape.add_force(g, &of_point(&stresses, g), &mut force);
            }
        }
        // Remaining part of the elastic stiffness of each point, and tangents that replace it.
        let mut intact = [1.0; 8];
        let mut others = [(0, Matrix6::zeros()); 8];
        let mut count = 0;
        for g in 0..8 {
            if at_rest & (1 << g) != 0 {
                continue;
            }
            let old = &self.old[g];
            let point = answers.of(g, &points)?;
            let elastic = if few {
                of_point(&stresses, g)
            } else {
                Vector6::zeros()
            };
            shape.add_force(g, &(point.stress - elastic), &mut force);
            slot.energy.add(&point.energy, shape.weight[g]);
            let new = &point.history;
            match wanted {
                Wanted::Everywhere => {
                    others[count] = (g, point.tangent);
                    count += 1;
                }
                Wanted::WherePlastic if new.kappa_t > old.kappa_t || new.kappa_c > old.kappa_c => {
                    let part = 1.0 - new.viscous_damage;
                    others[count] = (g, law.bounded(&point.tangent, part));
                    count += 1;
                }
                _ => intact[g] = 1.0 - new.viscous_damage,
            }
            let marks = &mut slot.marks.new;
            *marks = if new.is_virgin() {
                *marks & !(1 << g)
            } else {
                *marks | (1 << g)
            };
            slot.new[g] = point.history;
        }
        *slot.force = frame.force(shape, &force);
        if !setting.tangent {
            return Ok(());
        }
        if let Some(kept) = &mut slot.kept {
            kept.held = false;
        }
        *slot.written = true;
        if count == 0 {
            write_secant(shape, frame, &intact, &force, slot.cell);
            return Ok(());
        }
        let mut k = shape.scaled_stiffness(&intact);
        for (g, tangent) in &others[..count] {
            shape.replace_tangent(*g, tangent, &mut k);
        }
        if setting.solids == Solids::Implicit {
            frame.stiffness(shape, &k, &force, slot.cell);
        } else {
            frame.symmetric_stiffness(shape, &k, &force, slot.cell);
        }
        Ok(())
    }

    /// Writes the stiffness of an elastic element, at its pose if the element is close to it.
    #[inline(always)]
    fn write_elastic(&mut self, frame: &Corotated, force: &Nodal) {
        let (shape, slot) = (self.shape, &mut *self.slot);
        let k = shape.elastic_stiffness();
        if let Some(kept) = &mut slot.kept {
            let near = stands_for(&kept.pose, self.positions, shape, 1.0);
            if near && kept.held {
                return;
            }
            kept.held = true;
            *slot.written = true;
            if !near {
                kept.pose = *self.positions;
            } else if let Ok(posed) = Corotated::new(shape, &kept.pose) {
                let force = shape.elastic_force(&posed.local);
                posed.symmetric_stiffness(shape, k, &force, slot.cell);
                return;
            }
        }
        *slot.written = true;
        frame.symmetric_stiffness(shape, k, force, slot.cell);
    }

    /// Histories and energies of virgin points that stay elastic.
    #[inline(always)]
    fn rest(&mut self, at_rest: u8, strains: &ByPoint, stresses: &ByPoint) {
        let slot = &mut *self.slot;
        for g in 0..8 {
            if (at_rest & slot.marks.new) & (1 << g) == 0 {
                continue;
            }
            slot.new[g] = MaterialHistory::default();
        }
        slot.marks.new &= !at_rest;
        let mut energy = [0.0; 8];
        for (strain, stress) in strains.iter().zip(stresses) {
            for g in 0..8 {
                energy[g] += strain[g] * stress[g];
            }
        }
        let mut sum = 0.0;
        for g in 0..8 {
            if at_rest & (1 << g) != 0 {
                sum += 0.5 * self.shape.weight[g] * energy[g];
            }
        }
        *slot.energy = PointEnergy {
            elastic: sum,
            ..PointEnergy::default()
        };
        for (g, new) in slot.new.iter_mut().enumerate() {
            if at_rest & (1 << g) != 0 {
                new.stress = of_point(stresses, g);
            }
        }
    }
}

/// Six components of point `g`.
#[inline(always)]
fn of_point(components: &ByPoint, g: usize) -> Vector6<f64> {
    let mut one = Vector6::zeros();
    for k in 0..6 {
        one[k] = components[k][g];
    }
    one
}

/// Writes the secant stiffness: point `g` has the part `intact[g]` of its elastic stiffness.
#[inline(always)]
fn write_secant(
    shape: &ElementShape,
    frame: &Corotated,
    intact: &[f64; 8],
    force: &Nodal,
    cell: &mut [f64],
) {
    let scaled;
    let k = if *intact == [1.0; 8] {
        shape.elastic_stiffness()
    } else {
        scaled = shape.scaled_stiffness(intact);
        &scaled
    };
    frame.symmetric_stiffness(shape, k, force, cell);
}
