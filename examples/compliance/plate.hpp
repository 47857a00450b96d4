// SPDX-License-Identifier: Apache-2.0 OR MIT
// A plate in plane stress, an element a cell: stiffness by density (SIMP), compliance and its gradient.
#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

// Cells are numbered as Keepout's: `columns` along x, and within each `rows` along y. So are nodes, rows + 1 in a column; each has two degrees
// of freedom, x and y.
class Plate {
public:
    struct Force {
        std::size_t node;
        double x, y;
    };

    // `held` nodes do not move.
    Plate(std::size_t columns, std::size_t rows, const std::vector<std::size_t> &held, const std::vector<Force> &forces)
        : columns_(columns), rows_(rows), free_(2 * n_nodes(), NO), element_(element()) {
        std::vector<bool> is_held(n_nodes());
        for (const std::size_t node : held) is_held[node] = true;
        Eigen::Index n = 0;
        for (std::size_t node = 0; node < n_nodes(); ++node)
            for (std::size_t a = 0; a < 2; ++a)
                if (!is_held[node]) free_[2 * node + a] = n++;
        forces_ = Eigen::VectorXd::Zero(n);
        for (const Force &force : forces) {
            forces_[free_[2 * force.node]] += force.x;
            forces_[free_[2 * force.node + 1]] += force.y;
        }
    }

    std::size_t node(std::size_t column, std::size_t row) const { return column * (rows_ + 1) + row; }

    // f^T u for `densities` [n_cells]; `gradient` [n_cells] is its derivative.
    double compliance(const std::vector<double> &densities, std::vector<double> &gradient) {
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(64 * densities.size());
        for (std::size_t cell = 0; cell < densities.size(); ++cell) {
            const auto at = freedoms(cell);
            const double stiff = stiffness(densities[cell]);
            for (std::size_t i = 0; i < 8; ++i)
                for (std::size_t j = 0; j < 8; ++j)
                    if (at[i] != NO && at[j] != NO) entries.emplace_back(at[i], at[j], stiff * element_[i][j]);
        }
        Eigen::SparseMatrix<double> matrix(forces_.size(), forces_.size());
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (!analysed_) solver_.analyzePattern(matrix);
        analysed_ = true;
        solver_.factorize(matrix);
        if (solver_.info() != Eigen::Success) throw std::runtime_error("the plate's stiffness is singular");
        const Eigen::VectorXd moved = solver_.solve(forces_);
        gradient.resize(densities.size());
        for (std::size_t cell = 0; cell < densities.size(); ++cell) {
            const auto at = freedoms(cell);
            double energy = 0;
            for (std::size_t i = 0; i < 8; ++i)
                for (std::size_t j = 0; j < 8; ++j)
                    if (at[i] != NO && at[j] != NO) energy += moved[at[i]] * element_[i][j] * moved[at[j]];
            // du = -K^-1 dK u
            gradient[cell] = -(1 - SOFTEST) * 3 * densities[cell] * densities[cell] * energy;
        }
        return forces_.dot(moved);
    }

private:
    static constexpr Eigen::Index NO = -1;
    static constexpr double SOFTEST = 1e-6, POISSON = 0.3;

    std::size_t n_nodes() const { return (columns_ + 1) * (rows_ + 1); }
    static double stiffness(double density) { return SOFTEST + (1 - SOFTEST) * density * density * density; }

    // Counter-clockwise from the corner with the smallest coordinates.
    std::array<Eigen::Index, 8> freedoms(std::size_t cell) const {
        const std::size_t column = cell / rows_, row = cell % rows_;
        const std::size_t nodes[4] = {node(column, row), node(column + 1, row), node(column + 1, row + 1), node(column, row + 1)};
        std::array<Eigen::Index, 8> at{};
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t a = 0; a < 2; ++a) at[2 * k + a] = free_[2 * nodes[k] + a];
        return at;
    }

    // The bilinear square's stiffness, modulus 1, integrated by 2 x 2 Gauss points, which is exact.
    static std::array<std::array<double, 8>, 8> element() {
        std::array<std::array<double, 8>, 8> matrix{};
        const double signs[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, at = 1 / std::sqrt(3.0), d = 1 / (1 - POISSON * POISSON);
        const double law[3][3] = {{d, d * POISSON, 0}, {d * POISSON, d, 0}, {0, 0, 0.5 * d * (1 - POISSON)}};
        for (const auto &gauss : signs) {
            double strain[3][8] = {};
            for (int k = 0; k < 4; ++k) {
                const double by_x = 0.5 * signs[k][0] * (1 + signs[k][1] * at * gauss[1]);
                const double by_y = 0.5 * signs[k][1] * (1 + signs[k][0] * at * gauss[0]);
                strain[0][2 * k] = strain[2][2 * k + 1] = by_x;
                strain[1][2 * k + 1] = strain[2][2 * k] = by_y;
            }
            for (std::size_t i = 0; i < 8; ++i)
                for (std::size_t j = 0; j < 8; ++j)
                    for (int p = 0; p < 3; ++p)
                        for (int q = 0; q < 3; ++q) matrix[i][j] += 0.25 * strain[p][i] * law[p][q] * strain[q][j];
        }
        return matrix;
    }

    std::size_t columns_, rows_;
    std::vector<Eigen::Index> free_;
    std::array<std::array<double, 8>, 8> element_;
    Eigen::VectorXd forces_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
    bool analysed_ = false;
};
