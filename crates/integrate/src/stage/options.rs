//! Flags and pipeline keys, the settings they come to, the uncertain inputs among them.

use std::fmt;
use std::str::FromStr;

use crate::Uncertainty;
use clap::builder::PossibleValuesParser;
use crumple_metrics::{NO_DAMAGE_SPEED_M_PER_S, SLED_PULSES, SledPulse};
use crumple_signal::value::{Length, Level, Share, Speed, Time};
use crumple_signal::{
    About, Distribution, DriftShape, EndCondition, IntegrationRule, IntegrationStart, KnownEnd,
    STANDARD_GRAVITY_M_PER_S2, Spread, Uncertain, UsedStart, Weight, remarks,
};
use crumple_stage::{LeftOut, Usage, flag};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

// Flags and pipeline keys of the stage.

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// How samples are summed [default: trapezoid]
    #[arg(long, value_enum)]
    pub rule: Option<IntegrationRule>,

    /// Where the integration starts [default: auto]
    #[arg(long, value_enum)]
    pub start: Option<IntegrationStart>,

    /// Channel to take as the crash pulse, by id, code or a pattern that means one [default: the pulse of the test]
    #[arg(long, value_name = "ID")]
    pub channel: Option<String>,

    /// Further accelerometers to integrate, by id, code or pattern such as '1?VEHC*X?'; all stands for every x
    /// acceleration of the compartment [default: none]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub channels: Vec<String>,

    /// Speed just before contact, e.g. 57.09km/h, instead of the one in the test description
    #[arg(long, value_name = "SPEED")]
    pub impact_speed: Option<Speed>,

    /// Known velocity after separation, e.g. -2.5m/s, or standstill: the drift that brings the pulse there is taken out
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub end_velocity: Option<EndVelocity>,

    /// Known displacement from contact on, e.g. 655mm with --end-time 94ms, the stroke of a sled at the end of its
    /// pulse: the drift that brings the pulse there is taken out
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true, conflicts_with = "end_velocity")]
    pub end_displacement: Option<Length>,

    /// When the known velocity or displacement holds, counted from contact [default: at the last sample]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub end_time: Option<Time>,

    /// What the drift is taken to be [default: bias]
    #[arg(long, value_enum)]
    pub drift: Option<DriftShape>,

    /// Uncertainty of the impact speed, e.g. "0.1 km/h" (standard deviation) or "0.1 km/h uniform" (half width): events
    /// and metrics get 5-95 % intervals [default: none stated]
    #[arg(long, value_name = "SPEED [normal|uniform]")]
    pub speed_uncertainty: Option<Uncertain<Speed>>,

    /// Uncertainty of the zero level that is left, e.g. "0.05 g uniform" [default: none stated]
    #[arg(long, value_name = "ACCELERATION [normal|uniform]")]
    pub zero_level_uncertainty: Option<Uncertain<Level>>,

    /// Uncertainty of the gain of the channel, e.g. "1 % uniform" [default: none stated]
    #[arg(long, value_name = "PERCENT [normal|uniform]")]
    pub gain_uncertainty: Option<Uncertain<Share>>,

    /// How often the integration is repeated with perturbed inputs, 0 for no intervals [default: 128]
    #[arg(long, value_name = "N")]
    pub uncertainty_replicates: Option<u32>,

    /// Seed of the places of the repetitions [default: 1]
    #[arg(long, value_name = "N")]
    pub uncertainty_seed: Option<u64>,

    /// Load cells of the barrier in the sum of its force [default: valid]
    #[arg(long, value_enum)]
    pub barrier_cells: Option<BarrierCells>,

    /// Heights above ground of the load cells of the barrier, e.g. 'B0BARR01*=250mm,B0BARR02*=375mm', by id, code or
    /// pattern: the average height of force [default: none]
    #[arg(long, value_name = "ID=LENGTH", value_delimiter = ',')]
    pub wall_heights: Vec<WallHeight>,

    /// Metrics of occupants and roadside hardware beside those of the pulse, by group [default: auto]
    #[arg(long, value_enum, value_name = "GROUP", value_delimiter = ',')]
    pub metrics: Vec<MetricGroup>,

    /// Sled pulse of a standard that the pulse is held against: its corridor, velocity, stroke and peak [default: none]
    #[arg(long, value_name = "NAME", value_parser = corridor_names())]
    pub corridor: Option<String>,

    /// Width of the damage, e.g. 1.6m: with the residual crush, CRASH3 stiffness A, B and G [default: as the file
    /// states it]
    #[arg(long, value_name = "LENGTH")]
    pub damage_width: Option<Length>,

    /// Residual crush measured on the vehicle, e.g. 520mm, for CRASH3 [default: as the file states it]
    #[arg(long, value_name = "LENGTH")]
    pub residual_crush: Option<Length>,

    /// Speed of no damage b0 for CRASH3 [default: 2.2352 m/s, 5 mph]
    #[arg(long, value_name = "SPEED")]
    pub no_damage_speed: Option<Speed>,
}

