// Keepout's constraints as the bench uses them.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "../library.hpp"

namespace bench {

struct FreeConstraints {
    void operator()(ko_body *body) const { ko_body_free(body); }
    void operator()(ko_constraints *constraints) const { ko_constraints_free(constraints); }
    void operator()(ko_explicit *formula) const { ko_explicit_free(formula); }
};
using Body = std::unique_ptr<ko_body, FreeConstraints>;
using Constraints = std::unique_ptr<ko_constraints, FreeConstraints>;
using Explicit = std::unique_ptr<ko_explicit, FreeConstraints>;

inline Constraints constraints_of(std::uint32_t dim) {
    ko_constraints *made = nullptr;
    check(ko_constraints_create(dim, &made), "ko_constraints_create");
    return Constraints(made);
}

inline Body body_from(std::uint32_t dim, const std::vector<double> &points) {
    ko_body *made = nullptr;
    check(ko_body_from_points(dim, points.data(), points.size() / dim, 0, &made), "ko_body_from_points");
    return Body(made);
}

inline std::uint32_t add_frame(const Constraints &set, std::int32_t rotation, std::int32_t scale) {
    std::uint32_t frame = 0;
    check(ko_constraints_add_frame(set.get(), rotation, scale, &frame), "ko_constraints_add_frame");
    return frame;
}

inline ko_aggregation aggregation_of(std::int32_t kind, double sharpness, std::int32_t side = KO_BELOW) {
    ko_aggregation aggregation;
    check(ko_aggregation_init(&aggregation, sizeof aggregation), "ko_aggregation_init");
    aggregation.kind = kind;
    aggregation.sharpness = sharpness;
    aggregation.side = side;
    return aggregation;
}

inline void keep(const Constraints &set, const Body &body, std::uint32_t frame, const Field &field, std::uint32_t field_frame,
                 const ko_aggregation &aggregation) {
    check(ko_constraints_keep_body(set.get(), body.get(), frame, field.get(), field_frame, &aggregation, nullptr),
          "ko_constraints_keep_body");
}

inline void keep_in_fields(const Constraints &set, const Body &body, std::uint32_t frame, const std::vector<const ko_field *> &fields,
                           std::int32_t extreme, const ko_aggregation &combination, std::uint32_t field_frame,
                           const ko_aggregation &aggregation) {
    check(ko_constraints_keep_body_in_fields(set.get(), body.get(), frame, fields.data(), fields.size(), extreme, &combination,
                                             field_frame, &aggregation, nullptr),
          "ko_constraints_keep_body_in_fields");
}

struct Sizes {
    std::size_t variables = 0, values = 0, jacobian = 0, hessian = 0;
};

inline Sizes sizes_of(const Constraints &set) {
    Sizes sizes;
    check(ko_constraints_get_size(set.get(), &sizes.variables, &sizes.values, &sizes.jacobian, &sizes.hessian),
          "ko_constraints_get_size");
    return sizes;
}

inline std::vector<double> values_of(const Constraints &set, const std::vector<double> &x) {
    std::vector<double> values(sizes_of(set).values);
    check(ko_constraints_values(set.get(), x.data(), x.size(), values.size(), values.data()), "ko_constraints_values");
    return values;
}

inline std::vector<double> dense_jacobian(const Constraints &set, const std::vector<double> &x) {
    const std::size_t n = sizes_of(set).values;
    std::vector<double> jacobian(n * x.size());
    check(ko_constraints_dense_jacobian(set.get(), x.data(), x.size(), n, jacobian.data()), "ko_constraints_dense_jacobian");
    return jacobian;
}

// Both triangles, row-major.
inline std::vector<double> dense_hessian(const Constraints &set, const std::vector<double> &x, const std::vector<double> &lambda) {
    const std::size_t n = sizes_of(set).hessian;
    std::vector<std::int32_t> rows(n), columns(n);
    std::vector<double> entries(n), hessian(x.size() * x.size());
    check(ko_constraints_hessian_pattern(set.get(), n, rows.data(), columns.data()), "ko_constraints_hessian_pattern");
    check(ko_constraints_hessian(set.get(), x.data(), x.size(), lambda.data(), lambda.size(), n, entries.data()),
          "ko_constraints_hessian");
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t row = static_cast<std::size_t>(rows[i]), column = static_cast<std::size_t>(columns[i]);
        hessian[row * x.size() + column] = hessian[column * x.size() + row] = entries[i];
    }
    return hessian;
}

}  // namespace bench
