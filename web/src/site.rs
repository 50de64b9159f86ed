//! The files that are served, in memory: no request opens a file, and none reaches another one.

use std::{collections::HashMap, ffi::OsStr, fs, path::Path};

use anyhow::{Context, Result};

/// A file with its media type.
pub struct File {
    /// The media type.
    pub kind: &'static str,
    /// All bytes.
    pub body: Vec<u8>,
}

/// The files of a folder, by their paths in it: `/main.js`, `/example/left.png`.
pub struct Site(HashMap<String, File>);

impl Site {
    /// Reads all files of `folder`.
    ///
    /// # Errors
    /// If the folder or a file cannot be read.
    pub fn read(folder: &Path) -> Result<Self> {
        let mut files = HashMap::new();
        add(folder, "/", &mut files)?;
        Ok(Self(files))
    }

    /// The file of a path; `/` stands for `/index.html`.
    pub fn file(&self, path: &str) -> Option<&File> {
        self.0.get(if path == "/" { "/index.html" } else { path })
    }
}

/// Adds the files of `folder`, whose path in the site is `prefix`.
fn add(folder: &Path, prefix: &str, files: &mut HashMap<String, File>) -> Result<()> {
    let listing = || format!("listing {}", folder.display());
    for entry in fs::read_dir(folder).with_context(listing)? {
        let path = entry.with_context(listing)?.path();
        let Some(name) = path.file_name().and_then(OsStr::to_str) else { continue };
        if path.is_dir() {
            add(&path, &format!("{prefix}{name}/"), files)?;
        } else {
            let body = fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
            files.insert(format!("{prefix}{name}"), File { kind: media_type(&path), body });
        }
    }
    Ok(())
}

fn media_type(path: &Path) -> &'static str {
    match path.extension().and_then(OsStr::to_str) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("png") => "image/png",
        Some("json") => "application/json",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
