//! One model for several tests: their runs, the joint stages, every test predicted from the others, and what it says.

pub mod each_run;
pub mod files;
pub mod joint_run;
pub mod leave_one_out;
pub mod options;
pub mod summary;
