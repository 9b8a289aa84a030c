//! Tables that `th_to_csv` of OpenRadioss makes of a T01: quoted names, then rows.
//!
//! Names may hold control characters and line feeds. There are always 15 names of globals, also where the file has 12:
//! rows are then shorter. Without T01_TITLES a name ends in `var 47`: what it is, place and values tell, or nothing.

use crate::formats::simulation::ascii::number;
use crate::formats::simulation::channels::AXES;
use crate::formats::simulation::history::{Kind, Member, Simulation, integral};
use crate::formats::simulation::radioss::{Columns, GLOBALS, OF_NODE, OF_WALL, forces_of_impulses};
use crate::formats::simulation::remarks::{ForceOrImpulse, NamedByPlace, RowsCut};
use crate::formats::text::lines::{Lines, decode};
use crate::recording::content::list;
use crate::{Place, Result, refuse};

/// Characters of the title of a group in front of a name.
const GROUP: usize = 100;
/// Most columns.
const COLUMN_LIMIT: usize = 1 << 14;
/// Displacement off the integral of the velocity, as a part of the largest. Trapezoids of states every 1 ms miss 0.1 %.
const MOTION: f64 = 0.02;
/// Agreement of an impulse with the change of momentum.
const AGREES: f64 = 0.2;

/// Whether a file starts with the names of globals, which th_to_csv always writes.
pub fn recognises(head: &[u8]) -> bool {
    head.starts_with(b"\"time\",\"INTERNAL ENERGY\",\"KINETIC ENERGY\"")
}

/// Reads a table.
///
/// # Errors
/// Rows with more or fewer fields than names, columns that neither names nor values tell, no rows.
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
    if names.len() == fields + 3 && fields > 13 {
        // The file has no energies of contacts.
        names.drain(13..16);
    }
    if names.len() != fields {
        let found =
            format!("{} names and {fields} fields of a row: th_to_csv wrote other names than columns", names.len());
        return refuse(Place::line(file, line), found, "as many names as fields", AGAIN);
    }
    let nameless: Vec<usize> = (0..names.len()).filter(|k| stem(&names[*k]).is_some()).collect();
    let ends = nameless.first().zip(nameless.last()).map(|(first, last)| (*first, *last));
    let is_named = name_by_place(&mut names);
    let mut columns = columns(&names);
    let mut cut = 0;
    while let Some(line) = lines.take()? {
        let text = String::from_utf8_lossy(line.bytes);
        let numbers: Vec<f64> = text.split(',').map_while(|field| number(field.trim())).collect();
        match numbers.as_slice() {
            [time, numbers @ ..] if numbers.len() + 1 == fields => columns.push(*time, numbers.iter().copied()),
            _ => cut += usize::from(!text.trim().is_empty()),
        }
    }
    let Columns { members, .. } = columns;
    let contents = vec![format!("table of th_to_csv ({} states)", members[0].times.len())];
    let mut simulation = Simulation { solver: "OpenRadioss".to_owned(), contents, members, ..Simulation::default() };
    if cut > 0 {
        simulation.notes.push(RowsCut { file: file.to_owned(), rows: cut });
    }
    if let Some((first, last)) = ends {
        if !is_named || !is_motion(&simulation) {
            let found = format!(
                "columns {} to {} are \"var {first}\" to \"var {last}\": it was made without T01_TITLES, and their \
                 number or their values do not tell what they are",
                first + 1,
                last + 1
            );
            return refuse(file, found, "names of variables such as VX and FNX", AGAIN);
        }
        simulation.notes.push(NamedByPlace { first: first + 1, last: last + 1 });
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

/// What stands in front of `var 47`, where a name ends so.
fn stem(name: &str) -> Option<&str> {
    let numberless = name.trim_end().trim_end_matches(|c: char| c.is_ascii_digit());
    let stem = numberless.trim_end().strip_suffix("var").filter(|stem| stem.ends_with(char::is_whitespace))?;
    (numberless.len() < name.trim_end().len()).then_some(stem)
}

/// Names the variables of elements that have all of a node, or all of a wall, in the order of their codes. `false`: an
/// element has another number of them.
fn name_by_place(names: &mut [String]) -> bool {
    let groups = names.chunk_by_mut(|a, b| stem(a).is_some() && stem(a) == stem(b));
    let mut nameless = groups.filter(|group| stem(&group[0]).is_some());
    nameless.all(|group| {
        let of_all: [&[&str]; 2] = [&OF_NODE, &OF_WALL];
        let Some(own) = of_all.into_iter().find(|own| own.len() == group.len()) else { return false };
        for (name, own) in group.iter_mut().zip(own) {
            *name = format!("{}{own}", stem(name).unwrap_or_default());
        }
        true
    })
}

/// Whether the displacement of every node is the integral of its velocity, and one of them moves.
fn is_motion(simulation: &Simulation) -> bool {
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut moves = false;
    let is_one = |(node, axis): (&Member, &str)| {
        let column = |what: &str| node.column(&format!("{axis}_{what}"));
        let Some((way, velocity)) = column("displacement").zip(column("velocity")) else { return false };
        let of_velocity = integral(&node.times, velocity);
        let off = largest(&mut way.iter().zip(&of_velocity).map(|(x, y)| x - way[0] - y));
        let most = largest(&mut way.iter().map(|x| x - way[0]));
        moves |= most > 0.0;
        off <= MOTION * most
    };
    simulation.of(Kind::Node).flat_map(|node| AXES.map(|axis| (node, axis))).all(is_one) && moves
}

/// What each column behind the time is.
fn columns(names: &[String]) -> Columns {
    let mut columns = Columns::new();
    for name in names.iter().skip(1) {
        let global = name.trim().to_lowercase().replace([' ', '-'], "_");
        if GLOBALS.contains(&global.as_str()) {
            columns.add_global(&global);
            continue;
        }
        let rest: String = name.chars().skip(GROUP).collect();
        let words: Vec<&str> = rest.split_whitespace().collect();
        let [id, title @ .., variable] = words.as_slice() else {
            columns.skip();
            continue;
        };
        let name = name.to_lowercase();
        let kind = match variable.starts_with('F') {
            false => Kind::Node,
            true if name.contains("wall") || name.contains("barrier") => Kind::Wall,
            true => Kind::Contact,
        };
        columns.add(kind, (id, &title.join(" ")), variable);
    }
    columns
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
        forces_of_impulses(simulation);
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
