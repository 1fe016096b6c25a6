//! Packages are found, and what cannot be found is told.

use std::path::{Path, PathBuf};

use denavit_xacro::{Environment, Options, PackagePath, Source, expand};

/// A folder for one test, made anew.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages").join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn package(folder: &Path, name: &str) {
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join("package.xml"), format!("<package><name> {name} </name></package>")).unwrap();
}

fn environment(variable: &str, folders: &[&Path]) -> Environment {
    let value = std::env::join_paths(folders).unwrap().into_string().unwrap();
    [(variable.to_owned(), value)].into_iter().collect()
}

#[test]
fn given_folders_may_hold_packages_be_one_or_be_a_prefix() {
    let top = folder("given");
    package(&top.join("src/nested/arm_description"), "arm_description");
    package(&top.join("src/folder_with_another_name"), "tool_description");
    std::fs::create_dir_all(top.join("src/bare")).unwrap();
    package(&top.join("install/share/hand_description"), "hand_description");
    package(&top.join("src/ignored/lost"), "lost");
    std::fs::write(top.join("src/ignored/COLCON_IGNORE"), "").unwrap();
    let path = PackagePath::new(&[top.join("src"), top.join("install")], &Environment::default());
    assert_eq!(path.find("arm_description"), Ok(top.join("src/nested/arm_description")));
    assert_eq!(path.find("tool_description"), Ok(top.join("src/folder_with_another_name")));
    assert_eq!(path.find("bare"), Ok(top.join("src/bare")));
    assert_eq!(path.find("hand_description"), Ok(top.join("install/share/hand_description")));
    assert!(path.find("lost").is_err());
    assert_eq!(path.packages(), ["arm_description", "hand_description", "tool_description"]);
    let itself = PackagePath::new(&[top.join("src/nested/arm_description")], &Environment::default());
    assert_eq!(itself.find("arm_description"), Ok(top.join("src/nested/arm_description")));
}

#[test]
fn the_environment_is_searched_after_given_folders() {
    let top = folder("environment");
    for (at, name) in
        [("given/arm", "arm"), ("ament/share/arm", "arm"), ("ament/share/hand", "hand"), ("ros/deep/leg", "leg")]
    {
        package(&top.join(at), name);
    }
    let ament = top.join("ament");
    let path = PackagePath::new(&[], &environment("AMENT_PREFIX_PATH", &[&top.join("none"), &ament]));
    assert_eq!(path.find("arm"), Ok(ament.join("share/arm")));
    let path = PackagePath::new(&[top.join("given")], &environment("AMENT_PREFIX_PATH", &[&ament]));
    assert_eq!(path.find("arm"), Ok(top.join("given/arm")));
    assert_eq!(path.find("hand"), Ok(ament.join("share/hand")));
    let path = PackagePath::new(&[], &environment("ROS_PACKAGE_PATH", &[&top.join("ros")]));
    assert_eq!(path.find("leg"), Ok(top.join("ros/deep/leg")));
}

#[test]
fn the_package_of_a_file_and_its_siblings_are_found() {
    let top = folder("around");
    package(&top.join("repository/arm_description"), "arm_description");
    package(&top.join("repository/arm_gripper"), "arm_gripper");
    let file = top.join("repository/arm_description/urdf/deep/arm.xacro");
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    let path = PackagePath::default().near(&file);
    assert_eq!(path.find("arm_description"), Ok(top.join("repository/arm_description")));
    assert_eq!(path.find("arm_gripper"), Ok(top.join("repository/arm_gripper")));
}

