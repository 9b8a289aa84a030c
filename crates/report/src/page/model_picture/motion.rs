//! How far the masses of a picture move, for the cursor of the page.

use crate::drawing::numbers::MILLI;
use crate::findings::CandidateResult;
use crumple_signal::Sampled;

use super::layout::Layout;

/// Steps from the contact to the end.
const STEPS: usize = 60;
/// What is left of a gap at the largest crush, in units of the picture.
const LEFT_OVER: f64 = 6.0;

/// Places of the masses over time.
pub struct Motion {
    /// Time of the last step, ms after time zero; the first is at time zero.
    pub until_ms: f64,
    /// Of each mass from the barrier on how far it has come, in units of the picture, to one scale.
    pub places: Vec<Vec<f64>>,
}

/// The motion of a candidate's masses up to a time; `None` where one of them is not at hand or none moves forward.
pub fn motion(candidate: &CandidateResult, layout: &Layout, until_ms: f64) -> Option<Motion> {
    let in_front = candidate.masses.iter().map(|(displacement, _)| displacement);
    let waves: Vec<&Sampled> = in_front.chain(&candidate.displacement).collect();
    if waves.len() != layout.masses.len() || until_ms <= 0.0 {
        return None;
    }
    let time_s = |step: usize| until_ms / MILLI * step as f64 / STEPS as f64;
    let of_wave = |wave: &Sampled| (0..=STEPS).map_while(|step| wave.at(time_s(step))).collect::<Vec<f64>>();
    let way_m: Vec<Vec<f64>> = waves.into_iter().map(of_wave).collect();
    let room = |place: usize| {
        let taken: f64 = layout.masses[..place].iter().map(|mass| mass.width).sum();
        layout.barrier - layout.masses[place].x - layout.masses[place].width - taken - LEFT_OVER
    };
    let largest = |way: &Vec<f64>| way.iter().copied().fold(0.0, f64::max);
    let scales = way_m.iter().enumerate().map(|(place, way)| room(place) / largest(way));
    let scale = scales.fold(f64::INFINITY, f64::min);
    let places = way_m.into_iter().map(|way| way.into_iter().map(|x| scale * x).collect()).collect();
    (scale.is_finite() && scale > 0.0).then_some(Motion { until_ms, places })
}
