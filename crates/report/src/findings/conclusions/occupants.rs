//! What the verdict says of occupants and of event data recorders.

use crumple_signal::key_quantities::{
    CLIP_3MS, HIC15, HIC36, KeyQuantity, MAXIMUM_DELTA_V, RECORDED_CRUSH, RECORDED_EES, TIME_OF_MAXIMUM_DELTA_V,
};

use crate::findings::conclusions::concerns::Concern;
use crate::findings::conclusions::conclusion::Text;
use crate::findings::conclusions::key_numbers::sign_of;

/// The code of criteria without one of their axes, `CriteriaAreBounds` of integrate.
const NOT_ALL_AXES: &str = "CR352";

impl Text<'_> {
    pub(super) fn occupant(&mut self) -> String {
        let mut criteria = Vec::new();
        for quantity in [HIC15, HIC36, CLIP_3MS] {
            // The summary has a name once, as the run finds it.
            let metric = self.run.metric(quantity.key).and_then(|metric| metric.value.zip(Some(metric)));
            let Some((value, metric)) = metric else { continue };
            let (at, ends) = (format!("/metrics/{}/value", quantity.key), metric.low.zip(metric.high));
            let number = self.rounded(&at, value, ends, quantity.shown());
            criteria.push(format!("{} {}{number}", quantity.symbol, sign_of(self.run, metric)));
        }
        let criteria = if criteria.is_empty() { String::new() } else { format!(": {}", criteria.join(", ")) };
        let place = self.run.channel().map_or("", |channel| channel.location.as_str());
        format!("The sensor sits in an occupant ({place}), not in the vehicle{criteria}.")
    }

    pub(super) fn occupant_use(&self, concerns: &[Concern]) -> String {
        let partial = concerns.iter().any(|concern| concern.code == NOT_ALL_AXES);
        let bounds = if partial { "; the criteria are lower bounds: not all axes are in this record" } else { "" };
        format!("Do not use its crush, stiffness and models for the vehicle{bounds}.")
    }

    pub(super) fn recorded(&mut self) -> String {
        let metric = self.run.metric(MAXIMUM_DELTA_V.key);
        let recorded = metric.and_then(|metric| Some((metric.value?, metric.from_s, metric.is_lower_bound)));
        let Some((value, from_s, is_lower_bound)) = recorded else { return String::new() };
        let at = format!("/metrics/{}", MAXIMUM_DELTA_V.key);
        let change = self.number(&format!("{at}/value"), value, MAXIMUM_DELTA_V.shown());
        let time = from_s.map(|time_s| self.number(&format!("{at}/from_s"), time_s, TIME_OF_MAXIMUM_DELTA_V.shown()));
        if let Some(time) = time.as_ref().filter(|_| is_lower_bound) {
            return format!(
                "The recorder kept a delta-v of at least {change}: its table ends at {time} while the velocity still \
                 changes."
            );
        }
        let time = time.map_or_else(String::new, |time| format!(", reached at {time}"));
        format!("The recorder kept a delta-v of {change}{time}.")
    }

    /// A metric of a recorder's table and its interval in words.
    fn of_table(&mut self, quantity: &KeyQuantity) -> Option<[String; 2]> {
        let metric = self.run.metric(quantity.key)?;
        let (at, ends) = (format!("/metrics/{}", quantity.key), metric.low.zip(metric.high));
        let shown = self.rounded(&format!("{at}/value"), metric.value?, ends, quantity.shown());
        let interval = ends.map(|ends| self.interval(&at, ends, quantity.shown()));
        Some([shown, interval.unwrap_or_default()])
    }

    /// The speed that went into deformation.
    pub(super) fn recorder_energy(&mut self) -> Option<String> {
        let [ees, interval] = self.of_table(&RECORDED_EES)?;
        let share = self.run.metric("absorbed_energy_share").and_then(|metric| metric.value).map(|share| {
            let share = self.number("/metrics/absorbed_energy_share/value", share, (1.0, 2, ""));
            format!(": {share} of the kinetic energy went into deformation")
        });
        // Its interval holds the steps of the recorder alone.
        let speed = if share.is_some() { " and the stated speed is exact" } else { "" };
        let is_lower_bound = self.run.metric(RECORDED_EES.key).is_some_and(|metric| metric.is_lower_bound);
        let ees = if is_lower_bound { format!("at least {ees}") } else { format!("{ees}{interval}") };
        let share = share.unwrap_or_default();
        Some(format!("If what it hit did not give way{speed}, the EES is {ees}{share}."))
    }

    pub(super) fn recorder_use(&mut self) -> String {
        let crush = self.of_table(&RECORDED_CRUSH);
        let crush =
            crush.map_or_else(String::new, |[crush, interval]| format!("; its crush of {crush}{interval} is rough"));
        let none = if self.best().is_none() { "; no model is recommended" } else { "" };
        format!("Its table is too coarse for peak and force{crush}{none}.")
    }
}
