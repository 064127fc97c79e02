#!/usr/bin/env python3
"""Draws README's picture: the surface group of meshes side by side.

usage: docs/draw_mesh.py MESH... PICTURE.png      (needs meshio, NumPy and Matplotlib)
"""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection


def surface_triangles(path):
    """Corner positions of the triangles in the group "surface", n by 3 by 3."""
    mesh = meshio.read(path)
    number = mesh.field_data["surface"][0]
    corners = [
        block.data[groups == number]
        for block, groups in zip(mesh.cells, mesh.cell_data["gmsh:physical"])
        if block.type == "triangle"
    ]
    return mesh.points[np.concatenate(corners)]


def draw(axes, triangles):
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    light = np.array([0.3, -0.7, 0.65])
    shade = 0.35 + 0.65 * np.clip(normals @ (light / np.linalg.norm(light)), 0, 1)
    gold = np.array([1.0, 0.80, 0.36])
    axes.add_collection3d(
        Poly3DCollection(triangles, facecolors=shade[:, None] * gold, edgecolors=(0, 0, 0, 0.25), linewidths=0.2)
    )
    size = 0.72 * np.abs(triangles).max()
    axes.set(xlim=(-size, size), ylim=(-size, size), zlim=(-size, size), box_aspect=(1, 1, 1))
    axes.view_init(elev=18, azim=-60)
    axes.set_axis_off()


def main(meshes, picture):
    figure = plt.figure(figsize=(4 * len(meshes), 4))
    for place, path in enumerate(meshes, start=1):
        draw(figure.add_subplot(1, len(meshes), place, projection="3d"), surface_triangles(path))
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    main(sys.argv[1:-1], sys.argv[-1])
