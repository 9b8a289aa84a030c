//! What is read off a pulse: peak, means, centroid, square waves, the largest change of velocity.
//!
//! All metrics of a crash pulse, in the order in which they are written.
//!
//! The order of the list is that of the artifact, so it is part of the file format. Every metric carries the window it
//! belongs to: the loading phase, one moment, the stretch up to separation. One that the record does not show is absent
//! with its reason.

use crumple_signal::{Acceleration, Displacement, Signal, Velocity};

use crate::energy::{absorbed_energy, kinetic_energy, loading_work_per_kg};
use crate::metric::definitions::{
    ABSORBED_ENERGY, ASW, AVERAGE_STIFFNESS, CENTROID, CENTROID_MOMENT, CENTROID_RATIO, CLOSURE, DELTA_V,
    DYNAMIC_CRUSH, EES, ESW, IMPACT_ENERGY, LOSS_RATIO, PEAK, REBOUND_DISPLACEMENT, RESTITUTION, RETURNED_ENERGY,
    RISE_TIME, SEPARATION, TIME_OF_CRUSH, TIME_OF_PEAK, X_MEAN,
};
use crate::metric::value::same_grid;
use crate::restrained_occupant::{olc, vpi};
use crate::sums::sliding_mean_of_velocity;
use crate::{
    CrashEvents, Definition, EventEnd, Metric, MetricsError, OlcOptions, VpiOptions, acceleration_after_separation,
    average_stiffness, energy_equivalent_speed, first_event,
};

/// A crash as motion: what [`pulse_metrics`] looks at. The three signals share one grid.
#[derive(Debug, Clone, Copy)]
pub struct Pulse<'a> {
    /// Acceleration, m/s².
    pub acceleration: &'a Signal<Acceleration>,
    /// Velocity, m/s.
    pub velocity: &'a Signal<Velocity>,
    /// Displacement, m, zero at contact.
    pub displacement: &'a Signal<Displacement>,
    /// Events of this motion.
    pub events: &'a CrashEvents,
    /// Impact speed v0, m/s; `None`: not known, and the velocity is the change of it from contact.
    pub impact_speed_m_per_s: Option<f64>,
    /// Test mass, kg, if known.
    pub mass_kg: Option<f64>,
}

