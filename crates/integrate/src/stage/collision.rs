//! The other vehicle of a test with two: its own motion, and what both say of their collision.

use crumple_metrics::definitions::{
    COMMON_VELOCITY, COMMON_VELOCITY_BY_MOMENTUM, MOMENTUM_GAP, RELATIVE_CRUSH, RESTITUTION_TWO, STROKE,
    TIME_OF_COMMON_VELOCITY,
};
use crumple_metrics::{Metric, TwoVehicleImpact, collision, common_velocity};
use crumple_signal::{Channel, IntegrationRule, QuantityKind, Sampled, TestDescription, integrate_twice, part_of};
use crumple_stage::records::{ImpactsV1, MetricV1, MetricsV2, TestV1, VehicleV1, VehiclesV1};
use crumple_stage::{Inputs, Outcome, Output};

use crate::stage::criteria::{recorded_changes, recorded_impacts};
use crate::stage::integration::{ChannelIntegration, Integrated, acceleration};
use crate::stage::occupants_and_roadside::Criteria;
use crate::stage::options::StageSettings;
use crate::stage::records::{impact_records, metric_record, metric_records, note_impacts, warn_unless_of_the_vehicle};

/// Momentum left over that is worth a warning: sensors and masses are better than that.
const LARGE_GAP: f64 = 0.1;

/// The vehicles of the test, if it has several.
pub fn vehicles(input: &Inputs) -> anyhow::Result<Vec<VehicleV1>> {
    Ok(input.record_if::<VehiclesV1>("/vehicles")?.map_or_else(Vec::new, |record| record.vehicles))
}

/// The vehicle that carries a channel.
fn carrier<'a>(vehicles: &'a [VehicleV1], id: &str) -> Option<&'a VehicleV1> {
    vehicles.iter().find(|vehicle| vehicle.channels.iter().any(|channel| channel == id))
}

/// The test with the channels of the vehicle that carries the pulse, and those of none: sensors of another vehicle have
/// another speed and another mass.
pub fn of_one_vehicle(test: &TestDescription, vehicles: &[VehicleV1], pulse: &str) -> TestDescription {
    let number = |channel: &Channel| match carrier(vehicles, &channel.id) {
        Some(vehicle) => Some(vehicle.number),
        // The test object of an ISO 13499 code.
        None => channel.code.as_deref()?.chars().next()?.to_digit(10).filter(|object| *object > 0),
    };
    let Some(own) = test.channel(pulse).and_then(number) else { return test.clone() };
    let is_here = |channel: &Channel| number(channel).is_none_or(|other| other == own);
    let channels = test.channels.iter().filter(|channel| is_here(channel)).cloned().collect();
    TestDescription { channels, ..test.clone() }
}

/// Integrates the pulse of the other vehicle with its own speed and mass; returns its metrics and those of the
/// collision. Its velocity is written, no displacement: that of a sensor would be compared with the models.
pub fn other_vehicle(
    task: &ChannelIntegration<'_>,
    vehicles: &[VehicleV1],
    pulse: &Channel,
    integrated: &Integrated,
    out: &mut Output,
) -> anyhow::Result<Vec<MetricV1>> {
    let Some(own) = carrier(vehicles, &pulse.id) else { return Ok(Vec::new()) };
    let Some(other) = vehicles.iter().find(|vehicle| vehicle.number != own.number) else { return Ok(Vec::new()) };
    let number = other.number;
    let channel = other.pulse.as_deref().and_then(|id| task.test.channel(id));
    let Some(channel) = channel.filter(|channel| task.input.wave_if(&channel.id).is_some()) else {
        out.notes().info(format!(
            "vehicle {number} has no pulse in the inputs: no relative crush, common velocity and balance of momentum"
        ));
        return Ok(Vec::new());
    };
    let mut described = task.test.clone();
    described.mass_kg = other.mass_kg;
    described.impact_speed_m_per_s = other.impact_speed_m_per_s;
    let its_task = ChannelIntegration { test: &described, impact_speed_m_per_s: other.impact_speed_m_per_s, ..*task };
    let motion = its_task.integrate(channel, &acceleration(task.input, channel)?, out)?;
    let mut metrics = metric_records(&channel.id, &motion);
    let velocity = &motion.motion.velocity;
    let Some(other_speed) = other.impact_speed_m_per_s else {
        out.notes().warning(format!(
            "vehicle {number} states no speed (0 would be one): its velocity is the change of it, and nothing is \
             said of \
             both"
        ));
        out.wave(
            &format!("{}/velocity_change", channel.id),
            QuantityKind::VelocityChange,
            velocity.clone().into_sampled(),
        )?;
        return Ok(metrics);
    };
    match collision(&integrated.motion.velocity, velocity) {
        Some(found) => {
            let masses = own.mass_kg.or(task.test.mass_kg).zip(other.mass_kg);
            let speeds = [task.impact_speed_m_per_s.unwrap_or(0.0), other_speed];
            let ids = [pulse.id.as_str(), channel.id.as_str()];
            say(&found, [own.number, number], masses, speeds, out);
            metrics.extend(collision_metrics(&found, masses, speeds).iter().map(|metric| metric_record(&ids, metric)));
        }
        None => out.notes().warning(format!(
            "the pulses {} and {} of both vehicles show no collision along x (another grid, no change of velocity, or \
             a \
             hit across): nothing is said of both",
            pulse.id, channel.id
        )),
    }
    out.wave(&format!("{}/velocity", channel.id), QuantityKind::Velocity, velocity.clone().into_sampled())?;
    Ok(metrics)
}

