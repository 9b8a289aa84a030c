//! Two runs into one folder.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

use crate::chain::{Chain, Stages, said};

/// A run whose identify says by a file that it works, and waits until it is let go.
fn held_in_identify() -> Chain {
    let chain = Chain::new(Stages::Foreign);
    // The folder of the records has a name that a shell takes apart.
    let quoted = |name: &str| format!("'{}'", beside(&chain, name).display().to_string().replace('\'', "'\\''"));
    let (at_work, let_go) = (quoted("at-work"), quoted("let-go"));
    let wait = format!("touch {at_work}\nwhile [ ! -e {let_go} ]; do sleep 0.05; done\nexec \"$@\"\n");
    std::fs::write(beside(&chain, "wait.sh"), wait).unwrap();
    let command = format!("sh {} {}", quoted("wait.sh"), chain.command("4-identify.mcap"));
    chain.with("4-identify.mcap", &command)
}

/// A file beside the records.
fn beside(chain: &Chain, name: &str) -> PathBuf {
    chain.record("a").with_file_name(name)
}

/// Until identify itself works: the files of the stage before it are there while nothing holds the lock but the run.
fn wait_for_identify(chain: &Chain, run: &mut Child) {
    while !beside(chain, "at-work").exists() {
        if let Some(status) = run.try_wait().unwrap() {
            panic!("the run has ended ({status}): {}", first_line(run));
        }
        sleep(Duration::from_millis(5));
    }
}

/// The first line that a run says.
fn first_line(run: &mut Child) -> String {
    let mut line = String::new();
    BufReader::new(run.stderr.take().unwrap()).read_line(&mut line).unwrap();
    line
}

#[test]
fn ten_pairs_of_simultaneous_runs_end_well_and_unmixed() {
    for pair in 0..10 {
        let chain = Chain::new(if pair % 2 == 0 { Stages::Own } else { Stages::Foreign });
        let [a, b] = ["a", "b"].map(|record| chain.run(record).spawn().unwrap());
        for run in [a, b] {
            let output = run.wait_with_output().unwrap();
            assert!(output.status.success(), "pair {pair}: {}", said(&output));
        }
        let last = if chain.contents()["report.html"].ends_with('a') { "a" } else { "b" };
        chain.assert_whole(last);
    }
}

#[test]
fn the_second_run_says_for_whom_it_waits_and_goes_on_after_it() {
    let chain = held_in_identify();
    let mut first = chain.run("a").spawn().unwrap();
    wait_for_identify(&chain, &mut first);
    let mut second = chain.run("b").spawn().unwrap();
    let line = first_line(&mut second);
    let expected = format!("waiting for process {}, which runs {}", first.id(), chain.record("a").display());
    assert!(line.starts_with(&expected), "{line}");
    std::fs::write(beside(&chain, "let-go"), "").unwrap();
    assert!(second.wait().unwrap().success());
    assert!(first.wait().unwrap().success(), "the first was not disturbed");
    chain.assert_whole("b");
}

#[test]
fn a_lock_dies_with_its_last_holder() {
    let chain = held_in_identify();
    let mut first = chain.run("a").spawn().unwrap();
    wait_for_identify(&chain, &mut first);
    first.kill().unwrap();
    first.wait().unwrap();
    // The stage of the killed run still works: nobody else may write.
    let fast = Chain::new(Stages::Foreign);
    let mut second = fast.run_into(&chain.folder(), &chain.record("b")).spawn().unwrap();
    let line = first_line(&mut second);
    assert!(
        line.starts_with("waiting for process ") && line.contains("left over from a run that was killed"),
        "{line}"
    );
    let group = format!("kill -KILL -{}", first.id());
    assert!(Command::new("sh").args(["-c", &group]).status().unwrap().success());
    assert!(second.wait().unwrap().success());
    chain.assert_whole("b");
}
