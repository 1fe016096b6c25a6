//! A camera and the board that it sees, from a file and words.

use super::MeasuredError;
use denavit_measurements::board::{Board, Sight};
use denavit_measurements::lens::Lens;

/// A camera from its file of intrinsics (name and text), the board in words (`7x5:30mm`), and whether the camera
/// sits on the hand.
///
/// # Errors
/// Intrinsics or a board that cannot be read.
pub fn sight(file: &str, text: &str, board: Option<&str>, on_hand: bool) -> Result<Sight, MeasuredError> {
    let read =
        |written: &str| written.parse::<Board>().map_err(|error| MeasuredError::Option(format!("‹board›: {error}")));
    let board = board.map(read).transpose()?;
    let lens = Lens::read(file, text).map_err(|error| MeasuredError::Option(error.to_string()))?;
    Ok(Sight { lens, on_hand, board })
}
