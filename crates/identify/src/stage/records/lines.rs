//! The lines of one model on the screen, at most twelve: how well it fits, what speaks against it, what it is.

use std::f64::consts::TAU;

use crumple_numerics::lti::Complex;
use crumple_signal::Note;
use crumple_stage::SummaryLine;
use crumple_stage::records::{
    EvidenceV1, IdentificationV1, ModeV1, ModesV2, NoiseModelV1, OtherPoleKindV1, OtherPoleV1, SpreadV1,
};
use crumple_sysid::weak_fit;

use crate::stage::records::model::Forms;

/// Warnings of a model that have a line each; one line counts the others.
const MOST_WARNINGS: usize = 3;

/// Poles, zeros and outputs that are named; the others are counted.
const MOST_NAMED: usize = 8;

/// Numerators that have a line each.
const MOST_NUMERATORS: usize = 2;

/// Growth of a pole over the whole record below which it is rounding.
const GROWTH: f64 = 1e-6;

/// Above this condition number of the sensitivities of a fit single coefficients mean little.
pub const ILL_CONDITIONED: f64 = 1e8;

/// What the samples of a record are taken for whose input nobody knows.
pub const AMBIENT: &str = "ambient";

/// Columns of the names of lines.
const LABEL: usize = 13;

/// Numbers of a body on a spring and a damper: name in the evidence, symbol, unit.
pub const SINGLE_MASS: [(&str, &str, &str); 3] =
    [("mass_kg", "m", "kg"), ("damping_n_s_per_m", "c", "N s/m"), ("stiffness_n_per_m", "k", "N/m")];

/// Coefficients of a sampled model that are printed; those of more are in the artifact.
const MOST_COEFFICIENTS: usize = 12;

/// Name, numerator and denominator, and deviations of the numerator of one path.
type NamedPath<'a> = (String, &'a (Vec<f64>, Vec<f64>), &'a [f64]);

/// What the lines are made from.
pub struct ModelFacts<'a> {
    /// Id of the model.
    pub id: &'a str,
    /// How it was identified.
    pub identification: &'a IdentificationV1,
    /// Evidence of every output.
    pub evidence: &'a [EvidenceV1],
    /// Its poles.
    pub modes: &'a ModesV2,
    /// The model itself.
    pub forms: &'a Forms,
    /// Its zeros, 1/s.
    pub zeros: &'a [Complex],
    /// Whether straight lines between the samples of an input lose more than the record leaves open.
    pub loses_in_lines: bool,
}

/// A number with three significant digits, `1.23e8` where it is large or small.
pub fn digits(x: f64) -> String {
    significant(x, 3)
}

fn significant(x: f64, digits: usize) -> String {
    let scientific = format!("{x:.*e}", digits - 1);
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    if x == 0.0 {
        return "0".to_owned();
    }
    if !(-3..5).contains(&exponent) {
        return scientific;
    }
    let decimals = usize::try_from(i32::try_from(digits).unwrap_or(i32::MAX) - 1 - exponent).unwrap_or(0);
    // Rounded at its last significant digit, also left of the point.
    let rounded: f64 = scientific.parse().unwrap_or(x);
    format!("{rounded:.decimals$}")
}

/// `1.23e8 ± 4.56e7`, three significant digits each.
pub fn with_deviation(value: f64, deviation: Option<f64>) -> String {
    match deviation.filter(|deviation| deviation.is_finite()) {
        Some(deviation) => format!("{} ± {}", digits(value), digits(deviation)),
        None => digits(value),
    }
}

/// `(6.28e5 ± 2.98e6) s + (9.87e8 ± 1.34e9)`; `deviations` belong to the last coefficients.
fn polynomial(coefficients: &[f64], deviations: &[f64]) -> String {
    let before = coefficients.len().saturating_sub(deviations.len());
    let surplus = deviations.len().saturating_sub(coefficients.len());
    let terms = coefficients.iter().enumerate().map(|(k, value)| {
        let deviation = k.checked_sub(before).and_then(|k| deviations.get(k + surplus)).copied();
        let number = match with_deviation(*value, deviation) {
            text if deviation.is_some() => format!("({text})"),
            text => text,
        };
        match coefficients.len() - 1 - k {
            0 => number,
            power => {
                let s = if power == 1 { "s".to_owned() } else { format!("s^{power}") };
                if *value == 1.0 && deviation.is_none() { s } else { format!("{number} {s}") }
            }
        }
    });
    terms.collect::<Vec<_>>().join(" + ")
}

