// Calls of the library, which runs in a worker.

/** Largest side of a canvas that all browsers support, in pixels. */
const MAX_SIDE = 16384;

let worker;
/** The pending requests, by id. */
const waiting = new Map();
let lastId = 0;

/**
 * Decodes the file of one view, of both views, or the files of both views, to red, green, blue and alpha, rotated by their EXIF
 * orientation, without conversion of colours: the same bytes as on the command line.
 *
 * @param {{file: Blob, name: string}[]} files one or two, left first; the names are for errors
 * @param {string} halves where both views lie in one picture, as `Loaded.one` of the bindings takes it
 * @returns {Promise<{views: ImageData[], stretch: number[], warnings: string[]}>}
 */
export async function decode(files, halves = "") {
  const given = await Promise.all(files.map(async ({ file, name }) => {
    try {
      return { bytes: new Uint8Array(await file.arrayBuffer()), name };
    } catch ({ message }) {
      throw badPicture(`${name}: ${message}`);
    }
  }));
  const loaded = await ask("decode", { files: given, halves }, given.map(({ bytes }) => bytes.buffer));
  const views = loaded.views.map(({ width, height, data }) => {
    if (Math.max(width, height) <= MAX_SIDE) return new ImageData(data, width, height);
    const { name } = files[0];
    throw badPicture(`${name}: ${width}x${height} pixels, but a browser draws sides of at most ${MAX_SIDE} pixels: scale it down`);
  });
  return { ...loaded, views };
}

function badPicture(message) {
  return Object.assign(new Error(message), { name: "BadPicture" });
}

/** The options of a match, as the command line has them: `name`, `kind`, `help`, and `choices` with `name` and `help`. */
export function options() {
  return ask("options", {});
}

/**
 * Matches a pair.
 *
 * @param {{left: ImageData, right: ImageData, task: object}} work the task as `Task::read` of the bindings takes it
 * @param {(news: {device?: string, step?: string, share?: number}) => void} news called with the GPU's name, with each step, and
 *   with the share of the last step that is done
 */
export function match(work, news) {
  return ask("match", work, [], news);
}

/** Cancels the match that is going on. */
export function cancel() {
  return ask("cancel", {});
}

/**
 * A file of a result: the bytes that the command writes.
 *
 * @param {{id: number}} result the latest one
 * @param {string} name one of the result's `files`
 * @returns {Promise<Uint8Array>}
 */
export function file({ id }, name) {
  return ask("file", { id, name });
}

function ask(act, request, transfer = [], news) {
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
