//! Own laws: the families written as such, derivatives, energies, and files that are refused.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crumple_lumped::{
    Chain, DoubleSpringMassDamper, Drive, Elastoplastic, HORIZON_S, Instants, Kelvin, Model, ModelKind, Nonlinear1,
    Nonlinear2, OwnLaw, OwnModel, PiecewiseLinear, Structure, TripleSpringMassDamper,
};

const V0: f64 = 15.0;
const AT: Instants = Instants { first_s: 0.0, dt_s: 1e-4, samples: 1500 };

/// A law of elements, with given masses and the parameters of a model under their own names.
fn own(masses: &[(&str, f64)], elements: &[(&str, &str, &str, &str)], values: &[(&str, f64)]) -> Structure {
    let mut text = String::new();
    for (name, kg) in masses {
        text += &format!("[[mass]]\nname = \"{name}\"\nmass = \"{kg:?} kg\"\n");
    }
    for (front, rear, force, unloading) in elements {
        text += &format!("[[element]]\nbetween = [\"{front}\", \"{rear}\"]\nforce = \"{force}\"\n");
        if !unloading.is_empty() {
            text += &format!("unloading = \"{unloading}\"\n");
        }
    }
    for (name, value) in values {
        text += &format!("[parameters.{name}]\nunit = \"1\"\nvalue = {value:?}\n");
    }
    let law = OwnLaw::read(&text).unwrap_or_else(|mistake| panic!("{mistake}\n{text}"));
    OwnModel::at_start(Arc::new(law), 0.0).unwrap().structure().unwrap()
}

/// Least time of a motion of several.
fn cost(structure: &Structure) -> Duration {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(structure.motions_at(V0, &AT).unwrap());
        start.elapsed()
    };
    (0..20).map(time).min().unwrap()
}

#[test]
fn elements_side_by_side_have_forces_of_their_own() {
    let parts = [("wall", "car", "k*x", ""), ("wall", "car", "c*v", "")];
    let values = [("k", 6e5), ("c", 2e4)];
    let drive = Drive::Impact(V0);
    let apart = own(&ONE, &parts, &values).dynamics(&drive, 1e-4, 800).unwrap();
    let names: Vec<&str> = apart.forces.iter().map(|force| force.name.as_str()).collect();
    assert_eq!(names, ["k", "k.2"]);
    let whole = own(&ONE, &[wall("k*x + c*v")], &values).dynamics(&drive, 1e-4, 800).unwrap();
    for k in 0..800 {
        let sum = apart.forces[0].force_n[k] + apart.forces[1].force_n[k];
        assert!((sum - whole.forces[0].force_n[k]).abs() < 1e-9 * 6e5, "{k}");
    }
}

/// The curve of a structure: knots at 0.2 and 0.4 m, straight beyond.
const CURVE: &str = "a*min(x, 0.2) + b*max(min(x, 0.4) - 0.2, 0) + c*max(x - 0.4, 0)";

/// Nine of the ten families as own laws. Not the Maxwell model: its inner state, the length of the spring in the
/// series, is no function of deflection and rate.
fn references() -> Vec<(Model, Structure)> {
    [of_one_mass(), nonlinear(), of_several_masses(), crushed()].concat()
}

fn wall(force: &'static str) -> (&'static str, &'static str, &'static str, &'static str) {
    ("wall", "car", force, "")
}

const ONE: [(&str, f64); 1] = [("car", 1200.0)];
const TWO: [(&str, f64); 2] = [("front", 300.0), ("rear", 900.0)];

fn of_one_mass() -> Vec<(Model, Structure)> {
    let kelvin = Kelvin { mass_kg: 1200.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 6e3 };
    let plastic = Elastoplastic {
        mass_kg: 1200.0,
        loading_stiffness_n_per_m: 4e5,
        unloading_stiffness_n_per_m: 9e6,
        release: true,
    };
    vec![
        (Model::Kelvin(kelvin), own(&ONE, &[wall("k*x + c*v")], &[("k", 4e5), ("c", 6e3)])),
        (Model::Elastoplastic(plastic), own(&ONE, &[("wall", "car", "k*x", "ku")], &[("k", 4e5), ("ku", 9e6)])),
    ]
}

