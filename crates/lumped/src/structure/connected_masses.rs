//! Masses and what joins them: nodes, connections, and where a parameter stands.
//!
//! Polynomials of degree two in what an element feels.
//!
//! On one branch of its law every element of this crate has a force of this shape, and the instants at which it changes
//! its branch are zeros of such polynomials. So the simulators know forms and nothing of the elements.
//!
//! What an element has to say of itself.
//!
//! An element is a machine of branches. On a branch its force is a [`Form`] of the strain; a branch ends where one of
//! its guards falls through zero. Forces must be continuous there, so that the derivatives of a motion pass through
//! without a jump. What a branch remembers (the permanent set) may depend on parameters: [`Law::set_by`] says how it
//! changes when the branch begins, [`Law::force_by_set`] what that changes in the force.

use crate::LumpedError;
use crate::error::positive;
use crate::motion::collision::ElementEvent;
use crate::structure::crush_curve::Extrapolation;
use crate::structure::elements::{Damper, PlasticSpring, SeriesSpringDamper, Spring};
use crate::structure::force_deflection::ForceDeflection;
use crate::structure::own_force::OwnForce;

/// What an element is fixed to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Node {
    /// The barrier.
    #[default]
    Wall,
    /// The mass of this index, from 0.
    Mass(usize),
}

/// An element between two nodes. It is compressed by the displacement of the rear node less that of the front node, the
/// one nearer to the barrier.
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// The side nearer to the barrier.
    pub front: Node,
    /// The other side.
    pub rear: Node,
    /// What lies between.
    pub element: Element,
}

/// Where a parameter of a structure stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The mass of this index.
    Mass(usize),
    /// The speed of all masses at the start, m/s.
    ImpactSpeed,
    /// The velocity of the mass of this index at the start, m/s.
    Velocity(usize),
    /// The position of the mass of this index at the start, m.
    Position(usize),
    /// A parameter of a law of one's own, wherever it stands among its elements.
    Law(usize),
    /// A parameter of an element, counted as the element says.
    Element {
        /// Index of the connection.
        connection: usize,
        /// Place among the parameters of its element.
        parameter: usize,
    },
}

impl Place {
    /// Derivative of position and velocity of a mass at the start.
    pub(crate) fn of_start(&self, mass: usize) -> [f64; 2] {
        match self {
            Self::ImpactSpeed => [0.0, 1.0],
            Self::Velocity(i) if *i == mass => [0.0, 1.0],
            Self::Position(i) if *i == mass => [1.0, 0.0],
            _ => [0.0, 0.0],
        }
    }
}

/// Masses joined by elements, each between any two nodes: every model of this crate is one.
///
/// Masses are rigid and move along x alone; the barrier is a node that stands still unless it is driven. Elements
/// between the same nodes stand in parallel: their forces add.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    masses_kg: Vec<f64>,
    connections: Vec<Connection>,
    /// Indices of the nodes of each connection; that of the barrier is the number of masses.
    nodes: Vec<[usize; 2]>,
}

impl Structure {
    /// Masses, kg, and what joins them. Errors: no mass, masses that are not positive, a node that is not there, an
    /// element from a node to itself.
    pub fn new(masses_kg: Vec<f64>, connections: Vec<Connection>) -> Result<Self, LumpedError> {
        let n = masses_kg.len();
        masses_kg.iter().try_for_each(|mass| positive("mass_kg", *mass))?;
        let index = |node: Node| match node {
            Node::Wall => n,
            Node::Mass(i) if i < n => i,
            Node::Mass(_) => n + 1,
        };
        let nodes: Vec<[usize; 2]> = connections.iter().map(|c| [index(c.front), index(c.rear)]).collect();
        let expected = "two different nodes of the structure, which has a mass at least";
        let wrong = |[front, rear]: &&[usize; 2]| front == rear || *front > n || *rear > n;
        if n == 0 || nodes.iter().any(|ends| wrong(&ends)) {
            let value = nodes.iter().position(|ends| wrong(&ends)).unwrap_or_default() as f64;
            return Err(LumpedError::Value { name: "number of an element", value, expected });
        }
        Ok(Self { masses_kg, connections, nodes })
    }

