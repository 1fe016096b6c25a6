//! An editor that talks to the server in this process.

use denavit_lsp::{Connection, serve};
use lsp_server::{Message, Notification, Request};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longer than any answer takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

pub struct Editor {
    client: Connection,
    server: Option<JoinHandle<()>>,
    next: i32,
    /// What is called `‹folder›` in what is recorded.
    folder: PathBuf,
    texts: BTreeMap<PathBuf, String>,
    /// The problems that were sent last, of each file.
    problems: BTreeMap<String, Value>,
    messages: Vec<String>,
    pub capabilities: Value,
}

impl Editor {
    /// An editor with files of a folder.
    pub fn in_folder(folder: &Path, settings: &Value) -> Self {
        Self::with(folder, &json!({"capabilities": {}, "initializationOptions": settings}))
    }

    pub fn with(folder: &Path, initialize: &Value) -> Self {
        let (client, server) = Connection::memory();
        let server = std::thread::spawn(move || serve(&server, "0.0.0").unwrap());
        let (texts, problems) = (BTreeMap::new(), BTreeMap::new());
        let folder = folder.canonicalize().unwrap();
        let mut editor = Self {
            client,
            server: Some(server),
            next: 0,
            folder,
            texts,
            problems,
            messages: Vec::new(),
            capabilities: Value::Null,
        };
        editor.capabilities = editor.ask("initialize", initialize.clone()).unwrap();
        editor.tell("initialized", json!({}));
        editor
    }

    pub fn tell(&self, method: &str, params: Value) {
        self.client.sender.send(Notification::new(method.to_owned(), params).into()).unwrap();
    }

    /// Asks, and gives the answer or the error's message.
    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, String> {
        self.next += 1;
        let id = self.next.into();
        self.client.sender.send(Request { id, method: method.to_owned(), params }.into()).unwrap();
        loop {
            match self.client.receiver.recv_timeout(PATIENCE).unwrap() {
                Message::Response(response) => {
                    return response.response_result.map_err(|error| error.message);
                }
                other => self.heard(other),
            }
        }
    }

    fn heard(&mut self, message: Message) {
        let Message::Notification(Notification { method, params }) = message else { return };
        match method.as_str() {
            "textDocument/publishDiagnostics" => {
                let uri = params["uri"].as_str().unwrap().to_owned();
                self.problems.insert(uri, params["diagnostics"].clone());
            }
            "window/showMessage" => self.messages.push(params["message"].as_str().unwrap().to_owned()),
            other => panic!("{other}"),
        }
    }

    pub fn messages(&mut self) -> &[String] {
        let _ = self.ask("nothing", json!({}));
        &self.messages
    }

    pub fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    pub fn uri(&self, file: &str) -> String {
        format!("file://{}", self.path(file).display())
    }

    /// Opens a file of the folder.
    pub fn open(&mut self, file: &str) {
        let text = std::fs::read_to_string(self.path(file)).unwrap();
        self.open_as(file, &text);
    }

    pub fn open_as(&mut self, file: &str, text: &str) {
        let document = json!({"uri": self.uri(file), "languageId": "urdf", "version": 1, "text": text});
        self.tell("textDocument/didOpen", json!({"textDocument": document}));
        self.texts.insert(self.path(file), text.to_owned());
    }

    /// Puts other words for the first of these.
    pub fn type_over(&mut self, file: &str, words: &str, by: &str) {
        let text = self.texts[&self.path(file)].clone();
        let at = text.find(words).unwrap_or_else(|| panic!("{words} is not in {file}"));
        let range = json!({"start": position(&text, at), "end": position(&text, at + words.len())});
        let change = json!({"range": range, "text": by});
        let document = json!({"uri": self.uri(file), "version": 2});
        self.tell("textDocument/didChange", json!({"textDocument": document, "contentChanges": [change]}));
        self.texts.insert(self.path(file), text.replacen(words, by, 1));
    }

    pub fn text(&self, file: &str) -> &str {
        &self.texts[&self.path(file)]
    }

    /// The position of `|` in words that are in a file once marked so: `link="|base"`.
    fn at(&self, file: &str, marked: &str) -> Value {
        let text = &self.texts[&self.path(file)];
        let (before, after) = marked.split_once('|').unwrap();
        let words = format!("{before}{after}");
        let at = text.find(&words).unwrap_or_else(|| panic!("{words} is not in {file}"));
        position(text, at + before.len())
    }

    /// Asks of a place.
    pub fn ask_at(&mut self, method: &str, file: &str, marked: &str, more: &Value) -> Result<Value, String> {
        let mut params = json!({"textDocument": {"uri": self.uri(file)}, "position": self.at(file, marked)});
        for (name, value) in more.as_object().into_iter().flatten() {
            params[name] = value.clone();
        }
        self.ask(method, params)
    }

    pub fn ask_of(&mut self, method: &str, file: &str, more: &Value) -> Result<Value, String> {
        let mut params = json!({"textDocument": {"uri": self.uri(file)}});
        for (name, value) in more.as_object().into_iter().flatten() {
            params[name] = value.clone();
        }
        self.ask(method, params)
    }

