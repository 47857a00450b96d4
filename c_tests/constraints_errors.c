/* The errors of aggregates, bodies and constraints: every pointer NULL in turn, wrong lengths, numbers out of range, mixed dimensions. */

#include "check.h"

static const double nan_value = NAN;

/* ---- aggregates ---- */

static void aggregations_out_of_range_are_refused(void) {
    const double numbers[3] = {1, 2, 3};
    double value = 7.0, gradient[3] = {7, 7, 7}, hessian[6] = {7, 7, 7, 7, 7, 7};
    ko_aggregation ks = check_aggregation(KO_AGGREGATE_KS);
#define AGGREGATE_FAILS(aggregation, extreme, unit, numbers, n, words)                                              \
    FAILS(ko_aggregate((aggregation), (extreme), (unit), (numbers), (n), &value, gradient, hessian),                \
          KO_ERR_INVALID_ARGUMENT, (words))
    AGGREGATE_FAILS(&ks, KO_LEAST, 1.0, NULL, 3, "values is NULL");
    AGGREGATE_FAILS(&ks, KO_LEAST, 1.0, MISALIGNED(numbers), 2, "values is at");
    AGGREGATE_FAILS(&ks, KO_LEAST, 1.0, NULL, 0, "there are no values; at least 1 is needed");
    AGGREGATE_FAILS(&ks, KO_LEAST, 1.0, numbers, SIZE_MAX / 4, "values is said to have");
    AGGREGATE_FAILS(&ks, 2, 1.0, numbers, 3, "extreme is 2; it must be KO_LEAST (0) or KO_LARGEST (1)");
    AGGREGATE_FAILS(&ks, -1, 1.0, numbers, 3, "extreme is -1");
    AGGREGATE_FAILS(&ks, KO_LEAST, 0.0, numbers, 3, "unit is 0; it must lie in [1e-90, 1e90]");
    AGGREGATE_FAILS(&ks, KO_LEAST, -1.0, numbers, 3, "unit is -1");
    AGGREGATE_FAILS(&ks, KO_LEAST, nan_value, numbers, 3, "unit is NaN");
    AGGREGATE_FAILS(&ks, KO_LEAST, 1e91, numbers, 3, "unit is 1");
    const double bad[3] = {1, nan_value, INFINITY}, huge[3] = {1, 2, -1.1e12};
    AGGREGATE_FAILS(&ks, KO_LEAST, 1.0, bad, 3, "value 1 is NaN");
    AGGREGATE_FAILS(&ks, KO_LEAST, 1.0, huge, 3, "value 2 is -1100000000000; values must be finite, and at most 1e12 times");
    FAILS(ko_aggregate(&ks, KO_LEAST, 1.0, numbers, 3, MISALIGNED(&value), NULL, NULL), KO_ERR_INVALID_ARGUMENT,
          "value is at");
    FAILS(ko_aggregate(&ks, KO_LEAST, 1.0, numbers, 2, &value, MISALIGNED(gradient), NULL), KO_ERR_INVALID_ARGUMENT,
          "gradient is at");
    FAILS(ko_aggregate(&ks, KO_LEAST, 1.0, numbers, 2, &value, NULL, MISALIGNED(hessian)), KO_ERR_INVALID_ARGUMENT,
          "hessian is at");
    ko_aggregation none = check_aggregation(KO_AGGREGATE_NONE), minimum = check_aggregation(KO_AGGREGATE_MINIMUM);
    AGGREGATE_FAILS(&none, KO_LEAST, 1.0, numbers, 3, "no aggregation is asked for");
    FAILS(ko_aggregate(&minimum, KO_LEAST, 1.0, numbers, 3, &value, NULL, hessian), KO_ERR_UNSUPPORTED,
          "the minimum is not smooth");

#define OPTION_FAILS(member, to, words)                                   \
    do {                                                                  \
        ko_aggregation aggregation = check_aggregation(KO_AGGREGATE_KS);  \
        aggregation.member = (to);                                        \
        AGGREGATE_FAILS(&aggregation, KO_LEAST, 1.0, numbers, 3, words);  \
        double bound = 7.0;                                               \
        FAILS(ko_aggregation_bounds(&aggregation, 3, 0.0, &bound, NULL), KO_ERR_INVALID_ARGUMENT, (words)); \
        CHECK(bound == 7.0);                                              \
    } while (0)
    OPTION_FAILS(kind, 5, "kind is 5; it must be a KO_AGGREGATE_ constant, 0 to 4");
    OPTION_FAILS(kind, -1, "kind is -1");
    OPTION_FAILS(side, 2, "side is 2; it must be KO_BELOW (0) or KO_ABOVE (1)");
    OPTION_FAILS(sharpness, 0.9, "sharpness is 0.9; it must lie in [1, 1e9]");
    OPTION_FAILS(sharpness, 2e9, "sharpness is 2000000000");
    OPTION_FAILS(sharpness, nan_value, "sharpness is NaN");
    OPTION_FAILS(struct_size, 8, "aggregation has struct_size 8");
    OPTION_FAILS(struct_size, 1 << 20, "struct_size 1048576");
#undef OPTION_FAILS
    AGGREGATE_FAILS(MISALIGNED(&ks), KO_LEAST, 1.0, numbers, 3, "aggregation is at");
#undef AGGREGATE_FAILS
    struct {
        ko_aggregation aggregation;
        unsigned char newer[16];
    } grown;
    OK(ko_aggregation_init(&grown.aggregation, sizeof grown));
    OK(ko_aggregate(&grown.aggregation, KO_LEAST, 1.0, numbers, 3, NULL, NULL, NULL));
    grown.newer[9] = 1;
    FAILS(ko_aggregate(&grown.aggregation, KO_LEAST, 1.0, numbers, 3, &value, NULL, NULL), KO_ERR_UNSUPPORTED, "newer");
    FAILS(ko_aggregation_init(NULL, sizeof ks), KO_ERR_INVALID_ARGUMENT, "aggregation is NULL");
    FAILS(ko_aggregation_init(&ks, 8), KO_ERR_INVALID_ARGUMENT, "struct_size 8");

    FAILS(ko_aggregation_bounds(NULL, 0, 0.0, &value, NULL), KO_ERR_INVALID_ARGUMENT, "n_values is 0");
    FAILS(ko_aggregation_bounds(NULL, 3, nan_value, &value, NULL), KO_ERR_INVALID_ARGUMENT, "least is NaN");
    FAILS(ko_aggregation_bounds(NULL, 3, -1.1e12, &value, NULL), KO_ERR_INVALID_ARGUMENT, "least is -1100000000000");
    FAILS(ko_aggregation_bounds(NULL, 3, 0.0, MISALIGNED(&value), NULL), KO_ERR_INVALID_ARGUMENT, "below is at");
    FAILS(ko_aggregation_bounds(NULL, 3, 0.0, NULL, MISALIGNED(&value)), KO_ERR_INVALID_ARGUMENT, "above is at");
    CHECK(value == 7.0 && gradient[0] == 7.0 && hessian[5] == 7.0);
}

