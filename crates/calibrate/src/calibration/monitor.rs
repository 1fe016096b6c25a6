//! Checks while measuring: compares each row with the prediction of the rows before it, and gives the known parameters and the next pose.
//!
//! ```text
//! new row ─► compared with the fit of the rows before ─► out of line? then possible causes are tested ─► fitted again
//! ```
//! With J the row's Jacobian, C the covariance of the fit and σ its noise, the prediction error r has the covariance
//! S = J C Jᵀ + σ², and rᵀ S⁻¹ r over its number of values has an F distribution with the degrees of freedom of the noise. A row as far
//! beyond that as a fit's gross outliers is out of line: it does not fit, and is left out of the fit until later rows support it.

mod out_of_line;
mod suspects;

pub use self::out_of_line::{Off, OutOfLine};

use self::out_of_line::Prediction;
use self::suspects::explanations;
use super::contract::ReadAs;
use super::diagnosis::{self, Corrected, Diagnosis, needed_to_place};
use super::repeats_the_row_before;
use crate::apply::plan::next::{Outlook, outlook, within_limits};
use crate::apply::plan::{PlanError, PlanOptions};
use denavit_identify::initial_guess::nominal_fit;
use denavit_identify::parameters::{NoEffects, ParameterKind};
use denavit_identify::solve::Fit;
use denavit_identify::{IdentifyOptions, fit_stage, identify};
use denavit_measurements::{Measurements, Scene};
use denavit_model::Chain;
use denavit_model::nalgebra::{DMatrix, DVector};
use serde::{Serialize, Serializer};
use std::collections::BTreeSet;

/// Name and version of the status as JSON.
pub const SCHEMA: &str = "denavit.measure/1";
/// A parameter is known if its standard deviation is at most this share of the prior's.
const KNOWN_SHARE: f64 = 0.5;
/// This many of the least known parameters are named.
const WORST: usize = 3;
/// Numbers of rows at which mistakes in the data's notation are searched for: this, twice, four times as many and so on.
const ROWS_TO_DIAGNOSE: usize = 20;
/// All rows are fitted again after each row up to this many, then after each growth by a fiftieth.
const FIT_EVERY_ROW: usize = 50;

/// Note on a row that repeats the one before.
const LATE: &str =
    "the instrument repeats the row before, digit for digit, although a joint moved: its reading came late";

/// A poorly known parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertain {
    /// Its name.
    pub parameter: String,
    /// Its standard deviation, in its unit.
    pub std: f64,
    /// Its manufacturing tolerance, in its unit.
    pub tolerance: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Its standard deviation once the next pose is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std_after_next: Option<f64>,
}

/// How well the robot's parameters are known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Known {
    /// Parameters that measurements of this kind can identify.
    pub identifiable: usize,
    /// Those that the data determine better than their tolerance, and twice as well as the prior.
    pub known: usize,
    /// Joints that have not moved yet: nothing is known of their axes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unmoved: Vec<String>,
    /// The least known, in units of their tolerance.
    pub worst: Vec<Uncertain>,
    /// Standard deviation of the prediction over the joint range, without noise, m.
    pub prediction_std_m: Option<f64>,
}

/// The status after a row.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RowStatus {
    /// The row, counted from 1.
    pub row: usize,
    /// Its line in the file.
    pub line: usize,
    /// Whether the rows before it predict it well enough for a check.
    pub judged: bool,
    /// Whether it is an exact copy of an earlier row, which is not counted again.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub copy: bool,
    /// Measured less predicted; empty while nothing can be predicted.
    pub off: Vec<Off>,
    /// How the readings of all rows are interpreted from here on, if they do not fit the robot as written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_as: Option<ReadAs>,
    /// Why it is out of line, if it is.
    pub out_of_line: Option<OutOfLine>,
    /// Lines of all rows that are out of line by now.
    pub lines_out_of_line: Vec<usize>,
    /// Further measured numbers needed to place instrument and target; then 0.
    pub missing_numbers: usize,
    /// Noise of one component, by channel; empty while there is no fit.
    pub noise: Vec<Off>,
    /// How well the parameters are known; absent while there is no fit, and if the fit was postponed to a later row.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub known: Option<Known>,
    /// The most informative next posture, by joint: rad or m.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "by_name")]
    pub next: Option<Vec<(String, f64)>>,
}

