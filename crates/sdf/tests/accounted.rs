//! The reader says of everything in a file what became of it.

#![allow(clippy::unwrap_used)] // Tests: a panic is a failure.

use denavit_model::{Outcome, Robot, urdf};

/// A model that has every element that is understood.
const MODEL: &str = r#"<sdf version="1.9">
<model name="m" canonical_link="base">
  <pose>0 0 1 0 0 0</pose>
  <static>false</static>
  <link name="base"/>
  <link name="arm">
    <pose relative_to="base">0 0 1 0 0 0</pose>
    <inertial><pose>0 0 1 0 0 0</pose><mass>1</mass><inertia><ixx>1</ixx><ixy>0</ixy><ixz>0</ixz><iyy>1</iyy><iyz>0</iyz><izz>1</izz></inertia></inertial>
    <visual name="v"><pose>0 0 1 0 0 0</pose><geometry><box><size>1 1 1</size></box></geometry></visual>
    <visual name="w"><geometry><cylinder><radius>1</radius><length>1</length></cylinder></geometry></visual>
    <collision name="c"><geometry><sphere><radius>1</radius></sphere></geometry></collision>
    <collision name="d"><geometry><mesh><uri>a.stl</uri><scale>1 1 1</scale></mesh></geometry></collision>
    <collision name="e"><geometry><capsule><radius>1</radius><length>1</length></capsule></geometry></collision>
  </link>
  <link name="hand"/>
  <link name="nut"/>
  <frame name="tool" attached_to="hand"><pose>0 0 1 0 0 0</pose></frame>
  <joint name="j" type="revolute">
    <pose>0 0 0 0 0 0</pose><parent>base</parent><child>arm</child>
    <axis><xyz expressed_in="__model__">0 0 1</xyz><limit><lower>-1</lower><upper>1</upper><effort>1</effort><velocity>1</velocity></limit><dynamics><damping>1</damping><friction>1</friction><spring_reference>0</spring_reference><spring_stiffness>0</spring_stiffness></dynamics></axis>
  </joint>
  <joint name="k" type="universal">
    <parent>arm</parent><child>hand</child>
    <axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz><mimic joint="j"><multiplier>1</multiplier><offset>0</offset><reference>0</reference></mimic></axis2>
  </joint>
  <joint name="s" type="screw"><parent>arm</parent><child>nut</child><screw_thread_pitch>0.01</screw_thread_pitch><axis><xyz>0 0 1</xyz></axis></joint>
</model>
</sdf>"#;

fn read(text: &str) -> Robot {
    let urdf = denavit_sdf::read("m.sdf", text, &mut denavit_sdf::includes::nothing);
    let urdf = urdf.unwrap_or_else(|error| panic!("{error}\n{text}"));
    urdf::read("m.sdf", &urdf).unwrap_or_else(|error| panic!("{error}\n{urdf}"))
}

/// Byte offsets just behind the tag name of every element in the model, and its tag.
fn positions() -> Vec<(usize, &'static str)> {
    let starts = MODEL.match_indices('<').filter(|(at, _)| MODEL[at + 1..].starts_with(char::is_alphabetic));
    let tags = starts.map(|(at, _)| {
        let tag = &MODEL[at + 1..];
        let tag = &tag[..tag.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(tag.len())];
        (at + 1 + tag.len(), tag)
    });
    tags.filter(|(_, tag)| *tag != "sdf").collect()
}

/// The text with something put into the element whose tag name ends at `at`.
fn with_inside(at: usize, what: &str) -> String {
    let end = at + MODEL[at..].find('>').unwrap();
    let tag_at = MODEL[..at].rfind('<').unwrap();
    if MODEL[..end].ends_with('/') {
        let tag = &MODEL[tag_at + 1..at];
        return format!("{}>{what}</{tag}{}", &MODEL[..end - 1], &MODEL[end..]);
    }
    format!("{}>{}", &MODEL[..end], &MODEL[end + 1..]).replacen(
        &MODEL[end + 1..],
        &format!("{what}{}", &MODEL[end + 1..]),
        1,
    )
}

fn reported(robot: &Robot) -> Vec<(usize, String)> {
    robot.inventory().reported().map(|item| (item.place.line, item.what.clone())).collect()
}

#[test]
fn a_file_that_is_understood_is_wholly_understood() {
    let robot = read(MODEL);
    assert_eq!(reported(&robot), Vec::new());
    let inventory = robot.inventory();
    // The root's tag and its version; every element; every attribute. The model's pose rides along.
    assert_eq!(inventory.understood, 1 + positions().len() + MODEL.matches("=\"").count() - 1);
    assert_eq!(inventory.count(Outcome::Carried), 1, "{:?}", inventory.items);
}

#[test]
fn every_position_reports_an_attribute_and_an_element() {
    let line = |at: usize| 1 + MODEL[..at].matches('\n').count();
    assert!(positions().len() > 70);
    for (at, tag) in positions() {
        let attribute = format!("{} odd=\"1\"{}", &MODEL[..at], &MODEL[at..]);
        let robot = read(&attribute);
        assert_eq!(reported(&robot), [(line(at), format!("attribute odd=\"1\" of <{tag}>"))], "{attribute}");
        let what = format!("attribute odd=\"1\" of <{tag}> is not understood");
        let noted = robot.notes.iter().filter(|note| note.to_string().contains(&what)).count();
        assert_eq!(noted, 1, "{:?}", robot.notes);
        // The text of a value stands before an element in it here, as XML libraries read it.
        let end = MODEL[at..].find("</").unwrap() + at;
        let holds_value = !MODEL[at..end].contains('<') && MODEL[at..end].contains('>');
        let element =
            if holds_value { format!("{}<odd/>{}", &MODEL[..end], &MODEL[end..]) } else { with_inside(at, "<odd/>") };
        let robot = read(&element);
        assert!(
            reported(&robot).iter().any(|(_, what)| *what == format!("<odd> in <{tag}>")),
            "{:?}\n{element}",
            reported(&robot)
        );
        // It is kept, too.
        assert!(robot.source.text.contains("<odd/>"), "{}", robot.source.text);
    }
}

#[test]
fn text_beside_elements_is_reported() {
    for tag in
        ["model name=\"m\" canonical_link=\"base\"", "link name=\"arm\"", "inertial", "axis", "limit", "geometry"]
    {
        let robot = read(&MODEL.replacen(&format!("<{tag}>"), &format!("<{tag}>odd"), 1));
        let tag = tag.split(' ').next().unwrap();
        assert_eq!(reported(&robot)[0].1, format!("text \"odd\" in <{tag}>"));
    }
}

#[test]
fn second_elements_and_near_names_are_said() {
    let second = read(&MODEL.replacen("<mass>1</mass>", "<mass>1</mass><mass>2</mass>", 1));
    assert_eq!(reported(&second), [(8, "a second <mass> in <inertial>".to_owned())]);
    let near = read(&MODEL.replacen("<friction>1</friction>", "<fricton>1</fricton>", 1));
    assert!(near.notes.iter().any(|note| note.to_string().contains("did you mean <friction>?")), "{:?}", near.notes);
}