fn nonlinear() -> Vec<(Model, Structure)> {
    let first = Nonlinear1 {
        mass_kg: 1200.0,
        k1_n_per_m: 2e5,
        k2_n_per_m: 5e5,
        c1_n_s_per_m: 1.2e4,
        c2_n_s_per_m: 6e3,
        c3_n_s_per_m: 3e3,
        v_thresh_m_per_s: 5.0,
        crush_m: 0.6,
        v0_m_per_s: V0,
    };
    let second = Nonlinear2 {
        mass_kg: 1200.0,
        k1_n_per_m: 2e5,
        k2_n_per_m: 5e5,
        k3_n_per_m: 4e5,
        x1_m: 0.3,
        c1_n_s_per_m: 1.2e4,
        c2_n_s_per_m: 6e3,
        c3_n_s_per_m: 3e3,
        c4_n_s_per_m: 4e3,
        v1_m_per_s: 4.0,
        v2_m_per_s: 9.0,
        crush_m: 0.6,
        v0_m_per_s: V0,
    };
    let own_first = [
        wall("(k + (l - k)*min(abs(x)/0.6, 1))*x"),
        wall("(c + (d - c)*min(abs(v)/5, 1) + (e - d)*max(min((abs(v) - 5)/10, 1), 0))*v"),
    ];
    let own_second = [
        wall("(k + (l - k)*min(abs(x)/0.3, 1) + (m - l)*max(min((abs(x) - 0.3)/0.3, 1), 0))*x"),
        wall(
            "(c + (d - c)*min(abs(v)/4, 1) + (e - d)*max(min((abs(v) - 4)/5, 1), 0) \
             + (f - e)*max(min((abs(v) - 9)/6, 1), 0))*v",
        ),
    ];
    let values = [("k", 2e5), ("l", 5e5), ("c", 1.2e4), ("d", 6e3), ("e", 3e3)];
    let more = [&values[..], &[("m", 4e5), ("f", 4e3)]].concat();
    vec![
        (Model::Nonlinear1(first), own(&ONE, &own_first, &values)),
        (Model::Nonlinear2(second), own(&ONE, &own_second, &more)),
    ]
}

fn of_several_masses() -> Vec<(Model, Structure)> {
    let double = DoubleSpringMassDamper {
        m1_kg: 300.0,
        m2_kg: 900.0,
        k1_n_per_m: 5e5,
        k2_n_per_m: 8e5,
        c1_n_s_per_m: 4e3,
        c2_n_s_per_m: 9e3,
    };
    let triple = TripleSpringMassDamper {
        masses_kg: [150.0, 150.0, 900.0],
        springs_n_per_m: [5e5, 9e5, 8e5],
        dampers_n_s_per_m: [4e3, 2e3, 9e3],
    };
    let springs = [PiecewiseLinear::new(&[(0.0, 2e5), (0.3, 5e5)]).unwrap(), PiecewiseLinear::constant(8e5)];
    let chain = Chain::new(&[300.0, 900.0], &springs, &[4e3, 9e3].map(PiecewiseLinear::constant)).unwrap();
    let row = [("wall", "front", "k*x + c*v", ""), ("front", "rear", "l*x + d*v", "")];
    let of_triple =
        [("wall", "a", "5e5*x + 4e3*v", ""), ("a", "b", "9e5*x + 2e3*v", ""), ("b", "c", "8e5*x + 9e3*v", "")];
    let of_chain =
        [("wall", "front", "(2e5 + 3e5*min(abs(x)/0.3, 1))*x + 4e3*v", ""), ("front", "rear", "8e5*x + 9e3*v", "")];
    let values = [("k", 5e5), ("l", 8e5), ("c", 4e3), ("d", 9e3)];
    vec![
        (Model::DoubleSpringMassDamper(double), own(&TWO, &row, &values)),
        (Model::TripleSpringMassDamper(triple), own(&[("a", 150.0), ("b", 150.0), ("c", 900.0)], &of_triple, &[])),
        (Model::Chain(chain), own(&TWO, &of_chain, &[])),
    ]
}

