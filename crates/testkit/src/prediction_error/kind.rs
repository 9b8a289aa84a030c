//! The kinds of made cars, and how each is drawn.

use std::f64::consts::TAU;

use crumple_estimation::random::RandomNumbers;

use super::car::Car;
use super::crush_curve::CrushCurve;
use super::motion::{Joint, Part, Structure};

/// A kind of made car.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Name in the tables.
    pub name: &'static str,
    /// Whether a single test could tell how it behaves at another speed: rate effect of at most 1 % per m/s, nothing
    /// that only a harder impact reaches.
    pub told_by_one_test: bool,
    draw: Draw,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Draw {
    Buckling,
    EngineGap,
    RateSensitive,
    Bottoming,
    LinearDamped,
    Foam,
}

/// All of them.
pub const KINDS: &[Kind] = &[
    Kind { name: "two masses, buckling", told_by_one_test: true, draw: Draw::Buckling },
    Kind { name: "three masses, engine meets the wall", told_by_one_test: true, draw: Draw::EngineGap },
    Kind { name: "foam, sled buck", told_by_one_test: true, draw: Draw::Foam },
    Kind { name: "linear, damped", told_by_one_test: true, draw: Draw::LinearDamped },
    Kind { name: "rate-sensitive, 2 to 4 % per m/s", told_by_one_test: false, draw: Draw::RateSensitive },
    Kind { name: "bottoming out", told_by_one_test: false, draw: Draw::Bottoming },
];

/// Speed of the test that is made, m/s: 56 km/h.
pub(super) const TESTED_M_PER_S: f64 = 56.0 / 3.6;

impl Kind {
    /// The car of a number: 900 to 2200 kg, a scale of crush of 0.45 to 0.75 m at 56 km/h.
    pub(super) fn car(&self, number: usize) -> Car {
        let seed = self.name.bytes().fold(0_u64, |seed, byte| seed.wrapping_mul(1_099_511_628_211) ^ u64::from(byte));
        let mut random = RandomNumbers::of_stream(seed, number);
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mass_kg = between(900.0, 2200.0).round();
        let scale_m = between(0.45, 0.75);
        // The mean force that stops the car over its scale of crush.
        let mean_n = 0.5 * mass_kg * TESTED_M_PER_S.powi(2) / scale_m;
        let structure = match self.draw {
            Draw::LinearDamped => linear(mass_kg, scale_m, &mut between),
            Draw::Foam => {
                let curve = CrushCurve::Foam {
                    plateau_n: mean_n * between(0.55, 0.8),
                    bend_m: between(0.01, 0.03),
                    thickness_m: scale_m * between(1.5, 1.9),
                };
                let front = plastic(curve, mass_kg, scale_m, between(0.0, 0.01), between(0.15, 0.3));
                Structure { masses_kg: vec![mass_kg], joints: vec![Joint { front: None, rear: 0, part: front }] }
            }
            Draw::Buckling => two_masses(mass_kg, scale_m, mean_n, between(0.0, 0.01), None, &mut between),
            Draw::RateSensitive => two_masses(mass_kg, scale_m, mean_n, between(0.02, 0.04), None, &mut between),
            Draw::Bottoming => {
                let bottom_m = scale_m * between(0.85, 1.15);
                two_masses(mass_kg, scale_m, mean_n, between(0.0, 0.01), Some(bottom_m), &mut between)
            }
            Draw::EngineGap => engine_gap(mass_kg, scale_m, mean_n, &mut between),
        };
        Car { structure, random }
    }
}

/// Where a structure starts to bottom out and how its force grows there; never, without a place.
fn buckling(mean_n: f64, scale_m: f64, bottom_m: Option<f64>, between: &mut impl FnMut(f64, f64) -> f64) -> CrushCurve {
    let start = between(0.5, 0.8);
    CrushCurve::Buckling {
        force_n: mean_n * start,
        rise_n_per_m: mean_n * (1.1 - start) * 2.0 / scale_m,
        bend_m: between(0.01, 0.04),
        wave: between(0.05, 0.25),
        length_m: between(0.08, 0.2),
        phase: between(0.0, TAU),
        bottom_m: bottom_m.unwrap_or(f64::INFINITY),
        bottom_n_per_m2: if bottom_m.is_some() { mean_n * between(20.0, 60.0) / (scale_m * scale_m) } else { 0.0 },
    }
}

