//! Builds the page and serves it: `cargo run -p hsad-web [-- PORT]`.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> anyhow::Result<()> {
    use std::net::TcpListener;

    use anyhow::Context;

    let port = std::env::args().nth(1).map_or(Ok(8080), |text| {
        text.parse::<u16>().with_context(|| format!("'{text}' is not a port: use a number from 0 to 65535"))
    })?;
    // The port is bound before anything is built, since it may be taken.
    let listener = TcpListener::bind(("127.0.0.1", port)).with_context(|| {
        format!("port {port} is not available: use another one, as in cargo run -p hsad-web -- 8081")
    })?;
    let folder = hsad_web::bundle::target_folder().join("web");
    hsad_web::bundle::bundle(&folder)?;
    eprintln!("{} can be served by any web server", folder.display());
    eprintln!("serving it at http://localhost:{}", listener.local_addr()?.port());
    hsad_web::serve::serve(&listener, hsad_web::site::Site::read(&folder)?)
}

/// The WebAssembly build uses only the library.
#[cfg(target_arch = "wasm32")]
fn main() {}
