//! Closed forms of the lumped models.

use crumple_lumped::{CoefficientMatching, Kelvin, MatchedSolution, Reading};
use crumple_lumped_fit::{
    KelvinBranch, MaxwellExponents, elastoplastic_from_events, kelvin_from_events, maxwell_from_exponents,
};
use crumple_numerics::lti::{Complex, Mode};
use crumple_testkit::reference_signals::{list, number, text};
use serde_json::{Value, json};

use crate::metrics::check::Check;

pub fn kelvin(check: &mut Check<'_>) {
    let (v0, mass_kg) = (check.param("v0_ms"), check.param("mass_kg"));
    let (t_m, crush) = if check.has_param("omega") {
        // There and back: the events of the model, and the model from the events.
        let (omega, zeta) = (check.param("omega"), check.param("zeta"));
        let model = Kelvin {
            mass_kg,
            stiffness_n_per_m: mass_kg * omega * omega,
            damping_n_s_per_m: 2.0 * zeta * omega * mass_kg,
        };
        let events = model.events(v0);
        (events.time_of_dynamic_crush_s.unwrap(), events.dynamic_crush_m.unwrap())
    } else {
        (check.param("t_m_s"), check.param("dynamic_crush_m"))
    };
    let found = kelvin_from_events(mass_kg, v0, t_m, crush).unwrap();
    check.close("t_m_s", t_m);
    check.close("dynamic_crush_m", crush);
    check.close("tc_over_tm", found.time_ratio);
    check.close("tc_s", found.time_ratio * t_m);
    check.close("omega", found.natural_frequency_rad_per_s);
    check.close("zeta", found.damping_ratio);
    check.close("k_N_per_m", found.model.stiffness_n_per_m);
    check.close("c_Ns_per_m", found.model.damping_n_s_per_m);
    let (undamped, model_t_m) = match found.branch {
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s } => (true, model_time_of_dynamic_crush_s),
        _ => (false, t_m),
    };
    check.equal("undamped_fallback", json!(undamped));
    check.close("t_m_model_s", model_t_m);
}

pub fn maxwell(check: &mut Check<'_>) {
    let mass_kg = check.param("mass_kg");
    let exponents = match text(&check.case["params"]["branch"]) {
        "imaginary" => MaxwellExponents::Complex { a_per_s: check.param("a"), b_rad_per_s: check.param("b") },
        "real" => {
            let names = if check.has_param("r2") { ["r2", "r3"] } else { ["a", "b"] };
            let [r2, r3] = names.map(|name| check.param(name));
            MaxwellExponents::Real { a_per_s: (r2 + r3) / 2.0, b_per_s: (r2 - r3).abs() / 2.0 }
        }
        other => panic!("branch {other}"),
    };
    let found = maxwell_from_exponents(mass_kg, exponents).unwrap();
    check.close("k_N_per_m", found.stiffness_n_per_m);
    check.close("c_Ns_per_m", found.damping_n_s_per_m);
}

pub fn elastoplastic(check: &mut Check<'_>) {
    let (v0, crush) = (check.param("v0_ms"), check.param("dynamic_crush_m"));
    let restitution = check.param("rebound_ms").abs() / v0;
    let found = elastoplastic_from_events(check.param("mass_kg"), v0, crush, restitution).unwrap();
    check.close("restitution", restitution);
    check.close("kE_N_per_m", found.loading_stiffness_n_per_m);
    check.close("kP_N_per_m", found.unloading_stiffness_n_per_m);
    // Elastic part of the crush: C·k_E/k_P.
    check.close("de_m", crush * found.loading_stiffness_n_per_m / found.unloading_stiffness_n_per_m);
}

pub fn double(check: &mut Check<'_>) {
    let denominator: Vec<f64> = list(&check.case["params"]["den"]).iter().map(number).collect();
    let [leading, t, u, v, w] = denominator.as_slice().try_into().unwrap();
    let polynomial = [t, u, v, w].map(|coefficient: f64| coefficient / leading);
    let (m1, m2) = (check.param("m1_kg"), check.param("m2_kg"));
    let found = CoefficientMatching::new(polynomial, m1, m2, Reading::Binary).unwrap().solve();
    let real: Vec<&MatchedSolution> = found.solutions.iter().filter(|solution| solution.real).collect();
    let expected = list(&check.case["expected"]["real_solutions"]);
    let physical = list(&check.case["expected"]["physical"]);
    check.looked_at("real_solutions");
    check.looked_at("physical");
    if real.len() != expected.len() {
        check.fail(format!("{} real solutions instead of {}", real.len(), expected.len()));
    }
    // In any order.
    for (solution, physical) in expected.iter().zip(physical) {
        match real.iter().find(|found| same(check, found, solution)).map(|found| found.physical) {
            Some(is) if json!(is) == *physical => {}
            Some(_) => check.fail(format!("{solution} is physical where it is not, or the reverse")),
            None => check.fail(format!("{solution} is not among the solutions")),
        }
    }
}

fn same(check: &Check<'_>, found: &MatchedSolution, solution: &Value) -> bool {
    [("c1", found.c1_n_s_per_m), ("c2", found.c2_n_s_per_m), ("k1", found.k1_n_per_m), ("k2", found.k2_n_per_m)]
        .iter()
        .all(|(key, found)| {
            let expected = number(&solution[key]);
            (found.re - expected).abs() <= check.general_limit(expected)
        })
}

pub fn mode(check: &mut Check<'_>) {
    let mode = Mode::continuous(Complex::new(check.param("re"), check.param("im")));
    check.close("omega_n", mode.natural_frequency_rad_per_s);
    check.close_or_null("zeta", mode.damping_ratio);
    check.close("f_hz", mode.natural_frequency_hz());
}
