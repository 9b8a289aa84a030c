//! Simulations: files of known motion made by the testkit, and the cases of the reference.

use std::path::PathBuf;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, Wave, list};
use crumple_signal::{QuantityKind, Value};
use crumple_testkit::{shared, simulated};

use crate::{given, notes, open, program, read_as, write};

fn wave<'a>(ingested: &'a Ingested, id: &str) -> &'a Wave {
    let ids = || ingested.waves.iter().map(|wave| wave.id.clone()).collect::<Vec<_>>();
    ingested.waves.iter().find(|wave| wave.id == id).unwrap_or_else(|| panic!("{id} is not in {:?}", ids()))
}

/// Largest way from contact on, m, and when, s: the velocity, integrated by trapezoids.
fn crush(ingested: &Ingested, node: &str) -> (f64, f64) {
    let wave = &wave(ingested, &format!("node.{node}.x_velocity")).samples;
    let from = wave.index_at_or_after(0.0);
    let first = wave.time_s(from) * ingested.test.impact_speed_m_per_s.unwrap();
    let (mut way, mut best) = (first, (0.0, 0.0));
    for k in from + 1..wave.len() {
        way += wave.dt_s() * (wave.samples()[k] + wave.samples()[k - 1]) / 2.0;
        if way > best.0 {
            best = (way, wave.time_s(k));
        }
    }
    best
}

#[track_caller]
fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} within {tolerance}");
}

fn refusal(result: Result<Ingested, IngestError>) -> String {
    let error = result.unwrap_err();
    format!("{error}; {}", error.hint())
}

fn set(path: &str) -> Option<PathBuf> {
    shared(&format!("reference/simulation/{path}"))
}

const S1: &str = "s1-same-car";
const S2: &str = "s2-middle-of-the-front-too-stiff";
const S3: &str = "s3-openradioss-engine-mount-too-soft";

/// Every format gives the exact motion back: 15 m/s at contact after 5 ms, 477.5 mm of crush 50 ms later.
fn check_known_motion(ingested: &Ingested, has_wall: bool) {
    near(ingested.test.impact_speed_m_per_s.unwrap(), 15.0, 0.01);
    let pulse = &ingested.pulse().unwrap().samples;
    let peak = pulse.samples().iter().fold(0.0_f64, |least, a| least.min(*a));
    // v·w, by central differences of 1 ms: 1 - (w dt)²/6.
    near(peak, -15.0 * std::f64::consts::PI / 0.1, 0.5);
    if has_wall {
        // Five digits of the texts, and the trapezoid's error of 1e-4.
        let (way, at) = crush(ingested, "7");
        near(way, 0.477_465, 1e-3);
        near(at, 0.050, 1e-3);
        let wall = wave(ingested, "wall.1.x_force");
        let peak = wall.samples.samples().iter().fold(0.0_f64, |most, f| most.max(*f));
        near(peak, 471_239.0, 500.0);
        near(ingested.test.contact.as_ref().unwrap().source_time_s, 0.005, 2e-5);
    }
}

#[test]
fn known_motion_comes_back_from_every_format() {
    let settings = given("--units mm-ms-kg --node 7");
    for is_little in [true, false] {
        let read = read_as("binout", simulated::binout(is_little), &settings).unwrap();
        check_known_motion(&read, true);
        near(read.test.mass_kg.unwrap(), 1000.0, 1e-6);
        let titles: Vec<&str> = read.test.channels.iter().map(|channel| channel.location.as_str()).collect();
        assert!(titles.contains(&"REAR SILL") && titles.contains(&"ENGINE TOP"), "{titles:?}");
        assert_eq!(read.test.pulse.as_deref(), Some("node.7.x_acceleration"));
    }
    check_known_motion(&read_as("T01", simulated::t01(), &given("--node 7")).unwrap(), true);
    check_known_motion(&read_as("nodout", simulated::nodout(), &settings).unwrap(), false);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[("nodout", simulated::nodout()), ("rwforc", simulated::rwforc())]);
    check_known_motion(&open(folder.path(), &settings).unwrap(), true);
}

