//! Measured records of other people: DaISy, the database for the identification of systems (De Moor, ESAT/STADIUS, KU
//! Leuven). Models from the first part simulate the second; the tables of our methods are printed side by side.

use crumple_numerics::lti::{StateSpace, discretize_zero_order_hold};
use crumple_sysid::{
    ArxOrder, Criterion, Hold, Horizons, IdentifyError, IoData, Lags, Okid, OkidOptions, Order, OutputErrorOptions,
    Stop, Subspace, SubspaceOptions, TransferFunctionOptions, Weighting, arx, compare, fit_measures, horizons,
    output_error, transfer_function_fit,
};

/// Columns of a text file: `inputs` first, the rest outputs. Mean of the first part removed.
fn record(path: &str, inputs: usize, estimation: usize, dt: f64) -> Option<(IoData, IoData)> {
    let text = std::fs::read_to_string(crumple_testkit::shared(path)?).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split([',', ' ', '\t']).filter_map(|field| field.trim().parse().ok()).collect::<Vec<f64>>())
        .filter(|row| row.len() > inputs)
        .collect();
    let column = |j: usize| rows.iter().map(|row| row[j]).collect::<Vec<f64>>();
    let data =
        IoData::new((0..inputs).map(column).collect(), (inputs..rows[0].len()).map(column).collect(), dt).unwrap();
    let data = data.centred_on_first(estimation);
    Some((data.slice(0, estimation).unwrap(), data.slice(estimation, data.samples()).unwrap()))
}

/// Simulation fit of every output, initial state estimated.
fn fits(model: &StateSpace, data: &IoData) -> Vec<f64> {
    match compare(model, data) {
        Ok(fits) => fits.iter().map(|fit| fit.and_then(|f| f.fit_percent).unwrap_or(f64::NEG_INFINITY)).collect(),
        Err(_) => vec![f64::NEG_INFINITY; data.outputs().len()],
    }
}

fn line(name: &str, fits: &[f64]) {
    let fits: Vec<String> = fits.iter().map(|f| format!("{f:8.2}")).collect();
    println!("{name:<34}{}", fits.join(""));
}

/// Every subspace method at one order; the best fit of the first output.
fn subspace_table(estimation: &IoData, validation: &IoData, orders: &[usize], block_rows: usize) -> f64 {
    let mut best = f64::NEG_INFINITY;
    for weighting in Weighting::ALL {
        let options = SubspaceOptions { weighting, block_rows, direct: true };
        let subspace = Subspace::new(estimation, options).unwrap();
        for (order, result) in orders.iter().zip(subspace.realize_all(orders)) {
            let estimated = fits(&result.unwrap().model, validation);
            line(&format!("{} order {order}, {block_rows} block rows", weighting.name()), &estimated);
            best = best.max(estimated[0]);
        }
    }
    best
}

/// ARX: simulated, and predicted one step ahead, which says much less.
fn arx_line(estimation: &IoData, validation: &IoData, order: ArxOrder) -> f64 {
    let model = arx(estimation, order).unwrap();
    let simulated = fits(&model.state_space().unwrap(), validation);
    let predicted = fit_measures(&validation.outputs()[0], &model.predict(validation)[0]).unwrap();
    let ArxOrder { na, nb, nk } = order;
    line(&format!("arx ({na},{nb},{nk}) simulated | 1 step"), &[simulated[0], predicted.fit_percent.unwrap()]);
    simulated[0]
}

/// Output error: what the models before are starting points for.
fn output_error_line(estimation: &IoData, validation: &IoData, options: OutputErrorOptions) -> f64 {
    let estimated = output_error(estimation, options).unwrap();
    // The delay is applied to the inputs; the first samples of the validation part lack their past.
    let late = |data: &IoData| {
        let shift = |u: &Vec<f64>| -> Vec<f64> {
            std::iter::repeat_n(0.0, options.delay).chain(u[..u.len() - options.delay].iter().copied()).collect()
        };
        IoData::new(data.inputs().iter().map(shift).collect(), data.outputs().to_vec(), data.sample_time_s()).unwrap()
    };
    let (first, second) = (fits(&estimated.model, &late(estimation)), fits(&estimated.model, &late(validation)));
    let name = format!("output error order {}, delay {} | first half", options.order, options.delay);
    line(&name, &[second[0], first[0]]);
    println!(
        "    {} after {} iterations, {} evaluations, losses {:.6?}",
        estimated.stop_reason.name(),
        estimated.iterations,
        estimated.evaluations,
        estimated.losses
    );
    println!("    poles {:.5?}", estimated.model.poles().unwrap().iter().map(|z| (z.re, z.im)).collect::<Vec<_>>());
    second[0]
}

