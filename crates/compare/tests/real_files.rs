//! What comparing says of real robots: the vendor corpus beside the workspace and the robots in it.

mod gauge;
mod mutations;
mod real_pairs;
mod rules;
mod support;
