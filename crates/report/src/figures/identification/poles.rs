//! Poles in the s plane with lines of equal damping and circles of equal frequency.

use crate::words;
use std::f64::consts::TAU;

use crate::drawing::{Axis, Colour, Figure, Label, Look, Panel, Symbol};
use crate::findings::{Model, PoleStability, Run};

/// Marks of the models, so that they differ without colour too.
const SYMBOLS: [Symbol; 4] = [Symbol::Cross, Symbol::Plus, Symbol::Star, Symbol::Square];
const DAMPING_RAYS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// A pole this many times farther out than the next nearer one lies outside the first view.
const FAR: f64 = 8.0;
/// Width between the ends of a panel's axis.
const PLANE_WIDTH: f64 = 480.0;

/// Every model's poles; `None` where no model has any.
pub fn figure(run: &Run) -> Option<Figure> {
    let mut moduli: Vec<f64> = run.models.iter().flat_map(Model::poles).map(|([re, im], _)| re.hypot(im)).collect();
    if moduli.is_empty() {
        return None;
    }
    moduli.sort_by(f64::total_cmp);
    let (radius, outside) = first_view(&moduli);

    let mut figure = Figure::new("poles", "Poles and zeros of the identified models");
    // The upper half of the plane: poles of a real system are mirrored in the lower one.
    let (left, right, low, high) = (-1.2 * radius, 0.42 * radius, -0.1 * radius, 1.18 * radius);
    let real = Axis::new("real part, 1/s").from_to([left, right]);
    let mut panel = Panel::new(real, Axis::new("imaginary part, rad/s").from_to([low, high]));
    // One length for a unit on both axes, so that circles are round.
    panel.height = PLANE_WIDTH * (high - low) / (right - left);
    guide_lines(&mut panel, radius, [low, high]);
    poles(run, &mut figure, &mut panel);
    let far_zeros = zeros(run, &mut figure, &mut panel, radius);
    figure.caption = caption(run, far_zeros, outside);
    figure.panels.push(panel);
    Some(figure.tidy())
}

/// The poles of every model, unstable ones apart.
fn poles(run: &Run, figure: &mut Figure, panel: &mut Panel) {
    for (place, model) in run.models.iter().enumerate() {
        for stable in [true, false] {
            let poles = model.poles().filter(|(_, stability)| (*stability != PoleStability::Unstable) == stable);
            let name = if stable { model.id.clone() } else { format!("{}, unstable", model.id) };
            let symbol = if stable { SYMBOLS[place % SYMBOLS.len()] } else { Symbol::Triangle };
            let colour = if stable { Colour::Series(place) } else { Colour::Event };
            let entry = figure.entry(name, Look::marks(colour, symbol), true);
            panel.points(entry, poles.map(|(pole, _)| pole).filter(|[_, im]| *im >= 0.0).collect());
        }
    }
}

/// The zeros of every model. Gives how many lie outside the first view of this radius.
fn zeros(run: &Run, figure: &mut Figure, panel: &mut Panel, radius: f64) -> usize {
    let mut far = 0;
    for (place, model) in run.models.iter().enumerate() {
        let Some(response) = &model.response else { continue };
        let zeros = || response.zeros_re_per_s.iter().zip(&response.zeros_im_rad_per_s).map(|(re, im)| [*re, *im]);
        let near = |[re, im]: &[f64; 2]| re.hypot(*im) <= 1.2 * radius;
        far += zeros().filter(|z| !near(z)).count();
        let look = Look::marks(Colour::Series(place), Symbol::Ring);
        let entry = figure.entry(format!("{}, zeros", model.id), look, run.models.len() <= 3);
        // No name in the legend without a mark in the view.
        panel.points(entry, zeros().filter(|z| near(z) && z[1] >= 0.0).collect());
    }
    far
}

