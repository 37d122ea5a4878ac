// panel.js - the controls beside the picture.

import {facing, grips, isFull, PLANES_MOST, tilted, tiltedTo} from './clip.js';
import {Channels} from './channels.js';
import {Colors, ownColors, painted, ranged, text, upright} from './colors.js';
import {button, check, ink, line, make, number, row, section, select, short, show, slider, tip}
    from '../controls.js';
import {WORLD_VIEWS} from '../cube.js';
import {BY_GRADIENT, Editor} from './editor.js';
import {MODE_NAMES, VIEWS} from '../keys.js';
import {mixed, overlayKeys} from '../look.js';
import {axisNames} from './overlay.js';
import {NO_SHAPE, Presets} from './presets.js';
import {FEW, known} from '../store.js';

/** @typedef {import('../types').Keys} Keys */
/** @typedef {import('../types').Label} Label */
/** @typedef {import('../types').Point} Point */

/** Keys of the look of labels, of the volume or the overlay: as they are, and changes of them.
 * @typedef {{get: (keys: Keys) => {opacity?: Point[], colormap?: string},
 *   set: (changes: {preset?: string, colormap?: string, range?: number[], opacity?: Point[]}) => void}} Own */

const AXES = ['x', 'y', 'z'];
const FIRST_PANE = 4;
const FOV_MOST = 120; // degrees

/** @param {number[]} list
 * @param {number} i
 * @param {number} value */
const swap = (list, i, value) => list.map((old, k) => k === i ? value : old);
/** @param {Keys} keys */
const material = keys => keys.material ?? [0.2, 0.7, 0.2, 20];

/** The light's, to the right and up, where it has one.
 * @param {Keys} keys */
const direction = ({light}) => Array.isArray(light) ? light : [0, 0];

/** @param {{low: number, high: number}} look */
const middle = ({low, high}) => (low + high) / 2;

export class Panel {
    /** @param {import('../store.js').Store} store
     * @param {import('../types').Actions} actions
     * @param {import('../slices.js').Slices} slices
     * @param {import('../measure.js').Measure} measure
     * @param {import('./time.js').Times} times
     * @param {import('./movies.js').Movies} movies */
    constructor(store, actions, slices, measure, times, movies) {
        const {engine} = store;
        this.store = store;
        this.engine = engine;
        this.actions = actions;
        this.slices = slices;
        this.measure = measure;
        this.times = times;
        this.movies = movies;
        /** @type {HTMLDetailsElement|null} */
        this.clips = null;
        this.whole = [0, 0, 0]; // voxels without a crop
        this.editor = new Editor(store);
        this.gradient = new Editor(store, BY_GRADIENT);
        this.colors = new Colors(store);
        this.presets = new Presets(store, actions);
        this.channels = new Channels(store, {...NO_SHAPE, preset: null, component: null});
        this.element = make('aside', {className: 'panel', 'aria-label': 'Controls'});
        /** @type {((keys: Readonly<Keys>) => void)[]} */
        this.updates = [];
        /** Of the camera.
         * @type {((keys: Readonly<Keys>) => void)[]} */
        this.turns = [];
        store.onCamera(keys => {
            if (!store.gesture || store.frames % FEW === 0)
                this.turns.forEach(each => each(keys));
        });
    }

    get info() {
        return known(this.store.info);
    }

    /** When the volume is known. */
    build() {
        const {live, dims} = this.info; // a simulation knows its own data
        this.whole = dims;
        this.updates = [];
        this.turns = [];
        this.editor.renew();
        this.gradient.renew();
        this.element.replaceChildren(this.channels.element, this.presets.build(), this.look(),
            this.colors.element,
            section('Opacity by gradient', false, this.gradient.element), this.overlay(), this.named(), this.camera(), live ? '' : this.slices.section(each => this.follow(each)), this.measure.section(this.actions.measure), this.clipping(), this.shading(),
            this.times.section(each => this.follow(each)), this.movies.section(this.actions.movie), this.labels());
        this.update();
    }

    update() {
        if (this.store.info)
            for (const each of [...this.updates, ...this.turns])
                each(this.store.keys);
        this.editor.follow();
        this.gradient.follow();
        this.channels.update();
        this.colors.update();
        this.presets.update();
    }

