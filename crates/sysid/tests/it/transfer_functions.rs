//! Continuous transfer functions with known answers.

use crumple_numerics::lti::{StateSpace, discretize_first_order_hold};
use crumple_sysid::{Hold, InitialConditions, IoData, Start, TransferFunctionOptions, transfer_function_fit};
use nalgebra::{DMatrix, DVector};

/// Numbers in [-1, 1) that look random.
fn noise(k: usize) -> f64 {
    crumple_testkit::uniform(k as u64)
}

/// Unit of time of the simulations here, s: coefficients of all powers are then of one size.
const UNIT_S: f64 = 0.02;

/// Response of a transfer function to an input with first-order hold, from a state of its controller form given in
/// derivatives per second.
fn simulated(numerator: &[f64], denominator: &[f64], input: &[f64], initial: &[f64], dt: f64) -> Vec<f64> {
    let n = denominator.len() - 1;
    let power = |k: usize| (0..k).fold(1.0, |p, _| p * UNIT_S);
    let a = DMatrix::from_fn(n, n, |i, j| {
        if i + 1 < n { f64::from(u8::from(j == i + 1)) } else { -denominator[n - j] * power(n - j) }
    });
    let b = DMatrix::from_fn(n, 1, |i, _| f64::from(u8::from(i + 1 == n)));
    let c = DMatrix::from_fn(1, n, |_, j| numerator.iter().rev().nth(j).copied().unwrap_or(0.0) * power(n - j));
    let model = StateSpace::new(a, b, c, DMatrix::zeros(1, 1), None).unwrap();
    let d = discretize_first_order_hold(&model, dt / UNIT_S).unwrap();
    let initial: Vec<f64> = initial.iter().enumerate().map(|(k, x)| x * power(k)).collect();
    d.response(input, &DVector::from_column_slice(&initial)).unwrap()
}

/// The model that the transfer-function paper prints, with a crash-like pulse and a speed of 15.6 m/s at the start.
const NUMERATOR: [f64; 2] = [-76.15, 466.2];
const DENOMINATOR: [f64; 5] = [1.0, 35.7, 6024.0, 185_000.0, 414_600.0];

fn crash(noise_m: f64) -> IoData {
    let dt = 1e-3;
    let input: Vec<f64> = (0..200)
        .map(|k| {
            let t = f64::from(k) * dt;
            -300.0
                * (std::f64::consts::PI * t / 0.11).sin().max(0.0)
                * (1.0 + 0.4 * (140.0 * t).sin())
                * f64::from(u8::from(t < 0.11))
        })
        .collect();
    let forced = simulated(&NUMERATOR, &DENOMINATOR, &input, &[0.0; 4], dt);
    let free = free_motion(&DENOMINATOR, &[0.0, 15.6, 0.0, 0.0], 200, dt);
    let output = (0..200).map(|k| forced[k] + free[k] + noise_m * noise(k) * 3.0_f64.sqrt()).collect();
    IoData::single(input, output, dt).unwrap()
}

/// Solution of the homogeneous equation with given value and derivatives at the start.
fn free_motion(denominator: &[f64], start: &[f64], samples: usize, dt: f64) -> Vec<f64> {
    let n = denominator.len() - 1;
    // The first state of the controller form is the motion itself, times the unit of time to the n-th.
    simulated(&[1.0 / (0..n).fold(1.0, |p, _| p * UNIT_S)], denominator, &vec![0.0; samples], start, dt)
}

#[test]
fn coefficients_of_the_printed_model_come_back_to_nine_digits() {
    let fit = transfer_function_fit(&crash(0.0), &TransferFunctionOptions::new(4, 1)).unwrap();
    println!(
        "{:?} from {} after {} iterations, {} evaluations, loss {:.1e}",
        fit.search.stop_reason,
        fit.search.start.name(),
        fit.search.iterations,
        fit.search.evaluations,
        fit.search.losses[0]
    );
    println!("{:?} / {:?}", fit.entries[0][0].numerator(), fit.entries[0][0].denominator());
    let estimated = fit.entries[0][0].denominator().iter().chain(fit.entries[0][0].numerator());
    for (estimated, exact) in estimated.zip(DENOMINATOR.iter().chain(&NUMERATOR)) {
        assert!((estimated / exact - 1.0).abs() < 1e-9, "{estimated} {exact}");
    }
    // The zero in the right half plane is the finding about that model.
    assert!((fit.zeros[0].0.re - 466.2 / 76.15).abs() < 1e-7);
    assert!(fit.fits[0].unwrap().fit_percent.unwrap() > 99.999_999);
    // Free motion over the same denominator: y(0) = 0 and y'(0) = 15.6 are its leading coefficients.
    assert!(
        fit.initial_numerators[0][0].abs() < 1e-6 && (fit.initial_numerators[0][1] - 15.6).abs() < 1e-6,
        "{:?}",
        fit.initial_numerators[0]
    );
}

