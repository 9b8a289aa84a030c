//! Structures of any elements between any nodes: presets and closed forms, derivatives, energies, load paths.

use crumple_lumped::{
    Asked, Connection, Damper, Drive, Elastoplastic, Element, HORIZON_S, Instants, Kelvin, LumpedError, Maxwell, Model,
    ModelKind, Motion, Node, PiecewiseLinear, Place, PlasticSpring, SeriesSpringDamper, Spring, State, Structure,
    Waves,
};
use proptest::prelude::*;

const V0: f64 = 12.0;

fn curve(points: &[(f64, f64)]) -> PiecewiseLinear {
    PiecewiseLinear::new(points).unwrap()
}

fn plastic(loading_stiffness_n_per_m: f64, unloading_stiffness_n_per_m: f64, release: bool) -> Element {
    PlasticSpring { loading_stiffness_n_per_m, unloading_stiffness_n_per_m, release }.into()
}

fn series(stiffness_n_per_m: f64, damping_n_s_per_m: f64) -> Element {
    SeriesSpringDamper { stiffness_n_per_m, damping_n_s_per_m }.into()
}

fn between(front: Node, rear: Node, element: impl Into<Element>) -> Connection {
    Connection { front, rear, element: element.into() }
}

/// Two masses and a load path past the first: every kind of element.
fn every_element(factors: [f64; 12]) -> Structure {
    let [m1, m2, ke, kp, k, ks, cs, k1, k2, x1, c1, c2] = factors;
    let (first, second) = (Node::Mass(0), Node::Mass(1));
    let connections = vec![
        between(Node::Wall, first, plastic(ke * 4e5, kp * 6e6, true)),
        between(Node::Wall, second, Spring(curve(&[(0.0, k * 6e4)]))),
        between(first, second, series(ks * 2e6, cs * 3e4)),
        between(first, second, Spring(curve(&[(0.0, k1 * 2e5), (x1 * 0.02, k2 * 5e5)]))),
        between(first, second, Damper(curve(&[(0.0, c1 * 6e3), (3.0, c2 * 2e3)]))),
    ];
    Structure::new(vec![m1 * 300.0, m2 * 900.0], connections).unwrap()
}

/// Places of the factors of [`every_element`], and what each multiplies.
fn places() -> [(Place, f64); 12] {
    let element = |connection, parameter| Place::Element { connection, parameter };
    [
        (Place::Mass(0), 300.0),
        (Place::Mass(1), 900.0),
        (element(0, 0), 4e5),
        (element(0, 1), 6e6),
        (element(1, 0), 6e4),
        (element(2, 0), 2e6),
        (element(2, 1), 3e4),
        (element(3, 0), 2e5),
        (element(3, 2), 5e5),
        (element(3, 3), 0.02),
        (element(4, 0), 6e3),
        (element(4, 2), 2e3),
    ]
}

fn waves(motion: &Motion) -> [&Vec<f64>; 3] {
    [&motion.displacement_m, &motion.velocity_m_per_s, &motion.acceleration_m_per_s2]
}

fn largest(wave: &[f64]) -> f64 {
    wave.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Largest difference of two motions, each wave over its own size.
fn apart(a: &Motion, b: &Motion) -> f64 {
    let of_wave = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        let gap = a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        if gap == 0.0 { 0.0 } else { gap / largest(b) }
    };
    waves(a).into_iter().zip(waves(b)).map(of_wave).fold(0.0, f64::max)
}

/// The exact state of an elastoplastic model at `t_s >= 0`, in closed form.
fn elastoplastic_state(model: &Elastoplastic, impact_speed_m_per_s: f64, t_s: f64) -> State {
    let loading = (model.loading_stiffness_n_per_m / model.mass_kg).sqrt();
    let unloading = (model.unloading_stiffness_n_per_m / model.mass_kg).sqrt();
    let t_m = std::f64::consts::FRAC_PI_2 / loading;
    if t_s <= t_m {
        let (sine, cosine) = (loading * t_s).sin_cos();
        return State {
            displacement_m: impact_speed_m_per_s / loading * sine,
            velocity_m_per_s: impact_speed_m_per_s * cosine,
            acceleration_m_per_s2: -impact_speed_m_per_s * loading * sine,
        };
    }
    let set = model.permanent_set_m(impact_speed_m_per_s);
    let rebound_depth =
        impact_speed_m_per_s / loading * model.loading_stiffness_n_per_m / model.unloading_stiffness_n_per_m;
    let since = t_s - t_m;
    let opens = std::f64::consts::FRAC_PI_2 / unloading;
    if model.release && since >= opens {
        let velocity = -rebound_depth * unloading;
        return State {
            displacement_m: set + velocity * (since - opens),
            velocity_m_per_s: velocity,
            acceleration_m_per_s2: 0.0,
        };
    }
    let (sine, cosine) = (unloading * since).sin_cos();
    State {
        displacement_m: set + rebound_depth * cosine,
        velocity_m_per_s: -rebound_depth * unloading * sine,
        acceleration_m_per_s2: -rebound_depth * unloading * unloading * cosine,
    }
}

