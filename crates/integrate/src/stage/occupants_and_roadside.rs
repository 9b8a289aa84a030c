//! Criteria of occupants and of roadside hardware, from the channels a test has for them.

pub mod remarks;

use std::collections::BTreeSet;

use crumple_metrics::{
    AsiLimits, AsiMethod, CLIP_3MS_S, Dummy, FlailSpace, HIC15_WINDOW_S, HIC36_WINDOW_S, Metric, Neck, asi, bric,
    clip_contiguous, clip_cumulative, definitions, hic, hic_d, nij, oiv_ora, resultant, ride_down, thiv_phd,
};
use crumple_signal::{
    Acceleration, Axis, BodyPart, Channel, ChannelStatus, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2, Signal,
    TestDescription, criterion_of, part_of,
};
use crumple_stage::records::MetricV1;
use crumple_stage::{Inputs, Output, RefuseExt, option};

use crate::stage::criteria::{Site, place, sites};
use crate::stage::occupants_and_roadside::remarks::{
    AskedAndFilteredOut, AxesOnOtherGrids, CriteriaAreBounds, FilteredOut, NotMeasured, OCCUPANTS, OtherClass,
    ROADSIDE, RideDownMissing, RoadsideAssumes, RoadsideOnOtherGrids, THIV, assumption, other_class,
};
use crate::stage::options::{MetricGroup, StageSettings};
use crate::stage::records::metric_record;

/// Class that the criteria of roadside hardware ask for.
const ROADSIDE_CFC: u16 = 180;

/// What the criteria of a test are made from.
pub struct Criteria<'a> {
    pub settings: &'a StageSettings,
    pub input: &'a Inputs,
    pub test: &'a TestDescription,
    pub pulse: &'a Channel,
    /// `None`: not known.
    pub impact_speed_m_per_s: Option<f64>,
}

