//! The stiffness of a front: from runs of barrier tests, from tests that are typed, from a line, from A and B.

use std::path::{Path, PathBuf};

use crumple_artifact::Artifact;
use crumple_artifact::records::{DamageV1, MetricsV2, TestV1};
use crumple_metrics::{
    BarrierTest, CrushStiffness, DamageProfile, ImpactLine, ImpactLineError, NO_DAMAGE_SPEED_M_PER_S,
};
use crumple_signal::key_quantities::KM_PER_H_PER_M_PER_S;
use crumple_stage::{Refused, Usage, hint_for_a_run, refuse_a_mixture, results_of_an_earlier_run};
use serde::Serialize;

use super::typed::{Coefficients, Line, TEST};

/// What a stiffness is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum StiffnessSource {
    /// The metrics of one run.
    Run,
    /// Barrier tests, of runs or typed.
    Tests,
    /// b0 and b1, typed.
    Line,
    /// A and B, typed.
    Coefficients,
}

/// Where the speed without damage is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum NoDamageSpeedSource {
    /// The line of several tests.
    Fitted,
    /// Typed.
    Typed,
    /// That of the run.
    Run,
    /// 5 mph, the usual value where it is not known.
    Assumed,
}

/// A barrier test with its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NamedTest {
    pub(super) name: String,
    pub(super) test: BarrierTest,
}

/// The stiffness of a front.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrontStiffness {
    pub(super) line: ImpactLine,
    pub(super) coefficients: CrushStiffness,
    pub(super) source: StiffnessSource,
    pub(super) no_damage_speed: NoDamageSpeedSource,
    pub(super) tests: Vec<NamedTest>,
}

/// What of a stiffness was typed.
#[derive(Debug, Clone, Copy)]
pub(super) struct TypedStiffness<'a> {
    pub(super) runs: &'a [PathBuf],
    pub(super) tests: &'a [BarrierTest],
    pub(super) line: Option<Line>,
    pub(super) coefficients: Option<Coefficients>,
    pub(super) no_damage_speed_m_per_s: Option<f64>,
    /// Mass of the vehicle, kg.
    pub(super) mass_kg: Option<f64>,
    /// Width of its damage, m.
    pub(super) width_m: Option<f64>,
    /// What its flags begin with: `--` or `--other-`.
    pub(super) flag: &'static str,
    /// The line that was typed with all that it lacks.
    pub(super) completed: &'a str,
}