/// A closed form at `k dt`.
fn closed(state: impl Fn(f64) -> State, dt_s: f64, samples: usize) -> Motion {
    let states: Vec<State> = (0..samples).map(|k| state(k as f64 * dt_s)).collect();
    Motion {
        displacement_m: states.iter().map(|s| s.displacement_m).collect(),
        velocity_m_per_s: states.iter().map(|s| s.velocity_m_per_s).collect(),
        acceleration_m_per_s2: states.iter().map(|s| s.acceleration_m_per_s2).collect(),
    }
}

proptest! {
    #[test]
    fn presets_move_as_their_closed_forms(
        m in 500.0..2500.0f64, k in 1e5..1e6f64, ratio in 1.0..200.0f64, damping in 0.0..4.0f64, release: bool,
    ) {
        let critical = 2.0 * (k * m).sqrt();
        let kelvin = Kelvin { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: damping * critical };
        // Critical at a quarter of it: complex and real roots.
        let c = (0.05 + damping) * 0.25 * critical;
        let maxwell = Maxwell { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: c };
        let elastoplastic = Elastoplastic {
            mass_kg: m,
            loading_stiffness_n_per_m: k,
            unloading_stiffness_n_per_m: k * ratio,
            release,
        };
        let respond = |model: Model| model.respond(V0, 2e-4, 1001).unwrap().motions.remove(0);
        // A thousand roundings, of numbers that a stiff damper makes smaller than what they are made of.
        let gap = apart(&respond(Model::Kelvin(kelvin)), &closed(|t| kelvin.state(V0, t), 2e-4, 1001));
        prop_assert!(gap < 1e-12, "kelvin {gap:e}");
        let gap = apart(&respond(Model::Maxwell(maxwell)), &closed(|t| maxwell.state(V0, t), 2e-4, 1001));
        prop_assert!(gap < 1e-12, "maxwell {gap:e}");
        // The position is right to 1e-15, the force on a line 200 times as stiff to as many times that; attached, it
        // swings on that line for up to 40 periods.
        let plastic = closed(|t| elastoplastic_state(&elastoplastic, V0, t), 2e-4, 1001);
        let gap = apart(&respond(Model::Elastoplastic(elastoplastic)), &plastic);
        prop_assert!(gap < 1e-11, "elastoplastic {gap:e}");

        let close = |a: Option<f64>, b: Option<f64>| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-11 * b.abs(),
            (a, b) => a == b,
        };
        for (found, wanted) in [
            (Model::Kelvin(kelvin).events(V0).unwrap(), kelvin.events(V0)),
            (Model::Elastoplastic(elastoplastic).events(V0).unwrap(), elastoplastic.events(V0)),
        ] {
            prop_assert!(close(found.time_of_dynamic_crush_s, wanted.time_of_dynamic_crush_s));
            prop_assert!(close(found.dynamic_crush_m, wanted.dynamic_crush_m));
            // Where damping has eaten all but 1e-4 of the motion, a rounding of the rest is 1e-12 of it.
            prop_assert!(damping > 1.5 || close(found.time_of_rebound_s, wanted.time_of_rebound_s));
        }
    }

    #[test]
    fn energy_closes_whatever_is_joined(
        a in prop::array::uniform6(0.3..3.0f64), b in prop::array::uniform6(0.3..3.0f64),
    ) {
        let mut factors = [1.0; 12];
        factors[..6].copy_from_slice(&a);
        factors[6..].copy_from_slice(&b);
        let structure = every_element(factors);
        let pulse: Vec<f64> = (0..500).map(|k| 2e5 * (f64::from(k) * 0.01).sin().powi(2)).collect();
        let sled: Vec<f64> = (0..600).map(|k| -200.0 * (f64::from(k) * 0.006).sin()).collect();
        for drive in [Drive::Impact(V0), Drive::Force { mass: 1, samples: pulse }, Drive::BaseAcceleration(sled)] {
            let found = structure.dynamics(&drive, 1e-4, 1001).unwrap();
            // A thousand steps, heat and work each right to about 1e-15 of the energy.
            let closure = found.energy_closure().unwrap();
            prop_assert!(closure < 1e-11, "{drive:?} {closure:e}");
            for pair in found.energy.windows(2) {
                prop_assert!(pair[1].dissipated_j >= pair[0].dissipated_j - 1e-9, "cools");
            }
        }
    }

    #[test]
    fn parallel_load_paths_are_one_element_of_their_sum(
        share in 0.1..0.9f64, k in 1e5..1e6f64, c in 1e3..3e4f64, ratio in 1.0..50.0f64,
    ) {
        let paths = |split: &[f64]| {
            let element = |share: &f64| {
                let spring = Spring(curve(&[(0.0, share * k), (0.1, share * 2.0 * k), (0.4, share * k)]));
                let damper = Damper(curve(&[(0.0, share * c), (4.0, share * 0.2 * c)]));
                [
                    between(Node::Wall, Node::Mass(0), spring),
                    between(Node::Wall, Node::Mass(0), damper),
                    between(Node::Wall, Node::Mass(0), plastic(share * k, share * ratio * k, true)),
                    between(Node::Mass(0), Node::Mass(1), series(share * 5.0 * k, share * 3.0 * c)),
                ]
            };
            let connections = split.iter().flat_map(element).collect();
            Structure::new(vec![300.0, 900.0], connections).unwrap()
        };
        let at = Instants { first_s: 0.0, dt_s: 1e-3, samples: 200 };
        let (one, two) = (paths(&[1.0]), paths(&[share, 1.0 - share]));
        for (a, b) in one.motions_at(V0, &at).unwrap().iter().zip(&two.motions_at(V0, &at).unwrap()) {
            // Some hundred steps right to 1e-15, forces on lines up to fifty times as stiff.
            prop_assert!(apart(a, b) < 1e-11, "{:e}", apart(a, b));
        }
    }

    #[test]
    fn maxwell_elements_in_a_row_are_a_sum_of_closed_forms(
        m1 in 100.0..1e3f64, m2 in 100.0..1e3f64, k1 in 1e5..1e6f64, k2 in 1e5..1e6f64, relaxation_s in 0.01..0.2f64,
    ) {
        // All springs relax alike, so M v'' + M v'/T + K v = 0 falls apart into the modes of K: each a Maxwell model
        // of unit mass and stiffness λ.
        let fronts = [vec![series(k1, relaxation_s * k1)], vec![series(k2, relaxation_s * k2)]];
        let structure = Structure::row(&[m1, m2], fronts).unwrap();
        let (trace, determinant) = ((k1 + k2) / m1 + k2 / m2, k1 * k2 / (m1 * m2));
        let root = (trace * trace / 4.0 - determinant).sqrt();
        // The smaller from the product, without a difference.
        let large = trace / 2.0 + root;
        let modes = [large, determinant / large];
        // (1, 1) as a sum of the modes (1, r): r from the second row, k2/m2 (1 - r) = -λ r.
        let shape = modes.map(|lambda| 1.0 / (1.0 - lambda * m2 / k2));
        let weight = [(1.0 - shape[1]) / (shape[0] - shape[1]), (shape[0] - 1.0) / (shape[0] - shape[1])];
        let at = Instants { first_s: 0.0, dt_s: 1e-3, samples: 150 };
        let found = structure.motions_at(V0, &at).unwrap();
        for (mass, motion) in found.iter().enumerate() {
            let speed = |t: f64| -> f64 {
                let of_mode = |j: usize| {
                    let damping_n_s_per_m = modes[j] * relaxation_s;
                    let mode = Maxwell { mass_kg: 1.0, stiffness_n_per_m: modes[j], damping_n_s_per_m };
                    weight[j] * [1.0, shape[j]][mass] * mode.state(V0, t).velocity_m_per_s
                };
                of_mode(0) + of_mode(1)
            };
            for (k, v) in motion.velocity_m_per_s.iter().enumerate() {
                // 150 roundings of 12 m/s; modes nearly alike cost what their difference is small.
                prop_assert!((v - speed(k as f64 * 1e-3)).abs() < 1e-11, "{mass} {k}");
            }
        }
    }
}

