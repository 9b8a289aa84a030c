//! Mean force by segment of crush of a test and of a simulation, and their ratio with its interval.

use crumple_signal::{HALF_OF_90_PERCENT, Sampled};
use serde::Serialize;

/// Length of a segment, m.
pub const SEGMENT_M: f64 = 0.1;
/// Two tests of equal cars differ too: a ratio within this share of 1 is none. It is assumed, and the sentences say so.
pub const REPEAT_SCATTER: f64 = 0.05;
/// Standard deviation of the sum of load cells, as a share: an assumption, that of an accelerometer of ±1 %.
pub const GAIN_OF_WALL: f64 = 0.006;
/// Half of the window through which a velocity is smoothed to see its ring, s: the window is a period of 80 Hz. Sills
/// ring above that; the pulse itself is a parabola in it.
const HALF_WINDOW_S: f64 = 6e-3;
/// A mean force with a larger standard deviation than this share of it has no ratio.
const UNKNOWN: f64 = 0.3;

/// How well a run knows its force over crush. Of a simulation all is zero.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Accuracy {
    /// Standard deviation of the accelerometer's gain, as a share of all forces by deceleration.
    pub gain: f64,
    /// Standard deviation of the place of the whole curve: contact and zero level, m.
    pub shift_m: f64,
    /// Standard deviation of the velocity within a segment, by noise and ring, m/s.
    pub velocity_m_per_s: f64,
    /// That of the force on the wall, as a share.
    pub gain_of_wall: f64,
}

impl Accuracy {
    /// From the intervals (90 %) of crush and change of velocity as half widths, and the ring of the velocity.
    ///
    /// The gain acts on the change of velocity alone. What of the interval of the crush the gain does not explain moves
    /// the whole curve: an error of contact times the impact speed, an error of the zero level.
    pub fn of_sensor(crush: (f64, f64), delta_v: (f64, f64), velocity_m_per_s: f64) -> Self {
        let [crush_sd, delta_v_sd] = [crush.1, delta_v.1].map(|half| half / HALF_OF_90_PERCENT);
        let gain = delta_v_sd / delta_v.0.abs().max(f64::MIN_POSITIVE);
        let shift_m = (crush_sd.powi(2) - (gain * crush.0).powi(2)).max(0.0).sqrt();
        Self { gain, shift_m, velocity_m_per_s, gain_of_wall: GAIN_OF_WALL }
    }
}

/// The mean force over a segment, N, and its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanForce {
    /// The mean.
    pub mean_n: f64,
    /// Its standard deviation.
    pub deviation_n: f64,
}

/// Ends of the segments up to a crush, m: whole ones of [`SEGMENT_M`].
pub fn edges(crush_m: f64) -> Vec<f64> {
    (0..=(crush_m / SEGMENT_M).floor() as usize).map(|k| k as f64 * SEGMENT_M).collect()
}

/// Time after contact at which a displacement first reaches `x`; linear between samples.
fn crossing(displacement: &Sampled, x: f64) -> Option<f64> {
    let start = displacement.index_at_or_after(0.0);
    let samples = displacement.samples();
    let k = (start..samples.len()).find(|k| samples[*k] >= x)?;
    if k == 0 || x <= 0.0 {
        return Some(displacement.time_s(k).min(0.0).max(displacement.t0_s()));
    }
    let part = (x - samples[k - 1]) / (samples[k] - samples[k - 1]);
    Some(displacement.time_s(k - 1) + part * displacement.dt_s())
}

/// Mean of mass times deceleration over each segment: `m (v1² - v2²) / (2 (x2 - x1))`, from the velocity alone.
///
/// Exact for a velocity that is. Its error σ moves the mean by `m v σ √2 / (x2 - x1)`. Empty where the displacement
/// does not reach the last edge.
pub fn by_deceleration(
    mass_kg: f64,
    displacement: &Sampled,
    velocity: &Sampled,
    edges: &[f64],
    accuracy: Accuracy,
) -> Vec<MeanForce> {
    let speeds: Option<Vec<f64>> = edges.iter().map(|x| velocity.at(crossing(displacement, *x)?)).collect();
    let speeds = speeds.unwrap_or_default();
    let segments = || speeds.windows(2).zip(edges.windows(2)).map(|(v, x)| (v, x[1] - x[0]));
    let means = segments().map(|(v, length)| mass_kg * (v[0].powi(2) - v[1].powi(2)) / (2.0 * length)).collect();
    let rings: Vec<f64> = segments()
        .map(|(v, length)| {
            let speed = (0.5 * (v[0].powi(2) + v[1].powi(2))).sqrt();
            mass_kg * speed * accuracy.velocity_m_per_s * std::f64::consts::SQRT_2 / length
        })
        .collect();
    with_deviations(means, edges, accuracy.gain, accuracy.shift_m, |k| rings[k])
}

