//! Masses in a row, each on a spring and a damper: double, triple and the user's chains.

use crumple_numerics::lti::{Complex, polynomial_roots};

use crate::error::{finite, row_of_masses};
use crate::families::values::check_values;
use crate::structure::connected_masses::{Place, Structure};
use crate::structure::elements::piecewise_linear::PiecewiseLinear;
use crate::structure::elements::secant::{Damper, Spring};
use crate::{CrushEvents, Drive, Dynamics, Instants, LumpedError, ModelKind, Motion, Response, Sensitivity};

/// Any number of masses in a row: barrier - (k1, c1) - m1 - (k2, c2) - m2 - ... - mN, the compartment last.
///
/// Spring and damper `i` stand in parallel in front of mass `i`; their force is `k_i(|u|) u + c_i(|w|) w`, `u` the
/// compression and `w` the rate of it, positive in compression, with coefficients that are constant or piecewise
/// linear. The secant reading is that of the single-mass paper, carried to elements between masses; contact stays
/// closed, and an element is as stiff in tension as in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    masses_kg: Vec<f64>,
    springs: Vec<PiecewiseLinear>,
    dampers: Vec<PiecewiseLinear>,
}

/// A row of masses on springs and dampers with constant coefficients.
pub(crate) fn constants(masses_kg: &[f64], springs: &[f64], dampers: &[f64]) -> Result<Structure, LumpedError> {
    Chain::with_constants(masses_kg, springs, dampers)?.structure()
}

/// Where the parameters of so many masses with constant coefficients stand: masses, springs, dampers.
pub(crate) fn places_of_constants(masses: usize) -> Vec<Place> {
    let element = |connection| Place::Element { connection, parameter: 0 };
    let of_springs = (0..masses).map(|i| element(2 * i));
    (0..masses).map(Place::Mass).chain(of_springs).chain((0..masses).map(|i| element(2 * i + 1))).collect()
}

impl Chain {
    /// Masses in kg, springs in N/m over m and dampers in N·s/m over m/s in front of them, from the barrier on. Errors:
    /// lists of unequal length or none, masses that are not positive.
    pub fn new(
        masses_kg: &[f64],
        springs: &[PiecewiseLinear],
        dampers: &[PiecewiseLinear],
    ) -> Result<Self, LumpedError> {
        row_of_masses(masses_kg, springs.len(), dampers.len())?;
        Ok(Self { masses_kg: masses_kg.to_vec(), springs: springs.to_vec(), dampers: dampers.to_vec() })
    }

    /// The same with constant coefficients, N/m and N·s/m. Errors: also values that are not finite.
    pub fn with_constants(masses_kg: &[f64], springs: &[f64], dampers: &[f64]) -> Result<Self, LumpedError> {
        springs.iter().try_for_each(|k| finite("stiffness_n_per_m", *k))?;
        dampers.iter().try_for_each(|c| finite("damping_n_s_per_m", *c))?;
        let laws =
            |values: &[f64]| -> Vec<_> { values.iter().map(|value| PiecewiseLinear::constant(*value)).collect() };
        Self::new(masses_kg, &laws(springs), &laws(dampers))
    }

    /// Masses, kg, from the barrier on.
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Springs in front of the masses, N/m over the compression in m.
    pub fn springs(&self) -> &[PiecewiseLinear] {
        &self.springs
    }

    /// Dampers in front of the masses, N·s/m over the rate of the compression in m/s.
    pub fn dampers(&self) -> &[PiecewiseLinear] {
        &self.dampers
    }

    /// Whether no spring or damper is negative anywhere.
    pub fn is_passive(&self) -> bool {
        self.springs.iter().chain(&self.dampers).all(PiecewiseLinear::is_passive)
    }

