//! The reference cases of crash metrics and their signals, made from the formulas in the same file.

use std::f64::consts::PI;
use std::path::Path;

use crumple_signal::{STANDARD_GRAVITY_M_PER_S2, Sampled};
use serde_json::Value;

use crate::places::shared;

/// The case file, read; `None` (and a printed line) where it is absent.
pub struct Reference(Value);

/// One case: `id`, `metric`, `params`, `expected`, `tolerance`.
pub type Case = Value;

impl Reference {
    /// Reads the shared file.
    pub fn open() -> Option<Self> {
        shared("reference/metrics.json").map(|path| {
            let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            Self::of(serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
        })
    }

    /// A file of this layout.
    pub fn of(file: Value) -> Self {
        Self(file)
    }

    /// Every case, in the order of the file.
    pub fn all(&self) -> &[Case] {
        list(&self.0["cases"])
    }

    /// The cases whose id starts with `prefix` and whose metric is `metric`; at least one.
    pub fn cases(&self, prefix: &str, metric: &str) -> Vec<&Case> {
        let cases: Vec<&Case> = self
            .all()
            .iter()
            .filter(|case| text(&case["id"]).starts_with(prefix) && case["metric"] == metric)
            .collect();
        assert!(!cases.is_empty(), "no case {prefix}* of {metric}");
        cases
    }

    /// A signal by name, in the unit of its definition.
    pub fn signal(&self, name: &str) -> Sampled {
        self.signal_at(name, 1)
    }

    /// The same signal sampled `finer` times as fast, where its formula is one of time.
    pub fn signal_at(&self, name: &str, finer: u32) -> Sampled {
        let definition = &self.0["signals"][name];
        let (rate_hz, t0_s) = (number(&definition["fs"]) * f64::from(finer), number(&definition["t_start"]));
        let n = definition["n"].as_u64().unwrap_or_else(|| panic!("signal {name} has no length"));
        let components = list(&definition["components"]);
        let by_index = |kind: &Value| kind == "square" || kind == "points";
        assert!(finer == 1 || !components.iter().any(|c| by_index(&c["kind"])), "{name} is given sample by sample");
        let scale = definition["scale"].as_f64().unwrap_or(1.0);
        let magnitude = definition["abs"] == true;
        let samples = (0..(n.max(1) - 1) * u64::from(finer) + n.min(1))
            .map(|i| {
                let t = t0_s + i as f64 / rate_hz;
                let sum: f64 = components.iter().map(|component| value(component, i, t)).sum();
                scale * if magnitude { sum.abs() } else { sum }
            })
            .collect();
        Sampled::new(t0_s, 1.0 / rate_hz, samples).unwrap_or_else(|error| panic!("signal {name}: {error}"))
    }

    /// The factor from a signal's unit to the SI unit.
    pub fn to_si(&self, name: &str) -> f64 {
        match text(&self.0["signals"][name]["unit"]) {
            "g" => STANDARD_GRAVITY_M_PER_S2,
            "m/s2" | "rad/s" => 1.0,
            other => panic!("{name}: unit {other}"),
        }
    }
}

/// A component of a signal at sample i, time t.
fn value(component: &Value, i: u64, t: f64) -> f64 {
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
        "haversine" => inside().map_or(0.0, |u| get("amp") * (PI * u).sin().powi(2)),
        "triangle" => inside().map_or(0.0, |u| get("amp") * (1.0 - (2.0 * u - 1.0).abs())),
        "square" => {
            let position = i as f64;
            if position >= get("i0") && position <= get("i1") { get("amp") } else { 0.0 }
        }
        "points" => list(&component["values"]).get(i as usize).map_or(0.0, number),
        "ramp" => inside().map_or(0.0, |u| get("amp") * u),
        "harmonics" => inside().map_or(0.0, |u| {
            let amplitudes = list(&component["amps"]).iter().map(number);
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

/// A list of the case file.
pub fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is not a list"))
}

/// A text of the case file.
pub fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("{value} is not a text"))
}

/// Asserts that a number is the expected one within the tolerance of its case, `{"rel"}` or `{"abs"}`.
pub fn assert_close(case: &Case, what: &str, found: f64, expected: f64) {
    let (relative, absolute) = (case["tolerance"]["rel"].as_f64(), case["tolerance"]["abs"].as_f64());
    let limit = match (relative, absolute) {
        (Some(relative), None) => relative * expected.abs(),
        (None, Some(absolute)) => absolute,
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
pub fn two_columns(path: &Path, separator: char) -> Sampled {
    let content = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
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
    let samples = rows.iter().map(|row| row.1 * STANDARD_GRAVITY_M_PER_S2).collect();
    Sampled::new(rows[0].0, dt_s, samples).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
