//! A simulation beside its test: all numbers of the comparison.

use crumple_signal::{HALF_OF_90_PERCENT, Sampled, TestDescription};

use super::checks::{Impact, ModelRecords};
use super::ratings::Rating;
use super::requirements::Requirement;
use super::segments::{Accuracy, REPEAT_SCATTER, Segment, by_deceleration, by_wall, edges, ratios, ring};
use super::verdict::{Difference, ForeignPulse, OpenContact, Place, Reason, Verdict};
use crate::ComparedRun;
use crate::drawing::numbers::MILLI;
use crate::findings::{KeyNumber, Status, conclusion};
use crate::words;

/// Curves are rated up to this long after the end of crush, s.
const AFTER_CRUSH_S: f64 = 0.02;
/// Masses and speeds that differ by more are another test, as shares.
const SAME_TEST: f64 = 0.01;
/// Remarks that say what was taken for the motion of a simulation.
const TAKEN: [(&str, &str); 5] =
    [("CR171", "units"), ("CR173", "direction"), ("CR174", "acceleration"), ("CR177", "wall"), ("CR180", "states")];
/// The remark that a pulse is not that of the compartment.
const NOT_OF_COMPARTMENT: &str = "CR123";
/// Contact is named as the cause of a wide interval if it makes up at least this part of its variance.
const MOST: f64 = 0.5;
/// Names of the differences in a requirement.
const DIFFERENCES: [(&str, &str); 6] = [
    ("crush", "dynamic_crush"),
    ("time-of-crush", "time_of_dynamic_crush"),
    ("delta-v", "delta_v"),
    ("peak", "peak_acceleration"),
    ("olc", "olc"),
    ("restitution", "coefficient_of_restitution"),
];

/// A run with what its artifacts hold beside.
#[derive(Debug, Clone, Copy)]
pub struct Side<'a> {
    /// The run.
    pub run: &'a ComparedRun,
    /// Energies and the like; empty for a test.
    pub model: &'a ModelRecords,
    /// Travel of the engine, m.
    pub engine: Option<&'a Sampled>,
}

/// What a simulation comes to beside its test.
#[derive(Debug)]
pub struct Validation {
    /// Name of the simulation; of one beside several tests with that of the test.
    pub name: String,
    /// Name of the test.
    pub test: String,
    /// What it comes to.
    pub verdict: Verdict,
    /// Key numbers of both.
    pub differences: Vec<Difference>,
    /// Ratio of the mean force by deceleration, by segment of crush.
    pub deceleration: Vec<Segment>,
    /// That of the force of the wall; empty where one of both has none.
    pub wall: Vec<Segment>,
    /// That of the force of the wall over the travel of the engine.
    pub front: Vec<Segment>,
    /// Velocity and acceleration.
    pub ratings: Vec<Rating>,
    /// What was required, and the value.
    pub required: Vec<(Requirement, Option<f64>)>,
    /// What was assumed, by what it is of.
    pub assumed: Vec<(String, String)>,
    /// Ids of the candidates of one family in test and simulation.
    pub family: Option<[String; 2]>,
}

