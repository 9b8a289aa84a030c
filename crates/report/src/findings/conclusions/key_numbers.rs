//! The numbers that people ask for first, each with its interval, its spread over sensors and why it is missing.

use crate::drawing::numbers::MILLI;
use crate::phrases::PHRASES;
use crumple_artifact::records::{EventsV1, MetricV1};
use schemars::JsonSchema;
use serde::Serialize;

use crate::findings::Run;

/// One of the first numbers of a run, SI.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct KeyNumber {
    /// Name, that of the metric where it is one.
    pub name: &'static str,
    /// Value; `None`: `absent_because` says why.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// Channel it is of.
    pub channel: String,
    /// Instant it belongs to, s after time zero.
    pub at_s: Option<f64>,
    /// Lower end of the interval that the uncertainty of the inputs or the resolution of the recorder gives.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// How the interval was found.
    pub interval_by: Option<String>,
    /// Range over the sensors at the same place, of which the interval knows nothing.
    pub spread: Option<Spread>,
    /// Whether the value is a lower bound: a sensor it was found with may be clipped, or the record ends before the
    /// rebound does.
    pub is_lower_bound: bool,
    /// Why there is no value.
    pub absent_because: Option<String>,
}

/// Level, percent, of an interval that was found so: that of the inputs' uncertainty; a recorder's resolution has none.
pub fn level_percent(interval_by: &str) -> Option<u8> {
    interval_by.starts_with("5-95 %").then_some(90)
}

/// Before a lower bound.
const AT_LEAST: &str = "\u{2265}\u{a0}";

/// Range of a number over several sensors that measured the same.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Spread {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// Their channels.
    pub channels: Vec<String>,
}

impl Spread {
    /// How many sensors it is over.
    pub fn sensors(&self) -> usize {
        self.channels.len()
    }
}

/// The channels that a metric was found with, as its record joins them: `93+94`.
pub(crate) fn channels_of(joined: &str) -> impl Iterator<Item = &str> {
    joined.split('+')
}

/// Decimals of a first number in the unit of people: what is true of it.
pub fn decimals(name: &str) -> usize {
    match name {
        "dynamic_crush" | "hic15" | "hic36" | "time_of_maximum_delta_v" => 0,
        "coefficient_of_restitution" => 2,
        _ => 1,
    }
}

/// Factor, decimals and unit of a time in a sentence: none of a pulse of a car, some of a shorter one.
pub(crate) fn in_ms(time_s: f64) -> (f64, usize, &'static str) {
    (MILLI, true_places(MILLI * time_s), "ms")
}

/// Decimals of a time in ms in a sentence, known to some tenths.
fn true_places(value: f64) -> usize {
    match value.abs() {
        large if large >= 30.0 => 0,
        middle if middle >= 3.0 => 1,
        _ => 2,
    }
}

impl KeyNumber {
    /// What stands before the value.
    pub fn sign(&self) -> &'static str {
        if self.is_lower_bound { AT_LEAST } else { "" }
    }

    /// Whether the interval misses a value that another sensor at the same place gives.
    pub fn interval_misses_a_sensor(&self) -> bool {
        match (self.low, self.high, &self.spread) {
            (Some(low), Some(high), Some(spread)) => spread.low < low || spread.high > high,
            _ => false,
        }
    }
}

/// The first numbers of a run, by the kind of its record: of a vehicle's pulse, an occupant's sensor, a recorder's
/// table. Empty where nothing speaks of a crash.
pub fn key_numbers(run: &Run) -> Vec<KeyNumber> {
    if run.is_generic() {
        return Vec::new();
    }
    let occupant = of_occupant(run);
    if !occupant.is_empty() {
        return occupant;
    }
    let recorded = of_recorder(run);
    match &run.events {
        Some(events) => of_vehicle(run, events, recorded.first()),
        None if recorded.is_empty() => of_pulse(run),
        None => recorded,
    }
}

