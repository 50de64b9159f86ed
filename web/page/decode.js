// Pictures as the bytes that their files hold.

/** The largest side of a canvas that all browsers have. */
const MAX_SIDE = 16384;

/**
 * Red, green, blue and alpha of a picture file, turned as its EXIF orientation says, without any conversion of colours.
 *
 * @param {Blob} blob
 * @param {string} name what to call it in errors
 * @returns {Promise<ImageData>}
 */
export async function decode(blob, name) {
  let bitmap;
  try {
    bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  } catch {
    throw Object.assign(new Error(`${name} is not a picture that this browser can read: use PNG, JPEG or WebP`), {
      name: "NoPicture",
    });
  }
  const { width, height } = bitmap;
  if (Math.max(width, height) > MAX_SIDE) {
    throw new Error(`${name} has ${width}x${height} pixels, and a side of ${MAX_SIDE} is the longest that a browser draws: scale it down`);
  }
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  return context.getImageData(0, 0, width, height);
}
