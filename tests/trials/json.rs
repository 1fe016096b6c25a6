//! JSON: every output names its kind, `--json [FILE]` has the same meaning everywhere, and docs/json.md shows an example of each.

use super::Trial;
use crate::support::top;
use serde_json::Value;
use std::fmt::Write as _;

/// A kind of JSON: its purpose, the commands that make it, and the file that they write (none: standard output).
struct Kind {
    schema: &'static str,
    purpose: &'static str,
    before: &'static [&'static str],
    command: &'static str,
    file: Option<&'static str>,
}

const fn printed(schema: &'static str, purpose: &'static str, command: &'static str) -> Kind {
    Kind { schema, purpose, before: &[], command, file: None }
}

const SIMULATE: &str = "simulate arm.urdf --rows 60 -o data.csv";

const FLEET: &[&str] = &[SIMULATE, "fleet run plant.csv -o store"];

/// Every kind of JSON that a command makes, except a history in git, which `tests/oracle/fleet` makes, and the robots of a
/// repository (`projects.rs`).
const KINDS: &[Kind] = &[
    printed("denavit.table/1", "a D-H table, readable as a source", "table arm.urdf --json"),
    printed("denavit.poe/1", "screw axes and home pose, readable as a source", "poe arm.urdf --json"),
    printed("denavit.match/1", "a robot against a vendor's table", "table arm.urdf --match arm_dh.csv --json"),
    printed("denavit.chains/1", "the chains of a tree", "chains arm.urdf --json"),
    printed("denavit.fk/1", "pose of the tip", "fk arm.urdf --q 0,-1.57,1.57,0,0,0 --json"),
    printed("denavit.ik/1", "joint values that reach poses", "ik arm.urdf --pose 0.4,0.2,0.5,3.14,0,0 --json"),
    printed("denavit.hand_eye/1", "where the instrument and the target are", "hand-eye --data pairs.csv --json"),
    printed("denavit.diff/1", "how two robots differ", "diff arm.urdf longer.urdf --json"),
    printed("denavit.check/1", "findings", "check bent.urdf --json"),
    printed("denavit.edit/1", "what edits did, claim and prove", "edit arm.urdf flip elbow_joint -o out.urdf --json"),
    printed("denavit.fingerprint/1", "a short hash of the robot", "fingerprint arm.urdf --json"),
    printed("denavit.identifiability/1", "number and rank of parameters", "identify arm.urdf --json"),
    printed("denavit.plan/1", "poses to measure", "plan arm.urdf --count 10 --spread 100 --json"),
    Kind {
        schema: "denavit.tell_apart/1",
        purpose: "poses that distinguish causes",
        before: &["simulate arm.urdf --rows 60 --seed 6 -o run.csv --effect joint_compliance@elbow_joint=0.05mm"],
        command: "plan arm.urdf --tell-apart run.csv --count 10 --spread 100 --json",
        file: None,
    },
    Kind {
        schema: "denavit.measure/1",
        purpose: "each row while measuring, a line of JSON per row",
        before: &["simulate arm.urdf --rows 20 -o data.csv"],
        command: "measure arm.urdf --data data.csv --spread 100 --json",
        file: None,
    },
    Kind {
        schema: "denavit.simulation/1",
        purpose: "the simulated robot",
        before: &[],
        command: "simulate arm.urdf --rows 60 -o data.csv --truth truth.json --effect joint_compliance@elbow_joint=0.5mm",
        file: Some("truth.json"),
    },
    Kind {
        schema: "denavit.calibration/2",
        purpose: "the report of a calibration",
        before: &[SIMULATE],
        command: "calibrate arm.urdf --data data.csv --hold-out 0.3 --json",
        file: None,
    },
    Kind {
        schema: "denavit.effects/1",
        purpose: "effects, for fk, compensate and simulate",
        before: &["simulate arm.urdf --rows 60 -o data.csv --effect joint_compliance@elbow_joint=0.5mm"],
        command: "calibrate arm.urdf --data data.csv --effects-out effects.json",
        file: Some("effects.json"),
    },
    Kind {
        schema: "denavit.commands/1",
        purpose: "joint commands that reach poses",
        before: &["plan arm.urdf --count 10 --spread 100 -o poses.csv"],
        command: "compensate arm.urdf --poses poses.csv --json",
        file: None,
    },
    Kind {
        schema: "denavit.fleet.run/1",
        purpose: "a run over a fleet",
        before: FLEET,
        command: "fleet run plant.csv -o store --json",
        file: None,
    },
    Kind {
        schema: "denavit.fleet.watch/1",
        purpose: "which robots have changed",
        before: FLEET,
        command: "fleet watch store --json",
        file: None,
    },
    Kind {
        schema: "denavit.fleet.robots/1",
        purpose: "history of each robot",
        before: FLEET,
        command: "fleet history store --json",
        file: None,
    },
    Kind {
        schema: "denavit.fleet.siblings/1",
        purpose: "common parameters and outliers",
        before: FLEET,
        command: "fleet siblings store --json",
        file: None,
    },
    printed("denavit.fleet.corpus/1", "which files are one mechanism", "fleet corpus . --json"),
];

