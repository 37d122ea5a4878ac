// channels.js - the channels of a file: which are mixed, in which colour, range
// and opacity.

import {apart, button, check, ink, make, number, section, show, slider} from '../controls.js';
import {listed, mixed} from '../look.js';
import {known} from '../store.js';

const CHANNELS_MOST = 8; // SNOW_CHANNELS_MAX of volume.h

/** @typedef {import('../types').Channel} Channel */

export class Channels {
    /** @param {import('../store.js').Store} store
     * @param {import('../types').Changes} plain changes that take a look of one volume away */
    constructor(store, plain) {
        this.store = store;
        this.plain = plain;
        /** @type {Channel[]} */
        this.known = []; // as each was drawn last
        /** @type {ReturnType<Channels['row']>[]} */
        this.rows = [];
        /** @type {object|null} */
        this.before = null; // the look that *All* shall change
        this.list = make('div', {});
        this.element = section('Channels', true, this.list, button('All',
            'All channels as the file shows them', () => this.all()));
    }

    get first() {
        return [...this.names.keys()].slice(0, CHANNELS_MOST);
    }

    get names() {
        return this.store.info?.channels ?? [];
    }

    get drawn() {
        return this.store.look?.channels ?? [];
    }

    /** As the file shows them, if these are all; else a list, which has the file's colours.
     * A file of --tf is of one volume. */
    all() {
        const {store} = this, usual = 'channel' in store.keys && !store.info?.tf;
        this.before = usual ? store.answered : null;
        store.set({...this.plain, channel: usual ? null : this.first.join()});
    }

    /** More than can be mixed are refused, and said.
     * @param {(Channel|[number])[]} channels */
    set(channels) {
        this.store.set({...mixed(this.store.look) ? {} : this.plain, ...listed(channels)});
    }

    /** One of them stays.
     * @param {number} index
     * @param {boolean} on */
    turn(index, on) {
        const others = this.drawn.filter(one => one[0] !== index);
        if (on || others.length)
            this.set(on ? [...others, this.known[index] ?? [index]] : others);
        else
            this.update();
    }

    /** @param {number} index
     * @param {Partial<Record<2|3|4|5|6, string|number>>} changes */
    put(index, changes) {
        this.set(this.drawn.map(one => one[0] === index
            ? /** @type {Channel} */ (Object.assign([...one], changes)) : one));
    }

    /** @param {number} index
     * @param {string} name */
    row(index, name) {
        const box = check(name, on => this.turn(index, on));
        const color = ink(`colour of ${name}`, value => this.put(index, {2: value, 3: value}));
        const ends = ['lowest', 'highest'].map((word, i) => number(`${word} value of the range of ${name}`,
            value => {
                if (i ? this.known[index][4] < value : value < this.known[index][5])
                    this.put(index, i ? {5: value} : {4: value});
            }));
        const opacity = slider(`opacity of ${name}`, 0, 1, 0.02, this.store, value => this.put(index, {6: value}));
        const auto = button('Auto', `Range of ${name} as the file has it, or its values`,
            () => this.put(index, {4: 0, 5: 0}));
        const more = make('div', {className: 'row'}, color, ...ends, auto, opacity);
        return {box: box.box, color, ends, opacity, more, element: make('div', {}, box.label, more)};
    }

    update() {
        const {drawn, names, store} = this;
        this.element.hidden = names.length < 2;
        for (const [index, name] of [...names.entries(), ...drawn])
            if (!this.rows[index]) {
                this.rows[index] = this.row(index, name || `channel ${index}`);
                this.list.append(this.rows[index].element);
            }
        if (this.before && store.answered !== this.before) {
            this.before = null;
            if ((known(store.answered).channels ?? []).length < this.first.length)
                store.set({channel: this.first.join()});
        }
        this.rows.forEach(({box, color, ends, opacity, more}, index) => {
            const one = drawn.find(([k]) => k === index);
            box.checked = Boolean(one);
            more.hidden = !one?.[2];
            if (!one?.[2])
                return;
            this.known[index] = one;
            color.value = one[3];
            apart([one[4], one[5]], 5).forEach((value, i) => show(ends[i], value));
            opacity.value = `${one[6]}`;
        });
    }
}