/* ---- bodies ---- */

static void bodies_that_are_none_are_refused(void) {
    double points[12] = {0};
    ko_body *body = STALE(ko_body);
#define POINTS_FAIL(dim, points, n, radius, words)                                                                   \
    do {                                                                                                             \
        body = STALE(ko_body);                                                                                       \
        FAILS(ko_body_from_points((dim), (points), (n), (radius), &body), KO_ERR_INVALID_ARGUMENT, (words));         \
        CHECK(body == NULL);                                                                                         \
    } while (0)
    POINTS_FAIL(1, points, 4, 0.0, "dim is 1; it must be 2 or 3");
    POINTS_FAIL(4, points, 3, 0.0, "dim is 4");
    POINTS_FAIL(3, NULL, 4, 0.0, "points is NULL");
    POINTS_FAIL(3, MISALIGNED(points), 3, 0.0, "points is at");
    POINTS_FAIL(3, NULL, 0, 0.0, "a body has 0 points");
    POINTS_FAIL(2, points, SIZE_MAX / 8, 0.0, "points is said to have");
    POINTS_FAIL(3, points, 4, -1.0, "covering_radius is -1");
    POINTS_FAIL(3, points, 4, nan_value, "covering_radius is NaN");
    POINTS_FAIL(3, points, 4, INFINITY, "covering_radius is inf");
    points[8] = nan_value;
    POINTS_FAIL(3, points, 4, 0.0, "point 2 is (0, 0, NaN)");
    POINTS_FAIL(2, points, 6, 0.0, "point 4 is (NaN, 0)");
    points[8] = 1e91;
    POINTS_FAIL(3, points, 4, 0.0, "point 2 is ");
#undef POINTS_FAIL
    FAILS(ko_body_from_points(3, points, 1, 0.0, NULL), KO_ERR_INVALID_ARGUMENT, "body is NULL");

    ko_mesh *mesh = check_cube();
    const double radii[] = {0.0, -1.0, NAN, INFINITY, 1e91, 1e-91, 1e-60};
    const char *const words[] = {"covering_radius is 0", "covering_radius is -1", "covering_radius is NaN",
                                 "covering_radius is inf", "covering_radius is 1", "covering_radius is 0.0",
                                 "pieces or more, of which 2147483648 can be served; a larger one is needed"};
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
        body = STALE(ko_body);
        FAILS(ko_body_from_mesh(mesh, radii[i], &body), KO_ERR_INVALID_ARGUMENT, words[i]);
        CHECK(body == NULL);
    }
    FAILS(ko_body_from_mesh(NULL, 1.0, &body), KO_ERR_INVALID_ARGUMENT, "mesh is NULL");
    FAILS(ko_body_from_mesh(mesh, 1.0, NULL), KO_ERR_INVALID_ARGUMENT, "body is NULL");
    ko_mesh_free(mesh);

    uint32_t dim = 77;
    size_t n = 77;
    double number = 77.0;
    body = check_body(3, 4, 1);
    FAILS(ko_body_get_dim(NULL, &dim), KO_ERR_INVALID_ARGUMENT, "body is NULL");
    FAILS(ko_body_get_dim(body, NULL), KO_ERR_INVALID_ARGUMENT, "dim is NULL");
    FAILS(ko_body_get_size(NULL, &n), KO_ERR_INVALID_ARGUMENT, "body is NULL");
    FAILS(ko_body_get_size(body, NULL), KO_ERR_INVALID_ARGUMENT, "n_points is NULL");
    FAILS(ko_body_get_covering_radius(NULL, &number), KO_ERR_INVALID_ARGUMENT, "body is NULL");
    FAILS(ko_body_get_covering_radius(body, NULL), KO_ERR_INVALID_ARGUMENT, "covering_radius is NULL");
    FAILS(ko_body_copy_points(NULL, 4, points), KO_ERR_INVALID_ARGUMENT, "body is NULL");
    FAILS(ko_body_copy_points(body, 3, points), KO_ERR_INVALID_ARGUMENT, "n_points is 3; the object has 4");
    FAILS(ko_body_copy_points(body, 4, NULL), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_body_copy_points(body, 4, MISALIGNED(points)), KO_ERR_INVALID_ARGUMENT, "points is at");
    CHECK(dim == 77 && n == 77 && number == 77.0 && points[0] == 0.0);
    ko_body_free(body);
}

/* ---- what is added ---- */

