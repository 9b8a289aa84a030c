//! Records: two JSON values, walked side by side.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use crate::compare::polynomial;
use crate::compare::words::{same_but_for_numbers, same_words};
use crate::differences::{Difference, TopicReport};
use crate::tolerances::Unit;
use crate::tolerances::{Candidate, same_ranking};
use crate::{Base, CompareSettings, Tolerance};

/// Compares two values: numbers by tolerance (also decimal numbers inside texts), texts exactly, maps by key. Notes
/// that differ in numbers alone, and the digest of the source, are put aside.
///
/// Lists whose elements have a unique `id` or `name` are paired by it, whatever their order; other lists by index.
pub fn compare_json(topic: &str, a: &Value, b: &Value, settings: &CompareSettings) -> TopicReport {
    let mut walk = Walk { settings, report: TopicReport::new(topic), candidate: None };
    walk.value(At { place: String::new(), unit: None, scale: None, root_modulus: None }, a, b);
    walk.report
}

struct Walk<'a> {
    settings: &'a CompareSettings,
    report: TopicReport,
    /// The candidate that the walk is in.
    candidate: Option<Candidate>,
}

/// Where the walk stands.
struct At {
    place: String,
    unit: Option<Unit>,
    /// What a relative difference refers to, where not to the number itself.
    scale: Option<f64>,
    /// The list holds the coefficients of a polynomial whose roots are about this far from zero.
    root_modulus: Option<f64>,
}

impl At {
    fn element(&self, label: &str) -> Self {
        Self { place: format!("{}[{label}]", self.place), unit: self.unit, scale: self.scale, root_modulus: None }
    }
}

impl Walk<'_> {
    fn value(&mut self, at: At, a: &Value, b: &Value) {
        match (a, b) {
            (Value::Object(x), Value::Object(y)) => self.object(&at, x, y),
            (Value::Array(x), Value::Array(y)) => self.array(at, a, x, b, y),
            _ => self.scalar(at, a, b),
        }
    }

    fn object(&mut self, at: &At, a: &Map<String, Value>, b: &Map<String, Value>) {
        let candidate = Candidate::from_records(&at.place, a, b);
        let entered = candidate.is_some();
        self.candidate = candidate.or(self.candidate.take());
        let moduli = complex_moduli(a, b);
        let energy = largest_energy(a, b);
        let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
        for key in keys {
            if self.settings.tolerances.base != Base::Exact && same_ranking(key, a, b) {
                self.report.values += 1;
                continue;
            }
            let place = if at.place.is_empty() { key.clone() } else { format!("{}.{key}", at.place) };
            let unit = Unit::of_field(key, a.get("unit")).or(at.unit);
            let energy = energy.filter(|_| is_energy(key));
            let scale = complex_group(key).and_then(|group| moduli.get(&group).copied()).or(energy);
            let root_modulus =
                if matches!(key.as_str(), "numerator" | "denominator") { polynomial::root_modulus(a, b) } else { None };
            self.pair(At { place, unit, scale, root_modulus }, a.get(key), b.get(key));
        }
        if entered {
            self.candidate = None;
        }
    }

    fn array(&mut self, mut at: At, a: &Value, x: &[Value], b: &Value, y: &[Value]) {
        if let (Some(x), Some(y)) = (elements_by_name(x), elements_by_name(y)) {
            let names: BTreeSet<&str> = x.keys().chain(y.keys()).copied().collect();
            for name in names {
                self.pair(at.element(name), x.get(name).copied(), y.get(name).copied());
            }
            return;
        }
        if x.len() != y.len() && !self.tolerance(&at).is_any() {
            let place = if at.place.is_empty() { "length".to_owned() } else { format!("{} length", at.place) };
            self.report.differs(Difference {
                place,
                a: Some(x.len().into()),
                b: Some(y.len().into()),
                ..Difference::default()
            });
        }
        if let Some(modulus) = at.root_modulus
            && let Some(scales) = polynomial::scales(x, y, modulus)
        {
            for (k, ((x, y), scale)) in x.iter().zip(y).zip(scales).enumerate() {
                self.value(At { scale: Some(scale), ..at.element(&k.to_string()) }, x, y);
            }
            return;
        }
        if at.scale.is_none()
            && let (Some(largest_a), Some(largest_b)) = (largest(a), largest(b))
        {
            at.scale = Some(largest_a.max(largest_b));
        }
        for (k, (x, y)) in x.iter().zip(y).enumerate() {
            self.value(at.element(&k.to_string()), x, y);
        }
    }

    /// A value that one side may lack.
    fn pair(&mut self, at: At, a: Option<&Value>, b: Option<&Value>) {
        match (a, b) {
            (Some(a), Some(b)) => self.value(at, a, b),
            _ if self.tolerance(&at).is_any() => {}
            _ => {
                self.report.values += 1;
                self.report.differs(Difference {
                    place: at.place,
                    a: a.cloned(),
                    b: b.cloned(),
                    ..Difference::default()
                });
            }
        }
    }

    fn scalar(&mut self, at: At, a: &Value, b: &Value) {
        let tolerance = self.tolerance(&at);
        if tolerance.is_any() {
            return;
        }
        self.report.values += 1;
        let numbers = a.as_f64().zip(b.as_f64());
        let (mut abs, mut rel) = (None, None);
        if let Some((x, y)) = numbers {
            let scale = at.scale.unwrap_or(0.0).max(x.abs()).max(y.abs());
            let difference = (x - y).abs();
            abs = Some(difference);
            rel = Some(if difference == 0.0 { 0.0 } else { difference / scale });
            // Below the absolute part a relative difference says nothing.
            self.report.saw_rel(if difference > tolerance.abs { rel } else { Some(0.0) });
            let same_zero = !self.settings.bits || x.to_bits() == y.to_bits();
            // Integers beyond 2^53 that differ may be one f64.
            let same_integer = a.is_f64() || b.is_f64() || difference > 0.0 || a == b;
            if tolerance.allows(x, y, scale) && same_zero && same_integer {
                return;
            }
        } else if a == b {
            return;
        } else if let (Some(x), Some(y)) = (a.as_str(), b.as_str())
            && same_words(x, y, tolerance)
        {
            return;
        }
        let aside = self.is_aside(&at.place, a, b);
        let difference =
            Difference { place: at.place, a: Some(a.clone()), b: Some(b.clone()), abs, rel, ..Difference::default() };
        if aside {
            self.report.aside.push(difference);
        } else {
            self.report.differs(difference);
        }
    }

    /// Whether a text that differs is no result: a note that says the same with other numbers (which the records hold),
    /// and the digest of the file that the record came in, unless provenance counts.
    fn is_aside(&self, place: &str, a: &Value, b: &Value) -> bool {
        let (Some(x), Some(y)) = (a.as_str(), b.as_str()) else { return false };
        if self.settings.tolerances.base == Base::Exact {
            return false;
        }
        let is_note = place.rsplit_once('[').is_some_and(|(list, _)| list == "notes" || list.ends_with(".notes"));
        let is_source = self.report.topic == "/test" && place == "source.digest" && !self.settings.provenance;
        is_source || (is_note && same_but_for_numbers(x, y))
    }

    fn tolerance(&self, at: &At) -> Tolerance {
        self.settings.tolerances.tolerance_of(&self.report.topic, &at.place, at.unit, self.candidate.as_ref())
    }
}

