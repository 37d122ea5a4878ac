// tests/serve/web/folder.mjs - the list of a folder in the page: four volumes "v1.nrrd",
// "v2.nrrd", "v10.nrrd" and "deep/<b>v3.nrrd", a recipe of v2 and a file that is cut.
import {copyFileSync, rmSync} from 'node:fs';
import {end, start} from './everyday.mjs';

const names = page => page.locator('[aria-label="Volumes"] b').allTextContents();
const shown = (page, name) => page.waitForFunction(text => document.title.startsWith(text) && window.snowglass.page.rest, name,
    {polling: 20});

export async function listed(tools) {
    const {check, judged, open, shot} = tools, page = await open({}, undefined, false);
    await page.waitForFunction(() => document.querySelectorAll('.tiles img[src]').length === 4);
    check('the list is there before any volume', await page.locator('dialog.folder').getAttribute('open') !== null);
    check('in the order of a reader', String(await names(page)) === '<b>v3.nrrd,v1.nrrd,v2.nrrd,v10.nrrd', await names(page));
    check('with why one cannot be opened', /truncated/.test(await page.locator('.folder details li').textContent()));
    for (const [width, height, colorScheme] of [[400, 700, 'light'], [1600, 1000, 'dark'], [900, 560, 'light']]) {
        await page.setViewportSize({width, height});
        await page.emulateMedia({colorScheme});
        await judged(page, `of the list, ${width} pixels wide, ${colorScheme}`);
        check('nothing is cut at its side', await page.evaluate(() => {
            const {scrollWidth, clientWidth} = document.querySelector('.lists');
            return scrollWidth <= clientWidth;
        }));
        await shot(page, `folder_${width}`);
    }
    const line = page.locator('dialog.folder p[role=status]');
    await page.evaluate(() => window.snowglass.take([new File(['{"azimuth":3}'], 'x.json')]));
    check('a recipe that is dropped before is told so', /choose a volume/.test(await line.textContent()), await line.textContent());
    await page.keyboard.press('Escape');
    check('and stays until one is chosen', await page.locator('dialog.folder').getAttribute('open') !== null);
    await page.locator('.tiles button').first().focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Enter');
    await shown(page, 'v1.nrrd');
    check('the keyboard opens one', await page.locator('dialog.folder').getAttribute('open') === null);
    await page.evaluate(() => window.snowglass.recipe.set({title: 'mine', azimuth: 40}));
    await page.keyboard.press('x');
    await tools.slicesRest(page);
    const axis = await page.locator('.editor').first().evaluate(({dataset}) => dataset.span);
    await page.evaluate(() => window.snowglass.editor.nearer(8));
    await page.keyboard.press('n');
    await shown(page, 'v2.nrrd');
    check('of the one before no slice is left', await page.evaluate(() => window.snowglass.slices.panes.every(pane => !pane.bitmap)));
    check('nor the part of its values', await page.locator('.editor').first().evaluate(({dataset}) => dataset.span) === axis);
    const now = await tools.keys(page);
    check('n opens the next, as it is', !now.title && !now.azimuth, JSON.stringify(now));
    check('which has nothing to undo', await page.getByRole('button', {name: 'Undo (z)'}).isDisabled());
    await page.keyboard.press('N');
    await shown(page, 'v1.nrrd');
    await page.keyboard.press('N');
    await shown(page, '<b>v3.nrrd');
    check('Shift and n the one before', true);
    await page.evaluate(() => window.snowglass.recipe.set({azimuth: 40}));
    await page.getByRole('button', {name: /^Reset/}).click();
    await tools.rest(page);
    check('Reset is to what this one began with', !(await tools.keys(page)).azimuth);
    await page.getByRole('button', {name: /link to this state/}).click();
    const link = await page.getByLabel('Text to copy').inputValue();
    await page.keyboard.press('Escape');
    await page.locator('.picture canvas').first().focus();
    await page.keyboard.press('o');
    await page.getByRole('button', {name: /^v2.nrrd/}).click();
    await shown(page, 'v2.nrrd');
    await page.keyboard.press('o');
    await page.getByRole('button', {name: /warm.json/}).click();
    await page.waitForFunction(() => window.snowglass.page.info.mask && window.snowglass.page.rest, null, {polling: 20});
    check('a recipe opens its volume', (await tools.keys(page)).azimuth === 33);
    check('and its mask can be switched', await page.getByText('only what the mask keeps').count() === 1);
    await page.getByRole('button', {name: /link to this state/}).click();
    check('which a link names', /volume=%5B%22warm.json%22/.test(await page.getByLabel('Text to copy').inputValue()));
    await page.keyboard.press('Escape');
    const other = await open({}, link);
    await shown(other, '<b>v3.nrrd');
    await shown(page, '<b>v3.nrrd');
    check('a link names its volume, which all pages see', true);
    await linked(tools, page, other, link);
    await other.context().close();
    await page.context().close();
}

