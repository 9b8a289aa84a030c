//! The method `arx`: of an order, of a structure, or of the best structure of a scan.

use crumple_signal::{About, Note, Weight, remarks};
use crumple_stage::records::{ArxScanModelV1, ArxScanV1, ScanEdgeV1};
use crumple_stage::{Outcome, Output, RefuseExt, Refused};
use crumple_sysid::{Arx, ArxOrder, IdentifyError, IoData, arx, arx_scan, fit_measures, simulate_fitted};

use crate::stage::methods::discrete::{MethodRun, ModelRequest, StatesOfPaths};
use crate::stage::options::choices::Method;
use crate::stage::options::orders::ArxRanges;
use crate::stage::records::discrete::{Deviations, DiscreteModel};
use crate::stage::records::evidence::NamedNumbers;
use crate::stage::records::results::Results;
use crate::stage::waves::{Record, Source, flag, widen_the_window};

/// What to do about a regression that does not work.
fn hint() -> String {
    let (orders, scan) = (flag("arx-orders"), flag("arx-scan"));
    format!("lower the numbers of {orders} or {scan}, {}, or name other waveforms", widen_the_window())
}

/// ARX of an order `n`: `n` past outputs, `n + 1` inputs from the same sample on; of several outputs as many lags of
/// all as make `n` states.
pub fn identify_order(order: usize, data: &IoData) -> Result<DiscreteModel, IdentifyError> {
    let outputs = data.outputs().len();
    let lags = order.div_ceil(outputs);
    let mut model = identify_structure(ArxOrder { na: lags, nb: lags + 1, nk: 0 }, data)?;
    if outputs > 1 {
        let (lags, outputs, states) = (Some(lags), Some(outputs), Some(lags * outputs));
        model.notes.push(StatesOfPaths { poles: None, lags, outputs, states });
    }
    Ok(model)
}

/// ARX of a structure.
fn identify_structure(order: ArxOrder, data: &IoData) -> Result<DiscreteModel, IdentifyError> {
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let ArxOrder { na, nb, .. } = order;
    let model = arx(data, order)?;
    let states = model.state_space()?;
    // The initial state is fitted for the simulation.
    let parameters = q * (na * q + nb * m) + states.order();
    let discrete = DiscreteModel {
        predicted: model.predict(data),
        predicted_from: order.states(),
        coefficients: (0..q).map(|output| coefficients(&model, output)).collect(),
        ..DiscreteModel::new(states, parameters)
    };
    let deviations: Deviations = Box::new(move |poles| model.mode_deviations(poles));
    Ok(DiscreteModel { deviations: (q == 1).then_some(deviations), ..discrete })
}

/// Coefficients of the equation of one output, `y[k] + a_1 y[k-1] + ... = b_nk u[k-nk] + ...`: `a_<lag>`, `b_<lag>`,
/// with the number of the signal behind the letter where there are several, `a2_1`.
fn coefficients(model: &Arx, output: usize) -> NamedNumbers {
    let (mut names, mut values) = (Vec::new(), Vec::new());
    for (letter, first, matrices) in [("a", 1, &model.a), ("b", model.order.nk, &model.b)] {
        for (lag, matrix) in (first..).zip(matrices) {
            for (place, value) in matrix.row(output).iter().enumerate() {
                let number = if matrix.ncols() > 1 { (place + 1).to_string() } else { String::new() };
                names.push(format!("{letter}{number}_{lag}"));
                values.push(*value);
            }
        }
    }
    NamedNumbers { names, values, covariance: model.covariance(output) }
}

/// The structures asked for, and the best of the scan.
pub fn run(source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let Some(input_output) = &source.settings.input_output else { return Ok(Outcome::Done) };
    let all = MethodRun::new(Method::Arx, source, input_output, hint())?;
    let mut structures: Vec<(ArxOrder, Option<Note>)> =
        input_output.arx_orders.iter().map(|structure| (structure.0, None)).collect();
    if let Some(ranges) = &input_output.arx_scan {
        let best = scan(ranges, &all.record, &all.data, results.out)?;
        let remark = Some(BestOfScan { ranges: ranges.to_string() }.into());
        match structures.iter_mut().find(|(order, _)| *order == best) {
            Some((_, known)) => *known = remark,
            None => structures.push((best, remark)),
        }
    }
    let requests: Vec<ModelRequest<'_>> = structures
        .into_iter()
        .map(|(order, remark)| ModelRequest {
            id: id_of(&order),
            order: order.states(),
            identify: Box::new(move |data, _| identify_structure(order, data)),
            remark,
        })
        .collect();
    all.put_all(&requests, results)
}

fn id_of(order: &ArxOrder) -> String {
    format!("arx-{}-{}-{}", order.na, order.nb, order.nk)
}

