// keepout.hpp stands alone, also when it is included twice; linked with header/hpp_other.cpp, which includes it too.

#include <keepout.hpp>
#include <keepout.hpp>

bool other_throws();

int main() {
    try {
        keepout::Mesh::read("");
    } catch (const keepout::Error &error) {
        return error.status() == KO_ERR_INVALID_ARGUMENT && other_throws() ? 0 : 1;
    }
    return 1;
}
