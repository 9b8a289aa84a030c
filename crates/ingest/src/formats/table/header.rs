//! Column names and units from the header lines of a table.

use crumple_signal::unit::{self, Dimension};
use crumple_signal::{Axis, QuantityKind};

use crate::formats::iso13499;
use crate::formats::table::layout::{Delimiter, Layout};
use crate::formats::text::lines::{Line, decode};
use crate::formats::text::numbers::unquoted;

/// What a column is said to hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// The name in the header without its unit in brackets; `column 3` where there is none.
    pub name: String,
    /// The name in the header, whole.
    pub title: String,
    /// The stated unit.
    pub unit: Unit,
}

/// A stated unit.
#[derive(Debug, Clone, PartialEq)]
pub enum Unit {
    /// None is stated.
    Unstated,
    /// Of time, with its factor to s.
    Time(f64),
    /// Of a measured quantity, with its factor to SI.
    Signal(QuantityKind, f64),
    /// Something in brackets that is no unit known here.
    Unknown(String),
}

/// What the header lines say.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// One for each column of numbers.
    pub columns: Vec<Column>,
    /// Names are given at all.
    pub named: bool,
    /// More names than columns: how many there are.
    pub surplus_names: Option<usize>,
    /// `kg` was read as kilo-g in these columns.
    pub kilo_g: Vec<usize>,
    /// Header lines that are neither names nor units.
    pub ignored_lines: Vec<usize>,
}

/// Reads names and units from the lines before the rows.
pub fn read(layout: &Layout) -> Header {
    let count = layout.columns;
    let mut lines: Vec<(usize, Vec<String>)> =
        layout.header.iter().map(|line| (line.number, cells(line, layout.delimiter, count))).collect();
    if lines.is_empty()
        && let Some(comment) = layout.comments.last()
    {
        // Many programs write the names as the last comment.
        let names = cells(comment, layout.delimiter, count);
        if names.len() >= count && names.iter().any(|name| is_time_name(name)) && comment.number < layout.first_line {
            lines.push((comment.number, names));
        }
    }
    let has_units = match lines.as_slice() {
        [.., (_, above), (_, last)] => is_unit_line(last) && !is_header_below_a_title(last, above, count),
        _ => false,
    };
    let units = has_units.then(|| lines.pop()).flatten();
    let names = lines.pop();
    let named = names.is_some();
    let names = names.map(|(_, cells)| cells).unwrap_or_default();
    // A delimiter at the end of every line is no column.
    let stated = names.iter().rposition(|name| !name.trim().is_empty()).map_or(0, |last| last + 1);
    let surplus_names = (stated > count).then_some(stated);
    let mut kilo_g = Vec::new();
    let columns = (0..count)
        .map(|k| {
            let title =
                names.get(k).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("column {}", k + 1));
            let (name, mut unit) = split_unit(&title);
            if let Some(cell) = units.as_ref().and_then(|(_, cells)| cells.get(k)) {
                let stated = unit_cell(cell, &title);
                if !matches!(stated, Unit::Unstated) {
                    unit = stated;
                }
            }
            let about = format!("{title} {}", units.as_ref().and_then(|(_, c)| c.get(k)).map_or("", String::as_str));
            if matches!(&unit, Unit::Unknown(symbol) if is_kg(symbol)) && names_acceleration(&about) {
                kilo_g.push(k);
                unit = signal("kilo-g");
            }
            Column { name, title, unit }
        })
        .collect();
    Header { columns, named, surplus_names, kilo_g, ignored_lines: lines.iter().map(|(number, _)| *number).collect() }
}

/// The cells of a header line. Its delimiter may differ from that of the rows (`# time(s), <tab> acceleration(g)` over
/// blanks): then the one that gives as many cells as there are columns is taken.
fn cells(line: &Line, delimiter: Delimiter, count: usize) -> Vec<String> {
    let clean = |fields: Vec<&[u8]>| -> Vec<String> { fields.into_iter().map(|f| decode(unquoted(f))).collect() };
    let own = clean(delimiter.split(line.bytes));
    if own.len() >= 2 && delimiter != Delimiter::Blanks {
        return own;
    }
    [b',', b';', b'\t']
        .into_iter()
        .map(|byte| clean(Delimiter::Byte(byte).split(line.bytes)).into_iter().filter(|c| !c.is_empty()).collect())
        .find(|cells: &Vec<String>| cells.len() == count)
        .unwrap_or(own)
}

