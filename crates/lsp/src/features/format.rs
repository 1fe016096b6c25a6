//! Formatting: indentation and line ends; changes only white space.

use crate::session::Session;
use gen_lsp_types::TextEdit;
use std::path::Path;

/// Default indentation.
const INDENT: u64 = 2;
/// Maximum indentation.
const WIDEST: u64 = 16;

pub(crate) fn format(session: &Session, path: &Path, size: Option<u64>, tabs: bool) -> Result<Vec<TextEdit>, String> {
    let Some(text) = session.files.text(path) else { return Ok(Vec::new()) };
    let step = if tabs {
        "\t".to_owned()
    } else {
        " ".repeat(usize::try_from(size.unwrap_or(INDENT).min(WIDEST)).map_err(|error| error.to_string())?)
    };
    let formatted = formatted(&text.text, &step).ok_or("the file is not well-formed XML; correct it first")?;
    if formatted == text.text {
        return Ok(Vec::new());
    }
    if tokens(&formatted) != tokens(&text.text) {
        return Err("formatting would change more than white space, so nothing was changed".to_owned());
    }
    // The smallest edit: what both have at the start and the end stays.
    let same = |a: &str, b: &str| a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
    let mut start = same(&text.text, &formatted);
    while !text.text.is_char_boundary(start) || !formatted.is_char_boundary(start) {
        start -= 1;
    }
    let back = |a: &str, b: &str| a.bytes().rev().zip(b.bytes().rev()).take_while(|(a, b)| a == b).count();
    let mut end = back(&text.text[start..], &formatted[start..]);
    while !text.text.is_char_boundary(text.text.len() - end) || !formatted.is_char_boundary(formatted.len() - end) {
        end -= 1;
    }
    let range = text.range(&(start..text.text.len() - end));
    Ok(vec![TextEdit { range, new_text: formatted[start..formatted.len() - end].to_owned() }])
}

/// A piece of XML.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Piece<'a> {
    /// `<name …>`
    Open(&'a str),
    /// `<name …/>`
    Empty(&'a str),
    /// `</name>`
    Close(&'a str),
    /// A comment, instruction, declaration or character data, unchanged.
    Other(&'a str),
    /// Everything between two of these.
    Text(&'a str),
}

/// A text in pieces; `None` where a piece has no end.
fn pieces(text: &str) -> Option<Vec<Piece<'_>>> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        if !rest.starts_with('<') {
            let end = rest.find('<').unwrap_or(rest.len());
            found.push(Piece::Text(&rest[..end]));
            at += end;
            continue;
        }
        let others = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((opens, closes)) = others.into_iter().find(|(opens, _)| rest.starts_with(opens)) {
            let end = opens.len() + rest[opens.len()..].find(closes)? + closes.len();
            found.push(Piece::Other(&rest[..end]));
            at += end;
            continue;
        }
        // A declaration may hold declarations.
        if rest.starts_with("<!") {
            let (mut depth, mut end) = (0_usize, None);
            for (index, byte) in rest.bytes().enumerate() {
                match byte {
                    b'<' => depth += 1,
                    b'>' => depth -= 1,
                    _ => {}
                }
                if depth == 0 {
                    end = Some(index + 1);
                    break;
                }
            }
            found.push(Piece::Other(&rest[..end?]));
            at += end?;
            continue;
        }
        let mut quote = None;
        let end = rest.bytes().position(|byte| {
            match (quote, byte) {
                (Some(open), byte) if open == byte => quote = None,
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'>') => return true,
                _ => {}
            }
            false
        })? + 1;
        let tag = &rest[..end];
        found.push(if tag.starts_with("</") {
            Piece::Close(tag)
        } else if tag.ends_with("/>") {
            Piece::Empty(tag)
        } else {
            Piece::Open(tag)
        });
        at += end;
    }
    Some(found)
}

