//! What is around every page: head, style, script, and what the browser may load.
//! Uses drawing and text.

pub mod framed;
