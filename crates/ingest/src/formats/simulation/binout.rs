//! LS-DYNA binout: folders of states (`nodout`, `rwforc/forces`, `rcforc`, `glstat`, `matsum`) in one or several files.
//!
//! Titles belong to `legend_ids`, which has another order and another count than `ids`. Times are those of the
//! variable `time`: states are not equidistant.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::simulation::history::{Kind, Member, Simulation};
use crate::formats::simulation::lsda::Tree;
use crate::formats::simulation::remarks::EndMissing;
use crate::{IngestError, Result, refuse, refuse_size};

/// Folders that are read: path, metadata and what it holds.
const FOLDERS: [(&str, &str, Kind); 5] = [
    ("/nodout", "/nodout/metadata", Kind::Node),
    ("/rwforc/forces", "/rwforc/forces/metadata", Kind::Wall),
    ("/rcforc", "/rcforc/metadata", Kind::Contact),
    ("/glstat", "/glstat/metadata", Kind::Global),
    ("/matsum", "/matsum/metadata", Kind::Part),
];
/// What a number takes while it is read: as read, as a column, as a wave.
const BYTES_A_NUMBER: u64 = 24;
/// Most variables of a state.
const COLUMN_LIMIT: usize = 200;

/// Reads the files of one result in their order.
///
/// # Errors
/// A file that contradicts itself, nodes without ids, more states than memory is left for.
pub fn read(files: &[(&str, &[u8])]) -> Result<Simulation> {
    let mut tree = Tree::new();
    let mut cut = Vec::new();
    for (name, bytes) in files {
        let is_whole = tree.add(bytes).map_err(|found| {
            let hint = "the file is damaged: copy it again from where the solver wrote it";
            IngestError::content(name, found, "a whole binout of LS-DYNA", hint)
        })?;
        if !is_whole {
            cut.push((*name).to_owned());
        }
    }
    let main = files.first().map_or("binout", |(name, _)| name);
    let size: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    let mut simulation = Simulation::default();
    let mut others: BTreeSet<&str> = tree.folders().filter_map(|path| path.split('/').nth(1)).collect();
    for (folder, metadata, kind) in FOLDERS {
        let members = members(main, &tree, (folder, metadata, kind), size)?;
        if folder.split('/').nth(1).is_some_and(|top| others.remove(top)) {
            let empty = if members.is_empty() { ", nothing in it" } else { "" };
            simulation.contents.push(format!("{} ({} states{empty})", &folder[1..], tree.states(folder).len()));
        }
        simulation.members.extend(members);
        if simulation.title.is_empty() {
            simulation.title = tree.text(metadata, "title").unwrap_or_default();
            simulation.solver = tree.text(metadata, "version").map_or_else(String::new, |v| format!("LS-DYNA {v}"));
        }
    }
    if !others.is_empty() {
        simulation.contents.push(format!("not read: {}", others.into_iter().collect::<Vec<_>>().join(", ")));
    }
    if !cut.is_empty() {
        let states = simulation.members.iter().map(|member| member.times.len()).max().unwrap_or(0);
        let until = simulation.members.iter().filter_map(|member| member.times.last()).fold(0.0_f64, |a, b| a.max(*b));
        simulation.notes.push(EndMissing { files: cut.join(", "), states, until });
    }
    Ok(simulation.finished())
}

