//! Co-generation
pub mod bits;
pub mod closure;
pub mod conflict;
pub mod correlation;
pub mod cut;
pub mod family;
mod flow;
pub mod grid;
pub mod mma;
pub mod motion;
pub mod optimise;
pub mod part;
pub mod rows;
pub mod separation;
pub mod steps;
pub mod sweep;
#[cfg(test)]
mod tests;
mod ties;
pub mod trajectory;
