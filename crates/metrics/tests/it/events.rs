//! Instants and events on grids that begin before contact, at it and after it: worked by hand, on coarse grids whose
//! numbers are exact.

use crumple_metrics::{
    EventEnd, ThresholdRule, acceleration_after_separation, collision, crash_events, event_end_by_velocity_change,
    time_zero_by_threshold, time_zero_by_velocity_change, unstopped,
};
use crumple_signal::{Signal, Velocity};

fn velocity(t0_s: f64, dt_s: f64, samples: &[f64]) -> Signal<Velocity> {
    Signal::new(t0_s, dt_s, samples.to_vec()).unwrap()
}

/// Two vehicles head on: their relative velocity is 20, 14, 6, -3, -5, -4 m/s from contact on.
const FIRST: [f64; 8] = [12.0, 12.0, 12.0, 8.0, 4.0, 2.0, 1.0, 1.0];
const SECOND: [f64; 7] = [8.0, 8.0, 6.0, 2.0, -5.0, -6.0, -5.0];

#[test]
fn a_collision_on_a_coarse_grid_is_that_worked_by_hand() {
    let (first, second) = (velocity(-0.5, 0.25, &FIRST), velocity(-0.25, 0.25, &SECOND));
    let impact = collision(&first, &second).unwrap();
    let common = impact.common.unwrap();
    assert_eq!((impact.same_heading, impact.closing_speed_m_per_s), (false, 20.0));
    // Zero two thirds of an interval after 0.5 s; 0.25·17 + 0.25·10 m, and a triangle of 6 m/s.
    assert!((common.time_s - 2.0 / 3.0).abs() < 1e-15 && (common.relative_crush_m - 7.25).abs() < 1e-14);
    assert!((common.velocity_m_per_s - (4.0 - 4.0 / 3.0)).abs() < 1e-14);
    assert_eq!((impact.restitution, impact.changes_m_per_s), (Some(0.25), [-10.0, 13.0]));
    // Both without what lies before contact.
    let cut = collision(&velocity(0.0, 0.25, &FIRST[2..]), &velocity(0.0, 0.25, &SECOND[1..]));
    assert_eq!(cut, Some(impact));
}

#[test]
fn a_common_velocity_on_a_sample_is_that_sample() {
    let (first, second) = ([10.0, 6.0, 4.0, 3.0, 3.0], [0.0, 3.0, 4.0, 5.0, 5.0]);
    let impact = collision(&velocity(0.0, 0.5, &first), &velocity(0.0, 0.5, &second)).unwrap();
    let common = impact.common.unwrap();
    assert_eq!((common.time_s, common.velocity_m_per_s, common.relative_crush_m), (1.0, 4.0, 4.0));
    assert_eq!((impact.same_heading, impact.changes_m_per_s, impact.restitution), (true, [-6.0, 4.0], Some(0.2)));
    let shortest = collision(&velocity(0.0, 0.5, &first[..2]), &velocity(0.0, 0.5, &second[..2])).unwrap();
    assert_eq!((shortest.common, shortest.changes_m_per_s), (None, [-4.0, 3.0]));
    for (t0_s, left) in [(-2.5, "no sample is left"), (-2.0, "one sample is left")] {
        assert_eq!(collision(&velocity(t0_s, 0.5, &first), &velocity(t0_s, 0.5, &second)), None, "{left}");
    }
}

#[test]
fn the_heading_is_told_by_the_largest_change_the_first_of_equals() {
    // Later the first is pushed on: by less than it lost, or by as much.
    for later in [14.0, 16.0] {
        let first = [10.0, 6.0, 4.0, 5.0, later, later];
        let second = [8.0, 4.0, 2.0, 2.0, 2.0, 2.0];
        let impact = collision(&velocity(0.0, 0.5, &first), &velocity(0.0, 0.5, &second)).unwrap();
        assert!(!impact.same_heading, "{later}");
    }
}

