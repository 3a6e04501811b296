//! The steps of a run: increment sizes, procedures and their fallback, acceptance, peaks, history rows.

pub(in crate::solve) mod acceptance;
mod accepted;
pub(in crate::solve) mod commit;
pub(in crate::solve) mod counts;
pub(in crate::solve) mod damage_bound;
pub(in crate::solve) mod energy_watch;
mod entered;
pub(in crate::solve) mod exchange;
pub(in crate::solve) mod explain;
pub(in crate::solve) mod fallback;
pub(in crate::solve) mod fields;
pub(in crate::solve) mod first_damage;
pub(in crate::solve) mod history_row;
mod joint_damage;
pub(in crate::solve) mod narrowed_bands;
pub(in crate::solve) mod path;
pub(in crate::solve) mod peak_control;
pub(in crate::solve) mod probes;
pub(in crate::solve) mod rejection;
pub(in crate::solve) mod relaxation;
pub(in crate::solve) mod run;
pub(in crate::solve) mod snap;
pub(in crate::solve) mod step_run;
pub(in crate::solve) mod step_size;
pub(in crate::solve) mod stop;
