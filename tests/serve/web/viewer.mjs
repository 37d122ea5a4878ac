// tests/serve/web/viewer.mjs - the page in Chromium, without a GPU.
//
//   node viewer.mjs PLAYWRIGHT CHROMIUM FOLDER PART,URL[,ORIGIN...]...
//
// Each part has a viewer of its own, at that URL, and all of them one browser, in which
// LANES of them go on at a time, as a page waits for most of the time.  The URL is the
// program's path where a part starts viewers itself.  Screenshots, and the picture at
// rest and the command of a part, are left in FOLDER.
import {AsyncLocalStorage} from 'node:async_hooks';
import {createServer, request} from 'node:http';
import {connect} from 'node:net';
import {readFileSync, writeFileSync} from 'node:fs';
import {asked, restarted, steps} from './everyday.mjs';
import {listed, reopened} from './folder.mjs';
import {layouts} from './layouts.mjs';
import {measures} from './measures.mjs';
import {movies} from './movies.mjs';
import {automatic, transfer} from './transfer.mjs';

const [playwright, chromium, folder, ...parts] = process.argv.slice(2);
const {chromium: browsers} = await import(playwright);
const axe = readFileSync(playwright.replace(/playwright-core.*/, 'axe-core/axe.min.js'), 'utf8');
const PATIENCE = 600000; // ms: other programs may have the machine
const LANES = 3;
const running = new AsyncLocalStorage();
const part = () => running.getStore(); // its name, url, words, and what was said in it
let wrong = 0;

function check(what, good, why = '') {
    const name = `${part().name}: ${what}`;
    console.log(good ? `ok     ${name}` : `FAILED ${name}: ${why}`);
    wrong += good ? 0 : 1;
}

const browser = await browsers.launch({executablePath: chromium,
    args: ['--no-sandbox', '--disable-gpu', '--disable-software-rasterizer']});

async function open(options = {}, address = part().url, waits = true) {
    const context = await browser.newContext({viewport: {width: 900, height: 560},
        acceptDownloads: true, ...options});
    const {said} = part(); // on the console, and against the policy
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    page.on('console', message => said.push(message.text()));
    page.on('pageerror', error => said.push(String(error)));
    await page.addInitScript(() => document.addEventListener('securitypolicyviolation',
        event => console.log(`policy: ${event.violatedDirective}`)));
    await page.goto(address);
    if (waits) // there may be no picture yet
        await rest(page);
    return page;
}

const TOGETHER = 700; // ms: changes that come sooner are one step
const SELDOM = {polling: 20}; // ms: for each frame that is looked at, the page draws one

/** Until the final picture of the present state is there. */
async function rest(page) {
    await page.waitForFunction(() => {
        const {engine, page: of} = window.snowglass ?? {};
        return of?.rest && !engine.waiting && !engine.sentAt.size;
    }, null, SELDOM);
    await page.waitForTimeout(50);
}

/** After events of the page that an action causes, and what they cause: Chromium may
 * have them still to come when the action is done. */
async function after(page, name, count, act) {
    await page.evaluate(([event, left]) => {
        window.happened = new Promise(done => {
            const hear = () => {
                if (--left)
                    return;
                removeEventListener(event, hear, true);
                setTimeout(done);
            };
            addEventListener(event, hear, true);
        });
    }, [name, count]);
    await act();
    await page.evaluate(() => window.happened);
}

const wheel = (page, by) => after(page, 'wheel', 1, () => page.mouse.wheel(0, by));

/** After an answer of the server, which may come after the picture at rest, and may
 * change nothing. */
async function answered(page, name, act) {
    await page.evaluate(kind => {
        window.answered = new Promise(done => window.snowglass.engine.on(kind, done));
    }, name);
    await act();
    await page.evaluate(() => window.answered);
    await rest(page);
}

/** An action, and what it causes. */
async function settle(page, action) {
    await action;
    await rest(page);
}

async function press(page, ...all) {
    for (const key of all)
        await page.keyboard.press(key);
    await rest(page);
}

const set = (page, changes) => settle(page, page.evaluate(
    all => window.snowglass.recipe.set(all), changes));

async function enter(field, value) {
    await field.fill(value);
    await field.press('Enter');
}

/** What a dialog shows, which goes away. */
async function copied(page) {
    await page.waitForSelector('dialog[open] textarea');
    const text = await page.locator('dialog textarea').inputValue();
    await page.keyboard.press('Escape');
    return text;
}

async function hold(page, from, to, {button = 'left', steps = 1} = {}) {
    await page.mouse.move(...from);
    await page.mouse.down({button});
    await page.mouse.move(...to, {steps});
    await page.mouse.up({button});
}

const keys = page => page.evaluate(() => window.snowglass.recipe.keys);

const frameAll = page => answered(page, 'state', () => page.keyboard.press('r'));

const file = name => `${folder}/${part().name}_${name}`;
const shot = (page, name) => page.screenshot({path: `${folder}/${name}.png`});
const middle = async page => {
    const box = await page.locator('.picture canvas').first().boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
};

async function drag(page, dx, dy, button = 'left', modifier = null) {
    const [x, y] = await middle(page);
    if (modifier)
        await page.keyboard.down(modifier);
    await page.mouse.move(x, y);
    await page.mouse.down({button});
    for (let i = 1; i <= 8; i++)
        await page.mouse.move(x + dx * i / 8, y + dy * i / 8);
    await page.mouse.up({button});
    if (modifier)
        await page.keyboard.up(modifier);
    await rest(page);
}

async function smoke(page) {
    const gl = await page.evaluate(() => Boolean(document.createElement('canvas').getContext('webgl')));
    check('there is no WebGL', !gl);
    const before = await keys(page);
    check('the page has the size of its window', before.size[0] > 500 && before.size[1] > 400,
        before.size);
    await drag(page, 100, 0);
    let now = await keys(page);
    check('a drag to the right moves the camera to its left',
        now.azimuth < before.azimuth && now.elevation === before.elevation, now.azimuth);
    await drag(page, 0, 60);
    now = await keys(page);
    check('a drag down moves it up', now.elevation > before.elevation, now.elevation);
    const [x, y] = await middle(page);
    await page.mouse.move(x + 100, y);
    await wheel(page, -300);
    await rest(page);
    const zoomed = await keys(page);
    check('the wheel zooms', zoomed.zoom > 1.3 * now.zoom, zoomed.zoom);
    await press(page, 'z', 'z', 'z');
    now = await keys(page);
    check('three steps are undone', now.azimuth === before.azimuth && now.zoom === before.zoom &&
        now.elevation === before.elevation, JSON.stringify(now));
    await press(page, 'Z');
    const again = (await keys(page)).azimuth;
    check('and one is done again', again < before.azimuth);
    await page.mouse.click(x, y);
    await press(page, 'Z');
    check('a click is no step: another is done again',
        (await keys(page)).elevation > before.elevation);
    await press(page, '+');
    const near = (await keys(page)).zoom;
    await frameAll(page);
    check('frame all frames', (await keys(page)).zoom < near, (await keys(page)).zoom);
    await press(page, 'z');
    check('frame all is a step', (await keys(page)).zoom === near, (await keys(page)).zoom);
    await press(page, 'z', 'z');
    await page.keyboard.press('c');
    const command = await copied(page);
    check('the command is shown', command.startsWith('snowglass render '), command);
    writeFileSync(file('command.txt'), command);
    const coming = page.waitForEvent('download');
    await page.keyboard.press('s');
    await (await coming).saveAs(file('rest.png'));
    await sameAsCanvas(page);
    await set(page, {background: 'none'});
    await sameAsCanvas(page);
    await set(page, {background: null});
    await shot(page, 'smoke');
}

/** What is painted is the picture at rest, pixel by pixel. */
async function sameAsCanvas(page) {
    const different = await page.evaluate(async () => {
        const bitmap = await createImageBitmap(window.snowglass.page.rest,
            {premultiplyAlpha: 'none', colorSpaceConversion: 'none'});
        const canvas = document.querySelector('.picture canvas');
        const pixels = image => {
            const copy = new OffscreenCanvas(image.width, image.height).getContext('2d',
                {alpha: false, willReadFrequently: true});
            copy.drawImage(image, 0, 0);
            return copy.getImageData(0, 0, image.width, image.height).data;
        };
        const [a, b] = [canvas, bitmap].map(pixels);
        return a.length === b.length ? a.reduce((sum, value, i) => sum + (value !== b[i]), 0) : -1;
    });
    check('the canvas has the pixels of the PNG', different === 0, different);
}

