//! `crumple-damage` as it is typed: numbers by hand, runs of barrier tests, refusals with their codes.

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{DamageV1, MetricV1, MetricsV2, SourceV1, TestV1};
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use serde_json::Value;

fn damage(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-damage")).args(words).current_dir(folder).output().unwrap()
}

fn json(folder: &Path, words: &[&str]) -> Value {
    let output = damage(folder, &[words, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn close(value: &Value, exact: f64, share: f64) {
    let value = value.as_f64().unwrap();
    assert!((value / exact - 1.0).abs() < share, "{value} is not {exact}");
}

const EVEN: [&str; 6] = ["--profile", "40,40,40 cm", "--width", "1.5m", "--mass", "1500kg"];

/// By hand: b1 = (20 - 2)/0.5 = 36 1/s, A = 1500·2·36/1.5, B = 1500·36²/1.5; even crush of 0.4 m: 2 + 36·0.4 m/s.
#[test]
fn one_test_gives_the_speed_of_an_even_profile_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    let typed = ["--test", "1500kg,20m/s,50cm,1.5m", "--no-damage-speed", "2m/s"];
    let found = json(folder.path(), &[&typed[..], &EVEN].concat());
    let stiffness = &found["vehicle"]["stiffness"];
    close(&stiffness["a_n_per_m"], 72e3, 1e-12);
    close(&stiffness["b_n_per_m2"], 1.296e6, 1e-12);
    close(&stiffness["g_n"], 2000.0, 1e-12);
    let of = &found["vehicle"]["damage"];
    close(&of["equivalent_barrier_speed_m_per_s"], 16.4, 1e-12);
    close(&of["energy_j"], 0.5 * 1500.0 * 16.4 * 16.4, 1e-12);
    assert!(of["energy_interval_j"].is_null() && found["collision"].is_null());
    assert!(found["warnings"][0].as_str().unwrap().contains("no interval"));
    let oblique = json(folder.path(), &[&typed[..], &EVEN, &["--angle", "-45deg"]].concat());
    close(&oblique["vehicle"]["damage"]["energy_j"], 1500.0 * 16.4 * 16.4, 1e-12);
    // Without a profile the stiffness alone.
    assert!(json(folder.path(), &typed)["vehicle"]["damage"].is_null());
}

#[test]
fn the_file_holds_what_json_prints_and_replaces_no_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let typed = [&["--stiffness", "55kN/m,400kN/m^2"][..], &EVEN].concat();
    let printed = json(folder.path(), &typed);
    let to_file = |name: &str| damage(folder.path(), &[&typed[..], &["-o", name]].concat());
    for _ in 0..2 {
        assert!(to_file("damage.json").status.success());
    }
    let written: Value = serde_json::from_slice(&std::fs::read(folder.path().join("damage.json")).unwrap()).unwrap();
    assert_eq!(written, printed);
    assert_eq!(written["schema"], "crumple.damage.v1");
    std::fs::write(folder.path().join("own.json"), "{\"mine\": 1}").unwrap();
    assert_eq!(to_file("own.json").status.code(), Some(2));
}

/// Four tests on a line but for errors: the truth lies in the intervals, and the interval of one vehicle is wider.
#[test]
fn several_tests_have_intervals() {
    let folder = tempfile::tempdir().unwrap();
    // b0 = 2 m/s, b1 = 25 1/s.
    let tests = ["1500kg,9.6m/s,30cm,1.5m", "1500kg,11.9m/s,40cm,1.5m", "1500kg,14.6m/s,50cm,1.5m"];
    let typed: Vec<&str> = tests.iter().flat_map(|test| ["--test", test]).chain(EVEN).collect();
    let found = json(folder.path(), &typed);
    let ends = |value: &Value| [0, 1].map(|end| value[end].as_f64().unwrap());
    let of = &found["vehicle"]["damage"];
    let [low, high] = ends(&of["equivalent_barrier_speed_interval_m_per_s"]);
    let [lowest, highest] = ends(&of["one_vehicle_interval_m_per_s"]);
    assert!(lowest < low && low < 12.0 && 12.0 < high && high < highest);
    assert_eq!(found["vehicle"]["stiffness"]["degrees_of_freedom"], 1);
    let two = json(folder.path(), &[&typed[..4], &EVEN].concat());
    assert!(two["warnings"][0].as_str().unwrap().contains("two tests always lie on a line"));
    let wild = ["1500kg,11m/s,32cm,1.5m", "1500kg,13m/s,60cm,1.5m", "1500kg,16m/s,48cm,1.5m"];
    let wild: Vec<&str> = wild.iter().flat_map(|test| ["--test", test]).collect();
    assert!(json(folder.path(), &wild)["warnings"].to_string().contains("the interval of b1 holds zero"));
    let lines = text(&damage(folder.path(), &typed).stdout);
    assert!(lines.contains("scatter by") && lines.contains("(95 %: ") && lines.contains("km/h"), "{lines}");
}

/// Momentum, force balance, restitution; by hand: two like vehicles close at twice the speed of a barrier test.
#[test]
fn two_vehicles_close_at_the_speed_of_both_damages() {
    let folder = tempfile::tempdir().unwrap();
    let stiffness = ["--line", "2m/s,25/s"];
    let other = ["--other-line", "2m/s,25/s", "--other-width", "1.5m", "--other-mass", "1500kg"];
    let typed = [&stiffness[..], &EVEN, &other].concat();
    let found = json(folder.path(), &typed);
    close(&found["other"]["damage"]["mean_residual_crush_m"], 0.4, 1e-12);
    assert_eq!(found["other"]["damage"]["crush_source"], "force_balance");
    let collision = &found["collision"];
    close(&collision["closing_speed_m_per_s"], 24.0, 1e-12);
    close(&collision["delta_v_m_per_s"][0], 1.1 * 12.0, 1e-12);
    close(&collision["force_ratio"], 1.0, 1e-12);
    let lost = json(folder.path(), &[&typed[..], &["--energy", "lost", "--restitution", "0.6"]].concat());
    close(&lost["collision"]["closing_speed_m_per_s"], 30.0, 1e-12);
    let levers = ["--lever", "1m", "--yaw-radius", "1m"];
    let levers = json(folder.path(), &[&typed[..], &levers].concat());
    close(&levers["collision"]["effective_mass_shares"][0], 0.5, 1e-12);
    let shallow = json(folder.path(), &[&typed[..], &["--other-profile", "5,5cm"]].concat());
    let warnings = shallow["warnings"].to_string();
    assert!(warnings.contains("beyond our limit of 1.5"), "{warnings}");
}

/// A folder that looks like the run of a barrier test.
fn run(folder: &Path, name: &str, speed: Option<f64>, crush_m: Option<f64>, a_and_b: Option<[f64; 2]>) {
    let test = TestV1 {
        title: name.to_owned(),
        vehicle: None,
        mass_kg: Some(1500.0),
        impact_speed_m_per_s: speed,
        barrier: None,
        source: SourceV1 { format: "csv".to_owned(), name: "a.csv".to_owned(), digest: "blake3:0".to_owned() },
        channels: Vec::new(),
        pulse: None,
        notes: Vec::new(),
        time_zero: None,
        exchange_asked: false,
        contact: None,
        kind: None,
        overlap: None,
    };
    let write = |file: &str, stage: &str, builder: ArtifactBuilder| {
        let provenance = Provenance::new(stage, "0", "{}".to_owned(), vec![]);
        builder.write(&folder.join(name).join(file), &provenance, Compression::None).unwrap();
    };
    let mut ingested = ArtifactBuilder::new();
    ingested.put("/test", &test).unwrap();
    if let Some(crush) = crush_m {
        let damage = DamageV1 {
            residual_crush_m: vec![crush; 6],
            damage_width_m: Some(1.5),
            vehicle_width_m: None,
            classification: Some("12FDEW2".to_owned()),
            from: "DPD1-DPD6".to_owned(),
        };
        ingested.put("/damage", &damage).unwrap();
    }
    write("1-ingest.mcap", "ingest", ingested);
    let metric = |name: &str, value: f64| MetricV1 {
        name: name.to_owned(),
        value: Some(value),
        unit: "1".to_owned(),
        channel: "a".to_owned(),
        definition: "d".to_owned(),
        ..MetricV1::default()
    };
    let mut integrated = ArtifactBuilder::new();
    integrated.put("/test", &test).unwrap();
    let metrics = a_and_b.map(|[a, b]| vec![metric("crush_stiffness_a", a), metric("crush_stiffness_b", b)]);
    integrated.put("/metrics", &MetricsV2 { metrics: metrics.unwrap_or_default() }).unwrap();
    write("3-integrate.mcap", "integrate", integrated);
}

#[test]
fn runs_of_barrier_tests_give_the_stiffness() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    run(at, "a", Some(9.5), Some(0.3), Some([50e3, 625e3]));
    run(at, "b", Some(14.5), Some(0.5), None);
    run(at, "bare", Some(14.5), None, None);
    run(at, "typed-width", Some(14.5), None, Some([50e3, 625e3]));
    // One run: its own metrics; b0 and b1 by its mass and width.
    let one = json(at, &["--from", "a"]);
    assert_eq!(one["vehicle"]["stiffness"]["source"], "run");
    close(&one["vehicle"]["stiffness"]["b1_per_s"], 25.0, 1e-12);
    close(&one["vehicle"]["stiffness"]["b0_m_per_s"], 2.0, 1e-12);
    // Another b0: by energy, which for an even profile is (v - b0)/C.
    let held = json(at, &["--from", "a", "--no-damage-speed", "0.5m/s"]);
    close(&held["vehicle"]["stiffness"]["b1_per_s"], 30.0, 1e-12);
    // Two: the line through both.
    let both = json(at, &["--from", "a", "b"]);
    close(&both["vehicle"]["stiffness"]["b1_per_s"], 25.0, 1e-12);
    assert_eq!(both["vehicle"]["stiffness"]["tests"][1]["name"], "b");
    // What its file lacks is that of the example.
    let told = text(&damage(at, &["--from", "bare"]).stderr);
    assert!(told.contains("--test 1500kg,52.2km/h,48cm,150cm"), "{told}");
    let with_typed = json(at, &["--from", "a", "--test", "1500kg,14.5m/s,50cm,1.5m"]);
    close(&with_typed["vehicle"]["stiffness"]["b0_m_per_s"], 2.0, 1e-12);
    let by_metrics = json(at, &[&["--from", "typed-width"][..], &EVEN].concat());
    close(&by_metrics["vehicle"]["stiffness"]["g_n"], 2000.0, 1e-12);
    for (words, said) in [
        (&["--from", "a", "bare"][..], "states no residual crush"),
        (&["--from", "bare"], "states no residual crush"),
        (&["--from", "none"], "there is no 3-integrate.mcap"),
        (&["--from", "a", "a"], "values of a test before it"),
    ] {
        let output = damage(at, words);
        let told = text(&output.stderr);
        assert!(output.status.code() == Some(3) && told.contains(said) && told.contains("hint: "), "{words:?}: {told}");
    }
}

