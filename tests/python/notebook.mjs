// notebook.mjs - the viewer's widget in Chromium, as a notebook has it: in a cell of
// a page that has keys, styles and a title of its own, twice, over a model that
// speaks with Python.
//
//   node notebook.mjs PLAYWRIGHT CHROMIUM PYTHON KERNEL SOURCE FOLDER
import {spawn} from 'node:child_process';
import {writeFileSync} from 'node:fs';
import {createInterface} from 'node:readline';

const [playwright, chromium, python, kernel, source, folder] = process.argv.slice(2);
const {chromium: browsers} = await import(playwright);
let wrong = 0;

function check(name, good, why = '') {
    console.log(good ? `ok     ${name}` : `FAILED ${name}: ${why}`);
    wrong += good ? 0 : 1;
}

const process_ = spawn(python, ['-W', 'ignore', kernel, source],
    {stdio: ['pipe', 'pipe', 'inherit']});
const lines = createInterface({input: process_.stdout});
let hear, module_;
const begun = new Promise(resolve => lines.on('line', line => {
    if (module_)
        hear?.(line);
    else
        resolve(module_ = JSON.parse(line));
}));
await begun;

const browser = await browsers.launch({executablePath: chromium,
    args: ['--no-sandbox', '--disable-gpu', '--disable-software-rasterizer']});
const page = await browser.newPage({viewport: {width: 1100, height: 900}});
const said = [];
page.on('console', message => said.push(message.text()));
page.on('pageerror', error => said.push(String(error)));
await page.exposeFunction('toKernel', text => process_.stdin.write(`${text}\n`));
await page.setContent(`<!doctype html><title>notebook</title>
<style>button { color: red; font-size: 40px } .panel, .picture { display: none }</style>
<textarea id="cell"></textarea><div id="one"></div><div id="two"></div>`);
hear = line => page.evaluate(text => {
    const [content, buffers] = JSON.parse(text);
    const views = buffers.map(each => new DataView(
        Uint8Array.from(atob(each), letter => letter.charCodeAt(0)).buffer));
    for (const take of [...window.takers])
        take(content, views);
}, line).catch(() => {});
await page.evaluate(async text => {
    window.takers = new Set();
    window.keysOfTheNotebook = [];
    document.addEventListener('keydown', event => window.keysOfTheNotebook.push(event.key));
    const url = URL.createObjectURL(new Blob([text], {type: 'text/javascript'}));
    const {default: widget} = await import(url);
    window.model = {
        get: name => ({height: 420})[name],
        send: content => window.toKernel(JSON.stringify(content)),
        on: (name, take) => window.takers.add(take),
        off: (name, take) => window.takers.delete(take)};
    window.end = ['one', 'two'].map(id => widget.render(
        {model: window.model, el: document.getElementById(id)}));
}, module_);

const place = id => `document.querySelector('#${id} .snowglass-viewer')`;
const at = (id, code) => page.evaluate(`(() => { const place = ${place(id)}, page = place.snowglass;
    return ${code}; })()`);
async function rest(id) {
    await page.waitForFunction(`(() => { const {engine, page} = ${place(id)}.snowglass;
        return page.rest && !engine.waiting && !engine.sentAt.size; })()`, null, {timeout: 60000});
    await page.waitForTimeout(60);
}
const box = id => page.locator(`#${id} .picture canvas[role=img]`).boundingBox();

await rest('one');
await rest('two');
check('the page keeps its title', await page.title() === 'notebook');
check('the cell has the height that was asked for',
    await at('one', 'place.getBoundingClientRect().height') === 420);
check('styles of the notebook stay outside', await at('one',
    "getComputedStyle(place.shadowRoot.querySelector('button')).fontSize") === '14px');
const {x, y, width, height} = await box('one');
check('the picture has room', width > 300 && height > 250, [width, height]);
const before = await at('one', 'page.recipe.keys');
await page.mouse.move(x + width / 2, y + height / 2);
await page.mouse.down();
for (let i = 1; i <= 8; i++)
    await page.mouse.move(x + width / 2 + 12 * i, y + height / 2);
await page.mouse.up();
await rest('one');
const now = await at('one', 'page.recipe.keys');
check('a drag turns the camera', now.azimuth < (before.azimuth ?? 0), now.azimuth);
await rest('two');
check('the other cell shows the same',
    (await at('two', 'page.recipe.keys.azimuth')) === now.azimuth);
await page.locator('#one .picture canvas[role=img]').focus();
await page.keyboard.press('ArrowLeft');
await rest('one');
check('keys turn it', (await at('one', 'page.recipe.keys.azimuth')) === now.azimuth + 5 ||
    Math.abs((await at('one', 'page.recipe.keys.azimuth')) - now.azimuth) > 4,
await at('one', 'page.recipe.keys.azimuth'));
check('and are no keys of the notebook',
    (await page.evaluate('window.keysOfTheNotebook')).length === 0);
const kept = await at('one', 'page.recipe.keys.azimuth');
await page.locator('#cell').focus();
await page.keyboard.press('ArrowLeft');
await page.keyboard.press('m');
await page.waitForTimeout(300);
check('keys of a cell are none of the viewer', kept === await at('one', 'page.recipe.keys.azimuth') &&
    (await at('one', "page.recipe.keys.mode ?? 'over'")) === 'over');
check('and reach the notebook', (await page.evaluate('window.keysOfTheNotebook')).length === 2);
check('what the kernel does not offer is hidden',
    await page.locator('#one [title^="Three slices"]:visible').count() === 0 &&
    await page.locator('#one [title$="this picture (c)"]:visible').count() === 1);
check('no link leads here', await page.locator('#one [title^="Copy a link"]').count() === 0);
await page.locator('#one summary', {hasText: 'Presets'}).click();
await page.evaluate(`${place('one')}.shadowRoot.querySelectorAll('details:has(> div > .presets)')
    .forEach(group => { group.open = true; })`);
await page.waitForFunction(`[...${place('one')}.shadowRoot.querySelectorAll('.presets img')]
    .filter(image => !image.hidden).length > 3`, null, {timeout: 60000});
check('presets show themselves', true);
for (const [name, preset] of [['Bone', 'ct-bone'], ['Automatic', null]]) {
    await page.locator(`#one .presets button[aria-label^="${name}:"]`).first().click();
    const chosen = await page.waitForFunction(`(${place('two')}.snowglass.recipe.keys.preset ?? null) ===
        ${JSON.stringify(preset)}`, null, {timeout: 20000}).catch(() => null); // by way of the kernel
    check(`a click chooses ${name}`, chosen);
}
await rest('one');
const picture = await page.evaluate(`${place('one')}.snowglass.page.rest.arrayBuffer()
    .then(bytes => [...new Uint8Array(bytes)])`);
writeFileSync(`${folder}/rest.png`, Buffer.from(picture));
await page.screenshot({path: `${folder}/notebook.png`});
await page.evaluate('window.end[0]()');
check('a cell that is gone hears nothing', await page.evaluate('window.takers.size') === 1);
check('nothing is said on the console', said.length === 0, said.join('; '));
await browser.close();
process_.kill();
process.exit(wrong ? 1 : 0);
