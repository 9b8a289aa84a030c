//! How the number that belongs to a published figure is taken from the runs, and why it misses where it does.

use crumple_numerics::estimation::statistics::quantile;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use serde_json::Value;

use crate::atlas::runs::{CLOSING_MPH, Runs};

/// A number, and its interval where the published figure is to be in it.
type Taken = (f64, Option<[f64; 2]>);

/// A row of the atlas.
pub(crate) struct Reading {
    /// Name of the figure.
    pub figure: &'static str,
    /// The record or records.
    pub of: &'static str,
    /// The number in the unit of the figure; `None`: the run leaves none.
    pub take: fn(&Runs) -> Option<Taken>,
    /// Why it misses, or what is to be known of a hit.
    pub why: &'static str,
}

const CAMRY: &str = "Camry";
const TWO: &str = "Camry, two sensors";
const CARS: &str = "20 made cars, predicted, median";
const TESTED: &str = "the same cars, tested, median";

const fn row(figure: &'static str, of: &'static str, take: fn(&Runs) -> Option<Taken>, why: &'static str) -> Reading {
    Reading { figure, of, take, why }
}

/// All of them.
pub(crate) const READINGS: &[Reading] = &[
    row("fleet-crush-56", CAMRY, |runs| at(&runs.camry, "/events/dynamic_crush_m", 1.0), ""),
    row("fleet-peak-56", CAMRY, |runs| at(&runs.camry, "/metrics/peak_acceleration/value", G), ""),
    row("fleet-esw-56", CAMRY, |runs| at(&runs.camry, "/metrics/equivalent_square_wave/value", G), ""),
    row("fleet-crush-40", CAMRY, |runs| plain(crush(&runs.camry, 40.0)?), "predicted from the test at 57 km/h"),
    row("fleet-crush-40", TWO, |runs| plain(crush(&runs.two_sensors, 40.0)?), "predicted from the test at 57 km/h"),
    row("fleet-peak-40", CAMRY, |runs| plain(peak(&runs.camry, 40.0)? / G), "predicted"),
    row("fleet-peak-40", TWO, |runs| plain(peak(&runs.two_sensors, 40.0)? / G), "predicted"),
    row("fleet-esw-40", CAMRY, |runs| plain(square_wave(&runs.camry, 40.0)? / G), "predicted"),
    row("fleet-esw-40", TWO, |runs| plain(square_wave(&runs.two_sensors, 40.0)? / G), "predicted"),
    row("fleet-crush-ratio", CAMRY, |runs| plain(ratio(&runs.camry, crush)?), ""),
    row(
        "fleet-crush-ratio",
        TWO,
        |runs| plain(ratio(&runs.two_sensors, crush)?),
        "the engine's mass makes the chain of two masses softer at 40 km/h; a single car may lie outside of the \
         interval of a median",
    ),
    row("fleet-crush-ratio", CARS, |runs| plain(median(&runs.cars, |car| ratio(car, crush))?), MADE_CARS),
    row("fleet-crush-ratio", TESTED, |runs| plain(median(&runs.tested, |car| ratio(car, crush))?), MADE_CARS),
    row("fleet-peak-ratio", CAMRY, |runs| plain(ratio(&runs.camry, peak)?), ONE_CAR),
    row("fleet-peak-ratio", TWO, |runs| plain(ratio(&runs.two_sensors, peak)?), ONE_CAR),
    row("fleet-peak-ratio", CARS, |runs| plain(median(&runs.cars, |car| ratio(car, peak))?), MADE_CARS),
    row("fleet-peak-ratio", TESTED, |runs| plain(median(&runs.tested, |car| ratio(car, peak))?), MADE_CARS),
    row("fleet-crush-exponent", CAMRY, |runs| plain(exponent(&runs.camry)?), ""),
    row(
        "fleet-crush-exponent",
        TWO,
        |runs| plain(exponent(&runs.two_sensors)?),
        "as the ratio of crush: 40 km/h is predicted softer",
    ),
    row("fleet-crush-exponent", CARS, |runs| plain(median(&runs.cars, exponent)?), MADE_CARS),
    row("fleet-crush-exponent", TESTED, |runs| plain(median(&runs.tested, exponent)?), MADE_CARS),
    row("fleet-esw-ratio", CAMRY, |runs| plain(ratio(&runs.camry, square_wave)?), ""),
    row("fleet-esw-ratio", TWO, |runs| plain(ratio(&runs.two_sensors, square_wave)?), "as the ratio of crush"),
    row("fleet-esw-ratio", CARS, |runs| plain(median(&runs.cars, |car| ratio(car, square_wave))?), MADE_CARS),
    row("fleet-esw-ratio", TESTED, |runs| plain(median(&runs.tested, |car| ratio(car, square_wave))?), MADE_CARS),
    row(
        "fleet-crush-peak-correlation",
        "100 made cars",
        |runs| plain(correlation(&runs.pulses)?),
        "made cars share one scale of crush and force, real ones differ more in shape",
    ),
    row("fleet-shape", CAMRY, |runs| at(&runs.camry, "/metrics/centroid_time_ratio/value", 1.0), ""),
    row("camry-kw400", "Camry, wall", |runs| at(&runs.wall, "/metrics/kw400/value", 1e3), ""),
    row(
        "camry-wall-momentum",
        "Camry, wall",
        |runs| {
            let metric = |name: &str| runs.wall["metrics"][name]["value"].as_f64();
            plain(metric("barrier_delta_v")? / metric("delta_v")?)
        },
        "the impulse is that of the whole record",
    ),
    row(
        "crash-limits",
        "four typed tests, one car like them",
        |runs| {
            let vehicle = &runs.damage[2]["vehicle"]["damage"];
            let [low, high] = ends(&vehicle["one_vehicle_interval_m_per_s"])?;
            plain(50.0 * (high - low) / vehicle["equivalent_barrier_speed_m_per_s"].as_f64()?)
        },
        "",
    ),
    row(
        "crash-sensitivity",
        "a typed stiffness",
        |runs| {
            let speed = |k: usize| {
                runs.damage[k].pointer("/vehicle/damage/equivalent_barrier_speed_m_per_s").and_then(Value::as_f64)
            };
            plain(100.0 * (speed(1)? / speed(0)? - 1.0))
        },
        "",
    ),
    row(
        "crash3-pair",
        "the pair of its source",
        |runs| at(&runs.damage[3], "/other/damage/mean_residual_crush_m", 1.0),
        "",
    ),
    row("ab-constant", "four typed tests of a front", |runs| plain(crash3_constant(&runs.damage[2])?), ""),
    row(
        "winsmash-with-rebound",
        CAMRY,
        |runs| {
            let number = |name: &str| runs.camry["events"][name].as_f64();
            let lost = (1.0 + number("coefficient_of_restitution")?) * number("impact_speed_m_per_s")?;
            plain(number("delta_v_m_per_s")? / lost - 1.0)
        },
        "Crumple's delta-v counts the rebound",
    ),
    row("restitution-over-crush", "Camry, predicted at 56 km/h", |runs| restitution(&runs.camry, 56.0), ""),
    row(
        "restitution-over-crush",
        "Camry, predicted at 40 km/h",
        |runs| restitution(&runs.camry, 40.0),
        "another car; the recommended curve rebounds less from 40 km/h than from 57",
    ),
    row("restitution-lowest-speed", "Camry, predicted", |runs| restitution(&runs.camry, 15.5), ONE_UNLOADING),
    row("restitution-low-speed", "Camry, predicted", |runs| plain(restitution(&runs.camry, 8.0)?.0), ONE_UNLOADING),
    row(
        "restitution-speed-direction",
        "Camry, 56 less 8 km/h",
        |runs| plain(restitution(&runs.camry, 56.0)?.0 - restitution(&runs.camry, 8.0)?.0),
        "",
    ),
    row("speed-crush-line", "Camry, predicted 15.5 to 56 km/h", |runs| plain(intercept(&runs.camry)?), ""),
    row("cipriani-5-mph", CAMRY_PAIR, |runs| of_collision(&runs.closing, 5.0), ONE_UNLOADING),
    row("cipriani-7-mph", CAMRY_PAIR, |runs| of_collision(&runs.closing, 7.0), ONE_UNLOADING),
    row("cipriani-10-mph", CAMRY_PAIR, |runs| of_collision(&runs.closing, 10.0), ONE_UNLOADING),
    row("restitution-pairs", CAMRY_PAIR, |runs| of_collision(&runs.closing, 70.0), ""),
    row("pair-sdof-low", "made cars on that spring", |runs| pair_delta_v(&runs.pairs[0]), ""),
    row("pair-sdof-mean", "made cars on that spring", |runs| pair_delta_v(&runs.pairs[1]), ""),
    row("edr-2005", "table of the Camry", recorder_error, "sampling and rounding alone"),
    row("cfr-563", "table of the Camry", recorder_error, "sampling and rounding alone"),
    row(
        "ecr-delta-v",
        "table of the Camry",
        |runs| {
            let change = &runs.recorder["metrics"]["maximum_delta_v"];
            let half = 0.5 * (change["high"].as_f64()? - change["low"].as_f64()?);
            plain(100.0 * half / change["value"].as_f64()?.abs())
        },
        "",
    ),
    row("camry-sensors", "Camry, lowest", |runs| plain(sensors(&runs.camry, "low")? * 3.6), ""),
    row("camry-sensors", "Camry, highest", |runs| plain(sensors(&runs.camry, "high")? * 3.6), ""),
    row(
        "small-overlap-delta-v",
        "Accord, IIHS CEP1705",
        |runs| at(&runs.overlap, "/events/delta_v_m_per_s", 1.0 / 3.6),
        "",
    ),
    row(
        "munyazikwiye-2016",
        "Camry, recommended model",
        |runs| {
            let simulated = of_recommended(&runs.camry)?["simulation"]["dynamic_crush_m"].as_f64()?;
            plain(100.0 * (simulated / runs.camry["events"]["dynamic_crush_m"].as_f64()? - 1.0))
        },
        "",
    ),
];

