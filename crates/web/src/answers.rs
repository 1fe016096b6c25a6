//! Each question and its answer.

use crate::question::{Question, RobotText, table_options, units, without_scales};
use crate::{edits, effects, measured, reach, twists};
use denavit_compare::lint;
use denavit_compare::report::{self, Report};
use denavit_compare::{Options as Comparing, compare};
use denavit_export::{Sheet, formats, poe, shapes};
use denavit_load::{CheckOptions, Loaded, Rules, TableOptions, json};
use denavit_model::nalgebra::{Rotation3, Vector3};
use denavit_model::notes::Noted;
use denavit_model::robot::Inertial;
use denavit_model::{Reading, se3};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// The answer to a question.
pub fn of(question: &Question) -> Result<Value, String> {
    match question {
        Question::Open(source) => open(source),
        Question::Table { source, convention, gauge, units: written, format } => {
            table(source, convention.as_deref(), gauge.as_deref(), written, format)
        }
        Question::Poe(source) => {
            let Noted { value, notes } = source.load()?.chain(&source.selection()).map_err(words)?;
            Ok(json!({ "text": poe::json(&value, &notes) }))
        }
        Question::Twist(asked) => twists::twisted(asked),
        Question::Fk { source, q } => {
            let noted = source.load()?.chain(&source.selection()).map_err(words)?;
            let chain = &noted.value;
            let q: Vec<f64> =
                chain.coordinates().iter().map(|joint| q.get(&joint.name).copied().unwrap_or(0.0)).collect();
            Ok(json!({ "text": json::fk(&noted, &q, &chain.fk(&q)) }))
        }
        Question::Tips { source, q } => {
            let chain = source.load()?.chain(&source.selection()).map_err(words)?.value;
            let wanted = chain.coordinates().len();
            if q.iter().any(|row| row.len() != wanted || !row.iter().all(|value| value.is_finite())) {
                return Err(format!("{wanted} finite joint values are wanted"));
            }
            let tips: Vec<Value> = q.iter().map(|row| json!(chain.fk(row).translation.vector.as_slice())).collect();
            Ok(json!({ "tips": tips }))
        }
        Question::Ik(asked) => reach::reached(asked),
        Question::Check(source) => check(source),
        Question::Fix { source, only } => {
            let (file, text, findings) = findings(source)?;
            let chosen: Vec<_> =
                findings.into_iter().enumerate().filter(|(at, _)| only.is_none_or(|only| only == *at)).collect();
            let chosen: Vec<lint::Finding> = chosen.into_iter().map(|(_, finding)| finding).collect();
            let (text, made) = lint::fix(&text, &chosen);
            Ok(json!({ "file": file, "text": text, "made": made }))
        }
        Question::Canonical(source) => {
            let robot = source.load()?;
            let made = denavit_load::canonical(&robot, &source.file, &source.canonical_options()).map_err(words)?;
            Ok(json!({ "text": made.value, "notes": sentences(&made.notes) }))
        }
        Question::Edits {} => Ok(edits::possible()),
        Question::Edit { source, words, other } => edits::edited(source, words, other.as_ref()),
        Question::Diff { a, b } => diff(a, b),
        Question::Columns { source, data, units, map } => measured::columns(source, data, units, map.as_deref()),
        Question::Calibrate(asked) => measured::calibrated(asked),
        Question::Effects(source) => effects::possible(source),
        Question::Act { source, effect, q } => effects::act(source, effect, q),
    }
}

pub fn words(error: impl std::fmt::Display) -> String {
    error.to_string()
}

pub fn sentences(notes: &[denavit_model::Note]) -> Vec<String> {
    notes.iter().map(ToString::to_string).collect()
}

fn open(source: &RobotText) -> Result<Value, String> {
    let opened = source.open()?;
    let (file, urdf) = source.urdf()?;
    let tree = denavit_model::urdf::read(&file, &urdf).map_err(words)?;
    let listing = opened.robot.chains();
    let (_, scales) = without_scales(opened.robot)?;
    let mut scene = shapes::scene(&tree, source.reading());
    scale(&mut scene, &scales);
    for (link, shown) in tree.links.iter().zip(scene["links"].as_array_mut().into_iter().flatten()) {
        shown["inertial"] = link.inertial.as_ref().map_or(Value::Null, |inertial| matter(inertial, source.reading()));
    }
    Ok(json!({
        "robot": listing.robot,
        "chains": json::chains(&listing),
        "urdf": urdf,
        "urdf_file": file,
        "is_alone": opened.includes.is_empty(),
        "notes": opened.notes,
        "scene": scene,
    }))
}

