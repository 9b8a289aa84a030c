//! Random numbers that are the same for any number of threads.

mod circular_blocks;
mod random_numbers;
mod uniform_at;

pub use circular_blocks::circular_blocks;
pub use random_numbers::RandomNumbers;
pub use uniform_at::uniform_at;
