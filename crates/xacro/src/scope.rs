//! Tables of properties and macros, each with the table around it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use crate::expression::Value;
use crate::place::Spot;
use crate::tree::Element;

/// Properties, parameters and blocks (`*name`, `**name`) that are defined at one level.
#[derive(Debug)]
pub(crate) struct Scope {
    parent: Option<Rc<Scope>>,
    is_namespace: bool,
    entries: RefCell<HashMap<Rc<str>, Entry>>,
}

#[derive(Debug, Clone)]
pub(crate) enum Entry {
    Ready(Value),
    /// The text of a property that was not used yet.
    Lazy {
        text: Rc<str>,
        spot: Spot,
    },
    /// A property whose text is being evaluated at this moment.
    Evaluating,
}

impl Scope {
    pub fn root() -> Rc<Self> {
        Rc::new(Self { parent: None, is_namespace: false, entries: RefCell::default() })
    }

    pub fn inside(parent: &Rc<Self>) -> Rc<Self> {
        let parent = Some(Rc::clone(parent));
        Rc::new(Self { parent, is_namespace: false, entries: RefCell::default() })
    }

    /// The scope of a file that is included with `ns`.
    pub fn namespace(parent: &Rc<Self>) -> Rc<Self> {
        let parent = Some(Rc::clone(parent));
        Rc::new(Self { parent, is_namespace: true, entries: RefCell::default() })
    }

    pub fn set(&self, name: Rc<str>, entry: Entry) {
        self.entries.borrow_mut().insert(name, entry);
    }

    /// The innermost definition of a name, and the scope that it is in.
    pub fn find(self: &Rc<Self>, name: &str) -> Option<(Rc<Self>, Entry)> {
        let mut scope = self;
        loop {
            if let Some(entry) = scope.entries.borrow().get(name) {
                return Some((Rc::clone(scope), entry.clone()));
            }
            scope = scope.parent.as_ref()?;
        }
    }

    /// Forgets a name here and in all scopes around.
    pub fn remove(&self, name: &str) {
        let mut scope = Some(self);
        while let Some(here) = scope {
            here.entries.borrow_mut().remove(name);
            scope = here.parent.as_deref();
        }
    }

    /// The outermost scope.
    pub fn top(self: &Rc<Self>) -> Rc<Self> {
        let mut scope = self;
        while let Some(parent) = &scope.parent {
            scope = parent;
        }
        Rc::clone(scope)
    }

    /// The scope that `scope="parent"` means: the caller's, past the namespaces between a macro and its caller.
    pub fn caller(&self) -> Option<Rc<Self>> {
        let mut target = self.parent.as_ref()?;
        if !self.is_namespace {
            while target.is_namespace {
                target = target.parent.as_ref()?;
            }
        }
        Some(Rc::clone(target))
    }

    /// All visible names, sorted.
    pub fn names(&self) -> Vec<Rc<str>> {
        let mut names = Vec::new();
        let mut scope = Some(self);
        while let Some(here) = scope {
            names.extend(here.entries.borrow().keys().cloned());
            scope = here.parent.as_deref();
        }
        names.sort();
        names.dedup();
        names
    }
}

/// A macro as it is defined.
#[derive(Debug)]
pub(crate) struct Macro {
    pub body: Rc<Element>,
    pub parameters: Vec<Parameter>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Parameter {
    /// With the stars of a block parameter.
    pub name: Rc<str>,
    /// `^`: take the value from the scope around the call.
    pub forwarded: bool,
    pub default: Option<Rc<str>>,
}

/// Macros that are defined at one level.
#[derive(Debug, Default)]
pub(crate) struct Macros {
    parent: Option<Rc<Macros>>,
    entries: RefCell<HashMap<Rc<str>, MacroEntry>>,
}

#[derive(Debug, Clone)]
enum MacroEntry {
    Macro(Rc<Macro>),
    Namespace(Rc<Macros>),
}

impl Macros {
    pub fn inside(parent: &Rc<Self>) -> Rc<Self> {
        Rc::new(Self { parent: Some(Rc::clone(parent)), entries: RefCell::default() })
    }

    pub fn define(&self, name: Rc<str>, definition: Macro) {
        self.entries.borrow_mut().insert(name, MacroEntry::Macro(Rc::new(definition)));
    }

    pub fn define_namespace(&self, name: Rc<str>, macros: Rc<Self>) {
        self.entries.borrow_mut().insert(name, MacroEntry::Namespace(macros));
    }

    pub fn find_macro(self: &Rc<Self>, name: &str) -> Option<Rc<Macro>> {
        match self.find(name)? {
            MacroEntry::Macro(found) => Some(found),
            MacroEntry::Namespace(_) => None,
        }
    }

    pub fn find_namespace(self: &Rc<Self>, name: &str) -> Option<Rc<Self>> {
        match self.find(name)? {
            MacroEntry::Namespace(found) => Some(found),
            MacroEntry::Macro(_) => None,
        }
    }

    fn find(&self, name: &str) -> Option<MacroEntry> {
        let mut macros = self;
        loop {
            if let Some(entry) = macros.entries.borrow().get(name) {
                return Some(entry.clone());
            }
            macros = macros.parent.as_deref()?;
        }
    }

    /// All visible names, sorted; those in namespaces with their prefix.
    pub fn names(&self) -> Vec<String> {
        let mut names = Vec::new();
        let mut macros = Some(self);
        while let Some(here) = macros {
            for (name, entry) in here.entries.borrow().iter().collect::<std::collections::BTreeMap<_, _>>() {
                match entry {
                    MacroEntry::Macro(_) => names.push(name.to_string()),
                    MacroEntry::Namespace(inner) => {
                        names.extend(inner.names().iter().map(|inner| format!("{name}.{inner}")));
                    }
                }
            }
            macros = here.parent.as_deref();
        }
        names.sort();
        names.dedup();
        names
    }
}
