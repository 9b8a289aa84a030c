//! The tests of a joint model, and each of them predicted from the others.

use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, KM_PER_H_PER_M_PER_S, MILLI};

use crate::Run;
use crate::frame::heads::{Column, table};
use crate::results::joint::{JointTest, LeftOut};
use crate::text::language::{Language, fill};
use crate::text::names::candidate_name;

pub(super) fn write(out: &mut String, run: &Run) {
    let Some(joint) = &run.joint else { return };
    let texts = &run.language.phrases().joint;
    let columns = [
        Column::text(texts.test),
        Column::number(texts.mass),
        Column::number(texts.speed),
        Column::number(texts.crush),
        Column::number(texts.time),
        Column::number(texts.restitution),
        Column::number(texts.crush_error),
        Column::number(texts.time_error),
        Column::number(texts.peak_error),
        Column::number(texts.rating),
        Column::text(texts.held),
        Column::text(texts.by),
    ];
    out.push_str(&format!("<section id=\"tests\">\n<h2>{}</h2>\n{}", texts.title, table("", &columns)));
    joint.tests.iter().for_each(|test| row(out, run.language, test));
    out.push_str(&format!("</tbody>\n</table></div>\n<p class=\"caption\">{}</p>\n</section>\n", texts.caption));
}

fn row(out: &mut String, language: Language, joint: &JointTest) {
    let (texts, page) = (&language.phrases().joint, &language.phrases().page);
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| {
        format!("<td class=\"n\">{}</td>", value.map_or_else(|| ABSENT.to_owned(), text))
    };
    let JointTest { test, left_out } = joint;
    out.push_str(&format!("<tr><th scope=\"row\">{}</th>", html(&test.name)));
    out.push_str(&number(Some(test.mass_kg), &|v| language.decimals(v, 0)));
    out.push_str(&number(Some(test.impact_speed_m_per_s), &|v| language.decimals(KM_PER_H_PER_M_PER_S * v, 1)));
    out.push_str(&number(test.dynamic_crush_m, &|v| language.decimals(MILLI * v, 1)));
    out.push_str(&number(test.time_of_dynamic_crush_s, &|v| language.decimals(MILLI * v, 1)));
    out.push_str(&number(test.coefficient_of_restitution, &|v| language.decimals(v, 3)));
    match (left_out, joint.against()) {
        (LeftOut::Predicted(prediction), Some(against)) => {
            let percent = |v: f64| language.signed(v, 1);
            out.push_str(&number(against.dynamic_crush_error_percent, &percent));
            out.push_str(&number(against.time_of_dynamic_crush_error_percent, &percent));
            out.push_str(&number(against.peak_acceleration_error_percent, &percent));
            out.push_str(&number(against.iso18571_score, &|v| language.decimals(v, 2)));
            let held = if against.held.iter().any(|name| name == "dynamic_crush_m") { page.yes } else { page.no };
            let class = if against.missed_crush_percent().is_some() { " class=\"no\"" } else { "" };
            out.push_str(&format!("<td{class}>{held}</td><td>{}</td>", html(&candidate_name(&prediction.candidate))));
        }
        (LeftOut::NotPredicted(why), _) => {
            out.push_str(&format!("<td colspan=\"6\">{}</td>", fill(texts.not_predicted, &[("why", html(why))])));
        }
        _ => out.push_str(&format!("<td colspan=\"6\">{ABSENT}</td>")),
    }
    out.push_str("</tr>\n");
}
