//! Made records through `crumple-identify`: how often intervals of identified modes hold truth and estimate, and
//! whether a building in noise that nobody measured shows its modes and no others.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use crumple_artifact::records::{EvidenceV1, ModeV1, ModesV2, SpreadV1, StabilizationV1};
use crumple_numerics::estimation::random::RandomNumbers;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::identification::{chain, chain_modes, filtered, numbers};
use crate::interval_cover::CoverError;
use crate::programs::{Steps, records};

const DT_S: f64 = 0.01;
const SAMPLES: usize = 500;

/// Samples before the record, in which motion and noise settle.
const BEFORE: usize = 200;

/// Samples by which the input of a late system acts late.
const DELAY: usize = 5;

/// Two modes, Hz and damping ratio, with gains 1 and 3; and one.
const TWO: &[(f64, f64)] = &[(3.0, 0.03), (11.0, 0.02)];
const ONE: &[(f64, f64)] = &[(4.0, 0.15)];
const GAINS: [f64; 2] = [1.0, 3.0];

/// The methods with an input, and their flags.
const WITH_INPUT: &[&str] =
    &["--methods", "n4sid,okid,tfest", "--hold", "zero-order", "--inputs", "u", "--outputs", "y"];
const LATE: &[&str] =
    &["--methods", "n4sid,okid,tfest", "--hold", "zero-order", "--inputs", "u", "--outputs", "y", "--delay", "5"];
const FREE: &[&str] = &["--methods", "era", "--channels", "y"];

/// How white noise becomes that of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Noise {
    White,
    /// `1/(1 - 0.9 q⁻¹)`.
    Coloured,
    /// `1/A`, through the poles of the system.
    OfEquation,
}

/// A kind of record.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Name in the table.
    pub name: &'static str,
    modes: &'static [(f64, f64)],
    noise: Noise,
    /// Root mean square of the noise over that of the motion.
    share: f64,
    flags: &'static [&'static str],
}

/// All of them.
pub const KINDS: [Kind; 6] = [
    Kind { name: "white", modes: TWO, noise: Noise::White, share: 0.1, flags: WITH_INPUT },
    Kind { name: "AR 0.9", modes: TWO, noise: Noise::Coloured, share: 0.1, flags: WITH_INPUT },
    Kind { name: "equation noise", modes: TWO, noise: Noise::OfEquation, share: 0.1, flags: WITH_INPUT },
    Kind { name: "delay, AR 0.9", modes: ONE, noise: Noise::Coloured, share: 0.1, flags: LATE },
    Kind { name: "free motion, white", modes: TWO, noise: Noise::White, share: 0.05, flags: FREE },
    Kind { name: "free motion, AR 0.9", modes: TWO, noise: Noise::Coloured, share: 0.05, flags: FREE },
];

/// `1 - 2 Re(z) q⁻¹ + |z|² q⁻²` of a mode.
fn polynomial((hz, damping): (f64, f64)) -> [f64; 3] {
    let (decay, turn) = (TAU * hz * damping * DT_S, TAU * hz * (1.0 - damping * damping).sqrt() * DT_S);
    [1.0, -2.0 * (-decay).exp() * turn.cos(), (-2.0 * decay).exp()]
}

/// The record of a number, as CSV.
fn record(kind: &Kind, number: usize) -> String {
    let mut random = RandomNumbers::of_stream(kind.name.len() as u64, number);
    let mut draws = || (0..BEFORE + SAMPLES).map(|_| random.normal()).collect::<Vec<f64>>();
    let (drawn, e) = (draws(), draws());
    let is_free = kind.flags == FREE;
    let lag = if kind.flags == LATE { DELAY } else { 0 };
    // Struck just before its first sample, free motion has no past.
    let struck = |k: usize| f64::from(u8::from(k + 1 == BEFORE));
    let u = if is_free { (0..drawn.len()).map(struck).collect() } else { drawn };
    let mut y = vec![0.0; u.len()];
    let mut noise = e;
    for (mode, gain) in kind.modes.iter().zip(GAINS) {
        let a = polynomial(*mode);
        let gain = gain * a.iter().sum::<f64>() / 2.0;
        let motion = filtered(&[vec![0.0; 1 + lag], vec![gain, gain]].concat(), &a, &u);
        y.iter_mut().zip(motion).for_each(|(y, x)| *y += x);
        if kind.noise == Noise::OfEquation {
            noise = filtered(&[1.0], &a, &noise);
        }
    }
    if kind.noise == Noise::Coloured {
        noise = filtered(&[1.0], &[1.0, -0.9], &noise);
    }
    let rms = |x: &[f64]| (x[BEFORE..].iter().map(|x| x * x).sum::<f64>() / SAMPLES as f64).sqrt();
    let size = kind.share * rms(&y) / rms(&noise);
    let mut csv = "time [s],u [V],y [V]\n".to_owned();
    for k in 0..SAMPLES {
        let (u, y) = (u[BEFORE + k], y[BEFORE + k] + size * noise[BEFORE + k]);
        let _infallible = writeln!(csv, "{:.2},{u:.12e},{y:.12e}", k as f64 * DT_S);
    }
    csv
}

