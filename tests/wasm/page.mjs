// page.mjs - the page without a server in Chromium, without a GPU.
//
//   node page.mjs PLAYWRIGHT CHROMIUM FOLDER PAGES
//
// PAGES is a JSON list of {url, volumes, damaged}: the last is a file that is refused.  Each of the volumes is a list [NAME, FILE...],
// whose files, or a folder, are dropped on the page, if there are any.  The last one of a
// page is turned, sliced, and gets states.  Of each there are then in FOLDER the picture
// at rest and the command, NAME-rest.png and NAME.txt, of the last one a screenshot too.
import {writeFileSync} from 'node:fs';
import {SELDOM, browser, folder, keep, pages, settled} from './browser.mjs';

let wrong = 0, name, page, said, asked;

function check(what, good, why = '') {
    console.log(good ? `ok     ${name}: ${what}` : `FAILED ${name}: ${what}: ${why}`);
    wrong += good ? 0 : 1;
}

async function open(url) {
    page = await browser.newPage({viewport: {width: 800, height: 500}});
    page.setDefaultTimeout(300000); // ms: other programs may have the machine
    said = [], asked = [];
    page.on('console', message => said.push(message.text()));
    page.on('pageerror', error => said.push(String(error)));
    page.on('request', request => asked.push(request.url()));
    await page.addInitScript(() => document.addEventListener('securitypolicyviolation',
        event => console.log(`policy: ${event.violatedDirective}`)));
    await page.goto(url);
    await rest();
}

const rest = () => settled(page);
const slicesRest = () => page.waitForFunction(() => {
    const {panes} = window.snowglass.slices;
    return panes.length === 3 && panes.every(pane => pane.exact && !pane.busy && pane.file);
}, null, SELDOM);
const title = () => page.locator('.top .grow').textContent();

/** As from the desktop: an event that a page makes has no folders. */
async function drop(files) {
    const session = await page.context().newCDPSession(page);
    for (const type of ['dragEnter', 'dragOver', 'drop'])
        await session.send('Input.dispatchDragEvent', {type, x: 300, y: 300,
            data: {items: [], files, dragOperationsMask: 1}});
}

/** What a raw file does not say. */
async function fillIn() {
    await page.locator('dialog[open]').waitFor();
    await page.screenshot({path: `${folder}/${name}-form.png`});
    check('what fits is filled in', await page.getByLabel('voxels along x').inputValue() !== '');
    for (const [along, count] of [['x', 64], ['y', 64], ['z', 48]])
        await page.getByLabel(`voxels along ${along}`).fill(String(count));
    await page.getByLabel('spacing along z').fill('4.7');
    await page.locator('dialog[open] button', {hasText: 'Open'}).click();
}

async function show(files) {
    const before = await title();
    await drop(files);
    if (name === 'raw')
        await fillIn();
    await page.waitForFunction(was => document.querySelector('.top .grow')?.textContent.startsWith(was) === false,
        before, SELDOM);
    await rest();
}

async function turn() {
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
}

async function states() {
    const named = await title(), link = await page.evaluate(() => JSON.stringify(
        {...window.snowglass.recipe.keys, mode: 'mean'}));
    await page.evaluate(recipe => { location.hash = new URLSearchParams({recipe}); }, link);
    await page.waitForFunction(() => window.snowglass?.recipe.keys.mode === 'mean', null, SELDOM);
    await rest();
    check('a link is taken in the same tab', await title() === named, await title());
    const state = `${folder}/${name}.json`;
    writeFileSync(state, JSON.stringify({azimuth: 40, roll: 15}));
    await drop([state]);
    await page.waitForFunction(() => window.snowglass.recipe.keys.roll === 15, null, SELDOM);
    await rest();
    check('the file of a recipe is dropped as the state', await page.evaluate(() => {
        const {azimuth, mode} = window.snowglass.recipe.keys;
        return azimuth === 40 && !mode;
    }), await page.locator('.said').textContent());
    check('which keeps the volume', await title() === named, await title());
}

/** A file that cannot be opened takes nothing away. */
async function refusal(damaged) {
    const named = await title(), frames = () => page.evaluate(() => window.snowglass.page.frames);
    const {zoom: before} = await page.evaluate(() => window.snowglass.recipe.keys);
    await drop([damaged]);
    await page.waitForFunction(() => /damaged/.test(document.querySelector('.said').textContent), null, SELDOM);
    const said = await page.locator('.said').textContent(), drawn = await frames();
    check('a file that is refused is named', /damaged.nrrd/.test(said) && !/Reading/.test(said), said);
    check('and the volume before is shown', await title() === named && await page.locator('main').count() === 1);
    await page.keyboard.press('+');
    await page.waitForFunction(was => window.snowglass.page.frames > was, drawn, SELDOM);
    await rest();
    const {zoom} = await page.evaluate(() => window.snowglass.recipe.keys);
    check('by an engine that still draws, and hears a key once', Math.abs(zoom / (before ?? 1) - 1.25) < 0.01 ||
        zoom > (before ?? 1), zoom);
    await page.keyboard.press('z');
    await rest();
}

async function end(url) {
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
    await page.close();
}

for (const {url, volumes, damaged} of pages) {
    await open(url);
    for (const [i, [each, ...files]] of volumes.entries()) {
        name = each;
        if (files.length)
            await show(files);
        if (i === volumes.length - 1) {
            await turn();
            await page.keyboard.press('x');
            await slicesRest();
            await rest();
            await page.screenshot({path: `${folder}/${name}.png`});
            await page.keyboard.press('x');
            await rest();
            await states();
        }
        await keep(page, name);
    }
    if (damaged)
        await refusal(damaged);
    await end(url);
}
await browser.close();
process.exit(wrong ? 1 : 0);
