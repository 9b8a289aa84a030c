//! Flags and pipeline keys of the stage, speeds as a person types them, and the settings they come to.

use std::path::PathBuf;

use crate::Inputs;
use crumple_signal::value::{Mass, Speed};
use crumple_signal::{Display, Spread, Uncertain};
use crumple_stage::Usage;
use serde::{Deserialize, Serialize};

use crate::stage::occupant::{Described, Restraint, restraint, words};
use crate::stage::partner::PartnerSettings;

/// Speeds closer than this are one, m/s.
const SAME: f64 = 1e-9;

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Impact speeds to predict, e.g. 40km/h,64km/h, or a range 20..80/5 km/h; beside those of --speeds [default: none]
    #[arg(long, value_name = "SPEED", value_delimiter = ',')]
    pub speed: Vec<String>,

    /// Speeds that the pipeline always predicts [default: the speed of the test, where --speed gives none either]
    #[arg(long, value_name = "SPEED", value_delimiter = ',')]
    pub speeds: Vec<String>,

    /// Masses of the vehicle, e.g. 1300kg,1500kg; added mass sits in the compartment [default: the mass of the test]
    #[arg(long, value_name = "MASS", value_delimiter = ',')]
    pub mass: Vec<Mass>,

    /// Candidates to predict with, by their ids [default: the recommended, the simplest and the closest]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub candidate: Vec<String>,

    /// Run folder of another test: predicted at its speed and mass, and compared with it [default: none]
    #[arg(long, value_name = "FOLDER")]
    pub against: Option<PathBuf>,

    /// What the vehicle runs into: wall, the run folder of another vehicle, mpdb, fmvss-214, or a moving barrier such
    /// as "barrier mass=1400kg area=0.57m2 pressure=342kPa depth=250mm" [default: wall]
    #[arg(long, value_name = "WHAT")]
    pub partner: Option<Described>,

    /// Speed of the partner towards the vehicle; negative: it runs ahead [default: that of the vehicle for another
    /// vehicle and mpdb, else 0 km/h]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub partner_speed: Option<Speed>,

    /// Mass of the other vehicle [default: that of its test]
    #[arg(long, value_name = "MASS")]
    pub partner_mass: Option<Mass>,

    /// Candidate of the other vehicle's run [default: the recommended]
    #[arg(long, value_name = "ID")]
    pub partner_candidate: Option<String>,

    /// Closing speeds, or a range, in place of the standing list: the partner has its --partner-speed of it, the
    /// vehicle the rest; without one equal shares where both move [default: none]
    #[arg(long, value_name = "SPEED", value_delimiter = ',')]
    pub closing_speed: Vec<String>,

    /// Occupant of the compartment, e.g. "stiffness=60kN/m slack=30mm force_limit=5kN", or "sensor=CHANNEL" on its
    /// chest, which the restraint is fitted to [default: none]
    #[arg(long, value_name = "RESTRAINT")]
    pub occupant: Option<Described>,

    /// Uncertainty of the impact speed, e.g. "0.1 km/h uniform" (half width) or "0.1 km/h normal" (standard deviation)
    /// [default: 0.1 km/h uniform]
    #[arg(long, value_name = "SPEED")]
    pub speed_uncertainty: Option<Uncertain<Speed>>,

    /// Uncertainty of the mass, likewise [default: 0 kg]
    #[arg(long, value_name = "MASS")]
    pub mass_uncertainty: Option<Uncertain<Mass>>,

    /// What tests of the vehicle that were left out were missed by, root mean square in standard deviations of their
    /// predictions: above 1 it widens all intervals [default: none was left out]
    #[arg(long, value_name = "RATIO")]
    pub left_out: Option<f64>,

    /// Units of the printed table: si, or us (mph, in, lb) [default: si]
    #[arg(long, value_name = "UNITS", value_parser = ["si", "us"])]
    pub display: Option<String>,
}

/// Options with every default filled in.
#[derive(Debug, Serialize)]
pub struct Settings {
    /// Rising; none: that of the test.
    pub speeds_m_per_s: Vec<f64>,
    /// Those of them that were asked for beside the standing list.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub asked_speeds_m_per_s: Vec<f64>,
    /// As given; none: that of the test.
    pub masses_kg: Vec<f64>,
    pub candidates: Vec<String>,
    /// Standard deviations.
    pub speed_deviation_m_per_s: f64,
    pub mass_deviation_kg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<f64>,
    /// The digests of its artifacts are among those of the inputs.
    #[serde(skip)]
    pub against: Option<PathBuf>,
    /// Units of the printed table.
    #[serde(skip)]
    pub display: Display,
    /// Whether a range came without a unit.
    #[serde(skip)]
    pub taken_as_km_per_h: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub closing_speeds_m_per_s: Vec<f64>,
    #[serde(skip_serializing_if = "PartnerSettings::is_wall")]
    pub partner: PartnerSettings,
    /// The occupant as it was stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub occupant: Option<OccupantSettings>,
}

