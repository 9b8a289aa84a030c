//! One fitted model of any method: its records, its simulated outputs, its lines on the screen.

use std::f64::consts::PI;

use crumple_numerics::lti::{InputHold, StateSpace, to_continuous};
use crumple_signal::{About, Note, Notes, Sampled, Severity, Weight, remarks};
use crumple_stage::records::{
    EvidenceV1, ExponentialSumV1, ExponentialTermV1, IdentificationV1, ShapesV1, StateSpaceV1, TransferFunctionV1,
};
use crumple_stage::{Output, remark_on_model};
use crumple_sysid::{
    Bootstrap, IdentifyError, IoData, NoiseModel, Sample, continued, fit_measures, line_loss, simulate_fitted,
    unseen_squares, weak_fit,
};
use nalgebra::DMatrix;

use crate::stage::options::choices::Method;
use crate::stage::options::settings::BootstrapSettings;
use crate::stage::records::evidence::{Poles, add_to_gains, simulation_evidence, without_simulation};
use crate::stage::records::lines;
use crate::stage::records::responses::{Band, IntervalTask, ModelResponses, note_limits, zeros_of};
use crate::stage::records::results::Results;
use crate::stage::waves::{Record, WindowedWave};

/// Share of an amplitude below which no loss is said: calibrations of sensors leave as much open (ISO 16063-21).
const LEAST_LOSS: f64 = 0.005;

/// What a reader of the model of an impulse response must know of its input.
pub const IMPULSE: &str = "unit impulse (the record taken as Markov parameters)";

/// Outputs of a model on a record.
pub struct Simulated {
    /// Over the samples that it was identified from.
    pub used: Vec<Vec<f64>>,
    /// Over those kept after them, run on from its state; empty: none were kept.
    pub run_on: Vec<Vec<f64>>,
    /// The same with the initial state fitted to them; empty where the method has no state.
    pub restarted: Vec<Vec<f64>>,
}

impl Simulated {
    /// Nothing was kept for validation.
    pub fn all_used(used: Vec<Vec<f64>>) -> Self {
        Self { used, run_on: Vec::new(), restarted: Vec::new() }
    }

    /// Of a sampled model on what it was identified from and on `whole`, kept samples included. `start`: its initial
    /// state, where that is not fitted.
    pub fn of_state_space(
        model: &StateSpace,
        used: Vec<Vec<f64>>,
        (first, whole): (&IoData, &IoData),
        start: Option<&[f64]>,
    ) -> Result<Self, IdentifyError> {
        let count = first.samples();
        if whole.samples() == count {
            return Ok(Self::all_used(used));
        }
        let all = continued(model, first, whole, start)?;
        let run_on = all.into_iter().map(|mut y| y.split_off(count)).collect();
        // The protocol of published comparisons: the initial state is fitted to the kept samples.
        let restarted = simulate_fitted(model, &whole.slice(count, whole.samples())?)?.0;
        Ok(Self { used, run_on, restarted })
    }

    /// Those over the kept samples that are shown and counted: with the start fitted, where the method can.
    pub fn unseen(&self) -> &[Vec<f64>] {
        if self.restarted.is_empty() { &self.run_on } else { &self.restarted }
    }
}

