//! The figures of the page, one file each. A figure whose record is absent is left out.

pub mod all;
pub mod crash;
pub mod identification;
pub mod shown_at_first;
pub mod time_view;
