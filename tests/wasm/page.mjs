// page.mjs - the page without a server in Chromium, without a GPU.
//
//   node page.mjs PLAYWRIGHT CHROMIUM URL FOLDER NAME [FILE...]
//
// Drops the files, or a folder, on the page, if there are any, turns the volume, and leaves in
// FOLDER a screenshot, the picture at rest and the command: NAME.png, NAME-rest.png,
// NAME.txt.
import {writeFileSync} from 'node:fs';

const [playwright, chromium, url, folder, name, ...files] = process.argv.slice(2);
const {chromium: browsers} = await import(playwright);
let wrong = 0;

function check(what, good, why = '') {
    console.log(good ? `ok     ${name}: ${what}` : `FAILED ${name}: ${what}: ${why}`);
    wrong += good ? 0 : 1;
}

const browser = await browsers.launch({executablePath: chromium,
    args: ['--no-sandbox', '--disable-gpu', '--disable-software-rasterizer']});
const page = await browser.newPage({viewport: {width: 1000, height: 700}});
const said = [], asked = [];
page.on('console', message => said.push(message.text()));
page.on('pageerror', error => said.push(String(error)));
page.on('request', request => asked.push(request.url()));
await page.addInitScript(() => document.addEventListener('securitypolicyviolation',
    event => console.log(`policy: ${event.violatedDirective}`)));
await page.goto(url);

const rest = () => page.waitForFunction(() => {
    const {engine, page: of} = window.snowglass ?? {};
    return of?.rest && !engine.waiting && !engine.sentAt.size;
}, null, {timeout: 60000});
const title = () => page.locator('.top .grow').textContent();

/** As from the desktop: an event that a page makes has no folders. */
async function drop(files) {
    const session = await page.context().newCDPSession(page);
    for (const type of ['dragEnter', 'dragOver', 'drop'])
        await session.send('Input.dispatchDragEvent', {type, x: 300, y: 300,
            data: {items: [], files, dragOperationsMask: 1}});
}

await rest();
if (files.length) {
    const before = await title();
    await drop(files);
    if (name === 'raw') { // what the file does not say
        await page.locator('dialog[open]').waitFor();
        await page.screenshot({path: `${folder}/${name}-form.png`});
        check('what fits is filled in', await page.getByLabel('voxels along x').inputValue() !== '');
        for (const [along, count] of [['x', 64], ['y', 64], ['z', 48]])
            await page.getByLabel(`voxels along ${along}`).fill(String(count));
        await page.getByLabel('spacing along z').fill('4.7');
        await page.locator('dialog[open] button', {hasText: 'Open'}).click();
    }
    await page.waitForFunction(before => !document.querySelector('.top .grow')?.textContent.startsWith(before),
        before);
    await rest();
}
const box = await page.locator('.picture canvas').first().boundingBox();
const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
await page.mouse.move(x, y);
await page.mouse.down();
for (let i = 1; i <= 8; i++)
    await page.mouse.move(x + 10 * i, y + 5 * i);
await page.mouse.up();
await rest();
const {azimuth} = await page.evaluate(() => window.snowglass.recipe.keys);
check('a drag turns', azimuth !== undefined && azimuth !== 0, azimuth);
await page.keyboard.press('x');
await page.waitForFunction(() => document.querySelectorAll('.pane canvas').length === 3);
await rest();
await page.waitForTimeout(700);
await page.screenshot({path: `${folder}/${name}.png`});
await page.keyboard.press('x');
await page.waitForTimeout(300);
await rest();
const named = await title(), link = await page.evaluate(() => JSON.stringify(
    {...window.snowglass.recipe.keys, mode: 'mean'}));
await page.evaluate(recipe => { location.hash = new URLSearchParams({recipe}); }, link);
await page.waitForFunction(() => window.snowglass?.recipe.keys.mode === 'mean', null, {timeout: 60000});
await rest();
check('a link is taken in the same tab', await title() === named, await title());
const state = `${folder}/${name}.json`;
writeFileSync(state, JSON.stringify({azimuth: 40, roll: 15}));
await drop([state]);
await page.waitForFunction(() => window.snowglass.recipe.keys.roll === 15);
await rest();
check('the file of a recipe is dropped as the state', await page.evaluate(() => {
    const {azimuth, mode} = window.snowglass.recipe.keys;
    return azimuth === 40 && !mode;
}), await page.locator('.said').textContent());
check('which keeps the volume', await title() === named, await title());
const picture = await page.evaluate(async () =>
    [...new Uint8Array(await window.snowglass.page.rest.arrayBuffer())]);
writeFileSync(`${folder}/${name}-rest.png`, Buffer.from(picture));
await page.locator('button', {hasText: 'Command'}).first().click();
writeFileSync(`${folder}/${name}.txt`, await page.locator('dialog textarea').inputValue());
const {helpers, threads, isolated} = await page.evaluate(() => ({
    isolated: crossOriginIsolated,
    helpers: window.snowglass.engine.helpers.length,
    threads: crossOriginIsolated ? Math.min(navigator.hardwareConcurrency, 16) : 1}));
check('each processor has a thread, where memory may be shared', helpers + 1 === threads, helpers);
check('memory may be shared', isolated === /^http:/.test(url), isolated);
check('nothing is said on the console', !said.length, said.join('; '));
const far = asked.filter(each => each !== url && !/^(blob|data):/.test(each));
check('nothing else is asked for', !far.length, far.join());
const lost = await page.evaluate(() => new Promise(good => {
    const {engine} = window.snowglass;
    engine.on('closed', good);
    engine.help({t: 'help'}); // with nothing that a thread needs
}));
check('a lost thread ends the engine', /stopped.*open the file again/.test(lost), lost);
await browser.close();
process.exit(wrong ? 1 : 0);
