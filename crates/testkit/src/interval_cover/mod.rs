//! Cars of known parameters, recorded as a laboratory does, through the programs: how often the intervals of fitted
//! parameters hold the truth, and how often the true model is chosen.

use std::path::Path;

use crumple_lumped::{
    CrushedStructure, DoubleSpringMassDamper, Elastoplastic, Kelvin, LumpedError, Maxwell, Model, Nonlinear1,
    Nonlinear2, TripleSpringMassDamper,
};
use crumple_numerics::estimation::random::RandomNumbers;

use crate::records::{Errors, FINE_S, Measurement, Ring};

pub(crate) use crate::interval_cover::cover::rank;
pub use crate::interval_cover::cover::{Choices, Counts, Cover, CoverError, DRAWN, Drawn, Miss, choices_of, cover_of};

mod cover;

/// A car of one of [`DRAWN`] in a test as a laboratory records it.
pub(crate) struct MadeByFamily {
    pub model: Model,
    pub mass_kg: f64,
    pub impact_speed_m_per_s: f64,
    /// Whether the mass in front has a sensor, the channel `engine`.
    pub engine: bool,
    /// The record, as CSV.
    pub csv: String,
}

/// The car of a number. Errors: those of the model.
pub(crate) fn made(drawn: &Drawn, number: usize) -> Result<MadeByFamily, LumpedError> {
    let mut random = RandomNumbers::of_stream(drawn.name.len() as u64, number);
    let car = drawn.draw.car(&mut random)?;
    let csv = record(&car, Errors::Laboratory, &mut random)?;
    let Car { model, mass_kg, impact_speed_m_per_s, engine, .. } = car;
    Ok(MadeByFamily { model, mass_kg, impact_speed_m_per_s, engine, csv })
}

/// Writes so many cars of a model as `NUMBER.csv` with the truth beside it, `NUMBER.json`: parameters of the model,
/// its crush and rebound, and the impact speed, in SI units. Errors: no such model, a file that cannot be written.
pub fn write_cars(folder: &Path, name: &str, count: usize) -> Result<(), Box<dyn std::error::Error>> {
    let drawn = DRAWN.iter().find(|drawn| drawn.name == name).ok_or(format!("no family {name}"))?;
    std::fs::create_dir_all(folder)?;
    for number in 0..count {
        let car = made(drawn, number)?;
        let events = car.model.events(car.impact_speed_m_per_s)?;
        let truth = serde_json::json!({
            "parameters": car.model.parameters(),
            "dynamic_crush_m": events.dynamic_crush_m,
            "rebound_velocity_m_per_s": events.rebound_velocity_m_per_s,
            "impact_speed_m_per_s": car.impact_speed_m_per_s,
        });
        std::fs::write(folder.join(format!("{number}.csv")), car.csv)?;
        std::fs::write(folder.join(format!("{number}.json")), format!("{truth:#}\n"))?;
    }
    Ok(())
}

/// What is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Draw {
    Kelvin,
    Elastoplastic,
    Maxwell,
    Nonlinear1,
    Nonlinear2,
    ForceDeflection,
    Triple,
    /// Share of the mass in front, between these; whether the front carries a sensor too.
    Double {
        front: (f64, f64),
        engine: bool,
    },
}

/// A car before its test.
#[derive(Debug, Clone)]
pub(crate) struct Car {
    pub model: Model,
    pub mass_kg: f64,
    pub impact_speed_m_per_s: f64,
    /// Whether the mass next to the barrier has a sensor.
    pub engine: bool,
}

/// Rounds in which the last knot of a nonlinear spring is brought to the crush of its own model.
const ROUNDS: usize = 200;