/// The elements of a list by `id` or `name`, if all have one and none twice.
fn elements_by_name(list: &[Value]) -> Option<BTreeMap<&str, &Value>> {
    if list.is_empty() {
        return None;
    }
    ["id", "name"].into_iter().find_map(|key| {
        let named: BTreeMap<&str, &Value> =
            list.iter().map(|element| Some((element.get(key)?.as_str()?, element))).collect::<Option<_>>()?;
        (named.len() == list.len()).then_some(named)
    })
}

/// The largest magnitude in a list or matrix of numbers; `None` if anything else is in it.
fn largest(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => number.as_f64().map(f64::abs),
        Value::Array(list) => list.iter().map(largest).try_fold(0.0, |most, x| Some(f64::max(most, x?))),
        _ => None,
    }
}

/// `re_per_s` and `im_rad_per_s` are one number: the name without `re`, `im` and the radian.
fn complex_group(key: &str) -> Option<String> {
    let parts: Vec<&str> = key.split('_').collect();
    parts
        .iter()
        .any(|part| matches!(*part, "re" | "im"))
        .then(|| parts.into_iter().filter(|part| !matches!(*part, "re" | "im" | "rad")).collect::<Vec<_>>().join("_"))
}

/// The larger part of every complex number of two objects.
fn complex_moduli(a: &Map<String, Value>, b: &Map<String, Value>) -> BTreeMap<String, f64> {
    let mut moduli = BTreeMap::new();
    for (key, value) in a.iter().chain(b) {
        if let (Some(group), Some(part)) = (complex_group(key), value.as_f64()) {
            let most = moduli.entry(group).or_insert(0.0_f64);
            *most = most.max(part.abs());
        }
    }
    moduli
}

fn is_energy(key: &str) -> bool {
    key.ends_with("_j")
}

