//! Evidence common to the methods beside `era`, and poles, as records.

use std::f64::consts::TAU;

use crumple_numerics::lti::{Complex, Mode};
use crumple_signal::{Note, Notes, QuantityKind, Value};
use crumple_stage::records::{
    EvidenceV1, IdentificationV1, ModeKindV1, ModeV1, ModesV2, OtherPoleKindV1, OtherPoleV1, SpreadV1,
};
use crumple_sysid::{
    InformationCriteria, PoleKind, PoleRecord, ResidualTests, SearchOutcome, autoregressive_effective_samples,
    fit_measures, pole_kinds, pole_notes, residual_tests,
};
use nalgebra::DMatrix;

use crate::stage::options::choices::{Hold, Paper};
use crate::stage::records::lines::AMBIENT;
use crate::stage::waves::{WindowedWave, filter_edges};

/// A pole this near to the frequency of a machine that runs, relative, is its line.
const NEAR_A_LINE: f64 = 0.01;

/// All poles of a model that was identified from a record, one entry each, and what each is.
pub struct Poles {
    entries: Vec<ModeV1>,
    kinds: Vec<PoleKind>,
    /// Frequency, rad/s, and damping ratio that an exponential window added to each.
    of_window: Vec<(f64, f64)>,
    /// Decay rate of that window, 1/s.
    window_per_s: f64,
}

impl Poles {
    /// Of entries with whatever the method knows of each.
    pub fn new(mut entries: Vec<ModeV1>, record: PoleRecord) -> Self {
        let of_window = entries.iter_mut().map(|entry| without_window(entry, record.window_per_s)).collect();
        let poles: Vec<Complex> = entries.iter().map(|pole| Complex::new(pole.re_per_s, pole.im_rad_per_s)).collect();
        let kinds = pole_kinds(&poles, record);
        for (entry, kind) in entries.iter_mut().zip(&kinds) {
            entry.kind = match kind {
                PoleKind::Growing => Some(ModeKindV1::Growing),
                PoleKind::Real => Some(ModeKindV1::Real),
                PoleKind::Mode => Some(ModeKindV1::Mode),
                PoleKind::Integrator | PoleKind::BeyondNyquist | PoleKind::Cancelled | PoleKind::Harmonic => None,
            };
        }
        Self { entries, kinds, of_window, window_per_s: record.window_per_s }
    }

    /// Of continuous poles, with their discrete counterparts where the model is sampled.
    pub fn of(poles: impl Iterator<Item = (Mode, Option<Complex>)>, record: PoleRecord) -> Self {
        Self::new(poles.map(|(mode, discrete)| entry(&mode, discrete)).collect(), record)
    }

    /// Makes the oscillation nearest to each frequency (rad/s) of a machine that runs a harmonic line, up to 1 % away.
    pub fn with_harmonics(mut self, harmonics_rad_per_s: &[f64]) -> Self {
        let mut upper: Vec<usize> = (0..self.entries.len()).filter(|k| self.entries[*k].im_rad_per_s > 0.0).collect();
        for harmonic in harmonics_rad_per_s {
            let away = |k: usize| (self.entries[k].natural_frequency_rad_per_s / harmonic - 1.0).abs();
            let nearest = upper.iter().copied().min_by(|a, b| away(*a).total_cmp(&away(*b)));
            let Some(place) = nearest.filter(|place| away(*place) < NEAR_A_LINE) else { continue };
            upper.retain(|k| *k != place);
            self.take_out(place, PoleKind::Harmonic);
        }
        self
    }

    /// The continuous poles but those that a machine or a zero makes.
    pub fn of_the_system(&self) -> Vec<Complex> {
        let is_own = |kind: &PoleKind| !matches!(kind, PoleKind::Cancelled | PoleKind::Harmonic);
        let own = self.entries.iter().zip(&self.kinds).filter(|(_, kind)| is_own(kind));
        own.map(|(pole, _)| Complex::new(pole.re_per_s - self.window_per_s, pole.im_rad_per_s)).collect()
    }

