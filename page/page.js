"use strict";
// The page: takes records, asks for what they lack, runs the chain in the worker, shows the report.

const element = (id) => document.getElementById(id);
const text = (id) => element(id).textContent;
const html = document.documentElement;
const STEM = /\.[^.]*$/;
// Endings of the file that stands for a record of several files.
const MAIN = /\.(ev5|mme|tdm)$/i;
// The usual settings, by stage and key; the program says what each takes.
const USUAL = [["ingest", "mass", "Mass of the vehicle"], ["ingest", "impact_speed", "Impact speed"], ["ingest", "channel", "Channel of the pulse"],
  ["ingest", "unit", "Unit of acceleration"], ["ingest", "time_zero", "Time of first contact"], ["filter", "cfc", "Filter class"], ["parameter-solve", "models", "Models"],
  ["report", "display", "Units of the report"]];
// What a record may lack: its fields stand open, and the answer follows them.
const LACKED = ["mass", "impact_speed"];

// One line a stage: what it reads, what it writes.
const chain = text("chain").split("\n").filter((line) => line && !line.startsWith("#")).map((line) => {
  const [left, right] = line.split("->").map((side) => side.trim().split(/\s+/));
  return { name: left[0].replace("?", ""), optional: left[0].endsWith("?"), inputs: left.slice(1), outputs: right };
});

let worker;
let pending = new Map();
let number = 0;
let record;
let results;
let clock;
// Fields of the form, and the flags that they come to, by stage.
let fields = [];
let flags = {};
let answering = false;

function show(state, message = "") {
  html.dataset.state = state;
  if (state === "asking" || state === "done") element(state === "asking" ? "asked" : "settings").append(element("form"));
  element("status").textContent = message;
  clearInterval(clock);
}

// Calls a function of the worker.
const call = (name, args = {}) => new Promise((resolve, reject) => {
  pending.set(++number, { resolve, reject });
  worker.postMessage({ id: number, name, args });
});

function start() {
  worker?.terminate();
  pending = new Map();
  worker = new Worker(URL.createObjectURL(new Blob([text("worker")], { type: "text/javascript" })));
  worker.onmessage = ({ data: { id, answer, error } }) => {
    const waiting = pending.get(id);
    pending.delete(id);
    if (error) waiting?.reject(new Error(error));
    else waiting?.resolve(answer);
  };
  return call("start", { packed: text("module") });
}

const readText = async (path) => new TextDecoder().decode(await call("read", { path }));
// Objects that stand one a line.
const objects = (lines) => lines.trim().split("\n").map((one) => JSON.parse(one));

class Refusal extends Error {}

// Runs a command of the program; exit code 4 is a result: the report shows the diagnosis.
async function run(words) {
  const ended = await call("run", { words });
  if (ended.fault) {
    const last = ended.err.trim().split("\n").slice(-3).join("\n");
    throw new Refusal(`The program ended unforeseen: ${ended.fault}\n${last}\nThis is a fault of Crumple, please report it.`);
  }
  if (![0, 4].includes(ended.code)) throw new Refusal(ended.err);
  return ended;
}

// The words of a failure; anything but a refusal is a fault of the page.
function refuse(error) {
  const told = error instanceof Refusal ? error.message : `${error}\nThis is a fault of Crumple, please report it.`;
  const [first, ...rest] = told.trim().split("\n");
  element("refusal").replaceChildren(line("strong", first), rest.join("\n"));
  show("refused", first);
}

function line(tag, content) {
  const made = document.createElement(tag);
  made.textContent = content + "\n";
  return made;
}

// Files of a dropped folder with their paths; it hands out its entries a hundred at a time.
async function entriesOf(entry, path = "") {
  if (entry.isFile) return [[path + entry.name, await new Promise((resolve, reject) => entry.file(resolve, reject))]];
  const reader = entry.createReader();
  const files = [];
  for (;;) {
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    if (!some.length) return files;
    for (const one of some) files.push(...(await entriesOf(one, `${path}${entry.name}/`)));
  }
}

// The same by the handle of a folder: Chromium hands out no entries in a page from a disk.
async function filesOf(handle, path = "") {
  if (handle.kind === "file") return [[path + handle.name, await handle.getFile()]];
  const files = [];
  for await (const one of handle.values()) files.push(...(await filesOf(one, `${path}${handle.name}/`)));
  return files;
}

// The records among the files: a folder, a main file with what lies beside it, or every file by itself.
function recordsOf(files) {
  const folder = files.find(([path]) => path.includes("/"));
  const main = files.find(([path]) => MAIN.test(path));
  if (folder) return [{ path: folder[0].split("/")[0], files }];
  if (main) return [{ path: main[0], files }];
  const sidecars = new Set(files.map(([path]) => `${path}.toml`));
  const mains = files.filter(([path]) => !sidecars.has(path));
  return mains.map(([path]) => ({ path, files: files.filter(([other]) => other === path || other === `${path}.toml`) }));
}

