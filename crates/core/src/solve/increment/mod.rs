//! One increment: predictor, Newton iterations, line search, convergence, energy balance.

pub(in crate::solve) mod body_balance;
pub(in crate::solve) mod convergence;
pub(in crate::solve) mod direction;
pub(in crate::solve) mod elimination;
pub(in crate::solve) mod energy_balance;
pub(in crate::solve) mod external_forces;
pub(in crate::solve) mod line_search;
mod linear_system;
pub(in crate::solve) mod newton;
pub(in crate::solve) mod outcome;
pub(in crate::solve) mod path_iterations;
pub(in crate::solve) mod predictor;
pub(in crate::solve) mod traction_patterns;
pub(in crate::solve) mod work;
