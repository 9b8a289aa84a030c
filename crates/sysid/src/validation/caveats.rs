//! What a reader should know before believing an identified mode.
//!
//! A model has poles that are not those of what was measured: of the filter, of the sampling, of the length of the
//! record, or of an order that is too high. What can be told from the poles alone is told here, in words for a
//! reader; nothing is rejected.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crumple_numerics::lti::{Complex, Mode};
use crumple_signal::{About, Notes, Weight, remarks};

use crate::Realization;
use crate::modes::{PoleKind, PoleRecord, pole_kinds};

/// A mode within this factor of the filter's edge may be the filter's own.
const EDGE_FACTOR: f64 = 2.0;

/// Fraction of the Nyquist frequency above which an oscillation is an artefact of sampling.
const NEAR_NYQUIST: f64 = 0.95;

/// A gap between singular values below this ratio does not single out an order.
const WEAK_GAP: f64 = 3.0;

/// Growth of a pole over the whole record below which it is rounding: an integrator's pole is never exactly zero.
const GROWTH: f64 = 1e-6;

/// Fit, percent, below which a model leaves more than half of the variance of the record: `100 (1 - sqrt(1/2))`.
const WEAK_FIT_PERCENT: f64 = 100.0 * (1.0 - FRAC_1_SQRT_2);

/// What to say of a fit below 29.3 %, where the errors of a model have more than half of the variance of the record:
/// that its modes are not the record's. `None` above.
pub fn weak_fit(fit_percent: f64) -> Option<WeakFit> {
    (fit_percent < WEAK_FIT_PERCENT).then_some(WeakFit { fit_percent, limit_percent: WEAK_FIT_PERCENT })
}

/// A frequency at which a filter that the signals went through leaves 1/√2 of the amplitude (-3 dB).
#[derive(Debug, Clone, PartialEq)]
pub struct FilterEdge {
    /// The frequency, Hz.
    pub hz: f64,
    /// The filter in words, e.g. `CFC 60 filter`.
    pub filter: String,
}

impl FilterEdge {
    /// Edge of a channel frequency class: the corner of SAE J211-1 lies at `CFC/0.6` (CFC 60: 100 Hz).
    pub fn of_class(cfc: u16) -> Self {
        Self { hz: f64::from(cfc) / 0.6, filter: format!("CFC {cfc} filter") }
    }
}

/// Notes on the realisation `id`: on its poles ([`pole_notes`]), and on a weakly founded order. `edges` are
/// those of the filter that the `record` went through.
pub fn caveats(id: &str, model: &Realization, record: PoleRecord, edges: &[FilterEdge]) -> Notes {
    let mut notes = Notes::new();
    if let Some(gap) = model.chosen {
        let (model, order, ratio) = (id.to_owned(), model.order(), gap.ratio);
        if ratio < WEAK_GAP {
            notes.push(WeakGap { model, order, ratio });
        } else {
            notes.push(OrderByGap { model, order, ratio });
        }
    }
    if let Err(reason) = &model.continuous {
        notes.push(NoContinuousModel { model: id.to_owned(), reason: reason.to_string() });
    }
    if model.modes.iter().any(|identified| identified.mode.is_none()) {
        notes.push(PureDelay { model: id.to_owned() });
    }
    let poles: Vec<Complex> = model.modes.iter().filter_map(|identified| Some(identified.mode?.pole)).collect();
    notes.extend(pole_notes(id, &poles, record, edges));
    notes
}

/// Notes on single poles of a model of any method: which are no modes, growth by more than rounding, artefacts of
/// sampling, and frequencies near the `edges` of the filter that the signals went through. Of a conjugate pair the
/// upper one speaks; of integrators neither, for which of them seems to grow is noise.
pub fn pole_notes(model: &str, poles: &[Complex], record: PoleRecord, edges: &[FilterEdge]) -> Notes {
    let mut notes = Notes::new();
    let PoleRecord { dt_s, duration_s, of_motion, window_per_s } = record;
    let poles: Vec<Complex> = poles.iter().map(|pole| pole + window_per_s).collect();
    let kinds = pole_kinds(&poles, record);
    let integrators = kinds.iter().filter(|kind| **kind == PoleKind::Integrator).count();
    let grows = |(pole, kind): &(&Complex, &PoleKind)| pole.re * duration_s > GROWTH && **kind != PoleKind::Integrator;
    let upper = || poles.iter().zip(&kinds).filter(|(pole, _)| pole.im >= 0.0);
    let growing: Vec<String> = upper().filter(grows).map(|(pole, _)| describe(&Mode::continuous(*pole))).collect();
    if !growing.is_empty() {
        notes.push(Grows { model: model.to_owned(), poles: growing });
    }
    for (pole, kind) in upper() {
        let mode = Mode::continuous(*pole);
        match kind {
            PoleKind::Mode | PoleKind::Real | PoleKind::Growing => mode_caveats(model, &mode, dt_s, edges, &mut notes),
            PoleKind::BeyondNyquist => notes.push(BeyondNyquist {
                model: model.to_owned(),
                frequency_hz: mode.natural_frequency_hz(),
                damping_ratio: mode.damping_ratio,
                rate_per_s: rate_per_s(&mode),
                nyquist_hz: 0.5 / dt_s,
            }),
            PoleKind::Integrator | PoleKind::Cancelled | PoleKind::Harmonic => {}
        }
    }
    if integrators > 0 {
        let of_motion = if of_motion && integrators > 1 { integrators } else { 0 };
        // As it is said.
        let over_s = (duration_s * 1e4).round() / 1e4;
        notes.push(NearZero { model: model.to_owned(), poles: integrators, of_motion, over_s });
    }
    notes
}