async function take(files) {
  const records = recordsOf(files);
  if (!records.length || ["loading", "running"].includes(html.dataset.state)) return;
  try {
    await call("clear");
    await writePipeline();
    for (const { files } of records) {
      for (const [path, file] of files) await call("write", { path: path, bytes: await file.arrayBuffer(), readOnly: true });
    }
    if (records.length === 1) await open(records[0].path);
    else await compare(records.map(({ path }) => path));
  } catch (error) {
    refuse(error);
  }
}

// An edited pipeline has a name of its own.
const pipeline = () => `pipelines/${element("pipeline").value === element("pipeline").defaultValue ? "default" : "edited"}.toml`;
const writePipeline = () => call("write", { path: pipeline(), bytes: element("pipeline").value });
const folderOf = (path) => `runs/${path.replace(STEM, "")}/default`;
const name = () => record.path.replace(STEM, "");

// Reads a record, and asks for what it lacks.
async function open(path) {
  record = { path };
  for (const { stage, input } of fields) if (stage === "ingest") input.value = "";
  flags.ingest = [];
  element("channel").replaceChildren();
  const warnings = await ingest();
  const lacks = { mass: record.test.mass_kg == null, "impact-speed": record.test.impact_speed_m_per_s == null };
  const asked = warnings.filter(({ about }) => lacks[about]).map(({ about }) => about.replace("-", "_"));
  if (!asked.length) return runChain();
  ask([...asked, "channel"]);
  show("asking", `${path}: state what the record lacks`);
}

// Makes the fields of the usual settings from the options of the program.
async function makeFields() {
  const known = {};
  for (const [stage] of USUAL) known[stage] ??= objects((await run([stage, "--generate", "options"])).out);
  fields = USUAL.map(([stage, key, name]) => {
    const { flag, about, values, many } = known[stage].find((option) => option.key === key);
    const input = document.createElement(values.length || key === "channel" ? "select" : "input");
    const [label, output, place] = [line("label", name), line("output", ""), line("p", "")];
    Object.assign(input, { id: key, name: key, multiple: many, autocomplete: "off" }, many && { size: values.length });
    input.append(...(many || !values.length ? [] : [new Option("")]), ...values.map((value) => new Option(value)));
    input.setAttribute("aria-describedby", `${key}-about ${key}-error`);
    Object.assign(output, { id: `${key}-error` });
    label.htmlFor = output.htmlFor = key;
    place.replaceChildren(label, input, Object.assign(line("small", about), { id: `${key}-about` }), output);
    element("fields").append(place);
    if (LACKED.includes(key)) input.addEventListener("change", () => html.dataset.state === "done" && element("form").requestSubmit());
    return { stage, flag, input, output, place };
  });
}

// Shows the fields of these settings; the channel where there is a choice.
function ask(keys) {
  for (const { input, place } of fields) place.hidden = !keys.includes(input.id) || (input.id === "channel" && input.options.length < 2);
}

// Runs ingest with the flags of the form, and shows what it read.
async function ingest() {
  const to = `${folderOf(record.path)}/1-ingest.mcap`;
  await call("write", { path: `${folderOf(record.path)}/.made`, bytes: "" });
  const { out, err } = await run(["ingest", record.path, "-o", to, "--pipeline", pipeline(), "--json", ...flags.ingest]);
  const records = objects(out);
  const of = (topic) => records.find((one) => one.topic === topic)?.data;
  record.test = of("/test");
  element("read").textContent = err;
  await showPulse(to);
  return (of("/remarks")?.remarks ?? []).filter(({ weight }) => weight > 0);
}

// Draws the pulse, and lists the channels that may stand in its place.
async function showPulse(artifact) {
  await run(["artifact", "unpack", artifact, "tmp/waves", "--force"]);
  const waves = objects(await readText("tmp/waves/waves.ndjson"));
  const wave = waves.find(({ id }) => id === record.test.pulse);
  const channels = waves.filter(({ quantity }) => quantity === "acceleration").map(({ id }) => new Option(id, id, id === wave?.id, id === wave?.id));
  if (!element("channel").options.length) element("channel").replaceChildren(...channels);
  element("pulse").setAttribute("hidden", "");
  if (!wave) return;
  const samples = new Float64Array((await call("read", { path: `tmp/waves/${wave.file}` })).buffer);
  const step = Math.max(1, Math.ceil(samples.length / 600));
  const columns = Array.from({ length: Math.ceil(samples.length / step) }, (_, k) => samples.subarray(k * step, (k + 1) * step));
  const [low, high] = [Math.min(...columns.map((c) => Math.min(...c))), Math.max(...columns.map((c) => Math.max(...c)))];
  const y = (value) => 98 - (96 * (value - low)) / (high - low || 1);
  const points = columns.flatMap((c, k) => [Math.min(...c), Math.max(...c)].map((value) => `${((300 * k) / columns.length).toFixed(1)},${y(value).toFixed(1)}`));
  element("curve").setAttribute("points", points.join(" "));
  element("pulse").removeAttribute("hidden");
}

