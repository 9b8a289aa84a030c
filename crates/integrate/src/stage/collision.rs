//! The other vehicle of a test with two: its own motion, and what both say of their collision.

use crumple_metrics::definitions::{
    COMMON_VELOCITY, COMMON_VELOCITY_BY_MOMENTUM, MOMENTUM_GAP, RELATIVE_CRUSH, RESTITUTION_TWO,
    TIME_OF_COMMON_VELOCITY,
};
use crumple_metrics::{Metric, TwoVehicleImpact, collision, common_velocity};
use crumple_signal::{About, Channel, QuantityKind, Signal, TestDescription, Velocity, Weight, part_of, remarks};
use crumple_stage::records::{MetricV1, MetricsV2, VehicleV1, VehiclesV1};
use crumple_stage::{Inputs, Outcome, Output};

use crate::stage::criteria::{recorded_changes, recorded_impacts};
use crate::stage::integration::{ChannelIntegration, acceleration};
use crate::stage::occupants_and_roadside::Criteria;
use crate::stage::options::StageSettings;
use crate::stage::records::{metric_record, metric_records};

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
/// collision with the vehicle of the pulse, of which speed at contact and velocity are given. Its velocity is written,
/// no displacement: that of a sensor would be compared with the models.
pub fn other_vehicle(
    task: &ChannelIntegration<'_>,
    vehicles: &[VehicleV1],
    pulse: &Channel,
    (own_speed, own_velocity): (f64, &Signal<Velocity>),
    out: &mut Output,
) -> anyhow::Result<Vec<MetricV1>> {
    let Some(own) = carrier(vehicles, &pulse.id) else { return Ok(Vec::new()) };
    let Some(other) = vehicles.iter().find(|vehicle| vehicle.number != own.number) else { return Ok(Vec::new()) };
    let number = other.number;
    let channel = other.pulse.as_deref().and_then(|id| task.test.channel(id));
    let Some(channel) = channel.filter(|channel| task.input.wave_if(&channel.id).is_some()) else {
        out.notes().push(OtherWithoutPulse { vehicle: number });
        return Ok(Vec::new());
    };
    let mut described = task.test.clone();
    described.mass_kg = other.mass_kg;
    described.impact_speed_m_per_s = other.impact_speed_m_per_s;
    let its_task = ChannelIntegration {
        test: &described,
        impact_speed_m_per_s: other.impact_speed_m_per_s,
        change_from_m_per_s: Some(0.0),
        ..*task
    };
    let motion = its_task.integrate(channel, &acceleration(task.input, channel)?, out)?;
    let mut metrics = metric_records(&channel.id, &motion);
    let velocity = &motion.motion.velocity;
    let Some(other_speed) = other.impact_speed_m_per_s else {
        out.notes().push(OtherWithoutSpeed { vehicle: number });
        out.wave(
            &format!("{}/velocity_change", channel.id),
            QuantityKind::VelocityChange,
            velocity.clone().into_sampled(),
        )?;
        return Ok(metrics);
    };
    match collision(own_velocity, velocity) {
        Some(found) => {
            let masses = own.mass_kg.or(task.test.mass_kg).zip(other.mass_kg);
            let speeds = [own_speed, other_speed];
            let ids = [pulse.id.as_str(), channel.id.as_str()];
            say(&found, [own.number, number], masses, speeds, out);
            metrics.extend(collision_metrics(&found, masses, speeds).iter().map(|metric| metric_record(&ids, metric)));
        }
        None => out.notes().push(NoCollisionSeen { pulse: pulse.id.clone(), other: channel.id.clone() }),
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
    let heading = if found.same_heading { "the same way" } else { "towards it" }.to_owned();
    out.notes().push(ClosingSpeed { vehicle: own, other, heading, closing_m_per_s: found.closing_speed_m_per_s });
    out.notes().push(ModelsOfOneVehicle {});
    let Some((first, second)) = masses else { return };
    let sign = if found.same_heading { 1.0 } else { -1.0 };
    let common_velocity_m_per_s = common_velocity([first, second], [speeds[0], sign * speeds[1]]);
    let Some(gap) = found.momentum_gap([first, second]) else { return };
    if gap.abs() <= LARGE_GAP {
        out.notes().push(MomentumKept { vehicle: own, left_over: gap, common_velocity_m_per_s });
    } else {
        out.notes().push(MomentumLeftOver { vehicle: own, left_over: gap, common_velocity_m_per_s });
    }
}

/// The balance of momentum of both vehicles in words.
fn momentum(vehicle: u32, left_over: f64, common_velocity_m_per_s: f64) -> String {
    format!(
        "momentum: the changes of both vehicles leave {:+.1} % of that of vehicle {vehicle} over; the masses and \
         speeds give a common velocity of {common_velocity_m_per_s:.3} m/s",
        100.0 * left_over
    )
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
    out.put("/test", &input.test_with_samples(test))?;
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

remarks! {
    /// Remarks of two vehicles.
    pub REMARKS;

    /// The other vehicle has no pulse.
    CR364 OtherWithoutPulse { vehicle: u32 }
    bears on (About::Motion, Weight::None)
    decided "The file names no pulse of it, or the filtered record does not hold it."
    means "There is no relative crush, no common velocity and no balance of momentum. The pulse is not touched."
    remedy "nothing, or let the filter take the channel: filter.channels"
    says format!(
        "vehicle {vehicle} has no pulse in the inputs: no relative crush, common velocity and balance of momentum"
    );

    /// The other vehicle states no speed.
    CR365 OtherWithoutSpeed { vehicle: u32 }
    bears on (About::Motion, Weight::Slight)
    decided "The file has no speed of it; a vehicle that stands has the speed 0."
    means "Its velocity is the change of velocity. There is no closing speed and no relative crush."
    remedy "state its speed in the file of the test"
    says format!(
        "vehicle {vehicle} states no speed (0 would be one): its velocity is the change of it, and nothing is said of \
         both"
    );

    /// The pulses of both vehicles show no collision along x.
    CR366 NoCollisionSeen { pulse: String, other: String }
    bears on (About::Motion, Weight::Slight)
    decided "Both velocities need one time grid, a change, and an approach at contact."
    means "There is no closing speed, no relative crush and no balance of momentum. Each pulse holds."
    remedy "check which channels are the pulses, and their sign; a hit across the axis of a vehicle shows nothing"
    says format!(
        "the pulses {pulse} and {other} of both vehicles show no collision along x (another grid, no change of \
         velocity, or a hit across): nothing is said of both"
    );

    /// How the other vehicle heads, and the closing speed.
    CR367 ClosingSpeed { vehicle: u32, other: u32, heading: String, closing_m_per_s: f64 }
    bears on (About::Motion, Weight::None)
    decided "The forces on both are opposite: if both lose speed they head towards each other, if one gains what the \
             other loses they head the same way."
    means "Velocities of both are along the axis of the vehicle that has the pulse."
    remedy "nothing"
    says format!(
        "vehicle {other} heads {heading}, as the changes of velocity say: closing speed {closing_m_per_s:.3} m/s; the \
         velocities along the axis of vehicle {vehicle}"
    );

    /// Models of one vehicle are fitted to a collision of two.
    CR368 ModelsOfOneVehicle {}
    bears on (About::Model(String::new()), Weight::None)
    decided "The test has two vehicles. The models of this chain meet a rigid barrier."
    means "Their crush and parameters hold for both vehicles together: the other vehicle gave way too."
    remedy "use delta-v and the pulse; take parameters from a barrier test"
    says "models of one vehicle at a rigid barrier are fitted to the pulse as if it had met one: their crush and \
          parameters are not those of the vehicle alone";

    /// The momentum that one vehicle loses is what the other gains.
    CR369 MomentumKept { vehicle: u32, left_over: f64, common_velocity_m_per_s: f64 }
    bears on (About::Motion, Weight::None)
    decided "Mass times change of velocity is added over both vehicles, up to the common velocity. What is left over \
             is at most 10 % of what the vehicle with the pulse loses."
    means "Masses, speeds, sensors and direction fit together."
    remedy "nothing"
    says momentum(*vehicle, *left_over, *common_velocity_m_per_s);

    /// The momentum that one vehicle loses is not what the other gains.
    CR370 MomentumLeftOver { vehicle: u32, left_over: f64, common_velocity_m_per_s: f64 }
    bears on (About::Motion, Weight::Slight)
    decided "Mass times change of velocity is added over both vehicles, up to the common velocity. What is left over \
             is more than 10 % of what the vehicle with the pulse loses."
    means "A mass, a speed, a sensor or the direction is not as stated: relative crush and closing speed may be wrong."
    remedy "check masses, speeds and the sign of both pulses"
    says format!(
        "{}: a mass, a speed, a sensor or the direction is not as stated",
        momentum(*vehicle, *left_over, *common_velocity_m_per_s)
    );
}
