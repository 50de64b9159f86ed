// A point cloud on a canvas, by WebGL 2: one point per pixel, at the depth of its disparity.

import { listenForGestures } from "./gestures.js";

const VERTEX = `#version 300 es
uniform int width;        // width of the picture, in pixels
uniform float focal;      // focal length of the camera, in pixels
uniform vec2 principal;   // principal point of the camera, in pixels
uniform float doffs;      // difference of the principal points, added to a disparity, in pixels
uniform float unit;       // disparity plus doffs at depth 1, in pixels
uniform mat4 view;
uniform vec2 lens;        // focal length of the viewer divided by half the canvas's sides
uniform float footprint;  // focal length of the viewer, in pixels of the canvas
uniform bool painted;     // colour by depth instead of by the picture
in float disparity;       // in pixels, NaN for no point
in vec3 picture;          // colour of the point in the picture
in vec3 colors;           // colour of the point by depth
out vec3 color;

void main() {
  ivec2 pixel = ivec2(gl_VertexID % width, gl_VertexID / width);
  color = painted ? colors : picture;
  float shifted = disparity + doffs;
  float depth = unit / shifted;
  vec2 across = (vec2(pixel) - principal) / focal * depth;
  vec4 seen = view * vec4(across.x, -across.y, -depth, 1.0);
  if (!(shifted > 0.0) || -seen.z < 0.01) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside the clip volume: not drawn
    return;
  }
  float near = 0.01, far = 100.0;
  gl_Position = vec4(lens * seen.xy, (far + near) / (near - far) * seen.z + 2.0 * far * near / (near - far), -seen.z);
  // Points are 1.4 times as large as a pixel at their depth, so that surfaces seen obliquely show few gaps.
  gl_PointSize = clamp(1.4 * footprint * depth / focal / -seen.z, 1.0, 40.0);
}`;

