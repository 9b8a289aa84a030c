//! What integration writes for a model that meets a barrier, as far as later stages read it.

use std::error::Error;

use crumple_artifact::ArtifactBuilder;
use crumple_artifact::records::{EventsV1, TestV1};
use crumple_lumped::{CrushEvents, Model};
use crumple_signal::{Channel, QuantityKind, Sampled, TestDescription};

/// Speed of the impact, m/s.
pub const IMPACT_SPEED_M_PER_S: f64 = 9.7;

/// Test of a car of this mass, these events, where it does not stop the end of the event, and the displacement of
/// channel `a` over 100 ms at 10 kHz from contact on.
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
    let motion = model.respond(IMPACT_SPEED_M_PER_S, 1e-4, 1001)?;
    let displacement = Sampled::new(0.0, 1e-4, motion.compartment().displacement_m.clone())?;
    builder.wave("a/displacement", QuantityKind::Displacement, displacement)?;
    Ok(builder)
}
