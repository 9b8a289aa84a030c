//! Where the energy of every model is at dynamic crush.

use crate::drawing::escape::html;
use crate::drawing::numbers::{KILO, MILLI};
use crate::findings::{Ranking, Run, capitalised};
use crate::page::{UNFOLDED, folded};
use crate::words;

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
    let columns = [
        Column::text("Model"),
        Column::text("Instant"),
        Column::number("Time, ms"),
        Column::number("Brought in").of("kJ"),
        Column::number("Kinetic").of("kJ"),
        Column::number("In springs").of("kJ"),
        Column::number("Dissipated").of("kJ"),
        Column::number("Closure")
            .means("Largest gap of the balance over the whole response, relative to its largest term."),
    ];
    out.push_str(&format!("<section id=\"energy\">\n{}{}", folded("Energy of the models"), table("", &columns)));
    for (candidate, energy, closure) in rows {
        let kilojoule = |joule: f64| words::cell(KILO * joule, 2, "kJ");
        out.push_str(&format!(
            "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td \
             class=\"n\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{closure}</td></tr>\n",
            html(&capitalised(&run.name_of(&candidate.id))),
            html(&energy.instant),
            words::decimals(MILLI * energy.time_s, 1),
            kilojoule(energy.input_j),
            kilojoule(energy.kinetic_j),
            kilojoule(energy.stored_j),
            kilojoule(energy.dissipated_j)
        ));
    }
    out.push_str(&format!(
        "</tbody>\n</table></div>\n<p class=\"caption\">Heat and work are integrated apart from the motion, so the \
         closure checks motion, forces and law together. Plastic work of the elastoplastic model counts as \
         dissipated.</p>\n{UNFOLDED}"
    ));
}

/// Rounding: its size says something, its digits do not. Of a motion that grows without end only that is said.
fn closure(gap: Option<f64>, diverges: bool) -> String {
    match gap {
        _ if diverges => "diverges".to_owned(),
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
