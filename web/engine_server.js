// engine_server.js - the renderer behind a WebSocket: sends what changes,
// receives pictures and texts.  Of the page only this module and the first
// lines of viewer.js know the address.

import {merged} from './store.js';

const MAGIC = 0x31574e53;
const TYPES = ['', 'image/jpeg', 'image/png', 'image/webp'];
const FIRST = 1; // of the parts of a picture
const FRAME = 12; // ms, less than that of a screen
const FATAL = [4400, 4401, 4429]; // a message that it does not take, the secret, too many

/** @typedef {import('./types').Changes} Changes */
/** @typedef {import('./types').Heard} Heard */

/**
 * Events by name: 'open', 'closed', 'picture', 'small' (of a slice or a preset,
 * in its pane), and the kinds of texts (info, look, state, figures, progress,
 * histogram, command, said, slice, value, depth, times, movie).
 */
export class ServerEngine {
    /** @param {string} token */
    constructor(token) {
        this.token = token;
        /** @type {Map<keyof Heard, ((message: any) => void)[]>} */
        this.hearers = new Map();
        this.step = 0; // the number of the newest set
        this.since = 0; // when what waits began to
        /** @type {Map<number, number>} */
        this.sentAt = new Map();
        /** @type {Map<number, Changes>} */
        this.unheard = new Map(); // changes that no state or picture has yet
        /** @type {Changes|null} */
        this.waiting = null; // changes that are not sent yet
        /** @type {Uint8Array[]} */
        this.parts = []; // of the picture that comes in such
        this.painting = Promise.resolve();
        this.wait = 500;
        this.flushed = 0;
        /** @type {Changes} */
        this.lost = {}; // what a server that went away has not heard
    }

    /** @template {keyof Heard} K
     * @param {K} name
     * @param {(message: Heard[K]) => void} hear */
    on(name, hear) {
        this.hearers.set(name, [...(this.hearers.get(name) ?? []), hear]);
    }

    /** @template {keyof Heard} K
     * @param {K} name
     * @param {Heard[K]} [value] */
    tell(name, value) {
        for (const hear of this.hearers.get(name) ?? [])
            hear(value);
    }

    open() {
        const url = new URL('ws', location.href);
        url.protocol = url.protocol.replace('http', 'ws');
        this.socket = new WebSocket(url, 'snowglass.1');
        this.socket.binaryType = 'arraybuffer';
        this.socket.onopen = () => {
            this.wait = 500;
            this.sentAt.clear();
            this.lost = Object.assign({}, ...this.unheard.values(), this.waiting);
            delete this.lost.size;
            this.unheard.clear();
            this.waiting = null;
            this.parts = [];
            this.say({t: 'hello', token: this.token, wants: ['jpeg', 'png', 'webp']});
            this.tell('open');
        };
        this.socket.onclose = event => this.closed(event);
        this.socket.onmessage = event => this.hear(event.data);
    }

    /** @param {CloseEvent} event */
    closed(event) {
        const fatal = FATAL.includes(event.code);
        this.tell('closed', fatal ? `${event.reason} ${event.code === 4400 ? 'Load the page again.' : ''}` : 'The viewer does not answer. ' +
            'Trying again; if it has ended, start snowglass serve again.');
        if (fatal)
            return;
        setTimeout(() => this.open(), this.wait);
        this.wait = Math.min(2 * this.wait, 8000);
    }

    /** @param {import('./types').Said} message */
    say(message) {
        if (this.socket?.readyState === WebSocket.OPEN)
            this.socket.send(JSON.stringify(message));
    }

    /** What the server has for this page; the secret is no part of the address.
     * @param {string} name */
    fetch(name) {
        return fetch(new URL(name, location.href), {headers: {'x-auth-token': this.token}});
    }

    /** Of the recipe as it is now.
     * @param {string} what */
    ask(what, more = {}) {
        this.flush();
        this.say({t: 'ask', what, ...more});
    }

    /** @param {boolean} on */
    moving(on) {
        this.flush();
        this.say({t: 'moving', on});
    }

