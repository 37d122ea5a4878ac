// tests/serve/web/everyday.mjs - what users do most, control by control: viewer.mjs
// starts these with what it drives a page by.
import {spawn} from 'node:child_process';
import {once} from 'node:events';
import {readFileSync, renameSync, unlinkSync} from 'node:fs';
import {createInterface} from 'node:readline';

/** The keys of the recipe after an action, and only those that are wanted; undefined
 * is wanted of one that is to be gone. */
async function sets({check, keys, rest}, page, name, act, want) {
    await act();
    await rest(page);
    const now = await keys(page);
    const got = JSON.stringify(Object.fromEntries(Object.keys(want).map(key => [key, now[key]])));
    check(name, got === JSON.stringify(want), got);
}

const openAll = page => page.evaluate(() => document.querySelectorAll('details').forEach(each => {
    each.open = each.querySelector('summary').textContent !== 'Presets';
}));

const press = (page, ...all) => all.reduce((before, key) => before.then(() => page.keyboard.press(key)),
    page.locator('.picture canvas').first().focus());

const enter = async (page, label, value) => {
    await page.getByLabel(label, {exact: true}).fill(value);
    await page.getByLabel(label, {exact: true}).press('Enter');
};

const pixels = page => page.evaluate(() => document.querySelector('.picture canvas').toDataURL());

/** A CT of four steps: time, crop, and every control that no other test has. */
export async function steps(tools) {
    const {check, keys, open, rest} = tools, page = await open();
    const its = (...rest_) => sets(tools, page, ...rest_);
    await openAll(page);
    await rest(page);
    await computed(tools, page);
    await time(tools, page, its);
    await looks(tools, page, its);
    await light(tools, page, its);
    await arrows(tools, page, its);
    await views(its, page);
    await texts(tools, page);
    await windows(tools, page);
    await planes(tools, page, its);
    await enter(page, 'crop x, first voxel', '20');
    await page.waitForFunction(() => window.snowglass.page.info.dims[0] === 28);
    await rest(page);
    await enter(page, 'crop z, one past the last voxel', '30');
    await page.waitForFunction(() => window.snowglass.page.info.dims[2] === 30);
    await rest(page);
    check('a crop is set', JSON.stringify((await keys(page)).crop) === '[[20,48],[0,40],[0,30]]',
        JSON.stringify((await keys(page)).crop));
    await its('a crop that is empty is not', () => enter(page, 'crop y, first voxel', '40'),
        {crop: [[20, 48], [0, 40], [0, 30]]});
    await page.context().close();
}

/** What the viewer adds to a look of which a part was set comes back to it by none of the
 * ways on which a page sends much of its state. */
async function computed({check, rest}, page) {
    await page.evaluate(() => {
        const {engine, store} = window.snowglass, say = engine.say.bind(engine);
        window.back = [];
        engine.say = message => {
            if (message.t === 'set')
                window.back.push(...Object.keys(message.keys).filter(key => message.keys[key] !== null && key in window.was));
            window.was = {...store.computed};
            say(message);
        };
        window.was = {};
    });
    const added = () => page.evaluate(() => Object.keys(window.snowglass.store.computed).sort().join());
    const opaque = part => page.evaluate(share => {
        const {store} = window.snowglass;
        store.set({opacity: store.look.opacity.map(([value, opacity]) => [value, share * opacity])});
    }, part);
    await opaque(0.5);
    await page.waitForFunction(() => window.snowglass.store.computed.range);
    check('a part of a look that is set leaves the others', /range,shade/.test(await added()), await added());
    await rest(page);
    await opaque(0.8);
    await press(page, 'z', 'Z', 'm', 'z', 'z');
    await page.getByRole('button', {name: /All as it was/}).click();
    await rest(page);
    await page.waitForFunction(() => !Object.keys(window.snowglass.store.computed).length);
    check('and these are never sent back', await page.evaluate(() => window.back.join()) === '',
        await page.evaluate(() => window.back.join()));
    await page.evaluate(() => delete window.snowglass.engine.say);
}

