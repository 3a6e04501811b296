//! Law of a joint between two elements, with stiffnesses that depend on them.

use super::scatter::MOST_LAWS;
use super::schema::Interface;
use crate::model::scene::ContactSurfaces;
use crate::model::surfaces::{JointSide, joint_stiffness};
use wythe_contact::{InterfaceLaw, JointLaw};

/// Index of the law between two elements; adds it if it is new.
///
/// Stiffnesses are explicit, or k_n = factor × min E/h over both elements and k_s = factor × G/h of the same
/// element (theory/joint.md, eqs 32 and 33). If there are more laws than the index can number,
/// [`scatter`](crate::deck::scatter) reports the error.
pub(super) fn law_between(
    contact: &mut ContactSurfaces,
    name: &str,
    interface: &Interface,
    a: JointSide<'_>,
    b: JointSide<'_>,
) -> u16 {
    let [normal, shear] = joint_stiffness(interface.penalty(), a, b);
    let law = match (interface.normal_stiffness, interface.shear_stiffness) {
        (Some(normal), Some(shear)) => interface.law(normal.get(), shear.get()),
        _ => interface.law(normal, shear),
    };
    // Sizes are differences of coordinates: equal ones may differ in their last bits.
    let stiffness = law.stiffness();
    let alike = |l: &InterfaceLaw| {
        let same = |(a, b): (f64, f64)| (a - b).abs() <= 1e-9 * b;
        // The law of a joint that is cut at its middle differs.
        l.stiffness().into_iter().zip(stiffness).all(same) && l.is_half() == law.is_half()
    };
    // More laws are rejected in `scatter`; searching them would take too long.
    if contact.laws.len() > MOST_LAWS {
        return u16::MAX;
    }
    // Facets of a face mostly have one law.
    let is = |at: &usize| alike(&contact.laws[*at]) && contact.law_names[*at] == name;
    let last = contact
        .slave_law
        .last()
        .map(|law| usize::from(*law))
        .filter(is);
    let found = last.or_else(|| (0..contact.laws.len()).find(is));
    let index = found.unwrap_or_else(|| {
        contact.laws.push(law);
        contact.law_names.push(name.to_owned());
        contact.laws.len() - 1
    });
    u16::try_from(index).unwrap_or(u16::MAX)
}
