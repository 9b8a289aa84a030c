//! What a person chooses: ambiguous columns, channels off the compartment, flags that say nothing to a format.

use std::fs;

use crumple_ingest::{IngestError, IngestSettings, Ingested};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;

use crate::{given, lenient, notes, open, program, read_as, write};

fn channel(name: &str) -> IngestSettings {
    given(&format!("--allow-missing --channel {name}"))
}

fn read(text: &str, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    read_as("a.csv", text, settings)
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
    let error = read(&text, &channel("accel_g")).unwrap_err();
    assert_eq!(error.to_string(), "a.csv: columns 2, 3 are all named \"accel_g\"");
    assert_eq!(error.hint(), "give its number, such as --channel 2");
    let third = read(&text, &channel("3")).unwrap();
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
    assert_eq!(read(&text, &channel("accel_g-2")).unwrap().test.pulse.as_deref(), Some("accel_g-2"));
    assert_eq!(read(&text, &channel("Accel_g")).unwrap().test.pulse.as_deref(), Some("Accel_g"));
    // Without the unit two columns have one name.
    let text = table("time_s,a (g),a (m/s^2)");
    let error = read(&text, &channel("a")).unwrap_err();
    assert_eq!(error.to_string(), "a.csv: columns 2, 3 are all named \"a\"");
    let metric = read(&text, &channel("a (m/s^2)")).unwrap();
    assert_eq!(metric.pulse().unwrap().samples.samples()[10], 20.0);
}

#[test]
fn a_table_of_one_displacement_is_a_record_where_mass_and_speed_may_be_missing() {
    let kinds = |settings: &IngestSettings, header: &str| {
        let read = read(&table(header), settings).map_err(|error| error.to_string())?;
        Ok::<_, String>(read.test.channels.iter().map(|channel| channel.quantity).collect::<Vec<_>>())
    };
    assert_eq!(kinds(&given("--allow-missing"), "time_s,y (mm)"), Ok(vec![QuantityKind::Displacement]));
    // The channel that is asked for is to be a crash pulse.
    assert_eq!(kinds(&channel("y"), "time_s,y (mm)").unwrap_err(), "a.csv: channel y measures displacement");
    // A crash is not one, nor is a number of unknown unit.
    assert!(kinds(&given(""), "time_s,y (mm)").is_err() && kinds(&given("--allow-missing"), "time_s,y").is_err());
}

#[test]
fn a_pulse_that_is_not_on_the_compartment_is_warned_about() {
    let warning = |ingested: &Ingested| {
        let found: Vec<String> =
            ingested.notes.to_texts().into_iter().filter(|n| n.contains("may not show the motion")).collect();
        assert!(found.len() <= 1, "{found:?}");
        found.into_iter().next().unwrap_or_default()
    };
    let of_table = |title: &str| warning(&read(&table(&format!("time_s,{title}")), &lenient()).unwrap());
    assert_eq!(of_table("accel_x_g"), "");
    assert!(of_table("accel_z_g").contains("it measures along z, not along x; nothing else is here"));
    assert!(of_table("engine_acc_g").contains("it sits elsewhere (engine)"));
    let asked = read(&table("time_s,accel_x_g,head_acc_x_g"), &channel("head_acc_x_g")).unwrap();
    assert!(warning(&asked).contains("it sits elsewhere (head); taken as asked for"), "{}", warning(&asked));

    let samples: String = (0..100).map(|k| format!("{k}\n")).collect();
    let of_code = |code: &str| {
        let text =
            format!("Channel code :{code}\nUnit :g\nSampling interval :1e-4\nTime of first sample :-0.001\n{samples}");
        warning(&read_as("a.001", text, &lenient()).unwrap())
    };
    assert_eq!(of_code("10SECMLERE00ACXP"), "");
    assert!(of_code("11HEADCG00H3ACXA").contains("may not show the motion of the compartment"));

    let Some(ev5) = shared("data/nhtsa-v10146-camry-frontal/v10146.EV5") else { return };
    assert_eq!(warning(&open(&ev5, &IngestSettings::default()).unwrap()), "");
    let engine = warning(&open(&ev5, &channel("96")).unwrap());
    assert!(engine.starts_with("warning: channel 96 (bottom of engine)"), "{engine}");
}