/** Every control has a name for a screen reader. */
async function names(page) {
    const nameless = await page.evaluate(() => [...document.querySelectorAll(
        'button, input, select, textarea, canvas:not([aria-hidden]), summary')].filter(element => !(
        element.getAttribute('aria-label') || element.textContent.trim() ||
        [...(element.labels ?? [])].some(label => label.textContent.trim())))
        .map(element => element.outerHTML.slice(0, 90)));
    check('every control has a name', nameless.length === 0, nameless.join(' '));
}

/** Keys act wherever they mean nothing else, and single letters can be switched off. */
async function keyboard(page) {
    const header = page.locator('summary', {hasText: 'Clip'}), {azimuth = 0, mode = 'over'} = await keys(page);
    const now = async () => {
        const {azimuth: a = 0, mode: m = 'over', clip} = await keys(page);
        return `${a - azimuth} ${m} ${Boolean(clip)}`;
    };
    const is = async (what, want) => check(what, await now() === want, await now());
    await header.click();
    await press(page, 'ArrowLeft');
    await is('arrows turn after a click on a header', `5 ${mode} false`);
    const end = page.getByLabel(/clip .*highest/).and(page.locator('input')).first();
    await end.focus();
    await press(page, 'Home');
    await is('a slider has its keys', `5 ${mode} true`);
    await press(page, 'm');
    await is('and letters act beside it', '5 mip true');
    await press(page, 'Control+z', 'Control+z');
    await is('Ctrl+z undoes', `5 ${mode} false`);
    await press(page, 'Control+Shift+z');
    await is('Ctrl+Shift+z does again', `5 ${mode} true`);
    await press(page, 'Control+z', 'Control+y');
    await is('and so does Ctrl+y', `5 ${mode} true`);
    await press(page, 'z', 'z', '?');
    await page.getByLabel('single letters, digits and signs act').uncheck();
    await page.keyboard.press('Escape');
    await press(page, 'm', '3', 'ArrowLeft', 'ArrowRight');
    await is('single letters can be switched off', `0 ${mode} false`);
    await page.getByRole('button', {name: 'A short guide, and all keys (?)'}).click();
    await page.getByLabel('single letters, digits and signs act').check();
    await page.keyboard.press('Escape');
    await header.click();
}

/** What axe-core finds against the guidelines for accessible pages (WCAG). */
async function judged(page, what) {
    await page.waitForTimeout(100);
    await page.evaluate(axe);
    const found = await page.evaluate(async () => (await window.axe.run()).violations.map(
        ({id, nodes}) => `${id}: ${nodes.map(({html}) => html.slice(0, 99)).join(' ')}`));
    check(`axe finds nothing, ${what}`, found.length === 0, found.join('; '));
}

