//! The pulse in words: findings, warnings, a line of the summary.

use crumple_integrate::{WRONG_SIGN, findings, question_speed, wrong_sign};
use crumple_signal::{About, Channel, Note, Notes, Severity, Weight, part_of};

use crate::stage::pulse::integrated::Integrated;

/// Notes what the motion of the pulse shows: first where its sign is wrong or the impact speed does not fit it, because
/// most other notes follow from that.
///
/// Where the stage that read the record asked for an exchange that explains it, nothing more is asked.
pub fn note_findings(
    pulse: &Integrated,
    time_zero_s: f64,
    impact_speed_m_per_s: f64,
    speed_rule: SpeedRule,
    notes: &mut Notes,
) {
    let of_pulse = findings(&pulse.motion, &pulse.events, time_zero_s, impact_speed_m_per_s);
    if wrong_sign(&pulse.motion.velocity, time_zero_s, impact_speed_m_per_s) {
        let before = std::mem::replace(notes, of_pulse);
        notes.extend(before);
        return;
    }
    let question =
        question_speed(&pulse.motion, &pulse.events, impact_speed_m_per_s).filter(|_| speed_rule != SpeedRule::Partner);
    let is_asked = question.is_some() && speed_rule == SpeedRule::AskedBefore;
    // What follows from the exchange is no finding of its own.
    for note in of_pulse.iter().filter(|note| !(is_asked && is_decisive(note))) {
        notes.push(note.clone());
    }
    if let Some(question) = question.filter(|_| !is_asked) {
        notes.concern_first(About::ImpactSpeed, question);
    }
}

/// Whether a speed can be held against a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedRule {
    /// No: a partner gives way, too.
    Partner,
    /// Yes, and the stage that read the record has asked for an exchange of one of both.
    AskedBefore,
    /// Yes, and nobody has asked yet.
    New,
}

fn is_decisive(note: &Note) -> bool {
    note.bearing.as_ref().is_some_and(|bearing| bearing.weight == Weight::Decisive)
}

/// Notes the warnings of the motion of another channel, under its name.
pub fn note_warnings(id: &str, channel: &Integrated, time_zero_s: f64, impact_speed_m_per_s: f64, notes: &mut Notes) {
    for note in findings(&channel.motion, &channel.events, time_zero_s, impact_speed_m_per_s).iter() {
        if note.severity == Severity::Warning {
            notes.concern(About::Channel(id.to_owned()), Weight::Marked, format!("channel {id}: {}", note.text));
        }
    }
}

/// Warns of vehicle metrics of what is no part of the vehicle.
pub fn warn_unless_of_the_vehicle(channel: &Channel, notes: &mut Notes) {
    if !channel.may_be_on_vehicle() || part_of(channel).is_some() {
        let location = if channel.location.is_empty() { "an occupant" } else { &channel.location };
        notes.concern(About::Pulse, Weight::Decisive, format!(
            "channel {} is not of the vehicle ({location}): its dynamic crush, restitution, energies and pulse indices \
             are those of the sensor, not of the vehicle",
            channel.id
        ));
    }
}

/// The line of the summary.
pub fn summary(channel: &str, pulse: &Integrated, time_zero_s: f64, impact_speed_m_per_s: f64) -> String {
    if impact_speed_m_per_s == 0.0 {
        let change = pulse.events.end_velocity_m_per_s;
        return format!("pulse {channel}: from rest, change of velocity {change:.3} m/s at the end, no crash events");
    }
    if wrong_sign(&pulse.motion.velocity, time_zero_s, impact_speed_m_per_s) {
        return format!("pulse {channel}: no crash events, {WRONG_SIGN}");
    }
    match (pulse.events.crush, pulse.events.rebound) {
        (Some(crush), Some(rebound)) => {
            let interval = pulse.event_intervals.first().copied().flatten();
            let interval = interval.map_or_else(String::new, |i| format!(" ({:.3} to {:.3} m)", i.low, i.high));
            format!(
                "pulse {channel}: dynamic crush {:.4} m{interval} at {:.2} ms, rebound {:.3} m/s",
                crush.displacement_m,
                1e3 * crush.time_s,
                rebound.velocity_m_per_s
            )
        }
        _ => {
            let end = pulse.events.end_velocity_m_per_s;
            let change = pulse.events.unstopped.map_or_else(String::new, |unstopped| {
                format!(
                    ", delta-v {:.3} m/s at {:.1} ms (event ends at {:.1} ms: {})",
                    impact_speed_m_per_s - unstopped.velocity_m_per_s,
                    1e3 * unstopped.time_s,
                    1e3 * unstopped.end_s,
                    unstopped.end.name()
                )
            });
            format!("pulse {channel}: the velocity never reaches zero, {end:.3} m/s at the end{change}")
        }
    }
}
