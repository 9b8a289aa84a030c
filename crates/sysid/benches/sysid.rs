//! Times the estimators beside a plain pass over the same data and, where there is one, the naive version:
//! `cargo bench -p crumple-sysid`.

use std::hint::black_box;

use crumple_numerics::lti::{StateSpace, discretize_first_order_hold};
use crumple_sysid::{
    ArxOrder, Criterion, Era, EraOptions, IoData, Lags, MarkovParameters, Okid, OkidOptions, Order, OutputErrorOptions,
    Start, Stop, Subspace, SubspaceOptions, TransferFunctionOptions, Weighting, arx, output_error,
    transfer_function_fit,
};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};
use nalgebra::{DMatrix, DVector};

/// One figure beside a memory pass over the same data.
fn figure(name: &str, seconds: f64, data: &[f64]) -> Figure {
    Figure::new(name, seconds, memory_pass_s(data))
}

/// Peak of resident memory while something is done, MiB above what was there before; where the system tells it.
fn peak_mib(work: impl FnOnce()) -> Option<f64> {
    let entry = |name: &str| -> Option<f64> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix(name))?;
        line.trim().trim_end_matches("kB").trim().parse::<f64>().ok().map(|kib| kib / 1024.0)
    };
    // Sets the high-water mark back to what is resident now.
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    let before = entry("VmRSS:")?;
    work();
    Some(entry("VmHWM:")? - before)
}

fn noise(k: usize) -> f64 {
    crumple_testkit::uniform(k as u64)
}

fn era_times() {
    let wave = |t: f64| (-30.0 * t).exp() * (60.0 * t).sin() + 0.2 * (-12.0 * t).exp() * (400.0 * t).cos();
    for (samples, aim_s, peer) in [(2501, 2e-3, "scipy 3.5 ms"), (10_001, 6e-3, "")] {
        for (kind, level) in [("clean", 0.0), ("1 % noise", 0.01)] {
            let record: Vec<f64> = (0..samples).map(|k| wave(k as f64 * 1e-4) + level * noise(k)).collect();
            let time = best_s(|| {
                let model = Era::new(&record, EraOptions::new(1e-4), &[Order::Given(4)])
                    .and_then(|era| era.realize(Order::Given(4)));
                black_box(model).ok();
            });
            let name = format!("ERA order 4, {samples} samples, {kind}");
            figure(&name, time, &record).aim(aim_s, if level > 0.0 { peer } else { "" }).print();
        }
    }
    for samples in [25_001, 100_001, 400_001] {
        let record: Vec<f64> = (0..samples).map(|k| wave(k as f64 * 1e-4) + 0.01 * noise(k)).collect();
        let peak = peak_mib(|| {
            let model = Era::new(&record, EraOptions::new(1e-4), &[Order::Given(4)])
                .and_then(|era| era.realize(Order::Given(4)));
            black_box(model).ok();
        });
        if let Some(mib) = peak {
            let record_mib = record.len() as f64 / 131_072.0;
            println!(
                "    era order 4, {samples} samples: peak memory {mib:.1} MiB, {:.1} x the record",
                mib / record_mib
            );
        }
    }
    // The larger of the named sizes, 5000 x 5000, takes minutes and a fifth of a GiB.
    for size in [400, 1250] {
        let record: Vec<f64> = (0..=2 * size).map(|k| wave(k as f64 * 1e-4) + 0.01 * noise(k)).collect();
        let once = || {
            let h = DMatrix::from_fn(size, size, |i, j| record[1 + i + j]);
            black_box(h.svd(true, true));
        };
        let time = best_s(once);
        figure(&format!("    naive: dense SVD of {size} x {size} ({} samples)", 2 * size + 1), time, &record).print();
    }
}

/// Output of a stable fourth-order ARX model, with noise in the equation.
fn arx_data(samples: usize) -> IoData {
    let u: Vec<f64> = (0..samples).map(noise).collect();
    let mut y = vec![0.0; samples];
    for k in 4..samples {
        y[k] = 2.6 * y[k - 1] - 3.0 * y[k - 2] + 1.8 * y[k - 3] - 0.5 * y[k - 4] + 0.5 * u[k - 1] + 0.2 * u[k - 2]
            - 0.1 * u[k - 3]
            + 0.05 * u[k - 4]
            + 0.1 * noise(k + samples);
    }
    IoData::single(u, y, 1e-3).expect("a finite record")
}

