//! A fleet as a whole: its records found, its runs made, its tables and its page written.

pub mod make;
