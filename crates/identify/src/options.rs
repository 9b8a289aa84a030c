//! The stage's options, as flags and as keys of the pipeline file, and the settings they become.

use std::fmt;
use std::str::FromStr;

use crumple_signal::value::Time;
use crumple_stage::{Usage, nearest};
use serde::{Deserialize, Serialize};

use crumple_identify::Order;

/// Methods by name.
const METHODS: [&str; 1] = ["era"];

/// Flags of `crumple-identify`, keys of `[identify]`.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Identification methods, separated by commas. There is: era (eigensystem realization). Default: era.
    #[arg(long, value_delimiter = ',')]
    pub methods: Vec<String>,
    /// Numbers of states to try, separated by commas, and "auto" for the largest gap between singular values. Two
    /// states are one damped oscillation. Default: 4.
    #[arg(long, value_delimiter = ',')]
    pub orders: Vec<OrderOption>,
    /// Highest order that "auto" considers. Default: 20.
    #[arg(long)]
    pub max_order: Option<u32>,
    /// Rows of the Hankel matrix. Default: half of the record.
    #[arg(long)]
    pub rows: Option<u32>,
    /// Columns of the Hankel matrix. Default: half of the record.
    #[arg(long)]
    pub columns: Option<u32>,
    /// Number of samples to use, from the start of the window. Default: all.
    #[arg(long)]
    pub samples: Option<u32>,
    /// Channel to identify from. Default: the crash pulse.
    #[arg(long)]
    pub channel: Option<String>,
    /// Start of the window, e.g. 5ms. Default: time zero, 0 s.
    #[arg(long, allow_hyphen_values = true)]
    pub from: Option<Time>,
    /// End of the window, e.g. 120ms. Default: end of the record.
    #[arg(long, allow_hyphen_values = true)]
    pub to: Option<Time>,
}

/// Options with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Methods, each known.
    pub methods: Vec<String>,
    /// Orders in the order asked for, each once.
    pub orders: Vec<OrderOption>,
    /// Highest order that `auto` considers.
    pub max_order: usize,
    /// Rows of the Hankel matrix, if given.
    pub rows: Option<usize>,
    /// Columns, if given.
    pub columns: Option<usize>,
    /// Number of samples, if given.
    pub samples: Option<usize>,
    /// Channel, if not the pulse.
    pub channel: Option<String>,
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s, if not the end of the record.
    pub to_s: Option<f64>,
}

impl Settings {
    /// Fills in the defaults. Errors: an unknown method, an order of zero, an empty window.
    pub fn resolve(options: Options) -> Result<Self, Usage> {
        for method in &options.methods {
            if !METHODS.contains(&method.as_str()) {
                let hint = match nearest(method, METHODS) {
                    Some(near) => format!("did you mean {near:?}?"),
                    None => format!("there are: {}", METHODS.join(", ")),
                };
                return Err(Usage::new(format!("unknown identification method {method:?}")).hint(hint));
            }
        }
        let mut orders: Vec<OrderOption> = Vec::new();
        for order in options.orders {
            if !orders.contains(&order) {
                orders.push(order);
            }
        }
        let from_s = options.from.map_or(0.0, Time::si);
        let to_s = options.to.map(Time::si);
        if let Some(to_s) = to_s.filter(|to| *to <= from_s) {
            return Err(Usage::new(format!("the window from {from_s} s to {to_s} s is empty"))
                .hint("give --to a later time than --from"));
        }
        let sizes = [
            ("max_order", options.max_order),
            ("rows", options.rows),
            ("columns", options.columns),
            ("samples", options.samples),
        ];
        if let Some((name, _)) = sizes.iter().find(|(_, size)| *size == Some(0)) {
            return Err(Usage::new(format!("{name} is 0, a positive number is needed")));
        }
        let size = |n: Option<u32>| n.map(|n| n as usize);
        Ok(Self {
            methods: if options.methods.is_empty() { vec!["era".to_owned()] } else { options.methods },
            orders: if orders.is_empty() { vec![OrderOption(Order::Given(4))] } else { orders },
            max_order: size(options.max_order).unwrap_or(20),
            rows: size(options.rows),
            columns: size(options.columns),
            samples: size(options.samples),
            channel: options.channel,
            from_s,
            to_s,
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_era_of_order_four_from_time_zero() {
        let settings = Settings::resolve(Options::default()).unwrap();
        assert_eq!((settings.methods, settings.orders), (vec!["era".to_owned()], vec![OrderOption(Order::Given(4))]));
        assert_eq!((settings.from_s, settings.to_s, settings.max_order), (0.0, None, 20));
    }

    #[test]
    fn orders_are_read_as_numbers_and_words() {
        let options: Options = serde_json::from_str(r#"{"orders": [2, "4", "auto", 2]}"#).unwrap();
        let orders: Vec<String> =
            Settings::resolve(options).unwrap().orders.iter().map(OrderOption::to_string).collect();
        assert_eq!(orders, ["2", "4", "auto"]);
        let error = serde_json::from_str::<Options>(r#"{"orders": [-2]}"#).unwrap_err().to_string();
        assert!(error.contains("order \"-2\" is neither"), "{error}");
    }

    #[test]
    fn unknown_method_and_empty_window_are_usage_errors() {
        let method = Options { methods: vec!["ERAA".to_owned()], ..Options::default() };
        let error = format!("{:?}", Settings::resolve(method).unwrap_err());
        assert!(error.contains("did you mean \\\"era\\\""), "{error}");
        let window = Options { from: Some(Time::from_si(0.1)), to: Some(Time::from_si(0.1)), ..Options::default() };
        assert_eq!(Settings::resolve(window).unwrap_err().to_string(), "the window from 0.1 s to 0.1 s is empty");
        let size = Options { rows: Some(0), ..Options::default() };
        assert_eq!(Settings::resolve(size).unwrap_err().to_string(), "rows is 0, a positive number is needed");
    }
}
