// Figures of size and speed, all of them or the subjects that are named.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#include "../machine.hpp"
#include "subjects.hpp"

#include <cstring>

namespace {

using namespace bench;

struct Subject {
    const char *name;
    void (*print)(const Data &data);
};

const Subject SUBJECTS[] = {{"speed", speed}, {"fits", fits}, {"accuracy", accuracy}};
const Subject MILLION_ONLY = {"million-only", million_only};

const Subject *subject_of(const char *name) {
    for (const Subject &subject : SUBJECTS)
        if (!std::strcmp(name, subject.name)) return &subject;
    return !std::strcmp(name, MILLION_ONLY.name) ? &MILLION_ONLY : nullptr;
}

int usage(const char *program) {
    std::fprintf(stderr, "usage: %s DATA_FOLDER [SUBJECT...], of", program);
    for (const Subject &subject : SUBJECTS) std::fprintf(stderr, " %s", subject.name);
    std::fprintf(stderr, "\n");
    return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char **argv) {
    if (argc < 2) return usage(argv[0]);
    std::vector<const Subject *> named;
    for (int i = 2; i < argc; ++i) {
        named.push_back(subject_of(argv[i]));
        if (!named.back()) return usage(argv[0]);
    }
    return run("scale", [&] {
        const Data data(argv[1]);
        print_machine();
        if (named.empty())
            for (const Subject &subject : SUBJECTS) named.push_back(&subject);
        for (const Subject *subject : named) subject->print(data);
    });
}
