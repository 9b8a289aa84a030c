//! `crumple-testkit`: holds the programs against what is known, makes fixtures and fleets. `just` calls it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use crumple_testkit::atlas::{self, Atlas, Found};
use crumple_testkit::benchmark as performance;
use crumple_testkit::bytes::{Difference, compare, write_digests};
use crumple_testkit::calibration::{self, Condition, Ranks};
use crumple_testkit::contact_cover;
use crumple_testkit::fixture::fixtures;
use crumple_testkit::fuzz::{Campaign, Tally, run_campaign, run_simulations};
use crumple_testkit::identification_cover::{self, AMBIENT, right_clusters};
use crumple_testkit::instructions::{self, Counts};
use crumple_testkit::interval_cover::{Choices, Cover, DRAWN, FAMILIES, choices_of, cover_of, write_cars};
use crumple_testkit::made_fleet::write_fleet;
use crumple_testkit::prediction_error::{KINDS, outcomes, tables};
use crumple_testkit::truth::{self, Explained, Extent, Net, RunCase, cases};
use crumple_testkit::{Errors, simulated, workspace};

/// The made fleet is the same every time.
const SEED: u64 = 17;

/// Exit code 1: something differs, ends as it may not, or contradicts the truth; 2: it could not be found out.
#[derive(Debug, Parser)]
#[command(about = "Holds the programs against what is known, makes fixtures and fleets")]
enum Command {
    /// Published figures beside what the programs give, into docs/atlas.md and ci/atlas.json; exit 1 where a hit is
    /// lost
    Atlas {
        #[command(flatten)]
        programs: Programs,
    },
    /// Digests of everything that the programs write, or what differs between two lists of them
    Bytes(Bytes),
    /// Ranks of the truth in the posteriors behind intervals, into docs/calibration.md
    ///
    /// Exit 1 where of a model of one mass without a ring surely fewer than 95 % of the truths lie in the middle 95 %.
    Calibration {
        #[command(flatten)]
        programs: Programs,
        /// Records a family and condition
        #[arg(long, default_value_t = 50)]
        records: usize,
        /// Print the table and leave the page
        #[arg(long)]
        print: bool,
        /// Parts of names of families and kinds; the page needs all
        #[arg(requires = "print")]
        family: Vec<String>,
    },
    /// Mutated files and tampered artifacts, each read by the program that it is meant for, and for every ten of them a
    /// plausible record through the whole chain; the files stay in FOLDER
    Fuzz {
        #[command(flatten)]
        programs: Programs,
        #[arg(long, default_value_os_t = workspace().join("target/fuzz"))]
        folder: PathBuf,
        /// Number of each
        #[arg(long, default_value_t = 1000)]
        files: u64,
        /// Number of the first
        #[arg(long, default_value_t = 0)]
        first: u64,
        /// Files of simulations alone, with what is read of them
        #[arg(long)]
        simulations: bool,
    },
    /// How often nominal 90 % intervals of identified modes hold the truth, as Markdown, and of how many ambient
    /// records of a building the modes found are its own and no others
    IdentificationBenchmark {
        #[command(flatten)]
        programs: Programs,
        /// Records a kind; a fifth of them are ambient
        #[arg(long, default_value_t = 100)]
        records: usize,
        /// Number of the first
        #[arg(long, default_value_t = 0)]
        first: usize,
        /// Parts of names of kinds
        kind: Vec<String>,
    },
    /// How often 95 % intervals of fitted parameters hold the truth and how wide they are, as Markdown
    ///
    /// Intervals of parameters that their record determines, as the report says it, stand apart from other closed ones
    /// and from open ones.
    IntervalBenchmark(IntervalBenchmark),
    /// Instructions of whole runs by stage, counted by callgrind, into docs/performance.md; exit 1 where a stage takes
    /// more than what is accepted
    Instructions {
        #[command(flatten)]
        programs: Programs,
        /// Counts that are accepted
        #[arg(long, default_value_os_t = workspace().join("ci/instructions.json"))]
        accepted: PathBuf,
        /// Write these counts there
        #[arg(long)]
        accept: bool,
        /// Folder of what callgrind counted of the benchmarks
        #[arg(long)]
        kernels: Option<PathBuf>,
        /// Words of names of records; with them the page stays as it is
        record: Vec<String>,
    },
    /// Writes records of cars of a model with known parameters, and those parameters
    MakeCars {
        folder: PathBuf,
        records: usize,
        /// The model
        #[arg(long, default_value = "kelvin")]
        family: String,
    },
    /// Writes the fixtures
    MakeFixtures {
        #[arg(default_value_os_t = workspace().join("fixtures"))]
        folder: PathBuf,
    },
    /// Writes a binout of many nodes
    MakeBinout {
        file: PathBuf,
        #[arg(default_value_t = 10_000)]
        nodes: u64,
        #[arg(default_value_t = 1050)]
        states: usize,
    },
    /// Writes records of a made fleet
    MakeFleet {
        folder: PathBuf,
        records: usize,
        /// Records that cannot be read
        #[arg(default_value_t = 0)]
        broken: usize,
    },
    /// Times a Python script that does the same job and `crumple run` in turns
    Peer {
        #[command(flatten)]
        programs: Programs,
        /// Python with pandas, scipy and matplotlib
        python: PathBuf,
        #[arg(long, default_value_t = 5)]
        turns: usize,
    },
    /// Times whole runs, and writes them and the figures of the kernels into docs/performance.md
    Performance {
        #[command(flatten)]
        programs: Programs,
        /// What the benchmarks collected
        figures: PathBuf,
    },
    /// How far predictions of other tests are off, as Markdown
    PredictionBenchmark(PredictionBenchmark),
    /// Values of runs, of their remarks and every number people see, compared with the known truth of the records
    ///
    /// Prints what was compared, how often intervals hold the truth, what contradicts it, which codes were raised, and
    /// why the others were not.
    Truth {
        #[command(flatten)]
        programs: Programs,
        /// Made cars a family and kind
        #[arg(long, default_value_t = 4)]
        cars: usize,
        #[arg(long)]
        short: bool,
        /// Parts of names of runs
        name: Vec<String>,
    },
}

