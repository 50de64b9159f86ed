// Reads pictures and matches pairs beside the page, which stays usable meanwhile.

import init, { Session, View } from "./hsad_web.js";

const ready = init();
let session;

/** What can be asked for: from a request to the answer, and what of it is handed over instead of copied. */
const acts = {
  decode({ bytes, name }) {
    const view = View.decode(bytes, name);
    const picture = { width: view.width, height: view.height, data: view.rgba() };
    view.free();
    return [picture, [picture.data.buffer]];
  },

  async match({ left, right, preset, force }, tell) {
    session ??= await Session.open();
    tell({ device: await adapterName() });
    const view = ({ width, height, data }) => new View(width, height, new Uint8Array(data.buffer));
    const matched = await session.matchPair(view(left), view(right), preset, force, (step) => tell({ step }));
    const { first, last, found, matches, rectification, trust, coverage, measured, milliseconds, scale, none } = matched;
    const result = {
      first, last, found, matches, rectification, trust, coverage, measured, milliseconds, scale, none, preset,
      width: left.width,
      height: left.height,
      disparities: matched.disparities(),
      confidences: matched.confidences(),
      colors: matched.colors(),
      colorRange: matched.colorRange(),
      times: matched.times(),
    };
    matched.free();
    const { disparities, confidences, colors } = result;
    return [result, [disparities.buffer, confidences.buffer, colors.buffer]];
  },
};

/** What the browser tells of its GPU, which may be little. */
async function adapterName() {
  const info = (await navigator.gpu.requestAdapter())?.info;
  const name = info?.description || [info?.vendor, info?.architecture].filter(Boolean).join(" ") || "WebGPU";
  return info?.isFallbackAdapter ? `${name} (software)` : name;
}

onmessage = async ({ data: { id, act, request } }) => {
  try {
    await ready;
    const [answer, transfer] = await acts[act](request, (news) => postMessage({ id, news }));
    postMessage({ id, answer }, transfer);
  } catch (error) {
    if (error.name === "DeviceLost") session = undefined;
    // A panic, after which nothing of the library can be used again.
    const fatal = error instanceof WebAssembly.RuntimeError;
    postMessage({ id, error: { name: error.name ?? "Error", message: error.message ?? String(error), fatal } });
  }
};
