//! Modes of the system matrices printed in the ERA crash paper (Munyazikwiye et al.), eq. 63, 65 and 67.

use crumple_numerics::lti::{Mode, eigenvalues};
use nalgebra::{DMatrix, dmatrix};

fn modes(a: &DMatrix<f64>) -> Vec<Mode> {
    eigenvalues(a).unwrap().into_iter().filter(|z| z.im > 0.0).map(Mode::continuous).collect()
}

/// Checks pole, modulus and damping against values recomputed with 50 digits.
fn check(a: &DMatrix<f64>, expected: &[(f64, f64, f64, f64)]) {
    let estimated = modes(a);
    assert_eq!(estimated.len(), expected.len());
    for (mode, &(re, im, modulus, damping)) in estimated.iter().zip(expected) {
        // Rounding of a 4x4 eigenvalue problem of norm 2e3.
        let close = |x: f64, y: f64| (x - y).abs() < 1e-9 * modulus;
        assert!(close(mode.pole.re, re) && close(mode.pole.im, im), "{} against {re} {im}", mode.pole);
        assert!(close(mode.natural_frequency_rad_per_s, modulus));
        assert!((mode.damping_ratio.unwrap() - damping).abs() < 1e-10);
    }
}

#[test]
fn equation_63_has_its_printed_poles() {
    let a = dmatrix![95.5776, -545.1246; 545.12, -131.6485];
    check(&a, &[(-18.03545, 533.151_382_650_085, 533.456_347_116_050, 0.033_808_670_751_604)]);
}

#[test]
fn equation_65_needs_the_digit_its_symmetry_demands() {
    let mut a = dmatrix![
        -22.5, -526.3, 56.2, 141.5;
        526.3, -243.8, 631.5, 279.9;
        56.2, -631.5, -171.2, -1363.2;
        -141.5, 279.9, 136.2, -445.9
    ];
    check(
        &a,
        &[
            (-421.816_460_518_322, 224.742_075_323_208, 477.952_013_056_528, 0.882_549_814_615_873),
            (-19.883_539_481_677_5, 885.294_635_184_210, 885.517_897_181_227, 0.022_454_136_212_233),
        ],
    );
    // A balanced single-channel realisation is symmetric up to signs: element (4,3) mirrors (3,4).
    a[(3, 2)] = 1363.2;
    check(
        &a,
        &[
            (-274.874_691_555_389, 501.359_652_698_618, 571.767_083_183_134, 0.480_745_918_469_301),
            (-166.825_308_444_611, 1_476.686_421_770_455, 1_486.079_900_873_056, 0.112_258_639_893_187),
        ],
    );
    // Printed as 3592.8 and 9337.4 rad/s: 2 pi times the moduli of the printed poles.
    for (mode, printed) in modes(&a).iter().zip([3592.8, 9337.4]) {
        let ratio = printed / mode.natural_frequency_rad_per_s;
        // The printed poles carry four digits.
        assert!((ratio / std::f64::consts::TAU - 1.0).abs() < 2e-4, "{ratio}");
    }
}

#[test]
fn equation_67_needs_the_sign_its_symmetry_demands() {
    let mut a = dmatrix![
        0.1, -615.1, -3.6, -4.9;
        615.1, -13.1, -24.9, -5.3;
        -3.6, 24.9, -2.1, -577.0;
        -4.9, -5.3336, 577.0, -0.9876
    ];
    check(
        &a,
        &[
            (-4.340_928_178_334_87, 574.110_680_072_010, 574.127_091_008_772, 0.007_560_918_560_223),
            (-3.702_871_821_665_13, 618.201_230_334_874, 618.212_319_876_658, 0.005_989_644_176_622),
        ],
    );
    a[(3, 0)] = 4.9;
    a[(0, 0)] = -0.1;
    check(
        &a,
        &[
            (-3.842_125_584_978_92, 575.318_336_225_640, 575.331_165_439_914, 0.006_678_111_348_342),
            (-4.301_674_415_021_08, 617.116_988_566_564, 617.131_981_005_877, 0.006_970_428_607_524),
        ],
    );
}
