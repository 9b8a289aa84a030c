//! The program on artifacts: what it reads, what it writes, what it refuses.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crumple_artifact::records::{ChannelFilterV1, NotesV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_signal::{Channel, FilterSettings, QuantityKind, Sampled, TestDescription, filter};
use crumple_testkit::programs::Program;

/// A half-sine pulse of 20 g over 100 ms on a zero level of 2 m/s².
fn pulse(rate_hz: f64) -> Sampled {
    let dt_s = 1.0 / rate_hz;
    let samples = (0..(0.3 / dt_s) as usize).map(|k| k as f64 * dt_s - 0.05).map(|t| {
        let inside = (0.0..=0.1).contains(&t);
        2.0 - if inside { 196.133 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 }
    });
    Sampled::new(-0.05, dt_s, samples.collect()).unwrap()
}

fn channel(id: &str, location: &str, cfc: Option<u16>) -> Channel {
    Channel { location: location.to_owned(), cfc, ..Channel::new(id, QuantityKind::Acceleration) }
}

/// Writes what ingest would have written.
fn ingested(folder: &Path, channels: &[(Channel, Sampled)]) -> PathBuf {
    let test = TestDescription {
        title: "a test".to_owned(),
        pulse: Some(channels[0].0.id.clone()),
        channels: channels.iter().map(|(channel, _)| channel.clone()).collect(),
        ..TestDescription::default()
    };
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test)).unwrap();
    for (channel, samples) in channels {
        builder.wave(&channel.id, channel.quantity, samples.clone()).unwrap();
    }
    let path = folder.join("1-ingest.mcap");
    builder.write(&path, &Provenance::new("ingest", "0", "{}".to_owned(), vec![]), Compression::None).unwrap();
    path
}

const PROGRAM: Program = Program { exe: env!("CARGO_BIN_EXE_crumple-filter"), output: "2-filter.mcap" };

fn run(input: &Path, flags: &[&str]) -> Output {
    PROGRAM.run(input, flags)
}

fn result(input: &Path, flags: &[&str]) -> Artifact {
    Artifact::open(&PROGRAM.written(input, flags)).unwrap()
}

#[test]
fn writes_the_structure_s_channels_with_their_class_and_how_they_got_it() {
    let folder = tempfile::tempdir().unwrap();
    let raw = pulse(10_000.0);
    let input = ingested(
        folder.path(),
        &[
            (channel("093", "vehicle, rear seat crossmember", None), raw.clone()),
            (channel("097", "vehicle, sill", Some(60)), raw.clone()),
            (channel("001", "driver, head", None), raw.clone()),
        ],
    );
    let artifact = result(&input, &[]);
    assert_eq!(artifact.waves().keys().collect::<Vec<_>>(), ["001", "093", "097"]);
    let expected = filter(&raw, None, &FilterSettings::default()).unwrap();
    assert_eq!(artifact.waves()["093"].sampled, expected.samples);

    let test: TestV1 = artifact.record("/test").unwrap().unwrap();
    let classes: Vec<_> = test.channels.iter().map(|channel| channel.cfc).collect();
    assert_eq!(classes, [Some(60), Some(60), Some(1000)]);
    let how: ChannelFilterV1 = artifact.record("/filter/093").unwrap().unwrap();
    assert_eq!((how.cfc, how.mode.as_str(), how.samples_added), (Some(60), "iso6487", 100));
    // The mean of 401 equal samples: rounding only.
    assert!((how.zero_level_removed - 2.0).abs() < 1e-12);
    // Two passes of the ISO filter at F_H, 10 kHz: 1/(1 + (1/2.08333)^4) but for the warp, which is 1e-3 of it.
    assert!((how.gain_at_class_db.unwrap() + 0.449).abs() < 2e-3, "{:?}", how.gain_at_class_db);
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    assert_eq!(
        notes.notes,
        [
            "channel 001: of a dummy, filtered to CFC 1000 (SAE J211-1); --occupant-cfc changes the class",
            "channel 097: already CFC 60, passed through unfiltered",
            "channel 001: the sampling rate 10000 Hz is only 10.0 times CFC 1000: the -3 dB point is at 1756.4 Hz \
             instead of 1666.7 Hz"
        ]
    );
}

#[test]
fn the_response_stands_beside_the_limits_of_the_class() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("a", "", None), pulse(10_000.0))]);
    let how: ChannelFilterV1 = result(&input, &[]).record("/filter/a").unwrap().unwrap();
    assert_eq!((how.corridor_ok, how.phase.as_deref()), (Some(true), Some("zero")));
    let corner = how.corridor.iter().find(|point| point.frequency_hz == 100.0).unwrap();
    assert_eq!((corner.upper_db, corner.lower_db), (0.5, Some(-4.0)));
    // ISO 6487 has -2.98 dB at CFC/0.6, but for the warp at 10 kHz.
    assert!((corner.gain_db + 2.98).abs() < 0.01, "{corner:?}");
}

