//! ISO-MME tests: folders, archives, single files, and what laboratories write into them.

use std::fs;

use crumple_ingest::{IngestError, IngestSettings, Ingested};
use crumple_signal::{ChannelStatus, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;
use tempfile::TempDir;

use crate::{given, lenient, notes, open, read_as, write, zipped};

const MME: &str = "Data format edition number  :1.6\r\nTitle                       :sled 7\r\n\
    Name of test object 1       :white car\r\n\
    Mass test object 1          :1500\r\nVelocity test object 1      :50 km/h\r\n";
const CHN: &str = "Instrumentation standard    :ISO 6487\r\nNumber of channels          :4\r\n\
    Name of channel 001         :10SECMLERE00ACXP / seat\r\nName of channel 002         :10SECMRIRE00ACXP\r\n\
    Name of channel 003         :10ENGN000000ACXP\r\nName of channel 004         :11HEADCG00H3ACXA\r\n";

/// A half sine of `peak_g` over 90 ms from t = 0, 10 kHz from -20 ms.
fn samples(peak_g: f64) -> String {
    (0..1700)
        .map(|k| {
            let t = f64::from(k - 200) * 1e-4;
            let a = if (0.0..0.09).contains(&t) { -peak_g * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 };
            format!("{a:.6}\n")
        })
        .collect()
}

fn channel(code: &str, extra: &str, peak_g: f64) -> String {
    format!(
        "Test object number          :1\nChannel code                :{code}\nUnit                        :g\n\
         Reference channel           :implicit\nSampling interval           :0.0001\n\
         Time of first sample        :-0.02\nNumber of samples           :1700\n{extra}{}",
        samples(peak_g)
    )
}

/// Path inside the test and content.
fn files() -> Vec<(&'static str, String)> {
    vec![
        ("T7.MME", MME.to_owned()),
        ("Channel/t7.CHN", CHN.to_owned()),
        (
            "Channel/t7.001",
            channel("10SECMLERE00ACXP", "Transducer type :Endevco\nTransducer id :P1\nOdd key :kept\n", 30.0),
        ),
        ("Channel/T7.002", channel("10SECMRIRE00ACXP", "", 27.0)),
        ("Channel/t7.003", channel("10ENGN000000ACXP", "Data status :questionable data\n", 90.0)),
    ]
}

/// A folder with these files.
fn folder_of(files: &[(&str, String)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), files);
    folder
}

fn lone(content: &str) -> Result<Ingested, IngestError> {
    read_as("a.001", content, &lenient())
}

fn check(ingested: &Ingested) {
    let test = &ingested.test;
    assert_eq!((test.title.as_str(), test.vehicle.as_deref()), ("sled 7", Some("white car")));
    assert_eq!((test.mass_kg, test.impact_speed_m_per_s), (Some(1500.0), Some(50.0 * (1.0 / 3.6))));
    assert_eq!(test.pulse.as_deref(), Some("10SECMLERE00ACXP"));
    assert_eq!((test.channels.len(), ingested.waves.len()), (4, 3));
    assert_eq!(test.channel("11HEADCG00H3ACXA").unwrap().status, ChannelStatus::Absent);
    assert_eq!(test.channel("10ENGN000000ACXP").unwrap().status, ChannelStatus::Questionable);
    let pulse = test.channel("10SECMLERE00ACXP").unwrap();
    assert_eq!(pulse.location, "vehicle, seat cross member, left, rear");
    assert_eq!(pulse.sensor.as_deref(), Some("Endevco, P1"));
    assert_eq!(pulse.filter_state.as_deref(), Some("pre-filtered above CFC 1000"));
    assert!(pulse.comment.as_deref().unwrap().contains("Odd key: kept"));
    let text = notes(ingested);
    assert!(text.contains("mass is taken from T7.MME, \"mass test object 1\": 1500 (no unit: taken as kg)"), "{text}");
    assert!(text.contains("speed is taken from T7.MME"), "{text}");
    assert!(text.contains("1 of 4 channels listed in t7.CHN have no file here"), "{text}");
    assert!(text.contains("10SECMLERE00ACXP and 10SECMRIRE00ACXP (left and right) differ by"), "{text}");
}

#[test]
fn a_folder_whatever_the_case_of_its_names() {
    let folder = folder_of(&files());
    check(&open(folder.path(), &IngestSettings::default()).unwrap());
    check(&open(folder.path().join("T7.MME"), &IngestSettings::default()).unwrap());
    check(&open(folder.path().join("Channel/t7.CHN"), &IngestSettings::default()).unwrap());
}

