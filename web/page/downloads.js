// The files of a result, which the library writes: the bytes of the command's files.

import { at, made } from "./dom.js";
import * as library from "./library.js";

/** Offers the files of a result; calls `failed` with an error. */
export function offerFiles(result, failed) {
  const buttons = result.offered.map(({ name, label, title, isThere }) => {
    const button = made("button", "", label);
    Object.assign(button, { title: `${title} (${name})`, disabled: !isThere, onclick: () => save(result, name).catch(failed) });
    return button;
  });
  at("save").replaceChildren(made("span", "", "Save"), ...buttons);
  at("no-depth").hidden = result.offered.every(({ isThere }) => isThere);
}

async function save(result, name) {
  const url = URL.createObjectURL(new Blob([await library.file(result, name)]));
  Object.assign(document.createElement("a"), { href: url, download: name }).click();
  // The download has begun by then.
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
