// Keepout for C++17: owning handles, views of arrays, exceptions. Header only, over keepout.h, whose docs hold here too.
// SPDX-License-Identifier: Apache-2.0 OR MIT
//
// Shapes are those of the C calls: points [3 * n], row-major. A std::vector, a std::array or (pointer, size) is taken wherever a Span is;
// its length tells the number of points. Every call throws Error where the C call fails, also on a handle that was moved from.

#ifndef KEEPOUT_HPP
#define KEEPOUT_HPP

#if (defined(_MSVC_LANG) ? _MSVC_LANG : __cplusplus) < 201703L
#error "keepout.hpp needs C++17; keepout.h serves older compilers"
#endif

#include "keepout.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace keepout {

/// A call that failed: its status, and the message that tells what was wrong, where, and what would be right.
class Error : public std::runtime_error {
public:
    Error(std::int32_t status, const std::string &message) : std::runtime_error(message), status_(status) {}

    /// One of KO_ERR_...
    std::int32_t status() const noexcept { return status_; }

private:
    std::int32_t status_;
};

/// A view of an array that someone else owns.
template <class T>
class Span {
public:
    constexpr Span() noexcept = default;
    constexpr Span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}

    /// Of anything with contiguous T: std::vector, std::array, an array. A temporary vector is taken to be read, not to be written to.
    template <class C, class = std::enable_if_t<
                           std::is_convertible_v<decltype(std::data(std::declval<C &>())), T *> &&
                           !std::is_same_v<std::remove_cv_t<std::remove_reference_t<C>>, Span> &&
                           (std::is_lvalue_reference_v<C> || std::is_const_v<T> || std::is_trivially_copyable_v<C>)>>
    constexpr Span(C &&array) noexcept : data_(std::data(array)), size_(std::size(array)) {}

    constexpr T *data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

namespace detail {

inline void check(std::int32_t status) {
    if (status < 0) {
        throw Error(status, ko_last_error());
    }
}

[[noreturn]] inline void wrong(const std::string &message) { throw Error(KO_ERR_INVALID_ARGUMENT, message); }

/// Entries of `size` numbers, `width` each.
inline std::size_t count(const char *name, std::size_t size, std::size_t width) {
    if (size % width != 0) {
        wrong(std::string(name) + " has " + std::to_string(size) + " numbers; a multiple of " + std::to_string(width) +
              " is needed");
    }
    return size / width;
}

inline void check_size(const char *name, std::size_t size, std::size_t right) {
    if (size != right) {
        wrong(std::string(name) + " has room for " + std::to_string(size) + " entries; " + std::to_string(right) +
              " are needed");
    }
}

template <class T, void (*Free)(T *)>
struct Deleter {
    void operator()(T *handle) const noexcept { Free(handle); }
};

/// A C handle with one owner.
template <class T, void (*Free)(T *)>
using Handle = std::unique_ptr<T, Deleter<T, Free>>;

} // namespace detail

/// What an on_progress function asks for.
enum class Progress { go_on, cancel };

/// ko_fit_options with the defaults, and a function to be told of progress: fraction in [0, 1], stage.
///
/// What it throws cancels the fit and comes out of Field::fit. Where it is set, `progress` and `progress_data` are not called.
struct FitOptions : ko_fit_options {
    FitOptions() : ko_fit_options() { detail::check(ko_fit_options_init(this, sizeof(ko_fit_options))); }

    std::function<Progress(double fraction, const char *stage)> on_progress;
};

/// Points of a surface with unit normals.
class Cloud {
public:
    /// Takes ownership of `handle`.
    explicit Cloud(ko_cloud *handle) noexcept : handle_(handle) {}

    /// From points [3 * n] and normals [3 * n] out of the solid.
    static Cloud from_points(Span<const double> points, Span<const double> normals) {
        const std::size_t n = detail::count("points", points.size(), 3);
        detail::check_size("normals", normals.size(), points.size());
        ko_cloud *handle = nullptr;
        detail::check(ko_cloud_from_points(3, points.data(), normals.data(), n, &handle));
        return Cloud(handle);
    }

    std::size_t size() const {
        std::size_t n = 0;
        detail::check(ko_cloud_get_size(get(), &n));
        return n;
    }

