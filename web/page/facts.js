// The figures of a result.

import { at, made } from "./dom.js";
import { STEPS } from "./messages.js";

export function showFacts(result) {
  const percent = (share) => `${(100 * share).toFixed(1)} %`;
  const seconds = (milliseconds) => `${(milliseconds / 1000).toFixed(2)}\u00a0s`;
  const steps = STEPS.map(([, label], index) => `${label} ${seconds(result.times[index])}`).join(", ");
  const filled = result.measured < result.coverage ? `${percent(result.measured)} measured, the rest filled` : "";
  const [rows, ...agreeing] = result.rectification.split(/ (?=\()/);
  const list = [
    ["Time", seconds(result.milliseconds), steps, "large"],
    ["Range", `${result.first} to ${result.last} px`, result.found ? `found from ${result.matches} matches` : "assumed: too few matches"],
    ["Rows", rows.replace("rows correspond as they are, 95 %", "agree"), agreeing.join(" ").replace(/[()]/g, "")],
    ["Coverage", percent(result.coverage), filled],
    ["Trust", `${result.trust.toFixed(2)} of 1`],
    ["Size", `${result.width} × ${result.height}`],
  ];
  at("facts").replaceChildren(
    ...list.flatMap(([name, value, detail, className = ""]) => {
      const fact = made("dd", className, value);
      if (detail) fact.append(made("small", "", detail));
      return [made("dt", "", name), fact];
    }),
  );
}

export function clearFacts() {
  at("facts").replaceChildren();
}