/// Mean of the force on the wall over each segment of a travel: the integral of force over travel.
pub fn by_wall(force: &Sampled, travel: &Sampled, edges: &[f64], accuracy: Accuracy) -> Vec<MeanForce> {
    let mean = |ends: &[f64]| {
        let [from_s, to_s] = [crossing(travel, ends[0])?, crossing(travel, ends[1])?];
        let inner = travel.times_s().filter(|t| *t > from_s && *t < to_s);
        let times: Vec<f64> = std::iter::once(from_s).chain(inner).chain(std::iter::once(to_s)).collect();
        // The last sample of the one may lie behind that of the other.
        let points: Option<Vec<[f64; 2]>> = times.iter().map(|t| Some([travel.at(*t)?, force.at(*t)?])).collect();
        let work: f64 = points?.windows(2).map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0])).sum();
        Some(work / (ends[1] - ends[0]))
    };
    let means: Option<Vec<f64>> = edges.windows(2).map(mean).collect();
    with_deviations(means.unwrap_or_default(), edges, accuracy.gain_of_wall, accuracy.shift_m, |_| 0.0)
}

/// A shift of the curve moves the mean of a segment by the slope of the force there.
fn with_deviations(
    means: Vec<f64>,
    edges: &[f64],
    gain: f64,
    shift_m: f64,
    ring_n: impl Fn(usize) -> f64,
) -> Vec<MeanForce> {
    let at = |k: usize| 0.5 * (edges[k] + edges[k + 1]);
    let deviation = |k: usize| {
        let (before, x) = k.checked_sub(1).map_or((0.0, 0.0), |k| (means[k], at(k)));
        let next = if k + 1 < means.len() { k + 1 } else { k };
        let slope = (means[next] - before) / (at(next) - x);
        [gain * means[k], slope * shift_m, ring_n(k)].iter().map(|part| part.powi(2)).sum::<f64>().sqrt()
    };
    (0..means.len()).map(|k| MeanForce { mean_n: means[k], deviation_n: deviation(k) }).collect()
}

/// A segment of crush in test and simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Segment {
    /// Where it begins, m of crush.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
    /// Mean force of the test, N.
    pub test_n: f64,
    /// Mean force of the simulation, N.
    pub simulation_n: f64,
    /// Simulation over test; `None`: the test's force is not known there.
    pub ratio: Option<f64>,
    /// Lower end of its interval, 90 %; `None`: the test's force is not known there, or both forces are slight.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Segment {
    /// Whether the interval excludes 1 by more than the repeat scatter.
    pub fn is_named(&self) -> bool {
        self.low.is_some_and(|low| low > 1.0 + REPEAT_SCATTER)
            || self.high.is_some_and(|high| high < 1.0 - REPEAT_SCATTER)
    }
}

