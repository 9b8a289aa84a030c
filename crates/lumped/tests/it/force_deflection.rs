//! The force-deflection element: closed forms, energy, shifted speeds, derivatives, series, what is refused.

use crumple_lumped::{
    Collision, CollisionQuestions, CrashPulse, Damper, Drive, Elastoplastic, Element, ElementEvent, Extrapolation,
    ForceDeflection, ForceDeflectionParameter, Instants, Leg, LumpedError, Model, Motion, Node, Occupant,
    PiecewiseLinear, Place, SeriesSpringDamper, Start, Structure, lead,
};
use proptest::prelude::*;

/// A curve that buckles and rises, scaled.
fn buckling(forces: f64, deflections: f64, unloading: f64) -> ForceDeflection {
    let knots = [(0.0, 0.0), (0.04, 160e3), (0.1, 120e3), (0.24, 200e3), (0.4, 190e3), (0.6, 380e3)];
    ForceDeflection::new(&knots.map(|(d, force)| (d * deflections, force * forces)), unloading).unwrap()
}

/// A curve that rises.
fn rising(forces: f64, unloading: f64) -> ForceDeflection {
    let knots = [(0.0, 0.0), (0.05, 150e3), (0.15, 230e3), (0.3, 370e3), (0.5, 520e3)];
    ForceDeflection::new(&knots.map(|(d, force)| (d, force * forces)), unloading).unwrap()
}

/// Chassis, engine behind a gap, compartment: every element, two in parallel.
fn car(numbers: &[f64; 9]) -> Structure {
    let [m1, m2, m3, forces, unloading, rate, gap, limit, k] = *numbers;
    let front = buckling(forces, 1.0, 2e7 * unloading).with_rate(0.01 * rate).unwrap();
    let rails = rising(forces, 1.6e7 * unloading).with_rate(0.008 * rate).unwrap();
    let rails = rails.with_limit(420e3 * limit).unwrap();
    let engine = rising(0.8, 3e7).with_gap(0.25 * gap).unwrap();
    let foam = SeriesSpringDamper { stiffness_n_per_m: 8e5 * k, damping_n_s_per_m: 9e3 };
    let elements: Vec<(&str, &str, Element)> = vec![
        ("wall", "chassis", front.into()),
        ("chassis", "compartment", rails.into()),
        ("wall", "engine", engine.into()),
        ("engine", "compartment", foam.into()),
        ("engine", "compartment", Damper(PiecewiseLinear::constant(1500.0)).into()),
    ];
    Structure::named(&[("chassis", 180.0 * m1), ("engine", 300.0 * m2), ("compartment", 1200.0 * m3)], elements)
        .unwrap()
}

fn collision(structure: &Structure, start: Start, seen_from: Node) -> Collision {
    let questions = CollisionQuestions { seen_from, instants_s: vec![0.03, 0.06, 0.09], places: Vec::new() };
    structure.collision(&Drive::Start(start), 0.2, &questions).unwrap()
}

/// What the balance lacks at the end, over the kinetic energy at the start.
fn lacks(found: &Collision) -> f64 {
    let work: f64 = found.end.elements.iter().map(|element| element.energy.work_j()).sum();
    (found.kinetic_j(&found.end) + work - found.kinetic_start_j).abs() / found.kinetic_start_j
}

/// Only elements that go on with the slope of their last piece change; what they were read from stays.
#[test]
fn a_structure_goes_on_with_the_trends_of_its_curves() {
    let curve = buckling(1.0, 1.0, 2e7).with_rate(0.01).unwrap().with_gap(0.1).unwrap();
    let own = curve.clone().with_extrapolation(Extrapolation::Constant).unwrap();
    let both = Structure::row(&[1000.0], [vec![curve.clone().into(), own.clone().into()]]).unwrap();
    let trend = curve.with_trend_beyond().unwrap();
    let expected = Structure::row(&[1000.0], [vec![trend.clone().into(), own.into()]]).unwrap();
    assert_eq!(both.with_trends_beyond(), expected);
    assert_eq!(expected.clone().with_trends_beyond(), expected);
    assert!(trend.knots().starts_with(curve.knots()));
    assert_eq!((trend.rate_s_per_m(), trend.gap_m()), (0.01, 0.1));
    assert!((0..100).all(|i| {
        let d = 0.6 + 0.01 * f64::from(i);
        trend.static_force_n(d + 0.01) >= trend.static_force_n(d) && trend.static_force_n(d) >= 380e3
    }));
}

