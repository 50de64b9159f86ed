// The worker: decodes pictures and matches pairs, so that the page stays responsive.

import init, { Session, View, options } from "./hsad_web.js";

const ready = init();
let session;

/** The requests: each takes its arguments and returns the answer and the buffers to transfer instead of copy. */
const acts = {
  decode({ bytes, name }) {
    const view = View.decode(bytes, name);
    const picture = { width: view.width, height: view.height, data: view.rgba() };
    view.free();
    return [picture, [picture.data.buffer]];
  },

  options: () => [options(), []],

  async match({ left, right, options }, tell) {
    session ??= await Session.open();
    tell({ device: await adapterName() });
    const view = ({ width, height, data }) => new View(width, height, new Uint8Array(data.buffer));
    const matched = await session.matchPair(view(left), view(right), options, (step) => tell({ step }));
    const { first, last, found, matches, rectification, trust, coverage, measured, milliseconds, scale, none } = matched;
    const result = {
      first, last, found, matches, rectification, trust, coverage, measured, milliseconds, scale, none,
      preset: options.preset,
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

/** The name of the GPU, as far as the browser reveals it. */
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
    // A panic leaves the library unusable.
    const fatal = error instanceof WebAssembly.RuntimeError;
    postMessage({ id, error: { name: error.name ?? "Error", message: error.message ?? String(error), fatal } });
  }
};
