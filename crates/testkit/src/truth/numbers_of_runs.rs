//! Numbers of a summary against the truth, whatever is said of them.

use serde_json::Value;

use super::counts::Counts;
use super::run::Made;

/// Quantities of a prediction.
const PREDICTED: [&str; 5] = [
    "dynamic_crush_m",
    "time_of_dynamic_crush_s",
    "peak_acceleration_m_per_s2",
    "coefficient_of_restitution",
    "delta_v_m_per_s",
];

/// Words that belong to the status *usable* alone.
const USABLE: [&str; 4] = ["may be used", "is usable", "are usable", "reliable"];

/// What is wrong: the number and why. Intervals are counted.
pub fn check_numbers(made: &Made, counts: &mut Counts) -> Vec<(String, String)> {
    let mut wrong = Vec::new();
    intervals(made, counts);
    wrong.extend(poles(made));
    wrong.extend(usable_words(made));
    wrong.extend(question(made));
    wrong.extend(remedy(made));
    wrong
}

/// Counts the intervals of a sound record: of its events, and of what the recommended model predicts.
fn intervals(made: &Made, counts: &mut Counts) {
    let known = &made.known;
    let (Some(speed), Some(mass)) = (known.speed_m_per_s, known.mass_kg) else { return };
    if !known.is_sound || !made.is_of_a_vehicle() {
        return;
    }
    let holds = |interval: &Value, truth: f64| {
        let ends = interval["low"].as_f64().zip(interval["high"].as_f64());
        ends.map(|(low, high)| (low..=high).contains(&truth))
    };
    if let Some(truth) = known.impact(speed, mass) {
        for interval in made.list("/events/intervals") {
            let name = interval["name"].as_str().unwrap_or_default();
            let value = truth.named(name, speed).filter(|_| !name.starts_with("peak"));
            if let Some(holds) = value.and_then(|value| holds(interval, value)) {
                counts.add("of the test", name, holds);
            }
        }
    }
    let of_best = made.list("/predictions").iter().filter(|p| p["recommended"] == true && p["partner"].is_null());
    for prediction in of_best {
        let asked = prediction["impact_speed_m_per_s"].as_f64().zip(prediction["mass_kg"].as_f64());
        let Some((speed, mass)) = asked else { continue };
        let Some(truth) = known.impact(speed, mass) else { continue };
        for interval in prediction["intervals"].as_array().into_iter().flatten() {
            let name = interval["name"].as_str().unwrap_or_default();
            let value = truth.named(name, speed).filter(|_| PREDICTED.contains(&name));
            if let Some(holds) = value.and_then(|value| holds(interval, value)) {
                counts.add("of predictions", name, holds);
            }
        }
    }
}

/// A mode oscillates below half of the sampling rate; poles that are called stable do not grow.
fn poles(made: &Made) -> Vec<(String, String)> {
    let Some(rate) = made.number("/test/sample_rate_hz") else { return Vec::new() };
    let mut wrong = Vec::new();
    for model in made.list("/models") {
        let id = model["id"].as_str().unwrap_or_default();
        for mode in model["modes"].as_array().into_iter().flatten() {
            let hz = mode["natural_frequency_rad_per_s"].as_f64().unwrap_or_default() / std::f64::consts::TAU;
            let im = mode["im_rad_per_s"].as_f64().unwrap_or_default();
            if im != 0.0 && hz > 0.5 * rate * (1.0 + 1e-9) {
                wrong.push((format!("{id} modes"), format!("a mode of {hz:.0} Hz at {rate:.0} samples a second")));
            }
        }
    }
    let growing = |pole: &&Value| pole["re_per_s"].as_f64().is_some_and(|re| re > 1e-9);
    let all = made.list("/models").iter().flat_map(|model| model["poles"].as_array().into_iter().flatten());
    let count = all.filter(growing).count();
    if count > 0 && made.captions.contains("All poles are stable.") {
        wrong.push(("poles".to_owned(), format!("\"All poles are stable\" beside {count} that grow")));
    }
    wrong
}

/// What the status *usable* says, nothing else says.
fn usable_words(made: &Made) -> Vec<(String, String)> {
    let sentences = made.list("/verdict/sentences").iter().filter_map(Value::as_str).map(str::to_owned);
    let concerns = made.concerns().map(str::to_owned);
    let page = made.page.iter().filter(|block| !block.section.contains("status")).map(|block| block.text.clone());
    let all = sentences.chain(concerns).chain(page).chain(made.console.iter().cloned());
    let says = |text: String| {
        let text = text.to_lowercase().replace("unreliable", "");
        let word = USABLE.iter().find(|word| text.contains(**word))?;
        Some(("word".to_owned(), format!("{word:?} stands in {text:?}")))
    };
    all.filter_map(says).collect()
}

/// What was asked is predicted: this speed, this mass, this partner.
fn question(made: &Made) -> Option<(String, String)> {
    let question = made.question?;
    made.recommended()?;
    let answer = super::rules::answer(made);
    answer.is_none().then(|| ("predictions".to_owned(), format!("{:?} is not answered", question.flags)))
}

/// The first or second warning names what would make a wrong record right.
fn remedy(made: &Made) -> Option<(String, String)> {
    let remedy = made.known.remedy?;
    let first: Vec<&Value> = made.list("/concerns").iter().take(2).collect();
    let names = |concern: &&Value| {
        [&concern["text"], &concern["remedy"]]
            .iter()
            .any(|text| text.as_str().is_some_and(|text| text.contains(remedy)))
    };
    let texts = || first.iter().filter_map(|concern| concern["text"].as_str()).collect::<Vec<_>>().join("; ");
    (!first.iter().any(names)).then(|| ("warnings".to_owned(), format!("{remedy} is not named by: {}", texts())))
}
