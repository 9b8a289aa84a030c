//! Predictions as they stand in the artifact.

use crumple_predict::{Candidate, INTERVAL_LEVEL, Prediction, Quantity, Scenario, Wave};
use crumple_signal::{QuantityKind, Sampled};
use crumple_stage::Output;
use crumple_stage::records::{PredictedEnergyV1, PredictedIntervalV1, PredictionV1};

/// What goes to `/prediction/<n>`.
pub fn record(candidate: &Candidate, names: &[&str], scenario: Scenario, prediction: &Prediction) -> PredictionV1 {
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
        impact_speed_m_per_s: scenario.speed_m_per_s,
        mass_kg: prediction.mass_kg,
        partner: None,
        dynamic_crush_m: number(Quantity::DynamicCrush),
        time_of_dynamic_crush_s: number(Quantity::TimeOfDynamicCrush),
        delta_v_m_per_s: number(Quantity::DeltaV),
        coefficient_of_restitution: number(Quantity::Restitution),
        peak_acceleration_m_per_s2: number(Quantity::Peak),
        olc_m_per_s2: number(Quantity::Olc),
        energy: prediction.energy.map(|energy| PredictedEnergyV1 {
            kinetic_at_impact_j: energy.at_impact_j,
            kinetic_at_rest_j: energy.at_rest_j,
            absorbed_j: energy.at_impact_j - energy.at_rest_j,
        }),
        extrapolates: prediction.beyond.is_some() || prediction.faster,
        intervals: intervals.collect(),
        notes: notes(candidate, prediction),
        against: None,
    }
}

/// What a reader of the prediction should know.
fn notes(candidate: &Candidate, prediction: &Prediction) -> Vec<String> {
    let mut notes = Vec::new();
    let rule = candidate.rule_beyond_the_test();
    if let Some((element, factor)) = prediction.beyond {
        let percent = 100.0 * (factor - 1.0);
        notes.push(format!(
            "extrapolates: element {element} is compressed {percent:.1} % further than in the test; there the model \
             goes on with {rule}"
        ));
    }
    if prediction.faster {
        notes.push("extrapolates: its dampers are faster than in the test".to_owned());
    }
    if prediction.limited > 0 {
        let many = if prediction.limited == 1 { "direction" } else { "directions" };
        notes.push(format!(
            "{} {many} of its parameters are not determined by the test: taken as known to a factor of 2, beside what \
             they change in the test itself",
            prediction.limited
        ));
    }
    if candidate.spread.is_none() {
        notes.push("nobody says how well its parameters are known: the intervals hold nothing of them".to_owned());
    }
    if prediction.models == 0 {
        notes.push("no adequate model to compare with: the intervals hold no spread of models".to_owned());
    }
    if prediction.outcome.get(Quantity::DynamicCrush).is_none() {
        notes.push("the velocity of the model never reaches zero: it has no dynamic crush".to_owned());
    } else if prediction.outcome.get(Quantity::Restitution).is_none() {
        notes.push("the model does not come back from the wall: no restitution, no change of velocity".to_owned());
    }
    notes
}

/// The motion of the compartment, from contact on.
pub fn write_waves(n: usize, wave: Wave, out: &mut Output) -> anyhow::Result<()> {
    let Wave { dt_s, mut motions } = wave;
    let Some(motion) = motions.pop() else { return Ok(()) };
    for (what, quantity, samples) in [
        ("displacement", QuantityKind::Displacement, motion.displacement_m),
        ("velocity", QuantityKind::Velocity, motion.velocity_m_per_s),
        ("acceleration", QuantityKind::Acceleration, motion.acceleration_m_per_s2),
    ] {
        out.wave(&format!("prediction/{n}/{what}"), quantity, Sampled::new(0.0, dt_s, samples)?)?;
    }
    Ok(())
}
