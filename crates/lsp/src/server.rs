//! The conversation with an editor.

use crate::analysis::{Problem, real};
use crate::diagnostics::diagnostics;
use crate::features::{actions, commands, complete, definition, folding, format, hover, lens, rename, symbols};
use crate::session::Session;
use crate::settings::Settings;
use crate::text::{Encoding, Text};
use crate::uri::{path_of, uri_of};
use gen_lsp_types::{
    CodeActionKind, CodeActionOptions, CodeLens, CodeLensOptions, CompletionOptions, DidChangeTextDocumentParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, ExecuteCommandOptions, ExecuteCommandParams,
    InitializeResult, PositionEncodingKind, PublishDiagnosticsParams, Range, RenameOptions, ServerCapabilities,
    ServerInfo, TextDocumentContentChangeEvent, TextDocumentIdentifier, TextDocumentPositionParams,
    TextDocumentSyncKind, TextDocumentSyncOptions, Uri,
};
use lsp_server::{Connection, ErrorCode, Message, Notification, ProtocolError, Request, Response};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;

/// The problems are computed this long after the last change, longer than the pause between keystrokes.
const QUIET: Duration = Duration::from_millis(15);

/// Why a conversation ended.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The client violates the protocol, or disconnected.
    #[error("the editor ended the conversation: {0}")]
    Protocol(String),
    /// Standard input or output failed.
    #[error("standard input or output: {0}")]
    Io(#[from] std::io::Error),
}

impl From<ProtocolError> for ServeError {
    fn from(error: ProtocolError) -> Self {
        Self::Protocol(error.to_string())
    }
}

/// Serves an editor over standard input and output until it sends `exit`.
///
/// # Errors
/// The editor violates the protocol, or a stream fails.
pub fn serve_stdio(version: &str) -> Result<(), ServeError> {
    let (connection, threads) = Connection::stdio();
    serve(&connection, version)?;
    // The writer ends when all senders are gone.
    drop(connection);
    threads.join()?;
    Ok(())
}

/// Serves an editor until it sends `exit`.
///
/// # Errors
/// The editor violates the protocol.
pub fn serve(connection: &Connection, version: &str) -> Result<(), ServeError> {
    let (id, params) = connection.initialize_start()?;
    let offered = params.pointer("/capabilities/general/positionEncodings").and_then(Value::as_array);
    let utf8 = offered.is_some_and(|offered| offered.iter().any(|kind| kind == "utf-8"));
    let encoding = if utf8 { Encoding::Utf8 } else { Encoding::Utf16 };
    let wanted = params.get("initializationOptions").map_or(Ok(Settings::default()), Settings::read);
    let (settings, wrong) = match wanted {
        Ok(settings) => (settings, None),
        Err(wrong) => (Settings::default(), Some(wrong)),
    };
    let result = InitializeResult {
        capabilities: capabilities(encoding),
        server_info: Some(ServerInfo { name: "denavit".to_owned(), version: Some(version.to_owned()) }),
    };
    connection.initialize_finish(id, json!(result))?;
    // An editor that shows the commands' results itself states this; other editors get messages.
    let shows_results = params.pointer("/capabilities/experimental/denavit").is_some();
    let mut session = Session::new(encoding, settings);
    session.has_commands = shows_results;
    let (uris, changed) = (BTreeMap::new(), BTreeSet::new());
    let mut server = Server { connection, session, encoding, uris, changed };
    if let Some(wrong) = wrong {
        server.say(1, &wrong);
    }
    server.run()
}

fn capabilities(encoding: Encoding) -> ServerCapabilities {
    ServerCapabilities {
        position_encoding: Some(match encoding {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }),
        text_document_sync: Some(
            TextDocumentSyncOptions {
                open_close: Some(true),
                change: Some(TextDocumentSyncKind::Incremental),
                save: Some(true.into()),
                ..TextDocumentSyncOptions::default()
            }
            .into(),
        ),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(["<", " ", "\"", "/", ":", "{", "("].map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        hover_provider: Some(true.into()),
        definition_provider: Some(true.into()),
        references_provider: Some(true.into()),
        document_symbol_provider: Some(true.into()),
        code_action_provider: Some(
            CodeActionOptions {
                code_action_kinds: Some(vec![CodeActionKind::QuickFix, CodeActionKind::SourceFixAll]),
                ..CodeActionOptions::default()
            }
            .into(),
        ),
        code_lens_provider: Some(CodeLensOptions { resolve_provider: Some(true), ..CodeLensOptions::default() }),
        document_formatting_provider: Some(true.into()),
        rename_provider: Some(RenameOptions { prepare_provider: Some(true), ..RenameOptions::default() }.into()),
        folding_range_provider: Some(true.into()),
        execute_command_provider: Some(ExecuteCommandOptions {
            commands: commands::NAMES.map(str::to_owned).to_vec(),
            ..ExecuteCommandOptions::default()
        }),
        ..ServerCapabilities::default()
    }
}

struct Server<'a> {
    connection: &'a Connection,
    session: Session,
    encoding: Encoding,
    /// The editor's URIs of the open files.
    uris: BTreeMap<PathBuf, Uri>,
    /// Files that changed since the problems were last computed.
    changed: BTreeSet<PathBuf>,
}

