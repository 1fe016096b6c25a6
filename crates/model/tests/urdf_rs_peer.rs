//! Our reading of URDF beside urdf-rs', on every file that both take.

#![allow(clippy::unwrap_used, reason = "a test that cannot make its input has failed")]

use std::path::{Path, PathBuf};

fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "urdf") {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn both_read_the_same_joints_and_masses() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = files(&top.join("robots"));
    let own = found.len();
    found.extend(files(&top.join("../shared/vendor/robots")));
    if found.len() == own {
        println!("vendors' files skipped, because ../shared/vendor is not beside this clone");
    }
    let (mut compared, mut ours_alone) = (0, Vec::new());
    for path in &found {
        let text = std::fs::read_to_string(path).unwrap();
        let Ok(ours) = denavit_model::urdf::read(path.to_str().unwrap(), &text) else { continue };
        let Ok(theirs) = urdf_rs::read_from_string(&text) else {
            ours_alone.push(path.display().to_string());
            continue;
        };
        compared += 1;
        assert_eq!(ours.joints.len(), theirs.joints.len(), "{}", path.display());
        for (a, b) in ours.joints.iter().zip(&theirs.joints) {
            let place = format!("{} {}", path.display(), a.name);
            assert_eq!(a.name, b.name, "{place}");
            assert_eq!((a.origin.xyz, a.origin.rpy), (b.origin.xyz.0, b.origin.rpy.0), "{place}");
            assert_eq!(a.axis_written.unwrap_or([1.0, 0.0, 0.0]), b.axis.xyz.0, "{place}");
            assert_eq!(ours.links[a.parent].name, b.parent.link, "{place}");
            assert_eq!(ours.links[a.child].name, b.child.link, "{place}");
            let multiplier = b.mimic.as_ref().map(|mimic| (mimic.joint.clone(), mimic.multiplier.unwrap_or(1.0)));
            assert_eq!(a.mimic.as_ref().map(|mimic| (mimic.joint.clone(), mimic.multiplier)), multiplier, "{place}");
        }
        for (a, b) in ours.links.iter().zip(&theirs.links) {
            assert_eq!(
                a.inertial.as_ref().map_or(0.0, |inertial| inertial.mass),
                b.inertial.mass.value,
                "{} {}",
                path.display(),
                a.name
            );
            assert_eq!(
                (a.visuals.len(), a.collisions.len()),
                (b.visual.len(), b.collision.len()),
                "{} {}",
                path.display(),
                a.name
            );
        }
    }
    println!("{compared} files read alike; {} that urdf-rs refuses: {}", ours_alone.len(), ours_alone.join(", "));
    assert!(compared >= own);
}

/// The textures of a robot, taken from it.
fn textures(robot: &mut urdf_rs::Robot) -> Vec<Option<String>> {
    let of_links = robot.links.iter_mut().flat_map(|link| &mut link.visual).filter_map(|it| it.material.as_mut());
    robot.materials.iter_mut().chain(of_links).map(|it| it.texture.take().map(|it| it.filename)).collect()
}

/// What urdf-rs leaves open or keeps infinite, as it reads once it went through us.
fn as_we_write(mut robot: urdf_rs::Robot) -> urdf_rs::Robot {
    robot.version = None;
    for joint in &mut robot.joints {
        let limit = &mut joint.limit;
        if !(limit.lower.is_finite() && limit.upper.is_finite()) {
            (limit.lower, limit.upper) = (0.0, 0.0);
        }
        for bound in [&mut limit.velocity, &mut limit.effort] {
            *bound = if bound.is_finite() { *bound } else { 0.0 };
        }
        if !limit.deceleration.is_finite() {
            limit.deceleration = limit.acceleration;
        }
        if let Some(mimic) = &mut joint.mimic {
            (mimic.multiplier, mimic.offset) = (mimic.multiplier.or(Some(1.0)), mimic.offset.or(Some(0.0)));
        }
    }
    for shape in robot.links.iter_mut().flat_map(|link| {
        link.visual.iter_mut().map(|it| &mut it.geometry).chain(link.collision.iter_mut().map(|it| &mut it.geometry))
    }) {
        if let urdf_rs::Geometry::Mesh { scale, .. } = shape {
            *scale = scale.filter(|scale| scale.0 != [1.0; 3]);
        }
    }
    robot
}

