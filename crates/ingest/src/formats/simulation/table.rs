//! Tables that `th_to_csv` of OpenRadioss makes of a T01: quoted names, then rows.
//!
//! Names may hold control characters and line feeds. There are always 15 names of globals, also where the file has 12:
//! rows are then shorter. Without T01_TITLES a name ends in `var 47`, which says nothing.

use crate::formats::simulation::history::{Kind, Member, Simulation, integral};
use crate::formats::simulation::radioss::{GLOBALS, forces_of_impulses, is_read, rename};
use crate::formats::simulation::remarks::{ForceOrImpulse, FromImpulse, RowsCut};
use crate::formats::text::lines::{Lines, decode};
use crate::recording::content::list;
use crate::{Place, Result, refuse};

/// Characters of the title of a group in front of a name.
const GROUP: usize = 100;
/// Most columns.
const COLUMN_LIMIT: usize = 1 << 14;
/// Agreement of an impulse with the change of momentum.
const AGREES: f64 = 0.2;

/// Whether a file starts so.
pub fn recognises(head: &[u8]) -> bool {
    head.starts_with(b"\"time\",\"INTERNAL ENERGY\"")
}

/// A column that is read: of which member, under which name.
type Column = Option<(usize, String)>;

/// Reads a table.
///
/// # Errors
/// Rows with more or fewer fields than names, names that say nothing, no rows.
pub fn read(file: &str, bytes: &[u8]) -> Result<Simulation> {
    let (mut names, from) = names(bytes);
    if names.len() > COLUMN_LIMIT {
        return refuse(file, format!("more than {COLUMN_LIMIT} names of columns"), "a table of th_to_csv", AGAIN);
    }
    let line = 1 + bytes[..from].iter().filter(|b| **b == b'\n').count();
    let mut lines = Lines::new(file, &bytes[from..]);
    let Some(first) = lines.peek()? else {
        return refuse(file, "names and no rows", "rows of numbers", AGAIN);
    };
    let fields = first.bytes.split(|b| *b == b',').count();
    if names.len() == fields + 3 && names.len() > GLOBALS.len() {
        // The file has no energies of contacts.
        names.drain(13..16);
    }
    if names.len() != fields {
        let found =
            format!("{} names and {fields} fields of a row: th_to_csv wrote other names than columns", names.len());
        return refuse(Place::line(file, line), found, "as many names as fields", AGAIN);
    }
    let nameless = names.iter().position(|name| is_nameless(name));
    let (columns, mut members) = columns(&names);
    let mut cut = 0;
    while let Some(line) = lines.take()? {
        let text = String::from_utf8_lossy(line.bytes);
        if text.trim().is_empty() {
            continue;
        }
        let numbers: Vec<f64> = text.split(',').map_while(|field| field.trim().parse().ok()).collect();
        if numbers.len() != fields {
            cut += 1;
            continue;
        }
        members.iter_mut().for_each(|member| member.times.push(numbers[0]));
        for (column, number) in columns.iter().zip(&numbers) {
            let Some((member, name)) = column else { continue };
            let of_member = &mut members[*member].columns;
            match of_member.iter_mut().find(|(own, _)| own == name) {
                Some((_, values)) => values.push(*number),
                None => of_member.push((name.clone(), vec![*number])),
            }
        }
    }
    if let Some(k) = nameless {
        return Err(without_names(file, k, &names[k], (&bytes[from..], &members[0])));
    }
    let states = members[0].times.len();
    members.iter_mut().for_each(rename);
    let contents = vec![format!("table of th_to_csv ({states} states)")];
    let mut simulation = Simulation { solver: "OpenRadioss".to_owned(), contents, members, ..Simulation::default() };
    if cut > 0 {
        simulation.notes.push(RowsCut { file: file.to_owned(), rows: cut });
    }
    forces(&mut simulation);
    Ok(simulation.finished())
}

const AGAIN: &str = "give the T01 file itself, with its T01_TITLES beside it: it is read as it is";

