//! What the vehicle runs into: a moving barrier as it is described, or another vehicle's run.

use std::path::PathBuf;

use crate::{Partner, Scenario};
use crumple_lumped::{Extrapolation, ForceDeflection, Structure};
use crumple_signal::value::{Area, Force, Length, Mass, Pressure, Share, Speed};
use crumple_stage::records::{CandidateV1, RecommendationV1};
use crumple_stage::{InputDigest, Inputs, Refused, Usage, load_artifacts, unknown_name};
use serde::{Deserialize, Serialize};

use crate::stage::inputs::{candidates, named, tested};
use crate::stage::occupant::Described;

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

/// Deflection over which a plateau is reached, m, if nothing is said.
const RAMP_M: f64 = 0.003;
/// Share of its depth at which honeycomb is compacted: 70 to 80 %, well known, not from a source at hand.
const COMPACTED: f64 = 0.75;

/// What a person may say of a moving barrier.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BarrierTable {
    /// Name of a barrier that is known, or `barrier`.
    pub barrier: Option<String>,
    pub mass: Option<Mass>,
    /// Its speed towards the vehicle.
    pub speed: Option<Speed>,
    /// Of the face that is hit.
    pub area: Option<Area>,
    /// Crush strength of the face.
    pub pressure: Option<Pressure>,
    /// Force of the plateau, in place of area and pressure.
    pub force: Option<Force>,
    /// Deflection at which the face is compacted.
    pub depth: Option<Length>,
    /// Deflection over which the plateau is reached.
    pub ramp: Option<Length>,
    /// Share of the face that is hit.
    pub overlap: Option<Share>,
    /// Force over deflection, in place of a plateau: `"0.1 m: 200 kN"`, rising, without that at zero.
    pub knots: Option<Knots>,
}

/// Knots as a list, or in one text with commas.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum Knots {
    Text(String),
    List(Vec<String>),
}

/// A barrier that can be run into.
#[derive(Debug, Clone, PartialEq)]
pub struct Barrier {
    pub structure: Structure,
    /// What it is, and how sure its numbers are.
    pub words: String,
    /// Whether it comes as fast as the vehicle if nothing is said, as its protocol has it.
    pub comes_as_fast: bool,
}

/// A barrier that is known by name.
struct Known {
    name: &'static str,
    mass_kg: f64,
    /// Knots of the whole face, m and N; empty: the size of the face is to be stated.
    knots: &'static [(f64, f64)],
    pressure_pa: Option<f64>,
    comes_as_fast: bool,
    source: &'static str,
}

/// Moving barriers whose numbers have a source.
const KNOWN: [Known; 2] = [
    Known {
        name: "mpdb",
        mass_kg: 1400.0,
        // Blocks of 0.568 m x 1 m: 250 mm at 0.342 MPa, 450 mm rising to 1.711 MPa, 90 mm at that.
        knots: &[(RAMP_M, 194_256.0), (0.25, 194_256.0), (0.7, 971_848.0), (0.7 + COMPACTED * 0.09, 971_848.0)],
        pressure_pa: None,
        comes_as_fast: true,
        source: "mass, sizes and strengths: maker's sheets of the face; compacted at 75 % of the rear block: well \
                 known, without a source at hand",
    },
    Known {
        name: "fmvss-214",
        mass_kg: 1367.0,
        knots: &[],
        pressure_pa: Some(310e3),
        comes_as_fast: false,
        source: "mass and 45 psi (310 kPa): 49 CFR 587, of which only the title was seen; its bumper of 245 psi is \
                 left out",
    },
];

/// Builds a barrier from what was said of it. Errors: a name that is not known, numbers that make no face.
pub fn barrier(table: &BarrierTable) -> anyhow::Result<Barrier> {
    let name = table.barrier.as_deref().unwrap_or("barrier");
    let known = KNOWN.iter().find(|known| known.name == name);
    if known.is_none() && name != "barrier" {
        let names: Vec<&str> = KNOWN.iter().map(|known| known.name).chain(["barrier", "wall"]).collect();
        return Err(unknown_name(&format!("no run folder and no barrier is called {name:?}"), name, &names));
    }
    let mass = table.mass.map(Mass::si).or(known.map(|known| known.mass_kg));
    let mass_kg = mass.filter(|mass| *mass > 0.0).ok_or_else(|| {
        Usage::new("a moving barrier needs a positive mass").hint("--partner \"barrier mass=1400kg\"")
    })?;
    let share = table.overlap.map_or(1.0, Share::si);
    if !(share > 0.0 && share <= 1.0) {
        return Err(Usage::new(format!("the barrier's overlap is {:.0} %, expected up to 100 %", 100.0 * share)).into());
    }
    let knots = knots(table, known)?;
    let mut words = format!("{name}, {mass_kg:.0} kg");
    let structure = if knots.is_empty() {
        words.push_str(", rigid");
        Structure::new(vec![mass_kg], Vec::new())
    } else {
        let scaled: Vec<(f64, f64)> =
            [(0.0, 0.0)].into_iter().chain(knots.iter().map(|(d, force)| (*d, share * force))).collect();
        let told: Vec<String> =
            scaled[1..].iter().map(|(d, force)| format!("{:.0} kN at {:.0} mm", 1e-3 * force, 1e3 * d)).collect();
        words.push_str(&format!(", face {}", told.join(", ")));
        face(&scaled).and_then(|face| Structure::row(&[mass_kg], [vec![face.into()]]))
    };
    if let Some(known) = known {
        words.push_str(&format!(" ({})", known.source));
    }
    let structure = structure.map_err(|error| Usage::new(format!("the barrier's face: {error}")))?;
    Ok(Barrier { structure, words, comes_as_fast: known.is_some_and(|known| known.comes_as_fast) })
}

