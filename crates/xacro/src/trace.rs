//! Where everything in an expanded document comes from: for editors, which show the source.

use crate::error::Frame;
use crate::place::{SourceFile, Spot};
use crate::tree::Call;
use std::collections::HashMap;
use std::ops::Range;
use std::path::PathBuf;
use std::rc::Rc;

/// Bytes of one of [`Trace::files`].
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Span {
    /// Index of the file.
    pub file: usize,
    /// Byte offsets into its text, which begins after a byte order mark.
    pub range: Range<usize>,
}

/// Where an element of the result comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Origin {
    /// Byte offset of its `<` in the result.
    pub at: usize,
    /// Its name in the start tag of the source.
    pub name: Span,
    /// Its attributes, in order.
    pub attributes: Vec<AttributeOrigin>,
    /// The innermost of the macro calls that it was produced in, an index into [`Trace::calls`].
    pub call: Option<usize>,
}

/// Where the value of an attribute comes from, in the file of its element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AttributeOrigin {
    /// The value in the result, quotes not included.
    pub at: Range<usize>,
    /// The value as the source writes it.
    pub source: Range<usize>,
}

/// The value of an expression or substitution of the source.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Evaluated {
    /// The inside of `${…}` or `$(…)`.
    pub span: Span,
    /// Its value, as text.
    pub value: String,
}

/// Where everything in an expanded document comes from.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Trace {
    /// The files that spans are in.
    pub files: Vec<PathBuf>,
    /// The elements of the result, in its order.
    pub elements: Vec<Origin>,
    /// The macro calls, each with the index of the one around it.
    pub calls: Vec<(Frame, Option<usize>)>,
    /// The expressions, each as often as it was evaluated.
    pub values: Vec<Evaluated>,
}

impl Trace {
    /// The macro calls that an element was produced in, the innermost first.
    pub fn calls_of(&self, origin: &Origin) -> Vec<&Frame> {
        let mut frames = Vec::new();
        let mut next = origin.call;
        while let Some((frame, around)) = next.and_then(|index| self.calls.get(index)) {
            frames.push(frame);
            next = *around;
        }
        frames
    }

    pub(crate) fn of(elements: Vec<ElementOrigin>, values: Vec<EvaluatedAt>) -> Self {
        let mut found = Collector::default();
        let elements = elements
            .into_iter()
            .map(|element| Origin {
                at: element.at,
                name: found.span(&element.spot),
                attributes: element.attributes,
                call: element.calls.as_ref().map(|call| found.call(call)),
            })
            .collect();
        let values = values
            .into_iter()
            .map(|value| Evaluated { span: found.span(&value.spot), value: value.value.to_string() })
            .collect();
        Self { elements, values, ..found.trace }
    }
}

/// An element as it was written, before its places are computed.
pub(crate) struct ElementOrigin {
    pub at: usize,
    pub spot: Spot,
    pub attributes: Vec<AttributeOrigin>,
    pub calls: Option<Rc<Call>>,
}

/// A value as it was evaluated.
pub(crate) struct EvaluatedAt {
    pub spot: Spot,
    pub value: Rc<str>,
}

#[derive(Default)]
struct Collector {
    trace: Trace,
    files: HashMap<*const SourceFile, usize>,
    calls: HashMap<*const Call, usize>,
}

impl Collector {
    fn span(&mut self, spot: &Spot) -> Span {
        let files = &mut self.trace.files;
        let file = *self.files.entry(Rc::as_ptr(&spot.file)).or_insert_with(|| {
            files.push(spot.file.path.clone());
            files.len() - 1
        });
        Span { file, range: spot.range.clone() }
    }

    fn call(&mut self, call: &Rc<Call>) -> usize {
        if let Some(known) = self.calls.get(&Rc::as_ptr(call)) {
            return *known;
        }
        let around = call.around.as_ref().map(|around| self.call(around));
        let frame =
            Frame::Macro { name: call.name.to_string(), defined: call.defined.place(), called: call.called.place() };
        self.trace.calls.push((frame, around));
        let index = self.trace.calls.len() - 1;
        self.calls.insert(Rc::as_ptr(call), index);
        index
    }
}
