//! Which nodes and which walls stand for the car: those asked for, else those whose titles say so.

use crate::error::Question;
use crate::formats::simulation::history::{Kind, Member, Simulation};
use crate::recording::content::list;
use crate::{IngestError, IngestSettings, Result, refuse_channel};

/// Words of titles of places that move with the passenger compartment; codes of ISO/TS 13499 among them.
const COMPARTMENT: [&str; 18] = [
    "sill",
    "silb",
    "11sill",
    "13sill",
    "14sill",
    "16sill",
    "rocker",
    "b-pillar",
    "bpillar",
    "10vehc",
    "10vehccg",
    "vehc",
    "tunnel",
    "crossmember",
    "10secm",
    "compartment",
    "10tunn",
    "cg",
];
/// Words of places that do not.
const ELSEWHERE: [&str; 10] =
    ["engine", "10engn", "gearbox", "wheel", "bumper", "barrier", "dummy", "head", "chest", "pelvis"];

/// Nodes that stand for the car, and why.
pub struct Choice {
    /// As indices of the members.
    pub nodes: Vec<usize>,
    pub why: &'static str,
    /// Other nodes that may be meant, in words.
    pub others: Option<String>,
}

/// A node in words.
pub fn describe(node: &Member) -> String {
    if node.title.is_empty() { node.id.clone() } else { format!("{} ({})", node.id, node.title) }
}

/// The nodes asked for by id or title, several by commas; else the only one, or those at a place of the compartment:
/// one, or two, of which the mean is taken.
///
/// # Errors
/// A name that means no node or several; none asked for where the titles do not tell.
pub fn choose(file: &str, simulation: &Simulation, settings: &IngestSettings) -> Result<Choice> {
    let all = || (0..simulation.members.len()).filter(|k| simulation.members[*k].kind == Kind::Node);
    let words =
        |indices: &[usize]| list(&indices.iter().map(|k| describe(&simulation.members[*k])).collect::<Vec<_>>());
    if let Some(wanted) = &settings.node {
        let wanted = wanted.split(',').map(str::trim).filter(|name| !name.is_empty());
        let found: Result<Vec<usize>> = wanted.map(|name| named(file, simulation, name)).collect();
        return Ok(Choice { nodes: found?, why: "as asked for", others: None });
    }
    let nodes: Vec<usize> = all().collect();
    let is_of_compartment = |k: &usize| {
        let title = simulation.members[*k].title.to_lowercase();
        let has = |of: &[&str]| title.split([' ', ',', '_', '(', ')']).any(|word| of.contains(&word));
        has(&COMPARTMENT) && !has(&ELSEWHERE)
    };
    let of_compartment: Vec<usize> = nodes.iter().copied().filter(is_of_compartment).collect();
    let (taken, why) = match (nodes.as_slice(), of_compartment.as_slice()) {
        ([_], _) => (nodes.clone(), "the only one"),
        (_, [_]) => (of_compartment, "by its title"),
        (_, [_, _]) => (of_compartment, "by their titles: the mean of both"),
        ([], _) => return Ok(Choice { nodes, why: "", others: None }),
        (_, several) => {
            let among = if several.is_empty() { &nodes } else { &of_compartment };
            let id = &simulation.members[among[0]].id;
            let found =
                format!("{} nodes, and their titles do not say which is the car: {}", nodes.len(), words(among));
            let error = IngestError::channel(
                file,
                found,
                "the node of the compartment, by its id or title",
                format!("add --node {id}, for example; --list prints all"),
            );
            return Err(error.asking(Question::Node(id.as_str().into())));
        }
    };
    let others: Vec<usize> = nodes.into_iter().filter(|k| !taken.contains(k)).collect();
    let others = (!others.is_empty()).then(|| words(&others));
    Ok(Choice { nodes: taken, why, others })
}

/// The node of this id; else the one of this title, or with these words in its title.
fn named(file: &str, simulation: &Simulation, name: &str) -> Result<usize> {
    let fold = name.to_lowercase();
    let fitting = |fits: &dyn Fn(&Member) -> bool| -> Vec<usize> {
        let is_it = |k: &usize| simulation.members[*k].kind == Kind::Node && fits(&simulation.members[*k]);
        (0..simulation.members.len()).filter(is_it).collect()
    };
    let by_id = fitting(&|node| node.id == name);
    let by_title = || fitting(&|node| node.title.to_lowercase() == fold);
    let by_words = || fitting(&|node| node.title.to_lowercase().contains(&fold));
    let found = [by_id, by_title(), by_words()].into_iter().find(|found| !found.is_empty()).unwrap_or_default();
    let words = |indices: &mut dyn Iterator<Item = &Member>| list(&indices.map(describe).collect::<Vec<_>>());
    match found.as_slice() {
        [one] => Ok(*one),
        [] => {
            let here = words(&mut simulation.of(Kind::Node));
            let expected = if here.is_empty() { "no node is in it".to_owned() } else { format!("one of {here}") };
            refuse_channel(file, format!("node {name} of --node is not in it"), expected, "--list prints all nodes")
        }
        several => {
            let here = words(&mut several.iter().map(|k| &simulation.members[*k]));
            let found = format!("--node {name} means {} nodes: {here}", several.len());
            refuse_channel(file, found, "one node, or several ids by commas", "give its id")
        }
    }
}
