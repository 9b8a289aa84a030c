//! A pulse with several impacts: which of them the record is made to be of.

use std::fmt::Write as _;

use crumple_ingest::Ingested;

use super::{given, notes, read_as};

const DT_S: f64 = 1e-4;

/// A table in g at 10 kHz from -100 ms on: half sines (start, length, km/h taken off) and a little noise.
fn table(pulses: &[(f64, f64, f64)]) -> String {
    let mut text = "time [s],acceleration [g]\n".to_owned();
    for k in 0..6000 {
        let t = f64::from(k) * DT_S - 0.1;
        let of = |(start, length, km_per_h): &(f64, f64, f64)| {
            let inside = (*start..start + length).contains(&t);
            let mean = km_per_h / 3.6 / length / 9.806_65;
            if inside {
                -mean * std::f64::consts::FRAC_PI_2 * (std::f64::consts::PI * (t - start) / length).sin()
            } else {
                0.0
            }
        };
        // Two tones without a mean, as large as a quiet sensor's noise.
        let noise = 0.02 * (0.7 * f64::from(k)).sin() + 0.01 * (2.1 * f64::from(k)).sin();
        writeln!(text, "{t:.4},{:.5}", pulses.iter().map(of).sum::<f64>() + noise).unwrap();
    }
    text
}

fn taken(pulses: &[(f64, f64, f64)], flags: &str) -> Ingested {
    read_as("crash.csv", table(pulses), &given(flags)).unwrap()
}

fn speed_km_per_h(ingested: &Ingested) -> f64 {
    3.6 * ingested.test.impact_speed_m_per_s.unwrap()
}

#[test]
fn a_post_and_then_a_wall_are_two_impacts_and_the_wall_stops_the_vehicle() {
    for post_km_per_h in [5.0, 10.0, 15.0] {
        for wall_s in [0.08, 0.1, 0.2] {
            let pulses = [(0.0, 0.03, post_km_per_h), (wall_s, 0.1, 1.1 * (50.0 - post_km_per_h))];
            let wall = taken(&pulses, "--mass 1200kg --impact-speed 50km/h");
            let case = format!("post {post_km_per_h} km/h, wall at {wall_s} s: {}", notes(&wall));
            assert!((speed_km_per_h(&wall) - 50.0 + post_km_per_h).abs() < 0.1, "{case}");
            assert!(notes(&wall).contains("the pulse holds 2 impacts: impact 1 takes"), "{case}");
            assert!(notes(&wall).contains("Impact 2 is taken, because it stops the vehicle"), "{case}");
            // Contact is at t = 0 to a millisecond, 30 ms after the post the record begins.
            let pulse = wall.pulse().unwrap();
            assert!((pulse.samples.t0_s() - (0.03 - wall_s)).abs() < 0.005, "{case}");
            assert!((pulse.samples.end_s() - (0.5 - wall_s)).abs() < 0.002, "{case}");
            let first = taken(&pulses, "--mass 1200kg --impact-speed 50km/h --impact 1");
            assert_eq!((first.pulse().unwrap().samples.t0_s(), speed_km_per_h(&first).round()), (-0.1, 50.0));
            let asked = taken(&pulses, "--mass 1200kg --impact-speed 50km/h --impact 2");
            assert!(notes(&asked).contains("Impact 2 is taken, as asked"), "{}", notes(&asked));
        }
    }
}

#[test]
fn the_first_impact_is_taken_where_it_stops_the_vehicle_or_nobody_knows() {
    for (pulses, flags) in [
        (vec![(0.0, 0.1, 56.0), (0.4, 0.08, 30.0)], "--mass 1200kg --impact-speed 50km/h"),
        // It stops but for the error of the speed.
        (vec![(0.0, 0.1, 49.95), (0.4, 0.08, 30.0)], "--mass 1200kg --impact-speed 50km/h"),
        (vec![(0.0, 0.1, 20.0), (0.35, 0.12, 35.0)], "--mass 1200kg"),
        // Neither stops it.
        (vec![(0.0, 0.1, 10.0), (0.35, 0.12, 15.0)], "--mass 1200kg --impact-speed 50km/h"),
        (vec![(0.0, 0.1, 56.0)], "--mass 1200kg --impact-speed 50km/h"),
    ] {
        let found = taken(&pulses, flags);
        assert_eq!(found.pulse().unwrap().samples.t0_s(), -0.1, "{pulses:?}");
        assert!(!notes(&found).contains("is taken"), "{}", notes(&found));
    }
    let second = taken(&[(0.0, 0.1, 20.0), (0.35, 0.12, 35.0)], "--mass 1200kg --impact 2");
    assert!(
        (second.pulse().unwrap().samples.end_s() - 0.15).abs() < 0.005 && second.test.impact_speed_m_per_s.is_none()
    );
}

#[test]
fn an_impact_that_the_pulse_does_not_hold_is_refused() {
    for number in ["0", "3"] {
        let flags = given(&format!("--mass 1200kg --impact-speed 50km/h --impact {number}"));
        let error = read_as("crash.csv", table(&[(0.0, 0.1, 56.0), (0.4, 0.08, 30.0)]), &flags).unwrap_err();
        assert!(error.to_string().contains("the pulse holds 2 impacts"), "{error}");
    }
}
