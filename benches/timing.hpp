// Time, and the one thread that it is taken on.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include <chrono>
#include <ctime>
#ifdef __linux__
#include <sched.h>
#endif

namespace bench {

// Wall-clock seconds that `work` takes.
template <class Work> double seconds(Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Processor seconds that `work` takes, all threads together: what is left of a time where other programs hold the cores.
template <class Work> double processor_seconds(Work work) {
    const std::clock_t start = std::clock();
    work();
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// Keeps the calling thread on the core where it is, as long as this lives; elsewhere than on Linux it does nothing.
class Pinned {
public:
#ifdef __linux__
    Pinned() {
        sched_getaffinity(0, sizeof before_, &before_);
        cpu_set_t here;
        CPU_ZERO(&here);
        CPU_SET(sched_getcpu(), &here);
        sched_setaffinity(0, sizeof here, &here);
    }
    ~Pinned() { sched_setaffinity(0, sizeof before_, &before_); }

private:
    cpu_set_t before_;
#else
    Pinned() {}
#endif
public:
    Pinned(const Pinned &) = delete;
    Pinned &operator=(const Pinned &) = delete;
};

}  // namespace bench
