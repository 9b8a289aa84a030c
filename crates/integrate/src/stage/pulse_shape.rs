//! What a pulse looks like: the simple pulse that fits it best, and the sled pulse of a standard it is held against.

use crumple_metrics::{
    Measured, SimplePulse, SledPulse, best_simple_pulse, check_sled_pulse, first_event, rise_time, simple_pulses,
};
use crumple_signal::{About, Channel, Note, STANDARD_GRAVITY_M_PER_S2, Weight, remarks};
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
        let (rms_m_per_s2, share_of_peak) = (best.rms_m_per_s2, best.share_of_peak);
        out.notes().push(SimplePulseFits { pulse: best.words(), rms_m_per_s2, share_of_peak });
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
    let (reason, class) = (check.words(), channel.cfc);
    let remark: Note = if check.is_met() == Some(false) {
        SledPulseMissed { reason, class }.into()
    } else {
        SledPulseMet { reason, class }.into()
    };
    out.summary(remark.text.clone());
    out.notes().push(remark);
    check.metrics().iter().map(|metric| metric_record(&[&channel.id], metric)).collect()
}

/// A verdict with the class that the pulse has, where it is not the one of the standards.
fn with_class(reason: &str, class: Option<u16>) -> String {
    match class {
        Some(SLED_CFC) => reason.to_owned(),
        Some(other) => format!("{reason}; the pulse is of CFC {other}, standards read it at CFC {SLED_CFC}"),
        None => format!("{reason}; the pulse has no class, standards read it at CFC {SLED_CFC}"),
    }
}

remarks! {
    /// Remarks of the shape of a pulse.
    pub REMARKS;

    /// The simple pulse (half sine, haversine, triangle, trapezoid, square wave) that is nearest to the measured one.
    CR325 SimplePulseFits { pulse: String, rms_m_per_s2: f64, share_of_peak: f64 }
    bears on (About::Motion, Weight::None)
    decided "Each keeps duration and change of velocity of the impact; its free numbers are found by least squares. \
             Some miss at most 5 % more than the closest; the one of them with the fewest free numbers is named."
    means "It may stand for the pulse in a simulation. What it misses is the root mean square over the impact."
    remedy "nothing; /metrics has the numbers of every simple pulse"
    says format!(
        "the simple pulse that fits best is a {pulse}: it misses the pulse by {:.2} g RMS, {:.1} % of its peak",
        rms_m_per_s2 / STANDARD_GRAVITY_M_PER_S2,
        100.0 * share_of_peak
    );

    /// The pulse is what the standard of a sled test demands, as far as the record shows.
    CR326 SledPulseMet { reason: String, class: Option<u16> }
    bears on (About::Motion, Weight::None)
    decided "The pulse is held against the corridor, speed, stroke and peak of the standard that integrate.corridor \
             names. Standards read it at CFC 60: UN R16 asks for a response up to 60 Hz."
    means "No demand is violated. What the record does not show is not known."
    remedy "nothing; with another class than 60 filter the pulse to it: --cfc 60"
    says with_class(reason, *class);

    /// The pulse violates a demand of the standard of a sled test.
    CR327 SledPulseMissed { reason: String, class: Option<u16> }
    bears on (About::Motion, Weight::Slight)
    decided "The pulse is held against the corridor, speed, stroke and peak of the standard that integrate.corridor \
             names. Standards read it at CFC 60: UN R16 asks for a response up to 60 Hz."
    means "The test was not run with the pulse of the standard. Its motion is what was measured."
    remedy "filter the pulse to CFC 60 if it has another class; else the sled needs another setting"
    says with_class(reason, *class);
}