#[test]
fn derivatives_by_every_parameter_agree_with_central_differences() {
    let at = Instants { first_s: 0.0031, dt_s: 1.7e-3, samples: 90 };
    let all: Vec<Place> = places().iter().map(|(place, _)| *place).collect();
    let found = every_element([1.0; 12]).sensitivity(V0, &at, &all).unwrap();
    let h = 1e-6;
    for (p, (_, scale)) in places().iter().enumerate() {
        let moved = |by: f64| {
            let mut factors = [1.0; 12];
            factors[p] += by;
            every_element(factors).motions_at(V0, &at).unwrap()
        };
        let (up, down) = (moved(h), moved(-h));
        for mass in 0..2 {
            // Accelerations kink at an event: a difference across is none.
            for part in 0..2 {
                let (up, down) = (waves(&up[mass])[part], waves(&down[mass])[part]);
                let size = largest(waves(&found.motions[mass])[part]);
                for k in 0..at.samples {
                    let difference = (up[k] - down[k]) / (2.0 * h);
                    let derivative = waves(&found.derivatives[p][mass])[part][k] * scale;
                    // Rounding over h is 1e-9; where an event moves, the second derivative jumps: h of it.
                    assert!((derivative - difference).abs() < 10.0 * h * size, "{p} {mass} {part} {k}");
                }
            }
        }
        let moves = |motion: &Motion| largest(&motion.displacement_m) * scale > 1e-5;
        assert!(found.derivatives[p].iter().any(moves), "parameter {p} changes nothing");
    }
}

