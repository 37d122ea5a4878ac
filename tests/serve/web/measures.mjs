// tests/serve/web/measures.mjs - lengths, angles and ellipses of the page, and what it says
// of what lies under the pointer; of a volume of 40 x 30 x 20 voxels of 1 x 2 x 4 mm, whose
// first one is at (10, -20, 30): voxel (i, j, k) has the value i + 10 j + k.
import {readFileSync, writeFileSync} from 'node:fs';

const STEP = [1, 2, 4], FIRST = [10, -20, 30];
const words = page => page.evaluate(() => (window.snowglass.recipe.keys.measure ?? '').split('; ').filter(Boolean));
const items = page => page.evaluate(() => window.snowglass.measure.items);
const points = text => text.split(' ').filter(word => word.split(',').length === 3).map(word => word.split(',').map(Number));

/** Where a voxel is in the pane of a slice across z, whose x is to the patient's left. */
async function spotOf(page, [i, j]) {
    const box = await page.locator('.pane canvas').first().boundingBox();
    const [width, height] = [40 * STEP[0], 30 * STEP[1]], scale = Math.min(box.width / width, box.height / height);
    return [box.x + box.width / 2 + (width / 2 - (i + 0.5) * STEP[0]) * scale,
        box.y + box.height / 2 + (height / 2 - (j + 0.5) * STEP[1]) * scale];
}

async function drag(page, from, to) {
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
    await page.mouse.move(...to);
    await page.mouse.up();
}

const known = (page, count) => page.waitForFunction(n => {
    const all = window.snowglass.measure.items;
    return all.length === n && all.every(item => item.result);
}, count, {polling: 20});

const near = (a, b, most) => Math.abs(a - b) <= most;

export async function measures(tools) {
    const page = await tools.open();
    await page.keyboard.press('x');
    await tools.slicesRest(page);
    await slices(tools, page);
    await pointed(tools, page);
    await chosen(tools, page);
    await surface(tools, page);
    await left(tools, page);
    await page.context().close();
}

/** A pixel of the pane is some share of a voxel. */
async function slices({check, rest}, page) {
    const [a, b, c] = await Promise.all([[5, 4], [25, 19], [25, 4]].map(at => spotOf(page, at)));
    await page.keyboard.press('u');
    await drag(page, a, b);
    await known(page, 1);
    const [{result}] = await items(page), [line] = await words(page);
    const wanted = Math.hypot(20 * STEP[0], 15 * STEP[1]);
    check('a line on a slice is as long as it is in the world', near(result.length, wanted, 0.5), `${result.length}, not ${wanted}`);
    check('it lies in the slice', points(line).every(point => near(point[2], FIRST[2] + 10 * STEP[2], 1e-3)), line);
    check('its ends are under the pointer', near(points(line)[0][0], FIRST[0] + 5, 0.3) &&
        near(points(line)[0][1], FIRST[1] + 8, 0.6), line);
    await page.keyboard.press('a');
    for (const spot of [a, c, b])
        await page.mouse.click(...spot);
    await known(page, 2);
    const angle = (await items(page))[1].result.degrees;
    check('three clicks make an angle', near(angle, 90, 1.5), angle);
    await page.keyboard.press('e');
    await drag(page, a, b);
    await known(page, 3);
    const ellipse = (await items(page))[2].result, area = Math.PI * 10 * 15;
    check('a drag makes an ellipse', near(ellipse.area, area, 0.04 * area), `${ellipse.area}, not ${area}`);
    check('with values of its voxels', near(ellipse.mean, 15 + 115 + 10, 3) && near(ellipse.count, area / 2, 0.05 * area) &&
        ellipse.unit === 'mm', JSON.stringify(ellipse));
    await page.keyboard.press('Escape');
    check('Escape puts the tool away', await page.evaluate(() => !window.snowglass.measure.tool), '');
    await rest(page);
}

async function pointed({check}, page) {
    await page.mouse.move(...await spotOf(page, [30, 7]));
    await page.waitForFunction(() => document.querySelector('.probe')?.textContent, null, {polling: 20});
    const text = await page.locator('.probe').textContent();
    const [, right, back, up, value] = text.match(/^R ([\d.]+) {2}P ([\d.]+) {2}S ([\d.]+) mm: {2}([\d.]+)$/) ?? [];
    check('the pointer names place and value', near(right, 40, 0.6) && near(back, 6, 1.1) && near(up, 70, 1e-6) &&
        near(value, 30 + 70 + 10, 11), text);
}

