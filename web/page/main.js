// The page: takes two pictures, has a worker match them, and shows the disparity map and the point cloud.

import { Cloud } from "./cloud.js";
import * as library from "./library.js";

const SIDES = ["left", "right"];
const STEPS = [["luma", "luma"], ["features", "interest points"], ["seeding", "range"], ["dense", "disparities"]];
/** Horizontal angle of view assumed for an unknown camera, in radians. */
const ANGLE = (55 * Math.PI) / 180;

const at = (id) => document.getElementById(id);

/** The picture of each side. */
const pair = { left: undefined, right: undefined };
/** The camera of the pair; undefined if unknown. */
let camera;
let cloud;
/** The result on the page, with its disparities in pixels. */
let shown;
/** Whether a pair is being matched. */
let busy = false;
/** The request that came in meanwhile; only the latest one is kept. */
let next;
/** The pair being matched; undefined once its result is obsolete. */
let awaited;

// Messages

/** Creates an element with text or elements in it. */
function made(tag, className, ...content) {
  const element = document.createElement(tag);
  element.className = className;
  element.append(...content);
  return element;
}

function say(title, text = "", { bad = false, action } = {}) {
  const card = made("div", bad ? "card bad" : "card", made("h2", "", title));
  if (text) card.append(made("p", "", text));
  if (action) {
    const button = made("button", "", action.label);
    button.onclick = action.run;
    card.append(button);
  }
  at("message").replaceChildren(card);
  document.body.dataset.state = bad ? "failed" : "idle";
}

/** Shows the steps of matching, with the current one marked. */
function progress(now) {
  const current = STEPS.findIndex(([name]) => name === now);
  const items = STEPS.map(([, label], index) => made("li", index < current ? "done" : index === current ? "now" : "", label));
  const card = made("div", "card", made("h2", "", "Matching"), made("ul", "steps", ...items));
  at("message").replaceChildren(card);
  document.body.dataset.state = "busy";
}

const HEADLINES = {
  BadPicture: "This picture cannot be used",
  SizesDiffer: "The pictures differ in size",
  NotRectified: "This pair is not rectified",
  NoAdapter: "No GPU for this page",
  TooLarge: "Too large for this GPU",
  DeviceLost: "The GPU was lost",
  Broken: "The computation broke off",
};

function fail({ name, message }) {
  // A match in progress must not replace this message by its result.
  awaited = next = undefined;
  const again = { label: "Try again", run: () => match() };
  const actions = {
    NotRectified: { label: "Match it anyway", run: () => match({ force: true }) },
    NoAdapter: again,
    DeviceLost: again,
    Broken: again,
  };
  const text =
    name === "NoAdapter"
      ? "The browser has WebGPU, but offers no adapter: see chrome://gpu, update the GPU's driver, or use another browser."
      : name === "Broken"
        ? `Memory ran out, or the library has a fault; see the browser's console for details (${message}).`
        : name === "BadPicture"
          ? message // The message begins with the file's name.
          : message[0].toUpperCase() + message.slice(1);
  forget();
  say(HEADLINES[name] ?? "This could not be matched", text, { bad: true, action: actions[name] });
}

// Input

function put(side, picture) {
  pair[side] = picture;
  const view = at(side);
  const canvas = view.querySelector("canvas");
  Object.assign(canvas, { width: picture.width, height: picture.height });
  canvas.getContext("2d").putImageData(picture, 0, 0);
  view.classList.add("loaded");
}

/** Loads one picture for a side, or two for both sides in the order of their names. */
async function take(files, side) {
  files = [...files].sort((a, b) => a.name.localeCompare(b.name, "en", { numeric: true }));
  const sides = files.length > 1 ? SIDES : [side ?? (pair.left && !pair.right ? "right" : "left")];
  try {
    if (files.length > 2) throw new Error(`${files.length} files were dropped: one picture is needed for each side`);
    const pictures = await Promise.all(files.map((file) => library.decode(file, file.name)));
    pictures.forEach((picture, index) => put(sides[index], picture));
    camera = undefined;
    match();
  } catch (error) {
    fail(error);
  }
}

