//! How a program ended on a file, and how many ended in which way.

use std::collections::BTreeMap;
use std::fmt;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

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
pub fn ending_of(program: &Path, arguments: &[&str], folder: &Path) -> (Ending, String) {
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
