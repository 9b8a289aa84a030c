//! Rows of the joint of integrate: velocity and displacement are integrals, and events and metrics are theirs.

use crumple_artifact::Artifact;
use crumple_artifact::records::{EventsV1, MetricV1, MetricsV2, TestV1};
use crumple_signal::{About, Kind, Sampled, TestDescription, Weight};

use crate::joints::curves::{Running, end_of, farthest, range, times, value_at};
use crate::joints::{BESIDE, Finding, Invariant, RunParts, is_outside, pulse_of, record};

/// What every row of integrals says to do.
const INTEGRATE: &str = "integrate in m, s and kg in the program of the stage integrate";
/// What every row of figures says to do.
const READ_OFF: &str = "read the events off the curves that the program of the stage integrate writes";

/// Rows of the stage.
pub(crate) static ROWS: [Invariant; 10] = [
    Invariant {
        kind: Kind {
            code: "CR301",
            weight: Weight::Decisive,
            explanation: [
                "The velocity is not the integral of the acceleration.",
                "From contact on both are compared, sample by sample. What is left is 4 % of the range of the \
                 velocity beside a straight line, which a drift that was taken out makes: other rules of integration \
                 and a rate of 1 kHz stay below 1 %.",
                "A unit, a sign or a time axis is wrong: crush, delta-v and every model are made from this velocity.",
                INTEGRATE,
            ],
        },
        ends_the_run: true,
        find: velocity_is_no_integral,
    },
    Invariant {
        kind: Kind {
            code: "CR302",
            weight: Weight::Decisive,
            explanation: [
                "The displacement is not the integral of the velocity.",
                "From contact on both are compared, sample by sample; 2 % of the range of the displacement and 1 mm \
                 are left.",
                "A unit, a sign or a time axis is wrong: models are fitted to this displacement.",
                INTEGRATE,
            ],
        },
        ends_the_run: true,
        find: displacement_is_no_integral,
    },
    Invariant {
        kind: Kind {
            code: "CR303",
            weight: Weight::Decisive,
            explanation: [
                "The velocity does not begin with the impact speed, or two impact speeds are stated.",
                "The velocity at contact, or where the integration begins, and the speed of /test are compared with \
                 that of /events; 1 % and 0.05 m/s are left. What a filter spreads before contact is in between.",
                "Energy and crush go with the square of the speed: one of both is wrong.",
                READ_OFF,
            ],
        },
        ends_the_run: true,
        find: two_impact_speeds,
    },
    Invariant {
        kind: Kind {
            code: "CR304",
            weight: Weight::Decisive,
            explanation: [
                "The dynamic crush is not the displacement at its time, the velocity there is not zero, or the \
                 displacement at contact is not.",
                "The curves are read at the stated time; 1 % and 1 mm of the crush, 5 % of the impact speed are left, \
                 which is 1 % of the crush on a pulse of usual length.",
                "Crush is what models are fitted to and compared with.",
                READ_OFF,
            ],
        },
        ends_the_run: true,
        find: crush_is_not_of_the_curve,
    },
    Invariant {
        kind: Kind {
            code: "CR305",
            weight: Weight::Decisive,
            explanation: [
                "Impact speed, rebound, restitution and delta-v do not fit together.",
                "Delta-v is the impact speed less the rebound velocity, restitution their ratio (docs/format.md, \
                 Events); 1 % of the impact speed is left.",
                "One of them is wrong, and predictions start from them.",
                READ_OFF,
            ],
        },
        ends_the_run: true,
        find: rebound_contradicts_itself,
    },
    Invariant {
        kind: Kind {
            code: "CR306",
            weight: Weight::Decisive,
            explanation: [
                "A value lies outside of its own interval.",
                BESIDE,
                "The interval or the value is that of something else.",
                "write the interval of the value that is written",
            ],
        },
        ends_the_run: true,
        find: outside_of_its_interval,
    },
    Invariant {
        kind: Kind {
            code: "CR307",
            weight: Weight::Decisive,
            explanation: [
                "A metric and an event of one name differ.",
                "Dynamic crush and delta-v of /metrics, taken to SI by their unit, are compared with /events; 0.1 % \
                 and 0.0001 are left, for programs that round to four digits.",
                "A unit or a curve is another one: which number is right cannot be told.",
                "write SI units, and read metrics and events off the same curves",
            ],
        },
        ends_the_run: true,
        find: metric_and_event_differ,
    },
    Invariant {
        kind: Kind {
            code: "CR308",
            weight: Weight::Decisive,
            explanation: [
                "The force is not mass times deceleration.",
                "The force of the pulse is compared with the mass of /test times the acceleration; 3 % of its range \
                 are left.",
                "A unit or the mass is another one: stiffness goes with the force.",
                "write N in the program of the stage integrate",
            ],
        },
        ends_the_run: true,
        find: force_is_no_product,
    },
    Invariant {
        kind: Kind {
            code: "CR309",
            weight: Weight::Decisive,
            explanation: [
                "A motion was integrated, and nobody says what its events are.",
                "/events is looked for beside /wave/PULSE/displacement in 3-integrate of a vehicle that /test gives a \
                 mass and an impact speed.",
                "Without contact, crush and its time nothing can be fitted.",
                "write /events in the program of the stage integrate: CONTRACT.md of crumple new-stage integrate \
                 lists it",
            ],
        },
        ends_the_run: true,
        find: has_no_events,
    },
    Invariant {
        kind: Kind {
            code: "CR310",
            weight: Weight::Decisive,
            explanation: [
                "The velocity has a drift that the acceleration has not, and nobody says that it was taken out.",
                "The straight line between the velocity and the integral of the acceleration, from contact to the \
                 end, is compared with the metric drift_correction of the channel; 1 m/s² is left, twice the \
                 uncertainty of a zero level of 0.05 g.",
                "The crush is off by half of it times the square of the time of crush: 26 mm for 8 m/s² at 80 ms.",
                "write what was taken out as the metric drift_correction in m/s^2, or integrate the samples as they \
                 are",
            ],
        },
        ends_the_run: false,
        find: has_a_drift_of_its_own,
    },
];