#[test]
fn robots_go_to_urdf_rs_and_back_and_move_as_before() {
    use denavit_model::{Reading, Robot, se3};
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = files(&top.join("robots"));
    let own = found.len();
    found.extend(files(&top.join("../shared/vendor/robots")));
    let mut gone_through = 0;
    for path in &found {
        let place = path.display().to_string();
        let text = std::fs::read_to_string(path).unwrap();
        let Ok(mut theirs) = urdf_rs::read_from_string(&text) else { continue };
        // What urdf-rs takes and we do not is no tree.
        let Ok(ours) = denavit_model::urdf::read(&place, &text) else { continue };
        let through = Robot::from_urdf_rs(&theirs).unwrap_or_else(|error| panic!("{place}: {error}"));
        let mut back = through.to_urdf_rs().unwrap_or_else(|error| panic!("{place}: {error}"));
        // A link that joints name and the file does not declare is a link for us.
        back.links.retain(|link| theirs.links.iter().any(|known| known.name == link.name));
        // urdf-rs cannot write a texture that it has read.
        assert_eq!(textures(&mut back), textures(&mut theirs), "{place}");
        let written = |robot: urdf_rs::Robot| urdf_rs::write_to_string(&as_we_write(robot)).unwrap();
        let (back, theirs) = (written(back), written(theirs));
        // Line by line: the first that differs says more than two robots side by side.
        for (number, (ours, urdf_rs)) in back.lines().zip(theirs.lines()).enumerate() {
            assert_eq!(ours, urdf_rs, "{place}: line {number} of what is written");
        }
        assert_eq!(back.len(), theirs.len(), "{place}");
        for listing in ours.leaf_chains() {
            let chain = |robot: &Robot| {
                let chain = robot.chain(Some(&listing.base), Some(&listing.tip), Reading::AsWritten);
                chain.ok().map(|noted| noted.value)
            };
            let (Some(one), Some(other)) = (chain(&ours), chain(&through)) else { continue };
            let q = vec![0.3; one.coordinates().len()];
            let (turned, moved) = se3::difference(&one.fk(&q), &other.fk(&q));
            assert!(turned < 1e-12 && moved < 1e-12, "{place}: {turned} {moved}");
        }
        gone_through += 1;
    }
    println!("{gone_through} robots went to urdf-rs and back");
    assert!(gone_through >= own);
}

#[test]
fn what_we_write_reads_back_as_it_was() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = files(&top.join("robots"));
    found.extend(files(&top.join("../shared/vendor/robots")));
    for path in &found {
        let place = path.display().to_string();
        let Ok(robot) = denavit_model::urdf::read(&place, &std::fs::read_to_string(path).unwrap()) else { continue };
        let again = denavit_model::urdf::read(&place, &denavit_model::write::urdf(&robot)).unwrap();
        // Places in the text are others; all that they are places of is the same.
        let plain = |robot: &denavit_model::Robot| {
            let (mut links, mut joints, mut elements) =
                (robot.links.clone(), robot.joints.clone(), robot.elements.clone());
            for link in &mut links {
                link.at = 0;
            }
            for joint in &mut joints {
                joint.at = 0;
            }
            let of_links = links.iter_mut().flat_map(|link| {
                let shapes = link.visuals.iter_mut().chain(&mut link.collisions);
                shapes.flat_map(|shape| &mut shape.elements).chain(&mut link.elements)
            });
            let of_joints = joints.iter_mut().flat_map(|joint| &mut joint.elements);
            of_links.chain(of_joints).chain(&mut elements).for_each(|element| element.at = 0);
            for link in &mut links {
                let shapes = link.visuals.iter_mut().chain(&mut link.collisions).map(|shape| &mut shape.origin);
                shapes.chain(link.inertial.as_mut().map(|it| &mut it.origin)).for_each(|it| it.rpy_written = None);
            }
            for joint in &mut joints {
                joint.origin.rpy_written = None;
                joint.axis_meant = None;
            }
            format!("{links:?} {joints:?} {elements:?} {}", robot.root)
        };
        assert_eq!(plain(&robot), plain(&again), "{place}");
    }
}
