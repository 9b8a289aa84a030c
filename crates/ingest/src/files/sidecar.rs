//! The sidecar: `crash.csv.toml` beside `crash.csv`, with the keys of the flags.

use crate::formats::reader::Bundle;
use crate::{IngestError, IngestSettings, Place};

/// Reads a sidecar. An unknown key is refused; a value has its unit in it.
pub fn parse(file: &str, bytes: &[u8]) -> Result<IngestSettings, IngestError> {
    const EXPECTED: &str = "lines such as mass = \"873 kg\"";
    let refuse = |found: String, hint: &str| IngestError::content(Place::file(file), found, EXPECTED, hint);
    let text = std::str::from_utf8(bytes)
        .map_err(|_| refuse("the text is not UTF-8".to_owned(), "save the sidecar as UTF-8"))?;
    let table: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| refuse(one_line(&error.to_string()), "put text values in quotes"))?;
    for key in table.keys() {
        if !IngestSettings::KEYS.contains(&key.as_str()) {
            return Err(IngestError::UnknownKey {
                file: file.to_owned(),
                key: key.clone(),
                expected: EXPECTED.to_owned(),
                hint: format!("the keys are: {}", IngestSettings::KEYS.join(", ")),
            });
        }
    }
    table
        .try_into()
        .map_err(|error: toml::de::Error| refuse(one_line(error.message()), "write the value with its unit, in quotes"))
}

/// What the sidecar of a record states; nothing where there is none.
pub fn settings(bundle: &Bundle) -> Result<IngestSettings, IngestError> {
    bundle
        .sidecar
        .as_ref()
        .map_or_else(|| Ok(IngestSettings::default()), |sidecar| parse(&sidecar.name, &sidecar.bytes))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_values_with_units() {
        let settings = parse("a.toml", b"mass = \"873 kg\"\nimpact_speed = \"36 km/h\"\nsign = \"flip\"\n").unwrap();
        assert_eq!(settings.mass.unwrap().si(), 873.0);
        assert_eq!(settings.impact_speed.unwrap().si(), 10.0);
        assert_eq!(settings.sign, Some(crate::Sign::Flip));
    }

    #[test]
    fn an_unknown_key_is_refused() {
        let error = parse("a.toml", b"impact-sped = \"36 km/h\"\n").unwrap_err();
        assert_eq!(error.to_string(), "a.toml: unknown key \"impact-sped\"");
        assert!(error.hint().starts_with("the keys are: mass, impact_speed, "), "{}", error.hint());
    }

    #[test]
    fn asks_back_for_a_unit() {
        let error = parse("a.toml", b"mass = 873\n").unwrap_err();
        assert!(error.to_string().contains("\"873\" has no unit"), "{error}");
    }

    #[test]
    fn every_key_is_a_field() {
        // A key in the list that is no field would pass the spelling check and fail later with another message.
        for key in IngestSettings::KEYS {
            let value = match key {
                "mass" => "\"1 kg\"",
                "impact_speed" => "\"1 m/s\"",
                "time_zero" => "\"1 s\"",
                "sign" => "\"keep\"",
                "sample_time" => "\"1 s\"",
                "resample" => "\"100 Hz\"",
                "profile" => "\"edr\"",
                "vehicle_number" => "1",
                "allow_missing" => "true",
                _ => "\"x\"",
            };
            parse("a.toml", format!("{key} = {value}").as_bytes()).unwrap();
        }
    }
}