/// The motion that integrate wrote.
struct Motion<'a> {
    artifact: &'a Artifact,
    events: EventsV1,
    velocity: Option<&'a Sampled>,
    displacement: Option<&'a Sampled>,
}

impl<'a> Motion<'a> {
    fn of(parts: &RunParts<'a>) -> Option<Self> {
        let artifact = parts.of("integrate")?;
        let events: EventsV1 = record(artifact, "/events")?;
        let curve = |what: &str| {
            let wave = artifact.waves().get(&format!("{}/{what}", events.channel))?;
            Some(&wave.sampled).filter(|wave| wave.len() > 1)
        };
        let (velocity, displacement) = (curve("velocity"), curve("displacement"));
        Some(Self { artifact, events, velocity, displacement })
    }

    /// The velocity that an acceleration gives, m/s, from the impact speed at contact on.
    fn velocity_of_pulse(&self, pulse: &Sampled) -> Option<Sampled> {
        let (speed, running) = (self.events.impact_speed_m_per_s?, Running::of(pulse));
        let contact_s = pulse.t0_s().max(0.0);
        let samples = (0..pulse.len()).map(|index| Some(speed + running.over(contact_s, pulse.time_s(index))?));
        Sampled::new(pulse.t0_s(), pulse.dt_s(), samples.collect::<Option<Vec<f64>>>()?).ok()
    }

    /// The part in which it is a motion: from contact to the end of a curve.
    fn part(curve: &Sampled) -> (f64, f64) {
        (curve.t0_s().max(0.0), end_of(curve))
    }
}

fn finding(about: About, values: Vec<(&'static str, f64)>, text: String) -> Vec<Finding> {
    vec![Finding { stage: "integrate", about, values, text }]
}

/// Share of the range of a velocity, and of a displacement, that may be beside their integral.
const OF_VELOCITY: f64 = 0.04;
const OF_DISPLACEMENT: f64 = 0.02;

fn has_no_events(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("integrate") else { return Vec::new() };
    let has = |topic: &str| artifact.records().iter().any(|raw| raw.topic == topic);
    let Some(test) = record::<TestV1>(artifact, "/test") else { return Vec::new() };
    let Some(id) = pulse_of(&test).map(|pulse| format!("{pulse}/displacement")) else { return Vec::new() };
    // A component, a sled and what is struck at rest have none.
    let moves = test.mass_kg.is_some() && test.impact_speed_m_per_s.is_some_and(|speed| speed > 0.0);
    let has_structure = TestDescription::try_from(test).is_ok_and(|test| test.has_structure());
    if !(moves && has_structure && artifact.waves().contains_key(&id)) || has("/events") || has("/diagnosis") {
        return Vec::new();
    }
    let text = format!("there is the wave {id}, and no record /events");
    vec![Finding { stage: "integrate", about: About::Motion, values: Vec::new(), text }]
}

/// A velocity beside the integral of the acceleration, over the time of both from contact on.
struct Beside<'a> {
    velocity: &'a Sampled,
    running: Running,
    from_s: f64,
    to_s: f64,
    /// Velocity less integral at both ends.
    ends: (f64, f64),
}

