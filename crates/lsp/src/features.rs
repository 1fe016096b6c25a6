//! The requests of an editor, one file each.

pub(crate) mod actions;
pub(crate) mod commands;
pub(crate) mod complete;
pub(crate) mod definition;
pub(crate) mod folding;
pub(crate) mod format;
pub(crate) mod hover;
pub(crate) mod lens;
pub(crate) mod passed;
pub(crate) mod rename;
pub(crate) mod symbols;
