//! General contact of a deck.

use super::schema::Deck;
use crate::error::{ErrorKind, ModelError};
use crate::model::Model;
use crate::model::general::{DryStiffness, GeneralContact};

/// General contact of a model, if its deck asks for it.
///
/// # Errors
/// An unknown interface.
pub(super) fn general(deck: &Deck, model: &Model) -> Result<Option<GeneralContact>, ModelError> {
    let Some(name) = &deck.contact.general else {
        return Ok(None);
    };
    let Some(interface) = deck.interfaces.get(name) else {
        return Err(deck
            .error("contact.general", "there is no such interface", "name one")
            .of_kind(ErrorKind::UnknownName));
    };
    let stiffness = match (interface.normal_stiffness, interface.shear_stiffness) {
        (Some(normal), Some(shear)) => DryStiffness::Given([normal.get(), shear.get()]),
        _ => DryStiffness::Penalty(interface.penalty()),
    };
    Ok(Some(GeneralContact::new(
        name,
        &model.mesh,
        &model.materials,
        interface.residual_friction(),
        stiffness,
    )))
}
