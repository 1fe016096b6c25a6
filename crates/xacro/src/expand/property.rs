//! `<xacro:property>`

use std::rc::Rc;

use super::expander::{Expander, Outcome, Sight};
use super::values::literal;
use crate::expression::{Value, is_global, is_name};
use crate::scope::Entry;
use crate::tree::Element;

impl Expander<'_> {
    pub fn property(&mut self, element: &Rc<Element>, sight: &Sight) -> Outcome<()> {
        let [name] = self.attributes(element, ["name"], &["value", "default", "remove", "scope", "lazy_eval"])?;
        let spot = element.spot_of(name);
        let scope = &sight.symbols;
        let name = self.words(&name.value, &spot, scope)?;
        if !is_name(&name) || name.starts_with("__") {
            return Err(Self::wrong(element, format!("\"{name}\" cannot be the name of a property")).help(
                "use letters, digits and \"_\"; do not start with a digit or \"__\", and do not use a Python keyword",
            ));
        }
        let remove = self.flag(element, "remove", false, sight)?;
        let value = element.attribute("value");
        let default = element.attribute("default");
        if usize::from(value.is_some()) + usize::from(default.is_some()) + usize::from(remove) > 1 {
            return Err(Self::wrong(
                element,
                format!("property \"{name}\" has more than one of value, default and remove"),
            ));
        }
        let is_known = scope.find(&name).is_some();
        if remove {
            if is_known {
                scope.remove(&name);
                return Ok(());
            }
            if value.is_none() {
                return Ok(());
            }
        }
        let kind = element.attribute("scope").map(|attribute| &*attribute.value);
        if default.is_some() {
            if matches!(kind, Some("global" | "parent")) {
                self.note(
                    &element.spot(),
                    format!("the default of property \"{name}\" is set only in the local scope"),
                );
            }
            if is_known || is_global(&name) {
                return Ok(());
            }
        }
        let mut lazy = self.flag(element, "lazy_eval", true, sight)?;
        let target = match kind {
            Some("global") => scope.top(),
            Some("parent") => {
                let Some(caller) = scope.caller() else {
                    self.note(
                        &element.spot(),
                        format!("property \"{name}\" is not set: there is no scope around this one"),
                    );
                    return Ok(());
                };
                caller
            }
            // The Python tool takes any other word so.
            other => {
                if let Some(other) = other.filter(|other| !["", "local"].contains(other)) {
                    let message = format!(
                        "the scope \"{other}\" is not known, so \"local\" is used; known are \"parent\", \"global\" and \"local\""
                    );
                    self.note(&element.spot(), message);
                }
                Rc::clone(scope)
            }
        };
        lazy &= !matches!(kind, Some("global" | "parent"));
        if is_global(&name) {
            self.note(&element.spot(), format!("property \"{name}\" hides the built-in of that name"));
        }
        let Some(text) = value.or(default) else {
            target.set(format!("**{name}").into(), Entry::Ready(Value::Block(Rc::clone(element))));
            return Ok(());
        };
        self.note_content(element);
        let spot = element.spot_of(text);
        let entry = if lazy {
            match literal(Value::Text(Rc::clone(&text.value))) {
                Value::Text(words) => Entry::Lazy { text: words, spot },
                value => Entry::Ready(value),
            }
        } else {
            Entry::Ready(literal(self.value(&text.value, &spot, scope)?))
        };
        target.set(name, entry);
        Ok(())
    }

    fn flag(&mut self, element: &Element, name: &str, default: bool, sight: &Sight) -> Outcome<bool> {
        let Some(attribute) = element.attribute(name) else { return Ok(default) };
        let spot = element.spot_of(attribute);
        let value = self.value(&attribute.value, &spot, &sight.symbols)?;
        Self::truth(&value, &attribute.value, &spot)
    }
}
