//! The real files.

use crumple_ingest::{Bundle, IngestSettings};
use crumple_signal::{QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G};
use crumple_testkit::shared;

use crate::tdms::writer::{lenient, open, recording, samples};

/// Acceptance 6: wf_* time, unit from the name, 24 trailing NaN, and the velocity channel as the oracle of integration.
#[test]
fn the_target_pulse_integrates_to_its_own_velocity_channel() {
    let Some(ingested) = open("data/iihs-diadem-tdms/Target Pulse.tdms", &lenient()) else { return };
    let ingested = ingested.unwrap();
    let pulse = ingested.pulse().unwrap();
    assert_eq!(pulse.id, "IIWPG_Target_Pulse.IIWPG_Acceleration");
    assert_eq!((pulse.samples.len(), pulse.samples.t0_s(), pulse.samples.dt_s()), (92, 0.0, 1e-3));
    assert_eq!(pulse.quantity, QuantityKind::Acceleration);
    let notes = ingested.notes.to_texts();
    assert!(notes.iter().any(|n| n.starts_with("warning: 24 missing samples (NaN)")), "{notes:#?}");
    assert_eq!(ingested.waves.len(), 3, "the time channel is no wave");

    let a = pulse.samples.samples();
    let mut v = 0.0;
    let mut velocity = vec![0.0];
    for pair in a.windows(2) {
        v += 0.5 * (pair[0] + pair[1]) * pulse.samples.dt_s();
        velocity.push(v);
    }
    // Printed with the record; 1e-12 is some thousand roundings of 4 m/s.
    assert!((velocity[91] - 4.344_990_423_424_699).abs() < 1e-12, "{}", velocity[91]);
    let delta_v = ingested.waves.iter().find(|w| w.id.ends_with(".IIWPG_DeltaV")).unwrap();
    assert_eq!((delta_v.quantity, delta_v.samples.len()), (QuantityKind::Velocity, 92));
    for (ours, theirs) in velocity.iter().zip(delta_v.samples.samples()) {
        assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
    }
    let in_km_per_h = ingested.waves.iter().find(|w| w.id.ends_with(".IIWPG_Delta_V")).unwrap();
    // 15.641965524328903 km/h.
    assert!((in_km_per_h.samples.samples()[91] * 3.6 - 15.641_965_524_328_903).abs() < 1e-12);
    // 10.022165 g at 27 ms, to the digits printed.
    assert!((a[27] / G - 10.022_165).abs() < 1e-6 && a.iter().all(|x| *x <= a[27]));
}

/// Acceptance 8, first half.
#[test]
fn big_endian_channels_are_as_long_as_their_data() {
    let Some(recording) = recording("data/nptdms-fixtures/big_endian.tdms") else { return };
    assert_eq!(recording.channels.len(), 2);
    for found in &recording.channels {
        let wave = found.wave.as_ref().unwrap();
        assert_eq!((wave.len(), wave.dt_s()), (3500, 1e-3));
    }
    // By an independent script: samples 0, 1, 500 (the first of the second segment) and 3499.
    for (found, expected) in recording.channels.iter().zip([
        [0.0, 0.0, 0.309_016_994_374_943_7, 5.067_986_572_324_634],
        [0.0, 0.063_417_585_781_325_2, 0.309_016_994_374_943_7, 0.844_664_428_720_772_3],
    ]) {
        assert_eq!([0, 1, 500, 3499].map(|k| samples(found)[k]), expected);
    }
    assert_eq!(recording.details.title.unwrap().value, "LabVIEW Example (time domain)");
}

/// Acceptance 8, second half.
#[test]
fn daqmx_raw_data_are_read_as_volts() {
    let Some(recording) = recording("data/nptdms-fixtures/raw1.tdms") else { return };
    assert_eq!(recording.channels.len(), 7);
    for found in &recording.channels {
        let wave = found.wave.as_ref().unwrap();
        assert_eq!((wave.len(), wave.dt_s()), (2000, 1.999_999_999_999_999_8e-5));
        assert_eq!(found.channel.quantity, QuantityKind::Voltage);
    }
    // By an independent script, from the 16-bit values, slope 0.0003051850947599719 and intercept 0: samples 0, 1,
    // 1999.
    for (k, expected) in [
        (0, [-0.184_026_612_140_263_06, 0.148_014_770_958_586_4, 0.000_915_555_284_279_915_8]),
        (6, [5.043_183_690_908_536, 4.558_549_760_429_701, 5.074_922_940_763_573]),
    ] {
        assert_eq!([0, 1, 1999].map(|n| samples(&recording.channels[k])[n]), expected);
    }
}

#[test]
fn without_an_acceleration_the_channels_are_there_and_no_pulse_is_guessed() {
    let Some(result) = open("data/nptdms-fixtures/raw1.tdms", &IngestSettings::default()) else { return };
    let error = result.unwrap_err();
    assert!(error.to_string().starts_with("raw1.tdms: no acceleration"), "{error}");
}

#[test]
fn the_index_file_is_refused_by_name() {
    let Some(path) = shared("data/iihs-diadem-tdms/Target Pulse.tdms_index") else { return };
    let error = Bundle::open(&path).err().unwrap();
    assert_eq!(error.to_string(), "Target Pulse.tdms_index is a TDMS index file, which is not read");
    assert_eq!(error.hint(), "the samples are in the .tdms file beside it: give that");
}
