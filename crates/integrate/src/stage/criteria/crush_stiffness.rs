//! Stiffness of the front after CRASH3, from the residual crush that was measured on the vehicle.

use crumple_metrics::{CrushStiffness, DamageProfile, Metric};
use crumple_signal::Notes;
use crumple_stage::records::{DamageV1, MetricV1};

use crate::stage::criteria::occupants_and_roadside::Criteria;
use crate::stage::options::Damage;

/// Place of the deformed area in a collision deformation classification (SAE J224), and its letter for the front.
const AREA: (usize, char) = (2, 'F');

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
            notes.warning("crush stiffness: the mass is not known (give it to ingest with --mass)");
            return Vec::new();
        };
        let b0 = self.settings.no_damage_speed_m_per_s;
        let stiffness = CrushStiffness::from_barrier_test(mass_kg, damage.width_m, v0, damage.residual_crush_m, b0);
        let Some(stiffness) = stiffness else {
            notes.warning(format!(
                "crush stiffness: width, residual crush and impact speed above {b0} m/s must be positive, none computed"
            ));
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
        let none = |notes: &mut Notes, reason: &str| {
            notes.info(format!("crush stiffness (CRASH3): not from the damage that the file states: {reason}"));
            Vec::new()
        };
        let area = damage.classification.as_deref().and_then(|code| code.chars().nth(AREA.0));
        if area.is_some_and(|area| area != AREA.1) {
            return none(notes, "its classification is of another side than the front");
        }
        let (width_m, width_is) = match (damage.damage_width_m, damage.vehicle_width_m) {
            (Some(width), _) => (width, "of the damage"),
            (None, Some(width)) => (width, "of the vehicle"),
            (None, None) => return none(notes, "neither the width of the damage nor that of the vehicle is stated"),
        };
        let (Some(mass_kg), Some(v0)) = (self.test.mass_kg, self.impact_speed_m_per_s) else {
            return none(notes, "mass and impact speed are needed");
        };
        // A station that bulges out has no crush.
        let crush_m: Vec<f64> = damage.residual_crush_m.iter().map(|crush| crush.max(0.0)).collect();
        let b0 = self.settings.no_damage_speed_m_per_s;
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
        let at_impact = |metric: Metric| metric.over(self.time_zero_s, self.time_zero_s);
        metrics.map(|metric| self.record(&[self.pulse], at_impact(metric), &[remark.to_owned()])).collect()
    }
}
