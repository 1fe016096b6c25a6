//! The code of every language that is installed is compiled and run; its stored postures are those of the chain, which the
//! program that made the code never saw.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a panic is a failure, and what is printed is read")]

mod examples_with_effects;

use denavit_code::{Language, Options, Precision, code, code_with_effects};
use denavit_dh::convert::{self, table};
use denavit_dh::{Convention, NearParallel, Table};
use denavit_model::{Chain, Reading, examples, urdf};
use std::path::{Path, PathBuf};
use std::process::Command;

fn of(chain: &Chain, near_parallel: NearParallel) -> Table {
    table(chain, &convert::Options { near_parallel, ..convert::Options::default() }).unwrap().value
}

/// A turn and a slide along one axis: only the pose reads the turn's sine.
fn turn_and_slide() -> Chain {
    let joint = |name: &str, kind: &str, parent: &str, child: &str| {
        format!(
            r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.2"/>
            <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>"#
        )
    };
    let joints = [joint("turn", "revolute", "base", "column"), joint("slide", "prismatic", "column", "tip")].concat();
    let links = ["base", "column", "tip"].map(|link| format!(r#"<link name="{link}"/>"#)).concat();
    let robot = urdf::read("r.urdf", &format!(r#"<robot name="turn_and_slide">{links}{joints}</robot>"#)).unwrap();
    robot.chain(None, None, Reading::Intended).unwrap().value
}

/// Tables of every kind of joint, with couplings, with rows of five numbers, and of the project's robots.
fn tables() -> Vec<Table> {
    let mut tables: Vec<Table> = [examples::puma_like(), examples::scara_helical(), examples::planar_arm()]
        .iter()
        .map(|chain| of(chain, NearParallel::Dh))
        .collect();
    tables.push(of(&examples::puma_like(), NearParallel::HayatiBelow(0.1)));
    assert!(tables[3].convention_rows(Convention::Distal).len() > 6);
    tables.push(of(&turn_and_slide(), NearParallel::Dh));
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots")];
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "urdf") {
                let robot = urdf::read("r.urdf", &std::fs::read_to_string(&path).unwrap()).unwrap();
                let chain = robot.chain(None, None, Reading::Intended).unwrap().value;
                tables.push(of(&chain, NearParallel::Dh));
            }
        }
    }
    assert!(tables.len() > 15);
    tables
}

/// The code of every table, and of arms with effects, with what each is called.
fn texts(options: Options) -> Vec<(String, String)> {
    let mut texts: Vec<(String, String)> =
        tables().iter().map(|table| (table.name.clone(), code(table, options).unwrap())).collect();
    // Four-byte numbers change no formula: every other arm will do.
    let step = if options.precision == Precision::Single { 2 } else { 1 };
    for (index, effects) in examples_with_effects::all().iter().enumerate().step_by(step) {
        let table = of(&effects.chain, NearParallel::Dh);
        texts.push((format!("effects {index}"), code_with_effects(&table, effects, options).unwrap()));
    }
    texts
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let file = folder.join(name);
    std::fs::write(&file, text).unwrap();
    file
}

fn is_installed(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        println!("skipped, because {program} is not installed");
    }
    found
}

