//! Other channels than the pulse: integrated beside it, and how far sensors of one place agree.

use crumple_metrics::{Agreement, ChannelMotion, LARGEST_CRUSH_GAP, Metric, agreement, definitions, over_channels};
use crumple_signal::{
    About, Axis, Channel, ChannelStatus, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2, Sampled, TestDescription,
    Weight, part_of, remarks,
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
            notes.push(NotInTheCompartment { channels: left.iter().map(|channel| channel.id.clone()).collect() });
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
        let (channel, pulse) = (other.id.clone(), self.channel.id.clone());
        notes.push(NotCompared { channel, pulse, outside: Some(outside.id.clone()) });
    }

    /// Whether another channel shows the motion of the pulse: its crush within 5 %, on a grid that can be compared.
    pub fn agrees(&self, integrated: &Integrated) -> bool {
        let Some(crush) = self.pulse.events.crush else { return true };
        agreement(motion(self.pulse), motion(integrated), crush.time_s).is_ok_and(|gaps| gaps.may_be_averaged())
    }

    fn note_gaps(&self, other: &Channel, integrated: &Integrated, notes: &mut Notes) {
        let Some(crush) = self.pulse.events.crush else { return };
        let (channel, pulse) = (other.id.clone(), self.channel.id.clone());
        let Ok(gaps) = agreement(motion(self.pulse), motion(integrated), crush.time_s) else {
            return notes.push(NotCompared { channel, pulse, outside: None });
        };
        let Agreement {
            largest_acceleration_gap_m_per_s2: acceleration_gap_m_per_s2,
            velocity_gap_m_per_s,
            crush_gap_m,
            crush_gap_ratio: crush_gap,
            fit_percent,
            ..
        } = gaps;
        if gaps.may_be_averaged() {
            notes.push(ChannelAgrees {
                channel,
                pulse,
                acceleration_gap_m_per_s2,
                velocity_gap_m_per_s,
                crush_gap_m,
                crush_gap,
                fit_percent,
            });
        } else {
            notes.push(ChannelDiffers {
                channel,
                pulse,
                acceleration_gap_m_per_s2,
                velocity_gap_m_per_s,
                crush_gap_m,
                crush_gap,
                fit_percent,
                most_percent: 1e2 * LARGEST_CRUSH_GAP,
            });
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
            let (channels, share) = (crushes().count(), (high.1 - low.1) / high.1.abs());
            out.summary(crush_spread(channels, (low.1, low.0), (high.1, high.0), share));
            let (lowest, highest) = (low.0.to_owned(), high.0.to_owned());
            out.notes().push(CrushSpread { channels, low_m: low.1, lowest, high_m: high.1, highest, share });
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
        out.notes().push(FewerReplicates { channels: channels.len(), replicates: most_replicates, asked });
    }
    let task = &ChannelIntegration { most_replicates, ..*task };
    for other in channels {
        let samples = acceleration(input, other)?;
        if !covers(&samples) {
            out.notes().push(WithoutContact {
                channel: other.id.clone(),
                from_s: samples.t0_s(),
                to_s: samples.end_s(),
            });
            continue;
        }
        let motion = task.integrate(other, &samples, out)?;
        // Taken with all the others, of a place that nobody names: that it moves with the vehicle must show.
        let unnamed =
            !settings.channels.iter().any(|name| test.resolve_channels(name).iter().any(|c| c.id == other.id));
        if unnamed && unplaced(other) && !others.agrees(&motion) {
            out.notes().push(MovesOtherwise { channel: other.id.clone() });
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

/// How far a channel is from the pulse: acceleration, m/s², velocity at dynamic crush, m/s, crush, m and as a share,
/// fit, percent.
fn gaps_in_words(
    [channel, pulse]: [&str; 2],
    acceleration_gap_m_per_s2: f64,
    velocity_gap_m_per_s: Option<f64>,
    crush_gap: Option<(f64, f64)>,
    fit_percent: Option<f64>,
) -> String {
    let none = || "none".to_owned();
    format!(
        "channel {channel} against {pulse}: largest |da| {:.2} g, |dv| at dynamic crush {}, |dC| {}, fit {}",
        acceleration_gap_m_per_s2 / STANDARD_GRAVITY_M_PER_S2,
        velocity_gap_m_per_s.map_or_else(none, |dv| format!("{dv:.3} m/s")),
        crush_gap.map_or_else(none, |(gap, ratio)| format!("{:.1} mm ({:.1} %)", 1e3 * gap, 1e2 * ratio)),
        fit_percent.map_or_else(none, |fit| format!("{fit:.1} %")),
    )
}

/// The line of the summary: lowest and highest crush, m, with their channels.
fn crush_spread(channels: usize, (low_m, lowest): (f64, &str), (high_m, highest): (f64, &str), share: f64) -> String {
    format!(
        "dynamic crush of {channels} channels: {low_m:.4} m (channel {lowest}) to {high_m:.4} m (channel {highest}), \
         {:.1} % apart",
        1e2 * share
    )
}

remarks! {
    /// Remarks of channels beside the pulse.
    pub REMARKS;

    /// Accelerometers that failed, or that do not sit in the compartment, are not integrated.
    CR339 NotInTheCompartment { channels: Vec<String> }
    bears on (About::Motion, Weight::None)
    decided "integrate.channels is all: a channel is left out by its status, or where its code, location or name says \
             engine, wheel, brake, bumper, the front and the like."
    means "These parts move apart from the compartment. They are not in the range of the sensors."
    remedy "nothing; integrate.channels = [\"all\", \"ID\"] adds one"
    says format!(
        "not integrated, because failed or not in the compartment: channels {} (--set integrate.channels=all,ID adds \
         one)",
        channels.join(", ")
    );

    /// A channel is not compared with the pulse.
    CR340 NotCompared { channel: String, pulse: String, outside: Option<String> }
    bears on (About::Motion, Weight::None)
    decided "Channels are compared sample by sample on one time grid. Channels that failed or do not sit in the \
             compartment are not compared."
    means "Its metrics are in /metrics. It is not in the range that the sensors of the compartment give."
    remedy "nothing; filter.resample brings channels to one grid"
    says match outside {
        Some(outside) => format!(
            "channel {channel} is not in the spread: channel {outside} is failed or not of the compartment"
        ),
        None => {
            format!("channel {channel} against {pulse}: on another time grid, not compared sample by sample")
        }
    };

    /// Another sensor of the compartment gives the crush of the pulse.
    CR341 ChannelAgrees {
        channel: String, pulse: String, acceleration_gap_m_per_s2: f64, velocity_gap_m_per_s: Option<f64>,
        crush_gap_m: Option<f64>, crush_gap: Option<f64>, fit_percent: Option<f64>
    }
    bears on (About::Motion, Weight::None)
    decided "The crush of both differs by at most 5 %; velocities are compared at the time of dynamic crush."
    means "Both sensors measured the same motion. What they differ by is the error of a single sensor."
    remedy "nothing"
    says gaps_in_words(
        [channel, pulse],
        *acceleration_gap_m_per_s2,
        *velocity_gap_m_per_s,
        crush_gap_m.zip(*crush_gap),
        *fit_percent,
    );

    /// Another sensor of the compartment gives another crush than the pulse.
    CR342 ChannelDiffers {
        channel: String, pulse: String, acceleration_gap_m_per_s2: f64, velocity_gap_m_per_s: Option<f64>,
        crush_gap_m: Option<f64>, crush_gap: Option<f64>, fit_percent: Option<f64>, most_percent: f64
    }
    bears on (About::Motion, Weight::Marked)
    decided "The crush of both differs by more than 5 %, or one of them has none."
    means "A sensor is wrong, or the structure moves differently where it sits: one reading is no better than the gap."
    remedy "quote the range of the sensors; leave a sensor out whose pulse is wrong"
    says {
        let text = gaps_in_words(
            [channel, pulse],
            *acceleration_gap_m_per_s2,
            *velocity_gap_m_per_s,
            crush_gap_m.zip(*crush_gap),
            *fit_percent,
        );
        format!("{text}: more than {most_percent:.0} % of crush apart")
    };

    /// The range of the dynamic crush over the sensors of the compartment.
    CR343 CrushSpread { channels: usize, low_m: f64, lowest: String, high_m: f64, highest: String, share: f64 }
    bears on (About::Motion, Weight::None)
    decided "Lowest and highest dynamic crush of the pulse and the channels that are compared with it."
    means "The range is the error bar of a single sensor. /metrics has it of every metric, under all channels together."
    remedy "quote the range beside the crush of the pulse"
    says crush_spread(*channels, (*low_m, lowest), (*high_m, highest), *share)
        + "; the spread of every metric is the interval of their joint entry in /metrics";

    /// Many channels have intervals of fewer repetitions than the pulse.
    CR344 FewerReplicates { channels: usize, replicates: usize, asked: usize }
    bears on (About::Motion, Weight::None)
    decided "Up to 60 channels beside the pulse have all repetitions. More channels share as many, 50 each at least."
    means "The 5 % and 95 % quantiles of these channels are less certain. Those of the pulse are not touched."
    remedy "nothing; integrate.channels with fewer channels gives each of them more"
    says format!(
        "intervals of the {channels} channels beside the pulse are 5-95 % of {replicates} replicates each, not \
         {asked}: they are many"
    );

    /// A channel does not contain contact and is not integrated.
    CR345 WithoutContact { channel: String, from_s: f64, to_s: f64 }
    bears on (About::Channel(channel.clone()), Weight::Slight)
    decided "The channel starts later than one sampling interval after time zero, or ends there."
    means "Its speed is not known at any sample, so that it has no motion. The pulse is not touched."
    remedy "nothing, or check the time axis of the channel"
    says format!(
        "channel {channel} runs from {:.1} to {:.1} ms and does not contain contact: not integrated",
        1e3 * from_s,
        1e3 * to_s
    );

    /// A channel of an unknown place moves otherwise than the pulse.
    CR346 MovesOtherwise { channel: String }
    bears on (About::Channel(channel.clone()), Weight::Slight)
    decided "Neither location nor code says where it sits, and its crush is more than 5 % beside the crush of the \
             pulse."
    means "It is not compared with the vehicle and not in the range of the sensors. The pulse is not touched."
    remedy "name it if it is of the compartment: integrate.channels = [\"all\", \"ID\"]"
    says format!(
        "channel {channel} does not move as the pulse does, and nothing says where it sits: not compared with the \
         vehicle (if it is of the compartment, name it: --set integrate.channels=all,{channel})"
    );
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
