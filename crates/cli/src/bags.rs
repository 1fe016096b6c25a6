//! ROS 2 bags as files of measurements, where this build has them.

use crate::args::BagArguments;
use crate::failure::Failure;
use denavit_load::measured::DataFile;
use denavit_model::Chain;

#[cfg(feature = "bags")]
pub use denavit_bag::is_bag;

/// The rows that a bag makes.
#[cfg(feature = "bags")]
pub fn data_file(file: &str, arguments: &BagArguments, chain: &Chain) -> Result<DataFile, Failure> {
    use denavit_load::measured::HashedFile;
    let asked = denavit_bag::BagOptions {
        joints: chain.coordinates().iter().map(|coordinate| coordinate.name.clone()).collect(),
        joint_topic: arguments.joint_topic.clone(),
        target_topic: arguments.target_topic.clone(),
    };
    let rows = denavit_bag::rows(file, &asked)?;
    crate::measured::mention(&rows.notes.iter().map(|note| format!("{file}: {note}")).collect::<Vec<_>>());
    let unreadable = |error| denavit_bag::BagError::Open { file: file.into(), what: std::io::Error::to_string(&error) };
    let parts = denavit_bag::files(file)?.into_iter().map(|part| HashedFile::read(&part).map_err(unreadable));
    let bag = parts.collect::<Result<_, _>>()?;
    Ok(DataFile { name: file.into(), content: rows.csv.into(), bag, ..DataFile::default() })
}

/// Whether a name is that of a bag.
#[cfg(not(feature = "bags"))]
pub fn is_bag(file: &str) -> bool {
    let path = std::path::Path::new(file);
    path.join("metadata.yaml").is_file()
        || path.extension().is_some_and(|extension| extension == "mcap" || extension == "db3")
}

/// A build without bags says so.
#[cfg(not(feature = "bags"))]
pub fn data_file(_file: &str, _arguments: &BagArguments, _chain: &Chain) -> Result<DataFile, Failure> {
    Err(Failure::not_built("bags"))
}
