//! Cases of system identification: records made of seeds, and what the library finds in them.

use std::f64::consts::TAU;

use crumple_numerics::lti::{Complex, Mode};
use crumple_sysid::{
    AmbientOptions, ArxOrder, Constants, Hold, InitialConditions, IoData, NoiseKind, NoiseModel, NoiseOptions,
    OnUnseen, OutputErrorOptions, PoleKind, PoleRecord, PolynomialForm, Recommendable, Spread, TransferFunctionOptions,
    ambient_modes, arx, arx_orders, delay_scan, fit_measures, modal_assurance, mode_shapes, noise_model,
    noise_of_orders, outliers, output_error, phase_collinearity, pole_kinds, recommended, smallest, straight_line,
    transfer_function_fit, trend,
};
use crumple_testkit::identification::{self, Signals, channels, dt, gauss, integer, number, numbers};
use serde_json::{Map, Value, json};

use crate::Check;

fn data((inputs, outputs): Signals, input: &Value) -> IoData {
    IoData::new(inputs, outputs, dt(input)).unwrap()
}

fn record(input: &Value) -> IoData {
    data(identification::record(input), input)
}

fn chain(input: &Value, is_struck: bool) -> IoData {
    data(identification::chain(input, is_struck), input)
}

/// What of a case is not met.
pub fn check(_: Value) -> Check {
    Box::new(|case| {
        let input = &case["input"];
        let found = match case["kind"].as_str().unwrap_or("(no kind)") {
            "output-error" => by_output_error(input),
            "arx" => by_arx(input),
            "noise" => noise(input),
            "order" => order(input),
            "order-in-noise" => order_in_noise(input),
            "delay" => delay(input),
            "trend" => a_trend(input),
            "outlier" => some_outliers(input),
            "constant" => constants(input),
            "poles" => poles(input),
            "motion" => motion(input),
            "interval" => interval(input),
            "shape" => shapes(input),
            "validation" => validation(input),
            "recommend" => recommendation(input),
            "impact" => impact(input, &case["expected"]),
            "ambient" => ambient(input, &case["expected"]),
            other => return vec![format!("kind {other} is not known")],
        };
        compared(case, &found)
    })
}

/// Every key that is expected: booleans, whole numbers, texts and lists of those equal, numbers within the tolerance.
fn compared(case: &Value, found: &Value) -> Vec<String> {
    let tolerance_of = |key: &str| {
        let own = case["tolerances"][key].as_f64();
        own.or_else(|| case["relative_tolerance"].as_f64()).unwrap_or(0.0)
    };
    let expected = case["expected"].as_object().unwrap();
    let refuted = refuted(case);
    let asked = expected.iter().filter(|(key, _)| *key != "shapes" && !refuted.contains(&key.as_str()));
    let faults = asked.filter_map(|(key, wanted)| {
        if let Some(name) = key.strip_suffix("_at_least") {
            let (least, got) = (flat(wanted), flat(&found[name]));
            let is_met = least.len() == got.len() && got.iter().zip(&least).all(|(got, least)| got >= least);
            return (!is_met).then(|| format!("{name} is {}, expected at least {wanted}", found[name]));
        }
        let got = &found[key];
        is_met(wanted, got, tolerance_of(key)).then_some(()).map_or_else(
            || Some(format!("{key} is {got}, expected {wanted}, tolerance {}", tolerance_of(key))),
            |()| None,
        )
    });
    faults.collect()
}

/// What follows from a reference's loss that is no optimum, because the search of output error from all of its starts
/// ends lower, by more than ten times the tolerance of the losses.
fn refuted(case: &Value) -> &'static [&'static str] {
    let Some(loss) = case["expected"]["output_error_loss"].as_f64() else { return &[] };
    let lower = by_output_error(&case["input"])["loss"].as_f64().unwrap();
    if lower >= loss * (1.0 - 1e-4) {
        return &[];
    }
    println!("REFUTED {}: the loss of the reference, {loss}, is no optimum: {lower} is lower", case["id"]);
    &["output_error_loss", "ar_variances", "bic_output_error"]
}

