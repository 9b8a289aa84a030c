//! Parameters of a candidate as bars: the interval about the value, on a logarithmic scale of two decades.

use std::collections::BTreeMap;

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateResult, ShownParameter, parameter_order};
use crumple_artifact::records::Certainty;

use crate::frame::{Column, heads};

/// Decades to either side of the value.
const DECADES: f64 = 1.0;

/// A row a parameter: symbol, value, interval in words, bar.
pub(super) fn table(candidate: &CandidateResult) -> String {
    let model = candidate.record.model.as_str();
    let mut names: Vec<&String> = candidate.record.parameters.keys().collect();
    names.sort_by_key(|name| parameter_order(model, name));
    let rows: String = names.into_iter().map(|name| row(candidate, name)).collect();
    let columns = [Column::text("Parameter"), Column::number("Value"), Column::number("95&nbsp;%")];
    format!(
        "<table class=\"bars\"><thead><tr>{}<th scope=\"col\" class=\"scale\"><span>÷10</span>\
         <span>value</span><span>×10</span></th></tr></thead><tbody>{rows}</tbody></table>",
        heads(&columns)
    )
}

fn row(candidate: &CandidateResult, name: &str) -> String {
    let record = &candidate.record;
    let value = record.parameters[name];
    let shown = ShownParameter::of(record, name);
    let end = |ends: &BTreeMap<String, Option<f64>>| ends.get(name).copied();
    let ends = record.uncertainty.as_ref().and_then(|u| Some((end(&u.interval_low)?, end(&u.interval_high)?)));
    let on_bound = record.fit.as_ref().is_some_and(|fit| fit.active_bounds.iter().any(|bound| bound == name));
    let is_wide = record.certainty(name) == Some(Certainty::OrderOfMagnitude);
    let no = |words: &str| format!("<span class=\"no\">{words}</span>");
    let (words, bar) = match (candidate.doubt(name), ends) {
        (None, Some((low, high))) if is_wide => (no("wide interval"), bar(value, low, high)),
        (Some(doubt), _) => (no(doubt), bar(value, None, None)),
        (None, _) if on_bound => ("physical limit".to_owned(), String::new()),
        (None, None) if record.asked().any(|asked| asked == name) => (ABSENT.to_owned(), String::new()),
        (None, None) => ("given".to_owned(), String::new()),
        (None, Some((low, high))) => (shown.interval().unwrap_or_default(), bar(value, low, high)),
    };
    format!(
        "<tr><th scope=\"row\"><span tabindex=\"0\" title=\"{}\">{}</span></th><td class=\"n\">{} {}</td>\
         <td class=\"n\">{words}</td><td>{bar}</td></tr>",
        html(name),
        html(&shown.symbol),
        shown.value,
        shown.unit
    )
}

/// The interval between a tenth and ten times the value; an end beyond, or open, reaches the edge and fades.
fn bar(value: f64, low: Option<f64>, high: Option<f64>) -> String {
    if value == 0.0 || !value.is_finite() {
        return String::new();
    }
    let place = |end: f64| 50.0 + 50.0 * (end / value).log10() / DECADES;
    let edge = |end: Option<f64>, edge: f64| {
        let place = end.filter(|end| end / value > 0.0).map(place);
        place.map_or((edge, true), |place| (place.clamp(0.0, 100.0), !(0.0..=100.0).contains(&place)))
    };
    let ((left, left_open), (right, right_open)) = (edge(low, 0.0), edge(high, 100.0));
    let class = match (left_open, right_open) {
        (false, false) => "",
        (true, false) => " from",
        (false, true) => " to",
        (true, true) => " from to",
    };
    // Never thinner than can be seen.
    let width = (right - left).max(1.0);
    format!(
        "<div class=\"bar\" aria-hidden=\"true\"><i class=\"range{class}\" \
         style=\"left:{left:.1}%;width:{width:.1}%\"></i></div>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_lies_where_the_interval_does_and_an_open_end_reaches_the_edge() {
        let ten = 10_f64.sqrt();
        assert!(
            bar(2.0, Some(2.0 / ten), Some(2.0 * ten)).contains("class=\"range\" style=\"left:25.0%;width:50.0%\"")
        );
        assert!(bar(2.0, None, Some(2.0 * ten)).contains("range from\" style=\"left:0.0%;width:75.0%\""));
        assert!(bar(2.0, Some(0.1), Some(90.0)).contains("range from to\" style=\"left:0.0%;width:100.0%\""));
        assert!(bar(2.0, Some(2.0), Some(2.0)).contains("left:50.0%;width:1.0%"), "seen at all");
        // Negative values have a logarithm of their ratio.
        assert!(bar(-2.0, Some(-2.0 * ten), Some(-2.0 / ten)).contains("width"));
        assert_eq!(bar(0.0, None, None), "");
    }
}
