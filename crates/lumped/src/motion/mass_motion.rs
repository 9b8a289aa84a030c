//! The motion of masses: states, samples, responses, events.

use pulp::Arch;

/// One mass at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Displacement since contact, m.
    pub displacement_m: f64,
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
    /// Acceleration, m/s²; at `t = 0` the limit from the right.
    pub acceleration_m_per_s2: f64,
}

/// The motion of one mass at `t = k·dt`, k = 0, 1, ...
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// Displacement since contact, m.
    pub displacement_m: Vec<f64>,
    /// Velocity, m/s.
    pub velocity_m_per_s: Vec<f64>,
    /// Acceleration, m/s²; sample 0 is the limit from the right.
    pub acceleration_m_per_s2: Vec<f64>,
}

/// Waves of a motion that are asked for. What is not asked for may stay empty, and then costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Waves {
    /// All three.
    All,
    /// The displacement.
    Displacement,
    /// The velocity.
    Velocity,
    /// The acceleration.
    Acceleration,
}

impl Waves {
    /// Which of displacement, velocity and acceleration are asked for.
    pub(crate) fn asked(self) -> [bool; 3] {
        [Self::Displacement, Self::Velocity, Self::Acceleration].map(|wave| self == Self::All || self == wave)
    }
}

impl Motion {
    /// This many samples of what is asked for, all zero: to be filled in any order.
    pub(crate) fn zeros(samples: usize, waves: Waves) -> Self {
        let [displacement_m, velocity_m_per_s, acceleration_m_per_s2] =
            waves.asked().map(|asked| vec![0.0; if asked { samples } else { 0 }]);
        Self { displacement_m, velocity_m_per_s, acceleration_m_per_s2 }
    }

    /// Displacement, velocity and acceleration.
    pub(crate) fn waves_mut(&mut self) -> [&mut Vec<f64>; 3] {
        [&mut self.displacement_m, &mut self.velocity_m_per_s, &mut self.acceleration_m_per_s2]
    }

    /// Index of the first sample that is not finite.
    pub(crate) fn first_not_finite(&self) -> Option<usize> {
        let waves = [&self.displacement_m, &self.velocity_m_per_s, &self.acceleration_m_per_s2];
        // Nearly always all are finite, and a sum of flags without an early end is found side by side.
        let strays = |samples: &[f64]| samples.iter().map(|x| u64::from(!x.is_finite())).sum::<u64>();
        let all_finite = || waves.iter().all(|samples| strays(samples) == 0);
        if Arch::new().dispatch(all_finite) {
            return None;
        }
        waves.into_iter().filter_map(|samples| samples.iter().position(|x| !x.is_finite())).min()
    }
}

/// The motion of every mass of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Masses, kg, from the barrier on.
    pub masses_kg: Vec<f64>,
    /// Their motions, in the same order; the last is the passenger compartment.
    pub motions: Vec<Motion>,
}

impl Response {
    /// The motion an accelerometer in the compartment records: that of the last mass.
    pub fn compartment(&self) -> &Motion {
        // Every constructor puts one motion a mass in, and there is no model without a mass.
        &self.motions[self.motions.len() - 1]
    }

    /// Force on the barrier, N, positive in compression: `-sum of m·a` over the masses.
    pub fn barrier_force_n(&self) -> Vec<f64> {
        let samples = self.compartment().acceleration_m_per_s2.len();
        let force = |k: usize| {
            let inertia =
                self.masses_kg.iter().zip(&self.motions).map(|(m, motion)| m * motion.acceleration_m_per_s2[k]);
            -inertia.sum::<f64>()
        };
        (0..samples).map(force).collect()
    }
}

/// The instants of a response, from the exact solution and not from samples.
///
/// Times count from contact. What the model never reaches is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CrushEvents {
    /// Time of dynamic crush `t_m`, s: the first zero of velocity.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Dynamic crush `C = x(t_m)`, m.
    pub dynamic_crush_m: Option<f64>,
    /// Time of rebound, s: the first zero of acceleration after `t_m`, where a real contact would open.
    pub time_of_rebound_s: Option<f64>,
    /// Velocity there, m/s, negative.
    pub rebound_velocity_m_per_s: Option<f64>,
}