    /** Keeps a control as the recipe is.
     * @param {(keys: Readonly<Keys>) => void} each */
    follow(each) {
        this.updates.push(each);
    }

    /** A box that is ticked as the recipe says.
     * @param {string} name
     * @param {(keys: Readonly<Keys>) => unknown} of
     * @param {(on: boolean) => void} change */
    box(name, of, change) {
        const {box, label} = check(name, change);
        this.follow(keys => {
            box.checked = Boolean(of(keys));
        });
        return label;
    }

    /** A field or a list that has a value of the recipe.
     * @template {HTMLInputElement|HTMLSelectElement} T
     * @param {T} field
     * @param {(keys: Readonly<Keys>) => string|number} of */
    kept(field, of, list = this.updates) {
        list.push(keys => show(field, of(keys)));
        return field;
    }

    look() {
        const {store, info} = this;
        const modes = this.kept(select(Object.entries(MODE_NAMES), mode => store.set(mode === 'iso'
            ? {mode, iso: store.keys.iso ?? +short(middle(known(store.look)))}
            : {mode, iso: null})), ({mode = 'over'}) => mode);
        const isoRow = row('Surface at', this.kept(number('surface at this value', value => store.set({iso: value})),
            ({iso = ''}) => iso));
        const maps = this.kept(select([['', 'of the preset'], ...info.colormaps, [':', 'own']],
            name => store.set({colormap: name === ':' ? text(this.colors.points)
                : name ? name + (this.colors.inverted ? '_r' : '') : null,
                ...name && store.look?.labels?.length ? {preset: null} : {}})), // these are of values
        ({colormap = ''}) => ownColors(colormap) ? ':' : upright(colormap));
        const ends = /** @type {const} */ (['low', 'high']).map(end => this.kept(number(`${end}est value of the range`,
            value => this.setRange({[end]: value})), () => store.look ? short(store.look[end]) : ''));
        const percent = button('1-99 %', 'Range of the 1st to the 99th percentile',
            () => store.set({range: ['p1', 'p99']}));
        const alone = make('div', {}, this.editor.element, row('Range', ...ends, percent),
            row('Colours', maps), this.colors.invert.label);
        this.follow(keys => {
            alone.hidden = mixed(store.look);
            isoRow.hidden = keys.mode !== 'iso';
        });
        return section('Look', true, alone, row('Mode', tip(modes, 'How values along a ray become a pixel (m: the next)')), isoRow,
            this.box('logarithmic values', ({scale}) => scale === 'log', on => store.set({scale: on ? 'log' : null})),
            this.box('logarithmic on both sides of 0', ({scale}) => scale?.startsWith('sym'),
                on => store.set({scale: on ? 'symlog' : null})));
    }

    /** @param {{low?: number, high?: number}} end */
    setRange(end) {
        const look = known(this.store.look), {low, high} = {...look, ...end};
        if (low < high)
            this.store.set(ranged(look, this.store.keys, [low, high]));
    }

    /** A slider of a number, or of one of the material.
     * @param {string} name
     * @param {'material'|'depth-darkening'|'occlusion'|'threshold'} key
     * @param {number} high
     * @param {number} step */
    strength(name, key, high, step, i = 0) {
        const told = make('output'), {store} = this;
        const input = slider(name, 0, high, step, store, value => store.set({[key]:
            key === 'material' ? swap(material(store.keys), i, value) : value}));
        this.follow(keys => {
            input.value = `${key === 'material' ? material(keys)[i] : keys[key] ?? 0}`;
            told.textContent = input.value;
        });
        return row(name, input, told);
    }

