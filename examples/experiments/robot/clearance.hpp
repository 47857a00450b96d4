// SPDX-License-Identifier: Apache-2.0 OR MIT
// Two formulations of "outside the anatomy", behind one door: the field, and Lin's sum over the points of the anatomy.
#pragma once

#include <keepout.hpp>

#include <ctime>
#include <utility>
#include <vector>

class Clearance {
public:
    virtual ~Clearance() = default;

    // Values [n] and gradients [3 x n] at points [3 x n], positive outside the anatomy [mm]; timed.
    void eval(const std::vector<double> &points, std::vector<double> &values, std::vector<double> &gradients) {
        const std::clock_t begin = std::clock();
        values.resize(points.size() / 3);
        gradients.resize(points.size());
        at(points, values, gradients);
        seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    }

    double seconds = 0; // of the processor

private:
    virtual void at(const std::vector<double> &points, std::vector<double> &values, std::vector<double> &gradients) const = 0;
};

class FieldClearance : public Clearance {
public:
    explicit FieldClearance(keepout::Field field) : field_(std::move(field)) {}

private:
    void at(const std::vector<double> &points, std::vector<double> &values, std::vector<double> &gradients) const override {
        field_.eval(points, values, gradients);
    }

    keepout::Field field_;
};

class LinClearance : public Clearance {
public:
    explicit LinClearance(keepout::Explicit formula) : formula_(std::move(formula)) {}

private:
    void at(const std::vector<double> &points, std::vector<double> &values, std::vector<double> &gradients) const override {
        formula_.eval(points, values, gradients);
    }

    keepout::Explicit formula_;
};

// KS from below, the least of values as one number that can be differentiated.
struct LeastOf {
    keepout::Aggregation options;
    double unit; // D, the anatomy's diagonal

    LeastOf(double diagonal, double sharpness) : unit(diagonal) { options.sharpness = sharpness; }

    double operator()(keepout::Span<const double> values, keepout::Span<double> weights) const {
        return keepout::aggregate(options, KO_LEAST, unit, values, weights);
    }
};
