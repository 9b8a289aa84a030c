//! What people decide by beside the numbers of the table: status, intervals, fits, warnings, what the test was. One
//! walk over what is kept of two runs finds all that differs.

use std::collections::BTreeMap;

use crumple_artifact::records::{EventsV1, RemarkV1};
use crumple_diff::{CompareSettings, Difference, Limit, SAME_SHARE, Step, compare_with_limits, remarks_by_code};
use crumple_stage::joints::invariants;
use serde_json::{Map, Value, json};

use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateSummary, MetricSummary, Summary};
use crate::words;

use super::expected::{Expected, in_short, named};
use super::quantities::{INTERVAL_SHARE, PREDICTED, Quantity, allows_intervals};
use super::scenarios::{Scenario, scenarios};

/// Something that differs and is no number of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// Where it stands in the summary, lists by what their elements are of: `verdict.status`,
    /// `predictions[recommended at 40.0 km/h].extrapolates`.
    pub key: String,
    /// Before and after.
    pub values: [String; 2],
    /// What of a run it is of.
    part: Part,
}

/// What of a run a fact is of.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Status,
    /// The interval of a number of the table.
    Interval,
    /// A candidate by its id.
    Candidate(String),
    /// Another field of the summary.
    Field(String),
}

impl Part {
    /// By the place of a difference.
    fn at(steps: &[Step]) -> Self {
        match steps {
            [Step::Field(verdict), Step::Field(status)] if verdict == "verdict" && status == "status" => Self::Status,
            [Step::Field(list), Step::Element(id), ..] if list == "candidates" => Self::Candidate(id.clone()),
            [Step::Field(field), ..] => Self::Field(field.clone()),
            _ => Self::Field(String::new()),
        }
    }

    /// Place in the table: the named candidates behind what they follow from, all other candidates last.
    fn rank(&self, sides: [&Expected; 2]) -> usize {
        let is_named = |id: &str| sides.iter().any(|side| named(&side.summary).any(|(_, own)| own == id));
        let field = match self {
            Self::Candidate(id) => return PARTS.len() + if is_named(id) { 0 } else { 2 },
            Self::Status => "verdict",
            Self::Interval => INTERVALS,
            Self::Field(field) => field,
        };
        PARTS.iter().position(|part| *part == field).unwrap_or(PARTS.len() + 1)
    }
}

impl Fact {
    /// Whether it stands above all numbers: the status, and what a run contradicts itself in.
    pub fn is_grave(&self) -> bool {
        self.part == Part::Status || self.part == Part::Field("contradictions".to_owned())
    }
}

/// Names of fields that are sentences, steps of a solver, or follow from others: nobody decides by them.
const ASIDE: [&str; 30] = [
    "absent_because",
    "at_s",
    "bootstrap",
    "candidate",
    "condition",
    "correlation",
    "definition_id",
    "effective_samples",
    "energy_closure",
    "evaluations",
    "interval_by",
    "interval_source",
    "iterations",
    "language",
    "modal_amplitude_coherence",
    "mode_singular_value",
    "names",
    "notes",
    "numbers",
    "poles",
    "profile",
    "propagation",
    "reason",
    "remedy",
    "sentences",
    "status_sentence",
    "stop_reason",
    "title",
    "transfer_function",
    "weakest_direction",
];