const CAMRY_PAIR: &str = "Camry against itself";
const MADE_CARS: &str = "each kind of made car is drawn equally often, not as cars are sold: their own tests say how \
                         far they are from a fleet";
const ONE_CAR: &str = "one car beside the interval of a median over cars";
const ONE_UNLOADING: &str =
    "a plastic curve with one unloading stiffness does not rise at low speed, and a bumper is another part";

fn plain(value: f64) -> Option<Taken> {
    Some((value, None))
}

/// A number by its place, in multiples of a unit.
fn at(summary: &Value, pointer: &str, unit: f64) -> Option<Taken> {
    plain(summary.pointer(pointer)?.as_f64()?.abs() / unit)
}

fn ends(interval: &Value) -> Option<[f64; 2]> {
    Some([interval[0].as_f64()?, interval[1].as_f64()?])
}

/// The prediction of the recommended candidate at a speed, km/h.
fn prediction(summary: &Value, km_per_h: f64) -> Option<&Value> {
    summary["predictions"].as_array()?.iter().find(|one| {
        let near = one["impact_speed_m_per_s"].as_f64().is_some_and(|v| (3.6 * v - km_per_h).abs() < 1e-3);
        near && one["recommended"] == true
    })
}

fn crush(summary: &Value, km_per_h: f64) -> Option<f64> {
    prediction(summary, km_per_h)?["dynamic_crush_m"].as_f64()
}

