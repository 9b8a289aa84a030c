//! Flags and pipeline keys of the stage, and the settings they come to.

use crumple_integrate::{Rule, Start};
use crumple_signal::value::{Speed, Time};
use serde::{Deserialize, Serialize};

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// How samples are summed [default: trapezoid]
    #[arg(long, value_enum)]
    pub rule: Option<Rule>,

    /// Where the integration starts [default: auto]
    #[arg(long, value_enum)]
    pub start: Option<Start>,

    /// Channel to take as the crash pulse, by id [default: the pulse of the test]
    #[arg(long, value_name = "ID")]
    pub channel: Option<String>,

    /// First contact on the record's time axis, e.g. 1.2ms [default: 0 s, as the file has it]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub time_zero: Option<Time>,

    /// Speed just before contact, e.g. 57.09km/h, instead of the one in the test description
    #[arg(long, value_name = "SPEED")]
    pub impact_speed: Option<Speed>,
}

/// Options with the defaults filled in that do not depend on the record.
#[derive(Debug, Serialize)]
pub struct StageSettings {
    pub rule: Rule,
    pub start: Start,
    /// `None`: the pulse of the test.
    pub channel: Option<String>,
    /// `None`: 0 s, where the file has it.
    pub time_zero_s: Option<f64>,
    /// `None`: that of the test.
    pub impact_speed_m_per_s: Option<f64>,
}

impl From<Options> for StageSettings {
    fn from(options: Options) -> Self {
        Self {
            rule: options.rule.unwrap_or_default(),
            start: options.start.unwrap_or_default(),
            channel: options.channel,
            time_zero_s: options.time_zero.map(Time::si),
            impact_speed_m_per_s: options.impact_speed.map(Speed::si),
        }
    }
}
