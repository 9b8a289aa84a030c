//! The method `era`: records taken for impulse responses.

use crumple_signal::{About, QuantityKind, Weight, remarks};
use crumple_stage::{Outcome, Output, RefuseExt};
use crumple_sysid::{Era, EraError, EraOptions, MarkovParameters, Order, Realization, caveats, era_order_scan_of};

use crate::stage::methods::discrete::NoModel;
use crate::stage::options::choices::{Method, Paper};
use crate::stage::options::orders::OrderOption;
use crate::stage::options::paper;
use crate::stage::options::paper::AsPrinted;
use crate::stage::options::settings::Settings;
use crate::stage::records::discrete::PartFailed;
use crate::stage::records::evidence::pole_record;
use crate::stage::records::realization;
use crate::stage::records::realization::{RealizationTask, put_realization};
use crate::stage::records::results::Results;
use crate::stage::waves::{ScaledWaves, Source, WindowedWave, channel, filter_edges, flag, waves, widen_the_window};

/// What models of all orders are for and from.
struct EraRun<'a> {
    settings: &'a Settings,
    /// The channels, sampled together.
    waves: &'a [WindowedWave],
    treated_as: &'static str,
    /// Those of a paper, whose models are named so.
    remarks: &'a [&'a str],
    /// They are of a recorder's table, which may have a few rows.
    is_table: bool,
}

/// Whether an error says that a record is too short for a model of the order asked for.
fn is_too_short(error: &EraError) -> bool {
    matches!(error, EraError::TooShort { .. } | EraError::OrderAboveSize { .. })
}

/// Models of every order asked for, or those of the paper.
pub fn run(source: Source<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let settings = source.settings;
    let channels = match &settings.hankel {
        Some(hankel) if !hankel.channels.is_empty() => hankel.channels.clone(),
        _ => vec![channel(source, &format!("name the waveform with {}", flag("outputs")))?.to_owned()],
    };
    let names = channels.join(", ");
    let waves = sampled_together(channels, source)?;
    waves.iter().filter_map(WindowedWave::removed).for_each(|note| results.out.notes().push(note));
    let free = settings.hankel.as_ref().is_some_and(|hankel| hankel.free_decay_share.is_some());
    let treated_as = if free { "free-decay" } else { "impulse-response" };
    if !free {
        let is_pulse = |wave: &&WindowedWave| wave.quantity == QuantityKind::Acceleration && source.is_of_a_crash();
        let pulse = waves.iter().find(is_pulse).map(|wave| wave.id.clone());
        results.out.notes().push(TakenAsImpulse { channels: names.clone(), pulse });
    }
    let is_table = source.test.channels.iter().any(|c| c.quantity == QuantityKind::VelocityChange);
    let task = EraRun { settings, waves: &waves, treated_as, remarks: &[], is_table };
    if settings.paper.is_some() {
        return run_paper(&task, results);
    }
    if let Some(wanted) = &settings.stabilisation {
        let records = ScaledWaves::new(&waves);
        match records.markov().and_then(|m| era_order_scan_of(m, settings.max_order, settings.rows, settings.columns)) {
            Ok(models) => {
                realization::put_diagram(
                    &Method::Era.to_string(),
                    &names,
                    &models,
                    waves[0].sampled.dt_s(),
                    wanted,
                    results.out,
                )?;
            }
            Err(error) if is_table && is_too_short(&error) => {}
            Err(error) => results.out.notes().push(PartFailed::diagram("era", &error)),
        }
    }
    let orders: Vec<Order> = settings.orders.iter().map(|order| order.0).collect();
    realize_all(&task, &orders, &mut Vec::new(), results)
}

/// The window of every waveform. Errors: not sampled together.
fn sampled_together(ids: Vec<String>, source: Source<'_>) -> anyhow::Result<Vec<WindowedWave>> {
    let waves = waves(ids, source)?;
    for next in &waves[1..] {
        let hint = format!("name channels of one time base with {}, or a window that all have", flag("channels"));
        waves[0].require_same_times(next, &hint)?;
    }
    Ok(waves)
}