async function time({check, rest}, page, its) {
    const first = await pixels(page), slider = page.getByLabel('time step', {exact: true});
    await its('the slider goes to a step', () => slider.fill('3'), {time: 3});
    const last = await pixels(page);
    check('which is another picture', last !== first);
    check('and is written beside it', /3 \/ 3/.test(await slider.locator('..').textContent()));
    await its('and back', () => slider.fill('0'), {time: 0});
    check('to the same picture', await pixels(page) === first);
    const played = () => page.evaluate(() => new Promise(done => {
        const {recipe} = window.snowglass, seen = new Set();
        recipe.onChange(keys => seen.add(keys.time ?? 0).size === 4 && done([...seen].join()));
    }));
    const play = page.getByRole('button', {name: 'Play or stop the time steps'});
    for (const [name, turn] of [['Play', () => play.click()], ['Space', () => press(page, ' ')]]) {
        const all = played();
        await turn();
        const order = await all;
        check(`${name} shows all steps, one after another`,
            '0,1,2,3,0,1,2,3'.includes(order), order);
        await turn();
        await rest(page); // which no picture does that goes on
        const at = await slider.inputValue();
        await rest(page);
        check('and stops', await slider.inputValue() === at);
    }
    await slider.fill('0');
    await rest(page);
}

async function looks({check}, page, its) {
    const drawn = () => page.evaluate(() => document.querySelector('.editor').toDataURL());
    const bars = await drawn(), log = page.getByRole('button', {name: /Logarithmic counts/}).first();
    await log.click();
    check('counts are not logarithmic', await drawn() !== bars &&
        await log.getAttribute('aria-pressed') === 'false');
    await log.click();
    check('and are again', await drawn() === bars && await log.getAttribute('aria-pressed') === 'true');
    await its('the range is that of percentiles', () => page.getByRole('button', {name: /Range of the 1st/})
        .click(), {range: ['p1', 'p99']});
    await its('or the usual one', () => page.getByRole('button', {name: /Opacity of the preset/}).first()
        .click(), {range: undefined});
    const part = async () => parseFloat(await page.getByText(/not visible; method/).textContent());
    const before = await part();
    const threshold = page.getByLabel('Threshold', {exact: true});
    const written = share => page.getByText(`${share.toFixed(1)} % of the voxels are not visible`).waitFor();
    await its('a threshold is set', () => threshold.fill('250'), {threshold: 250});
    await written(100); // after the picture
    check('which hides all voxels', before < 100, before);
    await its('or none more', () => threshold.fill('0'), {threshold: 0});
    await written(before);
    check('and they are seen again', await part() === before, await part());
    for (const [name, key, on] of [['colour bar', 'legend', true], ['scale bar', 'legend', 'scale'],
        ["edges of the volume's box", 'box', 'outline']]) {
        const plain = await pixels(page);
        await its(`${name} is switched on`, () => page.getByLabel(name).check(), {[key]: on});
        check('and seen', await pixels(page) !== plain);
        await its('and off', () => page.getByLabel(name).uncheck(), {[key]: undefined});
    }
}

async function light(tools, page, its) {
    const list = page.getByLabel('Light', {exact: true});
    const plain = await pixels(page);
    await its('light is from the viewer', () => list.selectOption('head'), {light: 'head'});
    tools.check('which is seen', await pixels(page) !== plain);
    await its('or from a direction', () => list.selectOption('direction'), {light: [-25, 35]});
    await its('that a slider turns', () => page.getByLabel('degrees of the light right').fill('40'),
        {light: [40, 35]});
    await its('and lifts', () => page.getByLabel('degrees of the light up').fill('-10'), {light: [40, -10]});
    await its('or as usual', () => list.selectOption('key'), {light: 'key'});
}

