//! Two structures front against front, or a structure against a rigid body that moves: one structure.
//!
//! The wall of each gives way to the front of the other. Where that is a rigid body, its mass stands in place of the
//! wall; where both fronts are one curve each that never falls, without a rate factor, they are one element in series;
//! everywhere else a small mass lies between the fronts, [`CONTACT_SHARE`] of the lighter structure, for then the
//! massless point between is no function of the whole.

use std::ops::Range;

use crate::motion::collision::{Meeting, MeetingState};
use crate::response::collisions::CollisionQuestions;
use crate::response::motions::meeting;
use crate::structure::connected_masses::{Connection, Element, Node, Strain, Structure};
use crate::structure::crush_curve::InSeries;
use crate::structure::force_deflection::ForceDeflection;
use crate::{Drive, LumpedError, Start};

/// Mass between two fronts that are no element in series, as a share of the lighter structure: what it changes in a
/// velocity is at most this share.
pub const CONTACT_SHARE: f64 = 1e-3;

/// Whose an element is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Owner {
    Partner,
    Own,
    Both,
}

/// What the fronts meet in.
#[derive(Debug, Clone, PartialEq)]
enum Contact {
    /// The partner is rigid: its first mass.
    Rigid,
    /// One element: both fronts in series, own first, and the masses behind them.
    InSeries(Box<(InSeries, [ForceDeflection; 2])>, [usize; 2]),
    /// The mass of this index.
    Mass(usize),
}

/// Two structures as one. Its masses are those of the partner, from its front on, a contact mass where there is one,
/// and the own ones, so that the last is the own compartment. Velocities are on one axis, positive as the own ones.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontToFront {
    structure: Structure,
    velocities_m_per_s: Vec<f64>,
    partner: usize,
    own_from: usize,
    contact: Contact,
    owners: Vec<Owner>,
}

/// The element as a force-deflection curve, if it is one and stays one in series.
fn as_curve(element: &Element) -> Option<ForceDeflection> {
    match element {
        Element::ForceDeflection(curve) if curve.gap_m() == 0.0 => Some(curve.clone()),
        Element::PlasticSpring(spring) if spring.release => {
            let knots = [(0.0, 0.0), (1.0, spring.loading_stiffness_n_per_m)];
            ForceDeflection::new(&knots, spring.unloading_stiffness_n_per_m).ok()
        }
        _ => None,
    }
}

/// The elements of a structure on the wall.
fn fronts(structure: &Structure) -> Vec<&Connection> {
    structure.connections().iter().filter(|connection| connection.front == Node::Wall).collect()
}

/// The only front, as a curve, and the mass behind it.
fn only_curve(structure: &Structure) -> Option<(ForceDeflection, usize)> {
    match fronts(structure)[..] {
        [Connection { rear: Node::Mass(behind), element, .. }] => Some((as_curve(element)?, *behind)),
        _ => None,
    }
}

/// Damping and stiffness of a front at first contact at half the closing speed, N·s/m and N/m.
fn resistance(structure: &Structure, closing: f64) -> [f64; 2] {
    let strain = Strain { w: 0.5 * closing, ..Strain::default() };
    let forms = fronts(structure).into_iter().map(|connection| {
        let law = connection.element.law();
        if let Some(own) = law.as_own() {
            return own.slopes(strain);
        }
        let form = law.force(&law.start(strain));
        [form.w + form.ww * strain.w, form.u + form.uw * strain.w]
    });
    forms.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]])
}