/// Compiles with `compiler`, which is told the file and where the program goes, and runs the program.
fn compiled_and_run(
    language: Language,
    precision: Precision,
    program: &str,
    compile: impl Fn(&mut Command, &Path, &Path, &str),
) {
    if !is_installed(program) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (index, (name, text)) in texts(Options { language, precision }).iter().enumerate() {
        let file = written(folder.path(), &format!("arm{index}.{}", language.extension()), text);
        let made = folder.path().join(format!("arm{index}"));
        let main = text.lines().find_map(|line| line.split_once("-D")?.1.split_whitespace().next()).unwrap_or_default();
        let mut command = Command::new(program);
        compile(&mut command, &file, &made, main);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(output.stderr.is_empty(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        if language != Language::Python {
            let run = Command::new(&made).output().unwrap();
            assert!(run.status.success(), "{name} {precision:?}: {}", String::from_utf8_lossy(&run.stdout));
        }
    }
}

#[test]
fn c_compiles_without_a_warning_and_passes_its_test() {
    for precision in [Precision::Double, Precision::Single] {
        compiled_and_run(Language::C, precision, "gcc", |command, file, made, main| {
            let flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-x", "c"];
            command.args(flags).arg(format!("-D{main}")).arg(file).arg("-o").arg(made).arg("-lm");
        });
    }
}

#[test]
fn cpp_compiles_without_a_warning_and_passes_its_test() {
    for precision in [Precision::Double, Precision::Single] {
        compiled_and_run(Language::Cpp, precision, "g++", |command, file, made, main| {
            let flags = [
                "-std=c++17",
                "-Wall",
                "-Wextra",
                "-Wpedantic",
                "-Wconversion",
                "-Wno-pragma-once-outside-header",
                "-x",
                "c++",
            ];
            command.args(flags).arg(format!("-D{main}")).arg(file).arg("-o").arg(made);
        });
    }
}

#[test]
fn rust_compiles_without_a_warning_and_passes_its_test() {
    for precision in [Precision::Double, Precision::Single] {
        compiled_and_run(Language::Rust, precision, "rustc", |command, file, made, _| {
            command.args(["--edition", "2021", "--test", "-o"]).arg(made).arg(file);
        });
    }
}

#[test]
fn python_passes_its_test() {
    compiled_and_run(Language::Python, Precision::Double, "python3", |command, file, _, _| {
        command.arg(file);
    });
}

#[test]
fn matlab_passes_its_test_where_octave_is() {
    if !is_installed("octave") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (_, text) in texts(Options { language: Language::Matlab, precision: Precision::Double }) {
        let name = text.split_once("] = ").unwrap().1.split_once('(').unwrap().0.to_owned();
        written(folder.path(), &format!("{name}.m"), &text);
        let script = format!("exit({name}())");
        let run =
            Command::new("octave").args(["--quiet", "--eval", &script]).current_dir(folder.path()).output().unwrap();
        assert!(run.status.success(), "{name}: {}", String::from_utf8_lossy(&run.stderr));
    }
}

/// Numbers of postures about whole blocks, values of every size, those that the sines do not take and none: the poses of a batch are
/// those of `fk`, and nothing behind them is touched.
const MANY_IN_C: &str = r#"
#include <stdio.h>
int main(void)
{
    static const double odd[] = { 1e5, -1e5, 1.0000001e5, -3e8, 1e300, NAN, -INFINITY, 0.0 };
    static double q[40 * N];
    static double poses[41 * 12];
    unsigned long long state = 1;
    int wrong = 0;
    for (int n = 0; n < 40; ++n) {
        for (int k = 0; k < n * N; ++k) {
            state = state * 6364136223846793005ULL + 1442695040888963407ULL;
            const double part = (double)(state >> 11) / 4503599627370496.0 - 1.0;
            const int kind = (int)((state >> 7) % 100);
            q[k] = kind < 60 ? 3.2 * part : kind < 90 ? 100.0 * part : 1e5 * part;
            if (n > 30 && kind == 99) {
                q[k] = odd[(state >> 3) % 8];
            }
        }
        poses[12 * n] = 7.0;
        BATCH(q, n, poses);
        wrong += poses[12 * n] == 7.0 ? 0 : 1;
        for (int k = 0; k < n; ++k) {
            double own[3][4];
            double largest = 1.0;
            FK(&q[N * k], own);
            for (int i = 0; i < 12; ++i) {
                largest = fmax(largest, fabs(own[i / 4][i % 4]));
            }
            for (int i = 0; i < 12; ++i) {
                const double a = own[i / 4][i % 4];
                const double b = poses[12 * k + i];
                wrong += fabs(a - b) <= 1e-13 * largest || (a != a && b != b) || a == b ? 0 : 1;
            }
        }
    }
    printf("%d wrong\n", wrong);
    return wrong == 0 ? 0 : 1;
}
"#;

const MANY_IN_RUST: &str = r#"
mod arm;
const N: usize = arm::JOINTS;
fn main() {
    let odd = [1e5, -1e5, 1.0000001e5, -3e8, 1e300, f64::NAN, f64::NEG_INFINITY, 0.0];
    let mut state = 1u64;
    for n in 0..40 {
        let mut value = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let part = (state >> 11) as f64 / 4503599627370496.0 - 1.0;
            match (state >> 7) % 100 {
                99 if n > 30 => odd[(state >> 3) as usize % 8],
                0..60 => 3.2 * part,
                60..90 => 100.0 * part,
                _ => 1e5 * part,
            }
        };
        let q: Vec<[f64; N]> = (0..n).map(|_| std::array::from_fn(|_| value())).collect();
        let mut poses = vec![[[7.0; 4]; 3]; n];
        arm::fk_batch(&q, &mut poses);
        for (q, pose) in q.iter().zip(&poses) {
            let own = arm::fk(q);
            let largest = own.iter().flatten().fold(1.0, |most: f64, cell| most.max(cell.abs()));
            for (a, b) in own.iter().flatten().zip(pose.iter().flatten()) {
                assert!((a - b).abs() <= 1e-13 * largest || (a.is_nan() && b.is_nan()) || a == b, "{n}: {q:?}: {a} {b}");
            }
        }
    }
}
"#;

#[test]
fn the_poses_of_a_batch_are_those_of_each_posture() {
    let arms = [examples::scara_helical(), examples::planar_arm(), examples::rail_arm()];
    let mut tables = vec![of(&examples::puma_like(), NearParallel::HayatiBelow(0.1))];
    tables.extend(arms.iter().map(|chain| of(chain, NearParallel::Dh)));
    let mut compilers = vec![
        (Language::C, "gcc", &["-O3", "-std=c99", "-x", "c"][..]),
        (Language::Cpp, "g++", &["-O2", "-std=c++17", "-x", "c++"]),
        (Language::Rust, "rustc", &["-O", "--edition", "2021"]),
    ];
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        compilers.push((Language::Rust, "rustc", &["-O", "--edition", "2021", "-C", "target-feature=+avx2,+fma"]));
    }
    for (language, program, flags) in compilers {
        if !is_installed(program) {
            continue;
        }
        // What differs from arm to arm is the same in every language.
        for table in &tables[..if language == Language::C { tables.len() } else { 2 }] {
            let folder = tempfile::tempdir().unwrap();
            let text = code(table, Options { language, precision: Precision::Double }).unwrap();
            let name = text.lines().find_map(|line| line.strip_prefix("static inline void ")?.split_once("_fk("));
            let main = match (language, name) {
                (Language::Rust, _) => MANY_IN_RUST.to_owned(),
                (_, Some((name, _))) => {
                    let n = table.coordinates.len();
                    format!(
                        "#include \"arm.h\"\n#define N {n}\n#define BATCH {name}_fk_batch\n#define FK {name}_fk\n{MANY_IN_C}"
                    )
                }
                _ => {
                    let name =
                        text.lines().find_map(|line| line.strip_prefix("namespace ")?.strip_suffix(" {")).unwrap();
                    let n = table.coordinates.len();
                    format!(
                        "#include \"arm.hpp\"\n#define N {n}\nusing namespace {name};
                        static void BATCH(const double *q, int n, double *poses) {{
                            fk_batch(reinterpret_cast<const Joints *>(q), std::size_t(n), reinterpret_cast<Pose *>(poses)); }}
                        static void FK(const double *q, double pose[3][4]) {{
                            const Pose own = fk(*reinterpret_cast<const Joints *>(q)); std::memcpy(pose, &own, sizeof own); }}
                        {MANY_IN_C}"
                    )
                }
            };
            written(folder.path(), &format!("arm.{}", language.extension()), &text);
            let file = written(folder.path(), "main.rs", &main);
            let made = folder.path().join("many");
            let output = Command::new(program)
                .args(flags)
                .arg(file)
                .arg("-o")
                .arg(&made)
                .args((language != Language::Rust).then_some("-lm"))
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let run = Command::new(&made).output().unwrap();
            let said = [run.stdout, run.stderr].concat();
            assert!(run.status.success(), "{} {language:?}: {}", table.name, String::from_utf8_lossy(&said));
        }
    }
}