/// The metrics of two vehicles, always the same names in the same order.
fn collision_metrics(found: &TwoVehicleImpact, masses: Option<(f64, f64)>, speeds: [f64; 2]) -> Vec<Metric> {
    const APPROACHING: &str = "they still approach each other at the end of the record";
    const NO_MASS: &str = "the mass of a vehicle is not known";
    let sign = if found.same_heading { 1.0 } else { -1.0 };
    let masses = masses.map(|(first, second)| [first, second]);
    let end_s = found.common.map(|common| common.time_s);
    let over = |metric: Metric| end_s.map_or(metric.clone(), |end_s| metric.over(0.0, end_s));
    let by_momentum = masses.map(|masses| common_velocity(masses, [speeds[0], sign * speeds[1]]));
    vec![
        over(Metric::of(&RELATIVE_CRUSH, found.common.map(|c| c.relative_crush_m), APPROACHING)),
        over(Metric::of(&TIME_OF_COMMON_VELOCITY, end_s, APPROACHING)),
        over(Metric::of(&COMMON_VELOCITY, found.common.map(|c| c.velocity_m_per_s), APPROACHING)),
        Metric::of(&COMMON_VELOCITY_BY_MOMENTUM, by_momentum, NO_MASS),
        over(Metric::of(&MOMENTUM_GAP, masses.and_then(|masses| found.momentum_gap(masses)), NO_MASS)),
        Metric::of(&RESTITUTION_TWO, found.restitution, APPROACHING),
    ]
}

/// The collision in words.
fn say(
    found: &TwoVehicleImpact,
    [own, other]: [u32; 2],
    masses: Option<(f64, f64)>,
    speeds: [f64; 2],
    out: &mut Output,
) {
    let heading = if found.same_heading { "the same way" } else { "towards it" };
    let text = match found.common {
        Some(common) => format!(
            "vehicles {own} and {other}: relative crush {:.4} m and common velocity {:.3} m/s at {:.2} ms",
            common.relative_crush_m,
            common.velocity_m_per_s,
            1e3 * common.time_s
        ),
        None => format!("vehicles {own} and {other} still approach each other at the end of the record"),
    };
    out.summary(text);
    out.notes().info(format!(
        "vehicle {other} heads {heading}, as the changes of velocity say: closing speed {:.3} m/s; the velocities \
         along \
         the axis of vehicle {own}",
        found.closing_speed_m_per_s
    ));
    out.notes().info(
        "models of one vehicle at a rigid barrier are fitted to the pulse as if it had met one: their crush and \
         parameters are not those of the vehicle alone",
    );
    let Some((first, second)) = masses else { return };
    let sign = if found.same_heading { 1.0 } else { -1.0 };
    let expected = common_velocity([first, second], [speeds[0], sign * speeds[1]]);
    let Some(gap) = found.momentum_gap([first, second]) else { return };
    let text = format!(
        "momentum: the changes of both vehicles leave {:+.1} % of that of vehicle {own} over; the masses and speeds \
         give a \
         common velocity of {expected:.3} m/s",
        100.0 * gap
    );
    if gap.abs() <= LARGE_GAP {
        out.notes().info(text);
    } else {
        out.notes().warning(format!("{text}: a mass, a speed, a sensor or the direction is not as stated"));
    }
}

/// What a motion of the pulse lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// The impact speed.
    Speed,
    /// The samples of the pulse, while an occupant's are here.
    Pulse,
}