proptest! {
    #[test]
    fn energy_closes(numbers in prop::array::uniform9(0.6..1.6f64), v0 in 3.0..20.0f64) {
        let found = collision(&car(&numbers), Start::at_velocities(vec![v0; 3]), Node::Wall);
        prop_assert!(lacks(&found) < 1e-12, "{:e}", lacks(&found));
        for (before, after) in found.instants.iter().zip(found.instants[1..].iter().chain([&found.end])) {
            for (before, after) in before.elements.iter().zip(&after.elements) {
                // Rounding of some 1e5 J.
                prop_assert!(after.energy.plastic_j >= before.energy.plastic_j - 1e-9);
                prop_assert!(after.energy.rate_j >= before.energy.rate_j - 1e-9);
                prop_assert!(after.permanent_set_m >= before.permanent_set_m - 1e-15);
            }
        }
    }

    #[test]
    fn one_knot_is_the_elastoplastic_spring(
        m in 500.0..2500.0f64, k in 1e5..1e6f64, ratio in 1.0..200.0f64, v0 in 2.0..25.0f64,
    ) {
        let model = Elastoplastic {
            mass_kg: m,
            loading_stiffness_n_per_m: k,
            unloading_stiffness_n_per_m: k * ratio,
            release: true,
        };
        let element = ForceDeflection::new(&[(0.0, 0.0), (1.0, k)], k * ratio).unwrap();
        let structure = Structure::row(&[m], [vec![element.into()]]).unwrap();
        let times = [0.01, 0.04, 0.08, 0.15];
        let questions = CollisionQuestions { instants_s: times.to_vec(), ..CollisionQuestions::default() };
        let found = structure.collision(&Drive::Impact(v0), 0.6, &questions).unwrap();
        let events = model.events(v0);
        let (turn, close) = (found.turn.as_ref().unwrap(), |a: f64, b: f64| (a - b).abs() <= 1e-12 * b.abs());
        prop_assert!(close(turn.crush_m, events.dynamic_crush_m.unwrap()));
        prop_assert!(close(turn.moment.time_s, events.time_of_dynamic_crush_s.unwrap()));
        prop_assert!(close(found.separation_s.unwrap(), events.time_of_rebound_s.unwrap()));
        prop_assert!(close(found.coefficient_of_restitution().unwrap(), model.coefficient_of_restitution()));
        // Of a difference of two lengths, one of them up to two hundred times as large.
        prop_assert!((found.end.elements[0].permanent_set_m - model.permanent_set_m(v0)).abs() < 1e-12 * turn.crush_m);
        // The motion of the other element for the same law, which is checked against the closed form.
        let motion = Model::Elastoplastic(model).respond(v0, 0.01, 16).unwrap().compartment().clone();
        for (moment, k) in found.instants.iter().zip([1, 4, 8, 15]) {
            let state = moment.masses[0];
            prop_assert!((state.displacement_m - motion.displacement_m[k]).abs() < 1e-12 * turn.crush_m);
            prop_assert!((state.velocity_m_per_s - motion.velocity_m_per_s[k]).abs() < 1e-12 * v0);
        }
    }

    #[test]
    fn one_mass_with_a_rate_factor_is_its_closed_form(
        m in 800.0..2500.0f64, r in 0.002..0.04f64, v0 in 5.0..25.0f64, gap in 0.0..0.2f64,
    ) {
        let front = rising(1.0, 2e7).with_rate(r).unwrap().with_gap(gap).unwrap();
        let structure = Structure::row(&[m], [vec![front.clone().into()]]).unwrap();
        let found = structure.collision(&Drive::Impact(v0), 0.4, &CollisionQuestions::default()).unwrap();
        let (turn, state) = (found.turn.as_ref().unwrap(), found.turn.as_ref().unwrap().moment.elements[0]);
        // E(C) = m (r v0 - ln(1 + r v0))/r²: the two terms cancel to r v0/2 of the first.
        let wanted = m * (r * v0 - (r * v0).ln_1p()) / (r * r);
        let gap_of_work = (front.static_work_j(turn.crush_m - gap) - wanted).abs() / wanted;
        prop_assert!(gap_of_work < 1e-13 + 1e-15 / (r * v0), "{gap_of_work:e}");
        let restitution = state.force_n / (v0 * (m * 2e7).sqrt());
        prop_assert!((found.coefficient_of_restitution().unwrap() - restitution).abs() < 1e-12);
        let opens = turn.moment.time_s + std::f64::consts::FRAC_PI_2 * (m / 2e7).sqrt();
        prop_assert!((found.separation_s.unwrap() - opens).abs() < 1e-12);
    }

    #[test]
    fn a_shift_of_all_speeds_changes_no_collision(
        numbers in prop::array::uniform9(0.7..1.4f64), closing in 5.0..30.0f64, shift in -30.0..30.0f64,
    ) {
        // Compartment 2, chassis 2, chassis 1, compartment 1; both ends free.
        let [m1, m2, m3, f1, f2, k, gap, ..] = numbers;
        let fronts = rising(f1, 1.2e7 * k).in_series(&rising(f2, 1.5e7)).unwrap();
        let elements: Vec<(&str, &str, Element)> = vec![
            ("a", "b", buckling(1.0, 0.7, 1.8e7).with_rate(0.01).unwrap().into()),
            ("b", "c", fronts.element.with_gap(0.05 * gap).unwrap().into()),
            ("c", "d", rising(1.2, 2e7).into()),
        ];
        let masses = [("a", 1300.0 * m1), ("b", 350.0 * m2), ("c", 330.0 * m3), ("d", 1000.0)];
        let structure = Structure::named(&masses, elements).unwrap();
        let [still, moved] = [0.0, shift].map(|shift| {
            let start = Start::at_velocities(vec![shift, shift, shift + closing, shift + closing]);
            collision(&structure, start, Node::Mass(0))
        });
        let (a, b) = (still.turn.as_ref().unwrap(), moved.turn.as_ref().unwrap());
        // Rounding of positions that are up to ten times as large, over hundreds of steps.
        prop_assert!((a.crush_m - b.crush_m).abs() < 1e-11 && (a.moment.time_s - b.moment.time_s).abs() < 1e-11);
        for (a, b) in still.end.masses.iter().zip(&moved.end.masses) {
            prop_assert!((a.velocity_m_per_s + shift - b.velocity_m_per_s).abs() < 1e-9);
        }
        for (a, b) in still.end.elements.iter().zip(&moved.end.elements) {
            prop_assert!((a.energy.plastic_j - b.energy.plastic_j).abs() < 1e-6, "of some 1e5 J");
        }
        let names = |found: &Collision| found.events.iter().map(|(_, link, event)| (*link, *event)).collect::<Vec<_>>();
        prop_assert_eq!(names(&still), names(&moved));
        for found in [&still, &moved] {
            let momentum = found.momentum_n_s(&found.end);
            let start: f64 = found.velocity_of_centre_of_mass_start_m_per_s * found.masses_kg.iter().sum::<f64>();
            prop_assert!((momentum - start).abs() < 1e-9 * (start.abs() + 1e4));
        }
    }

    #[test]
    fn derivatives_agree_with_central_differences(numbers in prop::array::uniform9(0.85..1.15f64)) {
        let (v0, h) = (14.0, 1e-5);
        let structure = car(&numbers);
        let Element::ForceDeflection(front) = structure.connections()[0].element.clone() else { unreachable!() };
        let Element::ForceDeflection(rails) = structure.connections()[1].element.clone() else { unreachable!() };
        let Element::ForceDeflection(engine) = structure.connections()[2].element.clone() else { unreachable!() };
        let at = |connection: usize, element: &ForceDeflection, parameter| Place::Element {
            connection,
            parameter: element.place_of(parameter).unwrap(),
        };
        // Each changes by itself with one of the factors, or is a velocity.
        let factors: Vec<(usize, Vec<(Place, f64)>)> = vec![
            (0, vec![(Place::Mass(0), 180.0)]),
            (2, vec![(Place::Mass(2), 1200.0)]),
            (4, vec![
                (at(0, &front, ForceDeflectionParameter::Unloading), 2e7),
                (at(1, &rails, ForceDeflectionParameter::Unloading), 1.6e7),
            ]),
            (5, vec![
                (at(0, &front, ForceDeflectionParameter::Rate), 0.01),
                (at(1, &rails, ForceDeflectionParameter::Rate), 0.008),
            ]),
            (6, vec![(at(2, &engine, ForceDeflectionParameter::Gap), 0.25)]),
            (7, vec![(at(1, &rails, ForceDeflectionParameter::Limit), 420e3)]),
        ];
        let instants = Instants { first_s: 0.0, dt_s: 5e-3, samples: 30 };
        for (factor, places) in factors {
            let moved = |by: f64| {
                let mut numbers = numbers;
                numbers[factor] += by;
                car(&numbers).motions_at(v0, &instants).unwrap()
            };
            let asked: Vec<Place> = places.iter().map(|(place, _)| *place).collect();
            let found = structure.sensitivity(v0, &instants, &asked).unwrap();
            let (up, down) = (moved(h), moved(-h));
            let (farther_up, farther_down) = (moved(2.0 * h), moved(-2.0 * h));
            for mass in 0..3 {
                let speed = |motions: &[Motion], k: usize| motions[mass].velocity_m_per_s[k];
                for k in 0..30 {
                    let of_place = |(p, (_, unit)): (usize, &(Place, f64))| unit * speed(&found.derivatives[p], k);
                    let derivative: f64 = places.iter().enumerate().map(of_place).sum();
                    let now = speed(&found.motions, k);
                    let [forward, backward] = [(speed(&up, k) - now) / h, (now - speed(&down, k)) / h];
                    // Where an event lies between, the slope jumps, and the error is a part of the difference of both
                    // sides; rounding of 15 m/s over h is 1e-9.
                    // What the differences cut off shows between steps of h and 2h.
                    let central = 0.5 * (forward + backward);
                    let farther = (speed(&farther_up, k) - speed(&farther_down, k)) / (4.0 * h);
                    let bound = 1e-7 + (forward - backward).abs() + (farther - central).abs();
                    let gap = (central - derivative).abs();
                    prop_assert!(gap < bound, "{factor} {mass} {k}: {forward} {backward} {derivative}");
                }
            }
        }
    }
}