#[test]
fn a_butterworth_filter_is_recorded_with_its_sections() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("a", "", None), pulse(10_000.0))]);
    let how: ChannelFilterV1 =
        result(&input, &["--order", "3", "--cutoff", "200Hz"]).record("/filter/a").unwrap().unwrap();
    assert_eq!((how.mode.as_str(), how.cfc, how.corridor_ok), ("butterworth-low", None, None));
    assert_eq!((how.coefficients.len(), how.cutoff_hz), (10, vec![200.0]));
    for wrong in [
        &["--cutoff", "100Hz"][..],
        &["--order", "2", "--cutoff", "100"],
        &["--order", "2"],
        &["--phase", "causal"],
        &["--interpolation", "linear"],
    ] {
        assert_eq!(run(&input, wrong).status.code(), Some(2), "{wrong:?}");
    }
    for refused in [&["--order", "13", "--cutoff", "100Hz"], &["--order", "2", "--cutoff", "9kHz"]] {
        assert_eq!(run(&input, refused).status.code(), Some(3), "{refused:?}");
    }
}

#[test]
fn resampling_is_said_and_keeps_a_sample_at_time_zero() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("a", "", None), pulse(20_000.0))]);
    let artifact = result(&input, &["--resample", "8kHz"]);
    let wave = &artifact.waves()["a"].sampled;
    assert_eq!(wave.dt_s(), 1.0 / 8000.0);
    // Whole nanoseconds of t0 only.
    assert!(wave.time_s(wave.index_at_or_after(0.0)).abs() < 1e-9);
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    assert_eq!(notes.notes, ["channel a: resampled from 20000 Hz to 8000 Hz (windowed sinc)"]);
    let how: ChannelFilterV1 = artifact.record("/filter/a").unwrap().unwrap();
    assert_eq!(how.resampled_to_hz, Some(8000.0));
}

#[test]
fn the_load_cells_of_the_barrier_come_along_at_cfc_60() {
    let folder = tempfile::tempdir().unwrap();
    let force = Channel { quantity: QuantityKind::Force, ..channel("347", "barrier, load cell F-01", None) };
    let input = ingested(folder.path(), &[(channel("093", "", None), pulse(10_000.0)), (force, pulse(10_000.0))]);
    let artifact = result(&input, &["--cfc", "180"]);
    let class = |id: &str| artifact.record::<ChannelFilterV1>(&format!("/filter/{id}")).unwrap().unwrap().cfc;
    assert_eq!((class("093"), class("347")), (Some(180), Some(60)));
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let channels: Vec<_> =
        (0..9).map(|k| (channel(&format!("c{k}"), "", None), pulse(10_000.0 + 500.0 * f64::from(k)))).collect();
    let input = ingested(folder.path(), &channels);
    let bytes = |threads: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_crumple-filter"))
            .env("RAYON_NUM_THREADS", threads)
            .arg(&input)
            .arg("-o")
            .arg(input.with_file_name("2-filter.mcap"))
            .args(["--force", "-q"])
            .output()
            .unwrap();
        assert!(output.status.success());
        std::fs::read(input.with_file_name("2-filter.mcap")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("4"));
}

#[test]
fn none_takes_everything_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let raw = pulse(400.0);
    let input = ingested(folder.path(), &[(channel("a", "", None), raw.clone())]);
    let artifact = result(&input, &["--cfc", "none", "--zero-level", "none"]);
    assert_eq!(artifact.waves()["a"].sampled, raw);
    let how: ChannelFilterV1 = artifact.record("/filter/a").unwrap().unwrap();
    assert_eq!((how.cfc, how.mode.as_str(), how.zero_level_removed), (None, "none", 0.0));
    assert_eq!(artifact.record::<TestV1>("/test").unwrap().unwrap().channels[0].cfc, None);
}

#[test]
fn a_pipeline_table_names_the_class_as_a_number_and_a_flag_wins() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("a", "", None), pulse(10_000.0))]);
    let pipeline = folder.path().join("p.toml");
    std::fs::write(&pipeline, "[filter]\ncfc = 180\nmode = \"sae_reflect\"\nzero_level_from = \"-40 ms\"\n").unwrap();
    let class = |flags: &[&str]| {
        let how: ChannelFilterV1 = result(&input, flags).record("/filter/a").unwrap().unwrap();
        (how.cfc, how.mode)
    };
    let pipeline = pipeline.to_str().unwrap();
    assert_eq!(class(&["--pipeline", pipeline]), (Some(180), "sae_reflect".to_owned()));
    assert_eq!(class(&["--pipeline", pipeline, "--cfc", "60"]), (Some(60), "sae_reflect".to_owned()));
}

