//! The files of a matched pair.

/// A file of a matched pair, as the command writes it and the page offers it. The command alone writes `mesh.ply`, where it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultFile {
    /// Disparities in pixels, floats.
    Disparities,
    /// Disparities as 16-bit grey.
    DisparityPng,
    /// The map in false colours.
    DisparityColors,
    /// Confidences as 8-bit grey.
    Confidences,
    /// Depths in metres, floats.
    Depths,
    /// Depths in millimetres as 16-bit grey.
    DepthPng,
    /// The point cloud.
    Cloud,
    /// Parameters, figures and doubts, and the list of files.
    Report,
}

impl ResultFile {
    /// All files, in the order in which they are offered.
    pub const ALL: [Self; 8] = [
        Self::Disparities,
        Self::DisparityPng,
        Self::DisparityColors,
        Self::Confidences,
        Self::Depths,
        Self::DepthPng,
        Self::Cloud,
        Self::Report,
    ];

    /// The name of the file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Disparities => "disparity.pfm",
            Self::DisparityPng => "disparity.png",
            Self::DisparityColors => "disparity-color.png",
            Self::Confidences => "confidence.png",
            Self::Depths => "depth.pfm",
            Self::DepthPng => "depth.png",
            Self::Cloud => "cloud.ply",
            Self::Report => "report.json",
        }
    }

    /// Whether there is the file only where depth follows from the disparities.
    pub const fn needs_depth(self) -> bool {
        matches!(self, Self::Depths | Self::DepthPng | Self::Cloud)
    }
}
