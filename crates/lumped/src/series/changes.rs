//! Derivatives of a motion by parameters: the variational equation along its Taylor series.
//!
//! A small change of the motion by a parameter p feels, on each element, the derivative of the force by compression,
//! rate and inner state, and what p changes in the force at the motion itself. Over a step of the motion all these are
//! known series, so the change gets its own series by the same recurrence, on the same steps. At an event forces are
//! continuous, therefore so are the changes of displacement and velocity: the instant at which an event happens adds
//! nothing. What an element remembers from the event on (the permanent set) is one more number that changes.
//!
//! Several parameters are expanded side by side, [`ABREAST`] or [`FEW`]; each lane does the operations of a single
//! derivative in the same order, hence the same bits for any number. The derivatives are those of the motion as
//! computed, right to rounding; an acceleration has a kink at an event, where one of its two one-sided derivatives is
//! given.

use pulp::{Arch, Simd, WithSimd};

use crate::Element;
use crate::exact::derivatives::{ABREAST, FEW, Lanes};
use crate::series::expression_series::{ExpressionSeries, Partials};
use crate::series::step::{LinkSeries, ORDER, Series, Step};
use crate::structure::connected_masses::{Branch, Form, Law, Place, Strain, Structure};

/// Coefficients by order, then by parameter.
type LaneSeries<const L: usize> = [Lanes<L>; ORDER + 1];

/// Change of the motion of a node.
#[derive(Clone)]
struct NodeChange<const L: usize> {
    x: LaneSeries<L>,
    v: LaneSeries<L>,
    a: LaneSeries<L>,
}

/// Change of what an element feels and remembers, and of its law.
#[derive(Clone)]
struct LinkChange<const L: usize> {
    u: LaneSeries<L>,
    w: LaneSeries<L>,
    z: LaneSeries<L>,
    has_inner: bool,
    set: Lanes<L>,
    law: [Form; L],
    inner: [Form; L],
}

/// The changes by a few parameters: each sum of products is a chain that waits for itself, and the others fill the
/// time.
struct Block<const L: usize> {
    places: [Option<Place>; L],
    nodes: Vec<NodeChange<L>>,
    links: Vec<LinkChange<L>>,
}

/// The changes by all parameters asked for: whole blocks, and a narrow one where few are left.
pub(crate) struct Changes {
    blocks: Vec<Block<ABREAST>>,
    last: Option<Block<FEW>>,
    /// Of each element, over the last step.
    linearised: Vec<Linearised>,
    arch: Option<Arch>,
}

/// `sum += factor * terms`, lane by lane.
#[inline(always)]
fn add<const L: usize>(sum: &mut Lanes<L>, factor: f64, terms: &Lanes<L>) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += factor * term;
    }
}

/// Differences lane by lane.
#[inline(always)]
fn minus<const L: usize>(a: &Lanes<L>, b: &Lanes<L>) -> Lanes<L> {
    std::array::from_fn(|p| a[p] - b[p])
}

/// Coefficient `k` of the product of a series with changes.
///
/// In two sums that need not wait for each other; the newest coefficient comes last, so that the others need not wait
/// for it.
#[inline(always)]
fn lane_product<const L: usize>(series: &Series, change: &LaneSeries<L>, k: usize) -> Lanes<L> {
    let mut sums = [[0.0; L]; 2];
    let (series, change) = (&series[..=k], &change[..=k]);
    let mut i = 0;
    while i < k {
        add(&mut sums[0], series[k - i], &change[i]);
        add(&mut sums[1], series[k - i - 1], &change[i + 1]);
        i += 2;
    }
    if i == k {
        add(&mut sums[0], series[0], &change[k]);
    }
    std::array::from_fn(|p| sums[0][p] + sums[1][p])
}

/// The product of two series, term by term of the first.
#[inline(always)]
fn series_product(a: &Series, b: &Series) -> Series {
    let mut product = [0.0; ORDER + 1];
    for (i, a) in a.iter().enumerate() {
        for (sum, b) in product[i..].iter_mut().zip(b) {
            *sum += a * b;
        }
    }
    product
}

/// A law linearised along the motion: its derivatives there, and what a change of its numbers is multiplied with.
struct Linearised {
    /// Squares and product of compression and rate.
    uu: Series,
    ww: Series,
    uw: Series,
    /// Derivatives of the force by compression and rate.
    by_u: Series,
    by_w: Series,
    /// Whether these two do not change with the motion.
    is_linear: bool,
    /// Derivatives of a force that is no form by its parameters; none of others.
    by_parameter: Vec<Series>,
}

