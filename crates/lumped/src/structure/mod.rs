//! What a model is made of: masses, and elements between any two nodes. An element is one file in `elements/`.

pub mod connected_masses;
pub mod element;
pub mod elements;
pub mod form;
pub mod law;
