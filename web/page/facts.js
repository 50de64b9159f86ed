// The figures of a result, and the doubts about it.

import { at, made } from "./dom.js";
import { STEPS } from "./messages.js";

const TRUST = `How far the map can be believed, 0 to 1, told from the map alone. On 242 maps with known depth, those with more than 30 % wrong
  pixels stayed below 0.5 and those with less than 10 % wrong at 0.5 or above, but for one; between these, trust promises nothing.`;
const CONFIDENCE = `Each pixel has a confidence too: 255 is sure, from 16 on it was measured, 1 to 15 was filled in from its surroundings, 0 is
  doubtful.`;
const SOURCES = { asked: () => "as asked", found: ({ matches }) => `found from ${matches} matches`, assumed: () => "assumed: too few matches" };
const RECTIFIED = { calibration: "rectified by the calibration", matches: "rectified from matches" };

export function showFacts(result) {
  const percent = (share) => `${(100 * share).toFixed(1)} %`;
  const seconds = (milliseconds) => `${(milliseconds / 1000).toFixed(2)}\u00a0s`;
  const steps = STEPS.map(([, label], index) => `${label} ${seconds(result.times[index])}`).join(", ");
  const filled = result.measured < result.coverage ? `${percent(result.measured)} measured, the rest filled` : "";
  const [rows, ...agreeing] = result.rectification.split(/ (?=\()/);
  const help = made("details", "help-text", made("summary", "", "what is this?"), made("p", "", TRUST), made("p", "", CONFIDENCE));
  const list = [
    ["Trust", `${result.trust.toFixed(2)} of 1`, "", result.notTrusted ? "large bad" : "large"],
    ["Time", seconds(result.milliseconds), steps],
    ["Range", `${result.first} to ${result.last} px`, SOURCES[result.source](result)],
    ["Rows", RECTIFIED[result.rectified] ?? rows.replace("rows correspond as they are, 95 %", "agree"), agreeing.join(" ").replace(/[()]/g, "")],
    ["Coverage", percent(result.coverage), filled],
    ["Size", `${result.width} × ${result.height}`],
  ];
  at("facts").replaceChildren(
    ...list.flatMap(([name, value, detail, className = ""]) => {
      const fact = made("dd", className, value);
      if (detail) fact.append(made("small", "", detail));
      return [made("dt", "", name), fact, ...(name === "Trust" ? [made("dd", "", help)] : [])];
    }),
  );
  showDoubts(result);
}

function showDoubts({ notTrusted, warnings }) {
  // Options stand between backticks.
  const plain = (sentence) => {
    const text = sentence.replace(/`(\w+)`/g, (_, name) => `“${name.replaceAll("_", " ")}”`);
    return `${text[0].toUpperCase()}${text.slice(1)}.`;
  };
  const items = [...(notTrusted ? [made("li", "bad", plain(notTrusted))] : []), ...warnings.map((text) => made("li", "", plain(text)))];
  at("doubts").replaceChildren(...items);
  at("doubts").hidden = !items.length;
}
