//! Flags that all stages have, and the table of a pipeline file under them.

pub mod args;
pub mod left_out;
pub mod memory_limit;
pub mod pipeline;
pub mod pipeline_file;
