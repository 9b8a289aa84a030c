//! What the vehicle runs into: the wall, a moving barrier, or the vehicle of another run.

use std::path::PathBuf;

use crumple_predict::{Partner, Scenario};
use crumple_signal::value::{Mass, Speed};
use crumple_stage::records::{CandidateV1, RecommendationV1};
use crumple_stage::{InputDigest, Inputs, Refused, Usage, load_artifacts};
use serde::Serialize;

use crate::stage::barriers::{Barrier, BarrierTable, barrier};
use crate::stage::described::Described;
use crate::stage::inputs::{candidates, named, tested};

/// The partner as it was stated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartnerSettings {
    /// What it is; of a vehicle the digests of its artifacts are among those of the inputs.
    what: String,
    /// Its speed towards the vehicle, m/s, where one was stated.
    speed_m_per_s: Option<f64>,
    mass_kg: Option<f64>,
    candidate: Option<String>,
    #[serde(skip)]
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Wall,
    Barrier(Barrier),
    Run(PathBuf),
}

/// A partner that was read, and what to call it.
#[derive(Debug)]
pub struct ReadPartner {
    pub partner: Partner,
    /// `None`: the wall.
    pub words: Option<String>,
    /// Candidate of its run.
    pub candidate: Option<String>,
}

impl PartnerSettings {
    /// From what was stated. Errors: a folder or barrier that does not exist, numbers that make no barrier, a speed or
    /// mass of the wall.
    pub fn new(
        described: Option<&Described>,
        speed: Option<f64>,
        mass: Option<Mass>,
        candidate: Option<String>,
    ) -> anyhow::Result<Self> {
        let wall = Self {
            what: "wall".to_owned(),
            speed_m_per_s: speed,
            mass_kg: mass.map(Mass::si),
            candidate,
            kind: Kind::Wall,
        };
        let table: BarrierTable = match described {
            Some(described) => described.read("partner", "barrier")?,
            None => BarrierTable { barrier: Some("wall".to_owned()), ..BarrierTable::default() },
        };
        let name = table.barrier.clone().unwrap_or_else(|| "barrier".to_owned());
        if name == "wall" {
            if wall.speed_m_per_s.is_some() || wall.mass_kg.is_some() || wall.candidate.is_some() {
                let problem = "a wall has no speed, no mass and no candidate";
                return Err(Usage::new(problem).hint("--partner runs/NAME-OF-RECORD/NAME-OF-PIPELINE").into());
            }
            return Ok(wall);
        }
        let speed_m_per_s = speed.or(table.speed.map(Speed::si));
        let folder = PathBuf::from(&name);
        if folder.is_dir() {
            let settings = Self { what: "vehicle".to_owned(), speed_m_per_s, kind: Kind::Run(folder), ..wall };
            return Ok(Self { mass_kg: settings.mass_kg.or(table.mass.map(Mass::si)), ..settings });
        }
        if wall.candidate.is_some() {
            return Err(Usage::new("a barrier has no candidates").hint("--partner-candidate is of another run").into());
        }
        let mass = mass.or(table.mass);
        let barrier = barrier(&BarrierTable { mass, ..table })?;
        Ok(Self { what: barrier.words.clone(), speed_m_per_s, kind: Kind::Barrier(barrier), ..wall })
    }

    /// Whether it is the wall of the test.
    pub fn is_wall(&self) -> bool {
        self.kind == Kind::Wall
    }

    /// Whether the partner comes as fast as the vehicle if nothing is said.
    fn comes_as_fast(&self) -> bool {
        match &self.kind {
            Kind::Wall => false,
            Kind::Barrier(barrier) => barrier.comes_as_fast,
            Kind::Run(_) => true,
        }
    }

