//! What can go wrong in a linear solve.

/// Trouble with a linear system. Equations are numbered as the caller numbers them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// The pattern is not one of a structurally symmetric matrix.
    #[error("matrix pattern: {why}")]
    Pattern {
        /// What is wrong, with the entry.
        why: String,
    },
    /// Too large for memory or for 32-bit indices.
    #[error("the matrix is too large to factorise")]
    TooLarge,
    /// A slice has the wrong length.
    #[error("{what}: {got} numbers where {expected} are needed")]
    Length {
        /// Which slice.
        what: &'static str,
        /// The length needed.
        expected: usize,
        /// The length given.
        got: usize,
    },
    /// A value of the matrix or of the right-hand side is NaN or infinite.
    #[error("equation {equation} holds a number that is not finite")]
    NotFinite {
        /// Its row.
        equation: usize,
    },
    /// The elimination of this equation leaves nothing to divide by: a body is free to move, or
    /// the tangent is at a limit point.
    #[error("the matrix is singular at equation {equation}")]
    Singular {
        /// The equation (column) whose pivot vanished.
        equation: usize,
    },
    /// A symmetric factorisation met a pivot that is not positive; LU may still succeed.
    #[error("the matrix is not positive definite at equation {equation}")]
    NotPositiveDefinite {
        /// The equation whose pivot is not positive.
        equation: usize,
    },
    /// Solved, but the residual stays above the limit after refinement.
    #[error("the solution leaves a relative residual of {residual:.1e} (limit {limit:.1e})")]
    Inaccurate {
        /// ‖b − A x‖∞ / (‖A‖∞ ‖x‖∞ + ‖b‖∞), the largest over the right-hand sides.
        residual: f64,
        /// The limit it had to stay below.
        limit: f64,
    },
    /// `solve` was called without a successful `factorise` before it.
    #[error("no factorisation to solve with")]
    NotFactorised,
}
