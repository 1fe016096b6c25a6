//! `calibrate`: measurements to parameters, effects, curves and residuals.

use super::{Found, Summary, TaskError, load, note, selection};
use crate::manifest::{Entry, PriorSource};
use crate::store::table::Cell;
use denavit_calibrate::calibration::contract::{CalibrationReport, EffectEntry, Stage};
use denavit_calibrate::calibration::{HoldOut, calibrate};
use denavit_identify::information::Information;
use denavit_identify::proportion::can_be_identified;
use denavit_load::measured::{DataFile, Rows, RowsAsked, SearchAsked, moving, other_chains, rows, search};
use denavit_measurements::Units;
use denavit_model::ChainJoint;

pub(super) fn run(entry: &Entry) -> Result<Found, TaskError> {
    let mut found = Found::default();
    let loaded = load(entry, &entry.robot, &mut found.notes)?;
    let chain = loaded.chain(&selection(entry))?.value;
    moving(&entry.robot, &chain)?;
    can_be_identified(&chain)?;
    let statics = loaded.statics(&chain, selection(entry).reading);
    let options = &entry.options;
    let prior = match &entry.prior {
        None => None,
        Some(PriorSource::Siblings { learned: None }) => return Err(TaskError::NoSiblings),
        Some(PriorSource::Siblings { learned: Some(text) }) => {
            Some(DataFile { name: "siblings".into(), content: text.clone().into(), ..DataFile::default() })
        }
        Some(PriorSource::File(name)) => {
            let (name, bytes) = denavit_load::read_bytes(name)?;
            Some(DataFile { name, content: bytes.into(), ..DataFile::default() })
        }
    };
    let asked = SearchAsked {
        prior,
        effects: options.effects.clone(),
        max_effects: options.max_effects,
        mass: options.mass,
        hold_out: options.hold_out.filter(|_| entry.test.is_none()).map(|share| HoldOut { share, seed: options.seed }),
        ..SearchAsked::default()
    };
    let mut how = search(&asked, &chain)?;
    let units: Units = options
        .units
        .parse()
        .map_err(|error| TaskError::Units { written: options.units.clone(), reason: format!("{error}") })?;
    let read = |name: &String| {
        let (name, bytes) = denavit_load::read_bytes(name)?;
        Ok::<_, TaskError>(DataFile { name, content: bytes.into(), units, ..DataFile::default() })
    };
    let asked = RowsAsked {
        data: entry.data.iter().map(read).collect::<Result<_, _>>()?,
        test: entry.test.as_ref().map(read).transpose()?,
        ..RowsAsked::default()
    };
    let Rows { data, test, notes, .. } = rows(&asked, &chain)?;
    found.notes.extend(notes.into_iter().map(|text| note("reading", "", "note", "", text)));
    how.other_chains = other_chains(&loaded, &chain, &data);
    // Nothing of it is stored.
    how.noise = false;
    let result = calibrate(&chain, &statics, data, test, &how)?;
    let report = result.report;
    if let Some(information) = &result.information {
        found.information = information_rows(information);
        let axis = |joint: &ChainJoint| {
            let mut row: Vec<Cell> = vec![joint.name.as_str().into()];
            row.extend(joint.screw.twist().iter().map(|number| Cell::from(*number)));
            row
        };
        found.axes = chain.joints().iter().map(axis).collect();
    }
    found.parameters = report
        .parameters
        .iter()
        .map(|parameter| {
            let of_joint = parameter.parameter.rsplit_once('.').map_or(parameter.parameter.as_str(), |(_, name)| name);
            vec![
                parameter.joint.as_str().into(),
                of_joint.into(),
                parameter.change.into(),
                parameter.std.into(),
                parameter.half_interval_95.into(),
                parameter.unit.into(),
                parameter.held_by_prior.into(),
            ]
        })
        .collect();
    found.effects.extend(report.effects.iter().flat_map(|effect| effect_rows(effect, true)));
    found.effects.extend(report.one_of.iter().flat_map(|effect| effect_rows(effect, false)));
    for curve in &report.curves {
        found.curves.extend(curve.table.iter().map(|point| {
            vec![curve.joint.as_str().into(), point.at.into(), point.value.into(), point.std.into(), curve.unit.into()]
        }));
    }
    found.residuals = residuals(&report);
    remarks(&report, &mut found.notes);
    found.summary = summary(&report);
    Ok(found)
}

