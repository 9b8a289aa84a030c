//! Whatever the bytes, the answer is a result or a refusal.

use std::fs;
use std::io::{Cursor, Write};

use crumple_ingest::{Bundle, IngestError, IngestSettings, Refusal, ingest};
use crumple_testkit::shared;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestRunner;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const CSV: &str = "# mass: 873 kg\n# impact speed: 36 km/h\ntime_s,accel_g,force [kN]\n";
const EV5: &str = "# Source\n----- EV5 -----\n----- TEST -----\nV5|NCAP - 2018 CAR|||LAB||R|NCA|VTB|||22|||57.09|0|0\n\
    ----- VEHICLE -----\n1|16|03|2018|||||||1719|1514\n----- BARRIER -----\nR|LCB|0|0|X\n----- INSTRUMENTATION -----\n\
    1|93|AC|NA|FLLR|XG|SEC|G'S|2800|M|D|800|21|57.09|-5|64|100|AM|P|REAR SEAT X\n\
    1|96|AC|NA|ENGN|XG|SEC|G'S|2800|M|D|800|21|57.09|-5|64|100|CF|P|ENGINE X: bad\n----- END -----\n";

fn table() -> Vec<u8> {
    let rows: String =
        (0..60).map(|k| format!("{:.4},{:.3},{k}\n", f64::from(k) * 1e-4 - 0.001, -0.1 * f64::from(k))).collect();
    (CSV.to_owned() + &rows).into_bytes()
}

fn curve() -> Vec<u8> {
    (-5..65)
        .map(|k| format!("{:.6}\t{:.6}\n", f64::from(k) * 1e-4, -0.1 * f64::from(k)))
        .collect::<String>()
        .into_bytes()
}