fn crushed() -> Vec<(Model, Structure)> {
    let model = |masses: &[(&str, f64)], path: &str, more: &[(&str, f64)]| {
        let knots = [("n", [1.2e5, 1.8e5, 3.8e5]), ("m", [0.2, 0.4, 0.9])];
        let knots = knots.into_iter().flat_map(|(unit, of)| (1..).zip(of).map(move |(j, value)| (unit, j, value)));
        let knots = knots.map(|(unit, j, value)| (format!("{path}knot{j}_{unit}"), value));
        let named = masses.iter().chain(more).map(|(name, value)| ((*name).to_owned(), *value));
        let parameters: BTreeMap<String, f64> = named.chain(knots).collect();
        Model::from_parameters(ModelKind::ForceDeflection, &parameters).unwrap()
    };
    let one = model(&[("mass_kg", 1200.0)], "", &[("unloading_stiffness_n_per_m", 9e6), ("rate_s_per_m", 0.01)]);
    let rear = [("rear_knot1_n", 3e5), ("rear_knot1_m", 0.3), ("rear_unloading_n_per_m", 9e6)];
    let paths = [&[("front_unloading_n_per_m", 9e6)], &rear[..]].concat();
    let two = model(&[("m1_kg", 300.0), ("m2_kg", 900.0)], "front_", &paths);
    let of_curve = [("a", 6e5), ("b", 3e5), ("c", 4e5), ("ku", 9e6)];
    let with_rate = format!("({CURVE})*(1 + r*max(v, 0))");
    let of_paths = [("wall", "front", CURVE, "ku"), ("front", "rear", "1e6*max(x, 0)", "ku")];
    vec![
        (one, own(&ONE, &[("wall", "car", &with_rate, "ku")], &[&of_curve[..], &[("r", 0.01)]].concat())),
        (two, own(&TWO, &of_paths, &of_curve)),
    ]
}

/// The same motion to 1e-9 of the largest displacement, speed and acceleration, at ten times the cost at most.
#[test]
fn families_written_as_own_laws_move_alike_at_most_ten_times_as_slow() {
    for (model, own) in references() {
        let built_in = model.structure().unwrap();
        let [expected, found] = [&built_in, &own].map(|structure| structure.motions_at(V0, &AT).unwrap());
        for (expected, found) in expected.iter().zip(&found) {
            let waves = [
                (&expected.displacement_m, &found.displacement_m),
                (&expected.velocity_m_per_s, &found.velocity_m_per_s),
                (&expected.acceleration_m_per_s2, &found.acceleration_m_per_s2),
            ];
            for (expected, found) in waves {
                let size = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let worst = expected.iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(worst <= 1e-9 * size, "{}: {worst} of {size}", model.kind());
            }
        }
        let [built_in, own] = [&built_in, &own].map(cost);
        assert!(own <= 10 * built_in + Duration::from_micros(20), "{}: {own:?} for {built_in:?}", model.kind());
    }
}

/// A law with every function, two masses, a rigid and a stated unloading, a parameter in two elements.
const EVERYTHING: &str = r#"
[[mass]]
name = "engine"
mass = "20%"
[[mass]]
name = "cabin"
[[element]]
between = ["wall", "engine"]
force = "k*x + c*v*x^2 + h*tanh(x/l)*sqrt(1 + x)*exp(-x)"
unloading = "ku"
[[element]]
between = ["engine", "cabin"]
force = "(2*k*x + 1e5*x^3)/(1 + r*v^2)"
unloading = "rigid"
[[element]]
between = ["wall", "cabin"]
force = "1e4*max(x - 0.3, 0) + 500*v*ln(2 + x)"
[parameters]
k = { unit = "N/m", lower = 1e4, upper = 1e6, start = 3e5 }
c = { unit = "N*s/m^3", lower = 1e2, upper = 1e5, start = 9e3 }
h = { unit = "N", lower = 1e3, upper = 1e6, start = 6e4 }
l = { unit = "m", lower = 0.01, upper = 1.0, start = 0.1 }
r = { unit = "s^2/m^2", lower = 1e-5, upper = 1e-1, start = 1e-3 }
ku = { unit = "N/m", lower = 1e6, upper = 1e8, start = 8e6 }
"#;

