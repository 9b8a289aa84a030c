//! Records and texts: two JSON values, walked side by side; polynomials by what they mean.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use crate::allowed::{Allowed, Unit};
use crate::candidate::Candidate;
use crate::differences::{Difference, Reason, Step, TopicReport};
use crate::ranking::same_ranking;
use crate::texts::{same_but_for_numbers, same_words, same_words_exactly};
use crate::{Base, CompareSettings, Tolerance};

// Records: two JSON values, walked side by side.

/// Compares two values: numbers by tolerance (also decimal numbers inside texts), texts exactly, maps by key. Notes
/// that differ in numbers alone, and the digest of the source, are put aside.
///
/// Lists whose elements have a unique `id` or `name` are paired by it, whatever their order; other lists by index.
pub fn compare_json(topic: &str, a: &Value, b: &Value, settings: &CompareSettings) -> TopicReport {
    walk(topic, a, b, settings, None).0
}

/// The same, and the limit of every number that both sides have, by its place.
pub fn compare_with_limits(
    topic: &str,
    a: &Value,
    b: &Value,
    settings: &CompareSettings,
) -> (TopicReport, BTreeMap<String, Limit>) {
    walk(topic, a, b, settings, Some(BTreeMap::new()))
}

fn walk(
    topic: &str,
    a: &Value,
    b: &Value,
    settings: &CompareSettings,
    limits: Option<BTreeMap<String, Limit>>,
) -> (TopicReport, BTreeMap<String, Limit>) {
    let mut walk = Walk { settings, report: TopicReport::new(topic), candidate: None, limits };
    walk.value(At { place: String::new(), way: None, unit: None, scale: None, root_modulus: None }, a, b);
    (walk.report, walk.limits.unwrap_or_default())
}

/// How far two numbers may be apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Tolerance in force.
    pub tolerance: Tolerance,
    /// What its relative part refers to.
    pub scale: f64,
}

impl Limit {
    /// The largest distance that counts as the same, in the unit of the number.
    pub fn allowed(&self) -> f64 {
        self.tolerance.abs + self.tolerance.rel * self.scale
    }
}

struct Walk<'a> {
    settings: &'a CompareSettings,
    report: TopicReport,
    /// The candidate that the walk is in.
    candidate: Option<Candidate>,
    /// The limit of every number, where asked for.
    limits: Option<BTreeMap<String, Limit>>,
}

/// Where the walk stands.
struct At<'a> {
    place: String,
    /// The last step to it, and where that was made.
    way: Option<(Step, &'a At<'a>)>,
    unit: Option<Unit>,
    /// What a relative difference refers to, where not to the number itself.
    scale: Option<f64>,
    /// The list holds the coefficients of a polynomial whose roots are about this far from zero.
    root_modulus: Option<f64>,
}

impl At<'_> {
    /// An element of the list here, which `label` tells apart.
    fn element(&self, label: &str, step: Step) -> At<'_> {
        let place = format!("{}[{label}]", self.place);
        At { place, way: Some((step, self)), unit: self.unit, scale: self.scale, root_modulus: None }
    }

    fn named(&self, name: &str) -> At<'_> {
        self.element(name, Step::Element(name.to_owned()))
    }

    fn index(&self, index: usize) -> At<'_> {
        self.element(&index.to_string(), Step::Index(index))
    }

    fn steps(&self) -> Vec<Step> {
        let Some((step, from)) = &self.way else { return Vec::new() };
        let mut steps = from.steps();
        steps.push(step.clone());
        steps
    }
}

