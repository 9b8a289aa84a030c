//! Provenance: how two results were made, reported beside the differences.

use std::collections::BTreeMap;

use crumple_artifact::Provenance;
use serde_json::{Value, json};

use crate::compare::json::compare_json;
use crate::differences::Difference;
use crate::{Base, CompareSettings, Tolerances};

/// Stage, version, options and inputs that differ.
pub(crate) fn compare_provenance(a: Option<&Provenance>, b: Option<&Provenance>) -> Vec<Difference> {
    let (Some(a), Some(b)) = (a, b) else {
        let name = |side: Option<&Provenance>| side.map(|p| json!(format!("{} {}", p.stage, p.stage_version)));
        let only = Difference { a: name(a), b: name(b), ..Difference::default() };
        return if a.is_none() && b.is_none() { Vec::new() } else { vec![only] };
    };
    let exact = CompareSettings {
        tolerances: Tolerances { base: Base::Exact, ..Tolerances::default() },
        ..CompareSettings::default()
    };
    let mut differences = compare_json("provenance", &to_json(a), &to_json(b), &exact).differences;
    for difference in &mut differences {
        // By how much an option differs says nothing.
        (difference.abs, difference.rel) = (None, None);
    }
    differences
}

fn to_json(provenance: &Provenance) -> Value {
    let config: Value =
        serde_json::from_str(&provenance.config_json).unwrap_or_else(|_| provenance.config_json.clone().into());
    // Several inputs of a kind are numbered, the digests being sorted already.
    let mut inputs: BTreeMap<String, Value> = BTreeMap::new();
    for input in &provenance.inputs {
        let count = (1..).find(|n| !inputs.contains_key(&input_name(&input.kind, *n))).unwrap_or(1);
        inputs.insert(input_name(&input.kind, count), json!(input.digest));
    }
    json!({
        "stage": provenance.stage,
        "stage_version": provenance.stage_version,
        "config": config,
        "input": inputs,
    })
}

fn input_name(kind: &str, count: u32) -> String {
    if count == 1 { kind.to_owned() } else { format!("{kind} {count}") }
}

#[cfg(test)]
mod tests {
    use crumple_artifact::InputDigest;

    use super::*;

    #[test]
    fn changed_options_versions_and_inputs_are_named() {
        let make = |version: &str, cfc: u16, digest: &str| {
            let input = InputDigest { kind: "ingest".into(), digest: digest.into() };
            Provenance::new("filter", version, format!(r#"{{"cfc":{cfc}}}"#), vec![input])
        };
        let (a, b) = (make("0.1.0", 60, "blake3:00"), make("0.2.0", 180, "blake3:11"));
        let places = |differences: Vec<Difference>| differences.into_iter().map(|d| d.place).collect::<Vec<_>>();
        assert_eq!(places(compare_provenance(Some(&a), Some(&b))), ["config.cfc", "input.ingest", "stage_version"]);
        assert!(compare_provenance(Some(&a), Some(&a)).is_empty());
        assert_eq!(places(compare_provenance(Some(&a), None)), [""]);
    }
}
