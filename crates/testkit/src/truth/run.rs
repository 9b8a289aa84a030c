//! A run of a case by the programs, and what it says where.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};
use std::{fs, io};

use crumple_artifact::records::{RatedCandidateV1, RecommendationV1};
use crumple_artifact::{Artifact, Wave};
use crumple_signal::Sampled;
use serde_json::Value;

use crate::programs::{ARTIFACTS, just};
use crate::truth::cases::{Question, RunCase};
use crate::truth::known::{Known, Subject};
use crate::truth::template::without_tags;

/// What a run has left.
#[derive(Debug)]
pub struct Made {
    /// The case's name.
    pub name: String,
    /// What is true of its record.
    pub known: Known,
    /// What was asked of it.
    pub question: Option<Question>,
    /// Exit code.
    pub code: i32,
    /// What it printed, line by line.
    pub console: Vec<String>,
    /// `summary.json`.
    pub summary: Value,
    /// The texts of the first screen of `report.html`.
    pub page: Vec<Block>,
    /// The captions of all figures of `report.html`, as one text.
    pub captions: String,
    /// Waves by topic without its beginning, those of later stages in the place of earlier ones.
    pub waves: BTreeMap<String, Wave>,
    /// The records of its artifacts: topic and content.
    pub records: Vec<(String, Value)>,
    /// The choice of a candidate.
    pub choice: Option<RecommendationV1>,
    /// Every number of the summary and of those records, also of their texts; of waves the ends and the counts.
    pub all_numbers: Vec<f64>,
}

/// Why a run could not be read.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Runs a case in a folder of its own by the programs in `bin`. Errors: the run ends with another code than 0 or 4, or
/// leaves no summary or page.
pub fn run(case: &RunCase, bin: &Path, folder: &Path) -> Result<Made, Failure> {
    let folder = folder.join(case.name.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
    let variables = || {
        let own = case.variables.iter().map(|variable| variable.replace("$BIN", &bin.display().to_string()));
        std::iter::once(format!("bin={}", bin.display())).chain(own)
    };
    let mut output = if case.known.subject == Subject::InputOutput {
        identify_alone(case, bin, &folder)?
    } else {
        let mut command = just();
        command.args(variables()).arg(format!("out={}", folder.display()));
        command.arg("run").arg(&case.record).args(&case.flags).env("RAYON_NUM_THREADS", "1").output()?
    };
    if let Some(question) = case.question.filter(|_| output.status.success()) {
        let mut command = just();
        command.args(variables()).arg("predict").arg(&folder).args(question.flags);
        output = command.env("RAYON_NUM_THREADS", "1").output()?;
    }
    if !case.reported.is_empty() && output.status.success() {
        output = report_alone(case, bin, &folder)?;
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let code = output.status.code().unwrap_or(-1);
    if !matches!(code, 0 | 4) {
        return Err(format!("{}: exit {code}: {said}", case.name).into());
    }
    let made = Made::read(case, code, &said, &folder)?;
    fs::remove_dir_all(&folder)?;
    Ok(made)
}

/// Only some artifacts are left and reported anew; what the report prints.
fn report_alone(case: &RunCase, bin: &Path, folder: &Path) -> Result<Output, Failure> {
    for (_, name) in ARTIFACTS.iter().enumerate().filter(|(place, _)| !case.reported.contains(place)) {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error.into()),
            _ => {}
        }
    }
    let left = case.reported.iter().map(|place| ARTIFACTS[*place]);
    let arguments = left.chain(["-o", "report.html", "--summary", "summary.json"]);
    Ok(Command::new(bin.join("crumple-report")).args(arguments).current_dir(folder).output()?)
}

