//! Chains with piecewise-linear springs and dampers: reductions, an independent integrator, energies, drives, events.

use crumple_lumped::{Chain, Drive, Instants, Model, Nonlinear2, PiecewiseLinear, Response};

fn curve(points: &[(f64, f64)]) -> PiecewiseLinear {
    PiecewiseLinear::new(points).unwrap()
}

/// Engine, chassis, compartment; a front that softens, a rear that stiffens, dampers that weaken with speed.
fn triple() -> Chain {
    Chain::new(
        &[200.0, 350.0, 900.0],
        &[
            curve(&[(0.0, 9e5), (0.05, 5e5), (0.3, 3e5)]),
            curve(&[(0.0, 4e5), (0.08, 7e5)]),
            curve(&[(0.0, 6e5), (0.04, 6e5), (0.1, 1.1e6)]),
        ],
        &[
            curve(&[(0.0, 9e3), (4.0, 6e3), (12.0, 2e3)]),
            curve(&[(0.0, 2e3), (3.0, 7e3)]),
            PiecewiseLinear::constant(4e3),
        ],
    )
    .unwrap()
}

/// Classical Runge-Kutta with small steps on the law as a person writes it: nothing shared with the library but the
/// curves. Visits `k dt`, k = 0 .. samples, in steps of `dt/parts`.
fn runge_kutta(
    masses: &[f64],
    force: impl Fn(usize, f64, f64) -> f64,
    pushed: impl Fn(usize, f64) -> f64,
    base: impl Fn(f64) -> (f64, f64),
    speed: f64,
    (dt, parts, samples): (f64, usize, usize),
) -> Vec<Vec<f64>> {
    let n = masses.len();
    let rate = |t: f64, z: &[f64]| -> Vec<f64> {
        let (y, w) = base(t);
        let mut out = vec![0.0; 2 * n];
        for i in 0..n {
            let (front_x, front_v) = if i == 0 { (y, w) } else { (z[i - 1], z[n + i - 1]) };
            let f = force(i, z[i] - front_x, z[n + i] - front_v);
            out[i] = z[n + i];
            out[n + i] += (pushed(i, t) - f) / masses[i];
            if i > 0 {
                out[n + i - 1] += f / masses[i - 1];
            }
        }
        out
    };
    let mut z = vec![0.0; 2 * n];
    z[n..].fill(speed);
    let mut visited = vec![z.clone()];
    let h = dt / parts as f64;
    for k in 0..(samples - 1) * parts {
        let t = k as f64 * h;
        let shifted = |by: f64, d: &[f64]| -> Vec<f64> { z.iter().zip(d).map(|(z, d)| z + by * d).collect() };
        let k1 = rate(t, &z);
        let k2 = rate(t + 0.5 * h, &shifted(0.5 * h, &k1));
        let k3 = rate(t + 0.5 * h, &shifted(0.5 * h, &k2));
        let k4 = rate(t + h, &shifted(h, &k3));
        for i in 0..2 * n {
            z[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        if (k + 1) % parts == 0 {
            visited.push(z.clone());
        }
    }
    visited
}

/// The coefficients of [`triple`] written out by hand.
fn by_hand(i: usize, u: f64, w: f64) -> f64 {
    let between = |q: f64, from: (f64, f64), to: (f64, f64)| from.1 + (to.1 - from.1) * (q - from.0) / (to.0 - from.0);
    let (a, b) = (u.abs(), w.abs());
    let k = match i {
        0 if a < 0.05 => between(a, (0.0, 9e5), (0.05, 5e5)),
        0 if a < 0.3 => between(a, (0.05, 5e5), (0.3, 3e5)),
        0 => 3e5,
        1 if a < 0.08 => between(a, (0.0, 4e5), (0.08, 7e5)),
        1 => 7e5,
        _ if a < 0.04 => 6e5,
        _ if a < 0.1 => between(a, (0.04, 6e5), (0.1, 1.1e6)),
        _ => 1.1e6,
    };
    let c = match i {
        0 if b < 4.0 => between(b, (0.0, 9e3), (4.0, 6e3)),
        0 if b < 12.0 => between(b, (4.0, 6e3), (12.0, 2e3)),
        0 => 2e3,
        1 if b < 3.0 => between(b, (0.0, 2e3), (3.0, 7e3)),
        1 => 7e3,
        _ => 4e3,
    };
    k * u + c * w
}

fn largest_difference(response: &Response, truth: &[Vec<f64>]) -> (f64, f64) {
    let n = response.motions.len();
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    for (k, z) in truth.iter().enumerate() {
        for i in 0..n {
            x = x.max((response.motions[i].displacement_m[k] - z[i]).abs());
            v = v.max((response.motions[i].velocity_m_per_s[k] - z[n + i]).abs());
        }
    }
    (x, v)
}

#[test]
fn one_mass_is_the_second_nonlinear_model() {
    let model = Nonlinear2 {
        mass_kg: 873.0,
        k1_n_per_m: 1.2e5,
        k2_n_per_m: 4e5,
        k3_n_per_m: 2.5e5,
        x1_m: 0.2,
        c1_n_s_per_m: 9e3,
        c2_n_s_per_m: 3e3,
        c3_n_s_per_m: 6e3,
        c4_n_s_per_m: 1e3,
        v1_m_per_s: 2.0,
        v2_m_per_s: 5.0,
        crush_m: 0.4,
        v0_m_per_s: 9.7,
    };
    let chain = Chain::new(
        &[873.0],
        &[curve(&[(0.0, 1.2e5), (0.2, 4e5), (0.4, 2.5e5)])],
        &[curve(&[(0.0, 9e3), (2.0, 3e3), (5.0, 6e3), (9.7, 1e3)])],
    )
    .unwrap();
    let (one, two) = (
        chain.respond(&Drive::Impact(9.7), 1e-4, 5001).unwrap(),
        Model::Nonlinear2(model).respond(9.7, 1e-4, 5001).unwrap(),
    );
    let two = two.compartment();
    for k in 0..5001 {
        // About 50 steps each right to 1e-15 of half a metre and ten metres a second, on the same series.
        assert!((one.motions[0].displacement_m[k] - two.displacement_m[k]).abs() < 1e-13, "{k}");
        assert!((one.motions[0].velocity_m_per_s[k] - two.velocity_m_per_s[k]).abs() < 1e-11, "{k}");
    }
    let (a, b) = (chain.events(9.7, 2.0).unwrap()[0], model.events(9.7).unwrap());
    assert!((a.dynamic_crush_m.unwrap() - b.dynamic_crush_m.unwrap()).abs() < 1e-14);
    for (a, b) in [
        (a.time_of_dynamic_crush_s, b.time_of_dynamic_crush_s),
        (a.time_of_rebound_s, b.time_of_rebound_s),
        (a.rebound_velocity_m_per_s, b.rebound_velocity_m_per_s),
    ] {
        // Where the acceleration crosses zero at some 1e3 m/s^3, rounding of 1e-13 m/s^2 is 1e-16 s; speeds to 1e-13.
        assert!((a.unwrap() - b.unwrap()).abs() < 1e-12);
    }
}

#[test]
fn equal_knots_are_the_linear_chain() {
    let (masses, springs, dampers) = ([200.0, 350.0, 900.0], [4e5, 6e5, 9e5], [8e3, 5e3, 1.2e4]);
    let linear = Chain::with_constants(&masses, &springs, &dampers).unwrap();
    let constant = |values: &[f64]| -> Vec<PiecewiseLinear> {
        values.iter().map(|k| curve(&[(0.0, *k), (0.1, *k), (0.3, *k)])).collect()
    };
    let same = Chain::new(&masses, &constant(&springs), &constant(&dampers)).unwrap();
    let drive = Drive::Impact(15.0);
    assert_eq!(same.respond(&drive, 1e-4, 500), linear.respond(&drive, 1e-4, 500));
    // A knot of one part in 1e15 keeps the series in charge: the answer must not depend on who computes it.
    let nearly = |values: &[f64]| -> Vec<PiecewiseLinear> {
        values.iter().map(|k| curve(&[(0.0, *k), (0.1, *k * (1.0 + 2.0 * f64::EPSILON)), (0.3, *k)])).collect()
    };
    let series = Chain::new(&masses, &nearly(&springs), &nearly(&dampers)).unwrap();
    let pulse: Vec<f64> = (0..400).map(|k| 2e5 * (f64::from(k) * 0.01).sin()).collect();
    let sled: Vec<f64> = (0..900).map(|k| 200.0 * (f64::from(k) * 0.006).sin()).collect();
    for drive in [
        Drive::Impact(15.0),
        Drive::Force { mass: 1, samples: pulse.clone() },
        Drive::BaseAcceleration(sled),
        Drive::ImpactAndForce { speed_m_per_s: 15.0, mass: 0, samples: pulse },
    ] {
        let one = linear.dynamics(&drive, 1e-4, 2001).unwrap();
        let two = series.dynamics(&drive, 1e-4, 2001).unwrap();
        for i in 0..3 {
            for k in 0..2001 {
                // The two differ by two thousand roundings of motions up to 10 m (the sled) and 30 m/s.
                let (a, b) = (&one.response.motions[i], &two.response.motions[i]);
                assert!((a.displacement_m[k] - b.displacement_m[k]).abs() < 1e-11, "{i} {k}");
                assert!((a.velocity_m_per_s[k] - b.velocity_m_per_s[k]).abs() < 1e-10, "{i} {k}");
                // Accelerations near 1e3: stiffness over mass, 4.5e3, times the error in the compression.
                assert!((a.acceleration_m_per_s2[k] - b.acceleration_m_per_s2[k]).abs() < 1e-7, "{i} {k}");
            }
        }
        for (a, b) in one.energy.iter().zip(&two.energy) {
            // Each closes to 1e-11 of some 1e5 J.
            assert!((a.dissipated_j - b.dissipated_j).abs() < 2e-6 && (a.input_j - b.input_j).abs() < 2e-6);
        }
    }
    let (a, b) = (linear.events(15.0, 2.0).unwrap(), series.events(15.0, 2.0).unwrap());
    for (a, b) in a.iter().zip(&b) {
        assert!((a.dynamic_crush_m.unwrap() - b.dynamic_crush_m.unwrap()).abs() < 1e-12);
        // Velocity right to 1e-13 m/s at some 1e2 m/s^2 and more.
        assert!((a.time_of_dynamic_crush_s.unwrap() - b.time_of_dynamic_crush_s.unwrap()).abs() < 1e-12);
        // Acceleration right to 1e-9 m/s^2 at some 1e4 m/s^3.
        assert!((a.time_of_rebound_s.unwrap() - b.time_of_rebound_s.unwrap()).abs() < 1e-12);
    }
}

#[test]
fn three_masses_after_an_impact_move_as_a_small_step_integrator_says() {
    let chain = triple();
    let found = chain.respond(&Drive::Impact(14.0), 1e-3, 251).unwrap();
    let at = |parts| runge_kutta(chain.masses_kg(), by_hand, |_, _| 0.0, |_| (0.0, 0.0), 14.0, (1e-3, parts, 251));
    let (coarse, fine) = (largest_difference(&found, &at(250)), largest_difference(&found, &at(1000)));
    // Steps of 1 us. Between knots the rule is right to (70/s * 1e-6 s)^4; a step over a knot, where the third
    // derivative of the motion jumps by some 1e6 m/s^3 and more, errs by h^3 of it: 1e-12 m each, some twenty of them.
    assert!(fine.0 < 2e-11 && fine.1 < 2e-9, "{fine:?}");
    // It is the integrator that errs: four times the step, many times the difference.
    assert!(coarse.0 > 4.0 * fine.0, "{coarse:?} {fine:?}");
}

#[test]
fn drives_move_three_masses_as_a_small_step_integrator_says() {
    let chain = triple();
    let dt = 1e-3;
    let samples: Vec<f64> = (0..150).map(|k| 1.5e5 * (f64::from(k) * 0.05).sin()).collect();
    let linear = |samples: &[f64], t: f64| {
        let k = (t / dt + 1e-9).floor() as usize;
        let at = |k: usize| samples.get(k).copied().unwrap_or(0.0);
        at(k) + (at(k + 1) - at(k)) * (t / dt - k as f64)
    };
    let drive = Drive::Force { mass: 1, samples: samples.clone() };
    let found = chain.respond(&drive, dt, 251).unwrap();
    let push = |i: usize, t: f64| if i == 1 { linear(&samples, t) } else { 0.0 };
    let truth = runge_kutta(chain.masses_kg(), by_hand, push, |_| (0.0, 0.0), 0.0, (dt, 1000, 251));
    let difference = largest_difference(&found, &truth);
    // As after an impact, with slower knots.
    assert!(difference.0 < 2e-11 && difference.1 < 2e-9, "{difference:?}");

    // A base of constant acceleration for the whole response: its motion has a closed form.
    let sled = Drive::BaseAcceleration(vec![120.0; 252]);
    let dynamics = chain.dynamics(&sled, dt, 251).unwrap();
    let truth =
        runge_kutta(chain.masses_kg(), by_hand, |_, _| 0.0, |t| (60.0 * t * t, 120.0 * t), 0.0, (dt, 1000, 251));
    let difference = largest_difference(&dynamics.response, &truth);
    assert!(difference.0 < 2e-11 && difference.1 < 2e-9, "{difference:?}");
    let base = dynamics.response.motions[0].displacement_m[250] - dynamics.forces[0].deflection_m[250];
    assert!((base - 60.0 * 0.25 * 0.25).abs() < 1e-12);
}

#[test]
fn energy_closes_and_forces_move_the_masses() {
    let chain = triple();
    let pulse: Vec<f64> = (0..500).map(|k| 2e5 * (f64::from(k) * 0.01).sin().powi(2)).collect();
    let sled: Vec<f64> = (0..800).map(|k| 200.0 * (f64::from(k) * 0.006).sin()).collect();
    for drive in [Drive::Impact(15.0), Drive::Force { mass: 0, samples: pulse.clone() }, Drive::BaseAcceleration(sled)]
    {
        let found = chain.dynamics(&drive, 1e-4, 2001).unwrap();
        // Two thousand steps, heat and work each right to about 1e-15 of the energy.
        assert!(found.energy_closure().unwrap() < 1e-11, "{:?}", found.energy_closure());
        let at = |element: usize, k: usize| found.forces[element].force_n[k];
        let names: Vec<&str> = found.forces.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["k1", "c1", "k2", "c2", "k3", "c3"]);
        for k in [0, 1, 700, 2000] {
            let last = found.response.motions[2].acceleration_m_per_s2[k] * 900.0;
            // Products of numbers near 1e5.
            assert!((at(4, k) + at(5, k) + last).abs() < 1e-9);
        }
    }
}

#[test]
fn a_mass_that_comes_to_rest_and_one_without_spring_are_followed_to_the_end() {
    // Damped hard: ten time constants of decay, with every knot crossed on the way back.
    let slow = Chain::new(
        &[100.0, 800.0],
        &[curve(&[(0.0, 2e5), (0.1, 4e5)]), curve(&[(0.0, 0.0), (0.2, 3e5)])],
        &[curve(&[(0.0, 6e4), (5.0, 2e4)]), curve(&[(0.0, 3e4), (1.0, 1e4)])],
    )
    .unwrap();
    let found = slow.dynamics(&Drive::Impact(12.0), 1e-3, 2001).unwrap();
    assert!(found.energy_closure().unwrap() < 1e-11);
    assert!(found.response.motions[1].velocity_m_per_s[2000].abs() < 0.05);
    // No spring at all in front: it never comes back.
    let free = Chain::new(
        &[100.0, 800.0],
        &[PiecewiseLinear::constant(0.0), curve(&[(0.0, 2e5), (0.1, 4e5)])],
        &[curve(&[(0.0, 9e3), (5.0, 2e3)]), PiecewiseLinear::constant(0.0)],
    )
    .unwrap();
    let events = free.events(12.0, 2.0).unwrap();
    assert!(events.iter().all(|e| e.dynamic_crush_m.is_none_or(|c| c > 0.0)));
    assert!(free.dynamics(&Drive::Impact(12.0), 1e-3, 501).unwrap().energy_closure().unwrap() < 1e-11);
}

#[test]
fn an_undamped_rebound_falls_on_a_knot_and_is_found() {
    // The force is zero where the compression is: at the kink of the coefficient.
    let chain = Chain::new(&[900.0], &[curve(&[(0.0, 2e5), (0.3, 5e5)])], &[PiecewiseLinear::constant(0.0)]).unwrap();
    let event = chain.events(10.0, 2.0).unwrap()[0];
    // Nothing is lost: it leaves as fast as it came. Energy to 1e-14.
    assert!((event.rebound_velocity_m_per_s.unwrap() + 10.0).abs() < 1e-12);
    assert!((event.time_of_rebound_s.unwrap() - 2.0 * event.time_of_dynamic_crush_s.unwrap()).abs() < 1e-12);
}

#[test]
fn what_has_no_meaning_is_refused() {
    let one = PiecewiseLinear::constant(1e5);
    assert!(Chain::new(&[], &[], &[]).is_err());
    assert!(Chain::new(&[1.0], std::slice::from_ref(&one), &[]).is_err());
    assert!(Chain::new(&[0.0], std::slice::from_ref(&one), std::slice::from_ref(&one)).is_err());
    let drive = Drive::Force { mass: 3, samples: vec![1.0] };
    assert!(triple().respond(&drive, 1e-4, 10).unwrap_err().to_string().contains("mass is 3"));
    // Negative stiffness grows beyond all numbers: said, not written.
    let unstable = Chain::new(&[1.0], &[curve(&[(0.0, -1e5), (0.1, -1e7)])], std::slice::from_ref(&one)).unwrap();
    assert!(!unstable.is_passive());
    let wild = Chain::new(&[1.0], &[curve(&[(0.0, -1e5), (0.1, -1e7)])], &[PiecewiseLinear::constant(0.0)]);
    let error = wild.unwrap().respond(&Drive::Impact(10.0), 1e-3, 2001).unwrap_err().to_string();
    assert!(error.contains("cannot be followed beyond"), "{error}");
}

#[test]
fn motions_at_chosen_instants_are_those_of_the_response() {
    let whole = triple().respond(&Drive::Impact(14.0), 1e-3, 121).unwrap();
    let at = Instants { first_s: 0.01, dt_s: 2e-3, samples: 50 };
    let found = triple().motions_at(14.0, &at).unwrap();
    for (a, b) in found.iter().zip(&whole.motions) {
        for k in 0..at.samples {
            let i = 10 + 2 * k;
            // The same series; the step that holds an instant is cut elsewhere only at the end.
            assert!((a.displacement_m[k] - b.displacement_m[i]).abs() < 1e-13);
            assert!((a.velocity_m_per_s[k] - b.velocity_m_per_s[i]).abs() < 1e-11);
            assert!((a.acceleration_m_per_s2[k] - b.acceleration_m_per_s2[i]).abs() < 1e-9);
        }
    }
}

#[test]
fn derivatives_by_masses_values_and_places_of_knots_agree_with_central_differences() {
    let chain = triple();
    let at = Instants { first_s: 0.0021, dt_s: 1.3e-3, samples: 80 };
    // Three masses; eight values at knots of springs, six of dampers; then the places of five and of three, no zeros.
    let places = chain.places();
    assert_eq!(places.len(), 3 + 8 + 6 + 5 + 3);
    let all: Vec<usize> = (0..places.len()).collect();
    let sensitivity = chain.sensitivity(14.0, &at, &all).unwrap();
    let h = 1e-6;
    let mut numbers = chain.parameters();
    // Names in the order of the places.
    let mut names: Vec<String> = (1..=3).map(|i| format!("m{i}_kg")).collect();
    let knots = |symbol: &str, unit: &str, counts: [usize; 3], from: usize| -> Vec<String> {
        let name = |i: usize, j: usize, one: bool| match one {
            true => format!("{symbol}{i}_{unit}"),
            false => format!("{symbol}{i}_knot{j}_{unit}"),
        };
        (1..=3)
            .flat_map(|i| (from..=counts[i - 1]).map(move |j| (i, j)))
            .map(|(i, j)| name(i, j, counts[i - 1] == 1))
            .collect()
    };
    names.extend(knots("k", "n_per_m", [3, 2, 3], 1));
    names.extend(knots("c", "n_s_per_m", [3, 2, 1], 1));
    names.extend(knots("k", "m", [3, 2, 3], 2));
    names.extend(knots("c", "m_per_s", [3, 2, 1], 2));
    for (p, name) in names.iter().enumerate() {
        let value = numbers[name];
        let mut moved = |by: f64| {
            numbers.insert(name.clone(), value * (1.0 + by));
            let motions = Chain::from_parameters(&numbers).unwrap().motions_at(14.0, &at).unwrap();
            numbers.insert(name.clone(), value);
            motions
        };
        let (up, down) = (moved(h), moved(-h));
        for mass in 0..3 {
            for k in 0..at.samples {
                let difference = (up[mass].displacement_m[k] - down[mass].displacement_m[k]) / (2.0 * h);
                let derivative = sensitivity.derivatives[p][mass].displacement_m[k] * value;
                // Rounding over h is 1e-9; where a knot moves, the second derivative jumps: h of it.
                assert!((derivative - difference).abs() < 1e-5, "{name} {mass} {k}: {derivative} {difference}");
            }
        }
    }
}
