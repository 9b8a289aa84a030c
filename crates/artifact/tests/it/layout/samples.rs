//! Records with many fields, one of each.

use std::collections::BTreeMap;

use crumple_artifact::records::*;

fn names(pairs: &[(&str, f64)]) -> BTreeMap<String, f64> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect()
}

pub fn candidate() -> CandidateV1 {
    CandidateV1 {
        model: "kelvin".into(),
        method: "closed-form".into(),
        law: None,
        parameters: names(&[("mass_kg", 873.0), ("stiffness_n_per_m", 321_905.25)]),
        physical: true,
        equivalent_to: None,
        fit: Some(FitV1 {
            channel: "93".into(),
            quantity: "displacement".into(),
            from_s: 0.0,
            to_s: 0.075,
            samples: 251,
            rmse: 1e-6,
            iterations: 12,
            evaluations: 300,
            stop_reason: "gradient-converged".into(),
            active_bounds: vec!["c1_n_s_per_m".into()],
            sensors: vec![SensorFitV1 {
                channel: "103".into(),
                mass: 1,
                quantity: "displacement".into(),
                rmse: 2e-3,
                noise: 2.5e-3,
            }],
        }),
        uncertainty: Some(UncertaintyV1 {
            method: "linearised".into(),
            standard_deviation: names(&[("stiffness_n_per_m", 120.5)]),
            condition: Some(1e4),
            ..UncertaintyV1::default()
        }),
        notes: vec!["undamped".into()],
        evaluation: Some(evaluation()),
        mass_divisions: Some(MassDivisionsV1 {
            largest_mass_ratio: Some(4.5),
            sweep: vec![MatchingSweepV1 {
                front_mass_fraction: 0.25,
                k1_n_per_m: 9e5,
                k2_n_per_m: 1e6,
                c1_n_s_per_m: 6e3,
                c2_n_s_per_m: 9e3,
                physical: true,
            }],
        }),
    }
}

fn evaluation() -> EvaluationV1 {
    EvaluationV1 {
        from_s: 0.0,
        to_s: 0.075,
        fit_as_measured_percent: Some(99.5),
        crush_error: Some(0.01),
        time_error: Some(-0.02),
        restitution_error: None,
        coefficient_of_restitution: Some(0.15),
        force_misfit_percent: Some(12.5),
        worst_sensor: Some("103".to_owned()),
        worst_sensor_fit_percent: Some(98.0),
        crush_error_at_lower_speeds: Some(0.005),
    }
}

pub fn recommendation() -> RecommendationV1 {
    RecommendationV1 {
        recommended: Some("kelvin/closed-form/1".to_owned()),
        recommended_because: "the only one".to_owned(),
        simplest: None,
        simplest_because: "none".to_owned(),
        closest: Some("kelvin/closed-form/1".to_owned()),
        closest_because: "99 %".to_owned(),
        strength: Some(StrengthV1::Weak),
        beside: Some("maxwell/direct-fit/1".to_owned()),
        decided_by: vec!["accel".to_owned()],
        evidence: Some(RecommendationEvidenceV1 {
            quantity: "acceleration".to_owned(),
            as_measured: true,
            from_s: 0.0,
            to_s: 0.0742,
            samples: 743,
            effective_samples: 15.5,
        }),
        priors: vec![PriorV1 { name: "class".to_owned(), statement: "plastic".to_owned(), source: "tests".to_owned() }],
        candidates: vec![RatedCandidateV1 {
            id: "kelvin/closed-form/1".to_owned(),
            class: "damped".to_owned(),
            adequate: true,
            not_adequate_because: None,
            parameters: 2,
            determined: 1,
            misfit: Some(4.5),
            fit_as_measured_percent: Some(99.0),
            coefficient_of_restitution: Some(0.25),
            force_misfit_percent: None,
            aicc: Some(-12.5),
            aicc_difference: Some(0.0),
            priors: vec![PriorTermV1 { name: "class".to_owned(), term: 10.0 }],
            difference_with_priors: Some(0.0),
            ..RatedCandidateV1::default()
        }],
    }
}

pub fn prediction() -> PredictionV1 {
    PredictionV1 {
        candidate: "kelvin/closed-form/1".to_owned(),
        recommended: true,
        names: vec!["recommended".to_owned()],
        impact_speed_m_per_s: 17.5,
        mass_kg: 1500.0,
        partner: None,
        dynamic_crush_m: Some(0.75),
        time_of_dynamic_crush_s: Some(0.074),
        delta_v_m_per_s: Some(19.5),
        coefficient_of_restitution: Some(0.125),
        peak_acceleration_m_per_s2: Some(310.0),
        peak_by: Some(AnsweredByV1::Record),
        delta_v_by: Some(AnsweredByV1::Model),
        olc_m_per_s2: None,
        energy: Some(PredictedEnergyV1 { kinetic_at_impact_j: 8.0, kinetic_at_rest_j: 1.5, absorbed_j: 6.5 }),
        extrapolates: true,
        intervals: vec![PredictedIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            level: 0.9,
            low: 0.7,
            high: 0.8,
            interval_by: "parameters 100 % of the variance".to_owned(),
        }],
        notes: vec!["extrapolates".to_owned()],
        against: Some(AgainstTestV1 {
            test: "a car".to_owned(),
            dynamic_crush_error_percent: Some(-1.5),
            held: vec!["dynamic_crush_m".to_owned()],
            ..AgainstTestV1::default()
        }),
        collision: Some(PredictedCollisionV1 {
            kind: "vehicle".to_owned(),
            partner_candidate: Some("kelvin/closed-form/1".to_owned()),
            closing_speed_m_per_s: 30.0,
            partner_speed_m_per_s: 12.5,
            partner_mass_kg: 1200.0,
            mutual_crush_m: Some(1.25),
            partner_absorbed_j: Some(7.5),
            momentum_before_n_s: 1e4,
            momentum_after_n_s: 1e4,
            ..PredictedCollisionV1::default()
        }),
        occupant: Some(PredictedOccupantV1 {
            time_of_contact_s: Some(0.025),
            peak_acceleration_m_per_s2: 400.0,
            ride_down_share: Some(0.5),
            ..PredictedOccupantV1::default()
        }),
        asked: true,
    }
}

pub fn test() -> TestV1 {
    TestV1 {
        title: "NCAP <frontal>".into(),
        vehicle: Some("2018 sedan".into()),
        mass_kg: Some(1719.0),
        impact_speed_m_per_s: Some(15.858_333_333_333_333),
        barrier: None,
        source: SourceV1 { format: "nhtsa-ev5".into(), name: "v1.EV5".into(), digest: "blake3:00".into() },
        channels: vec![ChannelV1 {
            id: "93".into(),
            location: "left rear seat crossmember".into(),
            axis: Some("x".into()),
            quantity: "acceleration".into(),
            unit: "m/s^2".into(),
            cfc: Some(60),
            status: "valid".into(),
            initial_velocity_m_per_s: Some(-0.0),
            redundant: false,
            comment: None,
            code: Some("10FORALERE00ACXP".into()),
            sensor: None,
            filter_state: Some("low-pass 2800 Hz".into()),
            polarity: None,
        }],
        pulse: Some("93".into()),
        notes: vec![],
        time_zero: Some("the format nhtsa-ev5".into()),
        contact: None,
        exchange_asked: true,
        overlap: Some("glancing".into()),
        kind: Some(KindV1 { name: "vehicle".into(), rule: "stated by flag".into() }),
    }
}