/// All that differs between two runs and is not among the numbers. What an earlier version did not keep is not
/// compared.
pub fn facts([a, b]: [&Expected; 2], rows: &[&Quantity], settings: &CompareSettings) -> Vec<Fact> {
    let is_earlier = a.is_earlier() || b.is_earlier();
    let [before, after] = [[a, b], [b, a]].map(|sides| decided_by(sides, is_earlier));
    let (report, limits) = compare_with_limits("summary.json", &before, &after, settings);
    let is_within = |difference: &Difference| {
        let width = width_of_interval(&before, &difference.steps).filter(|_| allows_intervals(settings));
        let limit = limits.get(&difference.place).map_or(0.0, Limit::allowed);
        width.zip(difference.abs).is_some_and(|(width, abs)| abs <= limit.max(INTERVAL_SHARE * width))
    };
    let best = a.summary.recommended.as_ref().filter(|id| Some(*id) == b.summary.recommended.as_ref());
    let is_row = |steps: &[Step]| match steps {
        [Step::Field(list), Step::Element(id), Step::Field(part), rest @ ..] if list == "candidates" => {
            let is_interval = matches!(rest, [Step::Field(end), ..] if ENDS_OF_PARAMETERS.contains(&end.as_str()));
            Some(id) == best && ((part == "parameters" && !rest.is_empty()) || (part == "uncertainty" && is_interval))
        }
        _ => false,
    };
    // Events repeat what the key numbers say, a deviation what the interval says.
    let is_said = |steps: &[Step]| match steps {
        [Step::Field(events), event @ ..] if events == "events" => {
            let moved = rows.iter().filter(|row| row.differs(1) || row.interval_differs(1));
            moved.into_iter().any(|row| is_event(event, &row.key))
        }
        _ => false,
    };
    let is_deviation = |step: &Step| matches!(step, Step::Field(field) if field == "standard_deviation");
    let counts = |difference: &&Difference| {
        let steps = &difference.steps;
        !is_row(steps) && !steps.iter().any(is_deviation) && !is_said(steps) && !is_within(difference)
    };
    let of_walk = report.differences.iter().filter(counts).flat_map(|difference| {
        emptied(&before, &after, difference).unwrap_or_else(|| {
            let values = [&difference.a, &difference.b].map(|value| shown(value.as_ref()));
            vec![Fact { key: difference.place.clone(), values, part: Part::at(&difference.steps) }]
        })
    });
    let of_rows = rows.iter().filter(|row| row.interval_differs(1)).map(|row| Fact {
        key: format!("interval of {}", row.name),
        values: [0, 1].map(|run| row.interval(run).unwrap_or_else(|| ABSENT.to_owned())),
        part: Part::Interval,
    });
    let mut all: Vec<Fact> = of_rows.chain(of_walk).collect();
    all.sort_by_key(|fact| fact.part.rank([a, b]));
    all
}

/// Where intervals of the numbers of the table stand among the parts.
const INTERVALS: &str = "intervals of numbers";

/// Maps of a candidate's uncertainty with the ends of the intervals of its parameters.
const ENDS_OF_PARAMETERS: [&str; 2] = ["interval_low", "interval_high"];

/// Parts of a summary, those that people look at first in front.
const PARTS: [&str; 15] = [
    "verdict",
    "limits",
    "test",
    "contact",
    INTERVALS,
    "key_numbers",
    "simplest",
    "closest",
    "predictions",
    "concerns",
    "contradictions",
    "remarks",
    "events",
    "impacts",
    "metrics",
];

/// The elements of a list that is empty on one side, in place of its length; `None`: the place is no such list.
fn emptied(before: &Value, after: &Value, difference: &Difference) -> Option<Vec<Fact>> {
    let [Step::Field(list)] = &difference.steps[..] else { return None };
    let list = Some(list.as_str()).filter(|_| difference.is_length)?;
    let sides = [before, after].map(|run| run[list].as_array().map_or(&[][..], Vec::as_slice));
    let is_empty = sides.iter().any(|side| side.is_empty());
    let name = |one: &Value| Some(format!("{list}[{}]", one["id"].as_str()?));
    let fact = |side: usize, one: &Value| {
        let mut values = [ABSENT.to_owned(), ABSENT.to_owned()];
        values[side] = shown(Some(one));
        Some(Fact { key: name(one)?, values, part: Part::at(&difference.steps) })
    };
    let facts = (0..2).flat_map(|side| sides[side].iter().map(move |one| fact(side, one)));
    facts.collect::<Option<Vec<Fact>>>().filter(|_| is_empty)
}

