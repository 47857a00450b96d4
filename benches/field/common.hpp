// What the field's figures share: shapes with held-out points, and how a figure stands beside its limit and the paper's.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../library.hpp"
#include "../measure.hpp"
#include "../oracle.hpp"
#include "../points.hpp"
#include "../program.hpp"
#include "../stats.hpp"

namespace bench {

inline const char *const BUNNY = "stanford/bunny_35947.obj";
inline constexpr Counts BUNNY_GRID = {32, 31, 25};  // the paper's 24,800
inline constexpr std::size_t N_SAMPLES = 25000;
inline constexpr std::size_t N_POINTS = 100000;
inline constexpr std::uint64_t HELD_OUT = 20230601;  // a seed that no fit uses
inline constexpr std::uint64_t IN_BOX = 7;

// A mesh and the points that its fields are judged on.
struct Shape {
    Mesh mesh;
    SurfacePoints held_out;

    explicit Shape(Mesh mesh_of_it)
        : mesh(std::move(mesh_of_it)), held_out(draw_by_area(facets_of(mesh), N_POINTS, HELD_OUT)) {}
    explicit Shape(const std::string &path) : Shape(read_mesh(path)) {}
};

// As fractions of D.
struct Limits {
    double rms, max;
};

std::string text(Counts counts);

double seconds_of(const ko_fit_report &report);

void print_fit(const std::string &key, const Field &field);

// RMS and largest, each with the limit below where there is one.
void print_errors(const std::string &key, const Errors &errors, Limits limit = {0, 0}, const char *suffix = "_limit");

// Errors of |phi| and of |phi| / |grad phi|, both held to `limit`, and the mean gradient.
void print_on_surface(const std::string &key, const OnSurface &found, Limits limit = {0, 0});

void print_paper(const std::string &key, Limits paper);

void print_signs(const std::string &key, const Signs &signs, std::size_t n_points);

// Everything that `Field` is asked for on closed shapes: signs at `n_points` uniform in its box.
Signs signs_in_box(const Field &field, const Mesh &mesh, std::size_t n_points);

}  // namespace bench
