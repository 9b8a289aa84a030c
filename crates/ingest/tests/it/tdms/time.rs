//! Where the time comes from: steps, a sibling channel, times of the day.

use crumple_ingest::{IngestError, IngestSettings, Recording};

use crate::tdms::writer::{
    BIG, NEW_LIST, RAW, Value, Writer, accelerometer, has_note, lenient, pulse, read, read_with, samples, segment,
};

/// A group with a channel of times of `n` samples and an accelerometer of `m` without steps of its own.
pub fn with_times(n: usize, m: usize, step: f64) -> Vec<u8> {
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'Time'", Some((10, n as u64)), &[]).object("/'g'/'acc (g)'", Some((10, m as u64)), &[]);
    let mut raw = Writer::new(false);
    raw.doubles((0..n).map(|k| k as f64 * step - 100.0 * step)).doubles((0..m).map(pulse));
    segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes)
}

#[test]
fn a_sibling_channel_of_times_gives_the_grid() {
    for (n, m, length) in [(601, 600, 600), (600, 600, 600), (600, 601, 600)] {
        let recording = read(with_times(n, m, 1e-4)).unwrap();
        let wave = recording.channels[0].wave.as_ref().unwrap();
        assert_eq!((recording.channels.len(), wave.len(), wave.t0_s(), wave.dt_s()), (1, length, -0.01, 1e-4));
        has_note(&recording, "no unit of time is stated for Time: taken as s");
        if n != m {
            has_note(&recording, &format!("has {n} samples, g.acc {m}: the shorter length is used"));
        }
    }
    let settings = IngestSettings { time_unit: Some("ms".to_owned()), ..IngestSettings::default() };
    let recording = read_with(with_times(600, 600, 0.1), &settings).unwrap();
    assert_eq!(recording.channels[0].wave.as_ref().unwrap().dt_s(), 1e-4);
}

#[test]
fn times_of_the_day_count_from_the_first() {
    for big in [false, true] {
        let mut metadata = Writer::new(big);
        metadata.object("/'g'/'stamp'", Some((0x44, 60)), &[]).object("/'g'/'acc (g)'", Some((10, 60)), &[]);
        let mut raw = Writer::new(big);
        for k in 0..60_u64 {
            // From 3.6e9 s + 0.97 s in steps of 1 ms, across a whole second.
            let (ms, seconds) = ((970 + k) % 1000, 3_600_000_000 + (970 + k) / 1000);
            let fraction = (ms as f64 * 1e-3 * 2_f64.powi(64)) as u64;
            if big {
                raw.u64(seconds).u64(fraction);
            } else {
                raw.u64(fraction).u64(seconds);
            }
        }
        raw.doubles((0..60).map(pulse));
        let toc = NEW_LIST | RAW | if big { BIG } else { 0 };
        let recording = read(segment(toc, 2, &metadata, &raw.bytes)).unwrap();
        let wave = recording.channels[0].wave.as_ref().unwrap();
        assert_eq!((recording.channels.len(), wave.t0_s(), wave.dt_s()), (1, 0.0, 1e-3));
    }
}

#[test]
fn no_time_is_refused_and_so_is_another_axis() {
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'acc (g)'", Some((10, 60)), &[]);
    let mut raw = Writer::new(false);
    raw.doubles([0.0; 60]);
    let error = read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)).unwrap_err().to_string();
    assert!(error.contains("no time: neither a sampling interval"), "{error}");
    let mut properties = accelerometer();
    properties.push(("wf_xname", Value::Text("Tension")));
    let mut metadata = Writer::new(false);
    metadata.object("/'g'/'a'", Some((10, 60)), &properties);
    let error = read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes)).unwrap_err().to_string();
    assert!(error.contains("its X axis is \"Tension\", not time"), "{error}");
}

#[test]
fn inner_gaps_are_refused_and_gaps_at_the_end_cut() {
    let file = |gap: std::ops::Range<usize>| {
        let mut metadata = Writer::new(false);
        metadata.object("/'g'/'a'", Some((10, 80)), &accelerometer());
        let mut raw = Writer::new(false);
        raw.doubles((0..80).map(|k| if gap.contains(&k) { f64::NAN } else { pulse(k) }));
        read(segment(NEW_LIST | RAW, 1, &metadata, &raw.bytes))
    };
    let recording = file(70..80).unwrap();
    assert_eq!(samples(&recording.channels[0]).len(), 70);
    has_note(&recording, "10 missing samples (NaN) cut off at the end of g.a");
    let error = file(40..42).unwrap_err();
    assert_eq!(error.to_string(), "t.tdms, column g.a: sample 40 of 80 is missing (NaN)");
    assert!(file(0..80).unwrap_err().to_string().contains("no channel has samples"));
}

