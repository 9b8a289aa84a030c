"use strict";
// The program in a worker: WASI preview 1 over a tree of files in memory, and calls from the page.

const OK = 0, BADF = 8, EXIST = 20, INVAL = 28, ISDIR = 31, NOENT = 44, NOSYS = 52, NOTDIR = 54, NOTEMPTY = 55, ROFS = 69, SPIPE = 70;
const DEVICE = 2, FOLDER = 3, FILE = 4;
let numbers = 1;

class Folder {
  kind = FOLDER;
  number = numbers++;
  entries = new Map();
}

class File {
  kind = FILE;
  number = numbers++;
  constructor(bytes = new Uint8Array(), readOnly = false) {
    Object.assign(this, { bytes, size: bytes.length, readOnly });
  }
  content() {
    return this.bytes.subarray(0, this.size);
  }
  resize(size) {
    if (size > this.bytes.length) {
      const grown = new Uint8Array(Math.max(size, 2 * this.bytes.length, 4096));
      grown.set(this.content());
      this.bytes = grown;
    }
    this.bytes.fill(0, size, Math.max(size, this.size));
    this.size = size;
  }
  write(at, piece) {
    if (at + piece.length > this.size) this.resize(at + piece.length);
    this.bytes.set(piece, at);
  }
}

// Standard output and error.
class Said {
  kind = DEVICE;
  number = 0;
  pieces = [];
  size = 0;
  write(_, piece) {
    this.pieces.push(piece.slice());
  }
  text() {
    const decoder = new TextDecoder();
    return this.pieces.map((piece) => decoder.decode(piece, { stream: true })).join("") + decoder.decode();
  }
}

// The node at a path, the folder it lies in and its name there.
function find(folder, path) {
  let [node, parents, name] = [folder, [], ""];
  for (name of path.split("/").filter((part) => part && part !== ".")) {
    if (name === "..") node = parents.pop() ?? folder;
    else {
      if (node?.kind !== FOLDER) return { error: node ? NOTDIR : NOENT };
      parents.push(node);
      node = node.entries.get(name);
    }
  }
  return { node, parent: parents.at(-1), name };
}

class Exit extends Error {
  constructor(code) {
    super();
    this.code = code;
  }
}

