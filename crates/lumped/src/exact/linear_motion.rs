//! Linear equations of motion and their exact motion: one matrix exponential a step.
//!
//! The matrix of a structure whose forces are all linear, and its derivatives by the parameters.
//!
//! State: displacements of the masses, their velocities, the inner states of the elements that have one. Every entry is
//! linear in the forces of the elements, and the rows of velocities are over the masses.
//!
//! The kernel of `y'' + 2a y' + b y = 0`, which the single-mass models share.
//!
//! Kelvin solves it for the displacement, with `2a = c/m` and `b = k/m`; Maxwell for the velocity, with `2a = k/c` and
//! `b = k/m`. Critical damping lies inside the range of both, so all forms pass through it without a difference of two
//! large numbers.
//!
//! Linear motions of any structure with their derivatives by the parameters.
//!
//! Every motion here is `z' = A z` from a start, marched by `phi = exp(A dt)` from sample to sample. A derivative by a
//! parameter p, `s = dz/dp`, obeys `s' = A s + (dA/dp) z`, so it is marched by the same step and the derivative of it:
//! `s(t + dt) = phi s(t) + (dphi/dp) z(t)` ([`derivatives`](crate::exact::derivatives)).
//!
//! Error: that of the exponential, about `1e-16 2^s` with `s = log2(2 |A| dt)` squarings, and one rounding a sample.
//! Cost of a sample with P parameters and N states: `(2 P + 1) N²` products for the step and half as many for
//! accelerations.

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, Dim, Dyn, OMatrix, OVector, U1};
use pulp::Arch;

use crate::exact::derivatives::{ABREAST, DerivativesAbreast, FEW};
use crate::motion::mass_motion::Asked;
use crate::structure::connected_masses::{Form, Place, Strain, Structure};
use crate::{Instants, Motion, Sensitivity, Start};

/// Force and rate of the inner state of an element, with its nodes and the place of the inner state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinearElement {
    pub nodes: [usize; 2],
    pub force: Form,
    /// Rate of the inner state and its row.
    pub inner: Option<(Form, usize)>,
    /// Force of the damper.
    pub damping: Form,
}

/// A structure on the one branch that each of its elements has.
#[derive(Debug, Clone)]
pub(crate) struct LinearSystem<'a> {
    structure: &'a Structure,
    pub elements: Vec<LinearElement>,
    /// Number of masses.
    pub masses: usize,
    /// Number of states. The displacement of the barrier would come next, then its velocity.
    pub states: usize,
}

impl<'a> LinearSystem<'a> {
    /// The system, if the structure is linear for good.
    pub fn new(structure: &'a Structure) -> Option<Self> {
        if !structure.is_linear() {
            return None;
        }
        let masses = structure.masses_kg().len();
        let mut states = 2 * masses;
        let element = |(element, nodes): (&crate::Element, [usize; 2])| {
            let law = element.law();
            let branch = law.start(Strain::default());
            let inner = law.inner_rate().map(|form| {
                states += 1;
                (form, states - 1)
            });
            LinearElement { nodes, force: law.force(&branch), inner, damping: law.damping(&branch) }
        };
        let elements = structure.joined().map(element).collect();
        Some(Self { structure, elements, masses, states })
    }

    /// Masses, kg.
    pub fn masses_kg(&self) -> &[f64] {
        self.structure.masses_kg()
    }

    /// Places of displacement and velocity of a node in the state; those of the barrier beyond it.
    pub fn place_of(&self, node: usize) -> (usize, usize) {
        if node == self.masses { (self.states, self.states + 1) } else { (node, self.masses + node) }
    }

    /// Adds the row of a form of the strain of an element: `add(column, value)`; velocities are times `tau_s`.
    pub fn row(&self, element: &LinearElement, form: &Form, tau_s: f64, add: &mut dyn FnMut(usize, f64)) {
        let [front, rear] = element.nodes.map(|node| self.place_of(node));
        for ((x, v), sign) in [(rear, 1.0), (front, -1.0)] {
            add(x, sign * form.u);
            add(v, sign * form.w / tau_s);
        }
        if let Some((_, row)) = element.inner {
            add(row, form.z);
        }
    }

