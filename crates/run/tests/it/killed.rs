//! A run that is killed at any moment leaves no results of two records.

use std::fs::File;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Instant;

use crate::chain::{Chain, RESULTS, Stages};

/// Moments at which a run is killed; `CRUMPLE_KILLS` states another number.
fn kills() -> u32 {
    std::env::var("CRUMPLE_KILLS").ok().and_then(|number| number.parse().ok()).unwrap_or(15)
}

/// Kills runs of `b` over a finished run of `a`, spread over the time that one takes.
fn kill_at_many_moments(stages: Stages, whole_group: bool) {
    let chain = Chain::new(stages);
    assert!(chain.run("a").status().unwrap().success());
    let started = Instant::now();
    assert!(chain.run("b").status().unwrap().success());
    let duration = started.elapsed();
    let mut unfinished = 0;
    for kill in 0..kills() {
        assert!(chain.run("a").status().unwrap().success());
        chain.assert_whole("a");
        let mut run = chain.run("b").stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        sleep(duration.mul_f64(f64::from(kill) / f64::from(kills())));
        if whole_group {
            let group = format!("kill -KILL -{}", run.id());
            Command::new("sh").args(["-c", &group]).stderr(Stdio::null()).status().unwrap();
        } else {
            run.kill().unwrap();
        }
        run.wait().unwrap();
        // A stage that still runs keeps the folder locked.
        File::open(chain.folder()).unwrap().lock().unwrap();
        chain.assert_unmixed(&format!("{stages:?}, group {whole_group}, kill {kill}"));
        unfinished += u32::from(RESULTS.iter().any(|name| !chain.folder().join(name).exists()));
    }
    assert!(unfinished > 0, "no run was killed on its way");
    assert!(chain.run("b").status().unwrap().success());
    chain.assert_whole("b");
}

#[test]
fn a_killed_run_leaves_no_mixture() {
    kill_at_many_moments(Stages::Own, false);
}

#[test]
fn a_run_killed_with_its_stages_leaves_no_mixture() {
    kill_at_many_moments(Stages::Own, true);
}

#[test]
fn a_killed_run_of_programs_from_elsewhere_leaves_no_mixture() {
    kill_at_many_moments(Stages::Foreign, false);
}

#[test]
fn a_run_killed_with_programs_from_elsewhere_leaves_no_mixture() {
    kill_at_many_moments(Stages::Foreign, true);
}
