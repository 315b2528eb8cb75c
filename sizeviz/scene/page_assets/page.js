"use strict";
// The panes of a page: meshes from the arrays in it, drawn by WebGL. Nothing is loaded from anywhere.

const TYPES = { f4: Float32Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array };
const NEAR = [5, 11]; // pixels an element must be across for its edges to begin to show, and to show fully
const PALETTE_WIDTH = 1024;
const HINT = "Point at an element to read its values";
const FAILING = 0x8000; // bit of an element's colour that says R > 1

async function unpacked(array) {
  const bytes = Uint8Array.from(atob(array.data), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new TYPES[array.type](await new Response(stream).arrayBuffer());
}

function element(name, parent, attributes = {}, text = "") {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  parent.append(made);
  return made;
}

function short(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-4 || size >= 1e6) ? value.toExponential(3) : String(Number(value.toPrecision(4)));
}

// R rounded away from 1, so that no failing element reads as a correct one
function shortRatio(value, failing) {
  return failing ? (Math.ceil(value * 1000 - 1e-6) / 1000).toFixed(3) : Math.min(value, 1).toFixed(3);
}

class Mesh {
  constructor(subject, arrays) {
    Object.assign(this, subject);
    this.points = arrays[subject.points];
    this.quads = arrays[subject.quads];
    this.count = this.quads.length / 4;
    for (const quantity of Object.values(this.quantities)) {
      for (const name of ["values", "colors", "palette", "bar"]) quantity[name] = arrays[quantity[name]];
    }
    this.failing = new Uint8Array(this.count);
    for (const k of arrays[subject.failing]) this.failing[k] = 1;
    this.outline = subject.outline.map((index) => arrays[index]);
  }

  // Corner positions of every element, relative to the origin, (4 Q) pairs.
  corners() {
    const out = new Float32Array(8 * this.count);
    for (let k = 0; k < this.quads.length; k++) {
      out[2 * k] = this.points[2 * this.quads[k]];
      out[2 * k + 1] = this.points[2 * this.quads[k] + 1];
    }
    return out;
  }

  corner(e, c) {
    const node = this.quads[4 * e + c];
    return [this.points[2 * node], this.points[2 * node + 1]];
  }

  centre(e) {
    let x = 0, y = 0;
    for (let c = 0; c < 4; c++) { const p = this.corner(e, c); x += p[0] / 4; y += p[1] / 4; }
    return [x, y];
  }

  reach(e) {
    let far = 0;
    const m = this.centre(e);
    for (let c = 0; c < 4; c++) { const p = this.corner(e, c); far = Math.max(far, Math.hypot(p[0] - m[0], p[1] - m[1])); }
    return far;
  }

  boxes(visit) {
    for (let e = 0; e < this.count; e++) {
      let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
      for (let c = 0; c < 4; c++) {
        const [x, y] = this.corner(e, c);
        x0 = Math.min(x0, x); y0 = Math.min(y0, y); x1 = Math.max(x1, x); y1 = Math.max(y1, y);
      }
      const g = this.grid;
      const i0 = g.column(x0), i1 = g.column(x1), j0 = g.row(y0), j1 = g.row(y1);
      for (let j = j0; j <= j1; j++) for (let i = i0; i <= i1; i++) visit(e, j * g.nx + i);
    }
  }

  // A grid of buckets, built when the pointer first asks.
  index() {
    if (this.grid) return;
    const [x0, y0, x1, y1] = this.box, [ox, oy] = this.origin;
    const left = x0 - ox, low = y0 - oy, w = x1 - x0, h = y1 - y0;
    const side = Math.sqrt(Math.max(w * h, 1e-300) / Math.max(this.count / 2, 1));
    const nx = Math.min(Math.max(Math.ceil(w / side), 1), 2000), ny = Math.min(Math.max(Math.ceil(h / side), 1), 2000);
    const clamp = (value, most) => Math.min(Math.max(Math.floor(value), 0), most - 1);
    this.grid = { nx, ny, column: (x) => clamp(((x - left) / w) * nx, nx), row: (y) => clamp(((y - low) / h) * ny, ny) };
    this.starts = new Uint32Array(nx * ny + 1);
    this.boxes((e, bucket) => this.starts[bucket + 1]++);
    for (let k = 0; k < nx * ny; k++) this.starts[k + 1] += this.starts[k];
    const next = this.starts.slice();
    this.members = new Uint32Array(this.starts[nx * ny]);
    this.boxes((e, bucket) => { this.members[next[bucket]++] = e; });
  }

