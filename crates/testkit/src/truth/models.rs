//! Candidates and identified models against the truth, and against their own test.

use std::f64::consts::TAU;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use serde_json::Value;

use crate::truth::found::Found;
use crate::truth::known::Maker;
use crate::truth::run::Made;

/// Smallest fit of a recommended model, percent.
const ADEQUATE_PERCENT: f64 = 90.0;
/// How far the fit of a model as measured may be from that of its motion, points: the filter moves both.
const AS_MEASURED: f64 = 2.0;

/// What a candidate misses of its own test, by what the summary has of both: dynamic crush beyond 3.5 %, restitution
/// beyond 0.1, time beyond 5 %, or that it stops. The limits are those of what the project calls adequate.
pub fn miss(made: &Made, candidate: &Value) -> Option<String> {
    // One that is recommended although it misses more says so, and for what it is.
    let is_excused = ["recommended", "simplest"].iter().any(|name| made.summary[name] == candidate["id"])
        && made.rated(candidate).is_some_and(|rated| {
            let missed = rated["missed_events"].as_array().map_or(&[][..], Vec::as_slice);
            rated["adequate"] == false && !missed.is_empty() && missed.iter().all(|event| event != "dynamic_crush")
        });
    let has_crush = made.number("/events/dynamic_crush_m").is_some() && !candidate["simulation"].is_null();
    let crush = match event(made, candidate, "dynamic_crush_m") {
        Some((own, crush)) => {
            ((own / crush - 1.0).abs() > 0.035).then(|| format!("its crush is {own:.4} of {crush:.4} m"))
        }
        None => has_crush.then(|| "it does not stop".to_owned()),
    };
    crush.or_else(|| misses_time_or_rebound(made, candidate).filter(|_| !is_excused))
}

fn event(made: &Made, candidate: &Value, name: &str) -> Option<(f64, f64)> {
    candidate["simulation"][name].as_f64().zip(made.number(&format!("/events/{name}")))
}

/// The same of the events beside the crush.
pub fn misses_time_or_rebound(made: &Made, candidate: &Value) -> Option<String> {
    let (own, time) = event(made, candidate, "time_of_dynamic_crush_s")?;
    let off = 100.0 * (own / time - 1.0);
    // One that creeps to its stop is as slow as the vehicle by then: 5 % of the impact speed.
    let velocity = candidate["id"].as_str().and_then(|id| made.waves.get(&format!("{id}/velocity")));
    let left = velocity.and_then(|wave| wave.samples().get(((time - wave.t0_s()) / wave.dt_s()).round() as usize));
    let creeps = left.zip(made.known.speed_m_per_s).is_some_and(|(left, speed)| left.abs() <= 0.05 * speed);
    if off.abs() > 5.0 && !creeps {
        return Some(format!("its time of crush is off by {off:.1} %"));
    }
    let (own, restitution) = event(made, candidate, "coefficient_of_restitution")?;
    let off = own - restitution;
    // Of a rebound that the record cuts off, what it shows is a lower bound.
    let is_cut = is_rebound_cut(made) || made.summary["events"]["still_separating"] == true;
    let is_off = if is_cut { off < -0.1 } else { off.abs() > 0.1 };
    is_off.then(|| format!("its restitution is off by {off:.2}"))
}

/// Whether a force above 1 g still acts on a vehicle that rebounds where the record ends: what its velocity changes by
/// in the last 4.4 ms, the window of CFC 60.
pub fn is_rebound_cut(made: &Made) -> bool {
    const WINDOW_S: f64 = 4.4e-3;
    made.velocity().is_some_and(|wave| {
        let v = wave.samples();
        let before = v.len().saturating_sub(1 + (WINDOW_S / wave.dt_s()) as usize);
        v.last().zip(v.get(before)).is_some_and(|(last, before)| *last < 0.0 && before - last > WINDOW_S * G)
    })
}

