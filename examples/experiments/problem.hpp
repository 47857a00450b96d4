// SPDX-License-Identifier: Apache-2.0 OR MIT
// What the experiments share: a problem for IPOPT with an objective and constraints of its own beside Keepout's, the checks of its
// derivatives and of its optimum, and the table at the end.
#pragma once

#include "../ipopt/constraints_nlp.hpp"

#include <keepout.hpp>

#include <IpIpoptApplication.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

constexpr double unbounded = 2e19; // what IPOPT takes for infinite

inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Minimises objective(x) with Keepout's values at or above `least`, values of its own within bounds, and some variables held.
class Problem : public ConstraintsNlp {
public:
    struct Entry {
        Index row, column; // of a Hessian in the lower triangle
    };

    // The objective of ConstraintsNlp has weights of 0, and adds nothing.
    Problem(const keepout::Constraints &kept, std::vector<double> least, const std::vector<double> &start)
        : ConstraintsNlp(kept.get(), 0, std::vector<double>(start.size()), start, start), held(start.size()), lower_(std::move(least)),
          upper_(lower_.size(), unbounded), kept_(kept.size()) {}

    std::vector<char> held; // variables that stay where they start

    // The objective; its gradient where that is not null.
    virtual double objective_at(const double *x, double *gradient) const = 0;
    // Own values, their Jacobian's entries, and those of the Hessian of factor * objective + lambda . own values.
    virtual void own_values(const double *, double *) const {}
    virtual void own_jacobian(const double *, double *) const {}
    virtual void own_hessian(const double *x, double factor, const double *lambda, double *entries) const = 0;

    std::size_t n_values() const { return lower_.size(); }
    std::size_t n_held() const { return static_cast<std::size_t>(std::count(held.begin(), held.end(), 1)); }

    bool get_nlp_info(Index &n, Index &m, Index &nnz_jac_g, Index &nnz_h_lag, IndexStyleEnum &index_style) override {
        ConstraintsNlp::get_nlp_info(n, m, nnz_jac_g, nnz_h_lag, index_style);
        n_hessian_ = static_cast<std::size_t>(nnz_h_lag);
        m = static_cast<Index>(lower_.size());
        nnz_jac_g += static_cast<Index>(own_jacobian_.size());
        nnz_h_lag += static_cast<Index>(own_hessian_.size());
        return true;
    }

    bool get_bounds_info(Index n, Number *x_l, Number *x_u, Index m, Number *g_l, Number *g_u) override {
        for (Index k = 0; k < n; ++k) {
            x_l[k] = held[k] ? x[k] : -unbounded;
            x_u[k] = held[k] ? x[k] : unbounded;
        }
        std::copy_n(lower_.begin(), m, g_l);
        std::copy_n(upper_.begin(), m, g_u);
        return true;
    }

    bool eval_f(Index, const Number *at, bool, Number &f) override {
        f = objective_at(at, nullptr);
        return true;
    }

    bool eval_grad_f(Index, const Number *at, bool, Number *gradient) override {
        objective_at(at, gradient);
        return true;
    }

    bool eval_g(Index n, const Number *at, bool is_new, Index, Number *g) override {
        own_values(at, g + kept_.n_values);
        return ConstraintsNlp::eval_g(n, at, is_new, static_cast<Index>(kept_.n_values), g);
    }

    bool eval_jac_g(Index n, const Number *at, bool is_new, Index, Index count, Index *rows, Index *columns, Number *entries) override {
        if (entries != nullptr)
            own_jacobian(at, entries + kept_.n_jacobian);
        for (std::size_t k = 0; entries == nullptr && k < own_jacobian_.size(); ++k) {
            rows[kept_.n_jacobian + k] = own_jacobian_[k].row + static_cast<Index>(kept_.n_values);
            columns[kept_.n_jacobian + k] = own_jacobian_[k].column;
        }
        return ConstraintsNlp::eval_jac_g(n, at, is_new, static_cast<Index>(kept_.n_values), count, rows, columns, entries);
    }

