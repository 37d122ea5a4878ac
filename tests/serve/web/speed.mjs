// tests/serve/web/speed.mjs - how fast the page is in Chromium, without a GPU.
//
//   node speed.mjs PLAYWRIGHT CHROMIUM URL WIDTHxHEIGHT PID [PORT]
//
// Prints one JSON object: milliseconds from an input to the painted picture, how
// many pictures and bytes came, when the picture rests, what a picture took of the
// processor for the viewer and for the browser, and the longest wait of a turn for a
// picture while a second page is opened, and while none is.  PID is the viewer's, PORT that of a thin link.
import {readFileSync, readdirSync} from 'node:fs';

const [playwright, chromium, url, sides, pid, port] = process.argv.slice(2);
const {chromium: browsers} = await import(playwright);
const link = port ? [`--host-resolver-rules=MAP ${new URL(url).host} 127.0.0.1:${port}`] : [];
const browser = await browsers.launch({executablePath: chromium,
    args: ['--no-sandbox', '--disable-gpu', '--disable-software-rasterizer', ...link]});
const size = sides.split('x').map(Number), around = [337, 80];
const page = await browser.newPage({viewport: {width: size[0] + around[0], height: size[1] + around[1]}});
const begin = performance.now();
await page.goto(url, {waitUntil: 'commit'});
await page.waitForFunction(() => window.snowglass?.page.frames > 0, null, {timeout: 120000});
const first = performance.now() - begin;
// A pixel of the picture is one of the screen, as it is in any window that is not measured.
const box = await page.evaluate(() => {
    const {clientWidth, clientHeight} = document.querySelector('.picture');
    return [clientWidth, clientHeight];
});
const [width, height] = size.map((side, i) => 2 * side + around[i] - box[i]), viewport = {width, height};
await page.setViewportSize(viewport);
await page.waitForFunction(() => window.snowglass.page.rest, null, {timeout: 120000});

await page.evaluate(async size => {
    const {engine, recipe, page: of} = window.snowglass;
    const pause = ms => new Promise(resolve => setTimeout(resolve, ms));
    const times = [], pictures = [];
    engine.on('measured', ms => times.push(ms));
    engine.on('picture', frame => pictures.push({...frame, at: performance.now()}));
    recipe.apply({size});
    const rests = async from => {
        while (!pictures.some(each => each.at > from && each.level === 2))
            await pause(10);
        return level => pictures.find(each => each.at > from && each.level === level)?.at - from;
    };
    await rests(performance.now());
    const at = (list, share) => [...list].sort((a, b) => a - b)[Math.floor(share * (list.length - 1))] ?? NaN;
    const run = async (seconds, change) => {
        times.length = pictures.length = 0;
        recipe.begin();
        const start = performance.now(), end = start + 1000 * seconds;
        for (let i = 0; performance.now() < end; i++) {
            recipe.set(change(i));
            await new Promise(requestAnimationFrame);
        }
        const moving = pictures.filter(each => each.level === 0);
        const sides = moving.map(each => each.width);
        const result = {median: at(times, 0.5), late: at(times, 0.95), rate: moving.length / seconds,
            pictures: moving.length, bytes: at(moving.map(each => each.bytes), 0.5),
            drawn: at(moving.map(each => each.render), 0.5), packed: at(moving.map(each => each.pack), 0.5),
            side: at(sides, 0.5), whole: sides.filter(width => width === size[0]).length / (sides.length || 1)};
        recipe.end();
        const rest = await rests(performance.now());
        return {...result, normal: rest(1), high: rest(2)};
    };
    const points = of.look.opacity;
    window.measure = {
        turn: seconds => run(seconds, i => ({azimuth: i % 360})),
        edit: seconds => run(seconds, i => ({opacity: points.map(([value, opacity], k) =>
            [value, k ? Math.min(1, opacity * (1 + 0.002 * (i % 100))) : opacity])})),
        /** The longest time without a draft from a moment on. */
        wait: from => {
            const ats = [from, ...pictures.filter(each => each.level === 0 && each.at > from).map(each => each.at)];
            return Math.max(...ats.slice(1).map((at, i) => at - ats[i]));
        },
    };
}, size);
/** Milliseconds of the processor that a process and those that it started have used. */
const used = root => {
    const of = new Map([[`${root}`, 0]]);
    for (const id of readdirSync('/proc').filter(name => +name).sort((a, b) => a - b))
        try {
            const [, parent, ...rest] = readFileSync(`/proc/${id}/stat`, 'utf8').split(') ').at(-1).split(' ');
            if (of.has(id) || of.has(parent))
                of.set(id, 10 * (+rest[9] + +rest[10]));
        } catch { // it has ended
        }
    return [...of.values()].reduce((a, b) => a + b);
};
const before = [pid, process.pid].map(used);
const out = {first, turn: await page.evaluate(seconds => window.measure.turn(seconds), port ? 8 : 4)};
[out.viewer, out.browser] = [pid, process.pid].map((id, i) => (used(id) - before[i]) / out.turn.pictures);
/** The longest wait of a turn for a picture, from its first second on, in which `act` is done. */
const wait = async act => {
    const turn = page.evaluate(() => window.measure.turn(6));
    await page.waitForTimeout(1000);
    const from = await page.evaluate(() => performance.now());
    await act();
    await turn;
    return page.evaluate(from => window.measure.wait(from), from);
};
if (!port) { // the edit last: after it voxels are encoded anew for each direction
    out.still = await wait(() => {});
    out.wait = await wait(async () => {
        const other = await browser.newPage({viewport});
        await other.goto(url, {waitUntil: 'commit'});
        await other.waitForFunction(() => window.snowglass?.page.frames > 0, null, {timeout: 120000});
    });
    await browser.contexts().at(-1).pages().at(-1).close();
    out.edit = await page.evaluate(() => window.measure.edit(3));
}
console.log(JSON.stringify(out));
await browser.close();
