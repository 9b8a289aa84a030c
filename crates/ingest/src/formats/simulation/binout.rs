//! LS-DYNA binout: folders of states (`nodout`, `rwforc/forces`, `rcforc`, `glstat`, `matsum`) in one or several files.
//!
//! Titles belong to `legend_ids`, which has another order and another count than `ids`. Times are those of the
//! variable `time`: states are not equidistant.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::simulation::history::{Kind, Member, Simulation};
use crate::formats::simulation::lsda::{Source, Tree};
use crate::formats::simulation::remarks::EndMissing;
use crate::{IngestError, IngestSettings, Result, refuse, refuse_size};

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
pub fn read(files: Vec<(&str, Source<'_>)>, settings: &IngestSettings) -> Result<Simulation> {
    let mut tree = Tree::new();
    let mut cut = Vec::new();
    let main = files.first().map_or("binout", |(name, _)| name);
    for (name, file) in files {
        let is_whole = tree.add(file).map_err(|found| {
            let hint = "the file is damaged: copy it again from where the solver wrote it";
            IngestError::content(name, found, "a whole binout of LS-DYNA", hint)
        })?;
        if !is_whole {
            cut.push(name.to_owned());
        }
    }
    let mut simulation = Simulation::default();
    let mut others: BTreeSet<&str> = tree.folders().filter_map(|path| path.split('/').nth(1)).collect();
    for (folder, metadata, kind) in FOLDERS {
        let members = members(main, &tree, (folder, metadata, kind), settings)?;
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
    tree.finished().map_err(|error| {
        let hint = "read it again; of a run that goes on, give a copy";
        IngestError::content(main, error.to_string(), "files that can be read and do not change", hint)
    })?;
    Ok(simulation.finished())
}

/// Nodes, walls, contacts, the whole or parts of a folder.
fn members(
    file: &str,
    tree: &Tree<'_>,
    (folder, metadata, kind): (&str, &str, Kind),
    settings: &IngestSettings,
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
    let width = members.len();
    let names: Vec<String> = states.first().map(|first| columns_of(tree, first, kind)).unwrap_or_default();
    let rows = states.len().saturating_mul(names.len());
    if width.saturating_mul(rows) > tree.bytes() {
        return refuse(
            file,
            format!("{width} entries of {folder} in {} states are more than the file can hold", states.len()),
            "values of every entry in every state",
            "the file is damaged: copy it again from where the solver wrote it",
        );
    }
    let room = crumple_memory::left() / BYTES_A_NUMBER;
    let fits = |entries: usize| entries.saturating_mul(rows) as u64 <= room;
    let wanted = wanted(&members, settings, settings.listing && fits(width));
    if !fits(wanted.len()) {
        let limit = "what is left of the memory limit (--memory-limit gives more)";
        return refuse_size(file, format!("{} numbers in {folder}", wanted.len().saturating_mul(rows)), limit);
    }
    for state in &states {
        let Some(time) = tree.numbers(state, "time").and_then(|time| time.first().copied()) else { continue };
        if kind == Kind::Global {
            // The energy of stone walls has a value for each wall.
            let sum = |name: &str| Some(tree.numbers(state, name)?.iter().sum());
            members[0].push(time, names.iter().filter_map(|name| Some((name.as_str(), sum(name)?))));
            continue;
        }
        let values = names.iter().map(|name| tree.numbers_at(state, name, &wanted, width));
        // Else the end of the state is missing.
        let Some(values) = values.collect::<Option<Vec<Vec<f64>>>>() else { continue };
        for (place, k) in wanted.iter().enumerate() {
            let row = names.iter().zip(&values).map(|(name, values)| (name.as_str(), values[place]));
            members[*k].push(time, row);
        }
    }
    Ok(members)
}

/// The entries that are read: of nodes those with a title, that of `--node` and the first, which are all that a record
/// is made of; or all.
fn wanted(members: &[Member], settings: &IngestSettings, is_all: bool) -> Vec<usize> {
    let node = settings.node.as_deref().map(str::trim);
    let is_wanted = |k: &usize| {
        let member = &members[*k];
        is_all || *k == 0 || member.kind != Kind::Node || !member.title.is_empty() || node == Some(&member.id)
    };
    (0..members.len()).filter(is_wanted).collect()
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
