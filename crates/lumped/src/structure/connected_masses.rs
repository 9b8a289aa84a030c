//! Masses and what joins them: nodes, connections, and where a parameter stands.

use crate::LumpedError;
use crate::error::positive;
use crate::structure::element::Element;
use crate::structure::elements::crush_curve::Extrapolation;
#[cfg(doc)]
use crate::structure::elements::force_deflection::ForceDeflection;

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
    /// that of the node in front where it is not the one before.
    pub(crate) fn force_names(&self, connection: usize) -> Vec<String> {
        let [front, rear] = self.nodes[connection].map(|node| if node == self.masses_kg.len() { 0 } else { node + 1 });
        let ends = match self.masses_kg.len() {
            1 => String::new(),
            _ if front + 1 == rear => rear.to_string(),
            _ => format!("{front}-{rear}"),
        };
        let symbols = self.connections[connection].element.law().symbols();
        symbols.chars().map(|symbol| format!("{symbol}{ends}")).collect()
    }
}
