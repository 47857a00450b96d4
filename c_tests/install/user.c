#include <keepout.h>
#include <stdio.h>
#include <string.h>

int main(void) {
    ko_mesh *mesh = NULL;
    if (ko_mesh_read("no-such-file.obj", &mesh) != KO_ERR_IO || strstr(ko_last_error(), "no-such-file.obj") == NULL) {
        return 1;
    }
    printf("keepout %s, ABI %u\n", ko_version(), (unsigned)ko_abi_version());
    return ko_abi_version() == KO_ABI_VERSION ? 0 : 1;
}
