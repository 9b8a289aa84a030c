//! A realisation by ERA and its stabilisation diagram, as records.

use std::f64::consts::TAU;

use crumple_numerics::lti::{Complex, LtiError, Mode, StateSpace, to_transfer_function};
use crumple_signal::{Notes, Sampled};
use crumple_stage::Output;
use crumple_stage::records::{
    EvidenceV1, IdentificationV1, ModeV1, ShapeV1, ShapesV1, StabilizationClusterV1, StabilizationPoleV1,
    StabilizationV1, StateSpaceV1, TransferFunctionV1,
};
use crumple_sysid::{
    Decomposition, OrderPoles, Realization, Sample, StabilizationOptions, markov_parameters, modal_assurance,
    phase_collinearity, stabilization,
};
use nalgebra::DMatrix;

use crate::stage::options::choices::Method;
use crate::stage::options::settings::{BootstrapSettings, Stabilisation};
use crate::stage::records::discrete::note_on_fit;
use crate::stage::records::evidence::{Poles, entry, pole_record, simulation_evidence, validate, validation_summary};
use crate::stage::records::responses::{Band, ModelResponses, note_limits, put_spreads, spread_of_outputs, zeros_of};
use crate::stage::records::results::Results;
use crate::stage::waves::{WindowedWave, filter_edges};

/// What a reader of the model must know of its input.
const INPUT: &str = "unit impulse (the record taken as Markov parameters)";

/// What realised models come from.
pub struct RealizationTask<'a> {
    /// `era` or `era-dc`.
    pub method: Method,
    /// The channels, sampled together, at least one.
    pub waves: &'a [WindowedWave],
    /// What the samples are taken for.
    pub treated_as: &'static str,
    /// Bootstrap, if asked for.
    pub bootstrap: Option<&'a BootstrapSettings>,
    /// Whether this is the procedure of the paper, which the id then says with the number of samples.
    pub paper: bool,
    /// The same estimate from other samples of every channel.
    pub refit: &'a (dyn Fn(&[Vec<f64>]) -> Option<Realization> + Sync),
}

impl RealizationTask<'_> {
    fn names(&self) -> Vec<&str> {
        self.waves.iter().map(|wave| wave.id.as_str()).collect()
    }

    /// `acceleration of channels 11, 12, m/s^2`; of several quantities one after the other.
    fn describe(&self) -> String {
        let plural = if self.single() { "" } else { "s" };
        let describe = |wave: &WindowedWave, plural: &str, names: &str| {
            format!("{} of channel{plural} {names}, {}", wave.quantity.name(), wave.quantity.si_unit())
        };
        if self.one_quantity() {
            return describe(&self.waves[0], plural, &self.names().join(", "));
        }
        self.waves.iter().map(|wave| describe(wave, "", &wave.id)).collect::<Vec<_>>().join("; ")
    }

    fn one_quantity(&self) -> bool {
        self.waves.iter().all(|wave| wave.quantity == self.waves[0].quantity)
    }

    fn single(&self) -> bool {
        self.waves.len() == 1
    }

    fn samples(&self) -> usize {
        self.waves[0].sampled.len()
    }

    /// `<method>-<order>`; of the paper's procedure with the number of samples.
    pub fn id(&self, order: usize) -> String {
        let paper = if self.paper { format!("-n{}-paper", self.samples()) } else { String::new() };
        format!("{}-{order}{paper}", self.method)
    }
}

