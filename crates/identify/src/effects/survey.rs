//! Survey of the data: which joints move and how far, and what was recorded.

use crate::arm::Row;
use crate::effects::approach::still;
use crate::effects::driver::{Conditions, JointVelocity, RUN_ORDER, Statics, TIME, VELOCITY};
use crate::effects::history::{History, Move, Pace};
use denavit_measurements::kinds::ObservationKind;
use denavit_measurements::{Column, Covariate, Measurements};
use denavit_model::Screw;
use std::f64::consts::PI;

/// Highest order of a periodic error in the search without a gear ratio, periods per turn.
pub const HIGHEST_ORDER: u32 = 8;
/// Highest order of a gear with unknown ratio, if there are enough rows.
const HIGHEST_ORDER_OF_A_GEAR: f64 = 40.0;
/// Fewest rows for each period of such an error over the joint's range.
const ROWS_PER_PERIOD: f64 = 4.0;
/// Steps of the scan of such orders per period over the joint's range: the order is refined afterwards.
const HIGH_ORDERS_PER_PERIOD: f64 = 2.0;
/// Lowest order, periods per turn.
const LOWEST_ORDER: f64 = 0.5;
/// Steps of the scan of orders per period over the joint's range.
const ORDERS_PER_PERIOD: f64 = 3.0;
/// Standard widths of a bump to try, as fractions of the joint's range.
const BUMP_WIDTHS: [f64; 4] = [0.015, 0.03, 0.06, 0.1];
/// Positions of a step to try before the best is refined.
const STEP_PLACES: usize = 60;
/// Number of rows whose torques are examined.
const POSTURES: usize = 200;
/// Shortest and longest lag of warmth that a run shows, as fractions of its length: a shorter lag sees the last moves only, a longer one
/// all travel since the first row.
const LAGS: [f64; 2] = [0.03, 2.0];
/// A step needs this many rows on either side.
const ROWS_BESIDE_STEP: usize = 6;

/// The quantity that drifts depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    /// `time`, or run order.
    pub column: Column,
    /// Its values, ascending.
    pub sorted: Vec<f64>,
}

/// The data at hand.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The nominal chain and its masses.
    pub statics: Statics,
    /// Whether values are read in an instrument's frame.
    pub instrument: bool,
    /// Whether targets are measured along lines of sight.
    pub sight: bool,
    /// Whether lengths from fixed points are measured.
    pub anchor: bool,
    /// Number of rows without locating ones.
    pub rows: usize,
    /// Lowest and highest value of each joint, rad or m.
    pub ranges: Vec<(f64, f64)>,
    /// Recorded temperatures.
    pub temperatures: Vec<Column>,
    /// Recorded inclinations, and the standard deviation of each, in the column's own unit.
    pub tilts: Vec<(Column, f64)>,
    /// The velocity of every joint that moves; empty where that of one is not recorded, or where none of them varies.
    pub velocities: Vec<JointVelocity>,
    /// Time or run order; `None` with too few rows.
    pub clock: Option<Clock>,
    /// Every recorded column that varies.
    pub recorded: Vec<Column>,
    /// Motor turns per joint turn, one per joint where given.
    pub gear_ratios: Vec<Option<f64>>,
    /// For each joint the largest torque (N·m) or force (N) of gravity on it, of some rows of the data.
    pub torques: Vec<f64>,
}

