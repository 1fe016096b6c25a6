//! The table of a robot: its file's own numbers where it has some, else new ones from the chain.

use crate::LoadError;
use crate::robot::{Loaded, Selection};
use denavit_dh::convert::{HAYATI_BELOW, table};
use denavit_dh::{Convention, Gauge, NearParallel, Options, Parallelism, Table};
use denavit_export::urdf::read_off;
use denavit_model::Reading;
use denavit_model::notes::{Note, Noted};

/// Default: neighbouring axes closer to parallel than this are made parallel, rad.
pub const NEARLY_PARALLEL: f64 = 1e-6;

/// How the table is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableOptions {
    /// How the numbers are grouped; `None`: as the file does, else distal.
    pub convention: Option<Convention>,
    /// Choice that the geometry does not determine; `None`: as the file does, else the fewest numbers.
    pub gauge: Option<Gauge>,
    /// Neighbouring axes closer to parallel than this are made parallel, rad; 0: none.
    pub tolerance: f64,
}

/// A table and how its numbers are grouped.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// The numbers, and what must be said of them.
    pub table: Noted<Table>,
    /// How they are grouped.
    pub convention: Convention,
    /// How the gauge was chosen: `file` where the numbers stand in the source, `simple` or `paper`.
    pub gauge: &'static str,
}

impl Loaded {
    /// The table of a chain, the same in every command and page: a file's own numbers regrouped, or new ones.
    ///
    /// # Errors
    /// There is no such chain.
    pub fn table(&self, selection: &Selection, options: &TableOptions) -> Result<Made, LoadError> {
        let convention = options.convention.unwrap_or(match self {
            Self::Table { convention, .. } => *convention,
            _ => Convention::Distal,
        });
        let hayati = convention == Convention::Hayati;
        // Hayati's rows are used if they are requested or if nothing is; any other request is followed.
        let as_asked =
            |table: &Table| options.convention.is_none() || table.rows.iter().any(|row| row.beta().is_some()) == hayati;
        let own = |value, notes| Ok(Made { table: Noted { value, notes }, convention, gauge: "file" });
        if let (Self::Table { table, .. }, None) = (self, options.gauge)
            && as_asked(table)
        {
            return own(table.clone(), Vec::new());
        }
        let Noted { value: chain, mut notes } = self.chain(selection)?;
        if let (Self::Robot(tree), None, false) = (self, options.gauge, hayati) {
            // A file whose joint origins are D-H rows has chosen its gauge.
            let table = read_off(tree, selection.base, selection.tip, selection.reading);
            // Hayati's rows of a canonical URDF keep its frames near; the table is the one of the robot.
            if let Some(table) = table.filter(|table| table.rows.iter().all(|row| row.beta().is_none())) {
                return own(table, notes);
            }
        }
        let made = table(&chain, &conversion(selection, options, convention))
            .map_err(|source| LoadError::Chain { file: selection.file.to_owned(), source })?;
        notes.extend(made.notes.into_iter().filter(|note| !(hayati && matches!(note, Note::FarNumber { .. }))));
        let gauge = if options.gauge == Some(Gauge::Paper) { "paper" } else { "simple" };
        Ok(Made { table: Noted { value: made.value, notes }, convention, gauge })
    }
}

fn conversion(selection: &Selection, options: &TableOptions, convention: Convention) -> Options {
    let hayati = convention == Convention::Hayati;
    // Hayati's numbers need no axes made parallel.
    let exact = selection.reading == Reading::AsWritten || hayati || options.tolerance <= 0.0;
    Options {
        parallelism: if exact { Parallelism::Exact } else { Parallelism::Within { angle: options.tolerance } },
        gauge: options.gauge.unwrap_or(Gauge::Simple),
        near_parallel: if hayati { NearParallel::HayatiBelow(HAYATI_BELOW) } else { NearParallel::Dh },
    }
}