/// The metrics of a pulse, always the same names in the same order; windows count from contact, t = 0. Of a record with
/// several impacts they are those of the [first event](first_event).
///
/// What needs the mass or the dynamic crush and has none says so. A lowest velocity at the last sample makes delta-v,
/// restitution and the energies of the rebound bounds, and they say so.
pub fn pulse_metrics(pulse: &Pulse<'_>) -> Result<Vec<Metric>, MetricsError> {
    same_grid(("the acceleration", pulse.acceleration), ("the velocity", pulse.velocity))?;
    same_grid(("the velocity", pulse.velocity), ("the displacement", pulse.displacement))?;
    let samples = pulse.events.samples_of_event(pulse.velocity.len());
    let pulse = &Pulse {
        acceleration: &pulse.acceleration.slice(0, samples).into(),
        velocity: &pulse.velocity.slice(0, samples).into(),
        displacement: &pulse.displacement.slice(0, samples).into(),
        ..*pulse
    };
    let (v0, mass) = (pulse.impact_speed_m_per_s.unwrap_or(0.0), pulse.mass_kg);
    let (crush, rebound) = (pulse.events.crush, pulse.events.rebound);
    let peak = peak(pulse.acceleration);
    let work = crush.map(|c| loading_work_per_kg(pulse.acceleration, pulse.displacement, &c)).transpose()?;

    let no_crush = match pulse.impact_speed_m_per_s {
        _ if crush.is_some() && rebound.is_some() => String::new(),
        None => "the impact speed is not stated".to_owned(),
        Some(0.0) => "the motion starts from rest".to_owned(),
        Some(_) => format!("the record ends at v = {:.3} m/s", pulse.events.end_velocity_m_per_s),
    };
    let metric = |definition: &Definition, value: Option<f64>| {
        let reason = match crush {
            _ if matches!(definition.unit, "J" | "N/m") && mass.is_none() => "the mass is not known",
            None => &no_crush,
            Some(_) => "not computable from this record",
        };
        Metric::of(definition, value, reason)
    };
    // What belongs to the loading phase, to one moment, to the stretch up to separation.
    let loading = |m: Metric| crush.map_or(m.clone(), |c| m.over(0.0, c.time_s));
    let contact = |m: Metric| rebound.map_or(m.clone(), |r| m.over(0.0, r.time_s));
    let is_cut = rebound.is_some_and(|r| r.still_separating);
    let lower = |m: Metric| match contact(m) {
        m if is_cut => m.as_lower_bound("lower bound: still separating at the end"),
        m => m,
    };
    let upper = |m: Metric| match contact(m) {
        m if is_cut => m.remarked("upper bound: still separating at the end"),
        m => m,
    };
    let at_crush = |m: Metric| crush.map_or(m.clone(), |c| m.over(c.time_s, c.time_s));

    let at_peak = peak.map(|p| p.time_s);
    let moment = |m: Metric| at_peak.map_or(m.clone(), |t| m.over(t, t));
    let returned = rebound.zip(mass).map(|(r, m)| kinetic_energy(m, r.velocity_m_per_s));
    let absorbed = rebound.zip(mass).map(|(r, m)| absorbed_energy(m, v0, r.velocity_m_per_s));
    // Equal to sqrt(2·E_abs/m), which needs no mass.
    let equivalent = rebound.map(|r| energy_equivalent_speed(1.0, absorbed_energy(1.0, v0, r.velocity_m_per_s)));
    let recovered = metric(&REBOUND_DISPLACEMENT, crush.zip(rebound).map(|(c, r)| c.displacement_m - r.displacement_m));
    let recovered = match crush.zip(rebound) {
        Some((c, r)) => recovered.over(c.time_s, r.time_s),
        None => recovered,
    };
    let delta_v = match (v0 == 0.0).then(|| largest_change(pulse)).flatten() {
        Some(change) => delta_v_from_rest(change, is_change_cut(pulse, change.1)),
        None => lower(metric(&DELTA_V, pulse.events.delta_v_m_per_s(v0))),
    };
    let delta_v = delta_v_of_unstopped(delta_v, pulse);
    let drift = match rebound {
        Some(r) => acceleration_after_separation(pulse.velocity, r.time_s),
        None => Metric::absent(&SEPARATION, &no_crush),
    };

    Ok(vec![
        moment(metric(&PEAK, peak.map(|p| p.acceleration_m_per_s2.abs()))),
        moment(metric(&TIME_OF_PEAK, at_peak)),
        at_crush(metric(&DYNAMIC_CRUSH, crush.map(|c| c.displacement_m))),
        at_crush(metric(&TIME_OF_CRUSH, crush.map(|c| c.time_s))),
        loading(metric(&CENTROID, crush.map(|c| centroid_time_from_crush(c.displacement_m, v0)))),
        loading(metric(&CENTROID_MOMENT, crush.and_then(|c| centroid_time_by_moment(pulse.acceleration, c.time_s)))),
        loading(metric(&CENTROID_RATIO, crush.map(|c| centroid_time_from_crush(c.displacement_m, v0) / c.time_s))),
        delta_v,
        lower(metric(&RESTITUTION, pulse.events.restitution(v0))),
        recovered,
        loading(metric(&ESW, crush.map(|c| equivalent_square_wave(v0, c.displacement_m)))),
        loading(metric(&ASW, crush.map(|c| average_square_wave(v0, c.time_s)))),
        loading(metric(&X_MEAN, crush.and_then(|c| mean_deceleration(pulse.velocity, 0.0, c.time_s)))),
        sliding_mean_of_velocity(pulse.velocity, 0.025, 0.0),
        olc(pulse.velocity, pulse.displacement, v0, OlcOptions::default())?,
        vpi(pulse.acceleration, VpiOptions::default()),
        loading(metric(&AVERAGE_STIFFNESS, crush.zip(mass).map(|(c, m)| average_stiffness(m, v0, c.displacement_m)))),
        metric(&IMPACT_ENERGY, pulse.impact_speed_m_per_s.zip(mass).map(|(v0, m)| kinetic_energy(m, v0)))
            .over(0.0, 0.0),
        upper(metric(&ABSORBED_ENERGY, absorbed)),
        lower(metric(&RETURNED_ENERGY, returned)),
        upper(metric(&LOSS_RATIO, pulse.events.restitution(v0).map(|e| 1.0 - e * e))),
        upper(metric(&EES, equivalent)),
        loading(metric(&CLOSURE, work.map(|w| w / (v0 * v0 / 2.0) - 1.0))),
        drift,
    ])
}

