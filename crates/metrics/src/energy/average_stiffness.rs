/// Average stiffness k = m·v0²/C², N/m: the linear spring that stores the impact energy at the dynamic crush.
pub fn average_stiffness(mass_kg: f64, impact_speed_m_per_s: f64, dynamic_crush_m: f64) -> f64 {
    mass_kg * impact_speed_m_per_s * impact_speed_m_per_s / (dynamic_crush_m * dynamic_crush_m)
}
