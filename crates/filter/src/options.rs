//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_filter::{Class, Mode, Settings, Window, ZeroLevel};
use crumple_signal::value::Time;
use crumple_stage::Usage;
use serde::{Deserialize, Serialize};

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Channel frequency class to filter to: 60, 180, 600, 1000, or none to leave the signal as it is [default: 60]
    ///
    /// 60 is for the vehicle structure. A channel that already has the class or a lower one passes through.
    #[arg(long, value_name = "CLASS")]
    pub cfc: Option<Class>,

    /// Standard whose filter is used [default: iso6487]
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,

    /// Zero level to remove before filtering: the mean before the event, or none [default: pre-event]
    #[arg(long, value_enum, value_name = "RULE")]
    pub zero_level: Option<ZeroLevelRule>,

    /// Start of the pre-event window on the record's time axis [default: -50 ms]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub zero_level_from: Option<Time>,

    /// End of the pre-event window on the record's time axis [default: -10 ms]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub zero_level_to: Option<Time>,

    /// Channels to filter, by id, whatever they measure [default: every acceleration channel on the vehicle structure]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub channels: Vec<String>,
}

/// Where the zero level is read.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroLevelRule {
    /// Mean of the samples in the pre-event window, which must cover at least 10 ms.
    PreEvent,
    /// Nothing is removed.
    None,
}

/// Options with every default filled in.
#[derive(Debug, Serialize)]
pub struct StageSettings {
    #[serde(flatten)]
    pub filter: Settings,
    /// Ids asked for; empty: those on the vehicle structure.
    pub channels: Vec<String>,
}

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        let default = Settings::default();
        let window_given = options.zero_level_from.is_some() || options.zero_level_to.is_some();
        let zero_level = match options.zero_level.unwrap_or(ZeroLevelRule::PreEvent) {
            ZeroLevelRule::None if window_given => {
                return Err(
                    Usage::new("a window for the zero level is given, but zero-level is none").hint("leave out either")
                );
            }
            ZeroLevelRule::None => ZeroLevel::None,
            ZeroLevelRule::PreEvent => ZeroLevel::PreEvent(Window {
                from_s: options.zero_level_from.map_or(Window::default().from_s, Time::si),
                to_s: options.zero_level_to.map_or(Window::default().to_s, Time::si),
            }),
        };
        Ok(Self {
            filter: Settings {
                class: options.cfc.unwrap_or(default.class),
                mode: options.mode.unwrap_or(default.mode),
                zero_level,
            },
            channels: options.channels,
        })
    }
}