/** What is written can be read, spoken and seen. */
async function readable() {
    for (const colorScheme of ['dark', 'light']) {
        const page = await open({viewport: {width: 640, height: 360}, colorScheme}); // 1280 x 720 at 200 %
        const box = await page.locator('.picture').boundingBox();
        check('the picture of a magnified page is high', box.height > 200 && box.width > 300, JSON.stringify(box));
        const wide = await page.evaluate(() => [...document.querySelectorAll('.top, .bottom')].filter(
            bar => bar.scrollWidth > bar.clientWidth || [...bar.querySelectorAll('button, select')].some(
                one => one.getBoundingClientRect().right > bar.getBoundingClientRect().right)).map(bar => bar.className));
        check('all of its buttons are seen', wide.length === 0, wide.join());
        const spoken = await page.evaluate(() => [...document.querySelectorAll('button[aria-label]')].filter(one =>
            /[a-z]{2}/i.test(one.textContent) && !one.getAttribute('aria-label').toLowerCase().includes(
                one.textContent.toLowerCase())).map(one => one.textContent));
        check('names of buttons have their labels', spoken.length === 0, spoken.join());
        const bars = await page.evaluate(() => {
            const style = getComputedStyle(document.documentElement);
            const light = name => {
                const text = style.getPropertyValue(name).trim().slice(1);
                const parts = text.length === 3 ? [...text].map(x => x + x) : text.match(/../g);
                const [r, g, b] = parts.map(x => parseInt(x, 16) / 255).map(
                    x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
                return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
            };
            const [a, b] = [light('--bars'), light('--field')];
            return Math.max(a, b) / Math.min(a, b);
        });
        check('bars of the histogram stand out', bars >= 3, bars);
        await shot(page, `magnified_${colorScheme}`);
        await judged(page, colorScheme);
        const sections = on => page.evaluate(opens => document.querySelectorAll('details').forEach(each => {
            each.open = opens;
        }), on);
        await sections(true);
        await judged(page, 'all sections');
        await sections(false);
        await page.keyboard.press('?');
        await judged(page, 'Help');
        await shot(page, `help_${colorScheme}`);
        await page.keyboard.press('Escape');
        await page.waitForFunction(() => !document.activeElement.closest('dialog'));
        await page.keyboard.press('x');
        await slicesRest(page);
        await judged(page, 'slices');
        const ground = await page.evaluate(() => getComputedStyle(document.querySelector('figcaption')).backgroundColor);
        check('captions have a ground', /rgba\(0, 0, 0, 0\.8\)/.test(ground), ground);
        await shot(page, `magnified_slices_${colorScheme}`);
        await page.keyboard.press('x');
        await page.context().close();
    }
}

/** How many bars and colours of the editor a change draws; it is undone. */
const drawn = (page, change) => page.evaluate(changes => {
    const {recipe} = window.snowglass, {prototype} = CanvasRenderingContext2D, {fillRect} = prototype;
    let count = 0;
    prototype.fillRect = function fill(...box) {
        count += this.canvas.className === 'editor' ? 1 : 0;
        return fillRect.apply(this, box);
    };
    recipe.set(changes);
    prototype.fillRect = fillRect;
    recipe.undo();
    return count;
}, change);

async function costs(page) {
    const {azimuth = 0} = await keys(page);
    const points = await page.evaluate(() => window.snowglass.page.look.opacity);
    const turned = await drawn(page, {azimuth: azimuth + 1.5});
    check('a turn draws no histogram', turned === 0, turned);
    const moved = await drawn(page, {opacity: points.map(([value, opacity]) => [value, 0.9 * opacity])});
    check('a point that moves does', moved > 100, moved);
    check('nothing lies over the picture without slices', await page.locator('.over').isHidden());
    await rest(page);
}

async function editor(page) {
    const canvas = page.locator('.editor').first();
    const box = await canvas.boundingBox();
    const points = () => page.evaluate(() => window.snowglass.recipe.keys.opacity ??
        window.snowglass.page.look.opacity);
    const at = index => page.evaluate(i => {
        const look = document.querySelector('.editor');
        return look.dataset.points.split(' ').map(pair => pair.split(',').map(Number))[i];
    }, index);
    const before = await points();
    const [x, y] = await at(1);
    await settle(page, hold(page, [box.x + x, box.y + y], [box.x + x + 2, box.y + y - 30], {steps: 5}));
    let now = await points();
    check('a dragged point is more opaque', now[1][1] > before[1][1], JSON.stringify(now));
    const [px, py] = await at(1);
    await hold(page, [box.x + px, box.y + py], [box.x + px + 2, box.y + py - 30], {button: 'right', steps: 5});
    check('the right button drags no point', JSON.stringify(await points()) === JSON.stringify(now));
    await page.keyboard.press('Escape');
    await settle(page, page.mouse.dblclick(box.x + box.width / 2, box.y + 20));
    now = await points();
    check('a double click adds a point', now.length === before.length + 1, now.length);
    await page.getByLabel('value of the chosen point').fill('123');
    await press(page, 'Enter');
    check('which takes an exact number', (await points()).some(point => point[0] === 123));
    await settle(page, page.getByRole('button', {name: 'Remove the chosen point'}).click());
    check('and is removed', (await points()).length === before.length);
    await settle(page, hold(page, [box.x + 3, box.y + 12], [box.x + 33, box.y + 12], {steps: 4}));
    const moved = await points();
    check('a drag of empty ground moves all', moved[0][0] > now[0][0], JSON.stringify(moved));
    await shot(page, 'editor');
    await page.locator('summary', {hasText: 'Opacity by gradient'}).click();
    await settle(page, page.getByRole('button', {name: 'Add a point beside the chosen one'}).nth(1).click());
    check('opacity follows the gradient', (await keys(page))['gradient-opacity']?.length === 2);
    await shot(page, 'gradient');
    await page.getByRole('button', {name: 'The gradient does not matter'}).click();
    await page.locator('summary', {hasText: 'Opacity by gradient'}).click();
    await settle(page, page.getByRole('button', {name: /Opacity of the preset/}).click());
    check('and all is automatic again', !(await keys(page)).opacity);
}

/** Until all presets of the groups that are open have pictures. */
const thumbnails = page => page.waitForFunction(() => [...document.querySelectorAll('details[open] > div > .presets img')]
    .every(image => !image.hidden));

async function controls(page) {
    await drag(page, 60, 0, 'right');
    let now = await keys(page);
    check('a right drag sets the range', Array.isArray(now.range), JSON.stringify(now.range));
    const before = now.target;
    await drag(page, 50, 0, 'left', 'Shift');
    check('with Shift a drag moves the volume', String((await keys(page)).target) !== String(before));
    await settle(page, page.getByLabel('Mode', {exact: true}).selectOption('mip'));
    await shot(page, 'mip');
    await settle(page, page.getByLabel('Mode', {exact: true}).selectOption('iso'));
    now = await keys(page);
    check('mode iso has a value', now.mode === 'iso' && Number.isFinite(now.iso), now.iso);
    await page.getByLabel('Mode', {exact: true}).selectOption('over');
    await page.getByRole('button', {name: /Opacity of the preset/}).click();
    await page.locator('summary', {hasText: 'Clip'}).click();
    await settle(page, page.getByLabel(/clip .*highest/).and(page.locator('input')).first().fill('0'));
    check('a clip plane is set', (await keys(page)).clip?.length === 1,
        JSON.stringify((await keys(page)).clip));
    await shot(page, 'clip');
    await page.evaluate(() => window.snowglass.recipe.set({clip: [[1, 1, 0, 20]]}));
    await settle(page, page.getByLabel(/clip .*highest/).and(page.locator('input')).nth(1).fill('0'));
    const clip = (await keys(page)).clip;
    check('an oblique plane stays', clip?.length === 2 && clip[0][0] === 1 && clip[0][1] === 1,
        JSON.stringify(clip));
    await page.getByRole('button', {name: 'Remove all clip planes'}).click();
    await page.locator('summary', {hasText: 'Presets'}).click();
    await page.locator('details details summary', {hasText: 'CT'}).click();
    await thumbnails(page);
    await settle(page, page.locator('.presets button', {hasText: 'Bone'}).first().click());
    check('a preset is chosen', (await keys(page)).preset === 'ct-bone');
    await shot(page, 'presets');
    for (const key of ['1', '3', '6', 'ArrowLeft', 'ArrowUp', '+', '-', 'p', 'l', 'm', 'm']) {
        await page.keyboard.press(key);
        await rest(page);
    }
    await frameAll(page);
    now = await keys(page);
    check('keys work', now.view === 'inferior' && now.perspective > 0 && now['no-labels'] &&
        now.mode === 'minip', JSON.stringify(now));
}

/** Title, box and axes are in the picture, which is framed for them. */
async function marks(page) {
    await page.evaluate(() => document.querySelectorAll('details').forEach(each => {
        each.open = each.textContent.startsWith('Letters');
    }));
    await frameAll(page);
    const before = await keys(page);
    await enter(page.getByLabel('title of the picture'), 'Head, \u00b0C');
    await page.getByLabel('its axes, with numbers').check();
    await page.waitForFunction(zoom => window.snowglass.recipe.keys.zoom < zoom, before.zoom);
    await rest(page);
    const now = await keys(page);
    check('a title is in the recipe', now.title === 'Head, \u00b0C' && now.box === 'axes',
        JSON.stringify(now));
    check('the box is framed', now.zoom < 0.9 * before.zoom, now.zoom);
    await shot(page, 'marks');
    await page.getByLabel('its axes, with numbers').uncheck();
    await enter(page.getByLabel('title of the picture'), '');
    await page.waitForFunction(zoom => window.snowglass.recipe.keys.zoom === zoom, before.zoom);
    check('all is as before', !('title' in await keys(page)), '');
    await page.locator('.picture canvas').first().focus(); // where keys are commands
    await rest(page);
}

/** A pan follows the pointer also where the picture has another page's shape. */
async function letterboxed(page) {
    await page.evaluate(() => window.snowglass.recipe.apply({size: [300, 600]}));
    await rest(page);
    const [right, pixel] = await page.evaluate(() => {
        const {recipe: {keys: of}, page: {info}} = window.snowglass;
        const {clientHeight, clientWidth} = document.querySelector('.picture canvas');
        const wide = Math.min(clientWidth, clientHeight / 2);
        return [of.target, 2 * info.radius / (of.zoom * wide)];
    });
    await drag(page, 80, 0, 'left', 'Shift');
    const now = (await keys(page)).target;
    const moved = Math.hypot(...now.map((x, i) => x - right[i]));
    check('a pan follows the pointer in a letterbox', Math.abs(moved / (80 * pixel) - 1) < 0.05,
        moved / (80 * pixel));
}

/** One picture that cannot be decoded stops no other. */
async function damaged(page) {
    await page.evaluate(() => {
        const {createImageBitmap: good} = window;
        window.damaged = 3;
        window.createImageBitmap = (...given) => window.damaged-- > 0
            ? Promise.reject(new Error('damaged')) : good(...given);
    });
    while (await page.evaluate(() => window.damaged) > 0) {
        await page.keyboard.press('ArrowLeft');
        await page.waitForTimeout(200);
    }
    await press(page, 'ArrowLeft');
    check('after damaged pictures others are shown',
        await page.evaluate(() => document.querySelector('.picture canvas').dataset.level === '2'));
}

/** After a connection is lost the page has its window's size again. */
async function reconnected(page) {
    await page.evaluate(() => window.snowglass.engine.socket.close());
    await page.waitForFunction(() => window.snowglass.recipe.keys.size[0] > 300);
    await rest(page);
    check('a page that comes back has the size of its window',
        (await keys(page)).size[0] > 500, (await keys(page)).size);
}

/** Until all slices are those of their commands. */
const slicesRest = page => page.waitForFunction(() => window.snowglass.slices.panes.every(
    pane => pane.exact && !pane.busy && pane.file), null, SELDOM);

const crossing = page => page.evaluate(() => window.snowglass.slices.index);
const paneBox = (page, i) => page.locator('.pane canvas').nth(i).boundingBox();

/** Bytes of a picture of the page in base64, as numbers take a browser long. */
const bytesOf = (page, find) => page.evaluate(text => new Promise(done => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result.split(',')[1]);
    reader.readAsDataURL(Function('page', `return ${text}`)(window.snowglass));
}), find);

const keepBytes = async (page, name, find) =>
    writeFileSync(file(name), Buffer.from(await bytesOf(page, find), 'base64'));

/** Three slices, whose crosshairs move one another. */
async function slices(page, name = 'slices') {
    await page.keyboard.press('x');
    await slicesRest(page);
    await rest(page);
    const begin = await crossing(page), box = await paneBox(page, 0);
    await page.mouse.click(box.x + 0.3 * box.width, box.y + 0.4 * box.height);
    await slicesRest(page);
    const there = await crossing(page);
    check('a click in one slice moves the other two', there.filter((x, i) => x !== begin[i]).length === 2 &&
        there[2] === begin[2], `${begin} ${there}`);
    await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.4 * box.height);
    await wheel(page, 120);
    await slicesRest(page);
    const turned = await crossing(page);
    check('the wheel goes to another slice', Math.abs(turned[2] - begin[2]) === 2 &&
        turned[0] === there[0] && turned[1] === there[1], `${turned}`);
    const range = () => page.evaluate(() => window.snowglass.slices.keys.range);
    const before = await range();
    await page.mouse.down({button: 'right'});
    await page.mouse.move(box.x + 0.4 * box.width + 60, box.y + 0.4 * box.height, {steps: 5});
    await page.mouse.up({button: 'right'});
    await slicesRest(page);
    const now = await range();
    check('a right drag makes the window wider', now[1] - now[0] > 1.15 * (before[1] - before[0]) &&
        Math.abs(now[0] + now[1] - before[0] - before[1]) < 0.01 * (now[1] - now[0]), `${before} ${now}`);
    check('and leaves the look of the volume', !(await keys(page)).range);
    await page.keyboard.press('z');
    await slicesRest(page);
    check('which is undone', String(await range()) === String(before), `${await range()}`);
    await page.locator('.pane canvas').nth(1).focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('PageUp');
    await slicesRest(page);
    const keyed = await crossing(page);
    check('keys move the crosshair', keyed.filter((x, i) => Math.abs(x - turned[i]) === 1).length === 2,
        `${turned} ${keyed}`);
    await shot(page, name);
    await page.keyboard.press('c');
    writeFileSync(file('slice.txt'), await copied(page));
    await keepBytes(page, 'slice.png', 'page.slices.panes[1].file');
    await page.locator('.pane canvas').nth(1).focus();
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => !document.querySelector('.picture').clientWidth);
    const alone = await paneBox(page, 1);
    check('a slice stands alone', alone.width > 1.5 * box.width, alone.width);
    await page.mouse.move(alone.x + alone.width / 2, alone.y + alone.height / 2);
    await page.keyboard.down('Control');
    await wheel(page, -300);
    await page.keyboard.up('Control');
    await shot(page, `${name}_alone`);
    await page.keyboard.press('Enter');
    await page.waitForFunction(() => document.querySelector('.picture').clientWidth > 0);
    await rest(page);
    await awayAndBack(page);
    await page.getByRole('button', {name: 'The picture alone'}).click();
    check('and all are put away', await page.locator('.pane').count() === 0);
}

