// SPDX-License-Identifier: Apache-2.0 OR MIT
// An optimisation problem whose objective and constraints come from one computation, and IPOPT's way of solving it. What constraints_nlp.hpp
// of examples/ipopt does for ko_constraints, for values that a model stands in front of.
#pragma once

#include <keepout.hpp>

#include <IpIpoptApplication.hpp>
#include <IpIpoptData.hpp>
#include <IpTNLP.hpp>

#include <algorithm>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

constexpr double unbounded = 2e19; // IPOPT's infinity

struct Bounds {
    double low, high;
};

class Problem {
public:
    virtual ~Problem() = default;

    std::vector<Bounds> variables, constraints;
    std::vector<int> rows, columns; // of the Jacobian's entries

    // At the x of the last update.
    double objective = 0;
    std::vector<double> gradient, values, entries;

    int n_evaluations = 0; // of all the above

    void update(const double *x) {
        if (!at_.empty() && std::equal(at_.begin(), at_.end(), x))
            return;
        at_.clear(); // none, where the computation fails
        ++n_evaluations;
        compute(x);
        at_.assign(x, x + variables.size());
    }

protected:
    // An entry of the Jacobian: its place in `entries`.
    std::size_t add_entry(std::size_t row, std::size_t column) {
        rows.push_back(static_cast<int>(row));
        columns.push_back(static_cast<int>(column));
        entries.push_back(0);
        return entries.size() - 1;
    }

private:
    virtual void compute(const double *x) = 0;

    std::vector<double> at_;
};

class ProblemNlp : public Ipopt::TNLP {
public:
    using Index = Ipopt::Index;
    using Number = Ipopt::Number;

    ProblemNlp(Problem &problem, std::vector<double> start) : x(std::move(start)), problem_(problem) {}

    std::vector<double> x; // the start, then the optimum
    int iterations = 0;
    std::string failure;

    bool get_nlp_info(Index &n, Index &m, Index &nnz_jac_g, Index &nnz_h_lag, IndexStyleEnum &index_style) override {
        n = static_cast<Index>(problem_.variables.size());
        m = static_cast<Index>(problem_.constraints.size());
        nnz_jac_g = static_cast<Index>(problem_.entries.size());
        nnz_h_lag = 0; // limited memory
        index_style = C_STYLE;
        return true;
    }

    bool get_bounds_info(Index, Number *x_l, Number *x_u, Index, Number *g_l, Number *g_u) override {
        for (const Bounds &bounds : problem_.variables) {
            *x_l++ = bounds.low;
            *x_u++ = bounds.high;
        }
        for (const Bounds &bounds : problem_.constraints) {
            *g_l++ = bounds.low;
            *g_u++ = bounds.high;
        }
        return true;
    }

    bool get_starting_point(Index, bool, Number *start, bool, Number *, Number *, Index, bool, Number *) override {
        std::copy(x.begin(), x.end(), start);
        return true;
    }

    bool eval_f(Index, const Number *at, bool, Number &f) override {
        return updated(at) && (f = problem_.objective, true);
    }

    bool eval_grad_f(Index, const Number *at, bool, Number *gradient) override {
        return updated(at) && (std::copy(problem_.gradient.begin(), problem_.gradient.end(), gradient), true);
    }

    bool eval_g(Index, const Number *at, bool, Index, Number *g) override {
        return updated(at) && (std::copy(problem_.values.begin(), problem_.values.end(), g), true);
    }

    bool eval_jac_g(Index, const Number *at, bool, Index, Index, Index *rows, Index *columns, Number *entries) override {
        if (entries == nullptr) {
            std::copy(problem_.rows.begin(), problem_.rows.end(), rows);
            std::copy(problem_.columns.begin(), problem_.columns.end(), columns);
            return true;
        }
        return updated(at) && (std::copy(problem_.entries.begin(), problem_.entries.end(), entries), true);
    }

    bool intermediate_callback(Ipopt::AlgorithmMode, Index iteration, Number, Number, Number, Number, Number, Number, Number, Number, Index,
                               const Ipopt::IpoptData *, Ipopt::IpoptCalculatedQuantities *) override {
        iterations = iteration;
        return true;
    }

    void finalize_solution(Ipopt::SolverReturn, Index n, const Number *at, const Number *, const Number *, Index, const Number *,
                           const Number *, Number, const Ipopt::IpoptData *, Ipopt::IpoptCalculatedQuantities *) override {
        x.assign(at, at + n);
    }

private:
    // An exception must not pass IPOPT's frames; `false` makes it try a shorter step.
    bool updated(const Number *at) {
        try {
            problem_.update(at);
            return true;
        } catch (const keepout::Error &error) {
            failure = error.what();
            return false;
        }
    }

    Problem &problem_;
};

struct Solution {
    std::vector<double> x;
    Ipopt::ApplicationReturnStatus status;
    int iterations, evaluations;
    double seconds; // of the processor
    std::string failure;

    bool solved() const { return status == Ipopt::Solve_Succeeded; }
};

inline Solution solve_by_ipopt(Problem &problem, const std::vector<double> &start, int print_level = 0) {
    Ipopt::SmartPtr<ProblemNlp> nlp = new ProblemNlp(problem, start);
    Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt = new Ipopt::IpoptApplication();
    ipopt->Options()->SetStringValue("hessian_approximation", "limited-memory");
    ipopt->Options()->SetStringValue("sb", "yes"); // no banner
    ipopt->Options()->SetIntegerValue("print_level", print_level);
    ipopt->Options()->SetNumericValue("tol", 1e-5);
    ipopt->Options()->SetNumericValue("acceptable_tol", 1e-5); // nothing less
    ipopt->Options()->SetIntegerValue("max_iter", 2000);
    ipopt->Initialize();
    const std::clock_t begin = std::clock();
    const Ipopt::ApplicationReturnStatus status = ipopt->OptimizeTNLP(nlp);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    return {nlp->x, status, nlp->iterations, problem.n_evaluations, seconds, nlp->failure};
}
