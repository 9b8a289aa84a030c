//! Settings of the methods other than ERA.

use crumple_signal::value::{Acceleration, Speed};
use crumple_stage::Usage;
use crumple_sysid::Start;
use serde::Serialize;

use crate::stage::options::arx_structure::{ArxRanges, ArxStructure};
use crate::stage::options::flags::{Options, unknown};

/// Ways to starting points by name, default first to last.
const STARTS: [Start; 7] =
    [Start::Svf, Start::Gpmf, Start::Iv, Start::N4sid, Start::Integrators, Start::Exponentials, Start::Random];

/// Conditions of a sum of exponentials at the start of the window.
pub const CONDITIONS: [&str; 3] = ["position", "velocity", "acceleration"];

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
    /// Input between samples.
    pub hold: String,
    /// Motion at the start.
    pub initial: String,
    /// Whether poles are kept from growing.
    pub stable: bool,
    /// Ways to starting points.
    pub starts: Vec<String>,
    /// Iterations from each start, largest last, at least one.
    pub max_iterations: Vec<u32>,
    /// Samples by which the input acts late.
    pub delay: usize,
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
}

impl InputOutputSettings {
    /// The most iterations from a start.
    pub fn most_iterations(&self) -> u32 {
        self.max_iterations.last().copied().unwrap_or(0)
    }

    /// Fills in the defaults. Errors: unknown names, conditions out of order, waveforms named twice.
    pub fn resolve(options: &Options) -> Result<Self, Usage> {
        let choice = |name: &str, given: &Option<String>, choices: &[&str]| match given {
            None => Ok(choices[0].to_owned()),
            Some(text) if choices.contains(&text.as_str()) => Ok(text.clone()),
            Some(text) => Err(unknown(name, text, choices)),
        };
        let names = STARTS.map(Start::name);
        if let Some(start) = options.starts.iter().find(|start| !names.contains(&start.as_str())) {
            return Err(unknown("start", start, &names));
        }
        for (condition, expected) in options.conditions.iter().zip(CONDITIONS) {
            if !CONDITIONS.contains(&condition.as_str()) {
                return Err(unknown("condition", condition, &CONDITIONS));
            }
            if condition != expected {
                return Err(Usage::new(format!("condition {condition:?} stands before {expected:?}"))
                    .hint("each condition needs the ones before: position, then velocity, then acceleration"));
            }
        }
        for (name, given, needed) in [
            ("start_velocity", options.start_velocity.is_some(), 2),
            ("start_acceleration", options.start_acceleration.is_some(), 3),
        ] {
            if given && options.conditions.len() < needed {
                return Err(Usage::new(format!(
                    "{name} is given, but {} is not among conditions",
                    CONDITIONS[needed - 1]
                ))
                .hint(format!("give conditions = {}", CONDITIONS[..needed].join(","))));
            }
        }
        if options.conditions.len() > CONDITIONS.len() {
            return Err(Usage::new(format!("{} conditions, there are three", options.conditions.len())));
        }
        let size = |n: Option<u32>, default: usize| n.map_or(default, |n| n as usize);
        let starts: Vec<String> = if options.starts.is_empty() {
            names.iter().map(|name| (*name).to_owned()).collect()
        } else {
            options.starts.clone()
        };
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
            hold: choice("hold", &options.hold, &["first-order", "zero-order"])?,
            initial: choice("initial condition", &options.initial, &["estimate", "zero", "auto"])?,
            stable: options.stable.unwrap_or(false),
            starts,
            max_iterations,
            delay: size(options.delay, 0),
            terms: size(options.terms, 4),
            real: options.real.unwrap_or(false),
            conditions: options.conditions.len(),
            block_rows: options.block_rows.map(|n| n as usize),
            thin: options.thin.map(|n| n as usize),
            arx_orders: deduplicated(&options.arx_orders),
            arx_scan: options.arx_scan,
            start_velocity_m_per_s: options.start_velocity.map(Speed::si),
            start_acceleration_m_per_s2: options.start_acceleration.map(Acceleration::si),
            remove_mean: options.remove_mean.unwrap_or(false),
        })
    }

    /// The starts as the library knows them.
    pub fn start_kinds(&self) -> Vec<Start> {
        STARTS.into_iter().filter(|start| self.starts.iter().any(|name| name == start.name())).collect()
    }
}

/// Every structure once.
fn deduplicated(structures: &[ArxStructure]) -> Vec<ArxStructure> {
    let mut distinct: Vec<ArxStructure> = Vec::new();
    for structure in structures {
        if !distinct.contains(structure) {
            distinct.push(*structure);
        }
    }
    distinct
}

/// Waveforms named by the option of one or by that of several; each once.
pub fn waveforms(kind: &str, one: &Option<String>, several: &[String]) -> Result<Vec<String>, Usage> {
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
