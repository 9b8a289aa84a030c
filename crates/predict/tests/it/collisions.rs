//! Collisions with another vehicle, moving barriers, occupants.

use crumple_artifact::Artifact;
use crumple_artifact::records::{FitV1, PredictedCollisionV1, PredictionV1, SensorFitV1};
use crumple_lumped::{Chain, CrashPulse, Drive, Elastoplastic, ForceDeflection, Kelvin, Model, Structure};
use crumple_testkit::IMPACT_SPEED_M_PER_S;

use super::{
    KELVIN, KELVIN_ID, PLASTIC, PLASTIC_ID, both, candidate, choice, predictions, run, run_folder, stderr, write,
    write_with,
};

/// Predictions of the plastic and the damped candidate against the vehicle of another run.
fn against_a_vehicle(partner: &[(&str, super::CandidateV1)], more: &[&str]) -> Vec<PredictionV1> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let other = folder.path().join("other run");
    run_folder(&other, partner);
    let flags: Vec<&str> = ["--partner", other.to_str().unwrap()].into_iter().chain(more.iter().copied()).collect();
    let output = run(folder.path(), &flags);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    predictions(folder.path())
}

fn at_wall(speed: &str) -> Vec<PredictionV1> {
    super::predicted(&["--speed", speed])
}

fn collision(prediction: &PredictionV1) -> &PredictedCollisionV1 {
    prediction.collision.as_ref().unwrap()
}

fn close(value: Option<f64>, expected: Option<f64>, tolerance: f64) {
    let (value, expected) = (value.unwrap(), expected.unwrap());
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value}, expected {expected}");
}

/// Momentum of the two and the energy that both take, of one mass each; a contact mass is in both.
fn closes(prediction: &PredictionV1) {
    let both = collision(prediction);
    let scale = prediction.mass_kg * both.closing_speed_m_per_s;
    // Rounding of the exact motion.
    assert!((both.momentum_after_n_s - both.momentum_before_n_s).abs() < 1e-9 * scale, "{both:?}");
    let energy = prediction.energy.as_ref().unwrap();
    let absorbed = both.absorbed_j.unwrap() + both.partner_absorbed_j.unwrap();
    assert!((absorbed - energy.absorbed_j).abs() < 1e-9 * energy.kinetic_at_impact_j, "{both:?}");
    let crush = prediction.dynamic_crush_m.unwrap() + both.partner_crush_m.unwrap();
    close(Some(crush), both.mutual_crush_m, 1e-9);
}

#[test]
fn equal_vehicles_meet_as_at_the_wall_at_half_the_closing_speed() {
    let wall = at_wall("40km/h");
    for flags in [
        &["--speed", "40km/h"][..],
        &["--closing-speed", "80km/h"],
        &["--closing-speed", "80km/h", "--partner-speed", "0km/h"],
        &["--closing-speed", "80km/h", "--partner-speed", "80km/h"],
    ] {
        let predictions = against_a_vehicle(&both(), flags);
        // The partner is its recommended candidate, the plastic one.
        let (own, wall) = (&predictions[0], &wall[0]);
        assert_eq!(
            (own.candidate.as_str(), collision(own).partner_candidate.as_deref()),
            (PLASTIC_ID, Some(PLASTIC_ID))
        );
        assert!((3.6 * collision(own).closing_speed_m_per_s - 80.0).abs() < 1e-9);
        // Exact motions on both sides: rounding; the peak is read off samples after the same filter.
        close(own.dynamic_crush_m, wall.dynamic_crush_m, 1e-9);
        close(collision(own).partner_crush_m, wall.dynamic_crush_m, 1e-9);
        close(own.time_of_dynamic_crush_s, wall.time_of_dynamic_crush_s, 1e-9);
        close(own.delta_v_m_per_s, wall.delta_v_m_per_s, 1e-8);
        close(collision(own).partner_delta_v_m_per_s, wall.delta_v_m_per_s, 1e-8);
        close(own.coefficient_of_restitution, wall.coefficient_of_restitution, 1e-8);
        close(own.peak_acceleration_m_per_s2, wall.peak_acceleration_m_per_s2, 1e-8);
        close(own.olc_m_per_s2, wall.olc_m_per_s2, 1e-6);
        close(collision(own).energy_equivalent_speed_m_per_s, Some(wall.impact_speed_m_per_s), 1e-9);
        closes(own);
    }
}

