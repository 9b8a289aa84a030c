//! The three sentences: stiffer, softer, equal or undecided; where and by which force; what forbids trust.

use crumple_signal::display::unit_shown;
use serde::Serialize;

use super::checks::{Check, Outcome};
use super::requirements::shown;
use super::segments::{REPEAT_SCATTER, Segment};
use crate::drawing::numbers::{MILLI, decimals};
use crate::words;

/// A number of the simulation less that of the test, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Name of the key number.
    pub name: String,
    /// Of the test.
    pub test: f64,
    /// Of the simulation.
    pub simulation: f64,
    /// Simulation less test.
    pub difference: f64,
    /// Lower end of the interval of the difference, 90 %; `None`: the test has none.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
}

/// Segments in a row that are named, all stiffer or all softer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stretch {
    /// Where it begins, m.
    pub from_m: f64,
    /// Where it ends.
    pub to_m: f64,
    /// Smallest ratio of it.
    pub least: f64,
    /// Largest.
    pub most: f64,
}

/// Where test and simulation differ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "part")]
pub enum Place {
    /// The force of the wall differs first: what is in front of the engine.
    Front {
        /// Where.
        at: Stretch,
        /// Whether over the travel of the engine, else over the crush of the compartment.
        over_engine: bool,
    },
    /// The deceleration differs where the force of the wall does not: what is behind the engine, or the masses.
    Middle {
        /// Where the deceleration differs.
        at: Stretch,
        /// Up to where the force of the wall is equal, m.
        wall_equal_to_m: f64,
        /// As in [`Place::Front`].
        over_engine: bool,
    },
    /// The deceleration differs, and no force of the wall says where.
    Deceleration {
        /// Where it differs.
        at: Stretch,
    },
    /// No segment is named.
    Nowhere {
        /// Whether the force of the wall was compared.
        by_wall: bool,
    },
    /// No segment could be compared.
    Unknown,
}

/// Why a comparison is not to be trusted.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "reason")]
pub enum Reason {
    /// Masses or speeds differ.
    OtherTest {
        /// `mass` or `impact speed`.
        what: &'static str,
        /// Of the test, SI.
        test: f64,
        /// Of the simulation.
        simulation: f64,
    },
    /// What the reader of the simulation remarked.
    Remark {
        /// Its code.
        code: String,
        /// Its sentence.
        text: String,
    },
    /// The test itself is not to be used.
    Test {
        /// Why.
        text: String,
    },
}

/// What the crush of both says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decision {
    /// The simulation has less crush.
    Stiffer,
    /// It has more.
    Softer,
    /// The interval of the difference holds 0 and no difference that counts.
    Equal,
    /// The interval holds 0 and differences that count.
    Undecided,
}

/// A pulse that does not show the motion of the compartment: nothing of the vehicle can be compared by it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForeignPulse {
    /// Name of the run.
    pub run: String,
    /// What its reader says.
    pub text: String,
    /// One thing to do.
    pub remedy: String,
}

/// An uncertain contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OpenContact {
    /// How uncertain it is, s.
    pub by_s: f64,
    /// Where it was taken to be, on the time axis of the file, s.
    pub taken_s: f64,
}

/// What a comparison comes to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Why nothing of the vehicle is compared.
    pub foreign_pulse: Option<ForeignPulse>,
    /// The crush; `None`: one of both has none.
    pub crush: Option<Difference>,
    /// Contact of the test, where it makes up most of the interval of the crush.
    pub open_contact: Option<OpenContact>,
    /// Where they differ.
    pub place: Place,
    /// What forbids trust, beside the checks.
    pub reasons: Vec<Reason>,
    /// Checks of the simulation.
    pub checks: Vec<Check>,
}

