//! Elements: springs, dampers and their series.
//!
//! A spring that unloads stiffer than it loads, about a permanent set.
//!
//! Beyond the largest compression so far the force is `k_E u`; from there it goes out, and in again, along `k_P` about
//! the permanent set `u_max (1 - k_E/k_P)` until it passes that compression. This is what the law of the single-mass
//! paper for one loading and one unloading (section 3.2, equations 9 to 15) says when a motion goes on: no hardening
//! but by crush, no softening by repetition.

use crate::structure::connected_masses::{Branch, Form, Guard, Law, Strain};
use crate::structure::piecewise_linear::PiecewiseLinear;

/// The elastoplastic spring. Parameters: stiffness of loading, of unloading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlasticSpring {
    /// Stiffness while loading `k_E`, N/m, positive.
    pub loading_stiffness_n_per_m: f64,
    /// Stiffness of unloading `k_P`, N/m, positive.
    pub unloading_stiffness_n_per_m: f64,
    /// Whether it lets go below the permanent set; else the line goes on into tension.
    pub release: bool,
}

/// Farther in than ever.
const LOADING: usize = 0;
/// Out and in again, up to the largest compression so far.
const UNLOADING: usize = 1;
/// Without contact.
const OPEN: usize = 2;

impl PlasticSpring {
    /// Share of a compression that stays.
    fn lasting(&self) -> f64 {
        1.0 - self.loading_stiffness_n_per_m / self.unloading_stiffness_n_per_m
    }
}

impl Law for PlasticSpring {
    fn parameters(&self) -> usize {
        2
    }

    fn has_branches(&self) -> bool {
        true
    }

    fn start(&self, s: Strain) -> Branch {
        Branch { line: if s.u > 0.0 || s.w > 0.0 { LOADING } else { UNLOADING }, ..Branch::default() }
    }

    fn force(&self, branch: &Branch) -> Form {
        let stiff = self.unloading_stiffness_n_per_m;
        match branch.line {
            LOADING => Form { u: self.loading_stiffness_n_per_m, ..Form::ZERO },
            UNLOADING => Form { u: stiff, constant: -stiff * branch.set, ..Form::ZERO },
            _ => Form::ZERO,
        }
    }

    fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
        let below = |limit: f64| Form { constant: limit, u: -1.0, ..Form::ZERO };
        match branch.line {
            LOADING => add(Guard { form: Form { w: 1.0, ..Form::ZERO }, next: UNLOADING }),
            UNLOADING => {
                add(Guard { form: below(branch.crush), next: LOADING });
                if self.release {
                    add(Guard { form: Form { constant: -branch.set, u: 1.0, ..Form::ZERO }, next: OPEN });
                }
            }
            _ => add(Guard { form: below(branch.set), next: UNLOADING }),
        }
    }

    fn enter(&self, branch: &Branch, next: usize, strain: Strain) -> Branch {
        match branch.line {
            LOADING => Branch { line: next, set: strain.u * self.lasting(), crush: strain.u, ..*branch },
            _ => Branch { line: next, ..*branch },
        }
    }

    fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
        match (branch.line, parameter) {
            (LOADING, 0) => Form { u: 1.0, ..Form::ZERO },
            (UNLOADING, 1) => Form { u: 1.0, constant: -branch.set, ..Form::ZERO },
            _ => Form::ZERO,
        }
    }

    fn force_by_set(&self, branch: &Branch) -> Form {
        let constant = if branch.line == UNLOADING { -self.unloading_stiffness_n_per_m } else { 0.0 };
        Form { constant, ..Form::ZERO }
    }

    fn set_by(&self, before: &Branch, strain: Strain, by_u: f64, parameter: Option<usize>, set: f64) -> f64 {
        if before.line != LOADING {
            return set;
        }
        let (soft, stiff) = (self.loading_stiffness_n_per_m, self.unloading_stiffness_n_per_m);
        let own = match parameter {
            Some(0) => -strain.u / stiff,
            Some(_) => strain.u * soft / (stiff * stiff),
            None => 0.0,
        };
        self.lasting() * by_u + own
    }

    fn energies(&self, branch: &Branch, strain: &Strain) -> [f64; 2] {
        let crush = if branch.line == LOADING { strain.u } else { branch.crush };
        let stored = 0.5 * self.force(branch).at(*strain).powi(2) / self.unloading_stiffness_n_per_m;
        [stored, 0.5 * self.loading_stiffness_n_per_m * crush * crush * self.lasting()]
    }

    fn symbols(&self) -> &'static str {
        "k"
    }
}

