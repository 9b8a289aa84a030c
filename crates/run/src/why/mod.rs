//! Whose fault a change is: the chain is run again with one cause at a time, and every cause gets its share.

mod causes;
mod shapley;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread;

use anyhow::Context;
use crumple_report::{CompareSettings, Divided, DividedNumber, Group, Quantity, Summary, quantities};
use crumple_stage::{ExitStatus, Pipeline, Usage, chain, program};

use crate::recipe::{Recipe, made_from};
use crate::words::Words;
use causes::{Causes, place_in_chain};
use shapley::shares;

/// Causes that are told apart: all their sets come to 2^4 runs, two of which are made already.
const MOST: usize = 4;

/// The stage that takes most of the time of a run.
const MODELS: &str = "parameter-solve";

/// The change between two runs in parts.
///
/// Shapley values (Shapley 1953): the share of a cause is the mean, over every order in which the causes can come, of
/// what the number changes by when it comes. The shares of a number add up to its change.
///
/// Errors: a folder that does not say how it was made, a record that is not at hand or another one by now, programs of
/// another version.
pub fn why(before: &Path, after: &Path, settings: &CompareSettings) -> anyhow::Result<Divided> {
    let words = [before, after].map(|folder| folder.display().to_string());
    let again = format!("{} {} --why", program("diff"), Words(words.to_vec()));
    let [a, b] = [Recipe::of(before, &again)?, Recipe::of(after, &again)?];
    let causes = Causes::between(&a, &b).at_most(MOST);
    if causes.is_empty() {
        return Ok(Divided::default());
    }
    let made = Sets { a: &a, b: &b, causes: &causes, folder: tempfile::tempdir()? }.run()?;
    let last = made.len() - 1;
    let without = Summary::default();
    let summaries: Vec<&Summary> = made.iter().map(|made| made.as_ref().unwrap_or(&without)).collect();
    let mut divided = Divided { causes: causes.names().collect(), runs: made.len() - 2, ..Divided::default() };
    // A number that one of both does not have has no change.
    let has_both = |row: &&Quantity| row.values[0].is_some() && row.values[last].is_some();
    // Parameters of two models stand beside nothing.
    let is_one_model = summaries.iter().all(|summary| summary.recommended == a.summary.recommended);
    for row in quantities(&summaries, settings).iter().filter(has_both).filter(|row| row.differs(last)) {
        if (0..row.values.len()).any(|run| row.is_undetermined(run)) {
            divided.undetermined.push(row.name.clone());
            continue;
        }
        let values: Option<Vec<f64>> = row.values.iter().map(|own| Some(own.as_ref()?.value)).collect();
        match values.filter(|_| is_one_model || row.group != Group::Parameter) {
            Some(values) => {
                divided.numbers.push(DividedNumber::new(row, [values[0], values[last]], shares(&values)));
            }
            None => divided.undivided.push(row.name.clone()),
        }
    }
    Ok(divided)
}

/// What the chain gives with every set of causes: a set is a number, bit `k` of it the cause `k`.
struct Sets<'a> {
    a: &'a Recipe,
    b: &'a Recipe,
    causes: &'a Causes,
    folder: tempfile::TempDir,
}

impl Sets<'_> {
    /// The summary of every set; `None`: a run without a result.
    fn run(&self) -> anyhow::Result<Vec<Option<Summary>>> {
        let all = (1 << self.causes.len()) - 1;
        let mut made: Vec<Option<Summary>> = vec![None; all + 1];
        made[0] = Some(self.a.summary.clone());
        made[all] = Some(self.b.summary.clone());
        let ends = [(0, self.a.folder.clone()), (all, self.b.folder.clone())];
        let sets: Vec<usize> = (1..all).collect();
        let (first, later): (Vec<usize>, Vec<usize>) = sets.into_iter().partition(|set| self.model(*set).is_none());
        for (set, result) in self.run_all(&first, |set| self.nearest_end(set, &ends)) {
            made[set] = result?;
        }
        let results = self.run_all(&later, |set| {
            let like = self.model(set).filter(|like| made[*like].is_some());
            like.map_or_else(|| self.nearest_end(set, &ends), |like| (like, self.place(like)))
        });
        for (set, result) in results {
            made[set] = result?;
        }
        Ok(made)
    }

    /// The first set that has all up to the models in common with this one, where no end has: what is costly is
    /// computed once.
    fn model(&self, set: usize) -> Option<usize> {
        let all = (1 << self.causes.len()) - 1;
        let has_models = |other: usize| self.causes.first_stage(set ^ other) > place_in_chain(MODELS);
        let is_own = ![0, all].into_iter().any(has_models);
        (1..set).find(|other| is_own && has_models(*other))
    }

    /// The end that shares most with a set.
    fn nearest_end(&self, set: usize, ends: &[(usize, PathBuf); 2]) -> (usize, PathBuf) {
        let [a, b] = ends;
        let shared = |end: &(usize, PathBuf)| self.causes.first_stage(set ^ end.0);
        if shared(b) > shared(a) { b.clone() } else { a.clone() }
    }

    /// Runs sets beside each other, each from what `from` says; the results are in the order of the sets.
    fn run_all(
        &self,
        sets: &[usize],
        from: impl Fn(usize) -> (usize, PathBuf) + Sync,
    ) -> Vec<(usize, anyhow::Result<Option<Summary>>)> {
        let workers = thread::available_parallelism().map_or(1, usize::from).min(sets.len());
        let next = Mutex::new(sets.iter().copied());
        let results = Mutex::new(Vec::new());
        thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(|| {
                    loop {
                        let Some(set) = next.lock().ok().and_then(|mut sets| sets.next()) else { return };
                        let result = self.run_one(set, &from(set));
                        if let Ok(mut results) = results.lock() {
                            results.push((set, result));
                        }
                    }
                });
            }
        });
        let mut results = results.into_inner().unwrap_or_default();
        results.sort_by_key(|(set, _)| *set);
        results
    }

    fn place(&self, set: usize) -> PathBuf {
        self.folder.path().join(format!("set-{set}"))
    }

    /// Runs the chain with a set of causes, from what another run shares with it.
    fn run_one(&self, set: usize, (other, from): &(usize, PathBuf)) -> anyhow::Result<Option<Summary>> {
        let folder = self.place(set);
        fs::create_dir_all(&folder)?;
        let stages = chain().take(self.causes.first_stage(set ^ other)).flat_map(|stage| stage.outputs);
        for name in stages.chain([Pipeline::OF_A_RUN]).filter(|name| from.join(name).is_file()) {
            fs::copy(from.join(name), folder.join(name))?;
        }
        let recipe = self.causes.mixed(self.a, self.b, set);
        let file = self.folder.path().join(format!("set-{set}.toml"));
        fs::write(&file, recipe.pipeline.to_string())?;
        let mut command = recipe.typed.run(Path::new("."), file.as_os_str(), &recipe.record, &folder);
        let ended = command.output().context("cannot start the run of a cause")?;
        let has_result = [ExitStatus::Done, ExitStatus::NoAcceptableResult].map(|status| Some(i32::from(status as u8)));
        if !has_result.contains(&ended.status.code()) {
            return Ok(None);
        }
        if made_from(&folder).is_none_or(|made_from| made_from != recipe.made_from) {
            let problem =
                format!("the record {}, or the file beside it, is another one by now", recipe.record.display());
            return Err(Usage::new(problem).hint("put it back as it was, or run both records again").into());
        }
        Ok(Recipe::summary(&folder))
    }
}
