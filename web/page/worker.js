// Matches pairs beside the page, which stays usable meanwhile.

import init, { Session, View } from "./hsad_web.js";

const ready = init();
let session;

/** What the browser tells of its GPU, which may be little. */
async function adapterName() {
  const info = (await navigator.gpu.requestAdapter())?.info;
  const name = info?.description || [info?.vendor, info?.architecture].filter(Boolean).join(" ") || "WebGPU";
  return info?.isFallbackAdapter ? `${name} (software)` : name;
}

onmessage = async ({ data: { left, right, preset, force } }) => {
  try {
    await ready;
    session ??= await Session.open();
    postMessage({ device: await adapterName() });
    const view = ({ width, height, data }) => new View(width, height, new Uint8Array(data.buffer));
    const matched = await session.matchPair(view(left), view(right), preset, force, (step) => postMessage({ step }));
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
    postMessage({ result }, [disparities.buffer, confidences.buffer, colors.buffer]);
  } catch (error) {
    // A lost device, or a panic of the library, leaves nothing that could be used again.
    if (error.name === "DeviceLost") session = undefined;
    const fatal = error instanceof WebAssembly.RuntimeError;
    postMessage({ error: { name: error.name ?? "Error", message: error.message ?? String(error), fatal } });
  }
};