/// Whether the last line before the rows has the names, and the line above it is a title: as many cells as there are columns, each
/// with a name and a unit or one of them named for time, and no such names above.
fn is_header_below_a_title(last: &[String], above: &[String], count: usize) -> bool {
    let filled = last.iter().rposition(|cell| !cell.is_empty()).map_or(0, |end| end + 1);
    let above_is_names = above.len() >= count && above.iter().any(|cell| is_time_name(cell));
    let has_both = |cell: &String| {
        let (name, unit) = split_unit(cell);
        name != *cell && matches!(unit, Unit::Time(_) | Unit::Signal(..))
    };
    filled == count && !above_is_names && (last.iter().all(has_both) || last.iter().any(|cell| is_time_name(cell)))
}

/// A line under the names is one of units if some cell is a unit and no cell is a bare name.
fn is_unit_line(cells: &[String]) -> bool {
    let kinds: Vec<Unit> = cells.iter().map(|cell| unit_cell(cell, "")).collect();
    kinds.iter().any(|unit| matches!(unit, Unit::Time(_) | Unit::Signal(..)))
        && cells.iter().zip(&kinds).all(|(cell, unit)| {
            !matches!(unit, Unit::Unstated) || matches!(cell.as_str(), "" | "-" | "1") || !is_time_name(cell)
        })
}

