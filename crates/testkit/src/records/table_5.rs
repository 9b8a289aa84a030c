//! The second nonlinear model of the single-mass paper.

use crumple_lumped::Nonlinear2;

/// Table 5 of the single-mass paper: 873 kg, crush and impact speed of its test.
pub fn table_5() -> Nonlinear2 {
    Nonlinear2 {
        mass_kg: 873.0,
        k1_n_per_m: 82_357.0,
        k2_n_per_m: 4.0,
        k3_n_per_m: 197_519.0,
        x1_m: 0.472,
        c1_n_s_per_m: 86_585.0,
        c2_n_s_per_m: 80_056.0,
        c3_n_s_per_m: 18_721.0,
        c4_n_s_per_m: 81.0,
        v1_m_per_s: 2.55,
        v2_m_per_s: 7.23,
        crush_m: 0.5063,
        v0_m_per_s: 9.7222,
    }
}
