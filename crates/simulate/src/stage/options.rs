//! Flags, pipeline keys and `[simulate.chain.<name>]` of the stage, and the settings they come to.

use clap::ValueEnum;
use crumple_lumped::{Chain, LumpedError, PiecewiseLinear};
use crumple_signal::value::{Speed, Time};
use crumple_stage::records::CandidateV1;
use crumple_stage::{MassOfTable, NumberOfTable, TakenNumbers, Usage, read_chain, typed, unknown_name};
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::stage::drive::{Drive, Driven};

/// Flags and keys; what is not given has the default named in its text.
#[derive(Debug, Default, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// End of the compared window after time zero [default: dynamic crush of the test, or the end of a record without
    /// one]
    #[arg(long, value_name = "TIME")]
    pub to: Option<Time>,

    /// Keep the elastoplastic model on the barrier after rebound, where it oscillates; else it leaves the barrier
    /// [default: false]
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub stay_attached: Option<bool>,

    /// What moves the models: impact (the impact speed), force (a waveform in N), base (acceleration of the barrier, a
    /// waveform or a sled pulse), pulse-as-force (impact speed, and mass times measured acceleration on the front mass:
    /// the transfer-function paper's simulation, circular). Force and base start from rest [default: impact]
    #[arg(long, value_name = "NAME", hide_possible_values = true)]
    pub drive: Option<Drive>,

    /// Waveform for --drive force or base, by its id, e.g. barrier/force; for base also a pulse: "half-sine 20g 90ms"
    /// or "haversine 20g 90ms" (peak, duration), "triangle 24g 35ms 100ms" (peak, time of it, duration), positive in
    /// the direction of crush
    #[arg(long, value_name = "ID")]
    pub drive_wave: Option<String>,

    /// Mass that --drive force acts on, from 1 at the barrier [default: 1]
    #[arg(long, value_name = "NUMBER")]
    pub drive_mass: Option<usize>,

    /// Chains of masses stated in the pipeline file, `[simulate.chain.<name>]`, simulated beside the candidates.
    #[arg(skip)]
    pub chain: Table,
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
        let driven =
            Driven::new("", options.drive.unwrap_or_default(), options.drive_wave, options.drive_mass.unwrap_or(1))?;
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

/// Keys beside the masses.
const KEYS: [&str; 4] = ["speed", "drive", "drive_wave", "drive_mass"];

/// A chain with every default filled in, in SI.
#[derive(Debug, Serialize)]
pub struct ChainSettings {
    pub name: String,
    masses: Vec<MassSettings>,
    /// None: the impact speed of the test, or rest under a force or base motion.
    pub speed_m_per_s: Option<f64>,
    #[serde(flatten)]
    pub driven: Driven,
}

/// A mass with the spring and damper in front of it; coefficients at knots, m or m/s, one at zero for a constant.
#[derive(Debug, Serialize)]
struct MassSettings {
    name: String,
    mass_kg: f64,
    stiffness_n_per_m: Vec<(f64, f64)>,
    damping_n_s_per_m: Vec<(f64, f64)>,
}

impl ChainSettings {
    /// Reads `[simulate.chain.<name>]`; what it leaves out is moved as the stage's other models are.
    pub fn read(name: &str, table: &Value, stage: &Driven) -> anyhow::Result<Self> {
        let place = format!("[simulate.chain.{name}]");
        let (table, masses) = read_chain("simulate", name, table, &KEYS, TakenNumbers::Given)?;
        let masses: Vec<MassSettings> = masses.into_iter().map(MassSettings::from).collect();
        let names: Vec<&str> = masses.iter().map(|mass| mass.name.as_str()).collect();
        let driven = own_drive(&place, table, &names)?.unwrap_or_else(|| stage.clone());
        let speed_m_per_s = table
            .get("speed")
            .map(|value| typed::<Speed>(&format!("{place}, speed"), value).map(Speed::si))
            .transpose()?;
        if speed_m_per_s.is_some() && driven.drive == Drive::Base {
            return Err(Usage::new(format!("{place}: under a base motion a chain starts from rest"))
                .hint("leave speed out")
                .into());
        }
        if let Some(speed) = speed_m_per_s.filter(|speed| *speed <= 0.0) {
            return Err(Usage::new(format!("{place}: speed is {speed} m/s, expected a positive speed")).into());
        }
        for (number, mass) in (1..).zip(&masses) {
            for (law, points) in [("stiffness", &mass.stiffness_n_per_m), ("damping", &mass.damping_n_s_per_m)] {
                PiecewiseLinear::new(points)
                    .map_err(|error| Usage::new(format!("{place}, mass {number}, {law}: {error}")))?;
            }
        }
        let settings = Self { name: name.to_owned(), masses, speed_m_per_s, driven };
        settings.chain().map_err(|error| Usage::new(format!("{place}: {error}")))?;
        Ok(settings)
    }

