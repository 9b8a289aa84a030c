//! Pages in a real browser, for tests: opened on a screen, asked, pointed to, typed to, printed. A dev-dependency only.
//!
//! The browser is driven over its DevTools protocol by the crate `headless_chrome`. What fails here fails the test that
//! asked, so functions panic with what the browser said.

mod browser;
mod page;
mod screen;

pub use browser::Browser;
pub use page::Page;
pub use screen::Screen;
