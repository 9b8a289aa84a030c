//! A run made from closed forms, as artifacts: what the report's tests and its example look at.

#![allow(clippy::unwrap_used, reason = "test data: a failure here is the test's failure")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crumple_artifact::records::{
    CandidateV1, ChannelFilterV1, EventIntervalV1, EventsV1, FitV1, IdentificationV1, MetricV1, MetricsV1, ModeV1,
    ModesV1, NotesV1, ResponseV1, SimulationV1, StabilizationClusterV1, StabilizationPoleV1, StabilizationV1, TestV1,
    TransferFunctionV1, UncertaintyV1,
};
use crumple_artifact::{ArtifactBuilder, Compression, InputDigest, Provenance};
use crumple_signal::{Channel, ChannelStatus, QuantityKind, Sampled, Source, TestDescription};

/// A title that would break a careless page.
pub const TITLE: &str = "Frontal <b>impact</b> & \"pole\" </script><script>window.broken = true</script>";

const DT_S: f64 = 1e-4;
const BEFORE: u32 = 200;
const AFTER: u32 = 1501;

/// `m x'' = -k x - c x'`, `x(0) = 0`, `x'(0) = v0`, underdamped.
#[derive(Clone, Copy)]
struct Kelvin {
    mass_kg: f64,
    stiffness_n_per_m: f64,
    damping_n_s_per_m: f64,
    v0: f64,
}

impl Kelvin {
    fn poles(self) -> (f64, f64) {
        let sigma = self.damping_n_s_per_m / (2.0 * self.mass_kg);
        (sigma, (self.stiffness_n_per_m / self.mass_kg - sigma * sigma).sqrt())
    }

    /// Displacement, velocity, acceleration at `t` seconds after contact.
    fn at(self, t: f64) -> [f64; 3] {
        if t < 0.0 {
            return [self.v0 * t, self.v0, 0.0];
        }
        let (sigma, omega) = self.poles();
        let (sin, cos) = (omega * t).sin_cos();
        let decay = (-sigma * t).exp() * self.v0;
        let x = decay * sin / omega;
        let v = decay * (cos - sigma * sin / omega);
        let a = (-self.stiffness_n_per_m * x - self.damping_n_s_per_m * v) / self.mass_kg;
        [x, v, a]
    }

    fn time_of_crush(self) -> f64 {
        let (sigma, omega) = self.poles();
        omega.atan2(sigma) / omega
    }
}

const TEST: Kelvin =
    Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0, v0: 35.0 / 3.6 };

fn wave(before: u32, samples: u32, f: impl Fn(f64) -> f64) -> Sampled {
    let t0_s = -f64::from(before) * DT_S;
    Sampled::new(t0_s, DT_S, (0..samples).map(|k| f(t0_s + f64::from(k) * DT_S)).collect()).unwrap()
}

fn record_wave(f: impl Fn(f64) -> f64) -> Sampled {
    wave(BEFORE, BEFORE + AFTER, f)
}

fn test() -> TestDescription {
    let mut channels: Vec<Channel> = (1..=30)
        .map(|k| Channel { location: format!("sled <{k}>"), ..Channel::new(format!("ch{k}"), QuantityKind::Force) })
        .collect();
    channels.insert(
        3,
        Channel {
            location: "rear seat crossmember, left".to_owned(),
            axis: Some(crumple_signal::Axis::X),
            cfc: Some(60),
            ..Channel::new("accel", QuantityKind::Acceleration)
        },
    );
    channels[9].status = ChannelStatus::NotInstalled;
    TestDescription {
        title: TITLE.to_owned(),
        vehicle: Some("Synthetic hatchback".to_owned()),
        mass_kg: Some(TEST.mass_kg),
        impact_speed_m_per_s: Some(TEST.v0),
        barrier: Some("rigid wall, full width".to_owned()),
        source: Source {
            format: "csv".to_owned(),
            name: "crash.csv".to_owned(),
            digest: "blake3:00112233445566778899aabbccddeeff".to_owned(),
        },
        channels,
        pulse: Some("accel".to_owned()),
        notes: vec!["the time column has 4 decimals".to_owned()],
        time_zero: None,
    }
}

fn events() -> EventsV1 {
    let t_m = TEST.time_of_crush();
    let crush = TEST.at(t_m)[0];
    let t_s = 2.0 * t_m;
    let rebound = TEST.at(t_s)[1];
    EventsV1 {
        channel: "accel".to_owned(),
        time_zero_s: 0.0,
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: Some(crush),
        time_of_dynamic_crush_s: Some(t_m),
        centroid_time_s: Some(crush / TEST.v0),
        rebound_velocity_m_per_s: Some(rebound),
        coefficient_of_restitution: Some(-rebound / TEST.v0),
        delta_v_m_per_s: Some(TEST.v0 - rebound),
        time_of_rebound_s: Some(t_s),
        impact_speed_m_per_s: Some(TEST.v0),
        rule: Some("trapezoid".to_owned()),
        start: Some("record-start".to_owned()),
        intervals: vec![EventIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            low: crush - 0.008,
            high: crush + 0.008,
            interval_by: "5-95 % of 400 replicates".to_owned(),
        }],
    }
}

