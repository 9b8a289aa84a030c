//! An open page: what it answers, what it says to the console, keys and pointer, paper.

mod open;
mod said;

pub use open::Page;
