//! Calibrated URDFs: every robot at hand, its chain disturbed as a calibration would.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use crate::urdf_corpus::{corpus, random};
use denavit_export::urdf::with_chain;
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::screw::{Pitch, Screw};
use denavit_model::tree::Reading;
use denavit_model::{Chain, se3, urdf};

fn disturbed(chain: &Chain, next: &mut impl FnMut() -> f64, with_pitch: bool) -> Chain {
    let mut small = |size: f64| se3::exp(&(Vector6::from_fn(|_, _| next() - 0.5) * size));
    let screws: Vec<Screw> = chain
        .joints()
        .iter()
        .map(|joint| match joint.screw.moved(&small(1e-2)) {
            Screw::Helical { axis, pitch } if with_pitch => {
                let pitch = Pitch::from_metres_per_radian(pitch.metres_per_radian() * 1.001).unwrap();
                Screw::Helical { axis, pitch }
            }
            screw => screw,
        })
        .collect();
    let home = small(1e-2) * chain.home();
    chain.with_geometry(&screws, home).unwrap()
}

#[test]
fn a_calibrated_urdf_moves_as_the_calibrated_chain() {
    let mut next = random(11);
    let (mut robots, mut new_tips, mut worst) = (0, 0, 0.0f64);
    for path in corpus() {
        let file = path.display().to_string();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let Ok(robot) = urdf::read(&file, &text) else { continue };
        let Ok(nominal) = robot.chain(None, None, Reading::Intended) else { continue };
        let planar = nominal.notes.iter().any(|note| note.to_string().contains("planar joint: becomes"));
        if planar || nominal.value.joints().is_empty() {
            continue;
        }
        let calibrated = disturbed(&nominal.value, &mut next, true);
        let made = match with_chain(&robot, &calibrated, Reading::Intended) {
            Ok(made) => made,
            Err(error) => panic!("{file}: {error}"),
        };
        robots += 1;
        new_tips += made.notes.len();
        let tip = if made.notes.is_empty() {
            calibrated.tip().to_owned()
        } else {
            format!("{}_calibrated", calibrated.tip())
        };
        let again = urdf::read(&file, &made.value).unwrap();
        let chain = again.chain(Some(calibrated.base()), Some(&tip), Reading::Intended).unwrap().value;
        for _ in 0..20 {
            let q: Vec<f64> = chain.coordinates().iter().map(|_| 2.0 * next() - 1.0).collect();
            let (turned, moved) = se3::difference(&chain.fk(&q), &calibrated.fk(&q));
            worst = worst.max(turned).max(moved / calibrated.size());
        }
        let links = |robot: &denavit_model::Robot| {
            robot
                .links
                .iter()
                .map(|link| (link.name.clone(), link.inertial.clone(), link.visuals.clone()))
                .filter(|(name, ..)| *name != tip || made.notes.is_empty())
                .collect::<Vec<_>>()
        };
        assert_eq!(links(&robot), links(&again), "{file}");
    }
    assert!(robots > 0, "robots/ holds some at least");
    println!("{robots} calibrated robots ({new_tips} with a new tip link), largest difference {worst:.1e}");
    assert!(worst < 1e-12, "{worst}");
}

const ARM: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="upper"/> <!-- aluminium -->
  <link name="tool"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/> <child link="upper"/>
    <origin xyz="0.0 0.00 0.300"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="upper"/> <child link="tool"/>
    <origin xyz="0.5 0 0" rpy="0 0 0"/>
  </joint>
</robot>"#;

#[test]
fn nothing_changes_but_joint_origins() {
    let robot = urdf::read("arm.urdf", ARM).unwrap();
    let nominal = robot.chain(None, None, Reading::Intended).unwrap().value;
    let same = with_chain(&robot, &nominal, Reading::Intended).unwrap().value;
    assert_eq!(same, ARM);
    let shift = se3::translation(Vector3::new(0.001, 0.0, 0.002));
    let screws: Vec<Screw> = nominal.joints().iter().map(|joint| joint.screw.moved(&shift)).collect();
    let calibrated = nominal.with_geometry(&screws, shift * nominal.home()).unwrap();
    let made = with_chain(&robot, &calibrated, Reading::Intended).unwrap().value;
    assert_eq!(made, ARM.replace("0.0 0.00 0.300", "0.001 0.00 0.302"));
}

#[test]
fn what_a_urdf_cannot_say_is_refused() {
    let robot = urdf::read("arm.urdf", ARM).unwrap();
    let nominal = robot.chain(None, None, Reading::Intended).unwrap().value;
    let mut joints = nominal.joints().to_vec();
    joints[0].scale = 1.002;
    let names = (nominal.name(), nominal.base(), nominal.tip());
    let scaled = Chain::new(names, nominal.coordinates().to_vec(), joints, *nominal.home()).unwrap();
    let message = with_chain(&robot, &scaled, Reading::Intended).unwrap_err().to_string();
    assert_eq!(message, "joint \"shoulder\": joint scale 1.002 cannot be written in URDF; apply it in the controller");
}
