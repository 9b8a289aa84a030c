//! Kits of stages: a working program in one of five languages, its test, and the contract of its place in the chain.

use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use crumple_stage::{ExitStatus, Usage, say, unknown_name};

/// A language that the program of a kit is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Language {
    /// With the package crumple, which brings numpy.
    Python,
    /// With awk, grep and sed.
    Shell,
    /// Octave 7 or later, without packages.
    Octave,
    /// Without packages.
    R,
    /// Julia 1.6 or later, without packages.
    Julia,
}

/// What the programs of a language are called and started by.
struct Tools {
    name: &'static str,
    /// Ending of the files.
    ending: &'static str,
    /// What starts a program.
    command: &'static str,
    /// Reads and writes artifacts; empty where a package does.
    artifact: &'static str,
}

impl Language {
    fn tools(self) -> Tools {
        match self {
            Self::Python => Tools { name: "Python", ending: "py", command: "python3", artifact: "" },
            Self::Shell => {
                Tools { name: "shell", ending: "sh", command: "sh", artifact: include_str!("../kit/shell/artifact.sh") }
            }
            // It complains about its history where nobody types.
            Self::Octave => Tools {
                name: "Octave",
                ending: "m",
                command: "octave-cli --no-history",
                artifact: include_str!("../kit/octave/artifact.m"),
            },
            Self::R => {
                Tools { name: "R", ending: "R", command: "Rscript", artifact: include_str!("../kit/r/artifact.R") }
            }
            Self::Julia => Tools {
                name: "Julia",
                ending: "jl",
                command: "julia",
                artifact: include_str!("../kit/julia/artifact.jl"),
            },
        }
    }
}

/// What a kit is made of.
struct Kit {
    stage: &'static str,
    /// What its place in the chain asks of a stage.
    contract: &'static str,
    /// Its program in each language, in the order of [`Language`].
    programs: [&'static str; 5],
}

/// The files of a stage below `kit/`.
macro_rules! kit {
    ($stage:literal) => {
        Kit {
            stage: $stage,
            contract: include_str!(concat!("../kit/contract/", $stage, ".md")),
            programs: [
                include_str!(concat!("../kit/python/", $stage, ".py")),
                include_str!(concat!("../kit/shell/", $stage, ".sh")),
                include_str!(concat!("../kit/octave/", $stage, ".m")),
                include_str!(concat!("../kit/r/", $stage, ".R")),
                include_str!(concat!("../kit/julia/", $stage, ".jl")),
            ],
        }
    };
}

static KITS: [Kit; 6] =
    [kit!("filter"), kit!("integrate"), kit!("identify"), kit!("parameter-solve"), kit!("simulate"), kit!("predict")];

/// What a run asks of every stage.
const EVERY_STAGE: &str = include_str!("../kit/contract/every-stage.md");

const TEST: &str = include_str!("../kit/test.sh");

impl Kit {
    /// The kit of a stage. Errors: there is none.
    fn of(stage: &str) -> anyhow::Result<&'static Self> {
        let names = KITS.each_ref().map(|kit| kit.stage);
        let without = |reason: &str| {
            Usage::new(format!("there is no kit for {stage}: it {reason}"))
                .hint(format!("there are kits for {}", names.join(", ")))
        };
        match stage {
            "ingest" => Err(without("reads a record, not an artifact").into()),
            "report" => Err(without("writes a page, not an artifact").into()),
            _ => KITS
                .iter()
                .find(|kit| kit.stage == stage)
                .ok_or_else(|| unknown_name(&format!("crumple has no stage {stage:?}"), stage, &names)),
        }
    }

    /// Names and contents of the files.
    fn files(&self, language: Language) -> Vec<(String, String)> {
        let tools = language.tools();
        let test = TEST.replace("NAME", self.stage).replace("COMMAND", tools.command).replace("ENDING", tools.ending);
        let contract = format!("# {} in {}\n{}\n{EVERY_STAGE}", self.stage, tools.name, self.contract);
        let mut files = vec![
            (format!("stage.{}", tools.ending), self.programs[language as usize].to_owned()),
            ("test.sh".to_owned(), test),
            ("CONTRACT.md".to_owned(), contract),
        ];
        if !tools.artifact.is_empty() {
            files.insert(1, (format!("artifact.{}", tools.ending), tools.artifact.to_owned()));
        }
        files
    }
}

/// Writes the kit of a stage into a folder, and says how to test and to use it.
///
/// Errors: no kit for the stage, a file of that name that is there, a folder that cannot be written.
pub(crate) fn new_stage(stage: &str, language: Language, folder: Option<PathBuf>) -> anyhow::Result<ExitStatus> {
    let kit = Kit::of(stage)?;
    let folder = folder.unwrap_or_else(|| format!("my-{stage}").into());
    let files = kit.files(language);
    if let Some(path) = files.iter().map(|(name, _)| folder.join(name)).find(|path| path.symlink_metadata().is_ok()) {
        return Err(Usage::new(format!("{} exists", path.display())).hint("name another folder: -o FOLDER").into());
    }
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    for (name, text) in &files {
        let path = folder.join(name);
        File::create_new(&path)
            .and_then(|mut file| file.write_all(text.as_bytes()))
            .with_context(|| format!("cannot write {}", path.display()))?;
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let tools = language.tools();
    say(format_args!("{}: {}", folder.display(), names.join(", ")));
    let file = |name: &str| shell_words::quote(&folder.join(name).display().to_string()).into_owned();
    say(format_args!("test it  sh {} RECORD", file("test.sh")));
    let program = format!("{} {}", tools.command, file(&format!("stage.{}", tools.ending)));
    say(format_args!("use it   crumple run RECORD --stage {stage}={}", shell_words::quote(&program)));
    Ok(ExitStatus::Done)
}

#[cfg(test)]
mod tests {
    use clap::ValueEnum;

    use super::*;

    #[test]
    fn a_kit_has_a_program_its_test_and_its_contract() {
        for kit in &KITS {
            for &language in Language::value_variants() {
                let files = kit.files(language);
                let ending = language.tools().ending;
                let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
                assert_eq!(names[0], format!("stage.{ending}"));
                assert_eq!(names.contains(&format!("artifact.{ending}").as_str()), language != Language::Python);
                let [(_, test), (_, contract)] = &files[files.len() - 2..] else { panic!("{names:?}") };
                assert!(test.contains(&format!("--stage {}=", kit.stage)), "{test}");
                assert!(["COMMAND", "ENDING", "NAME"].iter().all(|place| !test.contains(place)), "{test}");
                assert!(contract.lines().count() <= 60, "{contract}");
            }
        }
    }

    #[test]
    fn stages_without_a_kit_are_refused_with_those_that_have_one() {
        for stage in ["ingest", "report", "filtre"] {
            let error = Kit::of(stage).map(|kit| kit.stage).unwrap_err();
            assert_eq!(error.downcast_ref::<Usage>().map(|_| ()), Some(()), "{error}");
        }
    }
}
