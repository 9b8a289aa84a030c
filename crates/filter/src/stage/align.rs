//! Shifts channels in time so that they lie over one of them.

use crumple_filter::delay;
use crumple_signal::QuantityKind;
use crumple_stage::{RefuseExt, Refused};

use crate::stage::filtered_channel::FilteredChannel;
use crate::stage::options::Align;
use crate::stage::remarks::Remarks;

/// Below this correlation two channels do not show the same motion, and a delay between them means nothing.
const LOWEST_CORRELATION: f64 = 0.5;

/// Shifts the time axis of every other acceleration by its delay against the one named; heads and chests that nobody named stay. Nothing is interpolated: the
/// samples stay as they are, their times move.
pub fn align(channels: &mut [FilteredChannel], asked: &Align, remarks: &mut Remarks) -> anyhow::Result<()> {
    let reference = channels.iter().find(|channel| channel.id == asked.to).ok_or_else(|| {
        Refused::new(format!("channel {} is not among those filtered, so nothing can be aligned to it", asked.to))
            .hint("name it in --channels too")
    })?;
    let reference = reference.filtered.samples.clone();
    for channel in channels.iter_mut() {
        if channel.id == asked.to || channel.quantity != QuantityKind::Acceleration || channel.for_criteria {
            continue;
        }
        let samples = &channel.filtered.samples;
        let found = match delay(samples, &reference, asked.within_s) {
            Ok(found) if found.correlation >= LOWEST_CORRELATION => found,
            Ok(found) => {
                let correlation = found.correlation;
                remarks.warning(
                    &channel.id,
                    format!("not aligned to {}: the highest correlation is {correlation:.3}", asked.to),
                );
                continue;
            }
            Err(error) => {
                remarks.warning(&channel.id, format!("not aligned to {}: {error}", asked.to));
                continue;
            }
        };
        // Whole nanoseconds, as an artifact stores times.
        let shift_s = (-found.delay_s * 1e9).round() / 1e9;
        channel.filtered.samples = samples.starting_at(samples.t0_s() + shift_s).refuse()?;
        channel.extra.shift_s = Some(shift_s);
        remarks.info(
            &channel.id,
            format!(
                "time axis shifted by {:+.4} ms to lie over channel {} (correlation {:.4})",
                1e3 * shift_s,
                asked.to,
                found.correlation
            ),
        );
    }
    Ok(())
}
