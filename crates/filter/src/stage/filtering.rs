//! Filters all channels at once.

use std::sync::Mutex;

use crumple_signal::{FilterError, Filtered, Note, filter_reporting};
use crumple_stage::{Output, Refused};
use rayon::prelude::*;

use crate::stage::channels_to_filter::ChannelToFilter;
use crate::stage::filtered_channel::{Extra, FilteredChannel};
use crate::stage::remarks::Remarks;

/// The channels after filtering, in their order. One that cannot be filtered is refused, or left out with a warning
/// where nobody named it and it is not the pulse.
pub fn filter_channels(
    channels: &[ChannelToFilter<'_>],
    named: bool,
    pulse: Option<&str>,
    remarks: &mut Remarks,
    out: &Output,
) -> anyhow::Result<Vec<FilteredChannel>> {
    let mut all = Vec::new();
    for (channel, result) in channels.iter().zip(filter_all(channels, out)) {
        match result {
            Ok(filtered) => {
                for note in filtered.notes.iter() {
                    remarks.add(&channel.id, note.clone());
                }
                all.push(FilteredChannel {
                    id: channel.id.clone(),
                    quantity: channel.wave.quantity,
                    filtered,
                    extra: Extra::default(),
                });
            }
            // A channel nobody asked for does not stop the others.
            Err(error) if !named && pulse != Some(&channel.id) => {
                remarks.add(&channel.id, Note::warning(format!("left out: {error}")));
            }
            Err(error) => {
                return Err(Refused::new(format!("channel {}: {error}", channel.id)).hint(hint(&error)).into());
            }
        }
    }
    Ok(all)
}

/// All channels at once; the results are in the order of the channels, whatever the number of threads.
fn filter_all(channels: &[ChannelToFilter<'_>], out: &Output) -> Vec<Result<Filtered, FilterError>> {
    let work = channels.iter().map(|channel| 2 * channel.wave.sampled.len() as u64).sum();
    let progress = Mutex::new(out.progress("filtering", work));
    let report = |amount| {
        if let Ok(mut progress) = progress.lock() {
            progress.advance(amount);
        }
    };
    let run = |channel: &ChannelToFilter<'_>| {
        filter_reporting(&channel.wave.sampled, channel.cfc, &channel.settings, &report)
    };
    match channels {
        // Threads cost more than they give for one channel.
        [channel] => vec![run(channel)],
        several => several.par_iter().map(run).collect(),
    }
}

/// The one thing to do about a channel that cannot be filtered.
fn hint(error: &FilterError) -> &'static str {
    match error {
        FilterError::Order { .. } => "--order 4 is usual",
        FilterError::Cutoff { .. } => "--cutoff takes the -3 dB frequency with its unit, e.g. --cutoff 100Hz",
        FilterError::Window { .. } => "--zero-level-from comes before --zero-level-to",
        _ => "--cfc none leaves the signal as it is, --channels names the channels to filter",
    }
}
