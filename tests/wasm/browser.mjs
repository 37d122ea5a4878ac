// browser.mjs - what page.mjs and url.mjs share: Chromium without a GPU, and a page that has
// drawn all.
//
//   node page.mjs|url.mjs PLAYWRIGHT CHROMIUM FOLDER PAGES
import {writeFileSync} from 'node:fs';

const [playwright, chromium, given, list] = process.argv.slice(2);
const {chromium: browsers} = await import(playwright);
export const folder = given, pages = JSON.parse(list);
export const browser = await browsers.launch({executablePath: chromium,
    args: ['--no-sandbox', '--disable-gpu', '--disable-software-rasterizer']});
export const SELDOM = {polling: 20}; // ms: for each frame that is looked at, the page draws one

export const settled = page => page.waitForFunction(() => {
    const {engine, page: of} = window.snowglass ?? {};
    return of?.rest && !engine.waiting && !engine.sentAt.size;
}, null, SELDOM);

/** Writes the picture at rest, NAME-rest.png, and its command, NAME.txt. */
export async function keep(page, name) {
    await settled(page);
    const picture = await page.evaluate(() => new Promise(done => {
        const reader = new FileReader();
        reader.onload = () => done(reader.result.split(',')[1]);
        reader.readAsDataURL(window.snowglass.page.rest);
    }));
    writeFileSync(`${folder}/${name}-rest.png`, Buffer.from(picture, 'base64'));
    await page.locator('button', {hasText: 'Command'}).first().click();
    writeFileSync(`${folder}/${name}.txt`, await page.locator('dialog[open] textarea').inputValue());
    await page.keyboard.press('Escape');
}
