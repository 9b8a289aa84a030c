//! Tables and recordings of a run, read back: every value is that of the artifact to the bit.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_signal::{QuantityKind, Sampled};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use tempfile::TempDir;

fn golden() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/double/golden")
}

fn program(path: &str, run: &Path, folder: &Path, words: &[&str]) -> Output {
    Command::new(path).arg(run).args(words).current_dir(folder).output().unwrap()
}

fn export(run: &Path, folder: &Path, words: &[&str]) -> Output {
    program(env!("CARGO_BIN_EXE_crumple-export"), run, folder, words)
}

fn view(run: &Path, folder: &Path, words: &[&str]) -> Output {
    program(env!("CARGO_BIN_EXE_crumple-view"), run, folder, words)
}

fn done(output: &Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Bits of the samples by time, ns.
type Bits = BTreeMap<i64, u64>;

fn bits(sampled: &Sampled) -> Bits {
    let ns = |t: f64| (t * 1e9).round() as i64;
    sampled.samples().iter().enumerate().map(|(k, x)| (ns(sampled.time_s(k)), x.to_bits())).collect()
}

/// Some waveforms of the golden run: artifact, id, column.
const WAVES: [[&str; 3]; 6] = [
    ["1-ingest", "accel_g", "accel_g/unfiltered/acceleration_m_per_s2"],
    ["2-filter", "accel_g", "accel_g/acceleration_m_per_s2"],
    ["3-integrate", "accel_g/displacement", "accel_g/displacement_m"],
    [
        "6-simulate",
        "double-spring-mass-damper/direct-fit/1/force/k1",
        "double-spring-mass-damper/direct-fit/1/force_k1_n",
    ],
    [
        "6-simulate",
        "double-spring-mass-damper/direct-fit/1/m1/velocity",
        "double-spring-mass-damper/direct-fit/1/m1/velocity_m_per_s",
    ],
    ["7-predict", "prediction/2/acceleration", "prediction/2/acceleration_m_per_s2"],
];

fn of_artifacts() -> Vec<(&'static str, Bits)> {
    let wave = |[file, id, column]: [&'static str; 3]| {
        let artifact = Artifact::open(&golden().join(file).with_extension("mcap")).unwrap();
        (column, bits(&artifact.waves()[id].sampled))
    };
    WAVES.into_iter().map(wave).collect()
}

#[test]
fn csv_and_parquet_have_the_samples_of_the_artifacts_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for to in ["csv", "parquet"] {
        done(&export(&golden(), folder.path(), &["--to", to, "-o", to]));
    }
    let mut columns: BTreeMap<String, Bits> = BTreeMap::new();
    let mut of_parquet: BTreeMap<String, Bits> = BTreeMap::new();
    let tables = fs::read_dir(folder.path().join("csv")).unwrap().map(|entry| entry.unwrap().path());
    let names = tables.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()));
    for table in names.filter(|name| name.starts_with("waves") || name.starts_with("simulated")) {
        let mut reader = csv::Reader::from_path(folder.path().join(format!("csv/{table}.csv"))).unwrap();
        let heads = reader.headers().unwrap().clone();
        for (k, row) in reader.records().map(Result::unwrap).enumerate() {
            let time = (row[0].parse::<f64>().unwrap() * 1e9).round() as i64;
            for (name, cell) in heads.iter().zip(&row).skip(1).filter(|(_, cell)| !cell.is_empty()) {
                // The first cell says that a column is none of counts.
                assert!(k > 0 || cell.contains(['.', 'e']), "{table}, {name}: {cell}");
                columns.entry(name.to_owned()).or_default().insert(time, cell.parse::<f64>().unwrap().to_bits());
            }
        }
        let file = File::open(folder.path().join(format!("parquet/{table}.parquet"))).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        for row in reader.get_row_iter(None).unwrap().map(Result::unwrap) {
            let number = |field: &Field| if let Field::Double(x) = field { Some(*x) } else { None };
            let mut cells = row.get_column_iter().map(|(name, field)| (name.clone(), number(field)));
            let time = (cells.next().unwrap().1.unwrap() * 1e9).round() as i64;
            for (name, value) in cells.filter_map(|(name, value)| Some((name, value?))) {
                of_parquet.entry(name).or_default().insert(time, value.to_bits());
            }
        }
    }
    assert!(columns.len() > 90 && columns == of_parquet, "{}", columns.len());
    for (name, expected) in of_artifacts() {
        assert!(columns[name] == expected, "{name}");
    }
    let parameters = fs::read_to_string(folder.path().join("csv/parameters.csv")).unwrap();
    assert!(parameters.starts_with("candidate,name,value,unit,low,high,recommended\n"), "{parameters}");
    assert!(parameters.contains(",k1_n_per_m,") && parameters.contains(",N/m,"), "{parameters}");
}