#[derive(Debug, clap::Args)]
struct Programs {
    /// Folder of the programs
    #[arg(long, default_value_os_t = workspace().join("target/release"), value_parser = absolute)]
    bin: PathBuf,
}

fn absolute(path: &str) -> Result<PathBuf, std::io::Error> {
    std::path::absolute(path)
}

#[derive(Debug, clap::Args)]
struct Bytes {
    #[command(flatten)]
    programs: Programs,
    /// The list; what the programs write lies beside it with the ending .cases meanwhile
    #[arg(default_value_os_t = workspace().join("target/bytes.txt"))]
    out: PathBuf,
    /// Two lists
    #[arg(long, num_args = 2, value_names = ["A", "B"], conflicts_with = "out")]
    compare: Vec<PathBuf>,
    /// Only texts and content count
    #[arg(long, requires = "compare", conflicts_with = "masked")]
    content: bool,
    /// Only content counts
    #[arg(long, requires = "compare")]
    masked: bool,
}

#[derive(Debug, clap::Args)]
struct IntervalBenchmark {
    #[command(flatten)]
    programs: Programs,
    /// How often the model that the record was made of, or one that the record cannot tell from it, is recommended or
    /// the simplest
    #[arg(long)]
    choice: bool,
    /// How often intervals of crush, its time and delta-v hold the truth, wherever contact lies in the file
    #[arg(long)]
    contact: bool,
    /// Records whose trigger and stated speed have no error, behind a filter without phase
    #[arg(long)]
    clean: bool,
    /// Every interval without the truth too, on stderr
    #[arg(long)]
    misses: bool,
    #[arg(long, default_value_t = 300)]
    records: usize,
    /// Number of the first record: another one draws other cars
    #[arg(long, default_value_t = 0)]
    first: usize,
    /// Parts of names of families
    family: Vec<String>,
}

