//! What the velocities of two vehicles say of their collision: common velocity, mutual crush, balance of momentum.

use crumple_signal::{Signal, Velocity};

/// What the velocities of two vehicles say of their collision along the axis of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoVehicleImpact {
    /// The second vehicle heads the same way as the first (a hit from behind), else towards it.
    pub same_heading: bool,
    /// Relative velocity at contact, m/s; positive: they approach.
    pub closing_speed_m_per_s: f64,
    /// The moment of common velocity; `None`: they still approach at the end of the record.
    pub common: Option<MutualCrush>,
    /// Largest speed of separation over the closing speed; 0 where they stay together.
    pub restitution: Option<f64>,
    /// Changes of velocity of both along the axis of the first, up to the common velocity or the end, m/s.
    pub changes_m_per_s: [f64; 2],
}

/// The moment at which two vehicles move alike, and are crushed most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MutualCrush {
    /// s from contact.
    pub time_s: f64,
    /// Velocity of the first vehicle then, m/s.
    pub velocity_m_per_s: f64,
    /// Mutual crush: how much closer their sensors have come, m.
    pub relative_crush_m: f64,
}

impl TwoVehicleImpact {
    /// Momentum that the changes of velocity leave over, over that which the first vehicle loses:
    /// `(m1·dv1 + m2·dv2)/(m1·|dv1|)`. 0 if no other force acts; `None` where the first does not change its velocity.
    pub fn momentum_gap(&self, masses_kg: [f64; 2]) -> Option<f64> {
        let [first, second] = [0, 1].map(|k| masses_kg[k] * self.changes_m_per_s[k]);
        Some((first + second) / first.abs()).filter(|gap| gap.is_finite())
    }
}

/// Velocity that two bodies have together by their momenta, m/s.
pub fn common_velocity(masses_kg: [f64; 2], velocities_m_per_s: [f64; 2]) -> f64 {
    (masses_kg[0] * velocities_m_per_s[0] + masses_kg[1] * velocities_m_per_s[1]) / (masses_kg[0] + masses_kg[1])
}

