//! Other channels than the pulse: integrated beside it, and how far sensors of one place agree.

use crumple_metrics::{ChannelMotion, LARGEST_CRUSH_GAP, Metric, agreement, definitions, over_channels};
use crumple_signal::{
    About, Axis, Channel, ChannelStatus, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2, Sampled, TestDescription,
    Weight, part_of,
};
use crumple_stage::records::MetricV1;
use crumple_stage::{Inputs, Output, Refused, program};

use crate::stage::integration::{ChannelIntegration, Integrated, acceleration};
use crate::stage::records::{metric_record, metric_records, note_warnings, warn_unless_of_the_vehicle};

/// Parts of the vehicle that move apart from its compartment, lower case.
const PARTS: [&str; 10] =
    ["engine", "caliper", "brake", "wheel", "steering", "dashboard", "bumper", "radiator", "subframe", "firewall"];

/// Places of the compartment that have a front of their own: elsewhere "front" is that of the vehicle.
const WITH_A_FRONT: [&str; 10] =
    ["seat", "sill", "rocker", "floor", "pillar", "door", "tunnel", "console", "passenger", "gravity"];

/// The channels of a list, or with `all` every x acceleration with data, not marked failed, whose location names
/// nothing that moves apart from the compartment, and those the list names beside it.
pub fn other_channels<'a>(
    asked: &[String],
    test: &'a TestDescription,
    pulse: &str,
    input: &Inputs,
    notes: &mut Notes,
) -> anyhow::Result<Vec<&'a Channel>> {
    let everything = asked.iter().any(|id| id == "all");
    let mut ids: Vec<String> = Vec::new();
    for name in asked.iter().filter(|name| *name != "all") {
        ids.extend(channels_named(test, name, "channels", input)?);
    }
    ids.retain(|id| id != pulse);
    if everything {
        let candidates = test.channels.iter().filter(|channel| {
            channel.id != pulse
                && channel.quantity == QuantityKind::Acceleration
                && channel.axis.is_none_or(|axis| axis == Axis::X)
                && input.wave_if(&channel.id).is_some()
        });
        for id in &ids {
            input.wave(id)?;
        }
        let named = |channel: &Channel| ids.contains(&channel.id);
        let (mut taken, mut left): (Vec<&Channel>, Vec<&Channel>) =
            candidates.partition(|channel| is_of_compartment(channel) || named(channel));
        // Heads and chests are here for their criteria.
        left.retain(|channel| part_of(channel).is_none());
        if !left.is_empty() {
            let ids: Vec<&str> = left.iter().map(|channel| channel.id.as_str()).collect();
            notes.info(format!(
                "not integrated, because failed or not in the compartment: channels {} (--set \
                 integrate.channels=all,ID adds one)",
                ids.join(", ")
            ));
        }
        // What was named is integrated, along whatever axis.
        for id in &ids {
            taken.extend(test.channel(id).filter(|channel| !taken.iter().any(|other| other.id == channel.id)));
        }
        return Ok(taken);
    }
    let mut channels: Vec<&Channel> = Vec::new();
    for id in &ids {
        input.wave(id)?;
        channels.extend(test.channel(id).filter(|channel| !channels.iter().any(|other| other.id == channel.id)));
    }
    Ok(channels)
}

/// Accelerometers that a refusal lists.
const SHOWN: usize = 12;

