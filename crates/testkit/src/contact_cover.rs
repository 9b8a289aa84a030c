//! Made pulses through ingest, filter and integrate: how often nominal 90 % intervals of crush, its time and delta-v
//! hold the truth, wherever contact lies on the file's axis and whatever happens before and after it.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use crumple_artifact::records::EventsV1;
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use rayon::prelude::*;

use crate::interval_cover::CoverError;
use crate::programs::{StepError, Steps, records};

const DT_S: f64 = 1e-4;

/// Where contact lies and what stands beside the pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Around {
    /// At 0 s of the file, up to 0.5 ms off as the default pipeline assumes, stated by a flag.
    Stated,
    /// Anywhere from -300 to 300 ms of the file, which nothing states.
    Anywhere,
    /// The same after up to a second of braking with up to 1 g.
    Braking,
    /// The same after a fall of 0.2 to 0.6 s.
    Fall,
    /// The same, and a second impact of a third of the first 0.2 to 0.5 s later.
    Second,
    /// The same, and a drag of up to 0.1 g afterwards.
    Drag,
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

/// All of them.
pub const KINDS: [Kind; 7] = [
    Kind { name: "contact stated", around: Around::Stated, power: 1 },
    Kind { name: "contact anywhere", around: Around::Anywhere, power: 1 },
    Kind { name: "haversine anywhere", around: Around::Anywhere, power: 2 },
    Kind { name: "braking before", around: Around::Braking, power: 1 },
    Kind { name: "fall before", around: Around::Fall, power: 1 },
    Kind { name: "second impact", around: Around::Second, power: 1 },
    Kind { name: "drag after", around: Around::Drag, power: 1 },
];

/// A made record and what is true of it.
struct Made {
    csv: String,
    flags: Vec<String>,
    crush_m: f64,
    time_s: f64,
    delta_v_m_per_s: f64,
}

/// Area of `sin^power` over half a period of length 1.
fn area(power: i32) -> f64 {
    if power == 1 { 2.0 / PI } else { 0.5 }
}

impl Kind {
    fn made(&self, number: usize) -> Made {
        let mut random = RandomNumbers::of_stream(self.name.len() as u64, number);
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let (v0, length_s, e) = (between(35.0, 64.0) / 3.6, between(0.07, 0.11), between(0.05, 0.4));
        let peak = (1.0 + e) * v0 / (area(self.power) * length_s);
        // The errors that the default pipeline states: speed 0.1 km/h, zero level 0.05 g, gain 1 %, contact 0.5 ms.
        let (speed_m_per_s, gain) = (v0 + between(-0.1, 0.1) / 3.6, 1.0 + between(-0.01, 0.01));
        let (drift, noise) = (between(-0.05, 0.05) * G, between(0.01, 0.1) * G);
        let zero_s = match self.around {
            Around::Stated => between(-5e-4, 5e-4),
            _ => between(-0.3, 0.3),
        };
        let (level, lasts_s, apart_s) = (between(0.0, 1.0), between(0.0, 1.0), between(0.2, 0.5));
        let pulse = |t: f64| {
            if (0.0..length_s).contains(&t) { -peak * (PI * t / length_s).sin().powi(self.power) } else { 0.0 }
        };
        let beside = |t: f64| match self.around {
            Around::Stated | Around::Anywhere => 0.0,
            Around::Braking if t < 0.0 && t > -lasts_s => -level * G,
            Around::Fall if t < 0.0 && t > -0.2 - 0.4 * lasts_s => -G,
            Around::Second => pulse(t - apart_s) / 3.0,
            Around::Drag if t > length_s => 0.1 * level * G,
            _ => 0.0,
        };
        let first_s = zero_s - if matches!(self.around, Around::Braking | Around::Fall) { 1.2 } else { 0.08 };
        let rows = ((zero_s + if self.around == Around::Second { 0.8 } else { 0.3 } - first_s) / DT_S) as usize;
        let mut csv = "time [s],acceleration [g]\n".to_owned();
        for k in 0..rows {
            let t = first_s + k as f64 * DT_S;
            // The zero level moves with the impact: what was removed before it is no longer all of it.
            let moved = if t > zero_s { drift } else { 0.0 };
            let a = gain * (pulse(t - zero_s) + beside(t - zero_s)) + moved + noise * random.normal();
            let _infallible = writeln!(csv, "{t:.4},{:.6}", a / G);
        }
        // The motion by steps of a microsecond.
        let (mut v, mut x, mut t) = (v0, 0.0, 0.0);
        while v > 0.0 && t < length_s {
            let a = pulse(t + 5e-7);
            (x, v, t) = (x + 1e-6 * (v + 5e-7 * a), v + 1e-6 * a, t + 1e-6);
        }
        let mut flags = vec![format!("--impact-speed={}m/s", speed_m_per_s), "--mass=1200kg".to_owned()];
        flags.extend((self.around == Around::Stated).then(|| "--time-zero=0s".to_owned()));
        Made { csv, flags, crush_m: x, time_s: t, delta_v_m_per_s: (1.0 + e) * v0 }
    }
}

