//! Texts of LS-DYNA: nodout, rwforc, rcforc and glstat, with five digits a number.
//!
//! Columns are fixed and numbers may touch; Fortran writes `1.2345-100`. Blocks of rotations and of segments are passed
//! over. Source: LSTC's converter of binout to text.

use std::collections::BTreeMap;

use crate::formats::simulation::history::{Kind, Member, Simulation};
use crate::formats::simulation::remarks::RowsCut;
use crate::formats::text::lines::{Lines, decode};
use crate::{Result, refuse};

/// A text that is read, by what stands in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Text {
    Nodout,
    Rwforc,
    Rcforc,
    Glstat,
}

impl Text {
    /// Which one starts so.
    pub fn of(head: &[u8]) -> Option<Self> {
        let head = &head[..head.len().min(HEAD)];
        let has = |words: &[u8]| head.windows(words.len()).any(|window| window == words);
        let is_contact = |line: &[u8]| {
            let line = String::from_utf8_lossy(line);
            let words: Vec<&str> = line.split_whitespace().collect();
            matches!(words.as_slice(), ["slave" | "master" | "surfa" | "surfb", _, "time", ..])
        };
        if has(b"n o d a l   p r i n t   o u t") {
            Some(Self::Nodout)
        } else if has(b"dt of cycle ") && has(b"....") {
            Some(Self::Glstat)
        } else if has(b"wall#") && has(b"normal-force") {
            Some(Self::Rwforc)
        } else {
            head.split(|b| *b == b'\n').take(4000).any(is_contact).then_some(Self::Rcforc)
        }
    }

