//! The sample's identified models.

use crumple_artifact::records::{
    IdentificationV1, ModeV1, ModesV2, ResponseV1, StabilizationClusterV1, StabilizationPoleV1, StabilizationV1,
};

/// A conjugate pair and, where `far` is given, a real pole.
pub(super) fn modes(sigma: f64, omega: f64, far: Option<f64>) -> ModesV2 {
    let mode = |re: f64, im: f64| ModeV1 {
        re_per_s: re,
        im_rad_per_s: im,
        natural_frequency_rad_per_s: re.hypot(im),
        damping_ratio: Some(-re / re.hypot(im)),
        modal_amplitude_coherence: Some(0.998),
        mode_singular_value: Some(0.7),
        discrete_re: None,
        discrete_im: None,
        kind: None,
    };
    let mut modes = vec![mode(-sigma, -omega), mode(-sigma, omega)];
    modes.extend(far.map(|re| mode(re, 0.0)));
    ModesV2 { modes, other_poles: Vec::new() }
}

pub(super) fn identification(order: u32) -> IdentificationV1 {
    IdentificationV1 {
        method: "era".to_owned(),
        order,
        channel: "accel".to_owned(),
        treated_as: "impulse-response".to_owned(),
        from_s: 0.0,
        to_s: 0.08,
        samples: 801,
        hankel_rows: Some(400),
        hankel_columns: Some(400),
        singular_values: (0..12)
            .map(|k| if k < 2 { 900.0 - 200.0 * f64::from(k) } else { 3.0 * 0.7_f64.powi(k) })
            .collect(),
        fit_percent: Some(97.31),
        rmse: Some(1.2),
        notes: vec!["the record is treated as an impulse response".to_owned()],
        output_fits_percent: Vec::new(),
        delay_s: None,
        inputs: Vec::new(),
        remarks: Vec::new(),
    }
}

/// `1/(s + 20)`: with a band of 10 % and 5°, half of it not determined.
pub(super) fn response() -> ResponseV1 {
    let frequency_hz: Vec<f64> = (0..60).map(|k| 0.5 * 1.1_f64.powi(k)).collect();
    let w: Vec<f64> = frequency_hz.iter().map(|f| std::f64::consts::TAU * f).collect();
    let magnitude: Vec<f64> = w.iter().map(|w| 1.0 / w.hypot(20.0)).collect();
    let phase_rad: Vec<f64> = w.iter().map(|w| -(w / 20.0).atan()).collect();
    let edge = |values: &[f64], change: &dyn Fn(f64) -> f64| {
        values.iter().enumerate().map(|(k, x)| (k < 30).then(|| change(*x))).collect::<Vec<Option<f64>>>()
    };
    let time_s: Vec<f64> = (0..200).map(|k| f64::from(k) * 4e-4).collect();
    ResponseV1 {
        input: "unit impulse (the record taken as Markov parameters)".to_owned(),
        output: "acceleration of channel accel, m/s^2".to_owned(),
        model: "continuous".to_owned(),
        band: Some("bootstrap of 200 replicates, 5 to 95 %".to_owned()),
        magnitude_lower: edge(&magnitude, &|x| 0.9 * x),
        magnitude_upper: edge(&magnitude, &|x| 1.1 * x),
        phase_lower_rad: edge(&phase_rad, &|x| x - 0.09),
        phase_upper_rad: edge(&phase_rad, &|x| x + 0.09),
        frequency_hz,
        magnitude,
        phase_rad,
        impulse_of: "unit sample".to_owned(),
        impulse: time_s.iter().map(|t| (-20.0 * t).exp()).collect(),
        step: time_s.iter().map(|t| (1.0 - (-20.0 * t).exp()) / 20.0).collect(),
        time_s,
        zeros_re_per_s: vec![-132.0],
        zeros_im_rad_per_s: vec![0.0],
    }
}

/// One mode that stays from order 4 on, and one pole of every other kind.
pub(super) fn stabilization() -> StabilizationV1 {
    let pole = |order: u32, im: f64, stability: &str| StabilizationPoleV1 {
        order,
        re_per_s: -1.4,
        im_rad_per_s: im,
        stability: stability.to_owned(),
    };
    StabilizationV1 {
        method: "era".to_owned(),
        channel: "accel".to_owned(),
        orders: vec![2, 4, 6, 8],
        highest_damping: 2.0,
        nyquist_share: 0.95,
        least_collinearity: None,
        least_strength: Some(2.0),
        frequency_change: 0.01,
        damping_change: 0.05,
        shape_change: None,
        presence: 0.5,
        poles: vec![
            pole(2, 19.4, "new"),
            pole(4, 19.41, "frequency"),
            pole(4, 900.0, "rejected"),
            pole(6, 19.42, "frequency-and-damping"),
            pole(8, 19.42, "frequency-and-damping"),
        ],
        clusters: vec![StabilizationClusterV1 {
            orders: 3,
            natural_frequency_rad_per_s: 19.47,
            natural_frequency_lower_rad_per_s: 19.46,
            natural_frequency_upper_rad_per_s: 19.48,
            damping_ratio: 0.0719,
            damping_ratio_lower: 0.0718,
            damping_ratio_upper: 0.0721,
            halves_rad_per_s: Vec::new(),
            shape_re: Vec::new(),
            shape_im: Vec::new(),
        }],
        not_in_both_halves: None,
    }
}
