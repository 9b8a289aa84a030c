//! What is around every page: head, style, script, and what the browser may load.
//! Uses no other room.

pub mod framed;
