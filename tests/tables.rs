//! Tables as people write them, and one table in every format.

use crate::support::{denavit, denavit_with_input, robot};
use std::fmt::Write as _;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

/// The UR5e's table as in manuals, spreadsheets and wikis.
const UR5E: [(&str, &str); 8] = [
    (
        "semicolons.csv",
        "# Standard DH\nJoint;Alpha [deg];a (mm);d (mm);θ\n1;90;0;162,5;q1\n2;0;-425;0;q2\n3;0;-392,2;0;q3\n\
         4;90;0;133,3;q4\n5;-90;0;99,7;q5\n6;0;0;99,6;q6\n",
    ),
    (
        "wiki.md",
        "# UR5e\n\nStandard Denavit-Hartenberg parameters, lengths in mm.\n\n| Link | θᵢ | αᵢ | aᵢ | dᵢ |\n\
         |:---|---:|---:|---:|---:|\n| 1 | θ₁ | π/2 | 0 | 162.5 |\n| 2 | θ₂ | 0 | -425 | 0 |\n| 3 | θ₃ | 0 | -392.2 | 0 |\n\
         | 4 | θ₄ | π/2 | 0 | 133.3 |\n| 5 | θ₅ | -π/2 | 0 | 99.7 |\n| 6 | θ₆ | 0 | 0 | 99.6 |\n\nSome words behind it.\n",
    ),
    (
        "tabs.tsv",
        "i\td\ta\talpha\ttheta\n1\t0.1625\t0\tpi/2\tq1\n2\t0\t-0.425\t0\tq2\n3\t0\t-0.3922\t0\tq3\n4\t0.1333\t0\tpi/2\tq4\n\
         5\t0.0997\t0\t-pi/2\tq5\n6\t0.0996\t0\t0\tq6\n",
    ),
    (
        "bom.csv",
        "\u{feff}alpha_deg,a_m,theta_deg,d_m\n90,0,0,0.1625\n0,-0.425,0,0\n0,-0.3922,0,0\n90,0,0,0.1333\n-90,0,0,0.0997\n\
         0,0,0,0.0996\n",
    ),
    (
        "no_units.csv",
        "joint,theta,d,a,alpha\n1,0,162.5,0,90\n2,0,0,-425,0\n3,0,0,-392.2,0\n4,0,133.3,0,90\n5,0,99.7,0,-90\n\
         6,0,99.6,0,0\n",
    ),
    (
        "degrees_in_cells.csv",
        "theta,d,a,alpha\nθ1,162.5 mm,0,90°\nθ2,0,-425 mm,0\nθ3,0,-392.2 mm,0\nθ4,133.3 mm,0,+90°\nθ5,99.7 mm,0,−90°\n\
         θ6,99.6 mm,0,–\n",
    ),
    (
        "latex.csv",
        "$\\theta_i$,$d_i$ [m],$a_i$ [m],$\\alpha_i$ [°]\n$\\theta_1$,0.1625,0,90\n$\\theta_2$,0,-0.425,0\n\
         $\\theta_3$,0,-0.3922,0\n$\\theta_4$,0.1333,0,90\n$\\theta_5$,0.0997,0,-90\n$\\theta_6$,0.0996,0,0\n",
    ),
    (
        "title_line.csv",
        "UR5e;;;;\n\"Kind\";\"theta\";\"d\";\"a\";\"alpha\"\nR;0;0,1625;0;90°\nR;0;0;-0,425;0\nR;0;0;-0,3922;0\nR;0;0,1333;0;90°\n\
         R;0;0,0997;0;-90°\nR;0;0,0996;0;0\n",
    ),
];

#[test]
fn tables_as_manuals_print_them_are_the_robot() {
    let (folder, ur5e) = (Folder::new(), robot("universal_robots/ur5e.urdf"));
    for (name, text) in UR5E {
        let file = folder.file(name, text);
        let matched = denavit(&["table", &ur5e, "--match", &file]);
        assert_eq!(matched.code, 0, "{name}: {}{}", matched.stdout, matched.stderr);
        assert!(matched.stdout.contains(": exact\n"), "{name}: {}", matched.stdout);
        let compared = denavit(&["diff", &ur5e, &file, "--only", "kinematics", "--q-range=-3,3"]);
        assert!(compared.stdout.contains("the same robot"), "{name}: {}{}", compared.stdout, compared.stderr);
    }
    let silent = denavit(&["table", &folder.file("a.csv", UR5E[0].1)]);
    assert_eq!((silent.code, silent.stderr.as_str()), (0, ""), "all is stated");
    let told = denavit(&["table", &folder.file("b.csv", UR5E[4].1)]);
    for expected in ["read as distal", "degrees, as 90 is", "mm, because links of"] {
        assert!(told.stderr.contains(expected), "{expected}: {}", told.stderr);
    }
}

