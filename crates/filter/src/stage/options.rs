//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_signal::value::{Frequency, Time};
use crumple_signal::{
    Butterworth, CfcMode, Class, FilterSettings, Interpolation, Phase, PreEventWindow, Resampling, ZeroLevel,
};
use crumple_stage::Usage;
use serde::{Deserialize, Serialize};

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Channel frequency class to filter to: 60, 180, 600, 1000, or none to leave the signal as it is [default: 60]
    ///
    /// That of the vehicle structure and of the pulse; a dummy's head and chest have --occupant-cfc. A channel that
    /// already has the class or a lower one passes through.
    #[arg(long, value_name = "CLASS")]
    pub cfc: Option<Class>,

    /// Class of a dummy's head and chest [default: that of their criteria, 1000 and 180]
    #[arg(long, value_name = "CLASS")]
    pub occupant_cfc: Option<Class>,

    /// Standard whose filter is used [default: iso6487]
    #[arg(long, value_enum)]
    pub mode: Option<CfcMode>,

    /// Butterworth low-pass filter instead of the class: its order, 1 to 12, which is the number of poles of one pass
    #[arg(long, value_name = "N")]
    pub order: Option<usize>,

    /// Frequency at which the Butterworth filter as run leaves -3 dB, e.g. 100Hz
    #[arg(long, value_name = "FREQUENCY")]
    pub cutoff: Option<Frequency>,

    /// How the Butterworth filter is run [default: zero]
    #[arg(long, value_enum)]
    pub phase: Option<Phase>,

    /// Zero level to remove before filtering: the mean before the event, or none [default: pre-event]
    #[arg(long, value_enum, value_name = "RULE")]
    pub zero_level: Option<ZeroLevelRule>,

    /// Start of the pre-event window on the record's time axis [default: -50 ms]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub zero_level_from: Option<Time>,

    /// End of the pre-event window on the record's time axis [default: -10 ms]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub zero_level_to: Option<Time>,

    /// Channels to filter, by id, code or pattern such as '1?VEHC*X?', whatever they measure [default: every
    /// acceleration channel on the vehicle structure, the heads and chests of occupants, and the load cells of the
    /// barrier]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub channels: Vec<String>,

    /// Channels to hand on as they are, by id, code or pattern, e.g. a contact switch
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub pass: Vec<String>,

    /// Rate to keep of channels that were filtered to a class: auto, full, or the lowest to keep, e.g. 50kHz [default:
    /// auto]
    ///
    /// auto leaves records up to 20 kHz as they are. Of one sampled faster every n-th sample is kept after filtering,
    /// so that at least 10 kHz and 100 times the -3 dB frequency of the class remain: what would fold back is down by
    /// 136 dB. A rate raises that, full keeps every sample.
    #[arg(long, value_name = "RATE")]
    pub rate: Option<KeptRate>,

    /// Sampling rate to bring the filtered channels to, e.g. 10kHz [default: their own]
    #[arg(long, value_name = "FREQUENCY")]
    pub resample: Option<Frequency>,

    /// How values between samples are found when resampling [default: sinc]
    #[arg(long, value_enum, value_name = "HOW")]
    pub interpolation: Option<Interpolation>,
}

/// Which rate is kept of what was filtered to a class.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum KeptRate {
    /// What the class needs.
    #[default]
    Auto,
    /// Every sample.
    Full,
    /// At least this, Hz.
    AtLeast(f64),
}

impl KeptRate {
    /// Whether it is the default, which stands in no provenance.
    pub fn is_auto(&self) -> bool {
        *self == Self::Auto
    }
}

impl std::str::FromStr for KeptRate {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "auto" => Ok(Self::Auto),
            "full" => Ok(Self::Full),
            rate => {
                let rate: Frequency =
                    rate.parse().map_err(|error| format!("expected auto, full or a rate: {error}"))?;
                Ok(Self::AtLeast(rate.si()))
            }
        }
    }
}

impl TryFrom<String> for KeptRate {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<KeptRate> for String {
    fn from(rate: KeptRate) -> Self {
        match rate {
            KeptRate::Auto => "auto".to_owned(),
            KeptRate::Full => "full".to_owned(),
            KeptRate::AtLeast(rate_hz) => format!("{rate_hz} Hz"),
        }
    }
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
    pub filter: FilterSettings,
    /// Class of a dummy's head and chest, if not that of their criteria.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub occupant_cfc: Option<Class>,
    /// Ids, codes or patterns asked for; empty: those on the vehicle structure and the barrier.
    pub channels: Vec<String>,
    /// Ids, codes or patterns of those handed on as they are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pass: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resample: Option<Resampling>,
    #[serde(skip_serializing_if = "KeptRate::is_auto")]
    pub rate: KeptRate,
}

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        let default = FilterSettings::default();
        if options.resample.is_some() && options.rate.is_some() {
            return Err(Usage::new("both a rate to keep and a rate to resample to are given").hint("leave out either"));
        }
        let resample = match (options.resample, options.interpolation) {
            (None, Some(_)) => return Err(together("interpolation", "resample")),
            (None, None) => None,
            (Some(rate), how) => Some(Resampling { rate_hz: rate.si(), interpolation: how.unwrap_or_default() }),
        };
        Ok(Self {
            filter: FilterSettings {
                class: options.cfc.unwrap_or(default.class),
                mode: options.mode.unwrap_or(default.mode),
                zero_level: zero_level(&options)?,
                butterworth: butterworth(&options)?,
            },
            occupant_cfc: options.occupant_cfc,
            channels: options.channels,
            pass: options.pass,
            resample,
            rate: options.rate.unwrap_or_default(),
        })
    }
}

fn zero_level(options: &Options) -> Result<ZeroLevel, Usage> {
    let window_given = options.zero_level_from.is_some() || options.zero_level_to.is_some();
    match options.zero_level.unwrap_or(ZeroLevelRule::PreEvent) {
        ZeroLevelRule::None if window_given => {
            Err(Usage::new("a window for the zero level is given, but zero-level is none").hint("leave out either"))
        }
        ZeroLevelRule::None => Ok(ZeroLevel::None),
        ZeroLevelRule::PreEvent => Ok(ZeroLevel::PreEvent(PreEventWindow::stated(
            options.zero_level_from.map(Time::si),
            options.zero_level_to.map(Time::si),
        ))),
    }
}

fn butterworth(options: &Options) -> Result<Option<Butterworth>, Usage> {
    match (options.order, options.cutoff, options.phase) {
        (None, None, None) => Ok(None),
        (Some(order), Some(cutoff), phase) => {
            Ok(Some(Butterworth { cutoff_hz: cutoff.si(), order, phase: phase.unwrap_or_default() }))
        }
        (Some(_), None, _) => Err(together("order", "cutoff")),
        (None, Some(_), _) => Err(together("cutoff", "order")),
        (None, None, Some(_)) => Err(together("phase", "order")),
    }
}

fn together(given: &str, needed: &str) -> Usage {
    Usage::new(format!("{given} needs {needed}")).hint(format!("give --{needed} too"))
}