    /// Masses in a row, from the barrier on, each with the elements in front of it. Errors: as [`new`](Self::new).
    pub fn row(masses_kg: &[f64], fronts: impl IntoIterator<Item = Vec<Element>>) -> Result<Self, LumpedError> {
        let mut connections = Vec::new();
        for (i, elements) in fronts.into_iter().enumerate() {
            let front = i.checked_sub(1).map_or(Node::Wall, Node::Mass);
            connections.extend(elements.into_iter().map(|element| Connection { front, rear: Node::Mass(i), element }));
        }
        Self::new(masses_kg.to_vec(), connections)
    }

    /// Masses `(name, kg)` and elements `(front, rear, element)` between them; `wall` is the barrier. Errors: as
    /// [`new`](Self::new), a name that no mass has.
    pub fn named<'a>(
        masses: &[(&str, f64)],
        elements: impl IntoIterator<Item = (&'a str, &'a str, Element)>,
    ) -> Result<Self, LumpedError> {
        let node = |name: &str| match masses.iter().position(|(mass, _)| *mass == name) {
            Some(mass) => Ok(Node::Mass(mass)),
            None if name == "wall" => Ok(Node::Wall),
            None => Err(LumpedError::ChainParameter { problem: "has no mass of the name", name: name.to_owned() }),
        };
        let join = |(front, rear, element): (&str, &str, Element)| {
            Ok(Connection { front: node(front)?, rear: node(rear)?, element })
        };
        let connections = elements.into_iter().map(join).collect::<Result<_, LumpedError>>()?;
        Self::new(masses.iter().map(|(_, kg)| *kg).collect(), connections)
    }

    /// The structure for impacts beyond what its curves were read from: each force-deflection element that goes on with
    /// the slope of its last piece goes on with its [trend](ForceDeflection::with_trend_beyond) instead.
    pub fn with_trends_beyond(mut self) -> Self {
        for connection in &mut self.connections {
            let Element::ForceDeflection(element) = &mut connection.element else { continue };
            if element.extrapolation() == Extrapolation::Slope
                && let Ok(extrapolated) = element.with_trend_beyond()
            {
                *element = extrapolated;
            }
        }
        self
    }

    /// Masses, kg.
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// What joins them.
    pub fn connections(&self) -> &[Connection] {
        &self.connections
    }

    /// Each connection with the indices of its front and rear node; that of the barrier is the number of masses.
    pub(crate) fn joined(&self) -> impl Iterator<Item = (&Element, [usize; 2])> {
        self.connections.iter().map(|connection| &connection.element).zip(self.nodes.iter().copied())
    }

    /// Whether every force is linear, for good.
    pub fn is_linear(&self) -> bool {
        self.connections.iter().all(|connection| connection.element.law().is_linear())
    }

    /// Refuses a place that is none.
    pub(crate) fn check_places(&self, places: &[Place]) -> Result<(), LumpedError> {
        let exists = |place: &Place| match *place {
            Place::ImpactSpeed => true,
            Place::Mass(i) | Place::Velocity(i) | Place::Position(i) => i < self.masses_kg.len(),
            Place::Law(parameter) => self.connections.iter().any(|c| parameter < c.element.law().parameters()),
            Place::Element { connection, parameter } => {
                self.connections.get(connection).is_some_and(|c| parameter < c.element.law().parameters())
            }
        };
        match places.iter().position(|place| !exists(place)) {
            Some(p) => {
                let expected = "the place of a mass or of a parameter of an element";
                Err(LumpedError::Value { name: "place number", value: p as f64, expected })
            }
            None => Ok(()),
        }
    }

    /// Names of the forces of an element: its symbols, with the number of the rear mass where there are several, and
    /// that of the node in front where it is not the one before. The second of a symbol between the same nodes ends
    /// with `.2`, as in `k2.2`.
    pub(crate) fn force_names(&self, connection: usize) -> Vec<String> {
        let [front, rear] = self.nodes[connection].map(|node| if node == self.masses_kg.len() { 0 } else { node + 1 });
        let ends = match self.masses_kg.len() {
            1 => String::new(),
            _ if front + 1 == rear => rear.to_string(),
            _ => format!("{front}-{rear}"),
        };
        let symbols = self.connections[connection].element.law().symbols();
        let beside = || (0..connection).filter(|other| self.nodes[*other] == self.nodes[connection]);
        let name = |symbol: char| {
            let symbols_of = |other: usize| self.connections[other].element.law().symbols();
            match beside().filter(|other| symbols_of(*other).contains(symbol)).count() {
                0 => format!("{symbol}{ends}"),
                before => format!("{symbol}{ends}.{}", before + 1),
            }
        };
        symbols.chars().map(name).collect()
    }
}

