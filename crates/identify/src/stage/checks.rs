//! What the waveforms of a run show by themselves: constant channels, the delay, trends, outliers, and the modes of a
//! record that nobody knows the input of.

use std::f64::consts::TAU;

use crumple_signal::{About, Note, Weight, remarks};
use crumple_stage::records::{
    FoundDelayV1, NoiseModelV1, OutliersV1, RecordChecksV1, StabilizationClusterV1, StabilizationPoleV1,
    StabilizationV1, TrendV1,
};
use crumple_stage::{Output, Refused};
use crumple_sysid::{
    AmbientModes, AmbientOptions, Constants, HarmonicLine, IdentifyError, IoData, NoiseKind, Order, Stability,
    StabilizationOptions, Trend, ambient_modes, delay_scan, is_staircase, outliers, trend,
};
use rayon::prelude::*;

use crate::stage::options::choices::Hold;
use crate::stage::options::settings::{InputOutputSettings, Settings};
use crate::stage::waves::{Source, WindowedWave, behind_blank, flag, record, waves, widen_the_window};

/// Samples that the delay is looked for in, and trends and outliers, from the first on.
const SAMPLES_OF_DELAY: usize = 4000;
const SAMPLES_OF_CHECKS: usize = 20_000;

/// Poles that the delay is looked for with, and trends and outliers, at most.
const ORDER_OF_DELAY: usize = 4;
const ORDER_OF_CHECKS: usize = 8;

/// Delays that are tried where fewer are asked for: outside of a scan that misses the delay no lag in it is right.
const LEAST_DELAYS: usize = 19;

/// Outliers whose times are said.
const SAID: usize = 5;

/// Settings without constant inputs and with the delay that was left to the record, and what was found. Errors: a
/// constant output, inputs that are all constant.
pub fn prepared(source: Source<'_>, out: &mut Output) -> anyhow::Result<(Settings, RecordChecksV1)> {
    let mut settings = source.settings.clone();
    let mut checks = RecordChecksV1 {
        inputs_left_out: left_out(source)?,
        delay: None,
        order: None,
        trends: Vec::new(),
        outliers: Vec::new(),
    };
    let Some(input_output) = &mut settings.input_output else { return Ok((settings, checks)) };
    if !checks.inputs_left_out.is_empty() {
        input_output.inputs.retain(|name| !checks.inputs_left_out.contains(name));
        out.notes().push(ConstantInput { inputs: checks.inputs_left_out.clone() });
    }
    if settings.methods.iter().any(|method| method.takes_inputs()) {
        choose_hold(Source { settings: source.settings, ..source }, input_output, out);
    }
    if let Some(range) = input_output.delays {
        let order = settings.orders.iter().find_map(|order| match order.0 {
            Order::Given(n) => Some(n.min(ORDER_OF_DELAY)),
            Order::Automatic => None,
        });
        checks.delay = delay(Source { settings: source.settings, ..source }, input_output, order, range, out)?;
        input_output.delay = checks.delay.as_ref().map_or(0, |found| found.samples as usize);
    }
    Ok((settings, checks))
}

/// Constant inputs, by name, among those that are named. Errors: a constant output, or nothing but constant inputs.
fn left_out(source: Source<'_>) -> anyhow::Result<Vec<String>> {
    let Settings { input_output, hankel, channel, .. } = source.settings;
    let (mut inputs, mut outputs) = match input_output {
        Some(InputOutputSettings { inputs, outputs, .. }) => (inputs.clone(), outputs.clone()),
        None => (Vec::new(), Vec::new()),
    };
    inputs.retain(|name| name != "none");
    // Of a crash the pulse may be beside what is asked for.
    let channels = hankel.iter().flat_map(|hankel| &hankel.channels).chain(channel);
    for name in channels.filter(|_| input_output.is_none()) {
        if !outputs.contains(name) {
            outputs.push(name.clone());
        }
    }
    // What is not there, or not in the window, the methods say.
    let (Ok(driving), Ok(answering)) = (waves(inputs, source), waves(outputs, source)) else { return Ok(Vec::new()) };
    let samples = |all: &[WindowedWave]| all.iter().map(|wave| wave.sampled.samples().to_vec()).collect::<Vec<_>>();
    let found = Constants::of(&samples(&driving), &samples(&answering));
    let names = |all: &[WindowedWave], places: &[usize]| -> Vec<String> {
        places.iter().map(|place| all[*place].id.clone()).collect()
    };
    if !found.outputs.is_empty() {
        let names = names(&answering, &found.outputs).join(", ");
        return Err(Refused::new(format!("the output {names} is constant over the samples in use: nothing answers"))
            .hint(format!("name another with {}, or {}", flag("outputs"), widen_the_window()))
            .into());
    }
    if found.all_inputs {
        let names: Vec<&str> = driving.iter().map(|wave| wave.id.as_str()).collect();
        let text = format!("the input {} is constant over the samples in use: nothing drives", names.join(", "));
        return Err(Refused::new(text)
            .hint(format!(
                "name what drives with {}, \"none\" where nothing does, or {}",
                flag("inputs"),
                widen_the_window()
            ))
            .into());
    }
    Ok(names(&driving, &found.inputs_left_out))
}

