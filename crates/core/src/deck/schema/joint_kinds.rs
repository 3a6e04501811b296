//! Kinds of joint laws in a deck: the law of each, the keys that it requires, and which kinds read a key.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use wythe_contact::{Coupling, InterfaceLaw};

use super::Interface;

/// Law of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum JointKind {
    /// Cohesion that softens to friction; pressure does not damage the joint.
    #[default]
    CohesiveFrictional,
    /// Tension cut-off, Coulomb friction and a compression cap, as plasticity: joints between expanded units.
    Cap,
}

impl JointKind {
    /// All kinds.
    const ALL: [Self; 2] = [Self::CohesiveFrictional, Self::Cap];

    /// Name of the kind in a deck.
    pub fn name(self) -> &'static str {
        match self {
            Self::CohesiveFrictional => "cohesive-frictional",
            Self::Cap => "cap",
        }
    }

    /// Keys without which a joint of the kind has no law.
    pub(super) fn requires(self) -> &'static [&'static str] {
        match self {
            Self::CohesiveFrictional => &["f_t", "c", "tan_phi", "mu"],
            Self::Cap => &["f_t", "c", "tan_phi", "mu", "f_m", "G_fc", "kappa_p"],
        }
    }

    /// The law of an interface with these stiffnesses [N/mm³].
    pub(super) fn law(self, interface: &Interface, normal: f64, shear: f64) -> InterfaceLaw {
        match self {
            Self::CohesiveFrictional => interface.cohesive_frictional(normal, shear).into(),
            Self::Cap => interface.cap(normal, shear).into(),
        }
    }
}

/// A key of `[interfaces.NAME]` that a kind may or may not read.
pub(super) struct KindKey {
    /// Its name.
    pub(super) name: &'static str,
    /// Whether a table gives it.
    pub(super) is_given: fn(&Interface) -> bool,
    /// The kinds that read it; given to another kind it is an error.
    pub(super) kinds: &'static [JointKind],
}

const fn key(
    name: &'static str,
    kinds: &'static [JointKind],
    is_given: fn(&Interface) -> bool,
) -> KindKey {
    KindKey {
        name,
        is_given,
        kinds,
    }
}

const COHESIVE: &[JointKind] = &[JointKind::CohesiveFrictional];
const CAP: &[JointKind] = &[JointKind::Cap];
const ALL: &[JointKind] = &JointKind::ALL;

/// All keys that need not be read by every kind.
pub(super) const KIND_KEYS: [KindKey; 18] = [
    key("f_t", ALL, |f| f.f_t.is_some()),
    key("c", ALL, |f| f.c.is_some()),
    key("tan_phi", ALL, |f| f.tan_phi.is_some()),
    key("mu", ALL, |f| f.mu.is_some()),
    key("f_m", CAP, |f| f.f_m.is_some()),
    key("G_fc", CAP, |f| f.G_fc.is_some()),
    key("kappa_p", CAP, |f| f.kappa_p.is_some()),
    key("C_nn", CAP, |f| f.C_nn.is_some()),
    key("C_ss", CAP, |f| f.C_ss.is_some()),
    key("closes", CAP, |f| f.closes.is_some()),
    key("tan_psi", CAP, |f| f.tan_psi.is_some()),
    key("sigma_u", CAP, |f| f.sigma_u.is_some()),
    key("delta", CAP, |f| f.delta.is_some()),
    key("zeta", COHESIVE, |f| f.zeta.is_some()),
    key("xi", COHESIVE, |f| f.xi.is_some()),
    key("u_k", COHESIVE, |f| f.u_k.is_some()),
    key("delta_k", COHESIVE, |f| f.delta_k.is_some()),
    key("coupling", COHESIVE, |f| f.coupling != Coupling::default()),
];

/// Schema of a joint that has a `name` of the catalogue, or all keys that its kind requires.
pub(super) fn named_or_whole(schema: &mut schemars::Schema) {
    let whole = JointKind::ALL.map(|kind| {
        let mut required = kind.requires().to_vec();
        if kind != JointKind::default() {
            required.push("kind");
        }
        serde_json::json!({
            "properties": { "kind": { "const": kind.name(), "description": "Law of the joint." } },
            "required": required,
        })
    });
    let named = serde_json::json!({ "required": ["name"] });
    let choices: Vec<_> = std::iter::once(named).chain(whole).collect();
    schema.insert("anyOf".to_owned(), choices.into());
}
