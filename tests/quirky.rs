//! Malformed and odd files found in the wild: each gives a table or an error that names the cause.

use crate::support::{denavit, files, vendor};

#[test]
fn each_odd_file_ends_in_a_table_or_a_reason() {
    let Some(vendor) = vendor() else { return };
    let found = files(&vendor.join("quirky"), "urdf");
    assert!(found.len() >= 27, "{}", found.len());
    for path in found {
        let run = denavit(&["table", path.to_str().unwrap()]);
        let name = path.file_name().unwrap().to_str().unwrap();
        match run.code {
            0 => assert!(run.stdout.contains("tool"), "{name}: {}", run.stdout),
            2 => assert!(
                run.stdout.is_empty() && run.stderr.starts_with("error: ") && run.stderr.contains(name),
                "{name}: {}",
                run.stderr
            ),
            code => panic!("{name}: exit code {code}: {}", run.stderr),
        }
        println!("{name}: {}", if run.code == 0 { "table" } else { run.stderr.lines().next().unwrap() });
    }
}