/// The occupant, and its words.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct OccupantSettings {
    pub words: String,
    #[serde(skip)]
    pub restraint: Restraint,
}

impl Settings {
    /// The settings with defaults filled in and values checked.
    pub fn new(options: Options) -> anyhow::Result<Self> {
        let closing = read_speeds(&options.closing_speed)?;
        // Closing speeds stand in place of the standing list.
        let standing = if closing.0.is_empty() { &options.speeds[..] } else { &[] };
        let both: Vec<String> = standing.iter().chain(&options.speed).cloned().collect();
        let all = read_speeds(&both)?;
        // Without a standing list nothing has to be told apart.
        let asked = if standing.is_empty() { Vec::new() } else { read_speeds(&options.speed)?.0 };
        let masses_kg: Vec<f64> = options.mass.iter().map(|mass| mass.si()).collect();
        if let Some(mass) = masses_kg.iter().find(|mass| !(**mass > 0.0 && mass.is_finite())) {
            return Err(Usage::new(format!("mass is {mass} kg, expected a positive mass")).into());
        }
        let of_speed = |speed: Uncertain<Speed>| speed.distribution.deviation(speed.size.si());
        if let Some(ratio) = options.left_out.filter(|ratio| !(*ratio >= 0.0 && ratio.is_finite())) {
            return Err(Usage::new(format!("--left-out is {ratio}, expected zero or more")).into());
        }
        let mass = options.mass_uncertainty.map_or(0.0, |mass| mass.distribution.deviation(mass.size.si()));
        Ok(Self {
            speeds_m_per_s: all.0,
            asked_speeds_m_per_s: asked,
            closing_speeds_m_per_s: closing.0,
            display: options.display.as_deref().map(read_display).transpose()?.unwrap_or_default(),
            taken_as_km_per_h: all.1 || closing.1,
            partner: partner(&options)?,
            occupant: options.occupant.as_ref().map(occupant).transpose()?,
            masses_kg,
            candidates: options.candidate,
            against: options.against,
            speed_deviation_m_per_s: options.speed_uncertainty.map_or(Spread::USUAL_SPEED.deviation(), of_speed),
            mass_deviation_kg: mass,
            left_out: options.left_out,
        })
    }

    /// Whether a speed was asked for beside the standing ones.
    pub fn asks_for(&self, speed_m_per_s: f64) -> bool {
        self.asked_speeds_m_per_s.iter().any(|asked| (asked - speed_m_per_s).abs() < SAME)
    }

    /// Whether a person asked for an impact at this speed: by the speed, or, where none was asked for beside the
    /// standing ones, by a mass, a partner or a closing speed.
    pub fn is_asked(&self, speed_m_per_s: f64) -> bool {
        if self.asked_speeds_m_per_s.is_empty() {
            return !self.masses_kg.is_empty() || !self.closing_speeds_m_per_s.is_empty() || !self.partner.is_wall();
        }
        self.asks_for(speed_m_per_s)
    }

    /// How uncertain the inputs are.
    pub fn inputs(&self) -> Inputs {
        Inputs {
            speed_m_per_s: self.speed_deviation_m_per_s,
            mass_kg: self.mass_deviation_kg,
            left_out: self.left_out.unwrap_or(0.0),
        }
    }
}

fn read_display(text: &str) -> Result<Display, Usage> {
    text.parse().map_err(|error| Usage::new(format!("display: {error}")))
}

/// All speeds of several texts, rising, and whether a range came without a unit.
fn read_speeds(texts: &[String]) -> Result<(Vec<f64>, bool), Usage> {
    let (mut all, mut taken_as_km_per_h) = (Vec::new(), false);
    for text in texts {
        let (speeds, without_unit) = speeds(text)?;
        all.extend(speeds);
        taken_as_km_per_h |= without_unit;
    }
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < SAME);
    Ok((all, taken_as_km_per_h))
}

fn partner(options: &Options) -> anyhow::Result<PartnerSettings> {
    if let Some(mass) = options.partner_mass.filter(|mass| !(mass.si() > 0.0 && mass.si().is_finite())) {
        return Err(Usage::new(format!("the partner's mass is {mass}, expected a positive mass")).into());
    }
    PartnerSettings::new(
        options.partner.as_ref(),
        options.partner_speed.map(Speed::si),
        options.partner_mass,
        options.partner_candidate.clone(),
    )
}

fn occupant(described: &Described) -> Result<OccupantSettings, Usage> {
    let restraint = restraint(&described.read("occupant", "occupant")?)?;
    let words = match &restraint {
        Restraint::Stated(occupant) => words(occupant),
        Restraint::OfSensor(channel, mass_kg) => format!("{mass_kg:.0} kg, restraint fitted to {channel}"),
    };
    Ok(OccupantSettings { words, restraint })
}