/// What stands in the way of a motion, if anything does that is no fault of the inputs.
pub fn missing_for_motion(
    input: &Inputs,
    test: &TestDescription,
    pulse: &Channel,
    speed_m_per_s: Option<f64>,
) -> Option<Missing> {
    let occupants = || test.channels.iter().any(|c| part_of(c).is_some() && input.wave_if(&c.id).is_some());
    if input.wave_if(&pulse.id).is_none() && occupants() {
        return Some(Missing::Pulse);
    }
    // A vehicle has a change of velocity without it; an occupant and a recorder say what they can by themselves.
    let is_recorded =
        || test.channels.iter().any(|c| c.quantity == QuantityKind::VelocityChange && input.wave_if(&c.id).is_some());
    (speed_m_per_s.is_none() && (part_of(pulse).is_some() || is_recorded())).then_some(Missing::Speed)
}

/// Writes the test and the criteria. Done where the pulse is an occupant's, or not in the inputs: nobody asked for a
/// motion of the vehicle. A vehicle without impact speed has no acceptable result, whatever else was measured.
pub fn without_motion(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    pulse: &Channel,
    missing: Missing,
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    out.put("/test", &TestV1::from(test))?;
    let impact_speed_m_per_s = None;
    let criteria = Criteria { settings, input, test, pulse, impact_speed_m_per_s };
    let mut metrics = criteria.records(out)?;
    let measured = metrics.iter().any(|metric| metric.value.is_some());
    let recorded = recorded_changes(input, test, out);
    let recorder = recorded.iter().any(|metric| metric.value.is_some());
    if let Some(impacts) = recorded_impacts(input, test, out) {
        out.put("/impacts", &impacts)?;
    }
    metrics.extend(recorded);
    if !metrics.is_empty() {
        out.put("/metrics", &MetricsV2 { metrics })?;
    }
    let id = &pulse.id;
    let state_the_speed = "state the speed just before contact: --impact-speed 35km/h at ingest";
    let (result, reason, remedy) = match missing {
        Missing::Pulse if measured => (
            true,
            format!(
                "criteria of occupants alone: the pulse {id} is not in the inputs, so there is no motion of the vehicle"
            ),
            "the filter without channels takes both".to_owned(),
        ),
        Missing::Pulse => (
            false,
            format!("the pulse {id} is not in the inputs: the channels of the filter leave it out"),
            format!("name {id} there too"),
        ),
        Missing::Speed if part_of(pulse).is_some() && measured => (
            true,
            format!(
                "criteria of occupants alone: channel {id} is of an occupant, and no impact speed is stated for a \
                 motion"
            ),
            state_the_speed.to_owned(),
        ),
        Missing::Speed if recorder => (
            true,
            "the recorded change of velocity alone: no impact speed is stated, so there is no crush".to_owned(),
            state_the_speed.to_owned(),
        ),
        Missing::Speed => (
            false,
            "the test has no impact speed, which no accelerometer can tell".to_owned(),
            state_the_speed.to_owned(),
        ),
    };
    out.remedy(remedy);
    if !result {
        return Ok(Outcome::NoAcceptableResult(reason));
    }
    out.nothing_for_later_stages(reason);
    Ok(Outcome::Done)
}

/// Gain of velocity over the impact speed, up to which a pulse that pushes forward is a hit from behind: a frontal
/// pulse of the wrong sign gains 1.0 to 1.35 times the impact speed.
const PUSHED: f64 = 0.6;

/// Whether a vehicle that moves at a stated speed gains velocity: it was struck from behind. A pulse of the wrong sign
/// gains more, and was asked about. A velocity that is known at the end is one over ground: such a motion is integrated
/// from its stated speed.
pub fn is_pushed(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    (pulse, speed_m_per_s): (&Channel, Option<f64>),
) -> anyhow::Result<bool> {
    let may_be = !test.exchange_asked && settings.end_condition.is_none();
    let Some(speed) = speed_m_per_s.filter(|_| may_be) else { return Ok(false) };
    let samples = acceleration(input, pulse)?;
    let (whole, _) = integrate_twice(samples.samples(), samples.dt_s(), IntegrationRule::Trapezoid, 0.0, 0.0);
    let v = &whole[samples.index_at_or_after(0.0).min(whole.len().saturating_sub(1))..];
    let change = |of: fn(f64, f64) -> f64| v.iter().copied().reduce(of).map_or(0.0, |end| end - v[0]);
    let (gain, loss) = (change(f64::max), -change(f64::min));
    Ok(gain > loss && gain < PUSHED * speed && gain > LEAST_GAIN_M_PER_S)
}

