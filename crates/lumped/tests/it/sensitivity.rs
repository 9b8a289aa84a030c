//! Derivatives of every model's motion against central differences of it.

use std::collections::BTreeMap;

use crumple_lumped::{Chain, CrushedLoadPaths, CrushedStructure, Instants, LoadPath, Model, ModelKind, Motion};

const V0: f64 = 9.7222;

fn model(kind: ModelKind) -> Model {
    if kind == ModelKind::ForceDeflection {
        let knots = [(0.05, 9e4), (0.12, 8e4), (0.3, 1.6e5), (0.5, 2.2e5)];
        return Model::ForceDeflection(CrushedStructure::new(873.0, &knots, 9e6, 0.012).unwrap());
    }
    if kind == ModelKind::LoadPaths {
        let path = |knots: &[(f64, f64)], unloading| Some(LoadPath::new(knots, unloading, 0.012).unwrap());
        let front = path(&[(0.06, 7e4), (0.2, 9e4), (0.4, 1.2e5)], 8e6);
        let rear = path(&[(0.03, 5e4), (0.2, 1.1e5)], 9e6);
        let parallel = path(&[(0.1, 4e4), (0.3, 5e4), (0.5, 9e4)], 7e6);
        return Model::LoadPaths(CrushedLoadPaths { m1_kg: 200.0, m2_kg: 673.0, paths: [front, rear, parallel] });
    }
    let values: &[f64] = match kind {
        ModelKind::Kelvin => &[873.0, 3.2e5, 6e3],
        ModelKind::Elastoplastic => &[873.0, 3.2e5, 9e6],
        ModelKind::Maxwell => &[873.0, 2.3e6, 3.4e4],
        ModelKind::Nonlinear1 => &[873.0, 23_700.0, 253_440.0, 56_816.0, 19_956.0, 1_795.0, 2.8, 0.5063, V0],
        ModelKind::Nonlinear2 => {
            &[873.0, 82_357.0, 40_000.0, 197_519.0, 0.4, 86_585.0, 50_056.0, 18_721.0, 2_000.0, 2.55, 7.23, 0.5063, V0]
        }
        ModelKind::DoubleSpringMassDamper => &[300.0, 900.0, 5e5, 7e5, 6e3, 9e3],
        ModelKind::TripleSpringMassDamper => &[150.0, 200.0, 900.0, 6e5, 5e5, 7e5, 6e3, 4e3, 9e3],
        ModelKind::ForceDeflection | ModelKind::LoadPaths | ModelKind::Chain => &[],
    };
    let named: BTreeMap<String, f64> =
        kind.parameter_names().iter().map(|n| (*n).to_owned()).zip(values.iter().copied()).collect();
    Model::from_parameters(kind, &named).unwrap()
}

fn moved(of: &Model, name: &str, by: f64) -> Model {
    let mut named = of.parameters();
    *named.get_mut(name).unwrap() *= 1.0 + by;
    Model::from_parameters(of.kind(), &named).unwrap()
}

fn parts(motion: &Motion) -> [&Vec<f64>; 3] {
    [&motion.displacement_m, &motion.velocity_m_per_s, &motion.acceleration_m_per_s2]
}