/// A link's mass properties as a view draws them: `mass` kg, `centre` (its place with the principal axes of inertia, 16 numbers column
/// by column), `box`: edges (m) of the solid box of that mass and that inertia, null where no body has such an inertia.
///
/// A box of mass m and edges a, b, c has I₁ = m (b² + c²) / 12 and so on, so that a² = 6 (I₂ + I₃ - I₁) / m.
fn matter(inertial: &Inertial, reading: Reading) -> Value {
    let eigen = inertial.tensor.symmetric_eigen();
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        let turned = -axes.column(2);
        axes.set_column(2, &turned);
    }
    let moments = eigen.eigenvalues;
    let total = moments.sum();
    let square = |axis: usize| 6.0 * (total - 2.0 * moments[axis]) / inertial.mass;
    let squares = [square(0), square(1), square(2)];
    let solid = squares.iter().all(|square| square.is_finite() && *square >= 0.0) && total > 0.0;
    let principal = se3::pose(Rotation3::from_matrix_unchecked(axes), Vector3::zeros());
    let centre = inertial.origin.read(reading).pose() * principal;
    json!({
        "mass": inertial.mass,
        "centre": centre.to_homogeneous().as_slice(),
        "box": solid.then(|| squares.map(f64::sqrt)),
    })
}

/// Gives the joints of a scene, and the joints that follow them, the scales that the URDF could not state.
fn scale(scene: &mut Value, scales: &BTreeMap<String, f64>) {
    let Some(joints) = scene["joints"].as_array_mut() else { return };
    let names: Vec<String> = joints.iter().map(|joint| joint["name"].as_str().unwrap_or_default().to_owned()).collect();
    for joint in joints {
        let driver = joint["driver"].as_u64().and_then(|index| names.get(usize::try_from(index).ok()?));
        if let (Some(by), Some(own)) = (driver.and_then(|name| scales.get(name)), joint["scale"].as_f64()) {
            joint["scale"] = json!(own * by);
        }
    }
}

fn table(
    source: &RobotText,
    convention: Option<&str>,
    gauge: Option<&str>,
    written: &str,
    format: &str,
) -> Result<Value, String> {
    tabled(&source.load()?, source, &table_options(convention, gauge)?, written, format)
}

/// A robot's table in a format, and in the cells that a page shows.
pub fn tabled(
    loaded: &Loaded,
    source: &RobotText,
    options: &TableOptions,
    written: &str,
    format: &str,
) -> Result<Value, String> {
    let made = loaded.table(&source.selection(), options).map_err(words)?;
    let Noted { value: table, notes } = made.table;
    let sheet = Sheet {
        table: &table,
        convention: made.convention,
        units: units(written)?,
        notes: &notes,
        source: &source.file,
        gauge: made.gauge,
    };
    let format = formats::named(format).ok_or_else(|| format!("there is no format \"{format}\""))?;
    let text = (format.render)(&sheet).map_err(words)?;
    let rows: Vec<Value> = sheet
        .text_rows(|index| format!("q{index}"))
        .into_iter()
        .map(|row| {
            json!({ "label": row.label, "joint": row.joint, "kind": row.kind, "numbers": row.numbers, "limits": row.limits })
        })
        .collect();
    Ok(json!({
        "text": text,
        "columns": sheet.number_columns(),
        "rows": rows,
        "formula": sheet.row_formula(),
        "convention": sheet.convention_words(),
        "notes": sentences(&notes),
    }))
}

fn findings(source: &RobotText) -> Result<(String, String, Vec<lint::Finding>), String> {
    let rules = Rules::of(&source.file, &CheckOptions { package_path: vec!["/".into()], ..CheckOptions::default() });
    let rules = rules.map_err(words)?;
    let (file, text) = source.urdf()?;
    let found = rules.check(&file, &text);
    Ok((file, text, found))
}

fn check(source: &RobotText) -> Result<Value, String> {
    let (file, text, findings) = findings(source)?;
    let files = [source.file.clone()];
    let found = Report::Findings { files: &files, findings: &findings, inventories: &[], known: None };
    Ok(json!({ "text": rendered("json", &found), "file": file, "urdf": text, "is_source": text == source.text }))
}

fn rendered(format: &str, found: &Report) -> String {
    (report::format(format).expect("the format is in the list").render)(found)
}

fn diff(a: &RobotText, b: &RobotText) -> Result<Value, String> {
    let (one, other) = (a.load()?, b.load()?);
    let comparison = compare(&one.subject(&a.file), &other.subject(&b.file), &Comparing::default()).map_err(words)?;
    let found = Report::Comparison(&comparison);
    Ok(json!({ "text": rendered("json", &found), "words": rendered("text", &found) }))
}