impl Draw {
    /// A car of 900 to 2200 kg at 35 to 64 km/h whose scale of crush is 0.4 to 0.75 m.
    ///
    /// Springs are counted in `m (v0/C)²`, dampers in `m v0/C`. Errors: those of the model.
    pub fn car(self, random: &mut RandomNumbers) -> Result<Car, LumpedError> {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mass_kg = between(900.0, 2200.0).round();
        let v0 = between(35.0, 64.0).round() / 3.6;
        let crush = between(0.4, 0.75);
        let (k, c) = (mass_kg * (v0 / crush).powi(2), mass_kg * v0 / crush);
        let mut engine = false;
        let model = match self {
            Self::Kelvin => {
                let (omega, zeta) = (v0 / crush * between(0.7, 1.0), between(0.02, 0.4));
                Model::Kelvin(Kelvin {
                    mass_kg,
                    stiffness_n_per_m: mass_kg * omega * omega,
                    damping_n_s_per_m: 2.0 * zeta * omega * mass_kg,
                })
            }
            Self::Elastoplastic => Model::Elastoplastic(Elastoplastic {
                mass_kg,
                loading_stiffness_n_per_m: k,
                unloading_stiffness_n_per_m: k / between(0.08, 0.3).powi(2),
                release: true,
            }),
            Self::Maxwell => Model::Maxwell(Maxwell {
                mass_kg,
                stiffness_n_per_m: k * between(1.5, 4.0),
                damping_n_s_per_m: c * between(1.2, 3.0),
            }),
            Self::Nonlinear1 => {
                let (k1, c3) = (between(0.2, 0.6), between(0.02, 0.1));
                let (k2, c2) = (k1 + between(0.2, 0.8), c3 + between(0.05, 0.2));
                let (c1, knee) = (c2 + between(0.05, 0.3), between(0.2, 0.7));
                last_knot(
                    crush,
                    |crush_m| {
                        Model::Nonlinear1(Nonlinear1 {
                            mass_kg,
                            k1_n_per_m: k1 * k,
                            k2_n_per_m: k2 * k,
                            c1_n_s_per_m: c1 * c,
                            c2_n_s_per_m: c2 * c,
                            c3_n_s_per_m: c3 * c,
                            v_thresh_m_per_s: knee * v0,
                            crush_m,
                            v0_m_per_s: v0,
                        })
                    },
                    v0,
                )?
            }
            Self::Nonlinear2 => {
                let springs = [between(0.2, 0.6), between(0.4, 1.0), between(0.6, 1.6)];
                let dampers = [between(0.2, 0.5), between(0.1, 0.3), between(0.05, 0.2), between(0.02, 0.1)];
                let knots = [between(0.3, 0.7), between(0.15, 0.4), between(0.5, 0.8)];
                last_knot(
                    crush,
                    |crush_m| {
                        Model::Nonlinear2(Nonlinear2 {
                            mass_kg,
                            k1_n_per_m: springs[0] * k,
                            k2_n_per_m: springs[1] * k,
                            k3_n_per_m: springs[2] * k,
                            x1_m: knots[0] * crush_m,
                            c1_n_s_per_m: dampers[0] * c,
                            c2_n_s_per_m: dampers[1] * c,
                            c3_n_s_per_m: dampers[2] * c,
                            c4_n_s_per_m: dampers[3] * c,
                            v1_m_per_s: knots[1] * v0,
                            v2_m_per_s: knots[2] * v0,
                            crush_m,
                            v0_m_per_s: v0,
                        })
                    },
                    v0,
                )?
            }
            Self::ForceDeflection => {
                let of_force = [(0.2, 0.5), (0.2, 0.6), (0.3, 0.8), (0.4, 1.2)];
                let knots = std::array::from_fn(|j| {
                    let force = between(of_force[j].0, of_force[j].1) * k * crush;
                    ((j as f64 + between(0.3, 0.7)) * crush / 3.0, force)
                });
                crushed(mass_kg, knots, k / between(0.08, 0.2).powi(2), between(0.0, 0.008))?
            }
            Self::Triple => {
                let springs = std::array::from_fn(|_| k * between(1.5, 4.0));
                triple(mass_kg, springs, std::array::from_fn(|_| c * between(0.05, 0.4)))
            }
            Self::Double { front, engine: with_engine } => {
                engine = with_engine;
                let m1_kg = between(front.0, front.1) * mass_kg;
                let springs = std::array::from_fn(|_| k * between(1.0, 3.0));
                double([m1_kg, mass_kg - m1_kg], springs, std::array::from_fn(|_| c * between(0.05, 0.4)))
            }
        };
        Ok(Car { model, mass_kg, impact_speed_m_per_s: v0, engine })
    }
}

/// Two masses, springs and dampers, from the barrier on.
fn double([m1_kg, m2_kg]: [f64; 2], [k1, k2]: [f64; 2], [c1, c2]: [f64; 2]) -> Model {
    Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
        m1_kg,
        m2_kg,
        k1_n_per_m: k1,
        k2_n_per_m: k2,
        c1_n_s_per_m: c1,
        c2_n_s_per_m: c2,
    })
}

/// Three masses, divided as the solver assumes.
fn triple(mass_kg: f64, springs_n_per_m: [f64; 3], dampers_n_s_per_m: [f64; 3]) -> Model {
    let masses_kg = [0.125, 0.125, 0.75].map(|share| share * mass_kg);
    Model::TripleSpringMassDamper(TripleSpringMassDamper { masses_kg, springs_n_per_m, dampers_n_s_per_m })
}

/// A curve of knots `(deflection, force)`; unloading is not softer than its steepest slope.
fn crushed(mass_kg: f64, knots: [(f64, f64); 4], unloading: f64, rate_s_per_m: f64) -> Result<Model, LumpedError> {
    Ok(Model::ForceDeflection(CrushedStructure::new(mass_kg, &knots, unloading, rate_s_per_m)?))
}