/// The collision of two vehicles, each with the velocity along its own forward axis on one time grid.
///
/// The forces on both are opposite, so the second vehicle heads towards the first if both lose speed, and the same way
/// if one gains what the other loses. The relative velocity `v1 - s·v2` (s = 1 for the same heading, -1 else) is zero
/// at the common velocity, interpolated linearly; its integral up to there by the trapezoid is the mutual crush. Where
/// both head the same way and the second is faster, it runs into the first: the sign of the relative velocity is then
/// the other one. `None` where the grids differ, a vehicle does not change its velocity, or they do not approach at
/// contact, t = 0.
pub fn collision(first: &Signal<Velocity>, second: &Signal<Velocity>) -> Option<TwoVehicleImpact> {
    let dt = first.dt_s();
    let shift = (second.t0_s() - first.t0_s()) / dt;
    if (second.dt_s() / dt - 1.0).abs() > 1e-9 || (shift - shift.round()).abs() > 1e-3 {
        return None;
    }
    let from = [first.index_at_or_after(0.0), second.index_at_or_after(0.0)];
    let v = [first.samples().get(from[0]..)?, second.samples().get(from[1]..)?];
    let n = v[0].len().min(v[1].len());
    if n < 2 {
        return None;
    }
    // By the changes up to the largest of the first: later both roll on.
    let turn = (1..n).fold(0, |k, j| if (v[0][j] - v[0][0]).abs() > (v[0][k] - v[0][0]).abs() { j } else { k });
    let changes = v.map(|v| v[turn] - v[0]);
    if changes.contains(&0.0) {
        return None;
    }
    let same_heading = changes[0].signum() != changes[1].signum();
    let sign = if same_heading { 1.0 } else { -1.0 };
    let is_run_into = same_heading && v[0][0] < v[1][0];
    let side = if is_run_into { -1.0 } else { 1.0 };
    let relative = |k: usize| side * (v[0][k] - sign * v[1][k]);
    let closing_speed_m_per_s = relative(0);
    if closing_speed_m_per_s <= 0.0 {
        return None;
    }
    let mut crush = 0.0;
    let mut common = None;
    let mut slowest = closing_speed_m_per_s;
    for k in 1..n {
        let (before, now) = (relative(k - 1), relative(k));
        slowest = slowest.min(now);
        if common.is_some() {
            continue;
        }
        if now > 0.0 {
            crush += dt * (before + now) / 2.0;
        } else {
            let part = before / (before - now);
            let time_s = first.time_s(from[0] + k - 1) + part * dt;
            let velocity_m_per_s = v[0][k - 1] + part * (v[0][k] - v[0][k - 1]);
            let relative_crush_m = crush + part * dt * before / 2.0;
            common = Some((k, MutualCrush { time_s, velocity_m_per_s, relative_crush_m }));
        }
    }
    let last = common.map_or(n - 1, |(k, _)| k);
    Some(TwoVehicleImpact {
        same_heading,
        closing_speed_m_per_s,
        common: common.map(|(_, common)| common),
        restitution: common.map(|_| (-slowest / closing_speed_m_per_s).max(0.0)),
        changes_m_per_s: [v[0][last] - v[0][0], sign * (v[1][last] - v[1][0])],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two masses on a spring between them: `x1 - x2 = w/ω·sin ωt`, a common velocity at a quarter of a period.
    fn collide(masses: [f64; 2], speeds: [f64; 2], same_heading: bool) -> (TwoVehicleImpact, [f64; 2]) {
        let sign = if same_heading { 1.0 } else { -1.0 };
        let (closing, omega) = (speeds[0] - sign * speeds[1], 20.0);
        let reduced = masses[0] * masses[1] / (masses[0] + masses[1]);
        let loss = |t: f64| reduced * closing * (1.0 - (omega * t.clamp(0.0, std::f64::consts::PI / omega)).cos());
        let wave = |v: &dyn Fn(f64) -> f64| {
            Signal::new(-0.01, 1e-4, (0..2500).map(|k| v(f64::from(k) * 1e-4 - 0.01)).collect()).unwrap()
        };
        let first = wave(&|t| speeds[0] - loss(t) / masses[0]);
        let second = wave(&|t| speeds[1] + sign * loss(t) / masses[1]);
        let quarter = std::f64::consts::PI / (2.0 * omega);
        (collision(&first, &second).unwrap(), [quarter, closing / omega])
    }

    #[test]
    fn common_velocity_crush_and_momentum_are_those_of_two_masses_on_a_spring() {
        for (speeds, same_heading) in
            [([15.0, 0.0], false), ([15.0, 0.0], true), ([15.0, 12.0], false), ([15.0, 5.0], true)]
        {
            let masses = [1200.0, 1600.0];
            let (found, [time_s, crush_m]) = collide(masses, speeds, same_heading);
            let sign = if same_heading { 1.0 } else { -1.0 };
            let common = found.common.unwrap();
            assert_eq!(found.same_heading, same_heading);
            // Linear interpolation at 10 kHz, and the trapezoid.
            assert!((common.time_s - time_s).abs() < 1e-7 && (common.relative_crush_m - crush_m).abs() < 1e-6);
            let expected = common_velocity(masses, [speeds[0], sign * speeds[1]]);
            assert!((common.velocity_m_per_s - expected).abs() < 1e-6, "{common:?} {expected}");
            assert!(found.momentum_gap(masses).unwrap().abs() < 1e-9);
            assert!((found.restitution.unwrap() - 1.0).abs() < 1e-5);
            // A wrong mass shows.
            assert!((found.momentum_gap([1200.0, 800.0]).unwrap() + 0.5).abs() < 1e-9);
        }
    }

    #[test]
    fn vehicles_that_do_not_meet_have_no_collision() {
        let still = Signal::new(0.0, 1e-3, vec![10.0; 50]).unwrap();
        let braked = Signal::new(0.0, 1e-3, (0..50).map(|k| 10.0 - 0.1 * f64::from(k)).collect()).unwrap();
        assert_eq!(collision(&still, &braked), None);
        let other_grid = Signal::new(0.0, 2e-3, vec![1.0; 50]).unwrap();
        assert_eq!(collision(&braked, &other_grid), None);
        // Still approaching at the end.
        let found = collision(&braked, &braked).unwrap();
        assert_eq!((found.common, found.restitution), (None, None));
    }
}
