//! Responses against records with known parameters, computed elsewhere with 50 digits.

use crumple_lumped::{
    CrushEvents, DoubleSpringMassDamper, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2,
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
