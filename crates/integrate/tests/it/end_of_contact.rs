//! Separation is where the force of a contact ends: what drags, hits or shakes the vehicle later moves no event.

use crumple_integrate::{Uncertainty, events_within, propagate};
use crumple_metrics::CrashEvents;
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::{
    Acceleration, Distribution, IntegrationRule, IntegrationSettings, IntegrationStart, Motion,
    STANDARD_GRAVITY_M_PER_S2 as G, Signal, Spread, integrate,
};

const DT_S: f64 = 1e-4;
/// 50 km/h.
const V0_M_PER_S: f64 = 50.0 / 3.6;

/// A vehicle of 1200 kg on a spring of 560 kN/m that unloads on a stiffer one: crush 642.9 mm at 72.71 ms.
struct Vehicle {
    restitution: f64,
    /// Acceleration from separation on, m/s².
    drag: f64,
    /// Standard deviation of white noise, m/s².
    noise: f64,
    /// Start, length and change of velocity of a half sine after it.
    second: Option<[f64; 3]>,
}

impl Vehicle {
    const OMEGA: f64 = 21.602_468_994_692_866;

    fn separation_s(&self) -> f64 {
        // A quarter of a period of each spring; their speeds are those of equal force.
        std::f64::consts::FRAC_PI_2 * (1.0 + self.restitution) / Self::OMEGA
    }

    fn acceleration(&self, seed: u64) -> Signal<Acceleration> {
        use std::f64::consts::{FRAC_PI_2, PI};
        let mut random = RandomNumbers::of_stream(seed, 0);
        let (stop, end, peak) = (FRAC_PI_2 / Self::OMEGA, self.separation_s(), V0_M_PER_S * Self::OMEGA);
        let at = |k: i32| {
            let t = f64::from(k) * DT_S - 0.1;
            let contact = match t {
                t if t < 0.0 => 0.0,
                t if t < stop => -peak * (Self::OMEGA * t).sin(),
                t if t < end => -peak * (FRAC_PI_2 * (t - stop) / (end - stop)).cos(),
                _ => self.drag,
            };
            let second = self.second.filter(|[start, length, _]| (*start..start + length).contains(&t));
            let second = second
                .map_or(0.0, |[start, length, change]| change / length * FRAC_PI_2 * (PI * (t - start) / length).sin());
            contact + second + self.noise * random.normal()
        };
        Signal::new(-0.1, DT_S, (0..7000).map(at).collect()).unwrap()
    }
}

fn motion(a: &Signal<Acceleration>, v0: f64) -> (Motion, IntegrationSettings) {
    let settings = IntegrationSettings {
        rule: IntegrationRule::Trapezoid,
        start: IntegrationStart::TimeZero,
        impact_speed_m_per_s: v0,
        low_pass_filtered: false,
    };
    (integrate(a, &settings).unwrap(), settings)
}

fn events(a: &Signal<Acceleration>, v0: f64, speed_error: f64) -> CrashEvents {
    events_within(&motion(a, v0).0, v0, speed_error).unwrap()
}

#[test]
fn restitution_and_delta_v_are_those_of_the_contact_whatever_comes_after_it() {
    for restitution in [0.05, 0.1, 0.2, 0.3, 0.4] {
        for drag in [0.0, -0.05, 0.05, -0.3, 0.3] {
            for noise in [0.0, 0.02, 0.1] {
                for second in [None, Some([0.25, 0.08, -6.0]), Some([0.4, 0.06, -8.0]), Some([0.4, 0.06, 8.0])] {
                    let vehicle = Vehicle { restitution, drag: drag * G, noise: noise * G, second };
                    let found = events(&vehicle.acceleration(1), V0_M_PER_S, 0.0);
                    let case = format!("e {restitution}, drag {drag} g, noise {noise} g, then {second:?}: {found:?}");
                    let (crush, rebound) = (found.crush.unwrap(), found.rebound.unwrap());
                    // Noise of 0.1 g is 0.001 m/s and 0.05 mm after 73 ms; the trapezoid at 10 kHz is nearer.
                    assert!((crush.displacement_m - 0.642_930_6).abs() < 2e-4, "{case}");
                    assert!((crush.time_s - 0.072_713_7).abs() < 5e-5, "{case}");
                    assert!(!rebound.still_separating, "{case}");
                    // What a drag of 0.3 g does in the 5 ms in which the end of the force is not known.
                    let slack = 0.003 + 0.005 * vehicle.drag.abs() / V0_M_PER_S;
                    assert!((found.restitution(V0_M_PER_S).unwrap() - restitution).abs() < slack, "{case}");
                    let delta_v = found.delta_v_m_per_s(V0_M_PER_S).unwrap() / V0_M_PER_S;
                    assert!((delta_v - 1.0 - restitution).abs() < slack, "{case}");
                    assert!((rebound.time_s - vehicle.separation_s()).abs() < 0.005, "{case}");
                    assert_eq!(found.impacts.len(), 1 + usize::from(second.is_some()), "{case}");
                }
            }
        }
    }
}