/// The largest energy of an instant: what is left of the others at the turning point is their difference.
fn largest_energy(a: &Map<String, Value>, b: &Map<String, Value>) -> Option<f64> {
    let energies = a.iter().chain(b).filter(|(key, _)| is_energy(key)).filter_map(|(_, value)| value.as_f64());
    energies.map(f64::abs).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::Tolerances;

    fn compare(a: &Value, b: &Value) -> TopicReport {
        compare_json("/events", a, b, &CompareSettings::default())
    }

    fn places(report: &TopicReport) -> Vec<&str> {
        report.differences.iter().map(|d| d.place.as_str()).collect()
    }

    #[test]
    fn numbers_by_tolerance_texts_exactly_absent_keys_named() {
        let a = json!({"x_m": 1.0, "rule": "trapezoid", "t": null, "n": 3, "same": [1, {"a": 2.5}]});
        let b = json!({"x_m": 1.0 + 1e-12, "rule": "euler", "t": 0.5, "n": 4, "more": 1, "same": [1, {"a": 2.5}]});
        let report = compare(&a, &b);
        assert_eq!(places(&report), ["more", "n", "rule", "t"]);
        assert_eq!(report.different, 4);
        assert_eq!(report.differences[0].a, None);
        assert_eq!(report.differences[1].abs, Some(1.0));
        assert_eq!(report.differences[1].rel, Some(0.25));
        assert!(!report.same);
        assert!(compare(&a, &a).same);
    }

    #[test]
    fn an_integer_and_a_float_of_the_same_value_are_the_same() {
        assert!(compare(&json!({"x": 1}), &json!({"x": 1.0})).same);
    }

    #[test]
    fn integers_that_no_f64_tells_apart_still_differ() {
        let exact = CompareSettings {
            tolerances: Tolerances { base: Base::Exact, ..Tolerances::default() },
            ..CompareSettings::default()
        };
        let report = compare_json("/x", &json!(9_007_199_254_740_993_u64), &json!(9_007_199_254_740_992_u64), &exact);
        assert!(!report.same);
    }

    #[test]
    fn a_zero_s_sign_counts_only_where_bits_do() {
        let (a, b) = (json!([0.0]), json!([-0.0]));
        assert!(compare(&a, &b).same);
        assert!(!compare_json("/x", &a, &b, &CompareSettings { bits: true, ..CompareSettings::default() }).same);
    }

    #[test]
    fn a_small_number_in_a_list_is_judged_by_the_largest() {
        let (a, b) = (json!({"sigma": [1e3, 1e-9]}), json!({"sigma": [1e3, 2e-9]}));
        assert!(compare(&a, &b).same, "1e-9 beside 1e3 is its rounding error");
        let report = compare(&json!({"sigma": 1e-9}), &json!({"sigma": 2e-9}));
        assert_eq!(places(&report), ["sigma"]);
        let report = compare(&json!([[1e3, 1.0], [0.0, 1.0]]), &json!([[1e3, 1.0], [0.0, 1.1]]));
        assert_eq!(places(&report), ["[1][1]"]);
    }

    #[test]
    fn the_parts_of_a_complex_number_are_judged_by_the_larger() {
        let pole = |im: f64| json!([{"re_per_s": -20.0, "im_rad_per_s": im}]);
        assert!(compare(&pole(1e-10), &pole(-1e-10)).same);
        assert!(!compare(&pole(1e-3), &pole(-1e-3)).same);
    }

    #[test]
    fn coefficients_of_a_transfer_function_are_judged_by_their_share_in_its_value() {
        // Roots near 100 rad/s: s^2 weighs 1e4 times its coefficient, the constant term 1 times.
        let tf = |lead: f64, first: f64| json!({"numerator": [lead, 0.0, 2e4], "denominator": [first, 20.0, 1e4]});
        assert!(compare(&tf(1e-12, 1.0), &tf(-1e-12, 1.0)).same, "a leading zero made of rounding errors");
        assert_eq!(places(&compare(&tf(0.0, 1.0), &tf(1e-3, 1.001))), ["denominator[0]", "numerator[0]"]);
    }

    #[test]
    fn named_elements_are_paired_by_name_and_others_by_index() {
        let a = json!([{"name": "olc", "value": 1.0}, {"name": "vpi", "value": 2.0}]);
        let b = json!([{"name": "vpi", "value": 2.5}, {"name": "esw", "value": 3.0}, {"name": "olc", "value": 1.0}]);
        assert_eq!(places(&compare(&a, &b)), ["[esw]", "[vpi].value"]);
        assert_eq!(places(&compare(&json!([1, 2]), &json!([1, 3, 4]))), ["length", "[1]"]);
        let twice = json!([{"name": "a", "v": 1}, {"name": "a", "v": 2}]);
        assert_eq!(places(&compare(&twice, &json!([{"name": "a", "v": 1}, {"name": "a", "v": 3}]))), ["[1].v"]);
    }

    #[test]
    fn what_is_ignored_may_differ_or_lack() {
        let rules = crate::parse_rules("\"/events#fit.*\" = { ignore = true }").unwrap();
        let settings =
            CompareSettings { tolerances: Tolerances { rules, ..Tolerances::default() }, ..CompareSettings::default() };
        let (a, b) =
            (json!({"fit": {"n": 1, "why": "x", "l": [1]}, "x": 1}), json!({"fit": {"n": 2, "l": []}, "x": 1}));
        let report = compare_json("/events", &a, &b, &settings);
        assert!(report.same, "{report:?}");
        assert_eq!(report.values, 1);
    }
}
