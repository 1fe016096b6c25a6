//! `tests/failed-tests`: the part of a failed run's log that `tests/run` prints.

use crate::support::top;
use std::process::Command;

/// A log of two binaries of cargo: a test that prints the word `failures:` and passes, one that fails after much output, one that is killed.
const CARGO: &str = "     Running unittests src/lib.rs (target/debug/deps/arm-0123456789abcdef)

running 2 tests
test good ... ok
test bad ... FAILED

successes:

---- good stdout ----
thread 'x' panicked at this is only printed
failures:

failures:

---- bad stdout ----
NOISE
thread 'bad' (10824) panicked at src/lib.rs:6:58:
assertion `left == right` failed: two is
  left: 2
 right: 3
note: run with `RUST_BACKTRACE=1` environment variable to display a backtrace


failures:
    bad

test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.69s

     Running tests/kill.rs (target/debug/deps/kill-0123456789abcdef)
  process didn't exit successfully: `kill` (signal: 6, SIGABRT: process abort signal)
";

const PYTEST: &str = "F
=================================== FAILURES ===================================
____________________________________ test_a ____________________________________
>       assert f() == 1
E       assert 2 == 1

test_x.py:7: AssertionError
----------------------------- Captured stdout call -----------------------------
E  only printed
=========================== short test summary info ============================
FAILED test_x.py::test_a - assert 2 == 1
";

fn failed(log: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.log");
    std::fs::write(&path, log).unwrap();
    let output = Command::new(top().join("tests/failed-tests")).arg(&path).output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_failed_run_names_its_tests_and_their_messages() {
    let noise = "noise\n".repeat(80);
    assert_eq!(
        failed(&CARGO.replace("NOISE\n", &noise)),
        format!(
            "FAILED arm: bad\n{}    thread 'bad' (10824) panicked at src/lib.rs:6:58:\n    assertion `left == right` failed: two is\n      \
             left: 2\n     right: 3\n    (shortened)\nFAILED kill: process didn't exit successfully: `kill` (signal: 6, SIGABRT: process \
             abort signal)\n",
            "    noise\n".repeat(12)
        )
    );
    assert_eq!(failed(PYTEST), "FAILED test_a\n    E       assert 2 == 1\n    test_x.py:7: AssertionError\n");
    assert_eq!(failed("test a ... ok\n"), "");
}
