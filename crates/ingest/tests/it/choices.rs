//! What a person chooses: ambiguous columns, channels off the compartment, flags that say nothing to a format.

use std::fs;
use std::path::Path;
use std::process::Command;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, Profile, ingest};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use crumple_testkit::shared;

use crate::{lenient, notes};

fn channel(name: &str) -> IngestSettings {
    IngestSettings { channel: Some(name.to_owned()), ..lenient() }
}

fn read(name: &str, text: &str, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    ingest(&Bundle::from_bytes(name, text.as_bytes().to_vec())?, settings)
}

fn open(path: &Path, settings: &IngestSettings) -> Ingested {
    ingest(&Bundle::open(path).unwrap(), settings).unwrap()
}

/// A table with a header and rows of which column `k` counts in steps of `k`.
fn table(header: &str) -> String {
    let columns = header.split(',').count();
    let row = |n: usize| (1..columns).map(|k| format!(",{}", n * k)).collect::<String>();
    let rows: String = (0..100).map(|n| format!("{:.4}{}\n", n as f64 * 1e-4, row(n))).collect();
    format!("{header}\n{rows}")
}

#[test]
fn one_of_several_columns_with_one_title_is_taken_by_its_number_only() {
    let text = table("time_s,accel_g,accel_g,Accel_g");
    let error = read("a.csv", &text, &channel("accel_g")).unwrap_err();
    assert_eq!(error.to_string(), "a.csv: columns 2, 3 are all named \"accel_g\"");
    assert_eq!(error.hint(), "give its number, such as --channel 2");
    let third = read("a.csv", &text, &channel("3")).unwrap();
    let pulse = third.pulse().unwrap();
    // Column 3 counts in steps of two.
    assert_eq!((pulse.id.as_str(), pulse.samples.samples()[10]), ("accel_g-2", 20.0 * G));
    assert!(
        notes(&third)
            .contains("warning: 2 columns have the title \"accel_g\": column 2 is accel_g, column 3 is accel_g-2"),
        "{}",
        notes(&third)
    );
    // The same by id, and a title that differs by case alone.
    assert_eq!(read("a.csv", &text, &channel("accel_g-2")).unwrap().test.pulse.as_deref(), Some("accel_g-2"));
    assert_eq!(read("a.csv", &text, &channel("Accel_g")).unwrap().test.pulse.as_deref(), Some("Accel_g"));
    // Without the unit two columns have one name.
    let text = table("time_s,a (g),a (m/s^2)");
    let error = read("a.csv", &text, &channel("a")).unwrap_err();
    assert_eq!(error.to_string(), "a.csv: columns 2, 3 are all named \"a\"");
    let metric = read("a.csv", &text, &channel("a (m/s^2)")).unwrap();
    assert_eq!(metric.pulse().unwrap().samples.samples()[10], 20.0);
}

#[test]
fn a_word_among_the_numbers_is_named_with_its_line() {
    let late = table("time_s,accel_g").replacen("0.0050,50\n", "0.0050,overload\n", 1);
    let error = read("a.csv", &late, &lenient()).unwrap_err();
    assert_eq!(error.to_string(), "a.csv, line 52, column 2 (accel_g): \"overload\" is not a finite number");
}

#[test]
fn a_pulse_that_is_not_on_the_compartment_is_warned_about() {
    let warning = |ingested: &Ingested| {
        let found: Vec<String> =
            ingested.notes.to_texts().into_iter().filter(|n| n.contains("may not show the motion")).collect();
        assert!(found.len() <= 1, "{found:?}");
        found.into_iter().next().unwrap_or_default()
    };
    let of_table = |title: &str| warning(&read("a.csv", &table(&format!("time_s,{title}")), &lenient()).unwrap());
    assert_eq!(of_table("accel_x_g"), "");
    assert!(of_table("accel_z_g").contains("it measures along z, not along x; nothing else is here"));
    assert!(of_table("engine_acc_g").contains("it sits elsewhere (engine)"));
    let asked = read("a.csv", &table("time_s,accel_x_g,head_acc_x_g"), &channel("head_acc_x_g")).unwrap();
    assert!(warning(&asked).contains("it sits elsewhere (head); taken as asked for"), "{}", warning(&asked));

    let samples: String = (0..100).map(|k| format!("{k}\n")).collect();
    let of_code = |code: &str| {
        let text =
            format!("Channel code :{code}\nUnit :g\nSampling interval :1e-4\nTime of first sample :-0.001\n{samples}");
        warning(&read("a.001", &text, &lenient()).unwrap())
    };
    assert_eq!(of_code("10SECMLERE00ACXP"), "");
    assert!(of_code("11HEADCG00H3ACXA").contains("may not show the motion of the compartment"));

    let Some(ev5) = shared("data/nhtsa-v10146-camry-frontal/v10146.EV5") else { return };
    assert_eq!(warning(&open(&ev5, &IngestSettings::default())), "");
    let engine = warning(&open(&ev5, &channel("96")));
    assert!(engine.starts_with("warning: channel 96 (bottom of engine)"), "{engine}");
}

