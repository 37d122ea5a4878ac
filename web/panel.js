// panel.js - the controls beside the picture.

import {facing, grips, isFull, PLANES_MOST, tilted, tiltedTo} from './clip.js';
import {Channels, mixed} from './channels.js';
import {Colors, ownColors, painted, ranged, text} from './colors.js';
import {button, check, ink, line, make, number, row, section, select, short, show, slider}
    from './controls.js';
import {BY_GRADIENT, Editor} from './editor.js';
import {MODES, VIEWS} from './keys.js';
import {axisNames} from './overlay.js';

const WORLD_VIEWS = ['+x', '-x', '+y', '-y', '+z', '-z'];
const AXES = ['x', 'y', 'z'];
const FIRST_PANE = 4;
const NO_SHAPE = {colormap: null, opacity: null, 'gradient-opacity': null, range: null,
    scale: null};

/** The look of the overlay, "labels,1:#00ff00,0:0,5:0.8", as the keys of the volume's. */
const split = ({'overlay-look': text = ''}) => {
    const of = test => text.split(',').filter(part => test.test(part)), name = /#|^[a-eg-z]\D/;
    return {colormap: of(name).join(), opacity: of(/:[^#]/).map(part => part.split(':').map(Number)),
        range: of(/^[^:]+$/).filter(part => !name.test(part))};
};

const swap = (list, i, value) => list.map((old, k) => k === i ? value : old);
const material = keys => keys.material ?? [0.2, 0.7, 0.2, 20];

export class Panel {
    constructor(recipe, page, engine, actions, slices) {
        Object.assign(this, {recipe, page, engine, actions, slices});
        this.editor = new Editor(recipe, page);
        this.gradient = new Editor(recipe, page, BY_GRADIENT);
        this.colors = new Colors(recipe, page);
        this.channels = new Channels(recipe, page, {...NO_SHAPE, preset: null, component: null});
        this.element = make('aside', {className: 'panel', 'aria-label': 'Controls'});
        this.updates = [];
        engine.on('small', frame => this.showThumbnail(frame));
    }

    /** When the volume is known. */
    build() {
        const {live} = this.page.info; // a simulation knows its own data
        this.updates = [];
        this.element.replaceChildren(this.channels.element, this.presets(), this.look(),
            this.colors.element,
            section('Opacity by gradient', false, this.gradient.element), this.overlay(), this.named(), this.camera(), live ? '' : this.slices.section(each => this.follow(each)), this.page.measure.section(this.actions.measure), this.clipping(), this.shading(),
            this.time(), this.labels());
        this.update();
    }

    update() {
        if (this.page.info)
            for (const each of this.updates)
                each(this.recipe.keys);
        this.editor.follow();
        this.gradient.follow();
        this.channels.update();
        this.colors.update();
    }

    /** Keeps a control as the recipe is. */
    follow(each) {
        this.updates.push(each);
    }

    /** A box that is ticked as the recipe says. */
    box(name, of, change) {
        const {box, label} = check(name, change);
        this.follow(keys => {
            box.checked = of(keys);
        });
        return label;
    }

    /** A field or a list that has a value of the recipe. */
    kept(field, of) {
        this.follow(keys => show(field, of(keys)));
        return field;
    }

    look() {
        const {recipe, page} = this;
        const modes = this.kept(select(MODES, mode => recipe.set(mode === 'iso'
            ? {mode, iso: recipe.keys.iso ?? +short((page.look.low + page.look.high) / 2)}
            : {mode, iso: null})), ({mode = 'over'}) => mode);
        const isoRow = row('Iso value', this.kept(number('iso value', value => recipe.set({iso: value})),
            ({iso = ''}) => iso));
        const maps = this.kept(select([['', 'of the preset'], ...page.info.colormaps, [':', 'own']],
            name => recipe.set({colormap: name === ':' ? text(this.colors.points) : name || null,
                ...name && page.look.labels?.length && {preset: null}})), // these are of values
        ({colormap = ''}) => ownColors(colormap) ? ':' : colormap);
        const ends = ['low', 'high'].map((end, i) => this.kept(number(`${end}est value of the range`,
            value => this.setRange(...i ? [null, value] : [value, null])),
        () => page.look ? short(page.look[end]) : ''));
        const percent = button('1-99 %', 'Range of the 1st to the 99th percentile',
            () => recipe.set({range: ['p1', 'p99']}));
        const alone = make('div', {}, this.editor.element, row('Range', ...ends, percent),
            row('Colours', maps));
        this.follow(keys => {
            alone.hidden = mixed(page.look);
            isoRow.hidden = keys.mode !== 'iso';
        });
        return section('Look', true, alone, row('Mode', modes), isoRow,
            this.box('logarithmic values', ({scale}) => scale === 'log', on => recipe.set({scale: on ? 'log' : null})),
            this.box('on both sides of 0', ({scale}) => scale?.startsWith('sym'),
                on => recipe.set({scale: on ? 'symlog' : null})));
    }

    setRange(low, high) {
        const {look} = this.page, range = [low ?? look.low, high ?? look.high];
        if (range[0] < range[1])
            this.recipe.set(ranged(look, this.recipe.keys, range));
    }

    /** Pictures of the volume itself, made when the list is opened. */
    presets() {
        const {page} = this, none = page.info.tf ? 'of the file' : 'automatic';
        const names = [['', page.info.tf ? 'of the file of --tf' : 'made from the histogram'], 
            ...page.info.presets];
        const grid = make('div', {className: 'presets'});
        this.images = names.map(([name, text]) => {
            const image = make('img', {alt: '', hidden: true});
            const choose = make('button', {type: 'button', title: text,
                'aria-label': `Preset ${name || none}: ${text}`,
                onclick: () => this.recipe.set({...NO_SHAPE, preset: name || null,
                    ...mixed(page.look) && {channel: `${page.look.channels[0][0]}`}})},
            image, name || none);
            this.follow(keys => choose.setAttribute('aria-pressed',
                (keys.preset ?? '') === name));
            grid.append(choose);
            return image;
        });
        const list = section('Presets', false, grid);
        const ask = () => list.open && names.forEach(([preset], i) => this.engine.ask('thumbnail',
            {preset, pane: FIRST_PANE + i}));
        list.addEventListener('toggle', ask);
        return list;
    }

    showThumbnail(frame) {
        const image = this.images?.[frame.pane - FIRST_PANE];
        if (!image)
            return;
        URL.revokeObjectURL(image.src);
        image.src = URL.createObjectURL(frame.blob);
        image.hidden = false;
    }

    /** A slider of a number, or of one of the material. */
    strength(name, key, high, step, i) {
        const told = make('output'), {recipe} = this;
        const input = slider(name, 0, high, step, recipe, value => recipe.set({[key]:
            key === 'material' ? swap(material(recipe.keys), i, value) : value}));
        this.follow(keys => {
            input.value = key === 'material' ? material(keys)[i] : keys[key] ?? 0;
            told.textContent = input.value;
        });
        return row(name, input, told);
    }

    shading() {
        const {recipe} = this;
        const shade = this.box('shaded', keys => keys.shade ? keys.shade === 'phong'
            : this.page.look?.shaded ?? true, on => recipe.set({shade: on ? 'phong' : 'none'}));
        const light = select([['key', 'from the upper left'], ['head', 'from the viewer'],
            ['direction', 'from a direction']],
        value => recipe.set({light: value === 'direction' ? [-25, 35] : value}));
        const way = ['right', 'up'].map((name, i) => slider(`degrees of the light ${name}`, -90, 90, 1,
            recipe, value => recipe.set({light: swap(recipe.keys.light, i, value)})));
        const ways = row('Right, up', ...way);
        const sparse = make('output', {className: 'faint'});
        this.engine.on('figures', figures => {
            const share = figures.sparse === null ? '' :
                `${(100 * figures.sparse).toFixed(1)} % of the voxels are not visible; `;
            sparse.textContent = `${share}method ${figures.method}`;
        });
        this.follow(keys => {
            ways.hidden = !Array.isArray(keys.light);
            show(light, ways.hidden ? keys.light ?? 'key' : 'direction');
            way.forEach((input, i) => {
                input.value = ways.hidden ? 0 : keys.light[i];
            });
        });
        return section('Light and detail', false, shade, row('Light', light), ways,
            this.strength('Ambient', 'material', 1, 0.01, 0),
            this.strength('Diffuse', 'material', 1, 0.01, 1),
            this.strength('Specular', 'material', 1, 0.01, 2),
            this.strength('Depth dark', 'depth-darkening', 1, 0.05),
            this.strength('Occlusion', 'occlusion', 1, 0.05),
            this.strength('Threshold', 'threshold', 255, 1), sparse);
    }

    camera() {
        const {recipe, actions, page} = this;
        const names = page.info.medical ? VIEWS : WORLD_VIEWS;
        const views = make('div', {className: 'row'}, ...[...names, 'iso'].map(name =>
            button(page.info.medical ? name[0].toUpperCase() + name.slice(1) : name,
                `View from ${name}`, () => actions.view(name))));
        const angles = ['azimuth', 'elevation', 'roll'].map(key => this.kept(
            number(`${key} in degrees`, value => recipe.set({[key]: value})),
            keys => short(keys[key] ?? 0)));
        const zoom = this.kept(number('zoom', value => value > 0 && recipe.set({zoom: value})),
            keys => short(keys.zoom ?? 1));
        const height = this.kept(number('height, a factor', value => value > 0 && recipe.set({'z-scale': value})),
            keys => keys['z-scale'] ?? '');
        return section('Camera', true, views, row('Angles', ...angles),
            row('Zoom', zoom, button('Frame all', 'Frame what the look shows', actions.fit)),
            page.info.medical ? '' : row('Height', height),
            this.box('perspective', keys => keys.perspective > 0, actions.perspective));
    }

    /** Two planes across each axis of the world, tilted ones, and the box that is
     * read.  While it is open handles are on the picture. */
    clipping() {
        const {page, recipe} = this;
        const end = i => {
            const {name, low, high} = this.grip(i);
            const input = slider(name, low, high, (high - low) / 200, recipe,
                value => recipe.set(this.grip(i).move(recipe.keys, value)));
            this.follow(() => {
                const {value, fixed} = this.grip(i);
                input.value = value;
                input.disabled = fixed;
            });
            return input;
        };
        const rows = axisNames(page.info).map((name, i) => row(name, end(2 * i), end(2 * i + 1)));
        const cut = button('Cut here', 'A plane that faces the viewer, through the point that is ' +
            'turned around', () => recipe.set(facing(recipe.keys, page.info)));
        this.follow(keys => {
            cut.disabled = isFull(keys);
        });
        this.clips = section('Clip', false, ...rows, ...this.tilted(), make('div', {className: 'row'}, cut,
            button('Remove all', 'Remove all clip planes', () => recipe.set({clip: null}))),
        ...this.masking(), ...page.info.live ? [] : this.cropping());
        this.clips.addEventListener('toggle', () => {
            page.clipping = this.clips.open;
            recipe.changed();
        });
        return this.clips;
    }

    /** An end or, from 6 on, a tilted plane. */
    grip(i) {
        return grips(this.recipe.keys, this.page.info, axisNames(this.page.info))[i];
    }

    tilted() {
        const {recipe} = this;
        return Array.from({length: PLANES_MOST}, (_, i) => {
            const input = slider(`tilted clip plane ${i + 1}`, -1, 1, 0.01, recipe, value => {
                const {low, high, move} = this.grip(6 + i);
                recipe.set(move(recipe.keys, low + (value + 1) / 2 * (high - low)));
            });
            const line = row(`Tilted ${i + 1}`, input, button('Remove', `Remove tilted plane ${i + 1}`,
                () => recipe.set(tiltedTo(recipe.keys, i, null))));
            this.follow(keys => {
                line.hidden = i >= tilted(keys).length;
                if (line.hidden)
                    return;
                const {value, low, high} = this.grip(6 + i);
                input.value = 2 * (value - low) / (high - low) - 1;
            });
            return line;
        });
    }

    /** Labels are those of the mask; a page that begins without it has them too. */
    masking() {
        const {page, recipe} = this;
        if (!page.info.mask)
            return [];
        return [this.box('only what the mask keeps', ({mask}) => mask, on => recipe.set({mask: on || null,
            labels: on ? page.info.labels : null}))];
    }

    cropping() {
        const {recipe} = this, full = this.page.whole ?? this.page.info.dims;
        return [make('p', {className: 'faint', textContent: 'Crop: first voxel, and one past the last'}),
            ...AXES.map((name, axis) => {
                const fields = [0, 1].map(end => this.kept(number(
                    `crop ${name}, ${end ? 'one past the last' : 'first'} voxel`,
                    value => this.setCrop(full, axis, end, Math.round(value)), 1),
                ({crop}) => crop?.[axis][end] || (end ? full[axis] : 0)));
                return row(name, ...fields);
            })];
    }

    setCrop(full, axis, end, value) {
        const crop = full.map((size, i) => [this.recipe.keys.crop?.[i][0] ?? 0,
            this.recipe.keys.crop?.[i][1] || size]);
        crop[axis][end] = Math.max(0, Math.min(full[axis], value));
        if (crop[axis][0] >= crop[axis][1])
            return;
        const whole = crop.every(([a, b], i) => a === 0 && b === full[i]);
        this.recipe.set({crop: whole ? null : crop});
    }

    /** A second volume of the command line: switched; labels by name, or values in
     * colours of a range. */
    overlay() {
        const {recipe, page} = this;
        if (!page.info.overlay)
            return '';
        const on = this.box(page.info.overlay, keys => keys.overlay, value => recipe.set({overlay: value || null}));
        const over = {get: split, set: changes => {
            const {preset = [], colormap, range, opacity} = {...split(recipe.keys), ...changes};
            recipe.set({'overlay-look': [preset, colormap, range, opacity.map(point => point.join(':'))].filter(
                String).join() || null});
        }};
        const labels = () => this.labelled(over, page.look?.overlay?.labels);
        // Half, as in slices where nothing is asked.
        const list = this.switches(over, labels, 0.5);
        const maps = this.kept(select(page.info.colormaps,
            colormap => over.set({colormap})), keys => split(keys).colormap || 'hot');
        // From nothing at the low end of a range on.  The next change may come before the
        // server's look.
        const spread = (to, opacity = this.most(over)) => {
            const {low, high} = Object.assign(page.look.overlay, to);
            if (low < high)
                over.set({range: [low, high], opacity: opacity ? [[low, 0], [high, opacity]] : []});
        };
        const ends = ['lowest', 'highest'].map((name, i) => number(`${name} value of the range of the overlay`,
            value => spread({[i ? 'high' : 'low']: value})));
        const opacity = slider('opacity of the overlay', 0.02, 1, 0.02, recipe, value => labels().length
            ? over.set({opacity: labels().map(([label, , , now]) => [label, now ? value : 0])}) : spread({}, value));
        const values = make('div', {}, row('Colours', maps), row('Range', ...ends), button('Automatic', 'Opacity of the preset', () => over.set({range: [], opacity: []})));
        this.follow(keys => {
            const overlay = page.look?.overlay;
            values.hidden = !overlay || labels().length > 0;
            ends.forEach((field, i) => show(field, overlay ? short(i ? overlay.high : overlay.low) : ''));
            opacity.value = this.most(over) || 0.5;
        });
        return section('Overlay', true, on, list, row('Opacity', opacity), values);
    }

    /** Labels of the volume itself. */
    named() {
        const {recipe} = this, own = {get: keys => keys, set: keys => recipe.set(keys)};
        const list = this.switches(own, () => this.labelled(own, this.page.look?.labels));
        const made = section('Labels', true, list);
        this.follow(() => {
            made.hidden = !list.childElementCount;
        });
        return made;
    }

    /** The largest opacity of a look. */
    most(of) {
        return Math.max(0, ...(of.get(this.recipe.keys).opacity ?? []).map(point => point[1]));
    }

    /** Labels with the colours and opacities of the recipe, which may be newer than the
     * look. */
    labelled(of, labels = []) {
        const {opacity: given, colormap} = of.get(this.recipe.keys), points = new Map(given);
        const colors = new Map(ownColors(colormap));
        return labels.map(([value, name, color, opacity]) =>
            [value, name, colors.get(value) ?? color, points.get(value) ?? opacity]);
    }

    /** A box for each label, that sets its opacity to 0 and back, and its colour. */
    switches(of, labels, usual = 1) {
        const list = make('div', {});
        const put = (i, on) => {
            const full = this.most(of) || usual;
            of.set({opacity: labels().map(([value, , , opacity], k) =>
                [value, (k === i ? on : opacity) ? full : 0])});
        };
        let names, boxes;
        this.follow(() => {
            const now = labels(), called = now.map(([value, name]) => name || value);
            if (String(called) !== names) {
                boxes = called.map((name, i) => ({...check(name, on => put(i, on)),
                    color: ink(`colour of ${name}`, to => of.set({preset: 'labels',
                        colormap: painted(of.get(this.recipe.keys).colormap, labels()[i][0], to)}))}));
                list.replaceChildren(...boxes.map(({color, label}) => make('div', {className: 'row'}, color, label)));
            }
            names = String(called);
            now.forEach(([, , color, opacity], i) => {
                boxes[i].box.checked = opacity;
                boxes[i].color.value = color;
            });
        });
        return list;
    }

    time() {
        const {page, recipe} = this, told = make('output');
        if (page.info.times < 2)
            return '';
        const input = slider('time step', 0, page.info.times - 1, 1, recipe,
            value => recipe.set({time: value}));
        this.follow(keys => {
            input.value = keys.time ?? 0;
            told.textContent = `${keys.time ?? 0} / ${page.info.times - 1}`;
        });
        return section('Time', true, row('Step', input, told),
            button('Play', 'Play or stop the time steps', this.actions.play));
    }

    labels() {
        const {recipe, page} = this;
        const title = this.kept(line('title of the picture', value => recipe.set({title: value || null})),
            keys => keys.title ?? '');
        const time = this.kept(select([['', 'nothing'], ['time', 'time'], ['step', 'number of the step']],
            annotate => recipe.set({annotate: annotate || null})), keys => keys.annotate ?? '');
        const {legend = 'scale'} = recipe.keys; // its title is kept
        const boxes = [['letters of the sides', 'no-labels', null, true],
            ['colour bar', 'legend', legend === 'scale' || legend], ['scale bar', 'legend', 'scale'],
            ["edges of the volume's box", 'box', 'outline'], ['its axes, with numbers', 'box', 'axes']].map(([name, key, on, off = null]) => make('div', {},
            this.box(name, ({[key]: now = null}) => now === on, checked => {
                recipe.set({[key]: checked ? on : off});
                key === 'box' && this.actions.fit(); // it is larger
            })));
        const drawn = page.info.mask === undefined ? boxes.slice(0, 3) // by the kernel of a notebook
            : [...boxes, row('Title', title), row('Time', time)];
        return section('Letters and bars', false, ...drawn);
    }
}
