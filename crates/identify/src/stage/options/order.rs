//! The order of a model as an option: a number of states, or `auto`.

use std::fmt;
use std::str::FromStr;

use crumple_sysid::Order;
use serde::{Deserialize, Serialize};

/// A number of states, or `auto`. In a pipeline file `4`, `"4"` or `"auto"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OrderOption(pub Order);

impl FromStr for OrderOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "auto" => Ok(Self(Order::Automatic)),
            number => match number.parse::<u16>() {
                Ok(n) if n > 0 => Ok(Self(Order::Given(n.into()))),
                _ => Err(format!("order {text:?} is neither a positive number of states nor \"auto\"")),
            },
        }
    }
}

impl fmt::Display for OrderOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Order::Given(n) => write!(f, "{n}"),
            Order::Automatic => f.write_str("auto"),
        }
    }
}

impl Serialize for OrderOption {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for OrderOption {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Number(i64),
            Text(String),
        }
        let text = match Written::deserialize(deserializer)? {
            Written::Number(n) => n.to_string(),
            Written::Text(text) => text,
        };
        text.parse().map_err(serde::de::Error::custom)
    }
}
