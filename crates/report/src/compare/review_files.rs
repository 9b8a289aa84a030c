//! Reviews as files that machines show: Markdown for a merge request, JUnit for its tests, annotations of GitHub, JSON.

use crumple_diff::{Comparison, conclusion};
use serde_json::{Value, json};

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::markdown;

use super::compared::Compared;
use super::facts::Fact;
use super::quantities::{Group, Quantity};
use super::review::Review;
use super::table::plain;

/// Most characters of Markdown of one record.
const MOST_OF_ONE: usize = 8_000;
/// Most of all records: GitHub refuses a comment of more than 65,536.
const MOST: usize = 60_000;
/// Blocks of the longest bar, each a limit.
const LONGEST_BAR: f64 = 12.0;
/// Most bytes of the JSON, but for `--all`.
const MOST_OF_JSON: usize = 100_000;

/// The comment for a merge request: first those that could not be compared, in a line each, then those that differ,
/// each under its name, then the same ones in one line.
pub fn to_markdown(compared: &[Compared], commands: &Commands) -> String {
    let names: Vec<&str> = compared.iter().map(|one| one.name.as_str()).collect();
    let mut text = format!("<!-- crumple: {} -->\n", comment(&names.join(", ")));
    text.push_str(&without_review(compared));
    let mut left = Vec::new();
    let (same, others): (Vec<&Compared>, Vec<&Compared>) = compared.iter().partition(|one| one.is_same());
    for one in others {
        let Some((review, comparison)) = one.review() else { continue };
        let sections = [true, false].map(|with_details| section(review, comparison, with_details, commands));
        let section = sections.into_iter().find(|text| text.len() <= MOST_OF_ONE);
        // What comes behind is no longer than one section.
        match section.filter(|section| text.len() + section.len() < MOST - MOST_OF_ONE) {
            Some(section) => text.push_str(&section),
            None => left.push(one),
        }
    }
    if !left.is_empty() {
        text.push_str(&format!("Too long for a comment: {}. The report has them.\n\n", listed(&left)));
    }
    if !same.is_empty() {
        text.push_str(&format!("The same within the limits: {}.\n\n", listed(&same)));
        let notes = same.iter().filter_map(|one| one.review()).filter_map(|(review, _)| aside(review));
        notes.take(NAMED).for_each(|note| text.push_str(&note));
    }
    if same.len() < compared.len() {
        let accept = quoted(&commands.accept);
        text.push_str(&format!("To take the results of all records: {accept}, and commit what it writes.\n"));
    }
    text.push_str(&format!("To compare again, after new runs: {}.\n", quoted(&commands.again)));
    text
}

/// What can be typed, as the comment names it.
#[derive(Debug, Clone)]
pub struct Commands {
    /// Makes the comment again.
    pub again: String,
    /// Shows every difference.
    pub all: String,
    /// Takes the results.
    pub accept: String,
}

/// A command in Markdown.
fn quoted(command: &str) -> String {
    format!("`{}`", command.replace('`', "'"))
}

/// Most records that are named in a line.
const NAMED: usize = 40;

fn listed(records: &[&Compared]) -> String {
    let names: Vec<&str> = records.iter().map(|one| one.name.as_str()).take(NAMED).collect();
    let more = if records.len() > NAMED { format!(" and {} more", records.len() - NAMED) } else { String::new() };
    format!("{}{more}", markdown(&names.join(", ")))
}

/// The records that could not be compared, and those that nobody has accepted.
fn without_review(compared: &[Compared]) -> String {
    let problems: Vec<(&Compared, &str)> = compared.iter().filter_map(|one| Some((one, one.problem()?))).collect();
    if problems.is_empty() {
        return String::new();
    }
    let mut text = format!("### {} of {} records not compared\n\n", problems.len(), compared.len());
    for (one, problem) in problems.iter().take(NAMED) {
        let name = markdown(&one.name);
        text.push_str(&format!("- **{name}**: {}: {}\n", markdown(one.said_word()), markdown(problem)));
    }
    if problems.len() > NAMED {
        text.push_str(&format!("- and {} more\n", problems.len() - NAMED));
    }
    text.push('\n');
    text
}