/// Whether a model misses the decelerations of the record by no more than 15 % of their mean, `v0²/2C`: then its forces
/// are known together, though none may be known beside the others.
pub fn has_the_forces(made: &Made, best: &Value) -> bool {
    let misfit = made.rated(best).and_then(|rated| rated["misfit"].as_f64());
    let events = made.number("/events/impact_speed_m_per_s").zip(made.number("/events/dynamic_crush_m"));
    misfit.zip(events).is_some_and(|(misfit, (speed, crush))| misfit <= 0.15 * 0.5 * speed * speed / crush)
}

/// Whether a candidate has a dual that no fitted sensor tells it from.
pub fn has_an_open_dual(made: &Made, own: &Value) -> bool {
    let has_sensors = own["fit"]["sensors"].as_array().is_some_and(|sensors| !sensors.is_empty());
    let is_dual = |other: &Value| other["equivalent_to"] == own["id"];
    (!own["equivalent_to"].is_null() || made.list("/candidates").iter().any(is_dual)) && !has_sensors
}

/// The fit of a candidate as measured, else that of its motion, percent.
fn fit(candidate: &Value) -> Option<f64> {
    let simulation = &candidate["simulation"];
    simulation["fit_as_measured_percent"].as_f64().or(simulation["fit_percent"].as_f64())
}

/// `100 (1 - |x - y| / |x - mean x|)`, percent, of the displacement of the record, x, and of a candidate, y, over the
/// window that its simulation was compared in, at the instants of the record. `None` without one of the waves.
fn fit_of_waves(made: &Made, candidate: &Value) -> Option<f64> {
    let simulation = &candidate["simulation"];
    let (from_s, to_s) = (simulation["from_s"].as_f64()?, simulation["to_s"].as_f64()?);
    let wave = |of: &str| made.waves.get(&format!("{of}/displacement"));
    let (record, model) = (wave(made.text("/events/channel"))?, wave(candidate["id"].as_str()?)?);
    let window = (0..record.len()).map(|k| record.t0_s() + k as f64 * record.dt_s());
    let pairs: Vec<(f64, f64)> = window
        .zip(record.samples())
        .filter(|(time_s, _)| (from_s - 1e-9..=to_s + 1e-9).contains(time_s))
        .filter_map(|(time_s, x)| Some((*x, model.at(time_s)?)))
        .collect();
    let mean = pairs.iter().map(|(x, _)| x).sum::<f64>() / pairs.len() as f64;
    let misfit = pairs.iter().map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    let spread = pairs.iter().map(|(x, _)| (x - mean).powi(2)).sum::<f64>();
    (spread > 0.0).then(|| 100.0 * (1.0 - (misfit / spread).sqrt()))
}

/// The recommended model is a candidate, repeats its own test and follows nine tenths of the displacement, also by its
/// waves; the verdict has its counts.
pub fn recommended(made: &Made, found: &mut Found) {
    let id = &made.summary["recommended"];
    found.holds(*id == made.summary["best"], || format!("{id} is recommended, {} is best", made.summary["best"]));
    let Some(best) = made.recommended() else {
        return found.holds(id.is_null(), || format!("{id} is no candidate"));
    };
    if made.is_of_a_vehicle() && made.known.is_sound {
        let miss = miss(made, best);
        found.holds(miss.is_none(), || format!("{id} does not repeat its own test: {}", miss.unwrap_or_default()));
    }
    for (what, fit) in [("its fit", fit(best)), ("the fit of its waves", fit_of_waves(made, best))] {
        found.holds(fit.is_none_or(|fit| fit >= ADEQUATE_PERCENT), || format!("{what} is {fit:?} %"));
    }
    for name in ["parameters", "determined"] {
        let own = &made.summary["verdict"][name];
        found.holds(*own == best["certainties"][name], || format!("the verdict has {own} {name}"));
    }
}