    /// Adds what an element of force `force` and rate of its inner state `inner` gives to the matrix, in time units of
    /// `tau_s`: `add(row, column, value)`.
    fn element_entries(
        &self,
        element: &LinearElement,
        (force, inner): (&Form, &Form),
        tau_s: f64,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let [front, rear] = element.nodes;
        for (node, sign) in [(rear, -1.0), (front, 1.0)] {
            if node < self.masses {
                let factor = sign * tau_s * tau_s / self.structure.masses_kg()[node];
                self.row(element, force, tau_s, &mut |column, value| add(self.masses + node, column, factor * value));
            }
        }
        if let Some((_, row)) = element.inner {
            self.row(element, inner, tau_s, &mut |column, value| add(row, column, tau_s * value));
        }
    }

    /// Adds the entries of the matrix in time units of `tau_s`: `add(row, column, value)`, columns of the barrier
    /// among them.
    pub fn entries(&self, tau_s: f64, add: &mut dyn FnMut(usize, usize, f64)) {
        for i in 0..self.masses {
            add(i, self.masses + i, 1.0);
        }
        for element in &self.elements {
            let inner = element.inner.map_or(Form::ZERO, |(inner, _)| inner);
            self.element_entries(element, (&element.force, &inner), tau_s, add);
        }
    }

    /// Adds the entries of the derivative of the matrix by a parameter.
    pub fn entries_by(&self, place: Place, tau_s: f64, add: &mut dyn FnMut(usize, usize, f64)) {
        match place {
            Place::Mass(mass) => {
                let per_mass = -1.0 / self.structure.masses_kg()[mass];
                self.entries(tau_s, &mut |row, column, value| {
                    if row == self.masses + mass {
                        add(row, column, per_mass * value);
                    }
                });
            }
            Place::ImpactSpeed | Place::Velocity(_) | Place::Position(_) => {}
            Place::Law(parameter) => {
                for connection in 0..self.elements.len() {
                    self.entries_by(Place::Element { connection, parameter }, tau_s, add);
                }
            }
            Place::Element { connection, parameter } => {
                let law = self.structure.connections()[connection].element.law();
                let (force, inner) =
                    (law.force_by(&law.start(Strain::default()), parameter), law.inner_rate_by(parameter));
                self.element_entries(&self.elements[connection], (&force, &inner), tau_s, add);
            }
        }
    }

    /// A time unit in which the fastest swing is of size one, s; one second where nothing is stiff.
    ///
    /// The square root of the largest ratio of stiffness to mass is the fastest natural frequency to within a factor
    /// of two; its reciprocal brings positions and scaled velocities to one size.
    pub fn time_unit_s(&self) -> f64 {
        let mut stiffness = vec![0.0; self.masses + 1];
        let mut fastest = 0.0_f64;
        for element in &self.elements {
            for node in element.nodes {
                stiffness[node] += element.force.u + element.force.z;
            }
            fastest = fastest.max(element.inner.map_or(0.0, |(inner, _)| inner.z * inner.z));
        }
        let masses = self.structure.masses_kg();
        let fastest = masses.iter().zip(&stiffness).map(|(m, k)| (k / m).abs()).fold(fastest, f64::max);
        if fastest > 0.0 && fastest.is_finite() { fastest.sqrt().recip() } else { 1.0 }
    }
}

/// Taylor terms after scaling to a norm of 1/2: the rest of the series is below `0.5^17/17! = 3e-20`, and of its
/// derivative below `0.5^16/16! = 8e-19`.
pub(crate) const TERMS: usize = 16;

/// Powers of the matrix that are formed: the series is one in the last of them, whose coefficients are sums of the
/// others (Paterson, Stockmeyer, *On the number of nonscalar multiplications necessary to evaluate polynomials*, 1973):
/// six products instead of fifteen.
pub(crate) const POWERS: usize = 4;

/// `1/k!` of the terms of the series.
pub(crate) const INVERSE_FACTORIALS: [f64; TERMS + 1] = {
    let mut inverse = [1.0; TERMS + 1];
    let mut k = 1;
    while k <= TERMS {
        inverse[k] = inverse[k - 1] / k as f64;
        k += 1;
    }
    inverse
};

/// Halvings of a step after which a matrix of this norm is below 1/2. Beyond 2^60 the result is zero or infinite
/// anyway.
pub(crate) fn squarings_of(norm: f64) -> i32 {
    if norm > 0.5 { ((2.0 * norm).log2().ceil() as i32).clamp(0, 60) } else { 0 }
}

/// `y'' + 2·half_damping·y' + stiffness·y = 0`: coefficients in 1/s and 1/s², any sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SecondOrder {
    pub half_damping: f64,
    pub stiffness: f64,
}

