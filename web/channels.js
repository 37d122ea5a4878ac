// channels.js - the channels of a file: which are mixed, in which colour, range
// and opacity.  A channel is as the look has it: [0, 'DAPI', 'blue', '#0000ff',
// 10, 200, 1], without a colour where it is drawn alone.

import {apart, button, check, ink, make, number, section, show, slider} from './controls.js';

const CHANNELS_MOST = 8; // SNOW_CHANNELS_MAX of volume.h

export const mixed = look => Boolean(look?.channels?.[0]?.[2]);

/** Changes of a recipe: the file says what is not known of a channel. */
export const listed = channels => ({channel: channels.map(([index, , map, , low, high, opacity]) =>
    (map ? [index, map, ...low < high ? [`${low}..${high}`] : [], opacity] : [index]).join(':')).join()});

export class Channels {
    /** `plain` are the changes that take a look of one volume away. */
    constructor(recipe, page, plain) {
        Object.assign(this, {recipe, page, plain});
        this.known = [];
        this.rows = [];
        this.list = make('div', {});
        this.element = section('Channels', true, this.list, button('All',
            'All channels as the file shows them', () => this.all()));
    }

    get first() {
        return [...this.page.info.channels.keys()].slice(0, CHANNELS_MOST);
    }

    /** As the file shows them, if these are all; else a list, which has the file's colours.
     * A file of --tf is of one volume. */
    all() {
        const {recipe, page} = this, usual = 'channel' in recipe.keys && !page.info.tf;
        this.before = usual && page.look;
        recipe.set({...this.plain, channel: usual ? null : this.first.join()});
    }

    /** The next change may come before the server's look. */
    set(channels) {
        const {look} = this.page, begins = mixed(look) ? {} : this.plain;
        if (channels.length <= CHANNELS_MOST) // more are refused
            look.channels = channels;
        this.recipe.set({...begins, ...listed(channels)});
    }

    /** One of them stays. */
    turn(index, on) {
        const others = this.page.look.channels.filter(one => one[0] !== index);
        if (on || others.length)
            this.set(on ? [...others, this.known[index] ?? [index]] : others);
        else
            this.update();
    }

    put(index, changes) {
        this.set(this.page.look.channels.map(one => one[0] === index ? Object.assign([...one], changes) : one));
    }

    row(index, name) {
        const box = check(name, on => this.turn(index, on));
        const color = ink(`colour of ${name}`, value => this.put(index, {2: value, 3: value}));
        const ends = ['lowest', 'highest'].map((word, i) => number(`${word} value of the range of ${name}`,
            value => (i ? this.known[index][4] < value : value < this.known[index][5]) &&
                this.put(index, {[4 + i]: value})));
        const opacity = slider(`opacity of ${name}`, 0, 1, 0.02, this.recipe, value => this.put(index, {6: value}));
        const more = make('div', {className: 'row'}, color, ...ends, opacity);
        return {box: box.box, color, ends, opacity, more, element: make('div', {}, box.label, more)};
    }

    update() {
        const {info, look} = this.page, drawn = look?.channels ?? [], names = info?.channels ?? [];
        this.element.hidden = names.length < 2;
        for (const one of [...names.map((name, i) => [i, name]), ...drawn])
            if (!this.rows[one[0]]) {
                this.rows[one[0]] = this.row(one[0], one[1] || `channel ${one[0]}`);
                this.list.append(this.rows[one[0]].element);
            }
        if (this.before && look !== this.before) {
            this.before = null;
            if (drawn.length < this.first.length)
                this.recipe.set({channel: this.first.join()});
        }
        this.rows.forEach(({box, color, ends, opacity, more}, index) => {
            const one = drawn.find(([k]) => k === index);
            box.checked = Boolean(one);
            more.hidden = !one?.[2];
            if (more.hidden)
                return;
            this.known[index] = one;
            color.value = one[3];
            apart(one.slice(4, 6), 5).forEach((value, i) => show(ends[i], value));
            opacity.value = one[6];
        });
    }
}