#[test]
fn a_damped_pair_meets_with_a_contact_mass_and_still_closes() {
    let wall = super::predicted(&["--speed", "40km/h", "--candidate", KELVIN_ID]);
    let flags = ["--speed", "40km/h", "--candidate", KELVIN_ID, "--partner-candidate", KELVIN_ID];
    let equal = against_a_vehicle(&both(), &flags);
    // Between equals the contact stands still, whatever its mass.
    close(equal[0].dynamic_crush_m, wall[0].dynamic_crush_m, 1e-9);
    close(equal[0].delta_v_m_per_s, wall[0].delta_v_m_per_s, 1e-8);
    let heavy = Kelvin { mass_kg: 1500.0, ..KELVIN };
    let unequal = against_a_vehicle(&[(KELVIN_ID, candidate(&Model::Kelvin(heavy)))], &flags);
    closes(&unequal[0]);
    assert!(unequal[0].notes.iter().any(|note| note.contains("lies between the fronts")), "{:?}", unequal[0].notes);
    assert!(unequal[0].delta_v_m_per_s.unwrap() > collision(&unequal[0]).partner_delta_v_m_per_s.unwrap());
}

#[test]
fn the_light_one_changes_its_velocity_more_and_all_of_it_is_shown() {
    let heavy = Elastoplastic { mass_kg: 1746.0, ..PLASTIC };
    let partner = [(PLASTIC_ID, candidate(&Model::Elastoplastic(heavy)))];
    let predictions = against_a_vehicle(&partner, &["--speed", "40km/h"]);
    let (own, of_both) = (&predictions[0], collision(&predictions[0]));
    closes(own);
    // Masses 1 and 2: changes of velocity 2 and 1, a third of the closing speed less than its own speed in common.
    close(own.delta_v_m_per_s, of_both.partner_delta_v_m_per_s.map(|dv| 2.0 * dv), 1e-9);
    close(of_both.common_velocity_m_per_s, Some(-40.0 / 3.6 / 3.0), 1e-9);
    let after = of_both.partner_velocity_after_m_per_s.unwrap() - of_both.velocity_after_m_per_s.unwrap();
    close(Some(after / of_both.closing_speed_m_per_s), own.coefficient_of_restitution, 1e-9);
    let names: Vec<&str> = own.intervals.iter().map(|interval| interval.name.as_str()).collect();
    assert!(names.contains(&"collision.partner_crush_m") && names.contains(&"collision.mutual_crush_m"), "{names:?}");
    // Equal parameters of both vehicles are twice as many sources for a crush that is shared equally.
    let mutual = own.intervals.iter().find(|interval| interval.name == "collision.mutual_crush_m").unwrap();
    assert!(mutual.low < of_both.mutual_crush_m.unwrap() && mutual.high > of_both.mutual_crush_m.unwrap());
    assert!(mutual.interval_by.contains("parameters"), "{}", mutual.interval_by);
}

fn against_a_barrier(more: &[&str]) -> (PredictionV1, String) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let flags: Vec<&str> = ["--candidate", PLASTIC_ID].iter().chain(more).copied().collect();
    let output = run(folder.path(), &flags);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let artifact = Artifact::open(&folder.path().join("7.mcap")).unwrap();
    assert!(artifact.waves().keys().any(|id| id == "prediction/1/partner-velocity"));
    (predictions(folder.path()).remove(0), stderr(&output))
}

#[test]
fn a_heavy_rigid_barrier_is_the_wall() {
    let wall = at_wall("40km/h").remove(0);
    let (barrier, _) = against_a_barrier(&["--speed", "40km/h", "--partner", "barrier mass=1e9kg"]);
    // It gives way as the masses are to each other: 873e-9.
    close(barrier.dynamic_crush_m, wall.dynamic_crush_m, 1e-6);
    close(barrier.peak_acceleration_m_per_s2, wall.peak_acceleration_m_per_s2, 1e-6);
    closes(&barrier);
}

