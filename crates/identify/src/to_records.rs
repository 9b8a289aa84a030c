//! An identified model as the records of the artifact.

use crumple_identify::{Decomposition, Realization, Sample, markov_parameters, modal_assurance, phase_collinearity};
use crumple_lti::{LtiError, StateSpace, to_transfer_function};
use crumple_signal::{Notes, QuantityKind, Sampled};
use crumple_stage::Output;
use crumple_stage::records::{IdentificationV1, ModeV1, ModesV1, ShapeV1, ShapesV1, StateSpaceV1, TransferFunctionV1};
use nalgebra::DMatrix;

use crate::acceptable::note_on_fit;
use crate::comparison::Comparison;
use crate::evidence::{evidence, foretold, validate};
use crate::evidence_options::BootstrapSettings;
use crate::input_output::{Cut, filter_edges};
use crate::judgement::{Band, Judged, limits, put_spreads, spread, zeros_of};

/// What a reader of the model must know of its input.
const INPUT: &str = "unit impulse (the record taken as Markov parameters)";

/// What a model comes from.
pub struct Pass<'a> {
    /// `era` or `era-dc`.
    pub method: &'a str,
    /// The channels, sampled together, at least one.
    pub cuts: &'a [Cut],
    /// What the samples are taken for.
    pub treated_as: &'static str,
    /// Bootstrap, if asked for.
    pub bootstrap: Option<&'a BootstrapSettings>,
    /// Whether this is the procedure of the paper, which the id then says with the number of samples.
    pub paper: bool,
    /// The same estimate from another record of one channel.
    pub refit: &'a (dyn Fn(&[f64]) -> Option<Realization> + Sync),
}

impl Pass<'_> {
    fn names(&self) -> Vec<&str> {
        self.cuts.iter().map(|cut| cut.id.as_str()).collect()
    }

    fn single(&self) -> bool {
        self.cuts.len() == 1
    }

    fn samples(&self) -> usize {
        self.cuts[0].sampled.len()
    }
}

