//! Responses of a model to look at (frequency, impulse, step), and their spread over the fits of a bootstrap.

use std::f64::consts::{PI, TAU};

use crumple_numerics::lti::{
    Complex, StateSpace, discretize_zero_order_hold, free_response, frequency_response, impulse_response,
    step_response, to_transfer_function,
};
use crumple_signal::{About, HALF_OF_90_PERCENT, Notes, Weight, remarks};
use crumple_stage::records::{EvidenceV1, NoIntervalV1, NoSpreadV1, NoiseModelV1, NoiseV1, ResponseV1, SpreadV1};
use crumple_sysid::{
    Bootstrap, BootstrapOptions, IoData, NoSpread, NoiseKind, NoiseModel, NoiseOptions, RecordLength, Sample, Spread,
    bootstrap, noise_model,
};

use crate::stage::options::settings::BootstrapSettings;

/// Points of a frequency response beside those at resonances, and at most so many of a response in time.
const FREQUENCIES: usize = 160;
const TIMES: usize = 400;

/// Orders above this have no zeros worth printing: coefficients of the polynomial have lost their digits.
const ZEROS_UP_TO: usize = 10;

/// Natural frequencies that vary more than this over the replicates do not belong to a mode of the record.
const DROPPED_ABOVE: f64 = 0.02;

/// What the responses of a model are computed from, whatever method gave it.
pub struct ModelResponses<'a> {
    /// Continuous form, if there is one.
    pub continuous: Option<&'a StateSpace>,
    /// Sampled form, if that is what was identified.
    pub discrete: Option<&'a StateSpace>,
    /// Continuous poles in the order of the record of modes.
    pub poles: Vec<Complex>,
    /// Zeros of the continuous form.
    pub zeros: Vec<Complex>,
    /// Sampling interval of the record, s.
    pub dt_s: f64,
    /// Its samples.
    pub samples: usize,
    /// Samples by which the input acts late, which neither form holds.
    pub delay: usize,
}

/// A band around a frequency response: lower and upper modulus and phase change (rad) at every point.
pub struct Band {
    /// Where it comes from.
    pub origin: String,
    /// Points of the grid.
    pub points: Vec<Option<[f64; 4]>>,
}

impl Band {
    /// From relative deviations of the modulus and deviations of the phase.
    pub fn from_deviations(magnitude: &[f64], deviations: &[Option<(f64, f64)>]) -> Self {
        let points = magnitude.iter().zip(deviations).map(|(m, deviation)| {
            let (relative, phase) = (*deviation)?;
            let factor = (HALF_OF_90_PERCENT * relative).exp();
            // A phase known to half a turn is not known.
            let turn = (HALF_OF_90_PERCENT * phase).min(PI);
            let point = [m / factor, m * factor, -turn, turn];
            point.iter().all(|x| x.is_finite()).then_some(point)
        });
        Self { origin: "covariance, 5 to 95 %".to_owned(), points: points.collect() }
    }

    /// From the replicates.
    pub fn from_bootstrap(bootstrap: &Bootstrap) -> Self {
        let points = bootstrap.band.iter().map(|point| {
            let p = (*point)?;
            Some([p.magnitude.0, p.magnitude.1, p.phase_change_rad.0, p.phase_change_rad.1])
        });
        Self {
            origin: format!("bootstrap of {} replicates, 5 to 95 %", bootstrap.replicates),
            points: points.collect(),
        }
    }
}

/// Zeros of a continuous model, as far as its transfer function can be trusted.
pub fn zeros_of(model: &StateSpace) -> Vec<Complex> {
    if model.order() > ZEROS_UP_TO {
        return Vec::new();
    }
    to_transfer_function(model).and_then(|tf| tf.zeros()).unwrap_or_default()
}