/// A continuous transfer function, its input held between samples, simulated as the sampled model it stands for.
fn transfer_function_line(estimation: &IoData, validation: &IoData, poles: usize, zeros: usize, delay: usize) {
    let options = TransferFunctionOptions { hold: Hold::Zero, delay, ..TransferFunctionOptions::new(poles, zeros) };
    let estimated = transfer_function_fit(estimation, &options).unwrap();
    let model = discretize_zero_order_hold(&estimated.state_space, estimation.sample_time_s()).unwrap();
    let name = format!("tfest {poles} poles, {zeros} zeros, delay {delay} | first half");
    line(&name, &[fits(&model, &validation.delayed(delay))[0], estimated.fits[0].unwrap().fit_percent.unwrap()]);
}

/// OKID at several orders; the best fit of the first output.
fn okid_lines(estimation: &IoData, validation: &IoData, lags: Lags, orders: &[usize]) -> f64 {
    let okid = Okid::new(estimation, OkidOptions::new(lags)).unwrap();
    // The predictor sees the outputs too.
    let seen = validation.inputs().iter().chain(validation.outputs()).cloned().collect();
    let seen = IoData::new(seen, validation.outputs().to_vec(), validation.sample_time_s()).unwrap();
    let one = |order: &usize| {
        let estimated = okid.realize(Order::Given(*order)).unwrap();
        let simulated = fits(&estimated.model, validation)[0];
        let predicted = fits(&estimated.predictor().unwrap(), &seen)[0];
        line(&format!("okid order {order}, {} lags | 1 step", okid.lags), &[simulated, predicted]);
        simulated
    };
    orders.iter().map(one).fold(f64::NEG_INFINITY, f64::max)
}

const BY_AICC: Lags = Lags::Best { highest: 40, criterion: Criterion::Aicc };
const BY_BIC: Lags = Lags::Best { highest: 40, criterion: Criterion::Bic };

#[test]
fn hair_dryer() {
    let Some((estimation, validation)) = record("data/sysid/hair-dryer/dryer.dat", 1, 500, 0.08) else { return };
    let fit = arx_line(&estimation, &validation, ArxOrder { na: 2, nb: 2, nk: 3 });
    // The known figure; ours has two more free initial states, those of the delay, which adds a little.
    assert!((fit - 85.50).abs() < 0.1, "{fit}");
    let best = subspace_table(&estimation, &validation, &[2, 3, 4], 10);
    let okid = [BY_AICC, BY_BIC, Lags::Given(20)].map(|lags| okid_lines(&estimation, &validation, lags, &[3, 4]));
    // In the neighbourhood of the subspace methods, of which OKID is a forerunner: 85.90 was measured.
    assert!(okid[1] > 85.5, "{okid:?}");
    let mut refined = best;
    for (order, delay) in [(2, 2), (3, 2), (4, 2), (3, 1), (4, 1)] {
        let options = OutputErrorOptions { direct: true, delay, ..OutputErrorOptions::new(order) };
        refined = refined.max(output_error_line(&estimation, &validation, options));
    }
    for order in [3, 4] {
        transfer_function_line(&estimation, &validation, order, order - 1, 2);
    }
    assert!(best.max(refined) >= 85.9, "{best} {refined}");
}

#[test]
fn flexible_robot_arm() {
    let path = "data/sysid/flexible-robot-arm/robot_arm.dat";
    let Some((estimation, validation)) = record(path, 1, 512, 1.0) else { return };
    for (na, expected) in [(4, 82.38), (6, 96.60), (8, 97.42)] {
        let fit = arx_line(&estimation, &validation, ArxOrder { na, nb: na + 1, nk: 0 });
        assert!((fit - expected).abs() < 0.02, "{fit} against {expected}");
    }
    subspace_table(&estimation, &validation, &[4, 6, 8], 12);
    let okid = [BY_AICC, BY_BIC, Lags::Given(20)].map(|lags| okid_lines(&estimation, &validation, lags, &[4, 6, 8]));
    // 97.0 was measured, as good as the subspace methods.
    assert!(okid.iter().all(|fit| *fit > 96.4), "{okid:?}");
    let refined = output_error_line(&estimation, &validation, OutputErrorOptions::new(4));
    output_error_line(&estimation, &validation, OutputErrorOptions::new(6));
    transfer_function_line(&estimation, &validation, 4, 4, 0);
    // An independent output-error fit reaches 96.44 from its ARX start.
    assert!(refined >= 96.4, "{refined}");
}

/// Simulation fits of the validation part by an ARX model of all outputs.
fn vector_arx_line(estimation: &IoData, validation: &IoData, lags: usize) -> Vec<f64> {
    let model = arx(estimation, ArxOrder { na: lags, nb: lags + 1, nk: 0 }).unwrap();
    let estimated = fits(&model.state_space().unwrap(), validation);
    line(&format!("arx, {lags} lags, {} states", lags * estimation.outputs().len()), &estimated);
    estimated
}

