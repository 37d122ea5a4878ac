// engine.cjs - runs the engine of the page without a server in Node.
//
//   node engine.cjs WORKER ENGINE FOLDER JOBS
//
// JOBS is a JSON list of {name, path, files, recipe, turn, threads, narrow}, whose files
// are in FOLDER.  Of each there are then in FOLDER too the pictures NAME-0.bin (draft),
// NAME-1.bin, NAME-2.bin, as they go to the page, and NAME.json: what was said, the
// command, the qualities of all pictures, and the processor's milliseconds of each thread.
// A turn comes when the picture at rest was begun.  Where it is narrow, there is no room
// for memory that threads share.
const fs = require('fs');
const {helpers} = require('./helpers.cjs');
const [script, engine, folder, jobs] = process.argv.slice(2);
const worker = require('path').resolve(script);
const {begin} = require(worker);

/** Of the processor, of a thread of this process. */
const milliseconds = folder =>
    Number(fs.readFileSync(`/proc/${folder}/schedstat`, 'latin1').split(' ')[0]) / 1e6;

const Memory = WebAssembly.Memory;

function narrowMemory(how) {
    if (how.shared)
        throw new RangeError('there is no room');
    return new Memory(how);
}

async function run({name, path, files, recipe, turn, threads = 1, narrow}) {
    const others = helpers(worker);
    WebAssembly.Memory = narrow ? narrowMemory : Memory;
    const made = await begin(fs.readFileSync(engine), files.map(name => ({
        name, bytes: new Uint8Array(fs.readFileSync(`${folder}/${name}`)).buffer})), threads, threads > 1 && others.share);
    const folders = ['thread-self', ...await others.folders()], begun = folders.map(milliseconds);
    const out = {said: [], levels: [], opened: made.open(path, recipe)};
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
            if (turn && wait === 0 && out.levels.length === before && out.levels.at(-1) === 1) {
                made.hear(JSON.stringify({t: 'set', n: 1, recipe: turn}));
                turn = null;
            }
            if (wait)
                await new Promise(done => setTimeout(done, wait));
        }
    };
    take();
    if (out.opened) {
        await rest();
        made.hear(JSON.stringify({t: 'ask', what: 'command'}));
        await rest();
        take();
    }
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
}

all();
