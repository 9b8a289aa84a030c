//! The acceptance list of ingest, item by item; each is backed by a record of the reference material.

use std::fs;
use std::io::{Cursor, Read as _, Write as _};
use std::path::Path;
use std::process::Command;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, ingest, list};
use crumple_signal::{ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;
use zip::write::SimpleFileOptions;

use crate::{lenient, notes};

fn read(path: &Path, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    ingest(&Bundle::open(path)?, settings)
}

fn channel(id: &str) -> IngestSettings {
    IngestSettings { channel: Some(id.to_owned()), ..IngestSettings::default() }
}

/// Exit code, stdout and stderr of the program.
fn program(path: &Path, flags: &[&str]) -> (i32, String, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_crumple-ingest")).arg(path).args(flags).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (done.status.code().unwrap(), text(done.stdout), text(done.stderr))
}

/// The EV5 file, its signal files and those of the barrier archive as one archive, as it is downloaded.
fn whole_camry(folder: &Path) -> Vec<u8> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("v10146.") {
            files.push((name, fs::read(&path).unwrap()));
        }
    }
    let mut barrier = zip::ZipArchive::new(fs::File::open(folder.join("v10146_barrier_fx.zip")).unwrap()).unwrap();
    for k in 0..barrier.len() {
        let mut entry = barrier.by_index(k).unwrap();
        let name = entry.name().unwrap().rsplit('/').next().unwrap().to_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        files.push((name, bytes));
    }
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(format!("v10146ascii/{name}"), SimpleFileOptions::default()).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn item_1_nhtsa_10146_and_its_crossmember() {
    let Some(folder) = shared("data/nhtsa-v10146-camry-frontal") else { return };
    let ev5 = folder.join("v10146.EV5");
    let ingested = read(&ev5, &channel("93")).unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (3500, -0.05, 1e-4));
    assert_eq!(pulse.quantity, QuantityKind::Acceleration);
    let test = &ingested.test;
    assert_eq!(test.channel("93").unwrap().initial_velocity_m_per_s, Some(57.09 / 3.6));
    assert!((57.09_f64 / 3.6 - 15.858_333).abs() < 1e-6);
    assert_eq!(test.mass_kg, Some(1719.0));
    assert!(test.notes.iter().any(|n| n.contains("static crush 518 mm")));

    let engine = read(&ev5, &channel("96")).unwrap();
    assert_eq!(engine.pulse().unwrap().samples.len(), 1170);
    assert!(notes(&engine).contains(
        "warning: channel 96 is questionable by its laboratory: BOTTOM OF ENGINE X: No valid data after 67ms"
    ));

    let belt = read(&ev5, &channel("45")).unwrap_err();
    assert!(belt.to_string().contains("not installed"), "{belt}");
    assert!(belt.to_string().contains("no file is missing"), "{belt}");
}

#[test]
fn item_2_the_same_from_the_zip_with_the_barrier() {
    let Some(folder) = shared("data/nhtsa-v10146-camry-frontal") else { return };
    let work = tempfile::tempdir().unwrap();
    let zip = work.path().join("v10146.zip");
    fs::write(&zip, whole_camry(&folder)).unwrap();
    let ingested = read(&zip, &IngestSettings::default()).unwrap();
    assert_eq!((ingested.test.channels.len(), ingested.waves.len()), (634, 189));
    let unpacked = read(&folder.join("v10146.EV5"), &IngestSettings::default()).unwrap();
    assert_eq!(ingested.pulse().unwrap().samples, unpacked.pulse().unwrap().samples);
    for cell in ["347", "500"] {
        assert_eq!(ingested.test.channel(cell).unwrap().status, ChannelStatus::Questionable);
        assert!(notes(&ingested).contains(&format!("channel {cell} is questionable")));
    }
    let cells = list(&Bundle::open(&zip).unwrap(), &channel("LC* XG")).unwrap();
    assert_eq!(cells.iter().filter(|c| c.samples > 0).count(), 176);
    assert!(cells.iter().filter(|c| c.samples > 0).all(|c| c.quantity == "force" && c.axis.as_deref() == Some("x")));
}

