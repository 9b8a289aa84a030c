//! Orders of models as options: numbers of states, and numbers of past outputs and inputs and delays of ARX models.

use std::fmt;
use std::str::FromStr;

use crumple_stage::records::ScanEdgeV1;
use crumple_sysid::{ArxOrder, Order};
use serde::{Deserialize, Serialize};

/// Numbers of states: one, `auto`, or a range, `1:10`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrdersOption {
    /// One order.
    One(OrderOption),
    /// All from the first to the last.
    Range(usize, usize),
}

/// Orders of a range, at most.
const MOST_ORDERS: usize = 200;

impl FromStr for OrdersOption {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((first, last)) = text.split_once(':') else { return text.parse().map(Self::One) };
        let number = |text: &str| text.trim().parse::<u16>().ok().map(usize::from);
        match (number(first), number(last)) {
            (Some(first), Some(last)) if first > 0 && first <= last && last - first < MOST_ORDERS => {
                Ok(Self::Range(first, last))
            }
            _ => Err(format!("orders {text:?} are no range of numbers of states, as in 1:10")),
        }
    }
}

impl OrdersOption {
    /// The orders, one by one.
    pub fn all(self) -> Vec<OrderOption> {
        match self {
            Self::One(order) => vec![order],
            Self::Range(first, last) => (first..=last).map(|n| OrderOption(Order::Given(n))).collect(),
        }
    }
}

impl fmt::Display for OrdersOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(order) => write!(f, "{order}"),
            Self::Range(first, last) => write!(f, "{first}:{last}"),
        }
    }
}

impl Serialize for OrdersOption {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

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

impl<'de> Deserialize<'de> for OrdersOption {
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

/// Past outputs, inputs and delay, `2,2,3`. In a pipeline file `"2,2,3"` or `[2, 2, 3]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArxStructure(pub ArxOrder);

/// What is scanned: of each number the least and the most, `1-4,1-4,0-6`; a single number stays what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArxRanges {
    /// Past outputs.
    pub na: (usize, usize),
    /// Inputs.
    pub nb: (usize, usize),
    /// Delays.
    pub nk: (usize, usize),
}

/// Models of a scan at most.
const MOST_MODELS: usize = 10_000;

/// Three numbers between commas.
fn split_three(text: &str) -> Option<[&str; 3]> {
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    <[&str; 3]>::try_from(parts).ok()
}

impl FromStr for ArxStructure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = split_three(text).map(|parts| parts.map(|part| part.parse::<u16>().map(usize::from)));
        match numbers {
            Some([Ok(na), Ok(nb), Ok(nk)]) if na + nb > 0 => Ok(Self(ArxOrder { na, nb, nk })),
            _ => Err(format!(
                "{text:?} are not the numbers of past outputs, inputs and delays of an arx model, as in 2,2,3"
            )),
        }
    }
}

impl FromStr for ArxRanges {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range = |part: &str| -> Option<(usize, usize)> {
            let (low, high) = part.split_once('-').unwrap_or((part, part));
            let number = |text: &str| text.trim().parse::<u16>().ok().map(usize::from);
            let (low, high) = (number(low)?, number(high)?);
            (low <= high).then_some((low, high))
        };
        let bad = || format!("{text:?} are not three ranges of past outputs, inputs and delays, as in 1-4,1-4,0-6");
        let [na, nb, nk] = split_three(text).ok_or_else(bad)?;
        let (Some(na), Some(nb), Some(nk)) = (range(na), range(nb), range(nk)) else { return Err(bad()) };
        let ranges = Self { na, nb, nk };
        let count = [na, nb, nk].iter().map(|(low, high)| high - low + 1).product::<usize>();
        if count > MOST_MODELS {
            return Err(format!("{text:?} are {count} models, {MOST_MODELS} at most are scanned"));
        }
        if ranges.all().is_empty() {
            return Err(bad());
        }
        Ok(ranges)
    }
}

impl ArxRanges {
    /// Every structure of the ranges, the smallest first.
    pub fn all(&self) -> Vec<ArxOrder> {
        let over = |(low, high): (usize, usize)| low..=high;
        over(self.na)
            .flat_map(|na| over(self.nb).flat_map(move |nb| over(self.nk).map(move |nk| ArxOrder { na, nb, nk })))
            .filter(|order| order.na + order.nb > 0)
            .collect()
    }
}

impl ArxRanges {
    /// Which numbers of a structure stand at the end of a range of more than one, and could go beyond.
    pub fn edges(&self, order: &ArxOrder) -> Vec<ScanEdgeV1> {
        let at_edge =
            |(low, high): (usize, usize), n: usize, least: usize| low < high && (n == high || (n == low && n > least));
        let Self { na, nb, nk } = *self;
        let all = [
            (ScanEdgeV1::PastOutputs, at_edge(na, order.na, 0)),
            (ScanEdgeV1::Inputs, at_edge(nb, order.nb, 1)),
            (ScanEdgeV1::Delay, at_edge(nk, order.nk, 0)),
        ];
        all.into_iter().filter_map(|(edge, is_there)| is_there.then_some(edge)).collect()
    }
}

impl fmt::Display for ArxStructure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{}", self.0.na, self.0.nb, self.0.nk)
    }
}

impl fmt::Display for ArxRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { na, nb, nk } = self;
        write!(f, "{}-{},{}-{},{}-{}", na.0, na.1, nb.0, nb.1, nk.0, nk.1)
    }
}

impl Serialize for ArxStructure {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl Serialize for ArxRanges {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ArxStructure {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Numbers(Vec<i64>),
            Text(String),
        }
        let text = match Written::deserialize(deserializer)? {
            Written::Numbers(numbers) => numbers.iter().map(i64::to_string).collect::<Vec<_>>().join(","),
            Written::Text(text) => text,
        };
        text.parse().map_err(serde::de::Error::custom)
    }
}

impl<'de> Deserialize<'de> for ArxRanges {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_and_ranges_are_read_or_refused() {
        let structure: ArxStructure = serde_json::from_str("[2, 2, 3]").unwrap();
        assert_eq!((structure, structure.to_string()), ("2, 2,3".parse().unwrap(), "2,2,3".to_owned()));
        for wrong in ["2,2", "0,0,1", "2,2,x", "2,2,-1", "1,2,3,4"] {
            assert!(wrong.parse::<ArxStructure>().is_err(), "{wrong}");
        }
        let ranges: ArxRanges = "1-2,2,0-3".parse().unwrap();
        assert_eq!((ranges.all().len(), ranges.to_string()), (8, "1-2,2-2,0-3".to_owned()));
        for wrong in ["2-1,1,0", "1-2,1", "0,0,0-4", "1-100,1-100,0-100", "a-b,1,0"] {
            assert!(wrong.parse::<ArxRanges>().is_err(), "{wrong}");
        }
    }
}