static void what_cannot_be_added_is_refused(void) {
    ko_constraints *space = STALE(ko_constraints), *plane = NULL;
    FAILS(ko_constraints_create(4, &space), KO_ERR_INVALID_ARGUMENT, "dim is 4; it must be 2 or 3");
    CHECK(space == NULL);
    FAILS(ko_constraints_create(3, NULL), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    OK(ko_constraints_create(3, &space));
    OK(ko_constraints_create(2, &plane));

    uint32_t made = 77;
#define FRAME_FAILS(set, rotation, scale, words) \
    FAILS(ko_constraints_add_frame((set), (rotation), (scale), &made), KO_ERR_INVALID_ARGUMENT, (words))
    FRAME_FAILS(NULL, KO_ROTATION_NONE, KO_SCALE_ONE, "constraints is NULL");
    FRAME_FAILS(space, 4, KO_SCALE_ONE, "rotation is 4; it must be a KO_ROTATION_ constant, 0 to 3");
    FRAME_FAILS(space, -1, KO_SCALE_ONE, "rotation is -1");
    FRAME_FAILS(space, KO_ROTATION_NONE, 2, "scale is 2; it must be KO_SCALE_ONE (0) or KO_SCALE_FREE (1)");
    FRAME_FAILS(space, KO_ROTATION_ANGLE, KO_SCALE_ONE, "dimension 3 is turned by a quaternion or a rotation vector, not by an angle");
    FRAME_FAILS(plane, KO_ROTATION_QUATERNION, KO_SCALE_ONE, "dimension 2 is turned by an angle, not by a quaternion");
    FRAME_FAILS(plane, KO_ROTATION_VECTOR, KO_SCALE_ONE, "not by a rotation vector");
#undef FRAME_FAILS
    FAILS(ko_constraints_add_frame(space, KO_ROTATION_NONE, KO_SCALE_ONE, NULL), KO_ERR_INVALID_ARGUMENT, "frame is NULL");

    double pose[8] = {1, 2, 3, 1, 0, 0, 0, 1};
#define FIXED_FAILS(set, rotation, scale, pose, n, words)                                                              \
    FAILS(ko_constraints_add_fixed_frame((set), (rotation), (scale), (pose), (n), &made), KO_ERR_INVALID_ARGUMENT, (words))
    FIXED_FAILS(NULL, KO_ROTATION_NONE, KO_SCALE_ONE, pose, 3, "constraints is NULL");
    FIXED_FAILS(space, 9, KO_SCALE_ONE, pose, 3, "rotation is 9");
    FIXED_FAILS(space, KO_ROTATION_NONE, -1, pose, 3, "scale is -1");
    FIXED_FAILS(space, KO_ROTATION_ANGLE, KO_SCALE_ONE, pose, 4, "not by an angle");
    FIXED_FAILS(space, KO_ROTATION_NONE, KO_SCALE_ONE, NULL, 3, "parameters is NULL");
    FIXED_FAILS(space, KO_ROTATION_NONE, KO_SCALE_ONE, MISALIGNED(pose), 3, "parameters is at");
    FIXED_FAILS(space, KO_ROTATION_NONE, KO_SCALE_ONE, NULL, 0, "the pose has 0 parameters; such a frame has 3");
    FIXED_FAILS(space, KO_ROTATION_QUATERNION, KO_SCALE_FREE, pose, 7, "the pose has 7 parameters; such a frame has 8");
    FIXED_FAILS(plane, KO_ROTATION_ANGLE, KO_SCALE_FREE, pose, 3, "the pose has 3 parameters; such a frame has 4");
    pose[7] = 0.0;
    FIXED_FAILS(space, KO_ROTATION_QUATERNION, KO_SCALE_FREE, pose, 8, "parameter 7 is the scale 0; it must lie in [1e-30, 1e30]");
    pose[3] = 0.0;
    FIXED_FAILS(space, KO_ROTATION_QUATERNION, KO_SCALE_ONE, pose, 7, "parameters 3 to 6 are a quaternion of length 0");
    pose[3] = 2e6;
    FIXED_FAILS(space, KO_ROTATION_QUATERNION, KO_SCALE_ONE, pose, 7, "are a quaternion of length 2000000");
    FIXED_FAILS(space, KO_ROTATION_VECTOR, KO_SCALE_ONE, pose, 6, "parameters 3 to 5 are a rotation vector of length 2000000");
    pose[2] = 2e6;
    FIXED_FAILS(plane, KO_ROTATION_ANGLE, KO_SCALE_ONE, pose, 3, "parameter 2 is the angle 2000000");
    pose[1] = nan_value;
    FIXED_FAILS(space, KO_ROTATION_NONE, KO_SCALE_ONE, pose, 3, "parameter 1 is NaN; it must be finite");
#undef FIXED_FAILS
    FAILS(ko_constraints_add_fixed_frame(space, KO_ROTATION_NONE, KO_SCALE_ONE, pose, 3, NULL), KO_ERR_INVALID_ARGUMENT,
          "frame is NULL");

    FAILS(ko_constraints_add_points(NULL, 1, &made), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    FAILS(ko_constraints_add_points(space, 1, NULL), KO_ERR_INVALID_ARGUMENT, "points is NULL");
    FAILS(ko_constraints_add_points(space, 0, &made), KO_ERR_INVALID_ARGUMENT, "0 points are asked for");
    FAILS(ko_constraints_add_points(space, INT32_MAX / 3 + 1, &made), KO_ERR_INVALID_ARGUMENT, "can be served");
    FAILS(ko_constraints_add_points(space, SIZE_MAX, &made), KO_ERR_INVALID_ARGUMENT, "can be served");
    size_t n = 77;
    OK(ko_constraints_get_size(space, &n, NULL, NULL, NULL));
    CHECK(made == 77 && n == 0);
    OK(ko_constraints_add_points(space, INT32_MAX / 3, &made));
    FAILS(ko_constraints_add_points(space, 1, &made), KO_ERR_INVALID_ARGUMENT, "2147483649 variables; at most 2147483647");
    FAILS(ko_constraints_add_frame(space, KO_ROTATION_NONE, KO_SCALE_ONE, &made), KO_ERR_INVALID_ARGUMENT, "variables; at most");
    CHECK(made == 0);
    /* Entries beyond the integers of optimisers: of points that an aggregate couples, and of the Jacobian the third time. */
    ko_field *field = check_made_field(3);
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE);
    FAILS(ko_constraints_keep_points(space, made, field, KO_WORLD, NULL, &n), KO_ERR_INVALID_ARGUMENT,
          "the Hessian would have 2305843005992468481 entries");
    ko_constraints_free(space);
    OK(ko_constraints_create(3, &space));
    OK(ko_constraints_add_points(space, 300000000, &made));
    OK(ko_constraints_keep_points(space, made, field, KO_WORLD, &each, NULL));
    OK(ko_constraints_keep_points(space, made, field, KO_WORLD, &each, NULL));
    FAILS(ko_constraints_keep_points(space, made, field, KO_WORLD, &each, NULL), KO_ERR_INVALID_ARGUMENT,
          "there would be 2700000000 entries of the Jacobian; at most 2147483647");
    ko_field_free(field);
    ko_constraints_free(space);
    ko_constraints_free(plane);
}

/* Fields that cannot be combined, of a `set` in space that has this frame and these points. */
static void sets_that_are_none_are_refused(ko_constraints *set, const ko_body *body, uint32_t frame, uint32_t points,
                                           const ko_field *field, const ko_field *flat_field, const ko_body *flat_body) {
    const ko_field *fields[257], *with_null[2] = {field, NULL}, *with_flat[2] = {field, flat_field};
    for (int f = 0; f < 257; f++) {
        fields[f] = field;
    }
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE), bad = check_aggregation(KO_AGGREGATE_KS);
    bad.sharpness = 0.0;
    size_t first = 77;
#define FIELDS_FAIL(set, fields, n, extreme, combination, field_frame, aggregation, words)                               \
    FAILS(ko_constraints_keep_body_in_fields((set), body, frame, (fields), (n), (extreme), (combination), (field_frame), \
                                             (aggregation), &first),                                                     \
          KO_ERR_INVALID_ARGUMENT, (words));                                                                             \
    FAILS(ko_constraints_keep_points_in_fields((set), points, (fields), (n), (extreme), (combination), (field_frame),    \
                                               (aggregation), &first),                                                   \
          KO_ERR_INVALID_ARGUMENT, (words))
    FIELDS_FAIL(NULL, fields, 2, KO_LEAST, NULL, KO_WORLD, NULL, "constraints is NULL");
    FIELDS_FAIL(set, NULL, 2, KO_LEAST, NULL, KO_WORLD, NULL, "fields is NULL");
    FIELDS_FAIL(set, MISALIGNED(fields), 2, KO_LEAST, NULL, KO_WORLD, NULL, "fields is at");
    FIELDS_FAIL(set, fields, 0, KO_LEAST, NULL, KO_WORLD, NULL, "0 fields are given; from 1 to 256 can be combined");
    FIELDS_FAIL(set, NULL, 0, KO_LEAST, NULL, KO_WORLD, NULL, "0 fields are given");
    FIELDS_FAIL(set, fields, 257, KO_LEAST, NULL, KO_WORLD, NULL, "257 fields are given");
    FIELDS_FAIL(set, fields, SIZE_MAX, KO_LEAST, NULL, KO_WORLD, NULL, "fields are given");
    FIELDS_FAIL(set, with_null, 2, KO_LEAST, NULL, KO_WORLD, NULL, "field 1 of fields is NULL");
    FIELDS_FAIL(set, with_flat, 2, KO_LEAST, NULL, KO_WORLD, NULL,
                "the constraints dim 3, field 1 of fields dim 2; they must be the same");
    FIELDS_FAIL(set, fields, 2, 2, NULL, KO_WORLD, NULL, "extreme is 2; it must be KO_LEAST (0) or KO_LARGEST (1)");
    FIELDS_FAIL(set, fields, 2, KO_LARGEST, &each, KO_WORLD, NULL, "no combination is asked for");
    FIELDS_FAIL(set, fields, 2, KO_LARGEST, &bad, KO_WORLD, NULL, "combination of the fields: sharpness is 0");
    FIELDS_FAIL(set, fields, 2, KO_LARGEST, NULL, 2, NULL, "there is no frame 2");
    FIELDS_FAIL(set, fields, 2, KO_LARGEST, NULL, KO_WORLD, &bad, "sharpness is 0");
#undef FIELDS_FAIL
#define BODY_FAILS(body, frame, field_frame, first, words)                                                               \
    FAILS(ko_constraints_keep_body_in_fields(set, (body), (frame), fields, 2, KO_LEAST, NULL, (field_frame), NULL, (first)), \
          KO_ERR_INVALID_ARGUMENT, (words))
    BODY_FAILS(NULL, frame, KO_WORLD, &first, "body is NULL");
    BODY_FAILS(flat_body, frame, KO_WORLD, &first, "the constraints dim 3, the body dim 2; they must be the same");
    BODY_FAILS(body, 2, KO_WORLD, &first, "there is no frame 2");
    BODY_FAILS(body, frame, frame, &first, "samples and field both move with frame 1");
    BODY_FAILS(body, frame, KO_WORLD, MISALIGNED(&first), "first_value is at");
#undef BODY_FAILS
    FAILS(ko_constraints_keep_points_in_fields(set, 1, fields, 2, KO_LEAST, NULL, KO_WORLD, NULL, &first), KO_ERR_INVALID_ARGUMENT,
          "there is no set of points 1");
    FAILS(ko_constraints_keep_points_in_fields(set, points, fields, 2, KO_LEAST, NULL, KO_WORLD, NULL, MISALIGNED(&first)),
          KO_ERR_INVALID_ARGUMENT, "first_value is at");
    CHECK(first == 77);
}

