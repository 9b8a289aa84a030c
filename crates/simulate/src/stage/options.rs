//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_signal::value::Time;
use serde::{Deserialize, Serialize};

use crate::stage::chain_table::ChainSettings;
use crate::stage::drive::Driven;

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// End of the compared window after time zero [default: dynamic crush of the test, or the end of a record without
    /// one]
    #[arg(long, value_name = "TIME")]
    pub to: Option<Time>,

    /// Keep the elastoplastic model attached after rebound, so that it oscillates for ever, instead of letting it leave
    /// the barrier [default: false]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub stay_attached: Option<bool>,

    /// What moves the models: impact (the impact speed), force (a waveform of the inputs, N, from rest), base (the
    /// barrier's acceleration, a waveform of the inputs or a sled pulse, from rest), pulse-as-force (the impact speed,
    /// and the mass times the measured acceleration as a force on the front mass: the transfer-function paper's
    /// simulation, circular) [default: impact]
    #[arg(long, value_name = "NAME")]
    pub drive: Option<String>,

    /// Waveform for --drive force or base, by its id, e.g. barrier/force; for base also a pulse: "half-sine 20g 90ms"
    /// (peak, duration), "triangle 24g 35ms 100ms" (peak, time of it, duration), positive in the direction of crush
    #[arg(long, value_name = "ID")]
    pub drive_wave: Option<String>,

    /// Mass that --drive force acts on, from 1 at the barrier [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub drive_mass: Option<usize>,

    /// Chains of masses stated in the pipeline file, `[simulate.chain.<name>]`, simulated beside the candidates.
    #[arg(skip)]
    pub chain: toml::Table,
}

/// Options with every default filled in.
#[derive(Debug, Serialize)]
pub struct Settings {
    pub to_s: Option<f64>,
    pub stay_attached: bool,
    #[serde(flatten)]
    pub driven: Driven,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chain: Vec<ChainSettings>,
}

impl Settings {
    /// Whether every model starts from rest.
    pub fn all_start_from_rest(&self) -> bool {
        let stated = self.chain.iter().map(|stated| &stated.driven);
        stated.chain([&self.driven]).all(Driven::starts_from_rest)
    }

    /// The settings with defaults filled in and names checked.
    pub fn new(options: Options) -> anyhow::Result<Self> {
        let name = options.drive.as_deref().unwrap_or("impact");
        let driven = Driven::new("", name, options.drive_wave, options.drive_mass.unwrap_or(1))?;
        let chain = options
            .chain
            .iter()
            .map(|(name, table)| ChainSettings::read(name, table, &driven))
            .collect::<anyhow::Result<_>>()?;
        Ok(Self {
            to_s: options.to.map(Time::si),
            stay_attached: options.stay_attached.unwrap_or(false),
            driven,
            chain,
        })
    }
}
