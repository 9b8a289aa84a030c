//! From state space to a transfer function.

use nalgebra::DMatrix;

use crate::lti::matrix::exponential::one_norm;
use crate::lti::{Complex, LtiError, StateSpace, TransferFunction};

/// The transfer function of a continuous model with one input and one output.
///
/// Time is scaled by the largest pole first, so that coefficients of `s^4 ... s^0` do not differ by powers of 1e3. The
/// denominator is the product over the poles; the numerator follows from the adjugate by the Faddeev-LeVerrier
/// recursion `M[k+1] = A M[k] + c[k] I`, `n[k] = C M[k] B + D c[k]`. Accurate to about 1e-10 up to ten states (checked
/// at eight); the coefficients themselves lose their meaning as the order grows, not this computation alone.
/// Nothing is cancelled: an unobservable pole stays.
///
/// Errors: discrete model, several channels, coefficients beyond the range of `f64`.
pub fn to_transfer_function(model: &StateSpace) -> Result<TransferFunction, LtiError> {
    model.require_continuous()?;
    model.require_single()?;
    let n = model.order();
    let poles = model.poles()?;
    let fastest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    // A nilpotent matrix (rigid bodies only) has no fastest pole; its norm is a rate too.
    let rate = [fastest, one_norm(&model.a), 1.0].into_iter().find(|&r| r > 0.0).unwrap_or(1.0);

    let mut denominator = vec![Complex::new(1.0, 0.0)];
    for pole in poles {
        let pole = pole / rate;
        denominator.push(Complex::new(0.0, 0.0));
        for k in (1..denominator.len()).rev() {
            let previous = denominator[k - 1];
            denominator[k] -= previous * pole;
        }
    }
    // Poles come in exact conjugate pairs: what imaginary part is left is rounding.
    let denominator: Vec<f64> = denominator.iter().map(|c| c.re).collect();

    let a = &model.a / rate;
    let d = model.d[(0, 0)];
    let mut adjugate = DMatrix::<f64>::identity(n, n);
    let mut numerator = vec![d];
    for c in &denominator[1..] {
        numerator.push((&model.c * &adjugate * &model.b)[(0, 0)] / rate + d * c);
        adjugate = &a * adjugate + DMatrix::<f64>::identity(n, n) * *c;
    }
    let unscaled = |p: Vec<f64>| {
        let powers = std::iter::successors(Some(1.0), |power| Some(power * rate));
        p.iter().zip(powers).map(|(c, power)| c * power).collect::<Vec<f64>>()
    };
    TransferFunction::new(&unscaled(numerator), &unscaled(denominator))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    #[test]
    fn kelvin_model_gives_its_textbook_coefficients() {
        let (m, c, k) = (873.0, 10_000.0, 321_535.0);
        let model = StateSpace::new(
            dmatrix![0.0, 1.0; -k / m, -c / m],
            dmatrix![0.0; 1.0 / m],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
            None,
        )
        .unwrap();
        let tf = to_transfer_function(&model).unwrap();
        // 1/(m s^2 + c s + k); the s^1 coefficient of the numerator cancels exactly.
        assert_eq!(tf.numerator().len(), 1);
        // Two poles and their product, each a few roundings of an eigenvalue of a two by two matrix: 45 are allowed.
        for (found, exact) in tf.numerator().iter().chain(tf.denominator()).zip([1.0 / m, 1.0, c / m, k / m]) {
            assert!((found / exact - 1.0).abs() < 1e-14, "{found} against {exact}");
        }
    }

    #[test]
    fn double_integrator_is_one_over_s_squared() {
        let model =
            StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 3.0], dmatrix![1.0, 0.0], dmatrix![0.0], None)
                .unwrap();
        let tf = to_transfer_function(&model).unwrap();
        assert_eq!((tf.numerator(), tf.denominator()), (&[3.0][..], &[1.0, 0.0, 0.0][..]));
    }

    proptest! {
        #[test]
        fn answers_as_the_resolvent_does(
            entries in prop::collection::vec(-1.0..1.0_f64, 81),
            frequency in 0.1..3.0_f64,
        ) {
            let n = 8;
            let speed = 500.0;
            let a = (DMatrix::from_column_slice(n, n, &entries[..64]) - DMatrix::identity(n, n) * 3.0) * speed;
            let b = DMatrix::from_column_slice(n, 1, &entries[64..72]);
            let c = DMatrix::from_column_slice(1, n, &entries[72..80]);
            let d = dmatrix![entries[80]];
            let model = StateSpace::new(a.clone(), b.clone(), c.clone(), d.clone(), None).unwrap();
            let tf = to_transfer_function(&model).unwrap();
            let s = Complex::new(0.0, frequency * speed);
            let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
            let resolvent = (DMatrix::identity(n, n) * s - complex(&a)).lu().solve(&complex(&b)).unwrap();
            let exact = (complex(&c) * resolvent)[(0, 0)] + d[(0, 0)];
            // Eight states, coefficients up to binomials times 3^8: five digits of the sixteen may go.
            prop_assert!((tf.at(s) - exact).norm() < 1e-10 * (1.0 + exact.norm()), "{} {exact}", tf.at(s));
        }
    }
}