fn metrics() -> MetricsV1 {
    let metric = |name: &str, value, unit: &str, definition: &str| MetricV1 {
        name: name.to_owned(),
        value,
        unit: unit.to_owned(),
        channel: "accel".to_owned(),
        definition: definition.to_owned(),
        definition_id: Some(name.replace('_', "-")),
        ..MetricV1::default()
    };
    MetricsV1(vec![
        metric("peak_acceleration", Some(-191.5), "m/s^2", "largest |a|"),
        metric("time_of_peak_acceleration", Some(0.0612), "s", "time of it"),
        metric("equivalent_square_wave", Some(98.7), "m/s^2", "v0^2/(2C)"),
        metric("average_stiffness", Some(297_700.0), "N/m", "m*v0^2/C^2"),
        metric("energy_absorbed", Some(33_214.0), "J", "m*(v0^2 - v_s^2)/2"),
        metric("olc", None, "m/s^2", "not reached: the restraint travel of 235 mm is not used up"),
    ])
}

/// A conjugate pair and, where `far` is given, a real pole.
fn modes(sigma: f64, omega: f64, far: Option<f64>) -> ModesV1 {
    let mode = |re: f64, im: f64| ModeV1 {
        re_per_s: re,
        im_rad_per_s: im,
        natural_frequency_rad_per_s: re.hypot(im),
        damping_ratio: Some(-re / re.hypot(im)),
        modal_amplitude_coherence: Some(0.998),
        mode_singular_value: Some(0.7),
        discrete_re: None,
        discrete_im: None,
    };
    let mut modes = vec![mode(-sigma, -omega), mode(-sigma, omega)];
    modes.extend(far.map(|re| mode(re, 0.0)));
    ModesV1(modes)
}

fn identification(order: u32) -> IdentificationV1 {
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
    }
}

/// `1/(s + 20)`: with a band of 10 % and 5°, half of it not determined.
fn response() -> ResponseV1 {
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
fn stabilization() -> StabilizationV1 {
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
        }],
    }
}

struct Sketch {
    id: &'static str,
    parameters: &'static [(&'static str, f64)],
    physical: bool,
    equivalent_to: Option<&'static str>,
    response: Option<Kelvin>,
    fit_percent: f64,
}

