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

#include <array>
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

    /// Of anything with contiguous T: std::vector, std::array, an array. A temporary that holds its numbers is taken to be read, not to be
    /// written to; one that only views them, as its constness does not reach them, for both.
    template <class C, class = std::enable_if_t<
                           std::is_convertible_v<decltype(std::data(std::declval<C &>())), T *> &&
                           !std::is_same_v<std::remove_cv_t<std::remove_reference_t<C>>, Span> &&
                           (std::is_lvalue_reference_v<C> || std::is_const_v<T> ||
                            std::is_convertible_v<decltype(std::data(std::declval<const C &>())), T *>)>>
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

/// `path` as C takes it, which would end it at a zero byte, and take another file.
inline const char *c_path(const std::string &path) {
    if (path.find('\0') != path.npos) {
        wrong("the path '" + std::string(path.c_str()) + "' goes on behind a zero byte");
    }
    return path.c_str();
}

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

/// Points of a lattice; too many to count wrap around to what no array is as long as, or are for the call to refuse.
inline std::size_t product(Span<const std::size_t> counts) {
    std::size_t n = 1;
    for (std::size_t i = 0; i < counts.size(); i++) {
        n *= counts.data()[i];
    }
    return n;
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

inline std::uint32_t dim_of(const ko_body *body) noexcept {
    std::uint32_t dim = dim_of_none;
    if (body != nullptr) {
        ko_body_get_dim(body, &dim);
    }
    return dim;
}

inline std::uint32_t dim_of(const ko_motion *motion) noexcept {
    std::uint32_t dim = dim_of_none;
    if (motion != nullptr) {
        ko_motion_get_dim(motion, &dim);
    }
    return dim;
}

inline std::uint32_t dim_of(const ko_part *part) noexcept {
    std::uint32_t dim = dim_of_none;
    if (part != nullptr) {
        ko_part_get_size(part, &dim, nullptr);
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

/// Told of progress: fraction in [0, 1], stage. What it throws cancels the call and comes out of it.
///
/// Where options have one, their `progress` and `progress_data` are not called.
using OnProgress = std::function<Progress(double fraction, const char *stage)>;

/// ko_fit_options with the defaults.
struct FitOptions : ko_fit_options {
    FitOptions() : ko_fit_options() { detail::check(ko_fit_options_init(this, sizeof(ko_fit_options))); }

    OnProgress on_progress;
};

/// ko_normal_options with the defaults.
struct NormalOptions : ko_normal_options {
    NormalOptions() : ko_normal_options() { detail::check(ko_normal_options_init(this, sizeof(ko_normal_options))); }

    OnProgress on_progress;
};

/// ko_smooth_options with the defaults.
struct SmoothOptions : ko_smooth_options {
    SmoothOptions() : ko_smooth_options() { detail::check(ko_smooth_options_init(this, sizeof(ko_smooth_options))); }

    OnProgress on_progress;
};

/// ko_level_set_options with the defaults.
struct LevelSetOptions : ko_level_set_options {
    LevelSetOptions() : ko_level_set_options() {
        detail::check(ko_level_set_options_init(this, sizeof(ko_level_set_options)));
    }

    OnProgress on_progress;
};

/// ko_certify_options with the defaults.
struct CertifyOptions : ko_certify_options {
    CertifyOptions() : ko_certify_options() { detail::check(ko_certify_options_init(this, sizeof(ko_certify_options))); }

    OnProgress on_progress;
};

/// ko_aggregation with the defaults: KS.
struct Aggregation : ko_aggregation {
    Aggregation() : ko_aggregation() { detail::check(ko_aggregation_init(this, sizeof(ko_aggregation))); }
};

/// ko_explicit_options with the defaults: KO_EXPLICIT_HICKEN_KAUR_LINEAR over all points.
struct ExplicitOptions : ko_explicit_options {
    ExplicitOptions() : ko_explicit_options() {
        detail::check(ko_explicit_options_init(this, sizeof(ko_explicit_options)));
    }
};

/// ko_pair_options with the defaults: a conflict graph of overlap, no measures.
struct PairOptions : ko_pair_options {
    PairOptions() : ko_pair_options() { detail::check(ko_pair_options_init(this, sizeof(ko_pair_options))); }

    OnProgress on_progress;
};

/// ko_family_options with the defaults.
struct FamilyOptions : ko_family_options {
    FamilyOptions() : ko_family_options() { detail::check(ko_family_options_init(this, sizeof(ko_family_options))); }

    OnProgress on_progress;
};

/// ko_optimise_options with the defaults.
struct OptimiseOptions : ko_optimise_options {
    OptimiseOptions() : ko_optimise_options() {
        detail::check(ko_optimise_options_init(this, sizeof(ko_optimise_options)));
    }

    OnProgress on_progress;
};

/// ko_persistence_options with the defaults.
struct PersistenceOptions : ko_persistence_options {
    PersistenceOptions() : ko_persistence_options() {
        detail::check(ko_persistence_options_init(this, sizeof(ko_persistence_options)));
    }

    OnProgress on_progress;
};

/// ko_arrange_options with the defaults.
struct ArrangeOptions : ko_arrange_options {
    ArrangeOptions() : ko_arrange_options() { detail::check(ko_arrange_options_init(this, sizeof(ko_arrange_options))); }

    OnProgress on_progress;
};

namespace detail {

/// Stands between C and an on_progress: no exception passes.
struct Listener {
    const OnProgress &on_progress;
    std::exception_ptr thrown;

    static std::int32_t hear(double fraction, const char *stage, void *data) noexcept {
        auto &self = *static_cast<Listener *>(data);
        try {
            return self.on_progress(fraction, stage) == Progress::cancel;
        } catch (...) {
            self.thrown = std::current_exception();
            return 1;
        }
    }
};

/// Status of `call(plain)`, with the options as the struct `Plain` of C.
template <class Plain, class Options, class Call>
std::int32_t listened(const Options &options, const Call &call) {
    Listener listener{options.on_progress, nullptr};
    Plain plain = options;
    if (options.on_progress) {
        plain.progress = Listener::hear;
        plain.progress_data = &listener;
    }
    const std::int32_t status = call(plain);
    if (listener.thrown) {
        std::rethrow_exception(listener.thrown);
    }
    check(status);
    return status;
}

/// What stands for the options of calls that have none but these.
struct Told {
    ko_progress progress;
    void *progress_data;
};

struct Listening : Told {
    explicit Listening(OnProgress listener) : Told{nullptr, nullptr}, on_progress(std::move(listener)) {}

    OnProgress on_progress;
};

/// The same of `call(plain, &handle)`; `free` takes the handle where on_progress threw.
template <class Plain, class Options, class T, class Call>
std::int32_t listened(const Options &options, T *&handle, void (*free)(T *), const Call &call) {
    try {
        return listened<Plain>(options, [&](const Plain &plain) { return call(plain, &handle); });
    } catch (...) {
        free(handle);
        throw;
    }
}

} // namespace detail

class Mesh;

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

    /// The same with normals that are estimated by the defaults.
    static Cloud from_points(Span<const double> points, std::uint32_t dim = 3) {
        const std::size_t n = detail::count("points", points.size(), dim == 2 ? 2 : 3);
        ko_cloud *handle = nullptr;
        detail::check(ko_cloud_from_points(dim, points.data(), nullptr, n, &handle));
        return Cloud(handle);
    }

    struct Estimate;

    /// From points [dim * n] that come without normals, which are estimated, with what was found.
    static Estimate estimate_normals(Span<const double> points, std::uint32_t dim = 3, const NormalOptions &options = {});

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

    /// A cloud with noise smoothed out of points and normals, which must be about right before; weights stay, origins go.
    Cloud smooth(const SmoothOptions &options = {}) const {
        ko_cloud *handle = nullptr;
        detail::listened<ko_smooth_options>(options, handle, ko_cloud_free, [&](const ko_smooth_options &plain, ko_cloud **cloud) {
            return ko_cloud_smooth(get(), &plain, cloud);
        });
        return Cloud(handle);
    }

    /// On which side points [dim() * n] lie, into `sides` [n]: 1 where the normals point to, -1 behind them, towards 0 where there are
    /// none.
    void sides(Span<const double> points, Span<double> sides) const {
        const std::size_t n = detail::count("points", points.size(), dim_);
        detail::check_size("sides", sides.size(), n);
        detail::check(ko_cloud_sides(get(), points.data(), n, sides.data()));
    }

    std::vector<double> sides(Span<const double> points) const {
        std::vector<double> found(detail::count("points", points.size(), dim_));
        sides(points, found);
        return found;
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

    /// The cloud of the same places on `mesh`: the one that this was sampled from, with its vertices moved.
    Cloud follow(const Mesh &mesh) const;

    /// Takes derivatives by points and normals, each [dim() * size()] or empty for zeros, back to those by the vertices of `mesh`, into
    /// `d_vertices` [dim() * mesh.n_vertices()].
    void pull_back(const Mesh &mesh, Span<const double> d_points, Span<const double> d_normals, Span<double> d_vertices) const;

    const ko_cloud *get() const noexcept { return handle_.get(); }
    ko_cloud *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_cloud, ko_cloud_free> handle_;
    std::uint32_t dim_;
};

/// A cloud whose normals were estimated.
struct Cloud::Estimate {
    Cloud cloud;
    std::vector<std::uint8_t> flags; ///< [cloud.size()], each an or of KO_POINT_ bits, 0 for most
    ko_normal_report report;
};

inline Cloud::Estimate Cloud::estimate_normals(Span<const double> points, std::uint32_t dim, const NormalOptions &options) {
    const std::size_t n = detail::count("points", points.size(), dim == 2 ? 2 : 3);
    std::vector<std::uint8_t> flags(n);
    ko_normal_report report;
    ko_cloud *handle = nullptr;
    detail::listened<ko_normal_options>(options, handle, ko_cloud_free, [&](const ko_normal_options &plain, ko_cloud **cloud) {
        return ko_cloud_estimate_normals(dim, points.data(), n, &plain, cloud, flags.data(), sizeof report, &report);
    });
    return Estimate{Cloud(handle), std::move(flags), report};
}

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
        detail::check(ko_mesh_read(detail::c_path(path), &handle));
        return Mesh(handle);
    }

    /// To the file `path`, whose ending names the format: .obj, .off, .ply or .stl.
    void write(const std::string &path) const { detail::check(ko_mesh_write(get(), detail::c_path(path))); }

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

    struct Curves {
        std::vector<double> points;           ///< [2 * n]
        std::vector<std::size_t> loop_starts; ///< [n_loops]: polyline i begins at points[2 * loop_starts[i]]
        std::vector<std::uint8_t> closed;     ///< [n_loops]: 1 where polyline i goes back to its first point, else 0
    };

    /// The curves that the segments of a mesh of the plane make: open ones first, then closed ones.
    Curves polylines() const {
        std::size_t n = 0, n_loops = 0;
        detail::check(ko_mesh_get_polylines_size(get(), &n, &n_loops));
        Curves curves{std::vector<double>(2 * n), std::vector<std::size_t>(n_loops), std::vector<std::uint8_t>(n_loops)};
        detail::check(ko_mesh_copy_polylines(get(), n, n_loops, curves.points.data(), curves.loop_starts.data(),
                                             curves.closed.data()));
        return curves;
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

    /// Parts that hang together by vertices that triangles share; report().n_components may be more.
    std::size_t n_components() const {
        std::size_t n = 0;
        detail::check(ko_mesh_get_component_count(get(), &n));
        return n;
    }

    /// A vertex of each component, [dim() * n_components()]: what a body that swallows the component holds.
    std::vector<double> component_points() const {
        const std::size_t n = n_components();
        std::vector<double> points(dim_ * n);
        detail::check(ko_mesh_copy_component_points(get(), n, points.data()));
        return points;
    }

    const ko_mesh *get() const noexcept { return handle_.get(); }
    ko_mesh *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_mesh, ko_mesh_free> handle_;
    std::uint32_t dim_;
};

inline Cloud Cloud::follow(const Mesh &mesh) const {
    ko_cloud *handle = nullptr;
    detail::check(ko_cloud_follow(get(), mesh.get(), &handle));
    return Cloud(handle);
}

inline void Cloud::pull_back(const Mesh &mesh, Span<const double> d_points, Span<const double> d_normals,
                             Span<double> d_vertices) const {
    const std::size_t n = size();
    if (!d_points.empty()) {
        detail::check_size("d_points", d_points.size(), dim_ * n);
    }
    if (!d_normals.empty()) {
        detail::check_size("d_normals", d_normals.size(), dim_ * n);
    }
    const std::size_t n_vertices = mesh.n_vertices();
    detail::check_size("d_vertices", d_vertices.size(), dim_ * n_vertices);
    detail::check(ko_cloud_pull_back(get(), mesh.get(), d_points.data(), d_normals.data(), n, n_vertices, d_vertices.data()));
}

/// A level-set function phi, close to the signed distance to a shape.
class Field {
public:
    /// Takes ownership of `handle`.
    explicit Field(ko_field *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

    /// Of `cloud`. Where options.max_error was out of reach, KO_BUDGET_REACHED, report().max tells.
    static Field fit(const Cloud &cloud, const FitOptions &options = {}) {
        ko_field *handle = nullptr;
        detail::listened<ko_fit_options>(options, handle, ko_field_free, [&](const ko_fit_options &plain, ko_field **field) {
            return ko_field_fit(cloud.get(), &plain, field);
        });
        return Field(handle);
    }

    /// A fit to `cloud` on this field's box, from its control points on; this field stays as it is.
    Field refit(const Cloud &cloud, const FitOptions &options = {}) const {
        ko_field *handle = nullptr;
        detail::listened<ko_fit_options>(options, handle, ko_field_free, [&](const ko_fit_options &plain, ko_field **field) {
            return ko_field_refit(get(), cloud.get(), &plain, field);
        });
        return Field(handle);
    }

    /// Of control points, as many as the product of counts [dim], the last axis contiguous, on the box from box_min [dim] to box_max [dim].
    /// `feasible` is KO_FEASIBLE_OUTSIDE or KO_FEASIBLE_INSIDE, `diagonal` the D that the report shall have.
    static Field from_control_points(Span<const std::uint32_t> counts, Span<const double> box_min,
                                     Span<const double> box_max, std::int32_t feasible, double diagonal,
                                     Span<const double> control_points) {
        detail::check_size("box_min", box_min.size(), counts.size());
        detail::check_size("box_max", box_max.size(), counts.size());
        ko_field *handle = nullptr;
        detail::check(ko_field_from_control_points(static_cast<std::uint32_t>(counts.size()), counts.data(), box_min.data(),
                                                   box_max.data(), feasible, diagonal, control_points.data(),
                                                   control_points.size(), &handle));
        return Field(handle);
    }

    /// [report().n_unknowns], row-major over the counts of the report, the last axis contiguous.
    std::vector<double> control_points() const {
        std::vector<double> control_points(static_cast<std::size_t>(report().n_unknowns));
        detail::check(ko_field_copy_control_points(get(), control_points.size(), control_points.data()));
        return control_points;
    }

    static Field load(const std::string &path) {
        ko_field *handle = nullptr;
        detail::check(ko_field_load(detail::c_path(path), &handle));
        return Field(handle);
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    void save(const std::string &path) const { detail::check(ko_field_save(get(), detail::c_path(path))); }

    ko_fit_report report() const {
        ko_fit_report report;
        detail::check(ko_field_get_report(get(), sizeof report, &report));
        return report;
    }

    /// Evaluates at points [dim() * n] into values [n], gradients [dim() * n] and hessians, [6 * n: xx xy xz yy yz zz] in space and
    /// [3 * n: xx xy yy] in the plane; empty: not wanted. No lock; it allocates for large fields only; any number of threads at once.
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

    /// Evaluates at the points of a lattice, origin [dim()] plus multiples below counts [k] of steps [dim() * k], 1 <= k <= dim(), on
    /// `n_threads` threads (0: all cores): values [n] and gradients [dim() * n], n the product of the counts, the last index fastest;
    /// empty: not wanted.
    void eval_lattice(std::uint32_t n_threads, Span<const double> origin, Span<const double> steps,
                      Span<const std::size_t> counts, Span<double> values, Span<double> gradients = {}) const {
        detail::check_size("origin", origin.size(), dim_);
        detail::check_size("steps", steps.size(), dim_ * counts.size());
        const std::size_t n = detail::product(counts);
        if (!values.empty()) {
            detail::check_size("values", values.size(), n);
        }
        if (!gradients.empty()) {
            detail::check_size("gradients", gradients.size(), dim_ * n);
        }
        detail::check(ko_field_eval_lattice(get(), origin.data(), steps.data(), counts.data(),
                                            static_cast<std::uint32_t>(counts.size()), values.data(), gradients.data(),
                                            n_threads));
    }

    struct LevelSet {
        Mesh mesh;
        bool open_at_box; ///< It meets the field's box, and is open there: KO_OPEN_AT_BOX.
    };

    /// The level set phi = `level` within the field's box: triangles in space, curves in the plane.
    LevelSet level_set(double level, const LevelSetOptions &options = {}) const {
        ko_mesh *handle = nullptr;
        const std::int32_t status = detail::listened<ko_level_set_options>(
            options, handle, ko_mesh_free,
            [&](const ko_level_set_options &plain, ko_mesh **mesh) { return ko_field_level_set(get(), level, &plain, mesh); });
        return LevelSet{Mesh(handle), status == KO_OPEN_AT_BOX};
    }

    /// Certifies the field against `mesh`, which it was fitted to: phi at or above the certificate's threshold at samples that cover a
    /// body's surface within `covering_radius` proves that the body is on the feasible side and farther than `clearance` from the shape,
    /// once mesh.component_points() are outside the body. What KO_SIDE_NOT_CERTIFIED and KO_BUDGET_REACHED tell is in side_certified and
    /// budget_reached.
    ko_certificate certify(const Mesh &mesh, double clearance, double covering_radius, const CertifyOptions &options = {}) const {
        ko_certificate certificate;
        detail::listened<ko_certify_options>(options, [&](const ko_certify_options &plain) {
            return ko_field_certify(get(), mesh.get(), clearance, covering_radius, &plain, sizeof certificate, &certificate);
        });
        return certificate;
    }

    const ko_field *get() const noexcept { return handle_.get(); }
    ko_field *get() noexcept { return handle_.get(); }

private:
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

/// How values of a field change as its cloud does: ready for any number of solves, one a J = sum of w_j phi(x_j).
class Sensitivity {
public:
    /// Takes ownership of `handle`, made for a cloud of `n_points` points of dimension `dim`.
    explicit Sensitivity(ko_sensitivity *handle, std::size_t n_points, std::uint32_t dim) noexcept
        : handle_(handle), n_points_(n_points), dim_(dim) {}

    /// Of `field` with respect to `cloud`, to which it was fitted with `options`; it refers to neither.
    static Sensitivity create(const Field &field, const Cloud &cloud, const FitOptions &options = {}) {
        const std::size_t n_points = cloud.size();
        ko_sensitivity *handle = nullptr;
        detail::listened<ko_fit_options>(options, handle, ko_sensitivity_free,
                                         [&](const ko_fit_options &plain, ko_sensitivity **sensitivity) {
                                             return ko_sensitivity_create(field.get(), cloud.get(), &plain, sensitivity);
                                         });
        return Sensitivity(handle, n_points, cloud.dim());
    }

    /// Points of the cloud.
    std::size_t n_points() const noexcept { return n_points_; }

    /// dJ by points and normals of the cloud, each [dim * n_points()] or empty where not wanted, of J over points [dim * n] with weights
    /// [n], empty for ones; to the tolerance of create's options.
    void solve(Span<const double> points, Span<const double> weights, Span<double> d_points, Span<double> d_normals = {}) {
        const std::size_t n = check(points, weights, d_points, d_normals);
        detail::check(ko_sensitivity_solve(get(), points.data(), weights.data(), n, nullptr, n_points_, d_points.data(),
                                           d_normals.data()));
    }

    /// The same to the tolerance, with the threads and the on_progress of `options`.
    void solve(Span<const double> points, Span<const double> weights, const FitOptions &options, Span<double> d_points,
               Span<double> d_normals = {}) {
        const std::size_t n = check(points, weights, d_points, d_normals);
        detail::listened<ko_fit_options>(options, [&](const ko_fit_options &plain) {
            return ko_sensitivity_solve(get(), points.data(), weights.data(), n, &plain, n_points_, d_points.data(),
                                        d_normals.data());
        });
    }

    const ko_sensitivity *get() const noexcept { return handle_.get(); }
    ko_sensitivity *get() noexcept { return handle_.get(); }

private:
    std::size_t check(Span<const double> points, Span<const double> weights, Span<double> d_points, Span<double> d_normals) const {
        const std::size_t n = detail::count("points", points.size(), dim_);
        if (!weights.empty()) {
            detail::check_size("weights", weights.size(), n);
        }
        if (!d_points.empty()) {
            detail::check_size("d_points", d_points.size(), dim_ * n_points_);
        }
        if (!d_normals.empty()) {
            detail::check_size("d_normals", d_normals.size(), dim_ * n_points_);
        }
        return n;
    }

    detail::Handle<ko_sensitivity, ko_sensitivity_free> handle_;
    std::size_t n_points_;
    std::uint32_t dim_;
};

/// The aggregate of values [n], with D the `unit`, and, where they are not empty, `gradient` [n] and `hessian` [n * (n + 1) / 2], rows of
/// the lower triangle. `extreme` is KO_LEAST or KO_LARGEST.
inline double aggregate(const Aggregation &aggregation, std::int32_t extreme, double unit, Span<const double> values,
                        Span<double> gradient = {}, Span<double> hessian = {}) {
    const std::size_t n = values.size();
    if (!gradient.empty()) {
        detail::check_size("gradient", gradient.size(), n);
    }
    if (!hessian.empty()) {
        detail::check_size("hessian", hessian.size(), n * (n + 1) / 2);
    }
    double value = 0.0;
    detail::check(ko_aggregate(&aggregation, extreme, unit, values.data(), n, &value, gradient.data(), hessian.data()));
    return value;
}

/// How far an aggregate of KO_LEAST may lie from the least value, in units of D.
struct Bounds {
    double below;
    double above;
};

/// Those of an aggregate of `n_values` values; `least`, the least of them in units of D, counts for KO_AGGREGATE_P_NORM alone.
inline Bounds aggregation_bounds(const Aggregation &aggregation, std::size_t n_values, double least = 0.0) {
    Bounds bounds{};
    detail::check(ko_aggregation_bounds(&aggregation, n_values, least, &bounds.below, &bounds.above));
    return bounds;
}

/// Points of a design that move with it, and how densely they cover its surface.
class Body {
public:
    /// Takes ownership of `handle`.
    explicit Body(ko_body *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

    /// From points [dim * n], of which one is within `covering_radius` of each point of the surface; 0: not known.
    static Body from_points(Span<const double> points, double covering_radius = 0.0, std::uint32_t dim = 3) {
        const std::size_t n = detail::count("points", points.size(), dim == 2 ? 2 : 3);
        ko_body *handle = nullptr;
        detail::check(ko_body_from_points(dim, points.data(), n, covering_radius, &handle));
        return Body(handle);
    }

    /// Points on `mesh`, so many that one is within `covering_radius` of each point of its surface or curves.
    static Body from_mesh(const Mesh &mesh, double covering_radius) {
        ko_body *handle = nullptr;
        detail::check(ko_body_from_mesh(mesh.get(), covering_radius, &handle));
        return Body(handle);
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    std::size_t size() const {
        std::size_t n = 0;
        detail::check(ko_body_get_size(get(), &n));
        return n;
    }

    /// 0: not known.
    double covering_radius() const {
        double radius = 0.0;
        detail::check(ko_body_get_covering_radius(get(), &radius));
        return radius;
    }

    /// [dim() * size()]
    std::vector<double> points() const {
        const std::size_t n = size();
        std::vector<double> points(dim_ * n);
        detail::check(ko_body_copy_points(get(), n, points.data()));
        return points;
    }

    const ko_body *get() const noexcept { return handle_.get(); }
    ko_body *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_body, ko_body_free> handle_;
    std::uint32_t dim_;
};

/// Requirements that samples of a design lie where fields are positive, over one vector of variables x.
///
/// What takes a Span to write to allocates nothing and locks nothing; any number of threads may evaluate at once.
class Constraints {
public:
    /// Takes ownership of `handle`.
    explicit Constraints(ko_constraints *handle) noexcept : handle_(handle) {}

    /// Without variables and values; `dim` 2 or 3.
    static Constraints create(std::uint32_t dim = 3) {
        ko_constraints *handle = nullptr;
        detail::check(ko_constraints_create(dim, &handle));
        return Constraints(handle);
    }

    /// A frame whose parameters are variables: its number. `rotation` is a KO_ROTATION_, `scale` a KO_SCALE_ constant.
    std::uint32_t add_frame(std::int32_t rotation, std::int32_t scale = KO_SCALE_ONE) {
        std::uint32_t frame = 0;
        detail::check(ko_constraints_add_frame(get(), rotation, scale, &frame));
        return frame;
    }

    /// A frame that stands still at `parameters`: its number.
    std::uint32_t add_fixed_frame(std::int32_t rotation, std::int32_t scale, Span<const double> parameters) {
        std::uint32_t frame = 0;
        detail::check(
            ko_constraints_add_fixed_frame(get(), rotation, scale, parameters.data(), parameters.size(), &frame));
        return frame;
    }

    /// Points whose coordinates are variables: their number.
    std::uint32_t add_points(std::size_t n_points) {
        std::uint32_t points = 0;
        detail::check(ko_constraints_add_points(get(), n_points, &points));
        return points;
    }

    /// Keeps `body` in `frame` where phi of `field` in `field_frame` is positive: the number of the first value. Body and field may go.
    std::size_t keep_body(const Body &body, std::uint32_t frame, const Field &field, std::uint32_t field_frame = KO_WORLD,
                          const Aggregation &aggregation = {}) {
        std::size_t first = 0;
        detail::check(
            ko_constraints_keep_body(get(), body.get(), frame, field.get(), field_frame, &aggregation, &first));
        return first;
    }

    /// The same of points that are variables, by their number.
    std::size_t keep_points(std::uint32_t points, const Field &field, std::uint32_t field_frame = KO_WORLD,
                            const Aggregation &aggregation = {}) {
        std::size_t first = 0;
        detail::check(ko_constraints_keep_points(get(), points, field.get(), field_frame, &aggregation, &first));
        return first;
    }

    /// Fields in one frame and one unit of length, by reference: {tank, other}.
    using Fields = std::vector<std::reference_wrapper<const Field>>;

    /// Keeps `body` in `frame` in the union, KO_LARGEST, or the intersection, KO_LEAST, of the feasible sets of `fields`, whose phi become
    /// one by `combination`: the number of the first value. Body and fields may go.
    std::size_t keep_body_in_fields(const Body &body, std::uint32_t frame, const Fields &fields, std::int32_t extreme,
                                    const Aggregation &combination = {}, std::uint32_t field_frame = KO_WORLD,
                                    const Aggregation &aggregation = {}) {
        std::size_t first = 0;
        const std::vector<const ko_field *> handles = handles_of(fields);
        detail::check(ko_constraints_keep_body_in_fields(get(), body.get(), frame, handles.data(), handles.size(), extreme,
                                                         &combination, field_frame, &aggregation, &first));
        return first;
    }

    /// The same of points that are variables, by their number.
    std::size_t keep_points_in_fields(std::uint32_t points, const Fields &fields, std::int32_t extreme,
                                      const Aggregation &combination = {}, std::uint32_t field_frame = KO_WORLD,
                                      const Aggregation &aggregation = {}) {
        std::size_t first = 0;
        const std::vector<const ko_field *> handles = handles_of(fields);
        detail::check(ko_constraints_keep_points_in_fields(get(), points, handles.data(), handles.size(), extreme, &combination,
                                                           field_frame, &aggregation, &first));
        return first;
    }

    struct Size {
        std::size_t n_variables;
        std::size_t n_values;
        std::size_t n_jacobian; ///< entries of the Jacobian's pattern
        std::size_t n_hessian;  ///< entries of the Hessian's
    };

    Size size() const {
        Size size{};
        detail::check(ko_constraints_get_size(get(), &size.n_variables, &size.n_values, &size.n_jacobian, &size.n_hessian));
        return size;
    }

    /// Variables first, first + 1, ...
    struct Variables {
        std::size_t first;
        std::size_t n;
    };

    /// Those of a frame, none of one that stands still.
    Variables frame_variables(std::uint32_t frame) const {
        Variables variables{};
        detail::check(ko_constraints_get_frame_variables(get(), frame, &variables.first, &variables.n));
        return variables;
    }

    Variables points_variables(std::uint32_t points) const {
        Variables variables{};
        detail::check(ko_constraints_get_points_variables(get(), points, &variables.first, &variables.n));
        return variables;
    }

    /// Where entries stand, counted from 0.
    struct Pattern {
        std::vector<std::int32_t> rows;
        std::vector<std::int32_t> columns;
    };

    /// [n_jacobian], rows being values, columns variables.
    Pattern jacobian_pattern() const {
        const std::size_t n = size().n_jacobian;
        Pattern pattern{std::vector<std::int32_t>(n), std::vector<std::int32_t>(n)};
        detail::check(ko_constraints_jacobian_pattern(get(), n, pattern.rows.data(), pattern.columns.data()));
        return pattern;
    }

    /// [n_hessian], both variables, columns no larger than rows.
    Pattern hessian_pattern() const {
        const std::size_t n = size().n_hessian;
        Pattern pattern{std::vector<std::int32_t>(n), std::vector<std::int32_t>(n)};
        detail::check(ko_constraints_hessian_pattern(get(), n, pattern.rows.data(), pattern.columns.data()));
        return pattern;
    }

    /// Values [n_values] at x [n_variables], each to be kept at or above 0.
    void values(Span<const double> x, Span<double> values) const {
        detail::check(ko_constraints_values(get(), x.data(), x.size(), values.size(), values.data()));
    }

    std::vector<double> values(Span<const double> x) const {
        std::vector<double> found(size().n_values);
        values(x, found);
        return found;
    }

    /// Entries [n_jacobian] of the Jacobian at x [n_variables], in the order of jacobian_pattern().
    void jacobian(Span<const double> x, Span<double> entries) const {
        detail::check(ko_constraints_jacobian(get(), x.data(), x.size(), entries.size(), entries.data()));
    }

    std::vector<double> jacobian(Span<const double> x) const {
        std::vector<double> entries(size().n_jacobian);
        jacobian(x, entries);
        return entries;
    }

    /// Both at once.
    void values_and_jacobian(Span<const double> x, Span<double> values, Span<double> entries) const {
        detail::check(ko_constraints_values_and_jacobian(get(), x.data(), x.size(), values.size(), values.data(),
                                                         entries.size(), entries.data()));
    }

    /// The Jacobian at x [n_variables] as a whole, jacobian [n_values * n_variables], row-major.
    void dense_jacobian(Span<const double> x, Span<double> jacobian) const {
        const std::size_t n = size().n_values;
        detail::check_size("jacobian", jacobian.size(), n * x.size());
        detail::check(ko_constraints_dense_jacobian(get(), x.data(), x.size(), n, jacobian.data()));
    }

    std::vector<double> dense_jacobian(Span<const double> x) const {
        std::vector<double> jacobian(size().n_values * x.size());
        dense_jacobian(x, jacobian);
        return jacobian;
    }

    /// J v, product [n_values], at x [n_variables] for v [n_variables].
    void jacobian_times(Span<const double> x, Span<const double> v, Span<double> product) const {
        detail::check_size("v", v.size(), x.size());
        detail::check(
            ko_constraints_jacobian_times(get(), x.data(), v.data(), x.size(), product.size(), product.data()));
    }

    std::vector<double> jacobian_times(Span<const double> x, Span<const double> v) const {
        std::vector<double> product(size().n_values);
        jacobian_times(x, v, product);
        return product;
    }

    /// J^T w, product [n_variables], at x [n_variables] for w [n_values].
    void transposed_jacobian_times(Span<const double> x, Span<const double> w, Span<double> product) const {
        detail::check_size("product", product.size(), x.size());
        detail::check(ko_constraints_transposed_jacobian_times(get(), x.data(), x.size(), w.data(), w.size(),
                                                               product.data()));
    }

    std::vector<double> transposed_jacobian_times(Span<const double> x, Span<const double> w) const {
        std::vector<double> product(x.size());
        transposed_jacobian_times(x, w, product);
        return product;
    }

    /// Entries [n_hessian] of the Hessian of the sum of lambda [n_values] times the values, in the order of hessian_pattern().
    void hessian(Span<const double> x, Span<const double> lambda, Span<double> entries) const {
        detail::check(ko_constraints_hessian(get(), x.data(), x.size(), lambda.data(), lambda.size(), entries.size(),
                                             entries.data()));
    }

    std::vector<double> hessian(Span<const double> x, Span<const double> lambda) const {
        std::vector<double> entries(size().n_hessian);
        hessian(x, lambda, entries);
        return entries;
    }

    const ko_constraints *get() const noexcept { return handle_.get(); }
    ko_constraints *get() noexcept { return handle_.get(); }

private:
    static std::vector<const ko_field *> handles_of(const Fields &fields) {
        std::vector<const ko_field *> handles;
        for (const Field &field : fields) handles.push_back(field.get());
        return handles;
    }

    detail::Handle<ko_constraints, ko_constraints_free> handle_;
};

/// A formulation that is a formula of the points of a cloud, to compare a field with.
class Explicit {
public:
    /// Takes ownership of `handle`, made of a cloud of dimension `dim`.
    explicit Explicit(ko_explicit *handle, std::uint32_t dim) noexcept : handle_(handle), dim_(dim) {}

    /// Of the points of `cloud`, to which it does not refer.
    static Explicit create(const Cloud &cloud, const ExplicitOptions &options = {}) {
        ko_explicit *handle = nullptr;
        detail::check(ko_explicit_create(cloud.get(), &options, &handle));
        return Explicit(handle, cloud.dim());
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    /// rho, in 1 / D; 0 where the formula has none.
    double smoothing() const {
        double smoothing = 0.0;
        detail::check(ko_explicit_get_smoothing(get(), &smoothing));
        return smoothing;
    }

    /// Evaluates at points [dim() * n] into values [n] and gradients [dim() * n]; empty: not wanted. No allocation, no lock; any number of
    /// threads at once.
    void eval(Span<const double> points, Span<double> values, Span<double> gradients = {}) const {
        const std::size_t n = detail::count("points", points.size(), dim_);
        if (!values.empty()) {
            detail::check_size("values", values.size(), n);
        }
        if (!gradients.empty()) {
            detail::check_size("gradients", gradients.size(), dim_ * n);
        }
        detail::check(ko_explicit_eval(get(), points.data(), n, values.data(), gradients.data()));
    }

    /// Values alone at points [dim() * n].
    std::vector<double> values(Span<const double> points) const {
        std::vector<double> values(detail::count("points", points.size(), dim_));
        eval(points, values);
        return values;
    }

    const ko_explicit *get() const noexcept { return handle_.get(); }
    ko_explicit *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_explicit, ko_explicit_free> handle_;
    std::uint32_t dim_;
};

/// How far two triangulations are apart, and how much they cross, with `b` moved by `translation` [3], empty for none. `sharpness` 0: the
/// minimum distance itself, else its KS. The gradients [3 * b.n_vertices()] are by the vertices of `b`; empty: not wanted.
inline ko_separation separation(const Mesh &a, const Mesh &b, Span<const double> translation = {}, double sharpness = 0.0,
                                Span<double> distance_gradients = {}, Span<double> length_gradients = {}) {
    const std::size_t n = b.n_vertices();
    if (!translation.empty()) {
        detail::check_size("translation", translation.size(), 3);
    }
    if (!distance_gradients.empty()) {
        detail::check_size("distance_gradients", distance_gradients.size(), 3 * n);
    }
    if (!length_gradients.empty()) {
        detail::check_size("length_gradients", length_gradients.size(), 3 * n);
    }
    ko_separation found;
    detail::check(ko_meshes_separation(a.get(), b.get(), translation.data(), sharpness, n, sizeof found, &found,
                                       distance_gradients.data(), length_gradients.data()));
    return found;
}

/// amplitude cos(2 pi cycles t + phase)
struct Wave {
    double amplitude;
    double cycles;
    double phase;
};

/// How far along its way a motion is at t in [0, 1]: f(t) = offset + slope t + the waves.
struct Law {
    double offset = 0.0;
    double slope = 0.0;
    std::vector<Wave> waves;
};

namespace detail {

/// Status of `call(law)`, with the law as C has it.
template <class Call>
void with_law(const Law &law, const Call &call) {
    std::vector<double> waves;
    for (const Wave &wave : law.waves) {
        waves.insert(waves.end(), {wave.amplitude, wave.cycles, wave.phase});
    }
    ko_law plain;
    check(ko_law_init(&plain, sizeof plain));
    plain.offset = law.offset;
    plain.slope = law.slope;
    plain.waves = waves.data();
    plain.n_waves = law.waves.size();
    check(call(&plain));
}

template <class T>
const T *or_null(Span<const T> numbers) noexcept {
    return numbers.empty() ? nullptr : numbers.data();
}

} // namespace detail

/// A pose: x_w = R x + t.
struct Pose {
    std::vector<double> rotation;    ///< R, [dim * dim], row-major
    std::vector<double> translation; ///< t, [dim]
};

class Part;

/// A rigid motion of one parameter t in [0, 1], from a part's frame to the world. What is made of one goes on without it.
class Motion {
public:
    /// Takes ownership of `handle`.
    explicit Motion(ko_motion *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

    /// Told the time, and writes the pose's rotation [dim * dim], row-major, and translation [dim].
    using Function = std::function<void(double time, double *rotation, double *translation)>;

    /// At a pose: rotation [dim * dim], row-major, and translation [dim]; each may be empty for none.
    static Motion fixed(std::uint32_t dim, Span<const double> rotation = {}, Span<const double> translation = {}) {
        if (!rotation.empty()) {
            detail::check_size("rotation", rotation.size(), dim * dim);
        }
        if (!translation.empty()) {
            detail::check_size("translation", translation.size(), dim);
        }
        ko_motion *handle = nullptr;
        detail::check(ko_motion_fixed(dim, detail::or_null(rotation), detail::or_null(translation), &handle));
        return Motion(handle);
    }

    /// A slide by f(t) times along [dim].
    static Motion slide(Span<const double> along, const Law &law) {
        ko_motion *handle = nullptr;
        detail::with_law(law, [&](const ko_law *plain) {
            return ko_motion_slide(static_cast<std::uint32_t>(along.size()), along.data(), plain, &handle);
        });
        return Motion(handle);
    }

    /// A turn in the plane about center [2], by f(t) radians counter-clockwise.
    static Motion turn(Span<const double> center, const Law &law) {
        detail::check_size("center", center.size(), 2);
        ko_motion *handle = nullptr;
        detail::with_law(law, [&](const ko_law *plain) { return ko_motion_turn(center.data(), plain, &handle); });
        return Motion(handle);
    }

    /// A screw in space about the line through point [3] along axis [3]: f(t) radians, and a slide of `lead` a radian.
    static Motion screw(Span<const double> point, Span<const double> axis, double lead, const Law &law) {
        detail::check_size("point", point.size(), 3);
        detail::check_size("axis", axis.size(), 3);
        ko_motion *handle = nullptr;
        detail::with_law(law, [&](const ko_law *plain) {
            return ko_motion_screw(point.data(), axis.data(), lead, plain, &handle);
        });
        return Motion(handle);
    }

    /// Through poses at even times: rotations [dim * dim * n], row-major each, and translations [dim * n].
    static Motion sampled(std::uint32_t dim, Span<const double> rotations, Span<const double> translations) {
        const std::size_t n = detail::count("translations", translations.size(), dim == 2 ? 2 : 3);
        detail::check_size("rotations", rotations.size(), dim * translations.size());
        ko_motion *handle = nullptr;
        detail::check(ko_motion_sampled(dim, rotations.data(), translations.data(), n, &handle));
        return Motion(handle);
    }

    /// Through `n_poses` poses that `pose` is asked for at even times. What it throws comes out of the call. With a part a jump is an error: where a
    /// point of its grid would be faster than max_speed.
    static Motion from_function(std::uint32_t dim, const Function &pose, std::size_t n_poses, const Part *part = nullptr,
                                double max_speed = 0.0);

    /// Two wheels about centers [4] that turn against each other: the first by `turns` counter-clockwise, the second by `ratio` times that.
    static std::array<Motion, 2> gears(Span<const double> centers, double turns, double ratio) {
        detail::check_size("centers", centers.size(), 4);
        ko_motion *first = nullptr, *second = nullptr;
        detail::check(ko_motion_gears(centers.data(), turns, ratio, &first, &second));
        return {Motion(first), Motion(second)};
    }

    /// Crank, coupler and rocker of a four-bar linkage with pivots [4] and lengths [3], see ko_motion_four_bar.
    static std::array<Motion, 3> four_bar(Span<const double> pivots, Span<const double> lengths, double from, double by,
                                          std::int32_t bend, std::size_t n_steps) {
        detail::check_size("pivots", pivots.size(), 4);
        detail::check_size("lengths", lengths.size(), 3);
        ko_motion *crank = nullptr, *coupler = nullptr, *rocker = nullptr;
        detail::check(ko_motion_four_bar(pivots.data(), lengths.data(), from, by, bend, n_steps, &crank, &coupler, &rocker));
        return {Motion(crank), Motion(coupler), Motion(rocker)};
    }

    /// tau(t) = this(t) inner(t)
    Motion product(const Motion &inner) const {
        ko_motion *handle = nullptr;
        detail::check(ko_motion_product(get(), inner.get(), &handle));
        return Motion(handle);
    }

    Motion inverse() const {
        ko_motion *handle = nullptr;
        detail::check(ko_motion_inverse(get(), &handle));
        return Motion(handle);
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    /// Poses at times [n] into rotations [dim() * dim() * n] and translations [dim() * n].
    void eval(Span<const double> times, Span<double> rotations, Span<double> translations) const {
        detail::check_size("rotations", rotations.size(), dim_ * dim_ * times.size());
        detail::check_size("translations", translations.size(), dim_ * times.size());
        detail::check(ko_motion_eval(get(), times.data(), times.size(), rotations.data(), translations.data()));
    }

    Pose pose(double time) const {
        Pose pose{std::vector<double>(dim_ * dim_), std::vector<double>(dim_)};
        eval({&time, 1}, pose.rotation, pose.translation);
        return pose;
    }

    const ko_motion *get() const noexcept { return handle_.get(); }
    ko_motion *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_motion, ko_motion_free> handle_;
    std::uint32_t dim_;
};

/// A set of a part's cells: a byte a cell, 1 where it is in the set.
using CellSet = std::vector<std::uint8_t>;

/// A grid of square or cubic cells, and what a part may do with each.
class Part {
public:
    /// Takes ownership of `handle`.
    explicit Part(ko_part *handle) noexcept : handle_(handle), dim_(detail::dim_of(handle)) {}

    /// counts [dim] cells of this edge from corner [dim] on; cells are KO_CELL_ constants, empty: all are free.
    static Part create(Span<const double> corner, double cell_edge, Span<const std::size_t> counts,
                       Span<const std::uint8_t> cells = {}) {
        detail::check_size("counts", counts.size(), corner.size());
        ko_part *handle = nullptr;
        detail::check(ko_part_create(static_cast<std::uint32_t>(corner.size()), corner.data(), cell_edge, counts.data(),
                                     detail::or_null(cells), cells.size(), &handle));
        return Part(handle);
    }

    /// 3 in space, 2 in the plane.
    std::uint32_t dim() const noexcept { return dim_; }

    /// Cells.
    std::size_t size() const {
        std::size_t n = 0;
        detail::check(ko_part_get_size(get(), nullptr, &n));
        return n;
    }

    struct Grid {
        std::vector<double> corner;      ///< [dim()]
        double cell_edge;                ///< of each cell
        std::vector<std::size_t> counts; ///< [dim()]
    };

    Grid grid() const {
        Grid grid{std::vector<double>(dim_), 0.0, std::vector<std::size_t>(dim_)};
        detail::check(ko_part_get_grid(get(), grid.corner.data(), &grid.cell_edge, grid.counts.data()));
        return grid;
    }

    /// KO_CELL_ constants [size()].
    std::vector<std::uint8_t> cells() const {
        std::vector<std::uint8_t> cells(size());
        detail::check(ko_part_copy_cells(get(), cells.size(), cells.data()));
        return cells;
    }

    /// What part of each cell a mesh's solid fills, [size()], by `samples` points along a cell's edge.
    std::vector<double> fractions(const Mesh &mesh, std::uint32_t samples = 8, std::uint32_t n_threads = 0) const {
        std::vector<double> out(size());
        detail::check(ko_part_fractions_of_mesh(get(), mesh.get(), samples, n_threads, out.size(), out.data()));
        return out;
    }

    /// The same of a field's solid; `steepness` bounds the length of its gradient.
    std::vector<double> fractions(const Field &field, double steepness, std::uint32_t samples = 8,
                                  std::uint32_t n_threads = 0) const {
        std::vector<double> out(size());
        detail::check(ko_part_fractions_of_field(get(), field.get(), steepness, samples, n_threads, out.size(), out.data()));
        return out;
    }

    /// The same of a box from box_min [dim()] to box_max [dim()].
    std::vector<double> fractions_of_box(Span<const double> box_min, Span<const double> box_max, std::uint32_t samples = 8,
                                         std::uint32_t n_threads = 0) const {
        detail::check_size("box_min", box_min.size(), dim_);
        detail::check_size("box_max", box_max.size(), dim_);
        std::vector<double> out(size());
        detail::check(
            ko_part_fractions_of_box(get(), box_min.data(), box_max.data(), samples, n_threads, out.size(), out.data()));
        return out;
    }

    /// The same of a ball or disc around center [dim()].
    std::vector<double> fractions_of_ball(Span<const double> center, double radius, std::uint32_t samples = 8,
                                          std::uint32_t n_threads = 0) const {
        detail::check_size("center", center.size(), dim_);
        std::vector<double> out(size());
        detail::check(ko_part_fractions_of_ball(get(), center.data(), radius, samples, n_threads, out.size(), out.data()));
        return out;
    }

    /// The same of a cylinder or strip between the middles of its ends [2 * dim()].
    std::vector<double> fractions_of_cylinder(Span<const double> ends, double radius, std::uint32_t samples = 8,
                                              std::uint32_t n_threads = 0) const {
        detail::check_size("ends", ends.size(), 2 * dim_);
        std::vector<double> out(size());
        detail::check(ko_part_fractions_of_cylinder(get(), ends.data(), radius, samples, n_threads, out.size(), out.data()));
        return out;
    }

    /// The cells of `still` that this part's `cells`, empty: all that it may have, pass over.
    CellSet sweep(const Motion &motion, const Part &still, const Motion &still_motion, Span<const std::uint8_t> cells = {},
                  const PairOptions &options = {}) const {
        CellSet swept(still.size());
        detail::listened<ko_pair_options>(options, [&](const ko_pair_options &plain) {
            return ko_part_sweep(get(), detail::or_null(cells), cells.size(), motion.get(), still.get(), still_motion.get(),
                                 &plain, swept.size(), swept.data());
        });
        return swept;
    }

    /// Takes out of `kept` [size()] what breaks `rule`, KO_AVOID or KO_STAY_IN, about `body` and its cells, empty: all that it may have.
    void unsweep(const Motion &motion, const Part &body, const Motion &body_motion, std::int32_t rule,
                 Span<std::uint8_t> kept, Span<const std::uint8_t> body_cells = {}, const PairOptions &options = {}) const {
        detail::listened<ko_pair_options>(options, [&](const ko_pair_options &plain) {
            return ko_part_unsweep(get(), motion.get(), body.get(), detail::or_null(body_cells), body_cells.size(),
                                   body_motion.get(), rule, &plain, kept.size(), kept.data());
        });
    }

    /// The mesh that bounds a set of cells: closed, within the cells with KO_WITHIN_CELLS.
    Mesh mesh_of_cells(Span<const std::uint8_t> cells, std::int32_t within = KO_WITHIN_CELLS, std::uint32_t rounds = 20,
                       const OnProgress &on_progress = {}) const {
        ko_mesh *handle = nullptr;
        detail::listened<detail::Told>(
            detail::Listening(on_progress), handle, ko_mesh_free, [&](const detail::Told &plain, ko_mesh **mesh) {
                return ko_part_mesh_of_cells(get(), cells.data(), cells.size(), within, rounds, plain.progress,
                                             plain.progress_data, mesh);
            });
        return Mesh(handle);
    }

    /// The same of the cells whose density is above `level`.
    Mesh mesh_of_densities(Span<const double> densities, double level = 0.5, std::int32_t within = KO_WITHIN_CELLS,
                           std::uint32_t rounds = 20, const OnProgress &on_progress = {}) const {
        ko_mesh *handle = nullptr;
        detail::listened<detail::Told>(
            detail::Listening(on_progress), handle, ko_mesh_free, [&](const detail::Told &plain, ko_mesh **mesh) {
                return ko_part_mesh_of_densities(get(), densities.data(), densities.size(), level, within, rounds,
                                                 plain.progress, plain.progress_data, mesh);
            });
        return Mesh(handle);
    }

    const ko_part *get() const noexcept { return handle_.get(); }
    ko_part *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_part, ko_part_free> handle_;
    std::uint32_t dim_;
};

inline Motion Motion::from_function(std::uint32_t dim, const Function &pose, std::size_t n_poses, const Part *part,
                                    double max_speed) {
    struct Asked {
        const Function &pose;
        std::exception_ptr thrown;

        static std::int32_t ask(double time, double *rotation, double *translation, void *data) noexcept {
            auto &self = *static_cast<Asked *>(data);
            try {
                self.pose(time, rotation, translation);
                return 0;
            } catch (...) {
                self.thrown = std::current_exception();
                return 1;
            }
        }
    } asked{pose, nullptr};
    ko_motion *handle = nullptr;
    const std::int32_t status = ko_motion_from_function(dim, Asked::ask, &asked, n_poses, part == nullptr ? nullptr : part->get(),
                                                        max_speed, &handle);
    if (asked.thrown) {
        std::rethrow_exception(asked.thrown);
    }
    detail::check(status);
    return Motion(handle);
}

/// A set of cells, or densities, for each part of a pair.
template <class T>
struct OfParts {
    std::vector<T> first;
    std::vector<T> second;
};

using CellSets = OfParts<std::uint8_t>;

/// Two parts in relative motion: how they collide, and sets of cells that never do. Any number of threads may use one at once.
class Pair {
public:
    /// Takes ownership of `handle`.
    explicit Pair(ko_pair *handle) : handle_(handle) {
        if (handle != nullptr) {
            const ko_pair_report found = report();
            dim_ = found.dim;
            n_1_ = static_cast<std::size_t>(found.n_cells[0]);
            n_2_ = static_cast<std::size_t>(found.n_cells[1]);
        }
    }

    /// It refers to neither parts nor motions. Where they never meet, report().n_edges is 0.
    static Pair create(const Part &part_1, const Motion &motion_1, const Part &part_2, const Motion &motion_2,
                       const PairOptions &options = {}) {
        ko_pair *handle = nullptr;
        detail::listened<ko_pair_options>(options, handle, ko_pair_free, [&](const ko_pair_options &plain, ko_pair **pair) {
            return ko_pair_create(part_1.get(), motion_1.get(), part_2.get(), motion_2.get(), &plain, pair);
        });
        return Pair(handle);
    }

    ko_pair_report report() const {
        ko_pair_report report;
        detail::check(ko_pair_get_report(get(), sizeof report, &report));
        return report;
    }

    struct Measures {
        double g21;
        double g12;
    };

    /// (29) and (30) of densities [n_1], [n_2].
    Measures measures(Span<const double> densities_1, Span<const double> densities_2, std::uint32_t n_threads = 0) const {
        Measures found{};
        detail::check(ko_pair_measures(get(), densities_1.data(), densities_1.size(), densities_2.data(), densities_2.size(),
                                       n_threads, &found.g21, &found.g12));
        return found;
    }

    /// (12), l21 of part 1's cells, and (13), l12 of part 2's.
    OfParts<double> local_measures(Span<const double> densities_1, Span<const double> densities_2,
                                   std::uint32_t n_threads = 0) const {
        OfParts<double> found{std::vector<double>(densities_1.size()), std::vector<double>(densities_2.size())};
        detail::check(ko_pair_local_measures(get(), densities_1.data(), densities_1.size(), densities_2.data(),
                                             densities_2.size(), n_threads, found.first.data(), found.second.data()));
        return found;
    }

    struct Sensitivities {
        OfParts<double> g21; ///< by densities_1 and by densities_2
        OfParts<double> g12;
    };

    /// (31) and (32).
    Sensitivities sensitivities(Span<const double> densities_1, Span<const double> densities_2,
                                std::uint32_t n_threads = 0) const {
        const std::size_t n_1 = densities_1.size(), n_2 = densities_2.size();
        Sensitivities found{{std::vector<double>(n_1), std::vector<double>(n_2)},
                            {std::vector<double>(n_1), std::vector<double>(n_2)}};
        detail::check(ko_pair_sensitivities(get(), densities_1.data(), n_1, densities_2.data(), n_2, n_threads,
                                            found.g21.first.data(), found.g21.second.data(), found.g12.first.data(),
                                            found.g12.second.data()));
        return found;
    }

    /// (B.1) and (B.2), by `change`, KO_CHANGE_PUT or KO_CHANGE_TAKE.
    Sensitivities topological_sensitivities(Span<const double> densities_1, Span<const double> densities_2,
                                            std::int32_t change, std::uint32_t n_threads = 0) const {
        const std::size_t n_1 = densities_1.size(), n_2 = densities_2.size();
        Sensitivities found{{std::vector<double>(n_1), std::vector<double>(n_2)},
                            {std::vector<double>(n_1), std::vector<double>(n_2)}};
        detail::check(ko_pair_topological_sensitivities(get(), densities_1.data(), n_1, densities_2.data(), n_2, change,
                                                        n_threads, found.g21.first.data(), found.g21.second.data(),
                                                        found.g12.first.data(), found.g12.second.data()));
        return found;
    }

    /// The initially colliding subdomains, (33) to (36).
    CellSets colliding() const {
        CellSets sets = none();
        detail::check(ko_pair_colliding(get(), n_1_, n_2_, sets.first.data(), sets.second.data()));
        return sets;
    }

    struct Volumes {
        std::array<double, 2> volumes; ///< what is left of the colliding cells
        double gamma;                  ///< NaN where nothing is
        std::size_t n_lost;            ///< cells of part 2 that conflict with the first set
    };

    /// Of any sets.
    Volumes volumes(const CellSets &sets) const {
        Volumes found{};
        detail::check(ko_pair_volumes(get(), sets.first.data(), sets.first.size(), sets.second.data(), sets.second.size(),
                                      found.volumes.data(), &found.gamma, &found.n_lost));
        return found;
    }

    struct Closed {
        CellSets cells;
        double gamma;
    };

    /// From any sets to a pair that never collides and cannot grow; `from` 1 or 2, 0: the larger.
    Closed close(const CellSets &sets, std::uint32_t from = 0) const {
        Closed closed{none(), 0.0};
        if (from != 2) {
            detail::check_size("the first set", sets.first.size(), n_1_);
        }
        if (from != 1) {
            detail::check_size("the second set", sets.second.size(), n_2_);
        }
        detail::check(ko_pair_close(get(), sets.first.data(), sets.second.data(), from, n_1_, n_2_, closed.cells.first.data(),
                                    closed.cells.second.data(), &closed.gamma));
        return closed;
    }

    struct Cut {
        CellSets cells;
        double weight;
        double bound; ///< no pair weighs more
        double gamma;
    };

    /// The pair of the greatest weight; weights [n_1] and [n_2], empty: areas or volumes.
    Cut cut(Span<const double> weights_1 = {}, Span<const double> weights_2 = {}, const FamilyOptions &options = {}) const {
        check_weights(weights_1, weights_2);
        Cut found{none(), 0.0, 0.0, 0.0};
        detail::listened<ko_family_options>(options, [&](const ko_family_options &plain) {
            return ko_pair_cut(get(), detail::or_null(weights_1), detail::or_null(weights_2), &plain, n_1_, n_2_,
                               found.cells.first.data(), found.cells.second.data(), &found.weight, &found.bound, &found.gamma);
        });
        return found;
    }

    struct Member {
        CellSets cells;
        double gamma;                  ///< that of the pair
        std::array<double, 2> volumes; ///< what is left of the colliding cells
        double bound;                  ///< no pair of the gamma that was asked for has more
    };

    /// A pair for each gamma; weights as in cut().
    std::vector<Member> family(Span<const double> gammas, Span<const double> weights_1 = {},
                               Span<const double> weights_2 = {}, const FamilyOptions &options = {}) const {
        check_weights(weights_1, weights_2);
        const std::size_t n = gammas.size();
        CellSets all{CellSet(n * n_1_), CellSet(n * n_2_)};
        std::vector<double> reached(n), volumes(2 * n), bounds(n);
        detail::listened<ko_family_options>(options, [&](const ko_family_options &plain) {
            return ko_pair_family(get(), detail::or_null(weights_1), detail::or_null(weights_2), gammas.data(), n, &plain, n_1_,
                                  n_2_, all.first.data(), all.second.data(), reached.data(), volumes.data(), bounds.data());
        });
        std::vector<Member> members;
        for (std::size_t k = 0; k < n; k++) {
            const auto row = [k](const CellSet &set, std::size_t width) {
                const auto begin = set.begin() + static_cast<std::ptrdiff_t>(k * width);
                return CellSet(begin, begin + static_cast<std::ptrdiff_t>(width));
            };
            members.push_back(Member{{row(all.first, n_1_), row(all.second, n_2_)},
                                     reached[k],
                                     {volumes[2 * k], volumes[2 * k + 1]},
                                     bounds[k]});
        }
        return members;
    }

    struct Optimised {
        OfParts<double> densities;
        CellSets cells;                             ///< closed
        std::vector<std::array<double, 5>> history; ///< V_1, V_2, g_21, g_12, change
        ko_optimise_report report;
    };

    /// Moving asymptotes, then closure. report.converged tells whether iterations sufficed.
    Optimised optimise(const OptimiseOptions &options = {}) const {
        Optimised found{{std::vector<double>(n_1_), std::vector<double>(n_2_)}, none(), {}, {}};
        std::vector<double> history(5 * (std::size_t{options.max_iterations} + 1));
        detail::listened<ko_optimise_options>(options, [&](const ko_optimise_options &plain) {
            return ko_pair_optimise(get(), &plain, n_1_, n_2_, found.densities.first.data(), found.densities.second.data(),
                                    found.cells.first.data(), found.cells.second.data(), history.data(), sizeof found.report,
                                    &found.report);
        });
        for (std::size_t k = 0; k <= found.report.n_iterations; k++) {
            const double *row = history.data() + 5 * k;
            found.history.push_back({row[0], row[1], row[2], row[3], row[4]});
        }
        return found;
    }

    struct Contact {
        std::vector<double> gaps;       ///< [n_times]
        std::vector<std::size_t> cells; ///< [2 * n_times], those nearest to each other
        std::vector<double> places;     ///< [dim * n_times], in part 1's frame
        double largest;
        double mean;
    };

    /// Gaps of a pair that does not collide, at even times.
    Contact contact(const CellSets &sets, std::size_t n_times, std::uint32_t n_threads = 0,
                    const OnProgress &on_progress = {}) const {
        Contact found{std::vector<double>(n_times), std::vector<std::size_t>(2 * n_times), std::vector<double>(dim_ * n_times),
                      0.0, 0.0};
        detail::listened<detail::Told>(detail::Listening(on_progress), [&](const detail::Told &plain) {
            return ko_pair_contact(get(), sets.first.data(), sets.first.size(), sets.second.data(), sets.second.size(), n_times,
                                   n_threads, plain.progress, plain.progress_data, found.gaps.data(), found.cells.data(),
                                   found.places.data(), &found.largest, &found.mean);
        });
        return found;
    }

    struct Persistent {
        CellSets cells;
        double before; ///< persistence of the sets
        double after;  ///< that of the cells
        std::size_t n_tries;
    };

    /// Of the pairs as heavy as `sets`, one of the greatest weight by these weights, one that keeps better in touch; weights as in cut().
    Persistent more_persistent(const CellSets &sets, Span<const double> weights_1 = {}, Span<const double> weights_2 = {},
                               const PersistenceOptions &options = {}) const {
        detail::check_size("the first set", sets.first.size(), n_1_);
        detail::check_size("the second set", sets.second.size(), n_2_);
        check_weights(weights_1, weights_2);
        Persistent found{none(), 0.0, 0.0, 0};
        detail::listened<ko_persistence_options>(options, [&](const ko_persistence_options &plain) {
            return ko_pair_more_persistent(get(), sets.first.data(), sets.second.data(), detail::or_null(weights_1),
                                           detail::or_null(weights_2), &plain, n_1_, n_2_, found.cells.first.data(),
                                           found.cells.second.data(), &found.before, &found.after, &found.n_tries);
        });
        return found;
    }

    const ko_pair *get() const noexcept { return handle_.get(); }
    ko_pair *get() noexcept { return handle_.get(); }

private:
    CellSets none() const { return {CellSet(n_1_), CellSet(n_2_)}; }

    void check_weights(Span<const double> weights_1, Span<const double> weights_2) const {
        if (!weights_1.empty()) {
            detail::check_size("weights_1", weights_1.size(), n_1_);
        }
        if (!weights_2.empty()) {
            detail::check_size("weights_2", weights_2.size(), n_2_);
        }
    }

    detail::Handle<ko_pair, ko_pair_free> handle_;
    std::uint32_t dim_ = detail::dim_of_none;
    std::size_t n_1_ = 0;
    std::size_t n_2_ = 0;
};

/// Any number of parts, none of which collides with another. Sets and weights are of the cells of all parts, part after part. Any number of
/// threads may use one at once.
class Assembly {
public:
    /// Takes ownership of `handle`.
    explicit Assembly(ko_assembly *handle) : handle_(handle) {
        if (handle != nullptr) {
            n_cells_ = static_cast<std::size_t>(report().n_cells);
        }
    }

    /// It refers to neither parts nor motions, of which there is one for each; nullptr: the part stays. Where none meet, meetings() is empty.
    static Assembly create(Span<const Part *const> parts, Span<const Motion *const> motions, const PairOptions &options = {}) {
        detail::check_size("motions", motions.size(), parts.size());
        std::vector<const ko_part *> of_c;
        std::vector<const ko_motion *> by_c;
        for (std::size_t k = 0; k < parts.size(); k++) {
            const Part *part = parts.data()[k];
            const Motion *motion = motions.data()[k];
            of_c.push_back(part == nullptr ? nullptr : part->get());
            by_c.push_back(motion == nullptr ? nullptr : motion->get());
        }
        ko_assembly *handle = nullptr;
        const auto make = [&](const ko_pair_options &plain, ko_assembly **assembly) {
            return ko_assembly_create(of_c.data(), by_c.data(), of_c.size(), &plain, assembly);
        };
        detail::listened<ko_pair_options>(options, handle, ko_assembly_free, make);
        return Assembly(handle);
    }

    ko_assembly_report report() const {
        ko_assembly_report report;
        detail::check(ko_assembly_get_report(get(), sizeof report, &report));
        return report;
    }

    /// Pairs of parts of which some cells conflict, the smaller number first.
    std::vector<std::array<std::size_t, 2>> meetings() const {
        const std::size_t n = static_cast<std::size_t>(report().n_meetings);
        std::vector<std::size_t> numbers(2 * n);
        detail::check(ko_assembly_copy_meetings(get(), n, numbers.data()));
        std::vector<std::array<std::size_t, 2>> found;
        for (std::size_t k = 0; k < n; k++) {
            found.push_back({numbers[2 * k], numbers[2 * k + 1]});
        }
        return found;
    }

    /// From any sets to parts that never collide and of which none can grow; `order` [n_parts], empty: in that in which they were given.
    CellSet close(Span<const std::uint8_t> sets, Span<const std::size_t> order = {}) const {
        if (!order.empty()) {
            detail::check_size("order", order.size(), report().n_parts);
        }
        CellSet cells(n_cells_);
        detail::check_size("sets", sets.size(), n_cells_);
        detail::check(ko_assembly_close(get(), sets.data(), detail::or_null(order), n_cells_, cells.data()));
        return cells;
    }

    struct Arrangement {
        CellSet cells;
        double weight;
        double bound; ///< no parts weigh more
        std::size_t n_cuts;
    };

    /// Parts of great weight that never collide; weights [n_cells], empty: areas or volumes.
    Arrangement arrange(Span<const double> weights = {}, const ArrangeOptions &options = {}) const {
        if (!weights.empty()) {
            detail::check_size("weights", weights.size(), n_cells_);
        }
        Arrangement found{CellSet(n_cells_), 0.0, 0.0, 0};
        detail::listened<ko_arrange_options>(options, [&](const ko_arrange_options &plain) {
            return ko_assembly_arrange(get(), detail::or_null(weights), &plain, n_cells_, found.cells.data(), &found.weight,
                                       &found.bound, &found.n_cuts);
        });
        return found;
    }

    const ko_assembly *get() const noexcept { return handle_.get(); }
    ko_assembly *get() noexcept { return handle_.get(); }

private:
    detail::Handle<ko_assembly, ko_assembly_free> handle_;
    std::size_t n_cells_ = 0;
};

} // namespace keepout

#endif