/// The ratio of the simulation's forces to the test's, by segment.
///
/// Two equal tests differ by [`REPEAT_SCATTER`] of the test's mean force over all segments. Where neither force is
/// above that, the ratio has no interval: 4 kN against 9 kN of a mean of 243 kN names no place.
pub fn ratios(edges: &[f64], test: &[MeanForce], simulation: &[MeanForce]) -> Vec<Segment> {
    let sum_n: f64 = test.iter().map(|force| force.mean_n).sum();
    let slight_n = REPEAT_SCATTER * sum_n / test.len().max(1) as f64;
    let segment = |(ends, (a, b)): (&[f64], (&MeanForce, &MeanForce))| {
        let [of_a, of_b] = [a, b].map(|force| force.deviation_n / force.mean_n.abs().max(f64::MIN_POSITIVE));
        let is_known = a.mean_n > 0.0 && of_a < UNKNOWN;
        let ratio = is_known.then(|| b.mean_n / a.mean_n);
        let known = ratio.filter(|_| a.mean_n.max(b.mean_n) > slight_n);
        let half = known.map(|ratio| HALF_OF_90_PERCENT * ratio.abs() * of_a.hypot(of_b));
        let end = |sign: f64| ratio.zip(half).map(|(ratio, half)| ratio + sign * half);
        let (low, high) = (end(-1.0), end(1.0));
        let (from_m, to_m) = (ends[0], ends[1]);
        Segment { from_m, to_m, test_n: a.mean_n, simulation_n: b.mean_n, ratio, low, high }
    };
    edges.windows(2).zip(test.iter().zip(simulation)).map(segment).collect()
}

