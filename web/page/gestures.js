// Mouse, fingers and keys that turn, move and zoom a cloud.

/** Angle per press of an arrow key, in radians. */
const TURN = 0.08;
/** Way per press of an arrow key with shift, in units of the median depth. */
const WAY = 0.05;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Listens on the canvas of a cloud. One finger moved up or down is left to the page, which scrolls. */
export function listenForGestures(cloud) {
  const { canvas } = cloud;
  /** Position of each finger, or of the mouse, by pointer id. */
  const held = new Map();
  /** The angles when the last finger was put down. */
  let before;
  const spread = () => {
    const [a, b] = [...held.values()];
    return Math.max(1, Math.hypot(a.x - b.x, a.y - b.y));
  };
  canvas.addEventListener("pointerdown", ({ pointerId, clientX, clientY }) => {
    cloud.hold();
    canvas.setPointerCapture(pointerId);
    held.set(pointerId, { x: clientX, y: clientY });
    before = { yaw: cloud.yaw, pitch: cloud.pitch };
  });
  canvas.addEventListener("pointermove", ({ pointerId, clientX, clientY, buttons, shiftKey }) => {
    const last = held.get(pointerId);
    if (!last) return;
    const apart = held.size === 2 ? spread() : 0;
    const [dx, dy] = [clientX - last.x, clientY - last.y];
    Object.assign(last, { x: clientX, y: clientY });
    const side = canvas.clientHeight;
    if (held.size === 2) {
      cloud.zoom(apart / spread());
      // The middle between two fingers moves half as far as one of them.
      cloud.move(dx / 2 / side, dy / 2 / side);
    } else if (buttons & 2 || shiftKey) {
      cloud.move(dx / side, dy / side);
    } else {
      cloud.turn((3 * dx) / canvas.clientWidth, (3 * dy) / side);
    }
  });
  canvas.addEventListener("pointerup", ({ pointerId }) => held.delete(pointerId));
  canvas.addEventListener("pointercancel", ({ pointerId }) => {
    // The page scrolls by this finger, which therefore has turned nothing.
    if (held.delete(pointerId)) cloud.look(before.yaw, before.pitch, cloud.distance);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    cloud.hold();
    cloud.zoom(Math.exp(0.0012 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const { key, shiftKey } = event;
    const arrow = ARROWS[key];
    if (!arrow && !["+", "-", "Home"].includes(key)) return;
    event.preventDefault();
    cloud.hold();
    if (key === "Home") cloud.home();
    else if (!arrow) cloud.zoom(key === "+" ? 0.9 : 1.1);
    else if (shiftKey) cloud.move(...arrow.map((step) => WAY * step));
    else cloud.turn(...arrow.map((step) => TURN * step));
  });
}