/// The notes on one mode.
fn mode_caveats(model: &str, mode: &Mode, dt_s: f64, edges: &[FilterEdge], notes: &mut Notes) {
    let (frequency_hz, damping_ratio) = (mode.natural_frequency_hz(), mode.damping_ratio);
    if mode.pole.im.abs() * dt_s > NEAR_NYQUIST * PI {
        notes.push(Alternates { model: model.to_owned(), frequency_hz, damping_ratio });
    }
    for FilterEdge { hz: edge_hz, filter } in edges {
        if (1.0 / EDGE_FACTOR..=EDGE_FACTOR).contains(&(frequency_hz / edge_hz)) {
            notes.push(NearFilterEdge {
                model: model.to_owned(),
                frequency_hz,
                damping_ratio,
                rate_per_s: rate_per_s(mode),
                edge_hz: *edge_hz,
                filter: filter.clone(),
            });
        }
    }
}

/// `at 13.1 Hz (damping ratio 0.48)`, or the rate of a real pole.
fn describe(mode: &Mode) -> String {
    place(mode.natural_frequency_hz(), mode.damping_ratio, rate_per_s(mode))
}

/// The same from its numbers.
fn place(frequency_hz: f64, damping_ratio: Option<f64>, rate_per_s: Option<f64>) -> String {
    match (rate_per_s, damping_ratio) {
        (Some(rate_per_s), _) => format!("at {rate_per_s:.4} 1/s"),
        (None, Some(damping)) => format!("at {frequency_hz:.2} Hz (damping ratio {damping:.4})"),
        (None, None) => "at 0 Hz".to_owned(),
    }
}

/// The rate of a real pole other than zero. Rounding is no sign: -0.0000 is 0.
fn rate_per_s(mode: &Mode) -> Option<f64> {
    let re = if mode.pole.re.abs() < 5e-5 { 0.0 } else { mode.pole.re };
    mode.damping_ratio.filter(|_| mode.pole.im == 0.0).map(|_| re)
}

