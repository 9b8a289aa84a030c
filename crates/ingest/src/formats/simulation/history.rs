//! Time histories of a simulation, whatever solver wrote them: nodes, walls, contacts, parts, the whole model.

use std::collections::BTreeMap;

use crumple_signal::{Notes, QuantityKind};

use crate::formats::simulation::remarks::{BlownUp, NotNumbers};
use crate::recording::content::list;
use crate::recording::unit_system::Units;

/// What a history belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A node: displacement, velocity, acceleration.
    Node,
    /// A rigid wall: the force that it exerts on the model.
    Wall,
    /// A side of a contact interface.
    Contact,
    /// The whole model.
    Global,
    /// A part.
    Part,
}

impl Kind {
    /// First part of a channel's id.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Node => "node",
            Self::Wall => "wall",
            Self::Contact => "contact",
            Self::Global => "model",
            Self::Part => "part",
        }
    }
}

/// Histories of one node, wall, contact or part, or of the whole, in the units of the file.
#[derive(Debug, Clone)]
pub struct Member {
    pub kind: Kind,
    pub id: String,
    /// Title; empty where the file has none.
    pub title: String,
    pub times: Vec<f64>,
    /// By name (`x_velocity`, `kinetic_energy`), each as long as the times.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Member {
    /// One without states.
    pub fn new(kind: Kind, id: impl Into<String>, title: impl Into<String>) -> Self {
        Self { kind, id: id.into(), title: title.into(), times: Vec::new(), columns: Vec::new() }
    }

    /// First part of the ids of its channels: `node.7`, `model`.
    pub fn name(&self) -> String {
        let kind = self.kind.word();
        if self.id.is_empty() { kind.to_owned() } else { format!("{kind}.{}", self.id) }
    }

    /// A column.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(own, _)| own == name).map(|(_, values)| values.as_slice())
    }

    /// Adds a state.
    pub fn push<'a>(&mut self, time: f64, values: impl Iterator<Item = (&'a str, f64)>) {
        for (name, value) in values {
            let column = match self.columns.iter().position(|(own, _)| own == name) {
                Some(k) => k,
                None => {
                    self.columns.push((name.to_owned(), Vec::new()));
                    self.columns.len() - 1
                }
            };
            self.columns[column].1.push(value);
        }
        self.times.push(time);
    }

    /// Leaves out states that a restart wrote again (the later one counts), columns that are not whole, and what is no
    /// number.
    fn finish(&mut self) -> Option<Bad> {
        let states = self.times.len();
        self.columns.retain(|(_, values)| values.len() == states);
        let bad = self.leave_out_what_is_no_number();
        let states = self.times.len();
        let mut kept: Vec<usize> = Vec::new();
        for k in (0..states).rev() {
            if kept.last().is_none_or(|next| self.times[k] < self.times[*next]) {
                kept.push(k);
            }
        }
        kept.reverse();
        if kept.len() < states {
            let pick = |values: &mut Vec<f64>| *values = kept.iter().map(|k| values[*k]).collect();
            self.columns.iter_mut().for_each(|(_, values)| pick(values));
            pick(&mut self.times);
        }
        bad
    }

    /// Ends in front of a blow-up, of which the last state has no number; else without the columns that hold such.
    fn leave_out_what_is_no_number(&mut self) -> Option<Bad> {
        let first = |values: &[f64]| values.iter().position(|x| !x.is_finite());
        let is_last = |values: &[f64]| values.last().is_some_and(|x| !x.is_finite());
        let blows_up = !self.columns.is_empty() && self.columns.iter().all(|(_, values)| is_last(values));
        if blows_up {
            let end = self.columns.iter().filter_map(|(_, values)| first(values)).min().unwrap_or(0);
            let from = self.times[end];
            self.times.truncate(end);
            self.columns.iter_mut().for_each(|(_, values)| values.truncate(end));
            return Some(Bad::From(from));
        }
        let (good, bad): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.columns).into_iter().partition(|(_, values)| first(values).is_none());
        self.columns = good;
        (!bad.is_empty()).then(|| Bad::Columns(bad.into_iter().map(|(name, _)| name).collect()))
    }
}

/// What of a member is no number.
enum Bad {
    /// All of it from this time on.
    From(f64),
    /// These columns.
    Columns(Vec<String>),
}

/// Says it once of all members: where the run blew up, which columns are left out.
fn say_what_is_no_number(all: &[(String, Bad)], notes: &mut Notes) {
    let blown = all.iter().filter_map(|(of, bad)| if let Bad::From(from) = bad { Some((of, *from)) } else { None });
    let (of, from): (Vec<String>, Vec<f64>) = blown.map(|(of, from)| (of.clone(), from)).unzip();
    if let Some(from) = from.into_iter().reduce(f64::min) {
        notes.push(BlownUp { count: of.len(), of: list(&of), from });
    }
    let mut by_columns: BTreeMap<&[String], Vec<&str>> = BTreeMap::new();
    for (of, bad) in all {
        if let Bad::Columns(columns) = bad {
            by_columns.entry(columns).or_default().push(of);
        }
    }
    for (columns, of) in by_columns {
        notes.push(NotNumbers { count: of.len(), of: list(&of), columns: list(columns) });
    }
}