/// Writes the records of one model under its id, `<method>-<order>`, and a summary line.
pub fn put_realization(
    model: &Realization,
    task: &RealizationTask<'_>,
    notes: &Notes,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let (order, samples, single) = (model.order(), task.samples(), task.single());
    let id = task.id(order);
    let output = task.describe();
    let mut notes = notes.clone();
    results.out.put(&format!("/model/{id}/discrete"), &state_space(&model.discrete, INPUT, &output, None))?;
    if let Ok(continuous) = &model.continuous {
        results.out.put(&format!("/model/{id}/continuous"), &state_space(continuous, INPUT, &output, None))?;
        match transfer_function(continuous, &output) {
            _ if !single => {}
            Ok(record) => results.out.put(&format!("/model/{id}/transfer-function"), &record)?,
            Err(error) => notes.info(format!("no transfer function: {error}")),
        }
    }
    let poles = poles(model, &task.waves[0]);
    poles.put(&id, results.out)?;
    if !single {
        let mut are_modes = poles.are_modes();
        let modes = model.modes.iter().map(|identified| {
            let mode = identified.mode.filter(|_| are_modes.next().unwrap_or(true));
            (identified.discrete_pole, mode)
        });
        let modes: Vec<_> = modes.collect();
        results.out.put(&format!("/shapes/{id}"), &shapes(&modes, &model.mode_shapes, task.waves))?;
    }
    if let Decomposition::Lanczos { steps } = model.decomposition {
        let converged = model
            .singular_value_errors
            .iter()
            .take_while(|error| **error <= 1e-9 * model.singular_values.first().copied().unwrap_or(0.0))
            .count();
        notes.info(format!(
            "the {} leading singular values are listed after {steps} Lanczos steps: {converged} converged, the others \
             within 3 %",
            model.singular_values.len()
        ));
    }
    let whole = markov_parameters(&model.discrete, samples + task.waves[0].kept.len());
    let parameters = (task.waves.len() + 1) * order + task.waves.len();
    let response: Vec<Vec<f64>> = whole.iter().map(|y| y[..samples].to_vec()).collect();
    let mut evidence = evidence_of_outputs(task, &whole, parameters)?;
    for output_evidence in &mut evidence {
        output_evidence.singular_value_errors = model.singular_value_errors.clone();
        output_evidence.paper = task.paper.then(|| "era".to_owned());
        output_evidence.validation_from_s = task.waves[0].kept_from_s();
    }

    let mut remarks = Notes::new();
    note_limits(&id, (1, task.waves.len()), None, &mut remarks);
    note_on_fit(&id, model.fit_percent, &mut remarks);
    let wave = &task.waves[0];
    let responses = responses_of(model, wave);
    let grid = if single { responses.grid_hz() } else { Vec::new() };
    let measured: Vec<Vec<f64>> = task.waves.iter().map(|wave| wave.sampled.samples().to_vec()).collect();
    let nominal = (&id[..], &responses.sample(&grid));
    let bootstrap = spread_of_outputs(task.bootstrap, nominal, (&measured, &response), parameters, &mut remarks, |y| {
        Some(sample_of(&(task.refit)(y)?, wave, &grid))
    });
    if let Some(bootstrap) = &bootstrap {
        evidence.iter_mut().for_each(|output_evidence| put_spreads(bootstrap, output_evidence));
    }
    let band = bootstrap.as_ref().map(Band::from_bootstrap);
    if let Some(record) = responses.response(INPUT, &output, band.as_ref()).filter(|_| single) {
        results.out.put(&format!("/response/{id}"), &record)?;
    }
    notes.extend(remarks.clone());
    results.out.notes().extend(remarks);
    let whole = identification(model, task, notes.to_texts());
    results.out.put(&format!("/identification/{id}"), &whole)?;
    poles.keep_those_of_modes(&mut evidence);
    results.enter(&id, &whole, &mut evidence)?;
    results.out.summary(format!("{}{}", summary(&id, &whole, &poles), validation_summary(&evidence)));
    Ok(())
}

/// Evidence from the response over all samples: one record for channels of one quantity, whose residuals stand one
/// after the other, else one for each.
fn evidence_of_outputs(
    task: &RealizationTask<'_>,
    whole: &[Vec<f64>],
    parameters: usize,
) -> anyhow::Result<Vec<EvidenceV1>> {
    let samples = task.samples();
    let evidence_of = |wave: &WindowedWave, response: &[f64], kept: &[f64]| {
        let mut output_evidence = simulation_evidence(None, wave, response, parameters);
        validate(wave, &[response, kept].concat(), &mut output_evidence);
        output_evidence
    };
    if !task.one_quantity() {
        return Ok(task
            .waves
            .iter()
            .zip(whole)
            .map(|(wave, y)| evidence_of(wave, &y[..samples], &y[samples..]))
            .collect());
    }
    let part = |from: usize, to: usize| whole.iter().flat_map(|y| &y[from..to]).copied().collect::<Vec<f64>>();
    let kept = task.waves[0].kept.len();
    Ok(vec![evidence_of(&joined(task.waves)?, &part(0, samples), &part(samples, samples + kept))])
}

