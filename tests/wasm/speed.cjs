// speed.cjs - how fast the engine of the page without a server is in Node.
//
//   node speed.cjs WORKER ENGINE PATH SIDE TURNS [THREADS]
//
// Prints the least milliseconds of the processor for a draft, a normal picture and one
// at rest: its clock is that of this thread, and what is waited for.  With THREADS they
// are milliseconds that pass.
const fs = require('fs');
const {helpers} = require('./helpers.cjs');
const [script, engine, path, side, turns, threads] = process.argv.slice(2);
const worker = require('path').resolve(script);
const {begin} = require(worker);

let waited = 0;
if (!threads)
    performance.now = () => waited + Number(fs.readFileSync('/proc/thread-self/schedstat', 'latin1').split(' ')[0]) / 1e6;

/** Waits, or takes it for done. */
async function pause(milliseconds) {
    waited += milliseconds;
    if (threads && milliseconds)
        await new Promise(good => setTimeout(good, milliseconds));
}

(async () => {
    const others = helpers(worker);
    const made = await begin(fs.readFileSync(engine), [], threads, threads > 1 && others.share);
    await others.folders();
    const least = [Infinity, Infinity, Infinity];
    const take = () => {
        for (let each; (each = made.take()) !== null;) {
            const head = typeof each === 'string' ? null : new DataView(each);
            const level = head?.getUint8(8);
            if (head && head.getUint32(16, true) === +side)
                least[level] = Math.min(least[level], head.getUint32(24, true) / 1000);
        }
    };
    made.open(path, {size: [+side, +side]});
    for (let turn = 0; turn < +turns; turn++) {
        made.hear(JSON.stringify({t: 'set', step: turn + 1, keys: {azimuth: 30 + turn / 8}}));
        for (let wait; (wait = made.step()) >= 0; await pause(wait))
            take();
        take();
    }
    await others.end();
    console.log(JSON.stringify(least));
})();