/// The realisations of the paper: each order from its own number of samples, as far as the record has them.
fn run_paper(task: &EraRun<'_>, results: &mut Results<'_>) -> anyhow::Result<Outcome> {
    let remarks = paper::remarks(Paper::Era);
    remarks.iter().for_each(|remark| results.out.notes().push(AsPrinted::new(remark)));
    let mut outcome = Outcome::Done;
    // A window shorter than the samples of two runs makes one of them.
    let mut written = Vec::new();
    for (order, samples) in paper::ERA_RUNS {
        let shorter: Vec<WindowedWave> = task
            .waves
            .iter()
            .map(|wave| WindowedWave {
                id: wave.id.clone(),
                quantity: wave.quantity,
                sampled: wave.sampled.slice(0, samples),
                kept: Vec::new(),
                edges: wave.edges.clone(),
                removed: wave.removed,
                window_per_s: wave.window_per_s,
            })
            .collect();
        let available = shorter[0].sampled.len();
        if available < samples {
            results.out.notes().push(ShortForPaper { available, samples });
        }
        match realize_all(&EraRun { waves: &shorter, remarks, ..*task }, &[order], &mut written, results)? {
            Outcome::Done => {}
            other => outcome = other,
        }
    }
    Ok(outcome)
}

/// A recorder's table that is too short for a model has none: what it says of the impact is no worse without one.
fn left_out(waves: &[WindowedWave], results: &mut Results<'_>) -> Outcome {
    let rows = waves[0].sampled.len();
    results.out.notes().push(RowsTooFew { rows });
    Outcome::Done
}

/// Models of several orders from one decomposition; `written` are orders and samples of those that are there already.
fn realize_all(
    task: &EraRun<'_>,
    orders: &[Order],
    written: &mut Vec<(usize, usize)>,
    results: &mut Results<'_>,
) -> anyhow::Result<Outcome> {
    let EraRun { settings, waves, treated_as, remarks, is_table } = *task;
    let dt_s = waves[0].sampled.dt_s();
    let records = ScaledWaves::new(waves);
    let decomposed = match decompose(settings, records.slices(), dt_s, orders) {
        Err(error @ EraError::Silent { .. }) => {
            let names: Vec<&str> = waves.iter().map(|wave| wave.id.as_str()).collect();
            return Ok(Outcome::NoAcceptableResult(format!("channel {}: {error}", names.join(", "))));
        }
        Err(error) if is_table && is_too_short(&error) => return Ok(left_out(waves, results)),
        result => {
            let hint = format!("{}, or lower {} and {}", widen_the_window(), flag("rows"), flag("columns"));
            result.refuse_with_hint(hint)?
        }
    };
    let before = written.len();
    let mut failures = Vec::new();
    for &order in orders {
        let model = match realize(&decomposed, order, results.out) {
            Ok(model) => records.unscaled(model),
            Err(error) => {
                failures.push((order, error));
                continue;
            }
        };
        let made = (model.order(), waves[0].sampled.len());
        if written.contains(&made) {
            continue;
        }
        written.push(made);
        let realized_order = Order::Given(model.order());
        // A Hankel matrix sized by the order asked for stays as it was.
        let sizing_order = if matches!(decomposed, Decomposed::Sized(_)) { order } else { realized_order };
        let refit = |y: &[Vec<f64>]| {
            let divided = records.divided(y);
            let slices = divided.iter().map(Vec::as_slice).collect();
            Some(
                records
                    .unscaled(decompose(settings, slices, dt_s, &[sizing_order]).ok()?.realize(realized_order).ok()?),
            )
        };
        let realization = RealizationTask {
            method: Method::Era,
            waves,
            treated_as,
            bootstrap: settings.bootstrap.as_ref(),
            paper: !remarks.is_empty(),
            refit: &refit,
        };
        let record = pole_record(&[&waves[0]]);
        let mut notes = caveats(&realization.id(model.order()), &model, record, filter_edges(waves));
        remarks.iter().for_each(|remark| notes.push(AsPrinted::new(remark)));
        put_realization(&model, &realization, notes, results)?;
    }
    let mut failures = failures.into_iter();
    // Where there is no model the first failure is the answer.
    let answer = if written.len() == before { failures.next() } else { None };
    for (order, error) in failures {
        let (method, what) = (Method::Era.to_string(), format!("era of order {}", OrderOption(order)));
        results.out.notes().push(NoModel { method, what, reason: error.to_string() });
    }
    if let Some((_, error)) = answer {
        if is_table && is_too_short(&error) {
            return Ok(left_out(waves, results));
        }
        return Err(error).refuse_with_hint(format!("lower {}, or {}", flag("orders"), widen_the_window()));
    }
    Ok(Outcome::Done)
}

