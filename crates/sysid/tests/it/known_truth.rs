//! ERA on every record of known modes: the folders `era-*` of the reference material, and others made here.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crumple_numerics::lti::Complex;
use crumple_sysid::{EraOptions, Order, Realization, era};
use nalgebra::DMatrix;
use serde_json::{Value, json};

/// What is asked for without noise, relative to the pole.
const CLEAN: f64 = 1e-9;

/// The folder of records with known truth: `CRUMPLE_KNOWN_TRUTH`, else the shared material.
fn known_truth() -> Option<PathBuf> {
    match std::env::var_os("CRUMPLE_KNOWN_TRUTH") {
        Some(folder) => Some(folder.into()),
        None => crumple_testkit::shared("reference/known-truth"),
    }
}

/// A record and what is known of it.
struct Known {
    /// From time zero on: the first is `D`.
    samples: Vec<f64>,
    dt_s: f64,
    poles: Vec<Complex>,
    noisy: bool,
    /// Poles that a plain ERA finds.
    references: Vec<Reference>,
    /// Checks that `truth.json` says too little for.
    skipped: Vec<String>,
}

struct Reference {
    rows: usize,
    columns: usize,
    error: f64,
    poles: Vec<Complex>,
    singular_values: Vec<f64>,
}

fn number(value: &Value) -> Option<f64> {
    value.as_f64().filter(|x| x.is_finite())
}

fn size(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

fn list<T>(value: &Value, of: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
    value.as_array()?.iter().map(of).collect()
}

fn pole(value: &Value) -> Option<Complex> {
    Some(Complex::new(number(&value["re"])?, number(&value["im"])?))
}

/// All poles: those listed, else those of the modes, each with its conjugate.
fn true_poles(truth: &Value) -> Option<Vec<Complex>> {
    let mode = |m: &Value| Some(Complex::new(number(&m["sigma"])?, number(&m["omega"])?));
    let listed = list(&truth["expected"]["poles"], pole).or_else(|| list(&truth["parameters"]["modes"], mode))?;
    let lacking: Vec<Complex> =
        listed.iter().filter(|s| s.im != 0.0).map(Complex::conj).filter(|s| !listed.contains(s)).collect();
    Some([listed, lacking].concat())
}

/// Times and values of a file of two columns.
fn columns(csv: &str) -> Result<Vec<(f64, f64)>, String> {
    let rows = csv.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty()).skip(1);
    rows.map(|line| {
        let (time, value) = line.split_once(',')?;
        let value = value.split(',').next()?;
        Some((time.trim().parse().ok()?, value.trim().parse().ok()?))
    })
    .enumerate()
    .map(|(k, row)| row.ok_or(format!("accel.csv: row {} below its header is not two numbers", k + 1)))
    .collect()
}

