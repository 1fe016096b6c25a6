//! Masses of links that the description does not give: unknowns that all compliances of a robot share.
//!
//! The residual of the geometric fit, in units of the noise,
//!
//! ```text
//! r = J b + W w + Σ_s c_s Σ_k (m_k C_sk + m_k Δ_k · D_sk) + e
//! J  geometry, instrument, targets        W  smooth errors of joints and play
//! c  compliances: of each joint about its axis, and of its bearing across it
//! C  effect of c_s = 1 under 1 kg of link k at its assumed centre        D  the same under its first moments, 1 kg m
//! m, Δ  mass and shift of the centre of each link
//! ```
//! b and w are projected out; c, ln m and Δ are found by Gauss-Newton steps on the products of the columns. The priors of m and Δ come
//! from rods, the assumed links (`Masses::stand_in`); the prior of c has one variance about the axes and one across them, found from
//! the data (expectation maximisation). Only the products m·c are identifiable, so the total mass is fixed: at the data sheet's or at
//! that of the rods. The masses are used if those found in either half of the postures predict the other half better than the rods do,
//! with very strong evidence in total (Kass, Raftery 1995).

use crate::linear::{Linear, linearise};
use crate::loads::{of_joint, smooth};
use crate::projected::{Projected, RowProducts, fit_with};
use crate::projector::Projector;
use crate::scorer::carriers_of;
use denavit_identify::arm::Row;
use denavit_identify::averaging::terms::largest_moment;
use denavit_identify::effects::carrier::Carrier;
use denavit_identify::effects::catalogue::Kind;
use denavit_identify::effects::driver::{Conditions, Driver, Posture, Statics};
use denavit_identify::effects::gravity::{Masses, PointMass};
use denavit_identify::effects::model::{Coupling, EffectModel, Term};
use denavit_identify::effects::survey::Survey;
use denavit_identify::parameters::NoEffects;
use denavit_identify::solve::Fit;
use denavit_measurements::Measurements;
use denavit_measurements::covariates::PAYLOAD;
use denavit_model::nalgebra::{DMatrix, DVector, Point3, Vector3};
use serde::Serialize;

/// Standard deviation of a link's mass about the rod's: a factor of two either way.
const MASS: f64 = std::f64::consts::LN_2;
/// A centre is anywhere along a link of the mean length, uniformly: this share of the length is its standard deviation.
const ALONG_A_LINK: f64 = 0.288_675_134_594_812_9;
/// Standard deviation of the total mass, relative: a data sheet's last digit.
const TOTAL: f64 = 0.01;
/// Unknowns of a link: its mass and three first moments.
const UNITS: usize = 4;
/// Largest standard deviation of a joint's deflection under the largest moment, rad: ten tolerances of geometry.
const GIVES: f64 = 1e-2;
/// Twice the logarithm of the odds from which evidence is very strong (Kass, Raftery 1995).
const VERY_STRONG: f64 = 10.0;
/// Largest number of steps; smallest gain of a step that is followed by another, in chi squared.
const STEPS: usize = 60;
const GAINED: f64 = 1e-3;
/// A step without a gain is halved up to this many times.
const HALVINGS: i32 = 12;
/// Largest number of rows used: some ninety parameters need no more.
const ROWS: usize = 2000;

/// The mass of one link, as fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinkMass {
    /// The joint that carries it.
    pub joint: String,
    /// kg.
    pub kg: f64,
    /// Standard deviation, kg, the total mass taken as known.
    pub std: f64,
    /// The assumed mass without data, kg.
    pub assumed_kg: f64,
    /// Its centre, base frame with all joints at zero, m.
    pub centre: [f64; 3],
}

/// Masses of links that were fitted because the description has none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LinkMasses {
    /// Joint by joint.
    pub links: Vec<LinkMass>,
    /// Together, kg.
    pub total_kg: f64,
    /// Whether the total was given; else it is assumed, and the compliances scale with it.
    pub total_given: bool,
    /// Share of the rods' squared residual that the masses explain, in postures that were not used to find them.
    pub explains: f64,
}

