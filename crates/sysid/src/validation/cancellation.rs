//! Poles that zeros cancel: those of an order that is too high.
//!
//! A model with more poles than the record shows has a zero beside each of the surplus ones. Such a pole is a product
//! of the noise, its deviation that of a frequency in the noise (Ljung, *System Identification*, 2nd ed. 1999, ch. 16:
//! a pole and a zero whose regions of confidence overlap cancel; Söderström & Stoica, *System Identification*, 1989,
//! ch. 11: the model with fewer parameters is taken where its loss is not significantly larger).

use crumple_numerics::lti::Complex;

use crate::output_error::output_error::{OutputError, output_error_from};
use crate::{InformationCriteria, IoData, OutputErrorOptions, PolynomialForm};
use crate::{autoregressive_effective_samples, fit_measures};

/// Poles of the models that are looked at, and samples, from the first on.
const MOST_POLES: usize = 8;
const MOST_SAMPLES: usize = 20_000;

/// A mean square error below this, of outputs divided by their root mean squares, is rounding.
const ROUNDING: f64 = 1e-20;

/// Poles of a model that the record does not ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct Cancelled {
    /// The sampled poles, both of a pair.
    pub poles: Vec<Complex>,
    /// Fit of the simulation with all poles, percent; the smallest of several outputs.
    pub fit_percent: f64,
    /// The same of the model without these poles, fitted again.
    pub without_percent: f64,
}

/// The sampled poles of a model of one input or one output that zeros cancel. `None`: there are none, several inputs
/// and outputs, more than eight poles, or no fit.
///
/// Output error is fitted from the poles of the model and from those without one pole or pair, over and over while
/// Schwarz's criterion on all samples falls. With one input and one output the zero must also lie beside the
/// pole: no further away than the noise brings it, at 95 % over all frequencies that the record tells apart.
pub fn cancelled_poles(data: &IoData, poles: &[Complex]) -> Option<Cancelled> {
    let paths = (data.inputs().len(), data.outputs().len());
    if paths.0.min(paths.1) != 1 || !(2..=MOST_POLES).contains(&poles.len()) {
        return None;
    }
    let data = data.slice(0, MOST_SAMPLES).ok()?;
    let fitted = |poles: &[Complex]| {
        let options = OutputErrorOptions { random_starts: 0, ..OutputErrorOptions::new(poles.len()) };
        output_error_from(&data, options, &[poles.to_vec()]).ok()
    };
    let mut current = fitted(poles)?;
    let samples = effective_samples(&data, &current);
    // All samples count: what is counted too high here keeps a pole, and no mode of the record is lost.
    let count = samples.max((data.samples() * data.outputs().len()) as f64);
    let bic = |fit: &OutputError| InformationCriteria::new(fit.loss.max(ROUNDING), count, fit.criteria.parameters).bic;
    let fit_percent = worst_fit(&data, &current)?;
    loop {
        let own = poles_of(&current);
        let is_of = |z: &Complex, unit: &Complex| *z == *unit || *z == unit.conj();
        let units = own.iter().filter(|z| z.im >= 0.0 && lies_beside_a_zero(&data, &current, **z, samples));
        let tried = units.filter_map(|unit| {
            let rest: Vec<Complex> = own.iter().filter(|z| !is_of(z, unit)).copied().collect();
            if rest.is_empty() { None } else { fitted(&rest) }
        });
        let best = tried.min_by(|a, b| bic(a).total_cmp(&bic(b))).filter(|best| bic(best) < bic(&current));
        let Some(fit) = best else { break };
        current = fit;
    }
    let without_percent = worst_fit(&data, &current)?;
    let surplus = without_nearest(poles, &poles_of(&current));
    (!surplus.is_empty()).then_some(Cancelled { poles: surplus, fit_percent, without_percent })
}

/// The poles that all paths share.
fn poles_of(fit: &OutputError) -> Vec<Complex> {
    fit.pole_deviations.iter().map(|(pole, _)| *pole).collect()
}

/// The poles that are left where each of `kept` takes the nearest one, the nearest of all first; a pair takes a pair.
fn without_nearest(poles: &[Complex], kept: &[Complex]) -> Vec<Complex> {
    let (mut left, mut kept) = (poles.to_vec(), kept.to_vec());
    while !kept.is_empty() && !left.is_empty() {
        let distance = |(i, k): &(usize, usize)| {
            let other_kind = if (left[*i].im == 0.0) == (kept[*k].im == 0.0) { 0.0 } else { 1.0 };
            other_kind + (left[*i] - kept[*k]).norm()
        };
        let all = (0..left.len()).flat_map(|i| (0..kept.len()).map(move |k| (i, k)));
        let Some((i, k)) = all.min_by(|a, b| distance(a).total_cmp(&distance(b))) else { break };
        left.remove(i);
        kept.remove(k);
    }
    // Of a pair whose other half was taken by a real pole nothing is left.
    let whole = |z: &Complex| z.im == 0.0 || left.contains(&z.conj());
    left.iter().filter(|z| whole(z)).copied().collect()
}