    shading() {
        const {store} = this;
        const shade = this.box('shaded', keys => keys.shade ? keys.shade === 'phong'
            : store.look?.shaded ?? true, on => store.set({shade: on ? 'phong' : 'none'}));
        const light = select([['key', 'from the upper left'], ['head', 'from the viewer'],
            ['direction', 'from a direction']],
        value => store.set({light: value === 'direction' ? [-25, 35] : value}));
        const way = ['right', 'up'].map((name, i) => slider(`degrees of the light ${name}`, -90, 90, 1,
            store, value => store.set({light: swap(direction(store.keys), i, value)})));
        const ways = row('Right, up', ...way);
        const sparse = make('output', {className: 'faint'});
        this.engine.on('figures', figures => {
            const share = figures.sparse === null ? '' :
                `${(100 * figures.sparse).toFixed(1)} % of the voxels are not visible; `;
            sparse.textContent = `${share}method ${figures.method}`;
        });
        this.follow(keys => {
            ways.hidden = !Array.isArray(keys.light);
            show(light, Array.isArray(keys.light) ? 'direction' : keys.light ?? 'key');
            way.forEach((input, i) => {
                input.value = `${direction(keys)[i]}`;
            });
        });
        return section('Light and detail', false, shade, row('Light', light), ways,
            this.strength('Ambient', 'material', 1, 0.01, 0),
            this.strength('Diffuse', 'material', 1, 0.01, 1),
            this.strength('Specular', 'material', 1, 0.01, 2),
            tip(this.strength('Depth dark', 'depth-darkening', 1, 0.05), 'What lies behind something is darker at its edge'),
            this.strength('Occlusion', 'occlusion', 1, 0.05),
            tip(this.strength('Threshold', 'threshold', 255, 1), 'Voxels of at most this opacity, of 255, are left out'), sparse);
    }

    camera() {
        const {store, actions, info} = this;
        const names = info.medical ? VIEWS : WORLD_VIEWS;
        const views = make('div', {className: 'row'}, ...[...names, 'iso'].map((name, i) =>
            name === 'iso' ? button('Oblique', 'Oblique view, from a corner', () => actions.view(name))
                : button(info.medical ? name[0].toUpperCase() + name.slice(1) : name,
                    `View from ${name}` + (info.medical && i < VIEWS.length ? ` (${i + 1})` : ''), () => actions.view(name))));
        const angles = /** @type {const} */ (['azimuth', 'elevation', 'roll']).map(key => this.kept(
            number(`${key} in degrees`, value => store.set({[key]: value})),
            keys => short(keys[key] ?? 0), this.turns));
        const zoom = this.kept(number('zoom', value => value > 0 && store.set({zoom: value})),
            keys => short(keys.zoom ?? 1), this.turns);
        const height = this.kept(number('height, a factor', value => value > 0 && store.set({'z-scale': value})),
            keys => keys['z-scale'] ?? '');
        const fov = this.kept(number('angle of the perspective in degrees',
            value => store.set({perspective: Math.max(0, Math.min(FOV_MOST, value))})),
        keys => keys.perspective ? short(keys.perspective) : '');
        const cubed = this.box('cube of directions', () => store.cube, on => {
            store.cube = on;
            store.changed();
        });
        return section('Camera', true, views, row('Angles', ...angles),
            row('Zoom', zoom, button('Frame all', 'Frame what the look shows (r)', actions.fit)),
            info.medical ? '' : row('Height', height),
            make('div', {className: 'row'}, tip(this.box('perspective', keys => (keys.perspective ?? 0) > 0,
                actions.perspective), 'What is nearer is larger (p)'), fov, 'degrees'),
            cubed);
    }

    /** Two planes across each axis of the world, tilted ones, and the box that is
     * read.  While it is open handles are on the picture. */
    clipping() {
        const {store, info} = this;
        /** @param {number} i */
        const end = i => {
            const {name, low, high} = this.grip(i);
            const input = slider(name, low, high, (high - low) / 200, store,
                value => store.set(this.grip(i).move(store.keys, value)));
            this.follow(() => {
                const {value, fixed} = this.grip(i);
                input.value = `${value}`;
                input.disabled = Boolean(fixed);
            });
            return input;
        };
        const rows = axisNames(info).map((name, i) => row(name, end(2 * i), end(2 * i + 1)));
        const cut = button('Cut here', 'A plane that faces the viewer, through the point that is ' +
            'turned around', () => store.set(facing(store.keys, this.info)));
        this.follow(keys => {
            cut.disabled = isFull(keys);
        });
        const clips = section('Clip', false, ...rows, ...this.tilted(), make('div', {className: 'row'}, cut,
            button('Remove all', 'Remove all clip planes', () => store.set({clip: null}))),
        ...this.masking(), ...info.live ? [] : this.cropping());
        tip(clips.firstElementChild ?? clips, 'Planes that cut, with handles on the picture (k)');
        clips.addEventListener('toggle', () => {
            store.clipping = clips.open;
            store.changed();
        });
        this.clips = clips;
        return clips;
    }

