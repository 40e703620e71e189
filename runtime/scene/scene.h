// What a scene is: meshes, spheres, materials, emitters, a camera and a film, in world space and free of any file
// format. runtime/io fills it, runtime/scene/traits.h says what it needs, runtime/scene/scene_tables.h lays it out
// for the device.
#pragma once

#include "kernels/shared/bsdf_list.h"
#include "runtime/scene/texture.h"

#include <array>
#include <concepts>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gradus {

/// Linear RGB with the primaries and white point of sRGB. Unit and meaning are with the member that holds it.
struct Rgb {
    float r = 0, g = 0, b = 0;
    bool operator==(const Rgb &) const = default;
};

/// As rgb_luminance in kernels/lib/vector.h.
constexpr double luminance(double r, double g, double b) { return 0.212671 * r + 0.715160 * g + 0.072169 * b; }
constexpr double luminance(const Rgb &color) { return luminance(color.r, color.g, color.b); }

constexpr std::int32_t no_texture = -1;

/// A colour of a material: `texture`, an index into Scene::textures, stands in its place where there is one. The colour
/// is its mean then.
struct Color : Rgb {
    std::int32_t texture = no_texture;
    Color() = default;
    Color(const Rgb &rgb) : Rgb(rgb) {}
    Color(float red, float green, float blue) : Rgb{red, green, blue} {}
    bool operator==(const Color &) const = default;
};

/// The same for a number: `value` is then the least that the texture has.
struct Number {
    float value = 0;
    std::int32_t texture = no_texture;
    Number() = default;
    Number(float number) : value(number) {}
    operator float() const { return value; }
    Number &operator*=(float factor) { return value *= factor, *this; }
    bool operator==(const Number &) const = default;
    template <std::floating_point Other>
    bool operator==(Other other) const {
        return texture == no_texture && value == other;
    }
};

struct Vector3 {
    float x = 0, y = 0, z = 0;
    bool operator==(const Vector3 &) const = default;
};

/// Row-major 4x4 matrix acting on column vectors, in double so that chains of transforms stay exact to float.
struct Matrix4 {
    std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
};

/// Numbers of a mesh beside its geometry, which textures of kind mesh_attribute read.
struct MeshAttribute {
    std::string name;           ///< vertex_... or face_...: one for each vertex, or for each triangle
    std::uint32_t channels = 3; ///< one or three numbers
    std::vector<float> values;
};

/// A triangle mesh in world space. The geometric normal of a triangle is (p1 - p0) x (p2 - p0), normalised; a loader
/// that mirrors or flips a mesh reorders its indices so that this holds.
struct Mesh {
    std::vector<Vector3> positions;
    std::vector<Vector3> normals;                ///< shading normals by vertex, interpolated before they are made unit
                                                 ///< vectors, of about that length; empty: use the geometric normal
    std::vector<std::array<float, 2>> texcoords; ///< by vertex; may be empty
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<MeshAttribute> attributes = {}; ///< those that textures of the scene name
    std::vector<std::uint32_t> normal_of = {};  ///< by vertex, until the mesh is built: the one whose computed normal
                                                ///< it shares, as both were one; empty: each has its own
};

/// Whether an attribute of that name is by triangle; it is by vertex else.
inline bool is_by_face(const std::string &attribute) { return attribute.starts_with("face_"); }
/// nullptr where the mesh has none of that name.
inline const MeshAttribute *find_attribute(const Mesh &mesh, const std::string &name) {
    for (const MeshAttribute &attribute : mesh.attributes)
        if (attribute.name == name)
            return &attribute;
    return nullptr;
}

struct Sphere {
    /// What rays meet of it. Of a sphere that rays may pass (opacity below 1) they must pass each side by itself, so
    /// that is two spheres of the scene: the side on which they come in, and that on which they leave.
    enum class Side { both, entered, left };
    Vector3 center;
    float radius = 1;
    bool flip_normals = false; ///< true: the normal points to the center
    Side side = Side::both;
    /// Unit vectors along which its own x, y and z lie: (u, v) and anisotropy turn with them. A mirrored sphere's are
    /// left-handed.
    std::array<Vector3, 3> axes{Vector3{1, 0, 0}, Vector3{0, 1, 0}, Vector3{0, 0, 1}};

