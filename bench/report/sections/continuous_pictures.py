# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of what is told between the rings: range images, cut-outs of them and views, beside the
exact scene or the whole scan."""
from dataclasses import dataclass
from pathlib import Path

import numpy

from common.digest import digest
from frame import files
from frame.context import OUTPUT
from frame.scans import Scene
from frame.tables import Figure
from sections import pictures
from sections.one_to_one import taken_as

FACTOR, QUICK_FACTOR = 8, 4
EVERY = 4               # of real scans
SECTOR = .28            # share of the turn that a range image shows
CUT_ROWS, CUT_COLUMNS = .2, 72  # share of the rows, columns
CUTS = (("poles", 2), ("low", 2), ("edges", 3))
APART = 1.15            # ratio of two ranges across an edge
PLANES = ("elevation", "truth", "compact", "confidence", "compact-field", "edge-aware")
SPREAD = 2              # cut-outs lie so many of their widths apart
VIEW_WIDTH = 600


@dataclass
class Images:
    """Range images of one size, rows from the top; `beside`: what the truth is; `first`: the first
    row of a coded ring."""
    planes: dict
    beside: str
    factor: int
    first: int

    def of_rows(self, name, factor):
        """Made `factor` times denser only, its rows repeated to the size of the others."""
        plane, step = self.planes[name], self.factor // factor
        nearest = numpy.arange(plane.shape[0]) - self.first + step // 2
        taken = self.first + nearest // step * step
        return plane[numpy.clip(taken, 0, plane.shape[0] - 1)]


def read(path, item, factor):
    planes = dict(zip(PLANES, numpy.load(path)))
    beside = "exact" if isinstance(item, Scene) else "all rings"
    return Images(planes, beside, factor, (planes["truth"].shape[0] - 1) % factor)


def factor_of(context):
    return QUICK_FACTOR if context.quick else FACTOR


def file_of(context, item):
    program, factor = context.bin / "report_measure", ["--factor", str(factor_of(context))]
    if isinstance(item, Scene):
        return context.made(".npy", [program, "range-images-truth", item.name, item.sensor,
                                     item.preset, OUTPUT, "--seed", str(item.seed), *factor])
    return context.made(".npy", [program, "range-images", item.path, OUTPUT, "--every", str(EVERY),
                                 *taken_as(item), *factor])


def told_of(item, factor):
    """(what is beside the reconstruction, how it was made) for captions."""
    if isinstance(item, Scene):
        return "the exact scene", f"the scan at 1 bit a return, up to {factor} times its rings"
    return "all rings of the scan (edge-aware between them)", \
        f"every {EVERY}th ring at 1 bit a return, up to {factor} times these rings"


def ids_of(item):
    return {kind: f"between-{kind}-{item.id.lower()}" for kind in ("images", "cuts", "views")}


def measure(context, items):
    """Draws what is not drawn yet."""
    for item in items:
        made, names = file_of(context, item), ids_of(item)
        targets = {kind: context.figure_path(name, "png") for kind, name in names.items()}
        made_from = digest("between", made.path.name, Path(__file__))
        if context.store.get("continuous", made_from) and all(
                target.is_file() for target in targets.values()):
            continue
        context.progress(f"continuous: pictures of {item.name}")
        images = read(context.make(made), item, factor_of(context))
        draw_images(context, images, targets["images"])
        draw_cuts(context, images, targets["cuts"])
        draw_views(context, item, images, targets["views"])
        context.store.add("continuous", made_from, {"picture": item.id}, "curlidar render",
                          [{"file": target.name} for target in targets.values()])


def figures(context, items):
    found = []
    for item in items:
        factor, names = factor_of(context), ids_of(item)
        beside, coded = told_of(item, factor)
        found += [
            Figure(names["images"], f"{item.name}: range images between the rings",
                   f"A part of the turn, from {beside} to {coded}, then edge-aware interpolation "
                   "of the raw samples and the confidence of curlidar (yellow: high). Black: "
                   "nothing is told.", "png", f"the coded file of {item.name}"),
            Figure(names["cuts"], f"{item.name}: cut-outs",
                   "Where there are most thin things (poles), most edges below the horizon "
                   "(wheels, kerbs) and most edges at all (foliage): each coloured from its "
                   "nearest to its farthest range.", "png", f"the coded file of {item.name}"),
            Figure(names["views"], f"{item.name}: views",
                   f"From the left: {beside}, then {coded}; coloured by height.", "png",
                   f"the coded file of {item.name}")]
    return found


def edges(plane):
    """Where the range jumps to a neighbour; what is empty on either side does not count."""
    found = numpy.zeros(plane.shape, dtype=bool)
    with numpy.errstate(invalid="ignore", divide="ignore"):
        for axis in (0, 1):
            ratio = plane / numpy.roll(plane, 1, axis)
            found |= (ratio > APART) | (ratio < 1 / APART)
    found[0] = False
    return found


def poles(plane, width=5):
    """What is nearer than both its sides."""
    with numpy.errstate(invalid="ignore"):
        return (plane * APART < numpy.roll(plane, width, 1)) & \
            (plane * APART < numpy.roll(plane, -width, 1))


def windows(images):
    """(kind, row, column) of cut-outs, none over another."""
    truth = images.planes["truth"]
    height = max(4, int(truth.shape[0] * CUT_ROWS))
    free = numpy.ones(truth.shape, dtype=bool)
    edge = edges(truth)
    low = edge & (images.planes["elevation"] < numpy.radians(-3))
    counted = {"poles": poles(truth), "low": low, "edges": edge}
    for kind, number in CUTS:
        for _ in range(number):
            best = (0, None)
            for row in range(0, truth.shape[0] - height + 1, height // 2):
                for column in range(0, truth.shape[1] - CUT_COLUMNS, CUT_COLUMNS // 2):
                    where = numpy.s_[row:row + height, column:column + CUT_COLUMNS]
                    if free[where].all():
                        best = max(best, (int(counted[kind][where].sum()), where),
                                   key=lambda each: each[0])
            if best[1] is not None:
                columns = best[1][1]
                yield kind, best[1]
                around = max(0, columns.start - SPREAD * CUT_COLUMNS)
                free[:, around:columns.stop + SPREAD * CUT_COLUMNS] = False


def figure_of(rows, columns, width, height):
    from frame import plots
    figure, axes = plots.pyplot.subplots(rows, columns, squeeze=False, figsize=(width, height),
                                         layout="constrained", facecolor="white")
    for axis in axes.flat:
        axis.set(xticks=[], yticks=[], facecolor="black")
        axis.grid(False)
        axis.title.set_fontsize(9)
        axis.title.set_color("black")
    return figure, axes


def save(context, figure, target):
    from frame import plots
    part = context.scratch / target.name
    figure.savefig(part, format="png", dpi=100, facecolor="white")
    plots.pyplot.close(figure)
    files.write(target, part.read_bytes())


def draw_plane(axis, plane, title, low, high):
    with numpy.errstate(invalid="ignore", divide="ignore"):
        axis.imshow(numpy.log(plane), cmap="turbo_r", vmin=numpy.log(low), vmax=numpy.log(high),
                    aspect="auto", interpolation="nearest")
    axis.set_title(title)


def shown(images):
    """(title, plane) of what is drawn side by side."""
    return [(images.beside, images.planes["truth"]),
            *((f"curlidar, {factor}x", images.of_rows("compact", factor))
              for factor in (1, images.factor // 2, images.factor)),
            (f"edge-aware, {images.factor}x", images.planes["edge-aware"])]


def draw_images(context, images, target):
    truth = images.planes["truth"]
    width = int(truth.shape[1] * SECTOR)
    counts = numpy.convolve(edges(truth).sum(0), numpy.ones(width), "valid")
    part = slice(int(counts.argmax()), int(counts.argmax()) + width)
    drawn = shown(images)
    figure, axes = figure_of(len(drawn) + 1, 1, 11, 1.55 * (len(drawn) + 1))
    low, high = numpy.nanpercentile(truth[:, part], (2, 98))
    for axis, (title, plane) in zip(axes.flat, drawn):
        draw_plane(axis, plane[:, part], title, low, high)
    axes.flat[-1].imshow(images.planes["confidence"][:, part], cmap="viridis", vmin=0, vmax=1,
                         aspect="auto", interpolation="nearest")
    axes.flat[-1].set_title("confidence")
    save(context, figure, target)


def draw_cuts(context, images, target):
    cuts, drawn = list(windows(images)), shown(images)
    figure, axes = figure_of(len(cuts), len(drawn), 2.1 * len(drawn), 1.35 * len(cuts))
    for row, (kind, where) in zip(axes, cuts):
        seen = images.planes["truth"][where]
        low, high = numpy.nanpercentile(seen, (1, 99)) if numpy.isfinite(seen).any() else (1, 10)
        for axis, (title, plane) in zip(row, drawn):
            draw_plane(axis, plane[where], f"{kind}: {title}", low, high)
    save(context, figure, target)


def draw_views(context, item, images, target):
    truth, told = images.planes["truth"], images.planes["compact"]
    clouds = [(images.beside, truth, 1)] + [
        (f"{factor}x", told, images.factor // factor)
        for factor in (1, images.factor // 2, images.factor)]
    drawn = []
    for name, plane, step in clouds:
        path = context.scratch / f"{target.stem}-{name.replace(' ', '-')}.npy"
        numpy.save(path, points_of(images.planes["elevation"], plane, images.first % step, step))
        drawn.append(context.make(pictures.drawn(context, path, *pictures.camera(item), "--title",
                                                 name, width=VIEW_WIDTH)))
    pictures.side_by_side(context, drawn, target)


def points_of(elevation, plane, first, step):
    """Every step-th row as points, float32."""
    azimuth = -numpy.pi + 2 * numpy.pi * numpy.arange(plane.shape[1]) / plane.shape[1]
    ranges, up = plane[first::step], elevation[first::step]
    flat = ranges * numpy.cos(up)
    points = numpy.stack([flat * numpy.cos(azimuth), flat * numpy.sin(azimuth),
                          ranges * numpy.sin(up)], -1).reshape(-1, 3)
    return points[numpy.isfinite(points).all(1)].astype(numpy.float32)
