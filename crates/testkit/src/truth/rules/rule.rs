//! A rule: a sentence that a run may say, and what must be true then. All rules, registered.

use std::collections::{BTreeMap, BTreeSet};

use crumple_report::phrases::named;
use serde_json::Value;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use crate::truth::known::{BELOW, ELSEWHERE, Impact, LABELS, NOT_OF_A_RUN};
use crate::truth::rules::{impacts, models, notes, page, status};
use crate::truth::run::{Made, Shown, numbers};
use crate::truth::template::{Grammar, Place, Said, Template};

/// Where something is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Surface {
    /// The sentences on top of page and console.
    Top,
    /// Printed by the run.
    Console,
    /// The first screen of the page.
    Page,
    /// `summary.json`: warnings, notes, reasons.
    Summary,
}

impl Surface {
    /// In the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Top => "verdict",
            Self::Console => "console",
            Self::Page => "first screen",
            Self::Summary => "summary",
        }
    }
}

/// A sentence in its run.
#[derive(Debug, Clone, Copy)]
pub struct Spot<'a> {
    /// The run.
    pub made: &'a Made,
    /// Where it is said.
    pub surface: Surface,
    /// What it is about there: the key of a card, the candidate of a picture, the stage of a note.
    pub key: &'a str,
}

/// What must be true where a sentence stands; else what it contradicts.
pub type Check = fn(&Said, &Spot<'_>) -> Result<(), String>;

/// What one template claims.
#[derive(Clone, Copy)]
pub struct Rule {
    /// `subject.name` of a text of `phrases`, or `note.name`, `page.name` of a sentence made elsewhere.
    pub template: &'static str,
    /// The sentence, where it is not one of `phrases`.
    pub text: &'static str,
    /// What stands in its places.
    pub places: &'static [(&'static str, Place)],
    /// What must be true.
    pub check: Check,
}

/// A rule of a text of `phrases`.
pub const fn rule(template: &'static str, places: &'static [(&'static str, Place)], check: Check) -> Rule {
    Rule { template, text: "", places, check }
}

/// A rule of a sentence that is made elsewhere.
pub const fn says(
    template: &'static str,
    text: &'static str,
    places: &'static [(&'static str, Place)],
    check: Check,
) -> Rule {
    Rule { template, text, places, check }
}

/// `Err(what)` unless it holds.
pub fn holds(condition: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if condition { Ok(()) } else { Err(what()) }
}

/// Its places say all that it claims: [`Place::At`] is compared wherever it stands.
pub fn places_alone(_: &Said, _: &Spot<'_>) -> Result<(), String> {
    Ok(())
}

/// Every number of the sentence stands in the summary or in a record of the artifacts, rounded as it is shown.
pub fn numbers_of_records(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    for filled in said.places.values().filter(|filled| filled.said.is_none()) {
        for shown in numbers(&filled.text) {
            holds(is_in_records(spot.made, &shown), || format!("{} stands in no record", filled.text))?;
        }
    }
    Ok(())
}

/// Counts of things are in records as lengths of lists, so small whole numbers are not looked for.
const COUNT: f64 = 20.0;

/// Factors of the units of columns, and of ends of intervals, which are said once.
const FACTORS: [f64; 7] = [1.0, 1e3, 3.6, 1.0 / 9.806_65, 1e-3, 100.0, 1.0 / std::f64::consts::TAU];

/// Numbers of definitions: the end of an event by 49 CFR 563 (20 ms of at most 0.8 km/h), a deceleration that counts as
/// contact (0.5 g for 3 ms), the ways of OLC (65 mm free, 235 mm in all), levels, the first 150 ms.
const OF_DEFINITIONS: [f64; 11] = [49.0, 563.0, 0.8, 20.0, 0.5, 3.0, 0.065, 0.235, 90.0, 95.0, 150.0];

/// Whether a number is one of a record, in its unit or in that of its column.
pub fn is_in_records(made: &Made, shown: &Shown) -> bool {
    let plain = shown.without_unit();
    let is_count = shown.factor == 1.0 && shown.decimals == 0 && shown.value.abs() <= COUNT;
    is_count
        || OF_DEFINITIONS.contains(&shown.value)
        || made.all_numbers.iter().any(|number| {
            let is_own = |factor: f64| plain.is_of(number * factor) || plain.is_of(-number * factor);
            if shown.factor == 1.0 { FACTORS.into_iter().any(is_own) } else { is_own(shown.factor) || is_own(1.0) }
        })
}