impl Survey {
    /// Surveys the rows of `data` (locating rows left out).
    pub fn of(statics: &Statics, data: &Measurements, gear_ratios: Vec<Option<f64>>) -> Self {
        let rows: Vec<usize> = (0..data.len()).filter(|&row| !data.locate[row]).collect();
        let range = |joint: &denavit_model::ChainJoint| {
            let seen = rows.iter().filter(|&&row| data.moves_its_tip(row, joint.coordinate));
            seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &row| {
                let value = joint.value(data.reading(row));
                (low.min(value), high.max(value))
            })
        };
        let ranges: Vec<(f64, f64)> = statics.chain.joints().iter().map(range).collect();
        let varies =
            |covariate: &&Covariate| rows.iter().any(|&row| covariate.values[row] != covariate.values[rows[0]]);
        let recorded: Vec<Column> =
            data.covariates.iter().filter(varies).filter_map(|c| data.column(&c.name).ok()).collect();
        let of_the_room = |name: &str| name.ends_with("temperature") && !name.ends_with(".temperature");
        let temperatures = recorded.iter().filter(|column| of_the_room(column.name())).cloned().collect();
        let scatter = |column: &Column| {
            let values = || rows.iter().map(|&row| data.covariates.row(row).value(column));
            let mean = values().sum::<f64>() / rows.len() as f64;
            (values().map(|value| (value - mean).powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
        };
        let tilts = recorded.iter().filter(|column| column.name().starts_with("tilt"));
        let tilts = tilts.map(|column| (column.clone(), scatter(column))).collect();
        let velocities = velocities(statics, data, &ranges, &recorded);
        let clock = [TIME, RUN_ORDER].into_iter().find_map(|name| {
            let column = data.covariate(name).filter(|column| varies(column))?;
            let mut sorted: Vec<f64> = rows.iter().map(|&row| column.values[row]).collect();
            sorted.sort_by(f64::total_cmp);
            let column = data.column(name).ok()?;
            (sorted.len() > 3 * ROWS_BESIDE_STEP).then_some(Clock { column, sorted })
        });
        let anchored = |kind: &ObservationKind| kind.unknowns().point.is_some() && kind.own_target().is_none();
        let (instrument, anchor) = (data.scene.has_instruments(), data.scene.kinds().iter().any(anchored));
        let sight = data.scene.kinds().iter().any(|kind| kind.has_a_line_of_sight());
        let torques = torques(statics, data, &rows);
        let (statics, rows) = (statics.clone(), rows.len());
        Self {
            statics,
            instrument,
            sight,
            anchor,
            rows,
            ranges,
            temperatures,
            tilts,
            velocities,
            clock,
            recorded,
            gear_ratios,
            torques,
        }
    }

    /// The columns of a joint's wind-up, one for each memory.
    pub fn wound_up(&self, joint: usize) -> impl Iterator<Item = Column> + '_ {
        self.histories(joint, |history| matches!(history, History::WoundUp { .. }))
    }

