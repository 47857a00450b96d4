# SPDX-License-Identifier: Apache-2.0 OR MIT
"""Keepout for Python: ctypes and NumPy over libkeepout, without a build step. keepout.h documents what the calls promise.

    field = keepout.Field.fit(keepout.Mesh.read("part.stl").sample(25000, seed=1))
    values, gradients = field.eval(points, derivatives=1)

Arrays. Points are [n, dim] of float64; one point may come as [dim]. What is C-contiguous, aligned float64 is handed over as it is, all
else is copied first; complex numbers and masked entries are refused. eval_into, values_into and their like write to arrays of the
caller's. Hessians are packed, [n, dim (dim + 1) / 2]; unpack_hessians makes matrices.
Handles. Mesh, Cloud, Field, Sensitivity, Body, Constraints, Explicit, Motion, Part, Pair and Assembly free what they hold with the last
reference to them, at the end of a `with` block, or by free(). close() does the same, but of a Pair and an Assembly, where it is closure.
Errors. A call that fails raises Error, with the library's message and its status.
Threads. As in C; ctypes lets other Python threads run during each call, so they may evaluate one field at once.
The library is the file $KEEPOUT_LIBRARY, else one beside this file, in a build tree above it or installed with it,
else where the system finds it.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import enum
import operator
import os
import pathlib
import weakref
from ctypes import POINTER, c_char_p, c_double, c_int32, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from typing import Any, Callable, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Progress = Callable[[float, str], Any]
"""Told of the fraction done, in [0, 1], and the stage. False cancels the call, any other answer goes on; an exception comes out of it."""

ABI_VERSION = 0


class Status(enum.IntEnum):
    """What calls of C return: 0, errors below it, successes with a remark above it."""

    OK = 0
    OPEN_AT_BOX = 1
    BUDGET_REACHED = 2
    SIDE_NOT_CERTIFIED = 3
    NEVER_MEET = 4
    INVALID_ARGUMENT = -1
    OUT_OF_MEMORY = -2
    IO = -3
    FORMAT = -4
    UNSUPPORTED = -5
    DEGENERATE = -6
    NOT_CONVERGED = -7
    CANCELLED = -8
    INTERNAL = -9


class Capability(enum.IntFlag):
    """Bits of capabilities()."""

    SPACE = 1
    GZIP = 2
    PLANE = 4


class Point(enum.IntFlag):
    """Bits of a point's flags: what Cloud.estimate_normals found of it."""

    COPY = 1
    OUTLIER = 2
    DEGENERATE = 4
    DOUBTFUL = 8


class Feasible(enum.IntEnum):
    """Where phi > 0."""

    OUTSIDE = 0
    INSIDE = 1


class Reweight(enum.IntEnum):
    """What the rounds of reweighting are for."""

    LARGEST = 0
    ROBUST = 1
    KEEP = 2


class Aggregate(enum.IntEnum):
    """How values of samples become one."""

    NONE = 0
    KS = 1
    INDUCED_EXPONENTIAL = 2
    P_NORM = 3
    MINIMUM = 4


class Side(enum.IntEnum):
    """The side of the least value on which an aggregate lies for certain: BELOW is the safe one."""

    BELOW = 0
    ABOVE = 1


class Extreme(enum.IntEnum):
    """Which end of the values is aggregated."""

    LEAST = 0
    LARGEST = 1


class Rotation(enum.IntEnum):
    """How a frame is turned, and by how many parameters: 0, 4, 3, 1."""

    NONE = 0
    QUATERNION = 1
    VECTOR = 2
    ANGLE = 3


class Scale(enum.IntEnum):
    """Whether a frame is scaled, by one parameter."""

    ONE = 0
    FREE = 1


WORLD = 0
"""The frame of all constraints that does not move."""


class Formulation(enum.IntEnum):
    """Formulas of an Explicit, told at KO_EXPLICIT_."""

    HICKEN_KAUR_LINEAR = 0
    HICKEN_KAUR_QUADRATIC = 1
    LIN = 2
    NEAREST_PLANE = 3
    NEAREST_POINT = 4


class Cell(enum.IntEnum):
    """What a part may do with a cell."""

    FORBIDDEN = 0
    FREE = 1
    FROZEN = 2


class Within(enum.IntEnum):
    """Where the mesh of a part may be, told at KO_WITHIN_."""

    CELLS = 0
    ANYWHERE = 1


class Conflicts(enum.IntEnum):
    """Which conflict graph a Pair has, told at KO_CONFLICTS_."""

    OF_OVERLAP = 0
    OF_MEASURE = 1
    NONE = 2


class Rule(enum.IntEnum):
    """What a part has to do with a body's cells."""

    AVOID = 0
    STAY_IN = 1


class Change(enum.IntEnum):
    """What is done with a cell: it is put to a part, or taken from it."""

    PUT = 0
    TAKE = 1


class Polylines(enum.IntEnum):
    """Whether polylines go back to their first points."""

    OPEN = 0
    CLOSED = 1


class Error(RuntimeError):
    """A call that failed: its message says what was wrong, where, and what would be right; `status` is one of Status, or a plain
    int where the library is newer than this module and has more of them."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        try:
            self.status: int = Status(status)
        except ValueError:
            self.status = int(status)

    def __reduce__(self) -> Any:
        return type(self), (int(self.status), str(self))


ko_progress = ctypes.CFUNCTYPE(c_int32, c_double, c_char_p, c_void_p)
ko_pose_function = ctypes.CFUNCTYPE(c_int32, c_double, POINTER(c_double), POINTER(c_double), c_void_p)


class ko_mesh(ctypes.Structure):
    """Opaque."""


class ko_cloud(ctypes.Structure):
    """Opaque."""


class ko_field(ctypes.Structure):
    """Opaque."""


class ko_sensitivity(ctypes.Structure):
    """Opaque."""


class ko_body(ctypes.Structure):
    """Opaque."""


class ko_constraints(ctypes.Structure):
    """Opaque."""


class ko_explicit(ctypes.Structure):
    """Opaque."""


class ko_motion(ctypes.Structure):
    """Opaque."""


class ko_part(ctypes.Structure):
    """Opaque."""


class ko_pair(ctypes.Structure):
    """Opaque."""


class ko_assembly(ctypes.Structure):
    """Opaque."""


class _Struct(ctypes.Structure):
    """A struct of C whose fields show in its repr, arrays as tuples."""

    def __repr__(self) -> str:
        def show(name: str) -> str:
            value = getattr(self, name)
            return f"{name}={tuple(value) if isinstance(value, ctypes.Array) else value}"

        return f"{type(self).__name__}({', '.join(show(field[0]) for field in self._fields_)})"


class ko_mesh_report(_Struct):
    """What can be said of a mesh."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("n_vertices", c_uint64),
        ("n_triangles", c_uint64),
        ("n_components", c_uint64),
        ("n_boundary_edges", c_uint64),
        ("n_non_manifold_edges", c_uint64),
        ("n_non_manifold_vertices", c_uint64),
        ("n_degenerate", c_uint64),
        ("n_duplicate", c_uint64),
        ("n_unreferenced", c_uint64),
        ("closed", c_int32),
        ("oriented", c_int32),
        ("manifold", c_int32),
        ("inside_out", c_int32),
        ("bounds_min", c_double * 3),
        ("bounds_max", c_double * 3),
        ("area", c_double),
        ("volume", c_double),
    ]


class ko_normal_options(_Struct):
    """Options of Cloud.estimate_normals; see NormalOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("neighbours", c_uint32),
        ("n_threads", c_uint32),
        ("outlier_factor", c_double),
        ("memory_limit", c_uint64),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_normal_report(_Struct):
    """What an estimate of normals found."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("n_components", c_uint64),
        ("n_copies", c_uint64),
        ("n_outliers", c_uint64),
        ("n_degenerate", c_uint64),
        ("n_doubtful", c_uint64),
        ("agreement", c_double),
        ("seconds", c_double),
    ]


class ko_smooth_options(_Struct):
    """Options of Cloud.smooth; see SmoothOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("neighbours", c_uint32),
        ("rounds", c_uint32),
        ("n_threads", c_uint32),
        ("reserved", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_fit_options(_Struct):
    """Options of Field.fit; see FitOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("control_points", c_uint32 * 3),
        ("reweightings", c_uint32),
        ("margin", c_double),
        ("lambda_normal", c_double),
        ("lambda_smooth", c_double),
        ("distance_weight", c_double),
        ("tolerance", c_double),
        ("feasible", c_int32),
        ("max_iterations", c_uint32),
        ("memory_limit", c_uint64),
        ("n_threads", c_uint32),
        ("reserved", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
        ("reweighting", c_int32),
        ("reserved_2", c_uint32),
        ("max_error", c_double),
        ("max_unknowns", c_uint64),
    ]


class ko_fit_report(_Struct):
    """What a field is and what its fit did."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("dim", c_uint32),
        ("feasible", c_int32),
        ("control_points", c_uint32 * 3),
        ("iterations", c_uint32),
        ("n_unknowns", c_uint64),
        ("n_points", c_uint64),
        ("bytes", c_uint64),
        ("box_min", c_double * 3),
        ("box_max", c_double * 3),
        ("diagonal", c_double),
        ("residual", c_double),
        ("seconds_assembly", c_double),
        ("seconds_solve", c_double),
        ("seconds_check", c_double),
        ("rms", c_double),
        ("max", c_double),
        ("mean_gradient", c_double),
        ("n_outliers", c_uint64),
        ("clear_sides", c_double),
        ("convergence_rate", c_double),
        ("n_levels", c_uint64),
    ]


class ko_level_set_options(_Struct):
    """Options of Field.level_set; see LevelSetOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("subdivisions", c_uint32),
        ("n_threads", c_uint32),
        ("shortest_edge", c_double),
        ("relaxations", c_uint32),
        ("reserved", c_uint32),
        ("memory_limit", c_uint64),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_certify_options(_Struct):
    """Options of Field.certify; see CertifyOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("tolerance", c_double),
        ("max_boxes", c_uint64),
        ("n_threads", c_uint32),
        ("reserved", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_certificate(_Struct):
    """What was certified of a field."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("threshold", c_double),
        ("largest_found", c_double),
        ("place", c_double * 3),
        ("surface_error", c_double),
        ("steepest", c_double),
        ("steepest_beyond", c_double),
        ("n_boxes", c_uint64),
        ("n_components", c_uint64),
        ("side_certified", c_int32),
        ("budget_reached", c_int32),
    ]


class ko_aggregation(_Struct):
    """How values of samples become one; see Aggregation."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("sharpness", c_double),
        ("kind", c_int32),
        ("side", c_int32),
    ]


class ko_explicit_options(_Struct):
    """Options of Explicit.create; see ExplicitOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("smoothing", c_double),
        ("softening", c_double),
        ("formulation", c_int32),
        ("n_nearest", c_uint32),
        ("exponent", c_uint32),
        ("feasible", c_int32),
    ]


class ko_separation(_Struct):
    """How two triangulations lie to each other."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("minimum_distance", c_double),
        ("intersection_length", c_double),
        ("distance_by_translation", c_double * 3),
        ("length_by_translation", c_double * 3),
        ("b_in_a", c_int32),
        ("a_in_b", c_int32),
    ]


class ko_law(_Struct):
    """How far along its way a motion is; see Law."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("offset", c_double),
        ("slope", c_double),
        ("waves", POINTER(c_double)),
        ("n_waves", c_size_t),
    ]


