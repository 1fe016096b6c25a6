// The 3-D view: forward kinematics by screw axes, and line segments on a 2-D canvas.
// A pose is an array of 12: the rows of the rotation, then the translation, m.
(() => {
  "use strict";
  const scene = JSON.parse(document.getElementById("motion").textContent);
  const canvas = document.getElementById("view");
  const sliders = document.getElementById("sliders");
  const pen = canvas.getContext("2d");
  const q = scene.coordinates.map(() => 0);
  const millimetres = canvas.dataset.length === "mm";
  let shown = 0; // index of the chain whose frames and sliders are shown
  let framesAreShown = true;

  // ---- kinematics -------------------------------------------------------------------------------------------------

  const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];

  const times = (a, b) => {
    const c = new Array(12);
    for (let i = 0; i < 3; i++) {
      for (let j = 0; j < 3; j++) {
        c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
      }
      c[9 + i] = a[3 * i] * b[9] + a[3 * i + 1] * b[10] + a[3 * i + 2] * b[11] + a[9 + i];
    }
    return c;
  };

  const carry = (pose, p) =>
    [0, 1, 2].map((i) => pose[3 * i] * p[0] + pose[3 * i + 1] * p[1] + pose[3 * i + 2] * p[2] + pose[9 + i]);

  // exp(screw * value): I + sin [u] + (1 - cos) [u]^2 about the line through point, and a slide along it.
  const exp = (joint, value) => {
    const [x, y, z] = joint.direction;
    if (joint.kind === "prismatic") {
      return [1, 0, 0, 0, 1, 0, 0, 0, 1, x * value, y * value, z * value];
    }
    const s = Math.sin(value), half = Math.sin(value / 2), v = 2 * half * half;
    const r = [
      1 - v * (y * y + z * z), v * x * y - s * z, v * x * z + s * y,
      v * x * y + s * z, 1 - v * (x * x + z * z), v * y * z - s * x,
      v * x * z - s * y, v * y * z + s * x, 1 - v * (x * x + y * y),
    ];
    const p = joint.point, slide = joint.pitch * value;
    const t = [0, 1, 2].map(
      (i) => p[i] - (r[3 * i] * p[0] + r[3 * i + 1] * p[1] + r[3 * i + 2] * p[2]) + slide * joint.direction[i]);
    return r.concat(t);
  };

  // What the first 0, 1, ... n joints of a chain have moved what hangs on them by.
  const motions = (chain) => {
    const reached = [IDENTITY];
    for (const joint of chain.joints) {
      reached.push(times(reached[reached.length - 1], exp(joint, joint.scale * q[joint.coordinate])));
    }
    return reached;
  };

  // Fixed-axis angles roll, pitch, yaw, as URDF has them.
  const rpy = (r) => {
    const level = Math.hypot(r[0], r[3]);
    const pitch = Math.atan2(-r[6], level);
    return level < 1e-12 ? [0, pitch, Math.atan2(-r[1], r[4])] : [Math.atan2(r[7], r[8]), pitch, Math.atan2(r[3], r[0])];
  };

  // ---- the camera -------------------------------------------------------------------------------------------------

  const camera = { azimuth: -0.85, elevation: 0.42, zoom: 1 };
  const middle = [0, 0, 0];
  let radius = scene.size / 2;

  const frameRobot = () => {
    const lower = [0, 0, 0], upper = [0, 0, 0];
    for (const chain of scene.chains) {
      // The arrows of the frames want room, too.
      for (const { pose } of chain.frames) {
        for (const axis of [0, 2]) {
          for (let i = 0; i < 3; i++) {
            const tip = pose[9 + i] + 0.13 * scene.size * pose[3 * i + axis];
            if (Math.abs(tip) < 3 * scene.size) {
              lower[i] = Math.min(lower[i], tip);
              upper[i] = Math.max(upper[i], tip);
            }
          }
        }
      }
      for (const { from, to } of chain.links) {
        for (const [p] of [from, to]) {
          for (let i = 0; i < 3; i++) {
            if (Math.abs(p[i]) < 3 * scene.size) {
              lower[i] = Math.min(lower[i], p[i]);
              upper[i] = Math.max(upper[i], p[i]);
            }
          }
        }
      }
    }
    for (let i = 0; i < 3; i++) middle[i] = (lower[i] + upper[i]) / 2;
    radius = Math.max(0.5 * Math.hypot(...upper.map((u, i) => u - lower[i])), 0.2 * scene.size);
  };

  // To px to the right, px down, and m towards the reader.
  const projection = (width, height) => {
    const [ca, sa] = [Math.cos(camera.azimuth), Math.sin(camera.azimuth)];
    const [ce, se] = [Math.cos(camera.elevation), Math.sin(camera.elevation)];
    const right = [-sa, ca, 0], up = [-se * ca, -se * sa, ce], near = [ce * ca, ce * sa, se];
    const eye = 5 * radius, scale = (0.5 * Math.max(Math.min(width - 140, height - 60), 80) / radius) * camera.zoom;
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    return (p) => {
      const d = [p[0] - middle[0], p[1] - middle[1], p[2] - middle[2]];
      const depth = dot(d, near);
      const k = (scale * eye) / Math.max(eye - depth, 0.05 * eye);
      return [width / 2 + k * dot(d, right), height / 2 - k * dot(d, up), depth, k];
    };
  };

  // ---- drawing ----------------------------------------------------------------------------------------------------

  const INK = { link: "#5b6470", other: "#c3c9d0", joint: [226, 230, 236], edge: "#2c333b", grid: "#e6e9ee", x: "#c6281f", z: "#1a56c4" };

  const add = (a, b, k) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const n = Math.hypot(...a); return a.map((x) => x / n); };
  const turned = (pose, v) => carry(pose.slice(0, 9).concat([0, 0, 0]), v);

  const drawing = (project) => {
    const items = [];
    const line = (a, b, colour, thickness, lift = 0) => {
      const [p, r] = [project(a), project(b)];
      items.push({ depth: (p[2] + r[2]) / 2 + lift, paint: () => {
        pen.strokeStyle = colour;
        pen.lineWidth = thickness;
        pen.lineCap = "round";
        pen.beginPath();
        pen.moveTo(p[0], p[1]);
        pen.lineTo(r[0], r[1]);
        pen.stroke();
      } });
    };
    const face = (corners, normal) => {
      const seen = corners.map(project);
      const depth = seen.reduce((sum, p) => sum + p[2], 0) / seen.length;
      const light = 0.8 + 0.2 * (0.4 * normal[0] - 0.5 * normal[1] + 0.77 * normal[2]);
      const colour = `rgb(${INK.joint.map((c) => Math.round(c * light)).join(" ")})`;
      items.push({ depth: depth + 1e-3 * radius, paint: () => {
        pen.fillStyle = colour;
        pen.strokeStyle = corners.length > 4 || corners.block ? INK.edge : colour;
        pen.lineWidth = 1;
        pen.beginPath();
        seen.forEach((p, i) => (i ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1])));
        pen.closePath();
        pen.fill();
        pen.stroke();
      } });
    };
    const body = (kind, at, axis) => {
      const size = 0.022 * Math.min(radius * 2, scene.size);
      const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
      const one = unit(cross(axis, [0, 1, 2].map((i) => (i === least ? 1 : 0))));
      const other = cross(axis, one);
      const corners = kind === "prismatic" ? 4 : 20;
      const half = (kind === "prismatic" ? 1.6 : 1.35) * size;
      const spokes = Array.from({ length: corners }, (_, k) => {
        const angle = (2 * Math.PI * (k + 0.5)) / corners;
        return add(one.map((x) => x * size * Math.cos(angle)), other, size * Math.sin(angle));
      });
      const end = (side) => spokes.map((spoke) => add(add(at, spoke, 1), axis, side * half));
      const [top, bottom] = [end(1), end(-1)];
      if (corners === 4) top.block = bottom.block = true;
      face(top, axis);
      face(bottom, axis.map((x) => -x));
      spokes.forEach((spoke, k) => {
        const next = (k + 1) % corners;
        const side = [bottom[k], bottom[next], top[next], top[k]];
        side.block = corners === 4;
        face(side, unit(add(spoke, spokes[next], 1)));
      });
      if (kind === "helical") {
        const at_turn = (part) => add(add(add(at, axis, half * (2 * part - 1)), one, 1.04 * size * Math.cos(19 * part)), other, 1.04 * size * Math.sin(19 * part));
        for (let k = 0; k < 60; k++) line(at_turn(k / 60), at_turn((k + 1) / 60), INK.edge, 1);
      }
    };
    return { items, line, body };
  };

  const grid = (project) => {
    const step = 10 ** Math.round(Math.log10(radius / 2.5));
    const reach = Math.ceil((1.3 * radius) / step) * step;
    pen.lineWidth = 1;
    for (let k = -reach; k <= reach + step / 2; k += step) {
      for (const [a, b] of [[[k, -reach, 0], [k, reach, 0]], [[-reach, k, 0], [reach, k, 0]]]) {
        const [p, r] = [project(a), project(b)];
        pen.strokeStyle = Math.abs(k) < step / 2 ? "#cdd3db" : INK.grid;
        pen.beginPath();
        pen.moveTo(p[0], p[1]);
        pen.lineTo(r[0], r[1]);
        pen.stroke();
      }
    }
  };

  // Every name off the others and inside the canvas, near what it names; where there is no room it is left out until the
  // reader comes nearer.
  const words = (tags, marks, width, height) => {
    const taken = [];
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.font = "600 12px system-ui, sans-serif";
    pen.lineJoin = "round";
    for (const { text, at, out, colour } of tags) {
      const wide = pen.measureText(text).width / 2 + 2, high = 8;
      const forward = Math.atan2(out[1], out[0]);
      let best = null;
      for (const far of [3, 10, 19, 30, 44]) {
        for (let k = 0; k < 24; k++) {
          const aside = (k * Math.PI) / 12, [c, s] = [Math.cos(forward + aside), Math.sin(forward + aside)];
          const x = at[0] + c * (far + Math.abs(c) * wide + Math.abs(s) * high);
          const y = at[1] + s * (far + Math.abs(s) * high);
          if (x - wide < 3 || x + wide > width - 3 || y - high < 3 || y + high > height - 3) continue;
          if (taken.some((t) => Math.abs(t.x - x) < t.wide + wide + 1 && Math.abs(t.y - y) < 2 * high - 2)) continue;
          const covered = marks.filter((m) => Math.abs(m[0] - x) < wide && Math.abs(m[1] - y) < high).length;
          const cost = far + 3 * Math.min(aside, 2 * Math.PI - aside) + 5 * covered;
          if (!best || cost < best.cost) best = { cost, x, y, far };
        }
      }
      if (!best) continue;
      const { x, y, far } = best;
      taken.push({ text, x, y, wide, high });
      if (far > 15) {
        pen.strokeStyle = "#b4bbc4";
        pen.lineWidth = 0.8;
        pen.beginPath();
        pen.moveTo(at[0], at[1]);
        pen.lineTo(Math.max(x - wide, Math.min(x + wide, at[0])), Math.max(y - high, Math.min(y + high, at[1])));
        pen.stroke();
      }
      pen.strokeStyle = "rgb(255 255 255 / 0.9)";
      pen.lineWidth = 3;
      pen.strokeText(text, x, y);
      pen.fillStyle = colour;
      pen.fillText(text, x, y);
    }
    canvas.dataset.named = JSON.stringify({ asked: tags.length, width, height, words: taken });
  };

  const draw = () => {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const project = projection(width, height);
    grid(project);
    const { items, line, body } = drawing(project);
    const tags = [];
    // What a name should not lie on, px.
    const marks = [];
    scene.chains.forEach((chain, index) => {
      const reached = motions(chain);
      const mine = index === shown;
      for (const { from, to } of chain.links) {
        const [a, b] = [carry(reached[from[1]], from[0]), carry(reached[to[1]], to[0])];
        const length = Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        const parts = Math.min(24, Math.ceil(length / (0.06 * radius)));
        for (let k = 0; k < parts; k++) {
          const at = (part) => add(a, [b[0] - a[0], b[1] - a[1], b[2] - a[2]], part / parts);
          if (mine) marks.push(project(at(k)));
          line(at(k), at(k + 1), mine ? INK.link : INK.other, mine ? 5 : 3.5, mine ? 0 : -0.05 * radius);
        }
      }
      if (!mine) return;
      chain.joints.forEach((joint, k) => body(joint.kind, carry(reached[k], joint.body), turned(reached[k], joint.direction)));
      if (!framesAreShown) return;
      const length = 0.13 * Math.min(2 * radius, scene.size);
      const named = new Map();
      for (const frame of chain.frames) {
        const pose = times(reached[frame.carried], frame.pose);
        const at = pose.slice(9);
        for (const [axis, colour] of [[0, "x"], [2, "z"]]) {
          const tip = add(at, [pose[axis], pose[3 + axis], pose[6 + axis]], length);
          line(at, add(at, tip.map((t, i) => t - at[i]), 0.5), INK[colour], 2.2, 2e-3 * radius);
          line(add(at, tip.map((t, i) => t - at[i]), 0.5), tip, INK[colour], 2.2, 2e-3 * radius);
          const [p, r] = [project(at), project(tip)];
          for (let k = 0; k <= 6; k++) marks.push([0, 1].map((i) => p[i] + ((r[i] - p[i]) * k) / 6));
          const reach = Math.hypot(r[0] - p[0], r[1] - p[1]);
          const head = Math.min(9, 0.7 * reach), [dx, dy] = reach > 1 ? [(r[0] - p[0]) / reach, (r[1] - p[1]) / reach] : [0, 0];
          items.push({ depth: r[2] + 2e-3 * radius, paint: () => {
            pen.fillStyle = INK[colour];
            pen.beginPath();
            pen.moveTo(r[0] + 2 * dx, r[1] + 2 * dy);
            pen.lineTo(r[0] - head * dx - 0.4 * head * dy, r[1] - head * dy + 0.4 * head * dx);
            pen.lineTo(r[0] - head * dx + 0.4 * head * dy, r[1] - head * dy - 0.4 * head * dx);
            pen.fill();
          } });
          const key = `${colour} ${tip.map((t) => Math.round(t / (1e-3 * radius))).join()}`;
          const known = named.get(key);
          if (known) known.names.push(frame.name);
          else named.set(key, { names: [frame.name], letter: colour, at: r, out: [dx, dy], colour: INK[colour] });
        }
      }
      for (const { names, letter, at, out, colour } of named.values()) {
        const kept = names.length > 1 ? names.filter((name) => name !== "base") : names;
        tags.push({ text: `${letter} ${kept.join(",")}`, at, out, colour });
      }
    });
    items.sort((a, b) => a.depth - b.depth).forEach((item) => item.paint());
    words(tags, marks, width, height);
  };

  let waiting = false;
  const redraw = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
  };

  // ---- numbers and sliders ----------------------------------------------------------------------------------------

  const decimal = (value, places) => {
    const text = value.toFixed(places);
    return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−");
  };
  const length = (metres) => (millimetres ? `${decimal(metres * 1e3, 2)} mm` : `${decimal(metres, 4)} m`);
  const angle = (radians) => `${decimal((radians * 180) / Math.PI, 2)}°`;

  const tell = () => {
    const chain = scene.chains[shown];
    const reached = motions(chain);
    const tip = times(reached[reached.length - 1], chain.home);
    const values = { x: tip[9], y: tip[10], z: tip[11] };
    [values.roll, values.pitch, values.yaw] = rpy(tip);
    for (const [name, value] of Object.entries(values)) {
      const cell = document.getElementById(`tip-${name}`);
      cell.dataset.value = String(value);
      cell.textContent = "xyz".includes(name) ? length(value) : angle(value);
    }
    for (const row of sliders.children) {
      const index = Number(row.dataset.coordinate), { turns, lower, upper } = scene.coordinates[index];
      const value = q[index];
      row.querySelector("output").textContent = turns ? angle(value) : length(value);
      row.classList.toggle("outside", value < lower || value > upper);
    }
    // For a view that is laid over this one.
    canvas.dataset.posture = JSON.stringify({ chain: shown, q: Object.fromEntries(scene.coordinates.map(({ name }, index) => [name, q[index]])) });
    canvas.dispatchEvent(new Event("posture"));
    redraw();
  };

  const SUBSCRIPTS = "₀₁₂₃₄₅₆₇₈₉";

  const makeSliders = () => {
    sliders.textContent = "";
    scene.chains[shown].coordinates.forEach((index, position) => {
      const { name, lower, upper } = scene.coordinates[index];
      const row = document.createElement("label");
      row.dataset.coordinate = String(index);
      const title = document.createElement("span");
      const number = String(position + 1).replace(/\d/g, (digit) => SUBSCRIPTS[digit]);
      title.append(Object.assign(document.createElement("b"), { textContent: `q${number}` }), ` ${name}`);
      const range = Object.assign(document.createElement("input"), { type: "range", step: "any" });
      range.min = String(Math.min(lower, 0));
      range.max = String(Math.max(upper, 0));
      range.value = String(q[index]);
      range.addEventListener("input", () => { q[index] = range.valueAsNumber; tell(); });
      row.append(title, document.createElement("output"), range);
      sliders.append(row);
    });
  };

  const set = (value) => {
    for (const row of sliders.children) {
      const index = Number(row.dataset.coordinate);
      q[index] = value(scene.coordinates[index], index);
      row.querySelector("input").value = String(q[index]);
    }
    tell();
  };

  // #q=0.1,0.2: values of the shown chain's coordinates, rad and m; #chain=1&q=...: another chain's.
  const readAddress = () => {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const chain = Number(wanted.get("chain") ?? shown);
    if (Number.isInteger(chain) && chain >= 0 && chain < scene.chains.length) show(chain);
    const values = (wanted.get("q") ?? "").split(",").map(Number);
    if (wanted.has("q") && values.every(Number.isFinite)) {
      let next = 0;
      set((_, index) => values[next++] ?? q[index]);
    }
  };

  const picker = document.getElementById("chain");
  const show = (chain) => {
    shown = chain;
    if (picker) picker.value = String(chain);
    makeSliders();
    tell();
  };

  // ---- the reader's hands -----------------------------------------------------------------------------------------

  const held = new Map();
  const spread = () => { const [a, b] = [...held.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = held.get(event.pointerId);
    if (!last) return;
    const before = held.size === 2 ? spread() : 0;
    held.set(event.pointerId, [event.clientX, event.clientY]);
    if (held.size === 2) {
      zoom(spread() / before);
    } else {
      turn((event.clientX - last[0]) * 0.008, (event.clientY - last[1]) * 0.008);
    }
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => held.delete(event.pointerId));
  const turn = (across, down) => {
    camera.azimuth -= across;
    camera.elevation = Math.max(-1.57, Math.min(1.57, camera.elevation + down));
    redraw();
  };
  const zoom = (factor) => {
    if (Number.isFinite(factor)) camera.zoom = Math.max(0.2, Math.min(20, camera.zoom * factor));
    redraw();
  };
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.0015 * event.deltaY));
  }, { passive: false });
  const KEYS = {
    ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
    "+": () => zoom(1.2), "=": () => zoom(1.2), "-": () => zoom(1 / 1.2),
  };
  canvas.addEventListener("keydown", (event) => {
    if (KEYS[event.key]) {
      event.preventDefault();
      KEYS[event.key]();
    }
  });

  const VIEWS = { isometric: [-Math.PI / 4, Math.atan(Math.SQRT1_2)], front: [0, 0], side: [-Math.PI / 2, 0], top: [-Math.PI / 2, 1.57] };
  const POSTURES = {
    zero: () => 0,
    middle: ({ lower, upper }) => (lower + upper) / 2,
    random: ({ lower, upper }) => lower + (upper - lower) * Math.random(),
  };
  document.getElementById("buttons").addEventListener("click", (event) => {
    const { view, posture } = event.target.dataset;
    if (view) {
      [camera.azimuth, camera.elevation] = VIEWS[view];
      camera.zoom = 1;
      redraw();
    }
    if (posture) set(POSTURES[posture]);
  });
  document.getElementById("frames").addEventListener("change", (event) => { framesAreShown = event.target.checked; redraw(); });
  picker?.addEventListener("change", () => show(Number(picker.value)));
  window.addEventListener("hashchange", readAddress);
  window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((part) => { part.open = true; }));
  new ResizeObserver(redraw).observe(canvas);

  frameRobot();
  show(0);
  readAddress();
  draw();
})();
