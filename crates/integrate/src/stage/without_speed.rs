//! A pulse without an impact speed: its change of velocity, and every metric that needs no more.

use crumple_signal::{Channel, QuantityKind, TestDescription};
use crumple_stage::records::{MetricsV2, TestV1};
use crumple_stage::{Inputs, Outcome, Output};

use crate::stage::criteria::occupants_and_roadside::Criteria;
use crate::stage::options::StageSettings;
use crate::stage::pulse::integration::{ChannelIntegration, acceleration};
use crate::stage::pulse::records::metric_records;
use crate::stage::pulse::summary::warn_unless_of_the_vehicle;
use crate::stage::pulse::time_zero::time_zero;

/// Writes the change of velocity of the pulse, the metrics that need no impact speed, and criteria. The others are
/// absent, with this as their reason. Later stages, whose models start at the impact speed, have nothing to work on.
pub fn without_speed(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    pulse: &Channel,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let samples = acceleration(input, pulse)?;
    let zero = time_zero(settings, input, test, pulse, &samples, 0.0, out.notes())?;
    let task = ChannelIntegration { settings, input, test, impact_speed_m_per_s: None, time_zero_s: zero.time_s };
    let integrated = task.integrate(pulse, &samples, out)?;
    warn_unless_of_the_vehicle(pulse, out.notes());
    let mut metrics = metric_records(&pulse.id, &integrated, zero.time_s);
    let criteria = Criteria { settings, input, test, pulse, time_zero_s: zero.time_s, impact_speed_m_per_s: None };
    metrics.extend(criteria.records(out)?);

    let delta_v = metrics.iter().find(|metric| metric.name == "delta_v");
    let delta_v = delta_v.and_then(|metric| Some((metric.value?, metric.to_s?)));
    let change = delta_v.map_or_else(String::new, |(value, time_s)| {
        format!(": change of velocity {value:.3} m/s at {:.1} ms", 1e3 * time_s)
    });
    out.summary(format!("pulse {}{change}; no impact speed is stated", pulse.id));
    // A vehicle pushed forward starts from rest: nobody has an impact speed to give.
    let is_pushed = integrated.events.end_velocity_m_per_s > 0.0;
    let reason = if is_pushed {
        "the pulse pushes the vehicle forward and no impact speed is stated: a motion from rest has no crush, and no \
         model \
         of one"
    } else {
        "no impact speed is stated, so there is no crush and no model of it: --impact-speed 35km/h here or at \
         crumple-ingest"
    };
    out.put("/test", &TestV1::from(test))?;
    out.put("/metrics", &MetricsV2 { metrics })?;
    let change = integrated.motion.velocity.into_sampled();
    out.wave(&format!("{}/velocity_change", pulse.id), QuantityKind::VelocityChange, change)?;
    out.nothing_for_later_stages(reason);
    Ok(Outcome::Done)
}
