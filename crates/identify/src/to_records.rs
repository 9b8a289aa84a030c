//! An identified model as the records of the artifact.

use crumple_identify::{Decomposition, Realization, markov_parameters, modal_assurance, phase_collinearity};
use crumple_lti::{LtiError, StateSpace, to_transfer_function};
use crumple_signal::{Notes, QuantityKind, Sampled};
use crumple_stage::Output;
use crumple_stage::records::{IdentificationV1, ModeV1, ModesV1, ShapeV1, ShapesV1, StateSpaceV1, TransferFunctionV1};
use nalgebra::DMatrix;

use crate::evidence::evidence;
use crate::input_output::Cut;

/// What a reader of the model must know of its input.
const INPUT: &str = "unit impulse (the record taken as Markov parameters)";

/// The samples a model was identified from.
pub struct Window<'a> {
    /// `era` or `era-dc`.
    pub method: &'a str,
    /// Ids of the channels.
    pub channels: &'a [&'a str],
    /// The samples of each and their times.
    pub sampled: &'a [Sampled],
    /// What the samples are taken for.
    pub treated_as: &'static str,
}

/// Writes the records of one model under its id, `<method>-<order>`, and a summary line.
pub fn put_model(model: &Realization, window: &Window<'_>, notes: &Notes, out: &mut Output) -> anyhow::Result<()> {
    let id = format!("{}-{}", window.method, model.order());
    let single = window.channels.len() == 1;
    let plural = if single { "" } else { "s" };
    let output = format!("acceleration of channel{plural} {}, m/s^2", window.channels.join(", "));
    let mut notes = notes.to_texts();
    out.put(&format!("/model/{id}/discrete"), &state_space(&model.discrete, INPUT, &output))?;
    if let Ok(continuous) = &model.continuous {
        out.put(&format!("/model/{id}/continuous"), &state_space(continuous, INPUT, &output))?;
        match transfer_function(continuous, &output) {
            _ if !single => {}
            Ok(record) => out.put(&format!("/model/{id}/transfer-function"), &record)?,
            Err(error) => notes.push(format!("no transfer function: {error}")),
        }
    }
    out.put(&format!("/modes/{id}"), &modes(model))?;
    if !single {
        out.put(&format!("/shapes/{id}"), &shapes(model, window.channels))?;
    }
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
    out.put(&format!("/identification/{id}"), &identification(model, window, notes))?;
    // Of several channels the residuals stand one after the other.
    let first = &window.sampled[0];
    let samples = window.sampled.iter().flat_map(Sampled::samples).copied().collect();
    let sampled = Sampled::new(first.t0_s(), first.dt_s(), samples)?;
    let cut = Cut { id: window.channels.join(", "), quantity: QuantityKind::Acceleration, sampled };
    let response = markov_parameters(&model.discrete, first.len()).concat();
    let mut support =
        evidence(None, &cut, &response, (window.channels.len() + 1) * model.order() + window.channels.len());
    support.singular_value_errors = model.singular_value_errors.clone();
    out.put(&format!("/evidence/{id}"), &support)?;
    out.summary(summary(&id, model, window));
    Ok(())
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

/// Shapes of the modes, conjugates once, and how alike they are.
fn shapes(model: &Realization, channels: &[&str]) -> ShapesV1 {
    let modes = model.modes.iter().zip(&model.mode_shapes).filter(|(mode, _)| mode.discrete_pole.im >= 0.0);
    let known: Vec<_> = modes.filter_map(|(mode, shape)| Some((mode.mode?, shape.as_ref()?))).collect();
    let modal_assurance =
        known.iter().map(|(_, p)| known.iter().map(|(_, q)| modal_assurance(p, q).unwrap_or(0.0)).collect()).collect();
    let shapes = known.iter().map(|(mode, shape)| ShapeV1 {
        re_per_s: mode.pole.re,
        im_rad_per_s: mode.pole.im,
        re: shape.iter().map(|x| x.re).collect(),
        im: shape.iter().map(|x| x.im).collect(),
        phase_collinearity: phase_collinearity(shape),
    });
    ShapesV1 {
        channels: channels.iter().map(|&channel| channel.to_owned()).collect(),
        shapes: shapes.collect(),
        modal_assurance,
    }
}

fn identification(model: &Realization, window: &Window<'_>, notes: Vec<String>) -> IdentificationV1 {
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    IdentificationV1 {
        method: window.method.to_owned(),
        order: size(model.order()),
        channel: window.channels.join(", "),
        treated_as: window.treated_as.to_owned(),
        from_s: window.sampled[0].t0_s(),
        to_s: window.sampled[0].end_s(),
        samples: window.sampled[0].len() as u64,
        hankel_rows: Some(size(model.rows)),
        hankel_columns: Some(size(model.columns)),
        singular_values: model.singular_values.clone(),
        fit_percent: model.fit_percent,
        rmse: model.rmse,
        notes,
        output_fits_percent: Vec::new(),
    }
}

/// `era-4: fit 81.4 % of 2501 samples; 5.31 Hz (damping 0.481), 13.2 Hz (damping 0.112)`.
fn summary(id: &str, model: &Realization, window: &Window<'_>) -> String {
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
    format!("{id}: {fit} of {} samples; {}", window.sampled[0].len(), modes.join(", "))
}
