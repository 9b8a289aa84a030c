//! What is said of poles and modes of identified models.

use crate::truth::rules::rule::{Spot, holds, shows};
use crate::truth::template::Said;

/// An identified model of this name is there.
pub(super) fn is_identified(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let id = said.text("id");
    let is_there = spot.made.list("/models").iter().any(|model| model["id"].as_str() == Some(id));
    holds(is_there || spot.made.records.iter().any(|(topic, _)| topic.contains(id)), || {
        format!("there is no model {id}")
    })
}

/// A mode of this model at this frequency with this damping ratio.
pub(super) fn mode_of_a_model(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let model = spot.made.list("/models").iter().find(|model| model["id"].as_str() == Some(said.text("id")));
    let model = model.ok_or("there is no such model")?;
    let frequency = said.number("frequency").ok_or("no frequency is said")?;
    let ratio = said.number("ratio").ok_or("no damping ratio is said")?;
    let is_it = |pole: &serde_json::Value| {
        let (re, im) =
            (pole["re_per_s"].as_f64().unwrap_or_default(), pole["im_rad_per_s"].as_f64().unwrap_or_default());
        let modulus = re.hypot(im);
        frequency.is_of(modulus / std::f64::consts::TAU) && ratio.is_of(-re / modulus)
    };
    holds(model["poles"].as_array().into_iter().flatten().any(is_it), || "no pole of the model is there".to_owned())
}

/// The model has a real pole there, on that side.
pub(super) fn real_pole(said: &Said, spot: &Spot<'_>, is_there: fn(f64) -> bool) -> Result<(), String> {
    let place = said.number("place").ok_or("no place is said")?;
    holds(is_there(place.value), || format!("{} is on the other side", place.value))?;
    holds(poles(said, spot).iter().any(|modulus| place.is_of(*modulus) || place.is_of(-modulus)), || {
        "no pole of the model is there".to_owned()
    })
}

pub(super) fn growing_mode(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(said.number("ratio").is_some_and(|ratio| ratio.value < 0.0), || {
        "its damping ratio is not negative".to_owned()
    })?;
    mode_of_a_model(said, spot)
}

pub(super) fn two_poles_at_zero(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let mut poles = poles(said, spot);
    poles.sort_by(f64::total_cmp);
    // A double zero is known to the root of the rounding of the coefficients.
    let is_there = poles.len() > 2 && poles[1] < 1e-3 * poles[poles.len() - 1];
    holds(is_there, || format!("the poles are {poles:.3?} from zero"))
}

/// The fits are those of the model, and they contradict it.
pub(super) fn contradicted(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    is_identified(said, spot)?;
    let models = spot.made.list("/models");
    let model = models.iter().find(|model| model["id"].as_str() == Some(said.text("id")));
    shows(said, "unseen", model.and_then(|model| model["unseen_fit_percent"].as_f64()), "the fit of unseen samples")?;
    let [unseen, fit] = ["unseen", "fit"].map(|place| said.number(place).map_or(f64::NAN, |number| number.value));
    holds(unseen < 0.0 || unseen < fit - 30.0, || format!("{unseen} % does not contradict {fit} %"))
}

/// A pole as large as half of the sampling rate.
pub(super) fn beyond_nyquist(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let largest = poles(said, spot).into_iter().fold(0.0, f64::max);
    let limit = std::f64::consts::PI * spot.made.number("/test/sample_rate_hz").unwrap_or_default();
    holds(largest >= 0.999 * limit, || format!("its poles reach {largest:.0} of {limit:.0} rad/s"))
}

/// Moduli of the poles of the model that is named, rad/s, also of those that are no modes.
fn poles(said: &Said, spot: &Spot<'_>) -> Vec<f64> {
    let own = spot.made.list("/models").iter().filter(|model| model["id"].as_str() == Some(said.text("id")));
    let topic = format!("/modes/{}", said.text("id"));
    let others = spot.made.records.iter().filter(|(own, _)| *own == topic).map(|(_, record)| &record["other_poles"]);
    let all = own.map(|model| &model["poles"]).chain(others).filter_map(|poles| poles.as_array()).flatten();
    let part = |pole: &serde_json::Value, name: &str| pole[name].as_f64().unwrap_or(0.0);
    all.map(|pole| part(pole, "re_per_s").hypot(part(pole, "im_rad_per_s"))).collect()
}
