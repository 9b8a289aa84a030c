//! What records say of themselves: how sure a parameter is, when contact ends, what a test description must hold.

use crumple_artifact::records::{
    CandidateV1, Certainty, ConcernV1, ConcernsV1, ConcernsV2, Doubt, EventsV1, MetricsV1, MetricsV2, ModesV1, ModesV2,
    TestV1,
};
use crumple_artifact::{ArtifactBuilder, Codec, Compression, Provenance, Record};
use crumple_signal::{QuantityKind, Sampled, TestDescription};
use serde_json::{Value, json};

/// A candidate of one parameter `k`, with what is known of it.
fn candidate(k: f64, deviation: Option<f64>, interval: Option<[Option<f64>; 2]>, on_bound: bool) -> CandidateV1 {
    let ends = |end: usize| interval.map_or(json!({}), |ends| json!({ "k": ends[end] }));
    let bounds = if on_bound { vec!["k"] } else { Vec::new() };
    serde_json::from_value(json!({
        "model": "kelvin", "method": "fit", "physical": true,
        "parameters": {"k": k, "m": 900.0},
        "fit": {"channel": "93", "quantity": "displacement", "from_s": 0.0, "to_s": 0.1, "samples": 10, "rmse": 0.0,
                "iterations": 1, "evaluations": 1, "stop_reason": "", "active_bounds": bounds},
        "uncertainty": {"method": "linearised", "standard_deviation": deviation.map_or(json!({}), |d| json!({"k": d})),
                        "condition": null, "interval_low": ends(0), "interval_high": ends(1)},
    }))
    .unwrap()
}

#[test]
fn a_parameter_is_open_known_to_an_order_of_magnitude_or_determined() {
    use Certainty::{Determined, Open, OrderOfMagnitude};
    let closed = |low: f64, high: f64| Some([Some(low), Some(high)]);
    for (k, deviation, interval, on_bound, certainty, doubt) in [
        (5.0, Some(1.0), None, false, Determined, None),
        (5.0, Some(5.0), None, false, Open, Some(Doubt::NotDetermined)),
        (-5.0, Some(5.0), None, false, Open, Some(Doubt::NotDetermined)),
        (0.0, Some(5.0), None, false, Determined, None),
        (5.0, None, Some([None, None]), false, Open, Some(Doubt::NotDetermined)),
        (5.0, None, Some([None, Some(6.0)]), false, OrderOfMagnitude, None),
        (5.0, None, closed(1.0, 10.0), false, Determined, None),
        (5.0, None, closed(1.0, 10.5), false, OrderOfMagnitude, None),
        (-5.0, None, closed(-10.5, -1.0), false, OrderOfMagnitude, None),
        (-5.0, None, closed(-9.0, -1.0), false, Determined, None),
        (5.0, None, closed(-1.0, 100.0), false, Determined, None),
        (5.0, None, closed(0.0, 100.0), false, Determined, None),
        (5.0, Some(1.0), None, true, Open, Some(Doubt::OnBound)),
        (0.0, Some(1.0), None, true, Determined, None),
    ] {
        let candidate = candidate(k, deviation, interval, on_bound);
        let of = format!("{k} {deviation:?} {interval:?} {on_bound}");
        assert_eq!(candidate.certainty("k"), Some(certainty), "{of}");
        assert_eq!(candidate.doubt("k"), doubt, "{of}");
        assert_eq!(candidate.undetermined(), if certainty == Open { vec!["k"] } else { vec![] }, "{of}");
        for each in [Open, OrderOfMagnitude, Determined] {
            assert_eq!(candidate.parameters_of(each), if each == certainty { vec!["k"] } else { vec![] }, "{of}");
        }
        assert_eq!((candidate.certainty("m"), candidate.certainty("none")), (None, None), "given, or not there");
    }
}

#[test]
fn a_zero_is_determined_where_all_that_it_may_be_is_small() {
    // Of 900 kg within 0.1 s: 9 kN·s/m and 90 kN/m.
    let certainty = |name: &str, high: Option<f64>| {
        let text = serde_json::to_string(&candidate(0.0, None, Some([Some(0.0), high]), true)).unwrap();
        let text = text.replace("\"k\"", &format!("\"{name}\"")).replace("\"m\"", "\"mass_kg\"");
        serde_json::from_str::<CandidateV1>(&text).unwrap().certainty(name)
    };
    for (name, high, expected) in [
        ("c_n_s_per_m", Some(899.0), Certainty::Determined),
        ("c_n_s_per_m", Some(901.0), Certainty::OrderOfMagnitude),
        ("c_n_s_per_m", None, Certainty::OrderOfMagnitude),
        ("k_n_per_m", Some(8_999.0), Certainty::Determined),
        ("k_n_per_m", Some(9_001.0), Certainty::OrderOfMagnitude),
        ("knot_1_n", Some(1.0), Certainty::OrderOfMagnitude),
    ] {
        assert_eq!(certainty(name, high), Some(expected), "{name} {high:?}");
    }
}

