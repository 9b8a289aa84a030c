//! Records as users bring them: each is read right, or refused with advice that is followed here as it is printed, by
//! `crumple run` and by the program that reads. No advice leads in a circle, to an error of usage or further than three
//! steps.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use crumple_testkit::programs::binary;
use serde_json::{Map, Value};

use crate::Check;

/// Advice followed one after the other.
const STEPS: usize = 3;

/// What of a case is not met; the records lie beside the file of the cases.
pub fn check(file: Value) -> Check {
    let folder = PathBuf::from(file["folder"].as_str().unwrap_or("."));
    Box::new(move |case| {
        let of_case = Case { record: folder.join(case["file"].as_str().unwrap()), case };
        let expected = &case["expect"];
        match expected["any_of"].as_array() {
            None => of_case.not_met(expected),
            Some(ways) => {
                let all: Vec<Vec<String>> = ways.iter().map(|way| of_case.not_met(way)).collect();
                if all.iter().any(Vec::is_empty) { Vec::new() } else { all.concat() }
            }
        }
        .into_iter()
        .chain(of_case.programs().iter().filter_map(|program| of_case.follow(program).err()))
        .collect()
    })
}

struct Case<'a> {
    record: PathBuf,
    case: &'a Value,
}

/// What a command came to.
struct Answer {
    code: i64,
    said: String,
    summary: Value,
}

impl Case<'_> {
    fn not_met(&self, expected: &Value) -> Vec<String> {
        let arguments: Vec<String> = texts(&self.case["args"]);
        let program = self.case["program"].as_str().unwrap();
        let mut faults = Vec::new();
        let mut answer = self.run(program, &arguments);
        if expected["hint_works"] == true {
            match self.follow(program) {
                Ok(last) => answer = last,
                Err(fault) => return vec![fault],
            }
        } else if let Some(then) = expected["then"].as_array() {
            let met = |answer: &Answer| said(expected, &answer.said);
            faults.extend(met(&answer));
            let then =
                self.run(program, &[arguments, then.iter().map(|v| v.as_str().unwrap().to_owned()).collect()].concat());
            answer = Answer { said: answer.said + &then.said, ..then };
        }
        let followed = expected["hint_works"] == true;
        let codes: Vec<i64> =
            expected["exit"].as_array().unwrap_or(&Vec::new()).iter().filter_map(Value::as_i64).collect();
        let is_right = codes.is_empty() || codes.contains(&answer.code) || (followed && answer.code == 0);
        if !is_right {
            faults.push(format!("exit {}: {}", answer.code, answer.said));
        }
        faults.extend(said(expected, &(answer.said.clone() + &remarks(&answer.summary))));
        faults.extend(numbers(expected, &answer));
        faults
    }

    /// The programs that read its record.
    fn programs(&self) -> &'static [&'static str] {
        match self.case["program"].as_str() {
            Some("run") => &["run", "ingest"],
            Some("ingest") => &["ingest"],
            _ => &[],
        }
    }

    /// Follows what a refusal advises, and what the next one does, to a result or to advice that is no flag.
    fn follow(&self, program: &str) -> Result<Answer, String> {
        let expected = &self.case["expect"];
        let ways = expected["any_of"].as_array().into_iter().flatten().chain([expected]);
        let knows: Map<String, Value> = ways.filter_map(|way| way["knows"].as_object().cloned()).flatten().collect();
        let mut arguments = texts(&self.case["args"]);
        if let Some(k) = arguments.iter().position(|word| word == "--set").filter(|_| program == "ingest") {
            arguments.drain(k..k + 2);
        }
        let (mut answer, mut refusals) = (self.run(program, &arguments), BTreeSet::new());
        while !matches!(answer.code, 0 | 4) {
            let advice = advised(&answer.said, &arguments, &knows);
            if advice.is_empty() && answer.code == 3 && !hint(&answer.said).contains("--") {
                break;
            }
            if answer.code != 3 || advice.is_empty() || refusals.len() == STEPS || !refusals.insert(answer.said.clone())
            {
                return Err(format!("the advice leads nowhere after {arguments:?} of {program}: {}", answer.said));
            }
            arguments.extend(advice);
            answer = self.run(program, &arguments);
        }
        Ok(answer)
    }

    /// Runs a program on the record of the case, in its folder as a user does.
    fn run(&self, program: &str, arguments: &[String]) -> Answer {
        let out = tempfile::tempdir().unwrap();
        let (folder, name) = (self.record.parent().unwrap(), self.record.file_name().unwrap());
        let crumple = |words: &[&str], input: &Path| {
            let mut command = Command::new(binary("crumple"));
            command.current_dir(folder).args(words).arg(input);
            command
        };
        let path = |name: &str| out.path().join(name);
        let answer = |command: &mut Command| {
            let output = command.output().unwrap();
            let text = [output.stdout, output.stderr].concat();
            let summary =
                std::fs::read(path("summary.json")).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
            Answer {
                code: output.status.code().map_or(-1, i64::from),
                said: String::from_utf8_lossy(&text).replace(&*out.path().to_string_lossy(), ""),
                summary: summary.unwrap_or_default(),
            }
        };
        match program {
            "run" => answer(crumple(&["run"], Path::new(name)).args(arguments).arg("-o").arg(out.path())),
            "ingest" if arguments.iter().any(|word| word == "--list") => {
                answer(crumple(&["ingest"], Path::new(name)).args(arguments))
            }
            "ingest" => answer(crumple(&["ingest"], Path::new(name)).args(arguments).arg("-o").arg(path("1.mcap"))),
            "identify" => {
                let read =
                    answer(crumple(&["ingest", "--allow-missing"], Path::new(name)).arg("-o").arg(path("1.mcap")));
                if read.code != 0 {
                    return read;
                }
                answer(crumple(&["identify"], &path("1.mcap")).args(arguments).arg("-o").arg(path("4.mcap")))
            }
            other => panic!("program {other} is not known"),
        }
    }
}

