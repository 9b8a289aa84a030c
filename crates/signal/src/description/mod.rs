//! What is known of a test beside its samples: description, channels by name, parts of a dummy's body.

pub mod body_part;
pub mod channel_selection;
pub mod test_description;