fn errors(data: &IoData, fit: &OutputError) -> Vec<Vec<f64>> {
    let of_output = |(y, yh): (&Vec<f64>, &Vec<f64>)| y.iter().zip(yh).map(|(y, yh)| y - yh).collect();
    data.outputs().iter().zip(&fit.simulated).map(of_output).collect()
}

/// Independent samples that the errors of all outputs are worth.
fn effective_samples(data: &IoData, fit: &OutputError) -> f64 {
    errors(data, fit).iter().map(|errors| autoregressive_effective_samples(errors)).sum()
}

fn worst_fit(data: &IoData, fit: &OutputError) -> Option<f64> {
    let fits = data.outputs().iter().zip(&fit.simulated).map(|(y, yh)| fit_measures(y, yh)?.fit_percent);
    fits.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::min)
}

/// Whether a zero of a single path lies beside the pole nearest to this one: the square of their distance in deviations
/// of the noise, which is that of chi-square with two degrees of freedom, at most `2 ln(10 N)`, one chance in twenty
/// over `N/2` frequencies (Bonferroni). Of several channels it is not asked for.
fn lies_beside_a_zero(data: &IoData, fit: &OutputError, pole: Complex, independent: f64) -> bool {
    if data.inputs().len() + data.outputs().len() > 2 {
        return true;
    }
    let count = data.samples() as f64;
    let loss = errors(data, fit)[0].iter().map(|e| e * e).sum::<f64>() / count;
    let Ok(form) = PolynomialForm::new(&fit.model) else { return false };
    // Without a determined distance the zero may lie anywhere.
    let Ok(deviations) = form.white_deviations(data, loss * count / independent) else { return false };
    form.distance_of_zero(&deviations, pole).is_some_and(|square| square <= 2.0 * (10.0 * count).ln())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;

    /// `y = 1.5 y1 - 0.7 y2 + u1 + 0.5 u2`, a mode beside it of this strength, and noise of 5 %; and the fit of the
    /// truth to it, percent.
    fn record(seed: u64, beside: f64) -> (IoData, f64) {
        let mut random = RandomNumbers::seeded(seed);
        let u: Vec<f64> = (0..800).map(|_| random.normal()).collect();
        let (mut y, mut v) = (vec![0.0; 800], vec![0.0; 800]);
        for k in 2..800 {
            y[k] = 1.5 * y[k - 1] - 0.7 * y[k - 2] + u[k - 1] + 0.5 * u[k - 2];
            v[k] = 0.6 * v[k - 1] - 0.95 * v[k - 2] + beside * u[k - 1];
        }
        let truth: Vec<f64> = y.iter().zip(&v).map(|(y, v)| y + v).collect();
        let output: Vec<f64> = truth.iter().map(|truth| truth + 0.25 * random.normal()).collect();
        let of_the_truth = fit_measures(&output, &truth).and_then(|fit| fit.fit_percent).unwrap();
        (IoData::single(u, output, 0.1).unwrap(), of_the_truth)
    }

    #[test]
    fn surplus_poles_cancel_and_weak_modes_do_not() {
        for seed in 0..6 {
            let (data, of_the_truth) = record(seed, 0.0);
            let options = OutputErrorOptions::new(4);
            let fit = crate::output_error(&data, options).unwrap();
            let found = cancelled_poles(&data, &fit.model.poles().unwrap()).unwrap();
            assert_eq!(found.poles.len(), 2, "{seed}: {found:?}");
            // Fitted numbers of the true order leave no more than the truth does.
            assert!(found.without_percent > of_the_truth - 1e-3, "{seed}: {found:?} {of_the_truth}");
            assert!(found.fit_percent >= found.without_percent - 1e-6, "{found:?}");
            assert!(found.poles.iter().all(|z| (z - Complex::new(0.75, 0.37)).norm() > 0.05), "{seed}: {found:?}");
            // A mode of two fifths of the noise is there.
            let (data, _) = record(seed, 0.03);
            let fit = crate::output_error(&data, options).unwrap();
            assert_eq!(cancelled_poles(&data, &fit.model.poles().unwrap()), None, "{seed}");
        }
    }
}