impl Walk<'_> {
    fn value(&mut self, at: At<'_>, a: &Value, b: &Value) {
        match (a, b) {
            (Value::Object(x), Value::Object(y)) => self.object(&at, x, y),
            (Value::Array(x), Value::Array(y)) => self.array(at, a, x, b, y),
            _ => self.scalar(at, a, b),
        }
    }

    fn object(&mut self, at: &At<'_>, a: &Map<String, Value>, b: &Map<String, Value>) {
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
                if matches!(key.as_str(), "numerator" | "denominator") { root_modulus(a, b) } else { None };
            let way = Some((Step::Field(key.clone()), at));
            self.pair(At { place, way, unit, scale, root_modulus }, a.get(key), b.get(key));
        }
        if entered {
            self.candidate = None;
        }
    }

    fn array(&mut self, mut at: At<'_>, a: &Value, x: &[Value], b: &Value, y: &[Value]) {
        if let (Some(x), Some(y)) = (elements_by_name(x), elements_by_name(y)) {
            let names: BTreeSet<&str> = x.keys().chain(y.keys()).copied().collect();
            for name in names {
                self.pair(at.named(name), x.get(name).copied(), y.get(name).copied());
            }
            return;
        }
        if let Some(candidate) = &self.candidate
            && let (Some(p), Some(q)) =
                (candidate.bounds_beside_open(&at.place, x), candidate.bounds_beside_open(&at.place, y))
        {
            let open = (x.len() - p.len()).max(y.len() - q.len());
            if open > 0 {
                self.report.leaves_out(Reason::FollowsOpenParameter, open as u64);
                let (a, b) = (Value::from(p.clone()), Value::from(q.clone()));
                return self.array(at, &a, &p, &b, &q);
            }
        }
        let length = self.tolerance(&at);
        if let Err(reason) = length {
            let more = |long: &[Value], short: &[Value]| long.iter().skip(short.len()).map(leaves).sum::<u64>();
            self.report.leaves_out(reason, more(x, y) + more(y, x));
        }
        if x.len() != y.len() && length.is_ok() {
            let place = if at.place.is_empty() { "length".to_owned() } else { format!("{} length", at.place) };
            self.report.differs(Difference {
                place,
                steps: at.steps(),
                is_length: true,
                a: Some(x.len().into()),
                b: Some(y.len().into()),
                ..Difference::default()
            });
        }
        if let Some(modulus) = at.root_modulus
            && let Some(scales) = scales(x, y, modulus)
        {
            for (k, ((x, y), scale)) in x.iter().zip(y).zip(scales).enumerate() {
                self.value(At { scale: Some(scale), ..at.index(k) }, x, y);
            }
            return;
        }
        if at.scale.is_none()
            && let (Some(largest_a), Some(largest_b)) = (largest(a), largest(b))
        {
            at.scale = Some(largest_a.max(largest_b));
        }
        for (k, (x, y)) in x.iter().zip(y).enumerate() {
            self.value(at.index(k), x, y);
        }
    }

    /// A value that one side may lack.
    fn pair(&mut self, at: At<'_>, a: Option<&Value>, b: Option<&Value>) {
        match (a, b) {
            (Some(a), Some(b)) => self.value(at, a, b),
            _ => match self.tolerance(&at) {
                Err(reason) => self.report.leaves_out(reason, a.or(b).map_or(0, leaves)),
                Ok(_) => {
                    self.report.values += 1;
                    let (a, b) = (a.cloned(), b.cloned());
                    let steps = at.steps();
                    self.report.differs(Difference { place: at.place, steps, a, b, ..Difference::default() });
                }
            },
        }
    }

    fn scalar(&mut self, at: At<'_>, a: &Value, b: &Value) {
        let tolerance = match self.tolerance(&at) {
            Ok(tolerance) => tolerance,
            Err(reason) => return self.report.leaves_out(reason, leaves(a).max(leaves(b))),
        };
        self.report.values += 1;
        let determined = self.candidate.as_ref().and_then(|candidate| candidate.determined_on(&at.place));
        let numbers = a.as_f64().zip(b.as_f64());
        let (mut abs, mut rel) = (None, None);
        if let Some((x, y)) = numbers {
            let scale = at.scale.unwrap_or(0.0).max(x.abs()).max(y.abs());
            if let Some(limits) = &mut self.limits {
                limits.insert(at.place.clone(), Limit { tolerance, scale });
            }
            let difference = (x - y).abs();
            abs = Some(difference);
            rel = Some(if difference == 0.0 { 0.0 } else { difference / scale });
            // Below the absolute part a relative difference says nothing.
            self.report.saw_rel(if difference > tolerance.abs { rel } else { Some(0.0) });
            let same_zero = !self.settings.bits || x.to_bits() == y.to_bits();
            // Integers beyond 2^53 that differ may be one f64.
            let same_integer = a.is_f64() || b.is_f64() || difference > 0.0 || a == b;
            if tolerance.allows(x, y, scale) && same_zero && same_integer && determined.is_none() {
                return;
            }
        } else if a == b {
            return;
        } else if let (Some(x), Some(y)) = (a.as_str(), b.as_str())
            && (same_words(x, y, tolerance) || (!self.settings.bits && same_words_exactly(x, y)))
        {
            return;
        }
        let aside = self.is_aside(&at.place, a, b);
        let (steps, a, b) = (at.steps(), Some(a.clone()), Some(b.clone()));
        let difference = Difference { place: at.place, steps, a, b, abs, rel, determined, ..Difference::default() };
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

    fn tolerance(&self, at: &At<'_>) -> Allowed {
        self.settings.tolerances.tolerance_of(&self.report.topic, &at.place, at.unit, self.candidate.as_ref())
    }
}

