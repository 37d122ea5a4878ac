// tests/serve/web/layouts.mjs - how picture and slices lie, one zoom for all, lines, slabs,
// the cube of directions and drags over the poles; of the volume of measures.mjs.
import {writeFileSync} from 'node:fs';

const SPACING = [1, 2, 4], DIMS = [40, 30, 20], HALF = 18; // of the cube, in pixels
const held = page => page.evaluate(() => window.snowglass.recipe.keys);
const boxOf = (page, selector) => page.locator(selector).boundingBox();
const area = ({width, height}) => width * height;

export async function layouts(tools) {
    const page = await tools.open();
    await cube(tools, page);
    await dragged(tools, page);
    await arranged(tools, page);
    await zoomed(tools, page);
    await lined(tools, page);
    await thick(tools, page);
    await linked(tools, page);
    await tumbled(tools, page);
    await page.context().close();
}

/** Where a face is: its normal, in the camera's directions. */
async function cube({check, rest}, page) {
    await page.evaluate(() => window.snowglass.recipe.set({view: 'anterior', azimuth: 35, elevation: 25}));
    await rest(page);
    const [az, el] = [35, 25].map(x => x * Math.PI / 180), origin = await page.locator('.cube').evaluate(
        element => [element.getBoundingClientRect().left, element.getBoundingClientRect().top]);
    const face = name => page.getByRole('button', {name: `look from ${name}`});
    // From the front the patient's left is at the right.
    for (const [name, x, y] of [['anterior', -Math.sin(az), Math.sin(el) * Math.cos(az)],
        ['left', Math.cos(az), Math.sin(el) * Math.sin(az)], ['superior', 0, -Math.cos(el)]]) {
        const box = await face(name).boundingBox();
        const [dx, dy] = [box.x + box.width / 2 - origin[0] - HALF * x, box.y + box.height / 2 - origin[1] - HALF * y];
        check(`the cube shows ${name} where it is`, Math.hypot(dx, dy) < 0.2, `${dx} ${dy}`);
    }
    check('and three faces', await page.locator('.cube button:visible').count() === 3);
    await face('left').click();
    await rest(page);
    const {view, azimuth, elevation} = await held(page);
    check('a press of a face looks from there', view === 'left' && !azimuth && !elevation, `${view} ${azimuth}`);
    check('which is then the only one', await page.locator('.cube button:visible').textContent() === 'L');
    await page.getByLabel('cube of directions').uncheck();
    check('the cube can be hidden', await page.locator('.cube button:visible').count() === 0);
    await page.getByLabel('cube of directions').check();
}

/** While the camera is dragged the page does not change but for what shows the camera, which
 * follows the pictures: a processor that draws both has no time for more. */
async function dragged({check, rest}, page) {
    await page.evaluate(() => {
        const {store} = window.snowglass;
        window.changes = 0;
        store.onChange(() => window.changes++);
        store.begin();
        store.set({azimuth: 50});
    });
    await page.waitForFunction(() => !window.snowglass.store.moved);
    const turn = () => page.getByRole('button', {name: 'look from left'}).evaluate(
        element => new DOMMatrix(getComputedStyle(element).transform).e / 18);
    const during = await turn(), expected = -Math.sin(50 * Math.PI / 180); // it is seen from the left
    await page.evaluate(() => window.snowglass.store.set({azimuth: -30}));
    const changes = await page.evaluate(() => window.changes);
    await page.evaluate(() => window.snowglass.store.end());
    check('in a drag of the camera nothing else is brought up to date', changes === 0, changes);
    check('but the cube, with its picture', Math.abs(during - expected) < 0.01, `${during} ${expected}`);
    check('and the angles when it ends', await page.getByLabel('azimuth in degrees').inputValue() === '-30');
    await page.evaluate(() => window.snowglass.store.set({azimuth: 0}));
    await rest(page);
}

