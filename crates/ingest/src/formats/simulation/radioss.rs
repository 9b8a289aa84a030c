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
const OF_NODE: [&str; 9] = ["DX", "DY", "DZ", "VX", "VY", "VZ", "AX", "AY", "AZ"];
const OF_WALL: [&str; 6] = ["FNX", "FNY", "FNZ", "FTX", "FTY", "FTZ"];
/// Types of groups.
const NODES: usize = 0;
const INTERFACES: usize = 101;
const WALLS: usize = 102;

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

/// Elements of a group, each with the same variables.
struct Group {
    kind: Option<Kind>,
    /// Ids and titles.
    elements: Vec<(i32, String)>,
    variables: usize,
    /// Codes of the variables.
    codes: Vec<i32>,
}

/// The description in front of the states.
struct Header {
    title: String,
    units: Option<Units>,
    globals: usize,
    /// Numbers of a state of all parts, of all subsets.
    of_parts: usize,
    of_subsets: usize,
    groups: Vec<Group>,
}

impl Header {
    fn of(records: &mut Records<'_>) -> Result<Self, String> {
        let room = records.bytes.len() / 4;
        let mut next = |what: &str| records.next().ok_or_else(|| format!("it ends before {what}"));
        let first = next("its code")?;
        let code = count(first, 0)?;
        let mut length = match code {
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
        let (mut of_parts, mut of_subsets) = (0, 0);
        for _ in 0..parts {
            let variables = count(next("its parts")?, 4 + length + 12)?;
            of_parts += variables;
            if variables > 0 {
                next("the variables of its parts")?;
            }
        }
        for _ in 0..materials + properties {
            next("its materials")?;
        }
        for _ in 0..subsets {
            let record = next("its subsets")?;
            of_subsets += count(record, 16)?;
            for at in [8, 12, 16] {
                if count(record, at)? > 0 {
                    next("the members of its subsets")?;
                }
            }
        }
        let mut found = Vec::new();
        for _ in 0..groups {
            let record = next("its groups")?;
            let (elements, variables) = (count(record, 12)?, count(record, 16)?);
            let kind = match count(record, 4)? {
                NODES => Some(Kind::Node),
                WALLS => Some(Kind::Wall),
                INTERFACES => Some(Kind::Contact),
                _ => None,
            };
            let mut group = Group { kind, elements: Vec::new(), variables, codes: Vec::new() };
            for _ in 0..elements {
                let record = next("the elements of its groups")?;
                group.elements.push((whole(record, 0).unwrap_or(0), title(record, 4, length)));
            }
            if variables > 0 {
                let record = next("the variables of its groups")?;
                group.codes = (0..record.len() / 4).filter_map(|k| whole(record, 4 * k)).collect();
            }
            if group.codes.len() != variables || elements.saturating_mul(variables) > room {
                return Err("a group with other variables than it says, or more than it can hold".to_owned());
            }
            found.push(group);
        }
        Ok(Self { title: title(first, 4, 80), units, globals, of_parts, of_subsets, groups: found })
    }

    /// Names of all variables of all elements: of the titles, else by their codes.
    fn names(&self, titles: Option<&[u8]>) -> Vec<Vec<String>> {
        let text = titles.map(decode).unwrap_or_default();
        let mut named = text.lines().skip(1).step_by(2).map(|name| name.trim().to_owned());
        let of_code = |group: &Group, k: usize| {
            let table: &[&str] = if group.kind == Some(Kind::Node) { &OF_NODE } else { &OF_WALL };
            let code = group.codes.get(k).and_then(|code| usize::try_from(*code - 1).ok());
            code.and_then(|code| table.get(code)).map_or_else(String::new, |name| (*name).to_owned())
        };
        let of_group = |group: &Group| {
            let all = (0..group.elements.len()).flat_map(|_| 0..group.variables);
            all.map(|k| named.next().unwrap_or_else(|| of_code(group, k))).collect()
        };
        self.groups.iter().map(of_group).collect()
    }

    /// The members with columns yet to be filled, and for each group those of its elements.
    fn members(&self) -> (Vec<Member>, Vec<Vec<Option<usize>>>) {
        let mut members = vec![Member::new(Kind::Global, "", "")];
        let mut add = |group: &Group, (id, title): &(i32, String)| {
            let kind = group.kind?;
            members.push(Member::new(kind, id.to_string(), title.clone()));
            Some(members.len() - 1)
        };
        let of_groups =
            self.groups.iter().map(|group| group.elements.iter().map(|e| add(group, e)).collect()).collect();
        (members, of_groups)
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
    let header = Header::of(&mut records).map_err(refused)?;
    let names = header.names(titles);
    let (mut members, of_groups) = header.members();
    let (mut states, mut until) = (0, 0.0);
    while records.at < bytes.len() {
        let Some(state) = State::of(&mut records, &header) else {
            let files = file.to_owned();
            let mut simulation = finished(header, members, states);
            simulation.notes.push(EndMissing { files, states, until });
            return if states == 0 { Err(refused("it has no whole state".to_owned())) } else { Ok(simulation) };
        };
        let globals = GLOBALS.iter().copied().zip(floats(state.globals));
        members[0].push(state.time, globals);
        for ((record, group), (of_group, names)) in
            state.groups.iter().zip(&header.groups).zip(of_groups.iter().zip(&names))
        {
            for (k, member) in of_group.iter().enumerate() {
                let Some(member) = member else { continue };
                let from = k * group.variables;
                let values = floats(record.get(4 * from..).unwrap_or_default()).take(group.variables);
                let row = names[from..from + group.variables].iter().zip(values).filter(|(name, _)| is_read(name));
                members[*member].push(state.time, row.map(|(name, value)| (name.as_str(), value)));
            }
        }
        (states, until) = (states + 1, state.time);
    }
    if states == 0 { Err(refused("it has no state".to_owned())) } else { Ok(finished(header, members, states)) }
}

/// The records of a state.
struct State<'a> {
    time: f64,
    globals: &'a [u8],
    /// One a group, empty where it has no numbers.
    groups: Vec<&'a [u8]>,
}

impl<'a> State<'a> {
    /// The next state; `None` where it is not whole.
    fn of(records: &mut Records<'a>, header: &Header) -> Option<Self> {
        let mut of = |numbers: usize| match numbers {
            0 => Some(&[][..]),
            numbers => records.next().filter(|record| Some(record.len()) == numbers.checked_mul(4)),
        };
        let time = floats(of(1)?).next()?;
        let globals = of(header.globals)?;
        of(header.of_parts)?;
        of(header.of_subsets)?;
        let numbers = |group: &Group| group.elements.len().checked_mul(group.variables);
        let groups = header.groups.iter().map(|group| of(numbers(group)?)).collect::<Option<_>>()?;
        Some(Self { time, globals, groups })
    }
}

fn finished(header: Header, mut members: Vec<Member>, states: usize) -> Simulation {
    members.iter_mut().for_each(rename);
    let walls = forces_of_impulses(&mut members);
    let contents = vec![format!("T01 ({states} states)")];
    let Header { title, units, .. } = header;
    let mut simulation =
        Simulation { solver: "OpenRadioss".to_owned(), title, contents, members, units, ..Simulation::default() };
    if !walls.is_empty() {
        simulation.notes.push(FromImpulse { walls: list(&walls) });
    }
    simulation.finished()
}

/// Whether a variable of a node, a wall or an interface is read.
pub fn is_read(name: &str) -> bool {
    OF_NODE.contains(&name) || OF_WALL.contains(&name)
}

/// Gives columns their names: `VX` is `x_velocity`; normal and tangential impulses of a wall are added.
pub fn rename(member: &mut Member) {
    if member.kind == Kind::Global {
        return;
    }
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for (name, values) in std::mem::take(&mut member.columns) {
        let axis = name.chars().last().unwrap_or('x').to_ascii_lowercase();
        let what = match (&name[..name.len().saturating_sub(1)], member.kind) {
            ("D", Kind::Node) => "displacement",
            ("V", Kind::Node) => "velocity",
            ("A", Kind::Node) => "acceleration",
            ("FN" | "FT", Kind::Wall | Kind::Contact) => "impulse",
            _ => continue,
        };
        let name = format!("{axis}_{what}");
        match columns.iter_mut().find(|(own, _)| *own == name) {
            Some((_, sum)) => sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value),
            None => columns.push((name, values)),
        }
    }
    member.columns = columns;
}

/// Adds the forces to walls and contacts with impulses; returns which these are.
pub fn forces_of_impulses(members: &mut [Member]) -> Vec<String> {
    let mut walls = Vec::new();
    for member in members.iter_mut().filter(|member| matches!(member.kind, Kind::Wall | Kind::Contact)) {
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
    walls
}
