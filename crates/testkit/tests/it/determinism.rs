//! Same input and configuration, same bytes, for any number of threads; and what `crumple-diff` says of it.

use std::path::Path;
use std::process::Command;

use crumple_artifact::{Artifact, ArtifactBuilder, Compression};
use crumple_signal::Sampled;
use crumple_testkit::pipeline::{ARTIFACTS, binary, code_and_error, just};

fn run_with_threads(folder: &Path, threads: &str) {
    let status = just()
        .env("RAYON_NUM_THREADS", threads)
        .arg(format!("out={}", folder.display()))
        .args(["run", "fixtures/noisy/crash.csv"])
        .output()
        .unwrap()
        .status;
    assert!(status.success());
}

#[test]
fn two_runs_and_any_number_of_threads_give_the_same_bytes() {
    let out = tempfile::tempdir().unwrap();
    let folders: Vec<_> = ["1", "1", "2", "4"]
        .iter()
        .enumerate()
        .map(|(k, threads)| {
            let folder = out.path().join(format!("run-{k}"));
            run_with_threads(&folder, threads);
            folder
        })
        .collect();
    for name in ARTIFACTS.iter().chain(&["report.html", "summary.json"]) {
        let first = std::fs::read(folders[0].join(name)).unwrap();
        for other in &folders[1..] {
            assert!(first == std::fs::read(other.join(name)).unwrap(), "{name} differs in {}", other.display());
        }
    }
    let (code, _) = code_and_error(Command::new(binary("crumple-diff")).args(&folders[..2]));
    assert_eq!(code, 0);
}

#[test]
fn a_second_run_leaves_every_artifact_alone() {
    let out = tempfile::tempdir().unwrap();
    run_with_threads(out.path(), "2");
    let times = |folder: &Path| -> Vec<_> {
        ARTIFACTS.iter().map(|name| folder.join(name).metadata().unwrap().modified().unwrap()).collect()
    };
    let before = times(out.path());
    run_with_threads(out.path(), "2");
    assert_eq!(before, times(out.path()));
}

/// A copy of an artifact with one sample of one waveform changed.
fn with_one_sample_changed(from: &Path, to: &Path, wave_id: &str, index: usize) {
    let artifact = Artifact::open(from).unwrap();
    let mut builder = ArtifactBuilder::new();
    for raw in artifact.records() {
        match raw.schema.as_str() {
            "crumple.Test.v1" => {
                let test: crumple_artifact::records::TestV1 = artifact.decode(raw).unwrap();
                builder.put(&raw.topic, &test).unwrap();
            }
            "crumple.ChannelFilter.v1" => {
                let filter: crumple_artifact::records::ChannelFilterV1 = artifact.decode(raw).unwrap();
                builder.put(&raw.topic, &filter).unwrap();
            }
            "crumple.Notes.v1" => {
                let notes: crumple_artifact::records::NotesV1 = artifact.decode(raw).unwrap();
                builder.put(&raw.topic, &notes).unwrap();
            }
            other => panic!("the filter stage writes {other}: add it here"),
        }
    }
    for (id, wave) in artifact.waves() {
        let mut samples = wave.sampled.samples().to_vec();
        if id == wave_id {
            samples[index] += 1.0;
        }
        let sampled = Sampled::new(wave.sampled.t0_s(), wave.sampled.dt_s(), samples).unwrap();
        builder.wave(id, wave.quantity, sampled).unwrap();
    }
    builder.write(to, artifact.provenance().unwrap(), Compression::None).unwrap();
}

#[test]
fn diff_names_the_first_difference_and_tells_trouble_from_difference() {
    let out = tempfile::tempdir().unwrap();
    run_with_threads(out.path(), "2");
    let good = out.path().join("2-filter.mcap");
    let changed = out.path().join("changed.mcap");
    with_one_sample_changed(&good, &changed, "accel_g", 1234);

    let diff = |a: &Path, b: &Path| {
        let output = Command::new(binary("crumple-diff")).args([a, b]).output().unwrap();
        let text = [output.stdout, output.stderr].concat();
        (output.status.code().unwrap(), String::from_utf8_lossy(&text).into_owned())
    };
    assert_eq!(diff(&good, &good).0, 0);
    let (code, text) = diff(&good, &changed);
    assert_eq!(code, 1, "{text}");
    let sample = Artifact::open(&good).unwrap().waves()["accel_g"].sampled.samples()[1234];
    for part in ["/wave/accel_g", "1234", &format!("{sample}"), &format!("{}", sample + 1.0)] {
        assert!(text.contains(part), "{part} is not named in: {text}");
    }

    let cut = out.path().join("cut.mcap");
    let bytes = std::fs::read(&good).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let (code, text) = diff(&good, &cut);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("truncated"), "{text}");
}
