//! Predictions as they stand in the artifact.

use crate::{Candidate, CollisionOutcome, INTERVAL_LEVEL, Partner, Prediction, Quantity, Scenario, Support, Wave};
use crumple_lumped::{CONTACT_SHARE, OccupantMotion};
use crumple_signal::{QuantityKind, Sampled};
use crumple_stage::Output;
use crumple_stage::records::{
    AnsweredByV1, PredictedCollisionV1, PredictedEnergyV1, PredictedIntervalV1, PredictedOccupantV1, PredictionV1,
};

use crate::stage::partner::ReadPartner;

/// What goes to `/prediction/<n>`.
pub fn record(
    candidate: &Candidate,
    names: &[&str],
    scenario: Scenario,
    prediction: &Prediction,
    partner: &ReadPartner,
) -> PredictionV1 {
    let number = |quantity: Quantity| prediction.outcome.get(quantity);
    let intervals = Quantity::ALL.iter().zip(&prediction.intervals).filter_map(|(quantity, interval)| {
        let interval = interval.as_ref()?;
        Some(PredictedIntervalV1 {
            name: quantity.field().to_owned(),
            level: INTERVAL_LEVEL,
            low: interval.low,
            high: interval.high,
            interval_by: interval.by.clone(),
        })
    });
    PredictionV1 {
        candidate: candidate.id.clone(),
        recommended: names.contains(&"recommended"),
        names: names.iter().map(|name| (*name).to_owned()).collect(),
        asked: false,
        impact_speed_m_per_s: scenario.speed_m_per_s,
        mass_kg: prediction.mass_kg,
        partner: partner.words.clone(),
        dynamic_crush_m: number(Quantity::DynamicCrush),
        time_of_dynamic_crush_s: number(Quantity::TimeOfDynamicCrush),
        delta_v_m_per_s: number(Quantity::DeltaV),
        coefficient_of_restitution: number(Quantity::Restitution),
        peak_acceleration_m_per_s2: number(Quantity::Peak),
        peak_by: prediction.peak_by_record.map(answered_by),
        delta_v_by: prediction.rebound_by_record.map(answered_by),
        olc_m_per_s2: number(Quantity::Olc),
        energy: prediction.energy.map(|energy| PredictedEnergyV1 {
            kinetic_at_impact_j: energy.at_impact_j,
            kinetic_at_rest_j: energy.at_rest_j,
            absorbed_j: energy.at_impact_j - energy.at_rest_j,
        }),
        extrapolates: [Some(prediction.support), prediction.partner_support]
            .into_iter()
            .flatten()
            .any(|support| support.beyond.is_some() || support.faster),
        intervals: intervals.collect(),
        notes: notes(candidate, prediction, partner),
        against: None,
        collision: prediction.collision.as_ref().map(|both| collision(both, scenario, prediction, partner)),
        occupant: prediction.occupant.as_ref().map(occupant),
    }
}

/// Who answers for a number, of which the record says something.
fn answered_by(record: bool) -> AnsweredByV1 {
    if record { AnsweredByV1::Record } else { AnsweredByV1::Model }
}

/// What the collision makes of both.
fn collision(
    both: &CollisionOutcome,
    scenario: Scenario,
    prediction: &Prediction,
    partner: &ReadPartner,
) -> PredictedCollisionV1 {
    let number = |quantity: Quantity| prediction.outcome.get(quantity);
    PredictedCollisionV1 {
        kind: if partner.candidate.is_some() { "vehicle" } else { "barrier" }.to_owned(),
        partner_candidate: partner.candidate.clone(),
        closing_speed_m_per_s: both.closing_speed_m_per_s,
        partner_speed_m_per_s: scenario.partner_speed_m_per_s,
        partner_mass_kg: both.partner.mass_kg,
        common_velocity_m_per_s: both.common_velocity_m_per_s,
        mutual_crush_m: number(Quantity::MutualCrush),
        partner_crush_m: number(Quantity::PartnerCrush),
        partner_delta_v_m_per_s: number(Quantity::PartnerDeltaV),
        partner_peak_acceleration_m_per_s2: number(Quantity::PartnerPeak),
        partner_olc_m_per_s2: number(Quantity::PartnerOlc),
        absorbed_j: both.own.absorbed_j,
        partner_absorbed_j: both.partner.absorbed_j,
        energy_equivalent_speed_m_per_s: both.own.energy_equivalent_speed_m_per_s,
        partner_energy_equivalent_speed_m_per_s: both.partner.energy_equivalent_speed_m_per_s,
        velocity_after_m_per_s: both.own.velocity_after_m_per_s,
        partner_velocity_after_m_per_s: both.partner.velocity_after_m_per_s,
        momentum_before_n_s: both.momentum_n_s[0],
        momentum_after_n_s: both.momentum_n_s[1],
    }
}

