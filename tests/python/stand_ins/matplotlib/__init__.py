"""In the place of matplotlib, where that is not installed: its map bone, of which
matplotlib gives the points, and one of ten steps."""

BONE = ([(0, 0), (0.746032, 0.652778), (1, 1)],
        [(0, 0), (0.365079, 0.319444), (0.746032, 0.777778), (1, 1)],
        [(0, 0), (0.365079, 0.444444), (1, 1)])


def bone(share):
    def between(points):
        for (a, x), (b, y) in zip(points, points[1:]):
            if share <= b:
                return x + (y - x) * (share - a) / (b - a)
        return 1.0
    return (*map(between, BONE), 1.0)


def steps(share):
    return (int(min(share, 0.999) * 10) / 9, 0.0, 1.0, 1.0)


colormaps = {"bone": bone, "steps": steps}
