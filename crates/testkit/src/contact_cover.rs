//! Made pulses through ingest, filter and integrate: how often nominal 90 % intervals of crush, its time and delta-v
//! hold the truth, wherever contact lies on the file's axis and whatever happens before and after it.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use crumple_artifact::records::EventsV1;
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::{HALF_OF_90_PERCENT, STANDARD_GRAVITY_M_PER_S2 as G};
use rayon::prelude::*;

use crate::interval_cover::{CoverError, rank};
use crate::programs::{StepError, Steps, records};

const DT_S: f64 = 1e-4;

/// Where contact lies and what stands beside the pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Around {
    /// At 0 s of the file, up to 0.5 ms off as the default pipeline assumes, stated by a flag.
    Stated,
    /// The same, and the speed up to 1 % off, which a flag states.
    SpeedOff,
    /// Anywhere from -300 to 300 ms of the file, which nothing states.
    Anywhere,
    /// The same after up to a second of braking with up to 1 g. It goes on until the vehicle stops.
    Braking,
    /// The same after a fall of 0.2 to 0.6 s. Gravity goes on.
    Fall,
    /// The same, and one or two impacts of a third of the first, each 0.2 to 0.3 s after the one before.
    Further,
    /// The same, and a drag of up to 0.1 g afterwards.
    Drag,
    /// The same, and the record ends after 30 to 100 % of the pulse.
    Cut,
}

/// A kind of record.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Name in the table.
    pub name: &'static str,
    around: Around,
    /// The pulse is `sin^power`.
    power: i32,
}

/// The longest lead of a soft front that ingest reckons with, s.
const SOFT_FRONT_S: f64 = 4e-3;

/// All of them.
pub const KINDS: [Kind; 9] = [
    Kind { name: "contact stated", around: Around::Stated, power: 1 },
    Kind { name: "speed off by 1 %", around: Around::SpeedOff, power: 1 },
    Kind { name: "contact anywhere", around: Around::Anywhere, power: 1 },
    Kind { name: "haversine anywhere", around: Around::Anywhere, power: 2 },
    Kind { name: "braking before", around: Around::Braking, power: 1 },
    Kind { name: "fall before", around: Around::Fall, power: 1 },
    Kind { name: "further impacts", around: Around::Further, power: 1 },
    Kind { name: "drag after", around: Around::Drag, power: 1 },
    Kind { name: "cut in the pulse", around: Around::Cut, power: 1 },
];

/// Mass of the vehicle, kg.
pub const MASS_KG: f64 = 1200.0;

/// A made record and what is true of it.
#[derive(Debug)]
pub struct Made {
    /// The record.
    pub csv: String,
    /// Flags of ingest, and of a run.
    pub flags: Vec<String>,
    /// A setting of integrate, as a run takes it.
    pub stated: Option<String>,
    /// Contact on the time axis of the file, s.
    pub contact_s: f64,
    /// Speed at contact, m/s.
    pub true_speed_m_per_s: f64,
    /// Crush, m, and its time, s; `None` where the record ends before the stop.
    pub crush: Option<[f64; 2]>,
    /// Velocity lost where the force ends, or the record, m/s.
    pub delta_v_m_per_s: f64,
    /// Largest deceleration of the pulse, m/s².
    pub peak_m_per_s2: f64,
}

/// Area of `sin^power` over half a period of length 1.
fn area(power: i32) -> f64 {
    if power == 1 { 2.0 / PI } else { 0.5 }
}

