//! Latency of the server: `cargo run --release -p denavit-lsp --example latency -- FILE…`
//!
//! Opens each file, and changes a number in it and back; prints the median time from the change to the problems, and of
//! each request, in ms. On a busy machine run it with high priority (`chrt -f 10`), to measure what a user sees.

use denavit_lsp::{Connection, serve};
use lsp_server::{Message, Notification, Request};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

/// Number of rounds for the median.
const ROUNDS: usize = 11;

fn main() {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let mut out = String::from(
        "| file | kB | open | problems as you type | hover | definition | completion | outline | format |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for file in &files {
        out.push_str(&row(file));
    }
    #[allow(clippy::print_stdout)]
    {
        println!("{out}");
    }
}

fn row(file: &str) -> String {
    let (client, server) = Connection::memory();
    std::thread::spawn(move || serve(&server, "0.0.0"));
    let mut next = 0;
    let mut ask = |method: &str, params: Value| {
        next += 1;
        client
            .sender
            .send(Request { id: next.into(), method: method.to_owned(), params }.into())
            .expect("the server listens");
        loop {
            if let Message::Response(response) = client.receiver.recv().expect("the server answers") {
                return response.response_result;
            }
        }
    };
    let tell = |method: &str, params: Value| {
        client.sender.send(Notification::new(method.to_owned(), params).into()).expect("the server listens");
    };
    // Waits for the problems that follow a change: what is asked is answered after them.
    let _ = ask("initialize", json!({"capabilities": {}}));
    tell("initialized", json!({}));
    let text = std::fs::read_to_string(file).expect("the file can be read");
    let path = Path::new(file).canonicalize().expect("the file is there");
    let uri = format!("file://{}", path.display());
    let start = Instant::now();
    tell(
        "textDocument/didOpen",
        json!({"textDocument": {"uri": uri, "languageId": "urdf", "version": 1, "text": text}}),
    );
    let _ = ask("nothing", json!({}));
    let open = milliseconds(start);
    // A number: in SDF it is the text of an element, else the value of an attribute.
    let numbers = ["xyz=\"", "<pose>", "pos=\""];
    let at = numbers.iter().find_map(|words| Some(text.find(words)? + words.len())).expect("a place in the file");
    let place = |at: usize| {
        let before = &text[..at];
        json!({"line": before.matches('\n').count(), "character": at - before.rfind('\n').map_or(0, |end| end + 1)})
    };
    let typed: Vec<f64> = (0..ROUNDS)
        .map(|round| {
            let end = if round % 2 == 0 { at } else { at + 1 };
            let change = json!({"range": {"start": place(at), "end": place(end)}, "text": if round % 2 == 0 { "1" } else { "" }});
            let start = Instant::now();
            tell("textDocument/didChange", json!({"textDocument": {"uri": uri, "version": 2}, "contentChanges": [change]}));
            let _ = ask("nothing", json!({}));
            milliseconds(start)
        })
        .collect();
    let named =
        text.find("<joint").and_then(|at| Some(at + text[at..].find("name=\"")? + "name=\"".len() + 1)).unwrap_or(at);
    let parent =
        text.find("<parent").and_then(|at| Some(at + text[at..].find("link=\"")? + "link=\"".len())).unwrap_or(at);
    let mut measured = |method: &str, at: usize| {
        let times = (0..ROUNDS).map(|_| {
            let start = Instant::now();
            let options = json!({"tabSize": 2, "insertSpaces": true});
            let _ = ask(method, json!({"textDocument": {"uri": uri}, "position": place(at), "options": options}));
            milliseconds(start)
        });
        median(times.collect())
    };
    let hover = measured("textDocument/hover", named);
    let definition = measured("textDocument/definition", parent);
    let completion = measured("textDocument/completion", parent);
    let outline = measured("textDocument/documentSymbol", parent);
    let format = measured("textDocument/formatting", parent);
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    format!(
        "| {name} | {:.0} | {open:.1} | {:.1} | {hover:.1} | {definition:.1} | {completion:.1} | {outline:.1} | {format:.1} |\n",
        text.len() as f64 / 1e3,
        median(typed)
    )
}

fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
