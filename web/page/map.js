// The map, disparities or confidences, with its scale, and the values at a place of it.

import { at } from "./dom.js";

/** The result on the page, with its disparities in pixels. */
let shown;

/** Shows the map of a result, with the disparities of its pixels. */
export function showMap(result, pixels) {
  shown = { ...result, pixels };
  const map = at("disparity");
  Object.assign(map, { width: result.width, height: result.height });
  map.style.setProperty("--aspect", result.width / result.height);
  draw();
}

export function clearMap() {
  shown = undefined;
  at("probe").hidden = at("marker").hidden = true;
}

const showsConfidences = () => document.querySelector("input[name=view]:checked").value === "confidence";

/** Draws the disparities or the confidences, with their scale. */
function draw() {
  if (!shown) return;
  const { width, height, colors, confidences, colorRange: [far, near] } = shown;
  const isConfidence = showsConfidences();
  const rgba = new Uint8ClampedArray(isConfidence ? greys(confidences) : colors);
  at("disparity").getContext("2d").putImageData(new ImageData(rgba, width, height), 0, 0);
  at("disparity").ariaLabel = `${isConfidence ? "Confidences" : "Disparity map"}: arrow keys read pixels`;
  at("far").textContent = isConfidence ? "0 doubtful" : `far ${far.toFixed(1)} px`;
  at("near").textContent = isConfidence ? "255 sure" : `${near.toFixed(1)} px near`;
  const canvas = at("scale").querySelector("canvas");
  const bar = isConfidence ? greys(Uint8Array.from({ length: canvas.width }, (_, grey) => grey)) : colorScale(shown, canvas.width);
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(bar), canvas.width, 1), 0, 0);
}

/** The RGBA bytes of grey values. */
function greys(values) {
  const rgba = new Uint8ClampedArray(4 * values.length);
  values.forEach((value, index) => rgba.fill(value, 4 * index, 4 * index + 3));
  for (let alpha = 3; alpha < rgba.length; alpha += 4) rgba[alpha] = 255;
  return rgba;
}

/** The RGBA bytes of the colour scale from far to near: the colour of each disparity is sampled from the map's own pixels. */
function colorScale({ colors, disparities, none, scale, colorRange: [far, near] }, width) {
  const samples = new Array(width);
  disparities.forEach((disparity, index) => {
    if (disparity === none) return;
    const share = (disparity / scale - far) / (near - far || 1);
    if (share >= 0 && share <= 1) samples[Math.min(width - 1, Math.floor(share * width))] = index;
  });
  const bar = new Uint8ClampedArray(4 * width);
  let last = samples.find((index) => index !== undefined) ?? 0;
  for (let x = 0; x < width; ++x) {
    last = samples[x] ?? last;
    bar.set(colors.subarray(4 * last, 4 * last + 4), 4 * x);
  }
  return bar;
}

/** Shows disparity and confidence at a place of the map, in pixels of the map. */
function probe(x, y) {
  const index = y * shown.width + x;
  const [disparity, confidence] = [shown.pixels[index], shown.confidences[index]];
  const kind = confidence > shown.filled ? "" : confidence ? " (filled)" : " (doubtful)";
  at("probe").value = Number.isNaN(disparity) ? "none" : `${disparity.toFixed(2)} px, confidence ${confidence}${kind}`;
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
  at("view").onchange = draw;
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