#[test]
fn refuses_400_hz_and_says_what_cfc_60_needs() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("accel_g", "", None), pulse(400.0))]);
    let output = run(&input, &[]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(
        stderr
            .contains("channel accel_g: a sampling rate of 400 Hz is too low for CFC 60, which needs at least 600 Hz"),
        "{stderr}"
    );
    assert!(!input.with_file_name("2-filter.mcap").exists());
}

#[test]
fn a_channel_nobody_asked_for_is_left_out_and_one_asked_for_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(
        folder.path(),
        &[(channel("fast", "", None), pulse(10_000.0)), (channel("slow", "", None), pulse(400.0))],
    );
    let artifact = result(&input, &[]);
    assert_eq!(artifact.waves().keys().collect::<Vec<_>>(), ["fast"]);
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    assert!(notes.notes[0].starts_with("warning: channel slow: left out: a sampling rate of 400 Hz"), "{notes:?}");
    assert_eq!(run(&input, &["--channels", "fast,slow"]).status.code(), Some(3));
    assert_eq!(run(&input, &["--channels", "nope"]).status.code(), Some(3));
}

#[test]
fn a_class_that_does_not_exist_is_a_usage_error() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("a", "", None), pulse(10_000.0))]);
    for flags in [["--cfc", "61"], ["--zero-level-from", "-50"]] {
        assert_eq!(run(&input, &flags).status.code(), Some(2), "{flags:?}");
    }
    assert_eq!(run(&input, &["--zero-level", "none", "--zero-level-to", "-5ms"]).status.code(), Some(2));
}

#[test]
fn channels_may_be_named_by_code_or_pattern() {
    let folder = tempfile::tempdir().unwrap();
    let coded = |id: &str, code: &str| Channel { code: Some(code.to_owned()), ..channel(id, "vehicle", None) };
    let raw = pulse(10_000.0);
    let input = ingested(
        folder.path(),
        &[
            (coded("93", "10FORALERE00ACXP"), raw.clone()),
            (coded("94", "10FORARIRE00ACXP"), raw.clone()),
            (coded("95", "10ENGN000000ACXP"), raw.clone()),
        ],
    );
    let artifact = result(&input, &["--channels", "1?FORA*X?", "--pass", "10ENGN000000ACXP"]);
    assert_eq!(artifact.waves().keys().collect::<Vec<_>>(), ["93", "94", "95"]);
    assert_eq!(artifact.waves()["95"].sampled, raw);
    assert_eq!(run(&input, &["--channels", "1?SECM*"]).status.code(), Some(3));
}

#[test]
fn the_velocity_change_of_a_recorder_becomes_an_acceleration_that_says_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    // 50 km/h lost in 100 ms, in whole km/h every 10 ms.
    let change = (0..26).map(|k| f64::from(-5 * k.min(10)) / 3.6).collect();
    let change = Sampled::new(0.0, 0.01, change).unwrap();
    let of_recorder =
        Channel { axis: Some(crumple_signal::Axis::X), ..Channel::new("dv", QuantityKind::VelocityChange) };
    let artifact = result(&ingested(folder.path(), &[(of_recorder, change)]), &[]);
    assert_eq!(artifact.waves().keys().collect::<Vec<_>>(), ["dv", "dv_derivative"], "the table itself is handed on");
    let wave = &artifact.waves()["dv_derivative"];
    assert_eq!(wave.quantity, QuantityKind::Acceleration);
    // 5 km/h in 10 ms; rounding only.
    assert!((wave.sampled.samples()[5] + 500.0 / 3.6).abs() < 1e-9);
    let test: TestV1 = artifact.record("/test").unwrap().unwrap();
    assert_eq!(test.pulse.as_deref(), Some("dv_derivative"));
    let channel = test.channels.iter().find(|c| c.id == "dv_derivative").unwrap();
    assert_eq!((channel.status.as_str(), channel.axis.as_deref(), channel.cfc), ("computed", Some("x"), None));
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    let said = notes.notes.join("\n");
    assert!(said.contains("warning: channel dv_derivative: derived from the velocity change of channel dv"), "{said}");
    let how: ChannelFilterV1 = artifact.record("/filter/dv_derivative").unwrap().unwrap();
    assert_eq!((how.mode.as_str(), how.cfc), ("none", None));
}

#[test]
fn a_filter_that_cannot_be_is_answered_with_its_own_flag() {
    let folder = tempfile::tempdir().unwrap();
    let input = ingested(folder.path(), &[(channel("093", "vehicle, sill", None), pulse(10_000.0))]);
    for (flags, said) in [
        (&["--order", "13", "--cutoff", "100Hz"][..], "hint: crumple-filter --order 4"),
        (&["--order", "4", "--cutoff", "9kHz"], "hint: crumple-filter --cutoff 100Hz"),
        (&["--zero-level-from=-10ms", "--zero-level-to=-50ms"], "hint: let the zero level begin"),
    ] {
        let output = run(&input, flags);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{text}");
        assert!(text.contains(said), "{flags:?}: {text}");
    }
}

