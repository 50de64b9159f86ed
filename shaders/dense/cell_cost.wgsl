// Matching cost of each pixel at the disparities of its cell: this text, then cost.wgsl.

#import cell_layout

@group(0) @binding(4) var words: texture_storage_2d<r32uint, read>;