/// The Panda's table as printed by its maker: Craig's convention, the flange in the last row.
const PANDA: &str = "Joint,a (m),d (m),alpha (rad),theta (rad)\nJoint 1,0,0.333,0,θ1\nJoint 2,0,0,−π/2,θ2\n\
                     Joint 3,0,0.316,π/2,θ3\nJoint 4,0.0825,0,π/2,θ4\nJoint 5,−0.0825,0.384,−π/2,θ5\nJoint 6,0,0,π/2,θ6\n\
                     Joint 7,0.088,0,π/2,θ7\nFlange,0,0.107,0,0\n";

#[test]
fn an_unstated_convention_is_tried_and_reported() {
    let folder = Folder::new();
    let file = folder.file("panda.csv", PANDA);
    let panda = robot("franka/panda.urdf");
    let matched =
        |extra: &[&str]| denavit(&[&["table", &panda, "--tip", "panda_link8", "--match", &file], extra].concat());
    let tried = matched(&[]);
    assert_eq!(tried.code, 0, "{}{}", tried.stdout, tried.stderr);
    assert!(tried.stdout.contains("read as proximal, rad and m, the best fit"), "{}", tried.stdout);
    let json: serde_json::Value = serde_json::from_str(&matched(&["--format", "json"]).succeeded()).unwrap();
    assert_eq!(
        json["read_as"],
        serde_json::json!({"convention": "proximal", "angle": "rad", "length": "m", "tried": true})
    );
    let stated = matched(&["--convention", "proximal"]);
    assert!(stated.code == 0 && !stated.stdout.contains("fits best"), "{}", stated.stdout);
    let wrong = matched(&["--convention", "distal"]);
    assert_eq!(wrong.code, 1, "{}", wrong.stderr);
    assert!(wrong.stdout.contains("this looks like proximal, rad and m: the match is then exact"), "{}", wrong.stdout);
    let headed = folder.file("headed.csv", &PANDA.replace("a (m)", "a_i-1").replace("alpha (rad)", "alpha_i-1"));
    let by_heading = denavit(&["table", &panda, "--tip", "panda_link8", "--match", &headed]);
    assert!(by_heading.code == 0 && !by_heading.stdout.contains("fits best"), "{}", by_heading.stdout);
    let q = ["--q", "0.1,-0.2,0.3,-0.4,0.5,0.6,-0.7", "--json"];
    let pose = |arguments: &[&str]| {
        let json: serde_json::Value =
            serde_json::from_str(&denavit(&[&["fk"], arguments, &q].concat()).succeeded()).unwrap();
        let numbers = json["pose"].to_string();
        numbers.split(|c: char| "[],".contains(c)).filter_map(|word| word.parse::<f64>().ok()).collect::<Vec<_>>()
    };
    let of_file = pose(&[&file, "--table-convention", "proximal"]);
    let of_robot = pose(&[&panda, "--tip", "panda_link8"]);
    assert!(of_file.len() >= 12, "{of_file:?}");
    assert!(of_file.iter().zip(&of_robot).all(|(a, b)| (a - b).abs() < 1e-12), "{of_file:?} {of_robot:?}");
}

#[test]
fn a_mismatch_says_what_the_table_looks_like() {
    let (folder, ur5e) = (Folder::new(), robot("universal_robots/ur5e.urdf"));
    let slip = UR5E[0].1.replace("Alpha [deg]", "Alpha [rad]").replace("a (mm);d (mm)", "a (m);d (m)");
    let run = denavit(&["table", &ur5e, "--match", &folder.file("slip.csv", &slip)]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stdout.contains("this looks like distal, degrees and mm: the match is then exact"), "{}", run.stdout);
    // Another arm's table, with degrees declared as rad: without a match the message says what the numbers look like.
    let other = denavit(&["table", &robot("abb/irb120.urdf"), "--match", &folder.file("slip.csv", &slip)]);
    assert_eq!(other.code, 1, "{}", other.stderr);
    assert!(other.stdout.contains("angles up to 90 rad look like degrees"), "{}", other.stdout);
    assert!(other.stdout.contains("lengths up to 425 m look like millimetres"), "{}", other.stdout);
    let clash = denavit(&["table", &ur5e, "--match", &folder.file("a.csv", UR5E[0].1), "--convention", "proximal"]);
    assert!(clash.failed().contains("the file says distal and the options say proximal"));
}

