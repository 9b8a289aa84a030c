//! The stage's settings: its options with every default filled in, as they stand in the provenance.

use clap::ValueEnum;
use crumple_signal::value::{Acceleration, Speed, Time};
use crumple_stage::Usage;
use crumple_sysid::{Order, Start};
use serde::Serialize;

use crate::stage::options::choices::{
    Condition, Delay, FreeDecay, HankelSize, Hold, Initial, LagCriterion, Method, Paper, StartName, ValidateFrom,
};
use crate::stage::options::flags::Options;
use crate::stage::options::orders::{ArxRanges, ArxStructure, OrderOption, OrdersOption};
use crate::stage::options::paper;
use crate::stage::waves::flag;

/// Highest order that subspace methods consider by themselves where several outputs are named: their modes are many.
const HIGHEST_OF_SEVERAL: u32 = 40;

/// Options with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Methods, each known.
    pub methods: Vec<Method>,
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
    /// What the methods other than `era` need, and what is taken off the waveforms; absent where `era` is alone and
    /// nothing is.
    #[serde(rename = "beyond_era", skip_serializing_if = "Option::is_none")]
    pub input_output: Option<InputOutputSettings>,
    /// What methods through Markov parameters need beyond plain ERA; absent for the latter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hankel: Option<HankelSettings>,
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s, if not the end of the record.
    pub to_s: Option<f64>,
    /// Decay rate of the exponential window on the record, 1/s, if there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_per_s: Option<f64>,
    /// Stabilisation diagram, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stabilisation: Option<Stabilisation>,
    /// Bootstrap, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bootstrap: Option<BootstrapSettings>,
    /// First time of the samples kept for validation, s, if any are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validate_from_s: Option<f64>,
    /// Or the share of the samples in use before them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validate_from_share: Option<f64>,
    /// Paper whose procedure is followed, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper: Option<Paper>,
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
        let auto = automatic(&mut options);
        let orders: Vec<OrderOption> = options.orders.iter().flat_map(|orders| orders.all()).collect();
        let orders = once(&orders);
        let from_s = options.from.map_or(0.0, Time::si);
        let to_s = options.to.map(Time::si);
        if let Some(to_s) = to_s.filter(|to| *to <= from_s) {
            return Err(Usage::new(format!("the window from {from_s} s to {to_s} s is empty")).hint(format!(
                "give {} a later time than {}",
                flag("to"),
                flag("from")
            )));
        }
        let (validate_from_s, validate_from_share) = validate_from(&options, from_s, to_s)?;
        let bootstrap = BootstrapSettings::resolve(&options)?;
        let stabilisation = stabilisation(&options)?;
        let sizes = [
            ("max_order", options.max_order),
            ("rows", options.rows),
            ("columns", options.columns),
            ("samples", options.samples),
        ];
        if let Some((name, _)) = sizes.iter().find(|(_, size)| *size == Some(0)) {
            return Err(Usage::new(format!("{name} is 0, a positive number is needed")));
        }
        if options.allow_unstable == Some(true) && !options.methods.iter().any(|method| method.predicts()) {
            return Err(Usage::new("allow_unstable is given, but no method that predicts one step ahead")
                .hint(format!("add arx or okid to {}", flag("methods"))));
        }
        let size = |n: Option<u32>| n.map(|n| n as usize);
        let window_per_s = options.window_time_constant.map(|constant| constant.si().recip());
        if window_per_s.is_some_and(|rate| !(rate > 0.0 && rate.is_finite())) {
            return Err(Usage::new("window_time_constant is not a positive time")
                .hint("give the τ of exp(-t/τ) as the analyser states it, e.g. 120ms"));
        }
        // What is taken off the waveforms is, whatever the method.
        let removes = options.remove_mean == Some(true) || options.remove_trend == Some(true);
        let with_input = removes || options.methods.iter().any(|method| !method.is_of_free_motion());
        let input_output = with_input.then(|| InputOutputSettings::resolve(&options, auto)).transpose()?;
        let hankel = HankelSettings::resolve(&options)?;
        Ok(Self {
            input_output,
            hankel,
            methods: if options.methods.is_empty() { vec![Method::Era] } else { options.methods },
            orders: if orders.is_empty() { vec![OrderOption(Order::Given(4))] } else { orders },
            max_order: size(options.max_order).unwrap_or(20),
            rows: size(options.rows),
            columns: size(options.columns),
            samples: size(options.samples),
            channel: options.channel,
            from_s,
            to_s,
            window_per_s,
            stabilisation,
            bootstrap,
            validate_from_s,
            validate_from_share,
            paper: options.paper,
        })
    }
}

