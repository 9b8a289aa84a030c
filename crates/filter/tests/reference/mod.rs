//! The reference cases of crash metrics and their signals, made from the formulas in the same file.

#![allow(dead_code, reason = "compiled into several tests, of which each uses a part")]

use std::f64::consts::PI;
use std::path::PathBuf;

use crumple_signal::{STANDARD_GRAVITY_M_PER_S2, Sampled};
use serde_json::Value;

/// The case file, read; `None` (and a printed line) where it is absent.
pub struct Reference(Value);

/// One case: `id`, `metric`, `params`, `expected`, `tolerance`.
pub type Case = Value;

impl Reference {
    /// Reads the file.
    pub fn open() -> Option<Self> {
        let text = std::fs::read_to_string(crumple_testkit::shared("reference/metrics.json")?).unwrap();
        Some(Self(serde_json::from_str(&text).unwrap()))
    }

    /// The cases whose id starts with `prefix` and whose metric is `metric`; at least one.
    pub fn cases(&self, prefix: &str, metric: &str) -> Vec<&Case> {
        let cases: Vec<&Case> = self.0["cases"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|case| text(&case["id"]).starts_with(prefix) && case["metric"] == metric)
            .collect();
        assert!(!cases.is_empty(), "no case {prefix}* of {metric}");
        cases
    }

    /// A signal by name, in the unit of its definition.
    pub fn signal(&self, name: &str) -> Sampled {
        let definition = &self.0["signals"][name];
        let (rate_hz, t0_s) = (number(&definition["fs"]), number(&definition["t_start"]));
        let n = definition["n"].as_u64().unwrap();
        let components = definition["components"].as_array().unwrap();
        assert!(definition.get("abs").is_none() && definition.get("scale").is_none(), "{name}: not made here");
        let samples = (0..n)
            .map(|i| {
                let t = t0_s + i as f64 / rate_hz;
                components.iter().map(|component| value(component, t)).sum()
            })
            .collect();
        Sampled::new(t0_s, 1.0 / rate_hz, samples).unwrap()
    }

    /// The factor from a signal's unit to m/s².
    pub fn to_si(&self, name: &str) -> f64 {
        match text(&self.0["signals"][name]["unit"]) {
            "g" => STANDARD_GRAVITY_M_PER_S2,
            "m/s2" => 1.0,
            other => panic!("{name}: unit {other}"),
        }
    }
}

/// A component of a signal at time t.
fn value(component: &Value, t: f64) -> f64 {
    let get = |key: &str| number(&component[key]);
    // Position in a pulse of limited length, 0..=1, with the slack that the file's conventions give.
    let inside = || {
        let u = (t - get("t0")) / get("dur");
        (-1e-9..=1.0 + 1e-9).contains(&u).then_some(u)
    };
    match text(&component["kind"]) {
        "const" => get("value"),
        "sine" => get("amp") * (2.0 * PI * get("f") * t + component["phase"].as_f64().unwrap_or(0.0)).sin(),
        "halfsine" => inside().map_or(0.0, |u| get("amp") * (PI * u).sin()),
        "ramp" => inside().map_or(0.0, |u| get("amp") * u),
        "harmonics" => inside().map_or(0.0, |u| {
            let amplitudes = component["amps"].as_array().unwrap().iter().map(number);
            amplitudes.zip(1..).map(|(amplitude, j)| amplitude * (f64::from(j) * PI * u).sin()).sum()
        }),
        "kelvin" => {
            let (v0, omega, zeta) = (get("v0"), get("omega"), get("zeta"));
            let wd = omega * (1.0 - zeta * zeta).sqrt();
            let (sin, cos) = (wd * t).sin_cos();
            v0 / wd
                * (-zeta * omega * t).exp()
                * ((zeta * zeta * omega * omega - wd * wd) * sin - 2.0 * zeta * omega * wd * cos)
        }
        kind => panic!("signals of kind {kind} are not made here"),
    }
}

/// A number of the case file.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

/// A text of the case file.
pub fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is not a text"))
}

/// Asserts that a number is the expected one within the tolerance of its case, `{"rel"}` or `{"abs"}`.
pub fn assert_close(case: &Case, what: &str, found: f64, expected: f64) {
    let limit = match (&case["tolerance"]["rel"], &case["tolerance"]["abs"]) {
        (Value::Number(relative), Value::Null) => relative.as_f64().unwrap() * expected.abs(),
        (Value::Null, Value::Number(absolute)) => absolute.as_f64().unwrap(),
        other => panic!("{}: tolerance {other:?}", case["id"]),
    };
    let difference = (found - expected).abs();
    assert!(
        difference <= limit,
        "{} {what}: {found} instead of {expected}, off by {difference:e} > {limit:e}",
        case["id"]
    );
}

/// Reads the samples of a file with time in column 1 and acceleration in g in column 2; `#` and a header line are
/// passed over.
pub fn two_columns(path: &PathBuf, separator: char) -> Sampled {
    let content = std::fs::read_to_string(path).unwrap();
    let rows: Vec<(f64, f64)> = content
        .lines()
        .filter_map(|line| {
            let (time, value) = line.split_once(separator)?;
            Some((time.trim().parse().ok()?, value.trim().parse().ok()?))
        })
        .collect();
    let n = rows.len();
    let dt_s = (rows[n - 1].0 - rows[0].0) / (n - 1) as f64;
    // Both kinds of file are sampled at 10 kHz; the rounded division gives that to the last bits only.
    let dt_s = (dt_s * 1e7).round() / 1e7;
    Sampled::new(rows[0].0, dt_s, rows.iter().map(|row| row.1 * STANDARD_GRAVITY_M_PER_S2).collect()).unwrap()
}
