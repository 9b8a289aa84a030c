//! A spring that unloads stiffer than it loads, about a permanent set.
//!
//! Beyond the largest compression so far the force is `k_E u`; from there it goes out, and in again, along `k_P` about
//! the permanent set `u_max (1 - k_E/k_P)` until it passes that compression. This is what the law of the single-mass
//! paper for one loading and one unloading (section 3.2, equations 9 to 15) says when a motion goes on: no hardening
//! but by crush, no softening by repetition.

use crate::structure::form::{Form, Strain};
use crate::structure::law::{Branch, Guard, Law};

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