/// The first stretch of named segments.
fn first_stretch(segments: &[Segment]) -> Option<Stretch> {
    let first = segments.iter().position(Segment::is_named)?;
    let above = |segment: &Segment| segment.ratio.is_some_and(|ratio| ratio > 1.0);
    let side = above(&segments[first]);
    let stretch = segments[first..].iter().take_while(|segment| segment.is_named() && above(segment) == side);
    let (from_m, ratios): (f64, Vec<(f64, f64)>) =
        (segments[first].from_m, stretch.filter_map(|segment| Some((segment.to_m, segment.ratio?))).collect());
    let fold = |pick: fn(f64, f64) -> f64| ratios.iter().map(|(_, ratio)| *ratio).reduce(pick);
    Some(Stretch { from_m, to_m: ratios.last()?.0, least: fold(f64::min)?, most: fold(f64::max)? })
}

impl Place {
    /// From the ratios by deceleration and by the wall's force over `over_engine` the travel of the engine, else over
    /// the crush. What is hit first differs first: where the deceleration differs before the wall does, the cause is
    /// behind the engine.
    pub fn of(deceleration: &[Segment], wall: &[Segment], over_engine: bool) -> Self {
        if deceleration.is_empty() && wall.is_empty() {
            return Self::Unknown;
        }
        let [by_wall, felt] = [wall, deceleration].map(first_stretch);
        match (by_wall, felt) {
            (None, None) => Self::Nowhere { by_wall: !wall.is_empty() },
            (None, Some(at)) if wall.is_empty() => Self::Deceleration { at },
            (None, Some(at)) => {
                Self::Middle { at, wall_equal_to_m: wall.last().map_or(0.0, |segment| segment.to_m), over_engine }
            }
            (Some(front), Some(at)) if at.from_m < front.from_m => {
                Self::Middle { at, wall_equal_to_m: front.from_m, over_engine }
            }
            (Some(at), _) => Self::Front { at, over_engine },
        }
    }
}

impl Stretch {
    /// `100 to 500 mm`.
    fn range(&self) -> String {
        let [from, to] = [self.from_m, self.to_m].map(|x| words::cell(MILLI * x, 0, "mm"));
        words::with_unit(words::between(&from, &to), unit_shown("mm"))
    }

    /// `22 to 29 % higher`.
    fn change(&self) -> String {
        let percent = |ratio: f64| decimals(100.0 * (ratio - 1.0).abs(), 0);
        let (near, far) = if self.most > 1.0 { (self.least, self.most) } else { (self.most, self.least) };
        let [near, far] = [near, far].map(percent);
        let range = if near == far { near } else { words::between(&near, &far) };
        format!("{} {}", words::with_unit(range, "%"), if self.most > 1.0 { "higher" } else { "lower" })
    }

    fn word(&self) -> &'static str {
        if self.most > 1.0 { "stiff" } else { "soft" }
    }
}

impl Difference {
    /// Whether the interval excludes 0; without one, whether they differ at all.
    pub fn is_apart(&self) -> bool {
        match self.low.zip(self.high) {
            Some((low, high)) => low > 0.0 || high < 0.0,
            None => self.difference != 0.0,
        }
    }

    /// Stiffer or softer where the interval excludes 0. Equal where it holds no difference that counts: a force that
    /// is off by [`REPEAT_SCATTER`] everywhere, as of two equal tests, moves the crush by at most that share, since the
    /// energy is force times crush. Else nothing is decided.
    pub fn decision(&self) -> Decision {
        let counts_m = REPEAT_SCATTER * self.test.abs();
        let is_within = |end: Option<f64>| end.is_none_or(|end| end.abs() <= counts_m);
        match () {
            () if self.is_apart() && self.difference > 0.0 => Decision::Softer,
            () if self.is_apart() => Decision::Stiffer,
            () if is_within(self.low) && is_within(self.high) => Decision::Equal,
            () => Decision::Undecided,
        }
    }