fn everything() -> OwnModel {
    OwnModel::at_start(Arc::new(OwnLaw::read(EVERYTHING).unwrap()), 1200.0).unwrap()
}

#[test]
fn names_carry_units_and_masses_follow_the_vehicle() {
    let model = everything();
    assert_eq!(
        model.names(),
        ["m1_kg", "m2_kg", "c_n_s_per_m3", "h_n", "k_n_per_m", "ku_n_per_m", "l_m", "r_s2_per_m2"]
    );
    assert_eq!(model.masses_kg(), [240.0, 960.0]);
    let law = Arc::new(model.law().clone());
    let again = OwnModel::from_parameters(law, &Model::Own(model.clone()).parameters()).unwrap();
    assert_eq!(again, model);
}

#[test]
fn derivatives_agree_with_differences_through_every_branch() {
    let model = everything();
    let structure = model.structure().unwrap();
    let places = model.places();
    let at = Instants { first_s: 0.0, dt_s: 1e-3, samples: 120 };
    let sensitivity = structure.sensitivity(V0, &at, &places).unwrap();
    for (p, value) in model.values().iter().enumerate() {
        let step = 1e-5 * value;
        let moved = |step: f64| {
            let mut values = model.values();
            values[p] += step;
            model.with_values(&values).structure().unwrap().motions_at(V0, &at).unwrap()
        };
        let (up, down) = (moved(step), moved(-step));
        for mass in 0..2 {
            let derivative = &sensitivity.derivatives[p][mass].displacement_m;
            let size = derivative.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            for (k, derivative) in derivative.iter().enumerate() {
                let difference = (up[mass].displacement_m[k] - down[mass].displacement_m[k]) / (2.0 * step);
                // The square of the step times the third derivative, some 1e-8, and rounding, 1e-15/1e-5 of the motion.
                assert!((derivative - difference).abs() <= 1e-5 * size, "{p} {mass} {k}: {derivative} {difference}");
            }
        }
    }
}

#[test]
fn energies_add_up() {
    let structure = everything().structure().unwrap();
    let dynamics = structure.dynamics(&Drive::Impact(V0), 1e-3, 150).unwrap();
    for energy in &dynamics.energy {
        let spent = energy.kinetic_j + energy.stored_j + energy.dissipated_j;
        // Of the five-point rule over 32 pieces, where a force has a corner.
        assert!((spent - energy.input_j).abs() <= 1e-5 * energy.input_j, "{energy:?}");
    }
    assert!(structure.events(V0, HORIZON_S).unwrap()[1].dynamic_crush_m.is_some());
}

#[test]
fn a_law_that_gives_no_number_says_so() {
    let fault = |force: &str| {
        let text = format!("[[element]]\nforce = \"{force}\"\n[parameters]\nk = {{ unit = \"N\", value = 1e5 }}\n");
        let model = OwnModel::at_start(Arc::new(OwnLaw::read(&text).unwrap()), 1000.0).unwrap();
        assert!(model.structure().unwrap().motions_at(V0, &AT).is_err());
        model.fault_at(V0).unwrap()
    };
    assert_eq!(fault("k/x"), "the force of element 1 is no number at x = 0 and v = 15.00 m/s");
    assert_eq!(fault("k*ln(x - 1)"), "the force of element 1 is no number at x = 0 and v = 15.00 m/s");
    assert_eq!(fault("k*x^1.5"), "the force of element 1 has no Taylor series at x = 0 and v = 15.00 m/s");
}

