//! What can be folded: elements and comments over several lines.

use crate::session::Session;
use gen_lsp_types::{FoldingRange, FoldingRangeKind};
use std::path::Path;

pub(crate) fn folding(session: &Session, path: &Path) -> Vec<FoldingRange> {
    let (Some(text), Some(markup)) = (session.files.text(path), session.files.markup(path)) else { return Vec::new() };
    let fold = |start: usize, end: usize, kind: Option<FoldingRangeKind>| {
        let (start_line, end_line) = (text.position(start).line, text.position(end).line);
        (end_line > start_line).then(|| FoldingRange { start_line, end_line, kind, ..FoldingRange::default() })
    };
    let elements = markup.tags.iter().filter_map(|tag| {
        // The end tag stays in sight.
        let end = tag.close.as_ref().map_or(tag.start.end, |close| close.start);
        let closes_on_own_line =
            tag.close.as_ref().is_some_and(|close| text.words_of_line(text.line_of(close.start)).start == close.start);
        let mut folded = fold(tag.start.start, end, None)?;
        if closes_on_own_line {
            folded.end_line -= 1;
        }
        (folded.end_line > folded.start_line).then_some(folded)
    });
    let comments = markup.others.iter().filter_map(|other| {
        let is_comment = text.text[other.clone()].starts_with("<!--");
        fold(other.start, other.end, is_comment.then_some(FoldingRangeKind::Comment))
    });
    let mut found: Vec<FoldingRange> = elements.chain(comments).collect();
    found.sort_by_key(|range| (range.start_line, range.end_line));
    found
}
