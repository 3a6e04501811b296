//! No more than the scene needs: what is solved instead of a model, and shown as its results.
//!
//! **Mirror images** ([`Fidelity::Auto`]). Of a scene that is its own mirror image one half is solved, held in the
//! plane, and its results are shown as those of the whole: the same elements, points and equations, so that what it
//! gives is what the whole gives as long as that stays symmetric. What bends or cracks to one side, with nothing in
//! the scene that says to which, is left out.
//!
//! **Elastic solids** ([`Fidelity::Elastic`]). Only joints open and slide; the rest is [`Fidelity::Auto`]. How far the solids would have gone beyond
//! their yield surface is told at the end.

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
use expand::{Places, Unfold};
pub(super) use part::Part;

/// What is solved instead of a model.
#[derive(Clone, Debug)]
pub(super) enum Reduction {
    /// One half of it.
    Half {
        model: Box<Model>,
        part: Part,
        places: Places,
    },
    /// The same with elastic solids.
    Elastic(Box<Elastic>),
}

impl Reduction {
    /// Nothing if the model itself is to be solved.
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
        // Of halves, the one that is left has elastic solids.
        half().or_else(|| elastic.then(|| Self::Elastic(Box::new(Elastic::of(model)))))
    }

    /// What is solved.
    pub fn model(&self) -> &Model {
        match self {
            Self::Half { model, .. } => model,
            Self::Elastic(elastic) => &elastic.model,
        }
    }

    /// Does with what is solved what `go` does with a model, and shows its results as those of `whole`, itself that
    /// part of what is shown in the end. `reached` is what elastic solids did before.
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
                let mut unfold = Unfold {
                    whole,
                    places,
                    recorder,
                };
                let mut summary = go(model, &part.within(part_of), &mut unfold)?;
                summary.sizes = Sizes {
                    dofs: summary.sizes.dofs,
                    ..sizes(whole)
                };
                if let Some(fall) = &mut summary.fall {
                    places.unfold_fall(whole, model, fall);
                }
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