impl Side<'_> {
    /// Whether it is the result of a simulation.
    pub fn is_simulated(&self) -> bool {
        self.test().source.is_simulated()
    }

    fn number(&self, name: &str) -> Option<&KeyNumber> {
        self.run.summary.key_numbers.iter().find(|number| number.name == name && number.value.is_some())
    }

    fn accuracy(&self) -> Accuracy {
        let half = |name: &str| {
            let number = self.number(name)?;
            Some((number.value?, number.interval().map_or(0.0, |(low, high)| 0.5 * (high - low))))
        };
        let known = half("dynamic_crush").zip(half("delta_v")).filter(|_| !self.is_simulated());
        let end_s = self.run.run.time_of_crush_s().unwrap_or(0.0);
        let rings = || self.run.run.measured.velocity.as_ref().map_or(0.0, |velocity| ring(velocity, end_s));
        known.map_or(Accuracy::default(), |(crush, delta_v)| Accuracy::of_sensor(crush, delta_v, rings()))
    }

    fn test(&self) -> &TestDescription {
        &self.run.run.test
    }

    /// What says that its pulse is not that of the compartment.
    fn foreign_pulse(&self) -> Option<ForeignPulse> {
        let remark = self.run.run.remarks.iter().find(|remark| remark.code == NOT_OF_COMPARTMENT)?;
        let remedy = remark.remedy.clone().filter(|_| !self.is_simulated());
        let remedy = remedy.unwrap_or_else(|| "name a node of the compartment by --node".to_owned());
        Some(ForeignPulse { run: self.run.name.clone(), text: remark.text.clone(), remedy })
    }

    /// Its contact, where that makes up most of the interval of a crush.
    fn open_contact(&self, crush: &Difference) -> Option<OpenContact> {
        let contact = self.test().contact.as_ref()?;
        let deviation_s = contact.uncertainty_s?.deviation();
        let half_m = HALF_OF_90_PERCENT * deviation_s * self.test().impact_speed_m_per_s?;
        let half_of_all_m = 0.5 * (crush.high? - crush.low?);
        let is_most = half_m.powi(2) >= MOST * half_of_all_m.powi(2);
        is_most.then_some(OpenContact { by_s: deviation_s, taken_s: contact.source_time_s })
    }
}

/// Why two runs cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoComparison {
    /// What is missing.
    pub problem: String,
    /// One thing to do.
    pub hint: String,
}

impl NoComparison {
    /// A side without a motion: the mass and speed that it does not state are those of the other one, where that has
    /// them.
    fn no_motion(side: &Side<'_>, other: &Side<'_>) -> Self {
        let (own, other) = (side.test(), other.test());
        let missing = |own: Option<f64>, other: Option<f64>| other.filter(|_| own.is_none());
        let speed = missing(own.impact_speed_m_per_s, other.impact_speed_m_per_s);
        let mass = missing(own.mass_kg, other.mass_kg);
        // Four digits, as a flag reads them.
        let digits = |x: f64| format!("{x:.3e}").parse().unwrap_or(x);
        let flags = [
            mass.map(|mass_kg| format!("--mass {}kg", digits(mass_kg))),
            speed.map(|m_per_s| format!("--impact-speed {}m/s", digits(m_per_s))),
        ];
        let flags: Vec<String> = flags.into_iter().flatten().collect();
        let hint = match speed {
            Some(_) => format!("add {} (those of the other run), if {} had the same", flags.join(" "), side.run.name),
            None => "see its report for the reason".to_owned(),
        };
        Self { problem: format!("{} has no velocity after contact", side.run.name), hint }
    }
}

/// Simulation less test, for a key number that both have.
fn difference(name: &str, test: &Side<'_>, simulation: &Side<'_>) -> Option<Difference> {
    let (a, b) = (test.number(name)?, simulation.number(name)?);
    let (x, y) = (a.value?, b.value?);
    // A simulation has no sensor: its interval is that of sampling, which is below what is shown.
    let of_b = if simulation.is_simulated() { Some((y, y)) } else { b.interval() };
    let ends = a.interval().zip(of_b).map(|((a_low, a_high), (b_low, b_high))| {
        (y - x - (a_high - x).hypot(y - b_low), y - x + (x - a_low).hypot(b_high - y))
    });
    let (low, high) = (ends.map(|ends| ends.0), ends.map(|ends| ends.1));
    Some(Difference { name: name.to_owned(), test: x, simulation: y, difference: y - x, low, high })
}