impl<'a> Beside<'a> {
    fn of(parts: &RunParts<'a>, motion: &Motion<'a>) -> Option<Self> {
        let (velocity, pulse) = motion.velocity.zip(parts.wave(&motion.events.channel, "filter"))?;
        let (from_s, to_s) = Motion::part(velocity);
        let (from_s, to_s) = (from_s.max(pulse.t0_s()), to_s.min(end_of(pulse)));
        let running = Running::of(pulse);
        let beside = |t: f64| Some(value_at(velocity, t)? - running.over(from_s, t)?);
        let ends = (beside(from_s)?, beside(to_s)?);
        Some(Self { velocity, running, from_s, to_s, ends })
    }

    /// The line between both, m/s².
    fn slope(&self) -> f64 {
        (self.ends.1 - self.ends.0) / (self.to_s - self.from_s).max(f64::MIN_POSITIVE)
    }

    fn line(&self, t: f64) -> f64 {
        self.ends.0 + self.slope() * (t - self.from_s)
    }

    /// The larger change: of the velocity, or of the integral.
    fn change(&self) -> f64 {
        let of_integral = self.running.over(self.from_s, self.to_s).unwrap_or_default().abs();
        range(self.velocity, self.from_s, self.to_s).max(of_integral)
    }

    /// Whether the line is as long as the change itself: no drift.
    fn is_no_drift(&self) -> bool {
        (self.ends.1 - self.ends.0).abs() > DRIFT * self.change()
    }
}

fn velocity_is_no_integral(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let Some(beside) = Beside::of(parts, &motion) else { return Vec::new() };
    let (velocity, from_s, to_s) = (beside.velocity, beside.from_s, beside.to_s);
    let integral = |t: f64| Some(beside.running.over(from_s, t)? + beside.line(t));
    let found = if beside.is_no_drift() {
        let of = beside.running.over(from_s, to_s);
        of.map(|of| (to_s, of + beside.line(to_s), of + beside.ends.0))
    } else {
        farthest(times(velocity, from_s, to_s), |t| value_at(velocity, t), integral)
    };
    let left = OF_VELOCITY * beside.change();
    let Some((time_s, says, of)) = found.filter(|(_, says, of)| (says - of).abs() > left) else { return Vec::new() };
    let text = format!(
        "the velocity at {:.1} ms is {says:.2} m/s, the integral of the acceleration {of:.2} m/s",
        time_s * 1e3
    );
    let values = vec![("time_s", time_s), ("velocity_m_per_s", says), ("integral_m_per_s", of)];
    finding(About::Motion, values, text)
}

/// Drift that nobody need state, m/s².
const UNSTATED: f64 = 1.0;

fn has_a_drift_of_its_own(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let Some(beside) = Beside::of(parts, &motion).filter(|beside| !beside.is_no_drift()) else { return Vec::new() };
    let stated = record::<MetricsV2>(motion.artifact, "/metrics").and_then(|metrics| {
        let of_drift = |m: &&MetricV1| m.name == "drift_correction" && m.channel == motion.events.channel;
        metrics.metrics.iter().find(of_drift)?.value
    });
    let (slope, stated) = (beside.slope(), stated.unwrap_or(0.0));
    // A drift is stated with the sign of the sensor's error or of the correction.
    if (slope.abs() - stated.abs()).abs() <= UNSTATED {
        return Vec::new();
    }
    let text = format!("the velocity drifts by {slope:.2} m/s² against the acceleration, {stated:.2} m/s² are stated");
    finding(About::Motion, vec![("drift_m_per_s2", slope), ("stated_m_per_s2", stated)], text)
}

/// Share of the change of velocity that a drift may take out: `known ends` of long records stay below it.
const DRIFT: f64 = 0.25;

