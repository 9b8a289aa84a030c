//! What the waveforms of a run are taken from.

use crumple_signal::TestDescription;
use crumple_stage::Inputs;

use crate::stage::options::settings::Settings;

/// Settings, test and artifacts of a run.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// The test that the artifacts are of.
    pub test: &'a TestDescription,
    /// The artifacts read.
    pub inputs: &'a Inputs,
}
