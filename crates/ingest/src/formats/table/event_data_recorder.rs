//! A report of an event data recorder, several tables in one text, as a recording: the crash tables become channels,
//! the others are named.
//!
//! A table is a run of rows that begin with a number, under a line of names, under lines of text of which the last is
//! its title. `-2 [-3]` under `Velocity Change (MPH [km/h])` says one thing twice: the way of writing that is the finer
//! one is kept, and both are compared.

use crumple_signal::unit::signal_unit;
use crumple_signal::{Notes, QuantityKind};

use crate::formats::reader::Bundle;
use crate::formats::remarks::{ColumnsOfWords, PartsNotRead};
use crate::formats::table::layout::Delimiter;
use crate::formats::table::remarks::{FileNotComplete, OfARecorder, TableNotRead, TwoNumbers, TwoUnitsDiffer};
use crate::formats::table::{OneTable, TextAbove, header, one_table};
use crate::formats::text::column_names::{axis, names_acceleration, names_velocity_change};
use crate::formats::text::lines::{Line, Lines, comment, decode, field, is_gap, unquoted};
use crate::recording::content::{Ids, PulseRule, ReadChannel, Recording};
use crate::recording::details::Details;
use crate::{IngestError, IngestSettings, Refusal, Result};

/// Reads a text that holds several tables, or cells in two units. `None`: it is a table like any other.
pub fn read(file: &str, text: &[u8], bundle: &Bundle, settings: &IngestSettings) -> Result<Option<Recording>> {
    let mut sections = report_tables(text, file)?;
    if sections.len() < 2 && !sections.iter().any(|section| section.rewritten) {
        return Ok(None);
    }
    if let Some(wanted) = &settings.skip_to {
        let fold = wanted.trim().to_lowercase();
        let means = |s: &ReportTable| s.heading.iter().any(|line| line.to_lowercase().contains(&fold));
        match sections.iter().position(means) {
            Some(at) => sections = vec![sections.swap_remove(at)],
            // Its refusal says what was not found.
            None => {
                header::cut(text, wanted, file)?;
                return Ok(None);
            }
        }
    }
    // One asked for by its title is read as what it was asked for.
    let is_read = |s: &ReportTable| s.is_pulse || settings.listing || settings.skip_to.is_some();
    if !sections.iter().any(is_read) {
        return Ok(None);
    }
    let mut notes = Notes::new();
    let mut details = Details::default();
    let mut channels: Vec<ReadChannel> = Vec::new();
    let mut ids = Ids::default();
    let mut left_out = Vec::new();
    let table_settings = IngestSettings { channel: None, skip_to: None, ..settings.clone() };
    for (k, section) in sections.iter().enumerate() {
        if !is_read(section) {
            left_out.push(section.name());
            continue;
        }
        let table = match one_table(file, &section.text, &section.text, bundle, &table_settings, TextAbove::Heading) {
            Ok(table) => table,
            // A table that a list cannot read does not hide the others.
            Err(error) if settings.listing || channels.iter().any(is_change) => {
                notes.push(TableNotRead { table: section.name(), reason: error.to_string() });
                continue;
            }
            Err(error) => return Err(error),
        };
        let OneTable { channels: of_table, details: facts, notes: table_notes } = table;
        if channels.is_empty() {
            details = facts;
        }
        notes.extend(section.notes.clone());
        for note in table_notes.iter() {
            if !notes.iter().any(|before| before == note) {
                notes.push(note.clone());
            }
        }
        for mut read in of_table {
            describe_by_heading(&mut read, section, k, &mut ids);
            channels.push(read);
        }
    }
    if !left_out.is_empty() {
        notes.push(PartsNotRead { parts: "tables", names: left_out.join(", ") });
    }
    for (line, words) in incompleteness(text, file)? {
        details.facts.push(not_complete(line, &words));
        notes.push(FileNotComplete { line, words });
    }
    edr_notes(&channels, &mut details, &mut notes);
    Ok(Some(Recording { details, channels, pulse_rule: PulseRule::OnlyOne, contact_at_zero: false, notes }))
}

/// What the recorder says of its file in a line.
pub fn not_complete(line: usize, words: &str) -> String {
    format!("the recorder says that its file is not complete (line {line}: {words})")
}