impl LinkMasses {
    /// The robot with these masses.
    #[must_use]
    pub fn applied(&self, statics: &Statics) -> Statics {
        let mut statics = statics.clone();
        for (point, link) in statics.masses.points.iter_mut().zip(&self.links) {
            (point.mass, point.centre) = (link.kg, Point3::from(link.centre));
        }
        statics
    }

    /// The finding, as one sentence.
    pub fn said(&self) -> String {
        let total = if self.total_given {
            format!("their total is {:.1} kg as given", self.total_kg)
        } else {
            format!(
                "their total, {:.1} kg, is assumed, and compliances scale with it; give the data sheet's with ‹mass›",
                self.total_kg
            )
        };
        format!(
            "the description has no masses; those of {} links were fitted, which explains {:.0} % of the error that assumed rods leave \
             in other postures ({total})",
            self.links.len(),
            100.0 * self.explains
        )
    }
}

/// Masses of the links, fitted to the rows; `None` if the description has masses, or if fitted ones predict no better than rods.
///
/// `total_given`: whether the rods have the true total mass ([`Statics::of_total`]).
pub fn link_masses(
    statics: &Statics,
    data: &Measurements,
    geometric: &Fit<NoEffects>,
    total_given: bool,
) -> Option<LinkMasses> {
    if statics.masses.from_inertials || statics.masses.points.is_empty() {
        return None;
    }
    let survey = Survey::of(statics, data, Vec::new());
    let compliances = compliances(&survey);
    let masses: Vec<f64> = statics.masses.points.iter().map(|point| point.mass).collect();
    let prior = Prior {
        total: masses.iter().sum(),
        masses,
        centre: ALONG_A_LINK * mean_length(statics)?,
        largest: (GIVES / largest_moment(statics)).powi(2),
    };
    let columns = Columns::of(statics, data, geometric, (&compliances, &smooth(&survey)))?;
    let [first, second] = [0, 1].map(|half| columns.products(Some(half)));
    let (mut rods_leave, mut masses_leave, mut free) = (0.0, 0.0, 0);
    for (own, other) in [(&first, &second), (&second, &first)] {
        let rods = own.solved(&prior, false)?;
        let fitted = own.solved(&prior, true)?;
        let (before, after) = (other.squares(&prior, &rods), other.squares(&prior, &fitted));
        if after >= before {
            return None;
        }
        rods_leave += before;
        masses_leave += after;
        free += other.freedom();
    }
    if free == 0 || (rods_leave - masses_leave) * free as f64 <= VERY_STRONG * masses_leave {
        return None;
    }
    let all = columns.products(None);
    let found = all.solved(&prior, true)?;
    let deviations = all.deviations(&prior, &found)?;
    let joints = statics.chain.joints();
    let links = statics.masses.points.iter().enumerate().map(|(k, point)| {
        let kg = prior.mass(&found, k);
        LinkMass {
            joint: joints[point.joint].name.clone(),
            kg,
            std: kg * deviations[k],
            assumed_kg: prior.masses[k],
            centre: (point.centre + prior.shift(&found, k)).coords.into(),
        }
    });
    let links: Vec<LinkMass> = links.collect();
    Some(LinkMasses {
        total_kg: links.iter().map(|link| link.kg).sum(),
        links,
        total_given,
        explains: 1.0 - masses_leave / rods_leave,
    })
}

/// Mean length of the links that have one, m.
fn mean_length(statics: &Statics) -> Option<f64> {
    let ends =
        |tip: usize| statics.on_the_way(tip).filter_map(move |joint| Some((joint, statics.link_end(joint, tip)?)));
    let lengths: Vec<f64> = (0..statics.tips.all().len())
        .flat_map(ends)
        .map(|(joint, end)| (end.point - statics.points[joint]).norm())
        .filter(|length| *length > 0.0)
        .collect();
    (!lengths.is_empty()).then(|| lengths.iter().sum::<f64>() / lengths.len() as f64)
}