    bool eval_h(Index n, const Number *at, bool is_new, Number factor, Index, const Number *lambda, bool is_new_lambda, Index count,
                Index *rows, Index *columns, Number *entries) override {
        if (entries != nullptr)
            own_hessian(at, factor, lambda + kept_.n_values, entries + n_hessian_);
        for (std::size_t k = 0; entries == nullptr && k < own_hessian_.size(); ++k) {
            rows[n_hessian_ + k] = own_hessian_[k].row;
            columns[n_hessian_ + k] = own_hessian_[k].column;
        }
        return ConstraintsNlp::eval_h(n, at, is_new, factor, static_cast<Index>(kept_.n_values), lambda, is_new_lambda, count, rows,
                                      columns, entries);
    }

    bool intermediate_callback(Ipopt::AlgorithmMode mode, Index iteration, Number f, Number missed, Number slope, Number mu, Number step,
                               Number regularisation, Number alpha_dual, Number alpha_primal, Index trials, const Ipopt::IpoptData *data,
                               Ipopt::IpoptCalculatedQuantities *quantities) override {
        if (iteration % 20 == 0) {
            std::printf("  iteration %4d: objective %12.6f, missed by %.1e, dual %.1e\n", iteration, f, missed, slope);
            std::fflush(stdout);
        }
        return ConstraintsNlp::intermediate_callback(mode, iteration, f, missed, slope, mu, step, regularisation, alpha_dual, alpha_primal,
                                                     trials, data, quantities);
    }

    void finalize_solution(Ipopt::SolverReturn status, Index n, const Number *at, const Number *z_l, const Number *z_u, Index m,
                           const Number *g, const Number *lambda, Number f, const Ipopt::IpoptData *data,
                           Ipopt::IpoptCalculatedQuantities *quantities) override {
        ConstraintsNlp::finalize_solution(status, n, at, z_l, z_u, m, g, lambda, f, data, quantities);
        values.assign(g, g + m);
        multipliers.assign(lambda, lambda + m);
    }

    // Of the Lagrangian factor * objective + lambda . values.
    std::vector<double> lagrangian_gradient(const std::vector<double> &at, double factor, const std::vector<double> &lambda) {
        const Sizes s = sizes();
        std::vector<double> gradient(at.size()), entries(s.n_jacobian);
        std::vector<Index> rows(s.n_jacobian), columns(s.n_jacobian);
        eval_grad_f(s.n, at.data(), true, gradient.data());
        for (double &entry : gradient)
            entry *= factor;
        eval_jac_g(s.n, nullptr, false, s.m, s.n_jacobian, rows.data(), columns.data(), nullptr);
        if (!eval_jac_g(s.n, at.data(), true, s.m, s.n_jacobian, nullptr, nullptr, entries.data()))
            throw std::runtime_error(failure);
        for (Index k = 0; k < s.n_jacobian; ++k)
            gradient[columns[k]] += lambda[rows[k]] * entries[k];
        return gradient;
    }

    // How far x is from an optimum, by the Karush-Kuhn-Tucker conditions: the gradient of the Lagrangian by what is not held, values out of
    // their bounds, multipliers of the wrong sign, and those of values that are at no bound.
    double kkt_residual() {
        std::vector<double> g(lower_.size());
        const std::vector<double> gradient = lagrangian_gradient(x, 1, multipliers);
        if (!eval_g(static_cast<Index>(x.size()), x.data(), true, static_cast<Index>(g.size()), g.data()))
            throw std::runtime_error(failure);
        double residual = 0;
        for (std::size_t k = 0; k < x.size(); ++k)
            residual = std::max(residual, held[k] ? 0 : std::fabs(gradient[k]));
        for (std::size_t i = 0; i < g.size(); ++i) {
            residual = std::max({residual, lower_[i] - g[i], g[i] - upper_[i]});
            if (lower_[i] == upper_[i])
                continue; // an equation: its multiplier is free
            // Above 0 it holds g at its upper limit, below 0 at its lower one.
            const double m = multipliers[i], limit = m > 0 ? upper_[i] : lower_[i];
            residual = std::max(residual, std::fabs(limit) < unbounded ? std::fabs(m * (g[i] - limit)) : std::fabs(m));
        }
        return residual;
    }

