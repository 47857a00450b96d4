#include <keepout.hpp>

int main() {
    try {
        keepout::Mesh::read("no-such-file.obj");
    } catch (const keepout::Error &error) {
        return error.status() == KO_ERR_IO ? 0 : 1;
    }
    return 1;
}