/// A haversine that takes `change` off in `length_s`, with noise.
fn haversine(change: f64, length_s: f64, noise: f64, seed: u64) -> Signal<Acceleration> {
    let mut random = RandomNumbers::of_stream(seed, 0);
    let at = |k: i32| {
        let t = f64::from(k) * DT_S - 0.1;
        let inside = (0.0..length_s).contains(&t);
        let pulse = if inside { 1.0 - (std::f64::consts::TAU * t / length_s).cos() } else { 0.0 };
        -change / length_s * pulse + noise * random.normal()
    };
    Signal::new(-0.1, DT_S, (0..7000).map(at).collect()).unwrap()
}

#[test]
fn the_duration_of_a_pulse_does_not_hang_on_its_noise() {
    for length_s in [0.06, 0.1, 0.15] {
        for noise in [0.0, 0.03, 0.1, 0.3] {
            for seed in 0..12 {
                let found = events(&haversine(20.0 / 3.6, length_s, noise * G, seed), 0.0, 0.0);
                let [impact] = found.impacts.as_slice() else { panic!("{length_s} {noise} {seed}: {found:?}") };
                let case = format!("{length_s} s, {noise} g, {seed}: {impact:?}");
                assert!((impact.end_s - length_s).abs() < 0.1 * length_s && impact.is_whole, "{case}");
                // White noise of 0.3 g over 100 ms is 0.01 m/s.
                assert!((impact.change_m_per_s + 20.0 / 3.6).abs() < 0.02 + 0.1 * noise, "{case}");
            }
        }
    }
}

#[test]
fn a_stop_within_the_error_of_the_speed_is_a_stop() {
    let v0 = 56.0 / 3.6;
    let stated = 0.1 / 3.6;
    for short in [0.0, 0.02, 0.05, 0.09] {
        for length_s in [0.08, 0.1, 0.12] {
            let a = haversine(v0 - short / 3.6, length_s, 0.02 * G, 1);
            let found = events(&a, v0, stated);
            let case = format!("short by {short} km/h in {length_s} s: {found:?}");
            let crush = found.crush.unwrap();
            // Half of the length at the impact speed, by symmetry.
            assert!((crush.displacement_m - 0.5 * v0 * length_s).abs() < 0.002, "{case}");
            assert!(crush.time_s > 0.85 * length_s && crush.time_s < length_s + 0.003, "{case}");
            assert!((3.6 * found.delta_v_m_per_s(v0).unwrap() - 56.0 + short).abs() < 0.03, "{case}");
            assert!(found.restitution(v0).unwrap() < 0.002 && found.unstopped.is_none(), "{case}");
        }
    }
    // More than the error is left: the vehicle goes on.
    let goes_on = events(&haversine(v0 - 0.5 / 3.6, 0.1, 0.0, 1), v0, stated);
    assert!(goes_on.crush.is_none() && goes_on.unstopped.is_some());
}

#[test]
fn the_crush_of_a_vehicle_that_stops_dead_has_an_interval() {
    let v0 = 56.0 / 3.6;
    let spread = |size: f64| Some(Spread { size, distribution: Distribution::Uniform });
    let uncertainty = Uncertainty {
        impact_speed_m_per_s: spread(0.1 / 3.6),
        zero_level_m_per_s2: spread(0.05 * G),
        gain: spread(0.01),
        contact_s: None,
        earlier_by_s: 0.0,
        lost_s: None,
        zero_shift: None,
        replicates: 60,
        seed: 1,
    };
    for short in [0.0, 0.05] {
        let a = haversine(v0 - short / 3.6, 0.1, 0.02 * G, 1);
        let (motion, settings) = motion(&a, v0);
        let intervals = propagate(&a, &motion, &settings, None, None, &uncertainty, |_| ());
        let crush = intervals.events[0].unwrap();
        assert!(crush.low < 0.7775 && crush.high > 0.7775 && crush.high - crush.low < 0.04, "{short}: {crush:?}");
    }
}