/// What `okid` needs, and what is unusual about `era`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HankelSettings {
    /// Waveforms that `era` takes together; empty: the one of `--channel`, else the pulse.
    pub channels: Vec<String>,
    /// Whether the Hankel matrix has twice as many rows and columns as the model states.
    pub twice_the_order: bool,
    /// Lags of the observer, if given.
    pub lags: Option<usize>,
    /// Criterion for their number otherwise.
    pub lag_criterion: LagCriterion,
    /// Share of the peak below which the contact force has ended; 0: from the time of separation on.
    pub free_decay_share: Option<f64>,
}

impl HankelSettings {
    /// `None` for plain ERA of one channel, which has no need of it. Errors: counts of zero, channels named twice.
    fn resolve(options: &Options) -> Result<Option<Self>, Usage> {
        if options.lags == Some(0) {
            return Err(Usage::new("lags is a count of samples: a positive number is needed"));
        }
        let channels = channels(options)?;
        let asked = !channels.is_empty() || options.hankel_size.is_some() || options.free_decay.is_some();
        if !asked && !options.methods.contains(&Method::Okid) {
            return Ok(None);
        }
        Ok(Some(Self {
            channels,
            twice_the_order: options.hankel_size == Some(HankelSize::TwiceOrder),
            lags: options.lags.map(|n| n as usize),
            lag_criterion: options.lag_criterion.unwrap_or_default(),
            free_decay_share: options.free_decay.map(FreeDecay::share),
        }))
    }
}

/// What ERA takes together: the channels, or the outputs where neither they nor one channel are named.
fn channels(options: &Options) -> Result<Vec<String>, Usage> {
    let named = &options.channels;
    if let Some(twice) = named.iter().enumerate().find(|(i, c)| named[..*i].contains(c)) {
        return Err(Usage::new(format!("channel {} is named twice", twice.1)));
    }
    if !named.is_empty() && options.channel.is_some() {
        return Err(Usage::new("channel and channels are both given")
            .hint(format!("name all of them with {}", flag("channels"))));
    }
    let free = options.methods.is_empty() || options.methods.iter().any(|method| method.is_of_free_motion());
    // The paper's procedure is one of the pulse, whatever its curve fit takes.
    let pulse = options.channel.is_some() || options.paper == Some(Paper::Era);
    if free && named.is_empty() && !pulse {
        return waveforms("output", &options.output_channel, &options.output_channels);
    }
    Ok(named.clone())
}

/// Settings of the methods other than `era`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputOutputSettings {
    /// Driving waveforms; empty: the pulse. One alone named `none`: no input.
    pub inputs: Vec<String>,
    /// Answering waveforms; empty: the pulse's displacement.
    pub outputs: Vec<String>,
    /// Poles of a transfer function.
    pub poles: usize,
    /// Zeros.
    pub zeros: usize,
    /// Input between samples; where it is not asked for, steps of inputs that stand still between jumps.
    pub hold: Hold,
    /// Whether it is asked for.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub hold_is_given: bool,
    /// Motion at the start.
    pub initial: Initial,
    /// Whether poles are kept from growing.
    pub stable: bool,
    /// Whether a model that grows is written without a simulation.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub allow_unstable: bool,
    /// Ways to starting points.
    pub starts: Vec<StartName>,
    /// Iterations from each start, largest last, at least one.
    pub max_iterations: Vec<u32>,
    /// Samples by which the input acts late.
    pub delay: usize,
    /// The range that the delay is chosen from, where it is left to the record.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delays: Option<(usize, usize)>,
    /// Exponential terms.
    pub terms: usize,
    /// Real exponents only.
    pub real: bool,
    /// Conditions at the start, in the order position, velocity, acceleration.
    pub conditions: usize,
    /// Block rows, if given.
    pub block_rows: Option<usize>,
    /// Thinning of the subspace methods, if given.
    pub thin: Option<usize>,
    /// Structures of arx, if given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub arx_orders: Vec<ArxStructure>,
    /// Structures that arx scans, if it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arx_scan: Option<ArxRanges>,
    /// Velocity that a sum of exponentials has at the start, m/s, if not that of the record.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_velocity_m_per_s: Option<f64>,
    /// Acceleration there, m/s², if not zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub start_acceleration_m_per_s2: Option<f64>,
    /// Whether the mean is removed from inputs and outputs.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub remove_mean: bool,
    /// Whether it is where the record is no crash.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub remove_mean_unless_crash: bool,
    /// Whether a straight line is removed from inputs and outputs.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub remove_trend: bool,
    /// Frequencies of machines that run, rad/s, as the record shows them; not asked for.
    #[serde(skip)]
    pub harmonics_rad_per_s: Vec<f64>,
}

