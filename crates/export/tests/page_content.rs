//! What pages say, and that they are well formed whatever the robot is called.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use denavit_dh::{Options, Parallelism, convert};
use denavit_export::drawing::{Detail, View, far_from_scale, skeleton};
use denavit_export::page::{Card, ChainPart, Document, html, index, markdown};
use denavit_export::{LengthUnit, Units};
use denavit_model::nalgebra::{Point3, Unit, Vector3};
use denavit_model::tree::Reading;
use denavit_model::{AxisLine, Chain, ChainJoint, Coordinate, Note, Quantity, Screw, examples, se3, urdf};

fn document(chain: Chain, options: &Options) -> Document {
    let table = convert::table(&chain, options).unwrap();
    Document {
        main: ChainPart { chain, table: table.value, notes: table.notes, gauge: "Fewest numbers.".into() },
        others: Vec::new(),
        robot: None,
        source: "arm.urdf".into(),
        fingerprint: Some("4f1d0a".into()),
        units: Units::default(),
    }
}

fn of_urdf(text: &str) -> Document {
    let robot = urdf::read("arm.urdf", text).unwrap();
    let chain = robot.chain(None, None, Reading::Intended).unwrap();
    let mut document = document(chain.value, &Options::default());
    document.main.notes.extend(chain.notes);
    document.robot = Some(robot);
    document
}

/// Two revolute joints whose axes are so many rad from parallel.
fn nearly_parallel(angle: f64) -> Chain {
    let joint = |k: usize, direction: Vector3<f64>, x: f64| ChainJoint {
        name: format!("j{k}"),
        screw: Screw::Revolute(AxisLine { direction: Unit::new_normalize(direction), point: Point3::new(x, 0.0, 0.0) }),
        coordinate: k,
        scale: 1.0,
        offset: 0.0,
    };
    let joints = vec![joint(0, Vector3::z(), 0.0), joint(1, Vector3::new(angle.sin(), 0.0, angle.cos()), 0.5)];
    let coordinates = (0..2).map(|k| Coordinate::unlimited(format!("j{k}"), Quantity::Angle)).collect();
    Chain::new(("far", "base", "tip"), coordinates, joints, se3::translation(Vector3::new(1.0, 0.0, 0.0))).unwrap()
}

fn xml(svg: &str) -> roxmltree::Document<'_> {
    roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{error} in {svg}"))
}

fn texts(svg: &str) -> Vec<String> {
    let document = xml(svg);
    let words = document.descendants().filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")));
    words.filter_map(|node| node.text().map(str::to_owned)).collect()
}

#[test]
fn figure_names_every_axis_and_every_number_that_is_not_zero() {
    let chain = examples::puma_like();
    let table = convert::table(&chain, &Options::default()).unwrap().value;
    let words = texts(&skeleton(&table, View::Isometric, Detail::Dimensioned, Units::default())).join(" ");
    for name in ["x₀", "x₁", "x₂", "x₃", "x₄", "x₅", "x₆", "xₜ", "z₀", "z₁", "z₂", "z₃", "z₄", "z₅", "z₆", "zₜ"]
    {
        assert!(words.split(' ').any(|word| word == name), "{name} in {words}");
    }
    for (index, row) in table.rows.iter().enumerate() {
        let digit = char::from_u32(0x2080 + u32::try_from(index).unwrap()).unwrap();
        let numbers = [("a", row.a()), ("d", row.d().unwrap()), ("α", row.alpha())];
        for (letter, value) in numbers {
            assert_eq!(words.contains(&format!("{letter}{digit} =")), value.abs() > 1e-9, "{letter}{digit} in {words}");
        }
        assert_eq!(words.contains(&format!("θ{digit} =")), index > 0, "θ{digit} in {words}");
    }
    assert!(words.contains("a₂ = 0.43 m") && words.contains("= 90°"), "{words}");
}

#[test]
fn figures_are_well_formed_and_the_same_on_every_run() {
    for chain in examples::all() {
        let table = convert::table(&chain, &Options::default()).unwrap().value;
        for view in View::ALL {
            for detail in [Detail::Dimensioned, Detail::Plain] {
                let svg = skeleton(&table, view, detail, Units::default());
                xml(&svg);
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{}", chain.name());
                assert_eq!(svg, skeleton(&table, view, detail, Units::default()));
            }
        }
    }
}