/// Fields of the events that people ask for, in their order: the name of the metric, the field, the unit.
const OF_EVENTS: [(&str, &str, &str); 4] = [
    ("dynamic_crush", "dynamic_crush_m", "m"),
    ("time_of_dynamic_crush", "time_of_dynamic_crush_s", "s"),
    ("delta_v", "delta_v_m_per_s", "m/s"),
    ("coefficient_of_restitution", "coefficient_of_restitution", "1"),
];

fn of_vehicle(run: &Run, events: &EventsV1, recorded: Option<&KeyNumber>) -> Vec<KeyNumber> {
    let of_rebound = ["delta_v", "coefficient_of_restitution"];
    let from_events = |(name, field, unit): (&'static str, &str, &'static str)| {
        let (value, at_s) = match name {
            "dynamic_crush" => (events.dynamic_crush_m, events.time_of_dynamic_crush_s),
            "time_of_dynamic_crush" => (events.time_of_dynamic_crush_s, None),
            "delta_v" => (events.delta_v_m_per_s, events.time_of_delta_v_s.or(events.time_of_rebound_s)),
            _ => (events.coefficient_of_restitution, None),
        };
        let interval = events.intervals.iter().find(|interval| interval.name == field);
        let without = events.without_interval.iter().find(|without| without.name == field);
        KeyNumber {
            name,
            value,
            unit,
            channel: events.channel.clone(),
            at_s: at_s.filter(|_| value.is_some()),
            low: interval.map(|interval| interval.low),
            high: interval.map(|interval| interval.high),
            interval_by: interval
                .map(|interval| interval.interval_by.clone())
                .or_else(|| without.map(|without| without.reason.clone())),
            spread: spread(run, name, &events.channel),
            is_lower_bound: value.is_some() && of_rebound.contains(&name) && run.is_rebound_cut(),
            absent_because: value.is_none().then(|| why_no_event(run, name)),
        }
    };
    let [crush, time, change, restitution] = OF_EVENTS.map(from_events);
    // Of what follows from a recorder's steps no interval knows their length.
    let olc = run.metric("olc").filter(|_| recorded.is_none());
    // The maximum that a recorder kept goes before the change derived from its table.
    let change = recorded.cloned().unwrap_or(change);
    let olc = olc.map(|metric| of_metric(run, "olc", "m/s^2", metric));
    [Some(crush), Some(time), Some(change), peak(run), olc, Some(restitution)].into_iter().flatten().collect()
}

fn why_no_event(run: &Run, name: &str) -> String {
    let stated = run.metric(name).filter(|metric| metric.value.is_none()).map(|metric| metric.definition.clone());
    stated.unwrap_or_else(|| PHRASES.numbers.velocity_never_zero.to_owned())
}

/// What a pulse without a motion has: change of velocity, peak, OLC.
fn of_pulse(run: &Run) -> Vec<KeyNumber> {
    let metric = |name: &'static str, unit| {
        let metric = run.metric(name).filter(|metric| metric.value.is_some())?;
        Some(of_metric(run, name, unit, metric))
    };
    [metric("delta_v", "m/s"), peak(run), metric("olc", "m/s^2")].into_iter().flatten().collect()
}

/// Criteria of the occupant whose sensor the pulse channel is.
fn of_occupant(run: &Run) -> Vec<KeyNumber> {
    let Some(channel) = run.channel_id() else { return Vec::new() };
    let of_pulse = |name: &str| {
        run.metrics.iter().find(|metric| metric.name == name && channels_of(&metric.channel).any(|id| id == channel))
    };
    if of_pulse("hic15").is_none() {
        return Vec::new();
    }
    let criteria = [("hic15", "1"), ("hic36", "1"), ("clip_3ms_contiguous", "m/s^2")];
    let criterion = |(name, unit)| {
        let metric = of_pulse(name)?;
        let is_lower_bound = metric.value.is_some() && may_be_clipped(run, metric);
        Some(KeyNumber { is_lower_bound, ..of_metric(run, name, unit, metric) })
    };
    criteria.into_iter().filter_map(criterion).collect()
}