// Runs with the fields as they are; each value is checked by the program, its words stand at the field.
async function answer(event) {
  event.preventDefault();
  // A field that is left by Enter changes and submits.
  if (answering) return;
  answering = true;
  await answerOnce().finally(() => (answering = false));
}

async function answerOnce() {
  const asked = fields.filter(({ place, output }) => ((output.textContent = ""), !place.hidden));
  const wrong = [];
  const typed = { ingest: [] };
  for (const { stage, flag, input, output } of asked) {
    const value = input.multiple ? [...input.selectedOptions].map((option) => option.value).join() : input.value.trim();
    if (!value || input.selectedOptions?.[0]?.defaultSelected) continue;
    const { code, err } = await call("run", { words: [stage, record.path, "-o", "tmp/x.mcap", "--check-options", flag, value] });
    if (code) output.textContent = err.trim().split("\n")[0];
    if (code) wrong.push(input);
    (typed[stage] ??= []).push(flag, value);
  }
  if (wrong.length) return wrong[0].focus();
  flags = { ...(html.dataset.state === "asking" && flags), ...typed };
  try {
    await writePipeline();
    await ingest();
    await runChain();
  } catch (error) {
    refuse(error);
  }
}

// Runs the stages behind ingest, then shows the report.
async function runChain() {
  await stages();
  showReport(`${folderOf(record.path)}/report.html`);
}

async function stages() {
  const folder = folderOf(record.path);
  const settings = element("pipeline").value;
  const used = chain.filter(({ name, optional }) => !optional || new RegExp(`^\\[${name}\\]`, "m").test(settings));
  const made = new Set(used.flatMap(({ outputs }) => outputs));
  element("steps").replaceChildren(...used.map(({ name }) => line("li", name)));
  show("running", record.path);
  const begun = performance.now();
  const tick = () => (element("elapsed").textContent = `${record.path}, ${((performance.now() - begun) / 1000).toFixed(1)} s`);
  clock = setInterval(tick, 100);
  tick();
  for (const [k, { name, inputs, outputs }] of used.entries()) {
    const step = element("steps").children[k];
    step.setAttribute("aria-current", "step");
    if (inputs[0] !== "RECORD") {
      const paths = inputs.filter((input) => made.has(input)).map((input) => `${folder}/${input}`);
      const quiet = name === "report" ? [] : ["--no-summary"];
      await run([name, ...paths, "-o", `${folder}/${outputs[0]}`, "--pipeline", pipeline(), ...(flags[name] ?? []), ...quiet]);
    }
    step.removeAttribute("aria-current");
    step.className = "over";
  }
}

// Several records: every one by itself, then one page of them all.
async function compare(paths) {
  for (const path of paths) {
    record = { path };
    flags.ingest = [];
    await ingest();
    await stages();
  }
  await run(["compare", ...paths.map(folderOf), "-o", "runs/compare.html"]);
  record = { path: paths.map((path) => path.replace(STEM, "")).join("-and-"), folders: paths.map(folderOf) };
  await showReport("runs/compare.html");
}

async function showReport(path) {
  const folders = record.folders ?? [folderOf(record.path)];
  results = [];
  for (const folder of folders) {
    const files = (await call("list", { path: folder })).filter(([name]) => !name.startsWith("."));
    results.push(...files.map(([name, bytes]) => [`${folder.slice("runs/".length)}/${name}`, bytes]));
  }
  record.report = await readText(path);
  const summary = record.folders ? undefined : JSON.parse(await readText(`${folders[0]}/summary.json`));
  const verdict = summary ? [summary.verdict.status_sentence, ...summary.verdict.sentences.slice(0, 1)] : [];
  element("verdict").textContent = verdict.filter(Boolean).join(" ");
  element("title").textContent = summary?.test.title ?? name();
  element("frame").srcdoc = record.report;
  if (history.state !== "done") history.pushState("done", "");
  ask(USUAL.map(([, key]) => key));
  element("settings").hidden = Boolean(record.folders);
  const { mass_kg: mass, impact_speed_m_per_s: speed } = record.test ?? {};
  element("settings").open = !record.folders && (mass == null || speed == null);
  show("done", `${record.path}: done`);
}

