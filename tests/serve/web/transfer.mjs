// tests/serve/web/transfer.mjs - the transfer function of the page: where values lie on an
// axis that is zoomed, colours the other way round, looks in groups, and a look that is saved
// to a file and opened again.
import {readFileSync} from 'node:fs';

const editor = page => page.locator('.editor').first();
const span = page => editor(page).evaluate(canvas => canvas.dataset.span.split(',').map(Number));
const strip = page => page.evaluate(() => window.snowglass.page.look.strip);
const keys = page => page.evaluate(() => window.snowglass.recipe.keys);
const bytes = page => page.evaluate(async () => [...new Uint8Array(await window.snowglass.page.rest.arrayBuffer())].join());
const near = (a, b, most) => Math.abs(a - b) <= most;

/** Whether colours are those the other way round, to a step of 255. */
const turned = (a, b) => a.every((color, i) => [1, 3, 5].every(k =>
    near(parseInt(color.slice(k, k + 2), 16), parseInt(b.at(-1 - i).slice(k, k + 2), 16), 1)));

/** Points are x = 8 + (value - low) / (high - low) (width - 16) pixels to the right. */
async function places(check, page, when) {
    const [low, high] = await span(page);
    const [shown, opacity, width] = await page.evaluate(() => [document.querySelector('.editor').dataset.points,
        window.snowglass.recipe.keys.opacity ?? window.snowglass.page.look.opacity, document.querySelector('.editor').clientWidth]);
    const wanted = opacity.map(([value]) => Math.round(8 + (value - low) / (high - low) * (width - 16)));
    check(`points lie where the formula has them, ${when}`, shown.split(' ').every((pair, i) =>
        near(Number(pair.split(',')[0]), wanted[i], 1)), `${shown}, not ${wanted}`);
    return [low, high, width];
}

async function axis({check, rest, wheel}, page) {
    const [low, high, width] = await places(check, page, 'all values');
    const box = await editor(page).boundingBox(), x = 0.3 * width, before = (await keys(page)).opacity;
    await page.mouse.move(box.x + x, box.y + 20);
    await wheel(page, -200);
    const [a, b] = await places(check, page, 'nearer');
    const share = (x - 8) / (width - 16), value = low + share * (high - low);
    check('the value under the pointer stays there', near(a + share * (b - a), value, 0.02 * (b - a)), [a, b, value]);
    check('and the axis is 1.5 x 1.5 times nearer', near((high - low) / (b - a), 2.25, 1e-6), (high - low) / (b - a));
    await page.waitForFunction(([from, to]) => {
        const {closer, closerPart} = window.snowglass.editor;
        return closerPart === `${from},${to}` && closer.lo < from && closer.hi > to;
    }, [a, b], {polling: 20});
    const bins = await page.evaluate(() => window.snowglass.editor.closer);
    check('its values are counted, in bins of whole numbers', bins.counts.length === 256 &&
        (bins.hi - bins.lo) % 256 === 0 && (bins.lo + 0.5) % 1 === 0, [bins.lo, bins.hi]);
    check('points beyond stay', JSON.stringify((await keys(page)).opacity) === JSON.stringify(before));
    const at = await page.evaluate(() => window.snowglass.editor.x(window.snowglass.editor.points[1][0]));
    check('a value goes to a pixel and back', await page.evaluate(([pixel, wide]) =>
        Math.abs(window.snowglass.editor.axis.value(pixel, wide) - window.snowglass.editor.points[1][0]), [at, width]) < 1e-9);
    await page.getByLabel('which part of the values is shown').evaluate(slider => {
        slider.value = '1';
        slider.dispatchEvent(new Event('input'));
    });
    check('a slider moves along', near((await span(page))[1], high, 1e-9), await span(page));
    await editor(page).focus();
    await page.keyboard.press('PageDown');
    const [from, to] = await places(check, page, 'at a point');
    const [point] = await page.evaluate(() => window.snowglass.editor.points[window.snowglass.editor.chosen]);
    check('a point that is chosen by key is shown', point >= from && point <= to, [point, from, to]);
    await page.keyboard.press('0');
    check('0 shows all', String(await span(page)) === String([low, high]), await span(page));
    const zoom = (await keys(page)).zoom;
    await page.keyboard.press('+');
    check('plus zooms the axis, not the picture', (await span(page))[1] - (await span(page))[0] < high - low &&
        (await keys(page)).zoom === zoom);
    await page.getByRole('button', {name: 'Show all values'}).first().click();
    await rest(page);
}