impl InputOutputSettings {
    /// The most iterations from a start.
    pub fn most_iterations(&self) -> u32 {
        self.max_iterations.last().copied().unwrap_or(0)
    }

    /// Fills in the defaults. Errors: conditions out of order, waveforms named twice.
    fn resolve(options: &Options, auto: bool) -> Result<Self, Usage> {
        let all = Condition::value_variants();
        for (condition, expected) in options.conditions.iter().zip(all) {
            if condition != expected {
                let text = format!("condition \"{condition}\" stands before \"{expected}\"");
                return Err(Usage::new(text)
                    .hint("each condition needs the ones before: position, then velocity, then acceleration"));
            }
        }
        for (name, given, needed) in [
            ("start_velocity", options.start_velocity.is_some(), 2),
            ("start_acceleration", options.start_acceleration.is_some(), 3),
        ] {
            if given && options.conditions.len() < needed {
                let names: Vec<String> = all[..needed].iter().map(Condition::to_string).collect();
                let text = format!("{name} is given, but {} is not among conditions", all[needed - 1]);
                return Err(Usage::new(text).hint(format!("give conditions = {}", names.join(","))));
            }
        }
        if options.conditions.len() > all.len() {
            return Err(Usage::new(format!("{} conditions, there are three", options.conditions.len())));
        }
        let size = |n: Option<u32>, default: usize| n.map_or(default, |n| n as usize);
        let starts = if options.starts.is_empty() { StartName::value_variants() } else { &options.starts };
        let mut max_iterations = options.max_iterations.clone();
        if max_iterations.is_empty() {
            max_iterations.push(200);
        }
        max_iterations.sort_unstable();
        max_iterations.dedup();
        if options.thin == Some(0) {
            return Err(Usage::new("thin is 0, a positive number is needed"));
        }
        Ok(Self {
            inputs: waveforms("input", &options.input_channel, &options.input_channels)?,
            outputs: waveforms("output", &options.output_channel, &options.output_channels)?,
            poles: size(options.poles, 4),
            zeros: size(options.zeros, 1),
            hold: options.hold.unwrap_or_default(),
            hold_is_given: options.hold.is_some(),
            initial: options.initial.unwrap_or_default(),
            stable: options.stable.unwrap_or(false),
            allow_unstable: options.allow_unstable.unwrap_or(false),
            starts: starts.to_vec(),
            max_iterations,
            delay: if let Some(Delay::Given(samples)) = options.delay { samples as usize } else { 0 },
            delays: match options.delay {
                Some(Delay::Auto(first, last)) => Some((first as usize, last as usize)),
                _ => None,
            },
            terms: size(options.terms, 4),
            real: options.real.unwrap_or(false),
            conditions: options.conditions.len(),
            block_rows: options.block_rows.map(|n| n as usize),
            thin: options.thin.map(|n| n as usize),
            arx_orders: once(&options.arx_orders),
            arx_scan: options.arx_scan,
            start_velocity_m_per_s: options.start_velocity.map(Speed::si),
            start_acceleration_m_per_s2: options.start_acceleration.map(Acceleration::si),
            remove_mean: options.remove_mean.unwrap_or(false),
            remove_mean_unless_crash: auto && options.remove_mean.is_none(),
            remove_trend: options.remove_trend.unwrap_or(false),
            harmonics_rad_per_s: Vec::new(),
        })
    }