/// Whether a place in the events is the value or the interval of a key number; events have the unit in their names.
fn is_event(steps: &[Step], key_number: &str) -> bool {
    let name = match steps {
        [Step::Field(list), Step::Element(name), ..] if list == "intervals" => name,
        [Step::Field(name)] => name,
        _ => return false,
    };
    name.strip_prefix(key_number).is_some_and(|unit| ["", "_m", "_s", "_m_per_s"].contains(&unit))
}

/// What of a run is walked: the fields of its summary, each list by what its elements are of. What the rows of numbers
/// hold is left out; of candidates that not both runs name little is compared.
fn decided_by([kept, other]: [&Expected; 2], is_earlier: bool) -> Value {
    let (run, with_artifacts) = (&kept.summary, !kept.stages.is_empty() && !other.stages.is_empty());
    let other = &other.summary;
    let of_both = |id: &str| named(run).any(|(_, own)| own == id) && named(other).any(|(_, own)| own == id);
    let is_row = |name: &str| run.key_numbers.iter().any(|number| number.name == name);
    let candidate = |one: &CandidateSummary| match of_both(&one.id) {
        true => Some(one.clone()),
        false => (!is_earlier).then(|| in_short(one)),
    };
    let candidates: Vec<CandidateSummary> = run.candidates.iter().filter_map(candidate).collect();
    let mut key_numbers = json!(run.key_numbers);
    for number in key_numbers.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
        ["value", "low", "high"].iter().for_each(|field| _ = number.remove(*field));
    }
    let mut walked = json!({
        "test": run.test, "key_numbers": key_numbers, "candidates": candidates,
        "predictions": predictions(run, is_earlier),
    });
    if !is_earlier && let Some(walked) = walked.as_object_mut() {
        let metrics = run.metrics.iter().filter(|(name, _)| !is_row(name));
        let figures =
            |one: &MetricSummary| json!({"value": one.value, "unit": one.unit, "low": one.low, "high": one.high});
        let metrics: BTreeMap<_, _> = metrics.map(|(name, one)| (name, figures(one))).collect();
        let others: Vec<Value> = run
            .other_metrics
            .iter()
            .map(|one| with_id(figures(&one.metric), format!("{} of {}", one.name, one.channel)))
            .collect();
        walked.extend([
            ("verdict".to_owned(), verdict(run)),
            ("limits".to_owned(), json!(kept.limits)),
            ("simplest".to_owned(), json!(run.simplest)),
            ("closest".to_owned(), json!(run.closest)),
            ("contact".to_owned(), json!(kept.contact.as_ref().filter(|_| with_artifacts))),
            ("events".to_owned(), json!(run.events.clone().map(|events| EventsV1 { impacts: Vec::new(), ..events }))),
            ("impacts".to_owned(), json!(run.impacts)),
            ("metrics".to_owned(), json!(metrics)),
            ("other_metrics".to_owned(), json!(others)),
            ("models".to_owned(), json!(run.models)),
            ("contradictions".to_owned(), remarks(run, true)),
            ("remarks".to_owned(), remarks(run, false)),
            ("warnings".to_owned(), json!(run.warnings)),
            ("best_undetermined".to_owned(), json!(run.best_undetermined)),
            ("best_hardly_determined".to_owned(), json!(run.best_hardly_determined)),
            ("matching_best".to_owned(), json!(run.matching_best)),
        ]);
    }
    without_asides(&mut walked);
    if !is_earlier {
        walked["concerns"] = concerns(run);
    }
    walked
}

/// The status without its words, and the one reason of it by its kind: its numbers are those of intervals.
fn verdict(run: &Summary) -> Value {
    let mut verdict = json!(run.verdict);
    let kind = verdict["status_reason"]["kind"].take();
    verdict["status_reason"] = kind;
    verdict
}