    // How far gradient and Hessian of the Lagrangian, with random multipliers, differ from central differences along random directions at
    // x, over the largest that was found; x is of the order of `unit`.
    std::pair<double, double> derivative_errors(double unit) {
        const Sizes s = sizes();
        std::mt19937 random(1);
        const auto draw = [&] { return random() / 2147483648.0 - 1; };
        std::vector<double> lambda(s.m), entries(s.n_hessian);
        for (double &entry : lambda)
            entry = draw();
        std::vector<Index> rows(s.n_hessian), columns(s.n_hessian);
        eval_h(s.n, nullptr, false, 1, s.m, nullptr, false, s.n_hessian, rows.data(), columns.data(), nullptr);
        eval_h(s.n, x.data(), true, 1, s.m, lambda.data(), true, s.n_hessian, nullptr, nullptr, entries.data());
        const std::vector<double> gradient = lagrangian_gradient(x, 1, lambda);
        double first = 0, first_scale = 0, second = 0, second_scale = 0;
        for (int trial = 0; trial < 5; ++trial) {
            const double step = 1e-6 * unit;
            std::vector<double> v(x.size()), product(x.size()), above = x, below = x;
            double slope = 0;
            for (std::size_t k = 0; k < x.size(); ++k) {
                v[k] = draw();
                above[k] += step * v[k];
                below[k] -= step * v[k];
                slope += gradient[k] * v[k];
            }
            for (Index k = 0; k < s.n_hessian; ++k) {
                product[rows[k]] += entries[k] * v[columns[k]];
                if (rows[k] != columns[k])
                    product[columns[k]] += entries[k] * v[rows[k]];
            }
            const double rise = (lagrangian(above, lambda) - lagrangian(below, lambda)) / (2 * step);
            first = std::max(first, std::fabs(rise - slope));
            first_scale = std::max(first_scale, std::fabs(slope));
            const std::vector<double> g_above = lagrangian_gradient(above, 1, lambda), g_below = lagrangian_gradient(below, 1, lambda);
            for (std::size_t k = 0; k < x.size(); ++k) {
                second = std::max(second, std::fabs((g_above[k] - g_below[k]) / (2 * step) - product[k]));
                second_scale = std::max(second_scale, std::fabs(product[k]));
            }
        }
        return {first / first_scale, second / second_scale};
    }

protected:
    // Own values are added with their bounds, then the places of entries in the Jacobian, rows counted from the first own value.
    void add_own_value(double lower, double upper) {
        lower_.push_back(lower);
        upper_.push_back(upper);
    }

    std::vector<Entry> own_jacobian_, own_hessian_;

private:
    struct Sizes {
        Index n, m, n_jacobian, n_hessian;
    };

    Sizes sizes() {
        Sizes s;
        IndexStyleEnum style;
        get_nlp_info(s.n, s.m, s.n_jacobian, s.n_hessian, style);
        return s;
    }

    double lagrangian(const std::vector<double> &at, const std::vector<double> &lambda) {
        std::vector<double> g(lambda.size());
        double sum = objective_at(at.data(), nullptr);
        if (!eval_g(static_cast<Index>(at.size()), at.data(), true, static_cast<Index>(g.size()), g.data()))
            throw std::runtime_error(failure);
        for (std::size_t i = 0; i < g.size(); ++i)
            sum += lambda[i] * g[i];
        return sum;
    }

    std::vector<double> lower_, upper_;
    keepout::Constraints::Size kept_;
    std::size_t n_hessian_ = 0; // entries of ConstraintsNlp
};

// What an experiment found. Lengths are in `unit`, `scale` times what they are in the problem; `field` is what the fields say of the
// clearance at the optimum, `exact` what the shapes say.
struct Outcome {
    std::string name, unit;
    double scale = 1;
    std::size_t n_unknowns = 0, n_values = 0;
    int iterations = 0;
    double seconds_fit = 0, seconds_solve = 0, start = 0, field = 0, exact = 0, wanted = 0, kkt = 0;
    bool solved = false;
};

constexpr double kkt_limit = 1e-6;