#[expect(clippy::ref_option, reason = "serde hands over the field as it is")]
fn by_name<S: Serializer>(values: &Option<Vec<(String, f64)>>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(values.iter().flatten().map(|(name, value)| (name, value)))
}

/// What to watch for.
#[derive(Debug, Clone, PartialEq)]
pub struct MonitorOptions {
    /// What is fitted.
    pub identify: IdentifyOptions,
    /// Which poses may be measured next.
    pub plan: PlanOptions,
}

/// Watches rows as they come.
#[derive(Debug, Clone)]
pub struct Monitor {
    chain: Chain,
    options: MonitorOptions,
    candidates: Vec<Vec<f64>>,
    rows: usize,
    fit: Option<Fitted>,
    /// Rows that are out of line.
    out: BTreeSet<usize>,
    /// Rows that are exact copies of earlier ones.
    copies: BTreeSet<usize>,
    /// Corrections of readings that do not agree with the drawing, one after another.
    corrected: Vec<Corrected>,
}

#[derive(Debug, Clone)]
struct Fitted {
    fit: Fit<NoEffects>,
    /// The rows that it is of.
    data: Measurements,
    /// Whether the noise is estimated from the data: from then on rows are judged.
    judges: bool,
}

impl Monitor {
    /// Before any row.
    ///
    /// # Errors
    /// Candidates that are no postures of the chain.
    pub fn new(chain: &Chain, options: MonitorOptions) -> Result<Self, PlanError> {
        let candidates = within_limits(chain, &options.plan)?;
        Ok(Self {
            chain: chain.clone(),
            options,
            candidates,
            rows: 0,
            fit: None,
            out: BTreeSet::new(),
            copies: BTreeSet::new(),
            corrected: Vec::new(),
        })
    }

    /// Lines of the rows that are out of line.
    pub fn lines_out_of_line(&self, rows: &Measurements) -> Vec<usize> {
        self.out.iter().map(|&row| rows.lines[row]).collect()
    }

    /// Processes the new rows among these, which begin with the earlier ones, and reports the status of each, until the callback stops it.
    ///
    /// # Errors
    /// The rows do not belong to this robot as they are written.
    pub fn take(&mut self, rows: &Measurements, tell: &mut dyn FnMut(RowStatus) -> bool) -> Result<(), Diagnosis> {
        while self.rows < rows.len() {
            self.rows += 1;
            let so_far: Vec<usize> = (0..self.rows).collect();
            let data = self.as_read(rows.subset(&so_far).pruned());
            if !tell(self.row(&data, self.rows == rows.len())?) {
                break;
            }
        }
        Ok(())
    }