/// The first of them, and how many more there are.
fn named(all: Vec<String>) -> String {
    let more = all.len().saturating_sub(MOST_NAMED);
    let mut text = all[..all.len() - more].join("; ");
    if more > 0 {
        text.push_str(&format!("; {more} more in the artifact"));
    }
    text
}

fn percent(fit: Option<f64>) -> String {
    fit.map_or_else(|| "no defined fit".to_owned(), |fit| format!("{fit:.2} %"))
}

impl ModelFacts<'_> {
    /// All lines: first how well it fits, then the warnings, then the model.
    pub fn lines(&self, warnings: &[&Note]) -> Vec<SummaryLine> {
        let mut lines = vec![self.headline().into()];
        let shown = if warnings.len() > MOST_WARNINGS + 1 { MOST_WARNINGS } else { warnings.len() };
        lines.extend(warnings[..shown].iter().map(|warning| SummaryLine::Remark((*warning).clone())));
        if warnings.len() > shown {
            lines.push(format!("  {} more warnings are in the notes", warnings.len() - shown).into());
        }
        let mut put = |label: &str, text: Option<String>| {
            lines.extend(text.map(|text| SummaryLine::Text(format!("  {label:<LABEL$} {text}"))));
        };
        put("outputs", self.outputs().filter(|_| !self.is_ambient() && !self.is_predicted_only()));
        self.form().into_iter().for_each(|(label, text)| put(label, Some(text)));
        put("poles", self.poles());
        put("poles z", self.sampled_poles().filter(|_| self.is_predicted_only()));
        put("zeros", self.zeros());
        put("search", self.search());
        if !self.is_ambient() {
            put("errors", self.errors());
            put("verdict", Some(self.verdict()));
        }
        lines
    }

    fn headline(&self) -> String {
        let Self { id, identification, evidence, .. } = *self;
        let IdentificationV1 { samples, fit_percent, .. } = identification;
        if self.is_ambient() {
            return format!("{id}: of an ambient record of {samples} samples, not judged by a fit");
        }
        if self.is_predicted_only() {
            let fits = evidence.iter().map(|e| format!("{} of {}", percent(e.prediction_fit_percent), e.output));
            let fits = fits.collect::<Vec<_>>().join(", ");
            return format!("{id}: one-step prediction fit {fits}, {samples} samples; it grows and is not simulated");
        }
        if evidence.len() > 1 {
            return format!("{id}: worst fit {} of {samples} samples", percent(*fit_percent));
        }
        let (name, unseen) = evidence.first().map_or((String::new(), String::new()), |e| (e.output.clone(), unseen(e)));
        format!("{id}: fit {} of {name}, {samples} samples{unseen}", percent(*fit_percent))
    }

    /// Whether nobody knows what drove the record.
    fn is_ambient(&self) -> bool {
        self.identification.treated_as == AMBIENT
    }

    /// Whether the model grows, so that its one-step prediction alone was compared with the record.
    fn is_predicted_only(&self) -> bool {
        let Self { identification, evidence, .. } = *self;
        let predicts = |e: &EvidenceV1| e.loss.is_none() && e.prediction_fit_percent.is_some();
        identification.fit_percent.is_none() && !evidence.is_empty() && evidence.iter().all(predicts)
    }

    /// Fit and validation of each output, where there are several.
    fn outputs(&self) -> Option<String> {
        let fits = self.identification.output_fits_percent.iter();
        let all: Vec<String> = self
            .evidence
            .iter()
            .zip(fits)
            .map(|(e, fit)| format!("{} {}{}", e.output, percent(*fit), unseen(e)))
            .collect();
        (!all.is_empty()).then(|| named(all))
    }

    /// Polynomials of transfer functions, sizes of a state space, the number of exponentials.
    fn form(&self) -> Vec<(&'static str, String)> {
        let forms = self.forms;
        if !forms.terms.is_empty() {
            return vec![("model", format!("sum of {} exponentials", forms.terms.len()))];
        }
        if !forms.is_transfer_function {
            let Some((_, model, _)) = forms.state_spaces.first() else { return Vec::new() };
            let sampled = model.sample_time_s.map_or("continuous".to_owned(), |dt| format!("sampled every {dt} s"));
            let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
            let [states, inputs, outputs] =
                [(model.order(), "state"), (model.b.ncols(), "input"), (model.c.nrows(), "output")]
                    .map(|(n, w)| count(n, w));
            let mut lines = vec![("state space", format!("{states}, {inputs}, {outputs}, {sampled}"))];
            lines.extend(self.shift_polynomials());
            return lines;
        }
        let paths = self.paths();
        let mut lines: Vec<(&'static str, String)> = Vec::new();
        if paths.len() <= MOST_NUMERATORS {
            for (name, (numerator, _), deviations) in &paths {
                lines.push(("numerator", format!("{}{name}", polynomial(numerator, deviations))));
            }
        } else {
            let place = format!("/model/{}/<output>-<input>/transfer-function", self.id);
            lines.push(("numerators", format!("{} in the artifact: {place}", paths.len())));
        }
        if let Some((_, (_, denominator), _)) = paths.first() {
            let deviations = self.evidence.first().map_or(&[][..], |evidence| &evidence.denominator_deviations);
            lines.push(("denominator", polynomial(denominator, deviations)));
        }
        lines.extend(self.single_mass().map(|text| ("structure", text)));
        lines
    }

    /// `m 2.500 ± 0.010 kg, c ..., k ...` of a body on a spring and a damper.
    fn single_mass(&self) -> Option<String> {
        let evidence = self.evidence.first()?;
        let number = |(name, symbol, unit): &(&str, &str, &str)| {
            let place = evidence.parameter_names.iter().position(|known| known == name)?;
            let deviation = evidence.parameter_deviations.get(place).copied();
            Some(format!("{symbol} {} {unit}", measured(evidence.parameter_values[place], None, deviation, 1.0).0))
        };
        let all: Option<Vec<String>> = SINGLE_MASS.iter().map(number).collect();
        Some(all?.join(", "))
    }

    /// `A(q)` and `B(q)` of every input of a model of one output that was fitted as such, with deviations.
    fn shift_polynomials(&self) -> Vec<(&'static str, String)> {
        let [evidence] = self.evidence else { return Vec::new() };
        let EvidenceV1 { parameter_names: names, parameter_values: values, parameter_deviations: deviations, .. } =
            evidence;
        if names.len() > MOST_COEFFICIENTS {
            return vec![(
                "A(q), B(q)",
                format!("{} coefficients in the artifact: /evidence/{}", names.len(), self.id),
            )];
        }
        let term = |lag: usize, place: usize| {
            let number = measured(values[place], None, deviations.get(place).copied(), 1.0).0;
            if lag == 0 { format!("({number})") } else { format!("({number}) q^-{lag}") }
        };
        let of = |prefix: &str| -> Vec<String> {
            let lag_of = |name: &String| name.strip_prefix(prefix)?.parse::<usize>().ok();
            names.iter().enumerate().filter_map(|(place, name)| Some(term(lag_of(name)?, place))).collect()
        };
        let mut lines = Vec::new();
        let a = of("a_");
        if !a.is_empty() {
            lines.push(("A(q)", format!("1 + {}", a.join(" + "))));
        }
        let inputs = &self.identification.inputs;
        for (place, input) in inputs.iter().enumerate() {
            let several = inputs.len() > 1;
            let b = of(&if several { format!("b{}_", place + 1) } else { "b_".to_owned() });
            let name = if several { format!("   of {input}") } else { String::new() };
            if !b.is_empty() {
                lines.push(("B(q)", format!("{}{name}", b.join(" + "))));
            }
        }
        lines
    }

    /// Name, polynomials and deviations of the numerator of every path.
    fn paths(&self) -> Vec<NamedPath<'_>> {
        let several = self.forms.paths.iter().map(Vec::len).sum::<usize>() > 1;
        let mut all = Vec::new();
        for (of_inputs, evidence) in self.forms.paths.iter().zip(self.evidence) {
            let each = evidence.numerator_deviations.len() / of_inputs.len().max(1);
            for (j, path) in of_inputs.iter().enumerate() {
                let name = match self.identification.inputs.get(j) {
                    Some(input) if several => format!("   from {input} to {}", evidence.output),
                    _ => String::new(),
                };
                all.push((name, path, &evidence.numerator_deviations[j * each..(j + 1) * each]));
            }
        }
        all
    }

    /// Modes as frequency and damping, then the poles that are none.
    fn poles(&self) -> Option<String> {
        let evidence = self.evidence.first()?;
        let mut order: Vec<usize> = (0..self.modes.modes.len()).collect();
        let frequency = |k: &usize| self.modes.modes[*k].natural_frequency_rad_per_s;
        order.retain(|k| self.modes.modes[*k].im_rad_per_s >= 0.0);
        order.sort_by(|a, b| frequency(a).total_cmp(&frequency(b)));
        let mut all: Vec<String> = order.into_iter().map(|k| mode(&self.modes.modes[k], k, evidence)).collect();
        let others = |kind: OtherPoleKindV1| self.modes.other_poles.iter().filter(move |pole| pole.kind == kind);
        match others(OtherPoleKindV1::Integrator).count() {
            0 => {}
            1 => all.push("an integrator".to_owned()),
            count => all.push(format!("{count} integrators")),
        }
        for (kind, what) in [
            (OtherPoleKindV1::BeyondNyquist, "beyond Nyquist"),
            (OtherPoleKindV1::Cancelled, "cancelled by a zero, no mode"),
            (OtherPoleKindV1::Harmonic, "a harmonic line, no mode"),
        ] {
            let upper = others(kind).filter(|pole| pole.im_rad_per_s >= 0.0);
            let hz = |pole: &OtherPoleV1| digits(pole.re_per_s.hypot(pole.im_rad_per_s) / TAU);
            all.extend(upper.map(|pole| format!("{} Hz, {what}", hz(pole))));
        }
        (!all.is_empty()).then(|| named(all))
    }

    /// The sampled poles, `1.1175; 0.8798`.
    fn sampled_poles(&self) -> Option<String> {
        let modes = self.modes.modes.iter().map(|mode| (mode.discrete_re, mode.discrete_im));
        let others = self.modes.other_poles.iter().map(|pole| (pole.discrete_re, pole.discrete_im));
        let upper = modes.chain(others).filter_map(|(re, im)| re.zip(im)).filter(|(_, im)| *im >= 0.0);
        let all: Vec<String> =
            upper.map(|(re, im)| if im == 0.0 { format!("{re:.4}") } else { format!("{re:.4} ± {im:.4}i") }).collect();
        (!all.is_empty()).then(|| named(all))
    }

    fn zeros(&self) -> Option<String> {
        let evidence = self.evidence.first()?;
        let deviation = |all: &[Option<f64>], spreads: &[Option<SpreadV1>], k: usize| {
            let spread = spreads.get(k).and_then(Option::as_ref).map(|spread| spread.deviation);
            spread.or_else(|| all.get(k).copied().flatten())
        };
        let upper = self.zeros.iter().enumerate().filter(|(_, zero)| zero.im >= 0.0);
        let all: Vec<String> = upper
            .map(|(k, zero)| {
                let re = with_deviation(zero.re, deviation(&evidence.zero_re_deviations, &evidence.zero_re_spreads, k));
                let im = deviation(&evidence.zero_im_deviations, &evidence.zero_im_spreads, k);
                match zero.im {
                    0.0 => format!("{re} 1/s"),
                    _ => format!("{re} 1/s, imaginary {} rad/s", with_deviation(zero.im, im)),
                }
            })
            .collect();
        (!all.is_empty()).then(|| named(all))
    }

    /// Why the search stopped.
    fn search(&self) -> Option<String> {
        let evidence = self.evidence.first()?;
        let reason = evidence.stop_reason.as_deref()?.replace('-', " ");
        let iterations = evidence.iterations.map_or_else(String::new, |n| format!(" after {n} iterations"));
        let start = evidence.start.as_deref().map_or_else(String::new, |start| format!(" from start {start}"));
        let starts = match evidence.losses.len() {
            0 | 1 => String::new(),
            several => format!(", the best of {several} starts"),
        };
        Some(format!("stopped: {reason}{iterations}{start}{starts}"))
    }

    /// Whether the errors of the simulation are correlated, and what that does to the deviations.
    pub fn errors(&self) -> Option<String> {
        let ahead = self.is_predicted_only();
        let whiteness = |e: &EvidenceV1| if ahead { e.whiteness } else { e.simulation_whiteness };
        let tested: Vec<(&EvidenceV1, f64, f64)> = self
            .evidence
            .iter()
            .filter_map(|evidence| Some((evidence, whiteness(evidence)?, evidence.whiteness_limit?)))
            .collect();
        let of = |(_, statistic, limit): &&(&EvidenceV1, f64, f64)| statistic > limit;
        let Some((first, statistic, limit)) = tested.iter().filter(of).max_by(|a, b| a.1.total_cmp(&b.1)) else {
            let assumed = match self.loses_in_lines {
                true => "white, but deviations of poles leave out what straight lines between samples lose",
                false => "white, as deviations and intervals assume",
            };
            return (!tested.is_empty()).then(|| assumed.to_owned());
        };
        let count = tested.iter().filter(of).count();
        let where_ = if tested.len() > 1 { format!(" in {count} of {} outputs", tested.len()) } else { String::new() };
        let effect = effect_of_correlation(first, self.identification.samples);
        Some(format!(
            "correlated{where_} (Q {}, {} allowed): {effect}",
            significant(*statistic, 3),
            significant(*limit, 3)
        ))
    }

    /// What to use the model for.
    fn verdict(&self) -> String {
        let Self { identification, evidence, modes, .. } = *self;
        if self.is_predicted_only() {
            return "unstable: use its poles and one-step prediction, not its output".to_owned();
        }
        let holds: Vec<bool> = evidence.iter().filter_map(|evidence| evidence.holds_on_unseen).collect();
        if holds.contains(&false) {
            return "do not use it: unseen samples contradict it".to_owned();
        }
        if identification.fit_percent.is_none_or(|fit| weak_fit(fit).is_some()) {
            return "do not use it: it leaves more than half of the variance".to_owned();
        }
        let duration_s = identification.to_s - identification.from_s;
        let grows = |re_per_s: f64| re_per_s * duration_s > GROWTH;
        let integrates = modes.other_poles.iter().any(|pole| pole.kind == OtherPoleKindV1::Integrator);
        let beyond = modes.other_poles.iter().filter(|pole| pole.kind == OtherPoleKindV1::BeyondNyquist);
        let is_unstable =
            modes.modes.iter().map(|mode| mode.re_per_s).chain(beyond.map(|pole| pole.re_per_s)).any(grows);
        let known = evidence.iter().all(|evidence| evidence.condition.is_none_or(|c| c <= ILL_CONDITIONED));
        let has_known_mode = evidence.first().is_some_and(|evidence| {
            modes.modes.iter().enumerate().any(|(place, mode)| is_known(mode, place, evidence))
        });
        let use_it = if is_unstable {
            "unstable: it describes this window alone"
        } else if modes.other_poles.iter().any(|pole| pole.kind == OtherPoleKindV1::Cancelled) {
            "zeros cancel poles: use its output, or fewer poles"
        } else if modes.modes.is_empty() {
            "no pole is a mode: use its output, not its poles"
        } else if !has_known_mode {
            "no pole is a known mode: use its output, not its poles and coefficients"
        } else if !known {
            "use its output, not its coefficients"
        } else if integrates {
            "its modes are stable, and it integrates"
        } else {
            "all its poles are stable"
        };
        let seen = if holds.is_empty() {
            "judged by seen samples alone (--validate-from keeps some)"
        } else {
            "holds on unseen samples"
        };
        format!("{use_it}; {seen}")
    }
}

