//! Records of the made fleet as files.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

use rayon::prelude::*;

use super::car::FleetCar;

/// Sample interval, s.
const DT_S: f64 = 1e-4;
/// Samples before contact and after it.
const BEFORE: i32 = 500;
const AFTER: i32 = 2000;
/// Speeds of the tests of each car, km/h.
const SPEEDS_KM_PER_H: [f64; 2] = [56.0, 40.0];
/// Noise, m/s².
const NOISE_M_PER_S2: f64 = 0.5;
/// Resolution of the digitiser, m/s².
const STEP_M_PER_S2: f64 = 0.05;

/// Writes this many records into a folder, two tests a car, then some that hold no record: `00012-40.csv`,
/// `broken-1.csv`.
pub fn write_fleet(folder: &Path, records: usize, broken: usize, seed: u64) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    (0..records).into_par_iter().try_for_each(|number| {
        let (car, test) = (number / SPEEDS_KM_PER_H.len(), number % SPEEDS_KM_PER_H.len());
        let name = format!("{car:05}-{}.csv", SPEEDS_KM_PER_H[test]);
        fs::write(folder.join(name), record(&FleetCar::new(seed, car), test))
    })?;
    (1..=broken).try_for_each(|number| fs::write(folder.join(format!("broken-{number}.csv")), "no record\n"))
}

fn record(car: &FleetCar, test: usize) -> String {
    let speed_km_per_h = SPEEDS_KM_PER_H[test];
    let mut random = car.random.clone();
    for _ in 0..test * usize::try_from(4 * (BEFORE + AFTER)).unwrap_or_default() {
        let _of_an_earlier_test = random.uniform();
    }
    let mut csv = format!(
        "# title: {} into the wall\n# vehicle: {}\n# mass: {} kg\n# impact speed: {speed_km_per_h} km/h\n\
         # time zero: 0 s\ntime_s,accel (m/s^2)\n",
        car.vehicle, car.vehicle, car.mass_kg
    );
    for k in -BEFORE..AFTER {
        let exact = car.acceleration(speed_km_per_h / 3.6, f64::from(k) * DT_S);
        let measured = ((exact + NOISE_M_PER_S2 * random.normal()) / STEP_M_PER_S2).round() * STEP_M_PER_S2;
        let _infallible = writeln!(csv, "{:.4},{measured:.2}", f64::from(k) * DT_S);
    }
    csv
}