/// Speeds of a range at most.
const MOST: f64 = 1000.0;

/// `64 km/h`, or a range with both ends and a step: `20..80/5 km/h`, `20km/h..80km/h/5km/h`. The unit of a range may
/// stand once; one without any is in km/h, the second thing returned says so. SI, rising.
///
/// Errors: a number without unit, a speed that is not positive, a step that leads nowhere.
pub fn speeds(text: &str) -> Result<(Vec<f64>, bool), Usage> {
    let Some((low, rest)) = text.split_once("..") else { return Ok((vec![positive(speed(text)?)?], false)) };
    let wrong = || {
        Usage::new(format!("{text:?} is no range of speeds")).hint("both ends and a step: 20..80/5 km/h, with its unit")
    };
    // A unit has a stroke of its own: the last stroke with a number behind it divides end and step.
    let strokes = rest.match_indices('/').map(|(at, _)| (&rest[..at], &rest[at + 1..]));
    let is_number = |text: &str| text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let (high, step) = strokes.rev().find(|(_, step)| is_number(step)).ok_or_else(wrong)?;
    let units: Vec<&str> = [low, high, step].into_iter().map(unit).filter(|unit| !unit.is_empty()).collect();
    let stated = units.first().copied();
    let with_unit = |text: &str| {
        let unit = if unit(text).is_empty() { stated.unwrap_or("km/h") } else { "" };
        speed(&format!("{} {unit}", text.trim()))
    };
    let (low, high, step) = (positive(with_unit(low)?)?, positive(with_unit(high)?)?, positive(with_unit(step)?)?);
    let count = ((high - low) / step + 1e-9).floor();
    if !(0.0..MOST).contains(&count) {
        return Err(wrong());
    }
    Ok(((0..=count as usize).map(|k| low + k as f64 * step).collect(), stated.is_none()))
}

/// What stands behind the number.
fn unit(text: &str) -> &str {
    text.trim().trim_start_matches(|c: char| c.is_ascii_digit() || ".+-".contains(c)).trim()
}

fn speed(text: &str) -> Result<f64, Usage> {
    let speed: Speed = text.trim().parse().map_err(|error| Usage::new(format!("speed {text:?}: {error}")))?;
    Ok(speed.si())
}

fn positive(speed: f64) -> Result<f64, Usage> {
    if speed > 0.0 && speed.is_finite() {
        return Ok(speed);
    }
    Err(Usage::new(format!("an impact at {speed} m/s is none, expected a positive speed")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_of_the_pipeline_and_of_the_flag_are_one_rising_list() {
        let options = Options {
            speeds: vec!["56 km/h".to_owned(), "40 km/h".to_owned()],
            speed: vec!["36..40/2 km/h".to_owned()],
            ..Options::default()
        };
        let settings = Settings::new(options).unwrap();
        let km_per_h: Vec<f64> = settings.speeds_m_per_s.iter().map(|v| (v * 3.6).round()).collect();
        assert_eq!(km_per_h, [36.0, 38.0, 40.0, 56.0]);
        let asked: Vec<bool> = settings.speeds_m_per_s.iter().map(|v| settings.asks_for(*v)).collect();
        assert_eq!(asked, [true, true, true, false]);
        assert!((settings.inputs().speed_m_per_s - 0.1 / 3.6 / 3.0_f64.sqrt()).abs() < 1e-15);
        assert!(Settings::new(Options { mass: vec![Mass::from_si(0.0)], ..Options::default() }).is_err());
    }

    fn km_per_h(text: &str) -> Vec<f64> {
        speeds(text).unwrap().0.iter().map(|v| (v * 3.6 * 1e6).round() / 1e6).collect()
    }

    #[test]
    fn a_range_has_its_unit_once_or_everywhere() {
        assert_eq!(km_per_h("64km/h"), [64.0]);
        for text in ["20..30/5 km/h", "20km/h..30km/h/5km/h", "20 .. 30 km/h / 5", "20..30/5"] {
            assert_eq!(km_per_h(text), [20.0, 25.0, 30.0], "{text}");
        }
        assert_eq!(km_per_h("10..12/1 m/s"), [36.0, 39.6, 43.2]);
        assert_eq!(km_per_h("20..33/5 km/h").len(), 3);
        assert!(speeds("20..30/5").unwrap().1 && !speeds("20..30/5 km/h").unwrap().1);
    }

    #[test]
    fn what_is_no_speed_is_refused() {
        for text in ["64", "0 km/h", "-5 km/h", "20..30 km/h", "30..20/5 km/h", "20..30/0 km/h", "20..1e9/1 m/s", ".."]
        {
            assert!(speeds(text).is_err(), "{text}");
        }
    }
}