/** What a drag does without keys is what arrow keys do. */
async function arrows({check, keys, rest}, page, its) {
    const drag = page.getByLabel('Drag'), canvas = page.locator('.picture canvas').first();
    await its('a view begins without turns', () => press(page, '1'), {azimuth: 0, elevation: 0});
    await its('arrows turn by 5 degrees', () => press(page, 'ArrowLeft', 'ArrowUp'),
        {azimuth: 5, elevation: -5});
    await its('with Shift by 1', () => press(page, 'Shift+ArrowRight', 'Shift+ArrowDown'),
        {azimuth: 4, elevation: -4});
    await drag.selectOption('pan');
    let before = await keys(page);
    await its('when drags move, arrows do not turn', () => press(page, 'ArrowRight'),
        {azimuth: 4, elevation: -4});
    const moved = async () => {
        const {target} = await keys(page);
        return Math.hypot(...target.map((x, i) => x - before.target[i]));
    };
    const far = await moved();
    check('but move', far > 1, far);
    await press(page, 'Shift+ArrowLeft', 'Shift+ArrowLeft', 'Shift+ArrowLeft', 'Shift+ArrowLeft',
        'Shift+ArrowLeft');
    await rest(page);
    check('there and back', await moved() < 1e-3 * far, await moved());
    await press(page, 'd');
    check('d chooses the next', await drag.inputValue() === 'window' &&
        /window/.test(await page.locator('.said').textContent()));
    const look = () => page.evaluate(() => window.snowglass.page.look);
    const begin = await look();
    await press(page, 'ArrowRight', 'ArrowRight', 'ArrowUp'); // sooner than the look comes
    await rest(page);
    const {range} = await keys(page), wide = begin.high - begin.low, side = await canvas.evaluate(
        ({clientHeight}) => clientHeight);
    check('arrows set window', Math.abs((range[1] - range[0]) / wide / Math.exp(side / 18 / 250) - 1) < 0.01,
        `${range} ${wide} ${side}`);
    check('and level', Math.abs((range[0] + range[1] - begin.low - begin.high) / 2 / wide * 36 - 1) < 0.01,
        `${range} ${wide} ${side}`);
    await press(page, 'd', 'ArrowDown');
    await rest(page);
    const {opacity} = await keys(page);
    check('or opacity', opacity.at(-1)[1] < begin.opacity.at(-1)[1], JSON.stringify(opacity));
    await press(page, 'd', 'ArrowRight');
    await rest(page);
    const {light: [right, up]} = await keys(page);
    check('or the light', right > -25 && up === 35, `${right} ${up}`);
    await press(page, 'd');
    check('and the first comes again', await drag.inputValue() === 'turn');
    before = await keys(page);
    await its('after which arrows turn', () => press(page, 'ArrowLeft'), {azimuth: before.azimuth + 5});
    await page.evaluate(() => window.snowglass.recipe.set({range: null, opacity: null, light: null}));
    await rest(page);
}

async function views(its, page) {
    for (const [key, view] of [['2', 'posterior'], ['4', 'right'], ['5', 'superior'], ['1', 'anterior']])
        await its(`${key} looks from ${view}`, () => press(page, key), {view, azimuth: 0, elevation: 0});
}

/** Recipe, movie, help. */
async function texts({check, keys, folder}, page) {
    const coming = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save the recipe of this state'}).click();
    const file = await coming;
    await file.saveAs(`${folder}/recipe.json`);
    const saved = JSON.parse(readFileSync(`${folder}/recipe.json`, 'utf8')), now = await keys(page);
    check('a recipe is saved', file.suggestedFilename() === 'steps.json' && saved.view === now.view &&
        String(saved.size) === String(now.size), JSON.stringify(saved));
    const dialog = page.locator('dialog[open]');
    const movie = page.getByRole('button', {name: /^Copy the command that makes a movie/});
    for (const [name, act] of [['Movie', () => movie.click()], ['v', () => press(page, 'v')]]) {
        await act();
        const command = await dialog.locator('textarea').inputValue();
        check(`${name} gives the command of a movie`, /^snowglass turntable .*--view anterior/.test(command),
            command);
        await page.keyboard.press('Escape');
    }
    await press(page, '?');
    check('? lists all keys', await dialog.locator('kbd').count() > 20);
    await page.keyboard.press('Escape');
    check('and goes away', await dialog.count() === 0);
}

/** The usual windows of a CT, in slices. */
async function windows({check, slicesRest}, page) {
    await press(page, 'x');
    await slicesRest(page);
    const list = page.getByLabel('Window', {exact: true});
    const range = () => page.evaluate(() => String(window.snowglass.slices.keys.range));
    const all = await range();
    for (const [name, want] of [['lung', '-1350,150'], ['bone', '-500,1300'], ['soft tissue', '-160,240'],
        ['all', all]]) {
        await list.selectOption(name);
        await slicesRest(page);
        check(`the window of ${name} is chosen`, await range() === want, await range());
    }
    await press(page, 'x');
}