impl TypedStiffness<'_> {
    /// Whether anything says it.
    pub(super) fn is_stated(&self) -> bool {
        !self.runs.is_empty() || !self.tests.is_empty() || self.line.is_some() || self.coefficients.is_some()
    }

    /// Reads the runs, and makes the stiffness.
    pub(super) fn stiffness(&self) -> anyhow::Result<FrontStiffness> {
        let flag = self.flag;
        let is_of_tests = !self.runs.is_empty() || !self.tests.is_empty();
        let ways = [(is_of_tests, "tests"), (self.line.is_some(), "line"), (self.coefficients.is_some(), "stiffness")];
        let ways: Vec<&str> = ways.into_iter().filter(|(is_stated, _)| *is_stated).map(|(_, way)| way).collect();
        if ways.is_empty() {
            let choices = format!("{flag}from RUN, {flag}test, {flag}line or {flag}stiffness");
            let problem = format!("the stiffness is missing: it comes by {choices}");
            return Err(Usage::new(problem).hint(self.completed).into());
        }
        if let [first, more @ ..] = &ways[..]
            && !more.is_empty()
        {
            let problem = format!("the stiffness is stated in two ways: by {}", ways.join(" and by "));
            return Err(Usage::new(problem).hint(format!("keep that by {first}, and leave the other out")).into());
        }
        if let Some(line) = self.line {
            return self.by_line(line);
        }
        if let Some(Coefficients { a_n_per_m, b_n_per_m2 }) = self.coefficients {
            // A and B hold for any mass and width; b0 and b1 are those of this vehicle.
            let line =
                ImpactLine::from_coefficients(a_n_per_m, b_n_per_m2, self.mass_per_width("b0 and b1 of A and B")?);
            return front(line, StiffnessSource::Coefficients, NoDamageSpeedSource::Typed, Vec::new());
        }
        self.by_tests()
    }

    fn mass_per_width(&self, why: &str) -> Result<f64, Usage> {
        let missing = || Usage::new(format!("{why} need a mass and a width")).hint(self.completed);
        self.mass_kg.zip(self.width_m).map(|(mass, width)| mass / width).ok_or_else(missing)
    }

    /// The flags that it lacks.
    pub(super) fn missing(&self) -> Vec<String> {
        let [mass, width] = [self.mass_kg, self.width_m].map(|value| value.is_some());
        let known = [(self.is_stated(), "stiffness 55kN/m,400kN/m^2"), (mass, "mass 1400kg"), (width, "width 150cm")];
        known.iter().filter(|(is_known, _)| !is_known).map(|(_, flag)| format!("{}{flag}", self.flag)).collect()
    }

    fn by_line(&self, Line { b0_m_per_s, b1_per_s, mass_and_width }: Line) -> anyhow::Result<FrontStiffness> {
        let mass_per_width_kg_per_m = match mass_and_width {
            Some((mass, width)) => mass / width,
            None => self.mass_per_width("A and B of b0 and b1")?,
        };
        let line = ImpactLine { b0_m_per_s, b1_per_s, mass_per_width_kg_per_m, scatter: None };
        front(Some(line), StiffnessSource::Line, NoDamageSpeedSource::Typed, Vec::new())
    }

    fn by_tests(&self) -> anyhow::Result<FrontStiffness> {
        let runs = self.runs.iter().map(|run| RunTest::read(run)).collect::<anyhow::Result<Vec<_>>>()?;
        let held = self.no_damage_speed_m_per_s;
        if let ([run], [], None, Some((a, b))) = (&runs[..], self.tests, held, runs.first().and_then(|run| run.a_and_b))
        {
            let own = run.barrier_test().ok().map(|named| named.test.mass_kg / named.test.width_m);
            let mass_per_width = own.map_or_else(|| self.mass_per_width("b0 and b1 of this run"), Ok)?;
            let line = ImpactLine::from_coefficients(a, b, mass_per_width);
            let tests = run.barrier_test().ok().into_iter().collect();
            return front(line, StiffnessSource::Run, NoDamageSpeedSource::Run, tests);
        }
        let mut tests = runs.iter().map(RunTest::barrier_test).collect::<Result<Vec<_>, _>>()?;
        let named =
            |(index, test): (usize, &BarrierTest)| NamedTest { name: format!("typed test {}", index + 1), test: *test };
        tests.extend(self.tests.iter().enumerate().map(named));
        let is_repeated = |(k, named): &(usize, &NamedTest)| tests[..*k].iter().any(|other| other.test == named.test);
        if let Some((_, repeated)) = tests.iter().enumerate().find(is_repeated) {
            let problem = format!("{} has the values of a test before it", repeated.name);
            let hint = "give each test once: one that is there twice shows no scatter";
            return Err(Refused::new(problem).hint(hint).into());
        }
        let is_one = tests.len() == 1;
        let (b0, whose) = match (held, is_one) {
            (Some(typed), _) => (Some(typed), NoDamageSpeedSource::Typed),
            (None, true) => (Some(NO_DAMAGE_SPEED_M_PER_S), NoDamageSpeedSource::Assumed),
            (None, false) => (None, NoDamageSpeedSource::Fitted),
        };
        let by_profile = runs.first().filter(|_| is_one).zip(b0).and_then(|(run, b0)| run.line(b0));
        let line = match by_profile {
            Some(line) => line,
            None => {
                let all: Vec<BarrierTest> = tests.iter().map(|named| named.test).collect();
                ImpactLine::fit(&all, b0).map_err(|error| no_line(&error, &tests, self))?
            }
        };
        front(Some(line), StiffnessSource::Tests, whose, tests)
    }
}

fn front(
    line: Option<ImpactLine>,
    source: StiffnessSource,
    no_damage_speed: NoDamageSpeedSource,
    tests: Vec<NamedTest>,
) -> anyhow::Result<FrontStiffness> {
    let both = line.and_then(|line| Some((line, line.stiffness()?)));
    let impossible = || {
        Refused::new("these values give no stiffness: b1 and B must be above zero, b0 and A not below, all finite")
            .hint("check the units, e.g. 55kN/m,400kN/m^2 or 2.2m/s,25/s")
    };
    let (line, coefficients) = both.ok_or_else(impossible)?;
    Ok(FrontStiffness { line, coefficients, source, no_damage_speed, tests })
}

fn no_line(error: &ImpactLineError, tests: &[NamedTest], typed: &TypedStiffness<'_>) -> Refused {
    let flag = typed.flag;
    let of = tests.iter().map(|named| named.name.as_str()).collect::<Vec<_>>().join(", ");
    let hint = match error {
        ImpactLineError::NotPositive { .. } => format!("give its values by {flag}test {TEST}"),
        ImpactLineError::TooFew { .. } => format!("add a test by {flag}from RUN or {flag}test {TEST}"),
        ImpactLineError::NotRising { .. } => {
            "look whether all tests are of this front, over its whole width".to_owned()
        }
        ImpactLineError::SameCrush | ImpactLineError::NegativeSpeed { .. } => {
            format!("state the speed without damage: {} --no-damage-speed 8km/h", typed.completed)
        }
    };
    Refused::new(format!("{of}: {error}")).expected("tests of one front at different speeds").hint(hint)
}

// One run of a barrier test.

/// The stage whose artifact has the metrics of a run.
const INTEGRATED: &str = "3-integrate.mcap";
/// Artifacts that may hold what the file stated of the damage.
const WITH_DAMAGE: [&str; 2] = ["2-filter.mcap", "1-ingest.mcap"];