/// What is to be known of a record that is the same.
fn aside(review: &Review) -> Option<String> {
    let not_compared = review.not_compared().map(|note| format!("{}: {note}", review.name));
    let notes = [review.changed_within(), review.artifacts_line(), not_compared];
    let notes: Vec<String> = notes.into_iter().flatten().map(|note| arrows(&note)).collect();
    (!notes.is_empty()).then(|| format!("{}.\n\n", capital(&notes.join("; "))))
}

/// A text inside of an HTML comment.
fn comment(text: &str) -> String {
    markdown(text).replace("--", "- -")
}

/// What differs in one record; without its details where they are too long.
fn section(review: &Review, comparison: &Comparison, with_details: bool, commands: &Commands) -> String {
    let cause = match review.causes.first() {
        Some(cause) => {
            let place = cause.place.as_ref().map(|(file, line)| format!(" ({}:{line})", markdown(file)));
            let [from, to] = [&cause.from, &cause.to].map(|value| markdown(value));
            format!("Cause: `{}` {from} → {to}{}", cause.name.replace('`', "'"), place.unwrap_or_default())
        }
        None => sentence(&review.cause()),
    };
    let more = match (review.causes.len(), review.unexplained.is_empty()) {
        (0, _) => "",
        (1, true) => "; no other option, record or program differs",
        (1, false) => "; it does not explain all that differs",
        _ => " and more, listed below",
    };
    let [before, after] = &review.models;
    let verdict = if before == after { "results changed" } else { "results and recommended model changed" };
    let mut text = format!("### Record {}: {verdict}\n\n{cause}{more}.\n\n", markdown(&review.name));
    let (loud, quiet): (Vec<&Quantity>, Vec<&Quantity>) = review.rows.iter().partition(|row| row.differs(1));
    let said: Vec<String> = loud.iter().take(6).map(|row| format!("**{}** {}", name(row), change(row))).collect();
    let others: Vec<String> = quiet.iter().map(|row| name(row)).collect();
    if !said.is_empty() {
        text.push_str(&format!("{}.", said.join(", ")));
    }
    if !others.is_empty() {
        text.push_str(&format!(" Within the limits: {}.", others.join(", ")));
    }
    let counted = sentence(&review.counted());
    let notes = [in_files(review, comparison), review.artifacts_line(), review.not_compared().map(str::to_owned)];
    let notes = notes.into_iter().flatten().map(|note| format!("{}.\n", sentence(&note)));
    let bold = if before == after { "" } else { "**" };
    let model = arrows(&review.model());
    text.push_str(&format!("\n{}.\n{}{bold}Recommended model: {model}.{bold}\n\n", counted, notes.collect::<String>()));
    let rows: Vec<String> = loud.iter().map(|row| table_row(row)).collect();
    let (grave, facts): (Vec<&Fact>, Vec<&Fact>) = review.facts.iter().partition(|fact| fact.is_grave());
    let [grave, facts] = [grave, facts].map(|facts| facts.into_iter().map(fact_row).collect::<Vec<String>>());
    let quiet: Vec<String> = quiet.iter().map(|row| table_row(row)).collect();
    // Some of both kinds, whichever there are more of.
    let (of_rows, of_facts) = (rows.len().min(16), facts.len().min(8));
    let of_quiet = quiet.len().min(8_usize.saturating_sub(of_rows + of_facts));
    let shown = [&grave[..], &rows[..of_rows], &facts[..of_facts], &quiet[..of_quiet]].concat();
    let rest = [&rows[of_rows..], &facts[of_facts..], &quiet[of_quiet..]].concat();
    if !shown.is_empty() {
        text.push_str("| | before | after | change | limit | change ÷ limit |\n|---|--:|--:|--:|--:|:--|\n");
        text.push_str(&shown.concat());
    }
    if with_details && (!rest.is_empty() || review.causes.len() > 1) {
        text.push_str("\n<details><summary>All that differs</summary>\n\n");
        for cause in &review.causes {
            text.push_str(&format!("- {}\n", arrows(&cause.to_string())));
        }
        if !rest.is_empty() {
            text.push_str("\n| | before | after | change | limit | |\n|---|--:|--:|--:|--:|:--|\n");
            text.push_str(&rest.concat());
        }
        text.push_str("\n</details>\n");
    }
    if !with_details && !rest.is_empty() {
        text.push_str(&format!("\nAnd {} more: {}.\n", rest.len(), quoted(&commands.all)));
    }
    text.push('\n');
    text
}

