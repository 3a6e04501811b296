//! Tests of the module `contact`.

mod bvh;
mod couplets;
mod four_points;
mod interface;
mod joint_laws;
mod parts;
mod patch;
mod pivots;
mod projection;
mod rims;
mod search_radius;
mod sliding;
mod stencil;
