// engine_kernel.js - the renderer in the kernel of a notebook: the messages of
// engine_server.js over the connection that the notebook has, anywidget's model.
// `host` is what notebook.js gives.

import {ServerEngine as SocketEngine} from './engine_server.js';

const PATIENCE = 5000; // ms

export class ServerEngine extends SocketEngine {
    constructor() {
        super('');
        this.page = Math.random().toString(36).slice(2); // one of several views
        this.take = (message, buffers) => this.receive(message, buffers);
    }

    open() {
        host.model.on('msg:custom', this.take);
        this.on('info', () => clearTimeout(this.silent));
        this.silent = setTimeout(() => this.tell('closed',
            'The kernel does not answer. When it is idle, run the cell again.'), PATIENCE);
        this.say({t: 'hello'});
        this.tell('open');
    }

    close() {
        clearTimeout(this.silent);
        host.model.off('msg:custom', this.take);
        this.say({t: 'bye'});
    }

    say(message) {
        host.model.send({...message, page: this.page});
    }

    receive(message, buffers) {
        if (message.to !== this.page)
            return;
        if (message.t !== 'frame') {
            this.hear(JSON.stringify(message));
            return;
        }
        const [data] = buffers;
        const bytes = new Uint8Array(data.buffer ?? data, data.byteOffset ?? 0, data.byteLength);
        this.hear(bytes.slice().buffer);
    }
}
