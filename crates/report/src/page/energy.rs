//! Where the energy of every model is at dynamic crush.

use crate::drawing::escape::html;
use crate::drawing::numbers::{KILO, MILLI};
use crate::findings::{Ranking, Run, candidate_name};
use crate::page::{UNFOLDED, folded};
use crate::phrases::PHRASES;
use crate::phrases::words;

use crate::frame::{Column, table};

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let mut rows: Vec<_> = run
        .candidates
        .iter()
        .filter_map(|candidate| {
            let simulation = candidate.simulation.as_ref()?;
            let at = |name: &str| simulation.energy.iter().find(|e| e.instant == name);
            // More kinetic energy at the end than any passive structure can keep.
            let diverges = at("end").is_some_and(|end| end.kinetic_j > 10.0 * end.input_j.abs());
            Some((candidate, at("dynamic crush").or_else(|| at("end"))?, closure(simulation.energy_closure, diverges)))
        })
        .collect();
    if rows.is_empty() {
        return;
    }
    rows.sort_by_key(|(candidate, ..)| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    let texts = &PHRASES.how_well;
    let columns = [
        Column::text(texts.model),
        Column::text(texts.instant),
        Column::number(texts.time),
        Column::number(texts.brought_in),
        Column::number(texts.kinetic),
        Column::number(texts.in_springs),
        Column::number(texts.dissipated),
        Column::number(texts.closure).means(texts.closure_definition),
    ];
    out.push_str(&format!("<section>\n{}{}", folded(texts.energy), table("", &columns)));
    for (candidate, energy, closure) in rows {
        let kilojoule = |joule: f64| words::decimals(KILO * joule, 2);
        out.push_str(&format!(
            "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td \
             class=\"n\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            html(&candidate_name(&candidate.id)),
            html(match energy.instant.as_str() {
                "dynamic crush" => texts.at_dynamic_crush,
                "end" => texts.at_end,
                other => other,
            }),
            words::decimals(MILLI * energy.time_s, 1),
            kilojoule(energy.input_j),
            kilojoule(energy.kinetic_j),
            kilojoule(energy.stored_j),
            kilojoule(energy.dissipated_j),
            closure,
        ));
    }
    out.push_str(&format!("</tbody>\n</table></div>\n<p class=\"caption\">{}</p>\n{UNFOLDED}", texts.energy_caption));
}

/// Rounding: its size says something, its digits do not. Of a motion that grows without end only that is said.
fn closure(gap: Option<f64>, diverges: bool) -> String {
    match gap {
        _ if diverges => PHRASES.how_well.diverges.to_owned(),
        None => String::new(),
        Some(gap) if gap < 1e-9 => "&lt; 10⁻⁹".to_owned(),
        Some(gap) => format!("{gap:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closure_is_its_size_and_a_growing_motion_says_so() {
        assert_eq!(closure(Some(3e-13), false), "&lt; 10⁻⁹");
        assert_eq!(closure(Some(1.63e-8), false), "1.6e-8");
        assert_eq!(closure(Some(1e-12), true), "diverges");
        assert_eq!(closure(None, false), "");
    }
}
