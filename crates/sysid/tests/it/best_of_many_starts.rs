//! The transfer-function fit against an independent optimiser: Levenberg-Marquardt on all unknowns of a modal model at
//! once, numerical derivatives, 200 random starts.

use crumple_numerics::lti::{StateSpace, discretize_first_order_hold};
use crumple_sysid::{IoData, TransferFunctionOptions, transfer_function_fit};
use nalgebra::{DMatrix, DVector};

const G: f64 = 9.806_65;

/// Numbers in [0, 1) that look random.
fn random(k: usize) -> f64 {
    let mut x = (k as u64).wrapping_add(77).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 32;
    x = x.wrapping_mul(0xD6E8_FEB8_6659_FD93);
    x ^= x >> 32;
    (x >> 11) as f64 / (1_u64 << 53) as f64
}

/// Sum of squares left by four poles, given as two sections `s² + p s + q` in scaled time (`asinh` of the
/// coefficients, so growth is allowed), with one zero and free
/// initial conditions: numerator and free motion by least squares (SVD). Written from the definition, in companion
/// form with scaled time, without any of the library's estimation code.
fn cost(unknowns: &[f64; 4], u: &[f64], y: &[f64]) -> (f64, DVector<f64>) {
    let infinite = || (f64::INFINITY, DVector::zeros(y.len()));
    let [p1, q1, p2, q2] = unknowns.map(f64::sinh);
    let a: [f64; 4] = [q1 * q2, p1 * q2 + p2 * q1, q1 + q2 + p1 * p2, p1 + p2];
    // Unit of time in which the product of the poles is 1.
    let w = a[0].abs().powf(0.25).max(1.0);
    let scaled: Vec<f64> = a.iter().enumerate().map(|(i, a)| a / (i..4).fold(1.0, |p, _| p * w)).collect();
    let matrix = DMatrix::from_fn(4, 4, |i, j| if i < 3 { f64::from(u8::from(j == i + 1)) } else { -scaled[j] });
    let b = DMatrix::from_fn(4, 1, |i, _| f64::from(u8::from(i == 3)));
    let Ok(model) = StateSpace::new(matrix, b, DMatrix::zeros(1, 4), DMatrix::zeros(1, 1), None) else {
        return infinite();
    };
    let Ok(d) = discretize_first_order_hold(&model, w / y.len() as f64) else { return infinite() };
    let mut x = DVector::zeros(4);
    let mut free = DMatrix::identity(4, 4);
    let mut basis = DMatrix::zeros(y.len(), 6);
    for k in 0..y.len() {
        basis[(k, 0)] = x[0];
        basis[(k, 1)] = x[1];
        for j in 0..4 {
            basis[(k, 2 + j)] = free[(0, j)];
        }
        if k + 1 < y.len() {
            x = &d.a * x + d.b_now.column(0) * u[k] + d.b_next.column(0) * u[k + 1];
            free = &d.a * free;
        }
    }
    for mut column in basis.column_iter_mut() {
        let norm = column.norm();
        if !(norm > 0.0 && norm.is_finite()) {
            return infinite();
        }
        column /= norm;
    }
    let target = DVector::from_column_slice(y);
    let q = basis.qr().q();
    let once = &target - &q * q.tr_mul(&target);
    let residual = &once - &q * q.tr_mul(&once);
    (residual.norm_squared(), residual)
}

/// Levenberg-Marquardt with numerical derivatives of the projected residual.
fn refine(start: [f64; 4], u: &[f64], y: &[f64]) -> f64 {
    let mut x = start;
    let (mut best, mut residual) = cost(&x, u, y);
    let mut damping = 1e-2;
    for _ in 0..60 {
        if !best.is_finite() {
            return best;
        }
        let mut jacobian = DMatrix::zeros(y.len(), 4);
        for i in 0..4 {
            let h = 1e-6;
            let moved = |sign: f64| {
                let mut x = x;
                x[i] += sign * h;
                cost(&x, u, y).1
            };
            jacobian.set_column(i, &((moved(1.0) - moved(-1.0)) / (2.0 * h)));
        }
        let (square, gradient) = (jacobian.tr_mul(&jacobian), jacobian.tr_mul(&residual));
        let before = best;
        let mut improved = false;
        for _ in 0..12 {
            let mut damped = square.clone();
            for i in 0..4 {
                damped[(i, i)] *= 1.0 + damping;
                damped[(i, i)] += 1e-30;
            }
            let Some(step) = damped.lu().solve(&(-&gradient)) else { break };
            let trial = std::array::from_fn(|i| (x[i] + step[i].clamp(-2.0, 2.0)).clamp(-7.0, 16.0));
            let (new, new_residual) = cost(&trial, u, y);
            if new < best {
                (x, best, residual) = (trial, new, new_residual);
                damping = (damping / 5.0_f64).max(1e-12);
                improved = true;
                break;
            }
            damping *= 4.0;
        }
        if !improved || before - best < 1e-12 * best {
            break;
        }
    }
    best
}

