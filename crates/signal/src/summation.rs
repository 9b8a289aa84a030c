//! Sums of samples: acceleration to velocity and displacement, and back from the velocity change that a recorder keeps.

use serde::{Deserialize, Serialize};

use crate::{About, Notes, STANDARD_GRAVITY_M_PER_S2, Sampled, SignalError, Weight, remarks};

/// How samples are summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum IntegrationRule {
    /// Exact for an acceleration that is linear between samples; error O(T²).
    #[default]
    Trapezoid,
    /// As in the single-mass paper: a sample holds until the next; about v0·T/2 too much displacement (0.7 mm at 10
    /// kHz and 14 m/s).
    ForwardEuler,
    /// Exact for an acceleration that is a parabola through three samples; error O(T⁴) where it is smooth, no better
    /// than the trapezoid at a jump.
    Simpson,
}

impl IntegrationRule {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::Trapezoid, Self::ForwardEuler, Self::Simpson];

    /// The name used in artifacts and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Trapezoid => "trapezoid",
            Self::ForwardEuler => "forward-euler",
            Self::Simpson => "simpson",
        }
    }
}

/// Integrates an acceleration to velocity and displacement, given both at the first sample.
///
/// Trapezoid: `v[k] = v[k-1] + T·(a[k-1] + a[k])/2`, `x[k] = x[k-1] + T·(v[k-1] + v[k])/2`; v errs by up to
/// `t·T²·max|a''|/12`, and by T/2 of the height of every jump. Forward Euler: `v[k] = v[k-1] + T·a[k-1]`, `x[k] =
/// x[k-1] + T·v[k-1]`; errs by `T·(a_end - a_0)/2` in v and about `T·(v0 - v_end)/2` in x. Simpson: over two intervals
/// `v[k] = v[k-2] + T·(a[k-2] + 4·a[k-1] + a[k])/3`, in the middle
/// `v[k-1] = v[k-2] + T·(5·a[k-2] + 8·a[k-1] - a[k])/12` (the same parabola), a last odd interval by the parabola of
/// the last three samples, two samples by the trapezoid; v errs by up to `t·T⁴·max|a''''|/180` at every second sample
/// and T⁴·max|a'''|/24 between. A wrong zero level δ grows to δ·t and δ·t²/2 with any of them.
///
/// `a` in m/s², `dt_s` the interval T in s; the result is the velocity in m/s and the displacement in m, each as long
/// as `a`, beginning with `v_first` and `x_first`. Empty for an empty `a`. Forward Euler is there because published
/// models were fitted with it.
pub fn integrate_twice(
    a: &[f64],
    dt_s: f64,
    rule: IntegrationRule,
    v_first: f64,
    x_first: f64,
) -> (Vec<f64>, Vec<f64>) {
    let (mut velocity, mut displacement) = (Vec::new(), Vec::new());
    integrate_twice_into(a, dt_s, rule, [v_first, x_first], (&mut velocity, &mut displacement), |_| ());
    (velocity, displacement)
}

/// Samples between two reports of progress.
const BLOCK: usize = 1 << 16;

/// [`integrate_twice`] into buffers whose memory is used again; `report` is told how many samples are done.
pub fn integrate_twice_into(
    a: &[f64],
    dt_s: f64,
    rule: IntegrationRule,
    [v_first, x_first]: [f64; 2],
    (velocity, displacement): (&mut Vec<f64>, &mut Vec<f64>),
    report: impl FnMut(u64),
) {
    // Memory fresh from the system is zero already; what is there from before is written over.
    for output in [&mut *velocity, &mut *displacement] {
        if output.capacity() < a.len() {
            *output = vec![0.0; a.len()];
        } else {
            output.resize(a.len(), 0.0);
        }
    }
    let outputs = (velocity.as_chunks_mut::<1>().0, displacement.as_chunks_mut::<1>().0);
    sum_twice(a.as_chunks::<1>().0, dt_s, rule, [[v_first], [x_first]], outputs, report);
}

