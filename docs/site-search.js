// site-search.js - finds words in the parts of the site's pages, of which
// search-index.js has a list; no server is asked.  The words of the field stand in
// the address, so that a result can be linked and the browser's "back" works.
const form = document.querySelector('main form');
const field = form.querySelector('input');
const list = document.querySelector('#found');
const told = document.querySelector('#told');

/** How well a part of a page fits all words; 0: it does not. */
function score(part, words) {
    let sum = 0;
    for (const word of words) {
        const inTitle = part.title.toLowerCase().includes(word);
        const inText = ` ${part.words}`.includes(` ${word}`);
        if (!inTitle && !inText)
            return 0;
        sum += (inTitle ? 10 : 0) + (inText ? 1 : 0) +
            (` ${part.words} `.includes(` ${word} `) ? 2 : 0);
    }
    return sum;
}

function shown(part) {
    const item = document.createElement('li'), link = document.createElement('a');
    const page = document.createElement('span'), text = document.createElement('p');
    link.href = part.address;
    link.textContent = part.title;
    page.textContent = part.page === part.title ? '' : ` - ${part.page}`;
    text.textContent = part.text;
    item.append(link, page, text);
    return item;
}

function search() {
    const words = field.value.toLowerCase().match(/[\p{L}\p{N}_-]+/gu) ?? [];
    const plain = words.map(word => word.replace(/^-+/, '')).filter(word => word.length > 1);
    const found = plain.length === 0 ? [] : window.searchIndex
        .map(part => ({part, fit: score(part, plain)}))
        .filter(one => one.fit > 0)
        .sort((a, b) => b.fit - a.fit);
    list.replaceChildren(...found.slice(0, 50).map(one => shown(one.part)));
    told.textContent = plain.length === 0 ? 'Give a word of two letters or more.'
        : found.length === 0 ? 'Nothing has all of these words; try fewer.'
        : found.length > 50 ? `${found.length} parts, the best 50:`
        : `${found.length} part${found.length > 1 ? 's' : ''}:`;
    history.replaceState(null, '', `?q=${encodeURIComponent(field.value)}`);
}

field.value = new URLSearchParams(location.search).get('q') ?? '';
form.addEventListener('submit', event => {
    event.preventDefault();
    search();
});
field.addEventListener('input', search);
if (field.value)
    search();
