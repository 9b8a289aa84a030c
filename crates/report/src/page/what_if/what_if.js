"use strict";
// What if: integrates the recommended model in the page with other stiffness, damping, mass and speed. It shows itself
// only if, as identified, it finds the crush and time of the simulate stage again to a thousandth.
(function () {
  const section = document.getElementById("what-if");
  const data = JSON.parse(document.getElementById("what-if-data").textContent);
  const TOLERANCE = 1e-3;

  // A number with so many decimals and a true minus.
  const number = function (value, places) { return value.toFixed(places).replace("-", "\u2212"); };

  // y(q) through points, constant beyond the last.
  function along(points, q) {
    let j = 1;
    if (points.length === 1 || q <= points[0][0]) { return points[0][1]; }
    while (j < points.length && points[j][0] < q) { j += 1; }
    if (j === points.length) { return points[j - 1][1]; }
    const a = points[j - 1], b = points[j];
    return a[1] + (b[1] - a[1]) * (q - a[0]) / (b[0] - a[0]);
  }

  // Force of a crushed curve at a deflection, without rate factor.
  function static_force(e, d) {
    if (d <= 0) { return 0; }
    const last = e.knots[e.knots.length - 1];
    const force = d > last[0] ? Math.max(0, last[1] + e.beyond * (d - last[0])) : along(e.knots, d);
    return e.limit === null ? force : Math.min(force, e.limit);
  }

  function loading_force(e, d, w) {
    const force = static_force(e, d) * (1 + e.rate * w);
    return e.limit === null ? force : Math.min(force, e.limit);
  }

  // The model with factors on springs and dampers. Fourth order Runge-Kutta; on which branch a curve is changes
  // between steps.
  function integrate(change) {
    const n = data.masses.length;
    const mass = data.masses.map(function (m) { return m * change.mass; });
    const elements = data.elements.map(function (e) {
      const scaled = function (points, by) { return points.map(function (p) { return [p[0], p[1] * by]; }); };
      const k = change.stiffness, c = change.damping;
      switch (e.kind) {
        case "spring": return Object.assign({}, e, { points: scaled(e.points, k) });
        case "damper": return Object.assign({}, e, { points: scaled(e.points, c) });
        case "series": return Object.assign({}, e, { k: e.k * k, c: e.c * c });
        default: return Object.assign({}, e, {
          knots: scaled(e.knots, k), beyond: e.beyond * k, unloading: e.unloading * k, rate: e.rate * c,
          limit: e.limit === null ? null : e.limit * k, loading: true, set: 0,
        });
      }
    });
    const size = 2 * n + elements.length;
    let y = new Float64Array(size);
    for (let i = 0; i < n; i += 1) { y[n + i] = change.speed; }
    const force = new Float64Array(n);

    // How far and how fast the ends of an element come together.
    function way(e, y) { return y[e.rear] - (e.front < 0 ? 0 : y[e.front]); }
    function pace(e, y) { return y[n + e.rear] - (e.front < 0 ? 0 : y[n + e.front]); }
    function force_of(e, y, j) {
      switch (e.kind) {
        case "spring": { const u = way(e, y); return along(e.points, Math.abs(u)) * u; }
        case "damper": { const w = pace(e, y); return along(e.points, Math.abs(w)) * w; }
        case "series": return e.k * y[2 * n + j];
        default: {
          const d = way(e, y) - e.gap;
          if (e.loading) { return loading_force(e, d, pace(e, y)); }
          const elastic = e.unloading * (d - e.set);
          return e.pulls ? elastic : Math.max(0, elastic);
        }
      }
    }
    function rates(y, out) {
      force.fill(0);
      for (let j = 0; j < elements.length; j += 1) {
        const e = elements[j], f = force_of(e, y, j);
        force[e.rear] -= f;
        if (e.front >= 0) { force[e.front] += f; }
        out[2 * n + j] = e.kind === "series" ? pace(e, y) - f / e.c : 0;
      }
      for (let i = 0; i < n; i += 1) {
        out[i] = y[n + i];
        out[n + i] = force[i] / mass[i];
      }
    }
    function settle(y) {
      elements.forEach(function (e) {
        if (e.kind !== "curve") { return; }
        const w = pace(e, y), d = way(e, y) - e.gap;
        if (e.loading && w < 0 && d > 0) {
          e.loading = false;
          e.set = d - static_force(e, d) / e.unloading;
        } else if (!e.loading && w > 0 && d > e.set && e.unloading * (d - e.set) >= loading_force(e, d, w)) {
          e.loading = true;
        }
      });
    }
    // A step well below every time constant.
    let fastest = 1 / data.time;
    for (let i = 0; i < n; i += 1) {
      let k = 0, c = 0;
      elements.forEach(function (e) {
        if (e.front !== i && e.rear !== i) { return; }
        const most = function (points) {
          return points.reduce(function (largest, p) { return Math.max(largest, Math.abs(p[1])); }, 0);
        };
        if (e.kind === "spring") { k += most(e.points); }
        if (e.kind === "damper") { c += most(e.points); }
        if (e.kind === "series") { k += e.k; fastest = Math.max(fastest, e.k / e.c); }
        if (e.kind === "curve") { k += e.unloading; }
      });
      fastest = Math.max(fastest, Math.sqrt(k / mass[i]) + c / mass[i]);
    }
    const end = 4 * data.end;
    const h = Math.min(data.time / 1500, Math.max(0.05 / fastest, end / 60000));
    const a = new Float64Array(size), b = new Float64Array(size), c = new Float64Array(size);
    const d = new Float64Array(size), z = new Float64Array(size);
    const result = { crush: null, time: null, rebound: null, t: [], x: [], a: [] };
    const keep = Math.max(1, Math.round(data.end / h / 300));
    let until = end;
    const p = n - 1;
    for (let step = 0, t = 0; t <= until; step += 1, t = step * h) {
      rates(y, a);
      if (step % keep === 0) {
        result.t.push(1e3 * t); result.x.push(data.length[0] * y[p]); result.a.push(data.g * a[n + p]);
      }
      const v = y[n + p], x = y[p], acceleration = a[n + p];
      for (let i = 0; i < size; i += 1) { z[i] = y[i] + 0.5 * h * a[i]; }
      rates(z, b);
      for (let i = 0; i < size; i += 1) { z[i] = y[i] + 0.5 * h * b[i]; }
      rates(z, c);
      for (let i = 0; i < size; i += 1) { z[i] = y[i] + h * c[i]; }
      rates(z, d);
      for (let i = 0; i < size; i += 1) { y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]); }
      if (result.time === null && y[n + p] <= 0) {
        const share = v / (v - y[n + p]);
        result.time = t + share * h;
        result.crush = x + share * h * v / 2;
        until = Math.max(2 * result.time, data.end);
      }
      settle(y);
      if (result.time !== null && result.rebound === null && acceleration < 0) {
        rates(y, a);
        if (a[n + p] >= 0) { result.rebound = y[n + p]; }
      }
      if (!isFinite(y[p])) { return null; }
    }
    return result;
  }

  const identified = { stiffness: 1, damping: 1, mass: 1, speed: data.v0 };
  const original = integrate(identified);
  // Factor from SI, decimals and unit.
  const length = function (m) { return number(data.length[0] * m, data.length[1]) + " " + data.length[2]; };
  const [perKg, , kg] = data.mass, [perSpeed, , speedUnit] = data.speed;
  const off = function (found, stage) { return Math.abs(found - stage) / stage; };
  const state = section.querySelector(".state");
  section.hidden = false;
  if (original === null || original.time === null || off(original.crush, data.crush) > TOLERANCE
      || off(original.time, data.time) > TOLERANCE) {
    section.dataset.state = "off";
    const stopped = original !== null && original.time !== null;
    const motion = function (m) { return `${length(m.crush)} at ${number(1e3 * m.time, 2)} ms`; };
    const instead = stopped ? ` (${motion(original)} instead of ${motion(data)})` : "";
    state.textContent =
      `Switched off: this page does not find the crush and time of the simulation again${instead}.`;
    return;
  }

  const damped = data.elements.some(function (e) { return e.kind !== "curve" && e.kind !== "spring"; });
  const rated = data.elements.some(function (e) { return e.rate > 0; });
  const total = data.masses.reduce(function (sum, m) { return sum + m; }, 0);
  // Letter in the address, name, unit, range, step, factor from the shown number to that of the model.
  const sliders = [
    { key: "k", of: "stiffness", name: "Stiffness", unit: "%", low: 50, high: 200, step: 1, per: 0.01 },
    { key: "c", of: "damping", name: damped ? "Damping" : "Rate effect", unit: "%", low: 0, high: 300, step: 1,
      per: 0.01 },
    { key: "m", of: "mass", name: "Mass", unit: kg, low: Math.round(0.5 * perKg * total),
      high: Math.round(2 * perKg * total), step: 1, per: 1 / (perKg * total) },
    { key: "v", of: "speed", name: "Speed", unit: speedUnit, low: Math.ceil(2.7 * perSpeed),
      high: Math.ceil(perSpeed * Math.max(33.3, 1.5 * data.v0)), step: 0.1, per: 1 / perSpeed },
  ].filter(function (s) { return s.key !== "c" || damped || rated; });

  const controls = section.querySelector(".controls");
  sliders.forEach(function (s) {
    s.start = Number((identified[s.of] / s.per).toFixed(1));
    const label = document.createElement("label");
    const name = document.createElement("span");
    const input = document.createElement("input");
    const output = document.createElement("output");
    name.textContent = s.name;
    Object.assign(input, { type: "range", min: s.low, max: s.high, step: s.step, id: "what-if-" + s.key });
    input.value = s.start;
    output.htmlFor = input.id;
    label.append(name, input, output);
    controls.append(label);
    Object.assign(s, { input: input, output: output });
    input.addEventListener("input", function () { update(true); });
  });
  const reset = document.createElement("button");
  reset.type = "button";
  reset.textContent = "as identified";
  reset.addEventListener("click", function () {
    sliders.forEach(function (s) { s.input.value = s.start; });
    update(true);
  });
  controls.append(reset);

  const SVG = section.querySelector(".panels svg").namespaceURI;
  function shape(parent, name, attributes, text) {
    const element = document.createElementNS(SVG, name);
    Object.keys(attributes).forEach(function (key) { element.setAttribute(key, attributes[key]); });
    if (text !== undefined) { element.textContent = text; }
    parent.append(element);
    return element;
  }
  // Round steps, five or so in a span.
  function ticks(low, high) {
    const raw = (high - low) / 5, size = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].map(function (f) { return f * size; }).find(function (s) { return s >= raw; });
    const all = [];
    for (let k = Math.ceil(low / step); k * step <= high; k += 1) { all.push(Number((k * step).toPrecision(6))); }
    return all;
  }
  function panel(svg, title, unit, curves) {
    // The frame of all figures.
    const W = 560, H = 306, L = 66, R = 14, T = 26, B = 50;
    const all = curves.reduce(function (list, c) { return list.concat(c.points); }, []);
    const bound = function (i, pick) { return all.reduce(function (m, p) { return pick(m, p[i]); }, 0); };
    const right = bound(0, Math.max), low = bound(1, Math.min), high = bound(1, Math.max);
    const x = function (t) { return L + (W - L - R) * t / right; };
    const y = function (v) { return T + (H - T - B) * (high - v) / (high - low || 1); };
    svg.replaceChildren();
    shape(svg, "title", {}, title + " over time: test, model as identified, model as set");
    ticks(low, high).forEach(function (v) {
      shape(svg, "path", { class: "g", d: "M" + L + " " + y(v).toFixed(1) + "H" + (W - R) });
      shape(svg, "text", { x: L - 6, y: (y(v) + 4.5).toFixed(1), "text-anchor": "end" },
        String(v).replace("-", "\u2212"));
    });
    ticks(0, right).forEach(function (t) {
      shape(svg, "text", { x: x(t).toFixed(1), y: H - B + 19, "text-anchor": "middle" }, String(t));
    });
    shape(svg, "rect", { class: "frame", x: L, y: T, width: W - L - R, height: H - T - B });
    shape(svg, "text", { class: "t", x: 4, y: 16 }, title.toLowerCase() + ", " + unit);
    shape(svg, "text", { class: "t", x: (L + W - R) / 2, y: H - 8, "text-anchor": "middle" },
      "time after time zero, ms");
    curves.forEach(function (c) {
      const d = c.points.map(function (p, i) {
        return (i ? "L" : "M") + x(p[0]).toFixed(1) + " " + y(p[1]).toFixed(1);
      });
      shape(svg, "path", { class: c.name, d: d.join("") });
    });
  }
  const panels = section.querySelector(".panels");
  const charts = panels.querySelectorAll("svg");
  const legend = document.createElement("p");
  legend.className = "legend";
  const names = [["test", "test"], ["identified", "model as identified"], ["changed", "model as set"]];
  names.forEach(function (entry) {
    const svg = shape(legend, "svg", { viewBox: "0 0 30 8", "aria-hidden": "true" });
    shape(svg, "path", { class: entry[0], d: "M1 4H29" });
    legend.append(entry[1] + " ");
  });
  panels.after(legend);

  const points = function (r, y) { return r.t.map(function (t, i) { return [t, r[y][i]]; }); };
  const percent = function (now, then) {
    const p = 100 * (now - then) / then;
    return (p < 0 ? "\u2212" : "+") + number(Math.abs(p), 1) + " %";
  };
  function update(keep) {
    const change = Object.assign({}, identified);
    let is_changed = false;
    sliders.forEach(function (s) {
      const shown = Number(s.input.value);
      s.output.textContent = shown + " " + s.unit;
      s.input.setAttribute("aria-valuetext", s.output.textContent);
      if (shown !== s.start) { change[s.of] = shown * s.per; is_changed = true; }
    });
    const result = is_changed ? integrate(change) : original;
    const stops = result !== null && result.time !== null;
    let answer = "The model does not stop.";
    if (stops) {
      const crush = `${length(result.crush)} (${percent(result.crush, original.crush)})`;
      const time = `${number(1e3 * result.time, 1)} ms (${percent(result.time, original.time)})`;
      const restitution = result.rebound === null ? ""
        : ", restitution " + number(Math.max(0, -result.rebound / change.speed), 3);
      const is_beyond = data.tested !== null && result.crush > 1.001 * data.tested;
      answer = `C ${crush} after ${time}${restitution}${is_beyond ? "; beyond the tested crush" : ""}.`;
      section.dataset.crush = result.crush;
      section.dataset.time = result.time;
    }
    section.querySelector(".answer").textContent = answer;
    if (result !== null) {
      [["Displacement", data.length[2], "x", data.displacement], ["Acceleration", "g", "a", data.acceleration]]
        .forEach(function (p, i) {
          const curves = [{ name: "identified", points: points(original, p[2]) },
            { name: "changed", points: points(result, p[2]) }];
          if (p[3]) { curves.unshift({ name: "test", points: p[3] }); }
          panel(charts[i], p[0], p[1], curves);
        });
    }
    if (keep) {
      const moved = sliders.filter(function (s) { return Number(s.input.value) !== s.start; });
      const hash = moved.map(function (s) { return s.key + "=" + s.input.value; }).join("&");
      history.replaceState(null, "", hash ? "#" + hash : location.pathname + location.search);
    }
  }
  // Of the address `#k=110&v=64`; any other fragment is somebody else's.
  function read() {
    const state = new URLSearchParams(location.hash.slice(1));
    const own = sliders.filter(function (s) { return state.has(s.key) && isFinite(Number(state.get(s.key))); });
    if (own.length > 0 || location.hash === "") {
      sliders.forEach(function (s) { s.input.value = own.includes(s) ? state.get(s.key) : s.start; });
    }
    update(false);
  }
  section.dataset.state = "ready";
  state.textContent = "As identified this page finds crush and time of the simulation again to 0.1 %. Stiffness and " +
    "damping are shares of those identified. The acceleration is that of the model itself, the test’s is filtered. " +
    "The address of the page keeps the sliders, to be sent.";
  window.addEventListener("hashchange", read);
  read();
}());
