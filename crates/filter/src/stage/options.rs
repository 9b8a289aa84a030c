//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_filter::{Butterworth, Class, Instead, Interpolation, Mode, Pass, Phase, Resampling, Settings, ZeroLevel};
use crumple_signal::PreEventWindow;
use crumple_signal::value::{Frequency, Time};
use crumple_stage::Usage;
use serde::{Deserialize, Serialize};

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Channel frequency class to filter to: 60, 180, 600, 1000, or none to leave the signal as it is [default: 60]
    ///
    /// 60 is for the vehicle structure; a dummy's head and chest go to their own, 1000 and 180, unless the class is
    /// typed here and the channel named by --channels. A channel that already has the class or a lower one passes
    /// through.
    #[arg(long, value_name = "CLASS")]
    pub cfc: Option<Class>,

    /// The class is meant for whatever is filtered: set by where it stands, not by a flag of its own.
    #[arg(skip)]
    #[serde(skip)]
    pub class_for_all: bool,

    /// Standard whose filter is used [default: iso6487]
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,

    /// Butterworth filter instead of the class: what passes
    ///
    /// Needs --order and --cutoff, a band --cutoff-high too.
    #[arg(long, value_enum, value_name = "PASS")]
    pub butterworth: Option<PassKind>,

    /// Order of the Butterworth filter, 1 to 12: poles of one pass (a band has twice as many)
    #[arg(long, value_name = "N")]
    pub order: Option<usize>,

    /// Frequency at which the Butterworth filter as run leaves -3 dB, e.g. 100Hz; of a band the lower one
    #[arg(long, value_name = "FREQUENCY")]
    pub cutoff: Option<Frequency>,

    /// Upper -3 dB frequency of a band
    #[arg(long, value_name = "FREQUENCY")]
    pub cutoff_high: Option<Frequency>,

    /// How the Butterworth filter is run [default: zero]
    #[arg(long, value_enum)]
    pub phase: Option<Phase>,

    /// Centred moving average of this width instead of the class, e.g. 3ms
    #[arg(long, value_name = "TIME")]
    pub moving_average: Option<Time>,

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

    /// Channel to align the other accelerations with: each is shifted in time by its delay, which is printed
    #[arg(long, value_name = "ID")]
    pub align_to: Option<String>,

    /// Longest delay that is looked for [default: 5 ms]
    #[arg(long, value_name = "TIME")]
    pub align_within: Option<Time>,

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

impl Options {
    /// A class typed as a flag, or stated in the pipeline file together with the channels, is meant for all that is
    /// filtered. One that stands in a pipeline file alone is that of the vehicle's structure.
    pub fn note_typed(&mut self, is_flag: &dyn Fn(&str) -> bool) {
        let with_its_channels = self.cfc.is_some() && !self.channels.is_empty() && !is_flag("channels");
        self.class_for_all = is_flag("cfc") || with_its_channels;
    }
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

/// What a Butterworth filter lets pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum PassKind {
    /// Below the cut-off.
    Low,
    /// Above the cut-off.
    High,
    /// Between the cut-offs.
    Band,
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
    /// The class holds for a dummy's head and chest too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub class_for_all: bool,
    /// Ids, codes or patterns asked for; empty: those on the vehicle structure and the barrier.
    pub channels: Vec<String>,
    /// Ids, codes or patterns of those handed on as they are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pass: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub align: Option<Align>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resample: Option<Resampling>,
    #[serde(skip_serializing_if = "KeptRate::is_auto")]
    pub rate: KeptRate,
}

/// Which channel the others are aligned with.
#[derive(Debug, Serialize)]
pub struct Align {
    /// Its id.
    pub to: String,
    /// Longest delay looked for, s.
    pub within_s: f64,
}

/// Longest delay looked for unless stated, s.
const ALIGN_WITHIN_S: f64 = 5e-3;

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        let default = Settings::default();
        let align = match (&options.align_to, options.align_within) {
            (None, Some(_)) => return Err(together("align-within", "align-to")),
            (None, None) => None,
            (Some(to), within) => Some(Align { to: to.clone(), within_s: within.map_or(ALIGN_WITHIN_S, Time::si) }),
        };
        if options.resample.is_some() && options.rate.is_some() {
            return Err(Usage::new("both a rate to keep and a rate to resample to are given").hint("leave out either"));
        }
        let resample = match (options.resample, options.interpolation) {
            (None, Some(_)) => return Err(together("interpolation", "resample")),
            (None, None) => None,
            (Some(rate), how) => Some(Resampling { rate_hz: rate.si(), interpolation: how.unwrap_or_default() }),
        };
        Ok(Self {
            filter: Settings {
                class: options.cfc.unwrap_or(default.class),
                mode: options.mode.unwrap_or(default.mode),
                zero_level: zero_level(&options)?,
                instead: instead(&options)?,
            },
            class_for_all: options.class_for_all,
            channels: options.channels,
            pass: options.pass,
            align,
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
        ZeroLevelRule::PreEvent => Ok(ZeroLevel::PreEvent(PreEventWindow {
            from_s: options.zero_level_from.map_or(PreEventWindow::default().from_s, Time::si),
            to_s: options.zero_level_to.map_or(PreEventWindow::default().to_s, Time::si),
        })),
    }
}

fn instead(options: &Options) -> Result<Option<Instead>, Usage> {
    let Some(kind) = options.butterworth else {
        let given = [
            ("order", options.order.is_some()),
            ("cutoff", options.cutoff.is_some()),
            ("cutoff-high", options.cutoff_high.is_some()),
            ("phase", options.phase.is_some()),
        ];
        if let Some((name, _)) = given.into_iter().find(|(_, given)| *given) {
            return Err(together(name, "butterworth"));
        }
        return Ok(options.moving_average.map(|width| Instead::MovingAverage(width.si())));
    };
    if options.moving_average.is_some() {
        return Err(Usage::new("both butterworth and moving-average are asked for").hint("leave out either"));
    }
    let order = options.order.ok_or_else(|| together("butterworth", "order"))?;
    let cutoff_hz = options.cutoff.ok_or_else(|| together("butterworth", "cutoff"))?.si();
    let pass = match (kind, options.cutoff_high) {
        (PassKind::Low, None) => Pass::Low(cutoff_hz),
        (PassKind::High, None) => Pass::High(cutoff_hz),
        (PassKind::Band, Some(high)) => Pass::Band(cutoff_hz, high.si()),
        (PassKind::Band, None) => return Err(together("a butterworth band", "cutoff-high")),
        (_, Some(_)) => return Err(Usage::new("cutoff-high belongs to a butterworth band").hint("leave it out")),
    };
    Ok(Some(Instead::Butterworth(Butterworth { pass, order, phase: options.phase.unwrap_or_default() })))
}

fn together(given: &str, needed: &str) -> Usage {
    Usage::new(format!("{given} needs {needed}")).hint(format!("give --{needed} too"))
}
