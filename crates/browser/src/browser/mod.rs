//! A running browser.
//! May use `page` and `screen`.

mod start;

pub use start::Browser;
