//! Records of the reference cases of system identification, made of a congruence from stated seeds.

use std::f64::consts::PI;

use nalgebra::{DMatrix, SymmetricEigen};
use serde_json::Value;

/// Signals of inputs and of outputs.
pub type Signals = (Vec<Vec<f64>>, Vec<Vec<f64>>);

/// A number of a case; panics where it is missing.
pub fn number(input: &Value, name: &str) -> f64 {
    input[name].as_f64().unwrap_or_else(|| panic!("{name} is missing"))
}

/// A whole number of a case; panics where it is missing.
pub fn integer(input: &Value, name: &str) -> usize {
    input[name].as_u64().unwrap_or_else(|| panic!("{name} is missing")) as usize
}

/// A list of numbers; empty where there is none.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// Sampling interval, s; 1 where none is stated.
pub fn dt(input: &Value) -> f64 {
    input["dt"].as_f64().unwrap_or(1.0)
}

/// `x <- (1664525 x + 1013904223) mod 2^32`, values over 2^32.
fn uniform(seed: usize) -> impl Iterator<Item = f64> {
    let mut x = seed as u32;
    std::iter::from_fn(move || {
        x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        Some(f64::from(x) / 4_294_967_296.0)
    })
}

/// Sums of twelve values less 6.
pub fn gauss(seed: usize, count: usize) -> Vec<f64> {
    let mut values = uniform(seed);
    (0..count).map(|_| values.by_ref().take(12).sum::<f64>() - 6.0).collect()
}

/// `B/A` of a signal from rest.
pub(crate) fn filtered(b: &[f64], a: &[f64], u: &[f64]) -> Vec<f64> {
    let mut y: Vec<f64> = Vec::with_capacity(u.len());
    for k in 0..u.len() {
        let driven = b.iter().enumerate().filter_map(|(lag, b)| Some(b * u[k.checked_sub(lag)?])).sum::<f64>();
        let past = a.iter().enumerate().skip(1).filter_map(|(lag, a)| Some(a * y[k.checked_sub(lag)?])).sum::<f64>();
        y.push((driven - past) / a[0]);
    }
    y
}

/// `y = (B/F) u + (sd/D) e + slope k`, then outliers.
pub fn record(input: &Value) -> Signals {
    let samples = integer(input, "N");
    let values = uniform(integer(input, "seed_u")).take(samples);
    let u: Vec<f64> = match input["input"].as_str().unwrap_or("uniform") {
        "uniform" => values.map(|x| x - 0.5).collect(),
        "gauss" => gauss(integer(input, "seed_u"), samples),
        "binary" => values.map(|x| if x < 0.5 { -1.0 } else { 1.0 }).collect(),
        other => panic!("input {other} is not known"),
    };
    let of = |name: &str| Some(numbers(&input[name])).filter(|all| !all.is_empty()).unwrap_or_else(|| vec![1.0]);
    let e = gauss(integer(input, "seed_e"), samples);
    let noise = filtered(&[number(input, "sd")], &of("D"), &e);
    let slope = input["slope"].as_f64().unwrap_or(0.0);
    let mut y: Vec<f64> = filtered(&of("B"), &of("F"), &u)
        .iter()
        .zip(noise)
        .enumerate()
        .map(|(k, (y, v))| y + v + slope * k as f64)
        .collect();
    for outlier in input["outliers"].as_array().into_iter().flatten().map(numbers) {
        y[outlier[0] as usize] += outlier[1];
    }
    (vec![u], vec![y])
}

/// Channels `value + size` times draws.
pub fn channels(input: &Value, name: &str) -> Vec<Vec<f64>> {
    let samples = integer(input, "N");
    let channel = |channel: &Value| {
        let (value, size) = (channel["value"].as_f64().unwrap_or(0.0), channel["size"].as_f64().unwrap_or(0.0));
        let seed = channel["seed"].as_u64().map_or(0, |seed| seed as usize);
        uniform(seed).take(samples).map(|x| value + size * (x - 0.5)).collect()
    };
    input[name].as_array().into_iter().flatten().map(channel).collect()
}

