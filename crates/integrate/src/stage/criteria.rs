//! Criteria beside the pulse: load cells of the barrier, crush stiffness, recorders, sites of sensors.

pub mod remarks;

use std::collections::BTreeMap;

use crate::{CellSum, impulse_n_s, sum_of_cells};
use crumple_metrics::definitions::{
    AHOF400, BARRIER_DELTA_V, BARRIER_DELTA_V_AS_READ, BARRIER_IMPULSE, BARRIER_PEAK, KW400, MAXIMUM_LATERAL_DELTA_V,
    MOMENTUM_RATIO, WALL_INITIAL_STIFFNESS,
};
use crumple_metrics::{
    CrushStiffness, DamageProfile, KW400_TO_M, Metric, RecordedImpact, average_height_of_force, cumulative,
    impacts_of_table, maximum_delta_v, total_and_direction, wall_stiffness,
};
use crumple_signal::{
    Axis, BARRIER, BodyPart, Channel, ChannelStatus, Motion, Note, Notes, QuantityKind, Sampled, TestDescription,
    part_of,
};
use crumple_stage::records::{ChannelFilterV1, DamageV1, ImpactV1, ImpactsV1, MetricV1};
use crumple_stage::{Inputs, Output, RefuseExt, Refused, option};

use crate::stage::criteria::remarks::{
    BarrierAsRead, BarrierSum, CellsNotValid, CellsOnAnotherGrid, MomentumApart, MomentumChecked,
    SeveralImpactsInTable, StiffnessNotComputed, StiffnessNotFromDamage, WallHeightsUnused,
};
use crate::stage::occupants_and_roadside::Criteria;
use crate::stage::options::{BarrierCells, Damage, StageSettings, WallHeight};
use crate::stage::records::{impact_records, metric_record};

/// Gap of impulse and change of momentum above which something does not fit.
const MOMENTUM_GAP: f64 = 0.05;
/// Names in a note.
const NAMED: usize = 12;

/// The pulse whose change of velocity the impulse is held against.
pub struct Pulse<'a> {
    pub id: &'a str,
    pub motion: &'a Motion,
    /// Time of the lowest velocity on the record's axis, if the record shows it.
    pub separation_s: Option<f64>,
}

/// Sums the load cells, writes `/wave/barrier/force` and returns what is to be said of it in numbers.
pub fn barrier(
    settings: &StageSettings,
    input: &Inputs,
    test: &TestDescription,
    pulse: &Pulse<'_>,
    out: &mut Output,
) -> anyhow::Result<Vec<MetricV1>> {
    let cells = settings.barrier_cells;
    let unused = |out: &mut Output| {
        if !settings.wall_heights.is_empty() {
            out.notes().push(WallHeightsUnused {});
        }
        Ok(Vec::new())
    };
    let listed: Vec<&Channel> = test.channels.iter().filter(|channel| channel.is_wall_force()).collect();
    let valid = |channel: &&&Channel| matches!(channel.status, ChannelStatus::Valid | ChannelStatus::Computed);
    let summed: Vec<(&str, &Sampled)> = match cells {
        BarrierCells::None => return unused(out),
        BarrierCells::All => waves(input, listed.iter()),
        BarrierCells::Valid => waves(input, listed.iter().filter(valid)),
    };
    let Some(sum) = sum_of_cells(&summed).refuse_with_hint(without_the_barrier())? else {
        return unused(out);
    };
    if cells == BarrierCells::Valid {
        let dead: Vec<&str> = listed
            .iter()
            .filter(|channel| channel.status.has_data() && !valid(channel))
            .map(|channel| channel.id.as_str())
            .collect();
        if !dead.is_empty() {
            out.notes().push(CellsNotValid { count: dead.len(), cells: some(&dead) });
        }
    }
    if !sum.off_grid.is_empty() {
        let ids: Vec<&str> = sum.off_grid.iter().map(String::as_str).collect();
        out.notes().push(CellsOnAnotherGrid { count: ids.len(), cells: some(&ids) });
    }
    let as_read = as_read(input, &waves(input, listed.iter()))?;
    let way = WayIn::of(&sum, pulse.motion);
    let mut metrics = momentum(&sum, as_read, test.mass_kg, pulse, out);
    metrics.extend(stiffness(&sum, &way).iter().map(|metric| metric_record(&[BARRIER], metric)));
    metrics.extend(height_of_force(&settings.wall_heights, test, &sum, &summed, &way)?);
    out.wave("barrier/force", QuantityKind::Force, sum.force.into_sampled())?;
    Ok(metrics)
}

