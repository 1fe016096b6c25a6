//! The words inside `$(…)`.

/// A parsed substitution.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Substitution<'a> {
    Argument(&'a str),
    Find(&'a str),
    Environment(&'a str),
    OptionalEnvironment {
        name: &'a str,
        default: String,
    },
    Folder,
    WorkingFolder,
    Expression(&'a str),
    /// `command` and `anon`, which would run programs or ask a ROS master.
    Refused(&'a str),
    /// What is wrong with it.
    Wrong(String),
}

pub(crate) fn substitution(inner: &str) -> Substitution<'_> {
    if let Some(expression) = inner.strip_prefix("eval ") {
        return Substitution::Expression(expression);
    }
    let words: Vec<&str> = inner.split_ascii_whitespace().collect();
    match words[..] {
        ["arg", name] => Substitution::Argument(name),
        ["find", name] => Substitution::Find(name),
        ["env", name] => Substitution::Environment(name),
        ["optenv", name, ref default @ ..] => Substitution::OptionalEnvironment { name, default: default.join(" ") },
        ["dirname"] => Substitution::Folder,
        ["cwd"] => Substitution::WorkingFolder,
        [word @ ("command" | "anon"), ..] => Substitution::Refused(word),
        [word @ ("arg" | "find" | "env" | "optenv"), ref rest @ ..] => {
            Substitution::Wrong(format!("$({word} …) takes one name, not {}", rest.len()))
        }
        [word @ ("dirname" | "cwd"), ..] => Substitution::Wrong(format!("$({word}) takes no name")),
        [word, ..] => Substitution::Wrong(format!("$({word} …) is not known")),
        [] => Substitution::Wrong("$() is empty".to_owned()),
    }
}
