//! Time of one simulation, each beside a plain memory pass over as many samples and a naive integrator at equal error.
//!
//! `cargo bench -p crumple-lumped --bench simulate`

#![allow(clippy::unwrap_used, reason = "a benchmark that cannot run has no figure")]

use std::hint::black_box;
use std::time::Instant;

use crumple_lumped::{DoubleSpringMassDamper, Drive, Model, Nonlinear2, compartment_displacements};

/// Median of repeated runs, µs.
fn time(name: &str, aim: &str, mut run: impl FnMut()) -> f64 {
    let mut found: Vec<f64> = (0..15)
        .map(|_| {
            let (start, mut runs) = (Instant::now(), 0_u32);
            while start.elapsed().as_secs_f64() < 0.01 {
                run();
                runs += 1;
            }
            1e6 * start.elapsed().as_secs_f64() / f64::from(runs)
        })
        .collect();
    found.sort_by(f64::total_cmp);
    println!("{name:62} {:10.2} µs   aim {aim}", found[7]);
    found[7]
}

/// Steps of the classical Runge-Kutta method.
fn runge_kutta<const N: usize>(start: [f64; N], h: f64, steps: usize, f: impl Fn(&[f64; N]) -> [f64; N]) -> [f64; N] {
    let mut z = start;
    let moved = |z: &[f64; N], k: &[f64; N], h: f64| -> [f64; N] { std::array::from_fn(|i| z[i] + h * k[i]) };
    for _ in 0..steps {
        let k1 = f(&z);
        let k2 = f(&moved(&z, &k1, 0.5 * h));
        let k3 = f(&moved(&z, &k2, 0.5 * h));
        let k4 = f(&moved(&z, &k3, h));
        z = std::array::from_fn(|i| z[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
    }
    z
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
    let nonlinear = Nonlinear2 {
        mass_kg: 873.0,
        k1_n_per_m: 82357.0,
        k2_n_per_m: 4.0,
        k3_n_per_m: 197_519.0,
        x1_m: 0.472,
        c1_n_s_per_m: 86585.0,
        c2_n_s_per_m: 80056.0,
        c3_n_s_per_m: 18721.0,
        c4_n_s_per_m: 81.0,
        v1_m_per_s: 2.55,
        v2_m_per_s: 7.23,
        crush_m: 0.5063,
        v0_m_per_s: 9.7222,
    };
    let waves = vec![vec![1.0_f64; 2501]; 6];
    time("memory pass: six waves of 2,501 samples copied", "-", || {
        black_box(waves.clone());
    });
    let model = Model::DoubleSpringMassDamper(double);
    time("double mass, 0.2 s at 10 kHz, all six waves, exact", "20", || {
        black_box(model.respond(black_box(12.0), 1e-4, 2001).unwrap());
    });
    let a = double.state_matrix();
    time("  the same by Runge-Kutta steps of 0.1 ms (end state only)", "-", || {
        black_box(runge_kutta(black_box([0.0, 0.0, 12.0, 12.0]), 1e-4, 2000, |z| {
            let acc = |r: usize| a[(r, 0)] * z[0] + a[(r, 1)] * z[1] + a[(r, 2)] * z[2] + a[(r, 3)] * z[3];
            [z[2], z[3], acc(2), acc(3)]
        }));
    });
    time("double mass, also forces and energy, as the stage wants them", "-", || {
        black_box(model.dynamics(&Drive::Impact(black_box(12.0)), 1e-4, 2001).unwrap());
    });
    let sets: Vec<_> =
        (0..10_000).map(|i| DoubleSpringMassDamper { k1_n_per_m: 3e5 + 10.0 * f64::from(i), ..double }).collect();
    let mut displacements = vec![0.0; sets.len() * 2001];
    time("memory pass: 10,000 displacements of 2,001 samples written", "-", || {
        black_box(&mut displacements).fill(1.0);
    });
    time("10,000 parameter sets, compartment, exact, two threads", "80000", || {
        let half = sets.len() / 2;
        let (first, second) = displacements.split_at_mut(half * 2001);
        std::thread::scope(|scope| {
            scope.spawn(|| compartment_displacements(&sets[..half], 12.0, 1e-4, 2001, first).unwrap());
            compartment_displacements(&sets[half..], 12.0, 1e-4, 2001, second).unwrap();
        });
    });
    // Runge-Kutta at 0.1 ms errs by some 1e-9 m here: the naive way at no better an error.
    time("  a hundredth of them by Runge-Kutta steps of 0.1 ms, one thread", "-", || {
        for set in &sets[..100] {
            let a = set.state_matrix();
            black_box(runge_kutta(black_box([0.0, 0.0, 12.0, 12.0]), 1e-4, 2000, |z| {
                let acc = |r: usize| a[(r, 0)] * z[0] + a[(r, 1)] * z[1] + a[(r, 2)] * z[2] + a[(r, 3)] * z[3];
                [z[2], z[3], acc(2), acc(3)]
            }));
        }
    });
    time("nonlinear II, 0.25 s at 10 kHz, three waves, error 1e-13", "30", || {
        black_box(nonlinear.motion(black_box(9.7222), 1e-4, 2501).unwrap());
    });
    let mut picked = vec![0.0; 189];
    time("  the same, displacement at 189 instants, as a fit uses it", "-", || {
        nonlinear.displacement(black_box(9.7222), 0.0, 4e-4, &mut picked).unwrap();
    });
    let curve = |knots: &[f64], values: &[f64], x: f64| {
        let j = knots.partition_point(|k| *k <= x).clamp(1, knots.len() - 1);
        let share = ((x - knots[j - 1]) / (knots[j] - knots[j - 1])).clamp(0.0, 1.0);
        values[j - 1] + share * (values[j] - values[j - 1])
    };
    let exact = nonlinear.motion(9.7222, 0.25, 2).unwrap().displacement_m[1];
    for steps in [2500, 20_000] {
        let run = || {
            runge_kutta(black_box([0.0, 9.7222]), 0.25 / f64::from(steps), steps as usize, |z| {
                let k = curve(&[0.0, 0.472, 0.5063], &[82357.0, 4.0, 197_519.0], z[0].abs());
                let c = curve(&[0.0, 2.55, 7.23, 9.7222], &[86585.0, 80056.0, 18721.0, 81.0], z[1].abs());
                [z[1], -(k * z[0] + c * z[1]) / 873.0]
            })
        };
        let error = (run()[0] - exact).abs();
        time(&format!("  by {steps} Runge-Kutta steps, blind to knots, error {error:.0e} m"), "-", || {
            black_box(run());
        });
    }
}
