//! What is around every page and every table: head, style, script, what the browser may load, heads of columns.

pub mod framed;
pub mod heads;
pub mod page_files;