fn is_change(read: &ReadChannel) -> bool {
    read.channel.quantity == QuantityKind::VelocityChange
}

fn describe_by_heading(read: &mut ReadChannel, section: &ReportTable, number: usize, ids: &mut Ids) {
    let channel = &mut read.channel;
    // A speed before the crash is no change of velocity.
    if !section.is_pulse && channel.quantity == QuantityKind::VelocityChange {
        channel.quantity = QuantityKind::Velocity;
    }
    channel.axis = channel.axis.or_else(|| section.axis());
    channel.id = ids.unique(&channel.id);
    // The number of a column says nothing where there are several tables.
    read.aliases.retain(|alias| alias.parse::<usize>().is_err());
    if !section.title.is_empty() {
        channel.comment = Some(section.title.clone());
        read.aliases.push(section.title.clone());
    }
    read.aliases.push(format!("table {}", number + 1));
}

/// A refusal of a table that is one of a recorder, read without its profile, says so.
pub fn with_profile_hint(file: &str, text: &[u8], error: IngestError) -> IngestError {
    let is_report =
        report_tables(text, file).is_ok_and(|sections| sections.iter().any(|section| section.only_a_change));
    let hint = "a table of an event data recorder (velocity change over time) is read with --profile edr";
    let is_of_table = matches!(error.refusal, Refusal::Content | Refusal::Channel);
    if is_of_table && is_report { error.with_hint(hint) } else { error }
}

/// What an event data recorder's table is good for.
pub fn edr_notes(channels: &[ReadChannel], details: &mut Details, notes: &mut Notes) {
    details.no_pulse = !channels.iter().any(|f| f.fitness.is_some());
    details.facts.push(
        "event data recorder (49 CFR 563): time zero is the recorder's, some milliseconds after contact".to_owned(),
    );
    notes.push(OfARecorder {});
}

/// Delimiters of reports, most particular first.
const DELIMITERS: [u8; 3] = [b'\t', b';', b','];
/// More lines of text than this above a table are no heading of it.
const HEADING_LINES: usize = 20;

/// One table of a report, ready to be read as a table of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportTable {
    /// The last line of text above the names; empty where there is none.
    pub title: String,
    /// All lines of text above the names.
    pub heading: Vec<String>,
    /// The table as plain text: one number a cell, lines at their numbers.
    pub text: Vec<u8>,
    /// It holds a change of velocity or an acceleration of the event itself.
    pub is_pulse: bool,
    /// It names a change of velocity and no acceleration.
    pub only_a_change: bool,
    pub notes: Notes,
    /// Whether its text differs from that of the file.
    pub rewritten: bool,
}

impl ReportTable {
    /// The axis that its heading names.
    pub fn axis(&self) -> Option<crumple_signal::Axis> {
        self.heading.iter().rev().find_map(|line| axis(line))
    }

    /// Its title, or words for none.
    pub fn name(&self) -> String {
        if self.title.is_empty() { "a table without a title".to_owned() } else { format!("{:?}", self.title) }
    }
}

/// The tables of a report that have a line of names, in its order.
fn report_tables(text: &[u8], file: &str) -> Result<Vec<ReportTable>> {
    let mut all = Lines::new(file, text);
    let lines: Vec<Line> = std::iter::from_fn(|| all.take().transpose()).collect::<Result<_>>()?;
    let mut sections = Vec::new();
    let mut words: Vec<usize> = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let bytes = lines[at].bytes;
        if bytes.trim_ascii().is_empty() || comment(bytes).is_some() {
            at += 1;
        } else if let Some(delimiter) = delimiter_of(bytes) {
            let end =
                (at..lines.len()).find(|k| delimiter_of(lines[*k].bytes) != Some(delimiter)).unwrap_or(lines.len());
            if let Some((header, above)) = words.split_last() {
                let from = above.len().saturating_sub(HEADING_LINES);
                let heading: Vec<String> = above[from..]
                    .iter()
                    .map(|k| cells(lines[*k].bytes, delimiter).join(" ").trim().to_owned())
                    .collect();
                sections.push(report_table(&lines, *header, at..end, delimiter, heading));
            }
            words.clear();
            at = end;
        } else {
            words.push(at);
            at += 1;
        }
    }
    Ok(sections)
}

