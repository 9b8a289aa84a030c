//! One step of a motion: Taylor series of all nodes and elements on one branch of each element.
//!
//! With every force a [`Form`] of degree two in compression, rate and inner state, the Taylor coefficients of the
//! motion follow from `x_(k+1) = v_k/(k+1)`, `v_(k+1) = a_k/(k+1)`, where products of series are convolutions of the
//! coefficients known so far (the recurrence of Parker and Sochacki). A step is as long as its two last terms stay
//! below [`REST`] of the motion.

use crate::exact::crossing::falling_zero;
use crate::motion::collision::Extremum;
use crate::motion::mass_motion::Course;
use crate::series::expression_series::ExpressionSeries;
use crate::structure::connected_masses::{Branch, Form, Strain, Structure};
use crate::{Start, State};

/// Terms of the Taylor series.
pub(crate) const ORDER: usize = 20;
/// Rest of the series after a step, relative to the motion.
const REST: f64 = 1e-17;
/// Below this many metres nothing moves.
pub(crate) const NOTHING_M: f64 = 1e-12;

/// Taylor coefficients about the start of a step, lowest order first, SI units per `s^k`.
pub(crate) type Series = [f64; ORDER + 1];

/// Motion of a node.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NodeSeries {
    pub x: Series,
    pub v: Series,
    pub a: Series,
}

/// What an element feels, and its force, on the branch it is on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkSeries {
    /// Indices of its front and rear node.
    pub nodes: [usize; 2],
    pub law: Form,
    /// Rate of its inner state, if it has one.
    pub inner: Option<Form>,
    pub u: Series,
    pub w: Series,
    pub z: Series,
    pub force: Series,
}

/// What drives a step: the series of a force on a mass or of the acceleration of the barrier.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Input {
    /// The mass that is pushed; otherwise the barrier is.
    pub mass: Option<usize>,
    pub terms: Series,
}

/// A change of branch at the start of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    pub link: usize,
    pub before: Branch,
    pub after: Branch,
}

/// One step: series about its start, valid for `length_s`.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub start_s: f64,
    pub length_s: f64,
    /// Masses, then the barrier.
    pub nodes: Vec<NodeSeries>,
    pub links: Vec<LinkSeries>,
    pub branches: Vec<Branch>,
    /// The forces that are no forms.
    pub own: Vec<Option<ExpressionSeries>>,
    /// How the elements came to their branches at the start.
    pub entered: Vec<Entry>,
    pub input: Input,
    pub per_mass: Vec<f64>,
}

/// Value and derivative of a polynomial.
#[inline]
pub(crate) fn horner(series: &Series, tau: f64) -> (f64, f64) {
    let (mut value, mut rate) = (0.0, 0.0);
    for term in series.iter().rev() {
        rate = rate * tau + value;
        value = value * tau + term;
    }
    (value, rate)
}

/// Value of a polynomial.
#[inline]
pub(crate) fn value(series: &Series, tau: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, term| sum * tau + term)
}

/// Values of a polynomial at several instants.
#[inline(always)]
pub(crate) fn values<const L: usize>(series: &Series, tau: &[f64; L]) -> [f64; L] {
    let mut sums = [0.0; L];
    for term in series.iter().rev() {
        for lane in 0..L {
            sums[lane] = sums[lane] * tau[lane] + term;
        }
    }
    sums
}

/// `integral from 0 to tau`.
pub(crate) fn integral(series: &Series, tau: f64) -> f64 {
    (0..=ORDER).rev().fold(0.0, |sum, k| sum * tau + series[k] / (k + 1) as f64) * tau
}

/// Coefficient `k` of the product of two series.
#[inline]
pub(crate) fn product(a: &Series, b: &Series, k: usize) -> f64 {
    a[..=k].iter().zip(b[..=k].iter().rev()).map(|(a, b)| a * b).sum()
}

/// Largest modulus.
pub(crate) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, q| m.max(q.abs()))
}

impl Input {
    /// The series about `t_s` of an input.
    pub fn of_course(mass: Option<usize>, course: &Course, t_s: f64) -> Self {
        let mut terms = [0.0; ORDER + 1];
        match *course {
            Course::Line { from_s, value, slope } => (terms[0], terms[1]) = (value + slope * (t_s - from_s), slope),
            Course::Sine { peak, frequency } => terms = sine(peak, frequency, frequency * t_s),
            Course::Haversine { peak, frequency } => {
                // (1 - cos φ)/2 = (1 + sin(φ - π/2))/2.
                terms = sine(peak / 2.0, frequency, frequency * t_s - std::f64::consts::FRAC_PI_2);
                terms[0] += peak / 2.0;
            }
        }
        Self { mass, terms }
    }
}

