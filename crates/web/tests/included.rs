//! Models whose files include others, as a page asks about them: first with the files beside, then as it keeps the robot.

#![allow(clippy::unwrap_used, reason = "a panic is a failure")]

use serde_json::{Value, json};

const ARM: &str = r#"<mujoco model="arm"><compiler angle="degree"/><include file="parts/defaults.xml"/><worldbody>
  <body name="base"><geom size=".1"/><body name="tip" pos="0 0 .5"><joint name="j" class="turn"/><geom type="mesh" mesh="tool"/>
  </body></body></worldbody></mujoco>"#;
const SDF: &str = r#"<sdf version="1.9"><model name="cell"><include><uri>model://arm</uri></include></model></sdf>"#;
const NESTED: &str = r#"<sdf version="1.9"><model name="arm"><link name="base"/><link name="tip"/>
  <joint name="j" type="revolute"><pose relative_to="base">0 0 .5 0 0 0</pose><parent>base</parent><child>tip</child>
  <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint></model></sdf>"#;

fn answer(question: &Value) -> Value {
    serde_json::from_str(&denavit_web::answer(&question.to_string())).unwrap()
}

/// What the page asks about a robot after it was opened, as `opened` in `web/src/main.ts` keeps it.
fn opened(file: &str, text: &str, files: &Value, names: &Value) -> (Value, Value) {
    let mut source = json!({ "file": file, "text": text, "files": files, "names": names });
    let answer = answer(&json!({ "ask": "open", "source": source }).as_object_mut().map(flat).unwrap());
    assert!(answer.get("error").is_none(), "{answer}");
    source["files"] = json!({});
    if answer["is_alone"] == false {
        source["text"] = answer["urdf"].clone();
    }
    (answer, source)
}

/// The source's fields stand beside `ask` where the question is about it alone.
fn flat(question: &mut serde_json::Map<String, Value>) -> Value {
    let source = question.remove("source").unwrap();
    let mut flat = source.as_object().unwrap().clone();
    flat.insert("ask".into(), question["ask"].clone());
    Value::Object(flat)
}

#[test]
fn every_question_is_answered_where_a_model_includes_others() {
    for root in ["mujoco", "mujocoinclude"] {
        let part = format!(
            r#"<{root}><default><default class="turn"><joint axis="0 1 0" range="-90 90"/></default></default>
               <asset><mesh name="tool" file="tool.stl"/></asset></{root}>"#
        );
        let files = json!({ "/top/arm.xml": ARM, "/top/parts/defaults.xml": part });
        let names = json!(["/top/arm.xml", "/top/parts/defaults.xml", "/top/tool.stl"]);
        let (answer, source) = opened("top/arm.xml", ARM, &files, &names);
        assert!(answer["urdf"].as_str().unwrap().contains("does not compute their mass"), "{}", answer["urdf"]);
        check(&source, "j");
    }
    let files = json!({ "/ws/cell/model.sdf": SDF, "/ws/arm/arm.sdf": NESTED,
        "/ws/arm/model.config": "<model><name>arm</name><sdf version='1.9'>arm.sdf</sdf></model>" });
    let names = json!(["/ws/cell/model.sdf", "/ws/arm/arm.sdf", "/ws/arm/model.config"]);
    let (_, source) = opened("ws/cell/model.sdf", SDF, &files, &names);
    check(&source, "arm::j");
    // A model that is whole stands for itself.
    let (answer, source) = opened("arm.sdf", NESTED, &json!({}), &json!(["/arm.sdf"]));
    assert!(answer["is_alone"] == true && source["text"] == NESTED);
    check(&source, "j");
}

fn check(source: &Value, joint: &str) {
    let table = answer(&json!({ "ask": "table", "source": source, "format": "csv" }));
    assert!(table["text"].as_str().is_some_and(|text| text.contains(joint)), "{table}");
    let found = answer(&json!({ "ask": "check", "source": source }).as_object_mut().map(flat).unwrap());
    assert!(found.get("error").is_none(), "{found}");
    let same = answer(&json!({ "ask": "diff", "a": source, "b": source }));
    assert!(same.get("error").is_none(), "{same}");
}