/// What the report says of its own completeness, by line: `Complete File Recorded, No`.
fn incompleteness(text: &[u8], file: &str) -> Result<Vec<(usize, String)>> {
    let mut incomplete = Vec::new();
    let mut lines = Lines::new(file, text);
    while let Some(line) = lines.take()? {
        let words = decode(line.bytes);
        // The answer is the last word; `(Yes, No)` in the name of the field is none.
        let answer = words.rsplit(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty());
        let is_question_alone = words.trim_end().ends_with(')');
        if words.to_lowercase().contains("complete file recorded")
            && !is_question_alone
            && answer.is_some_and(|word| word.eq_ignore_ascii_case("no"))
        {
            incomplete.push((line.number, words.trim().to_owned()));
        }
    }
    Ok(incomplete)
}

/// The delimiter of a row: two fields and more, of which the first is a number.
fn delimiter_of(line: &[u8]) -> Option<u8> {
    DELIMITERS.into_iter().find(|byte| {
        let fields = Delimiter::Byte(*byte).split(line);
        fields.len() >= 2 && [b'.', b','].into_iter().any(|d| d != *byte && number(unquoted(fields[0]), d).is_some())
    })
}

/// The printed text of a number, of one in two units the first.
fn number(cell: &[u8], decimal: u8) -> Option<()> {
    field(cell, decimal).map(|_| ()).or_else(|| two_numbers(cell, decimal).map(|_| ()))
}

fn cells(line: &[u8], delimiter: u8) -> Vec<String> {
    Delimiter::Byte(delimiter).split(line).into_iter().map(|f| decode(unquoted(f))).collect()
}

/// The numbers of a cell in two units, printed and as values.
type Pair = [(Vec<u8>, f64); 2];

/// `-2 [-3]` as both numbers.
fn two_numbers(cell: &[u8], decimal: u8) -> Option<Pair> {
    let cell = unquoted(cell).strip_suffix(b"]")?;
    let open = cell.iter().position(|b| *b == b'[')?;
    let read = |part: &[u8]| {
        let part = part.trim_ascii();
        field(part, decimal).map(|number| (part.to_vec(), number.value))
    };
    Some([read(&cell[..open])?, read(&cell[open + 1..])?])
}

/// `Velocity Change (MPH [km/h])`, `Speed, MPH [km/h]`: the name and both units.
fn dual_unit(title: &str) -> Option<(String, [String; 2])> {
    let inner = title.trim().trim_end_matches(')').trim_end().strip_suffix(']')?;
    let (before, second) = inner.rsplit_once('[')?;
    let before = before.trim_end();
    let start = before.rfind(['(', ',', ' ']).map_or(0, |k| k + 1);
    let first = before[start..].trim();
    let known = |symbol: &str| signal_unit(symbol.trim()).map(|(kind, _)| kind);
    (known(first).is_some() && known(first) == known(second)).then(|| {
        let name = before[..start].trim_end_matches(['(', ',', ' ', '-']).trim().to_owned();
        (name, [first.to_owned(), second.trim().to_owned()])
    })
}

fn decimals(printed: &[u8], decimal: u8) -> i32 {
    let at = printed.iter().position(|b| *b == decimal);
    at.and_then(|at| i32::try_from(printed.len() - at - 1).ok()).unwrap_or(0)
}

/// A column whose cells are numbers, in one unit or two.
struct Column {
    title: String,
    cells: Vec<Vec<u8>>,
}

