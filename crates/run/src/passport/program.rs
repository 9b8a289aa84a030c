//! `crumple-passport`: what a run was made from and what it made, as a Workflow Run RO-Crate.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::Context;
use crumple_artifact::{Artifact, ReadError};
use crumple_stage::records::{IdentificationV1, SimulationV1, TestV1};
use crumple_stage::{
    ChainStage, ExitStatus, Pipeline, Refused, Usage, chain, keep_budget, program, refuse_a_mixture,
    results_of_an_earlier_run, say,
};

use super::asked::repeatable;
use super::contents::{Contents, Item, Role};
use super::crate_files::{Source, is_zip, write};
use super::metadata::{About, METADATA, Software, metadata};
use super::record::Record;
use crate::export::program::records;
use crate::folder::content::is_artifact;
use crate::program::digest_of;
use crate::recipe::{Typed, VERSION, place_of};

/// Writes what a run was made from and what it made as a Workflow Run RO-Crate, with digests of record, programs,
/// options and results.
///
/// The record, and results that hold or draw its samples, stay out: the crate has their digests. `crumple check
/// --passport` runs it again from the record and compares.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-passport",
    version,
    after_help = "Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused."
)]
pub struct PassportOptions {
    /// Folder of a run.
    #[arg(value_name = "RUN")]
    run: PathBuf,

    /// Folder, or zip archive, to write.
    #[arg(short, long, value_name = "FOLDER|FILE.zip", default_value = "passport.zip")]
    output: PathBuf,

    /// The record, and the results with its samples, go in too.
    #[arg(long)]
    with_record: bool,

    /// Where the record that goes in is [default: where it was, as seen from the run].
    #[arg(long, value_name = "RECORD", requires = "with_record")]
    record: Option<PathBuf>,

    /// License of the crate: an address such as https://spdx.org/licenses/CC-BY-4.0, or words.
    #[arg(long, value_name = "URL")]
    license: Option<String>,

    /// Day of publication [default: that of SOURCE_DATE_EPOCH, else today in UTC].
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = day)]
    date: Option<String>,

    /// Replace an archive that is there.
    #[arg(long)]
    force: bool,

    /// Do not say what goes out.
    #[arg(short, long)]
    quiet: bool,
}

/// Writes the passport of a run.
pub(crate) fn passport(options: PassportOptions) -> anyhow::Result<ExitStatus> {
    let run = &options.run;
    options.refuse_what_is_there()?;
    keep_budget(std::slice::from_ref(run), ExitStatus::Refused);
    let made = Made::read(run)?;
    let noted = made.pipeline.record().unwrap_or_default();
    let at = options.record.clone().or_else(|| place_of(run, noted).filter(|_| !noted.is_empty()));
    let record = Record::find(at, noted, &made.test.source, made.sidecar(), options.with_record)?;
    let (contents, files) = made.contents(&record, options.with_record)?;
    let (date, whose) = options.date();
    let about = About {
        date,
        license: options.license.clone(),
        pipeline: made.pipeline.name().unwrap_or_default().to_owned(),
        programs: made.programs(),
    };
    let mut all = vec![(METADATA.to_owned(), Source::Text(metadata(&contents, &about)))];
    all.extend(files.into_iter().map(|(place, path)| (place, Source::File(path))));
    write(&options.output, &all)?;
    if !options.quiet {
        options.say_what_goes_out(&contents, &all, &format!("dated {} ({whose})", about.date));
    }
    Ok(ExitStatus::Done)
}

impl PassportOptions {
    /// A folder keeps what an earlier crate left in it, which might be a record: it must be new.
    fn refuse_what_is_there(&self) -> Result<(), Usage> {
        let output = &self.output;
        let problem = format!("{} exists", output.display());
        if fs::read_dir(output).is_ok_and(|mut entries| entries.next().is_some()) {
            return Err(Usage::new(format!("{problem} and is not empty")).hint("name a new folder by -o"));
        }
        let is_file_for_a_folder = output.is_file() && !is_zip(output);
        if output.is_file() && !self.force || is_file_for_a_folder {
            let hint = if is_file_for_a_folder { "name a new folder by -o" } else { "name another by -o, or --force" };
            return Err(Usage::new(problem).hint(hint));
        }
        Ok(())
    }

    /// The day of publication, and whose it is. No program knows it of itself, and RO-Crate demands one.
    fn date(&self) -> (String, &'static str) {
        let of_build = std::env::var("SOURCE_DATE_EPOCH").ok().and_then(|seconds| seconds.parse().ok());
        match (&self.date, of_build) {
            (Some(typed), _) => (typed.clone(), "--date"),
            (None, Some(seconds)) => (day_of(seconds), "SOURCE_DATE_EPOCH"),
            (None, None) => {
                let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                (day_of(now.as_secs()), "today; --date fixes it")
            }
        }
    }

