#include <keepout.h>

uint32_t other_abi_version(void);

uint32_t other_abi_version(void) {
    return ko_abi_version();
}