/// What a column measures, by its name, and the powers of length, time and mass in its unit.
pub fn quantity(name: &str) -> (QuantityKind, [i32; 3]) {
    const KINDS: [(&str, QuantityKind, [i32; 3]); 10] = [
        ("displacement", QuantityKind::Displacement, [1, 0, 0]),
        ("velocity", QuantityKind::Velocity, [1, -1, 0]),
        ("acceleration", QuantityKind::Acceleration, [1, -2, 0]),
        ("force", QuantityKind::Force, [1, -2, 1]),
        ("impulse", QuantityKind::Other, [1, -1, 1]),
        ("momentum", QuantityKind::Other, [1, -1, 1]),
        ("energy", QuantityKind::Other, [2, -2, 1]),
        ("work", QuantityKind::Other, [2, -2, 1]),
        ("mass", QuantityKind::Other, [0, 0, 1]),
        ("time_step", QuantityKind::Other, [0, 1, 0]),
    ];
    let kind = KINDS.iter().find(|(ending, ..)| name.ends_with(ending));
    kind.map_or((QuantityKind::Other, [0; 3]), |(_, kind, powers)| (*kind, *powers))
}

/// Everything that is read of a simulation.
#[derive(Debug, Default)]
pub struct Simulation {
    /// Solver and version, in words.
    pub solver: String,
    pub title: String,
    /// What of it is read and what is there, in words.
    pub contents: Vec<String>,
    pub members: Vec<Member>,
    /// Units that the file states.
    pub units: Option<Units>,
    pub notes: Notes,
}

impl Simulation {
    /// The members in order, without states that a restart wrote again.
    pub fn finished(mut self) -> Self {
        let Self { members, notes, .. } = &mut self;
        let bad: Vec<(String, Bad)> =
            members.iter_mut().filter_map(|member| Some((member.name(), member.finish()?))).collect();
        say_what_is_no_number(&bad, notes);
        // Stable: as in the file.
        self.members.sort_by_key(|member| member.kind);
        self
    }

    /// The members of a kind.
    pub fn of(&self, kind: Kind) -> impl Iterator<Item = &Member> {
        self.members.iter().filter(move |member| member.kind == kind)
    }
}

/// Derivative over time by central differences, one-sided at the ends: of a column that is exact at every state the
/// error is a sixth of the step squared times the third derivative.
pub fn derivative(times: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let slope = |k: usize| {
        let (a, b) = (k.saturating_sub(1), (k + 1).min(last));
        if a == b { 0.0 } else { (values[b] - values[a]) / (times[b] - times[a]) }
    };
    (0..values.len()).map(slope).collect()
}

/// Integral over time by the trapezoidal rule, from 0.
pub fn integral(times: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let step = |k: usize| {
        if k > 0 {
            sum += (times[k] - times[k - 1]) * (values[k] + values[k - 1]) / 2.0;
        }
        sum
    };
    (0..values.len()).map(step).collect()
}

#[cfg(test)]
mod tests {
    use crumple_signal::{Note, Value};

    use super::*;

    #[test]
    fn a_restart_replaces_what_it_wrote_again() {
        let mut member = Member::new(Kind::Node, "1", "");
        for (time, x) in [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0), (1.0, 4.0), (2.0, 5.0)] {
            member.push(time, [("x_velocity", x)].into_iter());
        }
        let simulation = Simulation { members: vec![member], ..Simulation::default() }.finished();
        let member = &simulation.members[0];
        assert_eq!(
            (member.times.as_slice(), member.column("x_velocity").unwrap()),
            (&[0.0, 1.0, 2.0][..], &[1.0, 4.0, 5.0][..])
        );
    }

    #[test]
    fn a_blow_up_ends_the_record_and_a_bad_column_is_left_out() {
        let finished = |rows: &[(f64, f64, f64)]| {
            let member = |id: &str| {
                let mut member = Member::new(Kind::Node, id, "");
                for (time, x, y) in rows {
                    member.push(*time, [("x_velocity", *x), ("y_velocity", *y)].into_iter());
                }
                member
            };
            Simulation { members: vec![member("1"), member("2")], ..Simulation::default() }.finished()
        };
        // One remark of all nodes.
        let said = |simulation: &Simulation| {
            let one = |note: &Note| (note.kind.map(|kind| kind.code), note.values.clone());
            simulation.notes.iter().map(one).collect::<Vec<_>>()
        };
        let text = |text: &str| Value::Text(text.to_owned());
        let blown = finished(&[(0.0, 1.0, 0.0), (1.0, f64::NAN, 0.0), (2.0, f64::INFINITY, f64::NAN)]);
        assert_eq!((blown.members[0].times.as_slice(), blown.members[0].columns.len()), (&[0.0][..], 2));
        let values = vec![("count", Value::Number(2.0)), ("of", text("node.1, node.2")), ("from", Value::Number(1.0))];
        assert_eq!(said(&blown), [(Some("CR183"), values)]);
        let bad = finished(&[(0.0, 1.0, f64::NAN), (1.0, 2.0, 0.0), (2.0, 3.0, 0.0)]);
        assert_eq!(bad.members[1].columns, [("x_velocity".to_owned(), vec![1.0, 2.0, 3.0])]);
        let columns = ("columns", text("y_velocity"));
        let values = vec![("count", Value::Number(2.0)), ("of", text("node.1, node.2")), columns];
        assert_eq!(said(&bad), [(Some("CR184"), values)]);
    }

    #[test]
    fn derivative_and_integral_of_a_parabola() {
        let times: Vec<f64> = (0..11).map(|k| 0.1 * f64::from(k)).collect();
        let values: Vec<f64> = times.iter().map(|t| t * t).collect();
        // Central differences are exact for it.
        assert!(derivative(&times, &values)[1..10].iter().zip(&times[1..]).all(|(v, t)| (v - 2.0 * t).abs() < 1e-12));
        let back = integral(&times, &derivative(&times, &values));
        assert!((back[10] - 1.0).abs() < 0.011);
    }
}