/// The ids that a name, a code or a pattern means, given under an option. A pattern leaves out what cannot be
/// integrated: other quantities, and channels that are not in the inputs.
pub fn channels_named(test: &TestDescription, name: &str, key: &str, input: &Inputs) -> anyhow::Result<Vec<String>> {
    let all = test.resolve_channels(name);
    if all.is_empty() {
        let usable_here =
            |channel: &&Channel| channel.quantity == QuantityKind::Acceleration && input.wave_if(&channel.id).is_some();
        let mut usable_here: Vec<&str> =
            test.channels.iter().filter(usable_here).map(|channel| channel.id.as_str()).collect();
        let more = usable_here.len().saturating_sub(SHOWN);
        usable_here.truncate(SHOWN);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        return Err(Refused::new(format!(
            "the test has no channel {name:?}, which {key} of [integrate] or --{key} \
            names"
        ))
        .expected(format!("an accelerometer of the inputs: {}{more}", usable_here.join(", ")))
        .hint(format!(
            "put the id of yours there; in the pipeline two-sensors it stands in channels of [integrate] and in \
                 sensors of [parameter-solve]{}",
            if test.channels.len() > usable_here.len() {
                format!(" ({} shows every channel)", program("ingest --list RECORD"))
            } else {
                String::new()
            }
        ))
        .into());
    }
    let usable =
        |channel: &&&Channel| channel.quantity == QuantityKind::Acceleration && input.wave_if(&channel.id).is_some();
    let ids = |channels: Vec<&Channel>| channels.into_iter().map(|channel| channel.id.clone()).collect::<Vec<_>>();
    let fit: Vec<&Channel> = all.iter().filter(usable).copied().collect();
    // One that was named says itself what it lacks.
    Ok(if all.len() == 1 || fit.is_empty() { ids(all) } else { ids(fit) })
}

/// Whether a channel moves with the compartment, as far as status, code, location and, without a location, its name
/// say.
fn is_of_compartment(channel: &Channel) -> bool {
    let place = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    let place = place.to_lowercase();
    let is_said = |wanted: &str| place.split(|c: char| !c.is_alphanumeric()).any(|word| word == wanted);
    channel.status != ChannelStatus::Failed
        && channel.may_be_on_vehicle()
        && part_of(channel).is_none()
        && !PARTS.iter().any(|word| place.contains(word))
        && (!is_said("front") || is_said("cg") || WITH_A_FRONT.iter().any(|word| place.contains(word)))
}

/// The pulse and the channels that measured the same motion.
pub struct ChannelAgreement<'a> {
    channel: &'a Channel,
    pulse: &'a Integrated,
    /// Id and metrics of each.
    others: Vec<(String, Vec<Metric>)>,
}

impl<'a> ChannelAgreement<'a> {
    pub fn new(channel: &'a Channel, pulse: &'a Integrated) -> Self {
        Self { channel, pulse, others: Vec::new() }
    }

    /// Notes how far another channel is from the pulse, and takes it into the spread if both are of the compartment.
    pub fn compare(&mut self, other: &Channel, integrated: &Integrated, notes: &mut Notes) {
        let Some(outside) = [self.channel, other].into_iter().find(|channel| !is_of_compartment(channel)) else {
            self.others.push((other.id.clone(), integrated.metrics.clone()));
            return self.note_gaps(other, integrated, notes);
        };
        notes.info(format!(
            "channel {} is not in the spread: channel {} is failed or not of the compartment",
            other.id, outside.id
        ));
    }

    /// Whether another channel shows the motion of the pulse: its crush within 5 %, on a grid that can be compared.
    pub fn agrees(&self, integrated: &Integrated) -> bool {
        let Some(crush) = self.pulse.events.crush else { return true };
        agreement(motion(self.pulse), motion(integrated), crush.time_s).is_ok_and(|gaps| gaps.may_be_averaged())
    }