static void what_cannot_be_kept_is_refused(void) {
    ko_constraints *set = NULL, *plane = NULL;
    ko_body *body = check_body(3, 4, 1), *flat_body = check_body(2, 4, 1);
    ko_field *field = check_made_field(3), *flat_field = check_made_field(2);
    uint32_t frame = 0, points = 77, flat_points = 77;
    size_t first = 77;
    OK(ko_constraints_create(3, &set));
    OK(ko_constraints_create(2, &plane));
    OK(ko_constraints_add_frame(set, KO_ROTATION_NONE, KO_SCALE_ONE, &frame));
    OK(ko_constraints_add_points(set, 2, &points));
    OK(ko_constraints_add_points(plane, 2, &flat_points));
    ko_aggregation bad = check_aggregation(KO_AGGREGATE_KS);
    bad.sharpness = 0.0;
#define BODY_FAILS(set, body, frame, field, field_frame, aggregation, words)                                             \
    FAILS(ko_constraints_keep_body((set), (body), (frame), (field), (field_frame), (aggregation), &first),               \
          KO_ERR_INVALID_ARGUMENT, (words))
    BODY_FAILS(NULL, body, frame, field, KO_WORLD, NULL, "constraints is NULL");
    BODY_FAILS(set, NULL, frame, field, KO_WORLD, NULL, "body is NULL");
    BODY_FAILS(set, body, frame, NULL, KO_WORLD, NULL, "field is NULL");
    BODY_FAILS(set, body, 2, field, KO_WORLD, NULL, "there is no frame 2; 2 are there, the world counted, from 0");
    BODY_FAILS(set, body, frame, field, UINT32_MAX, NULL, "there is no frame 4294967295");
    BODY_FAILS(set, body, frame, field, frame, NULL, "samples and field both move with frame 1");
    BODY_FAILS(set, body, frame, field, KO_WORLD, &bad, "sharpness is 0");
    BODY_FAILS(set, flat_body, frame, field, KO_WORLD, NULL,
               "the constraints dim 3, the body dim 2, the field dim 3; they must be the same");
    BODY_FAILS(set, body, frame, flat_field, KO_WORLD, NULL, "the field dim 2");
    BODY_FAILS(plane, body, KO_WORLD, flat_field, KO_WORLD, NULL, "the constraints dim 2, the body dim 3");
#undef BODY_FAILS
    FAILS(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, NULL, MISALIGNED(&first)), KO_ERR_INVALID_ARGUMENT,
          "first_value is at");
