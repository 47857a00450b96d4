// What the benches' programs share: where the data lies, and how they end.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace bench {

// The folder of test data: $KEEPOUT_DATA, else the one given on the command line.
class Data {
public:
    explicit Data(const char *otherwise) {
        const char *named = std::getenv("KEEPOUT_DATA");
        folder_ = named && *named ? named : otherwise;
        if (!std::filesystem::is_directory(folder_))
            throw std::runtime_error("there is no data folder " + folder_.string() + "; set KEEPOUT_DATA to where the meshes lie");
    }
    std::string operator()(const char *name) const { return (folder_ / name).string(); }

private:
    std::filesystem::path folder_;
};

// Runs `body`; what it throws is said, and makes the exit status 1.
template <class Body> int run(const char *name, Body body) {
    try {
        body();
        return EXIT_SUCCESS;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", name, error.what());
        return EXIT_FAILURE;
    }
}

}  // namespace bench