    fn sentence(&self, contact: Option<OpenContact>) -> String {
        let mm = |x: f64| words::quantity(MILLI * x.abs(), 0, "mm");
        let number = |x: f64| words::cell(MILLI * x.abs(), 0, "mm");
        let both = format!("{} against {} in the test", mm(self.simulation), mm(self.test));
        let side = if self.difference > 0.0 { "more" } else { "less" };
        let signed = self.low.zip(self.high).map(|(low, high)| {
            let [low, high] = [low, high].map(|end| words::signed_cell(MILLI * end, 0, "mm"));
            words::with_unit(words::between(&low, &high), unit_shown("mm"))
        });
        let word = match self.decision() {
            Decision::Equal => {
                let known = signed.map_or_else(String::new, |ends| format!(" (90\u{a0}% of the difference: {ends})"));
                return format!("Equal: {both}{known}.");
            }
            Decision::Undecided => {
                let counts = words::with_unit(decimals(100.0 * REPEAT_SCATTER, 0), "%");
                let cause = contact.map_or_else(
                    || format!("The interval is wider than ±{counts} of the crush, which would count as equal."),
                    OpenContact::sentence,
                );
                let ends = signed.unwrap_or_default();
                return format!("Undecided: the 90\u{a0}% interval of the difference is {ends}, {both}. {cause}");
            }
            Decision::Softer => "softer",
            Decision::Stiffer => "stiffer",
        };
        let known = self.low.zip(self.high).map_or_else(
            || "without an interval".to_owned(),
            |(low, high)| {
                let [near, far] = if low > 0.0 { [low, high] } else { [high, low] };
                format!("90\u{a0}%: {}", words::between(&number(near), &number(far)))
            },
        );
        let by = mm(self.difference);
        format!("The simulation is {word} than the test: {by} {side} crush ({known}), {both}.")
    }
}

impl OpenContact {
    fn sentence(self) -> String {
        let by = words::quantity(MILLI * self.by_s, 1, "ms");
        // To the microsecond, without a negative zero.
        let taken_s = (self.taken_s * 1e6).round() / 1e6 + 0.0;
        format!("Contact in the test is uncertain by {by}: add --time-zero {taken_s}s if it is known to be there.")
    }
}

impl ForeignPulse {
    fn sentence(&self) -> String {
        format!("Not compared: in {}, {}. To compare, {}.", self.run, self.text, self.remedy)
    }
}

impl Verdict {
    /// The three sentences; where nothing of the vehicle can be compared, why, and what forbids trust.
    pub fn sentences(&self) -> Vec<String> {
        if let Some(foreign) = &self.foreign_pulse {
            return vec![foreign.sentence(), self.trust()];
        }
        let crush = self.crush.as_ref().map_or_else(
            || "Crush cannot be compared: one of both does not come to rest.".to_owned(),
            |crush| crush.sentence(self.open_contact),
        );
        vec![crush, self.where_differs(), self.trust()]
    }

    fn where_differs(&self) -> String {
        let scatter = words::with_unit(decimals(100.0 * REPEAT_SCATTER, 0), "%");
        let over = |over_engine: bool| if over_engine { "engine travel" } else { "crush" };
        match &self.place {
            Place::Front { at, over_engine } => format!(
                "Its front is too {} from {} of {}: the wall force is {} there, and every 90\u{a0}% interval excludes \
                 the {scatter} by which two equal tests may differ.",
                at.word(),
                at.range(),
                over(*over_engine),
                at.change()
            ),
            Place::Middle { at, wall_equal_to_m, over_engine } => format!(
                "It is too {} between engine and compartment, not in the front: the deceleration is {} from {} of \
                 crush, while the wall force is equal within {scatter} up to {} of {}; another division of the masses \
                 would look the same.",
                at.word(),
                at.change(),
                at.range(),
                words::quantity(MILLI * wall_equal_to_m, 0, "mm"),
                over(*over_engine)
            ),
            Place::Deceleration { at } => format!(
                "By deceleration alone it is too {} from {} of crush, {} there; one accelerometer cannot name the \
                 part, since a softer middle of the car shifts the ratio to later segments, and the wall force of both \
                 would.",
                at.word(),
                at.range(),
                at.change()
            ),
            Place::Nowhere { by_wall } => format!(
                "No segment of {} differs by more than {scatter} (two equal tests may), by {}.",
                words::quantity(100.0, 0, "mm"),
                if *by_wall { "wall force and deceleration" } else { "deceleration, without the wall force of both" }
            ),
            Place::Unknown => format!(
                "No segment can be compared: a mass, a motion or the first {} are missing, so that nothing says where \
                 they differ.",
                words::quantity(100.0, 0, "mm")
            ),
        }
    }

