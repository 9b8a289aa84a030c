//! Selects channels by the name a person gives: an id, a code, another name, a pattern.

use crate::iso13499::wildcard;
use crate::{Channel, TestDescription};

/// Whether a name is a pattern: it has `*` or `?` in it.
pub fn is_pattern(wanted: &str) -> bool {
    wanted.contains(['*', '?'])
}

/// The channels that a name selects, as indices: the one with this id; else those with this id or code or other name
/// in any case; else, if it is a pattern, all whose id, code or other name matches. None, one or several.
pub fn resolve_channels(channels: &[(&Channel, &[String])], wanted: &str) -> Vec<usize> {
    let wanted = wanted.trim();
    if let Some(index) = channels.iter().position(|(channel, _)| channel.id == wanted) {
        return vec![index];
    }
    let fold = wanted.to_lowercase();
    let all = |fits: &dyn Fn(&str) -> bool, by_other_names: bool| -> Vec<usize> {
        let named = |(channel, names): &(&Channel, &[String])| {
            let others = names.iter().chain(&channel.code).map(String::as_str);
            fits(&channel.id) || (by_other_names && others.into_iter().any(fits))
        };
        (0..channels.len()).filter(|k| named(&channels[*k])).collect()
    };
    let same = |name: &str| name.to_lowercase() == fold;
    for by_other_names in [false, true] {
        let matches = all(&same, by_other_names);
        if !matches.is_empty() {
            return matches;
        }
    }
    if is_pattern(wanted) { all(&|name| wildcard(wanted, name), true) } else { Vec::new() }
}

impl TestDescription {
    /// The channels that an id, a code or a pattern such as `1?VEHC*X?` selects, see [`resolve_channels`].
    pub fn resolve_channels(&self, wanted: &str) -> Vec<&Channel> {
        let named: Vec<(&Channel, &[String])> = self.channels.iter().map(|channel| (channel, [].as_slice())).collect();
        resolve_channels(&named, wanted).into_iter().map(|k| &self.channels[k]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::QuantityKind;

    #[test]
    fn an_id_beats_a_code_beats_a_pattern() {
        let channel = |id: &str, code: &str| Channel {
            code: Some(code.to_owned()),
            ..Channel::new(id, QuantityKind::Acceleration)
        };
        let channels = vec![
            channel("93", "10FORALERE00ACXP"),
            channel("94", "10FORARIRE00ACXP"),
            channel("95", "10ENGN000000ACXP"),
        ];
        let test = TestDescription { channels, ..TestDescription::default() };
        let ids = |wanted: &str| -> Vec<String> {
            test.resolve_channels(wanted).into_iter().map(|channel| channel.id.clone()).collect()
        };
        assert_eq!(ids("93"), ["93"]);
        assert_eq!(ids("10foralere00acxp"), ["93"]);
        assert_eq!(ids("1?FORA*X?"), ["93", "94"]);
        assert_eq!(ids("9?"), ["93", "94", "95"]);
        assert_eq!(ids("96"), [""; 0]);
    }
}
