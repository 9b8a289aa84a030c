//! What a record shows without a motion: criteria of occupants and recorded changes of velocity need no impact speed.

use crumple_signal::{Channel, QuantityKind, TestDescription, part_of};
use crumple_stage::records::{MetricsV2, TestV1};
use crumple_stage::{Inputs, Outcome, Output};

use crate::stage::criteria::occupants_and_roadside::Criteria;
use crate::stage::criteria::recorder::recorded_changes;
use crate::stage::options::StageSettings;

/// What a motion of the pulse lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// The impact speed.
    Speed,
    /// The samples of the pulse, while an occupant's are here.
    Pulse,
}

/// What stands in the way of a motion, if anything does that is no fault of the inputs.
pub fn missing_for_motion(
    input: &Inputs,
    test: &TestDescription,
    pulse: &Channel,
    speed_m_per_s: Option<f64>,
) -> Option<Missing> {
    let occupants = || test.channels.iter().any(|c| part_of(c).is_some() && input.wave_if(&c.id).is_some());
    if input.wave_if(&pulse.id).is_none() && occupants() {
        return Some(Missing::Pulse);
    }
    // A vehicle has a change of velocity without it; an occupant and a recorder say what they can by themselves.
    let is_recorded =
        || test.channels.iter().any(|c| c.quantity == QuantityKind::VelocityChange && input.wave_if(&c.id).is_some());
    (speed_m_per_s.is_none() && (part_of(pulse).is_some() || is_recorded())).then_some(Missing::Speed)
}

/// Writes the test and the criteria. Done where the pulse is an occupant's, or not in the inputs: nobody asked for a
/// motion of the vehicle. A vehicle without impact speed has no acceptable result, whatever else was measured.
pub fn without_motion(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    pulse: &Channel,
    missing: Missing,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    out.put("/test", &TestV1::from(test))?;
    let time_zero_s = settings.time_zero_s.unwrap_or(0.0);
    let impact_speed_m_per_s = None;
    let criteria = Criteria { settings, input, test, pulse, time_zero_s, impact_speed_m_per_s };
    let mut metrics = criteria.records(out)?;
    let measured = metrics.iter().any(|metric| metric.value.is_some());
    let recorded = recorded_changes(input, test, time_zero_s, out);
    let recorder = recorded.iter().any(|metric| metric.value.is_some());
    metrics.extend(recorded);
    if !metrics.is_empty() {
        out.put("/metrics", &MetricsV2 { metrics })?;
    }
    let id = &pulse.id;
    let state_the_speed = "state the speed just before contact: --impact-speed 35km/h here or at crumple-ingest";
    let (result, reason, remedy) = match missing {
        Missing::Pulse if measured => (
            true,
            format!(
                "criteria of occupants alone: the pulse {id} is not in the inputs, so there is no motion of the vehicle"
            ),
            "crumple-filter without --channels takes both".to_owned(),
        ),
        Missing::Pulse => (
            false,
            format!("the pulse {id} is not in the inputs: crumple-filter --channels leaves out what it does not name"),
            format!("name {id} there too"),
        ),
        Missing::Speed if part_of(pulse).is_some() && measured => (
            true,
            format!(
                "criteria of occupants alone: channel {id} is of an occupant, and no impact speed is stated for a \
                 motion"
            ),
            state_the_speed.to_owned(),
        ),
        Missing::Speed if recorder => (
            true,
            "the recorded change of velocity alone: no impact speed is stated, so there is no crush".to_owned(),
            state_the_speed.to_owned(),
        ),
        Missing::Speed => (
            false,
            "the test has no impact speed, which no accelerometer can tell".to_owned(),
            state_the_speed.to_owned(),
        ),
    };
    out.remedy(remedy);
    if !result {
        return Ok(Outcome::NoAcceptableResult(reason));
    }
    out.nothing_for_later_stages(reason);
    Ok(Outcome::Done)
}
