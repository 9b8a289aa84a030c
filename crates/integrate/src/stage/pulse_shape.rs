//! What a pulse looks like: the simple pulse that fits it best, and the sled pulse of a standard it is held against.

use crumple_metrics::{
    Measured, SimplePulse, SledPulse, best_simple_pulse, check_sled_pulse, first_event, rise_time, simple_pulses,
};
use crumple_signal::{Channel, STANDARD_GRAVITY_M_PER_S2};
use crumple_stage::Output;
use crumple_stage::records::MetricV1;

use crate::stage::integration::Integrated;
use crate::stage::records::metric_record;

/// The class that sled pulses are read at: R16 asks for a response up to 60 Hz.
const SLED_CFC: u16 = 60;

/// Rise time, and what each simple pulse misses of the impact that the events belong to, with a note of the one that
/// fits best. An impact that the record cuts has no shape.
pub fn pulse_shape(id: &str, integrated: &Integrated, out: &mut Output) -> Vec<MetricV1> {
    let acceleration = &integrated.motion.acceleration;
    let impacts = &integrated.events.impacts;
    let impact = first_event(impacts).map(|k| &impacts[k]);
    let rise = rise_time(acceleration, impact.map_or(acceleration.end_s(), |impact| impact.end_s));
    let of_whole = impact.filter(|impact| impact.is_whole);
    let pulses = of_whole.map_or_else(Vec::new, |impact| {
        simple_pulses(acceleration, impact.start_s.max(acceleration.t0_s()), impact.end_s)
    });
    if let Some(best) = best_simple_pulse(&pulses) {
        out.notes().info(format!(
            "the simple pulse that fits best is a {}: it misses the pulse by {:.2} g RMS, {:.1} % of its peak",
            best.words(),
            best.rms_m_per_s2 / STANDARD_GRAVITY_M_PER_S2,
            100.0 * best.share_of_peak
        ));
    }
    let shapes = pulses.iter().map(SimplePulse::metric);
    std::iter::once(rise).chain(shapes).map(|metric| metric_record(&[id], &metric)).collect()
}

/// Holds the pulse against a sled pulse, where one is asked for, and says whether it is met.
pub fn sled_pulse(
    asked: Option<SledPulse>,
    channel: &Channel,
    integrated: &Integrated,
    measured: Measured,
    out: &mut Output,
) -> Vec<MetricV1> {
    let Some(asked) = asked else { return Vec::new() };
    let check = check_sled_pulse(asked, &integrated.motion.acceleration, measured);
    let class = match channel.cfc {
        Some(SLED_CFC) => String::new(),
        Some(other) => format!("; the pulse is of CFC {other}, standards read it at CFC {SLED_CFC}"),
        None => format!("; the pulse has no class, standards read it at CFC {SLED_CFC}"),
    };
    let text = format!("{}{class}", check.words());
    out.summary(text.clone());
    if check.is_met() == Some(false) {
        out.notes().warning(text);
    } else {
        out.notes().info(text);
    }
    check.metrics().iter().map(|metric| metric_record(&[&channel.id], metric)).collect()
}
