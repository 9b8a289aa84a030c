//! What a reader should know before believing an identified mode.
//!
//! A model has poles that are not those of what was measured: of the filter, of the sampling, of the length of the
//! record, or of an order that is too high. What can be told from the poles alone is told here, in words for a
//! reader; nothing is rejected.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crumple_numerics::lti::{Complex, Mode};
use crumple_signal::Notes;

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
pub fn weak_fit(fit_percent: f64) -> Option<String> {
    (fit_percent < WEAK_FIT_PERCENT).then(|| {
        format!(
            "fit {fit_percent:.1} %, below {WEAK_FIT_PERCENT:.1} %: the model leaves more than half of the record's \
             variance, and its modes say little of the record"
        )
    })
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
    let order = model.order();
    if let Some(gap) = model.chosen {
        let text = format!(
            "{id}: order {order} lies before the largest gap of the singular values, a factor {:.3}",
            gap.ratio
        );
        if gap.ratio < WEAK_GAP {
            notes.warning(format!("{text}: too small to single out an order"));
        } else {
            notes.info(text);
        }
    }
    if let Err(reason) = &model.continuous {
        notes.warning(format!("{id}: no continuous model: {reason}"));
    }
    if model.modes.iter().any(|identified| identified.mode.is_none()) {
        notes.warning(format!("{id}: a pole at z = 0 is a pure delay and has no frequency"));
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
    match &growing[..] {
        [] => {}
        [one] => notes.warning(format!("{model}: the pole {one} grows: the model is unstable")),
        several => notes.warning(format!(
            "{model}: {} poles grow, {}: the model is unstable",
            several.len(),
            several.join(", ")
        )),
    }
    for (pole, kind) in upper() {
        let mode = Mode::continuous(*pole);
        match kind {
            PoleKind::Mode | PoleKind::Real | PoleKind::Growing => mode_caveats(model, &mode, dt_s, edges, &mut notes),
            PoleKind::BeyondNyquist => notes.info(format!(
                "{model}: the pole {} is no mode: it lies at or beyond the Nyquist frequency ({:.4} Hz), an artefact \
                 of sampling or of too high an order",
                describe(&mode),
                0.5 / dt_s
            )),
            PoleKind::Integrator | PoleKind::Cancelled | PoleKind::Harmonic => {}
        }
    }
    match integrators {
        0 => {}
        1 => notes.info(format!(
            "{model}: one pole lies at or near zero: over this record it makes a constant, and is no mode"
        )),
        _ if of_motion => notes.info(format!(
            "{model}: {integrators} poles lie at or near zero: the model integrates the acceleration twice, which is \
             true of any body; they are no modes and tell nothing of stiffness or damping"
        )),
        _ => notes.info(format!(
            "{model}: {integrators} poles lie at or near zero: over this record they make a constant or a trend, and \
             are no modes"
        )),
    }
    notes
}

/// The notes on one mode.
fn mode_caveats(model: &str, mode: &Mode, dt_s: f64, edges: &[FilterEdge], notes: &mut Notes) {
    let name = describe(mode);
    if mode.pole.im.abs() * dt_s > NEAR_NYQUIST * PI {
        notes.warning(format!(
            "{model}: the mode {name} alternates from sample to sample: an artefact of sampling or of too high an order"
        ));
    }
    for FilterEdge { hz: edge, filter } in edges {
        let ratio = mode.natural_frequency_hz() / edge;
        if (1.0 / EDGE_FACTOR..=EDGE_FACTOR).contains(&ratio) {
            notes.warning(format!(
                "{model}: the mode {name} lies near the {edge:.0} Hz edge of the {filter}; it may be a mode of the \
                 filter"
            ));
        }
    }
}

/// `at 13.1 Hz (damping ratio 0.48)`, or the rate of a real pole.
fn describe(mode: &Mode) -> String {
    match mode.damping_ratio {
        Some(_) if mode.pole.im == 0.0 => {
            // Rounding is no sign: -0.0000 is 0.
            let re = if mode.pole.re.abs() < 5e-5 { 0.0 } else { mode.pole.re };
            format!("at {re:.4} 1/s")
        }
        Some(damping) => format!("at {:.2} Hz (damping ratio {damping:.4})", mode.natural_frequency_hz()),
        None => "at 0 Hz".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_is_weak_where_more_than_half_of_the_variance_is_left() {
        let of_errors = |share: f64| 100.0 * (1.0 - share.sqrt());
        assert_eq!(weak_fit(of_errors(0.49)), None);
        assert!(weak_fit(of_errors(0.51)).is_some_and(|text| text.contains("below 29.3 %")));
        assert!(weak_fit(-250.0).is_some());
    }
}