fn arx_times() {
    let data = arx_data(1_000_000);
    let time = best_s(|| {
        black_box(arx(&data, ArxOrder { na: 4, nb: 4, nk: 1 })).ok();
    });
    figure("ARX (4,4,1), 10^6 samples", time, &data.outputs()[0]).aim(20e-3, "").print();
    let (y, u) = (&data.outputs()[0], &data.inputs()[0]);
    let time = best_s(|| {
        let regressors = DMatrix::from_fn(y.len() - 4, 8, |i, j| if j < 4 { y[i + 3 - j] } else { u[i + 7 - j] });
        let qr = regressors.qr();
        black_box(qr.r().solve_upper_triangular(&qr.q().tr_mul(&DVector::from_column_slice(&y[4..]))));
    });
    figure("    naive: whole matrix by QR, 10^6 samples", time, y).print();
}

fn subspace_times() {
    let data = arx_data(10_000);
    for weighting in Weighting::ALL {
        let options = SubspaceOptions { weighting, block_rows: 8, direct: true };
        let time = best_s(|| {
            black_box(Subspace::new(&data, options).and_then(|subspace| subspace.realize(4))).ok();
        });
        let name = format!("{} order 4, 8 block rows, 10^4 samples", weighting.name());
        figure(&name, time, &data.outputs()[0]).aim(2e-3, "").print();
    }
    let (y, u) = (&data.outputs()[0], &data.inputs()[0]);
    let time = best_s(|| {
        let rows = y.len() - 15;
        let hankel = DMatrix::from_fn(rows, 32, |k, j| match j {
            0..8 => u[k + j + 8],
            8..16 => u[k + j - 8],
            _ => y[k + j - 16],
        });
        black_box(hankel.qr().r());
    });
    figure("    naive: block Hankel matrix formed, dense QR alone", time, y).print();
}

fn era_sensor_times() {
    let wave = |t: f64| (-30.0 * t).exp() * (60.0 * t).sin() + 0.2 * (-12.0 * t).exp() * (400.0 * t).cos();
    let sensors: Vec<Vec<f64>> = (0..4)
        .map(|s| (0..2501).map(|k| wave((k + 20 * s) as f64 * 1e-4) + 0.01 * noise(k + 9 * s)).collect())
        .collect();
    let time = best_s(|| {
        let markov = MarkovParameters::new(sensors.iter().map(Vec::as_slice).collect(), 1);
        let order = Order::Given(4);
        black_box(markov.and_then(|markov| Era::from_markov(markov, EraOptions::new(1e-4), &[order])?.realize(order)))
            .ok();
    });
    figure("ERA order 4, 4 sensors of 2501 samples, 1 % noise", time, &sensors[0]).print();
}

fn okid_times() {
    let data = arx_data(10_000);
    for (name, lags) in [
        ("20 lags", Lags::Given(20)),
        ("lags by AICc of 1 to 20", Lags::Best { highest: 20, criterion: Criterion::Aicc }),
    ] {
        let time = best_s(|| {
            let model = Okid::new(&data, OkidOptions::new(lags)).and_then(|okid| okid.realize(Order::Given(4)));
            black_box(model).ok();
        });
        figure(&format!("OKID order 4, {name}, 10^4 samples"), time, &data.outputs()[0]).aim(2e-3, "").print();
    }
    let (y, u) = (&data.outputs()[0], &data.inputs()[0]);
    let time = best_s(|| {
        let regressors = DMatrix::from_fn(y.len() - 20, 41, |i, j| match j {
            0 => u[i + 20],
            j if j % 2 == 1 => u[i + 20 - j.div_ceil(2)],
            j => y[i + 20 - j / 2],
        });
        let target = DVector::from_column_slice(&y[20..]);
        let qr = regressors.qr();
        black_box(qr.r().solve_upper_triangular(&qr.q().tr_mul(&target)));
    });
    figure("    naive: whole matrix by QR, the regression alone", time, y).print();
}