    /// The impact at a speed of the vehicle, m/s. Errors: the partner runs away.
    pub fn at_speed(&self, speed_m_per_s: f64, mass_kg: Option<f64>) -> Result<Scenario, Usage> {
        let usual = if self.comes_as_fast() { speed_m_per_s } else { 0.0 };
        let partner_speed_m_per_s = self.speed_m_per_s.unwrap_or(usual);
        if speed_m_per_s + partner_speed_m_per_s <= 0.0 {
            let [own, ahead] = [speed_m_per_s, -partner_speed_m_per_s].map(|speed| 3.6 * speed);
            return Err(Usage::new(format!("at {own:.1} km/h a partner {ahead:.1} km/h ahead is never reached")));
        }
        Ok(Scenario { speed_m_per_s, partner_speed_m_per_s, mass_kg })
    }

    /// The impact at a closing speed, m/s: the partner has its own speed of it, the vehicle the rest; equal shares
    /// where nothing is said and both move. Errors: the vehicle would go backwards.
    pub fn at_closing_speed(&self, closing_m_per_s: f64, mass_kg: Option<f64>) -> Result<Scenario, Usage> {
        let usual = if self.comes_as_fast() { 0.5 * closing_m_per_s } else { 0.0 };
        let partner_speed_m_per_s = self.speed_m_per_s.unwrap_or(usual);
        let speed_m_per_s = closing_m_per_s - partner_speed_m_per_s;
        if speed_m_per_s < -1e-9 {
            let [closing, partner] = [closing_m_per_s, partner_speed_m_per_s].map(|speed| 3.6 * speed);
            let problem =
                format!("a partner at {partner:.1} km/h leaves nothing of a closing speed of {closing:.1} km/h");
            return Err(Usage::new(problem));
        }
        Ok(Scenario { speed_m_per_s: speed_m_per_s.max(0.0), partner_speed_m_per_s, mass_kg })
    }

    /// Reads the run of another vehicle, or the model of its several tests. Errors: artifacts that are missing or
    /// cannot be read, no candidate for predictions.
    pub fn read(&self) -> anyhow::Result<(ReadPartner, Vec<InputDigest>)> {
        let folder = match &self.kind {
            Kind::Wall => {
                return Ok((ReadPartner { partner: Partner::Wall, words: None, candidate: None }, Vec::new()));
            }
            Kind::Barrier(barrier) => {
                let (partner, words) = (Partner::Barrier(barrier.structure.clone()), Some(barrier.words.clone()));
                return Ok((ReadPartner { partner, words, candidate: None }, Vec::new()));
            }
            Kind::Run(folder) => folder,
        };
        let [integrated, solved] = ["3-integrate.mcap", "5-parameter-solve.mcap"].map(|name| folder.join(name));
        if !solved.is_file() {
            let problem = format!("the partner's run has no {}", solved.display());
            return Err(Usage::new(problem)
                .hint("--partner runs/NAME-OF-RECORD/NAME-OF-PIPELINE, or runs/together/NAME")
                .into());
        }
        // One model of several tests has no motion of its own.
        let paths: Vec<PathBuf> = [integrated, solved].into_iter().filter(|path| path.is_file()).collect();
        let loaded = load_artifacts(&paths)?;
        Ok((self.vehicle(&loaded.input)?, loaded.digests))
    }

    fn vehicle(&self, input: &Inputs) -> anyhow::Result<ReadPartner> {
        let test = input.test()?;
        let tested = tested(input)?.ok_or_else(|| Refused::new("the partner's test has no impact speed"))?;
        let records: Vec<(String, CandidateV1)> = input.records("/parameters/")?;
        let choice: Option<RecommendationV1> = input.record_if("/recommendation")?;
        let candidates = candidates(&records, choice.as_ref());
        let asked: Vec<String> = self.candidate.iter().cloned().collect();
        let named = named(&candidates, &records, choice.as_ref(), &asked)?;
        let chosen = named.first().ok_or_else(|| {
            Refused::new("none of the partner's candidates is for predictions")
                .hint("name one with --partner-candidate")
        })?;
        let id = candidates[chosen.place].id.clone();
        Ok(ReadPartner {
            words: Some(test.title),
            candidate: Some(id),
            partner: Partner::Vehicle { place: chosen.place, candidates, test: tested, mass_kg: self.mass_kg },
        })
    }
}
