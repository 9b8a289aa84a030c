//! The predictions of a run by what was asked: the same names in every run.

use std::collections::BTreeMap;

use crumple_artifact::records::PredictionV1;

use super::expected::named;
use crate::drawing::numbers::KM_PER_H_PER_M_PER_S;
use crate::findings::Summary;
use crate::words;

/// A prediction of a run, called by what the choice names its candidate and by what was asked.
pub struct Scenario<'a> {
    /// `recommended`, or the candidate where it has no name.
    role: &'a str,
    /// `40.0 km/h`, `40.0 km/h against small car`.
    pub asked: String,
    /// The prediction.
    pub made: &'a PredictionV1,
}

impl Scenario<'_> {
    /// The same in every run: `recommended at 40.0 km/h`.
    pub fn id(&self) -> String {
        format!("{} at {}", self.role, self.asked)
    }
}

/// The predictions of a run. Those of one speed and one partner are counted: their masses differ.
pub fn scenarios(run: &Summary) -> Vec<Scenario<'_>> {
    let mut seen: BTreeMap<(&str, String), usize> = BTreeMap::new();
    let mut all = Vec::new();
    for made in &run.predictions {
        let role = named(run).find(|(_, id)| **id == made.candidate).map_or(made.candidate.as_str(), |(name, _)| name);
        let asked = asked(made);
        let count = seen.entry((role, asked.clone())).or_default();
        *count += 1;
        let asked = if *count == 1 { asked } else { format!("{asked}, number {count}") };
        all.push(Scenario { role, asked, made });
    }
    all
}

fn asked(made: &PredictionV1) -> String {
    let speed = words::quantity(KM_PER_H_PER_M_PER_S * made.impact_speed_m_per_s, 1, "km/h").replace('\u{a0}', " ");
    let partner = made.partner.as_ref().map(|partner| format!(" against {partner}"));
    let occupant = made.occupant.as_ref().map(|_| ", with an occupant".to_owned());
    [Some(speed), partner, occupant].into_iter().flatten().collect()
}