    /// [3 * size()]
    std::vector<double> points() const {
        std::vector<double> points(3 * size());
        detail::check(ko_cloud_copy(get(), points.size() / 3, points.data(), nullptr));
        return points;
    }

    /// [3 * size()], of length 1.
    std::vector<double> normals() const {
        std::vector<double> normals(3 * size());
        detail::check(ko_cloud_copy(get(), normals.size() / 3, nullptr, normals.data()));
        return normals;
    }

    struct Origins {
        std::vector<std::uint32_t> triangles; ///< [size()]
        std::vector<double> barycentric;      ///< [3 * size()]
    };

    /// Where on its mesh each point was taken.
    Origins origins() const {
        const std::size_t n = size();
        Origins origins{std::vector<std::uint32_t>(n), std::vector<double>(3 * n)};
        detail::check(ko_cloud_copy_origins(get(), n, origins.triangles.data(), origins.barycentric.data()));
        return origins;
    }

    ko_cloud *get() const noexcept { return handle_.get(); }

private:
    detail::Handle<ko_cloud, ko_cloud_free> handle_;
};

/// A triangulated surface.
class Mesh {
public:
    /// Takes ownership of `handle`.
    explicit Mesh(ko_mesh *handle) noexcept : handle_(handle) {}

    /// From an OBJ, STL, PLY or OFF file.
    static Mesh read(const std::string &path) {
        ko_mesh *handle = nullptr;
        detail::check(ko_mesh_read(path.c_str(), &handle));
        return Mesh(handle);
    }

    /// From vertices [3 * n_vertices] and triangles [3 * n_triangles], counter-clockwise seen from outside.
    static Mesh from_triangles(Span<const double> vertices, Span<const std::uint32_t> triangles) {
        const std::size_t n_vertices = detail::count("vertices", vertices.size(), 3);
        const std::size_t n_triangles = detail::count("triangles", triangles.size(), 3);
        ko_mesh *handle = nullptr;
        detail::check(ko_mesh_from_triangles(vertices.data(), n_vertices, triangles.data(), n_triangles, &handle));
        return Mesh(handle);
    }

    std::size_t n_vertices() const {
        std::size_t n = 0;
        detail::check(ko_mesh_get_size(get(), &n, nullptr));
        return n;
    }

    std::size_t n_triangles() const {
        std::size_t n = 0;
        detail::check(ko_mesh_get_size(get(), nullptr, &n));
        return n;
    }

    /// [3 * n_vertices()]
    std::vector<double> vertices() const {
        std::vector<double> vertices(3 * n_vertices());
        detail::check(ko_mesh_copy(get(), vertices.size() / 3, n_triangles(), vertices.data(), nullptr));
        return vertices;
    }

    /// [3 * n_triangles()]
    std::vector<std::uint32_t> triangles() const {
        std::vector<std::uint32_t> triangles(3 * n_triangles());
        detail::check(ko_mesh_copy(get(), n_vertices(), triangles.size() / 3, nullptr, triangles.data()));
        return triangles;
    }

    ko_mesh_report report() const {
        ko_mesh_report report;
        detail::check(ko_mesh_get_report(get(), sizeof report, &report));
        return report;
    }

    /// Turns every triangle over.
    void flip() { detail::check(ko_mesh_flip(get())); }

    /// `n_points` points of the surface with normals, evenly spread.
    Cloud sample(std::size_t n_points, std::uint64_t seed) const {
        ko_cloud *cloud = nullptr;
        detail::check(ko_mesh_sample(get(), n_points, seed, &cloud));
        return Cloud(cloud);
    }

    /// Exact distances of points [3 * n] into `distances` [n]: positive outside.
    void signed_distance(Span<const double> points, Span<double> distances) const {
        const std::size_t n = detail::count("points", points.size(), 3);
        detail::check_size("distances", distances.size(), n);
        detail::check(ko_mesh_signed_distance(get(), points.data(), n, distances.data()));
    }

    std::vector<double> signed_distance(Span<const double> points) const {
        std::vector<double> distances(detail::count("points", points.size(), 3));
        signed_distance(points, distances);
        return distances;
    }

    ko_mesh *get() const noexcept { return handle_.get(); }

private:
    detail::Handle<ko_mesh, ko_mesh_free> handle_;
};