/// What to do where the cells of a barrier give no force.
fn without_the_barrier() -> String {
    format!("{} leaves the barrier out", option("integrate", "barrier-cells", "none"))
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
fn as_read(input: &Inputs, cells: &[(&str, &Sampled)]) -> anyhow::Result<Option<AsRead>> {
    let Some(sum) = sum_of_cells(cells).refuse_with_hint(without_the_barrier())? else {
        return Ok(None);
    };
    let mut zero_level_n = 0.0;
    for (id, _) in cells.iter().filter(|(id, _)| !sum.off_grid.iter().any(|off| off == id)) {
        let filter: Option<ChannelFilterV1> = input.record_if(&format!("/filter/{id}"))?;
        zero_level_n += filter.map_or(0.0, |filter| filter.zero_level_removed);
    }
    let sign = if sum.turned { -1.0 } else { 1.0 };
    let inside = sum.force.len().saturating_sub(sum.force.index_at_or_after(0.0) + 1) as f64;
    let of_zero_level = sign * zero_level_n * inside * sum.force.dt_s();
    let impulse = impulse_n_s(&sum.force, 0.0, sum.force.end_s());
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
    let &Pulse { id, motion, separation_s } = pulse;
    let over_mass = |impulse: Option<f64>| impulse.zip(mass_kg).map(|(impulse, mass)| impulse / mass);
    let last_s = sum.force.end_s().min(motion.velocity.end_s());
    let end_s = separation_s.unwrap_or(last_s).min(last_s);
    let impulse = impulse_n_s(&sum.force, 0.0, sum.force.end_s());
    let whole = over_mass(impulse);
    let of_barrier = over_mass(impulse_n_s(&sum.force, 0.0, end_s));
    let as_read = over_mass(all.as_ref().map(|all| all.impulse_n_s));
    let of_sensor = motion.velocity.at(0.0).zip(motion.velocity.at(end_s)).map(|(start, end)| start - end);
    let peak = sum.force.samples().iter().copied().enumerate().reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a });
    let (highest, peak_s) = (peak.map(|(_, force)| force), peak.map_or(0.0, |(k, _)| sum.force.time_s(k)));

    out.notes().push(BarrierSum { cells: sum.cells, sign: if sum.turned { -1 } else { 1 } });
    if let Some((all, delta_v_m_per_s)) = all.zip(as_read) {
        out.notes().push(BarrierAsRead { cells: all.cells, delta_v_m_per_s });
    }
    let ratio = ratio(mass_kg, of_barrier, of_sensor, id);
    if let Some(((barrier, whole), sensor)) = of_barrier.zip(whole).zip(of_sensor) {
        let gap = ratio.as_ref().map(|ratio| ratio - 1.0);
        let (channel, up_to) =
            (id.to_owned(), if separation_s.is_some() { "separation" } else { "the end" }.to_owned());
        let (barrier_m_per_s, whole_m_per_s, sensor_m_per_s) = (barrier, whole, sensor);
        let remark: Note = match gap {
            Ok(gap) if gap.abs() <= MOMENTUM_GAP => {
                MomentumChecked { up_to, end_s, barrier_m_per_s, whole_m_per_s, channel, sensor_m_per_s, gap }.into()
            }
            gap => {
                let (gap, reason) = (gap.ok(), gap.err().cloned());
                MomentumApart { up_to, end_s, barrier_m_per_s, whole_m_per_s, channel, sensor_m_per_s, gap, reason }
                    .into()
            }
        };
        out.notes().push(remark);
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
        Metric::of(&BARRIER_IMPULSE, impulse, few).over(0.0, whole_end_s),
        Metric::of(&BARRIER_DELTA_V, whole, over_mass_reason).over(0.0, whole_end_s),
        Metric::of(&BARRIER_DELTA_V_AS_READ, as_read, over_mass_reason).over(0.0, whole_end_s),
        ratio_metric.over(0.0, end_s),
    ]
    .iter()
    .map(|metric| metric_record(&[BARRIER], metric))
    .collect()
}