    /// The natural frequency of a pole, Hz.
    pub fn natural_hz(&self, place: usize) -> f64 {
        self.entries[place].natural_frequency_rad_per_s / TAU
    }

    /// Makes a pole and its conjugate something that is no mode.
    pub fn take_out(&mut self, place: usize, kind: PoleKind) {
        let ModeV1 { re_per_s: re, im_rad_per_s: im, .. } = self.entries[place];
        for (entry, known) in self.entries.iter_mut().zip(&mut self.kinds) {
            if entry.re_per_s == re && entry.im_rad_per_s.abs() == im.abs() {
                (*known, entry.kind) = (kind, None);
            }
        }
    }

    /// Whether each is a mode, in their order.
    pub fn are_modes(&self) -> impl Iterator<Item = bool> {
        self.kinds.iter().map(|kind| kind.is_motion())
    }

    /// The modes alone.
    pub fn modes(&self) -> impl Iterator<Item = &ModeV1> {
        self.entries.iter().zip(self.are_modes()).filter_map(|(entry, is_mode)| is_mode.then_some(entry))
    }

    /// The record of them.
    pub fn record(&self) -> ModesV2 {
        let others = self.entries.iter().zip(&self.kinds).filter_map(|(pole, kind)| {
            let kind = match kind {
                PoleKind::Mode | PoleKind::Real | PoleKind::Growing => return None,
                PoleKind::Integrator => OtherPoleKindV1::Integrator,
                PoleKind::BeyondNyquist => OtherPoleKindV1::BeyondNyquist,
                PoleKind::Cancelled => OtherPoleKindV1::Cancelled,
                PoleKind::Harmonic => OtherPoleKindV1::Harmonic,
            };
            let ModeV1 { re_per_s, im_rad_per_s, discrete_re, discrete_im, .. } = *pole;
            Some(OtherPoleV1 { re_per_s, im_rad_per_s, discrete_re, discrete_im, kind })
        });
        ModesV2 { modes: self.modes().cloned().collect(), other_poles: others.collect() }
    }

    /// Leaves deviations and spreads of the modes alone where the evidence has one of every pole.
    pub fn keep_those_of_modes(&self, evidence: &mut [EvidenceV1]) {
        for EvidenceV1 {
            frequency_deviations,
            damping_deviations,
            frequency_spreads,
            damping_spreads,
            no_spreads,
            ..
        } in evidence
        {
            self.keep(no_spreads);
            self.keep(frequency_deviations);
            self.keep(damping_deviations);
            self.keep(frequency_spreads);
            self.keep(damping_spreads);
        }
    }

    /// Takes what an exponential window added off the intervals of the modes, as off the modes.
    pub fn take_window_off(&self, evidence: &mut [EvidenceV1]) {
        let of_modes = || self.of_window.iter().zip(self.are_modes()).filter_map(|(added, is)| is.then_some(added));
        let less = |spreads: &mut [Option<SpreadV1>], of: fn(&(f64, f64)) -> f64| {
            for (spread, added) in spreads.iter_mut().zip(of_modes()) {
                if let Some(spread) = spread {
                    spread.lower -= of(added);
                    spread.upper -= of(added);
                }
            }
        };
        for EvidenceV1 { frequency_spreads, damping_spreads, .. } in evidence {
            less(frequency_spreads, |added| added.0);
            less(damping_spreads, |added| added.1);
        }
    }

    fn keep<T>(&self, of_poles: &mut Vec<T>) {
        if of_poles.len() == self.kinds.len() {
            let mut are_modes = self.are_modes();
            of_poles.retain(|_| are_modes.next().unwrap_or(true));
        }
    }
}

