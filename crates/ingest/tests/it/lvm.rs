//! LVM: the real files, and texts written here for what they lack.

use crumple_ingest::{Bundle, IngestError, IngestSettings, ReadChannel, Recording};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;

use crate::{given, grid, has_note, open, samples};

fn read(text: impl AsRef<[u8]>) -> Result<Recording, IngestError> {
    let bundle = Bundle::from_bytes("t.lvm", text.as_ref().to_vec())?;
    bundle.read(&IngestSettings::default())
}

fn recording(path: &str) -> Option<Recording> {
    let bundle = Bundle::open(&shared(path)?).unwrap();
    assert_eq!(bundle.reader.format, "lvm");
    Some(bundle.read(&IngestSettings::default()).unwrap())
}

/// Acceptance 9, first half.
#[test]
fn short_has_decimal_commas_and_no_x_column() {
    let Some(recording) = recording("data/lvm-fixtures/short.lvm") else { return };
    let [force, response] = &recording.channels[..] else { panic!("{:?}", recording.channels) };
    assert_eq!((force.channel.quantity, response.channel.quantity), (QuantityKind::Force, QuantityKind::Acceleration));
    assert_eq!((grid(force), grid(response)), ((0.0, 3.90625e-5), (0.0, 3.90625e-5)));
    assert_eq!(samples(force)[..2], [0.914_018, 0.537_321]);
    assert_eq!((samples(response).len(), samples(response)[9]), (10, 1.212_775));
    assert_eq!(response.channel.id, "Response_Trigger");
    assert_eq!(recording.details.facts, ["recorded 2013/02/19 09:51:39 by JS"]);
}

/// Acceptance 9, second half. Extremes as printed with the record.
#[test]
fn test_002_has_two_accelerations_at_51_2_khz() {
    let Some(recording) = recording("data/shock-table-lvm/Test_002.lvm") else { return };
    let accelerations: Vec<&ReadChannel> =
        recording.channels.iter().filter(|f| f.channel.quantity == QuantityKind::Acceleration).collect();
    assert_eq!((recording.channels.len(), accelerations.len()), (6, 2));
    for (found, minimum, maximum) in
        [(accelerations[0], -13_028.64, 38_649.58), (accelerations[1], -118_374.0, 116_701.0)]
    {
        let a = samples(found);
        assert_eq!((a.len(), grid(found)), (51_200, (0.0, 1.953_125e-5)));
        let (low, high) = a.iter().fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(*x), high.max(*x)));
        // Half a unit of the last digit that the record's description prints.
        let digit = if minimum < -1e5 { 0.5 } else { 0.005 };
        assert!((low - minimum).abs() <= digit && (high - maximum).abs() <= digit, "{low} {high}");
    }
    let first = samples(accelerations[0]);
    assert_eq!(first.iter().position(|x| *x == first.iter().copied().fold(0.0, f64::min)), Some(5029));
    assert_eq!(samples(&recording.channels[2]), [100_000.0, 10_000.0, 1000.0, 120.0, 100.0]);
    has_note(&recording, "X0 = 46.859645800000074 s is the time since the program began");
}

#[test]
fn test_002_goes_through_with_its_channel_named() {
    let Some(path) = shared("data/shock-table-lvm/Test_002.lvm") else { return };
    let error = open(&path, &IngestSettings::default()).unwrap_err();
    assert!(error.to_string().contains("Acceleration_0, Acceleration_1"), "{error}");
    let ingested = open(&path, &given("--channel Acceleration_0")).unwrap();
    assert_eq!((ingested.test.pulse.as_deref(), ingested.waves.len()), (Some("Acceleration_0"), 6));
    // A shock table pushes: nobody asks for an impact speed.
    let notes = ingested.notes.to_texts().join("\n");
    assert!(notes.contains("no mass is stated") && !notes.contains("--impact-speed"), "{notes}");
}

#[test]
fn one_x_column_for_each_channel() {
    let Some(recording) = recording("data/lvm-fixtures/multi_time_column.lvm") else { return };
    let [voltage, acceleration] = &recording.channels[..] else { panic!("{:?}", recording.channels) };
    assert_eq!(samples(voltage), [-0.035_229, -0.034_882, -0.034_191]);
    assert_eq!(samples(acceleration), [0.532_608 * G, 0.502_991 * G, 0.467_541 * G]);
    assert_eq!((grid(voltage), grid(acceleration)), ((0.0, 1.953_125e-5), (0.0, 1.953_125e-5)));
    has_note(&recording, "51200 samples are announced, 3 are there, in 2 channels");
}

