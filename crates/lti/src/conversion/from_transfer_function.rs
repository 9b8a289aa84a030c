//! From a transfer function to state space.

use nalgebra::DMatrix;

use crate::{LtiError, StateSpace, TransferFunction};

/// The controller form of a transfer function, as MATLAB's `tf2ss` has it: the denominator's negated coefficients in
/// the first row, ones below the diagonal, the input on the first state.
///
/// The coefficients are those of the polynomials, bit for bit; the form is as badly balanced as they are. Errors: not
/// finite.
pub fn to_state_space(transfer_function: &TransferFunction) -> Result<StateSpace, LtiError> {
    let denominator = transfer_function.denominator();
    let n = denominator.len() - 1;
    let numerator = transfer_function.numerator();
    // Padded to the length of the denominator.
    let b = |k: usize| (k + numerator.len()).checked_sub(n + 1).map_or(0.0, |i| numerator[i]);
    let direct = b(0);
    StateSpace::new(
        DMatrix::from_fn(n, n, |i, j| if i == 0 { -denominator[j + 1] } else { f64::from(u8::from(i == j + 1)) }),
        DMatrix::from_fn(n, 1, |i, _| f64::from(u8::from(i == 0))),
        DMatrix::from_fn(1, n, |_, j| b(j + 1) - direct * denominator[j + 1]),
        DMatrix::from_element(1, 1, direct),
        None,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Complex;
    use crate::to_transfer_function;

    /// The transfer function of the crash paper: poles and zero recomputed with 50 digits.
    #[test]
    fn the_papers_model_has_its_poles_and_its_zero() {
        let tf = TransferFunction::new(&[-76.15, 466.2], &[1.0, 35.7, 6024.0, 185_000.0, 414_600.0]).unwrap();
        let model = to_state_space(&tf).unwrap();
        assert_eq!(model.a.row(0).iter().copied().collect::<Vec<_>>(), [-35.7, -6024.0, -185_000.0, -414_600.0]);
        assert_eq!(model.c.iter().copied().collect::<Vec<_>>(), [0.0, 0.0, -76.15, 466.2]);
        let expected = [
            Complex::new(-29.273_594_108_624_803, 0.0),
            Complex::new(-2.430_919_615_220_442, 0.0),
            Complex::new(-1.997_743_138_077_378_2, 76.303_160_607_879_3),
            Complex::new(-1.997_743_138_077_378_2, -76.303_160_607_879_3),
        ];
        for exact in expected {
            let nearest = |poles: &[Complex]| poles.iter().map(|s| (s - exact).norm()).fold(f64::INFINITY, f64::min);
            // Condition of the companion matrix's eigenvalues, some 1e3 times rounding; those of the polynomial are
            // polished.
            assert!(nearest(&model.poles().unwrap()) < 1e-10 * exact.norm());
            assert!(nearest(&tf.poles().unwrap()) < 1e-13 * exact.norm());
        }
        // A quotient of two coefficients, rounded once, against a value printed to its last digit: two units of 9e-16.
        assert!((tf.zeros().unwrap()[0].re - 6.122_127_380_170_716).abs() < 2e-15);
        // Roundings of a matrix of norm 4e5 are 1e-10 (balancing leaves far less), of poles near 76: 1e-12 after
        // multiplying out.
        let back = to_transfer_function(&model).unwrap();
        for (x, y) in back.denominator().iter().zip(tf.denominator()) {
            assert!((x / y - 1.0).abs() < 1e-12, "{x} {y}");
        }
        // The recursion carries what was lost there through three more products of the matrix: two digits more.
        let numerator = back.numerator();
        for (x, y) in numerator[numerator.len() - 2..].iter().zip(tf.numerator()) {
            assert!((x / y - 1.0).abs() < 1e-10, "{numerator:?}");
        }
    }

    #[test]
    fn a_direct_term_and_a_constant_are_ordinary() {
        let tf = TransferFunction::new(&[2.0, 3.0], &[1.0, 5.0]).unwrap();
        let model = to_state_space(&tf).unwrap();
        assert_eq!((model.a[0], model.c[0], model.d[0]), (-5.0, -7.0, 2.0));
        let constant = to_state_space(&TransferFunction::new(&[3.0], &[2.0]).unwrap()).unwrap();
        assert_eq!((constant.order(), constant.d[0]), (0, 1.5));
    }
}