fn load(folder: &Path) -> Result<Known, String> {
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).map_err(|error| format!("{file}: {error}"));
    let truth: Value = serde_json::from_str(&read("truth.json")?).map_err(|error| format!("truth.json: {error}"))?;
    let rows = columns(&read("accel.csv")?)?;
    if rows.len() < 3 {
        return Err(format!("accel.csv has {} samples", rows.len()));
    }
    let mut skipped = Vec::new();
    let step = (rows[rows.len() - 1].0 - rows[0].0) / (rows.len() - 1) as f64;
    let dt_s = match number(&truth["sampling"]["rate_hz"]) {
        Some(rate) => 1.0 / rate,
        None => {
            skipped.push("sampling.rate_hz against the times".to_owned());
            step
        }
    };
    // Printed times are coarse, but not by a thousandth over the record.
    if (step / dt_s - 1.0).abs() > 1e-3 {
        return Err(format!("accel.csv has steps of {step} s, truth.json of {dt_s} s"));
    }
    let by_time = rows.iter().position(|(time, _)| *time > -dt_s / 2.0).ok_or("accel.csv ends before time zero")?;
    let trigger = size(&truth["sampling"]["trigger_sample_index"]);
    if trigger.is_none() {
        skipped.push("sampling.trigger_sample_index against the times".to_owned());
    }
    if trigger.is_some_and(|index| index != by_time) {
        return Err(format!("time zero is sample {by_time} of accel.csv, {trigger:?} of truth.json"));
    }
    let poles = true_poles(&truth).ok_or("truth.json has neither expected.poles nor parameters.modes")?;
    match size(&truth["expected"]["order"]) {
        Some(order) if order != poles.len() => {
            return Err(format!("expected.order is {order}, there are {} poles", poles.len()));
        }
        Some(_) => {}
        None => skipped.push("expected.order against the number of poles".to_owned()),
    }
    let noise = &truth["noise"];
    let level = number(&noise["sigma_g"]).or_else(|| number(&noise["fraction_of_peak"]));
    if !noise.is_null() && level.is_none() {
        return Err("noise has neither sigma_g nor fraction_of_peak".to_owned());
    }
    // Before time zero there is nothing else.
    let before: Vec<f64> = rows[..by_time].iter().map(|row| row.1).collect();
    let square = before.iter().map(|x| x * x).sum::<f64>() / before.len().max(1) as f64;
    match number(&noise["sigma_g"]).filter(|_| before.len() >= 50 && square > 0.0) {
        // 50 samples know their deviation to 10 %.
        Some(sigma) if (square.sqrt() / sigma - 1.0).abs() > 0.5 => {
            return Err(format!("noise.sigma_g is {sigma}, before time zero the record has {}", square.sqrt()));
        }
        Some(_) => {}
        None => skipped.push("level of the noise before time zero".to_owned()),
    }
    let samples: Vec<f64> = rows[by_time..].iter().map(|row| row.1).collect();
    let mut references = Vec::new();
    for (k, stated) in truth["reference_era_recovery"].as_array().into_iter().flatten().enumerate() {
        let half = || size(&stated["markov_parameters_used"]).map(|n| n / 2);
        let rows = size(&stated["alpha"]).or_else(half);
        let columns = size(&stated["beta"]).or_else(half);
        let Some((rows, columns, error)) = rows
            .zip(columns)
            .zip(number(&stated["max_relative_pole_error"]))
            .map(|((rows, columns), e)| (rows, columns, e))
        else {
            skipped.push(format!("reference recovery {}: no size, or no error", k + 1));
            continue;
        };
        references.push(Reference {
            rows,
            columns,
            error,
            poles: list(&stated["continuous_poles"], pole).unwrap_or_default(),
            singular_values: list(&stated["first_singular_values"], number).unwrap_or_default(),
        });
    }
    if references.is_empty() {
        skipped.push("reference_era_recovery: sizes of Hankel matrices".to_owned());
    }
    let noisy = level.is_some_and(|level| level > 0.0);
    Ok(Known { samples, dt_s, poles, noisy, references, skipped })
}

/// Largest distance of a true pole to the nearest found one, relative to the true one: what the reference states.
fn nearest_error(estimated: &[Complex], truth: &[Complex]) -> f64 {
    let nearest = |t: &Complex| estimated.iter().map(|f| (f - t).norm()).fold(f64::INFINITY, f64::min) / t.norm();
    truth.iter().map(nearest).fold(0.0, f64::max)
}

/// The same to a found one of its own: the closest pairs first. Of two poles near each other one alone is not enough.
fn own_error(estimated: &[Complex], truth: &[Complex]) -> f64 {
    let mut pairs: Vec<(f64, usize, usize)> = truth
        .iter()
        .enumerate()
        .flat_map(|(i, t)| estimated.iter().enumerate().map(move |(j, f)| ((f - t).norm() / t.norm(), i, j)))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut errors, mut used) = (vec![f64::INFINITY; truth.len()], vec![false; estimated.len()]);
    for (error, i, j) in pairs {
        if errors[i].is_infinite() && !used[j] {
            errors[i] = error;
            used[j] = true;
        }
    }
    errors.into_iter().fold(0.0, f64::max)
}

