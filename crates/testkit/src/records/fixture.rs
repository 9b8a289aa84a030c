//! Crash records with known parameters, as a laboratory would hand them over: `crash.csv` and `truth.json`.

use std::fmt::Write as _;

use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Kelvin, LumpedError, Model};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2;
use crumple_signal::value::Speed;
use serde_json::{Value, json};

const RATE_HZ: u32 = 10_000;
/// Samples before contact: 50 ms.
const BEFORE: usize = 500;
/// Samples from contact on: 0 to 200 ms.
const AFTER: usize = 2001;
/// Instants written to `truth.json`.
const CHECKPOINTS_MS: [usize; 9] = [0, 5, 10, 20, 40, 60, 80, 120, 200];

/// One record: the folder it goes into and its two files.
#[derive(Debug, Clone)]
pub struct Fixture {
    /// Folder under `fixtures/`.
    pub name: &'static str,
    /// Content of `crash.csv`.
    pub csv: String,
    /// Content of `truth.json`.
    pub truth: Value,
}

impl Fixture {
    /// `truth.json` as text.
    pub fn truth_text(&self) -> String {
        format!("{:#}\n", self.truth)
    }
}

struct Car {
    name: &'static str,
    title: &'static str,
    vehicle: &'static str,
    mass_kg: u32,
    speed_km_per_h: u32,
    model: Model,
    noisy: bool,
}

const KELVIN: Model =
    Model::Kelvin(Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0 });

fn cars() -> [Car; 4] {
    [
        Car {
            name: "kelvin",
            title: "synthetic mid-size car, spring and damper in parallel",
            vehicle: "synthetic Kelvin model",
            mass_kg: 873,
            speed_km_per_h: 35,
            model: KELVIN,
            noisy: false,
        },
        Car {
            name: "elastoplastic",
            title: "synthetic family car, unloading stiffer than loading",
            vehicle: "synthetic elastoplastic model",
            mass_kg: 1400,
            speed_km_per_h: 56,
            model: Model::Elastoplastic(Elastoplastic {
                mass_kg: 1400.0,
                loading_stiffness_n_per_m: 700_000.0,
                unloading_stiffness_n_per_m: 48_600_000.0,
                release: true,
            }),
            noisy: false,
        },
        Car {
            name: "double",
            title: "synthetic family car, chassis and compartment",
            vehicle: "synthetic double spring-mass-damper model",
            mass_kg: 1500,
            speed_km_per_h: 50,
            model: Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
                m1_kg: 375.0,
                m2_kg: 1125.0,
                k1_n_per_m: 900_000.0,
                k2_n_per_m: 1_000_000.0,
                c1_n_s_per_m: 6_000.0,
                c2_n_s_per_m: 9_000.0,
            }),
            noisy: false,
        },
        Car {
            name: "noisy",
            title: "synthetic mid-size car with ringing and noise",
            vehicle: "synthetic Kelvin model, 120 Hz ring and sensor noise added",
            mass_kg: 873,
            speed_km_per_h: 35,
            model: KELVIN,
            noisy: true,
        },
    ]
}

/// All fixtures, from the exact responses of their models.
///
/// The numbers depend on the platform's `exp`, `sin` and `cos` in their last digits only.
pub fn fixtures() -> Result<Vec<Fixture>, LumpedError> {
    cars().iter().map(fixture).collect()
}

/// The cars of the fixtures: name, model, mass, kg, speed, m/s.
pub fn fixture_models() -> [(&'static str, Model, f64, f64); 4] {
    cars().map(|car| (car.name, car.model, f64::from(car.mass_kg), f64::from(car.speed_km_per_h) / 3.6))
}

fn fixture(car: &Car) -> Result<Fixture, LumpedError> {
    // As the reader of the file computes it from the header.
    let v0 = Speed::from_si(f64::from(car.speed_km_per_h) * (1.0 / 3.6)).si();
    let dt = 1.0 / f64::from(RATE_HZ);
    let response = car.model.respond(v0, dt, AFTER)?;
    let motion = response.compartment();
    let mut acceleration_g = vec![0.0; BEFORE];
    acceleration_g.extend(motion.acceleration_m_per_s2.iter().map(|a| a / STANDARD_GRAVITY_M_PER_S2));
    if car.noisy {
        add_ring_and_noise(&mut acceleration_g);
    }

    let mut csv = format!(
        "# title: {}\n# vehicle: {}\n# mass: {} kg\n# impact speed: {} km/h\ntime_s,accel_g\n",
        car.title, car.vehicle, car.mass_kg, car.speed_km_per_h
    );
    for (k, a) in acceleration_g.iter().enumerate() {
        // Division by the rate gives the shortest decimals; adding zero turns -0 into 0.
        let t = (k as f64 - BEFORE as f64) / f64::from(RATE_HZ);
        let _infallible = writeln!(csv, "{t},{}", a + 0.0);
    }

    let events = car.model.events(v0)?;
    let checkpoints: Vec<Value> = CHECKPOINTS_MS
        .iter()
        .map(|ms| ms * (RATE_HZ as usize / 1000))
        .map(|k| {
            json!({
                "t_s": k as f64 / f64::from(RATE_HZ),
                "displacement_m": motion.displacement_m[k],
                "velocity_m_per_s": motion.velocity_m_per_s[k],
                "acceleration_m_per_s2": motion.acceleration_m_per_s2[k] + 0.0,
            })
        })
        .collect();
    let dual = match &car.model {
        Model::DoubleSpringMassDamper(double) => json!(Model::DoubleSpringMassDamper(double.dual()).parameters()),
        _ => Value::Null,
    };
    let truth = json!({
        "schema": "crumple.fixture.v1",
        "name": car.name,
        "model": car.model.kind().name(),
        "parameters": car.model.parameters(),
        "equivalent_parameters": dual,
        "mass_kg": f64::from(car.mass_kg),
        "impact_speed_m_per_s": v0,
        "rate_hz": RATE_HZ,
        "samples_before_contact": BEFORE,
        "samples": BEFORE + AFTER,
        "added": if car.noisy { json!("120 Hz ring of 5 g decaying with 25/s from contact on, white noise of 0.3 g") }
                 else { Value::Null },
        "expected": {
            "time_of_dynamic_crush_s": events.time_of_dynamic_crush_s,
            "dynamic_crush_m": events.dynamic_crush_m,
            "time_of_rebound_s": events.time_of_rebound_s,
            "rebound_velocity_m_per_s": events.rebound_velocity_m_per_s,
        },
        "checkpoints": checkpoints,
    });
    Ok(Fixture { name: car.name, csv, truth })
}

/// A structural mode at the sensor's mount and sensor noise, the same on every run.
fn add_ring_and_noise(acceleration_g: &mut [f64]) {
    let mut noise = RandomNumbers::seeded(1);
    for (k, a) in acceleration_g.iter_mut().enumerate() {
        let t = (k as f64 - BEFORE as f64) / f64::from(RATE_HZ);
        if t > 0.0 {
            *a += 5.0 * (-25.0 * t).exp() * (std::f64::consts::TAU * 120.0 * t).sin();
        }
        *a += 0.3 * noise.normal();
    }
}
