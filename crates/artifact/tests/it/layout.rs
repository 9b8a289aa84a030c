//! The layout of every record type, frozen: JSON text and bincode bytes of one sample each.
//!
//! A change here is a change of the format: it needs a new version of the type, not a new snapshot.

mod samples;

use std::fmt::Write;

use crumple_artifact::records::*;
use crumple_artifact::{Codec, Record, SCHEMAS};

use samples::{candidate, prediction, recommendation, test};

#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

/// Sixteen bytes a line, so that a difference points at a place.
fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for line in bytes.chunks(16) {
        for byte in line {
            write!(text, "{byte:02x}").unwrap();
        }
        text.push('\n');
    }
    text
}

fn freeze<R: Record + PartialEq + std::fmt::Debug>(record: &R) {
    let json = Codec::Json.encode(record).unwrap();
    let bincode = Codec::Bincode.encode(record).unwrap();
    assert_eq!(&Codec::Json.decode::<R>(&json).unwrap(), record, "JSON round trip");
    assert_eq!(&Codec::Bincode.decode::<R>(&bincode).unwrap(), record, "bincode round trip");
    replace_every_u64::<R>(&bincode);
    let text = format!("{}\n\n{}", String::from_utf8(json).unwrap(), hex(&bincode));
    insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false }, {
        insta::assert_snapshot!(R::SCHEMA, text);
    });
}

/// Whatever length or number stands at any place of the bytes: they are read or refused, with little memory.
fn replace_every_u64<R: Record>(bytes: &[u8]) {
    let before = crumple_memory::used();
    for place in 0..=bytes.len().saturating_sub(8) {
        for number in [0, 1, 0xff, 1 << 16, 1 << 26, 1 << 31, 1 << 40, u64::MAX / 2, u64::MAX / 8, u64::MAX] {
            let mut changed = bytes.to_vec();
            changed[place..place + 8].copy_from_slice(&u64::to_le_bytes(number));
            let _ = Codec::Bincode.decode::<R>(&changed);
        }
    }
    let most = crumple_memory::peak() - before;
    assert!(most < 1 << 24, "{}: {most} bytes for a record of {}", R::SCHEMA, bytes.len());
}

#[test]
fn the_layout_of_every_record_type_is_frozen() {
    freeze_measured();
    freeze_models();
    freeze_identification();
    freeze_scans();
    freeze_fitted();
    freeze_simulated();
    freeze_of_every_stage();
}

fn impact() -> ImpactV1 {
    ImpactV1 {
        start_s: 0.0,
        end_s: 0.0983,
        start_velocity_m_per_s: Some(15.86),
        delta_v_m_per_s: 5.56,
        peak_acceleration_m_per_s2: Some(-111.4),
        time_of_peak_s: Some(0.05),
        is_lower_bound: false,
    }
}

