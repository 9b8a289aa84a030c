//! Reviews as files that machines show: Markdown for a merge request, JUnit for its tests, annotations of GitHub, JSON.

use crumple_diff::Comparison;
use serde_json::{Value, json};

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::markdown;

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

/// The comment for a merge request: first those that differ, each under its name, then the same ones in one line.
/// `again` is the command that makes it, `accept` the one that takes the results.
pub fn to_markdown(reviews: &[&Review], again: &str, accept: &str) -> String {
    let names: Vec<&str> = reviews.iter().map(|review| review.name.as_str()).collect();
    let mut text = format!("<!-- crumple: {} -->\n", comment(&names.join(", ")));
    let mut left = Vec::new();
    let (same, differing): (Vec<&Review>, Vec<&Review>) = reviews.iter().copied().partition(|review| review.is_same());
    for review in differing {
        let section =
            [section(review, true), section(review, false)].into_iter().find(|text| text.len() <= MOST_OF_ONE);
        match section.filter(|section| text.len() + section.len() < MOST) {
            Some(section) => text.push_str(&section),
            None => left.push(review.name.as_str()),
        }
    }
    if !left.is_empty() {
        text.push_str(&format!("Too long for a comment: {}. The report has them.\n\n", markdown(&left.join(", "))));
    }
    if !same.is_empty() {
        let names: Vec<&str> = same.iter().map(|review| review.name.as_str()).take(40).collect();
        let more =
            if same.len() > names.len() { format!(" and {} more", same.len() - names.len()) } else { String::new() };
        text.push_str(&format!("The same within the limits: {}{more}.\n\n", markdown(&names.join(", "))));
    }
    if same.len() < reviews.len() {
        let accept = accept.replace('`', "'");
        text.push_str(&format!("To take the results of all records: `{accept}`, and commit what it writes.\n"));
    }
    text.push_str(&format!("To compare again, after new runs: `{}`.\n", again.replace('`', "'")));
    text
}

/// A text inside of an HTML comment.
fn comment(text: &str) -> String {
    markdown(text).replace("--", "- -")
}