#[test]
fn units_are_asked_with_the_system_that_fits() {
    let text = refusal(read_as("binout", simulated::binout(true), &IngestSettings::default()));
    assert!(text.contains("--units mm-ms-kg (1000 kg, 15 m/s, 120 ms)"), "{text}");
    for units in ["mm-s-t", "m-s-kg"] {
        let typed = format!("--units {units} --node 7");
        let text = refusal(read_as("binout", simulated::binout(true), &given(&typed)));
        assert!(text.contains(&format!("{units} by --units give")) && text.contains("no crash of a car"), "{text}");
        assert!(text.contains("--units mm-ms-kg"), "{text}");
    }
}

#[test]
fn a_binout_longer_than_memory_stays_on_the_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("binout0000");
    // 2,500 nodes and 300 states: 73 MB. Files above 64 MiB are read where they stand.
    let mut file = std::fs::File::create(&path).unwrap();
    simulated::write_large_binout(&mut file, 2500, 300).unwrap();
    let settings = given("--units mm-ms-kg --node 1 --mass 1000kg");
    let bundle = Bundle::open(&path).unwrap();
    assert!(bundle.main.bytes.len() <= 8192 && bundle.digest() == Bundle::digests_at(&path).unwrap().record);
    let read = open(&path, &settings).unwrap();
    check_known_motion(&read, false);
    // Titled nodes, and the one that is asked for.
    let nodes = |read: &Ingested| read.waves.iter().filter(|wave| wave.id.ends_with(".x_velocity")).count();
    assert_eq!((nodes(&read), nodes(&open(&path, &given("--units mm-ms-kg --node 2000")).unwrap())), (3, 4));
    let length = path.metadata().unwrap().len();
    std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(length - 400_000).unwrap();
    let cut = open(&path, &settings).unwrap();
    assert!(notes(&cut).contains("binout0000 is cut: 298 states"), "{}", notes(&cut));
}

#[test]
fn a_wall_is_chosen_and_a_run_that_blew_up_ends() {
    let settings = given("--units mm-ms-kg --node 7 --wall 1");
    let read = read_as("binout", simulated::binout(true), &settings).unwrap();
    check_known_motion(&read, true);
    let text = refusal(read_as("binout", simulated::binout(true), &given("--units mm-ms-kg --node 7 --wall 2")));
    assert!(text.contains("channel 2 of --wall is not listed"), "{text}");
    let (head, rows) =
        simulated::nodout().split_once("( at time 1.1000000E+02").map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    let stars = "*".repeat(12);
    let row = |line: &str| match line.strip_prefix("        7") {
        Some(numbers) => format!("        7 {}\n", stars.repeat(numbers.len() / 12)),
        None => format!("{line}\n"),
    };
    let blown: String = rows.lines().map(row).collect();
    let text = format!("{head}( at time 1.1000000E+02{blown}");
    let read = read_as("nodout", text, &given("--units mm-ms-kg --node 7")).unwrap();
    let blown = read.notes.iter().find(|note| note.kind.is_some_and(|kind| kind.code == "CR183")).unwrap();
    let values = [("count", Value::Number(1.0)), ("of", Value::Text("node.7".into())), ("from", Value::Number(110.0))];
    assert_eq!(blown.values, values);
    assert_eq!(wave(&read, "node.7.x_velocity").samples.len(), 110);
}

#[test]
fn damaged_files_are_refused_or_said_to_be_cut() {
    let settings = given("--units mm-ms-kg --node 7");
    let whole = simulated::binout(true);
    let half = read_as("binout", whole[..whole.len() / 2].to_vec(), &settings).unwrap();
    assert!(notes(&half).contains("binout is cut: "), "{}", notes(&half));
    assert!(read_as("binout", whole[..20].to_vec(), &settings).is_err());
    let t01 = simulated::t01();
    let cut = read_as("T01", t01[..t01.len() - 9].to_vec(), &settings).unwrap();
    assert!(notes(&cut).contains("T01 is cut: 120 states"), "{}", notes(&cut));
    let nodout = simulated::nodout();
    let cut = read_as("nodout", nodout[..nodout.len() - 40].to_owned(), &settings).unwrap();
    assert!(notes(&cut).contains("1 rows of nodout are not whole"), "{}", notes(&cut));
}

