//! The families whose intervals are tried, and how each is asked for.

use super::car::Draw;

/// A family as the programs solve for it.
#[derive(Debug, Clone, Copy)]
pub struct Family {
    /// Name in the table.
    pub name: &'static str,
    /// Id of its candidates without the index.
    pub id: &'static str,
    /// Flags of crumple-parameter-solve.
    pub flags: &'static [&'static str],
    /// The car that is drawn.
    pub(super) draw: Draw,
}

/// All of them. Closed forms and fits of one model are two estimators with intervals of their own.
pub const FAMILIES: &[Family] = &[
    Family {
        name: "kelvin, closed form",
        id: "kelvin/closed-form",
        flags: &["--models", "kelvin", "--method", "closed-form"],
        draw: Draw::Kelvin,
    },
    Family {
        name: "kelvin, fit",
        id: "kelvin/direct-fit",
        flags: &["--models", "kelvin", "--method", "direct-fit"],
        draw: Draw::Kelvin,
    },
    Family {
        name: "elastoplastic, closed form",
        id: "elastoplastic/closed-form",
        flags: &["--models", "elastoplastic", "--method", "closed-form"],
        draw: Draw::Elastoplastic,
    },
    Family {
        name: "elastoplastic, fit",
        id: "elastoplastic/direct-fit",
        flags: &["--models", "elastoplastic", "--method", "direct-fit"],
        draw: Draw::Elastoplastic,
    },
    Family {
        name: "maxwell, fit",
        id: "maxwell/direct-fit",
        flags: &["--models", "maxwell", "--method", "direct-fit"],
        draw: Draw::Maxwell,
    },
    Family {
        name: "nonlinear-1, fit",
        id: "nonlinear-1/direct-fit",
        flags: &["--models", "nonlinear-1", "--method", "direct-fit"],
        draw: Draw::Nonlinear1,
    },
    Family {
        name: "nonlinear-2, fit",
        id: "nonlinear-2/direct-fit",
        flags: &["--models", "nonlinear-2", "--method", "direct-fit"],
        draw: Draw::Nonlinear2,
    },
    Family {
        name: "double, split known",
        id: "double-spring-mass-damper/direct-fit",
        flags: &["--models", "double-spring-mass-damper", "--method", "direct-fit", "--front-mass-uncertainty", "0"],
        draw: Draw::Double { front: (0.25, 0.25), engine: false },
    },
    Family {
        name: "double, split 15 to 35 % taken as 25 %",
        id: "double-spring-mass-damper/direct-fit",
        flags: &["--models", "double-spring-mass-damper", "--method", "direct-fit"],
        draw: Draw::Double { front: (0.15, 0.35), engine: false },
    },
    Family {
        name: "double, sensor on the engine, masses free",
        id: "double-spring-mass-damper/direct-fit",
        flags: &[
            "--models",
            "double-spring-mass-damper",
            "--method",
            "direct-fit",
            "--sensors",
            "compartment=accel,engine=engine",
            "--fit-masses",
            "free",
        ],
        draw: Draw::Double { front: (0.15, 0.35), engine: true },
    },
];