    /** An end or, from 6 on, a tilted plane.
     * @param {number} i */
    grip(i) {
        return grips(this.store.keys, this.info, axisNames(this.info))[i];
    }

    tilted() {
        const {store} = this;
        return Array.from({length: PLANES_MOST}, (_, i) => {
            const input = slider(`tilted clip plane ${i + 1}`, -1, 1, 0.01, store, value => {
                const {low, high, move} = this.grip(6 + i);
                store.set(move(store.keys, low + (value + 1) / 2 * (high - low)));
            });
            const line = row(`Tilted ${i + 1}`, input, button('Remove', `Remove tilted plane ${i + 1}`,
                () => store.set(tiltedTo(store.keys, i, null))));
            this.follow(keys => {
                line.hidden = i >= tilted(keys).length;
                if (line.hidden)
                    return;
                const {value, low, high} = this.grip(6 + i);
                input.value = `${2 * (value - low) / (high - low) - 1}`;
            });
            return line;
        });
    }

    /** Labels are those of the mask; a page that begins without it has them too. */
    masking() {
        const {store, info} = this;
        if (!info.mask)
            return [];
        return [this.box('only what the mask keeps', ({mask}) => mask, on => store.set({mask: on || null,
            labels: on ? info.labels : null}))];
    }

    cropping() {
        const full = this.whole;
        return [make('p', {className: 'faint', textContent: 'Crop: first voxel, and one past the last'}),
            ...AXES.map((name, axis) => {
                const fields = [0, 1].map(end => this.kept(number(
                    `crop ${name}, ${end ? 'one past the last' : 'first'} voxel`,
                    value => this.setCrop(full, axis, end, Math.round(value)), 1),
                ({crop}) => crop?.[axis][end] || (end ? full[axis] : 0)));
                return row(name, ...fields);
            })];
    }

    /** @param {number[]} full
     * @param {number} axis
     * @param {number} end
     * @param {number} value */
    setCrop(full, axis, end, value) {
        const {store} = this;
        /** @type {import('../types').Pair[]} */
        const crop = full.map((size, i) => [store.keys.crop?.[i][0] ?? 0, store.keys.crop?.[i][1] || size]);
        crop[axis][end] = Math.max(0, Math.min(full[axis], value));
        if (crop[axis][0] >= crop[axis][1])
            return;
        const whole = crop.every(([a, b], i) => a === 0 && b === full[i]);
        store.set({crop: whole ? null : crop});
    }

    /** A second volume of the command line: switched; labels by name, or values in
     * colours of a range. */
    overlay() {
        const {store, info} = this;
        if (!info.overlay)
            return '';
        const on = this.box(info.overlay, keys => keys.overlay, value => store.set({overlay: value || null}));
        /** @type {Own} */
        const over = {get: overlayKeys, set: changes => {
            const {colormap, range, opacity} = {...overlayKeys(store.keys), ...changes};
            store.set({'overlay-look': [changes.preset, colormap, range, opacity?.map(point => point.join(':'))].filter(
                part => part && String(part)).join() || null});
        }};
        const labels = () => this.labelled(over, store.look?.overlay?.labels);
        // Half, as in slices where nothing is asked.
        const list = this.switches(over, labels, 0.5);
        const maps = this.kept(select(info.colormaps,
            colormap => over.set({colormap})), keys => overlayKeys(keys).colormap || 'hot');
        // From nothing at the low end of a range on.  An end beyond the other one waits in
        // its field for that.
        const spread = (opacity = this.most(over)) => {
            const {low: first, high: last} = known(store.look?.overlay);
            const [low, high] = [first, last].map((value, i) =>
                ends[i].value === short(value) ? value : ends[i].valueAsNumber);
            if (low < high)
                over.set({range: [low, high], opacity: opacity ? [[low, 0], [high, opacity]] : []});
        };
        const ends = ['lowest', 'highest'].map(name => number(`${name} value of the range of the overlay`,
            () => spread()));
        const opacity = slider('opacity of the overlay', 0.02, 1, 0.02, store, value => labels().length
            ? over.set({opacity: labels().map(([label, , , now]) => [label, now ? value : 0])}) : spread(value));
        const values = make('div', {}, row('Colours', maps), row('Range', ...ends), button('Automatic', 'Opacity of the preset', () => over.set({range: [], opacity: []})));
        this.follow(keys => {
            const overlay = store.look?.overlay;
            values.hidden = !overlay || labels().length > 0;
            ends.forEach((field, i) => show(field, overlay ? short(i ? overlay.high : overlay.low) : ''));
            opacity.value = `${this.most(over) || 0.5}`;
        });
        return section('Overlay', true, on, list, row('Opacity', opacity), values);
    }

