//! Pages in a real browser, for tests: opened on a screen, asked, pointed to, typed to, printed. A dev-dependency only.
//!
//! The browser is driven over its DevTools protocol by the crate `headless_chrome`. What fails here fails the test that
//! asked, so functions panic with what the browser said.

mod page;
mod running;
mod screen;

pub use page::Page;
pub use running::Browser;
pub use screen::Screen;
