//! Simulation against records whose model is known.

use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Kelvin, Model};
use crumple_signal::{Measurement, Sampled};
use crumple_simulate::{Measured, OtherSensor, SimulateError, Window, beside, simulate};

const DT: f64 = 1e-4;

fn model() -> Kelvin {
    Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0 }
}

/// The exact motion of the Kelvin model on a grid whose samples lie `offset` before multiples of `DT`, from 50 ms
/// before contact, where the car coasts.
fn record(offset: f64, rate: impl Fn(f64) -> f64) -> Sampled {
    Sampled::new(-0.05 - offset, DT, (0..2501).map(|k| rate(f64::from(k) * DT - 0.05 - offset)).collect()).unwrap()
}

fn displacement(t: f64) -> f64 {
    if t < 0.0 { 9.7 * t } else { model().state(9.7, t).displacement_m }
}

fn measured<'a>(displacement: &'a Sampled, velocity: Option<&'a Sampled>) -> Measured<'a> {
    let events = model().events(9.7);
    Measured {
        impact_speed_m_per_s: 9.7,
        displacement,
        measurement: Measurement::of_samples(displacement),
        velocity,
        acceleration: None,
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
    }
}

#[test]
fn the_model_of_the_record_fits_it_to_rounding() {
    let x = record(0.0, displacement);
    let v = record(0.0, |t| if t < 0.0 { 9.7 } else { model().state(9.7, t).velocity_m_per_s });
    let s = simulate(&Model::Kelvin(model()), &measured(&x, Some(&v)), Window::default()).unwrap();
    let c = &s.comparison;
    // Time stamps 1e-17 s apart at 9.7 m/s.
    assert!(c.rmse_displacement_m.unwrap() < 1e-14 && c.max_displacement_error_m.unwrap() < 1e-13);
    assert!(c.fit_displacement_percent.unwrap() > 100.0 - 1e-10 && c.fit_velocity_percent.unwrap() > 100.0 - 1e-10);
    // The root of the exact solution beside the closed form: roundings of half a metre and of 77 ms.
    assert!(c.dynamic_crush_error_m.unwrap().abs() < 1e-14);
    assert!(c.time_of_dynamic_crush_error_s.unwrap().abs() < 1e-15);
    assert_eq!(c.fit_acceleration_percent, None);
    // From time zero to the record's end at 0.2 s; the window ends at dynamic crush, 77.2 ms.
    assert_eq!(s.motion.displacement_m.len(), 2001);
    assert!((c.to_s - 0.0772).abs() < 1e-12);
    assert_eq!((s.motion.displacement_m[0], s.motion.velocity_m_per_s[0]), (0.0, 9.7));
}

#[test]
fn a_time_zero_between_samples_costs_the_interpolation_only() {
    let x = record(0.4 * DT, displacement);
    let s = simulate(&Model::Kelvin(model()), &measured(&x, None), Window { to_s: Some(0.1) }).unwrap();
    // dt²/8 of 190 m/s², plus the kink at contact in the first interval.
    let bound = DT * DT / 8.0 * 190.0;
    let largest = s.comparison.max_displacement_error_m.unwrap();
    assert!(largest > 0.0 && largest < 1.1 * bound, "{largest:e} {bound:e}");
    assert!((s.comparison.to_s - 0.1).abs() < 1e-12);
}

#[test]
fn another_model_is_measured_by_its_difference() {
    let x = record(0.0, displacement);
    let other = Elastoplastic {
        mass_kg: 873.0,
        loading_stiffness_n_per_m: 330_000.0,
        unloading_stiffness_n_per_m: 3.3e7,
        release: true,
    };
    let s = simulate(&Model::Elastoplastic(other), &measured(&x, None), Window::default()).unwrap();
    // v0/w against the damped crush.
    let crush = 9.7 * (873.0_f64 / 330_000.0).sqrt();
    let expected = crush - model().events(9.7).dynamic_crush_m.unwrap();
    assert!((s.comparison.dynamic_crush_error_m.unwrap() - expected).abs() < 1e-15);
    let fit = s.comparison.fit_displacement_percent.unwrap();
    assert!(fit > 50.0 && fit < 95.0, "{fit}");
    // After release the model coasts backwards.
    let motion = &s.motion;
    assert_eq!(motion.acceleration_m_per_s2[2000], 0.0);
    assert!((motion.velocity_m_per_s[2000] + 0.97).abs() < 1e-12);
}

