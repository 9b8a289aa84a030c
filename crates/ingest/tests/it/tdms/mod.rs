//! TDMS: the real files, and files built here for what they lack.

mod identity;
mod layout;
mod mutations;
mod real_files;
mod scaling;
mod time;
mod writer;