    /// Where a name is from, and every place that it is in.
    pub fn definition_and_references(&mut self, file: &str, place: &str) -> String {
        let definition = self.ask_at("textDocument/definition", file, place, &Value::Null).unwrap();
        let asked = json!({"context": {"includeDeclaration": true}});
        let references = self.ask_at("textDocument/references", file, place, &asked).unwrap();
        let (definition, references) = (self.places(&definition), self.places(&references).replace('\n', "\n    "));
        format!("{file} {place}\n  is from {definition}\n  is in\n    {references}\n\n")
    }

    /// What a hover says.
    pub fn hover(&mut self, file: &str, marked: &str) -> String {
        let answer = self.ask_at("textDocument/hover", file, marked, &Value::Null).unwrap();
        self.shown(answer["contents"]["value"].as_str().unwrap_or("nothing"))
    }

    /// Places as `file:line: the words there`.
    pub fn places(&self, answer: &Value) -> String {
        let place = |location: &Value| {
            let uri = location["uri"].as_str().unwrap();
            let path = PathBuf::from(uri.strip_prefix("file://").unwrap());
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            let text = self.texts.get(&path).cloned().unwrap_or(text);
            let number = |at: &str, what: &str| usize::try_from(location["range"][at][what].as_u64().unwrap()).unwrap();
            let line = text.lines().nth(number("start", "line")).unwrap_or_default();
            let words: String = line
                .chars()
                .skip(number("start", "character"))
                .take(number("end", "character").saturating_sub(number("start", "character")))
                .collect();
            let file = path.strip_prefix(&self.folder).unwrap_or(&path).display().to_string();
            format!("{file}:{}: {words}", number("start", "line") + 1)
        };
        let mut places: Vec<String> = answer.as_array().into_iter().flatten().map(place).collect();
        places.sort();
        places.join("\n")
    }

    /// The problems of a file: `line:column-column severity code message`, with the way there below.
    pub fn problems(&mut self, file: &str) -> String {
        // What is asked is answered after what was typed has been looked at.
        let _ = self.ask("nothing", json!({}));
        let found = self.problems.get(&self.uri(file)).cloned().unwrap_or(json!([]));
        let mut lines = Vec::new();
        for problem in found.as_array().unwrap() {
            let range = &problem["range"];
            let (start, end) = (&range["start"], &range["end"]);
            let severity =
                ["", "error", "warning", "note"][usize::try_from(problem["severity"].as_u64().unwrap()).unwrap()];
            lines.push(format!(
                "{}:{}-{}:{} {severity} {} {}",
                start["line"].as_u64().unwrap() + 1,
                start["character"].as_u64().unwrap() + 1,
                end["line"].as_u64().unwrap() + 1,
                end["character"].as_u64().unwrap() + 1,
                problem["code"].as_str().unwrap_or("-"),
                self.shown(problem["message"].as_str().unwrap()),
            ));
            for related in problem["relatedInformation"].as_array().into_iter().flatten() {
                let place = self.places(&json!([related["location"]]));
                lines.push(format!("    {place}: {}", related["message"].as_str().unwrap()));
            }
        }
        lines.join("\n")
    }

    /// A text in which the folder is called `‹folder›`.
    pub fn shown(&self, text: &str) -> String {
        text.replace(&self.folder.display().to_string(), "‹folder›")
    }

    /// The texts of files with a workspace edit's changes made.
    pub fn edited(&self, edit: &Value) -> BTreeMap<String, String> {
        let mut done = BTreeMap::new();
        for (uri, edits) in edit["changes"].as_object().into_iter().flatten() {
            let path = PathBuf::from(uri.strip_prefix("file://").unwrap());
            let text = self.texts.get(&path).cloned().unwrap_or_else(|| std::fs::read_to_string(&path).unwrap());
            let file = path.strip_prefix(&self.folder).unwrap_or(&path).display().to_string();
            done.insert(file, with_edits(&text, edits));
        }
        done
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        if std::thread::panicking() {
            return;
        }
        self.ask("shutdown", Value::Null).unwrap();
        self.tell("exit", Value::Null);
        self.server.take().unwrap().join().unwrap();
    }
}

/// Line and column in UTF-16.
fn position(text: &str, at: usize) -> Value {
    let before = &text[..at];
    let line = before.matches('\n').count();
    let column: usize = before[before.rfind('\n').map_or(0, |end| end + 1)..].chars().map(char::len_utf16).sum();
    json!({"line": line, "character": column})
}

/// A text with edits made.
pub fn with_edits(text: &str, edits: &Value) -> String {
    let offset = |position: &Value| {
        let line = usize::try_from(position["line"].as_u64().unwrap()).unwrap();
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        let column = usize::try_from(position["character"].as_u64().unwrap()).unwrap();
        start
            + text[start..]
                .chars()
                .scan(0, |seen, c| {
                    let before = *seen;
                    *seen += c.len_utf16();
                    (before < column).then_some(c.len_utf8())
                })
                .sum::<usize>()
    };
    let mut edits: Vec<(usize, usize, &str)> = edits
        .as_array()
        .unwrap()
        .iter()
        .map(|edit| (offset(&edit["range"]["start"]), offset(&edit["range"]["end"]), edit["newText"].as_str().unwrap()))
        .collect();
    edits.sort_unstable();
    let mut done = text.to_owned();
    for (start, end, new) in edits.into_iter().rev() {
        done.replace_range(start..end, new);
    }
    done
}
