//! Measured outputs over those of every model, and the correlations of the errors between them.

use crate::drawing::numbers::LONG_S;
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Panel, Width};
use crate::findings::{ErrorCorrelation, Model, ModelOutput, Run};
use crate::words;
use crumple_signal::{QuantityKind, Sampled};

/// Outputs that have a panel.
const MOST_OUTPUTS: usize = 4;
/// Inputs that errors are correlated with in a panel of their own.
const MOST_INPUTS: usize = 2;
/// Models shown at first; the others wait in the legend.
const SHOWN: usize = 3;
/// A record that crosses its mean more often is too dense to be read at first.
const CROSSINGS_IN_VIEW: f64 = 60.0;

/// Channels of the outputs of all models, each once.
fn channels(run: &Run) -> Vec<&str> {
    let mut all: Vec<&str> = Vec::new();
    for output in run.models.iter().flat_map(|model| &model.outputs).filter(|output| output.simulated.is_some()) {
        if !all.contains(&output.channel.as_str()) {
            all.push(&output.channel);
        }
    }
    all
}

/// Measured over simulated; `None` where no output of a model is in the artifacts.
pub fn compare(run: &Run) -> Option<Figure> {
    let channels = channels(run);
    let mut figure = Figure::new("compare", "Measured and simulated");
    let test = figure.entry("measured", Look::line(Colour::Test, Dash::Solid).width(Width::Thick), true);
    let order = run.model_order();
    let entries: Vec<usize> = run
        .models
        .iter()
        .enumerate()
        .map(|(place, model)| {
            let shown = order.iter().take(SHOWN).any(|k| *k == place) || run.is_recommended(&model.id);
            figure.entry(legend(model), Look::of_series(place), shown)
        })
        .collect();
    let mut is_cut = false;
    for channel in channels.iter().take(MOST_OUTPUTS) {
        let drawn: Vec<(usize, &ModelOutput)> = run
            .models
            .iter()
            .zip(&entries)
            .filter_map(|(model, entry)| {
                let output = model.outputs.iter().find(|output| output.channel == *channel)?;
                output.simulated.is_some().then_some((*entry, output))
            })
            .collect();
        let panel = panel_of(channel, &drawn, test)?;
        is_cut |= panel.1;
        figure.panels.push(panel.0);
    }
    let mut caption = String::from("The record and the outputs that the models answer the recorded inputs with.");
    if run.models.iter().any(|model| model.unseen_fit_percent().is_some()) {
        caption.push_str(" Shaded: unseen samples, with the start of the model fitted to them.");
    }
    if is_cut {
        caption.push_str(" The axis of time shows a part of the record at first.");
    }
    if channels.len() > MOST_OUTPUTS {
        caption.push_str(&format!(" {} more outputs are in the artifact.", channels.len() - MOST_OUTPUTS));
    }
    figure.caption = caption;
    let figure = figure.tidy();
    (!figure.panels.is_empty()).then_some(figure)
}

/// `n4sid-4, 96.1 % (unseen 95.4 %)`.
fn legend(model: &Model) -> String {
    let percent = |fit: f64| format!("{} %", words::decimals(fit, 1));
    match (model.fit_percent().map(percent), model.unseen_fit_percent().map(percent)) {
        (Some(fit), Some(unseen)) => format!("{}, {fit}, unseen {unseen}", model.id),
        (Some(fit), None) => format!("{}, {fit}", model.id),
        (None, _) => model.id.clone(),
    }
}

/// One output: the record, every model, the unseen stretch shaded. Beside it whether a part of it is in view at first.
fn panel_of(channel: &str, drawn: &[(usize, &ModelOutput)], test: usize) -> Option<(Panel, bool)> {
    let ends = drawn.iter().filter_map(|(_, output)| output.simulated.as_ref());
    let (from_s, to_s) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y.t0_s()), h.max(y.end_s())));
    let first = drawn.iter().find_map(|(_, output)| output.simulated.as_ref())?;
    let unseen_from_s = drawn.iter().find_map(|(_, output)| output.unseen_from_s);
    let share = CROSSINGS_IN_VIEW / crossings(first);
    let view = (share < 1.0).then(|| {
        let half = 0.5 * share * (to_s - from_s);
        let middle = unseen_from_s.unwrap_or(from_s).clamp(from_s + half, to_s - half);
        [middle - half, middle + half]
    });
    let seen_s = view.map_or(to_s - from_s, |[from, to]| to - from);
    // In s where what is looked at is long.
    let (factor, unit) = if seen_s > LONG_S { (1.0, "s") } else { (1e3, "ms") };
    let x = Axis { view: view.map(|ends| ends.map(|t| factor * t)), ..Axis::new(format!("time, {unit}")) };
    let unit = drawn.iter().find_map(|(_, output)| output.quantity).map(QuantityKind::si_unit);
    let unit = unit.filter(|unit| *unit != "1").map_or_else(String::new, |unit| format!(", {unit}"));
    let mut panel = Panel::new(x, Axis::new(format!("{channel}{unit}")));
    let points = |signal: &Sampled| -> Vec<[f64; 2]> {
        let inside = |t: f64| t >= from_s - 0.5 * signal.dt_s() && t <= to_s + 0.5 * signal.dt_s();
        let at = signal.samples().iter().enumerate().map(|(k, y)| (signal.time_s(k), *y));
        at.filter(|(t, _)| inside(*t)).map(|(t, y)| [factor * t, y]).collect()
    };
    if let Some(measured) = drawn.iter().find_map(|(_, output)| output.measured.as_ref()) {
        panel.line(test, points(measured));
    }
    for (entry, output) in drawn {
        if let Some(simulated) = &output.simulated {
            panel.line(*entry, points(simulated));
        }
    }
    panel.windows.extend(unseen_from_s.map(|from| [factor * from, factor * to_s]));
    Some((panel, view.is_some()))
}