/// The names of the sled pulses.
fn corridor_names() -> PossibleValuesParser {
    PossibleValuesParser::new(SLED_PULSES.iter().map(|pulse| pulse.name))
}

/// Contact is settled where the record is read, for all stages.
const GIVE_IT_TO_INGEST: &str = "give it to ingest, which settles contact for every stage: in the table [ingest], or \
    as a flag of ingest and run";

/// Options of earlier versions.
pub const LEFT_OUT: &[LeftOut] = &[
    LeftOut { option: "time_zero", value: "", instead: GIVE_IT_TO_INGEST },
    LeftOut { option: "time_zero_rule", value: "", instead: GIVE_IT_TO_INGEST },
    LeftOut { option: "time_zero_uncertainty", value: "", instead: GIVE_IT_TO_INGEST },
];

/// Groups of metrics of occupants and of roadside hardware.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum MetricGroup {
    /// Every group whose channels the test has.
    #[default]
    Auto,
    /// Head accelerations: HIC15, HIC36, 3 ms clips; HIC(d) of a free-motion headform.
    Head,
    /// Chest accelerations: 3 ms clips.
    Chest,
    /// Vehicle x and y at the centre of gravity: ASI, OIV, ORA; with the yaw rate THIV and PHD. Asked for by name, the
    /// pulse stands in for a missing x, and a missing y is 0.
    Roadside,
    /// Chest x against the pulse: ride-down.
    RideDown,
    /// None of them.
    None,
}

/// Which load cells are summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum BarrierCells {
    /// Those that the laboratory marks valid; the others are named.
    #[default]
    Valid,
    /// All with data, as read.
    All,
    /// None: no barrier force.
    None,
}

/// A velocity along x, m/s; `standstill` is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndVelocity(pub Speed);

impl FromStr for EndVelocity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "standstill" => Ok(Self(Speed::from_si(0.0))),
            speed => speed.parse().map(Self).map_err(|error: crumple_signal::unit::UnitError| error.to_string()),
        }
    }
}

impl fmt::Display for EndVelocity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The height of a row of load cells above ground: the cells by id, code or pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct WallHeight {
    pub cells: String,
    pub height: Length,
}

impl FromStr for WallHeight {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (cells, height) = text.split_once('=').ok_or("expected cells and their height, such as row1=250mm")?;
        let height: Length =
            height.trim().parse().map_err(|error: crumple_signal::unit::UnitError| error.to_string())?;
        if cells.trim().is_empty() || height.si() <= 0.0 {
            return Err("expected cells and their height above ground, such as row1=250mm".to_owned());
        }
        Ok(Self { cells: cells.trim().to_owned(), height })
    }
}

impl fmt::Display for WallHeight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.cells, self.height)
    }
}

macro_rules! as_text {
    ($($name:ident),*) => {$(
        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                String::deserialize(deserializer)?.parse().map_err(de::Error::custom)
            }
        }
    )*};
}

as_text!(EndVelocity, WallHeight);

// The settings that the options come to.