#[test]
fn case_1_to_4_real_files() {
    let Some(folder) = shared("data/lsdyna-binout") else { return };
    // In mm, ms, g an impulse is in mN s.
    let forces = [
        ("R7_1_2", "0.00008285 N s, the change of momentum 0.0001478 N s; its largest is 165.048 N at state 28"),
        ("R9_3_1", "0.00008291 N s, the change of momentum 0.0001478 N s; its largest is 165.186 N at state 28"),
        ("R12_2_1", "0.00006708 N s, the change of momentum 0.000149 N s; its largest is 137.571 N at state 28"),
    ];
    for (name, force) in forces {
        let path = folder.join(format!("{name}.binout"));
        let text = refusal(open(&path, &IngestSettings::default()));
        assert!(text.contains("no node is in it (no nodout") && text.contains("no system makes it"), "{text}");
        assert!(text.contains("mm-ms-g: 0.000002732 kg, 50 m/s, 0.03"), "{text}");
        let read = open(&path, &given("--units mm-ms-g --allow-missing")).unwrap();
        assert!(notes(&read).contains(&format!("undersampled: its impulse is {force}")), "{}", notes(&read));
        assert!(wave(&read, "wall.1.x_force").samples.len() > 80);
        assert!(notes(&read).contains("glstat (88 states)"), "{}", notes(&read));
        let listed = list(&Bundle::open(&path).unwrap(), &IngestSettings::default()).unwrap();
        let title = |id: &str| {
            listed.iter().find(|line| line.id == format!("part.{id}.kinetic_energy")).unwrap().location.clone()
        };
        assert_eq!((title("1").as_str(), title("101").as_str()), ("null shells for visualization", ""));
    }
}

#[test]
fn case_5_and_6_same_car() {
    let Some(folder) = set(S1) else { return };
    let out = tempfile::tempdir().unwrap().path().join("out.mcap");
    let (code, _, stderr) = program(&folder.join("binout0000"), &["-o", out.to_str().unwrap()]);
    assert!(code == 3 && stderr.contains("--units mm-ms-kg (1500 kg, 15.65 m/s, 150 ms)"), "{stderr}");
    let read = open(&folder, &given("--units mm-ms-kg --node 1000001")).unwrap();
    let velocity = &wave(&read, "node.1000001.x_velocity").samples;
    assert_eq!(velocity.len(), 376);
    near(velocity.samples()[99], 10.38473, 1e-5);
    near(velocity.time_s(99), 0.0396, 1e-6);
    near(wave(&read, "wall.1.x_force").samples.samples()[99], 353_164.6, 1.0);
    let (way, at) = crush(&read, "1000001");
    near(way, 0.7552, 0.0005);
    near(at, 0.07676, 0.0004);
    let change = velocity.samples().last().unwrap() - 15.65;
    near(change, -17.705, 0.002);
    assert!(notes(&read).contains("the model drives to -x at 15.650 m/s"), "{}", notes(&read));
    near(read.test.mass_kg.unwrap(), 1500.0, 1.0);
}