#[test]
fn vehicles_on_grids_that_do_not_meet_are_not_compared() {
    let first = velocity(-0.5, 0.25, &FIRST);
    for (t0_s, dt_s) in [(-0.125, 0.25), (-0.24, 0.25), (-1.0, 0.5), (-0.5, 0.2501), (-0.375, 0.25)] {
        assert_eq!(collision(&first, &velocity(t0_s, dt_s, &SECOND)), None, "{t0_s} {dt_s}");
    }
    // An axis whose samples are a quarter of an interval off contact, and one that begins five intervals later.
    let (off, later) = (velocity(-1.1875, 0.25, &FIRST), velocity(0.0625, 0.25, &[12.0, 2.0]));
    assert!(collision(&off, &later).is_none_or(|impact| impact.common.is_none()));
    let (off, same) = (velocity(0.0625, 0.25, &FIRST[2..]), velocity(0.0625, 0.25, &SECOND[1..]));
    assert!(collision(&off, &same).unwrap().common.is_some());
    let longer = [&[8.0; 6][..], &SECOND].concat();
    assert!(collision(&velocity(0.0625, 0.25, &FIRST[2..]), &velocity(-1.4375, 0.25, &longer)).is_some());
}

#[test]
fn crush_and_rebound_count_from_contact_and_every_later_zero_is_listed_once() {
    let v = [4.0, 4.0, 2.0, -2.0, -2.0, 0.0, 0.0, 2.0, -2.0, -1.0, 1.0];
    let x = [0.0, 1.0, 3.0, 3.0, 2.0, 1.5, 1.5, 2.0, 2.0, 1.0, 1.0];
    let displacement = Signal::new(-0.5, 0.5, x.to_vec()).unwrap();
    let events = crash_events(&velocity(-0.5, 0.5, &v), &displacement).unwrap();
    let (crush, rebound) = (events.crush.unwrap(), events.rebound.unwrap());
    // Halfway between 0.5 and 1 s: 3 m and a triangle of 2 m/s.
    assert_eq!((crush.time_s, crush.displacement_m, crush.index), (0.75, 3.25, 3));
    assert_eq!((rebound.velocity_m_per_s, rebound.time_s, rebound.displacement_m), (-2.0, 1.0, 3.0));
    assert!(!rebound.still_separating);
    assert_eq!(events.later_zeros_s, [2.0, 3.25, 4.25]);
    assert_eq!((events.time_of_delta_v_s(), events.delta_v_m_per_s(4.0)), (Some(1.0), Some(6.0)));
}

#[test]
fn a_motion_from_rest_has_no_crush_and_one_that_stops_dead_does_not_separate() {
    let zeros = |n: usize| Signal::new(0.0, 0.5, vec![0.0; n]).unwrap();
    let backwards = crash_events(&velocity(0.0, 0.5, &[0.0, -1.0, -2.0]), &zeros(3)).unwrap();
    assert_eq!((backwards.crush, backwards.time_of_delta_v_s()), (None, None));
    let dead = crash_events(&velocity(0.0, 0.5, &[4.0, 2.0, 0.0]), &zeros(3)).unwrap();
    assert!(!dead.rebound.unwrap().still_separating);
    assert!(dead.restitution(4.0).unwrap().is_sign_positive());
    let going = crash_events(&velocity(0.0, 0.5, &[4.0, 2.0, -1.0]), &zeros(3)).unwrap();
    assert!(going.rebound.unwrap().still_separating);
}

#[test]
fn twenty_milliseconds_must_be_left_after_separation() {
    let v: Vec<f64> = (0..=500).map(|k| -1.0 + 0.01 * f64::from(k)).collect();
    let v = velocity(0.0, 1e-4, &v);
    let drift = acceleration_after_separation(&v, 0.03);
    // 0.01 m/s in 0.1 ms; differences of decimal numbers.
    assert!((drift.value.unwrap() - 100.0).abs() < 1e-9);
    assert_eq!(acceleration_after_separation(&v, 0.03005).value, None);
}