    /// The columns of a joint's warmth, one for each lag that a run of this length can show.
    pub fn warmth(&self, joint: usize) -> impl Iterator<Item = Column> + '_ {
        let clock = self.clock.as_ref();
        let by_time = clock.is_some_and(|clock| clock.column.name() == TIME);
        let own = if by_time { Pace::Seconds } else { Pace::Rows };
        let (shortest, longest) = clock.map_or((1.0, 0.0), |clock| {
            let [shortest, longest] = LAGS.map(|share| share * clock.span());
            (shortest, longest)
        });
        self.histories(joint, move |history| match history {
            History::Warmth { lag, pace } => pace == own && (shortest..=longest).contains(&lag),
            _ => false,
        })
    }

    /// The columns of a joint that are computed from the order of the rows, of the wanted kinds.
    fn histories<'a>(
        &'a self,
        joint: usize,
        wanted: impl Fn(History) -> bool + 'a,
    ) -> impl Iterator<Item = Column> + 'a {
        let histories = History::available(true).filter(move |history| wanted(*history));
        histories.filter_map(move |history| self.of_joint(joint, &history.ending()))
    }

    /// These fractions of the largest torque of gravity on a joint; none where gravity does not load it.
    pub fn torques_of(&self, joint: usize, shares: &'static [f64]) -> impl Iterator<Item = f64> + use<> {
        let largest = self.torques[joint];
        shares.iter().map(move |share| share * largest).filter(|torque| *torque > 0.0)
    }

    /// Joints whose value changes.
    pub fn moving(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.ranges.len()).filter(|&joint| moves(self.ranges[joint]))
    }

    /// Those of them that turn.
    pub fn turning(&self) -> impl Iterator<Item = usize> + '_ {
        self.moving().filter(|&joint| !self.slides(joint))
    }

    /// Whether a joint slides.
    pub fn slides(&self, joint: usize) -> bool {
        matches!(self.statics.chain.joints()[joint].screw, Screw::Prismatic(_))
    }

    /// How far a joint moves in the data, rad or m.
    pub fn span(&self, joint: usize) -> f64 {
        self.ranges[joint].1 - self.ranges[joint].0
    }

    /// The column `<joint><ending>`, such as `elbow.temperature`, where it is recorded and varies.
    pub fn of_joint(&self, joint: usize, ending: &str) -> Option<Column> {
        let name = format!("{}{ending}", self.statics.chain.joints()[joint].name);
        self.recorded.iter().find(|column| column.name() == name).cloned()
    }

    /// Spacing of orders that a scan needs: a fraction of a period over the joint's range.
    pub fn order_step(&self, joint: usize) -> f64 {
        2.0 * PI / self.span(joint) / ORDERS_PER_PERIOD
    }

    /// Orders to try: whole ones up to the highest, and a grid fine enough to find any other between.
    ///
    /// An order needs half a period over the measured range. For a slide orders count periods per 2π m, and
    /// the highest has four periods over the range.
    pub fn orders(&self, joint: usize) -> Vec<f64> {
        let span = self.span(joint);
        let lowest = if self.slides(joint) { PI / span } else { LOWEST_ORDER.max(PI / span) };
        let highest = if self.slides(joint) { 8.0 * PI / span } else { f64::from(HIGHEST_ORDER) };
        let mut orders: Vec<f64> = Vec::new();
        if !self.slides(joint) {
            orders.extend((1..=HIGHEST_ORDER).map(f64::from).filter(|&order| order >= lowest));
        }
        let step = self.order_step(joint);
        let mut order = lowest;
        while order <= highest {
            orders.push(order);
            order += step;
        }
        orders.sort_by(f64::total_cmp);
        orders.dedup();
        orders
    }

    /// Orders above those of [`Survey::orders`], as high as the number of rows allows: of wheels inside a gear.
    pub fn high_orders(&self, joint: usize) -> Vec<f64> {
        let per_period = 2.0 * PI / self.span(joint);
        let highest = HIGHEST_ORDER_OF_A_GEAR.min(per_period * self.rows as f64 / ROWS_PER_PERIOD);
        let from = f64::from(HIGHEST_ORDER);
        let step = per_period / HIGH_ORDERS_PER_PERIOD;
        let orders = std::iter::successors(Some(from + step), |order| Some(order + step));
        orders.take_while(|order| *order <= highest && !self.slides(joint)).collect()
    }

    /// Orders of the motor side: once and twice per motor turn.
    pub fn motor_orders(&self, joint: usize) -> Vec<f64> {
        let ratio = self.gear_ratios.get(joint).copied().flatten();
        ratio.map_or_else(Vec::new, |ratio| vec![ratio, 2.0 * ratio])
    }

    /// Middles and widths of bumps to try.
    pub fn bumps(&self, joint: usize) -> Vec<(f64, f64)> {
        let (low, high) = self.ranges[joint];
        let mut bumps = Vec::new();
        for share in BUMP_WIDTHS {
            let width = share * (high - low);
            let mut at = low + width;
            while at < high {
                bumps.push((at, width));
                at += 1.2 * width;
            }
        }
        bumps
    }
}

impl Clock {
    /// Where it starts.
    pub fn first(&self) -> f64 {
        self.sorted[0]
    }

    /// How long it runs.
    pub fn span(&self) -> f64 {
        self.sorted[self.sorted.len() - 1] - self.sorted[0]
    }

    /// Time constants to try.
    pub fn constants(&self) -> Vec<f64> {
        [0.03, 0.08, 0.2, 0.5].iter().map(|share| share * self.span()).collect()
    }

    /// Positions of a step to try: between rows, evenly over the run.
    pub fn places(&self) -> Vec<f64> {
        let all = self.all_places();
        let stride = all.len().div_ceil(STEP_PLACES).max(1);
        all.into_iter().step_by(stride).collect()
    }

    /// Every position between two rows with enough rows on either side.
    pub fn all_places(&self) -> Vec<f64> {
        let last = self.sorted.len().saturating_sub(ROWS_BESIDE_STEP);
        (ROWS_BESIDE_STEP..last)
            .filter(|&k| self.sorted[k] > self.sorted[k - 1])
            .map(|k| 0.5 * (self.sorted[k - 1] + self.sorted[k]))
            .collect()
    }

    /// Sets of knots for a piecewise linear curve; `fine`: also finer ones, where one number per row drifts.
    pub fn pieces(&self, fine: bool) -> Vec<Vec<f64>> {
        let counts: &[usize] = if fine { &[5, 10, 20, 40] } else { &[5] };
        counts.iter().filter(|&&pieces| self.sorted.len() > 8 * pieces).map(|&pieces| self.knots(pieces)).collect()
    }