/** Slices that are put away while exact ones are awaited; keys of the browser;
 * many places at once; a narrow window at a large offset. */
async function awayAndBack(page) {
    await page.evaluate(async () => {
        const {slices} = window.snowglass, wait = ms => new Promise(done => setTimeout(done, ms));
        slices.goTo(slices.index.map(i => i + 1));
        while (slices.panes.some(pane => pane.busy))
            await wait(5);
        slices.toggle();
        await wait(400);
        slices.toggle();
    });
    check('slices that were put away come back', await slicesRest(page).then(() => true, () => false));
    await page.locator('.pane canvas').nth(1).focus();
    await page.keyboard.press('Control+c');
    check('Ctrl+C is the browser\'s', await page.locator('dialog[open]').count() === 0);
    const asked = await page.evaluate(() => {
        const {slices, engine} = window.snowglass, begin = slices.index;
        let count = 0;
        engine.say = message => {
            count += message.what === 'value';
            Object.getPrototypeOf(engine).say.call(engine, message);
        };
        for (let i = 1; i < 20; i++)
            slices.goTo([begin[0] - i, begin[1], begin[2]]);
        delete engine.say;
        return count;
    });
    check('one value is asked for at a time', asked === 1, asked);
    await slicesRest(page);
    const wide = await page.evaluate(() => {
        const {slices} = window.snowglass;
        slices.setWindow(2.7, 101326.5);
        const [low, high] = slices.keys.range;
        window.snowglass.recipe.undo();
        return high - low;
    });
    check('a narrow window keeps its width', Math.abs(wide - 2.7) < 1e-4, wide);
    await slicesRest(page);
}

