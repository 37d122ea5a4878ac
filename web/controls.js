// controls.js - makes the elements of the page.  Texts from files and from the
// server become text, never markup.

/** An element with properties and children; names with "-" are attributes.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, unknown>} [properties]
 * @param {...(Node|string)} children
 * @returns {HTMLElementTagNameMap[T]} */
export function make(tag, properties = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(properties)) {
        if (name.includes('-') || name === 'for' || name === 'role')
            element.setAttribute(name, `${value}`);
        else
            Object.assign(element, {[name]: value});
    }
    element.append(...children);
    return element;
}

/** @param {string} text */
const words = text => ` ${text.toLowerCase().split(/[^a-z0-9-]+/).filter(Boolean).join(' ')} `;

/** Whether a name has the words of a text.
 * @type {(name: string, text: string) => boolean} */
const has = (name, text) => words(name).includes(words(text));

/** What is spoken begins with what is written, unless that is in it.
 * @param {string} text
 * @param {string} name
 * @param {() => void} press */
export function button(text, name, press) {
    return make('button', {type: 'button', textContent: text, title: name,
        'aria-label': /[a-z\d]/i.test(text) && !has(name, text) ? `${text}: ${name}` : name, onclick: press});
}

let count = 0;

/** A row with a name, which belongs to its first control unless that has another.
 * @param {string} name
 * @param {...HTMLElement} controls */
export function row(name, ...controls) {
    const [control] = controls;
    const own = control.getAttribute('aria-label') ?? name;
    control.id ||= `control${++count}`;
    return make('div', {className: 'row'}, has(own, name)
        ? make('label', {className: 'name', textContent: name, htmlFor: control.id})
        : make('span', {className: 'name', textContent: name}), ...controls);
}

/** @param {(string|string[])[]} options
 * @param {(value: string) => void} change */
export function select(options, change) {
    const list = make('select', {onchange: () => change(list.value)});
    for (const option of options) {
        const [value, text] = Array.isArray(option) ? option : [option, option];
        list.append(make('option', {value, textContent: text}));
    }
    return list;
}

/** @param {string} name
 * @param {(on: boolean) => void} change */
export function check(name, change) {
    const box = make('input', {type: 'checkbox', onchange: () => change(box.checked)});
    return {box, label: make('label', {}, box, ` ${name}`)};
}

/** A number that is taken when it is typed and left, or entered.
 * @param {string} name
 * @param {(value: number) => void} change
 * @param {number|'any'} step */
export function number(name, change, step = 'any') {
    const field = make('input', {type: 'number', step, 'aria-label': name,
        onchange: () => {
            if (Number.isFinite(field.valueAsNumber))
                change(field.valueAsNumber);
        }});
    return field;
}

/** @param {string} name
 * @param {(color: string) => void} change */
export function ink(name, change) {
    const field = make('input', {type: 'color', 'aria-label': name,
        oninput: () => change(field.value)});
    return field;
}

/** A line of text, taken as a number is.
 * @param {string} name
 * @param {(text: string) => void} change */
export function line(name, change) {
    const field = make('input', {type: 'text', 'aria-label': name, maxLength: 120,
        onchange: () => change(field.value)});
    return field;
}

/** A slider: `begin` and `end` enclose what is one step to undo.
 * @param {string} name
 * @param {number} low
 * @param {number} high
 * @param {number} step
 * @param {import('./store.js').Store} store
 * @param {(value: number) => void} change */
export function slider(name, low, high, step, store, change) {
    const input = make('input', {type: 'range', min: low, max: high, step,
        'aria-label': name,
        oninput: () => change(input.valueAsNumber),
        onchange: () => store.end()}); // let go elsewhere
    listen(input, {down: () => store.begin(), up: () => store.end()});
    return input;
}

/** @type {Record<string, keyof import('./types').Hearer>} */
const METHODS = {pointerdown: 'down', pointermove: 'move', pointerup: 'up', pointercancel: 'up',
    lostpointercapture: 'up', wheel: 'wheel', dblclick: 'doubled', keydown: 'key'};

/** Calls the methods of these names, as far as there are such; one that returns true has
 * done all.  Where the wheel means something, so do all buttons of the mouse.
 * @param {HTMLElement} element
 * @param {import('./types').Hearer} hearer */
export function listen(element, hearer) {
    for (const [name, method] of Object.entries(METHODS))
        if (hearer[method])
            element.addEventListener(name, event => hearer[method]?.(/** @type {any} */ (event)) &&
                event.preventDefault(), {passive: false});
    if (hearer.wheel)
        element.oncontextmenu = element.onauxclick = event => event.preventDefault();
}

/** What draws on a canvas.
 * @param {HTMLCanvasElement} canvas
 * @param {CanvasRenderingContext2DSettings} [options] */
export const context = (canvas, options) =>
    /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d', options));

/** A canvas to draw on in pixels of the page, with as many as the screen has; null where
 * it is not seen.
 * @param {HTMLCanvasElement} canvas
 * @param {CanvasRenderingContext2DSettings} [options] */
export function surface(canvas, options) {
    const {clientWidth: width, clientHeight: height} = canvas, dense = devicePixelRatio || 1;
    if (!width)
        return null;
    canvas.width = Math.round(width * dense);
    canvas.height = Math.round(height * dense);
    const g = context(canvas, options);
    g.scale(dense, dense);
    return {g, width, height};
}

/** Says of an element more than its name: what it does, and its key.
 * @template {Element} T
 * @param {T} element
 * @param {string} text */
export function tip(element, text) {
    element.setAttribute('title', text);
    return element;
}

/** What two fingers do, of which one has moved: the distance's factor, and the middle.
 * @param {Map<number, [number, number]>} fingers
 * @param {number} id
 * @param {[number, number]} now
 * @returns {[factor: number, x: number, y: number]} */
export function pinched(fingers, id, now) {
    const [, [x, y]] = [...fingers].find(([other]) => other !== id) ?? [id, now];
    /** @param {[number, number]} place */
    const far = ([a, b]) => Math.hypot(a - x, b - y) || 1;
    return [far(now) / far(fingers.get(id) ?? now), (now[0] + x) / 2, (now[1] + y) / 2];
}

/** @param {string} name
 * @param {boolean} open
 * @param {...(Node|string)} children */
export function section(name, open, ...children) {
    return make('details', {open}, make('summary', {textContent: name}),
        make('div', {}, ...children));
}

/** Gives a list its elements; a focused one stays so where none comes or goes.
 * @param {HTMLElement} list
 * @param {HTMLElement[]} elements */
export function fill(list, elements) {
    if (list.childElementCount !== elements.length)
        list.replaceChildren(...elements);
}

/** Sets a value unless it is there, or the user is typing there.
 * @param {HTMLInputElement|HTMLSelectElement} field
 * @param {string|number} value */
export function show(field, value) {
    if (field.value !== `${value}` && (document.activeElement !== field || field.type === 'range'))
        field.value = `${value}`;
}

/** Numbers to some digits of a range's width, so that they stay apart.
 * @param {number[]} values
 * @param {number} width
 * @param {number} digits */
export function near(values, width, digits) {
    const places = digits - 1 - Math.floor(Math.log10(width));
    return values.map(x => +x.toFixed(Math.max(0, Math.min(100, places || 0))));
}

/** @param {number[]} range
 * @param {number} digits
 * @returns {import('./types').Pair} */
export const apart = ([low, high], digits) => {
    const [a, b] = near([low, high], high - low, digits);
    return [a, b];
};

/** At most five digits, without zeros at the end.
 * @param {number} value */
export const short = value => String(+Number(value).toPrecision(5));