/// The number in a place is this one, rounded as it is shown.
pub fn shows(said: &Said, place: &str, si: Option<f64>, what: &str) -> Result<(), String> {
    let shown = said.number(place).ok_or_else(|| format!("{what}: {:?} is no number", said.text(place)))?;
    let si = si.ok_or_else(|| format!("{what}: there is no such number, and {} is said", said.text(place)))?;
    holds(shown.is_of(si) || shown.is_of(-si), || format!("{what} is {} in SI, and {} is said", si, said.text(place)))
}

/// The truth of the test that was made, of a sound record of a vehicle.
pub fn own_test(made: &Made) -> Option<Impact> {
    let known = &made.known;
    known.impact(known.speed_m_per_s?, known.mass_kg?).filter(|_| known.is_sound && made.is_of_a_vehicle())
}

/// Whether a record is a sound one of a vehicle as cars are: it rebounds at a third of its speed at most. A spring that
/// stays attached, and so pulls its mass back, may be asked about.
pub fn is_like_a_car(made: &Made) -> bool {
    own_test(made).is_some_and(|truth| truth.restitution <= 0.3)
}

/// What a candidate misses of its own test, by what the summary has of both: dynamic crush beyond 3.5 %, restitution
/// beyond 0.1, time beyond 5 %, or that it stops. The limits are those of what the project calls adequate.
pub fn misses_its_own_test(made: &Made, candidate: &Value) -> Option<String> {
    // One that is recommended although it misses more says so, and for what it is.
    let is_excused = ["recommended", "simplest"].iter().any(|name| made.summary[name] == candidate["id"])
        && made.rated(candidate).is_some_and(|rated| {
            let missed = &rated.missed_events;
            !rated.adequate && !missed.is_empty() && missed.iter().all(|event| event != "dynamic_crush")
        });
    misses_its_own_crush(made, candidate).or_else(|| misses_time_or_rebound(made, candidate).filter(|_| !is_excused))
}

fn event(made: &Made, candidate: &Value, name: &str) -> Option<(f64, f64)> {
    let of_model = candidate.pointer(&format!("/simulation/{name}")).and_then(Value::as_f64);
    of_model.zip(made.number(&format!("/events/{name}")))
}

fn misses_its_own_crush(made: &Made, candidate: &Value) -> Option<String> {
    made.number("/events/dynamic_crush_m").filter(|_| !candidate["simulation"].is_null())?;
    let Some((own, crush)) = event(made, candidate, "dynamic_crush_m") else {
        return Some("it does not stop".to_owned());
    };
    let off = 100.0 * (own / crush - 1.0);
    (off.abs() > 3.5).then(|| format!("its crush is off by {off:.1} %"))
}

/// The same of the events beside the crush.
pub fn misses_time_or_rebound(made: &Made, candidate: &Value) -> Option<String> {
    let (own, time) = event(made, candidate, "time_of_dynamic_crush_s")?;
    let off = 100.0 * (own / time - 1.0);
    if off.abs() > 5.0 {
        return Some(format!("its time of crush is off by {off:.1} %"));
    }
    let (own, restitution) = event(made, candidate, "coefficient_of_restitution")?;
    let off = own - restitution;
    // Of a rebound that the record cuts off, what it shows is a lower bound: a force still acts, or the lowest velocity
    // is the last.
    let is_cut = is_rebound_cut(made) || made.summary["events"]["still_separating"] == true;
    let is_off = if is_cut { off < -0.1 } else { off.abs() > 0.1 };
    is_off.then(|| format!("its restitution is off by {off:.2}"))
}

/// Whether a force above 1 g still acts on a vehicle that rebounds where the record ends: what its velocity changes by
/// in the last 4.4 ms, the window of CFC 60.
pub fn is_rebound_cut(made: &Made) -> bool {
    acts_at_end(made, 4.4e-3)
}

