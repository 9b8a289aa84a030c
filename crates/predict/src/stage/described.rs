//! What a person describes in one text on the command line, or in a table of the pipeline file.

use crumple_stage::Usage;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A text such as `barrier mass=1400kg pressure=342kPa`, or a table with the same keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Described {
    /// Words of the command line.
    Text(String),
    /// A table of the pipeline file.
    Table(toml::Table),
}

impl std::str::FromStr for Described {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self::Text(text.to_owned()))
    }
}

impl Described {
    /// The keys and values as the fields of `T`. Words without a sign of equality come first and are the value of
    /// `name`, blanks included: a folder may have some. Errors: keys that `T` does not have, values it refuses.
    pub fn read<T: DeserializeOwned>(&self, what: &str, name: &str) -> Result<T, Usage> {
        let table = match self {
            Self::Table(table) => table.clone(),
            Self::Text(text) => {
                let mut words = text.split(' ').peekable();
                let mut first = Vec::new();
                while let Some(word) = words.next_if(|word| !word.contains('=')) {
                    first.push(word);
                }
                let mut table = toml::Table::new();
                let named = first.join(" ").trim().to_owned();
                if !named.is_empty() {
                    table.insert(name.to_owned(), named.into());
                }
                for word in words.filter(|word| !word.is_empty()) {
                    let Some((key, value)) = word.split_once('=') else {
                        let problem = format!("{word:?} of the {what} is not key=value");
                        return Err(Usage::new(problem).hint("no blank between a number and its unit: mass=1400kg"));
                    };
                    table.insert(key.to_owned(), value.into());
                }
                table
            }
        };
        table.try_into().map_err(|error: toml::de::Error| {
            Usage::new(format!("the {what}: {}", error.to_string().trim().replace('\n', " ")))
        })
    }
}

#[cfg(test)]
mod tests {
    use crumple_signal::value::Mass;

    use super::*;

    #[derive(Debug, Default, PartialEq, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    struct Thing {
        name: Option<String>,
        mass: Option<Mass>,
    }

    #[test]
    fn a_text_is_its_name_and_its_keys() {
        let read = |text: &str| Described::Text(text.to_owned()).read::<Thing>("thing", "name");
        let barrier = Thing { name: Some("barrier".to_owned()), mass: Some(Mass::from_si(1400.0)) };
        assert_eq!(read("barrier mass=1400kg").unwrap(), barrier);
        assert_eq!(read("my runs/a").unwrap().name.as_deref(), Some("my runs/a"));
        assert!(read("barrier weight=1400kg").unwrap_err().to_string().contains("weight"));
        assert!(read("barrier mass=1400 kg").is_err());
        assert!(read("barrier mass=1400").unwrap_err().to_string().contains("has no unit"));
        let table = "name = 'barrier'\nmass = '1400 kg'".parse().unwrap();
        assert_eq!(Described::Table(table).read::<Thing>("thing", "name").unwrap(), barrier);
    }
}