/// Steps between the samples where every input stands still between jumps and nothing else is asked for. What is chosen
/// is said, and what is asked for against the samples.
fn choose_hold(source: Source<'_>, input_output: &mut InputOutputSettings, out: &mut Output) {
    // Where the waveforms are refused, the methods say so.
    let Ok(record) = record(source, input_output) else { return };
    let is_still = |wave: &&WindowedWave| is_staircase(wave.sampled.samples());
    let inputs: Vec<String> = record.inputs.iter().filter(is_still).map(|wave| wave.id.clone()).collect();
    if inputs.is_empty() || input_output.hold == Hold::ZeroOrder {
        return;
    }
    let of_inputs = record.inputs.len();
    if !input_output.hold_is_given && inputs.len() == of_inputs {
        input_output.hold = Hold::ZeroOrder;
        let note = Note::from(StepsTaken { inputs });
        out.summary(format!("hold: {}", note.text));
        out.notes().push(note);
        return;
    }
    let asked_hold = input_output.hold_is_given.then(|| input_output.hold.to_string());
    out.notes().push(LinesOverSteps { inputs, of_inputs, asked_hold });
}

/// Which inputs stand still.
fn standing_still(inputs: &[String]) -> String {
    match inputs {
        [one] => format!("{one} stands still between its jumps"),
        several => format!("{} stand still between their jumps", several.join(", ")),
    }
}

/// The delay of the record, said with the number that `--delay` takes. A wider range is tried where few are asked for,
/// and once where the best is the last: a delay beyond the range asked for is said.
fn delay(
    source: Source<'_>,
    input_output: &InputOutputSettings,
    order: Option<usize>,
    (first, last): (usize, usize),
    out: &mut Output,
) -> anyhow::Result<Option<FoundDelayV1>> {
    let record = record(source, input_output)?;
    if record.inputs.is_empty() {
        return Ok(None);
    }
    let data = record.data.slice(0, SAMPLES_OF_DELAY)?;
    let order = order.unwrap_or(ORDER_OF_DELAY);
    // A hold takes a lag of its own.
    let scan = |last: usize| delay_scan(&data, order, 0, last + 1).map(|scan| (last, scan));
    let wide = LEAST_DELAYS.max(last);
    let found = scan(wide).or_else(|| scan(last)).map(|found| match found.1.lag == found.0 + 1 {
        true => scan(2 * found.0 + 1).unwrap_or(found),
        false => found,
    });
    let Some((tried, scan)) = found else {
        out.notes().push(NoDelayFound { first, last, samples: data.samples() });
        return Ok(None);
    };
    let samples = scan.lag.saturating_sub(1);
    let seconds = samples as f64 * data.sample_time_s();
    out.summary(format!("delay: {samples} samples ({seconds:.6} s), the best of 0 to {tried}"));
    let is_last = scan.lag == tried + 1;
    if is_last || !(first..=last).contains(&samples) {
        let wider = is_last.then_some(2 * tried);
        out.notes().push(DelayAtEdge { samples, first, last, tried, wider });
    }
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    Ok(Some(FoundDelayV1 {
        samples: size(samples),
        first: 0,
        last: size(tried),
        at_edge: is_last,
        noise: match scan.noise {
            NoiseKind::OutputError => NoiseModelV1::OutputError,
            NoiseKind::Arx => NoiseModelV1::Arx,
        },
    }))
}