/// The warnings without a code by what they are about.
fn concerns(run: &Summary) -> Value {
    let mut by_subject: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for one in run.concerns.iter().filter(|concern| concern.code.is_empty()) {
        by_subject.entry(format!("{}, {}, weight {}", one.about, one.stage, one.weight)).or_default().push(&one.text);
    }
    // Under this name texts that say the same with other numbers are the same.
    json!(by_subject.iter().map(|(id, notes)| json!({"id": id, "notes": notes})).collect::<Vec<_>>())
}

/// The warnings with a code, with their values: what contradicts, or the others.
fn remarks(run: &Summary, contradict: bool) -> Value {
    let is_row = |code: &str| invariants().any(|row| row.kind.code == code);
    let is_meant =
        |remark: &&RemarkV1| remark.is_warning() && !remark.code.is_empty() && is_row(&remark.code) == contradict;
    remarks_by_code(&json!(run.remarks.iter().filter(is_meant).collect::<Vec<_>>()))
}

/// The predictions by what was asked, without the numbers of the rows.
fn predictions(run: &Summary, is_earlier: bool) -> Value {
    let of_best = |id: &str| run.recommended.as_deref() == Some(id);
    // Earlier versions kept those of the recommended candidate alone.
    let kept = scenarios(run).into_iter().filter(|one| !is_earlier || of_best(&one.made.candidate));
    // A prediction is of the mass of the test where both differ by no more than an engineer calls the same.
    let is_of_test = |mass_kg: f64| run.test.mass_kg.is_some_and(|own| (mass_kg - own).abs() <= SAME_SHARE * own);
    let one = |scenario: Scenario<'_>| {
        let mut value = json!(scenario.made);
        if of_best(&scenario.made.candidate) {
            for (_, field, _) in PREDICTED {
                value[field] = Value::Null;
            }
            value["intervals"] = Value::Null;
        }
        if is_of_test(scenario.made.mass_kg) {
            value["mass_kg"] = Value::Null;
        }
        with_id(value, scenario.id())
    };
    Value::from(kept.map(one).collect::<Vec<_>>())
}

fn with_id(mut value: Value, id: String) -> Value {
    value["id"] = Value::from(id);
    value
}

/// Removes fields that nobody decides by, at any depth. What is unknown is as what is not there.
fn without_asides(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, value| !ASIDE.contains(&name.as_str()) && !value.is_null());
            fields.values_mut().for_each(without_asides);
        }
        Value::Array(list) => list.iter_mut().for_each(without_asides),
        _ => {}
    }
}

/// The width of the interval that a place is an end of: `low` of `high`, or a parameter in `interval_low`.
fn width_of_interval(run: &Value, steps: &[Step]) -> Option<f64> {
    let [low, high] = ENDS_OF_PARAMETERS;
    let last = steps.len().checked_sub(1)?;
    let other_end = |(k, step): (usize, &Step)| {
        let Step::Field(field) = step else { return None };
        let other = match (field.as_str(), k == last) {
            ("low", true) => "high",
            ("high", true) => "low",
            (end, false) if end == low => high,
            (end, false) if end == high => low,
            _ => return None,
        };
        Some((k, Step::Field(other.to_owned())))
    };
    let (k, other) = steps.iter().enumerate().rev().find_map(other_end)?;
    let mut other_steps = steps.to_vec();
    other_steps[k] = other;
    Some((number_at(run, steps)? - number_at(run, &other_steps)?).abs())
}

/// The number at a place of the walk.
fn number_at(run: &Value, steps: &[Step]) -> Option<f64> {
    let mut value = run;
    for step in steps {
        value = match step {
            Step::Field(field) => value.get(field)?,
            Step::Index(index) => value.get(*index)?,
            Step::Element(name) => {
                let is_named = |one: &&Value| ["id", "name"].iter().any(|key| one[*key] == *name.as_str());
                value.as_array()?.iter().find(is_named)?
            }
        };
    }
    value.as_f64()
}