/// The curve of a face that never falls: beyond its last knot as steep as it begins, for it is compacted, and back
/// along that slope.
fn face(knots: &[(f64, f64)]) -> Result<ForceDeflection, crumple_lumped::LumpedError> {
    let slope = |pair: &[(f64, f64)]| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
    let steepest = knots.windows(2).map(slope).fold(0.0, f64::max);
    ForceDeflection::new(knots, steepest)?.with_extrapolation(Extrapolation::Stiffness(steepest))
}

/// Knots of the whole face without that at zero; none: rigid.
fn knots(table: &BarrierTable, known: Option<&Known>) -> Result<Vec<(f64, f64)>, Usage> {
    if let Some(knots) = &table.knots {
        let texts: Vec<&str> = match knots {
            Knots::Text(text) => text.split(',').collect(),
            Knots::List(list) => list.iter().map(String::as_str).collect(),
        };
        return texts.into_iter().map(knot).collect();
    }
    let pressure = table.pressure.map(Pressure::si).or(known.and_then(|known| known.pressure_pa));
    let by_pressure = pressure.zip(table.area.map(Area::si)).map(|(pressure, area)| pressure * area);
    let force = table.force.map(Force::si).or(by_pressure);
    match (force, table.depth.map(Length::si)) {
        (Some(force), Some(depth)) => {
            let ramp = table.ramp.map_or(RAMP_M, Length::si);
            if !(force > 0.0 && ramp > 0.0 && depth > ramp) {
                let problem = "the barrier's face needs a positive force and a depth beyond its ramp";
                return Err(Usage::new(problem).hint("ramp=3mm depth=250mm"));
            }
            Ok(vec![(ramp, force), (depth, force)])
        }
        _ if known.is_some_and(|known| !known.knots.is_empty()) && force.is_none() => {
            Ok(known.map_or_else(Vec::new, |known| known.knots.to_vec()))
        }
        (None, None) if pressure.is_none() && table.area.is_none() => Ok(Vec::new()),
        _ => Err(Usage::new("the barrier's face is not complete").hint(
            "area=0.57m2 pressure=342kPa depth=250mm, or force=194kN depth=250mm, or knots=3mm:194kN,250mm:194kN",
        )),
    }
}

/// `250 mm: 194 kN`.
fn knot(text: &str) -> Result<(f64, f64), Usage> {
    let wrong = |problem: String| Usage::new(format!("knot {text:?} of the barrier's face: {problem}"));
    let (at, force) = text.split_once(':').ok_or_else(|| wrong("expected deflection: force".to_owned()))?;
    let at: Length = at.trim().parse().map_err(|error| wrong(format!("{error}")))?;
    let force: Force = force.trim().parse().map_err(|error| wrong(format!("{error}")))?;
    Ok((at.si(), force.si()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::occupant::Described;

    fn read(text: &str) -> anyhow::Result<Barrier> {
        barrier(&Described::Text(text.to_owned()).read("partner", "barrier")?)
    }

    fn curve(barrier: &Barrier) -> ForceDeflection {
        match &barrier.structure.connections()[0].element {
            crumple_lumped::Element::ForceDeflection(curve) => curve.clone(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_plateau_is_area_times_pressure_and_then_steep() {
        let face = curve(&read("barrier mass=1400kg area=0.5m2 pressure=0.4MPa depth=250mm").unwrap());
        for (deflection, force) in [(0.0015, 1e5), (0.003, 2e5), (0.25, 2e5), (0.2515, 3e5)] {
            assert!((face.static_force_n(deflection) - force).abs() < 1e-6 * force, "{deflection}");
        }
        let half = curve(&read("barrier mass=1400kg force=200kN depth=250mm overlap=50%").unwrap());
        assert!((half.static_force_n(0.1) - 1e5).abs() < 1e-6);
    }

    #[test]
    fn barriers_that_are_known_say_how_sure_they_are() {
        let mpdb = read("mpdb").unwrap();
        assert!(mpdb.comes_as_fast && mpdb.words.contains("maker's sheets"), "{}", mpdb.words);
        // 0.568 m2 at 0.342 and 1.711 MPa.
        assert!((curve(&mpdb).static_force_n(0.2) - 0.568 * 0.342e6).abs() < 1.0);
        assert!((curve(&mpdb).static_force_n(0.72) - 0.568 * 1.711e6).abs() < 1.0);
        assert!(read("fmvss-214").is_err());
        assert!(read("fmvss-214 area=0.5m2 depth=400mm").is_ok());
        assert!(read("mdbp").unwrap_err().to_string().contains("\"mdbp\""));
    }

    #[test]
    fn a_barrier_without_a_face_is_rigid_and_one_with_half_a_face_is_refused() {
        assert!(read("barrier mass=1400kg").unwrap().structure.connections().is_empty());
        for text in ["barrier", "barrier mass=0kg", "barrier mass=1t area=0.5m2", "barrier mass=1t force=1kN depth=1mm"]
        {
            assert!(read(text).is_err(), "{text}");
        }
        assert!(read("barrier mass=1t knots=3mm:2kN,2mm:3kN").is_err());
        assert_eq!(curve(&read("barrier mass=1t knots=3mm:2kN,200mm:3kN").unwrap()).knots().len(), 3);
    }
}
