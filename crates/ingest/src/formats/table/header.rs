//! Column names and units from the header lines of a table.

use crumple_signal::unit;

use crate::formats::iso13499::code_of_name;
use crate::formats::table::layout::{Delimiter, Layout};
use crate::formats::text::column_names::{Unit, is_kg, is_time_name, names_acceleration, signal, split_unit, symbol};
use crate::formats::text::lines::{Line, Lines, decode, field, unquoted};
use crate::time::stamp;
use crate::{Result, refuse};

/// Name and stated unit of a column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The name in the header without its unit in brackets; `column 3` where there is none.
    pub name: String,
    /// The name in the header, whole.
    pub title: String,
    pub unit: Unit,
    /// Whether the file names it.
    pub is_named: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub struct TableHeader {
    pub columns: Vec<Column>,
    pub named: bool,
    /// How many names there are.
    pub names: usize,
    /// One name fewer than columns.
    pub lacks_a_name: bool,
    /// `kg` was read as kilo-g in these columns.
    pub kilo_g: Vec<usize>,
    /// Header lines that are neither names nor units.
    pub ignored_lines: Vec<usize>,
    /// Two lines that state different units of one column.
    pub contradiction: Option<Contradiction>,
}

impl TableHeader {
    /// Whether there are fewer names than columns.
    pub fn lacks_names(&self) -> bool {
        self.named && self.names < self.columns.len()
    }
}

/// Two units of one column.
#[derive(Debug, Clone, PartialEq)]
pub struct Contradiction {
    pub column: usize,
    /// The line of the names, and the name with its unit.
    pub name: (usize, String),
    /// The line of the units, and the unit.
    pub unit: (usize, String),
}

/// Reads names and units from the lines before the rows.
pub fn read(layout: &Layout) -> TableHeader {
    let count = layout.columns;
    let mut lines: Vec<(usize, Vec<String>)> =
        layout.header.iter().map(|line| (line.number, cells(line, layout))).collect();
    if lines.is_empty()
        && let Some(comment) = layout.comments.last()
    {
        // Many programs write the names as the last comment.
        let names = cells(comment, layout);
        if names.len() >= count && names.iter().any(|name| is_time_name(name)) && comment.number < layout.first_line {
            lines.push((comment.number, names));
        }
    }
    of_lines(lines, count)
}

/// Reads names and units of so many columns from the cells of the lines before the rows, with their numbers.
pub fn of_lines(mut lines: Vec<(usize, Vec<String>)>, count: usize) -> TableHeader {
    // A line that names no column, such as `[DATA]`, `***End_of_Header***` or dashes, stands below the names.
    let mut below = Vec::new();
    while let [.., above, last] = lines.as_slice()
        && names_nothing(&last.1, &above.1, count)
    {
        below.extend(lines.pop());
    }
    let units = units_line(&lines, count).map(|k| {
        below.extend(lines.split_off(k + 1));
        lines.pop()
    });
    let units = units.flatten();
    let names = lines.pop();
    let named = names.is_some();
    let (names_line, names) = names.unwrap_or_default();
    // A delimiter at the end of every line is no column.
    let stated = names.iter().rposition(|name| !name.trim().is_empty()).map_or(0, |last| last + 1);
    let preamble = Preamble::of(&lines, count);
    let mut kilo_g = Vec::new();
    let mut contradiction = None;
    let columns = (0..count)
        .map(|k| {
            let title =
                names.get(k).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("column {}", k + 1));
            let (mut name, mut unit) = split_unit(&title);
            if matches!(unit, Unit::Unstated) {
                unit = preamble.unit(k).map_or(unit, |cell| symbol(cell, &title));
            }
            if let Some(code) = preamble.code(k) {
                code.clone_into(&mut name);
            }
            if let Some((units_line, cell)) = units.as_ref().and_then(|(line, cells)| Some((*line, cells.get(k)?))) {
                let stated = unit_cell(cell, &title);
                if stated.is_known() && unit.is_known() && stated != unit && contradiction.is_none() {
                    let (name, unit) = ((names_line, title.clone()), (units_line, cell.clone()));
                    contradiction = Some(Contradiction { column: k, name, unit });
                }
                if !matches!(stated, Unit::Unstated) {
                    unit = stated;
                }
            }
            let about = format!("{title} {}", units.as_ref().and_then(|(_, c)| c.get(k)).map_or("", String::as_str));
            if matches!(&unit, Unit::Unknown(symbol) if is_kg(symbol)) && names_acceleration(&about) {
                kilo_g.push(k);
                unit = signal("kilo-g");
            }
            Column { name, title, unit, is_named: names.get(k).is_some_and(|name| !name.is_empty()) }
        })
        .collect();
    TableHeader {
        columns,
        named,
        names: stated,
        lacks_a_name: named && stated + 1 == count,
        kilo_g,
        ignored_lines: lines.iter().chain(&below).map(|(number, _)| *number).collect(),
        contradiction,
    }
}

