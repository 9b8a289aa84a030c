//! A realisation by ERA and its stabilisation diagram, as records.

use std::f64::consts::TAU;

use crumple_numerics::lti::{Complex, Mode, StateSpace, to_transfer_function};
use crumple_signal::{About, Notes, Weight, remarks};
use crumple_stage::Output;
use crumple_stage::records::{ModeV1, ShapeV1, ShapesV1, StabilizationClusterV1, StabilizationPoleV1, StabilizationV1};
use crumple_sysid::{
    Decomposition, IoData, OrderPoles, Realization, StabilizationOptions, markov_parameters, modal_assurance,
    phase_collinearity, simulate_fitted, stabilization,
};
use nalgebra::DMatrix;

use crate::stage::options::choices::Method;
use crate::stage::options::settings::{BootstrapSettings, Stabilisation};
use crate::stage::records::discrete::{PartLeftOut, note_on_fit};
use crate::stage::records::evidence::{Poles, entry, pole_record};
use crate::stage::records::model::{FittedModel, Forms, IMPULSE, Simulated, evidence_of};
use crate::stage::records::responses::{ModelResponses, zeros_of};
use crate::stage::records::results::Results;
use crate::stage::waves::WindowedWave;

/// What realised models come from.
pub struct RealizationTask<'a> {
    /// `era`.
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
    fn samples(&self) -> usize {
        self.waves[0].sampled.len()
    }

    /// `<method>-<order>`; of the paper's procedure with the number of samples.
    pub fn id(&self, order: usize) -> String {
        let paper = if self.paper { format!("-n{}-paper", self.samples()) } else { String::new() };
        format!("{}-{order}{paper}", self.method)
    }
}

/// Writes one model under its id, `<method>-<order>`, and says it on the screen.
pub fn put_realization(
    model: &Realization,
    task: &RealizationTask<'_>,
    mut notes: Notes,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let (order, single) = (model.order(), task.waves.len() == 1);
    let id = task.id(order);
    let forms = forms(&id, model, single, &mut notes);
    let poles = poles(model, &task.waves[0]);
    let shapes = (!single).then(|| {
        let mut are_modes = poles.are_modes();
        let modes = model.modes.iter().map(|identified| {
            let mode = identified.mode.filter(|_| are_modes.next().unwrap_or(true));
            (identified.discrete_pole, mode)
        });
        shapes(&modes.collect::<Vec<_>>(), &model.mode_shapes, task.waves)
    });
    if let Decomposition::Lanczos { steps } = model.decomposition {
        let converged = model
            .singular_value_errors
            .iter()
            .take_while(|error| **error <= 1e-9 * model.singular_values.first().copied().unwrap_or(0.0))
            .count();
        notes.push(LanczosValues { id: id.clone(), values: model.singular_values.len(), steps, converged });
    }
    let simulated = simulated(model, task)?;
    let parameters = (task.waves.len() + 1) * order + task.waves.len();
    let mut evidence = evidence_of(&[], task.waves, &simulated.used, parameters);
    for output_evidence in &mut evidence {
        output_evidence.singular_value_errors = model.singular_value_errors.clone();
        output_evidence.paper = task.paper.then(|| "era".to_owned());
    }
    note_on_fit(&id, model.fit_percent, &mut notes);
    let wave = &task.waves[0];
    FittedModel {
        id: &id,
        method: task.method,
        order,
        treated_as: task.treated_as,
        input: IMPULSE.to_owned(),
        inputs: &[],
        outputs: task.waves,
        delay_s: None,
        forms,
        poles,
        shapes,
        simulated,
        evidence,
        hankel: (Some(model.rows), Some(model.columns)),
        singular_values: model.singular_values.clone(),
        responses: responses_of(model, wave),
        band: None,
        bootstrap: task.bootstrap,
        hold: None,
        refit: Box::new(|y, grid| Some(responses_of(&(task.refit)(y)?, wave).sample(grid))),
        notes,
    }
    .put(results)
}

/// The sampled model, the continuous one, and of one channel its transfer function.
fn forms(id: &str, model: &Realization, single: bool, notes: &mut Notes) -> Forms {
    let mut forms =
        Forms { state_spaces: vec![("discrete", model.discrete.clone(), IMPULSE.to_owned())], ..Forms::default() };
    if let Ok(continuous) = &model.continuous {
        forms.state_spaces.push(("continuous", continuous.clone(), IMPULSE.to_owned()));
        match to_transfer_function(continuous) {
            _ if !single => {}
            Ok(tf) => forms.paths = vec![vec![(tf.numerator().to_vec(), tf.denominator().to_vec())]],
            Err(error) => notes.push(PartLeftOut::new(id, "transfer function", &error)),
        }
    }
    forms
}

/// The impulse response over all samples; over the kept ones also a free motion with the start fitted to them.
fn simulated(model: &Realization, task: &RealizationTask<'_>) -> anyhow::Result<Simulated> {
    let first = &task.waves[0];
    let (samples, kept) = (first.sampled.len(), first.kept.len());
    let mut used = markov_parameters(&model.discrete, samples + kept);
    let run_on: Vec<Vec<f64>> = used.iter_mut().map(|y| y.split_off(samples)).collect();
    if kept == 0 {
        return Ok(Simulated::all_used(used));
    }
    let StateSpace { a, c, sample_time_s, .. } = &model.discrete;
    let (order, outputs) = (a.nrows(), c.nrows());
    let none = (DMatrix::zeros(order, 0), DMatrix::zeros(outputs, 0));
    let free = StateSpace::new(a.clone(), none.0, c.clone(), none.1, *sample_time_s)?;
    let measured = task.waves.iter().map(|wave| wave.kept.clone()).collect();
    let unseen = IoData::new(Vec::new(), measured, first.sampled.dt_s());
    // Too few samples for a state have none.
    let restarted = unseen.and_then(|unseen| simulate_fitted(&free, &unseen)).map_or(Vec::new(), |(y, _)| y);
    Ok(Simulated { used, run_on, restarted })
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
        let reason = "the record supports no order of two";
        out.notes().push(PartLeftOut::new(method, "stabilisation diagram", &reason));
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

remarks! {
    /// Remarks of decompositions.
    pub REMARKS;

    /// Only the leading singular values of a large Hankel matrix were computed.
    CR468 LanczosValues { id: String, values: usize, steps: usize, converged: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Matrices with more than 64 rows and columns are not formed. Lanczos steps give the leading values: \
             converged ones err by 1e-9 of the largest at most, the others by 3 % of themselves."
    means "The model is made from converged values. The others only show where the singular values level off."
    remedy "nothing; --rows or --columns up to 64 compute all of them"
    says format!(
        "{id}: {values} singular values were computed in {steps} Lanczos steps: {converged} converged, the others are \
         known to 3 %"
    );
}
