//! The force on a load-cell barrier, and its impulse against the change of momentum.

use crumple_integrate::{CellSum, impulse_n_s, sum_of_cells};
use crumple_metrics::definitions::{
    BARRIER_DELTA_V, BARRIER_DELTA_V_AS_READ, BARRIER_IMPULSE, BARRIER_PEAK, KW400, MOMENTUM_RATIO,
    WALL_INITIAL_STIFFNESS,
};
use crumple_metrics::{KW400_TO_M, Metric, wall_stiffness};
use crumple_signal::{About, Axis, Channel, ChannelStatus, Motion, QuantityKind, Sampled, TestDescription, Weight};
use crumple_stage::records::{ChannelFilterV1, MetricV1};
use crumple_stage::{Inputs, Output, RefuseExt};

use crate::stage::metric_record::metric_record;
use crate::stage::options::BarrierCells;

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
                "barrier force: {} not marked valid by the laboratory, not in the sum: {} (crumple-integrate \
                 --barrier-cells all takes them as read)",
                count(dead.len()),
                some(&dead)
            ));
        }
    }
    if !sum.off_grid.is_empty() {
        let ids: Vec<&str> = sum.off_grid.iter().map(String::as_str).collect();
        out.notes().concern(
            About::WallForce,
            Weight::Marked,
            format!("barrier force: {} on another time grid, not in the sum: {}", count(ids.len()), some(&ids)),
        );
    }
    let as_read = as_read(input, &waves(input, listed.iter()), pulse.time_zero_s)?;
    let metrics = momentum(&sum, as_read, test.mass_kg, pulse, out);
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

/// What all cells with data gave before anything was taken out.
struct AsRead {
    cells: usize,
    impulse_n_s: f64,
}

/// Impulse from time zero on of all cells with data, the zero level that the filter removed from each put back.
///
/// A low-pass of class 60 and above leaves the impulse but for its ends. Cells on another grid are left out, as from
/// the sum.
fn as_read(input: &Inputs, cells: &[(&str, &Sampled)], time_zero_s: f64) -> anyhow::Result<Option<AsRead>> {
    let Some(sum) = sum_of_cells(cells).refuse_with_hint("--barrier-cells none leaves the barrier out")? else {
        return Ok(None);
    };
    let mut zero_level_n = 0.0;
    for (id, _) in cells.iter().filter(|(id, _)| !sum.off_grid.iter().any(|off| off == id)) {
        let filter: Option<ChannelFilterV1> = input.record_if(&format!("/filter/{id}"))?;
        zero_level_n += filter.map_or(0.0, |filter| filter.zero_level_removed);
    }
    let sign = if sum.turned { -1.0 } else { 1.0 };
    let inside = sum.force.len().saturating_sub(sum.force.index_at_or_after(time_zero_s) + 1) as f64;
    let of_zero_level = sign * zero_level_n * inside * sum.force.dt_s();
    let impulse = impulse_n_s(&sum.force, time_zero_s, sum.force.end_s());
    Ok(impulse.map(|impulse| AsRead { cells: sum.cells, impulse_n_s: impulse + of_zero_level }))
}