/// The same in the last 15 ms, the pause that ends an impact: without one the record does not show the end.
pub fn may_be_cut(made: &Made) -> bool {
    acts_at_end(made, 4.4e-3) || acts_at_end(made, 0.015)
}

fn acts_at_end(made: &Made, window_s: f64) -> bool {
    let velocity = made.waves.get(&format!("{}/velocity", made.text("/test/channel")));
    velocity.is_some_and(|wave| {
        let v = wave.sampled.samples();
        let before = v.len().saturating_sub(1 + (window_s / wave.sampled.dt_s()) as usize);
        v.last().zip(v.get(before)).is_some_and(|(last, before)| *last < 0.0 && before - last > window_s * G)
    })
}

/// Rules by the names of their templates.
pub struct Registry {
    rules: BTreeMap<&'static str, Rule>,
    grammar: Grammar,
}

impl Default for Registry {
    fn default() -> Self {
        Self::new()
    }
}

impl Registry {
    /// All of them. A rule of a text that `phrases` has no more reads nothing.
    pub fn new() -> Self {
        let mut all = [
            page::VEHICLE_RULES,
            status::RULES,
            models::RULES,
            models::CHOICE_RULES,
            notes::RULES,
            impacts::RULES,
            page::RULES,
        ]
        .concat();
        all.extend(REMARKS.iter().map(|(template, text)| says(template, text, &[], numbers_of_records)));
        let texts: BTreeMap<String, &str> =
            named().map(|(subject, name, text)| (format!("{subject}.{name}"), text)).collect();
        let mut grammar = Grammar::default();
        for rule in &all {
            let text = if rule.text.is_empty() { texts.get(rule.template).copied() } else { Some(rule.text) };
            if let Some(text) = text {
                grammar.add(Template::new(rule.template.to_owned(), text), rule.places);
            }
        }
        for label in LABELS {
            if let Some(text) = texts.get(*label) {
                grammar.add(Template::new((*label).to_owned(), text), &[]);
            }
        }
        Self { rules: all.into_iter().map(|rule| (rule.template, rule)).collect(), grammar }
    }

    /// Texts of `phrases` that a run can print and that have neither a rule nor a reason; rules, labels and reasons of
    /// texts that `phrases` has no more.
    pub fn without_rule(&self) -> Vec<String> {
        let is_elsewhere = |subject: &str| ELSEWHERE.iter().chain(BELOW).any(|(other, _)| *other == subject);
        let reasons = || LABELS.iter().copied().chain(NOT_OF_A_RUN.iter().map(|(name, _)| *name));
        let all: Vec<(&str, String)> =
            named().map(|(subject, name, _)| (subject, format!("{subject}.{name}"))).collect();
        let texts = all.iter().filter(|(subject, _)| !is_elsewhere(subject)).map(|(_, name)| name.as_str());
        let without = texts.filter(|name| !self.rules.contains_key(name) && !reasons().any(|own| own == *name));
        let of_phrases = self.rules.values().filter(|rule| rule.text.is_empty()).map(|rule| rule.template);
        let left_over = of_phrases.chain(reasons()).filter(|name| !all.iter().any(|(_, own)| own == name));
        without.chain(left_over).map(str::to_owned).collect()
    }