fn freeze_measured() {
    freeze(&test());
    freeze(&EventsV1 {
        channel: "93".into(),
        time_zero_s: 0.0,
        time_zero_rule: "file".into(),
        dynamic_crush_m: Some(0.75),
        time_of_dynamic_crush_s: Some(0.0742),
        centroid_time_s: Some(0.047),
        rebound_velocity_m_per_s: None,
        coefficient_of_restitution: None,
        still_separating: true,
        delta_v_m_per_s: None,
        time_of_rebound_s: None,
        impact_speed_m_per_s: Some(15.86),
        rule: Some("trapezoid".into()),
        start: Some("record-start".into()),
        intervals: vec![EventIntervalV1 {
            name: "dynamic_crush_m".into(),
            low: 0.74,
            high: 0.76,
            interval_by: "5-95 % of 400 replicates".into(),
            interval_source: Some(IntervalSourceV1::Replicates),
        }],
        time_of_delta_v_s: Some(0.143),
        end_of_event_s: None,
        end_of_event_rule: Some("end of the record".into()),
        without_interval: vec![MissingIntervalV1 {
            name: "time_of_dynamic_crush_s".into(),
            reason: "12 of 400 replicates do not have it".into(),
        }],
        impacts: vec![impact()],
    });
    freeze(&ImpactsV1 { channel: "93".into(), impacts: vec![impact()] });
    let metrics = vec![MetricV1 {
        name: "peak_acceleration".into(),
        value: Some(-445.7),
        unit: "m/s^2".into(),
        channel: "93".into(),
        definition: "largest |a|".into(),
        definition_id: Some("peak-sample".into()),
        from_s: Some(0.063),
        to_s: Some(0.063),
        low: Some(440.0),
        high: Some(450.0),
        interval_by: Some("range over 4 channels".into()),
        interval_source: Some(IntervalSourceV1::Channels),
        channels: vec!["93".into(), "94".into()],
        is_lower_bound: true,
    }];
    freeze(&MetricsV1(metrics.clone()));
    freeze(&MetricsV2 { metrics });
    freeze(&QualityV1 {
        zero_level: Some(0.25),
        noise_floor: Some(1.5),
        pre_event_from_s: Some(-0.05),
        pre_event_to_s: Some(-0.01),
        sample_rate_hz: 1e4,
        time_jitter: 0.0,
        minimum: -500.0,
        maximum: 30.0,
        clipped_run: 1,
        constant_run: Some(4),
        constant_run_from_s: Some(0.03),
        end_level: Some(-1.5),
        rest_level: Some(9.8),
    });
    freeze(&DamageV1 {
        residual_crush_m: vec![0.38, 0.466, 0.511, 0.518, 0.489, 0.37],
        damage_width_m: None,
        vehicle_width_m: Some(1.839),
        classification: Some("12FDEW2".into()),
        from: "DPD1-DPD6, VEHWID".into(),
    });
    freeze(&VehiclesV1 {
        vehicles: vec![VehicleV1 {
            number: 2,
            description: Some("2015 sedan".into()),
            mass_kg: Some(1400.0),
            impact_speed_m_per_s: Some(0.0),
            pulse: Some("21".into()),
            channels: vec!["21".into(), "22".into()],
        }],
        closing_speed_m_per_s: Some(12.5),
    });
    freeze_filtered();
}

fn freeze_filtered() {
    freeze(&ChannelFilterV1 {
        cfc: Some(60),
        mode: "iso6487".into(),
        frequency_factor: Some(25.0 / 12.0),
        samples_added: 100,
        coefficients: vec![0.0015, 0.003, 0.0015, 1.889, -0.895],
        gain_at_class_db: Some(-0.45),
        zero_level_removed: 0.25,
        notes: vec![],
        corridor: vec![CorridorPointV1 { frequency_hz: 100.0, gain_db: -3.0, upper_db: 0.5, lower_db: Some(-4.0) }],
        corridor_ok: Some(true),
        cutoff_hz: vec![100.0],
        phase: Some("zero".into()),
        width_s: Some(0.002),
        resampled_to_hz: Some(1e4),
        shift_s: Some(-5e-5),
    });
    freeze(&WaveBlockV1 { t0_ns: -20_000_000, dt_s: 1e-4, first: 65_536, samples: vec![1.5, -0.0, 1e-300] });
}