/// What correlated errors do to the deviations of a model.
fn effect_of_correlation(evidence: &EvidenceV1, samples: u64) -> String {
    let has_spreads = evidence.frequency_spreads.iter().any(Option::is_some);
    let is_linearised =
        [&evidence.frequency_deviations, &evidence.damping_deviations].iter().any(|all| !all.is_empty())
            || !evidence.denominator_deviations.is_empty();
    match (&evidence.noise, evidence.effective_samples) {
        (Some(noise), _) if has_spreads && noise.is_white => match noise.model {
            NoiseModelV1::OutputError => {
                format!("intervals are drawn from noise of an autoregression of order {}", noise.ar_order)
            }
            NoiseModelV1::Arx => "intervals are drawn from noise that goes through the poles of the system".to_owned(),
        },
        (Some(noise), _) if !noise.is_white => {
            "no noise model explains them: deviations would be too small, and intervals are left out".to_owned()
        }
        (_, Some(effective)) if is_linearised => {
            format!("the deviations count {effective:.0} independent samples of {samples}")
        }
        _ => "deviations that take them for white would be too small".to_owned(),
    }
}

/// `; unseen 96.44 %, start fitted (run on 95.41 %)`.
fn unseen(evidence: &EvidenceV1) -> String {
    match (evidence.validation_restarted_fit_percent, evidence.validation_fit_percent) {
        (Some(restarted), run_on) => {
            let run_on = run_on.map_or_else(String::new, |fit| format!(" (run on {fit:.2} %)"));
            format!("; unseen {restarted:.2} % with the start fitted{run_on}")
        }
        (None, Some(run_on)) => format!("; unseen {run_on:.2} %"),
        (None, None) => String::new(),
    }
}

