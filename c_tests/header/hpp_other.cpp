#include <keepout.hpp>

bool other_throws();

bool other_throws() {
    try {
        keepout::Field::load("");
    } catch (const keepout::Error &error) {
        return error.status() == KO_ERR_INVALID_ARGUMENT;
    }
    return false;
}
