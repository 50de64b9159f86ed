// The files of a result, which the library writes: the bytes of the command's files.

import { at, made } from "./dom.js";
import * as library from "./library.js";

/** What is offered: file, label, and what it is. */
const OFFERED = [
  ["disparity.pfm", "PFM", "Disparities in pixels, floats; inf where there is none"],
  ["disparity.png", "PNG", "Disparities as 16-bit grey, 256 per pixel, 0 where there is none; negative ones by an offset in its text"],
  ["disparity-color.png", "Colours", "The map in false colours"],
  ["confidence.png", "Confidence", "Confidences as 8-bit grey"],
  ["depth.pfm", "Depth PFM", "Depths in metres, floats"],
  ["depth.png", "Depth PNG", "Depths in millimetres as 16-bit grey, 0 where there is none"],
  ["cloud.ply", "PLY", "The point cloud in metres, of measured pixels"],
  ["report.json", "Report", "Parameters, figures and doubts as JSON"],
];

/** Offers the files of a result; calls `failed` with an error. */
export function offerFiles(result, failed) {
  const buttons = OFFERED.map(([name, label, title]) => {
    const button = made("button", "", label);
    const isThere = result.files.includes(name);
    Object.assign(button, { title: `${title} (${name})`, disabled: !isThere, onclick: () => save(result, name).catch(failed) });
    return button;
  });
  at("save").replaceChildren(made("span", "", "Save"), ...buttons);
  at("no-depth").hidden = result.files.includes("cloud.ply");
}

async function save(result, name) {
  const url = URL.createObjectURL(new Blob([await library.file(result, name)]));
  Object.assign(document.createElement("a"), { href: url, download: name }).click();
  // The download has begun by then.
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
