//! What was tested: a vehicle, a sled, a catapult, a component. Stated, told by the code of the pulse, or proposed by
//! it.

use std::fmt;

use crumple_signal::{About, IntegrationRule, KindOfTest, Notes, Sampled, TestKind, Weight, integrate_twice, remarks};

use crate::recording::content::Wave;
use crate::recording::details::Details;

/// Of a motion that is pushed, the part of its largest velocity that it keeps to the end of the record: a sled rolls
/// on.
const LASTING: f64 = 0.9;
/// Less is no push, m/s: 3.6 km/h.
const LEAST_M_PER_S: f64 = 1.0;
/// Velocity before and after the stop of a braked sled that counts as none, as a part of the speed: cars leave a
/// barrier with 5 to 30 % of it.
const STANDS: f64 = 0.02;
/// Time after the stop in which it stands, s.
const STANDS_S: f64 = 0.02;
/// A force that has gone before the stop: the mean deceleration of the last tenth before it, as a part of that of the
/// whole. A spring has its largest force there (1.6 times the mean), a constant force 1, a half sine that takes the
/// whole speed 0.6.
const GONE: f64 = 0.75;

/// What says what was tested.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// A flag, the sidecar, the header, by name.
    Stated(String),
    /// The ISO 13499 code of the pulse.
    Code,
    /// Its motion.
    Proposed,
}

/// What was tested, and what says so.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    kind: TestKind,
    rule: Rule,
}

impl Found {
    /// The kind that is stated or told by the code. What the pulse proposes may be a frontal pulse of the wrong sign,
    /// or the vehicle of somebody who has not stated its mass: sign and mass are asked about as before.
    pub fn certain(&self) -> Option<TestKind> {
        (self.rule != Rule::Proposed).then_some(self.kind)
    }
}

impl From<Found> for KindOfTest {
    fn from(found: Found) -> Self {
        Self { kind: found.kind, rule: found.rule.to_string() }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stated(from) => write!(f, "stated by {from}"),
            Self::Code => f.write_str("the code of the pulse"),
            Self::Proposed => f.write_str("proposed by the pulse"),
        }
    }
}

/// What was tested, as stated, as the code has it, or as the pulse of a body proposes from its speed; with a note where
/// it is no vehicle.
pub fn settle(
    details: &Details,
    code: Option<&str>,
    pulse: Option<(&Wave, Option<f64>)>,
    notes: &mut Notes,
) -> Option<Found> {
    let proposed = || pulse.and_then(|(wave, speed)| proposed(wave, speed, details, code));
    let kind = stated(details, code).or_else(proposed);
    note(kind.as_ref(), notes);
    kind
}

/// As stated; else a sled where the ISO 13499 code of the pulse has the test object S.
fn stated(details: &Details, code: Option<&str>) -> Option<Found> {
    if let Some(stated) = &details.kind {
        return Some(Found { kind: stated.value, rule: Rule::Stated(stated.from.to_string()) });
    }
    let is_sled = code.is_some_and(|code| code.starts_with('S'));
    is_sled.then_some(Found { kind: TestKind::Sled, rule: Rule::Code })
}

/// What the pulse proposes where nothing says that it is of a vehicle: no mass, no words on vehicle or barrier, no code
/// of a vehicle. From rest, or without a speed, one that pushes forward to a velocity that lasts is a catapult. From a
/// speed, one that stops without a rebound although its force has gone before is a sled with a brake or a programme. A
/// force that is there at the stop may be a structure, whatever the rebound.
fn proposed(wave: &Wave, speed_m_per_s: Option<f64>, details: &Details, code: Option<&str>) -> Option<Found> {
    let is_of_vehicle = details.mass_kg.is_some()
        || details.vehicle.is_some()
        || details.barrier.is_some()
        || !details.vehicles.is_empty()
        || code.is_some_and(|code| code.starts_with(|c: char| ('1'..='9').contains(&c)));
    if is_of_vehicle {
        return None;
    }
    let kind = by_motion(&wave.samples, wave.quality.zero_level().unwrap_or(0.0), speed_m_per_s.unwrap_or(0.0))?;
    Some(Found { kind, rule: Rule::Proposed })
}