/// The ratios by deceleration, by the wall over the crush, by the wall over the engine's travel.
fn segments(test: &Side<'_>, simulation: &Side<'_>) -> Option<[Vec<Segment>; 3]> {
    let [a, b] = [test, simulation].map(|side| (side.accuracy(), &side.run.run.measured));
    let crush = |side: &Side<'_>| side.number("dynamic_crush").and_then(|number| number.value);
    let over_crush = edges(crush(test)?.min(crush(simulation)?));
    let (x_a, x_b) = (a.1.displacement.as_ref()?, b.1.displacement.as_ref()?);
    let felt = |side: &Side<'_>, accuracy, x| {
        let velocity = side.run.run.measured.velocity.as_ref()?;
        Some(by_deceleration(side.test().mass_kg?, x, velocity, &over_crush, accuracy))
    };
    let felt = felt(test, a.0, x_a).zip(felt(simulation, b.0, x_b));
    let walls = a.1.barrier_force.as_ref().zip(b.1.barrier_force.as_ref());
    let of_wall = |travels: Option<(&Sampled, &Sampled)>, edges: &[f64]| {
        let both = walls.zip(travels);
        let means = both.map(|((f_a, f_b), (x_a, x_b))| (by_wall(f_a, x_a, edges, a.0), by_wall(f_b, x_b, edges, b.0)));
        means.map_or_else(Vec::new, |(of_a, of_b)| ratios(edges, &of_a, &of_b))
    };
    let engines = test.engine.zip(simulation.engine);
    let furthest = |wave: &Sampled| wave.samples().iter().copied().fold(0.0, f64::max);
    let over_engine = engines.map_or_else(Vec::new, |(a, b)| edges(furthest(a).min(furthest(b))));
    Some([
        felt.map_or_else(Vec::new, |(of_a, of_b)| ratios(&over_crush, &of_a, &of_b)),
        of_wall(Some((x_a, x_b)), &over_crush),
        of_wall(engines, &over_engine),
    ])
}

/// Candidates of one family in both runs, with the same parameters: those with the fewest undetermined ones, of them
/// the closest by the worse of both fits.
fn family(test: &ComparedRun, simulation: &ComparedRun) -> Option<[String; 2]> {
    let fit = |run: &ComparedRun, id: &str| run.run.candidate(id).and_then(crate::CandidateResult::fit_percent);
    let pairs = test.summary.candidates.iter().filter_map(|a| {
        let is_same = |b: &&crate::CandidateSummary| {
            (&b.model, &b.method) == (&a.model, &a.method) && b.parameters.keys().eq(a.parameters.keys())
        };
        let b = simulation.summary.candidates.iter().find(is_same).filter(|b| a.physical && b.physical)?;
        let undetermined = [a, b].map(|one| one.certainties.parameters - one.certainties.determined);
        Some((undetermined[0].max(undetermined[1]), fit(test, &a.id)?.min(fit(simulation, &b.id)?), [&a.id, &b.id]))
    });
    let best = pairs.min_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)))?;
    Some(best.2.map(Clone::clone))
}

impl Validation {
    /// Compares; `of_several` is whether it is one of several tests. Errors: why there is nothing to compare.
    pub fn new(
        test: &Side<'_>,
        simulation: &Side<'_>,
        of_several: bool,
        requirements: &[Requirement],
    ) -> Result<Self, NoComparison> {
        let is_still = |side: &Side<'_>| side.run.run.measured.velocity.is_none();
        for (side, other) in [(test, simulation), (simulation, test)] {
            if is_still(side) {
                return Err(NoComparison::no_motion(side, other));
            }
        }
        let foreign_pulse = test.foreign_pulse().or_else(|| simulation.foreign_pulse());
        // A number of an engine beside that of a compartment is none.
        let is_of_car = foreign_pulse.is_none();
        let [deceleration, wall, front] = segments(test, simulation).filter(|_| is_of_car).unwrap_or_default();
        let names = DIFFERENCES.iter().filter(|_| is_of_car);
        let differences: Vec<Difference> = names.filter_map(|(_, name)| difference(name, test, simulation)).collect();
        let impact =
            Impact { mass_kg: simulation.test().mass_kg, wall: simulation.run.run.measured.barrier_force.as_ref() };
        let of_front = if front.is_empty() { &wall } else { &front };
        let crush = differences.iter().find(|one| one.name == "dynamic_crush").cloned();
        let verdict = Verdict {
            open_contact: crush.as_ref().and_then(|crush| test.open_contact(crush)),
            foreign_pulse,
            crush,
            place: Place::of(&deceleration, of_front, !front.is_empty()),
            reasons: reasons(test, simulation),
            checks: simulation.model.checks(impact, requirements),
        };
        let to_s = test.run.run.time_of_crush_s().map_or(f64::INFINITY, |time_s| time_s + AFTER_CRUSH_S);
        let [a, b] = [test, simulation].map(|side| &side.run.run);
        let waves = [
            ("velocity", a.measured.velocity.as_ref().zip(b.measured.velocity.as_ref())),
            ("acceleration", a.acceleration().zip(b.acceleration())),
        ];
        let waves = waves.into_iter().filter(|_| is_of_car);
        let ratings = waves.filter_map(|(name, both)| Rating::new(name, both?.0, both?.1, to_s)).collect();
        let (name, of_test) = (simulation.run.name.clone(), test.run.name.clone());
        let mut validation = Self {
            name: if of_several { format!("{name} against {of_test}") } else { name },
            test: of_test,
            verdict,
            differences,
            deceleration,
            wall,
            front,
            ratings,
            required: Vec::new(),
            assumed: assumed(test, simulation),
            family: family(test.run, simulation.run).filter(|_| is_of_car),
        };
        validation.required = requirements.iter().map(|one| (one.clone(), validation.number(one.name))).collect();
        Ok(validation)
    }

