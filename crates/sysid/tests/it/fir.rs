//! Regularised impulse responses of systems that are known.

use crumple_numerics::lti::{StateSpace, simulate};
use crumple_sysid::{EraOptions, Fir, FirOptions, IdentifyError, IoData, Kernel, Order, era, fir, markov_parameters};
use crumple_testkit::white_noise;
use nalgebra::dmatrix;

/// A damped oscillation of 20 samples a period.
fn system() -> StateSpace {
    StateSpace::new(
        dmatrix![0.85, 0.28; -0.28, 0.85],
        dmatrix![1.0; 0.3],
        dmatrix![1.0, 0.5],
        dmatrix![0.0],
        Some(1e-3),
    )
    .unwrap()
}

/// The answer to a smooth input (hard to invert), with noise of a tenth of its root mean square.
fn data(samples: usize, level: f64, seed: usize, x0: f64) -> IoData {
    let mut u = vec![0.0; samples];
    for k in 1..samples {
        u[k] = 0.8 * u[k - 1] + white_noise(100 + seed, k);
    }
    let mut y = simulate(&system(), &[u.clone()], &[x0, 0.0]).unwrap().swap_remove(0);
    let size = (y.iter().map(|y| y * y).sum::<f64>() / samples as f64).sqrt();
    for (k, y) in y.iter_mut().enumerate() {
        *y += level * size * white_noise(200 + seed, k);
    }
    IoData::single(u, y, 1e-3).unwrap()
}

fn error(estimated: &Fir, taps: usize) -> f64 {
    let exact = markov_parameters(&system(), taps).swap_remove(0);
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    (square(&mut exact.iter().zip(&estimated.sequences[0]).map(|(a, b)| a - b)) / square(&mut exact.iter().copied()))
        .sqrt()
}

#[test]
fn short_noisy_records_are_estimated_better_than_by_least_squares_every_time() {
    let (samples, taps) = (130, 60);
    let mut all = [Vec::new(), Vec::new(), Vec::new()];
    for seed in 0..25 {
        let data = data(samples, 0.3, seed, 0.0);
        for (errors, kernel) in all.iter_mut().zip(Kernel::ALL) {
            errors.push(error(&fir(&data, FirOptions { taps, kernel, at_rest: true }).unwrap(), taps));
        }
    }
    let [with_tuned, with_diagonal, without] = &all;
    for (seed, ((tuned, diagonal), plain)) in with_tuned.iter().zip(with_diagonal).zip(without).enumerate() {
        assert!(tuned < plain && diagonal < plain, "seed {seed}: {tuned} {diagonal} {plain}");
    }
    let medians = all.map(|mut errors| {
        errors.sort_by(f64::total_cmp);
        errors[12]
    });
    println!("median relative error of {taps} taps from {samples} samples, 30 % noise: tc, dc, none {medians:.3?}");
    assert!(medians[0] < 0.3 * medians[2] && medians[1] < 0.3 * medians[2], "{medians:?}");
}

#[test]
fn fewer_samples_than_taps_are_enough_with_a_kernel() {
    let data = data(50, 0.05, 3, 0.0);
    let options = FirOptions { taps: 60, kernel: Kernel::TunedCorrelated, at_rest: true };
    let estimated = fir(&data, options).unwrap();
    let chosen = estimated.hyperparameters[0].unwrap();
    println!("error {:.3}, {chosen:?}", error(&estimated, 60));
    assert!(error(&estimated, 60) < 0.3, "{}", error(&estimated, 60));
    assert!(chosen.effective_parameters < 50.0 && chosen.decay < 1.0);
    let refused = fir(&data, FirOptions { kernel: Kernel::None, ..options });
    assert!(matches!(refused, Err(IdentifyError::TooShort { needed: 61, .. })), "{refused:?}");
}

#[test]
fn long_clean_records_give_the_response_with_and_without_a_kernel() {
    let taps = 80;
    for at_rest in [true, false] {
        let data = data(800, 0.0, 1, if at_rest { 0.0 } else { 5.0 });
        for kernel in Kernel::ALL {
            let estimated = fir(&data, FirOptions { taps, kernel, at_rest }).unwrap();
            let error = error(&estimated, taps);
            // What is left of the response after 80 taps: 0.895^80 = 1e-4, thrown on the others.
            assert!(error < 1e-3, "{}: {error:e}", kernel.name());
        }
    }
}

#[test]
fn era_on_the_estimate_finds_the_pole_where_least_squares_leaves_noise() {
    let exact = system().poles().unwrap()[0];
    let taps = 60;
    let mut pole_errors = [Vec::new(), Vec::new()];
    for seed in 0..15 {
        let data = data(200, 0.2, seed, 0.0);
        for (errors, kernel) in pole_errors.iter_mut().zip([Kernel::TunedCorrelated, Kernel::None]) {
            let estimated = fir(&data, FirOptions { taps, kernel, at_rest: true }).unwrap();
            let model =
                era(&estimated.sequences[0], EraOptions { order: Order::Given(2), ..EraOptions::new(1e-3) }).unwrap();
            let poles = model.discrete.poles().unwrap();
            errors.push(poles.iter().map(|z| (z - exact).norm()).fold(f64::INFINITY, f64::min));
        }
    }
    let medians = pole_errors.map(|mut errors| {
        errors.sort_by(f64::total_cmp);
        errors[7]
    });
    println!("median error of the pole {exact:.3}: tc {:.4}, least squares {:.4}", medians[0], medians[1]);
    assert!(medians[0] < medians[1], "{medians:?}");
}

#[test]
fn two_inputs_and_a_silent_output() {
    let a = data(300, 0.02, 5, 0.0);
    let b = data(300, 0.02, 6, 0.0);
    let sum: Vec<f64> = a.outputs()[0].iter().zip(&b.outputs()[0]).map(|(x, y)| x + y).collect();
    let both = IoData::new(vec![a.inputs()[0].clone(), b.inputs()[0].clone()], vec![sum], 1e-3).unwrap();
    let estimated = fir(&both, FirOptions { taps: 50, kernel: Kernel::TunedCorrelated, at_rest: true }).unwrap();
    let exact = markov_parameters(&system(), 50).swap_remove(0);
    for sequence in &estimated.sequences {
        for (estimated, exact) in sequence.iter().zip(&exact) {
            // 2 % noise on 300 samples: a percent or two of the largest tap, 1.15.
            assert!((estimated - exact).abs() < 0.1, "{estimated} {exact}");
        }
    }
    let silent = IoData::new(vec![a.inputs()[0].clone()], vec![vec![0.0; 300]], 1e-3).unwrap();
    let options = FirOptions { taps: 50, kernel: Kernel::TunedCorrelated, at_rest: true };
    assert!(matches!(fir(&silent, options), Err(IdentifyError::Silent(_))));
}
