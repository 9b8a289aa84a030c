//! Square waves of acceleration that are equivalent to a pulse. Huang, *Vehicle Crash Mechanics* (2002).
//! Their ratio is the shape of the pulse: t_c/t_m = ASW/(2·ESW).

/// Equivalent square wave by displacement, ESW = v0²/(2C), m/s²: the constant deceleration with the same crush.
pub fn equivalent_square_wave(impact_speed_m_per_s: f64, dynamic_crush_m: f64) -> f64 {
    impact_speed_m_per_s * impact_speed_m_per_s / (2.0 * dynamic_crush_m)
}

/// Average square wave by time, ASW = v0/t_m, m/s²: the constant deceleration that stops in the same time.
pub fn average_square_wave(impact_speed_m_per_s: f64, time_of_dynamic_crush_s: f64) -> f64 {
    impact_speed_m_per_s / time_of_dynamic_crush_s
}
