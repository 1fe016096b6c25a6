//! Effects and where the tip is: whether what they follow is known, and which have no part in it.

use super::MeasuredError;
use denavit_calibrate::effects::{EffectModel, recorded};

/// Whether everything is known that the effects with a part in where the tip is follow; `known` says so of a name.
///
/// # Errors
/// An effect follows what nobody gives.
pub fn all_known(file: &str, model: &EffectModel, known: &dyn Fn(&str) -> bool) -> Result<(), MeasuredError> {
    let chain = &model.statics.chain;
    for effect in model.effects.iter().filter(|effect| recorded::moves_the_tip(&effect.term)) {
        for name in recorded::needed(&effect.term, chain) {
            if !known(&name) {
                let name = recorded::plain(&name);
                let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(chain));
                return Err(MeasuredError::Option(format!(
                    "{file}: {kind} at {place} follows \"{name}\"; give its value: --given \"{name}=VALUE\""
                )));
            }
        }
    }
    Ok(())
}

/// Which effects have no part in where the tip is, a sentence each.
pub fn without_part_in_the_tip(file: &str, model: &EffectModel) -> Vec<String> {
    let chain = &model.statics.chain;
    let without = model.effects.iter().filter(|effect| !recorded::moves_the_tip(&effect.term));
    let sentence = |effect: &denavit_calibrate::effects::Effect| {
        let (kind, place) = (effect.term.kind.name(), effect.term.carrier.place(chain));
        format!("{file}: {kind} at {place} changes what is measured, not where the tip is; left out")
    };
    without.map(sentence).collect()
}
