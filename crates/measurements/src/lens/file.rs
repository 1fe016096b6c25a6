//! A camera's intrinsics as ROS (`camera_info`) and OpenCV (`FileStorage`) write them: YAML.

use super::{Distortion, Lens};
use denavit_model::nalgebra::Matrix3;
use saphyr_parser::{Event, Parser};
use thiserror::Error;

/// Why a file of intrinsics cannot be read.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LensError {
    /// Not YAML.
    #[error("{file}:{line}: {what}; give the camera's intrinsics as ROS (camera_info) or OpenCV write them, in YAML")]
    Yaml {
        /// The file's name.
        file: String,
        /// Where, counted from 1.
        line: usize,
        /// What the parser says.
        what: String,
    },
    /// A part is missing.
    #[error("{file}: there is no {key}; give the camera's intrinsics as ROS (camera_info) or OpenCV write them")]
    Missing {
        /// The file's name.
        file: String,
        /// What is missing.
        key: &'static str,
    },
    /// A text where a number must be.
    #[error("{file}:{line}: {key}: \"{text}\" is not a finite number")]
    NotANumber {
        /// The file's name.
        file: String,
        /// Where.
        line: usize,
        /// The list that it is in.
        key: String,
        /// The text.
        text: String,
    },
    /// A list of another length.
    #[error("{file}: {key} has {found} numbers; {expected}")]
    Count {
        /// The file's name.
        file: String,
        /// The list.
        key: &'static str,
        /// Its length.
        found: usize,
        /// What it should have.
        expected: &'static str,
    },
    /// A matrix that is not a camera's.
    #[error("{file}: camera_matrix is not fx 0 cx, 0 fy cy, 0 0 1 with fx and fy above 0, row by row")]
    NotACamera {
        /// The file's name.
        file: String,
    },
    /// An unsupported model of distortion.
    #[error(
        "{file}: the distortion model \"{model}\" is not known; it must be plumb_bob, rational_polynomial or equidistant"
    )]
    Model {
        /// The file's name.
        file: String,
        /// Its name.
        model: String,
    },
    /// A sensor that is tilted relative to the lens.
    #[error(
        "{file}: a tilted sensor (the 13th and 14th number of the distortion) is not supported; calibrate without it"
    )]
    Tilted {
        /// The file's name.
        file: String,
    },
}

const MATRIX: [&str; 5] = ["camera_matrix", "k", "cameramatrix", "intrinsic_matrix", "mtx"];
const DISTORTION: [&str; 6] =
    ["distortion_coefficients", "d", "distcoeffs", "dist_coeffs", "distortion_coeffs", "dist"];
const MODEL: [&str; 2] = ["distortion_model", "camera_model"];
const WIDTH: [&str; 2] = ["image_width", "width"];
const HEIGHT: [&str; 2] = ["image_height", "height"];

/// A scalar: the keys above it in lower case, its text, and its line.
type Scalar = (Vec<String>, String, usize);

impl Lens {
    /// Reads intrinsics: `camera_matrix` (or `k`), `distortion_coefficients` (or `d`), `distortion_model`, the image's size.
    ///
    /// Without a model, OpenCV's polynomial with this number of coefficients is assumed.
    ///
    /// # Errors
    /// The text is not YAML, or a part is missing or invalid.
    pub fn read(file: &str, text: &str) -> Result<Self, LensError> {
        let scalars = scalars(file, text)?;
        let list = |names: &[&str]| numbers(file, &scalars, names);
        let matrix = list(&MATRIX)?.ok_or_else(|| LensError::Missing { file: file.into(), key: "camera_matrix" })?;
        if matrix.len() != 9 {
            let (file, key, found) = (file.to_owned(), "camera_matrix", matrix.len());
            return Err(LensError::Count { file, key, found, expected: "it must have 9, row by row" });
        }
        let matrix = Matrix3::from_row_slice(&matrix);
        let bottom = [matrix[(1, 0)], matrix[(2, 0)], matrix[(2, 1)], matrix[(2, 2)] - 1.0];
        if matrix[(0, 0)] <= 0.0 || matrix[(1, 1)] <= 0.0 || bottom != [0.0; 4] {
            return Err(LensError::NotACamera { file: file.into() });
        }
        let model = scalars.iter().find(|(path, _, _)| path.last().is_some_and(|key| MODEL.contains(&key.as_str())));
        let coefficients = list(&DISTORTION)?.unwrap_or_default();
        let distortion = distortion(file, model.map(|(_, text, _)| text.as_str()), &coefficients)?;
        let size = match (list(&WIDTH)?.as_deref(), list(&HEIGHT)?.as_deref()) {
            (Some([width]), Some([height])) if *width > 0.0 && *height > 0.0 => Some([*width, *height]),
            _ => None,
        };
        Ok(Self { matrix, distortion, size })
    }
}