/// Names in quotes, which may go over lines, and where the rows begin.
fn names(bytes: &[u8]) -> (Vec<String>, usize) {
    let (mut names, mut at) = (Vec::new(), 0);
    while bytes.get(at) == Some(&b'"') {
        let Some(length) = bytes[at + 1..].iter().position(|b| *b == b'"') else { break };
        let name: String = decode(&bytes[at + 1..at + 1 + length]);
        names.push(name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect());
        at += length + 2;
        if bytes.get(at) != Some(&b',') {
            break;
        }
        at += 1;
    }
    let rest = bytes[at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
    (names, at + rest)
}

fn is_nameless(name: &str) -> bool {
    let mut words = name.split_whitespace().rev();
    words.next().is_some_and(|word| word.parse::<u32>().is_ok()) && words.next() == Some("var")
}

/// What each column is, and the members without states.
fn columns(names: &[String]) -> (Vec<Column>, Vec<Member>) {
    let mut members = vec![Member::new(Kind::Global, "", "")];
    let column = |(k, name): (usize, &String)| -> Column {
        let global = name.trim().to_lowercase().replace([' ', '-'], "_");
        if k > 0 && GLOBALS.contains(&global.as_str()) {
            return Some((0, global));
        }
        let group: String = name.chars().take(GROUP).collect();
        let rest: String = name.chars().skip(GROUP).collect();
        let words: Vec<&str> = rest.split_whitespace().collect();
        let [id, title @ .., variable] = words.as_slice() else { return None };
        id.parse::<u64>().ok().filter(|_| is_read(variable))?;
        let title = title.join(" ");
        let is_wall = format!("{group} {title}").to_lowercase();
        let kind = match variable.starts_with('F') {
            false => Kind::Node,
            true if is_wall.contains("wall") || is_wall.contains("barrier") => Kind::Wall,
            true => Kind::Contact,
        };
        let known = members.iter().position(|member| member.kind == kind && member.id == *id);
        let member = known.unwrap_or_else(|| {
            members.push(Member::new(kind, *id, title));
            members.len() - 1
        });
        Some((member, (*variable).to_owned()))
    };
    let columns = names.iter().enumerate().map(column).collect();
    (columns, members)
}

/// Walls of a table have forces or impulses: the change of momentum tells.
fn forces(simulation: &mut Simulation) {
    let global = simulation.of(Kind::Global).next();
    let momentum = global.and_then(|global| global.column("x_momentum")).map_or(0.0, change);
    let (mut ends, mut integrals) = (0.0, 0.0);
    for wall in simulation.of(Kind::Wall) {
        let Some(values) = wall.column("x_impulse") else { continue };
        ends += values.last().copied().unwrap_or(0.0);
        integrals += integral(&wall.times, values).last().copied().unwrap_or(0.0);
    }
    let agrees = |impulse: f64| momentum != 0.0 && (impulse.abs() / momentum.abs() - 1.0).abs() < AGREES;
    if agrees(ends) {
        let walls = forces_of_impulses(&mut simulation.members);
        simulation.notes.push(FromImpulse { walls: list(&walls) });
        return;
    }
    let is_force = agrees(integrals);
    let mut left = Vec::new();
    for member in &mut simulation.members {
        if is_force {
            member.columns.iter_mut().for_each(|(name, _)| *name = name.replace("_impulse", "_force"));
        } else if member.columns.iter().any(|(name, _)| name.ends_with("_impulse")) {
            left.push(format!("{} {}", member.kind.word(), member.id));
            member.columns.retain(|(name, _)| !name.ends_with("_impulse"));
        }
    }
    if !left.is_empty() {
        simulation.notes.push(ForceOrImpulse { walls: list(&left) });
    }
}

/// First to last value.
fn change(values: &[f64]) -> f64 {
    values.last().zip(values.first()).map_or(0.0, |(last, first)| last - first)
}

/// The refusal of names that say nothing, with the columns that are impulses by the change of momentum.
fn without_names(file: &str, k: usize, name: &str, (rows, global): (&[u8], &Member)) -> crate::IngestError {
    let words: Vec<&str> = name.split_whitespace().rev().take(2).collect();
    let momentum = global.column("X-MOMENTUM").or(global.column("x_momentum")).map_or(0.0, change);
    let last = rows.split(|b| *b == b'\n').rfind(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    let last = String::from_utf8_lossy(last);
    let near = |field: &str| {
        let value: f64 = field.trim().parse().ok()?;
        (momentum != 0.0 && (value.abs() / momentum.abs() - 1.0).abs() < 0.02).then_some(value)
    };
    let impulse = last.split(',').enumerate().skip(GLOBALS.len() + 1).find_map(|(at, field)| Some((at, near(field)?)));
    let impulse = impulse.map_or_else(String::new, |(at, value)| {
        format!("; var {at} ends at {value}, the change of momentum: an impulse, no force")
    });
    let found = format!(
        "column {} is named \"{} {}\": its table was made without T01_TITLES{impulse}",
        k + 1,
        words[1],
        words[0]
    );
    let hint = "give the T01 file itself, or write it with /TH/TITLE and convert it again beside its T01_TITLES";
    crate::IngestError::content(file, found, "names of variables such as VX and FNX", hint)
}