#[test]
fn flags_that_say_nothing_to_a_format_are_named() {
    const ALL: &str = "--allow-missing --unit g --time-unit s --sample-time 1ms --profile edr --skip-to table \
        --field x --resample 20Hz --vehicle-number 1";
    let unheeded = |ingested: &Ingested| -> Vec<String> {
        let said = |n: String| Some(n.strip_prefix("warning: ")?.split_once(" has no effect")?.0.to_owned());
        ingested.notes.to_texts().into_iter().filter_map(said).collect()
    };
    let text = "Channel code :10SECMLERE00ACXP\nUnit :g\nSampling interval :1e-4\nTime of first sample :-0.001\n";
    let samples: String = (0..100).map(|k| format!("{k}\n")).collect();
    let iso = read_as("a.001", format!("{text}{samples}"), &given(ALL)).unwrap();
    let but_two = ["--unit", "--time-unit", "--sample-time", "--profile", "--skip-to", "--field", "--resample"];
    assert_eq!(unheeded(&iso), but_two);
    // A unit is heeded where a column lacks one, and said to be unused where all have one.
    for (header, flags, said) in [
        ("time_s,accel_g", "--field x", "--field"),
        ("time_s,accel_g", "--vehicle-number 1", "--vehicle-number"),
        ("time_s,accel_g", "", ""),
        ("time_s,accel", "--unit g", ""),
        ("time_s,a1 (m/s^2),a2 (m/s^2)", "--unit g", "--unit"),
    ] {
        let read = read(&table(header), &given(&format!("--allow-missing {flags}"))).unwrap();
        assert_eq!(unheeded(&read).join(" "), said, "{header} {flags}");
    }
    // All but those that the format heeds; --time-unit is that of the steps.
    for (path, channel, said) in [
        (
            "nhtsa-v10146-camry-frontal/v10146.EV5",
            "",
            "--unit --time-unit --sample-time --profile --skip-to --field --resample",
        ),
        (
            "iihs-diadem-tdms/Target Pulse.tdms",
            "--channel IIWPG Acceleration",
            "--resample --sample-time --vehicle-number --profile --skip-to --field",
        ),
        (
            "shock-table-lvm/Test_002.lvm",
            "",
            "--unit --resample --sample-time --vehicle-number --profile --skip-to --field",
        ),
        (
            "ros-imu-bag/tilt_laser.bag",
            "--channel acceleration_x",
            "--unit --time-unit --sample-time --profile --skip-to --field --vehicle-number",
        ),
    ] {
        let Some(path) = shared(&format!("data/{path}")) else { continue };
        let ingested = open(&path, &given(&format!("{ALL} {channel}"))).unwrap();
        assert_eq!(unheeded(&ingested).join(" "), said, "{}", path.display());
    }
}

fn list(content: &str, flags: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[("a.csv", content)]);
    let done = program(&folder.path().join("a.csv"), &[&["--list"], flags].concat());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is written");
    done
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
    write(folder.path(), &[("v1.EV5", &ev5), ("v1.007", &rows), ("v1.008", &rows.replacen("0.5", "what", 1))]);
    let (code, said, error) = program(&folder.path().join("v1.EV5"), &["--list", "--json"]);
    assert_eq!(code, 0, "{error}");
    let lines: Vec<serde_json::Value> = said.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let status: Vec<_> = lines.iter().map(|l| l["status"].as_str().unwrap()).collect();
    assert_eq!(status, ["valid", "not read", "absent"]);
    let comment = lines[1]["comment"].as_str().unwrap();
    assert!(comment.contains("v1.008, line 1") && comment.contains("what"), "{comment}");
}
