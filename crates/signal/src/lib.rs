//! The vocabulary of crash records: quantities, units, sampled signals, channels, the test
//! description and notes. No input or output, no filters, no numerics beyond a time grid
//! and the zero level before the event.
//!
//! Inside Crumple every number is SI. A value typed by a person carries its unit
//! ([`value::Mass`], [`value::Speed`], ...); an array carries its quantity in its type
//! ([`Signal<Acceleration>`](Signal)).
//!
//! rooms: description | iso13499 | channels samples | notes units

mod channels;
mod description;
pub mod iso13499;
mod notes;
mod samples;
mod units;

pub use channels::{Axis, Channel, ChannelStatus};
pub use description::{ANOTHER_VEHICLE, PulseError, Source, TestDescription};
pub use description::{BodyPart, part_of};
pub use description::{is_pattern, resolve_channels};
pub use notes::{About, Bearing, UnknownAbout, Weight};
pub use notes::{Note, Notes, Severity};
pub use samples::{BeforeEvent, RecordingSteps};
pub use samples::{FreeFall, falls_before_event, free_fall, is_gravity};
pub use samples::{PreEvent, PreEventWindow, pre_event};
pub use samples::{Sampled, Signal, SignalError};
pub use units::gravity::STANDARD_GRAVITY_M_PER_S2;
pub use units::quantity::{Acceleration, Displacement, Force, Quantity, QuantityKind, Velocity};
pub use units::uncertain::{Distribution, Uncertain};
pub use units::{unit, value};