/// Options with the defaults filled in that do not depend on the record.
#[derive(Debug, Serialize)]
pub struct StageSettings {
    pub rule: IntegrationRule,
    pub start: IntegrationStart,
    /// `None`: the pulse of the test.
    pub channel: Option<String>,
    /// Further channels.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub channels: Vec<String>,
    /// `None`: that of the test.
    pub impact_speed_m_per_s: Option<f64>,
    /// `None`: no drift is taken out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_condition: Option<EndCondition>,
    #[serde(skip_serializing_if = "is_default")]
    pub barrier_cells: BarrierCells,
    /// Empty: the heights are not known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wall_heights: Vec<WallHeight>,
    /// Empty: auto.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub metrics: Vec<MetricGroup>,
    /// The sled pulse that is held against; `None`: none.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "as_name")]
    pub corridor: Option<SledPulse>,
    /// Speed of no damage, for CRASH3.
    #[serde(skip_serializing_if = "is_usual_speed")]
    pub no_damage_speed_m_per_s: f64,
    /// For CRASH3; `None`: what the file of the test states.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
    /// `None`: no intervals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<Uncertainty>,
}

/// The damage of a barrier test, for the stiffness of CRASH3.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Damage {
    pub width_m: f64,
    pub residual_crush_m: f64,
}

/// Options that are not used stay out of the provenance, so that results from before they existed stay up to date.
fn is_default(cells: &BarrierCells) -> bool {
    *cells == BarrierCells::default()
}

fn as_name<S: Serializer>(pulse: &Option<SledPulse>, serializer: S) -> Result<S::Ok, S::Error> {
    pulse.map(|pulse| pulse.name).serialize(serializer)
}

fn is_usual_speed(speed: &f64) -> bool {
    *speed == NO_DAMAGE_SPEED_M_PER_S
}

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        if options.end_velocity.is_some() && options.end_displacement.is_some() {
            return Err(Usage::new("end-velocity and end-displacement are both given").hint("one drift meets one"));
        }
        if options.end_velocity.is_none() && options.end_displacement.is_none() {
            let given = [("end-time", options.end_time.is_some()), ("drift", options.drift.is_some())];
            if let Some((name, _)) = given.into_iter().find(|(_, given)| *given) {
                return Err(Usage::new(format!("{name} needs end-velocity or end-displacement"))
                    .hint(format!("give the velocity that is known with {}", flag("integrate", "end-velocity"))));
            }
        }
        let corridor = options.corridor.as_deref().map(sled_pulse).transpose()?;
        let known = options.end_velocity.map(|EndVelocity(speed)| KnownEnd::Velocity(speed.si()));
        let known = known.or(options.end_displacement.map(|way| KnownEnd::Displacement(way.si())));
        let uncertainty = uncertainty(&options)?;
        let metrics: Vec<MetricGroup> =
            options.metrics.iter().copied().filter(|group| *group != MetricGroup::Auto).collect();
        if metrics.contains(&MetricGroup::None) && metrics.len() > 1 {
            return Err(Usage::new("metrics none stands beside other groups").hint("leave out either"));
        }
        let damage = match (options.damage_width, options.residual_crush) {
            (Some(width), Some(crush)) => Some(Damage { width_m: width.si(), residual_crush_m: crush.si() }),
            (None, None) => None,
            _ => {
                return Err(Usage::new("damage-width and residual-crush belong together").hint(format!(
                    "give both, {} and {}",
                    flag("integrate", "damage-width"),
                    flag("integrate", "residual-crush")
                )));
            }
        };
        Ok(Self {
            uncertainty,
            rule: options.rule.unwrap_or_default(),
            start: options.start.unwrap_or_default(),
            channel: options.channel,
            channels: options.channels,
            impact_speed_m_per_s: options.impact_speed.map(Speed::si),
            corridor,
            end_condition: known.map(|known| EndCondition {
                known,
                time_s: options.end_time.map(Time::si),
                shape: options.drift.unwrap_or_default(),
            }),
            barrier_cells: options.barrier_cells.unwrap_or_default(),
            wall_heights: options.wall_heights,
            metrics,
            no_damage_speed_m_per_s: options.no_damage_speed.map_or(NO_DAMAGE_SPEED_M_PER_S, Speed::si),
            damage,
        })
    }
}