    /// As kernels have it: below 0 where rays leave it.
    float signed_radius() const { return side == Side::left ? -radius : radius; }
};

constexpr std::int32_t no_group = -1;

/// A mesh or a sphere, with its material and what it emits.
struct Shape {
    enum class Kind { mesh, sphere };
    Kind kind = Kind::mesh;
    std::uint32_t geometry = 0; ///< index into Scene::meshes or Scene::spheres
    std::uint32_t material = 0; ///< index into Scene::materials
    std::int32_t emitter = -1;  ///< index into Scene::emitters, or -1
    std::string name;           ///< its id in the file, or a description of where it came from
    /// A mesh of that group, in its frame: seen where instances of the group are, and neither emits. Else it is seen
    /// where it is.
    std::int32_t group = no_group;
    bool is_black_lamp = false; ///< bears an emitter of radiance 0, which is none but hidden from the camera as one

    bool bears_emitter() const { return emitter >= 0 || is_black_lamp; }
};

/// A group of shapes once more.
struct Instance {
    std::uint32_t group = 0;
    /// Rows of the map from the group's frame to the world. It can be undone; normals go as normals, so that a mirror
    /// turns no front (NormalMap).
    std::array<float, 12> to_world{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
};

/// GRADUS_BSDF_KINDS. A kind's place is its number in kernels.
#define GRADUS_KIND_NAME(name, ...) name,
enum class BsdfKind : std::uint32_t { GRADUS_BSDF_KINDS(GRADUS_KIND_NAME) };
#undef GRADUS_KIND_NAME

constexpr std::int32_t no_blend = -1;

/// A texture that turns the shading normal under a BSDF.
struct NormalTexture {
    enum class Kind {
        none,
        normal, ///< its colour is the normal: x along dp/du, z along the shading normal, each from [-1, 1] to [0, 1]
        bump    ///< its luminance, times `scale`, is a height along the normal
    };
    Kind kind = Kind::none;
    std::int32_t texture = no_texture;
    float scale = 1;         ///< of a bump map, in lengths
    bool turns_over = false; ///< a normal that would be seen from behind is turned about the surface's own
    bool shadows = false;    ///< light that grazes the surface is dimmed
    bool is_outside = false; ///< the material was two-sided before it had the map
    bool operator==(const NormalTexture &) const = default;
};

/// One side of a surface. The members are those of GRADUS_MATERIAL_PARAMETERS; what its kind does not name is ignored.
#define GRADUS_COLOR_MEMBER(with, name, value, text) Color name{value, value, value};
#define GRADUS_NUMBER_MEMBER(with, name, value, text) Number name = value;
struct Bsdf {
    BsdfKind kind = BsdfKind::diffuse;
    GRADUS_MATERIAL_PARAMETERS(GRADUS_COLOR_MEMBER, GRADUS_NUMBER_MEMBER, )
    NormalTexture map;
    std::int32_t blend = no_blend; ///< index into Scene::blends, which then says all: a mixture of two others
    bool operator==(const Bsdf &) const = default;
};
#undef GRADUS_COLOR_MEMBER
#undef GRADUS_NUMBER_MEMBER

/// Two BSDFs of Scene::blended, each of which may be a blend again. A path meets one of them at a vertex, the second
/// with the probability `weight`.
struct Blend {
    std::uint32_t first = 0, second = 0;
    Number weight = 0.5f;
};

/// A BSDF for the front side of a surface and one for its back. One-sided kinds (diffuse, conductors) absorb what
/// arrives from behind unless two_sided; then `back` describes the back side as seen from there.
struct Material {
    Bsdf front;
    Bsdf back;              ///< used only where two_sided
    bool two_sided = false; ///< never true for kinds that transmit, which have both sides by nature
    Number opacity = 1; ///< share of the rays that meet the surface, of a coloured texture its luminance; the others
                        ///< pass, as if nothing were there
    std::string name;
};

struct EnvironmentMap; // runtime/scene/environment_map.h

struct Emitter {
    enum class Kind {
        area,        ///< emits from the front side of a shape
        constant,    ///< the same radiance from every direction
        point,       ///< at position
        directional, ///< travels along direction
        environment, ///< from every direction what its map says
        spot,        ///< from position around direction
        projector    ///< from position, a picture
    };
    Kind kind = Kind::area;
    Rgb value; ///< area, constant: radiance (W sr^-1 m^-2); point: intensity (W sr^-1); directional: irradiance on a
               ///< plane across the direction (W m^-2); spot: intensity within the beam; environment: what the map's
               ///< radiance is times; projector: irradiance on a plane across its axis, at distance 1 (W m^-2)
    /// What value is times, at each place of a surface or of the picture that a spot or a projector throws.
    std::int32_t texture = no_texture;
    Vector3 position;  ///< point, spot, projector
    Vector3 direction; ///< directional, spot, projector: unit vector, the way that light travels
    float cutoff = 0;  ///< spot: the angle from the direction beyond which nothing goes, in radians, at most pi
    float beam = 0;    ///< spot: the angle up to which all does; in between intensity is linear in the angle
    /// In world space; environment: the map's; spot with a texture, projector: along u and v of the picture, and ahead.
    std::array<Vector3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::array<float, 2> picture{1, 1};        ///< how wide and high the picture is at distance 1
    std::shared_ptr<const EnvironmentMap> map; ///< environment

