//! Where the energy of every model is at dynamic crush.

use crate::escape::html;
use crate::people::{KILO, MILLI, candidate_name, decimals, significant};
use crate::{Ranking, Run};

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let mut rows: Vec<_> = run
        .candidates
        .iter()
        .filter_map(|candidate| {
            let simulation = candidate.simulation.as_ref()?;
            let at = |name: &str| simulation.energy.iter().find(|e| e.instant == name);
            Some((candidate, at("dynamic crush").or_else(|| at("end"))?, simulation.energy_closure))
        })
        .collect();
    if rows.is_empty() {
        return;
    }
    rows.sort_by_key(|(candidate, ..)| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    out.push_str(
        "<section>\n<h2>Energy of the models</h2>\n<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">Model</th>\
         <th scope=\"col\">Instant</th><th scope=\"col\" class=\"n\">Time, ms</th>\
         <th scope=\"col\" class=\"n\">Brought in, kJ</th><th scope=\"col\" class=\"n\">Kinetic, kJ</th>\
         <th scope=\"col\" class=\"n\">In springs, kJ</th><th scope=\"col\" class=\"n\">Dissipated, kJ</th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Largest gap of the balance over the whole response, relative to the energy \
         brought in.\">Closure</abbr></th></tr></thead>\n<tbody>\n",
    );
    for (candidate, energy, closure) in rows {
        let kilojoule = |joule: f64| decimals(KILO * joule, 2);
        out.push_str(&format!(
            "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            html(&candidate_name(&candidate.id)),
            html(&energy.instant),
            decimals(MILLI * energy.time_s, 1),
            kilojoule(energy.input_j),
            kilojoule(energy.kinetic_j),
            kilojoule(energy.stored_j),
            kilojoule(energy.dissipated_j),
            // Rounding: its size says something, its digits do not.
            closure.map_or_else(String::new, |gap| if gap < 1e-9 { "&lt; 10⁻⁹".to_owned() } else { significant(gap, 2) }),
        ));
    }
    out.push_str(
        "</tbody>\n</table></div>\n<p class=\"caption\">Heat and work are integrated apart from the motion, so the closure checks motion, forces \
         and law together. Plastic work of the elastoplastic model counts as dissipated.</p>\n</section>\n",
    );
}
