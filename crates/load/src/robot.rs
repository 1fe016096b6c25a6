//! A robot as its source gives it, and the chains that it has.

use crate::LoadError;
use denavit_compare::Subject;
use denavit_dh::{Convention, Table};
#[cfg(feature = "calibrate")]
use denavit_identify::effects::driver::Statics;
#[cfg(feature = "calibrate")]
use denavit_model::PlacedRobot;
use denavit_model::notes::{Note, Noted};
use denavit_model::tree::ChainListing;
use denavit_model::{Chain, Reading, Robot, Tips};
#[cfg(feature = "calibrate")]
use std::sync::Arc;

/// A robot as its source gives it.
#[derive(Debug, Clone)]
pub enum Loaded {
    /// A tree.
    Robot(Box<Robot>),
    /// Denavit-Hartenberg numbers.
    Table {
        /// The numbers.
        table: Table,
        /// How the file groups them.
        convention: Convention,
        /// What they stand for.
        chain: Chain,
    },
    /// Screw axes.
    Poe(Chain),
}

/// Which chain of a robot, and how its numbers are read.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Selection<'a> {
    /// What messages call the robot.
    pub file: &'a str,
    /// Link that the chain starts at; `None`: the root, or below the last floating joint.
    pub base: Option<&'a str>,
    /// Link that the chain ends at; `None`: the end of the longest actuated chain.
    pub tip: Option<&'a str>,
    /// How the literals of angles are read.
    pub reading: Reading,
}

/// The chains of a robot from a base link to a leaf.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listing {
    /// The robot's name.
    pub robot: String,
    /// Every chain.
    pub chains: Vec<ChainListing>,
    /// The default one.
    pub default: ChainListing,
}

impl Loaded {
    /// The chain that is chosen, with everything that must be said of it.
    ///
    /// # Errors
    /// There is no such chain.
    pub fn chain(&self, selection: &Selection) -> Result<Noted<Chain>, LoadError> {
        let chain = match self {
            Self::Robot(robot) => {
                let Noted { value, notes } = robot.chain(selection.base, selection.tip, selection.reading)?;
                let mut all: Vec<Note> = robot.notes.clone();
                all.extend(notes);
                return Ok(Noted { value, notes: all });
            }
            Self::Table { chain, .. } | Self::Poe(chain) => chain,
        };
        for (option, link, given) in [("‹base›", chain.base(), selection.base), ("‹tip›", chain.tip(), selection.tip)]
        {
            if given.is_some_and(|given| given != link) {
                return Err(LoadError::OneChain {
                    file: selection.file.to_owned(),
                    option,
                    tip: chain.tip().to_owned(),
                });
            }
        }
        Ok(Noted { value: chain.clone(), notes: Vec::new() })
    }

    /// Refuses a robot whose own chain cannot be used, such as one with numbers beyond all reach: what `table` refuses is refused
    /// wherever the whole robot is written, too.
    ///
    /// # Errors
    /// As [`Loaded::chain`].
    pub fn sound(&self, file: &str) -> Result<(), LoadError> {
        self.chain(&Selection { file, ..Selection::default() }).map(drop)
    }

    /// The chain to one tip (to the selection's where `tips` is empty), or the joints on the ways to several: see [`Chain::joined`].
    ///
    /// # Errors
    /// As [`Loaded::chain`]; the tips make no tree.
    pub fn chain_to(&self, selection: &Selection, tips: &[String]) -> Result<Noted<(Chain, Tips)>, LoadError> {
        let first = self.chain(&Selection { tip: tips.first().map(String::as_str).or(selection.tip), ..*selection })?;
        let (mut notes, mut others) = (first.notes, Vec::new());
        for tip in tips.iter().skip(1) {
            // From the same link, if none is given.
            let (base, tip) = (Some(first.value.base()), Some(tip.as_str()));
            let chain = self.chain(&Selection { base, tip, ..*selection })?;
            notes.extend(chain.notes.into_iter().filter(|note| !notes.contains(note)).collect::<Vec<_>>());
            others.push(chain.value);
        }
        let joined = Chain::joined(&first.value, &others);
        let value = joined.map_err(|source| LoadError::Tips { file: selection.file.to_owned(), source })?;
        Ok(Noted { value, notes })
    }

    /// Every chain that it has.
    pub fn chains(&self) -> Listing {
        match self {
            Self::Robot(robot) => {
                Listing { robot: robot.name.clone(), chains: robot.leaf_chains(), default: robot.default_chain() }
            }
            Self::Table { chain, .. } | Self::Poe(chain) => {
                let coordinates = chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect();
                let listing = ChainListing {
                    base: chain.base().to_owned(),
                    tip: chain.tip().to_owned(),
                    coordinates,
                    links: chain.joints().len() + 1,
                };
                Listing { robot: chain.name().to_owned(), chains: vec![listing.clone()], default: listing }
            }
        }
    }

    /// What gravity acts on, angles read as for the chain.
    #[cfg(feature = "calibrate")]
    pub fn statics(&self, chain: &Chain, reading: Reading) -> Statics {
        self.statics_to(chain, &Arc::new(Tips::only(chain)), reading)
    }

    /// The same on the ways to several tips.
    #[cfg(feature = "calibrate")]
    pub fn statics_to(&self, chain: &Chain, tips: &Arc<Tips>, reading: Reading) -> Statics {
        match self {
            Self::Robot(robot) => Statics::placed_tips(&PlacedRobot::new(robot, reading), chain, tips),
            Self::Table { .. } | Self::Poe(_) => Statics::of_tips(chain, tips),
        }
    }

    /// What a comparison takes.
    pub fn subject<'a>(&'a self, file: &'a str) -> Subject<'a> {
        match self {
            Self::Robot(robot) => Subject::Robot(robot),
            Self::Table { chain, .. } | Self::Poe(chain) => Subject::Chain { file, chain },
        }
    }
}
