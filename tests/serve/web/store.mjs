// store.mjs - the store of the page and its engine, with a server of a few lines: it keeps
// each text that is sent to it, and what it answers is written here.
import {ServerEngine} from './web/engine_server.js';
import {listed} from './web/look.js';
import {Store} from './web/store.js';

let wrong = 0;

function check(what, is, wanted) {
    const good = JSON.stringify(is) === JSON.stringify(wanted);
    console.log(good ? `ok     ${what}` : `FAILED ${what}: ${JSON.stringify(is)}, not ${JSON.stringify(wanted)}`);
    wrong += good ? 0 : 1;
}

globalThis.location = new URL('http://127.0.0.1:8000/');
globalThis.WebSocket = class {
    static OPEN = 1;
    readyState = 1;
    sent = [];
    send(text) {
        this.sent.push(JSON.parse(text));
    }
};

/** A page whose server has said a state. */
function begin(keys = {}, computed = {}) {
    const engine = new ServerEngine('secret'), store = new Store(engine);
    engine.open();
    const {socket} = engine;
    socket.onopen();
    socket.sent.length = 0;
    const hear = message => socket.onmessage({data: JSON.stringify(message)});
    const sent = () => {
        engine.flush();
        return socket.sent.splice(0).filter(({t}) => t === 'set');
    };
    hear({t: 'state', step: 0, touched: false, keys, computed});
    return {engine, store, hear, sent};
}

const points = [[10, 0], [90, 1]];
{
    const {store, hear, sent} = begin({view: 'left'});
    store.set({azimuth: 30});
    check('a change has a step and its keys', sent(), [{t: 'set', step: 1, keys: {azimuth: 30}}]);
    store.set({azimuth: 30});
    check('what is so already is not sent', sent(), []);
    hear({t: 'state', step: 0, keys: {view: 'left', roll: 5}});
    check('a state without a change keeps it', store.keys, {view: 'left', roll: 5, azimuth: 30});
    hear({t: 'state', step: 1, keys: {view: 'left', azimuth: 31}});
    check('one that has it is the truth', store.keys, {view: 'left', azimuth: 31});
}
{
    const {store, hear, sent} = begin();
    store.set({opacity: points});
    sent();
    hear({t: 'state', step: 1, keys: {opacity: points}, computed: {range: [0, 100], shade: 'none'}});
    check('what is computed is seen', store.keys, {opacity: points, range: [0, 100], shade: 'none'});
    check('and not of the user', store.own, {opacity: points});
    store.set({range: [0, 100], shade: 'none'});
    check('and never sent back', sent(), []);
    store.set({azimuth: 1, range: [0, 100]});
    check('beside others neither', sent().map(({keys}) => keys), [{azimuth: 1}]);
    store.undo();
    sent();
    store.replace({...store.own, zoom: 2, range: [0, 100], shade: 'none'});
    check('nor with a whole recipe', sent().map(({keys}) => keys), [{opacity: points, zoom: 2}]);
    store.set({range: [0, 50]});
    check('another value is the user\'s', [sent().map(({keys}) => keys), store.computed],
        [[{range: [0, 50]}], {shade: 'none'}]);
    store.undo();
    check('until it is undone', sent().map(({keys}) => keys), [{range: null}]);
    hear({t: 'state', step: 0, keys: {}, computed: {range: [0, 100]}});
    check('what was set meanwhile is not computed', [store.computed, store.keys.range], [{}, undefined]);
}
{
    const {store, sent} = begin({crop: [[0, 9], [0, 9], [0, 9]], zoom: 2});
    store.replace({crop: [[0, 5], [0, 9], [0, 9]], zoom: 2});
    check('a whole recipe is sent whole', sent().map(({keys}) => keys),
        [{crop: [[0, 5], [0, 9], [0, 9]], zoom: 2}]);
    store.set({slices: {at: [1, 2, 3], range: [0, 1]}});
    check('slices are of the page alone', [sent(), store.keys.slices?.at], [[], [1, 2, 3]]);
}
{
    const {store} = begin();
    const look = Object.freeze({low: 0, high: 100, count: 300, opacity: points, gradient: [], strip: ['#000000'],
        text: '', shaded: true, channels: Object.freeze([[0, 'DAPI', 'blue', '#0000ff', 10, 200, 1],
            [1, 'GFP', 'green', '#00ff00', 5, 50, 0.5]])});
    store.answered = look;
    check('the look is what the server says', [store.look.low, store.look.channels], [0, look.channels]);
    check('and the same until something is set', store.look === store.look, true);
    const other = [[1, 'GFP', '#ff0000', '#ff0000', 5, 60, 0.25], [0, 'DAPI', 'blue', '#0000ff', -1e-7, 2.5e9, 1]];
    store.set(listed(other));
    check('channels are as they were set', store.look.channels, other);
    store.set({channel: '0:blue:p1..p99'});
    check('or as the server finds them', store.look.channels, look.channels);
    store.set({channel: '1'});
    check('one alone has no map', store.look.channels, [[1, 'GFP', '', '#00ff00', 5, 50, 0.5]]);
    store.set({range: [20, 30], opacity: [[20, 0]]});
    check('and the range and points that were set', [store.look.low, store.look.high, store.look.count], [20, 30, 1]);
    store.set({colormap: '5:#000000,40:#ffffff'});
    check('colours at values have the range of these', [store.look.low, store.look.high], [0, 100]);
    store.set({range: ['p1', 'p99'], colormap: null});
    check('shares of values are the server\'s to find', [store.look.low, store.look.high], [0, 100]);
    store.answered = {...look, overlay: {low: 1, high: 9, labels: []}};
    store.set({'overlay-look': 'hot,2,12,2:0,12:0.5'});
    check('the overlay\'s range too', store.look.overlay, {low: 2, high: 12, labels: []});
}
{
    const {engine, hear} = begin(), painted = [];
    const {socket} = engine;
    /** A message with a head, of a level, of a part, of so many bytes in all. */
    const frame = (level, part, all, ...bytes) => {
        const data = new Uint8Array([83, 78, 87, 49, 0, 0, 0, 0, level, 1, 0, part, ...new Array(20).fill(0), ...bytes]);
        new DataView(data.buffer).setUint32(12, all, true);
        socket.onmessage({data: data.buffer});
    };
    engine.paint = async data => painted.push([...new Uint8Array(data)].slice(32));
    frame(2, 1, 5, 1, 2);
    frame(2, 2, 5, 3, 4);
    await engine.painting;
    check('parts of a picture are no picture', painted, []);
    frame(2, 2, 5, 5);
    frame(0, 0, 0, 9);
    await engine.painting;
    check('until all are there', painted.splice(0), [[1, 2, 3, 4, 5], [9]]);
    frame(2, 1, 5, 1, 2);
    frame(0, 0, 0, 7);
    frame(2, 1, 3, 4, 5);
    frame(2, 2, 3, 6);
    await engine.painting;
    check('another one comes in the place of those that do not come', painted, [[7], [4, 5, 6]]);
    check('each part is acknowledged', socket.sent.filter(({t}) => t === 'part').length, 6);
    hear({t: 'said', text: ''});
}
process.exit(wrong ? 1 : 0);
