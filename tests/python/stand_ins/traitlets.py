"""What of traitlets the viewer uses, in tests."""


class Int:
    def __init__(self, value):
        self.value = value

    def tag(self, **_):
        return self
