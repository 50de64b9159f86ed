// The library, in a worker.

/** The largest side of a canvas that all browsers have. */
const MAX_SIDE = 16384;

let worker;
/** Who waits for an answer, by the number of what was asked. */
const waiting = new Map();
let asked = 0;

/**
 * Red, green, blue and alpha of a picture file, turned as its EXIF orientation says, without any conversion of colours:
 * the bytes that the command line reads too.
 *
 * @param {Blob} file
 * @param {string} name what to call it in errors
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
    throw badPicture(`${name}: ${width}x${height} pixels, and a side of ${MAX_SIDE} is the longest that a browser draws: scale it down`);
  }
  return new ImageData(data, width, height);
}

function badPicture(message) {
  return Object.assign(new Error(message), { name: "BadPicture" });
}

/**
 * Matches a pair.
 *
 * @param {{left: ImageData, right: ImageData, preset: string, force: boolean}} pair
 * @param {({device, step}: {device?: string, step?: string}) => void} news is told the GPU's name and each step
 */
export function match(pair, news) {
  return ask("match", pair, [], news);
}

function ask(act, request, transfer, news) {
  worker ??= hire();
  const id = ++asked;
  return new Promise((resolve, reject) => {
    waiting.set(id, { resolve, reject, news });
    worker.postMessage({ id, act, request }, transfer);
  });
}

function hire() {
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

/** After a panic nothing of it can be used again: whoever waits is told, and the next request gets another worker. */
function dismiss(why) {
  worker?.terminate();
  worker = undefined;
  const left = [...waiting.values()];
  waiting.clear();
  for (const { reject } of left) reject({ name: "Broken", message: why });
}