#[test]
fn an_archive_with_one_top_folder_gives_the_same_digest_as_the_folder() {
    let folder = folder_of(&files());
    let archive = folder.path().join("t7.zip");
    let inside: Vec<_> = files().into_iter().map(|(path, content)| (format!("download/{path}"), content)).collect();
    fs::write(&archive, zipped(&inside)).unwrap();
    let zipped = open(&archive, &IngestSettings::default()).unwrap();
    check(&zipped);
    let unpacked = open(folder.path().join("T7.MME"), &IngestSettings::default()).unwrap();
    assert_eq!(zipped.test.source.digest, unpacked.test.source.digest);
}

#[test]
fn without_test_file_and_list_the_channels_are_read_all_the_same() {
    let folder = folder_of(&files()[2..]);
    let ingested = open(folder.path(), &lenient()).unwrap();
    assert_eq!((ingested.waves.len(), ingested.test.pulse.as_deref()), (3, Some("10SECMLERE00ACXP")));
    // One channel file by itself is one channel.
    let ingested = open(folder.path().join("Channel/T7.002"), &lenient()).unwrap();
    assert_eq!((ingested.test.channels.len(), ingested.test.pulse.as_deref()), (1, Some("10SECMRIRE00ACXP")));
}

#[test]
fn a_code_or_a_pattern_names_the_pulse() {
    let folder = folder_of(&files());
    let named =
        |channel: &str| open(folder.path(), &given(&format!("--channel {channel}"))).map(|i| i.test.pulse.unwrap());
    assert_eq!(named("1?SECMRI*X?").unwrap(), "10SECMRIRE00ACXP");
    assert_eq!(named("002").unwrap(), "10SECMRIRE00ACXP");
    let error = named("1?SECM*X?").unwrap_err();
    assert!(error.to_string().contains("--channel 1?SECM*X? means 2 channels: 10SECMLERE00ACXP"), "{error}");
    assert!(named("11HEAD*").unwrap_err().to_string().contains("11HEADCG00H3ACXA"));
}

#[test]
fn a_broken_channel_costs_itself_and_is_named() {
    let mut files = files();
    files[4].1 = "Channel code :10ENGN000000ACXP\nUnit :g\nSampling interval :1e-4\n1\n\u{1}\u{2}\n".to_owned();
    let folder = folder_of(&files);
    let ingested = open(folder.path(), &IngestSettings::default()).unwrap();
    assert_eq!(ingested.waves.len(), 2);
    assert!(notes(&ingested).contains("a channel is left out: t7.003, line 5"), "{}", notes(&ingested));
}

#[test]
fn an_explicit_time_channel_gives_the_grid() {
    let folder = tempfile::tempdir().unwrap();
    let times: String = (0..1700).map(|k| format!("{:.5}\n", f64::from(k - 200) * 1e-4)).collect();
    let time = format!(
        "Channel code :10TIRS000000TI00\nUnit :s\nSampling interval :0.0001\nTime of first sample :-0.02\n{times}"
    );
    let mut data = channel("10SECMLERE00ACXP", "", 30.0);
    data = data.replace(":implicit", ":explicit\nReference channel name      :10TIRS000000TI00");
    data = data.replace("Sampling interval           :0.0001\n", "");
    write(folder.path(), &[("t.001", data), ("t.002", time)]);
    for path in [folder.path().to_owned(), folder.path().join("t.001")] {
        let ingested = open(&path, &lenient()).unwrap();
        let pulse = ingested.pulse().unwrap_or_else(|| panic!("{}", notes(&ingested)));
        assert_eq!((pulse.samples.t0_s(), pulse.samples.dt_s(), pulse.samples.len()), (-0.02, 1e-4, 1700));
    }
    fs::remove_file(folder.path().join("t.002")).unwrap();
    let error = open(folder.path().join("t.001"), &lenient()).unwrap_err();
    assert!(error.to_string().contains("time channel 10TIRS000000TI00 is not here"), "{error}");
}

#[test]
fn odd_headers_are_read_with_a_remark() {
    let text = channel("10VEHC0000__ACXD", "a line without colon\nFirst global minimum value :-99\n", 20.0);
    let text = text.replace(":1700", ":2000").replace(":g\n", ":[g]\n").replace("0.0001", "0,0001") + "NOVALUE \n\n";
    let ingested = lone(&text).unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!((pulse.samples.len(), pulse.samples.dt_s()), (1700, 1e-4));
    assert!((pulse.quality.record.minimum + 20.0 * G).abs() < 1e-2 * G);
    assert_eq!(ingested.test.channels[0].cfc, Some(60));
    let notes = notes(&ingested);
    for words in [
        "places left open by \"_\"",
        "the header states 2000 samples, the file has 1701",
        "NOVALUE at 0 samples before and 1 after",
        "neither a keyword nor a number",
        "states the minimum -99, the samples have -20",
    ] {
        assert!(notes.contains(words), "{words}: {notes}");
    }
}