/// What the run of a barrier test says of its front.
#[derive(Debug)]
struct RunTest {
    name: String,
    test: TestV1,
    damage: Option<DamageV1>,
    a_and_b: Option<(f64, f64)>,
}

impl RunTest {
    fn read(folder: &Path) -> anyhow::Result<Self> {
        let name = folder.display().to_string();
        let refused = |problem: String| {
            Refused::new(problem).expected("the folder of a run of a barrier test").hint(hint_for_a_run(folder))
        };
        if let Some(problem) = results_of_an_earlier_run(folder) {
            return Err(refused(problem).into());
        }
        if !folder.join(INTEGRATED).is_file() {
            return Err(refused(format!("{name}: there is no {INTEGRATED}")).into());
        }
        let open = |file: &str| Artifact::open(&folder.join(file)).map_err(Refused::from);
        let mut artifacts = vec![open(INTEGRATED)?];
        let mut damage: Option<DamageV1> = None;
        for file in WITH_DAMAGE.iter().filter(|file| folder.join(file).is_file()) {
            artifacts.push(open(file)?);
            damage = artifacts[artifacts.len() - 1].record("/damage").map_err(Refused::from)?;
            if damage.is_some() {
                break;
            }
        }
        refuse_a_mixture(&artifacts, |artifact| artifact.path().display().to_string())?;
        let test: Option<TestV1> = artifacts[0].record("/test").map_err(Refused::from)?;
        let test = test.ok_or_else(|| refused(format!("{name}: {INTEGRATED} names no test")))?;
        let metrics: Option<MetricsV2> = artifacts[0].record("/metrics").map_err(Refused::from)?;
        let metrics = metrics.unwrap_or_default().metrics;
        let value = |name: &str| metrics.iter().find(|metric| metric.name == name).and_then(|metric| metric.value);
        let a_and_b = value("crush_stiffness_a").zip(value("crush_stiffness_b"));
        Ok(Self { name, test, damage, a_and_b })
    }

    /// The test as it is typed, with values of the example for what is not known.
    fn as_typed(&self) -> String {
        let damage = self.damage.as_ref();
        let crush_m = damage.and_then(|damage| Some(DamageProfile::new(&damage.crush_m())?.mean_m()));
        let width_m = damage.and_then(|damage| Some(damage.width()?.0));
        let own = [
            self.test.mass_kg.map(|kg| format!("{kg:.0}kg")),
            self.test.impact_speed_m_per_s.map(|v| format!("{:.1}km/h", KM_PER_H_PER_M_PER_S * v)),
            crush_m.map(|m| format!("{:.0}mm", 1e3 * m)),
            width_m.map(|m| format!("{:.0}mm", 1e3 * m)),
        ];
        let values =
            own.into_iter().zip(TEST.split(',')).map(|(own, example)| own.unwrap_or_else(|| example.to_owned()));
        values.collect::<Vec<_>>().join(",")
    }

    /// The test, or what it lacks.
    fn barrier_test(&self) -> Result<NamedTest, Refused> {
        let refused = |problem: &str| {
            Refused::new(format!("{}: {problem}", self.name))
                .expected("mass, impact speed, residual crush and width of a frontal barrier test")
                .hint(format!(
                    "in place of --from {} type the test, with what its file lacks: --test {}",
                    self.name,
                    self.as_typed()
                ))
        };
        let (Some(mass_kg), Some(speed)) = (self.test.mass_kg, self.test.impact_speed_m_per_s) else {
            return Err(refused("mass or impact speed is not known"));
        };
        let damage = self.damage.as_ref().ok_or_else(|| refused("its file states no residual crush"))?;
        if damage.is_of_another_side() {
            return Err(refused("its damage is classified as of another side than the front"));
        }
        let no_width = || refused("neither the width of the damage nor that of the vehicle is stated");
        let (width_m, _) = damage.width().ok_or_else(no_width)?;
        let crush_m = damage.crush_m();
        let profile = DamageProfile::new(&crush_m).ok_or_else(|| refused("its residual crush has no two stations"))?;
        let test = BarrierTest { mass_kg, width_m, impact_speed_m_per_s: speed, mean_crush_m: profile.mean_m() };
        Ok(NamedTest { name: self.name.clone(), test })
    }

    /// The line of this test through b0, by the energy of its profile.
    fn line(&self, b0_m_per_s: f64) -> Option<ImpactLine> {
        let BarrierTest { mass_kg, width_m, impact_speed_m_per_s, .. } = self.barrier_test().ok()?.test;
        let crush_m = self.damage.as_ref()?.crush_m();
        let profile = DamageProfile::new(&crush_m).filter(|_| impact_speed_m_per_s > b0_m_per_s)?;
        let stiffness = CrushStiffness::from_energy(mass_kg, width_m, impact_speed_m_per_s, profile, b0_m_per_s)?;
        let mass_per_width_kg_per_m = mass_kg / width_m;
        Some(ImpactLine { b0_m_per_s, b1_per_s: stiffness.b1_per_s, mass_per_width_kg_per_m, scatter: None })
    }
}
