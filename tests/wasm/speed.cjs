// speed.cjs - how fast the engine of the page without a server is in Node.
//
//   node speed.cjs WORKER ENGINE PATH SIDE TURNS
//
// Prints the least milliseconds of the processor for a draft, a normal picture and one
// at rest: its clock is that of this thread, and what is waited for.
const fs = require('fs');
const [worker, engine, path, side, turns] = process.argv.slice(2);
const {begin} = require(worker);

let waited = 0;
performance.now = () => waited + Number(fs.readFileSync('/proc/thread-self/schedstat', 'latin1').split(' ')[0]) / 1e6;

(async () => {
    const made = await begin(fs.readFileSync(engine), []);
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
        made.hear(JSON.stringify({t: 'set', n: turn + 1, recipe: {azimuth: 30 + turn / 8}}));
        for (let wait; (wait = made.step()) >= 0; waited += wait)
            take();
        take();
    }
    console.log(JSON.stringify(least));
})();