/// Two channels of 60 samples at 1e-4 s from -0.01 s of their own axes, the second `later` seconds after the first.
fn apart(later: f64, second_offset: f64) -> Recording {
    let mut metadata = Writer::new(false);
    for (path, start, offset) in [("/'g'/'a'", 3.6e9, -0.01), ("/'g'/'b'", 3.6e9 + later, second_offset)] {
        let properties = [
            ("wf_increment", Value::Double(1e-4)),
            ("wf_start_offset", Value::Double(offset)),
            ("unit_string", Value::Text("g")),
            ("wf_start_time", Value::Time(start)),
        ];
        metadata.object(path, Some((10, 60)), &properties);
    }
    let mut raw = Writer::new(false);
    raw.doubles([0.5; 120]);
    read(segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes)).unwrap()
}

fn starts(recording: &Recording) -> Vec<f64> {
    recording.channels.iter().map(|read| read.wave.as_ref().unwrap().t0_s()).collect()
}

#[test]
fn channels_that_start_later_stand_later_on_the_axis_of_the_first() {
    let recording = apart(0.25, -0.01);
    assert_eq!(starts(&recording), [-0.01, 0.24]);
    has_note(&recording, "all have the axis of g.a, which starts first (g.b +250.000 ms)");
    // The second starts first: its axis counts, whatever the offset of the other.
    assert_eq!(starts(&apart(-0.125, 0.0)), [0.115, 0.0]);
    // Start time and offset together are the start.
    assert_eq!(starts(&apart(0.25, -0.5)), [-0.26, -0.5]);
    // One instant: the offsets are those of one trigger.
    assert_eq!(starts(&apart(0.0, 0.02)), [-0.01, 0.02]);
}

#[test]
fn channels_of_different_events_keep_their_axes() {
    let recording = apart(3600.0, -0.01);
    assert_eq!(starts(&recording), [-0.01, -0.01]);
    has_note(&recording, "up to 3600.000 s apart: they are not of one event");
}

#[test]
fn groups_with_stamps_of_their_own_have_one_axis() {
    let mut metadata = Writer::new(false);
    for group in ["a", "b"] {
        metadata.object(&format!("/'{group}'/'stamp'"), Some((0x44, 60)), &[]);
        metadata.object(&format!("/'{group}'/'acc (g)'"), Some((10, 60)), &[]);
    }
    let mut raw = Writer::new(false);
    for first_ms in [970, 1020] {
        for k in 0..60_u64 {
            let (ms, seconds) = ((first_ms + k) % 1000, 3_600_000_000 + (first_ms + k) / 1000);
            raw.u64((ms as f64 * 1e-3 * 2_f64.powi(64)) as u64).u64(seconds);
        }
        raw.doubles((0..60).map(pulse));
    }
    let recording = read(segment(NEW_LIST | RAW, 4, &metadata, &raw.bytes)).unwrap();
    assert_eq!(starts(&recording), [0.0, 0.05]);
}

/// An accelerometer with a sampling interval of `increment`, and a channel of times where it has a name.
fn with_increment(increment: f64, times: &str, settings: &IngestSettings) -> Result<Recording, IngestError> {
    let properties = [("wf_increment", Value::Double(increment)), ("unit_string", Value::Text("g"))];
    let mut metadata = Writer::new(false);
    metadata.object(&format!("/'g'/'{times}'"), Some((10, 60)), &[]).object("/'g'/'acc'", Some((10, 60)), &properties);
    let mut raw = Writer::new(false);
    raw.doubles((0..60).map(|k| f64::from(k) * 2.5e-4)).doubles((0..60).map(pulse));
    read_with(segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes), settings)
}

fn grid(recording: &Recording, id: &str) -> (f64, f64) {
    let wave = recording.channels.iter().find(|read| read.channel.id == id).unwrap().wave.as_ref().unwrap();
    (wave.t0_s(), wave.dt_s())
}

#[test]
fn a_channel_of_times_beats_an_increment() {
    let default = IngestSettings::default();
    for (increment, words) in
        [(1.0, "an interval that no crash is recorded at"), (1e-3, "the channel of times is used")]
    {
        let recording = with_increment(increment, "Time (s)", &default).unwrap();
        assert_eq!(grid(&recording, "g.acc"), (0.0, 2.5e-4), "{increment}");
        has_note(&recording, words);
    }
}

#[test]
fn an_interval_of_a_second_is_asked_about() {
    let wanted = IngestSettings { channel: Some("g.acc".to_owned()), ..IngestSettings::default() };
    let error = with_increment(1.0, "other (V)", &wanted).unwrap_err();
    assert!(error.to_string().contains("a sampling interval of 1 s and no channel of times"), "{error}");
    assert_eq!(error.hint(), "state the sampling interval, such as --sample-time 100us");
    let stated = IngestSettings { sample_time: Some("250us".parse().unwrap()), ..wanted.clone() };
    assert_eq!(grid(&with_increment(1.0, "other (V)", &stated).unwrap(), "g.acc"), (0.0, 2.5e-4));
    // The unit of the increment may be another one.
    let stated = IngestSettings { time_unit: Some("ms".to_owned()), ..wanted };
    assert_eq!(grid(&with_increment(1.0, "other (V)", &stated).unwrap(), "g.acc"), (0.0, 1e-3));
    // What is no crash may be that slow.
    assert_eq!(grid(&with_increment(1.0, "other (V)", &lenient()).unwrap(), "g.acc"), (0.0, 1.0));
}