/// A plastic part whose unloading leaves this restitution at 56 km/h, and is stiffer than any of its slopes.
fn plastic(curve: CrushCurve, mass_kg: f64, scale_m: f64, rate_s_per_m: f64, restitution: f64) -> Part {
    let force = curve.at(scale_m);
    let from_restitution = force * force / (mass_kg * (TESTED_M_PER_S * restitution).powi(2));
    let unloading_n_per_m = from_restitution.max(1.1 * curve.steepest(1.5 * scale_m));
    Part::Plastic { curve, unloading_n_per_m, rate_s_per_m, gap_m: 0.0, known_to_m: f64::INFINITY }
}

fn linear(mass_kg: f64, scale_m: f64, between: &mut impl FnMut(f64, f64) -> f64) -> Structure {
    let omega = TESTED_M_PER_S / scale_m * between(0.8, 1.1);
    let damped = |mass: f64, omega: f64, zeta: f64| Part::Linear(mass * omega * omega, 2.0 * zeta * mass * omega);
    let front = damped(mass_kg, omega, between(0.1, 0.4));
    if between(0.0, 1.0) < 0.5 {
        return Structure { masses_kg: vec![mass_kg], joints: vec![Joint { front: None, rear: 0, part: front }] };
    }
    let engine = mass_kg * 0.25;
    let rear = damped(mass_kg - engine, omega * between(1.5, 2.5), between(0.1, 0.4));
    Structure {
        masses_kg: vec![engine, mass_kg - engine],
        joints: vec![Joint { front: None, rear: 0, part: front }, Joint { front: Some(0), rear: 1, part: rear }],
    }
}

/// A front mass of 15 to 35 % behind a structure that folds, the compartment behind one that is half as strong again or
/// twice as strong: what stands between engine and occupants is to hold.
fn two_masses(
    mass_kg: f64,
    scale_m: f64,
    mean_n: f64,
    rate_s_per_m: f64,
    bottom_m: Option<f64>,
    between: &mut impl FnMut(f64, f64) -> f64,
) -> Structure {
    let engine = mass_kg * between(0.15, 0.35);
    let restitution = between(0.08, 0.2);
    let front = plastic(
        buckling(mean_n, 0.75 * scale_m, bottom_m.map(|b| 0.75 * b), between),
        mass_kg,
        scale_m,
        rate_s_per_m,
        restitution,
    );
    let rear = buckling(mean_n * between(1.5, 2.0), 0.3 * scale_m, None, between);
    let rear = plastic(rear, mass_kg - engine, 0.4 * scale_m, rate_s_per_m, restitution);
    Structure {
        masses_kg: vec![engine, mass_kg - engine],
        joints: vec![Joint { front: None, rear: 0, part: front }, Joint { front: Some(0), rear: 1, part: rear }],
    }
}

/// The radiator support in front, rails from it to the compartment, and the engine on its mounts, which reaches the
/// wall after a gap.
fn engine_gap(mass_kg: f64, scale_m: f64, mean_n: f64, between: &mut impl FnMut(f64, f64) -> f64) -> Structure {
    let (support, engine) = (mass_kg * between(0.03, 0.06), mass_kg * between(0.12, 0.2));
    let (rate, restitution) = (between(0.0, 0.01), between(0.08, 0.2));
    let face = plastic(buckling(mean_n * 0.8, 0.3 * scale_m, None, between), mass_kg, 0.4 * scale_m, rate, restitution);
    let rails = plastic(buckling(mean_n * 0.8, 0.8 * scale_m, None, between), mass_kg, scale_m, rate, restitution);
    let block = buckling(mean_n * between(0.5, 1.0), 0.2 * scale_m, None, between);
    let mut block = plastic(block, engine, 0.3 * scale_m, rate, restitution);
    if let Part::Plastic { gap_m, .. } = &mut block {
        *gap_m = scale_m * between(0.35, 0.6);
    }
    let firewall = buckling(mean_n * between(0.3, 0.6), 0.3 * scale_m, None, between);
    let firewall = plastic(firewall, engine, 0.4 * scale_m, rate, restitution);
    Structure {
        masses_kg: vec![support, engine, mass_kg - support - engine],
        joints: vec![
            Joint { front: None, rear: 0, part: face },
            Joint { front: Some(0), rear: 2, part: rails },
            Joint { front: None, rear: 1, part: block },
            Joint { front: Some(1), rear: 2, part: firewall },
        ],
    }
}
