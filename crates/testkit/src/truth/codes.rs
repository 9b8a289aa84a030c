//! What the values of a remark are compared with: a row a claim of a code.

use std::f64::consts::{FRAC_2_PI, TAU};

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use serde_json::Value;

use crate::truth::found::Found;
use crate::truth::known::{Impact, Subject};
use crate::truth::models::has_an_open_dual;
use crate::truth::run::Made;
use crate::truth::values::OF_RESTITUTION;

/// A claim of a remark. A name is that of a value of the remark, or of a number of the summary: one with `/` in front.
enum Claim {
    /// A value is this number, within so much. Nothing is asked where the number is not known.
    Near(&'static str, Truth, f64),
    /// Something else, in words.
    By(&'static str, fn(&Said<'_>) -> bool),
}

type Truth = fn(&Said<'_>) -> Option<f64>;

use Claim::{By, Near};
use Subject::{InputOutput, TwoVehicles, Vehicle};

const CRUSH: &str = "/events/dynamic_crush_m";
const TIME: &str = "/events/time_of_dynamic_crush_s";
const MASS: &str = "/test/mass_kg";
const SPEED: &str = "/test/impact_speed_m_per_s";
const RATE: &str = "/test/sample_rate_hz";
const E: &str = "/events/coefficient_of_restitution";
const EXACT: f64 = 1e-6;
/// The pulse of a soft front begins up to 5 ms after contact, and a contact that is found is off by 1 ms; s.
const LATE: f64 = 6e-3;

type Row = (&'static [&'static str], Claim);

const fn by(codes: &'static [&'static str], what: &'static str, holds: fn(&Said<'_>) -> bool) -> Row {
    (codes, By(what, holds))
}

