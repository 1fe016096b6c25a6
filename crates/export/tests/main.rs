//! Pages and URDF as they are written, seen from outside: one binary, a module for each subject.

mod makers;
mod page_content;
mod page_written;
mod sources;
mod urdf_calibrated;
mod urdf_canonical;
mod urdf_corpus;
mod urdf_parts;
mod urdf_tables;
