# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Pictures of triangulated surfaces: a depth buffer, smooth shading, a colour for each number on the surface. NumPy alone."""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

from keepout import Array

SAMPLES = 2
"""Samples of a pixel along each axis."""


class Surface(NamedTuple):
    """What is drawn."""

    vertices: Array
    """[n, 3]"""
    triangles: Array
    """[m, 3], indices of vertices"""
    normals: Array
    """[n, 3], of length 1, out of the solid"""
    numbers: Array
    """[n], coloured by `colours`"""
    colours: Callable[[Array], Array]
    """Colours [k, 3] in [0, 1] of numbers [k]."""


class View(NamedTuple):
    """How it is looked at: orthographically, with y up in the picture."""

    axes: Array
    """[3, 3]: rows to the right, up, towards the eye; orthonormal"""
    centre: Array
    """[3], in the middle of the picture"""
    half: float
    """Length from the middle of the picture to its border"""
    pixels: int
    """Width and height of the picture"""


def turned(around: float, above: float) -> Array:
    """The axes of a view from `around` degrees to the right of the z axis and `above` degrees above the plane of x and z."""
    a, b = np.radians((around, above))
    eye = np.array((np.sin(a) * np.cos(b), np.sin(b), np.cos(a) * np.cos(b)))
    right = np.array((np.cos(a), 0, -np.sin(a)))
    return np.array((right, np.cross(eye, right), eye))


def draw(surfaces: list[Surface], view: View) -> Array:
    """The picture [pixels, pixels, 4]: red, green, blue and coverage in [0, 1], from the top down."""
    size = SAMPLES * view.pixels
    depths = np.full(size * size, -np.inf)
    colours = np.zeros((size * size, 4))
    for surface in surfaces:
        pixels, triangles, weights, depth = _nearest(surface, view, size)
        wins = depth > depths[pixels]
        pixels, triangles, weights = pixels[wins], triangles[wins], weights[wins]
        depths[pixels] = depth[wins]
        corners = surface.triangles[triangles]
        normals = np.einsum("ij,ijk->ik", weights, surface.normals[corners]) @ view.axes.T
        plain = surface.colours(np.einsum("ij,ij->i", weights, surface.numbers[corners]))
        colours[pixels] = np.column_stack((_lit(plain, normals), np.ones(len(pixels))))
    blocks = colours.reshape(view.pixels, SAMPLES, view.pixels, SAMPLES, 4).mean(axis=(1, 3))
    blocks[..., :3] /= np.maximum(blocks[..., 3:], 1e-9)
    return blocks


def _lit(colours: Array, normals: Array) -> Array:
    """Lambert's law: a lamp at the upper left before the surface, a weaker one at the right, and light from everywhere."""
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    normals *= np.where(normals[:, 2:] < 0, -1, 1)
    key, fill = np.array((-0.45, 0.65, 0.61)), np.array((0.8, 0.1, 0.59))
    light = 0.42 + 0.6 * np.maximum(normals @ key, 0) + 0.18 * np.maximum(normals @ fill, 0)
    return np.clip(colours * light[:, None], 0, 1)


def _nearest(surface: Surface, view: View, size: int) -> tuple[Array, Array, Array, Array]:
    """Of each pixel that a triangle covers: its index, the triangle nearest to the eye, barycentric weights there, the depth."""
    seen = (surface.vertices - view.centre) @ view.axes.T / view.half
    places = np.stack(((1 + seen[:, 0]) * size / 2 - 0.5, (1 - seen[:, 1]) * size / 2 - 0.5), axis=1)
    corners = places[surface.triangles]
    first = np.maximum(np.ceil(corners.min(axis=1)), 0).astype(int)
    last = np.minimum(np.floor(corners.max(axis=1)), size - 1).astype(int)
    width = (last - first).max(axis=1) + 1
    found = []
    # Triangles by the size of their boxes, so that those of a kind are cut into pixels at once.
    side = 1
    while side < 2 * size:
        kind = np.flatnonzero((width > side // 2) & (width <= side) & (last >= first).all(axis=1))
        for some in np.array_split(kind, len(kind) * side * side // 2_000_000 + 1):
            found.append(_covered(corners, first, last, some, side))
        side *= 2
    columns, rows, triangles, weights = (np.concatenate(parts) for parts in zip(*found))
    depth = np.einsum("ij,ij->i", weights, seen[:, 2][surface.triangles[triangles]])
    order = np.argsort(depth, kind="stable")
    # The last write to a pixel stays: that of the nearest triangle.
    winners = np.full(size * size, -1)
    winners[(rows * size + columns)[order]] = order
    winners = winners[winners >= 0]
    return (rows * size + columns)[winners], triangles[winners], weights[winners], depth[winners]


def _covered(corners: Array, first: Array, last: Array, some: Array, side: int) -> tuple[Array, Array, Array, Array]:
    """Pixels, column and row, that `some` triangles cover, with the triangle and the barycentric weights of each."""
    steps = np.arange(side)
    columns = (first[some, 0, None, None] + steps[None, None, :]) + np.zeros((1, side, 1), dtype=int)
    rows = (first[some, 1, None, None] + steps[None, :, None]) + np.zeros((1, 1, side), dtype=int)
    a, b, c = (corners[some, i][:, None, None, :] for i in range(3))
    point = np.stack((columns, rows), axis=-1)

    def cross(p: Array, q: Array) -> Array:
        return p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]

    whole = cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = np.stack((cross(b - point, c - point), cross(c - point, a - point), cross(a - point, b - point)), -1)
        weights = weights / whole[..., None]
    # A little over the edges, so that no line of pixels between two triangles stays empty.
    covered = (weights >= -1e-9).all(axis=-1) & (columns <= last[some, 0, None, None]) & (rows <= last[some, 1, None, None])
    which = np.broadcast_to(some[:, None, None], covered.shape)
    return columns[covered], rows[covered], which[covered], weights[covered]