fn identify(known: &Known, size: Option<(usize, usize)>) -> Result<(Vec<Complex>, Realization), String> {
    let options = EraOptions {
        order: Order::Given(known.poles.len()),
        rows: size.map(|s| s.0),
        columns: size.map(|s| s.1),
        ..EraOptions::new(known.dt_s)
    };
    let model = era(&known.samples, options).map_err(|error| error.to_string())?;
    Ok((model.modes.iter().filter_map(|m| Some(m.mode?.pole)).collect(), model))
}

/// The whole record and every size of the reference. Returns what was found, line by line.
fn check(folder: &Path) -> Result<String, String> {
    let known = load(folder)?;
    let order = known.poles.len();
    let mut report = String::new();
    let (estimated, _) = identify(&known, None)?;
    let whole = (if known.noisy { nearest_error } else { own_error })(&estimated, &known.poles);
    let _infallible =
        write!(report, "{} samples of {} s, order {order}, whole record {whole:.1e}", known.samples.len(), known.dt_s);
    let mut stated: Vec<f64> = known.references.iter().map(|reference| reference.error).collect();
    stated.sort_by(f64::total_cmp);
    match (known.noisy, stated.get(stated.len() / 2)) {
        (false, _) if whole > CLEAN => return Err(format!("whole record: {whole:e}, asked for {CLEAN:e}")),
        // By default all samples count: no worse than the reference with its middle size. (With its best size chance
        // has a say: of a record that has decayed into noise the rest adds nothing but that.)
        (true, Some(middle)) if whole > *middle => {
            return Err(format!("whole record: {whole:e}, the reference with its middle size {middle:e}"));
        }
        (true, None) => report.push_str("; SKIPPED: no recovery stated to compare noise with"),
        _ => {}
    }
    for reference in &known.references {
        let Reference { rows, columns, error: stated, .. } = *reference;
        let (estimated, model) =
            identify(&known, Some((rows, columns))).map_err(|e| format!("{rows}x{columns}: {e}"))?;
        let error = nearest_error(&estimated, &known.poles);
        let _infallible = write!(report, "; {rows}x{columns} {error:.2e} (reference {stated:.2e})");
        // The same algorithm: equal but for rounding, which the ratio of the singular values amplifies.
        let values = &model.singular_values;
        let rounding = 100.0 * f64::EPSILON * values[0] / values[order - 1];
        let limit = if known.noisy { stated * (1.0 + 1e-6) + rounding } else { stated.max(CLEAN) };
        if error > limit {
            return Err(format!("{rows}x{columns}: {error:e}, the reference has {stated:e}"));
        }
        // Poles of the reference itself, where they are defined: not artefacts of sampling.
        let defined = |s: &Complex| s.im != 0.0 && s.im.abs() < 0.9 * PI / known.dt_s;
        if reference.poles.len() == order && reference.poles.iter().all(defined) {
            let apart = nearest_error(&estimated, &reference.poles);
            if apart > 1e-6 {
                return Err(format!("{rows}x{columns}: {apart:e} from the poles of the reference"));
            }
        }
        for (k, (value, stated)) in values.iter().zip(&reference.singular_values).take(order).enumerate() {
            if (value - stated).abs() > 1e-12 * values[0] {
                return Err(format!("{rows}x{columns}: singular value {} is {value}, stated is {stated}", k + 1));
            }
        }
    }
    for skipped in &known.skipped {
        let _infallible = write!(report, "; SKIPPED: {skipped}");
    }
    Ok(report)
}

