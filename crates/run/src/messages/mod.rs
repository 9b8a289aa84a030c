//! What is said to people beside what the stages say themselves.

pub mod changed_options;
pub mod replaced_record;
pub mod stage_failed;
pub mod whose_flag;