/// Why there is nothing over 400 mm.
const TOO_SHORT: &str = "the sensor does not move 400 mm from time zero on within the record of the force";

/// The displacement of the sensor at the samples of the force, from the sample `first` at time zero on, m.
struct WayIn {
    first: usize,
    displacement_m: Vec<f64>,
    /// When 400 mm are reached, else the end, s.
    end_s: f64,
}

impl WayIn {
    fn of(sum: &CellSum, motion: &Motion) -> Self {
        let first = sum.force.index_at_or_after(0.0);
        let displacement_m: Vec<f64> =
            (first..sum.force.len()).map_while(|k| motion.displacement.at(sum.force.time_s(k))).collect();
        let reached = displacement_m.iter().position(|x| *x >= KW400_TO_M).unwrap_or(displacement_m.len());
        let end_s = sum.force.time_s((first + reached).min(sum.force.len().saturating_sub(1)));
        Self { first, displacement_m, end_s }
    }

    /// The samples of the force over it.
    fn of_force<'a>(&self, force_n: &'a [f64]) -> &'a [f64] {
        &force_n[self.first..self.first + self.displacement_m.len()]
    }
}

/// KW400 and initial stiffness: the force over the displacement of the sensor, from time zero on.
fn stiffness(sum: &CellSum, way: &WayIn) -> [Metric; 2] {
    let stiffness = wall_stiffness(&way.displacement_m, way.of_force(sum.force.samples()));
    [
        Metric::of(&KW400, stiffness.map(|s| s.kw400_n_per_m), TOO_SHORT).over(0.0, way.end_s),
        Metric::of(&WALL_INITIAL_STIFFNESS, stiffness.map(|s| s.initial_n_per_m), TOO_SHORT).over(0.0, way.end_s),
    ]
}