fn report_table(
    lines: &[Line],
    header: usize,
    rows: std::ops::Range<usize>,
    delimiter: u8,
    heading: Vec<String>,
) -> ReportTable {
    let mut notes = Notes::new();
    let names = cells(lines[header].bytes, delimiter);
    let table: Vec<Vec<&[u8]>> =
        lines[rows.clone()].iter().map(|line| Delimiter::Byte(delimiter).split(line.bytes)).collect();
    let points = table.iter().flatten().any(|cell| cell.contains(&b'.'));
    let decimal = if delimiter != b',' && !points { b',' } else { b'.' };
    let width = table.iter().map(Vec::len).max().unwrap_or(0);
    let title = heading.last().cloned().unwrap_or_default();
    let mut columns = Vec::new();
    let mut rewritten = false;
    let (mut of_words, mut with_words) = (Vec::new(), Vec::new());
    for k in 0..width {
        let name = names.get(k).filter(|n| !n.is_empty()).cloned().unwrap_or_else(|| format!("column {}", k + 1));
        let column: Vec<&[u8]> = table.iter().map(|row| row.get(k).copied().unwrap_or_default()).collect();
        if column.iter().all(|cell| unquoted(cell).is_empty()) {
            rewritten = true;
            continue;
        }
        let dual = dual_unit(&name);
        let pairs: Vec<Option<_>> = column.iter().map(|cell| two_numbers(cell, decimal)).collect();
        if pairs.iter().any(Option::is_some) {
            rewritten = true;
            let numbers = rows.clone().map(|row| lines[row].number);
            columns.push(finer_of_two_units(&name, dual, &column, pairs, numbers, decimal, &mut notes));
            continue;
        }
        let is_number = |cell: &&[u8]| field(cell, decimal).is_some();
        let word = column.iter().position(|cell| !is_number(cell) && !is_gap(cell));
        if let Some(row) = word.filter(|_| k > 0) {
            let numbers = column.iter().any(is_number);
            // In the pulse itself such a cell is an error of its line, which the reader of the table names; whether it
            // is one, its own name says, or the title of the table.
            let of_the_pulse = is_of_the_pulse(&name) || (numbers && title_of_a_pulse(&title));
            if !of_the_pulse {
                if numbers {
                    let (cell, line) = (decode(unquoted(column[row])), lines[rows.start + row].number);
                    with_words.push(format!("{name} ({cell:?} in line {line})"));
                } else {
                    of_words.push(name);
                }
                rewritten = true;
                continue;
            }
        }
        let title = match dual {
            Some((name, [unit, _])) => {
                rewritten = true;
                format!("{name} ({unit})")
            }
            None => name,
        };
        columns.push(Column { title, cells: column.into_iter().map(<[u8]>::to_vec).collect() });
    }
    if !of_words.is_empty() {
        notes.push(ColumnsOfWords { columns: of_words.join(", "), table: Some(title.clone()), with_words: 0 });
    }
    if !with_words.is_empty() {
        let (columns, with_words) = (with_words.join(", "), with_words.len());
        notes.push(ColumnsOfWords { columns, table: Some(title.clone()), with_words });
    }
    let change = columns.iter().any(|c| names_velocity_change(&c.title));
    let acceleration = columns.iter().any(|c| is_acceleration(&c.title));
    let is_pulse = change || acceleration || title_of_a_pulse(&title);
    let text = plain_text(lines, header, rows, delimiter, &columns);
    ReportTable { title, heading, text, is_pulse, only_a_change: change && !acceleration, notes, rewritten }
}

/// Whether a column is named as a change of velocity or an acceleration.
fn is_of_the_pulse(name: &str) -> bool {
    names_velocity_change(name) || is_acceleration(name)
}

/// Whether a column is named as an acceleration; the pedal of that name is none, nor is cruise control.
fn is_acceleration(name: &str) -> bool {
    const OTHER: [&str; 8] = ["accelerator", "pedal", "cruise", "accept", "accur", "access", "accum", "accord"];
    let name = name.to_lowercase();
    !OTHER.iter().any(|word| name.contains(word)) && names_acceleration(&name)
}

/// Whether the line above the names says that the table is the pulse.
fn title_of_a_pulse(title: &str) -> bool {
    let title = title.to_lowercase();
    ["crash pulse", "delta-v", "delta v", "velocity change"].iter().any(|words| title.contains(words))
}

