//! One case: its signals, its expected numbers, what was not met.

use std::collections::BTreeSet;

use crumple_metrics::Metric;
use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal};
use crumple_testkit::reference_signals::{Case, Reference, list, number, text};
use serde_json::Value;

/// One case under test.
pub struct Check<'a> {
    /// The file it is from.
    pub reference: &'a Reference,
    /// The case.
    pub case: &'a Case,
    met: BTreeSet<String>,
    failures: Vec<String>,
}

impl<'a> Check<'a> {
    pub fn new(reference: &'a Reference, case: &'a Case) -> Self {
        Self { reference, case, met: BTreeSet::new(), failures: Vec::new() }
    }

    /// A parameter, which the case must have.
    pub fn param(&self, key: &str) -> f64 {
        number(&self.case["params"][key])
    }

    /// A parameter that the case may leave out.
    pub fn param_or(&self, key: &str, default: f64) -> f64 {
        self.case["params"][key].as_f64().unwrap_or(default)
    }

    pub fn has_param(&self, key: &str) -> bool {
        self.case["params"].get(key).is_some()
    }

    /// Signal number k of the case as it is defined, in the unit of its definition.
    pub fn signal(&self, k: usize) -> Sampled {
        self.reference.signal(text(&self.case["signals"][k]))
    }

    /// Signal number k in SI.
    pub fn si(&self, k: usize) -> Sampled {
        let (signal, to_si) = (self.signal(k), self.reference.to_si(text(&self.case["signals"][k])));
        Sampled::new(signal.t0_s(), signal.dt_s(), signal.samples().iter().map(|x| x * to_si).collect()).unwrap()
    }

    /// Signal number k in m/s², sampled so finely that its sampling is far below the tolerance of a closed form.
    ///
    /// At the case's own 10 kHz the samples of a pulse of 10 ms are 4e-4 away from the closed form.
    pub fn fine_acceleration(&self, k: usize) -> Signal<Acceleration> {
        let name = text(&self.case["signals"][k]);
        let (signal, to_si) = (self.reference.signal_at(name, 10), self.reference.to_si(name));
        let samples = signal.samples().iter().map(|x| x * to_si).collect();
        Signal::new(signal.t0_s(), signal.dt_s(), samples).unwrap()
    }

    /// Signal number k in m/s².
    pub fn acceleration(&self, k: usize) -> Signal<Acceleration> {
        self.si(k).into()
    }

    /// The constant deceleration of a closed form, sampled at 10 kHz for 1 s.
    pub fn constant_deceleration(&self) -> Signal<Acceleration> {
        Signal::new(0.0, 1e-4, vec![-self.param("constant_decel_ms2"); 10_001]).unwrap()
    }

    /// What is not met.
    pub fn fail(&mut self, failure: String) {
        self.failures.push(failure);
    }