/// A value for people.
fn shown(value: Option<&Value>) -> String {
    match value {
        None | Some(Value::Null) => ABSENT.to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(number)) => match number.as_f64().filter(|_| number.is_f64()) {
            Some(value) => words::significant(value, 6),
            None => number.to_string(),
        },
        Some(Value::Object(fields)) => of_object(fields),
        Some(Value::Array(list)) => format!("{} of them", list.len()),
        Some(Value::Bool(is)) => is.to_string(),
    }
}

/// Of something that only one side has: its sentence, else that it is there.
fn of_object(fields: &Map<String, Value>) -> String {
    let sentence = fields.get("notes").and_then(|notes| notes.get(0)).and_then(Value::as_str);
    sentence.unwrap_or("there").to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::quantities::engineering;
    use super::super::review::Review;
    use super::*;

    /// A run as it is kept, with some of everything.
    fn run() -> Value {
        json!({
            "schema": Expected::SCHEMA,
            "record": ["crash.csv", "blake3:0123456789"],
            "contact": {"rule": "file", "source_time_s": 0.5},
            "options": {"filter": {"cfc": 60}},
            "stages": [{"stage": "filter", "version": "1", "digest": "d", "settings": "{\"cfc\":60}", "inputs": []}],
            "summary": {
                "schema": "crumple.summary.v1",
                "verdict": {"status": "usable", "status_reason": {"kind": "good-to", "good_to_percent": 5.0,
                    "prediction": 0}, "parameters": 2, "determined": 2, "open": 0},
                "test": {"title": "t", "mass_kg": 1400.0, "impact_speed_m_per_s": 15.0, "channel": "93",
                    "sample_rate_hz": 1e4},
                "events": {"channel": "93", "time_zero_s": 0.0, "time_zero_rule": "file", "still_separating": false,
                    "intervals": [{"name": "centroid_time_s", "low": 0.04, "high": 0.05, "interval_by": "x"}]},
                "impacts": [{"start_s": 0.0, "end_s": 0.08, "delta_v_m_per_s": 17.0, "is_lower_bound": false}],
                "key_numbers": [{"name": "dynamic_crush", "value": 0.7, "unit": "m", "channel": "93", "low": 0.69,
                    "high": 0.71, "is_lower_bound": false}],
                "metrics": {"dynamic_crush": {"value": 0.7, "unit": "m"},
                    "velocity_loss": {"value": 9.0, "unit": "m/s"}},
                "models": [{"id": "era-4", "order": 4, "fit_percent": 99.0}],
                "candidates": [{"id": "kelvin/direct-fit/1", "model": "kelvin", "method": "direct-fit",
                    "parameters": {"k1_n_per_m": 1e5}, "physical": true,
                    "certainties": {"parameters": 1, "determined": 1, "order_of_magnitude": [], "open": []},
                    "simulation": {"from_s": 0.0, "to_s": 0.1, "fit_percent": 99.98, "notes": []},
                    "uncertainty": {"method": "linearised", "standard_deviation": {"k1_n_per_m": 1e3},
                        "interval_low": {"k1_n_per_m": 9.8e4}, "interval_high": {"k1_n_per_m": 1.02e5}}}],
                "recommended": "kelvin/direct-fit/1",
                "simplest": "kelvin/direct-fit/1",
                "predictions": [{"candidate": "kelvin/direct-fit/1", "recommended": true, "impact_speed_m_per_s": 10.0,
                    "mass_kg": 1400.0, "dynamic_crush_m": 0.5, "delta_v_m_per_s": 11.0, "extrapolates": false,
                    "intervals": [{"name": "dynamic_crush_m", "level": 0.9, "low": 0.45, "high": 0.55,
                        "interval_by": "x"}]}],
                "concerns": [{"stage": "ingest", "severity": "warning", "about": "mass", "weight": 2,
                    "text": "the mass of 1400 kg is assumed", "remedy": null}],
                "remarks": [{"code": "CR203", "stage": "integrate", "about": "motion", "weight": 2,
                    "values": {"apart_m": 0.01}, "text": "apart", "remedy": null}],
                "warnings": 1,
            },
        })
    }

    fn reviewed(before: &Value, after: &Value) -> Review {
        let [a, b] = [before, after].map(|run| serde_json::from_value::<Expected>(run.clone()).unwrap());
        Review::new("crash", [&a, &b], &engineering(), |_, _| None)
    }

    /// Places of a kept run, another value there, and what names the change.
    fn changes() -> Vec<(&'static str, Value, &'static str)> {
        vec![
            ("/summary/verdict/status", json!("do-not-use"), "verdict.status"),
            ("/summary/verdict/status_reason/kind", json!("measured-only"), "verdict.status_reason"),
            ("/summary/verdict/determined", json!(0), "verdict.determined"),
            ("/summary/test/mass_kg", json!(1680.0), "test.mass_kg"),
            ("/summary/test/impact_speed_m_per_s", json!(18.0), "test.impact_speed_m_per_s"),
            ("/summary/test/channel", json!("94"), "test.channel"),
            ("/summary/events/still_separating", json!(true), "events.still_separating"),
            ("/summary/events/intervals/0/high", json!(0.06), "events.intervals[centroid_time_s].high"),
            ("/summary/impacts/0/is_lower_bound", json!(true), "impacts[0].is_lower_bound"),
            ("/summary/key_numbers/0/is_lower_bound", json!(true), "key_numbers[dynamic_crush].is_lower_bound"),
            ("/summary/key_numbers/0/value", json!(0.705), "dynamic_crush"),
            ("/summary/key_numbers/0/high", json!(0.78), "interval of Dynamic crush C"),
            ("/summary/key_numbers/0/high", Value::Null, "interval of Dynamic crush C"),
            ("/summary/key_numbers", json!([]), "dynamic_crush"),
            ("/summary/metrics/velocity_loss/value", json!(9.5), "metrics.velocity_loss.value"),
            ("/summary/models/0/fit_percent", json!(60.0), "models[era-4].fit_percent"),
            ("/summary/candidates/0/physical", json!(false), "candidates[kelvin/direct-fit/1].physical"),
            ("/summary/candidates/0/simulation/fit_percent", json!(20.0), "simulation.fit_percent"),
            ("/summary/candidates/0/certainties/determined", json!(0), "certainties.determined"),
            ("/summary/candidates/0/parameters/k1_n_per_m", json!(1.1e5), "k1_n_per_m"),
            ("/summary/candidates/0/uncertainty/interval_high/k1_n_per_m", json!(1.3e5), "interval of k1"),
            ("/summary/candidates/0/uncertainty/interval_high/k1_n_per_m", Value::Null, "interval of k1"),
            ("/summary/simplest", json!("maxwell/direct-fit/1"), "simplest"),
            ("/summary/predictions", json!([]), "predictions[recommended at 36.0 km/h]"),
            ("/summary/predictions/0/delta_v_m_per_s", json!(13.2), "delta_v at 36.0 km/h"),
            ("/summary/predictions/0/olc_m_per_s2", json!(200.0), "olc at 36.0 km/h"),
            ("/summary/predictions/0/intervals/0/low", json!(0.1), "interval of Predicted crush"),
            ("/summary/predictions/0/intervals", json!([]), "interval of Predicted crush"),
            ("/summary/predictions/0/extrapolates", json!(true), "extrapolates"),
            ("/summary/concerns", json!([]), "concerns[mass, ingest, weight 2]"),
            ("/summary/concerns/0/weight", json!(3), "concerns[mass, ingest, weight 3]"),
            ("/summary/remarks", json!([]), "contradictions[CR203]"),
            ("/contact/source_time_s", json!(0.6), "contact.source_time_s"),
        ]
    }

    #[test]
    fn all_that_people_decide_by_is_compared() {
        let before = run();
        let mut unseen = Vec::new();
        for (place, value, name) in changes() {
            let mut after = run();
            match after.pointer_mut(place) {
                Some(at) => *at = value.clone(),
                None => {
                    let (parent, key) = place.rsplit_once('/').unwrap();
                    after.pointer_mut(parent).unwrap()[key] = value.clone();
                }
            }
            let review = reviewed(&before, &after);
            let rows = review.differing().map(|row| row.key.clone());
            let named: Vec<String> = rows.chain(review.facts.iter().map(|fact| fact.key.clone())).collect();
            if review.is_same() || !named.iter().any(|one| one.contains(name)) {
                unseen.push(format!("{place} {value}: {named:?}"));
            }
        }
        assert!(unseen.is_empty(), "{}", unseen.join("\n"));
    }

    #[test]
    fn what_counts_as_the_same_is_the_same() {
        let before = run();
        for (place, value) in [
            ("/summary/verdict/status_sentence", json!("other words")),
            ("/summary/verdict/status_reason/good_to_percent", json!(6.0)),
            ("/summary/key_numbers/0/value", json!(0.7005)),
            ("/summary/key_numbers/0/high", json!(0.7109)),
            ("/summary/events/intervals/0/high", json!(0.0504)),
            ("/summary/candidates/0/uncertainty/interval_high/k1_n_per_m", json!(1.0215e5)),
            ("/summary/predictions/0/intervals/0/low", json!(0.454)),
            ("/summary/concerns/0/text", json!("the mass of 1401 kg is assumed")),
            ("/summary/test/mass_kg", json!(1401.0)),
        ] {
            let mut after = run();
            *after.pointer_mut(place).unwrap_or(&mut Value::Null) = value;
            let review = reviewed(&before, &after);
            assert!(review.is_same(), "{place}: {:?}", review.facts);
        }
    }

    #[test]
    fn of_what_an_earlier_version_kept_the_rest_is_said_to_be_not_compared() {
        let mut before = run();
        before["schema"] = json!("crumple.expected.v1");
        for gone in ["events", "impacts", "metrics", "concerns", "remarks", "models", "verdict", "simplest"] {
            before["summary"].as_object_mut().unwrap().remove(gone);
        }
        before["contact"] = Value::Null;
        before["options"] = json!({});
        let mut after = run();
        let review = reviewed(&before, &after);
        assert!(review.is_same() && review.not_compared().is_some(), "{:?}", review.facts);
        assert!(review.causes.is_empty(), "{:?}", review.causes);
        after["summary"]["verdict"]["status"] = json!("do-not-use");
        assert!(reviewed(&before, &after).is_same());
        after["summary"]["test"]["mass_kg"] = json!(900.0);
        assert!(!reviewed(&before, &after).is_same());
    }

    #[test]
    fn an_artifact_that_is_gone_is_a_difference_and_another_content_one_where_all_counts() {
        let before = run();
        let mut after = run();
        after["stages"] = json!([]);
        assert!(!reviewed(&before, &after).is_same());
        after["stages"] = run()["stages"].clone();
        after["stages"][0]["digest"] = json!("other");
        let review = reviewed(&before, &after);
        assert!(review.is_same() && review.artifacts_line().is_some());
        let [a, b] = [&before, &after].map(|run| serde_json::from_value::<Expected>(run.clone()).unwrap());
        let exact = crumple_diff::Tolerances { base: crumple_diff::Base::Exact, ..Default::default() };
        let exact = CompareSettings { tolerances: exact, ..CompareSettings::default() };
        assert!(!Review::new("crash", [&a, &b], &exact, |_, _| None).is_same());
        let mut provenance = engineering();
        provenance.provenance = true;
        after["options"]["filter"]["cfc"] = json!(180);
        let b = serde_json::from_value::<Expected>(after).unwrap();
        let review = Review::new("crash", [&a, &b], &provenance, |_, _| None);
        assert!(!review.is_same() && review.causes[0].name == "filter.cfc", "{:?}", review.causes);
    }
}
