//! One budget of memory for a process, kept by its allocator.
//!
//! What a file states about its size reserves nothing by itself: readers ask [`left`] first and refuse with the place
//! in the file. What they overlook ends here: an allocation beyond the budget prints the refusal that was set with it
//! and ends the process with its exit code, before the memory is taken. Without a budget nothing is refused.

mod memory;

pub use memory::{Budgeted, left, peak, set_budget, used};