fn trial() -> Trial {
    let trial = Trial::new().with_robot("arm_dh.csv", "universal_robots/ur5e_dh.csv");
    let arm = trial.text("arm.urdf");
    let longer = arm.replacen("-0.425", "-0.427", 1);
    let bent = arm.replacen("axis xyz=\"0 0 1\"", "axis xyz=\"0 0 2\"", 1);
    assert!(longer != arm && bent != arm);
    let plant = "serial,robot,data,date,effects\nSN-1,arm.urdf,data.csv,2026-11-20,none\nSN-1,arm.urdf,data.csv,2026-11-21,none\n\
                 SN-2,longer.urdf,data.csv,2026-11-21,none\n";
    trial
        .with("longer.urdf", &longer)
        .with("bent.urdf", &bent)
        .with("plant.csv", plant)
        .with("pairs.csv", &super::hand_eye::pairs(6))
}

fn made(trial: &Trial, kind: &Kind) -> Value {
    for line in kind.before {
        trial.run(line).succeeded();
    }
    let run = trial.run(kind.command);
    assert!(run.code < 2, "{}: {}", kind.command, run.stderr);
    let text = kind.file.map_or(run.stdout, |file| trial.text(file));
    // The last of several lines of JSON.
    let mut values = serde_json::Deserializer::from_str(&text).into_iter::<Value>();
    let last = values.by_ref().map(|value| value.unwrap_or_else(|error| panic!("{}: {error}: {text}", kind.command)));
    last.last().unwrap_or_else(|| panic!("{}: nothing", kind.command))
}

/// Lists of objects and of lists cut to their first entry, other lists longer than four to two; numbers to six digits.
fn shortened(value: &Value) -> Value {
    match value {
        Value::Array(list) => {
            let nested = list.iter().any(|entry| entry.is_array() || entry.is_object());
            let shown = if nested {
                1
            } else if list.len() > 4 {
                2
            } else {
                list.len()
            };
            list.iter().take(shown).map(shortened).collect()
        }
        Value::Object(map) => map.iter().map(|(key, value)| (key.clone(), shortened(value))).collect(),
        Value::Number(number) if number.is_f64() => {
            format!("{:.5e}", number.as_f64().unwrap()).parse::<f64>().unwrap().into()
        }
        other => other.clone(),
    }
}

/// JSON in which what fits into 140 columns is one line.
fn laid_out(value: &Value, indent: usize, before: usize) -> String {
    let line = value.to_string();
    if indent + before + line.chars().count() <= 140 {
        return line;
    }
    let (open, close, entries): (_, _, Vec<String>) = match value {
        Value::Array(list) => ("[", "]", list.iter().map(|entry| laid_out(entry, indent + 2, 0)).collect()),
        Value::Object(map) => {
            let entry = |(key, value): (&String, &Value)| {
                let key = format!("{}:", Value::from(key.as_str()));
                format!("{key}{}", laid_out(value, indent + 2, key.chars().count()))
            };
            ("{", "}", map.iter().map(entry).collect())
        }
        _ => return line,
    };
    let margin = " ".repeat(indent + 2);
    format!("{open}\n{margin}{}\n{}{close}", entries.join(&format!(",\n{margin}")), " ".repeat(indent))
}