fn peak(summary: &Value, km_per_h: f64) -> Option<f64> {
    prediction(summary, km_per_h)?["peak_acceleration_m_per_s2"].as_f64()
}

/// Speed squared over twice the crush.
fn square_wave(summary: &Value, km_per_h: f64) -> Option<f64> {
    Some((km_per_h / 3.6).powi(2) / (2.0 * crush(summary, km_per_h)?))
}

/// At 40 over 56 km/h.
fn ratio(summary: &Value, of: fn(&Value, f64) -> Option<f64>) -> Option<f64> {
    Some(of(summary, 40.0)? / of(summary, 56.0)?)
}

/// Exponent of crush over speed between 40 and 56 km/h.
fn exponent(summary: &Value) -> Option<f64> {
    Some(ratio(summary, crush)?.ln() / (40.0_f64 / 56.0).ln())
}

/// Median over the cars that have such a number.
fn median(cars: &[Value], of: impl Fn(&Value) -> Option<f64>) -> Option<f64> {
    let mut all: Vec<f64> = cars.iter().filter_map(of).collect();
    all.sort_unstable_by(f64::total_cmp);
    quantile(&all, 0.5)
}

fn correlation(pairs: &[[f64; 2]]) -> Option<f64> {
    let count = pairs.len() as f64;
    let mean = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / count);
    let moment = |a: usize, b: usize| pairs.iter().map(|pair| (pair[a] - mean[a]) * (pair[b] - mean[b])).sum::<f64>();
    (count > 2.0).then(|| moment(0, 1) / (moment(0, 0) * moment(1, 1)).sqrt())
}

