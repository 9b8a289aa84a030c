//! Lines of Rust that each crate may have, `budget.toml`: they only fall.
//!
//! `CRUMPLE_WRITE_BUDGET=1` (`just budget`) writes down what crates need less.

use std::collections::BTreeMap;
use std::fs;

use serde::{Deserialize, Serialize};

use crate::{Package, root};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Lines by crate.
    pub lines: BTreeMap<String, usize>,
    /// Crates that rose above their lines.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub exceptions: BTreeMap<String, Exception>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exception {
    pub lines: usize,
    pub reason: String,
    /// Number of the decision that says why.
    pub adr: u32,
}

/// Compares the packages with the file, which is lowered first where that is asked for.
pub fn check(packages: &[Package]) -> Vec<String> {
    let path = root().join("crates/testkit/tests/architecture/budget.toml");
    let text = fs::read_to_string(&path).unwrap();
    let mut budget: Budget = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    if std::env::var_os("CRUMPLE_WRITE_BUDGET").is_some() {
        budget.lower(packages);
        let comment: String = text.split_inclusive('\n').take_while(|line| line.starts_with('#')).collect();
        fs::write(&path, format!("{comment}\n{}", toml::to_string(&budget).unwrap())).unwrap();
    }
    let decisions = fs::read_dir(root().join("docs/adr")).unwrap().map(|entry| entry.unwrap().file_name());
    let decisions = decisions.filter_map(|name| name.to_str()?.split_once('-')?.0.parse().ok());
    budget.broken(packages, &decisions.collect::<Vec<u32>>())
}

impl Budget {
    pub fn broken(&self, packages: &[Package], decisions: &[u32]) -> Vec<String> {
        let mut broken = Vec::new();
        for package in packages {
            let (name, lines) = (&package.name, package.lines());
            let most = self.exceptions.get(name).map(|exception| &exception.lines).or(self.lines.get(name));
            match most {
                None => broken.push(format!("crate {name} has no budget: give it {lines} lines in budget.toml")),
                Some(most) if lines > *most => broken.push(format!(
                    "crate {name} has {lines} lines, its budget is {most}: write less, or state an exception in \
                     budget.toml"
                )),
                Some(_) => {}
            }
        }
        for name in self.lines.keys().filter(|name| !packages.iter().any(|package| package.name == **name)) {
            broken.push(format!("budget.toml: {name} is no crate: take it out"));
        }
        for (name, exception) in &self.exceptions {
            if exception.reason.split_whitespace().count() < 4 || !decisions.contains(&exception.adr) {
                broken.push(format!("budget.toml: the exception of {name} needs a reason and the number of an ADR"));
            }
            if self.lines.get(name).is_none_or(|lines| *lines >= exception.lines) {
                broken.push(format!("budget.toml: {name} needs no exception: take it out"));
            }
        }
        broken
    }

    pub fn lower(&mut self, packages: &[Package]) {
        for package in packages {
            let lines = package.lines();
            if let Some(budget) = self.lines.get_mut(&package.name) {
                *budget = lines.min(*budget);
            }
            if let Some(exception) = self.exceptions.get_mut(&package.name) {
                exception.lines = lines.min(exception.lines);
            }
        }
        let lines = &self.lines;
        self.exceptions.retain(|name, exception| lines.get(name).is_none_or(|lines| exception.lines > *lines));
    }
}