/// Root mean square of what a velocity has beside a parabola through 12 ms around each sample, up to `to_s`: its ring
/// and noise, m/s. (Savitzky & Golay, Anal. Chem. 36, 1964: the parabola's value in the middle.)
pub fn ring(velocity: &Sampled, to_s: f64) -> f64 {
    let m = (HALF_WINDOW_S / velocity.dt_s()).round() as usize;
    if m < 2 {
        return 0.0;
    }
    let [from, to] = [0.0, to_s].map(|t| velocity.index_at_or_after(t));
    let whole = m as f64;
    let scale = (2.0 * whole - 1.0) * (2.0 * whole + 1.0) * (2.0 * whole + 3.0) / 3.0;
    let weight = |k: f64| (3.0 * whole * whole + 3.0 * whole - 1.0 - 5.0 * k * k) / scale;
    let weights: Vec<f64> = (0..=2 * m).map(|k| weight(k as f64 - whole)).collect();
    let windows = velocity.samples().windows(weights.len()).enumerate();
    let inside = windows.filter(|(first, _)| (from..to).contains(&(first + m))).map(|(_, window)| {
        let smooth: f64 = weights.iter().zip(window).map(|(weight, v)| weight * v).sum();
        (window[m] - smooth).powi(2)
    });
    let (count, sum) = inside.fold((0_u32, 0.0), |(count, sum), square| (count + 1, sum + square));
    if count == 0 { 0.0 } else { (sum / f64::from(count)).sqrt() }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    pub const MASS_KG: f64 = 1500.0;
    pub const SPEED_M_PER_S: f64 = 15.65;

    /// Displacement, velocity and force at 10 kHz of one mass on a curve through these points (m, N); plastic: it ends
    /// where it stops. By the exact work, with steps of 1 µs.
    pub fn crash(law: &[[f64; 2]]) -> [Sampled; 3] {
        let force = |x: f64| {
            let k = law[1..law.len() - 1].iter().filter(|point| point[0] <= x).count();
            let [[x1, f1], [x2, f2]] = [law[k], law[k + 1]];
            f1 + (x - x1) / (x2 - x1) * (f2 - f1)
        };
        let (mut x, mut v, mut columns) = (0.0, SPEED_M_PER_S, [vec![], vec![], vec![]]);
        for step in 0.. {
            if step % 100 == 0 {
                for (column, value) in columns.iter_mut().zip([x, v, force(x)]) {
                    column.push(value);
                }
            }
            if v <= 0.0 && step % 100 == 0 {
                break;
            }
            let middle = v - 0.5e-6 * force(x) / MASS_KG;
            x += 1e-6 * middle;
            v = middle - 0.5e-6 * force(x) / MASS_KG;
        }
        columns.map(|samples| Sampled::new(0.0, 1e-4, samples).unwrap())
    }

    pub const LAW: [[f64; 2]; 5] = [[0.0, 0.0], [0.2, 2.0e5], [0.4, 2.2e5], [0.6, 3.4e5], [1.0, 5.0e5]];
    pub const STIFF: [[f64; 2]; 5] = [[0.0, 0.0], [0.2, 2.6e5], [0.4, 2.86e5], [0.6, 3.4e5], [1.0, 5.0e5]];

    /// The mean of a curve over a segment, by the trapezoids of its points.
    fn exact(law: &[[f64; 2]], from: f64, to: f64) -> f64 {
        let force = |x: f64| {
            let k = law.iter().rposition(|point| point[0] <= x).unwrap().min(law.len() - 2);
            law[k][1] + (x - law[k][0]) / (law[k + 1][0] - law[k][0]) * (law[k + 1][1] - law[k][1])
        };
        (0..1000).map(|k| force(from + (to - from) * (f64::from(k) + 0.5) / 1000.0)).sum::<f64>() / 1000.0
    }

    #[test]
    fn the_ratio_of_two_known_curves_is_theirs_by_velocity_and_by_force() {
        let [a, b] = [crash(&LAW), crash(&STIFF)];
        let edges = edges(b[0].samples().last().copied().unwrap());
        let exactly = Accuracy::default();
        let by_velocity = [&a, &b].map(|run| by_deceleration(MASS_KG, &run[0], &run[1], &edges, exactly));
        let by_force = [&a, &b].map(|run| by_wall(&run[2], &run[0], &edges, exactly));
        assert!(edges.len() > 6, "{edges:?}");
        for [test, simulation] in [by_velocity, by_force] {
            for segment in ratios(&edges, &test, &simulation) {
                let truth = exact(&STIFF, segment.from_m, segment.to_m) / exact(&LAW, segment.from_m, segment.to_m);
                assert!((segment.ratio.unwrap() / truth - 1.0).abs() < 0.002, "{segment:?} {truth}");
                assert_eq!(segment.is_named(), truth > 1.05, "{segment:?}");
            }
        }
    }

    #[test]
    fn a_ring_is_seen_and_makes_the_first_segment_unknown() {
        let [x, v, _] = crash(&LAW);
        assert!(ring(&v, 0.06) < 0.01, "{}", ring(&v, 0.06));
        let rings = v.times_s().zip(v.samples()).map(|(t, v)| v + 0.03 * (754.0 * t).sin()).collect();
        let ringing = Sampled::new(0.0, 1e-4, rings).unwrap();
        // 0.03/√2, of which a parabola over 1.4 periods takes a part.
        assert!((0.012..0.03).contains(&ring(&ringing, 0.06)), "{}", ring(&ringing, 0.06));
        let edges = edges(0.5);
        let accuracy = Accuracy { velocity_m_per_s: 0.2, ..Accuracy::default() };
        let test = by_deceleration(MASS_KG, &x, &v, &edges, accuracy);
        let segments = ratios(&edges, &test, &by_deceleration(MASS_KG, &x, &v, &edges, Accuracy::default()));
        // 1500 · 15.4 · 0.2 · √2 / 0.1 = 65 kN of 50 kN.
        assert!(segments[0].ratio.is_none() && segments[3].ratio.is_some(), "{segments:?}");
        assert!(segments.iter().all(|segment| !segment.is_named()));
    }

    #[test]
    fn forces_that_two_equal_tests_may_differ_by_name_no_place() {
        let force = |mean_n| MeanForce { mean_n, deviation_n: 1.0 };
        let segments =
            |first_n: f64| ratios(&edges(0.35), &[4e3, 3e5, 4e5].map(force), &[first_n, 3e5, 4e5].map(force));
        // 5 % of the mean of 235 kN.
        assert!(segments(9e3).iter().all(|segment| segment.ratio.is_some() && !segment.is_named()));
        assert!(segments(9e3)[0].low.is_none() && segments(2e4)[0].is_named());
    }

    #[test]
    fn what_the_gain_does_not_explain_of_the_crush_is_a_shift() {
        let accuracy = Accuracy::of_sensor((0.75, 0.0095), (17.7, 0.175), 0.01);
        assert!((accuracy.gain - 0.0060).abs() < 1e-4 && (accuracy.shift_m - 0.00362).abs() < 1e-4, "{accuracy:?}");
        // A segment of a force that rises by 1 kN/mm is off by 3.6 kN.
        let [x, v, _] = crash(&[[0.0, 0.0], [1.0, 1e6]]);
        let mean = by_deceleration(MASS_KG, &x, &v, &edges(0.5), Accuracy { shift_m: 0.0036, ..Accuracy::default() });
        assert!((mean[2].deviation_n - 3600.0).abs() < 40.0, "{mean:?}");
    }
}
