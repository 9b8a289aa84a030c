//! The modules directly below `src`, files or folders, use each other in no circle.

use std::collections::{BTreeMap, BTreeSet};

use crate::Package;
use crate::paths::{Use, uses};

/// Who uses whom, and where.
type Arrows = BTreeMap<(String, String), String>;

pub fn broken(package: &Package) -> Vec<String> {
    let uses = uses(package);
    let roots: BTreeSet<&str> = uses.iter().map(|named| named.root.as_str()).collect();
    let of_root = |root| arrows(root, uses.iter().filter(|named| named.root == *root).collect());
    roots.into_iter().filter_map(|root| message(&of_root(root))).collect()
}

/// The arrows between the modules of one library or program, the root among them under the name of its file.
fn arrows(root: &str, uses: Vec<&Use>) -> Arrows {
    let modules: BTreeSet<&str> = uses.iter().filter_map(|named| named.module.first()).map(String::as_str).collect();
    // What the root hands on belongs to the module that it is from.
    let mut handed_on = BTreeMap::new();
    for named in uses.iter().filter(|named| named.module.is_empty() && named.is_handed_on) {
        let module = below_root(named).filter(|module| modules.contains(module));
        handed_on.extend(named.path.last().map(String::as_str).zip(module));
    }
    let mut arrows = Arrows::new();
    for named in uses.iter().filter(|named| !named.module.is_empty() || !named.is_handed_on) {
        let from = named.module.first().map_or(root, String::as_str);
        let Some(name) = below_root(named) else { continue };
        let to = modules.get(name).copied().or_else(|| handed_on.get(name).copied()).unwrap_or(root);
        // The errors of a crate belong to all of its modules.
        if from != to && ![from, to].contains(&"error") {
            let place = format!("{} {from} uses {}", named.place, named.path.join("::"));
            arrows.entry((from.to_owned(), to.to_owned())).or_insert(place);
        }
    }
    arrows
}

/// The first name of a path below the root of its library or program; none if it leads elsewhere.
fn below_root(named: &Use) -> Option<&str> {
    let (mut depth, mut rest) = match named.path.first()?.as_str() {
        "crate" => (0, &named.path[1..]),
        "self" => (named.module.len(), &named.path[1..]),
        "super" => (named.module.len(), &named.path[..]),
        _ if named.module.is_empty() => (0, &named.path[..]),
        _ => return None,
    };
    while rest.first().is_some_and(|name| name == "super") {
        (depth, rest) = (depth.checked_sub(1)?, &rest[1..]);
    }
    named.module[..depth].iter().chain(rest).next().map(String::as_str)
}

/// One circle, if there is any.
fn message(arrows: &Arrows) -> Option<String> {
    let mut left: Vec<&(String, String)> = arrows.keys().collect();
    let mut before = usize::MAX;
    // Without the modules that use none, until each that is left uses another one.
    while left.len() < before {
        before = left.len();
        let users: BTreeSet<&String> = left.iter().map(|(from, _)| from).collect();
        left.retain(|(_, to)| users.contains(to));
    }
    let mut way = vec![*left.first()?];
    loop {
        let (_, last) = way[way.len() - 1];
        if let Some(start) = way.iter().position(|(from, _)| from == last) {
            let steps: Vec<&str> = way[start..].iter().map(|arrow| arrows[*arrow].as_str()).collect();
            return Some(format!("circle of modules: {}; move what both need below them", steps.join(", ")));
        }
        way.extend(left.iter().find(|(from, _)| from == last));
    }
}
