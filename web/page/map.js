// The disparity map with its colour scale, and the disparity at a place of it.

import { at } from "./dom.js";

/** The result on the page, with its disparities in pixels. */
let shown;

/** Shows the map of a result, `colors`, with the disparities of its pixels. */
export function showMap(result, colors, pixels) {
  shown = { ...result, pixels };
  const map = at("disparity");
  Object.assign(map, { width: result.width, height: result.height });
  map.getContext("2d").putImageData(colors, 0, 0);
  map.style.setProperty("--aspect", result.width / result.height);
  legend(result);
}

export function clearMap() {
  shown = undefined;
  at("probe").hidden = at("marker").hidden = true;
}

/** Draws the colour scale from far to near. */
function legend({ colors, disparities, none, scale, colorRange: [far, near] }) {
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

/** Shows the disparity at a place of the map, in pixels of the map. */
function probe(x, y) {
  const index = y * shown.width + x;
  const disparity = shown.pixels[index];
  const kind = shown.confidences[index] ? "" : ", filled";
  at("probe").value = Number.isNaN(disparity) ? "none" : `${disparity.toFixed(2)} px${kind}`;
  at("probe").hidden = false;
}

const within = (value, count) => Math.min(count - 1, Math.max(0, Math.floor(value)));

/** Listens for the mouse and for arrow keys, which move a marker: by a pixel with shift, else by a fiftieth of the map. */
export function listenOnMap() {
  const [map, marker] = [at("disparity"), at("marker")];
  const hide = () => (at("probe").hidden = marker.hidden = true);
  map.onpointermove = map.onpointerdown = ({ offsetX, offsetY }) => {
    if (!shown) return;
    marker.hidden = true;
    probe(within((offsetX / map.clientWidth) * shown.width, shown.width), within((offsetY / map.clientHeight) * shown.height, shown.height));
  };
  map.onpointerleave = map.onblur = hide;
  map.onkeydown = (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!way || !shown) return;
    event.preventDefault();
    const { width, height } = shown;
    const step = event.shiftKey ? 1 : Math.max(1, Math.round(width / 50));
    const { x, y } = shown.marked ?? { x: width >> 1, y: height >> 1 };
    shown.marked = { x: within(x + step * way[0], width), y: within(y + step * way[1], height) };
    marker.style.left = `${map.offsetLeft + ((shown.marked.x + 0.5) / width) * map.clientWidth}px`;
    marker.style.top = `${((shown.marked.y + 0.5) / height) * map.clientHeight}px`;
    marker.hidden = false;
    probe(shown.marked.x, shown.marked.y);
  };
}
