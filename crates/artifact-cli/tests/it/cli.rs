//! The program as people and programs in other languages use it.

use std::fs;
use std::io::Cursor;
use std::path::Path;
use std::process::Command;

use crumple_artifact::records::{ChannelV1, EventsV1, MetricV1, MetricsV2, NotesV1, SourceV1, StateSpaceV1, TestV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, InputDigest, Provenance, Record};
use crumple_signal::{QuantityKind, Sampled};

struct Outcome {
    code: i32,
    stdout: String,
    stderr: String,
}

fn artifact(folder: &Path, args: &[&str]) -> Outcome {
    let output = Command::new(env!("CARGO_BIN_EXE_crumple-artifact")).args(args).current_dir(folder).output().unwrap();
    Outcome {
        code: output.status.code().unwrap(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

fn provenance() -> Provenance {
    let input = InputDigest { kind: "ingest".into(), digest: "blake3:00".into() };
    Provenance::new("filter", "0.1.0", r#"{"cfc":60,"mode":"iso6487"}"#.into(), vec![input])
}

fn channel(id: &str, quantity: QuantityKind) -> ChannelV1 {
    ChannelV1 {
        id: id.into(),
        location: "rear seat".into(),
        axis: Some("x".into()),
        quantity: quantity.name().into(),
        unit: quantity.si_unit().into(),
        cfc: Some(60),
        status: "valid".into(),
        initial_velocity_m_per_s: None,
        redundant: false,
        comment: None,
        code: None,
        sensor: None,
        filter_state: None,
        polarity: None,
    }
}

fn test() -> TestV1 {
    TestV1 {
        title: "A \"test\"".into(),
        vehicle: None,
        mass_kg: Some(873.0),
        impact_speed_m_per_s: Some(9.75),
        barrier: None,
        source: SourceV1 { format: "csv".into(), name: "crash.csv".into(), digest: "blake3:00".into() },
        channels: vec![channel("93", QuantityKind::Acceleration), channel("seat belt", QuantityKind::Force)],
        pulse: Some("93".into()),
        notes: vec![],
        time_zero: None,
        contact: None,
        exchange_asked: false,
        overlap: None,
        kind: None,
    }
}

fn builder() -> ArtifactBuilder {
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &test()).unwrap();
    // A third and the smallest number: their texts must read back to the last bit.
    let metric = |name: &str, value: f64| MetricV1 {
        name: name.into(),
        value: Some(value),
        unit: "1".into(),
        channel: "93".into(),
        definition: "as defined".into(),
        ..MetricV1::default()
    };
    builder.put("/metrics", &MetricsV2 { metrics: vec![metric("third", 1.0 / 3.0), metric("tiny", 5e-324)] }).unwrap();
    builder.put("/notes", &NotesV1 { stage: "filter".into(), notes: vec!["a note".into()] }).unwrap();
    let wave = |t0, n: u32| Sampled::new(t0, 1e-4, (0..n).map(|k| f64::from(k % 7) / 3.0 - 1.0).collect()).unwrap();
    // More than one block of 65,536 samples.
    builder.wave("93", QuantityKind::Acceleration, wave(-0.02, 70_000)).unwrap();
    builder.wave("93/velocity", QuantityKind::Velocity, wave(0.0, 4)).unwrap();
    builder.wave("seat belt", QuantityKind::Force, wave(0.0, 0)).unwrap();
    builder
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    builder().write(&folder.path().join("2-filter.mcap"), &provenance(), Compression::None).unwrap();
    folder
}

/// The artifact that `builder` makes.
fn made(builder: &ArtifactBuilder) -> Artifact {
    let mut bytes = Cursor::new(Vec::new());
    builder.write_to(&mut bytes, &provenance(), Compression::None).unwrap();
    Artifact::read(Path::new("x.mcap"), bytes.get_ref().as_slice()).unwrap()
}

#[test]
fn show_tells_provenance_records_and_waves() {
    let folder = folder();
    let output = artifact(folder.path(), &["show", "2-filter.mcap", "--topic", "/notes", "--topic", "/wave/*"]);
    assert_eq!((output.code, output.stderr.as_str()), (0, ""));
    let digest = made(&builder()).digest().to_owned();
    // Broken before the extremes, so that the lines are short.
    let shown = output.stdout.replace(&digest, "blake3:<digest>").replace("; min", ";\n  min");
    insta::assert_snapshot!(shown, @r#"
    stage    filter 0.1.0
    config   {"cfc":60,"mode":"iso6487"}
    input    ingest blake3:00
    content  blake3:<digest>

    /notes  crumple.Notes.v1
    {
      "stage": "filter",
      "notes": [
        "a note"
      ]
    }

    /wave/93  acceleration in m/s^2, 70000 samples from -0.02 s to 6.9799 s, every 0.0001 s (10000 Hz);
      min -1 at -0.02 s, max 1 at -0.0194 s
    /wave/93/velocity  velocity in m/s, 4 samples from 0 s to 0.0003 s, every 0.0001 s (10000 Hz);
      min -1 at 0 s, max 0 at 0.0003 s
    /wave/seat belt  force in N, no samples
    "#);
    let whole = artifact(folder.path(), &["show", "2-filter.mcap"]).stdout;
    assert!(whole.contains("\n/test  crumple.Test.v1\n{\n  \"title\": \"A \\\"test\\\"\",\n"), "{whole}");
}

#[test]
fn show_prints_samples_with_their_times() {
    let folder = folder();
    let output = artifact(folder.path(), &["show", "2-filter.mcap", "--topic", "/wave/93/velocity", "--samples"]);
    let samples: Vec<&str> = output.stdout.lines().filter(|line| line.contains('\t')).collect();
    assert_eq!(samples.len(), 5);
    assert_eq!(samples[0], "time_s\tvalue");
    assert_eq!(samples[4], "0.0003\t0");
}

#[test]
fn records_as_lines_of_json_make_the_same_records_again() {
    let folder = folder();
    let lines = artifact(folder.path(), &["show", "2-filter.mcap", "--json"]).stdout;
    assert_eq!(lines.lines().count(), 3);
    assert!(lines.starts_with(r#"{"topic":"/test","schema":"crumple.Test.v1","data":{"title":"#), "{lines}");
    fs::write(folder.path().join("typed.ndjson"), &lines).unwrap();
    assert_eq!(artifact(folder.path(), &["pack", "typed.ndjson", "typed.mcap"]).code, 0);
    assert_eq!(artifact(folder.path(), &["show", "typed.mcap", "--json"]).stdout, lines);

    // With the samples, all of the artifact.
    let lines = artifact(folder.path(), &["show", "2-filter.mcap", "--json", "--samples"]).stdout;
    fs::write(folder.path().join("whole.ndjson"), lines).unwrap();
    assert_eq!(artifact(folder.path(), &["pack", "whole.ndjson", "whole.mcap"]).code, 0);
    let whole = Artifact::open(&folder.path().join("whole.mcap")).unwrap();
    let original = made(&builder());
    assert_eq!(whole.digest(), original.digest());
    assert_eq!(whole.waves(), original.waves());
}

#[test]
fn unpacking_and_packing_gives_the_same_content_and_provenance() {
    let folder = folder();
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain"]).code, 0);
    let plain = folder.path().join("plain");
    let waves = fs::read_to_string(plain.join("waves.ndjson")).unwrap();
    assert_eq!(
        waves.lines().nth(1),
        Some(concat!(
            r#"{"id":"93/velocity","quantity":"velocity","t0_s":0.0,"dt_s":0.0001,"samples":4,"#,
            r#""file":"waves/002-93_velocity.f64"}"#
        ))
    );
    assert_eq!(fs::read(plain.join("waves/002-93_velocity.f64")).unwrap()[..8], (-1.0_f64).to_le_bytes());

    for extra in [None, Some("--zstd")] {
        let args: Vec<&str> = ["pack", "plain", "again.mcap"].into_iter().chain(extra).collect();
        assert_eq!(artifact(folder.path(), &args).code, 0);
        let again = Artifact::open(&folder.path().join("again.mcap")).unwrap();
        let original = made(&builder());
        assert_eq!(again.digest(), original.digest());
        assert_eq!(again.provenance(), Some(&provenance()));
        assert_eq!(again.waves(), original.waves());
    }
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain"]).code, 2, "the folder is not empty");
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain", "--force"]).code, 0);
}

#[test]
fn samples_as_text_read_back_to_the_same_numbers() {
    let folder = folder();
    let unpacked = artifact(folder.path(), &["unpack", "2-filter.mcap", "plain", "--text"]);
    assert_eq!(unpacked.code, 0, "{}", unpacked.stderr);
    let file = folder.path().join("plain/waves/002-93_velocity.txt");
    let text = fs::read_to_string(&file).unwrap();
    assert_eq!((text.lines().next(), text.lines().count()), (Some("-1.0"), 4));
    assert_eq!(artifact(folder.path(), &["pack", "plain", "again.mcap"]).code, 0);
    let again = Artifact::open(&folder.path().join("again.mcap")).unwrap();
    let original = made(&builder());
    assert_eq!((again.digest(), again.waves()), (original.digest(), original.waves()));
    assert_eq!(again.provenance(), Some(&provenance()));
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain", "--text", "--force"]).code, 0);

    for (wrong, said) in [
        ("1\n2\nx\n4\n", "002-93_velocity.txt, line 3: \"x\": invalid float literal"),
        ("1\n2\n3\n", "002-93_velocity.txt has 3 lines, 4 samples have one each"),
        ("1\n2\nNaN\n4\n", "is NaN"),
    ] {
        fs::write(&file, wrong).unwrap();
        let refused = artifact(folder.path(), &["pack", "plain", "wrong.mcap"]);
        assert!(refused.code == 3 && refused.stderr.contains(said), "{}", refused.stderr);
    }
}

#[test]
fn what_was_edited_is_not_the_stages_own_any_more() {
    let folder = folder();
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain"]).code, 0);
    let records = folder.path().join("plain/records.ndjson");
    let edited = fs::read_to_string(&records).unwrap().replace("a note", "another note");
    fs::write(&records, edited).unwrap();
    assert_eq!(artifact(folder.path(), &["pack", "plain", "edited.mcap"]).code, 0);
    let edited = Artifact::open(&folder.path().join("edited.mcap")).unwrap();
    assert_eq!(edited.stage(), Some("filter"), "later stages look for it");
    let stated = edited.provenance().unwrap();
    assert_eq!((stated.build.as_str(), stated.made_by.as_str()), ("", "crumple-artifact pack"));
    let shown = artifact(folder.path(), &["show", "edited.mcap"]).stdout;
    assert!(shown.contains("made by  crumple-artifact pack, of content that is not the stage's own"), "{shown}");

    // and stays so, packed again as it is
    assert_eq!(artifact(folder.path(), &["unpack", "edited.mcap", "again"]).code, 0);
    assert_eq!(artifact(folder.path(), &["pack", "again", "again.mcap"]).code, 0);
    let again = Artifact::open(&folder.path().join("again.mcap")).unwrap();
    assert_eq!(again.provenance(), Some(stated));
}

#[test]
fn no_file_of_another_kind_is_overwritten() {
    let folder = folder();
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain"]).code, 0);
    let record = folder.path().join("crash.csv");
    fs::write(&record, "time_s,accel_g\n").unwrap();
    let output = artifact(folder.path(), &["pack", "plain", "crash.csv"]);
    assert_eq!(output.code, 2, "{}", output.stderr);
    insta::assert_snapshot!(output.stderr, @"
    error: the output crash.csv exists and is no artifact of this project
      hint: give it another name
    ");
    assert_eq!(fs::read(&record).unwrap(), b"time_s,accel_g\n");

    let records = folder.path().join("plain/records.ndjson");
    fs::write(&records, "topic,schema\n").unwrap();
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain", "--force"]).code, 2);
    assert_eq!(fs::read(&records).unwrap(), b"topic,schema\n");

    #[cfg(unix)]
    {
        let (waves, other) = (folder.path().join("plain/waves"), folder.path().join("other"));
        fs::rename(&waves, &other).unwrap();
        std::os::unix::fs::symlink(&other, &waves).unwrap();
        let refuses = |link: &str| {
            let output = artifact(folder.path(), &["unpack", "2-filter.mcap", "plain", "--force"]);
            assert_eq!((output.code, output.stderr.contains(link)), (2, true), "{}", output.stderr);
        };
        refuses("plain/waves is a link");
        fs::remove_file(&waves).unwrap();
        fs::rename(&records, folder.path().join("lines")).unwrap();
        std::os::unix::fs::symlink(folder.path().join("lines"), &records).unwrap();
        refuses("plain/records.ndjson is a link");
    }
}

#[test]
fn completions_and_the_man_page_are_printed_without_a_command() {
    let folder = folder();
    for (kind, word) in [("bash", "crumple-artifact"), ("zsh", "#compdef"), ("fish", "complete -c"), ("man", ".TH")] {
        let output = artifact(folder.path(), &["--generate", kind]);
        assert_eq!(output.code, 0, "{}", output.stderr);
        assert!(output.stdout.contains(word), "{kind}");
    }
    assert_eq!(artifact(folder.path(), &[]).code, 2, "a command is needed else");
    let help = artifact(folder.path(), &["--help"]).stdout;
    assert!(help.contains("--generate") && help.contains("--memory-limit"), "{help}");
}

#[test]
fn what_needs_more_memory_than_its_limit_is_refused_by_name() {
    let folder = folder();
    let output = artifact(folder.path(), &["show", "2-filter.mcap", "--memory-limit", "400KiB"]);
    assert_eq!(output.code, 3, "{}", output.stderr);
    insta::assert_snapshot!(output.stderr, @"
    error: 2-filter.mcap: this needs more than 400 KiB of memory, the limit of --memory-limit
      hint: where the input is right all the same, give it more: --memory-limit 1MiB
    ");
    assert_eq!(artifact(folder.path(), &["check", "2-filter.mcap", "--memory-limit", "64MiB"]).code, 0);
    assert_eq!(artifact(folder.path(), &["check", "2-filter.mcap", "--memory-limit", "64"]).code, 2);
}

#[test]
fn a_title_does_not_command_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1 { title: "\u{9b}31m".into(), ..test() }).unwrap();
    builder.write(&folder.path().join("x.mcap"), &provenance(), Compression::None).unwrap();
    let shown = artifact(folder.path(), &["show", "x.mcap"]).stdout;
    assert!(shown.contains("\\u{9b}31m") && !shown.contains('\u{9b}'), "{shown}");
}

#[test]
fn plain_files_that_make_no_sense_are_refused_with_their_place() {
    let folder = folder();
    assert_eq!(artifact(folder.path(), &["unpack", "2-filter.mcap", "plain"]).code, 0);
    let refused = |name: &str, change: &dyn Fn(String) -> String| {
        let path = folder.path().join("plain").join(name);
        let good = fs::read_to_string(&path).unwrap();
        fs::write(&path, change(good.clone())).unwrap();
        let output = artifact(folder.path(), &["pack", "plain", "again.mcap"]);
        fs::write(&path, good).unwrap();
        assert_eq!(output.code, 3, "{}", output.stderr);
        assert!(!folder.path().join("again.mcap").exists());
        output.stderr.lines().next().unwrap().to_owned()
    };
    let swap = |from: &'static str, to: &'static str| {
        move |text: String| {
            assert!(text.contains(from));
            text.replace(from, to)
        }
    };
    let refusals = [
        refused("records.ndjson", &swap("crumple.Notes.v1", "crumple.Note.v1")),
        refused("records.ndjson", &swap("\"stage\":\"filter\"", "\"stage\":7")),
        refused("records.ndjson", &swap("\"notes\":[\"a note\"]}}", "")),
        refused("waves.ndjson", &swap("\"samples\":4", "\"samples\":5")),
        refused("waves.ndjson", &swap("\"velocity\",", "\"speed\",")),
        refused("waves.ndjson", &swap("waves/002", "../waves/002")),
        refused("waves.ndjson", &swap("waves/002", "waves/007")),
        refused("waves.ndjson", &swap("\"93/velocity\"", "\"93\"")),
    ];
    let quantities: Vec<&str> = QuantityKind::ALL.iter().map(|kind| kind.name()).collect();
    let refusals = refusals.join("\n").replace(&quantities.join(", "), "<quantities>");
    insta::assert_snapshot!(refusals, @r#"
    error: record /notes: schema "crumple.Note.v1" is unknown, did you mean "crumple.Notes.v1"?
    error: record /notes: not a crumple.Notes.v1: invalid type: integer `7`, expected a string
    error: plain/records.ndjson, line 3: EOF while parsing a value at column 71
    error: wave "93/velocity": waves/002-93_velocity.f64 has 32 bytes, 5 samples have 8 each
    error: wave "93/velocity": unknown quantity "speed", expected one of <quantities>
    error: wave "93/velocity": file "../waves/002-93_velocity.f64" lies outside the folder
    error: cannot read plain/waves/007-93_velocity.f64: No such file or directory (os error 2)
    error: topic /wave/93 is written twice
    "#);

    let file = folder.path().join("plain/waves/002-93_velocity.f64");
    fs::write(&file, [1.0, f64::NAN, 1.0, 1.0].map(f64::to_le_bytes).concat()).unwrap();
    let output = artifact(folder.path(), &["pack", "plain", "again.mcap"]);
    assert_eq!(output.code, 3);
    assert!(output.stderr.contains("sample 1 (t = 0.000100 s) is NaN"), "{}", output.stderr);
}

#[test]
fn check_counts_what_is_sound_and_refuses_what_is_not() {
    let folder = folder();
    let good = fs::read(folder.path().join("2-filter.mcap")).unwrap();
    fs::write(folder.path().join("cut.mcap"), &good[..good.len() - 9]).unwrap();
    let mut bad = good;
    bad[5000] ^= 1;
    fs::write(folder.path().join("bad.mcap"), bad).unwrap();
    let output = artifact(folder.path(), &["check", "2-filter.mcap"]);
    assert_eq!((output.code, output.stderr.as_str()), (0, ""));
    let digest = made(&builder()).digest().to_owned();
    assert_eq!(output.stdout, format!("2-filter.mcap: ok: 3 records, 3 waves, 70004 samples, digest {digest}\n"));

    let output = artifact(folder.path(), &["check", "cut.mcap", "bad.mcap", "2-filter.mcap", "none.mcap"]);
    assert_eq!(output.code, 3);
    assert_eq!(output.stdout.lines().count(), 1, "sound files are counted all the same");
    let starts: Vec<_> =
        output.stderr.lines().map(|line| line.split(": ").take(3).collect::<Vec<_>>().join(": ")).collect();
    assert_eq!(
        starts,
        [
            "error: cut.mcap: truncated",
            "error: bad.mcap: corrupted",
            "error: cannot read none.mcap: No such file or directory (os error 2)"
        ]
    );
}

#[test]
fn check_finds_what_the_container_cannot() {
    let folder = tempfile::tempdir().unwrap();
    let check = |fill: &dyn Fn(&mut ArtifactBuilder)| {
        let mut builder = ArtifactBuilder::new();
        fill(&mut builder);
        builder.write(&folder.path().join("x.mcap"), &provenance(), Compression::None).unwrap();
        let output = artifact(folder.path(), &["check", "x.mcap"]);
        assert_eq!(output.code, 3, "{}", output.stdout);
        output.stderr
    };
    let notes = NotesV1 { stage: "x".into(), notes: vec![] };
    let wrong_type = check(&|b| b.put("/events", &notes).unwrap());
    let no_pulse = check(&|b| b.put("/test", &TestV1 { pulse: Some("94".into()), ..test() }).unwrap());
    let other_quantity = check(&|b| {
        b.put("/test", &test()).unwrap();
        b.wave("93", QuantityKind::Velocity, Sampled::new(0.0, 1.0, vec![1.0]).unwrap()).unwrap();
    });
    let model = StateSpaceV1 {
        a: vec![vec![1.0, 0.0], vec![0.0, 1.0]],
        b: vec![vec![1.0], vec![1.0]],
        c: vec![vec![1.0]],
        d: vec![vec![0.0]],
        sample_time_s: 1e-4,
        input: "force".into(),
        output: "acceleration".into(),
        delay_s: None,
    };
    let wrong_shape = check(&|b| b.put("/model/era-2/discrete", &model).unwrap());
    insta::assert_snapshot!([wrong_type, no_pulse, other_quantity, wrong_shape].concat(), @r#"
    error: x.mcap: topic /events holds crumple.Notes.v1, crumple.Events.v1 is stated for it
    error: x.mcap: topic /test: the pulse is channel "94", which is not listed
    error: x.mcap: topic /test: channel "93" is listed as acceleration, its waveform says velocity
    error: x.mcap: topic /model/era-2/discrete: c has rows of [1] numbers, expected 1 of 2 [CR401]
      hint: write matrices of one order in the program of the stage identify
    "#);
}

/// A file as another program writes it.
fn foreign(path: &Path, topics: &[(&str, &str, &str, &[u8])]) {
    let mut file = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut file).unwrap();
    for (topic, schema, encoding, payload) in topics {
        let schema = writer.add_schema(schema, "jsonschema", b"{}").unwrap();
        let channel = writer.add_channel(schema, topic, encoding, &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, payload).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    fs::write(path, file.into_inner()).unwrap();
}

#[test]
fn records_of_other_programs_are_shown_checked_and_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let notes = br#"{"stage":"python","notes":["hello"]}"#;
    foreign(
        &folder.path().join("x.mcap"),
        &[
            ("/notes", NotesV1::SCHEMA, "json", notes),
            ("/mine", "my.Type", "json", br#"{"a":1}"#),
            ("/raw", "my.Other", "cbor", b"\xa0"),
        ],
    );
    let shown = artifact(folder.path(), &["show", "x.mcap"]);
    assert_eq!(shown.code, 0);
    assert!(shown.stdout.starts_with("stage    not stated\n"), "{}", shown.stdout);
    assert!(
        shown.stdout.contains("\"a\": 1") && shown.stdout.contains("1 bytes in encoding \"cbor\""),
        "{}",
        shown.stdout
    );
    let checked = artifact(folder.path(), &["check", "x.mcap"]);
    assert!(checked.stdout.starts_with("x.mcap: ok: 3 records (2 of other projects, not decoded), 0 waves"));
    assert_eq!(artifact(folder.path(), &["unpack", "x.mcap", "plain"]).code, 3, "cbor is no JSON");

    foreign(
        &folder.path().join("y.mcap"),
        &[("/notes", NotesV1::SCHEMA, "json", b"{}"), ("/events", EventsV1::SCHEMA, "json", b"[")],
    );
    let checked = artifact(folder.path(), &["check", "y.mcap"]);
    assert_eq!(checked.code, 3);
    insta::assert_snapshot!(checked.stderr, @"
    error: y.mcap: topic /notes: JSON: missing field `stage` at line 1 column 2
    error: y.mcap: topic /events: JSON: EOF while parsing a list at line 1 column 1
    ");
    assert_eq!(artifact(folder.path(), &["show", "y.mcap"]).code, 3);
}