#[test]
fn contact_ends_at_the_rebound_else_at_the_largest_change_of_velocity_else_with_the_record() {
    let events = |rebound: Option<f64>, delta_v: Option<f64>| -> EventsV1 {
        serde_json::from_value(json!({"channel": "93", "time_zero_s": 0.0, "time_zero_rule": "file",
            "time_of_rebound_s": rebound, "time_of_delta_v_s": delta_v}))
        .unwrap()
    };
    assert_eq!(events(Some(0.5), Some(0.625)).end_of_contact_s(2.0), 0.5);
    assert_eq!(events(None, Some(0.625)).end_of_contact_s(2.0), 0.625);
    assert_eq!(events(None, None).end_of_contact_s(2.0), 2.0);
    assert_eq!(events(Some(3.0), None).end_of_contact_s(2.0), 2.0, "not beyond the record");
}

#[test]
fn a_test_description_is_read_back_and_refused_where_channels_contradict_themselves() {
    let channel = |id: &str, quantity: &str, unit: &str| {
        json!({
            "id": id, "location": "sill", "axis": "x", "quantity": quantity, "unit": unit, "status": "valid",
        })
    };
    let described = |channels: Vec<Value>| -> Result<TestDescription, String> {
        let source = json!({"format": "csv", "name": "crash.csv", "digest": "blake3:00"});
        let test = json!({"title": "a test", "mass_kg": 900.0, "source": source, "channels": channels});
        let test: TestV1 = serde_json::from_value(test).unwrap();
        TestDescription::try_from(test).map_err(|error| error.to_string())
    };
    let test = described(vec![channel("1", "acceleration", "m/s^2"), channel("2", "other", "furlong")]).unwrap();
    assert_eq!((test.title.as_str(), test.mass_kg, test.channels.len()), ("a test", Some(900.0), 2));
    assert_eq!(test.channels[0].quantity, QuantityKind::Acceleration);
    let in_g = described(vec![channel("1", "acceleration", "g")]).unwrap_err();
    assert_eq!(in_g, "channel \"1\": unit is \"g\", but acceleration is stored in \"m/s^2\"");
    let twice = described(vec![channel("1", "acceleration", "m/s^2"), channel("1", "velocity", "m/s")]).unwrap_err();
    assert_eq!(twice, "channel \"1\" is listed twice");
}

#[test]
fn lists_of_the_version_before_keep_their_entries() {
    let concerns = ConcernsV1(vec![ConcernV1 { text: "a".to_owned(), ..ConcernV1::default() }]);
    let mode = json!({"re_per_s": -3.0, "im_rad_per_s": 4.0, "natural_frequency_rad_per_s": 5.0});
    let modes: ModesV1 = serde_json::from_value(json!([mode])).unwrap();
    for codec in [Codec::Json, Codec::Bincode] {
        let read = ConcernsV2::decode_earlier(codec, &codec.encode(&concerns).unwrap()).unwrap();
        assert_eq!(read.concerns, concerns.0);
        let read = ModesV2::decode_earlier(codec, &codec.encode(&modes).unwrap()).unwrap();
        assert_eq!(read.modes, modes.0);
    }
    let metric = json!({"name": "olc", "value": 1.5, "unit": "m/s^2", "channel": "93", "definition": "", "low": 2.0,
        "high": 1.0});
    let metrics: MetricsV1 = serde_json::from_value(json!([metric])).unwrap();
    let falls = MetricsV2::decode_earlier(Codec::Json, &Codec::Json.encode(&metrics).unwrap()).unwrap_err();
    assert_eq!(falls, "the interval of olc has its low end, 2, above its high end, 1");
}

/// The digest that writing returns is that of the file; every sample is reported once.
#[test]
fn writing_returns_the_digest_and_reports_every_sample() {
    let mut builder = ArtifactBuilder::new();
    for (id, count) in [("a", 70_000), ("b", 3)] {
        let samples = (0..count).map(f64::from).collect();
        builder.wave(id, QuantityKind::Velocity, Sampled::new(0.0, 1e-4, samples).unwrap()).unwrap();
    }
    assert_eq!(builder.samples(), 70_003);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/x.mcap");
    let mut reported = 0;
    let provenance = Provenance::new("filter", "0.1.0", "{}".into(), Vec::new());
    let count = &mut |samples| reported += samples;
    let digest = builder.write_replacing(&path, &[], &provenance, Compression::None, count).unwrap();
    assert_eq!(reported, 70_003);
    let read = crumple_artifact::Artifact::open(&path).unwrap();
    assert_eq!(read.digest(), digest);
    assert_eq!(builder.digest().unwrap(), digest);
    assert_eq!(builder.write(&path, &provenance, Compression::Zstd).unwrap(), digest);
    assert_eq!(read.waves()["a"].sampled.samples()[69_999], 69_999.0);
}