impl ModelResponses<'_> {
    /// The model whose frequency response is shown: the continuous one where there is one.
    fn displayed(&self) -> Option<&StateSpace> {
        self.continuous.or(self.discrete)
    }

    /// Frequencies, Hz: from a decade below the slowest mode (at most ten records long) to a decade above the fastest,
    /// at most half the sampling rate.
    pub fn grid_hz(&self) -> Vec<f64> {
        let (duration, nyquist) = (self.samples as f64 * self.dt_s, 0.5 / self.dt_s);
        let moduli: Vec<f64> = self.poles.iter().map(|s| s.norm() / TAU).filter(|f| *f * duration > 0.01).collect();
        let slowest = moduli.iter().copied().fold(f64::INFINITY, f64::min).min(nyquist);
        let fastest = moduli.iter().copied().fold(0.0, f64::max);
        let low = (slowest / 10.0).max(0.1 / duration);
        let high = if fastest > 0.0 { (fastest * 10.0).min(nyquist) } else { nyquist };
        let (low, high) = if low < high { (low, high) } else { (0.1 / duration, nyquist) };
        let even = (0..FREQUENCIES).map(|k| low * (high / low).powf(k as f64 / (FREQUENCIES - 1) as f64));
        // A weakly damped resonance is narrower than the grid: its peak and flanks are looked at too.
        let resonances = self.poles.iter().filter(|s| s.im > 0.0).flat_map(|s| {
            let width = s.re.abs() / TAU;
            [-3.0, -1.0, -0.3, 0.0, 0.3, 1.0, 3.0].map(|k| s.im / TAU + k * width)
        });
        let mut grid: Vec<f64> = even.chain(resonances.filter(|f| (low..=high).contains(f))).collect();
        grid.sort_by(f64::total_cmp);
        grid.dedup();
        grid
    }

    /// What a replicate is compared by; the delay, the same for all, is left out.
    pub fn sample(&self, grid_hz: &[f64]) -> Sample {
        let rad_per_s: Vec<f64> = grid_hz.iter().map(|f| TAU * f).collect();
        let response =
            self.displayed().and_then(|model| frequency_response(model, &rad_per_s).ok()).unwrap_or_default();
        Sample { poles: self.poles.clone(), zeros: self.zeros.clone(), response }
    }

    /// The record of responses; `None` for a model without an input, or one that is not finite where it should be
    /// drawn.
    pub fn response(&self, input: &str, output: &str, band: Option<&Band>) -> Option<ResponseV1> {
        let grid = self.grid_hz();
        let values = self.sample(&grid).response;
        if values.is_empty() || values.iter().any(|h| !(h.norm().is_finite() && h.norm() > 0.0)) {
            return None;
        }
        let mut phase_rad = Vec::with_capacity(values.len());
        let mut last = 0.0;
        for h in &values {
            let phase = h.arg();
            last = phase - TAU * ((phase - last) / TAU).round();
            phase_rad.push(last);
        }
        // A delay turns the phase in proportion to the frequency; unwrapped without it, no step exceeds half a turn.
        let delay_s = self.delay as f64 * self.dt_s;
        phase_rad.iter_mut().zip(&grid).for_each(|(phase, hz)| *phase -= TAU * hz * delay_s);
        let edge = |k: usize| -> Vec<Option<f64>> {
            let points = band.map(|band| &band.points[..]).unwrap_or_default();
            let moved =
                |(at, point): (usize, &Option<[f64; 4]>)| Some((*point)?[k] + if k > 1 { phase_rad[at] } else { 0.0 });
            points.iter().enumerate().map(moved).collect()
        };
        let (magnitude_lower, magnitude_upper) = (edge(0), edge(1));
        let (phase_lower_rad, phase_upper_rad) = (edge(2), edge(3));
        let (time_s, impulse, step) = self.time_responses()?;
        Some(ResponseV1 {
            input: input.to_owned(),
            output: output.to_owned(),
            model: if self.continuous.is_some() { "continuous" } else { "discrete" }.to_owned(),
            magnitude: values.iter().map(|h| h.norm()).collect(),
            frequency_hz: grid,
            band: band.map(|band| band.origin.clone()),
            magnitude_lower,
            magnitude_upper,
            phase_lower_rad,
            phase_upper_rad,
            phase_rad,
            impulse_of: if self.discrete.is_some() { "unit sample" } else { "unit impulse" }.to_owned(),
            time_s,
            impulse,
            step,
            zeros_re_per_s: self.zeros.iter().map(|z| z.re).collect(),
            zeros_im_rad_per_s: self.zeros.iter().map(|z| z.im).collect(),
        })
    }

    /// Every so many samples of a response that begins after the delay.
    fn delayed(&self, response: Vec<f64>, stride: usize) -> Vec<f64> {
        let silence = std::iter::repeat_n(0.0, self.delay.min(response.len()));
        silence.chain(response).take(self.samples).step_by(stride).collect()
    }

    /// Times, impulse and step response, every so many samples, late by the delay.
    fn time_responses(&self) -> Option<(Vec<f64>, Vec<f64>, Vec<f64>)> {
        let stride = self.samples.div_ceil(TIMES).max(1);
        let (impulse, step): (Vec<f64>, Vec<f64>) = if let Some(model) = self.discrete {
            (
                self.delayed(impulse_response(model, self.samples).ok()?, stride),
                self.delayed(step_response(model, self.samples).ok()?, stride),
            )
        } else if self.delay > 0 {
            // A late step falls between thinned times: all samples are computed first.
            let model = self.continuous?;
            let held = discretize_zero_order_hold(model, self.dt_s).ok()?;
            let start = model.b.column(0).into_owned();
            (
                self.delayed(free_response(&held, &start, self.samples).ok()?, stride),
                self.delayed(step_response(&held, self.samples).ok()?, stride),
            )
        } else {
            // At the thinned times a held model is exact: its step is a step, its impulse a state.
            let model = self.continuous?;
            let held = discretize_zero_order_hold(model, self.dt_s * stride as f64).ok()?;
            let count = self.samples.div_ceil(stride);
            let start = model.b.column(0).into_owned();
            (free_response(&held, &start, count).ok()?, step_response(&held, count).ok()?)
        };
        // A growing model may leave the range of numbers: it is shown as far as it stays.
        let end = impulse.iter().zip(&step).position(|(a, b)| !(a.is_finite() && b.is_finite())).unwrap_or(step.len());
        let time_s = (0..end).map(|k| (k * stride) as f64 * self.dt_s).collect();
        Some((time_s, impulse[..end].to_vec(), step[..end].to_vec()))
    }
}