/// The series of `peak sin(phase + frequency t)` about `t = 0`.
fn sine(peak: f64, frequency: f64, phase: f64) -> Series {
    let (sine, cosine) = phase.sin_cos();
    let (mut terms, mut factor) = ([0.0; ORDER + 1], peak);
    for (k, term) in terms.iter_mut().enumerate() {
        *term = factor * [sine, cosine, -sine, -cosine][k % 4];
        factor *= frequency / (k + 1) as f64;
    }
    terms
}

impl NodeSeries {
    /// The Taylor coefficients where the acceleration is a form of displacement and velocity: the sums for both squares
    /// side by side, without the elements.
    ///
    /// The newest coefficients come in by the slopes of the law at the start alone, so that each waits for little of
    /// the one before.
    fn fall(&mut self, law: &Form) {
        let Self { x, v, a } = self;
        let now = Strain { u: x[0], w: v[0], z: 0.0 };
        let [by_x, by_v] = law.slopes(now);
        let has_squares = law.uu != 0.0 || law.ww != 0.0;
        a[0] = law.at(now);
        for k in 1..=ORDER {
            let factor = 1.0 / k as f64;
            (x[k], v[k]) = (v[k - 1] * factor, a[k - 1] * factor);
            let mut inner = 0.0;
            if has_squares {
                let half = k.div_ceil(2);
                let (mut xx, mut vv) = (0.0, 0.0);
                let of_x = x[1..half].iter().rev().zip(&x[k + 1 - half..k]);
                let of_v = v[1..half].iter().rev().zip(&v[k + 1 - half..k]);
                for ((x, other_x), (v, other_v)) in of_x.zip(of_v) {
                    xx += x * other_x;
                    vv += v * other_v;
                }
                (xx, vv) = (2.0 * xx, 2.0 * vv);
                if k.is_multiple_of(2) {
                    xx += x[k / 2] * x[k / 2];
                    vv += v[k / 2] * v[k / 2];
                }
                inner = law.uu * xx + law.ww * vv;
            }
            if law.uw != 0.0 {
                inner += law.uw * x[1..k].iter().zip(v[1..k].iter().rev()).map(|(x, v)| x * v).sum::<f64>();
            }
            a[k] = inner + by_x * x[k] + by_v * v[k];
        }
    }
}

impl LinkSeries {
    /// The strain at `tau` after the step's start.
    pub fn strain(&self, tau: f64) -> Strain {
        let z = if self.inner.is_some() { value(&self.z, tau) } else { 0.0 };
        Strain { u: value(&self.u, tau), w: value(&self.w, tau), z }
    }

    /// The series of a form of its strain.
    pub fn series(&self, form: &Form) -> Series {
        let mut series = std::array::from_fn(|k| form.u * self.u[k] + form.w * self.w[k] + form.z * self.z[k]);
        series[0] += form.constant;
        for (factor, a, b) in [(form.uu, &self.u, &self.u), (form.ww, &self.w, &self.w), (form.uw, &self.u, &self.w)] {
            if factor != 0.0 {
                for (k, sum) in series.iter_mut().enumerate() {
                    *sum += factor * product(a, b, k);
                }
            }
        }
        series
    }
}

impl Step {
    /// The structure at the start. Nothing is expanded yet.
    pub fn at_start(structure: &Structure, start: &Start) -> Self {
        let masses = structure.masses_kg().len();
        let mut nodes = vec![NodeSeries::default(); masses + 1];
        for (mass, node) in nodes[..masses].iter_mut().enumerate() {
            [node.x[0], node.v[0]] = start.of_mass(mass);
        }
        let zero = [0.0; ORDER + 1];
        let (mut links, mut branches, mut own) = (Vec::new(), Vec::new(), Vec::new());
        for (element, ends) in structure.joined() {
            let law = element.law();
            let branch = law.start(strain_between(&nodes, ends));
            let (force, inner) = (law.force(&branch), law.inner_rate());
            links.push(LinkSeries { nodes: ends, law: force, inner, u: zero, w: zero, z: zero, force: zero });
            own.push(ExpressionSeries::of_element(law, &branch));
            branches.push(branch);
        }
        let per_mass = structure.masses_kg().iter().map(|mass| mass.recip()).collect();
        let entered = Vec::new();
        let input = Input::default();
        Self { start_s: 0.0, length_s: 0.0, nodes, links, branches, own, entered, input, per_mass }
    }

    /// The Taylor coefficients from the values at the start, which stand in place 0.
    ///
    /// Some `ORDER²` products for every square that a force has.
    pub fn expand(&mut self) {
        let Some(law) = self.law_of_one_mass() else {
            recurrence(&mut self.nodes, &mut self.links, &mut self.own, &self.per_mass, &self.input);
            return;
        };
        self.nodes[0].fall(&law);
        for link in &mut self.links {
            (link.u, link.w) = (self.nodes[0].x, self.nodes[0].v);
        }
    }

