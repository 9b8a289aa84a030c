//! Where the time comes from: steps, a sibling channel, times of the day.

use crumple_ingest::IngestSettings;

use crate::writer::{
    BIG, NEW_LIST, RAW, Value, Writer, accelerometer, has_note, pulse, read, read_with, samples, segment,
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

#[test]
fn different_start_times_are_told_and_not_aligned() {
    let mut metadata = Writer::new(false);
    for (path, start) in [("/'g'/'a'", 3.6e9), ("/'g'/'b'", 3.6e9 + 0.25)] {
        let mut properties = accelerometer();
        properties.push(("wf_start_time", Value::Time(start)));
        metadata.object(path, Some((10, 60)), &properties);
    }
    let mut raw = Writer::new(false);
    raw.doubles([0.5; 120]);
    let recording = read(segment(NEW_LIST | RAW, 2, &metadata, &raw.bytes)).unwrap();
    has_note(&recording, "channels start at times of the day up to 0.250000 s apart");
}