/// Text, line and column, and a part of what is said.
const REFUSED: [(&str, [usize; 2], &str); 22] = [
    ("", [1, 1], "no element"),
    ("[[element]\nforce = \"1\"", [1, 11], "docs/how-to/own-model.md"),
    ("[[element]]\n", [1, 1], "missing field `force`"),
    ("[[element]]\nforce = \"2*x\"\nfriction = 1\n", [3, 1], "unknown field `friction`"),
    ("[[element]]\nforce = \"k*x\"\n", [2, 10], "found \"k\", expected one of x, v: state it under [parameters]"),
    ("[[element]]\nforce = \"2 x\"\n", [2, 12], "found \"x\", expected an operator"),
    ("[[element]]\nforce = \"2*(x + 1\"\n", [2, 18], "found the end of the expression, expected \")\""),
    ("[[element]]\nforce = \"2*x +\"\n", [2, 15], "expected a number, x, v, a parameter"),
    ("[[element]]\nforce = \"2*sin(x)\"\n", [2, 12], "found the function \"sin\", expected one of abs, min"),
    ("[[element]]\nforce = \"min(x)\"\n", [2, 10], "found 1 for min, expected two arguments"),
    ("[[element]]\nforce = \"1.2.3*x\"\n", [2, 10], "found \"1.2.3\", expected a number"),
    ("[[element]]\nforce = \"x # v\"\n", [2, 12], "found '#', expected an operator"),
    ("[[element]]\nforce = \"abs(x^3)\"\n", [2, 10], "the second at most"),
    ("[[element]]\nforce = \"2*x\"\nunloading = \"5*x\"\n", [3, 14], "an unloading stiffness is constant"),
    ("[[element]]\nforce = \"2*x\"\nbetween = [\"wall\", \"engine\"]\n", [3, 11], "expected wall or one of car"),
    ("[[element]]\nforce = \"2*x\"\nbetween = [\"car\", \"car\"]\n", [1, 1], "the same end twice"),
    ("[[element]]\nforce = \"k*x\"\n[parameters]\nk = { unit = \"N/m\", lower = 1 }\n", [4, 5], "expected both"),
    (
        "[[element]]\nforce = \"k*x\"\n[parameters]\nk = { unit = \"N/m\", lower = -1, upper = 2 }\n",
        [4, 5],
        "0 < lower",
    ),
    ("[[element]]\nforce = \"k*x\"\n[parameters]\nk = { unit = \"€\", value = 1 }\n", [4, 5], "found the unit \"€\""),
    ("[[element]]\nforce = \"2*x\"\n[parameters]\nk = { unit = \"N/m\", value = 1 }\n", [4, 5], "in no force"),
    ("[[element]]\nforce = \"2*x\"\n[parameters]\nmax = { unit = \"N/m\", value = 1 }\n", [4, 7], "the name \"max\""),
    (
        "[[mass]]\nname = \"a\"\n[[mass]]\nname = \"b\"\n[[element]]\nbetween = [\"wall\", \"a\"]\nforce = \"2*x\"\n",
        [1, 1],
        "found 2 masses that are the rest",
    ),
];

#[test]
fn files_with_a_mistake_are_refused_with_their_place() {
    for (text, [line, column], says) in REFUSED {
        let mistake = OwnLaw::read(text).expect_err(text);
        assert!(mistake.problem.contains(says), "{text}\n{mistake}");
        assert_eq!([mistake.line, mistake.column], [line, column], "{text}\n{mistake}");
    }
}

/// Sizes are bounded: what is too deep, too long or too much is refused, in no time.
#[test]
fn what_is_too_large_is_refused() {
    let of_force = |force: String| OwnLaw::read(&format!("[[element]]\nforce = \"{force}\"\n")).unwrap_err().problem;
    let deep = format!("{}x{}", "(".repeat(500), ")".repeat(500));
    assert!(of_force(deep).contains("brackets within brackets"));
    assert!(of_force(format!("{}x", "-".repeat(500))).contains("within each other"));
    assert!(of_force(vec!["x"; 600].join("+")).contains("more than 400 operations"));
    assert!(of_force(vec!["x"; 1200].join("+")).contains("characters"));
    assert!(of_force(vec!["abs(x)"; 30].join("+")).contains("more than 16 of abs, min and max"));
    let elements = "[[element]]\nforce = \"x\"\n".repeat(40);
    assert!(OwnLaw::read(&elements).unwrap_err().problem.contains("expected 30 at most"));
    assert!(OwnLaw::read(&" ".repeat(70_000)).unwrap_err().problem.contains("bytes"));
}
