//! What the verdict says of identified models.

use crumple_artifact::records::{ModeV1, StabilizationV1};

use crate::findings::conclusions::conclusion::{FIT, Text};
use crate::findings::conclusions::status::closest_identified;
use crate::words;

impl Text<'_> {
    /// The recommended identified model, else the one that follows the record closest.
    pub(super) fn identified(&mut self) -> String {
        if let Some(ambient) = self.run.ambient() {
            return self.ambient(ambient);
        }
        let Some((k, model, fit)) = closest_identified(self.run) else {
            return "No identified model has a fit.".to_owned();
        };
        let (id, fit) = (&model.id, self.number(&format!("/models/{k}/fit_percent"), fit, FIT));
        let unseen = model.unseen_fit_percent().map_or_else(String::new, |unseen| {
            let unseen = self.number(&format!("/models/{k}/unseen_fit_percent"), unseen, FIT);
            format!(" (unseen samples: {unseen})")
        });
        if !model.holds() {
            return format!("No identified model holds: the best, {id}, has a fit of {fit}{unseen}.");
        }
        // What grows is unstable, and no mode of what was measured.
        let decays = |mode: &ModeV1| mode.im_rad_per_s > 0.0 && mode.re_per_s < 0.0;
        let modes = model.modes.iter().enumerate().filter(|(_, mode)| decays(mode));
        let slowest =
            modes.min_by(|(_, a), (_, b)| a.natural_frequency_rad_per_s.total_cmp(&b.natural_frequency_rad_per_s));
        let mode = slowest.map_or_else(String::new, |(j, mode)| {
            let at = format!("/models/{k}/modes/{j}");
            let hz = (1.0 / std::f64::consts::TAU, 2, "Hz");
            let w = self.number(&format!("{at}/natural_frequency_rad_per_s"), mode.natural_frequency_rad_per_s, hz);
            let damping = mode.damping_ratio.map_or_else(String::new, |ratio| {
                let ratio = self.number(&format!("{at}/damping_ratio"), ratio, (1.0, 3, ""));
                format!(", damping ratio {ratio}")
            });
            format!("; its slowest mode is at {w}{damping}")
        });
        let which = if self.run.is_recommended(id) { "recommended" } else { "closest" };
        format!("The {which} identified model, {id}, has a fit of {fit}{unseen}{mode}.")
    }

    /// The modes of an ambient record, the slowest first.
    fn ambient(&mut self, diagram: &StabilizationV1) -> String {
        let mut all: Vec<f64> = diagram.clusters.iter().map(|c| c.natural_frequency_rad_per_s).collect();
        all.sort_by(f64::total_cmp);
        let shown: Vec<String> = all.iter().map(|w| words::quantity(w / std::f64::consts::TAU, 2, "Hz")).collect();
        let modes = if shown.is_empty() { "none".to_owned() } else { shown.join(", ") };
        format!(
            "Nobody measured what drove this record. Modes that stay over model orders and in both halves: {modes}."
        )
    }
}