fn information_rows(information: &Information) -> Vec<Vec<Cell>> {
    let mut rows = Vec::new();
    for (i, parameter) in information.parameters.iter().enumerate() {
        rows.push(vec![parameter.as_str().into(), Cell::Empty, information.pull[i].into()]);
        for (k, other) in information.parameters[..=i].iter().enumerate() {
            rows.push(vec![parameter.as_str().into(), other.as_str().into(), information.matrix[(i, k)].into()]);
        }
    }
    rows
}

fn effect_rows(effect: &EffectEntry, named: bool) -> Vec<Vec<Cell>> {
    let place = effect.joint.as_deref().or(effect.place.as_deref()).unwrap_or_default();
    let driver = effect.covariate.as_deref().or(effect.driven_by.as_deref()).unwrap_or_default();
    let number =
        |value: &serde_json::Value, name: &str| Cell::from(value.get(name).and_then(serde_json::Value::as_f64));
    let row = |(name, value): (&String, &serde_json::Value)| {
        vec![
            effect.kind.as_str().into(),
            place.into(),
            driver.into(),
            name.as_str().into(),
            number(value, "value"),
            number(value, "std"),
            value.get("unit").and_then(serde_json::Value::as_str).unwrap_or_default().into(),
            effect.probability.into(),
            effect.found_again.into(),
            named.into(),
        ]
    };
    effect.parameters.iter().map(row).collect()
}

fn residuals(report: &CalibrationReport) -> Vec<Vec<Cell>> {
    let row = |row: denavit_calibrate::calibration::rows::RowEntry| {
        let mut cells = vec![
            row.line.into(),
            row.setup.as_str().into(),
            row.target.as_str().into(),
            row.held_out.into(),
            row.rejected.into(),
        ];
        cells.extend((0..3).map(|index| Cell::from(row.place.get(index).copied())));
        cells.extend((0..3).map(|index| Cell::from(row.turn.get(index).copied())));
        cells
    };
    report.rows.iter().map(row).collect()
}

fn remarks(report: &CalibrationReport, notes: &mut Vec<Vec<Cell>>) {
    for unseen in &report.unidentifiable {
        notes.push(note("unidentifiable", &unseen.parameter, "note", &unseen.joint, unseen.why.clone()));
    }
    for far in &report.differs_from_drawing {
        let message = format!("{} is {:.1} tolerances from the nominal model", far.parameter, far.tolerances);
        let mut row = note("drawing", &far.parameter, "warning", &far.joint, message);
        row[5] = far.value.into();
        row[6] = far.unit.into();
        notes.push(row);
    }
    for place in report.unexplained.places.iter().filter(|_| report.unexplained.structured) {
        let at = place.joint.as_deref().or(place.covariate.as_deref()).unwrap_or_default();
        let message =
            format!("{:.0} % of the residual is a function of {at} that no effect explains", 100.0 * place.share);
        let mut row = note("unexplained", "", "note", at, message);
        row[5] = place.share.into();
        row[6] = "1".into();
        notes.push(row);
    }
}

fn summary(report: &CalibrationReport) -> Summary {
    // What was measured in metres: position of targets, else distances, else whatever comes first.
    let rms = |stage: &Stage| {
        let errors = stage.test.as_ref().unwrap_or(&stage.train);
        ["position", "distance"].iter().find_map(|word| errors.of(word)).or(errors.0.first()).map(|error| error.rms)
    };
    let adopted = report.stages.iter().find(|stage| stage.adopted);
    Summary {
        name: report.robot.clone(),
        verdict: adopted.map_or_else(String::new, |stage| stage.name.clone()),
        rows_fitted: Some(report.samples.train),
        rows_held_out: Some(report.samples.test),
        nominal_rms: report.stages.first().and_then(rms),
        geometric_rms: report.stages.iter().find(|stage| stage.name == "geometric").and_then(rms),
        rms: adopted.and_then(rms),
        structured: Some(report.unexplained.structured),
        base: report.base.clone(),
        tip: report.tip.clone(),
        prior_weight: report.earlier.as_ref().map(|earlier| earlier.weight),
        ..Summary::default()
    }
}
