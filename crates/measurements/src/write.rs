//! Writing a measurement file that [`super::read`] reads.

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
    // The same columns serve all setups.
    let mut groups: Vec<(Vec<String>, Vec<usize>)> = Vec::new();
    for (index, series) in data.scene.series.iter().enumerate() {
        let target = data.scene.number_of(series.target).split('@').next().unwrap_or("");
        let columns = series.kind.columns(series.corner.as_ref().map_or(target, |corner| &corner.label));
        match groups.iter_mut().find(|group| group.0 == columns) {
            Some(group) => group.1.push(index),
            None => groups.push((columns, vec![index])),
        }
    }
    header.extend(groups.iter().flat_map(|group| group.0.iter().cloned()));
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
        for (columns, series) in &groups {
            match data.of_row(row).find(|&observation| series.contains(&data.observed.series(observation))) {
                Some(observation) => {
                    let values = data.series_of(observation).kind.to_cells(data.observed.values(observation));
                    cells.extend(values.iter().map(f64::to_string));
                }
                None => cells.extend(columns.iter().map(|_| String::new())),
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
