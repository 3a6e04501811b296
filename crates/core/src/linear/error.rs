//! Errors of linear solves.

/// Error of a linear system. Equations have the caller's numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// The pattern does not belong to a structurally symmetric matrix.
    #[error("matrix pattern: {why}")]
    Pattern {
        /// Reason, with the entry.
        why: String,
    },
    /// Too large for memory or for 32-bit indices.
    #[error("the matrix is too large to factorise")]
    TooLarge,
    /// A slice has the wrong length.
    #[error("{what}: {got} numbers where {expected} are needed")]
    Length {
        /// Name of the slice.
        what: &'static str,
        /// Length needed.
        expected: usize,
        /// Length given.
        got: usize,
    },
    /// A value of the matrix or of the right-hand side is NaN or infinite.
    #[error("equation {equation} holds a number that is not finite")]
    NotFinite {
        /// Its row.
        equation: usize,
    },
    /// The pivot of this equation vanishes: a body can move freely, or the tangent is at a limit point.
    #[error("the matrix is singular at equation {equation}")]
    Singular {
        /// The equation (column) whose pivot vanished.
        equation: usize,
    },
    /// A symmetric factorisation found a pivot that is not positive. L U may still succeed.
    #[error("the matrix is not positive definite at equation {equation}")]
    NotPositiveDefinite {
        /// The equation whose pivot is not positive.
        equation: usize,
    },
    /// The residual stays above the limit after refinement.
    #[error("the solution leaves a relative residual of {residual:.1e} (limit {limit:.1e})")]
    Inaccurate {
        /// ‖b − A x‖∞ / (‖A‖∞ ‖x‖∞ + ‖b‖∞), the largest over the right-hand sides.
        residual: f64,
        /// Limit.
        limit: f64,
    },
    /// `solve` was called without a successful `factorise`.
    #[error("no factorisation to solve with")]
    NotFactorised,
}