/// Nodes, walls, contacts, the whole or parts of a folder.
fn members(
    file: &str,
    tree: &Tree<'_>,
    (folder, metadata, kind): (&str, &str, Kind),
    size: usize,
) -> Result<Vec<Member>> {
    let states = tree.states(folder);
    let ids = tree.numbers(metadata, "ids").unwrap_or_default();
    if kind == Kind::Node && !states.is_empty() && ids.is_empty() {
        return refuse(
            file,
            "its nodes have no ids: metadata stand in the first file of a result only",
            "the first file beside it, binout0000 or binout",
            "give the folder of the simulation, or its first file with all others beside it",
        );
    }
    let mut members = named(tree, metadata, kind, &ids);
    let numbers = members.len().saturating_mul(states.len());
    let names: Vec<String> = states.first().map(|first| columns_of(tree, first, kind)).unwrap_or_default();
    let count = numbers.saturating_mul(names.len());
    if count > size {
        return refuse(
            file,
            format!("{} entries of {folder} in {} states are more than the file can hold", members.len(), states.len()),
            "values of every entry in every state",
            "the file is damaged: copy it again from where the solver wrote it",
        );
    }
    if count as u64 > crumple_memory::left() / BYTES_A_NUMBER {
        let limit = "what is left of the memory limit (--memory-limit gives more)";
        return refuse_size(file, format!("{count} numbers in {folder}"), limit);
    }
    let width = members.len();
    for state in &states {
        let Some(time) = tree.numbers(state, "time").and_then(|time| time.first().copied()) else { continue };
        let values: Vec<Option<Vec<f64>>> = names.iter().map(|name| tree.numbers(state, name)).collect();
        let is_whole = |values: &Option<Vec<f64>>| values.as_ref().is_some_and(|values| values.len() >= width);
        // A state of which the end is missing.
        if kind != Kind::Global && !values.iter().all(is_whole) {
            continue;
        }
        for (k, member) in members.iter_mut().enumerate() {
            let of_member = |values: &Option<Vec<f64>>| {
                let values = values.as_deref().unwrap_or_default();
                // The energy of stone walls has a value for each wall.
                if kind == Kind::Global { values.iter().sum() } else { values.get(k).copied().unwrap_or(f64::NAN) }
            };
            let row = names.iter().zip(&values).filter(|(_, values)| kind != Kind::Global || values.is_some());
            member.push(time, row.map(|(name, values)| (name.as_str(), of_member(values))));
        }
    }
    Ok(members)
}

/// The members of a folder by ids and titles; one without a name for the whole.
fn named(tree: &Tree<'_>, metadata: &str, kind: Kind, ids: &[f64]) -> Vec<Member> {
    if kind == Kind::Global {
        return vec![Member::new(kind, "", "")];
    }
    let legend_ids = tree.numbers(metadata, "legend_ids").unwrap_or_default();
    let titles = tree.texts(metadata, "legend", legend_ids.len());
    let titles: BTreeMap<i64, String> = legend_ids.iter().map(|id| *id as i64).zip(titles).collect();
    let sides = tree.numbers(metadata, "side").unwrap_or_default();
    let member = |(k, id): (usize, &f64)| {
        let title = titles.get(&(*id as i64)).cloned().unwrap_or_default();
        let side = match sides.get(k) {
            Some(side) if kind == Kind::Contact => {
                if *side == 0.0 {
                    ".slave"
                } else {
                    ".master"
                }
            }
            _ => "",
        };
        Member::new(kind, format!("{id}{side}"), title)
    };
    ids.iter().enumerate().map(member).collect()
}

/// The variables of a state that are read.
fn columns_of(tree: &Tree<'_>, state: &str, kind: Kind) -> Vec<String> {
    let is_read = |name: &&str| match kind {
        Kind::Node => {
            name.len() > 2
                && matches!(&name[..2], "x_" | "y_" | "z_")
                && matches!(&name[2..], "displacement" | "velocity" | "acceleration")
        }
        Kind::Wall | Kind::Contact => name.ends_with("_force"),
        Kind::Global => !matches!(*name, "time" | "cycle" | "nzc") && !name.starts_with("ts_"),
        Kind::Part => {
            matches!(*name, "internal_energy" | "kinetic_energy" | "x_momentum" | "y_momentum" | "z_momentum")
        }
    };
    tree.names(state).filter(is_read).take(COLUMN_LIMIT).map(str::to_owned).collect()
}