#[test]
fn what_is_wrong_in_a_table_is_named_with_its_place() {
    let folder = Folder::new();
    let says = |text: &str, expected: &str| {
        let file = folder.file("t.csv", text);
        let message = denavit(&["table", &file]).failed().replace(&file, "t.csv");
        assert!(message.contains(expected), "{message}");
    };
    says("theta;d;alpha;a\n0;1;  x;0\n", "error: t.csv:2:7: row: alpha is \"x\"; write a finite number");
    says("theta,d,alpha,a\n0,1,0\n", "t.csv:2: row: a is missing");
    says("theta,d,alpha\n0,1,0\n", "t.csv:1: header: columns are theta, d, alpha; a D-H table has theta (θ, q), d");
    says("theta,d,alpha,r\n0,1,0,0\n", "\"r\" is the link length in some books");
    says("theta,d,alpha,a,θ\n0,1,0,0,0\n", "\"theta\" and \"θ\" name the same column");
    says("theta;d;alpha;a\n0;0,5;0;0\n0;0.5;0;0\n", "t.csv:3:3: row: this number uses another decimal mark");
    says("theta,d,alpha,a\n0,1 rad,0,0\n", "t.csv:2:3: row: d is \"1 rad\"");
    let file = folder.file("t.csv", "theta,d,alpha,a\n0,1,0,0\n");
    assert!(denavit(&["table", &file, "--table-units", "cubit"]).failed().contains("\"cubit\" is not a known unit"));
}

#[test]
fn our_own_markdown_reads_back() {
    for (source, extra, style) in [
        ("universal_robots/ur5e.urdf", &[][..], &[][..]),
        ("franka/panda.urdf", &["--tip", "panda_link8", "--convention", "proximal"][..], &["--units", "mm,rad"][..]),
        ("stanford/stanford_arm.urdf", &[][..], &["--units", "mm"][..]),
    ] {
        let source = robot(source);
        let text = denavit(&[&["table", &source, "--format", "md"], extra, style].concat()).succeeded();
        let again = denavit_with_input(&[&["table", "-", "--format", "md"], style].concat(), &text).succeeded();
        let numbers = |text: &str| -> Vec<Vec<String>> {
            let rows = text.lines().filter(|line| line.starts_with('|') && !line.contains("---"));
            // No table has the limits that follow the numbers.
            rows.map(|row| row.split('|').take(8).map(|cell| cell.trim().to_owned()).collect()).collect()
        };
        assert_eq!(numbers(&again), numbers(&text), "{again}\n{text}");
    }
}

#[test]
fn every_view_shows_one_table() {
    let folder = Folder::new();
    let canonical = folder.file("iiwa.urdf", &denavit(&["export", &robot("kuka/iiwa14.urdf")]).succeeded());
    let sources = [
        canonical,
        robot("universal_robots/ur5e_dh.csv"),
        robot("franka/panda_dh.csv"),
        robot("stanford/stanford_arm.urdf"),
    ];
    for source in sources {
        let cells = |text: &str| -> Vec<Vec<String>> {
            let rows = text.lines().filter(|line| line.starts_with('|') && !line.contains("---")).skip(1);
            let plain = |c: char| match c {
                '−' => '-',
                '₀'..='₉' => char::from_digit(u32::from(c) - u32::from('₀'), 10).unwrap(),
                c => c,
            };
            let cell = |cell: &str| cell.trim().chars().map(plain).collect();
            rows.map(|row| row.split('|').map(cell).collect::<Vec<String>>()).map(|row| row[4..8].to_vec()).collect()
        };
        let pages = folder.0.path().join("pages");
        denavit(&["doc", &source, "--markdown", "-o", pages.to_str().unwrap()]).succeeded();
        let stem = std::path::Path::new(&source).file_stem().unwrap().to_str().unwrap();
        let page = std::fs::read_to_string(pages.join(format!("{stem}.md"))).unwrap();
        for (convention, title) in [("distal", "Distal"), ("proximal", "Proximal")] {
            let table = denavit(&["table", &source, "--convention", convention, "--format", "md"]).succeeded();
            let from = page.find(title).unwrap_or_else(|| panic!("{page}"));
            let of_page = &page[from..];
            let expected = cells(&table);
            assert_eq!(cells(of_page)[..expected.len()], expected[..], "{source} {convention}");
        }
    }
    let gauge = |arguments: &[&str]| {
        let text = denavit(&[&["table", "--format", "json"], arguments].concat()).succeeded();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["gauge"].as_str().unwrap().to_owned()
    };
    let ur5e = robot("universal_robots/ur5e.urdf");
    assert_eq!(gauge(&[&robot("universal_robots/ur5e_dh.csv")]), "file");
    assert_eq!(gauge(&[&robot("kuka/iiwa14.urdf"), "--gauge", "simple"]), "simple");
    assert_eq!(gauge(&[&ur5e, "--gauge", "paper"]), "paper");
}

