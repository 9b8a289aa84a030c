//! A campaign: so many files, each read by the program that it is meant for.

use std::collections::BTreeMap;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fmt, fs, thread};

use crumple_artifact::{Artifact, JsonForm};

use crate::fuzz::plausible::run_chain;
use crate::fuzz::tampering::{Dice, mutate, tamper};
use crate::places::{shared, workspace};

/// What a campaign does.
#[derive(Debug, Clone)]
pub struct Campaign {
    /// Folder of the programs.
    pub bin: PathBuf,
    /// Folder to work in; files on which a program ended as it may not stay in it.
    pub folder: PathBuf,
    /// Number of the first file; the same number makes the same file.
    pub first: u64,
    /// Number of files of each sort.
    pub files: u64,
}

/// The sound files that changes are made of.
struct Corpus {
    /// Records of tests, for ingest.
    records: Vec<PathBuf>,
    /// Artifacts of one run, in the order of its stages.
    run: Vec<PathBuf>,
}

/// Sets of simulations: binout, texts and curves of LS-DYNA, T01 and its tables.
const SIMULATIONS: [&str; 3] =
    ["s1-same-car", "s2-middle-of-the-front-too-stiff", "s3-openradioss-engine-mount-too-soft"];

impl Corpus {
    fn new() -> Self {
        let fixtures = workspace().join("fixtures");
        let mut records: Vec<PathBuf> =
            ["kelvin", "double"].iter().map(|name| fixtures.join(name).join("crash.csv")).collect();
        let golden = fixtures.join("double/golden");
        let stages =
            ["1-ingest", "2-filter", "3-integrate", "4-identify", "5-parameter-solve", "6-simulate", "7-predict"];
        let run: Vec<PathBuf> = stages.iter().map(|stage| golden.join(format!("{stage}.mcap"))).collect();
        records.push(run[0].clone());
        let folders = [Some(workspace().join("fuzz/corpus/record")), shared("reference/hostile")];
        let folders = folders.into_iter().flatten().map(|folder| (folder, 100_000));
        let simulations =
            SIMULATIONS.into_iter().filter_map(|set| Some((shared("reference/simulation")?.join(set), 2_000_000)));
        records.extend(folders.chain(simulations).flat_map(|(folder, most)| {
            let files = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
            let mut files: Vec<PathBuf> =
                files.filter(|file| file.metadata().is_ok_and(|m| m.len() < most)).map(|file| file.path()).collect();
            files.sort();
            files
        }));
        records.retain(|path| path.is_file());
        Self { records, run }
    }
}

/// Files of each sort for every record that goes through the whole chain.
const FILES_OF_A_CHAIN: u64 = 10;

/// Runs a campaign; `tell` hears of every file on which a program ended as it may not.
///
/// Returns how the programs ended on mutated files, on tampered artifacts, and on plausible records in the whole chain,
/// one for every ten files.
///
/// # Errors
/// Of the disk, in words.
pub fn run_campaign(campaign: &Campaign, tell: &mut dyn FnMut(String)) -> Result<[Tally; 3], String> {
    let corpus = Corpus::new();
    fs::create_dir_all(&campaign.folder).map_err(|error| format!("{}: {error}", campaign.folder.display()))?;
    let [mut of_files, mut of_artifacts, mut of_chains] = [Tally::default(), Tally::default(), Tally::default()];
    for number in campaign.first..campaign.first + campaign.files {
        for (sort, tally) in [&mut of_files, &mut of_artifacts].into_iter().enumerate() {
            let mut dice = Dice::new(2 * number + sort as u64);
            let trial = if sort == 0 { mutated(&corpus, &mut dice)? } else { tampered(&corpus, &mut dice)? };
            let (ending, said) = trial.run(campaign)?;
            tally.add(ending);
            if !ending.is_allowed() {
                let kept = campaign.folder.join(format!("{number}-{}-{}", ["mutated", "tampered"][sort], trial.name));
                fs::write(&kept, &trial.bytes).map_err(|error| format!("{}: {error}", kept.display()))?;
                let first = said.lines().next().unwrap_or_default();
                tell(format!("{ending}: {} {} ({first}): {}", trial.program, trial.words.join(" "), kept.display()));
            }
        }
        if number.is_multiple_of(FILES_OF_A_CHAIN) {
            let (ending, said, record) = run_chain(campaign, number)?;
            of_chains.add(ending);
            if !ending.is_allowed() {
                let first = said.lines().next().unwrap_or_default();
                tell(format!("{ending}: {record} ({first}): {}", campaign.folder.display()));
            }
        }
    }
    Ok([of_files, of_artifacts, of_chains])
}

/// A file and the program that reads it.
struct Trial {
    /// Name of the file.
    name: String,
    bytes: Vec<u8>,
    program: &'static str,
    /// The arguments; `FILE` stands for the file, `OUT` for what is written.
    words: Vec<String>,
    /// Where the file was an artifact with its own checksums: the digest that a program may accept.
    only_digest: Option<String>,
}

