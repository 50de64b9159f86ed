// The choice of a preset.

import { at, made } from "./dom.js";
import * as library from "./library.js";

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
  at("preset").replaceChildren(...offered);
}

export function chosenPreset() {
  return document.querySelector("input[name=preset]:checked").value;
}