// The functions of WASI for one program: its words, its environment, its files.
function system(root, words, environment) {
  const open = [{ node: new Said() }, { node: new Said() }, { node: new Said() }, { node: root }];
  const encoder = new TextEncoder();
  let memory;
  const view = () => new DataView(memory.buffer);
  const bytes = (at, length) => new Uint8Array(memory.buffer, at, length);
  const path = (at, length) => new TextDecoder().decode(bytes(at, length));
  const set32 = (at, value) => (view().setUint32(at, value, true), OK);
  const set64 = (at, value) => (view().setBigUint64(at, BigInt(value), true), OK);
  const now = () => BigInt(Math.round((performance.timeOrigin + performance.now()) * 1e6));
  const texts = (list) => list.map((text) => encoder.encode(text + "\0"));
  const sizes = (list) => (count, size) =>
    set32(count, list.length) || set32(size, texts(list).reduce((sum, text) => sum + text.length, 0));
  const put = (list) => (places, at) => {
    for (const text of texts(list)) {
      set32(places, at);
      bytes(at, text.length).set(text);
      [places, at] = [places + 4, at + text.length];
    }
    return OK;
  };
  const stat = (node, at) => {
    bytes(at, 64).fill(0);
    set64(at + 8, node.number);
    view().setUint8(at + 16, node.kind);
    set64(at + 24, 1);
    return set64(at + 32, node.size ?? 0);
  };
  // Each piece of a list of buffers; ends early where one was not filled.
  const pieces = (list, count, each) => {
    let total = 0;
    for (let k = 0; k < count; k++) {
      const length = view().getUint32(list + 8 * k + 4, true);
      const done = each(bytes(view().getUint32(list + 8 * k, true), length), total);
      total += done;
      if (done < length) break;
    }
    return total;
  };
  const read = (fd, list, count, at, size) => {
    const node = open[fd]?.node;
    if (!node?.content) return node?.kind === FOLDER ? ISDIR : node ? set32(size, 0) : BADF;
    const total = pieces(list, count, (buffer, before) => {
      const piece = node.content().subarray(at + before, at + before + buffer.length);
      buffer.set(piece);
      return piece.length;
    });
    if (at === open[fd].at) open[fd].at += total;
    return set32(size, total);
  };
  const write = (fd, list, count, at, size) => {
    const node = open[fd]?.node;
    if (!node?.write) return BADF;
    const total = pieces(list, count, (buffer, before) => (node.write(at + before, buffer), buffer.length));
    if (at === open[fd].at) open[fd].at += total;
    return set32(size, total);
  };
  const remove = (kind) => (_, at, length) => {
    const { node, parent, name } = find(root, path(at, length));
    if (!node) return NOENT;
    if (node.kind !== kind) return kind === FOLDER ? NOTDIR : ISDIR;
    if (node.entries?.size) return NOTEMPTY;
    parent.entries.delete(name);
    return OK;
  };
  const nothing = () => OK;
  const wasi = {
    args_sizes_get: sizes(words),
    args_get: put(words),
    environ_sizes_get: sizes(environment),
    environ_get: put(environment),
    clock_time_get: (_, precision, at) => set64(at, now()),
    clock_res_get: (_, at) => set64(at, 1000),
    random_get: (at, length) => {
      for (let k = 0; k < length; k += 65536) crypto.getRandomValues(bytes(at + k, Math.min(65536, length - k)));
      return OK;
    },
    proc_exit: (code) => {
      throw new Exit(code);
    },
    sched_yield: nothing,
    fd_advise: nothing,
    fd_datasync: nothing,
    fd_sync: nothing,
    fd_fdstat_set_flags: nothing,
    fd_filestat_set_times: nothing,
    path_filestat_set_times: nothing,
    fd_close: (fd) => (open[fd] ? (delete open[fd], OK) : BADF),
    fd_prestat_get: (fd, at) => (fd === 3 ? set32(at, 0) || set32(at + 4, 1) : BADF),
    fd_prestat_dir_name: (_, at) => (bytes(at, 1).set([47]), OK),
    fd_fdstat_get: (fd, at) => {
      if (!open[fd]) return BADF;
      bytes(at, 24).fill(0);
      view().setUint8(at, open[fd].node.kind);
      return set64(at + 8, (1n << 30n) - 1n) || set64(at + 16, (1n << 30n) - 1n);
    },
    fd_filestat_get: (fd, at) => (open[fd] ? stat(open[fd].node, at) : BADF),
    fd_filestat_set_size: (fd, size) => (open[fd]?.node.resize ? (open[fd].node.resize(Number(size)), OK) : BADF),
    fd_read: (fd, list, count, size) => read(fd, list, count, open[fd]?.at, size),
    fd_pread: (fd, list, count, at, size) => read(fd, list, count, Number(at), size),
    fd_write: (fd, list, count, size) => write(fd, list, count, open[fd]?.at ?? 0, size),
    fd_pwrite: (fd, list, count, at, size) => write(fd, list, count, Number(at), size),
    fd_tell: (fd, at) => set64(at, open[fd].at),
    fd_seek: (fd, by, from, at) => {
      const file = open[fd];
      if (!file || file.node.kind === FOLDER) return BADF;
      if (file.node.kind === DEVICE) return SPIPE;
      const place = [0, file.at, file.node.size][from] + Number(by);
      if (!(place >= 0)) return INVAL;
      file.at = place;
      return set64(at, place);
    },
    fd_readdir: (fd, at, length, cookie, used) => {
      if (open[fd]?.node.kind !== FOLDER) return NOTDIR;
      const end = at + length;
      const start = at;
      for (const [k, [name, node]] of [...open[fd].node.entries].entries()) {
        if (k < Number(cookie) || at >= end) continue;
        const text = encoder.encode(name);
        const entry = new DataView(new ArrayBuffer(24));
        entry.setBigUint64(0, BigInt(k + 1), true);
        entry.setBigUint64(8, BigInt(node.number), true);
        entry.setUint32(16, text.length, true);
        entry.setUint8(20, node.kind);
        for (const part of [new Uint8Array(entry.buffer), text]) {
          const fits = part.subarray(0, end - at);
          bytes(at, fits.length).set(fits);
          at += fits.length;
        }
      }
      return set32(used, at - start);
    },
    path_open: (fd, _, at, length, how, rights, inherited, flags, opened) => {
      let { node, parent, name, error } = find(open[fd]?.node ?? root, path(at, length));
      if (error) return error;
      const [makes, folder, fresh, empties] = [1, 2, 4, 8].map((bit) => how & bit);
      if (node && makes && fresh) return EXIST;
      if (node && folder && node.kind !== FOLDER) return NOTDIR;
      if (node?.readOnly && (empties || rights & 64n)) return ROFS;
      if (!node) {
        if (!makes || !parent) return NOENT;
        parent.entries.set(name, (node = new File()));
      }
      if (empties && node.kind === FILE) node.resize(0);
      return set32(opened, open.push({ node, at: flags & 1 ? node.size : 0 }) - 1);
    },
    path_filestat_get: (_, how, at, length, to) => {
      const { node, error } = find(root, path(at, length));
      return node ? stat(node, to) : (error ?? NOENT);
    },
    path_create_directory: (_, at, length) => {
      const { node, parent, name, error } = find(root, path(at, length));
      if (node || error || !parent) return node ? EXIST : (error ?? NOENT);
      parent.entries.set(name, new Folder());
      return OK;
    },
    path_unlink_file: remove(FILE),
    path_remove_directory: remove(FOLDER),
    path_rename: (_, at, length, __, to, toLength) => {
      const [old, next] = [find(root, path(at, length)), find(root, path(to, toLength))];
      if (!old.node || !next.parent) return NOENT;
      old.parent.entries.delete(old.name);
      next.parent.entries.set(next.name, old.node);
      return OK;
    },
  };
  const absent = { get: (known, name) => known[name] ?? (() => NOSYS) };
  return {
    imports: new Proxy({}, { get: () => new Proxy(wasi, absent) }),
    start: (instance) => ((memory = instance.exports.memory), instance.exports._start()),
    said: (fd) => open[fd]?.node.text() ?? "",
  };
}

