//! Element formulations.

/// How the hex8 interpolates strain.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Deserialize,
    serde::Serialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Formulation {
    /// 2×2×2 points, displacement strains.
    Full,
    /// Constant dilatation.
    BBar,
    /// Wilson–Taylor incompatible modes, condensed elastically once.
    #[default]
    Incompatible,
}
