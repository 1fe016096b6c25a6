//! ROS 2 bags (MCAP and SQLite) to the rows of a measurement file.
//!
//! ```text
//! messages ──► joint readings and places of a target ──► one clock ──► standstills ──► a row each
//! ```
//! A bag holds what the robot said of its joints (`sensor_msgs/JointState`) and what an instrument said of a target
//! (`geometry_msgs/PoseStamped`, `TransformStamped`, `PointStamped`, `tf2_msgs/TFMessage`). Neither ROS nor the definitions of
//! its messages are needed to read them. This crate knows no robots: it is told names of joints.

mod cdr;
mod clock;
mod error;
mod messages;
mod rows;
mod standstill;
mod storage;
mod tracks;

pub use error::BagError;
pub use rows::{Rows, rows};
pub use storage::{files, is_bag};

/// What to take out of a bag.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BagOptions {
    /// The robot's joints, as `JointState` names them.
    pub joints: Vec<String>,
    /// The topic of the joint readings, where several have these joints.
    pub joint_topic: Option<String>,
    /// The topic of the target, where there are several; `/tf:PARENT/CHILD` names a transform among others.
    pub target_topic: Option<String>,
}