#define KEPT_FAILS(set, points, field, field_frame, aggregation, words)                                                  \
    FAILS(ko_constraints_keep_points((set), (points), (field), (field_frame), (aggregation), &first),                    \
          KO_ERR_INVALID_ARGUMENT, (words))
    KEPT_FAILS(NULL, points, field, KO_WORLD, NULL, "constraints is NULL");
    KEPT_FAILS(set, points, NULL, KO_WORLD, NULL, "field is NULL");
    KEPT_FAILS(set, 1, field, KO_WORLD, NULL, "there is no set of points 1; 1 were added, counted from 0");
    KEPT_FAILS(set, points, field, 2, NULL, "there is no frame 2");
    KEPT_FAILS(set, points, field, KO_WORLD, &bad, "sharpness is 0");
    KEPT_FAILS(set, points, flat_field, KO_WORLD, NULL, "the constraints dim 3, the field dim 2; they must be the same");
    KEPT_FAILS(plane, flat_points, field, KO_WORLD, NULL, "the constraints dim 2, the field dim 3");
#undef KEPT_FAILS
    FAILS(ko_constraints_keep_points(set, points, field, KO_WORLD, NULL, MISALIGNED(&first)), KO_ERR_INVALID_ARGUMENT,
          "first_value is at");
    sets_that_are_none_are_refused(set, body, frame, points, field, flat_field, flat_body);
    /* What failed left nothing behind. */
    size_t n = 77, m = 77, n_jacobian = 77, n_hessian = 77;
    OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, &n_hessian));
    CHECK(first == 77 && n == 9 && m == 0 && n_jacobian == 0 && n_hessian == 0);
    FAILS(ko_constraints_get_size(NULL, &n, NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    FAILS(ko_constraints_get_size(set, MISALIGNED(&n), NULL, NULL, NULL), KO_ERR_INVALID_ARGUMENT, "n_variables is at");
    FAILS(ko_constraints_get_size(set, &m, MISALIGNED(&n), NULL, NULL), KO_ERR_INVALID_ARGUMENT, "n_values is at");
    FAILS(ko_constraints_get_size(set, &m, NULL, MISALIGNED(&n), NULL), KO_ERR_INVALID_ARGUMENT, "n_jacobian is at");
    FAILS(ko_constraints_get_size(set, &m, NULL, NULL, MISALIGNED(&n)), KO_ERR_INVALID_ARGUMENT, "n_hessian is at");
    FAILS(ko_constraints_get_frame_variables(NULL, 0, &n, &m), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    FAILS(ko_constraints_get_frame_variables(set, 0, NULL, &m), KO_ERR_INVALID_ARGUMENT, "first is NULL");
    FAILS(ko_constraints_get_frame_variables(set, 0, &n, NULL), KO_ERR_INVALID_ARGUMENT, "n_variables is NULL");
    FAILS(ko_constraints_get_frame_variables(set, 2, &n, &m), KO_ERR_INVALID_ARGUMENT, "there is no frame 2");
    FAILS(ko_constraints_get_points_variables(NULL, 0, &n, &m), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    FAILS(ko_constraints_get_points_variables(set, 0, NULL, &m), KO_ERR_INVALID_ARGUMENT, "first is NULL");
    FAILS(ko_constraints_get_points_variables(set, 0, &n, NULL), KO_ERR_INVALID_ARGUMENT, "n_variables is NULL");
    FAILS(ko_constraints_get_points_variables(set, 1, &n, &m), KO_ERR_INVALID_ARGUMENT, "there is no set of points 1");
    CHECK(n == 9 && m == 0);
    ko_constraints_free(set);
    ko_constraints_free(plane);
    ko_body_free(body);
    ko_body_free(flat_body);
    ko_field_free(field);
    ko_field_free(flat_field);
}

/* ---- what is evaluated ---- */

/* A frame that is turned by a quaternion, a point; three values of a body in that frame, and one of the point in a field in it. */
enum { N = 7 + 3, M = 3 + 1, N_JACOBIAN = 3 * 7 + 10, N_HESSIAN = 28 + 6 + 21 };

static ko_constraints *make_set(void) {
    ko_constraints *set = NULL;
    ko_field *field = check_made_field(3);
    ko_body *body = check_body(3, 3, 1);
    uint32_t frame = 0, point = 0;
    ko_aggregation each = check_aggregation(KO_AGGREGATE_NONE);
    OK(ko_constraints_create(3, &set));
    OK(ko_constraints_add_frame(set, KO_ROTATION_QUATERNION, KO_SCALE_ONE, &frame));
    OK(ko_constraints_add_points(set, 1, &point));
    OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, &each, NULL));
    OK(ko_constraints_keep_points(set, point, field, frame, NULL, NULL));
    ko_body_free(body);
    ko_field_free(field);
    size_t n = 0, m = 0, n_jacobian = 0, n_hessian = 0;
    OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, &n_hessian));
    CHECK(n == N && m == M && n_jacobian == N_JACOBIAN && n_hessian == N_HESSIAN);
    return set;
}