impl Kind {
    /// A record by its number.
    pub fn made(&self, number: usize) -> Made {
        let mut random = RandomNumbers::of_stream(self.name.len() as u64, number);
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let (v0, length_s, e) = (between(35.0, 64.0) / 3.6, between(0.07, 0.11), between(0.0, 0.4));
        let peak = (1.0 + e) * v0 / (area(self.power) * length_s);
        // The errors that the default pipeline states: speed 0.1 km/h, zero level 0.05 g, gain 1 %, contact 0.5 ms.
        let speed_error = if self.around == Around::SpeedOff { 0.01 * v0 } else { 0.1 / 3.6 };
        let (speed_m_per_s, gain) = (v0 + between(-speed_error, speed_error), 1.0 + between(-0.01, 0.01));
        let (drift, noise) = (between(-0.05, 0.05) * G, between(0.01, 0.1) * G);
        let is_stated = matches!(self.around, Around::Stated | Around::SpeedOff);
        let zero_s = if is_stated { between(-5e-4, 5e-4) } else { between(-0.3, 0.3) };
        let (level, share, apart_s) = (between(0.0, 1.0), between(0.0, 1.0), [between(0.2, 0.3), between(0.2, 0.3)]);
        // Half of the fronts that nothing states are soft: they touch up to 4 ms before the structure resists.
        let soft_s = (2.0 * between(0.0, 1.0) - 1.0).max(0.0) * SOFT_FRONT_S;
        let soft_s = if is_stated || self.power > 1 { 0.0 } else { soft_s };
        let pulse = |t: f64| {
            let t = t - soft_s;
            if (0.0..length_s).contains(&t) { -peak * (PI * t / length_s).sin().powi(self.power) } else { 0.0 }
        };
        let over_s = soft_s + length_s;
        let total = |t: f64, v: f64| match self.around {
            Around::Braking if t > -share && t < over_s => pulse(t) - level * G * v.signum(),
            Around::Fall if t > -0.2 - 0.4 * share => pulse(t) + G,
            Around::Further => {
                let third = if level > 0.5 { pulse(t - apart_s[0] - apart_s[1]) } else { 0.0 };
                pulse(t) + (pulse(t - apart_s[0]) + third) / 3.0
            }
            Around::Drag if t > over_s => 0.1 * level * G,
            _ => pulse(t),
        };
        let end_s = match self.around {
            Around::Further => 1.0,
            Around::Cut => (0.3 + 0.7 * share) * over_s,
            _ => 0.3,
        };
        // The motion from contact by steps of 10 µs: crush, its time, velocity where the force ends, rows of the file.
        let (step, mut v, mut x) = (1e-5, v0, 0.0);
        let mut crush = None;
        let mut left_m_per_s = v0;
        let mut after = Vec::new();
        for k in 0..(end_s / step) as usize {
            let t = k as f64 * step;
            if k % 10 == 0 {
                after.push(total(t, v));
            }
            let a = total(t + 0.5 * step, v);
            let next = v + step * a;
            if crush.is_none() && next <= 0.0 {
                let part = v / (v - next);
                crush = Some([x + 0.5 * v * part * step, t + part * step]);
            }
            (x, v) = (x + 0.5 * step * (v + next), next);
            left_m_per_s = if t < over_s { v } else { left_m_per_s };
        }
        let lead_s = if matches!(self.around, Around::Braking | Around::Fall) { 1.2 } else { 0.08 };
        let before = (lead_s / DT_S) as i32;
        let motion = (-before..0).map(|k| total(f64::from(k) * DT_S, v0)).chain(after);
        let mut csv = "time [s],acceleration [g]\n".to_owned();
        for (k, a) in motion.enumerate() {
            let t = k as f64 * DT_S - f64::from(before) * DT_S;
            // The zero level moves with the impact: what was removed before it is no longer all of it.
            let moved = if t > 0.0 { drift } else { 0.0 };
            let read = gain * a + moved + noise * random.normal();
            let _infallible = writeln!(csv, "{:.6},{:.6}", t + zero_s, read / G);
        }
        let mut flags = vec![format!("--impact-speed={speed_m_per_s}m/s"), format!("--mass={MASS_KG}kg")];
        flags.extend(is_stated.then(|| "--time-zero=0s".to_owned()));
        let error_km_per_h = 3.6 * speed_error;
        let stated = (self.around == Around::SpeedOff)
            .then(|| format!("integrate.speed_uncertainty={error_km_per_h:.3} km/h uniform"));
        Made {
            csv,
            flags,
            stated,
            contact_s: zero_s,
            true_speed_m_per_s: v0,
            crush,
            delta_v_m_per_s: v0 - left_m_per_s,
            peak_m_per_s2: peak,
        }
    }
}

/// What intervals of a kind hold.
#[derive(Debug, Clone, Default)]
pub struct Held {
    records: usize,
    /// Those in which the vehicle stops.
    stops: usize,
    /// Records with an interval of crush, its time, and delta-v, and those that hold the truth.
    held: [(usize, usize); 3],
    /// Widths of the intervals of crush, m.
    widths_m: Vec<f64>,
    /// The ranks of the three truths in their posteriors.
    pub(crate) ranks: [Vec<f64>; 3],
}