/// AHOF, where the heights of the cells are stated. Cells of the sum without a height leave it open.
fn height_of_force(
    heights: &[WallHeight],
    test: &TestDescription,
    sum: &CellSum,
    summed: &[(&str, &Sampled)],
    way: &WayIn,
) -> anyhow::Result<Option<MetricV1>> {
    if heights.is_empty() {
        return Ok(None);
    }
    let mut height_of: BTreeMap<&str, f64> = BTreeMap::new();
    for WallHeight { cells, height } in heights {
        let ids = test.resolve_channels(cells).into_iter().map(|channel| channel.id.as_str());
        let of_wall: Vec<&str> = ids.filter(|id| summed.iter().any(|(cell, _)| cell == id)).collect();
        if of_wall.is_empty() {
            let ids: Vec<&str> = summed.iter().map(|(id, _)| *id).collect();
            return Err(Refused::new(format!(
                "wall-heights names {cells:?}, which is no cell in the force of the wall"
            ))
            .expected(format!("an id, a code or a pattern of these: {}", some(&ids)))
            .hint(format!("give the heights as {}", option("integrate", "wall-heights", "ID=250mm")))
            .into());
        }
        height_of.extend(of_wall.into_iter().map(|id| (id, height.si())));
    }
    let cells = summed.iter().filter(|(id, _)| !sum.off_grid.iter().any(|off| off == id));
    let mut moment_n_m = vec![0.0; sum.force.len()];
    let mut unknown = Vec::new();
    for (id, cell) in cells {
        let Some(height_m) = height_of.get(id) else {
            unknown.push(*id);
            continue;
        };
        let arm_m = if sum.turned { -height_m } else { *height_m };
        moment_n_m.iter_mut().zip(cell.samples()).for_each(|(moment, force)| *moment += arm_m * force);
    }
    let value =
        average_height_of_force(&way.displacement_m, way.of_force(sum.force.samples()), way.of_force(&moment_n_m));
    let metric = if unknown.is_empty() {
        let reached = way.displacement_m.iter().any(|x| *x >= KW400_TO_M);
        let reason = if reached { "the force does no work from 25 to 400 mm" } else { TOO_SHORT };
        Metric::of(&AHOF400, value, reason).over(0.0, way.end_s)
    } else {
        Metric::of(&AHOF400, None, &format!("no height is stated of {}", some(&unknown)))
    };
    Ok(Some(metric_record(&[BARRIER], &metric)))
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

fn some(ids: &[&str]) -> String {
    match ids.len().saturating_sub(NAMED) {
        0 => ids.join(", "),
        more => format!("{} and {more} more", ids[..NAMED].join(", ")),
    }
}

impl Criteria<'_> {
    /// A, B and G, and with a profile the energy that they give for it: from the flags, else from the damage that the
    /// file of the test states.
    pub fn crush_stiffness(&self, notes: &mut Notes) -> anyhow::Result<Vec<MetricV1>> {
        if let Some(damage) = self.settings.damage {
            return Ok(self.by_mean_crush(damage, notes));
        }
        let Some(damage) = self.input.record_if::<DamageV1>("/damage")? else { return Ok(Vec::new()) };
        Ok(self.by_energy(&damage, notes))
    }

    fn by_mean_crush(&self, damage: Damage, notes: &mut Notes) -> Vec<MetricV1> {
        let (Some(mass_kg), Some(v0)) = (self.test.mass_kg, self.impact_speed_m_per_s) else {
            notes.push(StiffnessNotComputed { no_damage_speed_m_per_s: None });
            return Vec::new();
        };
        let b0 = self.settings.no_damage_speed_m_per_s;
        let stiffness = CrushStiffness::from_barrier_test(mass_kg, damage.width_m, v0, damage.residual_crush_m, b0);
        let Some(stiffness) = stiffness else {
            notes.push(StiffnessNotComputed { no_damage_speed_m_per_s: Some(b0) });
            return Vec::new();
        };
        let remark = format!(
            "width {} m, residual crush {} m, b0 = {b0} m/s; from the impact speed and what was measured afterwards",
            damage.width_m, damage.residual_crush_m
        );
        self.records_at_impact(stiffness.metrics().into_iter(), &remark)
    }

    /// From the profile: `b1` such that the energy of the test comes back, also where the profile is uneven.
    fn by_energy(&self, damage: &DamageV1, notes: &mut Notes) -> Vec<MetricV1> {
        let b0 = self.settings.no_damage_speed_m_per_s;
        let none = |notes: &mut Notes, reason: &str| {
            notes.push(StiffnessNotFromDamage { reason: reason.to_owned(), no_damage_speed_m_per_s: b0 });
            Vec::new()
        };
        if damage.is_of_another_side() {
            return none(notes, "its classification is of another side than the front");
        }
        let Some((width_m, width_is)) = damage.width() else {
            return none(notes, "neither the width of the damage nor that of the vehicle is stated");
        };
        let (Some(mass_kg), Some(v0)) = (self.test.mass_kg, self.impact_speed_m_per_s) else {
            return none(notes, "mass and impact speed are needed");
        };
        let crush_m = damage.crush_m();
        let stiffness = DamageProfile::new(&crush_m)
            .filter(|_| v0 > b0)
            .and_then(|profile| CrushStiffness::from_energy(mass_kg, width_m, v0, profile, b0));
        let Some(stiffness) = stiffness else {
            return none(notes, &format!("the crush must be positive and the impact speed above {b0} m/s"));
        };
        let stations: Vec<String> = crush_m.iter().map(|crush| format!("{:.0}", 1e3 * crush)).collect();
        let remark = format!(
            "residual crush {} mm ({}), width {width_m} m {width_is}, b0 = {b0} m/s; b1 = {:.2} 1/s by energy, \
             which gives that of the test back",
            stations.join(", "),
            damage.from,
            stiffness.b1_per_s
        );
        let energy = stiffness.energy(width_m, &crush_m, 0.0);
        self.records_at_impact(stiffness.metrics().into_iter().chain([energy]), &remark)
    }

    fn records_at_impact(&self, metrics: impl Iterator<Item = Metric>, remark: &str) -> Vec<MetricV1> {
        let at_impact = |metric: Metric| metric.over(0.0, 0.0);
        metrics.map(|metric| self.record(&[self.pulse], at_impact(metric), &[remark.to_owned()])).collect()
    }
}

