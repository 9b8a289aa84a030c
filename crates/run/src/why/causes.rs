//! What two runs were made with that differs, and the runs in between.

use std::collections::BTreeSet;

use crumple_report::name_of_cause;
use crumple_stage::chain;

use crate::recipe::{Flags, Recipe, flag_name};

/// One thing that differs.
#[derive(Debug, Clone, PartialEq)]
enum What {
    Record,
    /// A flag of a stage.
    Flag(String, String),
    /// The flags of every stage.
    OfAll,
    /// Whether a stage runs at all.
    Stage(String),
    /// An option of the pipeline.
    Option(String),
    Program(String),
}

/// What is changed at once, and what people call it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cause {
    name: String,
    /// Place of its stage in the chain.
    stage: usize,
    what: Vec<What>,
}

/// What two runs were made with that differs, in the order of the chain.
#[derive(Debug)]
pub(super) struct Causes(Vec<Cause>);

/// The place of a stage in the chain.
pub(super) fn place_in_chain(stage: &str) -> usize {
    chain().position(|known| known.name == stage).unwrap_or(0)
}

impl Causes {
    /// All that differs, each by itself.
    pub(super) fn between<'a>(a: &'a Recipe, b: &'a Recipe) -> Self {
        let mut all: Vec<Cause> = Vec::new();
        // What is typed for a run and what its pipeline states is one cause.
        let mut add = |name: String, stage: &str, what: What| {
            let name = name_of_cause(&name);
            match all.iter_mut().find(|cause| cause.name == name) {
                Some(cause) => cause.what.push(what),
                None => all.push(Cause { name, stage: place_in_chain(stage), what: vec![what] }),
            }
        };
        if a.made_from != b.made_from {
            add("record".to_owned(), "ingest", What::Record);
        }
        if a.typed.of_all != b.typed.of_all {
            add("flags of every stage".to_owned(), "ingest", What::OfAll);
        }
        for stage in chain() {
            let of = |recipe: &'a Recipe| recipe.typed.flags.get(stage.name).map_or(&[][..], Vec::as_slice);
            let names: BTreeSet<&str> = of(a).iter().chain(of(b)).map(|group| flag_name(group)).collect();
            let flags = |recipe: &'a Recipe, name: &str| -> Flags {
                of(recipe).iter().filter(|group| flag_name(group) == name).cloned().collect()
            };
            for name in names.into_iter().filter(|name| flags(a, name) != flags(b, name)) {
                let shown = format!("{}.{}", stage.name, name.trim_start_matches('-').replace('-', "_"));
                add(shown, stage.name, What::Flag(stage.name.to_owned(), name.to_owned()));
            }
        }
        let runs = |recipe: &Recipe, stage: &str| recipe.pipeline.table(stage).is_some();
        for stage in chain().filter(|stage| runs(a, stage.name) != runs(b, stage.name)) {
            add(stage.name.to_owned(), stage.name, What::Stage(stage.name.to_owned()));
        }
        for name in b.pipeline.changed_options(&a.pipeline) {
            let stage = name.split('.').next().unwrap_or_default().to_owned();
            if runs(a, &stage) && runs(b, &stage) {
                add(name.clone(), &stage, What::Option(name));
            }
        }
        for stage in chain().filter(|stage| a.typed.programs.get(stage.name) != b.typed.programs.get(stage.name)) {
            add(format!("program of {}", stage.name), stage.name, What::Program(stage.name.to_owned()));
        }
        all.sort_by_key(|cause| cause.stage);
        Self(all)
    }

    /// The same with no more causes than so many: those of one stage come together, then those of the last stages.
    pub(super) fn at_most(self, most: usize) -> Self {
        let mut causes = self.0;
        let join = |first: &mut Cause, next: Cause| {
            first.name = format!("{}, {}", first.name, next.name);
            first.what.extend(next.what);
        };
        while causes.len() > most {
            let pairs = (1..causes.len()).rev();
            let of_one_stage = pairs.clone().find(|k| causes[*k].stage == causes[k - 1].stage);
            let k = of_one_stage.unwrap_or(causes.len() - 1);
            let next = causes.remove(k);
            join(&mut causes[k - 1], next);
        }
        Self(causes)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|cause| cause.name.clone())
    }

    /// The first stage that a set of causes concerns, by its place in the chain; the length of the chain for none.
    pub(super) fn first_stage(&self, set: usize) -> usize {
        let concerned = self.0.iter().enumerate().filter(|(k, _)| set & (1 << k) != 0);
        concerned.map(|(_, cause)| cause.stage).min().unwrap_or_else(|| chain().count())
    }

    /// The recipe of the first run with a set of causes of the second.
    pub(super) fn mixed(&self, a: &Recipe, b: &Recipe, set: usize) -> Recipe {
        let mut mixed = a.clone();
        let chosen = self.0.iter().enumerate().filter(|(k, _)| set & (1 << k) != 0);
        for what in chosen.flat_map(|(_, cause)| &cause.what) {
            match what {
                What::Record => (mixed.record, mixed.made_from) = (b.record.clone(), b.made_from.clone()),
                What::OfAll => b.typed.of_all.clone_into(&mut mixed.typed.of_all),
                What::Flag(stage, name) => {
                    let is_meant = |group: &Vec<String>| flag_name(group) == name;
                    let taken: Flags = b.typed.flags[stage].iter().filter(|group| is_meant(group)).cloned().collect();
                    let flags = mixed.typed.flags.entry(stage.clone()).or_default();
                    flags.retain(|group| !is_meant(group));
                    flags.extend(taken);
                }
                What::Stage(stage) => mixed.pipeline.take_stage(&b.pipeline, stage),
                What::Option(name) => mixed.pipeline.take_option(&b.pipeline, name),
                What::Program(stage) => match b.typed.programs.get(stage) {
                    Some(program) => _ = mixed.typed.programs.insert(stage.clone(), program.clone()),
                    None => _ = mixed.typed.programs.remove(stage),
                },
            }
        }
        mixed
    }
}