/// A cell of the units line: `g`, `[m/s^2]`, `time - seconds (computed after test)`.
fn unit_cell(cell: &str, title: &str) -> Unit {
    let cell = cell.trim();
    let whole = symbol(unit::without_brackets(cell), title);
    if !matches!(whole, Unit::Unstated | Unit::Unknown(_)) {
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

/// `Acceleration [m/s^2]`, `a (g)`, `acceleration(g)`, `time_s`, `accel_m_per_s2`, `Beschleunigung in g`: the name
/// without the bracket, and the unit.
pub fn split_unit(title: &str) -> (String, Unit) {
    let title = title.trim();
    if let Some(start) = unit::opening_bracket(title) {
        let unit = symbol(&title[start + 1..title.len() - 1], title);
        // `Acc in m/(s*s)`: the bracket belongs to the unit.
        let within = title[..start].ends_with('/').then(|| unbracketed(title));
        if let Some(found @ (_, Unit::Time(_) | Unit::Signal(..))) = within {
            return found;
        }
        let name = title[..start].trim();
        let name = if name.is_empty() { title } else { name };
        return (name.trim_end_matches([',', '_', '-', '/']).trim().to_owned(), unit);
    }
    unbracketed(title)
}

/// The name and the unit of a title that does not end in a unit in brackets.
fn unbracketed(title: &str) -> (String, Unit) {
    for separator in [" in ", " / ", " - ", ", "] {
        if let Some((name, rest)) = title.rsplit_once(separator) {
            let unit = symbol(rest, title);
            if !matches!(unit, Unit::Unstated | Unit::Unknown(_)) {
                return (name.trim().to_owned(), unit);
            }
        }
    }
    // `accel_m_per_s2` before `accel_m_per` + `s2`: the longest suffix that is a unit.
    for (at, _) in title.match_indices('_') {
        let suffix = &title[at + 1..];
        let spelled = suffix.replace("_per_", "/").replace("per_", "/").replace("_s2", "/s2");
        let unit = symbol(&spelled, title);
        if at > 0 && !matches!(unit, Unit::Unstated | Unit::Unknown(_)) {
            return (title.to_owned(), unit);
        }
        if at > 0 && is_kg(suffix) && names_acceleration(title) {
            return (title.to_owned(), Unit::Unknown(suffix.to_owned()));
        }
    }
    // `Time s`, `accel g`: the last word, if the words before name the same kind of thing.
    if let Some((name, last)) = title.rsplit_once(' ') {
        let unit = symbol(last, title);
        let fits = match unit {
            Unit::Time(_) => is_time_name(name),
            Unit::Signal(QuantityKind::Acceleration, _) => names_acceleration(name),
            _ => false,
        };
        if fits {
            return (name.trim().to_owned(), unit);
        }
    }
    (title.to_owned(), Unit::Unstated)
}

/// A unit by its symbol. In a column named for time, `m` and `s` are not lengths.
fn symbol(text: &str, title: &str) -> Unit {
    let text = text.trim();
    if text.is_empty() {
        return Unit::Unstated;
    }
    if let Some(factor) = unit::factor(text, Dimension::Time) {
        return Unit::Time(factor);
    }
    if is_kg(text) && names_acceleration(title) {
        return Unit::Unknown(text.to_owned());
    }
    match unit::signal_unit(text) {
        Some((kind, factor)) => Unit::Signal(kind, factor),
        None => Unit::Unknown(text.to_owned()),
    }
}

fn signal(text: &str) -> Unit {
    unit::signal_unit(text).map_or(Unit::Unstated, |(kind, factor)| Unit::Signal(kind, factor))
}

fn is_kg(text: &str) -> bool {
    text.trim().eq_ignore_ascii_case("kg")
}

/// Whether words speak of acceleration: `accel_g`, `Deceleration`, `deacceleration`, `Beschleunigung`, `Verzögerung`, `a`, or a
/// channel code.
pub fn names_acceleration(text: &str) -> bool {
    let lower = text.to_lowercase();
    ["acc", "decel", "beschl", "verzög", "verzoeg"].iter().any(|part| lower.contains(part))
        || {
            let mut words = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
            matches!(words.next(), Some("a" | "ax" | "ay" | "az"))
        }
        || iso13499::is_acceleration(text)
}

/// Whether a header cell names time: `time_s`, `Zeit`, `temps`, `t`, `t [ms]`, `t(s)`.
pub fn is_time_name(text: &str) -> bool {
    let lower = text.trim().to_lowercase();
    ["time", "zeit", "temps", "tempo", "tiempo"].iter().any(|word| lower.starts_with(word))
        || lower == "t"
        || lower
            .strip_prefix('t')
            .is_some_and(|rest| rest.trim_start().starts_with(['[', '(', '/', '{']) || rest.starts_with('_'))
}

/// The axis a name speaks of: `ax`, `accel_x`, `Acc X (g)`, `accX`.
pub fn axis(name: &str) -> Option<Axis> {
    let of = |word: &str| match word {
        "x" | "ax" | "accx" | "accelx" | "xg" | "longitudinal" => Some(Axis::X),
        "y" | "ay" | "accy" | "accely" | "yg" | "lateral" => Some(Axis::Y),
        "z" | "az" | "accz" | "accelz" | "zg" | "vertical" => Some(Axis::Z),
        "resultant" | "res" => Some(Axis::Resultant),
        _ => None,
    };
    name.to_lowercase().split(|c: char| !c.is_alphanumeric()).find_map(of)
}

/// The channel frequency class a name speaks of: `accel_cfc60`, `CFC 180`.
pub fn cfc(name: &str) -> Option<u16> {
    let lower = name.to_lowercase();
    let digits: String = lower
        .split_once("cfc")?
        .1
        .trim_start_matches([' ', '_', '-'])
        .chars()
        .take_while(char::is_ascii_digit)
        .collect();
    digits.parse().ok().filter(|class| matches!(class, 60 | 180 | 600 | 1000))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::table::layout::sniff;

    const G: Unit = Unit::Signal(QuantityKind::Acceleration, 9.806_65);

    fn header(text: &str) -> Header {
        read(&sniff(text.as_bytes(), "t.csv", 2).unwrap())
    }

    fn units(text: &str) -> Vec<Unit> {
        header(text).columns.into_iter().map(|c| c.unit).collect()
    }

    #[test]
    fn units_stand_in_brackets_suffixes_and_words() {
        let metre = Unit::Signal(QuantityKind::Acceleration, 1.0);
        let metre_again = metre.clone();
        for (name, unit) in [
            ("accel_g", G),
            ("a (g)", G),
            ("acceleration(g)", G),
            ("Beschleunigung in g", G),
            ("Accel - g", G),
            ("acc g", G),
            ("Acceleration [m/s^2]", metre.clone()),
            ("accel_m_per_s2", metre.clone()),
            ("accel_m_s2", metre),
            ("speed_km_per_h", Unit::Signal(QuantityKind::Velocity, 1.0 / 3.6)),
            ("time_s", Unit::Time(1.0)),
            ("t [ms]", Unit::Time(1e-3)),
            ("Time ms", Unit::Time(1e-3)),
            ("Acc (m/(s*s))", metre_again.clone()),
            ("Acc [m/(s^2)]", metre_again.clone()),
            ("Acc in m/(s*s)", metre_again.clone()),
            ("Acc m/(s*s)", metre_again),
            ("accel", Unit::Unstated),
            ("x [furlong]", Unit::Unknown("furlong".to_owned())),
        ] {
            assert_eq!(split_unit(name).1, unit, "{name}");
        }
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
        assert_eq!((header.kilo_g, header.surplus_names), (vec![1], Some(3)));
        let header = self::header("time_s,accel_g,\n0,1,\n1,2,\n2,3,\n");
        assert_eq!((header.columns.len(), header.surplus_names), (2, None), "a delimiter at the end is no name");
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
    fn words_tell_axis_class_and_kind() {
        assert_eq!(axis("accel_x_g"), Some(Axis::X));
        assert_eq!(axis("ay (g)"), Some(Axis::Y));
        assert_eq!(axis("accel_g"), None);
        assert_eq!(cfc("accel_cfc60_g"), Some(60));
        assert_eq!(cfc("accel CFC 61"), None);
        assert!(names_acceleration("deacceleration") && names_acceleration("a [g]") && !names_acceleration("force"));
        assert!(
            is_time_name("t(s)")
                && is_time_name("Zeit [ms]")
                && !is_time_name("trunk_g")
                && !is_time_name("temperature")
        );
    }
}