async function loadExample() {
  const file = async (name) => {
    const response = await fetch(`example/${name}`);
    if (!response.ok) throw new Error(`the server has no example/${name}: ${response.status}`);
    return response;
  };
  try {
    const [left, right, meta] = await Promise.all([
      ...SIDES.map(async (side) => library.decode(await (await file(`${side}.png`)).blob(), `${side}.png`)),
      file("meta.json").then((response) => response.json()),
    ]);
    put("left", left);
    put("right", right);
    const [, cx, cy] = meta.calib_txt.match(/cam0=\[\S+ \S+ (\S+); \S+ \S+ (\S+);/);
    camera = { focal: meta.focal_px, principal: [Number(cx), Number(cy)], doffs: meta.doffs_px };
    match();
  } catch (error) {
    fail(error);
  }
}

// Matching

async function match({ force = false } = {}) {
  if (!pair.left || !pair.right) {
    const missing = pair.left ? "right" : pair.right ? "left" : "first";
    say(`Now the ${missing} picture`, "Both views of one scene, rectified: corresponding points lie in the same row.");
    return;
  }
  next = { force };
  if (busy) {
    if (!awaited) progress();
    return;
  }
  occupied(true);
  while (next) {
    const { force } = next;
    next = undefined;
    const preset = document.querySelector("input[name=preset]:checked").value;
    const work = (awaited = { ...pair, options: { preset, force } });
    progress();
    try {
      const result = await library.match(work, ({ device, step }) => {
        if (device) named(device);
        else if (awaited === work) progress(step);
      });
      if (awaited === work && !next) show(result);
    } catch (error) {
      if (awaited === work && !next) fail(error);
    }
  }
  occupied(false);
}

function occupied(now) {
  busy = now;
  document.body.ariaBusy = now;
}

function named(device) {
  at("device").value = device;
  at("device").hidden = false;
}

// Results

function forget() {
  shown = undefined;
  cloud?.clear();
  for (const id of ["scale", "probe", "tools", "help"]) at(id).hidden = true;
  document.querySelector(".map").classList.remove("loaded");
  const map = at("disparity");
  map.getContext("2d").clearRect(0, 0, map.width, map.height);
  at("facts").replaceChildren();
}

function show(result) {
  const { width, height, disparities, none, scale } = result;
  const colors = new ImageData(new Uint8ClampedArray(result.colors.buffer), width, height);
  const map = at("disparity");
  Object.assign(map, { width, height });
  map.getContext("2d").putImageData(colors, 0, 0);
  document.querySelector(".map").classList.add("loaded");

  const pixels = Float32Array.from(disparities, (disparity) => (disparity === none ? NaN : disparity / scale));
  shown = { ...result, pixels };
  at("message").replaceChildren();
  at("tools").hidden = at("help").hidden = false;
  legend(result);
  facts(result);
  cloud.show(pair.left, colors, chosen(), camera ?? {
    focal: width / (2 * Math.tan(ANGLE / 2)),
    principal: [(width - 1) / 2, (height - 1) / 2],
    doffs: 0,
  });
  // For scripts that drive the page, such as the tests.
  window.result = result;
  document.body.dataset.state = "done";
}

/** The disparities in the cloud: all of them, or the measured ones only. */
function chosen() {
  if (!at("measured").checked) return shown.pixels;
  return shown.pixels.map((disparity, index) => (shown.confidences[index] ? disparity : NaN));
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

function facts(result) {
  const percent = (share) => `${(100 * share).toFixed(1)} %`;
  const seconds = (milliseconds) => `${(milliseconds / 1000).toFixed(2)}\u00a0s`;
  const steps = STEPS.map(([, label], index) => `${label} ${seconds(result.times[index])}`).join(", ");
  const filled = result.measured < result.coverage ? `${percent(result.measured)} measured, the rest filled` : "";
  const [rows, ...agreeing] = result.rectification.split(/ (?=\()/);
  const list = [
    ["Time", seconds(result.milliseconds), steps, "large"],
    ["Range", `${result.first} to ${result.last} px`, result.found ? `found from ${result.matches} matches` : "assumed: too few matches"],
    ["Rows", rows.replace("rows correspond as they are, 95 %", "agree"), agreeing.join(" ").replace(/[()]/g, "")],
    ["Coverage", percent(result.coverage), filled],
    ["Trust", `${result.trust.toFixed(2)} of 1`],
    ["Size", `${result.width} × ${result.height}`],
  ];
  at("facts").replaceChildren(
    ...list.flatMap(([name, value, detail, className = ""]) => {
      const fact = made("dd", className, value);
      if (detail) fact.append(made("small", "", detail));
      return [made("dt", "", name), fact];
    }),
  );
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

// Events

function listen() {
  for (const side of SIDES) {
    const input = at(side).querySelector("input");
    input.multiple = true;
    input.onchange = () => {
      if (input.files.length) take(input.files, side);
      input.value = "";
    };
  }
  let inside = 0;
  const over = (change) => {
    inside = Math.max(0, inside + change);
    document.body.classList.toggle("over", inside > 0);
  };
  addEventListener("dragenter", () => over(1));
  addEventListener("dragleave", () => over(-1));
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    over(-inside);
    const { files } = event.dataTransfer;
    if (files.length) take(files, event.target.closest?.(".view")?.id);
    else fail(new Error("no file was dropped: drop pictures from a folder"));
  });
  at("example").onclick = loadExample;
  at("exchange").onclick = () => {
    const { left, right } = pair;
    if (!left || !right) return;
    put("left", right);
    put("right", left);
    camera = undefined;
    match();
  };
  at("preset").onchange = () => pair.left && pair.right && match();
  at("measured").onchange = () => shown && cloud.change(chosen());
  at("painted").onchange = () => cloud.paint(at("painted").checked);
  at("home").onclick = () => cloud.home();
  at("disparity").onpointermove = probe;
  at("disparity").onpointerleave = () => (at("probe").hidden = true);
}

/** Offers the presets that the library has, but those whose map is the right view's: the page shows the left one's. */
async function offerPresets() {
  const { choices } = (await library.options()).find(({ name }) => name === "preset");
  const offered = choices.filter(({ name }) => name !== "paper").map(({ name, help }) => {
    const input = Object.assign(document.createElement("input"), { type: "radio", name: "preset", value: name });
    input.defaultChecked = name === "balanced";
    const label = made("label", "", input, made("span", "", name[0].toUpperCase() + name.slice(1)));
    label.title = help;
    return label;
  });
  at("preset").replaceChildren(...offered);
}

async function begin() {
  if (!navigator.gpu) {
    const text = isSecureContext
      ? "WebGPU is in Chrome and Edge since version 113, in Safari since 26, in Firefox since 141 on Windows and 145 on macOS. On Linux it may have to be turned on: chrome://flags/#enable-unsafe-webgpu."
      : "Browsers offer WebGPU only to pages from https or localhost, and this page comes from neither.";
    say("This browser has no WebGPU", text, { bad: true });
    document.querySelectorAll("button, input").forEach((control) => (control.disabled = true));
    return;
  }
  try {
    cloud = new Cloud(at("cloud"));
    window.cloud = cloud;
    await offerPresets();
    listen();
    say("Two photographs, one depth map", "Drop a rectified stereo pair anywhere on this page: of the two files, the first by name is the left view.", {
      action: { label: "Show the example", run: loadExample },
    });
  } catch (error) {
    fail(error);
  }
}

begin();
