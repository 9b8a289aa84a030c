//! Texts of loggers that hold a table in another form, written as one: the clock of a serial monitor in front of each
//! row, a label before every number, the annotated CSV of InfluxDB, a log with lines of keywords, one with scales.
//!
//! A row stays in its line where that can be, so that messages name lines of the file.

use std::collections::{BTreeMap, BTreeSet};

use crumple_signal::Note;

use crate::formats::table::layout::Delimiter;
use crate::formats::table::remarks::{LinesOfNoRow, TextOfLogger};
use crate::formats::text::lines::{NumberStyle, decode, unquoted};
use crate::recording::content::list;
use crate::time::stamp;
use crate::{Result, refuse_channel};

/// A text as a table, and what is said about that.
pub struct AsTable {
    pub text: Vec<u8>,
    pub note: Note,
}

/// Lines looked at, blank ones aside, and the share of them that must have a form, of ten.
const LOOKED_AT: usize = 60;
const OF_TEN: usize = 8;

/// The text as a table where it has one of these forms; `None` for any other. `wanted`: the channel asked for.
pub fn as_table(file: &str, text: &[u8], wanted: Option<&str>) -> Result<Option<AsTable>> {
    let decoded = |line: &[u8]| decode(line.trim_ascii_end());
    let lines = || text.split(|b| *b == b'\n').map(decoded);
    let head: Vec<String> = lines().filter(|line| !line.is_empty()).take(LOOKED_AT).collect();
    let all = || lines().collect::<Vec<String>>();
    let first = head.first().map_or("", |line| line.trim());
    let is_of_influx = ["#datatype", "#group", "#default"].iter().any(|word| first.starts_with(word));
    Ok(match first {
        _ if is_of_influx => return series(file, &all(), wanted),
        "channel names:" => with_interval(file, &all())?,
        "GYROFLOW IMU LOG" => scaled(&all()),
        _ if have(&head, |line| labels_and_numbers(line).is_some()) => labelled(&all()),
        _ if have(&head, |line| clock_and_row(line).is_some()) => Some(behind_a_clock(&all())),
        _ => None,
    })
}

/// Whether enough of the first lines have a form.
fn have(head: &[String], form: impl Fn(&str) -> bool) -> bool {
    head.len() > 2 && head.iter().filter(|line| form(line)).count() * 10 >= OF_TEN * head.len()
}

/// `10:02:03.001 -> -0.12,0.01`: clock and row.
fn clock_and_row(line: &str) -> Option<(&str, &str)> {
    let (clock, row) = line.split_once("->")?;
    stamp(clock.trim()).map(|_| (clock.trim(), row.trim()))
}

/// That a text has a form that needs no further words.
fn read_as(form: &'static str) -> Note {
    TextOfLogger { form, interval_s: None, series: None, names: None }.into()
}

fn behind_a_clock(lines: &[String]) -> AsTable {
    let delimiter_of = |row: &str| [';', '\t', ','].into_iter().find(|c| row.contains(*c)).unwrap_or(' ');
    let row = |line: &String| {
        let Some((clock, row)) = clock_and_row(line) else { return line.clone() };
        format!("{clock}{}{row}", delimiter_of(row))
    };
    let mut rows: Vec<String> = lines.iter().map(row).collect();
    // Without names the numbers are called by their places behind the clock, as people count them.
    if let Some((_, first)) = lines.first().and_then(|line| clock_and_row(line)) {
        let delimiter = delimiter_of(first);
        let fields: Vec<&str> = first.split(delimiter).filter(|field| !field.is_empty()).collect();
        if fields.iter().all(|field| NumberStyle::POINT.field(field.trim().as_bytes()).is_some()) {
            let names = (1..=fields.len()).map(|place| format!("{delimiter}{place}"));
            rows.insert(0, format!("time{}", names.collect::<String>()));
        }
    }
    let text = rows.join("\n").into_bytes();
    AsTable { text, note: read_as("serial monitor") }
}