/// Moves a pole back by the decay rate of an exponential window, `s + 1/τ`: the response `e^(st)` was recorded as
/// `e^(st) e^(-t/τ)`. Returns what the window had added to frequency, rad/s, and damping ratio.
fn without_window(entry: &mut ModeV1, window_per_s: f64) -> (f64, f64) {
    if window_per_s == 0.0 {
        return (0.0, 0.0);
    }
    let measured = (entry.natural_frequency_rad_per_s, entry.damping_ratio);
    let mode = Mode::continuous(Complex::new(entry.re_per_s + window_per_s, entry.im_rad_per_s));
    entry.re_per_s = mode.pole.re;
    entry.natural_frequency_rad_per_s = mode.natural_frequency_rad_per_s;
    entry.damping_ratio = mode.damping_ratio;
    let damping = measured.1.zip(mode.damping_ratio).map_or(0.0, |(with, without)| with - without);
    (measured.0 - mode.natural_frequency_rad_per_s, damping)
}

/// The entry of a pole of which no more is known.
pub fn entry(mode: &Mode, discrete: Option<Complex>) -> ModeV1 {
    ModeV1 {
        // Adding zero takes the sign from a zero.
        re_per_s: mode.pole.re + 0.0,
        im_rad_per_s: mode.pole.im + 0.0,
        natural_frequency_rad_per_s: mode.natural_frequency_rad_per_s,
        damping_ratio: mode.damping_ratio,
        modal_amplitude_coherence: None,
        mode_singular_value: None,
        discrete_re: discrete.map(|z| z.re),
        discrete_im: discrete.map(|z| z.im),
        kind: None,
    }
}

/// Lags of the whiteness test.
const LAGS: usize = 20;

/// Evidence from the simulated output: criteria, residual tests; everything else is still unknown.
pub fn simulation_evidence(
    input: Option<&WindowedWave>,
    output: &WindowedWave,
    simulated: &[f64],
    parameters: usize,
) -> EvidenceV1 {
    let residual: Vec<f64> = output.sampled.samples().iter().zip(simulated).map(|(y, yh)| y - yh).collect();
    let finite = |x: f64| x.is_finite().then_some(x);
    let loss = finite(residual.iter().map(|e| e * e).sum::<f64>() / residual.len().max(1) as f64);
    let effective = autoregressive_effective_samples(&residual);
    let criteria = loss.map(|loss| InformationCriteria::new(loss, effective, parameters));
    let tests = residual_tests(&residual, input.map(|wave| wave.sampled.samples()), LAGS);
    EvidenceV1 {
        input: input.map(|wave| wave.id.clone()),
        output: output.id.clone(),
        hold: None,
        initial_conditions: "estimated".to_owned(),
        start: None,
        stop_reason: None,
        iterations: None,
        evaluations: None,
        losses: Vec::new(),
        loss,
        prediction_fit_percent: None,
        parameters: parameters as u64,
        effective_samples: finite(effective),
        aicc: criteria.and_then(|c| finite(c.aicc)),
        bic: criteria.and_then(|c| finite(c.bic)),
        final_prediction_error: criteria.and_then(|c| finite(c.fpe)),
        residual_lag_one: tests.map(|t| t.lag_one),
        whiteness: tests.map(|t| t.whiteness),
        whiteness_limit: tests.map(|t| t.whiteness_limit),
        input_correlation: tests.and_then(|t| t.input_correlation),
        condition: None,
        numerator_deviations: Vec::new(),
        denominator_deviations: Vec::new(),
        frequency_deviations: Vec::new(),
        damping_deviations: Vec::new(),
        zeros_re_per_s: Vec::new(),
        zeros_im_rad_per_s: Vec::new(),
        singular_value_errors: Vec::new(),
        zero_re_deviations: Vec::new(),
        zero_im_deviations: Vec::new(),
        bootstrap_replicates: None,
        bootstrap_failed: None,
        bootstrap_noise: None,
        frequency_spreads: Vec::new(),
        damping_spreads: Vec::new(),
        zero_re_spreads: Vec::new(),
        zero_im_spreads: Vec::new(),
        validation_fit_percent: None,
        validation_from_s: None,
        paper: None,
        validation_restarted_fit_percent: None,
        aic: criteria.and_then(|c| finite(c.aic)),
        minimum_description_length: criteria.and_then(|c| finite(c.mdl)),
        vaf_percent: fit_measures(output.sampled.samples(), simulated).and_then(|fit| fit.vaf_percent),
        no_deviations: None,
        parameter_names: Vec::new(),
        parameter_values: Vec::new(),
        parameter_deviations: Vec::new(),
        parameter_correlations: Vec::new(),
        denominator_covariance: Vec::new(),
        holds_on_unseen: None,
        simulation_whiteness: tests.map(|t| t.whiteness),
        noise: None,
        no_interval: None,
        no_spreads: Vec::new(),
    }
}