impl FrontToFront {
    /// The own structure at a velocity, m/s, against a partner that comes towards it at a speed of its own, m/s,
    /// negative where it runs ahead. A partner without an element on the wall is rigid.
    ///
    /// Errors: no closing speed, a structure that is none.
    pub fn new(own: &Structure, velocity: f64, partner: &Structure, speed: f64) -> Result<Self, LumpedError> {
        let closing = velocity + speed;
        crate::error::positive("closing speed", closing)?;
        let behind = partner.masses_kg().len();
        let series = only_curve(own).zip(only_curve(partner));
        let series = series.and_then(|(a, b)| Some((a.0.in_series(&b.0).ok()?, a, b)));
        let is_rigid = fronts(partner).is_empty();
        let has_mass = !is_rigid && series.is_none();
        let own_from = behind + usize::from(has_mass);
        let mut masses_kg = partner.masses_kg().to_vec();
        let mut velocities_m_per_s = vec![-speed; behind];
        if has_mass {
            let total = |structure: &Structure| structure.masses_kg().iter().sum::<f64>();
            masses_kg.push(CONTACT_SHARE * total(own).min(total(partner)));
            let [[c, k], [partner_c, partner_k]] = [own, partner].map(|structure| resistance(structure, closing));
            let (here, there) = if c + partner_c > 0.0 { (c, partner_c) } else { (k, partner_k) };
            let share = if here + there > 0.0 { (here / (here + there)).clamp(0.0, 1.0) } else { 0.5 };
            // The velocity at which a point without mass would feel no force.
            velocities_m_per_s.push(share * velocity - (1.0 - share) * speed);
        }
        masses_kg.extend(own.masses_kg());
        velocities_m_per_s.resize(masses_kg.len(), velocity);
        let meets = if has_mass { Node::Mass(behind) } else { Node::Mass(0) };
        let node = |node: Node, from: usize| match node {
            Node::Wall => meets,
            Node::Mass(i) => Node::Mass(from + i),
        };
        let inner = |c: &&Connection| series.is_none() || c.front != Node::Wall;
        let mut connections = Vec::new();
        // Of the partner, which looks the other way, front and rear change places.
        connections.extend(partner.connections().iter().filter(inner).map(|c| Connection {
            front: node(c.rear, 0),
            rear: node(c.front, 0),
            element: c.element.clone(),
        }));
        let mut owners = vec![Owner::Partner; connections.len()];
        connections.extend(own.connections().iter().filter(inner).map(|c| Connection {
            front: node(c.front, own_from),
            rear: node(c.rear, own_from),
            element: c.element.clone(),
        }));
        owners.resize(connections.len(), Owner::Own);
        let contact = match series {
            Some((series, (front, mass), (partner_front, partner_mass))) if !is_rigid => {
                let masses = [own_from + mass, partner_mass];
                let [rear, front_node] = masses.map(Node::Mass);
                let element = series.element.clone().into();
                connections.push(Connection { front: front_node, rear, element });
                owners.push(Owner::Both);
                Contact::InSeries(Box::new((series, [front, partner_front])), masses)
            }
            _ if has_mass => Contact::Mass(behind),
            _ => Contact::Rigid,
        };
        let structure = Structure::new(masses_kg, connections)?;
        Ok(Self { structure, velocities_m_per_s, partner: behind, own_from, contact, owners })
    }

    /// Both as one structure.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Every mass at its velocity.
    pub fn start(&self) -> Start {
        Start::at_velocities(self.velocities_m_per_s.clone())
    }

    /// Velocities at the start, m/s.
    pub fn velocities_m_per_s(&self) -> &[f64] {
        &self.velocities_m_per_s
    }

    /// Places of the own masses, from the front to the compartment.
    pub fn own(&self) -> Range<usize> {
        self.own_from..self.structure.masses_kg().len()
    }

    /// Places of the partner's masses, from its front to its compartment.
    pub fn partner(&self) -> Range<usize> {
        0..self.partner
    }

    /// The mass between the fronts, kg, where there is one.
    pub fn contact_mass_kg(&self) -> Option<f64> {
        match self.contact {
            Contact::Mass(place) => Some(self.structure.masses_kg()[place]),
            _ => None,
        }
    }

    /// Common velocity and parting of the compartments, within a horizon, s. Errors: a motion that cannot be followed.
    pub fn meeting(&self, horizon_s: f64) -> Result<Meeting, LumpedError> {
        meeting(&self.structure, self.start(), self.partner - 1, horizon_s)
    }

