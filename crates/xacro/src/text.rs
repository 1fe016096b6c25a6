//! Attribute values and texts in parts: words, `${…}`, `$(…)` and escapes.

use std::ops::Range;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Segment {
    /// Taken as it stands.
    Plain(Range<usize>),
    /// The inside of `${…}`.
    Expression(Range<usize>),
    /// The inside of `$(…)`.
    Substitution(Range<usize>),
}

/// Splits a text into parts. The error is the invalid range.
///
/// `$${` and `$$(` mean `${` and `$(`; a dollar before anything else is a dollar. An expression ends at the first
/// `}`, a substitution at the first `)`.
pub(crate) fn segments(text: &str) -> Result<Vec<Segment>, Range<usize>> {
    let mut segments = Vec::new();
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        let dollars = rest.bytes().take_while(|&b| b == b'$').count();
        let opener = rest.as_bytes().get(dollars).copied();
        let opens = matches!(opener, Some(b'{' | b'('));
        let segment;
        (segment, at) = match (dollars, opener) {
            (0, _) => {
                let end = at + rest.find('$').unwrap_or(rest.len());
                (Segment::Plain(at..end), end)
            }
            (1, Some(opener)) if opens => {
                let close = if opener == b'{' { '}' } else { ')' };
                let length = rest.find(close).ok_or(at..text.len())?;
                let (inner, end) = (at + 2..at + length, at + length + 1);
                if opener == b'{' { (Segment::Expression(inner), end) } else { (Segment::Substitution(inner), end) }
            }
            (_, Some(_)) if opens => {
                let end = at + dollars + 1;
                (Segment::Plain(at + 1..end), end)
            }
            (1, Some(_)) => {
                let end = at + 1 + rest[1..].find(['$', '{', '(']).unwrap_or(rest.len() - 1);
                (Segment::Plain(at..end), end)
            }
            (1, None) => (Segment::Plain(at..at + 1), at + 1),
            _ => return Err(at..at + dollars),
        };
        segments.push(segment);
    }
    Ok(segments)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &str) {
        let shown = match segments(text) {
            Err(range) => format!("error at {}", &text[range]),
            Ok(segments) => segments
                .into_iter()
                .map(|segment| match segment {
                    Segment::Plain(range) => text[range].to_owned(),
                    Segment::Expression(range) => format!("E<{}>", &text[range]),
                    Segment::Substitution(range) => format!("S<{}>", &text[range]),
                })
                .collect::<Vec<_>>()
                .join("|"),
        };
        assert_eq!(shown, expected, "{text}");
    }

    #[test]
    fn dollars_begin_expressions_and_substitutions_only_before_brackets() {
        check("", "");
        check("1 2 3", "1 2 3");
        check("${a} ${b}", "E<a>| |E<b>");
        check("$(find x)/y", "S<find x>|/y");
        check("$${a}", "${|a}");
        check("$$$(a)", "$$(|a)");
        check("5$ and $5", "5|$ and |$5");
        check("5$", "5|$");
        check("${'$(arg x)'}", "E<'$(arg x)'>");
        check("a ${b", "error at ${b");
        check("$$x", "error at $$");
    }
}