#[test]
fn a_threshold_is_held_for_a_part_of_a_sample_too() {
    // Four and five samples above: three and four intervals of 1 ms.
    for (samples, hold_s, holds) in [(4, 0.003, true), (4, 0.0035, false), (5, 0.0035, true), (3, 0.003, false)] {
        let mut a = vec![0.0; 60];
        a[20..20 + samples].fill(-10.0);
        let rule = ThresholdRule { threshold_m_per_s2: 5.0, hold_s };
        let found = time_zero_by_threshold(&Signal::new(0.0, 1e-3, a).unwrap(), rule);
        assert_eq!(found.value.is_some(), holds, "{samples} {hold_s}");
    }
    // Above from the first sample on, of a record that is as long as the hold.
    let rule = ThresholdRule { threshold_m_per_s2: 5.0, hold_s: 0.003 };
    assert_eq!(time_zero_by_threshold(&Signal::new(0.5, 1e-3, vec![6.0; 4]).unwrap(), rule).value, Some(0.5));
}

#[test]
fn the_rule_of_recorders_finds_start_and_end() {
    // 11.2 m/s² take 0.224 m/s off in 20 ms, in 19 ms 0.2128: the first that reach all of it begin at 99.5 ms or later.
    let a: Vec<f64> = (0..300).map(|k| if (100..200).contains(&k) { -11.2 } else { 0.0 }).collect();
    let a = Signal::new(1.0, 1e-3, a).unwrap();
    let start = time_zero_by_velocity_change(&a);
    let window = start.window.unwrap();
    assert!((start.value.unwrap() - 1.1).abs() < 1e-12, "{start:?}");
    assert!((window.to_s - window.from_s - 0.02).abs() < 1e-12);
    // From within the pulse: its last 20 ms begin at 179 ms.
    assert!((event_end_by_velocity_change(&a, 1.12).unwrap() - 1.18).abs() < 1e-12);
    assert_eq!(event_end_by_velocity_change(&a, 1.0), Some(1.0), "before it, nothing changes");
    assert_eq!(event_end_by_velocity_change(&a, 1.29), None, "no 20 ms are left");
}

/// 15 m/s, less what is lost at each of the samples; 1 kHz from `t0_s` on.
fn steps(t0_s: f64, n: usize, lost: &[(usize, f64)]) -> Signal<Velocity> {
    let at = |k: usize| 15.0 - lost.iter().filter(|(at, _)| k >= *at).map(|(_, loss)| loss).sum::<f64>();
    velocity(t0_s, 1e-3, &(0..n).map(at).collect::<Vec<f64>>())
}

#[test]
fn an_event_of_one_blow_ends_20_ms_after_it() {
    let event = unstopped(&steps(-0.01, 200, &[(50, 5.0)])).unwrap();
    assert_eq!((event.velocity_m_per_s, event.end), (10.0, EventEnd::Quiet));
    // The blow is at sample 50, contact at 10; the first 20 ms without it begin on it.
    assert!((event.time_s - 0.04).abs() < 1e-12 && (event.end_s - 0.06).abs() < 1e-12, "{event:?}");
    let twice = unstopped(&steps(0.0, 300, &[(50, 3.0), (150, 3.0)])).unwrap();
    assert_eq!(twice.velocity_m_per_s, 12.0, "of two equal blows the first is the event");
    let shortest = unstopped(&steps(0.0, 21, &[(10, 3.0)])).unwrap();
    assert_eq!((shortest.velocity_m_per_s, shortest.end), (12.0, EventEnd::Record));
}

#[test]
fn the_lowest_velocity_is_looked_for_up_to_the_end_of_the_event_and_no_sample_further() {
    // After the blow 0.008 m/s are lost in each millisecond, 0.16 in 20.
    let at = |k: usize| if k < 50 { 15.0 } else { 10.0 - 0.0078125 * (k - 50) as f64 };
    let event = unstopped(&velocity(0.0, 1e-3, &(0..200).map(at).collect::<Vec<f64>>())).unwrap();
    assert!((event.end_s - 0.07).abs() < 1e-12 && (event.time_s - 0.07).abs() < 1e-12, "{event:?}");
    assert_eq!(event.velocity_m_per_s, 10.0 - 0.0078125 * 20.0);
}
