//! Text that fits the terminal: sentences and rows of tables that are too long continue in further lines.

/// Narrower than this nothing is wrapped: words would stand one below the other.
const NARROWEST: usize = 20;

/// Text with its lines no longer than `width` characters where they have blanks; further lines are indented by two more than
/// theirs. A line with columns, which have two blanks or more between them, is folded between columns: rows that are aligned stay
/// aligned.
pub(super) fn wrapped(text: &str, width: usize) -> String {
    if width < NARROWEST {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let (words, end) = line.strip_suffix('\n').map_or((line, ""), |line| (line, "\n"));
        if shown(words) <= width {
            out.push_str(line);
            continue;
        }
        if words.trim_start().contains("  ") {
            out.push_str(&folded(words, width));
            out.push_str(end);
            continue;
        }
        let indent = words.len() - words.trim_start().len();
        let mut column = indent;
        out.push_str(&words[..indent]);
        for (index, word) in words.split_whitespace().enumerate() {
            let length = shown(word);
            if index > 0 && column + 1 + length > width {
                out.push('\n');
                out.push_str(&" ".repeat(indent + 2));
                column = indent + 2;
            } else if index > 0 {
                out.push(' ');
                column += 1;
            }
            out.push_str(word);
            column += length;
        }
        out.push_str(end);
    }
    out
}

/// How many characters a terminal shows of a text with colours (ECMA-48, select graphic rendition).
fn shown(text: &str) -> usize {
    let hidden: usize = text.split("\x1b[").skip(1).map(|rest| 2 + rest.find('m').map_or(0, |end| end + 1)).sum();
    text.chars().count() - hidden
}

/// A row of a table in several lines, each broken after a column.
fn folded(row: &str, width: usize) -> String {
    let letters: Vec<char> = row.chars().collect();
    let blank = |at: usize| letters.get(at).is_none_or(|c| *c == ' ');
    let ends: Vec<usize> = (1..=letters.len()).filter(|&at| !blank(at - 1) && blank(at) && blank(at + 1)).collect();
    let (mut out, mut start, mut indent) = (String::new(), 0, 0);
    while start < letters.len() {
        let room = start + width.saturating_sub(indent);
        let rest = ends.iter().copied().filter(|end| *end > start);
        let end = rest.clone().take_while(|end| *end <= room).last().or_else(|| rest.clone().next());
        let end = end.unwrap_or(letters.len());
        if start > 0 {
            out.push('\n');
            out.push_str(&" ".repeat(indent));
        }
        out.extend(&letters[start..end]);
        (start, indent) = (end, 2);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::wrapped;

    #[test]
    fn long_sentences_are_wrapped_and_tables_are_folded_between_columns() {
        let text = "  a sentence that is longer than thirty\nshort\njoint_1  0.1 ± 0.2  0.3 ± 0.4  0.5 ± 0.6\n";
        let expected =
            "  a sentence that is longer\n    than thirty\nshort\njoint_1  0.1 ± 0.2  0.3 ± 0.4\n    0.5 ± 0.6\n";
        assert_eq!(wrapped(text, 30), expected);
        assert_eq!(wrapped(text, 80), text);
        assert_eq!(wrapped(text, 10), text);
    }

    #[test]
    fn rows_that_are_aligned_are_folded_at_the_same_columns() {
        let text = "errors in mm   train rms    mean  test rms\nnominal           3.8908  3.6523    4.6298\n";
        assert_eq!(
            wrapped(text, 34),
            "errors in mm   train rms    mean\n    test rms\nnominal           3.8908  3.6523\n      4.6298\n"
        );
    }

    #[test]
    fn colours_take_no_room() {
        let text = "before.urdf → after.urdf: \x1b[31mdifferent\x1b[0m\n";
        assert_eq!(wrapped(text, 35), text);
        assert_eq!(wrapped(text, 34), "before.urdf → after.urdf:\n  \x1b[31mdifferent\x1b[0m\n");
    }

    #[test]
    fn a_word_longer_than_the_line_stands_alone() {
        assert_eq!(
            wrapped("see https://example.org/a/long/address now", 20),
            "see\n  https://example.org/a/long/address\n  now"
        );
    }
}
