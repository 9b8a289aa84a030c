//! The recursion of time warping.

/// Costs of cells of one diagonal from the two before it: `out[p] = (c[p] - t[p])² + min(up, left, corner)[p]`.
///
/// Compiled once for every width of vectors, inside the functions that call it.
#[inline(always)]
pub(super) fn accumulate(c: &[f64], t: &[f64], up: &[f64], left: &[f64], corner: &[f64], out: &mut [f64]) {
    let length = out.len();
    let (c, t, up, left, corner) = (&c[..length], &t[..length], &up[..length], &left[..length], &corner[..length]);
    for p in 0..length {
        let gap = c[p] - t[p];
        let one = if up[p] < left[p] { up[p] } else { left[p] };
        let least = if one < corner[p] { one } else { corner[p] };
        out[p] = gap * gap + least;
    }
}
