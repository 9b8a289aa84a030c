//! ERA on several sensors and several impulses at once: a system that is known is given back.

use crumple_numerics::lti::{Complex, StateSpace, discretize_zero_order_hold};
use crumple_sysid::{Era, EraOptions, MarkovParameters, Order, markov_parameters, modal_assurance, phase_collinearity};
use crumple_testkit::white_noise;
use nalgebra::DMatrix;

const DT_S: f64 = 1e-3;

/// Three masses in a row between walls, springs and light dampers: accelerometers on all, forces on the first `inputs`.
fn chain(inputs: usize) -> StateSpace {
    let stiffness = DMatrix::from_fn(3, 3, |i, j| match i.abs_diff(j) {
        0 => 8e4,
        1 => -4e4,
        _ => 0.0,
    });
    let mass = [4.0, 5.0, 7.0];
    let a = DMatrix::from_fn(6, 6, |i, j| match (i < 3, j < 3) {
        (true, true) => 0.0,
        (true, false) => f64::from(u8::from(j == i + 3)),
        (false, true) => -stiffness[(i - 3, j)] / mass[i - 3],
        (false, false) => -3e-4 * stiffness[(i - 3, j - 3)] / mass[i - 3],
    });
    let b = DMatrix::from_fn(6, inputs, |i, j| if i == j + 3 { 1.0 / mass[j] } else { 0.0 });
    let c = a.rows(3, 3).into_owned();
    let d = b.rows(3, 3).into_owned();
    discretize_zero_order_hold(&StateSpace::new(a, b, c, d, None).unwrap(), DT_S).unwrap()
}

fn worst(estimated: &[Complex], truth: &[Complex]) -> f64 {
    truth
        .iter()
        .map(|t| estimated.iter().map(|f| (f - t).norm()).fold(f64::INFINITY, f64::min) / t.norm())
        .fold(0.0, f64::max)
}

#[test]
fn poles_response_and_shapes_of_every_block_size_come_back() {
    for inputs in [1, 2, 3] {
        let truth = chain(inputs);
        // 30 samples: the dense way. 600: Lanczos.
        for samples in [31, 601] {
            let records = markov_parameters(&truth, samples);
            let markov = MarkovParameters::new(records.iter().map(Vec::as_slice).collect(), inputs).unwrap();
            let options = EraOptions::new(DT_S);
            let model =
                Era::from_markov(markov, options, &[Order::Given(6)]).unwrap().realize(Order::Given(6)).unwrap();
            assert_eq!((model.discrete.c.nrows(), model.discrete.b.ncols()), (3, inputs));
            let error = worst(&model.discrete.poles().unwrap(), &truth.poles().unwrap());
            // Rounding, times the ratio of the first to the sixth singular value, up to 1e3 for 30 samples.
            assert!(error < 1e-11, "{inputs} inputs, {samples} samples: {error:e}");
            assert!(model.fit_percent.unwrap() > 100.0 - 1e-8, "{:?}", model.fit_percent);
            assert_eq!(model.sequence_fits_percent.len(), 3 * inputs);
            for mode in &model.modes {
                assert!(mode.modal_amplitude_coherence.unwrap() > 1.0 - 1e-8, "{mode:?}");
            }
        }
    }
}

#[test]
fn shapes_are_those_of_the_structure() {
    let truth = chain(1);
    let records = markov_parameters(&truth, 800);
    let markov = MarkovParameters::new(records.iter().map(Vec::as_slice).collect(), 1).unwrap();
    let order = Order::Given(6);
    let model = Era::from_markov(markov, EraOptions::new(DT_S), &[order]).unwrap().realize(order).unwrap();
    // Damping proportional to stiffness: undamped shapes, the eigenvectors of M⁻¹ K.
    let operator = nalgebra::dmatrix![
        2e4, -1e4, 0.0;
        -8e3, 1.6e4, -8e3;
        0.0, -4e4 / 7.0, 8e4 / 7.0
    ];
    for (i, mode) in model.modes.iter().enumerate().filter(|(_, mode)| mode.discrete_pole.im > 0.0) {
        let shape = model.mode_shapes[i].as_ref().unwrap();
        let undamped = mode.mode.unwrap().natural_frequency_rad_per_s.powi(2);
        let real: Vec<f64> = shape.iter().map(|x| x.re).collect();
        let residual =
            &operator * DMatrix::from_column_slice(3, 1, &real) - DMatrix::from_column_slice(3, 1, &real) * undamped;
        // Poles and shapes good to 1e-9, times the largest eigenvalue.
        assert!(residual.norm() < 1e-8 * undamped, "{shape:?} {residual}");
        assert!(shape.iter().any(|x| (x - Complex::from(1.0)).norm() < 1e-15));
        assert!(phase_collinearity(shape).unwrap() > 1.0 - 1e-12);
    }
    let first = model.mode_shapes[0].as_ref().unwrap();
    let other = model.mode_shapes[4].as_ref().unwrap();
    assert!(modal_assurance(first, other).unwrap() < 0.5);
}

#[test]
fn several_sensors_find_weak_modes_better_than_one() {
    let truth = chain(1);
    let clean = markov_parameters(&truth, 801);
    let size = clean[0].iter().fold(0.0_f64, |m, y| m.max(y.abs()));
    let poles = truth.poles().unwrap();
    let order = Order::Given(6);
    let errors = |sensors: &[usize], seed: usize| {
        let records: Vec<Vec<f64>> = sensors
            .iter()
            .map(|i| clean[*i].iter().enumerate().map(|(k, y)| y + 0.02 * size * white_noise(seed + i, k)).collect())
            .collect();
        let markov = MarkovParameters::new(records.iter().map(Vec::as_slice).collect(), 1).unwrap();
        let model = Era::from_markov(markov, EraOptions::new(DT_S), &[order]).unwrap().realize(order).unwrap();
        worst(&model.discrete.poles().unwrap(), &poles)
    };
    let median = |sensors: &[usize]| {
        let mut all: Vec<f64> = (0..9).map(|seed| errors(sensors, 10 * seed)).collect();
        all.sort_by(f64::total_cmp);
        all[4]
    };
    let (alone, together) = (median(&[2]), median(&[0, 1, 2]));
    println!("median of worst pole errors over 9 records: one sensor {alone:.2e}, three {together:.2e}");
    assert!(together < alone, "{together} {alone}");
}

#[test]
fn wrong_shapes_are_refused() {
    let y = [1.0, 0.5, 0.25];
    assert!(MarkovParameters::new(vec![&y, &y, &y], 2).is_err());
    let error = MarkovParameters::new(vec![&y, &y[..2]], 1).unwrap_err().to_string();
    assert_eq!(error, "sequence 2 has 2 samples, the first has 3");
    assert!(MarkovParameters::new(Vec::new(), 1).is_err());
}