// By IPOPT with exact Hessians, once the derivatives are checked; x is of the order of `unit`.
inline void solve(const Ipopt::SmartPtr<Problem> &problem, double unit, Outcome &outcome) {
    const auto [first, second] = problem->derivative_errors(unit);
    std::printf("Derivatives differ from differences by %.1e, second ones by %.1e of the largest\n", first, second);
    std::fflush(stdout);

    Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication();
    ipopt->Options()->SetStringValue("sb", "yes"); // no banner
    ipopt->Options()->SetIntegerValue("print_level", 0);
    ipopt->Options()->SetStringValue("mu_strategy", "adaptive");
    ipopt->Options()->SetNumericValue("tol", 1e-8);
    ipopt->Options()->SetNumericValue("acceptable_tol", 1e-8); // nothing less
    ipopt->Options()->SetIntegerValue("max_iter", 1000);
    ipopt->Initialize();
    const double begin = processor_seconds();
    const Ipopt::ApplicationReturnStatus status = ipopt->OptimizeTNLP(problem);
    outcome.seconds_solve = processor_seconds() - begin;
    outcome.n_unknowns = problem->x.size() - problem->n_held();
    outcome.n_values = problem->n_values();
    outcome.iterations = problem->iterations;
    if (problem->multipliers.size() == problem->n_values())
        outcome.kkt = problem->kkt_residual();
    else
        outcome.kkt = std::numeric_limits<double>::infinity();
    outcome.solved = status == Ipopt::Solve_Succeeded && first < 1e-5 && second < 1e-4;
    std::printf("IPOPT ends with status %d after %d iterations%s%s\n", status, problem->iterations,
                problem->failure.empty() ? "" : "; of a point on the way Keepout said: ", problem->failure.c_str());
}

// Prints the table. True where the start was in collision, the end is an optimum, and exactly as clear as it was to be.
inline bool report(const Outcome &o) {
    std::printf("\n| problem | unknowns | constraints | iterations | fit | solve | exact at the start | by the field | exact | wanted "
                "| KKT |\n"
                "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n"
                "| %s | %zu | %zu | %d | %.2f s | %.2f s | %.4f %s | %.4f %s | %.4f %s | > %.4f %s | %.1e |\n\n",
                o.name.c_str(), o.n_unknowns, o.n_values, o.iterations, o.seconds_fit, o.seconds_solve, o.start, o.unit.c_str(), o.field,
                o.unit.c_str(), o.exact, o.unit.c_str(), o.wanted, o.unit.c_str(), o.kkt);
    if (!o.solved)
        std::printf("NOT solved.\n");
    if (!(o.start < 0))
        std::printf("NOT a start in collision.\n");
    if (!(o.kkt < kkt_limit))
        std::printf("NOT an optimum: the KKT residual is above %.0e.\n", kkt_limit);
    if (!(o.exact > o.wanted))
        std::printf("NOT clear.\n");
    const bool good = o.solved && o.start < 0 && o.kkt < kkt_limit && o.exact > o.wanted;
    if (good)
        std::printf("An optimum, clear by the exact shape.\n");
    return good;
}

// The folder of data, and the file of a picture or nothing, from a program's arguments.
struct Arguments {
    std::string data, picture;

    // `file` is one that the program reads; null: it reads none.
    Arguments(int argc, char **argv, const char *file) : data(argc > 1 ? argv[1] : ""), picture(argc > 2 ? argv[2] : "") {
        if (file == nullptr)
            return;
        std::FILE *found = std::fopen((data + "/" + file).c_str(), "rb");
        if (found == nullptr)
            throw std::runtime_error("there is no " + std::string(file) + " in the folder of data, '" + data +
                                     "'; call with the folder, then a picture.svg if one is wanted");
        std::fclose(found);
    }
};

// The options of all fits here: one thread, so that processor time is time.
inline keepout::FitOptions fit_options(std::int32_t feasible) {
    keepout::FitOptions options;
    options.feasible = feasible;
    options.n_threads = 1;
    return options;
}

// Of `n_points` points of `mesh`, lengths in the outcome's unit; tells of it, and adds its time.
inline keepout::Field fit(const char *name, const keepout::Mesh &mesh, std::size_t n_points, const keepout::FitOptions &options,
                          Outcome &outcome) {
    std::printf("Fitting %s ...\n", name);
    std::fflush(stdout);
    const double begin = processor_seconds();
    keepout::Field field = keepout::Field::fit(mesh.sample(n_points, /*seed*/ 1), options);
    outcome.seconds_fit += processor_seconds() - begin;
    const ko_fit_report report = field.report();
    std::printf("  %llu control points, %.5f %s from the shape at most, %.5f %s RMS\n", static_cast<unsigned long long>(report.n_unknowns),
                report.max * report.diagonal * outcome.scale, outcome.unit.c_str(), report.rms * report.diagonal * outcome.scale,
                outcome.unit.c_str());
    return field;
}
