//! Finds first contact by the rule asked for.

use crumple_integrate::{TimeZeroEstimate, contact_edge, edr_start, threshold_crossing};
use crumple_metrics::event_end_by_velocity_change;
use crumple_signal::{About, Acceleration, Channel, Notes, Signal, TestDescription, Weight};
use crumple_stage::{Inputs, Refused};

use crate::stage::options::StageSettings;
use crate::stage::options::ZeroRule;

/// Threshold crossings this much later than the file's t = 0 are worth a warning, s.
const LATE_S: f64 = 0.005;

/// First contact on the record's axis, and the rule in the words of the artifact.
pub struct TimeZero {
    pub time_s: f64,
    pub rule: String,
}

/// Time zero of the pulse. What a rule leaves uncertain is said in a note, in time and in displacement.
pub fn time_zero(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    channel: &Channel,
    pulse: &Signal<Acceleration>,
    impact_speed_m_per_s: f64,
    notes: &mut Notes,
) -> anyhow::Result<TimeZero> {
    if let Some(time_s) = settings.time_zero_s {
        return Ok(TimeZero { time_s, rule: "flag".to_owned() });
    }
    let Some(rule) = &settings.time_zero_rule else {
        late_contact(test, channel, pulse, impact_speed_m_per_s, notes);
        return Ok(TimeZero { time_s: 0.0, rule: ZeroRule::File.to_string() });
    };
    let zero = match rule {
        ZeroRule::File => None,
        ZeroRule::Threshold => threshold_crossing(pulse),
        ZeroRule::Edr => edr_start(pulse),
        ZeroRule::Contact(id) => contact_edge(&input.wave(id)?.sampled),
    };
    let Some(zero) = zero else {
        return Err(Refused::new(format!("time zero rule {rule}: {}", nothing_found(rule, &channel.id)))
            .hint("state first contact with --time-zero, e.g. --time-zero 0s")
            .into());
    };
    if *rule == ZeroRule::Threshold && channel.cfc != Some(60) {
        let class = channel.cfc.map_or_else(|| "no class".to_owned(), |cfc| format!("cfc {cfc}"));
        notes.concern(
            About::Time,
            Weight::Slight,
            format!("the threshold rule is meant for cfc 60, channel {} is of {class}", channel.id),
        );
    }
    notes.info(uncertainty(rule, zero, impact_speed_m_per_s));
    if *rule == ZeroRule::Edr
        && let Some(end_s) = event_end_by_velocity_change(pulse, zero.time_s)
    {
        notes.info(format!("the event ends at {:.2} ms by the same rule", 1e3 * (end_s - zero.time_s)));
    }
    Ok(TimeZero { time_s: zero.time_s, rule: rule.to_string() })
}

/// Warns of a pulse that begins long after the file's t = 0 where nothing says that this is first contact: an NHTSA or
/// ISO-MME test defines it so, a person may have stated it; a table does not, and its axis may begin with the
/// recording.
fn late_contact(
    test: &TestDescription,
    channel: &Channel,
    pulse: &Signal<Acceleration>,
    speed_m_per_s: f64,
    notes: &mut Notes,
) {
    // An artifact of another program may have the format alone.
    if test.time_zero.is_some() || matches!(test.source.format.as_str(), "nhtsa-ev5" | "iso-mme") {
        return;
    }
    // What stands does not move on until contact.
    let is_late = |zero: &TimeZeroEstimate| zero.time_s > LATE_S && speed_m_per_s > 0.0;
    let Some(zero) = threshold_crossing(pulse).filter(is_late) else { return };
    let late_ms = 1e3 * zero.time_s;
    notes.concern(About::Time, Weight::Decisive, format!(
        "channel {} first exceeds 0.5 g for 3 ms at {late_ms:.1} ms, and nothing says that contact is at the file's t \
         = 0: the vehicle is taken to move on at the impact speed until then, up to {:.3} m that may be no crush: if \
         contact is there, crumple-ingest --time-zero {late_ms:.1}ms; if it is at 0, crumple-ingest --time-zero 0s",
        channel.id,
        zero.time_s * speed_m_per_s
    ));
}

fn nothing_found(rule: &ZeroRule, pulse: &str) -> String {
    match rule {
        ZeroRule::Contact(id) => format!("channel {id} never changes"),
        ZeroRule::Edr => format!("the velocity of channel {pulse} never changes by 0.8 km/h in 20 ms"),
        ZeroRule::File | ZeroRule::Threshold => format!("channel {pulse} never stays at 0.5 g for 3 ms"),
    }
}

fn uncertainty(rule: &ZeroRule, zero: TimeZeroEstimate, impact_speed_m_per_s: f64) -> String {
    let TimeZeroEstimate { time_s, earlier_by_s, later_by_s } = zero;
    let side = |by_s: f64, word: &str| {
        (by_s > 0.0).then(|| {
            let mm = 1e3 * by_s * impact_speed_m_per_s;
            let distance = if mm > 0.0 { format!(" ({mm:.1} mm at the impact speed)") } else { String::new() };
            format!("{:.2} ms {word}{distance}", 1e3 * by_s)
        })
    };
    let sides: Vec<String> = [side(earlier_by_s, "earlier"), side(later_by_s, "later")].into_iter().flatten().collect();
    let tail = if sides.is_empty() { String::new() } else { format!("; contact may be {}", sides.join(", or ")) };
    format!("time zero by rule {rule} at {:.3} ms of the record{tail}", 1e3 * time_s)
}
