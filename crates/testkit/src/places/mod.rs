//! Where the workspace and the shared reference material lie.
//! Uses no other room.

mod folders;

pub use folders::{shared, workspace};