/// A record that is no crash goes through ingest, identify and report, by their own commands; what the report prints.
fn identify_alone(case: &RunCase, bin: &Path, folder: &Path) -> Result<Output, Failure> {
    fs::create_dir_all(folder)?;
    let record = case.record.display().to_string();
    let (ingest, identify): (Vec<&str>, Vec<&str>) =
        case.flags.iter().map(String::as_str).partition(|flag| INGEST.iter().any(|own| flag.starts_with(own)));
    let steps: [(&str, Vec<&str>); 3] = [
        ("ingest", [vec![record.as_str(), "-q", "-o", ARTIFACTS[0]], ingest].concat()),
        ("identify", [vec![ARTIFACTS[0], "-q", "-o", ARTIFACTS[3]], identify].concat()),
        ("report", vec![ARTIFACTS[0], ARTIFACTS[3], "-o", "report.html", "--summary", "summary.json"]),
    ];
    let mut last = Err("no step".into());
    for (program, arguments) in steps {
        let output =
            Command::new(bin.join(format!("crumple-{program}"))).args(arguments).current_dir(folder).output()?;
        if !matches!(output.status.code(), Some(0 | 4)) {
            return Ok(output);
        }
        last = Ok(output);
    }
    last
}

/// Flags of ingest among those of such a record; the others are those of identify.
const INGEST: [&str; 2] = ["--sample-time", "--allow-missing"];

impl Made {
    fn read(case: &RunCase, code: i32, said: &str, folder: &Path) -> Result<Self, Failure> {
        let (mut waves, mut records, mut all_numbers) = (BTreeMap::new(), Vec::new(), Vec::new());
        for path in ARTIFACTS.iter().map(|name| folder.join(name)).filter(|path| path.is_file()) {
            let artifact = Artifact::open(&path)?;
            artifact.waves().values().for_each(|wave| numbers_of_wave(&wave.sampled, &mut all_numbers));
            waves.extend(artifact.waves().iter().map(|(id, wave)| (id.clone(), wave.clone())));
            let json = artifact.records().iter().filter(|raw| raw.encoding == "json");
            for raw in json {
                records.push((raw.topic.clone(), serde_json::from_slice(&raw.payload)?));
            }
        }
        let read = |name: &str| -> io::Result<String> { fs::read_to_string(folder.join(name)) };
        let summary: Value = serde_json::from_str(&read("summary.json")?)?;
        records.iter().map(|(_, record)| record).chain([&summary]).for_each(|value| collect(value, &mut all_numbers));
        let html = read("report.html")?;
        let choice = records.iter().find(|(topic, _)| topic == "/recommendation");
        Ok(Self {
            all_numbers,
            choice: choice.map(|(_, record)| serde_json::from_value(record.clone())).transpose()?,
            name: case.name.clone(),
            known: case.known.clone(),
            question: case.question,
            code,
            console: said.lines().map(plain_line).collect(),
            summary,
            page: first_screen(&html),
            captions: captions(&html),
            waves,
            records,
        })
    }

    /// A number of the summary.
    pub fn number(&self, pointer: &str) -> Option<f64> {
        self.summary.pointer(pointer)?.as_f64()
    }

    /// A text of the summary.
    pub fn text(&self, pointer: &str) -> &str {
        self.summary.pointer(pointer).and_then(Value::as_str).unwrap_or_default()
    }