/// [`integrate_twice_into`] of N accelerations side by side, into slices as long as `a`.
#[inline(always)]
pub(crate) fn sum_twice<const N: usize>(
    a: &[[f64; N]],
    dt_s: f64,
    rule: IntegrationRule,
    [v_first, x_first]: [[f64; N]; 2],
    (velocity, displacement): (&mut [[f64; N]], &mut [[f64; N]]),
    mut report: impl FnMut(u64),
) {
    let (Some((v, velocity)), Some((x, displacement))) = (velocity.split_first_mut(), displacement.split_first_mut())
    else {
        return;
    };
    (*v, *x) = (v_first, x_first);
    let mut sums = Sums { dt_s, v: v_first, x: x_first, v_middle: v_first };
    for (block, (v, x)) in velocity.chunks_mut(BLOCK).zip(displacement.chunks_mut(BLOCK)).enumerate() {
        let first = 1 + block * BLOCK;
        match rule {
            IntegrationRule::Trapezoid => sums.trapezoid(&a[first - 1..first + v.len()], v, x),
            IntegrationRule::ForwardEuler => sums.forward_euler(&a[first - 1..first + v.len()], v, x),
            // A block has an even number of samples, so that pairs of intervals do not cross from one to the next.
            IntegrationRule::Simpson => sums.simpson(a, first, v, x),
        }
        report(v.len() as u64);
    }
}

/// Velocity and displacement at the last sample done: what one block hands to the next, so that blocks give the bits of
/// a single sum.
struct Sums<const N: usize> {
    dt_s: f64,
    v: [f64; N],
    x: [f64; N],
    /// Velocity one sample before; kept by Simpson's rule alone.
    v_middle: [f64; N],
}

impl<const N: usize> Sums<N> {
    /// `a` begins one sample before the outputs. Both sums in one pass: their additions wait for nothing but the sample
    /// before.
    #[inline(always)]
    fn trapezoid(&mut self, a: &[[f64; N]], v_out: &mut [[f64; N]], x_out: &mut [[f64; N]]) {
        // Halving is exact, so T/2 times a sum is T times a sum, halved.
        let half_s = self.dt_s / 2.0;
        let (mut v, mut x) = (self.v, self.x);
        for (pair, (v_out, x_out)) in a.windows(2).zip(v_out.iter_mut().zip(x_out)) {
            for lane in 0..N {
                let next = v[lane] + half_s * (pair[0][lane] + pair[1][lane]);
                x[lane] += half_s * (v[lane] + next);
                v[lane] = next;
            }
            (*v_out, *x_out) = (v, x);
        }
        (self.v, self.x) = (v, x);
    }

    /// `a` begins one sample before the outputs. The displacement takes the velocity before the step, not after it. Two
    /// short loops in turn: packed into one pair of lanes, each sum would wait for the other.
    #[inline(always)]
    fn forward_euler(&mut self, a: &[[f64; N]], v_out: &mut [[f64; N]], x_out: &mut [[f64; N]]) {
        const SAMPLES: usize = 16;
        let dt_s = self.dt_s;
        let (mut v, mut x) = (self.v, self.x);
        for (a, (v_out, x_out)) in a.chunks(SAMPLES).zip(v_out.chunks_mut(SAMPLES).zip(x_out.chunks_mut(SAMPLES))) {
            let first = v;
            for (a, v_out) in a.iter().zip(&mut *v_out) {
                for lane in 0..N {
                    v[lane] += dt_s * a[lane];
                }
                *v_out = v;
            }
            for (v, x_out) in std::iter::once(&first).chain(&*v_out).zip(x_out) {
                for lane in 0..N {
                    x[lane] += dt_s * v[lane];
                }
                *x_out = x;
            }
        }
        (self.v, self.x) = (v, x);
    }

