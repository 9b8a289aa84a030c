//! Ids of waveforms, and the names under which they may be asked for.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::label::Label;

/// `group.channel`, the unit left out, each once: letters, digits, `_`, `-` and `.`; anything else becomes `_`, so that
/// an id can be a part of a topic and of a file name.
pub fn ids(waveforms: &[Waveform], labels: &[Label]) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let mut next_copy: BTreeMap<String, usize> = BTreeMap::new();
    let mut ids = Vec::with_capacity(waveforms.len());
    for (k, (waveform, label)) in waveforms.iter().zip(labels).enumerate() {
        let mut base = clean(&label.name);
        if base.is_empty() {
            base = format!("channel_{}", k + 1);
        }
        let group = clean(&waveform.group);
        if !group.is_empty() {
            base = format!("{group}.{base}");
        }
        let mut id = base.clone();
        let copy = next_copy.entry(base.clone()).or_insert(2);
        while !taken.insert(id.clone()) {
            id = format!("{base}-{copy}");
            *copy += 1;
        }
        ids.push(id);
    }
    ids
}

fn clean(name: &str) -> String {
    let mut clean = String::new();
    for c in name.chars().take(80) {
        if c.is_alphanumeric() || matches!(c, '_' | '-' | '.') {
            clean.push(c);
        } else if !clean.is_empty() && !clean.ends_with('_') {
            clean.push('_');
        }
    }
    clean.trim_end_matches(['_', '.']).trim_start_matches('.').to_owned()
}

/// Name with and without unit, with and without group, and the number from 1. A name that two channels have is none.
pub fn aliases(waveforms: &[Waveform], labels: &[Label]) -> Vec<Vec<String>> {
    let mut all: Vec<Vec<String>> = Vec::with_capacity(waveforms.len());
    for (k, (waveform, label)) in waveforms.iter().zip(labels).enumerate() {
        let mut names = vec![label.title.clone(), label.name.clone()];
        if !waveform.group.is_empty() {
            names.extend([&label.title, &label.name].map(|name| format!("{}/{name}", waveform.group)));
        }
        names.push((k + 1).to_string());
        names.sort();
        names.dedup();
        all.push(names);
    }
    let mut uses: BTreeMap<String, usize> = BTreeMap::new();
    for name in all.iter().flatten() {
        *uses.entry(name.to_lowercase()).or_default() += 1;
    }
    for names in &mut all {
        names.retain(|name| uses.get(&name.to_lowercase()) == Some(&1));
    }
    all
}

/// The waveform asked for: by its id, then by an alias, case aside.
pub fn find(wanted: &str, ids: &[String], aliases: &[Vec<String>]) -> Option<usize> {
    let wanted = wanted.trim();
    let same = |name: &String| name.to_lowercase() == wanted.to_lowercase();
    let exact = ids.iter().position(|id| id == wanted);
    exact.or_else(|| ids.iter().position(same)).or_else(|| aliases.iter().position(|names| names.iter().any(same)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::waveform::label::label;

    #[test]
    fn ids_are_unique_and_names_unambiguous() {
        let waveforms: Vec<Waveform> =
            [("A b", "acc (g)"), ("A b", "acc [m/s^2]"), ("C", "acc (g)"), ("", "Dev0/Ai0"), ("", "//")]
                .map(|(group, name)| Waveform::new(group, name))
                .into();
        let labels: Vec<Label> = waveforms.iter().map(|w| label(&w.name, "")).collect();
        let ids = ids(&waveforms, &labels);
        assert_eq!(ids, ["A_b.acc", "A_b.acc-2", "C.acc", "Dev0_Ai0", "channel_5"]);
        let aliases = aliases(&waveforms, &labels);
        let find = |wanted| find(wanted, &ids, &aliases);
        assert_eq!(find("a b/acc (g)"), Some(0));
        assert_eq!(find("acc [m/s^2]"), Some(1));
        assert_eq!(find("c/acc"), Some(2));
        assert_eq!(find("dev0/ai0"), Some(3));
        assert_eq!((find("acc"), find("acc (g)"), find("3")), (None, None, Some(2)));
    }
}