/// The sled pulse of a name.
fn sled_pulse(name: &str) -> Result<SledPulse, Usage> {
    SLED_PULSES.iter().find(|pulse| pulse.name == name).copied().ok_or_else(|| {
        let names: Vec<&str> = SLED_PULSES.iter().map(|pulse| pulse.name).collect();
        Usage::new(format!("no sled pulse is called {name:?}")).hint(format!("there are: {}", names.join(", ")))
    })
}

// The uncertain inputs of the options, and what the intervals made of them rest on.

fn spread<V>(stated: Uncertain<V>, si: impl Fn(V) -> f64) -> Spread {
    Spread { size: si(stated.size), distribution: stated.distribution }
}

/// Repetitions where none are stated: the ends of an interval are then uncertain by a ninth of a standard deviation at
/// most, as those of 400 random ones are.
const REPLICATES: u32 = 128;

/// Fewer have no 5 % quantile.
const FEWEST_REPLICATES: u32 = 20;

/// More do not make an interval better that rests on stated uncertainties.
const MOST_REPLICATES: u32 = 100_000;

/// `None` where nothing is uncertain or no repetitions are wanted.
pub fn uncertainty(options: &Options) -> Result<Option<Uncertainty>, Usage> {
    let replicates = options.uncertainty_replicates.unwrap_or(REPLICATES);
    if replicates != 0 && !(FEWEST_REPLICATES..=MOST_REPLICATES).contains(&replicates) {
        return Err(Usage::new(format!(
            "{replicates} replicates, expected 0 or a number from {FEWEST_REPLICATES} to {MOST_REPLICATES}"
        )));
    }
    let stated = Uncertainty {
        impact_speed_m_per_s: options.speed_uncertainty.map(|u| spread(u, Speed::si)),
        zero_level_m_per_s2: options.zero_level_uncertainty.map(|u| spread(u, Level::si)),
        gain: options.gain_uncertainty.map(|u| spread(u, Share::si)),
        contact_s: None,
        earlier_by_s: 0.0,
        lost_s: None,
        zero_shift: None,
        replicates: replicates as usize,
        seed: options.uncertainty_seed.unwrap_or(1),
    };
    Ok((replicates > 0 && stated.is_any()).then_some(stated))
}

/// What the intervals rest on. `start`: of an impact, whose crush contact moves; `None`: of a change of velocity.
pub fn uncertainty_note(uncertainty: &Uncertainty, start: Option<UsedStart>) -> IntervalsRestOn {
    let Uncertainty { impact_speed_m_per_s, zero_level_m_per_s2, gain, contact_s, replicates, seed, .. } = *uncertainty;
    let named = [(SPEED, impact_speed_m_per_s), (ZERO_LEVEL, zero_level_m_per_s2), (GAIN, gain), (CONTACT, contact_s)];
    let is_uniform = |spread: Option<Spread>| spread.is_some_and(|s| s.distribution == Distribution::Uniform);
    let uniform = named.into_iter().filter(|(_, spread)| is_uniform(*spread)).map(|(name, _)| name.to_owned());
    let size = |spread: Option<Spread>| spread.map(|spread| spread.size);
    IntervalsRestOn {
        replicates,
        seed,
        impact_speed_m_per_s: size(impact_speed_m_per_s),
        zero_level_m_per_s2: size(zero_level_m_per_s2),
        gain: size(gain),
        contact_s: size(contact_s),
        uniform: uniform.collect(),
        contact_earlier_by_s: Some(uncertainty.earlier_by_s).filter(|lead_s| *lead_s > 0.0),
        lost_from_s: uncertainty.lost_s.map(|[from_s, _]| from_s),
        lost_to_s: uncertainty.lost_s.map(|[_, to_s]| to_s),
        zero_shift_m_per_s2: uncertainty.zero_shift.map(|shift| shift.level_m_per_s2),
        start: start.map(|start| start.name().to_owned()),
    }
}

