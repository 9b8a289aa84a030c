//! The numbers that people ask for first, each with its interval, its spread over sensors and why it is missing.

use std::borrow::Cow;

use crate::drawing::numbers::MILLI;
use crate::words;
use crumple_artifact::records::{EventIntervalV1, EventsV1, IntervalSourceV1, MetricV1};
use crumple_signal::Cfc;
use crumple_signal::key_quantities::{
    CLIP_3MS, CRUSH, DELTA_V, DIRECTION_OF_FORCE, HIC15, HIC36, KeyQuantity, MAXIMUM_DELTA_V, MAXIMUM_LATERAL_DELTA_V,
    OLC, PEAK, RECORDED_CRUSH, RECORDED_EES, RESTITUTION, STROKE, TIME_OF_CRUSH, TIME_OF_MAXIMUM_DELTA_V,
    TOTAL_DELTA_V, UNKNOWN,
};
use serde::{Deserialize, Serialize};

use crate::findings::Run;

/// One of the first numbers of a run, SI.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
pub struct KeyNumber {
    /// Name, that of the metric where it is one.
    pub name: Cow<'static, str>,
    /// Value; `None`: `absent_because` says why.
    pub value: Option<f64>,
    /// SI unit.
    pub unit: Cow<'static, str>,
    /// Channel it is of; of several their ids joined.
    pub channel: String,
    /// Every channel it is of.
    pub channels: Vec<String>,
    /// Instant it belongs to, s after time zero.
    pub at_s: Option<f64>,
    /// Lower end of the interval that the uncertainty of the inputs or the resolution of the recorder gives.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// How the interval was found, or why there is none.
    pub interval_by: Option<String>,
    /// What the interval is made from.
    pub interval_source: Option<IntervalSourceV1>,
    /// Range over the sensors at the same place, of which the interval knows nothing.
    pub spread: Option<Spread>,
    /// Whether the value is a lower bound: a sensor it was found with may be clipped, or the record ends before the
    /// rebound does.
    pub is_lower_bound: bool,
    /// Why there is no value.
    pub absent_because: Option<String>,
}

/// Before a lower bound.
const AT_LEAST: &str = "\u{2265}\u{a0}";
/// Before the lower bound of a loss that is written as a negative number.
const AT_MOST: &str = "\u{2264}\u{a0}";

/// Less to one side than this is straight ahead, degrees: half of what is shown.
const STRAIGHT_DEG: f64 = 0.5;

/// Range of a number over several sensors that measured the same.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
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
        match (self.is_lower_bound, self.value) {
            (false, _) => "",
            (true, Some(value)) if value < 0.0 => AT_MOST,
            (true, _) => AT_LEAST,
        }
    }

    /// The same in words.
    pub fn bound(&self) -> &'static str {
        match self.sign() {
            AT_LEAST => "at least ",
            AT_MOST => "at most ",
            _ => "",
        }
    }

    /// How it is called and shown.
    pub fn quantity(&self) -> &'static KeyQuantity {
        KeyQuantity::of(&self.name).unwrap_or(&UNKNOWN)
    }

    /// Its interval, SI.
    pub fn interval(&self) -> Option<(f64, f64)> {
        self.low.zip(self.high)
    }

    /// Two values of it, rounded as its interval asks, the unit behind the second.
    pub fn range(&self, low: f64, high: f64) -> String {
        let shown = self.quantity().shown();
        words::with_unit(words::ends((low, high), self.interval(), shown), shown.2)
    }

    /// The side from which the force of a direction came, by the part of the change of velocity along y, to the right
    /// positive.
    pub fn side(&self, run: &Run) -> Option<&'static str> {
        let is_direction = self.name == DIRECTION_OF_FORCE.key;
        let degrees = self.value.filter(|_| is_direction)?;
        let lateral = run.metric("total_delta_v_lateral").and_then(|metric| metric.value)?;
        let side = if lateral > 0.0 { "from the left" } else { "from the right" };
        (STRAIGHT_DEG..=180.0 - STRAIGHT_DEG).contains(&degrees).then_some(side)
    }

    /// Under which condition it holds: with an impact speed that is in doubt, what follows from it and not from the
    /// pulse alone.
    pub fn condition(&self, is_speed_in_doubt: bool) -> Option<&'static str> {
        let follows = [&CRUSH, &TIME_OF_CRUSH, &RESTITUTION].contains(&self.quantity());
        (is_speed_in_doubt && follows).then_some("if the impact speed is right")
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
        _ if !recorded.is_empty() => recorded,
        Some(events) => of_vehicle(run, events),
        None => of_pulse(run),
    }
}