    bool shines_from_a_point() const { return kind == Kind::point || kind == Kind::spot || kind == Kind::projector; }
};

/// A camera that looks along its local +z with +y up and +x to the left of the image, as Mitsuba has it.
struct Camera {
    enum class FovAxis { x, y, smaller, larger, diagonal };
    enum class Kind {
        perspective, ///< a pinhole
        thin_lens,
        orthographic ///< its film is [-1, 1] wide before to_world
    };
    Matrix4 to_world; ///< rigid but for a scale, which counts of an orthographic camera alone
    double fov = 50;  ///< degrees, along fov_axis
    FovAxis fov_axis = FovAxis::x;
    Kind kind = Kind::perspective;
    double principal_x = 0,
           principal_y = 0;                ///< how far right of and below what lies ahead the film's middle looks, ...
                                           ///< ... in widths and heights of the film
    double near_clip = 0, far_clip = 1e30; ///< along the line of sight, what is nearer or farther is not seen
    double aperture_radius = 0;            ///< of a thin lens
    double focus_distance = 1;             ///< of a thin lens, along the line of sight
};

struct FilmSettings {
    enum class Filter { box, tent, gaussian, mitchell, catmullrom, lanczos };
    std::uint32_t width = 768, height = 576;                               ///< the full film; the crop is a part of it
    std::uint32_t crop_x = 0, crop_y = 0, crop_width = 0, crop_height = 0; ///< crop_width 0: no crop
    Filter filter = Filter::gaussian;
    float filter_radius =
        2.0f; ///< half its support in pixels: of a Gaussian where it is cut off, of Lanczos' its lobes
    float filter_stddev = 0.5f;                         ///< gaussian, in pixels
    float mitchell_b = 1 / 3.0f, mitchell_c = 1 / 3.0f; ///< of Mitchell and Netravali (1988)
};

/// Width and height of the image to render: the crop's, or the film's where there is none.
inline std::array<std::uint32_t, 2> image_size(const FilmSettings &film) {
    if (film.crop_width == 0)
        return {film.width, film.height};
    return {film.crop_width, film.crop_height};
}

/// What the file asks of the renderer; the command line may override each.
struct RenderSettings {
    int max_depth = -1; ///< path edges at most; 1: directly seen emitters only; -1: no limit
    int rr_depth = 5;   ///< Russian roulette from this depth on
    bool hide_emitters = false;
    std::uint64_t samples_per_pixel = 4;
    std::string integrator; ///< as the file names it; informative
};

struct Scene {
    std::string path; ///< the file that it came from
    std::vector<Mesh> meshes;
    std::vector<Sphere> spheres;
    std::vector<Shape> shapes;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Bsdf> blended; ///< what blends are made of
    std::vector<Blend> blends;
    std::vector<Emitter> emitters;
    Camera camera;
    FilmSettings film;
    RenderSettings settings;
    std::vector<Instance> instances;
    std::uint32_t groups = 0;           ///< Shape::group is below
    std::uint64_t copied_instances = 0; ///< of groups of shapes, which are shapes by now; informative
};

} // namespace gradus
