//! What an assessment needs to know of free numbers: their names, their kinds, and their values at a coordinate.

use crumple_lumped::ParameterKind;

use crate::free::parameterisation::Parameterisation;

/// Free numbers with names. A coordinate is the logarithm of its value, or near zero its share of a scale.
pub(crate) trait FreeNumbers: Parameterisation {
    /// Names with units, in the order of the coordinates.
    fn names(&self) -> Vec<String>;

    /// What a number is.
    fn kind(&self, index: usize) -> ParameterKind;

    /// Whether its coordinate is a logarithm; a share ends at zero.
    fn is_logarithmic(&self, _index: usize) -> bool {
        true
    }

    /// Its value at a coordinate, in the unit of its name.
    fn value(&self, _index: usize, coordinate: f64) -> f64 {
        coordinate.exp()
    }

    /// The coordinate of a value.
    fn coordinate(&self, _index: usize, value: f64) -> f64 {
        value.ln()
    }

    /// Derivative of the value by the coordinate.
    fn slope(&self, index: usize, coordinate: f64) -> f64 {
        self.value(index, coordinate)
    }

    /// Name and value, kg, of the mass that is the rest of a known total and follows from masses that are free.
    fn rest(&self, theta: &[f64]) -> Option<(String, f64)>;
}
