// How a pair is matched: preset, range of disparities, and cameras.

import { at, made } from "./dom.js";
import * as library from "./library.js";

/** Files of a calibration, with `name` and `text`; `isExample` for that of the example. */
let calibration = { files: [], isExample: false };

/** Offers the presets that the library has, but those whose map is the right view's: the page shows the left one's. */
export async function offerPresets() {
  const { choices } = (await library.options()).find(({ name }) => name === "preset");
  const offered = choices.filter(({ name }) => name !== "paper").map(({ name, help }) => {
    const input = Object.assign(document.createElement("input"), { type: "radio", name: "preset", value: name });
    input.defaultChecked = name === "balanced";
    const label = made("label", "", input, made("span", "", name[0].toUpperCase() + name.slice(1)));
    label.title = help;
    return label;
  });
  at("preset").replaceChildren(made("legend", "unseen", "Preset"), ...offered);
}

/** The number in a field; undefined if it is empty. */
function number(id) {
  const { value, valueAsNumber } = at(id);
  return value === "" ? undefined : valueAsNumber;
}

/** The settings as the library takes them: options of matching and what is known of the cameras. */
export function settings() {
  const options = { preset: document.querySelector("input[name=preset]:checked").value };
  const [first, last] = [number("first"), number("last")];
  if (first !== undefined) options.min_disparity = first;
  if (last !== undefined) options.disparities = Math.max(0, last - (first ?? 0) + 1);
  const [focal, baseline, doffs] = ["focal", "baseline", "doffs"].map(number);
  const { files } = calibration;
  return { options, calibration: files.length ? { files } : focal && baseline ? { focal, baseline, doffs } : null };
}

/** Takes the calibration of the example. */
export function useExampleCamera(file) {
  calibration = { files: [file], isExample: true };
  showCalibration();
}

/** Leaves out the calibration of the example, since other pictures came. */
export function leaveExampleCamera() {
  if (calibration.isExample) leaveCalibration();
}

/** Whether an error is about a file of the calibration. */
export function isOfCalibration({ message }) {
  return calibration.files.some(({ name }) => message.startsWith(`${name}:`));
}

export function leaveCalibration() {
  calibration = { files: [], isExample: false };
  showCalibration();
}

/** Shows the names of the calibration's files in place of the fields. */
function showCalibration() {
  const { files } = calibration;
  at("calibrated").hidden = !files.length;
  at("fields").hidden = files.length > 0;
  at("calibration-name").textContent = files.map(({ name }) => name).join(", ");
}

/** Calls `changed` when a setting has changed, and `failed` with an error. */
export function listenForSettings(changed, failed) {
  at("preset").onchange = changed;
  for (const id of ["first", "last", "focal", "baseline", "doffs"]) at(id).onchange = changed;
  const input = at("calibration");
  input.onchange = async () => {
    try {
      const files = [...input.files];
      calibration = { files: await Promise.all(files.map(async (file) => ({ name: file.name, text: await file.text() }))), isExample: false };
      showCalibration();
      changed();
    } catch (error) {
      failed(error);
    }
    input.value = "";
  };
  at("uncalibrate").onclick = () => {
    leaveCalibration();
    changed();
    input.focus();
  };
}
