// engine.cjs - runs the engine of the page without a server in Node.
//
//   node engine.cjs WORKER ENGINE FOLDER JOBS
//
// JOBS is a JSON list of {name, path, files, recipe, turn}, whose files are in FOLDER.  Of each there are then in
// FOLDER too the pictures NAME-0.bin (draft), NAME-1.bin, NAME-2.bin, as they go to the
// page, and NAME.json: what was said, the command, and
// the qualities of all pictures.  A turn comes when the picture at rest was begun.
const fs = require('fs');
const [worker, engine, folder, jobs] = process.argv.slice(2);
const {begin} = require(worker);

async function run({name, path, files, recipe, turn}) {
    const made = await begin(fs.readFileSync(engine), files.map(name => ({
        name, bytes: new Uint8Array(fs.readFileSync(`${folder}/${name}`)).buffer})));
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
    fs.writeFileSync(`${folder}/${name}.json`, JSON.stringify(out));
}

// What the engine lacks: the page's part, the system's, and what is of many processes.
const lacks = /^(host|invoke|ranks|snow_(comm|combiner|group|part|partition|pipeline|ranks))_|^(__syscall|_?emscripten|fd|environ|clock)_|^(proc_exit|[gs]etTempRet0)$/;
for (const {name} of WebAssembly.Module.imports(new WebAssembly.Module(fs.readFileSync(engine))))
    if (!lacks.test(name))
        throw new Error(`${name} is called, and not in the engine`);

(async () => {
    for (const job of JSON.parse(jobs))
        await run(job);
})();
