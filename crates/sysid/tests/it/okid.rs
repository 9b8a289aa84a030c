//! OKID on data of systems that are known.

use crumple_numerics::lti::{StateSpace, simulate};
use crumple_sysid::{
    Criterion, IdentifyError, IoData, Lags, Okid, OkidOptions, Order, compare, fit_measures, markov_parameters,
};
use crumple_testkit::white_noise;
use nalgebra::{DMatrix, dmatrix};

/// Three states, two inputs, two outputs.
fn system() -> StateSpace {
    let a = dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 0.5];
    let b = dmatrix![1.0, 0.0; 0.5, -1.0; 0.2, 2.0];
    let c = dmatrix![1.0, 0.0, 0.3; 0.0, 1.0, -1.0];
    StateSpace::new(a, b, c, DMatrix::from_element(2, 2, 0.1), Some(0.01)).unwrap()
}

fn white(channels: usize, samples: usize, size: f64) -> Vec<Vec<f64>> {
    (0..channels).map(|j| (0..samples).map(|k| size * white_noise(j, k)).collect()).collect()
}

#[test]
fn clean_data_give_markov_parameters_model_and_predictor() {
    let truth = system();
    let u = white(2, 400, 1e4);
    let y = simulate(&truth, &u, &[100.0, 0.0, 0.0]).unwrap();
    let data = IoData::new(u, y, 0.01).unwrap();
    let okid = Okid::new(&data, OkidOptions::new(Lags::Given(6))).unwrap();
    // Three states tie the past together: of 26 regressors 2 + 2 * 6 inputs and 3 states are free.
    assert_eq!((okid.rank, okid.regressors), (17, 26));
    let exact = markov_parameters(&truth, 60);
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        for (estimated, exact) in okid.system(i, j).iter().zip(&exact[2 * i + j]) {
            // Rounding, times the condition of the regression.
            assert!((estimated - exact).abs() < 1e-10, "{estimated} {exact}");
        }
    }
    // No noise: the gain is not determined.
    let estimated = okid.realize(Order::Given(3)).unwrap();
    for (estimated, exact) in estimated.model.poles().unwrap().iter().zip(truth.poles().unwrap()) {
        assert!((estimated - exact).norm() < 1e-9, "{estimated} {exact}");
    }
    for fit in compare(&estimated.model, &data).unwrap() {
        assert!(fit.unwrap().fit_percent.unwrap() > 100.0 - 1e-7, "{fit:?}");
    }
    let automatic = okid.realize(Order::Automatic).unwrap();
    assert_eq!(automatic.model.order(), 3);
}

#[test]
fn the_kalman_gain_of_an_innovations_model_comes_back() {
    let truth = system();
    let k = dmatrix![0.3, 0.0; 0.1, 0.2; 0.0, -0.2];
    let samples = 20_000;
    let u = white(2, samples, 1.0);
    let e = (2..4).map(|j| (0..samples).map(|t| 0.5 * white_noise(j, t)).collect::<Vec<f64>>());
    // Innovations are an input through K and the identity.
    let both: Vec<Vec<f64>> = u.iter().cloned().chain(e).collect();
    let b = DMatrix::from_fn(3, 4, |i, j| if j < 2 { truth.b[(i, j)] } else { k[(i, j - 2)] });
    let d = DMatrix::from_fn(2, 4, |i, j| if j < 2 { truth.d[(i, j)] } else { f64::from(u8::from(i == j - 2)) });
    let model = StateSpace::new(truth.a.clone(), b, truth.c.clone(), d, Some(0.01)).unwrap();
    let y = simulate(&model, &both, &[0.0; 3]).unwrap();
    let data = IoData::new(u, y, 0.01).unwrap();
    let lags = Lags::Best { highest: 25, criterion: Criterion::Aicc };
    let okid = Okid::new(&data, OkidOptions::new(lags)).unwrap();
    let estimated = okid.realize(Order::Given(3)).unwrap();
    println!("{} lags, growth {:.2e}", okid.lags, okid.growth);
    let gain = |model: &StateSpace, k: &DMatrix<f64>| {
        let zero = DMatrix::zeros(2, 2);
        let through = StateSpace::new(model.a.clone(), k.clone(), model.c.clone(), zero, Some(0.01)).unwrap();
        markov_parameters(&through, 8)
    };
    for (estimated, exact) in gain(&estimated.model, &estimated.kalman_gain).iter().zip(gain(&truth, &k)) {
        for (estimated, exact) in estimated.iter().zip(exact) {
            // Each is a regression coefficient on 20,000 samples, or a sum of some: 1/sqrt N = 0.007, four of them.
            assert!((estimated - exact).abs() < 0.03, "{estimated} {exact}");
        }
    }
    // The predictor leaves the innovations and no more: their root mean square is 0.5.
    let predictor = estimated.predictor().unwrap();
    let seen: Vec<Vec<f64>> = data.inputs().iter().chain(data.outputs()).cloned().collect();
    let predicted = simulate(&predictor, &seen, &[0.0; 3]).unwrap();
    for (y, predicted) in data.outputs().iter().zip(&predicted) {
        let rmse = fit_measures(&y[100..], &predicted[100..]).unwrap().rmse;
        // Sampling error of a root mean square: 0.5/sqrt(2 N) = 0.0025, and 50 parameters too many or too few.
        assert!((rmse - 0.5).abs() < 0.01, "{rmse}");
    }
}