fn freeze_models() {
    freeze(&StateSpaceV1 {
        a: vec![vec![0.5, 1.0], vec![-1.0, 0.25]],
        b: vec![vec![1.0], vec![0.0]],
        c: vec![vec![1.0, 0.0]],
        d: vec![vec![0.125]],
        sample_time_s: 1e-4,
        input: "u".into(),
        output: "y".into(),
        delay_s: Some(2e-4),
    });
    freeze(&TransferFunctionV1 {
        numerator: vec![-76.5, 449.0],
        denominator: vec![1.0, 35.7],
        input: "deceleration".into(),
        output: "displacement".into(),
        delay_s: None,
    });
    freeze(&ExponentialSumV1 {
        terms: vec![ExponentialTermV1 { re_amplitude: 1.0, im_amplitude: -2.0, re_per_s: -33.4, im_rad_per_s: 39.0 }],
        output: "displacement".into(),
    });
    let modes = vec![ModeV1 {
        re_per_s: -18.0,
        im_rad_per_s: 533.0,
        natural_frequency_rad_per_s: 533.5,
        damping_ratio: Some(0.0338),
        modal_amplitude_coherence: Some(0.999),
        mode_singular_value: None,
        discrete_re: Some(0.99),
        discrete_im: Some(0.05),
        kind: Some(ModeKindV1::Mode),
    }];
    freeze(&ModesV1(modes.clone()));
    let pole = OtherPoleV1 {
        re_per_s: 0.0,
        im_rad_per_s: 0.1,
        discrete_re: Some(1.0),
        discrete_im: None,
        kind: OtherPoleKindV1::Integrator,
    };
    freeze(&ModesV2 { modes, other_poles: vec![pole] });
    freeze(&ResponseV1 {
        input: "unit impulse".into(),
        output: "acceleration of channel 93, m/s^2".into(),
        model: "continuous".into(),
        frequency_hz: vec![0.5, 5.0],
        magnitude: vec![1.5, 2.5],
        phase_rad: vec![-0.1, -3.5],
        band: Some("bootstrap, 5 to 95 %".into()),
        magnitude_lower: vec![Some(1.25), None],
        magnitude_upper: vec![Some(1.75), None],
        phase_lower_rad: vec![Some(-0.2), None],
        phase_upper_rad: vec![Some(0.0), None],
        impulse_of: "unit sample".into(),
        time_s: vec![0.0, 1e-3],
        impulse: vec![0.0, 1.0],
        step: vec![0.0, 0.5],
        zeros_re_per_s: vec![6.125],
        zeros_im_rad_per_s: vec![0.0],
    });
}

fn freeze_identification() {
    freeze(&IdentificationV1 {
        method: "era".into(),
        order: 4,
        channel: "93".into(),
        treated_as: "impulse-response".into(),
        from_s: 0.0,
        to_s: 0.25,
        samples: 2501,
        hankel_rows: Some(1250),
        hankel_columns: Some(1250),
        singular_values: vec![3.0, 2.0],
        fit_percent: Some(99.5),
        rmse: None,
        notes: vec![],
        output_fits_percent: vec![],
        delay_s: Some(1e-3),
        inputs: vec!["93".into()],
        remarks: vec![],
    });
    freeze(&EvidenceV1 {
        input: Some("93".into()),
        output: "93/displacement".into(),
        hold: Some("first-order".into()),
        initial_conditions: "estimated".into(),
        start: Some("iv".into()),
        stop_reason: Some("gradient-converged".into()),
        iterations: Some(9),
        evaluations: Some(700),
        losses: vec![1e-6, 2e-6],
        loss: Some(1e-6),
        prediction_fit_percent: None,
        parameters: 10,
        effective_samples: Some(25.5),
        aicc: Some(-300.0),
        bic: Some(-290.0),
        final_prediction_error: Some(2e-6),
        residual_lag_one: Some(0.99),
        whiteness: Some(9000.0),
        whiteness_limit: Some(31.4),
        input_correlation: Some(3.5),
        condition: Some(1e5),
        numerator_deviations: vec![3.5, 170.0],
        denominator_deviations: vec![1.5, 17.0],
        frequency_deviations: vec![Some(0.5), None],
        damping_deviations: vec![Some(0.01), None],
        zeros_re_per_s: vec![6.125],
        zeros_im_rad_per_s: vec![0.0],
        singular_value_errors: vec![1e-9],
        zero_re_deviations: vec![Some(2.5)],
        zero_im_deviations: vec![None],
        bootstrap_replicates: Some(198),
        bootstrap_failed: Some(2),
        bootstrap_noise: Some("residuals in blocks of 12 samples".into()),
        frequency_spreads: vec![Some(SpreadV1 { deviation: 0.5, lower: 37.0, upper: 38.5, bias: Some(0.25) }), None],
        damping_spreads: vec![None],
        zero_re_spreads: vec![Some(SpreadV1 { deviation: 2.0, lower: 2.5, upper: 9.0, bias: None })],
        zero_im_spreads: vec![],
        validation_fit_percent: Some(97.5),
        validation_from_s: Some(0.1),
        paper: Some("tfest".into()),
        validation_restarted_fit_percent: Some(98.0),
        aic: Some(-301.0),
        minimum_description_length: Some(3e-6),
        vaf_percent: Some(99.9),
        no_deviations: Some("the method has no covariance".into()),
        parameter_names: vec!["re_amplitude_1".into(), "re_per_s_1".into()],
        parameter_values: vec![0.5, -7.5],
        parameter_deviations: vec![0.125, 2.0],
        parameter_correlations: vec![vec![1.0, -0.5], vec![-0.5, 1.0]],
        denominator_covariance: vec![vec![4.0, -1.0], vec![-1.0, 9.0]],
        holds_on_unseen: Some(false),
        simulation_whiteness: Some(9500.0),
        noise: Some(NoiseV1 {
            model: NoiseModelV1::OutputError,
            ar_order: 1,
            ljung_box: 25.5,
            white_limit: 36.5,
            is_white: true,
        }),
        no_interval: Some(NoIntervalV1::FewReplicates),
        no_spreads: vec![None, Some(NoSpreadV1::ShortRecord)],
    });
}

