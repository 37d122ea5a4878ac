"""What of anywidget the viewer uses, where that package is not: a model whose
messages a test sends and sees."""


class AnyWidget:
    def __init__(self, **traits):
        self.traits, self.sent, self._hear = traits, [], None
        self.listener = self.sent.append

    def on_msg(self, hear):
        self._hear = hear

    def send(self, content, buffers=None):
        self.listener((content, [bytes(each) for each in buffers or []]))

    def receive(self, content):
        """As if the page had sent it."""
        self._hear(self, content, [])

    def close(self):
        self.closed = True