    fn note_gaps(&self, other: &Channel, integrated: &Integrated, notes: &mut Notes) {
        let Some(crush) = self.pulse.events.crush else { return };
        let id = format!("channel {} against {}", other.id, self.channel.id);
        let Ok(gaps) = agreement(motion(self.pulse), motion(integrated), crush.time_s) else {
            return notes.info(format!("{id}: on another time grid, not compared sample by sample"));
        };
        let none = || "none".to_owned();
        let crush_gap = gaps.crush_gap_m.zip(gaps.crush_gap_ratio);
        let text = format!(
            "{id}: largest |da| {:.2} g, |dv| at dynamic crush {}, |dC| {}, fit {}",
            gaps.largest_acceleration_gap_m_per_s2 / STANDARD_GRAVITY_M_PER_S2,
            gaps.velocity_gap_m_per_s.map_or_else(none, |dv| format!("{dv:.3} m/s")),
            crush_gap.map_or_else(none, |(gap, ratio)| format!("{:.1} mm ({:.1} %)", 1e3 * gap, 1e2 * ratio)),
            gaps.fit_percent.map_or_else(none, |fit| format!("{fit:.1} %")),
        );
        if gaps.may_be_averaged() {
            notes.info(text);
        } else {
            notes.concern(
                About::Motion,
                Weight::Marked,
                format!("{text}: more than {:.0} % of crush apart", 1e2 * LARGEST_CRUSH_GAP),
            );
        }
    }

    /// Every metric of the pulse with the range over all channels: the honest error bar of a single one.
    ///
    /// Metrics that are the same for all of them (impact energy) or a check of the arithmetic have none.
    pub fn spread(self, out: &mut Output) -> Vec<MetricV1> {
        let Self { channel, pulse, others, .. } = self;
        if others.is_empty() {
            return Vec::new();
        }
        let ids: Vec<&str> = std::iter::once(channel.id.as_str()).chain(others.iter().map(|(id, _)| &id[..])).collect();
        let crushes = || {
            let of_all = std::iter::once(&pulse.metrics).chain(others.iter().map(|(_, metrics)| metrics));
            ids.iter().zip(of_all).filter_map(|(id, metrics)| {
                Some((*id, metrics.iter().find(|metric| metric.id == definitions::DYNAMIC_CRUSH.id)?.value?))
            })
        };
        let low = crushes().min_by(|a, b| a.1.total_cmp(&b.1));
        let high = crushes().max_by(|a, b| a.1.total_cmp(&b.1));
        if let (Some(low), Some(high), true) = (low, high, crushes().count() > 1) {
            let text = format!(
                "dynamic crush of {} channels: {:.4} m (channel {}) to {:.4} m (channel {}), {:.1} % apart",
                crushes().count(),
                low.1,
                low.0,
                high.1,
                high.0,
                1e2 * (high.1 - low.1) / high.1.abs()
            );
            out.summary(text.clone());
            out.notes().info(text + "; the spread of every metric is the interval of their joint entry in /metrics");
        }
        let spread = |(k, metric): (usize, &Metric)| {
            let of_others: Vec<&Metric> = others.iter().filter_map(|(_, metrics)| metrics.get(k)).collect();
            let spread = over_channels(metric, &of_others)?.remarked(&format!("value of channel {}", channel.id));
            let interval = spread.interval.filter(|interval| interval.low < interval.high)?;
            (spread.id != definitions::CLOSURE.id && interval.low.is_finite()).then(|| metric_record(&ids, &spread))
        };
        pulse.metrics.iter().enumerate().filter_map(spread).collect()
    }
}

/// Channels beside the pulse that have all replicates asked for; more of them share those of so many.
const WITH_ALL_REPLICATES: usize = 60;
/// Replicates of each of them at least: a quantile of 50 is itself uncertain by a third of a standard deviation.
const LEAST_REPLICATES: usize = 50;

/// Replicates for each of so many channels beside the pulse, so that the work on them is bounded.
fn replicates_of_others(asked: usize, channels: usize) -> usize {
    let shared = asked.saturating_mul(WITH_ALL_REPLICATES) / channels.max(WITH_ALL_REPLICATES);
    shared.max(LEAST_REPLICATES).min(asked)
}