#[test]
fn item_4_one_iso_mme_channel_by_itself() {
    let Some(path) = shared("data/iso-mme-98_7707/98_7707.001") else { return };
    let ingested = read(&path, &lenient()).unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (3001, -0.05, 1e-4));
    assert_eq!(pulse.samples.samples()[0], -1.421_09e-13 * G);
    let channel = &ingested.test.channels[0];
    assert_eq!(channel.code.as_deref(), Some("11HEADCGCGH3ACXA"));
    assert_eq!((channel.cfc, channel.filter_state.as_deref()), (Some(1000), Some("CFC 1000")));
    let text = notes(&ingested);
    assert!(text.contains("warning: 98_7707.001: reference channel not stated, assumed implicit"), "{text}");
    // The stated extremes fit the samples, the time of the minimum being the end of a plateau: nothing is said.
    assert!(!text.contains("the header states"), "{text}");
    assert!(
        (pulse.quality.record.maximum / G - 51.1861).abs() < 1e-9
            && (pulse.quality.record.minimum / G + 7.035_05).abs() < 1e-9
    );
}

#[test]
fn item_10_the_accord_record_asks_for_its_unit() {
    let Some(path) = shared("data/iihs-cep1705-accord/CEP1705_ACXD.csv") else { return };
    let error = read(&path, &lenient()).unwrap_err();
    assert!(error.to_string().contains("no unit is stated") && error.hint().contains("--unit g"), "{error}");
    let ingested = read(&path, &IngestSettings { unit: Some("g".to_owned()), ..lenient() }).unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (6000, -0.0999, 1e-4));
    assert!(pulse.quality.record.time_jitter > 0.0 && pulse.quality.record.time_jitter < 1e-3);
}

#[test]
fn item_11_shock_texts_keep_their_interval_and_report_clipping() {
    let Some(folder) = shared("data/pcb-shock-txt") else { return };
    let base = read(&folder.join("acc_base_a0.txt"), &lenient()).unwrap();
    let pulse = base.pulse().unwrap();
    assert_eq!(pulse.samples.len(), 1439);
    // Stated with the record to six digits.
    assert!((pulse.samples.dt_s() - 2.000_28e-5).abs() < 1e-10, "{}", pulse.samples.dt_s());
    let board = read(&folder.join("acc_pcb_a0.txt"), &lenient()).unwrap();
    assert!(notes(&board).contains("may be clipped"));
    assert!((board.pulse().unwrap().quality.record.maximum / G - 546.555).abs() < 1e-3);
}

#[test]
fn item_12_kilo_g_in_a_second_header_line() {
    let Some(path) = shared("data/drop-tower-csv/accel_1.csv") else { return };
    let ingested = read(&path, &IngestSettings { channel: Some("accel_1".to_owned()), ..lenient() }).unwrap();
    // Largest value of the first drop, stated to four digits.
    assert!((ingested.pulse().unwrap().quality.record.maximum / (1e3 * G) - 21.41).abs() < 0.005);
    let text = notes(&ingested);
    assert!(
        text.contains("kilo-g") && text.contains("warning: 7 names in the header of accel_1.csv, but 6 columns"),
        "{text}"
    );
}

#[test]
fn item_13_topics_of_a_bag_and_of_an_mcap_file() {
    let Some(bag) = shared("data/ros-imu-bag/tilt_laser.bag") else { return };
    let (code, table, _) = program(&bag, &["--list"]);
    assert_eq!(code, 0);
    assert!(table.contains("imu_data-acceleration_x") && table.contains("needs --resample"), "{table}");
    let Some(mcap) = shared("data/mcap-json/example.mcap") else { return };
    let (code, _, text) = program(&mcap, &["--list"]);
    assert_eq!(code, 3);
    assert!(text.contains("no topic with acceleration; its topics: mouse (MouseEvent, json, 111 messages)"), "{text}");
}

