//! What the waveforms of a run are taken from.

use crumple_signal::TestDescription;
use crumple_stage::Inputs;
use crumple_stage::records::EventsV1;

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

impl Source<'_> {
    /// Whether the record is of a crash: it has a pulse, or its events. Any other record has inputs and outputs.
    pub fn is_of_a_crash(&self) -> bool {
        self.test.pulse_channel().is_ok() || self.inputs.record_if::<EventsV1>("/events").ok().flatten().is_some()
    }
}