    /** Labels of the volume itself. */
    named() {
        const {store} = this;
        /** @type {Own} */
        const own = {get: keys => keys, set: ({preset, colormap, opacity}) => store.set({...preset && {preset},
            ...colormap && {colormap}, ...opacity && {opacity}})};
        const list = this.switches(own, () => this.labelled(own, store.look?.labels));
        const made = section('Labels', true, list);
        this.follow(() => {
            made.hidden = !list.childElementCount;
        });
        return made;
    }

    /** The largest opacity of a look.
     * @param {Own} of */
    most(of) {
        return Math.max(0, ...(of.get(this.store.keys).opacity ?? []).map(point => point[1]));
    }

    /** Labels with the colours and opacities of the recipe, which may be newer than the
     * look.
     * @param {Own} of
     * @param {Label[]} labels
     * @returns {Label[]} */
    labelled(of, labels = []) {
        const {opacity: given, colormap} = of.get(this.store.keys), points = new Map(given ?? []);
        const colors = new Map(ownColors(colormap) ?? []);
        return labels.map(([value, name, color, opacity]) =>
            [value, name, colors.get(value) ?? color, points.get(value) ?? opacity]);
    }

    /** A box for each label, that sets its opacity to 0 and back, and its colour.
     * @param {Own} of
     * @param {() => Label[]} labels */
    switches(of, labels, usual = 1) {
        const list = make('div', {});
        /** @param {number} i
         * @param {boolean} on */
        const put = (i, on) => {
            const full = this.most(of) || usual;
            of.set({opacity: labels().map(([value, , , opacity], k) =>
                [value, (k === i ? on : opacity) ? full : 0])});
        };
        let names = '';
        /** @type {{box: HTMLInputElement, label: HTMLElement, color: HTMLInputElement}[]} */
        let boxes = [];
        this.follow(() => {
            const now = labels(), called = now.map(([value, name]) => name || `${value}`);
            if (String(called) !== names) {
                boxes = called.map((name, i) => ({...check(name, on => put(i, on)),
                    color: ink(`colour of ${name}`, to => of.set({preset: 'labels',
                        colormap: painted(of.get(this.store.keys).colormap, labels()[i][0], to)}))}));
                list.replaceChildren(...boxes.map(({color, label}) => make('div', {className: 'row'}, color, label)));
            }
            names = String(called);
            now.forEach(([, , color, opacity], i) => {
                boxes[i].box.checked = opacity > 0;
                boxes[i].color.value = color;
            });
        });
        return list;
    }

    labels() {
        const {store, info} = this;
        const title = this.kept(line('title of the picture', value => store.set({title: value || null})),
            keys => keys.title ?? '');
        const time = this.kept(select([['', 'nothing'], ['time', 'time'], ['step', 'number of the step']],
            annotate => store.set({annotate: annotate || null})), keys => keys.annotate ?? '');
        const {legend = 'scale'} = store.keys; // its title is kept
        /** @type {[name: string, key: 'no-labels'|'legend'|'box', on: string|true|null, off?: true][]} */
        const rows = [['letters of the sides', 'no-labels', null, true],
            ['colour bar', 'legend', legend === 'scale' || legend], ['scale bar', 'legend', 'scale'],
            ["edges of the volume's box", 'box', 'outline'], ['its axes, with numbers', 'box', 'axes']];
        const boxes = rows.map(([name, key, on, off = null]) => make('div', {},
            this.box(name, ({[key]: now = null}) => now === on, checked => {
                store.set({[key]: checked ? on : off});
                if (key === 'box')
                    this.actions.fit(); // it is larger
            })));
        tip(boxes[0], 'Right, left, anterior, posterior, superior, inferior (l)');
        const drawn = info.mask === undefined ? boxes.slice(0, 3) // by the kernel of a notebook
            : [...boxes, row('Title', title), row('Time', time)];
        return section('Letters and bars', false, ...drawn);
    }
}
