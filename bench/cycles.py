"""One scene, path traced by Blender's Cycles and by clipgs on the same cores: seconds to equal noise.

  blender -b --factory-startup --python-exit-code 1 --python bench/cycles.py -- \\
      VOLUME.nrrd PRESET.json CLIPGS [--hu SCALE,OFFSET] [--surface HU] [--as-scanned] [--out FOLDER]

Prints one row of a Markdown table. So that noise is compared with like noise, the scene is what both
can do: the preset's extinction with one colour, isotropic scattering without surfaces, and the keys
of the studio rig under an even sky; or with --surface the body above a value, opaque and of one
colour, as Lambert's law has it: of Blender a mesh of the isosurface, of clipgs the voxels
themselves. FOLDER keeps the pictures. Needs Debian's blender and python3-openvdb, whose
module Blender's Python finds.
"""
import argparse
import gzip
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import bpy
import mathutils
import numpy as np
import pyopenvdb

SIZE = 512
VERTICES = 4  # of a path
SKY = 0.28
ROOT = pathlib.Path(__file__).resolve().parent.parent


def linear_color(text):
    c = np.array([int(text[i:i + 2], 16) / 255 for i in (1, 3, 5)])
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def load_nrrd(path):
    """Values[x, y, z] with axes to the right, anterior and superior, spacing and the first voxel's place."""
    with open(path, "rb") as file:
        header, data = file.read().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
    vectors = [[float(x) for x in v.strip("()").split(",")] for v in fields["space directions"].split()]
    spacing = np.diag(vectors)
    if (fields["space"], fields["encoding"]) != ("left-posterior-superior", "gzip") or \
            not (np.array(vectors) == np.diag(spacing)).all() or spacing.min() <= 0:
        raise SystemExit("cycles: only gzipped NRRDs along the axes of LPS are read")
    sizes = [int(n) for n in fields["sizes"].split()]
    kind = {"uchar": "u1", "short": "<i2"}[fields["type"]]
    values = np.frombuffer(gzip.decompress(data), kind).reshape(sizes[::-1]).T[::-1, ::-1]
    origin = np.array([float(x) for x in fields["space origin"].strip("()").split(",")])
    last = origin + spacing * (np.array(sizes) - 1)
    return values.astype(np.float32), spacing, np.array([-last[0], -last[1], origin[2]])