fn flat(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(all) => all.iter().flat_map(flat).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

fn is_met(wanted: &Value, got: &Value, tolerance: f64) -> bool {
    let is_real = |value: &Value| value.is_f64();
    let has_reals = match wanted {
        Value::Array(all) => all.iter().any(is_real),
        other => is_real(other),
    };
    if !has_reals {
        return wanted == got;
    }
    let (wanted, got) = (flat(wanted), flat(got));
    let largest = wanted.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    wanted.len() == got.len() && wanted.iter().zip(&got).all(|(a, b)| (a - b).abs() <= tolerance * largest)
}

/// Natural frequencies (Hz) and damping ratios of the upper poles of a kind, by rising frequency.
fn modes(poles: impl Iterator<Item = Complex>) -> Vec<Mode> {
    let mut modes: Vec<Mode> = poles.filter(|s| s.im > 0.0).map(Mode::continuous).collect();
    modes.sort_by(|a, b| a.natural_frequency_rad_per_s.total_cmp(&b.natural_frequency_rad_per_s));
    modes
}

fn frequencies(modes: &[Mode]) -> Value {
    modes.iter().map(Mode::natural_frequency_hz).collect()
}

fn dampings(modes: &[Mode]) -> Value {
    modes.iter().map(|mode| mode.damping_ratio.unwrap()).collect()
}

fn continuous(sampled: &[Complex], dt_s: f64) -> impl Iterator<Item = Complex> + '_ {
    sampled.iter().filter_map(move |z| Some(Mode::discrete(*z, dt_s)?.pole))
}

/// Deviations of the upper sampled poles, by rising frequency: Hz, and of the damping ratio.
fn mode_deviations(poles: &[Complex], deviations: &[Option<(f64, f64)>], dt_s: f64) -> (Value, Value) {
    let upper = poles.iter().zip(deviations).filter(|(z, _)| z.im > 0.0);
    let mut all: Vec<(f64, (f64, f64))> =
        upper.map(|(z, d)| (Mode::discrete(*z, dt_s).unwrap().natural_frequency_rad_per_s, d.unwrap())).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    (all.iter().map(|(_, d)| d.0 / TAU).collect(), all.iter().map(|(_, d)| d.1).collect())
}

fn noise_name(kind: NoiseKind) -> &'static str {
    match kind {
        NoiseKind::OutputError => "output-error",
        NoiseKind::Arx => "arx",
    }
}

fn by_output_error(input: &Value) -> Value {
    let data = record(input);
    let options = OutputErrorOptions { from_rest: true, ..OutputErrorOptions::new(integer(input, "order")) };
    let fit = output_error(&data, options).unwrap();
    let form = PolynomialForm::new(&fit.model).unwrap();
    let (y, yh) = (&data.outputs()[0], &fit.simulated[0]);
    let loss = y.iter().zip(yh).map(|(y, yh)| (y - yh).powi(2)).sum::<f64>() / y.len() as f64;
    let poles = fit.model.poles().unwrap();
    let deviations = form.white_deviations(&data, loss).unwrap();
    let (frequency_sd, damping_sd) = mode_deviations(&poles, &form.mode_deviations(&deviations, &poles), dt(input));
    let found = modes(continuous(&poles, dt(input)));
    json!({
        "B": form.numerator, "F": form.denominator, "loss": loss,
        "fit_percent": fit_measures(y, yh).unwrap().fit_percent,
        "frequency_hz": frequencies(&found), "damping": dampings(&found),
        "standard_deviations": deviations.coefficients, "frequency_sd": frequency_sd, "damping_sd": damping_sd,
    })
}

fn by_arx(input: &Value) -> Value {
    let order = ArxOrder { na: integer(input, "na"), nb: integer(input, "nb"), nk: integer(input, "nk") };
    let model = arx(&record(input), order).unwrap();
    let poles = model.state_space().unwrap().poles().unwrap();
    let found = modes(continuous(&poles, dt(input)));
    let (frequency_sd, damping_sd) = mode_deviations(&poles, &model.mode_deviations(&poles), dt(input));
    let parameters: Vec<f64> = model.a.iter().chain(&model.b).map(|x| x[0]).collect();
    json!({
        "parameters": parameters,
        "standard_deviations": model.covariance(0).diagonal().iter().map(|x| x.sqrt()).collect::<Vec<f64>>(),
        "loss": model.losses[0], "frequency_hz": frequencies(&found), "damping": dampings(&found),
        "frequency_sd": frequency_sd, "damping_sd": damping_sd,
    })
}

fn noise(input: &Value) -> Value {
    let options = NoiseOptions { from_rest: true, ..NoiseOptions::new(integer(input, "order")) };
    let NoiseModel { kind, losses, variances, bic_output_error, bic_arx, autoregressions, whiteness, .. } =
        noise_model(&record(input), options).unwrap();
    let filter = autoregressions.first().cloned().unwrap_or_default();
    json!({
        "output_error_loss": losses[0], "ar_variances": variances[0], "bic_output_error": bic_output_error,
        "bic_arx": bic_arx, "noise": noise_name(kind), "ar_order": filter.len().saturating_sub(1),
        "ar_coefficients": filter, "ljung_box": whiteness[0].ljung_box, "white_limit_95": whiteness[0].limit_95,
        "interval": whiteness[0].is_white,
    })
}

