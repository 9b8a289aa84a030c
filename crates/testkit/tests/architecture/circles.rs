//! Rule 2: no circle of files, nor of folders, inside a crate.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::modules::Arrow;
use crate::rule::Violation;
use crate::source::{Package, Source};

/// Arrows between nodes by index, each with one of the arrows of files that it stands for.
type Graph<'a> = BTreeMap<usize, BTreeMap<usize, &'a Arrow>>;

/// Circles of files, then at every level those of a folder's files and folders.
pub fn check(package: &Package, arrows: &[Arrow]) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut files = Graph::new();
    for arrow in arrows {
        files.entry(arrow.from).or_default().entry(arrow.to).or_insert(arrow);
    }
    for circle in circles(&files) {
        violations.push(violation(package, &circle, "files"));
    }
    let folders: BTreeSet<&str> = package.sources.iter().map(Source::folder).collect();
    for folder in folders {
        let mut names: Vec<&str> = Vec::new();
        let mut graph = Graph::new();
        for arrow in arrows {
            let ends = [arrow.from, arrow.to].map(|file| child_of(folder, &package.sources[file].path));
            let [Some(from), Some(to)] = ends else { continue };
            // The errors of a crate belong to all of its rooms; circles of files through them are found above.
            if from == "error.rs" || to == "error.rs" {
                continue;
            }
            let mut index = |name| {
                names.iter().position(|other| *other == name).unwrap_or_else(|| {
                    names.push(name);
                    names.len() - 1
                })
            };
            let (from, to) = (index(from), index(to));
            if from != to {
                graph.entry(from).or_default().entry(to).or_insert(arrow);
            }
        }
        for circle in circles(&graph) {
            // Circles of files alone have been found above.
            let is_folder = |arrow: &&&Arrow| {
                child_of(folder, &package.sources[arrow.from].path).is_some_and(|name| !name.ends_with(".rs"))
            };
            if circle.iter().any(|arrow| is_folder(&arrow)) {
                violations.push(violation(package, &circle, "folders"));
            }
        }
    }
    violations
}

/// The file or folder of `folder` that the path is or lies in.
fn child_of<'a>(folder: &str, path: &'a str) -> Option<&'a str> {
    let rest = path.strip_prefix(folder)?.strip_prefix('/')?;
    Some(rest.split('/').next().unwrap_or(rest))
}

fn violation(package: &Package, circle: &[&Arrow], of: &str) -> Violation {
    let prefix = format!("crates/{}/src/", package.name);
    let short = |file: usize| package.sources[file].path.trim_start_matches(&prefix).to_owned();
    let steps: Vec<String> = circle
        .iter()
        .map(|arrow| format!("{}:{} uses {} of {}", short(arrow.from), arrow.line, arrow.name, short(arrow.to)))
        .collect();
    let message = format!("circle of {of}: {}; move what both sides need into a file below them", steps.join(", "));
    let first = circle[0];
    Violation::of_file(2, &package.sources[first.from], first.line, message)
}

/// The shortest circle through each group of nodes that reach each other.
fn circles<'a>(graph: &Graph<'a>) -> Vec<Vec<&'a Arrow>> {
    let mut seen: BTreeSet<usize> = BTreeSet::new();
    let mut circles = Vec::new();
    for start in graph.keys() {
        if seen.contains(start) {
            continue;
        }
        let Some(circle) = shortest_circle(graph, *start) else { continue };
        let nodes = reachable(graph, *start);
        seen.extend(nodes.into_iter().filter(|node| reachable(graph, *node).contains(start)));
        circles.push(circle);
    }
    circles
}

fn reachable(graph: &Graph<'_>, start: usize) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut queue = vec![start];
    while let Some(node) = queue.pop() {
        for next in graph.get(&node).into_iter().flat_map(BTreeMap::keys) {
            if reached.insert(*next) {
                queue.push(*next);
            }
        }
    }
    reached
}

fn shortest_circle<'a>(graph: &Graph<'a>, start: usize) -> Option<Vec<&'a Arrow>> {
    let mut came: BTreeMap<usize, (usize, &'a Arrow)> = BTreeMap::new();
    let mut queue = VecDeque::from([start]);
    while let Some(node) = queue.pop_front() {
        for (next, arrow) in graph.get(&node).into_iter().flatten() {
            if !came.contains_key(next) {
                came.insert(*next, (node, arrow));
                queue.push_back(*next);
            }
        }
    }
    let mut circle = Vec::new();
    let mut node = start;
    loop {
        let (before, arrow) = came.get(&node)?;
        circle.push(*arrow);
        node = *before;
        if node == start {
            circle.reverse();
            return Some(circle);
        }
    }
}
