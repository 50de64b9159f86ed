// The layout of a volume with one range of disparities for all pixels: where the words of a pixel are, four disparities
// packed per u32.
//
// The module has `params` with `width`, `top` and `pixel_words`.

// The words of a pixel.
struct Span {
    // Index of the first word in the volume.
    start: u32,
    // The disparities, in words from the smallest of the range.
    first: u32,
    count: u32,
}

// The words of pixel (x, y) of the picture.
fn span_at(x: u32, y: u32) -> Span {
    return Span(((y - params.top) * params.width + x) * params.pixel_words, 0u, params.pixel_words);
}
