//! No more than the scene needs: what is solved instead of a model, and shown as its results.
//!
//! **Mirror images** ([`Fidelity::Auto`]). Of a scene that is its own mirror image one half is solved, held in the
//! plane, and its results are shown as those of the whole: the same elements, points and equations, so that what it
//! gives is what the whole gives as long as that stays symmetric. What bends or cracks to one side, with nothing in
//! the scene that says to which, is left out.
//!
//! **Elastic solids** ([`Fidelity::Elastic`]). Only joints open and slide. How far the solids would have gone beyond
//! their yield surface is told at the end.

mod elastic;
mod numbers;
mod unfold;

use crate::model::Model;
use crate::model::check::sizes;
use crate::model::mirrored::{MirrorPlane, halved};
use crate::model::scene::Fidelity;
use crate::results::{Recorder, Sizes, Summary};
pub(super) use elastic::Reached;
use elastic::{Elastic, Watch};
pub(super) use numbers::Numbers;
use unfold::{Places, Unfold};

/// What is solved instead of a model.
#[derive(Clone, Debug)]
pub(super) enum Instead {
    /// One half of it.
    Half {
        model: Box<Model>,
        plane: MirrorPlane,
        places: Places,
        numbers: Numbers,
    },
    /// The same with elastic solids.
    Elastic(Box<Elastic>),
}

impl Instead {
    /// Nothing if the model itself is to be solved.
    pub fn of(model: &Model) -> Option<Self> {
        match model.fidelity {
            Fidelity::Full => None,
            Fidelity::Elastic => Some(Self::Elastic(Box::new(Elastic::of(model)))),
            Fidelity::Auto => {
                let (images, half) = halved(model)?;
                let places = Places::of(model, &images, &half)?;
                let numbers = Numbers::of(&half);
                let (axis, at) = (images.axis, images.at);
                Some(Self::Half {
                    model: Box::new(half.model),
                    plane: MirrorPlane { axis, at },
                    places,
                    numbers,
                })
            }
        }
    }

    /// What is solved.
    pub fn model(&self) -> &Model {
        match self {
            Self::Half { model, .. } => model,
            Self::Elastic(elastic) => &elastic.model,
        }
    }

    /// What a run says of it before it begins.
    pub fn told(&self) -> Option<String> {
        match self {
            Self::Half { plane, .. } => Some(halved_by(*plane)),
            Self::Elastic(_) => None,
        }
    }

    /// Does with what is solved what `go` does with a model, and shows its results as those of `whole`, whose own
    /// numbers are `told`. `reached` is what elastic solids did before.
    pub fn show<E>(
        &self,
        whole: &Model,
        told: &Numbers,
        recorder: &mut dyn Recorder,
        reached: Reached,
        go: impl FnOnce(&Model, &Numbers, &mut dyn Recorder) -> Result<Summary, E>,
    ) -> Result<Summary, E> {
        match self {
            Self::Half {
                model,
                plane,
                places,
                numbers,
            } => {
                let mut unfold = Unfold {
                    whole,
                    places,
                    recorder,
                };
                let mut summary = go(model, &numbers.of_whole(told), &mut unfold)?;
                summary.log.insert(0, halved_by(*plane));
                summary.mirror_planes.insert(0, *plane);
                summary.sizes = Sizes {
                    dofs: summary.sizes.dofs,
                    ..sizes(whole)
                };
                Ok(summary)
            }
            Self::Elastic(elastic) => {
                let mut watch = Watch {
                    elastic,
                    recorder,
                    reached,
                };
                let mut summary = go(&elastic.model, told, &mut watch)?;
                let found = watch.told();
                watch.recorder.note(&found);
                if watch.reached.part > 1.0 {
                    summary.warnings.push(found);
                } else {
                    summary.log.push(found);
                }
                Ok(summary)
            }
        }
    }
}

fn halved_by(plane: MirrorPlane) -> String {
    format!("the scene is its own mirror image in the plane {plane}: one half of it is solved")
}
