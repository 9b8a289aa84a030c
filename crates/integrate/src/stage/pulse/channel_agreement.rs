//! Other accelerometers compared with the pulse: how far apart they are, and the spread of every metric.

use crumple_metrics::{ChannelMotion, LARGEST_CRUSH_GAP, Metric, agreement, definitions, over_channels};
use crumple_signal::{About, Channel, Notes, STANDARD_GRAVITY_M_PER_S2, Weight};
use crumple_stage::Output;
use crumple_stage::records::MetricV1;

use crate::stage::metric_record::metric_record;
use crate::stage::pulse::integrated::Integrated;
use crate::stage::pulse::other_channels::is_of_compartment;

/// The pulse and the channels that measured the same motion.
pub struct ChannelAgreement<'a> {
    channel: &'a Channel,
    pulse: &'a Integrated,
    time_zero_s: f64,
    /// Id and metrics of each.
    others: Vec<(String, Vec<Metric>)>,
}

impl<'a> ChannelAgreement<'a> {
    pub fn new(channel: &'a Channel, pulse: &'a Integrated, time_zero_s: f64) -> Self {
        Self { channel, pulse, time_zero_s, others: Vec::new() }
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
        agreement(motion(self.pulse), motion(integrated), self.time_zero_s + crush.time_s)
            .is_ok_and(|gaps| gaps.may_be_averaged())
    }

    fn note_gaps(&self, other: &Channel, integrated: &Integrated, notes: &mut Notes) {
        let Some(crush) = self.pulse.events.crush else { return };
        let id = format!("channel {} against {}", other.id, self.channel.id);
        let Ok(gaps) = agreement(motion(self.pulse), motion(integrated), self.time_zero_s + crush.time_s) else {
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
            out.notes().info(text + "; the spread of every metric is its interval under the channels' ids together");
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

fn motion(integrated: &Integrated) -> ChannelMotion<'_> {
    ChannelMotion {
        acceleration: &integrated.motion.acceleration,
        velocity: &integrated.motion.velocity,
        dynamic_crush_m: integrated.events.crush.map(|crush| crush.displacement_m),
    }
}
