// Keepout for C++17: owning handles, views of arrays, exceptions. Header only, over keepout.h, whose docs hold here too.
// SPDX-License-Identifier: Apache-2.0 OR MIT
//
// Shapes are those of the C calls: points [dim * n], row-major, dim being 3 in space and 2 in the plane, as dim() of a handle tells. A
// std::vector, a std::array or (pointer, size) is taken wherever a Span is; its length tells the number of points. Every call throws Error
// where the C call fails, also on a handle that was moved from.

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

/// What stands for the dimension of no handle; each call on it fails.
inline constexpr std::uint32_t dim_of_none = 3;

inline std::uint32_t dim_of(const ko_mesh *mesh) noexcept {
    std::uint32_t dim = dim_of_none;
    if (mesh != nullptr) {
        ko_mesh_get_dim(mesh, &dim);
    }
    return dim;
}

inline std::uint32_t dim_of(const ko_cloud *cloud) noexcept {
    std::uint32_t dim = dim_of_none;
    if (cloud != nullptr) {
        ko_cloud_get_dim(cloud, &dim);
    }
    return dim;
}

inline std::uint32_t dim_of(const ko_field *field) noexcept {
    ko_fit_report report;
    return field == nullptr || ko_field_get_report(field, sizeof report, &report) < 0 ? dim_of_none : report.dim;
}

} // namespace detail

/// Version of the library, "major.minor.patch".
inline std::string version() { return ko_version(); }

/// Version of the ABI of the library that is loaded; KO_ABI_VERSION is that of the header.
inline std::uint32_t abi_version() noexcept { return ko_abi_version(); }

/// An or of KO_CAPABILITY_ bits.
inline std::uint64_t capabilities() noexcept { return ko_capabilities(); }

/// Name of a status, "KO_ERR_IO", say.
inline std::string status_string(std::int32_t status) { return ko_status_string(status); }

/// What an on_progress function asks for.
enum class Progress { go_on, cancel };

/// ko_fit_options with the defaults, and a function to be told of progress: fraction in [0, 1], stage.
///
/// What it throws cancels the fit and comes out of Field::fit. Where it is set, `progress` and `progress_data` are not called.
struct FitOptions : ko_fit_options {
    FitOptions() : ko_fit_options() { detail::check(ko_fit_options_init(this, sizeof(ko_fit_options))); }

    std::function<Progress(double fraction, const char *stage)> on_progress;
};