macro_rules! elements {
    ($($(#[$doc:meta])* $element:ident),+ $(,)?) => {
        /// What joins two nodes of a [`Structure`](crate::Structure).
        #[derive(Debug, Clone, PartialEq)]
        pub enum Element {
            $($(#[$doc])* $element($element),)+
        }

        impl Element {
            /// What it says of itself.
            pub(crate) fn law(&self) -> &dyn Law {
                match self {
                    $(Self::$element(element) => element,)+
                }
            }
        }

        $(impl From<$element> for Element {
            fn from(element: $element) -> Self {
                Self::$element(element)
            }
        })+
    };
}

elements! {
    /// A spring, linear or with knots.
    Spring,
    /// A damper, linear or with knots.
    Damper,
    /// A linear spring and a linear damper in series.
    SeriesSpringDamper,
    /// A spring that unloads stiffer than it loads, about a permanent set.
    PlasticSpring,
    /// A structure that is crushed: a curve of force over deflection with an unloading stiffness.
    ForceDeflection,
    /// A force that a person states.
    OwnForce,
}

/// What an element feels: its compression `u` (m), the rate `w` of it (m/s) and its inner state `z` (m, zero for
/// elements without one).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strain {
    /// Compression, m: displacement of the rear node minus that of the front node.
    pub u: f64,
    /// Rate of it, m/s.
    pub w: f64,
    /// Inner state, m.
    pub z: f64,
}

/// `constant + u U + w W + z Z + uu U² + ww W² + uw U W` of the strain `U, W, Z`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Form {
    /// Without any strain.
    pub constant: f64,
    /// By the compression.
    pub u: f64,
    /// By its rate.
    pub w: f64,
    /// By the inner state.
    pub z: f64,
    /// By the square of the compression.
    pub uu: f64,
    /// By the square of its rate.
    pub ww: f64,
    /// By the product of both.
    pub uw: f64,
}

impl Form {
    /// Nothing, whatever the strain.
    pub const ZERO: Self = Self { constant: 0.0, u: 0.0, w: 0.0, z: 0.0, uu: 0.0, ww: 0.0, uw: 0.0 };

    /// Its value.
    #[inline(always)]
    pub fn at(&self, s: Strain) -> f64 {
        (self.u + self.uu * s.u + self.uw * s.w) * s.u + (self.w + self.ww * s.w) * s.w + self.z * s.z + self.constant
    }

    /// Its derivatives by compression and rate.
    #[inline(always)]
    pub fn slopes(&self, s: Strain) -> [f64; 2] {
        [self.u + 2.0 * self.uu * s.u + self.uw * s.w, self.w + 2.0 * self.ww * s.w + self.uw * s.u]
    }

    /// `self + factor other`.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        Self {
            constant: self.constant + factor * other.constant,
            u: self.u + factor * other.u,
            w: self.w + factor * other.w,
            z: self.z + factor * other.z,
            uu: self.uu + factor * other.uu,
            ww: self.ww + factor * other.ww,
            uw: self.uw + factor * other.uw,
        }
    }
}

