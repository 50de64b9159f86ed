// The card in the middle of the page: what to do, what is being done, and what went wrong.

import { at, made } from "./dom.js";

/** The steps of matching, by the library's name, with the page's. */
export const STEPS = [["luma", "luma"], ["features", "interest points"], ["seeding", "range"], ["dense", "disparities"]];

const HEADLINES = {
  BadPicture: "This file cannot be used",
  SizesDiffer: "The pictures differ in size",
  NotRectified: "The rows of this pair do not correspond",
  NoAdapter: "No GPU for this page",
  TooLarge: "Too large for this GPU",
  DeviceLost: "The GPU was lost",
  Broken: "The computation broke off",
};

export function say(title, text = "", { bad = false, action } = {}) {
  const card = made("div", bad ? "card bad" : "card", made("h2", "", title));
  if (text) card.append(made("p", "", text));
  if (action) card.append(button(action));
  at("message").replaceChildren(card);
  document.body.dataset.state = bad ? "failed" : "idle";
}

function button({ label, run }, className = "main") {
  return Object.assign(made("button", className, label), { onclick: run });
}

/** The parts of the card while a pair is matched. */
let matching;

/** Shows that a pair is matched, with a button that calls `cancel`. */
export function begin(cancel) {
  const items = STEPS.map(([, label]) => made("li", "", label));
  const bar = Object.assign(made("progress", ""), { ariaLabel: "Progress" });
  const title = made("h2", "", "Matching");
  matching = { title, items, bar };
  at("message").replaceChildren(made("div", "card", title, made("ul", "steps", ...items), bar, button({ label: "Cancel", run: cancel }, "")));
  document.body.dataset.state = "busy";
}

/** Marks the current step, and shows the share of it that is done. */
export function progress({ step, share }) {
  const { title, items, bar } = matching;
  if (step) {
    const current = STEPS.findIndex(([name]) => name === step);
    title.textContent = { rectifying: "Rectifying", mirror: "Looking for a mirror image" }[step] ?? "Matching";
    items.forEach((item, index) => (item.className = index < current ? "done" : index === current ? "now" : ""));
    bar.removeAttribute("value");
  }
  if (share !== undefined) bar.value = share;
}

/** Removes the card, since there is a result, and tells `sentence` to those who do not see it. */
export function done(sentence) {
  at("message").replaceChildren();
  at("spoken").textContent = sentence;
  document.body.dataset.state = "done";
}

/** Says what an error means, and offers `match`, which takes options, where matching again may help, or `action`. */
export function failure({ name, message }, match, action) {
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
  say(HEADLINES[name] ?? "This could not be matched", text, { bad: true, action: action ?? actions[name] });
}