fn sketches() -> Vec<Sketch> {
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

/// One artifact on its way to a file.
struct Stage {
    name: &'static str,
    file: &'static str,
    builder: ArtifactBuilder,
}

impl Stage {
    fn new(name: &'static str, file: &'static str, notes: &[&str]) -> Self {
        let mut builder = ArtifactBuilder::new();
        builder.put("/test", &TestV1::from(&test())).unwrap();
        if !notes.is_empty() {
            let notes = notes.iter().map(|&text| text.to_owned()).collect();
            builder.put("/notes", &NotesV1 { stage: name.to_owned(), notes }).unwrap();
        }
        Self { name, file, builder }
    }

    fn write(self, folder: &Path) -> PathBuf {
        let path = folder.join(self.file);
        let inputs = vec![InputDigest { kind: "csv".to_owned(), digest: "blake3:0123456789abcdef0123".to_owned() }];
        let provenance = Provenance::new(self.name, "0.1.0", r#"{"cfc":60,"mode":"iso6487"}"#.to_owned(), inputs);
        self.builder.write(&path, &provenance, Compression::None).unwrap();
        path
    }
}

/// Writes the six artifacts of the run into `folder`, in the order of the pipeline.
///
/// `simulated: false` leaves every candidate without a response.
pub fn write_artifacts(folder: &Path, simulated: bool) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    let ripple = |t: f64| if t < 0.0 { 0.0 } else { 22.0 * (1_900.0 * t).sin() * (-9.0 * t).exp() };

    let mut ingest = Stage::new(
        "ingest",
        "1-ingest.mcap",
        &["31 channels are listed", "warning: the zero level is -0.02 g; it is reported, not removed"],
    );
    ingest.builder.wave("accel", QuantityKind::Acceleration, record_wave(|t| TEST.at(t)[2] + ripple(t))).unwrap();
    paths.push(ingest.write(folder));

    let mut filter = Stage::new("filter", "2-filter.mcap", &[]);
    filter.builder.wave("accel", QuantityKind::Acceleration, record_wave(|t| TEST.at(t)[2])).unwrap();
    let channel_filter = ChannelFilterV1 {
        cfc: Some(60),
        mode: "iso6487".to_owned(),
        frequency_factor: Some(2.0775),
        samples_added: 100,
        coefficients: vec![0.1, 0.2, 0.1, 1.2, -0.6],
        gain_at_class_db: Some(-0.45),
        zero_level_removed: 0.0,
        notes: vec!["samples added by point reflection at both ends".to_owned()],
        corridor: vec![],
        corridor_ok: None,
        cutoff_hz: vec![],
        phase: Some("zero".to_owned()),
        width_s: None,
        resampled_to_hz: None,
        shift_s: None,
    };
    filter.builder.put("/filter/accel", &channel_filter).unwrap();
    paths.push(filter.write(folder));

    let mut integrate =
        Stage::new("integrate", "3-integrate.mcap", &["dynamic crush from CFC 60 and CFC 180 agrees within 0.1 mm"]);
    for (what, quantity, index) in
        [("velocity", QuantityKind::Velocity, 1), ("displacement", QuantityKind::Displacement, 0)]
    {
        integrate.builder.wave(&format!("accel/{what}"), quantity, record_wave(|t| TEST.at(t)[index])).unwrap();
    }
    let force = record_wave(|t| -TEST.mass_kg * TEST.at(t)[2]);
    integrate.builder.wave("accel/force", QuantityKind::Force, force).unwrap();
    integrate.builder.put("/events", &events()).unwrap();
    integrate.builder.put("/metrics", &metrics()).unwrap();
    paths.push(integrate.write(folder));

    let mut identify = Stage::new("identify", "4-identify.mcap", &["warning: order 3 has an unstable pole"]);
    let (sigma, omega) = TEST.poles();
    for (id, order, far) in [("era-2", 2, None), ("era-3", 3, Some(31.0))] {
        identify.builder.put(&format!("/identification/{id}"), &identification(order)).unwrap();
        identify.builder.put(&format!("/modes/{id}"), &modes(sigma, omega, far)).unwrap();
    }
    let tf = TransferFunctionV1 {
        numerator: vec![-27.8, -3_675.0],
        denominator: vec![1.0, 2.0 * sigma, sigma * sigma + omega * omega],
        input: "impulse".to_owned(),
        output: "acceleration".to_owned(),
        delay_s: None,
    };
    identify.builder.put("/model/era-2/transfer-function", &tf).unwrap();
    identify.builder.put("/response/era-2", &response()).unwrap();
    identify.builder.put("/stabilisation/era", &stabilization()).unwrap();
    paths.push(identify.write(folder));

    let mut solve = Stage::new("parameter-solve", "5-parameter-solve.mcap", &[]);
    let mut simulate =
        Stage::new("simulate", "6-simulate.mcap", &["warning: maxwell/closed-form/1 could not be simulated"]);
    let t_m = TEST.time_of_crush();
    for sketch in sketches() {
        let mut parts = sketch.id.split('/');
        let parameters: BTreeMap<String, f64> =
            sketch.parameters.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
        let fitted = sketch.id.contains("fit");
        let candidate = CandidateV1 {
            model: parts.next().unwrap().to_owned(),
            method: parts.next().unwrap().to_owned(),
            uncertainty: fitted.then(|| UncertaintyV1 {
                method: "linearised".to_owned(),
                standard_deviation: parameters.iter().map(|(name, value)| (name.clone(), 0.013 * value)).collect(),
                condition: Some(41.2),
                ..UncertaintyV1::default()
            }),
            parameters,
            physical: sketch.physical,
            equivalent_to: sketch.equivalent_to.map(str::to_owned),
            fit: fitted.then(|| FitV1 {
                channel: "accel".to_owned(),
                quantity: "displacement".to_owned(),
                from_s: 0.0,
                to_s: t_m,
                samples: 764,
                rmse: 0.0011,
                iterations: 14,
                evaluations: 212,
                stop_reason: "gradient-converged".to_owned(),
                active_bounds: vec![],
                sensors: vec![],
            }),
            notes: vec!["the test mass is taken for the mass that moves".to_owned()],
        };
        solve.builder.put(&format!("/parameters/{}", sketch.id), &candidate).unwrap();
        let Some(response) = sketch.response.filter(|_| simulated) else { continue };
        let crush_time = response.time_of_crush();
        let simulation = SimulationV1 {
            dynamic_crush_m: Some(response.at(crush_time)[0]),
            time_of_dynamic_crush_s: Some(crush_time),
            rmse_displacement_m: Some(0.45 * (1.0 - sketch.fit_percent / 100.0)),
            fit_percent: Some(sketch.fit_percent),
            iso18571_score: None,
            dynamic_crush_error_m: Some(response.at(crush_time)[0] - TEST.at(t_m)[0]),
            time_of_dynamic_crush_error_s: Some(crush_time - t_m),
            max_displacement_error_m: None,
            fit_velocity_percent: None,
            fit_acceleration_percent: None,
            from_s: 0.0,
            to_s: t_m,
            notes: vec![],
            aicc: None,
            effective_samples: None,
            fitted_parameters: None,
            other_sensors: vec![],
            drive: None,
            energy: Vec::new(),
            energy_closure: None,
        };
        simulate.builder.put(&format!("/simulation/{}", sketch.id), &simulation).unwrap();
        for (what, quantity, index) in [
            ("displacement", QuantityKind::Displacement, 0),
            ("velocity", QuantityKind::Velocity, 1),
            ("acceleration", QuantityKind::Acceleration, 2),
        ] {
            let id = format!("{}/{what}", sketch.id);
            simulate.builder.wave(&id, quantity, wave(0, AFTER, |t| response.at(t)[index])).unwrap();
        }
    }
    paths.push(solve.write(folder));
    paths.push(simulate.write(folder));
    paths
}