impl Trial {
    fn run(&self, campaign: &Campaign) -> Result<(Ending, String), String> {
        let (file, out) = (campaign.folder.join(&self.name), campaign.folder.join("out.mcap"));
        fs::write(&file, &self.bytes).map_err(|error| format!("{}: {error}", file.display()))?;
        let _ = fs::remove_file(&out);
        let place = |word: &String| match word.as_str() {
            "FILE" => file.display().to_string(),
            "OUT" => out.display().to_string(),
            other => other.to_owned(),
        };
        let words: Vec<String> = self.words.iter().map(place).collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (mut ending, said) = ending_of(&campaign.bin.join(self.program), &words, &campaign.folder);
        if self.program == "crumple-diff" && ending == Ending::Unforeseen {
            // to this program: different
            ending = Ending::Code(1);
        }
        if ending == Ending::Code(0) && !(self.accepts(&file) && is_sound(&out)) {
            ending = Ending::WrongResult;
        }
        let _ = fs::remove_file(&file);
        let _ = fs::remove_dir_all(campaign.folder.join("plain"));
        Ok((ending, said))
    }

    fn accepts(&self, file: &Path) -> bool {
        self.only_digest
            .as_ref()
            .is_none_or(|digest| Artifact::open(file).is_ok_and(|artifact| artifact.digest() == digest))
    }
}

/// Whether what was written can be read, every record of it; also where nothing was written.
pub(super) fn is_sound(out: &Path) -> bool {
    !out.exists()
        || Artifact::open(out)
            .is_ok_and(|artifact| artifact.records().iter().all(|raw| artifact.json_text(raw, JsonForm::Line).is_ok()))
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn words(text: &str) -> Vec<String> {
    text.split(' ').map(str::to_owned).collect()
}

/// Files of any kind with changed bytes.
fn mutated(corpus: &Corpus, dice: &mut Dice) -> Result<Trial, String> {
    let fixtures = workspace().join("fixtures/double/golden");
    let other = |name: &str| fixtures.join(name).display().to_string();
    let (path, program, arguments) = match dice.below(8) {
        0..=3 => {
            let path = dice.one_of(&corpus.records).clone();
            let flags = *dice.one_of(&[
                "",
                " --list",
                " --units mm-ms-kg --node 1000001",
                " --mass 900kg --impact-speed 50km/h",
                " --field a.b --unit g",
            ]);
            (path, "crumple-ingest", format!("FILE -o OUT{flags}"))
        }
        4 => {
            let command = *dice.one_of(&["check FILE", "show FILE", "unpack FILE plain"]);
            (dice.one_of(&corpus.run).clone(), "crumple-artifact", command.to_owned())
        }
        5 => {
            let path = workspace().join("pipelines/default.toml");
            (path, "crumple-filter", format!("{} -o OUT --pipeline FILE", other("1-ingest.mcap")))
        }
        6 => (fixtures.join("summary.json"), "crumple-diff", format!("FILE {}", other("summary.json"))),
        _ => {
            let path = workspace().join("docs/examples/tolerance.toml");
            (path, "crumple-diff", format!("{0} {0} --tolerance FILE", other("3-integrate.mcap")))
        }
    };
    let (name, mut bytes) = if path.is_file() {
        (path.file_name().unwrap_or_default().to_string_lossy().into_owned(), read(&path)?)
    } else {
        (
            "tolerance.toml".to_owned(),
            b"\"/wave/*\" = { abs = 1e-6, rel = 1e-6 }\n\"/metrics\" = { rel = 1e-3 }\n".to_vec(),
        )
    };
    let digest = || Artifact::read(&path, bytes.as_slice()).ok().map(|artifact| artifact.digest().to_owned());
    let only_digest = if program == "crumple-artifact" { digest() } else { None };
    mutate(&mut bytes, dice);
    Ok(Trial { name, bytes, program, words: words(&arguments), only_digest })
}

/// Artifacts of a run with lies inside, for the stage that reads them.
fn tampered(corpus: &Corpus, dice: &mut Dice) -> Result<Trial, String> {
    let stage = dice.below(corpus.run.len());
    let path = &corpus.run[stage];
    let others = |of: &[usize]| -> String {
        let names: Vec<String> =
            of.iter().map(|k| if *k == stage { "FILE".into() } else { corpus.run[*k].display().to_string() }).collect();
        names.join(" ")
    };
    let readers: [(&str, &[usize]); 6] = [
        ("crumple-filter", &[0]),
        ("crumple-integrate", &[1]),
        ("crumple-identify", &[1, 2]),
        ("crumple-simulate", &[1, 2, 4]),
        ("crumple-predict", &[2, 4]),
        ("crumple-report", &[0, 1, 2, 3, 4, 5, 6]),
    ];
    let fitting: Vec<_> = readers.iter().filter(|(_, inputs)| inputs.contains(&stage)).collect();
    let (program, arguments) = match dice.below(6) {
        0 => ("crumple-artifact", "check FILE".to_owned()),
        1 => ("crumple-artifact", "show FILE".to_owned()),
        2 => ("crumple-diff", format!("FILE {}", path.display())),
        _ => {
            let (program, inputs) = dice.one_of(&fitting);
            let output = if *program == "crumple-report" { "report.html" } else { "OUT" };
            (*program, format!("{} -o {output}", others(inputs)))
        }
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let bytes = tamper(&read(path)?, dice)?;
    Ok(Trial { name, bytes, program, words: words(&arguments), only_digest: None })
}

/// Longest a program may work on a small file: time of the processor, all threads, so that other work on the machine
/// does not count.
const WORK_S: u64 = 10;
/// Longest it may take with what it waits for.
const PATIENCE: Duration = Duration::from_secs(120);
/// Address space a program may take, KiB: its budget, its code, its threads, what the allocator keeps.
const ADDRESS_SPACE_KIB: u64 = 3 << 20;
/// Budget of every program.
const BUDGET: &str = "512MiB";

/// How a program ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ending {
    /// By an exit code of the contract: 0, 2, 3 or 4; 1 of `crumple-diff`.
    Code(i32),
    /// By the exit code 1 of what was not foreseen.
    Unforeseen,
    /// By a panic or a signal.
    Aborted,
    /// Beyond its budget of memory and its own refusal of that.
    OverMemory,
    /// Stopped: it worked for more than 10 s.
    TooLong,
    /// With exit code 0 and a result that is damaged, not finite, or another one than that of the sound file.
    WrongResult,
}

impl Ending {
    /// Whether it is what a user may expect of a program.
    pub fn is_allowed(self) -> bool {
        matches!(self, Self::Code(_))
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(code) => write!(f, "exit code {code}"),
            Self::Unforeseen => f.write_str("exit code 1"),
            Self::Aborted => f.write_str("aborted"),
            Self::OverMemory => f.write_str("over the memory limit"),
            Self::TooLong => f.write_str("over 10 s"),
            Self::WrongResult => f.write_str("wrong result with exit code 0"),
        }
    }
}

