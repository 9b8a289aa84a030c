//! The stage's settings: its options with every default filled in.

use crumple_signal::value::Time;
use crumple_stage::Usage;
use crumple_sysid::Order;
use serde::Serialize;

use crate::stage::options::evidence::{self, BootstrapSettings, Stabilisation};
use crate::stage::options::flags::{Options, unknown};
use crate::stage::options::hankel::HankelSettings;
use crate::stage::options::input_output::InputOutputSettings;
use crate::stage::options::order::OrderOption;
use crate::stage::options::paper;

/// Methods by name.
const METHODS: [&str; 11] =
    ["era", "era-dc", "okid", "fir", "tfest", "exponentials", "n4sid", "moesp", "cva", "arx", "output-error"];

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
    /// What the methods other than `era` need; absent where `era` is alone.
    #[serde(rename = "beyond_era", skip_serializing_if = "Option::is_none")]
    pub input_output: Option<InputOutputSettings>,
    /// What methods through Markov parameters need beyond plain ERA; absent for the latter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hankel: Option<HankelSettings>,
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s, if not the end of the record.
    pub to_s: Option<f64>,
    /// Stabilisation diagram, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stabilisation: Option<Stabilisation>,
    /// Bootstrap, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bootstrap: Option<BootstrapSettings>,
    /// First time of the samples kept for validation, s, if any are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validate_from_s: Option<f64>,
    /// Paper whose procedure is followed, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper: Option<String>,
}

impl Settings {
    /// Whether arx has structures of its own instead of orders.
    pub fn has_arx_structures(&self) -> bool {
        self.input_output
            .as_ref()
            .is_some_and(|input_output| !input_output.arx_orders.is_empty() || input_output.arx_scan.is_some())
    }

    /// Fills in the defaults. Errors: an unknown method, an order of zero, an empty window.
    pub fn resolve(mut options: Options) -> Result<Self, Usage> {
        paper::follow(&mut options)?;
        for method in &options.methods {
            if !METHODS.contains(&method.as_str()) {
                return Err(unknown("identification method", method, &METHODS));
            }
        }
        let mut orders: Vec<OrderOption> = Vec::new();
        for &order in &options.orders {
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
        let validate_from_s = evidence::validate_from(&options, from_s, to_s)?;
        let bootstrap = evidence::bootstrap(&options)?;
        let stabilisation = evidence::stabilisation(&options)?;
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
        let input_output = if options.methods.iter().any(|m| m != "era" && m != "era-dc") {
            Some(InputOutputSettings::resolve(&options)?)
        } else {
            None
        };
        let hankel = HankelSettings::resolve(&options)?;
        Ok(Self {
            input_output,
            hankel,
            methods: if options.methods.is_empty() { vec!["era".to_owned()] } else { options.methods },
            orders: if orders.is_empty() { vec![OrderOption(Order::Given(4))] } else { orders },
            max_order: size(options.max_order).unwrap_or(20),
            rows: size(options.rows),
            columns: size(options.columns),
            samples: size(options.samples),
            channel: options.channel,
            from_s,
            to_s,
            stabilisation,
            bootstrap,
            validate_from_s,
            paper: options.paper,
        })
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
