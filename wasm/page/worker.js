// worker.js - the engine in a worker: its few functions of a system (host.h), the
// files that it may read, and the loop that draws while nothing else comes.
//
// From the page: {t: 'open', wasm, files: [{name, bytes or file}], path, recipe}, where
// the files may be those of a server (remote.js): [{base, query, path}];
// then {t: 'hear', text} and {t: 'painted'}.  To the page: texts, pictures as
// ArrayBuffers (serve/message.h), {t: 'refused', text}, {t: 'fetched', files, bytes}, and,
// where pages may share memory, {t: 'help', ...} for each thread: the page hands it to one
// more worker.  page.cmake puts remote.js before this.
'use strict';

const far = typeof module === 'undefined' ? {Remote, FAR} : require('./remote.js');

const UNDER_WAY = 2; // pictures that the page has not painted yet
const MEMORY = {initial: 256, maximum: 32768}; // as the engine declares it
const THREADS_MOST = 16;
const WHOLE = 1 << 20; // bytes of a file that is read at once,
const AHEAD = 1 << 16; // of a larger one,
const KEPT = 1 << 28; // and of all that is kept until the volume is open
const FETCHED_MOST = 1 << 28; // bytes of voxels that are fetched where a coarser level is there
const SELDOM = 100; // ms between two lines about what is fetched

/** The files by their paths, and what the engine asks of them. */
class Files {
    constructor(list, onFetch) {
        this.list = list;
        this.remote = list[0]?.base ? new far.Remote(list[0], onFetch) : null;
        this.numbers = new Map(list.map(({name}, i) => [name, i]));
        this.reader = typeof FileReaderSync === 'undefined' ? null : new FileReaderSync();
        this.folders = new Map(); // the names in each
        this.forget();
    }

    forget() {
        this.ahead = new Map(); // of files, the last bytes that were read, the oldest first
        this.room = KEPT;
    }

    static plain(path) {
        return path.split('/').filter(part => part && part !== '.').join('/');
    }

    find(path) {
        const name = Files.plain(path);
        const within = `${name}/`;
        if (this.remote)
            return this.remote.find(name);
        return this.numbers.get(name) ?? (!name || this.list.some(each => each.name.startsWith(within)) ? -2 : -1);
    }

    /** Names in a folder, each once. */
    entries(path) {
        const name = Files.plain(path), begin = name ? `${name}/` : '';
        if (this.remote)
            return this.remote.entries(name);
        if (!this.folders.has(name))
            this.folders.set(name, [...new Set(this.list.filter(each => each.name.startsWith(begin))
                .map(each => each.name.slice(begin.length).split('/')[0]))]);
        return this.folders.get(name);
    }

    size(i) {
        if (i >= far.FAR)
            return this.remote.size(i);
        return this.list[i].bytes?.byteLength ?? this.list[i].file.size;
    }

    /** A browser takes a millisecond for each reading: so more is read than is asked for, of a
     * small file all, as the next reading mostly goes on there. */
    read(i, at, size) {
        if (i >= far.FAR)
            return this.remote.read(i, at, size);
        const {bytes, file} = this.list[i];
        if (bytes)
            return new Uint8Array(bytes, at, size);
        let last = this.ahead.get(i);
        if (!last || at < last.at || at + size > last.at + last.bytes.byteLength) {
            const small = file.size <= WHOLE, from = small ? 0 : at;
            last = {at: from, bytes: this.reader.readAsArrayBuffer(
                file.slice(from, small ? file.size : at + Math.max(size, AHEAD)))};
            this.keep(i, last);
        }
        return new Uint8Array(last.bytes, at - last.at, size);
    }

    keep(i, read) {
        const drop = which => {
            this.room += this.ahead.get(which)?.bytes.byteLength ?? 0;
            this.ahead.delete(which);
        };
        drop(i);
        if (read.bytes.byteLength > WHOLE)
            return;
        this.ahead.set(i, read);
        this.room -= read.bytes.byteLength;
        while (this.room < 0)
            drop(this.ahead.keys().next().value);
    }
}

