//! Where the workspace and the shared reference material lie.

mod folders;

pub use folders::{shared, workspace};