fn distortion(file: &str, model: Option<&str>, numbers: &[f64]) -> Result<Distortion, LensError> {
    let polynomial = |most: usize, expected: &'static str| {
        if ![0, 4, 5, 8, 12, 14].contains(&numbers.len()) || numbers.len() > most {
            let (file, key, found) = (file.to_owned(), "distortion_coefficients", numbers.len());
            return Err(LensError::Count { file, key, found, expected });
        }
        if numbers.iter().skip(12).any(|tilt| *tilt != 0.0) {
            return Err(LensError::Tilted { file: file.into() });
        }
        let mut all = [0.0; 12];
        all.iter_mut().zip(numbers).for_each(|(own, number)| *own = *number);
        Ok(Distortion::Polynomial(all))
    };
    match model.map(|model| model.trim().to_lowercase().replace([' ', '-'], "_")).as_deref() {
        None | Some("" | "none" | "pinhole") => polynomial(14, "OpenCV has 4, 5, 8, 12 or 14 of them"),
        Some("plumb_bob" | "radtan" | "radial_tangential") => polynomial(5, "plumb_bob has 5: k1, k2, p1, p2, k3"),
        Some("rational_polynomial" | "rational" | "thin_prism") => {
            polynomial(14, "rational_polynomial has 8: k1, k2, p1, p2, k3, k4, k5, k6")
        }
        Some("equidistant" | "fisheye" | "kannala_brandt" | "kannala_brandt4") => match *numbers {
            [k1, k2, k3, k4] => Ok(Distortion::Fisheye([k1, k2, k3, k4])),
            _ => Err(LensError::Count {
                file: file.into(),
                key: "distortion_coefficients",
                found: numbers.len(),
                expected: "equidistant has 4: k1, k2, k3, k4",
            }),
        },
        Some(other) => Err(LensError::Model { file: file.into(), model: other.into() }),
    }
}

/// The numbers of a list: directly below one of these keys, or in its `data`; `None` where there is no such key.
fn numbers(file: &str, scalars: &[Scalar], names: &[&str]) -> Result<Option<Vec<f64>>, LensError> {
    let mut found: Option<Vec<f64>> = None;
    for (path, text, line) in scalars {
        let own = match &path[..] {
            [key] => key,
            [key, data] if data == "data" => key,
            _ => continue,
        };
        if !names.contains(&own.as_str()) {
            continue;
        }
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| LensError::NotANumber {
            file: file.into(),
            line: *line,
            key: own.clone(),
            text: text.clone(),
        })?;
        found.get_or_insert_default().push(number);
    }
    Ok(found)
}

/// The open node: a mapping, with the key whose value comes next, or a list.
enum Open {
    Map(bool),
    List,
}