/** Handles take no wheel from zoom, and there is no seventh plane. */
async function planes({check, keys, rest, wheel}, page, its) {
    const grips = page.locator('.handle:visible');
    await grips.nth(5).waitFor();
    const box = await grips.first().boundingBox(), {zoom = 1} = await keys(page);
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await wheel(page, -120);
    await rest(page);
    check('the wheel over a handle zooms', (await keys(page)).zoom > 1.1 * zoom, (await keys(page)).zoom);
    const five = [[-1, 0, 0, 0], [1, 0, 0, 180], [0, -1, 0, 0], [0, 1, 0, 150], [0, 0, -1, 0]];
    const six = [[1, 1, 0, 250], ...five];
    await its('a tilted plane and five ends are cut', () => page.evaluate(
        clip => window.snowglass.recipe.set({clip}), six), {clip: six});
    const last = page.getByLabel('clip bottom - top, highest').and(page.locator('input'));
    check('no end makes a seventh', await last.isDisabled() && await grips.count() === 6,
        await grips.count());
    check('nor a tilted one', await page.getByRole('button', {name: /A plane that faces/}).isDisabled());
    await its('without the tilted one', () => page.getByRole('button', {name: 'Remove tilted plane 1'}).click(),
        {clip: five});
    await its('the end can cut', () => last.fill('100'), {clip: [...five, [0, 0, 1, 100.24]]});
    check('and go back', await last.isEnabled());
    await its('and all are removed', () => page.getByRole('button', {name: 'Remove all clip planes'}).click(),
        {clip: undefined});
    check('no change was refused', !/clip/.test(await page.locator('.said').textContent()));
}

const PHANTOM = ['phantom:head', '--dims', '64x64x64'];

/** A viewer of its own: [process, URL]. */
export async function start(tool, ...options) {
    const server = spawn(tool, ['serve', ...options],
        {stdio: ['ignore', 'pipe', 'ignore']});
    const [line] = await once(createInterface(server.stdout), 'line');
    return [server, line];
}

export async function end(server) {
    server.kill();
    await once(server, 'exit');
}

/** A viewer that ends is missed in words, and found again; one with another secret
 * is reached by its URL, in the same tab. */
export async function restarted({check, keys, open, part, rest, folder}) {
    const {url: tool, said} = part();
    const file = `${folder}/token_${process.pid}`;
    let [server, url] = await start(tool, ...PHANTOM, '--token-file', file);
    const {port} = new URL(url), page = await open({}, url);
    const hears = words => page.waitForFunction(text => document.querySelector('.said').textContent
        .includes(text), words);
    await page.evaluate(() => window.snowglass.recipe.set({azimuth: 42, colormap: 'hot', title: 'mine'}));
    await rest(page);
    await end(server);
    await hears('start snowglass serve again');
    check('the page says that the viewer does not answer', true);
    await page.evaluate(() => window.snowglass.recipe.set({elevation: 7}));
    await page.evaluate(() => { window.snowglass.page.rest = null; });
    [server] = await start(tool, ...PHANTOM, '--token-file', file, '--listen', `:${port}`);
    await rest(page);
    check('a page comes back with the viewer',
        await page.locator('.said').textContent() === '');
    await page.waitForFunction(() => window.snowglass.recipe.keys.title === 'mine');
    const other = await open({}, url); // sees what the viewer has
    const now = await keys(other);
    check('and so does what was done', now.azimuth === 42 && now.colormap === 'hot' && now.elevation === 7,
        JSON.stringify(now));
    await other.evaluate(() => window.snowglass.recipe.set({azimuth: 11}));
    await page.waitForFunction(() => window.snowglass.recipe.keys.azimuth === 11);
    await other.evaluate(() => window.snowglass.recipe.undo());
    await page.waitForFunction(() => window.snowglass.recipe.keys.azimuth === 42);
    await other.context().close();
    await end(server);
    await hears('start snowglass serve again');
    [server] = await start(tool, ...PHANTOM, '--token-file', file, '--listen', `:${port}`, '--azimuth', '5');
    await page.waitForFunction(() => window.snowglass.recipe.keys.azimuth === 42);
    await rest(page);
    check('all of it comes again', (await keys(page)).title === 'mine');
    await end(server);
    await hears('start snowglass serve again');
    [server, url] = await start(tool, ...PHANTOM, '--listen', `:${port}`);
    await hears('open the printed URL');
    check('the page says that the secret is another', true);
    await page.evaluate(() => { window.snowglass.old = true; });
    await page.goto(url); // another fragment alone
    await page.waitForFunction(() => window.snowglass && !window.snowglass.old);
    await rest(page);
    check('its URL is taken in the same tab', await page.locator('.said').textContent() === '');
    await page.getByRole('button', {name: 'Copy a link to this state'}).click();
    const link = new URL(await page.locator('dialog textarea').inputValue());
    await page.keyboard.press('Escape');
    const given = new URLSearchParams(link.hash.slice(1));
    given.set('recipe', JSON.stringify({...JSON.parse(given.get('recipe')), mode: 'mip'}));
    await page.evaluate(() => { window.snowglass.old = true; });
    await page.goto(`${link.href.split('#')[0]}#${given}`);
    await page.waitForFunction(() => window.snowglass && !window.snowglass.old);
    await rest(page);
    check('and so is a link', await page.evaluate(() => window.snowglass.recipe.keys.mode) === 'mip');
    await page.evaluate(() => window.snowglass.recipe.set({azimuth: 77}));
    await page.getByRole('button', {name: /^2 x 2/}).click();
    await rest(page);
    await page.evaluate(() => { window.snowglass.old = true; });
    await page.reload();
    await page.waitForFunction(() => window.snowglass && !window.snowglass.old);
    await rest(page);
    const {azimuth, mode, slices} = await keys(page);
    check('a page that is loaded again shows what was done since', azimuth === 77 && mode === 'mip' && slices?.layout === 'grid',
        JSON.stringify([azimuth, mode, slices]));
    await page.context().close();
    await end(server);
    said.splice(0, said.length, ...said.filter(line => !/WebSocket connection to/.test(line)));
}

