//! An open page: what it answers, what it says to the console, keys and pointer, paper.
//! May use `screen`.

mod open;
mod said;

pub use open::Page;
