//! `crumple check --passport`: runs what a crate describes in another folder, and compares.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::Artifact;
use crumple_artifact_cli::PassportCheck;
use crumple_ingest::FILE_LIMIT;
use crumple_stage::{
    ExitStatus, Pipeline, Refused, Usage, chain, keep_budget, memory_limit_flag, printable, program, say, to_stdout,
};

use super::asked::repeatable;
use super::contents::{Contents, Item, Role, damaged, refuse_path_that_leaves};
use super::crate_files::CrateFiles;
use super::metadata::{METADATA, read};
use super::record::{digests, is_one_file};
use crate::program::{NamedPrograms, digest_of};
use crate::recipe::{Typed, VERSION};
use crate::words::Words;

/// Most bytes of a description, of a pipeline, of options beside a record.
const TEXT_LIMIT: u64 = 4 << 20;

/// Checks a crate: whether its files are those that it states, and whether its run gives the same again.
pub(crate) fn check(asked: &PassportCheck) -> anyhow::Result<ExitStatus> {
    keep_budget(std::slice::from_ref(&asked.passport), ExitStatus::Refused);
    let mut files = CrateFiles::open(&asked.passport)?;
    let text = files.text(METADATA, TEXT_LIMIT)?;
    let contents = read(&asked.passport, &text)?;
    let folder = tempfile::tempdir().context("cannot make a folder for the run")?;
    let repeated = Repeated { contents: &contents, asked, folder: folder.path() };
    repeated.unpack(&mut files)?;
    let (pipeline, place) = repeated.pipeline()?;
    let typed = repeatable(Typed::of(&pipeline)?, &asked.passport)?;
    let typed = repeated.with_given_programs(typed)?;
    let record = repeated.record()?;
    keep_budget(&[asked.passport.clone(), record.clone()], ExitStatus::Refused);
    let out = folder.path().join("run");
    let mut command = typed.run(folder.path(), &place, &record, &out);
    if let Some(limit) = memory_limit_flag() {
        command.arg(limit);
    }
    let ended = command.output().context("cannot start the run of the crate")?;
    let code = ended.status.code();
    if code.is_none_or(|code| ![ExitStatus::Done, ExitStatus::NoAcceptableResult].map(|s| s as i32).contains(&code)) {
        say(printable(String::from_utf8_lossy(&ended.stderr).trim_end()));
        let code = code.map_or_else(|| "a signal".to_owned(), |code| format!("exit code {code}"));
        return not_equal(&format!("not equal: the run ended with {code}\n"));
    }
    repeated.compare(&out)
}

/// Says what is not equal.
fn not_equal(text: &str) -> anyhow::Result<ExitStatus> {
    to_stdout(printable(text).as_bytes())?;
    Ok(ExitStatus::Failure)
}

/// The run of a crate in a folder of its own.
struct Repeated<'a> {
    contents: &'a Contents,
    asked: &'a PassportCheck,
    folder: &'a Path,
}