/// The position of a request: the file and the byte.
struct TextPosition {
    path: PathBuf,
    at: usize,
}

impl Server<'_> {
    fn run(&mut self) -> Result<(), ServeError> {
        loop {
            let message = if self.changed.is_empty() {
                match self.connection.receiver.recv() {
                    Ok(message) => message,
                    Err(_) => return Ok(()),
                }
            } else if let Ok(message) = self.connection.receiver.recv_timeout(QUIET) {
                message
            } else {
                self.refresh();
                continue;
            };
            match message {
                Message::Request(request) => {
                    if self.connection.handle_shutdown(&request)? {
                        return Ok(());
                    }
                    // A request refers to the current text.
                    self.refresh();
                    let response = self.answer(&request);
                    self.send(response);
                }
                Message::Notification(notification) => self.notified(notification),
                Message::Response(_) => {}
            }
        }
    }

    fn send(&self, message: impl Into<Message>) {
        // If the editor is gone, sending fails; the next receive ends the loop.
        let _ = self.connection.sender.send(message.into());
    }

    /// Shows a message: 1 an error, 3 for information.
    fn say(&self, kind: u8, message: &str) {
        self.send(Notification::new("window/showMessage".to_owned(), json!({"type": kind, "message": message})));
    }

    fn notified(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        match method.as_str() {
            "textDocument/didOpen" => {
                let Some(opened) = read::<DidOpenTextDocumentParams>(params) else { return };
                let Some(path) = Self::path(&opened.text_document.uri) else { return };
                self.uris.insert(path.clone(), opened.text_document.uri);
                self.session.set(&path, opened.text_document.text);
                self.changed.insert(path);
            }
            "textDocument/didChange" => {
                let Some(changed) = read::<DidChangeTextDocumentParams>(params) else { return };
                let uri = &changed.text_document.text_document_identifier.uri;
                let Some(path) = Self::path(uri) else { return };
                let Some(text) = self.session.files.text(&path) else { return };
                let mut text = Text::clone(&text);
                for change in changed.content_changes {
                    text = match change {
                        TextDocumentContentChangeEvent::TextDocumentContentChangePartial(part) => {
                            let bytes = text.bytes(part.range);
                            let mut whole = text.text;
                            whole.replace_range(bytes, &part.text);
                            Text::new(whole, self.encoding)
                        }
                        TextDocumentContentChangeEvent::TextDocumentContentChangeWholeDocument(whole) => {
                            Text::new(whole.text, self.encoding)
                        }
                    };
                }
                self.session.set(&path, text.text);
                self.changed.insert(path);
            }
            "textDocument/didClose" => {
                let Some(closed) = read::<DidCloseTextDocumentParams>(params) else { return };
                let Some(path) = Self::path(&closed.text_document.uri) else { return };
                self.session.close(&path);
                self.changed.insert(path);
                self.refresh();
            }
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => {
                let problems = self.session.refresh_all();
                self.publish(problems);
            }
            "workspace/didChangeConfiguration" => match params.get("settings").map(Settings::read) {
                Some(Ok(settings)) => {
                    self.session.settings = settings;
                    let problems = self.session.refresh_all();
                    self.publish(problems);
                }
                Some(Err(wrong)) => self.say(1, &wrong),
                None => {}
            },
            _ => {}
        }
    }

    fn path(uri: &Uri) -> Option<PathBuf> {
        path_of(uri).map(|path| real(&path))
    }

    /// The editor's URI of a file.
    fn uri(&self, path: &Path) -> Uri {
        self.uris.get(path).cloned().unwrap_or_else(|| uri_of(path))
    }

    fn refresh(&mut self) {
        if self.changed.is_empty() {
            return;
        }
        let changed = std::mem::take(&mut self.changed);
        let problems = self.session.refresh(&changed);
        self.publish(problems);
    }

    fn publish(&self, problems: Vec<(PathBuf, Vec<Problem>)>) {
        for (path, problems) in problems {
            let diagnostics = diagnostics(&self.session.files, &problems);
            let params = PublishDiagnosticsParams { uri: self.uri(&path), version: None, diagnostics };
            self.send(Notification::new("textDocument/publishDiagnostics".to_owned(), params));
        }
    }

    fn answer(&mut self, request: &Request) -> Response {
        let id = request.id.clone();
        match self.result(&request.method, request.params.clone()) {
            Some(Ok(value)) => Response::new_ok(id, value),
            Some(Err(words)) => Response::new_err(id, ErrorCode::RequestFailed as i32, words),
            None => {
                let words = format!("{} is not supported", request.method);
                Response::new_err(id, ErrorCode::MethodNotFound as i32, words)
            }
        }
    }

    fn asked(&self, params: &Value) -> Option<TextPosition> {
        let TextDocumentPositionParams { text_document, position } = read(params.clone())?;
        let path = Self::path(&text_document.uri)?;
        let at = self.session.files.text(&path)?.offset(position);
        Some(TextPosition { path, at })
    }

    fn file(params: &Value) -> Option<PathBuf> {
        let document: TextDocumentIdentifier = read(params.get("textDocument")?.clone())?;
        Self::path(&document.uri)
    }

    /// The response, or the reason for an error; `None` for an unknown method.
    fn result(&mut self, method: &str, params: Value) -> Option<Result<Value, String>> {
        let session = &self.session;
        let asked = self.asked(&params);
        let file = Self::file(&params);
        let nothing = Ok(Value::Null);
        let at = |answer: &dyn Fn(&Path, usize) -> Result<Value, String>| match &asked {
            Some(TextPosition { path, at }) => answer(path, *at),
            None => Ok(Value::Null),
        };
        let of = |answer: &dyn Fn(&Path) -> Result<Value, String>| file.as_deref().map_or(Ok(Value::Null), answer);
        Some(match method {
            "textDocument/hover" => at(&|path, at| Ok(json!(hover::hover(session, path, at)))),
            "textDocument/definition" => at(&|path, at| Ok(json!(definition::definition(session, path, at)))),
            "textDocument/references" => {
                let with = params.pointer("/context/includeDeclaration").and_then(Value::as_bool) != Some(false);
                at(&|path, at| Ok(json!(definition::references(session, path, at, with))))
            }
            "textDocument/completion" => at(&|path, at| Ok(json!(complete::complete(session, path, at)))),
            "textDocument/prepareRename" => {
                at(&|path, at| rename::prepare(session, path, at).map(|range| json!(range)))
            }
            "textDocument/rename" => {
                let Some(name) = params.get("newName").and_then(Value::as_str) else { return Some(nothing) };
                at(&|path, at| rename::rename(session, path, at, name).map(|edit| json!(edit)))
            }
            "textDocument/documentSymbol" => of(&|path| Ok(json!(symbols::symbols(session, path)))),
            "textDocument/foldingRange" => of(&|path| Ok(json!(folding::folding(session, path)))),
            "textDocument/formatting" => {
                let size = params.pointer("/options/tabSize").and_then(Value::as_u64);
                let tabs = params.pointer("/options/insertSpaces").and_then(Value::as_bool) == Some(false);
                of(&|path| format::format(session, path, size, tabs).map(|edits| json!(edits)))
            }
            "textDocument/codeAction" => {
                let range: Option<Range> = params.get("range").cloned().and_then(read);
                let only = params.pointer("/context/only").cloned().and_then(read::<Vec<String>>);
                of(&|path| Ok(json!(range.map(|range| actions::actions(session, path, range, only.as_deref())))))
            }
            "textDocument/codeLens" => of(&|path| Ok(json!(lens::lenses(session, path)))),
            "codeLens/resolve" => match read::<CodeLens>(params) {
                Some(lens) => Ok(json!(lens::resolve(session, lens))),
                None => nothing,
            },
            "workspace/executeCommand" => {
                let Some(asked) = read::<ExecuteCommandParams>(params) else { return Some(nothing) };
                let uri = asked.arguments.as_ref().and_then(|list| list.first()).and_then(Value::as_str);
                let path = uri.and_then(|uri| Self::path(&Uri::from(uri)));
                let result = commands::run(session, &asked.command, path.as_deref());
                if let (Ok(words), false) = (&result, session.has_commands) {
                    self.say(3, words);
                }
                result.map(Value::String)
            }
            "denavit/linkAt" => at(&|path, at| Ok(json!(definition::link_at(session, path, at)))),
            _ => return None,
        })
    }
}

fn read<T: DeserializeOwned>(value: Value) -> Option<T> {
    serde_json::from_value(value).ok()
}