/** What the engine imports.  `of` has its memory, and its exports once they are there. */
function host(of, files) {
    const bytes = () => new Uint8Array(of.memory.buffer);
    const text = at => {
        const all = bytes();
        return new TextDecoder().decode(all.slice(at, all.indexOf(0, at)));
    };
    const put = (words, to, size) => {
        const encoded = new TextEncoder().encode(words).slice(0, size - 1);
        bytes().set(encoded, to);
        bytes()[to + encoded.length] = 0;
    };
    /** What `act` returns, or `failed`: why stands in `fault` then. */
    let fault = '';
    const tried = (failed, act) => {
        try {
            return act();
        } catch (error) {
            fault = error.name === 'NotReadableError' || error.name === 'NotFoundError'
                ? 'it was changed or removed since it was chosen; choose it again' : error.message;
            return failed;
        }
    };
    const env = {
        host_find: path => tried(-3, () => files.find(text(path))),
        host_size: file => files.size(file),
        host_read: (file, at, to, size) => tried(0, () => {
            bytes().set(files.read(file, at, size), to);
            return 1;
        }),
        host_name: (folder, index, to, size) => tried(-1, () => {
            const name = files.entries(text(folder))[index];
            if (name !== undefined)
                put(name, to, size);
            return name === undefined ? 0 : 1;
        }),
        host_fault: (to, size) => put(fault, to, size),
        emscripten_notify_memory_growth() {},
        getTempRet0: () => of.high ?? 0,
        setTempRet0(value) {
            of.high = value;
        },
        _emscripten_throw_longjmp() {
            throw Infinity;
        }};
    const wasi = {
        clock_time_get(clock, precision, to) {
            const now = clock ? performance.timeOrigin + performance.now() : Date.now();
            new DataView(of.memory.buffer).setBigUint64(to, BigInt(Math.round(1e6 * now)), true);
            return 0;
        },
        proc_exit(code) {
            throw new Error(`the engine ended with ${code}`);
        }};
    /** A call that longjmp may leave. */
    const invoke = (index, ...words) => {
        const stack = of.exports.stackSave();
        try {
            return of.table.get(index)(...words);
        } catch (error) {
            of.exports.stackRestore(stack);
            if (error !== Infinity)
                throw error;
            of.exports.setThrew(1, 0);
            return 0;
        }
    };
    // What else the library could call: the system's, of other processes.
    const others = {get(known, name) {
        if (name in known)
            return known[name];
        if (name.startsWith('invoke_'))
            return invoke;
        if (/^(__syscall_|fd_|environ_)/.test(name))
            return () => -52; // ENOSYS
        return () => {
            throw new Error(`${name} is not in the engine`);
        };
    }};
    return {env: new Proxy(env, others), wasi_snapshot_preview1: new Proxy(wasi, others)};
}

/** The engine for a page that cannot share memory: the flags of its memory, which
 * follow its name and its kind, say so. */
function unshared(wasm) {
    const bytes = new Uint8Array(wasm).slice();
    const head = String.fromCharCode(...bytes.subarray(0, 1 << 14));
    bytes[head.indexOf('\x06memory\x02\x03') + 8] = 1;
    return bytes;
}

/** Memory, which threads share where that is asked for and a browser has room for all
 * that it may grow to. */
function room(share) {
    try {
        return new WebAssembly.Memory({...MEMORY, shared: !!share});
    } catch {
        return new WebAssembly.Memory(MEMORY);
    }
}

/** The same files, whose bytes all threads have. */
function shared(list) {
    return list.map(each => {
        const copy = each.bytes && new SharedArrayBuffer(each.bytes.byteLength);
        if (copy)
            new Uint8Array(copy).set(new Uint8Array(each.bytes));
        each.bytes = null; // the room of one is enough
        return {...each, bytes: copy};
    });
}

/** The module with a memory, as `exports`.  `onFetch` hears of each answer of a server. */
function instance(module, memory, list, onFetch) {
    const of = {memory, files: new Files(list, onFetch)};
    const {env, wasi_snapshot_preview1: wasi} = host(of, of.files);
    const imports = {env: {}, wasi_snapshot_preview1: {}};
    for (const {module: from, name, kind} of WebAssembly.Module.imports(module))
        imports[from][name] = kind === 'memory' ? memory : (from === 'env' ? env : wasi)[name];
    of.exports = new WebAssembly.Instance(module, imports).exports;
    of.table = of.exports.__indirect_function_table;
    return of;
}

/** A thread of the engine: never returns. */
function help({module, memory, files, stack, number}) {
    const {exports} = instance(module, memory, files);
    exports.stackRestore(stack);
    exports.engine_help(number);
}