#[test]
fn flags_that_say_nothing_to_a_format_are_named() {
    let all = IngestSettings {
        unit: Some("g".to_owned()),
        time_unit: Some("s".to_owned()),
        sample_time: Some("1ms".parse().unwrap()),
        profile: Some(Profile::Edr),
        skip_to: Some("table".to_owned()),
        field: Some("x".to_owned()),
        resample: Some("20Hz".parse().unwrap()),
        vehicle_number: Some(1),
        ..lenient()
    };
    let flags = |ingested: &Ingested| -> Vec<String> {
        let said = |n: String| Some(n.strip_prefix("warning: ")?.split_once(" has no effect")?.0.to_owned());
        ingested.notes.to_texts().into_iter().filter_map(said).collect()
    };
    let text = "Channel code :10SECMLERE00ACXP\nUnit :g\nSampling interval :1e-4\nTime of first sample :-0.001\n";
    let samples: String = (0..100).map(|k| format!("{k}\n")).collect();
    let iso = read("a.001", &format!("{text}{samples}"), &all).unwrap();
    assert_eq!(
        flags(&iso),
        ["--unit", "--time-unit", "--sample-time", "--profile", "--skip-to", "--field", "--resample"]
    );
    let table = |header: &str, settings: IngestSettings| flags(&read("a.csv", &table(header), &settings).unwrap());
    let some = |flag: &str| match flag {
        "--field" => IngestSettings { field: all.field.clone(), ..lenient() },
        "--vehicle-number" => IngestSettings { vehicle_number: all.vehicle_number, ..lenient() },
        _ => lenient(),
    };
    for flag in ["--field", "--vehicle-number"] {
        assert_eq!(table("time_s,accel_g", some(flag)), [flag]);
    }
    assert_eq!(table("time_s,accel_g", lenient()), [""; 0]);
    // A unit is heeded where a column lacks one, and said to be unused where all have one.
    let unit = || IngestSettings { unit: Some("g".to_owned()), ..lenient() };
    assert_eq!(table("time_s,accel", unit()), [""; 0]);
    assert_eq!(table("time_s,a1 (m/s^2),a2 (m/s^2)", unit()), ["--unit"]);

    if let Some(ev5) = shared("data/nhtsa-v10146-camry-frontal/v10146.EV5") {
        assert_eq!(flags(&open(&ev5, &all)).len(), 7, "all but --vehicle-number");
    }
    if let Some(tdms) = shared("data/iihs-diadem-tdms/Target Pulse.tdms") {
        let found =
            flags(&open(&tdms, &IngestSettings { channel: Some("IIWPG Acceleration".to_owned()), ..all.clone() }));
        assert_eq!(
            found,
            ["--resample", "--sample-time", "--vehicle-number", "--profile", "--skip-to", "--field"],
            "--time-unit is that of the steps"
        );
    }
    if let Some(lvm) = shared("data/shock-table-lvm/Test_002.lvm") {
        let found = flags(&open(&lvm, &all));
        assert!(found.contains(&"--sample-time".to_owned()) && found.contains(&"--unit".to_owned()), "{found:?}");
        assert!(found.contains(&"--vehicle-number".to_owned()), "{found:?}");
    }
    if let Some(bag) = shared("data/ros-imu-bag/tilt_laser.bag") {
        let found = flags(&open(&bag, &IngestSettings { channel: Some("acceleration_x".to_owned()), ..all.clone() }));
        assert!(found.len() == 7 && !found.contains(&"--resample".to_owned()), "{found:?}");
    }
}

