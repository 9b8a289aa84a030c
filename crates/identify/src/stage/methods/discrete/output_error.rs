//! The method `output-error`.

use crumple_lti::Complex;
use crumple_signal::Notes;
use crumple_sysid::{IdentifyError, IoData, OutputErrorOptions, Stop, output_error};

use crate::stage::options::input_output::BeyondEra;
use crate::stage::records::discrete_model::Found;

/// Output error of one order.
pub fn of_order(order: usize, data: &IoData, beyond: &BeyondEra) -> Result<Found, IdentifyError> {
    let options = OutputErrorOptions {
        stop: Stop { max_iterations: beyond.most_iterations(), ..Stop::default() },
        ..OutputErrorOptions::new(order)
    };
    let found = output_error(data, options)?;
    let mut notes = Notes::new();
    let copies = data.inputs().len().min(data.outputs().len());
    if copies > 1 {
        notes.info(format!(
            "all paths share {order} poles, each with a numerator of its own: the model has {} states",
            copies * order
        ));
    }
    let known = found.pole_deviations;
    // The poles of the model are those of the chain, some several times.
    let deviations = move |poles: &[Complex]| {
        let nearest = |z: &Complex| {
            let by_distance = |a: &&(Complex, _), b: &&(Complex, _)| (a.0 - z).norm().total_cmp(&(b.0 - z).norm());
            known.iter().min_by(by_distance).and_then(|(_, deviations)| *deviations)
        };
        poles.iter().map(nearest).collect()
    };
    Ok(Found {
        stop_reason: Some(found.termination.name()),
        deviations: Some(Box::new(deviations)),
        condition: Some(found.condition).filter(|condition| condition.is_finite()),
        losses: found.losses,
        notes,
        ..Found::new(found.model, found.criteria.parameters)
    })
}