/// Notes what is not written for a model of several inputs or outputs.
pub fn note_limits(id: &str, (inputs, outputs): (usize, usize), notes: &mut Notes) {
    if inputs > 1 || outputs > 1 {
        notes.push(SinglePathOnly { id: id.to_owned() });
    }
}

/// Orders and samples up to which a noise model is looked for from all starts, not from the model at hand alone.
const ALL_STARTS: (usize, usize) = (8, 5000);

/// A model whose intervals are asked for, whatever method gave it.
pub struct IntervalTask<'a> {
    /// Id of the model.
    pub id: &'a str,
    /// Bootstrap, if asked for.
    pub settings: Option<&'a BootstrapSettings>,
    /// The record, inputs delayed.
    pub data: &'a IoData,
    /// Samples by which they are.
    pub delay: usize,
    /// States of the noise model.
    pub order: usize,
    /// What the method made of the record.
    pub estimate: &'a Sample,
}

impl IntervalTask<'_> {
    /// The noise of the record after its delay: before, nobody knows what drives it.
    fn noise(&self) -> Option<NoiseModel> {
        let data = self.data.slice(self.delay, self.data.samples()).ok()?;
        let near = [self.estimate.poles.iter().map(|s| (s * data.sample_time_s()).exp()).collect()];
        let near_alone = self.order > ALL_STARTS.0 || data.samples() > ALL_STARTS.1;
        noise_model(&data, NoiseOptions { near: &near, near_alone, ..NoiseOptions::new(self.order) }).ok()
    }

    /// Runs the method again on records with new noise and puts noise and intervals into the evidence of every output;
    /// `described` tells of the system of the noise model what `refit` tells of a model. `None` without a bootstrap, or
    /// with the reason in evidence and notes.
    pub fn intervals(
        &self,
        evidence: &mut [EvidenceV1],
        notes: &mut Notes,
        described: impl FnOnce(&NoiseModel) -> Sample,
        refit: impl Fn(&[Vec<f64>]) -> Option<Sample> + Sync,
    ) -> Option<Bootstrap> {
        let settings = self.settings?;
        let Some(noise) = self.noise() else {
            evidence.iter_mut().for_each(|e| e.no_interval = Some(NoIntervalV1::NoNoiseModel));
            notes.push(NoIntervals { states: Some(self.order), ..NoIntervals::of(self.id) });
            return None;
        };
        put_noise(&noise, evidence);
        if !noise.is_white() {
            evidence.iter_mut().for_each(|e| e.no_interval = Some(NoIntervalV1::NotWhite));
            notes.push(not_white(self.id, &noise));
            return None;
        }
        let measured: Vec<&[f64]> = self.data.outputs().iter().map(|y| &y[..self.delay]).collect();
        let whole = |drawn: &[Vec<f64>]| -> Vec<Vec<f64>> {
            measured.iter().zip(drawn).map(|(first, rest)| [*first, rest].concat()).collect()
        };
        let options = BootstrapOptions { replicates: settings.replicates, seed: settings.seed.into() };
        let duration_s = self.data.samples() as f64 * self.data.sample_time_s();
        let both = (self.estimate, &described(&noise));
        let is_free = self.data.inputs().is_empty();
        let length = if is_free { RecordLength::Free(duration_s) } else { RecordLength::Driven(duration_s) };
        let drawn = bootstrap(both, &noise, length, options, |y| refit(&whole(y)));
        let Some(drawn) = drawn else {
            evidence.iter_mut().for_each(|e| e.no_interval = Some(NoIntervalV1::FewReplicates));
            notes.push(NoIntervals::of(self.id));
            return None;
        };
        note_scatter(self.id, self.estimate, &drawn, notes);
        let by = in_words(&noise);
        evidence.iter_mut().for_each(|output_evidence| put_spreads(&drawn, &by, output_evidence));
        Some(drawn)
    }
}

