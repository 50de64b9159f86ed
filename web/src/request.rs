//! Requests: what is read of them, and why one is refused.

use std::{
    io::{self, Read},
    net::TcpStream,
    time::Instant,
};

/// Longest request that is read, in bytes.
const MAX_REQUEST: usize = 1 << 14;

/// A request for a file.
#[derive(Debug, PartialEq, Eq)]
pub struct Request {
    /// Path of the file, without what follows a `?`.
    pub target: String,
    /// Whether the file is wanted (GET), and not only what is told of it (HEAD).
    pub wants_body: bool,
}

/// Why a request gets no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Not HTTP, or cut off.
    Malformed,
    /// Longer than [`MAX_REQUEST`].
    TooLong,
    /// Sent to a name that is not this machine's own.
    ForeignHost,
    /// Neither GET nor HEAD.
    Method,
    /// There is no such file.
    NotFound,
}

impl Refusal {
    /// Status of the answer.
    pub fn status(self) -> &'static str {
        match self {
            Self::Malformed => "400 Bad Request",
            Self::TooLong => "431 Request Header Fields Too Large",
            Self::ForeignHost => "403 Forbidden",
            Self::Method => "405 Method Not Allowed",
            Self::NotFound => "404 Not Found",
        }
    }

    /// The refusal for whoever sees it in a browser.
    pub fn words(self) -> &'static str {
        match self {
            Self::Malformed => "this is no request for a file\n",
            Self::TooLong => "the request is too long\n",
            Self::ForeignHost => "this server answers to localhost, 127.0.0.1 and [::1] only\n",
            Self::Method => "files are only read here: use GET or HEAD\n",
            Self::NotFound => "there is no such file\n",
        }
    }
}

impl Request {
    /// Reads a request, whose last byte must be there at `end`.
    ///
    /// # Errors
    /// If the client is gone or too slow.
    pub fn read(mut stream: &TcpStream, end: Instant) -> io::Result<Result<Self, Refusal>> {
        let mut bytes = Vec::new();
        let mut chunk = [0; 2048];
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(io::ErrorKind::TimedOut.into());
            }
            stream.set_read_timeout(Some(left))?;
            match stream.read(&mut chunk)? {
                0 => return Ok(Err(Refusal::Malformed)),
                count => bytes.extend_from_slice(&chunk[..count]),
            }
            if let Some(length) = bytes.windows(4).position(|end| end == b"\r\n\r\n") {
                return Ok(Self::parse(&String::from_utf8_lossy(&bytes[..length])));
            }
            if bytes.len() > MAX_REQUEST {
                return Ok(Err(Refusal::TooLong));
            }
        }
    }

    /// Parses the lines of a request.
    fn parse(head: &str) -> Result<Self, Refusal> {
        let mut lines = head.split("\r\n");
        let [method, target, version] = words(lines.next().unwrap_or_default()).ok_or(Refusal::Malformed)?;
        if !version.starts_with("HTTP/1.") {
            return Err(Refusal::Malformed);
        }
        let fields = lines.filter_map(|line| line.split_once(':'));
        let mut hosts = fields.filter(|(name, _)| name.eq_ignore_ascii_case("host")).map(|(_, host)| host.trim());
        match (hosts.next(), hosts.next()) {
            (Some(host), None) if is_own(host) => {}
            (Some(_), None) => return Err(Refusal::ForeignHost),
            _ => return Err(Refusal::Malformed),
        }
        let wants_body = match method {
            "GET" => true,
            "HEAD" => false,
            _ => return Err(Refusal::Method),
        };
        let target = target.split(['?', '#']).next().unwrap_or_default().into();
        Ok(Self { target, wants_body })
    }
}

/// The three words of a line.
fn words(line: &str) -> Option<[&str; 3]> {
    let mut words = line.split(' ');
    let three = [words.next()?, words.next()?, words.next()?];
    words.next().is_none().then_some(three)
}

/// Whether a host, with or without a port, is this machine.
fn is_own(host: &str) -> bool {
    ["localhost", "127.0.0.1", "[::1]"].iter().any(|own| {
        let port = host.get(..own.len()).filter(|name| name.eq_ignore_ascii_case(own)).map(|name| &host[name.len()..]);
        port.is_some_and(|port| {
            port.is_empty() || port.strip_prefix(':').is_some_and(|port| port.parse::<u16>().is_ok())
        })
    })
}

#[cfg(test)]
mod tests {
    use std::{io::Write, net::TcpListener, time::Duration};

    use super::*;

    #[test]
    fn only_this_machine_is_answered_for() {
        for own in ["localhost", "localhost:8080", "LOCALHOST:1", "127.0.0.1", "127.0.0.1:80", "[::1]", "[::1]:8080"] {
            assert!(is_own(own), "{own}");
        }
        for foreign in [
            "",
            "example.com",
            "localhost.example.com",
            "localhost:",
            "localhost:80:80",
            "localhost:x",
            "127.0.0.10",
            "127.0.0.1.example.com:80",
            "::1",
            "[::2]",
            "0.0.0.0",
            "locälhost",
        ] {
            assert!(!is_own(foreign), "{foreign}");
        }
    }

    #[test]
    fn requests_are_read_or_refused() {
        let get = |target: &str| Ok(Request { target: target.into(), wants_body: true });
        let head = Ok(Request { target: "/".into(), wants_body: false });
        for (text, expected) in [
            ("GET / HTTP/1.1\r\nHost: localhost", get("/")),
            ("GET /a.js?now#there HTTP/1.0\r\nAccept: */*\r\nhost:127.0.0.1:8080 ", get("/a.js")),
            ("HEAD / HTTP/1.1\r\nHost: [::1]:80", head),
            ("GET / HTTP/1.1\r\nHost: example.com", Err(Refusal::ForeignHost)),
            ("POST / HTTP/1.1\r\nHost: example.com", Err(Refusal::ForeignHost)),
            ("POST / HTTP/1.1\r\nHost: localhost", Err(Refusal::Method)),
            ("GET / HTTP/1.1", Err(Refusal::Malformed)),
            ("GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost", Err(Refusal::Malformed)),
            ("GET / HTTP/2\r\nHost: localhost", Err(Refusal::Malformed)),
            ("GET / a HTTP/1.1\r\nHost: localhost", Err(Refusal::Malformed)),
            ("GET", Err(Refusal::Malformed)),
            ("", Err(Refusal::Malformed)),
        ] {
            assert_eq!(Request::parse(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_request_that_does_not_come_is_not_waited_for() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        client.write_all(b"GET / HTTP/1.1\r\n").unwrap();
        let (server, _) = listener.accept().unwrap();
        assert!(Request::read(&server, Instant::now() + Duration::from_millis(50)).is_err());
        client.write_all(b"Host: localhost\r\n\r\n").unwrap();
        // What was read is gone.
        let read = Request::read(&server, Instant::now() + Duration::from_secs(60)).unwrap();
        assert_eq!(read, Err(Refusal::Malformed));
    }
}
