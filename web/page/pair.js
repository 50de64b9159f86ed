// The two pictures: from files, dropped or chosen, or from the example.

import { at } from "./dom.js";
import * as library from "./library.js";

const SIDES = ["left", "right"];

/** The picture of each side. */
export const pair = { left: undefined, right: undefined };

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
  if (files.length > 2) throw new Error(`${files.length} files were dropped: one picture is needed for each side`);
  const pictures = await Promise.all(files.map((file) => library.decode(file, file.name)));
  pictures.forEach((picture, index) => put(sides[index], picture));
}

/** Loads the example; returns its camera. */
export async function loadExample() {
  const file = async (name) => {
    const response = await fetch(`example/${name}`);
    if (!response.ok) throw new Error(`the server has no example/${name}: ${response.status}`);
    return response;
  };
  const [left, right, meta] = await Promise.all([
    ...SIDES.map(async (side) => library.decode(await (await file(`${side}.png`)).blob(), `${side}.png`)),
    file("meta.json").then((response) => response.json()),
  ]);
  put("left", left);
  put("right", right);
  const [, cx, cy] = meta.calib_txt.match(/cam0=\[\S+ \S+ (\S+); \S+ \S+ (\S+);/);
  return { focal: meta.focal_px, principal: [Number(cx), Number(cy)], doffs: meta.doffs_px };
}

/** Exchanges left and right; returns whether there was anything to exchange. */
export function exchange() {
  const { left, right } = pair;
  if (!left || !right) return false;
  put("left", right);
  put("right", left);
  return true;
}

/** Listens for files; calls `changed` when pictures are there, and `failed` with an error. */
export function listenForFiles(changed, failed) {
  const taken = (files, side) => take(files, side).then(changed, failed);
  for (const side of SIDES) {
    const input = at(side).querySelector("input");
    input.multiple = true;
    input.onchange = () => {
      if (input.files.length) taken(input.files, side);
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
    if (files.length) taken(files, event.target.closest?.(".view")?.id);
    else failed(new Error("no file was dropped: drop pictures from a folder"));
  });
}
