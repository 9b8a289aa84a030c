"use strict";
// A cursor and a zoom through all figures over time, and downloads. The figures are drawn without it; it reads their
// curves off the drawing, which is true to 0.02 % of an axis.
(function () {
  const SVG = "http://www.w3.org/2000/svg";
  const make = (tag, attributes, text, space) => {
    const element = space ? document.createElementNS(space, tag) : document.createElement(tag);
    for (const name in attributes) element.setAttribute(name, attributes[name]);
    if (text !== undefined) element.textContent = text;
    return element;
  };
  const numbers = (text) => text.split(" ").map(Number);
  const written = (text) => text.replace(/^-(?=[0.]*$)/, "").replace("-", "−");

  class Plot {
    constructor(svg) {
      this.svg = svg;
      this.figure = svg.closest(".figure");
      this.inside = svg.querySelector("svg.in");
      [this.left, this.top, this.width, this.height] =
        ["x", "y", "width", "height"].map((name) => Number(this.inside.getAttribute(name)));
      this.x = numbers(svg.dataset.x);
      this.y = numbers(svg.dataset.y);
      this.view = this.x;
      this.isTime = "time" in svg.dataset;
      this.log = svg.dataset.log || "";
      this.follows = "follows" in svg.dataset ? Number(svg.dataset.follows) : null;
      const titles = svg.querySelectorAll(":scope > text.t:not(.halo)");
      // The power of ten belongs to the axis' numbers; values are told in full.
      [this.yTitle, this.xTitle] = [0, 1].map((k) => titles[k].textContent.replace(/ × 10\S+$/, ""));
      this.read = new Map();
    }
    value(share, [low, high], log) {
      return log ? low * Math.pow(high / low, share) : low + share * (high - low);
    }
    /** The curve of a place in the legend, in the units of the axes; empty without one. Read when first asked for. */
    curve(entry) {
      const known = this.read.get(entry);
      if (known) return known;
      const points = [];
      for (const path of this.inside.querySelectorAll(`path.l.e${entry}:not(.p)`)) {
        for (const stretch of path.getAttribute("d").split("M").slice(1)) {
          const steps = (stretch.match(/-?(?:\d+\.?\d*|\.\d+)/g) || []).map(Number);
          let [x, y] = [0, 0];
          if (points.length) points.push([NaN, NaN]);
          for (let k = 0; k + 1 < steps.length; k += 2) {
            x += steps[k];
            y += steps[k + 1];
            points.push([
              this.value(x / this.width, this.x, this.log.includes("x")),
              this.value(1 - y / this.height, this.y, this.log.includes("y")),
            ]);
          }
        }
      }
      this.read.set(entry, points);
      return points;
    }
    /** The curve of that entry at x. */
    at(entry, x) {
      const points = this.curve(entry);
      if (points.length === 0) return null;
      let [low, high] = [0, points.length - 1];
      if (!(x >= points[0][0] && x <= points[high][0])) return null;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (points[middle][0] <= x) low = middle; else high = middle;
      }
      const [a, b] = [points[low], points[high]];
      const y = b[0] > a[0] ? a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) : a[1];
      return Number.isFinite(y) ? y : null;
    }
    place(x, y) {
      return [
        this.left + (x - this.view[0]) / (this.view[1] - this.view[0]) * this.width,
        this.top + (1 - (y - this.y[0]) / (this.y[1] - this.y[0])) * this.height,
      ];
    }
    contains(x, y) {
      return x >= this.view[0] && x <= this.view[1] && y >= this.y[0] && y <= this.y[1];
    }
    text(y) {
      const places = Math.ceil(-Math.log10((this.y[1] - this.y[0]) / 1000));
      return written(y.toFixed(Math.min(Math.max(places, 0), 6)));
    }
    zoom(view) {
      this.view = view || this.x;
      const unit = this.width / (this.x[1] - this.x[0]);
      this.inside.setAttribute("viewBox",
        `${(this.view[0] - this.x[0]) * unit} 0 ${(this.view[1] - this.view[0]) * unit} ${this.height}`);
      for (const named of this.svg.querySelectorAll("[data-at]")) {
        const at = Number(named.dataset.at);
        if (named.first === undefined) named.first = named.getAttribute("x") || named.getAttribute("cx");
        const x = view ? this.place(at, 0)[0] : named.first;
        named.setAttribute(named.tagName === "circle" ? "cx" : "x", x);
        named.style.display = at < this.view[0] || at > this.view[1] ? "none" : "";
      }
      const ticks = this.svg.querySelector("g.xs");
      if (!this.firstTicks) this.firstTicks = Array.from(ticks.childNodes);
      if (!view) {
        ticks.replaceChildren(...this.firstTicks);
        return;
      }
      ticks.textContent = "";
      const rough = (view[1] - view[0]) / 8;
      const power = Math.pow(10, Math.floor(Math.log10(rough)));
      const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999999);
      const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      const bottom = this.top + this.height;
      for (let x = Math.ceil(view[0] / step) * step; x <= view[1]; x += step) {
        const at = this.place(x, 0)[0];
        ticks.append(make("path", { class: "g", d: `M${at} ${this.top}V${bottom}` }, undefined, SVG));
        const tick = { x: at, y: bottom + 19, "text-anchor": "middle" };
        ticks.append(make("text", tick, written((x + 0).toFixed(places)), SVG));
      }
    }
  }

  // The figure of the first screen repeats what the next one has.
  const figures = Array.from(document.querySelectorAll(".figure:not(#first)")).map((element) => ({
    element,
    plots: Array.from(element.querySelectorAll("svg.plot"), (svg) => new Plot(svg)),
    boxes: Array.from(element.querySelectorAll(".legend li:not(.all) input")),
    names: Array.from(element.querySelectorAll(".legend li:not(.all) label"), (label) => label.textContent.trim()),
  }));
  const overTime = figures.filter((figure) => figure.plots.some((plot) => plot.isTime));
  const timePlots = overTime.flatMap((figure) => figure.plots.filter((plot) => plot.isTime));

  // ---- The cursor.
  let time = null;
  let shown = null;
  const whole = timePlots.length ? timePlots[0].x : [0, 1];
  const limits = [whole[0] - 0.25 * (whole[1] - whole[0]), whole[1] + 0.5 * (whole[1] - whole[0])];
  const slider = make("input", { type: "range", min: 0, max: 1000, step: 1, "aria-label": "Time of the cursor" });
  const output = make("output", { class: "time" });

  /** The pictures of models: outlines of their masses where they are at the cursor's time. */
  const pictures = Array.from(document.querySelectorAll(".model-picture[data-until]"), (svg) => {
    const masses = Array.from(svg.querySelectorAll("rect[data-places]"), (mass) => {
      const outline = mass.cloneNode();
      outline.setAttribute("class", "moved");
      outline.removeAttribute("data-places");
      return { places: numbers(mass.dataset.places), first: Number(mass.getAttribute("x")), outline };
    });
    const { width, height } = svg.viewBox.baseVal;
    const now = make("text", { class: "now", x: width / 2, y: height - 7, "text-anchor": "middle" }, "", SVG);
    return { svg, masses, now, until: Number(svg.dataset.until) };
  });
  function drawPictures() {
    for (const { svg, masses, now, until } of pictures) {
      if (!now.parentNode) svg.append(...masses.map((mass) => mass.outline), now);
      for (const { places, first, outline } of masses) {
        const step = Math.round(Math.min(Math.max(time / until, 0), 1) * 60);
        outline.setAttribute("x", first + places[Math.min(step, places.length - 1)]);
      }
      now.textContent = output.textContent;
    }
  }

  /** What is enough of a name beside its value: `recommended`, `Kelvin model (fitted)`. */
  const brief = (name) => {
    const role = /^(recommended and closest|recommended|closest): /.exec(name);
    const [model, ...more] = name.split("), ");
    return role ? role[1] : more.length > 0 ? `${model})` : name.replace(/ \(.*\)$/, "");
  };

  /** Head of a column: a quantity and its unit, which alone is enough where there is little room. */
  function titled(title) {
    const cell = make("th", { scope: "col", class: "n", abbr: title });
    const at = title.lastIndexOf(", ") + 2;
    if (at > 1) cell.append(make("span", {}, title.slice(0, at)));
    cell.append(title.slice(at > 1 ? at : 0));
    return cell;
  }

  /** The values of a figure at the cursor: for each curve that is shown one of each panel. */
  function values(figure) {
    const rows = [];
    figure.names.forEach((name, entry) => {
      if (!figure.boxes[entry].checked) return;
      const cells = figure.plots.map((plot) => {
        if (plot.isTime) return [time, plot.at(entry, time)];
        if (plot.follows === null) return null;
        const [acceleration, , displacement] = figure.plots;
        const [a, x] = [acceleration.at(entry, time), displacement.isTime ? displacement.at(entry, time) : null];
        return a === null || x === null ? null : [x, plot.follows * a];
      });
      if (cells.some((cell) => cell && cell[1] !== null)) rows.push({ name, entry, cells });
    });
    return rows;
  }

  function draw() {
    output.textContent = written(time.toFixed(1)) + " ms";
    const view = shown || whole;
    slider.value = 1000 * (time - view[0]) / (view[1] - view[0]);
    slider.setAttribute("aria-valuetext", output.textContent);
    for (const figure of overTime) {
      const rows = values(figure);
      const head = figure.table.querySelector("thead tr");
      const columns = figure.plots.map((plot, k) => k)
        .filter((k) => figure.plots[k].isTime || figure.plots[k].follows !== null);
      if (!head.firstChild) {
        head.append(make("th", { scope: "col" }, "at the cursor"));
        for (const k of columns) head.append(titled(figure.plots[k].yTitle));
      }
      const body = figure.table.querySelector("tbody");
      body.textContent = "";
      for (const row of rows) {
        const line = make("tr", {});
        line.append(make("th", { scope: "row" }, brief(row.name)));
        for (const k of columns) {
          const cell = row.cells[k];
          const text = cell && cell[1] !== null ? figure.plots[k].text(cell[1]) : "–";
          line.append(make("td", { class: "n" }, text));
        }
        body.append(line);
      }
      figure.plots.forEach((plot, k) => {
        plot.layer.textContent = "";
        if (plot.isTime && time >= plot.view[0] && time <= plot.view[1]) {
          const x = plot.place(time, 0)[0];
          const bottom = plot.top + plot.height;
          plot.layer.append(make("path", { class: "l event w1", d: `M${x} ${plot.top}V${bottom}` }, undefined, SVG));
        }
        for (const row of rows) {
          const cell = row.cells[k];
          if (!cell || cell[1] === null || !plot.contains(cell[0], cell[1])) continue;
          const [cx, cy] = plot.place(cell[0], cell[1]);
          plot.layer.append(make("circle", { class: "dot", cx, cy, r: 4 }, undefined, SVG));
        }
      });
    }
  }

  function moveTo(t) {
    const view = shown || whole;
    // At first the pictures are as they are on paper.
    const isMoved = time !== null;
    time = Math.min(Math.max(t, view[0]), view[1]);
    draw();
    if (isMoved) drawPictures();
  }

  function zoomTo(view) {
    if (view) {
      const span = Math.min(Math.max(view[1] - view[0], (whole[1] - whole[0]) / 200), limits[1] - limits[0]);
      const from = Math.min(Math.max(view[0], limits[0]), limits[1] - span);
      view = [from, from + span];
    }
    shown = view;
    timePlots.forEach((plot) => plot.zoom(view));
    moveTo(time);
  }

  function zoomBy(factor) {
    const view = shown || whole;
    zoomTo([time - (time - view[0]) * factor, time + (view[1] - time) * factor]);
  }

  function keys(event) {
    const view = shown || whole;
    const step = (view[1] - view[0]) / (event.shiftKey ? 20 : 200);
    const actions = {
      ArrowLeft: () => moveTo(time - step), ArrowRight: () => moveTo(time + step),
      Home: () => moveTo(view[0]), End: () => moveTo(view[1]),
      "+": () => zoomBy(0.5), "-": () => zoomBy(2), 0: () => zoomTo(null),
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  }

  function listen(plot) {
    const svg = plot.svg;
    const timeAt = (event) => {
      const box = plot.inside.getBoundingClientRect();
      const area = svg.getBoundingClientRect();
      const scale = area.width / svg.viewBox.baseVal.width;
      const x = (event.clientX - area.left) / scale - plot.left;
      return box && plot.view[0] + x / plot.width * (plot.view[1] - plot.view[0]);
    };
    let start = null;
    svg.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "mouse" && event.button === 0) start = event;
      moveTo(timeAt(event));
    });
    svg.addEventListener("pointermove", (event) => moveTo(timeAt(event)));
    svg.addEventListener("pointerup", (event) => {
      if (start && Math.abs(event.clientX - start.clientX) > 12) {
        zoomTo([timeAt(start), timeAt(event)].sort((a, b) => a - b));
      }
      start = null;
    });
    svg.addEventListener("dblclick", () => zoomTo(null));
    svg.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      moveTo(timeAt(event));
      zoomBy(event.deltaY < 0 ? 0.8 : 1.25);
    }, { passive: false });
  }

  // ---- Downloads.
  function save(name, type, text) {
    const link = make("a", { download: name, href: URL.createObjectURL(new Blob([text], { type })) });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
  const quoted = (text) => `"${text.replace(/"/g, '""')}"`;
  function csv(figure) {
    const lines = ["curve,along,upward,x,y"];
    for (const plot of figure.plots) {
      figure.names.forEach((name, entry) => {
        const start = [name, plot.xTitle, plot.yTitle].map(quoted).join(",");
        for (const [x, y] of plot.curve(entry)) {
          if (Number.isFinite(x)) lines.push(`${start},${Number(x.toPrecision(7))},${Number(y.toPrecision(7))}`);
        }
      });
    }
    return lines.join("\n") + "\n";
  }
  /** The figure as one file: its panels below each other, its names, and its colours as they are on white. */
  function file(figure) {
    const width = 592;
    let height = 40;
    const style = getComputedStyle(document.documentElement);
    const rules = document.getElementById("figure-style").textContent
      .replace(/var\((--[a-z0-9]+)\)/g, (_, name) => style.getPropertyValue(name));
    const svg = make("svg", { xmlns: SVG, class: "file" }, undefined, SVG);
    const title = figure.element.querySelector("h2,h3").textContent;
    svg.append(make("title", {}, title, SVG), make("style", {}, rules, SVG));
    const fill = style.getPropertyValue("--paper");
    svg.append(make("rect", { width: "100%", height: "100%", fill }, undefined, SVG));
    svg.append(make("text", { x: 16, y: 25, "font-weight": 600 }, title, SVG));
    const hidden = figure.boxes.map((box, k) => (box.checked ? null : ".e" + k)).filter(Boolean).join(",");
    for (const plot of figure.plots) {
      const copy = plot.svg.cloneNode(true);
      const size = plot.svg.viewBox.baseVal;
      for (const [name, value] of [["x", 16], ["y", height], ["width", size.width], ["height", size.height]]) {
        copy.setAttribute(name, value);
      }
      if (hidden) copy.querySelectorAll(hidden).forEach((curve) => curve.remove());
      svg.append(copy);
      height += size.height;
    }
    figure.names.forEach((name, entry) => {
      if (!figure.boxes[entry].checked) return;
      const row = make("g", { transform: `translate(16 ${height})` }, undefined, SVG);
      row.append(...figure.boxes[entry].parentNode.querySelector("svg").cloneNode(true).childNodes);
      row.append(make("text", { x: 34, y: 10 }, name, SVG));
      svg.append(row);
      height += 20;
    });
    svg.setAttribute("width", width);
    svg.setAttribute("height", height + 16);
    svg.setAttribute("viewBox", `0 0 ${width} ${height + 16}`);
    return new XMLSerializer().serializeToString(svg);
  }
  function button(text, label, action) {
    const element = make("button", { type: "button", "aria-label": label }, text);
    element.addEventListener("click", action);
    return element;
  }

  // ---- What the page gets.
  overTime.forEach((figure, place) => {
    figure.table = make("table", { class: "values" });
    const [head, body] = [make("thead", {}), make("tbody", {})];
    head.append(make("tr", {}));
    figure.table.append(head, body);
    const bar = make("div", { class: "cursor", role: "group" });
    bar.setAttribute("aria-label", "Cursor and zoom of all figures over time");
    if (place === 0) {
      const controls = make("div", { class: "controls" });
      const label = make("label", {}, "time ");
      label.append(slider);
      controls.append(label, output,
        button("+", "Zoom in at the cursor", () => zoomBy(0.5)), button("−", "Zoom out", () => zoomBy(2)),
        button("all", "Show the whole of the first view", () => zoomTo(null)));
      bar.append(controls);
    }
    bar.append(figure.table);
    const panels = figure.element.querySelector(".panels");
    panels.before(bar);
    panels.tabIndex = 0;
    panels.setAttribute("role", "group");
    panels.setAttribute("aria-label", "Figures: arrow keys move the cursor, + and − zoom, 0 shows all");
    panels.addEventListener("keydown", keys);
    figure.plots.forEach((plot) => {
      plot.layer = make("g", { class: "cursor-marks" }, undefined, SVG);
      plot.svg.append(plot.layer);
      if (plot.isTime) listen(plot);
    });
    figure.boxes.forEach((box) => box.addEventListener("change", draw));
  });
  slider.addEventListener("input", () => {
    const view = shown || whole;
    moveTo(view[0] + slider.value / 1000 * (view[1] - view[0]));
  });
  figures.forEach((figure) => {
    const id = figure.element.id;
    const title = figure.element.querySelector("h2,h3").textContent;
    const line = make("p", { class: "downloads" }, "Download: ");
    line.append(
      button("SVG", `Download the figure “${title}” as SVG`, () => save(`${id}.svg`, "image/svg+xml", file(figure))),
      button("CSV", `Download the curves of “${title}” as CSV`, () => save(`${id}.csv`, "text/csv", csv(figure))));
    figure.element.append(line);
  });
  const summary = document.getElementById("summary-data");
  if (summary) {
    const line = make("p", { class: "downloads" }, "Download: ");
    line.append(button("summary.json", "Download the summary as JSON",
      async () => {
        const packed = Uint8Array.from(atob(summary.textContent), (c) => c.charCodeAt(0));
        const json = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
        save("summary.json", "application/json", await new Response(json).text());
      }));
    document.querySelector("main").append(line);
  }
  if (timePlots.length) {
    const mark = timePlots[0].svg.querySelector("text[data-at]");
    moveTo(mark ? Number(mark.dataset.at) : (whole[0] + whole[1]) / 2);
  }

  // What is folded is opened on paper, but for a report, whose details stay on the screen.
  let opened = [];
  if (document.getElementById("details")) { return; }
  window.addEventListener("beforeprint", () => {
    opened = Array.from(document.querySelectorAll("details:not([open])"));
    opened.forEach((details) => { details.open = true; });
  });
  window.addEventListener("afterprint", () => opened.forEach((details) => { details.open = false; }));
})();