/// The branch an element is on, and what it remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Branch {
    /// Number of the branch; what it means is the element's own affair.
    pub line: usize,
    /// Permanent set, m.
    pub set: f64,
    /// Largest compression so far, m.
    pub crush: f64,
    /// Plastic work so far, less what the branch itself tells, J.
    pub plastic_j: f64,
}

/// A branch ends where `form` falls through zero; the next one has the number `next`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard {
    /// Positive on the branch.
    pub form: Form,
    /// The line that follows.
    pub next: usize,
}

/// The law of an element: force, branches, energies, derivatives. SI units; parameters by their place.
pub trait Law {
    /// Number of parameters.
    fn parameters(&self) -> usize;

    /// Whether the force is one linear form, for good.
    fn is_linear(&self) -> bool {
        !self.has_branches()
    }

    /// Whether its force has more than one branch, whatever the values of its parameters.
    fn has_branches(&self) -> bool;

    /// The branch it starts on.
    fn start(&self, _strain: Strain) -> Branch {
        Branch::default()
    }

    /// Force, N, positive in compression.
    fn force(&self, branch: &Branch) -> Form;

    /// Adds the guards of a branch.
    fn guards(&self, _branch: &Branch, _add: &mut dyn FnMut(Guard)) {}

    /// The branch that follows on the line `next`.
    fn enter(&self, branch: &Branch, next: usize, _strain: Strain) -> Branch {
        Branch { line: next, ..*branch }
    }

    /// What a change of branch is, if it is one to tell of.
    fn event(&self, _before: &Branch, _after: &Branch) -> Option<ElementEvent> {
        None
    }

    /// Rate of the inner state, m/s; `None` without one.
    fn inner_rate(&self) -> Option<Form> {
        None
    }

    /// Derivative of the force by a parameter, the memory as it is.
    fn force_by(&self, branch: &Branch, parameter: usize) -> Form;

    /// Derivative of the rate of the inner state by a parameter.
    fn inner_rate_by(&self, _parameter: usize) -> Form {
        Form::ZERO
    }

    /// Derivative of the force by the permanent set.
    fn force_by_set(&self, _branch: &Branch) -> Form {
        Form::ZERO
    }

    /// Derivative of the permanent set, after `before` ended at `strain`, by something that changes the compression
    /// there by `by_u`; `parameter` is the place it has in this element, if it has one. `set` is that derivative
    /// before.
    fn set_by(&self, _before: &Branch, _strain: Strain, _by_u: f64, _parameter: Option<usize>, set: f64) -> f64 {
        set
    }

    /// Energy that it can give back, and energy turned into plastic deformation so far, J.
    fn energies(&self, branch: &Branch, strain: &Strain) -> [f64; 2];

    /// Force of its damper, or what the rate adds to its force, N: heat is this times the rate of the compression less
    /// that of the inner state.
    fn damping(&self, _branch: &Branch) -> Form {
        Form::ZERO
    }

    /// Whether that heat is the rate effect of a structure and not of a damper.
    fn has_rate_effect(&self) -> bool {
        false
    }

    /// The law of one's own that it is: its force need not be a form.
    fn as_own(&self) -> Option<&OwnForce> {
        None
    }

    /// Symbols of the parts whose forces are written: springs `k`, dampers `c`.
    fn symbols(&self) -> &'static str;

    /// How far it is deflected, m: the compression, without a gap.
    fn deflection(&self, strain: &Strain) -> f64 {
        strain.u
    }

    /// Deflection of one of its parts, m.
    fn compression(&self, _part: usize, strain: &Strain) -> f64 {
        self.deflection(strain)
    }
}