fn order(input: &Value) -> Value {
    let all = arx_orders(&record(input), integer(input, "nk"), integer(input, "max_order")).unwrap();
    let (loss, bic): (Vec<f64>, Vec<f64>) = all.into_iter().unzip();
    json!({ "order": smallest(bic.iter().copied()).map(|place| place + 1), "loss": loss, "bic": bic })
}

fn order_in_noise(input: &Value) -> Value {
    let all = noise_of_orders(&record(input), true, integer(input, "max_order"));
    let (order, best) = &all[smallest(all.iter().map(|(_, noise)| noise.bic)).unwrap()];
    json!({ "order": order, "noise": noise_name(best.kind), "bic_of_the_order": best.bic })
}

fn delay(input: &Value) -> Value {
    let scan = delay_scan(&record(input), integer(input, "nf"), integer(input, "first"), integer(input, "last"));
    let scan = scan.unwrap();
    json!({
        "lags": scan.lags, "arx_bic": scan.bic_arx, "noise": noise_name(scan.noise), "lag": scan.lag,
        "at_edge": scan.at_edge,
    })
}

fn a_trend(input: &Value) -> Value {
    let found = trend(&record(input), integer(input, "order")).unwrap();
    json!({ "trend": found.is_there, "slope_per_sample": straight_line(&record(input).outputs()[0]).1 })
}

fn some_outliers(input: &Value) -> Value {
    let (places, fit) = outliers(&record(input), integer(input, "order"), true).unwrap();
    let found = modes(continuous(&fit.model.poles().unwrap(), dt(input)));
    json!({ "outliers": places[0], "frequency_hz": frequencies(&found), "damping": dampings(&found) })
}

fn constants(input: &Value) -> Value {
    let list = |name: &str| input[name].as_array().unwrap();
    let name = |name: &str, place: usize| list(name)[place]["name"].clone();
    let found = Constants::of(&channels(input, "inputs"), &channels(input, "outputs"));
    let because: Vec<Value> = match found.all_inputs {
        true => (0..list("inputs").len()).map(|place| name("inputs", place)).collect(),
        false => found.outputs.iter().map(|place| name("outputs", *place)).collect(),
    };
    let left_out: Vec<Value> = found.inputs_left_out.iter().map(|place| name("inputs", *place)).collect();
    json!({ "inputs_left_out": left_out, "refused": !because.is_empty(), "because": because })
}

fn kind_name(kind: PoleKind) -> &'static str {
    match kind {
        PoleKind::Mode => "mode",
        PoleKind::Real => "real",
        PoleKind::Growing => "growing",
        PoleKind::Integrator => "integrator",
        PoleKind::BeyondNyquist => "beyond-nyquist",
        PoleKind::Cancelled => "cancelled",
        PoleKind::Harmonic => "harmonic",
    }
}

fn poles(input: &Value) -> Value {
    let dt_s = number(input, "sample_time_s");
    let pairs = |name: &str| -> Vec<Complex> {
        let all = input[name].as_array().into_iter().flatten();
        all.map(|pair| Complex::new(pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap())).collect()
    };
    let mut all = pairs("poles_per_s");
    all.extend(continuous(&pairs("poles_discrete"), dt_s));
    let kinds = pole_kinds(
        &all,
        PoleRecord { dt_s, duration_s: number(input, "duration_s"), of_motion: false, window_per_s: 0.0 },
    );
    let of_modes = all.iter().zip(&kinds).filter(|(_, kind)| **kind == PoleKind::Mode).map(|(s, _)| *s);
    let found = modes(of_modes);
    json!({
        "what": kinds.iter().map(|kind| kind_name(*kind)).collect::<Vec<_>>(),
        "mode_frequency_hz": frequencies(&found), "mode_damping": dampings(&found),
    })
}

fn motion(input: &Value) -> Value {
    let data = record(input);
    let order = integer(input, "order");
    let options = TransferFunctionOptions {
        hold: Hold::Zero,
        initial: InitialConditions::Zero,
        ..TransferFunctionOptions::new(order, order - 1)
    };
    let fit = transfer_function_fit(&data, &options).unwrap();
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    let duration_s = dt(input) * data.samples() as f64;
    let kinds = pole_kinds(&poles, PoleRecord { dt_s: dt(input), duration_s, of_motion: false, window_per_s: 0.0 });
    let mut what: Vec<&str> = kinds.iter().map(|kind| kind_name(*kind)).collect();
    what.sort_unstable();
    let found = modes(poles.into_iter());
    json!({
        "what": what, "fit_percent": fit.fits[0].unwrap().fit_percent,
        "frequency_hz": frequencies(&found), "damping": dampings(&found),
    })
}

