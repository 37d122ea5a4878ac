// panel.js - the controls beside the picture.

import {button, check, make, number, row, section, select, short, show, slider}
    from './controls.js';
import {BY_GRADIENT, Editor} from './editor.js';
import {MODES, VIEWS} from './keys.js';

const WORLD_VIEWS = ['+x', '-x', '+y', '-y', '+z', '-z'];
const AXES = ['x', 'y', 'z'];
const PATIENT_AXES = ['left - right', 'back - front', 'bottom - top'];
const FIRST_PANE = 4;
const NO_SHAPE = {colormap: null, opacity: null, 'gradient-opacity': null, range: null,
    shift: null, log: null};

/** The corners of the volume in the world, lowest and highest. */
function bounds(info) {
    return info.matrix.map((line, i) => {
        let low = line[3], high = line[3];
        line.slice(0, 3).forEach((step, k) => {
            const ends = [-0.5 * step, (info.dims[k] - 0.5) * step];
            low += Math.min(...ends);
            high += Math.max(...ends);
        });
        return [low, high];
    });
}

/** Planes of the command line that no slider shows, and that stay. */
const isOblique = plane => plane.slice(0, 3).filter(x => x !== 0).length > 1;

export class Panel {
    constructor(recipe, page, engine, actions) {
        Object.assign(this, {recipe, page, engine, actions});
        this.editor = new Editor(recipe, page);
        this.gradient = new Editor(recipe, page, BY_GRADIENT);
        this.element = make('aside', {className: 'panel', 'aria-label': 'Controls'});
        this.updates = [];
        engine.on('small', frame => this.showThumbnail(frame));
    }

    /** When the volume is known. */
    build() {
        this.updates = [];
        this.element.replaceChildren(this.look(),
            section('Opacity by gradient', false, this.gradient.element), this.presets(),
            this.shading(), this.camera(), this.clipping(), this.time(), this.labels());
        this.update();
    }

    update() {
        if (this.page.info)
            for (const each of this.updates)
                each(this.recipe.keys);
        this.editor.draw();
        this.gradient.draw();
    }

    /** Keeps a control as the recipe is. */
    follow(each) {
        this.updates.push(each);
    }

    value(key, otherwise) {
        return this.recipe.keys[key] ?? otherwise;
    }

    look() {
        const {recipe, page} = this;
        const modes = select(MODES, mode => recipe.set(mode === 'iso'
            ? {mode, iso: this.value('iso', +short((page.look.low + page.look.high) / 2))}
            : {mode, iso: null}));
        const iso = number('iso value', value => recipe.set({iso: value}));
        const isoRow = row('Iso value', iso);
        const maps = select([['', 'of the preset'], ...page.info.colormaps],
            name => recipe.set({colormap: name || null}));
        const low = number('lowest value of the range', value => this.setRange(value, null));
        const high = number('highest value of the range', value => this.setRange(null, value));
        const percent = button('1-99 %', 'Range of the 1st to the 99th percentile',
            () => recipe.set({range: ['p1', 'p99']}));
        const log = check('logarithmic values', on => recipe.set({log: on || null}));
        this.follow(keys => {
            show(modes, keys.mode ?? 'over');
            isoRow.hidden = keys.mode !== 'iso';
            show(iso, keys.iso ?? '');
            show(maps, keys.colormap ?? '');
            show(low, page.look ? short(page.look.low) : '');
            show(high, page.look ? short(page.look.high) : '');
            log.box.checked = Boolean(keys.log);
        });
        return section('Look', true, this.editor.element, row('Range', low, high, percent),
            row('Colours', maps), row('Mode', modes), isoRow, log.label);
    }