/// Forms of a model.
#[derive(Default)]
pub struct Forms {
    /// State spaces by the last part of their topic, and what drives each, in words.
    pub state_spaces: Vec<(&'static str, StateSpace, String)>,
    /// Numerator and denominator of every path, by output and input; empty: none are written.
    pub paths: Vec<Vec<(Vec<f64>, Vec<f64>)>>,
    /// Whether these polynomials are what was fitted.
    pub is_transfer_function: bool,
    /// Terms of a sum of exponentials.
    pub terms: Vec<ExponentialTermV1>,
}

/// Fits the method again to another record of every output, to compare poles, zeros and a frequency response on a grid.
pub type Refit<'a> = Box<dyn Fn(&[Vec<f64>], &[f64]) -> Option<Sample> + Sync + 'a>;

/// A model as its method hands it over.
pub struct FittedModel<'a> {
    /// Its id.
    pub id: &'a str,
    /// Name of the method.
    pub method: Method,
    /// Number of states.
    pub order: usize,
    /// What the samples were taken for.
    pub treated_as: &'static str,
    /// What drives it, in words.
    pub input: String,
    /// The waveforms that drive it; empty: none does.
    pub inputs: &'a [WindowedWave],
    /// Those it answers with.
    pub outputs: &'a [WindowedWave],
    /// Time by which the inputs act late, s.
    pub delay_s: Option<f64>,
    /// The model itself.
    pub forms: Forms,
    /// Its poles.
    pub poles: Poles,
    /// Shapes of its modes, of several outputs.
    pub shapes: Option<ShapesV1>,
    /// Its outputs.
    pub simulated: Simulated,
    /// What the method knows of every output.
    pub evidence: Vec<EvidenceV1>,
    /// Rows and columns of the Hankel matrix, where there is one.
    pub hankel: (Option<usize>, Option<usize>),
    /// Its singular values.
    pub singular_values: Vec<f64>,
    /// What its responses are made from.
    pub responses: ModelResponses<'a>,
    /// Band of its frequency response without a bootstrap.
    pub band: Option<Band>,
    /// Bootstrap, if asked for and possible.
    pub bootstrap: Option<&'a BootstrapSettings>,
    /// Hold that its continuous form is made for; `None` without an input.
    pub hold: Option<InputHold>,
    /// The same fit of another record.
    pub refit: Refit<'a>,
    /// What a reader should know.
    pub notes: Notes,
}