impl Linearised {
    #[inline(always)]
    fn new(law: &Form, link: &LinkSeries, own: Option<&ExpressionSeries>, is_mixed: bool) -> Self {
        let LinkSeries { u, w, .. } = link;
        if let Some(own) = own {
            let Partials { by_deflection: by_u, by_rate: by_w, by_parameter } = own.partials();
            let none = [0.0; ORDER + 1];
            return Self { uu: none, ww: none, uw: none, by_u, by_w, is_linear: false, by_parameter };
        }
        let uw = if is_mixed { series_product(u, w) } else { [0.0; ORDER + 1] };
        let (mut by_u, mut by_w) = ([0.0; ORDER + 1], [0.0; ORDER + 1]);
        for k in 0..=ORDER {
            (by_u[k], by_w[k]) = (2.0 * law.uu * u[k] + law.uw * w[k], 2.0 * law.ww * w[k] + law.uw * u[k]);
        }
        by_u[0] += law.u;
        by_w[0] += law.w;
        let is_linear = law.uu == 0.0 && law.ww == 0.0 && law.uw == 0.0;
        let (uu, ww) = (series_product(u, u), series_product(w, w));
        Self { uu, ww, uw, by_u, by_w, is_linear, by_parameter: Vec::new() }
    }

    /// Coefficient `k` of the change of the force with changes of compression and rate; those of the rate come last,
    /// since the newest one is known last.
    #[inline(always)]
    fn add_to<const L: usize>(&self, mut direct: Lanes<L>, u: &LaneSeries<L>, w: &LaneSeries<L>, k: usize) -> Lanes<L> {
        if self.is_linear {
            add(&mut direct, self.by_u[0], &u[k]);
            add(&mut direct, self.by_w[0], &w[k]);
        } else {
            add(&mut direct, 1.0, &lane_product(&self.by_u, u, k));
            add(&mut direct, 1.0, &lane_product(&self.by_w, w, k));
        }
        direct
    }
}

/// Values of changes at `tau`.
#[inline(always)]
fn at<const L: usize>(change: &LaneSeries<L>, tau: f64) -> Lanes<L> {
    let mut sum = [0.0; L];
    for terms in change.iter().rev() {
        for (sum, term) in sum.iter_mut().zip(terms) {
            *sum = *sum * tau + term;
        }
    }
    sum
}

/// The place of a parameter in an element.
fn place_in(place: Option<Place>, link: usize) -> Option<usize> {
    match place {
        Some(Place::Element { connection, parameter }) if connection == link => Some(parameter),
        Some(Place::Law(parameter)) => Some(parameter),
        _ => None,
    }
}

impl Changes {
    /// At the start nothing has changed yet but the start itself.
    pub fn at_start(structure: &Structure, places: &[Place]) -> Self {
        let few = if (1..=FEW).contains(&(places.len() % ABREAST)) { places.len() % ABREAST } else { 0 };
        let (whole, few) = places.split_at(places.len() - few);
        Self {
            blocks: whole.chunks(ABREAST).map(|places| Block::at_start(structure, places)).collect(),
            last: (!few.is_empty()).then(|| Block::at_start(structure, few)),
            linearised: Vec::new(),
            arch: (!places.is_empty()).then(Arch::new),
        }
    }

    /// The series of the changes over a step of the motion.
    pub fn expand(&mut self, structure: &Structure, step: &Step) {
        let Some(arch) = self.arch else { return };
        self.blocks.iter_mut().for_each(|block| block.change_laws(structure, step));
        self.last.iter_mut().for_each(|block| block.change_laws(structure, step));
        let law = step.law_of_one_mass();
        let is_mixed = self.blocks.iter().any(Block::is_mixed) || self.last.iter().any(Block::is_mixed);
        // All elements of one mass feel the same.
        let links = if law.is_some() { &step.links[..1] } else { &step.links[..] };
        self.linearised.clear();
        arch.dispatch(|| {
            let linearised = |(link, own): (&LinkSeries, &Option<ExpressionSeries>)| {
                Linearised::new(law.as_ref().unwrap_or(&link.law), link, own.as_ref(), is_mixed)
            };
            self.linearised.extend(links.iter().zip(&step.own).map(linearised));
        });
        for block in &mut self.blocks {
            arch.dispatch(Expand { block, step, law, linearised: &self.linearised });
        }
        if let Some(block) = &mut self.last {
            arch.dispatch(Expand { block, step, law, linearised: &self.linearised });
        }
    }

    /// Takes the values at the end of a step as those of the next start.
    pub fn advance(&mut self, length_s: f64) {
        let Some(arch) = self.arch else { return };
        arch.dispatch(|| {
            self.blocks.iter_mut().for_each(|block| block.advance(length_s));
            self.last.iter_mut().for_each(|block| block.advance(length_s));
        });
    }

