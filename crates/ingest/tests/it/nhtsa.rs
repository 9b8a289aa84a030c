//! NHTSA test 10146 from its EV5 file, its folder and a zip.

use std::fs;
use std::io::{Cursor, Read as _};
use std::path::{Path, PathBuf};

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, Wave, ingest, list};
use crumple_signal::{Axis, ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::{TwoVehicles, shared};

use crate::{given, lenient, notes, open, write, zipped};

fn folder() -> Option<PathBuf> {
    shared("data/nhtsa-v10146-camry-frontal")
}

fn read(path: impl AsRef<Path>, channel: Option<&str>) -> Result<Ingested, IngestError> {
    open(path, &IngestSettings { channel: channel.map(str::to_owned), ..IngestSettings::default() })
}

fn wave<'a>(ingested: &'a Ingested, id: &str) -> &'a Wave {
    ingested.waves.iter().find(|w| w.id == id).unwrap()
}

/// The EV5 file, all signal files, and those of the barrier archive, as one zip with one folder.
fn whole_test_as_zip(folder: &Path) -> Vec<u8> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("v10146.") {
            files.push((format!("v10146ascii/{name}"), fs::read(&path).unwrap()));
        }
    }
    let barrier = fs::read(folder.join("v10146_barrier_fx.zip")).unwrap();
    let mut barrier = zip::ZipArchive::new(Cursor::new(barrier)).unwrap();
    for k in 0..barrier.len() {
        let mut entry = barrier.by_index(k).unwrap();
        let name = format!("v10146ascii/{}", entry.name().unwrap().rsplit('/').next().unwrap());
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        files.push((name, bytes));
    }
    zipped(&files)
}

#[test]
fn the_test_and_its_pulse() {
    let Some(folder) = folder() else { return };
    let ingested = read(folder.join("v10146.EV5"), None).unwrap();
    let test = &ingested.test;
    assert_eq!(test.mass_kg, Some(1719.0));
    assert_eq!(test.impact_speed_m_per_s, Some(57.09 / 3.6));
    assert_eq!(test.title, "NCAP - 2018 TOYOTA CAMRY LE 4-DOOR SEDAN");
    assert_eq!(test.vehicle.as_deref(), Some("2018 TOYOTA CAMRY LE 4-DOOR SEDAN"));
    assert_eq!(test.barrier.as_deref(), Some("rigid load cell barrier (advanced research load cell barrier)"));
    assert_eq!((test.source.format.as_str(), test.source.name.as_str()), ("nhtsa-ev5", "v10146.EV5"));
    assert!(test.notes[0].starts_with("largest static crush 518 mm"), "{:?}", test.notes);
    let damage = ingested.damage.as_ref().unwrap();
    assert_eq!(damage.residual_crush_m, [0.38, 0.466, 0.511, 0.518, 0.489, 0.37]);
    assert_eq!(damage.classification.as_deref(), Some("12FDEW2"));
    assert_eq!((test.channels.len(), ingested.waves.len()), (634, 13));

    assert_eq!(test.pulse.as_deref(), Some("93"));
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (3500, -0.05, 1e-4));
    // First line of the file: -0.050000<TAB>0.114681, in g.
    assert_eq!(pulse.samples.samples()[0], 0.114_681 * G);
    assert!(pulse.quality.pre_event.is_some_and(|p| p.samples == 401 && p.noise_floor < G));
    let channel = test.channel("93").unwrap();
    assert_eq!(channel.location, "vehicle, left rear seat crossmember");
    assert_eq!((channel.axis, channel.status, channel.redundant), (Some(Axis::X), ChannelStatus::Valid, false));
    assert_eq!(channel.initial_velocity_m_per_s, Some(57.09 / 3.6));
    assert!(test.channel("99").unwrap().redundant);
    assert_eq!(test.channel("7").unwrap().quantity, QuantityKind::Force);
    assert_eq!(pulse.quantity, QuantityKind::Acceleration);
    // Asked for by its number it is the same.
    let asked = read(folder.join("v10146.EV5"), Some("93")).unwrap();
    assert_eq!((asked.test.pulse.as_deref(), &asked.pulse().unwrap().samples), (Some("93"), &pulse.samples));
}

#[test]
fn notes_say_what_was_taken_what_is_doubted_and_what_is_missing() {
    let Some(folder) = folder() else { return };
    let notes = read(folder.join("v10146.EV5"), None).unwrap().notes.to_texts();
    let has = |text: &str| assert!(notes.iter().any(|n| n.contains(text)), "{text:?} is not in {notes:#?}");
    has("pulse: channel 93 (left rear seat crossmember)");
    has("94 (right rear seat crossmember)");
    has("100 (right rear seat crossmember, redundant)");
    has("warning: channel 96 is questionable by its laboratory: BOTTOM OF ENGINE X: No valid data after 67ms");
    has("617 of 634 listed channels have no signal file here: 2-12, 14, 15");
    has("4 listed channels were not installed: 45, 46, 91, 92");
    assert!(notes.len() < 12, "{notes:#?}");
}