fn zipped() -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in [("t/v1.EV5", EV5.as_bytes().to_vec()), ("t/v1.093", curve()), ("t/v1.096", curve())] {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(&bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Replaces, inserts, removes and cuts bytes; the pieces are those that matter to a reader.
fn mutate(mut bytes: Vec<u8>, changes: &[(u8, Index, usize)]) -> Vec<u8> {
    const PIECES: [&[u8]; 22] = [
        b"NaN",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\r\n",
        b"\"",
        b"#",
        b"-",
        b"1e999",
        b"|",
        b"\0",
        b"\xFF\xFE",
        b" ",
        b":",
        b"-----",
        b"99999999999999999999",
        b"\n\n",
        b"e",
        b".",
        b"0",
        b"kg",
    ];
    for (kind, at, piece) in changes {
        let at = at.index(bytes.len() + 1);
        let piece = PIECES[piece % PIECES.len()];
        match kind % 4 {
            0 => drop(bytes.splice(at..at, piece.iter().copied())),
            1 => {
                let end = (at + piece.len()).min(bytes.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            2 => drop(bytes.drain(at..(at + piece.len()).min(bytes.len()))),
            _ => bytes.truncate(bytes.len().max(1) - (bytes.len().max(1) - at.min(bytes.len().max(1))) / 8),
        }
    }
    bytes
}

/// A result has finite samples and a pulse; a refusal has words. Reaching the end is the point.
fn check(bundle: Result<Bundle, IngestError>, settings: &IngestSettings) {
    match bundle.and_then(|bundle| ingest(&bundle, settings)) {
        Ok(ingested) => {
            assert!(ingested.pulse().is_none_or(|w| w.samples.len() >= 50));
            assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
        }
        Err(error) => assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
    }
}

fn settings() -> impl Strategy<Value = IngestSettings> {
    (prop::option::of(prop::sample::select(vec!["accel_g", "93", "2", "96", "x"])), any::<bool>()).prop_map(
        |(channel, allow)| IngestSettings {
            channel: channel.map(str::to_owned),
            allow_missing: Some(allow),
            ..IngestSettings::default()
        },
    )
}

fn changes() -> impl Strategy<Value = Vec<(u8, Index, usize)>> {
    vec((any::<u8>(), any::<Index>(), 0_usize..64), 0..6)
}

#[test]
fn the_unchanged_examples_are_read() {
    let all = IngestSettings::default();
    assert!(ingest(&Bundle::from_bytes("a.csv", table()).unwrap(), &all).is_ok());
    let mut bundle = Bundle::from_bytes("v1.EV5", EV5.as_bytes().to_vec()).unwrap();
    bundle.companions.insert("v1.093".to_owned(), curve());
    assert_eq!(ingest(&bundle, &all).unwrap().test.pulse.as_deref(), Some("93"));
    let path = tempfile::tempdir().unwrap();
    let file = path.path().join("v1.zip");
    fs::write(&file, zipped()).unwrap();
    assert_eq!(ingest(&Bundle::open(&file).unwrap(), &all).unwrap().waves.len(), 2);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_tables(changes in changes(), settings in settings()) {
        check(Bundle::from_bytes("a.csv", mutate(table(), &changes)), &settings);
    }

    #[test]
    fn mutated_tests(spec in changes(), samples in changes(), settings in settings()) {
        let bundle = Bundle::from_bytes("v1.EV5", mutate(EV5.as_bytes().to_vec(), &spec)).map(|mut bundle| {
            bundle.companions.insert("v1.093".to_owned(), mutate(curve(), &samples));
            bundle.companions.insert("v1.096".to_owned(), curve());
            bundle
        });
        check(bundle, &settings);
    }

    #[test]
    fn any_bytes(bytes in vec(any::<u8>(), 0..400), settings in settings()) {
        check(Bundle::from_bytes("a.bin", bytes), &settings);
    }

    #[test]
    fn any_printed_text(text in "[-0-9.,;eE\t \n#a-z\"()]{0,400}", settings in settings()) {
        check(Bundle::from_bytes("a.txt", text.into_bytes()), &settings);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_archives(changes in changes(), settings in settings()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("v1.zip");
        fs::write(&path, mutate(zipped(), &changes)).unwrap();
        check(Bundle::open(&path), &settings);
    }
}

/// An ISO-MME channel file.
fn channel_file() -> Vec<u8> {
    let samples: String = (0..80).map(|k| format!("{:.4e}\n", -0.1 * f64::from(k))).collect();
    format!(
        "Test object number          :1\nChannel code                :10SECMLERE00ACXP\n\
         Unit                        :g\n\
         Reference channel           :implicit\nSampling interval           :0.0001\n\
         Time of first sample        :-0.002\nNumber of samples           :80\n{samples}NOVALUE\n"
    )
    .into_bytes()
}

/// An MCAP file of JSON messages.
fn mcap_file() -> Vec<u8> {
    let mut writer = mcap::WriteOptions::new().create(Cursor::new(Vec::new())).unwrap();
    let channel = writer.add_channel(0, "/a", "json", &std::collections::BTreeMap::new()).unwrap();
    for k in 0..60_u64 {
        let time = 1_000_000 * k;
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, format!("{{\"x\":{k}}}").as_bytes()).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// A ROS bag with one connection and some messages that are too short for what they claim to be.
fn bag() -> Vec<u8> {
    let block = |bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat();
    let field = |name: &str, value: &[u8]| block(&[name.as_bytes(), b"=", value].concat());
    let conn = field("conn", &0_u32.to_le_bytes());
    let about = [field("topic", b"/imu"), field("type", b"sensor_msgs/Imu")].concat();
    let mut bag = b"#ROSBAG V2.0\n".to_vec();
    bag.extend(block(&[field("op", &[7]), conn.clone(), field("topic", b"/imu")].concat()));
    bag.extend(block(&about));
    for k in 0..60_u32 {
        bag.extend(block(&[field("op", &[2]), conn.clone()].concat()));
        let mut message =
            [1_u32.to_le_bytes(), 5_u32.to_le_bytes(), (k * 1_000_000).to_le_bytes(), 0_u32.to_le_bytes()].concat();
        message.resize(16 + 37 * 8, 0);
        bag.extend(block(&message));
    }
    bag
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_channel_files(changes in changes(), settings in settings()) {
        check(Bundle::from_bytes("a.001", mutate(channel_file(), &changes)), &settings);
    }

    #[test]
    fn mutated_bags(changes in changes(), settings in settings()) {
        check(Bundle::from_bytes("a.bag", mutate(bag(), &changes)), &settings);
    }

    #[test]
    fn mutated_recordings(changes in changes(), settings in settings()) {
        let settings = IngestSettings { field: Some("x".to_owned()), unit: Some("g".to_owned()), ..settings };
        check(Bundle::from_bytes("a.mcap", mutate(mcap_file(), &changes)), &settings);
    }
}

#[test]
fn the_unchanged_recordings_are_read() {
    let settings =
        IngestSettings { field: Some("x".to_owned()), allow_missing: Some(true), ..IngestSettings::default() };
    for (name, bytes, waves) in [("a.001", channel_file(), 1), ("a.bag", bag(), 6), ("a.mcap", mcap_file(), 1)] {
        assert_eq!(ingest(&Bundle::from_bytes(name, bytes).unwrap(), &settings).unwrap().waves.len(), waves, "{name}");
    }
}

fn archive(files: &[(&str, usize)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let zeros = vec![b'0'; 1 << 20];
    for (name, mebibytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        for _ in 0..*mebibytes {
            zip.write_all(&zeros).unwrap();
        }
    }
    zip.finish().unwrap().into_inner()
}

fn open(name: &str, bytes: &[u8]) -> Result<Bundle, IngestError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    Bundle::open(&path)
}

fn refused(bundle: Result<Bundle, IngestError>) -> String {
    let error = match bundle.and_then(|bundle| ingest(&bundle, &IngestSettings::default())) {
        Err(error) => error,
        Ok(_) => panic!("it was read"),
    };
    assert!(error.refusal == Refusal::TooLarge, "{error:?}");
    error.to_string()
}

#[test]
fn a_zip_bomb_is_not_inflated_to_its_end() {
    let bomb = archive(&[("a.csv", 300)]);
    assert!(bomb.len() < 1 << 20, "a good bomb is small");
    assert_eq!(refused(open("a.zip", &bomb)), "a.zip: a.csv: more than 256 MiB when unpacked");
}

#[test]
fn a_bomb_of_many_files_is_refused_by_what_it_claims() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("v1.EV5", SimpleFileOptions::default()).unwrap();
    zip.write_all(b"----- EV5 -----\n----- TEST -----\n").unwrap();
    for k in 0..9 {
        zip.start_file(format!("v1.{k:03}"), SimpleFileOptions::default()).unwrap();
        zip.write_all(b"0\n").unwrap();
    }
    let mut bomb = zip.finish().unwrap().into_inner();
    // Each of the nine claims 240 MiB, within the limit of a file: 24 bytes into its entry of the central directory.
    let entries: Vec<usize> = (0..bomb.len()).filter(|at| bomb[*at..].starts_with(b"PK\x01\x02")).collect();
    for at in &entries[1..] {
        bomb[at + 24..at + 28].copy_from_slice(&(240_u32 << 20).to_le_bytes());
    }
    assert_eq!(refused(open("a.zip", &bomb)), "a.zip: the files of the record take more than 2048 MiB");
}

#[test]
fn an_archive_of_countless_files_is_refused_before_any_is_read() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for k in 0..20_001 {
        zip.start_file(format!("{k}.csv"), SimpleFileOptions::default()).unwrap();
    }
    assert_eq!(refused(open("a.zip", &zip.finish().unwrap().into_inner())), "a.zip: 20001 entries");
}

#[test]
fn endless_lines_are_refused_where_they_start() {
    let line = "1".repeat((1 << 20) + 10);
    assert_eq!(
        refused(open("a.csv", format!("0,1\n{line}").as_bytes())),
        "a.csv, line 2: the line is longer than 1 MiB"
    );
    let header = "Channel code :10VEHC000000ACX0\n";
    let text = format!("{header}Comments :{line}");
    assert_eq!(refused(open("a.001", text.as_bytes())), "a.001, line 2: the line is longer than 1 MiB");
}

#[test]
fn endless_headers_are_refused() {
    let text = format!("Channel code :10VEHC000000ACX0\n{}", "Comments :x\n".repeat(20_000));
    assert_eq!(refused(open("a.001", text.as_bytes())), "a.001, line 10001: more than 10000 lines of keywords");
}

#[test]
fn thousands_of_columns_are_no_record() {
    let row = vec!["1"; 5000].join(",");
    assert_eq!(refused(open("a.csv", format!("{row}\n{row}\n").as_bytes())), "a.csv, line 1: 5000 columns");
}

/// A change: what, where, which piece, how long.
type Change = (u8, Index, u8, u16);

fn changes_of_real_files() -> impl Strategy<Value = Vec<Change>> {
    vec((any::<u8>(), any::<Index>(), any::<u8>(), 0_u16..400), 1..5)
}

/// Bytes set, pieces put in, taken out or doubled, the end cut off. Half of the places are in the first 4 KiB, where
/// the headers are.
fn mutate_real_file(mut bytes: Vec<u8>, changes: &[Change]) -> Vec<u8> {
    const PIECES: [&[u8]; 16] = [
        b"NaN",
        b",",
        b";",
        b"\t",
        b"\n",
        b"\"",
        b"-",
        b"1e999",
        b"|",
        b"\0\0\0\0",
        b"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF",
        b":",
        b"0",
        b"\x7F\xFF\xFF\xFF",
        b"<",
        b"99999999999999999999",
    ];
    for (kind, at, piece, length) in changes {
        let span = if kind & 8 == 0 { bytes.len().min(4096) } else { bytes.len() };
        let at = at.index(span + 1);
        let end = (at + usize::from(*length)).min(bytes.len());
        let bytes_of_piece = PIECES[usize::from(*piece) % PIECES.len()];
        match kind % 6 {
            0 => drop(bytes.splice(at..at, bytes_of_piece.iter().copied())),
            1 => drop(bytes.splice(at..(at + bytes_of_piece.len()).min(bytes.len()), bytes_of_piece.iter().copied())),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            4 => bytes[at..].iter_mut().take(1).for_each(|b| *b ^= piece),
            _ if kind & 16 == 0 => bytes.truncate(at),
            _ => {}
        }
    }
    bytes
}

fn check_real_file(name: &str, bundle: Result<Bundle, IngestError>) {
    // What a record lacks is not asked back, and messages are resampled, so that reading gets as far as it can.
    let settings = IngestSettings {
        allow_missing: Some(true),
        unit: Some("g".to_owned()),
        field: name.ends_with(".mcap").then(|| "clientX".to_owned()),
        sample_time: name.ends_with(".dat").then(|| "80ms".parse().unwrap()),
        resample: Some("20Hz".parse().unwrap()),
        ..IngestSettings::default()
    };
    match bundle.and_then(|bundle| ingest(&bundle, &settings)) {
        Ok(ingested) => {
            assert!(ingested.waves.iter().all(|w| w.samples.samples().iter().all(|x| x.is_finite())));
        }
        Err(error) => assert!(!error.to_string().is_empty() && !error.hint().is_empty()),
    }
}

/// Damages the main file and, half of the time, one of the files beside it.
fn never_panics(main: &str, beside: &[&str], cases: u32) {
    let Some(path) = shared(main) else { return };
    let folder = path.parent().unwrap();
    let name = path.file_name().unwrap().to_str().unwrap();
    let bytes = fs::read(&path).unwrap();
    let companions: Vec<(&str, Vec<u8>)> = beside.iter().map(|n| (*n, fs::read(folder.join(n)).unwrap())).collect();
    let config =
        ProptestConfig { cases, failure_persistence: None, max_shrink_iters: 200, ..ProptestConfig::default() };
    let work = tempfile::tempdir().unwrap();
    let strategy = (changes_of_real_files(), changes_of_real_files(), any::<Option<Index>>());
    TestRunner::new(config)
        .run(&strategy, |(of_main, of_companion, which)| {
            let main = if which.is_some() && of_main.len() % 2 == 0 {
                bytes.clone()
            } else {
                mutate_real_file(bytes.clone(), &of_main)
            };
            if name.ends_with(".zip") {
                let path = work.path().join(name);
                fs::write(&path, main).unwrap();
                check_real_file(name, Bundle::open(&path));
                return Ok(());
            }
            let bundle = Bundle::from_bytes(name, main).map(|mut bundle| {
                bundle.companions.extend(companions.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.clone())));
                if let Some(which) = which.filter(|_| !companions.is_empty()) {
                    let (name, bytes) = &companions[which.index(companions.len())];
                    bundle.companions.insert((*name).to_owned(), mutate_real_file(bytes.clone(), &of_companion));
                }
                bundle
            });
            check_real_file(name, bundle);
            Ok(())
        })
        .unwrap();
}

#[test]
fn nhtsa_specification_and_curves() {
    never_panics("data/nhtsa-v10146-camry-frontal/v10146.EV5", &["v10146.093", "v10146.094", "v10146.096"], 100);
}

#[test]
fn nhtsa_archive() {
    never_panics("data/nhtsa-v10146-camry-frontal/v10146_barrier_fx.zip", &[], 30);
}

#[test]
fn iso_channel() {
    never_panics("data/iso-mme-98_7707/98_7707.001", &[], 300);
}

#[test]
fn tdms_and_tdm() {
    never_panics("data/iihs-diadem-tdms/Target Pulse.tdms", &[], 1000);
    never_panics("data/nptdms-fixtures/big_endian.tdms", &[], 300);
    never_panics("data/nptdms-fixtures/raw1.tdms", &[], 300);
    never_panics("data/iihs-diadem-tdms/Corridors.TDM", &["Corridors.tdx"], 300);
}

#[test]
fn labview_texts() {
    for name in ["no_decimal_separator", "short", "with_empty_fields", "multi_time_column"] {
        never_panics(&format!("data/lvm-fixtures/{name}.lvm"), &[], 300);
    }
    never_panics("data/shock-table-lvm/Test_002.lvm", &[], 20);
}

#[test]
fn tables() {
    never_panics("data/iihs-cep1705-accord/CEP1705_ACXD.csv", &[], 100);
    never_panics("data/pcb-shock-txt/acc_base_a0.txt", &[], 100);
    never_panics("data/drop-tower-csv/accel_1.csv", &[], 40);
    never_panics("data/sysid/hair-dryer/dryer.dat", &[], 200);
}

#[test]
fn recordings() {
    never_panics("data/ros-imu-bag/tilt_laser.bag", &[], 60);
    never_panics("data/mcap-json/example.mcap", &[], 500);
}
