// The page: takes two pictures, has a worker match them, and shows the disparity map and the point cloud.

import { Cloud } from "./cloud.js";
import { at, isTouch } from "./dom.js";
import { offerFiles } from "./downloads.js";
import { showFacts } from "./facts.js";
import { clearMap, listenOnMap, showMap } from "./map.js";
import { Matching } from "./matching.js";
import * as messages from "./messages.js";
import { currentPair, exchange, listenForFiles, loadExample, missing, seemsToHaveBoth, splitInHalves } from "./pair.js";
import {
  isOfCalibration, leaveCalibration, leaveExampleCamera, listenForSettings, offerPresets, settings, useExampleCamera,
} from "./settings.js";

/** Horizontal angle of view assumed for an unknown camera, in radians. */
const ANGLE = (55 * Math.PI) / 180;

let cloud;
/** Disparities in pixels, confidences, and the largest confidence of what is filled, of the result on the page. */
let shown;

const matching = new Matching({
  begin: () => messages.begin(cancel),
  news: ({ device, ...news }) => (device ? named(device) : messages.progress(news)),
  done: show,
  failed: fail,
});

function match({ force = false } = {}) {
  const pair = currentPair();
  if (!pair) return askForPicture();
  const { left, right, ...files } = pair;
  const { options, calibration } = settings();
  matching.match({ left, right, task: { ...files, calibration, options: { ...options, force } } });
}

function askForPicture() {
  const side = missing() ?? "first";
  if (seemsToHaveBoth()) {
    const action = { label: "It has both views", run: splitInHalves };
    messages.say(`Now the ${side} picture`, "Or has this wide picture both views beside each other, the left one on the left?", { action });
  } else if (isTouch && side === "right") {
    messages.say("Now the right picture", "Move the camera to the right by a thirtieth of the distance to the scene, without turning it.");
  } else {
    messages.say(`Now the ${side} picture`, "Both views show one scene, from places beside each other.");
  }
}

function cancel() {
  matching.cancel();
  messages.say("Cancelled", "", { action: { label: "Match again", run: () => match() } });
}

/** Matches a pair whose camera is not that of the example. */
function matchOthers() {
  leaveExampleCamera();
  match();
}

async function matchExample() {
  try {
    useExampleCamera(await loadExample());
    match();
  } catch (error) {
    fail(error);
  }
}

function fail(error) {
  // A match in progress must not replace this message by its result.
  matching.forget();
  forget();
  const without = () => {
    leaveCalibration();
    match();
  };
  messages.failure(error, match, isOfCalibration(error) && currentPair() ? { label: "Match without it", run: without } : undefined);
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
}

/** Whether there is a result to see. */
function visible(there) {
  for (const id of ["tools", "help", "outputs"]) at(id).hidden = !there;
  at("cloud").tabIndex = there ? 0 : -1;
}

function show(result) {
  const { width, height, disparities, confidences, none, scale, filled, picture, trust, coverage } = result;
  const pixels = Float32Array.from(disparities, (disparity) => (disparity === none ? NaN : disparity / scale));
  shown = { pixels, confidences, filled };
  visible(true);
  showMap(result, pixels);
  showFacts(result);
  offerFiles(result, (error) => messages.failure(error, match, { label: "Back to the result", run: () => messages.done("") }));
  const image = (data) => new ImageData(new Uint8ClampedArray(data.buffer), width, height);
  cloud.show(image(picture), image(result.colors), chosen(), camera(result));
  // For scripts that drive the page, such as the tests.
  window.result = result;
  messages.done(`Matched: trust ${trust.toFixed(2)} of 1, ${(100 * coverage).toFixed(0)} % of the pixels have a disparity.`);
}

/** The camera of a result, or an assumed one. */
function camera({ width, height, camera: [focal, cx, cy, doffs] }) {
  if (focal) return { focal, principal: [cx, cy], doffs };
  return { focal: width / (2 * Math.tan(ANGLE / 2)), principal: [(width - 1) / 2, (height - 1) / 2], doffs: 0 };
}

/** The disparities in the cloud: all of them, or the measured ones only. */
function chosen() {
  const { pixels, confidences, filled } = shown;
  return at("measured").checked ? pixels.map((disparity, index) => (confidences[index] > filled ? disparity : NaN)) : pixels;
}

function listen() {
  listenForFiles(matchOthers, fail);
  listenForSettings(() => currentPair() && match(), fail);
  listenOnMap();
  at("example").onclick = matchExample;
  at("exchange").onclick = () => exchange() && matchOthers();
  at("measured").onchange = () => shown && cloud.change(chosen());
  at("painted").onchange = () => cloud.paint(at("painted").checked);
  at("home").onclick = () => cloud.home();
}

async function begin() {
  if (!navigator.gpu) {
    const text = isSecureContext
      ? "WebGPU is in Chrome and Edge since version 113, in Safari since 26, in Firefox since 141 on Windows and 145 on macOS. On Linux it may have to be turned on: chrome://flags/#enable-unsafe-webgpu."
      : "Browsers offer WebGPU only to pages from https or localhost, and this page comes from neither.";
    messages.say("This browser has no WebGPU", text, { bad: true });
    document.querySelectorAll("button, input, select").forEach((control) => (control.disabled = true));
    return;
  }
  try {
    cloud = new Cloud(at("cloud"));
    window.cloud = cloud;
    await offerPresets();
    listen();
    messages.say("Two photographs, one depth map", isTouch
      ? "Choose, or take, the left and the right view of one scene: the right one from a little further to the right."
      : "Drop a stereo pair anywhere on this page, two files or one with both views: of two files the first by name is the left view.", {
      action: { label: "Show the example", run: matchExample },
    });
  } catch (error) {
    fail(error);
  }
}

begin();
