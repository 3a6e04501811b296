//! Numbers with units; their dimension is checked when the deck is read.
//!
//! A bare number is in N, mm, MPa, tonne, s (angles in degrees). A string contains its unit: `"2.12 MPa"`, `"30
//! kN/m^2"`, `"1900 kg/m^3"`. All values are stored in the base units.

use super::unit::{self, Dimension};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// A value of dimension mmᴸ tonneᴹ sᵀ degᴬ, in these units.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Quantity<const L: i8, const M: i8, const T: i8, const A: i8>(f64);

/// Dimensionless number; strings may contain `%`.
pub type Number = Quantity<0, 0, 0, 0>;
/// Length [mm].
pub type Length = Quantity<1, 0, 0, 0>;
/// Mass [tonne].
pub type Mass = Quantity<0, 1, 0, 0>;
/// Area [mm²].
pub type Area = Quantity<2, 0, 0, 0>;
/// Inverse of a length [1/mm].
pub type InverseLength = Quantity<-1, 0, 0, 0>;
/// Pressure, stress, modulus [MPa].
pub type Pressure = Quantity<-1, 1, -2, 0>;
/// Density [tonne/mm³].
pub type Density = Quantity<-3, 1, 0, 0>;
/// Energy per area [N/mm].
pub type FractureEnergy = Quantity<0, 1, -2, 0>;
/// Stiffness per area [N/mm³].
pub type InterfaceStiffness = Quantity<-2, 1, -2, 0>;
/// Stiffness of a spring [N/mm].
pub type SpringStiffness = Quantity<0, 1, -2, 0>;
/// Force [N].
pub type Force = Quantity<1, 1, -2, 0>;
/// Force over a length [N/mm].
pub type LineForce = Quantity<0, 1, -2, 0>;
/// Force for each width and strain [N/mm].
pub type MembraneStiffness = Quantity<0, 1, -2, 0>;
/// Velocity [mm/s].
pub type Velocity = Quantity<1, 0, -1, 0>;
/// Time [s].
pub type Time = Quantity<0, 0, 1, 0>;
/// Rate [1/s].
pub type Frequency = Quantity<0, 0, -1, 0>;
/// Acceleration [mm/s²].
pub type Acceleration = Quantity<1, 0, -2, 0>;
/// Angle [deg].
pub type Angle = Quantity<0, 0, 0, 1>;

/// Largest magnitude of a quantity [base units]: products of several remain far below the largest floating-point
/// number.
pub const LARGEST: f64 = 1e15;

/// Smallest magnitude of a quantity other than 0 [base units].
pub const SMALLEST: f64 = 1e-30;

/// Returns whether a number is 0 or within these bounds.
pub(in crate::deck) fn is_sound(value: f64) -> bool {
    value == 0.0 || (SMALLEST..=LARGEST).contains(&value.abs())
}

/// Default acceleration of gravity [mm/s²].
pub const GRAVITY: f64 = 9810.0;

impl<const L: i8, const M: i8, const T: i8, const A: i8> Quantity<L, M, T, A> {
    const DIMENSION: Dimension = Dimension([L, M, T, A]);

    /// A value already in base units.
    pub const fn new(value: f64) -> Self {
        Self(value)
    }

    /// The value in base units.
    pub const fn get(self) -> f64 {
        self.0
    }
}

impl<const L: i8, const M: i8, const T: i8, const A: i8> Serialize for Quantity<L, M, T, A> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0)
    }
}

struct QuantityVisitor<const L: i8, const M: i8, const T: i8, const A: i8>;

impl<const L: i8, const M: i8, const T: i8, const A: i8> Visitor<'_>
    for QuantityVisitor<L, M, T, A>
{
    type Value = Quantity<L, M, T, A>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimension = Quantity::<L, M, T, A>::DIMENSION;
        write!(f, "{dimension}: a number, or a string with its unit")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        let dimension = Quantity::<L, M, T, A>::DIMENSION;
        if is_sound(value) {
            Ok(Quantity(value))
        } else if value.is_finite() {
            Err(E::custom(format_args!(
                "expected {dimension}, found {value:e}: sizes are 0, or from {SMALLEST:e} to {LARGEST:e}"
            )))
        } else {
            Err(E::custom(format_args!(
                "expected {dimension}, found {value}, which is not finite"
            )))
        }
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
        let wanted = Quantity::<L, M, T, A>::DIMENSION;
        if wanted == Acceleration::DIMENSION && text.trim() == "g" {
            return Ok(Quantity(GRAVITY));
        }
        match unit::parse(text) {
            Ok((value, found)) if found == wanted => self.visit_f64(value),
            Ok((_, found)) => Err(E::custom(format_args!(
                "expected {wanted}, found \"{text}\" ({})",
                found.name()
            ))),
            Err(why) => Err(E::custom(format_args!(
                "expected {wanted}, found \"{text}\": {why}"
            ))),
        }
    }
}

impl<'de, const L: i8, const M: i8, const T: i8, const A: i8> Deserialize<'de>
    for Quantity<L, M, T, A>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(QuantityVisitor)
    }
}

/// A number, or a string of a number and its unit, which is optional for dimensionless numbers.
impl<const L: i8, const M: i8, const T: i8, const A: i8> JsonSchema for Quantity<L, M, T, A> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("Quantity_{L}_{M}_{T}_{A}").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let number = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?";
        let unit = if Self::DIMENSION == Number::DIMENSION {
            r"\s*([^\s0-9+-].*)?"
        } else {
            r"\s*[^\s0-9.+-].*"
        };
        let pattern = if Self::DIMENSION == Acceleration::DIMENSION {
            format!("^\\s*({number}{unit}|g\\s*)$")
        } else {
            format!("^\\s*{number}{unit}$")
        };
        json_schema!({ "type": ["number", "string"], "pattern": pattern })
    }
}
