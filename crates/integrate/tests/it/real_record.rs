//! The four rear-seat crossmember channels of a real frontal barrier test, NHTSA 10146.

use crumple_metrics::crash_events;
use crumple_signal::{IntegrationRule, IntegrationSettings, IntegrationStart, Signal, integrate};
use crumple_testkit::reference_signals::two_columns;

const V0_M_PER_S: f64 = 57.09 / 3.6;

/// Channel, lowest velocity km/h and its time ms, crush mm and its time ms: a separate script of whoever published
/// the record, on unfiltered data from time zero, zero level from before -5 ms.
const PUBLISHED: [(&str, f64, f64, f64, f64); 4] = [
    ("093", -9.10, 113.1, 750.0, 74.1),
    ("094", -9.88, 113.5, 741.0, 73.6),
    ("099", -10.38, 113.2, 733.0, 72.4),
    ("100", -9.66, 114.0, 740.0, 73.7),
];

#[test]
fn crush_and_rebound_are_those_published_with_the_record() {
    for (channel, v_min_km_per_h, t_s_ms, crush_mm, t_m_ms) in PUBLISHED {
        let Some(path) = crumple_testkit::shared(&format!("data/nhtsa-v10146-camry-frontal/v10146.{channel}")) else {
            return;
        };
        let record = two_columns(&path, '\t');
        let before = record.index_at_or_after(-0.005);
        let zero = record.samples()[..before].iter().sum::<f64>() / before as f64;
        let a = Signal::new(record.t0_s(), record.dt_s(), record.samples().iter().map(|a| a - zero).collect()).unwrap();
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::Auto,
            time_zero_s: 0.0,
            impact_speed_m_per_s: V0_M_PER_S,
            low_pass_filtered: false,
        };
        let motion = integrate(&a, &settings).unwrap();
        let events = crash_events(&motion.velocity, &motion.displacement, 0.0).unwrap();
        let (crush, rebound) = (events.crush.unwrap(), events.rebound.unwrap());
        assert!((0.730..=0.755).contains(&crush.displacement_m), "{channel}: {crush:?}");
        // The published figures are rounded to 1 mm, 0.01 km/h and 0.1 ms; allowed is one unit of that.
        let near = |what: &str, found: f64, published: f64, unit: f64| {
            assert!((found - published).abs() <= unit, "{channel} {what}: {found}, published {published}");
        };
        near("crush, mm", 1e3 * crush.displacement_m, crush_mm, 1.0);
        near("its time, ms", 1e3 * crush.time_s, t_m_ms, 0.1);
        near("lowest velocity, km/h", 3.6 * rebound.velocity_m_per_s, v_min_km_per_h, 0.01);
        near("its time, ms", 1e3 * rebound.time_s, t_s_ms, 0.1);
        near("delta-v, km/h", 3.6 * events.delta_v_m_per_s(V0_M_PER_S).unwrap(), 57.09 - v_min_km_per_h, 0.01);

        // The same from the record's start: the zero level acts 50 ms longer, nothing else changes.
        let early = integrate(&a, &IntegrationSettings { start: IntegrationStart::RecordStart, ..settings }).unwrap();
        let crush_early = crash_events(&early.velocity, &early.displacement, 0.0).unwrap().crush.unwrap();
        println!(
            "{channel}: {:+.3} mm from the record's start",
            1e3 * (crush_early.displacement_m - crush.displacement_m)
        );
        assert!((crush_early.displacement_m - crush.displacement_m).abs() < 1e-3, "{channel}: {crush_early:?}");
    }
}