/// Tests of one-step prediction errors from sample `from` on, against every input: the largest correlation counts.
pub fn prediction_tests(inputs: &[Vec<f64>], errors: &[f64], from: usize) -> Option<ResidualTests> {
    let errors = errors.get(from..)?;
    let mut tests = residual_tests(errors, None, LAGS)?;
    tests.input_correlation =
        inputs.iter().filter_map(|u| residual_tests(errors, u.get(from..), LAGS)?.input_correlation).reduce(f64::max);
    Some(tests)
}

/// A remark of a model, or of a method: its id before the sentence, and among the values.
pub fn of_model(id: &str, remark: impl Into<Note>) -> Note {
    let mut note = remark.into().within(&format!("{id}: "), "");
    note.values.insert(0, ("id", Value::Text(id.to_owned())));
    note
}

/// Notes on single poles of a model between waveforms: which are no modes, growth, sampling, and the edge of the filter
/// they went through.
pub fn notes_on_poles(id: &str, poles: &[Complex], waves: &[&WindowedWave]) -> Notes {
    pole_notes(id, poles, pole_record(waves), filter_edges(waves.iter().copied()))
}

/// What tells the poles of a model between waveforms apart; the answering ones first.
pub fn pole_record(waves: &[&WindowedWave]) -> PoleRecord {
    let (dt_s, samples) = waves.first().map_or((0.0, 0), |wave| (wave.sampled.dt_s(), wave.sampled.len()));
    let quantities: Vec<QuantityKind> = waves.iter().map(|wave| wave.quantity).collect();
    let of_motion = quantities == [QuantityKind::Displacement, QuantityKind::Acceleration];
    let window_per_s = waves.first().map_or(0.0, |wave| wave.window_per_s);
    PoleRecord { dt_s, duration_s: dt_s * samples as f64, of_motion, window_per_s }
}

/// Takes the figures of a simulation out, which are no verdict on a record that nobody knows the input of.
pub fn without_simulation(whole: &mut IdentificationV1, evidence: &mut [EvidenceV1]) {
    whole.treated_as = AMBIENT.to_owned();
    (whole.fit_percent, whole.rmse) = (None, None);
    whole.output_fits_percent.iter_mut().for_each(|fit| *fit = None);
    evidence.iter_mut().for_each(clear_simulation);
}

/// Takes the figures of a simulation out of the evidence of one output.
pub fn clear_simulation(evidence: &mut EvidenceV1) {
    (evidence.loss, evidence.vaf_percent, evidence.final_prediction_error) = (None, None, None);
    (evidence.aic, evidence.aicc, evidence.bic) = (None, None, None);
    (evidence.minimum_description_length, evidence.simulation_whiteness) = (None, None);
    (evidence.whiteness, evidence.residual_lag_one) = (None, None);
}