#[test]
fn the_short_engine_channel_is_read_as_it_is() {
    let Some(folder) = folder() else { return };
    let ingested = read(folder.join("v10146.EV5"), Some("96")).unwrap();
    assert_eq!(wave(&ingested, "96").samples.len(), 1170);
    assert_eq!(ingested.test.channel("96").unwrap().status, ChannelStatus::Questionable);
    assert_eq!(ingested.test.pulse.as_deref(), Some("96"));
    let doubt = "warning: channel 96 is questionable by its laboratory: BOTTOM OF ENGINE X: No valid data after 67ms";
    assert!(notes(&ingested).contains(doubt));
}

#[test]
fn channels_without_data_say_why() {
    let Some(folder) = folder() else { return };
    let error = |channel| read(folder.join("v10146.EV5"), Some(channel)).unwrap_err().to_string();
    assert_eq!(
        error("45"),
        "v10146.EV5: channel 45: not installed (DRIVER SHOULDER BELT: Not installed): it has no data, and no file is \
         missing"
    );
    assert!(error("2").contains("channel 2 (driver, head): its signal file, with the extension .002, is not here"));
    assert!(error("700").contains("channel 700 is not listed"));
}

#[test]
fn folder_and_zip_read_like_the_file() {
    let Some(folder) = folder() else { return };
    let file = read(folder.join("v10146.EV5"), None).unwrap();
    let whole = read(folder.clone(), None).unwrap();
    assert_eq!(whole.test.source.digest, file.test.source.digest);
    assert_eq!(whole.test.channels, file.test.channels);

    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("v10146.zip");
    fs::write(&path, whole_test_as_zip(&folder)).unwrap();
    let zipped = read(&path, None).unwrap();
    assert_eq!((zipped.test.channels.len(), zipped.waves.len()), (634, 13 + 176));
    assert_eq!(zipped.test.pulse, file.test.pulse);
    let listed = list(&Bundle::open(&path).unwrap(), &given("--channel LC* XG")).unwrap();
    let listed: Vec<_> = listed.iter().filter(|c| c.samples > 0).collect();
    assert_eq!(listed.len(), 176);
    assert!(listed.iter().all(|c| c.quantity == "force" && c.axis.as_deref() == Some("x")));
    for wave_of_file in &file.waves {
        assert_eq!(wave(&zipped, &wave_of_file.id).samples, wave_of_file.samples);
    }
    let cells: Vec<_> = zipped
        .test
        .channels
        .iter()
        .filter(|c| c.location.starts_with("barrier, load cell") && c.axis == Some(Axis::X) && c.status.has_data())
        .collect();
    assert_eq!(cells.len(), 176);
    assert!(cells.iter().all(|c| c.quantity == QuantityKind::Force));
    for dead in ["347", "500"] {
        assert_eq!(zipped.test.channel(dead).unwrap().status, ChannelStatus::Questionable);
        assert!(notes(&zipped).contains(&format!("channel {dead} is questionable")));
    }
    // Newton's second law, as stated with the record: the cells' impulse over 0 to 300 ms is the mass times 68.0 km/h.
    let impulse: f64 = cells
        .iter()
        .map(|c| {
            let w = wave(&zipped, &c.id);
            let zero = w.quality.pre_event.unwrap().zero_level;
            let from = w.samples.index_at_or_after(0.0);
            w.samples.samples()[from..].iter().map(|f| (f - zero) * w.samples.dt_s()).sum::<f64>()
        })
        .sum();
    // 3 % is the agreement claimed for two independent sets of sensors.
    assert!((impulse / 1719.0 * 3.6 + 68.0).abs() < 0.03 * 68.0, "{} km/h", impulse / 1719.0 * 3.6);
}

/// The specification, and these of its signal files.
fn part_of_the_test(folder: &Path, curves: &[(&str, &str)]) -> tempfile::TempDir {
    let part = tempfile::tempdir().unwrap();
    write(part.path(), &[("v10146.EV5", fs::read(folder.join("v10146.EV5")).unwrap())]);
    write(part.path(), curves);
    part
}

#[test]
fn a_specification_without_its_files_is_refused_with_an_example() {
    let Some(folder) = folder() else { return };
    let error = read(part_of_the_test(&folder, &[]).path().join("v10146.EV5"), None).unwrap_err();
    assert_eq!(error.to_string(), "v10146.EV5: none of the 634 listed channels has its signal file here");
    assert_eq!(error.expected(), Some("files such as v10146.001 beside it"));
}