#[test]
fn a_face_of_honeycomb_takes_its_plateau_while_the_vehicle_waits() {
    let face = "barrier mass=1400kg area=0.5m2 pressure=120kPa depth=500mm";
    let (prediction, text) = against_a_barrier(&["--speed", "30km/h", "--partner", face]);
    let both = collision(&prediction);
    closes(&prediction);
    assert_eq!((both.partner_speed_m_per_s, both.kind.as_str()), (0.0, "barrier"));
    // The vehicle is crushed up to the force of the plateau, 60 kN, and no further.
    close(prediction.dynamic_crush_m, Some(60e3 / PLASTIC.loading_stiffness_n_per_m), 1e-9);
    // Of the energy at common velocity the face has the rest, along 60 kN but for its ramp of 3 mm.
    let reduced = 873.0 * 1400.0 / 2273.0;
    let energy = 0.5 * reduced * (30.0_f64 / 3.6).powi(2);
    let crush = prediction.dynamic_crush_m.unwrap();
    close(both.partner_absorbed_j, Some(energy - 0.5 * 60e3 * crush), 1e-9);
    close(both.partner_crush_m, Some(0.0015 + (energy - 0.5 * 60e3 * crush) / 60e3), 1e-9);
    assert!(text.contains("partner: barrier, 1400 kg, face 60 kN at 3 mm, 60 kN at 500 mm"), "{text}");
    assert!(text.contains("mutual crush"), "{text}");
}