    /// Knots of this number of equal pieces.
    pub fn knots(&self, pieces: usize) -> Vec<f64> {
        (0..=pieces).map(|k| self.first() + self.span() * k as f64 / pieces as f64).collect()
    }
}

/// Whether a joint with this range moves.
fn moves((low, high): (f64, f64)) -> bool {
    high - low > 1e-6
}

/// The velocity of every joint that moves: all of them, or none.
fn velocities(
    statics: &Statics,
    data: &Measurements,
    ranges: &[(f64, f64)],
    recorded: &[Column],
) -> Vec<JointVelocity> {
    let chain = &statics.chain;
    let moving = (0..ranges.len()).filter(|&joint| moves(ranges[joint]));
    let of = |joint: usize| {
        let name = format!("{}{VELOCITY}", chain.coordinates()[chain.joints()[joint].coordinate].name);
        Some(JointVelocity { joint, of_coordinate: data.column(&name).ok()? })
    };
    let all: Vec<JointVelocity> = moving.map(of).collect::<Option<_>>().unwrap_or_default();
    let varies = all.iter().any(|joint| recorded.contains(&joint.of_coordinate));
    if varies { all } else { Vec::new() }
}

/// The largest torque of gravity on each joint: of at most [`POSTURES`] rows, spread over the data.
fn torques(statics: &Statics, data: &Measurements, rows: &[usize]) -> Vec<f64> {
    let mut largest = vec![0.0_f64; statics.chain.joints().len()];
    let few = rows.len().div_ceil(POSTURES).max(1);
    for &row in rows.iter().step_by(few) {
        let posture = statics.posture(statics.chain.joints(), &Conditions::of(Row::new(data, row)), None);
        for (joint, largest) in largest.iter_mut().enumerate() {
            *largest = largest.max(statics.torque(&posture, joint).abs());
        }
    }
    largest
}

/// Adds columns that are computed from the order of the rows: run order, and for each joint its side of approach, its wind-up and its
/// warmth. Rows of a longer run that have these columns keep them.
pub fn with_run_order(data: Measurements) -> Measurements {
    ordered(data, None)
}

/// The same for rows that were measured after those of `before`, which has its run order: a test file's after the
/// training file's.
pub fn with_run_order_after(data: Measurements, before: &Measurements) -> Measurements {
    ordered(data, Some(before))
}

fn ordered(mut data: Measurements, before: Option<&Measurements>) -> Measurements {
    if data.covariate(RUN_ORDER).is_some() {
        return data;
    }
    let first = before.map_or(0, Measurements::len);
    let rows = data.len();
    let order = (0..rows).map(|row| (first + row) as f64).collect();
    data.covariates.push(Covariate { name: RUN_ORDER.into(), values: order });
    let before = before.filter(|before| !before.is_empty());
    let times = data.column(TIME).ok().and_then(|_| data.covariate(TIME)).map(|column| column.values.clone());
    let last_time = before.and_then(|before| before.covariate(TIME)?.values.last().copied());
    for (index, joint) in data.joints.clone().iter().enumerate() {
        let readings: Vec<f64> = (0..rows).map(|row| data.reading(row)[index]).collect();
        let still = still(&readings);
        for history in History::available(times.is_some()) {
            let name = format!("{joint}{}", history.ending());
            let mut last = before.map(|before| before.reading(before.len() - 1)[index]);
            let mut then = last_time;
            let mut state = before.and_then(|before| before.covariate(&name)?.values.last().copied()).unwrap_or(0.0);
            let after = |(row, here): (usize, &f64)| {
                // A cell may be empty where the joint does not move the tip; it then reads 0.
                if *here != 0.0 || data.moves_its_tip(row, index) {
                    let moved = last.replace(*here).map(|last| here - last);
                    let now = times.as_ref().map(|times| times[row]);
                    let since = then;
                    then = now.or(then);
                    let seconds = now.zip(since).map(|(now, since)| now - since);
                    // The history before the first row is unknown.
                    if let Some(moved) = moved {
                        state = history.after(Move { moved, still, seconds }, state);
                    }
                }
                state
            };
            let values = readings.iter().enumerate().map(after).collect();
            data.covariates.push(Covariate { name, values });
        }
    }
    data
}
