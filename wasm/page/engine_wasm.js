// engine_wasm.js - the renderer in a worker of this page: the messages of
// engine_server.js without a server.  `host` is what shell.js gives.

import {ServerEngine as SocketEngine} from './engine_server.js';

const LEVELS = 4; // serve/message.h
const PATIENCE = 400; // ms

/** At an address, the path behind it is what option --dataset is elsewhere. */
const inWordsOfThePage = text => host.volume.address ? text.replace(/with --dataset\b/g, 'by its path behind the address')
    .replace(/--dataset selects\b/g, 'its path behind the address selects') : text;

export class ServerEngine extends SocketEngine {
    constructor() {
        super('');
        this.flat = true; // it finds no surface: depths are of method raycast
        this.on('said', ({text}) => {
            this.last = text.split('\n').at(-1);
        });
        for (const name of ['info', 'state'])
            this.on(name, host.opened);
    }

    open() {
        this.worker = host.work();
        this.helpers = [];
        this.worker.onmessage = ({data}) => this.receive(data);
        this.worker.onerror = event => this.tell('closed', event.message);
        this.worker.postMessage({t: 'open', ...host.volume},
            host.volume.files.flatMap(({bytes}) => bytes ?? []));
        this.tell('open');
        this.reading = setTimeout(() => this.inform(host.says, `Reading ${host.volume.path}`), PATIENCE);
    }

    /** A line on this page, unless another one has it as yet. */
    inform(there, text) {
        if (!there(text))
            this.tell('closed', text);
    }

    close() {
        clearTimeout(this.reading);
        for (const worker of [this.worker, ...this.helpers])
            worker.terminate();
    }

    say(message) {
        this.worker.postMessage(message.t === 'ack' ? {t: 'painted'}
            : {t: 'hear', text: JSON.stringify(message)});
    }

    /** A thread that ends, or cannot begin, would be waited for. */
    help(data) {
        const helper = host.work();
        const lost = text => {
            this.close();
            this.receive({t: 'refused', text});
        };
        helper.onmessage = event => lost(event.data.text);
        helper.onerror = () => lost('A thread of the engine cannot begin: load the page again.');
        helper.postMessage(data);
        this.helpers.push(helper);
    }

    /** How much has come from a server, while a volume is opened and later. */
    fetched({files, bytes}) {
        const text = `Reading ${host.volume.path}: ${files} files, ${(bytes / 1e6).toFixed(1)} MB`;
        clearTimeout(this.reading);
        if (this.reading)
            this.inform(host.says, text);
        else
            this.tell('said', {text});
    }

    receive(data) {
        if (data.t === 'help') {
            this.help(data);
            return;
        }
        if (data.t === 'fetched') {
            this.fetched(data);
            return;
        }
        if (this.reading) {
            clearTimeout(this.reading);
            this.reading = null;
            this.tell('open');
        }
        if (data.t !== 'refused') {
            this.hear(typeof data === 'string' ? inWordsOfThePage(data) : data);
            return;
        }
        const text = data.text || this.last || 'The file cannot be opened.';
        this.inform(host.refused, inWordsOfThePage(text).replace(/; install .*build again$/,
            '; snowglass serve shows it, and snowglass export makes a page of it'));
    }

    decode(frame) {
        return frame.kind === LEVELS
            ? createImageBitmap(new ImageData(new Uint8ClampedArray(frame.data, 32), frame.width, frame.height))
            : super.decode(frame);
    }
}
