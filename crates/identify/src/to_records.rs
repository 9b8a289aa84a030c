//! An identified model as the records of the artifact.

use crumple_identify::{Decomposition, EraOptions, Order, Realization, Sample, era};
use crumple_lti::{LtiError, StateSpace, impulse_response, to_transfer_function};
use crumple_signal::Notes;
use crumple_stage::Output;
use crumple_stage::records::{IdentificationV1, ModeV1, ModesV1, StateSpaceV1, TransferFunctionV1};
use nalgebra::DMatrix;

use crate::comparison::Comparison;
use crate::evidence::{evidence, foretold, validate};
use crate::evidence_options::BootstrapSettings;
use crate::input_output::Cut;
use crate::judgement::{Band, Judged, put_spreads, spread, zeros_of};

/// What a reader of the model must know of its input.
const INPUT: &str = "unit impulse (the record taken as Markov parameters)";

/// What all models of one decomposition share.
pub struct Pass<'a> {
    /// The record.
    pub cut: &'a Cut,
    /// How it was decomposed.
    pub options: EraOptions,
    /// Bootstrap, if asked for.
    pub bootstrap: Option<&'a BootstrapSettings>,
    /// Whether this is the procedure of the paper, which the id then says with the number of samples.
    pub paper: bool,
}

/// Writes the records of one model under its id, `era-<order>`, and a summary line.
pub fn put_model(
    model: &Realization,
    pass: &Pass<'_>,
    notes: &Notes,
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<()> {
    let Pass { cut, options, bootstrap, paper } = pass;
    let (order, samples) = (model.order(), cut.sampled.len());
    let id = if *paper { format!("era-{order}-n{samples}-paper") } else { format!("era-{order}") };
    let output = format!("acceleration of channel {}, m/s^2", cut.id);
    let mut notes = notes.to_texts();
    out.put(&format!("/model/{id}/discrete"), &state_space(&model.discrete, INPUT, &output))?;
    if let Ok(continuous) = &model.continuous {
        out.put(&format!("/model/{id}/continuous"), &state_space(continuous, INPUT, &output))?;
        match transfer_function(continuous, &output) {
            Ok(record) => out.put(&format!("/model/{id}/transfer-function"), &record)?,
            Err(error) => notes.push(format!("no transfer function: {error}")),
        }
    }
    out.put(&format!("/modes/{id}"), &modes(model))?;
    if let Decomposition::Lanczos { steps } = model.decomposition {
        let converged = model
            .singular_value_errors
            .iter()
            .take_while(|error| **error <= 1e-9 * model.singular_values.first().copied().unwrap_or(0.0))
            .count();
        notes.push(format!(
            "the {} leading singular values are listed after {steps} Lanczos steps: {converged} converged, the others within 3 %",
            model.singular_values.len()
        ));
    }
    let whole = impulse_response(&model.discrete, samples + cut.kept.len())?;
    let response = &whole[..samples];
    let mut support = evidence(None, cut, response, 2 * order + 1);
    support.singular_value_errors = model.singular_value_errors.clone();
    support.paper = paper.then(|| "era".to_owned());
    validate(cut, &whole, &mut support);

    let judged = judged(model, cut);
    let grid = judged.grid_hz();
    let options = EraOptions { order: Order::Given(order), ..*options };
    let mut remarks = Notes::new();
    let record = (cut.sampled.samples(), response);
    let found = spread(*bootstrap, (&id, &judged.sample(&grid)), record, 2 * order + 1, &mut remarks, |y| {
        Some(judged_sample(&era(y, options).ok()?, cut, &grid))
    });
    notes.extend(remarks.to_texts());
    out.notes().extend(remarks);
    let band = found.as_ref().map(Band::from_bootstrap);
    if let Some(found) = &found {
        put_spreads(found, &mut support);
    }
    if let Some(record) = judged.response(INPUT, &output, band.as_ref()) {
        out.put(&format!("/response/{id}"), &record)?;
    }
    out.put(&format!("/identification/{id}"), &identification(model, cut, notes))?;
    out.put(&format!("/evidence/{id}"), &support)?;
    comparison.enter(&id, samples, &support);
    out.summary(format!("{}{}", summary(&id, model, samples), foretold(&support)));
    Ok(())
}

fn judged<'a>(model: &'a Realization, cut: &Cut) -> Judged<'a> {
    let continuous = model.continuous.as_ref().ok();
    Judged {
        continuous,
        discrete: Some(&model.discrete),
        poles: model.modes.iter().filter_map(|m| m.mode).map(|mode| mode.pole).collect(),
        zeros: continuous.map(zeros_of).unwrap_or_default(),
        dt_s: cut.sampled.dt_s(),
        samples: cut.sampled.len(),
    }
}

fn judged_sample(model: &Realization, cut: &Cut, grid_hz: &[f64]) -> Sample {
    judged(model, cut).sample(grid_hz)
}

pub fn state_space(model: &StateSpace, input: &str, output: &str) -> StateSpaceV1 {
    StateSpaceV1 {
        a: rows(&model.a),
        b: rows(&model.b),
        c: rows(&model.c),
        d: rows(&model.d),
        sample_time_s: model.sample_time_s.unwrap_or(0.0),
        input: input.to_owned(),
        output: output.to_owned(),
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
    })
}

/// One entry a pole; a pole at `z = 0` has no continuous counterpart and no entry (a note tells of it).
fn modes(model: &Realization) -> ModesV1 {
    let entries = model.modes.iter().filter_map(|identified| {
        let mode = identified.mode?;
        Some(ModeV1 {
            re_per_s: mode.pole.re,
            im_rad_per_s: mode.pole.im,
            natural_frequency_rad_per_s: mode.natural_frequency_rad_per_s,
            damping_ratio: mode.damping_ratio,
            modal_amplitude_coherence: identified.modal_amplitude_coherence,
            mode_singular_value: identified.mode_singular_value,
            discrete_re: Some(identified.discrete_pole.re),
            discrete_im: Some(identified.discrete_pole.im),
        })
    });
    ModesV1(entries.collect())
}

fn identification(model: &Realization, cut: &Cut, notes: Vec<String>) -> IdentificationV1 {
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    IdentificationV1 {
        method: "era".to_owned(),
        order: size(model.order()),
        channel: cut.id.clone(),
        treated_as: "impulse-response".to_owned(),
        from_s: cut.sampled.t0_s(),
        to_s: cut.sampled.end_s(),
        samples: cut.sampled.len() as u64,
        hankel_rows: Some(size(model.rows)),
        hankel_columns: Some(size(model.columns)),
        singular_values: model.singular_values.clone(),
        fit_percent: model.fit_percent,
        rmse: model.rmse,
        notes,
    }
}

/// `era-4: fit 81.4 % of 2501 samples; 5.31 Hz (damping 0.481), 13.2 Hz (damping 0.112)`.
fn summary(id: &str, model: &Realization, samples: usize) -> String {
    let fit = model.fit_percent.map_or("no defined fit".to_owned(), |fit| format!("fit {fit:.1} %"));
    let modes: Vec<String> = model
        .modes
        .iter()
        .filter_map(|identified| identified.mode)
        .filter(|mode| mode.pole.im >= 0.0)
        .map(|mode| {
            if mode.pole.im == 0.0 {
                format!("real pole {:.4} 1/s", mode.pole.re)
            } else {
                let damping = mode.damping_ratio.unwrap_or(0.0);
                format!("{:.3} Hz (damping ratio {damping:.3})", mode.natural_frequency_hz())
            }
        })
        .collect();
    format!("{id}: {fit} of {samples} samples; {}", modes.join(", "))
}