async function colors({check, rest, answered}, page) {
    const box = page.getByLabel('inverted colours'), before = await strip(page);
    await answered(page, 'look', () => box.click());
    check('the colour at t is that of 1 - t', turned(await strip(page), before), await strip(page));
    check('by a name of the tool', /_r$/.test((await keys(page)).colormap), (await keys(page)).colormap);
    await answered(page, 'look', () => page.getByLabel('Colours', {exact: true}).selectOption('viridis'));
    check('another map is inverted too', (await keys(page)).colormap === 'viridis_r' && await box.isChecked());
    check('and the list has its name', await page.getByLabel('Colours', {exact: true}).inputValue() === 'viridis');
    await page.evaluate(() => window.snowglass.recipe.set({colormap: null, preset: 'ct-bone', opacity: null, range: null}));
    await rest(page);
    const bone = await strip(page);
    await answered(page, 'look', () => box.click());
    check('colours of a preset are', turned(await strip(page), bone) &&
        (await keys(page)).colormap === 'reversed');
    await answered(page, 'look', () => box.click());
    check('and come back', !(await keys(page)).colormap && String(await strip(page)) === String(bone));
    await page.evaluate(() => window.snowglass.recipe.set({preset: null, colormap: '20:#000000,60:#ff0000,200:#ffffff'}));
    await rest(page);
    await box.click();
    check('so are those of a list', (await keys(page)).colormap === '20:#ffffff,160:#ff0000,200:#000000', (await keys(page)).colormap);
    await box.click();
    check('which comes back as it was', (await keys(page)).colormap === '20:#000000,60:#ff0000,200:#ffffff');
    await rest(page);
}

async function file({check, folder, rest}, page) {
    await page.evaluate(() => window.snowglass.recipe.set({colormap: 'inferno_r', range: [12.5, 190], shade: 'none',
        opacity: [[20, 0], [90, 0.25], [180, 0.9]]}));
    await rest(page);
    const shown = await bytes(page), path = `${folder}/look.json`;
    await page.locator('summary', {hasText: 'Presets'}).click();
    const coming = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save look'}).click();
    const saved = await coming;
    await saved.saveAs(path);
    const look = JSON.parse(readFileSync(path, 'utf8'));
    check('a look is a file of its own', /-look\.json$/.test(saved.suggestedFilename()) && look.colormap === 'inferno_r' &&
        !look.input && !('zoom' in look), JSON.stringify(look));
    await page.locator('.presets button', {hasText: 'Grey ramp'}).click();
    await rest(page);
    await page.evaluate(() => window.snowglass.recipe.set({azimuth: 0}));
    check('another look is another picture', await bytes(page) !== shown && (await keys(page)).preset === 'linear');
    const choosing = page.waitForEvent('filechooser');
    await page.getByRole('button', {name: 'Open look'}).click();
    await (await choosing).setFiles(path);
    await page.waitForFunction(() => window.snowglass.recipe.keys.colormap === 'inferno_r');
    await rest(page);
    check('opened again it is the same picture, to the byte', await bytes(page) === shown);
    await page.keyboard.press('z');
    check('one step takes it back', (await keys(page)).preset === 'linear', JSON.stringify(await keys(page)));
    await rest(page);
}

async function groups({check, rest}, page) {
    const heads = await page.locator('details details summary').allTextContents();
    check('looks are in groups, those of the file first', String(heads) === 'General,CT,MR,PET,Microscopy,Simulation', heads);
    await page.locator('details details summary', {hasText: 'PET'}).click();
    const group = page.locator('details details', {hasText: 'PET'});
    await group.locator('img:not([hidden])').nth(2).waitFor();
    await group.getByRole('button', {name: /^Dark on white/}).click();
    await rest(page);
    const now = await keys(page);
    check('a look may be of several keys', now.mode === 'mip' && now.colormap === 'grey_r' && !now.preset, JSON.stringify(now));
    check('and is shown as chosen', await group.locator('[aria-pressed="true"]').count() === 1 &&
        await page.locator('.presets [aria-pressed="true"]').count() === 1);
    await page.locator('.presets button', {hasText: 'Automatic'}).click();
    await rest(page);
    check('its mode goes with it', !(await keys(page)).mode, JSON.stringify(await keys(page)));
    check('names of the tool stand in the tips', /\(ct-bone\)/.test(await page.locator('.presets button', {hasText: 'Bone'}).first()
        .getAttribute('title')));
}

export async function transfer(tools) {
    const page = await tools.open();
    for (const each of [axis, colors, file, groups])
        await each(tools, page);
    await page.screenshot({path: `${tools.folder}/transfer.png`});
    await tools.accessible(page);
    await page.context().close();
}

/** A channel gets its range from the file, which the tool would take too. */
export async function automatic({check, rest}, page) {
    const range = () => page.evaluate(() => window.snowglass.page.look.channels[1].slice(4, 6));
    const before = await range(), others = await page.evaluate(() => window.snowglass.page.look.channels[0]);
    await page.getByLabel(/^lowest value of the range of GFP/).fill('333');
    await page.keyboard.press('Enter');
    await rest(page);
    check('a range is set', (await range())[0] === 333, await range());
    await page.getByRole('button', {name: /Auto: Range of GFP/}).click();
    await page.waitForFunction(low => window.snowglass.page.answered.channels[1][4] === low, before[0]);
    await rest(page);
    check('and is automatic again, of this channel alone', String(await range()) === String(before) &&
        String(await page.evaluate(() => window.snowglass.page.look.channels[0])) === String(others), await range());
}
