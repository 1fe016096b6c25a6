//! Every benchmark in one program, a module for each thing measured; a line of JSON for each figure.

mod calibration;
mod comparison;
mod forward_kinematics;
mod jacobian;
mod limits;
mod loading;

fn main() {
    forward_kinematics::single();
    forward_kinematics::batch();
    forward_kinematics::many();
    jacobian::single();
    loading::loading();
    comparison::comparison();
    calibration::identification();
    calibration::tracing();
    limits::arithmetic();
    limits::standard_sines();
}
