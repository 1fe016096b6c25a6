//! Sentences that fit the terminal: lines that are too long continue in further ones, tables stay as they are.

/// Narrower than this nothing is wrapped: words would stand one below the other.
const NARROWEST: usize = 20;

/// Text with its lines no longer than `width` characters where they have blanks; further lines are indented by two more than
/// theirs. A line with columns, which have two blanks or more between them, stays as it is.
pub(super) fn wrapped(text: &str, width: usize) -> String {
    if width < NARROWEST {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let (words, end) = line.strip_suffix('\n').map_or((line, ""), |line| (line, "\n"));
        if words.chars().count() <= width || words.trim_start().contains("  ") {
            out.push_str(line);
            continue;
        }
        let indent = words.len() - words.trim_start().len();
        let mut column = indent;
        out.push_str(&words[..indent]);
        for (index, word) in words.split_whitespace().enumerate() {
            let length = word.chars().count();
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

#[cfg(test)]
mod tests {
    use super::wrapped;

    #[test]
    fn long_sentences_are_wrapped_and_tables_are_not() {
        let text = "  a sentence that is longer than thirty\nshort\njoint_1  0.1 ± 0.2  0.3 ± 0.4  0.5 ± 0.6\n";
        let expected =
            "  a sentence that is longer\n    than thirty\nshort\njoint_1  0.1 ± 0.2  0.3 ± 0.4  0.5 ± 0.6\n";
        assert_eq!(wrapped(text, 30), expected);
        assert_eq!(wrapped(text, 80), text);
        assert_eq!(wrapped(text, 10), text);
    }

    #[test]
    fn a_word_longer_than_the_line_stands_alone() {
        assert_eq!(
            wrapped("see https://example.org/a/long/address now", 20),
            "see\n  https://example.org/a/long/address\n  now"
        );
    }
}
