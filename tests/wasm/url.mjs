// url.mjs - the page without a server opens volumes on servers, in Chromium.
//
//   node url.mjs PLAYWRIGHT CHROMIUM FOLDER PAGES
//
// PAGES is a JSON list of {url, cases}; each case has a `name`, the `address` that is typed
// into the page's field, by keys alone (none: the page's own address names it), and `says`,
// a pattern of a line that refuses it (none: it is shown), and perhaps a `time` step that is
// looked at too.  In FOLDER there are
// then of each NAME-rest.png and NAME.txt, as of page.mjs, and in results.json what was said,
// and what the page asked for.
import {writeFileSync} from 'node:fs';
import {SELDOM, browser, folder, keep, pages, settled} from './browser.mjs';

const results = {};
let page, wrong = 0;

function fail(text) {
    console.log(`FAILED ${text}`);
    wrong++;
}

const rest = () => settled(page);
const said = () => page.evaluate(() => document.querySelector('.said')?.textContent);

/** By the keyboard, as without a mouse. */
async function type(name, address) {
    await page.getByRole('button', {name: 'Open from a URL'}).focus();
    await page.keyboard.press('Enter');
    const field = page.getByLabel('Address');
    await field.waitFor();
    if (name === 'shard')
        await page.screenshot({path: `${folder}/field.png`});
    await page.keyboard.type(address);
    await page.keyboard.press('Enter');
    const refused = await page.evaluate(() => document.querySelector('dialog[open] [role=alert]')?.textContent);
    if (refused) {
        if (name === 'ftp')
            await page.screenshot({path: `${folder}/field-wrong.png`});
        await page.keyboard.press('Escape');
    }
    return refused;
}

/** All lines until the volume is shown, or refused. */
async function open({name, address, says, time}) {
    const before = await page.evaluate(() => {
        const lines = window.lines = [];
        const note = () => {
            const text = document.querySelector('.said')?.textContent;
            if (text && text !== lines.at(-1))
                lines.push(text);
        };
        window.watching?.disconnect();
        window.watching = new MutationObserver(note);
        window.watching.observe(document.body, {subtree: true, childList: true, characterData: true});
        note();
        window.was = window.snowglass;
        return window.was?.page.info?.name;
    });
    const refused = address === undefined ? null : await type(name, address);
    if (refused) {
        results[name] = {said: [refused], shown: before, search: await page.evaluate(() => location.search)};
        return;
    }
    const done = says ? pattern => window.lines.some(line => new RegExp(pattern).test(line))
        : () => window.snowglass !== window.was && window.snowglass?.page.info;
    if (address !== undefined || says)
        await page.waitForFunction(done, says, {...SELDOM, timeout: 60000}).catch(error =>
            fail(`${name}: ${error.message}`));
    if (!says)
        await keep(page, name);
    else if (name === 'broken')
        await page.screenshot({path: `${folder}/refused.png`});
    const lines = await page.evaluate(() => window.lines);
    if (time !== undefined) {
        await page.evaluate(step => window.snowglass.store.set({time: step}), time);
        await keep(page, `${name}-time`);
    }
    results[name] = {said: address === undefined ? [...lines, await said()] : lines,
        shown: await page.evaluate(() => window.snowglass?.page.info?.name),
        search: await page.evaluate(() => location.search)};
}

for (const {url, cases} of pages) {
    page = await browser.newPage({viewport: {width: 640, height: 400}});
    page.setDefaultTimeout(300000);
    page.on('pageerror', error => fail(`${url}: ${error}`));
    await page.goto(url, {timeout: 300000});
    await rest();
    for (const each of cases) {
        const begin = performance.now();
        await open(each);
        console.log(`       ${each.name}: ${((performance.now() - begin) / 1000).toFixed(1)} s`);
    }
    if (cases.length === 0) { // an exported page
        results.exported = await page.evaluate(async () => {
            const violated = [];
            document.addEventListener('securitypolicyviolation', event => violated.push(event.violatedDirective));
            const inWorker = text => new Promise(done => {
                const worker = new Worker(URL.createObjectURL(new Blob([text], {type: 'text/javascript'})));
                worker.onmessage = ({data}) => done(data);
            });
            const far = `${location.origin}/cors/told`;
            return {fetched: await fetch(far).then(() => true, () => false), violated,
                byWorker: await inWorker(`try { const r = new XMLHttpRequest(); r.open('GET', '${far}', false); r.send();
                    postMessage(true) } catch { postMessage(false) }`),
                beacon: navigator.sendBeacon(far),
                field: [...document.querySelectorAll('button')].some(each => each.textContent === 'URL'),
                shown: window.snowglass.page.info.name};
        });
        await page.screenshot({path: `${folder}/exported.png`});
    }
    await page.close();
}
writeFileSync(`${folder}/results.json`, JSON.stringify(results));
await browser.close();
process.exit(wrong ? 1 : 0);