/// What differs in files beside the numbers of the table; of what was accepted there are no files.
fn in_files(review: &Review, comparison: &Comparison) -> Option<String> {
    let is_listed = review.differing().next().is_some() || !review.facts.is_empty();
    (!comparison.same
        && !is_listed
        && comparison.files.iter().any(|file| !file.topics.is_empty() || file.only_in.is_some()))
    .then(|| conclusion(comparison))
}

fn sentence(text: &str) -> String {
    capital(&markdown(text))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}", letters.as_str())
}

/// A text with before and after, for Markdown.
fn arrows(text: &str) -> String {
    markdown(&text.replace(" -> ", " → "))
}

fn name(row: &Quantity) -> String {
    markdown(&plain(&row.name))
}

fn change(row: &Quantity) -> String {
    row.change(1).unwrap_or_else(|| ABSENT.to_owned())
}

/// A row of the table; a block of the bar is a limit.
fn table_row(row: &Quantity) -> String {
    let (times, mark) = (row.beyond(1), if row.differs(1) { "**" } else { "" });
    let bar = "█".repeat(times.min(LONGEST_BAR) as usize);
    let times = match times {
        times if times.is_finite() => format!("{bar} {times:.1}").trim_start().to_owned(),
        _ if [0, 1].iter().any(|side| row.is_undetermined(*side)) => "determined on one side only".to_owned(),
        _ if row.values.iter().all(Option::is_some) => "beyond a limit of 0".to_owned(),
        _ => "on one side only".to_owned(),
    };
    let limit = row.limit(1).unwrap_or_else(|| ABSENT.to_owned());
    format!(
        "| {mark}{}{mark} | {} | {mark}{}{mark} | {} | {limit} | {times} |\n",
        name(row),
        markdown(&row.known(0)),
        markdown(&row.known(1)),
        change(row)
    )
}

/// The row of something that is no number: it differs, and has no limit.
fn fact_row(fact: &Fact) -> String {
    let [before, after] =
        fact.values.each_ref().map(|value| markdown(&value.chars().take(OF_VALUE).collect::<String>()));
    format!("| **{}** | {before} | **{after}** | {ABSENT} | {ABSENT} | |\n", markdown(&fact.key))
}

/// Most characters of a value that is a text.
const OF_VALUE: usize = 200;

