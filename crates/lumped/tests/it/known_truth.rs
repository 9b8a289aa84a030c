//! Responses against records with known parameters, computed elsewhere with 50 digits.

use crumple_lumped::{
    Chain, CrushEvents, DoubleSpringMassDamper, Drive, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2,
};
use serde_json::Value;

/// The truth files print f64 values; the responses here lose a few hundred roundings of `1e-16` on top.
const RELATIVE: f64 = 1e-12;

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn model(truth: &Value) -> Model {
    let p = &truth["parameters"];
    let n = |key| number(p, key);
    match truth["model"].as_str().unwrap() {
        "kelvin" => Model::Kelvin(Kelvin { mass_kg: n("m"), stiffness_n_per_m: n("k"), damping_n_s_per_m: n("c") }),
        "maxwell" => Model::Maxwell(Maxwell { mass_kg: n("m"), stiffness_n_per_m: n("k"), damping_n_s_per_m: n("c") }),
        "elastoplastic" => Model::Elastoplastic(Elastoplastic {
            mass_kg: n("m"),
            loading_stiffness_n_per_m: n("k_E"),
            unloading_stiffness_n_per_m: n("k_P"),
            release: p["release"].as_bool().unwrap_or(false),
        }),
        "nonlinear" => {
            let list =
                |key: &str| -> Vec<f64> { p[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() };
            let (kx, k, cv, c) = (list("k_knots"), list("k_values"), list("c_knots"), list("c_values"));
            if k.len() == 2 {
                Model::Nonlinear1(Nonlinear1 {
                    mass_kg: n("m"),
                    k1_n_per_m: k[0],
                    k2_n_per_m: k[1],
                    c1_n_s_per_m: c[0],
                    c2_n_s_per_m: c[1],
                    c3_n_s_per_m: c[2],
                    v_thresh_m_per_s: cv[1],
                    crush_m: kx[1],
                    v0_m_per_s: cv[2],
                })
            } else {
                Model::Nonlinear2(Nonlinear2 {
                    mass_kg: n("m"),
                    k1_n_per_m: k[0],
                    k2_n_per_m: k[1],
                    k3_n_per_m: k[2],
                    x1_m: kx[1],
                    c1_n_s_per_m: c[0],
                    c2_n_s_per_m: c[1],
                    c3_n_s_per_m: c[2],
                    c4_n_s_per_m: c[3],
                    v1_m_per_s: cv[1],
                    v2_m_per_s: cv[2],
                    crush_m: kx[2],
                    v0_m_per_s: cv[3],
                })
            }
        }
        "double" => Model::DoubleSpringMassDamper(double(truth)),
        other => panic!("{other}"),
    }
}

fn double(truth: &Value) -> DoubleSpringMassDamper {
    let n = |key| number(&truth["parameters"], key);
    DoubleSpringMassDamper {
        m1_kg: n("m1"),
        m2_kg: n("m2"),
        k1_n_per_m: n("k1"),
        k2_n_per_m: n("k2"),
        c1_n_s_per_m: n("c1"),
        c2_n_s_per_m: n("c2"),
    }
}

fn close(what: &str, found: f64, wanted: f64, scale: f64) {
    assert!((found - wanted).abs() <= RELATIVE * scale, "{what}: {found} {wanted}, off by {:e}", found - wanted);
}

fn check(record: &str) {
    let Some(truth) = crumple_testkit::known_truth(record) else { return };
    let model = model(&truth);
    let v0 = number(&truth, "v0_m_s");
    let dt = 1e-4;
    let response = model.respond(v0, dt, 2501).unwrap();
    let motion = response.compartment();
    let crush = number(&truth["expected"], "C");
    // Scale of the accelerations: the largest one.
    let deceleration = motion.acceleration_m_per_s2.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
    let checkpoints = truth["checkpoints"].as_array().unwrap();
    assert!(checkpoints.len() > 10);
    for point in checkpoints {
        let k = (number(point, "t") / dt).round() as usize;
        close(&format!("{record} x[{k}]"), motion.displacement_m[k], number(point, "x"), crush);
        close(&format!("{record} v[{k}]"), motion.velocity_m_per_s[k], number(point, "v"), v0);
        close(&format!("{record} a[{k}]"), motion.acceleration_m_per_s2[k], number(point, "a_m_s2"), deceleration);
    }
    let CrushEvents {
        time_of_dynamic_crush_s: t_m,
        dynamic_crush_m: c,
        time_of_rebound_s: t_rebound,
        rebound_velocity_m_per_s: v_rebound,
    } = model.events(v0).unwrap();
    let expected = &truth["expected"];
    close("C", c.unwrap(), crush, crush);
    close("t_m", t_m.unwrap(), number(expected, "t_m"), number(expected, "t_m"));
    close("t_rebound", t_rebound.unwrap(), number(expected, "t_rebound"), number(expected, "t_rebound"));
    close("v_rebound", v_rebound.unwrap(), number(expected, "v_rebound"), v0);
}

#[test]
fn kelvin_records() {
    check("kelvin-undamped");
    check("kelvin-underdamped");
}

#[test]
fn elastoplastic_records() {
    check("elastoplastic");
    check("elastoplastic-release");
}

#[test]
fn maxwell_record() {
    check("maxwell");
}

#[test]
fn nonlinear_records() {
    check("nonlinear-1");
    check("nonlinear-2");
}

#[test]
fn double_records() {
    for record in ["double-underdamped", "double-mixed", "double-overdamped"] {
        check(record);
        let Some(truth) = crumple_testkit::known_truth(record) else { return };
        let (model, expected) = (double(&truth), &truth["expected"]);
        let chassis = model.events(number(&truth, "v0_m_s")).unwrap()[0];
        close("t_m1", chassis.time_of_dynamic_crush_s.unwrap(), number(expected, "t_m1"), number(expected, "t_m1"));
        close("C1", chassis.dynamic_crush_m.unwrap(), number(expected, "C1"), number(expected, "C1"));
        let polynomial = model.characteristic_polynomial();
        for (found, wanted) in polynomial.iter().zip(expected["charpoly_descending_monic"].as_array().unwrap()) {
            close("characteristic polynomial", *found, wanted.as_f64().unwrap(), wanted.as_f64().unwrap());
        }
        for wanted in expected["roots"].as_array().unwrap() {
            let (re, im) = match wanted.as_f64() {
                Some(re) => (re, 0.0),
                None => (number(wanted, "re"), number(wanted, "im")),
            };
            let nearest =
                model.poles().unwrap().into_iter().map(|p| (p.re - re).hypot(p.im - im)).fold(f64::MAX, f64::min);
            // The roots of these quartics amplify rounding of the coefficients by up to 100.
            assert!(nearest < 1e-13 * 100.0 * re.hypot(im), "{record} {re} {im}: {nearest:e}");
        }
        let dual = model.dual();
        let n = |key| number(&expected["dual_parameters"], key);
        close("dual k1", dual.k1_n_per_m, n("k1"), n("k1"));
        close("dual k2", dual.k2_n_per_m, n("k2"), n("k2"));
        close("dual c1", dual.c1_n_s_per_m, n("c1"), n("c1"));
        close("dual c2", dual.c2_n_s_per_m, n("c2"), n("c2"));
    }
}

fn triple() -> Chain {
    Chain::with_constants(&[200.0, 350.0, 900.0], &[4e5, 6e5, 9e5], &[8e3, 5e3, 1.2e4]).unwrap()
}

#[test]
fn two_masses_are_the_double_model() {
    let double = DoubleSpringMassDamper {
        m1_kg: 291.0,
        m2_kg: 582.0,
        k1_n_per_m: 4e5,
        k2_n_per_m: 6e5,
        c1_n_s_per_m: 9e3,
        c2_n_s_per_m: 7e3,
    };
    let chain = Chain::with_constants(&[291.0, 582.0], &[4e5, 6e5], &[9e3, 7e3]).unwrap();
    for (a, b) in chain.characteristic_polynomial().iter().zip(double.characteristic_polynomial()) {
        // Sums of positive terms on both sides.
        assert!((a - b).abs() <= 4e-15 * b, "{a} {b}");
    }
    let one = chain.respond(&Drive::Impact(12.0), 1e-4, 1001).unwrap();
    let two = Model::DoubleSpringMassDamper(double).respond(12.0, 1e-4, 1001).unwrap();
    for (a, b) in one.motions[1].displacement_m.iter().zip(&two.motions[1].displacement_m) {
        // A thousand multiplications by matrices that differ by roundings.
        assert!((a - b).abs() < 1e-12, "{a} {b}");
    }
    let (a, b) = (chain.events(12.0, 2.0).unwrap()[1], double.events(12.0).unwrap()[1]);
    assert!((a.dynamic_crush_m.unwrap() - b.dynamic_crush_m.unwrap()).abs() < 1e-13);
    assert!((a.time_of_rebound_s.unwrap() - b.time_of_rebound_s.unwrap()).abs() < 1e-12);
}

#[test]
fn energy_closes_for_every_drive() {
    let chain = triple();
    let pulse: Vec<f64> = (0..500).map(|k| 2e5 * (f64::from(k) * 0.01).sin().powi(2)).collect();
    let sled: Vec<f64> = (0..800).map(|k| 200.0 * (f64::from(k) * 0.006).sin()).collect();
    for drive in [Drive::Impact(15.0), Drive::Force { mass: 0, samples: pulse }, Drive::BaseAcceleration(sled)] {
        let response = chain.dynamics(&drive, 1e-4, 2001).unwrap();
        let largest = response.energy.iter().fold(0.0_f64, |m, e| m.max(e.input_j.abs()));
        assert!(largest > 1.0);
        for e in &response.energy {
            // 2,000 quadratic forms, each right to about 1e-15 of the energy.
            let gap = e.kinetic_j + e.stored_j + e.dissipated_j - e.input_j;
            assert!(gap.abs() < 1e-11 * largest, "{gap} of {largest}");
        }
    }
}

#[test]
fn forces_of_the_elements_move_the_masses() {
    let chain = triple();
    let r = chain.dynamics(&Drive::Impact(15.0), 1e-4, 1001).unwrap();
    for k in [0, 10, 400, 1000] {
        let force: Vec<f64> = (0..3).map(|i| r.forces[2 * i].force_n[k] + r.forces[2 * i + 1].force_n[k]).collect();
        for i in 0..3 {
            let behind = force.get(i + 1).copied().unwrap_or(0.0);
            let inertia = chain.masses_kg()[i] * r.response.motions[i].acceleration_m_per_s2[k];
            // Sums of forces near 1e6 N.
            assert!((inertia - (behind - force[i])).abs() < 1e-8, "{i} {k}");
        }
    }
}

#[test]
fn refuses_what_is_no_chain() {
    assert!(Chain::with_constants(&[], &[], &[]).is_err());
    assert!(Chain::with_constants(&[1.0], &[1.0, 2.0], &[1.0]).is_err());
    assert!(Chain::with_constants(&[-1.0], &[1.0], &[1.0]).is_err());
    let chain = Chain::with_constants(&[1.0], &[1.0], &[1.0]).unwrap();
    assert!(chain.respond(&Drive::Force { mass: 1, samples: vec![1.0] }, 1e-3, 3).is_err());
    assert!(chain.respond(&Drive::Impact(1.0), 0.0, 3).is_err());
}

#[test]
fn crush_and_rebound_within_one_step_are_both_found() {
    // The horizon bounds the step from below: 100 s / 400,000 = 0.25 ms, 0.6 of a swing of the front mass.
    let chain = Chain::with_constants(&[1.0, 1000.0], &[2.27e8, 1e6], &[0.0, 0.0]).unwrap();
    let found = chain.events(10.0, 100.0).unwrap()[0];
    let swing_s = 2.0 * std::f64::consts::PI * (1.0_f64 / 2.28e8).sqrt();
    // The compartment moves on and shifts the middle of the swing by less than 1e6/2.28e8 of it.
    assert!((found.time_of_dynamic_crush_s.unwrap() / (0.25 * swing_s) - 1.0).abs() < 0.01);
    assert!((found.time_of_rebound_s.unwrap() / (0.5 * swing_s) - 1.0).abs() < 0.01);
    assert!(chain.events(10.0, 0.0).is_err() && chain.events(10.0, f64::NAN).is_err());
}