/* Every call that evaluates fails so at `x`. */
static void evaluations_fail(const ko_constraints *set, const double *x, const char *words) {
    const double v[N] = {0}, w[M] = {1, 1, 1, 1};
    double values[M], entries[N_JACOBIAN], dense[M * N], product[N], hessian[N_HESSIAN];
    FAILS(ko_constraints_values(set, x, N, M, values), KO_ERR_INVALID_ARGUMENT, words);
    FAILS(ko_constraints_jacobian(set, x, N, N_JACOBIAN, entries), KO_ERR_INVALID_ARGUMENT, words);
    FAILS(ko_constraints_values_and_jacobian(set, x, N, M, values, N_JACOBIAN, entries), KO_ERR_INVALID_ARGUMENT, words);
    FAILS(ko_constraints_dense_jacobian(set, x, N, M, dense), KO_ERR_INVALID_ARGUMENT, words);
    FAILS(ko_constraints_jacobian_times(set, x, v, N, M, product), KO_ERR_INVALID_ARGUMENT, words);
    FAILS(ko_constraints_transposed_jacobian_times(set, x, N, w, M, product), KO_ERR_INVALID_ARGUMENT, words);
    FAILS(ko_constraints_hessian(set, x, N, w, M, N_HESSIAN, hessian), KO_ERR_INVALID_ARGUMENT, words);
}

static void variables_out_of_range_are_named(void) {
    ko_constraints *set = make_set();
    const double sound[N] = {0.1, 0.2, 0.3, 1, 0, 0, 0, 0.3, 0.2, 0.1};
    double x[N];
    evaluations_fail(NULL, sound, "constraints is NULL");
    evaluations_fail(set, NULL, "x is NULL");
    evaluations_fail(set, MISALIGNED(sound), "x is at");
    memcpy(x, sound, sizeof x);
    x[8] = nan_value;
    evaluations_fail(set, x, "variable 8 is NaN; it must be finite");
    x[2] = -INFINITY;
    evaluations_fail(set, x, "variable 2 is -inf");
    memcpy(x, sound, sizeof x);
    x[3] = 0.0;
    evaluations_fail(set, x, "frame 1, with variables from 0 on: parameters 3 to 6 are a quaternion of length 0");
    memcpy(x, sound, sizeof x);
    x[1] = 1e200;
    evaluations_fail(set, x, "samples of value 0, in the field's frame: point 0 is ");
    memcpy(x, sound, sizeof x);
    x[8] = 1e200;
    evaluations_fail(set, x, "samples of value 3, in the field's frame: point 0 is ");
    ko_constraints_free(set);
}

/* Samples are counted through, not from the first of those that are evaluated together. */
static void samples_out_of_range_are_named(void) {
    enum { N_MANY = 400 };
    ko_field *field = check_made_field(3);
    double *x = check_points(N_MANY, 0.5, 1), values[N_MANY], entries[3 * N_MANY], lambda[N_MANY];
    double *hessian = malloc(sizeof *hessian * 3 * N_MANY * (3 * N_MANY + 1) / 2);
    for (int i = 0; i < N_MANY; i++) {
        lambda[i] = 1.0;
    }
    x[3 * 300 + 1] = 1e200;
    for (int32_t kind = KO_AGGREGATE_NONE; kind <= KO_AGGREGATE_P_NORM; kind++) {
        ko_aggregation aggregation = check_aggregation(kind);
        ko_constraints *set = NULL;
        uint32_t points = 0;
        size_t n = 0, m = 0, n_jacobian = 0, n_hessian = 0;
        OK(ko_constraints_create(3, &set));
        OK(ko_constraints_add_points(set, N_MANY, &points));
        OK(ko_constraints_keep_points(set, points, field, KO_WORLD, &aggregation, NULL));
        OK(ko_constraints_get_size(set, &n, &m, &n_jacobian, &n_hessian));
        FAILS(ko_constraints_values(set, x, n, m, values), KO_ERR_INVALID_ARGUMENT, "point 300 is ");
        FAILS(ko_constraints_jacobian(set, x, n, n_jacobian, entries), KO_ERR_INVALID_ARGUMENT, "point 300 is ");
        FAILS(ko_constraints_hessian(set, x, n, lambda, m, n_hessian, hessian), KO_ERR_INVALID_ARGUMENT, "point 300 is ");
        ko_constraints_free(set);
    }
    free(x);
    free(hessian);
    ko_field_free(field);
}