    /// The step after which the last terms of the series are [`REST`] of the motion; two terms, because the
    /// coefficients of an even or odd function vanish in turn.
    pub fn longest(&self) -> f64 {
        let x = || self.nodes.iter().map(|node| &node.x).chain(self.links.iter().map(|link| &link.z));
        let size =
            largest(x().map(|x| x[0])).max(1e-3 * largest(self.nodes.iter().map(|node| node.v[0]))).max(NOTHING_M);
        let bound = |k: usize| (size * REST / largest(x().map(|x| x[k])).max(f64::MIN_POSITIVE)).powf(1.0 / k as f64);
        bound(ORDER).min(bound(ORDER - 1)).max(1e-12)
    }

    /// Whether the coefficients are numbers: each is made of all before it, so that the last ones tell.
    pub fn is_finite(&self) -> bool {
        self.nodes.iter().all(|node| node.v[ORDER].is_finite() && node.a[ORDER].is_finite() && node.x[0].is_finite())
    }

    /// A mass at `tau` after the start.
    pub fn state(&self, mass: usize, tau: f64) -> State {
        let node = &self.nodes[mass];
        State {
            displacement_m: value(&node.x, tau),
            velocity_m_per_s: value(&node.v, tau),
            acceleration_m_per_s2: value(&node.a, tau),
        }
    }

    /// Takes the values at the end of the step as those of the next start.
    pub fn advance(&mut self) {
        let tau = self.length_s;
        // A barrier that rests stays where it is.
        let resting = usize::from(self.barrier_rests());
        let moving = self.nodes.len() - resting;
        for node in &mut self.nodes[..moving] {
            let terms = node.x.iter().zip(&node.v).rev();
            (node.x[0], node.v[0]) = terms.fold((0.0, 0.0), |(x, v), (of_x, of_v)| (x * tau + of_x, v * tau + of_v));
        }
        for link in self.links.iter_mut().filter(|link| link.inner.is_some()) {
            link.z[0] = value(&link.z, tau);
        }
        self.start_s += tau;
    }

    /// Whether nothing moves the barrier.
    fn barrier_rests(&self) -> bool {
        let Input { mass, terms } = &self.input;
        self.nodes[self.nodes.len() - 1].v[0] == 0.0 && (mass.is_some() || terms.iter().all(|term| *term == 0.0))
    }

    /// The acceleration of the only mass as a form of its own displacement and velocity, if it has no other.
    pub fn law_of_one_mass(&self) -> Option<Form> {
        let [_, barrier] = &self.nodes[..] else { return None };
        let is_free = self.input.mass.is_none() && self.barrier_rests() && barrier.x[0] == 0.0;
        let mut sum = Form::ZERO;
        if self.own.iter().any(Option::is_some) {
            return None;
        }
        for link in &self.links {
            if !is_free || link.nodes != [1, 0] || link.inner.is_some() {
                return None;
            }
            sum = sum.plus(-self.per_mass[0], &link.law);
        }
        Some(sum)
    }

    /// The series of the force of an element.
    pub fn force(&self, link: usize) -> Series {
        match self.own[link] {
            Some(_) => self.links[link].force,
            None => self.links[link].series(&self.links[link].law),
        }
    }

    /// The force of an element at `tau` after the start, N.
    pub fn force_at(&self, link: usize, tau: f64) -> f64 {
        match self.own[link] {
            Some(_) => value(&self.links[link].force, tau),
            None => self.links[link].law.at(self.links[link].strain(tau)),
        }
    }

    /// Whether an element has a force on its branch.
    pub fn presses(&self, link: usize) -> bool {
        self.own[link].is_some() || self.links[link].law != Form::ZERO
    }

    /// What an element feels at the start.
    pub fn strain_now(&self, link: usize) -> Strain {
        let LinkSeries { nodes, z, .. } = &self.links[link];
        Strain { z: z[0], ..strain_between(&self.nodes, *nodes) }
    }
}

/// Compression between two nodes and its rate at the start of a step.
fn strain_between(nodes: &[NodeSeries], [front, rear]: [usize; 2]) -> Strain {
    let (front, rear) = (&nodes[front], &nodes[rear]);
    Strain { u: rear.x[0] - front.x[0], w: rear.v[0] - front.v[0], z: 0.0 }
}

