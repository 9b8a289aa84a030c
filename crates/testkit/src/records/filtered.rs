//! What filtering writes, as far as integration reads it.

use std::error::Error;
use std::path::{Path, PathBuf};

use crumple_artifact::records::TestV1;
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
use crumple_signal::{Channel, Sampled, TestDescription};

/// Writes `2-filter.mcap` of this test, its first channel the pulse: all channels are listed, those with samples have
/// them.
///
/// # Errors
/// A file that cannot be written, two channels of one id.
pub fn write_filtered(
    folder: &Path,
    test: TestDescription,
    channels: &[(Channel, Option<Sampled>)],
) -> Result<PathBuf, Box<dyn Error>> {
    let test = TestDescription {
        pulse: channels.first().map(|(channel, _)| channel.id.clone()),
        channels: channels.iter().map(|(channel, _)| channel.clone()).collect(),
        ..test
    };
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&test))?;
    for (channel, samples) in channels {
        if let Some(samples) = samples {
            builder.wave(&channel.id, channel.quantity, samples.clone())?;
        }
    }
    let path = folder.join("2-filter.mcap");
    builder.write(&path, &Provenance::new("filter", "0", "{}".to_owned(), vec![]), Compression::None)?;
    Ok(path)
}
