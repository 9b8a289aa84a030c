//! ERA on systems made here: known poles come back over orders, rates and shapes; what cannot work says so.

use crumple_numerics::lti::{Complex, impulse_response};
use crumple_sysid::{Decomposition, Era, EraError, EraOptions, Order, PoleRecord, Realization, era};
use proptest::prelude::*;

/// Sum of damped waves `amplitude e^{sigma t} cos(omega t + phase)` at `t = dt, 2 dt, ...`, after a first sample `d`.
fn record(modes: &[(f64, f64, f64, f64)], d: f64, dt: f64, samples: usize) -> Vec<f64> {
    (0..samples)
        .map(|k| {
            let t = k as f64 * dt;
            let wave = |&(sigma, omega, amplitude, phase): &(f64, f64, f64, f64)| {
                amplitude * (sigma * t).exp() * (omega * t + phase).cos()
            };
            if k == 0 { d } else { modes.iter().map(wave).sum() }
        })
        .collect()
}

fn given(order: usize, dt: f64) -> EraOptions {
    EraOptions { order: Order::Given(order), ..EraOptions::new(dt) }
}

#[test]
fn poles_come_back_for_several_orders_rates_and_lengths() {
    let all = [(-15.0, 120.0, -90.0, 0.3), (-40.0, 420.0, 35.0, -1.0), (-60.0, 900.0, 20.0, 0.7)];
    for count in 1..=3 {
        for dt in [1e-4, 5e-4, 1e-3] {
            for samples in [101, 500, 2501] {
                let modes = &all[..count];
                let y = record(modes, 4.0, dt, samples);
                let model = era(&y, given(2 * count, dt)).unwrap();
                // Two decades over rounding times the spread of the singular values, which is 1e6 when a tenth of a
                // second period is seen for 10 ms.
                let conditioning = model.singular_values[0] / model.singular_values[2 * count - 1];
                let tolerance = 1e-13 * conditioning.max(10.0);
                for &(sigma, omega, ..) in modes {
                    let truth = Complex::new(sigma, omega);
                    let error = model
                        .modes
                        .iter()
                        .map(|m| (m.mode.unwrap().pole - truth).norm() / truth.norm())
                        .fold(f64::INFINITY, f64::min);
                    assert!(error < tolerance, "{count} modes, dt {dt}, {samples}: {error:e} over {tolerance:e}");
                }
                assert!(model.fit_percent.unwrap() > 100.0 - 1e-6, "{:?}", model.fit_percent);
            }
        }
    }
}

