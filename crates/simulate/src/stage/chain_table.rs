//! `[simulate.chain.<name>]`: a chain of masses that a person states.

use std::collections::BTreeMap;

use crumple_lumped::{Chain, LumpedError, ParameterKind, PiecewiseLinear};
use crumple_signal::value::Speed;
use crumple_stage::records::CandidateV1;
use crumple_stage::{
    LawOfTable, MassOfTable, NumberReaders, Usage, check_keys, check_name, read_masses, table_at, typed, unknown_name,
};
use serde::Serialize;
use toml::{Table, Value};

use crate::stage::drive::Driven;

const CHAIN_KEYS: [&str; 5] = ["masses", "speed", "drive", "drive_wave", "drive_mass"];

const READERS: NumberReaders<f64, f64> = NumberReaders {
    mass: |place, value, si| si(place, value),
    coefficient: |place, value, si| si(place, value),
    no_damping: 0.0,
    example: "masses = [{ name = \"engine\", mass = \"200 kg\", stiffness = \"900 kN/m\", damping = \"8 kN*s/m\" }, \
        ...], from the barrier on",
    knots_example: "stiffness = [[\"0 mm\", \"350 kN/m\"], [\"200 mm\", \"150 kN/m\"]]",
};

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

/// A mass with the spring and damper in front of it.
#[derive(Debug, Serialize)]
struct MassSettings {
    name: String,
    mass_kg: f64,
    stiffness_n_per_m: Law,
    damping_n_s_per_m: Law,
}

/// A coefficient: one value, or values at knots (m or m/s).
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Law {
    Constant(f64),
    Knots(Vec<(f64, f64)>),
}

impl Law {
    /// Errors: knots that make no curve.
    fn new(place: &str, read: LawOfTable<f64>) -> Result<Self, Usage> {
        let law = match read {
            LawOfTable::Constant(value) => Self::Constant(value),
            LawOfTable::Knots(points) => Self::Knots(points),
        };
        law.curve().map_err(|error| Usage::new(format!("{place}: {error}")))?;
        Ok(law)
    }

    fn curve(&self) -> Result<PiecewiseLinear, LumpedError> {
        match self {
            Self::Constant(value) => Ok(PiecewiseLinear::constant(*value)),
            Self::Knots(points) => PiecewiseLinear::new(points),
        }
    }

    /// Named as parameters of a candidate: `k2_n_per_m`, or `k2_knot1_m` and `k2_knot1_n_per_m`. A knot at zero is no
    /// parameter.
    fn parameters(&self, symbol: &str, place: ParameterKind, value: ParameterKind, out: &mut BTreeMap<String, f64>) {
        let (place, unit) = (place.unit_in_name(), value.unit_in_name());
        match self {
            Self::Constant(value) => {
                out.insert(format!("{symbol}_{unit}"), *value);
            }
            Self::Knots(points) => {
                for (j, (knot, value)) in (1..).zip(points) {
                    if *knot > 0.0 {
                        out.insert(format!("{symbol}_knot{j}_{place}"), *knot);
                    }
                    out.insert(format!("{symbol}_knot{j}_{unit}"), *value);
                }
            }
        }
    }
}

impl ChainSettings {
    /// Reads `[simulate.chain.<name>]`; what it leaves out is moved as the stage's other models are.
    pub fn read(name: &str, table: &Value, stage: &Driven) -> anyhow::Result<Self> {
        let place = format!("[simulate.chain.{name}]");
        check_name(&place, name)?;
        let table = table_at(&place, table, "[simulate.chain.car] with masses = [...]")?;
        check_keys(&place, table, &CHAIN_KEYS)?;
        let masses: Vec<MassSettings> = (1..)
            .zip(read_masses(&place, table, &READERS)?)
            .map(|(number, mass)| MassSettings::new(&format!("{place}, mass {number}"), mass))
            .collect::<Result<_, Usage>>()?;
        let names: Vec<&str> = masses.iter().map(|mass| mass.name.as_str()).collect();
        let driven = own_drive(&place, table, &names)?.unwrap_or_else(|| stage.clone());
        let speed_m_per_s = table
            .get("speed")
            .map(|value| typed::<Speed>(&format!("{place}, speed"), value).map(Speed::si))
            .transpose()?;
        if speed_m_per_s.is_some() && driven.drive == "base" {
            return Err(Usage::new(format!("{place}: under a base motion a chain starts from rest"))
                .hint("leave speed out")
                .into());
        }
        if let Some(speed) = speed_m_per_s.filter(|speed| *speed <= 0.0) {
            return Err(Usage::new(format!("{place}: speed is {speed} m/s, expected a positive speed")).into());
        }
        let settings = Self { name: name.to_owned(), masses, speed_m_per_s, driven };
        settings.chain().map_err(|error| Usage::new(format!("{place}: {error}")))?;
        Ok(settings)
    }

    /// The chain it states.
    pub fn chain(&self) -> Result<Chain, LumpedError> {
        let springs: Vec<PiecewiseLinear> =
            self.masses.iter().map(|mass| mass.stiffness_n_per_m.curve()).collect::<Result<_, _>>()?;
        let dampers: Vec<PiecewiseLinear> =
            self.masses.iter().map(|mass| mass.damping_n_s_per_m.curve()).collect::<Result<_, _>>()?;
        let masses: Vec<f64> = self.masses.iter().map(|mass| mass.mass_kg).collect();
        Chain::new(&masses, &springs, &dampers)
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

    /// The record that stands beside those of solved candidates.
    pub fn candidate(&self, physical: bool) -> CandidateV1 {
        let mut parameters = BTreeMap::new();
        for (i, mass) in (1..).zip(&self.masses) {
            parameters.insert(format!("m{i}_kg"), mass.mass_kg);
            mass.stiffness_n_per_m.parameters(
                &format!("k{i}"),
                ParameterKind::Length,
                ParameterKind::Stiffness,
                &mut parameters,
            );
            mass.damping_n_s_per_m.parameters(
                &format!("c{i}"),
                ParameterKind::Rate,
                ParameterKind::Damping,
                &mut parameters,
            );
        }
        let names: Vec<&str> = self.masses.iter().map(|mass| mass.name.as_str()).collect();
        CandidateV1 {
            model: "chain".to_owned(),
            method: self.name.clone(),
            parameters,
            physical,
            equivalent_to: None,
            fit: None,
            uncertainty: None,
            notes: vec![
                format!("masses from the barrier on: {}", names.join(", ")),
                "given in the pipeline, not fitted to this record".to_owned(),
            ],
        }
    }
}

impl MassSettings {
    fn new(place: &str, read: MassOfTable<f64, f64>) -> Result<Self, Usage> {
        Ok(Self {
            name: read.name,
            mass_kg: read.mass_kg,
            stiffness_n_per_m: Law::new(&format!("{place}, stiffness"), read.stiffness_n_per_m)?,
            damping_n_s_per_m: Law::new(&format!("{place}, damping"), read.damping_n_s_per_m)?,
        })
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
    Driven::new(&format!("{place}: "), &drive, wave, number).map(Some)
}