/// An end of what the sensors of the compartment say of delta-v, m/s.
fn sensors(summary: &Value, end: &str) -> Option<f64> {
    let all = summary["key_numbers"].as_array()?;
    all.iter().find(|number| number["name"] == "delta_v")?["spread"][end].as_f64()
}

fn interval_of(record: &Value, name: &str) -> Option<[f64; 2]> {
    let interval = record["intervals"].as_array()?.iter().find(|interval| interval["name"] == name)?;
    Some([interval["low"].as_f64()?, interval["high"].as_f64()?])
}

const RESTITUTION: &str = "coefficient_of_restitution";

fn with_interval(record: &Value) -> Option<Taken> {
    Some((record[RESTITUTION].as_f64()?, Some(interval_of(record, RESTITUTION)?)))
}

fn restitution(summary: &Value, km_per_h: f64) -> Option<Taken> {
    with_interval(prediction(summary, km_per_h)?)
}

/// Restitution of the recommended candidate in the collision at a closing speed.
fn of_collision(summaries: &[Value], mph: f64) -> Option<Taken> {
    let place = CLOSING_MPH.iter().position(|closing| *closing == mph)?;
    let all = summaries[place]["predictions"].as_array()?;
    with_interval(all.iter().find(|one| one["recommended"] == true && !one["collision"].is_null())?)
}

fn pair_delta_v(summary: &Value) -> Option<Taken> {
    let all = summary["predictions"].as_array()?;
    let collision = all.iter().find(|one| one["recommended"] == true && !one["collision"].is_null())?;
    plain(collision["delta_v_m_per_s"].as_f64()?)
}

/// Delta-v of the recorder over that of the laboratory, less 1, in percent.
fn recorder_error(runs: &Runs) -> Option<Taken> {
    let recorded = runs.recorder.pointer("/metrics/maximum_delta_v/value")?.as_f64()?.abs();
    plain(100.0 * (recorded / runs.camry["events"]["delta_v_m_per_s"].as_f64()? - 1.0))
}

fn of_recommended(summary: &Value) -> Option<&Value> {
    let id = summary["recommended"].as_str()?;
    summary["candidates"].as_array()?.iter().find(|candidate| candidate["id"] == id)
}

/// Intercept, m/s, of the line with the least squares through speed over crush less its rebound.
fn intercept(summary: &Value) -> Option<f64> {
    let rebound = summary.pointer("/metrics/rebound_displacement/value")?.as_f64()?;
    let points: Vec<[f64; 2]> = [15.5, 24.0, 40.0, 48.0, 56.0]
        .iter()
        .map(|km_per_h| Some([crush(summary, *km_per_h)? - rebound, km_per_h / 3.6]))
        .collect::<Option<_>>()?;
    let count = points.len() as f64;
    let [x, y] = [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / count);
    let slope = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum::<f64>()
        / points.iter().map(|point| (point[0] - x).powi(2)).sum::<f64>();
    Some(y - slope * x)
}

/// `A L/(m b0 b1)` in the units of its source: lb/in, lb, mph, mph/in.
fn crash3_constant(damage: &Value) -> Option<f64> {
    const INCH_M: f64 = 0.0254;
    const POUND_KG: f64 = 0.453_592_37;
    const MPH: f64 = 0.447_04;
    let number = |name: &str| damage["vehicle"]["stiffness"][name].as_f64();
    let a = number("a_n_per_m")? / (POUND_KG * G / INCH_M);
    let mass = number("mass_per_width_kg_per_m")? * INCH_M / POUND_KG;
    Some(a / (mass * number("b0_m_per_s")? / MPH * number("b1_per_s")? * INCH_M / MPH))
}