class ko_pair_options(_Struct):
    """Options of Pair.create, Part.sweep and Part.unsweep; see PairOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("slack", c_double),
        ("n_steps", c_uint64),
        ("measure_steps", c_uint64),
        ("clearance", c_double),
        ("max_bytes", c_uint64),
        ("conflicts", c_int32),
        ("n_threads", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_family_options(_Struct):
    """Options of Pair.cut and Pair.family; see FamilyOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("gap", c_double),
        ("symmetries", POINTER(c_double)),
        ("n_symmetries", c_size_t),
        ("symmetry_excess", c_double),
        ("n_threads", c_uint32),
        ("reserved", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_optimise_options(_Struct):
    """Options of Pair.optimise; see OptimiseOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("gamma", c_double),
        ("tolerance", c_double),
        ("feasibility", c_double),
        ("max_iterations", c_uint32),
        ("close_from", c_uint32),
        ("n_threads", c_uint32),
        ("reserved", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_persistence_options(_Struct):
    """Options of Pair.more_persistent; see PersistenceOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("scale", c_double),
        ("gammas", c_double * 2),
        ("n_times", c_uint64),
        ("max_tries", c_uint64),
        ("n_threads", c_uint32),
        ("reserved", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_pair_report(_Struct):
    """What a pair is."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("n_cells", c_uint64 * 2),
        ("n_colliding", c_uint64 * 2),
        ("n_edges", c_uint64),
        ("graph_bytes", c_uint64),
        ("measure_steps", c_uint64),
        ("n_visits", c_uint64),
        ("measure_bytes", c_uint64),
        ("dim", c_uint32),
        ("has_graph", c_int32),
    ]


class ko_optimise_report(_Struct):
    """What an optimisation found."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("gamma", c_double),
        ("volumes", c_double * 2),
        ("measures", c_double * 2),
        ("change", c_double),
        ("n_iterations", c_uint32),
        ("converged", c_int32),
    ]


class ko_arrange_options(_Struct):
    """Options of Assembly.arrange; see ArrangeOptions."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("max_rounds", c_uint32),
        ("max_starts", c_uint32),
        ("progress", ko_progress),
        ("progress_data", c_void_p),
    ]


class ko_assembly_report(_Struct):
    """What an assembly is."""

    _fields_ = [
        ("struct_size", c_size_t),
        ("n_cells", c_uint64),
        ("n_meetings", c_uint64),
        ("n_edges", c_uint64),
        ("graph_bytes", c_uint64),
        ("n_parts", c_uint32),
        ("dim", c_uint32),
    ]


# ---- The library


def _candidates() -> list[str]:
    """Where libkeepout may be, the likeliest first."""
    here = pathlib.Path(__file__).resolve().parent
    built = [here / "libkeepout.so"]
    root = here.parent.parent
    if (root / "include/keepout.h").exists():
        built += [root / "build/lib/libkeepout.so", *sorted(root.glob("build/*/lib/libkeepout.so"))]
        built += [root / "target/cmake/lib/libkeepout.so", root / "target/release/libkeepout.so"]
    if here.parts[-3:] == ("share", "keepout", "python"):  # where `cmake --install` puts this file
        prefix, file = here.parents[2], f"libkeepout.so.{ABI_VERSION}"
        built += [*sorted(prefix.glob(f"lib*/{file}")), *sorted(prefix.glob(f"lib/*/{file}"))]
    found = ctypes.util.find_library("keepout")
    return [str(path) for path in built if path.exists()] + ([found] if found else [])


def _load() -> ctypes.CDLL:
    named = os.environ.get("KEEPOUT_LIBRARY")
    paths = [named] if named else _candidates()
    if not paths:
        raise ImportError("there is no libkeepout here: build it, or set KEEPOUT_LIBRARY to its file")
    return ctypes.CDLL(paths[0])


_library = _load()
_mesh = POINTER(ko_mesh)
_cloud = POINTER(ko_cloud)
_field = POINTER(ko_field)
_sensitivity = POINTER(ko_sensitivity)
_body = POINTER(ko_body)
_constraints = POINTER(ko_constraints)
_explicit = POINTER(ko_explicit)
_motion = POINTER(ko_motion)
_part = POINTER(ko_part)
_pair = POINTER(ko_pair)
_assembly = POINTER(ko_assembly)
_doubles = POINTER(c_double)
_indices = POINTER(c_uint32)


def _bind(name: str, returns: Any, *takes: Any) -> Any:
    try:
        function = getattr(_library, name)
    except AttributeError:
        raise ImportError(f"{_library._name}, libkeepout {version()}, is too old for this module: it has no {name}") from None
    function.restype = returns
    function.argtypes = takes
    return function


def version() -> str:
    """Version of the library, "major.minor.patch"."""
    return _version().decode()


def abi_version() -> int:
    """Version of the ABI of the library; ABI_VERSION is that of this module."""
    return _abi_version()


_version = _bind("ko_version", c_char_p)
_abi_version = _bind("ko_abi_version", c_uint32)
if abi_version() != ABI_VERSION:
    raise ImportError(f"{_library._name} has ABI {abi_version()}; this module needs {ABI_VERSION}")

_last_error = _bind("ko_last_error", c_char_p)
_status_string = _bind("ko_status_string", c_char_p, c_int32)
_capabilities = _bind("ko_capabilities", c_uint64)

_mesh_read = _bind("ko_mesh_read", c_int32, c_char_p, POINTER(_mesh))
_mesh_write = _bind("ko_mesh_write", c_int32, _mesh, c_char_p)
_mesh_from_triangles = _bind("ko_mesh_from_triangles", c_int32, _doubles, c_size_t, _indices, c_size_t, POINTER(_mesh))
_mesh_from_polylines = _bind(
    "ko_mesh_from_polylines", c_int32, _doubles, c_size_t, POINTER(c_size_t), c_size_t, c_int32, POINTER(_mesh)
)
_mesh_free = _bind("ko_mesh_free", None, _mesh)
_mesh_get_dim = _bind("ko_mesh_get_dim", c_int32, _mesh, POINTER(c_uint32))
_mesh_get_size = _bind("ko_mesh_get_size", c_int32, _mesh, POINTER(c_size_t), POINTER(c_size_t))
_mesh_copy = _bind("ko_mesh_copy", c_int32, _mesh, c_size_t, c_size_t, _doubles, _indices)
_mesh_get_polylines_size = _bind("ko_mesh_get_polylines_size", c_int32, _mesh, POINTER(c_size_t), POINTER(c_size_t))
_mesh_copy_polylines = _bind(
    "ko_mesh_copy_polylines", c_int32, _mesh, c_size_t, c_size_t, _doubles, POINTER(c_size_t), POINTER(c_uint8)
)
_mesh_get_report = _bind("ko_mesh_get_report", c_int32, _mesh, c_size_t, POINTER(ko_mesh_report))
_mesh_flip = _bind("ko_mesh_flip", c_int32, _mesh)
_mesh_sample = _bind("ko_mesh_sample", c_int32, _mesh, c_size_t, c_uint64, POINTER(_cloud))
_mesh_signed_distance = _bind("ko_mesh_signed_distance", c_int32, _mesh, _doubles, c_size_t, _doubles)
_mesh_get_component_count = _bind("ko_mesh_get_component_count", c_int32, _mesh, POINTER(c_size_t))
_mesh_copy_component_points = _bind("ko_mesh_copy_component_points", c_int32, _mesh, c_size_t, _doubles)

_cloud_from_points = _bind("ko_cloud_from_points", c_int32, c_uint32, _doubles, _doubles, c_size_t, POINTER(_cloud))
_cloud_free = _bind("ko_cloud_free", None, _cloud)
_cloud_get_dim = _bind("ko_cloud_get_dim", c_int32, _cloud, POINTER(c_uint32))
_cloud_get_size = _bind("ko_cloud_get_size", c_int32, _cloud, POINTER(c_size_t))
_cloud_copy = _bind("ko_cloud_copy", c_int32, _cloud, c_size_t, _doubles, _doubles)
_cloud_set_weights = _bind("ko_cloud_set_weights", c_int32, _cloud, _doubles, c_size_t)
_cloud_sides = _bind("ko_cloud_sides", c_int32, _cloud, _doubles, c_size_t, _doubles)
_cloud_copy_origins = _bind("ko_cloud_copy_origins", c_int32, _cloud, c_size_t, _indices, _doubles)
_normal_options_init = _bind("ko_normal_options_init", c_int32, POINTER(ko_normal_options), c_size_t)
_cloud_estimate_normals = _bind(
    "ko_cloud_estimate_normals",
    c_int32,
    c_uint32,
    _doubles,
    c_size_t,
    POINTER(ko_normal_options),
    POINTER(_cloud),
    POINTER(c_uint8),
    c_size_t,
    POINTER(ko_normal_report),
)
_smooth_options_init = _bind("ko_smooth_options_init", c_int32, POINTER(ko_smooth_options), c_size_t)
_cloud_smooth = _bind("ko_cloud_smooth", c_int32, _cloud, POINTER(ko_smooth_options), POINTER(_cloud))

_fit_options_init = _bind("ko_fit_options_init", c_int32, POINTER(ko_fit_options), c_size_t)
_field_fit = _bind("ko_field_fit", c_int32, _cloud, POINTER(ko_fit_options), POINTER(_field))
_field_refit = _bind("ko_field_refit", c_int32, _field, _cloud, POINTER(ko_fit_options), POINTER(_field))
_field_from_control_points = _bind(
    "ko_field_from_control_points",
    c_int32,
    c_uint32,
    _indices,
    _doubles,
    _doubles,
    c_int32,
    c_double,
    _doubles,
    c_size_t,
    POINTER(_field),
)
_field_copy_control_points = _bind("ko_field_copy_control_points", c_int32, _field, c_size_t, _doubles)
_field_eval = _bind("ko_field_eval", c_int32, _field, _doubles, c_size_t, _doubles, _doubles, _doubles)
_field_eval_parallel = _bind(
    "ko_field_eval_parallel", c_int32, _field, _doubles, c_size_t, _doubles, _doubles, _doubles, c_uint32
)
_field_eval_lattice = _bind(
    "ko_field_eval_lattice", c_int32, _field, _doubles, _doubles, POINTER(c_size_t), c_uint32, _doubles, _doubles, c_uint32
)
_field_outside_box = _bind("ko_field_outside_box", c_int32, _field, _doubles, c_size_t, POINTER(c_uint8))
_field_get_report = _bind("ko_field_get_report", c_int32, _field, c_size_t, POINTER(ko_fit_report))
_field_save = _bind("ko_field_save", c_int32, _field, c_char_p)
_field_load = _bind("ko_field_load", c_int32, c_char_p, POINTER(_field))
_field_free = _bind("ko_field_free", None, _field)
_level_set_options_init = _bind("ko_level_set_options_init", c_int32, POINTER(ko_level_set_options), c_size_t)
_field_level_set = _bind("ko_field_level_set", c_int32, _field, c_double, POINTER(ko_level_set_options), POINTER(_mesh))
_certify_options_init = _bind("ko_certify_options_init", c_int32, POINTER(ko_certify_options), c_size_t)
_field_certify = _bind(
    "ko_field_certify",
    c_int32,
    _field,
    _mesh,
    c_double,
    c_double,
    POINTER(ko_certify_options),
    c_size_t,
    POINTER(ko_certificate),
)

_aggregation_init = _bind("ko_aggregation_init", c_int32, POINTER(ko_aggregation), c_size_t)
_aggregate = _bind(
    "ko_aggregate",
    c_int32,
    POINTER(ko_aggregation),
    c_int32,
    c_double,
    _doubles,
    c_size_t,
    POINTER(c_double),
    _doubles,
    _doubles,
)
_aggregation_bounds = _bind(
    "ko_aggregation_bounds", c_int32, POINTER(ko_aggregation), c_size_t, c_double, POINTER(c_double), POINTER(c_double)
)
_body_from_points = _bind("ko_body_from_points", c_int32, c_uint32, _doubles, c_size_t, c_double, POINTER(_body))
_body_from_mesh = _bind("ko_body_from_mesh", c_int32, _mesh, c_double, POINTER(_body))
_body_free = _bind("ko_body_free", None, _body)
_body_get_dim = _bind("ko_body_get_dim", c_int32, _body, POINTER(c_uint32))
_body_get_size = _bind("ko_body_get_size", c_int32, _body, POINTER(c_size_t))
_body_get_covering_radius = _bind("ko_body_get_covering_radius", c_int32, _body, POINTER(c_double))
_body_copy_points = _bind("ko_body_copy_points", c_int32, _body, c_size_t, _doubles)

_constraints_create = _bind("ko_constraints_create", c_int32, c_uint32, POINTER(_constraints))
_constraints_free = _bind("ko_constraints_free", None, _constraints)
_constraints_add_frame = _bind("ko_constraints_add_frame", c_int32, _constraints, c_int32, c_int32, POINTER(c_uint32))
_constraints_add_fixed_frame = _bind(
    "ko_constraints_add_fixed_frame", c_int32, _constraints, c_int32, c_int32, _doubles, c_size_t, POINTER(c_uint32)
)
_constraints_add_points = _bind("ko_constraints_add_points", c_int32, _constraints, c_size_t, POINTER(c_uint32))
_constraints_keep_body = _bind(
    "ko_constraints_keep_body",
    c_int32,
    _constraints,
    _body,
    c_uint32,
    _field,
    c_uint32,
    POINTER(ko_aggregation),
    POINTER(c_size_t),
)
_constraints_keep_points = _bind(
    "ko_constraints_keep_points",
    c_int32,
    _constraints,
    c_uint32,
    _field,
    c_uint32,
    POINTER(ko_aggregation),
    POINTER(c_size_t),
)
_constraints_keep_body_in_fields = _bind(
    "ko_constraints_keep_body_in_fields",
    c_int32,
    _constraints,
    _body,
    c_uint32,
    POINTER(_field),
    c_size_t,
    c_int32,
    POINTER(ko_aggregation),
    c_uint32,
    POINTER(ko_aggregation),
    POINTER(c_size_t),
)
_constraints_keep_points_in_fields = _bind(
    "ko_constraints_keep_points_in_fields",
    c_int32,
    _constraints,
    c_uint32,
    POINTER(_field),
    c_size_t,
    c_int32,
    POINTER(ko_aggregation),
    c_uint32,
    POINTER(ko_aggregation),
    POINTER(c_size_t),
)
_constraints_get_size = _bind(
    "ko_constraints_get_size",
    c_int32,
    _constraints,
    POINTER(c_size_t),
    POINTER(c_size_t),
    POINTER(c_size_t),
    POINTER(c_size_t),
)
_constraints_get_frame_variables = _bind(
    "ko_constraints_get_frame_variables", c_int32, _constraints, c_uint32, POINTER(c_size_t), POINTER(c_size_t)
)
_constraints_get_points_variables = _bind(
    "ko_constraints_get_points_variables", c_int32, _constraints, c_uint32, POINTER(c_size_t), POINTER(c_size_t)
)
_constraints_values = _bind("ko_constraints_values", c_int32, _constraints, _doubles, c_size_t, c_size_t, _doubles)
_constraints_jacobian_pattern = _bind(
    "ko_constraints_jacobian_pattern", c_int32, _constraints, c_size_t, POINTER(c_int32), POINTER(c_int32)
)
_constraints_jacobian = _bind("ko_constraints_jacobian", c_int32, _constraints, _doubles, c_size_t, c_size_t, _doubles)
_constraints_values_and_jacobian = _bind(
    "ko_constraints_values_and_jacobian",
    c_int32,
    _constraints,
    _doubles,
    c_size_t,
    c_size_t,
    _doubles,
    c_size_t,
    _doubles,
)
_constraints_dense_jacobian = _bind(
    "ko_constraints_dense_jacobian", c_int32, _constraints, _doubles, c_size_t, c_size_t, _doubles
)
_constraints_jacobian_times = _bind(
    "ko_constraints_jacobian_times", c_int32, _constraints, _doubles, _doubles, c_size_t, c_size_t, _doubles
)
_constraints_transposed_jacobian_times = _bind(
    "ko_constraints_transposed_jacobian_times", c_int32, _constraints, _doubles, c_size_t, _doubles, c_size_t, _doubles
)
_constraints_hessian_pattern = _bind(
    "ko_constraints_hessian_pattern", c_int32, _constraints, c_size_t, POINTER(c_int32), POINTER(c_int32)
)
_constraints_hessian = _bind(
    "ko_constraints_hessian", c_int32, _constraints, _doubles, c_size_t, _doubles, c_size_t, c_size_t, _doubles
)

_cloud_follow = _bind("ko_cloud_follow", c_int32, _cloud, _mesh, POINTER(_cloud))
_cloud_pull_back = _bind(
    "ko_cloud_pull_back", c_int32, _cloud, _mesh, _doubles, _doubles, c_size_t, c_size_t, _doubles
)
_sensitivity_create = _bind(
    "ko_sensitivity_create", c_int32, _field, _cloud, POINTER(ko_fit_options), POINTER(_sensitivity)
)
_sensitivity_solve = _bind(
    "ko_sensitivity_solve",
    c_int32,
    _sensitivity,
    _doubles,
    _doubles,
    c_size_t,
    POINTER(ko_fit_options),
    c_size_t,
    _doubles,
    _doubles,
)
_sensitivity_free = _bind("ko_sensitivity_free", None, _sensitivity)

_explicit_options_init = _bind("ko_explicit_options_init", c_int32, POINTER(ko_explicit_options), c_size_t)
_explicit_create = _bind("ko_explicit_create", c_int32, _cloud, POINTER(ko_explicit_options), POINTER(_explicit))
_explicit_free = _bind("ko_explicit_free", None, _explicit)
_explicit_get_smoothing = _bind("ko_explicit_get_smoothing", c_int32, _explicit, POINTER(c_double))
_explicit_eval = _bind("ko_explicit_eval", c_int32, _explicit, _doubles, c_size_t, _doubles, _doubles)
_meshes_separation = _bind(
    "ko_meshes_separation",
    c_int32,
    _mesh,
    _mesh,
    _doubles,
    c_double,
    c_size_t,
    c_size_t,
    POINTER(ko_separation),
    _doubles,
    _doubles,
)

_law_init = _bind("ko_law_init", c_int32, POINTER(ko_law), c_size_t)
_motion_fixed = _bind("ko_motion_fixed", c_int32, c_uint32, _doubles, _doubles, POINTER(_motion))
_motion_slide = _bind("ko_motion_slide", c_int32, c_uint32, _doubles, POINTER(ko_law), POINTER(_motion))
_motion_turn = _bind("ko_motion_turn", c_int32, _doubles, POINTER(ko_law), POINTER(_motion))
_motion_screw = _bind("ko_motion_screw", c_int32, _doubles, _doubles, c_double, POINTER(ko_law), POINTER(_motion))
_motion_sampled = _bind("ko_motion_sampled", c_int32, c_uint32, _doubles, _doubles, c_size_t, POINTER(_motion))
_motion_from_function = _bind(
    "ko_motion_from_function", c_int32, c_uint32, ko_pose_function, c_void_p, c_size_t, _part, c_double, POINTER(_motion)
)
_motion_gears = _bind("ko_motion_gears", c_int32, _doubles, c_double, c_double, POINTER(_motion), POINTER(_motion))
_motion_four_bar = _bind(
    "ko_motion_four_bar",
    c_int32,
    _doubles,
    _doubles,
    c_double,
    c_double,
    c_int32,
    c_size_t,
    POINTER(_motion),
    POINTER(_motion),
    POINTER(_motion),
)
_motion_product = _bind("ko_motion_product", c_int32, _motion, _motion, POINTER(_motion))
_motion_inverse = _bind("ko_motion_inverse", c_int32, _motion, POINTER(_motion))
_motion_free = _bind("ko_motion_free", None, _motion)
_motion_get_dim = _bind("ko_motion_get_dim", c_int32, _motion, POINTER(c_uint32))
_motion_eval = _bind("ko_motion_eval", c_int32, _motion, _doubles, c_size_t, _doubles, _doubles)
_part_create = _bind(
    "ko_part_create", c_int32, c_uint32, _doubles, c_double, POINTER(c_size_t), POINTER(c_uint8), c_size_t, POINTER(_part)
)
_part_free = _bind("ko_part_free", None, _part)
_part_get_size = _bind("ko_part_get_size", c_int32, _part, POINTER(c_uint32), POINTER(c_size_t))
_part_get_grid = _bind("ko_part_get_grid", c_int32, _part, _doubles, _doubles, POINTER(c_size_t))
_part_copy_cells = _bind("ko_part_copy_cells", c_int32, _part, c_size_t, POINTER(c_uint8))
_part_fractions_of_mesh = _bind(
    "ko_part_fractions_of_mesh", c_int32, _part, _mesh, c_uint32, c_uint32, c_size_t, _doubles
)
_part_fractions_of_field = _bind(
    "ko_part_fractions_of_field", c_int32, _part, _field, c_double, c_uint32, c_uint32, c_size_t, _doubles
)
_part_fractions_of_box = _bind(
    "ko_part_fractions_of_box", c_int32, _part, _doubles, _doubles, c_uint32, c_uint32, c_size_t, _doubles
)
_part_fractions_of_ball = _bind(
    "ko_part_fractions_of_ball", c_int32, _part, _doubles, c_double, c_uint32, c_uint32, c_size_t, _doubles
)
_part_fractions_of_cylinder = _bind(
    "ko_part_fractions_of_cylinder", c_int32, _part, _doubles, c_double, c_uint32, c_uint32, c_size_t, _doubles
)
_part_mesh_of_cells = _bind(
    "ko_part_mesh_of_cells",
    c_int32,
    _part,
    POINTER(c_uint8),
    c_size_t,
    c_int32,
    c_uint32,
    ko_progress,
    c_void_p,
    POINTER(_mesh),
)
_part_mesh_of_densities = _bind(
    "ko_part_mesh_of_densities",
    c_int32,
    _part,
    _doubles,
    c_size_t,
    c_double,
    c_int32,
    c_uint32,
    ko_progress,
    c_void_p,
    POINTER(_mesh),
)
_pair_options_init = _bind("ko_pair_options_init", c_int32, POINTER(ko_pair_options), c_size_t)
_family_options_init = _bind("ko_family_options_init", c_int32, POINTER(ko_family_options), c_size_t)
_optimise_options_init = _bind("ko_optimise_options_init", c_int32, POINTER(ko_optimise_options), c_size_t)
_persistence_options_init = _bind("ko_persistence_options_init", c_int32, POINTER(ko_persistence_options), c_size_t)
_part_sweep = _bind(
    "ko_part_sweep",
    c_int32,
    _part,
    POINTER(c_uint8),
    c_size_t,
    _motion,
    _part,
    _motion,
    POINTER(ko_pair_options),
    c_size_t,
    POINTER(c_uint8),
)
_part_unsweep = _bind(
    "ko_part_unsweep",
    c_int32,
    _part,
    _motion,
    _part,
    POINTER(c_uint8),
    c_size_t,
    _motion,
    c_int32,
    POINTER(ko_pair_options),
    c_size_t,
    POINTER(c_uint8),
)
_pair_create = _bind(
    "ko_pair_create", c_int32, _part, _motion, _part, _motion, POINTER(ko_pair_options), POINTER(_pair)
)
_pair_free = _bind("ko_pair_free", None, _pair)
_pair_get_report = _bind("ko_pair_get_report", c_int32, _pair, c_size_t, POINTER(ko_pair_report))
_pair_measures = _bind(
    "ko_pair_measures", c_int32, _pair, _doubles, c_size_t, _doubles, c_size_t, c_uint32, _doubles, _doubles
)
_pair_local_measures = _bind(
    "ko_pair_local_measures", c_int32, _pair, _doubles, c_size_t, _doubles, c_size_t, c_uint32, _doubles, _doubles
)
_pair_sensitivities = _bind(
    "ko_pair_sensitivities",
    c_int32,
    _pair,
    _doubles,
    c_size_t,
    _doubles,
    c_size_t,
    c_uint32,
    _doubles,
    _doubles,
    _doubles,
    _doubles,
)
_pair_topological_sensitivities = _bind(
    "ko_pair_topological_sensitivities",
    c_int32,
    _pair,
    _doubles,
    c_size_t,
    _doubles,
    c_size_t,
    c_int32,
    c_uint32,
    _doubles,
    _doubles,
    _doubles,
    _doubles,
)
_pair_colliding = _bind("ko_pair_colliding", c_int32, _pair, c_size_t, c_size_t, POINTER(c_uint8), POINTER(c_uint8))
_pair_volumes = _bind(
    "ko_pair_volumes",
    c_int32,
    _pair,
    POINTER(c_uint8),
    c_size_t,
    POINTER(c_uint8),
    c_size_t,
    _doubles,
    _doubles,
    POINTER(c_size_t),
)
_pair_close = _bind(
    "ko_pair_close",
    c_int32,
    _pair,
    POINTER(c_uint8),
    POINTER(c_uint8),
    c_uint32,
    c_size_t,
    c_size_t,
    POINTER(c_uint8),
    POINTER(c_uint8),
    _doubles,
)
_pair_cut = _bind(
    "ko_pair_cut",
    c_int32,
    _pair,
    _doubles,
    _doubles,
    POINTER(ko_family_options),
    c_size_t,
    c_size_t,
    POINTER(c_uint8),
    POINTER(c_uint8),
    _doubles,
    _doubles,
    _doubles,
)
_pair_family = _bind(
    "ko_pair_family",
    c_int32,
    _pair,
    _doubles,
    _doubles,
    _doubles,
    c_size_t,
    POINTER(ko_family_options),
    c_size_t,
    c_size_t,
    POINTER(c_uint8),
    POINTER(c_uint8),
    _doubles,
    _doubles,
    _doubles,
)
_pair_optimise = _bind(
    "ko_pair_optimise",
    c_int32,
    _pair,
    POINTER(ko_optimise_options),
    c_size_t,
    c_size_t,
    _doubles,
    _doubles,
    POINTER(c_uint8),
    POINTER(c_uint8),
    _doubles,
    c_size_t,
    POINTER(ko_optimise_report),
)
_pair_contact = _bind(
    "ko_pair_contact",
    c_int32,
    _pair,
    POINTER(c_uint8),
    c_size_t,
    POINTER(c_uint8),
    c_size_t,
    c_size_t,
    c_uint32,
    ko_progress,
    c_void_p,
    _doubles,
    POINTER(c_size_t),
    _doubles,
    _doubles,
    _doubles,
)
_pair_more_persistent = _bind(
    "ko_pair_more_persistent",
    c_int32,
    _pair,
    POINTER(c_uint8),
    POINTER(c_uint8),
    _doubles,
    _doubles,
    POINTER(ko_persistence_options),
    c_size_t,
    c_size_t,
    POINTER(c_uint8),
    POINTER(c_uint8),
    _doubles,
    _doubles,
    POINTER(c_size_t),
)
_arrange_options_init = _bind("ko_arrange_options_init", c_int32, POINTER(ko_arrange_options), c_size_t)
_assembly_create = _bind(
    "ko_assembly_create",
    c_int32,
    POINTER(_part),
    POINTER(_motion),
    c_size_t,
    POINTER(ko_pair_options),
    POINTER(_assembly),
)
_assembly_free = _bind("ko_assembly_free", None, _assembly)
_assembly_get_report = _bind("ko_assembly_get_report", c_int32, _assembly, c_size_t, POINTER(ko_assembly_report))
_assembly_copy_meetings = _bind("ko_assembly_copy_meetings", c_int32, _assembly, c_size_t, POINTER(c_size_t))
_assembly_close = _bind(
    "ko_assembly_close", c_int32, _assembly, POINTER(c_uint8), POINTER(c_size_t), c_size_t, POINTER(c_uint8)
)
_assembly_arrange = _bind(
    "ko_assembly_arrange",
    c_int32,
    _assembly,
    _doubles,
    POINTER(ko_arrange_options),
    c_size_t,
    POINTER(c_uint8),
    _doubles,
    _doubles,
    POINTER(c_size_t),
)


def capabilities() -> Capability:
    """What the library's build can do."""
    return Capability(_capabilities())


def status_string(status: int) -> str:
    """Name of a status, "KO_ERR_IO", say."""
    return _status_string(status).decode()


# ---- Arrays and errors


def _check(status: int) -> None:
    if status < 0:
        raise Error(status, _last_error().decode(errors="replace"))


def _wrong(message: str) -> Error:
    return Error(Status.INVALID_ARGUMENT, message)


def _laid_out(name: str, array: npt.ArrayLike, type_: Any = np.float64) -> Array:
    """`array` as C reads it: of `type_`, C-contiguous and aligned; itself where it is so already."""
    given = np.asarray(array)
    if given.dtype.kind == "c":
        raise _wrong(f"{name} holds {given.dtype}; real numbers are needed")
    if np.ma.is_masked(array):
        raise _wrong(f"{name} has masked entries; fill or leave them out")
    numbers = np.ascontiguousarray(given, dtype=type_)
    return numbers if numbers.flags.aligned else numbers.copy()


def _numbers(name: str, array: npt.ArrayLike, width: Optional[int], type_: Any = np.float64) -> Array:
    """`array` as [n, width], C-contiguous; itself where it is so already. Width None: [n]."""
    numbers = _laid_out(name, array, type_)
    if width is None:
        if numbers.ndim != 1:
            raise _wrong(f"{name} has the shape {numbers.shape}; [n] is needed")
        return numbers
    if numbers.ndim == 1 and numbers.size == width:
        numbers = numbers.reshape(1, width)
    if numbers.ndim != 2 or numbers.shape[1] != width:
        raise _wrong(f"{name} has the shape {numbers.shape}; [n, {width}] is needed")
    return numbers


def _points_of_any_dim(points: npt.ArrayLike) -> Array:
    """`points` as [n, dim]; which dimensions there are is for the call to say."""
    points = _laid_out("points", points)
    if points.ndim != 2:
        raise _wrong(f"points has the shape {points.shape}; [n, 2] or [n, 3] is needed")
    return points


def _indices_of(name: str, array: npt.ArrayLike, width: Optional[int], type_: Any) -> Array:
    """The same for indices, which must not change on their way to `type_`."""
    given = np.asarray(array)
    if given.dtype != type_ and given.size > 0:
        if given.dtype.kind not in "iu" or given.min() < 0 or given.max() > np.iinfo(type_).max:
            raise _wrong(f"{name} holds {given.dtype}; indices from 0 are needed")
    return _numbers(name, array if np.ma.is_masked(array) else given, width, type_)


def _one_for_each(n: int, name: str, array: Optional[npt.ArrayLike], width: Optional[int]) -> Optional[Array]:
    """`array` as _numbers has it, with `n` rows."""
    if array is None:
        return None
    numbers = _numbers(name, array, width)
    if len(numbers) != n:
        raise _wrong(f"{name} has {len(numbers)} rows; {n} are needed")
    return numbers


def _room(name: str, array: Optional[Array], shape: tuple[int, ...], type_: Any = np.float64) -> Optional[Array]:
    """`array`, into which the library can write `shape`; None stays None."""
    return None if array is None else _needed(name, array, shape, type_)


def _needed(name: str, array: Any, shape: tuple[int, ...], type_: Any = np.float64) -> Array:
    """The same of an array that there must be."""
    if not isinstance(array, np.ndarray) or array.dtype != type_ or array.shape != shape:
        found = f"{array.dtype} {array.shape}" if isinstance(array, np.ndarray) else type(array).__name__
        raise _wrong(f"{name} is {found}; an array of {np.dtype(type_)} {shape} is needed")
    if not (array.flags.c_contiguous and array.flags.aligned and array.flags.writeable):
        raise _wrong(f"{name} must be C-contiguous, aligned and writeable")
    return array


def _at(array: Optional[Array], type_: Any = c_double) -> Any:
    """Where an array lies; NULL for none."""
    return None if array is None else array.ctypes.data_as(POINTER(type_))


def _whole(name: str, value: Any, type_: Any) -> int:
    """A number that C takes as `type_`: ctypes would wrap one that does not fit around."""
    number = operator.index(value)
    signed, bits = type_(-1).value < 0, 8 * ctypes.sizeof(type_)
    largest = (1 << (bits - signed)) - 1
    if not signed and number < 0:
        raise _wrong(f"{name} is {number}; it must not be negative")
    if not -signed * (largest + 1) <= number <= largest:
        raise _wrong(f"{name} is {number}; {largest} is the largest that C takes")
    return number


def _count(name: str, value: Any) -> int:
    """The same of a size_t."""
    return _whole(name, value, c_size_t)


def _small(name: str, value: Any) -> int:
    """The same of a uint32_t."""
    return _whole(name, value, c_uint32)


def _choice(name: str, value: Any) -> int:
    """The same of an int32_t, as enumerators are; whether there is such a one is for the call to say."""
    return _whole(name, value, c_int32)


def _path(path: Union[str, os.PathLike]) -> bytes:
    encoded = os.fsencode(path)
    if b"\0" in encoded:
        raise _wrong(f"the path {path!r} has a zero byte in it")
    return encoded


class _Handle:
    """Owns a handle of C, `_as_parameter_` to ctypes. Once closed it is NULL, which each call refuses."""

    _free: Any
    _pointer: Any

    def __init__(self, handle: Any) -> None:
        self._as_parameter_ = handle
        self._finalizer = weakref.finalize(self, self._free, handle)

    def free(self) -> None:
        """Frees what is held. No other thread may be using it. Calls from then on raise Error."""
        self._as_parameter_ = type(self._as_parameter_)()
        self._finalizer()

    def close(self) -> None:
        """The same."""
        self.free()

    def __reduce__(self) -> Any:
        raise TypeError(f"a {type(self).__name__} cannot be copied or pickled: it owns what the library holds")

    def __copy__(self) -> Any:
        return self.__reduce__()

    def __deepcopy__(self, _: Any) -> Any:
        return self.__reduce__()

    def __enter__(self):
        return self

    def __exit__(self, *_: object) -> None:
        self.free()


# ---- Options and progress


class _Options:
    """A struct of options: the defaults but for what is given by name. A name that is no option raises AttributeError."""

    _fields_: Any
    _init: Any

    def __init__(self, **settings: Any) -> None:
        super().__init__()
        _check(self._init(ctypes.byref(self), ctypes.sizeof(self)))
        for name, value in settings.items():
            setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        own = ("struct_size", "progress", "n_symmetries")
        options = {field: type_ for field, type_ in self._fields_ if not field.startswith(own)}
        if name not in options:
            raise AttributeError(f"there is no option {name}; there are {', '.join(options)}")
        if name == "control_points":
            counts = [value] * 3 if np.ndim(value) == 0 else [*value]
            if not 1 <= len(counts) <= 3:
                raise _wrong(f"control_points has {len(counts)} entries; one for each axis, 3 at most, are needed")
            value = (c_uint32 * 3)(*(_small(name, count) for count in counts))
        elif name == "gammas":
            value = (c_double * 2)(*_needs(name, value, 2))
        elif options[name] in (c_int32, c_uint32, c_uint64):
            value = _whole(name, value, options[name])
        super().__setattr__(name, value)


class FitOptions(_Options, ko_fit_options):
    """Options of Field.fit and refit: the defaults but for what is given by name, FitOptions(feasible=Feasible.INSIDE, margin=0.3), say.

    control_points takes one number for all axes, or one for each. A name that is no option raises AttributeError.
    """

    _init = staticmethod(_fit_options_init)


class NormalOptions(_Options, ko_normal_options):
    """Options of Cloud.estimate_normals, as FitOptions has those of Field.fit."""

    _init = staticmethod(_normal_options_init)


class SmoothOptions(_Options, ko_smooth_options):
    """Options of Cloud.smooth, as FitOptions has those of Field.fit."""

    _init = staticmethod(_smooth_options_init)


class LevelSetOptions(_Options, ko_level_set_options):
    """Options of Field.level_set, as FitOptions has those of Field.fit."""

    _init = staticmethod(_level_set_options_init)


class CertifyOptions(_Options, ko_certify_options):
    """Options of Field.certify, as FitOptions has those of Field.fit."""

    _init = staticmethod(_certify_options_init)


class Aggregation(_Options, ko_aggregation):
    """How values of samples become one, KS but for what is given by name: Aggregation(kind=Aggregate.NONE), say."""

    _init = staticmethod(_aggregation_init)


class ExplicitOptions(_Options, ko_explicit_options):
    """Options of Explicit.create, as FitOptions has those of Field.fit."""

    _init = staticmethod(_explicit_options_init)


class PairOptions(_Options, ko_pair_options):
    """Options of Pair.create, Part.sweep and Part.unsweep, as FitOptions has those of Field.fit."""

    _init = staticmethod(_pair_options_init)


class FamilyOptions(_Options, ko_family_options):
    """Options of Pair.cut and Pair.family, as FitOptions has those of Field.fit.

    symmetries takes maps by which pairs shall be symmetric, [((A_1, b_1), (A_2, b_2)), ...], and copies them: x goes to A x + b in the own frame of
    part 1 and of part 2, with A [dim, dim] and b [dim]. None or []: none.
    """

    _init = staticmethod(_family_options_init)
    _maps: Array = np.empty((0, 0))

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "symmetries":
            super().__setattr__(name, value)
            return
        # C is told where the numbers are: they stay as long as these options.
        maps = _maps_of(() if value is None else value)
        super().__setattr__(name, _at(maps) if len(maps) else None)
        ctypes.Structure.__setattr__(self, "n_symmetries", len(maps))
        ctypes.Structure.__setattr__(self, "_maps", maps)


class OptimiseOptions(_Options, ko_optimise_options):
    """Options of Pair.optimise, as FitOptions has those of Field.fit."""

    _init = staticmethod(_optimise_options_init)


class PersistenceOptions(_Options, ko_persistence_options):
    """Options of Pair.more_persistent, as FitOptions has those of Field.fit. gammas takes two numbers, from and to."""

    _init = staticmethod(_persistence_options_init)


class ArrangeOptions(_Options, ko_arrange_options):
    """Options of Assembly.arrange, as FitOptions has those of Field.fit."""

    _init = staticmethod(_arrange_options_init)


def _maps_of(symmetries: Sequence[Any]) -> Array:
    """Maps of both parts' frames, ((A_1, b_1), (A_2, b_2)) each, as C has them: [n, 2 dim (dim + 1)]."""
    rows = []
    for m, (first, second) in enumerate(symmetries):
        row: list[Any] = []
        for matrix, vector in (first, second):
            shift = _numbers(f"the vector of symmetry {m}", vector, None)
            row += [np.ravel(_one_for_each(len(shift), f"the matrix of symmetry {m}", matrix, len(shift))), shift]
        rows.append(np.concatenate(row))
        if len(rows[m]) != len(rows[0]):
            raise _wrong(f"symmetry {m} has {len(rows[m])} numbers; {len(rows[0])}, as symmetry 0 has, are needed")
    return np.array(rows) if rows else np.empty((0, 0))


def _plain(aggregation: Optional[Aggregation]) -> Any:
    """NULL, which is KS, for none."""
    return None if aggregation is None else ctypes.byref(aggregation)


def _handles(fields: Sequence[Field]) -> Any:
    """The handles of `fields` as an array, and how many there are."""
    for field in fields:
        if not isinstance(field, Field):
            raise TypeError(f"fields holds {field!r}; each must be a Field")
    return (_field * len(fields))(*(field._as_parameter_ for field in fields)), len(fields)


class _Listener:
    """Stands between C and a Progress: no exception passes."""

    def __init__(self, progress: Progress) -> None:
        self.progress = progress
        self.raised: Optional[BaseException] = None
        self.for_c = ko_progress(self.hear)

    def hear(self, fraction: float, stage: bytes, _data: Optional[int]) -> int:
        try:
            answer = self.progress(fraction, stage.decode())
            return int(answer is False or (isinstance(answer, np.bool_) and not answer))
        except BaseException as exception:  # KeyboardInterrupt too
            self.raised = exception
            return 1


def _listened(plain: Any, progress: Optional[Progress], call: Callable[[Any], int]) -> int:
    """Status of `call(options)`; `plain`, the options as C has them, get `progress`."""
    listener = _Listener(progress) if progress else None
    if listener:
        plain.progress = listener.for_c
    status = call(ctypes.byref(plain))
    if listener:
        # Neither its own method nor the frames of an exception may hold the listener in a circle, and with it all that they refer to.
        plain.progress = listener.for_c = ko_progress()
        raised, listener.raised = listener.raised, None
        try:
            if raised is not None:
                raise raised
        finally:
            del raised
    _check(status)
    return status


def _make(kind: Any, plain: Any, progress: Optional[Progress], call: Callable[[Any, Any], int]) -> tuple[Any, int]:
    """What `call(options, handle)` made, as the handle `kind`, and its status."""
    handle = kind._pointer()
    try:
        status = _listened(plain, progress, lambda own: call(own, ctypes.byref(handle)))
    except BaseException:
        kind._free(handle)
        raise
    return kind(handle), status


# ---- Meshes, clouds, fields


class Mesh(_Handle):
    """A triangulated surface in space (dim 3), or polylines in the plane (dim 2): there a triangle is a segment."""

    _free = staticmethod(_mesh_free)
    _pointer = _mesh

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        dim = c_uint32()
        _check(_mesh_get_dim(self, ctypes.byref(dim)))
        self.dim: int = dim.value

    @classmethod
    def read(cls, path: Union[str, os.PathLike]) -> Mesh:
        """From an OBJ, STL, PLY or OFF file, plain or compressed by gzip."""
        handle = _mesh()
        _check(_mesh_read(_path(path), ctypes.byref(handle)))
        return cls(handle)

    def write(self, path: Union[str, os.PathLike]) -> None:
        """To the file `path`, whose ending names the format: .obj, .off, .ply or .stl."""
        _check(_mesh_write(self, _path(path)))

    @classmethod
    def from_triangles(cls, vertices: npt.ArrayLike, triangles: npt.ArrayLike) -> Mesh:
        """From vertices [n, 3] and triangles [n, 3], indices from 0, counter-clockwise seen from outside."""
        vertices = _numbers("vertices", vertices, 3)
        triangles = _indices_of("triangles", triangles, 3, np.uint32)
        handle = _mesh()
        _check(
            _mesh_from_triangles(
                _at(vertices), len(vertices), _at(triangles, c_uint32), len(triangles), ctypes.byref(handle)
            )
        )
        return cls(handle)

    @classmethod
    def from_polylines(
        cls, points: npt.ArrayLike, loop_starts: Sequence[int] = (0,), kind: Polylines = Polylines.CLOSED
    ) -> Mesh:
        """From points [n, 2] of the plane, of which polyline i begins at loop_starts[i]. A solid lies on the left of closed ones."""
        points = _numbers("points", points, 2)
        starts = _indices_of("loop_starts", loop_starts, None, np.uintp)
        handle = _mesh()
        _check(
            _mesh_from_polylines(
                _at(points), len(points), _at(starts, c_size_t), len(starts), _choice("kind", kind), ctypes.byref(handle)
            )
        )
        return cls(handle)

    def _size(self) -> tuple[int, int]:
        n_vertices, n_triangles = c_size_t(), c_size_t()
        _check(_mesh_get_size(self, ctypes.byref(n_vertices), ctypes.byref(n_triangles)))
        return n_vertices.value, n_triangles.value

    @property
    def n_vertices(self) -> int:
        """Vertices, used by a triangle or not."""
        return self._size()[0]

    @property
    def n_triangles(self) -> int:
        """Triangles, in the plane segments."""
        return self._size()[1]

    def vertices(self) -> Array:
        """A copy of the vertices, [n_vertices, dim]."""
        n_vertices, n_triangles = self._size()
        vertices = np.empty((n_vertices, self.dim))
        _check(_mesh_copy(self, n_vertices, n_triangles, _at(vertices), None))
        return vertices

    def triangles(self) -> Array:
        """A copy of the triangles, in the plane the segments, [n_triangles, dim] of uint32."""
        n_vertices, n_triangles = self._size()
        triangles = np.empty((n_triangles, self.dim), dtype=np.uint32)
        _check(_mesh_copy(self, n_vertices, n_triangles, None, _at(triangles, c_uint32)))
        return triangles

    def polylines(self) -> Curves:
        """The curves that the segments of a mesh of the plane make: open ones first, then closed ones."""
        n_points, n_loops = c_size_t(), c_size_t()
        _check(_mesh_get_polylines_size(self, ctypes.byref(n_points), ctypes.byref(n_loops)))
        n, m = n_points.value, n_loops.value
        curves = Curves(np.empty((n, 2)), np.empty(m, dtype=np.uintp), np.empty(m, dtype=np.bool_))
        points, starts, closed = _at(curves.points), _at(curves.loop_starts, c_size_t), _at(curves.closed, c_uint8)
        _check(_mesh_copy_polylines(self, n, m, points, starts, closed))
        return curves

    def report(self) -> ko_mesh_report:
        """What can be said of the mesh: closed, oriented, manifold, components, flaws, extents."""
        report = ko_mesh_report()
        _check(_mesh_get_report(self, ctypes.sizeof(report), ctypes.byref(report)))
        return report

    def flip(self) -> None:
        """Turns every triangle over; an inside-out solid becomes a solid. No other thread may be using the mesh."""
        _check(_mesh_flip(self))

    def sample(self, n_points: int, seed: int = 0) -> Cloud:
        """`n_points` points of the surface or the curves with normals, evenly spread."""
        handle = _cloud()
        _check(_mesh_sample(self, _count("n_points", n_points), _whole("seed", seed, c_uint64), ctypes.byref(handle)))
        return Cloud(handle)

    def signed_distance(self, points: npt.ArrayLike) -> Array:
        """Exact distances [n] of points [n, dim]: positive outside."""
        points = _numbers("points", points, self.dim)
        distances = np.empty(len(points))
        _check(_mesh_signed_distance(self, _at(points), len(points), _at(distances)))
        return distances

    def component_points(self) -> Array:
        """A vertex of each component, [n_components, dim]: what a body that swallows the component holds.

        Components are parts that hang together by vertices that triangles share; report().n_components may be more.
        """
        n = c_size_t()
        _check(_mesh_get_component_count(self, ctypes.byref(n)))
        points = np.empty((n.value, self.dim))
        _check(_mesh_copy_component_points(self, len(points), _at(points)))
        return points


class Curves(NamedTuple):
    """Polylines, as Mesh.from_polylines takes those of one kind."""

    points: Array
    """[n, 2]"""
    loop_starts: Array
    """[n_loops] of uintp: where in points each polyline begins."""
    closed: Array
    """[n_loops] of bool: whether it goes back to its first point, which is not repeated."""

    def split(self) -> list[Array]:
        """The points of each polyline, closed ones with their first point once more."""
        parts = np.split(self.points, self.loop_starts[1:].astype(int))
        return [np.vstack((part, part[:1])) if closed else part for part, closed in zip(parts, self.closed)]


class Origins(NamedTuple):
    """Where on its mesh each point of a cloud was taken."""

    triangles: Array
    """[n] of uint32; in the plane segments."""
    barycentric: Array
    """[n, dim]"""


class Cloud(_Handle):
    """Points of a surface in space (dim 3) or of a curve in the plane (dim 2) with unit normals. len() tells how many."""

    _free = staticmethod(_cloud_free)
    _pointer = _cloud

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        dim = c_uint32()
        _check(_cloud_get_dim(self, ctypes.byref(dim)))
        self.dim: int = dim.value

    @classmethod
    def from_points(cls, points: npt.ArrayLike, normals: Optional[npt.ArrayLike] = None) -> Cloud:
        """From points [n, dim] and normals [n, dim] out of the solid, of any length but 0; dim is 2 or 3. None are estimated."""
        points = _points_of_any_dim(points)
        n, dim = points.shape
        normals = None if normals is None else _numbers("normals", normals, dim)
        if normals is not None and len(normals) != n:
            raise _wrong(f"{n} points come with {len(normals)} normals; one a point is needed")
        handle = _cloud()
        _check(_cloud_from_points(dim, _at(points), _at(normals), n, ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def estimate_normals(
        cls, points: npt.ArrayLike, options: Optional[NormalOptions] = None, progress: Optional[Progress] = None
    ) -> Estimate:
        """From points [n, dim] that come without normals, with what was found; `progress` is told on this thread."""
        points = _points_of_any_dim(points)
        n, dim = points.shape
        plain = ko_normal_options.from_buffer_copy(options or NormalOptions())
        flags, report = np.empty(n, dtype=np.uint8), ko_normal_report()
        found = (_at(flags, c_uint8), ctypes.sizeof(report), ctypes.byref(report))
        cloud, _ = _make(
            cls, plain, progress, lambda own, to: _cloud_estimate_normals(dim, _at(points), n, own, to, *found)
        )
        return Estimate(cloud, flags, report)

    def __len__(self) -> int:
        n = c_size_t()
        _check(_cloud_get_size(self, ctypes.byref(n)))
        return n.value

    def points(self) -> Array:
        """A copy of the points, [n, dim]."""
        points = np.empty((len(self), self.dim))
        _check(_cloud_copy(self, len(points), _at(points), None))
        return points

    def normals(self) -> Array:
        """A copy of the normals, [n, dim], of length 1."""
        normals = np.empty((len(self), self.dim))
        _check(_cloud_copy(self, len(normals), None, _at(normals)))
        return normals

    def set_weights(self, weights: npt.ArrayLike) -> None:
        """Gives each point a weight [n]: how much a fit trusts it. Points of weight 0 take no part."""
        weights = _numbers("weights", weights, None)
        _check(_cloud_set_weights(self, _at(weights), len(weights)))

    def smooth(self, options: Optional[SmoothOptions] = None, progress: Optional[Progress] = None) -> Cloud:
        """A cloud with noise smoothed out of points and normals, which must be about right before; weights stay, origins go.

        `progress` is told on this thread.
        """
        plain = ko_smooth_options.from_buffer_copy(options or SmoothOptions())
        return _make(Cloud, plain, progress, lambda own, to: _cloud_smooth(self, own, to))[0]

    def sides(self, points: npt.ArrayLike) -> Array:
        """On which side points [n, dim] lie, [n]: 1 where the normals point to, -1 behind them, towards 0 where there are none."""
        points = _numbers("points", points, self.dim)
        sides = np.empty(len(points))
        _check(_cloud_sides(self, _at(points), len(points), _at(sides)))
        return sides

    def origins(self) -> Origins:
        """Where on its mesh each point was taken; raises Error for a cloud that was not sampled from one."""
        n = len(self)
        origins = Origins(np.empty(n, dtype=np.uint32), np.empty((n, self.dim)))
        _check(_cloud_copy_origins(self, n, _at(origins.triangles, c_uint32), _at(origins.barycentric)))
        return origins

    def follow(self, mesh: Mesh) -> Cloud:
        """The cloud of the same places on `mesh`: the one that this was sampled from, with its vertices moved."""
        handle = _cloud()
        _check(_cloud_follow(self, mesh, ctypes.byref(handle)))
        return Cloud(handle)

    def pull_back(
        self, mesh: Mesh, d_points: Optional[npt.ArrayLike] = None, d_normals: Optional[npt.ArrayLike] = None
    ) -> Array:
        """Takes derivatives by points and normals, each [n, dim] or None for zeros, back to those by vertices of `mesh`, [n_vertices, dim]."""
        n = len(self)
        d_points = _one_for_each(n, "d_points", d_points, self.dim)
        d_normals = _one_for_each(n, "d_normals", d_normals, self.dim)
        d_vertices = np.empty((mesh.n_vertices, self.dim))
        _check(_cloud_pull_back(self, mesh, _at(d_points), _at(d_normals), n, len(d_vertices), _at(d_vertices)))
        return d_vertices


class Estimate(NamedTuple):
    """A cloud whose normals were estimated."""

    cloud: Cloud
    flags: Array
    """[n] of uint8: an or of the bits of Point for each point, 0 for most."""
    report: ko_normal_report


class LevelSet(NamedTuple):
    """A level set of a field."""

    mesh: Mesh
    open_at_box: bool
    """It meets the field's box, and is open there."""


class Field(_Handle):
    """A level-set function phi, close to the signed distance to a shape."""

    _free = staticmethod(_field_free)
    _pointer = _field

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self.dim: int = self.report().dim

    @classmethod
    def fit(cls, cloud: Cloud, options: Optional[FitOptions] = None, progress: Optional[Progress] = None) -> Field:
        """Fits a field to `cloud`; `progress` is told on this thread. Where options.max_error was out of reach report.max tells."""
        plain = ko_fit_options.from_buffer_copy(options or FitOptions())
        return _make(cls, plain, progress, lambda own, to: _field_fit(cloud, own, to))[0]

    def refit(self, cloud: Cloud, options: Optional[FitOptions] = None, progress: Optional[Progress] = None) -> Field:
        """A fit to `cloud` on this field's box, from its control points on; this field stays as it is."""
        plain = ko_fit_options.from_buffer_copy(options or FitOptions())
        return _make(Field, plain, progress, lambda own, to: _field_refit(self, cloud, own, to))[0]

    @classmethod
    def from_control_points(
        cls,
        control_points: npt.ArrayLike,
        box_min: npt.ArrayLike,
        box_max: npt.ArrayLike,
        diagonal: float,
        feasible: Feasible = Feasible.OUTSIDE,
    ) -> Field:
        """Of control points, with an axis for each of the box, from box_min [dim] to box_max [dim]; `diagonal` is the report's D."""
        control_points = _laid_out("control_points", control_points)
        low, high = _numbers("box_min", box_min, None), _numbers("box_max", box_max, None)
        dim, counts = control_points.ndim, np.array(control_points.shape, dtype=np.uint32)
        if not len(low) == len(high) == dim:
            raise _wrong(f"control_points has {dim} axes, box_min {len(low)}, box_max {len(high)}; they must be as many")
        box, numbers = (_at(counts, c_uint32), _at(low), _at(high)), (_at(control_points), control_points.size)
        handle, feasible = _field(), _choice("feasible", feasible)
        _check(_field_from_control_points(dim, *box, feasible, diagonal, *numbers, ctypes.byref(handle)))
        return cls(handle)

    def control_points(self) -> Array:
        """A copy of the control points, with an axis for each of the box."""
        control_points = np.empty(tuple(self.report().control_points)[: self.dim])
        _check(_field_copy_control_points(self, control_points.size, _at(control_points)))
        return control_points

    @classmethod
    def load(cls, path: Union[str, os.PathLike]) -> Field:
        """From a file that save wrote; it evaluates to the same bits."""
        handle = _field()
        _check(_field_load(_path(path), ctypes.byref(handle)))
        return cls(handle)

    def save(self, path: Union[str, os.PathLike]) -> None:
        """To the file `path`, which is replaced whole or, after an error, left as it was."""
        _check(_field_save(self, _path(path)))

    def report(self) -> ko_fit_report:
        """What the field is and what its fit did."""
        report = ko_fit_report()
        _check(_field_get_report(self, ctypes.sizeof(report), ctypes.byref(report)))
        return report

    def __call__(self, points: npt.ArrayLike) -> Array:
        """Values [n] at points [n, dim]."""
        return self.eval(points, derivatives=0)[0]

    def eval(self, points: npt.ArrayLike, derivatives: int = 1, n_threads: int = 1) -> tuple[Array, ...]:
        """Values [n] at points [n, dim], with gradients [n, dim] from derivatives 1 on, and packed Hessians with 2."""
        if derivatives not in (0, 1, 2):
            raise _wrong(f"derivatives is {derivatives}; it must be 0, 1 or 2")
        points = _numbers("points", points, self.dim)
        n = len(points)
        shapes = ((n,), (n, self.dim), (n, self.dim * (self.dim + 1) // 2))[: derivatives + 1]
        outputs = tuple(np.empty(shape) for shape in shapes)
        self.eval_into(points, *outputs, n_threads=n_threads)
        return outputs

    def eval_into(
        self,
        points: npt.ArrayLike,
        values: Optional[Array] = None,
        gradients: Optional[Array] = None,
        hessians: Optional[Array] = None,
        n_threads: int = 1,
    ) -> None:
        """Evaluates into arrays of the caller's: values [n], gradients [n, dim], hessians [n, dim (dim + 1) / 2]; None: not wanted.

        Hessians are by rows of the upper triangle, xx xy xz yy yz zz in space, xx xy yy in the plane. n_threads 0: all cores.
        """
        points = _numbers("points", points, self.dim)
        n = len(points)
        values = _room("values", values, (n,))
        gradients = _room("gradients", gradients, (n, self.dim))
        hessians = _room("hessians", hessians, (n, self.dim * (self.dim + 1) // 2))
        outputs = (_at(values), _at(gradients), _at(hessians))
        if n_threads == 1:
            _check(_field_eval(self, _at(points), n, *outputs))
        else:
            _check(_field_eval_parallel(self, _at(points), n, *outputs, _small("n_threads", n_threads)))

    def eval_lattice(
        self, origin: npt.ArrayLike, steps: npt.ArrayLike, counts: Sequence[int], derivatives: int = 1, n_threads: int = 1
    ) -> tuple[Array, ...]:
        """Values [*counts] at origin [dim] plus multiples of steps [k, dim], below counts [k], with gradients [*counts, dim].

        derivatives 0: values alone. n_threads 0: all cores.
        """
        if derivatives not in (0, 1):
            raise _wrong(f"derivatives is {derivatives}; it must be 0 or 1")
        origin = _numbers("origin", origin, self.dim)
        steps = _numbers("steps", steps, self.dim)
        sizes = _indices_of("counts", counts, None, np.uintp)
        if len(origin) != 1 or len(steps) != len(sizes):
            raise _wrong(f"{len(origin)} origins, {len(steps)} steps and {len(sizes)} counts; one, and a count a step, are needed")
        shape = tuple(int(size) for size in sizes)
        outputs = (np.empty(shape), np.empty((*shape, self.dim)))[: derivatives + 1]
        to = (_at(outputs[0]), _at(outputs[1]) if derivatives else None)
        at = (_at(origin), _at(steps), _at(sizes, c_size_t), len(steps))
        _check(_field_eval_lattice(self, *at, *to, _small("n_threads", n_threads)))
        return outputs

    def level_set(
        self, level: float = 0.0, options: Optional[LevelSetOptions] = None, progress: Optional[Progress] = None
    ) -> LevelSet:
        """phi = `level` within the field's box: triangles in space, curves in the plane. `progress` is told on this thread."""
        plain = ko_level_set_options.from_buffer_copy(options or LevelSetOptions())
        mesh, status = _make(Mesh, plain, progress, lambda own, to: _field_level_set(self, level, own, to))
        return LevelSet(mesh, status == Status.OPEN_AT_BOX)

    def certify(
        self,
        mesh: Mesh,
        clearance: float = 0.0,
        covering_radius: float = 0.0,
        options: Optional[CertifyOptions] = None,
        progress: Optional[Progress] = None,
    ) -> ko_certificate:
        """Certifies the field against `mesh`, which it was fitted to; `progress` is told on this thread.

        phi at or above its threshold at samples that cover a body's surface within `covering_radius` proves that the body is on the
        feasible side and farther than `clearance` from the shape, once mesh.component_points() are outside the body. What Status.SIDE_NOT_CERTIFIED and
        BUDGET_REACHED tell is in side_certified and budget_reached.
        """
        plain = ko_certify_options.from_buffer_copy(options or CertifyOptions())
        certificate = ko_certificate()
        to = (ctypes.sizeof(certificate), ctypes.byref(certificate))
        _listened(plain, progress, lambda own: _field_certify(self, mesh, clearance, covering_radius, own, *to))
        return certificate

    def outside_box(self, points: npt.ArrayLike) -> Array:
        """Which of points [n, dim] are outside the field's box, [n] of bool."""
        points = _numbers("points", points, self.dim)
        outside = np.empty(len(points), dtype=np.bool_)
        _check(_field_outside_box(self, _at(points), len(points), _at(outside, c_uint8)))
        return outside


class Derivatives(NamedTuple):
    """dJ by a cloud."""

    points: Array
    """By its points, [n, dim]."""
    normals: Array
    """By its normals, [n, dim], at right angles to them."""


class Sensitivity(_Handle):
    """How values of a field change as its cloud does: ready for any number of solves, one a J = sum of w_j phi(x_j)."""

    _free = staticmethod(_sensitivity_free)
    _pointer = _sensitivity

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self.shape: tuple[int, int] = (0, 0)

    @classmethod
    def create(
        cls, field: Field, cloud: Cloud, options: Optional[FitOptions] = None, progress: Optional[Progress] = None
    ) -> Sensitivity:
        """Of `field` with respect to `cloud`, to which it was fitted with `options`; it refers to neither."""
        plain = ko_fit_options.from_buffer_copy(options or FitOptions())
        made = _make(cls, plain, progress, lambda own, to: _sensitivity_create(field, cloud, own, to))[0]
        made.shape = (len(cloud), cloud.dim)
        return made

    def solve(
        self,
        points: npt.ArrayLike,
        weights: Optional[npt.ArrayLike] = None,
        options: Optional[FitOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Derivatives:
        """dJ by points and normals of the cloud, of J over `points` [n, dim] with `weights` [n], None for ones.

        To the tolerance of create's options, or that of `options`.
        """
        points = _numbers("points", points, self.shape[1])
        weights = _one_for_each(len(points), "weights", weights, None)
        to = Derivatives(np.empty(self.shape), np.empty(self.shape))

        def solve(own: Any) -> int:
            arrays = (_at(points), _at(weights), len(points))
            return _sensitivity_solve(self, *arrays, own, self.shape[0], _at(to.points), _at(to.normals))

        if options is None and progress is None:
            _check(solve(None))
        else:
            _listened(ko_fit_options.from_buffer_copy(options or FitOptions()), progress, solve)
        return to


def unpack_hessians(packed: Array) -> Array:
    """Symmetric matrices [n, dim, dim] of packed Hessians [n, dim (dim + 1) / 2]."""
    dim = {3: 2, 6: 3}.get(packed.shape[-1])
    if dim is None:
        raise _wrong(f"packed has the shape {packed.shape}; [n, 6] or [n, 3] is needed")
    rows, columns = np.triu_indices(dim)
    matrices = np.empty(packed.shape[:-1] + (dim, dim))
    matrices[..., rows, columns] = packed
    matrices[..., columns, rows] = packed
    return matrices


# ---- Constraints


class Bounds(NamedTuple):
    """How far an aggregate may lie from the least value, in units of D."""

    below: float
    above: float


def aggregate(
    values: npt.ArrayLike,
    unit: float,
    aggregation: Optional[Aggregation] = None,
    extreme: Extreme = Extreme.LEAST,
    derivatives: int = 0,
) -> tuple[Any, ...]:
    """The aggregate of values [n], with D the `unit`; from derivatives 1 on its gradient [n], with 2 its packed Hessian.

    That is the lower triangle by rows, [n (n + 1) / 2], in the order of numpy.tril_indices(n). Without an aggregation: KS.
    """
    if derivatives not in (0, 1, 2):
        raise _wrong(f"derivatives is {derivatives}; it must be 0, 1 or 2")
    values = _numbers("values", values, None)
    n, value = len(values), c_double()
    found = tuple(np.empty(size) for size in (n, n * (n + 1) // 2)[:derivatives])
    to = [_at(array) for array in found] + [None] * (2 - derivatives)
    _check(_aggregate(_plain(aggregation), _choice("extreme", extreme), unit, _at(values), n, ctypes.byref(value), *to))
    return (value.value, *found)


def aggregation_bounds(n_values: int, aggregation: Optional[Aggregation] = None, least: float = 0.0) -> Bounds:
    """How far the aggregate of n_values values may lie from the least; `least`, in units of D, counts for Aggregate.P_NORM alone."""
    below, above = c_double(), c_double()
    n = _count("n_values", n_values)
    _check(_aggregation_bounds(_plain(aggregation), n, least, ctypes.byref(below), ctypes.byref(above)))
    return Bounds(below.value, above.value)


class Body(_Handle):
    """Points of a design that move with it, and how densely they cover its surface. len() tells how many."""

    _free = staticmethod(_body_free)
    _pointer = _body

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        dim = c_uint32()
        _check(_body_get_dim(self, ctypes.byref(dim)))
        self.dim: int = dim.value

    @classmethod
    def from_points(cls, points: npt.ArrayLike, covering_radius: float = 0.0) -> Body:
        """From points [n, dim], of which one is within `covering_radius` of each point of the surface; 0: not known."""
        points = _points_of_any_dim(points)
        n, dim = points.shape
        handle = _body()
        _check(_body_from_points(dim, _at(points), n, covering_radius, ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def from_mesh(cls, mesh: Mesh, covering_radius: float) -> Body:
        """Points on `mesh`, so many that one is within `covering_radius` of each point of its surface or curves."""
        handle = _body()
        _check(_body_from_mesh(mesh, covering_radius, ctypes.byref(handle)))
        return cls(handle)

    def __len__(self) -> int:
        n = c_size_t()
        _check(_body_get_size(self, ctypes.byref(n)))
        return n.value

    @property
    def covering_radius(self) -> float:
        """0: not known."""
        radius = c_double()
        _check(_body_get_covering_radius(self, ctypes.byref(radius)))
        return radius.value

    def points(self) -> Array:
        """A copy of the points, [n, dim]."""
        points = np.empty((len(self), self.dim))
        _check(_body_copy_points(self, len(points), _at(points)))
        return points


class Size(NamedTuple):
    """How many of each some constraints have."""

    n_variables: int
    n_values: int
    n_jacobian: int
    """Entries of the Jacobian's pattern."""
    n_hessian: int
    """Entries of the Hessian's."""


class Pattern(NamedTuple):
    """Where entries stand, counted from 0: scipy.sparse.coo_array((entries, pattern), shape) is the matrix."""

    rows: Array
    """[n] of int32"""
    columns: Array
    """[n] of int32"""


class Constraints(_Handle):
    """Requirements that samples of a design lie where fields are positive, over one vector of variables x [n_variables].

    Frames and points are told by their numbers; WORLD is the frame that does not move.
    """

    _free = staticmethod(_constraints_free)
    _pointer = _constraints
    _sizes: Optional[Size] = None

    @classmethod
    def create(cls, dim: int = 3) -> Constraints:
        """Without variables and values; dim is 2 or 3."""
        handle = _constraints()
        _check(_constraints_create(_small("dim", dim), ctypes.byref(handle)))
        return cls(handle)

    def add_frame(self, rotation: Rotation = Rotation.NONE, scale: Scale = Scale.ONE) -> int:
        """A frame whose parameters are variables: dim of its place, then those of its rotation, then its scale."""
        frame, turned = c_uint32(), (_choice("rotation", rotation), _choice("scale", scale))
        self._sizes = None
        _check(_constraints_add_frame(self, *turned, ctypes.byref(frame)))
        return frame.value

    def add_fixed_frame(
        self, parameters: npt.ArrayLike, rotation: Rotation = Rotation.NONE, scale: Scale = Scale.ONE
    ) -> int:
        """A frame that stands still at `parameters`."""
        parameters = _numbers("parameters", parameters, None)
        frame, given = c_uint32(), (_at(parameters), len(parameters))
        turned = (_choice("rotation", rotation), _choice("scale", scale))
        self._sizes = None
        _check(_constraints_add_fixed_frame(self, *turned, *given, ctypes.byref(frame)))
        return frame.value

    def add_points(self, n_points: int) -> int:
        """Points whose coordinates are variables."""
        points = c_uint32()
        self._sizes = None
        _check(_constraints_add_points(self, _count("n_points", n_points), ctypes.byref(points)))
        return points.value

    def keep_body(
        self, body: Body, frame: int, field: Field, field_frame: int = WORLD, aggregation: Optional[Aggregation] = None
    ) -> int:
        """Keeps `body` in `frame` where phi of `field` in `field_frame` is positive: the number of the first value."""
        first, frames = c_size_t(), (_small("frame", frame), _small("field_frame", field_frame))
        one, other = (body, frames[0]), (field, frames[1])
        self._sizes = None
        _check(_constraints_keep_body(self, *one, *other, _plain(aggregation), ctypes.byref(first)))
        return first.value

    def keep_points(
        self, points: int, field: Field, field_frame: int = WORLD, aggregation: Optional[Aggregation] = None
    ) -> int:
        """The same of points that are variables."""
        first, numbers = c_size_t(), (_small("points", points), _small("field_frame", field_frame))
        other = (field, numbers[1])
        self._sizes = None
        _check(_constraints_keep_points(self, numbers[0], *other, _plain(aggregation), ctypes.byref(first)))
        return first.value

    def keep_body_in_fields(
        self,
        body: Body,
        frame: int,
        fields: Sequence[Field],
        extreme: Extreme,
        combination: Optional[Aggregation] = None,
        field_frame: int = WORLD,
        aggregation: Optional[Aggregation] = None,
    ) -> int:
        """Keeps `body` in `frame` in the union, Extreme.LARGEST, or the intersection, LEAST, of the feasible sets of `fields`.

        Their phi become one by `combination`, sample by sample. All are in `field_frame`. The number of the first value.
        """
        first, frames = c_size_t(), (_small("frame", frame), _small("field_frame", field_frame))
        combined = (*_handles(fields), _choice("extreme", extreme), _plain(combination))
        whole = (frames[1], _plain(aggregation), ctypes.byref(first))
        self._sizes = None
        _check(_constraints_keep_body_in_fields(self, body, frames[0], *combined, *whole))
        return first.value

    def keep_points_in_fields(
        self,
        points: int,
        fields: Sequence[Field],
        extreme: Extreme,
        combination: Optional[Aggregation] = None,
        field_frame: int = WORLD,
        aggregation: Optional[Aggregation] = None,
    ) -> int:
        """The same of points that are variables."""
        first, numbers = c_size_t(), (_small("points", points), _small("field_frame", field_frame))
        combined = (*_handles(fields), _choice("extreme", extreme), _plain(combination))
        whole = (numbers[1], _plain(aggregation), ctypes.byref(first))
        self._sizes = None
        _check(_constraints_keep_points_in_fields(self, numbers[0], *combined, *whole))
        return first.value

    def size(self) -> Size:
        """How many variables, values and entries there are."""
        sizes = [c_size_t() for _ in Size._fields]
        _check(_constraints_get_size(self, *(ctypes.byref(size) for size in sizes)))
        return Size(*(size.value for size in sizes))

    def _size(self) -> Size:
        """The same, asked for once after each addition."""
        if self._sizes is None:
            self._sizes = self.size()
        return self._sizes

    def frame_variables(self, frame: int) -> slice:
        """Where in x the parameters of a frame are; empty for one that stands still."""
        first, n = c_size_t(), c_size_t()
        frame = _small("frame", frame)
        _check(_constraints_get_frame_variables(self, frame, ctypes.byref(first), ctypes.byref(n)))
        return slice(first.value, first.value + n.value)

    def points_variables(self, points: int) -> slice:
        """Where in x the coordinates of points are, point by point."""
        first, n = c_size_t(), c_size_t()
        points = _small("points", points)
        _check(_constraints_get_points_variables(self, points, ctypes.byref(first), ctypes.byref(n)))
        return slice(first.value, first.value + n.value)

    def values(self, x: npt.ArrayLike) -> Array:
        """Values [n_values] at x, each to be kept at or above 0."""
        values = np.empty(self._size().n_values)
        self.values_into(x, values)
        return values

    def values_into(self, x: npt.ArrayLike, values: Array) -> None:
        """The same into an array of the caller's."""
        x, values = _numbers("x", x, None), _needed("values", values, (self._size().n_values,))
        _check(_constraints_values(self, _at(x), len(x), len(values), _at(values)))

    def jacobian_pattern(self) -> Pattern:
        """Where the entries of jacobian stand: rows are values, columns variables."""
        n = self._size().n_jacobian
        pattern = Pattern(np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32))
        _check(_constraints_jacobian_pattern(self, n, _at(pattern.rows, c_int32), _at(pattern.columns, c_int32)))
        return pattern

    def jacobian(self, x: npt.ArrayLike) -> Array:
        """Entries [n_jacobian] of the Jacobian at x, in the order of jacobian_pattern."""
        entries = np.empty(self._size().n_jacobian)
        self.jacobian_into(x, entries)
        return entries

    def jacobian_into(self, x: npt.ArrayLike, entries: Array) -> None:
        """The same into an array of the caller's."""
        x, entries = _numbers("x", x, None), _needed("entries", entries, (self._size().n_jacobian,))
        _check(_constraints_jacobian(self, _at(x), len(x), len(entries), _at(entries)))

    def values_and_jacobian(self, x: npt.ArrayLike) -> tuple[Array, Array]:
        """Both at once, which costs no more than jacobian."""
        size = self._size()
        values, entries = np.empty(size.n_values), np.empty(size.n_jacobian)
        self.values_and_jacobian_into(x, values, entries)
        return values, entries

    def values_and_jacobian_into(self, x: npt.ArrayLike, values: Array, entries: Array) -> None:
        """The same into arrays of the caller's."""
        x, size = _numbers("x", x, None), self._size()
        values, entries = _needed("values", values, (size.n_values,)), _needed("entries", entries, (size.n_jacobian,))
        to = (len(values), _at(values), len(entries), _at(entries))
        _check(_constraints_values_and_jacobian(self, _at(x), len(x), *to))

    def dense_jacobian(self, x: npt.ArrayLike) -> Array:
        """The Jacobian at x as a whole, [n_values, n_variables]."""
        x, n_values = _numbers("x", x, None), self._size().n_values
        jacobian = np.empty((n_values, len(x)))
        _check(_constraints_dense_jacobian(self, _at(x), len(x), n_values, _at(jacobian)))
        return jacobian

    def jacobian_times(self, x: npt.ArrayLike, v: npt.ArrayLike) -> Array:
        """J v, [n_values], at x for v [n_variables]."""
        x, v, product = _numbers("x", x, None), _numbers("v", v, None), np.empty(self._size().n_values)
        if len(v) != len(x):
            raise _wrong(f"v has {len(v)} entries; {len(x)} are needed")
        _check(_constraints_jacobian_times(self, _at(x), _at(v), len(x), len(product), _at(product)))
        return product

    def transposed_jacobian_times(self, x: npt.ArrayLike, w: npt.ArrayLike) -> Array:
        """J^T w, [n_variables], at x for w [n_values]."""
        x, w = _numbers("x", x, None), _numbers("w", w, None)
        product = np.empty(len(x))
        _check(_constraints_transposed_jacobian_times(self, _at(x), len(x), _at(w), len(w), _at(product)))
        return product

    def hessian_pattern(self) -> Pattern:
        """Where the entries of hessian stand: variables both, columns no larger than rows."""
        n = self._size().n_hessian
        pattern = Pattern(np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32))
        _check(_constraints_hessian_pattern(self, n, _at(pattern.rows, c_int32), _at(pattern.columns, c_int32)))
        return pattern

    def hessian(self, x: npt.ArrayLike, multipliers: npt.ArrayLike) -> Array:
        """Entries [n_hessian] of the Hessian of the sum of multipliers [n_values] times the values, the lower triangle alone."""
        x, multipliers = _numbers("x", x, None), _numbers("multipliers", multipliers, None)
        entries = np.empty(self._size().n_hessian)
        given = (_at(x), len(x), _at(multipliers), len(multipliers))
        _check(_constraints_hessian(self, *given, len(entries), _at(entries)))
        return entries


class Explicit(_Handle):
    """A formulation that is a formula of the points of a cloud, to compare a field with."""

    _free = staticmethod(_explicit_free)
    _pointer = _explicit

    def __init__(self, handle: Any, dim: int) -> None:
        super().__init__(handle)
        self.dim: int = dim

    @classmethod
    def create(cls, cloud: Cloud, options: Optional[ExplicitOptions] = None) -> Explicit:
        """Of the points of `cloud`, to which it does not refer."""
        handle = _explicit()
        _check(_explicit_create(cloud, ctypes.byref(options or ExplicitOptions()), ctypes.byref(handle)))
        return cls(handle, cloud.dim)

    @property
    def smoothing(self) -> float:
        """rho, in 1 / D; 0 where the formula has none."""
        smoothing = c_double()
        _check(_explicit_get_smoothing(self, ctypes.byref(smoothing)))
        return smoothing.value

    def __call__(self, points: npt.ArrayLike) -> Array:
        """Values [n] at points [n, dim]."""
        points = _numbers("points", points, self.dim)
        values = np.empty(len(points))
        _check(_explicit_eval(self, _at(points), len(points), _at(values), None))
        return values

    def eval(self, points: npt.ArrayLike) -> tuple[Array, Array]:
        """Values [n] and gradients [n, dim] at points [n, dim]."""
        points = _numbers("points", points, self.dim)
        values, gradients = np.empty(len(points)), np.empty(points.shape)
        _check(_explicit_eval(self, _at(points), len(points), _at(values), _at(gradients)))
        return values, gradients


def separation(
    mesh_a: Mesh,
    mesh_b: Mesh,
    translation: Optional[npt.ArrayLike] = None,
    sharpness: float = 0.0,
    distance_gradients: Optional[Array] = None,
    length_gradients: Optional[Array] = None,
) -> ko_separation:
    """How far two triangulations are apart, and how much they cross, with mesh_b moved by translation [3].

    sharpness 0: the minimum distance itself, else its KS. The gradients, arrays of the caller's [mesh_b.n_vertices, 3], are by the vertices
    of mesh_b; None: not wanted.
    """
    by = None if translation is None else _numbers("translation", translation, 3)
    if by is not None and len(by) != 1:
        raise _wrong(f"translation has the shape {by.shape}; [3] is needed")
    n = mesh_b.n_vertices
    outputs = (_room("distance_gradients", distance_gradients, (n, 3)), _room("length_gradients", length_gradients, (n, 3)))
    found = ko_separation()
    to = (ctypes.sizeof(found), ctypes.byref(found), *map(_at, outputs))
    _check(_meshes_separation(mesh_a, mesh_b, _at(by), sharpness, n, *to))
    return found


# ---- Co-generation


class Law(NamedTuple):
    """How far along its way a motion is at t in [0, 1]: offset + slope t + the sum of amplitude cos(2 pi cycles t + phase) over waves [n, 3]."""

    offset: float = 0.0
    slope: float = 0.0
    waves: npt.ArrayLike = ()

    def for_c(self) -> tuple[ko_law, Array]:
        """The struct of C, and the array that it refers to."""
        waves = _numbers("waves", self.waves, 3) if np.size(self.waves) else np.empty((0, 3))
        law = ko_law()
        _check(_law_init(ctypes.byref(law), ctypes.sizeof(law)))
        law.offset, law.slope, law.waves, law.n_waves = self.offset, self.slope, _at(waves), len(waves)
        return law, waves


PoseFunction = Callable[[float], tuple[npt.ArrayLike, npt.ArrayLike]]
"""Told the time, gives the pose: rotation [dim, dim] and translation [dim]."""


class Motion(_Handle):
    """A rigid motion of one parameter t in [0, 1], from a part's frame to the world."""

    _free = staticmethod(_motion_free)
    _pointer = _motion

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        dim = c_uint32()
        _check(_motion_get_dim(self, ctypes.byref(dim)))
        self.dim: int = dim.value

    @classmethod
    def fixed(cls, dim: int, rotation: Optional[npt.ArrayLike] = None, translation: Optional[npt.ArrayLike] = None) -> Motion:
        """At a pose, by rotation [dim, dim] and translation [dim]; None: none."""
        rows = _one_for_each(dim, "rotation", rotation, dim)
        shift = _one_for_each(dim, "translation", translation, None)
        handle = _motion()
        _check(_motion_fixed(_small("dim", dim), _at(rows), _at(shift), ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def slide(cls, along: npt.ArrayLike, law: Law) -> Motion:
        """A slide by f(t) times along [dim]."""
        along = _numbers("along", along, None)
        plain, _waves = law.for_c()
        handle = _motion()
        _check(_motion_slide(len(along), _at(along), ctypes.byref(plain), ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def turn(cls, center: npt.ArrayLike, law: Law) -> Motion:
        """A turn in the plane about center [2], by f(t) radians counter-clockwise."""
        center = _needs("center", center, 2)
        plain, _waves = law.for_c()
        handle = _motion()
        _check(_motion_turn(_at(center), ctypes.byref(plain), ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def screw(cls, point: npt.ArrayLike, axis: npt.ArrayLike, lead: float, law: Law) -> Motion:
        """A screw in space about the line through point [3] along axis [3]: f(t) radians, and a slide of `lead` a radian."""
        point, axis = _needs("point", point, 3), _needs("axis", axis, 3)
        plain, _waves = law.for_c()
        handle = _motion()
        _check(_motion_screw(_at(point), _at(axis), lead, ctypes.byref(plain), ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def sampled(cls, rotations: npt.ArrayLike, translations: npt.ArrayLike) -> Motion:
        """Through poses at even times, rotations [n, dim, dim] and translations [n, dim], with screws between them."""
        shifts = _laid_out("translations", translations)
        turns = _laid_out("rotations", rotations)
        if shifts.ndim != 2 or turns.shape != (*shifts.shape, shifts.shape[1]):
            raise _wrong(f"rotations {turns.shape} and translations {shifts.shape}; [n, dim, dim] and [n, dim] are needed")
        handle = _motion()
        _check(_motion_sampled(shifts.shape[1], _at(turns), _at(shifts), len(shifts), ctypes.byref(handle)))
        return cls(handle)

    @classmethod
    def from_function(
        cls, dim: int, pose: PoseFunction, n_poses: int, part: Optional[Part] = None, max_speed: float = 0.0
    ) -> Motion:
        """Through `n_poses` poses that `pose` is asked for at even times. What it raises comes out of the call.

        With a part a jump is an error: where a point of its grid would be faster than max_speed.
        """
        raised: list[BaseException] = []

        def ask(time: float, rotation: Any, translation: Any, _data: Optional[int]) -> int:
            try:
                turn, shift = pose(time)
                ctypes.memmove(rotation, _at(_one_for_each(dim, "rotation", turn, dim)), 8 * dim * dim)
                ctypes.memmove(translation, _at(_one_for_each(dim, "translation", shift, None)), 8 * dim)
                return 0
            except BaseException as exception:  # KeyboardInterrupt too
                raised.append(exception)
                return 1

        handle = _motion()
        status = _motion_from_function(
            _small("dim", dim),
            ko_pose_function(ask),
            None,
            _count("n_poses", n_poses),
            part,
            max_speed,
            ctypes.byref(handle),
        )
        if raised:
            raise raised.pop()
        _check(status)
        return cls(handle)

    @classmethod
    def gears(cls, centers: npt.ArrayLike, turns: float, ratio: float) -> tuple[Motion, Motion]:
        """Two wheels about centers [2, 2] that turn against each other: the first by `turns`, the second by `ratio` times that."""
        centers = _one_for_each(2, "centers", centers, 2)
        first, second = _motion(), _motion()
        _check(_motion_gears(_at(centers), turns, ratio, ctypes.byref(first), ctypes.byref(second)))
        return cls(first), cls(second)

    @classmethod
    def four_bar(
        cls, pivots: npt.ArrayLike, lengths: npt.ArrayLike, start: float, by: float, bend: int = 1, n_steps: int = 256
    ) -> tuple[Motion, Motion, Motion]:
        """Crank, coupler and rocker of a linkage with pivots [2, 2] and lengths [3]: see ko_motion_four_bar."""
        pivots, lengths = _one_for_each(2, "pivots", pivots, 2), _needs("lengths", lengths, 3)
        made = [_motion() for _ in range(3)]
        to = [ctypes.byref(handle) for handle in made]
        _check(_motion_four_bar(_at(pivots), _at(lengths), start, by, _choice("bend", bend), _count("n_steps", n_steps), *to))
        crank, coupler, rocker = (cls(handle) for handle in made)
        return crank, coupler, rocker

    def __matmul__(self, inner: Motion) -> Motion:
        """The product: what `inner` does is seen from what this moves."""
        handle = _motion()
        _check(_motion_product(self, inner, ctypes.byref(handle)))
        return type(self)(handle)

    def inverse(self) -> Motion:
        """The motion that undoes this one at each time."""
        handle = _motion()
        _check(_motion_inverse(self, ctypes.byref(handle)))
        return type(self)(handle)

    def eval(self, times: npt.ArrayLike) -> tuple[Array, Array]:
        """Poses at times [n]: rotations [n, dim, dim] and translations [n, dim]."""
        times = _numbers("times", np.atleast_1d(times), None)
        turns, shifts = np.empty((len(times), self.dim, self.dim)), np.empty((len(times), self.dim))
        _check(_motion_eval(self, _at(times), len(times), _at(turns), _at(shifts)))
        return turns, shifts


def _needs(name: str, array: npt.ArrayLike, n: int) -> Array:
    """`array` as [n]."""
    numbers = _numbers(name, array, None)
    if len(numbers) != n:
        raise _wrong(f"{name} has {len(numbers)} entries; {n} are needed")
    return numbers


def _set_of(name: str, cells: npt.ArrayLike, n: int) -> Array:
    """A set of `n` cells, bools or 0 and 1, as C has it."""
    given = np.asarray(cells)
    if given.dtype.kind not in "bui" or (given.size and not 0 <= given.min() <= given.max() <= 1):
        raise _wrong(f"{name} holds {given.dtype}; bools, or 0 and 1, are needed")
    flat = np.ascontiguousarray(given.reshape(-1), dtype=np.uint8)
    if len(flat) != n:
        raise _wrong(f"{name} has {len(flat)} cells; {n} are needed")
    return flat


def _cell_numbers(name: str, numbers: npt.ArrayLike, n: int) -> Array:
    """A number for each of `n` cells, as C has them."""
    flat = _laid_out(name, numbers).reshape(-1)
    if len(flat) != n:
        raise _wrong(f"{name} has {len(flat)} cells; {n} are needed")
    return flat


class Part(_Handle):
    """A grid of square or cubic cells, and what a part may do with each. len() tells how many there are.

    Sets of cells are arrays of bools, densities of numbers in [0, 1]; either may have the shape [n] or that of the grid, and comes as the latter.
    """

    _free = staticmethod(_part_free)
    _pointer = _part

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        dim, n = c_uint32(), c_size_t()
        _check(_part_get_size(self, ctypes.byref(dim), ctypes.byref(n)))
        self.dim: int = dim.value
        corner, edge, counts = np.empty(self.dim), c_double(), (c_size_t * self.dim)()
        _check(_part_get_grid(self, _at(corner), ctypes.byref(edge), counts))
        self.corner: Array = corner
        self.cell_edge: float = edge.value
        self.shape: tuple[int, ...] = tuple(counts)
        self._n: int = n.value

    @classmethod
    def create(
        cls, corner: npt.ArrayLike, cell_edge: float, counts: Sequence[int], cells: Optional[npt.ArrayLike] = None
    ) -> Part:
        """Cells of this edge from corner [dim] on, counts [dim] of them; `cells` are of Cell, None: all are free."""
        corner = _numbers("corner", corner, None)
        if len(counts) != len(corner):
            raise _wrong(f"counts has {len(counts)} entries; {len(corner)} are needed")
        sizes = (c_size_t * len(counts))(*(_count("counts", count) for count in counts))
        given = None if cells is None else np.asarray(cells)
        if given is not None and (given.dtype.kind not in "ui" or (given.size and not 0 <= given.min() <= given.max() <= 255)):
            raise _wrong(f"cells holds {given.dtype}; members of Cell are needed")
        own = None if given is None else np.ascontiguousarray(given.reshape(-1), dtype=np.uint8)
        handle = _part()
        n = 0 if own is None else len(own)
        _check(_part_create(len(corner), _at(corner), cell_edge, sizes, _at(own, c_uint8), n, ctypes.byref(handle)))
        return cls(handle)

    def __len__(self) -> int:
        return self._n

    def cells(self) -> Array:
        """What the part may do with each cell, of Cell, in the shape of the grid."""
        cells = np.empty(self.shape, dtype=np.uint8)
        _check(_part_copy_cells(self, self._n, _at(cells, c_uint8)))
        return cells

    def centers(self) -> Array:
        """The cells' centres, [*shape, dim]."""
        axes = [self.corner[a] + self.cell_edge * (np.arange(n) + 0.5) for a, n in enumerate(self.shape)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def _filled(self, call: Any, *arguments: Any, samples: int, n_threads: int) -> Array:
        out = np.empty(self.shape)
        _check(call(self, *arguments, _small("samples", samples), _small("n_threads", n_threads), self._n, _at(out)))
        return out

    def fractions_of_mesh(self, mesh: Mesh, samples: int = 8, n_threads: int = 0) -> Array:
        """What part of each cell the mesh's solid fills, by `samples` points along a cell's edge."""
        return self._filled(_part_fractions_of_mesh, mesh, samples=samples, n_threads=n_threads)

    def fractions_of_field(self, field: Field, steepness: float, samples: int = 8, n_threads: int = 0) -> Array:
        """The same of a field's solid; `steepness` bounds the length of its gradient."""
        return self._filled(_part_fractions_of_field, field, steepness, samples=samples, n_threads=n_threads)

    def fractions_of_box(self, low: npt.ArrayLike, high: npt.ArrayLike, samples: int = 8, n_threads: int = 0) -> Array:
        """The same of a box along the axes."""
        corners = _needs("low", low, self.dim), _needs("high", high, self.dim)
        return self._filled(_part_fractions_of_box, *map(_at, corners), samples=samples, n_threads=n_threads)

    def fractions_of_ball(self, center: npt.ArrayLike, radius: float, samples: int = 8, n_threads: int = 0) -> Array:
        """The same of a ball, in the plane a disc."""
        center = _needs("center", center, self.dim)
        return self._filled(_part_fractions_of_ball, _at(center), radius, samples=samples, n_threads=n_threads)

    def fractions_of_cylinder(self, ends: npt.ArrayLike, radius: float, samples: int = 8, n_threads: int = 0) -> Array:
        """The same of a cylinder, in the plane a strip, between the middles of its ends [2, dim]."""
        ends = _one_for_each(2, "ends", ends, self.dim)
        return self._filled(_part_fractions_of_cylinder, _at(ends), radius, samples=samples, n_threads=n_threads)

    def mesh_of_cells(
        self,
        cells: npt.ArrayLike,
        within: Within = Within.CELLS,
        rounds: int = 20,
        progress: Optional[Progress] = None,
    ) -> Mesh:
        """The mesh that bounds a set of cells: closed, in the part's frame. Each vertex is moved `rounds` times, with 0 it is the cells' faces."""
        own = _set_of("cells", cells, self._n)
        return self._bounded(_part_mesh_of_cells, _at(own, c_uint8), self._n, within=within, rounds=rounds, progress=progress)

    def mesh_of_densities(
        self,
        densities: npt.ArrayLike,
        level: float = 0.5,
        within: Within = Within.CELLS,
        rounds: int = 20,
        progress: Optional[Progress] = None,
    ) -> Mesh:
        """The same of the cells whose density is above `level`; the mesh is drawn to where the density passes it."""
        rho = _cell_numbers("densities", densities, self._n)
        what = _at(rho), self._n, level
        return self._bounded(_part_mesh_of_densities, *what, within=within, rounds=rounds, progress=progress)

    def _bounded(self, call: Any, *what: Any, within: Within, rounds: int, progress: Optional[Progress]) -> Mesh:
        # Any options will do to carry the function.
        plain, how = ko_family_options(), (_choice("within", within), _small("rounds", rounds))
        mesh, _ = _make(Mesh, plain, progress, lambda _, to: call(self, *what, *how, plain.progress, None, to))
        return mesh

    def sweep(
        self,
        motion: Optional[Motion],
        still: Part,
        still_motion: Optional[Motion] = None,
        cells: Optional[npt.ArrayLike] = None,
        options: Optional[PairOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Array:
        """The cells of `still` that this part's `cells`, None: all that it may have, pass over. A motion None: it stays."""
        own = None if cells is None else _set_of("cells", cells, self._n)
        swept = np.empty(still.shape, dtype=np.uint8)
        n = 0 if own is None else self._n

        def call(plain: Any) -> int:
            to = _at(swept, c_uint8)
            return _part_sweep(self, _at(own, c_uint8), n, motion, still, still_motion, plain, len(still), to)

        _listened(ko_pair_options.from_buffer_copy(options or PairOptions()), progress, call)
        return swept.astype(bool)

    def unsweep(
        self,
        motion: Optional[Motion],
        body: Part,
        body_motion: Optional[Motion] = None,
        rule: Rule = Rule.AVOID,
        kept: Optional[npt.ArrayLike] = None,
        body_cells: Optional[npt.ArrayLike] = None,
        options: Optional[PairOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Array:
        """What is left of `kept`, None: all that the part may have, when what breaks the rule about `body` is taken out."""
        left = np.ones(self._n, dtype=np.uint8) if kept is None else _set_of("kept", kept, self._n).copy()
        own = None if body_cells is None else _set_of("body_cells", body_cells, len(body))
        n = 0 if own is None else len(own)

        def call(plain: Any) -> int:
            to, which = _at(left, c_uint8), _choice("rule", rule)
            return _part_unsweep(self, motion, body, _at(own, c_uint8), n, body_motion, which, plain, self._n, to)

        _listened(ko_pair_options.from_buffer_copy(options or PairOptions()), progress, call)
        return left.reshape(self.shape).astype(bool)


class Measures(NamedTuple):
    """(29) and (30): area or volume of a part that is in the other, times the fraction of the motion that it is."""

    g21: float
    g12: float


class Sensitivities(NamedTuple):
    """(31) and (32), derivatives of each measure by the densities of both parts; or (B.1) and (B.2)."""

    g21_by_1: Array
    g21_by_2: Array
    g12_by_1: Array
    g12_by_2: Array


class Volumes(NamedTuple):
    """What is left of the colliding cells of both parts, gamma, and how many cells of part 2 conflict with part 1's."""

    volumes: tuple[float, float]
    gamma: float
    n_lost: int


class Closed(NamedTuple):
    """Sets of cells that never collide, maximal, and their gamma."""

    first: Array
    second: Array
    gamma: float


class Cut(NamedTuple):
    """The pair of the greatest weight, with symmetries of the symmetric ones, and the bound that proves it."""

    first: Array
    second: Array
    gamma: float
    weight: float
    bound: float


class Member(NamedTuple):
    """A pair of a family."""

    first: Array
    second: Array
    gamma: float
    volumes: tuple[float, float]
    bound: float
    """No pair of the gamma that was asked for has more for the volumes' sum."""


class Optimised(NamedTuple):
    """What moving asymptotes ended with, and its closure."""

    first: Array
    second: Array
    densities_1: Array
    densities_2: Array
    history: Array
    """[n, 5]: V_1, V_2, g_21, g_12, change."""
    report: ko_optimise_report


class Contact(NamedTuple):
    """Gaps over the motion."""

    gaps: Array
    """[n]"""
    cells: Array
    """[n, 2], those nearest to each other."""
    places: Array
    """[n, dim], between them, in part 1's frame."""
    largest: float
    mean: float


class Persistent(NamedTuple):
    """A pair that keeps in touch."""

    first: Array
    second: Array
    before: float
    """Persistence of the pair that it began with: the mean of 1 / (1 + gap / scale) over the motion."""
    after: float
    """That of this pair."""
    n_tries: int


class Pair(_Handle):
    """Two parts in relative motion: how they collide, and sets of cells that never do. Any number of threads may use one at once."""

    _free = staticmethod(_pair_free)
    _pointer = _pair

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        report = self.report()
        self.dim: int = report.dim
        n_1, n_2 = report.n_cells
        self.shapes: tuple[tuple[int, ...], tuple[int, ...]] = ((n_1,), (n_2,))

    @classmethod
    def create(
        cls,
        part_1: Part,
        motion_1: Optional[Motion],
        part_2: Part,
        motion_2: Optional[Motion],
        options: Optional[PairOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Pair:
        """It refers to neither parts nor motions; a motion None: the part stays. Where they never meet, report().n_edges is 0."""
        plain = ko_pair_options.from_buffer_copy(options or PairOptions())
        pair, _ = _make(
            cls, plain, progress, lambda own, to: _pair_create(part_1, motion_1, part_2, motion_2, own, to)
        )
        pair.shapes = part_1.shape, part_2.shape
        return pair

    def report(self) -> ko_pair_report:
        """What the pair is."""
        report = ko_pair_report()
        _check(_pair_get_report(self, ctypes.sizeof(report), ctypes.byref(report)))
        return report

    @property
    def _n(self) -> tuple[int, int]:
        first, second = (int(np.prod(shape)) for shape in self.shapes)
        return first, second

    def _densities(self, first: npt.ArrayLike, second: npt.ArrayLike) -> tuple[Any, int, Any, int]:
        own = [np.ascontiguousarray(_laid_out("densities", x).reshape(-1)) for x in (first, second)]
        return own[0], len(own[0]), own[1], len(own[1])

    def measures(self, densities_1: npt.ArrayLike, densities_2: npt.ArrayLike, n_threads: int = 0) -> Measures:
        """(29) and (30)."""
        x, n, y, m = self._densities(densities_1, densities_2)
        g21, g12 = c_double(), c_double()
        threads = _small("n_threads", n_threads)
        _check(_pair_measures(self, _at(x), n, _at(y), m, threads, ctypes.byref(g21), ctypes.byref(g12)))
        return Measures(g21.value, g12.value)

    def local_measures(
        self, densities_1: npt.ArrayLike, densities_2: npt.ArrayLike, n_threads: int = 0
    ) -> tuple[Array, Array]:
        """(12), of part 1's cells, and (13), of part 2's."""
        x, n, y, m = self._densities(densities_1, densities_2)
        l21, l12 = np.empty(self.shapes[0]), np.empty(self.shapes[1])
        if (n, m) != self._n:
            raise _wrong(f"densities of {n} and {m} cells; {self._n} are needed")
        _check(_pair_local_measures(self, _at(x), n, _at(y), m, _small("n_threads", n_threads), _at(l21), _at(l12)))
        return l21, l12

    def sensitivities(
        self, densities_1: npt.ArrayLike, densities_2: npt.ArrayLike, n_threads: int = 0
    ) -> Sensitivities:
        """(31) and (32)."""
        return self._sensitive(_pair_sensitivities, densities_1, densities_2, _small("n_threads", n_threads))

    def topological_sensitivities(
        self, densities_1: npt.ArrayLike, densities_2: npt.ArrayLike, change: Change, n_threads: int = 0
    ) -> Sensitivities:
        """(B.1) and (B.2): how each measure changes, by the area or volume, as cells are put to a part or taken from it."""
        how = _choice("change", change), _small("n_threads", n_threads)
        return self._sensitive(_pair_topological_sensitivities, densities_1, densities_2, *how)

    def _sensitive(self, call: Any, densities_1: npt.ArrayLike, densities_2: npt.ArrayLike, *how: int) -> Sensitivities:
        x, n, y, m = self._densities(densities_1, densities_2)
        if (n, m) != self._n:
            raise _wrong(f"densities of {n} and {m} cells; {self._n} are needed")
        out = Sensitivities(*(np.empty(self.shapes[k]) for k in (0, 1, 0, 1)))
        _check(call(self, _at(x), n, _at(y), m, *how, *map(_at, out)))
        return out

    def _room(self) -> list[Array]:
        return [np.empty(shape, dtype=np.uint8) for shape in self.shapes]

    def colliding(self) -> tuple[Array, Array]:
        """The initially colliding subdomains, (33) to (36)."""
        first, second = self._room()
        _check(_pair_colliding(self, *self._n, _at(first, c_uint8), _at(second, c_uint8)))
        return first.astype(bool), second.astype(bool)

    def volumes(self, first: npt.ArrayLike, second: npt.ArrayLike) -> Volumes:
        """Of any sets."""
        n, m = self._n
        x, y = _set_of("first", first, n), _set_of("second", second, m)
        volumes, gamma, lost = np.empty(2), c_double(), c_size_t()
        sets = _at(x, c_uint8), n, _at(y, c_uint8), m
        _check(_pair_volumes(self, *sets, _at(volumes), ctypes.byref(gamma), ctypes.byref(lost)))
        return Volumes((volumes[0].item(), volumes[1].item()), gamma.value, lost.value)

    def close(
        self, first: Optional[npt.ArrayLike] = None, second: Optional[npt.ArrayLike] = None, start: int = 0
    ) -> Closed:
        """From any sets to a pair that never collides and cannot grow, beginning with part `start`, 0: the larger."""
        n, m = self._n
        x = None if first is None else _set_of("first", first, n)
        y = None if second is None else _set_of("second", second, m)
        (to_1, to_2), gamma = self._room(), c_double()
        outs = _at(to_1, c_uint8), _at(to_2, c_uint8)
        sets = _at(x, c_uint8), _at(y, c_uint8)
        _check(_pair_close(self, *sets, _small("start", start), n, m, *outs, ctypes.byref(gamma)))
        return Closed(to_1.astype(bool), to_2.astype(bool), gamma.value)

    def _weights(self, first: Optional[npt.ArrayLike], second: Optional[npt.ArrayLike]) -> list[Optional[Array]]:
        given = [None if x is None else _laid_out("weights", x).reshape(-1) for x in (first, second)]
        for weights, n in zip(given, self._n):
            if weights is not None and len(weights) != n:
                raise _wrong(f"weights of {len(weights)} cells; {n} are needed")
        return given

    def _family_options(self, options: Optional[FamilyOptions]) -> tuple[ko_family_options, Array]:
        """The struct of C, and the array that it refers to, whose length C takes from the pair."""
        own = options or FamilyOptions()
        maps, right = own._maps, 2 * self.dim * (self.dim + 1)
        if len(maps) and maps.shape[1] != right:
            raise _wrong(f"symmetries have {maps.shape[1]} numbers each; {right} are needed in dim {self.dim}")
        return ko_family_options.from_buffer_copy(own), maps

    def cut(
        self,
        weights_1: Optional[npt.ArrayLike] = None,
        weights_2: Optional[npt.ArrayLike] = None,
        options: Optional[FamilyOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Cut:
        """The pair of the greatest weight; weights None: areas or volumes. With symmetries among the options: of those that all maps carry onto
        themselves."""
        w1, w2 = self._weights(weights_1, weights_2)
        own, _maps = self._family_options(options)
        first, second = self._room()
        numbers = [c_double(), c_double(), c_double()]

        def call(plain: Any) -> int:
            outs = _at(first, c_uint8), _at(second, c_uint8)
            return _pair_cut(self, _at(w1), _at(w2), plain, *self._n, *outs, *map(ctypes.byref, numbers))

        _listened(own, progress, call)
        weight, bound, gamma = (number.value for number in numbers)
        return Cut(first.astype(bool), second.astype(bool), gamma, weight, bound)

    def family(
        self,
        gammas: npt.ArrayLike,
        weights_1: Optional[npt.ArrayLike] = None,
        weights_2: Optional[npt.ArrayLike] = None,
        options: Optional[FamilyOptions] = None,
        progress: Optional[Progress] = None,
    ) -> list[Member]:
        """A pair for each gamma; weights and symmetries as in cut()."""
        wanted = _numbers("gammas", np.atleast_1d(gammas), None)
        w1, w2 = self._weights(weights_1, weights_2)
        own, _maps = self._family_options(options)
        k = len(wanted)
        first, second = (np.empty((k, *shape), dtype=np.uint8) for shape in self.shapes)
        reached, volumes, bounds = np.empty(k), np.empty((k, 2)), np.empty(k)

        def call(plain: Any) -> int:
            outs = _at(first, c_uint8), _at(second, c_uint8), _at(reached), _at(volumes), _at(bounds)
            return _pair_family(self, _at(w1), _at(w2), _at(wanted), k, plain, *self._n, *outs)

        _listened(own, progress, call)
        rows = zip(first.astype(bool), second.astype(bool), reached.tolist(), volumes.tolist(), bounds.tolist())
        return [Member(a, b, gamma, (v[0], v[1]), bound) for a, b, gamma, v, bound in rows]

    def optimise(self, options: Optional[OptimiseOptions] = None, progress: Optional[Progress] = None) -> Optimised:
        """Moving asymptotes, then closure. report.converged tells whether iterations sufficed."""
        plain = ko_optimise_options.from_buffer_copy(options or OptimiseOptions())
        (first, second), rho = self._room(), [np.empty(shape) for shape in self.shapes]
        history, report = np.empty((plain.max_iterations + 1, 5)), ko_optimise_report()

        def call(own: Any) -> int:
            outs = _at(rho[0]), _at(rho[1]), _at(first, c_uint8), _at(second, c_uint8), _at(history)
            return _pair_optimise(self, own, *self._n, *outs, ctypes.sizeof(report), ctypes.byref(report))

        _listened(plain, progress, call)
        return Optimised(
            first.astype(bool), second.astype(bool), *rho, history[: report.n_iterations + 1].copy(), report
        )

    def contact(
        self,
        first: npt.ArrayLike,
        second: npt.ArrayLike,
        n_times: int,
        n_threads: int = 0,
        progress: Optional[Progress] = None,
    ) -> Contact:
        """Gaps of a pair that does not collide, at even times."""
        (n, m), k = self._n, _count("n_times", n_times)
        x, y = _set_of("first", first, n), _set_of("second", second, m)
        gaps, places, cells = np.empty(k), np.empty((k, self.dim)), np.empty((k, 2), dtype=np.uintp)
        largest, mean = c_double(), c_double()
        sets = _at(x, c_uint8), n, _at(y, c_uint8), m
        outs = _at(gaps), _at(cells, c_size_t), _at(places), ctypes.byref(largest), ctypes.byref(mean)

        # Any options will do to carry the function.
        own, threads = ko_family_options(), _small("n_threads", n_threads)
        _listened(own, progress, lambda _: _pair_contact(self, *sets, k, threads, own.progress, None, *outs))
        return Contact(gaps, cells, places, largest.value, mean.value)

    def more_persistent(
        self,
        first: npt.ArrayLike,
        second: npt.ArrayLike,
        weights_1: Optional[npt.ArrayLike] = None,
        weights_2: Optional[npt.ArrayLike] = None,
        options: Optional[PersistenceOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Persistent:
        """Of the pairs as heavy as these sets, which are of the greatest weight, as those of cut(), one that keeps better in touch."""
        n, m = self._n
        x, y = _set_of("first", first, n), _set_of("second", second, m)
        w1, w2 = self._weights(weights_1, weights_2)
        (to_1, to_2), before, after, tried = self._room(), c_double(), c_double(), c_size_t()
        sets = _at(x, c_uint8), _at(y, c_uint8), _at(w1), _at(w2)
        outs = _at(to_1, c_uint8), _at(to_2, c_uint8), *map(ctypes.byref, (before, after, tried))

        plain = ko_persistence_options.from_buffer_copy(options or PersistenceOptions())
        _listened(plain, progress, lambda own: _pair_more_persistent(self, *sets, own, n, m, *outs))
        return Persistent(to_1.astype(bool), to_2.astype(bool), before.value, after.value, tried.value)


class Arrangement(NamedTuple):
    """Parts that never collide and of which none can grow."""

    cells: list[Array]
    """The set of each part."""
    weight: float
    bound: float
    """No parts that never collide weigh more."""
    n_cuts: int


class Assembly(_Handle):
    """Any number of parts, none of which collides with another. Any number of threads may use one at once.

    Sets of cells and weights are lists with an array for each part, each of the shape [n] or that of the part's grid; sets come as the latter.
    """

    _free = staticmethod(_assembly_free)
    _pointer = _assembly

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        report = self.report()
        self.dim: int = report.dim
        self.shapes: tuple[tuple[int, ...], ...] = ()

    @classmethod
    def create(
        cls,
        parts: Sequence[Part],
        motions: Sequence[Optional[Motion]],
        options: Optional[PairOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Assembly:
        """It refers to neither parts nor motions; a motion None: the part stays. Where none meet, meetings() is empty."""
        if len(motions) != len(parts):
            raise _wrong(f"motions has {len(motions)} entries; {len(parts)} are needed")
        for part, motion in zip(parts, motions):
            if not isinstance(part, Part):
                raise TypeError(f"parts holds {part!r}; each must be a Part")
            if not (motion is None or isinstance(motion, Motion)):
                raise TypeError(f"motions holds {motion!r}; each must be a Motion or None")
        n = len(parts)
        of_parts = (_part * n)(*(part._as_parameter_ for part in parts))
        of_motions = (_motion * n)(*(_motion() if motion is None else motion._as_parameter_ for motion in motions))
        plain = ko_pair_options.from_buffer_copy(options or PairOptions())
        assembly, _ = _make(cls, plain, progress, lambda own, to: _assembly_create(of_parts, of_motions, n, own, to))
        assembly.shapes = tuple(part.shape for part in parts)
        return assembly

    def report(self) -> ko_assembly_report:
        """What the assembly is."""
        report = ko_assembly_report()
        _check(_assembly_get_report(self, ctypes.sizeof(report), ctypes.byref(report)))
        return report

    def meetings(self) -> Array:
        """Pairs of parts of which some cells conflict, [n, 2] of numbers from 0 on, the smaller one first."""
        meetings = np.empty((self.report().n_meetings, 2), dtype=np.uintp)
        _check(_assembly_copy_meetings(self, len(meetings), _at(meetings, c_size_t)))
        return meetings

    @property
    def _n(self) -> list[int]:
        return [int(np.prod(shape)) for shape in self.shapes]

    def _joined(self, name: str, given: Sequence[npt.ArrayLike], laid_out: Callable[[str, Any, int], Array]) -> Array:
        """What there is for each part, part after part."""
        if len(given) != len(self.shapes):
            raise _wrong(f"{name} has {len(given)} entries; {len(self.shapes)}, one for each part, are needed")
        each = enumerate(zip(given, self._n))
        return np.concatenate([laid_out(f"{name}[{k}]", array, n) for k, (array, n) in each])

    def _parted(self, cells: Array) -> list[Array]:
        """The sets of each part."""
        each = np.split(cells.astype(bool), np.cumsum(self._n)[:-1])
        return [own.reshape(shape) for own, shape in zip(each, self.shapes)]

    def close(self, sets: Sequence[npt.ArrayLike], order: Optional[Sequence[int]] = None) -> list[Array]:
        """From any sets to parts that never collide and of which none can grow.

        Part by part in the order, numbers from 0 on, each keeps of its set what those before it leave; None: in that in which they were given.
        """
        own = self._joined("sets", sets, _set_of)
        numbers = None if order is None else _indices_of("order", order, None, np.uintp)
        if numbers is not None and len(numbers) != len(self.shapes):
            raise _wrong(f"order has {len(numbers)} entries; {len(self.shapes)} are needed")
        cells = np.empty_like(own)
        _check(_assembly_close(self, _at(own, c_uint8), _at(numbers, c_size_t), len(own), _at(cells, c_uint8)))
        return self._parted(cells)

    def arrange(
        self,
        weights: Optional[Sequence[npt.ArrayLike]] = None,
        options: Optional[ArrangeOptions] = None,
        progress: Optional[Progress] = None,
    ) -> Arrangement:
        """Parts of great weight; the heaviest, weight == bound, where parts that meet take two colours. Weights None: areas or volumes."""
        own = None if weights is None else self._joined("weights", weights, _cell_numbers)
        cells, weight, bound, n_cuts = np.empty(sum(self._n), dtype=np.uint8), c_double(), c_double(), c_size_t()
        outs = _at(cells, c_uint8), *map(ctypes.byref, (weight, bound, n_cuts))

        plain = ko_arrange_options.from_buffer_copy(options or ArrangeOptions())
        _listened(plain, progress, lambda to: _assembly_arrange(self, _at(own), to, len(cells), *outs))
        return Arrangement(self._parted(cells), weight.value, bound.value, n_cuts.value)