static void lengths_are_checked(void) {
    ko_constraints *set = make_set();
    const double x[N + 1] = {0.1, 0.2, 0.3, 1, 0, 0, 0, 0.3, 0.2, 0.1}, w[M + 1] = {1, 1, 1, 1, 1};
    double values[M + 1], entries[N_JACOBIAN + 1], dense[(M + 1) * (N + 1)], product[N + 1], hessian[N_HESSIAN + 1];
    int32_t rows[N_HESSIAN + 1], columns[N_HESSIAN + 1];
    /* One too few, one too many. */
    for (int by = -1; by <= 1; by += 2) {
        const size_t n = (size_t)(N + by), m = (size_t)(M + by), n_jacobian = (size_t)(N_JACOBIAN + by);
        const size_t n_hessian = (size_t)(N_HESSIAN + by);
        const char *words = by < 0 ? "x has 9 entries; there are 10 variables" : "x has 11 entries; there are 10 variables";
        FAILS(ko_constraints_values(set, x, n, M, values), KO_ERR_INVALID_ARGUMENT, words);
        FAILS(ko_constraints_jacobian(set, x, n, N_JACOBIAN, entries), KO_ERR_INVALID_ARGUMENT, words);
        FAILS(ko_constraints_values_and_jacobian(set, x, n, M, values, N_JACOBIAN, entries), KO_ERR_INVALID_ARGUMENT, words);
        FAILS(ko_constraints_dense_jacobian(set, x, n, M, dense), KO_ERR_INVALID_ARGUMENT,
              by < 0 ? "jacobian has 36 entries; there are 40 entries" : "jacobian has 44 entries; there are 40 entries");
        FAILS(ko_constraints_jacobian_times(set, x, x, n, M, product), KO_ERR_INVALID_ARGUMENT,
              by < 0 ? "v has 9 entries; there are 10 variables" : "v has 11 entries; there are 10 variables");
        FAILS(ko_constraints_transposed_jacobian_times(set, x, n, w, M, product), KO_ERR_INVALID_ARGUMENT,
              by < 0 ? "product has 9 entries; there are 10" : "product has 11 entries; there are 10");
        FAILS(ko_constraints_hessian(set, x, n, w, M, N_HESSIAN, hessian), KO_ERR_INVALID_ARGUMENT, words);

        words = by < 0 ? "values has 3 entries; there are 4 values" : "values has 5 entries; there are 4 values";
        FAILS(ko_constraints_values(set, x, N, m, values), KO_ERR_INVALID_ARGUMENT, words);
        FAILS(ko_constraints_values_and_jacobian(set, x, N, m, values, N_JACOBIAN, entries), KO_ERR_INVALID_ARGUMENT, words);
        FAILS(ko_constraints_dense_jacobian(set, x, N, m, dense), KO_ERR_INVALID_ARGUMENT, "there are 40 entries");
        FAILS(ko_constraints_jacobian_times(set, x, x, N, m, product), KO_ERR_INVALID_ARGUMENT,
              by < 0 ? "product has 3 entries; there are 4 values" : "product has 5 entries; there are 4 values");
        FAILS(ko_constraints_transposed_jacobian_times(set, x, N, w, m, product), KO_ERR_INVALID_ARGUMENT,
              by < 0 ? "w has 3 entries; there are 4 values" : "w has 5 entries; there are 4 values");
        FAILS(ko_constraints_hessian(set, x, N, w, m, N_HESSIAN, hessian), KO_ERR_INVALID_ARGUMENT,
              by < 0 ? "lambda has 3 entries; there are 4 values" : "lambda has 5 entries; there are 4 values");

        FAILS(ko_constraints_jacobian(set, x, N, n_jacobian, entries), KO_ERR_INVALID_ARGUMENT, "there are 31 entries");
        FAILS(ko_constraints_values_and_jacobian(set, x, N, M, values, n_jacobian, entries), KO_ERR_INVALID_ARGUMENT,
              "there are 31 entries");
        FAILS(ko_constraints_jacobian_pattern(set, n_jacobian, rows, columns), KO_ERR_INVALID_ARGUMENT, "the object has 31");
        FAILS(ko_constraints_hessian(set, x, N, w, M, n_hessian, hessian), KO_ERR_INVALID_ARGUMENT, "there are 55 entries");
        FAILS(ko_constraints_hessian_pattern(set, n_hessian, rows, columns), KO_ERR_INVALID_ARGUMENT, "the object has 55");
    }
    FAILS(ko_constraints_dense_jacobian(set, x, N, SIZE_MAX / 8, dense), KO_ERR_INVALID_ARGUMENT, "jacobian is said to have");
    ko_constraints_free(set);
}

static void directions_that_are_not_finite_are_named(void) {
    ko_constraints *set = make_set();
    const double x[N] = {0.1, 0.2, 0.3, 1, 0, 0, 0, 0.3, 0.2, 0.1};
    double v[N] = {0}, w[M] = {1, 1, 1, 1}, product[N];
    v[7] = nan_value;
    w[2] = -INFINITY;
    FAILS(ko_constraints_jacobian_times(set, x, v, N, M, product), KO_ERR_INVALID_ARGUMENT,
          "entry of v 7 is NaN; it must be finite");
    FAILS(ko_constraints_transposed_jacobian_times(set, x, N, w, M, product), KO_ERR_INVALID_ARGUMENT,
          "entry of w 2 is -inf; it must be finite");
    ko_constraints_free(set);
}

