//! What DIAdem files say of a test: properties of the file, as laboratories name them.

use std::collections::BTreeMap;

use crate::recording::details::{Details, Stated};

/// Title, vehicle and facts by the names of properties, case aside. Speeds and masses in properties carry no unit and
/// are told as facts only.
pub fn details(properties: &BTreeMap<String, String>) -> Details {
    let find = |names: &[&str]| {
        names.iter().find_map(|wanted| {
            properties
                .iter()
                .find(|(name, value)| name.eq_ignore_ascii_case(wanted) && !value.trim().is_empty())
                .map(|(name, value)| Stated { value: value.trim().to_owned(), from: format!("property {name}") })
        })
    };
    let mut facts = Vec::new();
    for (name, value) in properties {
        let squeezed: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).take(40).collect();
        let is_fact = matches!(
            squeezed.as_str(),
            "testid"
                | "testdate"
                | "description"
                | "impactvelocity"
                | "impactspeed"
                | "testspeed"
                | "testmass"
                | "vehiclemass"
                | "occupantposition"
                | "dummytype"
                | "laboratory"
                | "author"
        );
        if is_fact && !value.trim().is_empty() {
            facts.push(format!("{name}: {}", value.trim()));
        }
    }
    Details {
        title: find(&["title", "Test_Title", "TestTitle"]),
        vehicle: find(&["Vehicle_Name", "VehicleName", "Vehicle"]),
        facts,
        ..Details::default()
    }
}