/// Why errors that are not white give no intervals.
fn not_white(id: &str, noise: &NoiseModel) -> NoIntervals {
    let worst = noise.whiteness.iter().max_by(|a, b| (a.ljung_box / a.limit_95).total_cmp(&(b.ljung_box / b.limit_95)));
    let (found, allowed) = worst.map_or((0.0, 0.0), |worst| (worst.ljung_box, worst.limit_95));
    NoIntervals { ljung_box: Some(found), limit: Some(allowed), ..NoIntervals::of(id) }
}

impl NoIntervals {
    /// Of a model, without a reason but the bootstrap itself.
    fn of(id: &str) -> Self {
        Self { id: id.to_owned(), states: None, ljung_box: None, limit: None }
    }
}

/// The noise model as `bootstrap_noise` states it.
fn in_words(noise: &NoiseModel) -> String {
    let most = noise.autoregressions.iter().map(|filter| filter.len() - 1).max();
    match (noise.kind, most) {
        (NoiseKind::Arx, _) => "innovations through the poles of the system".to_owned(),
        (NoiseKind::OutputError, Some(order)) if order > 0 => {
            format!("innovations through an autoregression of order {order}")
        }
        (NoiseKind::OutputError, _) => "innovations, white".to_owned(),
    }
}

/// Puts the noise of every output into its evidence; of several that have one evidence the least white.
fn put_noise(noise: &NoiseModel, evidence: &mut [EvidenceV1]) {
    let record = |output: usize| NoiseV1 {
        model: match noise.kind {
            NoiseKind::OutputError => NoiseModelV1::OutputError,
            NoiseKind::Arx => NoiseModelV1::Arx,
        },
        ar_order: noise.autoregressions.get(output).map_or(0, |filter| u32::try_from(filter.len() - 1).unwrap_or(0)),
        ljung_box: noise.whiteness[output].ljung_box,
        white_limit: noise.whiteness[output].limit_95,
        is_white: noise.whiteness[output].is_white,
    };
    let outputs = noise.whiteness.len();
    if evidence.len() == outputs {
        evidence.iter_mut().enumerate().for_each(|(output, e)| e.noise = Some(record(output)));
        return;
    }
    let least = (0..outputs).max_by(|a, b| noise.whiteness[*a].ljung_box.total_cmp(&noise.whiteness[*b].ljung_box));
    evidence.iter_mut().for_each(|e| e.noise = least.map(record));
}

/// Notes on poles that scatter over the replicates, or are missing from most of them.
fn note_scatter(id: &str, sample: &Sample, bootstrap: &Bootstrap, notes: &mut Notes) {
    for (s, spread) in sample.poles.iter().zip(&bootstrap.modes).filter(|(s, _)| s.im >= 0.0 && s.norm() > 0.0) {
        match spread {
            Err(NoSpread::NotFoundAgain) => {
                notes.push(NotFoundAgain { id: id.to_owned(), re_per_s: s.re, im_rad_per_s: s.im });
            }
            Ok((frequency, _)) if frequency.deviation > DROPPED_ABOVE * s.norm() => notes.push(FrequencyScatters {
                id: id.to_owned(),
                frequency_hz: s.norm() / TAU,
                scatter_percent: 100.0 * frequency.deviation / s.norm(),
                replicates: bootstrap.replicates,
            }),
            Ok((frequency, _)) if frequency.is_biased() => notes.push(BiasedFrequency {
                id: id.to_owned(),
                bias_hz: frequency.bias / TAU,
                frequency_hz: s.norm() / TAU,
            }),
            _ => {}
        }
    }
}