/// All channels as one, one after the other.
fn joined(waves: &[WindowedWave]) -> anyhow::Result<WindowedWave> {
    let first = &waves[0].sampled;
    let samples = waves.iter().flat_map(|wave| wave.sampled.samples()).copied().collect();
    Ok(WindowedWave {
        id: waves.iter().map(|wave| wave.id.as_str()).collect::<Vec<_>>().join(", "),
        quantity: waves[0].quantity,
        sampled: Sampled::new(first.t0_s(), first.dt_s(), samples)?,
        kept: waves.iter().flat_map(|wave| &wave.kept).copied().collect(),
        edges: filter_edges(waves).to_vec(),
    })
}

fn responses_of<'a>(model: &'a Realization, wave: &WindowedWave) -> ModelResponses<'a> {
    let continuous = model.continuous.as_ref().ok();
    ModelResponses {
        continuous,
        discrete: Some(&model.discrete),
        poles: model.modes.iter().filter_map(|m| m.mode).map(|mode| mode.pole).collect(),
        zeros: continuous.map(zeros_of).unwrap_or_default(),
        dt_s: wave.sampled.dt_s(),
        samples: wave.sampled.len(),
        delay: 0,
    }
}

fn sample_of(model: &Realization, wave: &WindowedWave, grid_hz: &[f64]) -> Sample {
    responses_of(model, wave).sample(grid_hz)
}