/// Lines above the names that hold one value a column behind a word that says what they are: `Engineering Unit,g,mm`.
struct Preamble<'a> {
    lines: Vec<Values<'a>>,
}

/// A line of them: its word, whether that stands beside all values and not above the first column, and the values.
struct Values<'a> {
    word: String,
    is_beside: bool,
    values: &'a [String],
}

impl<'a> Preamble<'a> {
    /// Of lines with a cell for each of so many columns; the word stands above the first, or beside them all.
    fn of(lines: &'a [(usize, Vec<String>)], count: usize) -> Self {
        let of_line = |(_, cells): &'a (usize, Vec<String>)| {
            let filled = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
            let beside = filled.checked_sub(count).filter(|beside| *beside <= 1)?;
            let word = cells[0].trim().trim_end_matches(':').to_lowercase();
            Some(Values { word, is_beside: beside == 1, values: &cells[beside..filled] })
        };
        Self { lines: lines.iter().filter_map(of_line).filter(|_| count > 1).collect() }
    }

    /// The cell of a column in the last line of these whose word is meant.
    fn cell(&self, k: usize, is_meant: impl Fn(&str) -> bool) -> Option<&'a str> {
        let line = self.lines.iter().rev().find(|line| is_meant(&line.word))?;
        let cell = line.values.get(k).filter(|_| line.is_beside || k > 0)?.trim();
        Some(cell).filter(|cell| !["", "-", "n/a", "na", "none"].contains(&&*cell.to_lowercase()))
    }

    fn unit(&self, k: usize) -> Option<&'a str> {
        const WORDS: [&str; 7] =
            ["unit", "units", "engineering unit", "engineering units", "eu", "einheit", "einheiten"];
        self.cell(k, |word| WORDS.contains(&word))
    }

    fn code(&self, k: usize) -> Option<&'a str> {
        let code = self.cell(k, |word| word.contains("code") || word.contains("iso"))?;
        code_of_name(code).map(|_| code)
    }
}

/// Whether a line of one cell, below names or in brackets or marks, or one without letters and digits names no column.
fn names_nothing(cells: &[String], above: &[String], count: usize) -> bool {
    let filled: Vec<&String> = cells.iter().filter(|cell| !cell.is_empty()).collect();
    let has_sign = |cell: &str| cell.chars().any(char::is_alphanumeric);
    let above = above.iter().filter(|cell| has_sign(cell)).count();
    match filled.as_slice() {
        [one] => above > 0 && (above >= count && count > 1 || !one.starts_with(char::is_alphanumeric)),
        several => above > 0 && !several.iter().any(|cell| has_sign(cell)),
    }
}

