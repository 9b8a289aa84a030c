//! The sample's candidates: what they are and how they answer.

use std::collections::BTreeMap;

use crumple_artifact::records::{CandidateV1, FitV1, MassDivisionsV1, MatchingSweepV1, UncertaintyV1};

use super::kelvin::{Kelvin, TEST};

pub(super) struct Sketch {
    pub(super) id: &'static str,
    pub(super) parameters: &'static [(&'static str, f64)],
    pub(super) physical: bool,
    pub(super) equivalent_to: Option<&'static str>,
    pub(super) response: Option<Kelvin>,
    pub(super) fit_percent: f64,
}

impl Sketch {
    pub(super) fn candidate(&self) -> CandidateV1 {
        let mut parts = self.id.split('/');
        let parameters: BTreeMap<String, f64> =
            self.parameters.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
        let fitted = self.id.contains("fit");
        CandidateV1 {
            model: parts.next().unwrap().to_owned(),
            method: parts.next().unwrap().to_owned(),
            uncertainty: fitted.then(|| UncertaintyV1 {
                method: "linearised".to_owned(),
                standard_deviation: parameters.iter().map(|(name, value)| (name.clone(), 0.013 * value)).collect(),
                condition: Some(41.2),
                ..UncertaintyV1::default()
            }),
            parameters,
            physical: self.physical,
            equivalent_to: self.equivalent_to.map(str::to_owned),
            fit: fitted.then(|| FitV1 {
                channel: "accel".to_owned(),
                quantity: "displacement".to_owned(),
                from_s: 0.0,
                to_s: TEST.time_of_crush(),
                samples: 764,
                rmse: 0.0011,
                iterations: 14,
                evaluations: 212,
                stop_reason: "gradient-converged".to_owned(),
                active_bounds: vec![],
                sensors: vec![],
            }),
            notes: vec!["the test mass is taken for the mass that moves".to_owned()],
            mass_divisions: self.id.ends_with("displacement-fit/1").then(divisions),
            ..CandidateV1::default()
        }
    }
}

/// Sets of the double model on both sides of the division that was used.
fn divisions() -> MassDivisionsV1 {
    let at = |front_mass_fraction: f64| MatchingSweepV1 {
        front_mass_fraction,
        k1_n_per_m: 412_000.0,
        k2_n_per_m: 330_000.0 / front_mass_fraction,
        c1_n_s_per_m: 3_120.0,
        c2_n_s_per_m: 8_400.0,
        physical: front_mass_fraction > 0.15,
    };
    MassDivisionsV1 { largest_mass_ratio: Some(5.5), sweep: vec![at(0.1), at(0.2), at(0.3)] }
}

pub(super) fn sketches() -> Vec<Sketch> {
    const DOUBLE_1: &str = "double-spring-mass-damper/displacement-fit/1";
    const DOUBLE_2: &str = "double-spring-mass-damper/displacement-fit/2";
    let response = |k: f64, c: f64| Some(Kelvin { stiffness_n_per_m: k, damping_n_s_per_m: c, ..TEST });
    vec![
        Sketch {
            id: DOUBLE_1,
            parameters: &[
                ("m1_kg", 174.6),
                ("m2_kg", 698.4),
                ("k1_n_per_m", 412_000.0),
                ("k2_n_per_m", 1_650_000.0),
                ("c1_n_s_per_m", 3_120.0),
                ("c2_n_s_per_m", 8_400.0),
            ],
            physical: true,
            equivalent_to: Some(DOUBLE_2),
            response: response(331_000.0, 2_550.0),
            fit_percent: 98.9,
        },
        Sketch {
            id: DOUBLE_2,
            parameters: &[
                ("m1_kg", 174.6),
                ("m2_kg", 698.4),
                ("k1_n_per_m", 2_062_500.0),
                ("k2_n_per_m", 329_600.0),
                ("c1_n_s_per_m", 10_500.0),
                ("c2_n_s_per_m", 2_496.0),
            ],
            physical: true,
            equivalent_to: Some(DOUBLE_1),
            response: response(331_000.0, 2_550.0),
            fit_percent: 98.9,
        },
        Sketch {
            id: "elastoplastic/closed-form/1",
            parameters: &[
                ("mass_kg", 873.0),
                ("loading_stiffness_n_per_m", 298_000.0),
                ("unloading_stiffness_n_per_m", 910_000.0),
            ],
            physical: true,
            equivalent_to: None,
            response: response(298_000.0, 800.0),
            fit_percent: 93.4,
        },
        Sketch {
            id: "kelvin/closed-form/1",
            parameters: &[("mass_kg", 873.0), ("stiffness_n_per_m", 321_900.0), ("damping_n_s_per_m", 2_410.0)],
            physical: true,
            equivalent_to: None,
            response: response(321_900.0, 2_410.0),
            fit_percent: 98.2,
        },
        Sketch {
            id: "kelvin/coefficient-matching/1",
            parameters: &[("mass_kg", 873.0), ("stiffness_n_per_m", 330_500.0), ("damping_n_s_per_m", -40.0)],
            physical: false,
            equivalent_to: None,
            response: response(330_500.0, -40.0),
            fit_percent: 99.4,
        },
        Sketch {
            id: "maxwell/closed-form/1",
            parameters: &[("mass_kg", 873.0), ("stiffness_n_per_m", 512_000.0), ("damping_n_s_per_m", 21_000.0)],
            physical: true,
            equivalent_to: None,
            response: None,
            fit_percent: 0.0,
        },
    ]
}