#[test]
fn derivatives_agree_with_central_differences() {
    let at = Instants { first_s: 0.0031, dt_s: 1.7e-3, samples: 70 };
    let h = 1e-6;
    for kind in ModelKind::ALL {
        let centre = model(kind);
        let (names, given) = (kind.parameter_names(), centre.parameters());
        let all: Vec<usize> = (0..names.len()).filter(|p| given.contains_key(names[*p])).collect();
        let found = centre.sensitivity(V0, &at, &all).unwrap();
        for (p, name) in all.iter().map(|p| names[*p]).enumerate() {
            // The motion begins on the last knot of the damper, a kink: differences to the side it moves to.
            let one_sided = name == "v0_m_per_s";
            let (a, b) = if one_sided { (2.0 * h, h) } else { (h, -h) };
            let up = moved(&centre, name, a).sensitivity(V0, &at, &[]).unwrap();
            let down = moved(&centre, name, b).sensitivity(V0, &at, &[]).unwrap();
            let value = given[name];
            for mass in 0..found.motions.len() {
                // Acceleration jumps or kinks in models with knots and plastic ones: a difference across is none.
                let smooth = matches!(
                    kind,
                    ModelKind::Kelvin
                        | ModelKind::Maxwell
                        | ModelKind::DoubleSpringMassDamper
                        | ModelKind::TripleSpringMassDamper
                );
                for part in 0..if smooth { 3 } else { 2 } {
                    let (up, down) = (parts(&up.motions[mass])[part], parts(&down.motions[mass])[part]);
                    let derivative = parts(&found.derivatives[p][mass])[part];
                    let size = parts(&found.motions[mass])[part].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                    for k in 0..at.samples {
                        let here = parts(&found.motions[mass])[part][k];
                        let difference = if one_sided {
                            (4.0 * down[k] - up[k] - 3.0 * here) / (2.0 * h)
                        } else {
                            (up[k] - down[k]) / (2.0 * h)
                        };
                        // Relative change by relative change. h² of the third derivative is 1e-11 here, rounding over h
                        // 1e-9; where a knot moves, the second derivative jumps: h of it.
                        let limit = if smooth { 1e-7 } else { 10.0 * h } * size;
                        let gap = (derivative[k] * value - difference).abs();
                        assert!(gap < limit, "{kind} {name} mass {mass} part {part} sample {k}: {gap:e} {limit:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn motions_are_those_of_the_response() {
    for kind in ModelKind::ALL {
        let model = model(kind);
        let whole = model.respond(V0, 1e-3, 120).unwrap();
        let at = Instants { first_s: 0.01, dt_s: 2e-3, samples: 50 };
        let found = model.sensitivity(V0, &at, &[]).unwrap();
        for (a, b) in found.motions.iter().zip(&whole.motions) {
            for k in 0..at.samples {
                let i = 10 + 2 * k;
                // Two exact methods: rounding of 120 steps.
                assert!((a.displacement_m[k] - b.displacement_m[i]).abs() < 1e-13, "{kind} {k}");
                assert!((a.acceleration_m_per_s2[k] - b.acceleration_m_per_s2[i]).abs() < 1e-9, "{kind} {k}");
            }
        }
    }
}

#[test]
fn derivatives_of_a_chain_of_any_length_agree_with_central_differences() {
    let (masses, springs, dampers) = ([150.0, 200.0, 120.0, 900.0], [6e5, 5e5, 9e5, 7e5], [6e3, 4e3, 2e3, 9e3]);
    let at = Instants { first_s: 0.0031, dt_s: 1.7e-3, samples: 60 };
    let all: Vec<usize> = (0..12).collect();
    let found = Chain::with_constants(&masses, &springs, &dampers).unwrap().sensitivity(V0, &at, &all).unwrap();
    let h = 1e-6;
    for place in all {
        let moved = |by: f64| {
            let mut values = [masses, springs, dampers].concat();
            values[place] *= 1.0 + by;
            let chain = Chain::with_constants(&values[..4], &values[4..8], &values[8..]).unwrap();
            (chain.sensitivity(V0, &at, &[]).unwrap().motions, values[place])
        };
        let ((up, _), (down, _), (_, value)) = (moved(h), moved(-h), moved(0.0));
        for mass in 0..4 {
            for part in 0..3 {
                let size = parts(&up[mass])[part].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                for k in 0..at.samples {
                    let difference = (parts(&up[mass])[part][k] - parts(&down[mass])[part][k]) / (2.0 * h);
                    let own = parts(&found.derivatives[place][mass])[part][k] * value;
                    // h² of the third derivative 1e-11, rounding over h 1e-9.
                    assert!((own - difference).abs() < 1e-7 * size, "{place} {mass} {part} {k}");
                }
            }
        }
    }
    let error = Chain::with_constants(&masses, &springs, &dampers).unwrap().sensitivity(V0, &at, &[12]).unwrap_err();
    assert_eq!(error.to_string(), "parameter is 12, expected the place of a mass, spring or damper of the chain");
}