    fn row(&mut self, data: &Measurements, is_last: bool) -> Result<RowStatus, Diagnosis> {
        let row = data.len() - 1;
        let mut off = Vec::new();
        let (mut judged, mut why) = (false, None);
        let copy = data.copies(None).contains(&row);
        if copy {
            self.copies.insert(row);
        }
        let fitted = self.fit.as_ref().filter(|fitted| !copy && fitted.fits(data) && !data.locate[row]);
        if let Some(fitted) = fitted {
            let prediction = Prediction::of(&fitted.fit, data, &[row]);
            off = prediction.off(&fitted.fit, data);
            judged = fitted.judges;
            if judged && let Some(mut found) = prediction.out_of_line(&fitted.fit, data) {
                self.out.insert(row);
                let run: Vec<usize> = (0..=row).rev().take_while(|row| self.out.contains(row)).collect();
                found.rows = run.len();
                (found.explanations, found.undecided) = if repeats_the_row_before(data, row) {
                    (vec![LATE.into()], false)
                } else {
                    explanations(&fitted.fit, data, &run)
                };
                why = Some(found);
            }
        }
        let needed = needed_to_place(&data.scene);
        let missing = (needed + 1).saturating_sub(data.values());
        let due =
            self.fit.as_ref().is_none_or(|fitted| data.len() >= fitted.data.len() + fitted.data.len() / FIT_EVERY_ROW);
        let fits = missing == 0 && (due || is_last);
        let mut read_as = None;
        let reread;
        let mut data = data;
        if fits {
            self.refit(data);
            if let Some(corrected) = self.diagnose(data)? {
                read_as = Some(ReadAs::of(&corrected));
                reread = corrected.applied(&self.chain, data.clone());
                data = &reread;
                self.corrected.push(corrected);
                // The status of rows as written is no longer valid.
                self.fit = None;
                self.out.clear();
                (off, judged, why) = (Vec::new(), false, None);
                self.refit(data);
            }
        }
        let fitted = self.fit.as_ref().filter(|_| missing == 0);
        let (known, next) = match fitted.filter(|_| fits) {
            None => (None, None),
            Some(fitted) => self.outlook(&fitted.fit, data),
        };
        Ok(RowStatus {
            row: row + 1,
            line: data.lines[row],
            judged,
            copy,
            off,
            read_as,
            out_of_line: why,
            lines_out_of_line: self.lines_out_of_line(data),
            missing_numbers: missing,
            noise: fitted.map_or_else(Vec::new, |fitted| noise(&fitted.fit, &fitted.data)),
            known,
            next,
        })
    }

    /// Whether a row is fitted.
    fn counts(&self, row: usize) -> bool {
        !self.out.contains(&row) && !self.copies.contains(&row)
    }

    /// Fits all rows except copies and rows out of line, and readmits rows that the fit then predicts.
    fn refit(&mut self, data: &Measurements) {
        let options = self.options.identify.for_data(&self.chain, data);
        let weights: Vec<f64> = (0..data.len())
            .flat_map(|row| data.of_row(row).map(move |_| row))
            .map(|row| f64::from(u8::from(self.counts(row))))
            .collect();
        let warm = self.fit.as_ref().filter(|fitted| fitted.judges && fitted.data.scene == data.scene);
        let start = warm.map_or_else(
            || nominal_fit(&self.chain, data, &weights, &options.fit).arm,
            |fitted| fitted.fit.arm.clone(),
        );
        let fit = fit_stage(data, &start, &NoEffects, &weights, &options);
        let judges = fit.assumed_degrees() == 0.0 && fit.converged_or_exact();
        let likely = |row: &usize| Prediction::of(&fit, data, &[*row]).out_of_line(&fit, data).is_none();
        if judges {
            self.out.retain(|row| !likely(row));
            let rejected = |row: &usize| {
                data.of_row(*row).any(|observation| weights[observation] > 0.0 && fit.weights[observation] == 0.0)
            };
            self.out.extend((0..data.len()).filter(rejected));
        }
        self.fit = Some(Fitted { fit, data: data.clone(), judges });
    }

    /// The rows with corrected readings.
    fn as_read(&self, data: Measurements) -> Measurements {
        self.corrected.iter().fold(data, |data, corrected| corrected.applied(&self.chain, data))
    }

