//! The occupant of all predictions: as it was stated, or fitted to a sensor of the test.

use crumple_lumped::Occupant;
use crumple_predict::{Fitted, FittedRestraint, MeasuredRide};
use crumple_signal::Sampled;
use crumple_stage::records::EventsV1;
use crumple_stage::{Inputs, Refused};

use crate::stage::restraint::{Restraint, words};

/// Spacing of the motions that a restraint is fitted to, s: that of the pulses of predictions.
const SPACING_S: f64 = 5e-4;
/// The longest that an occupant is followed, s.
const LONGEST_S: f64 = 0.3;

/// An occupant that rides.
#[derive(Debug, Default)]
pub struct Rider {
    pub occupant: Option<Occupant>,
    /// One standard deviation of its restraint up and down, along each direction.
    pub ends: Vec<[Occupant; 2]>,
    /// It in words.
    pub words: Option<String>,
}

impl Rider {
    /// Whether its restraint follows a sensor of the test.
    pub fn is_fitted(&self) -> bool {
        !self.ends.is_empty()
    }
}

/// The occupant of a test. Errors: a sensor that is not there or that no restraint follows.
pub fn rider(restraint: Option<&Restraint>, input: &Inputs) -> anyhow::Result<Rider> {
    Ok(match restraint {
        None => Rider::default(),
        Some(Restraint::Stated(occupant)) => {
            Rider { occupant: Some(occupant.clone()), ends: Vec::new(), words: Some(words(occupant)) }
        }
        Some(Restraint::OfSensor(channel, mass_kg)) => {
            let fitted = fitted(input, channel, *mass_kg)?;
            let words = Some(in_words(&fitted, channel));
            Rider { occupant: Some(fitted.occupant), ends: fitted.ends, words }
        }
    })
}

/// The restraint that follows a channel of the test.
fn fitted(input: &Inputs, channel: &str, mass_kg: f64) -> anyhow::Result<FittedRestraint> {
    let events: EventsV1 = input.record_if("/events")?.ok_or_else(|| {
        Refused::new("no test with events: a restraint is fitted to one test")
            .hint("state it: --occupant stiffness=...")
    })?;
    let velocity = |channel: &str| {
        let wave = input.wave_if(&format!("{channel}/velocity")).map(|wave| &wave.sampled);
        wave.ok_or_else(|| {
            Refused::new(format!("the velocity of channel {channel} is not there"))
                .hint("channels = [\"all\", \"CHANNEL\"] of [integrate] integrates a sensor on the chest")
        })
    };
    let (vehicle, chest) = (velocity(&events.channel)?, velocity(channel)?);
    let ride = ride(vehicle, chest, events.time_zero_s);
    let restraint = ride.restraint(mass_kg).ok_or_else(|| {
        Refused::new(format!("no restraint follows {channel}: it does not move ahead of the compartment and back"))
    })?;
    Ok(restraint)
}

/// Both motions from contact on, as far as both go.
fn ride(vehicle: &Sampled, chest: &Sampled, time_zero_s: f64) -> MeasuredRide {
    let times = (0..=(LONGEST_S / SPACING_S) as usize).map(|k| time_zero_s + k as f64 * SPACING_S);
    let both = times.map_while(|t| vehicle.at(t).zip(chest.at(t)));
    let (compartment_m_per_s, chest_m_per_s) = both.unzip();
    MeasuredRide { dt_s: SPACING_S, compartment_m_per_s, chest_m_per_s }
}

fn in_words(fitted: &FittedRestraint, channel: &str) -> String {
    let number =
        |of: Fitted, unit: f64, name: &str| format!("{:.1} +- {:.1} {name}", of.value / unit, of.deviation / unit);
    let limit = fitted.limit_n.map_or_else(
        || "no force limit that the sensor shows".to_owned(),
        |limit| format!("limit {}", number(limit, 1e3, "kN")),
    );
    format!(
        "{:.0} kg, restraint fitted to {channel}: {}, slack {}, {limit}; its velocity is missed by {:.2} m/s root mean \
         square, its peak by {:+.1} %, its way ahead of the compartment by {:+.1} %",
        fitted.occupant.mass_kg,
        number(fitted.stiffness_n_per_m, 1e3, "kN/m"),
        number(fitted.slack_m, 1e-3, "mm"),
        fitted.misfit_m_per_s,
        100.0 * (fitted.peak_ratio - 1.0),
        100.0 * (fitted.excursion_ratio - 1.0),
    )
}
