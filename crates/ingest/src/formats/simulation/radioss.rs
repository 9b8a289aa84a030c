//! OpenRadioss T01: records of Fortran, big-endian, integers and floats of four bytes (kind 4 of `/TFILE`).
//!
//! A description of parts, subsets and groups, then for each state the time, the globals and the values of the groups.
//! Walls, interfaces and sections hold impulses. Sources: `hist1` of the engine, `th_to_csv`.

use crate::formats::simulation::history::{Kind, Member, Simulation, derivative};
use crate::formats::simulation::remarks::{EndMissing, FromImpulse};
use crate::formats::text::lines::decode;
use crate::recording::content::list;
use crate::recording::unit_system::Units;
use crate::{IngestError, Result};

/// Columns of the globals in their order.
pub const GLOBALS: [&str; 15] = [
    "internal_energy",
    "kinetic_energy",
    "x_momentum",
    "y_momentum",
    "z_momentum",
    "mass",
    "time_step",
    "rotation_energy",
    "external_work",
    "spring_energy",
    "contact_energy",
    "hourglass_energy",
    "elastic_contact_energy",
    "frictional_contact_energy",
    "damping_contact_energy",
];
/// Names of variables by their codes from 1: nodes; interfaces and walls.
pub const OF_NODE: [&str; 9] = ["DX", "DY", "DZ", "VX", "VY", "VZ", "AX", "AY", "AZ"];
pub const OF_WALL: [&str; 6] = ["FNX", "FNY", "FNZ", "FTX", "FTY", "FTZ"];

/// Whether a file starts with the record of a code and a title.
pub fn recognises(head: &[u8]) -> bool {
    let word = |at: usize| head.get(at..at + 4).map(|b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]));
    word(0) == Some(84) && word(88) == Some(84) && word(4).is_some_and(|code| (1000..10_000).contains(&code))
}

/// Records of Fortran.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Records<'a> {
    /// The next record; `None` where no whole one follows.
    fn next(&mut self) -> Option<&'a [u8]> {
        let length = usize::try_from(whole(self.bytes.get(self.at..)?, 0)?).ok()?;
        let start = self.at + 4;
        let end = start.checked_add(length)?;
        let record = self.bytes.get(start..end)?;
        (whole(self.bytes, end)? == whole(self.bytes, self.at)?).then_some(())?;
        self.at = end + 4;
        Some(record)
    }
}

fn whole(bytes: &[u8], at: usize) -> Option<i32> {
    bytes.get(at..at.checked_add(4)?).map(|b| i32::from_be_bytes([b[0], b[1], b[2], b[3]]))
}

fn count(record: &[u8], at: usize) -> Result<usize, String> {
    let number = whole(record, at).and_then(|number| usize::try_from(number).ok());
    number.ok_or_else(|| "a count that is none".to_owned())
}

fn floats(record: &[u8]) -> impl Iterator<Item = f64> + '_ {
    record.chunks_exact(4).map(|b| f64::from(f32::from_be_bytes([b[0], b[1], b[2], b[3]])))
}

fn title(record: &[u8], at: usize, length: usize) -> String {
    let bytes = record.get(at..record.len().min(at + length)).unwrap_or_default();
    decode(bytes).trim_matches(|c: char| c.is_whitespace() || c == '\0').to_owned()
}

/// What the numbers of a state are, and the histories they go on.
pub struct Columns {
    /// The whole model first.
    pub members: Vec<Member>,
    /// Member and column of each number; `None` for one that is not read.
    places: Vec<Option<(usize, usize)>>,
}

impl Columns {
    /// The whole model, without numbers yet.
    pub fn new() -> Self {
        Self { members: vec![Member::new(Kind::Global, "", "")], places: Vec::new() }
    }

    /// Adds a global by its name.
    pub fn add_global(&mut self, name: &str) {
        if GLOBALS.contains(&name) { self.place(0, name.to_owned()) } else { self.skip() }
    }

    /// Adds a variable of an element by its name: `VX`. Variables of one element follow each other.
    pub fn add(&mut self, kind: Kind, (id, title): (&str, &str), variable: &str) {
        let Some(name) = column_of(kind, variable) else { return self.skip() };
        if self.members.last().is_none_or(|last| (last.kind, last.id.as_str()) != (kind, id)) {
            self.members.push(Member::new(kind, id, title));
        }
        self.place(self.members.len() - 1, name);
    }

