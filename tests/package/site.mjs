// tests/package/site.mjs - opens every page of the site without a server:
//
//   node site.mjs MODULES CHROMIUM SITE [PATTERN]
//
// axe-core finds nothing that keeps people out, narrow and light; of one page in
// eight, since all have one style, colours stand out also dark and wide.  No page is
// wider than the window; the search finds parts of pages.  PATTERN picks pages by
// their paths.
import {createRequire} from 'node:module';
import {readFileSync, readdirSync} from 'node:fs';
import {pathToFileURL} from 'node:url';
import {join, relative} from 'node:path';

const [modules, chromium, site, pattern = ''] = process.argv.slice(2);
const {chromium: browsers} = createRequire(join(modules, 'x.js'))('playwright-core');
const axe = readFileSync(join(modules, 'axe-core', 'axe.min.js'), 'utf8');
const browser = await browsers.launch({executablePath: chromium, args: ['--no-sandbox']});
const pages = readdirSync(site, {recursive: true, withFileTypes: true})
    .filter(one => one.name.endsWith('.html'))
    .map(one => join(one.parentPath ?? one.path, one.name))
    .filter(path => !relative(site, path).startsWith('demo') && path.match(pattern));
let failed = 0;

function check(name, good, why = '') {
    if (!good)
        failed++;
    if (!good || why === 'show')
        console.log(`${good ? 'ok    ' : 'FAILED'} ${name} ${good ? '' : why}`);
}

/** What axe-core finds in the page that is open, by all rules or some, as lines. */
async function findings(page, rules = null) {
    if (!await page.evaluate(() => Boolean(window.axe)))
        await page.evaluate(axe);
    const found = await page.evaluate(
        some => window.axe.run(some ? {runOnly: {type: 'rule', values: some}} : {}), rules);
    return found.violations.map(one => `${one.id}: ${one.help}: ` +
        one.nodes.slice(0, 3).map(node => node.html.slice(0, 120)).join(' | '));
}

/** How a page is looked at, one after the other; the first is asked for all. */
const ways = [[400, 'light'], [400, 'dark'], [1600, 'dark'], [1600, 'light']];

for (const [n, path] of pages.entries()) {
    const page = await browser.newPage({viewport: {width: 400, height: 900}, colorScheme: 'light'});
    await page.goto(pathToFileURL(path).href);
    for (const [width, colorScheme] of ways.slice(0, n % 8 === 0 ? ways.length : 1)) {
        const name = `${relative(site, path)} at ${width}, ${colorScheme}`;
        await page.setViewportSize({width, height: 900});
        await page.emulateMedia({colorScheme});
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        check(name, wide <= width, `is ${wide} wide`);
        const first = width === 400 && colorScheme === 'light';
        const found = await findings(page, first ? null : ['color-contrast']);
        check(name, found.length === 0, found.join('; '));
    }
    await page.close();
}

const page = await browser.newPage();
await page.goto(pathToFileURL(join(site, 'docs', 'movies.html')).href);
await page.getByLabel('Search').fill('turntable frames');
await page.keyboard.press('Enter');
await page.waitForURL(/search\.html\?q=turntable/);
const first = page.locator('#found li a').first();
check('the search finds movies', await page.locator('#found a[href^="docs/movies"]').count() > 0);
check('and says how many', /^\d+ parts/.test(await page.locator('#told').textContent()));
const wanted = await first.getAttribute('href');
await first.click();
check('a result leads to its part', page.url().endsWith(wanted), page.url());
await page.goBack();
check('"back" shows the results', await page.locator('#found li').count() > 1);
await page.getByRole('searchbox').fill('snow_frame_render');
check('names of functions are found', await page.locator('#found a[href*="c-api"]').count() > 0);
await page.getByRole('searchbox').fill('<b>qqqq');
check('what is not there', /Nothing has/.test(await page.locator('#told').textContent()));
check('makes no markup', await page.locator('main b').count() === 0);
check('axe of results', (await findings(page)).length === 0);
await browser.close();
console.log(`${pages.length} pages, ${failed} failed`);
process.exit(failed ? 1 : 0);