#[test]
fn derivatives_by_knots_and_speeds_agree_with_central_differences() {
    let knots = [(0.0, 0.0), (0.04, 160e3), (0.1, 120e3), (0.24, 200e3), (0.4, 190e3)];
    let model = |knots: [(f64, f64); 5], speeds: [f64; 2], stiffness: f64| {
        let front = ForceDeflection::new(&knots, 2e7).unwrap().with_rate(0.01).unwrap();
        let front = front.with_extrapolation(Extrapolation::Stiffness(stiffness)).unwrap();
        let rails = rising(1.0, 2e7);
        let structure = Structure::row(&[300.0, 1100.0], [vec![front.clone().into()], vec![rails.into()]]).unwrap();
        (structure, Drive::Start(Start::at_velocities(speeds.to_vec())), front)
    };
    let (structure, drive, front) = model(knots, [14.0, 15.0], 8e5);
    let at = |parameter| Place::Element { connection: 0, parameter: front.place_of(parameter).unwrap() };
    let mut places: Vec<Place> = Vec::new();
    for knot in 1..5 {
        places.push(at(ForceDeflectionParameter::KnotForce(knot)));
        places.push(at(ForceDeflectionParameter::KnotDeflection(knot)));
    }
    places.extend([at(ForceDeflectionParameter::Beyond), Place::Velocity(0), Place::Velocity(1), Place::ImpactSpeed]);
    let questions = CollisionQuestions { instants_s: vec![0.05, 0.11], places, ..CollisionQuestions::default() };
    let found = structure.collision(&drive, 0.2, &questions).unwrap();
    let turn = found.turn.as_ref().unwrap();
    for p in 0..questions.places.len() {
        let unit = [1e5, 0.1, 1e5, 0.1, 1e5, 0.1, 1e5, 0.1, 1e6, 1.0, 1.0, 1.0][p];
        let moved = |by: f64| {
            let (mut knots, mut speeds, mut stiffness) = (knots, [14.0, 15.0], 8e5);
            match p {
                0..8 if p % 2 == 0 => knots[p / 2 + 1].1 += by,
                0..8 => knots[p / 2 + 1].0 += by,
                8 => stiffness += by,
                9 | 10 => speeds[p - 9] += by,
                _ => speeds = speeds.map(|speed| speed + by),
            }
            let (structure, drive, _) = model(knots, speeds, stiffness);
            let questions = CollisionQuestions { places: Vec::new(), ..questions.clone() };
            structure.collision(&drive, 0.2, &questions).unwrap()
        };
        let h = 1e-6 * unit;
        let (up, down) = (moved(h), moved(-h));
        let check = |what: &str, found: f64, of: &dyn Fn(&Collision) -> f64| {
            let wanted = (of(&up) - of(&down)) / (2.0 * h);
            // Second order in h, and rounding over h: 1e-14/1e-6.
            assert!((found - wanted).abs() * unit < 1e-6, "{what} by {:?}: {found} {wanted}", questions.places[p]);
        };
        check("crush", turn.crush_by[p], &|c| c.turn.as_ref().unwrap().crush_m);
        check("its time", turn.time_by.as_ref().unwrap()[p], &|c| c.turn.as_ref().unwrap().moment.time_s);
        for k in 0..2 {
            let state = found.instants[k].derivatives[p][1];
            check("position", state.displacement_m, &|c| c.instants[k].masses[1].displacement_m);
            check("velocity", state.velocity_m_per_s, &|c| c.instants[k].masses[1].velocity_m_per_s);
        }
    }
}

