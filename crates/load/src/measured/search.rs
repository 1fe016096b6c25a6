//! Options of a calibration: what it fits and searches for.

use super::{DataFile, MeasuredError};
use crate::Loaded;
use denavit_calibrate::calibration::{CalibrateOptions, HoldOut};
use denavit_calibrate::{Freedom, IdentifyOptions, Measurements};
use denavit_identify::effects::catalogue::{KINDS, Kind};
use denavit_identify::parameters::is_zero;
use denavit_identify::posterior::{Earlier, KnownParameter};
use denavit_model::{Chain, Reading};
use denavit_trace::TraceOptions;
use denavit_trace::infer::CurveOptions;

/// What a calibration is asked to fit and to look for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SearchAsked {
    /// Joints whose scale is fitted, too: names, or `all`.
    pub scales: Vec<String>,
    /// Revolute joints whose pitch is fitted, too: names, or `all`.
    pub pitches: Vec<String>,
    /// Joints whose zeros are fitted in place of every axis: names, or `all`.
    pub zeros: Vec<String>,
    /// `none`, `curves`, `auto` (all kinds, and predict by averaging), or kinds of effects.
    pub effects: Vec<String>,
    /// No more effects than this.
    pub max_effects: Option<usize>,
    /// Mass of all links from the first joint on, kg, where the description has none.
    pub mass: Option<f64>,
    /// Motor turns per joint turn: `NAME=RATIO`.
    pub gear_ratios: Vec<String>,
    /// What an earlier calibration of this robot knows, or its siblings do.
    pub prior: Option<DataFile>,
    /// Share of rows to hold out if there is no test file.
    pub hold_out: Option<HoldOut>,
}

/// The options of a calibration, but for other chains ([`other_chains`]).
///
/// # Errors
/// A joint or a kind of effect that is not there, a ratio that is no number.
pub fn search(asked: &SearchAsked, chain: &Chain) -> Result<CalibrateOptions, MeasuredError> {
    let freedom = freedom(chain, &asked.scales, &asked.pitches)?;
    let earlier = asked.prior.as_ref().map(|file| earlier(file, chain)).transpose()?;
    let of_zeros = |known: &KnownParameter| is_zero(&known.parameter);
    if let (Some(file), Some(earlier)) = (&asked.prior, &earlier)
        && earlier.parameters.iter().any(|known| of_zeros(known) == asked.zeros.is_empty())
    {
        let (has, fix) = if asked.zeros.is_empty() {
            ("zeros alone", "give ‹zeros› again, or leave ‹prior› out")
        } else {
            ("axes", "leave ‹zeros› or ‹prior› out")
        };
        return Err(MeasuredError::Option(format!("‹prior› {}: it holds a calibration of {has}; {fix}", file.name)));
    }
    let identify = if asked.zeros.is_empty() {
        IdentifyOptions { freedom, earlier, ..IdentifyOptions::axes(chain) }
    } else {
        let mut which = vec![false; chain.joints().len()];
        mark("‹zeros›", &asked.zeros, chain, &mut which)?;
        let zeros = IdentifyOptions::zeros(chain, which);
        let freedom = Freedom { zeros: zeros.freedom.zeros, axes: zeros.freedom.axes, ..freedom };
        IdentifyOptions { freedom, earlier, tolerances: zeros.tolerances, ..IdentifyOptions::axes(chain) }
    };
    let effects: &[String] = if asked.zeros.is_empty() { &asked.effects } else { &["none".to_owned()] };
    let trace = match effects.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["none" | "curves"] => None,
        ["auto" | AVERAGED] => Some(Vec::new()),
        ref words => Some(words.iter().map(|word| kind(word)).collect::<Result<Vec<Kind>, _>>()?),
    };
    if let Some(mass) = asked.mass.filter(|mass| !(mass.is_finite() && *mass > 0.0)) {
        return Err(MeasuredError::Option(format!(
            "‹mass› {mass}: give the mass of all moving links in kg, such as 28.9"
        )));
    }
    let gear_ratios = gear_ratios(&asked.gear_ratios, chain)?;
    let of_effects = [
        ("‹mass›", asked.mass.is_some()),
        ("‹gear-ratio›", !asked.gear_ratios.is_empty()),
        ("‹max-effects›", asked.max_effects.is_some()),
    ];
    if let (None, Some((option, _))) = (&trace, of_effects.iter().find(|(_, given)| *given)) {
        let without = if asked.zeros.is_empty() { "‹effects› none or curves" } else { "‹zeros›" };
        return Err(MeasuredError::Option(format!(
            "{option}: there is no search for effects with {without}; leave {option} out"
        )));
    }
    let trace = trace.map(|kinds| TraceOptions {
        kinds,
        max_effects: asked.max_effects,
        gear_ratios,
        total_mass: asked.mass,
        ..TraceOptions::new(identify.clone())
    });
    let curves = (effects == ["curves"]).then(CurveOptions::default);
    let (hold_out, average) = (asked.hold_out, effects == ["auto"] || effects == [AVERAGED]);
    let other_chains = Vec::new();
    Ok(CalibrateOptions { identify, hold_out, trace, curves, average, noise: true, other_chains })
}

