//! The sample's test, events and metrics.

use crumple_artifact::records::{ChannelFilterV1, EventIntervalV1, EventsV1, MetricV1, MetricsV2};
use crumple_signal::{Channel, ChannelStatus, QuantityKind, Source, TestDescription};

use super::TITLE;
use super::kelvin::TEST;

pub(super) fn test() -> TestDescription {
    let mut channels: Vec<Channel> = (1..=30)
        .map(|k| Channel { location: format!("sled <{k}>"), ..Channel::new(format!("ch{k}"), QuantityKind::Force) })
        .collect();
    channels.insert(
        3,
        Channel {
            location: "rear seat crossmember, left".to_owned(),
            axis: Some(crumple_signal::Axis::X),
            cfc: Some(60),
            ..Channel::new("accel", QuantityKind::Acceleration)
        },
    );
    channels[9].status = ChannelStatus::NotInstalled;
    TestDescription {
        title: TITLE.to_owned(),
        vehicle: Some("Synthetic hatchback".to_owned()),
        mass_kg: Some(TEST.mass_kg),
        impact_speed_m_per_s: Some(TEST.v0),
        barrier: Some("rigid wall, full width".to_owned()),
        source: Source {
            format: "csv".to_owned(),
            name: "crash.csv".to_owned(),
            digest: "blake3:00112233445566778899aabbccddeeff".to_owned(),
        },
        channels,
        pulse: Some("accel".to_owned()),
        notes: vec!["the time column has 4 decimals".to_owned()],
        contact: None,
        exchange_asked: false,
        kind: None,
        overlap: None,
    }
}

pub(super) fn events() -> EventsV1 {
    let t_m = TEST.time_of_crush();
    let crush = TEST.at(t_m)[0];
    let t_s = 2.0 * t_m;
    let rebound = TEST.at(t_s)[1];
    EventsV1 {
        channel: "accel".to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: Some(crush),
        time_of_dynamic_crush_s: Some(t_m),
        centroid_time_s: Some(crush / TEST.v0),
        rebound_velocity_m_per_s: Some(rebound),
        coefficient_of_restitution: Some(-rebound / TEST.v0),
        delta_v_m_per_s: Some(TEST.v0 - rebound),
        time_of_rebound_s: Some(t_s),
        impact_speed_m_per_s: Some(TEST.v0),
        rule: Some("trapezoid".to_owned()),
        start: Some("record-start".to_owned()),
        intervals: vec![EventIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            low: crush - 0.008,
            high: crush + 0.008,
            interval_by: "5-95 % of 400 replicates".to_owned(),
            interval_source: None,
        }],
        ..EventsV1::default()
    }
}

pub(super) fn metrics() -> MetricsV2 {
    let metric = |name: &str, value, unit: &str, definition: &str| MetricV1 {
        name: name.to_owned(),
        value,
        unit: unit.to_owned(),
        channel: "accel".to_owned(),
        definition: definition.to_owned(),
        definition_id: Some(name.replace('_', "-")),
        ..MetricV1::default()
    };
    MetricsV2 {
        metrics: vec![
            metric("peak_acceleration", Some(-191.5), "m/s^2", "largest |a|"),
            metric("time_of_peak_acceleration", Some(0.0612), "s", "time of it"),
            metric("equivalent_square_wave", Some(98.7), "m/s^2", "v0^2/(2C)"),
            metric("average_stiffness", Some(297_700.0), "N/m", "m*v0^2/C^2"),
            metric("energy_absorbed", Some(33_214.0), "J", "m*(v0^2 - v_s^2)/2"),
            metric("olc", None, "m/s^2", "not reached: the restraint travel of 235 mm is not used up"),
        ],
    }
}

pub(super) fn channel_filter() -> ChannelFilterV1 {
    ChannelFilterV1 {
        cfc: Some(60),
        mode: "iso6487".to_owned(),
        frequency_factor: Some(2.0775),
        samples_added: 100,
        coefficients: vec![0.1, 0.2, 0.1, 1.2, -0.6],
        gain_at_class_db: Some(-0.45),
        zero_level_removed: 0.0,
        notes: vec!["samples added by point reflection at both ends".to_owned()],
        corridor: vec![],
        corridor_ok: None,
        cutoff_hz: vec![],
        phase: Some("zero".to_owned()),
        width_s: None,
        resampled_to_hz: None,
        shift_s: None,
    }
}