#[test]
fn a_path_up_down_and_up_again_meets_the_curve_where_it_left_it() {
    let element = rising(1.0, 2e7).with_gap(0.1).unwrap();
    let legs =
        [(0.2, 4.0), (0.19, -3.0), (0.2, 5.0), (0.25, 1.0)].map(|(to_m, rate_m_per_s)| Leg { to_m, rate_m_per_s });
    let points = lead(&element.clone().into(), &legs).unwrap();
    for (point, d) in [(&points[0], 0.2), (&points[2], 0.2), (&points[3], 0.25)] {
        assert!((point.force_n - element.static_force_n(d)).abs() < 1e-6, "of some 3e5 N");
    }
    assert!((points[0].work_j - element.static_work_j(0.2)).abs() < 1e-8, "of some 4e4 J");
    assert!((points[3].work_j - element.static_work_j(0.25)).abs() < 1e-8, "what went back came in again");
    assert!(lead(&element.into(), &[Leg { to_m: 0.1, rate_m_per_s: -1.0 }]).is_err());
}

#[test]
fn an_occupant_without_slack_under_a_box_swings_about_twice_its_rest() {
    // A linear restraint under a constant deceleration: excursion (1 - cos ω t) a/ω², twice the rest at the most.
    let restraint = ForceDeflection::new(&[(0.0, 0.0), (2.0, 1e5)], 5e4).unwrap();
    let pulse = CrashPulse::Lines(vec![(0.0, 200.0), (0.3, 200.0)]);
    let found = Occupant { mass_kg: 75.0, restraint }.ride(&pulse, 40.0, 0.25).unwrap();
    let squared: f64 = 5e4 / 75.0;
    assert!((found.largest_excursion.value - 400.0 / squared).abs() < 1e-13);
    assert!((found.largest_excursion.time_s - std::f64::consts::PI / squared.sqrt()).abs() < 1e-13);
    assert!((found.peak_deceleration.value - 400.0).abs() < 1e-10);
    assert_eq!(found.contact, Some([0.0; 2]));
    let stop = found.stop.unwrap();
    assert!((stop.ridedown_share + stop.restraint_share - 1.0).abs() < 1e-13);
    assert!(CrashPulse::triangle(1.0, 0.2, 0.1).is_err());
}