fn texts(list: &Value) -> Vec<String> {
    list.as_array().unwrap_or(&Vec::new()).iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// What the last hint advises: an option of another stage as it is; a flag that is not given yet, with what the user
/// knows of it, else with the value of the hint.
fn advised(said: &str, given: &[String], knows: &Map<String, Value>) -> Vec<String> {
    let hint = hint(said);
    let trim = |word: &str| word.trim_end_matches([',', ';', ':', ')', '.']).trim_matches('"').to_owned();
    let words: Vec<&str> = hint.split_whitespace().collect();
    if let Some(k) = words.iter().position(|word| *word == "--set") {
        return vec!["--set".to_owned(), trim(words[k + 1])];
    }
    let flags = || words.iter().enumerate().filter(|(_, word)| word.starts_with("--") && !given.contains(&trim(word)));
    let known = flags().find_map(|(_, flag)| Some((trim(flag), texts(knows.get(&trim(flag)[2..])?).first()?.clone())));
    let stated = || flags().find_map(|(k, flag)| Some((trim(flag), trim(words.get(k + 1)?))));
    known.or_else(stated).map(|(flag, value)| vec![flag, value]).unwrap_or_default()
}

/// The last hint; empty where there is none.
fn hint(said: &str) -> &str {
    said.lines().rev().find_map(|line| line.trim().strip_prefix("hint: ")).unwrap_or_default()
}

fn remarks(summary: &Value) -> String {
    format!("{}{}", summary["notes"], summary["concerns"])
}

/// What has to be said, and is not; what must not, and is.
pub fn said(expected: &Value, text: &str) -> Vec<String> {
    let is_said = |pattern: &String| regex::Regex::new(pattern).unwrap().is_match(text);
    let missing = texts(&expected["must_say"]).into_iter().filter(|pattern| !is_said(pattern));
    let missing: Vec<String> = missing.map(|pattern| format!("{pattern} is not said: {text}")).collect();
    let wrong = texts(&expected["must_not_say"]).into_iter().filter(is_said);
    [missing, wrong.map(|pattern| format!("{pattern} is said: {text}")).collect()].concat()
}

/// Numbers outside their ranges.
fn numbers(expected: &Value, answer: &Answer) -> Vec<String> {
    let summary = &answer.summary;
    let metric = |name: &str| summary["metrics"][name]["value"].as_f64();
    let event = |name: &str| summary["events"][name].as_f64();
    let recommended =
        summary["candidates"].as_array().into_iter().flatten().find(|c| c["id"] == summary["recommended"]);
    let fit = recommended.and_then(|c| {
        let simulation = &c["simulation"];
        simulation["fit_as_measured_percent"].as_f64().or_else(|| simulation["fit_percent"].as_f64())
    });
    let of_models = summary["models"].as_array().into_iter().flatten().filter_map(|m| m["fit_percent"].as_f64());
    let of_lines = answer.said.lines().filter(|line| line.contains("fit ")).filter_map(|line| {
        line.split("fit ").nth(1)?.split_whitespace().next()?.trim_end_matches('%').parse::<f64>().ok()
    });
    let best = fit.or_else(|| of_models.chain(of_lines).reduce(f64::max));
    let found = [
        ("crush_mm", event("dynamic_crush_m").map(|m| 1e3 * m)),
        ("peak_g", metric("peak_acceleration").map(|a| a.abs() / G)),
        ("delta_v_m_s", event("delta_v_m_per_s").or_else(|| metric("delta_v")).map(f64::abs)),
        ("hic15", metric("hic15")),
    ];
    let delta_v = &summary["metrics"]["delta_v"];
    let spread = ["low", "high"].map(|end| ("spread_delta_v_km_h", delta_v[end].as_f64().map(|v| 3.6 * v.abs())));
    let spread = spread.into_iter().filter(|(_, end)| end.is_some());
    let found: Vec<(&str, Option<f64>)> = found.into_iter().chain(spread).collect();
    let ranges = found.iter().filter_map(|(name, value)| {
        let range = expected[*name].as_array()?;
        let is_inside = value.is_some_and(|x| range[0].as_f64() <= Some(x) && Some(x) <= range[1].as_f64());
        (!is_inside).then(|| format!("{name} is {value:?}, expected {range:?}"))
    });
    let least = expected["fit_at_least"].as_f64().filter(|least| best.is_none_or(|fit| fit < *least));
    ranges.chain(least.map(|least| format!("fit {best:?}, expected {least} at least"))).collect()
}
