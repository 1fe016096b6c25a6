//! Serves one page at this machine's own address, and nothing to other machines.

use crate::failure::Failure;
use crate::output;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A request's head is a few hundred bytes.
const LONGEST_HEAD: u64 = 16 << 10;
/// Who connects and says nothing is not waited for.
const PATIENCE: Duration = Duration::from_secs(5);

/// Serves the page until the program is ended.
pub fn serve(page: &str, port: u16, open: bool) -> Result<(), Failure> {
    let failed = |error: std::io::Error| {
        Failure::Argument(format!(
            "--port {port}: cannot serve at 127.0.0.1: {error}; choose another port, or --output FILE"
        ))
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
    let port = listener.local_addr().map_err(failed)?.port();
    let address = format!("http://127.0.0.1:{port}/");
    output::print(&format!("{address}  (Ctrl-C ends it)\n"))?;
    if open {
        open_browser(&address);
    }
    for stream in listener.incoming().flatten() {
        // One who goes away is no failure of ours.
        let _ = answer(&stream, page, port);
    }
    Ok(())
}

fn answer(mut stream: &TcpStream, page: &str, port: u16) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(stream.take(LONGEST_HEAD)).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    let mut host = String::new();
    for line in lines {
        let line = line?;
        if line.is_empty() {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("host")
        {
            value.trim().clone_into(&mut host);
        }
    }
    // A name that leads here by somebody else's name server would let a foreign page read the robot.
    let ours = [format!("127.0.0.1:{port}"), format!("localhost:{port}")].contains(&host);
    let (status, kind, body) = match request.split(' ').collect::<Vec<_>>()[..] {
        _ if !ours => ("403 Forbidden", "text/plain", "this address answers to 127.0.0.1 only\n"),
        ["GET" | "HEAD", "/", _] => ("200 OK", "text/html; charset=utf-8", page),
        _ => ("404 Not Found", "text/plain", "there is one page here: /\n"),
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Content-Security-Policy: frame-ancestors 'none'\r\n\r\n",
        body.len()
    )?;
    if !request.starts_with("HEAD") {
        stream.write_all(body.as_bytes())?;
    }
    stream.flush()
}

/// Opens the user's browser if there is a screen; the address is printed in any case.
fn open_browser(address: &str) {
    let screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        let mut command = Command::new("rundll32");
        command.arg("url.dll,FileProtocolHandler");
        command
    } else if screen {
        Command::new("xdg-open")
    } else {
        return;
    };
    let started = command.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    if started.is_err() {
        output::mention("no browser could be opened; go to the address yourself");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(request: &str) -> String {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let mut client = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        client.write_all(request.replace("PORT", &port.to_string()).as_bytes()).unwrap();
        let (stream, _) = listener.accept().unwrap();
        answer(&stream, "<p>page</p>", port).unwrap();
        drop(stream);
        let mut out = String::new();
        client.read_to_string(&mut out).unwrap();
        out
    }

    #[test]
    fn the_page_is_given_to_this_machine_and_nothing_else_is() {
        let page = asked("GET / HTTP/1.1\r\nHost: 127.0.0.1:PORT\r\n\r\n");
        assert!(page.starts_with("HTTP/1.1 200") && page.ends_with("<p>page</p>"), "{page}");
        assert!(asked("GET /../etc/passwd HTTP/1.1\r\nHost: localhost:PORT\r\n\r\n").starts_with("HTTP/1.1 404"));
        assert!(asked("POST / HTTP/1.1\r\nHost: localhost:PORT\r\n\r\n").starts_with("HTTP/1.1 404"));
        let foreign = asked("GET / HTTP/1.1\r\nHost: evil.example:PORT\r\n\r\n");
        assert!(foreign.starts_with("HTTP/1.1 403") && !foreign.contains("<p>"), "{foreign}");
    }
}
