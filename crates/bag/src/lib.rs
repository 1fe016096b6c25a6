//! ROS 2 bags (MCAP and SQLite) to the rows of a measurement file.
//!
//! ```text
//! messages ──► joint readings and places of a target ──► one clock ──► standstills ──► a row each
//! ```
//! A bag holds a robot's joint readings (`sensor_msgs/JointState`) and an instrument's readings of a target
//! (`geometry_msgs/PoseStamped`, `TransformStamped`, `PointStamped`, `tf2_msgs/TFMessage`). Neither ROS nor the definitions of
//! its messages are needed to read them. This crate knows only the names of the joints.

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

/// What to extract from a bag.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BagOptions {
    /// The robot's joints, as `JointState` names them.
    pub joints: Vec<String>,
    /// The topic of the joint readings, if several topics have these joints.
    pub joint_topic: Option<String>,
    /// The topic of the target, if there are several; `/tf:PARENT/CHILD` names one transform.
    pub target_topic: Option<String>,
}
