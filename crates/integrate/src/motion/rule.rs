//! Rules of summation: trapezoid, forward Euler, Simpson.

use serde::{Deserialize, Serialize};

/// How samples are summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
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

impl Rule {
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
pub fn integrate_twice(a: &[f64], dt_s: f64, rule: Rule, v_first: f64, x_first: f64) -> (Vec<f64>, Vec<f64>) {
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
    rule: Rule,
    [v_first, x_first]: [f64; 2],
    (velocity, displacement): (&mut Vec<f64>, &mut Vec<f64>),
    mut report: impl FnMut(u64),
) {
    // Memory fresh from the system is zero already; what is there from before is written over.
    for output in [&mut *velocity, &mut *displacement] {
        if output.capacity() < a.len() {
            *output = vec![0.0; a.len()];
        } else {
            output.resize(a.len(), 0.0);
        }
    }
    let (Some(v), Some(x)) = (velocity.first_mut(), displacement.first_mut()) else { return };
    (*v, *x) = (v_first, x_first);
    let mut state = State { dt_s, v: v_first, x: x_first, v_middle: v_first };
    let outputs = velocity[1..].chunks_mut(BLOCK).zip(displacement[1..].chunks_mut(BLOCK));
    for (block, (v, x)) in outputs.enumerate() {
        let first = 1 + block * BLOCK;
        match rule {
            Rule::Trapezoid => state.trapezoid(&a[first - 1..first + v.len()], v, x),
            Rule::ForwardEuler => state.forward_euler(&a[first - 1..first + v.len()], v, x),
            // A block has an even number of samples, so that pairs of intervals do not cross from one to the next.
            Rule::Simpson => state.simpson(a, first, v, x),
        }
        report(v.len() as u64);
    }
}

/// Velocity and displacement at the last sample done: what one block hands to the next, so that blocks give the bits of
/// a single sum.
struct State {
    dt_s: f64,
    v: f64,
    x: f64,
    /// Velocity one sample before; kept by Simpson's rule alone.
    v_middle: f64,
}

impl State {
    /// `a` begins one sample before the outputs. Both sums in one pass: their additions wait for nothing but the sample
    /// before.
    fn trapezoid(&mut self, a: &[f64], v_out: &mut [f64], x_out: &mut [f64]) {
        // Halving is exact, so T/2 times a sum is T times a sum, halved.
        let half_s = self.dt_s / 2.0;
        let (mut v, mut x) = (self.v, self.x);
        for (pair, (v_out, x_out)) in a.windows(2).zip(v_out.iter_mut().zip(x_out)) {
            let next = v + half_s * (pair[0] + pair[1]);
            x += half_s * (v + next);
            v = next;
            (*v_out, *x_out) = (v, x);
        }
        (self.v, self.x) = (v, x);
    }

    /// `a` begins one sample before the outputs. The displacement takes the velocity before the step, not after it. Two
    /// short loops in turn: packed into one pair of lanes, each sum would wait for the other.
    fn forward_euler(&mut self, a: &[f64], v_out: &mut [f64], x_out: &mut [f64]) {
        const SAMPLES: usize = 16;
        let dt_s = self.dt_s;
        let (mut v, mut x) = (self.v, self.x);
        for (a, (v_out, x_out)) in a.chunks(SAMPLES).zip(v_out.chunks_mut(SAMPLES).zip(x_out.chunks_mut(SAMPLES))) {
            let first = v;
            for (a, v_out) in a.iter().zip(&mut *v_out) {
                v += dt_s * a;
                *v_out = v;
            }
            for (v, x_out) in std::iter::once(&first).chain(&*v_out).zip(x_out) {
                x += dt_s * v;
                *x_out = x;
            }
        }
        (self.v, self.x) = (v, x);
    }

    /// `a` is the whole record, `first` the index of the first output.
    fn simpson(&mut self, a: &[f64], first: usize, v_out: &mut [f64], x_out: &mut [f64]) {
        let twelfth_s = self.dt_s / 12.0;
        let third_s = self.dt_s / 3.0;
        let (mut v, mut x) = (self.v, self.x);
        let pairs = a[first - 1..].windows(3).step_by(2);
        for (a, (v_out, x_out)) in pairs.zip(v_out.chunks_exact_mut(2).zip(x_out.chunks_exact_mut(2))) {
            let middle = v + twelfth_s * (5.0 * a[0] + 8.0 * a[1] - a[2]);
            let end = v + third_s * (a[0] + 4.0 * a[1] + a[2]);
            x_out[0] = x + twelfth_s * (5.0 * v + 8.0 * middle - end);
            x += third_s * (v + 4.0 * middle + end);
            x_out[1] = x;
            v_out.copy_from_slice(&[middle, end]);
            self.v_middle = middle;
            v = end;
        }
        (self.v, self.x) = (v, x);
        // A single interval is left at the end of a record with an even number of samples.
        let left = v_out.chunks_exact_mut(2).into_remainder().first_mut().zip(x_out.last_mut());
        let Some((v_last, x_last)) = left else { return };
        match a {
            [.., a0, a1, a2] => {
                *v_last = v + twelfth_s * (-a0 + 8.0 * a1 + 5.0 * a2);
                *x_last = x + twelfth_s * (-self.v_middle + 8.0 * v + 5.0 * *v_last);
            }
            _ => {
                *v_last = v + self.dt_s / 2.0 * a.iter().sum::<f64>();
                *x_last = x + self.dt_s / 2.0 * (v + *v_last);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_on_a_ramp_worked_by_hand() {
        let a = [0.0, -2.0, -4.0];
        // Literals with exact binary values.
        assert_eq!(integrate_twice(&a, 0.5, Rule::Trapezoid, 4.0, 1.0), (vec![4.0, 3.5, 2.0], vec![1.0, 2.875, 4.25]));
        assert_eq!(integrate_twice(&a, 0.5, Rule::ForwardEuler, 4.0, 1.0), (vec![4.0, 4.0, 3.0], vec![1.0, 3.0, 5.0]));
    }

    #[test]
    fn simpson_is_exact_for_a_parabola_whatever_the_number_of_samples() {
        for n in [1, 2, 3, 4, 5, 8, 9, 200, 201] {
            let t: Vec<f64> = (0..n).map(|k| 5e-3 * f64::from(k)).collect();
            let a: Vec<f64> = t.iter().map(|t| 2.0 - 3.0 * t + t * t).collect();
            let (v, x) = integrate_twice(&a, 5e-3, Rule::Simpson, 5.0, 1.0);
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
            for rule in Rule::ALL {
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
        for rule in Rule::ALL {
            assert_eq!(integrate_twice(&[], 0.5, rule, 4.0, 1.0), (vec![], vec![]));
        }
    }

    #[test]
    fn the_name_is_the_one_in_a_pipeline_table() {
        for rule in Rule::ALL {
            assert_eq!(serde_json::to_value(rule).unwrap(), rule.name());
        }
    }
}