/// What intervals of one method hold.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Held {
    /// Modes with an interval.
    intervals: usize,
    /// Those whose frequency, damping ratio, and own estimates lie inside.
    frequency: usize,
    damping: usize,
    estimate: usize,
    /// Modes without one.
    without: usize,
}

/// Counts by method, in the order of the program.
pub type Cover = Vec<(String, Held)>;

/// The counts of a kind over the records of these numbers; the same for any number of threads. Errors: a program that
/// is missing or fails.
pub fn cover_of(kind: &Kind, numbers: Range<usize>, (bin, folder): (&Path, &Path)) -> Result<Cover, CoverError> {
    let trials = numbers.into_par_iter().map(|number| {
        let folder = folder.join(number.to_string());
        let steps = Steps { bin, folder: &folder, pipeline: None };
        let order = (2 * kind.modes.len()).to_string();
        let flags = ["--orders", &order, "--poles", &order, "--zeros", &order, "--bootstrap", "60"];
        let printed = identified(&steps, &record(kind, number), &[kind.flags, &flags].concat())?;
        let mut cover = Cover::new();
        for (id, modes) in records(&printed, "/modes/") {
            let evidence = records(&printed, "/evidence/").find(|(of, _)| *of == id);
            let evidence: EvidenceV1 = serde_json::from_value(evidence.map(|(_, data)| data).unwrap_or_default())?;
            let modes: ModesV2 = serde_json::from_value(modes)?;
            let method = id.split('-').next().unwrap_or(&id).to_owned();
            cover.push((method, held(kind, &modes.modes, &evidence)));
        }
        Ok(cover)
    });
    let trials: Vec<Cover> = trials.collect::<Result<_, CoverError>>()?;
    let mut total = Cover::new();
    for (method, more) in trials.into_iter().flatten() {
        match total.iter_mut().find(|(known, _)| *known == method) {
            Some((_, held)) => {
                held.intervals += more.intervals;
                held.frequency += more.frequency;
                held.damping += more.damping;
                held.estimate += more.estimate;
                held.without += more.without;
            }
            None => total.push((method, more)),
        }
    }
    Ok(total)
}

/// What `crumple-identify` prints of a table.
fn identified(steps: &Steps<'_>, csv: &str, flags: &[&str]) -> Result<String, CoverError> {
    steps.write("record.csv", csv)?;
    steps.run("ingest", &["record.csv", "--allow-missing", "-o", "1.mcap"])?;
    let printed = steps.run("identify", &[&["1.mcap", "--json", "-o", "4.mcap"], flags].concat())?;
    steps.remove_folder()?;
    Ok(printed)
}