impl FittedModel<'_> {
    /// Writes everything under its id, and says it on the screen.
    pub fn put(mut self, results: &mut Results<'_>) -> anyhow::Result<()> {
        self.put_forms(results.out)?;
        let modes = self.poles.record();
        results.out.put(&format!("/modes/{}", self.id), &modes)?;
        if let Some(shapes) = &self.shapes {
            results.out.put(&format!("/shapes/{}", self.id), shapes)?;
        }
        self.put_responses(results.out)?;
        self.put_waves(results.out)?;
        let ambient = self.is_ambient();
        if !ambient {
            self.validate();
        }
        let mut evidence = std::mem::take(&mut self.evidence);
        let loses_in_lines = self.put_line_loss(&mut evidence);
        self.poles.keep_those_of_modes(&mut evidence);
        self.poles.take_window_off(&mut evidence);
        let mut identification = self.identification();
        if ambient {
            without_simulation(&mut identification, &mut evidence);
        }
        let contradiction = results.enter(self.id, &identification, &mut evidence, self.unseen_squares())?;
        let own = std::mem::take(&mut self.notes);
        let notes: Vec<Note> = contradiction.into_iter().chain(own.iter().cloned()).collect();
        remark_on_model(&mut identification, &notes);
        results.out.put(&format!("/identification/{}", self.id), &identification)?;
        let warnings: Vec<&Note> = notes.iter().filter(|note| note.severity == Severity::Warning).collect();
        let of_model = lines::ModelFacts {
            id: self.id,
            identification: &identification,
            evidence: &evidence,
            modes: &modes,
            forms: &self.forms,
            zeros: &self.responses.zeros,
            loses_in_lines,
        };
        of_model.lines(&warnings).into_iter().for_each(|line| results.out.summary(line));
        results.out.notes().extend(own);
        Ok(())
    }

    /// Where straight lines between the samples of an input lose more than the record leaves open, the deviations of
    /// gains hold that too, and a warning says so: `d² + (loss b)²`.
    ///
    /// The record leaves open `sqrt(V/(N y²))` of a gain, `V` the mean square of the errors, `y²` that of the output,
    /// `N` independent samples.
    fn put_line_loss(&mut self, evidence: &mut [EvidenceV1]) -> bool {
        let losses = self.inputs.iter().filter_map(|wave| Some((wave, line_loss(wave.sampled.samples())?)));
        let worst = losses.reduce(|worst, next| if next.1.share > worst.1.share { next } else { worst });
        let Some((input, loss)) = worst.filter(|_| self.hold == Some(InputHold::First)) else {
            return false;
        };
        let left_open = |(evidence, wave): (&EvidenceV1, &WindowedWave)| {
            let samples = wave.sampled.samples();
            let square = samples.iter().map(|y| y * y).sum::<f64>() / samples.len() as f64;
            Some((evidence.loss? / (evidence.effective_samples? * square)).sqrt())
        };
        let open = evidence.iter().zip(self.outputs).filter_map(|(e, wave)| left_open((e, wave)));
        let open = open.reduce(f64::min).map(|open| open.max(LEAST_LOSS));
        let Some(open) = open.filter(|open| loss.share > *open) else { return false };
        let fitted = self.forms.paths.iter().filter(|_| self.forms.is_transfer_function);
        for (output_evidence, paths) in evidence.iter_mut().zip(fitted) {
            add_to_gains(output_evidence, paths, loss.share);
        }
        let dt_s = input.sampled.dt_s();
        // (x²)/3 of the loss at x = pi/n.
        let enough = (PI / (3.0 * open).sqrt()).ceil();
        self.notes.push(LinesLose {
            id: self.id.to_owned(),
            input: input.id.clone(),
            lost: loss.share,
            samples_a_period: loss.cycles_per_sample.recip(),
            frequency_hz: loss.cycles_per_sample / dt_s,
            enough_a_period: enough,
        });
        true
    }

    /// What it answers with, in words.
    fn output(&self) -> String {
        self.outputs.iter().map(WindowedWave::describe).collect::<Vec<_>>().join("; ")
    }

    /// Names of waveforms, separated by commas.
    fn names(&self) -> String {
        self.outputs.iter().map(|wave| wave.id.as_str()).collect::<Vec<_>>().join(", ")
    }

    fn put_forms(&self, out: &mut Output) -> anyhow::Result<()> {
        let Self { id, forms, .. } = self;
        let output = self.output();
        for (name, model, input) in &forms.state_spaces {
            out.put(&format!("/model/{id}/{name}"), &state_space(model, input, &output, self.delay_s))?;
        }
        let single = self.outputs.len() == 1 && self.inputs.len() <= 1;
        for (i, (answer, of_inputs)) in self.outputs.iter().zip(&forms.paths).enumerate() {
            for (j, (numerator, denominator)) in of_inputs.iter().enumerate() {
                let place = if single { String::new() } else { format!("{}-{}/", i + 1, j + 1) };
                let record = TransferFunctionV1 {
                    numerator: numerator.clone(),
                    denominator: denominator.clone(),
                    input: self.inputs.get(j).map_or_else(|| self.input.clone(), WindowedWave::describe),
                    output: answer.describe(),
                    delay_s: self.delay_s,
                };
                out.put(&format!("/model/{id}/{place}transfer-function"), &record)?;
            }
        }
        if !forms.terms.is_empty() {
            out.put(&format!("/model/{id}"), &ExponentialSumV1 { terms: forms.terms.clone(), output })?;
        }
        Ok(())
    }

    /// Runs the bootstrap, if asked for, and writes the responses of a model of one path.
    fn put_responses(&mut self, out: &mut Output) -> anyhow::Result<()> {
        note_limits(self.id, (self.inputs.len(), self.outputs.len()), &mut self.notes);
        // The impulse of a free motion is an input too.
        let single = self.outputs.len() == 1
            && self.forms.state_spaces.first().is_some_and(|(_, model, _)| model.b.ncols() == 1);
        let grid = if single { self.responses.grid_hz() } else { Vec::new() };
        let spreads = self.spreads(&grid);
        let band = spreads.as_ref().map(Band::from_bootstrap).or(self.band.take());
        let response = self.responses.response(&self.input, &self.output(), band.as_ref());
        if let Some(response) = response.filter(|_| single) {
            out.put(&format!("/response/{}", self.id), &response)?;
        }
        Ok(())
    }

    fn spreads(&mut self, grid: &[f64]) -> Option<Bootstrap> {
        self.bootstrap?;
        let signals = |waves: &[WindowedWave]| waves.iter().map(|wave| wave.sampled.samples().to_vec()).collect();
        let dt_s = self.outputs[0].sampled.dt_s();
        let data = IoData::new(signals(self.inputs), signals(self.outputs), dt_s).ok()?.delayed(self.responses.delay);
        let estimate = self.responses.sample(grid);
        let task = IntervalTask {
            id: self.id,
            settings: self.bootstrap,
            data: &data,
            delay: self.responses.delay,
            order: self.order,
            estimate: &estimate,
        };
        let (mut evidence, mut notes) = (std::mem::take(&mut self.evidence), std::mem::take(&mut self.notes));
        let refit = |y: &[Vec<f64>]| (self.refit)(y, grid);
        let spreads = task.intervals(&mut evidence, &mut notes, |noise| self.described(noise, grid), refit);
        (self.evidence, self.notes) = (evidence, notes);
        spreads
    }

    /// The system of a noise model in the terms of this model.
    fn described(&self, noise: &NoiseModel, grid: &[f64]) -> Sample {
        let poles = noise.poles.clone();
        let Some(hold) = self.hold.filter(|_| !grid.is_empty()) else { return Sample { poles, ..Sample::default() } };
        let continuous = to_continuous(&noise.model, hold).ok().map(|result| result.model);
        let continuous = continuous.as_ref().filter(|_| self.responses.continuous.is_some());
        let zeros = continuous.map(zeros_of).unwrap_or_default();
        let ModelResponses { dt_s, samples, delay, .. } = self.responses;
        ModelResponses { continuous, discrete: Some(&noise.model), poles, zeros, dt_s, samples, delay }.sample(grid)
    }

    /// Whether the record moves by what nobody measured: then the free motion from its start says little, and its fit
    /// is no verdict on a model.
    fn is_ambient(&self) -> bool {
        let says_little = |(wave, yh): (&WindowedWave, &Vec<f64>)| {
            let fit = fit_measures(wave.sampled.samples(), yh).and_then(|fit| fit.fit_percent);
            fit.is_none_or(|fit| weak_fit(fit).is_some())
        };
        let of_subspace = self.method.weighting().is_some() && self.inputs.is_empty() && self.outputs.len() > 1;
        of_subspace && self.outputs.iter().zip(&self.simulated.used).any(says_little)
    }

    /// Writes the simulated outputs, those over kept samples with the start fitted to them, at the level of the record:
    /// `/wave/<id>/simulated`, of several outputs with the name of each behind it.
    fn put_waves(&self, out: &mut Output) -> anyhow::Result<()> {
        for (i, (wave, used)) in self.outputs.iter().zip(&self.simulated.used).enumerate() {
            let unseen = self.simulated.unseen().get(i).into_iter().flatten();
            let (level, slope) = wave.removed;
            let all = used.iter().chain(unseen).enumerate();
            let samples: Vec<f64> = all.map(|(k, y)| y + level + slope * k as f64).collect();
            // A model that grows beyond all numbers has no curve.
            if samples.iter().any(|y| !y.is_finite()) {
                continue;
            }
            let place = if self.outputs.len() == 1 { String::new() } else { format!("/{}", wave.id) };
            let sampled = Sampled::new(wave.sampled.t0_s(), wave.sampled.dt_s(), samples)?;
            out.wave(&format!("{}/simulated{place}", self.id), wave.quantity, sampled)?;
        }
        Ok(())
    }

    /// Squares of its errors on the kept samples, by which models are compared.
    fn unseen_squares(&self) -> Vec<f64> {
        let kept: Vec<Vec<f64>> = self.outputs.iter().map(|wave| wave.kept.clone()).collect();
        let unseen = self.simulated.unseen();
        if unseen.len() == kept.len() { unseen_squares(&kept, unseen) } else { Vec::new() }
    }

    /// Fits of the kept samples, run on and with the start fitted.
    fn validate(&mut self) {
        let Self { outputs, simulated, evidence, .. } = self;
        if simulated.used.is_empty() {
            return;
        }
        for (i, (wave, evidence)) in outputs.iter().zip(evidence).enumerate() {
            let fit_of = |all: &[Vec<f64>]| fit_measures(&wave.kept, all.get(i)?).and_then(|fit| fit.fit_percent);
            evidence.validation_from_s = wave.kept_from_s();
            evidence.validation_fit_percent = fit_of(&simulated.run_on);
            evidence.validation_restarted_fit_percent = fit_of(&simulated.restarted);
        }
    }

    /// How it was identified; of several outputs the smallest fit stands for all. Its remarks are still missing.
    fn identification(&self) -> IdentificationV1 {
        let first = &self.outputs[0].sampled;
        let fits: Vec<_> = self
            .outputs
            .iter()
            .zip(&self.simulated.used)
            .map(|(wave, yh)| fit_measures(wave.sampled.samples(), yh))
            .collect();
        let mut percent: Vec<Option<f64>> = fits.iter().map(|fit| fit.and_then(|fit| fit.fit_percent)).collect();
        // A model that is not simulated has no fit.
        percent.resize(self.outputs.len(), None);
        let single = self.outputs.len() == 1;
        let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        IdentificationV1 {
            method: self.method.to_string(),
            order: size(self.order),
            channel: self.names(),
            treated_as: self.treated_as.to_owned(),
            from_s: first.t0_s(),
            to_s: first.end_s(),
            samples: first.len() as u64,
            hankel_rows: self.hankel.0.map(size),
            hankel_columns: self.hankel.1.map(size),
            singular_values: self.singular_values.clone(),
            fit_percent: percent.iter().try_fold(f64::INFINITY, |worst, fit| fit.map(|fit| worst.min(fit))),
            rmse: fits.first().copied().flatten().filter(|_| single).map(|fit| fit.rmse),
            notes: Vec::new(),
            output_fits_percent: if single { Vec::new() } else { percent },
            delay_s: self.delay_s,
            inputs: self.inputs.iter().map(|wave| wave.id.clone()).collect(),
            remarks: Vec::new(),
        }
    }
}

