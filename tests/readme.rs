//! What the README shows is what the commands print.

use crate::support::{denavit, top};

#[test]
fn every_example_prints_what_the_readme_shows() {
    let text = std::fs::read_to_string(top().join("README.md")).unwrap();
    let mut examples = 0;
    for block in text.split("```console\n").skip(1) {
        let block = block.split("```").next().unwrap();
        let (command, shown) = block.split_once('\n').unwrap();
        let arguments: Vec<&str> = command.strip_prefix("$ denavit ").unwrap().split_whitespace().collect();
        let run = denavit(&arguments);
        assert!(run.code < 2, "{}", run.stderr);
        assert_eq!(run.stdout.trim_end(), shown.trim_end(), "{command}");
        examples += 1;
    }
    assert!(examples >= 3);
}
