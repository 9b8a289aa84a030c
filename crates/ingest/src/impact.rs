//! The impact that a run is about, of a pulse with several: the record is made to begin before it, with contact at
//! t = 0 and the speed that the vehicle then has.

use crumple_metrics::{PulseImpact, impacts};
use crumple_signal::{
    About, Contact, Notes, QuantityKind, Sampled, Signal, Velocity, Weight, part_of, pre_event, remarks,
};

use crate::recording::content::Recording;
use crate::recording::details::{Stated, is_alone};
use crate::recording::settings;
use crate::{Result, refuse, time};

/// A vehicle that is no faster than this part of its impact speed has stopped, m/s: what is left is the error of speed
/// and gain.
const STOPPED: f64 = 0.05;

/// Takes the impact that was asked for, or of a vehicle that goes on after the first the one that stops it, as the
/// impact of the record; says so.
///
/// Without an impact speed it is the first. The samples up to the end of the impact
/// before it are left out of every channel and the zero level from before the first contact is taken off the
/// accelerations: nothing else is at rest before a later impact.
pub fn take(
    file: &str,
    recording: &mut Recording,
    pulse: Option<usize>,
    asked: Option<u32>,
    contact: &mut Option<Contact>,
    notes: &mut Notes,
) -> Result<()> {
    // A recorder's table keeps the change of all its impacts, and a partner that gives way leaves speed.
    let is_table = recording.channels.iter().any(|c| c.channel.quantity == QuantityKind::VelocityChange);
    let may_be_divided =
        |k: &usize| part_of(&recording.channels[*k].channel).is_none() && is_alone(&recording.details) && !is_table;
    let Some(wave) = pulse.filter(may_be_divided).and_then(|k| recording.channels[k].wave.as_ref()) else {
        if asked.is_some() {
            settings::warn("--impact", "only the pulse of a vehicle alone is divided into impacts", notes);
        }
        return Ok(());
    };
    let speed = recording.details.impact_speed_m_per_s.as_ref().map(|stated| stated.value);
    let velocity = velocity(wave, speed.unwrap_or(0.0));
    let all = impacts(&velocity);
    let taken = match asked {
        Some(number) if (1..=all.len().max(1)).contains(&(number as usize)) => number as usize - 1,
        Some(number) => {
            return refuse(
                file,
                format!("--impact {number}, but the pulse holds {} impacts", all.len()),
                "the number of an impact, 1 for the first",
                "leave it out",
            );
        }
        None => stopping(&all, &velocity, speed),
    };
    let (Some(impact), Some(before)) = (all.get(taken), taken.checked_sub(1).and_then(|k| all.get(k))) else {
        return Ok(());
    };
    let (number, start_speed) = (taken + 1, impact.start_velocity_m_per_s);
    notes.push(LaterImpact {
        impacts: all.len(),
        list: (1..).zip(&all).map(|(number, impact)| impact.words_with_peak(number)).collect::<Vec<_>>().join("; "),
        number,
        why: if asked.is_some() { "as asked" } else { "because it stops the vehicle" },
        start_s: impact.start_s,
        speed_m_per_s: speed.map(|_| start_speed),
    });
    for channel in &mut recording.channels {
        let Some(wave) = &channel.wave else { continue };
        let level = match channel.channel.quantity {
            QuantityKind::Acceleration => pre_event(wave).map_or(0.0, |l| l.zero_level),
            _ => 0.0,
        };
        let part = wave.slice(wave.index_at_or_after(before.end_s), wave.len());
        let moved = Sampled::new(part.t0_s(), part.dt_s(), part.samples().iter().map(|x| x - level).collect())
            .and_then(|wave| time::shift(&wave, impact.start_s));
        channel.wave = moved.ok();
    }
    let from = format!("the start of impact {number}");
    if let Some(contact) = contact {
        contact.rule.clone_from(&from);
        contact.source_time_s += impact.start_s;
    }
    if speed.is_some() {
        let moves_on = Some(Stated { value: start_speed, from }).filter(|stated| stated.value > 0.0);
        recording.details.impact_speed_m_per_s = moves_on;
    }
    Ok(())
}

/// The motion from contact on, the zero level taken off.
fn velocity(wave: &Sampled, speed_m_per_s: f64) -> Signal<Velocity> {
    let level = pre_event(wave).map_or(0.0, |before| before.zero_level);
    let zero = wave.index_at_or_after(0.0);
    let (mut v, mut last) = (speed_m_per_s, None);
    let samples = wave.samples()[zero..].iter().map(|a| {
        v += last.map_or(0.0, |last| wave.dt_s() * (last + a - level) / 2.0);
        last = Some(a - level);
        v
    });
    // Of finite samples within what an artifact holds.
    let samples: Vec<f64> = samples.collect();
    Signal::new(wave.time_s(zero), wave.dt_s(), samples).unwrap_or_else(|_| wave.slice(0, 0).into())
}

/// The impact in which the velocity first reaches zero, if the vehicle is still moving when it begins; else the first.
fn stopping(all: &[PulseImpact], velocity: &Signal<Velocity>, speed_m_per_s: Option<f64>) -> usize {
    let Some(speed) = speed_m_per_s.filter(|speed| *speed > 0.0) else { return 0 };
    let Some(stop) = velocity.samples().iter().position(|v| *v <= 0.0) else { return 0 };
    let stop_s = velocity.time_s(stop);
    let last = all.iter().rposition(|impact| impact.start_s <= stop_s).unwrap_or(0);
    match all.get(last) {
        Some(impact) if last > 0 && stop_s <= impact.end_s && impact.start_velocity_m_per_s > STOPPED * speed => last,
        _ => 0,
    }
}

remarks! {
    /// Remarks of pulses with several impacts.
    pub REMARKS;

    /// The pulse holds several impacts, and a later one than the first is taken.
    CR139 LaterImpact {
        impacts: usize, list: String, number: usize, why: &'static str, start_s: f64, speed_m_per_s: Option<f64>
    }
    bears on (About::Motion, Weight::Slight)
    decided "An impact changes the velocity by more than 0.8 km/h and 5 % of the strongest; 15 ms without a force \
             (below 1 g) part two. --impact names one, else it is the one in which the velocity first reaches zero, if \
             the vehicle begins it with more than 5 % of the impact speed."
    means "Crush and models are those of this impact. Samples before it are left out, and the impact speed is the \
           speed that is left at its start."
    remedy "nothing; --impact 1 takes the first impact"
    says {
        let speed = match speed_m_per_s {
            None => String::new(),
            Some(speed) if *speed > 0.0 => format!(", and the impact speed is {:.1} km/h, that of then", 3.6 * speed),
            Some(speed) => format!(", when the vehicle moves back at {:.1} km/h: no impact speed", -3.6 * speed),
        };
        format!(
            "the pulse holds {impacts} impacts: {list}. Impact {number} is taken, {why}: t = 0 is its contact, {:.1} \
             ms after the first{speed}. --impact 1 takes the first",
            1e3 * start_s
        )
    };
}
