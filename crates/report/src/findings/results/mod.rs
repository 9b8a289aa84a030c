//! Everything the artifacts of a run say: its types, the ranking of candidates, residuals, bands of models.

pub mod joint;
pub mod mass_divisions;
pub mod model_output;
pub mod one_spring;
pub mod parameters;
pub mod ranking;
pub mod run;