/// The line of units among those before the rows: the last one, or the one before it with names above (a line of
/// remarks may stand below the units).
fn units_line(lines: &[(usize, Vec<String>)], count: usize) -> Option<usize> {
    let last = lines.len().checked_sub(1)?;
    let is_below_names =
        |k: usize| k > 0 && is_unit_line(&lines[k].1) && !is_header_below_a_title(&lines[k].1, &lines[k - 1].1, count);
    if is_below_names(last) {
        return Some(last);
    }
    let names_above = |k: usize| lines[k - 1].1.len() == count && lines[k - 1].1.iter().any(|cell| is_time_name(cell));
    let all_units = |cells: &[String]| cells.len() == count && cells.iter().all(|cell| unit_cell(cell, "").is_known());
    (last >= 2 && all_units(&lines[last - 1].1) && names_above(last - 1)).then(|| last - 1)
}

/// The cells of a header line. Its delimiter may differ from that of the rows (`# time(s), <tab> acceleration(g)` over
/// blanks): then the one that gives as many cells as there are columns is taken.
pub fn cells(line: &Line, layout: &Layout) -> Vec<String> {
    let count = layout.columns;
    // A cell broken into lines is one.
    let text_of = |field: &[u8]| {
        let text = decode(unquoted(field));
        // `"AccelX"|"G"|-3.0|3.0|100`: name, unit, range, rate.
        let mut parts = text.split('|').map(|part| part.trim_matches('"'));
        let text = match (parts.next(), parts.next(), parts.next()) {
            (Some(name), Some(unit), Some(_)) => format!("{name} [{unit}]"),
            _ => text,
        };
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let clean = |fields: Vec<&[u8]>| -> Vec<String> { fields.into_iter().map(text_of).collect() };
    let cells_by_delimiter = clean(layout.without_blanks(layout.delimiter.split(line.bytes)));
    if cells_by_delimiter.len() >= 2 && layout.delimiter != Delimiter::Blanks {
        return cells_by_delimiter;
    }
    [b',', b';', b'\t']
        .into_iter()
        .map(|byte| clean(Delimiter::Byte(byte).split(line.bytes)).into_iter().filter(|c| !c.is_empty()).collect())
        .find(|cells: &Vec<String>| cells.len() == count)
        .or_else(|| cells_between_blanks(&decode(line.bytes), count))
        .unwrap_or(cells_by_delimiter)
}

/// Cells with blanks in them, `t [s]   a [g]`: those between runs of two blanks and more, else those that end in a
/// unit in brackets, if they are as many as there are columns.
fn cells_between_blanks(line: &str, count: usize) -> Option<Vec<String>> {
    let wide: Vec<String> =
        line.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).map(str::to_owned).collect();
    if wide.len() == count {
        return Some(wide);
    }
    let words: Vec<&str> = line.split_whitespace().collect();
    if words.len() == count {
        return None;
    }
    let mut cells = vec![String::new()];
    let mut depth = 0_i32;
    for c in line.trim().chars() {
        let last = cells.last_mut()?;
        last.push(c);
        depth += i32::from(matches!(c, '[' | '(' | '{')) - i32::from(matches!(c, ']' | ')' | '}'));
        if depth == 0 && matches!(c, ']' | ')' | '}') {
            cells.push(String::new());
        }
    }
    let cells: Vec<String> = cells.iter().map(|cell| cell.trim().to_owned()).filter(|cell| !cell.is_empty()).collect();
    // The names of a table without brackets, each followed by its unit.
    let pairs = || -> Option<Vec<String>> {
        let is_unit = |word: &str| unit_cell(word, "").is_known();
        let pairs = words.chunks_exact(2).map(|pair| is_unit(pair[1]).then(|| pair.join(" ")));
        (words.len() == 2 * count).then(|| pairs.collect())?
    };
    if cells.len() == count { Some(cells) } else { pairs() }
}

