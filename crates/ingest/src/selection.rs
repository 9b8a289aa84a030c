//! Channels by the name a person gives: an id, another name, a pattern.

use crumple_signal::iso13499::wildcard;

use crate::recording::Found;

/// Whether a name is a pattern: it has `*` or `?` in it.
pub fn is_pattern(wanted: &str) -> bool {
    wanted.contains(['*', '?'])
}

/// The channels meant, as indices: the one with this id; else those with this id or other name in any case; else, if it is a
/// pattern, all whose id, code or other name fits. None, one or several.
pub fn select(channels: &[Found], wanted: &str) -> Vec<usize> {
    let wanted = wanted.trim();
    if let Some(index) = channels.iter().position(|f| f.channel.id == wanted) {
        return vec![index];
    }
    let fold = wanted.to_lowercase();
    let all = |fits: &dyn Fn(&str) -> bool, aliases: bool| -> Vec<usize> {
        let named = |f: &Found| {
            let others = f.aliases.iter().chain(&f.channel.code).map(String::as_str);
            fits(&f.channel.id) || (aliases && others.into_iter().any(fits))
        };
        (0..channels.len()).filter(|k| named(&channels[*k])).collect()
    };
    let same = |name: &str| name.to_lowercase() == fold;
    for aliases in [false, true] {
        let found = all(&same, aliases);
        if !found.is_empty() {
            return found;
        }
    }
    if is_pattern(wanted) { all(&|name| wildcard(wanted, name), true) } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::{Channel, QuantityKind};

    fn found(id: &str, aliases: &[&str]) -> Found {
        Found {
            channel: Channel::new(id, QuantityKind::Acceleration),
            wave: None,
            jitter: 0.0,
            fitness: None,
            aliases: aliases.iter().map(|a| (*a).to_owned()).collect(),
        }
    }

    #[test]
    fn an_id_beats_a_name_beats_a_pattern() {
        let channels = [found("93", &["FLLR", "FLLR XG"]), found("99", &["FLLR", "93"]), found("FLRR", &["94"])];
        assert_eq!(select(&channels, "93"), [0]);
        assert_eq!(select(&channels, "fllr"), [0, 1]);
        assert_eq!(select(&channels, "FL*"), [0, 1, 2]);
        assert_eq!(select(&channels, "*xg"), [0]);
        assert_eq!(select(&channels, "nothing"), [0_usize; 0]);
        assert_eq!(select(&channels, "9?"), [0, 1, 2]);
    }
}
