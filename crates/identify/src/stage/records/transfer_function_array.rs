//! Continuous transfer functions of several inputs or outputs, and the evidence for them, as records.

use crumple_numerics::lti::Complex;
use crumple_signal::Notes;
use crumple_sysid::TransferFunctionArray;

use crate::stage::records::acceptance::note_on_fit;
use crate::stage::records::evidence::{
    fit_in_words, identification_with_evidence, if_determined, notes_on_poles, pole_record, put_search,
    put_transfer_functions, validation_summary,
};
use crate::stage::records::poles::Poles;
use crate::stage::records::realization::state_space;
use crate::stage::records::responses::note_limits;
use crate::stage::records::results::Results;
use crate::stage::records::transfer_function_task::{
    TransferFunctionTask, condition_note, preparation, validate_continuous,
};

/// Writes the records of one array and a summary line.
pub fn put_array(
    task: &TransferFunctionTask<'_>,
    fit: &TransferFunctionArray,
    notes: &mut Notes,
    results: &mut Results<'_>,
) -> anyhow::Result<()> {
    let TransferFunctionTask { id, settings, input_output, record, .. } = *task;
    notes.extend(preparation(id, record));
    let poles: Vec<Complex> = fit.modes.iter().map(|mode| mode.pole).collect();
    notes.extend(notes_on_poles(id, &poles, &record.waves()));
    notes.info(format!("{id}: one denominator for all paths, a numerator for each"));
    condition_note(id, fit.search.condition, notes);
    for measures in fit.fits.iter().flatten() {
        note_on_fit(id, measures.fit_percent, notes);
    }
    note_limits(id, (record.inputs.len(), record.outputs.len()), settings.bootstrap.as_ref(), notes);
    if settings.bootstrap.is_some() && record.outputs.len() == 1 {
        notes.warning(format!("{id}: no bootstrap: of transfer functions it is made for one input and one output"));
    }
    let entry = |i: usize, j: usize| {
        let tf = &fit.entries[i][j];
        (tf.numerator().to_vec(), tf.denominator().to_vec())
    };
    put_transfer_functions(id, record, entry, results.out)?;
    results.out.put(
        &format!("/model/{id}/continuous"),
        &state_space(&fit.state_space, &record.input(), &record.output(), record.delay_s),
    )?;
    let poles = Poles::of(fit.modes.iter().map(|mode| (*mode, None)), pole_record(&record.waves()));
    poles.put(id, results.out)?;
    let (whole, mut evidence) = identification_with_evidence(
        "tfest",
        input_output.poles,
        record,
        &fit.simulated,
        fit.parameters,
        notes.to_texts(),
    );
    for (output_evidence, deviations) in evidence.iter_mut().zip(&fit.numerator_deviations) {
        put_search(&fit.search, &input_output.hold, settings.paper.as_deref(), output_evidence);
        // Of every input, one after the other.
        output_evidence.numerator_deviations = if_determined(&deviations.concat());
    }
    validate_continuous(task, &fit.state_space, fit.search.initial_estimated, &mut evidence)?;
    let percent = fit_in_words(whole.fit_percent);
    results.out.put(&format!("/identification/{id}"), &whole)?;
    poles.keep_those_of_modes(&mut evidence);
    results.enter(id, &whole, &mut evidence)?;
    results.out.summary(format!(
        "{id}: {percent} of {} samples, {} after {} iterations from start {}{}",
        record.data.samples(),
        fit.search.stop_reason.name_with_bounds(fit.search.on_bound),
        fit.search.iterations,
        fit.search.start.name(),
        validation_summary(&evidence)
    ));
    Ok(())
}