    /// Adds a number that is not read.
    pub fn skip(&mut self) {
        self.places.push(None);
    }

    fn place(&mut self, member: usize, name: String) {
        let columns = &mut self.members[member].columns;
        let column = columns.iter().position(|(own, _)| *own == name).unwrap_or(columns.len());
        if column == columns.len() {
            columns.push((name, Vec::new()));
        }
        self.places.push(Some((member, column)));
    }

    /// Adds a state. Numbers of one column are added: normal and tangential impulse of a wall.
    pub fn push(&mut self, time: f64, numbers: impl Iterator<Item = f64>) {
        for member in &mut self.members {
            member.times.push(time);
            member.columns.iter_mut().for_each(|(_, values)| values.push(0.0));
        }
        for (place, number) in self.places.iter().zip(numbers) {
            let Some((member, column)) = place else { continue };
            if let Some(sum) = self.members[*member].columns[*column].1.last_mut() {
                *sum += number;
            }
        }
    }
}

/// The column of a variable: `VX` of a node is `x_velocity`.
fn column_of(kind: Kind, variable: &str) -> Option<String> {
    let is_known = OF_NODE.contains(&variable) || OF_WALL.contains(&variable);
    let (what, axis) = variable.split_at_checked(variable.len().checked_sub(1)?).filter(|_| is_known)?;
    let what = match (what, kind) {
        ("D", Kind::Node) => "displacement",
        ("V", Kind::Node) => "velocity",
        ("A", Kind::Node) => "acceleration",
        ("FN" | "FT", Kind::Wall | Kind::Contact) => "impulse",
        _ => return None,
    };
    Some(format!("{}_{what}", axis.to_lowercase()))
}

/// The description in front of the states.
struct Header {
    title: String,
    units: Option<Units>,
    /// Numbers of the records of a state: time, globals, parts, subsets, then one a group.
    sizes: Vec<usize>,
    columns: Columns,
}

impl Header {
    /// Reads it; `names` are those of T01_TITLES, of all variables of all elements.
    fn of(records: &mut Records<'_>, mut names: impl Iterator<Item = String>) -> Result<Self, String> {
        let room = records.bytes.len() / 4;
        let mut next = |what: &str| records.next().ok_or_else(|| format!("it ends before {what}"));
        let first = next("its code")?;
        let mut length = match count(first, 0)? {
            3050.. => 100,
            3041..=3049 => 80,
            _ => 40,
        };
        next("its date")?;
        let mut record = next("its counts")?;
        let mut units = None;
        if record.len() == 4 {
            length = count(next("the length of titles")?, 0)?.min(1000);
            let [mass_kg, length_m, time_s] = floats(next("its units")?).collect::<Vec<_>>()[..] else {
                return Err("units that are not three numbers".to_owned());
            };
            let is_stated = [mass_kg, length_m, time_s].iter().all(|unit| unit.is_finite() && *unit > 0.0);
            units = is_stated.then_some(Units { length_m, time_s, mass_kg });
            record = next("its counts")?;
        }
        let counts: Vec<usize> = (0..6).map(|k| count(record, 4 * k)).collect::<Result<_, _>>()?;
        let [parts, materials, properties, subsets, groups, globals] = counts[..] else {
            return Err("counts that are not six numbers".to_owned());
        };
        if globals > 0 {
            next("the numbers of its globals")?;
        }
        let mut sizes = vec![1, globals, 0, 0];
        for _ in 0..parts {
            let variables = count(next("its parts")?, 4 + length + 12)?;
            sizes[2] += variables;
            if variables > 0 {
                next("the variables of its parts")?;
            }
        }
        for _ in 0..materials + properties {
            next("its materials")?;
        }
        for _ in 0..subsets {
            let record = next("its subsets")?;
            sizes[3] += count(record, 16)?;
            for at in [8, 12, 16] {
                if count(record, at)? > 0 {
                    next("the members of its subsets")?;
                }
            }
        }
        let mut columns = Columns::new();
        for k in 0..globals.min(room) {
            columns.add_global(GLOBALS.get(k).copied().unwrap_or_default());
        }
        for _ in 0..groups {
            let record = next("its groups")?;
            let (elements, variables) = (count(record, 12)?, count(record, 16)?);
            let (kind, table) = match count(record, 4)? {
                0 => (Kind::Node, &OF_NODE[..]),
                101 => (Kind::Contact, &OF_WALL[..]),
                102 => (Kind::Wall, &OF_WALL[..]),
                // Of others, such as springs, nothing is read.
                _ => (Kind::Part, &[][..]),
            };
            let elements: Vec<&[u8]> = (0..elements).map(|_| next("elements of groups")).collect::<Result<_, _>>()?;
            let codes = if variables > 0 { next("the variables of its groups")? } else { &[] };
            sizes.push(elements.len().saturating_mul(variables));
            let numbers = sizes[4..].iter().fold(0, |sum: usize, size| sum.saturating_add(*size));
            if codes.len() != variables.saturating_mul(4) || numbers > room {
                return Err("a group with other variables than it says, or more than it can hold".to_owned());
            }
            for element in elements {
                let (id, title) = (whole(element, 0).unwrap_or(0).to_string(), title(element, 4, length));
                for k in 0..variables {
                    let code = whole(codes, 4 * k).and_then(|code| usize::try_from(code).ok()?.checked_sub(1));
                    let of_code = || code.and_then(|code| table.get(code)).map_or("", |name| *name).to_owned();
                    columns.add(kind, (&id, &title), &names.next().unwrap_or_else(of_code));
                }
            }
        }
        Ok(Self { title: title(first, 4, 80), units, sizes, columns })
    }
}

