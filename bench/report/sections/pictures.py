# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of scans and of what is made of them, drawn by `curlidar render`."""
from matplotlib import image as pixels
import numpy

from common.digest import digest
from frame import files
from frame.context import OUTPUT
from frame.tables import Figure

TITLE = "Pictures"
ERROR_M, QUICK_ERROR_M = .02, .05  # of the compact files that are drawn
ERROR_SCALE_M = .2                 # where the colours of errors end
WIDTH = 640                        # of one of three pictures side by side
GAP = 6


def chosen(context):
    """The scans that are drawn: the first real one and the first scene, in full mode two more
    scenes."""
    return context.scans[:1] + context.scenes[:1 if context.quick else 3]


def coded_of(context, item, profile):
    """The files that are drawn. `profile`: compact or paper."""
    error = f"{QUICK_ERROR_M if context.quick else ERROR_M:g}"
    settings = ["--error-nn", error] if profile == "compact" else \
        ["--profile", "paper", "--preset", getattr(item, "preset", "auto")]
    return context.made(".curl", [
        context.curlidar, "encode", context.cloud(item), *settings, "--attributes", "none",
        "--threads", "1", "--quiet", "-o", OUTPUT])


def drawn(context, source, *options, width=WIDTH):
    """The file of a picture."""
    return context.made(".png", [
        context.curlidar, "render", source, *options, "--size", f"{width}x0", "--threads", "1",
        "--quiet", "-o", OUTPUT])


def camera(item):
    """Of perspective views. Rooms without their ceilings."""
    return ["--clip-above", "1.2"] if item.name in ("room", "corridor") or "indoor" in item.name \
        else ["--distance", "45"]


def pictures_of(context, item):
    """(id, title, caption, Made pictures that stand side by side)."""
    cloud, compact, paper = (context.cloud(item), coded_of(context, item, "compact"),
                             coded_of(context, item, "paper"))
    view, name, asked = camera(item), item.id.lower(), QUICK_ERROR_M if context.quick else ERROR_M
    yield (f"density-{name}", f"{item.name}: original, decoded, decoded 8 times denser",
           f"Left the scan, in the middle its compact file at {asked * 100:g} cm mean error "
           "decoded as it is, right decoded with eight times as many rows; coloured by height.",
           [drawn(context, cloud, *view, "--title", "original"),
            drawn(context, compact, *view, "--title", "1x"),
            drawn(context, compact, *view, "--rows", "8", "--title", "8x")])
    error = ["--colour", "error", "--reference", cloud, "--max-value", str(ERROR_SCALE_M), *view]
    yield (f"error-{name}", f"{item.name}: errors of the reconstruction",
           f"Distance of each decoded return to the nearest return of the scan, up to "
           f"{ERROR_SCALE_M * 100:g} cm: left the compact file at {asked * 100:g} cm, right the "
           "paper's profile.",
           [drawn(context, compact, *error, "--title", "compact"),
            drawn(context, paper, *error, "--title", "paper")])
    yield (f"partition-{name}", f"{item.name}: the compact codec's partition",
           "Blocks of cells of the range image that share one surface, or two or more; the turn is "
           "cut into stripes.",
           [drawn(context, compact, "--view", "partition", width=1280)])
    yield (f"degrees-{name}", f"{item.name}: degrees of the paper's patches",
           "Degree of the spherical harmonics with which each patch of the range image is fitted; "
           "the turn is cut into stripes.",
           [drawn(context, paper, "--view", "degrees", width=1280)])


def side_by_side(context, paths, target):
    """One PNG of several, of equal height at least."""
    images = [numpy.asarray(pixels.imread(path))[..., :3] for path in paths]
    height = max(image.shape[0] for image in images)
    width = sum(image.shape[1] for image in images) + GAP * (len(images) - 1)
    canvas = numpy.full((height, width, 3), .5, dtype=images[0].dtype)
    left = 0
    for image in images:
        canvas[:image.shape[0], left:left + image.shape[1]] = image
        left += image.shape[1] + GAP
    part = context.scratch / target.name
    pixels.imsave(part, canvas)
    files.write(target, part.read_bytes())


def measure(context):
    """Draws what is not drawn yet; the key of a picture is what its command and its input are."""
    for item in chosen(context):
        for name, _, _, parts in pictures_of(context, item):
            target = context.figure_path(name, "png")
            made_from = digest(name, *(made.path.name for made in parts))
            if context.store.get("pictures", made_from) and target.is_file():
                continue
            context.progress(f"pictures: {name}")
            side_by_side(context, [context.make(made) for made in parts], target)
            context.store.add("pictures", made_from, {"picture": name}, "curlidar render",
                              [{"file": target.name}])


def tables(_context):
    return []


def figures(context):
    return [Figure(name, title, caption, "png", f"the coded file of {item.name}")
            for item in chosen(context)
            for name, title, caption, _ in pictures_of(context, item)]
