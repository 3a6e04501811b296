//! Implementation of the trait for the built-in laws. Elements call these laws through [`Material`](super::Material)
//! without the trait, so that their steps can be inlined.

use nalgebra::{Matrix6, Vector6};

use super::damage_plasticity::DamagePlasticity;
use super::law::{LocalFailure, MaterialHistory, Response};
use super::parameters::ElasticParameters;
use super::solid_law::{Increment, SolidLaw};
use crate::tensor::ByPoint;

impl SolidLaw for ElasticParameters {
    fn name(&self) -> &'static str {
        "elastic"
    }

    fn elastic(&self) -> &ElasticParameters {
        self
    }

    fn update(
        &self,
        strain: &Vector6<f64>,
        _old: &MaterialHistory,
        _increment: Increment,
    ) -> Result<Response, LocalFailure> {
        super::elastic(self, strain)
    }

    fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        super::screen::elastic(self, strain)
    }
}

impl SolidLaw for DamagePlasticity {
    fn name(&self) -> &'static str {
        "damage-plasticity"
    }

    fn elastic(&self) -> &ElasticParameters {
        &self.elastic
    }

    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        increment: Increment,
    ) -> Result<Response, LocalFailure> {
        self.step(strain, old, increment.dt, increment.tangent)
    }

    fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        self.screen(strain)
    }

    fn extrapolated(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        ratio: f64,
    ) -> (f64, Vector6<f64>) {
        self.extrapolated(strain, old, ratio)
    }

    fn bounded(&self, tangent: &Matrix6<f64>, intact: f64) -> Matrix6<f64> {
        self.bounded(tangent, intact)
    }

    /// The yield surface is homogeneous of degree one about σ̄_c0: (F + σ̄_c0)/σ̄_c0 (theory/damage-plasticity.md,
    /// eq. 2).
    fn reached(&self, stress: &Vector6<f64>) -> Option<f64> {
        let at = |stress: &Vector6<f64>| self.yield_function(stress, 0.0, 0.0);
        Some(1.0 - at(stress) / at(&Vector6::zeros()))
    }
}
