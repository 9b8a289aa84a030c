//! A first run without a record of one's own: a sample record of a car, made and not measured, and its run.
//!
//! The car is one mass behind a force-deflection curve with an elastic unloading, in its exact motion. The sensor adds
//! the ringing of its mount and noise. The same bytes come out everywhere: seed and decimals are fixed.

use std::f64::consts::TAU;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Parser;
use crumple_lumped::{CrushedStructure, Instants, LumpedError};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2;
use crumple_stage::{DisplayFlag, ExitStatus, Usage, say};

use crate::command::Options;

/// Writes the sample record of a car and runs it: a first look without a record of your own.
///
/// The record is made, not measured, and says so in its header. The report stands in runs/crumple-demo/default below
/// the current folder.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-demo",
    version,
    after_help = "It writes crumple-demo.csv, and refuses to where another file has that name.\n\
                  Exit codes: those of crumple run."
)]
pub struct DemoOptions {
    /// Open the report.
    #[arg(long)]
    open: bool,

    #[command(flatten)]
    display: DisplayFlag,

    /// No summary and no progress.
    #[arg(short, long)]
    quiet: bool,
}

/// The record in the current folder.
const RECORD: &str = "crumple-demo.csv";

const MASS_KG: f64 = 1500.0;
const IMPACT_SPEED_KM_PER_H: f64 = 56.0;

/// Deflection, m, and static force, N, of the front: the bumper, the rails as they fold, engine and firewall. Its crush
/// is 0.71 m, as that of a family car at this speed.
const KNOTS: [(f64, f64); 7] =
    [(0.05, 9e4), (0.12, 1.8e5), (0.2, 1.5e5), (0.35, 2.6e5), (0.5, 3.3e5), (0.65, 4.2e5), (0.9, 5.6e5)];
/// It gives back 2 % of the energy: the car rebounds at 15 % of its impact speed.
const UNLOADING_N_PER_M: f64 = 2.5e7;

/// Ringing of the floor from contact on: frequency, Hz, amplitude, g, and time in which it decays to 1/e, s.
const RINGING: [(f64, f64, f64); 3] = [(62.0, -1.6, 0.02), (145.0, 1.2, 0.03), (330.0, 0.8, 0.02)];
/// Standard deviation of the sensor's noise, g.
const NOISE_G: f64 = 0.15;

const RATE_HZ: u32 = 10_000;
/// Samples before contact, and from contact on: 50 ms and 200 ms.
const BEFORE: u32 = 500;
const AFTER: u32 = 2001;

/// Writes the record and runs it.
pub(crate) fn demo(options: &DemoOptions) -> anyhow::Result<ExitStatus> {
    let text = record().context("the sample record cannot be made")?;
    write_once(Path::new(RECORD), &text)?;
    if !options.quiet {
        say(format_args!("{:<16} {RECORD}: a made record of a car, not measured", "demo"));
    }
    let flags = [("--open", options.open), ("--quiet", options.quiet)];
    let flags = flags.iter().filter(|(_, is_given)| *is_given).map(|(flag, _)| *flag);
    let display = options.display.words();
    let display = display.iter().map(String::as_str);
    let words = ["crumple-run"].into_iter().chain(flags).chain(display).chain(["--", RECORD]);
    crate::run::run(Options::try_parse_from(words)?)
}

/// Errors: another file has the name.
fn write_once(path: &Path, text: &str) -> anyhow::Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    match File::create_new(path) {
        Ok(mut file) => file.write_all(text.as_bytes()).with_context(cannot),
        Err(_) if fs::read_to_string(path).is_ok_and(|there| there == text) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
            let folder = std::env::current_dir().unwrap_or_else(|_| PathBuf::from("."));
            let problem = format!("{} in {} is another file; nothing was written", path.display(), folder.display());
            Err(Usage::new(problem).hint("move it, or run crumple demo in another folder").into())
        }
        Err(error) => Err(error).with_context(cannot),
    }
}

/// The record as a table: time, s, and acceleration of the floor, g.
fn record() -> Result<String, LumpedError> {
    let car = CrushedStructure::new(MASS_KG, &KNOTS, UNLOADING_N_PER_M, 0.0)?.structure()?;
    let at = Instants { first_s: 0.0, dt_s: 1.0 / f64::from(RATE_HZ), samples: AFTER as usize };
    let motions = car.motions_at(IMPACT_SPEED_KM_PER_H / 3.6, &at)?;
    let crash = motions.iter().flat_map(|motion| &motion.acceleration_m_per_s2).map(|a| a / STANDARD_GRAVITY_M_PER_S2);
    let rest = std::iter::repeat_n(0.0, BEFORE as usize);
    let mut noise = RandomNumbers::seeded(1);
    let mut text = format!(
        "# title: sample record made by crumple demo, not measured\n\
         # vehicle: made car, one mass behind a force-deflection curve, with ringing and noise\n\
         # mass: {MASS_KG} kg\n\
         # impact speed: {IMPACT_SPEED_KM_PER_H} km/h\n\
         time_s,accel_g\n"
    );
    for (number, pulse_g) in (0_u32..).zip(rest.chain(crash)) {
        let t = (f64::from(number) - f64::from(BEFORE)) / f64::from(RATE_HZ);
        let mode = |(frequency_hz, amplitude_g, decay_s): (f64, f64, f64)| {
            amplitude_g * (TAU * frequency_hz * t).sin() * (-t / decay_s).exp()
        };
        let ringing_g: f64 = if t > 0.0 { RINGING.into_iter().map(mode).sum() } else { 0.0 };
        text += &format!("{t:.4},{:.3}\n", pulse_g + ringing_g + NOISE_G * noise.normal());
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_made_car_stops_as_a_car_does_and_rebounds() {
        let text = record().unwrap();
        assert!(text.starts_with("# title: sample record made by crumple demo, not measured\n"));
        let samples = text
            .lines()
            .filter_map(|line| line.split_once(','))
            .filter_map(|(t, a)| Some((t.parse::<f64>().ok()?, a.parse::<f64>().ok()? * STANDARD_GRAVITY_M_PER_S2)));
        let speed = IMPACT_SPEED_KM_PER_H / 3.6;
        let (mut velocity, mut crush, mut deepest) = (speed, 0.0, 0.0_f64);
        for (_, acceleration) in samples.filter(|(t, _)| *t >= 0.0) {
            velocity += acceleration / f64::from(RATE_HZ);
            crush += velocity / f64::from(RATE_HZ);
            deepest = deepest.max(crush);
        }
        // Ringing and noise bring no more than 1 % of the speed.
        assert!((0.1..0.2).contains(&(-velocity / speed)), "{}", velocity / speed);
        assert!((0.65..0.75).contains(&deepest), "{deepest}");
    }

    #[test]
    fn another_file_of_its_name_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RECORD);
        write_once(&path, "mine").unwrap();
        write_once(&path, "mine").unwrap();
        assert!(write_once(&path, "other").unwrap_err().to_string().contains("another file"));
        assert_eq!(fs::read_to_string(path).unwrap(), "mine");
    }
}