    /// The chain it states.
    pub fn chain(&self) -> Result<Chain, LumpedError> {
        let laws = |points: fn(&MassSettings) -> &[(f64, f64)]| -> Result<Vec<PiecewiseLinear>, LumpedError> {
            self.masses.iter().map(|mass| PiecewiseLinear::new(points(mass))).collect()
        };
        let masses: Vec<f64> = self.masses.iter().map(|mass| mass.mass_kg).collect();
        Chain::new(&masses, &laws(|mass| &mass.stiffness_n_per_m)?, &laws(|mass| &mass.damping_n_s_per_m)?)
    }

    /// Its id among the candidates.
    pub fn id(&self) -> String {
        format!("chain/{}/1", self.name)
    }

    /// What moves it where it is not the impact of the test alone.
    pub fn words(&self) -> Option<String> {
        match (self.driven.words(), self.speed_m_per_s) {
            (Some(words), Some(speed)) => Some(format!(
                "{}, at {speed} m/s",
                words.replace(", from rest", "").replace("the impact speed", "a speed")
            )),
            (None, Some(speed)) => Some(format!("an impact at {speed} m/s, stated in the pipeline")),
            (words, None) => words,
        }
    }

    /// The mass an engine's sensor sits on, from 1: the one named after it, or the one next to the barrier. `None` for
    /// a single mass of another name: that is the compartment.
    pub fn engine(&self) -> Option<usize> {
        match self.masses.iter().position(|mass| mass.name.to_lowercase().contains("engine")) {
            Some(index) => Some(index + 1),
            None => (self.masses.len() > 1).then_some(1),
        }
    }

    /// The record of its chain, which stands beside those of solved candidates.
    pub fn candidate(&self, chain: &Chain) -> CandidateV1 {
        let names: Vec<&str> = self.masses.iter().map(|mass| mass.name.as_str()).collect();
        CandidateV1 {
            model: "chain".to_owned(),
            method: self.name.clone(),
            parameters: chain.parameters(),
            physical: chain.is_passive(),
            equivalent_to: None,
            fit: None,
            uncertainty: None,
            notes: vec![
                format!("masses from the barrier on: {}", names.join(", ")),
                "given in the pipeline, not fitted to this record".to_owned(),
            ],
            ..CandidateV1::default()
        }
    }
}

impl From<MassOfTable> for MassSettings {
    fn from(read: MassOfTable) -> Self {
        // The table takes given numbers only.
        let given = |number| if let NumberOfTable::Given(value) = number { value } else { f64::NAN };
        let law = |points: Vec<(f64, NumberOfTable)>| points.into_iter().map(|(knot, x)| (knot, given(x))).collect();
        Self {
            name: read.name,
            mass_kg: given(read.mass_kg),
            stiffness_n_per_m: law(read.stiffness_n_per_m),
            damping_n_s_per_m: law(read.damping_n_s_per_m),
        }
    }
}

/// The drive that a chain states for itself.
fn own_drive(place: &str, table: &Table, masses: &[&str]) -> anyhow::Result<Option<Driven>> {
    let text = |key: &str| match table.get(key) {
        None => Ok(None),
        Some(Value::String(text)) => Ok(Some(text.clone())),
        Some(_) => Err(Usage::new(format!("{place}: {key} is no text"))),
    };
    let (drive, wave, mass) = (text("drive")?, text("drive_wave")?, text("drive_mass")?);
    let Some(drive) = drive else {
        if wave.is_some() || mass.is_some() {
            return Err(Usage::new(format!("{place} has a drive_wave or drive_mass and no drive"))
                .hint("drive = \"force\" or \"base\"")
                .into());
        }
        return Ok(None);
    };
    let number = match &mass {
        None => 1,
        Some(name) => match masses.iter().position(|known| known == name) {
            Some(index) => index + 1,
            None => return Err(unknown_name(&format!("{place}: drive_mass {name:?} is no mass of it"), name, masses)),
        },
    };
    let names: Vec<String> = Drive::value_variants().iter().map(Drive::to_string).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let unknown = |_| unknown_name(&format!("{place}: unknown drive {drive:?}"), &drive, &names);
    let known = <Drive as ValueEnum>::from_str(&drive, false).map_err(unknown)?;
    Driven::new(&format!("{place}: "), known, wave, number).map(Some)
}
