/* The header stands alone in C99, also when it is included twice; linked with header/c99_other.c. */

#include <keepout.h>
#include <keepout.h>

uint32_t other_abi_version(void);

int main(void) {
    return ko_abi_version() == KO_ABI_VERSION && other_abi_version() == KO_ABI_VERSION ? 0 : 1;
}