/// Whether the last line before the rows has the names, and the line above it is a title: as many cells as there are
/// columns, each with a name and a unit or one of them named for time, and no such names above.
fn is_header_below_a_title(last: &[String], above: &[String], count: usize) -> bool {
    let filled = last.iter().rposition(|cell| !cell.is_empty()).map_or(0, |end| end + 1);
    let above_is_names = above.len() >= count && above.iter().any(|cell| is_time_name(cell));
    let has_both = |cell: &String| {
        let (name, unit) = split_unit(cell);
        name != *cell && unit.is_known()
    };
    filled == count && !above_is_names && (last.iter().all(has_both) || last.iter().any(|cell| is_time_name(cell)))
}

/// A line under the names is one of units if some cell is a unit and no cell is a bare name.
fn is_unit_line(cells: &[String]) -> bool {
    let kinds: Vec<Unit> = cells.iter().map(|cell| unit_cell(cell, "")).collect();
    kinds.iter().any(Unit::is_known)
        && cells.iter().zip(&kinds).all(|(cell, unit)| {
            !matches!(unit, Unit::Unstated) || matches!(cell.as_str(), "" | "-" | "1") || !is_time_name(cell)
        })
}

/// A cell of the units line: `g`, `[m/s^2]`, `time - seconds (computed after test)`.
fn unit_cell(cell: &str, title: &str) -> Unit {
    let cell = cell.trim();
    let whole = symbol(unit::without_brackets(cell), title);
    if whole.is_known() {
        return whole;
    }
    if let Some((name, rest)) = cell.split_once(" - ") {
        let rest = rest.split('(').next().unwrap_or(rest).trim();
        return symbol(rest, name);
    }
    let (_, unit) = split_unit(cell);
    match unit {
        Unit::Unstated if is_kg(cell) => Unit::Unknown(cell.to_owned()),
        unit => unit,
    }
}

/// Lines looked through for the title.
const LINE_LIMIT: usize = 9_000;

/// The text from the line after the first one that holds `title` (any case) up to the first blank line or line without
/// a leading number after its rows. Everything before becomes empty lines, so that line numbers stay.
pub fn cut(text: &[u8], title: &str, file: &str) -> Result<Vec<u8>> {
    let wanted = title.trim().to_lowercase();
    let mut lines = Lines::new(file, text);
    let mut cut = Vec::new();
    let (mut inside, mut rows) = (false, false);
    while let Some(line) = lines.take()? {
        if inside {
            let is_row = starts_with_a_number(line.bytes);
            if rows && !is_row {
                break;
            }
            rows |= is_row;
            cut.extend_from_slice(&text[line.offset..lines.offset]);
        } else {
            cut.push(b'\n');
            inside = decode(line.bytes).to_lowercase().contains(&wanted);
            if !inside && line.number > LINE_LIMIT {
                break;
            }
        }
    }
    if rows {
        return Ok(cut);
    }
    let found = if inside {
        format!("no rows of numbers after the line with {title:?}")
    } else {
        format!("no line holds {title:?}")
    };
    refuse(file, found, "the title of a table in this file", "correct --skip-to")
}