/// Writes the table of a scan and returns the structure with the smallest BIC.
fn scan(ranges: &ArxRanges, record: &Record, data: &IoData, out: &mut Output) -> anyhow::Result<ArxOrder> {
    if data.outputs().len() != 1 {
        return Err(Refused::new(format!(
            "a scan of arx structures has one output, {} are named",
            data.outputs().len()
        ))
        .hint(format!("name one of {}, or give {}", flag("outputs"), flag("arx-orders")))
        .into());
    }
    let orders = ranges.all();
    let fits = arx_scan(data, &orders);
    let rows = fits.iter().flatten().map(|(model, _)| model.rows).next();
    let without = fits.iter().filter(|result| result.is_err()).count();
    if let Some(Err(error)) = fits.iter().find(|result| result.is_err())
        && without < orders.len()
    {
        let (structures, reason) = (orders.len(), error.to_string());
        out.notes().push(StructuresLeftOut { without, structures, reason });
    }
    let models: Vec<ArxScanModelV1> = orders
        .iter()
        .zip(&fits)
        .map(|(order, result)| {
            let finite = |x: f64| x.is_finite().then_some(x);
            let criteria = result.as_ref().ok().map(|(_, criteria)| criteria);
            ArxScanModelV1 {
                past_outputs: order.na as u64,
                inputs: order.nb as u64,
                delay: order.nk as u64,
                parameters: (order.na + order.nb * data.inputs().len()) as u64,
                loss: criteria.and_then(|c| finite(c.loss)),
                aicc: criteria.and_then(|c| finite(c.aicc)),
                bic: criteria.and_then(|c| finite(c.bic)),
                mdl: criteria.and_then(|c| finite(c.mdl)),
                fit_percent: result.as_ref().ok().and_then(|(model, _)| simulation_fit(model, data)),
                failure: result.as_ref().err().map(ToString::to_string),
            }
        })
        .collect();
    let smallest = |of: fn(&ArxScanModelV1) -> Option<f64>| {
        let known = models.iter().enumerate().filter_map(|(k, model)| Some((k, of(model)?)));
        known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    };
    let name = |k: usize| id_of(&orders[k]);
    let (by_bic, by_aicc) = (smallest(|model| model.bic), smallest(|model| model.aicc));
    let output = record.outputs[0].id.clone();
    let at_edge = by_bic.map_or_else(Vec::new, |best| ranges.edges(&orders[best]));
    if let (Some(best), false) = (by_bic, at_edge.is_empty()) {
        let names = at_edge.iter().map(|edge| match edge {
            ScanEdgeV1::PastOutputs => "past outputs",
            ScanEdgeV1::Inputs => "inputs",
            ScanEdgeV1::Delay => "delay",
        });
        let (numbers, ranges) = (names.map(str::to_owned).collect(), ranges.to_string());
        out.notes().push(ScanAtEdge { structure: name(best), ranges, numbers });
    }
    out.put(
        &format!("/scan/{output}"),
        &ArxScanV1 {
            input: record.inputs.iter().map(|wave| wave.id.clone()).collect::<Vec<_>>().join(", "),
            output,
            samples: rows.unwrap_or(0) as u64,
            models,
            best_by_bic: by_bic.map(name),
            best_by_aicc: by_aicc.map(name),
            at_edge,
        },
    )?;
    match (by_bic, fits.into_iter().find_map(Result::err)) {
        (Some(best), _) => {
            out.summary(format!(
                "arx scan of {} structures: {} by BIC, {} by AICc",
                orders.len(),
                name(best),
                by_aicc.map_or("none".to_owned(), name)
            ));
            Ok(orders[best])
        }
        (None, Some(error)) => Err(error).refuse_with_hint(hint()),
        (None, None) => Err(Refused::new("the scan of arx structures is empty").hint(hint()).into()),
    }
}

/// Fit of the simulated output, percent; `None` for a model that cannot be simulated.
fn simulation_fit(model: &Arx, data: &IoData) -> Option<f64> {
    let simulated = simulate_fitted(&model.state_space().ok()?, data).ok()?.0;
    fit_measures(&data.outputs()[0], &simulated[0])?.fit_percent
}

remarks! {
    /// Remarks of scans of structures.
    pub REMARKS;

    /// Structures of a scan have no model.
    CR428 StructuresLeftOut { without: usize, structures: usize, reason: String }
    bears on (About::IdentifiedModels, Weight::Slight)
    decided "The regression of each structure is solved on the same samples; the sentence has the first reason."
    means "The smallest BIC is that of the structures that are left. The table /scan names the others with their \
           reasons."
    remedy "lower the numbers of --arx-scan, or widen the window: --from, --to"
    says format!(
        "arx scan: {without} of {structures} structures have no model and are left out, the first because: {reason}"
    );

    /// The best structure of a scan stands at the end of a range.
    CR429 ScanAtEdge { structure: String, ranges: String, numbers: Vec<String> }
    bears on (About::Method(Method::Arx.to_string()), Weight::Marked)
    decided "One of its numbers is the first or the last of a range that could go on."
    means "The scan did not look beyond. A structure outside of the ranges may have a smaller BIC."
    remedy "widen the ranges: --arx-scan=1-8,1-8,0-12"
    says format!(
        "arx scan: {structure} is at the edge of the ranges {ranges} with its {}: a wider --arx-scan may find a better \
         one",
        numbers.join(" and its ")
    );

    /// A structure was chosen by a scan.
    CR430 BestOfScan { ranges: String }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The smallest BIC of the one-step prediction, all structures on the same samples."
    means "It predicts one step best. Another structure may simulate better."
    remedy "nothing; the table /scan has the fit of every simulation, --arx-orders takes another structure"
    says format!("the smallest BIC of the one-step prediction over the structures {ranges}, see /scan");
}
