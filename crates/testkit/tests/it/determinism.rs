//! Same input and configuration, same bytes, for any number of threads; and what `crumple-diff` says of it.

use std::f64::consts::PI;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use crumple_artifact::{Artifact, ArtifactBuilder, Compression};
use crumple_signal::Sampled;
use crumple_testkit::programs::{ARTIFACTS, binary, code_and_error, just, number, summary_of};

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
        let first = fs::read(folders[0].join(name)).unwrap();
        for other in &folders[1..] {
            assert!(first == fs::read(other.join(name)).unwrap(), "{name} differs in {}", other.display());
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
            "crumple.Quality.v1" => {
                let quality: crumple_artifact::records::QualityV1 = artifact.decode(raw).unwrap();
                builder.put(&raw.topic, &quality).unwrap();
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
        let output = Command::new(binary("crumple-diff")).args([a, b]).arg("--rounding").output().unwrap();
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
    let bytes = fs::read(&good).unwrap();
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let (code, text) = diff(&good, &cut);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("truncated"), "{text}");
}

/// A crash at 50 km/h: the motion of a car against its front, the engine's stop, a vibration above the class.
fn record(folder: &Path, rate_hz: u32) -> std::path::PathBuf {
    let mut text = String::from("# mass: 1200 kg\n# impact speed: 50 km/h\ntime [s],acceleration [m/s^2]\n");
    let (slow, fast) = (2.0 * PI * 4.2, 2.0 * PI * 18.0);
    for k in 0..=rate_hz / 5 {
        let t = f64::from(k) / f64::from(rate_hz) - 0.05;
        let acceleration = if t > 0.0 {
            -50.0 / 3.6 * slow * (-1.5 * t).exp() * (slow * t).sin()
                - 60.0 * (-14.0 * t).exp() * (fast * t).sin()
                - 45.0 * (-30.0 * t).exp() * (2.0 * PI * 610.0 * t).sin()
        } else {
            0.0
        };
        writeln!(text, "{t:.6},{acceleration:.9}").unwrap();
    }
    let path = folder.join(format!("crash-{rate_hz}.csv"));
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn the_same_crash_at_any_rate_has_the_same_results_and_files_of_one_size() {
    let folder = tempfile::tempdir().unwrap();
    let run = |rate_hz: u32| {
        let out = folder.path().join(rate_hz.to_string());
        let summary = summary_of(&["flags=-q"], &out, &record(folder.path(), rate_hz), &[]);
        let size = |name: &str| fs::metadata(out.join(name)).unwrap().len() as f64;
        (summary, ["2-filter.mcap", "3-integrate.mcap", "6-simulate.mcap"].map(size))
    };
    let (ordinary, sizes) = run(10_000);
    for rate_hz in [100_000, 1_000_000] {
        let (other, other_sizes) = run(rate_hz);
        // Rounding of the interval.
        let stated = number(&other, &["test", "sample_rate_hz"]);
        assert!((stated / f64::from(rate_hz) - 1.0).abs() < 1e-12, "{stated}");
        // The filter of a class is not quite the same at 10 kHz, by the bilinear transform: 5e-4 at its edge.
        for key in ["dynamic_crush_m", "time_of_dynamic_crush_s", "rebound_velocity_m_per_s", "delta_v_m_per_s"] {
            let (a, b) = (number(&ordinary, &["events", key]), number(&other, &["events", key]));
            assert!((a / b - 1.0).abs() < 5e-5, "{rate_hz} Hz, {key}: {a} {b}");
        }
        let kelvin = |summary: &serde_json::Value| {
            let candidates = summary["candidates"].as_array().unwrap().clone();
            let kelvin = candidates.into_iter().find(|c| c["id"] == "kelvin/direct-fit/1").unwrap();
            ["stiffness_n_per_m", "damping_n_s_per_m"].map(|name| number(&kelvin, &["parameters", name]))
        };
        for (a, b) in kelvin(&ordinary).into_iter().zip(kelvin(&other)) {
            assert!((a / b - 1.0).abs() < 1e-3, "{rate_hz} Hz: {a} {b}");
        }
        assert_eq!(ordinary["recommended"], other["recommended"]);
        let schema_bytes = crumple_artifact::schema_json("crumple.Remarks.v1").unwrap().len() as f64;
        for (a, b) in sizes.into_iter().zip(other_sizes) {
            // A stage that remarks nothing writes no /remarks, and not the schema of that record either.
            assert!((b - a).abs() < 0.1 * a + schema_bytes, "{rate_hz} Hz: {a} and {b} bytes");
        }
    }
}
