//! A web server for a few files, reachable from this machine only.
//!
//! Each connection has one request and one thread. Idle, slow and foreign clients cannot keep the page from others: a connection ends
//! after [`PATIENCE`], the oldest one ends when there are [`MOST`] or file handles run out, and only requests to this machine by its
//! own name are answered, so that no page of another site reads these files through a name that it points here (DNS rebinding).

use std::{
    collections::VecDeque,
    io::{self, Write},
    net::{Shutdown, TcpListener, TcpStream},
    sync::{Arc, Weak},
    thread,
    time::{Duration, Instant},
};

use crate::{
    request::{Refusal, Request},
    site::{File, Site},
};

/// Most connections at a time.
const MOST: usize = 64;
/// Longest time that a connection may take to send its request, and to take a part of the answer.
const PATIENCE: Duration = Duration::from_secs(10);
/// Time until connections are accepted again after the system refused one.
const PAUSE: Duration = Duration::from_millis(20);

/// What browsers are told with every file. The page runs its own scripts and WebAssembly alone, and loads nothing from elsewhere;
/// `no-store`: a rebuilt page must be seen at once.
const HEADERS: &str = "Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
                       img-src 'self' data:; connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; \
                       frame-ancestors 'none'\r\n\
                       X-Content-Type-Options: nosniff\r\n\
                       Cross-Origin-Resource-Policy: same-origin\r\n\
                       Referrer-Policy: no-referrer\r\n\
                       Cache-Control: no-store\r\n";

/// Serves the files of `site` until the process ends.
pub fn serve(listener: &TcpListener, site: Site) -> ! {
    let site = Arc::new(site);
    let mut connections = Connections::default();
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                let stream = Arc::new(stream);
                connections.add(&stream);
                let site = Arc::clone(&site);
                // Without a thread the connection ends here.
                let _ = thread::Builder::new().spawn(move || respond(&stream, &site));
            }
            // File handles ran out, or a client is gone already.
            Err(_) => {
                connections.end_oldest();
                thread::sleep(PAUSE);
            }
        }
    }
}

/// The connections in the order of their arrival, some of which have ended.
#[derive(Default)]
struct Connections(VecDeque<Weak<TcpStream>>);

impl Connections {
    fn add(&mut self, stream: &Arc<TcpStream>) {
        self.0.retain(|other| other.strong_count() > 0);
        if self.0.len() >= MOST {
            self.end_oldest();
        }
        self.0.push_back(Arc::downgrade(stream));
    }

    fn end_oldest(&mut self) {
        while let Some(oldest) = self.0.pop_front() {
            if let Some(stream) = oldest.upgrade() {
                // A client that is gone has ended the connection already.
                let _ = stream.shutdown(Shutdown::Both);
                return;
            }
        }
    }
}

fn respond(stream: &TcpStream, site: &Site) -> io::Result<()> {
    stream.set_write_timeout(Some(PATIENCE))?;
    let request = Request::read(stream, Instant::now() + PATIENCE)?;
    match request.and_then(|request| Ok((site.file(&request.target).ok_or(Refusal::NotFound)?, request.wants_body))) {
        Ok((file, wants_body)) => answer(stream, "200 OK", file, wants_body),
        Err(refusal) => {
            let body = refusal.words().as_bytes().to_vec();
            answer(stream, refusal.status(), &File { kind: "text/plain; charset=utf-8", body }, true)
        }
    }
}

fn answer(mut stream: &TcpStream, status: &str, File { kind, body }: &File, wants_body: bool) -> io::Result<()> {
    let length = body.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{HEADERS}Connection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes())?;
    if wants_body {
        stream.write_all(body)?;
    }
    stream.shutdown(Shutdown::Write)
}
