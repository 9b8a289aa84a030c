//! Curves as Oasys T/HIS writes them (`.cur`): title of the graph, label of x, label of y, label of the curve, pairs;
//! `CONTINUE` and the next one. A velocity is that of a node, a force that of a wall. Source: its manual, 22.1.

use crate::formats::simulation::ascii::number;
use crate::formats::simulation::history::{Kind, Member, Simulation};
use crate::formats::text::lines::{Lines, decode, without_mark};
use crate::{Place, Result, refuse};

/// What the labels may name, as a column has it.
const NAMES: [&str; 4] = ["velocity", "acceleration", "displacement", "force"];

/// Whether a text starts with four lines of words, the second of them the time, and pairs.
pub fn recognises(head: &[u8]) -> bool {
    let text = without_mark(head);
    let mut lines =
        text.split(|b| *b == b'\n').map(|line| decode(line).trim().to_owned()).filter(|line| !line.starts_with('$'));
    let labels: Vec<String> = lines.by_ref().take(4).collect();
    let is_label = |line: &String| !line.is_empty() && pair(line).is_none();
    // One word, perhaps with a unit: a table has the names of its columns in a line.
    let is_time = labels.get(1).is_some_and(|line| {
        let words: Vec<&str> = line.split(char::is_whitespace).collect();
        let is_unit = |word: &&str| word.starts_with(['(', '[']);
        words[0].eq_ignore_ascii_case("time") && words[1..].iter().all(is_unit) && words.len() < 3
    });
    labels.len() == 4 && is_time && labels.iter().all(is_label) && lines.take(3).all(|line| pair(&line).is_some())
}

/// Two numbers.
fn pair(line: &str) -> Option<(f64, f64)> {
    let mut words = line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    let pair = (number(words.next()?)?, number(words.next()?)?);
    words.next().is_none().then_some(pair)
}

/// Reads all curves.
///
/// # Errors
/// A line that is no pair. A curve whose labels name nothing that is known is a record of the whole model.
pub fn read(file: &str, bytes: &[u8]) -> Result<Simulation> {
    let text = without_mark(bytes);
    let mut lines = Lines::new(file, &text);
    let mut simulation = Simulation { solver: "curves of T/HIS".to_owned(), ..Simulation::default() };
    let mut labels: Vec<String> = Vec::new();
    let mut curve: Option<(Member, String)> = None;
    while let Some(line) = lines.take()? {
        let text = decode(line.bytes);
        let text = text.trim();
        if text.is_empty() || text.starts_with('$') {
            continue;
        }
        if text.eq_ignore_ascii_case("CONTINUE") {
            simulation.members.extend(curve.take().map(|(curve, _)| curve));
            labels.clear();
        } else if labels.len() < 4 {
            labels.push(text.to_owned());
        } else {
            let number = simulation.members.len() + 1;
            let (curve, name) = match &mut curve {
                Some(curve) => curve,
                None => curve.insert(begin(number, &labels)),
            };
            let Some((time, value)) = pair(text) else {
                let hint = "export the curve again, or as two columns under one line of names";
                return refuse(Place::line(file, line.number), "no pair of numbers", "time and value", hint);
            };
            curve.push(time, [(name.as_str(), value)].into_iter());
        }
    }
    simulation.members.extend(curve.map(|(curve, _)| curve));
    let points: Vec<String> =
        simulation.members.iter().map(|curve| format!("{} ({} points)", curve.title, curve.times.len())).collect();
    simulation.contents = points;
    Ok(simulation.finished())
}

/// A curve with its column by its labels: `x velocity of node 1` is `x_velocity`.
fn begin(number: usize, labels: &[String]) -> (Member, String) {
    let words = format!("{} {} {}", labels[3], labels[2], labels[0]).to_lowercase();
    let name = NAMES.iter().find(|name| words.contains(**name)).copied();
    let axis = words.split(|c: char| !c.is_alphanumeric()).find(|word| matches!(*word, "x" | "y" | "z")).unwrap_or("x");
    let kind = match name {
        Some("force") => Kind::Wall,
        Some(_) => Kind::Node,
        None => Kind::Global,
    };
    let column = name.map_or_else(|| "value".to_owned(), |name| format!("{axis}_{name}"));
    (Member::new(kind, number.to_string(), labels[3].clone()), column)
}