  // The element at a point relative to the origin, -1 outside.
  at(x, y) {
    this.index();
    const bucket = this.grid.row(y) * this.grid.nx + this.grid.column(x);
    for (let k = this.starts[bucket]; k < this.starts[bucket + 1]; k++) {
      const e = this.members[k];
      let inside = false;
      for (let c = 0; c < 4; c++) {
        const [ax, ay] = this.corner(e, c), [bx, by] = this.corner(e, (c + 1) % 4);
        if (ay > y !== by > y && x < ax + ((y - ay) * (bx - ax)) / (by - ay)) inside = !inside;
      }
      if (inside) return e;
    }
    return -1;
  }
}

const VERTEX = `#version 300 es
in vec2 place;
in uint look;
uniform vec2 centre, scale;
flat out uint color;
out vec2 uv;
void main() {
  int corner = gl_VertexID & 3;
  uv = vec2(corner == 1 || corner == 2, corner >= 2);
  color = look;
  gl_Position = vec4((place - centre) * scale, 0.0, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
flat in uint color;
in vec2 uv;
uniform sampler2D palette;
uniform vec4 edge, alarm;
uniform vec2 near;
uniform bool lines;
out vec4 shown;
void main() {
  vec3 own = texelFetch(palette, ivec2(int(color & 0x7fffu), 0), 0).rgb;
  if (lines) { shown = vec4(own, 1.0); return; }
  vec2 slope = max(fwidth(uv), vec2(1e-6));
  vec2 away = min(uv, 1.0 - uv) / slope;
  float pixels = 1.0 / max(slope.x, slope.y);
  bool failing = (color & 0x8000u) != 0u;
  vec4 ink = failing ? alarm : edge;
  float width = failing ? 1.2 : 0.7;
  float line = 1.0 - smoothstep(width - 0.5, width + 0.5, min(away.x, away.y));
  shown = vec4(mix(own, ink.rgb, line * ink.a * smoothstep(near.x, near.y, pixels)), 1.0);
}`;

class Painter {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("This page needs WebGL 2, which this browser does not offer or has switched off.");
    this.gl = gl;
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "WebGL failed");
    gl.useProgram(program);
    this.where = (name) => gl.getUniformLocation(program, name);
    this.places = gl.createBuffer();
    this.looks = gl.createBuffer();
    this.faces = gl.createBuffer();
    this.alarms = gl.createBuffer();
    this.alarmFaces = gl.createBuffer();
    const place = gl.getAttribLocation(program, "place"), look = gl.getAttribLocation(program, "look");
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 2, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.looks);
    gl.enableVertexAttribArray(look);
    gl.vertexAttribIPointer(look, 1, gl.UNSIGNED_SHORT, 0, 0);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  }

  setMesh(mesh) {
    const gl = this.gl, faces = new Uint32Array(6 * mesh.count), alarms = [], alarmFaces = [];
    for (let e = 0, k = 0; e < mesh.count; e++) {
      const first = 4 * e;
      for (const c of [0, 1, 2, 0, 2, 3]) faces[k++] = first + c;
      if (!mesh.failing[e]) continue;
      for (let c = 0; c < 4; c++) alarms.push(first + c, first + ((c + 1) % 4));
      alarmFaces.push(...faces.subarray(k - 6, k));
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.places);
    gl.bufferData(gl.ARRAY_BUFFER, mesh.corners(), gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.faces);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.alarms);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(alarms), gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.alarmFaces);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(alarmFaces), gl.STATIC_DRAW);
    this.counts = [faces.length, alarms.length, alarmFaces.length];
  }

  setColors(mesh, quantity) {
    const gl = this.gl, looks = new Uint16Array(4 * mesh.count);
    for (let e = 0; e < mesh.count; e++) {
      looks.fill(quantity.colors[e] | (quantity.alarmed && mesh.failing[e] ? FAILING : 0), 4 * e, 4 * e + 4);
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.looks);
    gl.bufferData(gl.ARRAY_BUFFER, looks, gl.STATIC_DRAW);
    const colors = new Uint8Array(4 * PALETTE_WIDTH).fill(255);
    for (let k = 0; k < quantity.palette.length / 3; k++) colors.set(quantity.palette.subarray(3 * k, 3 * k + 3), 4 * k);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, PALETTE_WIDTH, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colors);
    this.alarmed = quantity.alarmed;
  }

  draw(camera, width, height, ratio, dark) {
    const gl = this.gl;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...(dark ? [24, 27, 32] : [255, 255, 255]).map((c) => c / 255), 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniform2f(this.where("centre"), camera.x, camera.y);
    gl.uniform2f(this.where("scale"), (2 * height) / (camera.height * width), 2 / camera.height);
    gl.uniform2f(this.where("near"), NEAR[0] * ratio, NEAR[1] * ratio);
    gl.uniform4f(this.where("edge"), ...(dark ? [0.87, 0.88, 0.91] : [0.15, 0.17, 0.2]), 0.5);
    gl.uniform4f(this.where("alarm"), ...(dark ? [1, 0.7, 0.36] : [0.47, 0.125, 0.04]), 1);
    gl.uniform1i(this.where("lines"), 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.faces);
    gl.drawElements(gl.TRIANGLES, this.counts[0], gl.UNSIGNED_INT, 0);
    if (this.alarmed && this.counts[1]) { // lines about them, so that no failing element is too small to be seen
      gl.uniform1i(this.where("lines"), 1);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.alarms);
      gl.drawElements(gl.LINES, this.counts[1], gl.UNSIGNED_INT, 0);
      gl.uniform1i(this.where("lines"), 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.alarmFaces);
      gl.drawElements(gl.TRIANGLES, this.counts[2], gl.UNSIGNED_INT, 0);
    }
  }
}

