//! The part of a Maxwell model that is nearly rigid, and so not determined.

use crumple_lumped::Maxwell;

/// Share of the dynamic crush below which a part of the model is nearly rigid.
const RIGID: f64 = 0.02;

/// Which parameter the record hardly determines, in words, and why; `None` where both take part.
///
/// Spring and damper in series share the crush. The damper gives `m v0/c` until the mass stops, at most; the spring
/// gives the largest force over its stiffness, at a thousand instants up to twice the time `C/v0` (the force of a stiff
/// spring is largest soon after contact and falls slowly). Where one of them gives less than 2 % of the crush it could
/// as well be rigid: its value follows from that small part, to which noise, filter and the other's law contribute as
/// much.
pub(super) fn undetermined_by_the_record(model: &Maxwell, impact_speed_m_per_s: f64, crush_m: f64) -> Option<String> {
    let damper = model.mass_kg * impact_speed_m_per_s / model.damping_n_s_per_m;
    let step_s = 2.0 * crush_m / impact_speed_m_per_s / 1000.0;
    let force =
        |k: u32| model.mass_kg * model.state(impact_speed_m_per_s, f64::from(k) * step_s).acceleration_m_per_s2.abs();
    let spring = (1..=1000).map(force).fold(0.0, f64::max) / model.stiffness_n_per_m;
    let share = |give: f64| format!("{:.2} mm of {:.1} mm", 1e3 * give, 1e3 * crush_m);
    if damper < RIGID * crush_m {
        return Some(format!(
            "the damper is nearly rigid, it gives {}: the record does not determine its damping, only that it is \
             large, and the model is a spring alone",
            share(damper)
        ));
    }
    (spring < RIGID * crush_m).then(|| {
        format!(
            "the spring is nearly rigid, it gives {}: the record does not determine its stiffness, only that it is \
             large, and the model is a damper alone",
            share(spring)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nearly_rigid_damper_is_found_and_a_working_one_is_not() {
        let model = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 3e5, damping_n_s_per_m: 1e8 };
        let crush = model.events(10.0).dynamic_crush_m.unwrap();
        let finding = undetermined_by_the_record(&model, 10.0, crush).unwrap();
        assert!(finding.contains("does not determine its damping, only"), "{finding}");
        let working = Maxwell { damping_n_s_per_m: 4e4, stiffness_n_per_m: 1e6, ..model };
        let crush = working.events(10.0).dynamic_crush_m.unwrap();
        assert_eq!(undetermined_by_the_record(&working, 10.0, crush), None);
    }

    #[test]
    fn a_spring_that_has_relaxed_when_the_mass_stops_is_not_rigid() {
        // Nearly critical: hardly any force is left at dynamic crush, but the spring gave a fifth of the crush on the
        // way.
        let slow = Maxwell { mass_kg: 1600.0, stiffness_n_per_m: 6e5, damping_n_s_per_m: 1.6e4 };
        let crush = slow.events(17.0).dynamic_crush_m.unwrap();
        assert!(crush - 1600.0 * 17.0 / 1.6e4 < 0.02 * crush);
        assert_eq!(undetermined_by_the_record(&slow, 17.0, crush), None);
        // A spring hundred times as stiff is rigid beside the same damper: it gives c v0/k at most.
        let stiff = Maxwell { stiffness_n_per_m: 6e7, ..slow };
        let finding = undetermined_by_the_record(&stiff, 17.0, 1.7).unwrap();
        assert!(finding.contains("the spring is nearly rigid, it gives 4."), "{finding}");
    }
}