#[test]
fn four_byte_numbers_have_no_batch() {
    for language in [Language::C, Language::Cpp, Language::Rust] {
        let text =
            |precision| code(&of(&examples::puma_like(), NearParallel::Dh), Options { language, precision }).unwrap();
        assert!(text(Precision::Double).contains("fk_batch") && !text(Precision::Single).contains("fk_batch"));
    }
}

#[test]
fn a_self_test_can_fail() {
    let folder = tempfile::tempdir().unwrap();
    if !is_installed("python3") {
        return;
    }
    let text = code(
        &of(&examples::puma_like(), NearParallel::Dh),
        Options { language: Language::Python, precision: Precision::Double },
    );
    let text = text.unwrap();
    let from = text.find("= sin(q[1])").unwrap();
    let broken = format!("{}= sin(q[1] + 1e-9){}", &text[..from], &text[from + "= sin(q[1])".len()..]);
    let file = written(folder.path(), "broken.py", &broken);
    assert!(!Command::new("python3").arg(file).status().unwrap().success());
    // And so can that of inverse kinematics.
    let broken = text.replace("atan2(-root if second else root, c)", "atan2(root, c)");
    assert_ne!(broken, text);
    let file = written(folder.path(), "one_branch.py", &broken);
    assert!(!Command::new("python3").arg(file).status().unwrap().success());
}