/// The scalars of the first document that is not empty.
fn scalars(file: &str, text: &str) -> Result<Vec<Scalar>, LensError> {
    // OpenCV's first line, "%YAML:1.0", is not a YAML directive.
    let lines = text.lines().map(|line| if line.starts_with('%') { "" } else { line });
    let text = lines.collect::<Vec<&str>>().join("\n");
    let (mut open, mut path, mut all): (Vec<Open>, Vec<String>, Vec<Scalar>) = (Vec::new(), Vec::new(), Vec::new());
    for event in Parser::new_from_str(&text) {
        let (event, span) = event.map_err(|error| LensError::Yaml {
            file: file.into(),
            line: error.marker().line(),
            what: error.info().into(),
        })?;
        match event {
            Event::MappingStart(..) => open.push(Open::Map(false)),
            Event::SequenceStart(..) => open.push(Open::List),
            Event::MappingEnd | Event::SequenceEnd => {
                open.pop();
                if let Some(Open::Map(named)) = open.last_mut()
                    && std::mem::take(named)
                {
                    path.pop();
                }
            }
            Event::Scalar(value, ..) => match open.last_mut() {
                Some(Open::Map(named)) => {
                    if std::mem::take(named) {
                        all.push((path.clone(), value.into_owned(), span.start.line()));
                        path.pop();
                    } else {
                        path.push(value.to_lowercase());
                        *named = true;
                    }
                }
                _ => all.push((path.clone(), value.into_owned(), span.start.line())),
            },
            Event::DocumentEnd if !all.is_empty() => break,
            _ => {}
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROS: &str = "image_width: 640\nimage_height: 480\ncamera_name: webcam\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
                       data: [600.5, 0., 320, 0, 601, 240, 0, 0, 1]\ndistortion_model: plumb_bob\n\
                       distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, -0.2, 0.001, 0.002, 0]\n";
    const OPENCV: &str = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   \
                          cols: 3\n   dt: d\n   data: [ 600.5, 0., 320., 0., 601., 240., 0.,\n       0., 1. ]\n\
                          distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0.1, -0.2, \
                          1.0e-03, 2.0e-03, 0. ]\n";
    const MESSAGE: &str = "header:\n  frame_id: cam\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nd:\n- 0.1\n- -0.2\n\
                           - 0.001\n- 0.002\n- 0.0\nk:\n- 600.5\n- 0.0\n- 320.0\n- 0.0\n- 601.0\n- 240.0\n- 0.0\n- 0.0\n\
                           - 1.0\nr:\n- 1.0\n---\n";

    #[test]
    fn three_ways_of_writing_one_camera() {
        let expected = Lens {
            matrix: Matrix3::new(600.5, 0.0, 320.0, 0.0, 601.0, 240.0, 0.0, 0.0, 1.0),
            distortion: Distortion::Polynomial([0.1, -0.2, 1e-3, 2e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            size: Some([640.0, 480.0]),
        };
        for text in [ROS, OPENCV, MESSAGE] {
            assert_eq!(Lens::read("c.yaml", text).unwrap(), expected);
        }
    }

    #[test]
    fn fisheyes_have_four_numbers() {
        let text = ROS.replace("plumb_bob", "equidistant").replace("0.002, 0]", "0.002]");
        let lens = Lens::read("c.yaml", &text).unwrap();
        assert_eq!(lens.distortion, Distortion::Fisheye([0.1, -0.2, 1e-3, 2e-3]));
    }

    #[test]
    fn every_mistake_is_named() {
        let said = |text: &str| Lens::read("c.yaml", text).unwrap_err().to_string();
        assert_eq!(
            said("a: 1\n"),
            "c.yaml: there is no camera_matrix; give the camera's intrinsics as ROS (camera_info) or OpenCV write them"
        );
        assert!(said("a: [1\nb: {").starts_with("c.yaml:"));
        assert_eq!(said(&ROS.replace("601", "wide")), "c.yaml:7: camera_matrix: \"wide\" is not a finite number");
        assert_eq!(
            said(&ROS.replace("0, 0, 1]", "0, 1]")),
            "c.yaml: camera_matrix has 8 numbers; it must have 9, row by row"
        );
        assert!(said(&ROS.replace("600.5", "-600.5")).contains("fx and fy above 0"));
        assert_eq!(
            said(&ROS.replace("0.002, 0]", "0.002, 0, 1]")),
            "c.yaml: distortion_coefficients has 6 numbers; plumb_bob has 5: k1, k2, p1, p2, k3"
        );
        assert!(said(&ROS.replace("plumb_bob", "mei")).contains("the distortion model \"mei\" is not known"));
        assert!(said(&ROS.replace("plumb_bob", "equidistant")).ends_with("equidistant has 4: k1, k2, k3, k4"));
    }
}