/// Looks for trends and outliers in the outputs of a record that is no crash, with the order of the model to use, says
/// what there is and writes it.
pub fn finish(
    source: Source<'_>,
    order: Option<usize>,
    mut checks: RecordChecksV1,
    out: &mut Output,
) -> anyhow::Result<()> {
    let Some(input_output) = &source.settings.input_output else { return Ok(()) };
    let Some(record) = record(source, input_output).ok().filter(|record| !record.inputs.is_empty()) else {
        return Ok(());
    };
    let outputs: Vec<&str> = record.outputs.iter().map(|wave| wave.id.as_str()).collect();
    let topic = format!("/checks/{}", outputs.join("+"));
    let Some(order) = order.filter(|_| !source.is_of_a_crash()) else {
        let has_some = checks.delay.is_some() || !checks.inputs_left_out.is_empty();
        return if has_some { out.put(&topic, &checks) } else { Ok(()) };
    };
    let order = order.clamp(1, ORDER_OF_CHECKS);
    checks.order = u32::try_from(order).ok();
    let delay = input_output.delay;
    // Unseen samples belong to the record.
    let data = record.whole.delayed(delay).slice(delay, delay + SAMPLES_OF_CHECKS)?;
    let checked = data.outputs().par_iter().map(|output| {
        let single = IoData::new(data.inputs().to_vec(), vec![output.clone()], data.sample_time_s())?;
        let line = if input_output.remove_trend { None } else { trend(&single, order).ok() };
        let places = outliers(&single, order, false).map_or_else(|_| Vec::new(), |(mut found, _)| found.swap_remove(0));
        Ok((line.filter(|line| line.is_there), places))
    });
    let checked: Vec<(Option<Trend>, Vec<usize>)> = checked.collect::<Result<_, IdentifyError>>()?;
    for (answer, (line, places)) in record.outputs.iter().zip(checked) {
        if let Some(found) = line {
            let slope_per_s = found.slope / data.sample_time_s();
            out.notes().push(FollowsLine { output: answer.id.clone(), slope_per_s, unit: answer.unit().to_owned() });
            checks.trends.push(TrendV1 { channel: answer.id.clone(), slope_per_s, bic_gain: found.bic_gain });
        }
        if !places.is_empty() {
            let times_s: Vec<f64> = places.iter().map(|place| answer.sampled.time_s(place + delay)).collect();
            let times = times_s.iter().take(SAID).map(|time| format!("{time:.6} s")).collect();
            out.notes().push(OutliersFound { output: answer.id.clone(), count: places.len(), times });
            let samples = places.iter().map(|place| (place + delay) as u64).collect();
            checks.outliers.push(OutliersV1 { channel: answer.id.clone(), samples, times_s });
        }
    }
    out.put(&topic, &checks)
}

/// Modes of several outputs without an input, written as the diagram `ambient`, and lines of machines that run. `None`
/// of other records.
pub fn put_ambient(source: Source<'_>, out: &mut Output) -> anyhow::Result<Option<AmbientModes>> {
    let Some(input_output) = source.settings.input_output.as_ref() else { return Ok(None) };
    if input_output.inputs != ["none"] || input_output.outputs.len() < 2 {
        return Ok(None);
    }
    let Ok(record) = record(source, input_output) else { return Ok(None) };
    let mut options = AmbientOptions::default();
    if let Some(wanted) = source.settings.stabilisation.as_ref().filter(|wanted| wanted.highest_damping < 1.0) {
        options.highest_damping = wanted.highest_damping;
    }
    let found = match ambient_modes(&record.data, options) {
        Ok(found) => found,
        Err(error) => {
            out.notes().push(AmbientLeftOut { reason: Some(error.to_string()), count: None });
            return Ok(None);
        }
    };
    let names: Vec<String> = found
        .modes
        .iter()
        .map(|mode| {
            let hz = mode.natural_frequency_rad_per_s.median / TAU;
            let [early, late] = mode.halves_rad_per_s.map(|frequency| frequency / TAU);
            let damping = mode.damping_ratio.median;
            format!("{hz:.3} Hz (damping {damping:.3}, halves {early:.3} and {late:.3} Hz, {} orders)", mode.orders)
        })
        .collect();
    let highest = found.orders.last().copied().unwrap_or(0);
    out.summary(match names.len() {
        0 => format!("ambient: no mode stays over the orders up to {highest} and both halves of the record"),
        count => format!("ambient: {count} modes over orders and both halves: {}", names.join(", ")),
    });
    if found.not_in_both_halves > 0 {
        out.notes().push(AmbientLeftOut { reason: None, count: Some(found.not_in_both_halves) });
    }
    for HarmonicLine { frequency_rad_per_s, damping_ratio, kurtosis } in &found.harmonics {
        let frequency_hz = frequency_rad_per_s / TAU;
        let (damping_ratio, kurtosis) = (*damping_ratio, *kurtosis);
        let note = Note::from(RunningMachine { frequency_hz, damping_ratio, kurtosis });
        out.summary(note.clone());
        out.notes().push(note);
    }
    let channels: Vec<&str> = record.outputs.iter().map(|wave| wave.id.as_str()).collect();
    out.put("/stabilisation/ambient", &diagram(&found, channels.join(", "), options))?;
    Ok(Some(found))
}

