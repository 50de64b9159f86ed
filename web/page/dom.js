// Elements of the page.

export const at = (id) => document.getElementById(id);

/** Whether the page is used with fingers. */
export const isTouch = matchMedia("(hover: none) and (pointer: coarse)").matches;

/** Creates an element with text or elements in it. */
export function made(tag, className, ...content) {
  const element = document.createElement(tag);
  element.className = className;
  element.append(...content);
  return element;
}