/// Position of the two roots of the characteristic polynomial.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Roots {
    /// `-a ± i·w`, w > 0, rad/s.
    Complex { w: f64 },
    /// `-a ± s`, s >= 0 (equal: critical damping); `upper = -a + s` without cancellation.
    Real { s: f64, upper: f64 },
}

impl SecondOrder {
    /// Roots, with the discriminant `b - a²` formed as a product, so that it is right to rounding near critical
    /// damping.
    pub fn roots(self) -> Roots {
        let Self { half_damping: a, stiffness: b } = self;
        let discriminant = if b > 0.0 { (b.sqrt() - a.abs()) * (b.sqrt() + a.abs()) } else { b - a * a };
        if discriminant > 0.0 {
            return Roots::Complex { w: discriminant.sqrt() };
        }
        let s = (-discriminant).sqrt();
        // -a + s = -b/(a + s): the first loses all digits for strong damping.
        let upper = if a > 0.0 { -b / (a + s) } else { -a + s };
        Roots::Real { s, upper }
    }

    /// `(e^(-a t) cos w t, e^(-a t) sin(w t)/w)`, continued to hyperbolic functions beyond critical damping.
    ///
    /// The first solves `y(0) = 1, y'(0) = -a`, the second `y(0) = 0, y'(0) = 1`.
    pub fn kernel(self, t: f64) -> (f64, f64) {
        match self.roots() {
            Roots::Complex { w } => {
                let envelope = (-self.half_damping * t).exp();
                (envelope * (w * t).cos(), envelope * (w * t).sin() / w)
            }
            Roots::Real { s, upper } => {
                let envelope = (upper * t).exp();
                let sine = if s * t == 0.0 { t } else { -(-2.0 * s * t).exp_m1() / (2.0 * s) };
                (envelope * 0.5 * (1.0 + (-2.0 * s * t).exp()), envelope * sine)
            }
        }
    }

    /// `y'` for `y(0) = 0, y'(0) = 1`: `cos - a·sin/w` with its envelope, without cancellation for strong damping.
    pub fn step_rate(self, t: f64) -> f64 {
        match self.roots() {
            Roots::Real { s, upper } if s > 0.1 * self.half_damping.abs() => {
                let lower = -self.half_damping - s;
                (upper * t).exp() * (upper - lower * (-2.0 * s * t).exp()) / (2.0 * s)
            }
            _ => {
                let (cosine, sine) = self.kernel(t);
                cosine - self.half_damping * sine
            }
        }
    }
}

type Square<D> = OMatrix<f64, D, D>;

/// `z' = A z` in a time unit in which the fastest swing is of size one: state `(x, tau v, z)`, time in `tau`.
///
/// Unbalanced, the exponential of a car (stiffness over mass near 1e3/s²) loses three digits. Sizes of the usual
/// models are known to the compiler: a fit marches millions of steps of a few products.
pub(crate) struct LinearMotion<D: Dim>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    pub masses: usize,
    pub tau_s: f64,
    /// The matrix in the time unit.
    pub a: Square<D>,
    /// The state at the start.
    pub start: OVector<f64, D>,
}

/// The motion at these instants after an impact, with its derivatives by the parameters at `places`. What is not asked
/// for may stay empty.
pub(crate) fn sensitivity(
    system: &LinearSystem,
    start: &Start,
    at: &Instants,
    asked: Asked,
    places: &[Place],
) -> Sensitivity {
    if places.is_empty() {
        let motions = match system.states {
            2 => LinearMotion::new(Const::<2>, system, start).march(at, asked),
            3 => LinearMotion::new(Const::<3>, system, start).march(at, asked),
            4 => LinearMotion::new(Const::<4>, system, start).march(at, asked),
            6 => LinearMotion::new(Const::<6>, system, start).march(at, asked),
            n => LinearMotion::new(Dyn(n), system, start).march(at, asked),
        };
        return Sensitivity { motions, derivatives: Vec::new() };
    }
    let motion = LinearMotion::new(Dyn(system.states), system, start);
    let mut sensitivity = Sensitivity { motions: Vec::new(), derivatives: Vec::with_capacity(places.len()) };
    for places in places.chunks(ABREAST) {
        let by_some = if places.len() > FEW { by_lanes::<ABREAST> } else { by_lanes::<FEW> };
        let (motions, derivatives) = by_some((system, &motion), at, asked, places);
        sensitivity.motions = motions;
        sensitivity.derivatives.extend(derivatives);
    }
    sensitivity
}

