//! The server under clients that wait, lie, or take all file handles.

use std::{
    fs,
    io::{self, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    thread,
};

use hsad_web::{serve::serve, site::Site};

const SCRIPT: &str = "let a = 1;";

fn site() -> Site {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("example")).unwrap();
    for (name, text) in [("index.html", "<!doctype html>"), ("main.js", SCRIPT), ("example/left.png", "pixels")] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    Site::read(folder.path()).unwrap()
}

/// A server in this process.
fn started() -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || serve(&listener, site()));
    address
}

fn ask(address: SocketAddr, request: &str) -> io::Result<String> {
    let mut stream = TcpStream::connect(address)?;
    stream.write_all(request.as_bytes())?;
    io::read_to_string(stream)
}

fn get(address: SocketAddr, path: &str) -> io::Result<String> {
    ask(address, &format!("GET {path} HTTP/1.1\r\nHost: localhost:80\r\n\r\n"))
}

#[test]
fn files_come_with_their_types_and_headers() {
    let address = started();
    let script = get(address, "/main.js?now").unwrap();
    let (head, body) = script.split_once("\r\n\r\n").unwrap();
    assert_eq!(body, SCRIPT);
    for line in [
        "HTTP/1.1 200 OK",
        "Content-Type: text/javascript; charset=utf-8",
        "Content-Length: 10",
        "X-Content-Type-Options: nosniff",
        "Cache-Control: no-store",
    ] {
        assert!(head.split("\r\n").any(|found| found == line), "{line} is not in {head}");
    }
    assert!(
        head.contains("\r\nContent-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval';"),
        "{head}"
    );
    assert!(get(address, "/").unwrap().contains("text/html"));
    assert!(get(address, "/example/left.png").unwrap().contains("image/png"));
    let head_only = ask(address, "HEAD /main.js HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    assert!(head_only.contains("Content-Length: 10") && head_only.ends_with("\r\n\r\n"), "{head_only}");
}

#[test]
fn what_is_no_request_for_a_file_of_this_machine_is_refused() {
    let address = started();
    for (request, status) in [
        ("GET /main.js HTTP/1.1\r\nHost: example.com\r\n\r\n", 403),
        ("GET /main.js HTTP/1.1\r\nHost: localhost.example.com:80\r\n\r\n", 403),
        ("GET /main.js HTTP/1.1\r\n\r\n", 400),
        ("GET /other.js HTTP/1.1\r\nHost: localhost\r\n\r\n", 404),
        ("GET /../Cargo.toml HTTP/1.1\r\nHost: localhost\r\n\r\n", 404),
        ("GET //etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n", 404),
        ("GET /example HTTP/1.1\r\nHost: localhost\r\n\r\n", 404),
        ("POST /main.js HTTP/1.1\r\nHost: localhost\r\n\r\n", 405),
        ("\r\n\r\n", 400),
    ] {
        let answer = ask(address, request).unwrap();
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{request:?}: {answer}");
        assert!(answer.contains("nosniff") && !answer.contains(SCRIPT), "{request:?}: {answer}");
    }
    // The server may end the connection before it has read all of this.
    let long = format!("GET / HTTP/1.1\r\nHost: localhost\r\nCookie: {}", "a".repeat(1 << 15));
    assert!(!ask(address, &long).unwrap_or_default().contains("200 OK"));
}

#[test]
fn idle_connections_keep_nobody_out() {
    let address = started();
    let mut idle: Vec<TcpStream> = (0..200).map(|_| TcpStream::connect(address).unwrap()).collect();
    // Some have begun.
    idle.iter_mut().step_by(2).for_each(|stream| drop(stream.write_all(b"GET /main.js HT")));
    for _ in 0..20 {
        assert!(get(address, "/main.js").unwrap().ends_with(SCRIPT));
    }
    drop(idle);
    assert!(get(address, "/main.js").unwrap().ends_with(SCRIPT));
}

/// No test, but the server of the one above.
#[test]
#[ignore = "serves until the process is ended"]
fn serves() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let site = site();
    io::stdout().write_all(format!("serving at {}\n", listener.local_addr().unwrap()).as_bytes()).unwrap();
    serve(&listener, site)
}

#[cfg(unix)]
mod poor {
    use std::{
        io::{BufRead, BufReader},
        process::{Child, Command, Stdio},
        time::{Duration, Instant},
    };

    use super::*;

    /// A server in a process of its own with few file handles.
    struct Poor(Child);

    impl Drop for Poor {
        fn drop(&mut self) {
            let _ = self.0.kill();
            let _ = self.0.wait();
        }
    }

    #[test]
    fn few_file_handles_do_not_end_it() {
        // The process runs `serves` below, by the name of this test.
        let arguments = ["--exact", "serves", "--ignored", "--nocapture"];
        let mut command = Command::new("sh");
        command.args(["-c", r#"ulimit -n 24; exec "$0" "$@""#]).arg(std::env::current_exe().unwrap()).args(arguments);
        let mut server = Poor(command.stdout(Stdio::piped()).spawn().unwrap());
        let mut lines = BufReader::new(server.0.stdout.take().unwrap()).lines().map_while(Result::ok);
        let address: SocketAddr = lines.find_map(|line| line.split("serving at ").nth(1)?.parse().ok()).unwrap();

        let idle: Vec<TcpStream> = (0..100).map(|_| TcpStream::connect(address).unwrap()).collect();
        let end = Instant::now() + Duration::from_secs(60);
        // A request among so many may be cut off, as the oldest of all; a browser asks again.
        while !get(address, "/main.js").is_ok_and(|answer| answer.ends_with(SCRIPT)) {
            assert!(Instant::now() < end, "no request is answered");
            assert!(server.0.try_wait().unwrap().is_none(), "the server has ended");
        }
        drop(idle);
        assert!(get(address, "/main.js").unwrap().ends_with(SCRIPT));
        assert!(server.0.try_wait().unwrap().is_none(), "the server has ended");
    }
}