class Pane {
  constructor(board, number, start) {
    this.board = board;
    this.number = number;
    const root = element("article", board.root, { class: "pane", "aria-label": `Pane ${number + 1}` });
    const head = element("div", root, { class: "head" });
    this.what = element("select", head, { class: "what", "aria-label": "Method" });
    board.meshes.forEach((mesh, k) => element("option", this.what, { value: k }, mesh.title));
    this.by = element("select", head, { "aria-label": "Coloured by" });
    this.detail = element("span", head, { class: "detail" });
    this.stage = element("div", root, { class: "stage", tabindex: 0, role: "img" });
    this.canvas = element("canvas", this.stage);
    this.glass = element("canvas", this.stage, { class: "glass" });
    this.verdict = element("p", root, { class: "verdict" });
    this.readout = element("p", root, { class: "readout" }, HINT);
    const bar = element("div", root, { class: "bar" });
    this.barWords = element("div", bar, { class: "words" });
    this.barStrip = element("canvas", bar, { height: 1 });
    this.barTicks = element("div", bar, { class: "ticks" });
    this.painter = new Painter(this.canvas);
    this.hover = null;
    const [x0, y0, x1, y1] = board.box;
    this.stage.style.aspectRatio = String(Math.min(Math.max((x1 - x0) / (y1 - y0), 0.6), 2.2));
    this.what.addEventListener("change", () => this.show(Number(this.what.value), this.by.value));
    this.by.addEventListener("change", () => this.show(Number(this.what.value), this.by.value));
    this.listen();
    this.show(start.subject, start.quantity);
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  show(index, name) {
    if (this.mesh !== this.board.meshes[index]) {
      this.mesh = this.board.meshes[index];
      this.painter.setMesh(this.mesh);
      this.by.replaceChildren();
      for (const [key, quantity] of Object.entries(this.mesh.quantities)) element("option", this.by, { value: key }, quantity.words);
    }
    if (!(name in this.mesh.quantities)) name = Object.keys(this.mesh.quantities)[0];
    const quantity = this.mesh.quantities[name];
    this.what.value = String(index);
    this.by.value = name;
    this.painter.setColors(this.mesh, quantity);
    this.detail.textContent = this.mesh.detail;
    this.verdict.textContent = quantity.verdict;
    this.verdict.className = "verdict" + (quantity.passed === true ? " good" : quantity.passed === false ? " bad" : "");
    this.stage.setAttribute("aria-label", `${this.mesh.title}, ${quantity.words}: ${quantity.verdict}`);
    this.showBar(quantity);
    this.board.redraw();
  }

  showBar(quantity) {
    const steps = quantity.bar.length / 3, strip = new ImageData(steps, 1);
    for (let k = 0; k < steps; k++) strip.data.set([...quantity.bar.subarray(3 * k, 3 * k + 3), 255], 4 * k);
    this.barStrip.width = steps;
    this.barStrip.getContext("2d").putImageData(strip, 0, 0);
    this.barWords.textContent = quantity.title;
    this.barTicks.replaceChildren();
    for (const [at, label] of quantity.ticks) {
      const side = at < 0.02 ? "first" : at > 0.98 ? "last" : "";
      element("span", this.barTicks, { style: `left: ${100 * at}%`, class: side }, label);
    }
  }

  resize() {
    this.ratio = window.devicePixelRatio || 1;
    for (const canvas of [this.canvas, this.glass]) {
      canvas.width = Math.max(Math.round(this.stage.clientWidth * this.ratio), 1);
      canvas.height = Math.max(Math.round(this.stage.clientHeight * this.ratio), 1);
    }
    if (!this.camera) this.fit();
    this.board.redraw();
  }

  fit() {
    const [x0, y0, x1, y1] = this.board.box, [ox, oy] = this.mesh.origin;
    const aspect = this.canvas.width / this.canvas.height;
    this.camera = { x: (x0 + x1) / 2 - ox, y: (y0 + y1) / 2 - oy, height: Math.max(y1 - y0, (x1 - x0) / aspect) * 1.03 };
  }

  look(camera) {
    this.board.look(this, camera);
  }

  unit() {
    return this.camera.height / this.stage.clientHeight;
  }

  model(event) {
    const box = this.stage.getBoundingClientRect(), unit = this.unit();
    return [
      this.camera.x + (event.clientX - box.left - this.stage.clientLeft - this.stage.clientWidth / 2) * unit,
      this.camera.y - (event.clientY - box.top - this.stage.clientTop - this.stage.clientHeight / 2) * unit,
    ];
  }

  zoom(factor, x, y) {
    const smallest = this.board.size * 1e-6, height = Math.min(Math.max(this.camera.height / factor, smallest), this.board.size * 20);
    const kept = height / this.camera.height;
    this.look({ x: x + (this.camera.x - x) * kept, y: y + (this.camera.y - y) * kept, height });
  }

  goToWorst() {
    const worst = this.mesh.worst[this.by.value === "quality" ? "quality" : "ratio"];
    if (worst === null || worst === undefined) return;
    const [x, y] = this.mesh.centre(worst);
    const height = Math.min(Math.max(this.mesh.reach(worst) * 18, this.board.size * 1e-5), this.board.size);
    this.look({ x, y, height });
    this.board.point(x, y);
  }

  listen() {
    const fingers = new Map(), stage = this.stage;
    stage.addEventListener("wheel", (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 33 : event.deltaMode === 2 ? 400 : 1;
      this.zoom(Math.exp(-Math.max(Math.min(event.deltaY * lines, 400), -400) * 0.0018), ...this.model(event));
    }, { passive: false });
    stage.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, event);
      stage.setPointerCapture(event.pointerId);
      stage.classList.add("dragging");
    });
    stage.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return void this.board.point(...this.model(event));
      const others = [...fingers.values()].filter((finger) => finger.pointerId !== event.pointerId);
      fingers.set(event.pointerId, event);
      if (others.length === 1) {
        const apart = (e) => Math.hypot(e.clientX - others[0].clientX, e.clientY - others[0].clientY);
        this.zoom(apart(event) / Math.max(apart(before), 1), ...this.model(others[0]));
      } else if (!others.length) {
        const unit = this.unit();
        this.look({ ...this.camera, x: this.camera.x - (event.clientX - before.clientX) * unit,
          y: this.camera.y + (event.clientY - before.clientY) * unit });
      }
    });
    for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, (event) => {
      fingers.delete(event.pointerId);
      stage.classList.remove("dragging");
    });
    stage.addEventListener("pointerleave", () => this.board.point(NaN, NaN));
    stage.addEventListener("dblclick", () => this.board.fit());
    stage.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const { x, y, height } = this.camera, step = height / 8, key = event.key.toLowerCase();
      const moves = { arrowleft: [-step, 0], arrowright: [step, 0], arrowup: [0, step], arrowdown: [0, -step] };
      if (key in moves) this.look({ x: x + moves[key][0], y: y + moves[key][1], height });
      else if (key === "+" || key === "=") this.zoom(1.25, x, y);
      else if (key === "-") this.zoom(0.8, x, y);
      else if (key === "w") this.goToWorst();
      else return;
      event.preventDefault();
    });
  }

  point(x, y) {
    const e = Number.isFinite(x) ? this.mesh.at(x, y) : -1;
    this.hover = e >= 0 ? e : null;
    this.readout.replaceChildren();
    if (e < 0) return void (this.readout.textContent = HINT);
    const [ox, oy] = this.mesh.origin, q = this.mesh.quantities;
    const say = (words, value) => {
      this.readout.append(`${words} `);
      element("b", this.readout, {}, value);
      this.readout.append("   ");
    };
    say("element", String(e));
    if (q.ratio) say("R", shortRatio(q.ratio.values[e], this.mesh.failing[e]));
    if (q.quality) say("quality", q.quality.values[e].toFixed(3));
    if (q.size) say("size", short(q.size.values[e]));
    if (q.prescribed) say("h", short(q.prescribed.values[e]));
    if (q.target) say("h*", short(q.target.values[e]));
    say("x", short(x + ox));
    say("y", short(y + oy));
  }

  draw(dark) {
    if (!this.camera || !this.canvas.width) return;
    this.painter.draw(this.camera, this.canvas.width, this.canvas.height, this.ratio, dark);
    const glass = this.glass.getContext("2d"), { width, height } = this.glass, unit = this.camera.height / height;
    const spot = (x, y) => [width / 2 + (x - this.camera.x) / unit, height / 2 - (y - this.camera.y) / unit];
    glass.clearRect(0, 0, width, height);
    glass.lineWidth = 1.2 * this.ratio;
    glass.strokeStyle = dark ? "#dee2e8" : "#262b33";
    glass.beginPath();
    for (const loop of this.mesh.outline) {
      for (let k = 0; k < loop.length; k += 2) glass[k ? "lineTo" : "moveTo"](...spot(loop[k], loop[k + 1]));
      glass.closePath();
    }
    glass.stroke();
    if (this.hover === null) return;
    glass.lineWidth = 2.4 * this.ratio;
    glass.strokeStyle = "#d61685";
    glass.beginPath();
    for (let c = 0; c < 4; c++) glass[c ? "lineTo" : "moveTo"](...spot(...this.mesh.corner(this.hover, c)));
    glass.closePath();
    glass.stroke();
    const [x, y] = spot(...this.mesh.centre(this.hover));
    if (this.mesh.reach(this.hover) / unit < 5 * this.ratio) { // too small to see: a ring around it
      glass.beginPath();
      glass.arc(x, y, 8 * this.ratio, 0, 2 * Math.PI);
      glass.stroke();
    }
  }
}

