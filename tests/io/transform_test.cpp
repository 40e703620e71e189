// Transforms as scene files write them, against matrices worked out by hand.
#include "runtime/scene/transform.h"
#include "tests/io/scene_text.h"

#include <cmath>

namespace gradus {
namespace {

/// The camera's to_world for these steps of a <transform>.
Matrix4 matrix_of(const std::string &steps, const std::string &version = "3.0.0") {
    const std::string name = version[0] == '0' ? "toWorld" : "to_world";
    return load_text("<scene version=\"" + version + "\"><sensor type=\"perspective\"><transform name=\"" + name +
                     "\">" + steps + "</transform></sensor><shape type=\"sphere\"/></scene>")
        .scene.camera.to_world;
}

void expect_matrix(const Matrix4 &actual, const std::array<double, 16> &expected, double tolerance = 1e-12) {
    for (int i = 0; i < 16; ++i)
        EXPECT_NEAR(actual.m[i], expected[i], tolerance) << "row " << i / 4 << " column " << i % 4;
}

TEST(Transform, MatrixOfSixteenAndNine) {
    expect_matrix(matrix_of("<matrix value=\"1 2 3 4, 5 6 7 8  9,10,12 12 0 0 0 1\"/>"),
                  {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 12, 0, 0, 0, 1});
    expect_matrix(matrix_of("<matrix value=\" 1 2 3\n 4 5 6\n 7 8 10 \"/>"),
                  {1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 0, 0, 0, 1});
}

/// An exporter's inverse may leave rounding in the last row, or a factor.
TEST(Transform, MatrixWithALastRowThatIsNearlyThatOfAnAffineMap) {
    for (const char *row : {"1e-17 0 0 1", "0 -2e-6 1e-7 2"}) {
        const Matrix4 matrix = matrix_of("<matrix value=\"2 0 0 0 0 2 0 0 0 0 2 0 " + std::string(row) + "\"/>");
        for (int i = 12; i < 16; ++i)
            EXPECT_EQ(matrix.m[i], i == 15 ? 1 : 0);
        EXPECT_EQ(matrix.m[0], row[0] == '0' ? 1 : 2);
    }
}

TEST(Transform, TranslateAndScale) {
    expect_matrix(matrix_of("<translate x=\"1\" z=\"-2\"/>"), {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, -2, 0, 0, 0, 1});
    expect_matrix(matrix_of("<translate value=\"1, 2, 3\"/>"), {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1});
    expect_matrix(matrix_of("<translate value=\"0.3\"/>"), {1, 0, 0, 0.3, 0, 1, 0, 0.3, 0, 0, 1, 0.3, 0, 0, 0, 1});
    expect_matrix(matrix_of("<scale x=\"2\" y=\"-3\"/>"), {2, 0, 0, 0, 0, -3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<scale value=\"4\"/>"), {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<scale value=\"4 5 6\"/>"), {4, 0, 0, 0, 0, 5, 0, 0, 0, 0, 6, 0, 0, 0, 0, 1});
}

TEST(Transform, RotationIsRightHanded) {
    // A quarter turn about z takes x to y.
    expect_matrix(matrix_of("<rotate z=\"1\" angle=\"90\"/>"), {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<rotate y=\"7\" angle=\"90\"/>"), {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<rotate value=\"1 0 0\" angle=\"-90\"/>"),
                  {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1});
    // A third of a turn about the diagonal takes x to y, y to z and z to x.
    expect_matrix(matrix_of("<rotate x=\"1\" y=\"1\" z=\"1\" angle=\"120\"/>"),
                  {0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<rotate value=\"5\" angle=\"120\"/>"), {0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1});
}

TEST(Transform, StepsApplyInTheirOrder) {
    // First scaled, then moved: x -> 2 x + 1. The other way round: 2 (x + 1).
    expect_matrix(matrix_of("<scale value=\"2\"/><translate x=\"1\"/>"),
                  {2, 0, 0, 1, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<translate x=\"1\"/><scale value=\"2\"/>"),
                  {2, 0, 0, 2, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
    expect_matrix(matrix_of("<matrix value=\"0 -1 0 1 0 0 0 0 1\"/><matrix value=\"1 0 0 0 0 -1 0 1 0\"/>"),
                  {0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0, 0, 0, 1});
}

TEST(Transform, LookAt) {
    // From (0, 0, 5) towards the origin: z = (0, 0, -1), x = up x z = (-1, 0, 0), y = up.
    const std::array<double, 16> expected{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 5, 0, 0, 0, 1};
    expect_matrix(matrix_of("<lookat origin=\"0 0 5\" target=\"0 0 0\" up=\"0, 2, 1\"/>"), expected);
    expect_matrix(matrix_of("<lookAt origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"/>", "0.5.0"), expected);
}

/// As Mitsuba 3.9.1 has it; of 0.x the formula is that of the book that its program follows.
TEST(Transform, LookAtWithoutUp) {
    expect_matrix(matrix_of("<lookat origin=\"1 2 3\" target=\"0 0.5 -1\"/>"),
                  {-0.04076095, 0.97282606, -0.22792116, 1, 0.93885857, -0.04076095, -0.34188172, 2, -0.34188172,
                   -0.22792116, -0.91168463, 3, 0, 0, 0, 1},
                  1e-7);
    // up lies in the plane of the view and the axis that it is farther from, of x and y.
    const Matrix4 old = matrix_of("<lookat origin=\"1 2 3\" target=\"0 0.5 -1\"/>", "0.6.0");
    EXPECT_NEAR(determinant(old), 1, 1e-12);
    EXPECT_NEAR(old.m[0], 0, 1e-12);
    EXPECT_GT(old.m[1], 0.9);
}

TEST(Transform, LookAtAlongUpChoosesAnother) {
    const Matrix4 matrix = matrix_of("<lookat origin=\"0 0 0\" target=\"0 3 0\" up=\"0 1 0\"/>");
    EXPECT_NEAR(determinant(matrix), 1, 1e-12);
    EXPECT_NEAR(matrix.m[6], 1, 1e-12); // still looks up
}

TEST(Transform, NormalMapIsInverseTranspose) {
    Matrix4 matrix;
    matrix.m = {1, 0.5, 0.2, 3, -0.3, 2, 0.7, 1, 0.1, 0.4, -1.5, 0, 0, 0, 0, 1};
    ASSERT_LT(determinant(matrix), 0);
    const NormalMap map(matrix);
    const Double3 normal{0.3, -0.5, 0.8}, tangent{0.5, 0.3, 0}; // perpendicular
    ASSERT_NEAR(dot(normal, tangent), 0, 1e-15);
    const Double3 mapped = map(normal);
    EXPECT_NEAR(dot(mapped, transform_vector(matrix, tangent)), 0, 1e-12);
    // What lies on the normal's side stays there, mirrored or not.
    EXPECT_GT(dot(mapped, transform_vector(matrix, normal)), 0);
}

} // namespace
} // namespace gradus