impl Criteria<'_> {
    /// All criteria asked for; with `auto` those whose channels the test has. Heads and chests have a line of the
    /// summary.
    pub fn records(&self, out: &mut Output) -> anyhow::Result<Vec<MetricV1>> {
        let mut records = Vec::new();
        let sites = sites(self.test, self.input);
        let titles: Vec<String> = sites.iter().map(|(_, site)| title_of(&channels_of(site))).collect();
        let (mut lines, mut bounds) = (Vec::new(), Vec::new());
        let notes = out.notes();
        for (group, parts) in
            [(MetricGroup::Head, &[BodyPart::Head, BodyPart::Headform][..]), (MetricGroup::Chest, &[BodyPart::Chest])]
        {
            let of_group = || sites.iter().filter(|(part, _)| parts.contains(part));
            if self.takes(group) {
                self.note_what_is_left_out(group, parts, of_group().count() == 0, notes);
            }
            for (part, site) in of_group().filter(|_| self.takes(group)) {
                let channels = channels_of(site);
                let mut place = title_of(&channels);
                // Redundant sensors of one place are told apart.
                if titles.iter().filter(|title| **title == place).count() > 1 {
                    place += &format!(", channel {}", ids(&channels));
                }
                records.extend(self.of_body(*part, &channels, place, (&mut lines, &mut bounds), notes)?);
            }
        }
        if !bounds.is_empty() {
            notes.push(CriteriaAreBounds { places: bounds });
        }
        if self.takes(MetricGroup::Head) {
            records.extend(self.rotation_and_neck());
        }
        if self.takes(MetricGroup::RideDown) {
            records.extend(self.ride_down(&sites, notes)?);
        }
        if self.takes(MetricGroup::Roadside) {
            records.extend(self.roadside(notes)?);
        }
        lines.into_iter().for_each(|line| out.summary(line));
        Ok(records)
    }

    /// Names the heads or chests that were measured and are not in the inputs. A group that was asked for and has no
    /// sensor at all is a warning.
    fn note_what_is_left_out(&self, group: MetricGroup, parts: &[BodyPart], has_none: bool, notes: &mut Notes) {
        let (group_name, is_asked) = (name(group), self.asked(group));
        let left_out = |channel: &&Channel| part_of(channel).is_some_and(|part| parts.contains(&part));
        if let Some((ids, _)) = self.not_in_the_inputs(left_out) {
            let (group, pulse) = (group_name.to_owned(), self.pulse.id.clone());
            let channels = ids.into_iter().map(str::to_owned).collect();
            return if is_asked {
                notes.push(AskedAndFilteredOut { group, channels, pulse });
            } else {
                notes.push(FilteredOut { group, channels, pulse: Some(pulse) });
            };
        }
        if !is_asked || !has_none {
            return;
        }
        let unplaced = |channel: &&Channel| {
            channel.quantity == QuantityKind::Acceleration && channel.location.is_empty() && part_of(channel).is_none()
        };
        let unplaced = self.test.channels.iter().filter(unplaced).map(|channel| channel.id.clone()).collect();
        notes.push(NotMeasured { group: group_name.to_owned(), unplaced });
    }

    fn asked(&self, group: MetricGroup) -> bool {
        self.settings.metrics.contains(&group)
    }

    fn takes(&self, group: MetricGroup) -> bool {
        self.settings.metrics.is_empty() || self.asked(group)
    }

    /// The channels with data, not marked failed, that the inputs hold no samples of: their ids, and in words.
    fn not_in_the_inputs(&self, fits: impl Fn(&&Channel) -> bool) -> Option<(Vec<&str>, String)> {
        let in_inputs = |channel: &&Channel| self.input.wave_if(&channel.id).is_some();
        let usable = |channel: &&Channel| channel.status.has_data() && channel.status != ChannelStatus::Failed;
        let fits = |channel: &&Channel| usable(channel) && !in_inputs(channel) && fits(channel);
        let ids: Vec<&str> = self.test.channels.iter().filter(fits).map(|channel| channel.id.as_str()).collect();
        let words = match ids.as_slice() {
            [] => return None,
            [one] => format!("channel {one}"),
            several => format!("channels {}", several.join(", ")),
        };
        Some((ids, words))
    }

    fn acceleration(&self, channel: &Channel) -> anyhow::Result<Signal<Acceleration>> {
        self.input.wave(&channel.id)?.signal::<Acceleration>().refuse_with_hint(format!(
            "{} leaves the criteria of occupants and roadside hardware out",
            option("integrate", "metrics", "none")
        ))
    }

    /// The record of a criterion under the ids of its channels together, with what is to be said of their class and
    /// axes.
    pub(crate) fn record(&self, channels: &[&Channel], metric: Metric, remarks: &[String]) -> MetricV1 {
        let ids: Vec<&str> = channels.iter().map(|channel| channel.id.as_str()).collect();
        let metric = remarks.iter().fold(metric, |metric, remark| metric.remarked(remark));
        metric_record(&ids, &metric)
    }

    fn of_body(
        &self,
        part: BodyPart,
        channels: &[&Channel],
        place: String,
        (lines, bounds): (&mut Vec<String>, &mut Vec<String>),
        notes: &mut Notes,
    ) -> anyhow::Result<Vec<MetricV1>> {
        let signals: Vec<_> = channels.iter().map(|channel| self.acceleration(channel)).collect::<Result<_, _>>()?;
        let Ok(resultant) = resultant(&signals.iter().collect::<Vec<_>>()) else {
            notes.push(AxesOnOtherGrids { place });
            return Ok(Vec::new());
        };
        let partial = channels.len() < 3 && channels.iter().all(|channel| channel.axis != Some(Axis::Resultant));
        let bound = partial.then(|| {
            let axes: Vec<String> = channels.iter().filter_map(|c| c.axis).map(|axis| axis.to_string()).collect();
            let axes = if axes.is_empty() { "one axis".to_owned() } else { axes.join(" and ") };
            bounds.push(format!("{place} ({axes})"));
            format!("lower bound: resultant of {axes} alone")
        });
        let remarks = Vec::from_iter(class_remark(channels, OCCUPANTS, part.cfc(), notes));
        let mut metrics = match part {
            BodyPart::Head => vec![hic(&resultant, HIC15_WINDOW_S), hic(&resultant, HIC36_WINDOW_S)],
            BodyPart::Headform => vec![hic(&resultant, HIC36_WINDOW_S), hic_d(&resultant)],
            BodyPart::Chest | BodyPart::Neck => Vec::new(),
        };
        metrics.extend([clip_contiguous(&resultant, CLIP_3MS_S), clip_cumulative(&resultant, CLIP_3MS_S)]);
        lines.push(line(&place, &metrics, partial));
        let bounded = |metric: Metric| match &bound {
            Some(because) => metric.as_lower_bound(because),
            None => metric,
        };
        Ok(metrics.into_iter().map(|metric| self.record(channels, bounded(metric), &remarks)).collect())
    }

    /// BrIC of every head whose angular velocity is here, Nij of every upper neck with its two forces and the moment;
    /// of one location each.
    fn rotation_and_neck(&self) -> Vec<MetricV1> {
        let of_part = |part: BodyPart| {
            let channels = self.test.channels.iter().filter(move |channel| {
                criterion_of(channel).is_some_and(|(of, _)| of == part) && channel.status != ChannelStatus::Failed
            });
            channels.filter_map(|channel| Some((channel, &self.input.wave_if(&channel.id)?.sampled)))
        };
        let on = |at: &str, part, quantity, axis: Axis| {
            of_part(part)
                .find(|(channel, _)| place(channel) == at && channel.quantity == quantity && channel.axis == Some(axis))
        };
        let mut records = Vec::new();
        let rotates = |channel: &Channel| channel.quantity == QuantityKind::AngularVelocity;
        let heads: BTreeSet<String> = of_part(BodyPart::Head)
            .filter(|(channel, _)| rotates(channel))
            .map(|(channel, _)| place(channel))
            .collect();
        for head in heads {
            let rates =
                [Axis::X, Axis::Y, Axis::Z].map(|axis| on(&head, BodyPart::Head, QuantityKind::AngularVelocity, axis));
            let channels: Vec<&Channel> = rates.iter().flatten().map(|(channel, _)| *channel).collect();
            records.push(self.record(&channels, bric(rates.map(|rate| rate.map(|(_, wave)| wave))), &[]));
        }
        let necks: BTreeSet<String> = of_part(BodyPart::Neck).map(|(channel, _)| place(channel)).collect();
        for neck in necks {
            let of_neck = |quantity, axis| {
                of_part(BodyPart::Neck).find(|(channel, _)| {
                    place(channel) == neck && channel.quantity == quantity && channel.axis == Some(axis)
                })
            };
            let force = |axis| of_neck(QuantityKind::Force, axis);
            let moment = of_neck(QuantityKind::Moment, Axis::Y);
            let (Some((z, axial_n)), Some((x, shear_n)), Some((y, moment_n_m))) =
                (force(Axis::Z), force(Axis::X), moment)
            else {
                continue;
            };
            let waves = Neck { axial_n, shear_n, moment_n_m };
            let (metric, remark) = match dummy_of(z) {
                Some(dummy) => (nij(waves, dummy), None),
                None if z.code.as_deref().and_then(|code| code.get(DUMMY)).is_some_and(is_named) => {
                    let why = "the critical values of this dummy are not known here";
                    (Metric::absent(&definitions::NIJ, why), None)
                }
                None => {
                    let remark = "no code says which dummy: that of a 50 % male is supposed";
                    (nij(waves, Dummy::Male50), Some(remark.to_owned()))
                }
            };
            records.push(self.record(&[z, x, y], metric, &Vec::from_iter(remark)));
        }
        records
    }

    /// Ride-down of every chest along x against the pulse, both from time zero.
    fn ride_down(&self, sites: &[(BodyPart, Site<'_>)], notes: &mut Notes) -> anyhow::Result<Vec<MetricV1>> {
        let mut records = Vec::new();
        let chests = sites.iter().filter(|(part, _)| *part == BodyPart::Chest).filter_map(|(_, site)| site.axes[0]);
        let Some(v0) = self.impact_speed_m_per_s.filter(|v0| *v0 > 0.0) else { return Ok(records) };
        if !self.pulse.may_be_on_vehicle() || part_of(self.pulse).is_some() {
            if self.asked(MetricGroup::RideDown) {
                notes.push(RideDownMissing { pulse: Some(self.pulse.id.clone()), chest: None, reason: None });
            }
            return Ok(records);
        }
        let vehicle = self.since_contact(&self.acceleration(self.pulse)?);
        for chest in chests {
            let occupant = self.since_contact(&self.acceleration(chest)?);
            match ride_down(&vehicle, &occupant, v0) {
                Ok(shares) => {
                    let remarks = [format!("vehicle: channel {}", self.pulse.id)];
                    for metric in [shares.efficiency, shares.restraint, shares.largest_travel] {
                        records.push(self.record(&[chest], metric, &remarks));
                    }
                }
                Err(error) => {
                    let (chest, reason) = (Some(chest.id.clone()), Some(error.to_string()));
                    notes.push(RideDownMissing { pulse: None, chest, reason });
                }
            }
        }
        if records.is_empty() && self.asked(MetricGroup::RideDown) {
            notes.push(RideDownMissing { pulse: None, chest: None, reason: None });
        }
        Ok(records)
    }

    fn since_contact(&self, signal: &Signal<Acceleration>) -> Signal<Acceleration> {
        signal.slice(signal.index_at_or_after(0.0), signal.len()).into()
    }

    /// ASI over the whole record; the flights of head and occupant begin at time zero.
    fn roadside(&self, notes: &mut Notes) -> anyhow::Result<Vec<MetricV1>> {
        let asked = self.asked(MetricGroup::Roadside);
        let on_axis = |axis: Axis| {
            self.vehicle(QuantityKind::Acceleration, axis).into_iter().find(|channel| at_centre_of_gravity(channel))
        };
        let mut assumed = Vec::new();
        let (x, y) = match (on_axis(Axis::X), on_axis(Axis::Y)) {
            (Some(x), Some(y)) => (x, Some(y)),
            _ if !asked => return Ok(Vec::new()),
            (x, y) => {
                if x.is_none() {
                    assumed.push(("x", Some(self.pulse.id.clone())));
                }
                if y.is_none() {
                    assumed.push(("y", None));
                }
                (x.unwrap_or(self.pulse), y)
            }
        };
        let z = on_axis(Axis::Z);
        if z.is_none() {
            assumed.push(("z", None));
        }
        let mut remarks: Vec<String> = assumed.iter().map(|(axis, pulse)| assumption(axis, pulse.as_deref())).collect();
        for (axis, pulse) in assumed {
            notes.push(RoadsideAssumes { axis: axis.to_owned(), pulse });
        }
        let yaw = self.vehicle(QuantityKind::AngularVelocity, Axis::Z).into_iter().next();
        let mut planar = vec![x];
        planar.extend(y);
        remarks.extend(class_remark(&planar, ROADSIDE, ROADSIDE_CFC, notes));

        let ax = self.acceleration(x)?;
        let zeros = || ax.with_samples(vec![0.0; ax.len()]).refuse_with_hint(without_metrics());
        let along = |channel: Option<&Channel>| channel.map_or_else(zeros, |channel| self.acceleration(channel));
        let (ay, az) = (along(y)?, along(z)?);
        let mut spatial = planar.clone();
        spatial.extend(z);
        let space = FlailSpace::default();
        let (x_flight, y_flight) = (self.since_contact(&ax), self.since_contact(&ay));
        let mut metrics: Vec<(&[&Channel], Metric)> = Vec::new();
        let limits = AsiLimits::default();
        let severity = [AsiMethod::ButterworthPerPass].map(|method| asi([&ax, &ay, &az], limits, method));
        let flight = oiv_ora(&x_flight, &y_flight, space);
        let ([Ok(severity)], Ok(flight)) = (severity, flight) else {
            notes.push(RoadsideOnOtherGrids { reason: None });
            return Ok(Vec::new());
        };
        metrics.push((&spatial, severity));
        for metric in flight {
            // A zero that nothing measured is no result.
            let unmeasured =
                [&definitions::OIV_Y, &definitions::ORA_Y].into_iter().find(|d| y.is_none() && d.id == metric.id);
            let reason = "y is not measured at the centre of gravity";
            metrics.push((&planar[..], unmeasured.map_or(metric, |d| Metric::absent(d, reason))));
        }
        let mut with_yaw = planar.clone();
        with_yaw.extend(yaw);
        match yaw {
            Some(yaw) => {
                let rate = &self.input.wave(&yaw.id)?.sampled;
                let rate = rate.slice(rate.index_at_or_after(0.0), rate.len());
                match thiv_phd(&x_flight, &y_flight, &rate, space) {
                    Ok((thiv, phd)) => metrics.extend([(&with_yaw[..], thiv), (&with_yaw[..], phd)]),
                    Err(error) => notes.push(RoadsideOnOtherGrids { reason: Some(error.to_string()) }),
                }
            }
            None => {
                let yaw_rate = |channel: &&Channel| of_vehicle(channel, QuantityKind::AngularVelocity, Axis::Z);
                let reason = match self.not_in_the_inputs(yaw_rate) {
                    Some((ids, words)) => {
                        let channels = ids.into_iter().map(str::to_owned).collect();
                        notes.push(FilteredOut { group: THIV.to_owned(), channels, pulse: None });
                        format!("{words} measured the yaw rate, but the filter left it out")
                    }
                    None => "no yaw rate of the vehicle is measured".to_owned(),
                };
                metrics
                    .extend([&definitions::THIV, &definitions::PHD].map(|d| (&planar[..], Metric::absent(d, &reason))));
            }
        }
        Ok(metrics.into_iter().map(|(channels, metric)| self.record(channels, metric, &remarks)).collect())
    }

    /// Channels of the vehicle that measure a quantity along an axis, with samples in the inputs.
    fn vehicle(&self, quantity: QuantityKind, axis: Axis) -> Vec<&Channel> {
        let fits =
            |channel: &&Channel| of_vehicle(channel, quantity, axis) && self.input.wave_if(&channel.id).is_some();
        self.test.channels.iter().filter(fits).collect()
    }
}

/// Where a code names the dummy (ISO/TS 13499, fine location 3).
const DUMMY: std::ops::Range<usize> = 10..12;

fn is_named(dummy: &str) -> bool {
    !dummy.bytes().all(|byte| b"0_?".contains(&byte))
}

/// The dummy by the code of its channel, of those whose critical values are known.
fn dummy_of(channel: &Channel) -> Option<Dummy> {
    match channel.code.as_deref()?.get(DUMMY)? {
        "H3" => Some(Dummy::Male50),
        "HF" => Some(Dummy::Female5),
        _ => None,
    }
}

/// Whether a channel that did not fail measures a quantity of the vehicle along an axis.
fn without_metrics() -> String {
    format!("{} leaves it out", option("integrate", "metrics", "none"))
}

fn of_vehicle(channel: &Channel, quantity: QuantityKind, axis: Axis) -> bool {
    channel.quantity == quantity
        && channel.axis == Some(axis)
        && channel.status != ChannelStatus::Failed
        && channel.may_be_on_vehicle()
        && !channel.location.to_lowercase().contains("head")
}

fn name(group: MetricGroup) -> &'static str {
    if group == MetricGroup::Chest { "chest" } else { "head" }
}