/// The column in the unit in which it is printed more finely; both are compared where both units are known.
fn finer_of_two_units(
    name: &str,
    dual: Option<(String, [String; 2])>,
    column: &[&[u8]],
    pairs: Vec<Option<Pair>>,
    numbers: impl Iterator<Item = usize>,
    decimal: u8,
    notes: &mut Notes,
) -> Column {
    let Some((name, units)) = dual else {
        notes.push(TwoNumbers { column: name.to_owned() });
        let cells = column.iter().zip(pairs).map(|(cell, pair)| pair.map_or(cell.to_vec(), |[(first, _), _]| first));
        return Column { title: name.to_owned(), cells: cells.collect() };
    };
    let factor = [0, 1].map(|side| signal_unit(&units[side]).map_or(1.0, |(_, factor)| factor));
    // Half the last printed digit of either side, in SI.
    let rounding = [0, 1].map(|side: usize| {
        let most = pairs.iter().flatten().map(|pair| decimals(&pair[side].0, decimal)).max().unwrap_or(0);
        0.5 * 10_f64.powi(-most) * factor[side]
    });
    let kept = usize::from(rounding[1] < rounding[0]);
    let (mut apart, mut worst): (usize, Option<(f64, usize, String)>) = (0, None);
    let mut cells = Vec::with_capacity(column.len());
    for ((cell, pair), number) in column.iter().zip(pairs).zip(numbers) {
        let Some(pair) = pair else {
            // A lone number is of the first unit.
            let alone = field(cell, decimal).filter(|_| kept == 1);
            let other = alone.map(|number| format!("{}", number.value * factor[0] / factor[1]));
            let other = other.map(|text| text.replace('.', &char::from(decimal).to_string()));
            cells.push(other.map_or(cell.to_vec(), String::into_bytes));
            continue;
        };
        let gap = (pair[0].1 * factor[0] - pair[1].1 * factor[1]).abs();
        // 1e-9: binary rounding of the products.
        if gap > (rounding[0] + rounding[1]) * (1.0 + 1e-9) {
            apart += 1;
            if worst.as_ref().is_none_or(|(most, ..)| gap > *most) {
                worst = Some((gap, number, decode(unquoted(cell))));
            }
        }
        let [first, second] = pair;
        cells.push(if kept == 0 { first.0 } else { second.0 });
    }
    if let Some((_, line, cell)) = worst {
        let (column, used, [first, second]) = (name.clone(), units[kept].clone(), units.clone());
        notes.push(TwoUnitsDiffer { cells: apart, column, first, second, cell, line, used });
    }
    Column { title: format!("{name} ({})", units[kept]), cells }
}