    /// Its usual name.
    pub const NAMES: [&'static str; 4] = ["nodout", "rwforc", "rcforc", "glstat"];
}

/// Bytes in which a text shows what it is: a legend may stand in front.
const HEAD: usize = 1 << 22;

/// Title, then `ls-dyna` far from the margin with the date, as all its texts begin.
pub fn is_of_ls_dyna(bytes: &[u8]) -> bool {
    let is_version = |line: &[u8]| {
        let line = String::from_utf8_lossy(line).to_ascii_lowercase();
        line.starts_with("     ") && line.trim_start().starts_with("ls-dyna") && line.contains("date")
    };
    bytes.split(|b| *b == b'\n').take(4).any(is_version)
}

/// Whether it may be one that is read: by its first lines, or it has a legend that hides them.
pub fn recognises(head: &[u8]) -> bool {
    Text::of(head).is_some() || (is_of_ls_dyna(head) && head.windows(14).any(|window| window == b"{BEGIN LEGEND}"))
}

/// Columns of nodout from the tenth character on.
const NODE: [&str; 9] = [
    "x_displacement",
    "y_displacement",
    "z_displacement",
    "x_velocity",
    "y_velocity",
    "z_velocity",
    "x_acceleration",
    "y_acceleration",
    "z_acceleration",
];
const FORCES: [&str; 4] = ["normal_force", "x_force", "y_force", "z_force"];

/// Most lines of a state of glstat.
const ENERGY_LIMIT: usize = 200;

/// Members by kind and id while a text is read.
#[derive(Default)]
struct Members {
    titles: BTreeMap<String, String>,
    found: BTreeMap<(Kind, u64, String), Member>,
    cut: usize,
}

impl Members {
    fn push(&mut self, kind: Kind, id: &str, time: f64, names: &[&str], values: &[f64]) {
        let number = id.split('.').next().and_then(|id| id.parse().ok()).unwrap_or(0);
        let title = self.titles.get(id.split('.').next().unwrap_or_default());
        let member = self.found.entry((kind, number, id.to_owned()));
        let member = member.or_insert_with(|| Member::new(kind, id, title.cloned().unwrap_or_default()));
        member.push(time, names.iter().copied().zip(values.iter().copied()));
    }
}

/// Reads the texts of one simulation.
///
/// # Errors
/// A text in which nothing is found.
pub fn read(files: &[(&str, &[u8])]) -> Result<Simulation> {
    let mut simulation = Simulation::default();
    for (name, bytes) in files {
        let Some(text) = Text::of(bytes) else { continue };
        let mut members = Members::default();
        let mut lines = Lines::new(name, bytes);
        head(&mut lines, &mut members, &mut simulation)?;
        match text {
            Text::Nodout => nodout(&mut lines, &mut members)?,
            Text::Rwforc => rwforc(&mut lines, &mut members)?,
            Text::Rcforc => rcforc(&mut lines, &mut members)?,
            Text::Glstat => glstat(&mut lines, &mut members)?,
        }
        if members.cut > 0 {
            simulation.notes.push(RowsCut { file: (*name).to_owned(), rows: members.cut });
        }
        let states = members.found.values().map(|member| member.times.len()).max().unwrap_or(0);
        simulation.contents.push(format!("{name} ({states} states)"));
        simulation.members.extend(members.found.into_values());
    }
    if simulation.members.is_empty() {
        let (name, _) = files.first().copied().unwrap_or_default();
        let hint = "give nodout, or the folder of the simulation";
        return refuse(
            name,
            "an output text of LS-DYNA without a state that is read",
            "nodout, rwforc, rcforc or glstat",
            hint,
        );
    }
    Ok(simulation.finished())
}

/// Title, version and legend.
fn head(lines: &mut Lines<'_>, members: &mut Members, simulation: &mut Simulation) -> Result<()> {
    let title = lines.take()?.map(|line| decode(line.bytes).trim().to_owned()).unwrap_or_default();
    let version = lines.take()?.map(|line| decode(line.bytes)).unwrap_or_default();
    if simulation.title.is_empty() {
        simulation.title = title;
        let words: Vec<&str> = version.split_whitespace().take_while(|word| *word != "date").skip(1).collect();
        simulation.solver = format!("LS-DYNA {}", words.join(" "));
    }
    while let Some(line) = lines.peek()? {
        let text = decode(line.bytes);
        let text = text.trim();
        if text == "{END LEGEND}" {
            lines.take()?;
            return Ok(());
        }
        if !(text.is_empty() || text.starts_with("{BEGIN") || text.starts_with("Entity") || is_legend(text)) {
            return Ok(());
        }
        if let Some((id, title)) = text.split_once(char::is_whitespace).filter(|_| is_legend(text)) {
            members.titles.insert(id.to_owned(), title.trim().to_owned());
        }
        lines.take()?;
    }
    Ok(())
}

fn is_legend(text: &str) -> bool {
    text.split_whitespace().next().is_some_and(|word| word.bytes().all(|b| b.is_ascii_digit()))
        && text.split_whitespace().nth(1).is_some_and(|word| number(word).is_none_or(f64::is_nan))
}

fn nodout(lines: &mut Lines<'_>, members: &mut Members) -> Result<()> {
    // Rows without a time or names in front are left out, as those that are not whole.
    let (mut time, mut is_motion, mut is_rotation) = (None, false, false);
    while let Some(line) = lines.take()? {
        let text = String::from_utf8_lossy(line.bytes);
        if let Some((_, at)) = text.split_once("( at time") {
            let at = number(at.trim_end().trim_end_matches(')').trim()).filter(|at| at.is_finite());
            (time, is_motion, is_rotation) = (at, false, false);
        } else if text.contains("x-disp") {
            (is_motion, is_rotation) = (true, false);
        } else if text.contains("x-rot") {
            (is_motion, is_rotation) = (false, true);
        } else if !is_rotation && !text.trim().is_empty() {
            // Twelve numbers of 12 characters, the first of 13; what is in front is the id.
            let text = text.trim_end();
            let row = text.len().checked_sub(13 + 11 * 12).filter(|at| text.is_ascii() && *at > 0).and_then(|at| {
                let field = |k: usize| {
                    let from = if k == 0 { at } else { at + 1 + 12 * k };
                    number(text[from..at + 13 + 12 * k].trim())
                };
                let values: Option<Vec<f64>> = (0..9).map(field).collect();
                let id = text[..at].trim();
                Some((id, values?)).filter(|_| !id.is_empty() && id.bytes().all(|b| b.is_ascii_digit()))
            });
            match (row, time.filter(|_| is_motion)) {
                (Some((id, values)), Some(time)) => members.push(Kind::Node, id, time, &NODE, &values),
                (None, None) => {}
                _ => members.cut += 1,
            }
        }
    }
    Ok(())
}

fn rwforc(lines: &mut Lines<'_>, members: &mut Members) -> Result<()> {
    let mut is_walls = false;
    while let Some(line) = lines.take()? {
        let text = String::from_utf8_lossy(line.bytes);
        if text.contains("wall#") {
            is_walls = true;
            continue;
        }
        let words: Vec<&str> = text.split_whitespace().collect();
        let numbers: Option<Vec<f64>> = words.iter().map(|word| number(word)).collect();
        match (words.as_slice(), numbers) {
            ([_, wall, _, _, _, _], Some(values)) if is_walls && wall.bytes().all(|b| b.is_ascii_digit()) => {
                members.push(Kind::Wall, wall, values[0], &FORCES, &values[2..]);
            }
            // Stars that touch.
            (_, Some(_)) if is_walls && text.contains('*') => members.cut += 1,
            ([], _) | (_, Some(_)) => {}
            _ => is_walls = is_walls && !text.contains("transducer"),
        }
    }
    Ok(())
}

fn rcforc(lines: &mut Lines<'_>, members: &mut Members) -> Result<()> {
    while let Some(line) = lines.take()? {
        let text = String::from_utf8_lossy(line.bytes);
        let words: Vec<&str> = text.split_whitespace().collect();
        let [side, id, "time", ..] = words.as_slice() else { continue };
        let behind = |label: &str| words.iter().position(|word| *word == label).and_then(|k| number(words.get(k + 1)?));
        let values: Option<Vec<f64>> = ["time", "x", "y", "z"].into_iter().map(behind).collect();
        match values {
            Some(values) => {
                members.push(Kind::Contact, &format!("{id}.{side}"), values[0], &FORCES[1..], &values[1..]);
            }
            None => members.cut += 1,
        }
    }
    Ok(())
}

fn glstat(lines: &mut Lines<'_>, members: &mut Members) -> Result<()> {
    let mut state: Vec<(String, f64)> = Vec::new();
    let flush = |state: &mut Vec<(String, f64)>, members: &mut Members| {
        let row = std::mem::take(state);
        let Some((_, time)) = row.iter().find(|(name, _)| name == "time") else { return };
        let (names, values): (Vec<&str>, Vec<f64>) =
            row.iter().filter(|(name, _)| name != "time").map(|(name, value)| (name.as_str(), *value)).unzip();
        members.push(Kind::Global, "", *time, &names, &values);
    };
    while let Some(line) = lines.take()? {
        let text = String::from_utf8_lossy(line.bytes);
        if text.contains("dt of cycle") {
            flush(&mut state, members);
        } else if let Some((name, value)) = text.split_once("..") {
            let name = name.trim().replace(' ', "_");
            let value = value.trim_start_matches('.').split_whitespace().next().and_then(number);
            let name = if name.starts_with("total_energy_/") { "energy_ratio".to_owned() } else { name };
            let has_room = state.len() < ENERGY_LIMIT;
            match (value, state.iter_mut().find(|(own, _)| *own == name)) {
                _ if name.contains('(') => {}
                // One line a wall.
                (Some(value), Some((_, sum))) => *sum += value,
                (Some(value), None) if has_room => state.push((name, value)),
                (Some(_), None) => {}
                (None, _) => members.cut += 1,
            }
        }
    }
    flush(&mut state, members);
    Ok(())
}

/// A number as Fortran prints it: `1.2345-100` has no letter in front of its exponent; NaN where it is none, as NaN,
/// Infinity and the stars of a field that is too narrow.
pub fn number(text: &str) -> Option<f64> {
    let is_stars = !text.is_empty() && text.bytes().all(|b| b == b'*');
    let word = text.trim_start_matches(['+', '-']);
    if is_stars || ["nan", "inf", "infinity"].iter().any(|own| word.eq_ignore_ascii_case(own)) {
        return Some(f64::NAN);
    }
    if !text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b'E' | b'e' | b'D' | b'd')) {
        return None;
    }
    let text = text.replace(['D', 'd'], "E");
    text.parse().ok().or_else(|| {
        let sign = text.rfind(['+', '-']).filter(|at| *at > 0)?;
        format!("{}E{}", &text[..sign], &text[sign..]).parse().ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_fortran() {
        assert_eq!(number("1.5-100"), Some(1.5e-100));
        assert_eq!(number("-1.5D+02"), Some(-150.0));
        assert_eq!(number("-0.0000E+00"), Some(0.0));
        assert_eq!(number("1.0+100"), Some(1e100));
        assert_eq!((number("nano"), number(""), number("1-2-3")), (None, None, None));
        for none in ["NaN", "-Infinity", "+Inf", "************"] {
            assert!(number(none).unwrap().is_nan(), "{none}");
        }
    }

    #[test]
    fn numbers_that_touch_and_long_ids_are_parted_and_rotations_passed_over() {
        let row = |id: &str, x: f64| {
            let numbers: String = (0..11).map(|_| "-1.2345E+02".to_owned()).map(|n| format!("{n:>12}")).collect();
            format!("{id:>9}{:>13}{}\n", format!("{x:.4}E+00"), numbers.replace(' ', "-").replace("--", " -"))
        };
        let at = |time: &str| {
            format!("\n n o d a l   p r i n t   o u t   f o r   t i m e  s t e p  1   ( at time {time} )\n\n")
        };
        let block = |x| format!(" nodal point  x-disp\n{}{}", row("1", x), row("1234567890", x));
        let turned = " nodal point  x-rot\n        1   0.0000E+00\n";
        let text = format!(
            " t\n      ls-dyna R12 date 1/1/26\n{}{}{}{turned}{}{}",
            at("0.0"),
            block(1.0),
            at("0.0"),
            at("1.0E-3"),
            block(2.0)
        );
        let simulation = read(&[("nodout", text.as_bytes())]).unwrap();
        let ids: Vec<&str> = simulation.members.iter().map(|member| member.id.as_str()).collect();
        assert_eq!(ids, ["1", "1234567890"]);
        for member in &simulation.members {
            assert_eq!(member.times, [0.0, 1e-3]);
            assert_eq!(member.column("x_displacement").unwrap(), [1.0, 2.0]);
            assert_eq!(member.column("x_velocity").unwrap(), [-123.45, -123.45]);
        }
    }
}