/// A level-set function phi, close to the signed distance to a shape.
class Field {
public:
    /// Takes ownership of `handle`.
    explicit Field(ko_field *handle) noexcept : handle_(handle) {}

    static Field fit(const Cloud &cloud, const FitOptions &options = {}) {
        Listener listener{options, nullptr};
        ko_fit_options plain = options;
        if (options.on_progress) {
            plain.progress = Listener::hear;
            plain.progress_data = &listener;
        }
        ko_field *handle = nullptr;
        const std::int32_t status = ko_field_fit(cloud.get(), &plain, &handle);
        if (listener.thrown) {
            ko_field_free(handle);
            std::rethrow_exception(listener.thrown);
        }
        detail::check(status);
        return Field(handle);
    }

    static Field load(const std::string &path) {
        ko_field *handle = nullptr;
        detail::check(ko_field_load(path.c_str(), &handle));
        return Field(handle);
    }

    void save(const std::string &path) const { detail::check(ko_field_save(get(), path.c_str())); }

    ko_fit_report report() const {
        ko_fit_report report;
        detail::check(ko_field_get_report(get(), sizeof report, &report));
        return report;
    }

    /// Evaluates at points [3 * n] into values [n], gradients [3 * n], hessians [6 * n: xx xy xz yy yz zz]; empty: not wanted.
    /// No allocation, no lock; any number of threads at once.
    void eval(Span<const double> points, Span<double> values, Span<double> gradients = {},
              Span<double> hessians = {}) const {
        const std::size_t n = check_batch(points, values, gradients, hessians);
        detail::check(ko_field_eval(get(), points.data(), n, values.data(), gradients.data(), hessians.data()));
    }

    /// The same on `n_threads` threads; 0: all cores.
    void eval_parallel(std::uint32_t n_threads, Span<const double> points, Span<double> values,
                       Span<double> gradients = {}, Span<double> hessians = {}) const {
        const std::size_t n = check_batch(points, values, gradients, hessians);
        detail::check(ko_field_eval_parallel(get(), points.data(), n, values.data(), gradients.data(), hessians.data(),
                                             n_threads));
    }

    struct Evaluation {
        std::vector<double> values;    ///< [n]
        std::vector<double> gradients; ///< [3 * n]
        std::vector<double> hessians;  ///< [6 * n]
    };

    /// Value, gradient and Hessian at points [3 * n].
    Evaluation eval(Span<const double> points) const {
        const std::size_t n = detail::count("points", points.size(), 3);
        Evaluation all{std::vector<double>(n), std::vector<double>(3 * n), std::vector<double>(6 * n)};
        eval(points, all.values, all.gradients, all.hessians);
        return all;
    }

    /// Values alone at points [3 * n].
    std::vector<double> values(Span<const double> points) const {
        std::vector<double> values(detail::count("points", points.size(), 3));
        eval(points, values);
        return values;
    }

    /// 1 for each of points [3 * n] outside the field's box, else 0.
    std::vector<std::uint8_t> outside_box(Span<const double> points) const {
        std::vector<std::uint8_t> outside(detail::count("points", points.size(), 3));
        detail::check(ko_field_outside_box(get(), points.data(), outside.size(), outside.data()));
        return outside;
    }

    ko_field *get() const noexcept { return handle_.get(); }

private:
    /// Stands between C and on_progress: no exception passes.
    struct Listener {
        const FitOptions &options;
        std::exception_ptr thrown;

        static std::int32_t hear(double fraction, const char *stage, void *data) noexcept {
            auto &self = *static_cast<Listener *>(data);
            try {
                return self.options.on_progress(fraction, stage) == Progress::cancel;
            } catch (...) {
                self.thrown = std::current_exception();
                return 1;
            }
        }
    };

    static std::size_t check_batch(Span<const double> points, Span<double> values, Span<double> gradients,
                                   Span<double> hessians) {
        const std::size_t n = detail::count("points", points.size(), 3);
        if (!values.empty()) {
            detail::check_size("values", values.size(), n);
        }
        if (!gradients.empty()) {
            detail::check_size("gradients", gradients.size(), 3 * n);
        }
        if (!hessians.empty()) {
            detail::check_size("hessians", hessians.size(), 6 * n);
        }
        return n;
    }

    detail::Handle<ko_field, ko_field_free> handle_;
};

} // namespace keepout

#endif
