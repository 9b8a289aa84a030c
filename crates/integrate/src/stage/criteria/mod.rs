//! Numbers beside the motion: occupants, roadside hardware, load cells of the barrier, event data recorders.
//! May use `stage/options` and `stage/metric_record`.

pub mod load_cells;
pub mod occupants_and_roadside;
pub mod recorder;
pub mod sensor_sites;