/// Draws row by row, a row an instant: one signal a mass.
fn rows(draws: &[f64], count: usize) -> Vec<Vec<f64>> {
    (0..count).map(|i| draws.iter().skip(i).step_by(count).copied().collect()).collect()
}

/// Natural frequencies (rad/s) and shapes of unit modal mass of a chain held at mass 0, `springs[i]` below mass `i`:
/// the symmetric problem of `M^-1/2 K M^-1/2`.
pub fn chain_modes(masses: &[f64], springs: &[f64]) -> Vec<(f64, Vec<f64>)> {
    let (count, root) = (masses.len(), |i: usize| masses[i].sqrt());
    let stiffness = |i: usize, j: usize| match j {
        _ if i == j => springs[i] + springs.get(i + 1).copied().unwrap_or(0.0),
        _ if i.abs_diff(j) == 1 => -springs[i.max(j)],
        _ => 0.0,
    };
    let eigen = SymmetricEigen::new(DMatrix::from_fn(count, count, |i, j| stiffness(i, j) / root(i) / root(j)));
    let shape = |mode: usize| (0..count).map(|i| eigen.eigenvectors[(i, mode)] / root(i)).collect();
    (0..count).map(|mode| (eigen.eigenvalues[mode].sqrt(), shape(mode))).collect()
}

/// Accelerations of a chain held at mass 0: struck, or driven by noise on every mass; with noise of the sensors.
pub fn chain(input: &Value, is_struck: bool) -> Signals {
    let (masses, springs) = (numbers(&input["masses"]), numbers(&input["springs"]));
    let (count, samples, dt_s) = (masses.len(), integer(input, "N"), number(input, "dt"));
    let skip = input["skip"].as_u64().map_or(0, |skip| skip as usize);
    let all = samples + skip;
    let forces: Vec<Vec<f64>> = if is_struck {
        let (at, struck, length) = (integer(input, "at"), integer(input, "struck"), integer(input, "pulse_samples"));
        let mut force = vec![0.0; all];
        for k in 0..length {
            force[at + k] = number(input, "peak") * (PI * (k as f64 + 0.5) / length as f64).sin();
        }
        (0..count).map(|i| if i == struck { force.clone() } else { vec![0.0; all] }).collect()
    } else {
        rows(&gauss(integer(input, "seed"), count * all), count)
    };
    let modes = chain_modes(&masses, &springs);
    let damping = number(input, "damping");
    let mut outputs = vec![vec![0.0; all]; count];
    for (w, shape) in modes {
        // Exact over a step of constant force: towards its equilibrium f/w² like free motion.
        let (decay, turned) = (damping * w, w * (1.0 - damping * damping).sqrt());
        let (shrink, cos, sin) = ((-decay * dt_s).exp(), (turned * dt_s).cos(), (turned * dt_s).sin());
        let (mut position, mut velocity) = (0.0, 0.0);
        for k in 0..all {
            let force: f64 = shape.iter().zip(&forces).map(|(s, f)| s * f[k]).sum();
            let acceleration = force - 2.0 * decay * velocity - w * w * position;
            shape.iter().zip(&mut outputs).for_each(|(s, y)| y[k] += s * acceleration);
            let (rest, start) = (force / (w * w), velocity);
            let apart = position - rest;
            let of_sine = (start + decay * apart) / turned;
            position = rest + shrink * (apart * cos + of_sine * sin);
            velocity = shrink * (start * cos - (decay * of_sine + turned * apart) * sin);
        }
    }
    outputs.iter_mut().for_each(|y| drop(y.drain(..skip)));
    let noise = rows(&gauss(integer(input, "seed_e"), count * samples), count);
    for (y, noise) in outputs.iter_mut().zip(noise) {
        let mean = y.iter().sum::<f64>() / samples as f64;
        let size = match input["kind_of_noise"].as_str() {
            Some("largest") => y.iter().fold(0.0_f64, |m, x| m.max(x.abs())),
            Some("deviation") => (y.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples as f64).sqrt(),
            other => panic!("noise {other:?} is not known"),
        };
        y.iter_mut().zip(noise).for_each(|(y, e)| *y += number(input, "noise") * size * e);
    }
    let inputs = if is_struck { vec![forces[integer(input, "struck")].clone()] } else { Vec::new() };
    (inputs, outputs)
}