impl Repeated<'_> {
    fn crate_path(&self) -> &Path {
        &self.asked.passport
    }

    /// The command as it was typed, with one more flag.
    fn again(&self, value: &Words, flag: &str) -> String {
        let mut words = vec!["--passport".to_owned(), self.crate_path().display().to_string()];
        if let Some(record) = &self.asked.record {
            words.extend(["--record".to_owned(), record.display().to_string()]);
        }
        words.extend(self.asked.stages.iter().flat_map(|stage| ["--stage".to_owned(), stage.clone()]));
        format!("{} {} {flag} {value}", program("check"), Words(words))
    }

    /// Checks every file of the crate by its size and digest, and takes out what the run needs.
    fn unpack(&self, files: &mut CrateFiles) -> anyhow::Result<()> {
        for item in self.contents.items().filter(|item| item.is_inside) {
            let is_record = item.role == Role::Input && item.name == self.contents.record.name;
            let is_needed = item.role == Role::Input || item.name == Pipeline::OF_A_RUN;
            let most = if is_needed && !is_record { TEXT_LIMIT } else { FILE_LIMIT };
            let place = item.place();
            let copied = if is_needed {
                refuse_path_that_leaves(self.crate_path(), &place)?;
                let path = self.folder.join(&place);
                let parent = path.parent().unwrap_or(self.folder);
                fs::create_dir_all(parent).with_context(|| format!("cannot make {}", parent.display()))?;
                let mut file = File::create(&path).with_context(|| format!("cannot write {}", path.display()))?;
                files.copy(&place, item.size.unwrap_or(most).min(most), &mut file)?
            } else {
                files.copy(&place, item.size.unwrap_or(most).min(most), &mut io::sink())?
            };
            let is_stated = |(size, digest): &(u64, String)| {
                item.bytes.as_ref() == Some(digest) && item.size.is_none_or(|stated| stated == *size)
            };
            if !copied.as_ref().is_some_and(is_stated) {
                return Err(self.changed(item, copied).into());
            }
        }
        Ok(())
    }

    /// A file that is not what the crate states, with its size and digest where it is not larger.
    fn changed(&self, item: &Item, copied: Option<(u64, String)>) -> Refused {
        let stated = item.size.map_or_else(String::new, |size| format!(", {size} bytes"));
        let now = match copied {
            Some((size, digest)) => format!("it is {digest}, {size} bytes"),
            None => format!("it has more than its {} bytes", item.size.unwrap_or(FILE_LIMIT)),
        };
        let what = format!("{} was changed after the crate was made: {now}", item.place());
        let hint = "ask who made it for another copy; of a run of your own, make it again: crumple passport RUN";
        damaged(self.crate_path(), what)
            .expected(format!("{}{stated}, as {METADATA} says", item.bytes.as_deref().unwrap_or("no digest")))
            .hint(hint)
    }

    /// The pipeline of the crate, and how a run is told it, such that it has the name that the first run had.
    fn pipeline(&self) -> anyhow::Result<(Pipeline, OsString)> {
        let unpacked = self.folder.join(Pipeline::OF_A_RUN);
        let refused = |error: anyhow::Error| damaged(self.crate_path(), error);
        let pipeline = Pipeline::read(&unpacked, None).map_err(refused)?;
        let (name, file) = (pipeline.name().unwrap_or("default").to_owned(), pipeline.file());
        let (place, told) = if pipeline.is_named() {
            (format!("pipelines/{name}.toml"), OsString::from(&name))
        } else {
            let file = Path::new(&file).file_name().unwrap_or_default().to_string_lossy().into_owned();
            (format!("pipeline/{file}"), self.folder.join("pipeline").join(file).into())
        };
        refuse_path_that_leaves(self.crate_path(), &place)?;
        let path = self.folder.join(&place);
        let copy =
            || fs::create_dir_all(path.parent().unwrap_or(self.folder)).and_then(|()| fs::copy(&unpacked, &path));
        copy().with_context(|| format!("cannot write {}", path.display()))?;
        Ok((pipeline, told))
    }

    /// The same with the commands that were given here. A command runs because it was typed here, never because a crate
    /// names it.
    ///
    /// Errors: a program from elsewhere that is not given or is another one; a program for a stage of Crumple's own.
    fn with_given_programs(&self, mut typed: Typed) -> anyhow::Result<Typed> {
        let name = |typed: &str| typed.split_once('=').map_or(typed, |(name, _)| name).replace('_', "-");
        let commands = NamedPrograms { stage: self.asked.stages.clone() }.commands()?;
        if let Some(other) = self.asked.stages.iter().find(|given| !typed.programs.contains_key(&name(given))) {
            let problem = format!("--stage {other}: the run of {} has Crumple's own", self.crate_path().display());
            return Err(Usage::new(problem).hint("leave it out").into());
        }
        for (stage, known) in &mut typed.programs {
            let flag = Words(vec![format!("{stage}={}", known.typed)]);
            let refused = |found: String| {
                let names: Vec<&str> = known.files.keys().map(String::as_str).collect();
                let expected = format!("the program that made the run: {} ({})", known.typed, names.join(", "));
                Refused::new(found).expected(expected)
            };
            let is_given = self.asked.stages.iter().any(|given| name(given) == *stage);
            let Some(of_chain) = chain().map(|stage| stage.name).find(|name| name == stage).filter(|_| is_given) else {
                let found = format!("the stage {stage} was run by a program from elsewhere, which is not named here");
                let hint = format!("look at it, then {}", self.again(&flag, "--stage"));
                return Err(refused(found).hint(hint).into());
            };
            let given = commands.program(of_chain, &Words::default())?;
            let now: Vec<String> = given.files().map(|(_, digest)| digest).collect();
            if let Some((file, digest)) = known.files.iter().find(|(_, digest)| !now.contains(digest)) {
                let found = format!("{}: none of its files is {file} of {digest}", given.typed);
                return Err(refused(found).hint("put the program back as it was").into());
            }
            given.typed.clone_into(&mut known.typed);
        }
        Ok(typed)
    }

    /// The record that is run: that of the crate, else the one that was given, under the name that it had.
    fn record(&self) -> anyhow::Result<PathBuf> {
        let Contents { record, sidecar, .. } = self.contents;
        let own = self.folder.join(record.place());
        if record.is_inside {
            if let Some(given) = &self.asked.record {
                let problem = format!("--record {}: {} is in the crate", given.display(), record.name);
                return Err(Usage::new(problem).hint("leave it out").into());
            }
            self.refuse_another(&own, &own, sidecar.as_ref())?;
            return Ok(own);
        }
        let Some(given) = &self.asked.record else {
            let problem = format!("the record {} is not in {}", record.name, self.crate_path().display());
            return Err(Usage::new(problem).hint(self.again(&Words(vec![record.name.clone()]), "--record")).into());
        };
        // The files of a test stay where they are, and so do options that the crate has only the digest of.
        let stays = !is_one_file(given) || sidecar.as_ref().is_some_and(|sidecar| !sidecar.is_inside);
        if stays {
            self.refuse_another(given, given, sidecar.as_ref())?;
            return Ok(given.clone());
        }
        refuse_path_that_leaves(self.crate_path(), &record.place())?;
        let copy = || {
            fs::create_dir_all(own.parent().unwrap_or(self.folder))?;
            fs::hard_link(given.canonicalize()?, &own).or_else(|_| fs::copy(given, &own).map(drop))
        };
        copy().with_context(|| format!("cannot copy {}", given.display()))?;
        self.refuse_another(&own, given, sidecar.as_ref())?;
        Ok(own)
    }

    /// Errors: a record, or options beside it, that are not those of the crate. `given` is what errors call it.
    fn refuse_another(&self, path: &Path, given: &Path, sidecar: Option<&Item>) -> anyhow::Result<()> {
        let found = digests(path)?;
        let record = &self.contents.record;
        let refused = |what: String, stated: String, hint: &str| Refused::new(what).expected(stated).hint(hint);
        if record.content.as_deref() != Some(&found.record) {
            let what = format!("{} is another record: {}", given.display(), found.record);
            let stated = format!("{} of {}", record.name, record.content.as_deref().unwrap_or("no digest"));
            return Err(refused(what, stated, "give the record that the run was made from").into());
        }
        if found.name != record.name {
            let what = format!("the record is called {}", found.name);
            return Err(refused(what, record.name.clone(), "give it its name back: results hold it").into());
        }
        let stated = sidecar.and_then(Item::compared);
        if stated != found.sidecar.as_deref() {
            let what = format!("the options beside {}: {}", found.name, found.sidecar.as_deref().unwrap_or("none"));
            let stated = format!("as the run read them: {}", stated.unwrap_or("none"));
            return Err(refused(what, stated, "put the file as it was beside the record, or take it away").into());
        }
        Ok(())
    }

    /// Compares the results by content.
    fn compare(&self, run: &Path) -> anyhow::Result<ExitStatus> {
        let digest = |item: &Item| match &item.content {
            Some(_) => Artifact::open(&run.join(&item.name)).ok().map(|artifact| artifact.digest().to_owned()),
            None => digest_of(&run.join(&item.name)),
        };
        let results = &self.contents.results;
        let now: Vec<(&Item, Option<String>)> = results.iter().map(|item| (item, digest(item))).collect();
        let is_other = |(item, now): &&(&Item, Option<String>)| now.is_none() || item.compared() != now.as_deref();
        let others: Vec<_> = now.iter().filter(is_other).collect();
        let is_named = |name: &str| results.iter().any(|item| item.name == name);
        let made = chain().flat_map(|stage| stage.outputs).filter(|name| run.join(name).is_file());
        let unnamed: Vec<&str> = made.filter(|name| !is_named(name)).collect();
        let (record, count) = (&self.contents.record.name, results.len() + unnamed.len());
        if others.is_empty() && unnamed.is_empty() && count > 0 {
            let names: Vec<&str> = results.iter().map(|item| item.name.as_str()).collect();
            let text = format!("equal: {record} run again gives all {count} results: {}\n", names.join(", "));
            to_stdout(printable(&text).as_bytes())?;
            return Ok(ExitStatus::Done);
        }
        let mut text = format!("not equal: {} of {count} results of {record}\n", others.len() + unnamed.len());
        for (item, now) in others {
            let stated = item.compared().unwrap_or("no digest");
            text += &format!("  {}: {} now, {stated} in the crate\n", item.name, now.as_deref().unwrap_or("none"));
        }
        for name in unnamed {
            text += &format!("  {name}: made now, not named in the crate\n");
        }
        if self.contents.version != VERSION {
            text += &format!("  the crate is of Crumple {}, this is {VERSION}\n", self.contents.version);
        }
        not_equal(&text)
    }
}