#[test]
fn version_0_92_has_a_comma_in_the_clock_only() {
    let Some(recording) = recording("data/lvm-fixtures/no_decimal_separator.lvm") else { return };
    assert_eq!(recording.channels.len(), 3);
    assert_eq!(samples(&recording.channels[0])[3], 0.059_248 * G);
    assert_eq!(grid(&recording.channels[2]), (0.0, 2.5e-4));
    let axes: Vec<String> = recording.channels.iter().map(|f| f.channel.axis.unwrap().to_string()).collect();
    assert_eq!(axes, ["x", "y", "z"]);
}

#[test]
fn channels_without_samples_are_left_out() {
    let Some(recording) = recording("data/lvm-fixtures/with_empty_fields.lvm") else { return };
    let ids: Vec<&str> = recording.channels.iter().map(|f| f.channel.id.as_str()).collect();
    assert_eq!(ids, ["Dev0_Ai0", "Dev0_Ai2", "Dev0_Ai0_1"]);
    assert_eq!(samples(&recording.channels[1])[6], 7.254_639);
    has_note(&recording, "no samples in Untitled, Untitled_1, Untitled_2, Untitled_3: left out");
}

const HEAD: &str = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n\
    X_Columns\tOne\nDate\t2024/01/02\nTime\t10:00:00.0\n\
    ***End_of_Header***\t\n\t\n";

fn segment(x0: f64, from: usize, n: usize) -> String {
    let rows: String = (0..n).map(|k| format!("{:.6}\t{}\n", x0 + k as f64 * 1e-3, from + k)).collect();
    format!(
        "Channels\t1\nSamples\t{n}\nDate\t2024/01/02\nTime\t10:00:05.0\nY_Unit_Label\tg\n\
         X_Dimension\tTime\nX0\t{x0}\nDelta_X\t0.001\n***End_of_Header***\t\n\
         X_Value\tacc\tComment\n{rows}\n"
    )
}

#[test]
fn segments_that_continue_are_joined_and_others_kept_apart() {
    let joined = read(format!("{HEAD}{}{}", segment(0.0, 0, 60), segment(0.06, 60, 40))).unwrap();
    assert_eq!(joined.channels.len(), 1);
    let expected: Vec<f64> = (0..100).map(|k| f64::from(k) * G).collect();
    assert_eq!(samples(&joined.channels[0]), expected);
    let apart = read(format!("{HEAD}{}{}", segment(0.0, 0, 60), segment(0.5, 60, 40))).unwrap();
    let ids: Vec<&str> = apart.channels.iter().map(|f| f.channel.id.as_str()).collect();
    assert_eq!(ids, ["segment_1.acc", "segment_2.acc"]);
    assert_eq!(grid(&apart.channels[1]), (0.5, 1e-3));
    has_note(&apart, "2 segments of the file do not continue each other");
}

/// Two channels whose clocks are 0.1 s apart, with their X0.
#[test]
fn channels_that_start_later_by_the_clock_stand_later() {
    let text = |clocks: [&str; 2], x0: [f64; 2]| {
        let rows: String = (0..60).map(|k| format!("\t{k}\t{k}\n")).collect();
        format!(
            "{}Channels\t2\nSamples\t60\t60\nDate\t2024/01/02\t2024/01/02\nTime\t{}\t{}\nY_Unit_Label\tg\tg\n\
             X_Dimension\tTime\tTime\nX0\t{}\t{}\nDelta_X\t0.001\t0.001\n***End_of_Header***\t\n\
             X_Value\ta\tb\tComment\n{rows}\n",
            HEAD.replace("X_Columns\tOne", "X_Columns\tNo"),
            clocks[0],
            clocks[1],
            x0[0],
            x0[1]
        )
    };
    let starts = |text: String| -> Vec<f64> { read(text).unwrap().channels.iter().map(|f| grid(f).0).collect() };
    // Rounding of the seconds of a day: 4e-12.
    let is_near = |found: Vec<f64>, wanted: [f64; 2]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-10);
    assert!(is_near(starts(text(["10:00:05.0", "10:00:05.1"], [0.0, 0.0])), [0.0, 0.1]));
    assert!(is_near(starts(text(["10:00:05.1", "10:00:05.0"], [0.0, -0.05])), [0.1, -0.05]));
    // X0 holds it already.
    assert!(is_near(starts(text(["10:00:05.0", "10:00:05.1"], [0.0, 0.1])), [0.0, 0.1]));
    // X0 counts from the start of the program, at 10:00:00.
    assert!(is_near(starts(text(["10:00:05.0", "10:00:05.1"], [5.0, 5.1])), [0.0, 0.1]));
    // X in ms, with an X0 of 2 ms: the clock counts in s all the same.
    let in_ms = text(["10:00:05.0", "10:00:05.5"], [2.0, 2.0])
        .replace("X_Dimension\tTime\tTime\n", "X_Dimension\tTime\tTime\nX_Unit_Label\tms\tms\n");
    assert!(is_near(starts(in_ms), [2e-3, 0.502]));
    assert!(is_near(starts(text(["10:00:05.0", "10:02:05.0"], [0.0, 0.0])), [0.0, 0.0]));
}