/// Puts a search into the evidence of one output: `hold` as declared, `paper` whose procedure it is.
pub fn put_search(search: &SearchOutcome, hold: Hold, paper: Option<Paper>, output_evidence: &mut EvidenceV1) {
    output_evidence.hold = Some(hold.to_string());
    output_evidence.initial_conditions = if search.initial_estimated { "estimated" } else { "zero" }.to_owned();
    output_evidence.start = Some(search.start.name().to_owned());
    output_evidence.stop_reason = Some(search.stop_reason.name_with_bounds(search.on_bound).to_owned());
    output_evidence.iterations = Some(search.iterations);
    output_evidence.evaluations = Some(search.evaluations);
    output_evidence.losses = search.losses.clone();
    output_evidence.condition = Some(search.condition).filter(|c| c.is_finite());
    output_evidence.denominator_deviations = if_determined(&search.denominator_deviations);
    output_evidence.frequency_deviations = search.mode_deviations.iter().map(|d| d.map(|d| d.0)).collect();
    output_evidence.damping_deviations = search.mode_deviations.iter().map(|d| d.map(|d| d.1)).collect();
    output_evidence.paper = paper.map(|paper| paper.to_string());
}

/// Numbers up to which all correlations are written.
const MOST_CORRELATED: usize = 60;

/// Numbers of a model that are known with their correlations.
#[derive(Clone)]
pub struct NamedNumbers {
    /// Their names, a unit at the end where they have one.
    pub names: Vec<String>,
    /// Their values.
    pub values: Vec<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

impl NamedNumbers {
    /// Puts names, values, standard deviations and correlations into the evidence of an output.
    pub fn put(self, evidence: &mut EvidenceV1) {
        let Self { names, values, covariance } = self;
        let deviations: Vec<f64> = covariance.diagonal().iter().map(|x| x.max(0.0).sqrt()).collect();
        let correlation = |i: usize, k: usize| match deviations[i] * deviations[k] {
            _ if i == k => 1.0,
            // What does not vary varies with nothing.
            0.0 => 0.0,
            product => (covariance[(i, k)] / product).clamp(-1.0, 1.0),
        };
        let count = if values.len() > MOST_CORRELATED { 0 } else { values.len() };
        evidence.parameter_correlations = (0..count).map(|i| (0..count).map(|k| correlation(i, k)).collect()).collect();
        (evidence.parameter_names, evidence.parameter_values) = (names, values);
        evidence.parameter_deviations = deviations;
    }
}

/// Adds a relative error that all gains of a transfer function share to the deviations of its numerators, and of the
/// mass, damping and stiffness that follow from them.
pub fn add_to_gains(evidence: &mut EvidenceV1, paths: &[(Vec<f64>, Vec<f64>)], share: f64) {
    let each = (evidence.numerator_deviations.len() / paths.len().max(1)).max(1);
    for (deviations, (numerator, _)) in evidence.numerator_deviations.chunks_exact_mut(each).zip(paths) {
        // The deviations belong to the last coefficients.
        let shown = deviations.iter_mut().rev().zip(numerator.iter().rev());
        shown.for_each(|(deviation, b)| *deviation = deviation.hypot(share * b));
    }
    let EvidenceV1 { parameter_values: values, parameter_deviations: deviations, .. } = evidence;
    let before = deviations.clone();
    deviations.iter_mut().zip(&*values).for_each(|(deviation, value)| *deviation = deviation.hypot(share * value));
    for (i, row) in evidence.parameter_correlations.iter_mut().enumerate() {
        for (k, correlation) in row.iter_mut().enumerate() {
            let covariance = *correlation * before[i] * before[k] + share * share * values[i] * values[k];
            *correlation = (covariance / (deviations[i] * deviations[k])).clamp(-1.0, 1.0);
        }
    }
}

/// Deviations, or none where they are not determined.
pub fn if_determined(deviations: &[f64]) -> Vec<f64> {
    if deviations.iter().all(|x| x.is_finite()) { deviations.to_vec() } else { Vec::new() }
}
