// tests/serve/web/movies.mjs - time steps that play, and movies that the server writes; of
// a file with six steps of six hours each, from the first of January 2000 on.
import {readFileSync, writeFileSync} from 'node:fs';

const now = page => page.evaluate(() => window.snowglass.store.keys.time ?? 0);
const section = (page, name) => page.locator('details', {has: page.locator('summary', {hasText: new RegExp(`^${name}$`)})});

/** The steps that are asked for from now on, and whether each waited for the picture of
 * the one before, which takes some time to be painted. */
const watch = page => page.evaluate(() => {
    const {engine} = window.snowglass, {say} = engine, decode = engine.decode.bind(engine);
    window.seen = {steps: [], early: 0, painted: true, undo: () => Object.assign(engine, {say, decode})};
    engine.decode = async frame => {
        await new Promise(done => setTimeout(done, 60));
        return decode(frame);
    };
    engine.say = message => {
        if (message.t === 'set' && message.keys.time !== undefined) {
            window.seen.steps.push(message.keys.time);
            window.seen.early += !window.seen.painted;
            window.seen.painted = false;
        }
        if (message.t === 'ack' && message.n >= engine.step)
            window.seen.painted = true;
        say.call(engine, message);
    };
});

const seen = (page, count) => page.waitForFunction(n => window.seen.steps.length >= n && window.seen, count, {polling: 20})
    .then(handle => handle.jsonValue()).then(({steps, early}) => ({steps: steps.join(), early}));

export async function movies(tools) {
    const page = await tools.open();
    await played(tools, page);
    await written(tools, page);
    await page.context().close();
}

async function played({check, rest}, page) {
    const time = section(page, 'Time'), slider = page.getByLabel('time step', {exact: true});
    await page.waitForFunction(() => window.snowglass.times.texts.length, null, {polling: 20});
    check('a step has its date', /2000-01-01 00:00/.test(await time.textContent()), await time.textContent());
    await slider.fill('5');
    await rest(page);
    check('as has another', /2000-01-02 06:00/.test(await time.textContent()) &&
        /2000-01-02 06:00/.test(await slider.getAttribute('aria-valuetext')), await time.textContent());
    for (const [name, value] of [['first step that is played', '1'], ['last step that is played', '3']]) {
        await page.getByLabel(name).fill(value);
        await page.getByLabel(name).press('Enter');
    }
    await page.getByLabel('steps a second').fill('30');
    const play = page.getByRole('button', {name: /^Play or stop/});
    const undo = await page.evaluate(() => window.snowglass.store.before.length);
    for (const [loop, steps] of [['both', '1,2,3,2,1,2'], ['loop', '1,2,3,1,2,3']]) {
        await time.locator('select').selectOption(loop);
        await slider.fill('0');
        await rest(page);
        await watch(page);
        await play.click();
        const {steps: all, early} = await seen(page, 6);
        await play.click();
        await page.evaluate(() => window.seen.undo());
        check(`steps are played: ${loop}`, all.startsWith(steps), all);
        check('the next one is asked for when the last was painted', early === 0, early);
        await rest(page);
    }
    check('to play is one step to undo', await page.evaluate(() => window.snowglass.store.before.length) <= undo + 4,
        await page.evaluate(() => window.snowglass.store.before.length) - undo);
    await time.locator('select').selectOption('once');
    await slider.fill('2');
    await rest(page);
    await play.click();
    await page.waitForFunction(() => !window.snowglass.times.playing, null, {polling: 20});
    await rest(page);
    check('once ends at the last step', await now(page) === 3, await now(page));
}

/** Whether the browser asks before it leaves the page. */
const stays = page => page.evaluate(() => !dispatchEvent(new Event('beforeunload', {cancelable: true})));

/** Another page has not fetched it: it is asked before its own takes the place. */
async function asked({check, open}, page) {
    const other = await open(), movie = section(other, 'Movie'), dialog = other.locator('dialog[open]');
    const writing = page.evaluate(() => new Promise(done => window.snowglass.engine.on('movie', ({state}) =>
        state === 'writing' && done(true))));
    await movie.locator('summary').click();
    await movie.getByLabel('Format', {exact: true}).selectOption('webp');
    await movie.getByRole('button', {name: /^Write/}).click();
    const text = await dialog.textContent();
    check('the next one asks', /dated.webp is there, and this page has not fetched it/.test(text), text);
    await dialog.getByRole('button', {name: /^Close/}).click();
    check('and does nothing else', await movie.getByRole('button', {name: /^Download|^Fetch/}).isVisible() && !await stays(other));
    await movie.getByRole('button', {name: /^Write/}).click();
    await dialog.getByRole('button', {name: 'Write the new one'}).click();
    check('until the user says so', await writing);
    check('who closes the page meanwhile is asked', await stays(other) && !await stays(page));
    await movie.getByRole('button', {name: /^Cancel/}).click();
    await other.waitForFunction(() => window.snowglass.movies.movie.state === 'cancelled', null, {polling: 20});
    check('but not for nothing', !await stays(other));
    await page.evaluate(() => { document.querySelector('.said').textContent = ''; });
    await other.context().close();
}

async function written(tools, page) {
    const {check, copied, file, rest} = tools;
    const movie = section(page, 'Movie'), list = name => movie.getByLabel(name, {exact: true});
    await movie.locator('summary').click();
    await list('Shows').selectOption('movie');
    await list('Format').selectOption('webp');
    await rest(page);
    const saved = page.waitForEvent('download');
    await movie.getByRole('button', {name: /^Write/}).click();
    const got = await saved;
    check('a movie is fetched when it is written', got.suggestedFilename() === 'dated.webp', got.suggestedFilename());
    writeFileSync(file('movie.webp'), readFileSync(await got.path()));
    await movie.getByRole('button', {name: /^The command/}).or(movie.getByRole('button', {name: /^Command/})).first().click();
    const command = await copied(page);
    check('of the steps that are played', command.includes('snowglass movie ') && command.includes('--time 1:4'), command);
    writeFileSync(file('movie.txt'), command);
    await asked(tools, page);
    await list('Shows').selectOption('turntable');
    const frames = movie.getByLabel('number of frames');
    for (const [typed, count] of [['50', 50], ['', 120], ['12.5', 13], ['0', 1], ['3600', 3600]]) {
        await frames.fill(typed);
        await frames.blur();
        check(`"${typed}" frames`, await page.evaluate(() => window.snowglass.movies.order.frames) === count);
    }
    await movie.getByRole('button', {name: /^Write/}).click();
    await movie.getByRole('button', {name: /^Cancel/}).click();
    await page.waitForFunction(() => /cancelled/.test(document.querySelector('.said').textContent), null, {polling: 20});
    check('one that is cancelled says so', /cancelled/.test(await movie.textContent()), await movie.textContent());
    check('and another can be written', await movie.getByRole('button', {name: /^Write/}).isVisible());
}