/// Less is no pulse: 3.6 km/h.
const LEAST_GAIN_M_PER_S: f64 = 1.0;

/// Writes the change of velocity of the pulse, the metrics that need no impact, and criteria. The others are absent,
/// with this as their reason. Of a motion from rest, velocity and displacement are known: its stroke is there. Later
/// stages, whose models start at the impact speed, have nothing to work on.
pub fn without_impact(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    (pulse, speed_m_per_s): (&Channel, Option<f64>),
    out: &mut Output,
) -> anyhow::Result<Outcome> {
    let samples = acceleration(input, pulse)?;
    let impact_speed_m_per_s = speed_m_per_s.filter(|speed| *speed == 0.0);
    let task = ChannelIntegration { settings, input, test, impact_speed_m_per_s, most_replicates: usize::MAX };
    let integrated = task.integrate(pulse, &samples, out)?;
    warn_unless_of_the_vehicle(pulse, out.notes());
    note_impacts(&integrated.events.impacts, out);
    let mut metrics = metric_records(&pulse.id, &integrated);
    let is_forward = integrated.events.end_velocity_m_per_s > 0.0;
    // What is pushed forward and has no speed stated starts from rest: a sled, a hit on a vehicle that stands.
    let from_rest = speed_m_per_s == Some(0.0) || (speed_m_per_s.is_none() && is_forward);
    let delta_v = metrics.iter().find(|metric| metric.name == "delta_v");
    let delta_v = delta_v.and_then(|metric| Some((metric.value?, metric.to_s?)));
    let stroke = delta_v.and_then(|(_, time_s)| integrated.motion.displacement.at(time_s)).filter(|_| from_rest);
    if let (Some(stroke), Some((_, time_s))) = (stroke, delta_v) {
        let stroke = Metric::with_value(&STROKE, stroke.abs()).over(0.0, time_s);
        metrics.push(metric_record(&[&pulse.id], &stroke));
    }
    let criteria = Criteria { settings, input, test, pulse, impact_speed_m_per_s: None };
    metrics.extend(criteria.records(out)?);

    let change = delta_v.map_or_else(String::new, |(value, time_s)| {
        format!(": change of velocity {value:.3} m/s at {:.1} ms", 1e3 * time_s)
    });
    let stroke_text = stroke.map_or_else(String::new, |stroke| format!(", stroke {:.0} mm", 1e3 * stroke.abs()));
    let (speed_text, reason) = match speed_m_per_s {
        Some(0.0) => ("; from rest", FROM_REST),
        Some(_) => {
            ("; it is pushed forward", "the pulse pushes the vehicle forward: it has no crush and no crush model")
        }
        // A vehicle pushed forward starts from rest: nobody has an impact speed to give.
        None if is_forward => ("; no impact speed is stated", UNSTATED_AND_FORWARD),
        None => (
            "; no impact speed is stated",
            "no impact speed is stated, so there is no crush and no model of it: --impact-speed 35km/h at ingest",
        ),
    };
    out.summary(format!("pulse {}{change}{stroke_text}{speed_text}", pulse.id));
    out.put("/test", &TestV1::from(test))?;
    let impacts = impact_records(&integrated.events.impacts, None);
    out.put("/impacts", &ImpactsV1 { channel: pulse.id.clone(), impacts })?;
    out.put("/metrics", &MetricsV2 { metrics })?;
    // The speed at contact is known where it is stated, and zero for what starts from rest.
    if let Some(at_contact) = speed_m_per_s.or(from_rest.then_some(0.0)) {
        let change = &integrated.motion.velocity;
        let velocity = change.samples().iter().map(|change| at_contact + change).collect();
        let velocity = Sampled::new(change.t0_s(), change.dt_s(), velocity)?;
        out.wave(&format!("{}/velocity", pulse.id), QuantityKind::Velocity, velocity)?;
    }
    if from_rest {
        let displacement = integrated.motion.displacement.clone().into_sampled();
        out.wave(&format!("{}/displacement", pulse.id), QuantityKind::Displacement, displacement)?;
    }
    let change = integrated.motion.velocity.into_sampled();
    out.wave(&format!("{}/velocity_change", pulse.id), QuantityKind::VelocityChange, change)?;
    out.nothing_for_later_stages(reason);
    Ok(Outcome::Done)
}

const FROM_REST: &str = "the motion starts from rest: it has no crush and no crush model";
const UNSTATED_AND_FORWARD: &str = "no impact speed is stated and the pulse is positive, as of a sled or a hit from \
    behind: a motion from rest has no crush and no crush model";
