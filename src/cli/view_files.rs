//! The files of a pair: one per view, or one with both.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use hsad::{
    Result,
    io::load::{Halves, LoadedPair, Unseen, decode_pair, decode_views, load_both, load_pair},
};

/// The files of a pair.
#[derive(Args)]
pub struct ViewOptions {
    /// Left view: PNG, JPEG, PNM, PFM, BMP, TIFF or WebP, of 8 bits, 16 bits or floats; or, without RIGHT, a file with both
    /// views: MPO of 3D cameras, JPS, or any picture with --side-by-side or --top-bottom
    left: PathBuf,
    /// Right view
    #[arg(group = "second_view")]
    right: Option<PathBuf>,
    #[command(flatten)]
    halves: HalvesOptions,
}

/// Where the views of a picture that has both lie.
#[derive(Args, Debug)]
pub struct HalvesOptions {
    /// The picture has both views beside each other, in this order: left-right for parallel viewing, right-left for crossed eyes, as
    /// in most JPS files (those that tell it need no option)
    #[arg(long, value_enum, value_name = "ORDER", group = "second_view")]
    side_by_side: Option<Order>,
    /// The picture has both views above each other, the first of the order on top
    #[arg(long, value_enum, value_name = "ORDER", group = "second_view")]
    top_bottom: Option<Order>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Order {
    LeftRight,
    RightLeft,
}

/// The files of a pair, and where the views of one with both lie.
pub struct Views<'a> {
    pub left: &'a Path,
    pub right: Option<&'a Path>,
    pub halves: Option<Halves>,
    /// The bytes of the picture files, if they are read already, or come from no files of these names.
    pub in_memory: Option<InMemory<'a>>,
}

/// Picture files in memory.
#[derive(Clone, Copy)]
pub enum InMemory<'a> {
    /// One with both views.
    Both(&'a [u8]),
    /// Those of the left and of the right view.
    Each([&'a [u8]; 2]),
}

impl ViewOptions {
    /// The files.
    pub fn views(&self) -> Views<'_> {
        Views { left: &self.left, right: self.right.as_deref(), halves: self.halves.halves(), in_memory: None }
    }
}

impl Views<'_> {
    /// The files of the left and of the right view, which may be one.
    pub fn paths(&self) -> [&Path; 2] {
        [self.left, self.right.unwrap_or(self.left)]
    }

    /// Loads both views.
    ///
    /// # Errors
    /// As [`load_pair`] and [`load_both`].
    pub fn load(&self, unseen: &Unseen) -> Result<LoadedPair> {
        let [left, right] = self.paths();
        match (self.in_memory, self.right) {
            (Some(InMemory::Both(bytes)), _) => decode_views(bytes, left, self.halves, unseen),
            (Some(InMemory::Each(bytes)), _) => decode_pair((bytes[0], left), (bytes[1], right), unseen),
            (None, Some(right)) => load_pair(self.left, right, unseen),
            (None, None) => load_both(self.left, self.halves, unseen),
        }
    }
}

impl HalvesOptions {
    /// Where the views lie, if it is told.
    pub fn halves(&self) -> Option<Halves> {
        let beside = self.side_by_side.map(|order| match order {
            Order::LeftRight => Halves::LeftRight,
            Order::RightLeft => Halves::RightLeft,
        });
        let above = self.top_bottom.map(|order| match order {
            Order::LeftRight => Halves::LeftOnTop,
            Order::RightLeft => Halves::RightOnTop,
        });
        beside.or(above)
    }
}