    setRange(low, high) {
        const range = [low ?? this.page.look.low, high ?? this.page.look.high];
        if (range[0] < range[1])
            this.recipe.set({range});
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
                onclick: () => this.recipe.set({...NO_SHAPE, preset: name || null})},
            image, name || none);
            this.follow(keys => choose.setAttribute('aria-pressed',
                (keys.preset ?? '') === name));
            grid.append(choose);
            return image;
        });
        const list = section('Presets', false, grid);
        list.addEventListener('toggle', () => {
            if (list.open)
                names.forEach(([preset], i) => this.engine.ask('thumbnail',
                    {preset, pane: FIRST_PANE + i}));
        });
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

    /** A slider of a number that has a default. */
    strength(name, key, low, high, step, otherwise) {
        const told = make('output');
        const input = slider(name, low, high, step, this.recipe,
            value => this.recipe.set({[key]: value}));
        this.follow(keys => {
            input.value = keys[key] ?? otherwise;
            told.textContent = short(keys[key] ?? otherwise);
        });
        return row(name, input, told);
    }

    shading() {
        const {recipe} = this;
        const shade = check('shaded', on => recipe.set({shade: on ? 'phong' : 'none'}));
        const light = select([['key', 'from the upper left'], ['head', 'from the viewer']],
            value => recipe.set({light: value}));
        const sparse = make('output', {className: 'faint'});
        this.engine.on('figures', figures => {
            sparse.textContent = `${(100 * figures.sparse).toFixed(1)} % of the voxels are ` +
                `not visible; method ${figures.method}`;
        });
        this.follow(keys => {
            shade.box.checked = keys.shade ? keys.shade === 'phong' : this.page.look?.shaded ?? true;
            show(light, keys.light === 'head' ? 'head' : 'key');
        });
        return section('Light and detail', false, shade.label, row('Light', light),
            this.strength('Ambient', 'ambient', 0, 1, 0.01, 0.2),
            this.strength('Diffuse', 'diffuse', 0, 1, 0.01, 0.7),
            this.strength('Specular', 'specular', 0, 1, 0.01, 0.2),
            this.strength('Depth dark', 'depth-darkening', 0, 1, 0.05, 0),
            this.strength('Occlusion', 'occlusion', 0, 1, 0.05, 0),
            this.strength('Threshold', 'threshold', 0, 255, 1, 0), sparse);
    }

    camera() {
        const {recipe, actions, page} = this;
        const names = page.info.medical ? VIEWS : WORLD_VIEWS;
        const views = make('div', {className: 'row'}, ...[...names, 'iso'].map(name =>
            button(page.info.medical ? name[0].toUpperCase() + name.slice(1) : name,
                `View from ${name}`, () => actions.view(name))));
        const angles = ['azimuth', 'elevation', 'roll'].map(key => {
            const field = number(`${key} in degrees`, value => recipe.set({[key]: value}));
            this.follow(keys => show(field, short(keys[key] ?? 0)));
            return field;
        });
        const zoom = number('zoom', value => value > 0 && recipe.set({zoom: value}));
        const perspective = check('perspective', () => actions.perspective());
        this.follow(keys => {
            show(zoom, short(keys.zoom ?? 1));
            perspective.box.checked = (keys.perspective ?? 0) > 0;
        });
        return section('Camera', true, views, row('Angles', ...angles),
            row('Zoom', zoom, button('Frame all', 'Frame what the look shows', actions.fit)),
            perspective.label);
    }

    /** Two planes across each axis of the world, and the box that is read. */
    clipping() {
        const {page, recipe} = this, box = bounds(page.info);
        const rows = box.map(([low, high], axis) => {
            const name = page.info.medical ? PATIENT_AXES[axis] : AXES[axis];
            const inputs = [0, 1].map(end => slider(
                `clip ${name}, ${end ? 'highest' : 'lowest'}`, low, high, (high - low) / 200,
                recipe, value => this.setClip(box, axis, end, value)));
            this.follow(keys => {
                const ends = this.clips(box, keys)[axis];
                inputs.forEach((input, end) => {
                    input.value = ends[end];
                });
            });
            return row(name, ...inputs);
        });
        return section('Clip', false, ...rows,
            button('Remove all', 'Remove all clip planes', () => recipe.set({clip: null})),
            ...this.cropping());
    }

    /** The planes as the lowest and highest visible place of each axis. */
    clips(box, keys) {
        const ends = box.map(pair => [...pair]);
        for (const [a, b, c, d] of (keys.clip ?? []).filter(plane => !isOblique(plane))) {
            const axis = [a, b, c].findIndex(x => x !== 0);
            const sign = [a, b, c][axis];
            ends[axis][sign > 0 ? 1 : 0] = d / sign;
        }
        return ends;
    }

    setClip(box, axis, end, value) {
        const ends = this.clips(box, this.recipe.keys), margin = (box[axis][1] - box[axis][0]) / 200;
        ends[axis][end] = end ? Math.max(value, ends[axis][0] + margin)
            : Math.min(value, ends[axis][1] - margin);
        const planes = (this.recipe.keys.clip ?? []).filter(isOblique);
        ends.forEach((pair, i) => pair.forEach((place, side) => {
            if (Math.abs(place - box[i][side]) <= 1e-6 * (box[i][1] - box[i][0]))
                return;
            const plane = [0, 0, 0, +(side ? place : -place).toPrecision(6)];
            plane[i] = side ? 1 : -1;
            planes.push(plane);
        }));
        this.recipe.set({clip: planes.length ? planes : null});
    }

    cropping() {
        const {recipe} = this, full = this.page.whole ?? this.page.info.dims;
        return [make('p', {className: 'faint', textContent: 'Crop: first voxel, and one past the last'}),
            ...AXES.map((name, axis) => {
                const fields = [0, 1].map(end => number(
                    `crop ${name}, ${end ? 'one past the last' : 'first'} voxel`,
                    value => this.setCrop(full, axis, end, Math.round(value)), 1));
                this.follow(keys => fields.forEach((field, end) => show(field,
                    keys.crop?.[axis][end] || (end ? full[axis] : 0))));
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
        const {recipe} = this;
        const boxes = [['letters of the sides', 'no-labels', true], ['colour bar', 'legend', false],
            ['scale bar', 'scale-bar', false]].map(([name, key, inverse]) => {
            const made = check(name, on => recipe.set({[key]: on !== inverse || null}));
            this.follow(keys => {
                made.box.checked = Boolean(keys[key]) !== inverse;
            });
            return make('div', {}, made.label);
        });
        return section('Letters and bars', false, ...boxes);
    }
}
