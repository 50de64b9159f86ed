// The two pictures: from files, dropped, chosen or taken by a camera, or from the example.

import { at } from "./dom.js";
import * as library from "./library.js";

const SIDES = ["left", "right"];
/** Aspect from which on a picture seems to have two views beside each other. */
const WIDE = 2.2;

/** The picture of each side, its name, and its file unless that has both views. */
const sides = { left: {}, right: {} };
/** How samples of more than 8 bits were stretched, and doubts about the files. */
let loaded = { stretch: [], warnings: [] };
/** The file that was taken last, with its side, if it was one. */
let single;
/** Takes that file again, with its views where `halves` says. */
let retake;

/** The pair as a task of the library has it; undefined if a picture is missing. */
export function currentPair() {
  const { left, right } = sides;
  if (!left.picture || !right.picture) return undefined;
  return { left: left.picture, right: right.picture, names: [left.name, right.name], ...loaded };
}

/** The side that misses its picture; undefined if both do. */
export function missing() {
  return sides.left.picture ? "right" : sides.right.picture ? "left" : undefined;
}

/** Whether the only picture seems to have both views beside each other. */
export function seemsToHaveBoth() {
  const { picture } = sides.left.picture ? sides.left : sides.right;
  return Boolean(single && picture && picture.width > WIDE * picture.height);
}

function put(side, picture, name, file) {
  sides[side] = { picture, name, file };
  const view = at(side);
  const canvas = view.querySelector("canvas");
  Object.assign(canvas, { width: picture.width, height: picture.height });
  canvas.getContext("2d").putImageData(picture, 0, 0);
  view.classList.add("loaded");
}

/** Loads the file of one view, for a side, of both views, or two files in the order of their names. */
async function take(files, side, halves) {
  files = [...files].sort((a, b) => a.name.localeCompare(b.name, "en", { numeric: true }));
  if (files.length > 2) throw new Error(`${files.length} files were dropped: one picture is needed for each side`);
  let named = files.map((file) => ({ file, name: file.name }));
  side ??= missing() ?? "left";
  single = named.length === 1 ? { ...named[0], side } : undefined;
  let found = await library.decode(named, halves);
  if (found.views.length === 1) {
    const other = sides[side === "left" ? "right" : "left"];
    if (other.file) {
      // Both files of a pair are decoded together, since samples of more than 8 bits get one scale.
      named = side === "left" ? [single, other] : [other, single];
      found = await library.decode(named);
    } else {
      put(side, found.views[0], single.name, single.file);
      loaded = { stretch: [], warnings: [] };
      return;
    }
  }
  found.views.forEach((view, index) => {
    const { name, file } = named[index] ?? named[0];
    put(SIDES[index], view, name, named.length > 1 ? file : undefined);
  });
  loaded = { stretch: found.stretch, warnings: found.warnings };
}

/** Loads the example; returns its calibration file. */
export async function loadExample() {
  const fetched = async (name) => {
    const response = await fetch(`example/${name}`);
    if (!response.ok) throw new Error(`the server has no example/${name}: ${response.status}`);
    return response;
  };
  const [left, right, meta] = await Promise.all([
    ...SIDES.map(async (side) => new File([await (await fetched(`${side}.png`)).blob()], `${side}.png`)),
    fetched("meta.json").then((response) => response.json()),
  ]);
  await take([left, right]);
  return { name: "calib.txt", text: meta.calib_txt };
}

/** Exchanges left and right; returns whether there was anything to exchange. */
export function exchange() {
  const { left, right } = sides;
  if (!left.picture || !right.picture) return false;
  put("left", right.picture, right.name, right.file);
  put("right", left.picture, left.name, left.file);
  return true;
}

/** Listens for files; calls `changed` when pictures are there, and `failed` with an error. */
export function listenForFiles(changed, failed) {
  const taken = (files, side, halves = at("halves").value) => take(files, side, halves).then(changed, failed);
  retake = (halves) => single && taken([single.file], single.side, halves);
  for (const side of SIDES) {
    for (const input of at(side).querySelectorAll("input")) {
      input.onchange = () => {
        if (input.files.length) taken(input.files, side);
        input.value = "";
      };
    }
  }
  at("halves").onchange = () => retake();
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

/** Takes the only file as one with the left view on the left and the right view on the right. */
export function splitInHalves() {
  retake("left-right");
}