/// Every subspace method with the horizon whose model simulates the estimation part best, as the stage chooses; fits of
/// the first output of the validation part by method and order.
fn horizon_table(estimation: &IoData, validation: &IoData, orders: &[usize]) -> Vec<f64> {
    let mut all = Vec::new();
    for weighting in Weighting::ALL {
        for &order in orders {
            let Horizons { block_rows: candidates, lags } = horizons(estimation, (2 * order).max(10));
            let of = |block_rows: &usize| {
                let options = SubspaceOptions { weighting, block_rows: *block_rows, direct: true };
                let model = Subspace::new(estimation, options).unwrap().realize(order).unwrap().model;
                (fits(&model, estimation)[0], *block_rows, fits(&model, validation)[0])
            };
            let best = candidates.iter().map(of).reduce(|best, next| if next.0 > best.0 { next } else { best });
            let (_, rows, estimated) = best.unwrap();
            line(&format!("{} order {order}, {rows} of {candidates:?} rows, {lags:?}", weighting.name()), &[estimated]);
            all.push(estimated);
        }
    }
    all
}

#[test]
fn horizons_follow_the_record() {
    let Some((estimation, validation)) = record("data/sysid/hair-dryer/dryer.dat", 1, 500, 0.08) else { return };
    let dryer = horizon_table(&estimation, &validation, &[3, 4]);
    // A short memory, 5 lags by BIC: the ten block rows of before.
    assert!(dryer.iter().all(|fit| *fit > 85.7), "{dryer:?}");
    let path = "data/sysid/flexible-robot-arm/robot_arm.dat";
    let Some((estimation, validation)) = record(path, 1, 512, 1.0) else { return };
    let arm = horizon_table(&estimation, &validation, &[4, 6, 8]);
    // N4SID comes from 63.4 and 88.2 % with twice the order to 72.7 and 96.2 %; the others are within half a percent.
    assert!(arm[0] > 72.0 && arm[1..].iter().all(|fit| *fit > 96.1), "{arm:?}");
}

#[test]
fn okid_of_the_steel_subframe_diverges_and_is_not_passed_on() {
    let path = "data/sysid/steel-subframe-a/steel_subframe_u1u2_y01-y06.csv";
    let Some((estimation, _)) = record(path, 2, 4096, 1.0 / 1024.0) else { return };
    for lags in [20, 30, 40] {
        let result = Okid::new(&estimation, OkidOptions::new(Lags::Given(lags)));
        match &result {
            Ok(okid) => println!("{lags} lags: growth {:.2}, rank {} of {}", okid.growth, okid.rank, okid.regressors),
            Err(error) => println!("{lags} lags: {error}"),
        }
        assert!(matches!(result, Err(IdentifyError::Diverged { .. })), "{lags} lags");
    }
}

#[test]
fn steel_subframe() {
    let path = "data/sysid/steel-subframe-a/steel_subframe_u1u2_y01-y06.csv";
    let Some((estimation, validation)) = record(path, 2, 4096, 1.0 / 1024.0) else { return };
    let mut at_30 = Vec::new();
    for weighting in Weighting::ALL {
        let options = SubspaceOptions { weighting, block_rows: 25, direct: true };
        let subspace = Subspace::new(&estimation, options).unwrap();
        for (order, result) in [20, 30].iter().zip(subspace.realize_all(&[20, 30])) {
            let estimated = fits(&result.unwrap().model, &validation);
            line(&format!("{} order {order}", weighting.name()), &estimated);
            if weighting == Weighting::N4sid {
                at_30 = estimated;
            }
        }
    }
    for lags in [5, 10, 20] {
        vector_arx_line(&estimation, &validation, lags);
    }
    // The third output alone, which then has the order of the whole structure. Ten iterations: the rest gains little.
    let one = |data: &IoData| {
        IoData::new(data.inputs().to_vec(), vec![data.outputs()[2].clone()], data.sample_time_s()).unwrap()
    };
    let model = arx(&one(&estimation), ArxOrder { na: 30, nb: 31, nk: 0 }).unwrap().state_space().unwrap();
    line("arx (30,31,0) of output 3 alone", &fits(&model, &one(&validation)));
    let stop = Stop { max_iterations: 10, ..Stop::default() };
    let options = OutputErrorOptions { random_starts: 0, stop, ..OutputErrorOptions::new(30) };
    let estimated = output_error(&one(&estimation), options).unwrap();
    line("output error order 30 of output 3 alone", &fits(&estimated.model, &one(&validation)));
    let mean = at_30.iter().sum::<f64>() / 6.0;
    println!("mean of n4sid order 30: {mean:.2}");
    // nfoursid with the same horizon and order: 91.95 in the mean, from 84.21 (the third output) to 95.94.
    assert!(mean >= 92.0 && at_30.iter().all(|fit| *fit >= 84.21), "{at_30:?}");
    // The aim is 92 % on one output and 80 % on another: five of the six reach 92, the third, worst of all toolboxes,
    // 91.8.
    let others = at_30.iter().enumerate().filter(|(i, _)| *i != 2);
    assert!(others.clone().count() == 5 && others.clone().all(|(_, fit)| *fit >= 92.0), "{at_30:?}");
}