#[test]
fn an_occupant_under_a_haversine_moves_as_its_closed_form() {
    // x'' + ω² x = A/2 (1 - cos Ω t) from rest: x = A/2 ((1 - cos ω t)/ω² - (cos Ω t - cos ω t)/(ω² - Ω²)).
    let restraint = ForceDeflection::new(&[(0.0, 0.0), (2.0, 6e5)], 3e5).unwrap();
    let (peak, lasting): (f64, f64) = (300.0, 0.15);
    let omega: f64 = (3e5_f64 / 75.0).sqrt();
    let forcing = std::f64::consts::TAU / lasting;
    let at = |t: f64| {
        let swing = ((forcing * t).cos() - (omega * t).cos()) / (omega * omega - forcing * forcing);
        peak / 2.0 * ((1.0 - (omega * t).cos()) / (omega * omega) - swing)
    };
    let pulse = CrashPulse::Haversine { peak_m_per_s2: peak, duration_s: lasting };
    let found = Occupant { mass_kg: 75.0, restraint }.ride(&pulse, 40.0, 0.25).unwrap();
    let largest = found.largest_excursion;
    assert!(largest.time_s < lasting, "inside the pulse, where the closed form holds: {}", largest.time_s);
    assert!((largest.value - at(largest.time_s)).abs() < 1e-13 && largest.value >= at(largest.time_s + 1e-4));
    assert!(CrashPulse::Haversine { peak_m_per_s2: 1.0, duration_s: 0.0 }.check().is_err());
}

