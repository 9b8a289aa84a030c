//! The vocabulary of crash records: quantities, units, sampled signals, channels, the test
//! description and notes. No input or output, no filters, no numerics beyond a time grid
//! and the zero level before the event.
//!
//! Inside Crumple every number is SI. A value typed by a person carries its unit
//! ([`value::Mass`], [`value::Speed`], ...); an array carries its quantity in its type
//! ([`Signal<Acceleration>`](Signal)).

mod body_part;
mod channel;
pub mod iso13499;
mod note;
mod pre_event;
mod quantity;
mod selection;
mod signal;
mod test_description;
mod uncertain;
pub mod unit;
pub mod value;

pub use body_part::{BodyPart, part_of};
pub use channel::{Axis, Channel, ChannelStatus};
pub use note::{Note, Notes, Severity};
pub use pre_event::{PreEvent, PreEventWindow, pre_event};
pub use quantity::{Acceleration, Displacement, Force, Quantity, QuantityKind, Velocity};
pub use selection::{channels_meant, is_pattern};
pub use signal::{Sampled, Signal, SignalError};
pub use test_description::{PulseError, Source, TestDescription};
pub use uncertain::{Distribution, Uncertain};

/// Standard acceleration of gravity, m/s² per g, exact (ISO 80000-3; CGPM 1901).
pub const STANDARD_GRAVITY_M_PER_S2: f64 = 9.806_65;
