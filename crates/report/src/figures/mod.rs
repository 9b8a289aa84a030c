//! The figures of the page, one file each. A figure whose record is absent is left out.
//! Uses drawing, results and text.

pub mod all;
pub mod crash;
pub mod identification;