fn list(content: &str, flags: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    fs::write(&path, content).unwrap();
    let done =
        Command::new(env!("CARGO_BIN_EXE_crumple-ingest")).arg("--list").arg(&path).args(flags).output().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is written");
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (done.status.code().unwrap(), text(done.stdout), text(done.stderr))
}

fn three_axes() -> String {
    let rows: String = (0..100).map(|k| format!("{:.4},{k},{k},{k}\n", f64::from(k) * 1e-4)).collect();
    format!("time_s,accel_x_cfc60_g,force [kN],note\n{rows}")
}

#[test]
fn the_table_has_a_line_a_channel() {
    let (code, text, _) = list(&three_axes(), &[]);
    assert_eq!(code, 0);
    let cells: Vec<Vec<&str>> = text.lines().map(|line| line.split_whitespace().collect()).collect();
    let head = "id code location attached axis quantity unit rate_hz samples cfc status comment";
    let head: Vec<&str> = head.split(' ').collect();
    assert_eq!(cells[0], head);
    assert_eq!(
        cells[1],
        ["accel_x_cfc60_g", "-", "-", "-", "x", "acceleration", "m/s^2", "10000", "100", "60", "valid", "-"]
    );
    assert_eq!(cells[2], ["force", "-", "-", "-", "-", "force", "N", "10000", "100", "-", "valid", "-"]);
    assert_eq!(cells[3][5], "other");
    let (_, text, _) = list(&three_axes(), &["--search", "FORCE", "--with-data"]);
    assert_eq!(text.lines().count(), 2, "{text}");
    assert_eq!(cells.len(), 4);
}

#[test]
fn as_json_each_line_is_an_object() {
    let (code, text, _) = list(&three_axes(), &["--json", "--channel", "f*"]);
    assert_eq!((code, text.lines().count()), (0, 1));
    let line: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (line["id"].as_str(), line["samples"].as_u64(), line["cfc"].is_null()),
        (Some("force"), Some(100), true)
    );
}

#[test]
fn refusals_and_slips_have_their_exit_codes() {
    let (code, _, text) = list(&three_axes(), &["--channel", "zzz*"]);
    assert!(code == 3 && text.contains("--channel zzz* means none of its 3 channels"), "{text}");
    let (code, _, text) = list("%PDF-1.7\n", &[]);
    assert!(code == 3 && text.contains("PDF"), "{text}");
    let (code, ..) = list(&three_axes(), &["--no-such-flag"]);
    assert_eq!(code, 2);
}

#[test]
fn a_damaged_signal_file_is_listed_as_not_read_and_one_that_is_not_here_as_absent() {
    let folder = tempfile::tempdir().unwrap();
    let line = |curve: u32| format!("1|{curve}|AC|NA|FLLR|XG|SEC|G'S|2800||||| 57.0|-100|299|100|AM|P|FLOOR X\n");
    let ev5 = format!(
        "----- EV5 -----\n----- TEST -----\nV5|T\n----- VEHICLE -----\n1|1\n----- INSTRUMENTATION -----\n{}{}{}\
         ----- END -----\n",
        line(7),
        line(8),
        line(9)
    );
    let rows: String = (-100..300).map(|k| format!("{:.6}\t0.5\n", f64::from(k) * 1e-4)).collect();
    fs::write(folder.path().join("v1.EV5"), ev5).unwrap();
    fs::write(folder.path().join("v1.007"), &rows).unwrap();
    fs::write(folder.path().join("v1.008"), rows.replacen("0.5", "what", 1)).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_crumple-ingest"))
        .args(["--list", "--json"])
        .arg(folder.path().join("v1.EV5"))
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let lines: Vec<serde_json::Value> =
        String::from_utf8(done.stdout).unwrap().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let status: Vec<_> = lines.iter().map(|l| l["status"].as_str().unwrap()).collect();
    assert_eq!(status, ["valid", "not read", "absent"]);
    let comment = lines[1]["comment"].as_str().unwrap();
    assert!(comment.contains("v1.008, line 1") && comment.contains("what"), "{comment}");
}
