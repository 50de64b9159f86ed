// A point cloud on a canvas, by WebGL 2: a point for each pixel, where its disparity says that it lies.

const VERTEX = `#version 300 es
uniform sampler2D picture;
uniform sampler2D colors;
uniform ivec2 size;
uniform float focal;      // of the camera, in pixels
uniform vec2 principal;   // its principal point
uniform float doffs;      // added to a disparity before depth is computed
uniform float unit;       // the disparity at depth 1
uniform mat4 view;
uniform vec2 lens;        // the viewer's focal length over half the canvas's sides
uniform float footprint;  // the viewer's focal length in pixels of the canvas
uniform bool painted;     // by depth, and not by the picture
in float disparity;
out vec3 color;

void main() {
  ivec2 pixel = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
  color = painted ? texelFetch(colors, pixel, 0).rgb : texelFetch(picture, pixel, 0).rgb;
  float shifted = disparity + doffs;
  float depth = unit / shifted;
  vec2 across = (vec2(pixel) - principal) / focal * depth;
  vec4 seen = view * vec4(across.x, -across.y, -depth, 1.0);
  if (!(shifted > 0.0) || -seen.z < 0.01) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside: nothing to see
    return;
  }
  float near = 0.01, far = 100.0;
  gl_Position = vec4(lens * seen.xy, (far + near) / (near - far) * seen.z + 2.0 * far * near / (near - far), -seen.z);
  // Larger than the pixel is at that depth, so that few gaps show where a surface is seen from its side.
  gl_PointSize = clamp(1.4 * footprint * depth / focal / -seen.z, 1.0, 40.0);
}`;

const FRAGMENT = `#version 300 es
precision mediump float;
in vec3 color;
out vec4 shown;
void main() { shown = vec4(color, 1.0); }`;

/** What the sway adds to the angle, at most, in radians. */
const SWAY = 0.22;

export class Cloud {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    const gl = (this.gl = canvas.getContext("webgl2", { alpha: true, antialias: false }));
    if (!gl) throw new Error("this browser has no WebGL 2, which draws the point cloud");
    this.program = build(gl);
    this.places = {};
    for (let i = 0; i < gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS); ++i) {
      const { name } = gl.getActiveUniform(this.program, i);
      this.places[name] = gl.getUniformLocation(this.program, name);
    }
    this.buffer = gl.createBuffer();
    this.textures = [gl.createTexture(), gl.createTexture()];
    this.count = 0;
    this.painted = false;
    this.home();
    this.listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /**
   * Shows a cloud.
   *
   * @param {ImageData} picture what colours the points
   * @param {ImageData} colors what colours them by depth
   * @param {Float32Array} disparities in pixels, NaN where there is none
   * @param {{focal: number, principal: [number, number], doffs: number}} camera
   */
  show(picture, colors, disparities, { focal, principal, doffs }) {
    const { gl, program, places } = this;
    const known = disparities.filter((disparity) => disparity + doffs > 0).sort();
    // Turned about what most of the picture shows.
    const unit = known.length ? known[known.length >> 1] + doffs : 1;
    gl.useProgram(program);
    gl.uniform2i(places.size, picture.width, picture.height);
    gl.uniform1f(places.focal, focal);
    gl.uniform2f(places.principal, ...principal);
    gl.uniform1f(places.doffs, doffs);
    gl.uniform1f(places.unit, unit);
    gl.uniform1i(places.picture, 0);
    gl.uniform1i(places.colors, 1);
    [picture, colors].forEach((image, index) => {
      gl.activeTexture(gl.TEXTURE0 + index);
      gl.bindTexture(gl.TEXTURE_2D, this.textures[index]);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, disparities, gl.STATIC_DRAW);
    const place = gl.getAttribLocation(program, "disparity");
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 1, gl.FLOAT, false, 0, 0);
    this.count = disparities.length;
    this.extent = [picture.width / focal, picture.height / focal];
    this.draw();
  }

  /** Other disparities for the cloud that is shown. */
  change(disparities) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, disparities, gl.STATIC_DRAW);
    this.draw();
  }

  paint(painted) {
    this.painted = painted;
    this.draw();
  }

  clear() {
    this.count = 0;
    this.draw();
  }

  /** Back to a little beside the camera's place, swaying until someone takes hold. */
  home() {
    Object.assign(this, { yaw: 0, pitch: 0.1, distance: 1.2, shift: [0, 0] });
    this.swaying = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.began = undefined;
    this.draw();
  }

  /** Looks from a fixed place: angles in radians, the distance in units of the median depth. */
  look(yaw, pitch, distance) {
    this.swaying = false;
    Object.assign(this, { yaw, pitch, distance });
    this.draw();
  }

  /** Draws at the next frame. */
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
    if (!this.count) return;
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    let { yaw, pitch } = this;
    if (this.swaying) {
      this.began ??= now;
      const phase = (now - this.began) / 1600;
      yaw += SWAY * Math.sin(phase);
      pitch += 0.25 * SWAY * Math.sin(0.7 * phase);
    }
    // The picture fills the canvas when seen from the camera's place.
    const focal = Math.min(width / this.extent[0], height / this.extent[1]);
    gl.uniform2f(places.lens, (2 * focal) / width, (2 * focal) / height);
    gl.uniform1f(places.footprint, focal);
    gl.uniform1i(places.painted, this.painted);
    gl.uniformMatrix4fv(places.view, false, view(yaw, pitch, this.distance, this.shift));
    gl.drawArrays(gl.POINTS, 0, this.count);
    if (this.swaying) this.draw();
  }

  listen() {
    const { canvas } = this;
    /** Where each finger or the mouse is. */
    const held = new Map();
    const spread = () => {
      const [a, b] = [...held.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    const zoom = (factor) => {
      this.distance = Math.min(8, Math.max(0.08, this.distance * factor));
      this.draw();
    };
    canvas.addEventListener("pointerdown", (event) => {
      if (this.swaying && this.began !== undefined) {
        // It goes on from where it is.
        const phase = (performance.now() - this.began) / 1600;
        this.yaw += SWAY * Math.sin(phase);
        this.pitch += 0.25 * SWAY * Math.sin(0.7 * phase);
      }
      this.swaying = false;
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = held.get(event.pointerId);
      if (!last) return;
      const before = held.size === 2 ? spread() : 0;
      const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
      Object.assign(last, { x: event.clientX, y: event.clientY });
      if (held.size === 2) {
        zoom(before / Math.max(1, spread()));
      } else if (event.buttons & 2 || event.shiftKey) {
        const scale = this.distance / canvas.clientHeight;
        this.shift = [this.shift[0] + dx * scale, this.shift[1] - dy * scale];
      } else {
        this.yaw += (3 * dx) / canvas.clientWidth;
        this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + (3 * dy) / canvas.clientHeight));
      }
      this.draw();
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => held.delete(event.pointerId));
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.swaying = false;
      zoom(Math.exp(0.0012 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("keydown", ({ key }) => {
      const turns = { ArrowLeft: [-0.08, 0], ArrowRight: [0.08, 0], ArrowUp: [0, -0.08], ArrowDown: [0, 0.08] };
      if (turns[key]) this.look(this.yaw + turns[key][0], this.pitch + turns[key][1], this.distance);
      if (key === "+" || key === "-") zoom(key === "+" ? 0.9 : 1.1);
    });
  }
}

/** World to eye: turned about the point at depth 1, and seen from `distance`. Column by column. */
function view(yaw, pitch, distance, [x, y]) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  // Rotation about x after rotation about y, then the way from the pivot at (0, 0, -1).
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
