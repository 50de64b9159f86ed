// Calls of the library, which runs in a worker.

/** Largest side of a canvas that all browsers support, in pixels. */
const MAX_SIDE = 16384;

let worker;
/** The pending requests, by id. */
const waiting = new Map();
let lastId = 0;

/**
 * Decodes a picture file to red, green, blue and alpha, rotated by its EXIF orientation, without conversion of colours:
 * the same bytes as on the command line.
 *
 * @param {Blob} file
 * @param {string} name name of the file in errors
 * @returns {Promise<ImageData>}
 */
export async function decode(file, name) {
  let bytes;
  try {
    bytes = new Uint8Array(await file.arrayBuffer());
  } catch ({ message }) {
    throw badPicture(`${name}: ${message}`);
  }
  const { width, height, data } = await ask("decode", { bytes, name }, [bytes.buffer]);
  if (Math.max(width, height) > MAX_SIDE) {
    throw badPicture(`${name}: ${width}x${height} pixels, but a browser draws sides of at most ${MAX_SIDE} pixels: scale it down`);
  }
  return new ImageData(data, width, height);
}

function badPicture(message) {
  return Object.assign(new Error(message), { name: "BadPicture" });
}

/** The options of a match, as the command line has them: `name`, `kind`, `help`, and `choices` with `name` and `help`. */
export function options() {
  return ask("options", {}, []);
}

/**
 * Matches a pair.
 *
 * @param {{left: ImageData, right: ImageData, options: object}} pair
 * @param {({device, step}: {device?: string, step?: string}) => void} news called with the GPU's name and with each step
 */
export function match(pair, news) {
  return ask("match", pair, [], news);
}

function ask(act, request, transfer, news) {
  worker ??= startWorker();
  const id = ++lastId;
  return new Promise((resolve, reject) => {
    waiting.set(id, { resolve, reject, news });
    worker.postMessage({ id, act, request }, transfer);
  });
}

function startWorker() {
  const worker = new Worker("worker.js", { type: "module" });
  worker.onmessage = ({ data: { id, news, answer, error } }) => {
    if (error?.fatal) return dismiss(error.message);
    const { resolve, reject, news: tell } = waiting.get(id);
    if (news) return tell(news);
    waiting.delete(id);
    if (error) reject(error);
    else resolve(answer);
  };
  worker.onerror = ({ message }) => dismiss(message || "the worker could not be started");
  return worker;
}

/** Ends a worker after a panic, when it can no longer be used: pending requests fail, and the next one starts another. */
function dismiss(why) {
  worker?.terminate();
  worker = undefined;
  const left = [...waiting.values()];
  waiting.clear();
  for (const { reject } of left) reject({ name: "Broken", message: why });
}
