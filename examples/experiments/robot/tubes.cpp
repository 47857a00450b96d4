// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "tubes.hpp"

#include <algorithm>
#include <cmath>

namespace {

// Of an arc bent by the vector (a, b, 0), t = a^2 + b^2 the square of its angle: sin x / x, (1 - cos x) / x^2 and (x - sin x) / x^3, with
// the first two's derivatives by t. Series, since formulas cancel for small angles; angles of an element and of the tilt are below 1, where
// the first term left out is below 1e-12.
struct Arc {
    double sine, cosine, third, sine_slope, cosine_slope;

    explicit Arc(double t) {
        sine = series({1, -1. / 6, 1. / 120, -1. / 5040, 1. / 362880, -1. / 39916800, 1. / 6227020800}, t);
        cosine = series({1. / 2, -1. / 24, 1. / 720, -1. / 40320, 1. / 3628800, -1. / 479001600, 1. / 87178291200}, t);
        third = series({1. / 6, -1. / 120, 1. / 5040, -1. / 362880, 1. / 39916800, -1. / 6227020800}, t);
        sine_slope = series({-1. / 6, 2. / 120, -3. / 5040, 4. / 362880, -5. / 39916800, 6. / 6227020800}, t);
        cosine_slope = series({-1. / 24, 2. / 720, -3. / 40320, 4. / 3628800, -5. / 479001600, 6. / 87178291200}, t);
    }

