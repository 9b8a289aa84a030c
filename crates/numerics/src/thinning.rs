//! A line through points, drawn with fewer of them: of a pixel's columns the extremes, and no point that a straight
//! line replaces.

/// Columns a unit of width: two of a display's pixels on most displays, and room to zoom.
const COLUMNS: f64 = 2.0;
/// A point of a figure is needless where the line without it stays this near, units of the drawing.
pub const NEAR: f64 = 0.05;

/// Thins points of a drawing. Ends and extremes stay: of every column the first, the lowest, the highest and the last
/// point, and a peak is moved by less than `near`.
pub fn thinned(points: &[[f64; 2]], near: f64) -> Vec<[f64; 2]> {
    let rising = points.windows(2).all(|pair| pair[1][0] >= pair[0][0]);
    if rising { straightened(&by_columns(points), near) } else { straightened(points, near) }
}

fn by_columns(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| column_of(a[0]) == column_of(b[0])) {
        kept.extend(places_of_extremes(column.len(), |k| column[k][1]).map(|k| column[k]));
    }
    kept
}

/// Places of the first, the lowest, the highest and the last of at least one value, in order, each once.
pub fn extremes(values: &[f64]) -> Vec<usize> {
    places_of_extremes(values.len(), |k| values[k]).collect()
}

fn places_of_extremes(count: usize, value: impl Fn(usize) -> f64) -> impl Iterator<Item = usize> {
    let extreme = |better: fn(f64, f64) -> bool| {
        (0..count).fold(0, |best, k| if better(value(k), value(best)) { k } else { best })
    };
    let mut places = [0, extreme(|a, b| a < b), extreme(|a, b| a > b), count - 1];
    places.sort_unstable();
    (0..places.len()).filter(move |k| *k == 0 || places[k - 1] != places[*k]).map(move |k| places[k])
}

/// Number of the column of a place: the largest whole number below, without a call of the library.
fn column_of(x: f64) -> i64 {
    let x = x * COLUMNS;
    let towards_zero = x as i64;
    towards_zero - i64::from(towards_zero as f64 > x)
}

/// Ramer (1972), Douglas & Peucker (1973), without recursion.
fn straightened(points: &[[f64; 2]], near: f64) -> Vec<[f64; 2]> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut needed = vec![false; points.len()];
    needed[0] = true;
    needed[points.len() - 1] = true;
    let mut stretches = vec![(0, points.len() - 1)];
    while let Some((from, to)) = stretches.pop() {
        let offset_of = |k: usize| offset(points[k], points[from], points[to]);
        let distance = |[x, y]: [f64; 2]| x.hypot(y);
        let (mut most, mut farthest) = (near * near, None);
        for k in from + 1..to {
            let here = offset_of(k);
            let square = here[0] * here[0] + here[1] * here[1];
            // The root of the library is exact to the last bit, and slow: it is taken where it decides.
            let is_farther = square > most * (1.0 - ROUNDING)
                && (square > most * (1.0 + ROUNDING)
                    || distance(here) > farthest.map_or(near, |k| distance(offset_of(k))));
            if is_farther {
                (most, farthest) = (square, Some(k));
            }
        }
        if let Some(k) = farthest {
            needed[k] = true;
            stretches.extend([(from, k), (k, to)]);
        }
    }
    points.iter().zip(needed).filter_map(|(point, needed)| needed.then_some(*point)).collect()
}

/// Sums of squares that differ by more than this share are of distances in the same order: both are rounded by less
/// than 1e-15.
const ROUNDING: f64 = 1e-14;

/// From the nearest place of a stretch of line to a point.
fn offset([x, y]: [f64; 2], [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> [f64; 2] {
    let (along, up) = (x1 - x0, y1 - y0);
    let length = along * along + up * up;
    let share = if length > 0.0 { (((x - x0) * along + (y - y0) * up) / length).clamp(0.0, 1.0) } else { 0.0 };
    [x - x0 - share * along, y - y0 - share * up]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_of_one_sample_survives_and_both_ends_do() {
        let mut points: Vec<[f64; 2]> =
            (0..100_000).map(|k| [f64::from(k) * 4.8e-3, 100.0 + 20.0 * (f64::from(k) * 1e-3).sin()]).collect();
        points[54_321][1] = 7.0;
        points[77_777][1] = 190.0;
        let kept = thinned(&points, NEAR);
        assert!(kept.len() < 3_000, "{}", kept.len());
        for index in [0, 54_321, 77_777, 99_999] {
            assert!(kept.contains(&points[index]), "{index}");
        }
    }

    #[test]
    fn a_smooth_curve_is_met_everywhere_with_few_points() {
        let curve = |x: f64| 120.0 - 110.0 * (x / 480.0 * std::f64::consts::PI).sin();
        let points: Vec<[f64; 2]> = (0..=4_800).map(|k| [f64::from(k) * 0.1, curve(f64::from(k) * 0.1)]).collect();
        let kept = thinned(&points, NEAR);
        assert!(kept.len() < 150, "{}", kept.len());
        for pair in kept.windows(2) {
            let middle = [(pair[0][0] + pair[1][0]) / 2.0, (pair[0][1] + pair[1][1]) / 2.0];
            // Twice the distance allowed: that is to the nearest of the given points, which lie 0.1 apart.
            assert!((curve(middle[0]) - middle[1]).abs() < 2.0 * NEAR, "{middle:?}");
        }
    }

    #[test]
    fn a_loop_keeps_its_order() {
        // Up and back again: not a function of x, so no columns.
        let points: Vec<[f64; 2]> = (0..=20).map(|k| [f64::from(10 - (k - 10_i32).abs()), f64::from(k)]).collect();
        assert_eq!(thinned(&points, NEAR), [[0.0, 0.0], [10.0, 10.0], [0.0, 20.0]]);
    }
}