/// Puts the spreads into the evidence.
fn put_spreads(bootstrap: &Bootstrap, noise: &str, output_evidence: &mut EvidenceV1) {
    let record = |s: &Spread| SpreadV1 { deviation: s.deviation, lower: s.lower, upper: s.upper, bias: Some(s.bias) };
    let all = |spreads: &[Option<Spread>]| spreads.iter().map(|s| s.as_ref().map(record)).collect::<Vec<_>>();
    let modes = &bootstrap.modes;
    output_evidence.bootstrap_replicates = u32::try_from(bootstrap.replicates).ok();
    output_evidence.bootstrap_failed = u32::try_from(bootstrap.failed).ok();
    output_evidence.bootstrap_noise = Some(noise.to_owned());
    output_evidence.frequency_spreads = modes.iter().map(|mode| mode.as_ref().ok().map(|(f, _)| record(f))).collect();
    output_evidence.damping_spreads = modes.iter().map(|mode| mode.as_ref().ok().map(|(_, d)| record(d))).collect();
    output_evidence.no_spreads = modes.iter().map(|mode| mode.as_ref().err().map(|why| why_none(*why))).collect();
    output_evidence.zero_re_spreads = all(&bootstrap.zero_re);
    output_evidence.zero_im_spreads = all(&bootstrap.zero_im);
}

fn why_none(why: NoSpread) -> NoSpreadV1 {
    match why {
        NoSpread::NotFoundAgain => NoSpreadV1::NotFoundAgain,
        NoSpread::NotDetermined => NoSpreadV1::NotDetermined,
        NoSpread::ShortRecord => NoSpreadV1::ShortRecord,
    }
}

remarks! {
    /// Remarks of responses and intervals.
    pub REMARKS;

    /// Responses are not written for several inputs or outputs.
    CR469 SinglePathOnly { id: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The record /response holds one frequency, impulse and step response."
    means "The model is complete. Its responses follow from its matrices."
    remedy "nothing; one of --inputs and one of --outputs give a response"
    says format!("{id}: responses are written for models of one input and one output only");

    /// Intervals were asked for, and there are none.
    CR470 NoIntervals { id: String, states: Option<usize>, ljung_box: Option<f64>, limit: Option<f64> }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "A bootstrap needs a noise model, white prediction errors, and a model from half of its fits. Errors count \
             as white up to twice the 95 % point of the statistic of Ljung & Box over 25 lags (Biometrika 65, 1978). Q \
             is that statistic, and the number allowed its 95 % point."
    means "Frequencies and damping ratios have no interval. Intervals from correlated errors would be too narrow."
    remedy "try more states: --orders, --remove-trend, or a window without outliers; a longer one: --from, --to"
    says match (states, ljung_box.zip(*limit)) {
        (Some(states), _) => format!("{id}: no intervals: no noise model of {states} states was found"),
        (None, Some((found, allowed))) => format!(
            "{id}: the prediction errors are correlated (Q = {found:.0}, {allowed:.0} allowed): neither noise model \
             explains them; intervals would be too narrow and are left out. Usual reasons: too few states, a trend, an \
             outlier, a nonlinearity"
        ),
        (None, None) => format!("{id}: fewer than half of the bootstrap fits led to a model: no spread"),
    };

    /// Fits to records with new noise do not have this pole.
    CR471 NotFoundAgain { id: String, re_per_s: f64, im_rad_per_s: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The noise model has no pole that stands for it, or fewer than half of the bootstrap fits find that pole \
             again."
    means "The pole may be a product of the noise. It has no interval."
    remedy "do not use this pole, or try a lower order: --orders"
    says format!("{id}: the pole {re_per_s:.4} {im_rad_per_s:+.4}i 1/s is not found again in most replicates");

    /// A natural frequency varies much over records with new noise.
    CR472 FrequencyScatters { id: String, frequency_hz: f64, scatter_percent: f64, replicates: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Its standard deviation over the bootstrap fits is above 2 % of the frequency."
    means "Noise or another record of the same system gives another frequency. Do not count it among the modes."
    remedy "nothing; a longer record, or more sensors, settle it"
    says format!(
        "{id}: the natural frequency {frequency_hz:.4} Hz varies by {scatter_percent:.1} % over {replicates} \
         replicates: above 2 % a pole is not counted as a mode of the record"
    );

    /// The method finds this frequency too high or too low in noise like that of the record.
    CR473 BiasedFrequency { id: String, bias_hz: f64, frequency_hz: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The mean of the bootstrap fits is off the frequency that they were drawn from by more than their standard \
             deviation."
    means "The interval holds the bias: 1.645 sqrt(deviation^2 + bias^2) on either side of the estimate."
    remedy "nothing; quote the interval"
    says format!(
        "{id}: estimates of this method are off by {bias_hz:.4} Hz in noise like this at {frequency_hz:.4} Hz; the \
         interval has it"
    );
}