/// Lines at their numbers: comments stay, names and rows are those of `columns`, all else is empty.
fn plain_text(
    lines: &[Line],
    header: usize,
    rows: std::ops::Range<usize>,
    delimiter: u8,
    columns: &[Column],
) -> Vec<u8> {
    let mut text = Vec::new();
    for (at, line) in lines[..rows.end].iter().enumerate() {
        if at == header || rows.contains(&at) {
            let cell = |column: &Column| match at.checked_sub(rows.start) {
                Some(row) => column.cells[row].clone(),
                None => format!("\"{}\"", column.title.replace('"', "'")).into_bytes(),
            };
            text.extend(columns.iter().map(cell).collect::<Vec<_>>().join(&delimiter));
        } else if comment(line.bytes).is_some() {
            text.extend(line.bytes);
        }
        text.push(b'\n');
    }
    text
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn cells_in_two_units_are_read_in_the_finer_one_and_compared() {
        let text = b"Longitudinal Crash Pulse (Event Record 1)\nTime (msec),\"Velocity Change (MPH [km/h])\"\n0,0 \
            [0]\n10,-2 [-3]\n20,-4 [-9]\n";
        let [section] = report_tables(text, "a.csv").unwrap().try_into().unwrap();
        assert_eq!(section.title, "Longitudinal Crash Pulse (Event Record 1)");
        assert_eq!(section.axis(), Some(crumple_signal::Axis::X));
        assert_eq!(
            String::from_utf8(section.text).unwrap(),
            "\n\"Time (msec)\",\"Velocity Change (km/h)\"\n0,0\n10,-3\n20,-9\n"
        );
        // -4 mph are -6.4 km/h.
        let texts = section.notes.to_texts().join("\n");
        assert!(
            texts.contains("1 cells of column Velocity Change") && texts.contains("\"-4 [-9]\" in line 5"),
            "{texts}"
        );
    }

    #[test]
    fn a_lone_number_has_the_decimal_mark_of_its_table() {
        let text =
            b"Longitudinal Crash Pulse\nTime (msec);Delta-V (MPH [km/h])\n0;0,0 [0,0]\n10;-1,5\n20;-2,5 [-4,0]\n";
        let [section] = report_tables(text, "a.csv").unwrap().try_into().unwrap();
        let text = String::from_utf8(section.text).unwrap();
        // km/h to a tenth is the finer of both; 1.5 mph are 2.414 km/h.
        assert!(text.contains("10;-2,414") && !text.contains('.'), "{text}");
    }

    #[test]
    fn the_finer_unit_is_the_one_with_the_smaller_last_digit() {
        let text = b"Time (msec);Delta-V, longitudinal (MPH [km/h])\n0;0,0 [0]\n10;-1,2 [-2]\n";
        let [section] = report_tables(text, "a.csv").unwrap().try_into().unwrap();
        assert!(String::from_utf8_lossy(&section.text).ends_with("\"Delta-V, longitudinal (MPH)\"\n0;0,0\n10;-1,2\n"));
        assert!(section.notes.is_empty(), "{:?}", section.notes);
    }

    #[test]
    fn every_table_is_found_with_its_heading() {
        let text = b"CDR Report,v21\nComplete File Recorded,No\nPre-Crash Data\nTime (sec),\"Speed (MPH \
            [km/h])\",Brake\n-5,37 [60],Off\n-4,38 [61],On\n\nLateral Crash Pulse\nTime (msec),Delta-V \
            (km/h)\n0,0\n10,1\n";
        let tables = report_tables(text, "a.csv").unwrap();
        let titles: Vec<_> = tables.iter().map(|s| (s.title.as_str(), s.is_pulse)).collect();
        assert_eq!(titles, [("Pre-Crash Data", false), ("Lateral Crash Pulse", true)]);
        assert!(tables[0].notes.to_texts().join("").contains("not read: Brake"));
        assert_eq!(incompleteness(text, "a.csv").unwrap(), [(2, "Complete File Recorded,No".to_owned())]);
        assert_eq!(incompleteness(b"Complete File Recorded (Yes, No),Yes\n", "a.csv").unwrap(), []);
        assert_eq!(incompleteness(b"Complete File Recorded (Yes, No)\n", "a.csv").unwrap(), []);
    }

    #[test]
    fn a_pedal_is_no_acceleration_and_a_word_in_the_pulse_is_an_error_of_its_line() {
        let text = b"Pre-Crash Data\nTime (sec),Accelerator Pedal Switch,\"Accelerator Pedal, % Full\",\"Speed, \
            km/h\"\n-2,Off,0,60\n-1,On,9,SNA\n\n\
                     Longitudinal Crash Pulse\nTime (msec),Longitudinal (km/h),Status\n0,0,ok\n10,SNA,ok\n20,-4,ok\n";
        let [before, pulse] = report_tables(text, "a.csv").unwrap().try_into().unwrap();
        assert!(!before.is_pulse && pulse.is_pulse);
        let texts = before.notes.to_texts().join("\n");
        assert!(
            texts.contains("columns of words in the table \"Pre-Crash Data\" are not read: Accelerator Pedal Switch"),
            "{texts}"
        );
        assert!(texts.contains("are not read: Speed, km/h (\"SNA\" in line 4)"), "{texts}");
        assert!(String::from_utf8_lossy(&before.text).contains("-1,9\n"));
        // The column of the change stays, with its word; the column of words next to it goes.
        assert!(String::from_utf8_lossy(&pulse.text).ends_with("10,SNA\n20,-4\n"), "{:?}", pulse.notes);
    }

    #[test]
    fn names_carry_two_units_in_several_spellings() {
        for (title, name, units) in [
            ("Velocity Change (MPH [km/h])", "Velocity Change", ["MPH", "km/h"]),
            ("Delta-V, longitudinal (MPH [km/h])", "Delta-V, longitudinal", ["MPH", "km/h"]),
            ("Speed, Vehicle Indicated MPH [km/h]", "Speed, Vehicle Indicated", ["MPH", "km/h"]),
        ] {
            assert_eq!(dual_unit(title), Some((name.to_owned(), units.map(str::to_owned))), "{title}");
        }
        for title in ["Velocity Change [km/h]", "Time (msec)", "a (x [y])", "]", "[]", "([])"] {
            assert_eq!(dual_unit(title), None, "{title}");
        }
    }

    proptest::proptest! {
        #[test]
        fn any_text_gives_an_answer(text in "[-0-9., \\[\\]();\n\ta-z\"#]{0,300}") {
            for section in report_tables(text.as_bytes(), "t").unwrap() {
                let lines = section.text.iter().filter(|b| **b == b'\n').count();
                proptest::prop_assert!(lines <= text.lines().count() + 1);
            }
            incompleteness(text.as_bytes(), "t").unwrap();
        }
    }
}