/// How often a signal crosses its mean, at least once.
fn crossings(signal: &Sampled) -> f64 {
    let mean = signal.samples().iter().sum::<f64>() / signal.len().max(1) as f64;
    let changes = signal.samples().windows(2).filter(|pair| (pair[0] > mean) != (pair[1] > mean)).count();
    changes.max(1) as f64
}

/// Autocorrelation of the errors and their correlation with the inputs, with their 95 % limits; `None` without both
/// curves of an output.
pub fn errors(run: &Run) -> Option<Figure> {
    let mut figure = Figure::new("errors", "Errors of the simulation");
    let limits = figure.entry("95 % limits of white errors", Look::area(Colour::Test), true);
    let order = run.model_order();
    let entries: Vec<usize> = run
        .models
        .iter()
        .enumerate()
        .map(|(place, model)| {
            let shown = order.iter().take(SHOWN).any(|k| *k == place) || run.is_recommended(&model.id);
            figure.entry(&model.id, Look::of_series(place), shown)
        })
        .collect();
    for channel in channels(run).into_iter().take(MOST_OUTPUTS) {
        let outputs: Vec<(usize, &Model, &ModelOutput)> = run
            .models
            .iter()
            .zip(&entries)
            .filter_map(|(model, entry)| {
                Some((*entry, model, model.outputs.iter().find(|output| output.channel == channel)?))
            })
            .collect();
        let own: Vec<(usize, ErrorCorrelation)> =
            outputs.iter().filter_map(|(entry, _, output)| Some((*entry, output.autocorrelation()?))).collect();
        figure.panels.extend(correlation_panel(format!("errors of {channel}"), &own, limits));
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in outputs.iter().flat_map(|(_, model, _)| &model.inputs) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        for name in names.into_iter().take(MOST_INPUTS) {
            let with_input: Vec<(usize, ErrorCorrelation)> = outputs
                .iter()
                .filter_map(|(entry, model, output)| {
                    let (_, input) = model.inputs.iter().find(|(input, _)| input == name)?;
                    Some((*entry, output.correlation_with(input)?))
                })
                .collect();
            let title = format!("errors of {channel} with {name}");
            figure.panels.extend(correlation_panel(title, &with_input, limits));
        }
    }
    let outside = order.iter().take(SHOWN).filter_map(|place| {
        let model = &run.models[*place];
        let all: Vec<ErrorCorrelation> = model.outputs.iter().filter_map(ModelOutput::autocorrelation).collect();
        let lags: usize = all.iter().map(|correlation| correlation.at_lags.len() - 1).sum();
        let outside: usize = all.iter().map(ErrorCorrelation::outside).sum();
        (!all.is_empty()).then(|| format!(" {}: {outside} of {lags} lags are outside.", model.id))
    });
    figure.caption = format!(
        "Autocorrelation of the errors, and their correlation with the inputs; a negative lag is an input after the \
         error. Errors outside the limits are correlated: deviations that assume white ones are wrong.{}",
        outside.collect::<String>()
    );
    let figure = figure.tidy();
    (!figure.panels.is_empty()).then_some(figure)
}

fn correlation_panel(title: String, all: &[(usize, ErrorCorrelation)], limits: usize) -> Option<Panel> {
    let (_, first) = all.first()?;
    let mut panel = Panel::new(Axis { whole: true, ..Axis::new("lag, samples") }, Axis::new(title));
    // A shorter record has the wider limits.
    let limit = all.iter().map(|(_, correlation)| correlation.limit).fold(0.0, f64::max);
    let ends = [first.at_lags.first()?[0], first.at_lags.last()?[0]];
    let middle = 0.5 * (ends[0] + ends[1]);
    panel.band(limits, &[ends[0], middle, ends[1]].map(|lag| [lag, -limit, limit]));
    for (entry, correlation) in all {
        panel.line(*entry, correlation.at_lags.clone());
    }
    Some(panel)
}