    /// Names of the templates of these beginnings that may stand by themselves: none that fills a place of another.
    pub fn sentences(&self, beginnings: &[&str]) -> Vec<&'static str> {
        let of_places = self.rules.values().flat_map(|rule| rule.places).filter_map(|(_, place)| match place {
            Place::Said(names) => Some(*names),
            _ => None,
        });
        let parts: BTreeSet<&str> = of_places.flatten().copied().collect();
        let own = self.rules.keys().copied().filter(|name| beginnings.iter().any(|start| name.starts_with(start)));
        own.filter(|name| !parts.contains(name))
            .chain(LABELS.iter().copied().filter(|name| beginnings.iter().any(|start| name.starts_with(start))))
            .collect()
    }

    /// Every template with a rule that a run can print.
    pub fn templates(&self) -> impl Iterator<Item = &'static str> {
        self.rules.keys().copied().filter(|name| !NOT_OF_A_RUN.iter().any(|(own, _)| own == name))
    }

    /// A text by its templates; `None`: some of its words are of none.
    pub fn read(&self, text: &str, templates: &[&str]) -> Option<Vec<Said>> {
        let as_reason = || {
            let first = text.trim_start().chars().next()?.to_lowercase();
            let reason = first.chain(text.trim_start().chars().skip(1)).collect::<String>();
            let read = self.grammar.read(&reason, &[status::REASON_AS_SENTENCE])?;
            read.iter().all(|said| said.inner("reason").is_some()).then_some(read)
        };
        self.grammar.read(text, templates).or_else(as_reason)
    }

    /// What a sentence contradicts: its numbers those of the summary, then its own check.
    pub fn contradiction(&self, said: &Said, spot: &Spot<'_>) -> Option<String> {
        let rule = self.rules.get(said.template.as_str())?;
        let numbers = rule.places.iter().try_for_each(|(place, kind)| match (kind, said.number(place)) {
            (Place::At(pointer), Some(shown)) => {
                let own = spot.made.number(pointer);
                holds(own.is_some_and(|own| shown.is_of(own) || shown.is_of(-own)), || {
                    format!("{} is said, and {pointer} of the summary is {own:?}", said.text(place))
                })
            }
            _ => Ok(()),
        });
        numbers.and_then(|()| (rule.check)(said, spot)).err()
    }
}