/// The counts of a kind over the records of these numbers; the same for any number of threads. Errors: a program that
/// is missing or fails on anything but the record.
pub fn cover_of(
    kind: &Kind,
    numbers: Range<usize>,
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
    misses: bool,
) -> Result<Held, CoverError> {
    let trial = |number: usize| -> Result<Held, CoverError> {
        let folder = folder.join(number.to_string());
        let steps = Steps { bin, folder: &folder, pipeline: Some(pipeline) };
        let made = kind.made(number);
        let events = events(&steps, &made)?;
        steps.remove_folder()?;
        let mut held = Held { records: 1, stops: usize::from(made.crush.is_some()), ..Held::default() };
        // The crush of a record that ends before the stop is no number: an interval of it is wrong.
        let [crush_m, time_s] = made.crush.unwrap_or([f64::NAN; 2]);
        let truth = [
            ("dynamic_crush_m", crush_m),
            ("time_of_dynamic_crush_s", time_s),
            ("delta_v_m_per_s", made.delta_v_m_per_s),
        ];
        let stated = events
            .as_ref()
            .map(|events| [events.dynamic_crush_m, events.time_of_dynamic_crush_s, events.delta_v_m_per_s]);
        for (place, (name, value)) in truth.iter().enumerate() {
            let counts = &mut held.held[place];
            let intervals = events.iter().flat_map(|events| &events.intervals);
            let Some(interval) = intervals.into_iter().find(|interval| interval.name == *name) else { continue };
            *counts = (1, usize::from(interval.low <= *value && *value <= interval.high));
            let stated = stated.and_then(|stated| stated[place]).filter(|_| value.is_finite());
            let rank = stated.map(|stated| rank(*value, stated, (interval.low, interval.high), HALF_OF_90_PERCENT));
            held.ranks[place].extend(rank);
            held.widths_m.extend((*name == "dynamic_crush_m").then_some(interval.high - interval.low));
        }
        if misses && (events.is_none() || held.held.iter().any(|(all, inside)| all > inside)) {
            let figures = events.iter().flat_map(|events| &events.intervals);
            let figures = figures.filter(|interval| truth.iter().any(|(name, _)| *name == interval.name));
            eprintln!("{} {number}: {truth:?}", kind.name);
            figures.for_each(|one| eprintln!("    {}: {:.5} to {:.5}", one.name, one.low, one.high));
        }
        Ok(held)
    };
    let trials: Vec<Held> = numbers.into_par_iter().map(trial).collect::<Result<_, _>>()?;
    Ok(trials.into_iter().fold(Held::default(), |mut sum, one| {
        sum.records += one.records;
        sum.stops += one.stops;
        for (sum, one) in sum.held.iter_mut().zip(one.held) {
            *sum = (sum.0 + one.0, sum.1 + one.1);
        }
        sum.ranks.iter_mut().zip(one.ranks).for_each(|(sum, one)| sum.extend(one));
        sum.widths_m.extend(one.widths_m);
        sum
    }))
}

/// The events that integrate finds; `None` where a program refuses the record.
fn events(steps: &Steps<'_>, made: &Made) -> Result<Option<EventsV1>, CoverError> {
    steps.write("record.csv", &made.csv)?;
    let stated = made.stated.iter().map(|stated| stated.replace("integrate.speed_", "--speed-"));
    let integrate = ["2.mcap", "--json", "-o", "3.mcap"].map(str::to_owned).into_iter().chain(stated);
    let integrate: Vec<String> = integrate.collect();
    let flags: Vec<&str> = made.flags.iter().map(String::as_str).collect();
    let all = [
        ("ingest", [&["record.csv", "-o", "1.mcap"], flags.as_slice()].concat()),
        ("filter", vec!["1.mcap", "-o", "2.mcap"]),
        ("integrate", integrate.iter().map(String::as_str).collect()),
    ];
    let mut printed = String::new();
    for (program, arguments) in all {
        printed = match steps.run(program, &arguments) {
            Err(StepError::Program(_)) => return Ok(None),
            run => run?,
        };
    }
    let found = records(&printed, "/events").next();
    Ok(found.map(|(_, data)| serde_json::from_value(data)).transpose()?)
}

/// What stands over the [`row`](Held::row)s.
pub const HEAD: &str = "| record | records | crush, % | time of crush, % | delta-v, % | median width, mm | none |\n\
                        |---|---|---|---|---|---|---|";

impl Held {
    /// A line of the table.
    pub fn row(&self, name: &str) -> String {
        let share = |(all, held): (usize, usize)| match all {
            0 => "-".to_owned(),
            all => format!("{:.0}", 100.0 * held as f64 / all as f64),
        };
        let mut widths = self.widths_m.clone();
        widths.sort_unstable_by(f64::total_cmp);
        let median = widths.get(widths.len() / 2).map_or_else(|| "-".to_owned(), |width| format!("{:.0}", 1e3 * width));
        let [crush, time, delta_v] = self.held.map(share);
        let none = self.stops.saturating_sub(self.held[0].0);
        format!("| {name} | {} | {crush} | {time} | {delta_v} | {median} | {none} |", self.records)
    }
}
