//! Sliders on the recommended model: the structure as data, and the script that moves it.

use crate::drawing::escape::html;
use crate::drawing::numbers::{G_PER_M_PER_S2, MILLI};
use crate::findings::capitalised;
use crate::findings::{CandidateResult, Ranking, Run};
use crumple_artifact::records::CandidateV1;
use crumple_lumped::{Element, Extrapolation, ForceDeflection, Node, PiecewiseLinear, structure_of};
use crumple_signal::Sampled;
use crumple_signal::display::shown;
use crumple_signal::key_quantities::{MASS, SPEED};
use serde_json::{Value, json};

use crate::frame::json_element;
use crate::frame::{PageFiles, Script};

/// What the sliders look like, for the style of the page.
pub(super) const STYLE: &str = include_str!("what_if/style.css");

/// The script: integrates the model, keeps the state in the address, draws.
pub(super) const SCRIPT: Script = Script { name: "what-if", text: include_str!("what_if/what_if.js") };

/// A drawing that the script fills.
const PANEL: &str = "<svg class=\"plot\" viewBox=\"0 0 560 306\" role=\"img\"><title>Motion over time</title></svg>";

/// Points of a measured curve beside the model's.
const POINTS: usize = 300;

/// The section, hidden until its script has reproduced the stage's crush and time. Nothing without a model that stops.
pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking, files: &PageFiles) {
    let Some(candidate) = ranking.best.as_deref().and_then(|id| run.candidate(id)) else { return };
    let Some(data) = data(run, candidate) else { return };
    out.push_str(&format!(
        "<section id=\"what-if\" aria-labelledby=\"what-if-title\" hidden>\n<h2 id=\"what-if-title\">What if</h2>\n\
         <p>{}, computed in this page with other numbers. Not fitted to anything: it shows what the model says, not \
         what a vehicle does.</p>\n\
         <div class=\"controls\"></div>\n<p class=\"answer\" aria-live=\"polite\"></p>\n\
         <div class=\"panels\">{PANEL}{PANEL}</div>\n<p class=\"caption state\"></p>\n</section>\n\
         {}{}",
        html(&capitalised(&run.name_of(&candidate.id))),
        json_element("what-if-data", &data),
        files.script(SCRIPT)
    ));
}

/// What the script needs: structure, start, and what it must find again.
fn data(run: &Run, candidate: &CandidateResult) -> Option<Value> {
    let simulation = candidate.simulation.as_ref().filter(|simulation| simulation.drive.is_none())?;
    let (crush, time) = (simulation.dynamic_crush_m?, simulation.time_of_dynamic_crush_s?);
    let speed = run.test.impact_speed_m_per_s?;
    let structure = described(&candidate.record)?;
    let end_s = 2.0 * time;
    // Factor from SI, decimals and unit of what the script shows.
    let [speed_unit, length, mass] = [SPEED.shown(), shown((MILLI, 1, "mm")), MASS.shown()];
    let curve = |wave: Option<&Sampled>, factor: f64| wave.map(|wave| thinned(wave, end_s, factor));
    let mut data = json!({
        "v0": speed, "crush": crush, "time": time, "end": end_s,
        "tested": run.events.as_ref().and_then(|events| events.dynamic_crush_m),
        "displacement": curve(run.measured.displacement.as_ref(), length.0),
        "acceleration": curve(run.measured.filtered.as_ref(), G_PER_M_PER_S2),
        "speed": speed_unit, "length": length, "mass": mass, "g": G_PER_M_PER_S2,
    });
    data["masses"] = structure["masses"].clone();
    data["elements"] = structure["elements"].clone();
    Some(data)
}

/// `[[t, y], ...]` in ms and the unit of `factor`, from contact to `end_s`.
fn thinned(wave: &Sampled, end_s: f64, factor: f64) -> Vec<[f64; 2]> {
    let first = wave.index_at_or_after(0.0);
    let last = wave.index_at_or_after(end_s).min(wave.len());
    let step = (last.saturating_sub(first) / POINTS).max(1);
    let round = |x: f64| (x * 1e3).round() / 1e3;
    let point = |k: usize| [round(MILLI * wave.time_s(k)), round(factor * wave.samples()[k])];
    (first..last).step_by(step).map(point).collect()
}

// The structure of a candidate as numbers for the script: masses, and elements by their laws.

/// Masses and elements, the curves continued beyond their last knot as predictions do. `None`: no model that this
/// program knows, or one with a law of its own, which the script cannot compute.
pub fn described(record: &CandidateV1) -> Option<Value> {
    let structure = structure_of(&record.model, record.law.as_deref(), &record.parameters).ok()?.with_trends_beyond();
    let node = |node: Node| match node {
        Node::Wall => -1,
        Node::Mass(i) => i64::try_from(i).unwrap_or(-1),
    };
    let elements: Vec<Value> = structure
        .connections()
        .iter()
        .map(|connection| {
            let mut element = law(&connection.element)?;
            element["front"] = node(connection.front).into();
            element["rear"] = node(connection.rear).into();
            Some(element)
        })
        .collect::<Option<_>>()?;
    Some(json!({"masses": structure.masses_kg(), "elements": elements}))
}

fn law(element: &Element) -> Option<Value> {
    let points = |law: &PiecewiseLinear| law.points().map(|(at, value)| [at, value]).collect::<Vec<_>>();
    Some(match element {
        Element::OwnForce(_) => return None,
        Element::Spring(spring) => json!({"kind": "spring", "points": points(&spring.0)}),
        Element::Damper(damper) => json!({"kind": "damper", "points": points(&damper.0)}),
        Element::SeriesSpringDamper(series) => {
            json!({"kind": "series", "k": series.stiffness_n_per_m, "c": series.damping_n_s_per_m})
        }
        // A curve of one slope that goes back along another.
        Element::PlasticSpring(spring) => json!({
            "kind": "curve", "knots": [[0.0, 0.0], [1.0, spring.loading_stiffness_n_per_m]],
            "beyond": spring.loading_stiffness_n_per_m, "unloading": spring.unloading_stiffness_n_per_m, "rate": 0.0,
            "gap": 0.0, "limit": null, "pulls": !spring.release,
        }),
        Element::ForceDeflection(curve) => json!({
            "kind": "curve", "knots": curve.knots().iter().map(|(d, f)| [*d, *f]).collect::<Vec<_>>(),
            "beyond": beyond(curve), "unloading": curve.unloading_n_per_m(), "rate": curve.rate_s_per_m(),
            "gap": curve.gap_m(), "limit": curve.limit_n(), "pulls": false,
        }),
    })
}

/// Stiffness beyond the last knot, N/m.
fn beyond(curve: &ForceDeflection) -> f64 {
    match (curve.extrapolation(), curve.knots()) {
        (Extrapolation::Stiffness(stiffness), _) => stiffness,
        (Extrapolation::Constant, _) => 0.0,
        (Extrapolation::Slope, [.., (a, fa), (b, fb)]) => (fb - fa) / (b - a),
        (Extrapolation::Slope, _) => 0.0,
    }
}