#[test]
fn a_dummy_is_filtered_to_its_own_class_unless_one_is_typed() {
    let folder = tempfile::tempdir().unwrap();
    let raw = pulse(10_000.0);
    let input = ingested(
        folder.path(),
        &[
            (channel("001", "driver, head", None), raw.clone()),
            (channel("002", "driver, head", None), raw.clone()),
            (channel("013", "driver, chest", None), raw.clone()),
            (channel("093", "vehicle, sill", None), raw),
        ],
    );
    let classes = |artifact: &Artifact| -> Vec<Option<u16>> {
        let test: TestV1 = artifact.record("/test").unwrap().unwrap();
        test.channels.iter().map(|channel| channel.cfc).collect()
    };
    let said = |artifact: &Artifact| artifact.record::<NotesV1>("/notes").unwrap().unwrap().notes.join("\n");
    let pipeline = |text: &str| {
        let path = folder.path().join("p.toml");
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    // A flag and the key of a pipeline file mean the same: the class of the structure, and that of the dummies.
    let structure = pipeline("[filter]\ncfc = '180'\n");
    for (flags, class) in [(vec![], 60), (vec!["--pipeline", &structure], 180), (vec!["--cfc", "180"], 180)] {
        let artifact = result(&input, &flags);
        assert_eq!(classes(&artifact), [Some(1000), Some(1000), Some(180), Some(class)]);
        assert!(said(&artifact).contains("channels 001, 002: of a dummy, filtered to CFC 1000"), "{}", said(&artifact));
    }
    // Structure, head and chest in one run, each to its class.
    let artifact = result(&input, &["--channels", "001,013,093"]);
    assert_eq!(classes(&artifact), [Some(1000), None, Some(180), Some(60)]);

    let dummies = pipeline("[filter]\noccupant_cfc = '60'\n");
    for flags in [["--pipeline", &dummies], ["--occupant-cfc", "60"]] {
        let artifact = result(&input, &flags);
        assert_eq!(classes(&artifact), [Some(60); 4]);
        let warning =
            "warning: channels 001, 002: of a dummy, filtered to CFC 60 as asked for: its criteria ask for CFC 1000";
        assert!(said(&artifact).contains(warning), "{}", said(&artifact));
    }
    let artifact = result(&input, &["--cfc", "60", "--occupant-cfc", "180", "--channels", "001"]);
    assert_eq!(classes(&artifact), [Some(180), None, None, None]);
}

#[test]
fn heads_and_chests_come_to_their_class_and_other_sensors_of_occupants_are_named_with_the_flag_that_takes_them() {
    let folder = tempfile::tempdir().unwrap();
    let raw = pulse(10_000.0);
    let neck = Channel { quantity: QuantityKind::Force, ..channel("004", "driver, neck", None) };
    let input = ingested(
        folder.path(),
        &[
            (channel("093", "vehicle, sill", None), raw.clone()),
            (channel("001", "driver, head", None), raw.clone()),
            (channel("013", "driver, chest", None), raw.clone()),
            (neck, raw.clone()),
            (channel("007", "driver, pelvis", None), raw.clone()),
            (channel("017", "driver, head", None), pulse(5_000.0)),
        ],
    );
    // Whatever is done to the structure.
    for flags in [&[][..], &["--cfc", "180"], &["--order", "2", "--cutoff", "100Hz"]] {
        let artifact = result(&input, flags);
        assert_eq!(artifact.waves().keys().collect::<Vec<_>>(), ["001", "013", "093"]);
        for (id, cfc) in [("001", 1000), ("013", 180)] {
            let how: ChannelFilterV1 = artifact.record(&format!("/filter/{id}")).unwrap().unwrap();
            assert_eq!((how.cfc, how.mode.as_str()), (Some(cfc), "iso6487"));
        }
        let notes = artifact.record::<NotesV1>("/notes").unwrap().unwrap().notes;
        assert!(
            notes.iter().any(|note| note.starts_with("warning: channel 017: left out: a sampling rate of 5000")),
            "{notes:?}"
        );
        let line = "2 occupant channels are left out, because no criterion uses them: driver, neck (1), driver, \
            pelvis (1). --set filter.channels='093,007' adds one";
        assert!(notes.iter().any(|note| note.starts_with(line)), "{notes:?}");
    }
    // As the note has it.
    assert_eq!(result(&input, &["--channels", "093,007"]).waves().keys().collect::<Vec<_>>(), ["007", "093"]);
}