/// The codes whose values can be compared with the truth.
const ROWS: &[Row] = &[
    by(&["CR106"], "no impact speed", |said| said.number(SPEED).is_none()),
    by(&["CR107", "CR363"], "no mass", |said| said.number(MASS).is_none()),
    by(&["CR121"], "the channel of the test", |said| {
        said.text("channel").split(' ').next() == Some(said.made.text("/test/channel"))
    }),
    by(&["CR123"], "of no vehicle at a wall", |said| said.made.known.subject != Vehicle),
    by(&["CR148", "CR156", "CR311", "CR802"], "something is wrong", |said| !said.made.known.is_sound),
    (&["CR134"], Near("samples_before", |said| said.made.pulse().map(|pulse| -pulse.t0_s() / pulse.dt_s()), 0.5)),
    by(&["CR134"], "contact is t = 0 of the file", |said| said.made.known.contact_s.abs() < 1e-3),
    (&["CR135"], Near("begins_s", |_| Some(0.01), 0.01)),
    (&["CR136"], Near("contact_s", |said| Some(said.made.known.contact_s), LATE)),
    by(&["CR142", "CR165", "CR166", "CR318", "CR323", "CR324"], "no sound car", |said| !said.made.is_like_a_car()),
    by(&["CR143", "CR367", "CR368", "CR369", "CR801"], "two vehicles", |said| said.made.known.subject == TwoVehicles),
    (&["CR148"], Near("samples", clipped, 0.0)),
    (&["CR149"], Near("deviation_g", |said| Some(said.made.level(-0.05, Some(-0.01))?.1 / G), 0.1)),
    // Of the pulse without its zero level, with which a record that begins before contact begins.
    (&["CR151"], Near("level_g", level_at_the_end, 0.1)),
    (&["CR154", "CR155"], Near("level_g", |said| Some(said.made.level(-0.05, Some(-0.01))?.0 / G), 0.05)),
    (&["CR163"], Near("crush_m", |said| said.made.own_test().map(|truth| truth.crush_m), 0.02)),
    (&["CR165", "CR166"], Near("crush_m", |said| Some(said.meant()?.crush_m), 0.02)),
    (&["CR165"], Near("restitution", |said| Some(said.meant()?.restitution), OF_RESTITUTION)),
    (&["CR166"], Near("meant_m_per_s", |said| said.meant().and(said.made.known.speed_m_per_s), 0.1)),
    (&["CR216"], Near("ratio", |said| said.ratio("rate_hz", "class"), EXACT)),
    // A recorder keeps whole km/h.
    (&["CR217"], Near("step_m_per_s", |_| Some(1.0 / 3.6), EXACT)),
    (&["CR217"], Near("rounding_g", |said| Some(said.number("step_m_per_s")? / said.number("over_s")? / G), 0.01)),
    by(&["CR315", "CR534", "CR535", "CR537", "CR561"], "it does not stop, nor did it in truth", |said| {
        said.number(CRUSH).or(said.made.own_test().map(|truth| truth.crush_m)).is_none()
    }),
    (&["CR315"], Near("end_velocity_m_per_s", |said| said.made.velocity()?.samples().last().copied(), EXACT)),
    by(&["CR317"], "no more than the true rebound", |said| {
        said.made.own_test().is_none_or(|truth| said.number(E).is_none_or(|e| e <= truth.restitution + OF_RESTITUTION))
    }),
    by(&["CR318"], "faster than the impact", |said| {
        said.number("rebound_m_per_s").map(f64::abs) > said.number("impact_speed_m_per_s")
    }),
    (&["CR320"], Near("count", |said| Some(later_zeros(said)?.len() as f64), 0.0)),
    (&["CR320"], Near("first_s", |said| later_zeros(said)?.first().copied(), 1e-4)),
    (&["CR321"], Near("from_crush_s", |said| said.ratio(CRUSH, "/events/impact_speed_m_per_s"), EXACT)),
    (&["CR323"], Near("restitution", |said| said.number(E), EXACT)),
    by(&["CR323"], "above the largest", |said| said.number("largest") < said.number("restitution")),
    by(&["CR323", "CR324"], "the true speed fits", speed_that_fits),
    by(&["CR325"], "a pulse that misses least", simple_pulse),
    (&["CR361"], Near("count", |said| Some(said.made.list("/impacts").len() as f64), 0.0)),
    (&["CR343", "CR803"], Near("low_m", |said| said.spread("low"), EXACT)),
    (&["CR343", "CR803"], Near("high_m", |said| said.spread("high"), EXACT)),
    // The other vehicle stands.
    (&["CR367"], Near("closing_m_per_s", |said| said.number(SPEED), 0.3)),
    (&["CR410"], Near("nyquist_hz", |said| Some(0.5 * said.number(RATE)?), EXACT)),
    by(&["CR410"], "as fast as half of the rate", |said| {
        said.number("frequency_hz") >= said.number("nyquist_hz").map(|hz| 0.999 * hz)
    }),
    by(&["CR412"], "a pole of the model", |said| {
        let own = said.number("frequency_hz").map(|hz| TAU * hz).or(said.number("rate_per_s")).unwrap_or(f64::NAN);
        said.moduli().iter().any(|modulus| (modulus / own.abs() - 1.0).abs() < 1e-6)
    }),
    // A double zero is known to the root of the rounding of the coefficients.
    by(&["CR413"], "poles at zero", |said| {
        let moduli = said.moduli();
        let largest = moduli.iter().copied().fold(0.0, f64::max);
        let over_s = said.number("over_s").unwrap_or(f64::NAN);
        let near = moduli.iter().filter(|modulus| **modulus < (0.01 * largest).max(0.51 / over_s)).count();
        moduli.is_empty() || Some(near as f64) >= said.number("poles")
    }),
    // What leaves half of the variance.
    (&["CR414"], Near("limit_percent", |_| Some(100.0 * (1.0 - 0.5_f64.sqrt())), 0.05)),
    by(&["CR414"], "below its limit", |said| said.number("fit_percent") < said.number("limit_percent")),
    by(&["CR437"], "of a free motion", |said| said.made.known.subject != InputOutput),
    (&["CR441"], Near("value", |said| start_of_sum(said).map(|sum| sum[0]), EXACT)),
    (&["CR441"], Near("slope_per_s", |said| start_of_sum(said).map(|sum| sum[1]), 1e-3)),
    by(&["CR475"], "unseen samples are fitted far worse", contradicted),
    by(&["CR507"], "six solutions at most, in pairs", |said| {
        said.number("real").is_some_and(|real| real <= 6.0 && real % 2.0 == 0.0)
            && said.number("physical") <= said.number("real")
    }),
    (&["CR512"], Near("time_ratio", |said| said.ratio("/events/centroid_time_s", TIME), EXACT)),
    by(&["CR512"], "above 2/pi, and of no Kelvin model", |said| {
        let most = if said.made.known.model() == Some("kelvin") && said.made.known.is_sound { 0.645 } else { 10.0 };
        said.number("time_ratio").is_some_and(|ratio| (FRAC_2_PI - 5e-4..most).contains(&ratio))
    }),
    by(&["CR524"], "a second sensor", |said| said.made.known.sensors > 1),
    by(&["CR525"], "no second sensor was fitted", |said| {
        said.made.list("/candidates").iter().all(|own| own["fit"]["sensors"][0].is_null())
    }),
    (&["CR527", "CR808"], Near("crush_m", |said| said.number(CRUSH), EXACT)),
    by(&["CR527"], "momentum over damping", nearly_rigid),
    by(&["CR531"], "too few", |said| said.number("samples") < said.number("needed")),
    by(&["CR538"], "no record of the filter", |said| {
        let filter = said.made.records.get(&format!("/filter/{}", said.made.text("/test/channel")));
        !filter.is_some_and(|filter| filter["cfc"].is_number())
    }),
    (&["CR561"], Near("end_s", |said| said.number("/events/end_of_event_s"), EXACT)),
    by(&["CR563"], "bounds of the fit", |said| !said.candidate()["fit"]["active_bounds"][0].is_null()),
    by(&["CR805"], "a dual, no second sensor", |said| has_an_open_dual(said.made, said.candidate())),
    by(&["CR806"], "open numbers", |said| said.names_of("open")),
    by(&["CR807"], "wide intervals", |said| said.names_of("order_of_magnitude")),
    by(&["CR808"], "a prediction is beyond the test", |said| {
        said.made.list("/predictions").iter().any(|own| own["recommended"] == true && own["extrapolates"] == true)
    }),
];

