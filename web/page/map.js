// The disparity map with its colour scale, and the disparity under the mouse.

import { at } from "./dom.js";

/** The result on the page, with its disparities in pixels. */
let shown;

/** Shows the map of a result, `colors`, with the disparities of its pixels. */
export function showMap(result, colors, pixels) {
  shown = { ...result, pixels };
  const map = at("disparity");
  Object.assign(map, { width: result.width, height: result.height });
  map.getContext("2d").putImageData(colors, 0, 0);
  document.querySelector(".map").classList.add("loaded");
  legend(result);
}

export function clearMap() {
  shown = undefined;
  for (const id of ["scale", "probe"]) at(id).hidden = true;
  document.querySelector(".map").classList.remove("loaded");
  const map = at("disparity");
  map.getContext("2d").clearRect(0, 0, map.width, map.height);
}

/** Draws the colour scale from far to near. */
function legend({ colors, disparities, none, scale, colorRange: [far, near] }) {
  at("scale").hidden = false;
  at("far").textContent = `far ${far.toFixed(1)} px`;
  at("near").textContent = `${near.toFixed(1)} px near`;
  const canvas = at("scale").querySelector("canvas");
  const context = canvas.getContext("2d");
  const bar = context.createImageData(canvas.width, 1);
  // The colour of each disparity is sampled from the map's own pixels.
  const samples = new Array(canvas.width);
  disparities.forEach((disparity, index) => {
    if (disparity === none) return;
    const share = (disparity / scale - far) / (near - far || 1);
    if (share >= 0 && share <= 1) samples[Math.min(canvas.width - 1, Math.floor(share * canvas.width))] = index;
  });
  let last = samples.find((index) => index !== undefined) ?? 0;
  for (let x = 0; x < canvas.width; ++x) {
    last = samples[x] ?? last;
    bar.data.set(colors.subarray(4 * last, 4 * last + 4), 4 * x);
  }
  context.putImageData(bar, 0, 0);
}

/** Shows the disparity under the mouse. */
function probe({ offsetX, offsetY, currentTarget: map }) {
  if (!shown) return;
  const x = Math.min(shown.width - 1, Math.floor((offsetX / map.clientWidth) * shown.width));
  const y = Math.min(shown.height - 1, Math.floor((offsetY / map.clientHeight) * shown.height));
  const index = Math.max(0, y) * shown.width + Math.max(0, x);
  const disparity = shown.pixels[index];
  const kind = shown.confidences[index] ? "" : ", filled";
  at("probe").value = Number.isNaN(disparity) ? "none" : `${disparity.toFixed(2)} px${kind}`;
  at("probe").hidden = false;
}

export function listenOnMap() {
  at("disparity").onpointermove = probe;
  at("disparity").onpointerleave = () => (at("probe").hidden = true);
}
