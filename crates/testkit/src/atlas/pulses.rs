//! Pulses of regulations as tables, through ingest, filter and integrate.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use rayon::prelude::*;

use crate::atlas::{Failure, Found, Pulse};
use crate::programs::{Steps, records};

const DT_S: f64 = 1e-4;
/// Rest before the pulse, and the record's end behind contact, s.
const BEFORE_S: f64 = 0.1;
const END_S: f64 = 0.3;
/// Three digits are compared, as reports print them.
const RELATIVE: f64 = 2e-3;

impl Pulse {
    /// Deceleration at a time, g; a corner belongs to what comes before it.
    fn deceleration_g(&self, time_s: f64) -> f64 {
        if let Some(sine) = self.half_sine {
            let phase = time_s / sine.duration_s;
            return if (0.0..1.0).contains(&phase) { sine.peak_g * (PI * phase).sin() } else { 0.0 };
        }
        let piece = self.points_s_g.windows(2).find(|pair| pair[0][0] - 1e-9 <= time_s && time_s <= pair[1][0] + 1e-9);
        piece.map_or(0.0, |pair| {
            let [[t0, a0], [t1, a1]] = [pair[0], pair[1]];
            if t1 > t0 { a0 + (a1 - a0) * (time_s - t0) / (t1 - t0) } else { a0 }
        })
    }

    /// Area below the corners, m/s.
    pub(crate) fn area_m_per_s(&self) -> f64 {
        match self.half_sine {
            Some(sine) => 2.0 / PI * sine.peak_g * sine.duration_s * G,
            None => self.points_s_g.windows(2).map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0]) * G).sum(),
        }
    }

    fn csv(&self) -> String {
        let mut csv = "time [s],acceleration [g]\n".to_owned();
        let (before, end) = ((BEFORE_S / DT_S).round() as i32, (END_S / DT_S).round() as i32);
        for k in -before..=end {
            let time_s = f64::from(k) * DT_S;
            let _infallible = writeln!(csv, "{time_s:.4},{:.9}", 0.0 - self.deceleration_g(time_s));
        }
        csv
    }
}

/// What the programs make of every pulse. Its own area is the impact speed, so that it just stops. Errors: a program
/// fails.
pub fn found_of_pulses(pulses: &[Pulse], bin: &Path, folder: &Path) -> Result<Vec<Found>, Failure> {
    let of_pulse = |pulse: &Pulse| -> Result<Vec<Found>, Failure> {
        let folder = folder.join(&pulse.id);
        let steps = Steps { bin, folder: &folder, pipeline: None };
        steps.write("pulse.csv", &pulse.csv())?;
        let speed = format!("{}m/s", pulse.area_m_per_s());
        let ingest = ["pulse.csv", "--time-zero", "0s", "--mass", "1000kg", "--impact-speed", &speed, "-o", "1.mcap"];
        steps.run("ingest", &ingest)?;
        steps.run("filter", &["1.mcap", "-o", "2.mcap"])?;
        let integrate = ["2.mcap", "--uncertainty-replicates", "0", "--json", "-o", "3.mcap"];
        let printed = steps.run("integrate", &integrate)?;
        let expected = pulse.expected;
        let rows = [
            ("delta-v", Some(expected.delta_v_m_per_s), "delta_v", 1.0),
            ("peak", Some(expected.peak_g), "peak_acceleration", G),
            ("stroke", expected.stroke_m, "dynamic_crush", 1.0),
            ("OLC", expected.olc_g, "olc", G),
        ];
        let asked = rows.into_iter().filter_map(|(of, wanted, name, unit)| Some((of, wanted?, name, unit)));
        asked
            .map(|(of, wanted, name, unit)| {
                let value = metric(&printed, name).ok_or_else(|| format!("{}: no {name}", pulse.id))?.abs() / unit;
                let hit = (value / wanted - 1.0).abs() <= RELATIVE;
                Ok(Found { figure: pulse.id.clone(), of: of.to_owned(), value, interval: None, hit })
            })
            .collect()
    };
    let all: Vec<Vec<Found>> = pulses.par_iter().map(of_pulse).collect::<Result<_, _>>()?;
    Ok(all.into_iter().flatten().collect())
}

/// A metric among what integrate printed.
pub(crate) fn metric(printed: &str, name: &str) -> Option<f64> {
    let (_, metrics) = records(printed, "/metrics").next()?;
    let mut all = metrics.as_array().or_else(|| metrics["metrics"].as_array())?.iter();
    all.find(|metric| metric["name"] == name)?["value"].as_f64()
}