/// Points of a surface in space, or of a curve in the plane, with unit normals.
class Cloud {
public:
    /// Takes ownership of `handle`.
    explicit Cloud(ko_cloud *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

    /// From points [dim * n] and normals [dim * n] out of the solid; `dim` 2 or 3.
    static Cloud from_points(Span<const double> points, Span<const double> normals, std::uint32_t dim = 3) {
        // What is neither 2 nor 3 is for the call to refuse.
        const std::size_t n = detail::count("points", points.size(), dim == 2 ? 2 : 3);
        detail::check_size("normals", normals.size(), points.size());
        ko_cloud *handle = nullptr;
        detail::check(ko_cloud_from_points(dim, points.data(), normals.data(), n, &handle));
        return Cloud(handle);
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    std::size_t size() const {
        std::size_t n = 0;
        detail::check(ko_cloud_get_size(get(), &n));
        return n;
    }

    /// [dim() * size()]
    std::vector<double> points() const {
        const std::size_t n = size();
        std::vector<double> points(dim_ * n);
        detail::check(ko_cloud_copy(get(), n, points.data(), nullptr));
        return points;
    }

    /// [dim() * size()], of length 1.
    std::vector<double> normals() const {
        const std::size_t n = size();
        std::vector<double> normals(dim_ * n);
        detail::check(ko_cloud_copy(get(), n, nullptr, normals.data()));
        return normals;
    }

    /// Gives each point a weight, weights [size()]: how much a fit trusts it. Points of weight 0 take no part.
    void set_weights(Span<const double> weights) {
        detail::check(ko_cloud_set_weights(get(), weights.data(), weights.size()));
    }

    struct Origins {
        std::vector<std::uint32_t> triangles; ///< [size()], in the plane segments
        std::vector<double> barycentric;      ///< [dim() * size()]
    };

    /// Where on its mesh each point was taken.
    Origins origins() const {
        const std::size_t n = size();
        Origins origins{std::vector<std::uint32_t>(n), std::vector<double>(dim_ * n)};
        detail::check(ko_cloud_copy_origins(get(), n, origins.triangles.data(), origins.barycentric.data()));
        return origins;
    }

    const ko_cloud *get() const noexcept { return handle_.get(); }
    ko_cloud *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_cloud, ko_cloud_free> handle_;
    std::uint32_t dim_;
};

/// Whether polylines go back to their first points.
enum class Polylines { closed, open };

/// A triangulated surface in space, or polylines in the plane: there a triangle is a segment.
class Mesh {
public:
    /// Takes ownership of `handle`.
    explicit Mesh(ko_mesh *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

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

    /// From points [2 * n] of the plane, of which polyline i begins at loop_starts[i]; the solid lies on the left of closed ones.
    static Mesh from_polylines(Span<const double> points, Span<const std::size_t> loop_starts,
                               Polylines kind = Polylines::closed) {
        const std::size_t n = detail::count("points", points.size(), 2);
        ko_mesh *handle = nullptr;
        detail::check(ko_mesh_from_polylines(points.data(), n, loop_starts.data(), loop_starts.size(),
                                             kind == Polylines::closed, &handle));
        return Mesh(handle);
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

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

    /// [dim() * n_vertices()]
    std::vector<double> vertices() const {
        const std::size_t n = n_vertices();
        std::vector<double> vertices(dim_ * n);
        detail::check(ko_mesh_copy(get(), n, n_triangles(), vertices.data(), nullptr));
        return vertices;
    }

    /// [dim() * n_triangles()]
    std::vector<std::uint32_t> triangles() const {
        const std::size_t n = n_triangles();
        std::vector<std::uint32_t> triangles(dim_ * n);
        detail::check(ko_mesh_copy(get(), n_vertices(), n, nullptr, triangles.data()));
        return triangles;
    }

    ko_mesh_report report() const {
        ko_mesh_report report;
        detail::check(ko_mesh_get_report(get(), sizeof report, &report));
        return report;
    }

    /// Turns every triangle over; an inside-out solid becomes a solid.
    void flip() { detail::check(ko_mesh_flip(get())); }

    /// `n_points` points of the surface or the curves with normals, evenly spread.
    Cloud sample(std::size_t n_points, std::uint64_t seed) const {
        ko_cloud *cloud = nullptr;
        detail::check(ko_mesh_sample(get(), n_points, seed, &cloud));
        return Cloud(cloud);
    }

    /// Exact distances of points [dim() * n] into `distances` [n]: positive outside.
    void signed_distance(Span<const double> points, Span<double> distances) const {
        const std::size_t n = detail::count("points", points.size(), dim_);
        detail::check_size("distances", distances.size(), n);
        detail::check(ko_mesh_signed_distance(get(), points.data(), n, distances.data()));
    }

    std::vector<double> signed_distance(Span<const double> points) const {
        std::vector<double> distances(detail::count("points", points.size(), dim_));
        signed_distance(points, distances);
        return distances;
    }

    const ko_mesh *get() const noexcept { return handle_.get(); }
    ko_mesh *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_mesh, ko_mesh_free> handle_;
    std::uint32_t dim_;
};

/// A level-set function phi, close to the signed distance to a shape.
class Field {
public:
    /// Takes ownership of `handle`.
    explicit Field(ko_field *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

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

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    void save(const std::string &path) const { detail::check(ko_field_save(get(), path.c_str())); }

    ko_fit_report report() const {
        ko_fit_report report;
        detail::check(ko_field_get_report(get(), sizeof report, &report));
        return report;
    }

    /// Evaluates at points [dim() * n] into values [n], gradients [dim() * n] and hessians, [6 * n: xx xy xz yy yz zz] in space and
    /// [3 * n: xx xy yy] in the plane; empty: not wanted. No allocation, no lock; any number of threads at once.
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
        std::vector<double> gradients; ///< [dim() * n]
        std::vector<double> hessians;  ///< [6 * n] in space, [3 * n] in the plane
    };

    /// Value, gradient and Hessian at points [dim() * n].
    Evaluation eval(Span<const double> points) const {
        const std::size_t n = detail::count("points", points.size(), dim_);
        Evaluation all{std::vector<double>(n), std::vector<double>(dim_ * n), std::vector<double>(n_second() * n)};
        eval(points, all.values, all.gradients, all.hessians);
        return all;
    }

    /// Values alone at points [dim() * n].
    std::vector<double> values(Span<const double> points) const {
        std::vector<double> values(detail::count("points", points.size(), dim_));
        eval(points, values);
        return values;
    }

    /// 1 for each of points [dim() * n] outside the field's box, else 0.
    std::vector<std::uint8_t> outside_box(Span<const double> points) const {
        std::vector<std::uint8_t> outside(detail::count("points", points.size(), dim_));
        detail::check(ko_field_outside_box(get(), points.data(), outside.size(), outside.data()));
        return outside;
    }

    const ko_field *get() const noexcept { return handle_.get(); }
    ko_field *get() noexcept { return handle_.get(); }

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

    /// Second derivatives at a point: the upper triangle.
    std::size_t n_second() const noexcept { return dim_ * (dim_ + 1) / 2; }

    std::size_t check_batch(Span<const double> points, Span<double> values, Span<double> gradients,
                            Span<double> hessians) const {
        const std::size_t n = detail::count("points", points.size(), dim_);
        if (!values.empty()) {
            detail::check_size("values", values.size(), n);
        }
        if (!gradients.empty()) {
            detail::check_size("gradients", gradients.size(), dim_ * n);
        }
        if (!hessians.empty()) {
            detail::check_size("hessians", hessians.size(), n_second() * n);
        }
        return n;
    }

    detail::Handle<ko_field, ko_field_free> handle_;
    std::uint32_t dim_;
};

} // namespace keepout

#endif
