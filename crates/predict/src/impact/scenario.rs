//! What is to be predicted: speeds, masses, what the vehicle runs into, who sits in it.

use crumple_lumped::{Occupant, Structure};

use crate::impact::against::MadeTest;
use crate::impact::candidate::Candidate;

/// The test that the candidates are from; of several the one with the deepest crush.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedImpact {
    /// Its impact speed, m/s.
    pub speed_m_per_s: f64,
    /// Slowest and fastest test, m/s; of one test its speed twice.
    pub range_m_per_s: (f64, f64),
    /// Standard deviation of its dynamic crush by the uncertainty of its own speed, zero level, gain and time zero, m.
    pub crush_deviation_m: f64,
    /// What it measured; of several tests nothing.
    pub made: MadeTest,
}

impl TestedImpact {
    /// A test at this speed, with further ones of the same vehicle at these, m/s.
    pub fn new(speed_m_per_s: f64, others_m_per_s: impl IntoIterator<Item = f64>) -> Self {
        let range = (speed_m_per_s, speed_m_per_s);
        let range_m_per_s =
            others_m_per_s.into_iter().fold(range, |(slowest, fastest), v| (slowest.min(v), fastest.max(v)));
        Self { speed_m_per_s, range_m_per_s, crush_deviation_m: 0.0, made: MadeTest::default() }
    }

    /// The test with this standard deviation of its dynamic crush by its inputs, m.
    #[must_use]
    pub fn with_crush_deviation(self, crush_deviation_m: f64) -> Self {
        Self { crush_deviation_m, ..self }
    }

    /// The test with what it measured.
    #[must_use]
    pub fn with_measured(self, made: MadeTest) -> Self {
        Self { made, ..self }
    }

    /// The speed within those of the tests that is nearest to another, m/s.
    pub(crate) fn nearest_m_per_s(&self, speed_m_per_s: f64) -> f64 {
        speed_m_per_s.max(self.range_m_per_s.0).min(self.range_m_per_s.1)
    }
}

/// An impact to be predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scenario {
    /// Impact speed over ground, m/s; zero where only the partner moves.
    pub speed_m_per_s: f64,
    /// Speed of the partner towards the vehicle, m/s, negative where it runs ahead; the wall has none.
    pub partner_speed_m_per_s: f64,
    /// Mass of the vehicle, kg; `None`: that of the test.
    pub mass_kg: Option<f64>,
}

/// What the vehicle runs into.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Partner {
    /// The rigid wall of the test.
    #[default]
    Wall,
    /// A moving barrier: one mass, with a face or rigid.
    Barrier(Structure),
    /// Another vehicle, with the models of a test of its own.
    Vehicle {
        /// Its candidates.
        candidates: Vec<Candidate>,
        /// Place of the one that it is.
        place: usize,
        /// Its test.
        test: TestedImpact,
        /// Its mass, kg; `None`: that of its test.
        mass_kg: Option<f64>,
    },
}

/// What all impacts have in common.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surroundings {
    /// What the vehicle runs into.
    pub partner: Partner,
    /// Who sits in its compartment, behind which restraint.
    pub occupant: Option<Occupant>,
    /// The occupant one standard deviation up and down along each direction in which a fitted restraint may be off.
    pub occupant_ends: Vec<[Occupant; 2]>,
}
