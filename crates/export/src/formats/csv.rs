//! CSV in rad and m at full precision: `row,joint,kind,theta,d,alpha,a,beta,pitch,scale`.
//!
//! The base row's `kind` holds the convention. The `joint` of a row is the name of the coordinate that moves it, so two
//! rows of one name move together (a mimic joint and its driver). A name that a spreadsheet would read as a formula has `'`
//! before it, which the reader removes.

use super::{Format, RenderError};
use crate::numbers::exact;
use crate::sheet::Sheet;
use denavit_dh::RowLabel;
use denavit_model::words::to_cell;

/// Columns, in this order.
pub const COLUMNS: [&str; 10] = ["row", "joint", "kind", "theta", "d", "alpha", "a", "beta", "pitch", "scale"];

/// CSV.
pub const FORMAT: Format =
    Format { name: "csv", extension: "csv", purpose: "rad and m at full precision; denavit reads it back", render };

fn render(sheet: &Sheet) -> Result<String, RenderError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let mut lines: Vec<Vec<String>> = vec![COLUMNS.map(str::to_owned).to_vec()];
    for row in sheet.rows() {
        let number = |value: Option<f64>| exact(value.unwrap_or(0.0));
        let (label, joint, kind, pitch, scale) = match row.label {
            RowLabel::Base => ("base".to_owned(), String::new(), sheet.shown_convention().word(), 0.0, 1.0),
            RowLabel::Tool => ("tool".to_owned(), String::new(), "", 0.0, 1.0),
            RowLabel::Joint(index) => {
                let joint = &sheet.table.joints[index];
                let name = &sheet.table.coordinates[joint.coordinate].name;
                (
                    (index + 1).to_string(),
                    to_cell(name).into_owned(),
                    joint.motion.word(),
                    joint.motion.pitch(),
                    joint.scale,
                )
            }
        };
        // A Hayati row has no d: with an empty cell only beta is read.
        let d = row.d.map_or_else(String::new, exact);
        let cells =
            [number(row.theta), d, number(row.alpha), number(row.a), number(row.beta), exact(pitch), exact(scale)];
        lines.push([label, joint, kind.to_owned()].into_iter().chain(cells).collect());
    }
    for line in lines {
        writer.write_record(line).expect("writing to memory does not fail");
    }
    let bytes = writer.into_inner().expect("writing to memory does not fail");
    Ok(String::from_utf8(bytes).expect("every cell was text"))
}
