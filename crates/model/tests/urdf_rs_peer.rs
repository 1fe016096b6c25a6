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