/// `driver, head: hic15 412.3, hic36 530.1, 3 ms 61.2 g contiguous, 62.0 g cumulative`.
fn line(place: &str, metrics: &[Metric], lower_bound: bool) -> String {
    let value_in_words = |metric: &Metric| {
        let value = metric.value?;
        let g = value / STANDARD_GRAVITY_M_PER_S2;
        Some(match metric.name {
            "clip_3ms_contiguous" => format!("3 ms {g:.1} g contiguous"),
            "clip_3ms_cumulative" => format!("{g:.1} g cumulative"),
            name => format!("{name} {value:.1}"),
        })
    };
    let values: Vec<String> = metrics.iter().filter_map(value_in_words).collect();
    let values = if values.is_empty() { "no criterion, the notes say why".to_owned() } else { values.join(", ") };
    format!("{place}: {values}{}", if lower_bound { " (lower bounds: not all axes)" } else { "" })
}

/// The channels a resultant is made of: three axes, a channel that is the resultant, or the axes there are.
fn channels_of<'a>(site: &Site<'a>) -> Vec<&'a Channel> {
    let axes: Vec<&Channel> = site.axes.iter().flatten().copied().collect();
    match site.whole {
        Some(whole) if axes.len() < 3 => vec![whole],
        _ => axes,
    }
}