#[test]
fn lines_are_in_the_units_of_the_reader_or_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let typed = ["--test", "3100lb,35mph,19in,60in", "--profile", "4,10,15,16,12,5 in", "--width", "60in"];
    let typed = [&typed[..], &["--mass", "3100lb"]].concat();
    let us = text(&damage(folder.path(), &[&typed[..], &["--display", "us"]].concat()).stdout);
    for shown in ["3100 lb, 35.0 mph, mean residual crush 19.0 in, width 60.0 in", "lb/in²", " kip·ft"] {
        assert!(us.contains(shown), "{shown}: {us}");
    }
    assert!(!us.contains("km/h") && !us.contains(" mm") && !us.contains("kN"), "{us}");
    assert!(text(&damage(folder.path(), &typed).stdout).contains("1406 kg, 56.3 km/h"));
    let quiet = damage(folder.path(), &[&typed[..], &["-q", "-o", "d.json"]].concat());
    assert!(quiet.status.success() && quiet.stdout.is_empty() && folder.path().join("d.json").is_file());
}

#[test]
fn what_is_typed_wrong_ends_with_code_2_and_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let stiffness = ["--stiffness", "55kN/m,400kN/m^2"];
    for (words, said) in [
        (vec!["--angle", "46deg"], "above 45 deg"),
        (vec!["--width", "150"], "has no unit"),
        (vec!["--profile", "10,20"], "write 10,20cm, 10,20mm or 10,20in"),
        (vec!["-o", "d.html"], "-o d.json"),
        (vec!["--stiffness", "55kN/m,400"], "400kN/m^2"),
        (vec!["--profile", "10cm"], "expected 2 to 12"),
        (vec!["--line", "2m/s,25/s"], "stated in two ways"),
        (vec!["--restitution", "1"], "below 1"),
        // Of a collision, and there is none.
        (vec!["--restitution", "0.2"], "--other-mass"),
        (vec!["--energy", "lost"], "--other-mass"),
        (vec!["--lever", "40cm"], "--yaw-radius"),
        (vec!["--other-mass", "1500kg"], "stiffness is missing"),
        (vec!["--other-stiffness", "55kN/m,400kN/m^2"], "need a mass and a width"),
    ] {
        let mut typed: Vec<&str> = stiffness.into_iter().chain(EVEN).collect();
        if let Some(place) = typed.iter().position(|word| *word == words[0]) {
            typed.drain(place..place + 2);
        }
        typed.extend(&words);
        let output = damage(folder.path(), &typed);
        let told = text(&output.stderr);
        assert!(output.status.code() == Some(2) && told.contains(said), "{words:?}: {told}");
    }
    let nothing = damage(folder.path(), &[]);
    assert!(nothing.status.code() == Some(2) && text(&nothing.stderr).contains("hint: "));
}

