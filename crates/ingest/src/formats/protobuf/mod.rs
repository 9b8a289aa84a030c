//! Numbers out of protobuf messages: wire format, described types, paths through the fields.

pub mod decoder;
mod types;
mod wire;
