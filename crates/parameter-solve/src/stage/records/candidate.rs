//! A candidate as the artifact and a person get it.

use crumple_lumped::{ParameterKind, parameter_kind};
use crumple_lumped_fit::{Candidate, Fit, SensorFit};
use crumple_stage::records::{CandidateV1, FitV1, SensorFitV1};

use crate::stage::assess::candidate_assessment::CandidateAssessment;
use crate::stage::records::uncertainty::{uncertainty_of_fit, uncertainty_record};

/// What goes to `/parameters/<id>`.
pub fn record(candidate: &Candidate, assessed: Option<&CandidateAssessment>, channel: &str) -> CandidateV1 {
    CandidateV1 {
        model: candidate.model.kind().name().to_owned(),
        method: candidate.method.name().to_owned(),
        parameters: candidate.model.parameters(),
        physical: candidate.model.is_physical(),
        equivalent_to: candidate.equivalent_id(),
        fit: candidate.fit.as_ref().map(|fit| fit_record(fit, channel)),
        uncertainty: assessed
            .map(uncertainty_record)
            .or_else(|| candidate.uncertainty.as_ref().map(|u| uncertainty_of_fit(u, &candidate.model))),
        notes: candidate.notes.iter().map(ToString::to_string).collect(),
    }
}

/// How a candidate was fitted, to sensors of which `channel` is the pulse.
pub fn fit_record<N: ToString>(fit: &Fit<N>, channel: &str) -> FitV1 {
    let sensor = |sensor: &SensorFit| SensorFitV1 {
        channel: sensor.channel.clone(),
        mass: sensor.mass as u32,
        quantity: sensor.quantity.name().to_owned(),
        rmse: sensor.rmse,
        noise: sensor.noise,
    };
    FitV1 {
        channel: channel.to_owned(),
        quantity: fit.quantity.name().to_owned(),
        from_s: fit.from_s,
        to_s: fit.to_s,
        samples: fit.samples as u64,
        rmse: fit.rmse,
        iterations: fit.iterations,
        evaluations: fit.evaluations,
        stop_reason: fit.stop_reason.name().to_owned(),
        active_bounds: fit.active_bounds.iter().map(N::to_string).collect(),
        sensors: fit.sensors.iter().map(sensor).collect(),
    }
}

/// `kelvin/closed-form/1: stiffness 321.9 kN/m, ...` in the units of the trade, and how many of them the record leaves
/// open.
pub fn parameters_line(id: &str, candidate: &CandidateV1) -> String {
    let open = match (candidate.undetermined().len(), candidate.asked().count()) {
        (0, _) => String::new(),
        (n, of) => format!("; {n} of {of} not determined"),
    };
    let parameters: Vec<String> = candidate
        .parameters
        .iter()
        .map(|(name, value)| {
            let kind = parameter_kind(&candidate.model, name).unwrap_or(ParameterKind::Mass);
            let symbol = kind.symbol_of(name);
            match kind {
                ParameterKind::Damping => format!("{symbol} {:.3} kN s/m", value / 1e3),
                ParameterKind::Stiffness => format!("{symbol} {:.2} kN/m", value / 1e3),
                ParameterKind::Rate => format!("{symbol} {value:.3} m/s"),
                ParameterKind::Force => format!("{symbol} {:.1} kN", value / 1e3),
                ParameterKind::RateFactor => format!("{symbol} {value:.4} s/m"),
                ParameterKind::Length => format!("{symbol} {:.1} mm", 1e3 * value),
                ParameterKind::Mass => format!("{symbol} {value:.1} kg"),
            }
        })
        .map(|text| text.replace('_', " "))
        .collect();
    format!("{id}: {}{open}", parameters.join(", "))
}
