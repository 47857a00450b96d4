// What the benches' programs share: where the data lies, which of their subjects they print, and how they end.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "machine.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

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

// A part of a program's figures.
struct Subject {
    const char *name;
    void (*print)(const Data &data);
};

// Prints the machine, and the subjects that the command line names behind the folder of data; all where it names none, but for `alone`,
// which is for processes that do nothing else.
inline int run_subjects(const char *name, int argc, char **argv, const std::vector<Subject> &subjects,
                        const std::vector<Subject> &alone = {}) {
    std::vector<Subject> named;
    bool known = argc >= 2;
    for (int i = 2; i < argc; ++i) {
        const auto is_it = [&](const Subject &subject) { return !std::strcmp(argv[i], subject.name); };
        for (const std::vector<Subject> *of : {&subjects, &alone}) {
            const auto found = std::find_if(of->begin(), of->end(), is_it);
            if (found != of->end()) named.push_back(*found);
        }
        known = known && named.size() + 1 == static_cast<std::size_t>(i);
    }
    if (!known) {
        std::fprintf(stderr, "usage: %s DATA_FOLDER [SUBJECT...], of", name);
        for (const Subject &subject : subjects) std::fprintf(stderr, " %s", subject.name);
        for (const Subject &subject : alone) std::fprintf(stderr, " %s", subject.name);
        std::fprintf(stderr, "\n");
        return EXIT_FAILURE;
    }
    return run(name, [&] {
        const Data data(argv[1]);
        print_machine();
        for (const Subject &subject : named.empty() ? subjects : named) subject.print(data);
    });
}

}  // namespace bench
