//! NHTSA test 10146 from its EV5 file, its folder and a zip.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::PathBuf;

use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, Wave, ingest, list};
use crumple_signal::{Axis, ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::{TwoVehicles, shared};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn folder() -> Option<PathBuf> {
    shared("data/nhtsa-v10146-camry-frontal")
}

fn read(path: PathBuf, channel: Option<&str>) -> Result<Ingested, IngestError> {
    let settings = IngestSettings { channel: channel.map(str::to_owned), ..IngestSettings::default() };
    ingest(&Bundle::open(&path)?, &settings)
}

fn wave<'a>(ingested: &'a Ingested, id: &str) -> &'a Wave {
    ingested.waves.iter().find(|w| w.id == id).unwrap()
}

/// The EV5 file, all signal files, and those of the barrier archive, as one zip with one folder.
fn whole_test_as_zip(folder: &std::path::Path) -> Vec<u8> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("v10146.") {
            files.insert(name, fs::read(&path).unwrap());
        }
    }
    let barrier = fs::read(folder.join("v10146_barrier_fx.zip")).unwrap();
    let mut barrier = zip::ZipArchive::new(Cursor::new(barrier)).unwrap();
    for k in 0..barrier.len() {
        let mut entry = barrier.by_index(k).unwrap();
        let name = entry.name().unwrap().rsplit('/').next().unwrap().to_owned();
        let mut bytes = Vec::new();
        std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
        files.insert(name, bytes);
    }
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(format!("v10146ascii/{name}"), SimpleFileOptions::default()).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
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
    assert!(test.notes[0].starts_with("static crush 518 mm"), "{:?}", test.notes);
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
    let zipped = read(path, None).unwrap();
    assert_eq!(zipped.waves.len(), 13 + 176);
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

#[test]
fn a_specification_without_its_files_is_refused_with_an_example() {
    let Some(folder) = folder() else { return };
    let temporary = tempfile::tempdir().unwrap();
    let path = temporary.path().join("v10146.EV5");
    fs::copy(folder.join("v10146.EV5"), &path).unwrap();
    let error = read(path, None).unwrap_err();
    assert_eq!(error.to_string(), "v10146.EV5: none of the 634 listed channels has its signal file here");
    assert_eq!(error.expected(), Some("files such as v10146.001 beside it"));
}

#[test]
fn a_damaged_signal_file_costs_its_channel_only_unless_it_is_asked_for() {
    let Some(folder) = folder() else { return };
    let temporary = tempfile::tempdir().unwrap();
    for name in ["v10146.EV5", "v10146.093", "v10146.094"] {
        fs::copy(folder.join(name), temporary.path().join(name)).unwrap();
    }
    let damaged = temporary.path().join("v10146.093");
    let mut permissions = fs::metadata(&damaged).unwrap().permissions();
    #[expect(clippy::permissions_set_readonly_false, reason = "a copy in a temporary folder")]
    permissions.set_readonly(false);
    fs::set_permissions(&damaged, permissions).unwrap();
    let text = fs::read_to_string(&damaged).unwrap().replacen("-0.049900", "-0.0499xx", 1);
    fs::write(&damaged, text).unwrap();
    let ingested = read(temporary.path().join("v10146.EV5"), None).unwrap();
    assert_eq!(ingested.test.pulse.as_deref(), Some("94"));
    assert!(ingested.notes.to_texts().iter().any(|n| n.contains("channel 93 is left out: v10146.093, line 2")));
    let error = read(temporary.path().join("v10146.EV5"), Some("93")).unwrap_err().to_string();
    assert!(error.starts_with("v10146.093, line 2"), "{error}");
}

#[test]
fn a_damaged_signal_file_is_named_with_its_line() {
    let Some(folder) = folder() else { return };
    let copy = tempfile::tempdir().unwrap();
    fs::copy(folder.join("v10146.EV5"), copy.path().join("v10146.EV5")).unwrap();
    let text = fs::read_to_string(folder.join("v10146.093")).unwrap();
    let damaged: String =
        text.lines().enumerate().map(|(k, l)| if k == 3 { "x\n".to_owned() } else { format!("{l}\n") }).collect();
    fs::write(copy.path().join("v10146.093"), damaged).unwrap();
    let path = copy.path().join("v10146.EV5");
    let error = read(path.clone(), None).unwrap_err();
    assert!(error.to_string().contains("can be read: v10146.093, line 4"), "{error}");
    let lines = list(&Bundle::open(&path).unwrap(), &IngestSettings::default()).unwrap();
    let line = lines.iter().find(|line| line.id == "93").unwrap();
    assert!(line.comment.as_deref().unwrap().starts_with("its file is not read: v10146.093, line 4"), "{line:?}");
}

fn with_bundle<T>(of: &dyn Fn(&Bundle) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in TwoVehicles::STANDING.files() {
        fs::write(folder.path().join(name), text).unwrap();
    }
    of(&Bundle::open(&folder.path().join("v90001.EV5")).unwrap())
}

fn read_collision(flags: &IngestSettings) -> Ingested {
    with_bundle(&|bundle| ingest(bundle, flags).unwrap())
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
    let notes = ingested.notes.to_texts().join("\n");
    assert!(notes.contains("vehicles 1 and 2 meet") && notes.contains("--vehicle 2 takes the other"), "{notes}");
}

#[test]
fn the_other_vehicle_is_taken_by_its_number_or_by_its_channel() {
    let by_word = IngestSettings { vehicle: Some("2".to_owned()), ..IngestSettings::default() };
    let by_number = IngestSettings { vehicle_number: Some(2), ..IngestSettings::default() };
    let by_channel = IngestSettings { channel: Some("4".to_owned()), ..IngestSettings::default() };
    for flags in [by_word, by_number, by_channel] {
        let ingested = read_collision(&flags);
        let test = &ingested.test;
        assert_eq!(test.pulse.as_deref(), Some("4"), "{flags:?}");
        assert_eq!((test.mass_kg, test.impact_speed_m_per_s), (Some(1600.0), Some(0.0)), "{flags:?}");
        assert_eq!(test.vehicle.as_deref(), Some("2014 SECOND CAR HATCHBACK"));
        // The damage is that of the vehicle, or none.
        assert!(ingested.damage.is_none_or(|damage| damage.residual_crush_m[0] == 0.2));
    }
    // Words are words.
    let words = IngestSettings { vehicle: Some("a car".to_owned()), ..IngestSettings::default() };
    assert_eq!(read_collision(&words).test.vehicle.as_deref(), Some("a car"));
}

#[test]
fn locations_are_of_their_vehicle_and_a_comment_without_words_is_none() {
    let listed = with_bundle(&|bundle| list(bundle, &IngestSettings::default()).unwrap());
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
