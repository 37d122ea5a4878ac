// time.js - the time steps: their slider with the times of the file, and playing them.
//
// The next step is asked for when the last one was painted, and no sooner than the speed
// says: a slow link, or a large volume, plays slowly, and nothing waits in a row.

import {button, make, number, row, section, select, show, slider} from '../controls.js';
import {known} from '../store.js';

const SPEED = 5;
const LOOPS = [['loop', 'again and again'], ['once', 'once'], ['both', 'to and fro']];

export class Times {
    /** @param {import('../store.js').Store} store
     * @param {() => void} update of the panel */
    constructor(store, update) {
        const {engine} = store;
        this.store = store;
        this.engine = engine;
        this.update = update;
        // Of this page alone: how it plays, from the first to the last step.
        this.speed = SPEED;
        this.first = 0;
        this.last = 0;
        this.loop = 'loop';
        /** @type {string[]} */
        this.texts = []; // of the file's times
        this.playing = false;
        this.way = 1;
        this.at = 0; // the step that was asked for,
        this.asked = 0; // when,
        this.wanted = 0; // and with which set
        /** @type {number|undefined} */
        this.timer = undefined;
        this.button = button('Play', 'Play or stop the time steps (Space)', () => this.play());
        engine.on('times', ({texts}) => {
            this.texts = texts;
            update();
        });
        engine.on('picture', ({n}) => this.painted(n));
        engine.on('closed', () => this.stop());
        store.onChange(keys => {
            if (this.playing && (keys.time ?? 0) !== this.at) // by another page, or it cannot be read
                this.stop();
        });
    }

    get now() {
        return this.store.keys.time ?? 0;
    }

    play() {
        const {store} = this;
        if (this.playing || (store.info?.times ?? 1) < 2) {
            this.stop();
            return;
        }
        store.part();
        store.remember(['time']); // one step to undo, however long it plays
        this.playing = true;
        this.way = 1;
        this.ask(this.loop === 'once' && this.now >= this.last || this.now < this.first || this.now > this.last
            ? this.first : this.now);
        this.show();
    }

    stop() {
        clearTimeout(this.timer);
        this.playing = false;
        this.show();
    }

    show() {
        this.button.textContent = this.playing ? 'Stop' : 'Play';
        this.button.setAttribute('aria-pressed', `${this.playing}`);
    }

    /** The step after another one; null: it was the last. */
    next() {
        const {first, last, loop} = this, next = this.at + this.way;
        if (next >= first && next <= last)
            return next;
        if (loop === 'both' && first < last) {
            this.way = -this.way;
            return Math.min(last, Math.max(first, this.at + this.way));
        }
        return loop === 'once' ? null : first;
    }

    /** @param {number} step */
    ask(step) {
        const {engine, store} = this, same = step === this.now;
        this.at = step;
        this.asked = performance.now();
        if (!same) {
            store.apply({time: step});
            engine.flush();
        }
        this.wanted = engine.step;
        if (same)
            this.painted(this.wanted);
    }

    /** @param {number} n the newest set that a picture has */
    painted(n) {
        if (!this.playing || n < this.wanted)
            return;
        this.wanted = Infinity;
        this.timer = setTimeout(() => {
            const next = this.next();
            if (next === null)
                this.stop();
            else
                this.ask(next);
        }, this.asked + 1000 / this.speed - performance.now());
    }

    /** `follow` keeps controls as the recipe is.
     * @param {(each: (keys: Readonly<import('../types').Keys>) => void) => void} follow */
    section(follow) {
        const {store, engine} = this, {times, movies} = known(store.info);
        this.texts = [];
        this.first = 0;
        this.last = times - 1;
        this.stop();
        if (times < 2)
            return '';
        if (movies !== undefined) // the kernel of a notebook knows no times
            engine.ask('times');
        const told = make('output'), date = make('output', {className: 'date'}), speed = make('output');
        const input = slider('time step', 0, times - 1, 1, store, value => store.set({time: value}));
        const rate = slider('steps a second', 1, 30, 1, store, value => {
            this.speed = value;
            this.update();
        });
        rate.value = `${this.speed}`;
        /** @type {(name: 'first'|'last') => HTMLInputElement} */
        const end = name => number(`${name} step that is played`, value => {
            const [low, high] = name === 'first' ? [0, this.last] : [this.first, times - 1];
            this[name] = Math.max(low, Math.min(high, Math.round(value)));
            this.update();
        }, 1);
        const ends = /** @type {const} */ (['first', 'last']).map(name => /** @type {const} */ ([name, end(name)]));
        const loop = select(LOOPS, value => {
            this.loop = value;
        });
        loop.value = this.loop;
        const dated = row('Time', date);
        follow(keys => {
            const time = keys.time ?? 0, text = this.texts[time] ?? '';
            input.value = `${time}`;
            input.setAttribute('aria-valuetext', text ? `${text}, step ${time}` : `step ${time}`);
            told.textContent = `${time} / ${times - 1}`;
            dated.hidden = !this.texts.length;
            date.textContent = text;
            speed.textContent = `${this.speed} / s`;
            ends.forEach(([name, field]) => show(field, this[name]));
        });
        return section('Time', true, row('Step', input, told), dated, row('Speed', rate, speed),
            row('From, to', ...ends.map(([, field]) => field)), row('Plays', loop), this.button);
    }
}