#[test]
fn case_8_and_9_a_folder_is_one_result() {
    let Some(folder) = set(S2) else { return };
    let settings = given("--units mm-s-t --node 1000001");
    let read = open(&folder, &settings).unwrap();
    let velocity = &wave(&read, "node.1000001.x_velocity").samples;
    assert_eq!(velocity.len(), 301);
    near(velocity.samples()[99], 7.534_368, 1e-5);
    near(wave(&read, "wall.1.x_force").samples.samples()[99], 383_938.6, 1.0);
    let engine = read.test.channels.iter().find(|channel| channel.id == "node.3000001.x_velocity").unwrap();
    assert_eq!(engine.location, "10ENGN ENGINE TOP");
    assert!(refusal(open(&folder, &given("--units mm-s-t"))).contains("add --node 1000001, for example"));
    let named = open(&folder, &given("--units mm-s-t --node left rear")).unwrap();
    assert_eq!(named.test.pulse.as_deref(), Some("node.1000001.x_acceleration"));

    let copy = tempfile::tempdir().unwrap();
    for name in ["binout0000", "binout0000%001"] {
        std::fs::write(copy.path().join(name), std::fs::read(folder.join(name)).unwrap()).unwrap();
    }
    let without = open(copy.path(), &settings).unwrap();
    assert!(notes(&without).contains("no force of a wall is in it"), "{}", notes(&without));
    assert_eq!(wave(&without, "node.1000001.x_velocity").samples.len(), 301);
    // By the deceleration, which begins softly behind the gap of 3.195 ms.
    near(without.test.contact.as_ref().unwrap().source_time_s, 0.003_195, 0.002);
    std::fs::remove_file(copy.path().join("binout0000")).unwrap();
    assert!(refusal(open(copy.path(), &settings)).contains("its nodes have no ids"));
}

#[test]
fn case_10_aliased_acceleration_and_a_gap() {
    let Some(folder) = set(S2) else { return };
    let read = open(&folder, &given("--units mm-s-t --node 1000001")).unwrap();
    let text = notes(&read);
    // Over all 301 states. The reference has 4.75 and -6.10: from contact to 130 ms after it, where its test ends.
    assert!(text.contains("off the velocity by up to 4.76 m/s (end -6.29, velocity -2.80 m/s)"), "{text}");
    near(read.test.contact.as_ref().unwrap().source_time_s, 0.003_195, 1e-5);
    near(crush(&read, "1000001").0, 0.6927, 0.0005);
}

#[test]
fn case_11_texts_give_the_same_numbers() {
    let Some(folder) = set(S2) else { return };
    let settings = given("--units mm-s-t --node 1000001");
    let [binary, text] = [open(&folder, &settings), open(folder.join("nodout"), &settings)].map(Result::unwrap);
    assert_eq!(text.test.source.format, "ls-dyna-text");
    assert!(!notes(&text).contains("not whole") && !notes(&text).contains("cut"), "{}", notes(&text));
    for id in ["node.1000001.x_velocity", "node.3000001.x_displacement", "wall.1.x_force", "model.kinetic_energy"] {
        let [a, b] = [&binary, &text].map(|read| wave(read, id).samples.samples());
        assert_eq!(a.len(), b.len(), "{id}");
        let most = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        a.iter().zip(b).for_each(|(a, b)| near(*b, *a, 1e-4 * most));
    }
    near(crush(&text, "1000001").0, 0.6927, 0.001);
    near(text.test.mass_kg.unwrap(), 1500.0, 1.0);
}

#[test]
fn case_13_open_radioss() {
    let Some(folder) = set(S3) else { return };
    let read = open(&folder, &given("--node 1000001")).unwrap();
    assert_eq!(wave(&read, "node.1000001.x_velocity").samples.len(), 376);
    near(crush(&read, "1000001").0, 0.8194, 0.0005);
    near(read.test.contact.as_ref().unwrap().source_time_s, 0.001_278, 2e-5);
    let wall = wave(&read, "wall.1.x_force").samples.samples();
    near(wall.iter().fold(0.0_f64, |most, f| most.max(*f)), 417_000.0, 500.0);
    let text = notes(&read);
    assert!(text.contains("units mm-ms-kg by the file") && text.contains("impulse, not force"), "{text}");
    assert!(!text.contains("undersampled"), "{text}");
}

