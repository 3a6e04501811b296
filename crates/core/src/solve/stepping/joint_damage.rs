//! Damage of the joints, without the points that never faced anything: under an opening, parts of a bed have no unit
//! above.

use crate::model::Model;
use crate::state::State;
use wythe_contact::{InterfaceHistory, JointLaw};

/// Damage D of the contact points that have faced another body [-], with their indices.
pub(super) fn joint_damage<'a>(
    model: &'a Model,
    state: &'a State,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let contact = &model.contact;
    let alone: Vec<InterfaceHistory> = contact.laws.iter().map(|l| l.lost(&l.virgin())).collect();
    let points = state.interface.iter().zip(&state.pairs).enumerate();
    points.filter_map(move |(p, (history, pair))| {
        let law = usize::from(contact.slave_law[p / 4]);
        let faced = pair.facet.is_some() || *history != alone[law];
        faced.then_some((p, history.damage))
    })
}