/// Evidence of every output of a simulation of so many parameters; of several inputs the largest correlation counts.
pub fn evidence_of(
    inputs: &[WindowedWave],
    outputs: &[WindowedWave],
    simulated: &[Vec<f64>],
    parameters: usize,
) -> Vec<EvidenceV1> {
    let names = inputs.iter().map(|wave| wave.id.as_str()).collect::<Vec<_>>().join(", ");
    let of_output = |(answer, yh): (&WindowedWave, &Vec<f64>)| {
        let mut evidence = simulation_evidence(inputs.first(), answer, yh, parameters);
        for other in inputs.iter().skip(1) {
            let correlation = simulation_evidence(Some(other), answer, yh, parameters).input_correlation;
            evidence.input_correlation = evidence.input_correlation.zip(correlation).map(|(a, b)| a.max(b));
        }
        evidence.input = (!inputs.is_empty()).then(|| names.clone());
        evidence
    };
    outputs.iter().zip(simulated).map(of_output).collect()
}

/// What the samples of a record are taken for.
pub fn treated_as(record: &Record) -> &'static str {
    if record.inputs.is_empty() { "free-decay" } else { "input-output" }
}

fn state_space(model: &StateSpace, input: &str, output: &str, delay_s: Option<f64>) -> StateSpaceV1 {
    let rows = |matrix: &DMatrix<f64>| matrix.row_iter().map(|row| row.iter().copied().collect()).collect();
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

remarks! {
    /// Remarks of inputs between their samples.
    pub REMARKS;

    /// Straight lines between the samples of an input lose a part of its amplitude.
    CR467 LinesLose {
        id: String, input: String, lost: f64, samples_a_period: f64, frequency_hz: f64, enough_a_period: f64
    }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "Lines lose 1 - (sin x/x)^2 of a smooth input, x = pi f dt. That is more than the record leaves open of a \
             gain, and more than 0.5 %."
    means "Gains are too high by as much. Their deviations hold it; those of poles do not."
    remedy "sample faster, as the sentence says, or correct the gains by the share"
    says format!(
        "{id}: straight lines between the samples of {input} lose {:.1} % of its amplitude ({samples_a_period:.1} \
         samples a period at {} Hz), and gains are too high by as much. Deviations of gains hold it, those of poles do \
         not: sample {enough_a_period:.0} times a period",
        100.0 * lost,
        lines::digits(*frequency_hz)
    );
}