/** Handles on the picture, a point to turn around, the light. */
async function handles(page) {
    await page.getByRole('button', {name: /All as it was/}).click();
    await page.locator('details', {has: page.locator('summary', {hasText: 'Clip'})})
        .evaluate(group => { group.open = false; });
    await press(page, 'k');
    const grips = page.locator('.handle:visible');
    await grips.nth(5).waitFor(); // the section says later that it is open
    check('six handles are on the picture', await grips.count() === 6, await grips.count());
    const grip = page.getByRole('slider', {name: /^clip .*highest/}).and(page.locator('.handle')).first();
    const box = await grip.boundingBox(), [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    const [mx] = await middle(page), by = x > mx ? -80 : 80;
    await page.mouse.move(x + by, y, {steps: 8});
    await page.mouse.up();
    await rest(page);
    const after = await grip.boundingBox(), clip = (await keys(page)).clip;
    check('a handle cuts', clip?.length === 1, JSON.stringify(clip));
    check('and stays under the pointer', Math.abs(after.x - box.x - by) < 3, after.x - box.x);
    await hold(page, [after.x + after.width / 2, after.y + after.height / 2], [x, y],
        {button: 'right', steps: 4});
    check('but not by the right button', String((await keys(page)).clip) === String(clip));
    await settle(page, page.getByRole('button', {name: /A plane that faces the viewer/}).click());
    check('a plane faces the viewer', await grips.count() === 7 && (await keys(page)).clip.length === 2);
    await drag(page, 90, 40);
    await shot(page, 'handles');
    const slider = page.getByRole('slider', {name: 'tilted clip plane 1'}).and(page.locator('input'));
    await settle(page, slider.fill('0.5'));
    const moved = (await keys(page)).clip[1];
    // A click is a step of its own, however soon it comes.
    await page.getByRole('button', {name: 'Remove tilted plane 1'}).click();
    await press(page, 'z');
    check('a tilted plane is moved, removed and back', String((await keys(page)).clip[1]) === String(moved) &&
        moved[3] !== clip[3], String(moved));
    await page.getByRole('button', {name: 'Remove all clip planes'}).click();
    await page.keyboard.press('k');
    await frameAll(page);
    for (const perspective of [0, 30]) {
        await page.evaluate(fov => window.snowglass.recipe.set({perspective: fov}), perspective);
        await rest(page);
        const before = (await keys(page)).target, [cx, cy] = await middle(page);
        await page.mouse.dblclick(cx - 60, cy + 30);
        await page.waitForFunction(was => String(window.snowglass.recipe.keys.target) !== was,
            String(before));
        await rest(page);
        const depth = await page.evaluate(() => new Promise(done => {
            const {engine} = window.snowglass, tell = engine.tell.bind(engine);
            engine.tell = (name, value) => name === 'depth' ? done(value.depth) : tell(name, value);
            engine.ask('depth', {x: 0.5, y: 0.5});
        }));
        const radius = await page.evaluate(() => window.snowglass.page.info.radius);
        check(`a double click turns around its point, at ${perspective} degrees`,
            Math.abs(depth) < 0.03 * radius, depth);
        await page.evaluate(() => delete window.snowglass.engine.tell);
    }
    await drag(page, 60, -30, 'left', 'Control');
    const {light} = await keys(page);
    check('a drag with Ctrl moves the light', light?.[0] > -25 && light?.[1] > 35, light);
    await shot(page, 'light');
}

/** A link restores the state, and two pages see each other's changes. */
async function together(page) {
    await page.getByRole('button', {name: 'Copy a link to this state'}).click();
    const link = await copied(page);
    const before = await keys(page);
    await press(page, '1');
    const other = await open({}, link);
    const now = await keys(other);
    check('a link restores the view', now.view === before.view && now.mode === before.mode,
        JSON.stringify(now));
    await other.keyboard.press('3');
    await page.waitForFunction(() => window.snowglass.recipe.keys.view === 'left');
    check('another page sees a change', true);
    await set(page, {colormap: 'hot'});
    await other.waitForFunction(() => window.snowglass.recipe.keys.colormap === 'hot');
    await press(other, 'ArrowLeft');
    const {azimuth} = await keys(other);
    await page.waitForFunction(at => window.snowglass.recipe.keys.azimuth === at, azimuth);
    await press(page, 'z');
    await page.waitForFunction(() => !window.snowglass.recipe.keys.colormap);
    check('undo takes back what this page did, and no turn of the other',
        (await keys(page)).azimuth === azimuth && (await keys(page)).view === 'left', JSON.stringify(await keys(page)));
    await other.context().close();
    await sizes(page);
    await small(page);
}

/** A page whose window is smaller turns, and each has its own picture in the end. */
async function sizes(page) {
    const small = await open({viewport: {width: 420, height: 500}});
    await press(small, 'ArrowRight');
    const shown = one => one.evaluate(() => {
        const {recipe: {keys: of}} = window.snowglass, {width, height, dataset} = document.querySelector('.picture canvas');
        return `${of.azimuth} ${of.size} ${width},${height} ${dataset.level}`;
    });
    const {azimuth} = await keys(small);
    for (const one of [page, small]) {
        await one.waitForFunction(at => window.snowglass.recipe.keys.azimuth === at && window.snowglass.page.rest, azimuth);
        const {size} = await keys(one);
        check('each window has a picture of its size', await shown(one) === `${azimuth} ${size} ${size} 2`, await shown(one));
    }
    check('which differ', String((await keys(page)).size) !== String((await keys(small)).size));
    await shot(page, 'larger');
    await shot(small, 'smaller');
    await small.context().close();
}

/** A draft of an eighth of the side fills the picture's box, and the line above says so. */
async function small(page) {
    const [width, height] = (await keys(page)).size;
    const canvas = await page.evaluate(([across, down]) => {
        const draft = new OffscreenCanvas(across, down), g = draft.getContext('2d');
        g.fillStyle = '#f00';
        g.fillRect(0, 0, across, down);
        g.fillStyle = '#00f';
        g.fillRect(across / 2, 0, across, down);
        window.snowglass.engine.tell('picture', {level: 0, width: across, height: down, render: 1, pack: 1,
            bytes: 1, bitmap: draft.transferToImageBitmap()});
        const {width, height} = document.querySelector('.picture canvas');
        return [width, height, ...window.snowglass.overlay.pointer.size];
    }, [width >> 3, height >> 3]);
    check('a small draft has a canvas of its size, and stands for the picture',
        String(canvas) === String([width >> 3, height >> 3, width, height]), `${canvas} of ${width},${height}`);
    const said = await page.locator('.level').textContent();
    check('which is said', said === 'draft, 1/8 size', said);
    const shown = await pixels(page, await page.locator('.picture canvas').first().screenshot(),
        [0, width / 2 - 5, width / 2 + 5, width - 1].map(x => [Math.floor(x), height >> 1]));
    check('it is enlarged to all of the box', String(shown) === '255,0,0,255,0,0,0,0,255,0,0,255', String(shown));
    await press(page, 'ArrowRight');
    check('the picture at rest has all its pixels', String(await page.evaluate(() => {
        const {width, height} = document.querySelector('.picture canvas');
        return [width, height];
    })) === String([width, height]));
}

/** Red, green and blue of some pixels of a screenshot. */
function pixels(page, png, places) {
    return page.evaluate(async ([bytes, places]) => {
        const image = await createImageBitmap(new Blob([Uint8Array.from(atob(bytes), c => c.charCodeAt(0))]));
        const g = new OffscreenCanvas(image.width, image.height).getContext('2d', {willReadFrequently: true});
        g.drawImage(image, 0, 0);
        return places.flatMap(([x, y]) => [...g.getImageData(x, y, 1, 1).data].slice(0, 3));
    }, [png.toString('base64'), places]);
}

async function touch() {
    const page = await open({viewport: {width: 400, height: 700}, hasTouch: true});
    const before = await keys(page), hand = await Hand.of(page), [x, y] = await middle(page);
    await hand.drag([x, y], [x + 50, y]);
    let now = await keys(page);
    check('one finger turns', now.azimuth < before.azimuth, now.azimuth);
    await hand.zoom(x, y);
    now = await keys(page);
    check('two fingers zoom', now.zoom > 1.5 * before.zoom, now.zoom);
    await shot(page, 'touch');
    await page.evaluate(() => window.snowglass.page.say('A note that covers the picture.'));
    await page.touchscreen.tap(x, y);
    check('a tap on the picture takes a note away', await page.locator('.said').textContent() === '');
    await page.keyboard.press('x');
    await slicesRest(page);
    check('captions of narrow slices are whole', await page.evaluate(() => [...document.querySelectorAll(
        'figcaption')].every(one => one.textContent && one.scrollWidth <= one.clientWidth)));
    await shot(page, 'touch-slices');
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    check('nothing is wider than the window', wide <= 400, wide);
    await page.context().close();
}

async function schemes(page0) {
    await page0.getByRole('button', {name: /All as it was/}).click();
    await rest(page0);
    check('all can be reset', (await keys(page0)).mode === 'over');
    const page = await open({viewport: {width: 500, height: 400}, deviceScaleFactor: 2, colorScheme: 'dark'});
    await shot(page, 'dark');
    check('a dense screen gets more pixels', (await keys(page)).size[0] > 700);
    await page.evaluate(() => window.snowglass.engine.set({mask: '/etc/passwd'}));
    await page.waitForFunction(() => /Left out.*mask/.test(
        document.querySelector('.said').textContent));
    check('a key that is left out is told', true);
    await page.context().close();
}

/** A proxy that puts a prefix before every path, as portals do. */
async function prefixed() {
    const {port, hash} = new URL(part().url);
    const prefix = '/node/n17/8000';
    const headers = given => ({...given, host: `127.0.0.1:${port}`});
    const proxy = createServer((asked, answer) => {
        const passed = request({port, path: asked.url.slice(prefix.length), method: asked.method,
            headers: headers(asked.headers)}, got => {
            answer.writeHead(got.statusCode, got.headers);
            got.pipe(answer);
        });
        asked.pipe(passed);
    });
    proxy.on('upgrade', (asked, socket) => {
        const inner = connect(port, '127.0.0.1', () => {
            const lines = Object.entries({...headers(asked.headers), origin: `http://127.0.0.1:${port}`})
                .map(([name, value]) => `${name}: ${value}`);
            inner.write(`GET ${asked.url.slice(prefix.length)} HTTP/1.1\r\n${lines.join('\r\n')}\r\n\r\n`);
            inner.pipe(socket).pipe(inner);
        });
        inner.on('error', () => socket.destroy());
        socket.on('error', () => inner.destroy());
    });
    await new Promise(resolve => proxy.listen(0, '127.0.0.1', resolve));
    const page = await open({}, `http://127.0.0.1:${proxy.address().port}${prefix}/${hash}`);
    check('behind a prefix the page works', true);
    await page.context().close();
    proxy.closeAllConnections();
    proxy.close();
}

/** What a user does with fingers, and how many times: each tap, drag, zoom, key, and
 * each scrolling of a window that is too small. */
class Hand {
    static async of(page) {
        const hand = new Hand();
        return Object.assign(hand, {page, count: 0, session: await page.context().newCDPSession(page)});
    }

    send(type, points) {
        return this.session.send('Input.dispatchTouchEvent', {type,
            touchPoints: points.map(([x, y], id) => ({x, y, id}))});
    }

    /** Brings an element into the window. */
    async reach(locator) {
        const box = await locator.boundingBox(), {height} = this.page.viewportSize();
        const beyond = Math.max(-box.y, box.y + Math.min(box.height, height) - height, 0);
        this.count += Math.ceil(beyond / (0.8 * height));
        await locator.scrollIntoViewIfNeeded();
    }

    async press(locator) {
        await this.reach(locator);
        this.count++;
        await locator.tap({trial: true}); // it can be tapped
        const {x, y, width, height} = await locator.boundingBox();
        await this.tap('click', 1, x + width / 2, y + height / 2);
        await rest(this.page);
    }

    /** Taps until the page has its event: on a busy machine Chromium may take a tap for a
     * long one, or two for single ones.  Its end and the next begin wait for no answer. */
    async tap(name, times, x, y) {
        for (let came = false; !came;) {
            await this.page.evaluate(event => {
                window.tapped = new Promise(done => {
                    addEventListener('pointerup', () => setTimeout(() => done(false), 2000), {once: true, capture: true});
                    addEventListener(event, () => done(true), {once: true, capture: true});
                });
            }, name);
            await Promise.all(Array.from({length: 2 * times}, (_, i) =>
                i % 2 ? this.send('touchEnd', []) : this.send('touchStart', [[x, y]])));
            came = await this.page.evaluate(() => window.tapped);
        }
    }

    async choose(label, value) {
        const list = this.page.getByLabel(label);
        await this.reach(list);
        this.count += 2;
        await list.selectOption(value);
        await rest(this.page);
    }

    async key(name) {
        this.count++;
        await this.page.keyboard.press(name);
        await rest(this.page);
    }

    async drag([x, y], [toX, toY]) {
        this.count++;
        const at = i => [x + (toX - x) * i / 8, y + (toY - y) * i / 8];
        await after(this.page, 'pointerup', 1, async () => {
            await this.send('touchStart', [[x, y]]);
            for (let i = 1; i <= 8; i++)
                await this.send('touchMove', [at(i)]);
            await this.send('touchEnd', []);
        });
        await rest(this.page);
    }

    async twice(x, y) {
        this.count++;
        await this.tap('dblclick', 2, x, y);
        await rest(this.page);
    }

    /** About twice as near: fingers go apart. */
    async zoom(x, y) {
        this.count++;
        await after(this.page, 'pointerup', 2, async () => {
            await this.send('touchStart', [[x - 30, y], [x + 30, y]]);
            for (let i = 1; i <= 8; i++)
                await this.send('touchMove', [[x - 30 - 5 * i, y], [x + 30 + 5 * i, y]]);
            await this.send('touchEnd', []);
        });
        await rest(this.page);
    }
}

/** A practised user needs about a second for an action, and 10 s for a step at most. */
const ACTIONS_MOST = 8;

/** A radiologist's way: bone, a joint, window and level, a cut, slices, the command. */
async function film() {
    const page = await open({viewport: {width: 400, height: 700}, hasTouch: true, colorScheme: 'light'});
    const hand = await Hand.of(page);
    const canvas = page.locator('.picture canvas').first();
    const step = async what => {
        await shot(page, `film_${what}`);
        console.log(`       ${what}: ${hand.count} actions`);
        check(`${what} takes few actions`, hand.count <= ACTIONS_MOST, hand.count);
        hand.count = 0;
    };
    const seen = async what => {
        await rest(page);
        await hand.reach(canvas);
        await step(what);
    };
    const at = async (right, down) => { // shares of the shorter side, from the middle
        const box = await canvas.boundingBox(), side = Math.min(box.width, box.height);
        return [box.x + box.width / 2 + right * side, box.y + box.height / 2 + down * side];
    };
    const keep = async (what, button) => {
        await hand.press(button);
        await page.waitForSelector('dialog[open] textarea');
        writeFileSync(file(`${what}.txt`), await page.locator('dialog textarea').inputValue());
    };
    await seen('1_opened');
    const presets = page.locator('summary', {hasText: 'Presets'});
    await hand.press(presets);
    await thumbnails(page);
    await step('2_presets');
    await hand.press(page.locator('.presets button', {hasText: 'Bone'}).first());
    check('bone is seen', (await keys(page)).preset === 'ct-bone');
    await hand.press(presets);
    await seen('3_bone');
    const clips = page.locator('summary', {hasText: 'Clip'});
    await hand.press(clips);
    await hand.reach(canvas);
    const boxes = await Promise.all((await page.locator('.handle:visible').all()).map(one => one.boundingBox()));
    const low = boxes.reduce((a, b) => a.y > b.y ? a : b); // behind the table
    const from = [low.x + low.width / 2, low.y + low.height / 2];
    await hand.drag(from, [from[0], (await at(0, 0.22))[1]]);
    check('the table is cut away', (await keys(page)).clip?.length === 1);
    await seen('4_cut');
    await hand.press(clips);
    await hand.reach(canvas);
    const whole = await keys(page);
    await answered(page, 'depth', async () => hand.twice(...await at(0, 0.13)));
    await hand.zoom(...await at(0, 0));
    await hand.zoom(...await at(0, 0));
    const near = await keys(page);
    check('a joint is in the middle, and near', near.zoom > 3 * whole.zoom &&
        String(near.target) !== String(whole.target), near.zoom);
    await seen('5_joint');
    const range = () => page.evaluate(() => [window.snowglass.page.look.low, window.snowglass.page.look.high]);
    const before = await range();
    await hand.choose('Drag', 'window');
    await hand.reach(canvas);
    const [x, y] = await at(0, 0);
    await hand.drag([x, y], [x + 40, y - 20]);
    const now = await range();
    check('a drag sets window and level', now[1] - now[0] > 1.1 * (before[1] - before[0]) &&
        now[0] + now[1] > before[0] + before[1], `${before} ${now}`);
    await seen('6_window');
    await hand.choose('Drag', 'turn');
    await hand.reach(canvas);
    await hand.drag(await at(0, 0), await at(0.1, 0.15));
    check('it is turned', (await keys(page)).elevation !== near.elevation);
    await seen('7_turned');
    await hand.press(page.getByRole('button', {name: 'Three slices beside the picture'}));
    await slicesRest(page);
    const begin = await crossing(page);
    await hand.reach(canvas);
    await answered(page, 'depth', async () => hand.twice(...await at(0, 0)));
    await slicesRest(page);
    check('slices go to the joint', String(await crossing(page)) !== String(begin), begin);
    await seen('8_slices');
    const more = page.locator('summary', {hasText: 'Slices'});
    await hand.press(more);
    await hand.choose(/^Window/, 'bone');
    await slicesRest(page);
    check('slices have the window of bone', String(await page.evaluate(() =>
        window.snowglass.slices.keys.range)) === '-500,1300');
    const one = page.getByRole('button', {name: 'This slice alone, or all (Enter)'}).first();
    await hand.press(one);
    await slicesRest(page);
    await step('9_alone');
    await hand.press(one);
    await slicesRest(page);
    await keepBytes(page, 'slice.png', 'page.slices.panes[0].file');
    await keep('slice', page.getByRole('button', {name: /The command that makes the slice/}).first());
    await step('10_slice_command');
    await hand.key('Escape');
    await hand.press(more);
    await keep('command', page.getByRole('button', {name: /^Copy the command that makes this/}));
    await step('11_command');
    await hand.key('Escape');
    const coming = page.waitForEvent('download');
    await hand.press(page.getByRole('button', {name: /^Save the picture/}));
    await (await coming).saveAs(file('rest.png'));
    await hand.press(page.getByRole('button', {name: /All as it was/}));
    await seen('12_reset');
    await page.context().close();
}

/** Before the server has said anything nothing can be pressed, and nothing throws. */
async function unready() {
    const context = await browser.newContext(), {said, url} = part();
    const page = await context.newPage();
    page.on('pageerror', error => said.push(String(error)));
    await page.addInitScript(() => {
        window.WebSocket = class {
            static OPEN = 1;
        };
    });
    await page.goto(url);
    await page.waitForSelector('.bottom button');
    const enabled = await page.locator('.bottom button:enabled').count();
    check('buttons wait for the volume', enabled === 0, enabled);
    for (const key of ['m', 'c', 'p', ' '])
        await page.keyboard.press(key);
    await page.mouse.click(200, 200);
    await page.mouse.click(200, 200, {button: 'right'});
    await context.close();
}

/** In a frame of the origin that may, the viewer works; in another's it is not shown. */
async function embedded() {
    const context = await browser.newContext(), page = await context.newPage();
    page.setDefaultTimeout(PATIENCE);
    const {url, words: [may, mayNot]} = part();
    await page.goto(`${may}/?${encodeURIComponent(url)}`);
    const frame = page.frames()[1];
    await frame.waitForFunction(() => window.snowglass?.page.rest);
    await frame.getByRole('button', {name: /^View from/}).first().click();
    await frame.waitForFunction(() => window.snowglass.page.rest && window.snowglass.recipe.keys.view);
    check('in a frame of one origin the viewer works', true);
    const refused = page.waitForEvent('console', line => /frame-ancestors/.test(line.text()));
    await page.goto(`${mayNot}/?${encodeURIComponent(url)}`);
    check('another may not show it', (await refused).text().includes(may), (await refused).text());
    check('and does not', !await page.frames()[1].evaluate(() => Boolean(window.snowglass)).catch(() => false));
    await context.close();
}

/** A look of more points than a recipe holds is shown, and not changed. */
async function manyPoints() {
    const page = await open();
    const box = await page.locator('.editor').first().boundingBox();
    await hold(page, [box.x + 3, box.y + 12], [box.x + 33, box.y + 12], {steps: 4});
    check('it is told that they are too many', /too many/.test(
        await page.locator('.said').textContent()));
    check('and none is changed', !(await keys(page)).opacity);
    await drag(page, 0, -40, 'right', 'Control');
    check('nor faded', !(await keys(page)).opacity);
    await shot(page, 'points');
    await page.context().close();
}

/** Labels of the command line come back with the mask, in a page too that was
 * loaded without it. */
async function masked() {
    const page = await open();
    const flip = async () => {
        await settle(page, page.getByLabel('only what the mask keeps').evaluate(box => box.click()));
    };
    const {labels} = await keys(page);
    await flip();
    let now = await keys(page);
    check('a mask is switched off with its labels', labels && !now.mask && !now.labels, now.labels);
    await settle(page, page.reload());
    await flip();
    now = await keys(page);
    check('and on with them', now.mask && now.labels === labels, now.labels);
    await page.context().close();
}

/** What is at rest, for the copied commands: the picture and a slice. */
async function keepBoth(page) {
    await slicesRest(page);
    await rest(page);
    await keepBytes(page, 'rest.png', 'page.page.rest');
    await keepBytes(page, 'slice.png', 'page.slices.panes[0].file');
    await page.evaluate(() => window.snowglass.slices.command(window.snowglass.slices.panes[0]));
    writeFileSync(file('slice.txt'), await copied(page));
    await page.getByRole('button', {name: /^Copy the command that makes this/}).click();
    const command = await copied(page);
    writeFileSync(file('command.txt'), command);
    return command;
}

/** A segmentation in the volume and in its slices: labels by name. */
async function overlaid() {
    const page = await open();
    await page.keyboard.press('x');
    await slicesRest(page);
    const sliced = async () => {
        await slicesRest(page);
        return bytesOf(page, 'page.slices.panes[0].file');
    };
    const becomes = async bytes => { // the viewer's answer comes after the picture
        for (let n = 0; n < 50 && await sliced() !== bytes; n++)
            await page.waitForTimeout(100);
        return await sliced() === bytes;
    };
    const both = await sliced();
    await settle(page, page.getByLabel('right', {exact: true}).uncheck());
    const one = await sliced();
    let now = await keys(page);
    check('a label is switched off', now.overlay === true &&
        now['overlay-look'] === '1:0.5,2:0', now['overlay-look']);
    check('in slices too', one !== both);
    await page.waitForTimeout(TOGETHER);
    await settle(page, page.getByLabel('colour of left').fill('#00ff00'));
    now = await keys(page);
    check('a label of an overlay has a colour', now['overlay-look'] === 'labels,1:#00ff00,1:0.5,2:0', JSON.stringify(now));
    await shot(page, 'overlay');
    const green = await sliced();
    check('and in slices', green !== one);
    await page.locator('.picture canvas').first().focus();
    await press(page, 'z');
    check('that is undone', await becomes(one));
    await press(page, 'Z');
    check('and done again', await becomes(green));
    await set(page, {clip: [[1, 0, 0, 0]]});
    check('slices show what clip planes cut', await sliced() === green);
    const command = await keepBoth(page);
    check('the command has the overlay', command.includes('--overlay-look'), command);
    await set(page, {clip: null, mode: 'mip'});
    check('a projection has slices with it', await sliced() === green);
    await page.evaluate(() => window.snowglass.recipe.set({mode: null}));
    await settle(page, page.getByLabel('seg.nrrd').uncheck());
    const none = await sliced();
    check('the overlay is switched off', !(await keys(page)).overlay && none !== green && none !== both);
    await settle(page, page.getByLabel('seg.nrrd').check());
    check('and on again', await sliced() === green);
    await page.context().close();
}

/** Chooses a file with *Open*. */
async function choose(page, name, text) {
    const coming = page.waitForEvent('filechooser');
    await page.getByRole('button', {name: /^Open a recipe/}).click();
    await (await coming).setFiles({name, mimeType: 'application/json', buffer: Buffer.from(text)});
}

/** A recipe's file, as *Recipe* saves it, is the state again; others are refused by a line. */
async function recipes() {
    const page = await open();
    const line = async name => {
        await page.waitForFunction(text => document.querySelector('.said').textContent.includes(text), name);
        return page.locator('.said').textContent();
    };
    await set(page, {azimuth: 30, preset: 'ct-bone', legend: true});
    const picture = await bytesOf(page, 'page.page.rest');
    const coming = page.waitForEvent('download');
    await page.getByRole('button', {name: /^Save the recipe/}).click();
    const text = readFileSync(await (await coming).path(), 'utf8');
    await settle(page, page.getByRole('button', {name: /All as it was/}).click());
    const before = await keys(page);
    await choose(page, 'state.json', text);
    await page.waitForFunction(() => window.snowglass.recipe.keys.azimuth === 30);
    await rest(page);
    check('a recipe that was saved is opened', await bytesOf(page, 'page.page.rest') === picture,
        JSON.stringify(await keys(page)));
    await press(page, 'z');
    check('which is one step', JSON.stringify((await keys(page)).azimuth) === JSON.stringify(before.azimuth) &&
        !(await keys(page)).legend, JSON.stringify(await keys(page)));
    await page.evaluate(recipe => {
        const data = new DataTransfer();
        data.items.add(new File([recipe], 'other.json'));
        document.body.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true, cancelable: true}));
    }, '{"input": "far/away.nii", "roll": 20, "method": "raycast"}');
    const said = await line('away.nii');
    await rest(page);
    check('one of another volume is dropped, and says so', (await keys(page)).roll === 20, said);
    await shot(page, 'recipe');
    await choose(page, 'points.json', '{"snowglass-tf": 1}');
    check('what is no recipe is refused', /points\.json is no recipe/.test(await line('points.json')));
    await choose(page, 'cut.json', '{"roll": 2');
    check('and what is no JSON', /cut\.json is no recipe/.test(await line('cut.json')));
    await choose(page, 'wrong.json', '{"roll": 7, "preset": "bone"}');
    check('a wrong value is named', /preset/.test(await line('preset')));
    await page.waitForFunction(() => !window.snowglass.recipe.keys.preset); // and left out
    check('and the others are taken', (await keys(page)).roll === 7);
    await page.context().close();
    await links();
    const other = await open();
    await keyboard(other);
    await other.context().close();
}