/// The labels and numbers of `t:0 X: 0.00, Y= 0.01`, behind a clock or not; `None` where anything else stands there.
fn labels_and_numbers(line: &str) -> Option<Vec<(String, String)>> {
    let (clock, rest) = clock_and_row(line).unwrap_or(("", line));
    let mut found = Vec::new();
    if !clock.is_empty() {
        found.push(("time".to_owned(), clock.to_owned()));
    }
    let apart = rest.replace([':', '='], ": ");
    let words =
        apart.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '|')).filter(|word| !word.is_empty());
    let mut label: Vec<&str> = Vec::new();
    for word in words {
        match word.strip_suffix(':') {
            Some(last) => {
                label.push(last);
                // Two labels in a row are none.
                if found.last().is_some_and(|(_, number): &(String, String)| number.is_empty()) {
                    return None;
                }
                let name = std::mem::take(&mut label).join("_");
                found.push((name, String::new()));
            }
            None if NumberStyle::POINT.field(word.as_bytes()).is_some() => match found.last_mut() {
                Some((_, number)) if number.is_empty() => word.clone_into(number),
                _ => return None,
            },
            None => label.push(word),
        }
    }
    let is_whole = label.is_empty() && found.iter().all(|(name, number)| !name.is_empty() && !number.is_empty());
    let labels = found.iter().filter(|(name, _)| name.starts_with(char::is_alphabetic)).count();
    (is_whole && found.len() > 1 && labels == found.len()).then_some(found)
}

fn labelled(lines: &[String]) -> Option<AsTable> {
    let first = lines.iter().position(|line| labels_and_numbers(line).is_some())?;
    let names: Vec<String> = labels_and_numbers(&lines[first])?.into_iter().map(|(name, _)| name).collect();
    let mut left_out: Vec<(usize, String)> = Vec::new();
    let mut row = |(k, line): (usize, &String)| match labels_and_numbers(line) {
        Some(pairs) if pairs.iter().map(|(name, _)| name).eq(&names) => {
            pairs.into_iter().map(|(_, number)| number).collect::<Vec<_>>().join("\t")
        }
        _ => {
            left_out.extend(Some((k + 1, line.clone())).filter(|(k, line)| *k > first && !line.is_empty()));
            String::new()
        }
    };
    let mut rows: Vec<String> = lines.iter().enumerate().map(&mut row).collect();
    // The names take the line above the first row, where there is one.
    match first.checked_sub(1) {
        Some(above) => rows[above] = names.join("\t"),
        None => rows.insert(0, names.join("\t")),
    }
    // Without a time in each row a line that is left out is a sample that is lost.
    let note = match left_out.as_slice() {
        [] => read_as("labels"),
        [(line, words), ..] => LinesOfNoRow { lines: left_out.len(), line: *line, words: words.clone() }.into(),
    };
    Some(AsTable { text: rows.join("\n").into_bytes(), note })
}

/// A text of LabVIEW with the lines `channel names:`, `start times:`, `dt:` and `data:`, each above its values.
///
/// Errors: channels that start at different times.
fn with_interval(file: &str, lines: &[String]) -> Result<Option<AsTable>> {
    let starts = lines.iter().position(|line| line.trim() == "start times:").and_then(|at| lines.get(at + 1));
    let starts: Vec<&str> = starts.map_or(Vec::new(), |line| line.split('\t').map(str::trim).collect());
    if let Some(other) = starts.iter().find(|start| *start != &starts[0] && !start.is_empty()) {
        let found = format!("channels that start at {} and at {other} stand beside each other", starts[0]);
        return refuse_channel(file, found, "one start of all channels", "export each channel into a file of its own");
    }
    Ok(of_one_start(lines))
}

fn of_one_start(lines: &[String]) -> Option<AsTable> {
    let below = |keyword: &str| {
        let at = lines.iter().position(|line| line.trim() == keyword)?;
        Some((at, lines.get(at + 1)?))
    };
    let ((_, names), (_, intervals), (data, _)) = (below("channel names:")?, below("dt:")?, below("data:")?);
    let intervals: Vec<f64> = intervals.split('\t').map(|text| text.trim().parse().ok()).collect::<Option<_>>()?;
    let dt_s = *intervals.first().filter(|first| intervals.iter().all(|dt| dt == *first) && **first > 0.0)?;
    let mut rows = vec![String::new(); data];
    rows.push(format!("time_s\t{names}"));
    let of_data = lines[data + 1..].iter().take_while(|line| !line.trim().is_empty()).enumerate();
    rows.extend(of_data.map(|(k, line)| format!("{:.9}\t{line}", k as f64 * dt_s)));
    let note = TextOfLogger { form: "LabVIEW", interval_s: Some(dt_s), series: None, names: None }.into();
    Some(AsTable { text: rows.join("\n").into_bytes(), note })
}