#[test]
fn names_from_the_file_are_text_and_never_markup() {
    let name = "</script><b>arm & \"co\"";
    let page = html(&document(examples::planar_arm().renamed(name), &Options::default()));
    assert!(!page.contains("<b>arm"), "a name became markup");
    assert_eq!(page.matches("</script>").count(), 2);
    assert!(page.contains("&lt;b&gt;arm &amp; &quot;co&quot;"));
    let card = Card::of(&document(examples::planar_arm().renamed(name), &Options::default()), "arm.html");
    assert!(!index("Robots", &[card]).contains("<b>arm"));
}

#[test]
fn numbers_are_written_as_engineers_write() {
    let page = html(&document(examples::puma_like(), &Options::default()));
    let (shown, _) = page.split_once("<script type=\"application/json\"").unwrap();
    assert!(!shown.contains(">-0<") && !shown.contains(">−0<") && !shown.contains("1.5707"));
    assert!(shown.contains("<td class=\"n\">90</td>") && shown.contains("<td class=\"n\">0.67</td>"));
    let millimetres = Units { length: LengthUnit::Millimetre, ..Units::default() };
    let page = html(&Document { units: millimetres, ..document(examples::puma_like(), &Options::default()) });
    assert!(page.contains("d (mm)") && page.contains("<td class=\"n\">670</td>") && page.contains("d₁ = 670 mm"));
}

#[test]
fn page_tells_what_was_read_otherwise_than_written_and_where_it_came_from() {
    let text = r#"<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2.5"/><inertia ixx="0.01" ixy="0"
        ixz="0" iyy="0.02" iyz="0" izz="0.03"/></inertial></link><link name="c"/>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit lower="-1.5" upper="1.5" velocity="2" effort="30"/></joint>
        <joint name="k" type="continuous"><parent link="b"/><child link="c"/><origin xyz="0.4 0 0" rpy="1.5708 0 0"/>
        <axis xyz="0 0 1"/></joint></robot>"#;
    let document = of_urdf(text);
    let page = html(&document);
    let note = document.main.notes.iter().find(|note| matches!(note, Note::IntendedAngle { .. })).unwrap().to_string();
    assert!(page.contains(&note.replace('"', "&quot;").replace('/', "&#x2f;")), "{note}");
    for shown in ["arm.urdf", "4f1d0a", "2.5 kg", "0.01, 0.02, 0.03", "30 N·m", "endless", "85.94°", "2 of the links"]
    {
        assert!(page.contains(shown), "{shown}");
    }
    let files = markdown(&document, "arm");
    assert!(files[0].name == "arm.md" && files[0].text.contains(&note) && files[0].text.contains("2.5 kg"));
}

#[test]
fn markdown_tables_have_as_many_cells_in_every_row_and_every_figure_is_a_file() {
    for chain in examples::all() {
        let files = markdown(&document(chain, &Options::default()), "arm");
        let mut cells = None;
        for line in files[0].text.lines() {
            let count = line.starts_with('|').then(|| line.replace("\\|", "").matches('|').count());
            assert!(cells.is_none() || count.is_none() || cells == count, "{line}");
            cells = count;
        }
        for figure in files[0].text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            xml(&files.iter().find(|file| file.name == figure).unwrap().text);
        }
        assert_eq!(files.len(), 6);
    }
}

#[test]
fn numbers_that_are_not_to_scale_leave_the_arm_on_the_sheet() {
    let exact = Options { parallelism: Parallelism::Exact, ..Options::default() };
    let document = document(nearly_parallel(1e-6), &exact);
    assert!(far_from_scale(&document.main.table));
    let page = html(&document);
    assert!(page.contains("far beyond the robot&#x27;s size") || page.contains("far beyond the robot's size"));
    assert!(page.contains("common normal is"), "the note is on the page");
    let svg = skeleton(&document.main.table, View::Isometric, Detail::Dimensioned, Units::default());
    assert!(texts(&svg).iter().any(|word| word == "x₀"), "the arm is on the sheet: {:?}", texts(&svg));
    assert!(svg.len() < 400_000);
}

#[test]
fn robot_without_joints_has_a_page() {
    let page = html(&of_urdf(r#"<robot name="rock"><link name="a"/></robot>"#));
    assert!(page.contains("no joints") && !page.contains("id=\"workspace\""));
}