/// Rays of equal damping, rings of equal frequency and the imaginary axis, with their labels.
fn guide_lines(panel: &mut Panel, radius: f64, [low, high]: [f64; 2]) {
    for damping in DAMPING_RAYS {
        let end = [-damping * radius, (1.0 - damping * damping).sqrt() * radius];
        panel.guides.push(vec![[0.0, 0.0], end]);
        panel.labels.push(Label { at: end, text: format!("ζ {}", words::decimals(damping, 1)) });
    }
    let step = nice_step(radius / TAU / 2.5);
    for ring in (1..=4).map(|ring| TAU * step * f64::from(ring)).take_while(|r| *r <= 1.02 * radius) {
        let arc = (0..=60).map(|k| f64::from(k) / 60.0 * std::f64::consts::PI);
        panel.guides.push(arc.map(|angle| [ring * angle.cos(), ring * angle.sin()]).collect());
        panel.labels.push(Label { at: [0.0, ring], text: format!("{} Hz", words::significant(ring / TAU, 2)) });
    }
    panel.guides.push(vec![[0.0, low], [0.0, high]]);
}

/// What the figure shows, how many poles are not stable, what lies outside of it.
fn caption(run: &Run, far_zeros: usize, outside: usize) -> String {
    let poles = || run.models.iter().flat_map(Model::poles);
    let [stable, marginal, unstable] = [PoleStability::Stable, PoleStability::Marginal, PoleStability::Unstable]
        .map(|wanted| poles().filter(|(_, stability)| *stability == wanted).count());
    // A model whose poles nobody wrote may have any.
    let all_known = run.models.iter().all(|model| model.poles().next().is_some() || model.identification.is_none());
    let mut caption = String::from(
        "Continuous poles, and zeros as circles; their mirror images below the real axis are not drawn. Rays join \
         poles of equal damping ratio ζ, circles those of equal natural frequency.",
    );
    if all_known && marginal + unstable == 0 && stable > 0 {
        caption.push_str(" All poles are stable.");
    }
    // Of the wider side of the view some zeros may still be in sight.
    for (count, one, several) in [
        (
            unstable,
            " One pole is unstable (right half plane): it describes the window, not what was measured.",
            format!(
                " {unstable} poles are unstable (right half plane): they describe the window, not what was measured."
            ),
        ),
        (
            marginal,
            " One pole is marginal (on the stability limit): it neither dies down nor grows over the record.",
            format!(
                " {marginal} poles are marginal (on the stability limit): they neither die down nor grow over \
                 the record."
            ),
        ),
        (
            far_zeros,
            " 1 zero lies farther out than these poles.",
            format!(" {far_zeros} zeros lie farther out than these poles."),
        ),
        (outside, " 1 far pole lies outside the axes.", format!(" {outside} far poles lie outside the axes.")),
    ] {
        match count {
            0 => {}
            1 => caption.push_str(one),
            _ => caption.push_str(&several),
        }
    }
    caption
}

/// Radius of the first view and the number of poles left outside it, from moduli in rising order.
fn first_view(moduli: &[f64]) -> (f64, usize) {
    // The view must hold half of the poles: a single slow one does not push all others out.
    let half = moduli.len() / 2;
    let gap = |k: &usize| moduli[*k] > 0.0 && moduli[k + 1] > FAR * moduli[*k];
    let far = (half.saturating_sub(1)..moduli.len() - 1).find(gap);
    let inside = far.map_or(moduli.len(), |index| index + 1);
    let radius = 1.12 * moduli[inside - 1];
    (if radius > 0.0 { radius } else { 1.0 }, moduli.len() - inside)
}

/// The largest of 1, 2, 5 times a power of ten that is not above `x`.
fn nice_step(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|step| *step <= x).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_pole_does_not_crowd_the_others() {
        let (radius, outside) = first_view(&[10.0, 30.0, 32.0, 5000.0]);
        assert_eq!((radius, outside), (1.12 * 32.0, 1));
        assert_eq!(first_view(&[0.0]), (1.0, 0));
        assert_eq!(first_view(&[0.02, 3.0, 3.5, 9.0]), (1.12 * 9.0, 0));
    }

    #[test]
    fn rings_are_at_round_frequencies() {
        assert_eq!(nice_step(7.0), 5.0);
        assert_eq!(nice_step(0.3), 0.2);
    }
}