/// Reads a T01 with the titles of its variables.
///
/// # Errors
/// A description that is not whole, no state.
pub fn read(file: &str, bytes: &[u8], titles: Option<&[u8]>) -> Result<Simulation> {
    let refused = |found: String| {
        let hint = "write it with /TFILE kind 4 (IEEE), or convert it with th_to_csv";
        IngestError::content(file, found, "a whole T01 of OpenRadioss", hint)
    };
    let mut records = Records { bytes, at: 0 };
    let titles = titles.map(decode).unwrap_or_default();
    let names = titles.lines().skip(1).step_by(2).map(|name| name.trim().to_owned());
    let Header { title, units, sizes, mut columns } = Header::of(&mut records, names).map_err(refused)?;
    let mut simulation = Simulation { solver: "OpenRadioss".to_owned(), title, units, ..Simulation::default() };
    let mut is_whole = true;
    while is_whole && records.at < bytes.len() {
        match state(&mut records, &sizes) {
            Some(state) => {
                let time = floats(state[0]).next().unwrap_or(0.0);
                columns.push(time, floats(state[1]).chain(state[4..].iter().flat_map(|group| floats(group))));
            }
            None => is_whole = false,
        }
    }
    simulation.members = columns.members;
    let times = &simulation.members[0].times;
    let (states, Some(until)) = (times.len(), times.last().copied()) else {
        return Err(refused("it has no whole state".to_owned()));
    };
    if !is_whole {
        simulation.notes.push(EndMissing { files: file.to_owned(), states, until });
    }
    simulation.contents.push(format!("T01 ({states} states)"));
    forces_of_impulses(&mut simulation);
    Ok(simulation.finished())
}

/// The records of the next state; `None` where it is not whole.
fn state<'a>(records: &mut Records<'a>, sizes: &[usize]) -> Option<Vec<&'a [u8]>> {
    let mut record = |numbers: &usize| match numbers {
        0 => Some(&[][..]),
        numbers => records.next().filter(|record| Some(record.len()) == numbers.checked_mul(4)),
    };
    sizes.iter().map(&mut record).collect()
}

/// Adds the forces to walls and contacts with impulses, and says so.
pub fn forces_of_impulses(simulation: &mut Simulation) {
    let mut walls = Vec::new();
    for member in &mut simulation.members {
        let derived = |(name, values): &(String, Vec<f64>)| {
            let axis = name.strip_suffix("_impulse")?;
            Some((format!("{axis}_force"), derivative(&member.times, values)))
        };
        let forces: Vec<_> = member.columns.iter().filter_map(derived).collect();
        if !forces.is_empty() {
            walls.push(format!("{} {}", member.kind.word(), member.id));
            member.columns.extend(forces);
        }
    }
    if !walls.is_empty() {
        simulation.notes.push(FromImpulse { walls: list(&walls) });
    }
}