/// Delta-v of a motion that never reaches zero, with the end of its event as a remark; any other as it is.
fn delta_v_of_unstopped(delta_v: Metric, pulse: &Pulse<'_>) -> Metric {
    match pulse.events.unstopped {
        Some(unstopped) => {
            let (name, end_ms) = (unstopped.end.name(), 1e3 * unstopped.end_s);
            let not_stopped =
                if unstopped.end == EventEnd::Contact { "it goes on" } else { "the velocity never reaches zero" };
            let remark = format!("{not_stopped}, the event ends at {end_ms:.1} ms by {name}");
            let delta_v = delta_v.over(0.0, unstopped.time_s);
            match unstopped.end {
                EventEnd::Quiet | EventEnd::Contact => delta_v.remarked(&remark),
                EventEnd::Record => delta_v.as_lower_bound(&format!("{remark}: lower bound, it still changes there")),
            }
        }
        None => delta_v,
    }
}

/// Delta-v of a motion from rest: its largest velocity and when that is, with its direction as a remark.
fn delta_v_from_rest((change_m_per_s, time_s): (f64, f64), is_cut: bool) -> Metric {
    let way = if change_m_per_s < 0.0 { "rearward" } else { "forward" };
    let remark = format!("{way}, the largest change from time zero");
    let delta_v = Metric::with_value(&DELTA_V, change_m_per_s.abs()).over(0.0, time_s).remarked(&remark);
    if is_cut { delta_v.as_lower_bound("lower bound: it still changes at the end of the record") } else { delta_v }
}

/// Whether the first event is not over where the record ends, and its largest velocity is that of the last sample.
fn is_change_cut(pulse: &Pulse<'_>, time_s: f64) -> bool {
    let impacts = &pulse.events.impacts;
    first_event(impacts).is_some_and(|k| !impacts[k].is_whole) && time_s >= pulse.velocity.end_s()
}

/// The largest velocity of a motion from rest from contact to the end of its [first event](first_event), signed, m/s,
/// and its time, s from contact.
///
/// For a vehicle that rebounds from a barrier it is the delta-v of the motion with its impact speed, v0 - v_s, whatever
/// that speed is. What noise, drag or the next impact do after the end moves neither.
fn largest_change(pulse: &Pulse<'_>) -> Option<(f64, f64)> {
    let (v, first) = (pulse.velocity.samples(), pulse.velocity.index_at_or_after(0.0));
    let impacts = &pulse.events.impacts;
    let end = first_event(impacts).map_or(v.len(), |k| impacts[k].samples[1] + 1);
    let largest = first + index_of_largest(v.get(first..end).filter(|v| !v.is_empty())?);
    Some((v[largest], pulse.velocity.time_s(largest)))
}

/// Rise time of a pulse, s: from the last sample below 10 % of its peak before it to the first at 90 %, both
/// interpolated linearly. The window begins with the onset.
///
/// `to_s`: end of the pulse. A pulse that is above 10 % at contact, or an empty one, has none.
pub fn rise_time(acceleration: &Signal<Acceleration>, to_s: f64) -> Metric {
    let none = || Metric::absent(&RISE_TIME, "the pulse does not rise from 10 % to 90 % of its peak after contact");
    let (from, to) = (acceleration.index_at_or_after(0.0), acceleration.index_at_or_after(to_s) + 1);
    let a = acceleration.samples().get(from..to.min(acceleration.len())).unwrap_or_default();
    let largest = index_of_largest(a);
    let Some(peak) = a.get(largest).copied().filter(|peak| *peak != 0.0) else { return none() };
    let share = |k: usize| a[k] / peak;
    let crossing = |k: usize, level: f64| {
        let before = share(k - 1);
        acceleration.time_s(from + k - 1) + acceleration.dt_s() * (level - before) / (share(k) - before)
    };
    let Some(below) = (0..largest).rfind(|k| share(*k) < 0.1) else { return none() };
    let Some(high) = (below + 1..=largest).find(|k| share(*k) >= 0.9) else { return none() };
    let (onset_s, high_s) = (crossing(below + 1, 0.1), crossing(high, 0.9));
    Metric::with_value(&RISE_TIME, high_s - onset_s).over(onset_s, high_s)
}