    /// A list of the summary.
    pub fn list(&self, pointer: &str) -> &[Value] {
        self.summary.pointer(pointer).and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// A candidate by its id.
    pub fn candidate(&self, id: &str) -> Option<&Value> {
        self.list("/candidates").iter().find(|candidate| candidate["id"] == id)
    }

    /// The recommended one.
    pub fn recommended(&self) -> Option<&Value> {
        self.candidate(self.summary["recommended"].as_str()?)
    }

    /// A candidate by its name in words: `Kelvin, direct fit 1`.
    pub fn candidate_named(&self, words: &str) -> Option<&Value> {
        self.list("/candidates")
            .iter()
            .find(|candidate| candidate["id"].as_str().map(in_words) == Some(words.to_owned()))
    }

    /// How the choice rated a candidate.
    pub fn rated(&self, candidate: &Value) -> Option<&RatedCandidateV1> {
        self.choice.as_ref()?.candidates.iter().find(|rated| candidate["id"] == rated.id.as_str())
    }

    /// What the warnings say, gravest first.
    pub fn concerns(&self) -> impl Iterator<Item = &str> {
        self.list("/concerns").iter().filter_map(|concern| concern["text"].as_str())
    }

    /// Whether it is of a vehicle at a wall.
    pub fn is_of_a_vehicle(&self) -> bool {
        self.known.subject == Subject::Vehicle
    }
}

/// What is said of a wave: its mean, also over its deviation, its ends, its extremes, its first instant, and how many
/// samples it has in all, before and
/// from time zero on.
fn numbers_of_wave(wave: &Sampled, numbers: &mut Vec<f64>) {
    let samples = wave.samples();
    let (low, high) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let before = (-wave.t0_s() / wave.dt_s()).round();
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    let deviation = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples.len() as f64).sqrt();
    numbers.extend([mean, mean / deviation]);
    let counts = [samples.len() as f64, before, samples.len() as f64 - before];
    numbers.extend(counts.into_iter().flat_map(|count| [count, count - 1.0, count - 2.0]));
    numbers.extend(samples.first().into_iter().chain(samples.last()).chain([&low, &high, &wave.t0_s()]));
}

/// Settings stand in records as texts, as a person types them; sentences are none of a record's numbers.
const LONGEST_SETTING: usize = 40;

fn collect(value: &Value, into: &mut Vec<f64>) {
    match value {
        Value::Number(number) => into.extend(number.as_f64()),
        Value::Array(values) => values.iter().for_each(|value| collect(value, into)),
        Value::Object(fields) => fields.values().for_each(|value| collect(value, into)),
        Value::String(text) if text.len() < LONGEST_SETTING => {
            into.extend(numbers(text).iter().map(|shown| shown.value));
        }
        _ => {}
    }
}

/// A candidate's id as people read it: `kelvin/direct-fit/1` is "Kelvin, direct fit 1".
pub fn in_words(id: &str) -> String {
    let mut parts = id.splitn(3, '/');
    let (model, method, index) = (parts.next().unwrap_or_default(), parts.next(), parts.next());
    let model = model.replace("spring-mass-damper", "spring_mass_damper").replace('-', " ").replace('_', "-");
    let mut letters = model.chars();
    let model: String = letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect();
    match (method, index) {
        (Some(method), Some(index)) => format!("{model}, {} {index}", method.replace('-', " ")),
        _ => id.to_owned(),
    }
}

/// A line with its blanks at the start, which say whose it is.
fn plain_line(line: &str) -> String {
    let start = line.len() - line.trim_start().len();
    format!("{}{}", &line[..start], if start < line.len() { spaced(&line[start..]) } else { String::new() })
}

/// Columns of blanks stay; characters that look like blanks become one.
fn spaced(text: &str) -> String {
    let (label, rest) = text.split_once("  ").unwrap_or(("", text));
    if label.is_empty() { plain(rest) } else { format!("{}  {}", plain(label), plain(rest)) }
}

/// A piece of text of a page.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// The section it stands in: `verdict`, `before-use`, `model`, `numbers`, `header`, ...
    pub section: String,
    /// Its element: `p`, `li`, `dt`, ...
    pub element: String,
    /// The key of the card, or the class of the element.
    pub key: String,
    /// The text.
    pub text: String,
}

/// Elements whose text is a piece by itself.
const PIECES: [&str; 14] =
    ["h1", "h2", "h3", "h4", "p", "li", "dt", "dd", "figcaption", "caption", "th", "td", "strong-status", "summary"];

/// From the header to what lies below the answer: the figures.
fn first_screen(html: &str) -> Vec<Block> {
    let body = html.split_once("<header>").map_or(html, |(_, rest)| rest);
    let end = [
        "<section id=\"figures\"",
        "<figure class=\"figure",
        "id=\"crash\"",
        "class=\"figure",
        "id=\"models\"",
        "id=\"identification\"",
    ];
    let end = end.iter().filter_map(|mark| body.find(mark)).min().unwrap_or(body.len());
    pieces(&body[..end])
}