/** What is asked when a viewer has come back with another state or file, and when a file is
 * another one while it is shown.  The words are four files, of which the later take the
 * place of the first. */
export async function asked({check, keys, open, part, rest, folder}) {
    const {url: tool, said, words: [shown, next, third, last]} = part();
    const token = ['--token-file', `${folder}/asked_${process.pid}`];
    let [server, url] = await start(tool, shown, ...token);
    const {port} = new URL(url), page = await open({}, url);
    const dialog = page.locator('dialog[open]'), set = (where, changes) => where.evaluate(
        all => window.snowglass.recipe.set(all), changes);
    /** The viewer ends, and one of the file is there; the page tries again when it is told. */
    const renew = async (...options) => {
        await page.evaluate(() => { window.snowglass.engine.wait = 1e8; });
        await end(server);
        await page.waitForFunction(() => /start snowglass serve again/.test(
            document.querySelector('.said').textContent));
        [server] = await start(tool, shown, ...token, '--listen', `:${port}`, ...options);
    };
    const comeBack = () => page.evaluate(() => window.snowglass.engine.open());
    await set(page, {azimuth: 42, title: 'mine'});
    await rest(page);
    await renew();
    const other = await open({}, url);
    await set(other, {azimuth: 11});
    await rest(other);
    await comeBack();
    check('a state that another page has changed is not overwritten', /another page has changed it/.test(
        await dialog.textContent()), await dialog.textContent());
    const now = await keys(page);
    check('and is what the page shows', now.azimuth === 11 && !now.title, JSON.stringify(now));
    await dialog.getByRole('button', {name: 'Take the state of this page'}).click();
    await other.waitForFunction(() => window.snowglass.recipe.keys.title === 'mine');
    check('until it is said', (await keys(other)).azimuth === 42 && await dialog.count() === 0);
    await other.context().close();
    await rest(page);

    renameSync(next, shown);
    await renew('--elevation', '9');
    await comeBack();
    check('a viewer of another file asks', /this is another file/.test(await dialog.textContent()),
        await dialog.textContent());
    await page.keyboard.press('Escape');
    await rest(page);
    const kept = await keys(page);
    check('and keeps its state', kept.elevation === 9 && !kept.title, JSON.stringify(kept));

    renameSync(third, shown);
    const dims = () => page.evaluate(() => window.snowglass.page.info.dims.join());
    const before = await dims();
    await set(page, {azimuth: 20});
    check('a file that was replaced is told of', /another file now/.test(await dialog.textContent()),
        await dialog.textContent());
    await page.keyboard.press('Escape');
    check('what is shown stays', await dims() === before);
    renameSync(last, shown);
    await set(page, {azimuth: 21});
    await dialog.getByRole('button', {name: 'Open the new one'}).click();
    await page.waitForFunction(was => window.snowglass.page.info.dims.join() !== was, before);
    await rest(page);
    check('and the new one is opened', await dims() === '24,40,36' &&
        /24 x 40 x 36/.test(await page.locator('.top').textContent()), await dims());
    unlinkSync(shown);
    await set(page, {azimuth: 22});
    await page.waitForFunction(() => /was removed/.test(document.querySelector('.said').textContent));
    check('one that is gone is told of', await dialog.count() === 0);
    await page.context().close();
    await end(server);
    said.splice(0, said.length, ...said.filter(line => !/WebSocket connection to/.test(line)));
}