/// Checks all folders `era-*`. Errors: every one that is not understood or not good enough, by name.
fn walk(folder: &Path) -> Result<usize, String> {
    let entries = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut folders: Vec<PathBuf> = entries
        .filter_map(|e| Some(e.ok()?.path()))
        .filter(|path| path.is_dir() && name(path).starts_with("era-"))
        .collect();
    folders.sort();
    if folders.is_empty() {
        return Err(format!("{} holds no folder era-*", folder.display()));
    }
    let mut failures = Vec::new();
    for folder in &folders {
        match check(folder) {
            Ok(report) => println!("{}: {report}", name(folder)),
            Err(error) => failures.push(format!("{}: {error}", name(folder))),
        }
    }
    if failures.is_empty() { Ok(folders.len()) } else { Err(failures.join("\n")) }
}

#[test]
fn every_record_of_known_modes_gives_its_poles_back() {
    let Some(folder) = known_truth() else { return };
    walk(&folder).unwrap_or_else(|failures| panic!("{failures}"));
}

/// White noise by place, uniform with variance 1.
fn noise(k: usize) -> f64 {
    let mut x = (k as u64).wrapping_add(77).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 32;
    x = x.wrapping_mul(0xD6E8_FEB8_6659_FD93);
    x ^= x >> 32;
    ((x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * 3.0_f64.sqrt()
}

/// Poles of ERA with everything formed.
fn formed_era(samples: &[f64], dt_s: f64, order: usize, (rows, columns): (usize, usize)) -> Vec<Complex> {
    let hankel = |shift: usize| DMatrix::from_fn(rows, columns, |i, j| samples[1 + i + j + shift]);
    let svd = hankel(0).svd(true, true);
    let root = |i: usize| svd.singular_values[i].sqrt();
    let shifted = svd.u.unwrap().tr_mul(&hankel(1)) * svd.v_t.unwrap().transpose();
    let a = DMatrix::from_fn(order, order, |i, j| shifted[(i, j)] / (root(i) * root(j)));
    a.complex_eigenvalues().iter().map(|z| z.ln() / dt_s).collect()
}

/// A folder as the reference material has them: `(sigma, omega, amplitude, phase)` of every mode, `omega` 0 for a real
/// pole; the sizes are those of recoveries.
fn write(folder: &Path, name: &str, modes: &[[f64; 4]], dt_s: f64, level: f64, sizes: &[(usize, usize)]) {
    const BEFORE: usize = 100;
    let clean = |k: usize| {
        let t = k as f64 * dt_s;
        modes.iter().map(|[re, im, size, phase]| size * (re * t).exp() * (im * t + phase).cos()).sum::<f64>()
    };
    let peak = (0..2001).map(|k| clean(k).abs()).fold(0.0, f64::max);
    let sigma = level * peak;
    let values: Vec<f64> =
        (0..BEFORE + 2001).map(|k| k.checked_sub(BEFORE).map_or(0.0, clean) + sigma * noise(k)).collect();
    let mut csv = "# made here\ntime_s,accel_g\n".to_owned();
    for (k, value) in values.iter().enumerate() {
        let _infallible = writeln!(csv, "{},{value:e}", (k as f64 - BEFORE as f64) * dt_s);
    }
    let known = |[re, im, ..]: &[f64; 4]| {
        let s = Complex::new(*re, *im);
        if *im == 0.0 { vec![s] } else { vec![s, s.conj()] }
    };
    let poles: Vec<Complex> = modes.iter().flat_map(known).collect();
    let record = |s: &Complex| json!({ "re": s.re, "im": s.im });
    let recoveries: Vec<Value> = sizes
        .iter()
        .map(|&(rows, columns)| {
            let estimated = formed_era(&values[BEFORE..], dt_s, poles.len(), (rows, columns));
            json!({ "alpha": rows, "beta": columns, "max_relative_pole_error": nearest_error(&estimated, &poles) })
        })
        .collect();
    let mut truth = json!({
        "sampling": { "rate_hz": 1.0 / dt_s, "trigger_sample_index": BEFORE },
        "expected": { "order": poles.len(), "poles": poles.iter().map(record).collect::<Vec<_>>() },
        "reference_era_recovery": recoveries,
    });
    if level > 0.0 {
        truth["noise"] = json!({ "fraction_of_peak": level, "sigma_g": sigma });
    }
    let target = folder.join(name);
    std::fs::create_dir_all(&target).unwrap();
    std::fs::write(target.join("accel.csv"), csv).unwrap();
    std::fs::write(target.join("truth.json"), truth.to_string()).unwrap();
}

const THREE: [[f64; 4]; 3] = [[-12.0, 190.0, 9.0, 0.3], [-25.0, 520.0, 6.0, -0.8], [-40.0, 1150.0, 4.0, 1.1]];

#[test]
fn other_orders_rates_noise_close_and_real_poles_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path();
    write(to, "era-6state-20khz", &THREE, 5e-5, 0.0, &[(100, 80)]);
    write(to, "era-6state-20khz-noise3pct", &THREE, 5e-5, 0.03, &[(60, 60), (150, 150), (200, 120)]);
    // 0.3 % apart in frequency, the same damping.
    let close = [[-9.0, 600.0, 8.0, 0.0], [-9.0, 601.8, 5.0, 1.0]];
    write(to, "era-4state-nearly-equal", &close, 1e-4, 0.0, &[]);
    let real = [[-45.0, 0.0, 7.0, 0.0], [-16.0, 240.0, 9.0, 0.4]];
    write(to, "era-3state-real", &real, 2e-4, 0.0, &[(40, 40)]);
    write(to, "era-3state-real-noise05pct", &real, 2e-4, 0.005, &[(40, 40), (120, 120), (200, 200)]);
    assert_eq!(walk(to), Ok(5));
}

#[test]
fn what_the_truth_leaves_out_is_skipped_by_name() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "era-bare", &THREE, 1e-4, 0.0, &[]);
    let modes: Vec<Value> = THREE.iter().map(|m| json!({ "sigma": m[0], "omega": m[1] })).collect();
    let truth = json!({ "parameters": { "modes": modes } }).to_string();
    std::fs::write(folder.path().join("era-bare/truth.json"), truth).unwrap();
    let report = check(&folder.path().join("era-bare")).unwrap();
    for skipped in ["rate_hz", "trigger_sample_index", "expected.order", "reference_era_recovery"] {
        assert!(report.contains(skipped), "{report}");
    }
}

