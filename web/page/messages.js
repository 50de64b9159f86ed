// The card in the middle of the page: what to do, what is being done, and what went wrong.

import { at, made } from "./dom.js";

/** The steps of matching, by the library's name, with the page's. */
export const STEPS = [["luma", "luma"], ["features", "interest points"], ["seeding", "range"], ["dense", "disparities"]];

const HEADLINES = {
  BadPicture: "This picture cannot be used",
  SizesDiffer: "The pictures differ in size",
  NotRectified: "This pair is not rectified",
  NoAdapter: "No GPU for this page",
  TooLarge: "Too large for this GPU",
  DeviceLost: "The GPU was lost",
  Broken: "The computation broke off",
};

export function say(title, text = "", { bad = false, action } = {}) {
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
export function progress(now) {
  const current = STEPS.findIndex(([name]) => name === now);
  const items = STEPS.map(([, label], index) => made("li", index < current ? "done" : index === current ? "now" : "", label));
  const card = made("div", "card", made("h2", "", "Matching"), made("ul", "steps", ...items));
  at("message").replaceChildren(card);
  document.body.dataset.state = "busy";
}

/** Removes the card, since there is a result, and tells `sentence` to those who do not see it. */
export function done(sentence) {
  at("message").replaceChildren();
  at("spoken").textContent = sentence;
  document.body.dataset.state = "done";
}

/** Says what an error means, and offers `match`, which takes options, where matching again may help. */
export function failure({ name, message }, match) {
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
  say(HEADLINES[name] ?? "This could not be matched", text, { bad: true, action: actions[name] });
}