fn of_vehicle(run: &Run, events: &EventsV1) -> Vec<KeyNumber> {
    let number = |quantity: &KeyQuantity, (field, unit): (&str, &'static str), value: Option<f64>| {
        let interval = events.intervals.iter().find(|interval| interval.name == field);
        let without = events.without_interval.iter().find(|without| without.name == field);
        KeyNumber {
            name: quantity.key.into(),
            value,
            unit: unit.into(),
            channel: events.channel.clone(),
            channels: vec![events.channel.clone()],
            low: interval.map(|interval| interval.low),
            high: interval.map(|interval| interval.high),
            interval_by: interval
                .map(|interval| interval.interval_by.clone())
                .or_else(|| without.map(|without| without.reason.clone())),
            interval_source: interval.and_then(EventIntervalV1::source),
            spread: spread(run, quantity.key, &events.channel),
            absent_because: value.is_none().then(|| why_no_event(run, quantity.key)),
            ..KeyNumber::default()
        }
    };
    let at =
        |at_s: Option<f64>, number: KeyNumber| KeyNumber { at_s: at_s.filter(|_| number.value.is_some()), ..number };
    let is_cut = |name: &str| if name == DELTA_V.key { run.is_change_cut() } else { run.is_rebound_cut() };
    let of_rebound =
        |number: KeyNumber| KeyNumber { is_lower_bound: number.value.is_some() && is_cut(&number.name), ..number };
    let crush = at(events.time_of_dynamic_crush_s, number(&CRUSH, ("dynamic_crush_m", "m"), events.dynamic_crush_m));
    let time = number(&TIME_OF_CRUSH, ("time_of_dynamic_crush_s", "s"), events.time_of_dynamic_crush_s);
    let change = number(&DELTA_V, ("delta_v_m_per_s", "m/s"), events.delta_v_m_per_s);
    let change = of_rebound(at(events.time_of_delta_v_s.or(events.time_of_rebound_s), change));
    let restitution =
        of_rebound(number(&RESTITUTION, ("coefficient_of_restitution", "1"), events.coefficient_of_restitution));
    let olc = run.metric(OLC.key).map(|metric| of_metric(run, &OLC, metric));
    let own = [Some(crush), Some(time), Some(change), peak(run), olc, Some(restitution)];
    own.into_iter().flatten().chain(in_the_plane(run)).collect()
}

/// Total and direction of the change of velocity, of a record along two axes.
const IN_THE_PLANE: [KeyQuantity; 2] = [TOTAL_DELTA_V, DIRECTION_OF_FORCE];

fn in_the_plane(run: &Run) -> impl Iterator<Item = KeyNumber> {
    IN_THE_PLANE.iter().filter_map(|quantity| with_value(run, quantity))
}

/// A metric that has a value.
fn with_value(run: &Run, quantity: &KeyQuantity) -> Option<KeyNumber> {
    let metric = run.metric(quantity.key).filter(|metric| metric.value.is_some())?;
    Some(of_metric(run, quantity, metric))
}

fn why_no_event(run: &Run, name: &str) -> String {
    let stated = run.metric(name).filter(|metric| metric.value.is_none()).map(|metric| metric.definition.clone());
    stated.unwrap_or_else(|| "the velocity does not reach zero".to_owned())
}

/// What a pulse without a crush has: change of velocity, peak, OLC, stroke.
fn of_pulse(run: &Run) -> Vec<KeyNumber> {
    let metric = |quantity: &KeyQuantity| with_value(run, quantity);
    let own = [metric(&DELTA_V), peak(run), metric(&OLC), metric(&STROKE)];
    own.into_iter().flatten().chain(in_the_plane(run)).collect()
}

/// Criteria of the occupant whose sensor the pulse channel is.
fn of_occupant(run: &Run) -> Vec<KeyNumber> {
    let Some(channel) = run.channel_id() else { return Vec::new() };
    let of_pulse =
        |name: &str| run.metrics.iter().find(|metric| metric.name == name && metric.channels().contains(&channel));
    if of_pulse(HIC15.key).is_none() {
        return Vec::new();
    }
    let criterion = |quantity: KeyQuantity| {
        let metric = of_pulse(quantity.key)?;
        let is_lower_bound = metric.value.is_some() && may_be_clipped(run, metric);
        Some(KeyNumber { is_lower_bound, ..of_metric(run, &quantity, metric) })
    };
    [HIC15, HIC36, CLIP_3MS].into_iter().filter_map(criterion).collect()
}

