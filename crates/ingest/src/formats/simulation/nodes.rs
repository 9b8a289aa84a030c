//! Which node stands for the car: the one asked for, else the only one.

use crate::error::Question;
use crate::formats::simulation::history::{Kind, Member, Simulation};
use crate::recording::content::list;
use crate::{IngestError, IngestSettings, Result, refuse_channel};

/// A node in words.
pub fn describe(node: &Member) -> String {
    if node.title.is_empty() { node.id.clone() } else { format!("{} ({})", node.id, node.title) }
}

/// The node of `--node`, by its id, its title or words of that in any order; else the only one. `None` without nodes.
///
/// # Errors
/// A name that means no node or several; none asked for among several.
pub fn choose(file: &str, simulation: &Simulation, settings: &IngestSettings) -> Result<Option<usize>> {
    let members = &simulation.members;
    let fitting = |fits: &dyn Fn(&Member) -> bool| -> Vec<usize> {
        (0..members.len()).filter(|k| members[*k].kind == Kind::Node && fits(&members[*k])).collect()
    };
    let words = |nodes: &[usize]| list(&nodes.iter().map(|k| describe(&members[*k])).collect::<Vec<_>>());
    let all = fitting(&|_| true);
    let Some(name) = settings.node.as_deref().map(str::trim) else {
        return match all.as_slice() {
            [] => Ok(None),
            [only] => Ok(Some(*only)),
            [first, ..] => {
                let id = &members[*first].id;
                let found = format!("{} nodes, and nothing says which is the car: {}", all.len(), words(&all));
                let hint = format!("add --node {id}, for example; --list prints all");
                let error = IngestError::channel(file, found, "the node of the compartment, by its id or title", hint);
                Err(error.asking(Question::Node(id.as_str().into())))
            }
        };
    };
    let fold = name.to_lowercase();
    let by_id = fitting(&|node| node.id == name);
    let by_title = fitting(&|node| node.title.to_lowercase() == fold);
    let has_all_words = |title: &str| fold.split_whitespace().all(|word| title.contains(word));
    let by_words = fitting(&|node| has_all_words(&node.title.to_lowercase()));
    let meant = [by_id, by_title, by_words].into_iter().find(|nodes| !nodes.is_empty()).unwrap_or_default();
    match meant.as_slice() {
        [one] => Ok(Some(*one)),
        [] => {
            let expected =
                if all.is_empty() { "a file with nodes".to_owned() } else { format!("one of {}", words(&all)) };
            refuse_channel(file, format!("node {name} of --node is not in it"), expected, "--list prints all nodes")
        }
        several => {
            let found = format!("--node {name} means {} nodes: {}", several.len(), words(several));
            refuse_channel(file, found, "one node", "give its id")
        }
    }
}