/// Integrates and writes the channels beside the pulse and compares them with it; returns their metrics.
pub fn integrate_others(
    task: &ChannelIntegration<'_>,
    pulse: &Channel,
    others: &mut ChannelAgreement<'_>,
    out: &mut Output,
) -> anyhow::Result<Vec<MetricV1>> {
    let ChannelIntegration { settings, input, test, .. } = *task;
    let impact_speed_m_per_s = task.impact_speed_m_per_s.unwrap_or(0.0);
    let mut metrics = Vec::new();
    let channels = other_channels(&settings.channels, test, &pulse.id, input, out.notes())?;
    let asked = settings.uncertainty.as_ref().map_or(0, |uncertainty| uncertainty.replicates);
    let most_replicates = replicates_of_others(asked, channels.len());
    if most_replicates < asked {
        out.notes().info(format!(
            "intervals of the {} channels beside the pulse are 5-95 % of {most_replicates} replicates each, not \
             {asked}: they are many",
            channels.len()
        ));
    }
    let task = &ChannelIntegration { most_replicates, ..*task };
    for other in channels {
        let samples = acceleration(input, other)?;
        if !covers(&samples) {
            out.notes().concern(
                About::Channel(other.id.clone()),
                Weight::Slight,
                format!(
                    "channel {} runs from {:.1} to {:.1} ms and does not contain contact: not integrated",
                    other.id,
                    1e3 * samples.t0_s(),
                    1e3 * samples.end_s()
                ),
            );
            continue;
        }
        let motion = task.integrate(other, &samples, out)?;
        // Taken with all the others, of a place that nobody names: that it moves with the vehicle must show.
        let unnamed =
            !settings.channels.iter().any(|name| test.resolve_channels(name).iter().any(|c| c.id == other.id));
        if unnamed && unplaced(other) && !others.agrees(&motion) {
            out.notes().concern(
                About::Channel(other.id.clone()),
                Weight::Slight,
                format!(
                    "channel {} does not move as the pulse does, and nothing says where it sits: not compared with the \
                 vehicle (if it is of the compartment, name it: --set integrate.channels=all,{})",
                    other.id, other.id
                ),
            );
            continue;
        }
        note_warnings(&other.id, &motion, impact_speed_m_per_s, out.notes());
        metrics.extend(metric_records(&other.id, &motion));
        warn_unless_of_the_vehicle(other, out.notes());
        others.compare(other, &motion, out.notes());
        task.write(&other.id, motion, out)?;
    }
    Ok(metrics)
}

/// Whether a channel starts no later than one interval after time zero and goes on after it: its speed there is known.
fn covers(samples: &Sampled) -> bool {
    samples.t0_s() <= samples.dt_s() && samples.index_at_or_after(0.0) + 2 <= samples.len()
}

/// Whether neither a location nor a code says where a channel sits.
fn unplaced(channel: &Channel) -> bool {
    channel.location.trim().is_empty() && channel.code.is_none()
}

fn motion(integrated: &Integrated) -> ChannelMotion<'_> {
    ChannelMotion {
        acceleration: &integrated.motion.acceleration,
        velocity: &integrated.motion.velocity,
        dynamic_crush_m: integrated.events.crush.map(|crush| crush.displacement_m),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_channels_share_the_replicates_of_sixty() {
        let of = |channels| replicates_of_others(400, channels);
        assert_eq!([0, 1, 60, 120, 299, 100_000].map(of), [400, 400, 400, 200, 80, 50]);
        assert_eq!([0, 20].map(|asked| replicates_of_others(asked, 1000)), [0, 20]);
    }

    #[test]
    fn a_sensor_on_the_front_is_not_of_the_compartment() {
        let at = |location: &str| {
            is_of_compartment(&Channel {
                location: location.to_owned(),
                ..Channel::new("a_front", QuantityKind::Acceleration)
            })
        };
        for place in [
            "vehicle, left rear seat crossmember",
            "left front sill",
            "front floor, right",
            "right front door",
            "front rocker",
            "front console",
            "vehicle CG, frontal impact",
            "CG front",
        ] {
            assert!(at(place), "{place}");
        }
        for place in ["", "vehicle, front end", "front crossmember", "bumper beam", "engine top", "firewall, left"] {
            assert!(!at(place), "{place}");
        }
    }
}