/** Points of the chosen measure go where they are dragged. */
async function dragged({check, rest}, page) {
    const before = await words(page);
    await drag(page, await spotOf(page, [25, 19]), await spotOf(page, [30, 4]));
    await known(page, 3);
    const [line] = await items(page), now = await words(page), [from, to] = points(now[0]);
    check('the end of a line is dragged', near(to[0], FIRST[0] + 30, 0.3) && near(to[1], FIRST[1] + 8, 0.6) &&
        near(from[0], FIRST[0] + 5, 0.3) && near(line.result.length, 25, 0.5), `${now[0]} ${line.result.length}`);
    check('others stay', String(now.slice(1)) === String(before.slice(1)), now);
    await page.evaluate(() => window.snowglass.measure.choose(2));
    await rest(page);
    await drag(page, await spotOf(page, [15, 11.5]), await spotOf(page, [18, 12.5]));
    await known(page, 3);
    const ellipse = points((await words(page))[2]);
    check('an ellipse moves by its middle', ellipse.every((point, i) =>
        near(point[0], FIRST[0] + [18, 28, 18][i], 0.4) && near(point[1], FIRST[1] + 2 * [12.5, 12.5, 20][i], 0.7)), ellipse.join(' '));
    await drag(page, await spotOf(page, [28, 12.5]), await spotOf(page, [23, 20]));
    await known(page, 3);
    const narrow = (await items(page))[2].result;
    check('and is as wide as its end says', near(narrow.area, Math.PI * 5 * 15, 0.06 * narrow.area), narrow.area);
    for (let n = 0; n < 4; n++) // the ellipse was gone to, too
        await page.keyboard.press('z');
    await rest(page);
    check('each is a step', String(await words(page)) === String(before), await words(page));
}

async function chosen(tools, page) {
    const {check, rest} = tools;
    await page.mouse.click(...await spotOf(page, [15, 11.5]));
    const which = () => page.evaluate(() => window.snowglass.measure.chosen);
    check('a click on a line chooses it', await which() === 0, await which());
    await dragged(tools, page);
    await page.mouse.click(...await spotOf(page, [15, 11.5]));
    await page.keyboard.press('Delete');
    await rest(page);
    check('Delete deletes it alone', (await words(page)).map(text => text.split(' ')[0]).join() === 'angle,ellipse', await words(page));
    await page.keyboard.press('z');
    await rest(page);
    check('which is undone', (await words(page)).length === 3, await words(page));
    await page.locator('summary', {hasText: 'Measures'}).click();
    await page.getByLabel('Delete measure 2 (Delete)').click();
    await rest(page);
    check('the panel deletes, too', (await words(page)).map(text => text.split(' ')[0]).join() === 'line,ellipse', await words(page));
    await page.getByLabel('Choose measure 2').click();
    check('and chooses', await which() === 1, await which());
    for (let n = 0; n < 3 && (await words(page)).length < 3; n++) { // slices may have gone there
        await page.keyboard.press('z');
        await rest(page);
    }
}

/** From the front all of the block's face is at the far end of y. */
async function surface({check, rest}, page) {
    const box = await page.locator('.picture canvas').first().boundingBox();
    const at = (x, y) => [box.x + box.width * x, box.y + box.height * y];
    await page.keyboard.press('x');
    await page.keyboard.press('1');
    await rest(page);
    await page.keyboard.press('u');
    const wide = await page.locator('.picture canvas').first().boundingBox();
    const spot = (x, y) => [wide.x + wide.width * x, wide.y + wide.height * y];
    await page.mouse.click(...spot(0.48, 0.45));
    await page.mouse.click(...spot(0.53, 0.55));
    await known(page, 4);
    const [from, to] = points((await words(page))[3]);
    const face = FIRST[1] + 29.5 * STEP[1];
    check('two points of the surface make a line on it', near(from[1], face, 2.1) && near(to[1], face, 2.1), `${from} ${to}`);
    await page.keyboard.press('e');
    await page.mouse.click(...at(0.2, 0.5));
    check('an ellipse is for slices', (await page.locator('.said').textContent()).includes('on a slice'), '');
    await page.keyboard.press('Escape');
}

/** The command and the picture of it all; a link with a bad measure. */
async function left({check, folder, part, rest}, page) {
    await rest(page);
    await page.getByRole('button', {name: 'Command'}).first().click();
    await page.waitForSelector('dialog[open] textarea');
    const text = await page.locator('dialog textarea').inputValue();
    await page.keyboard.press('Escape');
    check('the command has the measures', text.includes(" --measure 'line "), text);
    writeFileSync(`${folder}/${part().name}_command.txt`, text);
    const [saved] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', {name: 'Save the picture (s)'}).click()]);
    writeFileSync(`${folder}/${part().name}_rest.png`, readFileSync(await saved.path()));
    const before = await words(page);
    await page.evaluate(() => window.snowglass.recipe.set({measure: 'line 1,2'}));
    await page.waitForFunction(() => /measure/.test(document.querySelector('.said').textContent), null, {polling: 20});
    await page.waitForFunction(n => (window.snowglass.recipe.keys.measure ?? '').split('; ').length === n, before.length, {polling: 20});
    check('bad words are refused, and change nothing', String(await words(page)) === String(before), await words(page));
}
