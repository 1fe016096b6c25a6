//! Notes of one command, printed at its end: each once, those of one kind together, few lines.

/// Largest number of lines of notes, unless all are requested.
pub(super) const MOST: usize = 10;

/// A note without what differs among notes of one kind: its numbers and what is quoted.
fn kind(note: &str) -> String {
    let mut kind = String::with_capacity(note.len());
    let (mut quoted, mut in_number) = (false, false);
    for c in note.chars() {
        let number = c.is_ascii_digit() || (in_number && c == '.');
        match c {
            '"' => {
                quoted = !quoted;
                kind.push(c);
            }
            _ if quoted => {}
            _ if number && in_number => {}
            _ if number => kind.push('#'),
            _ => kind.push(c),
        }
        in_number = number;
    }
    kind
}

/// Each note once, in the order of their first appearance.
pub(super) fn once(notes: Vec<String>) -> Vec<String> {
    let mut seen = Vec::with_capacity(notes.len());
    for note in notes {
        if !seen.contains(&note) {
            seen.push(note);
        }
    }
    seen
}

/// Notes of one kind as the first of them, at most [`MOST`] lines; `verbose` is the option that shows all.
pub(super) fn grouped(notes: Vec<String>, verbose: &str) -> Vec<String> {
    let mut groups: Vec<(String, String, usize)> = Vec::new();
    for note in once(notes) {
        let kind = kind(&note);
        match groups.iter_mut().find(|(known, ..)| *known == kind) {
            Some((.., others)) => *others += 1,
            None => groups.push((kind, note, 0)),
        }
    }
    let shown = if groups.len() > MOST { MOST - 1 } else { groups.len() };
    let hidden: usize = groups[shown..].iter().map(|(.., others)| others + 1).sum();
    let line = |(_, note, others): &(String, String, usize)| match others {
        0 => note.clone(),
        others => format!("{note} (and {others} more of this kind; {verbose} shows them)"),
    };
    let mut lines: Vec<String> = groups[..shown].iter().map(line).collect();
    if hidden > 0 {
        lines.push(format!("{hidden} more notes; {verbose} shows them"));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{MOST, grouped, once};

    fn texts(notes: &[&str]) -> Vec<String> {
        notes.iter().map(|note| (*note).to_owned()).collect()
    }

    #[test]
    fn notes_of_one_kind_are_one_line() {
        let notes = texts(&[
            "arm.urdf:12: joint \"a\": 1.5708 is read as 90°",
            "run.csv: columns separated by semicolons",
            "arm.urdf:27: joint \"b\": 3.14 is read as 180°",
            "run.csv: columns separated by semicolons",
        ]);
        assert_eq!(
            grouped(notes.clone(), "--verbose"),
            [
                "arm.urdf:12: joint \"a\": 1.5708 is read as 90° (and 1 more of this kind; --verbose shows them)",
                "run.csv: columns separated by semicolons",
            ]
        );
        assert_eq!(once(notes).len(), 3);
    }

    #[test]
    fn there_are_at_most_ten_lines_and_the_last_counts_the_others() {
        let kinds: Vec<String> = ('a'..='n').map(|letter| format!("{letter} is so")).collect();
        assert_eq!(grouped(kinds[..MOST].to_vec(), "--verbose"), kinds[..MOST]);
        let lines = grouped(kinds, "--verbose");
        assert_eq!(lines.len(), MOST);
        assert_eq!(lines[MOST - 1], "5 more notes; --verbose shows them");
    }
}