/// The location of channels at one place, else their ids.
fn title_of(channels: &[&Channel]) -> String {
    match channels {
        [] => String::new(),
        [one] => title(one),
        [first, ..] if !first.location.is_empty() => first.location.clone(),
        several => {
            format!("channels {}", several.iter().map(|channel| channel.id.as_str()).collect::<Vec<_>>().join(", "))
        }
    }
}

fn title(channel: &Channel) -> String {
    if channel.location.is_empty() { format!("channel {}", channel.id) } else { channel.location.clone() }
}

fn ids(channels: &[&Channel]) -> String {
    channels.iter().map(|channel| channel.id.as_str()).collect::<Vec<_>>().join(",")
}

/// What is to be said where the class of the input is not the one the definition asks for; a warning too.
fn class_remark(channels: &[&Channel], criteria: &str, asked: u16, notes: &mut Notes) -> Option<String> {
    let other = channels.iter().find(|channel| channel.cfc != Some(asked))?;
    notes.push(OtherClass {
        criteria: criteria.to_owned(),
        place: title(other),
        channel: other.id.clone(),
        class: other.cfc,
        asked_class: asked,
        channels: ids(channels),
    });
    Some(other_class(&other.id, other.cfc, asked))
}

/// Whether a sensor of the vehicle is said to sit at the centre of gravity, by code or in words.
fn at_centre_of_gravity(channel: &Channel) -> bool {
    let location = channel.location.to_lowercase();
    let by_code = channel.code.as_deref().is_some_and(|code| code.get(2..8).is_some_and(|part| part == "VEHCCG"));
    by_code
        || ["centre of gravity", "center of gravity", "c.g."].iter().any(|words| location.contains(words))
        || location.split(|c: char| !c.is_alphanumeric()).any(|word| word == "cg" || word == "cofg")
}
