//! The force on a load-cell barrier, and its impulse against the change of momentum.

use crumple_integrate::{CellSum, Motion, impulse_n_s, sum_of_cells};
use crumple_signal::{Axis, Channel, ChannelStatus, QuantityKind, Sampled, TestDescription};
use crumple_stage::records::MetricV1;
use crumple_stage::{Inputs, Output, RefuseExt};

use crate::options::BarrierCells;

/// Channel name of what is about the barrier as a whole.
const BARRIER: &str = "barrier";
/// Gap of impulse and change of momentum above which something does not fit.
const MOMENTUM_GAP: f64 = 0.05;
/// Names in a note.
const NAMED: usize = 12;

/// The pulse whose change of velocity the impulse is held against.
pub struct Pulse<'a> {
    pub id: &'a str,
    pub motion: &'a Motion,
    pub time_zero_s: f64,
    /// Time of the lowest velocity on the record's axis, if the record shows it.
    pub separation_s: Option<f64>,
}

/// Sums the load cells, writes `/wave/barrier/force` and returns what is to be said of it in numbers.
pub fn barrier(
    cells: BarrierCells,
    input: &Inputs,
    test: &TestDescription,
    pulse: &Pulse<'_>,
    out: &mut Output,
) -> anyhow::Result<Vec<MetricV1>> {
    let listed: Vec<&Channel> = test.channels.iter().filter(|channel| is_cell(channel)).collect();
    let valid = |channel: &&&Channel| matches!(channel.status, ChannelStatus::Valid | ChannelStatus::Computed);
    let summed: Vec<(&str, &Sampled)> = match cells {
        BarrierCells::None => return Ok(Vec::new()),
        BarrierCells::All => waves(input, listed.iter()),
        BarrierCells::Valid => waves(input, listed.iter().filter(valid)),
    };
    let Some(sum) = sum_of_cells(&summed).refuse_with_hint("--barrier-cells none leaves the barrier out")? else {
        return Ok(Vec::new());
    };
    if cells == BarrierCells::Valid {
        let dead: Vec<&str> = listed
            .iter()
            .filter(|channel| channel.status.has_data() && !valid(channel))
            .map(|channel| channel.id.as_str())
            .collect();
        if !dead.is_empty() {
            out.notes().info(format!(
                "barrier force: {} not marked valid by the laboratory, not in the sum: {} (--barrier-cells all takes them as read)",
                count(dead.len()),
                some(&dead)
            ));
        }
    }
    if !sum.off_grid.is_empty() {
        let ids: Vec<&str> = sum.off_grid.iter().map(String::as_str).collect();
        out.notes().warning(format!(
            "barrier force: {} on another time grid, not in the sum: {}",
            count(ids.len()),
            some(&ids)
        ));
    }
    let metrics = momentum(&sum, test.mass_kg, pulse, out);
    out.wave("barrier/force", QuantityKind::Force, sum.force.into_sampled())?;
    Ok(metrics)
}

fn is_cell(channel: &Channel) -> bool {
    channel.quantity == QuantityKind::Force
        && channel.axis.is_none_or(|axis| axis == Axis::X)
        && channel.location.trim().to_lowercase().starts_with(BARRIER)
}

fn waves<'a>(input: &'a Inputs, channels: impl Iterator<Item = &'a &'a Channel>) -> Vec<(&'a str, &'a Sampled)> {
    channels.filter_map(|channel| Some((channel.id.as_str(), &input.wave_if(&channel.id)?.sampled))).collect()
}

/// Up to separation the barrier is what changes the momentum; after it the tyres are, which no cell feels.
fn momentum(sum: &CellSum, mass_kg: Option<f64>, pulse: &Pulse<'_>, out: &mut Output) -> Vec<MetricV1> {
    let metric = |name: &str, value: Option<f64>, unit: &str, definition: &str| MetricV1 {
        name: name.to_owned(),
        value,
        unit: unit.to_owned(),
        channel: BARRIER.to_owned(),
        definition: definition.to_owned(),
        ..MetricV1::default()
    };
    let &Pulse { id, motion, time_zero_s, separation_s } = pulse;
    let over_mass = |impulse: Option<f64>| impulse.zip(mass_kg).map(|(impulse, mass)| impulse / mass);
    let last_s = sum.force.end_s().min(motion.velocity.end_s());
    let end_s = separation_s.unwrap_or(last_s).min(last_s);
    let impulse = impulse_n_s(&sum.force, time_zero_s, sum.force.end_s());
    let whole = over_mass(impulse);
    let of_barrier = over_mass(impulse_n_s(&sum.force, time_zero_s, end_s));
    let of_sensor = motion.velocity.at(time_zero_s).zip(motion.velocity.at(end_s)).map(|(start, end)| start - end);
    let highest = sum.force.samples().iter().copied().reduce(|a, b| if b.abs() > a.abs() { b } else { a });

    let turned = if sum.turned { ", sign turned so that compression is positive" } else { "" };
    out.notes().info(format!("barrier force: sum of {} load cells along x{turned}", sum.cells));
    if let Some(((barrier, whole), sensor)) = of_barrier.zip(whole).zip(of_sensor) {
        let gap = barrier / sensor - 1.0;
        let text = format!(
            "momentum check up to {} at {:.1} ms: impulse of the barrier over the mass {:.2} km/h \
             ({:.2} km/h over the whole record), channel {id} {:.2} km/h, {:+.1} % apart",
            if separation_s.is_some() { "separation" } else { "the end" },
            1e3 * (end_s - time_zero_s),
            3.6 * barrier,
            3.6 * whole,
            3.6 * sensor,
            1e2 * gap
        );
        if gap.abs() <= MOMENTUM_GAP {
            out.notes().info(text);
        } else {
            out.notes().warning(text);
        }
    }
    let no_mass = "absent: the mass is not known";
    let by_mass = if mass_kg.is_some() { "barrier_impulse over the mass" } else { no_mass };
    vec![
        metric(
            "barrier_peak_force",
            highest,
            "N",
            "sample of the sum of the load cells along x with the largest magnitude, positive in compression",
        ),
        metric(
            "barrier_impulse",
            impulse,
            "N*s",
            "integral of the sum of the load cells from time zero to the end of the record, by trapezoid",
        ),
        metric("barrier_delta_v", whole, "m/s", by_mass),
        metric(
            "momentum_ratio",
            of_barrier.zip(of_sensor).map(|(barrier, sensor)| barrier / sensor).filter(|ratio| ratio.is_finite()),
            "1",
            if mass_kg.is_some() {
                "impulse of the barrier up to separation over the mass and the change of velocity of the pulse; 1 if both are right"
            } else {
                no_mass
            },
        ),
    ]
}

fn count(cells: usize) -> String {
    format!("{cells} cell{}", if cells == 1 { "" } else { "s" })
}

fn some(ids: &[&str]) -> String {
    match ids.len().saturating_sub(NAMED) {
        0 => ids.join(", "),
        more => format!("{} and {more} more", ids[..NAMED].join(", ")),
    }
}