/// Of every true mode: the oscillating mode with the nearest frequency.
fn held(kind: &Kind, modes: &[ModeV1], evidence: &EvidenceV1) -> Held {
    let mut held = Held::default();
    let inside = |x: f64, spread: &SpreadV1| usize::from(spread.lower <= x && x <= spread.upper);
    for (hz, damping) in kind.modes {
        let w = TAU * hz;
        let apart = |mode: &ModeV1| (mode.natural_frequency_rad_per_s - w).abs();
        let upper = modes.iter().enumerate().filter(|(_, mode)| mode.im_rad_per_s > 0.0);
        let nearest = upper.min_by(|(_, a), (_, b)| apart(a).total_cmp(&apart(b)));
        let interval = nearest.and_then(|(place, mode)| {
            let spread = |all: &[Option<SpreadV1>]| all.get(place).cloned().flatten();
            Some((mode, spread(&evidence.frequency_spreads)?, spread(&evidence.damping_spreads)?))
        });
        let Some((mode, of_frequency, of_damping)) = interval else {
            held.without += 1;
            continue;
        };
        let own = (mode.natural_frequency_rad_per_s, mode.damping_ratio.unwrap_or(f64::NAN));
        held.intervals += 1;
        held.frequency += inside(w, &of_frequency);
        held.damping += inside(*damping, &of_damping);
        held.estimate += inside(own.0, &of_frequency) * inside(own.1, &of_damping);
    }
    held
}

/// What stands over the [`rows`].
pub const HEAD: &str = "| record | method | intervals | frequency, % | damping, % | own estimate, % | none |\n\
                        |---|---|---|---|---|---|---|";

/// Rows of a Markdown table: how many intervals, how many of them hold true frequency, true damping ratio and the
/// estimate itself, how many modes have none.
pub fn rows(kind: &Kind, cover: &Cover) -> String {
    let mut rows = String::new();
    for (method, Held { intervals, frequency, damping, estimate, without }) in cover {
        let share = |count: &usize| 100.0 * *count as f64 / (*intervals).max(1) as f64;
        let shares = [frequency, damping, estimate].map(|count| format!("{:.0}", share(count))).join(" | ");
        let _infallible = writeln!(rows, "| {} | {method} | {intervals} | {shares} | {without} |", kind.name);
    }
    rows
}

/// Name of the ambient records.
pub const AMBIENT: &str = "ambient";

/// Relative distance of a frequency within which a mode is that of the building.
const SAME_FREQUENCY: f64 = 0.05;

/// Of how many ambient records of a five-storey building, 60 s each with 10 % noise, the modes found are its five and
/// no others. Errors: a program that is missing or fails.
pub fn right_clusters(numbers_of: Range<usize>, (bin, folder): (&Path, &Path)) -> Result<usize, CoverError> {
    let rights = numbers_of.into_par_iter().map(|number| {
        let folder = folder.join(format!("{AMBIENT}-{number}"));
        let steps = Steps { bin, folder: &folder, pipeline: None };
        let storeys = building(number);
        let (_, y) = chain(&storeys, false);
        let mut csv = "time [s],y1 [V],y2 [V],y3 [V],y4 [V],y5 [V]\n".to_owned();
        for k in 0..y[0].len() {
            let row: Vec<String> = y.iter().map(|y| format!("{:.9e}", y[k])).collect();
            let _infallible = writeln!(csv, "{:.2},{}", k as f64 * DT_S, row.join(","));
        }
        let flags = ["--methods", "n4sid", "--orders", "10", "--inputs", "none", "--outputs", "y1,y2,y3,y4,y5"];
        let printed = identified(&steps, &csv, &flags)?;
        let Some((_, found)) = records(&printed, "/stabilisation/").find(|(of, _)| of == AMBIENT) else {
            return Ok(false);
        };
        let found: StabilizationV1 = serde_json::from_value(found)?;
        let truth = chain_modes(&numbers(&storeys["masses"]), &numbers(&storeys["springs"]));
        let is_there = |w: &f64| {
            let apart = |found: f64| (found / w - 1.0).abs();
            found.clusters.iter().filter(|c| apart(c.natural_frequency_rad_per_s) < SAME_FREQUENCY).count() == 1
        };
        Ok(found.clusters.len() == truth.len() && truth.iter().all(|(w, _)| is_there(w)))
    });
    let rights: Vec<bool> = rights.collect::<Result<_, CoverError>>()?;
    Ok(rights.into_iter().filter(|is_right| *is_right).count())
}

fn building(number: usize) -> Value {
    json!({
        "masses": [25.0, 25.0, 25.0, 25.0, 25.0], "springs": [1e4, 1e4, 1e4, 1e4, 1e4], "damping": 0.02,
        "dt": DT_S, "N": 6000, "skip": 2000, "noise": 0.1, "kind_of_noise": "deviation",
        "seed": 1000 + 2 * number, "seed_e": 1001 + 2 * number,
    })
}
