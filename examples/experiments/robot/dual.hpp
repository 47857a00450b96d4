// SPDX-License-Identifier: Apache-2.0 OR MIT
// A number with its derivatives by n variables, which go along with it.
#pragma once

#include <array>
#include <cmath>

template <int n>
struct Dual {
    double value = 0;
    std::array<double, n> by{};

    Dual() = default;
    Dual(double constant) : value(constant) {}

    static Dual variable(double value, int number) {
        Dual made(value);
        made.by[number] = 1;
        return made;
    }

    // f(this), of value f and derivative slope there.
    Dual chained(double f, double slope) const {
        Dual made(f);
        for (int k = 0; k < n; ++k)
            made.by[k] = slope * by[k];
        return made;
    }

    Dual &operator+=(const Dual &b) {
        value += b.value;
        for (int k = 0; k < n; ++k)
            by[k] += b.by[k];
        return *this;
    }

    Dual &operator-=(const Dual &b) {
        value -= b.value;
        for (int k = 0; k < n; ++k)
            by[k] -= b.by[k];
        return *this;
    }
};

template <int n>
Dual<n> operator+(Dual<n> a, const Dual<n> &b) {
    return a += b;
}

template <int n>
Dual<n> operator-(Dual<n> a, const Dual<n> &b) {
    return a -= b;
}

template <int n>
Dual<n> operator*(const Dual<n> &a, const Dual<n> &b) {
    Dual<n> made(a.value * b.value);
    for (int k = 0; k < n; ++k)
        made.by[k] = a.by[k] * b.value + a.value * b.by[k];
    return made;
}

template <int n>
Dual<n> operator*(double a, const Dual<n> &b) {
    return b.chained(a * b.value, a);
}

template <int n>
Dual<n> operator/(const Dual<n> &a, const Dual<n> &b) {
    Dual<n> made(a.value / b.value);
    for (int k = 0; k < n; ++k)
        made.by[k] = (a.by[k] - made.value * b.by[k]) / b.value;
    return made;
}

// A step from 0 to 1 at x = 0, about `width` to either side: 1 / (1 + exp(-x / width)).
template <int n>
Dual<n> smooth_step(const Dual<n> &x, double width) {
    const double s = 1 / (1 + std::exp(-x.value / width));
    return x.chained(s, s * (1 - s) / width);
}