#[test]
fn events_have_their_names() {
    let front = rising(1.0, 2e7).with_gap(0.02).unwrap().with_rate(0.01).unwrap().with_limit(3e5).unwrap();
    let structure = Structure::row(&[1500.0], [vec![front.into()]]).unwrap();
    let found = structure.collision(&Drive::Impact(15.0), 0.3, &CollisionQuestions::default()).unwrap();
    let events: Vec<ElementEvent> = found.events.iter().map(|(_, _, event)| *event).collect();
    use ElementEvent::{Cap, Contact, Knot, Open, Turn};
    assert_eq!(events, [Contact, Knot, Knot, Cap, Knot, Knot, Turn, Open]);
    assert!(lacks(&found) < 1e-13);
}

#[test]
fn what_is_no_element_is_refused() {
    let new = |knots: &[(f64, f64)], unloading: f64| ForceDeflection::new(knots, unloading);
    let says = |refused: Result<ForceDeflection, LumpedError>, what: &str| {
        let error = refused.unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    };
    let good = [(0.0, 0.0), (0.1, 2e5)];
    says(new(&[(0.0, 0.0), (0.1, -1.0)], 1e7), "cannot pull");
    says(new(&[(0.0, 5.0), (0.1, 1e5)], 1e7), "steep ramp");
    says(new(&[(0.1, 0.0), (0.2, 1e5)], 1e7), "gap");
    says(new(&[(0.0, 0.0), (0.1, 1e5), (0.1, 2e5)], 1e7), "above that of the knot before");
    says(new(&[(0.0, 0.0)], 1e7), "two or more");
    says(new(&good, 1.9e6), "steepest slope");
    says(new(&good, f64::NAN), "unloading stiffness");
    says(new(&good, 1e7).unwrap().with_rate(-0.01), "rate factor");
    says(new(&good, 1e7).unwrap().with_gap(-0.01), "gap");
    says(new(&good, 1e7).unwrap().with_limit(0.0), "force limit");
    says(new(&good, 1e7).unwrap().with_extrapolation(Extrapolation::Stiffness(2e7)), "steepest slope");
    assert!(new(&good, 2e6).is_ok(), "as steep as the curve");
    let falling = new(&[(0.0, 0.0), (0.1, 2e5), (0.2, 1e5)], 1e7).unwrap();
    assert!(falling.in_series(&new(&good, 1e7).unwrap()).is_err());
    let structure = Structure::row(&[1000.0], [vec![new(&good, 1e7).unwrap().into()]]).unwrap();
    let ask =
        |drive: Drive, until_s: f64, questions: CollisionQuestions| structure.collision(&drive, until_s, &questions);
    let plain = CollisionQuestions::default();
    assert!(ask(Drive::Start(Start::at_velocities(vec![1.0; 2])), 0.1, plain.clone()).is_err());
    assert!(ask(Drive::Impact(f64::NAN), 0.1, plain.clone()).is_err());
    assert!(ask(Drive::Impact(1.0), 0.0, plain.clone()).is_err());
    assert!(ask(Drive::Impact(1.0), 0.1, CollisionQuestions { instants_s: vec![0.2], ..plain.clone() }).is_err());
    assert!(ask(Drive::Impact(1.0), 0.1, CollisionQuestions { seen_from: Node::Mass(0), ..plain }).is_err());
    assert!(Structure::named(&[("car", 1.0)], [("wall", "cart", new(&good, 1e7).unwrap().into())]).is_err());
}