fn interval(input: &Value) -> Value {
    let (estimate, centre) = (number(input, "estimate"), number(input, "generator_value"));
    let draws = gauss(integer(input, "seed"), integer(input, "replicates"));
    let (shift, spread) = (number(input, "shift"), number(input, "spread"));
    let replicates: Vec<f64> = draws.iter().map(|g| estimate * (1.0 + shift + spread * g)).collect();
    let found = Spread::about(estimate, centre, &replicates).unwrap();
    let (low, high) = found.interval_95();
    json!({
        "bias": found.bias, "sd": found.deviation, "interval_90": [found.lower, found.upper],
        "interval_95": [low, high], "note": found.is_biased(),
    })
}

fn shapes(input: &Value) -> Value {
    let shape = |name: &str| -> Vec<Complex> {
        let (re, im) = (numbers(&input[format!("{name}_re")]), numbers(&input[format!("{name}_im")]));
        re.into_iter().zip(im).map(|(re, im)| Complex::new(re, im)).collect()
    };
    let (x, y) = (shape("x"), shape("y"));
    json!({ "mac": modal_assurance(&x, &y), "mpc": phase_collinearity(&x) })
}

fn validation(input: &Value) -> Value {
    let said = |pair: &Value| match pair[1].as_f64().map(|unseen| OnUnseen::of(pair[0].as_f64(), unseen)) {
        None => "none",
        Some(OnUnseen::Holds) => "holds",
        Some(OnUnseen::BelowZero) => "below-zero",
        Some(OnUnseen::FarBelow) => "far-below",
    };
    let pairs = input["fit_and_validation_percent"].as_array().unwrap();
    json!({ "said": pairs.iter().map(said).collect::<Vec<_>>() })
}

fn recommendation(input: &Value) -> Value {
    let model = |model: &Value| Recommendable {
        id: model["id"].as_str().unwrap().to_owned(),
        order: integer(model, "order"),
        bic: number(model, "bic"),
        validation_percent: model["validation_percent"].as_f64(),
    };
    let models: Vec<Recommendable> = input["models"].as_array().unwrap().iter().map(model).collect();
    json!({ "recommended": recommended(&models).map(|(best, _)| &best.id) })
}

/// The assurance criterion of every shape with the true one of its mode.
fn assurance(found: &[Vec<Complex>], expected: &Value) -> Value {
    let truth = expected["shapes"].as_array().unwrap();
    let real = |row: &Value| -> Vec<Complex> { numbers(row).into_iter().map(|x| Complex::new(x, 0.0)).collect() };
    found.iter().zip(truth).map(|(shape, row)| modal_assurance(shape, &real(row)).unwrap_or(0.0)).collect()
}

fn impact(input: &Value, expected: &Value) -> Value {
    let data = chain(input, true);
    let masses = numbers(&input["masses"]).len();
    let fit = output_error(&data, OutputErrorOptions::new(2 * masses)).unwrap();
    let poles: Vec<Complex> = fit.model.poles().unwrap().into_iter().filter(|z| z.im > 0.0).collect();
    let mut all: Vec<(Mode, Vec<Complex>)> = poles
        .iter()
        .zip(mode_shapes(&fit.model, &poles))
        .map(|(z, shape)| (Mode::discrete(*z, dt(input)).unwrap(), shape.unwrap_or_default()))
        .collect();
    all.sort_by(|a, b| a.0.natural_frequency_rad_per_s.total_cmp(&b.0.natural_frequency_rad_per_s));
    let (found, seen): (Vec<Mode>, Vec<Vec<Complex>>) = all.into_iter().unzip();
    let fits = data.outputs().iter().zip(&fit.simulated).map(|(y, yh)| fit_measures(y, yh).unwrap().fit_percent);
    json!({
        "fit_percent": fits.collect::<Vec<_>>(), "frequency_hz": frequencies(&found), "damping": dampings(&found),
        "mac": assurance(&seen, expected),
    })
}

fn ambient(input: &Value, expected: &Value) -> Value {
    let options = AmbientOptions {
        block_rows: Some(integer(input, "rows")),
        highest_order: Some(integer(input, "max_order")),
        ..AmbientOptions::default()
    };
    let found = ambient_modes(&chain(input, false), options).unwrap().modes;
    let seen: Vec<Vec<Complex>> = found.iter().map(|mode| mode.shape.clone()).collect();
    let list = |of: &dyn Fn(&crumple_sysid::AmbientMode) -> f64| -> Value { found.iter().map(of).collect() };
    let mut all = Map::new();
    all.insert("clusters".to_owned(), json!(found.len()));
    all.insert("frequency_hz".to_owned(), list(&|mode| mode.natural_frequency_rad_per_s.median / TAU));
    all.insert("damping".to_owned(), list(&|mode| mode.damping_ratio.median));
    all.insert("mac".to_owned(), assurance(&seen, expected));
    Value::Object(all)
}