#[derive(Debug, clap::Args)]
struct PredictionBenchmark {
    #[command(flatten)]
    programs: Programs,
    /// Made cars a kind
    #[arg(long, default_value_t = 50)]
    cars: usize,
    /// Number of the first car
    #[arg(long, default_value_t = 0)]
    first: usize,
    /// Speeds in km/h at which each car is tested; several are joined to one model
    #[arg(long, value_delimiter = ',', default_value = "56")]
    tests: Vec<f64>,
    /// What every candidate predicts too
    #[arg(long)]
    candidates: bool,
    /// Leave the records and artifacts of every car here
    #[arg(long, value_name = "FOLDER")]
    keep: Option<PathBuf>,
    /// Parts of names of kinds
    kind: Vec<String>,
}

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match run(Command::parse()) {
        Ok(is_right) => ExitCode::from(u8::from(!is_right)),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// Whether all is as it should be.
fn run(command: Command) -> Result<bool, Failure> {
    match command {
        Command::Atlas { programs } => write_atlas(&programs.bin),
        Command::Bytes(asked) if asked.compare.is_empty() => {
            let digests = write_digests(&asked.programs.bin, &asked.out.with_extension("cases"))?;
            std::fs::write(&asked.out, &digests)?;
            eprintln!("{} digests: {}", digests.lines().count(), asked.out.display());
            Ok(true)
        }
        Command::Bytes(asked) => report_differences(&asked),
        Command::Calibration { programs, records, print, family } => calibrate(&programs.bin, records, print, &family),
        Command::Fuzz { programs, folder, files, first, simulations } => {
            let campaign = Campaign { bin: programs.bin, folder, first, files };
            if simulations {
                let tally = run_simulations(&campaign, &mut |line| println!("{line}"))?;
                println!("mutated simulations: {tally}");
                return Ok(tally.not_allowed() == 0);
            }
            let tallies = run_campaign(&campaign, &mut |line| println!("{line}"))?;
            let [mutated, tampered, plausible] = &tallies;
            println!("mutated files: {mutated}\ntampered artifacts: {tampered}\nplausible records: {plausible}");
            Ok(tallies.iter().map(Tally::not_allowed).sum::<usize>() == 0)
        }
        Command::IdentificationBenchmark { programs, records, first, kind } => {
            identification_benchmark(&programs.bin, (first, records), &kind)
        }
        Command::IntervalBenchmark(asked) => interval_benchmark(&asked),
        Command::MakeBinout { file, nodes, states } => {
            let mut out = std::io::BufWriter::new(std::fs::File::create(&file)?);
            simulated::write_large_binout(&mut out, nodes, states)?;
            Ok(true)
        }
        Command::MakeCars { folder, records, family } => {
            write_cars(&folder, &family, records)?;
            Ok(true)
        }
        Command::MakeFixtures { folder } => {
            for fixture in fixtures()? {
                let target = folder.join(fixture.name);
                std::fs::create_dir_all(&target)?;
                std::fs::write(target.join("crash.csv"), &fixture.csv)?;
                std::fs::write(target.join("truth.json"), fixture.truth_text())?;
            }
            Ok(true)
        }
        Command::MakeFleet { folder, records, broken } => {
            write_fleet(&folder, records, broken, SEED).map_err(|error| format!("{}: {error}", folder.display()))?;
            Ok(true)
        }
        Command::Instructions { programs, accepted, accept, kernels, record } => {
            let folder = own_folder("crumple-instructions");
            let runs = instructions::runs(&programs.bin, &record, &folder)?;
            std::fs::remove_dir_all(&folder)?;
            let kernels = kernels.as_deref().map(instructions::kernels).transpose()?.unwrap_or_default();
            judge_instructions(Counts { runs, kernels }, &accepted, accept, record.is_empty())
        }
        Command::Peer { programs, python, turns } => {
            print!("{}", performance::beside_peer(&programs.bin.join("crumple"), &python, turns.max(1))?);
            Ok(true)
        }
        Command::Performance { programs, figures } => write_performance(&programs.bin, &figures),
        Command::PredictionBenchmark(asked) => prediction_benchmark(&asked),
        Command::Truth { programs, cars, short, name } => {
            hold_against_truth(&programs.bin, if short { Extent::Short } else { Extent::Long(cars) }, &name)
        }
    }
}

/// Writes the atlas; whether every earlier hit is one still.
fn write_atlas(bin: &Path) -> Result<bool, Failure> {
    let (path, folder, atlas) = (workspace().join("ci/atlas.json"), own_folder("atlas"), Atlas::read()?);
    let before: Vec<Found> = match std::fs::read(&path) {
        Ok(bytes) => serde_json::from_slice(&bytes)?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(format!("{}: {error}", path.display()).into()),
    };
    let found = atlas::found(&atlas, bin, &folder).map_err(|error| error.to_string())?;
    std::fs::remove_dir_all(&folder)?;
    std::fs::write(&path, serde_json::to_string_pretty(&found)? + "\n")?;
    std::fs::write(workspace().join("docs/atlas.md"), atlas::page(&atlas, &found))?;
    let lost = atlas::lost(&before, &found);
    lost.iter().for_each(|one| println!("no hit any more: {} of {}", one.figure, one.of));
    Ok(lost.is_empty())
}

/// Whether the posteriors of models of one mass hold without a ring: they are those that a run recommends.
fn calibrate(bin: &Path, records: usize, print: bool, wanted: &[String]) -> Result<bool, Failure> {
    let (folder, pipeline) = (own_folder("calibration"), workspace().join("pipelines/default.toml"));
    let all = calibration::ranks_of(&|name| is_asked(wanted, name), &(0..records), (bin, &pipeline), &folder)?;
    std::fs::remove_dir_all(&folder)?;
    let page = calibration::page(&all, records);
    if print {
        println!("{page}");
    } else {
        std::fs::write(workspace().join("docs/calibration.md"), page)?;
        std::fs::write(workspace().join("docs/images/calibration.svg"), calibration::drawing(&all))?;
    }
    let is_judged = |ranks: &&Ranks| ranks.is_simple && ranks.condition == Condition::Laboratory;
    let misleading: Vec<&Ranks> = all.iter().filter(is_judged).filter(|ranks| ranks.misleads()).collect();
    misleading.iter().for_each(|one| println!("misleads: {} of {} ({})", one.number, one.of, one.condition.words()));
    Ok(misleading.is_empty())
}

fn write_performance(bin: &Path, figures: &Path) -> Result<bool, Failure> {
    let lines = std::fs::read_to_string(figures)?;
    let figures = lines.lines().map(serde_json::from_str).collect::<Result<Vec<_>, _>>()?;
    write_between((performance::BEGIN, performance::END), &performance::tables(&bin.join("crumple"), &figures)?)?;
    Ok(true)
}

/// Writes what stands between two comments of docs/performance.md.
fn write_between((begin, end): (&str, &str), text: &str) -> Result<(), Failure> {
    let path = workspace().join("docs/performance.md");
    let page = std::fs::read_to_string(&path)?;
    let (head, rest) = page.split_once(begin).ok_or(format!("docs/performance.md: {begin:?} is not there"))?;
    let (_, foot) = rest.split_once(end).ok_or(format!("docs/performance.md: {end:?} is not there"))?;
    Ok(std::fs::write(&path, format!("{head}{begin}\n{text}{end}{foot}"))?)
}

/// Prints the table of counts and what became slower; whether nothing did.
fn judge_instructions(counts: Counts, accepted: &Path, accept: bool, are_all: bool) -> Result<bool, Failure> {
    let before: Counts = match std::fs::read(accepted) {
        Ok(bytes) => serde_json::from_slice(&bytes)?,
        Err(error) if accept && error.kind() == std::io::ErrorKind::NotFound => Counts::default(),
        Err(error) => return Err(format!("{}: {error}; --accept writes it", accepted.display()).into()),
    };
    let table = instructions::table(&counts, &before);
    print!("{table}");
    let slower = if accept { Vec::new() } else { instructions::slower(&counts, &before) };
    slower.iter().for_each(|line| println!("{line}"));
    if are_all {
        write_between((instructions::BEGIN, instructions::END), &table)?;
    }
    if accept {
        let runs = before.runs.into_iter().chain(counts.runs).collect();
        let all = Counts { runs, kernels: before.kernels.into_iter().chain(counts.kernels).collect() };
        std::fs::write(accepted, serde_json::to_string_pretty(&all)? + "\n")?;
    }
    Ok(slower.is_empty())
}

/// Whether a name has one of these parts, or none is asked for.
fn is_asked(wanted: &[String], name: &str) -> bool {
    wanted.is_empty() || wanted.iter().any(|part| name.contains(part.as_str()))
}

fn own_folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("{name}-{}", std::process::id()))
}

