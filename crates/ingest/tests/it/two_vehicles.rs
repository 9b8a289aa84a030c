//! NHTSA tests in which two cars meet, on files with known parameters: every channel belongs to its vehicle.

use std::fs;

use crumple_ingest::{Bundle, IngestSettings, Ingested, ingest, list};
use crumple_testkit::TwoVehicles;

fn with_bundle<T>(of: &dyn Fn(&Bundle) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in TwoVehicles::STANDING.files() {
        fs::write(folder.path().join(name), text).unwrap();
    }
    of(&Bundle::open(&folder.path().join("v90001.EV5")).unwrap())
}

fn read(flags: &IngestSettings) -> Ingested {
    with_bundle(&|bundle| ingest(bundle, flags).unwrap())
}

#[test]
fn each_vehicle_has_its_own_mass_speed_pulse_and_channels() {
    let ingested = read(&IngestSettings::default());
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
        let ingested = read(&flags);
        let test = &ingested.test;
        assert_eq!(test.pulse.as_deref(), Some("4"), "{flags:?}");
        assert_eq!((test.mass_kg, test.impact_speed_m_per_s), (Some(1600.0), Some(0.0)), "{flags:?}");
        assert_eq!(test.vehicle.as_deref(), Some("2014 SECOND CAR HATCHBACK"));
        // The damage is that of the vehicle, or none.
        assert!(ingested.damage.is_none_or(|damage| damage.residual_crush_m[0] == 0.2));
    }
    // Words are words.
    let words = IngestSettings { vehicle: Some("a car".to_owned()), ..IngestSettings::default() };
    assert_eq!(read(&words).test.vehicle.as_deref(), Some("a car"));
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