fn starts_with_a_number(line: &[u8]) -> bool {
    let numeric =
        |bytes: &[u8]| field(bytes, b'.').is_some() || field(bytes, b',').is_some() || stamp(&decode(bytes)).is_some();
    [Delimiter::Byte(b'\t'), Delimiter::Byte(b';'), Delimiter::Byte(b','), Delimiter::Blanks].into_iter().any(|way| {
        let fields = way.split(line);
        fields.len() >= 2 && numeric(unquoted(fields[0]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    use crate::formats::table::layout::sniff;

    const G: Unit = Unit::Signal(QuantityKind::Acceleration, 9.806_65);

    fn header(text: &str) -> TableHeader {
        read(&sniff(text.as_bytes(), "t.csv", 2).unwrap())
    }

    fn units(text: &str) -> Vec<Unit> {
        header(text).columns.into_iter().map(|c| c.unit).collect()
    }

    #[test]
    fn a_second_line_may_hold_the_units() {
        assert_eq!(units("t,a\ns,g\n0,1\n1,2\n"), [Unit::Time(1.0), G]);
        assert_eq!(units("t;a\n[ms];m/(s*s)\n0;1\n1;2\n")[1], Unit::Signal(QuantityKind::Acceleration, 1.0));
        assert_eq!(units("t;a\n[ms];[g]\n0;1\n1;2\n"), [Unit::Time(1e-3), G]);
    }

    #[test]
    fn a_title_above_the_names_is_no_header() {
        let rows = "0,0;1,5;50,0\n0,1;2,5;49,9\n0,2;2,5;49,8\n";
        let header = header(&format!(
            "Versuch Nr. 12; Müller\nZeit [ms];Längsbeschleunigung B-Säule [g];Geschwindigkeit (km/h)\n{rows}"
        ));
        let names: Vec<&str> = header.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["Zeit", "Längsbeschleunigung B-Säule", "Geschwindigkeit"]);
        assert_eq!(header.columns[1].unit, G);
        assert_eq!(header.ignored_lines, [1]);
        // Names without units of their own, a title of as many words, and units below names.
        assert_eq!(self::header(&format!("Test 5\nZeit;a [g];v [km/h]\n{rows}")).columns[0].name, "Zeit");
        assert_eq!(self::header(&format!("Test;5;x\nt [ms];a [g];v [km/h]\n{rows}")).columns[1].name, "a");
        assert_eq!(self::header(&format!("t;a;v\n[ms];[g];[km/h]\n{rows}")).columns[1].name, "a");
        assert_eq!(self::header(&format!("Titel\nt;a;v\nms;g;km/h\n{rows}")).columns[1].name, "a");
    }

    #[test]
    fn kg_in_a_deceleration_column_is_kilo_g() {
        let text = "time, accel 1, accel 2\ntime - seconds (computed), deacceleration - kg\n0,1\n1,2\n2,3\n";
        let header = header(text);
        assert_eq!(header.columns[1].unit, Unit::Signal(QuantityKind::Acceleration, 9806.65));
        assert_eq!((header.kilo_g, header.names), (vec![1], 3));
        let header = self::header("time_s,accel_g,\n0,1,\n1,2,\n2,3,\n");
        assert_eq!((header.columns.len(), header.names), (2, 2), "a delimiter at the end is no name");
        assert_eq!(units("t_s,decel_kg\n0,1\n1,2\n")[1], Unit::Signal(QuantityKind::Acceleration, 9806.65));
        assert_eq!(units("t_s,Acc [kg]\n0,1\n1,2\n")[1], Unit::Signal(QuantityKind::Acceleration, 9806.65));
        assert_eq!(units("t_s,load [kg]\n0,1\n1,2\n")[1], Unit::Unknown("kg".to_owned()));
    }

    #[test]
    fn a_comment_may_hold_the_names_with_another_delimiter() {
        let header = header("# time(s), \t \t acceleration(g)\n0.0 1.5\n0.1 2.5\n");
        assert_eq!(header.columns[1].name, "acceleration");
        assert_eq!((&header.columns[0].unit, &header.columns[1].unit), (&Unit::Time(1.0), &G));
        // A fact is no header.
        assert!(!read(&sniff(b"# impact speed: 35 km/h\n0.0 1.5\n0.1 2.5\n", "t", 2).unwrap()).named);
    }

    #[test]
    fn the_section_is_cut_out_and_lines_keep_their_numbers() {
        let text = b"Report\nPre-Crash\nt,v\n-5,60\n-4,60\n\nLongitudinal Crash Pulse (event 1)\nTime (msec),Delta-V \
            (km/h)\n0,0\n10,-1\n\nLateral\n0,0\n";
        let part = cut(text, "longitudinal crash pulse", "a.csv").unwrap();
        assert_eq!(part, b"\n\n\n\n\n\n\nTime (msec),Delta-V (km/h)\n0,0\n10,-1\n");
        let error = cut(text, "Rollover", "a.csv").unwrap_err();
        assert_eq!(error.to_string(), "a.csv: no line holds \"Rollover\"");
    }
}