    /// `a` is the whole record, `first` the index of the first output.
    #[inline(always)]
    fn simpson(&mut self, a: &[[f64; N]], first: usize, v_out: &mut [[f64; N]], x_out: &mut [[f64; N]]) {
        let twelfth_s = self.dt_s / 12.0;
        let third_s = self.dt_s / 3.0;
        for lane in 0..N {
            let (mut v, mut x) = (self.v[lane], self.x[lane]);
            let pairs = a[first - 1..].windows(3).step_by(2);
            for (a, (v_out, x_out)) in pairs.zip(v_out.chunks_exact_mut(2).zip(x_out.chunks_exact_mut(2))) {
                let [a0, a1, a2] = [a[0][lane], a[1][lane], a[2][lane]];
                let middle = v + twelfth_s * (5.0 * a0 + 8.0 * a1 - a2);
                let end = v + third_s * (a0 + 4.0 * a1 + a2);
                x_out[0][lane] = x + twelfth_s * (5.0 * v + 8.0 * middle - end);
                x += third_s * (v + 4.0 * middle + end);
                x_out[1][lane] = x;
                (v_out[0][lane], v_out[1][lane]) = (middle, end);
                self.v_middle[lane] = middle;
                v = end;
            }
            (self.v[lane], self.x[lane]) = (v, x);
            // A single interval is left at the end of a record with an even number of samples.
            let left = v_out.chunks_exact_mut(2).into_remainder().first_mut().zip(x_out.last_mut());
            let Some((v_last, x_last)) = left else { continue };
            match a {
                [.., a0, a1, a2] => {
                    v_last[lane] = v + twelfth_s * (-a0[lane] + 8.0 * a1[lane] + 5.0 * a2[lane]);
                    x_last[lane] = x + twelfth_s * (-self.v_middle[lane] + 8.0 * v + 5.0 * v_last[lane]);
                }
                _ => {
                    v_last[lane] = v + self.dt_s / 2.0 * a.iter().map(|a| a[lane]).sum::<f64>();
                    x_last[lane] = x + self.dt_s / 2.0 * (v + v_last[lane]);
                }
            }
        }
    }
}

/// Acceleration from the change of velocity that an event data recorder keeps, on the same grid.
///
/// Central differences `a[k] = (v[k+1] - v[k-1]) / (2 dt)`, one-sided ones at both ends. Exact for a velocity that is a
/// parabola, but for the ends. The trapezoid of the result is the velocity smoothed by (1, 2, 1)/4, and the velocity
/// itself at both ends: the change over the whole event is kept. A peak that is shorter than some samples is lost.
/// Fewer than two samples give zeros. Gain of the difference against the true derivative:
/// `sin(2π·f·dt)/(2π·f·dt)`, -3 dB at 0.22 of the sampling rate and zero at half of it.
pub fn acceleration_of_velocity_change(change: &Sampled) -> Result<Sampled, SignalError> {
    let (v, dt_s) = (change.samples(), change.dt_s());
    let last = v.len().saturating_sub(1);
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        if to > from { (v[to] - v[from]) / ((to - from) as f64 * dt_s) } else { 0.0 }
    };
    Sampled::new(change.t0_s(), dt_s, (0..v.len()).map(slope).collect())
}

/// Units in which recorders print a velocity: km/h, mph, m/s.
const PRINTED_UNITS_M_PER_S: [f64; 3] = [1.0 / 3.6, 0.44704, 1.0];

/// The step in which changes of velocity are printed, m/s: the largest of 1, 0.5, 0.1, 0.05, 0.01 and 0.001 km/h, mph
/// or m/s of which all are multiples. `None` where there is none, and where all are zero.
pub fn printed_step_m_per_s(values: &[f64]) -> Option<f64> {
    // A unit's factor is rounded once, and so is its multiple.
    let is_multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
    let moves = values.iter().any(|value| *value != 0.0);
    [1.0, 0.5, 0.1, 0.05, 0.01, 0.001]
        .into_iter()
        .flat_map(|part| PRINTED_UNITS_M_PER_S.map(|unit| part * unit))
        .filter(|step| moves && values.iter().all(|value| is_multiple(*value, *step)))
        .reduce(f64::max)
}

/// The smallest difference between two values that is no rounding; `None` for a constant.
fn smallest_difference(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    values.sort_unstable_by(f64::total_cmp);
    let range = values.last()? - values.first()?;
    // 1e-9 of the range: products with a unit differ in the last bits only.
    let differences = values.windows(2).map(|pair| pair[1] - pair[0]);
    differences.filter(|step| *step > 1e-9 * range).reduce(f64::min)
}

/// What an acceleration derived from a change of velocity can be used for, as a warning among `notes`.
///
/// A printed step s leaves each velocity wrong by up to s/2, so a central difference by up to `s/(2·dt)`: 1.4 g for
/// whole km/h every 10 ms. `of` is the id of the channel it was derived from.
pub fn derivative_note(change: &Sampled, of: &str, notes: &mut Notes) {
    let dt_s = change.dt_s();
    let values = change.samples();
    let is_constant = values.windows(2).all(|pair| pair[0] == pair[1]);
    let step = printed_step_m_per_s(values).filter(|_| !is_constant).or_else(|| smallest_difference(values));
    notes.push(DerivedFromChange {
        channel: of.to_owned(),
        over_s: 2.0 * dt_s,
        step_m_per_s: step,
        rounding_g: step.map(|step| step / (2.0 * dt_s) / STANDARD_GRAVITY_M_PER_S2),
        rate_hz: change.rate_hz(),
        hidden_s: 4.0 * dt_s,
    });
}

