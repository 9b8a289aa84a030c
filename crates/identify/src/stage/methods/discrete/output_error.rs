//! The method `output-error`.

use crumple_numerics::lti::Complex;
use crumple_signal::Notes;
use crumple_sysid::{IdentifyError, IoData, OutputErrorOptions, Stop, output_error};

use crate::stage::options::input_output::InputOutputSettings;
use crate::stage::records::discrete_model::DiscreteModel;

/// Output error of one order.
pub fn identify_order(
    order: usize,
    data: &IoData,
    input_output: &InputOutputSettings,
) -> Result<DiscreteModel, IdentifyError> {
    let options = OutputErrorOptions {
        stop: Stop { max_iterations: input_output.most_iterations(), ..Stop::default() },
        ..OutputErrorOptions::new(order)
    };
    let fit = output_error(data, options)?;
    let mut notes = Notes::new();
    let copies = data.inputs().len().min(data.outputs().len());
    if copies > 1 {
        notes.info(format!(
            "all paths share {order} poles, each with a numerator of its own: the model has {} states",
            copies * order
        ));
    }
    let pole_deviations = fit.pole_deviations;
    // The poles of the model are those of the chain, some several times.
    let deviations = move |poles: &[Complex]| {
        let nearest = |z: &Complex| {
            let nearer = |a: &&(Complex, _), b: &&(Complex, _)| (a.0 - z).norm().total_cmp(&(b.0 - z).norm());
            pole_deviations.iter().min_by(nearer).and_then(|(_, deviations)| *deviations)
        };
        poles.iter().map(nearest).collect()
    };
    Ok(DiscreteModel {
        stop_reason: Some(fit.stop_reason.name_with_bounds(fit.on_bound)),
        deviations: Some(Box::new(deviations)),
        condition: Some(fit.condition).filter(|condition| condition.is_finite()),
        losses: fit.losses,
        notes,
        ..DiscreteModel::new(fit.model, fit.criteria.parameters)
    })
}