fn diagram(found: &AmbientModes, channel: String, options: AmbientOptions) -> StabilizationV1 {
    let usual = StabilizationOptions::default();
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    StabilizationV1 {
        method: "ambient".to_owned(),
        channel,
        orders: found.orders.iter().map(|order| size(*order)).collect(),
        highest_damping: options.highest_damping,
        nyquist_share: usual.nyquist_share,
        least_collinearity: Some(0.7),
        least_strength: None,
        frequency_change: usual.frequency_change,
        damping_change: usual.damping_change,
        shape_change: Some(usual.shape_change),
        presence: usual.presence,
        poles: found
            .poles
            .iter()
            .map(|pole| StabilizationPoleV1 {
                order: size(pole.order),
                re_per_s: pole.mode.pole.re,
                im_rad_per_s: pole.mode.pole.im,
                stability: Stability::All.name().to_owned(),
            })
            .collect(),
        clusters: found
            .modes
            .iter()
            .map(|mode| StabilizationClusterV1 {
                orders: size(mode.orders),
                natural_frequency_rad_per_s: mode.natural_frequency_rad_per_s.median,
                natural_frequency_lower_rad_per_s: mode.natural_frequency_rad_per_s.lower,
                natural_frequency_upper_rad_per_s: mode.natural_frequency_rad_per_s.upper,
                damping_ratio: mode.damping_ratio.median,
                damping_ratio_lower: mode.damping_ratio.lower,
                damping_ratio_upper: mode.damping_ratio.upper,
                halves_rad_per_s: mode.halves_rad_per_s.to_vec(),
                shape_re: mode.shape.iter().map(|x| x.re).collect(),
                shape_im: mode.shape.iter().map(|x| x.im).collect(),
            })
            .collect(),
        not_in_both_halves: Some(size(found.not_in_both_halves)),
    }
}

