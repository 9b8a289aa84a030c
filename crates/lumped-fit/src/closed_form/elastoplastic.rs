//! The elastoplastic model from crush, speed and restitution: a loading line, a steeper unloading line, no damper.

use crumple_lumped::Elastoplastic;

use crate::SolveError;
use crate::error::positive;

/// The elastoplastic model with the crush, speed and restitution of the record: `k_E = m v0²/C²`, `k_P = k_E/e²`.
///
/// Energy balance of loading and unloading, single-mass paper, equations 9 to 15; `e` is a ratio of velocities, so
/// the energy returned is `e²`. Keeps `C`, `v0` and the rebound velocity; its time of dynamic crush is `π/2·C/v0`
/// whatever was measured. Relative error: twice that of `C` for `k_E`, and twice that of `e` in addition for `k_P`.
/// Errors: values that are not positive (without rebound `k_P` is infinite), or restitution above 1.
pub fn elastoplastic_from_events(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    dynamic_crush_m: f64,
    coefficient_of_restitution: f64,
) -> Result<Elastoplastic, SolveError> {
    let m = positive("mass_kg", mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", impact_speed_m_per_s)?;
    let crush = positive("dynamic_crush_m", dynamic_crush_m)?;
    let e = positive("coefficient_of_restitution", coefficient_of_restitution)?;
    if e > 1.0 {
        return Err(SolveError::Value {
            name: "coefficient_of_restitution",
            value: e,
            expected: "at most 1 (more energy came back than went in)",
        });
    }
    let omega = v0 / crush;
    let loading = m * omega * omega;
    Ok(Elastoplastic {
        mass_kg: m,
        loading_stiffness_n_per_m: loading,
        unloading_stiffness_n_per_m: loading / (e * e),
        release: true,
    })
}

/// Coefficient of restitution below which the unloading is rigid within the accuracy of a record: a zero level 0.1 g
/// off makes as much rebound of nothing within 100 ms at 10 m/s.
pub(crate) const RIGID_RESTITUTION: f64 = 0.01;

/// As [`elastoplastic_from_events`], with an unloading stiffness of at most `k_E/0.01²`, and whether it stands there: a
/// smaller restitution, zero or none is no number but a rigid line, and any stiffness above gives the same record.
pub(crate) fn elastoplastic_of_record(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    dynamic_crush_m: f64,
    coefficient_of_restitution: f64,
) -> Result<(Elastoplastic, bool), SolveError> {
    let rigid = coefficient_of_restitution <= RIGID_RESTITUTION;
    let restitution = if rigid { RIGID_RESTITUTION } else { coefficient_of_restitution };
    Ok((elastoplastic_from_events(mass_kg, impact_speed_m_per_s, dynamic_crush_m, restitution)?, rigid))
}

/// Whether the unloading stiffness of a closed form is the one that stands for a rigid line.
pub fn unloads_rigidly(model: &Elastoplastic) -> bool {
    model.coefficient_of_restitution() <= RIGID_RESTITUTION * (1.0 + 1e-9)
}