/// Each joint that moves, about its axis; each that turns, across it.
fn compliances(survey: &Survey) -> Vec<Term> {
    let about = survey.moving().filter(|&joint| survey.statics.feels_gravity(joint));
    let about = about.map(|joint| of_joint(Kind::JointCompliance, joint, Driver::Torque(joint)));
    let across = survey.turning().map(|joint| Term {
        kind: Kind::LinkCompliance,
        carrier: Carrier::AxisBasis(joint),
        driver: Driver::MomentAcross(joint),
        coupling: Coupling::Paired,
    });
    about.chain(across).collect()
}

/// Priors of the masses.
struct Prior {
    /// kg.
    masses: Vec<f64>,
    /// Standard deviation of each coordinate of a centre, m.
    centre: f64,
    /// kg.
    total: f64,
    /// Largest variance of compliances.
    largest: f64,
}

/// Compliances, and masses and centres: logarithms of the ratio to the assumed mass, and shifts in units of their deviation.
struct State {
    compliances: DVector<f64>,
    links: DVector<f64>,
    /// Prior variance of the compliances about the axes and across them.
    variances: [f64; 2],
}

impl Prior {
    fn mass(&self, state: &State, link: usize) -> f64 {
        self.masses[link] * (MASS * state.links[UNITS * link]).exp()
    }

    fn shift(&self, state: &State, link: usize) -> Vector3<f64> {
        state.links.fixed_rows::<3>(UNITS * link + 1) * self.centre
    }

    /// Relative excess of the total mass, in units of its deviation, and its derivatives by the links' numbers.
    fn total(&self, state: &State) -> (f64, DVector<f64>) {
        let masses: Vec<f64> = (0..self.masses.len()).map(|link| self.mass(state, link)).collect();
        let sum: f64 = masses.iter().sum();
        let mut slope = DVector::zeros(state.links.len());
        masses.iter().enumerate().for_each(|(link, mass)| slope[UNITS * link] = MASS * mass / sum / TOTAL);
        ((sum / self.total).ln() / TOTAL, slope)
    }
}

/// Meaning of a column: a compliance, and a unit of a link (its mass or a first moment) or the payload.
#[derive(Clone, Copy)]
struct Place {
    compliance: usize,
    unit: Option<usize>,
}

/// Effect of a unit of each compliance under a unit of each load, after projection.
struct Columns {
    places: Vec<Place>,
    projected: Projected,
    /// Whether each compliance is across its axis.
    across: Vec<bool>,
    links: usize,
}

impl Columns {
    fn of(
        statics: &Statics,
        data: &Measurements,
        geometric: &Fit<NoEffects>,
        (compliances, smooth): (&[Term], &[Term]),
    ) -> Option<Self> {
        let mut fit = fit_with(statics, geometric, smooth);
        let thinned = thinned(data, &mut fit);
        let data = thinned.as_ref().unwrap_or(data);
        let linear = linearise(data, &fit, &geometric.arm, &carriers_of(compliances.iter()));
        let (places, cells) = under_units(statics, data, &geometric.arm.joints, compliances, &linear)?;
        let projector = Projector::new(&[&linear.geometry, &linear.effects], &linear.residual);
        let across = compliances.iter().map(|term| term.coupling == Coupling::Paired).collect();
        let projected = Projected::new(&projector, cells, &linear, data);
        Some(Self { places, projected, across, links: statics.masses.points.len() })
    }

    /// Their products in one half of the postures, or in all rows.
    fn products(&self, half: Option<usize>) -> Products<'_> {
        Products { columns: self, of_rows: self.projected.products(half) }
    }
}

/// Some of the rows where they are very many, evenly spread, with their weights in the fit.
fn thinned(data: &Measurements, fit: &mut Fit<EffectModel>) -> Option<Measurements> {
    let step = data.len().div_ceil(ROWS);
    if step < 2 {
        return None;
    }
    let kept: Vec<usize> = (0..data.len()).step_by(step).collect();
    fit.weights = kept.iter().flat_map(|&row| data.of_row(row)).map(|observation| fit.weights[observation]).collect();
    Some(data.subset(&kept))
}

