//! Discrete Fourier transforms of real vectors.

use std::sync::Arc;

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

// Plans of the discrete Fourier transform of real vectors.
//
// The transforms are generic, and a crate that plans one itself compiles all of them, ten seconds each: they are
// planned here, once for the workspace.

/// The transform of one length and its inverse.
pub struct RealTransform {
    /// `X_k = Σ x_n e^(-2πi·kn/N)`, k = 0 to N/2, of `N` real values.
    pub forward: Arc<dyn RealToComplex<f64>>,
    /// `N·x_n` of those `N/2 + 1` values: the inverse without its factor `1/N`.
    pub inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Plans the transform of `length` real values, any number of them; fastest for products of 2, 3 and 5.
///
/// Time `O(N log N)`, error of a value about `1e-16·log2 N` of the norm of the input. Both use their input as scratch.
/// The order of summation follows the vector instructions that the processor has.
pub fn real_transform(length: usize) -> RealTransform {
    let mut planner = RealFftPlanner::new();
    RealTransform { forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_sum_of_the_definition_and_back() {
        for length in [1, 2, 15, 31, 64] {
            let x: Vec<f64> = (0..length).map(|n| ((n * n) as f64 * 0.7).sin()).collect();
            let plan = real_transform(length);
            let mut spectrum = plan.forward.make_output_vec();
            plan.forward.process(&mut x.clone(), &mut spectrum).unwrap();
            for (k, value) in spectrum.iter().enumerate() {
                let angle = |n: usize| -2.0 * PI * (k * n) as f64 / length as f64;
                let re: f64 = x.iter().enumerate().map(|(n, x)| x * angle(n).cos()).sum();
                let im: f64 = x.iter().enumerate().map(|(n, x)| x * angle(n).sin()).sum();
                // The angles are rounded: some 1e-16 of 2π·k·n/N each, 64 terms.
                assert!((value.re - re).hypot(value.im - im) < 1e-12 * length as f64, "{length} {k}");
            }
            let mut back = plan.inverse.make_output_vec();
            plan.inverse.process(&mut spectrum, &mut back).unwrap();
            for (x, back) in x.iter().zip(back) {
                assert!((back / length as f64 - x).abs() < 1e-14, "{length}");
            }
        }
    }
}
