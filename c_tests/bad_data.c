/* Every file of data/bad: those that cannot be read say where and why, the others read and their reports say what is wrong.
 *
 *   bad_data FOLDER           FOLDER is that of the test data */

#include "check.h"

static const char *folder;

static int32_t read_bad(const char *name, ko_mesh **mesh) {
    char path[4096];
    snprintf(path, sizeof path, "%s/bad/%s", folder, name);
    return ko_mesh_read(path, mesh);
}

static ko_mesh_report report_of(const char *name) {
    ko_mesh *mesh = NULL;
    ko_mesh_report report = {0};
    OK(read_bad(name, &mesh));
    OK(ko_mesh_get_report(mesh, sizeof report, &report));
    ko_mesh_free(mesh);
    return report;
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: bad_data FOLDER\n");
        return EXIT_FAILURE;
    }
    folder = argv[1];
    ko_mesh *mesh = (ko_mesh *)(uintptr_t)8;
    FAILS(read_bad("empty.stl", &mesh), KO_ERR_FORMAT, "empty.stl");
    CHECK(mesh == NULL);
    FAILS(read_bad("nan_vertices.off", &mesh), KO_ERR_FORMAT, "nan_vertices.off:13: vertex 9 is (NaN, ");
    FAILS(read_bad("truncated.obj", &mesh), KO_ERR_FORMAT, "0 faces");
    FAILS(read_bad("truncated.off", &mesh), KO_ERR_FORMAT, "truncated.off:6009: ");
    FAILS(read_bad("truncated_binary.ply", &mesh), KO_ERR_FORMAT, "at byte 53912");
    FAILS(read_bad("truncated_binary.stl", &mesh), KO_ERR_FORMAT, "at byte 249342");

    CHECK(report_of("degtri_sliding.off").n_degenerate == 4);
    CHECK(report_of("quads_to_stitch.off").n_boundary_edges == 20);
    ko_mesh_report crossed = report_of("tetra_intersected_by_triangle.off");
    CHECK(crossed.n_components == 2 && crossed.n_boundary_edges == 3 && crossed.closed == 0);
    ko_mesh_report pig = report_of("pig.off");
    CHECK(pig.n_boundary_edges == 55 && pig.closed == 0 && pig.inside_out == 0);
    return check_result();
}