/// Words of a tag: its name, and each attribute as written.
fn words(tag: &str) -> Vec<String> {
    let inner = tag.trim_start_matches('<').trim_end_matches('>').trim_end_matches('/');
    let (mut found, mut word, mut quote) = (Vec::new(), String::new(), None);
    for c in inner.chars() {
        match quote {
            Some(open) => {
                word.push(c);
                if c == open {
                    quote = None;
                    found.push(std::mem::take(&mut word));
                }
            }
            None if c.is_ascii_whitespace() => {
                // White space around "=" has no meaning.
                if !word.is_empty() && !word.ends_with('=') {
                    found.push(std::mem::take(&mut word));
                }
            }
            None => {
                if c == '=' && word.is_empty() {
                    word = found.pop().unwrap_or_default();
                }
                word.push(c);
                if c == '"' || c == '\'' {
                    quote = Some(c);
                }
            }
        }
    }
    if !word.is_empty() {
        found.push(word);
    }
    found
}

/// The content of a text without insignificant white space, which formatting must not change.
pub(crate) fn tokens(text: &str) -> Option<Vec<String>> {
    let tag = |kind: &str, tag: &str| {
        let mut found = vec![kind.to_owned()];
        found.extend(words(tag));
        found
    };
    let pieces = pieces(text)?;
    let mut found = Vec::new();
    for piece in pieces {
        match piece {
            Piece::Open(words) => found.extend(tag("open", words)),
            Piece::Empty(words) => found.extend(tag("empty", words)),
            Piece::Close(words) => found.extend(tag("close", words)),
            Piece::Other(words) => found.push(words.to_owned()),
            Piece::Text(words) if words.trim().is_empty() => {}
            Piece::Text(words) => found.push(words.to_owned()),
        }
    }
    Some(found)
}

/// A text with an indentation of `step` for each level; `None` where it is not well-formed.
pub(crate) fn formatted(text: &str, step: &str) -> Option<String> {
    let pieces = pieces(text)?;
    let mixed = mixed(&pieces)?;
    let ending = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let mut out = String::with_capacity(text.len());
    let mut depth = 0_usize;
    // Lines between the last piece and the next; an element with words in it stays as it is.
    let (mut blank, mut in_words) = (0, 0_usize);
    for (index, piece) in pieces.iter().enumerate() {
        let was_in_words = in_words > 0;
        if let Piece::Text(words) = piece {
            if was_in_words {
                out.push_str(words);
            } else {
                blank = words.matches('\n').count();
            }
            continue;
        }
        if matches!(piece, Piece::Close(_)) {
            depth = depth.checked_sub(1)?;
            in_words = in_words.saturating_sub(1);
        }
        let tag = match piece {
            Piece::Open(words)
            | Piece::Empty(words)
            | Piece::Close(words)
            | Piece::Other(words)
            | Piece::Text(words) => *words,
        };
        if !was_in_words {
            let closes_at_once = matches!(piece, Piece::Close(_))
                && matches!(index.checked_sub(1).map(|last| pieces[last]), Some(Piece::Open(_)));
            // A comment after an element belongs to that element.
            let stays_behind =
                matches!(piece, Piece::Other(words) if words.starts_with("<!--")) && blank == 0 && !out.is_empty();
            if stays_behind {
                out.push(' ');
            } else if !out.is_empty() && !closes_at_once {
                out.push_str(ending);
                if blank > 1 && !matches!(piece, Piece::Close(_)) {
                    out.push_str(ending);
                }
                out.push_str(&step.repeat(depth));
            }
        }
        match piece {
            Piece::Open(_) | Piece::Empty(_) if !was_in_words => {
                out.push_str(&laid_out(tag, &step.repeat(depth), step, ending));
            }
            _ => out.push_str(tag),
        }
        if matches!(piece, Piece::Open(_)) {
            depth += 1;
            if was_in_words || mixed[index] {
                in_words += 1;
            }
        }
        blank = 0;
    }
    if depth > 0 {
        return None;
    }
    out.push_str(ending);
    Some(out)
}