/// Columns of compliances under 1 kg of each link that their joint carries, under its first moments, and under the payload.
fn under_units(
    statics: &Statics,
    data: &Measurements,
    joints: &[denavit_model::ChainJoint],
    compliances: &[Term],
    linear: &Linear,
) -> Option<(Vec<Place>, Vec<f64>)> {
    let points = &statics.masses.points;
    let centres = statics.centres(joints);
    let payload = data.covariate(PAYLOAD).is_some();
    let mut places = Vec::new();
    for (compliance, term) in compliances.iter().enumerate() {
        let joint = term.driver.joint()?;
        for (link, _) in points.iter().enumerate().filter(|(_, point)| statics.tips.carries(joint, point.joint)) {
            places.extend((0..UNITS).map(|k| Place { compliance, unit: Some(UNITS * link + k) }));
        }
        places.extend(payload.then_some(Place { compliance, unit: None }));
    }
    let unit = |unit: usize| {
        let (link, k) = (unit / UNITS, unit % UNITS);
        let shift = if k == 0 { Vector3::zeros() } else { Vector3::ith(k - 1, 1.0) };
        let centre = centres[link] + shift;
        let point = PointMass { joint: points[link].joint, mass: 1.0, centre };
        (Masses { points: vec![point], ..statics.masses }, [centre])
    };
    let units: Vec<(Masses, [Point3<f64>; 1])> = (0..UNITS * points.len()).map(unit).collect();
    let nothing = Masses { points: Vec::new(), ..statics.masses };
    let carriers: Vec<_> = compliances.iter().map(|term| linear.columns_of(term.carrier)).collect::<Option<_>>()?;
    // Unit by unit, so that its loads are found once.
    let each = (0..units.len()).map(Some).chain(payload.then_some(None));
    let columns_of = |unit: Option<usize>| {
        let own = places.iter().enumerate().filter(|(_, place)| place.unit == unit);
        (unit, own.map(|(column, place)| (column, place.compliance)).collect::<Vec<_>>())
    };
    let each: Vec<_> = each.map(columns_of).collect();
    let rows = linear.residual.len();
    let mut cells = vec![0.0; rows * places.len()];
    let mut first = 0;
    let mut values = Vec::new();
    for lines in linear.rows.chunk_by(|a, b| a == b) {
        let row = lines[0];
        let conditions = Conditions::of(Row::new(data, row));
        let mut posture = linear.postures(data)[row].clone();
        let mut at_centre = vec![[0.0; 2]; compliances.len()];
        let mut drive = |posture: &Posture, term: &Term| {
            values.clear();
            term.driver.values_into(statics, &conditions, posture, &mut values);
            [values[0], values.get(1).copied().unwrap_or(0.0)]
        };
        for (unit, own) in &each {
            match *unit {
                Some(unit) => statics.load_with(&units[unit].0, &units[unit].1, None, &mut posture),
                None => statics.load_with(&nothing, &[], Some(&conditions), &mut posture),
            }
            for &(column, compliance) in own {
                let mut driven = drive(&posture, &compliances[compliance]);
                // A first moment is 1 kg further on less 1 kg at the centre.
                match unit.map(|unit| unit % UNITS) {
                    Some(0) => at_centre[compliance] = driven,
                    Some(_) => driven.iter_mut().zip(at_centre[compliance]).for_each(|(value, at)| *value -= at),
                    None => {}
                }
                let carrier = &carriers[compliance];
                for line in first..first + lines.len() {
                    let moved = carrier
                        .clone()
                        .zip(driven)
                        .map(|(direction, value)| linear.carriers[(line, direction)] * value);
                    cells[column * rows + line] = moved.sum();
                }
            }
        }
        first += lines.len();
    }
    Some((places, cells))
}