    /// A number by the name that a requirement has, SI; differences by their magnitude.
    pub fn number(&self, name: &str) -> Option<f64> {
        let largest = |segments: &[Segment]| {
            segments.iter().filter_map(|segment| Some((segment.ratio? - 1.0).abs())).reduce(f64::max)
        };
        let rating = |quantity: &str| self.ratings.iter().find(|rating| rating.quantity == quantity);
        let key = DIFFERENCES.iter().find(|(own, _)| *own == name).map(|(_, key)| *key);
        match name {
            "velocity-iso" => rating("velocity")?.iso.overall,
            "acceleration-iso" => rating("acceleration")?.iso.overall,
            "velocity-cora" => Some(rating("velocity")?.cora.total),
            "acceleration-cora" => Some(rating("acceleration")?.cora.total),
            "wall-force" => largest(&self.wall),
            "deceleration" => largest(&self.deceleration),
            _ => match key {
                Some(key) => self.differences.iter().find(|one| one.name == key).map(|one| one.difference.abs()),
                None => self.verdict.checks.iter().find(|check| check.name == name).and_then(|check| check.value),
            },
        }
    }

    /// Requirements that are not held.
    pub fn broken(&self) -> impl Iterator<Item = &(Requirement, Option<f64>)> {
        self.required.iter().filter(|(requirement, value)| !requirement.is_held(*value))
    }
}

/// What forbids trust beside the checks.
fn reasons(test: &Side<'_>, simulation: &Side<'_>) -> Vec<Reason> {
    let [a, b] = [test, simulation].map(Side::test);
    let numbers =
        [("mass", a.mass_kg.zip(b.mass_kg)), ("impact speed", a.impact_speed_m_per_s.zip(b.impact_speed_m_per_s))];
    let other = numbers.into_iter().filter_map(|(what, both)| {
        let (test, simulation) = both?;
        ((simulation / test - 1.0).abs() > SAME_TEST).then_some(Reason::OtherTest { what, test, simulation })
    });
    // What is marked at the simulation's record: a missing start, foreign axes or units, an undersampled wall.
    let grave = simulation
        .run
        .run
        .remarks
        .iter()
        .filter(|remark| remark.stage == "ingest" && remark.weight > 1 && remark.code != NOT_OF_COMPARTMENT);
    let remarks = grave.map(|remark| Reason::Remark { code: remark.code.clone(), text: remark.text.clone() });
    // A sentence of the test points to its own list of warnings: the gravest itself is said here.
    let is_unusable = test.run.summary.verdict.status == Some(Status::DoNotUse) && test.foreign_pulse().is_none();
    let unusable = is_unusable.then(|| {
        let (said, concerns) = conclusion(&test.run.run, &test.run.ranking);
        Reason::Test { text: concerns.first().map_or(said.because, |gravest| gravest.text.clone()) }
    });
    other.chain(remarks).chain(unusable).collect()
}