    /// The controller's readings at these joint values; `None` if no reading corresponds to them.
    fn as_written(&self, joints: Vec<f64>) -> Option<Vec<f64>> {
        if self.corrected.is_empty() {
            return Some(joints);
        }
        // Readings are corrected by a linear map and a shift.
        let n = joints.len();
        let names = self.chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
        let mut rows = Measurements::empty("readings", names, Scene::default());
        for row in 0..=n {
            let reading: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k + 1 == row))).collect();
            rows.end_row(&reading, row + 1, false);
        }
        let taken = self.as_read(rows);
        let map = DMatrix::from_fn(n, n, |i, k| taken.reading(k + 1)[i] - taken.reading(0)[i]);
        let away = DVector::from_fn(n, |i, _| joints[i] - taken.reading(0)[i]);
        Some(map.lu().solve(&away)?.iter().copied().collect())
    }

    /// At certain numbers of rows, searches for a mistake in the data's notation; a harmless mistake is corrected, and the run continues.
    fn diagnose(&self, data: &Measurements) -> Result<Option<Corrected>, Diagnosis> {
        let parts = data.len() / ROWS_TO_DIAGNOSE;
        if !data.len().is_multiple_of(ROWS_TO_DIAGNOSE) || !parts.is_power_of_two() {
            return Ok(None);
        }
        let kept: Vec<usize> = (0..data.len()).filter(|row| self.counts(*row)).collect();
        let kept = data.subset(&kept).pruned();
        let found = identify(&self.chain, &kept, &self.options.identify);
        diagnosis::judge(&self.chain, &kept, &found, &self.options.identify, &[])
    }

    fn outlook(&self, fit: &Fit<NoEffects>, data: &Measurements) -> (Option<Known>, Option<Vec<(String, f64)>>) {
        let measured = (0..data.len()).rev().find(|&row| !data.locate[row]);
        let series: Vec<usize> = measured
            .map(|row| data.of_row(row).map(|observation| data.observed.series(observation)))
            .into_iter()
            .flatten()
            .filter(|&series| !data.scene.series[series].kind.holds_the_target())
            .collect();
        let seen = (!series.is_empty()).then(|| outlook(fit, data, &series, &self.candidates, &self.options.plan));
        let known = known(fit, data, seen.as_ref());
        let names = self.chain.coordinates().iter().map(|coordinate| coordinate.name.clone());
        let next = seen.and_then(|seen| seen.next).and_then(|next| self.as_written(next.joints));
        let next = next.map(|next| names.zip(next).collect());
        (Some(known), next)
    }
}

impl Fitted {
    /// Whether the fit has every frame and target of the last row.
    fn fits(&self, data: &Measurements) -> bool {
        self.data.scene == data.scene
    }
}

fn noise(fit: &Fit<NoEffects>, data: &Measurements) -> Vec<Off> {
    let parts = data.scene.channels.iter().zip(&fit.noise.levels);
    parts.map(|(part, level)| Off { what: part.word, error: *level, expected: *level, unit: part.unit }).collect()
}

fn known(fit: &Fit<NoEffects>, data: &Measurements, seen: Option<&Outlook>) -> Known {
    let chain = &fit.arm.nominal;
    let of_axis = |kind: ParameterKind| kind.joint().is_some();
    let mut uncertain = Vec::new();
    let (mut identifiable, mut known) = (0, 0);
    for (index, parameter) in fit.layout.parameters.iter().enumerate() {
        let Some(tolerance) = parameter.tolerance.filter(|_| of_axis(parameter.kind)) else { continue };
        identifiable += 1;
        let std = fit.deviation(index);
        known += usize::from(std < tolerance && fit.held_by_prior(index) < KNOWN_SHARE);
        let after =
            seen.and_then(|seen| seen.next.as_ref()).map(|next| next.covariance[(index, index)].max(0.0).sqrt());
        let parameter = parameter.clone();
        uncertain.push(Uncertain {
            parameter: parameter.name,
            std,
            tolerance,
            unit: parameter.unit,
            std_after_next: after,
        });
    }
    uncertain.sort_by(|a, b| (b.std / b.tolerance).total_cmp(&(a.std / a.tolerance)));
    uncertain.truncate(WORST);
    let still = chain.joints().iter().filter(|joint| data.never_moves(joint.coordinate));
    let unmoved: Vec<String> = still.map(|joint| joint.name.clone()).collect();
    let prediction = seen.map(|seen| seen.prediction).filter(|prediction| prediction.is_finite());
    Known { identifiable, known, unmoved, worst: uncertain, prediction_std_m: prediction }
}