#[test]
fn criteria_find_the_lags_of_an_autoregression() {
    let samples = 3000;
    let u = white(1, samples, 1.0);
    let mut y = vec![0.0; samples];
    for k in 3..samples {
        y[k] = 1.5 * y[k - 1] - 0.9 * y[k - 2] + 0.2 * y[k - 3] + u[0][k - 1] + 0.3 * white_noise(9, k);
    }
    let data = IoData::new(u, vec![y], 1.0).unwrap();
    let best = |criterion| {
        let okid = Okid::new(&data, OkidOptions::new(Lags::Best { highest: 15, criterion })).unwrap();
        assert_eq!(okid.scan.len(), 15);
        okid.lags
    };
    let (aicc, bic) = (best(Criterion::Aicc), best(Criterion::Bic));
    println!("AICc {aicc}, BIC {bic}");
    // BIC is consistent; AICc may add a few.
    assert_eq!(bic, 3);
    assert!((3..=8).contains(&aicc));
}

#[test]
fn equal_outputs_lower_the_rank_and_do_no_harm() {
    let truth = system();
    let u = white(2, 500, 1.0);
    let mut y = simulate(&truth, &u, &[0.0; 3]).unwrap();
    for (i, output) in y.iter_mut().enumerate() {
        for (k, y) in output.iter_mut().enumerate() {
            *y += 0.01 * white_noise(7 + i, k);
        }
    }
    y.push(y[0].clone());
    let data = IoData::new(u, y, 0.01).unwrap();
    let okid = Okid::new(&data, OkidOptions::new(Lags::Given(8))).unwrap();
    assert_eq!(okid.regressors - okid.rank, 8);
    // The gain is not determined between equal outputs.
    let model = okid.realize(Order::Given(3)).unwrap().model;
    let fits = compare(&model, &data).unwrap();
    assert!(fits.iter().all(|fit| fit.unwrap().fit_percent.unwrap() > 98.0), "{fits:?}");
}

#[test]
fn a_growing_recursion_is_not_passed_on() {
    // An output that grows: its autoregression has a root outside the unit circle.
    let u = white(1, 300, 1.0);
    let mut y = vec![0.0; 300];
    for k in 1..300 {
        y[k] = 1.05 * y[k - 1] + u[0][k - 1];
    }
    let data = IoData::new(u, vec![y], 1.0).unwrap();
    let error = Okid::new(&data, OkidOptions::new(Lags::Given(2))).unwrap_err();
    assert!(matches!(error, IdentifyError::Diverged { lags: 2, .. }), "{error}");
    assert!(error.to_string().starts_with("okid_diverged"), "{error}");
}

#[test]
fn too_short_and_silent_data_are_refused() {
    let data = IoData::new(white(1, 20, 1.0), white(1, 20, 1.0), 1.0).unwrap();
    let error = Okid::new(&data, OkidOptions::new(Lags::Given(5))).unwrap_err().to_string();
    assert_eq!(error, "20 samples, okid needs 28 (5 lags of 1 inputs and 1 outputs)");
    let silent = IoData::new(white(1, 200, 1.0), vec![vec![0.0; 200]], 1.0).unwrap();
    assert!(matches!(Okid::new(&silent, OkidOptions::new(Lags::Given(5))), Err(IdentifyError::Silent(_))));
}
