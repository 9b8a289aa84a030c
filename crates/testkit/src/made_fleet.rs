//! Records of a made fleet: cars whose stiffness and damping depend on mass and model year in a known way.

use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

use crumple_numerics::estimation::random::RandomNumbers;
use rayon::prelude::*;

/// Stiffness of a car of the middle year, N/m for each kg.
pub const STIFFNESS_N_PER_M_PER_KG: f64 = 420.0;
/// Rise of the stiffness a model year, as a share of that of the middle year.
pub const STIFFNESS_PER_YEAR: f64 = 0.01;
/// Damping, N s/m for each kg.
pub const DAMPING_N_S_PER_M_PER_KG: f64 = 9.0;
/// Middle of the model years.
pub const MIDDLE_YEAR: i32 = 2010;
/// Standard deviation of stiffness and damping about that, as a share.
const SCATTER: f64 = 0.05;
/// What the cars are called.
const CLASSES: [(&str, f64, f64); 4] =
    [("COMPACT", 1000.0, 1400.0), ("SEDAN", 1350.0, 1800.0), ("SUV", 1600.0, 2300.0), ("PICKUP", 1900.0, 2700.0)];

/// A car.
#[derive(Debug, Clone)]
pub struct FleetCar {
    /// Model year, make and model, as NHTSA writes them.
    pub vehicle: String,
    /// Test mass.
    pub mass_kg: f64,
    /// Stiffness.
    pub stiffness_n_per_m: f64,
    /// Damping.
    pub damping_n_s_per_m: f64,
    /// What its tests draw from.
    pub(crate) random: RandomNumbers,
}

impl FleetCar {
    /// The car of a number.
    pub fn new(seed: u64, number: usize) -> Self {
        let mut random = RandomNumbers::of_stream(seed, number);
        let (class, light, heavy) = CLASSES[number % CLASSES.len()];
        let mass_kg = (light + (heavy - light) * random.uniform()).round();
        let years = (25.0 * random.uniform()).floor() - 12.0;
        let mean_n_per_m = STIFFNESS_N_PER_M_PER_KG * mass_kg * (1.0 + STIFFNESS_PER_YEAR * years);
        let stiffness_n_per_m = mean_n_per_m * (1.0 + SCATTER * random.normal());
        let damping_n_s_per_m = DAMPING_N_S_PER_M_PER_KG * mass_kg * (1.0 + SCATTER * random.normal());
        let vehicle = format!("{} MADE {class} {number:05}", f64::from(MIDDLE_YEAR) + years);
        Self { vehicle, mass_kg, stiffness_n_per_m, damping_n_s_per_m, random }
    }

    /// Acceleration at a time after contact with the wall at a speed, m/s²; zero once it has left the wall.
    pub(crate) fn acceleration(&self, speed_m_per_s: f64, time_s: f64) -> f64 {
        let omega = (self.stiffness_n_per_m / self.mass_kg).sqrt();
        let decay = self.damping_n_s_per_m / (2.0 * self.mass_kg);
        let damped = (omega * omega - decay * decay).sqrt();
        let at = |t: f64| {
            let (sine, cosine) = (damped * t).sin_cos();
            speed_m_per_s
                * (-decay * t).exp()
                * ((decay * decay - damped * damped) / damped * sine - 2.0 * decay * cosine)
        };
        // The wall pushes and never pulls: the force is zero at the first zero of the acceleration.
        let phase = (2.0 * decay * damped).atan2(decay * decay - damped * damped);
        if time_s < 0.0 || time_s >= phase / damped { 0.0 } else { at(time_s) }
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wall_pushes_until_the_car_leaves_it_and_takes_its_speed() {
        let car = FleetCar::new(1, 3);
        let (speed, dt) = (15.0, 1e-6);
        let all: Vec<f64> = (0..200_000).map(|k| car.acceleration(speed, (f64::from(k) + 0.5) * dt)).collect();
        assert!(all.iter().all(|a| *a <= 1e-6 * speed), "{:?}", all.iter().copied().fold(f64::MIN, f64::max));
        let after = speed + all.iter().sum::<f64>() * dt;
        assert!((-0.9 * speed..-0.3 * speed).contains(&after), "{after}");
        let (omega, decay) = ((car.stiffness_n_per_m / car.mass_kg).sqrt(), car.damping_n_s_per_m / car.mass_kg / 2.0);
        let zeta = decay / omega;
        let angle = (1.0 - zeta * zeta).sqrt();
        // Restitution of a spring and a damper that part where the force is zero.
        let expected = (-zeta / angle * (2.0 * zeta * angle).atan2(2.0 * zeta * zeta - 1.0)).exp();
        assert!((after / -speed - expected).abs() < 1e-4, "{after} {expected}");
    }
}
