//! The impact speed of a test.

use crumple_signal::{About, Channel, Notes, TestDescription, Weight};
use crumple_stage::Refused;

use crate::stage::options::StageSettings;

/// Impact speeds of test and channel that differ by more than this get a warning, m/s.
const SPEED_GAP_M_PER_S: f64 = 0.05;

/// The speed of the flag, else of the test; never the channel's own, which is only held against it.
pub fn impact_speed(
    settings: &StageSettings,
    test: &TestDescription,
    channel: &Channel,
    notes: &mut Notes,
) -> anyhow::Result<f64> {
    let speed = settings.impact_speed_m_per_s.or(test.impact_speed_m_per_s).ok_or_else(|| {
        Refused::new("the test description has no impact speed")
            .expected("the speed just before contact; the accelerometer cannot tell it")
            .hint("give it with --impact-speed, e.g. --impact-speed 35km/h, here or to ingest")
    })?;
    if let (Some(_), Some(of_test)) = (settings.impact_speed_m_per_s, test.impact_speed_m_per_s)
        && of_test != speed
    {
        notes.info(format!("impact speed {speed} m/s as asked for, the test description says {of_test} m/s"));
    }
    if let Some(of_channel) = channel.initial_velocity_m_per_s
        && (of_channel.abs() - speed).abs() > SPEED_GAP_M_PER_S
    {
        notes.concern(
            About::ImpactSpeed,
            Weight::Marked,
            format!(
                "channel {} states an initial velocity of {of_channel:.3} m/s, the impact speed is {speed:.3} m/s",
                channel.id
            ),
        );
    }
    Ok(speed)
}