#[test]
fn realisation_reproduces_the_record_and_is_balanced() {
    let y = record(&[(-15.0, 120.0, -90.0, 0.3), (-40.0, 420.0, 35.0, -1.0)], 4.0, 1e-4, 1001);
    let model = era(&y, given(4, 1e-4)).unwrap();
    let response = impulse_response(&model.discrete, y.len()).unwrap();
    for (a, b) in response.iter().zip(&y) {
        // 1000 steps of a stable recursion, rounding relative to the peak of 100.
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
    assert_eq!(model.discrete.d[(0, 0)], 4.0);
    for i in 0..4 {
        // One channel, square Hankel matrix: u = +-v, so B and C' agree up to signs.
        let (b, c) = (model.discrete.b[(i, 0)], model.discrete.c[(0, i)]);
        assert!((b.abs() - c.abs()).abs() < 1e-11 * c.abs().max(1.0), "{b} {c}");
        let coherence = model.modes[i].modal_amplitude_coherence.unwrap();
        assert!(coherence > 1.0 - 1e-9, "{coherence}");
    }
    let largest = model.modes.iter().map(|m| m.mode_singular_value.unwrap()).fold(0.0, f64::max);
    assert_eq!(largest, 1.0);
}

#[test]
fn continuous_model_has_the_same_poles_and_samples_back() {
    let y = record(&[(-15.0, 120.0, -90.0, 0.3), (-40.0, 420.0, 35.0, -1.0)], 0.0, 1e-4, 1001);
    let model = era(&y, given(4, 1e-4)).unwrap();
    let continuous = model.continuous.clone().unwrap();
    for (pole, identified) in continuous.poles().unwrap().iter().zip(&model.modes) {
        // Rounding unit over dt is 2e-12, amplified by the eigenvalue condition, about 1e2.
        assert!((pole - identified.mode.unwrap().pole).norm() < 1e-8, "{pole}");
    }
    let back = crumple_numerics::lti::discretize_zero_order_hold(&continuous, 1e-4).unwrap();
    assert!((&back.a - &model.discrete.a).norm() < 1e-12);
    assert!((&back.b - &model.discrete.b).norm() < 1e-11 * model.discrete.b.norm());
}

#[test]
fn poles_do_not_depend_on_the_unit_of_the_record() {
    let y = record(&[(-15.0, 120.0, -90.0, 0.3)], 4.0, 1e-3, 301);
    let scaled: Vec<f64> = y.iter().map(|a| a * 9.806_65e-200).collect();
    let (a, b) = (era(&y, given(2, 1e-3)).unwrap(), era(&scaled, given(2, 1e-3)).unwrap());
    for (a, b) in a.modes.iter().zip(&b.modes) {
        // The scale is not a power of two, so samples are rounded once: 1e-16 times the condition, about 1e2, over dt.
        assert!((a.mode.unwrap().pole - b.mode.unwrap().pole).norm() < 1e-9);
    }
}

#[test]
fn large_and_small_matrices_agree() {
    // 60x60 is formed, 70x70 is not.
    let y = record(&[(-15.0, 120.0, -90.0, 0.3), (-40.0, 420.0, 35.0, -1.0)], 4.0, 5e-4, 300);
    let sized = |n| EraOptions { rows: Some(n), columns: Some(n), ..given(4, 5e-4) };
    let (small, large) = (era(&y, sized(60)).unwrap(), era(&y, sized(70)).unwrap());
    assert_eq!(small.decomposition, Decomposition::Dense);
    assert!(matches!(large.decomposition, Decomposition::Lanczos { .. }));
    for (a, b) in small.modes.iter().zip(&large.modes) {
        assert!((a.mode.unwrap().pole - b.mode.unwrap().pole).norm() < 1e-8);
    }
}

#[test]
fn same_record_gives_the_same_bits() {
    let y: Vec<f64> = record(&[(-15.0, 120.0, -90.0, 0.3)], 4.0, 1e-4, 2501)
        .iter()
        .enumerate()
        .map(|(k, a)| a + 0.5 * ((k * k) as f64 * 0.37).sin())
        .collect();
    let bits = |m: &Realization| m.discrete.a.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let (first, second) = (era(&y, given(4, 1e-4)).unwrap(), era(&y, given(4, 1e-4)).unwrap());
    assert_eq!(bits(&first), bits(&second));
    assert_eq!(first, second);
}

#[test]
fn automatic_order_counts_the_modes_of_a_clean_and_of_a_noisy_record() {
    let modes = [(-15.0, 120.0, -90.0, 0.3), (-40.0, 420.0, 35.0, -1.0)];
    for noise in [0.0, 0.1] {
        for samples in [201, 1501] {
            let y: Vec<f64> = record(&modes, 4.0, 5e-4, samples)
                .iter()
                .enumerate()
                .map(|(k, a)| a + noise * ((k * k) as f64 * 0.37).sin())
                .collect();
            let model = era(&y, EraOptions::new(5e-4)).unwrap();
            assert_eq!(model.order(), 4, "noise {noise}, {samples} samples: {:?}", model.chosen);
        }
    }
}

#[test]
fn one_factorisation_serves_all_orders() {
    let y = record(&[(-15.0, 120.0, -90.0, 0.3), (-40.0, 420.0, 35.0, -1.0)], 4.0, 5e-4, 1001);
    let orders = [Order::Given(2), Order::Given(4), Order::Automatic];
    let shared = Era::new(&y, EraOptions::new(5e-4), &orders).unwrap();
    let two = shared.realize(orders[0]).unwrap();
    let four = shared.realize(orders[1]).unwrap();
    // Balanced form: the smaller model is the leading part of the larger.
    assert_eq!(two.discrete.a, four.discrete.a.view((0, 0), (2, 2)).into_owned());
    assert_eq!(shared.realize(orders[2]).unwrap().order(), 4);
    assert_eq!(shared.rank(), 4);
}

#[test]
fn refuses_an_order_above_the_rank() {
    let one_pole: Vec<f64> = (0..41).map(|k| 0.9_f64.powi(k)).collect();
    let options = EraOptions { rows: Some(10), columns: Some(10), ..given(3, 1e-3) };
    let error = era(&one_pole, options).unwrap_err();
    assert_eq!(error.to_string(), "order 3 exceeds the numerical rank 1 (σ[1]/σ[0] < 1e-12)");
}

#[test]
fn refuses_what_it_cannot_work_on_and_says_what_it_needs() {
    let text = |y: &[f64], options| era(y, options).unwrap_err().to_string();
    let y = record(&[(-15.0, 120.0, -90.0, 0.3)], 4.0, 1e-3, 32);
    let square = EraOptions { rows: Some(20), columns: Some(20), ..given(2, 1e-3) };
    assert_eq!(text(&y, square), "31 Markov parameters, but a 20x20 Hankel pair needs 40");
    assert_eq!(text(&[1.0], given(2, 1e-3)), "0 Markov parameters, but a 1x1 Hankel pair needs 2");
    assert_eq!(text(&[], given(2, 1e-3)), "0 Markov parameters, but a 1x1 Hankel pair needs 2");
    assert_eq!(
        text(&[5.0, 0.0, 0.0, 0.0, 0.0], given(1, 1e-3)),
        "all 4 samples after the first are zero: there is no motion to identify"
    );
    assert_eq!(text(&[1.0, f64::NAN, 2.0], given(1, 1e-3)), "sample 1 is not a finite number");
    assert_eq!(text(&y, given(40, 1e-3)), "order 40 needs at least 40 rows and columns, the Hankel matrix is 15x15");
    assert_eq!(text(&y, given(0, 1e-3)), "order 0 is no model");
    assert!(matches!(era(&y, given(2, 0.0)), Err(EraError::System(_))));
    let huge = EraOptions { rows: Some(usize::MAX), columns: Some(usize::MAX), ..given(2, 1e-3) };
    assert!(matches!(era(&y, huge), Err(EraError::TooShort { .. })));
}

/// The record of a model, as its poles are concerned.
fn during(model: &Realization, duration_s: f64) -> PoleRecord {
    let dt_s = model.discrete.sample_time_s.unwrap_or(0.0);
    PoleRecord { dt_s, duration_s, of_motion: false, window_per_s: 0.0 }
}

#[test]
fn alternating_record_is_reported_as_having_no_continuous_model() {
    let y: Vec<f64> = (0..60).map(|k| (-0.8_f64).powi(k)).collect();
    let model = era(&y, given(1, 1e-3)).unwrap();
    let reason = model.continuous.clone().unwrap_err().to_string();
    assert!(reason.contains("negative real axis"), "{reason}");
    let notes = crumple_sysid::caveats("era", &model, during(&model, 0.06), &[]).to_texts();
    assert!(notes.iter().any(|n| n.contains("no continuous model")), "{notes:?}");
    assert!(notes.iter().any(|n| n.contains("artefact of sampling")), "{notes:?}");
}

#[test]
fn growing_modes_and_modes_at_the_filter_edge_are_named() {
    // 100 Hz: the edge of CFC 60; growing.
    let omega = std::f64::consts::TAU * 100.0;
    let y = record(&[(3.0, omega, 50.0, 0.0)], 50.0, 1e-3, 401);
    let model = era(&y, given(2, 1e-3)).unwrap();
    let notes = |cfc| {
        crumple_sysid::caveats("era", &model, during(&model, 0.4), &[crumple_sysid::FilterEdge::of_class(cfc)])
            .to_texts()
    };
    assert!(notes(60).iter().any(|n| n.contains("100 Hz edge of the CFC 60 filter")), "{:?}", notes(60));
    assert_eq!(notes(60).iter().filter(|n| n.contains("grows")).count(), 1);
    assert_eq!(notes(1000).len(), 1, "{:?}", notes(1000));
}

proptest! {
    #[test]
    fn any_samples_and_sizes_give_a_finite_model_or_an_error(
        samples in prop::collection::vec(-1.0..1.0_f64, 0..60),
        exponents in prop::collection::vec(-320..300_i32, 60),
        wild: bool,
        order in 0..12_usize,
        rows in prop::option::of(0..40_usize),
        columns in prop::option::of(0..40_usize),
    ) {
        let y: Vec<f64> = samples
            .iter()
            .zip(&exponents)
            .map(|(x, e)| if wild { x * 10.0_f64.powi(*e) } else { *x })
            .collect();
        let order = if order == 0 { Order::Automatic } else { Order::Given(order) };
        let options = EraOptions { order, rows, columns, ..EraOptions::new(1e-4) };
        if let Ok(model) = era(&y, options) {
            let finite = |m: &nalgebra::DMatrix<f64>| m.iter().all(|x| x.is_finite());
            prop_assert!(finite(&model.discrete.a) && finite(&model.discrete.b) && finite(&model.discrete.c));
            prop_assert!(model.singular_values.iter().all(|s| s.is_finite()));
            prop_assert!(model.fit_percent.is_none_or(f64::is_finite) && model.rmse.is_none_or(f64::is_finite));
            for mode in &model.modes {
                prop_assert!(mode.modal_amplitude_coherence.is_none_or(|c| (0.0..=1.0).contains(&c)));
                prop_assert!(mode.mode_singular_value.is_none_or(|s| (0.0..=1.0).contains(&s)));
                let pole = mode.mode.map(|m| m.pole);
                prop_assert!(pole.is_none_or(|p| p.re.is_finite() && p.im.is_finite()));
            }
            crumple_sysid::caveats("era", &model, during(&model, 6e-3), &[crumple_sysid::FilterEdge::of_class(60)]);
        }
    }
}