/// A number with as many decimals as show two digits of its deviation, its deviation, and its interval.
fn measured(value: f64, spread: Option<SpreadV1>, deviation: Option<f64>, factor: f64) -> (String, String) {
    /// More decimals than these are not read.
    const MOST: i32 = 9;
    let deviation = spread.as_ref().map(|spread| spread.deviation).or(deviation);
    let value = factor * value;
    let Some(deviation) = deviation.map(|d| factor * d).filter(|d| *d > 0.0 && d.is_finite()) else {
        return (significant(value, 4), String::new());
    };
    let decimals = usize::try_from((1 - deviation.log10().floor() as i32).clamp(0, MOST)).unwrap_or(0);
    let interval = spread.map_or_else(String::new, |spread| {
        format!(" ({:.decimals$} to {:.decimals$})", factor * spread.lower, factor * spread.upper)
    });
    (format!("{value:.decimals$} ± {}", significant(deviation, 2)), interval)
}

/// Standard deviation of the frequency of a mode over the frequency, from which on it is not known.
const UNKNOWN_FREQUENCY: f64 = 0.2;

/// Whether the frequency of a mode is known, as far as anything is said of it.
fn is_known(mode: &ModeV1, place: usize, evidence: &EvidenceV1) -> bool {
    let spread = evidence.frequency_spreads.get(place).and_then(Option::as_ref).map(|spread| spread.deviation);
    let deviation = spread.or_else(|| evidence.frequency_deviations.get(place).copied().flatten());
    deviation.is_none_or(|deviation| deviation <= UNKNOWN_FREQUENCY * mode.natural_frequency_rad_per_s)
}

/// `4.81 ± 0.05 Hz (4.73 to 4.89), damping 19.0 ± 0.3 %`.
fn mode(mode: &ModeV1, place: usize, evidence: &EvidenceV1) -> String {
    let at = |spreads: &[Option<SpreadV1>]| spreads.get(place).cloned().flatten();
    let known = |all: &[Option<f64>]| all.get(place).copied().flatten();
    let (hz, hz_ends) = measured(
        mode.natural_frequency_rad_per_s,
        at(&evidence.frequency_spreads),
        known(&evidence.frequency_deviations),
        1.0 / TAU,
    );
    let growing = if mode.re_per_s > 0.0 { ", growing" } else { "" };
    if mode.im_rad_per_s == 0.0 {
        return format!("{hz} Hz{hz_ends}, real{growing}");
    }
    let damping = mode.damping_ratio.map_or_else(String::new, |damping| {
        let (percent, ends) =
            measured(damping, at(&evidence.damping_spreads), known(&evidence.damping_deviations), 100.0);
        format!(", damping {percent} %{ends}")
    });
    format!("{hz} Hz{hz_ends}{damping}{growing}")
}