/// A linear structure of two masses, and every place of it.
fn linear() -> (Structure, Vec<Place>) {
    let values = [300.0, 900.0, 5e5, 8e5, 9e3, 5e3];
    let model = Model::of_values(ModelKind::DoubleSpringMassDamper, &values).unwrap();
    (model.structure().unwrap(), model.places())
}

#[test]
fn a_derivative_is_the_same_to_the_last_bit_beside_any_others_and_of_one_mass_alone() {
    let all_places: Vec<Place> = places().into_iter().map(|(place, _)| place).collect();
    let at = Instants { first_s: 0.01, dt_s: 1e-3, samples: 60 };
    for (structure, places) in [(every_element([1.0; 12]), all_places), linear()] {
        let whole = structure.sensitivity(V0, &at, &places).unwrap();
        for count in [1, 3, 5, 6] {
            let first = places.len() - count;
            let asked = Asked { waves: Waves::Velocity, mass: Some(1) };
            let few = structure.sensitivity_of(asked, V0, &at, &places[first..]).unwrap();
            assert_eq!(few.motions[0], Motion::default());
            assert_eq!(few.motions[1].velocity_m_per_s, whole.motions[1].velocity_m_per_s);
            for (few, whole) in few.derivatives.iter().zip(&whole.derivatives[first..]) {
                assert_eq!(few[1].velocity_m_per_s, whole[1].velocity_m_per_s, "{count}");
            }
        }
    }
}

#[test]
fn the_dynamic_crush_alone_is_that_of_all_events() {
    for structure in [every_element([1.0; 12]), linear().0] {
        let crush = structure.events(V0, HORIZON_S).unwrap()[1].dynamic_crush_m;
        assert!(crush.is_some());
        assert_eq!(structure.dynamic_crush_m(V0, HORIZON_S).unwrap(), crush);
    }
}

#[test]
fn elements_that_turn_at_the_same_instant_are_taken_one_by_one() {
    // Four plastic springs between the same nodes: one event at every turn for each.
    let quarter = || between(Node::Wall, Node::Mass(0), plastic(1e5, 2e6, true));
    let structure = Structure::new(vec![900.0], vec![quarter(), quarter(), quarter(), quarter()]).unwrap();
    let model = Elastoplastic {
        mass_kg: 900.0,
        loading_stiffness_n_per_m: 4e5,
        unloading_stiffness_n_per_m: 8e6,
        release: true,
    };
    let at = Instants { first_s: 0.0, dt_s: 1e-4, samples: 2001 };
    let found = structure.motions_at(V0, &at).unwrap();
    // Position to 1e-15, the force of the line twenty times as stiff to as many times that.
    assert!(apart(&found[0], &closed(|t| elastoplastic_state(&model, V0, t), 1e-4, 2001)) < 1e-12);
}

