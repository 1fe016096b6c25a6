//! A model of several tips, reduced to the chain to one of them.

use crate::arm::Arm;
use crate::effects::averaged::{Averaged, Known, Spread};
use crate::effects::carrier::Carrier;
use crate::effects::correction::Correction;
use crate::effects::curve::Curve;
use crate::effects::driver::{Driver, JointVelocity, Statics};
use crate::effects::everything::Everything;
use crate::effects::gravity::{Masses, PointMass};
use crate::effects::model::{Coupling, Effect, EffectModel, Term};
use denavit_measurements::Scene;
use denavit_model::Tips;
use std::sync::Arc;

impl Statics {
    /// For the chain to one tip: the load of joints that are not on the way to it stays at its home position, as with other joints
    /// of a tree.
    fn to_tip(&self, tip: usize) -> Self {
        let chain = self.tips[tip].chain(&self.chain).expect("a part of a chain is a chain");
        let own = self.own(tip);
        let on_the_way = |mass: &PointMass| {
            let mut at = Some(mass.joint);
            while let Some(joint) = at {
                if let Some(own) = own[joint] {
                    return Some(PointMass { joint: own, ..*mass });
                }
                at = self.carrier(joint);
            }
            None
        };
        let masses = Masses { points: self.masses.points.iter().filter_map(on_the_way).collect(), ..self.masses };
        let ends = self.chain.joints().len() + tip;
        let points = self.on_the_way(tip).chain([ends]).map(|slot| self.points[slot]).collect();
        let tips = Arc::new(Tips::only(&chain));
        Self::new(chain, tips, masses, points)
    }

    /// For each joint its index on the way to a tip, if it is on it.
    fn own(&self, tip: usize) -> Vec<Option<usize>> {
        let mut own = vec![None; self.chain.joints().len()];
        self.on_the_way(tip).enumerate().for_each(|(place, joint)| own[joint] = Some(place));
        own
    }
}

impl EffectModel {
    /// The effects on the way to one tip, for its chain.
    #[must_use]
    pub fn to_tip(&self, tip: usize) -> Self {
        if !self.statics.tips.several() {
            return self.clone();
        }
        let own = self.statics.own(tip);
        let curve = |curve: &Curve| Some(Curve { joint: own[curve.joint]?, ..curve.clone() });
        Self {
            statics: self.statics.to_tip(tip),
            effects: self.effects.iter().filter_map(|effect| Some(self.on_the_way(effect, &own)?.effect)).collect(),
            curves: self.curves.iter().filter_map(curve).collect(),
            earlier: None,
        }
    }

    fn on_the_way(&self, Effect { term, coefficients }: &Effect, own: &[Option<usize>]) -> Option<OnTheWay> {
        let carrier = renumbered(term.carrier, own)?;
        let (driver, kept) = match &term.driver {
            // Links that are not on the way do not belong to this chain.
            Driver::TorqueTerms { joint, links } => {
                let parts = self.statics.carried(*joint, *links).map(|link| own[link].is_some());
                let parts: Vec<bool> = parts.flat_map(|part| [part; 2]).collect();
                let links = parts.iter().filter(|part| **part).count() / 2;
                (Driver::TorqueTerms { joint: own[*joint]?, links }, parts)
            }
            driver => (driven(driver, own)?, vec![true; driver.len(&self.statics)]),
        };
        let numbers: Vec<bool> = match term.coupling {
            Coupling::Paired => vec![true; coefficients.len()],
            Coupling::Each => kept.iter().copied().cycle().take(coefficients.len()).collect(),
        };
        let coefficients = coefficients.iter().zip(&numbers).filter(|(_, kept)| **kept).map(|(value, _)| *value);
        let coefficients = coefficients.collect();
        let effect = Effect { term: Term { carrier, driver, ..term.clone() }, coefficients };
        Some(OnTheWay { effect, values: kept, numbers })
    }
}

impl Correction {
    /// The part on the way to one tip, for its chain.
    #[must_use]
    pub fn to_tip(&self, tip: usize) -> Self {
        if !self.effects.statics.tips.several() {
            return self.clone();
        }
        let averaged = self.averaged.as_ref().map(|averaged| averaged.to_tip(tip));
        Self { effects: self.effects.to_tip(tip), averaged }
    }
}

