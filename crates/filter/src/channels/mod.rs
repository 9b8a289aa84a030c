//! Which channels of a test are filtered, and to which class.

pub mod selection;
