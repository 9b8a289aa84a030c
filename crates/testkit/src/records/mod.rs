//! Records and artifacts that tests read: fixtures, records of known parameters, reference signals, outputs of stages
//! made directly; and how a laboratory measures the motions of made cars.

use std::error::Error;
use std::path::{Path, PathBuf};

use crumple_artifact::records::{EventsV1, TestV1};
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{CrushEvents, Model, Nonlinear2};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

pub use crate::records::camry::write_camry_with_load_cells;
pub(crate) use crate::records::half_sine::{HALF_SINE_SPEED, half_sine, table, test_of_half_sine, two_sensors};
pub use crate::records::known_truth::{
    KnownTruth, TwoVehicles, known_truth, known_truths, known_truths_in, other_records, write_known_truth,
};
pub use crate::records::measurement::Errors;
pub(crate) use crate::records::measurement::{FINE_S, LowPass, Measurement, Ring};

mod camry;
pub mod fixture;
mod half_sine;
pub mod identification;
pub mod kinds;
mod known_truth;
mod measurement;
pub mod reference_signals;
pub mod simulated;

/// Writes `2-filter.mcap` of this test, its first channel the pulse: all channels are listed, those with samples have
/// them.
///
/// # Errors
/// A file that cannot be written, two channels of one id.
pub fn write_filtered(
    folder: &Path,
    test: TestDescription,
    channels: &[(Channel, Option<Sampled>)],
) -> Result<PathBuf, Box<dyn Error>> {
    let test = TestDescription {
        pulse: channels.first().map(|(channel, _)| channel.id.clone()),
        channels: channels.iter().map(|(channel, _)| channel.clone()).collect(),
        ..test
    };
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test))?;
    for (channel, samples) in channels {
        if let Some(samples) = samples {
            builder.wave(&channel.id, channel.quantity, samples.clone())?;
        }
    }
    let path = folder.join("2-filter.mcap");
    builder.write(&path, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None)?;
    Ok(path)
}

/// Speed of the impact, m/s.
pub const IMPACT_SPEED_M_PER_S: f64 = 9.7;

/// Test of a car of this mass, these events, where it does not stop the end of the event, and the displacement of
/// channel `a` over 150 ms at 10 kHz from contact on.
///
/// # Errors
/// A model without a motion.
pub fn integrated(
    model: &Model,
    mass_kg: Option<f64>,
    events: &CrushEvents,
    end_of_event_s: Option<f64>,
) -> Result<ArtifactBuilder, Box<dyn Error>> {
    let mut builder = ArtifactBuilder::new();
    let test = TestDescription {
        title: "a car".to_owned(),
        mass_kg,
        impact_speed_m_per_s: Some(IMPACT_SPEED_M_PER_S),
        channels: vec![Channel::new("a", QuantityKind::Acceleration)],
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test))?;
    let crash = EventsV1 {
        channel: "a".to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        impact_speed_m_per_s: Some(IMPACT_SPEED_M_PER_S),
        end_of_event_s,
        end_of_event_rule: end_of_event_s.map(|_| "end of the record".to_owned()),
        ..EventsV1::default()
    };
    builder.put("/events", &crash)?;
    let motion = model.respond(IMPACT_SPEED_M_PER_S, 1e-4, 1501)?;
    let displacement = Sampled::new(0.0, 1e-4, motion.compartment().displacement_m.clone())?;
    builder.wave("a/displacement", QuantityKind::Displacement, displacement)?;
    Ok(builder)
}

/// Table 5 of the single-mass paper: 873 kg, crush and impact speed of its test.
pub fn table_5() -> Nonlinear2 {
    Nonlinear2 {
        mass_kg: 873.0,
        k1_n_per_m: 82_357.0,
        k2_n_per_m: 4.0,
        k3_n_per_m: 197_519.0,
        x1_m: 0.472,
        c1_n_s_per_m: 86_585.0,
        c2_n_s_per_m: 80_056.0,
        c3_n_s_per_m: 18_721.0,
        c4_n_s_per_m: 81.0,
        v1_m_per_s: 2.55,
        v2_m_per_s: 7.23,
        crush_m: 0.5063,
        v0_m_per_s: 9.7222,
    }
}