remarks! {
    /// Remarks of records.
    pub REMARKS;

    /// An input is constant: the methods run without it.
    CR415 ConstantInput { inputs: Vec<String> }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The input varies by no more than rounding, 1e-12 of its largest value, over the samples in use."
    means "A constant drives nothing, and no model has a path from it. Models of the other inputs are as they are."
    remedy "name inputs that vary: --inputs, or widen the window: --from, --to"
    says format!(
        "the methods run without {}, which is constant over the samples in use: it drives nothing",
        inputs.join(", ")
    );

    /// All inputs are staircases: the models take steps between the samples.
    CR416 StepsTaken { inputs: Vec<String> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Every input stands still between its jumps, and no --hold is given."
    means "The continuous models hold for an input that keeps each value until the next sample."
    remedy "nothing; --hold first-order takes straight lines"
    says format!("{}: steps between samples are taken, as --hold zero-order does", standing_still(inputs));

    /// An input is a staircase, and the models take straight lines between its samples.
    CR417 LinesOverSteps { inputs: Vec<String>, of_inputs: usize, asked_hold: Option<String> }
    bears on (About::IdentifiedModels, Weight::Marked)
    decided "The input stands still between its jumps. Straight lines are asked for, or another input does not stand \
             still: all inputs have one hold."
    means "Straight lines move a staircase by half a sample. Continuous poles, gains and phases are wrong by as much."
    remedy "add --hold zero-order; where the other inputs need lines, identify them in a run of their own"
    says {
        let mixed = if inputs.len() == *of_inputs { "" } else { ", the other inputs do not" };
        let asked = asked_hold.as_ref().map_or_else(|| "all inputs have".to_owned(), |h| format!("--hold {h} takes"));
        format!(
            "{}{mixed}: {asked} straight lines between samples, which move a staircase by half a sample; --hold \
             zero-order takes steps",
            standing_still(inputs)
        )
    };

    /// No delay of the input has a model.
    CR418 NoDelayFound { first: usize, last: usize, samples: usize }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "Each delay is tried with output error and with ARX of up to four poles, in the first 4000 samples at \
             most. The record is too short for that, or no fit works."
    means "The models have no delay. A true delay shows as extra poles and zeros."
    remedy "state the delay in samples: --delay, or widen the window: --from, --to"
    says format!("no delay from {first} to {last} has a model in {samples} samples: 0 is used");

    /// The best delay is the last that was tried, or lies outside of the range that was asked for.
    CR419 DelayAtEdge { samples: usize, first: usize, last: usize, tried: usize, wider: Option<usize> }
    bears on (About::IdentifiedModels, Weight::Marked)
    decided "The smallest BIC of the one-step prediction error decides among 0 to 19 samples, or up to the range asked \
             for where it is wider."
    means "The delay may be a longer one, or the range that was expected is wrong. Poles and gains depend on the delay."
    remedy "try a wider range: --delay auto=0-N, and check the time axes of input and output"
    says match wider {
        Some(wider) => format!(
            "the delay of {samples} samples is at the edge of what was tried, 0 to {tried}: try a wider range, --delay \
             auto=0-{wider}"
        ),
        None => format!(
            "the delay of {samples} samples lies beyond the edge of the scan asked for, {first} to {last}, and is used"
        ),
    };

    /// An output drifts along a straight line beside its motion.
    CR420 FollowsLine { output: String, slope_per_s: f64, unit: String }
    bears on (About::IdentifiedModels, Weight::Marked)
    decided "The noise model of the output gains more than ln N in BIC where straight lines are removed, and the \
             system does not integrate."
    means "A model takes the line for a slow mode. Its lowest frequency and its damping are those of the drift."
    remedy "add --remove-trend, unless the drift is part of the motion"
    says format!(
        "{output} follows a straight line of {slope_per_s:.3e}{}/s beside its motion, and a model takes it for a slow \
         mode; --remove-trend removes it",
        behind_blank(unit)
    );

    /// Single samples of an output stand out of the errors of a model.
    CR421 OutliersFound { output: String, count: usize, times: Vec<String> }
    bears on (About::IdentifiedModels, Weight::Marked)
    decided "The error of an output-error fit lies beyond six scaled median absolute deviations. Where more than 1 % \
             of the samples do, none is named: the model is wrong."
    means "Outliers move frequencies and damping ratios, and widen intervals."
    remedy "correct these samples in the record, or choose a window without them: --from, --to"
    says {
        let more = if *count > times.len() { " and later" } else { "" };
        format!(
            "outliers in {output}: {count} of its samples stand out of the errors of a model, at {}{more}; they move \
             frequencies and damping ratios",
            times.join(", ")
        )
    };

    /// Modes of a record without an input are left out, or were not looked for.
    CR422 AmbientLeftOut { reason: Option<String>, count: Option<usize> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "A mode must stay over half of the orders, and both halves of the record must show it: frequency within 4 \
             %, MAC 0.9 or more."
    means "What only one half shows comes and goes, or is noise. It is not among the modes of the record."
    remedy "record for longer, or widen the window: --from, --to"
    says match (reason, count) {
        (Some(reason), _) => format!("no modes over orders and halves of the record: {reason}"),
        (None, count) => format!(
            "ambient: {} more stay over the orders but not in both halves of the record, and are left out",
            count.unwrap_or_default()
        ),
    };

    /// A frequency of a record without an input is the line of a machine that runs, and no mode.
    CR423 RunningMachine { frequency_hz: f64, damping_ratio: f64, kurtosis: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The damping ratio is zero within two deviations, sqrt(zeta/(w T)), and the kurtosis of the band is below \
             2.25: a sine has 1.5, a mode in noise 3 (Jacobsen, Andersen & Brincker, ISMA 2006)."
    means "The structure is shaken at this frequency. It is not among the modes, and its shape is no mode shape."
    remedy "nothing; a record with the machine at rest shows whether a mode lies there too"
    says format!(
        "ambient: {frequency_hz:.3} Hz is a harmonic line, a machine that runs, and no mode: its damping of \
         {damping_ratio:.1e} is zero within its error, and the kurtosis of its band is {kurtosis:.2} (a sine has 1.5, \
         a mode in noise 3)"
    );
}
