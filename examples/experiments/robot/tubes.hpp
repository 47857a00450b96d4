// SPDX-License-Identifier: Apache-2.0 OR MIT
// A robot of three concentric tubes: its shape, and the derivatives of anything that depends on its shape.
//
//   s         length along the robot from the entry, where the tubes leave a straight guide; l_i is where tube i ends, l_0 the largest
//   kappa_i   precurvature of the last c_i of tube i; before that it is straight
//   alpha_i   angle of tube i about the centre line, psi_i that at the robot's tip
//   E_i I_i, G_i J_i   stiffness in bending and torsion
//   u         curvature of the centre line, in its Bishop frame R: R' = R [u]_x, p' = R e_3
//
// After Rucker, Jones and Webster 2010 and Dupont, Lock, Itkowitz and Butler 2010, no external load:
//
//   compliant   G_i J_i alpha_i'' = m_i sum_j m_j sin(alpha_i - alpha_j) / sum_j E_j I_j,  m_i = E_i I_i kappa_i,  alpha_i' = 0 at l_i
//               u = sum_i m_i (cos alpha_i, sin alpha_i) / sum_i E_i I_i                                                -> solve()
//   rigid       alpha_i constant: arcs of constant curvature between ends of tubes and of their straight parts          -> rigid_shape()
//
// The angles at the tip are the variables, not those at the base: from the tip on, where nothing twists, the boundary value problem is an
// initial value problem, with one solution where a base angle may have several. The base angles are results.
#pragma once

#include "dual.hpp"

#include <array>
#include <vector>

constexpr int n_tubes = 3;

using Vec3 = std::array<double, 3>;
using Mat3 = std::array<double, 9>; // row-major

// What a shape depends on, in this order: curvatures [1/mm], curved lengths [mm], tip angles, ends [mm], tilt of the guide about the
// entry's first two axes.
constexpr int kappa_0 = 0, curved_0 = n_tubes, psi_0 = 2 * n_tubes, end_0 = 3 * n_tubes, tilt_0 = 4 * n_tubes;
constexpr int n_parameters = 4 * n_tubes + 2;
using Parameters = std::array<double, n_parameters>;

// All but the tilt, which turns the robot as a whole.
using Length = Dual<4 * n_tubes>;

// What no optimisation changes. Tube 0 is the innermost.
struct Tubes {
    std::array<double, n_tubes> radius;  // outer [mm]
    std::array<double, n_tubes> bending; // E_i I_i [N mm^2]
    std::array<double, n_tubes> torsion; // G_i J_i [N mm^2]
    Vec3 entry;                          // where the guide ends [mm]
    Mat3 frame;                          // of the guide, without tilt: its third column is where it points
    int n_elements;                      // of equal length, each an arc
    double blur;                         // half-width of the ends of sections [mm]: shapes are smooth where two ends pass each other
};

// Nitinol tubes of these outer and inner diameters.
Tubes nitinol(const std::array<double, n_tubes> &outer, const std::array<double, n_tubes> &inner);

struct Shape {
    std::vector<double> points;             // [3 x (n_elements + 1)], from the entry to the tip
    std::array<Length, n_tubes> base_angle; // alpha_i at the entry
    std::array<Length, n_tubes> base_twist; // alpha_i' there [1/mm]

    // By element, for the derivatives: the bend, h u, the length h, and the frame at its start.
    std::vector<Length> bend_x, bend_y;
    Length h;
    std::vector<Mat3> frames;
    Mat3 guide; // the untilted frame
    std::array<double, 2> tilt;

    Vec3 tip() const { return {points[points.size() - 3], points[points.size() - 2], points[points.size() - 1]}; }
};

void solve(const Tubes &tubes, const Parameters &parameters, Shape &shape);

// Derivatives of sum_j forces_j . points_j by the parameters, forces [3 x (n_elements + 1)]: exact, in one pass from the tip.
void pull(const Shape &shape, const double *forces, Parameters &gradient);

// The outer radius of the robot at s.
double radius_at(const Tubes &tubes, const Parameters &parameters, double s);

// Points of the compliant robot, `n_between` within each element, the elements' arcs cut; with the radius at each.
void dense_points(const Tubes &tubes, const Parameters &parameters, const Shape &shape, int n_between, std::vector<double> &points,
                  std::vector<double> &radii);

// Where the torsionally rigid robot ends, by arcs in closed form with sharp ends of sections; psi_i are its angles from base to tip.
Vec3 rigid_tip(const Tubes &tubes, const Parameters &parameters);

// Rotation by the vector (a, b, 0).
Mat3 rotation(double a, double b);
Mat3 times(const Mat3 &a, const Mat3 &b);
Vec3 times(const Mat3 &a, const Vec3 &v);
