//! What kind of record a run is of: what its verdict speaks about.

use crumple_signal::key_quantities::MAXIMUM_DELTA_V;
use crumple_signal::{ANOTHER_VEHICLE, About, part_of};
use serde::{Deserialize, Serialize};

use crate::findings::Run;

/// What kind of record the verdict is about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A vehicle that was stopped: by a barrier, or as if by one.
    Barrier,
    /// A vehicle that still moved on when the record or the event ended.
    NoStop,
    /// A vehicle that met another one.
    TwoVehicles,
    /// One model of several tests.
    SeveralTests,
    /// A sensor in an occupant.
    Occupant,
    /// The table of an event data recorder.
    Recorder,
    /// Inputs and outputs, no crash.
    InputOutput,
    /// A pulse without mass or speed, as allowed: a linear model alone.
    LinearModel,
    /// No acceptable result.
    NoModel,
    /// Waves without models or motion: the stages of these did not run.
    #[default]
    MeasuredOnly,
}

/// Whether what was asked for is there.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ResultStatus {
    /// A model is recommended, or the identified one is the result.
    Model,
    /// There are results, and no model is recommended.
    #[default]
    NoneRecommended,
    /// There is no acceptable result.
    NoResult,
}

/// What kind of record a run is of.
pub fn kind_of(run: &Run) -> Kind {
    if run.is_generic() {
        return Kind::InputOutput;
    }
    if run.joint.is_some() {
        return if run.without_result() { Kind::NoModel } else { Kind::SeveralTests };
    }
    if run.metrics.iter().any(|metric| metric.name == MAXIMUM_DELTA_V.key && metric.value.is_some()) {
        return Kind::Recorder;
    }
    if run.channel().is_some_and(|channel| part_of(channel).is_some() || !channel.may_be_on_vehicle()) {
        return Kind::Occupant;
    }
    let simulated = run.responses.is_some_and(|number| number > 0);
    let nothing = run.no_candidate_simulated() && run.without.is_none();
    if (run.without_result() || nothing) && !simulated {
        let stated = run.test.mass_kg.is_some() && run.test.impact_speed_m_per_s.is_some();
        return if !stated && !run.models.is_empty() { Kind::LinearModel } else { Kind::NoModel };
    }
    match &run.events {
        _ if run.test.barrier.as_deref() == Some(ANOTHER_VEHICLE) => Kind::TwoVehicles,
        Some(events) if events.dynamic_crush_m.is_some() => Kind::Barrier,
        Some(_) => Kind::NoStop,
        None => Kind::MeasuredOnly,
    }
}

/// Whether there is a pulse without what a crush is computed from. What has no structure lacks neither.
pub fn lacks_mass_or_speed(run: &Run) -> bool {
    run.test.has_structure()
        && run.acceleration().is_some()
        && (run.test.mass_kg.is_none() || run.test.impact_speed_m_per_s.is_none())
}

/// Which of mass and impact speed is not stated, and what there is not for want of it.
pub fn not_stated(run: &Run) -> &'static str {
    match (run.test.mass_kg, run.test.impact_speed_m_per_s) {
        (None, None) => {
            "Mass and impact speed are missing, so there is no crush and no force: add --mass and --impact-speed."
        }
        (None, Some(_)) => "The mass is missing, so there is no force and no stiffness: add --mass.",
        _ => "The impact speed is missing, so there is no crush and no stiffness: add --impact-speed.",
    }
}

/// What a warning is about, as the status says it.
pub fn subject_of(about: &str) -> &'static str {
    match about.parse() {
        Ok(About::Pulse) => "the pulse",
        Ok(About::Mass) => "the mass",
        Ok(About::ImpactSpeed) => "the impact speed",
        Ok(About::Time) => "the time axis",
        Ok(About::Motion) => "the motion",
        Ok(About::Model(_)) => "the model",
        Ok(About::IdentifiedModels) => "every identified model",
        _ => "the record",
    }
}
