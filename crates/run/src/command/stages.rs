//! The stages as they are written on the command line: `--stage COMMAND INPUT... -o OUTPUT`, in the order of the run.

use clap::{Arg, ArgAction, ArgMatches, Command};

/// Stands for the record and the flags after it among the inputs of a stage.
pub(crate) const RECORD: &str = "RECORD";

/// One stage of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stage {
    /// The program and flags of its own, as typed into a shell.
    pub(crate) command: String,
    /// Names in the run folder, or [`RECORD`].
    pub(crate) inputs: Vec<String>,
    /// Names in the run folder; the program is told the first.
    pub(crate) outputs: Vec<String>,
}

impl Stage {
    /// Its output.
    pub(crate) fn output(&self) -> &str {
        self.outputs.first().map_or("", String::as_str)
    }

    /// Its name, which its output has too: `4-identify.mcap` is written by `identify`.
    pub(crate) fn name(&self) -> &str {
        let output = self.output();
        let stem = output.rsplit_once('.').map_or(output, |(stem, _)| stem);
        match stem.split_once('-') {
            Some((number, name)) if number.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => stem,
        }
    }

    /// Whether it writes an artifact, not a report.
    pub(crate) fn writes_an_artifact(&self) -> bool {
        self.output().ends_with(".mcap")
    }
}

/// All stages of the run.
#[derive(Debug, Clone)]
pub struct Stages(pub(crate) Vec<Stage>);

impl Stages {
    /// Names of what is made from the output of a stage, directly or not, in the order in which it is to be removed:
    /// the report first, which says the most, then the artifacts from the last one on.
    pub(crate) fn dependents(&self, stage: usize) -> impl Iterator<Item = &str> {
        self.0.iter().skip(stage + 1).rev().flat_map(|later| later.outputs.iter().map(String::as_str))
    }

    /// The stages that are in use, without what the others would have written among their inputs; and the outputs of
    /// the others.
    pub(crate) fn in_use(&self, is_in_use: impl Fn(&str) -> bool) -> (Self, Vec<String>) {
        let (used, others): (Vec<Stage>, Vec<Stage>) = self.0.iter().cloned().partition(|s| is_in_use(s.name()));
        let left_out: Vec<String> = others.into_iter().flat_map(|stage| stage.outputs).collect();
        let without = |mut stage: Stage| {
            stage.inputs.retain(|input| !left_out.contains(input));
            stage
        };
        (Self(used.into_iter().map(without).collect()), left_out)
    }

    /// Names of all outputs.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = &str> {
        self.0.iter().flat_map(|stage| stage.outputs.iter().map(String::as_str))
    }
}

impl clap::Args for Stages {
    fn augment_args(command: Command) -> Command {
        let stage = Arg::new("stage")
            .long("stage")
            .num_args(2..)
            .action(ArgAction::Append)
            .required(true)
            .value_names(["COMMAND", "INPUT"])
            .help(
                "A stage: its program, with flags of its own in the same word, and what it reads from the run folder; \
                 RECORD stands for the record",
            );
        let output = Arg::new("output")
            .short('o')
            .num_args(1..)
            .action(ArgAction::Append)
            .required(true)
            .value_name("OUTPUT")
            .help(
                "What that stage writes into the run folder; it is told the first name and writes the others beside it",
            );
        command.arg(stage).arg(output)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl clap::FromArgMatches for Stages {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let texts = |id: &str| -> Vec<Vec<String>> {
            let occurrences = matches.get_occurrences::<String>(id).into_iter().flatten();
            occurrences.map(|values| values.cloned().collect()).collect()
        };
        let (stages, outputs) = (texts("stage"), texts("output"));
        if stages.len() != outputs.len() {
            let problem = "every --stage needs one -o, behind its inputs\n";
            return Err(clap::Error::raw(clap::error::ErrorKind::WrongNumberOfValues, problem));
        }
        let stages = stages.into_iter().zip(outputs).filter_map(|(words, outputs)| {
            let mut words = words.into_iter();
            Some(Stage { command: words.next()?, inputs: words.collect(), outputs })
        });
        Ok(Self(stages.collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use clap::FromArgMatches;

    use super::*;

    fn parsed(words: &[&str]) -> Result<Stages, clap::Error> {
        let command = <Stages as clap::Args>::augment_args(Command::new("run"));
        Stages::from_arg_matches(&command.try_get_matches_from([&["run"], words].concat())?)
    }

    #[test]
    fn stages_stand_one_after_another_each_with_its_output() {
        let words = ["--stage", "read -x", "RECORD", "-o", "1-ingest.mcap"];
        let report = ["--stage", "show", "1-ingest.mcap", "-o", "report.html", "summary.json"];
        let stages = parsed(&[&words[..], &report].concat()).unwrap();
        let [ingest, report] = &stages.0[..] else { panic!("{stages:?}") };
        assert_eq!((ingest.command.as_str(), ingest.name(), ingest.writes_an_artifact()), ("read -x", "ingest", true));
        assert_eq!((report.inputs.as_slice(), report.name()), (&["1-ingest.mcap".to_owned()][..], "report"));
        assert_eq!(stages.dependents(0).collect::<Vec<_>>(), ["report.html", "summary.json"]);
        assert_eq!(stages.dependents(1).count(), 0);
        let (without, left_out) = Stages(stages.0.clone()).in_use(|name| name != "ingest");
        assert_eq!((without.0.len(), without.0[0].inputs.len(), left_out), (1, 0, vec!["1-ingest.mcap".to_owned()]));
        assert!(parsed(&["--stage", "a", "b", "--stage", "c", "d", "-o", "e"]).is_err());
    }
}