/// What intervals of a kind hold.
#[derive(Debug, Clone, Default)]
pub struct Held {
    records: usize,
    /// Records with an interval of crush, its time, and delta-v, and those that hold the truth.
    held: [(usize, usize); 3],
    /// Widths of the intervals of crush, m.
    widths_m: Vec<f64>,
}

/// The counts of a kind over the records of these numbers; the same for any number of threads. Errors: a program that
/// is missing or fails on anything but the record.
pub fn cover_of(
    kind: &Kind,
    numbers: Range<usize>,
    (bin, pipeline): (&Path, &Path),
    folder: &Path,
) -> Result<Held, CoverError> {
    let trial = |number: usize| -> Result<Held, CoverError> {
        let folder = folder.join(number.to_string());
        let steps = Steps { bin, folder: &folder, pipeline: Some(pipeline) };
        let made = kind.made(number);
        let events = events(&steps, &made)?;
        steps.remove_folder()?;
        let mut held = Held { records: 1, ..Held::default() };
        let truth = [
            ("dynamic_crush_m", made.crush_m),
            ("time_of_dynamic_crush_s", made.time_s),
            ("delta_v_m_per_s", made.delta_v_m_per_s),
        ];
        for ((name, value), counts) in truth.iter().zip(&mut held.held) {
            let intervals = events.iter().flat_map(|events| &events.intervals);
            let Some(interval) = intervals.into_iter().find(|interval| interval.name == *name) else { continue };
            *counts = (1, usize::from(interval.low <= *value && *value <= interval.high));
            held.widths_m.extend((*name == "dynamic_crush_m").then_some(interval.high - interval.low));
        }
        Ok(held)
    };
    let trials: Vec<Held> = numbers.into_par_iter().map(trial).collect::<Result<_, _>>()?;
    Ok(trials.into_iter().fold(Held::default(), |mut sum, one| {
        sum.records += one.records;
        for (sum, one) in sum.held.iter_mut().zip(one.held) {
            *sum = (sum.0 + one.0, sum.1 + one.1);
        }
        sum.widths_m.extend(one.widths_m);
        sum
    }))
}

/// The events that integrate finds; `None` where a program refuses the record.
fn events(steps: &Steps<'_>, made: &Made) -> Result<Option<EventsV1>, CoverError> {
    steps.write("record.csv", &made.csv)?;
    let flags: Vec<&str> = made.flags.iter().map(String::as_str).collect();
    let all = [
        ("ingest", [&["record.csv", "-o", "1.mcap"], flags.as_slice()].concat()),
        ("filter", vec!["1.mcap", "-o", "2.mcap"]),
        ("integrate", vec!["2.mcap", "--json", "-o", "3.mcap"]),
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
        let none = self.records - self.held[0].0;
        format!("| {name} | {} | {crush} | {time} | {delta_v} | {median} | {none} |", self.records)
    }
}
