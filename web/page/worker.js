// The worker: decodes pictures, matches pairs and writes files, so that the page stays responsive.

import init, { Loaded, Session, View, options } from "./hsad_web.js";

const ready = init();
let session;
/** The latest result, with the id of its request. */
let latest;
/** The id of the match that is going on; undefined once it was cancelled. */
let wanted;

/** The requests: each takes its arguments and returns the answer and the buffers to transfer instead of copy. */
const acts = {
  decode({ files, halves }) {
    const [first, second] = files;
    const loaded = second
      ? Loaded.pair(first.bytes, first.name, second.bytes, second.name)
      : Loaded.one(first.bytes, first.name, halves);
    const views = [];
    for (let view; (view = loaded.take()); ) views.push(picture(view));
    const answer = { views, stretch: [...loaded.stretch()], warnings: loaded.warnings() };
    loaded.free();
    return [answer, views.map(({ data }) => data.buffer)];
  },

  options: () => [options(), []],

  async match({ left, right, task }, tell, id) {
    wanted = id;
    session ??= await Session.open();
    tell({ device: await adapterName() });
    if (wanted !== id) throw Object.assign(new Error("the match was cancelled"), { name: "Cancelled" });
    const view = ({ width, height, data }) => new View(width, height, new Uint8Array(data.buffer));
    const begin = (step) => tell({ step });
    const progress = (share) => tell({ share });
    const matched = await session.matchPair(view(left), view(right), JSON.stringify(task), begin, progress);
    latest?.matched.free();
    latest = { id, matched };
    const names = [
      "first", "last", "source", "matches", "rectification", "rectified", "trust", "trusted", "notTrusted", "coverage", "measured",
      "filled", "milliseconds", "scale", "none",
    ];
    const { width, height, data } = picture(matched.picture());
    const result = {
      id,
      ...Object.fromEntries(names.map((name) => [name, matched[name]])),
      preset: task.options.preset,
      width,
      height,
      picture: data,
      disparities: matched.disparities(),
      confidences: matched.confidences(),
      colors: matched.colors(),
      colorRange: matched.colorRange(),
      camera: matched.camera(),
      warnings: matched.warnings(),
      files: matched.files(),
      offered: JSON.parse(matched.offered()),
      times: matched.times(),
    };
    const { disparities, confidences, colors } = result;
    return [result, [data.buffer, disparities.buffer, confidences.buffer, colors.buffer]];
  },

  cancel() {
    wanted = undefined;
    session?.cancel();
    return [undefined, []];
  },

  file({ id, name }) {
    if (latest?.id !== id) throw new Error("another pair was matched meanwhile");
    const bytes = latest.matched.file(name);
    return [bytes, [bytes.buffer]];
  },
};

/** Size and pixels of a view, which is freed. */
function picture(view) {
  const { width, height } = view;
  const data = view.rgba();
  view.free();
  return { width, height, data };
}

/** The name of the GPU, as far as the browser reveals it. */
async function adapterName() {
  const info = (await navigator.gpu.requestAdapter())?.info;
  const name = info?.description || [info?.vendor, info?.architecture].filter(Boolean).join(" ") || "WebGPU";
  return info?.isFallbackAdapter ? `${name} (software)` : name;
}

onmessage = async ({ data: { id, act, request } }) => {
  try {
    await ready;
    const [answer, transfer] = await acts[act](request, (news) => postMessage({ id, news }), id);
    postMessage({ id, answer }, transfer);
  } catch (error) {
    if (error.name === "DeviceLost") session = undefined;
    // A panic leaves the library unusable.
    const fatal = error instanceof WebAssembly.RuntimeError;
    postMessage({ id, error: { name: error.name ?? "Error", message: error.message ?? String(error), fatal } });
  }
};
