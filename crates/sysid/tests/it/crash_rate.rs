//! Subspace methods at the rate of crash records, 10 kHz: ten block rows are a millisecond there, so the record is
//! thinned.

use crumple_numerics::lti::{Complex, to_continuous};
use crumple_sysid::{IoData, Subspace, SubspaceOptions, Weighting, automatic_thinning, compare, thinned};

const DT_S: f64 = 1e-4;
const BLOCK_ROWS: usize = 10;

/// A known-truth record.
struct Record {
    /// Acceleration, m/s².
    a: Vec<f64>,
    /// Displacement by the trapezoidal rule, m; zero at the contact.
    s: Vec<f64>,
    /// Roots of the characteristic polynomial, 1/s.
    roots: Vec<Complex>,
}

fn record(name: &str, from_s: f64) -> Option<Record> {
    let folder = crumple_testkit::shared("reference/known-truth")?.join(name);
    let text = std::fs::read_to_string(folder.join("accel.csv")).unwrap();
    let a: Vec<f64> = text
        .lines()
        .filter_map(|line| line.split_once(','))
        .filter_map(|(t, a)| Some((t.parse::<f64>().ok()?, a.parse::<f64>().ok()?)))
        .filter(|(t, _)| *t > from_s - 1e-9)
        .map(|(_, a)| a * 9.806_65)
        .collect();
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
    let mut v = truth["v0_m_s"].as_f64().unwrap();
    let mut x = from_s * v;
    let mut s = vec![x];
    for pair in a.windows(2) {
        let next = v + DT_S / 2.0 * (pair[0] + pair[1]);
        x += DT_S / 2.0 * (v + next);
        v = next;
        s.push(x);
    }
    let roots = truth["expected"]["roots"].as_array().unwrap().iter().map(|root| match root.as_f64() {
        Some(re) => Complex::new(re, 0.0),
        None => Complex::new(root["re"].as_f64().unwrap(), root["im"].as_f64().unwrap()),
    });
    Some(Record { a, s, roots: roots.collect() })
}

/// Continuous poles of an order as the stage finds them, and the fit of the first output on the whole record.
fn identified(data: &IoData, order: usize) -> (Vec<Complex>, f64, usize) {
    let needed = Subspace::needed(BLOCK_ROWS, data.inputs().len(), data.outputs().len());
    let every = automatic_thinning(data, 2 * needed);
    let thin = thinned(data, every).unwrap();
    let options = SubspaceOptions { weighting: Weighting::N4sid, block_rows: BLOCK_ROWS, direct: true };
    let estimated = Subspace::new(&thin, options).unwrap().realize_on(order, data).unwrap();
    let fit = compare(&estimated.model, data).unwrap()[0].unwrap().fit_percent.unwrap();
    let continuous = to_continuous(&estimated.model, crumple_numerics::lti::InputHold::First).unwrap();
    (continuous.model.poles().unwrap(), fit, every)
}

fn worst(estimated: &[Complex], exact: &[Complex]) -> f64 {
    let nearest = |s: &Complex| estimated.iter().map(|f| (f - s).norm() / s.norm()).fold(f64::INFINITY, f64::min);
    exact.iter().map(nearest).fold(0.0, f64::max)
}

#[test]
fn the_free_motion_of_two_masses_has_the_roots_of_its_polynomial() {
    for (name, tolerance) in [
        // The trapezoidal rule is off by a relative (s dt)²/12 = 2e-6 of the fastest term, which is small. Two
        // oscillations are well told apart; with two and four slow creeping motions in 0.25 s the poles answer to an
        // error 1e3 and 1e4 times more (the condition of such a sum of exponentials).
        ("double-underdamped", 1e-6),
        ("double-mixed", 1e-2),
        ("double-overdamped", 0.05),
    ] {
        let Some(Record { s, roots, .. }) = record(name, 0.0) else { return };
        let data = IoData::new(Vec::new(), vec![s], DT_S).unwrap();
        let (poles, fit, every) = identified(&data, 4);
        println!("{name}: every {every}, fit {fit:.5} %, worst pole {:.2e}", worst(&poles, &roots));
        assert!(every >= 5 && fit > 99.999, "{name}: {every} {fit}");
        assert!(worst(&poles, &roots) < tolerance, "{name}: {poles:?} {roots:?}");
    }
}

#[test]
fn noise_needs_the_longer_horizon_that_thinning_gives() {
    let Some(Record { mut s, roots, .. }) = record("double-underdamped", 0.0) else { return };
    // 0.1 mm, uniform.
    for (k, s) in s.iter_mut().enumerate() {
        let x = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        *s += 2e-4
            * 3.0_f64.sqrt()
            * (((x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
    }
    let data = IoData::new(Vec::new(), vec![s], DT_S).unwrap();
    let (poles, fit, every) = identified(&data, 4);
    let options = SubspaceOptions { weighting: Weighting::N4sid, block_rows: BLOCK_ROWS, direct: true };
    let whole = Subspace::new(&data, options).unwrap().realize(4).unwrap();
    let whole = whole.model.poles().unwrap().into_iter().map(|z| z.ln() / DT_S).collect::<Vec<_>>();
    println!(
        "every {every}, fit {fit:.3} %, worst pole {:.2e}, unthinned {:.2e}",
        worst(&poles, &roots),
        worst(&whole, &roots)
    );
    // The horizon grows 29 times, and it is the horizon that tells a slow mode from noise: five times nearer at least.
    assert!(worst(&poles, &roots) < worst(&whole, &roots) / 5.0, "{poles:?} {whole:?}");
}

#[test]
fn acceleration_to_displacement_from_before_the_contact_is_a_double_integrator() {
    for name in ["double-underdamped", "double-mixed", "double-overdamped"] {
        let Some(Record { a, s, .. }) = record(name, -0.02) else { return };
        let data = IoData::single(a, s, DT_S).unwrap();
        let (poles, fit, every) = identified(&data, 2);
        println!("{name}: every {every}, fit {fit:.6} %, {poles:.4?}");
        // A double pole splits by the square root of what thinning leaves; 1/(0.27 s) is the slowest motion that the
        // record tells from none.
        assert!(poles.iter().all(|s| s.norm() < 3.7) && fit > 99.9, "{name}: {poles:?} {fit}");
    }
}

#[test]
fn a_record_from_the_contact_on_does_not_excite_and_that_is_seen() {
    let Some(Record { a, s, .. }) = record("double-underdamped", 0.0) else { return };
    let data = IoData::single(a, s, DT_S).unwrap();
    let thin = thinned(&data, 20).unwrap();
    let options = SubspaceOptions { weighting: Weighting::N4sid, block_rows: BLOCK_ROWS, direct: true };
    // Four exponentials in everything.
    assert_eq!(Subspace::new(&thin, options).unwrap().excitation(), (4, 20));
    let Some(Record { a, s, .. }) = record("double-underdamped", -0.02) else { return };
    let data = IoData::single(a, s, DT_S).unwrap();
    assert_eq!(Subspace::new(&thinned(&data, 5).unwrap(), options).unwrap().excitation(), (20, 20));
}
