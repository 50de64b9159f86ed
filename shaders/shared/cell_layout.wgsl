// The layout of a volume with a range of disparities per cell: where the words of a pixel are, four disparities packed
// per u32. The words of a pixel are contiguous, pixel by pixel and row by row; a pixel has as many as its cell.
//
// The module has `params` with `columns`, the cells per row, and `cells`; and the texture `words` with, for each row of
// the picture, the index of its first word in the volume of its band; then, from index `cells` on, for each cell the
// index of its first word in a row, and above 16 bits of its number of words the first word of its range, from the
// smallest disparity of the whole range.

#import words

// Constants:
//   CELL_BITS   log2 of the side of a cell, in pixels

// The words of a pixel.
struct Span {
    // Index of the first word in the volume; with `in_row`, in its row.
    start: u32,
    // The disparities, in words from the smallest of the whole range.
    first: u32,
    count: u32,
}

// The words of pixel (x, y) of the picture within its row.
fn in_row(x: u32, y: u32) -> Span {
    let cell = params.cells + 2u * ((y >> CELL_BITS) * params.columns + (x >> CELL_BITS));
    let range = word_at(cell + 1u);
    let count = range & 0xffffu;
    return Span(word_at(cell) + (x & ((1u << CELL_BITS) - 1u)) * count, range >> 16u, count);
}

// The words of pixel (x, y) of the picture.
fn span_at(x: u32, y: u32) -> Span {
    var span = in_row(x, y);
    span.start += word_at(y);
    return span;
}
