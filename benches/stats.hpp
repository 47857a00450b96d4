// Numbers about numbers, and how a figure is printed.
// SPDX-License-Identifier: Apache-2.0 OR MIT
#pragma once

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace bench {

// Root mean square and largest magnitude of what was added.
class Errors {
public:
    void add(double error) {
        sum_ += error * error;
        max_ = std::max(max_, std::abs(error));  // a NaN shows in the RMS
        ++n_;
    }
    double rms() const { return std::sqrt(sum_ / static_cast<double>(n_)); }
    double max() const { return max_; }

private:
    double sum_ = 0, max_ = 0;
    std::size_t n_ = 0;
};

inline double median(std::vector<double> numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

inline double minimum(const std::vector<double> &numbers) { return *std::min_element(numbers.begin(), numbers.end()); }

// `key = value unit`, flushed: a long bench is read while it runs.
inline void print(const std::string &key, double value, const char *unit = "") {
    std::printf("%s = %.4g%s%s\n", key.c_str(), value, *unit ? " " : "", unit);
    std::fflush(stdout);
}

inline void print_count(const std::string &key, std::uint64_t count, const char *unit = "") {
    std::printf("%s = %" PRIu64 "%s%s\n", key.c_str(), count, *unit ? " " : "", unit);
    std::fflush(stdout);
}

inline void print(const std::string &key, const std::string &text) {
    std::printf("%s = %s\n", key.c_str(), text.c_str());
    std::fflush(stdout);
}

}  // namespace bench