    fn trust(&self) -> String {
        let named = |outcome: Outcome| self.checks.iter().filter(move |check| check.outcome == outcome);
        let failed = named(Outcome::Failed).map(|check| {
            let value = check.value.map(|value| shown(check.name, value)).unwrap_or_default();
            format!("{} is {value} (limit {}, {})", check.what, check.limit(), check.source)
        });
        let reasons: Vec<String> = failed.chain(self.reasons.iter().map(Reason::sentence)).collect();
        let names = |outcome| named(outcome).map(|check| check.name).collect::<Vec<_>>().join(", ");
        let missing = match names(Outcome::NotInFile) {
            none if none.is_empty() => String::new(),
            list => format!(" Not in the file, so not checked: {list}."),
        };
        match (reasons.is_empty(), names(Outcome::Passed)) {
            (false, _) => format!("Do not rely on it before this is settled: {}.{missing}", reasons.join("; ")),
            (true, passed) if passed.is_empty() => {
                "Nothing says whether to trust it: the simulation's files have no energies.".to_owned()
            }
            (true, passed) => format!("Nothing that was checked forbids trust: {passed} passed.{missing}"),
        }
    }
}

impl Check {
    /// Its limit, for people.
    pub fn limit(&self) -> String {
        match (self.at_least, self.at_most) {
            (Some(least), Some(most)) => words::between(&shown(self.name, least), &shown(self.name, most)),
            (Some(least), None) => format!("at least {}", shown(self.name, least)),
            (None, Some(most)) => format!("at most {}", shown(self.name, most)),
            (None, None) => String::new(),
        }
    }
}