    fn say_what_goes_out(&self, contents: &Contents, files: &[(String, Source)], dated: &str) {
        let bytes: u64 = files.iter().map(|(_, source)| source.size()).sum();
        let names: Vec<&str> = files.iter().map(|(place, _)| place.as_str()).collect();
        let output = self.output.display();
        say(format_args!("{output}: {} files, {bytes} bytes leave {}", files.len(), self.run.display()));
        say(format_args!("  in the crate: {}", names.join(", ")));
        let out: Vec<&str> = contents.items().filter(|item| !item.is_inside).map(|item| item.name.as_str()).collect();
        if !out.is_empty() {
            say(format_args!("  only their digests: {}", out.join(", ")));
        }
        say(match self.with_record {
            true => "  the record and its samples are in the crate",
            false => "  the samples of the record are in none of these files; --with-record puts them in",
        });
        let license = self.license.as_deref().unwrap_or("none is stated, --license URL states one");
        say(format_args!("  {dated}; license: {license}"));
    }
}

/// A run as it lies in its folder.
struct Made {
    folder: PathBuf,
    pipeline: Pipeline,
    typed: Typed,
    /// In the order of the chain.
    artifacts: Vec<Artifact>,
    /// Names of all results.
    outputs: Vec<&'static str>,
    test: TestV1,
}

impl Made {
    fn read(folder: &Path) -> anyhow::Result<Self> {
        let refused = |problem: String| {
            Refused::new(problem)
                .expected("the folder of one whole run of a record")
                .hint(format!("{} RECORD makes the run again", program("run")))
        };
        if let Some(earlier) = results_of_an_earlier_run(folder) {
            return Err(refused(earlier).into());
        }
        let file = folder.join(Pipeline::OF_A_RUN);
        if !file.is_file() {
            return Err(refused(format!("{}: there is no {}", folder.display(), Pipeline::OF_A_RUN)).into());
        }
        let pipeline = Pipeline::read(&file, None)?;
        let stages: Vec<_> =
            chain().filter(|stage| !stage.is_optional || pipeline.table(stage.name).is_some()).collect();
        let outputs: Vec<&str> = stages.iter().flat_map(|stage| stage.outputs.iter().copied()).collect();
        if let Some(gone) = outputs.iter().find(|name| !folder.join(name).is_file()) {
            return Err(refused(format!("{}: there is no {gone}, which the run makes", folder.display())).into());
        }
        let open = |name: &&str| Artifact::open(&folder.join(name)).map_err(Refused::from);
        let artifacts: Vec<Artifact> =
            outputs.iter().filter(|name| is_artifact(name)).map(open).collect::<Result<_, _>>()?;
        refuse_a_mixture(&artifacts, |artifact| artifact.path().display().to_string())?;
        let ingested = artifacts.first().map(|ingested| ingested.record::<TestV1>("/test"));
        let test = ingested.transpose().map_err(Refused::from)?.flatten();
        let typed = repeatable(Typed::of(&pipeline)?, &file)?;
        let test = test.ok_or_else(|| refused(format!("{}: 1-ingest.mcap names no test", folder.display())))?;
        Ok(Self { folder: folder.to_owned(), pipeline, typed, artifacts, outputs, test })
    }

    /// The digest of the file of options beside the record, where the run read one.
    fn sidecar(&self) -> Option<&str> {
        let inputs = &self.artifacts.first()?.provenance()?.inputs;
        inputs.iter().find(|input| input.kind == "sidecar").map(|input| input.digest.as_str())
    }

    /// The artifact of a stage; the report has none.
    fn artifact(&self, stage: &ChainStage) -> Option<&Artifact> {
        self.artifacts.iter().find(|artifact| artifact.path().ends_with(stage.outputs[0]))
    }

    /// The stages that ran.
    fn stages(&self) -> impl Iterator<Item = ChainStage> {
        chain().filter(|stage| self.outputs.contains(&stage.outputs[0]))
    }

    fn programs(&self) -> Vec<Software> {
        let software = |stage: ChainStage| {
            let made = self.artifact(&stage).and_then(Artifact::provenance);
            let (version, build) = made.map_or(("", ""), |made| (made.stage_version.as_str(), made.build.as_str()));
            let Some(foreign) = self.typed.programs.get(stage.name) else {
                return Software::own(stage.name, if version.is_empty() { VERSION } else { version }, build);
            };
            let digests = foreign.files.iter().map(|(name, digest)| (format!("BLAKE3 of {name}"), digest.clone()));
            let (command, digests) = (Some(foreign.typed.clone()), digests.collect());
            Software { stage: stage.name, command, version: version.to_owned(), digests }
        };
        self.stages().map(software).collect()
    }

