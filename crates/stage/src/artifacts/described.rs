//! The description of the test among the inputs of a stage: read whole, handed on with the channels that have samples.

use crumple_artifact::records::{ChannelV1, TestV1};
use crumple_signal::TestDescription;

use crate::artifacts::inputs::Inputs;
use crate::error::{RefuseExt, Refused};

impl Inputs {
    /// The test description, from the latest stage that carries it.
    ///
    /// Its channels are those that the filter lists, else ingest, as later stages describe them: behind the filter a
    /// description travels with the channels that have samples alone.
    pub fn test(&self) -> anyhow::Result<TestDescription> {
        let mut test: TestV1 = self.record("/test")?;
        let place = |stage: &str| self.artifacts().iter().rposition(|artifact| artifact.stage() == Some(stage));
        let whole = place("filter").or_else(|| place("ingest")).unwrap_or(0);
        let mut channels: Vec<ChannelV1> = Vec::new();
        for artifact in &self.artifacts()[whole..] {
            let listed = artifact.record::<TestV1>("/test").map_err(Refused::from)?;
            for channel in listed.into_iter().flat_map(|test| test.channels) {
                match channels.iter_mut().find(|other| other.id == channel.id) {
                    Some(other) => *other = channel,
                    None => channels.push(channel),
                }
            }
        }
        test.channels = channels;
        TestDescription::try_from(test).refuse_with_hint("see docs/format.md, type Test")
    }

    /// The description as it travels on behind the filter: of its channels the pulse, and those that an input holds
    /// samples of.
    pub fn test_with_samples(&self, test: &TestDescription) -> TestV1 {
        let mut record = TestV1::from(test);
        let is_of = |wave: &str, channel: &str| {
            wave.strip_prefix(channel).is_some_and(|rest| matches!(rest.chars().next(), None | Some('/')))
        };
        let waves: Vec<&str> = self.waves().map(|(id, _)| id).collect();
        let pulse = record.pulse.clone();
        record
            .channels
            .retain(|channel| pulse.as_ref() == Some(&channel.id) || waves.iter().any(|wave| is_of(wave, &channel.id)));
        record
    }
}
