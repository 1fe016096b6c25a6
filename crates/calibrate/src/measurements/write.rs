//! Writing a measurement file: what [`super::read`] reads.

use super::Measurements;

/// The data as CSV text in m and rad, with `comments` on top, every number with all its digits.
pub fn write(data: &Measurements, comments: &[String]) -> String {
    let mut text = String::new();
    for comment in comments {
        text.push_str("# ");
        text.push_str(comment);
        text.push('\n');
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = data.joints.clone();
    let targets = &data.scene.targets;
    for series in &data.scene.series {
        header.extend(series.kind.columns(&targets[series.target]));
    }
    header.extend(data.covariates.iter().map(|column| column.name.clone()));
    header.extend(data.labels.iter().map(|column| column.name.clone()));
    let locates = data.locate.contains(&true);
    if locates {
        header.push("locate".into());
    }
    let to_memory = "writing to memory does not fail";
    writer.write_record(&header).expect(to_memory);
    for row in 0..data.len() {
        let mut cells: Vec<String> = data.reading(row).iter().map(f64::to_string).collect();
        for (index, series) in data.scene.series.iter().enumerate() {
            match data.of_row(row).find(|&observation| data.observed.series(observation) == index) {
                Some(observation) => {
                    let values = series.kind.to_cells(data.observed.values(observation));
                    cells.extend(values.iter().map(f64::to_string));
                }
                None => cells.extend(series.kind.columns(&targets[series.target]).iter().map(|_| String::new())),
            }
        }
        cells.extend(data.covariates.iter().map(|column| column.values[row].to_string()));
        cells.extend(data.labels.iter().map(|column| column.values[row].clone()));
        if locates {
            cells.push(u8::from(data.locate[row]).to_string());
        }
        writer.write_record(&cells).expect(to_memory);
    }
    let bytes = writer.into_inner().expect(to_memory);
    text.push_str(&String::from_utf8(bytes).expect("only UTF-8 was written"));
    text
}
