//! A running browser.

mod start;

pub use start::Browser;
