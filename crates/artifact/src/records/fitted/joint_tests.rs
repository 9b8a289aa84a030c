//! Record: the tests that went into a joint fit.

use serde::{Deserialize, Serialize};

/// The tests that one model was fitted to. Topic `/tests`.
///
/// Where an artifact holds it, candidates are of all of these tests, with the mass of the first in `/test`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct TestsV1 {
    /// The tests, in the order given.
    pub tests: Vec<JointTestV1>,
    /// What the speeds of the tests say of the rate factor of a structure: `fitted` or `prior`.
    pub rate_factor: String,
}

/// The tests that one model was fitted to. Topic `/tests`.
///
/// Where an artifact holds it, candidates are of all of these tests, with the mass of the first in `/test`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct TestsV2 {
    /// The tests, in the order given.
    pub tests: Vec<JointTestV1>,
    /// What the speeds of the tests say of the rate factor of a structure: `fitted` or `prior`.
    pub rate_factor: String,
    /// Standard deviation of a dynamic crush by the inputs of all tests (speed, zero level, gain, time zero, each of
    /// its own test), over the crush; `null`: not known of one of them.
    pub crush_deviation: Option<f64>,
}

impl From<TestsV1> for TestsV2 {
    fn from(TestsV1 { tests, rate_factor }: TestsV1) -> Self {
        Self { tests, rate_factor, crush_deviation: None }
    }
}

/// One test of a joint fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct JointTestV1 {
    /// The name that it was given under.
    pub name: String,
    /// Its title.
    pub title: String,
    /// `blake3:<hex>` of its record.
    pub digest: String,
    /// Channel of its pulse.
    pub channel: String,
    /// Test mass, kg.
    pub mass_kg: f64,
    /// Impact speed, m/s.
    pub impact_speed_m_per_s: f64,
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
    /// Its time, s after time zero.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Coefficient of restitution.
    pub coefficient_of_restitution: Option<f64>,
}