#[test]
fn partners_are_a_table_of_the_pipeline_too() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let pipeline = folder.path().join("p.toml");
    let table = "[predict]\nspeeds = ['40 km/h']\n[predict.partner]\nbarrier = 'mpdb'\nspeed = '20 km/h'\n\
                 [predict.occupant]\nstiffness = '60 kN/m'\nslack = '30 mm'\nforce_limit = '5 kN'\n";
    std::fs::write(&pipeline, table).unwrap();
    let output = run(folder.path(), &["--pipeline", pipeline.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let prediction = predictions(folder.path()).remove(0);
    assert!((3.6 * collision(&prediction).closing_speed_m_per_s - 60.0).abs() < 1e-9);
    assert!(prediction.partner.as_ref().unwrap().contains("maker's sheets"), "{:?}", prediction.partner);
    let occupant = prediction.occupant.as_ref().unwrap();
    // The limiter: 5 kN on 75 kg.
    close(Some(occupant.peak_acceleration_m_per_s2), Some(5e3 / 75.0), 1e-9);
    close(Some(occupant.ride_down_share.unwrap() + occupant.restraint_share.unwrap()), Some(1.0), 1e-6);
}

#[test]
fn an_occupant_rides_in_the_pulse_at_the_wall() {
    let flags = ["--speed", "40km/h", "--candidate", PLASTIC_ID, "--occupant", "frequency=9Hz slack=20mm"];
    let prediction = super::predicted(&flags).remove(0);
    let occupant = prediction.occupant.as_ref().unwrap();
    // Slack and stiffness let the occupant start later and stop later than the vehicle, at a higher peak.
    assert!(occupant.time_of_contact_s.unwrap() < occupant.time_of_peak_s);
    assert!(occupant.peak_acceleration_m_per_s2 > prediction.peak_acceleration_m_per_s2.unwrap());
    let [ride_down, restraint] = [occupant.ride_down_share, occupant.restraint_share].map(Option::unwrap);
    assert!(ride_down > 0.1 && restraint > 0.1, "{occupant:?}");
    // Straight lines between half milliseconds of the pulse.
    assert!((ride_down + restraint - 1.0).abs() < 1e-4, "{occupant:?}");
    let names: Vec<&str> = prediction.intervals.iter().map(|interval| interval.name.as_str()).collect();
    for name in ["occupant.peak_acceleration_m_per_s2", "occupant.largest_excursion_m", "occupant.ride_down_share"] {
        assert!(names.contains(&name), "{names:?}");
    }
}

/// A made ride: 75 kg behind 60 kN/m with 20 mm of slack and a limit of 4 kN, in the motion of the test.
#[test]
fn a_restraint_is_fitted_to_the_chest_and_scored_against_it() {
    let folder = tempfile::tempdir().unwrap();
    let limited = ForceDeflection::new(&[(0.0, 0.0), (1.0, 60e3)], 60e3).unwrap();
    let limited = limited.with_gap(0.02).unwrap().with_limit(4e3).unwrap();
    let pulse = Model::Kelvin(KELVIN).respond(IMPACT_SPEED_M_PER_S, 1e-4, 3000).unwrap();
    let compartment = pulse.compartment();
    let points = compartment.acceleration_m_per_s2.iter().enumerate();
    let base = Drive::BasePulse(CrashPulse::Lines(points.step_by(5).map(|(k, a)| (k as f64 * 1e-4, *a)).collect()));
    let structure = Structure::row(&[75.0], [vec![limited.into()]]).unwrap();
    let chest = structure.dynamics(&base, 1e-4, 3000).unwrap().response.motions.pop().unwrap();
    let velocity: Vec<f64> = chest.velocity_m_per_s.iter().map(|v| v + IMPACT_SPEED_M_PER_S).collect();
    write_with(folder.path(), &both(), Some(&choice()), &[("CHST/velocity", velocity)]);
    let flags = ["--speed", "40km/h", "--candidate", PLASTIC_ID, "--occupant"];
    let asked = |restraint: &str| run(folder.path(), &[&flags[..], &[restraint]].concat());
    let output = asked("sensor=CHST");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output);
    let of = |name: &str, unit: &str| -> f64 {
        let rest = said.split_once(name).unwrap_or_else(|| panic!("{name}: {said}")).1;
        assert!(rest.contains(unit), "{said}");
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    // The compartment is known by straight lines between half milliseconds.
    assert!((of("fitted to CHST: ", "kN/m") - 60.0).abs() < 1.0, "{said}");
    assert!((of("slack ", "mm") - 20.0).abs() < 0.5 && (of("limit ", "kN") - 4.0).abs() < 0.1, "{said}");
    let prediction = predictions(folder.path()).remove(0);
    let peak = prediction.intervals.iter().find(|i| i.name == "occupant.peak_acceleration_m_per_s2").unwrap();
    let occupant = prediction.occupant.as_ref().unwrap();
    // On the limit again: 4 kN on 75 kg.
    close(Some(occupant.peak_acceleration_m_per_s2), Some(4e3 / 75.0), 0.02);
    assert!(peak.low < occupant.peak_acceleration_m_per_s2 && occupant.peak_acceleration_m_per_s2 < peak.high);
    let refused = asked("sensor=HEAD");
    assert_eq!(refused.status.code(), Some(3), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("HEAD"), "{}", stderr(&refused));
    assert_eq!(asked("sensor=CHST slack=10mm").status.code(), Some(2));
}

#[test]
fn a_chain_that_ends_with_an_occupant_is_no_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let sensor = |channel: &str, mass: u32| SensorFitV1 {
        channel: channel.to_owned(),
        mass,
        quantity: "displacement".to_owned(),
        rmse: 0.0,
        noise: 1.0,
    };
    let chain = Chain::with_constants(&[798.0, 75.0], &[3e5, 6e4], &[2e3, 1e3]).unwrap();
    let mut sled = candidate(&Model::Kelvin(KELVIN));
    (sled.model, sled.parameters) = ("chain".to_owned(), chain.parameters());
    sled.fit = Some(FitV1 {
        channel: "pulse".to_owned(),
        quantity: "displacement".to_owned(),
        from_s: 0.0,
        to_s: 0.08,
        samples: 801,
        rmse: 0.0,
        iterations: 1,
        evaluations: 1,
        stop_reason: "cost-converged".to_owned(),
        active_bounds: Vec::new(),
        sensors: vec![sensor("pulse", 1), sensor("chest", 2)],
    });
    let all = [both(), vec![("chain/sled/1", sled)]].concat();
    write(folder.path(), &all, None);
    assert_eq!(run(folder.path(), &["--speed", "30km/h"]).status.code(), Some(0));
    assert!(predictions(folder.path()).iter().all(|prediction| prediction.candidate != "chain/sled/1"));
    let output = run(folder.path(), &["--candidate", "chain/sled/1"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("is an occupant"), "{}", stderr(&output));
}

#[test]
fn what_is_no_partner_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let refused = |flags: &[&str]| {
        let output = run(folder.path(), flags);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", stderr(&output));
        stderr(&output)
    };
    assert!(refused(&["--partner", "mpbd"]).contains("did you mean \"mpdb\"?"));
    assert!(refused(&["--partner", folder.path().to_str().unwrap()]).contains("has no"));
    assert!(refused(&["--partner-speed", "20km/h"]).contains("a wall has no speed"));
    assert!(
        refused(&["--partner", "barrier mass=1t", "--speed", "30km/h", "--partner-speed", "-30km/h"]).contains("never")
    );
    let split = ["--partner", "barrier mass=1t", "--closing-speed", "30km/h", "--partner-speed", "40km/h"];
    assert!(refused(&split).contains("leaves nothing"));
    refused(&["--occupant", "slack=30mm"]);
    refused(&["--partner", "barrier mass=1t", "--partner-candidate", KELVIN_ID]);
}