fn freeze_scans() {
    freeze(&ArxScanV1 {
        input: "heater".into(),
        output: "inside".into(),
        samples: 490,
        models: vec![ArxScanModelV1 {
            past_outputs: 2,
            inputs: 2,
            delay: 3,
            parameters: 4,
            loss: Some(1e-6),
            aicc: Some(-300.0),
            bic: Some(-290.0),
            mdl: Some(2e-6),
            fit_percent: Some(85.5),
            failure: None,
        }],
        best_by_bic: Some("arx-2-2-3".into()),
        best_by_aicc: None,
        at_edge: vec![ScanEdgeV1::Delay],
    });
    freeze(&StabilizationV1 {
        method: "era".into(),
        channel: "93".into(),
        orders: vec![2, 4],
        highest_damping: 2.0,
        nyquist_share: 0.95,
        least_collinearity: None,
        least_strength: Some(2.0),
        frequency_change: 0.01,
        damping_change: 0.05,
        shape_change: Some(0.02),
        presence: 0.5,
        poles: vec![StabilizationPoleV1 {
            order: 4,
            re_per_s: -7.5,
            im_rad_per_s: 36.9,
            stability: "frequency-and-damping".into(),
        }],
        clusters: vec![StabilizationClusterV1 {
            orders: 9,
            natural_frequency_rad_per_s: 37.7,
            natural_frequency_lower_rad_per_s: 37.5,
            natural_frequency_upper_rad_per_s: 38.0,
            damping_ratio: 0.2,
            damping_ratio_lower: 0.19,
            damping_ratio_upper: 0.21,
            halves_rad_per_s: vec![37.6, 37.75],
            shape_re: vec![1.0, -0.5],
            shape_im: vec![0.0, 0.25],
        }],
        not_in_both_halves: Some(1),
    });
    freeze(&RecordChecksV1 {
        inputs_left_out: vec!["v".into()],
        delay: Some(FoundDelayV1 { samples: 5, first: 0, last: 20, at_edge: false, noise: NoiseModelV1::Arx }),
        order: Some(4),
        trends: vec![TrendV1 { channel: "y".into(), slope_per_s: 0.15, bic_gain: 40.5 }],
        outliers: vec![OutliersV1 { channel: "y".into(), samples: vec![120], times_s: vec![1.2] }],
    });
    freeze(&SelectionV1 {
        output: "93/displacement".into(),
        effective_samples: 25.5,
        models: vec![SelectionModelV1 {
            id: "tfest-4-1".into(),
            parameters: 10,
            loss: 1e-6,
            aicc_difference: Some(0.0),
            bic_difference: 0.5,
            validation_fit_percent: Some(97.5),
            order: Some(4),
            validation_restarted_fit_percent: Some(98.0),
        }],
        best_by_aicc: "tfest-4-1".into(),
        best_by_bic: "tfest-2-0".into(),
        best_by_validation: None,
        near_equal: vec!["tfest-4-1".into()],
        recommended: Some("tfest-4-1".into()),
        recommended_because: Some(RecommendedBecauseV1::ValidatesBetter),
        passed_over: Some("tfest-1-0".into()),
    });
    freeze(&ShapesV1 {
        channels: vec!["93".into(), "95".into()],
        shapes: vec![ShapeV1 {
            re_per_s: -3.5,
            im_rad_per_s: 50.0,
            re: vec![1.0, -0.5],
            im: vec![0.0, 0.25],
            phase_collinearity: Some(0.75),
        }],
        modal_assurance: vec![vec![1.0]],
    });
}

