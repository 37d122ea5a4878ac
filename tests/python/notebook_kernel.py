"""notebook_kernel.py SOURCE: the kernel of notebook.mjs: messages of a page come as
lines on standard input, and go as lines on standard output.  Bytes are base64."""
import base64
import json
import os
import sys
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                "stand_ins"))
import snowglass as sg  # noqa: E402
from snowglass import viewer  # noqa: E402


def main():
    lock = threading.Lock()

    def answer(sent):
        content, buffers = sent
        with lock:
            print(json.dumps([content, [base64.b64encode(each).decode()
                                        for each in buffers]]), flush=True)

    widget = viewer.Viewer(sg.Volume(sys.argv[1]))
    print(json.dumps(viewer.bundle()), flush=True)
    widget.listener = answer
    for line in sys.stdin:
        widget.receive(json.loads(line))


if __name__ == "__main__":
    main()