let module;
let root = new Folder();

const calls = {
  async start({ packed }) {
    const text = atob(packed);
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const type = { headers: { "Content-Type": "application/wasm" } };
    module = await WebAssembly.compileStreaming(new Response(stream, type));
  },
  // Empties the disk.
  clear() {
    root = new Folder();
    root.entries.set("tmp", new Folder());
  },
  write({ path, bytes, readOnly }) {
    let folder = root;
    const parts = path.split("/");
    for (const name of parts.slice(0, -1)) {
      if (!folder.entries.has(name)) folder.entries.set(name, new Folder());
      folder = folder.entries.get(name);
    }
    const content = typeof bytes === "string" ? new TextEncoder().encode(bytes) : new Uint8Array(bytes);
    folder.entries.set(parts.at(-1), new File(content, readOnly));
  },
  read({ path }) {
    return find(root, path).node?.content().slice();
  },
  // Names and contents of the files in a folder.
  list({ path }) {
    const entries = [...(find(root, path).node?.entries ?? [])].filter(([, node]) => node.kind === FILE);
    return entries.map(([name, node]) => [name, node.content().slice()]);
  },
  async run({ words }) {
    const wasi = system(root, ["crumple", ...words], ["TMPDIR=/tmp"]);
    let [code, fault] = [0, ""];
    try {
      wasi.start(await WebAssembly.instantiate(module, wasi.imports));
    } catch (error) {
      if (error instanceof Exit) code = error.code;
      else [code, fault] = [1, `${error}`];
    }
    return { code, fault, out: wasi.said(1), err: wasi.said(2) };
  },
};

onmessage = async ({ data: { id, name, args } }) => {
  try {
    postMessage({ id, answer: await calls[name](args) });
  } catch (error) {
    postMessage({ id, error: `${error}` });
  }
};