    /// Where the fronts meet, m from first contact, at displacements of the masses and the largest deflection of the
    /// last element until then.
    pub fn contact_m(&self, displacement: impl Fn(usize) -> f64, largest_m: f64) -> f64 {
        match &self.contact {
            Contact::Rigid => displacement(0),
            Contact::Mass(place) => displacement(*place),
            Contact::InSeries(series, [own, partner]) => {
                let (series, [front, _]) = series.as_ref();
                let drop_n = self.drop_n(displacement(*own) - displacement(*partner), largest_m);
                let crush_m = series.shared(largest_m)[0] - drop_n / front.unloading_n_per_m();
                displacement(*own) - crush_m
            }
        }
    }

    /// What the force of fronts in series has lost since their largest deflection, N.
    fn drop_n(&self, deflection_m: f64, largest_m: f64) -> f64 {
        let Contact::InSeries(series, _) = &self.contact else { return 0.0 };
        let element = &series.0.element;
        let back_n = element.unloading_n_per_m() * (largest_m - deflection_m).max(0.0);
        back_n.min(element.static_force_n(largest_m))
    }

    /// Energy that the own elements and those of the partner have taken at an instant, J, stored or not.
    /// Errors: a motion that cannot be followed.
    pub fn absorbed_j(&self, at: &MeetingState) -> Result<[f64; 2], LumpedError> {
        let questions = CollisionQuestions { seen_from: Node::Mass(self.partner - 1), ..CollisionQuestions::default() };
        let end = self.structure.collision(&Drive::Start(self.start()), at.time_s, &questions)?.end;
        let mut sums = [0.0; 2];
        for (state, owner) in end.elements.iter().zip(&self.owners) {
            match owner {
                Owner::Own => sums[0] += state.energy.work_j(),
                Owner::Partner => sums[1] += state.energy.work_j(),
                Owner::Both => {}
            }
        }
        if let (Contact::InSeries(series, _), Some(state)) = (&self.contact, end.elements.last()) {
            let largest_m = at.largest_m.last().copied().unwrap_or(0.0).max(state.deflection_m);
            let (series, fronts) = series.as_ref();
            let force_n = series.element.static_force_n(largest_m);
            let left_n = force_n - self.drop_n(state.deflection_m, largest_m);
            for ((sum, front), crush_m) in sums.iter_mut().zip(fronts).zip(series.shared(largest_m)) {
                let given_back = 0.5 * (force_n * force_n - left_n * left_n) / front.unloading_n_per_m();
                *sum += front.static_work_j(crush_m) - given_back;
            }
        }
        Ok(sums)
    }

    /// Whether the shares of the crush are open: both fronts on plateaus of the same force.
    pub fn is_share_open(&self, largest_m: f64) -> bool {
        matches!(&self.contact, Contact::InSeries(series, _) if series.0.is_share_open(largest_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Elastoplastic, Kelvin, Model};

    fn front(knots: &[(f64, f64)]) -> ForceDeflection {
        ForceDeflection::new(knots, 2e7).unwrap()
    }

    fn vehicle(mass_kg: f64, front: &ForceDeflection) -> Structure {
        Structure::row(&[mass_kg], [vec![front.clone().into()]]).unwrap()
    }

    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() <= tolerance * expected.abs().max(1e-3), "{value}, expected {expected}");
    }

