// engine.cjs - runs the engine of the page without a server in Node.
//
//   node engine.cjs WORKER ENGINE FOLDER JOBS
//
// JOBS is a JSON list of {name, path, files, kept, recipe, turn, threads, narrow, first},
// whose files are in FOLDER, or, of one at an address, {name, address, recipe}; those that are kept are read by the part, as a page reads a
// File; the first picture may be all.  Of each there are then in FOLDER too the pictures
// NAME-0.bin (draft), NAME-1.bin, NAME-2.bin, as they go to the page, and NAME.json: what
// was said, the command, the qualities of all pictures, and the processor's milliseconds of each thread.
// `reads` has the bytes of the longest read and of all, and how many there were.
// A turn comes when the picture at rest was begun.  Where it is narrow, there is no room
// for memory that threads share.
const fs = require('fs');
const {helpers} = require('./helpers.cjs');
const [script, engine, folder, jobs] = process.argv.slice(2);
const worker = require('path').resolve(script);
const {begin} = require(worker);
const far = require('./far.cjs');

/** Of the processor, of a thread of this process. */
const milliseconds = folder =>
    Number(fs.readFileSync(`/proc/${folder}/schedstat`, 'latin1').split(' ')[0]) / 1e6;

const Memory = WebAssembly.Memory;

/** As much of a browser's File as the worker uses. */
class Kept {
    constructor(path) {
        this.path = path;
        this.size = fs.statSync(path).size;
    }

    slice(begin, end) {
        return {path: this.path, begin, end: Math.min(end, this.size)};
    }
}

let reads;

/** A browser's, which reads at once. */
globalThis.FileReaderSync = class {
    readAsArrayBuffer({path, begin, end}) {
        const bytes = new Uint8Array(end - begin), file = fs.openSync(path);
        const got = fs.readSync(file, bytes, 0, bytes.length, begin);
        fs.closeSync(file);
        reads = {most: Math.max(reads.most, got), all: reads.all + got, count: reads.count + 1};
        return bytes.buffer;
    }
};

function narrowMemory(how) {
    if (how.shared)
        throw new RangeError('there is no room');
    return new Memory(how);
}

/** As the page opens an address. */
async function placeOf(text) {
    const script = require('path').join(require('path').dirname(worker), 'address.js');
    const {addressOf} = await import(`data:text/javascript,${encodeURIComponent(fs.readFileSync(script, 'utf8'))}`);
    return addressOf(text, new URL('file:///viewer.html'));
}

async function run({name, path, files, kept, recipe, turn, threads = 1, narrow, first, address}) {
    reads = {most: 0, all: 0, count: 0};
    const others = helpers(worker);
    WebAssembly.Memory = narrow ? narrowMemory : Memory;
    const place = address === undefined ? null : await placeOf(address).catch(({message}) => ({message}));
    if (place?.message) {
        fs.writeFileSync(`${folder}/${name}.json`, JSON.stringify({opened: false, said: [place.message]}));
        return;
    }
    path ??= place?.path;
    const list = place ? [place] : files.map(each => kept ? {name: each, file: new Kept(`${folder}/${each}`)} : {
        name: each, bytes: new Uint8Array(fs.readFileSync(`${folder}/${each}`)).buffer});
    const made = await begin(fs.readFileSync(engine), list, threads, threads > 1 && others.share);
    const folders = ['thread-self', ...await others.folders()], begun = folders.map(milliseconds);
    const out = {path, said: [], levels: [], opened: made.open(path, recipe)};
    const take = () => {
        for (let each; (each = made.take()) !== null;) {
            if (typeof each !== 'string') {
                const level = new DataView(each).getUint8(8);
                out.levels.push(level);
                fs.writeFileSync(`${folder}/${name}-${level}.bin`, new Uint8Array(each));
                continue;
            }
            const message = JSON.parse(each);
            if (message.t === 'said' || message.t === 'command')
                out[message.t === 'said' ? 'said' : 'command'] =
                    message.t === 'said' ? [...out.said, message.text] : message.text;
        }
    };
    const rest = async () => {
        for (let wait; (wait = made.step()) >= 0;) {
            const before = out.levels.length;
            take();
            if (first && out.levels.length)
                return;
            if (turn && wait === 0 && out.levels.length === before && out.levels.at(-1) === 1) {
                made.hear(JSON.stringify({t: 'set', step: 1, keys: turn}));
                turn = null;
            }
            if (wait)
                await new Promise(done => setTimeout(done, wait));
        }
    };
    take();
    if (out.opened && first) {
        await rest();
    } else if (out.opened) {
        await rest();
        made.hear(JSON.stringify({t: 'ask', what: 'command'}));
        await rest();
        take();
    }
    out.reads = reads;
    out.took = folders.map((folder, i) => milliseconds(folder) - begun[i]);
    await others.end();
    fs.writeFileSync(`${folder}/${name}.json`, JSON.stringify(out));
}

// What the engine lacks: the page's part, and the system's.
const lacks = /^(host|invoke)_|^(__syscall|_?emscripten|fd|environ|clock)_|^(proc_exit|[gs]etTempRet0)$/;

async function all() {
    for (const {name, kind} of WebAssembly.Module.imports(new WebAssembly.Module(fs.readFileSync(engine))))
        if (kind === 'function' && !lacks.test(name))
            throw new Error(`${name} is called, and not in the engine`);
    for (const job of JSON.parse(jobs))
        await run(job);
    far.end();
}

all();