/// A log of Gyroflow: whole numbers with their scales in front, `ascale` in g, `gscale` in rad/s, `tscale` in s.
fn scaled(lines: &[String]) -> Option<AsTable> {
    let scale = |name: &str| {
        let value = lines.iter().take(LOOKED_AT).find_map(|line| line.strip_prefix(name)?.strip_prefix(','))?;
        value.trim().parse::<f64>().ok().filter(|x| x.is_finite())
    };
    let names = lines.iter().position(|line| line.starts_with("t,"))?;
    let tscale = scale("tscale")?;
    let of_column = |name: &str| match name.trim() {
        "t" => Some(("time_s".to_owned(), tscale)),
        "ax" | "ay" | "az" => Some((format!("{} [g]", name.trim()), scale("ascale")?)),
        "gx" | "gy" | "gz" => Some((format!("{} [rad/s]", name.trim()), scale("gscale")?)),
        other => Some((other.to_owned(), 1.0)),
    };
    let columns: Vec<(String, f64)> = lines[names].split(',').map(of_column).collect::<Option<_>>()?;
    let mut rows = vec![String::new(); names];
    rows.push(columns.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(","));
    rows.extend(lines[names + 1..].iter().map(|line| {
        let cells = line.split(',').zip(&columns).map(|(cell, (_, scale))| {
            // What is no number is said by who reads it.
            cell.trim().parse::<f64>().map_or_else(|_| cell.to_owned(), |x| format!("{:.9}", x * scale))
        });
        cells.collect::<Vec<_>>().join(",")
    }));
    Some(AsTable { text: rows.join("\n").into_bytes(), note: read_as("Gyroflow") })
}

/// One series of InfluxDB: its name, and the time and value of its rows.
type Series = (String, Vec<(usize, String, String)>);

/// The annotated CSV of InfluxDB: series one below the other are columns beside each other where their times are the
/// same. Errors: series with other times, of which none is asked for.
fn series(file: &str, lines: &[String], wanted: Option<&str>) -> Result<Option<AsTable>> {
    let cells = |line: &str| -> Vec<String> {
        Delimiter::Byte(b',').split(line.as_bytes()).into_iter().map(|cell| decode(unquoted(cell))).collect()
    };
    let mut all: Vec<Series> = Vec::new();
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut tables_of: BTreeMap<String, usize> = BTreeMap::new();
    let mut names: Vec<String> = Vec::new();
    let mut is_below = true;
    for (number, line) in lines.iter().enumerate() {
        if line.is_empty() || line.starts_with('#') {
            is_below = true;
            continue;
        }
        let row = cells(line);
        if std::mem::take(&mut is_below) {
            names = row;
            continue;
        }
        let cell = |name: &str| names.iter().position(|own| own == name).and_then(|k| row.get(k)).map(String::as_str);
        let (Some(time), Some(value)) = (cell("_time"), cell("_value")) else { return Ok(None) };
        let field = cell("_field").unwrap_or("_value");
        let key = format!("{field} {}", cell("table").unwrap_or_default());
        let place = *places.entry(key).or_insert_with(|| {
            let count = tables_of.entry(field.to_owned()).or_default();
            *count += 1;
            let name = if *count == 1 { field.to_owned() } else { format!("{field} of table {count}") };
            all.push((name, Vec::new()));
            all.len() - 1
        });
        all[place].1.push((number, time.to_owned(), value.to_owned()));
    }
    let labels: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let times = |(_, rows): &Series| rows.iter().map(|(_, time, _)| time.clone()).collect::<Vec<_>>();
    let is_one = all.iter().map(times).collect::<BTreeSet<_>>().len() <= 1;
    let chosen: Vec<&Series> = match wanted.filter(|_| !is_one) {
        Some(wanted) => all.iter().filter(|(name, _)| name == wanted).collect(),
        None => all.iter().collect(),
    };
    if chosen.is_empty() || (!is_one && chosen.len() > 1) {
        let found =
            format!("{} series (_field) one below the other, each with times of its own: {}", all.len(), list(&labels));
        let hint = format!("add --channel {:?}, for example", labels.first().copied().unwrap_or_default());
        return refuse_channel(file, found, "the name of the series with the crash pulse", hint);
    }
    let Some((first, _, _)) = chosen.first().and_then(|(_, rows)| rows.first()) else { return Ok(None) };
    let mut text = vec![String::new(); first.saturating_sub(1)];
    let titles: Vec<&str> = chosen.iter().map(|(name, _)| name.as_str()).collect();
    text.push(format!("time\t{}", titles.join("\t")));
    text.extend((0..chosen[0].1.len()).map(|k| {
        let values: Vec<&str> = chosen.iter().map(|(_, rows)| rows[k].2.as_str()).collect();
        format!("{}\t{}", chosen[0].1[k].1, values.join("\t"))
    }));
    let (series, names) = (Some(titles.len()), Some(list(&titles)));
    let note = TextOfLogger { form: "InfluxDB", interval_s: None, series, names }.into();
    Ok(Some(AsTable { text: text.join("\n").into_bytes(), note }))
}
