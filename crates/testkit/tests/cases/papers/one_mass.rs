//! Models of one mass: Kelvin, elastoplastic, Maxwell, nonlinear I and II, and the constants of a firefly search.

use crumple_lumped::{Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2};
use crumple_lumped_fit::{
    KelvinBranch, MaxwellExponents, centroid_to_crush_time_ratio, elastoplastic_from_events, kelvin_from_events,
    maxwell_constants,
};
use serde_json::{Value, json};

use crate::papers::inputs::{CHECKPOINT_TIMES, Inputs, text};

pub fn kelvin_curve(i: &Inputs<'_>) -> Result<Value, String> {
    let zeta = i.n("zeta")?;
    let unit = Kelvin { mass_kg: 1.0, stiffness_n_per_m: 1.0, damping_n_s_per_m: 2.0 * zeta };
    let events = unit.events(1.0);
    Ok(json!({
        "tau_m": events.time_of_dynamic_crush_s,
        "tau_c": events.dynamic_crush_m,
        "ratio": centroid_to_crush_time_ratio(zeta),
    }))
}

pub fn kelvin_invert(i: &Inputs<'_>) -> Result<Value, String> {
    let solution = kelvin_from_events(1.0, 1.0, 1.0, i.n("ratio")?).map_err(text)?;
    let solvable = !matches!(solution.branch, KelvinBranch::UndampedReduction { .. });
    Ok(json!({ "zeta": solvable.then_some(solution.damping_ratio), "solvable": solvable }))
}

pub fn kelvin_identify(i: &Inputs<'_>) -> Result<Value, String> {
    let (v0, crush, t_m) = (i.n("v0")?, i.n("C")?, i.n("t_m")?);
    let solution = kelvin_from_events(i.n("m")?, v0, t_m, crush).map_err(text)?;
    let (branch, used) = match solution.branch {
        KelvinBranch::Underdamped => ("underdamped", t_m),
        KelvinBranch::Overdamped => ("overdamped", t_m),
        KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s: t } => ("undamped_fallback", t),
    };
    Ok(json!({
        "t_c": crush / v0,
        "ratio": solution.time_ratio,
        "branch": branch,
        "zeta": solution.damping_ratio,
        "t_m_used": used,
        "omega_e": solution.natural_frequency_rad_per_s,
        "k": solution.model.stiffness_n_per_m,
        "c": solution.model.damping_n_s_per_m,
    }))
}

pub fn kelvin_response(i: &Inputs<'_>) -> Result<Value, String> {
    let v0 = i.n("v0")?;
    let model = Kelvin { mass_kg: i.n("m")?, stiffness_n_per_m: i.n("k")?, damping_n_s_per_m: i.n("c")? };
    let e = model.events(v0);
    let t_c = e.dynamic_crush_m.map(|c| c / v0);
    Ok(json!({
        "omega_e": model.natural_frequency_rad_per_s(),
        "zeta": model.damping_ratio(),
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "t_c": t_c,
        "ratio": t_c.zip(e.time_of_dynamic_crush_s).map(|(c, m)| c / m),
        "a_at_0_plus": model.state(v0, 0.0).acceleration_m_per_s2 + 0.0,
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
    }))
}

pub fn elastoplastic(i: &Inputs<'_>) -> Result<Value, String> {
    let (m, v0, crush) = (i.n("m")?, i.n("v0")?, i.n("C")?);
    let model: Elastoplastic = elastoplastic_from_events(m, v0, crush, i.n("v_rebound")? / v0).map_err(text)?;
    let e = model.events(v0);
    let (loading, unloading) = (model.loading_stiffness_n_per_m, model.unloading_stiffness_n_per_m);
    Ok(json!({
        "COR": model.coefficient_of_restitution(),
        "k_E": loading,
        "k_P": unloading,
        "d_e": crush * loading / unloading,
        "F_max": loading * crush,
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "omega_P": (unloading / m).sqrt(),
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
        "permanent_set": model.permanent_set_m(v0),
    }))
}

pub fn maxwell_printed(i: &Inputs<'_>) -> Result<Value, String> {
    let (a, b) = (i.n("a")?, i.n("b")?);
    let exponents = if i.0["root_type"] == "real" {
        MaxwellExponents::Real { a_per_s: a, b_per_s: b }
    } else {
        MaxwellExponents::Complex { a_per_s: a, b_rad_per_s: b }
    };
    let (k, c) = maxwell_constants(i.n("m")?, exponents);
    Ok(json!({ "k": k, "c": c }))
}

pub fn maxwell(i: &Inputs<'_>) -> Result<Value, String> {
    let (m, k, c, v0) = (i.n("m")?, i.n("k")?, i.n("c")?, i.n("v0")?);
    let model = Maxwell { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: c };
    model.check().map_err(text)?;
    let a = -0.5 * k / c;
    let square = k / m - a * a;
    let b = square.abs().sqrt();
    let rest = m * v0 / c;
    // x = C1 + e^(a t) (C2 cos b t + C3 sin b t), or C1 + C2 e^((a+b) t) + C3 e^((a-b) t) for real exponents; at the
    // start x = 0, x' = v0, x'' = 0.
    let swing = (v0 + a * rest) / b;
    let (c2, c3) = if square > 0.0 { (-rest, swing) } else { (0.5 * (swing - rest), -0.5 * (swing + rest)) };
    let e = model.events(v0);
    Ok(json!({
        "a": a,
        "b": b,
        "kind": if square > 0.0 { "imaginary" } else { "real" },
        "x_inf": rest,
        "C1": rest,
        "C2": c2,
        "C3": c3,
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
    }))
}