#[test]
fn masses_that_nothing_holds_keep_their_momentum() {
    let pair = Structure::new(
        vec![400.0, 800.0],
        vec![between(Node::Mass(0), Node::Mass(1), Spring(curve(&[(0.0, 1e5), (0.1, 4e5)])))],
    )
    .unwrap();
    // A force on the rear mass for 50 ms: from then on the momentum stands.
    let drive = Drive::Force { mass: 1, samples: vec![1e5; 51] };
    let found = pair.dynamics(&drive, 1e-3, 201).unwrap();
    // 50 intervals and the fall to zero.
    let wanted = 1e5 * 0.0505;
    for k in 60..201 {
        let v = |mass: usize| found.response.motions[mass].velocity_m_per_s[k];
        // Two hundred steps of 1e-16 of 5 kN·s.
        assert!((400.0 * v(0) + 800.0 * v(1) - wanted).abs() < 1e-9);
    }
    assert!(found.energy_closure().unwrap() < 1e-12);
    assert_eq!(found.forces[0].name, "k2");
}

#[test]
fn what_is_no_structure_is_refused() {
    let spring = || Spring(curve(&[(0.0, 1e5)]));
    let refused = |masses: &[f64], front: Node, rear: Node| {
        matches!(Structure::new(masses.to_vec(), vec![between(front, rear, spring())]), Err(LumpedError::Value { .. }))
    };
    assert!(refused(&[], Node::Wall, Node::Wall));
    assert!(refused(&[1.0], Node::Wall, Node::Mass(1)));
    assert!(refused(&[1.0], Node::Mass(0), Node::Mass(0)));
    assert!(refused(&[-1.0], Node::Wall, Node::Mass(0)));
    let at = Instants { first_s: 0.0, dt_s: 1e-3, samples: 5 };
    let places = [Place::Element { connection: 5, parameter: 0 }];
    assert!(every_element([1.0; 12]).sensitivity(V0, &at, &places).is_err());
}

/// The motion of an elastoplastic model at one instant.
fn instant(model: &Elastoplastic, v0: f64, t_s: f64) -> Motion {
    let at = Instants { first_s: t_s, dt_s: 1e-4, samples: 1 };
    model.structure().unwrap().motions_at(v0, &at).unwrap().remove(0)
}

#[test]
fn returns_the_square_of_the_restitution_as_energy() {
    let model = Elastoplastic {
        mass_kg: 900.0,
        loading_stiffness_n_per_m: 3e5,
        unloading_stiffness_n_per_m: 1.2e7,
        release: true,
    };
    let v0 = 12.0;
    let velocity_m_per_s = instant(&model, v0, 1.0).velocity_m_per_s[0];
    let returned = velocity_m_per_s.powi(2) / (v0 * v0);
    // Some roundings at each of two turns, of a velocity six times as large.
    assert!((returned - 3e5 / 1.2e7).abs() < 1e-14);
    // Absorbed: the triangle under loading minus that under unloading.
    let events = model.events(v0);
    let crush = events.dynamic_crush_m.unwrap();
    let depth = crush - model.permanent_set_m(v0);
    let absorbed = 0.5 * 3e5 * crush * crush - 0.5 * 1.2e7 * depth * depth;
    let lost = 0.5 * 900.0 * (v0 * v0 - velocity_m_per_s.powi(2));
    // Some roundings of numbers near 6e4 J.
    assert!((absorbed - lost).abs() < 1e-9, "{absorbed} {lost}");
}

#[test]
fn displacement_and_force_are_continuous_at_the_crush() {
    let model = Elastoplastic {
        mass_kg: 900.0,
        loading_stiffness_n_per_m: 3e5,
        unloading_stiffness_n_per_m: 1.2e7,
        release: false,
    };
    let t = model.events(12.0).time_of_dynamic_crush_s.unwrap();
    let (before, after) = (instant(&model, 12.0, t - 1e-9), instant(&model, 12.0, t + 1e-9));
    assert!((before.displacement_m[0] - after.displacement_m[0]).abs() < 1e-12);
    // The slopes of the force differ, its value does not: 1e-9 s at rest changes it by less than 1e-6 m/s².
    assert!((before.acceleration_m_per_s2[0] - after.acceleration_m_per_s2[0]).abs() < 1e-6);
}