/// Counts of determined numbers fit their intervals; fits are those of the waves; nothing fits better than the closest;
/// the simplest is determined; duals are candidates.
pub fn candidates(made: &Made, found: &mut Found) {
    let named = |name: &str| made.candidate(made.text(name));
    for own in made.list("/candidates") {
        let id = own["id"].as_str().unwrap_or_default();
        determined(own, found);
        if let Some((fit, waves)) = fit(own).zip(fit_of_waves(made, own)) {
            found.near(&format!("the fit of {id}"), fit, waves, AS_MEASURED.max(0.2 * (100.0 - waves)));
        }
        let dual = own["equivalent_to"].as_str();
        found.holds(dual.is_none_or(|dual| made.candidate(dual).is_some()), || format!("{dual:?} is no candidate"));
    }
    if let Some(closest) = named("/closest").filter(|closest| fit(closest).is_some()) {
        let physical = made.list("/candidates").iter().filter(|own| own["physical"] == true).filter_map(fit);
        let best = physical.fold(f64::NEG_INFINITY, f64::max);
        let own = fit(closest).unwrap_or(f64::NAN);
        found.holds(own >= best - 0.01, || format!("{} fits {own:.2} %, another {best:.2} %", closest["id"]));
    }
    if let Some(simplest) = named("/simplest").filter(|_| made.known.is_sound && made.is_of_a_vehicle()) {
        let miss = miss(made, simplest);
        found.holds(miss.is_none(), || format!("the simplest does not repeat its test: {}", miss.unwrap_or_default()));
    }
}

/// The counts of a candidate add up, and no more numbers are called determined than have an interval within a factor of
/// ten. One that reaches zero may count either way: of a damper that is hardly there, it is known to be small.
fn determined(own: &Value, found: &mut Found) {
    let known = &own["certainties"];
    let count =
        |name: &str| known[name].as_u64().or(known[name].as_array().map(|names| names.len() as u64)).unwrap_or(0);
    let sum = count("determined") + count("order_of_magnitude") + count("open");
    found.holds(sum == count("parameters"), || format!("{}: {known} does not add up", own["id"]));
    let (low, high) = (&own["uncertainty"]["interval_low"], &own["uncertainty"]["interval_high"]);
    let Some(asked) = low.as_object().filter(|asked| asked.len() as u64 == count("parameters")) else { return };
    let masses = own["parameters"].as_object().into_iter().flatten().filter(|(name, _)| name.ends_with("_kg"));
    let mass_kg: f64 = masses.filter_map(|(_, mass)| mass.as_f64()).sum();
    let window_s = own["fit"]["to_s"].as_f64().unwrap_or(0.0);
    // The force that by itself stops the vehicle within the window of the fit, with a tenth of it for a zero.
    let is_small = |name: &str, high: f64| {
        let per_time = [("_n_s_per_m", 1), ("_n_per_m", 2)].into_iter().find(|(unit, _)| name.ends_with(unit));
        per_time.is_none_or(|(_, power)| high <= 0.1001 * mass_kg / window_s.powi(power))
    };
    let within_ten = asked.iter().filter(|(name, low)| {
        let is_zero = own["parameters"][name.as_str()] == 0.0;
        low.as_f64().zip(high[name.as_str()].as_f64()).is_some_and(|(low, high)| {
            low > 0.0 && high <= 10.0 * low || low <= 0.0 && high >= 0.0 && (!is_zero || is_small(name, high))
        })
    });
    let most = within_ten.count() as u64;
    found.holds(count("determined") <= most, || {
        format!("{}: {} are determined, {most} intervals lie within a factor of ten", own["id"], known["determined"])
    });
}