#[test]
fn the_convention_that_is_asked_for_is_given() {
    let tilted = "<robot name='tilted'><link name='a'/><link name='b'/><link name='c'/>\
        <joint name='j1' type='continuous'><origin xyz='0.1 0 0.3' rpy='1e-5 2e-5 0'/><axis xyz='0 0 1'/><parent link='a'/><child link='b'/></joint>\
        <joint name='j2' type='continuous'><origin xyz='0.4 0 0' rpy='1.5707963267948966 0 0'/><axis xyz='0 0 1'/><parent link='b'/><child link='c'/></joint></robot>";
    for convention in ["distal", "proximal"] {
        let run =
            denavit_with_input(&["table", "-", "--exact", "--convention", convention, "--format", "json"], tilted);
        let json: serde_json::Value = serde_json::from_str(&run.succeeded()).unwrap();
        assert_eq!(json["convention"], convention);
        assert!(json["notes"].to_string().contains("base z"), "the far number is told: {}", json["notes"]);
    }
    let hayati = denavit_with_input(&["table", "-", "--exact", "--convention", "hayati", "--format", "json"], tilted);
    let json: serde_json::Value = serde_json::from_str(&hayati.succeeded()).unwrap();
    assert_eq!(json["convention"], "hayati");
}

#[test]
fn latex_tables_fit_two_columns() {
    let folder = Folder::new();
    let mut body = String::new();
    let mut labels = Vec::new();
    for source in crate::support::files(&crate::support::top().join("robots"), "urdf") {
        let source = source.to_str().unwrap();
        for convention in ["distal", "proximal", "hayati"] {
            let run = denavit(&["table", source, "--format", "tex", "--convention", convention]);
            let text = run.succeeded();
            let label = text.split("\\label{").nth(1).and_then(|rest| rest.split('}').next()).unwrap().to_owned();
            assert!(label.starts_with("tab:dh-") && text.find("\\caption") < text.find("\\label"), "{text}");
            let _ = writeln!(body, "{}\\clearpage", text.replace(&label, &format!("{label}-{}", labels.len())));
            labels.push(label);
        }
    }
    assert!(labels.len() > 30 && body.contains("\\begin{table}") && body.contains("\\begin{table*}"));
    if std::process::Command::new("pdflatex").arg("--version").output().is_err() {
        println!("skipped, because pdflatex is not installed");
        return;
    }
    // The column of IEEE's journals, 252 pt, and of many others, 246 pt: the narrower one.
    let document = format!(
        "\\documentclass[twocolumn]{{article}}\\usepackage[textwidth=510pt]{{geometry}}\\setlength{{\\columnsep}}{{18pt}}\n\
         \\usepackage{{booktabs,graphicx}}\\hbadness=10000\n\\begin{{document}}\n{body}\\end{{document}}\n"
    );
    folder.file("tables.tex", &document);
    let run = std::process::Command::new("pdflatex")
        .args(["-interaction=nonstopmode", "-halt-on-error", "tables.tex"])
        .current_dir(folder.0.path())
        .output()
        .unwrap();
    let log = String::from_utf8_lossy(&run.stdout).into_owned();
    if log.contains("File `booktabs.sty' not found") {
        println!("skipped, because LaTeX has no booktabs here");
        return;
    }
    assert!(run.status.success(), "{log}");
    let overfull: Vec<&str> = log.lines().filter(|line| line.starts_with("Overfull \\hbox")).collect();
    assert!(overfull.is_empty(), "{overfull:#?}");
}

/// A serial arm with this many joints, about the given axes in turn.
fn long_arm(joints: usize, axes: &[&str]) -> String {
    let mut text = "<robot name='long'><link name='l0'/>".to_owned();
    for k in 1..=joints {
        let axis = axes[k % axes.len()];
        let _ = write!(
            text,
            "<link name='l{k}'/><joint name='j{k}' type='revolute'><origin xyz='0.05 0 0.1'/><axis xyz='{axis}'/>\
             <parent link='l{}'/><child link='l{k}'/><limit lower='-2' upper='2' effort='1' velocity='1'/></joint>",
            k - 1
        );
    }
    text + "</robot>"
}