/// Whether a sensor of a metric may be clipped. A criterion grows with the magnitude, and what is clipped is too small.
fn may_be_clipped(run: &Run, metric: &MetricV1) -> bool {
    metric.channels().into_iter().any(|channel| run.clipped.iter().any(|clipped| clipped == channel))
}

/// Before a change of velocity, of which a record that ends too early shows a part.
pub(crate) fn bound_of_change(run: &Run) -> &'static str {
    if run.is_change_cut() { "at least " } else { "" }
}

/// Before a criterion that is a lower bound.
pub(crate) fn sign_of(run: &Run, metric: &MetricV1) -> &'static str {
    if may_be_clipped(run, metric) { AT_LEAST } else { "" }
}

/// What a recorder kept: the largest changes of velocity, and what follows of energy and crush. A table of a sample
/// every 10 ms has no peak.
fn of_recorder(run: &Run) -> Vec<KeyNumber> {
    let kept = [
        MAXIMUM_DELTA_V,
        TIME_OF_MAXIMUM_DELTA_V,
        MAXIMUM_LATERAL_DELTA_V,
        TOTAL_DELTA_V,
        DIRECTION_OF_FORCE,
        RECORDED_EES,
        RECORDED_CRUSH,
    ];
    let mut numbers: Vec<KeyNumber> = kept.iter().filter_map(|quantity| with_value(run, quantity)).collect();
    // Accelerometers along two axes have these as well.
    if numbers.iter().all(|number| IN_THE_PLANE.contains(number.quantity())) {
        return Vec::new();
    }
    // Earlier artifacts have the crush among the events alone.
    if let Some(events) = run.events.as_ref().filter(|_| matches!(&numbers[..], [_, _])) {
        numbers.extend(of_vehicle(run, events).into_iter().find(|number| number.value.is_some()));
    }
    if let [change, time, ..] = &mut numbers[..] {
        change.at_s = time.value;
    }
    numbers
}

fn of_metric(run: &Run, quantity: &KeyQuantity, metric: &MetricV1) -> KeyNumber {
    KeyNumber {
        name: quantity.key.into(),
        value: metric.value,
        unit: metric.unit.clone().into(),
        channel: metric.channel.clone(),
        channels: metric.channels().into_iter().map(str::to_owned).collect(),
        // A moment, not a window.
        at_s: metric.from_s.filter(|from_s| metric.value.is_some() && metric.to_s == Some(*from_s)),
        low: metric.low.filter(|_| metric.value.is_some()),
        high: metric.high.filter(|_| metric.value.is_some()),
        interval_by: metric.interval_by.clone(),
        interval_source: metric.source(),
        spread: spread(run, quantity.key, &metric.channel),
        is_lower_bound: metric.is_lower_bound && metric.value.is_some(),
        absent_because: metric.value.is_none().then(|| metric.definition.clone()),
    }
}

/// The range that the integrate stage states over the sensors at the place of this one.
fn spread(run: &Run, name: &str, channel: &str) -> Option<Spread> {
    run.metrics.iter().filter(|metric| metric.name == name).find_map(|metric| {
        let channels: Vec<String> = metric.channels().into_iter().map(str::to_owned).collect();
        let is_over_several = channels.len() > 1 && channels.iter().any(|id| id == channel);
        is_over_several.then_some(Spread { low: metric.low?, high: metric.high?, channels })
    })
}

/// The class that the pulse had before it was recorded, where a peak can be taken from it.
pub(crate) fn class_of_record(run: &Run) -> Option<u16> {
    run.channel()?.cfc.filter(|class| *class <= Cfc::Cfc60.number())
}

/// Largest deceleration of a filtered pulse, or of a channel without events its largest magnitude. `None`: no
/// acceleration.
fn peak(run: &Run) -> Option<KeyNumber> {
    let acceleration = run.acceleration()?;
    let channel = run.channel_id().unwrap_or_default().to_owned();
    let channels = vec![channel.clone()];
    let mut number =
        KeyNumber { name: PEAK.key.into(), unit: "m/s^2".into(), channel, channels, ..KeyNumber::default() };
    let unfiltered = run.measured.filtered.is_none() || run.filter.as_ref().is_some_and(|filter| filter.mode == "none");
    if unfiltered && class_of_record(run).is_none() {
        number.absent_because = Some("not filtered: the peak of a raw acceleration is mostly ringing".to_owned());
    } else if let Some(metric) = run.metric(PEAK.key).filter(|metric| metric.channel == number.channel) {
        let at_s = run.metric("time_of_peak_acceleration").and_then(|metric| metric.value);
        return Some(KeyNumber { at_s, ..of_metric(run, &PEAK, metric) });
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
