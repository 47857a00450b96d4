// Signs far from the surface.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "subjects.hpp"

#include "common.hpp"

namespace bench {

// Signs against CGAL's side.
void signs(const Data &data) {
    const std::pair<const char *, const char *> shapes[] = {{"bunny_lsdo_genie", "stanford/bunny_lsdo_genie.stl"},
                                                            {"armadillo", "stanford/armadillo_cgal.off"},
                                                            {"femur", "anatomy/femur_cgal.off"},
                                                            {"bwb", "aircraft/bwb.stl"},
                                                            {"rotor", "mechanical/rotor.off"}};
    for (const auto &[name, path] : shapes) {
        const Mesh mesh = read_mesh(data(path));
        const Field field = fit(sample(mesh, N_SAMPLES), options_of());
        const std::string key = std::string("signs_") + name;
        print_fit(key, field);
        print_signs(key, signs_in_box(field, mesh, N_POINTS), N_POINTS);
    }
}

}  // namespace bench