remarks! {
    /// Remarks of identified models of any method.
    pub REMARKS;

    /// The order of the model was chosen by the largest gap between the singular values.
    CR405 OrderByGap { model: String, order: usize, ratio: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Order auto of era takes the largest ratio of neighbouring singular values above the noise: here 3 or more."
    means "The record shows about as many states as the model has."
    remedy "nothing; --orders takes another number of states"
    says format!("{model}: order {order} lies before the largest gap of the singular values, a factor {ratio:.3}");

    /// The singular values fall smoothly: no order stands out.
    CR406 WeakGap { model: String, order: usize, ratio: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "Order auto of era takes the largest ratio of neighbouring singular values above the noise: here below 3."
    means "Another order is as good. Poles that only this order has are not those of the record."
    remedy "compare several orders, e.g. --orders 2,4,6 or --stabilisation, and use the poles that stay"
    says format!(
        "{model}: order {order} lies before the largest gap of the singular values, a factor {ratio:.3}: too small to \
         single out an order"
    );

    /// A sampled model has no continuous form.
    CR407 NoContinuousModel { model: String, reason: String }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The continuous form is the logarithm of the sampled one (docs/methods/era.md). A pole at z = 0, or a \
             negative real one, has none; the sentence says what is in the way."
    means "The sampled model and its poles hold. There is no continuous state space and no transfer function."
    remedy "try a lower order: --orders; such a pole often comes from too high an order"
    says format!("{model}: no continuous model: {reason}");

    /// A pole of the sampled model is zero.
    CR408 PureDelay { model: String }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The pole is z = 0 in the sampled model. Its logarithm, which would be the frequency, does not exist."
    means "The pole delays the response by one sample. It is not among the modes."
    remedy "try a lower order: --orders"
    says format!("{model}: a pole at z = 0 is a pure delay and has no frequency");

    /// Poles of the model grow.
    CR409 Grows { model: String, poles: Vec<String> }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The real part of the pole times the length of the record is above 1e-6. Smaller growth is rounding."
    means "The model follows this window only. Its motion after the window has no bound."
    remedy "try a lower order: --orders; for tfest --stable keeps poles from growing"
    says match &poles[..] {
        [one] => format!("{model}: the pole {one} grows: the model is unstable"),
        several => format!("{model}: {} poles grow, {}: the model is unstable", several.len(), several.join(", ")),
    };

    /// A pole is faster than the sampling: it is no mode.
    CR410 BeyondNyquist {
        model: String, frequency_hz: f64, damping_ratio: Option<f64>, rate_per_s: Option<f64>, nyquist_hz: f64
    }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The modulus of the pole is pi/dt rad/s or more, which is the Nyquist frequency."
    means "Nobody sees what it does between two samples. It is listed among the other poles, not among the modes."
    remedy "nothing; a lower order may do without it: --orders"
    says format!(
        "{model}: the pole {} is no mode: it lies at or beyond the Nyquist frequency ({nyquist_hz:.4} Hz), an artefact \
         of sampling or of too high an order",
        place(*frequency_hz, *damping_ratio, *rate_per_s)
    );

    /// A mode changes its sign at nearly every sample.
    CR411 Alternates { model: String, frequency_hz: f64, damping_ratio: Option<f64> }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The frequency of the oscillation is above 95 % of the Nyquist frequency."
    means "It is an artefact of sampling or of too high an order. Nothing that was measured oscillates so."
    remedy "leave this mode out, or try a lower order: --orders"
    says format!(
        "{model}: the mode {} alternates from sample to sample: an artefact of sampling or of too high an order",
        place(*frequency_hz, *damping_ratio, None)
    );

    /// A mode lies near the edge of the filter that the record went through.
    CR412 NearFilterEdge {
        model: String, frequency_hz: f64, damping_ratio: Option<f64>, rate_per_s: Option<f64>, edge_hz: f64,
        filter: String
    }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The natural frequency is within a factor of two of the -3 dB frequency of the filter. Of a channel \
             frequency class that is CFC/0.6 (SAE J211-1)."
    means "The filter has poles too. This mode may be one of them, and not one of the structure."
    remedy "identify from the unfiltered record (1-ingest.mcap) too, and use the modes that stay"
    says format!(
        "{model}: the mode {} lies near the {edge_hz:.0} Hz edge of the {filter}; it may be a mode of the filter",
        place(*frequency_hz, *damping_ratio, *rate_per_s)
    );

    /// Poles at or near zero make a constant or a trend over the record.
    CR413 NearZero { model: String, poles: usize, of_motion: usize, over_s: f64 }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The modulus of the pole times the length of the part identified is below 0.1. The limit is 0.5 where \
             two poles or more lead from an acceleration to a displacement: noise parts a double pole further."
    means "They are no modes. From an acceleration to its own displacement they are the double integration: they are \
           true of any body and tell nothing of stiffness or damping."
    remedy "nothing; stiffness and damping need an input and an output at two places: --inputs, --outputs"
    says match (poles, of_motion) {
        (1, _) => format!(
            "{model}: one pole lies at or near zero: over the {over_s} s identified it makes a constant, and is no mode"
        ),
        (_, 0) => format!(
            "{model}: {poles} poles lie at or near zero: over the {over_s} s identified they make a constant or a \
             trend, and are no modes"
        ),
        _ => format!(
            "{model}: {poles} poles lie at or near zero: the model integrates the acceleration twice, which is true \
             of any body; they are no modes and tell nothing of stiffness or damping"
        ),
    };

    /// The model leaves more than half of the variance of the record.
    CR414 WeakFit { fit_percent: f64, limit_percent: f64 }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The fit of the simulated output is below 29.3 %, which is 100 (1 - sqrt(1/2)): the errors have more than \
             half of the variance."
    means "Modes of this model are not those of the record. Do not use it."
    remedy "try another order, method, input or window: --orders, --methods, --inputs, --from, --to"
    says format!(
        "fit {fit_percent:.1} %, below {limit_percent:.1} %: the model leaves more than half of the record's variance, \
         and its modes say little of the record"
    );
}

#[cfg(test)]
mod tests {
    use crumple_signal::Note;

    use super::*;

    #[test]
    fn a_fit_is_weak_where_more_than_half_of_the_variance_is_left() {
        let of_errors = |share: f64| 100.0 * (1.0 - share.sqrt());
        assert!(weak_fit(of_errors(0.49)).is_none());
        let weak = weak_fit(of_errors(0.51)).map(Note::from);
        assert!(weak.is_some_and(|note| note.text.contains("below 29.3 %")));
        assert!(weak_fit(-250.0).is_some());
    }
}