/// Values in a value: numbers, texts and what stands for none.
pub(crate) fn leaves(value: &Value) -> u64 {
    match value {
        Value::Array(list) => list.iter().map(leaves).sum(),
        Value::Object(map) => map.values().map(leaves).sum(),
        _ => 1,
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

// Coefficients of a transfer function: numbers of different units in one list.
//
// A coefficient's rounding error is measured by its effect on the value of the polynomial near its roots: with roots
// of modulus w, `c_p s^p` is compared with the largest of all `|c_q| w^q`.

fn numbers(value: Option<&Value>) -> Option<Vec<f64>> {
    value?.as_array()?.iter().map(Value::as_f64).collect()
}

/// Geometric mean of the moduli of the denominator's roots, `|d_0 / d_n|^(1/n)`, the larger of both sides; `None` if
/// there are none away from zero.
pub(crate) fn root_modulus(a: &Map<String, Value>, b: &Map<String, Value>) -> Option<f64> {
    let mean = |object: &Map<String, Value>| {
        let denominator = numbers(object.get("denominator"))?;
        let (first, last) = (denominator.first()?, denominator.last()?);
        let modulus = (last / first).abs().powf(1.0 / (denominator.len() - 1) as f64);
        (modulus.is_finite() && modulus > 0.0).then_some(modulus)
    };
    Some(mean(a)?.max(mean(b)?))
}

/// The scale of each coefficient, highest power first; `None` if the lists are not numbers of equal count.
pub(crate) fn scales(a: &[Value], b: &[Value], modulus: f64) -> Option<Vec<f64>> {
    if a.len() != b.len() {
        return None;
    }
    let power = |k: usize| modulus.powf((a.len() - 1 - k) as f64);
    let mut most = 0.0_f64;
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        most = most.max(a.as_f64()?.abs().max(b.as_f64()?.abs()) * power(k));
    }
    Some((0..a.len()).map(|k| most / power(k)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tolerances;
    use serde_json::json;

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

    fn modulus(a: &Value, b: &Value) -> Option<f64> {
        let object = |list: &Value| json!({ "denominator": list }).as_object().cloned().unwrap_or_default();
        root_modulus(&object(a), &object(b))
    }

    #[test]
    fn roots_are_as_far_from_zero_as_the_ends_of_the_denominator_say() {
        // Roots of modulus 100 and 10; 8 against 1.
        assert_eq!(modulus(&json!([1.0, 20.0, 1e4]), &json!([1.0, 20.0, 1e4])), Some(100.0));
        assert_eq!(modulus(&json!([2.0, 3.0, 200.0]), &json!([1.0, 0.0, 1e4])), Some(100.0), "the larger side");
        assert_eq!(modulus(&json!([2.0, 3.0, 200.0]), &json!([4.0, 1.0, 16.0])), Some(10.0));
        assert_eq!(modulus(&json!([-1.0, 0.0, 64.0]), &json!([1.0, 0.0, 0.0, 1.0])), Some(8.0));
        for none in [json!([1.0, 2.0, 0.0]), json!([0.0, 2.0, 1.0]), json!([]), json!(["x", 1.0]), json!(1.0)] {
            assert_eq!(modulus(&json!([1.0, 2.0]), &none), None, "{none}");
            assert_eq!(modulus(&none, &json!([1.0, 2.0])), None, "{none}");
        }
    }

    #[test]
    fn a_coefficient_is_measured_by_the_largest_term_near_the_roots() {
        let list = |x: &[f64]| x.iter().map(|x| json!(x)).collect::<Vec<Value>>();
        // 3·10², 1·10 and 20 near roots of modulus 10: the first is the largest.
        assert_eq!(scales(&list(&[3.0, 1.0, 20.0]), &list(&[-2.0, 1.0, 7.0]), 10.0), Some(vec![3.0, 30.0, 300.0]));
        assert_eq!(scales(&list(&[1.0]), &list(&[1.0, 2.0]), 10.0), None);
        assert_eq!(scales(&list(&[1.0]), &[json!("x")], 10.0), None);
    }
}