fn freeze_fitted() {
    freeze(&candidate());
    freeze(&recommendation());
    freeze(&prediction());
    freeze(&TestsV1 {
        tests: vec![JointTestV1 {
            name: "a".to_owned(),
            title: "a car".to_owned(),
            digest: "blake3:00".to_owned(),
            channel: "93".to_owned(),
            mass_kg: 873.0,
            impact_speed_m_per_s: 9.72,
            dynamic_crush_m: Some(0.5),
            time_of_dynamic_crush_s: Some(0.075),
            coefficient_of_restitution: None,
        }],
        rate_factor: "fitted".to_owned(),
    });
    freeze(&TestsV2 { tests: Vec::new(), rate_factor: "prior".to_owned(), crush_deviation: Some(0.01) });
    freeze(&MatchingV1 {
        m1_kg: 284.4,
        m2_kg: 1137.6,
        polynomial: vec![1.0, 35.7, 6024.0, 185e3, 414.6e3],
        largest_mass_ratio: Some(0.147),
        roots: vec![MatchingRootV1 {
            re_per_s2: -2067.0,
            im_per_s2: 0.0,
            multiplicity: 1,
            certified_radius_per_s2: Some(1e-25),
        }],
        solutions: vec![MatchingSolutionV1 {
            k1_re_n_per_m: 75e3,
            k1_im_n_per_m: 0.0,
            k2_re_n_per_m: 1.78e6,
            k2_im_n_per_m: 0.0,
            c1_re_n_s_per_m: 34e3,
            c1_im_n_s_per_m: 0.0,
            c2_re_n_s_per_m: -19e3,
            c2_im_n_s_per_m: 0.0,
            real: true,
            physical: false,
            multiplicity: 1,
            dual: 1,
            residual: 1e-17,
            candidate: Some("double-spring-mass-damper/coefficient-matching/1".into()),
            zero_re_per_s: Some(91.7),
            zero_im_per_s: Some(0.0),
        }],
        sweep: vec![MatchingSweepV1 {
            front_mass_fraction: 0.9,
            k1_n_per_m: 1e5,
            k2_n_per_m: 6e5,
            c1_n_s_per_m: 4e4,
            c2_n_s_per_m: 160.0,
            physical: true,
        }],
        notes: vec![],
        source: Some("eigenvalues of a state matrix".into()),
        zeta_of_the_start_per_s2: Some(-2000.0),
        coordinates: vec![PhysicalCoordinatesV1 {
            candidate: "double-spring-mass-damper/coefficient-matching/1".into(),
            mass_kg: vec![vec![284.4, 0.0], vec![0.0, 1137.6]],
            damping_n_s_per_m: vec![vec![15e3, 19e3], vec![19e3, -19e3]],
            stiffness_n_per_m: vec![vec![1.8e6, -1.8e6], vec![-1.8e6, 1.8e6]],
            transformation: vec![vec![1.0, 0.0, 0.0, 0.5], vec![0.0, 1.0, 0.0, 0.0]],
            condition: 42.0,
            residual: 1e-13,
            chassis_mismatch: Some(0.02),
            start: Some(vec![0.0, 0.0, 15.6, 15.6]),
        }],
    });
}

