// notebook.js - the viewer's page in a cell of a notebook, by the conventions of
// anywidget; the kernel is its renderer.  snowglass/viewer.py puts this behind
// `begin`, which has the modules of the page, and `STYLE`.

/** What the page takes for its document: the cell's part of the real one. */
function pageIn(root, main) {
    const own = {
        getElementById: () => main,
        addEventListener: (...words) => root.addEventListener(...words),
        removeEventListener: (...words) => root.removeEventListener(...words),
        get activeElement() {
            return root.activeElement;
        },
        title: ''};
    return new Proxy(document, {
        get(real, name) {
            if (name in own)
                return own[name];
            const value = real[name];
            return typeof value === 'function' ? value.bind(real) : value;
        },
        set(real, name, value) {
            own[name] = value;
            return true;
        }});
}

function render({model, el}) {
    const place = document.createElement('div'), main = document.createElement('main');
    const style = document.createElement('style'), root = place.attachShadow({mode: 'open'});
    place.className = 'snowglass-viewer';
    place.style.height = `${model.get('height')}px`;
    // Keys are the viewer's while it has the focus, and not the notebook's.
    place.dataset.lmSuppressShortcuts = place.dataset.jpSuppressContextMenu = 'true';
    place.addEventListener('keydown', event => event.stopPropagation());
    style.textContent = STYLE;
    root.append(style, main);
    el.append(place);
    const page = begin({model, document: pageIn(root, main),
        window: {}, location: {hash: '', href: location.href}});
    main.querySelector('[title^="Copy a link"]')?.remove(); // none leads here
    place.snowglass = page; // for the console, and for tests
    return () => page.engine.close();
}

export default {render};