#[test]
fn noise_is_covered_by_the_standard_deviations_and_blurs_the_numerator() {
    for noise_m in [1e-4, 1e-3] {
        let fit = transfer_function_fit(&crash(noise_m), &TransferFunctionOptions::new(4, 1)).unwrap();
        let estimated = fit.entries[0][0].denominator()[1..].iter().chain(fit.entries[0][0].numerator());
        let deviations = fit.search.denominator_deviations.iter().chain(&fit.numerator_deviations[0][0]);
        for ((estimated, exact), deviation) in estimated.zip(DENOMINATOR[1..].iter().chain(&NUMERATOR)).zip(deviations)
        {
            println!("{noise_m}: {estimated:.6e} +- {deviation:.1e}, exact {exact:.6e}");
            // Four deviations; the data are fixed.
            assert!((estimated - exact).abs() < 4.0 * deviation, "{estimated} {exact} {deviation}");
        }
        let rmse = fit.fits[0].unwrap().rmse;
        assert!((rmse / noise_m - 1.0).abs() < 0.1, "{rmse}");
        if noise_m == 1e-3 {
            // At 1 mm the numerator's constant is known to a third at best.
            assert!(fit.numerator_deviations[0][0][1] > 0.3 * NUMERATOR[1], "{:?}", fit.numerator_deviations[0][0]);
        }
    }
}

#[test]
fn rest_is_found_by_the_test_and_other_orders_and_holds_come_back() {
    let dt = 1e-3;
    let input: Vec<f64> = (0..400).map(|k| noise(k / 5)).collect();
    for (numerator, denominator) in [
        (vec![2.0], vec![1.0, 3.0]),
        (vec![1.0, 400.0], vec![1.0, 20.0, 10_000.0]),
        (vec![3.0, 0.0, 900.0], vec![1.0, 60.0, 5000.0, 90_000.0]),
    ] {
        let n = denominator.len() - 1;
        let clean = simulated(&numerator, &denominator, &input, &vec![0.0; n], dt);
        let size = clean.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
        let output = clean.iter().enumerate().map(|(k, y)| y + 1e-3 * size * noise(k + 5000)).collect();
        let data = IoData::single(input.clone(), output, dt).unwrap();
        let options = TransferFunctionOptions {
            initial: InitialConditions::Auto,
            stable: true,
            ..TransferFunctionOptions::new(n, numerator.len() - 1)
        };
        let fit = transfer_function_fit(&data, &options).unwrap();
        assert!(!fit.search.initial_estimated, "order {n}");
        for ((estimated, exact), deviation) in
            fit.entries[0][0].denominator()[1..].iter().zip(&denominator[1..]).zip(&fit.search.denominator_deviations)
        {
            assert!((estimated - exact).abs() < 4.0 * deviation, "order {n}: {estimated} {exact} +- {deviation}");
        }
    }
}

#[test]
fn every_start_alone_reaches_the_optimum() {
    let data = crash(1e-4);
    let best = transfer_function_fit(&data, &TransferFunctionOptions::new(4, 1)).unwrap().search.losses[0];
    for start in [Start::Svf, Start::Iv, Start::N4sid, Start::Arx, Start::Random] {
        let options = TransferFunctionOptions { starts: vec![start], ..TransferFunctionOptions::new(4, 1) };
        let fit = transfer_function_fit(&data, &options).unwrap();
        println!(
            "{}: loss {:.9e}, {} evaluations, {:?}",
            start.name(),
            fit.search.losses[0],
            fit.search.evaluations,
            fit.search.stop_reason
        );
        // A stationary point to the gradient test; the loss is flat there to its square.
        assert!(fit.search.losses[0] <= best * (1.0 + 1e-9), "{}", start.name());
    }
    let zero_hold = TransferFunctionOptions { hold: Hold::Zero, ..TransferFunctionOptions::new(4, 1) };
    assert!(transfer_function_fit(&data, &zero_hold).unwrap().search.losses[0] > best);
}

#[test]
fn state_space_and_transfer_function_are_the_same() {
    let fit = transfer_function_fit(&crash(1e-4), &TransferFunctionOptions::new(4, 1)).unwrap();
    let again = crumple_numerics::lti::to_transfer_function(&fit.state_space).unwrap();
    for (a, b) in again.denominator().iter().zip(fit.entries[0][0].denominator()) {
        // Rounding of the eigenvalues of a small matrix.
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    let numerator = again.numerator();
    for (a, b) in numerator[numerator.len() - 2..].iter().zip(fit.entries[0][0].numerator()) {
        assert!((a / b - 1.0).abs() < 1e-6, "{numerator:?}");
    }
}

#[test]
fn refuses_what_it_cannot_do() {
    let data = crash(0.0);
    let text = |poles, zeros| {
        transfer_function_fit(&data, &TransferFunctionOptions::new(poles, zeros)).unwrap_err().to_string()
    };
    assert_eq!(
        text(2, 3),
        "3 zeros and 2 poles: a transfer function that can be simulated has no more zeros than poles"
    );
    assert_eq!(text(0, 0), "order 0 is no model");
    assert!(text(60, 1).contains("tfest needs 244"), "{}", text(60, 1));
}