#[test]
fn amplitude_class_and_resolution_scale_nothing() {
    let plain = lone(&channel("10SECMLERE00ACXP", "", 20.0)).unwrap();
    let classed = channel("10SECMLERE00ACXP", "Channel amplitude class :500\nBit resolution :12\n", 20.0);
    assert_eq!(lone(&classed).unwrap().waves[0].samples, plain.waves[0].samples);
}

#[test]
fn time_is_never_invented() {
    let text = channel("10SECMLERE00ACXP", "", 20.0);
    let error = lone(&text.replace("Sampling interval           :0.0001\n", "")).unwrap_err();
    assert!(error.to_string().contains("no sampling interval is stated"), "{error}");
    assert!(error.hint().contains("a sample number is not taken for time"));
    let error = lone(&text.replace("0.0001\n", "0\n")).unwrap_err();
    assert!(error.to_string().contains("sampling interval 0 s"), "{error}");
    let late = lone(&text.replace("Time of first sample        :-0.02\n", "")).unwrap();
    assert!(notes(&late).contains("the time of the first sample is not stated, taken as 0 s"));
}

#[test]
fn an_unknown_unit_is_kept_as_read_until_it_is_stated() {
    let text = channel("10SECMLERE00ACXP", "", 20.0).replace("Unit                        :g\n", "");
    let ingested = lone(&text).unwrap();
    assert_eq!((ingested.waves[0].quantity, ingested.test.pulse), (QuantityKind::Other, None));
    let ingested = read_as("a.001", text, &given("--allow-missing --unit g")).unwrap();
    assert!((ingested.pulse().unwrap().quality.record.minimum + 20.0 * G).abs() < 1e-2 * G);
}

#[test]
fn header_counts_allocate_nothing() {
    let text = channel("10SECMLERE00ACXP", "", 20.0).replace(":1700", ":999999999999999");
    assert_eq!(lone(&text).unwrap().waves[0].samples.len(), 1700);
    let mut files = files();
    files[1].1 = CHN.replace(":4\r\n", ":4000000000\r\n");
    let folder = folder_of(&files);
    assert!(
        notes(&open(folder.path(), &IngestSettings::default()).unwrap())
            .contains("states 4000000000 channels and lists 4")
    );
}

#[test]
fn a_unit_may_have_brackets_of_its_own() {
    for unit in ["m/(s*s)", "[m/(s*s)]", "m/(s^2)"] {
        let text =
            channel("10SECMLERE00ACXP", "", 30.0).replace("Unit                        :g", &format!("Unit :{unit}"));
        let ingested = lone(&text).unwrap();
        let pulse = ingested.pulse().unwrap();
        assert_eq!(pulse.quantity, QuantityKind::Acceleration, "{unit}");
        // In m/s^2 as written: sample 650 is 45 ms, the top of the half sine.
        assert!((pulse.samples.samples()[650] + 30.0).abs() < 1e-6, "{unit}");
    }
}

#[test]
fn samples_beyond_the_announced_number_are_left_off() {
    let text = channel("10SECMLERE00ACXP", "", 30.0).replace("samples           :1700", "samples           :1698");
    let ingested = lone(&text).unwrap();
    assert_eq!(ingested.pulse().unwrap().samples.len(), 1698);
    let notes = ingested.notes.to_texts();
    let said = "warning: a.001: the header states 1698 samples, the file has 1700: the first 1698 are used";
    assert!(notes.iter().any(|note| note == said), "{notes:?}");
}

#[test]
fn a_test_file_without_its_edition_is_read_and_a_bare_speed_is_named() {
    let mut files = files();
    files[0].1 = files[0].1.replace("Data format edition number  :1.6\r\n", "");
    let folder = folder_of(&files);
    let ingested = open(folder.path(), &IngestSettings::default()).unwrap();
    assert_eq!(ingested.test.mass_kg, Some(1500.0));
    let notes = ingested.notes.to_texts().join("\n");
    assert!(notes.contains("lacks the line \"Data format edition number\""), "{notes}");

    files[0].1 = files[0].1.replace("50 km/h", "50");
    let folder = folder_of(&files);
    let ingested = open(folder.path(), &IngestSettings::default()).unwrap();
    let notes = ingested.notes.to_texts().join("\n");
    assert_eq!(ingested.test.impact_speed_m_per_s, None);
    assert!(notes.contains("velocity test object 1 is 50 without a unit"), "{notes}");
    assert!(notes.contains("add --impact-speed 50km/h") && !notes.contains("a header line"), "{notes}");
}

#[test]
fn a_real_channel_by_itself() {
    let Some(path) = shared("data/iso-mme-98_7707/98_7707.001") else { return };
    let ingested = open(&path, &lenient()).unwrap();
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