#[test]
fn a_folder_that_is_not_understood_fails_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    assert!(walk(folder.path()).unwrap_err().contains("holds no folder era-*"));
    write(folder.path(), "era-good", &THREE, 1e-4, 0.0, &[]);
    std::fs::create_dir(folder.path().join("era-empty")).unwrap();
    let break_truth = |name: &str, change: &dyn Fn(&mut Value)| {
        write(folder.path(), name, &THREE, 1e-4, 0.0, &[(40, 40)]);
        let path = folder.path().join(name).join("truth.json");
        let mut truth: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        change(&mut truth);
        std::fs::write(path, truth.to_string()).unwrap();
    };
    break_truth("era-rate", &|truth| truth["sampling"]["rate_hz"] = json!(20_000));
    break_truth("era-trigger", &|truth| truth["sampling"]["trigger_sample_index"] = json!(3));
    break_truth("era-no-poles", &|truth| truth["expected"] = json!({}));
    break_truth("era-wrong", &|truth| truth["expected"]["poles"][0]["re"] = json!(-13.0));
    break_truth("era-noise", &|truth| truth["noise"] = json!({ "colour": "pink" }));
    let failures = walk(folder.path()).unwrap_err();
    let lines: Vec<&str> = failures.lines().collect();
    let names =
        ["era-empty: truth.json", "era-no-poles: ", "era-noise: ", "era-rate: ", "era-trigger: ", "era-wrong: "];
    assert_eq!(lines.len(), names.len(), "{failures}");
    assert!(lines.iter().zip(names).all(|(line, name)| line.starts_with(name)), "{failures}");
}