remarks! {
    /// Remarks of accelerations that were derived.
    pub REMARKS;

    /// The acceleration was derived from the change of velocity that a recorder kept.
    CR217 DerivedFromChange {
        channel: String, over_s: f64, step_m_per_s: Option<f64>, rounding_g: Option<f64>, rate_hz: f64, hidden_s: f64
    }
    bears on (About::Pulse, Weight::Slight)
    decided "The pulse is a change of velocity. A printed step s leaves each difference wrong by up to s/(2 dt)."
    means "The change of velocity holds. Peaks and forces do not, nor what lasts shorter than four samples."
    remedy "use delta-v; for peaks an accelerometer record is needed"
    says {
        let step = step_m_per_s.zip(*rounding_g).map_or_else(String::new, |(step, rounding_g)| {
            format!(
                "; its values come in steps of {step:.3} m/s, so that a sample may be {rounding_g:.2} g wrong by \
                 rounding alone"
            )
        });
        format!(
            "derived from the velocity change of channel {channel} by central differences over {:.1} ms, not \
             measured{step}; {rate_hz:.0} samples a second, and the filter of the recorder is not known: no class is \
             applied, peaks, force and what happens within {:.0} ms cannot be taken from it",
            1e3 * over_s,
            1e3 * hidden_s
        )
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_on_a_ramp_worked_by_hand() {
        let a = [0.0, -2.0, -4.0];
        // Literals with exact binary values.
        assert_eq!(
            integrate_twice(&a, 0.5, IntegrationRule::Trapezoid, 4.0, 1.0),
            (vec![4.0, 3.5, 2.0], vec![1.0, 2.875, 4.25])
        );
        assert_eq!(
            integrate_twice(&a, 0.5, IntegrationRule::ForwardEuler, 4.0, 1.0),
            (vec![4.0, 4.0, 3.0], vec![1.0, 3.0, 5.0])
        );
    }

    #[test]
    fn simpson_is_exact_for_a_parabola_whatever_the_number_of_samples() {
        for n in [1, 2, 3, 4, 5, 8, 9, 200, 201] {
            let t: Vec<f64> = (0..n).map(|k| 5e-3 * f64::from(k)).collect();
            let a: Vec<f64> = t.iter().map(|t| 2.0 - 3.0 * t + t * t).collect();
            let (v, x) = integrate_twice(&a, 5e-3, IntegrationRule::Simpson, 5.0, 1.0);
            for (k, t) in t.iter().enumerate() {
                let exact_v = 5.0 + 2.0 * t - 1.5 * t * t + t * t * t / 3.0;
                let exact_x = 1.0 + 5.0 * t + t * t - 0.5 * t.powi(3) + t.powi(4) / 12.0;
                // The velocity is a cubic: the parabola through three of its samples errs by T^4/24 times its third
                // derivative (2) in the middle. Two samples make a trapezoid: T^3/12 times a second derivative of up to
                // 3.
                let limit = if n == 2 { 4e-8 } else { 1e-10 };
                assert!((v[k] - exact_v).abs() < limit, "{n} {k}: {} {exact_v}", v[k]);
                assert!((x[k] - exact_x).abs() < limit, "{n} {k}: {} {exact_x}", x[k]);
            }
        }
    }

    #[test]
    fn blocks_change_nothing() {
        let long = i32::try_from(2 * BLOCK + 2).unwrap();
        let a: Vec<f64> = (0..long).map(|k| -200.0 * (1e-3 * f64::from(k)).sin()).collect();
        for n in [BLOCK, BLOCK + 1, BLOCK + 2, BLOCK + 3, 2 * BLOCK + 2] {
            for rule in IntegrationRule::ALL {
                let mut done = 0;
                let (mut v, mut x) = (vec![7.0; 3], vec![9.0; 2 * n]);
                integrate_twice_into(&a[..n], 1e-4, rule, [3.0, 2.0], (&mut v, &mut x), |amount| done += amount);
                assert_eq!((done, v.len(), x.len(), v[0], x[0]), (n as u64 - 1, n, n, 3.0, 2.0));
                // The beginning is that of a shorter record,
                let (head_v, head_x) = integrate_twice(&a[..1001], 1e-4, rule, 3.0, 2.0);
                assert_eq!((&v[..1001], &x[..1001]), (&head_v[..], &head_x[..]));
                // and the end that of one that starts a little, by an even number of samples, before it.
                let from = (n - 7) & !1;
                let (tail_v, tail_x) = integrate_twice(&a[from..n], 1e-4, rule, v[from], x[from]);
                assert_eq!((&v[from..], &x[from..]), (&tail_v[..], &tail_x[..]), "{n} {rule:?}");
            }
        }
    }

    #[test]
    fn no_sample_gives_no_sample() {
        for rule in IntegrationRule::ALL {
            assert_eq!(integrate_twice(&[], 0.5, rule, 4.0, 1.0), (vec![], vec![]));
        }
    }

    #[test]
    fn the_name_is_the_one_in_a_pipeline_table() {
        for rule in IntegrationRule::ALL {
            assert_eq!(serde_json::to_value(rule).unwrap(), rule.name());
        }
    }

    fn sampled(samples: &[f64]) -> Sampled {
        Sampled::new(0.0, 0.5, samples.to_vec()).unwrap()
    }

    #[test]
    fn the_derivative_of_a_parabola_is_exact_inside() {
        // v = -t², a = -2 t; at the ends the slope half an interval inside.
        let a = acceleration_of_velocity_change(&sampled(&[0.0, -0.25, -1.0, -2.25, -4.0])).unwrap();
        assert_eq!(a.samples(), [-0.5, -1.0, -2.0, -3.0, -3.5]);
        assert_eq!(acceleration_of_velocity_change(&sampled(&[3.0])).unwrap().samples(), [0.0]);
        assert!(acceleration_of_velocity_change(&sampled(&[])).unwrap().is_empty());
    }

    #[test]
    fn its_trapezoid_is_the_smoothed_velocity_and_keeps_the_whole_change() {
        let v = [0.0, -1.0, -4.0, -6.0, -6.5, -6.25];
        let a = acceleration_of_velocity_change(&sampled(&v)).unwrap();
        let mut sum = 0.0;
        for (k, pair) in a.samples().windows(2).enumerate() {
            sum += 0.25 * (pair[0] + pair[1]);
            let expected = match v.get(k + 2) {
                Some(next) => (v[k] + 2.0 * v[k + 1] + next) / 4.0,
                None => v[k + 1],
            };
            // Quarters of binary fractions: exact.
            assert_eq!(sum, expected, "{k}");
        }
    }

    #[test]
    fn the_step_of_the_print_is_found_in_si() {
        let km_per_h: Vec<f64> = [0, -3, -9, -14, -14, -13].iter().map(|v| f64::from(*v) / 3.6).collect();
        // 1 km/h; rounding of the differences.
        assert!((printed_step_m_per_s(&km_per_h).unwrap() - 1.0 / 3.6).abs() < 1e-12);
        assert_eq!((printed_step_m_per_s(&[0.0, 0.0]), smallest_difference(&[2.0, 2.0])), (None, None));
        // Tenths of a km/h whose neighbours are never one tenth apart.
        let tenths: Vec<f64> = [0, -14, -47, -93, -121].iter().map(|v| f64::from(*v) / 36.0).collect();
        assert!((printed_step_m_per_s(&tenths).unwrap() - 1.0 / 36.0).abs() < 1e-12);
        // Of no printed step: the smallest difference.
        let odd = [0.0, -1.0 / 7.0, -std::f64::consts::PI];
        assert_eq!(printed_step_m_per_s(&odd), None);
        assert!((smallest_difference(&odd).unwrap() - 1.0 / 7.0).abs() < 1e-12);
        let mut notes = Notes::new();
        derivative_note(&Sampled::new(0.0, 0.01, km_per_h).unwrap(), "dv", &mut notes);
        let text = notes.to_texts().join("");
        assert!(text.contains("steps of 0.278 m/s") && text.contains("1.42 g wrong"), "{text}");
    }
}