/// The sample of largest magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its acceleration with its sign, m/s².
    pub acceleration_m_per_s2: f64,
    /// Its time on the signal's own axis, s.
    pub time_s: f64,
}

/// The sample of largest |a|, the earliest of equals; `None` without samples.
///
/// Not interpolated: the true peak of a signal between two samples is higher by at most `T²·max|a''|/8`.
/// State the channel frequency class beside it, the peak of an unfiltered channel is mostly ringing.
pub fn peak(acceleration: &Signal<Acceleration>) -> Option<Peak> {
    let a = acceleration.samples();
    let index = index_of_largest(a);
    Some(Peak { acceleration_m_per_s2: *a.get(index)?, time_s: acceleration.time_s(index) })
}

/// Index of the sample of largest magnitude, the earliest of equals; 0 without samples.
fn index_of_largest(samples: &[f64]) -> usize {
    // The maximum alone is found in several lanes at once; where it is, in a second pass up to there.
    let mut lanes = [0.0_f64; 8];
    let chunks = samples.chunks_exact(lanes.len());
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            let size = value.abs();
            *lane = if size > *lane { size } else { *lane };
        }
    }
    let largest = rest.iter().map(|value| value.abs()).chain(lanes).fold(0.0, f64::max);
    samples.iter().position(|value| value.abs() == largest).unwrap_or(0)
}

/// Mean deceleration over `from_s ..= to_s`, m/s², positive when braking: `(v(from) - v(to))/(to - from)` ("x-mean").
///
/// From the velocity with linear interpolation, never a mean of samples: that one depends on where the samples
/// fall. Times are on the signal's own axis; `None` if they are out of order or outside the record.
pub fn mean_deceleration(velocity: &Signal<Velocity>, from_s: f64, to_s: f64) -> Option<f64> {
    if from_s >= to_s {
        return None;
    }
    Some((velocity.at(from_s)? - velocity.at(to_s)?) / (to_s - from_s))
}

/// Centroid time t_c = C/v0 of the loading pulse, s.
///
/// Exact where velocity and displacement are consistent: `∫ t·a dt / ∫ a dt` over 0..t_m, by parts with v(t_m) = 0.
/// Huang, *Vehicle Crash Mechanics* (2002).
pub fn centroid_time_from_crush(dynamic_crush_m: f64, impact_speed_m_per_s: f64) -> f64 {
    dynamic_crush_m / impact_speed_m_per_s
}

/// Centroid time as the first moment of the pulse, `∫ t·a dt / ∫ a dt` from the first sample to `until_s`, s.
///
/// Trapezoid with a interpolated at `until_s`, error O(T²). With a motion from the same acceleration it equals by parts
/// what its velocities and displacements at both ends say, and [`centroid_time_from_crush`] where it begins at contact
/// with the impact speed: a gap above 0.1 % from the former says that the sampling or the rule is too crude for the
/// pulse. `None` if the pulse has no area or `until_s` lies outside the record.
pub fn centroid_time_by_moment(acceleration: &Signal<Acceleration>, until_s: f64) -> Option<f64> {
    let a_end = acceleration.at(until_s)?;
    let (mut area, mut moment) = (0.0, 0.0);
    let mut previous: Option<(f64, f64)> = None;
    let before_end = acceleration.samples().iter().enumerate().map(|(k, &a)| (acceleration.time_s(k), a));
    for (t, a) in before_end.take_while(|(t, _)| *t < until_s).chain(std::iter::once((until_s, a_end))) {
        if let Some((t_before, a_before)) = previous {
            area += (t - t_before) * (a_before + a) / 2.0;
            moment += (t - t_before) * (t_before * a_before + t * a) / 2.0;
        }
        previous = Some((t, a));
    }
    let centroid = moment / area;
    centroid.is_finite().then_some(centroid)
}

