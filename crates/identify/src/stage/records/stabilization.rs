//! The stabilisation diagram of a method, as a record.

use std::f64::consts::TAU;

use crumple_stage::Output;
use crumple_stage::records::{StabilizationClusterV1, StabilizationPoleV1, StabilizationV1};
use crumple_sysid::{OrderPoles, StabilizationOptions, stabilization};

use crate::stage::options::evidence::Stabilisation;

/// Writes the diagram of models of one channel.
pub fn put_diagram(
    method: &str,
    channel: &str,
    models: &[OrderPoles],
    dt_s: f64,
    settings: &Stabilisation,
    out: &mut Output,
) -> anyhow::Result<()> {
    if models.is_empty() {
        out.notes().info(format!("{method}: no stabilisation diagram: the record supports no order of two"));
        return Ok(());
    }
    let options = StabilizationOptions { highest_damping: settings.highest_damping, ..StabilizationOptions::default() };
    let diagram = stabilization(models, dt_s, options);
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let several = diagram.poles.iter().any(|pole| pole.shape.len() > 1);
    let record = StabilizationV1 {
        method: method.to_owned(),
        channel: channel.to_owned(),
        orders: diagram.orders.iter().map(|order| size(*order)).collect(),
        highest_damping: options.highest_damping,
        nyquist_share: options.nyquist_share,
        least_collinearity: several.then_some(options.least_collinearity),
        least_strength: diagram.poles.iter().any(|pole| pole.strength.is_some()).then_some(options.least_strength),
        frequency_change: options.frequency_change,
        damping_change: options.damping_change,
        shape_change: several.then_some(options.shape_change),
        presence: options.presence,
        poles: diagram
            .poles
            .iter()
            .map(|pole| StabilizationPoleV1 {
                order: size(pole.order),
                re_per_s: pole.mode.pole.re,
                im_rad_per_s: pole.mode.pole.im,
                stability: pole.stability.name().to_owned(),
            })
            .collect(),
        clusters: diagram
            .clusters
            .iter()
            .map(|cluster| StabilizationClusterV1 {
                orders: size(cluster.orders),
                natural_frequency_rad_per_s: cluster.natural_frequency_rad_per_s.median,
                natural_frequency_lower_rad_per_s: cluster.natural_frequency_rad_per_s.lower,
                natural_frequency_upper_rad_per_s: cluster.natural_frequency_rad_per_s.upper,
                damping_ratio: cluster.damping_ratio.median,
                damping_ratio_lower: cluster.damping_ratio.lower,
                damping_ratio_upper: cluster.damping_ratio.upper,
            })
            .collect(),
    };
    let highest = diagram.orders.last().copied().unwrap_or(0);
    let names: Vec<String> = diagram
        .clusters
        .iter()
        .map(|c| {
            let hz = c.natural_frequency_rad_per_s.median / TAU;
            format!("{hz:.2} Hz (damping {:.3}, in {} orders)", c.damping_ratio.median, c.orders)
        })
        .collect();
    out.summary(if names.is_empty() {
        format!("{method}: no mode stays over half of the orders up to {highest}")
    } else {
        format!("{method}: modes that stay over the orders up to {highest}: {}", names.join(", "))
    });
    out.put(&format!("/stabilisation/{method}"), &record)
}