/// What models of all orders follow from.
enum Decomposed<'a> {
    /// One decomposition of the record.
    Whole(Box<Era<'a>>),
    /// One for every order, by the size of it.
    Sized(Vec<(Order, Era<'a>)>),
}

impl Decomposed<'_> {
    fn realize(&self, order: Order) -> Result<Realization, EraError> {
        match self {
            Self::Whole(era) => era.realize(order),
            Self::Sized(all) => {
                let sized = all.iter().find(|(sized_for, _)| *sized_for == order).or(all.first());
                sized.map_or(Err(EraError::OrderZero), |(_, era)| era.realize(order))
            }
        }
    }
}

fn decompose<'a>(
    settings: &Settings,
    samples: Vec<&'a [f64]>,
    dt_s: f64,
    orders: &[Order],
) -> Result<Decomposed<'a>, EraError> {
    let options = EraOptions {
        max_order: settings.max_order,
        rows: settings.rows,
        columns: settings.columns,
        ..EraOptions::new(dt_s)
    };
    let markov = MarkovParameters::new(samples, 1)?;
    match &settings.hankel {
        Some(hankel) if hankel.twice_the_order => {
            let mut all = Vec::with_capacity(orders.len());
            for &order in orders {
                let options = match order {
                    Order::Given(n) => options.twice_the_order(n),
                    Order::Automatic => options.twice_the_order(settings.max_order),
                };
                all.push((order, Era::from_markov(markov.clone(), options, &[order])?));
            }
            Ok(Decomposed::Sized(all))
        }
        _ => Ok(Decomposed::Whole(Box::new(Era::from_markov(markov, options, orders)?))),
    }
}

/// The model of one order. Where the record has less in it, the model of the highest order that it has, with a note.
fn realize(era: &Decomposed<'_>, order: Order, out: &mut Output) -> Result<Realization, EraError> {
    match era.realize(order) {
        Err(error @ EraError::OrderAboveRank { rank, .. }) if rank > 0 => {
            out.notes().push(RankUsed { reason: error.to_string(), rank });
            match era {
                Decomposed::Sized(all) => {
                    let sized = all.iter().find(|(sized_for, _)| *sized_for == order);
                    sized.map_or(Err(error), |(_, era)| era.realize(Order::Given(rank)))
                }
                _ => era.realize(Order::Given(rank)),
            }
        }
        result => result,
    }
}

remarks! {
    /// Remarks of era.
    pub REMARKS;

    /// A record is taken for an impulse response.
    CR437 TakenAsImpulse { channels: String, pulse: Option<String> }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The method era does it, unless --free-decay starts the window behind the contact."
    means "Poles and modes hold where nothing drives the system. B, C and D have no physical meaning. Poles of a pulse \
           may be those of its filter and of its shape (docs/methods/era.md)."
    remedy "nothing; tfest, n4sid and others take the input into account, --free-decay starts behind the contact"
    says {
        let pulse = pulse.as_ref().map_or(
            "",
            |_| "; of a crash pulse the strongest poles are often those of its filter and of its shape, not of the car",
        );
        format!("era: {channels} is treated as an impulse response{pulse}")
    };

    /// The window has fewer samples than the procedure of the paper takes.
    CR438 ShortForPaper { available: usize, samples: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "--paper era takes two states from 100 and from 50 samples, four from 60 and from 2501."
    means "The model is made from all samples of the window. It is not comparable with the one of the paper."
    remedy "widen the window: --from, --to"
    says format!("paper era: the window has {available} samples, not {samples}");

    /// The table of an event data recorder has too few rows for a model of era.
    CR439 RowsTooFew { rows: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "The Hankel matrix of the order asked for has more rows and columns than the table can fill."
    means "There is no model of era. Delta-v and the pulse of the recorder are not touched by it."
    remedy "nothing; --orders 2 needs fewer rows"
    says format!("era is left out: {rows} rows of a recorder are too few for a model");

    /// The record shows fewer states than the order asked for: a lower order is used.
    CR440 RankUsed { reason: String, rank: usize }
    bears on (About::IdentifiedModels, Weight::None)
    decided "Singular values below 1e-12 of the largest are rounding. Their number is the highest order."
    means "The model of the lower order follows the record as well as numbers of the computer can."
    remedy "nothing; such a record is made, or has a few samples only"
    says format!("{reason}: order {rank} is used, which follows the record to rounding");
}
