// Errors of a field on held-out points, as fractions of D.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "library.hpp"
#include "points.hpp"
#include "stats.hpp"

namespace bench {

struct OnSurface {
    Errors phi;       // |phi| / D
    Errors distance;  // |phi| / |grad phi| / D: the distance that phi stands for where its gradient is not 1
    double mean_gradient = 0;
};

inline OnSurface on_surface(const Field &field, const std::vector<double> &points, double D) {
    const std::size_t dim = report_of(field).dim, n = points.size() / dim;
    std::vector<double> values(n), gradients(dim * n);
    eval(field, points, values.data(), gradients.data());
    OnSurface found;
    for (std::size_t i = 0; i < n; ++i) {
        const double *g = &gradients[dim * i];
        const double length = std::hypot(g[0], g[1], dim == 3 ? g[2] : 0);
        found.phi.add(values[i] / D);
        found.distance.add(values[i] / length / D);
        found.mean_gradient += length / static_cast<double>(n);
    }
    return found;
}

inline OnSurface on_surface(const Field &field, const std::vector<double> &points) {
    return on_surface(field, points, report_of(field).diagonal);
}

// phi against the exact signed distances `exact` of `points`.
inline Errors off_surface(const Field &field, const std::vector<double> &points, const std::vector<double> &exact) {
    const std::vector<double> values = values_of(field, points);
    const double D = report_of(field).diagonal;
    Errors errors;
    for (std::size_t i = 0; i < values.size(); ++i) errors.add((values[i] - exact[i]) / D);
    return errors;
}

// The field's longest cell edge.
inline double cell_of(const ko_fit_report &field) {
    double longest = 0;
    for (std::uint32_t k = 0; k < field.dim; ++k)
        longest = std::max(longest, (field.box_max[k] - field.box_min[k]) / (field.control_points[k] - 3.0));
    return longest;
}

struct Signs {
    std::size_t far = 0;        // points farther than a cell from the surface
    std::size_t wrong_far = 0;  // of these, how many have the wrong sign
    std::size_t wrong = 0;      // of all points
    double farthest_wrong = 0;  // in cells
};

inline Signs signs_of(const Field &field, const std::vector<double> &points, const std::vector<double> &exact) {
    const std::vector<double> values = values_of(field, points);
    const double cell = cell_of(report_of(field));
    Signs signs;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double cells_away = std::abs(exact[i]) / cell;
        const bool wrong = !(values[i] * exact[i] > 0) && exact[i] != 0;
        signs.far += cells_away > 1;
        signs.wrong += wrong;
        signs.wrong_far += wrong && cells_away > 1;
        if (wrong) signs.farthest_wrong = std::max(signs.farthest_wrong, cells_away);
    }
    return signs;
}

}  // namespace bench