impl Reason {
    fn sentence(&self) -> String {
        match self {
            Self::OtherTest { what, test, simulation } => {
                let (places, unit) = if *what == "mass" { (0, "kg") } else { (2, "m/s") };
                let [test, simulation] = [test, simulation].map(|x| words::quantity(*x, places, unit));
                format!("the {what} is {simulation}, that of the test {test}")
            }
            Self::Remark { code, text } => format!("{} [{code}]", text.trim_end_matches('.')),
            Self::Test { text } => format!("the test is not to be used, {}", text.trim_end_matches('.')),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validate::segments::{MeanForce, edges, ratios};

    fn segments(list: &[f64]) -> Vec<Segment> {
        let force = |k: usize, ratio: f64| MeanForce { mean_n: 1e5 * (k + 1) as f64 * ratio, deviation_n: 500.0 };
        let all = |factor: &dyn Fn(usize) -> f64| (0..list.len()).map(|k| force(k, factor(k))).collect::<Vec<_>>();
        ratios(&edges(0.1 * list.len() as f64 + 0.05), &all(&|_| 1.0), &all(&|k| list[k]))
    }

    fn verdict(place: Place, difference: f64) -> Verdict {
        let (low, high) = (Some(difference - 0.009), Some(difference + 0.009));
        let crush = Difference {
            name: "dynamic_crush".into(),
            test: 0.755,
            simulation: 0.755 + difference,
            difference,
            low,
            high,
        };
        Verdict {
            foreign_pulse: None,
            crush: Some(crush),
            open_contact: None,
            place,
            reasons: Vec::new(),
            checks: Vec::new(),
        }
    }

    /// The sentences with plain blanks.
    fn said(verdict: &Verdict) -> Vec<String> {
        verdict.sentences().iter().map(|text| text.replace('\u{a0}', " ")).collect()
    }

    #[test]
    fn the_force_that_differs_first_names_the_part() {
        let wall = segments(&[1.06, 1.23, 1.29, 1.28, 1.22, 1.03]);
        let felt = segments(&[1.02, 1.10, 1.09, 1.13, 1.24, 1.29]);
        let text = said(&verdict(Place::of(&felt, &wall, false), -0.0625));
        assert_eq!(
            text[0],
            "The simulation is stiffer than the test: 62 mm less crush (90 %: 54 to 72), 692 mm against 755 mm in the \
             test."
        );
        assert_eq!(
            text[1],
            "Its front is too stiff from 100 to 500 mm of crush: the wall force is 22 to 29 % higher there, and every \
             90 % interval excludes the 5 % by which two equal tests may differ."
        );
        let wall = segments(&[1.0, 1.0, 1.0, 0.99, 0.94, 0.86, 0.85]);
        let felt = segments(&[0.99, 0.75, 0.75, 0.79, 0.87, 0.93, 0.87]);
        let text = said(&verdict(Place::of(&felt, &wall, false), 0.064));
        assert!(text[0].starts_with("The simulation is softer than the test: 64 mm more crush (90 %: 55 to 73)"));
        assert_eq!(
            text[1],
            "It is too soft between engine and compartment, not in the front: the deceleration is 7 to 25 % lower from \
             100 to 700 mm of crush, while the wall force is equal within 5 % up to 400 mm of crush; another division \
             of the masses would look the same."
        );
        let text = said(&verdict(Place::of(&felt, &[], false), 0.064));
        assert!(text[1].contains("one accelerometer cannot name the part, since a softer middle"), "{}", text[1]);
    }

    #[test]
    fn equal_is_no_difference_beyond_the_interval_and_never_valid() {
        let equal = segments(&[1.02, 1.0, 0.99]);
        let mut verdict = verdict(Place::of(&equal, &equal, false), 0.0);
        assert_eq!(
            said(&verdict),
            [
                "Equal: 755 mm against 755 mm in the test (90 % of the difference: −9 to +9 mm).",
                "No segment of 100 mm differs by more than 5 % (two equal tests may), by wall force and deceleration.",
                "Nothing says whether to trust it: the simulation's files have no energies.",
            ]
        );
        verdict.reasons.push(Reason::OtherTest { what: "mass", test: 1500.0, simulation: 1450.0 });
        let text = &said(&verdict)[2];
        assert_eq!(text, "Do not rely on it before this is settled: the mass is 1450 kg, that of the test 1500 kg.");
        assert_eq!(Place::of(&[], &[], false), Place::Unknown);
    }

    #[test]
    fn a_wide_interval_decides_nothing_and_its_cause_is_named() {
        let mut verdict = verdict(Place::Unknown, -0.056);
        let crush = verdict.crush.as_mut().unwrap();
        (crush.low, crush.high) = (Some(-0.115), Some(0.002));
        verdict.open_contact = Some(OpenContact { by_s: 0.0023, taken_s: 0.0 });
        assert_eq!(
            said(&verdict)[0],
            "Undecided: the 90 % interval of the difference is −115 to +2 mm, 699 mm against 755 mm in the test. \
             Contact in the test is uncertain by 2.3 ms: add --time-zero 0s if it is known to be there."
        );
        // ±5 % of the crush of 755 mm is ±38 mm.
        let decided = |low, high| Difference { low: Some(low), high: Some(high), ..verdict.crush.clone().unwrap() };
        assert_eq!(decided(-0.037, 0.037).decision(), Decision::Equal);
        assert_eq!(decided(-0.039, 0.037).decision(), Decision::Undecided);
        assert_eq!(decided(-0.115, -0.002).decision(), Decision::Stiffer);
    }

    #[test]
    fn a_pulse_of_the_engine_says_nothing_of_the_car() {
        let foreign = ForeignPulse {
            run: "test".into(),
            text: "the channel sits elsewhere (engine)".into(),
            remedy: "name another one by --channel".into(),
        };
        let verdict = Verdict { foreign_pulse: Some(foreign), ..verdict(Place::Unknown, 0.1) };
        let text = said(&verdict);
        let first =
            "Not compared: in test, the channel sits elsewhere (engine). To compare, name another one by --channel.";
        assert_eq!((text.len(), text[0].as_str()), (2, first));
        assert!(text[1].starts_with("Nothing says whether to trust it"), "{text:?}");
    }
}