/// What an earlier calibration knows of this chain.
///
/// # Errors
/// The file is no calibration, or one of another chain or drawing.
pub fn earlier(file: &DataFile, chain: &Chain) -> Result<Earlier, MeasuredError> {
    let unreadable = |error| MeasuredError::Unreadable { file: file.name.clone(), error };
    let bytes = file.content.bytes().map_err(unreadable)?;
    let text = String::from_utf8_lossy(&bytes);
    Ok(Earlier::read(&file.name, &text, chain)?)
}

/// What is fitted: every axis, and scales and pitches of the joints that were named.
///
/// # Errors
/// A name is no joint of the chain.
pub fn freedom(chain: &Chain, scales: &[String], pitches: &[String]) -> Result<Freedom, MeasuredError> {
    let mut freedom = Freedom::axes(chain.joints().len());
    mark("‹scales›", scales, chain, &mut freedom.scales)?;
    mark("‹pitches›", pitches, chain, &mut freedom.pitches)?;
    Ok(freedom)
}

/// Marks the joints that an option names.
fn mark(option: &str, words: &[String], chain: &Chain, flags: &mut [bool]) -> Result<(), MeasuredError> {
    let joints = chain.joints();
    for word in words {
        if word == "all" {
            flags.fill(true);
            continue;
        }
        let joint = joints.iter().position(|joint| joint.name == *word).ok_or_else(|| {
            let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
            MeasuredError::Option(format!(
                "{option}: the chain has no joint \"{word}\"; write all, or some of {}",
                names.join(", ")
            ))
        })?;
        flags[joint] = true;
    }
    Ok(())
}

/// The other chains of a tree whose joints all have a column in these data: what was measured may be one of them.
pub fn other_chains(loaded: &Loaded, chain: &Chain, data: &Measurements) -> Vec<Chain> {
    let Loaded::Robot(tree) = loaded else { return Vec::new() };
    let names = |chain: &Chain| chain.coordinates().iter().map(|c| c.name.clone()).collect::<Vec<_>>();
    let recorded = |name: &String| data.joints.contains(name) || data.covariate(name).is_some();
    let listed = tree.leaf_chains().into_iter().filter(|listing| listing.coordinates.iter().all(recorded));
    let chains = listed
        .filter_map(|listing| Some(tree.chain(Some(&listing.base), Some(&listing.tip), Reading::Intended).ok()?.value));
    let mut others: Vec<Chain> = Vec::new();
    for other in chains {
        let known = names(&other) == names(chain) || others.iter().any(|known| names(known) == names(&other));
        if !other.joints().is_empty() && !known {
            others.push(other);
        }
    }
    others
}

/// What `auto` was called where it averaged: still understood.
const AVERAGED: &str = "averaged";

fn kind(word: &str) -> Result<Kind, MeasuredError> {
    Kind::named(word).ok_or_else(|| {
        let names: Vec<&str> = KINDS.iter().map(|entry| entry.name).collect();
        MeasuredError::Option(format!(
            "‹effects›: \"{word}\" is not a kind of effect; write none, curves, auto, or some of {}",
            names.join(", ")
        ))
    })
}

fn gear_ratios(written: &[String], chain: &Chain) -> Result<Vec<Option<f64>>, MeasuredError> {
    let mut ratios = Vec::new();
    for word in written {
        let wrong = |why: &str| MeasuredError::Option(format!("‹gear-ratio›: \"{word}\" {why}"));
        let (name, ratio) = word.split_once('=').ok_or_else(|| wrong("has no joint; write NAME=RATIO"))?;
        let joint = chain.joints().iter().position(|joint| joint.name == name);
        let joint = joint.ok_or_else(|| wrong("names no joint of the chain"))?;
        let ratio = ratio.parse::<f64>().ok().filter(|ratio| ratio.is_finite() && *ratio != 0.0);
        ratios.resize(chain.joints().len(), None);
        ratios[joint] = Some(ratio.ok_or_else(|| wrong("has no number"))?);
    }
    Ok(ratios)
}