/// What was assumed of both.
fn assumed(test: &Side<'_>, simulation: &Side<'_>) -> Vec<(String, String)> {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, text: String| rows.push((name.to_owned(), text));
    let accuracy = test.accuracy();
    add(
        "Test: error",
        format!(
            "forces ±{} by gain, curve ±{} by contact and zero level, velocity ±{} by its ring (1 σ)",
            words::quantity(100.0 * accuracy.gain, 1, "%"),
            words::quantity(MILLI * accuracy.shift_m, 1, "mm"),
            words::quantity(accuracy.velocity_m_per_s, 3, "m/s")
        ),
    );
    add("Test: load cells", format!("±{} (1 σ)", words::quantity(100.0 * accuracy.gain_of_wall, 1, "%")));
    let scatter = words::quantity(100.0 * REPEAT_SCATTER, 0, "%");
    add("Two equal tests differ", format!("by up to {scatter} of force in a segment"));
    for (side, name) in [(test, "Test"), (simulation, "Simulation")] {
        let run = &side.run.run;
        let rule = run.events.as_ref().map(|events| events.time_zero_rule.clone()).unwrap_or_default();
        let filter = run.filter.as_ref().map_or_else(String::new, |filter| format!(", filter {}", filter.mode));
        let pulse = run.channel_id().unwrap_or_default();
        add(&format!("{name}: pulse"), format!("{pulse}{filter}; contact: {rule}"));
    }
    for (code, what) in TAKEN {
        let taken = simulation.run.run.remarks.iter().filter(|remark| remark.code == code);
        taken.for_each(|remark| add(&format!("Simulation: {what}"), remark.text.clone()));
    }
    if !simulation.is_simulated() {
        add("Simulation: source", "no file of a solver: taken as a second test, with its sensor's error".to_owned());
    }
    rows
}

#[cfg(test)]
mod tests {
    use std::fs::read_to_string;
    use std::path::Path;

    use super::*;
    use crate::validate::segments::MeanForce;
    use crumple_metrics::cumulative;

    const G: f64 = 9.80665;

