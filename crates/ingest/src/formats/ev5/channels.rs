//! Curves of an EV5 set as channels: samples in SI on their time grid.

use std::collections::BTreeMap;

use crumple_signal::unit::signal_unit;
use crumple_signal::{Channel, ChannelStatus, Notes, QuantityKind, Sampled};

use crate::formats::ev5::records::Curve;
use crate::formats::ev5::{code, sensor, signal_file};
use crate::recording::read_channel::ReadChannel;
use crate::time::grid::{self, Grid, GridError};
use crate::{IngestError, Place};

/// A curve as a channel, with its samples if `files` has them.
///
/// A file that cannot be read makes the channel absent with a warning; it is an error only for the channel asked for.
pub fn channel(
    curve: &Curve,
    files: &BTreeMap<u32, (&str, &[u8])>,
    vehicle: u32,
    wanted: bool,
    notes: &mut Notes,
) -> Result<ReadChannel, IngestError> {
    let (quantity, factor) = signal_unit(&curve.y_unit).unwrap_or((QuantityKind::Other, 1.0));
    let id = curve.number.to_string();
    let mut channel = Channel::new(id.clone(), quantity);
    channel.location = sensor::location(curve);
    channel.axis = sensor::axis(curve);
    channel.status = curve.channel_status();
    channel.redundant = curve.channel_status == "R";
    // Division, not a product with 1/3.6: 57.09 km/h is then the nearest number to 15.858333... m/s.
    channel.initial_velocity_m_per_s = curve.initial_velocity_km_per_h.map(|v| v / 3.6);
    channel.comment = curve.comment.clone();
    channel.code = code::code(curve).map(|code| code.to_string());
    channel.filter_state = curve.prefilter_hz.map(|hz| format!("low-pass {hz} Hz"));
    channel.sensor = sensor::words(curve);

    // Two digits and three name the file; people copy either.
    let mut aliases = vec![format!("{:03}", curve.number), format!("{:02}", curve.number)];
    aliases.extend(channel.code.clone());
    aliases.extend([curve.attachment.clone(), format!("{} {}", curve.attachment, curve.axis)]);
    let fitness = sensor::fitness(curve, vehicle).filter(|_| quantity == QuantityKind::Acceleration);
    let read = match files.get(&curve.number) {
        None => {
            if channel.status != ChannelStatus::NotInstalled {
                channel.status = ChannelStatus::Absent;
            }
            ReadChannel::new(channel)
        }
        Some((file, bytes)) => match samples(curve, file, bytes, factor, notes) {
            Ok((samples, jitter)) => {
                if channel.status == ChannelStatus::NotInstalled {
                    notes.warning(format!(
                        "channel {id} is listed as not installed, but {file} is here: taken as questionable"
                    ));
                    channel.status = ChannelStatus::Questionable;
                }
                ReadChannel { wave: Some(samples), jitter, ..ReadChannel::new(channel) }
            }
            Err(error) if wanted => return Err(error),
            Err(error) => {
                notes.warning(format!("channel {id} is left out: {error}"));
                let remark = channel.comment.take().map_or_else(String::new, |comment| format!("; {comment}"));
                ReadChannel::without_readable_file(channel, format!("{error}{remark}"))
            }
        },
    };
    let attachment = Some(curve.attachment.clone()).filter(|code| !code.is_empty());
    Ok(ReadChannel { fitness, aliases, attachment, ..read })
}

fn samples(
    curve: &Curve,
    file: &str,
    bytes: &[u8],
    factor: f64,
    notes: &mut Notes,
) -> Result<(Sampled, f64), IngestError> {
    let refuse = |place: Place, found: String| {
        IngestError::content(
            place,
            found,
            "samples at a uniform rate",
            "the file may be damaged: download the test again",
        )
    };
    let unit_s = match curve.x_unit.as_str() {
        "" | "SEC" | "S" | "SECS" => 1.0,
        "MS" | "MSEC" => 1e3,
        other => return Err(refuse(Place::file(file), format!("its X axis is in {other}, not in time"))),
    };
    let signal = signal_file::parse(file, bytes)?;
    let n = signal.y.len();
    if let (Some(first), Some(last)) = (curve.first, curve.last)
        && last.checked_sub(first).and_then(|d| d.checked_add(1)) != i64::try_from(n).ok()
    {
        notes.warning(format!(
            "{file} has {n} samples, its entry lists {first} to {last}: the samples of the file are used"
        ));
    }
    let listed = curve.interval_us.zip(curve.first).map(|(us, first)| Grid {
        t0_s: first as f64 * us / 1e6,
        dt_s: us / 1e6,
        jitter: 0.0,
    });
    let grid = if signal.x.is_empty() {
        listed.ok_or_else(|| {
            refuse(Place::file(file), "no time column, and its entry lists no DELT and NFP".to_owned())
        })?
    } else {
        let times: Vec<f64> = signal.x.iter().map(|x| x / unit_s).collect();
        let largest = signal.x[0].abs().max(signal.x[n - 1].abs());
        let resolution = 10_f64.powf(largest.log10().floor() - f64::from(signal.x_digits.max(1)) + 1.0) / unit_s;
        let printed = grid::fit(&times, resolution).map_err(|error| match error {
            GridError::Repeated { index } => refuse(Place::line(file, index + 1), "a repeated time".to_owned()),
            GridError::Backwards { index } => refuse(Place::line(file, index + 1), "time runs backwards".to_owned()),
            GridError::Uneven { index, step_s, dt_s } => refuse(
                Place::line(file, index + 1),
                format!("a step of {step_s:.9} s, where the others are {dt_s:.9} s"),
            ),
        })?;
        reconcile(curve.number, listed, printed, &times, resolution, notes)
    };
    let samples = signal.y.into_iter().map(|y| y * factor).collect();
    let sampled =
        Sampled::new(grid.t0_s, grid.dt_s, samples).map_err(|error| refuse(Place::file(file), error.to_string()))?;
    Ok((sampled, grid.jitter))
}

/// The listed grid where the printed times agree with it, else the printed one: DELT is rounded to whole microseconds
/// by the guide, so 16 kHz cannot be listed.
fn reconcile(
    number: u32,
    listed: Option<Grid>,
    printed: Grid,
    times: &[f64],
    resolution: f64,
    notes: &mut Notes,
) -> Grid {
    let Some(listed) = listed else { return printed };
    let end = |grid: &Grid| grid.t0_s + (times.len() - 1) as f64 * grid.dt_s;
    let slack = resolution + grid::STEP_TOLERANCE * printed.dt_s;
    if (listed.t0_s - times[0]).abs() <= slack && (end(&listed) - times[times.len() - 1]).abs() <= slack {
        return Grid { jitter: printed.jitter, ..listed };
    }
    notes.warning(format!(
        "channel {number}: its entry lists samples every {} s from {} s, the times in its file say every {} s from {} \
         s: those are used",
        listed.dt_s, listed.t0_s, printed.dt_s, printed.t0_s
    ));
    printed
}