/// A hint is the line that was typed, with what it lacks; typed in its place, it works.
#[test]
fn a_hint_holds_what_was_typed_and_works() {
    let folder = tempfile::tempdir().unwrap();
    for typed in [
        &["--profile", "10;25,5;12 cm"][..],
        &["--stiffness", "55kN/m,400kN/m^2", "--mass", "1500kg"],
        &["--line", "2m/s,25/s", "--profile", "10,25,12cm", "--width", "1.5m"],
        &["--test", "1500kg,20m/s,50cm,1.5m", "--other-mass", "900kg", "--restitution", "0.2"],
        &[],
    ] {
        let output = damage(folder.path(), typed);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{told}");
        let hint = told.lines().find_map(|line| line.trim().strip_prefix("hint: crumple-damage")).unwrap();
        // Quotes are the only ones of a shell here, around words with blanks or semicolons.
        let parts = hint.split('"').enumerate();
        let words: Vec<&str> = parts
            .flat_map(|(k, part)| if k % 2 == 1 { vec![part] } else { part.split_whitespace().collect() })
            .collect();
        assert_eq!(&words[..typed.len()], typed);
        let followed = damage(folder.path(), &words);
        assert!(followed.status.success(), "{hint}: {}", text(&followed.stderr));
    }
    for (wrong, right) in [
        (["--width", "1.5"], "write 1.5cm, 1.5mm, 1.5in or 1.5m"),
        (["--angle", "20"], "write 20deg"),
        (["--profile", "10,25,30"], "write 10,25,30cm"),
        (["--stiffness", "61kN/m,500"], "write 61kN/m,500kN/m^2"),
    ] {
        let told = text(&damage(folder.path(), &wrong).stderr);
        assert!(told.contains(right), "{told}");
    }
}