/** Each layout by its button. */
async function arranged({check, judged, rest, slicesRest}, page) {
    const group = page.getByRole('group', {name: 'Layout'}), choose = async name => {
        await group.getByText(name, {exact: true}).click();
        await rest(page);
        if (await page.locator('.pane').count())
            await slicesRest(page);
        const pressed = await group.locator('[aria-pressed="true"]').allTextContents();
        check(`${name} is pressed`, pressed.length === 1 && name.startsWith(pressed[0]), pressed);
        const boxes = await Promise.all(['.picture', ...[0, 1, 2].map(i => `.pane >> nth=${i}`)].map(
            async selector => await page.locator(selector).count() ? area(await boxOf(page, selector)) : 0));
        await judged(page, name);
        return boxes;
    };
    let [picture, ...panes] = await choose('3D + 3');
    check('beside three slices the picture is large', panes.every(each => each > 0 && 3 * each < picture), `${picture} ${panes}`);
    [picture, ...panes] = await choose('2 x 2');
    check('of four all are alike', panes.every(each => Math.abs(each - picture) < 0.03 * picture), `${picture} ${panes}`);
    [picture, ...panes] = await choose('Slice');
    check('one slice is large', picture > 0 && panes[0] > 3 * Math.max(picture, panes[1], panes[2]), `${picture} ${panes}`);
    panes = (await choose('Slice')).slice(1);
    check('once more, the next one is', panes[1] > 3 * Math.max(panes[0], panes[2]), panes);
    await page.keyboard.press('x');
    await rest(page);
    check('x puts slices away', await page.locator('.pane').count() === 0);
    await page.keyboard.press('x');
    await slicesRest(page);
    check('and brings them back as they were', await page.locator('.pane.large').evaluate(
        element => element.clientWidth > 300), '');
    await choose('2 x 2');
}

/** Pixels of the screen for a millimetre, in each pane: of its slice's corners. */
const scales = page => page.evaluate(([dims, spacing]) => window.snowglass.slices.panes.map(
    ({place, info}) => [place.scale * info.width / (dims[info.right[0]] * spacing[info.right[0]]),
        place.scale * info.height / (dims[info.down[0]] * spacing[info.down[0]])]), [DIMS, SPACING]);

async function zoomed({check, slicesRest, wheel}, page) {
    const fits = (await scales(page)).map(([across]) => across);
    check('slices fit at first, each in its pane', Math.max(...fits) > 1.05 * Math.min(...fits), fits);
    const box = await boxOf(page, '.pane canvas >> nth=1');
    const zoom = async by => {
        await page.mouse.move(box.x + box.width * 0.6, box.y + box.height * 0.4);
        await page.keyboard.down('Control');
        await wheel(page, by);
        await page.keyboard.up('Control');
    };
    await zoom(-240);
    const all = (await scales(page)).flat(), most = Math.max(...all), least = Math.min(...all);
    check('a zoom of one is that of all, in millimetres', most < 1.03 * least && least > 1.5 * fits[1], all);
    const seen = await page.evaluate(() => window.snowglass.slices.panes.every(pane => {
        const {place, cross, canvas} = pane, [x, y] = [place.x + cross[0] * place.scale, place.y + cross[1] * place.scale];
        return x > 0 && y > 0 && x < canvas.clientWidth && y < canvas.clientHeight;
    }));
    check('and they still show where they cross', seen);
    await page.locator('summary', {hasText: 'Slices'}).click();
    await page.getByLabel('one zoom for all').uncheck();
    await zoom(-120);
    const apart = (await scales(page)).map(([across]) => across);
    check('zooms may be apart', apart[1] > 1.2 * apart[0] && Math.abs(apart[0] - apart[2]) < 0.03 * apart[0], apart);
    await page.getByLabel('one zoom for all').check();
    await zoom(3000);
    const again = (await scales(page)).map(([across]) => across);
    check('far out, all fit again', again.every((x, i) => Math.abs(x - fits[i]) < 1e-6), `${again} ${fits}`);
    await slicesRest(page);
}