#[test]
fn a_model_that_never_stops_has_no_crush_and_is_still_compared() {
    let x = record(0.0, displacement);
    let coasting = Kelvin { stiffness_n_per_m: 0.0, ..model() };
    let s = simulate(&Model::Kelvin(coasting), &measured(&x, None), Window::default()).unwrap();
    assert_eq!((s.events.dynamic_crush_m, s.comparison.dynamic_crush_error_m), (None, None));
    assert!(s.comparison.rmse_displacement_m.unwrap() > 0.01);
}

#[test]
fn refuses_what_cannot_be_compared() {
    let x = record(0.0, displacement);
    let kelvin = Model::Kelvin(model());
    let slow = Measured { impact_speed_m_per_s: 0.0, ..measured(&x, None) };
    assert_eq!(simulate(&kelvin, &slow, Window::default()), Err(SimulateError::Speed(0.0)));
    let early = Sampled::new(-1.0, x.dt_s(), x.samples().to_vec()).unwrap();
    let late = measured(&early, None);
    assert!(matches!(simulate(&kelvin, &late, Window::default()), Err(SimulateError::Empty { .. })));
    let broken = Model::Kelvin(Kelvin { mass_kg: 0.0, ..model() });
    let error = simulate(&broken, &measured(&x, None), Window::default()).unwrap_err();
    assert_eq!(error.to_string(), "mass_kg is 0, expected a positive number");
}

#[test]
fn every_model_kind_is_simulated_from_its_named_parameters() {
    let zero = Sampled::new(0.0, 1e-3, vec![0.0; 101]).unwrap();
    for kind in crumple_lumped::ModelKind::ALL {
        let value = |name: &str| match name {
            "v1_m_per_s" | "v_thresh_m_per_s" => 2.0,
            "v2_m_per_s" => 5.0,
            "v0_m_per_s" => 10.0,
            "x1_m" => 0.3,
            "crush_m" => 0.5,
            name if name.ends_with("rate_s_per_m") => 0.008,
            name if name.contains("knot") => {
                let digits = name.chars().filter(char::is_ascii_digit).collect::<String>();
                let number: f64 = digits.parse().unwrap();
                if name.ends_with("_m") { 0.1 * number } else { 3e4 }
            }
            name if name.ends_with("_kg") => 500.0,
            name if name.contains("n_s_per_m") => 2e4,
            _ => 4e5,
        };
        let parameters = kind.parameter_names().iter().map(|name| ((*name).to_owned(), value(name))).collect();
        let model = Model::from_parameters(kind, &parameters).unwrap();
        let measured = Measured {
            impact_speed_m_per_s: 10.0,
            displacement: &zero,
            measurement: Measurement::of_samples(&zero),
            velocity: None,
            acceleration: None,
            dynamic_crush_m: None,
            time_of_dynamic_crush_s: None,
        };
        let simulation = simulate(&model, &measured, Window::default()).unwrap();
        assert_eq!(simulation.motion.displacement_m.len(), 101, "{kind}");
        assert!(simulation.events.dynamic_crush_m.unwrap() > 0.01, "{kind}");
    }
}

#[test]
fn the_engines_sensor_says_nothing_of_a_model_of_one_mass() {
    let x = record(0.0, displacement);
    let s = simulate(&Model::Kelvin(model()), &measured(&x, None), Window::default()).unwrap();
    let sensor = |on_engine| OtherSensor { channel: "95".to_owned(), on_engine, displacement: x.clone() };
    assert_eq!(beside(&s, &sensor(true), DT), None);
    let found = beside(&s, &sensor(false), DT).unwrap();
    // The model's own record: rounding of the time stamps.
    assert!(found.mass == 1 && found.rmse_m < 1e-14, "{found:?}");
    let double = DoubleSpringMassDamper {
        m1_kg: 291.0,
        m2_kg: 582.0,
        k1_n_per_m: 3e5,
        k2_n_per_m: 4e5,
        c1_n_s_per_m: 4e3,
        c2_n_s_per_m: 6e3,
    };
    let s = simulate(&Model::DoubleSpringMassDamper(double), &measured(&x, None), Window::default()).unwrap();
    assert_eq!(beside(&s, &sensor(true), DT).unwrap().mass, 1);
}
