//! Channel codes of ISO/TS 13499 as names of columns and waveforms: `10VEHC0000__ACXD`, `10VEHCCG0000ACXP (g)`.
//!
//! DIAdem and laboratories name the channels of TDMS, TDM, LVM and CSV files by their codes. The code then says place,
//! axis and filter class, as it does in an ISO-MME file. A name is only taken for a code if every place of it that has
//! a table holds something of that table, so that `Acceleration_0` stays a name.

use crumple_signal::iso13499::IsoCode;
use crumple_signal::{About, Channel, Notes, QuantityKind, Weight, remarks};

use crate::formats::remarks::CodeAgainstUnit;
use crate::recording::content::{PulseRule, ReadChannel};
use crate::recording::settings;
use crate::{IngestSettings, pulse};

/// Test objects a code may begin with.
const OBJECTS: &str = "?0123456789BMSPHDCT";
const DIRECTIONS: &str = "?XYZR0123";
const FILTERS: &str = "?_0ABCDEFGHLPQSXV123";
/// Longest prefix before its `_`: `M`, `DG0`, `Chan12`.
const LONGEST_PREFIX: usize = 8;

/// The code that a name without its unit is, and what had to be made of it.
///
/// DIAdem appends `_NoName` and a number where a name is taken already. Programs whose names cannot begin with a digit
/// put something in front: MATLAB `x`, R `X`, asammdf `M_`. A name in small letters, one with such a prefix, or one
/// without test object and position, is a code only if its main location is known.
pub fn code_of_name(name: &str) -> Option<(IsoCode, Vec<String>)> {
    let name = name.trim();
    let bare = name.strip_prefix(['x', 'X']).or_else(|| {
        let (prefix, rest) = name.split_once('_')?;
        (prefix.len() <= LONGEST_PREFIX).then_some(rest)
    });
    let of_bare = || {
        let bare = bare.filter(|bare| bare.starts_with(|c: char| c.is_ascii_digit()) && bare.len() >= 15)?;
        let (code, mut remarks) = code_of(bare).filter(|(code, _)| code.has_known_location())?;
        remarks.push(format!("the prefix of code {name:?} is left off: {code}"));
        Some((code, remarks))
    };
    code_of(name).or_else(of_bare)
}

fn code_of(name: &str) -> Option<(IsoCode, Vec<String>)> {
    let suffix = name.to_ascii_lowercase().find("_noname");
    let written = suffix.map_or(name, |at| &name[..at]);
    let (code, mut remarks) = IsoCode::parse(written).ok()?;
    let text = code.as_str();
    let character = |at: usize| text[at..].chars().next().unwrap_or('?');
    let known_parts = OBJECTS.contains(character(0))
        && DIRECTIONS.contains(character(14))
        && FILTERS.contains(character(15))
        && code.quantity().1 != "not known";
    // Locations are letters; `M_10SILL00FRACXP` is no code.
    let strict = written.bytes().any(|b| b.is_ascii_lowercase())
        || written.len() < 15
        || code.main_location().bytes().any(|b| b.is_ascii_digit());
    if !known_parts || (strict && !code.has_known_location()) {
        return None;
    }
    if let Some(at) = suffix {
        remarks.push(format!("suffix {:?} of code {written:?} is left off", &name[at..]));
    }
    Some((code, remarks))
}

/// Whether a name is the code of an acceleration.
pub fn is_acceleration(name: &str) -> bool {
    code_of_name(name).is_some_and(|(code, _)| code.quantity().0 == Some(QuantityKind::Acceleration))
}

/// Puts what the code in a channel's name says into the channel; its quantity, told by the unit, stays.
pub fn describe_by_name(channel: &mut Channel, name: &str, notes: &mut Notes) {
    let Some((code, remarks)) = code_of_name(name) else { return };
    remarks.into_iter().for_each(|reason| notes.push(CodeOfName { reason }));
    if let Some(of_code) =
        code.quantity().0.filter(|q| *q != channel.quantity && channel.quantity != QuantityKind::Other)
    {
        let (place, of_unit) = (format!("channel {}", channel.id), channel.quantity.to_string());
        notes.push(CodeAgainstUnit { place, of_code: of_code.to_string(), of_unit });
    }
    describe_by_code(channel, &code);
}

