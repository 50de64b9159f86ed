// The page: takes two pictures, has a worker match them, and shows the disparity map and the point cloud.

import { Cloud } from "./cloud.js";
import { at, isTouch } from "./dom.js";
import { clearFacts, showFacts } from "./facts.js";
import { clearMap, listenOnMap, showMap } from "./map.js";
import { Matching } from "./matching.js";
import { done, failure, progress, say } from "./messages.js";
import { exchange, listenForFiles, loadExample, pair } from "./pair.js";
import { chosenPreset, offerPresets } from "./presets.js";

/** Horizontal angle of view assumed for an unknown camera, in radians. */
const ANGLE = (55 * Math.PI) / 180;

/** The camera of the pair; undefined if unknown. */
let camera;
let cloud;
/** Disparities in pixels and confidences of the result on the page. */
let shown;

const matching = new Matching({
  begin: () => progress(),
  news: ({ device, step }) => (device ? named(device) : progress(step)),
  done: show,
  failed: fail,
});

function match({ force = false } = {}) {
  if (pair.left && pair.right) {
    matching.match({ ...pair, options: { preset: chosenPreset(), force } });
    return;
  }
  const missing = pair.left ? "right" : pair.right ? "left" : "first";
  say(`Now the ${missing} picture`, "Both views of one scene, rectified: corresponding points lie in the same row.");
}

/** Matches a pair whose camera is not known, or not any more. */
function matchUnknown() {
  camera = undefined;
  match();
}

async function matchExample() {
  try {
    camera = await loadExample();
    match();
  } catch (error) {
    fail(error);
  }
}

function fail(error) {
  // A match in progress must not replace this message by its result.
  matching.forget();
  forget();
  failure(error, match);
}

function named(device) {
  at("device").value = device;
  at("device").hidden = false;
}

function forget() {
  shown = undefined;
  cloud?.clear();
  visible(false);
  clearMap();
  clearFacts();
}

/** Whether there is a result to see. */
function visible(there) {
  for (const id of ["tools", "help", "outputs"]) at(id).hidden = !there;
  at("cloud").tabIndex = there ? 0 : -1;
}

function show(result) {
  const { width, height, disparities, confidences, none, scale } = result;
  const colors = new ImageData(new Uint8ClampedArray(result.colors.buffer), width, height);
  const pixels = Float32Array.from(disparities, (disparity) => (disparity === none ? NaN : disparity / scale));
  shown = { pixels, confidences };
  visible(true);
  showMap(result, colors, pixels);
  showFacts(result);
  cloud.show(pair.left, colors, chosen(), camera ?? {
    focal: width / (2 * Math.tan(ANGLE / 2)),
    principal: [(width - 1) / 2, (height - 1) / 2],
    doffs: 0,
  });
  // For scripts that drive the page, such as the tests.
  window.result = result;
  done(`Matched: trust ${result.trust.toFixed(2)} of 1, ${(100 * result.coverage).toFixed(0)} % of the pixels have a disparity.`);
}

/** The disparities in the cloud: all of them, or the measured ones only. */
function chosen() {
  const { pixels, confidences } = shown;
  return at("measured").checked ? pixels.map((disparity, index) => (confidences[index] ? disparity : NaN)) : pixels;
}

function listen() {
  listenForFiles(matchUnknown, fail);
  listenOnMap();
  at("example").onclick = matchExample;
  at("exchange").onclick = () => exchange() && matchUnknown();
  at("preset").onchange = () => pair.left && pair.right && match();
  at("measured").onchange = () => shown && cloud.change(chosen());
  at("painted").onchange = () => cloud.paint(at("painted").checked);
  at("home").onclick = () => cloud.home();
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
    say("Two photographs, one depth map", isTouch
      ? "Choose the left and the right view of one scene, rectified: corresponding points lie in the same row."
      : "Drop a rectified stereo pair anywhere on this page: of the two files, the first by name is the left view.", {
      action: { label: "Show the example", run: matchExample },
    });
  } catch (error) {
    fail(error);
  }
}

begin();