/// What becomes of an occupant.
fn occupant(motion: &OccupantMotion) -> PredictedOccupantV1 {
    PredictedOccupantV1 {
        time_of_contact_s: motion.contact.map(|[time, _]| time),
        relative_speed_at_contact_m_per_s: motion.contact.map(|[_, speed]| speed),
        peak_acceleration_m_per_s2: motion.peak_deceleration.value,
        time_of_peak_s: motion.peak_deceleration.time_s,
        largest_excursion_m: motion.largest_excursion.value,
        time_of_largest_excursion_s: motion.largest_excursion.time_s,
        ride_down_share: motion.stop.map(|stop| stop.ridedown_share),
        restraint_share: motion.stop.map(|stop| stop.restraint_share),
    }
}

/// What a reader of the prediction should know.
fn notes(candidate: &Candidate, prediction: &Prediction, partner: &ReadPartner) -> Vec<String> {
    let mut notes = of_test(candidate, &prediction.support, "");
    if let (Partner::Vehicle { candidates, place, .. }, Some(support)) = (&partner.partner, &prediction.partner_support)
    {
        notes.extend(of_test(&candidates[*place], support, "partner: "));
    }
    if let Some(both) = &prediction.collision {
        of_collision(both, partner, &mut notes);
    }
    let outcome = &prediction.outcome;
    if outcome.get(Quantity::DynamicCrush).is_none() {
        notes.push("the model never stops: it has no dynamic crush".to_owned());
    } else if outcome.get(Quantity::Restitution).is_none() {
        notes.push("the model does not rebound: no restitution, no delta-v".to_owned());
    }
    if prediction.occupant.is_some() && outcome.get(Quantity::RideDown).is_none() {
        notes.push("the occupant does not stop with the vehicle: no share of ride-down".to_owned());
    }
    notes
}

/// What the test of a vehicle leaves open.
fn of_test(candidate: &Candidate, support: &Support, whose: &str) -> Vec<String> {
    let mut notes = Vec::new();
    let rule = candidate.rule_beyond_the_test();
    if let Some((element, factor)) = support.beyond {
        let percent = 100.0 * (factor - 1.0);
        notes.push(format!(
            "{whose}extrapolates: element {element} is compressed {percent:.1} % further than in the test. Beyond it \
             the model uses {rule}"
        ));
    }
    if support.faster {
        notes.push(format!("{whose}extrapolates: its dampers move faster than in the test"));
    }
    if support.limited > 0 {
        let many = if support.limited == 1 { "direction" } else { "directions" };
        notes.push(format!(
            "{whose}{} {many} of its parameters are not determined by the test: taken as known to a factor of 2, \
             beside what they change in the test itself",
            support.limited
        ));
    }
    if candidate.spread.is_none() {
        notes.push(format!("{whose}nobody says how well its parameters are known: the intervals hold nothing of them"));
    }
    if support.models == 0 {
        notes.push(format!("{whose}no adequate model to compare with: the intervals hold no spread of models"));
    }
    notes
}

/// What is not in the numbers of a collision.
fn of_collision(both: &CollisionOutcome, partner: &ReadPartner, notes: &mut Vec<String>) {
    if let Some(contact_kg) = both.contact_mass_kg {
        notes.push(format!(
            "a mass of {contact_kg:.1} kg lies between the fronts, whose forces depend on a rate, fall or share \
             several elements: it changes the numbers by about {:.1} %",
            100.0 * CONTACT_SHARE
        ));
    }
    if both.is_share_open {
        notes.push(
            "both fronts crush at the same force: how they share the crush is open, taken in proportion".to_owned(),
        );
    }
    if partner.candidate.is_none() {
        notes.push("the intervals take mass and face of the barrier as exact".to_owned());
    }
    notes.push(
        "one axis, full overlap: the curve of a full-width test holds neither for a part of the front nor for a turn"
            .to_owned(),
    );
}

/// The motion of the compartment, and of that of the partner, from contact on.
pub fn write_waves(n: usize, wave: Wave, out: &mut Output) -> anyhow::Result<()> {
    let Wave { dt_s, mut motions, mut partner, .. } = wave;
    for (of, motion) in [("", motions.pop()), ("partner-", partner.pop())] {
        let Some(motion) = motion else { continue };
        for (what, quantity, samples) in [
            ("displacement", QuantityKind::Displacement, motion.displacement_m),
            ("velocity", QuantityKind::Velocity, motion.velocity_m_per_s),
            ("acceleration", QuantityKind::Acceleration, motion.acceleration_m_per_s2),
        ] {
            out.wave(&format!("prediction/{n}/{of}{what}"), quantity, Sampled::new(0.0, dt_s, samples)?)?;
        }
    }
    Ok(())
}