const SPEED: &str = "impact speed";
const ZERO_LEVEL: &str = "zero level";
const GAIN: &str = "gain";
const CONTACT: &str = "contact";

remarks! {
    /// Remarks of intervals.
    pub REMARKS;

    /// What the intervals of events and metrics are made from.
    CR328 IntervalsRestOn {
        replicates: usize, seed: u64, impact_speed_m_per_s: Option<f64>, zero_level_m_per_s2: Option<f64>,
        gain: Option<f64>, contact_s: Option<f64>, uniform: Vec<String>, contact_earlier_by_s: Option<f64>,
        lost_from_s: Option<f64>, lost_to_s: Option<f64>, zero_shift_m_per_s2: Option<f64>, start: Option<String>
    }
    bears on (About::Motion, Weight::None)
    decided "The integration is repeated with inputs that are off by their uncertainty; the interval is from the 5 % \
             to the 95 % quantile. A normal error is stated by its standard deviation, a uniform one by its half width."
    means "An input that is not named counts as exact. The mass, the mounting of the sensor and what another sensor \
           would have read are in no interval."
    remedy "state what is better known: --speed-uncertainty, --zero-level-uncertainty, --gain-uncertainty"
    says {
        let in_words = |name: &str, size: &Option<f64>, factor: f64, unit: &str| {
            // Rounded to what was typed: 0.1 km/h is not 0.09999999999999999.
            let size = (1e9 * (*size)? * factor).round() / 1e9;
            Some(if uniform.iter().any(|other| other == name) {
                format!("{name} +-{size} {unit} (uniform)")
            } else {
                format!("{name} {size} {unit} (standard deviation, normal)")
            })
        };
        let ms = |s: f64| 1e3 * s;
        let inputs = [
            in_words(SPEED, impact_speed_m_per_s, 3.6, "km/h"),
            in_words(ZERO_LEVEL, zero_level_m_per_s2, 1.0 / STANDARD_GRAVITY_M_PER_S2, "g"),
            in_words(GAIN, gain, 1e2, "%"),
            in_words(CONTACT, contact_s, 1e3, "ms"),
            contact_earlier_by_s.map(|lead_s| format!("contact up to {:.0} ms earlier for a soft front", ms(lead_s))),
            lost_from_s.zip(*lost_to_s).map(|(from_s, to_s)| {
                format!("samples that may be lost from {:.1} to {:.1} ms", ms(from_s), ms(to_s))
            }),
            zero_shift_m_per_s2.map(|level| {
                let level = level / STANDARD_GRAVITY_M_PER_S2;
                format!(
                    "a zero level that may have moved by {level:+.2} g up to the peak, where the record ends with it"
                )
            }),
        ];
        let inputs: Vec<String> = inputs.into_iter().flatten().collect();
        let moved = match start.as_deref().filter(|_| contact_s.is_some()) {
            None => "",
            Some(start) if start == UsedStart::RecordStart.name() => {
                ". An error of contact moves the crush by v0 times the error and all times by the error. Delta-v and \
                 rebound speed stay"
            }
            Some(_) => {
                ". An error of contact moves the crush by v0 times the error, and the velocity by the pulse in between"
            }
        };
        format!("intervals are 5-95 % of {replicates} replicates (seed {seed}) with {}{moved}", inputs.join(", "))
    };
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn nothing_uncertain_or_no_repetitions_is_none() {
        assert_eq!(uncertainty(&Options::default()).unwrap(), None);
        let speed = "0.1 m/s".parse().ok();
        let stated =
            |uncertainty_replicates| Options { speed_uncertainty: speed, uncertainty_replicates, ..Options::default() };
        assert_eq!(uncertainty(&stated(None)).unwrap().map(|u| (u.replicates, u.seed)), Some((128, 1)));
        assert_eq!(uncertainty(&stated(Some(0))).unwrap(), None);
        assert!(uncertainty(&stated(Some(3))).is_err());
    }
}