/** Pixels of the line that goes across a pane. */
const colored = page => page.evaluate(() => {
    const {canvas, place, cross} = window.snowglass.slices.panes[0], dense = devicePixelRatio;
    const row = Math.round((place.y + cross[1] * place.scale) * dense);
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [canvas.width, 3];
    const g = copy.getContext('2d', {willReadFrequently: true});
    g.drawImage(canvas, 0, 1 - row);
    const {data} = g.getImageData(0, 0, canvas.width, 3);
    return data.reduce((sum, _, i) => sum + (i % 4 === 0 && Math.abs(data[i] - data[i + 1]) > 60 ? 1 : 0), 0);
});

async function lined({check}, page) {
    const drawn = await colored(page);
    await page.keyboard.press('h');
    const hidden = await colored(page);
    check('lines where slices cross can be hidden', drawn > 100 && hidden === 0, `${drawn} ${hidden}`);
    check('and the panel says so', !await page.getByLabel('lines where they cross (h)').isChecked());
    await page.keyboard.press('h');
}

/** Slabs are those of the tool, whose command the page gives. */
async function thick({check, copied, keepBytes, file, slicesRest}, page) {
    await page.getByLabel('Slab', {exact: true}).selectOption('mean');
    await page.getByLabel('thickness in mm').fill('9');
    await page.keyboard.press('Enter');
    await slicesRest(page);
    check('a slab is in the state of slices', (await held(page)).slices.slab === '9mm:mean', JSON.stringify((await held(page)).slices));
    await page.locator('.pane canvas').nth(1).focus();
    await page.keyboard.press('c');
    const command = await copied(page);
    check('the command has it', command.includes(' --slab 9mm:mean'), command);
    writeFileSync(file('slice.txt'), command);
    await keepBytes(page, 'slice.png', 'page.slices.panes[1].file');
    await page.evaluate(() => window.snowglass.slices.set({slab: '0mm:max'}));
    await page.waitForFunction(() => window.snowglass.slices.panes.every(pane => !pane.busy && !pane.bitmap), null, {polling: 20});
    check('what cannot be drawn has no picture of something else', true);
    await page.evaluate(() => window.snowglass.slices.set({slab: '9mm:mean'}));
    await slicesRest(page);
}

async function linked({check, open}, page) {
    await page.getByRole('button', {name: 'Copy a link'}).click();
    await page.waitForSelector('dialog[open] textarea');
    const url = await page.locator('dialog textarea').inputValue();
    await page.keyboard.press('Escape');
    const other = await open({}, url), {slices} = await held(other);
    check('a link keeps the layout', slices?.layout === 'grid' && slices.slab === '9mm:mean' &&
        await other.locator('[data-layout="grid"]').count() === 1, JSON.stringify(slices));
    await other.context().close();
}

/** Twice over the head: the picture is that of the command. */
async function tumbled({check, copied, file, keepBytes, rest}, page) {
    await page.keyboard.press('x');
    await page.keyboard.press('1');
    await rest(page);
    await page.getByLabel('Drag').selectOption('tumble');
    const box = await boxOf(page, '.picture canvas >> nth=0');
    for (const by of [1, 1]) {
        await page.mouse.move(box.x + box.width / 2, box.y + box.height * 0.2);
        await page.mouse.down();
        await page.mouse.move(box.x + box.width / 2, box.y + box.height * (0.2 + 0.35 * by), {steps: 7});
        await page.mouse.up();
    }
    await rest(page);
    const {azimuth, elevation, roll} = await held(page); // 2 * 0.35 * 180 degrees over the head
    const near = (x, y) => Math.abs((x - y + 540) % 360 - 180) < 0.2;
    check('a drag goes over the poles', near(elevation, 54) && near(azimuth, 180) && near(roll, 180),
        `${azimuth} ${elevation} ${roll}`);
    await page.locator('.picture canvas').first().focus();
    await page.keyboard.press('c');
    writeFileSync(file('command.txt'), await copied(page));
    await keepBytes(page, 'rest.png', 'page.page.rest');
    await page.getByLabel('Drag').selectOption('turn');
}