/// Equivalent square wave by displacement, ESW = v0²/(2C), m/s²: the constant deceleration with the same crush.
pub fn equivalent_square_wave(impact_speed_m_per_s: f64, dynamic_crush_m: f64) -> f64 {
    impact_speed_m_per_s * impact_speed_m_per_s / (2.0 * dynamic_crush_m)
}

/// Average square wave by time, ASW = v0/t_m, m/s²: the constant deceleration that stops in the same time.
pub fn average_square_wave(impact_speed_m_per_s: f64, time_of_dynamic_crush_s: f64) -> f64 {
    impact_speed_m_per_s / time_of_dynamic_crush_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crash_events;

    fn metrics_of(mass_kg: Option<f64>, v: Vec<f64>, everywhere_m: f64) -> Vec<Metric> {
        let grid = |samples| Signal::<Velocity>::new(0.0, 0.5, samples).unwrap();
        let a = Signal::new(0.0, 0.5, vec![-2.0; v.len()]).unwrap();
        let x = Signal::new(0.0, 0.5, vec![everywhere_m; v.len()]).unwrap();
        let velocity = grid(v);
        let events = crash_events(&velocity, &x).unwrap();
        pulse_metrics(&Pulse {
            acceleration: &a,
            velocity: &velocity,
            displacement: &x,
            events: &events,
            impact_speed_m_per_s: Some(4.0),
            mass_kg,
        })
        .unwrap()
    }

    fn find<'a>(metrics: &'a [Metric], name: &str) -> &'a Metric {
        metrics.iter().find(|m| m.name == name).unwrap()
    }

    #[test]
    fn the_rise_of_a_triangle_is_four_fifths_of_the_way_to_its_peak() {
        let at = |k: i32| -2.0 * (f64::from(k.min(80 - k)).max(0.0));
        let pulse = Signal::new(-0.01, 1e-3, (-10..100).map(at).collect()).unwrap();
        let rise = rise_time(&pulse, 0.08);
        let window = rise.window.unwrap();
        // 40 ms up: from 4 to 36 ms, all of it straight.
        assert!((rise.value.unwrap() - 0.032).abs() < 1e-12 && (window.from_s - 0.004).abs() < 1e-12, "{rise:?}");
        assert_eq!(rise_time(&pulse, -1.0).value, None);
        assert_eq!(rise_time(&Signal::new(0.0, 1e-3, vec![3.0; 9]).unwrap(), 1.0).value, None);
    }

    #[test]
    fn what_the_record_does_not_show_is_absent_with_its_reason() {
        let metrics = metrics_of(Some(900.0), vec![4.0, 3.0, 2.0], 0.0);
        let crush = find(&metrics, "dynamic_crush");
        assert_eq!((crush.value, crush.definition.as_str()), (None, "absent: the record ends at v = 2.000 m/s"));
        assert_eq!(find(&metrics, "peak_acceleration").value, Some(2.0));
        assert_eq!(find(&metrics, "delta_v").value, None, "2 m/s a second are no impact");
    }

    #[test]
    fn a_velocity_that_never_reaches_zero_has_its_change_and_says_where_the_event_ends() {
        // 9 m/s in 45 ms, then free.
        let v: Vec<f64> = (0..200).map(|k| 15.0 - 0.2 * f64::from(k).min(45.0)).collect();
        let of = |v: Vec<f64>| {
            let grid = |samples| Signal::<Velocity>::new(0.0, 1e-3, samples).unwrap();
            let n = v.len();
            let x = Signal::new(0.0, 1e-3, vec![0.1; n]).unwrap();
            let velocity = grid(v);
            let events = crash_events(&velocity, &x).unwrap();
            let acceleration = Signal::new(0.0, 1e-3, vec![-2.0; n]).unwrap();
            let metrics = pulse_metrics(&Pulse {
                acceleration: &acceleration,
                velocity: &velocity,
                displacement: &x,
                events: &events,
                impact_speed_m_per_s: Some(15.0),
                mass_kg: None,
            });
            find(&metrics.unwrap(), "delta_v").clone()
        };
        let delta_v = of(v.clone());
        assert!((delta_v.value.unwrap() - 9.0).abs() < 1e-12, "{delta_v:?}");
        assert!((delta_v.window.unwrap().to_s - 0.045).abs() < 1e-12, "{delta_v:?}");
        // 0.2 m/s are lost in the millisecond from 44 ms on, less than 0.222.
        let said = "the event ends at 64.0 ms by 20 ms with no more than 0.8 km/h (49 CFR 563)";
        assert!(delta_v.definition.ends_with(said), "{}", delta_v.definition);
        let cut = of(v[..40].to_vec());
        assert!((cut.value.unwrap() - 7.8).abs() < 1e-12, "{cut:?}");
        assert!(cut.definition.ends_with("by end of the record: lower bound, it still changes there"), "{cut:?}");
    }

    #[test]
    fn every_value_has_a_window_and_a_motion_from_rest_says_that_it_is_one() {
        let metrics = metrics_of(Some(900.0), (0..=80).map(|k| 4.0 - 0.1 * f64::from(k)).collect(), 0.5);
        assert!(metrics.iter().any(|m| m.name == "rebound_displacement" && m.value.is_some()));
        for metric in metrics {
            assert_eq!(metric.value.is_some(), metric.window.is_some(), "{metric:?}");
        }
    }

    #[test]
    fn without_a_mass_energy_and_stiffness_say_so() {
        let metrics = metrics_of(None, vec![1.0, 0.0, -1.0], 0.0);
        for name in ["average_stiffness", "impact_energy", "energy_absorbed"] {
            assert_eq!(find(&metrics, name).definition, "absent: the mass is not known");
        }
    }

    #[test]
    fn no_value_is_infinite_or_nan_where_the_crush_is_zero() {
        let metrics = metrics_of(Some(900.0), vec![1.0, 0.0, -1.0], -0.25);
        assert_eq!(find(&metrics, "equivalent_square_wave").value, None);
        assert!(metrics.iter().all(|m| m.value.is_none_or(f64::is_finite)));
    }

    #[test]
    fn takes_the_larger_magnitude_and_the_earlier_of_equals() {
        let signal = Signal::new(0.0, 1.0, vec![3.0, -5.0, 5.0, -5.0]).unwrap();
        assert_eq!(peak(&signal), Some(Peak { acceleration_m_per_s2: -5.0, time_s: 1.0 }));
        assert_eq!(peak(&Signal::new(0.0, 1.0, vec![]).unwrap()), None);
        for at in [0, 7, 8, 40, 41] {
            let mut samples: Vec<f64> = (0..42).map(|k| (f64::from(k)).sin()).collect();
            samples[at] = -2.0;
            assert_eq!(index_of_largest(&samples), at);
        }
    }

    #[test]
    fn interpolates_the_velocity_at_both_ends() {
        let v = Signal::new(0.0, 1.0, vec![10.0, 8.0, 2.0]).unwrap();
        assert_eq!(mean_deceleration(&v, 0.5, 1.5), Some(4.0));
        assert_eq!(mean_deceleration(&v, 0.5, 2.5), None);
        assert_eq!(mean_deceleration(&v, 1.0, 1.0), None);
    }

    #[test]
    fn a_constant_pulse_has_its_centroid_in_the_middle() {
        let a = Signal::new(0.0, 0.5, vec![-4.0; 9]).unwrap();
        assert_eq!(centroid_time_by_moment(&a, 3.0), Some(1.5));
        assert_eq!(centroid_time_by_moment(&a, 9.0), None);
    }

    #[test]
    fn a_signal_of_zeros_has_no_centroid() {
        assert_eq!(centroid_time_by_moment(&Signal::new(0.0, 0.5, vec![0.0; 9]).unwrap(), 3.0), None);
    }
}
