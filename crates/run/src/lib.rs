//! Runs the stages of a pipeline one after another into one folder: the program behind `just run`.
//!
//! The stages know nothing of each other and this program knows nothing of what they compute. It knows the chain
//! (`pipelines/chain`) and the commands of its stages, and it keeps the promises of a run folder: one run at a time, no
//! results of two records side by side, nothing lost by a run that fails, and a plain word where a program breaks the
//! contract of a stage.
//!
//! [`together`] fits one model to several tests after their runs; [`fleet`] runs many records.

mod command;
pub mod fleet;
mod folder {
    //! The run folder: its lock, who holds it, whose files are in it, what an earlier run left behind.

    pub mod content;
    pub mod lock;
}
mod messages;
mod run;
mod steps;
mod together {
    //! One model for several tests: their runs, the joint stages, every test predicted from the others.

    pub mod joint_run;
    pub mod summary;
}

pub use command::{Options, Pipeline, own_program, typed_commands};
pub use run::run;
pub use together::joint_run::{TogetherOptions, together};
