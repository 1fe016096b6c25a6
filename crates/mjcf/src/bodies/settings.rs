//! The settings of a model's `<compiler>`.

use crate::document::Item;
use crate::place::{Angles, fixed, number};

/// When a body's mass is that of its geoms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FromGeoms {
    Never,
    Always,
    WhereNoneIsStated,
}

/// MuJoCo's defaults, or what the model states.
#[derive(Debug, Clone)]
pub struct Settings {
    pub angles: Angles,
    pub auto_limits: bool,
    pub mesh_folder: String,
    pub from_geoms: FromGeoms,
    pub balance: bool,
    pub least_mass: f64,
    pub least_inertia: f64,
    pub total_mass: Option<f64>,
    /// Geoms of these groups have mass.
    pub groups: (i64, i64),
    strip_path: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            angles: Angles { unit: 1f64.to_radians(), sequence: "xyz".into() },
            auto_limits: true,
            mesh_folder: String::new(),
            from_geoms: FromGeoms::WhereNoneIsStated,
            balance: false,
            least_mass: 0.0,
            least_inertia: 0.0,
            total_mass: None,
            groups: (0, 5),
            strip_path: false,
        }
    }
}

fn choice(item: &Item, attribute: &str) -> Result<Option<bool>, String> {
    match item.get(attribute) {
        None => Ok(None),
        Some("true") => Ok(Some(true)),
        Some("false") => Ok(Some(false)),
        Some(word) => Err(format!("{attribute}=\"{word}\" is neither true nor false; write one of them")),
    }
}

impl Settings {
    /// Reads the settings of one `<compiler>`.
    pub fn read(&mut self, item: &Item) -> Result<(), String> {
        match item.get("angle") {
            None => {}
            Some("degree") => self.angles.unit = 1f64.to_radians(),
            Some("radian") => self.angles.unit = 1.0,
            Some(word) => return Err(format!("angle=\"{word}\" is not a unit; write degree or radian")),
        }
        if let Some(sequence) = item.get("eulerseq") {
            if sequence.chars().count() != 3 || !sequence.chars().all(|letter| "xyzXYZ".contains(letter)) {
                return Err(format!(
                    "eulerseq=\"{sequence}\" is not a valid sequence; write three letters of x, y, z, X, Y, Z"
                ));
            }
            sequence.clone_into(&mut self.angles.sequence);
        }
        if item.get("coordinate").is_some_and(|word| word != "local") {
            return Err("coordinate=\"global\" is no longer MJCF; save the model with a MuJoCo before 2.3.4".into());
        }
        if let Some(choice) = choice(item, "autolimits")? {
            self.auto_limits = choice;
        }
        if let Some(choice) = choice(item, "balanceinertia")? {
            self.balance = choice;
        }
        if let Some(choice) = choice(item, "strippath")? {
            self.strip_path = choice;
        }
        if let Some(folder) = item.get("meshdir").or_else(|| item.get("assetdir")) {
            folder.trim_end_matches('/').clone_into(&mut self.mesh_folder);
        }
        self.from_geoms = match item.get("inertiafromgeom") {
            None => self.from_geoms,
            Some("true") => FromGeoms::Always,
            Some("false") => FromGeoms::Never,
            Some("auto") => FromGeoms::WhereNoneIsStated,
            Some(word) => {
                return Err(format!("inertiafromgeom=\"{word}\" is not a valid value; write true, false or auto"));
            }
        };
        self.least_mass = number(item, "boundmass")?.unwrap_or(self.least_mass);
        self.least_inertia = number(item, "boundinertia")?.unwrap_or(self.least_inertia);
        self.total_mass = number(item, "settotalmass")?.filter(|total| *total > 0.0).or(self.total_mass);
        if let Some(range) = fixed::<2>(item, "inertiagrouprange")? {
            #[expect(clippy::cast_possible_truncation, reason = "groups are small whole numbers")]
            let range = (range[0] as i64, range[1] as i64);
            self.groups = range;
        }
        Ok(())
    }

    /// Whether a range is active: as stated, or, if that is `auto`, because it exists.
    pub fn limited(&self, item: &Item, attribute: &str, stated: bool) -> Result<bool, String> {
        match item.get(attribute) {
            Some("true") => Ok(true),
            Some("false") => Ok(false),
            None | Some("auto") => {
                if stated && !self.auto_limits {
                    // Without autolimits MuJoCo refuses a range that does not state whether it is active.
                    return Ok(false);
                }
                Ok(stated)
            }
            Some(word) => Err(format!("{attribute}=\"{word}\" is not a valid value; write true, false or auto")),
        }
    }

    /// A mesh file's path from the model's folder.
    pub fn mesh_path(&self, file: &str) -> String {
        let file = if self.strip_path { file.rsplit(['/', '\\']).next().unwrap_or(file) } else { file };
        if self.mesh_folder.is_empty() || file.starts_with('/') {
            file.to_owned()
        } else {
            format!("{}/{file}", self.mesh_folder)
        }
    }
}