/// The captions of all figures.
pub fn captions(html: &str) -> String {
    let all = pieces(html).into_iter().filter(|block| block.element == "figcaption" || block.key.contains("caption"));
    all.map(|block| block.text).collect::<Vec<_>>().join(" ")
}

fn pieces(html: &str) -> Vec<Block> {
    let (mut section, mut card) = ("header".to_owned(), String::new());
    let mut blocks = Vec::new();
    let mut rest = html;
    while let Some((_, behind)) = rest.split_once('<') {
        let Some((tag, inside)) = behind.split_once('>') else { break };
        rest = inside;
        let name = tag.split([' ', '\n']).next().unwrap_or_default();
        match name {
            "svg" | "script" | "style" => {
                rest = inside.split_once(&format!("</{name}>")).map_or("", |(_, behind)| behind);
            }
            "section" => section = attribute(tag, "id").or(attribute(tag, "class")).unwrap_or_default(),
            "div" if tag.contains("data-key") => card = attribute(tag, "data-key").unwrap_or_default(),
            _ if PIECES.contains(&name) => {
                let (text, behind) = inside.split_once(&format!("</{name}>")).unwrap_or((inside, ""));
                rest = behind;
                let key = if section == "numbers" { card.clone() } else { attribute(tag, "class").unwrap_or_default() };
                let text = plain(&without_tags(text));
                if !text.is_empty() {
                    blocks.push(Block { section: section.clone(), element: name.to_owned(), key, text });
                }
            }
            _ => {}
        }
    }
    blocks
}

fn attribute(tag: &str, name: &str) -> Option<String> {
    let (_, value) = tag.split_once(&format!("{name}=\""))?;
    value.split_once('"').map(|(value, _)| value.to_owned())
}

/// Factors from the SI unit of a record to the units that a text may show it in.
const UNITS: [(&str, f64); 18] = [
    ("mm", 1e3),
    ("ms", 1e3),
    ("km/h", 3.6),
    ("g", 1.0 / 9.806_65),
    ("kN·s/m", 1e-3),
    ("kN/m", 1e-3),
    ("kN", 1e-3),
    ("kJ", 1e-3),
    ("kg", 1.0),
    ("m/s²", 1.0),
    ("m/s^2", 1.0),
    ("m/s", 1.0),
    ("rad/s", 1.0),
    ("1/s", 1.0),
    ("%", 1.0),
    ("Hz", 1.0),
    ("m", 1.0),
    ("s", 1.0),
];

/// Half a unit of the last digit, and what binary fractions add.
const HALF: f64 = 0.500_000_1;

/// A number as a text shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    /// As it is written, in its unit.
    pub value: f64,
    /// Digits after the point.
    pub decimals: usize,
    /// From SI to its unit; 1 of a number without one.
    pub factor: f64,
    /// Half of what its last digit counts, in its unit.
    half: f64,
}

impl Shown {
    /// Whether it is this number in SI, rounded as it is shown.
    pub fn is_of(&self, si: f64) -> bool {
        (si * self.factor - self.value).abs() <= self.half
    }

    /// Whether it is this number of a record, rounded as it is shown.
    pub fn is(&self, value: &Value) -> bool {
        value.as_f64().is_some_and(|value| self.is_of(value))
    }

    /// In SI.
    pub fn si(&self) -> f64 {
        self.value / self.factor
    }

    /// The number as it is written, in the unit of another.
    pub fn in_unit_of(&self, other: &Self) -> Self {
        Self { factor: other.factor, ..self.clone() }
    }

    /// The number as it is written, whatever its unit.
    pub fn without_unit(&self) -> Self {
        Self { factor: 1.0, ..self.clone() }
    }
}