/** Of what is open, and of what there is not, when the list is done last. */
async function linked({check, keys, rest}, page, other, link) {
    const opened = () => page.evaluate(() => window.snowglass.page.info.opened), before = await opened();
    await page.evaluate(() => window.snowglass.recipe.set({azimuth: 25}));
    await rest(page);
    const follow = async (url, title) => {
        await other.goto('about:blank'); // another fragment alone loads nothing
        await other.goto(url.replace('recipe=%7B', `recipe=%7B%22title%22%3A%22${title}%22%2C`));
    };
    await follow(link, 'linked');
    await page.waitForFunction(() => window.snowglass.recipe.keys.title === 'linked', null, {polling: 20});
    check('a link to what is open does not open it again', await opened() === before, await opened());
    await other.addInitScript(() => {
        const {parse} = JSON;
        JSON.parse = (...all) => {
            const message = parse(...all);
            if (message?.t === 'folder' && !window.late)
                window.late = {...message};
            return message?.t === 'folder' ? {...message, done: false} : message;
        };
    });
    await follow(link.replace(/volume=[^&]*/, 'volume=%5B%22gone.nrrd%22%2C%22%22%5D'), 'lost');
    await rest(other);
    await other.waitForFunction(() => document.querySelectorAll('.tiles b').length === 5, null, {polling: 20});
    await other.evaluate(() => window.snowglass.engine.tell('folder', window.late));
    const said = await other.locator('.said').textContent();
    check('a link to what there is not says so', /has no gone.nrrd/.test(said), said);
    await page.locator('.picture canvas').first().focus();
    await page.keyboard.press('n');
    await shown(page, 'v1.nrrd');
    await rest(other);
    check('and nothing else gets its state', !(await keys(page)).title, (await keys(page)).title);
}

/** A viewer of a folder that is started again: a page has what it had open, as it was. */
export async function reopened({check, keys, open, part, rest, slicesRest, folder}) {
    const {url: tool, said, words: [place]} = part();
    const token = ['--token-file', `${folder}/reopened_${process.pid}`];
    let [server, url] = await start(tool, place, ...token);
    const {port} = new URL(url), page = await open({}, url, false), dialog = page.locator('dialog[open]');
    const choose = (where, name) => where.getByRole('button', {name}).click();
    const told = words => page.waitForFunction(text => document.querySelector('.said').textContent.includes(text), words,
        {polling: 20});
    const set = (where, changes) => where.evaluate(all => window.snowglass.recipe.set(all), changes);
    /** Another viewer, which the page finds by its address. */
    const renew = async () => {
        await page.evaluate(() => { window.snowglass.engine.wait = 1e8; });
        await end(server);
        await told('start snowglass serve again');
        await page.evaluate(() => { window.snowglass.page.rest = null; });
        [server] = await start(tool, place, ...token, '--listen', `:${port}`);
    };
    const comeBack = () => page.evaluate(() => window.snowglass.engine.open());
    const asIt = async () => {
        await page.waitForFunction(() => window.snowglass.recipe.keys.title === 'mine' && window.snowglass.page.rest, null, {polling: 20});
        const {azimuth, colormap, measure, slices} = await keys(page);
        return JSON.stringify([azimuth, colormap, measure, slices?.layout]);
    };
    await choose(page, /^v2.nrrd/);
    await shown(page, 'v2.nrrd');
    await set(page, {azimuth: 42, colormap: 'hot', title: 'mine', measure: 'line 2,2,2 12,9,8'});
    await page.getByRole('button', {name: /^2 x 2/}).click();
    await rest(page);
    await slicesRest(page);
    const undo = await page.evaluate(() => window.snowglass.store.before.length);

    await renew();
    await set(page, {elevation: 7}); // nobody hears it
    await comeBack();
    const was = await asIt();
    check('the volume is open again, as it was', was === '[42,"hot","line 2,2,2 12,9,8","grid"]' &&
        (await keys(page)).elevation === 7 && (await page.title()).startsWith('v2.nrrd'), was);
    await slicesRest(page);
    check('with its slices, and nothing in the way', await page.evaluate(() => window.snowglass.slices.panes.every(pane => pane.bitmap)) &&
        !await dialog.count() && await page.locator('.said').textContent() === '', await page.locator('.said').textContent());
    check('and with its steps', await page.evaluate(() => window.snowglass.store.before.length) > undo);
    const other = await open({}, url);
    check('which other pages see', (await keys(other)).title === 'mine' && (await keys(other)).elevation === 7);
    await other.close();

    await renew();
    const third = await open({}, url, false);
    await choose(third, /^v1.nrrd/);
    await shown(third, 'v1.nrrd');
    await comeBack();
    const text = await dialog.textContent();
    check('what another page has opened meanwhile stays', /v1.nrrd, which another page/.test(text) && !(await keys(third)).title, text);
    await choose(dialog, /^Open v2.nrrd as it was/);
    await page.waitForFunction(() => window.snowglass?.page.info?.name === 'v2.nrrd');
    check('until it is said', await asIt() === was, await asIt());
    await third.context().close();

    copyFileSync(`${place}/v10.nrrd`, `${place}/v2.nrrd`); // of another time
    await renew();
    await comeBack();
    await page.waitForFunction(() => document.querySelector('dialog[open]:not(.folder)'), null, {polling: 20});
    check('another file under its name is not taken for it', /this is another file/.test(await dialog.textContent()) &&
        !(await keys(page)).title, await dialog.textContent());
    await choose(dialog, /^Take the state/);
    check('but gets its state, if that is said', await asIt() === was, await asIt());

    rmSync(`${place}/v2.nrrd`);
    await renew();
    await comeBack();
    await page.waitForFunction(() => /no v2.nrrd, which was open/.test(document.querySelector('.folder [role=status]').textContent), null,
        {polling: 20});
    check('one that is gone is named', true);
    await choose(page, /^v1.nrrd/);
    await shown(page, 'v1.nrrd');
    await rest(page);
    check('and another one has a state of its own', !(await keys(page)).title && !await dialog.count(), (await keys(page)).title);
    await page.context().close();
    await end(server);
    said.splice(0, said.length, ...said.filter(line => !/WebSocket connection to/.test(line)));
}