#[test]
fn a_missing_package_tells_where_it_was_looked_for() {
    let top = folder("missing");
    package(&top.join("src/arm_description"), "arm_description");
    let path = PackagePath::new(&[top.join("src")], &environment("AMENT_PREFIX_PATH", &[&top.join("install")]));
    let shown = |name: &str| path.find(name).unwrap_err().to_string().replace(&top.display().to_string(), "TOP");
    insta::assert_snapshot!(shown("arm_descripton"), @r#"package "arm_descripton" is not found; looked in TOP/src, TOP/install; did you mean "arm_description"?"#);
    insta::assert_snapshot!(shown("something_else"), @r#"package "something_else" is not found; looked in TOP/src, TOP/install; give the folder that holds it with ‹package-path›, or set ROS_PACKAGE_PATH"#);
    insta::assert_snapshot!(PackagePath::default().find("arm").unwrap_err().to_string(), @r#"package "arm" is not found; there are no folders to search; give the folder that holds it with ‹package-path›, or set ROS_PACKAGE_PATH"#);
    insta::assert_snapshot!(shown("../etc"), @r#""../etc" is not a package name; write letters, digits, "_" and "-" only"#);
    insta::assert_snapshot!(shown(""), @r#""" is not a package name; write letters, digits, "_" and "-" only"#);
}

#[test]
fn uris_become_files() {
    let top = folder("uris");
    package(&top.join("src/arm"), "arm");
    std::fs::create_dir_all(top.join("models/cup")).unwrap();
    let path = PackagePath::new(&[top.join("src")], &environment("GAZEBO_MODEL_PATH", &[&top.join("models")]));
    let from = top.join("src/arm/urdf/arm.urdf");
    let resolve = |uri: &str| path.resolve(uri, Some(&from));
    assert_eq!(resolve("package://arm/meshes/a b.stl"), Ok(top.join("src/arm/meshes/a b.stl")));
    assert_eq!(resolve("package://arm/meshes/a%20b.stl"), Ok(top.join("src/arm/meshes/a b.stl")));
    assert_eq!(resolve("package://arm//meshes/a.stl"), Ok(top.join("src/arm/meshes/a.stl")));
    assert_eq!(resolve("model://cup/cup.dae"), Ok(top.join("models/cup/cup.dae")));
    assert_eq!(resolve("model://arm/a.dae"), Ok(top.join("src/arm/a.dae")));
    assert_eq!(resolve("file:///opt/a%20b.stl"), Ok(PathBuf::from("/opt/a b.stl")));
    assert_eq!(resolve("/opt/a.stl"), Ok(PathBuf::from("/opt/a.stl")));
    assert_eq!(resolve("../meshes/a.stl"), Ok(top.join("src/arm/urdf/../meshes/a.stl")));
    insta::assert_snapshot!(resolve("http://example.com/a.stl").unwrap_err().to_string(), @r#""http://example.com/a.stl" does not refer to a file; write package://, file://, model:// or a path"#);
    insta::assert_snapshot!(resolve("file://relative/a.stl").unwrap_err().to_string(), @r#""file://relative/a.stl" does not refer to a file; write package://, file://, model:// or a path"#);
    assert!(resolve("package://no_such/a.stl").is_err());
}

#[cfg(unix)]
#[test]
fn links_out_of_a_package_are_followed_only_to_its_own_sources() {
    let top = folder("links");
    let body = "<robot xmlns:xacro='http://ros.org/wiki/xacro'><found/></robot>";
    // A build tool's install folder, linked to the sources file by file.
    package(&top.join("src/arm"), "arm");
    std::fs::create_dir_all(top.join("src/arm/urdf")).unwrap();
    std::fs::create_dir_all(top.join("install/share/arm/urdf")).unwrap();
    std::fs::write(top.join("src/arm/urdf/arm.xacro"), body).unwrap();
    std::fs::write(top.join("secret.xacro"), body).unwrap();
    for linked in ["package.xml", "urdf/arm.xacro"] {
        std::os::unix::fs::symlink(top.join("src/arm").join(linked), top.join("install/share/arm").join(linked))
            .unwrap();
    }
    std::os::unix::fs::symlink(top.join("secret.xacro"), top.join("install/share/arm/urdf/secret.xacro")).unwrap();
    let options = Options {
        packages: PackagePath::new(&[], &environment("AMENT_PREFIX_PATH", &[&top.join("install")])),
        ..Options::default()
    };
    let expand_file = |name: &str| {
        let text = crate::support::robot(&format!("<xacro:include filename='$(find arm)/urdf/{name}'/>"));
        expand(&Source::Text { name: "r".to_owned(), text, folder: Some(top.join("install")) }, &[], &options)
    };
    assert!(expand_file("arm.xacro").unwrap().urdf.contains("<found/>"));
    // The document's own folder is `install`, and `secret.xacro` is beside it.
    assert_eq!(expand_file("secret.xacro").unwrap_err().kind, denavit_xacro::ErrorKind::Access);
}
