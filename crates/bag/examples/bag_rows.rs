//! The standstills of a ROS 2 bag as rows of a measurement file: `bag_rows BAG JOINT…`.

use denavit_bag::{BagOptions, rows};

#[expect(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = std::env::args().skip(1);
    let bag = words.next().ok_or("usage: bag_rows BAG JOINT…")?;
    let found = rows(&bag, &BagOptions { joints: words.collect(), ..BagOptions::default() })?;
    for note in &found.notes {
        eprintln!("{note}");
    }
    print!("{}", found.csv);
    Ok(())
}
