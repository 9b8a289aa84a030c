//! What stands between two masses of a made car, or a mass and the wall, and what it remembers.

use super::crush_curve::CrushCurve;
use super::rate_effect::RateEffect;

/// What stands between two masses, or a mass and the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// A structure that stays crushed.
    Plastic(Plastic),
    /// A linear spring, N/m, and damper, N·s/m, in parallel; at the wall it opens at zero force.
    Linear(f64, f64),
}

/// A structure that stays crushed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plastic {
    /// Its static force.
    pub curve: CrushCurve,
    /// Stiffness of unloading, N/m: it gives back `F²/2k` whatever the power.
    pub unloading_n_per_m: f64,
    /// The force while it unloads is a power of the recovery that is left: 1 is straight, above it is concave.
    pub unloading_power: f64,
    /// Force while it is crushed over the static one.
    pub rate: RateEffect,
    /// Way before it is touched, m.
    pub gap_m: f64,
    /// Deflection up to which its curve is known, m; from there the force goes on without waves. Infinite for the
    /// car itself.
    pub known_to_m: f64,
    /// A Maxwell branch beside it: stiffness, N/m, and relaxation time, s. Both open together at zero force.
    pub branch: Option<(f64, f64)>,
}

/// What a plastic part remembers: its set, where and at which force it turned, and whether it is being crushed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Memory {
    set_m: f64,
    turn_m: f64,
    turn_n: f64,
    crushing: bool,
}

impl Memory {
    /// Untouched: the curve starts at once.
    pub const NEW: Self = Self { set_m: 0.0, turn_m: 0.0, turn_n: 0.0, crushing: true };
}

impl Plastic {
    /// Static force while it is crushed, N, at `d` from its touch on.
    pub fn static_force(&self, d: f64) -> f64 {
        if d <= self.known_to_m { self.curve.at(d) } else { self.curve.smooth().at(d) }
    }

    /// Force on the way back and forth from a turn, N.
    fn elastic(&self, memory: Memory, d: f64) -> f64 {
        let left = ((d - memory.set_m) / (memory.turn_m - memory.set_m)).max(0.0);
        memory.turn_n * if self.unloading_power == 1.0 { left } else { left.powf(self.unloading_power) }
    }

    fn force(&self, memory: Memory, d: f64, w: f64) -> f64 {
        let crushing = self.static_force(d) * self.rate.factor(w);
        if memory.crushing { crushing } else { self.elastic(memory, d).min(crushing) }
    }
}

impl Part {
    /// Way before it is touched, m.
    pub fn gap_m(&self) -> f64 {
        if let Self::Plastic(plastic) = self { plastic.gap_m } else { 0.0 }
    }

    /// Force, N, at deflection `d`, rate `w` and a way `slip` of the damper in its branch, and the rate of that way.
    pub fn force(&self, memory: Memory, d: f64, w: f64, slip: f64) -> (f64, f64) {
        match self {
            Self::Linear(k, c) => (k * d + c * w, 0.0),
            Self::Plastic(plastic) => {
                let d = d - plastic.gap_m;
                let force = plastic.force(memory, d, w);
                plastic.branch.map_or((force, 0.0), |(k, relaxation_s)| {
                    ((force + k * (d - slip)).max(0.0), (d - slip) / relaxation_s)
                })
            }
        }
    }

    /// What it remembers after a step that ended at `d` and `w`.
    pub fn after(&self, memory: Memory, d: f64, w: f64) -> Memory {
        let Self::Plastic(plastic) = self else { return memory };
        let d = d - plastic.gap_m;
        if d <= 0.0 {
            return memory;
        }
        let static_n = plastic.static_force(d);
        if memory.crushing && w < 0.0 {
            // The power takes more way for the same energy.
            let recovery_m = 0.5 * (plastic.unloading_power + 1.0) * static_n / plastic.unloading_n_per_m;
            let set_m = (d - recovery_m).max(memory.set_m);
            return Memory { set_m, turn_m: d, turn_n: static_n, crushing: false };
        }
        let meets = w >= 0.0 && plastic.elastic(memory, d) >= static_n * plastic.rate.factor(w);
        Memory { crushing: memory.crushing || meets, ..memory }
    }
}
