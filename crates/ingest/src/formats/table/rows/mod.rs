//! How the rows of a table are written, and their numbers by columns.
//! May use text and what formats may use, no other file of the room above.

pub mod layout;
pub mod numbers;
