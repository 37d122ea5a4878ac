// tests/serve/web/folder.mjs - the list of a folder in the page: four volumes "v1.nrrd",
// "v2.nrrd", "v10.nrrd" and "deep/<b>v3.nrrd", a recipe of v2 and a file that is cut.
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
    await page.keyboard.press('Escape');
    check('and stays until one is chosen', await page.locator('dialog.folder').getAttribute('open') !== null);
    await page.locator('.tiles button').first().focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Enter');
    await shown(page, 'v1.nrrd');
    check('the keyboard opens one', await page.locator('dialog.folder').getAttribute('open') === null);
    await page.evaluate(() => window.snowglass.recipe.set({title: 'mine', azimuth: 40}));
    await page.keyboard.press('n');
    await shown(page, 'v2.nrrd');
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
    await page.getByRole('button', {name: /warm.json/}).click();
    await shown(page, 'v2.nrrd');
    check('a recipe opens its volume', (await tools.keys(page)).azimuth === 33);
    const other = await open({}, link);
    await shown(other, '<b>v3.nrrd');
    await shown(page, '<b>v3.nrrd');
    check('a link names its volume, which all pages see', true);
    await other.context().close();
    await page.context().close();
}
