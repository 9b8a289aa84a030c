//! The load-cell barrier of a real frontal test, NHTSA 10146: its impulse over the mass.

use std::io::Read;

use crumple_integrate::{impulse_n_s, sum_of_cells};
use crumple_signal::Sampled;

const MASS_KG: f64 = 1719.0;
/// Marked failed by the laboratory.
const FAILED: [&str; 2] = ["347", "500"];

/// Curve number and force of every cell, as read.
fn cells() -> Option<Vec<(String, Sampled)>> {
    let path = crumple_testkit::shared("data/nhtsa-v10146-camry-frontal/v10146_barrier_fx.zip")?;
    let mut archive = zip::ZipArchive::new(std::fs::File::open(path).unwrap()).unwrap();
    let cells = (0..archive.len()).map(|k| {
        let mut file = archive.by_index(k).unwrap();
        let (mut text, id) = (String::new(), file.name().unwrap().rsplit_once('.').unwrap().1.to_owned());
        file.read_to_string(&mut text).unwrap();
        let column = text.lines().map(|line| line.split_once('\t').unwrap().1.trim().parse().unwrap()).collect();
        (id, Sampled::new(-0.05, 1e-4, column).unwrap())
    });
    Some(cells.collect())
}

fn delta_v_km_per_h(cells: &[(String, Sampled)], left_out: &[&str]) -> f64 {
    let taken: Vec<(&str, &Sampled)> = cells
        .iter()
        .filter(|(id, _)| !left_out.contains(&id.as_str()))
        .map(|(id, samples)| (id.as_str(), samples))
        .collect();
    let sum = sum_of_cells(&taken).unwrap().unwrap();
    assert_eq!((sum.cells, sum.turned), (taken.len(), true), "this laboratory reads compression as negative");
    3.6 * impulse_n_s(&sum.force, 0.0, sum.force.end_s()).unwrap() / MASS_KG
}

#[test]
fn the_impulse_over_the_mass_is_68_km_per_h_with_all_cells_and_without_the_dead_ones() {
    let Some(cells) = cells() else { return };
    assert_eq!(cells.len(), 176);
    // Published as 68.0 km/h: half a unit of the last digit.
    assert!((delta_v_km_per_h(&cells, &[]) - 68.0).abs() < 0.05, "{}", delta_v_km_per_h(&cells, &[]));
    // The two dead cells read noise around zero.
    assert!((delta_v_km_per_h(&cells, &FAILED) - 68.0).abs() < 0.05, "{}", delta_v_km_per_h(&cells, &FAILED));
    println!(
        "{:.3} km/h, without the dead cells {:.3}",
        delta_v_km_per_h(&cells, &[]),
        delta_v_km_per_h(&cells, &FAILED)
    );
}

#[test]
fn the_impulse_agrees_with_the_accelerometers_within_three_percent() {
    let Some(cells) = cells() else { return };
    let of_barrier = delta_v_km_per_h(&cells, &[]);
    // Largest change of velocity of the four rear-seat channels, as published with the record.
    for of_sensor in [66.2, 67.0, 67.5, 66.8] {
        // 3 % is what the publisher of the record states for the agreement.
        assert!((of_barrier / of_sensor - 1.0).abs() < 0.03, "{of_barrier} {of_sensor}");
    }
}