#[test]
fn pages_of_long_arms_take_no_longer_than_they_are_long() {
    let folder = Folder::new();
    let pages = folder.0.path().join("pages");
    for (name, axes) in [("mixed.urdf", &["0 0 1", "0 1 0", "1 0 0"][..]), ("planar.urdf", &["0 0 1"][..])] {
        let time = |joints: usize| {
            let file = folder.file(name, &long_arm(joints, axes));
            let start = std::time::Instant::now();
            denavit(&["doc", &file, "-o", pages.to_str().unwrap()]).succeeded();
            start.elapsed().as_secs_f64()
        };
        // If every sample and every word visits all joints, 50 joints take 25 s and 400 half an hour.
        let (short, long) = (time(50), time(400));
        println!("{name}: 50 joints {short:.2} s, 400 joints {long:.2} s");
        assert!(long < 40.0, "{name}: {short} s, {long} s");
    }
}

#[test]
fn pages_of_revisions_are_linked() {
    let folder = Folder::new();
    let here = folder.0.path();
    let git = |arguments: &[&str]| {
        let own = ["-c", "user.name=someone", "-c", "user.email=someone@example.org", "-c", "init.defaultBranch=main"];
        let run = std::process::Command::new("git").args(own).args(arguments).current_dir(here).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    };
    std::fs::copy(robot("universal_robots/ur5e.urdf"), here.join("ur5e.urdf")).unwrap();
    std::fs::copy(robot("abb/irb120.urdf"), here.join("my arm #1.urdf")).unwrap();
    git(&["init", "-q"]);
    git(&["add", "."]);
    git(&["commit", "-q", "-m", "robots"]);
    let run = std::process::Command::new(env!("CARGO_BIN_EXE_denavit"))
        .args(["doc", "git:HEAD:ur5e.urdf", "ur5e.urdf", "git:HEAD:my arm #1.urdf", "-o", "pages"])
        .current_dir(here)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let index = std::fs::read_to_string(here.join("pages/index.html")).unwrap();
    let links: Vec<&str> = index.split("<a href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(links, ["ur5e.html", "ur5e-2.html", "my%20arm%20%231.html"], "{index}");
    for name in ["ur5e.html", "ur5e-2.html", "my arm #1.html"] {
        assert!(here.join("pages").join(name).is_file(), "{name}");
    }
    assert!(index.contains("git:HEAD:ur5e.urdf"), "the revision is named");
}

#[test]
fn a_calibration_goes_to_its_makers_form_and_comes_back() {
    let folder = Folder::new();
    let path = |name: &str| folder.0.path().join(name).to_str().unwrap().to_owned();
    let xarm = robot("ufactory/xarm7.urdf");
    let data = folder.file("data.csv", &denavit(&["simulate", &xarm, "--rows", "60"]).succeeded());
    let (yaml, urdf, offsets) = (path("xarm7_kinematics_lab.yaml"), path("as_it_is.urdf"), path("offsets.yaml"));
    let added = path("master_calibration.yaml");
    let base = ["calibrate", &xarm, "--data", &data, "--effects", "none"];
    let run = denavit(
        &[
            &base[..],
            &["--urdf", &urdf, "--out-for", "xarm", &yaml, "--out-for", "robot-calibration", &offsets],
            &["--out-for", "pal", &added],
        ]
        .concat(),
    );
    assert_eq!(run.code, 0, "{}", run.stderr);
    let compared = denavit(&["diff", &urdf, &yaml, "--only", "kinematics", "--q-range=-2,2"]);
    let drawn = denavit(&["diff", &xarm, &yaml, "--only", "kinematics", "--q-range=-2,2"]);
    assert_ne!(drawn.code, 0, "{}", drawn.stdout);
    let shift = |text: &str| text.lines().filter(|line| line.contains("joint")).count();
    assert!(shift(&compared.stdout) < shift(&drawn.stdout), "{}\n{}", compared.stdout, drawn.stdout);
    assert!(std::fs::read_to_string(&offsets).unwrap().contains("joint2_x: "));
    let added = std::fs::read_to_string(&added).unwrap();
    assert!(added.contains("geometric_calibration:\n") && added.contains("_dx: "), "{added}");
    let refused = denavit(&[&base[..], &["--out-for", "kinova", &path("kinova.yaml")]].concat()).failed();
    assert!(refused.contains("in an unpublished format"), "{refused}");
    let other = denavit(&[&base[..], &["--out-for", "ur", &path("ur.yaml")]].concat()).failed();
    assert!(other.contains("six revolute joints"), "{other}");
    assert!(!folder.0.path().join("kinova.yaml").exists() && !folder.0.path().join("ur.yaml").exists());
}
