//! A fleet on a cluster of three nodes, one of which dies in mid-run. `just ci-full` runs it inside
//! `scripts/local-slurm.sh`, which says `SKIPPED` where there can be no Slurm.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crumple_testkit::fleet::{different_files, ended_runs, just_fleet, wait_for};
use crumple_testkit::made_fleet::write_fleet;

/// Records, those that hold none, and parts of the fleet.
const RECORDS: usize = 200;
const BROKEN: usize = 1;
const PARTS: usize = 9;
/// The cars of this test.
const SEED: u64 = 5;

/// What Slurm says of the jobs that run now: node and rule with its part, `rule_batch_wildcards_3`.
fn running_jobs() -> Vec<(String, String)> {
    let queue = Command::new("squeue").args(["--noheader", "--states=RUNNING", "--format=%N %k"]).output().unwrap();
    let queue = String::from_utf8_lossy(&queue.stdout).into_owned();
    queue.lines().filter_map(|line| line.split_once(' ')).map(|(node, job)| (node.into(), job.into())).collect()
}

#[test]
#[ignore = "needs a cluster: just ci-full starts one"]
fn a_fleet_outlives_a_node_that_dies() {
    let cluster = PathBuf::from(std::env::var_os("CRUMPLE_SLURM").expect("run inside scripts/local-slurm.sh"));
    let folder = tempfile::tempdir().unwrap();
    let [records, on_cluster, alone] = ["records", "cluster/fleet", "alone/fleet"].map(|name| folder.path().join(name));
    write_fleet(&records, RECORDS, BROKEN, SEED).unwrap();

    let mut command = just_fleet("fleet-slurm", &records, &on_cluster);
    command.arg(format!("batches={PARTS}")).args(["threads=1", "mem_mb=1000"]);
    command.args(["--slurm-init-seconds-before-status-checks", "5"]);
    let log = std::fs::File::create(folder.path().join("log")).unwrap();
    let mut fleet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log).spawn().unwrap();

    // A part that the second node is in the middle of.
    let (journal, before) = wait_for(&mut fleet, "part in the middle of its runs on node n2", || {
        running_jobs().into_iter().filter(|(node, _)| node == "n2").find_map(|(_, job)| {
            let journal = format!("journal/{}-of-{PARTS}.jsonl", job.strip_prefix("rule_batch_wildcards_")?);
            let ended = ended_runs(&on_cluster.join(&journal)).len();
            (3..10).contains(&ended).then_some((journal, ended))
        })
    });
    let node = std::fs::read_to_string(cluster.join("n2.pid")).unwrap();
    assert!(Command::new("kill").args(["-KILL", node.trim()]).status().unwrap().success());
    let status = fleet.wait().unwrap();
    let said = std::fs::read_to_string(folder.path().join("log")).unwrap();
    assert!(status.success(), "{said}");

    // Nodes of the jobs that ended well, and jobs that were lost with their node.
    let jobs = std::fs::read_to_string(cluster.join("log/jobs.txt")).unwrap();
    let field = |job: &str, name: &str| -> String {
        job.split(' ').find_map(|word| word.strip_prefix(name)?.strip_prefix('=')).unwrap_or_default().to_owned()
    };
    let mut nodes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for job in jobs.lines() {
        nodes.entry(field(job, "JobState")).or_default().insert(field(job, "NodeList"));
    }
    assert!(nodes["COMPLETED"].len() >= 2, "{jobs}");
    assert!(nodes.iter().any(|(state, nodes)| state != "COMPLETED" && nodes.contains("n2")), "{jobs}");

    // The part was done by another node, from where it was left, and nothing was run twice.
    let ended = ended_runs(&on_cluster.join(&journal));
    assert!(ended.len() > before + 1, "{journal}: {before} runs before the node died, {} in all", ended.len());
    let parts = (1..=PARTS).map(|part| on_cluster.join(format!("journal/{part}-of-{PARTS}.jsonl")));
    let all: Vec<String> = parts.flat_map(|journal| ended_runs(&journal)).collect();
    assert_eq!(all.len(), RECORDS + BROKEN);
    assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), RECORDS + BROKEN);

    // Tables, page and every file of every run, with no file beside them.
    let output = just_fleet("fleet", &records, &alone).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let different = different_files(&on_cluster, &alone);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(different.is_empty(), "{} files, for example {:?}; {said}", different.len(), &different[..1]);
    eprintln!(
        "{RECORDS} records, {BROKEN} broken, {PARTS} parts: {before} of {} runs of {journal} had ended when n2 died",
        ended.len()
    );
}
