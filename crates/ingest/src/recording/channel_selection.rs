//! Channels by the name a person gives: an id, another name, a pattern.

use crumple_signal::{Channel, resolve_channels};

use crate::recording::read_channel::ReadChannel;

pub use crumple_signal::is_pattern;

/// The channels meant, as indices, see [`resolve_channels`].
pub fn select(channels: &[ReadChannel], wanted: &str) -> Vec<usize> {
    let named: Vec<(&Channel, &[String])> = channels.iter().map(|f| (&f.channel, f.aliases.as_slice())).collect();
    resolve_channels(&named, wanted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    fn named(id: &str, aliases: &[&str]) -> ReadChannel {
        let aliases = aliases.iter().map(|a| (*a).to_owned()).collect();
        ReadChannel { aliases, ..ReadChannel::new(Channel::new(id, QuantityKind::Acceleration)) }
    }

    #[test]
    fn an_id_beats_a_name_beats_a_pattern() {
        let channels = [named("93", &["FLLR", "FLLR XG"]), named("99", &["FLLR", "93"]), named("FLRR", &["94"])];
        assert_eq!(select(&channels, "93"), [0]);
        assert_eq!(select(&channels, "fllr"), [0, 1]);
        assert_eq!(select(&channels, "FL*"), [0, 1, 2]);
        assert_eq!(select(&channels, "*xg"), [0]);
        assert_eq!(select(&channels, "nothing"), [0_usize; 0]);
        assert_eq!(select(&channels, "9?"), [0, 1, 2]);
    }
}
