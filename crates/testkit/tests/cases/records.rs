//! Records as users bring them: each is read right, or refused with advice that is followed here as it is printed, by
//! `crumple run` and by the program that reads. No advice leads in a circle, to an error of usage or further than three
//! steps.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_testkit::programs::binary;
use serde_json::{Map, Value};

use crate::Check;
use crate::expected::{numbers, remarks, said};
use crate::reviews;

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
#[derive(Default)]
pub struct Answer {
    pub code: i64,
    pub said: String,
    pub summary: Value,
    /// What `identify` wrote, a topic and its data each.
    pub records: Vec<(String, Value)>,
    /// Tables that `export` wrote.
    pub tables: Vec<String>,
}

impl Case<'_> {
    fn not_met(&self, expected: &Value) -> Vec<String> {
        let arguments: Vec<String> = texts(&self.case["args"]);
        let program = self.case["program"].as_str().unwrap();
        let mut faults = Vec::new();
        let ways = self.with_flags(expected, program, &arguments);
        if !ways.is_empty() {
            let all: Vec<Vec<String>> =
                ways.iter().map(|way| self.faults(expected, &self.run(program, way), false)).collect();
            return if all.iter().any(Vec::is_empty) { Vec::new() } else { all.concat() };
        }
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
        faults.extend(self.faults(expected, &answer, expected["hint_works"] == true));
        faults
    }

    /// The arguments with what the help of a stage, or what the warnings of the run, offer beside them.
    fn with_flags(&self, expected: &Value, program: &str, arguments: &[String]) -> Vec<Vec<String>> {
        if let Some(flag) = expected["help_flag"].as_object() {
            let stage = flag["stage"].as_str().unwrap();
            let help = Command::new(binary("crumple")).args([stage, "--help"]).output().unwrap();
            let help = String::from_utf8_lossy(&help.stdout).into_owned();
            let is_meant = regex::Regex::new(flag["says"].as_str().unwrap()).unwrap();
            let flags = options(&help).into_iter().filter(|option| is_meant.is_match(option));
            let names = flags
                .filter_map(|option| option.split_whitespace().find(|word| word.starts_with("--")).map(str::to_owned));
            let values = texts(&flag["values"]);
            let pair = |name: &str, value: &String| match value.as_str() {
                "" => vec![name.to_owned()],
                value => vec![name.to_owned(), value.to_owned()],
            };
            return names
                .flat_map(|name| {
                    values.iter().map(|value| [arguments, &pair(&name, value)].concat()).collect::<Vec<_>>()
                })
                .collect();
        }
        if expected["warning_works"] != true {
            return Vec::new();
        }
        let answer = self.run(program, arguments);
        let warnings = answer.said.clone() + &remarks(&answer.summary);
        let words: Vec<&str> = warnings.split_whitespace().collect();
        let is_flag = |word: &str| word.starts_with("--") && word != "--sign";
        let trim = |word: &str| word.trim_matches(|c: char| "\"',;:).(".contains(c)).to_owned();
        let flags = words.windows(2).filter(|pair| is_flag(pair[0]));
        flags.map(|pair| [arguments, &[trim(pair[0]), trim(pair[1])]].concat()).collect()
    }

    /// What of an answer is not as expected.
    fn faults(&self, expected: &Value, answer: &Answer, followed: bool) -> Vec<String> {
        let mut faults = Vec::new();
        let codes: Vec<i64> =
            expected["exit"].as_array().unwrap_or(&Vec::new()).iter().filter_map(Value::as_i64).collect();
        let is_right = codes.is_empty() || codes.contains(&answer.code) || (followed && answer.code == 0);
        if !is_right {
            faults.push(format!("exit {}: {}", answer.code, answer.said));
        }
        faults.extend(said(expected, &(answer.said.clone() + &remarks(&answer.summary))));
        faults.extend(numbers(expected, answer));
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
            // What is given already is given anew.
            let given = arguments.iter().position(|word| *word == advice[0] && advice[0] != "--set");
            if let Some(k) = given {
                arguments.drain(k..k + 2);
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
                ..Answer::default()
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
                let identified =
                    answer(crumple(&["identify"], &path("1.mcap")).args(arguments).arg("-o").arg(path("4.mcap")));
                let shown = answer(&mut crumple(&["show", "--json"], &path("4.mcap")));
                let line = |line: &str| {
                    let record: Value = serde_json::from_str(line).ok()?;
                    Some((record["topic"].as_str()?.to_owned(), record["data"].clone()))
                };
                Answer { records: shown.said.lines().filter_map(line).collect(), ..identified }
            }
            "export" => {
                let made = answer(crumple(&["run"], Path::new(name)).args(arguments).arg("-o").arg(path("run")));
                if !matches!(made.code, 0 | 4) {
                    return made;
                }
                let exported = answer(crumple(&["export", "--to", "csv"], &path("run")).arg("-o").arg(path("tables")));
                let files = std::fs::read_dir(path("tables")).into_iter().flatten().flatten();
                Answer { tables: files.filter_map(|f| std::fs::read_to_string(f.path()).ok()).collect(), ..exported }
            }
            "script" => reviews::typed(self.case["script"].as_str().unwrap(), folder),
            other => panic!("program {other} is not known"),
        }
    }
}

pub fn texts(list: &Value) -> Vec<String> {
    list.as_array().unwrap_or(&Vec::new()).iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// The options of a help, each with its text.
fn options(help: &str) -> Vec<String> {
    let mut options: Vec<String> = Vec::new();
    for line in help.lines() {
        match options.last_mut() {
            _ if line.trim_start().starts_with('-') => options.push(line.to_owned()),
            Some(option) => *option += &format!("\n{line}"),
            None => {}
        }
    }
    options
}

/// What the last hint advises: an option of another stage as it is; a flag that is not given yet, with what the user
/// knows of it, else with the value of the hint; else a flag that is given, with another value.
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
    let corrected = || {
        let values = given.windows(2).filter(|pair| pair[0].starts_with("--"));
        let advised = |flag: &str| words.windows(2).find(|pair| trim(pair[0]) == flag).map(|pair| trim(pair[1]));
        let mut other = values.filter_map(|pair| Some((pair[0].clone(), advised(&pair[0])?, &pair[1])));
        other.find(|(_, value, before)| value != *before).map(|(flag, value, _)| (flag, value))
    };
    let advice = known.or_else(stated).or_else(corrected);
    advice.map(|(flag, value)| vec![flag, value]).unwrap_or_default()
}

/// The last hint; empty where there is none.
fn hint(said: &str) -> &str {
    said.lines().rev().find_map(|line| line.trim().strip_prefix("hint: ")).unwrap_or_default()
}
