//! Expression text into tokens.

use std::ops::Range;

use super::Fault;
use super::number::{parse_float, parse_integer};
use crate::error::ErrorKind;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Integer(i128),
    Float(f64),
    Text(String),
    Name(String),
    Symbol(&'static str),
    End,
}

/// Longer symbols come first.
const SYMBOLS: &[&str] = &[
    "**", "//", "<<", ">>", "<=", ">=", "==", "!=", ":=", "->", "+", "-", "*", "/", "%", "(", ")", "[", "]", "{", "}",
    ",", ":", ".", "=", "<", ">", "&", "|", "^", "~", ";", "@",
];

pub(super) fn tokens(text: &str) -> Result<Vec<(Token, Range<usize>)>, Fault> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let start = at;
        let rest = &text[at..];
        let token = if c.is_whitespace() || rest.starts_with("\\\n") {
            at += c.len_utf8();
            continue;
        } else if c.is_ascii_digit() || (c == '.' && rest[1..].starts_with(|d: char| d.is_ascii_digit())) {
            let length = number_length(rest);
            at += length;
            number(&rest[..length]).map_err(|fault| fault.at(&(start..at)))?
        } else if let Some(length) = quote_start(rest) {
            let (value, end) = quoted(text, at, length)?;
            at = end;
            Token::Text(value)
        } else if c == '_' || c.is_alphabetic() {
            at += rest.find(|c: char| c != '_' && !c.is_alphanumeric()).unwrap_or(rest.len());
            Token::Name(text[start..at].to_owned())
        } else if let Some(symbol) = SYMBOLS.iter().find(|symbol| rest.starts_with(**symbol)) {
            at += symbol.len();
            Token::Symbol(symbol)
        } else {
            let fault = Fault::new(ErrorKind::Syntax, format!("\"{c}\" has no meaning in an expression"));
            let fault = match c {
                '!' => fault.help("write \"not\""),
                '$' => fault.help("write names without \"$\" inside ${…}"),
                _ => fault,
            };
            return Err(fault.at(&(at..at + c.len_utf8())));
        };
        tokens.push((token, start..at));
    }
    tokens.push((Token::End, text.len()..text.len()));
    Ok(tokens)
}

fn number_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let based = bytes[0] == b'0' && bytes.get(1).is_some_and(|b| b"xXoObB".contains(b));
    let mut length = if based { 2 } else { 0 };
    while let Some(&byte) = bytes.get(length) {
        let signed_exponent = !based
            && (byte == b'+' || byte == b'-')
            && matches!(bytes[length - 1], b'e' | b'E')
            && bytes.get(length + 1).is_some_and(u8::is_ascii_digit);
        let exponent_or_letter = byte.is_ascii_alphanumeric() || byte == b'_';
        if exponent_or_letter || (byte == b'.' && !based) || signed_exponent {
            length += 1;
        } else {
            break;
        }
    }
    // `1if x else 2` is legal in Python, but only just, and nobody writes it.
    length
}

fn number(text: &str) -> Result<Token, Fault> {
    let wrong = || Fault::new(ErrorKind::Syntax, format!("\"{text}\" is not a number"));
    let too_large = || Fault::new(ErrorKind::Limit, format!("the integer {text} has more than 127 bits"));
    if text.len() > 2 && text.starts_with('0') && text.as_bytes()[1].is_ascii_alphabetic() {
        let base = match text.as_bytes()[1].to_ascii_lowercase() {
            b'x' => 16,
            b'o' => 8,
            b'b' => 2,
            _ => 10,
        };
        if base != 10 {
            let digits = text[2..].replace('_', "");
            return i128::from_str_radix(&digits, base).map(Token::Integer).map_err(|_| wrong());
        }
    }
    if let Some(value) = parse_integer(text) {
        let padded = text.len() > 1 && text.starts_with('0') && value != 0;
        return if padded {
            Err(wrong().help("write integers without leading zeros"))
        } else {
            Ok(Token::Integer(value))
        };
    }
    if text.bytes().all(|b| b.is_ascii_digit() || b == b'_') {
        return Err(too_large());
    }
    parse_float(text).map(Token::Float).ok_or_else(wrong)
}

/// Length of a string's prefix and opening quotes.
fn quote_start(rest: &str) -> Option<usize> {
    let prefix = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
    let known = prefix == 0 || (prefix == 1 && b"rRuU".contains(&rest.as_bytes()[0]));
    if !known {
        return None;
    }
    let quotes = &rest[prefix..];
    if quotes.starts_with("'''") || quotes.starts_with("\"\"\"") {
        Some(prefix + 3)
    } else if quotes.starts_with(['\'', '"']) {
        Some(prefix + 1)
    } else {
        None
    }
}

fn quoted(text: &str, start: usize, opening: usize) -> Result<(String, usize), Fault> {
    let raw = text[start..].starts_with(['r', 'R']);
    let open = &text[start..start + opening];
    let close = open.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    let mut value = String::new();
    let mut at = start + opening;
    loop {
        let rest = &text[at..];
        if rest.starts_with(close) {
            return Ok((value, at + close.len()));
        }
        let Some(c) = rest.chars().next() else {
            return Err(Fault::new(ErrorKind::Syntax, "this text has no closing quote").at(&(start..text.len())));
        };
        at += c.len_utf8();
        if c != '\\' {
            value.push(c);
            continue;
        }
        let Some(escaped) = text[at..].chars().next() else { continue };
        at += escaped.len_utf8();
        match escaped {
            _ if raw => value.extend(['\\', escaped]),
            'n' => value.push('\n'),
            't' => value.push('\t'),
            'r' => value.push('\r'),
            '0' => value.push('\0'),
            '\n' => {}
            '\\' | '\'' | '"' => value.push(escaped),
            'x' | 'u' | 'U' => {
                let length = match escaped {
                    'x' => 2,
                    'u' => 4,
                    _ => 8,
                };
                let decoded = text
                    .get(at..at + length)
                    .and_then(|digits| u32::from_str_radix(digits, 16).ok())
                    .and_then(char::from_u32);
                let Some(decoded) = decoded else {
                    return Err(Fault::new(ErrorKind::Syntax, "this escape is not a character").at(&(at - 2..at)));
                };
                value.push(decoded);
                at += length;
            }
            other => value.extend(['\\', other]),
        }
    }
}