// Takes what is dropped on the page or the report; without this the browser would leave them for the file.
function takeDrops(window) {
  for (const [event, over] of [["dragenter", true], ["dragover", true], ["dragleave", false], ["drop", false]]) {
    window.addEventListener(event, (dragged) => {
      dragged.preventDefault();
      html.classList.toggle("over", over);
    });
  }
  window.addEventListener("drop", ({ dataTransfer }) => {
    const read = [...dataTransfer.items].map((item) => {
      const [entry, file] = [item.webkitGetAsEntry(), item.getAsFile()];
      if (!entry?.isDirectory) return [[file.name, file]];
      return item.getAsFileSystemHandle?.().then((handle) => filesOf(handle)) ?? entriesOf(entry);
    });
    const unread = () => refuse(new Refusal("The browser does not hand out this folder.\nChoose it with Choose a folder."));
    Promise.all(read).then((files) => take(files.flat()), unread);
  });
}

// The report as high as it is, also where a part of it is opened.
function fit() {
  const inside = element("frame").contentDocument;
  if (!inside?.body) return;
  takeDrops(element("frame").contentWindow);
  inside.documentElement.style.overflowY = "hidden";
  const size = () => (element("frame").style.height = `${Math.max(inside.documentElement.offsetHeight, inside.body.scrollHeight)}px`);
  new ResizeObserver(size).observe(inside.documentElement);
  size();
}

function save(file, parts, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(parts, { type }));
  link.download = file;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const CRC = Uint32Array.from({ length: 256 }, (_, n) => Array.from({ length: 8 }).reduce((c) => (c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1), n));

// A zip archive without compression: artifacts hardly compress.
function zip(files) {
  const [parts, directory] = [[], []];
  let at = 0;
  let length = 0;
  const header = (size, numbers) => {
    const view = new DataView(new ArrayBuffer(size));
    for (const [place, bits, value] of numbers) view[`setUint${bits}`](place, value, true);
    return view.buffer;
  };
  for (const [path, bytes] of files) {
    const named = new TextEncoder().encode(path);
    let crc = -1;
    for (const byte of bytes) crc = CRC[(crc ^ byte) & 255] ^ (crc >>> 8);
    // Version 2.0, names in UTF-8, stored, 1 January 1980.
    const common = (start) => [[start, 16, 20], [start + 2, 16, 0x800], [start + 8, 16, 0x21], [start + 10, 32, ~crc >>> 0],
      [start + 14, 32, bytes.length], [start + 18, 32, bytes.length], [start + 22, 16, named.length]];
    parts.push(header(30, [[0, 32, 0x04034b50], ...common(4)]), named, bytes);
    directory.push(header(46, [[0, 32, 0x02014b50], [4, 16, 20], ...common(6), [42, 32, at]]), named);
    at += 30 + named.length + bytes.length;
    length += 46 + named.length;
  }
  const end = [[0, 32, 0x06054b50], [8, 16, files.length], [10, 16, files.length], [12, 32, length], [16, 32, at]];
  return [...parts, ...directory, header(22, end)];
}

function again() {
  element("file").value = element("folder").value = "";
  show("ready");
  element("file").focus();
}

async function stop() {
  show("loading");
  await start();
  again();
}

const example = () => take([["example.csv", new Blob([text("example")])]]);
const on = (id, event, act) => element(id).addEventListener(event, act);

on("file", "change", ({ target }) => take([...target.files].map((file) => [file.name, file])));
on("folder", "change", ({ target }) => take([...target.files].map((file) => [file.webkitRelativePath, file])));
on("example-button", "click", example);
on("form", "submit", answer);
on("without", "click", () => runChain().catch(refuse));
on("stop", "click", stop);
on("frame", "load", fit);
on("save-report", "click", () => save(`${name()}-report.html`, [record.report], "text/html"));
on("save-results", "click", () => save(`${name()}-results.zip`, zip(results), "application/zip"));
for (const button of document.querySelectorAll(".another")) button.addEventListener("click", again);
takeDrops(window);
addEventListener("popstate", ({ state }) => show(state === "done" ? "done" : "ready"));

if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined") {
  element("loading").textContent = "This browser cannot run Crumple: it lacks WebAssembly or DecompressionStream. Use one of 2023 or later.";
} else {
  start().then(makeFields).then(() => run(["--version"])).then(({ out }) => {
    element("version").textContent = `${out.trim()}, `;
    show("ready");
  }, refuse);
}
