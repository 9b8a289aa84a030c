//! The equations of the transfer-function paper as typed there, for reproduction.

use crumple_signal::{Note, Notes};

use crate::SolveError;
use crate::matching::coefficient_matching::{Identified, Matched, Quartic, match_identified};

/// The printed denominator `s^4 + 35.7 s^3 + 6024 s^2 + 185000 s + 414600`.
const PRINTED: [f64; 4] = [35.7, 6024.0, 185_000.0, 414_600.0];
/// A fifth of the printed 1422 kg.
const FIFTH_KG: f64 = 284.4;
/// Four fifths of it.
const FOUR_FIFTHS_KG: f64 = 1137.6;
/// What is typed for the smaller mass on the right of the first equation.
const TYPED_KG: f64 = 284.6;

/// The solutions that the paper lists, from its printed polynomial: for reproduction only.
///
/// In the first of the four equations 284.6 kg is typed for 284.4 kg, which is to say that the coefficient of `s^3` is
/// `284.6/284.4` times the printed one. Both splits of the mass: one fifth in front, then four fifths. Candidates are
/// numbered from `first_index`; each says that it is a reproduction.
pub fn match_as_the_paper_typed(first_index: usize, notes: &mut Notes) -> Result<Vec<Matched>, SolveError> {
    let splits = [
        ("tfest-paper/one-fifth-in-front", FIFTH_KG, FOUR_FIFTHS_KG),
        ("tfest-paper/four-fifths-in-front", FOUR_FIFTHS_KG, FIFTH_KG),
    ];
    let [t, u, v, w] = PRINTED;
    let mut results: Vec<Matched> = Vec::new();
    for (id, m1_kg, m2_kg) in splits {
        let typed = t * TYPED_KG / FIFTH_KG;
        let identified = Identified {
            id: id.to_owned(),
            quartic: Quartic::Coefficients([typed, u, v, w]),
            numerator: None,
            source: "printed denominator of the transfer-function paper as typed for its solver,",
            realised: None,
            spread: None,
            delay_s: 0.0,
        };
        let first = first_index + results.iter().map(|matched| matched.candidates.len()).sum::<usize>();
        let mut matched = match_identified(&identified, m1_kg, m2_kg, first, notes)?;
        let label = "for reproduction only: 284.6 kg stands for 284.4 kg in the first right-hand side, as in the \
            paper, which lists k1 and c2 exchanged (its solver answers in the order c1, c2, k1, k2)";
        matched.remarks.push(label.to_owned());
        for candidate in &mut matched.candidates {
            candidate.notes.push(Note::info(label));
        }
        results.push(matched);
    }
    notes.warning(
        "the candidates of --paper tfest are those of the paper's printed polynomial, not of this test".to_owned(),
    );
    Ok(results)
}
