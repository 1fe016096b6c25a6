//! Effects on the pose of the tip: binds the quantities that they follow to known values, and lists effects that do not move the tip.

use super::MeasuredError;
use denavit_identify::effects::driver::{APPROACH_FROM_ROWS, RUN_ORDER, WARMTH, WOUND_UP};
use denavit_identify::effects::{Correction, SavedEffects, recorded};
use denavit_measurements::covariates::PAYLOAD;
use denavit_measurements::{Covariate, Covariates};

/// Checks that every quantity is known which an effect on the tip follows; `known` tells so for a name.
///
/// # Errors
/// An effect follows what nobody gives.
pub fn all_known(file: &str, effects: &SavedEffects, known: &dyn Fn(&str) -> bool) -> Result<(), MeasuredError> {
    let chain = &effects.statics.chain;
    for effect in effects.effects.iter().filter(|effect| effect.term.moves_the_tip()) {
        for name in effect.term.driver.columns() {
            if !known(name) {
                let name = recorded::plain(name);
                let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(chain));
                return Err(MeasuredError::Option(format!(
                    "{file}: {kind} at {place} follows \"{name}\"; give its value: ‹given› \"{name}=VALUE\""
                )));
            }
        }
    }
    Ok(())
}

/// The effects with a part in where the tip is, bound to the values that were given for what they follow: one row.
///
/// # Errors
/// An effect follows what nobody gives.
pub fn with_given(
    file: &str,
    effects: &SavedEffects,
    given: &[(String, f64)],
) -> Result<(Correction, Covariates), MeasuredError> {
    all_known(file, effects, &|name| recorded::given(given, name).is_some())?;
    let effects = effects.of_the_tip();
    let mut recorded = Covariates::none();
    let mut names = effects.needed();
    names.extend(effects.may_follow());
    names.push(PAYLOAD.to_owned());
    names.sort();
    names.dedup();
    for name in names {
        if let Some(value) = recorded::given(given, &name) {
            recorded.push(Covariate { name, values: vec![value] });
        }
    }
    let model = effects.bound(&|name| recorded.column(file, 1, name));
    Ok((model.map_err(|missing| MeasuredError::Option(missing.to_string()))?, recorded))
}

/// Which effects have no part in where the tip is, a sentence each.
pub fn without_part_in_the_tip(file: &str, effects: &SavedEffects) -> Vec<String> {
    let chain = &effects.statics.chain;
    let without = effects.effects.iter().filter(|effect| !effect.term.moves_the_tip());
    let sentence = |effect: &denavit_identify::effects::Effect<_>| {
        let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(chain));
        format!("{file}: {kind} at {place} changes the measurement, not the pose of the tip; left out")
    };
    without.map(sentence).collect()
}

/// A note on quantities that an averaged prediction follows and that are not given: their averages over the fitted rows are used.
pub fn taken_at_averages(file: &str, effects: &SavedEffects, given: &[(String, f64)]) -> Option<String> {
    let of_rows = |name: &String| {
        name == RUN_ORDER || [APPROACH_FROM_ROWS, WOUND_UP, WARMTH].iter().any(|word| name.contains(word))
    };
    let mut names = effects.may_follow();
    names.retain(|name| !of_rows(name) && recorded::given(given, name).is_none());
    names.sort();
    names.dedup();
    let names: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{file}: the prediction uses the average of the fitted rows for {}; set a value with ‹given›",
            names.join(", ")
        )
    })
}