/// A text with plain blanks and minus signs, one blank between words.
pub fn plain(text: &str) -> String {
    let text = text.replace(['\u{a0}', '\u{2009}', '\u{202f}'], " ").replace('−', "-").replace('\u{ad}', "");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The numbers of a text in their order. One without a unit, as before "to", has that of the next.
pub fn numbers(text: &str) -> Vec<Shown> {
    let text = plain(text);
    let mut shown: Vec<(Shown, Option<f64>)> = Vec::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let sign = if rest[..start].ends_with('-') { -1.0 } else { 1.0 };
        let is_name = rest[..start].ends_with(|c: char| c.is_alphabetic() || c == '_');
        let digits = &rest[start..];
        let end = digits.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(digits.len());
        let number = digits[..end].trim_end_matches('.');
        rest = &digits[number.len()..];
        let Some(value) = number.parse::<f64>().ok().filter(|_| !is_name) else { continue };
        let behind = rest.trim_start();
        let unit = UNITS.iter().find(|(unit, _)| {
            behind.strip_prefix(unit).is_some_and(|more| !more.starts_with(|c: char| c.is_alphanumeric() || c == '/'))
        });
        let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let half = HALF * last_digit(number, decimals);
        shown.push((Shown { value: sign * value, decimals, factor: 1.0, half }, unit.map(|(_, factor)| *factor)));
    }
    let mut factor = 1.0;
    for (number, own) in shown.iter_mut().rev() {
        factor = own.unwrap_or(factor);
        number.factor = factor;
    }
    shown.into_iter().map(|(number, _)| number).collect()
}

/// What the last digit of a number counts. Four significant digits are shown of a large one, so the zeros at the end of
/// one of five and more may be none of them.
fn last_digit(number: &str, decimals: usize) -> f64 {
    let zeros = number.len() - number.trim_end_matches('0').len();
    let not_shown = if decimals == 0 { zeros.min(number.len().saturating_sub(4)) } else { 0 };
    10f64.powf(not_shown as f64 - decimals as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_stand_in_their_sections() {
        let html = "<header>\n<h1>A &amp; B</h1><section class=\"verdict none\"><p>It was <b>so</b>.</p></section>\
                    <section id=\"numbers\"><div class=\"card\" data-key=\"olc\"><dt>OLC</dt><dd>29.3 <small>g\
                    </small></dd></div></section><svg><text>no</text></svg><figure class=\"figure\"><p>below</p>";
        let texts: Vec<(String, String, String)> =
            first_screen(html).into_iter().map(|b| (b.section, b.key, b.text)).collect();
        let expected = [
            ("header", "", "A & B"),
            ("verdict none", "", "It was so."),
            ("numbers", "olc", "OLC"),
            ("numbers", "olc", "29.3 g"),
        ];
        assert_eq!(texts, expected.map(|(a, b, c)| (a.to_owned(), b.to_owned(), c.to_owned())));
    }

    #[test]
    fn numbers_are_read_with_their_units() {
        let read = numbers("739.8 to 759.1\u{a0}mm, CFC60 at −0.5\u{a0}ms, 3 of 4");
        let expected = [(739.8, 1, 1e3), (759.1, 1, 1e3), (-0.5, 1, 1e3), (3.0, 0, 1.0), (4.0, 0, 1.0)];
        let read: Vec<(f64, usize, f64)> =
            read.iter().map(|shown| (shown.value, shown.decimals, shown.factor)).collect();
        assert_eq!(read, expected);
    }

    #[test]
    fn a_number_is_that_of_a_record_to_its_last_digit() {
        let one = |text: &str| numbers(text).remove(0);
        assert!(one("749.9 mm").is_of(0.749_93) && !one("749.9 mm").is_of(0.749_77));
        assert!(one("50 km/h").is_of(50.4 / 3.6) && !one("50 km/h").is_of(50.6 / 3.6));
        assert!(one("21610 kN/m").is_of(21_613e3) && !one("21610 kN/m").is_of(21_616e3));
    }
}