/// See [`Step::expand`].
fn recurrence(
    nodes: &mut [NodeSeries],
    links: &mut [LinkSeries],
    own: &mut [Option<ExpressionSeries>],
    per_mass: &[f64],
    input: &Input,
) {
    let barrier = nodes.len() - 1;
    for k in 0..=ORDER {
        for node in &mut *nodes {
            node.a[k] = 0.0;
        }
        if let Some(mass) = input.mass {
            nodes[mass].a[k] = input.terms[k];
        }
        for (link, own) in links.iter_mut().zip(&mut *own) {
            let [front, rear] = link.nodes;
            let law = &link.law;
            let (u, w) = (nodes[rear].x[k] - nodes[front].x[k], nodes[rear].v[k] - nodes[front].v[k]);
            (link.u[k], link.w[k]) = (u, w);
            let mut force = law.u * u + law.w * w + if k == 0 { law.constant } else { 0.0 };
            for (factor, a, b) in [(law.uu, &link.u, &link.u), (law.ww, &link.w, &link.w), (law.uw, &link.u, &link.w)] {
                if factor != 0.0 {
                    force += factor * product(a, b, k);
                }
            }
            if let Some(inner) = link.inner {
                let z = link.z[k];
                force += law.z * z;
                if k < ORDER {
                    link.z[k + 1] = (inner.u * u + inner.w * w + inner.z * z) / (k + 1) as f64;
                }
            }
            if let Some(own) = own {
                force += own.term(k, &link.u, &link.w);
            }
            link.force[k] = force;
            nodes[rear].a[k] -= force;
            nodes[front].a[k] += force;
        }
        for (node, per_mass) in nodes.iter_mut().zip(per_mass) {
            node.a[k] *= per_mass;
        }
        nodes[barrier].a[k] = if input.mass.is_none() { input.terms[k] } else { 0.0 };
        if k < ORDER {
            let factor = 1.0 / (k + 1) as f64;
            for node in &mut *nodes {
                node.x[k + 1] = node.v[k] * factor;
                node.v[k + 1] = node.a[k] * factor;
            }
        }
    }
}

/// Parts of a step on which a change of sign is looked for.
pub(crate) const PARTS: usize = 8;
/// A later value is larger if it is so by more than rounding: on a plateau the first counts.
const LARGER: f64 = 1.0 + 1e-14;

/// The ends of the parts of a step.
fn parts(length_s: f64) -> [f64; PARTS] {
    std::array::from_fn(|part| length_s * (part + 1) as f64 / PARTS as f64)
}

/// Visits the instants at which a series turns between `from` and the end of part `count`: an instant before, the
/// instant, and whether it is a lowest one. A part holds one at the most.
pub(crate) fn turns(
    series: &Series,
    from: f64,
    parts: &[f64; PARTS],
    count: usize,
    mut visit: impl FnMut(f64, f64, bool),
) {
    let rate: Series = std::array::from_fn(|k| if k < ORDER { (k + 1) as f64 * series[k + 1] } else { 0.0 });
    let (mut low, mut before) = (from, value(&rate, from));
    for (high, after) in parts[..count].iter().zip(values(&rate, parts)).filter(|(high, _)| **high > from) {
        if before * after < 0.0 {
            let sign = before.signum();
            let falling = |tau: f64| {
                let (rate, change) = horner(&rate, tau);
                (sign * rate, sign * change)
            };
            visit(low, falling_zero(low, *high, falling), sign < 0.0);
        }
        (low, before) = (*high, after);
    }
}

/// First instant within a step at which a quantity that was positive before is so no more. `is_positive`: whether it
/// was before the step, for at its start may stand the rounding of a zero; says so of its end.
pub(crate) fn falls(series: &Series, length_s: f64, is_positive: &mut bool) -> Option<f64> {
    let parts = parts(length_s);
    // The ends of the parts, and what is lowest within one: before its end.
    let mut looks = [f64::NAN; 2 * PARTS];
    for (look, end) in looks.iter_mut().skip(1).step_by(2).zip(parts) {
        *look = end;
    }
    turns(series, 0.0, &parts, PARTS, |_, bottom, is_lowest| {
        let part = parts.partition_point(|end| *end < bottom);
        if is_lowest && part < PARTS {
            looks[2 * part] = bottom;
        }
    });
    let mut low = 0.0;
    for high in looks.into_iter().filter(|look| !look.is_nan()) {
        let at = value(series, high);
        if *is_positive && at <= 0.0 {
            return Some(falling_zero(low, high, |tau| horner(series, tau)));
        }
        *is_positive = at > 0.0;
        low = high;
    }
    None
}

/// Takes the largest value of `size` of a quantity on a step that starts at `start_s`: at its ends, or inside where it
/// turns.
pub(crate) fn largest_coefficient(
    series: &Series,
    size: fn(f64) -> f64,
    start_s: f64,
    length_s: f64,
    peak: &mut Extremum,
) {
    let mut see = |tau: f64| {
        let size = size(value(series, tau));
        if size > peak.value * LARGER {
            *peak = Extremum { time_s: start_s + tau, value: size };
        }
    };
    see(0.0);
    turns(series, 0.0, &parts(length_s), PARTS, |_, tau, _| see(tau));
    see(length_s);
}