/// Text of XML: escaped, without the characters that XML 1.0 has not.
fn xml(text: &str) -> String {
    html(&text.replace(|c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'), " "))
}

/// What became of a case: `None` passed, else whether it is an error and what was found.
pub type Case = (&'static str, String, Option<(bool, String)>);

/// Cases of one record or simulation.
#[derive(Debug)]
pub struct Suite {
    /// Its name.
    pub name: String,
    /// What stands behind a case that failed.
    pub cause: String,
    /// What an error is called.
    pub error: &'static str,
    /// The cases.
    pub cases: Vec<Case>,
}

/// JUnit: one suite a record, a case a key number, prediction, the recommended model, its parameters, what else people
/// decide by, and all other values; a record that cannot be compared is an error.
pub fn to_junit(compared: &[Compared]) -> String {
    let suite = |one: &Compared| {
        let (cause, cases) = match one.review() {
            Some((review, comparison)) => (format!("cause: {}", review.cause()), cases_of(review, comparison)),
            None => {
                let problem = Some((one.trouble().is_some(), one.problem().unwrap_or_default().to_owned()));
                (one.said_word().to_owned(), vec![("records", "results of the record".to_owned(), problem)])
            }
        };
        Suite { name: one.name.clone(), cause, error: one.word(), cases }
    };
    junit("crumple diff", "different", &compared.iter().map(suite).collect::<Vec<_>>())
}

/// JUnit of the suites of a program; `failure` is what a failed case is called.
pub fn junit(program: &str, failure: &str, suites: &[Suite]) -> String {
    let mut text = format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"{program}\">\n");
    for Suite { name, cause, error, cases } in suites {
        let count = |is_error: bool| {
            cases.iter().filter(|(_, _, problem)| problem.as_ref().is_some_and(|(error, _)| *error == is_error)).count()
        };
        let name = xml(name);
        text.push_str(&format!(
            "<testsuite name=\"{program}: {name}\" tests=\"{}\" failures=\"{}\" errors=\"{}\">\n",
            cases.len(),
            count(false),
            count(true)
        ));
        for (group, case, problem) in cases {
            let head = format!("<testcase classname=\"{name}.{group}\" name=\"{}\"", xml(case));
            let Some((is_error, problem)) = problem else {
                text.push_str(&format!("{head}/>\n"));
                continue;
            };
            let (tag, kind) = if *is_error { ("error", *error) } else { ("failure", failure) };
            let (problem, cause) = (xml(problem), xml(cause));
            text.push_str(&format!("{head}><{tag} message=\"{problem}\" type=\"{kind}\">{cause}</{tag}></testcase>\n"));
        }
        text.push_str("</testsuite>\n");
    }
    text.push_str("</testsuites>\n");
    text
}

fn cases_of(review: &Review, comparison: &Comparison) -> Vec<Case> {
    let differs = |problem: Option<String>| problem.map(|problem| (false, problem));
    let mut cases: Vec<Case> = Vec::new();
    let in_words = |row: &Quantity| {
        let limit = row.limit(1).unwrap_or_else(|| ABSENT.to_owned());
        format!("{} -> {}, {}, limit {limit}", row.known(0), row.known(1), change(row))
    };
    for row in &review.rows {
        let group = match row.group {
            Group::KeyNumber => "key_numbers",
            Group::Prediction => "predictions",
            Group::Parameter | Group::PredictedDetail => continue,
        };
        cases.push((group, plain(&row.name), differs(row.differs(1).then(|| in_words(row)))));
    }
    // What follows from these, and what only a program reads, is one case each: one cause is no hundred failures.
    let of_group = |wanted: Group| review.rows.iter().filter(move |row| row.group == wanted);
    for (group, name, wanted) in [
        ("models", "parameters of the recommended model", Group::Parameter),
        ("predictions", "intervals and details of the predictions", Group::PredictedDetail),
    ] {
        let list: Vec<String> = of_group(wanted)
            .filter(|row| row.differs(1))
            .map(|row| format!("{}: {}", plain(&row.name), in_words(row)))
            .collect();
        if of_group(wanted).next().is_some() {
            cases.push((group, name.to_owned(), differs(first_of(&list))));
        }
    }
    let facts: Vec<String> =
        review.facts.iter().map(|fact| format!("{} {}", fact.key, fact.values.join(" -> "))).collect();
    cases.push(("other", "status, warnings and all else that people decide by".to_owned(), differs(first_of(&facts))));
    let [before, after] = &review.models;
    if before != after {
        cases.push(("models", "recommended model".to_owned(), differs(Some(review.model()))));
    }
    if let Some(problem) = review.artifacts_line().filter(|_| review.artifacts_count()) {
        cases.push(("artifacts", "artifacts".to_owned(), differs(Some(problem))));
    }
    // The numbers and the model of a file have cases of their own.
    let of_file = |file: &crumple_diff::FileReport| {
        let apart = file.topics.iter().filter(|topic| !topic.same).count();
        match file.only_in {
            Some(_) => Some(format!("{} on one side only", file.name)),
            None => (apart > 0).then(|| format!("{apart} of {} topics of {} differ", file.topics.len(), file.name)),
        }
    };
    let files: Vec<String> = comparison.files.iter().filter_map(of_file).collect();
    if !comparison.files.is_empty() {
        cases.push(("files", "all other values".to_owned(), differs(first_of(&files))));
    }
    cases
}

/// The first of a list, and how many more there are; `None` of an empty one.
fn first_of(list: &[String]) -> Option<String> {
    let shown = list[..list.len().min(OF_ANNOTATION)].join("; ");
    let more = list.len().saturating_sub(OF_ANNOTATION);
    (!list.is_empty()).then(|| if more > 0 { format!("{shown}; and {more} more") } else { shown })
}

/// Most changes that an annotation or a failed case names: what is read beside a line.
const OF_ANNOTATION: usize = 3;

/// Annotations of GitHub: one line a comparison that differs, at the line of its cause where that is known.
pub fn to_github(compared: &[Compared]) -> String {
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let mut text = String::new();
    for one in compared.iter().filter(|one| !one.is_same()) {
        let Some((review, _)) = one.review() else {
            let title = property(&format!("{}: {}", one.name, one.said_word()));
            text.push_str(&format!("::error title={title}::{}\n", data(one.problem().unwrap_or_default())));
            continue;
        };
        let place = review.causes.iter().find_map(|cause| cause.place.as_ref());
        let place = place.map_or_else(String::new, |(file, line)| format!("file={},line={line},", property(file)));
        let of_rows = review.differing().map(|row| format!("{} {} -> {}", row.name, row.known(0), row.known(1)));
        let of_facts = review.facts.iter().map(|fact| format!("{} {}", fact.key, fact.values.join(" -> ")));
        let said: Vec<String> = of_rows.chain(of_facts).collect();
        let said = first_of(&said).unwrap_or_else(|| review.model());
        let title = property(&format!("{}: results changed", review.name));
        text.push_str(&format!("::error {place}title={title}::{}\n", data(&format!("{}. {said}", review.cause()))));
    }
    text
}

/// The comparison as JSON: the summary first, then the files, each topic by its largest difference; with `all` every
/// difference.
pub fn to_json(compared: &[Compared], all: bool) -> Value {
    let row = |row: &Quantity| {
        let side = |k: usize| row.values[k].as_ref().map(|own| own.value);
        let beyond = Some(row.beyond(1)).filter(|x| x.is_finite());
        let determined = [0, 1].map(|side| !row.is_undetermined(side));
        json!({"group": row.group, "name": row.key, "from": side(0), "to": side(1), "beyond": beyond,
            "determined": determined, "differs": row.differs(1), "within_interval": row.is_within_interval(1)})
    };
    let fact = |fact: &Fact| json!({"name": fact.key, "from": fact.values[0], "to": fact.values[1]});
    let summary = |one: &Compared| match one.review() {
        Some((review, comparison)) => {
            json!({"name": review.name, "a": comparison.a, "b": comparison.b, "same": comparison.same,
                "status": one.word(), "causes": review.causes, "unexplained": review.unexplained,
                "artifacts": review.artifacts, "not_kept": review.not_compared(), "recommended": review.models,
                "numbers": review.rows.iter().map(row).collect::<Vec<_>>(),
                "facts": review.facts.iter().map(fact).collect::<Vec<_>>(), "not_compared": comparison.not_compared()})
        }
        None => json!({"name": one.name, "same": false, "status": one.word(), "problem": one.problem(), "causes": []}),
    };
    let mut value = json!({
        "schema": "crumple.diff.v1",
        "same": compared.iter().all(Compared::is_same),
        "summary": compared.iter().map(summary).collect::<Vec<_>>(),
        "files": [],
        "left_out": 0,
    });
    let mut files: Vec<Value> = Vec::new();
    let mut left_out = 0;
    let mut size = value.to_string().len();
    for (review, comparison) in compared.iter().filter_map(Compared::review) {
        for file in &comparison.files {
            let mut shown = file.clone();
            if !all {
                shown.topics.retain(|topic| !topic.same);
                for topic in &mut shown.topics {
                    let largest = |d: &crumple_diff::Difference| d.rel.unwrap_or(f64::INFINITY);
                    topic.differences.sort_by(|x, y| largest(y).total_cmp(&largest(x)));
                    left_out += topic.differences.len().saturating_sub(1);
                    topic.differences.truncate(1);
                }
            }
            let shown = json!({"of": review.name, "file": shown});
            size += shown.to_string().len();
            if all || size < MOST_OF_JSON { files.push(shown) } else { left_out += 1 }
        }
    }
    value["files"] = files.into();
    value["left_out"] = left_out.into();
    value
}

#[cfg(test)]
mod tests {
    use crumple_diff::FileReport;

    use super::super::compared::{Outcome, Trouble, TroubleKind};
    use super::super::expected::Expected;
    use super::super::review::tests::{made, review};
    use super::*;

    /// The record of a review; of what was accepted there is no file.
    fn reviewed(name: &str, mut review: Review, file: &str) -> Compared {
        let file = FileReport { name: file.into(), same: review.is_same(), ..FileReport::default() };
        let comparison = Comparison::new("a".into(), "b".into(), false, vec![file]);
        review.name = name.to_owned();
        Compared { name: name.to_owned(), outcome: Outcome::Reviewed(review, comparison) }
    }

    fn commands() -> Commands {
        let again = "crumple diff expected runs".to_owned();
        Commands { all: format!("{again} --all"), again, accept: "crumple accept runs".to_owned() }
    }

    fn peak(cfc: u16, value: f64, stiffness: &[f64]) -> Expected {
        made(cfc, &[("peak_acceleration", value, "m/s^2"), ("dynamic_crush", 0.45, "m")], stiffness)
    }

    #[test]
    fn the_comment_names_the_cause_and_what_changed_and_says_how_to_take_it() {
        let (a, b) = (peak(60, 175.0, &[1e5]), peak(180, 180.0, &[1e5]));
        let compared = [reviewed("rigid", review(&a, &b), ""), reviewed("kelvin", review(&a, &a), "")];
        let text = to_markdown(&compared, &commands()).replace('\u{a0}', " ");
        insta::assert_snapshot!(text, @"
        <!-- crumple: rigid, kelvin -->
        ### Record rigid: results changed

        Cause: `filter.cfc` 60 → 180; no other option, record or program differs.

        **Peak** +2.9 %. Within the limits: Dynamic crush C.
        Beyond the limit: 1 of 2 key numbers, 0 of 1 parameter.
        Recommended model: the same, Kelvin model (fitted).

        | | before | after | change | limit | change ÷ limit |
        |---|--:|--:|--:|--:|:--|
        | **Peak** | 17.8 g | **18.4 g** | +2.9 % | 0.5 % | █████ 5.6 |
        | Dynamic crush C | 450 mm | 450 mm | 0.0 mm | 1 mm | 0.0 |

        The same within the limits: kelvin.

        To take the results of all records: `crumple accept runs`, and commit what it writes.
        To compare again, after new runs: `crumple diff expected runs`.
        ");
    }

    #[test]
    fn a_comment_says_what_decides_the_farthest_first_and_what_a_record_does_not_determine() {
        let numbers = |peak, crush| [("peak_acceleration", peak, "m/s^2"), ("dynamic_crush", crush, "m")];
        let (a, mut b) = (made(60, &numbers(100.0, 0.45), &[1e5]), made(60, &numbers(200.0, 0.46), &[3e5]));
        let loose = json!({"method": "linearised", "standard_deviation": {"k1_n_per_m": 1e6},
            "interval_low": {"k1_n_per_m": null}, "interval_high": {"k1_n_per_m": null}});
        b.summary.candidates[0].uncertainty = serde_json::from_value(loose).unwrap();
        let text = to_markdown(&[reviewed("rigid", review(&a, &b), "")], &commands()).replace('\u{a0}', " ");
        let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| **")).collect();
        assert!(rows[0].contains("| **not determined** | – |") && rows[0].contains("on one side only"), "{text}");
        // Half of the larger value over 0.5 % of it; 10 mm over 1 mm.
        assert!(rows[1].contains("Peak") && rows[1].ends_with("| ████████████ 100.0 |"), "{text}");
        assert!(rows[2].contains("Dynamic crush") && rows[2].ends_with("| ██████████ 10.0 |"), "{text}");
        // A record that changed within the limits is named.
        let near = made(60, &numbers(100.1, 0.45), &[1e5]);
        let mut near = Expected { record: ["crash.csv".into(), "blake3:ffffffffff".into()], ..near };
        near.stages[1].digest = "other".into();
        let text = to_markdown(&[reviewed("rigid", review(&a, &near), "")], &commands());
        let named =
            "Record rigid changed (record crash.csv (0123456789) → crash.csv (ffffffffff)); every number is within";
        assert!(text.contains(named), "{text}");
    }

    #[test]
    fn a_comment_stays_below_its_size_and_no_text_of_a_record_is_markdown() {
        let many = |x: f64| (0..300).map(|k| x * f64::from(k + 1)).collect::<Vec<f64>>();
        let (a, mut b) = (peak(60, 175.0, &many(1e5)), peak(180, 180.0, &many(2e5)));
        b.record = ["@team <b>|\n`x`-->.csv".into(), "blake3:other".into()];
        let one = || reviewed("a|b <!-- @x", review(&a, &b), "");
        let text = to_markdown(&[one()], &commands());
        assert!(text.len() < MOST_OF_ONE, "{} characters", text.len());
        assert_eq!(text.matches("-->").count(), 1, "{text}");
        assert!(!text.contains("<b>") && !text.contains("@x") && !text.contains("@team"), "{text}");
        let all: Vec<Compared> = (0..30).map(|_| one()).collect();
        let all = to_markdown(&all, &commands());
        assert!(all.len() < MOST && all.contains("Too long for a comment"), "{}", all.len());
    }

    #[test]
    fn tests_are_counted_and_annotations_stand_in_one_line() {
        let found = || review(&peak(60, 175.0, &[1e5]), &peak(180, 180.0, &[1e5]));
        let compared = [reviewed("rigid", found(), "3-integrate.mcap")];
        let text = to_junit(&compared);
        assert!(text.contains("tests=\"4\" failures=\"1\" errors=\"0\""), "{text}");
        assert_eq!((text.matches("<testcase").count(), text.matches("<failure").count()), (4, 1));
        let mut noted = found();
        noted.causes[0].place = Some(("pipelines/default.toml".into(), 12));
        let line = to_github(&[reviewed("a,b:c\nd", noted, "")]);
        assert_eq!(line.lines().count(), 1, "{line}");
        assert!(
            line.starts_with("::error file=pipelines/default.toml,line=12,title=a%2Cb%3Ac%0Ad%3A results changed::")
        );
        let json = to_json(&compared, false);
        assert_eq!((&json["same"], &json["summary"][0]["causes"][0]["name"]), (&false.into(), &"filter.cfc".into()));
    }

    #[test]
    fn a_record_without_results_is_an_error_and_one_that_is_not_accepted_a_failure() {
        let trouble = |kind| Outcome::Trouble(Trouble { kind, problem: "why @here".into(), hint: "do".into() });
        let one = |name: &str, outcome| Compared { name: name.to_owned(), outcome };
        let same = peak(60, 175.0, &[1e5]);
        let compared = [
            reviewed("a", review(&same, &same), ""),
            one("b", trouble(TroubleKind::Refused)),
            one("c", trouble(TroubleKind::Missing)),
            one("d", Outcome::New { problem: "runs/d/default is not in expected".into() }),
        ];
        let junit = to_junit(&compared);
        assert_eq!((junit.matches("<error ").count(), junit.matches("<failure ").count()), (2, 1), "{junit}");
        assert!(junit.contains("type=\"refused\"") && junit.contains("tests=\"1\" failures=\"0\" errors=\"1\""));
        let text = to_markdown(&compared, &commands());
        insta::assert_snapshot!(text.replace('\u{200b}', ""), @r"
        <!-- crumple: a, b, c, d -->
        ### 3 of 4 records not compared

        - **b**: refused: why \@here
        - **c**: missing: why \@here
        - **d**: never accepted: runs/d/default is not in expected

        The same within the limits: a.

        To take the results of all records: `crumple accept runs`, and commit what it writes.
        To compare again, after new runs: `crumple diff expected runs`.
        ");
        assert_eq!(to_github(&compared).lines().count(), 3);
        let json = to_json(&compared, false);
        let words: Vec<&str> = (0..4).map(|k| json["summary"][k]["status"].as_str().unwrap()).collect();
        assert_eq!((words, &json["same"]), (vec!["same", "refused", "missing", "not-accepted"], &false.into()));
    }
}
