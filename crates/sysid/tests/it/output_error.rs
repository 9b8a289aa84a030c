//! Output error of an impact on several sensors, and of long records.

use crumple_numerics::lti::{Complex, StateSpace, discretize_zero_order_hold, simulate};
use crumple_sysid::{
    Hold, IoData, OutputErrorOptions, TransferFunctionOptions, compare, modal_assurance, mode_shapes, output_error,
    transfer_function_fit,
};
use crumple_testkit::white_noise;
use nalgebra::{DMatrix, SymmetricEigen};

/// Five equal masses on equal springs, held at the first: accelerations of all when the last but one is struck.
/// Sampled model, record with 2 % of noise, and shapes by rising frequency.
fn impact() -> (StateSpace, IoData, Vec<Vec<f64>>) {
    let (n, dt, samples) = (5, 0.01, 1200);
    let stiffness: DMatrix<f64> = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if i + 1 == n => 400.0,
        0 => 800.0,
        1 => -400.0,
        _ => 0.0,
    });
    let modes = SymmetricEigen::new(stiffness.clone());
    let rates = DMatrix::from_diagonal(&modes.eigenvalues.map(|w2| 2.0 * 0.02 * w2.sqrt()));
    let damping = &modes.eigenvectors * rates * modes.eigenvectors.transpose();
    let mut a = DMatrix::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n)).copy_from(&-&stiffness);
    a.view_mut((n, n), (n, n)).copy_from(&-&damping);
    let b = DMatrix::from_fn(2 * n, 1, |i, _| if i == n + 3 { 1.0 / 25.0 } else { 0.0 });
    let (c, d) = (a.rows(n, n).into_owned(), b.rows(n, n).into_owned());
    let model = discretize_zero_order_hold(&StateSpace::new(a, b, c, d, None).unwrap(), dt).unwrap();
    let force = |k: usize| (std::f64::consts::PI * ((k - 20) as f64 + 0.5) / 4.0).sin();
    let u: Vec<f64> = (0..samples).map(|k| if (20..24).contains(&k) { 1000.0 * force(k) } else { 0.0 }).collect();
    let mut y = simulate(&model, std::slice::from_ref(&u), &vec![0.0; 2 * n]).unwrap();
    for (i, y) in y.iter_mut().enumerate() {
        let largest = y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
        y.iter_mut().enumerate().for_each(|(k, y)| *y += 0.02 * largest * white_noise(30 + i, k));
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|i, j| modes.eigenvalues[*i].total_cmp(&modes.eigenvalues[*j]));
    let shapes = order.into_iter().map(|k| modes.eigenvectors.column(k).iter().copied().collect()).collect();
    (model, IoData::new(vec![u], y, dt).unwrap(), shapes)
}

/// Fits of all outputs, and the least assurance of the shapes of the modes by rising frequency.
fn quality(model: &StateSpace, data: &IoData, shapes: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let fits = compare(model, data).unwrap().into_iter().map(|fit| fit.unwrap().fit_percent.unwrap()).collect();
    let mut poles: Vec<Complex> = model.poles().unwrap().into_iter().filter(|z| z.im > 0.0).collect();
    poles.sort_by(|a, b| a.arg().total_cmp(&b.arg()));
    assert_eq!(poles.len(), shapes.len(), "{poles:?}");
    let found = mode_shapes(model, &poles);
    let least = found.iter().zip(shapes).map(|(shape, exact)| {
        let exact: Vec<Complex> = exact.iter().map(|x| Complex::new(*x, 0.0)).collect();
        modal_assurance(shape.as_ref().unwrap(), &exact).unwrap()
    });
    (fits, least.fold(1.0, f64::min))
}

#[test]
fn an_impact_on_five_sensors_gives_the_model_and_its_shapes() {
    let (truth, data, shapes) = impact();
    let (exact, _) = quality(&truth, &data, &shapes);
    let sampled = output_error(&data, OutputErrorOptions::new(10)).unwrap().model;
    let options = TransferFunctionOptions { hold: Hold::Zero, ..TransferFunctionOptions::new(10, 10) };
    let continuous = transfer_function_fit(&data, &options).unwrap();
    assert!(!continuous.search.initial_estimated);
    let continuous = discretize_zero_order_hold(&continuous.state_space, data.sample_time_s()).unwrap();
    for model in [&sampled, &continuous] {
        let (fits, least) = quality(model, &data, &shapes);
        println!("fits {fits:.2?} of {exact:.2?}, least assurance {least:.4}");
        assert!(fits.iter().zip(&exact).all(|(fit, exact)| (fit - exact).abs() < 3.0), "{fits:?} {exact:?}");
        assert!(least > 0.99, "{least}");
    }
}

#[test]
fn a_long_record_is_followed_as_closely_as_a_short_one() {
    let (dt, samples) = (0.01, 50_000);
    let pair = |hertz: f64, damping: f64| {
        let s = std::f64::consts::TAU * hertz * Complex::new(-damping, (1.0 - damping * damping).sqrt());
        (s * dt).exp()
    };
    let (p, q) = (pair(3.0, 0.03), pair(11.0, 0.02));
    let block = [p.re, -p.im, 0.0, 0.0, p.im, p.re, 0.0, 0.0, 0.0, 0.0, q.re, -q.im, 0.0, 0.0, q.im, q.re];
    let a = DMatrix::from_row_slice(4, 4, &block);
    let b = nalgebra::dmatrix![0.1; 0.05; 0.3; -0.2];
    let truth = StateSpace::new(a, b, DMatrix::from_element(1, 4, 1.0), DMatrix::zeros(1, 1), Some(dt)).unwrap();
    let u: Vec<f64> = (0..samples).map(|k| white_noise(1, k)).collect();
    let mut y = simulate(&truth, std::slice::from_ref(&u), &[0.0; 4]).unwrap().swap_remove(0);
    let size = (y.iter().map(|y| y * y).sum::<f64>() / samples as f64).sqrt();
    y.iter_mut().enumerate().for_each(|(k, y)| *y += 0.05 * size * white_noise(2, k));
    let data = IoData::single(u, y, dt).unwrap();
    let fit = output_error(&data, OutputErrorOptions::new(4)).unwrap();
    // Of 50,000 samples the noise is known to 0.3 %.
    assert!((fit.loss.sqrt() / 0.05 - 1.0).abs() < 0.02, "{}", fit.loss.sqrt());
    for z in [p, q] {
        let miss = fit.model.poles().unwrap().into_iter().map(|x| (x - z).norm()).fold(f64::INFINITY, f64::min);
        assert!(miss < 1e-3, "{miss}");
    }
}