    #[test]
    fn a_contact_mass_errs_by_its_share() {
        let curves = [front(&[(0.0, 0.0), (0.3, 2e5), (0.6, 3e5)]), front(&[(0.0, 0.0), (0.2, 2.5e5), (0.5, 2.6e5)])];
        let exact = FrontToFront::new(&vehicle(1500.0, &curves[0]), 12.0, &vehicle(900.0, &curves[1]), 9.0).unwrap();
        // A rate factor that does nothing still keeps the fronts from being one element.
        let rated = curves.clone().map(|curve| curve.with_rate(1e-12).unwrap());
        let joined = FrontToFront::new(&vehicle(1500.0, &rated[0]), 12.0, &vehicle(900.0, &rated[1]), 9.0).unwrap();
        assert_eq!(joined.contact_mass_kg(), Some(0.9));
        let crush = |joined: &FrontToFront| {
            let common = joined.meeting(2.0).unwrap().common.unwrap();
            let absorbed = joined.absorbed_j(&common).unwrap();
            let largest = common.largest_m.last().copied().unwrap();
            let [own, partner] = [joined.own().end - 1, joined.partner().end - 1];
            let contact = joined.contact_m(|i| common.masses[i].displacement_m, largest);
            let place = |i: usize| common.masses[i].displacement_m;
            [place(own) - contact, contact - place(partner), absorbed[0], absorbed[1]]
        };
        let (a, b) = (crush(&exact), crush(&joined));
        // The contact mass is a thousandth of the lighter vehicle: it changes crush and energy by parts of a percent.
        for (exact, with_mass) in a.iter().zip(b) {
            close(with_mass, *exact, 5e-3);
        }
    }

    #[test]
    fn equals_meet_as_at_a_wall_at_half_the_closing_speed() {
        let kelvin = Model::Kelvin(Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 5e3 });
        let spring = Elastoplastic {
            mass_kg: 1000.0,
            loading_stiffness_n_per_m: 4e5,
            unloading_stiffness_n_per_m: 1.6e7,
            release: true,
        };
        for model in [kelvin, Model::Elastoplastic(spring)] {
            let structure = model.structure().unwrap();
            let wall = structure.events(10.0, 2.0).unwrap().pop().unwrap();
            for (own, partner) in [(10.0, 10.0), (20.0, 0.0), (0.0, 20.0)] {
                let joined = FrontToFront::new(&structure, own, &structure, partner).unwrap();
                let Meeting { common: Some(common), parting: Some(parting) } = joined.meeting(2.0).unwrap() else {
                    panic!()
                };
                let last = joined.own().end - 1;
                let mean = 0.5 * (own - partner);
                close(common.time_s, wall.time_of_dynamic_crush_s.unwrap(), 1e-9);
                close(common.masses[last].displacement_m - mean * common.time_s, wall.dynamic_crush_m.unwrap(), 1e-9);
                close(parting.time_s, wall.time_of_rebound_s.unwrap(), 1e-9);
                close(parting.masses[last].velocity_m_per_s - mean, wall.rebound_velocity_m_per_s.unwrap(), 1e-8);
            }
        }
    }

    /// What each takes of a crush that both share in proportion is open, and told.
    #[test]
    fn plateaus_of_the_same_force_leave_the_shares_open() {
        let plateau = vehicle(1500.0, &front(&[(0.0, 0.0), (0.02, 2e5), (0.5, 2e5)]));
        let joined = FrontToFront::new(&plateau, 10.0, &plateau, 0.0).unwrap();
        assert!(joined.is_share_open(joined.meeting(2.0).unwrap().common.unwrap().largest_m[0]));
        let rising = vehicle(1500.0, &front(&[(0.0, 0.0), (0.3, 2e5), (0.6, 3e5)]));
        let joined = FrontToFront::new(&rising, 10.0, &rising, 0.0).unwrap();
        assert!(!joined.is_share_open(joined.meeting(2.0).unwrap().common.unwrap().largest_m[0]));
    }

    #[test]
    fn a_heavy_rigid_partner_is_the_wall() {
        let model = Model::Kelvin(Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 4e5, damping_n_s_per_m: 5e3 });
        let structure = model.structure().unwrap();
        let wall = structure.events(10.0, 2.0).unwrap().pop().unwrap();
        let block = Structure::new(vec![1e9], Vec::new()).unwrap();
        let joined = FrontToFront::new(&structure, 10.0, &block, 0.0).unwrap();
        let common = joined.meeting(2.0).unwrap().common.unwrap();
        // The block gives way as its mass is to that of the vehicle: 1e-6.
        close(common.masses[1].displacement_m, wall.dynamic_crush_m.unwrap(), 1e-5);
        assert!(FrontToFront::new(&structure, 10.0, &block, -10.0).is_err());
    }
}