    /// The structure it is: spring and damper of each mass in turn.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        let laws = self.springs.iter().zip(&self.dampers);
        Structure::row(&self.masses_kg, laws.map(|(k, c)| vec![Spring(k.clone()).into(), Damper(c.clone()).into()]))
    }

    /// Where its parameters stand in [`sensitivity`](Self::sensitivity): masses, values of the springs at their knots,
    /// values of the dampers, each from the barrier on; then the places of the knots of the springs, and of the
    /// dampers, but of those at zero, which stay. So a chain of constant coefficients counts masses, springs, dampers.
    pub fn places(&self) -> Vec<Place> {
        let knots = |laws: &[PiecewiseLinear], side: usize, which: usize| -> Vec<Place> {
            let place = |(i, j)| Place::Element { connection: 2 * i + side, parameter: 2 * j + which };
            laws.iter().enumerate().flat_map(|(i, law)| (which..law.len()).map(move |j| (i, j))).map(place).collect()
        };
        let lists = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let of_laws = lists.map(|(side, which)| knots([&self.springs, &self.dampers][side], side, which));
        (0..self.masses_kg.len()).map(Place::Mass).chain(of_laws.into_iter().flatten()).collect()
    }

    /// Masses, kg, then the values of the springs at their knots, N/m, and of the dampers, N·s/m: the first of
    /// [`places`](Self::places).
    pub fn values(&self) -> Vec<f64> {
        let laws = self.springs.iter().chain(&self.dampers);
        self.masses_kg.iter().copied().chain(laws.flat_map(PiecewiseLinear::points).map(|(_, value)| value)).collect()
    }

    /// The same chain with other [`values`](Self::values); knots stay where they are. Errors: masses that are not
    /// positive, values that are not finite or too few.
    pub fn with_values(&self, values: &[f64]) -> Result<Self, LumpedError> {
        let mut values = values.iter().copied();
        let mut next = || values.next().unwrap_or(f64::NAN);
        let masses: Vec<f64> = self.masses_kg.iter().map(|_| next()).collect();
        let mut law = |law: &PiecewiseLinear| {
            PiecewiseLinear::new(&law.points().map(|(knot, _)| (knot, next())).collect::<Vec<_>>())
        };
        let springs = self.springs.iter().map(&mut law).collect::<Result<Vec<_>, _>>()?;
        let dampers = self.dampers.iter().map(&mut law).collect::<Result<Vec<_>, _>>()?;
        Self::new(&masses, &springs, &dampers)
    }

    /// Motions, forces and energies at `k dt`, k = 0 .. `samples`. Errors: as [`Structure::dynamics`].
    pub fn dynamics(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        self.structure()?.dynamics(drive, dt_s, samples)
    }

    /// The motions of [`dynamics`](Self::dynamics).
    pub fn respond(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Response, LumpedError> {
        Ok(self.dynamics(drive, dt_s, samples)?.response)
    }

    /// Dynamic crush and rebound of every mass. Errors: as [`Structure::events`].
    pub fn events(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        self.structure()?.events(impact_speed_m_per_s, horizon_s)
    }

    /// The motion of every mass at these instants after an impact. Errors: as [`Structure::sensitivity`].
    pub fn motions_at(&self, impact_speed_m_per_s: f64, at: &Instants) -> Result<Vec<Motion>, LumpedError> {
        self.structure()?.motions_at(impact_speed_m_per_s, at)
    }

    /// Motions and their derivatives by the parameters that stand at these indices of [`places`](Self::places).
    /// Errors: an index that is none, and as [`Structure::sensitivity`].
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let places = self.places();
        let place = |index: &usize| {
            let expected = "the place of a mass, spring or damper of the chain";
            let error = LumpedError::Value { name: "parameter", value: *index as f64, expected };
            places.get(*index).copied().ok_or(error)
        };
        let places: Vec<Place> = parameters.iter().map(place).collect::<Result<_, _>>()?;
        self.structure()?.sensitivity(impact_speed_m_per_s, at, &places)
    }

    /// Characteristic polynomial, monic, highest power first; of coefficients with knots the values at contact count.
    ///
    /// Built from the compartment forwards as a dynamic stiffness `N/D`: an element in series makes `q N/(N + q D)` of
    /// it, a mass adds `m s²`. Sums of positive terms only, so every coefficient is right to a few roundings.
    pub fn characteristic_polynomial(&self) -> Vec<f64> {
        // Lowest power first.
        let times = |p: &[f64], q: &[f64]| {
            let mut product = vec![0.0; p.len() + q.len() - 1];
            for (i, a) in p.iter().enumerate() {
                for (j, b) in q.iter().enumerate() {
                    product[i + j] += a * b;
                }
            }
            product
        };
        let plus = |p: &[f64], q: &[f64]| -> Vec<f64> {
            let at = |v: &[f64], i: usize| v.get(i).copied().unwrap_or(0.0);
            (0..p.len().max(q.len())).map(|i| at(p, i) + at(q, i)).collect()
        };
        let (mut top, mut bottom) = (vec![0.0], vec![1.0]);
        for i in (0..self.masses_kg.len()).rev() {
            top = plus(&top, &times(&[0.0, 0.0, self.masses_kg[i]], &bottom));
            let q = [self.springs[i].at(0.0), self.dampers[i].at(0.0)];
            let closed = plus(&top, &times(&q, &bottom));
            top = times(&q, &top);
            bottom = closed;
        }
        let order = 2 * self.masses_kg.len();
        let leading = bottom[order];
        (0..=order).rev().map(|k| bottom[k] / leading).collect()
    }

    /// Poles, 1/s, as `polynomial_roots` sorts them.
    ///
    /// Two for each mass. Errors: parameters so extreme that the roots of the characteristic polynomial are not found.
    pub fn poles(&self) -> Result<Vec<Complex>, LumpedError> {
        Ok(polynomial_roots(&self.characteristic_polynomial())?)
    }
}

/// Three masses in a row: engine, suspension and chassis, compartment. See [`Chain`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TripleSpringMassDamper {
    /// Masses from the barrier on, kg.
    pub masses_kg: [f64; 3],
    /// Springs in front of them, N/m.
    pub springs_n_per_m: [f64; 3],
    /// Dampers in front of them, N·s/m.
    pub dampers_n_s_per_m: [f64; 3],
}

impl TripleSpringMassDamper {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::TripleSpringMassDamper, &self.values())?;
        constants(&self.masses_kg, &self.springs_n_per_m, &self.dampers_n_s_per_m)
    }

    /// Its parameters, masses first.
    pub(crate) fn values(&self) -> Vec<f64> {
        [self.masses_kg, self.springs_n_per_m, self.dampers_n_s_per_m].concat()
    }

    /// The model of these parameters; one that is left out is not a number.
    pub(crate) fn from_values(values: &[f64]) -> Self {
        let three = |from: usize| std::array::from_fn(|i| values.get(from + i).copied().unwrap_or(f64::NAN));
        Self { masses_kg: three(0), springs_n_per_m: three(3), dampers_n_s_per_m: three(6) }
    }
}
