use crumple_signal::{Acceleration, Displacement, Signal, Velocity};

use crate::metric::grid::same_grid;
use crate::{CrashEvents, MetricsError};

/// One branch of a force-deflection curve; both lists have one entry a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Branch {
    /// Displacement x, m.
    pub deflection_m: Vec<f64>,
    /// Barrier force -m·a, N, positive in compression.
    pub force_n: Vec<f64>,
}

impl Branch {
    /// Work `∫F dx` along the branch by the trapezoid in x, J; error O(T²).
    pub fn work_j(&self) -> f64 {
        let (x, f) = (self.deflection_m.windows(2), self.force_n.windows(2));
        x.zip(f).map(|(x, f)| (x[1] - x[0]) * (f[0] + f[1]) / 2.0).sum()
    }
}

/// Force against deflection, loading and unloading apart.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceDeflection {
    /// From time zero to dynamic crush; to the end where there is none.
    pub loading: Branch,
    /// From dynamic crush to the lowest velocity; empty where there is no dynamic crush.
    pub unloading: Branch,
}

/// The force-deflection curve of a motion, `F = -m·a` against x.
///
/// The turning point is the sample at or after the zero of velocity, so the loading branch may reach one interval past
/// it; the deflection there differs from C by less than `a·T²/2`. The unloading branch starts with that sample.
pub fn force_deflection(
    acceleration: &Signal<Acceleration>,
    displacement: &Signal<Displacement>,
    events: &CrashEvents,
    mass_kg: f64,
    time_zero_s: f64,
) -> Result<ForceDeflection, MetricsError> {
    same_grid(("the acceleration", acceleration), ("the displacement", displacement))?;
    let (a, x) = (acceleration.samples(), displacement.samples());
    let branch = |from: usize, to: usize| {
        let (to, from) = (to.min(a.len()), from.min(a.len()));
        let part = from..to.max(from);
        Branch { deflection_m: x[part.clone()].to_vec(), force_n: a[part].iter().map(|a| -mass_kg * a).collect() }
    };
    let zero = acceleration.index_at_or_after(time_zero_s);
    let Some(crush) = events.crush else {
        return Ok(ForceDeflection { loading: branch(zero, a.len()), unloading: Branch::default() });
    };
    let end = events.rebound.map_or(crush.index, |r| acceleration.index_at_or_after(time_zero_s + r.time_s));
    Ok(ForceDeflection { loading: branch(zero, crush.index + 1), unloading: branch(crush.index, end + 1) })
}

/// Kinetic energy given up, `(v0² - v²)/2`, J/kg, sample by sample.
pub fn specific_energy(velocity: &Signal<Velocity>, impact_speed_m_per_s: f64) -> Vec<f64> {
    let v0 = impact_speed_m_per_s;
    velocity.samples().iter().map(|v| (v0 - v) * (v0 + v) / 2.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crash_events;

    #[test]
    fn a_constant_force_gives_back_what_the_rebound_has() {
        // a = -2, v = 2 - 2t, x = 2t - t²: C = 1 m at 1 s, then back.
        let t = |k: usize| k as f64 * 0.25;
        let a = Signal::new(0.0, 0.25, vec![-2.0; 9]).unwrap();
        let v = Signal::new(0.0, 0.25, (0..9).map(|k| 2.0 - 2.0 * t(k)).collect()).unwrap();
        let x = Signal::new(0.0, 0.25, (0..9).map(|k| 2.0 * t(k) - t(k) * t(k)).collect()).unwrap();
        let events = crash_events(&v, &x, 0.0).unwrap();
        let curve = force_deflection(&a, &x, &events, 10.0, 0.0).unwrap();
        assert_eq!((curve.loading.work_j(), curve.unloading.work_j()), (20.0, -20.0));
        assert_eq!(specific_energy(&v, 2.0)[4], 2.0);
    }
}