/** Of a link all is taken that is understood. */
async function links() {
    const link = recipe => `${part().url}&recipe=${encodeURIComponent(JSON.stringify(recipe))}`;
    const page = await open({}, link({azimuth: 33, colour: 'red', slices: {at: 1}, target: 'x', mode: 'mop', zoom: 2,
        toString: 1}));
    await page.waitForFunction(() => !window.snowglass.recipe.keys.mode);
    const now = await keys(page);
    check('a link is taken but for what is wrong', now.azimuth === 33 && now.zoom === 2 && !now.slices &&
        now.target !== 'x', JSON.stringify(now));
    await page.context().close();
    const other = await open({}, link({roll: 5, colour: 'red', slices: 5}));
    check('which is named', /colour, slices/.test(await other.locator('.said').textContent()),
        await other.locator('.said').textContent());
    check('the rest stands', (await keys(other)).roll === 5);
    await other.context().close();
}

/** A segmentation alone: its labels take colours, which command and link have. */
async function labelled() {
    const page = await open();
    await settle(page, page.getByLabel('colour of right').fill('#2040ff'));
    await settle(page, page.getByLabel('colour of left').fill('#ffee00'));
    const now = await keys(page);
    check('labels have colours', now.preset === 'labels' && now.colormap === '1:#ffee00,2:#2040ff',
        JSON.stringify(now));
    check('which the look has', await page.evaluate(() => String(window.snowglass.page.look.labels
        .map(([, , color]) => color))) === '#ffee00,#2040ff');
    await page.locator('.picture canvas').first().focus();
    await page.keyboard.press('x');
    await slicesRest(page);
    await page.getByLabel('in the colours of the look').evaluate(box => box.click());
    await keepBoth(page);
    await shot(page, 'labels');
    await page.getByRole('button', {name: /^Copy a link/}).click();
    const link = await copied(page);
    const painted = await bytesOf(page, 'page.page.rest');
    await settle(page, page.getByLabel('Colours', {exact: true}).first().selectOption('viridis'));
    check('a map is of values', await page.evaluate(() => window.snowglass.page.look.labels.length === 0));
    await settle(page, page.getByRole('button', {name: /All as it was/}).click());
    check('their own colours come back', !(await keys(page)).colormap &&
        await bytesOf(page, 'page.page.rest') !== painted);
    await page.context().close();
    const linked = await open({}, link);
    await slicesRest(linked);
    await rest(linked);
    check('a link has them', await bytesOf(linked, 'page.page.rest') === painted);
    await linked.context().close();
}