/// Total and direction of the change of velocity of a pulse along x, where an accelerometer at its place measures along
/// y as well. They need no impact speed.
pub fn in_the_plane(
    input: &Inputs,
    test: &TestDescription,
    channel: &Channel,
    pulse: &Pulse<'_>,
) -> anyhow::Result<Vec<MetricV1>> {
    let is_across = |other: &&Channel| {
        other.axis == Some(Axis::Y)
            && other.quantity == QuantityKind::Acceleration
            && other.status == ChannelStatus::Valid
            && other.may_be_on_vehicle()
            && part_of(other).is_none()
            && place(other) == place(channel)
    };
    let across = test.channels.iter().filter(is_across).find_map(|c| Some((c, &input.wave_if(&c.id)?.sampled)));
    let Some((across, wave)) = across.filter(|_| channel.axis.is_none_or(|axis| axis == Axis::X)) else {
        return Ok(Vec::new());
    };
    let change = Sampled::new(wave.t0_s(), wave.dt_s(), cumulative(wave.samples(), wave.dt_s()));
    let change = change.refuse_with_hint(format!("{} leaves it out", option("filter", "channels", &channel.id)))?;
    let velocity = &pulse.motion.velocity;
    let at_contact = velocity.at(0.0).unwrap_or(0.0);
    let along = velocity.samples().iter().map(|v| v - at_contact).collect();
    let along = Sampled::new(velocity.t0_s(), velocity.dt_s(), along)?;
    let until_s = pulse.separation_s.unwrap_or(along.end_s());
    let metrics = total_and_direction(&along, &change, until_s, None);
    Ok(metrics.iter().map(|metric| metric_record(&[pulse.id, &across.id], metric)).collect())
}

/// Maximum delta-V and the time to it, of every change of velocity in the inputs, under the ids of their channels,
/// first that which the pulse was derived from. Each has a line of the summary. Last what those along x and y say of
/// energy and crush.
pub fn recorded_changes(input: &Inputs, test: &TestDescription, out: &mut Output) -> Vec<MetricV1> {
    let mut records = Vec::new();
    let mut changes: Vec<&Channel> =
        test.channels.iter().filter(|channel| channel.quantity == QuantityKind::VelocityChange).collect();
    // `<id>_derivative`, with underscores after it where that was taken.
    let derived_from = |id: &str| {
        let pulse = test.pulse.as_deref().unwrap_or_default();
        pulse == id || pulse.strip_prefix(id).is_some_and(|rest| rest.trim_end_matches('_') == "_derivative")
    };
    // Stable: the others stay in the order of the file.
    changes.sort_by_key(|channel| !derived_from(&channel.id));
    let along = |axis: Axis| changes.iter().find(|channel| channel.axis == Some(axis)).copied();
    let [x, y] = [Axis::X, Axis::Y].map(|axis| along(axis).and_then(|c| Some((c, &input.wave_if(&c.id)?.sampled))));
    let impact = x.filter(|(channel, _)| derived_from(&channel.id)).map(|(channel, along)| {
        let across = y.map(|(_, across)| across);
        let impact = RecordedImpact { along, across, impact_speed_m_per_s: test.impact_speed_m_per_s };
        let of = |metric: &Metric| match y {
            Some((across, _)) if metric.id == MAXIMUM_LATERAL_DELTA_V.id => across.id.as_str(),
            _ => channel.id.as_str(),
        };
        impact.metrics().iter().map(|metric| metric_record(&[of(metric)], metric)).collect::<Vec<_>>()
    });
    for channel in changes {
        let Some(wave) = input.wave_if(&channel.id) else { continue };
        let metrics = maximum_delta_v(&wave.sampled);
        if let [Some(change), Some(time_s)] = [&metrics[0], &metrics[1]].map(|metric| metric.value) {
            let title = channel.comment.as_ref().map_or_else(String::new, |title| format!(" ({title})"));
            let (change_km_per_h, time_ms) = (3.6 * change, 1e3 * time_s);
            let line =
                format!("recorded {}{title}: maximum delta-v {change_km_per_h:.2} km/h at {time_ms:.0} ms", channel.id);
            out.summary(line);
        }
        records.extend(metrics.iter().map(|metric| metric_record(&[&channel.id], metric)));
    }
    records.extend(impact.into_iter().flatten());
    records
}