static void arrays_that_are_required_are_asked_for(void) {
    ko_constraints *set = make_set();
    const double x[N] = {0.1, 0.2, 0.3, 1, 0, 0, 0, 0.3, 0.2, 0.1};
    double w[M] = {1, 1, 1, 1}, values[M], entries[N_JACOBIAN], hessian[N_HESSIAN];
    int32_t rows[N_HESSIAN], columns[N_HESSIAN];
    FAILS(ko_constraints_values(set, x, N, M, NULL), KO_ERR_INVALID_ARGUMENT, "values is NULL");
    FAILS(ko_constraints_jacobian(set, x, N, N_JACOBIAN, NULL), KO_ERR_INVALID_ARGUMENT, "entries is NULL");
    FAILS(ko_constraints_values_and_jacobian(set, x, N, M, NULL, N_JACOBIAN, entries), KO_ERR_INVALID_ARGUMENT,
          "values is NULL");
    FAILS(ko_constraints_values_and_jacobian(set, x, N, M, values, N_JACOBIAN, NULL), KO_ERR_INVALID_ARGUMENT,
          "entries is NULL");
    FAILS(ko_constraints_dense_jacobian(set, x, N, M, NULL), KO_ERR_INVALID_ARGUMENT, "jacobian is NULL");
    FAILS(ko_constraints_jacobian_times(set, x, NULL, N, M, values), KO_ERR_INVALID_ARGUMENT, "v is NULL");
    FAILS(ko_constraints_jacobian_times(set, x, x, N, M, NULL), KO_ERR_INVALID_ARGUMENT, "product is NULL");
    FAILS(ko_constraints_transposed_jacobian_times(set, x, N, NULL, M, entries), KO_ERR_INVALID_ARGUMENT, "w is NULL");
    FAILS(ko_constraints_transposed_jacobian_times(set, x, N, w, M, NULL), KO_ERR_INVALID_ARGUMENT, "product is NULL");
    FAILS(ko_constraints_hessian(set, x, N, NULL, M, N_HESSIAN, hessian), KO_ERR_INVALID_ARGUMENT, "lambda is NULL");
    FAILS(ko_constraints_hessian(set, x, N, w, M, N_HESSIAN, NULL), KO_ERR_INVALID_ARGUMENT, "entries is NULL");
    FAILS(ko_constraints_jacobian_pattern(NULL, N_JACOBIAN, rows, columns), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    FAILS(ko_constraints_jacobian_pattern(set, N_JACOBIAN, NULL, columns), KO_ERR_INVALID_ARGUMENT, "rows is NULL");
    FAILS(ko_constraints_jacobian_pattern(set, N_JACOBIAN, rows, NULL), KO_ERR_INVALID_ARGUMENT, "columns is NULL");
    FAILS(ko_constraints_hessian_pattern(NULL, N_HESSIAN, rows, columns), KO_ERR_INVALID_ARGUMENT, "constraints is NULL");
    FAILS(ko_constraints_hessian_pattern(set, N_HESSIAN, NULL, columns), KO_ERR_INVALID_ARGUMENT, "rows is NULL");
    FAILS(ko_constraints_hessian_pattern(set, N_HESSIAN, rows, NULL), KO_ERR_INVALID_ARGUMENT, "columns is NULL");
    FAILS(ko_constraints_jacobian_pattern(set, N_JACOBIAN, MISALIGNED(rows), columns), KO_ERR_INVALID_ARGUMENT, "rows is at");
    FAILS(ko_constraints_values(set, x, N, M, MISALIGNED(values)), KO_ERR_INVALID_ARGUMENT, "values is at");
    w[2] = nan_value;
    FAILS(ko_constraints_hessian(set, x, N, w, M, N_HESSIAN, hessian), KO_ERR_INVALID_ARGUMENT,
          "multiplier 2 is NaN; it must be finite");
    ko_constraints_free(set);
}

/* Angles, rotation vectors and scales that leave their range on the way of an optimiser. */
static void poses_out_of_range_are_named(void) {
    const struct {
        uint32_t dim;
        int32_t rotation, scale;
        size_t n, at;
        double to;
        const char *words;
    } cases[] = {
        {2, KO_ROTATION_ANGLE, KO_SCALE_FREE, 4, 2, 1e7, "frame 1, with variables from 0 on: parameter 2 is the angle 10000000"},
        {2, KO_ROTATION_ANGLE, KO_SCALE_FREE, 4, 3, 0.0, "parameter 3 is the scale 0"},
        {2, KO_ROTATION_NONE, KO_SCALE_FREE, 3, 2, -1.0, "parameter 2 is the scale -1"},
        {3, KO_ROTATION_VECTOR, KO_SCALE_ONE, 6, 4, -2e6, "parameters 3 to 5 are a rotation vector of length 2000000"},
        {3, KO_ROTATION_QUATERNION, KO_SCALE_FREE, 8, 7, 1e31, "parameter 7 is the scale 1"},
        {3, KO_ROTATION_QUATERNION, KO_SCALE_FREE, 8, 5, 2e6, "are a quaternion of length 2000000.0"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        ko_constraints *set = NULL;
        ko_field *field = check_made_field(cases[c].dim);
        ko_body *body = check_body(cases[c].dim, 3, 1);
        uint32_t frame = 0;
        OK(ko_constraints_create(cases[c].dim, &set));
        OK(ko_constraints_add_frame(set, cases[c].rotation, cases[c].scale, &frame));
        OK(ko_constraints_keep_body(set, body, frame, field, KO_WORLD, NULL, NULL));
        double x[8] = {1, 1, 1, 1, 1, 1, 1, 1}, value;
        OK(ko_constraints_values(set, x, cases[c].n, 1, &value));
        x[cases[c].at] = cases[c].to;
        FAILS(ko_constraints_values(set, x, cases[c].n, 1, &value), KO_ERR_INVALID_ARGUMENT, cases[c].words);
        ko_constraints_free(set);
        ko_body_free(body);
        ko_field_free(field);
    }
}

int main(void) {
    aggregations_out_of_range_are_refused();
    bodies_that_are_none_are_refused();
    what_cannot_be_added_is_refused();
    what_cannot_be_kept_is_refused();
    variables_out_of_range_are_named();
    samples_out_of_range_are_named();
    lengths_are_checked();
    directions_that_are_not_finite_are_named();
    arrays_that_are_required_are_asked_for();
    poses_out_of_range_are_named();
    return check_result();
}