/** A volume of values over another: its colours, range and opacity. */
async function fused() {
    const page = await open({viewport: {width: 1200, height: 700}});
    await page.keyboard.press('x');
    await slicesRest(page);
    await enter(page.getByLabel('highest value of the range of the overlay'), '150');
    await settle(page, page.getByRole('slider', {name: 'opacity of the overlay'}).fill('0.8'));
    await page.locator('details', {has: page.locator('summary', {hasText: 'Overlay'})})
        .getByLabel('Colours', {exact: true}).selectOption('viridis');
    await page.locator('summary', {hasText: 'Colours'}).click();
    await page.getByLabel('colour 2', {exact: true}).fill('#ff2040');
    await enter(page.getByLabel('value of colour 2'), '77');
    await page.getByRole('button', {name: 'Remove colour 1', exact: true}).click();
    await page.getByRole('button', {name: 'Add a colour'}).click();
    await settle(page, page.getByLabel('in the colours of the look').evaluate(box => box.click()));
    const map = (await keys(page)).colormap;
    check('colours are chosen', /^77:#ff2040(,[\d.]+:#[\da-f]{6}){4}$/.test(map), map);
    await page.getByLabel('highest value of the range', {exact: true}).fill('200');
    await press(page, 'Enter');
    check('and go with the range', /^77:#ff2040.*,200:#[\da-f]{6}$/.test((await keys(page)).colormap),
        (await keys(page)).colormap);
    const command = await keepBoth(page), now = await keys(page);
    check('an overlay of values has a look', /^viridis,[^,]+,150,[^,]+:0,150:0.8$/.test(now['overlay-look']),
    now['overlay-look']);
    check('which the command has', /--overlay-look viridis,/.test(command), command);
    await shot(page, 'fused');
    await set(page, {colormap: null, range: [100000, 100001]});
    await page.locator('details', {has: page.locator('summary', {hasText: 'Look'})})
        .getByLabel('Colours', {exact: true}).selectOption(':');
    await rest(page);
    const near = (await keys(page)).colormap.split(',').map(part => part.split(':')[0]).join();
    check('colours of a narrow range are apart', near === '100000,100000.25,100000.5,100000.75,100001',
        near);
    await page.locator('details', {has: page.locator('summary', {hasText: 'Overlay'})})
        .getByRole('button', {name: /Opacity of the preset/}).click();
    await rest(page);
    check('and loses', (await keys(page))['overlay-look'] === 'viridis');
    await page.context().close();
}

/** Channels are switched, coloured, windowed; a preset shows one of them. */
async function mixed() {
    const page = await open({viewport: {width: 1200, height: 700}});
    const list = async () => (await keys(page)).channel ?? '';
    const section = page.locator('details', {has: page.locator('summary', {hasText: 'Channels'})});
    const rowOf = name => section.getByLabel(name, {exact: true});
    check('all channels are drawn', await rowOf('DAPI').isChecked() && await rowOf('GFP').isChecked() &&
        await rowOf('Cy5').isChecked() && !await list(), await list());
    check('no transfer function is in their place', !await page.locator('.editor').first().isVisible());
    await automatic(tools, page);
    await page.keyboard.press('x');
    await slicesRest(page);
    await page.getByLabel('in the colours of the look').evaluate(box => box.click());
    await slicesRest(page);
    await shot(page, 'channels');
    await settle(page, rowOf('GFP').uncheck());
    check('one is switched off', /^0:#4d4dff:20\.\.900:1,2:#ff8000:20\.\.900:1$/.test(await list()), await list());
    await settle(page, rowOf('GFP').check());
    check('and on again, as it was', (await list()).endsWith(',1:green:20..900:1'), await list());
    await section.getByLabel('colour of Cy5').fill('#ff00c0');
    await enter(section.getByLabel('highest value of the range of DAPI'), '700');
    await settle(page, section.getByRole('slider', {name: 'opacity of GFP'}).fill('0.5'));
    check('colour, range and opacity are taken', (await list()).split(',').sort().join() ===
        '0:#4d4dff:20..700:1,1:green:20..900:0.5,2:#ff00c0:20..900:1', await list());
    const ranges = await list();
    await enter(section.getByLabel('lowest value of the range of DAPI'), '800');
    await section.getByLabel('highest value of the range of GFP').fill('20');
    await press(page, 'Enter');
    check('a range with nothing in it is not taken', await list() === ranges, await list());
    await drag(page, 0, -60, 'right');
    const before = await list();
    check('a right drag moves all ranges', /^0:#4d4dff:8\d\.\d*\.\.7\d\d/.test(before), before);
    await drag(page, 0, 80, 'right', 'Control');
    check('and with Ctrl all opacities', /:0\.257$/.test(await list()), await list());
    await press(page, 'z');
    check('a drag is undone', await list() === before, await list());
    const command = await keepBoth(page);
    check('the command has the list', command.includes(`--channel ${before.replace(/:1(?=,|$)/g, '')}`),
        `${command} ${before}`);
    await page.locator('summary', {hasText: 'Presets'}).click();
    await page.locator('details details summary', {hasText: 'General'}).click();
    await settle(page, page.getByRole('button', {name: /^Grey ramp/}).click());
    check('a preset shows one', await list() === '0' && !await rowOf('GFP').isChecked() &&
        await page.locator('.editor').first().isVisible(), await list());
    await settle(page, rowOf('Cy5').check());
    check('another makes them two', /^0,2:#ff00c0/.test(await list()) && !('preset' in await keys(page)),
        await list());
    await settle(page, rowOf('Cy5').uncheck());
    await rowOf('DAPI').click();
    check('the last one stays', await rowOf('DAPI').isChecked(), await list());
    await settle(page, section.getByRole('button', {name: /^All channels/}).click());
    check('all are back', !await list() && await rowOf('Cy5').isChecked(), await list());
    await page.setViewportSize({width: 400, height: 700});
    await rest(page);
    await shot(page, 'channels-small');
    await page.context().close();
}

/** A component, or a file of a look, of the command line gives way to channels. */
async function begun() {
    const page = await open();
    const rowOf = name => page.locator('details', {has: page.locator('summary', {hasText: 'Channels'})})
        .getByLabel(name, {exact: true});
    const drawn = () => page.evaluate(() => window.snowglass.page.look.channels.filter(one => one[2]).length);
    await settle(page, rowOf('Cy5').check());
    check('two are drawn', await drawn() === 2, JSON.stringify(await keys(page)));
    await settle(page, page.getByRole('button', {name: /^All channels/}).click());
    check('all are drawn', await drawn() === 3, JSON.stringify(await keys(page)));
    check('without the component', !('component' in await keys(page)));
    await page.context().close();
}

/** Of a file that shows one channel *All* shows all. */
async function plainChannels() {
    const page = await open();
    const drawn = () => page.evaluate(() => window.snowglass.page.look.channels.length);
    check('a file shows one channel', await drawn() === 1, await drawn());
    const all = page.getByRole('button', {name: /^All channels/});
    await settle(page, all.click());
    check('all are shown when they are asked for', await drawn() === 3, await drawn());
    await press(page, 'z');
    check('which is undone', await drawn() === 1, await drawn());
    await set(page, {channel: '1'});
    await all.click();
    await page.waitForFunction(() => window.snowglass.page.look.channels.length === 3);
    check('from another one too', true);
    const said = await page.evaluate(() => {
        window.snowglass.engine.tell('said', {text: 'give --channel N, or --range 0,1'});
        return document.querySelector('.said').textContent;
    });
    check('lines speak of the page', said === 'give Channels, or Range 0,1', said);
    const {radius} = await page.evaluate(() => window.snowglass.page.info);
    await page.keyboard.press('x');
    await slicesRest(page);
    await settle(page, enter(page.getByLabel('height, a factor'), '3'));
    await page.waitForFunction(was => window.snowglass.page.info.radius > 1.2 * was, radius);
    const command = await keepBoth(page);
    check('the height is stretched', command.includes('--z-scale 3'), command);
    await page.context().close();
}

/** Of more channels than are mixed, *All* takes the first ones. */
async function many() {
    const page = await open();
    const section = page.locator('details', {has: page.locator('summary', {hasText: 'Channels'})});
    const boxes = section.getByRole('checkbox');
    const on = async () => Promise.all((await boxes.all()).map(async box => Number(await box.isChecked())));
    check('each channel has a box', await boxes.count() === 10, await boxes.count());
    await settle(page, section.getByRole('button', {name: /^All channels/}).click());
    const list = (await keys(page)).channel;
    check('eight are drawn', list === '0,1,2,3,4,5,6,7' && String(await on()) === '1,1,1,1,1,1,1,1,0,0',
        `${list} ${await on()}`);
    await page.evaluate(() => { document.querySelector('.said').textContent = ''; });
    await section.getByLabel('channel 8', {exact: true}).click();
    await page.waitForFunction(() => /up to 8/.test(document.querySelector('.said').textContent));
    await rest(page);
    check('a ninth is refused with what to do', true);
    check('and its box is as the picture', String(await on()) === '1,1,1,1,1,1,1,1,0,0', String(await on()));
    await settle(page, section.getByLabel('dye 3', {exact: true}).click());
    await settle(page, section.getByLabel('channel 8', {exact: true}).click());
    check('but takes the place of another', String(await on()) === '1,1,1,0,1,1,1,1,1,0', String(await on()));
    await page.locator('.picture canvas').first().focus();
    await page.keyboard.press('x');
    await page.getByLabel('in the colours of the look').evaluate(box => box.click());
    await keepBoth(page);
    await shot(page, 'many');
    await page.context().close();
}

/** What the short tier looks at. */
async function first() {
    await unready();
    const page = await open();
    await smoke(page);
    await names(page);
    await costs(page);
    return page;
}

async function all() {
    const page = await first();
    for (const look of [letterboxed, reconnected, damaged, editor, controls])
        await look(page);
    await page.context().close();
}

async function more() {
    const page = await open();
    for (const look of [marks, slices, handles, together, touch, schemes, prefixed, readable])
        await look(page);
    await page.context().close();
}

const tools = {accessible: page => judged(page, 'with the axis near'), answered, check, copied, file, folder, judged, keepBytes, keys, open, shot, part, rest, slicesRest, wheel};
const known = {short: first, long: all, more, film, steps: () => steps(tools),
    restarted: () => restarted(tools), asked: () => asked(tools), measures: () => measures(tools), layouts: () => layouts(tools), transfer: () => transfer(tools), folder: () => listed(tools), reopened: () => reopened(tools), movies: () => movies(tools), embed: embedded, points: manyPoints, mask: masked,
    overlay: overlaid, labels: labelled, recipes, fused, channels: mixed, plain: plainChannels, begun, many};

async function run() {
    const {name, said} = part();
    await known[name]().catch(error => check('all of it', false, error.stack));
    check('nothing is on the console, nor against the policy', said.length === 0, said.join(' | '));
}

async function lane() {
    while (parts.length) {
        const [name, url, ...words] = parts.shift().split(',');
        await running.run({name, url, words, said: []}, run);
    }
}

await Promise.all(Array.from({length: LANES}, lane));
await browser.close();
process.exit(wrong ? 1 : 0);