fn claims(code: &str) -> impl Iterator<Item = &'static Claim> + '_ {
    ROWS.iter().filter(move |(codes, _)| codes.contains(&code)).map(|(_, claim)| claim)
}

/// What is compared of a code; empty: its numbers are its values, and that is all.
pub fn compared(code: &str) -> String {
    let words = |claim: &Claim| match claim {
        By(what, _) => (*what).to_owned(),
        Near(name, ..) => format!("{name} is true"),
    };
    claims(code).map(words).collect::<Vec<_>>().join("; ")
}

/// Compares a remark with the truth.
pub fn check(made: &Made, remark: &Value, found: &mut Found) {
    let said = Said { made, values: &remark["values"] };
    let code = remark["code"].as_str().unwrap_or_default();
    for claim in claims(code) {
        match *claim {
            Near(name, number, tolerance) => {
                if let Some(number) = number(&said) {
                    found.near(name, said.number(name).unwrap_or(f64::NAN), number, tolerance);
                }
            }
            By(what, holds) => found.holds(holds(&said), || format!("not so: {what}: {}", said.values)),
        }
    }
}

/// A remark in its run.
struct Said<'a> {
    made: &'a Made,
    values: &'a Value,
}

impl<'a> Said<'a> {
    fn number(&self, name: &str) -> Option<f64> {
        if name.starts_with('/') { self.made.number(name) } else { self.values[name].as_f64() }
    }

    fn ratio(&self, name: &str, other: &str) -> Option<f64> {
        Some(self.number(name)? / self.number(other)?)
    }

    fn text(&self, name: &str) -> &'a str {
        self.values[name].as_str().unwrap_or_default()
    }

    /// The true test of a record that a flag makes right.
    fn meant(&self) -> Option<Impact> {
        self.made.true_test().filter(|_| self.made.known.remedy.is_some())
    }

    /// An end of the spread of the crush over sensors of one mass.
    fn spread(&self, end: &str) -> Option<f64> {
        self.made.key_number("dynamic_crush").filter(|_| self.made.known.sensors == 1)?["spread"][end].as_f64()
    }

    fn candidate(&self) -> &'a Value {
        self.made.candidate(self.text("id")).unwrap_or(&Value::Null)
    }

    /// Whether no more names are said than numbers of the candidate are known so.
    fn names_of(&self, certainty: &str) -> bool {
        let own = self.candidate()["certainties"][certainty].as_array().map_or(0, Vec::len);
        (1..=own).contains(&self.text("names").split(", ").count())
    }

    /// Moduli of the poles of the model, 1/s, also of those that are no modes.
    fn moduli(&self) -> Vec<f64> {
        let topic = format!("/modes/{}", self.text("model"));
        let others = self.made.records.get(&topic).map(|record| &record["other_poles"]);
        let own = self.made.model(self.text("model")).map(|model| &model["poles"]);
        let part = |pole: &Value, name: &str| pole[name].as_f64().unwrap_or(0.0);
        let all = own.into_iter().chain(others).filter_map(Value::as_array).flatten();
        all.map(|pole| part(pole, "re_per_s").hypot(part(pole, "im_rad_per_s"))).collect()
    }
}

