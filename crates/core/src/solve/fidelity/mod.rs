//! Reductions: smaller or simpler models that are solved instead of the given one, with results shown for the whole.
//!
//! **Mirror images** ([`Fidelity::Auto`], docs/theory/symmetry.md). If a scene is its own mirror image, one half of
//! it is solved, held in the plane, and its results are expanded to the whole. The half has the same elements, points
//! and equations and therefore gives the results of the whole while that stays symmetric. Bending or cracking to one
//! side, with no load or imperfection that chooses the side, is left out.
//!
//! **Elastic solids** ([`Fidelity::Elastic`]). Solids stay elastic; only joints open and slide. Mirror images are
//! used as with [`Fidelity::Auto`]. The end of the run reports how far the stresses exceed the yield surface.

mod elastic;
mod expand;
mod leaning;
mod part;

use crate::model::Model;
use crate::model::mirrored::{MirrorPlane, halved};
use crate::model::scene::Fidelity;
use crate::model::sizes::Sizes;
use crate::model::sizes::sizes;
use crate::solve::Recorder;
use crate::state::Summary;
pub(super) use elastic::Reached;
use elastic::{Elastic, Watch};
use expand::{Expand, Places};
pub(super) use part::Part;

/// Model that is solved instead of the given one.
#[derive(Clone, Debug)]
pub(super) enum Reduction {
    /// One half of the model.
    Half {
        model: Box<Model>,
        part: Part,
        places: Places,
    },
    /// The model with elastic solids.
    Elastic(Box<Elastic>),
}

impl Reduction {
    /// Reduction of a model; none if the model itself is to be solved.
    pub fn of(model: &Model) -> Option<Self> {
        if model.fidelity == Fidelity::Full {
            return None;
        }
        let elastic = model.fidelity == Fidelity::Elastic;
        let half = || {
            let (images, half) = halved(model)?;
            let places = Places::of(model, &images, &half)?;
            let (axis, at) = (images.axis, images.at);
            let part = Part::of(model, &half, MirrorPlane { axis, at });
            Some(Self::Half {
                model: Box::new(half.model),
                part,
                places,
            })
        };
        // Halves come first; the last half gets elastic solids.
        half().or_else(|| elastic.then(|| Self::Elastic(Box::new(Elastic::of(model)))))
    }

    /// The model to be solved.
    pub fn model(&self) -> &Model {
        match self {
            Self::Half { model, .. } => model,
            Self::Elastic(elastic) => &elastic.model,
        }
    }

    /// Calls `go` with the reduced model and shows its results as those of `whole`, which is itself the part
    /// `part_of` of the scene shown. `reached`: largest stress of elastic solids before a resumed run.
    pub fn show<E>(
        &self,
        whole: &Model,
        part_of: &Part,
        recorder: &mut dyn Recorder,
        reached: Reached,
        go: impl FnOnce(&Model, &Part, &mut dyn Recorder) -> Result<Summary, E>,
    ) -> Result<Summary, E> {
        match self {
            Self::Half {
                model,
                part,
                places,
            } => {
                let mut expand = Expand {
                    whole,
                    places,
                    recorder,
                };
                let mut summary = go(model, &part.within(part_of), &mut expand)?;
                summary.sizes = Sizes {
                    dofs: summary.sizes.dofs,
                    ..sizes(whole)
                };
                if let Some(fall) = &mut summary.fall {
                    places.expand_fall(whole, model, fall);
                }
                places.expand_first_damage(&mut summary.first_damage);
                Ok(summary)
            }
            Self::Elastic(elastic) => {
                let mut watch = Watch {
                    elastic,
                    recorder,
                    reached,
                };
                let mut summary = go(&elastic.model, part_of, &mut watch)?;
                let told = watch.told();
                watch.recorder.note(&told);
                if watch.reached.part > 1.0 {
                    summary.warnings.push(told);
                } else {
                    summary.log.push(told);
                }
                Ok(summary)
            }
        }
    }
}
