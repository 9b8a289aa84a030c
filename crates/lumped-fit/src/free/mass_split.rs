//! How the mass of the car divides among the masses of a model.

use crate::SolveError;

/// How the test mass divides into chassis (next to the barrier) and compartment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MassSplit {
    /// `m1/(m1 + m2)`.
    FrontFraction(f64),
    /// Mass of the chassis alone, kg; the compartment is the rest.
    Front(f64),
    /// Mass of the compartment alone, kg; the chassis is the rest.
    Rear(f64),
    /// Both, kg.
    Both(f64, f64),
}

/// Which sensors could tell how the mass divides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassEvidence {
    /// Those of the compartment alone, which a division and its mirror image move alike.
    Compartment,
    /// One on another mass too.
    SeveralMasses,
}

impl MassEvidence {
    /// What it means for a division that is assumed.
    fn in_words(self) -> &'static str {
        match self {
            Self::Compartment => "one sensor cannot identify it, and the parameters depend on it",
            Self::SeveralMasses => {
                "the parameters depend on it; the sensors on several masses can identify it, with fit_masses = \"free\""
            }
        }
    }
}

/// Masses of chassis and compartment, kg, with the sentence that says where they come from.
///
/// All springs and dampers of the double model depend on how the mass divides. Errors: a share outside 0 to 1, a mass
/// that is not positive or not below the test mass.
pub fn masses(mass_kg: f64, split: MassSplit, evidence: MassEvidence) -> Result<(f64, f64, String), SolveError> {
    let value = |name, value, expected| SolveError::Value { name, value, expected };
    let below = "positive and below the test mass";
    let (m1, m2, source) = match split {
        MassSplit::FrontFraction(f) if f > 0.0 && f < 1.0 => {
            (f * mass_kg, (1.0 - f) * mass_kg, format!("front mass fraction {f} assumed: {}", evidence.in_words()))
        }
        MassSplit::FrontFraction(f) => return Err(value("front_mass_fraction", f, "between 0 and 1")),
        MassSplit::Front(m1) if m1 > 0.0 && m1 < mass_kg => (m1, mass_kg - m1, "m1 given, m2 is the rest".to_owned()),
        MassSplit::Front(m1) => return Err(value("m1_kg", m1, below)),
        MassSplit::Rear(m2) if m2 > 0.0 && m2 < mass_kg => (mass_kg - m2, m2, "m2 given, m1 is the rest".to_owned()),
        MassSplit::Rear(m2) => return Err(value("m2_kg", m2, below)),
        MassSplit::Both(m1, m2) => {
            crate::error::positive("m1_kg", m1)?;
            crate::error::positive("m2_kg", m2)?;
            (m1, m2, "both masses given".to_owned())
        }
    };
    let total = sum_remark(m1 + m2, mass_kg);
    Ok((m1, m2, format!("m1 = {m1:.2} kg, m2 = {m2:.2} kg: {source}{total}")))
}

/// The remark on given masses whose sum differs from the test mass by more than 0.5 %; empty otherwise.
fn sum_remark(sum_kg: f64, mass_kg: f64) -> String {
    if (sum_kg - mass_kg).abs() > 5e-3 * mass_kg {
        format!("; their sum {sum_kg:.1} kg is not the test mass {mass_kg:.1} kg")
    } else {
        String::new()
    }
}

/// Masses of engine, of suspension and chassis, and of the compartment, kg, with the sentence that says where they
/// come from: those given, else the front mass of the double model halved, which is an assumption.
pub fn triple_masses(
    mass_kg: f64,
    split: MassSplit,
    given: Option<[f64; 3]>,
    evidence: MassEvidence,
) -> Result<([f64; 3], String), SolveError> {
    if let Some(masses) = given {
        for (name, mass) in ["m1_kg", "m2_kg", "m3_kg"].into_iter().zip(masses) {
            crate::error::positive(name, mass)?;
        }
        let [a, b, c] = masses;
        let total = sum_remark(a + b + c, mass_kg);
        return Ok((masses, format!("m1 = {a:.2} kg, m2 = {b:.2} kg, m3 = {c:.2} kg: given{total}")));
    }
    let (front, rear, _) = masses(mass_kg, split, evidence)?;
    let half = 0.5 * front;
    let text = format!(
        "m1 = m2 = {half:.2} kg, m3 = {rear:.2} kg: the front mass halved between engine and chassis is assumed: {}",
        evidence.in_words()
    );
    Ok(([half, half, rear], text))
}
