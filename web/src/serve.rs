//! A web server for the files of one folder, reachable from this machine only.

use std::{
    ffi::OsStr,
    fs,
    io::{self, BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    path::{Component, Path, PathBuf},
    thread,
};

/// Longest request that is read, in bytes.
const MAX_REQUEST: u64 = 1 << 16;

/// Serves the files of `folder` until the process ends.
///
/// # Errors
/// If a connection cannot be accepted.
pub fn serve(listener: &TcpListener, folder: &Path) -> anyhow::Result<()> {
    loop {
        let (stream, _) = listener.accept()?;
        let folder = folder.to_path_buf();
        // Each connection has its own thread, so that an aborted one does not affect the next.
        thread::spawn(move || respond(&stream, &folder));
    }
}

fn respond(mut stream: &TcpStream, folder: &Path) -> io::Result<()> {
    let mut lines = BufReader::new(stream.take(MAX_REQUEST)).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    // The headers are not needed, but unread bytes would reset the connection.
    for line in lines.by_ref() {
        if line?.is_empty() {
            break;
        }
    }
    let mut words = request.split(' ');
    let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let file = (method == "GET").then(|| file(folder, target)).flatten();
    let (status, kind, body) = match file.map(|path| (mime_type(&path), fs::read(&path))) {
        Some((kind, Ok(body))) => ("200 OK", kind, body),
        _ => ("404 Not Found", "text/plain", b"there is no such file\n".to_vec()),
    };
    // no-store: a rebuilt page must be seen at once.
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         Connection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(&body)
}

/// Path of the file of a request target; `None` if it lies outside of `folder`.
fn file(folder: &Path, target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
    let path = Path::new(if path.is_empty() { "index.html" } else { path });
    path.components().all(|part| matches!(part, Component::Normal(_))).then(|| folder.join(path))
}

fn mime_type(path: &Path) -> &'static str {
    match path.extension().and_then(OsStr::to_str) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("png") => "image/png",
        Some("json") => "application/json",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_are_served() {
        let folder = Path::new("/page");
        assert_eq!(file(folder, "/"), Some("/page/index.html".into()));
        assert_eq!(file(folder, "/example/left.png?now#there"), Some("/page/example/left.png".into()));
        for outside in ["", "page", "//etc/passwd", "/../secret", "/a/../../secret"] {
            assert_eq!(file(folder, outside), None, "{outside}");
        }
    }

    #[test]
    fn a_request_is_answered() {
        let folder = std::env::temp_dir().join(format!("hsad-web-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("main.js"), "let a = 1;").unwrap();
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let served = folder.clone();
        thread::spawn(move || serve(&listener, &served));
        let ask = |request: &str| {
            let mut stream = TcpStream::connect(address).unwrap();
            write!(stream, "{request} HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
            io::read_to_string(stream).unwrap()
        };
        let found = ask("GET /main.js");
        assert!(found.starts_with("HTTP/1.1 200 OK\r\nContent-Type: text/javascript"), "{found}");
        assert!(found.ends_with("\r\n\r\nlet a = 1;"), "{found}");
        for missing in ["GET /other.js", "POST /main.js", "GET", ""] {
            assert!(ask(missing).starts_with("HTTP/1.1 404"), "{missing}");
        }
        fs::remove_dir_all(folder).unwrap();
    }
}