fn transfer_function_times() {
    // Two modes, sampled at 10 kHz, a pulse and a motion at the start.
    let denominator = [1.0, 35.7, 6024.0, 185_000.0, 414_600.0];
    let (unit, dt) = (0.02_f64, 1e-4);
    let power = |k: usize| (0..k).fold(1.0, |product, _| product * unit);
    let a = DMatrix::from_fn(4, 4, |i, j| {
        if i < 3 { f64::from(u8::from(j == i + 1)) } else { -denominator[4 - j] * power(4 - j) }
    });
    let b = DMatrix::from_fn(4, 1, |i, _| f64::from(u8::from(i == 3)));
    let c = DMatrix::from_fn(1, 4, |_, j| [466.2, -76.15, 0.0, 0.0][j] * power(4 - j));
    let model = StateSpace::new(a, b, c, DMatrix::zeros(1, 1), None).expect("a finite model");
    let discrete = discretize_first_order_hold(&model, dt / unit).expect("a small step");
    let u: Vec<f64> = (0..2001).map(|k| -300.0 * (f64::from(k) * 0.0028).sin().max(0.0)).collect();
    let clean = discrete.response(&u, &DVector::from_vec(vec![0.0, 50.0, 0.0, 0.0])).expect("four states");
    let size = clean.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
    let y = clean.iter().enumerate().map(|(k, y)| y + 1e-4 * size * noise(k)).collect();
    let data = IoData::single(u, y, dt).expect("a finite record");
    let options = TransferFunctionOptions::new(4, 1);
    let whole = best_s(|| {
        black_box(transfer_function_fit(&data, &options)).ok();
    });
    figure("tfest 4/1, 2001 samples, whole fit", whole, &data.outputs()[0]).aim(50e-3, "").print();
    let fit = transfer_function_fit(&data, &options).expect("the fit timed before");
    let near: Vec<_> = fit.modes.iter().map(|mode| mode.pole * 1.05).collect();
    let one = TransferFunctionOptions { starts: Vec::new(), given: vec![near], ..options.clone() };
    let time = best_s(|| {
        black_box(transfer_function_fit(&data, &one)).ok();
    });
    figure("tfest 4/1, one refinement, with covariance", time, &data.outputs()[0]).aim(1e-3, "scipy 5.6 ms").print();
    naive_iteration(&data, &fit.state_space);
    for start in [Start::Svf, Start::Iv, Start::N4sid] {
        let one = TransferFunctionOptions { starts: vec![start], ..options.clone() };
        let time = best_s(|| {
            black_box(transfer_function_fit(&data, &one)).ok();
        });
        figure(&format!("tfest 4/1, start {} alone", start.name()), time, &data.outputs()[0]).print();
    }
}

/// One Gauss-Newton step the plain way: all ten unknowns by differences, each of a whole simulation, and a dense SVD.
fn naive_iteration(data: &IoData, model: &StateSpace) {
    let (u, y, dt) = (&data.inputs()[0], &data.outputs()[0], data.sample_time_s());
    let simulate = |change: usize, by: f64| {
        let mut model = model.clone();
        let mut start = DVector::zeros(4);
        match change {
            0..4 => start[change] = by,
            4..6 => model.c[change - 4] += by,
            k => model.a[(k - 6, 0)] += by,
        }
        discretize_first_order_hold(&model, dt).and_then(|held| held.response(u, &start)).unwrap_or_default()
    };
    let time = best_s(|| {
        let rest = simulate(0, 0.0);
        let columns: Vec<Vec<f64>> =
            (0..10).map(|k| simulate(k, 1e-6).iter().zip(&rest).map(|(a, b)| (a - b) / 1e-6).collect()).collect();
        let jacobian = DMatrix::from_fn(y.len(), columns.len(), |i, j| columns[j][i]);
        let target = DVector::from_iterator(y.len(), y.iter().zip(&rest).map(|(y, yh)| y - yh));
        black_box(jacobian.svd(true, true).solve(&target, 1e-12)).ok();
    });
    figure("    naive: one step, ten unknowns by differences, SVD", time, y).print();
}

fn output_error_times() {
    let data = arx_data(1000);
    let whole = OutputErrorOptions::new(4);
    let time = best_s(|| {
        black_box(output_error(&data, whole)).ok();
    });
    figure("output error order 4, 1000 samples, all starts", time, &data.outputs()[0]).print();
    // The continuous starts of output error are those of tfest by refined instrumental variables.
    let options = TransferFunctionOptions {
        starts: vec![Start::Iv],
        stop: Stop { max_iterations: 0, ..Stop::default() },
        ..TransferFunctionOptions::new(4, 4)
    };
    let time = best_s(|| {
        black_box(transfer_function_fit(&data, &options)).ok();
    });
    figure("    of it: starts by refined instrumental variables", time, &data.outputs()[0]).print();
}

fn main() {
    // `cargo bench -p crumple-sysid -- era` runs the groups whose name contains the word.
    let only = std::env::args().skip(1).find(|word| !word.starts_with('-')).unwrap_or_default();
    let groups: [(&str, fn()); 7] = [
        ("era", era_times),
        ("era-sensors", era_sensor_times),
        ("okid", okid_times),
        ("arx", arx_times),
        ("subspace", subspace_times),
        ("tfest", transfer_function_times),
        ("output-error", output_error_times),
    ];
    for (_, group) in groups.iter().filter(|(name, _)| name.contains(&only)) {
        group();
    }
}