/// Deceleration in, displacement out, every tenth sample for the harness's sake, to the end of the record.
fn crash(acceleration: &[f64], v0: f64, dt: f64, every: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut v, mut x) = (v0, 0.0);
    let mut displacement = vec![0.0];
    for pair in acceleration.windows(2) {
        let next = v + dt * 0.5 * (pair[0] + pair[1]);
        x += dt * 0.5 * (v + next);
        v = next;
        displacement.push(x);
    }
    (acceleration.iter().step_by(every).copied().collect(), displacement.into_iter().step_by(every).collect())
}

fn check(name: &str, u: Vec<f64>, y: Vec<f64>, dt: f64) {
    let data = IoData::single(u.clone(), y.clone(), dt).unwrap();
    let ours = transfer_function_fit(&data, &TransferFunctionOptions::new(4, 1)).unwrap();
    let size = (y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64).sqrt();
    let scaled: Vec<f64> = y.iter().map(|y| y / size).collect();
    let mut losses: Vec<f64> = (0..200)
        .map(|start| {
            let unknowns = std::array::from_fn(|i| {
                // Moduli from 1 to a thousand over the record, damping ratios from 0.01 to 3.
                let w = 6.9 * random(8 * start + i / 2);
                let damping = 0.01 + 3.0 * random(8 * start + 4 + i / 2).powi(2);
                if i % 2 == 0 { (2.0 * damping * w.exp()).asinh() } else { (2.0 * w).exp().asinh() }
            });
            refine(unknowns, &u, &scaled) * size * size / y.len() as f64
        })
        .collect();
    losses.sort_by(f64::total_cmp);
    println!(
        "{name}: ours {:.12e} ({:.4} %, {}, start {}, {} of {} refined starts there), best of 200: {:.12e}, {} within \
         1e-6",
        ours.search.losses[0],
        ours.fits[0].unwrap().fit_percent.unwrap(),
        ours.search.stop_reason.name(),
        ours.search.start.name(),
        ours.search.losses.iter().filter(|l| **l < ours.search.losses[0] * (1.0 + 1e-6)).count(),
        ours.search.losses.len(),
        losses[0],
        losses.iter().filter(|l| **l < losses[0] * (1.0 + 1e-6)).count()
    );
    println!("    {:?} / {:?}", ours.entries[0][0].numerator(), ours.entries[0][0].denominator());
    // Perfect fits are equal at rounding: a relative comparison of such losses would be one of rounding errors.
    let rounding = (1e-11 * size).powi(2);
    assert!(
        ours.search.losses[0] <= losses[0] * (1.0 + 1e-6) + rounding,
        "{name}: {:e} {:e}",
        ours.search.losses[0],
        losses[0]
    );
}

fn known_truth(name: &str) {
    let Some(truth) = crumple_testkit::known_truth(name) else { return };
    let folder = match std::env::var_os("CRUMPLE_KNOWN_TRUTH") {
        Some(folder) => std::path::PathBuf::from(folder),
        None => crumple_testkit::shared("reference/known-truth").unwrap(),
    };
    let text = std::fs::read_to_string(folder.join(name).join("accel.csv")).unwrap();
    let acceleration: Vec<f64> = text
        .lines()
        .filter_map(|line| {
            let (t, a) = line.split_once(',')?;
            (t.parse::<f64>().ok()? > -5e-5).then(|| a.parse::<f64>().unwrap() * G)
        })
        .collect();
    let (u, y) = crash(&acceleration, truth["v0_m_s"].as_f64().unwrap(), 1e-4, 10);
    check(name, u, y, 1e-3);
}

#[test]
fn double_underdamped() {
    known_truth("double-underdamped");
}

#[test]
fn double_mixed() {
    known_truth("double-mixed");
}

#[test]
fn double_overdamped() {
    known_truth("double-overdamped");
}

#[test]
fn camry_left_rear_seat() {
    let Some(path) = crumple_testkit::shared("data/nhtsa-v10146-camry-frontal/v10146.093") else { return };
    // Two columns after a header: time and g, 10 kHz from -50 ms.
    let samples: Vec<(f64, f64)> = std::fs::read_to_string(path)
        .unwrap()
        .lines()
        .filter_map(|line| {
            let mut numbers = line.split_whitespace().map(str::parse::<f64>);
            match (numbers.next(), numbers.next()) {
                (Some(Ok(t)), Some(Ok(a))) => Some((t, a)),
                _ => None,
            }
        })
        .collect();
    let before: Vec<f64> = samples.iter().filter(|s| s.0 < -0.005).map(|s| s.1).collect();
    let zero = before.iter().sum::<f64>() / before.len() as f64;
    let acceleration: Vec<f64> =
        samples.iter().filter(|s| s.0 > -5e-5 && s.0 < 0.2001).map(|s| (s.1 - zero) * G).collect();
    let (u, y) = crash(&acceleration, 57.09 / 3.6, 1e-4, 4);
    check("camry 93", u, y, 4e-4);
}
