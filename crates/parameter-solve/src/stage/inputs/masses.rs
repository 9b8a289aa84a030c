//! Masses of chassis and compartment for models that are matched.

use crumple_lumped_fit::{MassEvidence, MassSplit, masses};
use crumple_stage::{Output, RefuseExt, Refused};

use crate::stage::options::settings::StageSettings;

/// Masses of chassis and compartment, by the options and the test.
pub fn given_masses(settings: &StageSettings, mass_kg: Option<f64>, out: &mut Output) -> anyhow::Result<(f64, f64)> {
    let mass_kg = match (mass_kg, settings.solve.split) {
        (Some(mass), _) => mass,
        (None, MassSplit::Both(m1, m2)) => m1 + m2,
        (None, _) => {
            return Err(Refused::new("the test has no mass")
                .expected("the masses of chassis and compartment")
                .hint("--m1 284.4kg --m2 1137.6kg")
                .into());
        }
    };
    let (m1_kg, m2_kg, split) =
        masses(mass_kg, settings.solve.split, MassEvidence::Compartment).refuse_with_hint("see --m1 and --m2")?;
    out.notes().info(split);
    Ok((m1_kg, m2_kg))
}