    /// The starts as the library knows them, in its order.
    pub fn start_kinds(&self) -> Vec<Start> {
        StartName::value_variants().iter().filter(|start| self.starts.contains(start)).map(|s| (*s).into()).collect()
    }
}

/// Each once.
fn once<T: Copy + PartialEq>(named: &[T]) -> Vec<T> {
    named.iter().enumerate().filter(|(k, one)| !named[..*k].contains(one)).map(|(_, one)| *one).collect()
}

/// Waveforms named by the option of one or by that of several; each once.
fn waveforms(kind: &str, one: &Option<String>, several: &[String]) -> Result<Vec<String>, Usage> {
    if one.is_some() && !several.is_empty() {
        return Err(
            Usage::new(format!("{kind}_channel and {kind}_channels both name waveforms")).hint("keep one of them")
        );
    }
    let mut names: Vec<String> = Vec::new();
    for name in several.iter().chain(one) {
        if names.contains(name) {
            return Err(Usage::new(format!("{kind} {name:?} is named twice")));
        }
        names.push(name.clone());
    }
    if names.len() > 1 && names.iter().any(|name| name == "none") {
        return Err(Usage::new(format!("\"none\" stands beside other {kind}s")));
    }
    Ok(names)
}

/// Settings of the stabilisation diagram.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stabilisation {
    /// Largest damping ratio that counts.
    pub highest_damping: f64,
}

/// Settings of the bootstrap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BootstrapSettings {
    /// Fits.
    pub replicates: usize,
    /// Seed.
    pub seed: u32,
}

impl BootstrapSettings {
    /// The bootstrap, if asked for. Errors: a single replicate.
    fn resolve(options: &Options) -> Result<Option<Self>, Usage> {
        if options.bootstrap == Some(1) {
            return Err(Usage::new("one bootstrap fit has no spread").hint("200 are usual, 0 for none"));
        }
        Ok(options
            .bootstrap
            .filter(|count| *count > 0)
            .map(|replicates| Self { replicates: replicates as usize, seed: options.bootstrap_seed.unwrap_or(1) }))
    }
}

/// The diagram, if asked for. Errors: a damping ratio that is none.
fn stabilisation(options: &Options) -> Result<Option<Stabilisation>, Usage> {
    let highest_damping = options.highest_damping.unwrap_or(2.0);
    if !(highest_damping > 0.0 && highest_damping.is_finite()) {
        return Err(Usage::new(format!("highest damping ratio {highest_damping}, a positive number is needed")));
    }
    Ok(options.stabilisation.unwrap_or(false).then_some(Stabilisation { highest_damping }))
}

/// The methods, orders and highest order that `auto` stands for, put in its place; whether it was there.
fn automatic(options: &mut Options) -> bool {
    if !options.methods.contains(&Method::Auto) {
        return false;
    }
    let subspace = [Method::N4sid, Method::Moesp, Method::Cva];
    let several = options.output_channels.len() > 1;
    let free = options.input_channels == ["none"] || options.input_channel.as_deref() == Some("none");
    let of_one_output = [Method::Arx, Method::Okid, Method::OutputError];
    let others = if several || free { &[][..] } else { &of_one_output };
    let named: Vec<Method> = options.methods.iter().copied().filter(|method| *method != Method::Auto).collect();
    options.methods = once(&[&subspace[..], others, &named].concat());
    if options.orders.is_empty() {
        options.orders.push(OrdersOption::One(OrderOption(Order::Automatic)));
    }
    options.max_order = options.max_order.or(several.then_some(HIGHEST_OF_SEVERAL));
    true
}