#[test]
fn comments_and_special_blocks_are_no_samples() {
    let special = "***Start_Special***\nanything\t1\n***End_Special***\n";
    let text = format!("{HEAD}{special}{}", segment(0.0, 0, 60)).replacen("\t3\n", "\t3\ta remark, with 7\n", 1);
    let recording = read(text).unwrap();
    assert_eq!((recording.channels.len(), samples(&recording.channels[0]).len()), (1, 60));
}

#[test]
fn line_ends_and_marks_of_windows() {
    let text = format!("\u{feff}{HEAD}{}", segment(0.0, 0, 60)).replace('\n', "\r\n");
    assert_eq!(samples(&read(text).unwrap().channels[0]).len(), 60);
}

#[test]
fn refusals_name_line_and_column() {
    let good = format!("{HEAD}{}", segment(0.0, 0, 60));
    // The header ends in line 8, the first row is line 20.
    let error = |from: &str, to: &str| read(good.replacen(from, to, 1)).unwrap_err().to_string();
    assert_eq!(error("\t7\n", "\tseven\n"), "t.lvm, line 27, column 2 (acc): \"seven\" is not a finite number");
    let hint = read(good.replacen("\t7\n", "\tseven\n", 1)).unwrap_err().hint().to_owned();
    assert!(hint.contains("write the number that belongs there"), "{hint}");
    assert_eq!(samples(&read(&good).unwrap().channels[0])[7], 7.0 * G);
    assert_eq!(error("\t7\n", "\t\n"), "t.lvm, line 28, column 2 (acc): a sample after empty fields");
    assert!(error("0.007000\t7\n", "").starts_with("t.lvm, line 27, column 2 (acc): X is 0.008, the row is at 0.007"));
    assert_eq!(error("\t7\n", "\tNaN\n"), "t.lvm, column acc: sample 7 of 60 is missing (NaN)");
    assert!(error("Channels\t1", "Channels\t99999999999").contains("\"99999999999\" channels are announced"));
    assert!(error("X_Dimension\tTime", "X_Dimension\tFrequency").contains("its X axis is \"Frequency\", not time"));
    assert!(error("Delta_X\t0.001\n", "").contains("no time"));
    assert!(
        error("Separator\tTab\nDecimal_Separator\t.", "Separator\tComma\nDecimal_Separator\t,")
            .contains("decimal commas")
    );
    let header_only = read(HEAD).unwrap_err().to_string();
    assert_eq!(header_only, "t.lvm: a header without a segment of data");
    assert!(read("LabVIEW Measurement\nSeparator\tTab\n").unwrap_err().to_string().contains("ends in a header"));
    let endless = format!("{HEAD}Channels\t1\nNotes\t{}", "x".repeat((1 << 20) + 10));
    assert!(read(endless).unwrap_err().to_string().contains("longer than 1 MiB"));
}

/// Files whose mutations must not panic.
pub fn examples() -> [Vec<u8>; 2] {
    [
        format!("{HEAD}{}{}", segment(0.0, 0, 60), segment(0.06, 60, 40)).into_bytes(),
        format!("{HEAD}{}", segment(0.0, 0, 60)).replace("One", "Multi").into_bytes(),
    ]
}