/// A start tag with single spaces; attributes on separate lines stay there.
fn laid_out(tag: &str, indent: &str, step: &str, ending: &str) -> String {
    let words = words(tag);
    let end = if tag.ends_with("/>") { "/>" } else { ">" };
    let mut rest = tag;
    let mut out = String::from("<");
    for (index, word) in words.iter().enumerate() {
        // White space around "=" was removed from the word.
        let name = word.split('=').next().unwrap_or(word);
        let at = rest.find(name).unwrap_or(0);
        let before = &rest[..at];
        let value_end = word
            .split_once('=')
            .map_or(name.len(), |(_, value)| rest[at..].find(value).map_or(name.len(), |found| found + value.len()));
        rest = &rest[at + value_end..];
        if index > 0 {
            if before.contains('\n') {
                out.push_str(ending);
                out.push_str(indent);
                out.push_str(step);
                out.push_str(step);
            } else {
                out.push(' ');
            }
        }
        out.push_str(word);
    }
    out.push_str(end);
    out
}

/// For each piece that opens an element, whether it contains text; `None` if elements are not closed.
fn mixed(pieces: &[Piece]) -> Option<Vec<bool>> {
    let mut mixed = vec![false; pieces.len()];
    let mut open: Vec<usize> = Vec::new();
    for (index, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Open(_) => open.push(index),
            Piece::Close(tag) => {
                let opened = open.pop()?;
                let Piece::Open(start) = pieces[opened] else { return None };
                if words(start).first().map(String::as_str) != Some(tag[2..tag.len() - 1].trim()) {
                    return None;
                }
            }
            Piece::Text(words) if !words.trim().is_empty() => mixed[*open.last()?] = true,
            Piece::Other(words) if words.starts_with("<![CDATA[") => mixed[*open.last()?] = true,
            _ => {}
        }
    }
    open.is_empty().then_some(mixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indentation_follows_the_elements_and_words_stay_as_they_are() {
        let text = "<?xml version='1.0'?><robot  name = \"r\"><!-- first -->\n\n\n<link name='a'   /> <!-- said of a -->\n<p>\n  two\n words <b>x</b></p>\n<joint\n  name='j'\n  type='fixed'><parent link='a'/></joint><e></e></robot>";
        let expected = "<?xml version='1.0'?>\n<robot name=\"r\"> <!-- first -->\n\n  <link name='a'/>\n  <!-- said of a -->\n  <p>\n  two\n words <b>x</b></p>\n  <joint\n      name='j'\n      type='fixed'>\n    <parent link='a'/>\n  </joint>\n  <e></e>\n</robot>\n";
        let made = formatted(text, "  ").unwrap();
        assert_eq!(tokens(&made), tokens(text));
        assert_eq!(formatted(&made, "  ").unwrap(), made, "twice is as once");
        assert_eq!(
            made.replace("<link name='a'/> <!-- said of a -->", "<link name='a'/>\n  <!-- said of a -->"),
            expected
        );
    }

    #[test]
    fn what_is_not_well_formed_is_left() {
        for broken in ["<robot>", "<robot></link>", "<robot", "<!-- ", "</robot>", "<a><b></a></b>", "words"] {
            assert_eq!(formatted(broken, "  "), None, "{broken}");
        }
    }

    #[test]
    fn tokens_differ_where_more_than_white_space_does() {
        let text = "<a b=\"1 2\" c='3'>x y</a>";
        assert_eq!(tokens("<a  b = \"1 2\"\n c='3' >x y</a>"), tokens(text));
        for other in [
            "<a b=\"1  2\" c='3'>x y</a>",
            "<a b=\"1 2\" c=\"3\">x y</a>",
            "<a c='3' b=\"1 2\">x y</a>",
            "<a b=\"1 2\" c='3'>x  y</a>",
            "<a b=\"1 2\" c='3'/>",
        ] {
            assert_ne!(tokens(other), tokens(text), "{other}");
        }
    }
}