/// The motion and its derivatives by at most `L` parameters.
fn by_lanes<const L: usize>(
    (system, motion): (&LinearSystem, &LinearMotion<Dyn>),
    at: &Instants,
    asked: Asked,
    places: &[Place],
) -> (Vec<Motion>, Vec<Vec<Motion>>) {
    let (n, tau_s, masses) = (system.states, motion.tau_s, system.masses);
    let (mut da, mut start_by) = (vec![[0.0; L]; n * n], vec![[0.0; L]; n]);
    for (lane, place) in places.iter().enumerate() {
        system.entries_by(*place, tau_s, &mut |row, column, value| {
            if column < n {
                da[row * n + column][lane] += value;
            }
        });
        let state = state_of(system, tau_s, &|mass| place.of_start(mass));
        start_by.iter_mut().zip(state).for_each(|(lanes, value)| lanes[lane] = value);
    }
    let (a, start, filled) = (motion.a.transpose(), motion.start.as_slice(), places.len());
    let (a, da, start_by) = (a.as_slice(), &*da, &*start_by);
    Arch::new().dispatch(DerivativesAbreast { masses, tau_s, a, da, start, start_by, filled, at, asked })
}

/// The state of masses that are at `[x, v]`.
fn state_of(system: &LinearSystem, tau_s: f64, of_mass: &dyn Fn(usize) -> [f64; 2]) -> Vec<f64> {
    let mut state = vec![0.0; system.states];
    for mass in 0..system.masses {
        let [x, v] = of_mass(mass);
        (state[mass], state[system.masses + mass]) = (x, v * tau_s);
    }
    state
}

impl<D: Dim> LinearMotion<D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    /// `size`: number of states of the system.
    pub fn new(size: D, system: &LinearSystem, start: &Start) -> Self {
        let (masses, tau_s) = (system.masses, system.time_unit_s());
        let mut a = Square::<D>::zeros_generic(size, size);
        // What the barrier does would stand in the columns beyond: it rests.
        system.entries(tau_s, &mut |row, column, value| {
            if column < system.states {
                a[(row, column)] += value;
            }
        });
        let start =
            OVector::<f64, D>::from_iterator_generic(size, U1, state_of(system, tau_s, &|mass| start.of_mass(mass)));
        Self { masses, tau_s, a, start }
    }

    /// `exp(A t)`, `t` in s: scaling, Taylor series, squaring.
    pub fn exponential(&self, t_s: f64) -> Square<D> {
        let (size, _) = self.a.shape_generic();
        let t = t_s / self.tau_s;
        let squarings = squarings_of(self.a.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max) * t.abs());
        let x = &self.a * (t * 0.5_f64.powi(squarings));
        let mut phi = Square::<D>::identity_generic(size, size) + &x;
        let mut term = x.clone();
        for k in 2..=TERMS {
            term = &term * &x * (1.0 / k as f64);
            phi += &term;
        }
        for _ in 0..squarings {
            phi = &phi * &phi;
        }
        phi
    }

    /// The motion alone. Even and odd instants by steps of twice the interval, side by side: one row of products that
    /// each wait for the one before leaves the processor idle.
    fn march(&self, at: &Instants, asked: Asked) -> Vec<Motion> {
        let mut motions = asked.zeros(at.samples, self.masses);
        let (n, per_tau) = (self.masses, self.tau_s.recip());
        let (masses, [asks_x, asks_v, asks_a]) = (asked.masses(n), asked.waves.asked());
        let start = if at.first_s > 0.0 { self.exponential(at.first_s) * &self.start } else { self.start.clone() };
        let phi = self.exponential(at.dt_s);
        let twice = &phi * &phi;
        let mut states = [start.clone(), &phi * start];
        for k in (0..at.samples).step_by(2) {
            for (odd, z) in states.iter_mut().enumerate().take(at.samples - k) {
                let rate = asks_a.then(|| &self.a * &*z);
                for i in masses.clone() {
                    let motion = &mut motions[i];
                    if asks_x {
                        motion.displacement_m[k + odd] = z[i];
                    }
                    if asks_v {
                        motion.velocity_m_per_s[k + odd] = z[n + i] * per_tau;
                    }
                    if let Some(rate) = &rate {
                        motion.acceleration_m_per_s2[k + odd] = rate[n + i] * per_tau * per_tau;
                    }
                }
                *z = &twice * &*z;
            }
        }
        motions
    }
}