class Board {
  constructor(data, arrays) {
    this.root = document.getElementById("panes");
    this.meshes = data.subjects.map((subject) => new Mesh(subject, arrays));
    this.box = data.box;
    this.size = Math.max(data.box[2] - data.box[0], data.box[3] - data.box[1]);
    this.linked = document.getElementById("link");
    this.panes = data.panes.map((start, number) => new Pane(this, number, start));
    this.linked.addEventListener("change", () => this.look(this.panes[0], this.panes[0].camera));
    document.getElementById("fit").addEventListener("click", () => this.fit());
    document.getElementById("theme").addEventListener("click", () => this.turn());
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
      if (event.key.toLowerCase() === "f") this.fit();
      if (event.key.toLowerCase() === "d") this.turn();
    });
    this.turn(data.dark);
  }

  get dark() {
    return document.body.dataset.theme === "dark";
  }

  turn(dark = !this.dark) {
    document.body.dataset.theme = dark ? "dark" : "light";
    document.getElementById("theme").textContent = dark ? "Light" : "Dark";
    this.redraw();
  }

  fit() {
    for (const pane of this.panes) pane.fit();
    this.redraw();
  }

  look(from, camera) {
    for (const pane of this.linked.checked ? this.panes : [from]) pane.camera = { ...camera };
    this.redraw();
  }

  point(x, y) {
    for (const pane of this.panes) pane.point(x, y);
    this.redraw();
  }

  redraw() {
    if (this.due) return;
    this.due = requestAnimationFrame(() => {
      this.due = 0;
      for (const pane of this.panes) pane.draw(this.dark);
    });
  }
}

function showTable(table) {
  const root = document.getElementById("table");
  const head = element("tr", element("thead", root));
  table.header.forEach((words) => element("th", head, { scope: "col" }, words));
  const body = element("tbody", root);
  for (const row of table.rows) {
    const line = element("tr", body);
    row.forEach((words, k) => element(k ? "td" : "th", line, k ? {} : { scope: "row" }, words));
  }
}

async function begin() {
  const data = JSON.parse(document.getElementById("data").textContent);
  showTable(data.table);
  try {
    if (typeof DecompressionStream === "undefined") throw new Error("This browser is too old for this page (no DecompressionStream).");
    window.sizeviz = new Board(data, await Promise.all(data.arrays.map(unpacked)));
    document.body.dataset.ready = "yes";
  } catch (problem) {
    const trouble = document.getElementById("trouble");
    trouble.textContent = problem.message;
    trouble.hidden = false;
  }
}

begin();