fn freeze_simulated() {
    freeze(&SimulationV1 {
        dynamic_crush_m: Some(0.75),
        time_of_dynamic_crush_s: Some(0.074),
        rmse_displacement_m: Some(0.002),
        fit_percent: Some(98.9),
        iso18571_score: None,
        dynamic_crush_error_m: Some(-0.001),
        time_of_dynamic_crush_error_s: Some(1e-4),
        max_displacement_error_m: Some(0.004),
        fit_velocity_percent: Some(95.0),
        fit_acceleration_percent: Some(60.0),
        from_s: 0.0,
        to_s: 0.0742,
        notes: vec![],
        aicc: None,
        effective_samples: None,
        fitted_parameters: None,
        other_sensors: vec![],
        drive: Some("a force on mass 1".to_owned()),
        energy: vec![EnergyV1 {
            instant: "end".to_owned(),
            time_s: 0.2,
            kinetic_j: 1.5,
            stored_j: 2.5,
            dissipated_j: 4.0,
            input_j: 8.0,
        }],
        energy_closure: Some(1e-14),
        ratings: vec![RatingV1 {
            name: "cora".to_owned(),
            quantity: "acceleration".to_owned(),
            value: Some(0.9),
            definition_id: "cora".to_owned(),
            mark: "M".to_owned(),
            from_s: Some(0.0),
            to_s: Some(0.0742),
            note: Some("interval: the compared window".to_owned()),
        }],
        fit_as_measured_percent: Some(99.1),
        force_misfit_percent: Some(18.5),
        coefficient_of_restitution: Some(0.15),
        rebound_velocity_m_per_s: Some(-2.4),
        peak_acceleration_m_per_s2: Some(-400.0),
        residual: Some(ResidualV1 {
            rms_m_per_s2: 4.5,
            share_of_test: 0.03,
            samples: 743,
            lag_s: 1e-4,
            autocorrelation: vec![1.0, 0.75],
            limit: 0.072,
            share_outside: 0.5,
        }),
        band: Some(MotionBandV1 { dt_s: 4e-4, displacement_m: vec![0.0, 1e-3], velocity_m_per_s: vec![0.0, 0.25] }),
    });
}

fn freeze_of_every_stage() {
    let concerns = vec![ConcernV1 {
        stage: "ingest".into(),
        severity: SeverityV1::Warning,
        about: "pulse".into(),
        weight: 3,
        text: "the pulse is positive".into(),
        remedy: Some("--sign flip".into()),
    }];
    freeze(&ConcernsV1(concerns.clone()));
    freeze(&ConcernsV2 { concerns });
    let values = [("rise_g".to_owned(), ValueV1::Number(5.5)), ("channel".to_owned(), ValueV1::Text("a".into()))];
    freeze(&RemarksV1 {
        remarks: vec![RemarkV1 {
            code: "CR101".into(),
            stage: "ingest".into(),
            about: "pulse".into(),
            weight: 3,
            values: values.into(),
            text: "the pulse is positive".into(),
            remedy: Some("--sign flip".into()),
            written_by: None,
        }],
    });
    freeze(&NotesV1 { stage: "ingest".into(), notes: vec!["warning: clipped".into()] });
    freeze(&DiagnosisV1 { stage: "identify".into(), reason: "the record is constant".into(), has_result: false });
}

#[test]
fn no_record_type_is_left_out() {
    let frozen: Vec<String> = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/snapshots"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    for schema in SCHEMAS {
        assert!(frozen.contains(&format!("{schema}.snap")), "{schema} has no frozen layout");
    }
}
