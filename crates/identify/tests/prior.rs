//! The prior of a calibration that follows another.

use denavit_identify::parameters::{Freedom, Layout, Tolerances};
use denavit_identify::prior::KnownBefore;
use denavit_measurements::Scene;
use denavit_model::examples;
use denavit_model::nalgebra::{DMatrix, DVector};

#[test]
fn knowing_what_the_drawing_says_changes_nothing() {
    for chain in examples::all() {
        let (freedom, tolerances) = (Freedom::axes(chain.joints().len()), Tolerances::default());
        let layout = Layout::new(&chain, &Scene::default(), &freedom, &tolerances, Vec::new());
        let covariance = layout.prior.of_drawing.clone().cholesky().unwrap().inverse();
        let indices: Vec<usize> = (0..layout.len()).filter(|index| index % 3 != 1).collect();
        let before = KnownBefore {
            weight: 1.0,
            mean: DVector::zeros(indices.len()),
            covariance: covariance.select_rows(&indices).select_columns(&indices),
            indices,
        };
        let known = layout.clone().knowing(&before).prior;
        // Scaled to the tolerances; only the added common motion differs.
        let unit = DVector::from_iterator(layout.len(), layout.parameters.iter().map(|p| p.tolerance.unwrap()));
        let scaled =
            |matrix: &DMatrix<f64>| DMatrix::from_fn(unit.len(), unit.len(), |i, k| matrix[(i, k)] * unit[i] * unit[k]);
        let (own, drawing) = (scaled(&known.precision), scaled(&known.of_drawing));
        assert!((&own - &drawing).norm() < 1e-2 * drawing.norm(), "{}", (&own - &drawing).norm() / drawing.norm());
        assert!(!known.is_of_drawing() && layout.prior.is_of_drawing());
    }
}

#[test]
fn a_known_axis_moves_the_axes_after_it() {
    // The fifth axis is known to be turned; the one after it is on the same links.
    let chain = examples::puma_like();
    let (freedom, tolerances) = (Freedom::axes(6), Tolerances::default());
    let layout = Layout::new(&chain, &Scene::default(), &freedom, &tolerances, Vec::new());
    let at = |name: &str| layout.parameters.iter().position(|parameter| parameter.name == name).unwrap();
    let known_axes: Vec<usize> = (0..layout.len()).filter(|&k| layout.parameters[k].kind.joint() <= Some(4)).collect();
    let mut mean = DVector::zeros(known_axes.len());
    let turned = at("joint_5.turn_x");
    mean[known_axes.iter().position(|&k| k == turned).unwrap()] = 5e-3;
    let before = KnownBefore {
        weight: 1.0,
        indices: known_axes.clone(),
        covariance: DMatrix::identity(known_axes.len(), known_axes.len()) * 1e-12,
        mean,
    };
    let prior = layout.clone().knowing(&before).prior;
    let last = at("joint_6.turn_x");
    assert!((prior.mean[turned] - 5e-3).abs() < 1e-7);
    assert!(prior.mean[last] > 2e-3, "{}", prior.mean[last]);
    let spread = prior.precision.clone().cholesky().unwrap().inverse();
    assert!(spread[(last, last)].sqrt() > 5e-4);
}