    /// Results whose numbers, or whose drawings, are the samples of the record.
    ///
    /// The first three stages write what was measured, and the page draws it. Elsewhere a waveform with the name of a
    /// channel is one of the test, and the motion of a model that a measured waveform drives gives that back.
    fn with_samples(&self) -> Result<BTreeSet<&'static str>, Refused> {
        let channels: Vec<&str> = self.test.channels.iter().map(|channel| channel.id.as_str()).collect();
        let of_channel = |id: &String| {
            let rest = channels.iter().filter_map(|channel| id.strip_prefix(channel));
            rest.clone().any(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let mut names = BTreeSet::from(["report.html"]);
        for stage in self.stages() {
            let Some(artifact) = self.artifact(&stage) else { continue };
            let is_measured = ["ingest", "filter", "integrate"].contains(&stage.name);
            if is_measured || artifact.waves().keys().any(of_channel) || is_driven(artifact)? {
                names.insert(stage.outputs[0]);
            }
        }
        Ok(names)
    }

    /// What the passport says of the files, and which of them go in, by their places.
    fn contents(&self, record: &Record, with_record: bool) -> anyhow::Result<(Contents, Vec<(String, PathBuf)>)> {
        let mut files = Vec::new();
        let mut own = |name: &str, content: Option<&str>, is_inside: bool| -> anyhow::Result<Item> {
            let path = self.folder.join(name);
            let cannot = || format!("cannot read {}", path.display());
            let item = Item {
                name: name.to_owned(),
                role: Role::Own,
                size: Some(fs::metadata(&path).with_context(cannot)?.len()),
                bytes: Some(digest_of(&path).with_context(cannot)?),
                content: content.map(str::to_owned),
                is_inside,
            };
            if is_inside {
                files.push((item.place(), path));
            }
            Ok(item)
        };
        let with_samples = self.with_samples()?;
        let pipeline = own(Pipeline::OF_A_RUN, None, true)?;
        let mut results = Vec::new();
        for name in &self.outputs {
            let artifact = self.artifacts.iter().find(|artifact| artifact.path().ends_with(name));
            let is_inside = with_record || !with_samples.contains(name);
            results.push(own(name, artifact.map(Artifact::digest), is_inside)?);
        }
        for (item, path) in [(Some(&record.item), &record.path), (record.sidecar.as_ref(), &record.sidecar_path)] {
            if let (Some(item), Some(path)) = (item.filter(|item| item.is_inside), path) {
                files.push((item.place(), path.clone()));
            }
        }
        let own = self.stages().filter(|stage| !self.typed.programs.contains_key(stage.name));
        let version = own.filter_map(|stage| self.artifact(&stage)?.provenance().cloned()).next();
        let version = version.map_or_else(|| VERSION.to_owned(), |made| made.stage_version);
        let (record, sidecar) = (record.item.clone(), record.sidecar.clone());
        Ok((Contents { version, pipeline, record, sidecar, results }, files))
    }
}

/// Whether a measured waveform drove one of its models.
fn is_driven(artifact: &Artifact) -> Result<bool, ReadError> {
    let one = std::slice::from_ref(artifact);
    let simulated = records::<SimulationV1>(one, "/simulation/")?;
    let identified = records::<IdentificationV1>(one, "/identification/")?;
    Ok(simulated.iter().any(|(_, of)| of.drive.is_some()) || identified.iter().any(|(_, of)| !of.inputs.is_empty()))
}

/// Days from 1970 to 2500.
const DAYS: u64 = 193_580;

/// A day as ISO 8601 writes it.
fn day(typed: &str) -> Result<String, String> {
    let is_digits = |part: &str, count: usize| part.len() == count && part.bytes().all(|b| b.is_ascii_digit());
    let parts: Vec<&str> = typed.split('-').collect();
    let is_written = parts.len() == 3 && parts.iter().zip([4, 2, 2]).all(|(part, count)| is_digits(part, count));
    // Every day of the calendar until 2500 is one of these.
    let is_day = is_written && (0..=DAYS).any(|day| day_of(day * 86_400) == typed);
    if is_day { Ok(typed.to_owned()) } else { Err(format!("{typed:?} is no day, expected e.g. 2026-11-30")) }
}

/// The day of a time, seconds since 1970-01-01 UTC: the proleptic Gregorian calendar in eras of 400 years that begin in
/// March (Hinnant, "chrono-Compatible Low-Level Date Algorithms").
fn day_of(seconds: u64) -> String {
    let days = seconds / 86_400 + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    format!("{:04}-{month:02}-{day:02}", year + 400 * era + u64::from(month <= 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        // By `date -u -d @SECONDS +%F`.
        let days = [
            (0, "1970-01-01"),
            (951_782_400, "2000-02-29"),
            (1_796_083_199, "2026-11-30"),
            (4_107_542_400, "2100-03-01"),
        ];
        for (seconds, expected) in days {
            assert_eq!(day_of(seconds), expected);
        }
        assert!(day("2026-11-30").is_ok());
        for wrong in [
            "2026-+1-01",
            "2026-1-011",
            "+026-01-01",
            "2026-02-31",
            "2026-13-01",
            "2026-1-1",
            "30.11.2026",
            "2026-11-32",
            "26-11-2030",
        ] {
            assert!(day(wrong).is_err(), "{wrong}");
        }
    }
}
