//! What transfer functions are fitted for and from, and the remarks and the validation that one and several share.

use crumple_numerics::lti::StateSpace;
use crumple_signal::Notes;
use crumple_stage::records::EvidenceV1;
use crumple_sysid::{TransferFunctionOptions, compare, continued, sampled};
use nalgebra::DVector;

use crate::stage::options::input_output::InputOutputSettings;
use crate::stage::options::settings::Settings;
use crate::stage::records::evidence::validate_all;
use crate::stage::waves::Record;

/// What transfer functions are for and from.
pub struct TransferFunctionTask<'a> {
    /// Id of the model.
    pub id: &'a str,
    /// How it was fitted.
    pub options: &'a TransferFunctionOptions,
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// Those beside `era`.
    pub input_output: &'a InputOutputSettings,
    /// The waveforms.
    pub record: &'a Record,
}

/// What was done to the waveforms before the fit.
pub fn preparation(id: &str, record: &Record) -> Notes {
    let mut notes = Notes::new();
    record.remarks.iter().for_each(|remark| notes.info(format!("{id}: {remark}")));
    if let Some(delay_s) = record.delay_s {
        notes.info(format!(
            "{id}: the input acts {delay_s:.6} s late: the coefficients have no delay in them, delay_s and the \
             responses have"
        ));
    }
    notes
}

/// Says so where the fit determines no single coefficient.
pub fn condition_note(id: &str, condition: f64, notes: &mut Notes) {
    if condition > 1e8 {
        notes.warning(format!(
            "{id}: condition number {condition:.1e}: this record does not determine the single coefficients"
        ));
    }
}

/// Puts the fit of the kept samples into the evidence, if there are any.
pub fn validate_continuous(
    task: &TransferFunctionTask<'_>,
    model: &StateSpace,
    initial_estimated: bool,
    evidence: &mut [EvidenceV1],
) -> anyhow::Result<()> {
    let TransferFunctionTask { options, record, .. } = *task;
    if record.outputs[0].kept.is_empty() {
        return Ok(());
    }
    let (model, rest) = sampled(model, options.hold, record.data.sample_time_s())?;
    let (first, whole) = (record.data.delayed(options.delay), record.whole.delayed(options.delay));
    let start = rest * DVector::from_iterator(first.inputs().len(), first.inputs().iter().map(|u| u[0]));
    let simulated = continued(&model, &first, &whole, (!initial_estimated).then_some(start.as_slice()))?;
    validate_all(record, &simulated, evidence);
    // The protocol of published comparisons: the initial state is fitted to the kept samples.
    let restarted = compare(&model, &whole.slice(first.samples(), whole.samples())?)?;
    for (output_evidence, fit) in evidence.iter_mut().zip(restarted) {
        output_evidence.validation_restarted_fit_percent = fit.and_then(|fit| fit.fit_percent);
    }
    Ok(())
}
