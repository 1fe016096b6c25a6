//! Recorded conversations with the server, in memory: question, place, answer.

mod editor;
mod own;
mod vendor;