/// Whether a sensor of a metric may be clipped. A criterion grows with the magnitude, and what is clipped is too small.
fn may_be_clipped(run: &Run, metric: &MetricV1) -> bool {
    channels_of(&metric.channel).any(|channel| run.clipped.iter().any(|clipped| clipped == channel))
}

/// Before a criterion that is a lower bound.
pub(crate) fn sign_of(run: &Run, metric: &MetricV1) -> &'static str {
    if may_be_clipped(run, metric) { AT_LEAST } else { "" }
}

/// What a recorder kept: the maximum change of velocity and its time. A table of a sample every 10 ms has no peak.
fn of_recorder(run: &Run) -> Vec<KeyNumber> {
    let kept = [("maximum_delta_v", "m/s"), ("time_of_maximum_delta_v", "s")];
    let mut numbers: Vec<KeyNumber> =
        kept.into_iter().filter_map(|(name, unit)| Some(of_metric(run, name, unit, run.metric(name)?))).collect();
    if let [change, time, ..] = &mut numbers[..] {
        change.at_s = time.value;
    }
    numbers
}

fn of_metric(run: &Run, name: &'static str, unit: &'static str, metric: &MetricV1) -> KeyNumber {
    KeyNumber {
        name,
        value: metric.value,
        unit,
        channel: metric.channel.clone(),
        // A moment, not a window.
        at_s: metric.from_s.filter(|from_s| metric.value.is_some() && metric.to_s == Some(*from_s)),
        low: metric.low.filter(|_| metric.value.is_some()),
        high: metric.high.filter(|_| metric.value.is_some()),
        interval_by: metric.interval_by.clone(),
        spread: spread(run, name, &metric.channel),
        is_lower_bound: false,
        absent_because: metric.value.is_none().then(|| metric.definition.clone()),
    }
}

/// The range that the integrate stage states over the sensors at the place of this one.
fn spread(run: &Run, name: &str, channel: &str) -> Option<Spread> {
    run.metrics.iter().filter(|metric| metric.name == name).find_map(|metric| {
        let channels: Vec<String> = channels_of(&metric.channel).map(str::to_owned).collect();
        let is_over_several = channels.len() > 1 && channels.iter().any(|id| id == channel);
        is_over_several.then_some(Spread { low: metric.low?, high: metric.high?, channels })
    })
}

/// Largest deceleration of a filtered pulse, or of a channel without events its largest magnitude. `None`: no
/// acceleration.
fn peak(run: &Run) -> Option<KeyNumber> {
    let texts = &PHRASES.numbers;
    let acceleration = run.acceleration()?;
    let channel = run.channel_id().unwrap_or_default().to_owned();
    let mut number = KeyNumber {
        name: "peak_acceleration",
        value: None,
        unit: "m/s^2",
        channel,
        at_s: None,
        low: None,
        high: None,
        interval_by: None,
        spread: None,
        is_lower_bound: false,
        absent_because: None,
    };
    let unfiltered = run.measured.filtered.is_none() || run.filter.as_ref().is_some_and(|filter| filter.mode == "none");
    let recorded = run.metrics.iter().any(|metric| metric.name == "maximum_delta_v");
    if recorded {
        number.absent_because = Some(texts.peak_of_a_table.to_owned());
    } else if unfiltered {
        number.absent_because = Some(texts.peak_not_filtered.to_owned());
    } else if let Some(metric) = run.metric("peak_acceleration").filter(|metric| metric.channel == number.channel) {
        let at_s = run.metric("time_of_peak_acceleration").and_then(|metric| metric.value);
        return Some(KeyNumber { at_s, ..of_metric(run, "peak_acceleration", "m/s^2", metric) });
    } else {
        let largest = |&i: &usize, &k: &usize| {
            acceleration.samples()[i].abs().total_cmp(&acceleration.samples()[k].abs()).then(k.cmp(&i))
        };
        let at = (0..acceleration.len()).max_by(largest)?;
        number.value = Some(acceleration.samples()[at].abs());
        number.at_s = Some(acceleration.time_s(at));
    }
    Some(number)
}