/// Mean of the last 20 ms, g, less that of the first half of a lead, of 40 ms at most.
fn level_at_the_end(said: &Said<'_>) -> Option<f64> {
    let pulse = said.made.pulse()?;
    let mean = |from_s: f64, to_s: Option<f64>| Some(said.made.level(from_s, to_s)?.0 / G);
    let lead_s = said.made.known.contact_s - pulse.t0_s();
    let zero = (lead_s > 0.01).then(|| mean(pulse.t0_s(), Some(pulse.t0_s() + (0.5 * lead_s).min(0.04))));
    Some(mean(pulse.end_s() - 0.02, None)? - zero.unwrap_or(Some(0.0))?)
}

/// The longest row of equal samples at the largest or smallest value.
fn clipped(said: &Said<'_>) -> Option<f64> {
    let samples = said.made.pulse()?.samples();
    let ends = samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let runs = samples.chunk_by(|a, b| a == b).filter(|run| run[0] != 0.0 && (run[0] == ends.0 || run[0] == ends.1));
    runs.map(<[f64]>::len).max().map(|longest| longest as f64)
}

/// Zeros of the velocity behind the first, between its samples, s.
fn later_zeros(said: &Said<'_>) -> Option<Vec<f64>> {
    let wave = said.made.velocity()?;
    let zeros = wave.samples().windows(2).enumerate().filter(|(_, pair)| pair[0] * pair[1] < 0.0);
    let times = zeros.map(|(k, pair)| wave.t0_s() + wave.dt_s() * (k as f64 + pair[0] / (pair[0] - pair[1])));
    let first_s = said.number(TIME)? + wave.dt_s();
    Some(times.filter(|time_s| *time_s > first_s).collect())
}

/// Whether the range of speeds that would fit holds the true one, where a record states another.
fn speed_that_fits(said: &Said<'_>) -> bool {
    let known = &said.made.known;
    known.speed_m_per_s.filter(|_| known.remedy == Some("--impact-speed")).is_none_or(|truth| {
        said.number("lowest_m_per_s") <= Some(truth) && Some(truth) <= said.number("highest_m_per_s")
    })
}

/// Of those that miss at most 5 % more than the closest the simplest is named.
fn simple_pulse(said: &Said<'_>) -> bool {
    let metrics = said.made.summary["metrics"].as_object().into_iter().flatten();
    let pulses = metrics.filter(|(name, _)| name.starts_with("simple_pulse_"));
    let misfits: Vec<f64> = pulses.filter_map(|(_, metric)| metric["value"].as_f64()).collect();
    let least = misfits.iter().copied().fold(f64::INFINITY, f64::min);
    said.number("share_of_peak").is_some_and(|own| misfits.contains(&own) && own <= 1.05 * least + 1e-6)
}

/// Value and slope at the start of a sum of exponentials, by the terms of the model.
fn start_of_sum(said: &Said<'_>) -> Option<[f64; 2]> {
    let model = said.made.records.get(&format!("/model/{}", said.text("id")))?;
    let part = |term: &Value, name: &str| term[name].as_f64().unwrap_or(0.0);
    let slope = |term: &Value| {
        part(term, "re_amplitude") * part(term, "re_per_s") - part(term, "im_amplitude") * part(term, "im_rad_per_s")
    };
    let terms = model["terms"].as_array().filter(|_| !said.values["value"].is_null())?.iter();
    Some(terms.fold([0.0, 0.0], |[x, v], term| [x + part(term, "re_amplitude"), v + slope(term)]))
}

fn contradicted(said: &Said<'_>) -> bool {
    let fit = said.number("fit_percent").unwrap_or(0.0);
    let unseen = said.number("restarted_percent").or(said.number("validation_percent"));
    unseen.is_some_and(|unseen| unseen < 0.0 || unseen < fit - 30.0)
}

/// What the damper of a Maxwell model gives up to its crush is `m v0 / c`: all of the momentum has passed through it.
/// The velocity at the end of the window is not quite zero.
fn nearly_rigid(said: &Said<'_>) -> bool {
    let Some((mass, speed)) = said.number(MASS).zip(said.number(SPEED)) else { return true };
    let maxwell = said.made.list("/candidates").iter().filter(|own| own["model"] == *said.text("model"));
    let mut gives = maxwell.filter_map(|own| Some(mass * speed / own["parameters"]["damping_n_s_per_m"].as_f64()?));
    let own = said.number("gives_m").unwrap_or(f64::NAN);
    said.text("part") != "damper" || gives.any(|gives| (own / gives - 1.0).abs() < 0.05)
}
