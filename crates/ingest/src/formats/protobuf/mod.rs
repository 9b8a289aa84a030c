//! Numbers out of protobuf messages: wire format, described types, paths through the fields.
//! May use no other room.

pub mod decoder;
mod types;
mod wire;
