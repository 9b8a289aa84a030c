//! What curves are read from, with a rate factor that all tests share.

use crumple_signal::TwoPassFilter;

/// A curve that is asked for: the elements of every test that follow it.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedCurve {
    /// Deflections of its knots, m, rising; the first is zero, where the force is zero. The last slope goes on.
    pub knots_m: Vec<f64>,
    /// Rate factor `r` of the loading force, s/m: `F (1 + r w)`.
    pub rate_s_per_m: f64,
}

/// An element in a test: what it joins and which curve it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredElement {
    /// The mass on the side of the wall, by its place in the test; `None`: the wall.
    pub front: Option<usize>,
    /// The mass behind.
    pub rear: usize,
    /// The curve, by its place.
    pub curve: usize,
    /// Way before it is touched, m.
    pub gap_m: f64,
}

/// A mass in a test and its measured motion, positive towards the wall.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredMass {
    /// Mass, kg; `None`: free, its motion times it is one more unknown.
    pub mass_kg: Option<f64>,
    /// Displacement at every sample, m.
    pub displacement_m: Vec<f64>,
    /// Velocity, m/s.
    pub velocity_m_per_s: Vec<f64>,
    /// Acceleration, m/s².
    pub acceleration_m_per_s2: Vec<f64>,
    /// Standard deviation of its equation of motion, N; all the same: 1.
    pub noise_n: f64,
}

/// A force on the wall, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredWall {
    /// Force at every sample, N, positive in compression: the sum over the elements that touch the wall.
    pub force_n: Vec<f64>,
    /// Standard deviation of it, N.
    pub noise_n: f64,
}

/// What accelerations and wall force went through before they were recorded, and the samples of them that are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredThrough {
    /// The filter: the forces of the elements go through it too. `None`: none.
    pub filter: Option<TwoPassFilter>,
    /// Samples whose equations of motion count; a filter looks at the others too.
    pub compared: Vec<usize>,
}

/// A test: masses and elements, sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtractionTest {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Masses from the wall on.
    pub masses: Vec<MeasuredMass>,
    /// Elements between them.
    pub elements: Vec<MeasuredElement>,
    /// Sum of all masses, kg, where some are free.
    pub total_mass_kg: Option<f64>,
    /// Force on the wall, where it was measured.
    pub wall: Option<MeasuredWall>,
    /// How accelerations and wall force were measured; `None`: as they are, all samples.
    pub through: Option<MeasuredThrough>,
}

/// What was extracted.
#[derive(Debug, Clone, PartialEq)]
pub struct Extraction {
    /// Forces at the knots of every curve, N; the first is zero.
    pub forces_n: Vec<Vec<f64>>,
    /// Unloading stiffness of every curve, N/m; `None` where nothing unloaded.
    pub unloading_n_per_m: Vec<Option<f64>>,
    /// Masses of every test, kg.
    pub masses_kg: Vec<Vec<f64>>,
    /// Sum of squares of the weighted equations and of the weighted changes of slope.
    pub objective: f64,
    /// Of every curve, the knots whose force is held at zero, the first among them.
    pub knots_at_zero: Vec<Vec<usize>>,
    /// Unknowns that the measurement determines, with smoothing: `tr(H (H'H + λD'D)^-1 H')`.
    pub effective_unknowns: f64,
}
