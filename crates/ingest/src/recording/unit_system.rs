//! Systems of units of simulations: no file of a solver states one, and physics tells them apart.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Units of length, time and mass that a simulation was run in; force, energy and the rest follow from them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnitSystem {
    /// Millimetre, millisecond, kilogram: kN, J.
    MmMsKg,
    /// Millimetre, second, tonne: N, mJ.
    #[value(name = "mm-s-t")]
    MmST,
    /// Metre, second, kilogram: N, J.
    #[value(name = "m-s-kg")]
    MSKg,
    /// Millimetre, millisecond, gram: N, mJ.
    MmMsG,
}

/// Systems with their names and units: m, s, kg.
const SYSTEMS: [(UnitSystem, &str, [f64; 3]); 4] = [
    (UnitSystem::MmMsKg, "mm-ms-kg", [1e-3, 1e-3, 1.0]),
    (UnitSystem::MmST, "mm-s-t", [1e-3, 1.0, 1e3]),
    (UnitSystem::MSKg, "m-s-kg", [1.0, 1.0, 1.0]),
    (UnitSystem::MmMsG, "mm-ms-g", [1e-3, 1e-3, 1e-3]),
];

impl UnitSystem {
    /// All systems.
    pub const ALL: [Self; 4] = [Self::MmMsKg, Self::MmST, Self::MSKg, Self::MmMsG];

    /// `mm-ms-kg`.
    pub const fn name(self) -> &'static str {
        SYSTEMS[self as usize].1
    }

    /// Its units in SI.
    pub const fn units(self) -> Units {
        let [length_m, time_s, mass_kg] = SYSTEMS[self as usize].2;
        Units { length_m, time_s, mass_kg }
    }
}

impl fmt::Display for UnitSystem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Axis that a model drives along, either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DrivingAxis {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
}

/// Units in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// m.
    pub length_m: f64,
    /// s.
    pub time_s: f64,
    /// kg.
    pub mass_kg: f64,
}

impl Units {
    /// The system with these units, which a file has in single precision.
    pub fn system(self) -> Option<UnitSystem> {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-5;
        UnitSystem::ALL.into_iter().find(|system| {
            let of = system.units();
            near(self.length_m, of.length_m) && near(self.time_s, of.time_s) && near(self.mass_kg, of.mass_kg)
        })
    }
}

/// What a simulation says of its units without stating them, in its own: the last time, the speed at the start, the
/// mass.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Evidence {
    /// Time of the last state.
    pub end: Option<f64>,
    /// Largest speed at the start.
    pub speed: Option<f64>,
    /// Mass of what moves.
    pub mass: Option<f64>,
}

/// Durations of a crash, s; speeds of a car before it, m/s; masses of cars, kg.
const CAR: [std::ops::RangeInclusive<f64>; 3] = [0.03..=0.5, 3.0..=30.0, 600.0..=3500.0];

impl Evidence {
    /// Duration, speed and mass in SI.
    fn in_si(self, units: Units) -> [Option<f64>; 3] {
        [
            self.end.map(|end| end * units.time_s),
            self.speed.map(|speed| speed * units.length_m / units.time_s),
            self.mass.map(|mass| mass * units.mass_kg),
        ]
    }

    /// Whether all that is known is that of a car; nothing known is.
    pub fn is_car(self, units: Units) -> bool {
        self.in_si(units).iter().zip(&CAR).all(|(value, car)| value.is_none_or(|value| car.contains(&value)))
    }

    /// The systems in which it is a car; none where neither speed nor mass is known.
    pub fn fitting(self) -> Vec<UnitSystem> {
        let is_told = self.speed.is_some() || self.mass.is_some();
        UnitSystem::ALL.into_iter().filter(|system| is_told && self.is_car(system.units())).collect()
    }

    /// Mass, speed and duration in these units, in words.
    pub fn words(self, units: Units) -> String {
        let [end_s, speed, mass] = self.in_si(units);
        // Four digits, without zeros at their end.
        let plain = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
        let parts = [
            mass.map(|x| format!("{} kg", plain(x))),
            speed.map(|x| format!("{} m/s", plain(x))),
            end_s.map(|x| format!("{} ms", plain(1e3 * x))),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    /// The same in every system.
    pub fn in_all(self) -> String {
        let of = |system: &UnitSystem| format!("{system}: {}", self.words(system.units()));
        UnitSystem::ALL.iter().map(of).collect::<Vec<_>>().join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn physics_tells_the_system_of_a_car() {
        // 1,500 kg at 15.65 m/s for 150 ms in each system.
        for system in UnitSystem::ALL {
            let units = system.units();
            let evidence = Evidence {
                end: Some(0.15 / units.time_s),
                speed: Some(15.65 * units.time_s / units.length_m),
                mass: Some(1500.0 / units.mass_kg),
            };
            assert_eq!(evidence.fitting(), [system]);
            assert_eq!(evidence.words(units), "1500 kg, 15.65 m/s, 150 ms");
            assert_eq!(units.system(), Some(system));
        }
        let small = Evidence { end: Some(0.0348), speed: Some(50.0), mass: Some(0.002732) };
        assert_eq!(small.fitting(), []);
        let no_mass = Evidence { end: Some(150.0), speed: Some(15.65), mass: None };
        assert_eq!(no_mass.fitting(), [UnitSystem::MmMsKg, UnitSystem::MmMsG]);
    }
}