/// First time, or share before, of the samples kept for validation. Errors: nothing before it, or nothing after.
fn validate_from(options: &Options, from_s: f64, to_s: Option<f64>) -> Result<(Option<f64>, Option<f64>), Usage> {
    let validate_from_s = match options.validate_from {
        Some(ValidateFrom::Share(share)) => return Ok((None, Some(share))),
        Some(ValidateFrom::Time(time_s)) => Some(time_s),
        None => None,
    };
    match validate_from_s.filter(|v| *v <= from_s || to_s.is_some_and(|to| *v >= to)) {
        Some(from) => Err(Usage::new(format!("validation from {from} s leaves nothing before it, or nothing after"))
            .hint(format!("give {} a time between {} and {}", flag("validate-from"), flag("from"), flag("to")))),
        None => Ok((validate_from_s, None)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_era_of_order_four_from_time_zero() {
        let settings = Settings::resolve(Options::default()).unwrap();
        assert_eq!((settings.methods, settings.orders), (vec![Method::Era], vec![OrderOption(Order::Given(4))]));
        assert_eq!((settings.from_s, settings.to_s, settings.max_order), (0.0, None, 20));
    }

    #[test]
    fn orders_are_read_as_numbers_and_words() {
        let options: Options = serde_json::from_str(r#"{"orders": [2, "4", "auto", "1:3"]}"#).unwrap();
        let orders: Vec<String> =
            Settings::resolve(options).unwrap().orders.iter().map(OrderOption::to_string).collect();
        assert_eq!(orders, ["2", "4", "auto", "1", "3"]);
        assert!(
            serde_json::from_str::<Options>(r#"{"orders": ["3:1"]}"#).unwrap_err().to_string().contains("no range")
        );
        let error = serde_json::from_str::<Options>(r#"{"orders": [-2]}"#).unwrap_err().to_string();
        assert!(error.contains("order \"-2\" is neither"), "{error}");
    }

    #[test]
    fn auto_stands_for_methods_and_their_orders() {
        let auto = |several: &[&str], free: bool| {
            let output_channels = several.iter().map(|name| (*name).to_owned()).collect();
            let input_channels = if free { vec!["none".to_owned()] } else { Vec::new() };
            let methods = vec![Method::Auto];
            Settings::resolve(Options { methods, output_channels, input_channels, ..Options::default() }).unwrap()
        };
        let one = auto(&["y"], false);
        assert_eq!((one.methods.len(), one.max_order, one.orders[0].to_string()), (6, 20, "auto".to_owned()));
        assert!(one.hankel.is_some() && one.input_output.unwrap().remove_mean_unless_crash);
        let several = auto(&["y", "z"], false);
        assert_eq!((several.methods.len(), several.max_order), (3, 40));
        assert_eq!(auto(&["y"], true).methods, [Method::N4sid, Method::Moesp, Method::Cva]);
    }

    #[test]
    fn an_unknown_method_and_an_empty_window_are_refused() {
        let error = serde_json::from_str::<Options>(r#"{"methods": ["ERAA"]}"#).unwrap_err().to_string();
        assert!(error.contains("unknown variant `ERAA`, expected one of `era`, `okid`"), "{error}");
        let window = Options { from: Some(Time::from_si(0.1)), to: Some(Time::from_si(0.1)), ..Options::default() };
        assert_eq!(Settings::resolve(window).unwrap_err().to_string(), "the window from 0.1 s to 0.1 s is empty");
        let size = Options { rows: Some(0), ..Options::default() };
        assert_eq!(Settings::resolve(size).unwrap_err().to_string(), "rows is 0, a positive number is needed");
    }

    #[test]
    fn plain_era_has_no_need_of_hankel_settings_and_a_channel_is_named_once() {
        assert_eq!(HankelSettings::resolve(&Options::default()).unwrap(), None);
        let options = Options { free_decay: Some(FreeDecay::Share(0.05)), ..Options::default() };
        assert_eq!(HankelSettings::resolve(&options).unwrap().unwrap().free_decay_share, Some(0.05));
        let options = Options { channels: vec!["a".to_owned(), "a".to_owned()], ..Options::default() };
        assert_eq!(HankelSettings::resolve(&options).unwrap_err().to_string(), "channel a is named twice");
    }
}