/// What a motion from contact on looks like, see [`proposed`].
fn by_motion(samples: &Sampled, zero_level: f64, speed_m_per_s: f64) -> Option<TestKind> {
    let from = samples.index_at_or_after(0.0);
    let a: Vec<f64> = samples.samples().get(from..)?.iter().map(|a| a - zero_level).collect();
    let (v, _) = integrate_twice(&a, samples.dt_s(), IntegrationRule::Trapezoid, speed_m_per_s, 0.0);
    let end = *v.last()?;
    let (low, high) = v.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
    if speed_m_per_s == 0.0 {
        let is_pushed = high > LEAST_M_PER_S && low > -LEAST_M_PER_S && end > LASTING * high;
        return is_pushed.then_some(TestKind::Catapult);
    }
    let stands = STANDS * speed_m_per_s;
    let stop = v.iter().position(|v| *v <= stands)?;
    let after = (STANDS_S / samples.dt_s()) as usize;
    let is_still = v.len() > stop + after && v[stop..].iter().all(|v| v.abs() <= stands);
    let tail = stop - stop / 10;
    let mean = |from: usize| (v[from] - v[stop]) / (stop - from).max(1) as f64;
    (is_still && stop >= 10 && mean(tail) < GONE * mean(0)).then_some(TestKind::Sled)
}

/// Says what a test is where it is no vehicle, and the flag that says otherwise.
fn note(found: Option<&Found>, notes: &mut Notes) {
    let Some(Found { kind, rule }) = found.filter(|of| of.kind != TestKind::Vehicle) else { return };
    let flag = (!matches!(rule, Rule::Stated(_))).then_some("--kind vehicle");
    notes.push(NoVehicle { kind: kind.name(), rule: rule.to_string(), flag });
}

remarks! {
    /// Remarks of what was tested.
    pub REMARKS;

    /// What was tested is no vehicle.
    CR140 NoVehicle { kind: &'static str, rule: String, flag: Option<&'static str> }
    bears on (About::Record, Weight::None)
    decided "--kind, the sidecar or the header states it, or the code of the pulse begins with S, a sled. Of a record \
             that states nothing of a vehicle the pulse proposes it: a catapult keeps 90 % of its largest velocity, a \
             sled stops without a rebound (2 %) after its force has gone."
    means "Brake and drive of a sled are no structure: no model is made. A component has one where its mass is stated."
    remedy "nothing; --kind vehicle if it is one, --mass for a model of a component"
    says match *kind {
        "component" => format!("what was tested is a component ({rule}): without its mass there is no model of it"),
        kind => {
            let other = flag.map_or_else(String::new, |flag| format!("; {flag} says that it is one"));
            format!("what was tested is a {kind} ({rule}): it has no structure, so no model is made of it{other}")
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A pulse from contact to `lasting_s`, 50 ms at rest before and 200 ms after it.
    fn record(lasting_s: f64, at: impl Fn(f64) -> f64) -> Sampled {
        let sample = |k: i32| {
            let t = f64::from(k) * 1e-4;
            if (0.0..lasting_s).contains(&t) { at(t) } else { 0.0 }
        };
        Sampled::new(-0.05, 1e-4, (-500..3000).map(sample).collect()).unwrap()
    }

    #[test]
    fn a_push_that_lasts_is_a_catapult_and_one_that_is_braked_again_is_not() {
        let pushed = record(0.1, |t| 200.0 * (PI * t / 0.1).sin());
        assert_eq!(by_motion(&pushed, 0.0, 0.0), Some(TestKind::Catapult));
        let there_and_back = record(0.2, |t| 200.0 * (PI * t / 0.1).sin());
        assert_eq!(by_motion(&there_and_back, 0.0, 0.0), None);
        assert_eq!(by_motion(&record(0.1, |_| 0.0), 0.0, 0.0), None);
    }

    #[test]
    fn a_stop_without_force_and_rebound_is_a_sled_and_one_by_a_spring_is_not() {
        // 2·A·T/π: the half sine takes the whole speed.
        let half_sine = record(0.1, |t| -200.0 * (PI * t / 0.1).sin());
        let speed = 2.0 * 200.0 * 0.1 / PI;
        assert_eq!(by_motion(&half_sine, 0.0, speed), Some(TestKind::Sled));
        // The same half sine as a spring: it takes twice the speed, and all of it is force at the stop.
        assert_eq!(by_motion(&half_sine, 0.0, speed / 2.0), None);
        // A body that is stopped dead by a constant force, or by a spring that gives nothing back.
        let constant = record(0.1, |_| -150.0);
        assert_eq!(by_motion(&constant, 0.0, 15.0), None);
        let dead = record(0.05, |t| -200.0 * (PI * t / 0.1).sin());
        assert_eq!(by_motion(&dead, 0.0, speed / 2.0), None);
        // One that rebounds at 5 %.
        assert_eq!(by_motion(&half_sine, 0.0, speed / 1.05), None);
    }
}
