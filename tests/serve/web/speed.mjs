// tests/serve/web/speed.mjs - how fast the page is in Chromium, without a GPU.
//
//   node speed.mjs PLAYWRIGHT CHROMIUM URL SIDE
//
// Prints one JSON object: milliseconds from an input to the painted picture, how
// many pictures and bytes came, and when the picture rests.
const [playwright, chromium, url, side] = process.argv.slice(2);
const {chromium: browsers} = await import(playwright);
const browser = await browsers.launch({executablePath: chromium,
    args: ['--no-sandbox', '--disable-gpu', '--disable-software-rasterizer']});
const page = await browser.newPage({viewport: {width: +side + 337, height: +side + 80}});
const begin = performance.now();
await page.goto(url, {waitUntil: 'commit'});
await page.waitForFunction(() => window.snowglass?.page.frames > 0, null, {timeout: 120000});
const first = performance.now() - begin;
// A pixel of the picture is one of the screen, as it is in any window that is not measured.
const [across, down] = await page.evaluate(() => {
    const {clientWidth, clientHeight} = document.querySelector('.picture');
    return [clientWidth, clientHeight];
});
await page.setViewportSize({width: 2 * +side + 337 - across, height: 2 * +side + 80 - down});
await page.waitForFunction(() => window.snowglass.page.rest, null, {timeout: 120000});

const out = await page.evaluate(async size => {
    const {engine, recipe, page: of} = window.snowglass;
    const pause = ms => new Promise(resolve => setTimeout(resolve, ms));
    const times = [], pictures = [];
    engine.on('measured', ms => times.push(ms));
    engine.on('picture', frame => pictures.push({...frame, at: performance.now()}));
    recipe.apply({size: [size, size]});
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
            whole: sides.filter(width => width === size).length / (sides.length || 1)};
        recipe.end();
        const rest = await rests(performance.now());
        return {...result, normal: rest(1), high: rest(2)};
    };
    const turn = await run(4, i => ({azimuth: i % 360}));
    const points = of.look.opacity;
    const edit = await run(3, i => ({opacity: points.map(([value, opacity], k) =>
        [value, k ? Math.min(1, opacity * (1 + 0.002 * (i % 100))) : opacity])}));
    return {turn, edit};
}, +side);
console.log(JSON.stringify({...out, first}));
await browser.close();
