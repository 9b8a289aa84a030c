//! The stage's options, as flags and as keys of the pipeline file.

use crumple_signal::value::{Acceleration, Speed, Time};
use serde::{Deserialize, Serialize};

use crate::stage::options::choices::{
    Condition, Delay, FreeDecay, HankelSize, Hold, Initial, LagCriterion, Method, Paper, StartName, ValidateFrom,
};
use crate::stage::options::orders::{ArxRanges, ArxStructure, OrdersOption};

/// Flags of `crumple-identify`, keys of `[identify]`.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[allow(rustdoc::invalid_html_tags, reason = "comments of fields are the help texts of their flags")]
pub struct Options {
    /// Identification methods, separated by commas. From free motion: era (eigensystem realization), exponentials. From
    /// an input and an output: tfest (continuous transfer function), output-error (the same, sampled), okid (observer,
    /// then era), n4sid, moesp, cva, arx. "auto": n4sid, moesp, cva, arx, okid and output-error, and the one to use
    /// among them; of several outputs, or without an input, n4sid, moesp and cva. Default: era.
    #[arg(long, value_delimiter = ',', hide_possible_values = true)]
    pub methods: Vec<Method>,
    /// Numbers of states to try, separated by commas, ranges as 1:10, and "auto": by the largest gap between singular
    /// values (era), by the BIC of the simulation (n4sid, moesp, cva). Two states are one damped oscillation. Default:
    /// 4, "auto" with --methods auto.
    #[arg(long, value_delimiter = ',')]
    pub orders: Vec<OrdersOption>,
    /// Highest order that "auto" considers. Default: 20; 40 of several outputs with --methods auto.
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
    /// Waveform to identify from, of any quantity. Default: the crash pulse.
    #[arg(long)]
    pub channel: Option<String>,
    /// Waveforms whose free motion is identified together by era, separated by commas: one model with a shape of every
    /// mode. Default: those of --outputs, else one channel.
    #[arg(long, value_delimiter = ',')]
    pub channels: Vec<String>,
    /// Start where the contact force has ended: "separation" (the time of the rebound velocity) or a share of the peak
    /// of the crash pulse that it stays under from then on, e.g. 5%. Default: the start of the window.
    #[arg(long)]
    pub free_decay: Option<FreeDecay>,
    /// Size of the Hankel matrix of era: half (of the record) or twice-order (rows and columns). Default: half.
    #[arg(long, hide_possible_values = true)]
    pub hankel_size: Option<HankelSize>,
    /// Past samples that the observer of okid sees. Default: chosen by --lag-criterion.
    #[arg(long)]
    pub lags: Option<u32>,
    /// Criterion for the number of lags: aicc or bic. Default: aicc.
    #[arg(long, hide_possible_values = true)]
    pub lag_criterion: Option<LagCriterion>,
    /// Waveform that drives the system, for methods with an input: --inputs of a single one.
    #[arg(long, conflicts_with = "input_channels")]
    pub input_channel: Option<String>,
    /// Waveform it answers with: --outputs of a single one.
    #[arg(long, conflicts_with = "output_channels")]
    pub output_channel: Option<String>,
    /// Waveforms that drive the system, separated by commas, of any quantity; "none": it moves freely (subspace
    /// methods). Default: the crash pulse (deceleration), or --channel.
    #[arg(long = "inputs", alias = "input-channels", value_delimiter = ',')]
    pub input_channels: Vec<String>,
    /// Waveforms it answers with, e.g. 93/velocity; "exponentials" takes the first. Default: displacement of the crash
    /// pulse (era: the crash pulse); a --channel that is no acceleration itself, which then moves freely.
    #[arg(long = "outputs", alias = "output-channels", value_delimiter = ',')]
    pub output_channels: Vec<String>,
    /// Number of poles of a transfer function. Default: 4.
    #[arg(long)]
    pub poles: Option<u32>,
    /// Number of its zeros. Default: 1.
    #[arg(long)]
    pub zeros: Option<u32>,
    /// Input between its samples: first-order (straight lines) or zero-order (steps). Default: zero-order where every
    /// input stands still between jumps, else first-order.
    #[arg(long, hide_possible_values = true)]
    pub hold: Option<Hold>,
    /// Motion at the start of the window: estimate, zero, or auto (estimated if an F-test at 5 % says so). Default:
    /// estimate.
    #[arg(long, hide_possible_values = true)]
    pub initial: Option<Initial>,
    /// Keep poles of transfer functions from growing; sums of exponentials never grow. Default: false.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub stable: Option<bool>,
    /// Write a model of arx or okid that grows and cannot be simulated, as of an unstable plant in a loop: poles and
    /// one-step prediction. Default: false.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub allow_unstable: Option<bool>,
    /// Ways to starting points of a transfer function: svf, iv, n4sid, arx, integrators, random.
    /// Default: all.
    #[arg(long, value_delimiter = ',', hide_possible_values = true)]
    pub starts: Vec<StartName>,
    /// Iterations from each start at most. Several, separated by commas: tfest gives one model each, those of fewer
    /// iterations with "after-<n>" in their names; other methods take the largest. Default: 200.
    #[arg(long, value_delimiter = ',')]
    #[serde(deserialize_with = "one_or_several")]
    pub max_iterations: Vec<u32>,
    /// Samples by which the input acts late; "auto": the best of 0 to 19 by the one-step prediction error, "auto=2-30":
    /// expected in these, and a best one beyond them is said. Default: 0.
    #[arg(long)]
    pub delay: Option<Delay>,
    /// Remove the mean over the samples identified from, from every waveform that a method takes (also from the samples
    /// kept by --validate-from). Default: false; true of inputs and outputs with --methods auto of records that are no
    /// crash.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub remove_mean: Option<bool>,
    /// The same with a straight line instead of the mean. Default: false.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub remove_trend: Option<bool>,
    /// Time constant τ of the exponential window exp(-t/τ) that the analyser multiplied the response with, e.g. 120ms:
    /// the damping that it adds to every mode, 1/(τω), is taken off. Default: no window.
    #[arg(long)]
    pub window_time_constant: Option<Time>,
    /// Number of exponential terms; a damped wave counts as two. Default: 4.
    #[arg(long)]
    pub terms: Option<u32>,
    /// Real exponents only. Default: false.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub real: Option<bool>,
    /// What a sum of exponentials must have at the start of the window: position (that of the record), velocity (that
    /// of the record, or --start-velocity), acceleration (zero, or --start-acceleration). Each needs the ones before.
    /// Default: none.
    #[arg(long, value_delimiter = ',', hide_possible_values = true)]
    pub conditions: Vec<Condition>,
    /// Velocity for --conditions position,velocity, e.g. 35km/h. Default: that of the record.
    #[arg(long, allow_hyphen_values = true)]
    pub start_velocity: Option<Speed>,
    /// Acceleration for --conditions position,velocity,acceleration, e.g. -3g. Default: zero.
    #[arg(long, allow_hyphen_values = true)]
    pub start_acceleration: Option<Acceleration>,
    /// Models of arx by numbers of past outputs, of inputs, and samples before an input acts, e.g. 2,2,3; several
    /// separated by semicolons, 2,2,3;4,4,1. Instead of --orders, which means n,n+1,0.
    #[arg(long, value_delimiter = ';')]
    pub arx_orders: Vec<ArxStructure>,
    /// Try arx models of ranges of these numbers on the same samples, write the table of their criteria, and take the
    /// one with the smallest BIC of its one-step prediction. Default: no scan; without ranges 1-4,1-4,0-6.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "1-4,1-4,0-6")]
    pub arx_scan: Option<ArxRanges>,
    /// Block rows of the subspace methods, their horizon. Default: of twice the order (10 at least) and once and twice
    /// the lags that a regression on the past needs by BIC (40 at most), the one whose model simulates the record best.
    #[arg(long)]
    pub block_rows: Option<u32>,
    /// The subspace methods find poles from every n-th sample behind a low-pass filter; 1: from all. Default: as many
    /// as the bandwidth of the waveforms leaves unneeded, 1 with --block-rows.
    #[arg(long)]
    pub thin: Option<u32>,
    /// Draw a stabilisation diagram: the poles of all orders up to --max-order of methods that choose an order (era,
    /// n4sid, moesp, cva), and which of them stay. Default: false.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub stabilisation: Option<bool>,
    /// Largest damping ratio of a pole that counts there. Default: 2; 0.3 is usual for structures.
    #[arg(long)]
    pub highest_damping: Option<f64>,
    /// Fits to records with new noise, for standard deviations and nominal 90 % intervals of frequencies, damping,
    /// zeros and frequency responses; 60 suffice, 200 are usual. Default: 0, none.
    #[arg(long)]
    pub bootstrap: Option<u32>,
    /// Seed of that noise. Default: 1.
    #[arg(long)]
    pub bootstrap_seed: Option<u32>,
    /// Identify from the samples before this time, or this share of the samples in use, only, and tell how well the
    /// model predicts the rest, e.g. 100ms or 50%: run on from its own state, and with the initial state fitted to the
    /// rest. Default: no validation.
    #[arg(long)]
    pub validate_from: Option<ValidateFrom>,
    /// Follow the procedure of a paper as printed, labelled so: era (crash pulse as an impulse response, 2 states from
    /// 100 and from 50 samples, 4 from 60 and from 2501), curve-fit (of the same paper: 4 real exponentials) or tfest
    /// (4 poles, 1 zero, 20 iterations, at rest before the record). It sets --methods and what belongs to the
    /// procedure. Default: none.
    #[arg(long, hide_possible_values = true)]
    pub paper: Option<Paper>,
    /// Start of the window, e.g. 5ms. Default: time zero, 0 s.
    #[arg(long, allow_hyphen_values = true)]
    pub from: Option<Time>,
    /// End of the window, e.g. 120ms. Default: end of the record.
    #[arg(long, allow_hyphen_values = true)]
    pub to: Option<Time>,
}

/// A number, or a list of numbers.
fn one_or_several<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<u32>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Written {
        One(u32),
        Several(Vec<u32>),
    }
    Ok(match Written::deserialize(deserializer)? {
        Written::One(number) => vec![number],
        Written::Several(numbers) => numbers,
    })
}