pub fn state_space(model: &StateSpace, input: &str, output: &str, delay_s: Option<f64>) -> StateSpaceV1 {
    StateSpaceV1 {
        a: rows(&model.a),
        b: rows(&model.b),
        c: rows(&model.c),
        d: rows(&model.d),
        sample_time_s: model.sample_time_s.unwrap_or(0.0),
        input: input.to_owned(),
        output: output.to_owned(),
        delay_s,
    }
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

fn transfer_function(model: &StateSpace, output: &str) -> Result<TransferFunctionV1, LtiError> {
    let tf = to_transfer_function(model)?;
    Ok(TransferFunctionV1 {
        numerator: tf.numerator().to_vec(),
        denominator: tf.denominator().to_vec(),
        input: INPUT.to_owned(),
        output: output.to_owned(),
        delay_s: None,
    })
}

/// The poles with what ERA knows of each; a pole at `z = 0` has no continuous counterpart and no entry (a note tells of
/// it).
fn poles(model: &Realization, wave: &WindowedWave) -> Poles {
    let entries = model.modes.iter().filter_map(|identified| {
        Some(ModeV1 {
            modal_amplitude_coherence: identified.modal_amplitude_coherence,
            mode_singular_value: identified.mode_singular_value,
            ..entry(&identified.mode?, Some(identified.discrete_pole))
        })
    });
    Poles::new(entries.collect(), pole_record(&[wave]))
}

/// Shapes of the modes, conjugates once, and how alike they are.
pub fn shapes(poles: &[(Complex, Option<Mode>)], shapes: &[Option<Vec<Complex>>], waves: &[WindowedWave]) -> ShapesV1 {
    let modes = poles.iter().zip(shapes).filter(|((z, _), _)| z.im >= 0.0);
    let known: Vec<_> = modes.filter_map(|((_, mode), shape)| Some(((*mode)?, shape.as_ref()?))).collect();
    let modal_assurance =
        known.iter().map(|(_, p)| known.iter().map(|(_, q)| modal_assurance(p, q).unwrap_or(0.0)).collect()).collect();
    let shapes = known.iter().map(|(mode, shape)| ShapeV1 {
        re_per_s: mode.pole.re,
        im_rad_per_s: mode.pole.im,
        re: shape.iter().map(|x| x.re).collect(),
        im: shape.iter().map(|x| x.im).collect(),
        phase_collinearity: phase_collinearity(shape),
    });
    ShapesV1 { channels: waves.iter().map(|wave| wave.id.clone()).collect(), shapes: shapes.collect(), modal_assurance }
}

fn identification(model: &Realization, task: &RealizationTask<'_>, notes: Vec<String>) -> IdentificationV1 {
    let sampled = &task.waves[0].sampled;
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    IdentificationV1 {
        method: task.method.to_string(),
        order: size(model.order()),
        channel: task.names().join(", "),
        treated_as: task.treated_as.to_owned(),
        from_s: sampled.t0_s(),
        to_s: sampled.end_s(),
        samples: sampled.len() as u64,
        hankel_rows: Some(size(model.rows)),
        hankel_columns: Some(size(model.columns)),
        singular_values: model.singular_values.clone(),
        fit_percent: model.fit_percent,
        rmse: model.rmse,
        notes,
        output_fits_percent: if task.single() { Vec::new() } else { model.sequence_fits_percent.clone() },
        delay_s: None,
    }
}

/// `era-4: fit 81.4 % of 2501 samples; 5.31 Hz (damping 0.481), 13.2 Hz (damping 0.112)`.
fn summary(id: &str, model: &IdentificationV1, poles: &Poles) -> String {
    let fit = model.fit_percent.map_or("no defined fit".to_owned(), |fit| format!("fit {fit:.1} %"));
    let modes = poles.modes().filter(|mode| mode.im_rad_per_s >= 0.0).map(|mode| {
        if mode.im_rad_per_s == 0.0 {
            let re = if mode.re_per_s.abs() < 5e-5 { 0.0 } else { mode.re_per_s };
            return format!("real pole {re:.4} 1/s");
        }
        let damping = mode.damping_ratio.unwrap_or(0.0);
        format!("{:.3} Hz (damping ratio {damping:.3})", mode.natural_frequency_rad_per_s / TAU)
    });
    let modes: Vec<String> = modes.collect();
    let modes = if modes.is_empty() { String::new() } else { format!("; {}", modes.join(", ")) };
    format!("{id}: {fit} of {} samples{modes}", model.samples)
}

/// Writes the diagram of models of one channel.
pub fn put_diagram(
    method: &str,
    channel: &str,
    models: &[OrderPoles],
    dt_s: f64,
    settings: &Stabilisation,
    out: &mut Output,
) -> anyhow::Result<()> {
    if models.is_empty() {
        out.notes().info(format!("{method}: no stabilisation diagram: the record supports no order of two"));
        return Ok(());
    }
    let options = StabilizationOptions { highest_damping: settings.highest_damping, ..StabilizationOptions::default() };
    let diagram = stabilization(models, dt_s, options);
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let several = diagram.poles.iter().any(|pole| pole.shape.len() > 1);
    let record = StabilizationV1 {
        method: method.to_owned(),
        channel: channel.to_owned(),
        orders: diagram.orders.iter().map(|order| size(*order)).collect(),
        highest_damping: options.highest_damping,
        nyquist_share: options.nyquist_share,
        least_collinearity: several.then_some(options.least_collinearity),
        least_strength: diagram.poles.iter().any(|pole| pole.strength.is_some()).then_some(options.least_strength),
        frequency_change: options.frequency_change,
        damping_change: options.damping_change,
        shape_change: several.then_some(options.shape_change),
        presence: options.presence,
        poles: diagram
            .poles
            .iter()
            .map(|pole| StabilizationPoleV1 {
                order: size(pole.order),
                re_per_s: pole.mode.pole.re,
                im_rad_per_s: pole.mode.pole.im,
                stability: pole.stability.name().to_owned(),
            })
            .collect(),
        clusters: diagram
            .clusters
            .iter()
            .map(|cluster| StabilizationClusterV1 {
                orders: size(cluster.orders),
                natural_frequency_rad_per_s: cluster.natural_frequency_rad_per_s.median,
                natural_frequency_lower_rad_per_s: cluster.natural_frequency_rad_per_s.lower,
                natural_frequency_upper_rad_per_s: cluster.natural_frequency_rad_per_s.upper,
                damping_ratio: cluster.damping_ratio.median,
                damping_ratio_lower: cluster.damping_ratio.lower,
                damping_ratio_upper: cluster.damping_ratio.upper,
                halves_rad_per_s: Vec::new(),
                shape_re: Vec::new(),
                shape_im: Vec::new(),
            })
            .collect(),
        not_in_both_halves: None,
    };
    let highest = diagram.orders.last().copied().unwrap_or(0);
    let names: Vec<String> = diagram
        .clusters
        .iter()
        .map(|c| {
            let hz = c.natural_frequency_rad_per_s.median / TAU;
            format!("{hz:.2} Hz (damping {:.3}, in {} orders)", c.damping_ratio.median, c.orders)
        })
        .collect();
    out.summary(if names.is_empty() {
        format!("{method}: no mode stays over half of the orders up to {highest}")
    } else {
        format!("{method}: modes that stay over the orders up to {highest}: {}", names.join(", "))
    });
    out.put(&format!("/stabilisation/{method}"), &record)
}