    /// An element goes to its next branch, between two steps.
    pub fn enter(&mut self, law: &dyn Law, link: usize, before: &Branch, strain: Strain, nodes: [usize; 2]) {
        self.blocks.iter_mut().for_each(|block| block.enter(law, link, before, strain, nodes));
        self.last.iter_mut().for_each(|block| block.enter(law, link, before, strain, nodes));
    }

    /// Series of the change of a mass by a parameter: of its displacement (`wave` 0), velocity (1) or acceleration (2).
    pub fn series(&self, mass: usize, parameter: usize, wave: usize) -> Series {
        let lane = parameter % ABREAST;
        match (self.blocks.get(parameter / ABREAST), &self.last) {
            (Some(block), _) => block.series(mass, lane, wave),
            (None, Some(block)) => block.series(mass, lane, wave),
            (None, None) => [0.0; ORDER + 1],
        }
    }
}

impl<const L: usize> Block<L> {
    fn at_start(structure: &Structure, places: &[Place]) -> Self {
        let none = [[0.0; L]; ORDER + 1];
        let link = |(element, _): (&Element, [usize; 2])| LinkChange {
            u: none,
            w: none,
            z: none,
            has_inner: element.law().inner_rate().is_some(),
            set: [0.0; L],
            law: [Form::ZERO; L],
            inner: [Form::ZERO; L],
        };
        let masses = structure.masses_kg().len();
        let mut nodes = vec![NodeChange { x: none, v: none, a: none }; masses + 1];
        for (p, place) in places.iter().enumerate() {
            for (mass, node) in nodes[..masses].iter_mut().enumerate() {
                [node.x[0][p], node.v[0][p]] = place.of_start(mass);
            }
        }
        let links = structure.joined().map(link).collect();
        Self { places: std::array::from_fn(|p| places.get(p).copied()), nodes, links }
    }

    /// Whether a parameter changes what is multiplied with the product of compression and rate.
    fn is_mixed(&self) -> bool {
        self.links.iter().flat_map(|link| &link.law).any(|law| law.uw != 0.0)
    }

    #[inline(always)]
    fn advance(&mut self, length_s: f64) {
        // The barrier does not change, nor what is not there.
        let masses = self.nodes.len() - 1;
        for node in &mut self.nodes[..masses] {
            (node.x[0], node.v[0]) = (at(&node.x, length_s), at(&node.v, length_s));
        }
        for link in self.links.iter_mut().filter(|link| link.has_inner) {
            link.z[0] = at(&link.z, length_s);
        }
    }

    fn enter(&mut self, law: &dyn Law, link: usize, before: &Branch, strain: Strain, [front, rear]: [usize; 2]) {
        let by_u = minus(&self.nodes[rear].x[0], &self.nodes[front].x[0]);
        for ((set, by_u), place) in self.links[link].set.iter_mut().zip(by_u).zip(self.places) {
            *set = law.set_by(before, strain, by_u, place_in(place, link), *set);
        }
    }

    fn series(&self, mass: usize, lane: usize, wave: usize) -> Series {
        let node = &self.nodes[mass];
        let series = [&node.x, &node.v, &node.a][wave];
        std::array::from_fn(|k| series[k][lane])
    }

    /// What each parameter changes in the law of each element on its branch.
    fn change_laws(&mut self, structure: &Structure, step: &Step) {
        let elements = structure.connections().iter().zip(&step.branches);
        for (link, (change, (connection, branch))) in self.links.iter_mut().zip(elements).enumerate() {
            let law = connection.element.law();
            let by_set = law.force_by_set(branch);
            for p in 0..L {
                let own = place_in(self.places[p], link);
                let direct = own.map_or(Form::ZERO, |parameter| law.force_by(branch, parameter));
                change.law[p] = direct.plus(change.set[p], &by_set);
                change.inner[p] = own.map_or(Form::ZERO, |parameter| law.inner_rate_by(parameter));
            }
        }
    }