#[test]
fn what_is_there_stays_and_tables_are_chosen_by_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let only = ["--to", "csv", "-o", "x", "--what", "metrics,notes"];
    done(&export(&golden(), folder.path(), &only));
    let mut names: Vec<_> = fs::read_dir(folder.path().join("x")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["metrics.csv", "notes.csv"]);
    assert_eq!(export(&golden(), folder.path(), &only).status.code(), Some(2));
    done(&export(&golden(), folder.path(), &[&only[..], &["--force"]].concat()));
    let wrong = export(&golden(), folder.path(), &["--to", "csv", "--what", "wave"]);
    let said = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(wrong.status.code() == Some(2) && said.contains("did you mean \"waves\""), "{said}");
    let thinned = ["--to", "csv", "-o", "y", "--what", "waves", "--decimate", "500"];
    done(&export(&golden(), folder.path(), &thinned));
    assert_eq!(export(&folder.path().join("x"), folder.path(), &["--to", "csv"]).status.code(), Some(3));
}

/// Fields of a protobuf message by their numbers: numbers as bits.
fn numbers(mut message: &[u8]) -> BTreeMap<u64, u64> {
    fn varint(bytes: &mut &[u8]) -> u64 {
        let mut value = 0;
        for shift in (0..).step_by(7) {
            let (first, rest) = bytes.split_first().unwrap();
            *bytes = rest;
            value |= u64::from(first & 0x7f) << shift;
            if first & 0x80 == 0 {
                return value;
            }
        }
        value
    }
    let mut found = BTreeMap::new();
    while !message.is_empty() {
        let tag = varint(&mut message);
        match tag & 7 {
            1 => {
                let (value, rest) = message.split_first_chunk::<8>().unwrap();
                found.insert(tag >> 3, u64::from_le_bytes(*value));
                message = rest;
            }
            2 => {
                let length = varint(&mut message) as usize;
                message = &message[length..];
            }
            other => panic!("wire type {other}"),
        }
    }
    found
}

#[test]
fn a_recording_has_a_message_a_sample_in_the_order_of_time_and_the_same_bytes_twice() {
    let folder = tempfile::tempdir().unwrap();
    done(&view(&golden(), folder.path(), &[]));
    let bytes = fs::read(folder.path().join("view.mcap")).unwrap();
    done(&view(&golden(), folder.path(), &[]));
    assert!(bytes == fs::read(folder.path().join("view.mcap")).unwrap() && bytes.len() < 5_000_000, "{}", bytes.len());
    let mut last = 0;
    let mut fields: BTreeMap<(String, u64), Bits> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap) {
        assert!(message.log_time >= last && message.channel.schema.as_ref().unwrap().encoding == "protobuf");
        last = message.log_time;
        for (number, value) in numbers(&message.data) {
            let of = fields.entry((message.channel.topic.clone(), number)).or_default();
            of.insert(i64::try_from(message.log_time).unwrap() - 1_000_000_000, value);
        }
    }
    let expected = of_artifacts();
    for (topic, of) in [
        ("/test/accel_g/unfiltered", 0),
        ("/model/double-spring-mass-damper/direct-fit/1", 3),
        ("/model/double-spring-mass-damper/direct-fit/1/mass1", 4),
    ] {
        let own: Vec<&Bits> = fields.iter().filter(|((name, _), _)| name == topic).map(|(_, bits)| bits).collect();
        assert!(own.contains(&&expected[of].1), "{topic}");
    }
    assert!(fields.keys().any(|(topic, _)| topic.starts_with("/prediction/2_at_") && topic.ends_with("_km_per_h")));
    assert!(["/event", "/summary"].iter().all(|name| fields.keys().any(|(topic, _)| topic == name)));
    for layout in ["view.foxglove.json", "view.plotjuggler.xml"] {
        let text = fs::read_to_string(folder.path().join(layout)).unwrap();
        assert!(text.contains("/test/accel_g") && text.contains("displacement_m"), "{text}");
    }
    // Neither somebody else's file nor the folder of a run.
    fs::write(folder.path().join("mine.mcap"), "mine").unwrap();
    assert_eq!(view(&golden(), folder.path(), &["-o", "mine.mcap"]).status.code(), Some(2));
    let inside = golden().join("view.mcap");
    assert_eq!(view(&golden(), folder.path(), &["-o", inside.to_str().unwrap()]).status.code(), Some(2));
}