    /// Rows of numbers at their columns, of lines that are such rows.
    fn rows(file: &Path, separator: for<'a> fn(&'a str) -> Vec<&'a str>, columns: &[usize]) -> Vec<Vec<f64>> {
        let text = read_to_string(file).unwrap();
        let row = |line: &str| {
            let words = separator(line);
            columns.iter().map(|k| words.get(*k)?.trim().parse().ok()).collect()
        };
        text.lines().filter_map(row).collect()
    }

    /// A column from contact, times `factor`, turned so that it is positive on the whole.
    fn wave(rows: &[Vec<f64>], column: usize, factor: f64, dt_s: f64, contact_s: f64) -> Sampled {
        let sign = rows.iter().map(|row| row[column]).sum::<f64>().signum();
        Sampled::new(-contact_s, dt_s, rows.iter().map(|row| sign * factor * row[column]).collect()).unwrap()
    }

    /// The integral, zero at contact.
    fn integral(rate: &Sampled) -> Sampled {
        let sum = cumulative(rate.samples(), rate.dt_s());
        let sum = Sampled::new(rate.t0_s(), rate.dt_s(), sum).unwrap();
        let start = sum.at(0.0).unwrap();
        Sampled::new(rate.t0_s(), rate.dt_s(), sum.samples().iter().map(|x| x - start).collect()).unwrap()
    }

    fn blanks(line: &str) -> Vec<&str> {
        line.split_whitespace().collect()
    }

    fn commas(line: &str) -> Vec<&str> {
        line.split(',').collect()
    }

    /// Velocity of the compartment and force of the wall as the solver's file has them.
    fn simulated(set: &Path, name: &str) -> [Sampled; 2] {
        match name {
            "s1" => {
                let all = rows(&set.join("curves.cur"), blanks, &[0, 1]);
                let (velocity, force) = all.split_at(all.len() / 2);
                [wave(velocity, 1, 1.0, 4e-4, 0.0), wave(force, 1, 1e3, 4e-4, 0.0)]
            }
            "s2" => {
                let all = rows(&set.join("nodout"), blanks, &[0, 4, 12]);
                let node: Vec<Vec<f64>> = all.into_iter().filter(|row| row[0] == 1_000_001.0).collect();
                let force = rows(&set.join("rwforc"), blanks, &[0, 1, 3, 5]);
                [wave(&node, 1, 1e-3, 5e-4, 3.195e-3), wave(&force, 2, 1.0, 5e-4, 3.195e-3)]
            }
            _ => {
                let all = rows(&set.join("CART01.csv"), commas, &[32, 47]);
                [wave(&all, 0, 1.0, 4e-4, 1.278e-3), wave(&all, 1, 1e3, 4e-4, 1.278e-3)]
            }
        }
    }

    #[test]
    fn the_made_sets_have_their_true_ratios_and_the_part_that_is_wrong() {
        let Some(folder) = crumple_testkit::shared("reference/simulation") else { return };
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_dir())
        {
            let name = &entry.file_name().unwrap().to_str().unwrap()[..2];
            let truth: serde_json::Value =
                serde_json::from_str(&read_to_string(entry.join("truth.json")).unwrap()).unwrap();
            let felt = rows(&entry.join("test.csv"), commas, &[0, 1]);
            let acceleration: Vec<f64> = felt.iter().map(|row| G * row[1]).collect();
            let change = integral(&Sampled::new(-0.02, 1e-4, acceleration).unwrap());
            let v: Vec<f64> = change.samples().iter().map(|dv| 15.65 + dv).collect();
            let v = Sampled::new(-0.02, 1e-4, v).unwrap();
            let force = rows(&entry.join("test-wall-and-engine.csv"), commas, &[0, 1]);
            let force = Sampled::new(-0.02, 1e-4, force.iter().map(|row| 1e3 * row[1]).collect()).unwrap();
            let [v_simulated, f_simulated] = simulated(&entry, name);
            let crush = |v: &Sampled| integral(v).samples().iter().copied().fold(0.0, f64::max);
            let edges = edges(crush(&v).min(crush(&v_simulated)));
            let accuracy = Accuracy::of_sensor((0.755, 0.0095), (17.7, 0.175), ring(&v, 0.077));
            let means = |v: &Sampled, force: &Sampled, accuracy| -> [Vec<MeanForce>; 2] {
                let x = integral(v);
                [by_deceleration(1500.0, &x, v, &edges, accuracy), by_wall(force, &x, &edges, accuracy)]
            };
            let [a, b] = [means(&v, &force, accuracy), means(&v_simulated, &f_simulated, Accuracy::default())];
            let [felt, wall] = [0, 1].map(|k| ratios(&edges, &a[k], &b[k]));
            let of_truth = truth["ratio_by_segment"].as_array().unwrap();
            assert_eq!(felt.len(), of_truth.len(), "{name}");
            // The ring of 2 g moves the mean by 2 kN of 8 in the first segment, by 5 of 86 in the second.
            let tolerance = |k: usize| if k == 1 { 0.07 } else { 0.02 };
            for (k, of_truth) in of_truth.iter().enumerate().skip(1) {
                let keys = ["simulation_over_test_mass_times_deceleration", "simulation_over_test_wall_force"];
                for (key, segment) in keys.iter().zip([&felt[k], &wall[k]]) {
                    let expected = of_truth[key].as_f64().unwrap();
                    let error = segment.ratio.unwrap() - expected;
                    assert!(error.abs() < tolerance(k), "{name} {key}: {segment:?} {expected}");
                }
            }
            let place = Place::of(&felt, &wall, false);
            match (name, &place) {
                ("s1", Place::Nowhere { by_wall: true }) => {}
                ("s2", Place::Front { at, .. }) => assert_eq!((at.from_m, at.to_m), (0.1, 0.5), "{place:?}"),
                ("s3", Place::Middle { .. }) => {}
                _ => panic!("{name}: {place:?} {felt:?} {wall:?}"),
            }
        }
    }
}