/// How many ended in which way.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Tally(pub BTreeMap<Ending, usize>);

impl Tally {
    /// Counts one more.
    pub fn add(&mut self, ending: Ending) {
        *self.0.entry(ending).or_default() += 1;
    }

    /// How many ended as they may not.
    pub fn not_allowed(&self) -> usize {
        self.0.iter().filter(|(ending, _)| !ending.is_allowed()).map(|(_, count)| count).sum()
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = self.0.iter().map(|(ending, count)| format!("{count} {ending}")).collect();
        write!(f, "{} runs: {}", self.0.values().sum::<usize>(), parts.join(", "))
    }
}

/// Runs a program in `folder` and returns how it ended, with what it said.
pub(super) fn ending_of(program: &Path, arguments: &[&str], folder: &Path) -> (Ending, String) {
    // The limit of the shell catches what the program's own count does not see.
    let script = format!("ulimit -v {ADDRESS_SPACE_KIB}; ulimit -t {WORK_S}; exec \"$0\" \"$@\"");
    let mut child = Command::new("sh")
        .args(["-c", &script])
        .arg(program)
        .args(arguments)
        .args(["--memory-limit", BUDGET])
        .current_dir(folder)
        .env_remove("RUST_BACKTRACE")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{}: {error}", program.display()));
    let mut stderr = child.stderr.take();
    let said = thread::spawn(move || {
        let mut said = Vec::new();
        let _ = stderr.as_mut().map(|pipe| pipe.read_to_end(&mut said));
        String::from_utf8_lossy(&said).into_owned()
    });
    let ending = wait(&mut child);
    let said = said.join().unwrap_or_default();
    let over = ending == Ending::Aborted && said.contains("memory allocation of");
    (if over { Ending::OverMemory } else { ending }, said)
}

fn wait(child: &mut Child) -> Ending {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => {
                return match (status.code(), status.signal()) {
                    (Some(1), _) => Ending::Unforeseen,
                    (Some(code @ (0 | 2 | 3 | 4)), _) => Ending::Code(code),
                    // The shell's limit of time sends SIGXCPU at first, then SIGKILL.
                    (_, Some(9 | 24)) => Ending::TooLong,
                    _ => Ending::Aborted,
                };
            }
            Ok(None) if start.elapsed() > PATIENCE => {
                let _ = child.kill();
                let _ = child.wait();
                return Ending::TooLong;
            }
            _ => thread::sleep(Duration::from_millis(2)),
        }
    }
}