/// A run folder whose channels have these names.
fn run_with_channels(names: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = ArtifactBuilder::new();
    for (number, name) in names.iter().enumerate() {
        let samples = (0..100).map(|k| f64::from(k) + number as f64).collect();
        builder.wave(name, QuantityKind::Acceleration, Sampled::new(-2.5, 1e-3, samples).unwrap()).unwrap();
    }
    let provenance = Provenance::new("filter", "0", "{}".to_owned(), vec![]);
    builder.write(&folder.path().join("2-filter.mcap"), &provenance, Compression::None).unwrap();
    fs::write(folder.path().join("summary.json"), "{\"schema\": \"crumple.summary.v1\"}").unwrap();
    folder
}

#[test]
fn channels_of_any_name_have_topics_and_columns_of_their_own() {
    let long = "x".repeat(300);
    let names = ["a b", "a_b", "ü/..", "=1+1", long.as_str()];
    let run = run_with_channels(&names);
    let folder = tempfile::tempdir().unwrap();
    done(&view(run.path(), folder.path(), &[]));
    let bytes = fs::read(folder.path().join("view.mcap")).unwrap();
    let mut topics: BTreeMap<String, (String, u64)> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap) {
        let id = message.channel.metadata.get("id").cloned().unwrap_or_default();
        topics.entry(message.channel.topic.clone()).or_insert((id, message.log_time));
    }
    let of_test: Vec<_> = topics.iter().filter(|(topic, _)| topic.starts_with("/test/")).collect();
    assert_eq!(of_test.len(), names.len(), "{topics:?}");
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_/-".contains(c);
    assert!(of_test.iter().all(|(topic, _)| topic.chars().all(is_plain)), "{topics:?}");
    assert!(names.iter().all(|name| of_test.iter().any(|(_, (id, _))| id == name)), "{topics:?}");
    // The record begins 2.5 s before time zero: that is at 3 s.
    assert!(of_test.iter().all(|(_, (_, time))| *time == 500_000_000), "{topics:?}");
    done(&export(run.path(), folder.path(), &["--to", "csv"]));
    let waves = fs::read_to_string(folder.path().join("export/waves.csv")).unwrap();
    assert!(waves.lines().next().unwrap().contains(",'=1+1/acceleration_m_per_s2,"), "{waves}");
}

#[test]
fn a_candidate_is_written_as_a_modelica_model() {
    let folder = tempfile::tempdir().unwrap();
    done(&export(&golden(), folder.path(), &["--to", "modelica", "-o", "own.mo"]));
    let text = fs::read_to_string(folder.path().join("own.mo")).unwrap();
    assert!(text.starts_with("model Candidate \"") && text.ends_with("end Candidate;\n"), "{text}");
    let id = "double-spring-mass-damper/direct-fit/1";
    done(&export(&golden(), folder.path(), &["--to", "modelica", "--candidate", id]));
    let of_double = fs::read_to_string(folder.path().join("model.mo")).unwrap();
    assert!(of_double.contains(id) && of_double.contains("der(v2) = a2;"), "{of_double}");
    for (words, said) in [
        (&["--to", "modelica", "--candidate", "double"][..], "has no candidate"),
        (&["--to", "modelica", "--what", "waves"][..], "are for tables"),
        (&["--to", "csv", "--candidate", id][..], "--candidate is for a model"),
    ] {
        let refused = export(&golden(), folder.path(), words);
        let error = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && error.contains(said), "{error}");
    }
}