fn displacement_is_no_integral(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    // Without a velocity that of the acceleration stands for it.
    let of_pulse = || motion.velocity_of_pulse(parts.wave(&motion.events.channel, "filter")?);
    let made = if motion.velocity.is_none() { of_pulse() } else { None };
    let Some((displacement, velocity)) = motion.displacement.zip(motion.velocity.or(made.as_ref())) else {
        return Vec::new();
    };
    let (from_s, to_s) = Motion::part(displacement);
    let (from_s, to_s) = (from_s.max(velocity.t0_s()), to_s.min(end_of(velocity)));
    let running = Running::of(velocity);
    let Some(first) = value_at(displacement, from_s) else { return Vec::new() };
    let integral = |t: f64| Some(first + running.over(from_s, t)?);
    let spread = range(displacement, from_s, to_s);
    let found = farthest(times(displacement, from_s, to_s), |t| value_at(displacement, t), integral);
    let left = |of: f64| OF_DISPLACEMENT * spread.max((of - first).abs()) + 1e-3;
    let Some((time_s, says, of)) = found.filter(|(_, says, of)| (says - of).abs() > left(*of)) else {
        return Vec::new();
    };
    let text = format!(
        "the displacement at {:.1} ms is {:.0} mm, the integral of the velocity {:.0} mm",
        time_s * 1e3,
        says * 1e3,
        of * 1e3
    );
    finding(About::Motion, vec![("time_s", time_s), ("displacement_m", says), ("integral_m", of)], text)
}

fn two_impact_speeds(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let Some(speed) = motion.events.impact_speed_m_per_s else { return Vec::new() };
    let of_test = record::<TestV1>(motion.artifact, "/test").and_then(|test| test.impact_speed_m_per_s);
    let at_contact = motion.velocity.and_then(|velocity| value_at(velocity, velocity.t0_s().max(0.0)));
    // A record that begins in the pulse has lost speed before its first sample.
    let at_contact = at_contact.filter(|_| motion.velocity.is_some_and(|velocity| velocity.t0_s() <= 0.0));
    let at_start = motion.velocity.and_then(|velocity| velocity.samples().first().copied());
    let differs = |other: f64| (other.abs() - speed.abs()).abs() > 0.01 * speed.abs() + 0.05;
    let at_contact = at_contact.filter(|_| at_start.is_none_or(differs));
    let others = [("the velocity at contact is", at_contact), ("the impact speed of /test is", of_test)];
    let Some((what, other)) = others.into_iter().find_map(|(what, other)| Some((what, other.filter(|o| differs(*o))?)))
    else {
        return Vec::new();
    };
    let text = format!("{what} {other:.2} m/s, that of /events {speed:.2} m/s");
    finding(About::ImpactSpeed, vec![("other_m_per_s", other), ("events_m_per_s", speed)], text)
}

fn crush_is_not_of_the_curve(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let Some((crush_m, time_s)) = motion.events.dynamic_crush_m.zip(motion.events.time_of_dynamic_crush_s) else {
        return Vec::new();
    };
    if let Some(curve) = motion.displacement {
        let at_contact = value_at(curve, 0.0).filter(|at_m| at_m.abs() > 0.01 * crush_m.abs() + 1e-3);
        if let Some(at_m) = at_contact {
            let text = format!("the displacement at contact is {:.0} mm, it was to be zero", at_m * 1e3);
            return finding(About::Motion, vec![("contact_m", at_m)], text);
        }
        let Some(at_m) = value_at(curve, time_s) else {
            let text = format!(
                "the time of dynamic crush is {:.1} ms, the displacement ends at {:.1} ms",
                time_s * 1e3,
                end_of(curve) * 1e3
            );
            return finding(About::Motion, vec![("time_s", time_s), ("end_s", end_of(curve))], text);
        };
        if (at_m - crush_m).abs() > 0.01 * crush_m.abs().max(at_m.abs()) + 1e-3 {
            let text = format!(
                "the dynamic crush of /events is {:.0} mm, the displacement of the curve at its time {:.0} mm",
                crush_m * 1e3,
                at_m * 1e3
            );
            return finding(About::Motion, vec![("events_m", crush_m), ("curve_m", at_m)], text);
        }
    }
    let speed = motion.events.impact_speed_m_per_s.unwrap_or(0.0).abs();
    let velocity = motion.velocity.and_then(|curve| value_at(curve, time_s));
    let Some(velocity) = velocity.filter(|velocity| speed > 0.0 && velocity.abs() > 0.05 * speed) else {
        return Vec::new();
    };
    let text = format!("the velocity at the time of dynamic crush is {velocity:.2} m/s, it was to be zero");
    finding(About::Motion, vec![("velocity_m_per_s", velocity)], text)
}

