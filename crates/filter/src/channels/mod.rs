//! Which channels of a test are filtered, and to which class.
//! May use `cfc`.

pub mod selection;