/// Structure of a value: its keys and kinds of values, without numbers and texts.
fn shape(value: &Value) -> Value {
    match value {
        Value::Array(list) => list.first().map(shape).into_iter().collect(),
        Value::Object(map) => map
            .iter()
            .map(|(key, value)| (key.clone(), if key == "schema" { value.clone() } else { shape(value) }))
            .collect(),
        Value::Number(_) => "number".into(),
        Value::String(_) => "text".into(),
        other => other.clone(),
    }
}

const INTRODUCTION: &str = "\
# JSON

For a programmer who reads the results. Every JSON begins with its `schema`, `denavit.<thing>/<version>`. Fields may be added
within a version; a removed or changed field counts it up. Lengths are m, angles rad, whatever `--units` says, at full precision.

`--json` alone prints JSON instead of the text; `--json report.json` writes it beside the text (another name: `--json=FILE`; `-` is
standard output).

";

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn page(examples: &[(&Kind, Value)]) -> String {
    let mut page = INTRODUCTION.to_owned();
    page.push_str(
        "Real output; lists of objects are cut to one entry, other lists longer than four to two, numbers to six digits.\n",
    );
    for (kind, value) in examples {
        let text = laid_out(&shortened(value), 0, 0);
        let Kind { schema, purpose, command, .. } = kind;
        let _ = write!(page, "\n## {schema}\n\n{}: `denavit {command}`\n\n```json\n{text}\n```\n", capital(purpose));
    }
    page
}

#[test]
fn every_json_says_what_it_is_and_the_page_shows_it() {
    let trial = trial();
    let examples: Vec<(&Kind, Value)> = KINDS.iter().map(|kind| (kind, made(&trial, kind))).collect();
    for (kind, value) in &examples {
        assert_eq!(value["schema"], kind.schema, "{}", kind.command);
        assert_eq!(value.as_object().unwrap().keys().next().unwrap(), "schema", "{}", kind.command);
    }
    let (file, made) = (top().join("docs/json.md"), page(&examples));
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    let outline = |page: &str| {
        let mut blocks = page.split("```json\n");
        let words = blocks.next().unwrap().to_owned();
        let parts = blocks.map(|block| {
            let (json, rest) = block.split_once("```").unwrap();
            (shape(&serde_json::from_str(json).unwrap()), rest.to_owned())
        });
        (words, parts.collect::<Vec<_>>())
    };
    if outline(&made) != outline(&written) {
        assert!(
            std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always"),
            "docs/json.md is out of date; INSTA_UPDATE=always cargo test -p denavit the_page_shows_it writes it"
        );
        std::fs::write(file, made).unwrap();
    }
}

#[test]
fn json_with_a_file_stands_beside_the_text() {
    let trial = trial();
    for kind in KINDS.iter().filter(|kind| kind.command.ends_with(" --json")) {
        for line in kind.before {
            trial.run(line).succeeded();
        }
        let plain = kind.command.trim_end_matches(" --json");
        let (alone, text) = (trial.run(kind.command), trial.run(plain));
        let both = trial.run(&format!("{plain} --json report.json"));
        assert_eq!((both.code, &both.stdout), (text.code, &text.stdout), "{plain}");
        assert_eq!(trial.text("report.json"), alone.stdout, "{plain}");
        assert_eq!(trial.run(&format!("{plain} --json=-")).stdout, alone.stdout, "{plain}");
    }
    // A robot after --json is a robot, not an output.
    let json = trial.run("fk --json arm.urdf").succeeded();
    assert!(json.starts_with('{') && trial.text("arm.urdf").starts_with("<?xml"), "{json}");
    trial.run("table arm.urdf --json one.json").succeeded();
    trial.run("table arm.urdf --json two.json").succeeded();
    trial.refuses("check --json one.json two.json", "--json one.json: this file is a robot, and would be replaced");
    assert_eq!(trial.run("check --json - one.json two.json").code, 0);
}
