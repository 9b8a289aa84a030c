//! The elastoplastic model: its closed form, its motion under any drive, its derivatives.
//! May use `exact`, `motion` and `kind`.

pub mod closed_form;
pub mod driven;
pub mod sensitivity;