/// The columns and their products in some of the rows.
struct Products<'a> {
    columns: &'a Columns,
    of_rows: RowProducts,
}

/// Half the gradient of the cost, and half its curvature (Gauss-Newton), in compliances and the links' numbers, without the prior of the
/// compliances, whose variances change while the state does not.
struct Normal {
    slope: DVector<f64>,
    curvature: DMatrix<f64>,
}

impl Products<'_> {
    /// Number of values, less the share of the directions that are projected out.
    fn freedom(&self) -> usize {
        let (values, projected) = (self.of_rows.values, &self.columns.projected);
        values.saturating_sub(projected.rank * values / projected.rows().max(1))
    }

    /// How much of each column a state takes, and its derivatives by the compliances and then by the links' numbers.
    fn taken(&self, prior: &Prior, state: &State) -> (DVector<f64>, DMatrix<f64>) {
        let compliances = state.compliances.len();
        let mut taken = DVector::zeros(self.columns.places.len());
        let mut slopes = DMatrix::zeros(self.columns.places.len(), compliances + state.links.len());
        for (column, place) in self.columns.places.iter().enumerate() {
            let c = state.compliances[place.compliance];
            let Some(unit) = place.unit else {
                (taken[column], slopes[(column, place.compliance)]) = (c, 1.0);
                continue;
            };
            let (link, k) = (unit / UNITS, unit % UNITS);
            let mass = prior.mass(state, link);
            let size = if k == 0 { mass } else { mass * prior.shift(state, link)[k - 1] };
            taken[column] = c * size;
            slopes[(column, place.compliance)] = size;
            slopes[(column, compliances + UNITS * link)] = c * size * MASS;
            if k > 0 {
                slopes[(column, compliances + unit)] = c * mass * prior.centre;
            }
        }
        (taken, slopes)
    }

    /// The sum of squared residuals of a state.
    fn squares(&self, prior: &Prior, state: &State) -> f64 {
        let (taken, _) = self.taken(prior, state);
        self.of_rows.square + 2.0 * self.of_rows.along.dot(&taken) + taken.dot(&(&self.of_rows.gram * &taken))
    }

    fn precision(&self, state: &State, compliance: usize) -> f64 {
        1.0 / state.variances[usize::from(self.columns.across[compliance])]
    }

    /// With the penalties of the priors.
    fn cost(&self, prior: &Prior, state: &State) -> f64 {
        let compliances =
            state.compliances.iter().enumerate().map(|(k, c)| c * c * self.precision(state, k)).sum::<f64>();
        self.squares(prior, state) + compliances + state.links.norm_squared() + prior.total(state).0.powi(2)
    }

    fn normal(&self, prior: &Prior, state: &State) -> Normal {
        let (taken, slopes) = self.taken(prior, state);
        let compliances = state.compliances.len();
        let mut slope = slopes.tr_mul(&(&self.of_rows.along + &self.of_rows.gram * taken));
        let mut curvature = slopes.tr_mul(&(&self.of_rows.gram * &slopes));
        let (excess, total) = prior.total(state);
        let mut links = slope.rows_mut(compliances, state.links.len());
        links += &state.links + &total * excess;
        let mut links = curvature.view_mut((compliances, compliances), (state.links.len(), state.links.len()));
        links += &total * total.transpose();
        (0..state.links.len()).for_each(|k| links[(k, k)] += 1.0);
        Normal { slope, curvature }
    }

    /// Half the gradient of the cost in the first numbers, and the inverse of half its curvature there.
    fn step(
        &self,
        Normal { slope, curvature }: &Normal,
        state: &State,
        free: usize,
    ) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let mut slope = slope.rows(0, free).into_owned();
        let mut curvature = curvature.view((0, 0), (free, free)).into_owned();
        for k in 0..state.compliances.len() {
            slope[k] += state.compliances[k] * self.precision(state, k);
            curvature[(k, k)] += self.precision(state, k);
        }
        Some((slope, scaled_inverse(&curvature)?))
    }

    /// Compliances, and, where they are free, masses and centres.
    fn solved(&self, prior: &Prior, free: bool) -> Option<State> {
        let compliances = self.columns.across.len();
        let rods = State {
            compliances: DVector::zeros(compliances),
            links: DVector::zeros(UNITS * self.columns.links),
            variances: [f64::INFINITY; 2],
        };
        // Under rods the compliances are linear; a unit of prior variance moves the tip as far as the residual is large.
        let (_, slopes) = self.taken(prior, &rods);
        let seen = slopes.tr_mul(&(&self.of_rows.gram * &slopes)).diagonal().rows(0, compliances).into_owned();
        let largest = |across: bool| {
            (0..compliances).filter(|&k| self.columns.across[k] == across).map(|k| seen[k]).fold(0.0, f64::max)
        };
        let variances = [false, true]
            .map(|across| (self.of_rows.square / largest(across).max(f64::MIN_POSITIVE)).min(prior.largest));
        let mut state = self.converged(prior, State { variances, ..rods }, compliances)?;
        if free {
            state = self.converged(prior, state, compliances + UNITS * self.columns.links)?;
        }
        Some(state)
    }

    /// The best state in its first numbers, and the variances of compliances that go with it.
    fn converged(&self, prior: &Prior, mut state: State, free: usize) -> Option<State> {
        let compliances = state.compliances.len();
        let (mut cost, mut normal) = (self.cost(prior, &state), self.normal(prior, &state));
        for _ in 0..STEPS {
            let (slope, inverse) = self.step(&normal, &state, free)?;
            let step = -inverse * slope;
            let moved = |share: f64| State {
                compliances: &state.compliances + step.rows(0, compliances) * share,
                links: if free > compliances {
                    &state.links + step.rows(compliances, free - compliances) * share
                } else {
                    state.links.clone()
                },
                variances: state.variances,
            };
            let shares = (0..HALVINGS).map(|halvings| 0.5_f64.powi(halvings));
            let better =
                shares.map(moved).map(|state| (self.cost(prior, &state), state)).find(|(found, _)| *found < cost);
            let gained = better.as_ref().map_or(0.0, |(found, _)| cost - found);
            if let Some((_, better)) = better {
                state = better;
                normal = self.normal(prior, &state);
            }
            let (_, covariance) = self.step(&normal, &state, free)?;
            state.variances = self.variances(prior, &state, &covariance);
            cost = self.cost(prior, &state);
            if gained < GAINED {
                break;
            }
        }
        Some(state)
    }

    /// Prior variances of the compliances as expectation maximisation has them next.
    fn variances(&self, prior: &Prior, state: &State, covariance: &DMatrix<f64>) -> [f64; 2] {
        [false, true].map(|across| {
            let own = || (0..self.columns.across.len()).filter(|&k| self.columns.across[k] == across);
            let squares: f64 = own().map(|k| state.compliances[k].powi(2) + covariance[(k, k)]).sum();
            (squares / own().count().max(1) as f64).min(prior.largest)
        })
    }

    /// Standard deviation of each link's mass, relative.
    fn deviations(&self, prior: &Prior, state: &State) -> Option<Vec<f64>> {
        let compliances = state.compliances.len();
        let (_, covariance) = self.step(&self.normal(prior, state), state, compliances + state.links.len())?;
        let of = |link: usize| MASS * covariance[(compliances + UNITS * link, compliances + UNITS * link)].sqrt();
        Some((0..self.columns.links).map(of).collect())
    }
}

/// Inverse of a positive definite matrix whose rows have different units.
fn scaled_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = matrix.diagonal().map(|cell| 1.0 / cell.max(f64::MIN_POSITIVE).sqrt());
    let scaled = |matrix: &DMatrix<f64>| matrix.map_with_location(|i, j, cell| cell * scale[i] * scale[j]);
    Some(scaled(&scaled(matrix).cholesky()?.inverse()))
}