#[test]
fn item_14_every_refusal_names_file_place_expectation_and_remedy() {
    let work = tempfile::tempdir().unwrap();
    let rows: String = (0..100).map(|k| format!("{:.4},{k}\n", f64::from(k) * 1e-4)).collect();
    let cases: [(&str, Vec<u8>, &str); 11] = [
        (
            "a.csv",
            format!("time_s,accel_g\n{}", rows.replacen(",7\n", ",x\n", 1)).into_bytes(),
            "a.csv, line 9, column 2",
        ),
        ("b.csv", format!("time_s,accel\n{rows}").into_bytes(), "b.csv, column 2 (accel)"),
        (
            "c.001",
            b"Channel code :10VEHC000000ACX0\nUnit :g\nSampling interval :1e-4\n1\n2\nx\n".to_vec(),
            "c.001, line 6",
        ),
        ("d.001", b"Channel code :10VEHC000000ACX0\nUnit :g\n1\n2\n".to_vec(), "d.001: no sampling interval"),
        ("e.bag", b"#ROSBAG V2.0\n\x09\0\0\0".to_vec(), "e.bag: a record is cut short (byte 13)"),
        ("f.mcap", b"\x89MCAP0\r\n".to_vec(), "f.mcap: the MCAP file cannot be read"),
        ("g.001", rows.replace(',', "\t").into_bytes(), "g.001, column 2"),
        ("h.EV5", b"----- EV5 -----\n----- TEST -----\nV5|T\n".to_vec(), "h.EV5: no section ----- VEHICLE -----"),
        ("i.db3", b"SQLite format 3\0\0\0".to_vec(), "i.db3 is "),
        ("j.csv", Vec::new(), "j.csv: the file is empty"),
        ("k.dat", vec![0; 100], "k.dat: binary data of an unknown kind"),
    ];
    for (name, content, place) in cases {
        let path = work.path().join(name);
        fs::write(&path, content).unwrap();
        let output = work.path().join("out.mcap");
        let (code, _, text) = program(&path, &["-o", output.to_str().unwrap(), "--allow-missing"]);
        assert_eq!(code, 3, "{name}: {text}");
        assert!(text.contains(place), "{place}: {text}");
        assert!(text.contains("expected: ") && text.contains("hint: "), "{name}: {text}");
        assert!(!output.exists());
    }
}

#[test]
fn a_signal_file_without_its_specification_is_told_from_an_iso_channel() {
    let Some(nhtsa) = shared("data/nhtsa-v10146-camry-frontal/v10146.093") else { return };
    let error = read(&nhtsa, &lenient()).unwrap_err();
    assert!(error.hint().contains("giving its .EV5 file"), "{}", error.hint());
    let alone = read(&nhtsa, &IngestSettings { unit: Some("g".to_owned()), ..lenient() }).unwrap();
    assert_eq!(alone.pulse().unwrap().samples.len(), 3500);
}

#[test]
fn records_for_identification_need_neither_time_column_nor_crash() {
    let Some(folder) = shared("data/sysid") else { return };
    let stated = |interval: &str| IngestSettings { sample_time: Some(interval.parse().unwrap()), ..lenient() };
    let dryer = read(&folder.join("hair-dryer/dryer.dat"), &stated("0.08s")).unwrap();
    assert_eq!((dryer.waves.len(), dryer.test.pulse.as_deref()), (2, None));
    let input = &dryer.waves[0];
    assert_eq!((input.quantity, input.samples.len(), input.samples.dt_s()), (QuantityKind::Other, 1000, 0.08));
    assert_eq!(input.samples.samples()[..2], [6.41, 3.41]);
    let frame = folder.join("steel-subframe-a/steel_subframe_u1u2_y01-y06.csv");
    let frame =
        read(&frame, &IngestSettings { sample_time: Some("0.0009765625s".parse().unwrap()), ..lenient() }).unwrap();
    assert_eq!((frame.waves.len(), frame.waves[0].id.as_str(), frame.waves[7].samples.rate_hz()), (8, "u1", 1024.0));
}