const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 color;
out vec4 shown;
void main() { shown = vec4(color, 1.0); }`;

/** Amplitude of the sway, in radians. */
const SWAY = 0.22;

export class Cloud {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    const gl = (this.gl = canvas.getContext("webgl2", { alpha: true, antialias: false }));
    if (!gl) throw new Error("this browser has no WebGL 2, which the point cloud needs");
    this.prepare();
    this.painted = false;
    this.home();
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Creates the GPU objects; they are lost with the WebGL context. */
  prepare() {
    const { gl } = this;
    this.program = build(gl);
    this.places = {};
    for (let i = 0; i < gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS); ++i) {
      const { name } = gl.getActiveUniform(this.program, i);
      this.places[name] = gl.getUniformLocation(this.program, name);
    }
    // Values are attributes, because the sides of textures are limited.
    this.attributes = { disparity: [1, gl.FLOAT], picture: [4, gl.UNSIGNED_BYTE], colors: [4, gl.UNSIGNED_BYTE] };
    this.buffers = Object.fromEntries(Object.keys(this.attributes).map((name) => [name, gl.createBuffer()]));
  }

  /**
   * Shows a cloud.
   *
   * @param {ImageData} picture colours of the points
   * @param {ImageData} colors colours of the points by depth
   * @param {Float32Array} disparities in pixels, NaN for no disparity
   * @param {{focal: number, principal: [number, number], doffs: number}} camera all values in pixels
   */
  show(picture, colors, disparities, camera) {
    this.shown = { picture, colors, disparities, camera };
    this.load();
  }

  /** Uploads the cloud to the GPU. */
  load() {
    const { gl, program, places } = this;
    const { picture, colors, disparities, camera: { focal, principal, doffs } } = this.shown;
    const known = disparities.filter((disparity) => disparity + doffs > 0).sort();
    // The median depth is the pivot of rotations.
    const unit = known.length ? known[known.length >> 1] + doffs : 1;
    gl.useProgram(program);
    gl.uniform1i(places.width, picture.width);
    gl.uniform1f(places.focal, focal);
    gl.uniform2f(places.principal, ...principal);
    gl.uniform1f(places.doffs, doffs);
    gl.uniform1f(places.unit, unit);
    this.fill("disparity", disparities);
    this.fill("picture", picture.data);
    this.fill("colors", colors.data);
    this.draw();
  }

  /** Uploads the values of an attribute, one per point. */
  fill(name, values) {
    const { gl } = this;
    const place = gl.getAttribLocation(this.program, name);
    const [components, type] = this.attributes[name];
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    // Normalised: bytes become 0 to 1.
    gl.vertexAttribPointer(place, components, type, true, 0, 0);
  }

  /** Replaces the disparities of the cloud. */
  change(disparities) {
    this.shown.disparities = disparities;
    this.fill("disparity", disparities);
    this.draw();
  }

  paint(painted) {
    this.painted = painted;
    this.draw();
  }

  clear() {
    this.shown = undefined;
    this.draw();
  }

  /** Resets the view to near the camera's position, swaying until the user drags it. */
  home() {
    Object.assign(this, { yaw: 0, pitch: 0.1, distance: 1.2, shift: [0, 0] });
    this.swaying = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.began = undefined;
    this.draw();
  }

  /** Sets a fixed view: angles in radians, distance in units of the median depth. */
  look(yaw, pitch, distance) {
    this.swaying = false;
    Object.assign(this, { yaw, pitch, distance });
    this.draw();
  }

  /** Ends the sway at its current angles. */
  hold() {
    if (this.swaying && this.began !== undefined) Object.assign(this, this.angles(performance.now()));
    this.swaying = false;
  }

  /** Turns the view, by angles in radians. */
  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + pitch));
    this.draw();
  }

  /** Moves the view to the right and down, in units of what is seen at the median depth. */
  move(right, down) {
    const [x, y] = this.shift;
    this.shift = [x + right * this.distance, y - down * this.distance];
    this.draw();
  }

  zoom(factor) {
    this.distance = Math.min(8, Math.max(0.08, this.distance * factor));
    this.draw();
  }

  /** The angles of the view, with the sway at a time in milliseconds. */
  angles(now) {
    const { yaw, pitch } = this;
    if (!this.swaying) return { yaw, pitch };
    this.began ??= now;
    const phase = (now - this.began) / 1600;
    return { yaw: yaw + SWAY * Math.sin(phase), pitch: pitch + 0.25 * SWAY * Math.sin(0.7 * phase) };
  }

  /** Requests a redraw at the next frame. */
  draw() {
    this.pending ??= requestAnimationFrame((now) => {
      this.pending = undefined;
      this.drawNow(now);
    });
  }

  drawNow(now) {
    const { canvas, gl, places } = this;
    const ratio = Math.min(devicePixelRatio, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.shown) return;
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    const { yaw, pitch } = this.angles(now);
    // Seen from the camera's position, the picture fills the canvas.
    const { picture, disparities, camera } = this.shown;
    const focal = camera.focal * Math.min(width / picture.width, height / picture.height);
    gl.uniform2f(places.lens, (2 * focal) / width, (2 * focal) / height);
    gl.uniform1f(places.footprint, focal);
    gl.uniform1i(places.painted, this.painted);
    gl.uniformMatrix4fv(places.view, false, view(yaw, pitch, this.distance, this.shift));
    gl.drawArrays(gl.POINTS, 0, disparities.length);
    if (this.swaying) this.draw();
  }

  /** Keeps the objects when the WebGL context is lost and restored. */
  listen() {
    const { canvas } = this;
    // The context is restored only if the default action of its loss is prevented.
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      if (this.shown) this.load();
    });
    listenForGestures(this);
  }
}

/** The view matrix, column by column: rotation about the point at depth 1, seen from `distance`. */
function view(yaw, pitch, distance, [x, y]) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  // Rotation about y, then about x, around the pivot at (0, 0, -1).
  const rows = [
    [cy, 0, sy],
    [sp * sy, cp, -sp * cy],
    [-cp * sy, sp, cp * cy],
  ];
  const moved = [x, y, -distance].map((offset, row) => offset + rows[row][2]);
  return new Float32Array([0, 1, 2].flatMap((column) => [...rows.map((row) => row[column]), 0]).concat(moved, 1));
}

function build(gl) {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}