    template <std::size_t n>
    static double series(const double (&c)[n], double t) {
        double sum = 0;
        for (std::size_t k = n; k-- > 0;)
            sum = sum * t + c[k];
        return sum;
    }
};

// The chord of an arc of length 1 that begins along (0, 0, 1).
Vec3 chord(double a, double b) {
    const Arc arc(a * a + b * b);
    return {b * arc.cosine, -a * arc.cosine, arc.sine};
}

Vec3 cross(const Vec3 &a, const Vec3 &b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vec3 &a, const Vec3 &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec3 transposed_times(const Mat3 &a, const Vec3 &v) {
    return {a[0] * v[0] + a[3] * v[1] + a[6] * v[2], a[1] * v[0] + a[4] * v[1] + a[7] * v[2], a[2] * v[0] + a[5] * v[1] + a[8] * v[2]};
}

// What a moment does along the small rotations that changes of a and b add to the rotation by (a, b, 0).
std::array<double, 2> turned(const Vec3 &moment, double a, double b, const Arc &arc) {
    return {dot(moment, {1 - arc.third * b * b, arc.third * a * b, -arc.cosine * b}),
            dot(moment, {arc.third * a * b, 1 - arc.third * a * a, arc.cosine * a})};
}

// At s: m_i, and how far s is in the part where tubes 0 to i, and no others, are: 0 or 1, but near the tubes' ends, and 1 in all. Blending
// parts, not stiffnesses, leaves the effective ends where they are: a blurred stiff tube would count as longer.
struct Section {
    std::array<Length, n_tubes> moment, share;
};

Section section_at(const Tubes &tubes, const std::array<Length, 4 * n_tubes> &x, const Length &s) {
    Section section;
    Length there(1);
    for (int i = 0; i < n_tubes; ++i) {
        section.moment[i] = tubes.bending[i] * (x[kappa_0 + i] * smooth_step(s - x[end_0 + i] + x[curved_0 + i], tubes.blur));
        const bool outermost = i + 1 == n_tubes;
        const Length further = outermost ? Length(0) : there * smooth_step(x[end_0 + i + 1] - s, tubes.blur);
        section.share[i] = there - further;
        there = further;
    }
    return section;
}

} // namespace

Mat3 rotation(double a, double b) {
    const Arc arc(a * a + b * b);
    const double c = arc.cosine, s = arc.sine;
    return {1 - c * b * b, c * a * b, s * b, c * a * b, 1 - c * a * a, -s * a, -s * b, s * a, 1 - c * (a * a + b * b)};
}

Mat3 times(const Mat3 &a, const Mat3 &b) {
    Mat3 product{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                product[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return product;
}

Vec3 times(const Mat3 &a, const Vec3 &v) {
    return {a[0] * v[0] + a[1] * v[1] + a[2] * v[2], a[3] * v[0] + a[4] * v[1] + a[5] * v[2], a[6] * v[0] + a[7] * v[1] + a[8] * v[2]};
}

Tubes nitinol(const std::array<double, n_tubes> &outer, const std::array<double, n_tubes> &inner) {
    constexpr double youngs = 60e3, poisson = 0.33; // N/mm^2
    Tubes tubes{};
    for (int i = 0; i < n_tubes; ++i) {
        const double area_moment = M_PI / 64 * (std::pow(outer[i], 4) - std::pow(inner[i], 4));
        tubes.radius[i] = outer[i] / 2;
        tubes.bending[i] = youngs * area_moment;
        tubes.torsion[i] = youngs / (2 * (1 + poisson)) * 2 * area_moment;
    }
    tubes.frame = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    tubes.n_elements = 64;
    tubes.blur = 0.7;
    return tubes;
}

void solve(const Tubes &tubes, const Parameters &parameters, Shape &shape) {
    const int n = tubes.n_elements;
    std::array<Length, 4 * n_tubes> x;
    for (int k = 0; k < 4 * n_tubes; ++k)
        x[k] = Length::variable(parameters[k], k);
    shape.bend_x.resize(n);
    shape.bend_y.resize(n);
    shape.h = (1.0 / n) * x[end_0];

    // Angles, and torques G_i J_i alpha_i', from the tip on: half a step of angles, one of torques, half a step of angles. Second order.
    std::array<Length, n_tubes> angle, torque;
    for (int i = 0; i < n_tubes; ++i)
        angle[i] = x[psi_0 + i];
    for (int j = n; j-- > 0;) {
        const Section section = section_at(tubes, x, (j + 0.5) * shape.h);
        std::array<Length, n_tubes> cosine, sine;
        for (int i = 0; i < n_tubes; ++i) {
            angle[i] -= (0.5 / tubes.torsion[i]) * (shape.h * torque[i]);
            const double c = std::cos(angle[i].value), s = std::sin(angle[i].value);
            cosine[i] = angle[i].chained(c, -s);
            sine[i] = angle[i].chained(s, c);
        }
        // u of each part, by its share: from part i on in u_x[i] and u_y[i], all in those of 0.
        std::array<Length, n_tubes> u_x, u_y;
        Length sum_x, sum_y;
        double stiffness = 0;
        for (int i = 0; i < n_tubes; ++i) {
            sum_x += section.moment[i] * cosine[i];
            sum_y += section.moment[i] * sine[i];
            stiffness += tubes.bending[i];
            const Length share = (1 / stiffness) * section.share[i];
            u_x[i] = share * sum_x;
            u_y[i] = share * sum_y;
        }
        for (int i = n_tubes - 1; i-- > 0;) {
            u_x[i] += u_x[i + 1];
            u_y[i] += u_y[i + 1];
        }
        shape.bend_x[j] = shape.h * u_x[0];
        shape.bend_y[j] = shape.h * u_y[0];
        for (int i = 0; i < n_tubes; ++i) {
            // m_i sum_j m_j sin(alpha_i - alpha_j) / sum E I, the sum written by u, over the parts that have tube i
            torque[i] -= shape.h * (section.moment[i] * (sine[i] * u_x[i] - cosine[i] * u_y[i]));
            angle[i] -= (0.5 / tubes.torsion[i]) * (shape.h * torque[i]);
        }
    }
    for (int i = 0; i < n_tubes; ++i) {
        shape.base_angle[i] = angle[i];
        shape.base_twist[i] = (1 / tubes.torsion[i]) * torque[i];
    }

    // The centre line, from the guide on.
    shape.points.resize(3 * (n + 1));
    shape.frames.resize(n);
    shape.guide = tubes.frame;
    shape.tilt = {parameters[tilt_0], parameters[tilt_0 + 1]};
    Mat3 frame = times(tubes.frame, rotation(shape.tilt[0], shape.tilt[1]));
    std::copy(tubes.entry.begin(), tubes.entry.end(), shape.points.begin());
    for (int j = 0; j < n; ++j) {
        shape.frames[j] = frame;
        const double a = shape.bend_x[j].value, b = shape.bend_y[j].value;
        const Vec3 step = times(frame, chord(a, b));
        for (int k = 0; k < 3; ++k)
            shape.points[3 * (j + 1) + k] = shape.points[3 * j + k] + shape.h.value * step[k];
        frame = times(frame, rotation(a, b));
    }
}

void pull(const Shape &shape, const double *forces, Parameters &gradient) {
    const int n = static_cast<int>(shape.frames.size());
    gradient.fill(0);
    // Force and moment, about the end of element j, of all that comes after it.
    Vec3 force{}, moment{};
    for (int j = n; j-- > 0;) {
        const double *end = &shape.points[3 * (j + 1)];
        for (int k = 0; k < 3; ++k)
            force[k] += forces[3 * (j + 1) + k];
        const double a = shape.bend_x[j].value, b = shape.bend_y[j].value, h = shape.h.value;
        const Arc arc(a * a + b * b);
        const Vec3 f = transposed_times(shape.frames[j], force);
        const std::array<double, 2> turn = turned(transposed_times(shape.frames[j], moment), a, b, arc);
        const double by_a = turn[0] + h * dot(f, {2 * a * b * arc.cosine_slope,
                                                    -arc.cosine - 2 * a * a * arc.cosine_slope, 2 * a * arc.sine_slope});
        const double by_b = turn[1] + h * dot(f, {arc.cosine + 2 * b * b * arc.cosine_slope,
                                                    -2 * a * b * arc.cosine_slope, 2 * b * arc.sine_slope});
        const double by_h = dot(f, {b * arc.cosine, -a * arc.cosine, arc.sine});
        for (int k = 0; k < tilt_0; ++k)
            gradient[k] += by_a * shape.bend_x[j].by[k] + by_b * shape.bend_y[j].by[k];
        gradient[end_0] += by_h * shape.h.by[end_0];
        const double *start = &shape.points[3 * j];
        const Vec3 twisting = cross({end[0] - start[0], end[1] - start[1], end[2] - start[2]}, force);
        for (int k = 0; k < 3; ++k)
            moment[k] += twisting[k];
    }
    const double a = shape.tilt[0], b = shape.tilt[1];
    const std::array<double, 2> turn = turned(transposed_times(shape.guide, moment), a, b, Arc(a * a + b * b));
    gradient[tilt_0] = turn[0];
    gradient[tilt_0 + 1] = turn[1];
}

double radius_at(const Tubes &tubes, const Parameters &parameters, double s) {
    double radius = tubes.radius[0];
    for (int i = 1; i < n_tubes; ++i)
        if (s <= parameters[end_0 + i])
            radius = std::max(radius, tubes.radius[i]);
    return radius;
}

void dense_points(const Tubes &tubes, const Parameters &parameters, const Shape &shape, int n_between, std::vector<double> &points,
                  std::vector<double> &radii) {
    const int n = static_cast<int>(shape.frames.size());
    for (int j = 0; j < n; ++j)
        for (int part = 0; part <= n_between; ++part) {
            const double share = static_cast<double>(part) / n_between;
            const Vec3 step = times(shape.frames[j], chord(share * shape.bend_x[j].value, share * shape.bend_y[j].value));
            for (int k = 0; k < 3; ++k)
                points.push_back(shape.points[3 * j + k] + share * shape.h.value * step[k]);
            radii.push_back(radius_at(tubes, parameters, (j + share) * shape.h.value));
        }
}

Vec3 rigid_tip(const Tubes &tubes, const Parameters &parameters) {
    std::vector<double> ends = {0};
    for (int i = 0; i < n_tubes; ++i)
        for (const double end : {parameters[end_0 + i], parameters[end_0 + i] - parameters[curved_0 + i]})
            if (end > 0 && end <= parameters[end_0])
                ends.push_back(end);
    std::sort(ends.begin(), ends.end());
    Mat3 frame = times(tubes.frame, rotation(parameters[tilt_0], parameters[tilt_0 + 1]));
    Vec3 point = tubes.entry;
    for (std::size_t k = 1; k < ends.size(); ++k) {
        const double middle = 0.5 * (ends[k - 1] + ends[k]), length = ends[k] - ends[k - 1];
        double stiffness = 0, x = 0, y = 0;
        for (int i = 0; i < n_tubes; ++i) {
            const double end = parameters[end_0 + i];
            if (middle > end)
                continue;
            stiffness += tubes.bending[i];
            if (middle > end - parameters[curved_0 + i]) {
                x += tubes.bending[i] * parameters[kappa_0 + i] * std::cos(parameters[psi_0 + i]);
                y += tubes.bending[i] * parameters[kappa_0 + i] * std::sin(parameters[psi_0 + i]);
            }
        }
        x /= stiffness;
        y /= stiffness;
        // An arc of curvature u turns about the axis (x, y, 0) / u, and runs in the plane across it.
        const double u = std::hypot(x, y), turn = u * length;
        const Vec3 axis = u > 0 ? Vec3{x / u, y / u, 0} : Vec3{1, 0, 0};
        const double across = u > 0 ? (1 - std::cos(turn)) / u : 0, along = u > 0 ? std::sin(turn) / u : length;
        const Vec3 step = times(frame, Vec3{axis[1] * across, -axis[0] * across, along});
        for (int i = 0; i < 3; ++i)
            point[i] += step[i];
        const double c = std::cos(turn), s = std::sin(turn), a = axis[0], b = axis[1];
        frame = times(frame, Mat3{c + a * a * (1 - c), a * b * (1 - c), b * s, a * b * (1 - c), c + b * b * (1 - c), -a * s,
                                  -b * s, a * s, c});
    }
    return point;
}