/// The model whose last knot of the spring is at its own dynamic crush, where the solvers put it.
fn last_knot(start_m: f64, model: impl Fn(f64) -> Model, v0: f64) -> Result<Model, LumpedError> {
    let mut crush_m = start_m;
    for _ in 0..ROUNDS {
        let reached = model(crush_m).events(v0)?.dynamic_crush_m.unwrap_or(crush_m);
        if (reached / crush_m - 1.0).abs() < 1e-13 {
            break;
        }
        crush_m = reached;
    }
    Ok(model(crush_m))
}

/// A family as the programs solve for it.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// Name in the table.
    pub name: &'static str,
    /// Id of its candidates without the index.
    pub id: &'static str,
    /// Flags of crumple-parameter-solve.
    pub flags: &'static [&'static str],
    /// The car that is drawn.
    pub(crate) draw: Draw,
}

/// All of them. Closed forms and fits of one model are two estimators with intervals of their own.
pub const FAMILIES: &[Family] = &[
    Family {
        name: "kelvin, closed form",
        id: "kelvin/closed-form",
        flags: &["--models", "kelvin", "--method", "closed-form"],
        draw: Draw::Kelvin,
    },
    Family {
        name: "kelvin, fit",
        id: "kelvin/direct-fit",
        flags: &["--models", "kelvin", "--method", "direct-fit"],
        draw: Draw::Kelvin,
    },
    Family {
        name: "elastoplastic, closed form",
        id: "elastoplastic/closed-form",
        flags: &["--models", "elastoplastic", "--method", "closed-form"],
        draw: Draw::Elastoplastic,
    },
    Family {
        name: "elastoplastic, fit",
        id: "elastoplastic/direct-fit",
        flags: &["--models", "elastoplastic", "--method", "direct-fit"],
        draw: Draw::Elastoplastic,
    },
    Family {
        name: "maxwell, fit",
        id: "maxwell/direct-fit",
        flags: &["--models", "maxwell", "--method", "direct-fit"],
        draw: Draw::Maxwell,
    },
    Family {
        name: "nonlinear-1, fit",
        id: "nonlinear-1/direct-fit",
        flags: &["--models", "nonlinear-1", "--method", "direct-fit"],
        draw: Draw::Nonlinear1,
    },
    Family {
        name: "nonlinear-2, fit",
        id: "nonlinear-2/direct-fit",
        flags: &["--models", "nonlinear-2", "--method", "direct-fit"],
        draw: Draw::Nonlinear2,
    },
    Family {
        name: "double, split known",
        id: "double-spring-mass-damper/direct-fit",
        flags: &["--models", "double-spring-mass-damper", "--method", "direct-fit", "--front-mass-uncertainty", "0"],
        draw: Draw::Double { front: (0.25, 0.25), engine: false },
    },
    Family {
        name: "double, split 15 to 35 % taken as 25 %",
        id: "double-spring-mass-damper/direct-fit",
        flags: &["--models", "double-spring-mass-damper", "--method", "direct-fit"],
        draw: Draw::Double { front: (0.15, 0.35), engine: false },
    },
    Family {
        name: "double, sensor on the engine, masses free",
        id: "double-spring-mass-damper/direct-fit",
        flags: &[
            "--models",
            "double-spring-mass-damper",
            "--method",
            "direct-fit",
            "--sensors",
            "compartment=accel,engine=engine",
            "--fit-masses",
            "free",
        ],
        draw: Draw::Double { front: (0.15, 0.35), engine: true },
    },
];

/// Samples of the motion from contact on: up to 155 ms, beyond the rebound.
const SAMPLES: usize = 15_501;

/// The record as CSV: columns `accel` and, where the car has that sensor, `engine`. Errors: those of the model.
pub(crate) fn record(car: &Car, errors: Errors, random: &mut RandomNumbers) -> Result<String, LumpedError> {
    let measurement = Measurement::drawn(random, errors == Errors::Few);
    let speed_m_per_s = car.impact_speed_m_per_s + measurement.speed_error_m_per_s;
    let response = car.model.respond(speed_m_per_s, FINE_S, SAMPLES)?;
    let mut motions = vec![("accel", response.compartment().acceleration_m_per_s2.clone())];
    motions.extend(car.engine.then(|| ("engine", response.motions[0].acceleration_m_per_s2.clone())));
    if errors == Errors::Ringing {
        motions.iter_mut().for_each(|(_, motion)| *motion = Ring::drawn(random).added_to(motion));
    }
    let sensors: Vec<(&str, &[f64])> = motions.iter().map(|(name, motion)| (*name, motion.as_slice())).collect();
    let head = format!(
        "# title: made for a trial of intervals\n# mass: {} kg\n# impact speed: {} km/h\n",
        car.mass_kg,
        (car.impact_speed_m_per_s * 3.6).round()
    );
    Ok(measurement.csv(&head, &sensors, random))
}
