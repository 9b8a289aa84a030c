//! Time of one simulation, each beside a plain memory pass over as many samples and a naive integrator at equal error.
//!
//! `cargo bench -p crumple-lumped --bench simulate`

#![allow(clippy::unwrap_used, reason = "a benchmark that cannot run has no figure")]

use std::hint::black_box;

use crumple_lumped::{
    CollisionQuestions, DoubleSpringMassDamper, Drive, ForceDeflection, ForceDeflectionParameter, Instants, Model,
    Place, Structure, Waves,
};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};
use crumple_testkit::table_5;

/// One figure beside a copy of what it writes, so many samples.
fn figure(name: &str, samples: usize, run: impl FnMut()) -> Figure {
    Figure::new(name, best_s(run), memory_pass_s(&vec![1.0; samples]))
}

fn time(name: &str, samples: usize, run: impl FnMut()) {
    figure(name, samples, run).print();
}

/// Instants at which errors are measured, evenly over the record.
const CHECKS: usize = 20;

/// Displacements of the last mass at the checks, by `steps` steps of the classical Runge-Kutta method in all.
fn runge_kutta<const N: usize>(
    start: [f64; N],
    end_s: f64,
    steps: usize,
    at: usize,
    f: impl Fn(&[f64; N]) -> [f64; N],
) -> [f64; CHECKS] {
    let mut z = start;
    let h = end_s / steps as f64;
    let moved = |z: &[f64; N], k: &[f64; N], h: f64| -> [f64; N] { std::array::from_fn(|i| z[i] + h * k[i]) };
    std::array::from_fn(|_| {
        for _ in 0..steps / CHECKS {
            let k1 = f(&z);
            let k2 = f(&moved(&z, &k1, 0.5 * h));
            let k3 = f(&moved(&z, &k2, 0.5 * h));
            let k4 = f(&moved(&z, &k3, h));
            z = std::array::from_fn(|i| z[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        z[at]
    })
}

/// Largest difference at the checks.
fn largest(a: &[f64; CHECKS], b: &[f64; CHECKS]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// Fewest steps, to a fifth, whose measured error is at most `bound_m`; and that error.
fn steps_for(bound_m: f64, exact: &[f64; CHECKS], run: impl Fn(usize) -> [f64; CHECKS]) -> (usize, f64) {
    let mut per_check = 1;
    loop {
        let steps = CHECKS * per_check;
        let error = largest(&run(steps), exact);
        if error <= bound_m || steps > 200_000 {
            return (steps, error);
        }
        per_check += (per_check / 5).max(1);
    }
}

/// Parameter sets that are worked on side by side.
const LANES: usize = 8;
/// Samples kept in the lanes' order before they go to their rows.
const BLOCK: usize = 64;

/// Displacement of the compartment after an impact for many parameter sets, row after row into `out`: sample `k` of set
/// `i`, at `k dt`, is `out[i * samples + k]`.
///
/// The same exact steps as `Model::respond`, eight sets side by side: one set is a sequence of products that each wait
/// for the one before, eight keep the processor busy.
fn compartment_displacements(
    models: &[DoubleSpringMassDamper],
    impact_speed_m_per_s: f64,
    dt_s: f64,
    samples: usize,
    out: &mut [f64],
) {
    for (sets, rows) in models.chunks(LANES).zip(out.chunks_mut(LANES * samples)) {
        let mut phi = [[0.0; LANES]; 16];
        for (lane, model) in sets.iter().enumerate() {
            let step = (model.state_matrix() * dt_s).exp();
            for (i, entry) in phi.iter_mut().enumerate() {
                entry[lane] = step[(i / 4, i % 4)];
            }
        }
        let mut z = [[0.0; LANES], [0.0; LANES], [impact_speed_m_per_s; LANES], [impact_speed_m_per_s; LANES]];
        let mut kept = [[0.0; LANES]; BLOCK];
        let mut from = 0;
        while from < samples {
            let count = BLOCK.min(samples - from);
            for instant in &mut kept[..count] {
                *instant = z[1];
                z = std::array::from_fn(|i| {
                    std::array::from_fn(|l| {
                        (phi[4 * i][l] * z[0][l] + phi[4 * i + 1][l] * z[1][l])
                            + (phi[4 * i + 2][l] * z[2][l] + phi[4 * i + 3][l] * z[3][l])
                    })
                });
            }
            for (lane, row) in rows.chunks_mut(samples).enumerate() {
                for (x, instant) in row[from..from + count].iter_mut().zip(&kept) {
                    *x = instant[lane];
                }
            }
            from += count;
        }
    }
}

/// A structure that is crushed: one mass, eight knots, without and with a rate factor.
fn time_force_deflection() {
    let knots = [0.0, 0.0297, 0.0816, 0.162, 0.253, 0.382, 0.525, 0.678]
        .into_iter()
        .zip([0.0, 83280.0, 127_300.0, 187_700.0, 176_400.0, 248_600.0, 324_800.0, 420_000.0]);
    let front = ForceDeflection::new(&knots.collect::<Vec<_>>(), 1.82e7).unwrap();
    let of = |front: ForceDeflection| Structure::row(&[1500.0], [vec![front.into()]]).unwrap();
    let plain = of(front.clone());
    let all = Instants { first_s: 0.0, dt_s: 1e-4, samples: 2001 };
    let few = Instants { first_s: 0.0, dt_s: 1e-3, samples: 200 };
    figure("force-deflection, one mass, eight knots, 0.2 s at 10 kHz, three waves", 3 * 2001, || {
        black_box(plain.motions_at(black_box(15.0), &all).unwrap());
    })
    .aim(40e-6, "")
    .print();
    let picked = Instants { first_s: 0.0, dt_s: 1e-3, samples: 189 };
    figure("  the same, displacement at 189 instants, as a propagation uses it", 189, || {
        black_box(plain.sensitivity_of(Waves::Displacement, black_box(15.0), &picked, &[]).unwrap());
    })
    .aim(20e-6, "")
    .print();
    let questions = CollisionQuestions::default();
    figure("  the same, crush, peaks, separation, energies", 2001, || {
        black_box(plain.collision(&Drive::Impact(black_box(15.0)), 0.2, &questions).unwrap());
    })
    .aim(40e-6, "")
    .print();
    let place = |knot| {
        let parameter = front.place_of(ForceDeflectionParameter::KnotForce(knot)).unwrap();
        Place::Element { connection: 0, parameter }
    };
    let places: Vec<Place> = (1..8).map(place).collect();
    time("  the same, 200 instants with derivatives by seven knot forces", 8 * 3 * 200, || {
        black_box(plain.sensitivity(black_box(15.0), &few, &places).unwrap());
    });
    let rated = of(front.with_rate(0.01).unwrap());
    figure("  with a rate factor, 0.2 s at 10 kHz, three waves", 3 * 2001, || {
        black_box(rated.motions_at(black_box(15.0), &all).unwrap());
    })
    .aim(40e-6, "")
    .print();
}

fn main() {
    let double = DoubleSpringMassDamper {
        m1_kg: 291.0,
        m2_kg: 582.0,
        k1_n_per_m: 3e5,
        k2_n_per_m: 4e5,
        c1_n_s_per_m: 4e3,
        c2_n_s_per_m: 6e3,
    };
    let nonlinear = table_5();
    time_force_deflection();
    let model = Model::DoubleSpringMassDamper(double);
    figure("double mass, 0.2 s at 10 kHz, all six waves, exact", 6 * 2001, || {
        black_box(model.respond(black_box(12.0), 1e-4, 2001).unwrap());
    })
    .aim(20e-6, "scipy 360 µs")
    .print();
    let naive = |set: &DoubleSpringMassDamper, steps: usize| {
        let a = set.state_matrix();
        runge_kutta(black_box([0.0, 0.0, 12.0, 12.0]), 0.2, steps, 1, |z| {
            let acc = |r: usize| a[(r, 0)] * z[0] + a[(r, 1)] * z[1] + a[(r, 2)] * z[2] + a[(r, 3)] * z[3];
            [z[2], z[3], acc(2), acc(3)]
        })
    };
    let response = model.respond(12.0, 1e-4, 2001).unwrap();
    let ours = std::array::from_fn(|k| response.compartment().displacement_m[100 * (k + 1)]);
    println!("  difference from 100,000 Runge-Kutta steps: {:.0e} m", largest(&ours, &naive(&double, 100_000)));
    let mut steps_of_a_set = 0;
    for (what, bound_m) in [("1e-9 m", 1e-9), ("1e-12 m", 1e-12)] {
        let (steps, error) = steps_for(bound_m, &ours, |steps| naive(&double, steps));
        time(&format!("  naive, {what} asked: {steps} Runge-Kutta steps, error {error:.0e} m"), CHECKS, || {
            black_box(naive(&double, steps));
        });
        if bound_m == 1e-9 {
            steps_of_a_set = steps;
        }
    }
    time("double mass, also forces and energy, as the stage wants them", 10 * 2001, || {
        black_box(model.dynamics(&Drive::Impact(black_box(12.0)), 1e-4, 2001).unwrap());
    });
    let sets: Vec<_> =
        (0..10_000).map(|i| DoubleSpringMassDamper { k1_n_per_m: 3e5 + 10.0 * f64::from(i), ..double }).collect();
    let mut displacements = vec![0.0; sets.len() * 2001];
    figure("10,000 parameter sets, compartment, exact, two threads", 10_000 * 2001, || {
        let half = sets.len() / 2;
        let (first, second) = displacements.split_at_mut(half * 2001);
        std::thread::scope(|scope| {
            scope.spawn(|| compartment_displacements(&sets[..half], 12.0, 1e-4, 2001, first));
            compartment_displacements(&sets[half..], 12.0, 1e-4, 2001, second);
        });
    })
    .aim(80e-3, "numba 160 ms")
    .print();
    // The first set is that of the response above: two thousand roundings of 1e-16 m.
    let pairs = displacements[..2001].iter().zip(&response.compartment().displacement_m);
    assert!(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-12);
    // At no better an error than 1e-9 m, and without the waves in between.
    time(&format!("  naive, a hundredth of them by {steps_of_a_set} steps, one thread"), 100 * CHECKS, || {
        for set in &sets[..100] {
            black_box(naive(set, steps_of_a_set));
        }
    });
    figure("nonlinear II, 0.25 s at 10 kHz, three waves", 3 * 2501, || {
        black_box(Model::Nonlinear2(nonlinear).respond(black_box(9.7222), 1e-4, 2501).unwrap());
    })
    .aim(30e-6, "numba 56 µs")
    .print();
    let picked = Instants { first_s: 0.0, dt_s: 4e-4, samples: 189 };
    time("  the same, displacement at 189 instants, as a fit uses it", 189, || {
        let structure = nonlinear.structure().unwrap();
        black_box(structure.sensitivity_of(Waves::Displacement, black_box(9.7222), &picked, &[]).unwrap());
    });
    let curve = |knots: &[f64], values: &[f64], x: f64| {
        let j = knots.partition_point(|k| *k <= x).clamp(1, knots.len() - 1);
        let share = ((x - knots[j - 1]) / (knots[j] - knots[j - 1])).clamp(0.0, 1.0);
        values[j - 1] + share * (values[j] - values[j - 1])
    };
    let naive = |steps: usize| {
        runge_kutta(black_box([0.0, 9.7222]), 0.25, steps, 0, |z| {
            let k = curve(&[0.0, 0.472, 0.5063], &[82357.0, 4.0, 197_519.0], z[0].abs());
            let c = curve(&[0.0, 2.55, 7.23, 9.7222], &[86585.0, 80056.0, 18721.0, 81.0], z[1].abs());
            [z[1], -(k * z[0] + c * z[1]) / 873.0]
        })
    };
    let response = Model::Nonlinear2(nonlinear).respond(9.7222, 1e-4, 2501).unwrap();
    let ours = std::array::from_fn(|k| response.compartment().displacement_m[125 * (k + 1)]);
    println!("  difference from 400,000 Runge-Kutta steps: {:.0e} m", largest(&ours, &naive(400_000)));
    for (what, bound_m) in [("1e-9 m", 1e-9), ("1e-12 m", 1e-12)] {
        let (steps, error) = steps_for(bound_m, &ours, naive);
        time(&format!("  naive, {what} asked: {steps} Runge-Kutta steps, error {error:.0e} m"), CHECKS, || {
            black_box(naive(steps));
        });
    }
}
