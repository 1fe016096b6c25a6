//! docs/fleet-store.md shows the tables as they are.

#[test]
fn the_page_shows_the_tables() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/fleet-store.md");
    let page = std::fs::read_to_string(&file).unwrap();
    let (before, rest) = page.split_once("<!-- tables -->\n").unwrap();
    let (shown, after) = rest.split_once("<!-- /tables -->").unwrap();
    let tables = denavit_fleet::store::schema::markdown();
    if shown != tables {
        assert!(
            std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always"),
            "docs/fleet-store.md is out of date; INSTA_UPDATE=always cargo test -p denavit-fleet the_page_shows writes it"
        );
        std::fs::write(file, format!("{before}<!-- tables -->\n{tables}<!-- /tables -->{after}")).unwrap();
    }
}