/// What differs in one record; without its details where they are too long.
fn section(review: &Review, with_details: bool) -> String {
    let cause = match review.causes.first() {
        Some(cause) => {
            format!("Cause: `{}` {} → {}", cause.name.replace('`', "'"), markdown(&cause.from), markdown(&cause.to))
        }
        None => "No option, record or program differs".to_owned(),
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
    let counted = review.counted().replacen('b', "B", 1);
    let bold = if before == after { "" } else { "**" };
    let model = arrows(&review.model());
    text.push_str(&format!("\n{}.\n{bold}Recommended model: {model}.{bold}\n\n", markdown(&counted)));
    text.push_str("| | before | after | change | limit | change ÷ limit |\n|---|--:|--:|--:|--:|:--|\n");
    let (shown, rest) = review.rows.split_at(review.rows.len().min(loud.len().clamp(8, 16)));
    shown.iter().for_each(|row| text.push_str(&table_row(row)));
    if with_details && (!rest.is_empty() || review.causes.len() > 1) {
        text.push_str("\n<details><summary>All that differs</summary>\n\n");
        for cause in &review.causes {
            text.push_str(&format!("- {}\n", arrows(&cause.to_string())));
        }
        if !rest.is_empty() {
            text.push_str("\n| | before | after | change | limit | |\n|---|--:|--:|--:|--:|:--|\n");
            rest.iter().for_each(|row| text.push_str(&table_row(row)));
        }
        text.push_str("\n</details>\n");
    }
    text.push('\n');
    text
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
    let (times, mark) = (row.times(1), if row.differs(1) { "**" } else { "" });
    let bar = "█".repeat(times.min(LONGEST_BAR) as usize);
    let times = if times.is_finite() {
        format!("{bar} {times:.1}").trim_start().to_owned()
    } else {
        "on one side only".to_owned()
    };
    let limit = row.limit(1).unwrap_or_else(|| ABSENT.to_owned());
    format!(
        "| {mark}{}{mark} | {} | {mark}{}{mark} | {} | {limit} | {times} |\n",
        name(row),
        markdown(&row.shown(0)),
        markdown(&row.shown(1)),
        change(row)
    )
}

/// Text of XML: escaped, without the characters that XML 1.0 has not.
fn xml(text: &str) -> String {
    html(&text.replace(|c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'), " "))
}

/// JUnit: one suite a comparison, a case a key number, parameter, prediction that differs or is a key number, and file.
pub fn to_junit(compared: &[(Review, Comparison)]) -> String {
    let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"crumple diff\">\n".to_owned();
    for (review, comparison) in compared {
        let cause = xml(&review.cause());
        let mut cases = Vec::new();
        for row in &review.rows {
            let group = match row.group {
                Group::KeyNumber => "key_numbers",
                Group::Parameter => "parameters",
                Group::Prediction => "predictions",
            };
            let limit = row.limit(1).unwrap_or_else(|| ABSENT.to_owned());
            let problem = format!("{} -> {}, {}, limit {limit}", row.shown(0), row.shown(1), change(row));
            cases.push((group, row.key.clone(), row.differs(1).then_some(problem)));
        }
        let [before, after] = &review.models;
        if before != after {
            cases.push(("models", "recommended model".to_owned(), Some(review.model())));
        }
        for file in &comparison.files {
            let apart = file.topics.iter().filter(|topic| !topic.same).count();
            let problem = match file.only_in {
                Some(_) => Some("on one side only".to_owned()),
                None if apart > 0 => Some(format!("{apart} of {} topics differ", file.topics.len())),
                // Its numbers and its model have cases of their own.
                None => None,
            };
            cases.push(("files", format!("all other values of {}", file.name), problem));
        }
        let failures = cases.iter().filter(|(_, _, problem)| problem.is_some()).count();
        let name = xml(&review.name);
        text.push_str(&format!(
            "<testsuite name=\"crumple diff: {name}\" tests=\"{}\" failures=\"{failures}\" errors=\"0\">\n",
            cases.len()
        ));
        for (group, case, problem) in cases {
            let head = format!("<testcase classname=\"{name}.{group}\" name=\"{}\"", xml(&case));
            match problem {
                None => text.push_str(&format!("{head}/>\n")),
                Some(problem) => text.push_str(&format!(
                    "{head}><failure message=\"{}\" type=\"different\">cause: {cause}</failure></testcase>\n",
                    xml(&problem)
                )),
            }
        }
        text.push_str("</testsuite>\n");
    }
    text.push_str("</testsuites>\n");
    text
}

/// Annotations of GitHub: one line a comparison that differs, at the line of its cause where that is known.
pub fn to_github(reviews: &[&Review]) -> String {
    let data = |text: &str| text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A");
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let mut text = String::new();
    for review in reviews.iter().filter(|review| !review.is_same()) {
        let place = review.causes.iter().find_map(|cause| cause.place.as_ref());
        let place = place.map_or_else(String::new, |(file, line)| format!("file={},line={line},", property(file)));
        let said: Vec<String> =
            review.differing().map(|row| format!("{} {} -> {}", row.name, row.shown(0), row.shown(1))).collect();
        let said = if said.is_empty() { review.model() } else { said.join("; ") };
        let title = property(&format!("{}: results changed", review.name));
        text.push_str(&format!("::error {place}title={title}::{}\n", data(&format!("{}. {said}", review.cause()))));
    }
    text
}

/// The comparison as JSON: the summary first, then the files, each topic by its largest difference; with `all` every
/// difference.
pub fn to_json(compared: &[(Review, Comparison)], all: bool) -> Value {
    let row = |row: &Quantity| {
        let side = |k: usize| row.values[k].as_ref().map(|own| own.value);
        let beyond = Some(row.beyond(1)).filter(|x| x.is_finite());
        json!({"group": row.group, "name": row.key, "from": side(0), "to": side(1), "beyond": beyond,
            "differs": row.differs(1), "within_interval": row.is_within_interval(1)})
    };
    let summary = |(review, comparison): &(Review, Comparison)| {
        json!({"name": review.name, "a": comparison.a, "b": comparison.b, "same": comparison.same,
            "causes": review.causes, "unexplained": review.unexplained, "recommended": review.models,
            "numbers": review.rows.iter().map(row).collect::<Vec<_>>(), "not_compared": comparison.not_compared()})
    };
    let mut value = json!({
        "schema": "crumple.diff.v1",
        "same": compared.iter().all(|(_, comparison)| comparison.same),
        "summary": compared.iter().map(summary).collect::<Vec<_>>(),
        "files": [],
        "left_out": 0,
    });
    let mut files: Vec<Value> = Vec::new();
    let mut left_out = 0;
    let mut size = value.to_string().len();
    for (review, comparison) in compared {
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

    use super::super::review::tests::{made, review};
    use super::*;

    fn peak(cfc: u16, value: f64, stiffness: &[f64]) -> super::super::review::Expected {
        made(cfc, &[("peak_acceleration", value, "m/s^2"), ("dynamic_crush", 0.45, "m")], stiffness)
    }

    #[test]
    fn the_comment_names_the_cause_and_what_changed_and_says_how_to_take_it() {
        let (a, b) = (peak(60, 175.0, &[1e5]), peak(180, 180.0, &[1e5]));
        let (changed, mut same) = (review(&a, &b), review(&a, &a));
        same.name = "kelvin".into();
        let text =
            to_markdown(&[&changed, &same], "crumple diff expected runs", "crumple accept runs").replace('\u{a0}', " ");
        insta::assert_snapshot!(text, @"
        <!-- crumple: rigid, kelvin -->
        ### Record rigid: results changed

        Cause: `filter.cfc` 60 → 180; no other option, record or program differs.

        **Peak** +2.9 %. Within the limits: Dynamic crush C.
        Beyond the limit: 1 of 2 key numbers, 0 of 1 parameter.
        Recommended model: the same, Kelvin, direct fit 1.

        | | before | after | change | limit | change ÷ limit |
        |---|--:|--:|--:|--:|:--|
        | **Peak** | 17.8 g | **18.4 g** | +2.9 % | 0.5 % | █████ 5.7 |
        | Dynamic crush C | 450 mm | 450 mm | 0.0 mm | 1 mm | 0.0 |

        The same within the limits: kelvin.

        To take the results of all records: `crumple accept runs`, and commit what it writes.
        To compare again, after new runs: `crumple diff expected runs`.
        ");
    }

    #[test]
    fn a_comment_stays_below_its_size_and_no_text_of_a_record_is_markdown() {
        let many = |x: f64| (0..300).map(|k| x * f64::from(k + 1)).collect::<Vec<f64>>();
        let (a, mut b) = (peak(60, 175.0, &many(1e5)), peak(180, 180.0, &many(2e5)));
        b.record = ["@team <b>|\n`x`-->.csv".into(), "blake3:other".into()];
        let mut found = review(&a, &b);
        found.name = "a|b <!-- @x".into();
        let text = to_markdown(&[&found], "crumple diff a b", "crumple accept runs");
        assert!(text.len() < MOST_OF_ONE, "{} characters", text.len());
        assert_eq!(text.matches("-->").count(), 1, "{text}");
        assert!(!text.contains("<b>"), "{text}");
        let reviews: Vec<&Review> = (0..30).map(|_| &found).collect();
        let all = to_markdown(&reviews, "crumple diff a b", "crumple accept runs");
        assert!(all.len() < MOST && all.contains("Too long for a comment"), "{}", all.len());
    }

    #[test]
    fn tests_are_counted_and_annotations_stand_in_one_line() {
        let found = review(&peak(60, 175.0, &[1e5]), &peak(180, 180.0, &[1e5]));
        let file = FileReport { name: "3-integrate.mcap".into(), ..FileReport::default() };
        let comparison = Comparison::new("a".into(), "b".into(), false, vec![file]);
        let compared = [(found, comparison)];
        let text = to_junit(&compared);
        assert!(text.contains("tests=\"3\" failures=\"1\" errors=\"0\""), "{text}");
        assert_eq!((text.matches("<testcase").count(), text.matches("<failure").count()), (3, 1));
        let mut noted = review(&peak(60, 175.0, &[1e5]), &peak(180, 180.0, &[1e5]));
        noted.causes[0].place = Some(("pipelines/default.toml".into(), 12));
        noted.name = "a,b:c\nd".into();
        let line = to_github(&[&noted]);
        assert_eq!(line.lines().count(), 1, "{line}");
        assert!(
            line.starts_with("::error file=pipelines/default.toml,line=12,title=a%2Cb%3Ac%0Ad%3A results changed::")
        );
        let json = to_json(&compared, false);
        assert_eq!((&json["same"], &json["summary"][0]["causes"][0]["name"]), (&false.into(), &"filter.cfc".into()));
    }
}