def bounding_sphere(extinction, spacing, origin, most):
    """That of the visible matter, as clipgs frames it: cells of 8³ voxels, and groups of them above 1 %."""
    diagonal = np.linalg.norm(spacing * extinction.shape)
    visible = extinction >= min(0.05 * most, 10 / diagonal)
    # clipgs counts cells from the other end of x and y: there the flip of load_nrrd is undone.
    padded = np.pad(visible[::-1, ::-1], [(0, -n % 8) for n in visible.shape])
    a, b, c = (n // 8 for n in padded.shape)
    counts = padded.reshape(a, 8, b, 8, c, 8).sum(axis=(1, 3, 5))
    labels = np.where(counts >= 6, np.arange(1, counts.size + 1).reshape(counts.shape), 0)
    while True:  # the largest label goes from neighbour to neighbour
        spread = np.pad(labels, 1)
        for axis in range(3):
            spread = np.maximum(spread, np.maximum(np.roll(spread, 1, axis), np.roll(spread, -1, axis)))
        spread = np.where(labels > 0, spread[1:-1, 1:-1, 1:-1], 0)
        if (spread == labels).all():
            break
        labels = spread
    sizes = np.bincount(labels.ravel(), counts.ravel())
    sizes[0] = 0
    kept = (sizes >= 0.01 * sizes.sum())[labels] & (labels > 0)
    kept = kept.repeat(8, 0).repeat(8, 1).repeat(8, 2) & padded
    x, y = (kept.any(axis=2)).nonzero()
    rows = kept[x, y]
    z = np.concatenate([rows.argmax(1), rows.shape[1] - 1 - rows[:, ::-1].argmax(1)])
    index = np.stack([visible.shape[0] - 1 - np.tile(x, 2), visible.shape[1] - 1 - np.tile(y, 2), z], 1)
    points = origin + spacing * index
    center = (points.min(0) + points.max(0)) / 2
    for i in range(1, 201):
        center = center + (points[((points - center) ** 2).sum(1).argmax()] - center) / (i + 1)
    return center, math.sqrt(((points - center) ** 2).sum(1).max())


def new_material(shader_name, socket):
    material = bpy.data.materials.new("matter")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    shader = nodes.new(shader_name)
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(shader.outputs[0], output.inputs[socket])
    return material, shader


def volume_matter(extinction, spacing, origin, color, folder):
    grid = pyopenvdb.FloatGrid()
    grid.name = "density"
    grid.copyFromArray(extinction)
    # Cycles puts a voxel's value half a voxel above its index.
    grid.transform = transform_of(spacing, origin - spacing / 2)
    pyopenvdb.write(str(folder / "density.vdb"), grids=[grid])
    volume = bpy.data.volumes.new("matter")
    volume.filepath = str(folder / "density.vdb")
    material, shader = new_material("ShaderNodeVolumePrincipled", "Volume")
    # With black absorption the principled volume has the extinction `density` and the albedo `color`.
    shader.inputs["Color"].default_value = (*color, 1)
    shader.inputs["Density"].default_value = 1
    volume.materials.append(material)
    return volume


def surface_matter(values, isovalue, spacing, origin, color):
    grid = pyopenvdb.FloatGrid(float(values.min()))
    grid.copyFromArray(np.ascontiguousarray(values))
    grid.transform = transform_of(spacing, origin)
    points, quads = grid.convertToQuads(isovalue)
    mesh = bpy.data.meshes.new("matter")
    mesh.from_pydata(points.tolist(), [], quads.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    material, shader = new_material("ShaderNodeBsdfDiffuse", "Surface")
    shader.inputs["Color"].default_value = (*color, 1)
    mesh.materials.append(material)
    return mesh


def transform_of(spacing, origin):
    matrix = np.diag([*spacing, 1.0])
    matrix[3, :3] = origin
    return pyopenvdb.createLinearTransform(matrix.tolist())


def make_scene(matter, keys, center, radius):
    """The matter, the lights and the camera (30° from the front, 15° up), in millimetres."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene = bpy.context.scene

    def add(name, data):
        thing = bpy.data.objects.new(name, data)
        scene.collection.objects.link(thing)
        return thing

    add("matter", matter)

    for key in keys:
        sun = bpy.data.lights.new("key", "SUN")
        angle = math.radians(key["angular_radius_deg"])
        sun.angle = 2 * angle
        sun.color = linear_color(key["color"])
        # clipgs: a surface facing the lamp gets π times its intensity.
        sun.energy = math.pi * key["intensity"] / (1 - 0.5 * (1 - math.cos(angle)))
        lamp = add("key", sun)
        lamp.rotation_mode = "QUATERNION"
        lamp.rotation_quaternion = mathutils.Vector(key["direction"]).to_track_quat("Z", "Y")
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (SKY, SKY, SKY, 1)
    scene.world = world

    camera = add("camera", bpy.data.cameras.new("camera"))
    fov = math.radians(40)
    distance = radius / math.sin(math.atan(0.9 * math.tan(fov / 2)))
    az, el = math.radians(30), math.radians(15)
    direction = mathutils.Vector((-math.sin(az) * math.cos(el), math.cos(az) * math.cos(el), math.sin(el)))
    camera.data.angle = fov
    camera.data.clip_end = 4 * distance
    camera.location = mathutils.Vector(center) + distance * direction
    camera.rotation_mode = "QUATERNION"
    camera.rotation_quaternion = direction.to_track_quat("Z", "Y")
    scene.camera = camera


def set_up_cycles():
    scene = bpy.context.scene
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x = render.resolution_y = SIZE
    render.resolution_percentage = 100
    render.film_transparent = True
    render.threads_mode = "FIXED"
    render.threads = os.cpu_count()
    render.use_persistent_data = True  # what is prepared once is not counted again
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.image_settings.color_mode = "RGBA"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False  # gains nothing here: no pixel of matter ends early
    cycles.pixel_filter_type = "BOX"  # as clipgs
    cycles.max_bounces = VERTICES - 1
    cycles.volume_bounces = VERTICES - 1  # after the first vertex
    cycles.diffuse_bounces = VERTICES - 1
    cycles.volume_step_rate = 1
    cycles.volume_max_steps = 1024
    cycles.sample_clamp_indirect = 0


def load_pixels(path, linear):
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Linear" if linear else "Non-Color"
    pixels = np.array(image.pixels[:], np.float32).reshape(SIZE, SIZE, image.channels)
    bpy.data.images.remove(image)
    return pixels


def display(rgba):
    """Over black: alpha times the sRGB of the straight colour."""
    alpha = rgba[..., 3:]
    c = np.clip(np.divide(rgba[..., :3], alpha, out=np.zeros_like(rgba[..., :3]), where=alpha > 0), 0, 1)
    return alpha * np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)


def decibels(a, b, scale=1.0):
    return -10 * math.log10(scale * float(((a - b) ** 2).mean()))


def cycles_half(samples, seed, folder):
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.cycles.seed = seed
    scene.render.filepath = str(folder / "half.exr")
    begin = time.monotonic()
    bpy.ops.render.render()
    seconds = time.monotonic() - begin
    bpy.data.images["Render Result"].save_render(scene.render.filepath)
    return seconds, display(load_pixels(scene.render.filepath, True))


def main():
    parser = argparse.ArgumentParser(prog="cycles.py")
    parser.add_argument("volume")
    parser.add_argument("preset")
    parser.add_argument("clipgs")
    parser.add_argument("--hu", help="SCALE,OFFSET")
    parser.add_argument("--surface", type=float, help="value above which all is opaque")
    parser.add_argument("--as-scanned", action="store_true", help="clipgs traces no finer voxels")
    parser.add_argument("--noise-db", type=float, default=35)
    parser.add_argument("--spp", default="4,8,16", help="samples a pixel in each half, ascending")
    parser.add_argument("--out")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    folder = pathlib.Path(arguments.out or tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)

    preset = json.loads(pathlib.Path(arguments.preset).read_text())
    rig = json.loads((ROOT / "presets/rigs/studio.json").read_text())
    color = preset["points"][2]["color"]
    preset |= {"surface_strength": 0, "phase_g": 0}
    preset.pop("gradient_opacity", None)
    preset.pop("boundary", None)
    if arguments.surface is not None:
        preset |= {"title": f"Opaque from {arguments.surface:g} HU on" + (", as scanned" if arguments.as_scanned else ""), "surface_strength": 1e6}
        # Within a hundredth of a millimetre of where bone or skin begins.
        preset["points"] = [{"value": arguments.surface, "extinction": 0},
                            {"value": arguments.surface + 2, "extinction": 100}]
    preset["points"] = [{"value": p["value"], "color": color, "extinction": p["extinction"]}
                        for p in preset["points"]]
    rig["sky"] = {part: {"color": "#ffffff", "intensity": SKY} for part in rig["sky"]}
    (folder / "preset.json").write_text(json.dumps(preset))
    (folder / "rig.json").write_text(json.dumps(rig))

    values, spacing, origin = load_nrrd(arguments.volume)
    if arguments.hu:
        scale, offset = (float(x) for x in arguments.hu.split(","))
        values = scale * values + offset
    knots = np.array([(p["value"], p["extinction"]) for p in preset["points"]])
    extinction = np.interp(values, knots[:, 0], knots[:, 1]).astype(np.float32)
    center, radius = bounding_sphere(extinction, spacing, origin, knots[:, 1].max())
    if arguments.surface is None:
        matter = volume_matter(extinction, spacing, origin, linear_color(color), folder)
    else:
        matter = surface_matter(values, arguments.surface, spacing, origin, linear_color(color))
    make_scene(matter, rig["keys"], center, radius)
    set_up_cycles()

    def draw_ours():
        command = [arguments.clipgs, "--quiet", "cinema", arguments.volume, "--keep-table",
                   "--preset", str(folder / "preset.json"), "--rig", str(folder / "rig.json"),
                   "--bounces", str(VERTICES), "--size", f"{SIZE}x{SIZE}", "--spp", "65536",
                   "--noise-db", str(arguments.noise_db), "--background", "0,0,0", "--bits", "16",
                   "-o", str(folder / "clipgs.png"), "--json"]
        command += ["--hu", arguments.hu] if arguments.hu else []
        command += ["--as-scanned"] if arguments.as_scanned else []
        return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)

    cycles_half(1, 0, folder)  # prepares the volume
    # In turns, so that both meet the same machine.
    curve = []
    turns = []
    for samples in (int(n) for n in arguments.spp.split(",")):
        time_a, a = cycles_half(samples, 1, folder)
        time_b, b = cycles_half(samples, 2, folder)
        curve.append((decibels(a, b, 0.25), time_a + time_b))
        figures = draw_ours()
        turns.append(figures["seconds"])
        print(f"cycles: {2 * samples} samples a pixel, {curve[-1][1]:.2f} s, {curve[-1][0]:.2f} dB; "
              f"clipgs: {figures['samples'] / SIZE ** 2:.1f}, {figures['seconds']:.2f} s, "
              f"{figures['noise_db']:.2f} dB", file=sys.stderr)
    # Cycles at the noise that clipgs reached, on straight lines of the logarithm of time over dB.
    noise = figures["noise_db"]
    if not curve[0][0] <= noise <= curve[-1][0]:
        raise SystemExit(f"cycles: {noise:.1f} dB are not between those of --spp {arguments.spp}")
    decibel, seconds = zip(*curve)
    theirs = math.exp(np.interp(noise, decibel, np.log(seconds)))
    ours = sorted(turns)[len(turns) // 2]

    mean = (a + b) / 2
    picture = bpy.data.images.new("cycles", SIZE, SIZE)
    picture.colorspace_settings.name = "Non-Color"
    picture.pixels = np.dstack([mean, np.ones((SIZE, SIZE), np.float32)]).ravel().tolist()
    picture.filepath_raw = str(folder / "cycles.png")
    picture.file_format = "PNG"
    picture.save()
    alike = decibels(mean, load_pixels(folder / "clipgs.png", False)[..., :3])
    print(f"| {preset['title']} | {noise:.1f} | {theirs:.1f} | {ours:.2f} | {theirs / ours:.0f} × | {alike:.1f} |")


main()
