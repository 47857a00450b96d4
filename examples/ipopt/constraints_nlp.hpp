// SPDX-License-Identifier: Apache-2.0 OR MIT
// A set of Keepout constraints as a problem for IPOPT: minimise sum w_k (x_k - target_k)^2 subject to values(x) >= least.
//
// Put an objective of your own into eval_f, eval_grad_f and eval_h; the rest stays. A point that Keepout refuses, one that is not finite or
// a quaternion of no length, is an evaluation that failed: `false`, which makes IPOPT try a shorter step.
#pragma once

#include <keepout.h>

#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpTNLP.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

class ConstraintsNlp : public Ipopt::TNLP {
public:
    using Index = Ipopt::Index;
    using Number = Ipopt::Number;

    ConstraintsNlp(const ko_constraints *constraints, double least, std::vector<double> weights, std::vector<double> targets,
                   std::vector<double> start)
        : x(std::move(start)), constraints_(constraints), least_(least), weights_(std::move(weights)), targets_(std::move(targets)) {
        if (ko_constraints_get_size(constraints_, &n_, &m_, &n_jacobian_, &n_hessian_) < 0)
            throw std::runtime_error(ko_last_error());
        if (x.size() != n_ || weights_.size() != n_ || targets_.size() != n_)
            throw std::runtime_error("start, weights and targets must have " + std::to_string(n_) + " entries, one a variable");
    }

    // The start, then the optimum, its values, and the multipliers of the Lagrangian f + multipliers . values.
    std::vector<double> x, values, multipliers;
    double objective = 0;
    int iterations = 0;
    std::string failure; // what Keepout said of the last point that it refused

    bool get_nlp_info(Index &n, Index &m, Index &nnz_jac_g, Index &nnz_h_lag, IndexStyleEnum &index_style) override {
        n = static_cast<Index>(n_);
        m = static_cast<Index>(m_);
        nnz_jac_g = static_cast<Index>(n_jacobian_);
        nnz_h_lag = static_cast<Index>(n_hessian_ + n_); // the constraints' entries, then the objective's diagonal: IPOPT adds them up
        index_style = C_STYLE;
        return true;
    }

    bool get_bounds_info(Index, Number *x_l, Number *x_u, Index, Number *g_l, Number *g_u) override {
        std::fill_n(x_l, n_, -2e19);
        std::fill_n(x_u, n_, 2e19);
        std::fill_n(g_l, m_, least_);
        std::fill_n(g_u, m_, 2e19);
        return true;
    }

    bool get_starting_point(Index, bool, Number *start, bool, Number *, Number *, Index, bool, Number *) override {
        std::copy(x.begin(), x.end(), start);
        return true;
    }

    bool eval_f(Index, const Number *at, bool, Number &f) override {
        f = 0;
        for (std::size_t k = 0; k < n_; ++k)
            f += weights_[k] * (at[k] - targets_[k]) * (at[k] - targets_[k]);
        return true;
    }

    bool eval_grad_f(Index, const Number *at, bool, Number *gradient) override {
        for (std::size_t k = 0; k < n_; ++k)
            gradient[k] = 2 * weights_[k] * (at[k] - targets_[k]);
        return true;
    }

    bool eval_g(Index, const Number *at, bool, Index, Number *g) override {
        return took(ko_constraints_values(constraints_, at, n_, m_, g));
    }

    bool eval_jac_g(Index, const Number *at, bool, Index, Index, Index *rows, Index *columns, Number *entries) override {
        if (entries == nullptr)
            return took(ko_constraints_jacobian_pattern(constraints_, n_jacobian_, rows, columns));
        return took(ko_constraints_jacobian(constraints_, at, n_, n_jacobian_, entries));
    }

    bool eval_h(Index, const Number *at, bool, Number factor, Index, const Number *lambda, bool, Index, Index *rows, Index *columns,
                Number *entries) override {
        for (std::size_t k = 0; k < n_; ++k) {
            if (entries == nullptr)
                rows[n_hessian_ + k] = columns[n_hessian_ + k] = static_cast<Index>(k);
            else
                entries[n_hessian_ + k] = 2 * factor * weights_[k];
        }
        if (entries == nullptr)
            return took(ko_constraints_hessian_pattern(constraints_, n_hessian_, rows, columns));
        return took(ko_constraints_hessian(constraints_, at, n_, lambda, m_, n_hessian_, entries));
    }

    bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number, Number, Number, Number, Number, Number, Number, Number, Index,
                               const Ipopt::IpoptData *, Ipopt::IpoptCalculatedQuantities *) override {
        iterations = iteration;
        return true;
    }

    void finalize_solution(Ipopt::SolverReturn, Index, const Number *at, const Number *, const Number *, Index, const Number *g,
                           const Number *lambda, Number f, const Ipopt::IpoptData *, Ipopt::IpoptCalculatedQuantities *) override {
        x.assign(at, at + n_);
        values.assign(g, g + m_);
        multipliers.assign(lambda, lambda + m_);
        objective = f;
    }

private:
    bool took(std::int32_t status) {
        if (status < 0)
            failure = ko_last_error();
        return status >= 0;
    }

    const ko_constraints *constraints_;
    std::size_t n_ = 0, m_ = 0, n_jacobian_ = 0, n_hessian_ = 0;
    double least_;
    std::vector<double> weights_, targets_;
};