    fn expected(&self, path: &str) -> Option<&'a Value> {
        path.split('/').try_fold(&self.case["expected"], |value, key| value.get(key))
    }

    /// Whether the case expects a number of this name (`/` between levels); it then counts as looked at.
    pub fn expects(&mut self, path: &str) -> bool {
        self.expected(path).is_some()
    }

    /// The limit of a number: that of its own name, else the case's; a time may also use `abs_t`.
    fn limit(&self, path: &str, expected: f64) -> f64 {
        let key = path.rsplit('/').next().unwrap_or(path);
        let tolerance = &self.case["tolerance"];
        let of = |name: &str| {
            let relative = tolerance[format!("rel{name}")].as_f64().map(|r| r * expected.abs());
            let absolute = tolerance[format!("abs{name}")].as_f64();
            match (relative, absolute) {
                (None, None) => None,
                (r, a) => Some(r.unwrap_or(0.0).max(a.unwrap_or(0.0))),
            }
        };
        if let Some(limit) = of(&format!("_{key}")) {
            return limit;
        }
        if key.contains("exact")
            && let Some(limit) = of("_exact")
        {
            return limit;
        }
        if key.starts_with("vpi")
            && let Some(limit) = of("_vpi")
        {
            return limit;
        }
        let is_time = key == "T" || key.ends_with("_s") && (key.starts_with("t_") || key.contains("_t") || is_t(key));
        let general = of("").unwrap_or(0.0);
        if is_time { general.max(of("_t").unwrap_or(0.0)) } else { general }
    }

    /// Holds a number against the expected one; nothing if the case does not ask for it.
    pub fn close(&mut self, path: &str, found: f64) {
        let Some(expected) = self.expected(path) else { return };
        self.met.insert(path.to_owned());
        let Some(expected) = expected.as_f64() else {
            self.fail(format!("{path}: {found} where {expected} is expected"));
            return;
        };
        let (difference, limit) = ((found - expected).abs(), self.limit(path, expected));
        if difference.is_nan() || difference > limit {
            self.fail(format!("{path}: {found} instead of {expected}, off by {difference:e} > {limit:e}"));
        }
    }

    /// The same for a number that may be missing: then `null` is expected.
    pub fn close_or_null(&mut self, path: &str, found: Option<f64>) {
        match (found, self.expected(path)) {
            (_, None) => {}
            (None, Some(Value::Null)) => {
                self.met.insert(path.to_owned());
            }
            (None, Some(expected)) => self.fail(format!("{path}: absent instead of {expected}")),
            (Some(found), Some(_)) => self.close(path, found),
        }
    }

    /// The value of a metric, divided by `unit`.
    pub fn metric(&mut self, path: &str, metric: &Metric, unit: f64) {
        if metric.value.is_none() && self.expected(path).is_some_and(|expected| !expected.is_null()) {
            self.fail(format!("{path}: {}", metric.definition));
            self.met.insert(path.to_owned());
            return;
        }
        self.close_or_null(path, metric.value.map(|value| value / unit));
    }

    /// The value of a metric in g.
    pub fn metric_g(&mut self, path: &str, metric: &Metric) {
        self.metric(path, metric, STANDARD_GRAVITY_M_PER_S2);
    }

    /// Start and end of a window. `same(from, to)` says whether another window has the same value: where several are
    /// equal but for rounding (a square pulse), which of them is reported is not defined.
    pub fn window(&mut self, from: &str, to: &str, metric: &Metric, same: impl Fn(f64, f64) -> bool) {
        let Some(window) = metric.window else { return };
        let expected = [from, to].map(|path| self.expected(path).and_then(Value::as_f64));
        let off = [window.from_s, window.to_s].iter().zip([from, to]).zip(expected).any(|((found, path), expected)| {
            expected.is_some_and(|expected| (found - expected).abs() > self.limit(path, expected))
        });
        if off && same(expected[0].unwrap_or(window.from_s), expected[1].unwrap_or(window.to_s)) {
            self.met.extend([from.to_owned(), to.to_owned()]);
            return;
        }
        self.close(from, window.from_s);
        self.close(to, window.to_s);
    }

    /// A whole number or a word.
    pub fn equal(&mut self, path: &str, found: Value) {
        let Some(expected) = self.expected(path) else { return };
        self.met.insert(path.to_owned());
        let same = match (found.as_f64(), expected.as_f64()) {
            (Some(found), Some(expected)) => found == expected,
            _ => found == *expected,
        };
        if !same {
            self.fail(format!("{path}: {found} instead of {expected}"));
        }
    }

    /// A list of numbers.
    pub fn close_list(&mut self, path: &str, found: &[f64]) {
        let Some(expected) = self.expected(path) else { return };
        self.met.insert(path.to_owned());
        let expected = list(expected);
        if expected.len() != found.len() {
            self.fail(format!("{path}: {} numbers instead of {}", found.len(), expected.len()));
        }
        for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
            let expected = number(expected);
            let limit = self.limit(path, expected);
            let difference = (found - expected).abs();
            if difference.is_nan() || difference > limit {
                self.fail(format!("{path}[{k}]: {found} instead of {expected}, limit {limit:e}"));
            }
        }
    }

    /// The tolerance of the case, for what is compared elsewhere.
    pub fn general_limit(&self, expected: f64) -> f64 {
        self.limit("", expected)
    }

    /// Counts as looked at.
    pub fn looked_at(&mut self, path: &str) {
        self.met.insert(path.to_owned());
    }

    /// The failures, among them every expected number that was not computed.
    pub fn finish(mut self) -> Vec<String> {
        let mut names = Vec::new();
        leaves(&self.case["expected"], "", &mut names);
        if names.is_empty() {
            self.failures.push("the case expects nothing".to_owned());
        }
        if self.failures.is_empty() {
            let missed = names.into_iter().filter(|name| !self.met.contains(name));
            self.failures.extend(missed.map(|name| format!("{name} is expected and not computed here")));
        }
        self.failures
    }
}

/// `t1_s`, `t2_s`.
fn is_t(key: &str) -> bool {
    key.strip_prefix('t').and_then(|rest| rest.strip_suffix("_s")).is_some_and(|n| n.parse::<u8>().is_ok())
}

/// Names of all numbers, words and lists, `/` between levels.
fn leaves(value: &Value, path: &str, names: &mut Vec<String>) {
    let Value::Object(map) = value else {
        names.push(path.to_owned());
        return;
    };
    for (key, value) in map {
        leaves(value, &if path.is_empty() { key.clone() } else { format!("{path}/{key}") }, names);
    }
}