/// Name and sentence; a place takes words, also none.
const REMARKS: &[(&str, &str)] = &[
    (
        "note.too-strong",
        "the pulse stays above {level} for {time} (largest {largest}), no vehicle does: check its channel and unit",
    ),
    ("note.too-flat", "the pulse never exceeds {level} for {time}: check its channel and unit"),
    (
        "note.noisy-before",
        "the pulse is noisy before the event: standard deviation {level}, at most {usual} is usual: {more}",
    ),
    ("note.equal-samples", "equal samples in a row at an extreme (clipped?) in {channels}"),
    (
        "note.recorder-zero",
        "event data recorder (49 CFR 563): time zero is the recorder's, some milliseconds after contact",
    ),
    ("note.recorder-table", "event data recorder table: the velocity change is cumulative and coarse {more}"),
    ("note.change-as-pulse", "the change of velocity {channel} is taken as the pulse"),
    ("note.level-in", "mean over the last {time} above {level} (drift, or a force still acts) in {channels}"),
    ("note.without-file", "{count} of {all} listed channels have no signal file here: {channels}"),
    ("note.left-and-right", "channels {one} and {two} (left and right) differ by at most {more}"),
    ("note.configuration", "configuration: {what}"),
    (
        "note.vehicles-meet",
        "vehicles {one} and {two} meet: mass, speed and description are those of vehicle {which}, {more}",
    ),
    ("note.of-exponentials", "{id}: time of the exponents runs from the first sample, {time}"),
    ("note.paper-curve-fit", "{id}: paper curve-fit: {more}"),
    ("note.beside-paper", "{id}: beside the paper's curve fit: {more}"),
    ("note.horizon", "{id}: horizon of {rows} block rows: {more}"),
    ("note.no-continuous", "{id}: the pole z = {pole} has no continuous counterpart: {more}"),
    ("note.no-pulse", "no channel is named as the crash pulse: {why}"),
    ("note.inputs-and-outputs", "a record of inputs and outputs, as no pulse is named (--channel names one): {why}"),
    ("note.time-zero-of-file", "time zero is t = 0 of the file, {samples} samples after its start"),
    ("note.start", "integration starts {time} before contact: {why}"),
    ("note.intervals", "intervals are {level} of {count} replicates (seed {seed}) with {inputs}"),
    ("note.thirds", "{model}: {masses}: {more}, an assumption that the parameters depend on"),
    (
        "note.sets",
        "{model}: the parameters are not identifiable from this record: {count} sets fit within {share} of the best",
    ),
    ("note.rank", "order {order} exceeds the numerical rank {rank} ({ratio}): order {used} is used, which {more}"),
    ("note.same-set", "{model}: a further set is left out, as measured it is the same as an earlier one"),
    ("note.free-fall", "{channel}free fall before contact{more}"),
    ("note.at-rest", "{channel}it falls or brakes before contact: zero is the level at rest, {level}"),
    (
        "note.brakes",
        "it brakes before contact: the level there is {level} off the level at the start of the record. {more}",
    ),
    ("note.begins-inside", "the record begins inside the pulse, at {level}: {more}"),
    ("note.contact-by-rule", "time zero by rule {rule} at {instant} of the file; {more}"),
    ("note.passed-through", "{channels}: already {class}, passed through unfiltered"),
    ("note.not-told-apart", "the record does not tell apart {models}: {more}"),
    (
        "note.occupant-needs-neither",
        "mass and impact speed are not both stated: the criteria of an occupant need neither",
    ),
    ("note.offset", "the level before contact is {level}: an offset that the filter removes"),
    ("note.level-before", "the level before contact is {level}: an offset, or a free fall. {more}"),
    ("note.axis", "channels start {more}"),
    ("note.words", "columns of words are left out: {channels}"),
    ("note.gaps", "columns with gaps are left out: {channels}; --channel takes the one it names"),
    ("note.late-columns", "columns that are blank in the first rows and filled later are left out"),
    ("note.slower-rows", "{count} of {all} rows have no number in {channels}, and are left out"),
    ("note.from-the-first", "the times of column {channel} count from the first one; {more}"),
    ("note.rows-resampled", "{count} rows are resampled to {rate} by linear interpolation, as asked: {more}"),
    ("note.stamps-stand-still", "stamps of topic {topics} stand still: the time of recording is taken {more}"),
    ("note.no-numbers", "variables that are no numbers are not read: {names}"),
    ("note.no-unit", "no unit is known for {channels}: kept as read, quantity other"),
    ("note.handed-on", "channel {channel}: handed on as it is"),
    ("note.of-a-dummy", "{channels}: of a dummy, filtered to {more}"),
    (
        "note.no-motion",
        "channel {channel}: all {count} samples after the first are zero: there is no motion to identify",
    ),
    ("note.no-stabilisation", "{method}: no stabilisation diagram: {why}"),
    ("note.not-in-spread", "channel {channel} is not in the spread: {why}"),
    ("note.not-integrated", "not integrated, because {why}: channels {channels} {more}"),
    ("note.against", "channel {one} against {two}: largest |da| {more}"),
    ("note.bounds-of-axes", "criteria are lower bounds, because only one or two axes are in this record: {channels}"),
    ("note.crash3", "crush stiffness (CRASH3): {why}"),
    ("note.spread", "dynamic crush of {count} channels: {range}; the spread of every metric is {more}"),
    (
        "note.as-if-wall",
        "models of one vehicle at a rigid barrier are fitted to the pulse as if it had met one: {more}",
    ),
    ("note.momentum", "momentum: the changes of both vehicles leave {share} of that of vehicle {which} over; {more}"),
    ("note.heads", "vehicle {which} heads towards it, as the changes of velocity say: closing speed {speed}; {more}"),
    ("note.to-the-end", "{model}: the velocity of the record never reaches zero: fitted up to {time}, {more}"),
    ("note.not-solved-no-crush", "{model}: not solved: the velocity never reaches zero, {more}"),
    ("note.to-the-event", "the velocity never reaches zero: fitted up to the end of the event at {more}"),
    ("note.does-not-stop", "the vehicle does not stop within the record: models are assessed over {more}"),
    ("note.no-force", "the pulse does not slow the vehicle down, so that there is no force to model"),
    (
        "note.elastoplastic",
        "elastoplastic: not solved, coefficient_of_restitution is {value}, expected at most 1 {more}",
    ),
    ("note.pairs", "{model}: the parameters are not identifiable: {count} pairs of sets {more}"),
    ("note.too-far", "the vehicle moves further than its impact speed would carry it: {more}"),
    ("note.rebounds-ten-times", "the vehicle rebounds at more than ten times its impact speed: {more}"),
    ("note.no-mass-no-models", "the test has no mass, which turns frequencies into N/m"),
    (
        "note.none-for-predictions",
        "no candidate is recommended for predictions: {why}. --candidate ID predicts with one of them",
    ),
];