/** The engine with its files open, as functions of texts and bytes.  `share` gets what
 * each thread but this one begins with; without it there are no others. */
async function begin(wasm, list, threads = 1, share = null, onFetch = null) {
    const memory = room(share);
    const among = memory.buffer instanceof ArrayBuffer ? null : share;
    const files = among ? shared(list) : list;
    const module = await WebAssembly.compile(among ? wasm : unshared(wasm));
    const of = instance(module, memory, files, onFetch ?? (() => {}));
    of.exports._initialize();
    for (let number = 0; among && number < threads - 1; number++) {
        const stack = of.exports.engine_add_helper();
        if (!stack)
            break;
        among({t: 'help', module, memory, files, stack, number});
    }
    const put = text => {
        const encoded = new TextEncoder().encode(text);
        const at = of.exports.engine_room(encoded.length + 1);
        const all = new Uint8Array(memory.buffer);
        all.set(encoded, at);
        all[at + encoded.length] = 0;
        return [at, encoded.length];
    };
    return {
        open(path, recipe) {
            const [a] = put(path), [b] = put(JSON.stringify(recipe));
            const good = of.exports.engine_open(a, b, of.files.remote ? FETCHED_MOST : 0);
            of.exports.engine_leave(a);
            of.exports.engine_leave(b);
            of.files.forget();
            return good;
        },
        hear(text) {
            const [at, length] = put(text);
            of.exports.engine_hear(at, length);
            of.exports.engine_leave(at);
        },
        step: () => of.exports.engine_step(),
        /** The next text or picture for the page; null: none. */
        take() {
            const at = of.exports.engine_take();
            if (!at)
                return null;
            const copy = new Uint8Array(memory.buffer, at, of.exports.engine_length()).slice();
            return of.exports.engine_is_text() ? new TextDecoder().decode(copy) : copy.buffer;
        }};
}

/** Serves one page. */
function serve(scope) {
    let engine, timer, underWay = 0, dead = false;
    const channel = new MessageChannel();
    const deliver = () => {
        for (let each; (each = engine.take()) !== null;) {
            const picture = typeof each !== 'string' && !new Uint8Array(each)[10];
            underWay += picture ? 1 : 0;
            scope.postMessage(each, typeof each === 'string' ? [] : [each]);
        }
    };
    const fail = error => {
        dead = true;
        scope.postMessage({t: 'refused', text: `The engine has stopped (${error.message}): ` +
            'open the file again; a part of it (Crop) or a smaller window needs less memory.'});
    };
    // What the page said meanwhile comes before the next picture.
    const soon = () => channel.port2.postMessage(0);
    const work = () => {
        clearTimeout(timer);
        if (dead || underWay >= UNDER_WAY)
            return;
        try {
            const wait = engine.step();
            deliver();
            if (wait === 0)
                soon();
            else if (wait > 0)
                timer = setTimeout(work, wait);
        } catch (error) {
            fail(error);
        }
    };
    channel.port1.onmessage = work;
    let told = performance.now();
    const reportFetched = ({count, fetched}) => {
        const now = performance.now();
        if (now - told < SELDOM)
            return;
        told = now;
        scope.postMessage({t: 'fetched', files: count, bytes: fetched});
    };
    const open = async ({wasm, files, path, recipe}) => {
        try {
            const made = await begin(wasm, files, Math.min(navigator.hardwareConcurrency, THREADS_MOST),
                scope.crossOriginIsolated && (what => scope.postMessage(what)), reportFetched);
            const good = made.open(path, recipe);
            engine = made;
            deliver();
            if (!good)
                scope.postMessage({t: 'refused', text: ''});
            dead = !good;
            work();
        } catch (error) {
            fail(error);
        }
    };
    scope.onmessage = ({data}) => {
        if (data.t === 'open') {
            open(data);
            return;
        }
        if (data.t === 'help') {
            try {
                help(data);
            } catch (error) {
                fail(error);
            }
            return;
        }
        if (!engine || dead)
            return;
        if (data.t === 'hear')
            engine.hear(data.text);
        else
            underWay = Math.max(0, underWay - 1);
        deliver();
        work();
    };
}

if (typeof module !== 'undefined')
    module.exports = {begin, help};
else
    serve(self);