#[test]
fn a_damaged_signal_file_is_named_with_its_line_and_costs_its_channel_only_unless_it_is_asked_for() {
    let Some(folder) = folder() else { return };
    let [good, other] = ["093", "094"].map(|n| fs::read_to_string(folder.join(format!("v10146.{n}"))).unwrap());
    let damaged = good.replacen("-0.049900", "-0.0499xx", 1);
    let both = part_of_the_test(&folder, &[("v10146.093", &damaged), ("v10146.094", &other)]);
    let path = both.path().join("v10146.EV5");
    let ingested = read(&path, None).unwrap();
    assert_eq!(ingested.test.pulse.as_deref(), Some("94"));
    assert!(notes(&ingested).contains("channel 93 is left out: v10146.093, line 2"));
    let error = read(&path, Some("93")).unwrap_err().to_string();
    assert!(error.starts_with("v10146.093, line 2"), "{error}");

    let lines = good.lines().enumerate().map(|(k, line)| if k == 3 { "x" } else { line });
    let alone = part_of_the_test(&folder, &[("v10146.093", &lines.collect::<Vec<_>>().join("\n"))]);
    let path = alone.path().join("v10146.EV5");
    let error = read(&path, None).unwrap_err();
    assert!(error.to_string().contains("can be read: v10146.093, line 4"), "{error}");
    let lines = list(&Bundle::open(&path).unwrap(), &IngestSettings::default()).unwrap();
    let line = lines.iter().find(|line| line.id == "93").unwrap();
    assert!(line.comment.as_deref().unwrap().starts_with("its file is not read: v10146.093, line 4"), "{line:?}");
}

#[test]
fn a_signal_file_without_its_specification_is_told_from_an_iso_channel() {
    let Some(folder) = folder() else { return };
    let error = open(folder.join("v10146.093"), &lenient()).unwrap_err();
    assert!(error.hint().contains("giving its .EV5 file"), "{}", error.hint());
    let alone = open(folder.join("v10146.093"), &given("--allow-missing --unit g")).unwrap();
    assert_eq!(alone.pulse().unwrap().samples.len(), 3500);
}

fn collision() -> Bundle {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &TwoVehicles::STANDING.files());
    Bundle::open(&folder.path().join("v90001.EV5")).unwrap()
}

fn read_collision(flags: &IngestSettings) -> Ingested {
    ingest(&collision(), flags).unwrap()
}

#[test]
fn each_vehicle_has_its_own_mass_speed_pulse_and_channels() {
    let ingested = read_collision(&IngestSettings::default());
    let [first, second] = &ingested.vehicles[..] else { panic!("{:?}", ingested.vehicles) };
    assert_eq!((first.mass_kg, first.impact_speed_m_per_s), (Some(1200.0), Some(50.0 / 3.6)));
    assert_eq!(first.channels, ["1", "2", "3"]);
    // A speed of 0 is a speed.
    assert_eq!((second.mass_kg, second.impact_speed_m_per_s), (Some(1600.0), Some(0.0)));
    assert_eq!((second.pulse.as_deref(), second.channels.len()), (Some("4"), 4));
    assert_eq!(second.description.as_deref(), Some("2014 SECOND CAR HATCHBACK"));
    assert_eq!(ingested.closing_speed_m_per_s, Some(50.0 / 3.6));
    let test = &ingested.test;
    assert_eq!((test.pulse.as_deref(), test.mass_kg), (Some("1"), Some(1200.0)));
    assert_eq!(test.vehicle.as_deref(), Some("2016 FIRST CAR SEDAN"));
    let notes = notes(&ingested);
    assert!(notes.contains("vehicles 1 and 2 meet") && notes.contains("--vehicle 2 takes the other"), "{notes}");
}

#[test]
fn the_other_vehicle_is_taken_by_its_number_or_by_its_channel() {
    for flags in ["--vehicle 2", "--vehicle-number 2", "--channel 4"] {
        let ingested = read_collision(&given(flags));
        let test = &ingested.test;
        assert_eq!(test.pulse.as_deref(), Some("4"), "{flags}");
        assert_eq!((test.mass_kg, test.impact_speed_m_per_s), (Some(1600.0), Some(0.0)), "{flags}");
        assert_eq!(test.vehicle.as_deref(), Some("2014 SECOND CAR HATCHBACK"));
        // The damage is that of the vehicle, or none.
        assert!(ingested.damage.is_none_or(|damage| damage.residual_crush_m[0] == 0.2));
    }
    // Words are words.
    assert_eq!(read_collision(&given("--vehicle a car")).test.vehicle.as_deref(), Some("a car"));
}

#[test]
fn locations_are_of_their_vehicle_and_a_comment_without_words_is_none() {
    let listed = list(&collision(), &IngestSettings::default()).unwrap();
    let location = |id: &str| listed.iter().find(|line| line.id == id).unwrap().location.clone();
    assert_eq!(location("1"), "vehicle, left rear seat crossmember");
    assert_eq!(location("2"), "vehicle, rear floor, right");
    assert_eq!(location("4"), "vehicle 2, rear floor, left");
    assert_eq!(location("5"), "vehicle 2, vehicle centre of gravity");
    assert_eq!(location("6"), "vehicle 2, left front sill");
    assert_eq!(location("7"), "driver of vehicle 2, chest");
    // What has no data stands last.
    assert_eq!(listed.last().unwrap().id, "6");
}