#[test]
fn case_14_and_15_tables_of_open_radioss() {
    let Some(folder) = set(S3) else { return };
    let settings = given("--units mm-ms-kg --node 1000001");
    let direct = open(folder.join("CART01"), &settings).unwrap();
    for name in ["CART01.csv", "CART01-garbled-header.csv", "CART01-impulse.csv"] {
        let read = open(folder.join(name), &settings).unwrap();
        for id in ["node.1000001.x_velocity", "wall.1.x_force"] {
            let [a, b] = [&direct, &read].map(|read| wave(read, id).samples.samples());
            let most = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            a.iter().zip(b).for_each(|(a, b)| near(*b, *a, 2e-3 * most));
        }
        let is_nameless = name == "CART01-impulse.csv";
        assert_eq!(notes(&read).contains("columns 21 to 53 have no names"), is_nameless, "{}", notes(&read));
        assert_eq!(notes(&read).contains("impulse, not force, is written for wall 1"), is_nameless, "{}", notes(&read));
    }
    // Another number of variables, and another order of them, tell nothing.
    let nameless = std::fs::read_to_string(folder.join("CART01-impulse.csv")).unwrap();
    let (names, rows) = nameless.split_once('\n').unwrap();
    let one_less = names.replacen("var 28\"", "var 2x\"", 1);
    let turned = rows.lines().map(|row| {
        let mut fields: Vec<&str> = row.split(',').collect();
        fields.swap(20, 26);
        fields.join(",") + "\n"
    });
    for table in [format!("{one_less}\n{rows}"), format!("{names}\n{}", turned.collect::<String>())] {
        let text = refusal(read_as("CART01.csv", table, &settings));
        assert!(text.contains("columns 21 to 53 are \"var 20\" to \"var 52\""), "{text}");
        assert!(text.contains("give the T01 file itself"), "{text}");
    }
}

#[test]
fn case_17_cut_and_damaged() {
    let Some(folder) = set(S1) else { return };
    let bytes = std::fs::read(folder.join("binout0000")).unwrap();
    let settings = given("--units mm-ms-kg --node 1000001");
    let half = read_as("binout0000", bytes[..661_633].to_vec(), &settings).unwrap();
    assert!(notes(&half).contains("binout0000 is cut: 187 states, the last at 74.4"), "{}", notes(&half));
    assert!(read_as("binout0000", bytes[..20].to_vec(), &settings).is_err());
    let first = usize::try_from(u64::from_le_bytes(bytes[17..25].try_into().unwrap())).unwrap();
    let length = u64::from_le_bytes(bytes[first..first + 8].try_into().unwrap());
    let end = first + usize::try_from(length).unwrap();
    let damaged = |at: usize, place: u64| {
        let mut bytes = bytes.clone();
        bytes[at..at + 8].copy_from_slice(&place.to_le_bytes());
        refusal(read_as("binout0000", bytes, &settings))
    };
    assert!(damaged(end - 8, first as u64).contains("tables circle"));
    assert!(damaged(end - 8, 1 << 40).contains("beyond the end"));
    // The path, then the title: length, command, name, type.
    let symbol = first + 9 + 9 + "/nodout/metadata".len();
    assert!(damaged(symbol + 9 + "title".len() + 1, 1 << 40).contains("beyond the end"));
}

#[test]
fn case_18_curves() {
    let Some(folder) = set(S1) else { return };
    let read = open(folder.join("curves.cur"), &given("--units mm-ms-kg")).unwrap();
    let lengths: Vec<(usize, QuantityKind)> =
        read.waves.iter().map(|wave| (wave.samples.len(), wave.quantity)).collect();
    for quantity in [QuantityKind::Velocity, QuantityKind::Force] {
        assert!(lengths.contains(&(376, quantity)), "{lengths:?}");
    }
    near(crush(&read, "1").0, 0.7552, 0.0005);
}

#[test]
fn case_19_what_is_not_in_the_file_is_no_channel() {
    let Some(folder) = set(S2) else { return };
    let copy = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(folder.join("glstat")).unwrap();
    let without: String =
        text.lines().filter(|line| !line.contains("hourglass")).map(|line| format!("{line}\n")).collect();
    write(copy.path(), &[("glstat", without), ("nodout", std::fs::read_to_string(folder.join("nodout")).unwrap())]);
    let read = open(copy.path(), &given("--units mm-s-t --node 1000001")).unwrap();
    let has = |id: &str| read.test.channels.iter().any(|channel| channel.id == id);
    assert!(has("model.internal_energy") && has("model.energy_ratio") && !has("model.hourglass_energy"));
}
