// What the figures were taken on: times mean nothing without it.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include "library.hpp"
#include "oracle.hpp"
#include "stats.hpp"

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

namespace bench {

inline std::string cpu_model() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
    return "unknown";
}

inline std::string today() {
    const std::time_t now = std::time(nullptr);
    char date[sizeof "2000-01-01"];
    std::strftime(date, sizeof date, "%Y-%m-%d", std::localtime(&now));
    return date;
}

inline void print_machine() {
    print("machine_date", today());
    print("machine_cpu", cpu_model());
    print_count("machine_cores", std::thread::hardware_concurrency());
    double load = 0;
    if (getloadavg(&load, 1) == 1) print("machine_load_of_last_minute", load);
    print("library_version", std::string(ko_version()));
    print("bench_compiler", std::string(BENCH_COMPILER));
    print("bench_flags", std::string(BENCH_FLAGS));
    print("cgal_version", std::string(oracle_version()));
    print_count("fit_threads", 1);
}

}  // namespace bench
