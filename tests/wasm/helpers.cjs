// helpers.cjs - threads of the engine in Node: of each the page's worker.js says what
// it begins with.
const fs = require('fs');
const {Worker, isMainThread, workerData, parentPort} = require('worker_threads');

function helpers(worker) {
    const all = [], ready = [];
    return {
        share(data) {
            const helper = new Worker(__filename, {workerData: {worker, data}});
            all.push(helper);
            ready.push(new Promise(good => helper.once('message', good)));
        },
        /** Their folders in /proc, once they have begun. */
        folders: () => Promise.all(ready),
        end: () => Promise.all(all.map(helper => helper.terminate()))};
}

if (isMainThread) {
    module.exports = {helpers};
} else {
    parentPort.postMessage(fs.readlinkSync('/proc/thread-self'));
    require(workerData.worker).help(workerData.data);
}