/// Writes the records of one model under its id, `<method>-<order>`, and a summary line.
pub fn put_model(
    model: &Realization,
    pass: &Pass<'_>,
    notes: &Notes,
    comparison: &mut Comparison,
    out: &mut Output,
) -> anyhow::Result<()> {
    let (order, samples, single) = (model.order(), pass.samples(), pass.single());
    let paper = if pass.paper { format!("-n{samples}-paper") } else { String::new() };
    let id = format!("{}-{order}{paper}", pass.method);
    let plural = if single { "" } else { "s" };
    let output = format!("acceleration of channel{plural} {}, m/s^2", pass.names().join(", "));
    let mut notes = notes.to_texts();
    out.put(&format!("/model/{id}/discrete"), &state_space(&model.discrete, INPUT, &output, None))?;
    if let Ok(continuous) = &model.continuous {
        out.put(&format!("/model/{id}/continuous"), &state_space(continuous, INPUT, &output, None))?;
        match transfer_function(continuous, &output) {
            _ if !single => {}
            Ok(record) => out.put(&format!("/model/{id}/transfer-function"), &record)?,
            Err(error) => notes.push(format!("no transfer function: {error}")),
        }
    }
    out.put(&format!("/modes/{id}"), &modes(model))?;
    if !single {
        out.put(&format!("/shapes/{id}"), &shapes(model, &pass.names()))?;
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
    let whole = markov_parameters(&model.discrete, samples + pass.cuts[0].kept.len());
    // Of several channels the residuals stand one after the other.
    let cut = joined(pass.cuts)?;
    let part = |samples: std::ops::Range<usize>| whole.iter().flat_map(|y| &y[samples.clone()]).copied().collect();
    let response: Vec<f64> = part(0..samples);
    let kept: Vec<f64> = part(samples..samples + pass.cuts[0].kept.len());
    let parameters = (pass.cuts.len() + 1) * order + pass.cuts.len();
    let mut support = evidence(None, &cut, &response, parameters);
    support.singular_value_errors = model.singular_value_errors.clone();
    support.paper = pass.paper.then(|| "era".to_owned());
    validate(&cut, &[&response[..], &kept].concat(), &mut support);
    support.validation_from_s = pass.cuts[0].kept_from_s();

    let mut remarks = Notes::new();
    limits(&id, (1, pass.cuts.len()), pass.bootstrap, &mut remarks);
    note_on_fit(&id, model.fit_percent, &mut remarks);
    if single {
        let judged = judged(model, &cut);
        let grid = judged.grid_hz();
        let record = (cut.sampled.samples(), &response[..]);
        let found = spread(pass.bootstrap, (&id, &judged.sample(&grid)), record, parameters, &mut remarks, |y| {
            Some(judged_sample(&(pass.refit)(y)?, &cut, &grid))
        });
        let band = found.as_ref().map(Band::from_bootstrap);
        if let Some(found) = &found {
            put_spreads(found, &mut support);
        }
        if let Some(record) = judged.response(INPUT, &output, band.as_ref()) {
            out.put(&format!("/response/{id}"), &record)?;
        }
    }
    notes.extend(remarks.to_texts());
    out.notes().extend(remarks);
    out.put(&format!("/identification/{id}"), &identification(model, pass, notes))?;
    out.put(&format!("/evidence/{id}"), &support)?;
    let supports = std::slice::from_ref(&support);
    comparison.enter(&id, samples, supports);
    out.summary(format!("{}{}", summary(&id, model, samples), foretold(supports)));
    Ok(())
}

/// All channels as one, one after the other.
fn joined(cuts: &[Cut]) -> anyhow::Result<Cut> {
    let first = &cuts[0].sampled;
    let samples = cuts.iter().flat_map(|cut| cut.sampled.samples()).copied().collect();
    Ok(Cut {
        id: cuts.iter().map(|cut| cut.id.as_str()).collect::<Vec<_>>().join(", "),
        quantity: QuantityKind::Acceleration,
        sampled: Sampled::new(first.t0_s(), first.dt_s(), samples)?,
        kept: cuts.iter().flat_map(|cut| &cut.kept).copied().collect(),
        edges: filter_edges(cuts).to_vec(),
    })
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
        delay: 0,
    }
}

fn judged_sample(model: &Realization, cut: &Cut, grid_hz: &[f64]) -> Sample {
    judged(model, cut).sample(grid_hz)
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

/// One entry a pole; a pole at `z = 0` has no continuous counterpart and no entry (a note tells of it).
fn modes(model: &Realization) -> ModesV1 {
    let entries = model.modes.iter().filter_map(|identified| {
        let mode = identified.mode?;
        Some(ModeV1 {
            // Adding zero takes the sign from a zero.
            re_per_s: mode.pole.re + 0.0,
            im_rad_per_s: mode.pole.im + 0.0,
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

fn identification(model: &Realization, pass: &Pass<'_>, notes: Vec<String>) -> IdentificationV1 {
    let sampled = &pass.cuts[0].sampled;
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    IdentificationV1 {
        method: pass.method.to_owned(),
        order: size(model.order()),
        channel: pass.names().join(", "),
        treated_as: pass.treated_as.to_owned(),
        from_s: sampled.t0_s(),
        to_s: sampled.end_s(),
        samples: sampled.len() as u64,
        hankel_rows: Some(size(model.rows)),
        hankel_columns: Some(size(model.columns)),
        singular_values: model.singular_values.clone(),
        fit_percent: model.fit_percent,
        rmse: model.rmse,
        notes,
        output_fits_percent: Vec::new(),
        delay_s: None,
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
                let re = if mode.pole.re.abs() < 5e-5 { 0.0 } else { mode.pole.re };
                format!("real pole {re:.4} 1/s")
            } else {
                let damping = mode.damping_ratio.unwrap_or(0.0);
                format!("{:.3} Hz (damping ratio {damping:.3})", mode.natural_frequency_hz())
            }
        })
        .collect();
    format!("{id}: {fit} of {samples} samples; {}", modes.join(", "))
}
