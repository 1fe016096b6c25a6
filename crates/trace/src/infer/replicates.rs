//! Values that share a misfit: rows that repeat a posture, targets that are seen in one row.
//!
//! If they counted as independent, a curve could learn the misfit of each posture, and a cause would look more certain than it is. A
//! group of m values with the intraclass correlation r counts as m/(1 + (m - 1) r) independent values (the design effect of
//! cluster samples, Kish 1965).

use denavit_identify::residual_statistics::Residual;
use denavit_measurements::Measurements;
use denavit_model::nalgebra::Vector3;

/// Rows by posture: each group in order, rows that stand alone left out.
pub fn groups(data: &Measurements) -> Vec<Vec<usize>> {
    data.postures().iter().filter(|rows| rows.len() > 1).map(<[usize]>::to_vec).collect()
}

/// The weight of each observation: 1, or less where others share its misfit.
pub fn weights(data: &Measurements, groups: &[Vec<usize>], residuals: &[Residual]) -> Vec<f64> {
    let mut weights = vec![1.0; data.observations()];
    let of_postures: Vec<Vec<&Residual>> = groups
        .iter()
        .flat_map(|group| {
            let mut own: Vec<&Residual> = residuals.iter().filter(|r| group.binary_search(&r.row).is_ok()).collect();
            own.sort_by_key(|residual| residual.series);
            own.chunk_by(|a, b| a.series == b.series).map(<[&Residual]>::to_vec).collect::<Vec<_>>()
        })
        .collect();
    let of_rows: Vec<Vec<&Residual>> =
        residuals.chunk_by(|a, b| a.row == b.row).map(|row| row.iter().collect()).collect();
    for sharing in [of_postures, of_rows] {
        let share = alike(&sharing);
        for group in &sharing {
            for residual in group {
                weights[residual.observation] /= 1.0 + (group.len() - 1) as f64 * share;
            }
        }
    }
    weights
}

/// Share of the errors' variance that the members of a group have in common, 0 to 1.
fn alike(groups: &[Vec<&Residual>]) -> f64 {
    let (mut within, mut free, mut total, mut count) = (0.0, 0.0, 0.0, 0.0);
    for same in groups.iter().filter(|group| group.len() > 1) {
        let mean = same.iter().map(|r| r.place).sum::<Vector3<f64>>() / same.len() as f64;
        within += same.iter().map(|r| (r.place - mean).norm_squared()).sum::<f64>();
        free += (same.len() - 1) as f64;
        total += same.iter().map(|r| r.place.norm_squared()).sum::<f64>();
        count += same.len() as f64;
    }
    if free == 0.0 || total == 0.0 { 0.0 } else { (1.0 - (within / free) / (total / count)).clamp(0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn residual(row: usize, x: f64) -> Residual {
        Residual { row, observation: row, series: 0, place: Vector3::new(x, 0.0, 0.0), turn: Vector3::zeros() }
    }

    #[test]
    fn what_repeats_exactly_counts_once() {
        let same: Vec<Residual> =
            [1.0, 1.0, 1.0, -2.0, -2.0].iter().enumerate().map(|(row, x)| residual(row, *x)).collect();
        let groups = |all: &'_ [Residual]| alike(&[all[..3].iter().collect(), all[3..].iter().collect()]);
        assert!((groups(&same) - 1.0).abs() < 1e-12);
        let noise: Vec<Residual> =
            [1.0, -1.0, 0.0, 2.0, -2.0].iter().enumerate().map(|(row, x)| residual(row, *x)).collect();
        assert!(groups(&noise) < 1e-12);
    }
}
