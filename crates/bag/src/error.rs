//! Why a bag cannot be converted to rows.

use thiserror::Error;

/// Why a bag cannot be converted to rows.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BagError {
    /// A file that cannot be opened.
    #[error("{file}: {what}")]
    Open {
        /// The file.
        file: String,
        /// What the system says.
        what: String,
    },
    /// A folder without a bag.
    #[error("{folder}: there is no .mcap and no .db3 file in this folder; name the folder that ros2 bag record made")]
    NoBag {
        /// The folder.
        folder: String,
    },
    /// Files that were compressed as a whole.
    #[error("{file}: the whole file is compressed; decompress it first: zstd -d {file}")]
    Compressed {
        /// The file.
        file: String,
    },
    /// Messages that were compressed one by one.
    #[error("{file}: its messages are compressed; rewrite the bag without compression: ros2 bag convert")]
    CompressedMessages {
        /// The file.
        file: String,
    },
    /// A file that is not a bag, or is damaged.
    #[error("{file}: this bag cannot be read ({what}); is the recording complete? ros2 bag reindex may repair it")]
    Broken {
        /// The file.
        file: String,
        /// What the reader says.
        what: String,
    },
    /// A message that does not hold what its type says.
    #[error(
        "{file}: message {number} of {topic} is not a {kind}: it ends too early or names an unknown encoding; record it again"
    )]
    Message {
        /// The file.
        file: String,
        /// Its topic.
        topic: String,
        /// Counted from 1 among those of the topic.
        number: usize,
        /// The type that it should have.
        kind: String,
    },
    /// No joint readings of the robot.
    #[error("{file}: no sensor_msgs/JointState names all of the joints {wanted}; {found}")]
    NoJoints {
        /// The file.
        file: String,
        /// The robot's joints.
        wanted: String,
        /// What is there instead.
        found: String,
    },
    /// Nothing that measures a target.
    #[error(
        "{file}: no topic is a PoseStamped, TransformStamped, PointStamped or tf2_msgs/TFMessage; there are {found}; record \
         the instrument's topic as well"
    )]
    NoTarget {
        /// The file.
        file: String,
        /// The topics that are there.
        found: String,
    },
    /// Several topics are possible.
    #[error("{file}: several topics may be {what}: {found}; choose one with {option}")]
    Several {
        /// The file.
        file: String,
        /// What is looked for.
        what: &'static str,
        /// The topics.
        found: String,
        /// The option that chooses.
        option: &'static str,
    },
    /// A topic that is not there.
    #[error("{file}: {option} {topic}: there is no such topic of {what}; there are {found}")]
    NoTopic {
        /// The file.
        file: String,
        /// The option.
        option: &'static str,
        /// The topic asked for.
        topic: String,
        /// What is looked for.
        what: &'static str,
        /// The topics.
        found: String,
    },
    /// A clock that was set while the bag was recorded.
    #[error(
        "{file}: the clock of {topic} jumps by {seconds} s at its message {number}, so its readings cannot be put in order; record \
         again after the clocks were synchronised, or keep one side of the jump (ros2 bag convert)"
    )]
    ClockJumps {
        /// The file.
        file: String,
        /// The topic.
        topic: String,
        /// How far, s.
        seconds: String,
        /// Counted from 1 among those of the topic.
        number: usize,
    },
    /// The motions of joints and target do not correlate.
    #[error(
        "{file}: {target} does not move when the joints of {joints} do (correlation {correlation}); is it the target on this \
         robot, and was it recorded at the same time?"
    )]
    Unrelated {
        /// The file.
        file: String,
        /// The topic of the target.
        target: String,
        /// The topic of the joints.
        joints: String,
        /// Of their speeds, at the best offset of the clocks.
        correlation: String,
    },
    /// The robot never stood still while the target was seen.
    #[error(
        "{file}: the robot never stands still for {least} s while the target is seen; stop at each pose for a second or two"
    )]
    NoStandstill {
        /// The file.
        file: String,
        /// The shortest standstill, s.
        least: String,
    },
}