    /** Changes of a recipe; null takes a key out.  Sent once what makes them has ended, as a
     * timer would wait for the page to be painted, but not more often than each FRAME.  One that
     * waited does not make those of all later frames wait.
     * @param {Changes} changes */
    set(changes) {
        if (!this.waiting) {
            this.since = performance.now();
            const rest = this.flushed + FRAME - this.since;
            if (rest > 0)
                setTimeout(() => this.flush(), rest);
            else
                queueMicrotask(() => this.flush());
        }
        this.waiting = {...this.waiting, ...changes};
    }

    flush() {
        if (!this.waiting)
            return;
        this.step++;
        this.flushed = performance.now();
        this.sentAt.set(this.step, this.since);
        this.unheard.set(this.step, this.waiting);
        this.say({t: 'set', step: this.step, keys: this.waiting});
        this.waiting = null;
    }

    /** @param {string|ArrayBuffer} data */
    hear(data) {
        if (typeof data === 'string') {
            const message = JSON.parse(data);
            this.tell(message.t, message.t === 'state' ? this.renewed(message) : message);
            return;
        }
        const whole = this.whole(data), came = performance.now();
        if (whole)
            this.painting = this.painting.then(() => this.paint(whole, came)).catch(
                error => this.tell('said', {text: `A picture cannot be shown: ${error.message}`}));
    }

    /** A picture, or null while parts of it are missing.  On a thin link another one may
     * come before them, as the server drops them then.
     * @param {ArrayBuffer} data */
    whole(data) {
        const {11: part, 10: pane} = new Uint8Array(data, 0, 12), [all] = new Uint32Array(data, 12, 1);
        if (!part) {
            this.parts = pane ? this.parts : [];
            return data;
        }
        this.say({t: 'part'});
        this.parts = part === FIRST ? [new Uint8Array(data)] : [...this.parts, new Uint8Array(data, 32)];
        const bytes = this.parts.reduce((sum, each) => sum + each.byteLength, -32);
        if (bytes < all)
            return null;
        const made = new Uint8Array(32 + all);
        let at = 0;
        for (const each of this.parts.splice(0)) {
            made.set(each, at);
            at += each.byteLength;
        }
        return made.buffer;
    }

    /** What the page has changed since stays on top of a state.
     * @param {import('./types').State} state
     * @returns {import('./types').State} */
    renewed(state) {
        this.heard(state.step);
        /** @type {Changes} */
        const changes = Object.assign({}, ...this.unheard.values(), this.waiting);
        const computed = Object.entries(state.computed ?? {}).filter(([key]) => !(key in changes));
        return {...state, keys: merged(state.keys, changes), computed: Object.fromEntries(computed)};
    }

    /** @param {number} step */
    heard(step) {
        for (const key of this.unheard.keys())
            if (key <= step)
                this.unheard.delete(key);
    }

    /** @param {ArrayBuffer} data
     * @param {number} came */
    async paint(data, came) {
        const [magic, n, , , width, height, render, pack] = new Uint32Array(data, 0, 8);
        const [level, kind, pane] = new Uint8Array(data, 8);
        if (magic !== MAGIC) // as machines have it that browsers are on: little endian
            return;
        /** @type {import('./types').Frame} */
        const frame = {n, level, kind, pane, width, height, render: render / 1000, pack: pack / 1000,
            data, bytes: data.byteLength,
            blob: new Blob([new Uint8Array(data, 32)], {type: TYPES[kind]})};
        if (pane) {
            this.tell('small', frame);
            return;
        }
        try {
            const bitmap = frame.bitmap = await this.decode(frame);
            this.tell('picture', frame);
            bitmap.close();
        } finally { // the server waits for it
            this.say({t: 'ack', n, took: Math.round(performance.now() - came)});
            this.measure(n);
        }
    }

    /** @param {import('./types').Frame} frame */
    decode({blob}) {
        return createImageBitmap(blob, {premultiplyAlpha: 'none', colorSpaceConversion: 'none'});
    }

    /** @param {number} n */
    measure(n) {
        this.heard(n);
        const sent = this.sentAt.get(n);
        if (sent !== undefined)
            this.tell('measured', performance.now() - sent);
        for (const key of this.sentAt.keys())
            if (key <= n)
                this.sentAt.delete(key);
    }
}