/// Puts what a code says into a channel, its quantity aside.
pub fn describe_by_code(channel: &mut Channel, code: &IsoCode) {
    channel.location = code.location();
    channel.axis = code.axis();
    channel.redundant = code.redundant();
    channel.cfc = code.filter_class().cfc();
    channel.filter_state = Some(code.filter_class().to_string());
    channel.code = Some(code.to_string());
    channel.polarity = code.polarity_remark();
}

/// How the pulse is found among channels of which some are named by codes: as in an ISO-MME test if all accelerations
/// that may be the pulse are and one sits at a usual place, else there must be only one.
pub fn pulse_rule(channels: &mut [ReadChannel], settings: &IngestSettings, notes: &mut Notes) -> PulseRule {
    let code_of =
        |read: &ReadChannel| read.channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()).map(|(c, _)| c);
    if settings.vehicle_number.is_some() && !channels.iter().any(|read| code_of(read).is_some()) {
        settings::warn("--vehicle-number", "no channel is named by a channel code", notes);
    }
    let candidates: Vec<usize> = (0..channels.len()).filter(|k| channels[*k].fitness.is_some()).collect();
    let vehicle = settings.vehicle_of_code();
    let fitness: Vec<_> =
        candidates.iter().map(|k| code_of(&channels[*k]).map(|code| pulse::fitness(&code, vehicle))).collect();
    if candidates.len() < 2 || fitness.iter().any(Option::is_none) || !fitness.iter().flatten().any(Option::is_some) {
        return PulseRule::OnlyOne;
    }
    for (k, fitness) in candidates.into_iter().zip(fitness) {
        channels[k].fitness = fitness.flatten();
    }
    PulseRule::Fittest
}

remarks! {
    /// Remarks of channel codes as names.
    pub REMARKS;

    /// The name of a channel is a code of ISO/TS 13499 but for a prefix, a suffix or open places.
    CR021 CodeOfName { reason: String }
    bears on (About::Record, Weight::None)
    decided "A name is a code if every place of it that has a table holds something of that table. Programs put a \
             prefix in front of a digit, DIAdem a suffix _NoName behind a name that is taken."
    means "The code says place, axis and filter class of the channel."
    remedy "nothing"
    says reason.clone();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_told_from_names() {
        let code = |name: &str| code_of_name(name).map(|(code, _)| code.to_string());
        for (name, expected) in [
            ("10VEHC0000__ACXD", "10VEHC0000__ACXD"),
            ("10VEHC0000__ACXD_NoName12", "10VEHC0000__ACXD"),
            ("11HEADCG00__ACR_NoName1", "11HEADCG00__ACR?"),
            (" 10VEHCCG0000ACXP ", "10VEHCCG0000ACXP"),
            ("10vehccg0000acxp", "10VEHCCG0000ACXP"),
            ("VEHC0000__VEX", "??VEHC0000__VEX?"),
            ("10QQQQ000000ACXD", "10QQQQ000000ACXD"),
            ("x11SILLLE0000ACXP", "11SILLLE0000ACXP"),
            ("X11SILLLE0000ACXP", "11SILLLE0000ACXP"),
            ("M_11SILLLE0000ACXP", "11SILLLE0000ACXP"),
            ("DG0_11SILLLE0000ACXP", "11SILLLE0000ACXP"),
            ("x11SILLLE0000ACXP_g_", "11SILLLE0000ACXP"),
            ("x11HEADCG00__ACR", "11HEADCG00__ACR?"),
            ("M0MBARLEMIUPACXP", "M0MBARLEMIUPACXP"),
        ] {
            assert_eq!(code(name).as_deref(), Some(expected), "{name}");
        }
        for name in [
            "Acceleration_0",
            "Accelerometer_1",
            "acceleration_acx",
            "IIWPG_Target_Pul",
            "Laengsbeschl_ACX",
            "",
            "time_s",
            "Müller",
            "M_10SILL00FRACXP",
            "x10SILL00FRACXP",
            "x_10QQQQ000000ACXD",
            "M_ü1SILLLE0000ACXP",
        ] {
            assert_eq!(code(name), None, "{name}");
        }
        assert!(is_acceleration("10VEHC0000__ACXD") && !is_acceleration("10VEHC0000__VEXD"));
    }
}