/// A spring whose stiffness, N/m, is constant or linear between knots over the compression, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring(pub PiecewiseLinear);

/// A damper whose coefficient, N·s/m, is constant or linear between knots over the rate of the compression, m/s.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper(pub PiecewiseLinear);

/// The law of an element over one of what it feels, with the term of its square in a force; `$symbol`: of its force;
/// `$start`: what it feels at the start, and where that goes.
macro_rules! secant_law {
    ($element:ident, $felt:ident, $square:ident, $symbol:literal, $start:expr, { $($own:item)* }) => {
        impl Law for $element {
            fn parameters(&self) -> usize {
                2 * self.0.len()
            }

            fn is_linear(&self) -> bool {
                self.0.as_constant().is_some()
            }

            fn has_branches(&self) -> bool {
                self.0.len() > 1
            }

            fn start(&self, strain: Strain) -> Branch {
                let (felt, towards) = $start(strain);
                Branch { line: self.0.line_at(felt, towards), ..Branch::default() }
            }

            fn force(&self, branch: &Branch) -> Form {
                let line = self.0.line(branch.line);
                Form { $felt: line.constant, $square: line.slope, ..Form::ZERO }
            }

            fn guards(&self, branch: &Branch, add: &mut dyn FnMut(Guard)) {
                let line = self.0.line(branch.line);
                if line.low.is_finite() {
                    add(Guard { form: Form { constant: -line.low, $felt: 1.0, ..Form::ZERO }, next: branch.line - 1 });
                }
                if line.high.is_finite() {
                    add(Guard { form: Form { constant: line.high, $felt: -1.0, ..Form::ZERO }, next: branch.line + 1 });
                }
            }

            fn force_by(&self, branch: &Branch, parameter: usize) -> Form {
                let (constant, slope) = self.0.line_by(branch.line, parameter);
                Form { $felt: constant, $square: slope, ..Form::ZERO }
            }

            fn symbols(&self) -> &'static str {
                $symbol
            }

            $($own)*
        }
    };
}

secant_law!(Spring, u, uu, "k", |s: Strain| (s.u, s.w), {
    fn energies(&self, _: &Branch, strain: &Strain) -> [f64; 2] {
        [self.0.energy(strain.u), 0.0]
    }
});

secant_law!(Damper, w, ww, "c", |s: Strain| (s.w, 0.0), {
    fn energies(&self, _: &Branch, _: &Strain) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn damping(&self, branch: &Branch) -> Form {
        self.force(branch)
    }
});

/// Spring and damper in series. Parameters: stiffness, coefficient of the damper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesSpringDamper {
    /// Spring, N/m, positive.
    pub stiffness_n_per_m: f64,
    /// Damper, N·s/m, positive.
    pub damping_n_s_per_m: f64,
}

impl Law for SeriesSpringDamper {
    fn parameters(&self) -> usize {
        2
    }

    fn has_branches(&self) -> bool {
        false
    }

    fn force(&self, _: &Branch) -> Form {
        Form { z: self.stiffness_n_per_m, ..Form::ZERO }
    }

    fn inner_rate(&self) -> Option<Form> {
        Some(Form { w: 1.0, z: -self.stiffness_n_per_m / self.damping_n_s_per_m, ..Form::ZERO })
    }

    fn force_by(&self, _: &Branch, parameter: usize) -> Form {
        Form { z: if parameter == 0 { 1.0 } else { 0.0 }, ..Form::ZERO }
    }

    fn inner_rate_by(&self, parameter: usize) -> Form {
        let (k, c) = (self.stiffness_n_per_m, self.damping_n_s_per_m);
        Form { z: if parameter == 0 { -1.0 / c } else { k / (c * c) }, ..Form::ZERO }
    }

    fn energies(&self, _: &Branch, strain: &Strain) -> [f64; 2] {
        [0.5 * self.stiffness_n_per_m * strain.z * strain.z, 0.0]
    }

    fn damping(&self, branch: &Branch) -> Form {
        self.force(branch)
    }

    fn symbols(&self) -> &'static str {
        "kc"
    }

    fn compression(&self, part: usize, strain: &Strain) -> f64 {
        if part == 0 { strain.z } else { strain.u - strain.z }
    }
}