/// A curve that has the forces takes up the energy of the impact to 10 % on its way to the crush of the test.
/// Parameters of the model that made the record lie in their 95 % intervals, which are for an exact mass
/// and gain: 2 % wider here.
pub fn forces_or_parameters(made: &Made, best: &Value, found: &mut Found) {
    let parameter = |name: &str| best["parameters"][name].as_f64();
    let knots = (1..).map_while(|k| parameter(&format!("knot{k}_m")).zip(parameter(&format!("knot{k}_n"))));
    let knots: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(knots).collect();
    let inputs = made.number("/test/mass_kg").zip(made.number("/test/impact_speed_m_per_s"));
    if let Some((mass, speed)) = inputs.filter(|_| knots.len() > 1 && parameter("mass_kg").is_some()) {
        let area: f64 = knots.windows(2).map(|k| 0.5 * (k[1].0 - k[0].0) * (k[1].1 + k[0].1)).sum();
        found.same("the energy of the forces", Some(area), Some(0.5 * mass * speed * speed), 0.1);
    }
    let Maker::Lumped(truth) = &made.known.maker else { return };
    if made.known.model() != best["model"].as_str() {
        return;
    }
    let ends = ["interval_low", "interval_high"].map(|end| &best["uncertainty"][end]);
    for (name, truth) in truth.parameters() {
        let [low, high] = ends.map(|ends| ends[name.as_str()].as_f64());
        if let Some((low, high)) = low.zip(high) {
            found.count("good for", "parameters", (0.98 * low..=1.02 * high).contains(&truth));
        }
    }
}

/// Parameters that a model is good for are known to ±30 %.
pub fn named_parameters(best: &Value, names: &Value, found: &mut Found) {
    for name in names.as_array().into_iter().flatten().filter_map(Value::as_str) {
        let [low, high] = ["interval_low", "interval_high"].map(|end| best["uncertainty"][end][name].as_f64());
        let value = best["parameters"][name].as_f64();
        let is_known = value.zip(low.zip(high)).is_some_and(|(value, (low, high))| {
            value.abs() > 0.0 && (value - low).max(high - value) <= 0.305 * value.abs()
        });
        found.holds(is_known, || format!("{name} is {value:?}, its interval {low:?} to {high:?}"));
    }
}

/// A mode oscillates below half of the sampling rate, and its frequency is that of its pole; poles that grow are
/// remarked; the mode that made the record is found by the best model.
pub fn identified(made: &Made, found: &mut Found) {
    let Some(rate) = made.number("/test/sample_rate_hz") else { return };
    let part = |pole: &Value, name: &str| pole[name].as_f64().unwrap_or(0.0);
    for model in made.list("/models") {
        let id = model["id"].as_str().unwrap_or_default();
        for mode in model["modes"].as_array().into_iter().flatten() {
            let hz = part(mode, "natural_frequency_rad_per_s") / TAU;
            let is_fast = part(mode, "im_rad_per_s") != 0.0 && hz > 0.5 * rate * (1.0 + 1e-9);
            found.holds(!is_fast, || format!("{id}: a mode of {hz:.0} Hz at {rate:.0} samples a second"));
            let modulus = part(mode, "re_per_s").hypot(part(mode, "im_rad_per_s"));
            found.same("the frequency of a mode", Some(hz), Some(modulus / TAU), 1e-6);
        }
        // By more than a twentieth over the record; what grows less lies at zero.
        let grows = |pole: &Value| part(pole, "re_per_s") * made.length_s() > 0.05;
        if model["poles"].as_array().into_iter().flatten().any(grows) {
            let is_said = |remark: &Value| remark["code"] == "CR409" && remark["values"]["model"] == id;
            found.holds(made.list("/remarks").iter().any(is_said), || format!("{id} grows, and no CR409 says so"));
        }
    }
    if let Maker::Mode { frequency_hz, damping_ratio } = made.known.maker {
        let fit = |model: &&Value| model["fit_percent"].as_f64().unwrap_or(f64::NEG_INFINITY);
        let best = made.list("/models").iter().max_by(|a, b| fit(a).total_cmp(&fit(b)));
        let mode = best.map_or(&Value::Null, |best| &best["modes"][0]);
        found.same("the frequency", mode["natural_frequency_rad_per_s"].as_f64(), Some(frequency_hz * TAU), 0.01);
        found.same("the damping ratio", mode["damping_ratio"].as_f64(), Some(damping_ratio), 0.02);
    }
}
