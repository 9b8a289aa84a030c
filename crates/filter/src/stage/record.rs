//! What is written and said of a filtered channel.

use crumple_signal::{Applied, CorridorPoint, Filtered, corridor};
use crumple_stage::records::{ChannelFilterV1, CorridorPointV1};

use crate::stage::filtered_channel::Extra;

/// The line of the summary about the pulse.
pub fn pulse_line(id: &str, cfc: Option<u16>, filtered: &Filtered) -> String {
    let class = cfc.map_or_else(|| "no class".to_owned(), |cfc| format!("cfc {cfc}"));
    let how = filtered.applied.as_ref().map_or("passed through", Applied::name);
    format!("pulse {id}: {class} ({how}), zero level {:+.4} m/s^2 removed", filtered.zero_level_removed)
}

/// The record of how a channel was filtered.
pub fn record(filtered: &Filtered, extra: &Extra) -> ChannelFilterV1 {
    let applied = filtered.applied.as_ref();
    let mut record = ChannelFilterV1 {
        cfc: None,
        mode: applied.map_or("none", Applied::name).to_owned(),
        frequency_factor: None,
        samples_added: applied.map_or(0, |applied| applied.samples_added() as u64),
        coefficients: Vec::new(),
        gain_at_class_db: None,
        zero_level_removed: filtered.zero_level_removed,
        notes: filtered.notes.to_texts(),
        corridor: Vec::new(),
        corridor_ok: None,
        cutoff_hz: Vec::new(),
        phase: applied.map(|applied| applied.phase().name().to_owned()),
        width_s: None,
        resampled_to_hz: extra.resampled_to_hz,
        shift_s: None,
    };
    match applied {
        Some(Applied::Class { cfc, coefficients, .. }) => {
            let points = corridor(*cfc, coefficients);
            record.cfc = Some(cfc.number());
            record.frequency_factor = Some(coefficients.mode().frequency_factor());
            record.coefficients = coefficients.to_array().to_vec();
            record.gain_at_class_db = Some(coefficients.two_pass_gain_db(cfc.frequency_hz()));
            record.corridor_ok = Some(points.iter().all(CorridorPoint::is_inside));
            record.corridor = points.into_iter().map(corridor_point).collect();
        }
        Some(Applied::Butterworth { design, .. }) => {
            record.coefficients = design.sections.concat();
            record.cutoff_hz = vec![design.asked.cutoff_hz];
        }
        None => {}
    }
    // What the kept samples show is this filter at their rate.
    if let Some((coefficients, samples_added)) = &extra.as_kept {
        record.coefficients = coefficients.to_array().to_vec();
        record.samples_added = *samples_added as u64;
    }
    record
}

fn corridor_point(point: CorridorPoint) -> CorridorPointV1 {
    let CorridorPoint { frequency_hz, gain_db, upper_db, lower_db } = point;
    CorridorPointV1 { frequency_hz, gain_db, upper_db, lower_db }
}