/// The impacts of the recorder's table along x, with a note of several: its maximum delta-V counts all of them within
/// 300 ms.
pub fn recorded_impacts(input: &Inputs, test: &TestDescription, out: &mut Output) -> Option<ImpactsV1> {
    let is_along = |c: &&Channel| c.quantity == QuantityKind::VelocityChange && c.axis == Some(Axis::X);
    let channel = test.channels.iter().filter(is_along).find(|c| input.wave_if(&c.id).is_some())?;
    let impacts = impacts_of_table(&input.wave_if(&channel.id)?.sampled);
    if impacts.len() > 1 {
        let each = (1..).zip(&impacts).map(|(number, impact)| impact.words(number)).collect();
        out.notes().push(SeveralImpactsInTable { count: impacts.len(), impacts: each });
    }
    // Rows of 10 ms have no peak.
    let without_peak = |impact| ImpactV1 { peak_acceleration_m_per_s2: None, time_of_peak_s: None, ..impact };
    let impacts = impact_records(&impacts, test.impact_speed_m_per_s).into_iter().map(without_peak).collect();
    Some(ImpactsV1 { channel: channel.id.clone(), impacts })
}

/// Accelerometers at one place, one for each axis.
#[derive(Default)]
pub struct Site<'a> {
    /// Along x, y and z.
    pub axes: [Option<&'a Channel>; 3],
    /// A resultant from the source, or a channel whose axis is not known.
    pub whole: Option<&'a Channel>,
}

/// The places of heads and chests of which the inputs hold samples; failed channels are left out. In the order of their
/// locations.
pub fn sites<'a>(test: &'a TestDescription, input: &Inputs) -> Vec<(BodyPart, Site<'a>)> {
    let mut sites: BTreeMap<(BodyPart, String), Site<'a>> = BTreeMap::new();
    for channel in &test.channels {
        let Some(part) = part_of(channel) else { continue };
        if channel.status == ChannelStatus::Failed || input.wave_if(&channel.id).is_none() {
            continue;
        }
        let site = sites.entry((part, place(channel))).or_default();
        let slot = match channel.axis {
            Some(Axis::X) => &mut site.axes[0],
            Some(Axis::Y) => &mut site.axes[1],
            Some(Axis::Z) => &mut site.axes[2],
            Some(Axis::Resultant) | None => &mut site.whole,
        };
        slot.get_or_insert(channel);
    }
    sites.into_iter().map(|((part, _), site)| (part, site)).collect()
}

/// What channels at one place have in common: location, the code up to its dimension, redundancy. Without location and
/// code the id without what says the axis (`head_x_g`, `head_y_g`: `head_g`), else up to its last separator (`head_1`,
/// `head_2`).
pub fn place(channel: &Channel) -> String {
    let code = channel.code.as_deref().and_then(|code| code.get(..12)).unwrap_or_default();
    let mut location = channel.location.trim().to_lowercase();
    if location.is_empty() && code.is_empty() {
        location = without_axis(&channel.id.to_lowercase());
    }
    format!("{location}|{code}|{}", channel.redundant)
}

fn without_axis(id: &str) -> String {
    const AXES: [&str; 12] = ["x", "y", "z", "r", "ax", "ay", "az", "acx", "acy", "acz", "res", "resultant"];
    let separator = ['_', '-', '.', ' '];
    let words: Vec<&str> = id.split(separator).collect();
    match words.iter().rposition(|word| AXES.contains(word)) {
        Some(axis) => {
            words.iter().enumerate().filter(|(k, _)| *k != axis).map(|(_, word)| *word).collect::<Vec<_>>().join("_")
        }
        None => id.rsplit_once(separator).map_or(id, |(stem, _)| stem).to_owned(),
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

    #[test]
    fn the_axes_of_one_head_have_one_place() {
        for ids in [
            ["head_x_g", "head_y_g", "Head_Z_g"],
            ["driver head x", "driver head y", "driver head z"],
            ["head-ax", "head-ay", "head-az"],
        ] {
            let places = ids.map(|id| place(&Channel::new(id, QuantityKind::Acceleration)));
            assert!(places.iter().all(|other| *other == places[0]), "{places:?}");
        }
        assert_ne!(without_axis("driver_head_x"), without_axis("passenger_head_x"));
    }
}