#[test]
fn arms_with_a_closed_form_have_inverse_kinematics_and_others_say_why_not() {
    let options = Options { language: Language::Python, precision: Precision::Double };
    let with: Vec<String> = tables()
        .iter()
        .filter(|table| code(table, options).unwrap().contains("def ik(pose, branch)"))
        .map(|table| table.name.clone())
        .collect();
    for name in ["ur5e", "ur10", "irb120", "puma560"] {
        assert!(with.iter().any(|it| it == name), "{name} is not among {with:?}");
    }
    let text = code(&of(&examples::scara_helical(), NearParallel::Dh), options).unwrap();
    assert!(text.contains("No inverse kinematics in closed form: it does not have six joints"), "{text}");
}

#[test]
fn a_planar_arm_in_every_language() {
    for (language, name) in [
        (Language::C, "c"),
        (Language::Cpp, "cpp"),
        (Language::Rust, "rust"),
        (Language::Python, "python"),
        (Language::Matlab, "matlab"),
    ] {
        let options = Options { language, precision: Precision::Double };
        insta::assert_snapshot!(name, code(&of(&examples::planar_arm(), NearParallel::Dh), options).unwrap());
    }
}

#[test]
fn names_end_no_comment_and_what_does_not_move_is_refused() {
    let mut table = of(&examples::planar_arm(), NearParallel::Dh);
    table.name = "7 */ \n\"\"\" end".into();
    table.coordinates[0].name = "a\nb */".into();
    for language in [Language::C, Language::Cpp, Language::Rust, Language::Python, Language::Matlab] {
        let text = code(&table, Options { language, precision: Precision::Double }).unwrap();
        assert!(text.contains("7 __ ___") && !text.contains("7 */"), "{text}");
        assert!(text.contains("a_b __"), "{text}");
    }
    let still = Chain::new(("r", "a", "b"), Vec::new(), Vec::new(), denavit_model::Pose::identity()).unwrap();
    let refused = code(&of(&still, NearParallel::Dh), Options { language: Language::C, precision: Precision::Double });
    assert!(refused.unwrap_err().to_string().starts_with("nothing moves between \"a\" and \"b\""));
}