pub fn nonlinear(i: &Inputs<'_>) -> Result<Value, String> {
    let (mass_kg, v0, end) = (i.n("m")?, i.n("v0")?, i.n("T")?);
    let (kx, k, cv, c) = (i.list("k_knots")?, i.list("k_values")?, i.list("c_knots")?, i.list("c_values")?);
    let model = match (&kx[..], &k[..], &cv[..], &c[..]) {
        ([_, crush], [k1, k2], [_, knee, last], [c1, c2, c3]) => Model::Nonlinear1(Nonlinear1 {
            mass_kg,
            k1_n_per_m: *k1,
            k2_n_per_m: *k2,
            c1_n_s_per_m: *c1,
            c2_n_s_per_m: *c2,
            c3_n_s_per_m: *c3,
            v_thresh_m_per_s: *knee,
            crush_m: *crush,
            v0_m_per_s: *last,
        }),
        ([_, x1, crush], [k1, k2, k3], [_, v1, v2, last], [c1, c2, c3, c4]) => Model::Nonlinear2(Nonlinear2 {
            mass_kg,
            k1_n_per_m: *k1,
            k2_n_per_m: *k2,
            k3_n_per_m: *k3,
            x1_m: *x1,
            c1_n_s_per_m: *c1,
            c2_n_s_per_m: *c2,
            c3_n_s_per_m: *c3,
            c4_n_s_per_m: *c4,
            v1_m_per_s: *v1,
            v2_m_per_s: *v2,
            crush_m: *crush,
            v0_m_per_s: *last,
        }),
        _ => return Err("no nonlinear model has so many knots".to_owned()),
    };
    let e = model.events(v0).map_err(text)?;
    // One step to each instant asked for: the series know no grid.
    let at = |t: f64| -> Result<(f64, f64, f64), String> {
        let response = model.respond(v0, t, 2).map_err(text)?;
        let motion = response.compartment();
        Ok((motion.displacement_m[1], motion.velocity_m_per_s[1], motion.acceleration_m_per_s2[1]))
    };
    let times = if i.0[CHECKPOINT_TIMES].is_array() { i.list(CHECKPOINT_TIMES)? } else { Vec::new() };
    let checkpoints: Vec<Value> = times
        .into_iter()
        .map(|t| at(t).map(|(x, v, a)| json!({ "t": t, "x": x, "v": v, "a": a })))
        .collect::<Result<_, _>>()?;
    let (x_end, v_end, _) = at(end)?;
    let mut found = json!({
        "t_m": e.time_of_dynamic_crush_s,
        "C": e.dynamic_crush_m,
        "t_rebound": e.time_of_rebound_s,
        "v_rebound": e.rebound_velocity_m_per_s,
        "x_at_T": x_end,
        "v_at_T": v_end,
        "checkpoints": checkpoints,
        "t_c": e.dynamic_crush_m.map(|c| c / v0),
    });
    if let Ok(dt) = i.n("euler_dt") {
        found["euler_first_nonpositive_v"] = euler(mass_kg, v0, dt, (&kx, &k), (&cv, &c));
    }
    Ok(found)
}

/// The explicit integration a paper's figures were made with: where its velocity is first not positive.
fn euler(m: f64, v0: f64, dt: f64, spring: (&[f64], &[f64]), damper: (&[f64], &[f64])) -> Value {
    let curve = |(knots, values): (&[f64], &[f64]), x: f64| {
        let j = knots.partition_point(|k| *k <= x).clamp(1, knots.len() - 1);
        let share = ((x - knots[j - 1]) / (knots[j] - knots[j - 1])).clamp(0.0, 1.0);
        values[j - 1] + share * (values[j] - values[j - 1])
    };
    let (mut x, mut v) = (0.0, v0);
    for step in 1..100_000 {
        let a = -(curve(spring, f64::abs(x)) * x + curve(damper, f64::abs(v)) * v) / m;
        (x, v) = (x + dt * v, v + dt * a);
        if v <= 0.0 {
            return json!({ "step": step, "t": f64::from(step) * dt, "x": x });
        }
    }
    Value::Null
}

pub fn firefly(i: &Inputs<'_>) -> Result<Value, String> {
    let length = i.list("lower")?.iter().zip(i.list("upper")?).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
    let gamma = length.sqrt().recip();
    let delta = 0.5_f64.powf(1.0 / 500.0);
    Ok(json!({
        "delta": delta,
        "L": length,
        "gamma": gamma,
        "gamma_L_squared": gamma * length * length,
        "log10_attractiveness_at_L": -gamma * length * length * std::f64::consts::LOG10_E,
        "alpha_after_500": i.n("alpha0")? * delta.powi(500),
    }))
}
