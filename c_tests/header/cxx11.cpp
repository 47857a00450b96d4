// The header stands alone in C++11, also when it is included twice.

#include <keepout.h>
#include <keepout.h>

int main() {
    return ko_abi_version() == KO_ABI_VERSION ? 0 : 1;
}