    /// The changes where the acceleration is a form of displacement and velocity: all elements in one.
    #[inline(always)]
    fn expand_one_mass(&mut self, step: &Step, law: &Form, linearised: &Linearised) {
        let (node, per_mass) = (&step.nodes[0], step.per_mass[0]);
        let mut by = [Form::ZERO; L];
        for (p, by) in by.iter_mut().enumerate() {
            let own = if self.places[p] == Some(Place::Mass(0)) { -per_mass } else { 0.0 };
            let of_links = self.links.iter().fold(Form::ZERO, |sum, link| sum.plus(-per_mass, &link.law[p]));
            *by = of_links.plus(own, law);
        }
        // One list a coefficient, side by side.
        let terms = [|f: &Form| f.u, |f: &Form| f.w, |f: &Form| f.uu, |f: &Form| f.ww, |f: &Form| f.uw];
        let by_terms = terms.map(|term| by.map(|form| term(&form)));
        let NodeChange { x, v, a } = &mut self.nodes[0];
        for k in 0..=ORDER {
            let mut now = if k == 0 { by.map(|form| form.constant) } else { [0.0; L] };
            let values = [node.x[k], node.v[k], linearised.uu[k], linearised.ww[k], linearised.uw[k]];
            for (by, value) in by_terms.iter().zip(values) {
                add(&mut now, value, by);
            }
            now = linearised.add_to(now, x, v, k);
            a[k] = now;
            if k < ORDER {
                let factor = 1.0 / (k + 1) as f64;
                (x[k + 1], v[k + 1]) = (v[k].map(|v| v * factor), now.map(|a| a * factor));
            }
        }
    }
}

/// The changes of a block over one step.
struct Expand<'a, const L: usize> {
    block: &'a mut Block<L>,
    step: &'a Step,
    /// The acceleration of the only mass, where it is a form.
    law: Option<Form>,
    /// Of each element.
    linearised: &'a [Linearised],
}

impl<const L: usize> WithSimd for Expand<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { block, step, law, linearised } = self;
        if let (Some(law), Some(linearised)) = (law, linearised.first()) {
            block.expand_one_mass(step, &law, linearised);
            return;
        }
        let of_mass = |place: &Option<Place>| match place {
            Some(Place::Mass(mass)) => *mass,
            _ => usize::MAX,
        };
        let masses: [usize; L] = std::array::from_fn(|p| of_mass(&block.places[p]));
        let places = block.places;
        for k in 0..=ORDER {
            for node in &mut block.nodes {
                node.a[k] = [0.0; L];
            }
            let links = step.links.iter().zip(&mut block.links).zip(linearised);
            for (at, ((link, change), linearised)) in links.enumerate() {
                let [front, rear] = link.nodes;
                change.u[k] = minus(&block.nodes[rear].x[k], &block.nodes[front].x[k]);
                change.w[k] = minus(&block.nodes[rear].v[k], &block.nodes[front].v[k]);
                let mut force = force_change(link, change, linearised, k);
                if !linearised.by_parameter.is_empty() {
                    for (force, place) in force.iter_mut().zip(places) {
                        let own = place_in(place, at).and_then(|parameter| linearised.by_parameter.get(parameter));
                        *force += own.map_or(0.0, |by| by[k]);
                    }
                }
                add(&mut block.nodes[rear].a[k], -1.0, &force);
                add(&mut block.nodes[front].a[k], 1.0, &force);
            }
            // The barrier moves as it is driven, whatever the parameters.
            for (mass, per_mass) in step.per_mass.iter().enumerate() {
                let NodeChange { x, v, a } = &mut block.nodes[mass];
                for (a, by) in a[k].iter_mut().zip(&masses) {
                    *a = (*a - if *by == mass { step.nodes[mass].a[k] } else { 0.0 }) * per_mass;
                }
                if k < ORDER {
                    let factor = 1.0 / (k + 1) as f64;
                    (x[k + 1], v[k + 1]) = (v[k].map(|v| v * factor), a[k].map(|a| a * factor));
                }
            }
        }
    }
}

/// Coefficient `k` of the change of a force; that of the rate of the inner state goes into its series.
#[inline(always)]
fn force_change<const L: usize>(
    link: &LinkSeries,
    change: &mut LinkChange<L>,
    linearised: &Linearised,
    k: usize,
) -> Lanes<L> {
    let (one, u, w, z) = (if k == 0 { 1.0 } else { 0.0 }, link.u[k], link.w[k], link.z[k]);
    let (uu, ww, uw) = (linearised.uu[k], linearised.ww[k], linearised.uw[k]);
    let mut force = [0.0; L];
    for (force, by) in force.iter_mut().zip(&change.law) {
        *force = by.constant * one + by.u * u + by.w * w + by.z * z + by.uu * uu + by.ww * ww + by.uw * uw;
    }
    force = linearised.add_to(force, &change.u, &change.w, k);
    if let Some(inner) = &link.inner {
        add(&mut force, link.law.z, &change.z[k]);
        if k < ORDER {
            let factor = 1.0 / (k + 1) as f64;
            for p in 0..L {
                let by = &change.inner[p];
                let rate = inner.u * change.u[k][p] + inner.w * change.w[k][p] + inner.z * change.z[k][p];
                change.z[k + 1][p] = (rate + by.u * u + by.w * w + by.z * z) * factor;
            }
        }
    }
    force
}