/// An effect for a chain that contains its joints.
struct OnTheWay {
    effect: Effect,
    /// Which values of its driver are left.
    values: Vec<bool>,
    /// Which of its coefficients are left.
    numbers: Vec<bool>,
}

impl Averaged {
    /// For the chain to one tip alone.
    fn to_tip(&self, tip: usize) -> Self {
        let (mean, known) = (self.mean(), &self.known);
        let own = mean.statics.own(tip);
        let (mut left, mut averages) = (Vec::new(), Vec::new());
        for (effect, of_driver) in mean.effects.iter().zip(&self.averages) {
            let Some(OnTheWay { values, numbers, .. }) = mean.on_the_way(effect, &own) else {
                left.resize(left.len() + effect.coefficients.len(), false);
                continue;
            };
            left.extend(numbers);
            averages.push(of_driver.iter().zip(values).filter(|(_, kept)| *kept).map(|(value, _)| *value).collect());
        }
        for curve in &mean.curves {
            left.resize(left.len() + curve.waves.len(), own[curve.joint].is_some());
        }
        // For each number its new index.
        let mut next = 0..;
        let places: Vec<Option<usize>> = left.into_iter().map(|left| left.then(|| next.next()).flatten()).collect();
        let spread = |spread: &Spread| {
            let numbers = spread.kept.len();
            let frames = spread.covariance.nrows() - numbers - 3 * known.tips.len();
            let left = (0..numbers).filter(|&k| places[spread.kept[k]].is_some());
            let target = numbers + frames + 3 * tip;
            let cells: Vec<usize> = left.chain(numbers..numbers + frames).chain(target..target + 3).collect();
            Spread {
                kept: spread.kept.iter().filter_map(|&number| places[number]).collect(),
                covariance: spread.covariance.select_rows(&cells).select_columns(&cells),
            }
        };
        let (drawn, geometric) = (known.drawn.nominal_to(tip), known.geometric.chain_to(tip));
        let arm = Arm::new(&drawn, &Scene::default());
        let moves = known.drawn.tips[tip].coordinates.iter();
        let known = Known {
            geometric: Arm { joints: geometric.joints().to_vec(), ..arm.clone() },
            drawn: arm,
            tips: vec![known.tips[tip]],
            spread: spread(&known.spread),
            geometric_spread: spread(&known.geometric_spread),
            ranges: known.ranges.iter().zip(moves).filter(|(_, moves)| **moves).map(|(range, _)| *range).collect(),
            ..Known::clone(known)
        };
        Self::new(Everything(mean.to_tip(tip)), averages, known)
    }
}

fn renumbered(carrier: Carrier, own: &[Option<usize>]) -> Option<Carrier> {
    Some(match carrier {
        Carrier::Joint(i) => Carrier::Joint(own[i]?),
        Carrier::Along(i) => Carrier::Along(own[i]?),
        Carrier::AxisBasis(i) => Carrier::AxisBasis(own[i]?),
        Carrier::Sideways(i) => Carrier::Sideways(own[i]?),
        Carrier::LinkEnd(i) => Carrier::LinkEnd(own[i]?),
        Carrier::LinkEndTurn(i) => Carrier::LinkEndTurn(own[i]?),
        Carrier::LinkLength(i) => Carrier::LinkLength(own[i]?),
        Carrier::Lengths
        | Carrier::Base
        | Carrier::BaseTurn
        | Carrier::Target
        | Carrier::Anchor
        | Carrier::Scale
        | Carrier::Reading
        | Carrier::Sight
        | Carrier::Range
        | Carrier::AllJoints => carrier,
    })
}

fn driven(driver: &Driver, own: &[Option<usize>]) -> Option<Driver> {
    let mut driver = driver.clone();
    if let Some(joint) = driver.joint_mut() {
        *joint = own[*joint]?;
    } else if let Driver::Velocities(moving) = &mut driver {
        let on_the_way = |of: &JointVelocity| Some(JointVelocity { joint: own[of.joint]?, ..of.clone() });
        *moving = moving.iter().filter_map(on_the_way).collect();
    }
    Some(driver)
}