fn rebound_contradicts_itself(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let events = &motion.events;
    let (Some(speed), Some(rebound)) = (events.impact_speed_m_per_s, events.rebound_velocity_m_per_s) else {
        return Vec::new();
    };
    let differs = |stated: f64, of: f64| (stated - of).abs() > 0.01 * speed.abs() + 1e-3;
    if let Some(change) = events.delta_v_m_per_s.filter(|change| differs(*change, speed - rebound)) {
        let text = format!("delta-v is {change:.2} m/s, impact speed less rebound velocity {:.2} m/s", speed - rebound);
        return finding(
            About::Motion,
            vec![("delta_v_m_per_s", change), ("difference_m_per_s", speed - rebound)],
            text,
        );
    }
    let stated = events.coefficient_of_restitution.filter(|e| differs(e * speed, -rebound));
    let Some(restitution) = stated.filter(|_| speed != 0.0) else { return Vec::new() };
    let text = format!(
        "the coefficient of restitution is {restitution:.3}, rebound velocity over impact speed {:.3}",
        -rebound / speed
    );
    finding(About::Motion, vec![("restitution", restitution), ("ratio", -rebound / speed)], text)
}

fn outside_of_its_interval(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(artifact) = parts.of("integrate") else { return Vec::new() };
    let mut stated: Vec<(String, f64, f64, f64)> = Vec::new();
    if let Some(events) = record::<EventsV1>(artifact, "/events") {
        let fields = serde_json::to_value(&events).unwrap_or_default();
        let value = |name: &str| fields.get(name).and_then(serde_json::Value::as_f64);
        let of = events.intervals.iter().filter_map(|i| Some((i.name.clone(), value(&i.name)?, i.low, i.high)));
        stated.extend(of);
    }
    if let Some(metrics) = record::<MetricsV2>(artifact, "/metrics") {
        stated.extend(metrics.metrics.iter().filter_map(|m| Some((m.name.clone(), m.value?, m.low?, m.high?))));
    }
    let found = stated.into_iter().find(|(_, value, low, high)| is_outside(*value, *low, *high));
    let Some((name, value, low, high)) = found else { return Vec::new() };
    let text = format!("{name} is {value:.4}, its interval {low:.4} to {high:.4}");
    finding(About::Motion, vec![("value", value), ("low", low), ("high", high)], text)
}

fn metric_and_event_differ(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let Some(metrics) = record::<MetricsV2>(motion.artifact, "/metrics") else { return Vec::new() };
    let events =
        [("dynamic_crush", motion.events.dynamic_crush_m, "m"), ("delta_v", motion.events.delta_v_m_per_s, "m/s")];
    for (name, event, unit) in events {
        let metric = metrics.metrics.iter().find(|m| m.name == name && m.channel == motion.events.channel);
        let Some((event, metric)) = event.zip(metric) else { continue };
        let Some(value) = metric.value else { continue };
        if metric.unit == unit && (value - event).abs() <= (1e-3 * value.abs().max(event.abs())).max(1e-4) {
            continue;
        }
        let text = format!("{name} is {value:.4} {} in /metrics, {event:.4} {unit} in /events", metric.unit);
        return finding(About::Motion, vec![("metric", value), ("event", event)], text);
    }
    Vec::new()
}

fn force_is_no_product(parts: &RunParts<'_>) -> Vec<Finding> {
    let Some(motion) = Motion::of(parts) else { return Vec::new() };
    let test: Option<TestV1> = record(motion.artifact, "/test");
    let (Some(mass_kg), Some(pulse), Some(force)) = (
        test.and_then(|test| test.mass_kg),
        parts.wave(&motion.events.channel, "filter"),
        motion.artifact.waves().get(&format!("{}/force", motion.events.channel)),
    ) else {
        return Vec::new();
    };
    let force = &force.sampled;
    let (from_s, to_s) = (force.t0_s().max(pulse.t0_s()).max(0.0), end_of(force).min(end_of(pulse)));
    let product = |t: f64| Some(-mass_kg * value_at(pulse, t)?);
    let found = farthest(times(force, from_s, to_s), |t| value_at(force, t), product);
    let left = 0.03 * range(force, from_s, to_s).max(mass_kg * range(pulse, from_s, to_s));
    let Some((time_s, says, of)) = found.filter(|(_, says, of)| (says - of).abs() > left) else { return Vec::new() };
    let text = format!(
        "the force at {:.1} ms is {:.1} kN, mass times deceleration {:.1} kN",
        time_s * 1e3,
        says / 1e3,
        of / 1e3
    );
    finding(About::Motion, vec![("time_s", time_s), ("force_n", says), ("product_n", of)], text)
}