/// Names every difference; whether none counts.
fn report_differences(asked: &Bytes) -> Result<bool, Failure> {
    let least = match (asked.content, asked.masked) {
        (true, _) => Difference::Texts,
        (_, true) => Difference::Content,
        _ => Difference::AroundContent,
    };
    let (first, second) = (std::fs::read_to_string(&asked.compare[0])?, std::fs::read_to_string(&asked.compare[1])?);
    let differences = compare(&first, &second)?;
    for (file, difference) in &differences {
        println!("{difference}: {file}");
    }
    let counted = differences.iter().filter(|(_, difference)| *difference >= least).count();
    println!("{} of {} lines differ, {counted} of them count", differences.len(), first.lines().count());
    Ok(counted == 0)
}

fn identification_benchmark(bin: &Path, (first, records): (usize, usize), wanted: &[String]) -> Result<bool, Failure> {
    let folder = own_folder("identification-benchmark");
    println!("{}", identification_cover::HEAD);
    for kind in identification_cover::KINDS.iter().filter(|kind| is_asked(wanted, kind.name)) {
        let cover = identification_cover::cover_of(kind, first..first + records, (bin, &folder))?;
        print!("{}", identification_cover::rows(kind, &cover));
    }
    if is_asked(wanted, AMBIENT) {
        let ambient = records.div_ceil(5);
        let right = right_clusters(first..first + ambient, (bin, &folder))?;
        println!("\n{AMBIENT}: the five modes of the building and no others in {right} of {ambient} records");
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(true)
}

fn interval_benchmark(asked: &IntervalBenchmark) -> Result<bool, Failure> {
    let IntervalBenchmark { programs, choice, contact, clean, misses, records, first, family: wanted } = asked;
    let (bin, records, folder) = (programs.bin.as_path(), *first..first + records, own_folder("interval-benchmark"));
    let names: Vec<&str> = match (choice, contact) {
        (_, true) => contact_cover::KINDS.iter().map(|kind| kind.name).collect(),
        (true, _) => DRAWN.iter().map(|drawn| drawn.name).collect(),
        _ => FAMILIES.iter().map(|family| family.name).collect(),
    };
    if !names.iter().any(|name| is_asked(wanted, name)) {
        return Err(format!("no family has {} in its name; there are: {}", wanted.join(", "), names.join("; ")).into());
    }
    let pipeline = workspace().join("pipelines/default.toml");
    let errors = if *clean { Errors::Few } else { Errors::Laboratory };
    if *contact {
        println!("{}", contact_cover::HEAD);
        for kind in contact_cover::KINDS.iter().filter(|kind| is_asked(wanted, kind.name)) {
            let held = contact_cover::cover_of(kind, records.clone(), (bin, &pipeline), &folder, *misses)?;
            println!("{}", held.row(kind.name));
        }
    } else if *choice {
        println!("{}", Choices::HEAD);
        for drawn in DRAWN.iter().filter(|drawn| is_asked(wanted, drawn.name)) {
            print!("{}", choices_of(drawn, records.clone(), errors, (bin, &pipeline), &folder)?.row(drawn.name));
        }
    } else {
        println!("{}", Cover::HEAD);
        for family in FAMILIES.iter().filter(|family| is_asked(wanted, family.name)) {
            let cover = cover_of(family, records.clone(), errors, (bin, &folder))?;
            print!("{}", cover.rows(family.name));
            cover.misses.iter().filter(|_| *misses).for_each(|miss| eprintln!("{miss}"));
        }
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(true)
}

fn prediction_benchmark(asked: &PredictionBenchmark) -> Result<bool, Failure> {
    let PredictionBenchmark { programs, cars, first, tests, candidates, keep, kind: wanted } = asked;
    let folder = keep.clone().unwrap_or_else(|| own_folder("prediction-benchmark"));
    let pipeline = workspace().join("pipelines/default.toml");
    let kinds: Vec<_> = KINDS.iter().filter(|kind| is_asked(wanted, kind.name)).collect();
    if kinds.is_empty() {
        return Err(format!("no kind has one of these in its name: {}", wanted.join(", ")).into());
    }
    let cars = *first..first + cars;
    print!("{}", tables(&outcomes(&kinds, &cars, (tests, *candidates), (&programs.bin, &pipeline), &folder)?));
    if keep.is_none() {
        std::fs::remove_dir_all(&folder)?;
    }
    Ok(true)
}

fn hold_against_truth(bin: &Path, extent: Extent, wanted: &[String]) -> Result<bool, Failure> {
    let folder = own_folder("truth");
    std::fs::create_dir_all(&folder)?;
    let all = cases(extent, &folder).map_err(|error| error.to_string())?;
    let asked: Vec<&RunCase> = all.iter().filter(|case| is_asked(wanted, &case.name)).collect();
    let runs = truth::run_all(&asked, bin, &folder);
    std::fs::remove_dir_all(&folder)?;
    let failed = runs.iter().filter_map(|run| run.as_ref().err()).inspect(|error| eprintln!("error: {error}")).count();
    let are_all = wanted.is_empty() && extent.is_full();
    let mut net = Net::new(Explained::by(bin).map_err(|error| error.to_string())?, are_all);
    runs.iter().flatten().for_each(|made| net.read(made));
    print!("{}", net.table());
    Ok(failed == 0 && net.holds())
}