/// Up to separation the barrier is what changes the momentum; after it the tyres are, which no cell feels.
fn momentum(
    sum: &CellSum,
    all: Option<AsRead>,
    mass_kg: Option<f64>,
    pulse: &Pulse<'_>,
    out: &mut Output,
) -> Vec<MetricV1> {
    let &Pulse { id, motion, time_zero_s, separation_s } = pulse;
    let over_mass = |impulse: Option<f64>| impulse.zip(mass_kg).map(|(impulse, mass)| impulse / mass);
    let last_s = sum.force.end_s().min(motion.velocity.end_s());
    let end_s = separation_s.unwrap_or(last_s).min(last_s);
    let impulse = impulse_n_s(&sum.force, time_zero_s, sum.force.end_s());
    let whole = over_mass(impulse);
    let of_barrier = over_mass(impulse_n_s(&sum.force, time_zero_s, end_s));
    let as_read = over_mass(all.as_ref().map(|all| all.impulse_n_s));
    let of_sensor = motion.velocity.at(time_zero_s).zip(motion.velocity.at(end_s)).map(|(start, end)| start - end);
    let peak = sum.force.samples().iter().copied().enumerate().reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a });
    let (highest, peak_s) = (peak.map(|(_, force)| force), peak.map_or(time_zero_s, |(k, _)| sum.force.time_s(k)));

    let turned = if sum.turned { ", sign turned so that compression is positive" } else { "" };
    out.notes().info(format!("barrier force: sum of {} load cells along x{turned}", sum.cells));
    if let Some((all, as_read)) = all.zip(as_read) {
        out.notes().info(format!(
            "barrier as read: all {} load cells with data, zero levels not removed, give {:.2} km/h over the mass for \
             the whole record",
            all.cells,
            3.6 * as_read
        ));
    }
    let ratio = ratio(mass_kg, of_barrier, of_sensor, id);
    if let Some(((barrier, whole), sensor)) = of_barrier.zip(whole).zip(of_sensor) {
        let gap = ratio.as_ref().map(|ratio| ratio - 1.0);
        let apart = match &gap {
            Ok(gap) => format!("{:+.1} % apart", 1e2 * gap),
            Err(reason) => format!("no ratio: {reason}"),
        };
        let text = format!(
            "momentum check up to {} at {:.1} ms: impulse of the barrier over the mass {:.2} km/h \
             ({:.2} km/h over the whole record), channel {id} {:.2} km/h, {apart}",
            if separation_s.is_some() { "separation" } else { "the end" },
            1e3 * (end_s - time_zero_s),
            3.6 * barrier,
            3.6 * whole,
            3.6 * sensor
        );
        if gap.is_ok_and(|gap| gap.abs() <= MOMENTUM_GAP) {
            out.notes().info(text);
        } else {
            out.notes().concern(About::WallForce, Weight::Slight, text);
        }
    }
    let few = "the force has fewer than two samples from time zero on";
    let over_mass_reason = if mass_kg.is_none() { "the mass is not known" } else { few };
    let whole_end_s = sum.force.end_s();
    let ratio_metric = match ratio {
        Ok(ratio) => Metric::of(&MOMENTUM_RATIO, Some(ratio), ""),
        Err(reason) => Metric::of(&MOMENTUM_RATIO, None, &reason),
    };
    [
        Metric::of(&BARRIER_PEAK, highest, "the record has no samples").over(peak_s, peak_s),
        Metric::of(&BARRIER_IMPULSE, impulse, few).over(time_zero_s, whole_end_s),
        Metric::of(&BARRIER_DELTA_V, whole, over_mass_reason).over(time_zero_s, whole_end_s),
        Metric::of(&BARRIER_DELTA_V_AS_READ, as_read, over_mass_reason).over(time_zero_s, whole_end_s),
        ratio_metric.over(time_zero_s, end_s),
    ]
    .into_iter()
    .chain(stiffness(sum, motion, time_zero_s))
    .map(|metric| metric_record(&[BARRIER], &metric.counted_from(time_zero_s)))
    .collect()
}

/// KW400 and initial stiffness: the force over the displacement of the sensor, from time zero on.
fn stiffness(sum: &CellSum, motion: &Motion, time_zero_s: f64) -> [Metric; 2] {
    let first = sum.force.index_at_or_after(time_zero_s);
    let pairs = (first..sum.force.len())
        .map_while(|k| Some((motion.displacement.at(sum.force.time_s(k))?, sum.force.samples()[k])));
    let (displacement_m, force_n): (Vec<f64>, Vec<f64>) = pairs.unzip();
    let stiffness = wall_stiffness(&displacement_m, &force_n);
    let reached = displacement_m.iter().position(|x| *x >= KW400_TO_M).unwrap_or(displacement_m.len());
    let end_s = sum.force.time_s((first + reached).min(sum.force.len().saturating_sub(1)));
    let why = "the sensor does not move 400 mm from time zero on within the record of the force";
    [
        Metric::of(&KW400, stiffness.map(|s| s.kw400_n_per_m), why).over(time_zero_s, end_s),
        Metric::of(&WALL_INITIAL_STIFFNESS, stiffness.map(|s| s.initial_n_per_m), why).over(time_zero_s, end_s),
    ]
}

/// Change of velocity by the barrier over that by the sensor, or why there is none.
fn ratio(mass_kg: Option<f64>, barrier: Option<f64>, sensor: Option<f64>, id: &str) -> Result<f64, String> {
    if mass_kg.is_none() {
        return Err("the mass is not known".to_owned());
    }
    let barrier = barrier.ok_or("the force has fewer than two samples from time zero to separation")?;
    let sensor = sensor.ok_or_else(|| format!("channel {id} has no velocity at time zero and at separation"))?;
    let ratio = barrier / sensor;
    if ratio.is_finite() { Ok(ratio) } else { Err(format!("the velocity of channel {id} does not change")) }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_that_cannot_be_formed_says_why() {
        assert_eq!(ratio(Some(1e3), Some(2.0), Some(4.0), "a"), Ok(0.5));
        let why = |mass, barrier, sensor| ratio(mass, barrier, sensor, "a").unwrap_err();
        assert_eq!(why(None, Some(1.0), Some(1.0)), "the mass is not known");
        assert_eq!(
            why(Some(1.0), None, Some(1.0)),
            "the force has fewer than two samples from time zero to separation"
        );
        assert_eq!(why(Some(1.0), Some(1.0), None), "channel a has no velocity at time zero and at separation");
        for sensor in [0.0, -0.0] {
            assert_eq!(why(Some(1.0), Some(1.0), Some(sensor)), "the velocity of channel a does not change");
        }
        assert_eq!(why(Some(1.0), Some(0.0), Some(0.0)), "the velocity of channel a does not change");
    }
}
